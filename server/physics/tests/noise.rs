//! Noise in runs: case 1 with a table that errs by 10 ms, under both readings.

use crate::paper;
use crate::support::lone_runs::alone;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::surveys::ensemble::{Ensemble, EnsembleRuns};

fn case_1(model: &'static str, timing_sd: f64, theta: f64) -> Scene {
    let mut draft = paper::scene(1.1, theta).draft();
    draft.set(Name::TimingSd, Some(Value::Number(timing_sd))).unwrap();
    draft.set(Name::NoiseModel, Some(Value::Choice(model))).unwrap();
    draft.build().unwrap()
}

/// Contacts of each of `runs` runs, and how they ended.
fn ends(scene: &Scene, runs: u64, impacts: u64) -> Vec<(u64, &'static str)> {
    (0..runs)
        .map(|number| match scene.orbit_of(number) {
            Ok(mut orbit) => {
                let ending = run(&mut orbit, impacts, |_| true).unwrap();
                (orbit.contacts(), ending.name())
            }
            Err(no_contact) => (0, no_contact.ending(0.0, 0.0).name()),
        })
        .collect()
}

fn survival(ends: &[(u64, &str)]) -> f64 {
    ends.iter().filter(|(_, outcome)| *outcome == "completed").count() as f64 / ends.len() as f64
}

#[test]
fn survival_is_that_of_the_readings() {
    let count = |ends: &[(u64, &'static str)]| {
        let mut names: Vec<_> = ends.iter().map(|(_, name)| *name).collect();
        names.sort_unstable();
        names.dedup();
        names.iter().map(|name| (*name, ends.iter().filter(|(_, other)| other == name).count())).collect::<Vec<_>>()
    };
    let strike = ends(&case_1("strike", 0.01, 0.3), 1000, 400);
    let plan = ends(&case_1("plan", 0.01, 0.3), 1000, 400);
    let early = plan.iter().filter(|(n, _)| *n <= 10).count();
    println!("strike {} {:?}", survival(&strike), count(&strike));
    println!("plan {} {:?}; {early} within 10", survival(&plan), count(&plan));
    let narrow = ends(&case_1("strike", 0.01, 0.1), 400, 400);
    println!("strike from 0.1: {}", survival(&narrow));
    assert!((survival(&strike) - 0.45).abs() < 0.08);
    assert!((survival(&plan) - 0.07).abs() < 0.03);
    assert_eq!(survival(&narrow), 1.0);
}

/// Runs in lanes and their angles are those of the runs alone, in the order of the runs, whether they fall early or stand.
#[test]
fn an_ensemble_is_its_runs() {
    for (model, timing_sd, runs) in [("strike", 0.01, 150), ("strike", 0.002, 40), ("plan", 0.002, 20)] {
        let ensemble = Ensemble { scene: case_1(model, timing_sd, 0.3), runs, impacts: 200, angle_contacts: 30 };
        assert!(ensemble.fits_lanes());
        let watched = ensemble.watched();
        let numbers = 3..runs;
        let mut expected = EnsembleRuns { ends: Vec::new(), angles: vec![Vec::new(); watched.len()] };
        for number in numbers.clone() {
            let mut orbit = ensemble.scene.orbit_of(number).unwrap();
            expected.ends.push(alone(orbit, ensemble.impacts));
            run(&mut orbit, ensemble.impacts, |contact| {
                let went_on = matches!(contact.ending, None | Some(Ending::Completed));
                if let (true, Ok(place)) = (went_on, watched.binary_search(&contact.n)) {
                    expected.angles[place].push(contact.state.theta.abs());
                }
                true
            });
        }
        assert_eq!(ensemble.runs(numbers, &mut || true), Some(expected), "{model} {timing_sd}");
    }
}

#[test]
fn a_scene_may_be_any_run_of_its_ensemble() {
    let scene = case_1("plan", 0.002, 0.1);
    let mut draft = scene.draft();
    draft.set(Name::NoiseRun, Some(Value::Integer(3))).unwrap();
    let mut ends = [scene.orbit_of(3), draft.build().unwrap().orbit(), scene.orbit()].map(|orbit| {
        let mut orbit = orbit.unwrap();
        run(&mut orbit, 20, |_| true);
        *orbit.state()
    });
    assert_eq!(ends[0], ends[1]);
    ends.rotate_left(1);
    assert_ne!(ends[0], ends[1]);
}

#[test]
fn a_release_on_the_table_is_struck_about_then() {
    for model in ["strike", "plan"] {
        let mut draft = case_1(model, 0.002, 0.0).draft();
        for (name, number) in [(Name::Height, 0.4 / 3.0), (Name::YDot, -1.0)] {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        let scene = draft.build().unwrap();
        for number in 0..50 {
            let orbit = scene.orbit_of(number).unwrap();
            assert!(orbit.t() > 0.0 && orbit.t() < 0.01, "{model}: {}", orbit.t());
        }
    }
}

/// A body that spins fast in little gravity over a plane that is planned nearly vertical: the flights to it last for days, and each
/// is computed to its end.
#[test]
fn a_nearly_vertical_plan_is_met_or_missed() {
    let mut draft = paper::scene(-46.3055, 0.0).draft();
    for (name, value) in [
        (Name::Gravity, 0.1),
        (Name::Incline, 0.01),
        (Name::ContactDistance, 1.0),
        (Name::RadiusOfGyration, 1.0),
        (Name::Height, 100.0),
        (Name::ThetaDot, 164.18),
        (Name::XDot, 59.06),
        (Name::YDot, 100.0),
        (Name::ToppleAngle, std::f64::consts::PI),
        (Name::TimingSd, 0.01),
        (Name::AngleSd, 0.01),
    ] {
        draft.set(name, Some(Value::Number(value))).unwrap();
    }
    draft.set(Name::NoiseModel, Some(Value::Choice("plan"))).unwrap();
    draft.set(Name::Seed, Some(Value::Integer(1))).unwrap();
    let ends = ends(&draft.build().unwrap(), 2000, 1);
    for outcome in ["missed", "toppled"] {
        assert!(ends.iter().any(|(_, name)| *name == outcome), "none is {outcome}");
    }
    let undecided = ends.iter().filter(|(_, name)| *name == "diverged").count();
    assert_eq!(undecided, 0, "flights to the plan given up");
    // The one that took 131,072 pieces and had no end.
    assert_eq!(ends[22], (1, "toppled"));
}
