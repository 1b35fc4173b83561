//! Motion in lasting contact.

use equipoise_physics::catching::aim::contact_gain;
use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Catch, CatchOutcome};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::control::riccati;
use equipoise_physics::control::riccati::Step;
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::polygon::{Outline, Vertices};
use equipoise_physics::map::strike::{PlannedTableMotion, Rod, State};
use equipoise_physics::map::table::actuator_load::{ActuatorLimits, Pose};
use equipoise_physics::map::table::control_law::Gains;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{
    ContactMotion, ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest, HoldSample, TangentialForce, hold, rest_of_run,
};
use equipoise_physics::run::orbit::{ComingContact, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene, Value};
use nalgebra::{DMatrix, DVector};

use crate::support::random::Random;
use crate::support::rig::scene;

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
    let rules = Rules { topple_angle: std::f64::consts::FRAC_PI_2, ..Rules::BARE_MAP };
    HoldRequest::new(&Body::plain(paper()), &rules, law, start, 6.0)
}

/// A table at rest at this tilt, rad.
fn tilted(alpha: f64) -> Pose {
    Pose { alpha, velocity: (0.0, 0.0) }
}

/// The contact with this friction, if any.
fn rough(request: HoldRequest, friction: Option<(f64, Slide)>) -> HoldRequest {
    let friction = friction.map(|(coefficient, slide)| Friction { coefficient, law: RestitutionLaw::Poisson, slide });
    HoldRequest { body: Body { friction, ..request.body }, ..request }
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
    before: None,
};

/// Case 1's body at its first contact from 0.25 m, with a table that meets it at its own speed.
const MET: ContactStart = ContactStart {
    t: 0.1546643321840389,
    x: 0.0,
    theta: 0.1,
    x_dot: 0.0,
    theta_dot: 0.0,
    table_speed: -1.5172570987254217,
    before: None,
};

/// The reference was sampled every 4 ms (8 s in 1999 steps); its times are those of the last sample out of the band.
#[test]
fn the_hold_of_the_reference_comes_to_rest_at_its_times() {
    let hold = held(&request(HoldLaw::Tilting(K_HOLD, 0.0), AFTER_NINE_STRIKES));
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
    let law = |gravity| HoldLaw::Tilting(contact_gains(gravity), 0.0);
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
    let law = HoldLaw::Tilting(contact_gains(9.81), 0.0);
    for n in 0..200 {
        let speed = if n % 2 == 0 { -3e-3 } else { 3e-3 };
        let start = ContactStart { t: 0.1 + 0.003_7 * f64::from(n), table_speed: speed, ..AFTER_NINE_STRIKES };
        let request = HoldRequest { brake: Some(4.9), duration: 0.5, ..request(law, start) };
        let hold = held(&request);
        let last = hold.samples.last().unwrap().normal_force;
        assert!((last - 9.81).abs() < 0.1, "{n}: {last}");
    }
}

/// Weights of the reference.
fn weights() -> DVector<f64> {
    DVector::from_column_slice(&[1.0, 10.0, 0.1, 0.1])
}

/// K of sliding contact with the weights of the reference: ẍ = −Gα, θ̈ = (Gl/ρ²)(θ − α).
fn contact_gains(gravity: f64) -> Gains {
    let rod = paper();
    let turn = gravity * rod.contact_distance / (rod.radius_of_gyration * rod.radius_of_gyration);
    let mut a = DMatrix::zeros(4, 4);
    (a[(0, 2)], a[(1, 3)], a[(3, 1)]) = (1.0, 1.0, turn);
    let b = DVector::from_column_slice(&[0.0, 0.0, -gravity, -turn]);
    let gain = riccati::solve(Step::Time, &a, &b, &weights(), 10.0).unwrap().gain;
    Gains { x: gain[0], theta: gain[1], x_dot: gain[2], theta_dot: gain[3] }
}

