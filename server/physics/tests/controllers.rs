//! Controllers for any rig: what the design predicts against the derivative of the map of the designed scene and against its runs.

use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random::Random;
use crate::support::rig_runs::{self, with, worded};
use equipoise_physics::analysis::gain_range::StableGains;
use equipoise_physics::analysis::jacobian::{eigenvalues, modulus};
use equipoise_physics::analysis::return_map::{COMPONENTS, ReturnMap, Vector, X, X_DOT, Y_DOT};
use equipoise_physics::control::bounce_model::states;
use equipoise_physics::control::controller::{Controller, ControllerFailure, Wanted, design_controller};
use equipoise_physics::control::lqr::{DesignFailure, design_lqr};
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene};

const STATE: [f64; 4] = [1.0, 10.0, 0.1, 0.1];

fn designed(scene: &Scene, state: [f64; 4]) -> Result<Controller, ControllerFailure> {
    design_controller(scene, &Wanted { friction: scene.model().friction, state, input: 10.0 })
}

/// The map of a designed scene and its fixed point.
fn map(controller: &Controller) -> (ReturnMap, Vector) {
    let (body, place) = (controller.scene.model(), &controller.place);
    let map = ReturnMap::new(&body, 1);
    let mut at = [0.0; COMPONENTS];
    (at[X_DOT], at[Y_DOT], at[X]) = (place.x_dot, -place.speed, place.x);
    if body.lag > place.flight_time {
        let map = map.planning();
        return (map, map.planned(&at));
    }
    (map, at)
}

/// The place is a fixed point of the map, and the closed loop that the design predicts is the part of its derivative that the height does not
/// act on. Returns the largest distance of a predicted eigenvalue from one of the map.
fn check(controller: &Controller, what: &dyn std::fmt::Debug) -> f64 {
    let (map, at) = map(controller);
    let there = map.derivative(&at).unwrap();
    let off = (map.reduced(&there.image) - map.reduced(&at)).amax();
    assert!(off <= 1e-11 * (1.0 + controller.place.speed), "{what:?}: {off}");
    let found = eigenvalues(&there.matrix).unwrap();
    let heights = found.iter().map(|other| (other.re - controller.height).hypot(other.im));
    assert!(heights.fold(f64::INFINITY, f64::min) <= 1e-7, "{what:?}: {} {found:?}", controller.height);
    let (gain, rho) = (controller.design.gain, controller.scene.model().rod.radius_of_gyration);
    let states: &[usize] = if gain[0] == 0.0 { &[1, 2, 3] } else { &[0, 1, 2, 3] };
    if map.components().len() <= 5 {
        let loop_of = controller.own.part(gain, states);
        let (places, units) = ([4, 0, 1, 3], [1.0, rho, 1.0, rho]);
        for (row, &own) in states.iter().enumerate() {
            for (column, &by) in states.iter().enumerate() {
                let exact = there.matrix[(places[own], places[by])] * units[by] / units[own];
                let close = (loop_of[(row, column)] - exact).abs() <= 1e-10 * (1.0 + loop_of.amax());
                assert!(close, "{what:?} [{row}, {column}]: {} {exact}", loop_of[(row, column)]);
            }
        }
    }
    let predicted = controller.own.closed_loop_of(gain, states).unwrap();
    let beside = predicted.eigenvalues.iter().map(|value| {
        let nearest = found.iter().map(|other| modulus(other - value));
        nearest.fold(f64::INFINITY, f64::min)
    });
    beside.fold(0.0, f64::max)
}

