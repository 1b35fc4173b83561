//! Accuracy of runs, in doubles and with 31 digits, against runs of other programs with 50 and 60 digits, and against exact identities.

use std::collections::BTreeMap;

use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::{RestitutionLaw, Slide};
use equipoise_physics::map::strike::{ContactMode, State};
use equipoise_physics::map::table::control_law::{Gains, Steering};
use equipoise_physics::map::table::noise::{NoiseModel, SensingErrors};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::error_estimate::ErrorEstimate;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::{ExtendedContact, Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use serde_json::Value as Json;

use crate::support::decimals::number;
use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use crate::support::reference;
use crate::support::rig::with_numbers;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Largest error of a component of the state at contact 100.
fn error(sample: &Json, holds_energy: bool) -> f64 {
    let mut draft = Draft::default();
    for (name, pointer) in [
        (Name::ContactDistance, "/body/contact_distance"),
        (Name::RadiusOfGyration, "/body/radius_of_gyration"),
        (Name::TiltGain, "/table/tilt_gain"),
        (Name::Height, "/release/height"),
        (Name::Theta, "/release/theta"),
        (Name::ThetaDot, "/release/theta_dot"),
        (Name::XDot, "/release/x_dot"),
    ] {
        draft.set(name, Some(Value::Number(sample.pointer(pointer).unwrap().as_f64().unwrap()))).unwrap();
    }
    let scene = draft.build().unwrap();
    let rules = Rules { holds_energy, ..scene.rules() };
    let mut orbit = Orbit::new(scene.model(), rules, scene.release()).unwrap();
    let mut last = *orbit.state();
    run(&mut orbit, 100, |contact| {
        last = contact.state;
        true
    });
    [("theta", last.theta), ("x_dot", last.x_dot), ("y_dot", last.y_dot), ("theta_dot", last.theta_dot)]
        .map(|(name, value)| (value - sample["state"][name].as_f64().unwrap()).abs())
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn holding_the_energy_pays() {
    let samples: Json = serde_json::from_str(include_str!("../../../tests/oracle/runs.json")).unwrap();
    let samples = samples.as_array().unwrap();
    let held: Vec<f64> = samples.iter().map(|sample| error(sample, true)).collect();
    let free: Vec<f64> = samples.iter().map(|sample| error(sample, false)).collect();
    let plain: Vec<f64> = samples.iter().map(|sample| sample["plain"].as_f64().unwrap()).collect();
    let (held, free, plain) = (median(held), median(free), median(plain));
    println!("median error at contact 100: plain doubles {plain:.1e}, our map {free:.1e}, with energy held {held:.1e}");
    assert!(held < 0.5 * free && held < 0.25 * plain, "{held:e} {free:e} {plain:e}");
}

// Every reference run, computed with 60 digits: same outcome, same number of contacts, states as close
// as the plain algorithm in doubles comes, or closer.

/// Distance of a double from a decimal of more digits than a double holds: the decimal's own rest counts too.
fn distance(value: f64, exact: &str) -> f64 {
    (value - exact.parse::<f64>().unwrap()).abs()
}

#[test]
fn every_reference_agrees() {
    let mut seen = 0;
    for (name, scene, reference) in reference::all() {
        seen += 1;
        let mut orbit = scene.orbit().unwrap();
        let mut contacts = Vec::new();
        let ending = run(&mut orbit, reference["impacts"].as_u64().unwrap(), |contact| {
            contacts.push(*contact);
            true
        });
        assert_eq!(ending.unwrap().name(), reference["outcome"], "{name}");
        let states = &reference["states"];
        assert_eq!(contacts.len(), states["t"].as_array().unwrap().len(), "{name}");
        let mut worst: f64 = 0.0;
        for (index, contact) in contacts.iter().enumerate() {
            let ours = [
                ("t", contact.t),
                ("x", contact.x),
                ("theta", contact.state.theta),
                ("x_dot", contact.state.x_dot),
                ("y_dot", contact.state.y_dot),
                ("theta_dot", contact.state.theta_dot),
            ];
            for (column, value) in ours {
                worst = worst.max(distance(value, states[column][index].as_str().unwrap()));
            }
        }
        let plain = reference["plain_double_error"].as_f64().unwrap();
        let allowed = (10.0 * plain).max(1e-13);
        println!("{name}: error {worst:.2e}, plain doubles {plain:.2e}, allowed {allowed:.2e}");
        assert!(worst <= allowed, "{name}: error {worst:.2e}, allowed {allowed:.2e}");
        let energies: Vec<f64> = contacts.iter().map(|contact| orbit.body.energy(&contact.state)).collect();
        if scene.model_level() == ModelLevel::Rod
            && scene.rules().holds_energy
            && scene.number(Name::EnergyGain) == Some(0.0)
        {
            let drift = energies.iter().map(|energy| (energy - energies[0]).abs()).fold(0.0, f64::max);
            assert!(drift <= allowed * 3.0, "{name}: energy drifts by {drift:.2e}");
        }
    }
    assert!(seen >= 22, "only {seen} references were run");
}

// The map with 31 digits against runs computed with 60, those that are chaotic too; and against the map in doubles.

fn contacts(scene: &Scene, impacts: u64) -> (Vec<ExtendedContact>, &'static str) {
    let mut contacts = Vec::new();
    let ending = orbit::run(&mut scene.extended_orbit().unwrap(), impacts, |contact| {
        contacts.push(*contact);
        true
    });
    (contacts, ending.unwrap().name())
}

fn worst(contacts: &[ExtendedContact], states: &Json) -> f64 {
    let mut worst: f64 = 0.0;
    for (index, contact) in contacts.iter().enumerate() {
        let state = contact.state;
        for (column, value) in [
            ("t", contact.t),
            ("x", contact.x),
            ("theta", state.theta),
            ("x_dot", state.x_dot),
            ("y_dot", state.y_dot),
            ("theta_dot", state.theta_dot),
        ] {
            let exact = number(states[column][index].as_str().unwrap());
            worst = worst.max((value - exact).to_f64().abs() / exact.to_f64().abs().max(1.0));
        }
    }
    worst
}

#[test]
fn every_reference_agrees_to_its_last_digits() {
    let mut seen = 0;
    for (name, scene, reference) in reference::all() {
        let (contacts, ending) = contacts(&scene, reference["impacts"].as_u64().unwrap());
        assert_eq!(ending, reference["outcome"], "{name}");
        let states = &reference["states"];
        assert_eq!(contacts.len(), states["t"].as_array().unwrap().len(), "{name}");
        let worst = worst(&contacts, states);
        let mut estimate = ErrorEstimate::of_extended_run(&scene, contacts[0].t.to_f64());
        let mut bound = estimate.bound();
        for contact in &contacts[..contacts.len() - 1] {
            estimate.pass(contact);
            bound = bound.max(estimate.bound());
        }
        // The bound is of m/s, which are some ten times the angles; the references are written with 25 digits.
        assert!(worst <= 20.0 * bound + 1e-24 && bound < 1e-19, "{name}: error {worst:.1e}, bound {bound:.1e}");
        let allowed = f64::max(1e-23, reference["plain_double_error"].as_f64().unwrap() * 1e-15);
        let orbit = scene.extended_orbit().unwrap();
        if scene.model_level() == ModelLevel::Rod
            && scene.rules().holds_energy
            && scene.number(Name::EnergyGain) == Some(0.0)
        {
            let energies: Vec<_> = contacts.iter().map(|contact| orbit.body.energy(&contact.state)).collect();
            let drift = energies.iter().map(|energy| (*energy - energies[0]).to_f64().abs()).fold(0.0, f64::max);
            assert!(drift <= 1e-30, "{name}: energy drifts by {drift:.1e}");
        }
        let last = contacts.last().unwrap().state;
        let speed = orbit.body.contact_speed(&last).to_f64();
        assert!((speed - scene.model().contact_speed(&last.to_f64())).abs() <= 1e-14 * speed.abs().max(1.0));
        println!("{name}: error {worst:.1e}, bound {bound:.1e}, allowed {allowed:.1e}");
        assert!(worst <= allowed, "{name}: error {worst:.1e}, allowed {allowed:.1e}");
        seen += 1;
    }
    assert!(seen >= 11, "only {seen} references were run");
}

fn scene(numbers: &[(Name, f64)], others: &[(Name, Value)]) -> Scene {
    let mut draft = with_numbers(Draft::default(), numbers);
    for &(name, value) in others {
        draft.set(name, Some(value)).unwrap();
    }
    draft.build().unwrap()
}

/// Eq. (5), exact at any angle: θ_n = (1 − 2κ)ⁿ θ₀.
#[test]
fn a_point_mass_follows_equation_5() {
    let tilt_gain = 0.0625;
    let scene = scene(
        &[(Name::TiltGain, tilt_gain), (Name::Height, 0.3), (Name::XDot, 0.7)],
        &[(Name::PointMass, Value::Flag(true))],
    );
    let (contacts, ending) = contacts(&scene, 60);
    assert_eq!(ending, "completed");
    let mut expected = contacts[0].state.theta;
    assert!(expected.to_f64() > 0.1);
    for contact in contacts {
        let error = (contact.state.theta - expected).to_f64().abs();
        assert!(error <= 1e-29, "contact {}: {error:e}", contact.n);
        expected = expected * DoubleDouble::from(1.0 - 2.0 * tilt_gain);
    }
}

/// It settles where the geometric series of its flights says.
#[test]
fn a_run_that_settles_does_so_when_it_should() {
    let scene = scene(
        &[
            (Name::ContactDistance, 0.1),
            (Name::RadiusOfGyration, 0.08),
            (Name::TiltGain, 0.0),
            (Name::Height, 0.3),
            (Name::Restitution, 0.5),
        ],
        &[(Name::Strike, Value::Choice("still"))],
    );
    let mut settles_at = None;
    let ending = orbit::run(&mut scene.extended_orbit().unwrap(), 100, |contact| {
        if let Some(equipoise_physics::run::ending::Ending::Settled { settle_time, .. }) = contact.ending {
            settles_at = Some(settle_time);
        }
        true
    });
    assert_eq!(ending.unwrap().name(), "settled");
    // The fall, and twice as long a flight for each factor 1/2 from there: 1 + 2·(1/2 + 1/4 + …) = 3 falls.
    let fall = (2.0_f64 * 0.2 / 9.81).sqrt();
    assert!((settles_at.unwrap() - 3.0 * fall).abs() <= 1e-15, "{settles_at:?} {fall}");
}

// Runs with 31 digits of scenes beyond the plain rod, by exact identities at each of their contacts.

/// Bound on the remainder of an identity whose terms are about 1.
const EXACT: f64 = 1e-29;

fn extended_contacts(scene: &Scene, impacts: u64) -> Vec<ExtendedContact> {
    let mut contacts = Vec::new();
    if let Ok(mut orbit) = scene.extended_orbit() {
        orbit::run(&mut orbit, impacts, |contact| {
            contacts.push(*contact);
            true
        });
    }
    contacts
}

fn from(value: f64) -> DoubleDouble {
    DoubleDouble::from_f64(value)
}

/// Remainders of the identities at one contact, each with its name.
fn remainders(scene: &Scene, body: &Body<DoubleDouble>, here: &ExtendedContact) -> Vec<(&'static str, DoubleDouble)> {
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
    ];
    if !body.is_point {
        all.push(("centre of percussion", (pushed_x * cos + pushed_y * sin) - rho * rho / l * spun));
    }
    let noise = body.noise;
    let error = noise.map_or(0.0, |noise| noise.angle_error(here.n));
    let off = noise.and_then(|noise| noise.sensing(here.n)).unwrap_or_default();
    let nominal = rod.restitution.to_f64();
    let restitution = from(noise.map_or(nominal, |noise| noise.restitution(here.n, nominal)));
    // Tables that are late are compared with a simulation (`rig_errors.rs`).
    let late = !body.lag.is_zero() || noise.is_some_and(|noise| noise.horizon != 0.0);
    if !late && noise.is_none_or(|noise| noise.model == NoiseModel::Strike) {
        let angle = if body.is_point {
            Body::point_state(before.x_dot + from(off.x_dot), before.y_dot + from(off.y_dot)).theta
        } else {
            before.theta
        };
        let sensed = angle + from(error);
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
        all.push(("tilt law", strike.alpha - alpha - body.constant_tilt));
    }
    let (coefficient, law, slide) =
        body.friction.map_or((from(0.0), RestitutionLaw::Newton, Slide::None), |friction| {
            (friction.coefficient, friction.law, friction.slide)
        });
    let still = scene.value(Name::Strike) == Some(Value::Choice("still"));
    let (turned_along, turned_normal) = surface_velocity(scene, body, here);
    let matched = slide == Slide::Matched && off == SensingErrors::default() && !late;
    if matched && noise.is_none_or(|noise| noise.model == NoiseModel::Strike) {
        all.push(("matched table", table_along - along - turned_along));
    }
    if !late && noise.is_none_or(|noise| noise.model == NoiseModel::Strike) {
        let impulse = (pushed_x, pushed_y);
        let velocity = |state: &State<DoubleDouble>| {
            (state.x_dot + l * cos * state.theta_dot, state.y_dot + l * sin * state.theta_dot)
        };
        let (coming, leaving) = (velocity(&before), velocity(&after));
        let work = impulse.0 * (coming.0 + leaving.0) + impulse.1 * (coming.1 + leaving.1);
        all.push(("approach", strike.approach - (normal - table_normal)));
        all.push(("work", strike.energy_gain - from(0.5) * work));
        if slide == Slide::None {
            all.push(("table along itself", table_along - turned_along));
        }
        // All of the table's velocity but what its law gives it is the turning's.
        let told = [Name::AssumedRestitution, Name::SpeedError].iter().any(|name| scene.number(*name).is_some());
        if noise.is_none() && !told && !scene.steers_energy() {
            let share = (from(1.0) - restitution) / (from(1.0) + restitution);
            let law = if still { from(0.0) } else { -(share * normal) };
            all.push(("law of the table's speed", table_normal - law - turned_normal));
        }
    }
    match strike.mode {
        ContactMode::Frictionless => all.push(("no friction", rubbed)),
        ContactMode::Stick => all.push(("sticking", along_after - table_along)),
        ContactMode::Slide => all.push(("sliding", rubbed * rubbed - coefficient * coefficient * pushed * pushed)),
        ContactMode::ReverseSlide | ContactMode::SlideThrough => {}
    }
    // The three laws agree where nothing changes on the way through the impact.
    let steady = matches!(strike.mode, ContactMode::Frictionless | ContactMode::Slide)
        || (matched && turned_along.is_zero() && strike.mode == ContactMode::Stick);
    if law == RestitutionLaw::Newton || (steady && noise.is_none_or(|noise| noise.model == NoiseModel::Strike)) {
        let restored = normal_after - table_normal + restitution * (normal - table_normal);
        all.push(("restitution", restored));
    }
    all
}

/// Velocity of the surface at a contact by its turning, along the table and along its normal, m/s, from the place of the hinge.
fn surface_velocity(scene: &Scene, body: &Body<DoubleDouble>, here: &ExtendedContact) -> (DoubleDouble, DoubleDouble) {
    let State { theta, x_dot, y_dot, theta_dot } = here.state;
    // It turns by the velocities that it senses.
    let off = body.noise.and_then(|noise| noise.sensing(here.n)).unwrap_or_default();
    let (x_dot, y_dot, theta_dot) = (x_dot + from(off.x_dot), y_dot + from(off.y_dot), theta_dot + from(off.theta_dot));
    let turn = match body.is_point {
        true => {
            let push = body.drag.map_or(from(0.0), |drag| drag.linear * drag.wind);
            -(body.rod.gravity * x_dot + push * y_dot) / (x_dot * x_dot + y_dot * y_dot)
        }
        false => theta_dot,
    };
    let number = |name| from(scene.number(name).unwrap_or(0.0));
    let rate = match body.steering {
        Steering::TiltGain => body.rod.tilt_gain * turn,
        Steering::Feedback(gains) => {
            let (braked, slowed) =
                (number(Name::Drag) * (x_dot - number(Name::Wind)), number(Name::RotationDrag) * theta_dot);
            gains.x_dot * braked + gains.theta_dot * slowed - (gains.x * x_dot + gains.theta * turn)
        }
    };
    let (depth, none) = (number(Name::PivotDepth), from(0.0));
    let (sin, cos) = here.strike.unwrap().alpha.sincos();
    // Sideways of the hinge, along the table, the surface moves along its normal.
    let aside = here.x + body.rod.contact_distance * theta.sincos().0 - number(Name::PivotX);
    match (scene.value(Name::TiltRate), scene.number(Name::PivotX)) {
        (Some(Value::Choice("follows")), Some(_)) => {
            // The hinge is below the contact by so much that the surface passes through the contact.
            let below = (depth + aside * sin) / cos;
            let (x, y) = (-rate * below, rate * aside);
            (cos * x + sin * y, cos * y - sin * x)
        }
        (Some(Value::Choice("follows")), None) => (-rate * depth, none),
        (Some(Value::Choice("corrected")), _) if scene.value(Name::Slide) != Some(Value::Choice("matched")) => {
            (-rate * depth, none)
        }
        _ => (none, none),
    }
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
    let mut all = vec![
        ("energy of the flight", energy(&end, height(to)) - energy(&start, height(from_contact))),
        ("height of the contact", fallen - height(to)),
        ("place", to.x - (from_contact.x + start.x_dot * t)),
        ("time", to.t - (from_contact.t + t)),
    ];
    if !body.is_point {
        all.push(("angle", end.theta - (start.theta + start.theta_dot * t)));
    }
    all
}

#[test]
fn every_contact_fulfils_the_identities() {
    let mut random = Random::new(2601);
    let features = all_but(&["triangle", "length", "limits"]);
    let (mut seen, mut worst) = (BTreeMap::new(), 0.0_f64);
    for number in 0..4000 {
        let mix = Mix::draw(&mut random, [Swing::Calm, Swing::Wide][number % 2], &features);
        let (scene, body) = (&mix.scene, mix.scene.body_in());
        let contacts = extended_contacts(scene, 30);
        for (index, here) in contacts.iter().enumerate() {
            let State { x_dot, y_dot, theta_dot, .. } = here.state.to_f64();
            let mut size = 1.0 + x_dot.abs() + y_dot.abs() + theta_dot.abs() + here.x.to_f64().abs();
            if let Some(strike) = here.strike {
                // Where friction nearly jams the contact the impulse is far larger than the velocities before it.
                let State { x_dot, y_dot, theta_dot, .. } = strike.after.to_f64();
                size += x_dot.abs() + y_dot.abs() + theta_dot.abs() + strike.impulse_normal.to_f64().abs();
            }
            // Flights through air are compared with steps of the equations of motion (`drag.rs`).
            let next = contacts.get(index + 1).filter(|_| scene.running_model().drag.is_none());
            let flown = next.map_or_else(Vec::new, |next| of_flight(&body, here, next));
            for (name, remainder) in remainders(scene, &body, here).into_iter().chain(flown) {
                let off = remainder.to_f64().abs() / (size * size);
                worst = worst.max(off);
                assert!(off <= EXACT, "{name} at contact {} is off by {off:e}: {:?} {scene:?}", here.n, mix.features);
            }
        }
        for feature in &mix.features {
            *seen.entry(*feature).or_insert(0) += contacts.len();
        }
    }
    println!("worst remainder {worst:.1e}; contacts {seen:?}");
    assert!(seen.len() == features.len() && seen.values().all(|seen| *seen > 1000), "{seen:?}");
}
