//! Rotation, chaos and horizon of runs against what is known of them; false rates of the chaos indicator on runs that are
//! labelled by what they do over 30,000 contacts.

use crate::paper;
use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random;
use crate::support::scenes;
use equipoise_physics::analysis::boundary::period_two_angle;
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::regularity::{
    Regularity, RotationCounter, Rows, TOLERANCE, Tangents, WATCHED, WatchedContact, measure_regularity,
    nearest_resonance, weighted_average,
};
use equipoise_physics::analysis::return_map::{COMPONENTS, ReturnMap, Vector};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use paper::scene;
use random::Random;
use scenes::Kind;

fn regularity(scene: &Scene) -> Regularity {
    measure_regularity(scene.orbit().unwrap(), &small_deviations(scene).unwrap(), WATCHED).unwrap()
}

#[test]
fn small_starts_turn_as_the_linear_map_says() {
    for tilt_gain in [1.02, 1.1, 1.25, 1.37, 1.45, 1.49] {
        let mut last = f64::INFINITY;
        for theta in [1e-2, 1e-3, 1e-4] {
            let rotation = regularity(&scene(tilt_gain, theta)).rotation.unwrap();
            let error = (rotation.measured.unwrap() - rotation.linear).abs();
            assert!(error < 50.0 * theta * theta + 1e-9, "κ = {tilt_gain}, θ₀ = {theta}: {error:e}");
            assert!(error <= last + 1e-9);
            last = error;
        }
    }
    // Upright there is nothing to turn, and no start from which chaos could be told.
    let upright = regularity(&scene(1.1, 0.0));
    assert_eq!((upright.rotation.unwrap().measured, upright.chaos), (None, None));
    assert_eq!(regularity(&scene(1.52, 0.01)).rotation, None);
}

#[test]
fn resonances_are_the_nearest_of_low_order() {
    for (turns, p, q) in [(0.3334, 1, 3), (0.25, 1, 4), (0.5, 1, 2), (0.374, 3, 8), (0.001, 0, 1), (0.287, 2, 7)] {
        let nearest = nearest_resonance(turns);
        assert_eq!((nearest.p, nearest.q), (p, q), "{turns}");
        assert!((nearest.distance - (turns - f64::from(p) / f64::from(q)).abs()).abs() < 1e-15);
    }
}

/// It falls soon after 500 contacts, and is lost long before.
fn lost() -> Scene {
    scene(1.265755, 0.15376)
}

#[test]
fn the_horizon_grows_with_the_tolerance() {
    let chaotic = regularity(&lost());
    let mut last = 0;
    for exponent in -14..3 {
        let horizon = chaotic.predictable_impacts(10.0_f64.powi(exponent)).unwrap_or(u64::MAX);
        assert!(horizon >= last);
        last = horizon;
    }
    assert!(chaotic.predictable_impacts(TOLERANCE).is_some());
    assert_eq!(regularity(&scene(1.1, 0.1)).predictable_impacts(TOLERANCE), None);
}

#[test]
fn the_horizon_is_where_a_twin_is_lost() {
    // Two runs a rounding apart are off by the tolerance near the horizon, not long before and not long after.
    let scene = lost();
    let horizon = regularity(&scene).predictable_impacts(TOLERANCE).unwrap();
    let (mut orbit, first) = (scene.orbit().unwrap(), *scene.orbit().unwrap().state());
    let mut state = first;
    state.theta *= 1.0 + f64::EPSILON;
    let mut twin = Orbit::at(scene.model(), scene.rules(), state);
    let mut lost = 0;
    for n in 1..=WATCHED {
        let (one, other) = (orbit.advance(), twin.advance());
        if (one.state.y_dot - other.state.y_dot).abs() > TOLERANCE || one.ending.is_some() {
            lost = n;
            break;
        }
    }
    println!("horizon {horizon}, lost at {lost}");
    assert!(horizon <= 2 * lost && lost <= 2 * horizon, "{horizon} {lost}");
}

/// Step of a difference, as a share of a tangent. Its square is far below the last digit of doubles.
const STEP: f64 = 1e-10;

/// Carries tangents over a contact and the flight after it by differences of the map with 31 digits; `None` if a side has no flight.
fn carry_by_differences<const K: usize>(map: &ReturnMap, rows: &Rows<K>, before: &Vector) -> Option<Rows<K>> {
    let mut carried = [[0.0; K]; COMPONENTS];
    // Rows have angles, and vectors ρ times them.
    let rho = map.body.rod.radius_of_gyration;
    let lengths = [rho, 1.0, 1.0, rho, 1.0, 1.0, 1.0, 1.0];
    for tangent in 0..K {
        let end = |step: f64| {
            map.image(&std::array::from_fn(|row| {
                let along = DoubleDouble::from(lengths[row] * rows[row][tangent]);
                DoubleDouble::from(before[row]) + DoubleDouble::from(step) * along
            }))
        };
        for (row, (ahead, behind)) in end(STEP)?.into_iter().zip(end(-STEP)?).enumerate() {
            carried[row][tangent] = (ahead - behind).to_f64() / (2.0 * STEP) / lengths[row];
        }
    }
    Some(carried)
}

