//! A case of the gallery: a scene, what each method claims about it, and what is true.

use crate::charts::Chart;
use equipoise_physics::scene::Scene;

/// A scene on which a common method is wrong.
#[derive(Clone, Copy, Debug)]
pub struct FailureCase {
    /// Name in requests.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// The usual method that fails.
    pub method: &'static str,
    /// Paragraph that says why it fails.
    pub why: &'static str,
    /// Contacts that its runs have at most.
    pub impacts: u64,
    /// The request that shows the truth, beside the scene: a resource, and the rest of its query.
    pub ask: (&'static str, &'static str),
    /// Cost of the claims, or of the picture, in bounces of the plain rod.
    pub price: u64,
    pub(super) scene: fn() -> Scene,
    pub(super) find: fn(&Scene, u64) -> Findings,
    pub(super) picture: fn(&Scene, u64) -> Chart,
}

impl FailureCase {
    /// The scene.
    pub fn scene(&self) -> Scene {
        (self.scene)()
    }

    /// The claims of the methods, and the truth.
    pub fn findings(&self) -> Findings {
        (self.find)(&self.scene(), self.impacts)
    }

    /// The picture.
    pub fn picture(&self) -> Chart {
        (self.picture)(&self.scene(), self.impacts)
    }
}

/// Findings on a scene.
#[derive(Clone, Debug)]
pub struct Findings {
    /// By each method, the usual one first.
    pub says: Vec<MethodClaim>,
    /// The truth, in the words of the verdicts.
    pub truth: &'static str,
    /// Evidence for it, with numbers.
    pub detail: String,
}

/// Claim of a method. It is right if its verdict is the truth.
#[derive(Clone, Debug)]
pub struct MethodClaim {
    /// Name of the method.
    pub method: &'static str,
    /// In a word or two.
    pub verdict: &'static str,
    /// The number that it rests on.
    pub value: Option<f64>,
    /// Unit of that; `None` for a pure number.
    pub unit: Option<&'static str>,
    /// Derivation of the claim, in a sentence.
    pub detail: String,
}
