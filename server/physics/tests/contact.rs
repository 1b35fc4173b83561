//! Motion in lasting contact.

use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::contact::{ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest, HoldSample, Touching, hold};
use equipoise_physics::control::care;
use equipoise_physics::table::control_law::Gains;
use nalgebra::{SMatrix, SVector};

fn paper() -> Rod {
    Rod::lossless(0.4 / 3.0, 2.0_f64.sqrt() / 15.0, 1.1)
}

const K_HOLD: Gains = Gains {
    x: 0.31622776601683744,
    theta: -2.9078091755454114,
    x_dot: 0.36468808214939585,
    theta_dot: -0.24630265177569016,
};

fn request(law: HoldLaw, start: ContactStart) -> HoldRequest {
    HoldRequest {
        rod: paper(),
        touching: Touching::Frictionless,
        outline: None,
        law,
        brake_law: None,
        start,
        brake: None,
        duration: 6.0,
        topple_angle: std::f64::consts::FRAC_PI_2,
        limits: None,
    }
}

fn held(request: &HoldRequest) -> Hold {
    hold(request, &mut || true)
}

/// The beginning of the hold of the reference, after nine strikes.
const AFTER_NINE_STRIKES: ContactStart = ContactStart {
    t: 0.4640648540424104,
    x: -0.07497221119142874,
    theta: -0.039752288759362424,
    x_dot: -0.16716153532158537,
    theta_dot: -0.01613867682200944,
    table_speed: 0.0,
};

/// Case 1's body at its first contact from 0.25 m, with a table that meets it at its own speed.
const MET: ContactStart = ContactStart {
    t: 0.1546643321840389,
    x: 0.0,
    theta: 0.1,
    x_dot: 0.0,
    theta_dot: 0.0,
    table_speed: -1.5172570987254217,
};

/// The reference was sampled every 4 ms (8 s in 1999 steps); its times are those of the last sample out of the band.
#[test]
fn the_hold_of_the_reference_comes_to_rest_at_its_times() {
    let hold = held(&request(HoldLaw::Feedback(K_HOLD), AFTER_NINE_STRIKES));
    assert_eq!(hold.ending, HoldEnding::Completed);
    for (within, last_out) in [(hold.theta_within, 3.965815729480129), (hold.x_within, 5.446556099665222)] {
        let late = within.unwrap() - last_out;
        assert!((0.0..8.0 / 1999.0).contains(&late), "{late}");
    }
    assert!(hold.error_bound < 1e-7, "{:e}", hold.error_bound);
    assert_eq!(hold.samples.len(), 601);
}

#[test]
fn a_braking_table_needs_the_stroke_and_the_tilt_of_the_reference() {
    let law = |gravity| HoldLaw::Feedback(contact_gains(gravity));
    let request = HoldRequest { brake: Some(9.81), brake_law: Some(law(2.0 * 9.81)), ..request(law(9.81), MET) };
    let hold = held(&request);
    assert_eq!(hold.ending, HoldEnding::Completed);
    // (h − l cos θ)G/a, with the speed of the fall.
    let stroke = MET.table_speed * MET.table_speed / (2.0 * 9.81);
    assert!((hold.load.stroke - stroke).abs() < 1e-15 && (stroke - 0.117).abs() < 5e-4, "{}", hold.load.stroke);
    assert!((hold.load.tilt - 0.298).abs() < 5e-4, "{}", hold.load.tilt);
    assert!(hold.most_theta <= 0.1 && hold.theta_within.is_some() && hold.x_within.is_some());
    // The body weighs G + a until the table stands.
    let stands = MET.t - MET.table_speed / 9.81;
    let heavy = |sample: &HoldSample| sample.normal_force > 1.5 * 9.81;
    assert!(hold.samples.iter().all(|it| heavy(it) == (it.t < stands)));
}

/// The time of the stop is rounded, and the body weighs G after it at every one.
#[test]
fn a_table_that_has_braked_stands_at_every_time() {
    let law = HoldLaw::Feedback(contact_gains(9.81));
    for n in 0..200 {
        let speed = if n % 2 == 0 { -3e-3 } else { 3e-3 };
        let start = ContactStart { t: 0.1 + 0.003_7 * f64::from(n), table_speed: speed, ..AFTER_NINE_STRIKES };
        let request = HoldRequest { brake: Some(4.9), duration: 0.5, ..request(law, start) };
        let hold = held(&request);
        let last = hold.samples.last().unwrap().normal_force;
        assert!((last - 9.81).abs() < 0.1, "{n}: {last}");
    }
}

/// K of sliding contact with the weights of the reference: ẍ = −Gα, θ̈ = (Gl/ρ²)(θ − α).
fn contact_gains(gravity: f64) -> Gains {
    let rod = paper();
    let turn = gravity * rod.contact_distance / (rod.radius_of_gyration * rod.radius_of_gyration);
    let mut a = SMatrix::<f64, 4, 4>::zeros();
    (a[(0, 2)], a[(1, 3)], a[(3, 1)]) = (1.0, 1.0, turn);
    let b = SVector::from([0.0, 0.0, -gravity, -turn]);
    let gain = care::solve(&a, &b, &SVector::from([1.0, 10.0, 0.1, 0.1]), 10.0).unwrap().gain;
    Gains { x: gain[0], theta: gain[1], x_dot: gain[2], theta_dot: gain[3] }
}
