//! Exact identities of the map, at any state: energy, determinant, reversibility, mirror symmetry, and the derivative
//! against eq. (14) and against differences computed with 50 digits.

use crate::support::reference::differences;
use equipoise_physics::analysis::return_map::ReturnMap;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};

use equipoise_physics::analysis::jacobian::jacobian;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::contact_time::{first_contact, first_descent};
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::numbers::trig;
use nalgebra::DMatrix;
use proptest::prelude::*;

prop_compose! {
    fn rods()(length in 0.02..2.0, ratio in 0.2..1.5, tilt_gain in -1.0..3.0) -> Rod {
        Rod::lossless(length, length * ratio, tilt_gain)
    }
}

prop_compose! {
    fn states()(theta in -1.4..1.4, x_dot in -2.0..2.0, y_dot in -5.0..0.5, theta_dot in -40.0..40.0) -> State {
        State { theta, x_dot, y_dot, theta_dot }
    }
}

/// One bounce of a rod: the state at its end and the speed of the contact point at its start and end, where there is one.
fn bounce(rod: &Rod, state: &State) -> Option<(State, f64, f64)> {
    let strike = rod.strike(state);
    if strike.approach >= 0.0 || strike.contact_rise <= 0.0 {
        return None;
    }
    let flight = rod.flight(&strike);
    let end = flight.end(first_contact(&flight).ok()?);
    Some((end, strike.contact_rise, rod.contact_speed(&end)))
}

fn norm(matrix: &DMatrix<f64>) -> f64 {
    matrix.norm()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn energy_is_conserved(rod in rods(), state in states()) {
        let Some((end, ..)) = bounce(&rod, &state) else { return Ok(()) };
        let (before, after) = (rod.energy(&state), rod.energy(&end));
        prop_assert!((before - after).abs() <= 1e-13 * before.abs().max(after.abs()).max(1.0), "{before} {after}");
    }

    #[test]
    fn determinant_is_the_ratio_of_contact_speeds(rod in rods(), state in states()) {
        let Some((_, rise, fall)) = bounce(&rod, &state) else { return Ok(()) };
        if fall.abs() <= 0.05 || rise <= 0.05 {
            return Ok(());
        }
        let matrix = jacobian(&Body::plain(rod), &state, 1).unwrap().matrix;
        let identity = -rise / fall;
        prop_assert!((matrix.determinant() - identity).abs() <= 1e-12 * norm(&matrix).max(1.0), "{matrix} {identity}");
    }

    /// S∘f∘S∘f = identity with S = (flip all velocities) ∘ (impact), at a lossless bounce.
    #[test]
    fn bounces_are_reversible(rod in rods(), state in states()) {
        let flip = |state: State| State { x_dot: -state.x_dot, y_dot: -state.y_dot, theta_dot: -state.theta_dot, ..state };
        let s = |state: &State| flip(rod.strike(state).after);
        let Some((end, rise, fall)) = bounce(&rod, &state) else { return Ok(()) };
        if fall.abs() <= 0.05 || rise <= 0.05 {
            return Ok(());
        }
        let back = s(&end);
        let Some((start, ..)) = bounce(&rod, &back) else { return Ok(()) };
        let start = s(&start);
        let size = norm(&jacobian(&Body::plain(rod), &state, 1).unwrap().matrix);
        let scale = 1e-13 * size * size * (1.0 + state.theta_dot.abs());
        for (ours, original) in [
            (start.theta, state.theta),
            (start.x_dot, state.x_dot),
            (start.y_dot, state.y_dot),
            (start.theta_dot, state.theta_dot),
        ] {
            prop_assert!((ours - original).abs() <= scale, "{state:?} {start:?}");
        }
    }

    #[test]
    fn left_and_right_are_the_same(rod in rods(), state in states()) {
        let mirror = |state: State| State {
            theta: -state.theta, x_dot: -state.x_dot, theta_dot: -state.theta_dot, ..state
        };
        let ours = bounce(&rod, &state).map(|(end, ..)| mirror(end));
        prop_assert_eq!(ours, bounce(&rod, &mirror(state)).map(|(end, ..)| end));
    }

    /// An independent search: march with a bound on the curvature of the gap, which passes no root.
    #[test]
    fn contact_time_is_the_first(
        rod in rods(), state in states(), clearance in prop_oneof![Just(0.0), 0.0..0.5], y_dot in -3.0..5.0, fast in any::<bool>()
    ) {
        let theta_dot = if fast { 5.0 * state.theta_dot } else { state.theta_dot };
        let start = State { y_dot, theta_dot, ..state };
        let flight = Flight {
            start,
            sin_cos_theta: trig::sin_cos(state.theta),
            clearance,
            contact_distance: rod.contact_distance,
            gravity: rod.gravity,
            drag: None,
        };
        if clearance <= 1e-9 && flight.gap(0.0).slope <= 1e-6 {
            return Ok(());
        }
        let found = first_contact(&flight).unwrap();
        let curvature = rod.gravity + rod.contact_distance * theta_dot * theta_dot;
        let mut t = 0.0;
        for step in 0.. {
            let gap = if t == 0.0 { flight.gap(0.0).slope } else { flight.gap(t).slope };
            let value = if t == 0.0 { clearance } else { flight.gap(t).value };
            if value < 1e-12 && t > 0.0 {
                break;
            }
            t += 0.9999 * (gap + (gap * gap + 2.0 * curvature * value).sqrt()) / curvature;
            prop_assert!(step < 2_000_000);
        }
        // The march stops just before the first root, or where the gap all but grazes; there either answer is right.
        let grazing = flight.gap(t).slope.abs() < 1e-4;
        prop_assert!((found - t).abs() <= 1e-7 || grazing, "found {found}, marched {t}");
        prop_assert!(flight.gap(found).value.abs() <= 1e-11 * (1.0 + curvature), "{}", flight.gap(found).value);
    }
}

