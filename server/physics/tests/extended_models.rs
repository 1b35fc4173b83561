//! Runs with 31 digits of scenes beyond the plain rod, by exact identities at each of their contacts.

use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::{RestitutionLaw, Slide};
use equipoise_physics::map::strike::{ContactMode, State};
use equipoise_physics::map::table::control_law::{Gains, Steering};
use equipoise_physics::map::table::noise::{NoiseModel, SensingErrors};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::ExtendedContact;
use equipoise_physics::scene::{Name, Scene, Value};
use std::collections::BTreeMap;

/// Bound on the remainder of an identity whose terms are about 1.
const EXACT: f64 = 1e-29;

fn contacts(scene: &Scene, impacts: u64) -> Vec<ExtendedContact> {
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
    // Tables that are late are compared with a simulation (`delay.rs`).
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
        let contacts = contacts(scene, 30);
        for (index, here) in contacts.iter().enumerate() {
            let State { x_dot, y_dot, theta_dot, .. } = here.state.to_f64();
            let mut size = 1.0 + x_dot.abs() + y_dot.abs() + theta_dot.abs() + here.x.to_f64().abs();
            if let Some(strike) = here.strike {
                // Where friction nearly jams the contact the impulse is far larger than the velocities before it.
                let State { x_dot, y_dot, theta_dot, .. } = strike.after.to_f64();
                size += x_dot.abs() + y_dot.abs() + theta_dot.abs() + strike.impulse_normal.to_f64().abs();
            }
            // Flights through air are compared with steps of the equations of motion (`drag.rs`).
            let next = contacts.get(index + 1).filter(|_| scene.drag().is_none());
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