#[test]
fn a_level_table_keeps_the_energy() {
    let start =
        ContactStart { t: 0.0, x: 0.1, theta: 0.05, x_dot: 0.2, theta_dot: -0.3, table_speed: 0.0, before: None };
    let rod = paper();
    let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
    let energy = |it: &HoldSample, sticks: f64| {
        let (sin, cos) = it.theta.sin_cos();
        let along = sticks * l * cos * it.theta_dot;
        let up = l * sin * it.theta_dot;
        0.5 * (along * along + up * up + rho * rho * it.theta_dot * it.theta_dot) + rod.gravity * l * cos
    };
    let level = request(HoldLaw::tilt_gain(0.0), start);
    let smooth = held(&level);
    // The body falls; the table has nothing to pull it back with.
    assert!(matches!(smooth.ending, HoldEnding::Ended(Ending::Toppled { .. })));
    let begin = energy(&smooth.samples[0], 0.0);
    for sample in &smooth.samples {
        assert!((energy(sample, 0.0) - begin).abs() < 1e-7 && (sample.x_dot - 0.2).abs() < 1e-15, "{sample:?}");
    }
    // A contact that sticks turns about its point.
    let x_dot = -l * start.theta.cos() * start.theta_dot;
    let stuck = HoldRequest { start: ContactStart { x_dot, ..start }, ..level };
    let stuck = held(&rough(stuck, Some((50.0, Slide::None))));
    let begin = energy(&stuck.samples[0], 1.0);
    assert!(stuck.samples.len() > 50);
    for sample in &stuck.samples {
        assert!((energy(sample, 1.0) - begin).abs() < 1e-7, "{sample:?}");
        assert!((sample.x + l * sample.theta.sin() - stuck.samples[0].x - l * start.theta.sin()).abs() < 1e-7);
    }
}

#[test]
fn a_mirrored_hold_is_the_mirror_of_the_hold() {
    let start =
        ContactStart { t: 0.0, x: 0.03, theta: 0.1, x_dot: -0.1, theta_dot: 0.4, table_speed: -0.5, before: None };
    let mirrored = ContactStart { x: -0.03, theta: -0.1, x_dot: 0.1, theta_dot: -0.4, ..start };
    for friction in [None, Some((0.3, Slide::Matched)), Some((0.2, Slide::None))] {
        let of = |start| {
            let smooth = HoldRequest { brake: Some(3.0), ..request(HoldLaw::Tilting(K_HOLD, 0.0), start) };
            held(&rough(smooth, friction))
        };
        let (one, other) = (of(start), of(mirrored));
        assert_eq!((one.ending, one.t_end, one.samples.len()), (other.ending, other.t_end, other.samples.len()));
        for (one, other) in one.samples.iter().zip(&other.samples) {
            assert_eq!((one.x, one.theta, one.theta_dot), (-other.x, -other.theta, -other.theta_dot));
            assert_eq!(one.normal_force, other.normal_force);
        }
    }
}

/// Fourth-order Runge-Kutta with 31 digits over the same equations.
fn extended(start: &ContactStart, gains: &Gains, duration: f64) -> [f64; 4] {
    type N = DoubleDouble;
    let number = |value: f64| N::from(value);
    let rod = paper().lift::<N>();
    let gains = [gains.x, gains.theta, gains.x_dot, gains.theta_dot].map(number);
    let rates = |s: [N; 4]| {
        let alpha = -(gains[0] * s[0] + gains[1] * s[1] + gains[2] * s[2] + gains[3] * s[3]);
        let motion =
            ContactMotion::new(&rod, rod.gravity, [s[1], s[3], alpha], TangentialForce::Sliding(number(0.0)), None);
        [s[2], s[3], motion.x_ddot, motion.theta_ddot]
    };
    let steps = 10_000;
    let h = number(duration / f64::from(steps));
    let moved = |s: [N; 4], k: [N; 4], h: N| std::array::from_fn(|i| s[i] + h * k[i]);
    let mut s = [start.x, start.theta, start.x_dot, start.theta_dot].map(number);
    let (half, sixth, two) = (h * number(0.5), h / number(6.0), number(2.0));
    for _ in 0..steps {
        let k1 = rates(s);
        let k2 = rates(moved(s, k1, half));
        let k3 = rates(moved(s, k2, half));
        let k4 = rates(moved(s, k3, h));
        s = std::array::from_fn(|i| s[i] + sixth * (k1[i] + two * (k2[i] + k3[i]) + k4[i]));
    }
    s.map(|it| it.to_f64())
}

