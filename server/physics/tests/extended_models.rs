//! Runs with 31 digits of scenes beyond the plain rod: state feedback, friction, drawn errors, polygons and tables with limits, by exact
//! identities at each of their contacts and against the map in doubles.

use crate::support::mixes;
use crate::support::random;
use equipoise_physics::body::Body;
use equipoise_physics::body::polygon::Vertices;
use equipoise_physics::bounce::friction::{RestitutionLaw, Slide};
use equipoise_physics::bounce::strike::{ContactMode, State};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::extended;
use equipoise_physics::run::extended::ExtendedContact;
use equipoise_physics::run::orbit;
use equipoise_physics::scene::{Draft, Name, Scene};
use equipoise_physics::table::control_law::{Gains, Steering};
use equipoise_physics::table::noise::{NoiseModel, SensingErrors};
use mixes::{MIXES, number, scene};
use random::Random;

/// Bound on the remainder of an identity whose terms are about 1.
const EXACT: f64 = 1e-29;

fn contacts(scene: &Scene, impacts: u64) -> (Vec<ExtendedContact>, Option<Ending>) {
    let mut contacts = Vec::new();
    let ending = match scene.extended_orbit() {
        Ok(mut orbit) => orbit::run(&mut orbit, impacts, |contact| {
            contacts.push(*contact);
            true
        }),
        Err(no_contact) => Some(no_contact.ending(0.0, 0.0)),
    };
    (contacts, ending)
}

fn from(value: f64) -> DoubleDouble {
    DoubleDouble::from_f64(value)
}

/// Remainders of the identities at one contact, each with its name.
fn remainders(body: &Body<DoubleDouble>, here: &ExtendedContact) -> Vec<(&'static str, DoubleDouble)> {
    let rod = &body.rod;
    let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
    let Some(strike) = here.strike else { return Vec::new() };
    let (before, after) = (here.state, strike.after);
    let (sin, cos) = before.theta.sincos();
    let (sin_alpha, cos_alpha) = strike.alpha.sincos();
    let (pushed, rubbed) = (strike.impulse_normal, strike.impulse_tangential);
    let of_contact = |state: &State<DoubleDouble>| {
        let x = state.x_dot + l * cos * state.theta_dot;
        let y = state.y_dot + l * sin * state.theta_dot;
        (cos_alpha * x + sin_alpha * y, cos_alpha * y - sin_alpha * x)
    };
    let ((along, normal), (along_after, normal_after)) = (of_contact(&before), of_contact(&after));
    let (table_x, table_y) = strike.table_velocity;
    let table_along = cos_alpha * table_x + sin_alpha * table_y;
    let table_normal = cos_alpha * table_y - sin_alpha * table_x;
    let spun = after.theta_dot - before.theta_dot;
    let (pushed_x, pushed_y) = (after.x_dot - before.x_dot, after.y_dot - before.y_dot);
    let mut all = vec![
        ("momentum in x", pushed_x - (rubbed * cos_alpha - pushed * sin_alpha)),
        ("momentum in y", pushed_y - (rubbed * sin_alpha + pushed * cos_alpha)),
        ("angular momentum about the contact", l * (cos * pushed_x + sin * pushed_y) - rho * rho * spun),
        ("centre of percussion", (pushed_x * cos + pushed_y * sin) - rho * rho / l * spun),
    ];
    let noise = body.noise;
    let error = noise.map_or(0.0, |noise| noise.angle_error(here.n));
    let off = noise.and_then(|noise| noise.sensing(here.n)).unwrap_or_default();
    let nominal = rod.restitution.to_f64();
    let restitution = from(noise.map_or(nominal, |noise| noise.restitution(here.n, nominal)));
    // Tables that are late are compared with a simulation (`delay.rs`).
    let late = !body.lag.is_zero() || noise.is_some_and(|noise| noise.further.horizon != 0.0);
    if !late && noise.is_none_or(|noise| noise.model == NoiseModel::Strike) {
        let sensed = before.theta + from(error);
        let alpha = match body.steering {
            Steering::TiltGain => rod.tilt_gain * sensed,
            Steering::Feedback(gains) => {
                let Gains { x, theta, x_dot, theta_dot } = gains;
                -(x * (here.x + from(off.x))
                    + theta * sensed
                    + x_dot * (before.x_dot + from(off.x_dot))
                    + theta_dot * (before.theta_dot + from(off.theta_dot)))
            }
        };
        all.push(("tilt law", strike.alpha - alpha));
    }
    let (coefficient, law, slide) =
        body.friction.map_or((from(0.0), RestitutionLaw::Newton, Slide::None), |friction| {
            (friction.coefficient, friction.law, friction.slide)
        });
    let matched = slide == Slide::Matched && off == SensingErrors::default() && !late;
    if matched && noise.is_none_or(|noise| noise.model == NoiseModel::Strike) {
        all.push(("matched table", table_along - along));
    }
    match strike.mode {
        ContactMode::Frictionless => all.push(("no friction", rubbed)),
        ContactMode::Stick => all.push(("sticking", along_after - table_along)),
        ContactMode::Slide => all.push(("sliding", rubbed * rubbed - coefficient * coefficient * pushed * pushed)),
        ContactMode::ReverseSlide | ContactMode::SlideThrough => {}
    }
    // The three laws agree where nothing changes on the way through the impact.
    let steady = matches!(strike.mode, ContactMode::Frictionless | ContactMode::Slide)
        || (matched && strike.mode == ContactMode::Stick);
    if law == RestitutionLaw::Newton || (steady && noise.is_none_or(|noise| noise.model == NoiseModel::Strike)) {
        let restored = normal_after - table_normal + restitution * (normal - table_normal);
        all.push(("restitution", restored));
    }
    all
}

