//! A case of the gallery: a scene, what each method claims about it, and what is true.

use crate::charts::Chart;
use equipoise_physics::scene::Scene;

/// A scene on which a common method is wrong.
#[derive(Clone, Copy, Debug)]
pub struct FailureCase {
    /// Its name in requests.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The usual method that fails.
    pub method: &'static str,
    /// Why it fails, in a paragraph.
    pub why: &'static str,
    /// Contacts that its runs have at most.
    pub impacts: u64,
    /// The request that shows the truth, beside the scene: a resource, and the rest of its query.
    pub ask: (&'static str, &'static str),
    /// What it costs to look, or to draw, in bounces of the plain rod.
    pub price: u64,
    pub(super) scene: fn() -> Scene,
    pub(super) look: fn(&Scene, u64) -> Findings,
    pub(super) picture: fn(&Scene, u64) -> Chart,
}

impl FailureCase {
    /// Its scene.
    pub fn scene(&self) -> Scene {
        (self.scene)()
    }

    /// What each method says of it.
    pub fn look(&self) -> Findings {
        (self.look)(&self.scene(), self.impacts)
    }

    /// Its picture.
    pub fn picture(&self) -> Chart {
        (self.picture)(&self.scene(), self.impacts)
    }
}

/// What was found on a scene.
#[derive(Clone, Debug)]
pub struct Findings {
    /// By each method, the usual one first.
    pub says: Vec<MethodClaim>,
    /// What is true, in the words of the verdicts.
    pub truth: &'static str,
    /// How that is known, with numbers.
    pub detail: String,
}

/// What a method says. It is right where its verdict is the truth.
#[derive(Clone, Debug)]
pub struct MethodClaim {
    /// Its name.
    pub method: &'static str,
    /// In a word or two.
    pub verdict: &'static str,
    /// The number that it rests on.
    pub value: Option<f64>,
    /// Unit of that; none for a pure number.
    pub unit: Option<&'static str>,
    /// How it comes to that, in a sentence.
    pub detail: String,
}