#[test]
fn the_error_is_within_its_bound() {
    let mut random = Random::new(16);
    for _ in 0..6 {
        let start = ContactStart {
            t: 0.0,
            x: random.between(-0.1, 0.1),
            theta: random.between(-0.2, 0.2),
            x_dot: random.between(-0.2, 0.2),
            theta_dot: random.between(-1.0, 1.0),
            table_speed: 0.0,
            before: None,
        };
        let hold = held(&HoldRequest { duration: 1.0, ..request(HoldLaw::Tilting(K_HOLD, 0.0), start) });
        assert_eq!(hold.ending, HoldEnding::Completed);
        let last = hold.samples.last().unwrap();
        let [x, theta, x_dot, theta_dot] = extended(&start, &K_HOLD, 1.0);
        let rho = paper().radius_of_gyration;
        let differences =
            [last.x - x, rho * (last.theta - theta), last.x_dot - x_dot, rho * (last.theta_dot - theta_dot)];
        let error = differences.iter().fold(0.0_f64, |worst, it| worst.max(it.abs()));
        assert!(error <= hold.error_bound && hold.error_bound < 1e-6, "{error:e} {:e}", hold.error_bound);
    }
}

/// K for a contact that sticks, with the weights of sliding contact: a table that tilts by α pushes with about Gα.
fn cart_pole_gains(input: f64) -> Gains {
    let Rod { contact_distance: l, radius_of_gyration: rho, gravity, .. } = paper();
    let about_contact = l * l + rho * rho;
    let mut a = DMatrix::zeros(4, 4);
    (a[(0, 2)], a[(1, 3)]) = (1.0, 1.0);
    (a[(2, 1)], a[(3, 1)]) = (-l * l * gravity / about_contact, l * gravity / about_contact);
    let b = DVector::from_column_slice(&[0.0, 0.0, rho * rho / about_contact, l / about_contact]);
    let gain = riccati::solve(Step::Time, &a, &b, &weights(), input).unwrap().gain;
    Gains { x: gain[0], theta: gain[1], x_dot: gain[2], theta_dot: gain[3] }
}

#[test]
fn a_cart_balances_a_contact_that_sticks() {
    let start = ContactStart { t: 0.0, x: 0.0, theta: 0.1, x_dot: 0.0, theta_dot: 0.0, table_speed: 0.0, before: None };
    // A dear input needs less friction and more travel.
    for (input, friction, travel) in [(0.005, 0.31, 0.058), (0.02, 0.221, 0.071), (1.0, 0.149, 0.157)] {
        let law = HoldLaw::CartPole { gains: cart_pole_gains(input), acceleration: 0.0, tilt: 0.0 };
        let request = rough(request(law, start), Some((2.0, Slide::None)));
        let hold = held(&request);
        assert!((hold.least_friction - friction).abs() < 5e-3 && (hold.travel - travel).abs() < 1e-3, "{hold:?}");
        assert_eq!(hold.ending, HoldEnding::Completed);
        assert!(hold.theta_within.is_some());
        // With less friction it slips, and says how much it needs.
        let slippery = held(&rough(request, Some((0.9 * hold.least_friction, Slide::None))));
        assert!(
            matches!(slippery.ending, HoldEnding::Slipped { needed } if needed > 0.9 * hold.least_friction * 0.999)
        );
        // The force is that of Newton's law: F = ẍ, N = G + ÿ.
        for three in hold.samples[..600].windows(3) {
            let second = (three[2].x - 2.0 * three[1].x + three[0].x) / 1e-4;
            assert!((second - three[1].tangential_force).abs() < 0.1, "{second} {}", three[1].tangential_force);
        }
    }
}

/// The paper's triangle, on the left end of its base.
fn on_its_base(theta_off: f64, theta_dot: f64, friction: Option<(f64, Slide)>) -> HoldRequest {
    let vertices = Vertices::new(&[[-0.05, 0.0], [0.05, 0.0], [0.0, 0.2]]).unwrap();
    let outline = Outline::new(&vertices, 0).unwrap();
    let flat = -libm::atan2(0.05, 0.2 / 3.0);
    let theta = flat + theta_off;
    // The vertex rests.
    let x_dot = -outline.contact_distance * theta.cos() * theta_dot;
    let start = ContactStart { t: 0.0, x: 0.0, theta, x_dot, theta_dot, table_speed: 0.0, before: None };
    let rod =
        Rod { contact_distance: outline.contact_distance, radius_of_gyration: outline.radius_of_gyration, ..paper() };
    let body = Body { outline: Some(outline), ..Body::plain(rod) };
    let rules = Rules { topple_angle: 3.0, ..Rules::BARE_MAP };
    rough(HoldRequest::new(&body, &rules, HoldLaw::Level, start, 6.0), friction)
}