/// Remainders of the identities of the flight between two contacts.
fn of_flight(
    body: &Body<DoubleDouble>,
    from_contact: &ExtendedContact,
    to: &ExtendedContact,
) -> Vec<(&'static str, DoubleDouble)> {
    let rod = &body.rod;
    let (Some(strike), Some(t)) = (from_contact.strike, from_contact.flight_time) else { return Vec::new() };
    let (start, end) = (strike.after, to.state);
    let (l, rho, gravity) = (rod.contact_distance, rod.radius_of_gyration, rod.gravity);
    let half = from(0.5);
    let height = |contact: &ExtendedContact| l * contact.state.theta.sincos().1 + contact.clearance;
    let energy = |state: &State<DoubleDouble>, height: DoubleDouble| {
        let spin = rho * state.theta_dot;
        half * (state.x_dot * state.x_dot + state.y_dot * state.y_dot + spin * spin) + gravity * height
    };
    let fallen = height(from_contact) + start.y_dot * t - half * gravity * t * t;
    vec![
        ("energy of the flight", energy(&end, height(to)) - energy(&start, height(from_contact))),
        ("height of the contact", fallen - height(to)),
        ("place", to.x - (from_contact.x + start.x_dot * t)),
        ("angle", end.theta - (start.theta + start.theta_dot * t)),
        ("time", to.t - (from_contact.t + t)),
    ]
}

#[test]
fn every_contact_fulfils_the_identities() {
    let mut random = Random::new(2601);
    let (mut seen, mut worst) = ([0_u32; MIXES.len()], 0.0_f64);
    for (mix, parts) in MIXES.into_iter().enumerate() {
        for _ in 0..60 {
            let scene = scene(&mut random, parts);
            let body = scene.body_in();
            let (contacts, _) = contacts(&scene, 30);
            for (index, here) in contacts.iter().enumerate() {
                let State { x_dot, y_dot, theta_dot, .. } = extended::in_doubles(&here.state);
                let mut size = 1.0 + x_dot.abs() + y_dot.abs() + theta_dot.abs() + here.x.to_f64().abs();
                if let Some(strike) = here.strike {
                    // Where friction nearly jams the contact the impulse is far larger than the velocities before it.
                    let State { x_dot, y_dot, theta_dot, .. } = extended::in_doubles(&strike.after);
                    size += x_dot.abs() + y_dot.abs() + theta_dot.abs() + strike.impulse_normal.to_f64().abs();
                }
                let next = contacts.get(index + 1);
                let flown = next.map_or_else(Vec::new, |next| of_flight(&body, here, next));
                for (name, remainder) in remainders(&body, here).into_iter().chain(flown) {
                    let off = remainder.to_f64().abs() / (size * size);
                    worst = worst.max(off);
                    assert!(off <= EXACT, "{name} at contact {} is off by {off:e}: {parts:?} {scene:?}", here.n);
                }
                seen[mix] += 1;
            }
        }
    }
    println!("worst remainder {worst:.1e}; contacts {seen:?}");
    assert!(seen.iter().all(|seen| *seen > 300), "{seen:?}");
}

