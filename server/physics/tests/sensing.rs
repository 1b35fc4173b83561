//! Random errors of place and velocities and scatter of restitution: exact properties. `properties.rs` holds their runs to a simulation.

use crate::paper;
use crate::support::features::{Mix, Swing};
use crate::support::random;
use crate::support::rig_runs;
use equipoise_physics::analysis::model_hierarchy::at_level;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::surveys::ensemble::Ensemble;
use random::Random;
use rig_runs::{states, with};

/// A random scene of a table that senses with errors.
fn random_scene(random: &mut Random) -> Scene {
    let features = ["sensing", "scatter", "wrong belief", "feedback", "vertical energy"];
    let mut drawn = std::iter::repeat_with(|| Mix::draw(random, Swing::Calm, &features));
    drawn.find(|mix| mix.has(&["sensing"])).unwrap().scene
}

/// A plan that is carried out in time is the strike that it was made for.
#[test]
fn plans_without_errors_of_time_are_strikes() {
    let (mut random, mut compared) = (Random::new(1803), 0);
    for _ in 0..100 {
        let scene = random_scene(&mut random);
        let mut draft = scene.draft();
        draft.set(Name::NoiseModel, Some(Value::Choice("plan"))).unwrap();
        let ((strike, _), (plan, _)) = (states(&scene, 6), states(&draft.build().unwrap(), 6));
        // Of a body that leans far, or hardly falls, a moving plane may be met earlier.
        for (one, other) in strike.iter().zip(&plan).take_while(|(one, _)| one[2].abs() < 0.2 && one[4] < -0.3) {
            compared += 1;
            for (a, b) in one.iter().zip(other) {
                assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{one:?}\n{other:?}\n{scene:?}");
            }
        }
    }
    assert!(compared > 250, "{compared}");
}

#[test]
fn errors_of_what_a_table_does_not_look_at_leave_the_run_as_it_is() {
    let ideal = paper::scene(1.1, 0.1);
    // A table at rest that does not look at x or at velocities has nothing to be wrong about.
    let blind =
        with(ideal.draft(), &[(Name::XSd, 0.1), (Name::XDotSd, 0.1), (Name::YDotSd, 0.1), (Name::ThetaDotSd, 1.0)]);
    let ((one, _), (other, _)) = (states(&blind, 30), states(&ideal, 30));
    for (a, b) in one.iter().flatten().zip(other.iter().flatten()) {
        assert!((a - b).abs() < 1e-11, "{a} {b}");
    }
    assert_eq!(blind.model_level(), ModelLevel::Noise);
    let below = at_level(&blind, ModelLevel::Friction).unwrap();
    assert_eq!(below.value(Name::YDotSd), None);
    assert_eq!(states(&below, 100), states(&ideal, 100));
}

#[test]
fn runs_follow_from_seed_and_number() {
    let mut random = Random::new(1804);
    let scene = random_scene(&mut random);
    let numbered = |seed: u64, number: u64| {
        let mut draft = with(scene.draft(), &[(Name::RestitutionSd, 0.01)]).draft();
        draft.set(Name::Seed, Some(Value::Integer(seed))).unwrap();
        draft.set(Name::NoiseRun, Some(Value::Integer(number))).unwrap();
        draft.build().unwrap()
    };
    let once = states(&numbered(3, 5), 20);
    assert_eq!(states(&numbered(3, 5), 20), once);
    assert_ne!(states(&numbered(3, 6), 20), once);
    assert_ne!(states(&numbered(4, 5), 20), once);
    // And an ensemble has just these runs.
    let ensemble = Ensemble { scene: numbered(3, 0), runs: 8, impacts: 20, angle_contacts: 20 };
    assert!(ensemble.fits_lanes());
    let runs = ensemble.runs(0..8, &mut || true).unwrap();
    let ends: Vec<_> = (0..8).map(|number| states(&numbered(3, number), 20).0.len() as u64).collect();
    assert_eq!(runs.ends.iter().map(|end| end.impacts).collect::<Vec<_>>(), ends);
    let place = ensemble.watched().iter().position(|n| *n == 2).unwrap();
    let angles: Vec<_> = (0..8).map(|number| states(&numbered(3, number), 20).0[1][2].abs()).collect();
    assert_eq!(runs.angles[place], angles);
}

/// e = 1 can only scatter downwards: bounces die out, which the table does not make up.
#[test]
fn a_scatter_below_one_settles() {
    let scene = with(paper::scene(1.1, 0.0).draft(), &[(Name::RestitutionSd, 0.3)]);
    let (course, ending) = states(&scene, 5000);
    assert!(matches!(ending, Ending::Settled { .. }), "{ending:?} after {}", course.len());
}