/// A run beside the bounce in place loses its deviation at the rate of the largest eigenvalue.
fn decays(controller: &Controller, what: &dyn std::fmt::Debug) {
    let (body, place) = (controller.scene.model(), &controller.place);
    let gain = controller.design.gain;
    let radius_of = |factor: f64| {
        controller.own.closed_loop(gain.map(|gain| factor * gain), gain[0] != 0.0).unwrap().spectral_radius
    };
    let radius = radius_of(1.0);
    let StableGains { lower, upper } = controller.own.stable_factors(gain, states(gain[0] != 0.0)).unwrap();
    assert!(0.0 < lower && lower < 1.0 && upper > 1.0 && upper.is_finite(), "{what:?}");
    for end in [lower, upper] {
        let [inside, outside] = [-1e-3, 1e-3].map(|step| radius_of(end + step * (end - 1.0)));
        assert!(inside < 1.0 && outside > 1.0, "{what:?}: {end} {inside} {outside}");
    }
    let mut start = place.state();
    start.theta = 1e-5;
    let mut orbit = Orbit::at(body, Rules::BARE_MAP, start).moved(place.x + 1e-5);
    let mut sizes = Vec::new();
    run(&mut orbit, 400, |contact| {
        let spin = contact.state.theta_dot * place.flight_time;
        let size = contact.state.theta.abs().max(spin.abs()).max((contact.state.x_dot - place.x_dot).abs());
        sizes.push(if gain[0] == 0.0 { size } else { size.max((contact.x - place.x).abs()) });
        true
    });
    // From the largest deviation down to near rounding, or to the end of the run.
    let until = sizes.iter().position(|size| *size <= 1e-11).unwrap_or(sizes.len() - 1);
    let decades = -libm::log10(sizes[until] / 1e-5);
    let expected = -libm::log10(radius) * until as f64;
    assert!(sizes.len() > until, "{what:?}");
    assert!(decades > 0.7 * expected - 2.0, "{what:?}: {decades} decades in {until} bounces, {expected} expected");
}

/// Rigs that are not as they are told to be.
const RIGS: [&[&str]; 7] = [
    &["angle bias", "tilt offset", "offset"],
    &["gain error"],
    &["speed error", "wrong belief"],
    &["delay"],
    &["turning", "turning in place", "turning, corrected"],
    &["drag", "wind"],
    &["rotation drag"],
];

#[test]
fn predicted_eigenvalues_are_those_of_the_map_of_any_rig() {
    let mut random = Random::new(23);
    let features = all_but(&["program", "still", "feedback", "feedback of the angle", "point mass"]);
    let features: Vec<_> = features.into_iter().filter(|name| !RANDOM.contains(name)).collect();
    let mut counts = RIGS.map(|_| 0);
    let (mut laws, mut none, mut unsolved, mut inaccurate, mut rounded) = (0, 0, 0, 0, 0);
    for _ in 0..700 {
        let mix = Mix::draw(&mut random, Swing::Calm, &features);
        match designed(&mix.scene, STATE) {
            Ok(controller) => {
                laws += 1;
                for (count, features) in counts.iter_mut().zip(RIGS) {
                    *count += u32::from(mix.has(features));
                }
                let beside = check(&controller, &mix.features);
                // Those near each other move by roots of the rounding.
                assert!(beside <= 1e-6, "{:?}: {beside}", mix.features);
                rounded += u32::from(beside > 1e-9);
                decays(&controller, &mix.features);
            }
            Err(ControllerFailure::NoBounce(why)) => {
                none += 1;
                // The air or a table of the wrong speed takes what nothing gives back, or the bounce is off the table.
                let takes = mix.has(&["drag", "wind", "wrong belief", "speed error", "delay"]);
                let turned = why.contains("do not come together");
                unsolved += u32::from(turned);
                assert!(takes || turned || why.contains("end of the table"), "{:?}: {why}", mix.features);
            }
            Err(ControllerFailure::Design(DesignFailure::Inaccurate(_))) => inaccurate += 1,
            // A table that plans before the last strike can hardly steer.
            Err(ControllerFailure::Design(DesignFailure::Diverging)) if mix.has(&["delay"]) => inaccurate += 1,
            Err(other) => panic!("{:?}: {other:?} {:?}", mix.features, mix.scene),
        }
    }
    assert!(counts.into_iter().all(|count| count >= 4), "{counts:?}");
    assert!(
        laws > 200 && unsolved < 5 && inaccurate < 10 && rounded < laws / 50,
        "{laws} laws, {none} scenes without a bounce, {inaccurate} inaccurate, {rounded} rounded"
    );
}