/// Speed of a contact as a share of ρ/τ, and of a point mass of Gτ/2, below which tangents are not compared.
const SLOW: f64 = 1e-2;

/// Largest difference that dual numbers and differences make over one contact of a run, in tangents with a joint norm of 1 m/s and in the
/// logarithm of their growth; and the number of contacts.
fn compare_tangents<const K: usize>(scene: &Scene, impacts: u64) -> (f64, u64) {
    let body = scene.model();
    let rod = body.rod;
    let Ok(mut orbit) = scene.orbit() else { return (0.0, 0) };
    let typical =
        small_deviations(scene).map(|small| small.fixed_point).map_or(1.0, |fixed_point| fixed_point.flight_time);
    // The angle of a point mass is that of its velocity, and no part of the state.
    let rho = if body.is_point { 0.0 } else { rod.radius_of_gyration };
    let speed = 0.5 * rod.gravity * typical;
    let place = if K > 4 && ReturnMap::new(&body, 1).components().contains(&4) { 1.0 / typical } else { 0.0 };
    let scales = [rho / typical, 1.0, 1.0, rho, place, speed, 1.0, 1.0];
    let mut ours = Tangents::<K>::new(&body, &orbit.coming(), typical);
    let mut most = 0.0_f64;
    for n in 0..impacts {
        let coming = orbit.coming();
        let Some(contact) = WatchedContact::of(&orbit.advance()) else { return (most, n) };
        // Slow contacts near rest have lost digits of their speed before either way begins.
        if body.contact_speed(&contact.state).abs() < SLOW * if body.is_point { speed } else { scales[0] } {
            return (most, n);
        }
        let map = ReturnMap::new(&body.from_contact(contact.n), 1);
        // A motion that is planned before the last strike is a part of the state.
        let plans = coming.plan.is_some() || orbit.coming().plan.is_some();
        let map = if plans { map.planning() } else { map };
        let mut before = map.vector(&contact.state, contact.x);
        if let Some(plan) = coming.plan {
            [before[5], before[6], before[7]] = [plan.alpha, plan.normal_velocity, plan.tangential_velocity];
        }
        // The map of such states plans for each of them.
        if plans && (coming.plan.is_none() || orbit.coming().plan.is_none()) {
            ours.pass(&contact);
            continue;
        }
        let Some(theirs) = carry_by_differences(&map, &ours.rows, &before) else { return (most, n) };
        let grown = ours.pass(&contact);
        let scaled = theirs.iter().zip(scales).flat_map(|(row, scale)| row.map(|partial| scale * partial));
        let norm = scaled.map(|number| number * number).sum::<f64>().sqrt();
        most = most.max((grown.ln() - norm.ln()).abs());
        for ((ours, theirs), scale) in ours.rows.iter().zip(&theirs).zip(scales) {
            for (ours, theirs) in ours.iter().zip(theirs) {
                let difference = scale * (ours - theirs / norm).abs();
                assert!(difference.is_finite());
                most = most.max(difference);
            }
        }
    }
    (most, impacts)
}

#[test]
fn tangents_are_differences_of_runs() {
    let mut random = Random::new(2024);
    for kind in [
        Kind::Regular,
        Kind::Small,
        Kind::Chaotic,
        Kind::Still,
        Kind::Feedback,
        Kind::Wide,
        Kind::Total,
        Kind::OneStrike,
    ] {
        let (mut most, mut contacts) = (0.0_f64, 0);
        for _ in 0..40 {
            let (difference, passed) = compare_tangents::<4>(&scenes::scene(&mut random, kind), WATCHED);
            most = most.max(difference);
            contacts += passed;
        }
        println!("{kind:?}: at most {most:.1e} over {contacts} contacts");
        // Where the contact point of a fast spin nearly grazes, the length of the flight has lost digits.
        let allowed = if kind == Kind::Wide { 1e-5 } else { 1e-12 };
        assert!(contacts > 40 && most < allowed, "{kind:?}: {most:e}, {contacts} contacts");
    }
}

