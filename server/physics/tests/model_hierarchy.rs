//! The ladder of models: the level that each field asks for, and what it changes. `properties.rs` holds it over all mixes of features.

use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use crate::support::rig::{scene, with, with_numbers};
use crate::support::turning::turning;
use equipoise_physics::analysis::method::{RunMethod, run_by};
use equipoise_physics::analysis::model_hierarchy::{LevelResult, run_hierarchy};
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::model::ModelLevel::{
    self, Delay, Drag, Friction, Linear, Noise, RigErrors, Rod, RodWithX, Turning,
};
use equipoise_physics::scene::{FIELDS, Name, Scene};

fn ladder(scene: &Scene) -> Vec<LevelResult> {
    run_hierarchy(scene, 50, || true).unwrap()
}

/// Each level is a scene that needs that level, the last one is the scene itself, and the field of a level is not in those below it.
#[test]
fn every_level_of_a_scene_is_a_scene() {
    let mut random = Random::new(2603);
    let mut levels = 0;
    for _ in 0..1500 {
        let mix = Mix::draw(&mut random, Swing::Calm, &all_but(&[]));
        let scene = &mix.scene;
        let steps = run_hierarchy(scene, 2, || true).unwrap();
        let reduced: Vec<Scene> = steps
            .iter()
            .map(|step| step.scene.unwrap_or_else(|| panic!("{:?}: {:?} of {scene:?}", step.level, step.run)))
            .collect();
        for (index, step) in steps.iter().enumerate() {
            assert!(reduced[index].model_level() <= step.level.max(Rod), "{scene:?}");
            let Some(requirement) = &step.requirement else { continue };
            assert_eq!(reduced[index].model_level(), step.level, "{scene:?}");
            if let Some(field) = FIELDS.iter().find(|row| row.path == requirement.path) {
                assert_eq!(reduced[index].value(field.name), scene.value(field.name), "{scene:?}");
                assert!(reduced[..index].iter().all(|below| below.value(field.name) != scene.value(field.name)));
            }
        }
        assert!(steps.windows(2).all(|pair| pair[0].level < pair[1].level));
        let last = reduced.last().unwrap();
        assert_eq!((last.running_model(), last.rules()), (scene.running_model(), scene.rules()), "{scene:?}");
        levels += steps.len();
        // The same law, written as a tilt gain, is the scene that a draft of it builds.
        let lawful = scene.with_tilt_law();
        assert_eq!(lawful, lawful.draft().build().unwrap());
    }
    assert!(levels > 4000, "{levels}");
}

#[test]
fn a_level_names_the_field_that_asks_for_it() {
    let rough = [(Name::Friction, 0.05), (Name::AngleBias, 0.001)];
    let in_air = scene(&[&rough[..], &[(Name::Drag, 0.2), (Name::RotationDrag, 0.1)]].concat());
    let turns = turning(&scene(&rough), "follows", Some(0.0), 0.02).build().unwrap();
    let off = scene(&[(Name::AngleBias, 0.002), (Name::Offset, 0.001), (Name::Friction, 0.05)]);
    let late = scene(&[(Name::AngleBias, 0.001), (Name::Delay, 0.01), (Name::AngleSd, 0.001)]);
    let feedback = [(Name::FeedbackX, 0.05), (Name::FeedbackTheta, -1.2), (Name::Theta, 0.05)];
    let mut fed_back = with_numbers(scene(&[]).draft(), &feedback);
    fed_back.set(Name::TiltGain, None).unwrap();
    let fed_back = with(fed_back, &[(Name::Friction, 0.05), (Name::TimingSd, 1e-3)]);
    let (biased, rubs) = ((RigErrors, "table.errors.angle_bias"), (Friction, "contact.friction"));
    let cases: [(&Scene, &[(ModelLevel, &str)]); 5] = [
        (&in_air, &[biased, (Drag, "air.drag"), rubs]),
        (&turns, &[biased, (Turning, "table.tilt_rate"), rubs]),
        (&off, &[biased, rubs]),
        (&late, &[biased, (Delay, "table.delay"), (Noise, "noise.angle_sd")]),
        (&fed_back, &[(RodWithX, "table.feedback.x"), rubs, (Noise, "noise.timing_sd")]),
    ];
    for (scene, expected) in cases {
        let steps = ladder(scene);
        assert_eq!(steps.iter().map(|step| step.level).take(2).collect::<Vec<_>>(), [Linear, Rod]);
        assert!(steps[..2].iter().all(|step| step.requirement.is_none()));
        let asked = steps[2..].iter().map(|step| (step.level, step.requirement.as_ref().unwrap().path));
        assert_eq!(asked.collect::<Vec<_>>(), expected);
        assert!(
            steps[1].scene.unwrap().running_model().constant_tilt == 0.0 && steps[2].run.as_ref().unwrap().impacts > 0
        );
        assert!(run_by(scene, RunMethod::Linear, 10, |_| true).is_err());
    }
    for (scene, level) in [(&in_air, Drag), (&turns, Turning)] {
        let change = ladder(scene).into_iter().find(|step| step.level == level).unwrap().run.unwrap().change.unwrap();
        assert!(change.largest[4].value > 1e-3, "{change:?}");
        assert!(scene.rules().settles && !scene.rules().holds_energy);
    }
    let steps = ladder(&fed_back);
    assert!(steps[0].run.is_err(), "no linear solution of a feedback in closed form");
    // Friction on a table that only tilts makes the rod fall.
    let friction = steps[3].run.as_ref().unwrap();
    assert!(!friction.change.unwrap().same_outcome && friction.ending != Ending::Completed, "{friction:?}");
    let plain = ladder(&scene(&[(Name::Theta, 1e-6)]));
    assert_eq!(plain.iter().map(|step| step.level).collect::<Vec<_>>(), [Linear, Rod]);
    let change = plain[1].run.as_ref().unwrap().change.unwrap();
    assert!(change.same_outcome && change.state().value < 1e-9 && change.impacts == 50, "{change:?}");
}