/// The first contacts of a run in doubles are those with 31 digits, but for rounding, and the runs end alike.
#[test]
fn the_map_in_doubles_agrees() {
    let mut random = Random::new(2602);
    let (mut compared, mut endings, mut alike) = (0, 0, 0);
    for parts in MIXES {
        for _ in 0..100 {
            let scene = scene(&mut random, parts);
            let (exact, ended) = contacts(&scene, 20);
            let mut ours = Vec::new();
            let ending = match scene.orbit() {
                Ok(mut orbit) => orbit::run(&mut orbit, 20, |contact| {
                    ours.push(*contact);
                    true
                }),
                Err(no_contact) => Some(no_contact.ending(0.0, 0.0)),
            };
            endings += 1;
            alike += u32::from(ending.map(Ending::name) == ended.map(Ending::name) && ours.len() == exact.len());
            for (one, other) in ours.iter().zip(&exact).take(4) {
                let off = |ours: f64, exact: DoubleDouble| (from(ours) - exact).to_f64().abs();
                let (mine, its) = (one.state, other.state);
                let error = off(mine.theta, its.theta)
                    .max(off(mine.x_dot, its.x_dot))
                    .max(off(mine.y_dot, its.y_dot))
                    .max(off(mine.theta_dot, its.theta_dot))
                    .max(off(one.x, other.x))
                    .max(off(one.clearance, other.clearance))
                    .max(off(one.alpha, other.alpha));
                let size = 1.0 + mine.x_dot.abs() + mine.y_dot.abs() + mine.theta_dot.abs();
                assert!(error <= 1e-10 * size, "contact {} is off by {error:e}: {scene:?}", one.n);
                compared += 1;
            }
        }
    }
    println!("{compared} contacts compared; {alike} of {endings} runs end alike");
    assert!(compared > 2000 && 100 * alike >= 99 * endings, "{compared}, {alike} of {endings}");
}

/// Another vertex of a polygon and the limits of a table end both runs at the same contact, in the same way.
#[test]
fn polygons_and_limits_end_both_runs_alike() {
    let mut random = Random::new(2603);
    let mut ended = std::collections::BTreeMap::<&str, u32>::new();
    for _ in 0..200 {
        let width = random.between(0.03, 0.15);
        let height = random.between(0.05, 0.2);
        let mut draft = Draft::default();
        draft.set_vertices(Some(Vertices::new(&[[0.0, 0.0], [width, height], [-width, height]]).unwrap()));
        number(&mut draft, Name::Height, height + random.between(0.05, 0.2));
        number(&mut draft, Name::Theta, random.size(0.01, 0.3));
        number(&mut draft, Name::ThetaDot, random.size(0.01, 0.5));
        number(&mut draft, Name::TiltGain, random.between(0.9, 1.6));
        if random.between(0.0, 1.0) < 0.5 {
            number(&mut draft, Name::TiltLimit, random.between(0.1, 0.6));
            number(&mut draft, Name::TiltRateLimit, random.between(0.5, 4.0));
        }
        let scene = draft.build().unwrap();
        let (exact, ending) = contacts(&scene, 30);
        let mut seen = 0;
        let ours = match scene.orbit() {
            Ok(mut orbit) => orbit::run(&mut orbit, 30, |contact| {
                seen = contact.n;
                true
            }),
            Err(no_contact) => Some(no_contact.ending(0.0, 0.0)),
        };
        assert_eq!(ours.map(Ending::name), ending.map(Ending::name), "{scene:?}");
        assert_eq!(seen, exact.len() as u64, "{scene:?}");
        *ended.entry(ending.unwrap().name()).or_default() += 1;
    }
    println!("{ended:?}");
    assert!(["completed", "other_vertex", "beyond_limits"].iter().all(|name| ended.get(name) > Some(&10)), "{ended:?}");
}
