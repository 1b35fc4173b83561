//! Random scenes by several methods: derivatives against finite differences, error bounds against runs with 31 digits.

use equipoise_physics::body::{Arrival, Body};
use equipoise_physics::bounce::strike::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::dual::Dual;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::method::{RunMethod, run_by};
use equipoise_physics::run::orbit::{Contact, Orbit};
use equipoise_physics::scene::Scene;
use equipoise_physics::stability::jacobian::{finite_difference_at, jacobian_at};

/// t, x, θ, ẋ, ẏ, θ̇ at a contact.
pub(crate) fn numbers(contact: &Contact) -> [f64; 6] {
    let State { theta, x_dot, y_dot, theta_dot } = contact.state;
    [contact.t, contact.x, theta, x_dot, y_dot, theta_dot]
}

/// State just before contact 3 with its derivatives by the one just before contact 1 and by the place there: ρθ, ẋ, ẏ, ρθ̇ and x. `None` if the
/// run ends before.
fn two_bounces_in_duals(scene: &Scene) -> Option<[Dual<5>; 5]> {
    let doubles = scene.orbit().unwrap();
    let body: Body<Dual<5>> = scene.model().map(Dual::from_f64);
    let rho = body.rod.radius_of_gyration;
    let State { theta, x_dot, y_dot, theta_dot } = *doubles.state();
    let along = |value, direction, rate| Dual::along(value, direction, rate);
    let (theta, theta_dot) = (along(theta, 0, 1.0 / rho.value), along(theta_dot, 3, 1.0 / rho.value));
    let state = State { theta, x_dot: along(x_dot, 1, 1.0), y_dot: along(y_dot, 2, 1.0), theta_dot };
    let zero = Dual::from_f64(0.0);
    let mut orbit = Orbit::at(body, scene.rules(), state);
    orbit.resume(0, zero, along(doubles.x(), 4, 1.0), &Arrival::from((zero, state)));
    if orbit.advance().ending.is_some() || orbit.advance().ending.is_some() {
        return None;
    }
    let State { theta, x_dot, y_dot, theta_dot } = *orbit.state();
    Some([rho * theta, x_dot, y_dot, rho * theta_dot, orbit.x()])
}

/// Holds the derivative of two bounces of each scene against finite differences, and against a run in dual numbers. Returns how many were compared.
pub(crate) fn compare_derivatives(scenes: impl Iterator<Item = Scene>) -> usize {
    let mut compared = 0;
    for scene in scenes {
        let orbit = scene.orbit().unwrap();
        let model = scene.model();
        let Ok(exact) = jacobian_at(&model, orbit.x(), orbit.state(), 2) else { continue };
        let estimate = finite_difference_at(&model, orbit.x(), orbit.state(), 2, 1e-6);
        let Some(estimate) = estimate.ok().filter(|_| exact.one_sided.is_empty()) else { continue };
        let size = exact.matrix.abs().max();
        assert!((&exact.matrix - estimate.matrix).abs().max() < 1e-6 * size, "{scene:?}");
        let end = two_bounces_in_duals(&scene).unwrap();
        for (row, column) in
            (0..exact.matrix.nrows()).flat_map(|row| (0..exact.matrix.ncols()).map(move |it| (row, it)))
        {
            let (ours, theirs) = (exact.matrix[(row, column)], end[row].partials[column]);
            assert!((ours - theirs).abs() < 1e-9 * size, "{row} {column}: {ours} {theirs} {scene:?}");
        }
        compared += 1;
    }
    compared
}

/// Holds the error bounds of the runs of some scenes, and their endings, against runs with 31 digits. At least seven in ten contacts have a
/// bound below 1e-3.
pub(crate) fn compare_bounds(scenes: impl Iterator<Item = Scene>) {
    let (mut bounds, mut contacts) = (0, 0);
    for scene in scenes {
        let rho = scene.parameters::<f64>().radius_of_gyration;
        let mut exact = Vec::new();
        let ending = run_by(&scene, RunMethod::Extended, 40, |impact| {
            exact.push(impact.extended.unwrap().1.state);
            true
        });
        contacts += exact.len();
        let mut n = 0;
        let same = run_by(&scene, RunMethod::Map, 40, |impact| {
            let Some(exact) = exact.get(n).filter(|_| impact.error_estimate < 1e-3) else { return true };
            n += 1;
            bounds += 1;
            let ours = impact.contact.state;
            let off = |ours: f64, exact: DoubleDouble| (DoubleDouble::from(ours) - exact).to_f64().abs();
            let turned = off(ours.theta, exact.theta).max(off(ours.theta_dot, exact.theta_dot));
            let error = (rho * turned).max(off(ours.x_dot, exact.x_dot)).max(off(ours.y_dot, exact.y_dot));
            assert!(error <= impact.error_estimate, "{n}: {error:e} {:e} {scene:?}", impact.error_estimate);
            true
        });
        if n == exact.len() {
            assert_eq!(ending.unwrap().unwrap().name(), same.unwrap().unwrap().name());
        }
    }
    assert!(10 * bounds >= 7 * contacts, "{bounds} of {contacts}");
}