/// Flights whose ends were lost in rounding, or in a guess that was wrong by powers of ten; roots with 40 digits.
#[test]
fn contact_times_keep_their_digits_in_odd_flights() {
    for (theta, theta_dot, y_dot, clearance, contact_distance, gravity, expected) in [
        // l θ̇² = G.
        (-3.575_374_014_647_543_6e-8, 1.0, 1.140_000_478_658_209_2, 0.0, 0.001, 0.001, 2_280.001_220_253_364),
        // Downwards in little gravity: spinning, straight, and from next to nothing.
        (5.000_002_404_418_193e-10, TAU, -1.2, 5.000_002_404_418_193e-10, 10.0, 0.001, 4.166_669_065_010_124e-10),
        (PI, 0.0, -1.853_520_685_703_823_1, FRAC_PI_2, 0.2, 0.001, 0.847_272_654_377_277),
        (-0.348, 0.0015, -188.306_087_800_164_16, 1e-9, 0.0015, 0.001, 5.310_502_743_737_77e-12),
        (
            2.651_127_687_818_921e-6,
            -1.570_796_326_794_896_8,
            -1.570_796_326_794_896_8,
            2.651_127_687_818_921e-6,
            10.0,
            0.001,
            1.687_737_931_889_607_9e-6,
        ),
    ] {
        let start = State { theta, x_dot: 0.0, y_dot, theta_dot };
        let flight =
            Flight { start, sin_cos_theta: trig::sin_cos(theta), clearance, contact_distance, gravity, drag: None };
        for found in [first_contact(&flight).ok(), first_descent(&flight).unwrap()] {
            let off = (found.unwrap() - expected).abs() / expected;
            assert!(off <= 1e-9, "{found:?}, not {expected}: {flight:?}");
        }
    }
}

