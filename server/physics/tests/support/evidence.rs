//! Verdicts and evidence of scenes.

use equipoise_physics::analysis::evidence::{Balance, Evidence, Judgement, SMALL_RUN, Swing, evidence, judge};
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::scene::Scene;

/// The verdict on a scene with its run of some contacts.
pub(crate) fn judged(scene: &Scene, impacts: u64) -> Judgement {
    judge(scene, &run_nonlinear(scene, impacts, || true).unwrap(), SMALL_RUN, || true).unwrap()
}

/// The bounce that repeats in a scene, with the motion beside it.
pub(crate) fn balance(scene: &Scene) -> Balance {
    match evidence(scene, SMALL_RUN, &mut || true).unwrap() {
        Evidence::Balances(balance) => *balance,
        other => panic!("{other:?}"),
    }
}

/// The swing of a scene's release, where it has a normal form.
pub(crate) fn swing(scene: &Scene) -> Option<Swing> {
    balance(scene).swing?.ok()
}

/// 1/(2ℓA²), contacts after which a swing that grows has left.
pub(crate) fn escape_impacts(swing: &Swing) -> f64 {
    0.5 / (swing.form.growth * swing.amplitude * swing.amplitude)
}