/// The paper's rod, its height held, with further fields.
fn held(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Scene {
    let rod = rig_runs::scene(&[(Name::Theta, 0.02), (Name::TargetHeight, 0.2), (Name::EnergyGain, 0.2)]);
    with(worded(rod.draft(), words), numbers)
}

#[test]
fn a_law_for_a_delay_is_that_of_the_table_that_sees_through_it() {
    let seen = designed(&held(&[], &[]), STATE).unwrap().design.gain;
    let predicted = designed(&held(&[(Name::Delay, 3e-3)], &[(Name::Prediction, "flight")]), STATE).unwrap();
    assert_eq!(predicted.design.gain, seen);
    // −K·(x − τẋ, θ − τθ̇, ẋ, θ̇) is the same tilt with K_ẋ + τK_x and K_θ̇ + τK_θ, at a bounce of another height.
    let late = designed(&held(&[(Name::Delay, 3e-3)], &[]), STATE).unwrap();
    let mut ideal = late.model;
    ideal.sensed = nalgebra::Matrix4::identity();
    let [x, theta, x_dot, theta_dot] = design_lqr(&ideal, STATE, 10.0).unwrap().gain;
    for (told, ideal) in late.design.gain.into_iter().zip([x, theta, x_dot + 3e-3 * x, theta_dot + 3e-3 * theta]) {
        assert!((told - ideal).abs() <= 1e-14 * theta.abs(), "{told} {ideal}");
    }
    // Longer than the flights: the table strikes by the beginning of each.
    let longer = designed(&held(&[(Name::Delay, 0.25), (Name::EnergyGain, 0.0)], &[]), STATE).unwrap();
    assert!(longer.place.flight_time < 0.25);
    assert!(check(&longer, &"longer") <= 1e-9);
    decays(&longer, &"longer");
}

#[test]
fn a_table_that_errs_is_told_more_or_less() {
    let plain = designed(&held(&[], &[]), STATE).unwrap();
    let errs = designed(&held(&[(Name::TiltGainError, 0.25), (Name::TiltOffset, 0.01)], &[]), STATE).unwrap();
    for (told, plain) in errs.design.gain.into_iter().zip(plain.design.gain) {
        assert!((1.25 * told - plain).abs() <= 1e-13 * plain.abs(), "{told} {plain}");
    }
    assert!((errs.place.x - 0.01 / plain.design.gain[0]).abs() < 1e-12, "{:?}", errs.place);
    // Off a short table, and without a gain on x a table through air never stands upright.
    let short = held(&[(Name::TiltOffset, 0.01), (Name::TableLength, 0.01)], &[]);
    let no_bounce = |scene: &Scene, state| match designed(scene, state) {
        Err(ControllerFailure::NoBounce(why)) => why,
        other => panic!("{other:?}"),
    };
    assert!(no_bounce(&short, STATE).contains("beyond the end of the table"));
    let air = held(&[(Name::TiltOffset, 0.01), (Name::Drag, 0.05)], &[]);
    assert!(no_bounce(&air, [0.0, 10.0, 0.1, 0.1]).contains("give x a weight"));
    check(&designed(&air, STATE).unwrap(), &"air");
    // Without air it moves on at the speed at which the table is level.
    let moving = designed(&held(&[(Name::TiltOffset, 0.01)], &[]), [0.0, 10.0, 0.1, 0.1]).unwrap();
    assert!((moving.place.x_dot - 0.01 / moving.design.gain[2]).abs() < 1e-12, "{:?}", moving.place);
    check(&moving, &"moving");
}
