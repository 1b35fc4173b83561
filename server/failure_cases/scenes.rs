//! The scenes of the gallery, made from the paper's rod.

use equipoise_physics::map::strike::Rod;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

/// The paper's l and ρ, m, and its height of release.
const PAPER: [(Name, f64); 3] =
    [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 0.094_280_904_158_206_35), (Name::Height, 0.2)];

/// The paper's rod with other numbers besides or instead.
pub(super) fn rod(numbers: &[(Name, f64)]) -> Draft {
    with(Draft::default(), &PAPER.iter().chain(numbers).copied().collect::<Vec<_>>())
}

/// A draft with these numbers.
pub(super) fn with(mut draft: Draft, numbers: &[(Name, f64)]) -> Draft {
    for (name, number) in numbers {
        draft.set(*name, Some(Value::Number(*number))).expect("a test builds every case");
    }
    draft
}

pub(super) fn built(draft: Draft) -> Scene {
    draft.build().expect("a test builds every case")
}

/// The rod of a scene: there are no point masses and no friction in the gallery.
pub(super) fn rod_of(scene: &Scene) -> Rod {
    scene.model().rod
}