#[test]
fn tangents_of_any_mix_are_differences_of_runs() {
    let mut random = Random::new(2025);
    let from = all_but(&RANDOM);
    let mut contacts = 0;
    for _ in 0..150 {
        let mix = Mix::draw(&mut random, Swing::Calm, &from);
        let (most, passed) = compare_tangents::<5>(&mix.scene, 40);
        contacts += passed;
        assert!(most < 1e-8, "{:?}: {most:e} over {passed} contacts", mix.features);
    }
    assert!(contacts > 2000, "{contacts}");
}

/// Turns a bounce of the angle by the changes of sign of its second difference, which are two a turn and know no slow lean; up to contact
/// `impacts` or until it is below `least`.
fn turns_by_signs(scene: &Scene, impacts: u64, least: f64) -> f64 {
    let mut orbit = scene.orbit().unwrap();
    let angles: Vec<f64> = (0..impacts).map(|_| orbit.advance().state.theta).collect();
    let bends: Vec<f64> = angles.windows(3).map(|three| three[2] - 2.0 * three[1] + three[0]).collect();
    let last = bends.iter().rposition(|bend| bend.abs() > least).unwrap();
    let changes = bends[..=last].windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    0.5 * changes as f64 / last as f64
}

#[test]
fn angles_turn_by_the_pair_of_the_map_where_there_is_no_residue() {
    let mut beyond = 0;
    for fields in [
        &[(Name::RotationDrag, 0.02)][..],
        &[(Name::RotationDrag, 0.02), (Name::Drag, 0.02), (Name::EnergyGain, 0.2)],
        &[(Name::FeedbackTheta, -1.1), (Name::FeedbackThetaDot, -5e-4)],
        &[(Name::FeedbackTheta, -1.1), (Name::FeedbackXDot, 2e-3)],
        &[(Name::Delay, 1e-3)],
    ] {
        let mut draft = scene(1.1, 1e-4).draft();
        for &(name, value) in fields {
            if name == Name::FeedbackTheta {
                draft.set(Name::TiltGain, None).unwrap();
            }
            if name == Name::EnergyGain {
                draft.set(Name::TargetHeight, Some(Value::Number(0.2))).unwrap();
            }
            draft.set(name, Some(Value::Number(value))).unwrap();
        }
        let scene = draft.build().unwrap();
        let found = regularity(&scene);
        let rotation = found.rotation.unwrap();
        let counted = turns_by_signs(&scene, 100, 1e-8);
        println!("{fields:?}: {rotation:?}, {counted}");
        // Within a change of sign.
        assert!((rotation.linear - counted).abs() < 0.006, "{fields:?}: {rotation:?} {counted}");
        if let Some(measured) = rotation.measured {
            assert!((measured - rotation.linear).abs() < 2e-3, "{fields:?}: {rotation:?}");
            beyond += 1;
        }
    }
    assert!(beyond >= 3);
}

#[test]
fn the_period_two_orbit_is_one() {
    for tilt_gain in [1.501, 1.51, 1.53] {
        let scene = scene(tilt_gain, 0.01);
        let fixed_point = small_deviations(&scene).unwrap().fixed_point;
        let theta = period_two_angle(&scene.model(), scene.rules().topple_angle, &fixed_point).unwrap();
        // κ − κ_c ≈ a C θ², a = 1/2, C = 2/3.
        assert!((theta / (3.0 * (tilt_gain - 1.5)).sqrt() - 1.0).abs() < 0.15, "{theta}");
        let rod = scene.model().rod;
        let (length, rho) = (rod.contact_distance, rod.radius_of_gyration);
        let alpha = tilt_gain * theta;
        let speed_squared =
            rod.gravity * rho * rho * theta * alpha.cos() / (length * ((tilt_gain - 1.0) * theta).sin());
        let speed = speed_squared.sqrt();
        let start = State { theta, x_dot: speed * alpha.tan(), y_dot: -speed, theta_dot: rod.gravity * theta / speed };
        let mut orbit = Orbit::at(Body::plain(rod), scene.rules(), start);
        let energy = 0.5 * fixed_point.speed * fixed_point.speed + rod.gravity * length;
        assert!((rod.energy(&start) - energy).abs() < 1e-12);
        orbit.advance();
        assert!((orbit.state().theta + theta).abs() < 1e-12);
        orbit.advance();
        assert!((orbit.state().theta - theta).abs() < 1e-12);
    }
    let stable = scene(1.45, 0.01);
    let fixed_point = small_deviations(&stable).unwrap().fixed_point;
    assert_eq!(period_two_angle(&stable.model(), stable.rules().topple_angle, &fixed_point), None);
}

