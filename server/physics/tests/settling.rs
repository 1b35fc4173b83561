//! Runs that come to rest: contacts with friction that lose their speed, and strikes that stop the contact point at once. Against a
//! simulation of its own, written from the equations; in the map, with 31 digits and in lanes alike.

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::{Ending, EndingKind};
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use equipoise_physics::surveys::stability_map::{MapAxis, MapOutcome, MapQuantity, StabilityMap};
use random::Random;
use simple::Simple;

use crate::support::rig::{with_numbers, worded};
use crate::support::{random, simple};

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct End {
    ending: Ending,
    impacts: u64,
    first_flight: f64,
    shortest: f64,
}

impl End {
    fn settle_time(&self) -> Option<f64> {
        match self.ending {
            Ending::Settled { settle_time, .. } => Some(settle_time),
            _ => None,
        }
    }
}

fn by_map(scene: &Scene, impacts: u64) -> End {
    let (mut flights, mut last) = (Vec::new(), 0);
    let ending = run(&mut scene.orbit().unwrap(), impacts, |contact| {
        flights.extend(contact.flight_time);
        last = contact.n;
        true
    });
    end_of(ending, last, &flights)
}

fn by_extended(scene: &Scene, impacts: u64) -> End {
    let (mut flights, mut last) = (Vec::new(), 0);
    let ending = orbit::run(&mut scene.extended_orbit().unwrap(), impacts, |contact| {
        flights.extend(contact.flight_time.map(|flight| flight.to_f64()));
        last = contact.n;
        true
    });
    end_of(ending, last, &flights)
}

fn end_of(ending: Option<Ending>, impacts: u64, flights: &[f64]) -> End {
    let shortest = flights.iter().copied().fold(f64::INFINITY, f64::min);
    End { ending: ending.unwrap(), impacts, first_flight: flights.first().copied().unwrap_or(0.0), shortest }
}

/// Contacts and outcome of the same run in a lane: a region of one scene.
fn by_lanes(draft: &Draft, impacts: u64) -> (u64, EndingKind) {
    let Some(Value::Number(theta)) = draft.get(Name::Theta) else { panic!("it has an angle") };
    let Some(Value::Number(kappa)) = draft.get(Name::TiltGain) else { panic!("it has a tilt gain") };
    let axis = |name, value| MapAxis { name, from: value, to: value, count: 2 };
    let region = StabilityMap {
        scene: *draft,
        x: axis(Name::TiltGain, kappa),
        y: axis(Name::Theta, theta),
        impacts,
        quantity: MapQuantity::Survival,
        catch: CatchSettings::default(),
    };
    assert!(region.fits_lanes());
    let cell = region.cells(0..1, &mut || true).unwrap()[0];
    let Some(MapOutcome::Run(outcome)) = cell.outcome else { panic!("{cell:?}") };
    (cell.value.unwrap() as u64, outcome)
}