#[test]
fn fixed_point_jacobian_is_equation_14_with_the_energy_term() {
    for (tilt_gain, restitution, energy_gain, y) in
        [(1.1, 1.0, 0.0, -1.1437), (1.5, 1.0, 0.0, -1.1437), (1.1, 0.5, 0.165, -1.2719), (0.3, 0.2, 0.4, -2.0)]
    {
        let (l, rho, gravity) = (0.4 / 3.0, SQRT_2 / 15.0, 6.937);
        let model = Rod {
            restitution,
            gravity,
            strike_gain_per_energy: (1.0 + restitution) * energy_gain,
            target_energy: gravity * l + 0.5 * y * y,
            ..Rod::lossless(l, rho, tilt_gain)
        };
        let state = State { theta: 0.0, x_dot: 0.0, y_dot: y, theta_dot: 0.0 };
        let matrix = jacobian(&Body::plain(model), &state, 1).unwrap().matrix;
        #[rustfmt::skip]
        let expected = DMatrix::from_row_slice(4, 4, &[
            1.0 + 4.0 * y * y * (1.0 - tilt_gain) * l / (gravity * rho * rho), 0.0, 0.0, -2.0 * y / gravity,
            2.0 * y * tilt_gain / rho, 1.0, 0.0, 0.0,
            0.0, 0.0, 1.0 - (1.0 + restitution) * energy_gain * y * y, 0.0,
            2.0 * y * (tilt_gain - 1.0) * l / (rho * rho), 0.0, 0.0, 1.0,
        ]);
        let difference = (&matrix - &expected).abs().max();
        assert!(difference <= 1e-13 * norm(&expected).max(1.0), "{difference:e} {matrix} {expected}");
    }
}

#[test]
fn derivatives_agree_with_differences_of_50_digits() {
    let samples: serde_json::Value =
        serde_json::from_str(include_str!("../../../tests/oracle/jacobians.json")).unwrap();
    let mut worst: f64 = 0.0;
    for sample in samples.as_array().unwrap() {
        let number = |group: &str, name: &str| sample[group][name].as_f64().unwrap();
        let body = |name| number("body", name);
        let model = Rod {
            gravity: body("gravity"),
            restitution: body("restitution"),
            strike_gain_per_energy: (1.0 + body("restitution")) * body("energy_gain"),
            target_energy: body("gravity") * body("target_height"),
            ..Rod::lossless(body("contact_distance"), body("radius_of_gyration"), body("tilt_gain"))
        };
        let state = State {
            theta: number("state", "theta"),
            x_dot: number("state", "x_dot"),
            y_dot: number("state", "y_dot"),
            theta_dot: number("state", "theta_dot"),
        };
        let linearization = jacobian(&Body::plain(model), &state, 1).unwrap();
        let expected = DMatrix::from_fn(4, 4, |row, column| sample["matrix"][row][column].as_f64().unwrap());
        let error = norm(&(&linearization.matrix - &expected)) / norm(&expected);
        assert!(error <= 1e-11, "{error:e} {sample}");
        assert!((linearization.contact_speed - sample["contact_speed"].as_f64().unwrap()).abs() <= 1e-11);
        let differences = differences(&ReturnMap::new(&Body::plain(model), 1), 0.0, &state, 1e-6).unwrap();
        let rough = norm(&(&differences - &expected)) / norm(&expected);
        assert!(rough <= 1e-4, "{rough:e} {sample}");
        worst = worst.max(error);
    }
    println!("worst relative error {worst:.1e}");
}

#[test]
fn period_two_orbits_beyond_the_boundary_are_exact() {
    // Gρ²θ cos κθ = V²l sin((κ − 1)θ) at (θ, V tan κθ, −V, Gθ/V): the mirror image after one bounce.
    let (l, rho, gravity, kappa, theta) = (0.4 / 3.0, 0.094, 9.81, 1.6, 0.2_f64);
    let speed = (gravity * rho * rho * theta * (kappa * theta).cos() / (l * ((kappa - 1.0) * theta).sin())).sqrt();
    let state =
        State { theta, x_dot: speed * (kappa * theta).tan(), y_dot: -speed, theta_dot: gravity * theta / speed };
    let (end, ..) = bounce(&Rod::lossless(l, rho, kappa), &state).unwrap();
    for (ours, exact) in [
        (end.theta, -state.theta),
        (end.x_dot, -state.x_dot),
        (end.y_dot, state.y_dot),
        (end.theta_dot, -state.theta_dot),
    ] {
        assert!((ours - exact).abs() <= 1e-14, "{end:?} {state:?}");
    }
}