/// Classifies a run by 30,000 contacts. `true` is chaotic: the run falls, or a twin 1e-10 rad aside separates from it. `false` is
/// regular: both halves turn at the same rate. `None` if neither is clear.
fn label(one: &Scene, other: &Scene) -> Option<bool> {
    let fixed_point = small_deviations(one).unwrap().fixed_point;
    let mut turns = RotationCounter::new(&fixed_point, &small_deviations(one).unwrap().linear)?;
    let (mut orbit, mut twin) = (one.orbit().unwrap(), other.orbit().unwrap());
    let (mut advances, mut separation) = (Vec::new(), 0.0_f64);
    for _ in 0..30_000 {
        let (contact, beside) = (orbit.advance(), twin.advance());
        if contact.ending.is_some() || beside.ending.is_some() {
            return Some(true);
        }
        advances.extend(turns.next(&contact.state, contact.x, None));
        separation = separation.max((contact.state.theta - beside.state.theta).abs());
        if separation > 1e-3 {
            return Some(true);
        }
    }
    let (first, second) = advances.split_at(advances.len() / 2);
    let change = weighted_average(first).unwrap() - weighted_average(second).unwrap();
    (separation < 1e-4 && change.abs() < 1e-7).then_some(false)
}

/// Counts of right and wrong verdicts of the indicator.
#[derive(Debug, Default)]
struct Tally {
    regular: u32,
    /// Regular, called chaotic.
    alarms: u32,
    chaotic: u32,
    /// Chaotic, called regular.
    missed: u32,
    unclear: u32,
    /// Ended within the contacts that were watched.
    fell: u32,
}

impl Tally {
    /// Tally of scenes, each with a twin 1e-10 rad aside.
    fn of(pairs: impl Iterator<Item = (Scene, Scene)>) -> Self {
        let mut tally = Self::default();
        for (one, twin) in pairs {
            let Some(chaos) = regularity(&one).chaos else {
                let run = run_nonlinear(&one, WATCHED, || true).unwrap();
                assert_ne!(run.ending, Ending::Completed);
                tally.fell += 1;
                continue;
            };
            match label(&one, &twin) {
                None => tally.unclear += 1,
                Some(false) => {
                    tally.regular += 1;
                    tally.alarms += u32::from(chaos.chaotic);
                }
                Some(true) => {
                    tally.chaotic += 1;
                    tally.missed += u32::from(!chaos.chaotic);
                }
            }
        }
        println!("within {WATCHED} contacts: {tally:?}");
        tally
    }
}

/// The set on which the threshold was chosen.
#[test]
fn the_chaos_indicator_is_seldom_wrong() {
    let cells = (0..40 * 18).map(|cell| (f64::from(cell / 18), f64::from(cell % 18)));
    let tally = Tally::of(cells.map(|(column, row)| {
        let tilt_gain = 1.02 + 0.46 * (column + 0.37) / 40.0;
        let theta = 0.1 + 0.29 * (row + 0.61) / 18.0;
        (scene(tilt_gain, theta), scene(tilt_gain, theta + 1e-10))
    }));
    assert!(tally.regular > 200 && tally.chaotic > 15, "{tally:?}");
    assert!(tally.alarms * 100 <= tally.regular && tally.missed * 3 <= tally.chaotic, "{tally:?}");
}

/// Other bodies, heights and releases: a set that nothing was chosen on.
#[test]
fn the_chaos_indicator_is_seldom_wrong_on_other_bodies() {
    let mut random = Random::new(7);
    let tally = Tally::of((0..1500).map(|_| {
        let length = random.between(0.05, 0.5);
        let (rho, above) = (length * random.between(0.35, 1.2), length * random.between(0.2, 2.0));
        // V² = 2 G (height − l) at rest, R = (κ − 1) V² l/(G ρ²).
        let tilt_gain = 1.0 + random.between(0.03, 1.03) * rho * rho / (2.0 * above * length);
        let speed = (2.0 * 9.81 * above).sqrt();
        let (theta, x_dot) = (random.between(0.02, 0.45), speed * random.between(-0.1, 0.1));
        // As much drift as that.
        let theta_dot = speed * random.between(-0.1, 0.1) * (tilt_gain - 1.0) * length / (tilt_gain * rho * rho);
        let build = |theta: f64| {
            let mut draft = Draft::default();
            for (name, value) in [
                (Name::ContactDistance, length),
                (Name::RadiusOfGyration, rho),
                (Name::Height, length + above),
                (Name::TiltGain, tilt_gain),
                (Name::Theta, theta),
                (Name::ThetaDot, theta_dot),
                (Name::XDot, x_dot),
            ] {
                draft.set(name, Some(Value::Number(value))).unwrap();
            }
            draft.build().unwrap()
        };
        (build(theta), build(theta + 1e-10))
    }));
    assert!(tally.regular > 200 && tally.chaotic > 15, "{tally:?}");
    assert!(tally.alarms * 50 <= tally.regular && tally.missed * 2 <= tally.chaotic, "{tally:?}");
}