fn draft(numbers: &[(Name, f64)], choices: &[(Name, &'static str)]) -> Draft {
    worded(with_numbers(Draft::default(), numbers), choices)
}

#[test]
fn contacts_with_friction_come_to_rest_where_the_equations_do() {
    let mut random = Random::new(13);
    let (mut rested, mut stopped, mut others) = (0, 0, 0);
    for number in 0..8000 {
        let l = random.between(0.05, 0.6);
        let mut simple = Simple {
            l,
            rho: l * random.between(0.25, 1.2),
            kappa: random.between(-1.0, 2.5),
            e: if number % 7 == 0 { 0.0 } else { random.between(0.0, 1.0) },
            mu: random.between(0.02, 1.2),
            still: number % 3 == 0,
            law: ["poisson", "newton", "stronge"][number % 3 * number % 5 % 3],
            state: [random.between(-0.5, 0.5), random.between(-0.5, 0.5), 0.0, random.between(-2.0, 2.0)],
        };
        let [theta, x_dot, _, theta_dot] = simple.state;
        let draft = draft(
            &[
                (Name::ContactDistance, l),
                (Name::RadiusOfGyration, simple.rho),
                (Name::TiltGain, simple.kappa),
                (Name::Restitution, simple.e),
                (Name::Friction, simple.mu),
                (Name::Height, l + random.between(0.005, 0.3)),
                (Name::Theta, theta),
                (Name::ThetaDot, theta_dot),
                (Name::XDot, x_dot),
            ],
            &[(Name::Strike, if simple.still { "still" } else { "compensated" }), (Name::Law, simple.law)],
        );
        let scene = draft.build().unwrap();
        // The fall to the first contact is not what is looked at here.
        let orbit = scene.orbit().unwrap();
        let fallen = orbit.state();
        simple.state = [fallen.theta, fallen.x_dot, fallen.y_dot, fallen.theta_dot];
        let most = 4000;
        let (map, exact) = (by_map(&scene, most), by_extended(&scene, most));
        assert!(exact.shortest > 0.0 && map.shortest > 0.0, "{simple:?}: {map:?} {exact:?}");
        let Some((t, first)) = simple.rest(orbit.t()) else {
            others += 1;
            continue;
        };
        let (Some(by_map), Some(by_extended)) = (map.settle_time(), exact.settle_time()) else {
            panic!("{number} {simple:?}: at rest at {t}, {map:?} {exact:?}")
        };
        assert!((by_map - t).abs() <= 1e-9 * t, "{number} {simple:?}: {by_map} {t}");
        assert!((by_extended - t).abs() <= 1e-9 * t, "{number} {simple:?}: {by_extended} {t}");
        assert_eq!(map.impacts, exact.impacts, "{number} {simple:?}: {map:?} {exact:?}");
        assert_eq!(by_lanes(&draft, most), (map.impacts, EndingKind::Settled), "{number} {simple:?}");
        if first == 0.0 { stopped += 1 } else { rested += 1 }
    }
    println!("{rested} come to rest, {stopped} at once, {others} do not");
    assert!(rested > 500 && stopped > 50 && others > 500, "{rested} {stopped} {others}");
}

/// The scene of an independent check: every flight is shorter than the last.
#[test]
fn a_sticking_contact_settles_and_no_flight_is_negative() {
    let numbers = [
        (Name::ContactDistance, 0.5388),
        (Name::RadiusOfGyration, 0.1672),
        (Name::Restitution, 0.0),
        (Name::Friction, 0.91),
        (Name::TiltGain, 2.08),
        (Name::Height, 0.56),
        (Name::Theta, 0.28),
        (Name::ThetaDot, 0.88),
        (Name::XDot, 0.17),
    ];
    let scene = draft(&numbers, &[]).build().unwrap();
    let (map, exact) = (by_map(&scene, 100), by_extended(&scene, 100));
    println!("{map:?} {exact:?}");
    assert_eq!(map.impacts, exact.impacts);
    assert!((map.settle_time().unwrap() - exact.settle_time().unwrap()).abs() < 1e-15);
    assert!(exact.shortest > 0.0);
}

/// A sticking contact that neither loses nor is given normal speed keeps cos 2α of its rise: at rest after a geometric series.
#[test]
fn a_sticking_contact_keeps_cos_2_alpha() {
    // So heavy to turn that the angle stays.
    let numbers = [
        (Name::ContactDistance, 0.001),
        (Name::RadiusOfGyration, 10.0),
        (Name::Restitution, 1.0),
        (Name::Friction, 10.0),
        (Name::TiltGain, 1.0),
        (Name::Height, 0.3),
        (Name::Theta, 0.5),
    ];
    let scene = draft(&numbers, &[]).build().unwrap();
    let orbit = scene.orbit().unwrap();
    let (speed, alpha) = (-orbit.state().y_dot, 0.5_f64);
    // The first strike leaves V cos α along the normal; of its rise V cos²α each further one keeps cos 2α.
    let flights = 2.0 * speed * alpha.cos().powi(2) / 9.81 / (1.0 - (2.0 * alpha).cos());
    let expected = orbit.t() + flights;
    for end in [by_map(&scene, 1000), by_extended(&scene, 1000)] {
        let settle_time = end.settle_time().unwrap();
        assert!((settle_time - expected).abs() < 1e-4 * expected, "{settle_time} {expected}");
        let contacts = 1.0 + (1e-9_f64.ln() / (2.0 * alpha).cos().ln()).ceil();
        assert!((end.impacts as f64 - contacts).abs() <= 1.0, "{end:?} {contacts}");
    }
}

/// e = 0 on a table that stands still leaves no normal velocity: where the contact sticks, or the table is flat, it is a dead stop
/// there and then. Where the contact slides down a tilted table, it is driven down at a speed.
#[test]
fn restitution_0_on_a_still_table_is_a_dead_stop() {
    let mut random = Random::new(0);
    let mut kinds = [0, 0, 0];
    for number in 0..3000 {
        let l = random.between(0.02, 1.0);
        let (flat, smooth) = (number % 3 == 0, number % 4 == 0);
        let friction = if smooth { 0.0 } else { random.between(0.01, 3.0) };
        let law = ["poisson", "newton", "stronge"][number % 5 % 3];
        let draft = draft(
            &[
                (Name::ContactDistance, l),
                (Name::RadiusOfGyration, l * random.size(0.05, 2.0).abs()),
                (Name::TiltGain, if flat { 0.0 } else { random.between(-2.0, 2.0) }),
                (Name::Restitution, 0.0),
                (Name::Friction, friction),
                (Name::Height, l + random.size(1e-3, 3.0).abs()),
                (Name::Theta, random.between(-1.0, 1.0)),
                (Name::ThetaDot, random.between(-8.0, 8.0)),
                (Name::XDot, random.between(-2.0, 2.0)),
            ],
            &[(Name::Strike, "still"), (Name::Law, law)],
        );
        let scene = draft.build().unwrap();
        let mut orbit = scene.orbit().unwrap();
        let (t, contact) = (orbit.t(), orbit.advance());
        let Some(strike) = contact.strike else { continue };
        let (map, exact) = (by_map(&scene, 50), by_extended(&scene, 50));
        let said = format!("{number}: {map:?} {exact:?}");
        if flat || strike.mode.name() == "stick" {
            kinds[0] += 1;
            assert_eq!((map.settle_time(), map.impacts), (Some(t), 1), "{said}");
            assert_eq!((exact.settle_time().is_some(), exact.impacts), (true, 1), "{said}");
            assert_eq!(by_lanes(&draft, 50), (1, EndingKind::Settled), "{said}");
        } else if strike.contact_rise < -1e-9 {
            kinds[1] += 1;
            assert!(matches!(map.ending, Ending::Sinking { contact_rise } if contact_rise < -1e-9), "{said}");
            assert!(matches!(exact.ending, Ending::Sinking { contact_rise } if contact_rise < -1e-9), "{said}");
            assert_eq!(by_lanes(&draft, 50), (1, EndingKind::Sinking), "{said}");
        } else {
            kinds[2] += 1;
            assert!(map.impacts > 1 && exact.impacts > 1, "{said}");
        }
    }
    println!("{kinds:?}");
    assert!(kinds.iter().all(|&count| count > 100), "{kinds:?}");
}

/// A strike that leaves the contact point all but grazing y = 0, at a speed: a short flight, and the run goes on.
#[test]
fn a_graze_is_not_rest() {
    let mut random = Random::new(5);
    let mut grazes = 0;
    for number in 0..400 {
        let l = random.between(0.1, 0.5);
        let (kappa, friction) = (random.between(1.5, 3.0), random.between(0.01, 0.3));
        let (height, x_dot) = (l + random.between(0.05, 0.3), random.between(-0.5, 0.5));
        let rho = l * random.between(0.4, 1.0);
        let scene = |theta: f64| {
            let energy_gain = number % 2 == 0;
            let mut draft = draft(
                &[
                    (Name::ContactDistance, l),
                    (Name::RadiusOfGyration, rho),
                    (Name::TiltGain, kappa),
                    (Name::Restitution, 0.8),
                    (Name::Height, height),
                    (Name::Theta, theta),
                    (Name::XDot, x_dot),
                ],
                &[],
            );
            let more: &[(Name, f64)] = if energy_gain {
                &[(Name::EnergyGain, 0.1), (Name::TargetHeight, height)]
            } else {
                &[(Name::Friction, friction)]
            };
            for &(name, value) in more {
                draft.set(name, Some(Value::Number(value))).unwrap();
            }
            draft.build().unwrap()
        };
        // ẏ_c after the second strike, where there is one.
        let rise = |theta: f64| {
            let mut orbit = scene(theta).orbit().unwrap();
            orbit.advance().flight_time?;
            orbit.advance().strike.map(|strike| strike.contact_rise)
        };
        let angles: Vec<f64> = (1..100).map(|step| 0.01 * f64::from(step)).collect();
        let crosses = |pair: &&[f64]| match (rise(pair[0]), rise(pair[1])) {
            (Some(one), Some(other)) => (one > 0.0) != (other > 0.0),
            _ => false,
        };
        let Some(&[one, other]) = angles.windows(2).find(crosses) else { continue };
        let (mut above, mut below) = if rise(one).unwrap() > 0.0 { (one, other) } else { (other, one) };
        for _ in 0..60 {
            let middle = 0.5 * (above + below);
            match rise(middle) {
                Some(rise) if rise > 0.0 => above = middle,
                Some(_) => below = middle,
                None => break,
            }
        }
        // On both sides of where doubles can tell.
        for away in [0.0, 1e-15, 1e-13, 1e-12, 1e-11] {
            let scene = scene(above + away * (above - below).signum());
            assert!(scene.rules().settles);
            let (map, exact) = (by_map(&scene, 10), by_extended(&scene, 10));
            for end in [map, exact] {
                assert!(!matches!(end.ending, Ending::Settled { .. }), "{number} {away:e}: {end:?}");
                assert!(end.shortest > 0.0, "{number} {away:e}: {end:?}");
            }
            grazes += u32::from(map.shortest < 1e-9 * map.first_flight);
        }
    }
    println!("{grazes} flights as short as that of a run that has settled");
    assert!(grazes > 20, "{grazes}");
}

/// Rises that doubles cannot tell from 0: with 31 digits every flight still has its own length.
#[test]
fn no_flight_of_31_digits_is_negative() {
    let mut random = Random::new(77);
    let mut short = 0;
    for number in 0..2000 {
        let l = random.between(0.05, 0.6);
        let tiny = random.size(1e-18, 1e-9).abs();
        let theta = random.between(-1.0, 1.0);
        let theta_dot = random.size(0.1, 30.0);
        // The contact point at y = 0 to the last digit, rising by next to nothing.
        let draft = draft(
            &[
                (Name::ContactDistance, l),
                (Name::RadiusOfGyration, l * random.between(0.3, 1.2)),
                (Name::TiltGain, random.between(-1.0, 2.5)),
                (Name::Friction, if number % 2 == 0 { 0.0 } else { random.between(0.05, 1.0) }),
                (Name::Restitution, random.between(0.0, 1.0)),
                (Name::Height, l * theta.cos()),
                (Name::Theta, theta),
                (Name::ThetaDot, theta_dot),
                (Name::YDot, -l * theta_dot * theta.sin() + tiny),
            ],
            &[(Name::Strike, if number % 3 == 0 { "still" } else { "compensated" })],
        );
        let Ok(scene) = draft.build() else { continue };
        let Ok(mut orbit) = scene.extended_orbit() else { continue };
        let first = orbit.t().to_f64();
        assert!(first >= 0.0, "{number}: {first}");
        short += u32::from(first > 0.0 && first < 1e-12);
        orbit::run(&mut orbit, 200, |contact| {
            let flight = contact.flight_time.map_or(1.0, DoubleDouble::to_f64);
            assert!(flight > 0.0, "{number}: {contact:?}");
            true
        });
    }
    println!("{short} first flights are shorter than a picosecond");
    assert!(short > 100, "{short}");
}
