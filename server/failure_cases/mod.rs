//! The failure gallery: scenes on which a common method is wrong, with what each method says there and what is true.
//!
//! A case is a scene and functions of it: everything it says is computed when it is asked for, nothing is recorded. Not here:
//! how a case is written down, and HTTP.

mod basin;
mod boundary;
mod contact;
mod course;
mod derivative;
mod horizon;
mod steps;

use crate::charts::Chart;
use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::scene::model::Model;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

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
    scene: fn() -> Scene,
    look: fn(&Scene, u64) -> Findings,
    picture: fn(&Scene, u64) -> Chart,
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

/// All cases, in the order in which they are shown.
pub const CASES: [FailureCase; 15] = [
    boundary::SOFT,
    boundary::HARD,
    boundary::HARD_WITH_FEEDBACK,
    basin::DRIFT,
    basin::RESONANCE,
    basin::WIDE,
    boundary::BEYOND,
    steps::INVENTED,
    steps::DESTROYED,
    steps::MISSED,
    derivative::DIFFERENCES,
    derivative::GRAZE,
    steps::ZENO,
    contact::TRIVIAL_ROOT,
    horizon::CHAOS,
];

/// The case of this name.
pub fn find(name: &str) -> Option<&'static FailureCase> {
    const { &CASES }.iter().find(|case| case.name == name)
}

/// The paper's l and ρ, m, and its height of release.
const PAPER: [(Name, f64); 3] =
    [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 0.094_280_904_158_206_35), (Name::Height, 0.2)];

/// The paper's rod with other numbers besides or instead.
fn rod(numbers: &[(Name, f64)]) -> Draft {
    with(Draft::default(), &PAPER.iter().chain(numbers).copied().collect::<Vec<_>>())
}

/// A draft with these numbers.
fn with(mut draft: Draft, numbers: &[(Name, f64)]) -> Draft {
    for (name, number) in numbers {
        draft.set(*name, Some(Value::Number(*number))).expect("a test builds every case");
    }
    draft
}

fn built(draft: Draft) -> Scene {
    draft.build().expect("a test builds every case")
}

/// The rod of a scene: there are no point masses and no friction in the gallery.
fn rod_of(scene: &Scene) -> Rod {
    match scene.model() {
        Model::Rod(rod) => rod,
        Model::Point(point) => *point.parameters(),
        Model::General(rig) => rig.rod,
    }
}
