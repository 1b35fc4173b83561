//! Lasting contact as the limit of ever smaller bounces, and against a stiff spring in place of the constraint.

use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{PlannedTableMotion, Rod, State};
use equipoise_physics::run::lasting_contact::{ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest, HoldSample, hold};
use equipoise_physics::run::rules::Rules;

const ROD: Rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.3);

fn held(friction: Option<Friction>, theta: f64, x_dot: f64, duration: f64) -> Hold {
    let start = ContactStart { t: 0.0, x: 0.0, theta, x_dot, theta_dot: 0.0, table_speed: 0.0, before: None };
    let rules = Rules { topple_angle: 1.5, ..Rules::BARE_MAP };
    let body = Body { friction, ..Body::plain(ROD) };
    let request = HoldRequest::new(&body, &rules, HoldLaw::tilt_gain(ROD.tilt_gain), start, duration);
    hold(&request, &mut || true)
}

/// Largest difference in x and θ between a hold of 0.3 s and a run of strikes that each give the contact point its vertical speed back,
/// from `drop` (m) above the table.
fn distance_to_bounces(friction: Option<Friction>, theta: f64, x_dot: f64, drop: f64) -> f64 {
    let hold = held(friction, theta, x_dot, 0.3);
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
    let hold = held(None, 0.2, 0.0, 0.3);
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