#[test]
fn a_triangle_rocks_to_rest_on_its_base() {
    let request = on_its_base(0.3, 0.0, Some((5.0, Slide::None)));
    let hold = held(&request);
    assert_eq!(hold.ending, HoldEnding::RestsOnEdge { vertices: [0, 1] });
    let last = hold.samples.last().unwrap();
    assert!((last.theta - (request.start.theta - 0.3)).abs() < 1e-8 && last.theta_dot == 0.0);
    // The base lands at θ̇, and the body turns on at 0.478θ̇ about the other end.
    let landed = hold.samples.iter().position(|it| it.theta < request.start.theta - 0.3).unwrap();
    let rod = request.body.rod;
    let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
    let fallen = rod.gravity * l * ((request.start.theta).cos() - (request.start.theta - 0.3).cos()).abs();
    let speed = (2.0 * fallen / (l * l + rho * rho)).sqrt();
    let most = hold.samples[..landed].iter().map(|it| it.theta_dot.abs()).fold(0.0, f64::max);
    let after = hold.samples[landed].theta_dot.abs();
    assert!(most < speed && most > 0.9 * speed, "{most} {speed}");
    assert!(after < 0.478 * speed && after > 0.35 * speed, "{after} {speed}");
}

#[test]
fn a_triangle_topples_over_its_base_above_its_speed() {
    let rho_squared = {
        let outline = on_its_base(0.0, 0.0, None).body.outline.unwrap();
        outline.radius_of_gyration * outline.radius_of_gyration
    };
    let arm = 0.05_f64 * 0.05 + (0.2_f64 / 3.0) * (0.2 / 3.0);
    let ratio = (rho_squared - 0.05 * 0.05 + (0.2_f64 / 3.0) * (0.2 / 3.0)) / (rho_squared + arm);
    assert!((ratio - 0.478).abs() < 5e-4, "{ratio}");
    // ½(ρ² + r²)θ̇² = G(r − h) on top of the vertex.
    let speed = (2.0 * 9.81 * (arm.sqrt() - 0.2 / 3.0) / (rho_squared + arm)).sqrt();
    assert!((speed - 5.84).abs() < 5e-3, "{speed}");
    for (share, edge) in [(0.999, [0, 1]), (1.001, [0, 2])] {
        let hold = held(&on_its_base(1e-12, share * speed, Some((50.0, Slide::None))));
        assert_eq!(hold.ending, HoldEnding::RestsOnEdge { vertices: edge });
    }
}

/// A contact asks whether to go on after every 128 steps and searches.
#[test]
fn a_contact_takes_no_more_work_than_its_price_allows_and_stops_when_it_is_told_to() {
    let weights = [74.42, 1.0586, 2874.3, 6.086];
    let gains = contact_gain(&Body::plain(paper()), 9.81, weights, 1.5844).unwrap();
    let stiff = HoldLaw::Tilting(gains, 0.0);
    let start = ContactStart { theta: 1e-4, ..ContactStart::default() };
    let swinging = HoldLaw::tilt_gain(1.3);
    for (law, duration) in [(stiff, 6.0), (stiff, 60.0), (swinging, 60.0), (HoldLaw::Tilting(K_HOLD, 0.0), 60.0)] {
        let request = HoldRequest { duration, ..request(law, start) };
        let mut asked = 0;
        let hold = hold(&request, &mut || {
            asked += 1;
            true
        });
        assert_eq!(hold.ending, HoldEnding::Completed, "{law:?}");
        assert!(asked > 0 && 128 * asked <= 2 * request.work(), "{asked} of {} for {law:?}", request.work());
        for last in [1, asked / 2] {
            let mut asked = 0;
            let stopped = equipoise_physics::run::lasting_contact::hold(&request, &mut || {
                asked += 1;
                asked < last
            });
            assert_eq!((stopped.ending, asked), (HoldEnding::Stopped, last), "{law:?}");
        }
    }
    let work = |duration| HoldRequest { duration, ..request(stiff, start) }.work();
    assert!(work(60.0) > 5 * work(6.0) && work(6.0) > 2 * request(HoldLaw::Tilting(K_HOLD, 0.0), start).work());
}

