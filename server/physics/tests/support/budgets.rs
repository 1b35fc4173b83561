//! Scenes whose errors have a budget, and their limits.

use crate::paper;
use crate::support::reference::differences;
pub(crate) use crate::support::rig::{scene, with};
use crate::support::scenes::upright_bounce;
use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::analysis::jacobian::eigenvalues;
use equipoise_physics::analysis::margins::budget::{Budget, ErrorBudget, find_budget};
use equipoise_physics::analysis::margins::judgement::LimitedBy;
use equipoise_physics::analysis::margins::judgement::VerdictLimit;
use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::DecidedBy;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene};

pub(crate) const LINEAR: LimitedBy = LimitedBy::Verdict(DecidedBy::Linear);
pub(crate) const BY_RUN: LimitedBy = LimitedBy::Verdict(DecidedBy::Nonlinear);

/// State feedback of the paper's rod that brings it to rest.
pub(crate) fn fed_back(values: &[(Name, f64)]) -> Scene {
    let mut draft = paper::scene(1.1, 0.05).draft();
    draft.set(Name::TiltGain, None).unwrap();
    let place = small_deviations(&paper::scene(1.1, 0.05)).unwrap().fixed_point;
    let model = upright_bounce(&paper::scene(1.1, 0.05).parameters(), place.speed, ContactRegime::Frictionless);
    let gain = design_lqr(&model, [1.0, 10.0, 0.1, 0.1], 10.0).unwrap().gain;
    let names = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];
    let gains: Vec<_> = names.into_iter().zip(gain).collect();
    with(draft, &[&gains[..], values].concat())
}

pub(crate) fn budget(scene: &Scene, impacts: u64) -> Budget {
    find_budget(scene, impacts, || true).unwrap()
}

pub(crate) fn of(budget: &Budget, name: Name) -> &ErrorBudget {
    budget.errors.iter().find(|error| error.name == name).unwrap()
}

pub(crate) fn above(budget: &Budget, name: Name) -> &VerdictLimit {
    of(budget, name).above.as_ref().unwrap()
}

pub(crate) fn survives(scene: &Scene, impacts: u64) -> bool {
    run(&mut scene.orbit().unwrap(), impacts, |_| true) == Some(Ending::Completed)
}

/// Largest modulus of the derivative of the map at the fixed point, but for the one of `x` and, if left alone, of drift and energy.
pub(crate) fn largest_modulus(scene: &Scene) -> f64 {
    let place = small_deviations(scene).unwrap().fixed_point;
    let matrix = differences(&ReturnMap::new(&scene.model(), 1), place.x, &place.state(), 1e-6).unwrap();
    eigenvalues(&matrix).unwrap().iter().map(|value| value.norm()).fold(0.0, f64::max)
}
