//! The scenes of the levels of a model hierarchy: each is built, or its refusal is told.

use crate::support::mixes;
use crate::support::random;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::model_hierarchy::run_hierarchy;
use mixes::MIXES;
use random::Random;

#[test]
fn every_level_of_a_scene_is_a_scene() {
    let mut random = Random::new(2603);
    let mut levels = 0;
    for parts in MIXES {
        for _ in 0..20 {
            let scene = mixes::scene(&mut random, parts);
            for step in run_hierarchy(&scene, 2, || true).unwrap() {
                let told = step.run.as_ref().err();
                let reduced = step.scene.unwrap_or_else(|| panic!("{:?}: {told:?} of {scene:?}", step.level));
                assert!(reduced.model_level() <= step.level.max(ModelLevel::Rod), "{scene:?}");
                levels += 1;
            }
            // The same law, written as a tilt gain, is the scene that a draft of it builds.
            let lawful = scene.with_tilt_law();
            assert_eq!(lawful, lawful.draft().build().unwrap());
        }
    }
    assert!(levels > 500, "{levels}");
}