#[test]
fn a_table_that_is_level_already_lets_a_body_down_at_once() {
    for friction in [None, Some((2.0, Slide::None))] {
        let request = on_its_base(0.02, 0.0, friction);
        let level = (tilted(1e-14), 0.0);
        let start = ContactStart { before: Some(level), ..request.start };
        assert_eq!(held(&HoldRequest { start, ..request }), held(&request));
    }
}

// Lasting contact as the limit of ever smaller bounces, and against a stiff spring in place of the constraint.

const ROD: Rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.3);

fn held_for(friction: Option<Friction>, theta: f64, x_dot: f64, duration: f64) -> Hold {
    let start = ContactStart { t: 0.0, x: 0.0, theta, x_dot, theta_dot: 0.0, table_speed: 0.0, before: None };
    let rules = Rules { topple_angle: 1.5, ..Rules::BARE_MAP };
    let body = Body { friction, ..Body::plain(ROD) };
    let request = HoldRequest::new(&body, &rules, HoldLaw::tilt_gain(ROD.tilt_gain), start, duration);
    hold(&request, &mut || true)
}

/// Largest difference in x and θ between a hold of 0.3 s and a run of strikes that each give the contact point its vertical speed back,
/// from `drop` (m) above the table.
fn distance_to_bounces(friction: Option<Friction>, theta: f64, x_dot: f64, drop: f64) -> f64 {
    let hold = held_for(friction, theta, x_dot, 0.3);
    assert_eq!(hold.ending, HoldEnding::Completed);
    let body = Body { friction, ..Body::plain(ROD) };
    let mut state = State { theta, x_dot, y_dot: -(2.0 * ROD.gravity * drop).sqrt(), theta_dot: 0.0 };
    let (mut t, mut x, mut worst) = (0.0, 0.0, 0.0_f64);
    loop {
        let place: f64 = t / 0.01;
        if place >= 29.0 {
            return worst;
        }
        let (before, after) = (hold.samples[place as usize], hold.samples[place as usize + 1]);
        let at = |read: fn(&HoldSample) -> f64| read(&before) * (1.0 - place.fract()) + read(&after) * place.fract();
        if place >= 1.0 {
            // The samples of the first 10 ms are too far apart for a contact that stops sliding there.
            worst = worst.max((x - at(|it| it.x)).abs()).max((state.theta - at(|it| it.theta)).abs());
        }
        let alpha = ROD.tilt_gain * state.theta;
        let along = x_dot_of_contact(&state) * alpha.cos() + ROD.contact_speed(&state) * alpha.sin();
        let matched = friction.is_some_and(|friction| friction.slide == Slide::Matched);
        let tangential_velocity = if matched { along } else { 0.0 };
        let coming = |normal_velocity| {
            let plan = Some(PlannedTableMotion { alpha, normal_velocity, tangential_velocity });
            PreImpact { n: 1, x, state, clearance: 0.0, plan }
        };
        // The faster the table, the faster the rise.
        let wanted = -ROD.contact_speed(&state);
        let (mut slow, mut fast) = (-1.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (slow + fast);
            let strike = body.strike(&coming(middle));
            // A table that leaves the contact point behind strikes nothing.
            if strike.approach >= 0.0 || strike.contact_rise < wanted { slow = middle } else { fast = middle }
        }
        let coming = coming(fast);
        let strike = body.strike(&coming);
        assert!((strike.contact_rise - wanted).abs() < 1e-12);
        let arrival = body.fly(&coming, &strike).unwrap();
        (t, x, state) = (t + arrival.t, x + arrival.state.x_dot * arrival.t, arrival.state);
    }
}

fn x_dot_of_contact(state: &State) -> f64 {
    state.x_dot + ROD.contact_distance * state.theta.cos() * state.theta_dot
}

/// Each kind of table strikes ever smaller bounces, and the run tends to the hold: this is why it is the motion in contact.
#[test]
fn small_bounces_tend_to_the_hold() {
    let rough = |coefficient, slide| Some(Friction { coefficient, law: RestitutionLaw::Poisson, slide });
    for (friction, theta, x_dot) in [
        (None, 0.1, 0.0),
        (None, -0.3, 0.2),
        (rough(0.5, Slide::Matched), 0.1, 0.1),
        // Outside the cone: F is at most μN.
        (rough(0.05, Slide::Matched), 0.3, 0.0),
        // It slides all the time, and it slides first and sticks then.
        (rough(0.1, Slide::None), 0.1, 0.5),
        (rough(0.4, Slide::None), 0.02, 0.1),
    ] {
        let [far, near] = [1e-5, 1e-7].map(|drop| distance_to_bounces(friction, theta, x_dot, drop));
        assert!(near < 1e-3 && near < 0.3 * far, "{friction:?} {theta}: {far:e} {near:e}");
    }
}

/// x, y, θ and their rates of a free body on a spring and a damper along the normal of a table that tilts by κθ about its contact point.
fn on_a_spring(stiffness: f64, theta: f64, duration: f64) -> [f64; 6] {
    let Rod { contact_distance: l, radius_of_gyration: rho, gravity, tilt_gain, .. } = ROD;
    let damping = 2.0 * stiffness.sqrt();
    let rates = |s: [f64; 6]| {
        let [_, y, theta, x_dot, y_dot, theta_dot] = s;
        let alpha = tilt_gain * theta;
        // The contact point comes to the height 0 whatever the tilt: the spring sees its depth, and pushes along the normal.
        let depth = l * theta.cos() - y;
        let rate = -l * theta.sin() * theta_dot - y_dot;
        let force = stiffness * depth + damping * rate;
        let (f_x, f_y) = (-force * alpha.sin(), force * alpha.cos());
        let torque = l * theta.sin() * f_y + l * theta.cos() * f_x;
        [x_dot, y_dot, theta_dot, f_x, f_y - gravity, torque / (rho * rho)]
    };
    let mut s = [0.0, l * theta.cos() - gravity / stiffness, theta, 0.0, 0.0, 0.0];
    let steps = (duration * 2e5) as u32;
    let h = duration / f64::from(steps);
    let moved = |s: [f64; 6], k: [f64; 6], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    for _ in 0..steps {
        let k1 = rates(s);
        let k2 = rates(moved(s, k1, 0.5 * h));
        let k3 = rates(moved(s, k2, 0.5 * h));
        let k4 = rates(moved(s, k3, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    s
}

#[test]
fn a_stiff_spring_tends_to_the_constraint() {
    let hold = held_for(None, 0.2, 0.0, 0.3);
    let last = hold.samples.last().unwrap();
    let l = ROD.contact_distance;
    let error = |stiffness: f64| {
        let [x, y, theta, x_dot, _, theta_dot] = on_a_spring(stiffness, 0.2, 0.3);
        let force = stiffness * (l * theta.cos() - y);
        let differences = [x - last.x, theta - last.theta, x_dot - last.x_dot, theta_dot - last.theta_dot];
        differences.iter().fold((force / last.normal_force - 1.0).abs(), |worst, it| worst.max(it.abs()))
    };
    let (soft, stiff) = (error(1e6), error(1e8));
    assert!(stiff < 1e-4 && stiff < 0.2 * soft, "{soft:e} {stiff:e}");
}

// The tilt of the table as a lasting contact begins and goes on: it moves at a finite rate, which its demand has and its limits bound.

fn caught(scene: &Scene, strategy: Strategy) -> Catch {
    let settings = CatchSettings { strategy: Some(strategy), ..CatchSettings::default() };
    catch(scene, &settings, None, &mut || true).unwrap()
}

/// Holds the tilts of a motion, from `before` on, to the rate that its load has.
fn assert_finite(hold: &Hold, before: Option<f64>, case: &str) {
    let first = hold.samples.first().unwrap();
    assert!(before.is_none_or(|alpha| (alpha - first.alpha).abs() <= 1e-9), "{case}: {before:?} and {}", first.alpha);
    for pair in hold.samples.windows(2) {
        let rate = (pair[1].alpha - pair[0].alpha).abs() / (pair[1].t - pair[0].t);
        assert!(rate <= hold.load.tilt_rate * (1.0 + 1e-9), "{case}: {rate} rad/s at {} s", pair[0].t);
    }
}

#[test]
fn a_contact_begins_at_the_tilt_of_its_strike() {
    let mut jumps = 0;
    for strategy in Strategy::ALL {
        for (friction, restitution, theta) in [(0.0, 1.0, 0.1), (0.0, 0.6, -0.15), (0.6, 0.7, 0.1), (0.8, 1.0, -0.05)] {
            let scene = scene(&[(Name::Friction, friction), (Name::Restitution, restitution), (Name::Theta, theta)]);
            let caught = caught(&scene, strategy);
            let case = format!("{strategy:?} {friction} {restitution} {theta}: {:?}", caught.outcome);
            assert!(caught.outcome.is_caught(), "{case}");
            let hold = caught.hold.unwrap();
            let last = caught.strikes.last().map(|strike| strike.strike.alpha);
            assert_finite(&hold, last, &case);
            assert!(caught.demand.load.tilt_rate >= hold.load.tilt_rate, "{case}");
            // On the way the table moves by 1 rad in ρ/√(Gl).
            let growth = (9.81 * 0.4 / 3.0_f64).sqrt() / (2.0_f64.sqrt() / 15.0);
            if hold.load.tilt_rate > 0.999 * growth {
                jumps += 1;
            }
        }
    }
    assert!(jumps > 4, "{jumps} contacts begin with a table on its way");
}

#[test]
fn a_limit_of_the_tilt_rate_bounds_the_way_to_the_hold() {
    let free = caught(&scene(&[(Name::Friction, 0.6)]), Strategy::BounceDown);
    let between = free
        .strikes
        .windows(2)
        .map(|pair| (pair[1].strike.alpha - pair[0].strike.alpha).abs() / pair[0].flight_time.unwrap());
    let limit = 1.001 * between.fold(0.0, f64::max);
    let bounded = caught(&scene(&[(Name::Friction, 0.6), (Name::TiltRateLimit, limit)]), Strategy::BounceDown);
    assert_eq!(bounded.outcome, CatchOutcome::Held);
    assert_eq!(bounded.strikes, free.strikes);
    assert!(bounded.demand.load.tilt_rate <= limit, "{} {limit}", bounded.demand.load.tilt_rate);
    // A level table holds by moving along itself: its tilt acts on the needed friction alone.
    let (free, bounded) = (free.hold.unwrap(), bounded.hold.unwrap());
    assert!(bounded.load.tilt_rate <= limit && free.load.tilt_rate > limit);
    for (one, other) in free.samples.iter().zip(&bounded.samples) {
        let apart = (one.theta - other.theta).abs().max((one.x - other.x).abs());
        assert!(apart < 1e-7, "{apart} at {} and {} s", one.t, other.t);
    }
    assert!(free.samples.last().unwrap().alpha == 0.0);
}

#[test]
fn a_table_that_stops_braking_goes_to_its_law_at_a_finite_rate() {
    let gains = |scale: f64| {
        let (x, theta) = (0.3162 * scale, -2.9078 * scale);
        HoldLaw::Tilting(Gains { x, theta, x_dot: 0.3647 * scale, theta_dot: -0.2463 * scale }, 0.0)
    };
    let start =
        ContactStart { t: 0.0, x: 0.02, theta: 0.1, x_dot: 0.0, theta_dot: 0.0, table_speed: -1.0, before: None };
    let rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.3);
    let rules = |limits| Rules { topple_angle: 1.5, limits, ..Rules::BARE_MAP };
    let request = HoldRequest {
        brake_law: Some(gains(0.8)),
        brake: Some(9.81),
        ..HoldRequest::new(&Body::plain(rod), &rules(None), gains(1.0), start, 2.0)
    };
    let free = hold(&request, &mut || true);
    assert_eq!(free.ending, HoldEnding::Completed);
    assert_finite(&free, None, "brake");
    let limits = ActuatorLimits { tilt: 1.0, tilt_rate: 8.0, speed: 10.0, stroke: 10.0 };
    let struck = (tilted(0.2), 0.0);
    let from = |before| ContactStart { before: Some(before), ..start };
    let slow = hold(&HoldRequest { rules: rules(Some(limits)), start: from(struck), ..request }, &mut || true);
    assert_eq!(slow.ending, HoldEnding::Completed);
    assert_finite(&slow, Some(0.2), "slow");
    assert_eq!(slow.load.tilt_rate, 8.0);
    // A table that is too slow loses the body, or has to go faster.
    let slower = ActuatorLimits { tilt_rate: 0.1, ..limits };
    let lost = hold(&HoldRequest { rules: rules(Some(slower)), start: from(struck), ..request }, &mut || true);
    assert_ne!(lost.ending, HoldEnding::Completed);
    assert!(lost.load.tilt_rate <= 0.1 || matches!(lost.ending, HoldEnding::Ended(Ending::BeyondLimits(_))));
    // With a flight before the contact the way takes all of it.
    let flown = HoldRequest { start: from((tilted(0.3), 0.05)), ..request };
    let first = hold(&flown, &mut || true);
    let alpha = first.samples[0].alpha;
    assert_eq!(alpha, free.samples[0].alpha);
    assert!(first.load.tilt_rate >= (0.3 - alpha).abs() / 0.05);
    let fast = rules(Some(ActuatorLimits { tilt_rate: 0.5, ..limits }));
    let HoldEnding::Ended(Ending::BeyondLimits(violation)) =
        hold(&HoldRequest { rules: fast, ..flown }, &mut || true).ending
    else {
        panic!("within limits")
    };
    assert_eq!((violation.quantity, violation.value), ("tilt_rate", (alpha - 0.3).abs() / 0.05));
}

#[test]
fn a_catch_begins_at_the_tilt_of_the_strike_before_it() {
    let plain = scene(&[]);
    let mut contacts = Vec::new();
    run(&mut plain.orbit().unwrap(), 4, |contact| {
        contacts.push(*contact);
        true
    });
    let (before, at) = (contacts[2], contacts[3]);
    for strategy in Strategy::ALL {
        let settings = CatchSettings { strategy: Some(strategy), ..CatchSettings::default() };
        let from = ComingContact {
            t: at.t,
            coming: PreImpact::at(at.n, at.x, at.state),
            before: before.strike.map(|strike| Pose::of(&strike)).zip(before.flight_time),
        };
        let of = |scene: &Scene, from: &ComingContact| catch(scene, &settings, Some(from), &mut || true).unwrap();
        let known = of(&plain, &from);
        let first =
            known.strikes.first().map_or_else(|| known.hold.as_ref().unwrap().samples[0].alpha, |it| it.strike.alpha);
        let rate = (first - before.alpha).abs() / before.flight_time.unwrap();
        assert!(known.demand.load.tilt_rate >= rate, "{strategy:?}");
        let limited = of(&scene(&[(Name::TiltRateLimit, 0.99 * rate)]), &from);
        let CatchOutcome::Ended { t, ending: Ending::BeyondLimits(violation) } = limited.outcome else {
            panic!("{strategy:?}: {:?}", limited.outcome)
        };
        assert_eq!((t, violation.quantity, violation.value), (at.t, "tilt_rate", rate), "{strategy:?}");
    }
}

#[test]
fn the_rest_of_a_run_begins_where_its_last_strike_left_the_table() {
    let mut settled = 0;
    for (restitution, gain) in [(0.5, 1.1), (0.6, 1.1), (0.5, 1.05), (0.4, 1.1)] {
        let values = [(Name::Height, 0.25), (Name::Restitution, restitution), (Name::TiltGain, gain)];
        let mut draft = scene(&values).draft();
        draft.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
        let scene = draft.build().unwrap();
        let mut last = None;
        let ending = run(&mut scene.orbit().unwrap(), 10_000, |contact| {
            last = Some(*contact);
            true
        });
        let Some(Ending::Settled { settle_time, .. }) = ending else { continue };
        settled += 1;
        let last = last.unwrap();
        let rest = hold(&rest_of_run(&scene, &last, settle_time, 0.2).unwrap(), &mut || true);
        assert_finite(&rest, (settle_time == last.t).then_some(last.alpha), "rest");
        let rate = (rest.samples[0].alpha - last.alpha).abs();
        assert!(rate <= rest.load.tilt_rate * (settle_time - last.t).max(f64::MIN_POSITIVE) * (1.0 + 1e-15));
    }
    assert!(settled > 0, "no run settles");
}
