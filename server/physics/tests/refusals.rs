//! Fields that contradict each other: the scene is refused, and the errors name the fields.

use crate::paper;
use crate::support::rig_runs::{with_numbers, worded};
use crate::support::turning::turning;
use equipoise_physics::analysis::method::{RunMethod, run_by};
use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::scene::capability::{CAPABILITIES, Lack, Need};
use equipoise_physics::scene::{Draft, Name, Value};

fn draft(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Draft {
    worded(with_numbers(paper::scene(1.1, 0.1).draft(), numbers), words)
}

fn point(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Draft {
    let mut draft = with_numbers(Draft::default(), &[&[(Name::TiltGain, 0.5), (Name::Height, 0.2)], numbers].concat());
    draft.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    worded(draft, words)
}

#[test]
fn contradictions_are_refused_by_their_fields() {
    let planned = (Name::NoiseModel, "plan");
    let timing = (Name::TimingSd, 0.001);
    let about = turning(&paper::scene(1.1, 0.1), "follows", Some(0.0), 0.0);
    // Path of the error, and a word of its reason.
    let cases: [(Draft, &[(&str, &str)]); 8] = [
        (worded(with_numbers(about, &[timing]), &[planned]), &[("table.tilt_rate", "noise.model")]),
        (draft(&[(Name::SpeedError, 0.1)], &[(Name::Strike, "still")]), &[("table.errors.speed", "")]),
        (point(&[(Name::Offset, 0.1)], &[]), &[("body.offset", "point mass")]),
        (point(&[(Name::RotationDrag, 0.2)], &[]), &[("air.rotation_drag", "point mass")]),
        (point(&[(Name::ThetaDotSd, 0.1)], &[]), &[("noise.theta_dot_sd", "point mass")]),
        (
            point(&[(Name::FeedbackThetaDot, 0.1)], &[]),
            &[("table.tilt_gain", ""), ("table.feedback.theta_dot", "point mass")],
        ),
        (
            draft(&[(Name::EnergyGain, 0.1)], &[(Name::Strike, "still")]),
            &[("table.energy_gain", ""), ("table.target_height", "")],
        ),
        (
            draft(&[(Name::Restitution, 0.5), (Name::AssumedRestitution, 0.55)], &[(Name::Strike, "still")]),
            &[("table.assumed_restitution", "")],
        ),
    ];
    for (draft, expected) in cases {
        let errors = draft.build().err().unwrap_or_default();
        assert_eq!(errors.len(), expected.len(), "{errors:?}");
        for (error, (path, word)) in errors.iter().zip(expected) {
            assert!(error.path == *path && error.detail.contains(word), "{errors:?}");
        }
    }
}

#[test]
fn methods_that_do_not_know_a_rig_say_so() {
    let refused = |draft: Draft| run_by(&draft.build().unwrap(), RunMethod::Linear, 10, |_| true).unwrap_err();
    assert!(refused(draft(&[(Name::AngleBias, 0.002)], &[])).contains("table.errors.angle_bias"));
    assert!(refused(draft(&[(Name::TableLength, 0.5)], &[])).contains("table.length"));
    let beyond = |numbers: &[(Name, f64)]| draft(numbers, &[]).build().unwrap().first_beyond_rod();
    assert_eq!(beyond(&[(Name::AngleBias, 0.002)]), Some("table.errors.angle_bias"));
    assert!(beyond(&[(Name::TiltGainError, 0.1), (Name::SpeedError, 0.1)]).is_none(), "gains alone");
}

/// A scene for each need that it does not meet, with the field that says so. Nothing else of the table is missed.
#[test]
fn every_need_is_missed_by_a_scene_that_has_too_much() {
    let polygon = || {
        let mut polygon = draft(&[], &[]);
        for name in [Name::ContactDistance, Name::RadiusOfGyration] {
            polygon.set(name, None).unwrap();
        }
        polygon.set_vertices(Some(Vertices::new(&[[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]]).unwrap()));
        polygon
    };
    let total = [(Name::EnergyMeasure, "total")];
    let follows = [(Name::TiltRate, "follows")];
    let target = [(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.25)];
    let missed: [(Need, Draft, &str); 12] = [
        (Need::Angle, point(&[], &[]), "body.point"),
        (Need::PlainRod, draft(&[(Name::Delay, 0.002)], &[]), "table.delay"),
        (Need::NoEndings, draft(&[(Name::TableLength, 1.0)], &[]), "table.length"),
        (Need::NoEndings, draft(&[(Name::SpeedLimit, 1.0)], &[]), "table.limits.speed"),
        (Need::NoEndings, polygon(), "body.vertices"),
        (Need::VerticalEnergy, draft(&target, &total), "table.energy_measure"),
        (Need::VerticalEnergy, draft(&target[1..], &[(Name::EnergyLaw, "one_strike")]), "table.energy_law"),
        (Need::PresentState, draft(&[(Name::Delay, 0.002)], &[]), "table.delay"),
        (Need::NoDragging, draft(&[(Name::Friction, 0.3), (Name::PivotDepth, 0.03)], &follows), "table.pivot.depth"),
        (Need::NoTurning, draft(&[(Name::PivotX, 0.02)], &follows), "table.tilt_rate"),
        (Need::NoAir, draft(&[(Name::RotationDrag, 0.1)], &[]), "air.rotation_drag"),
        (Need::NoFriction, draft(&[(Name::Friction, 0.3)], &[]), "contact.friction"),
    ];
    let plain = draft(&[], &[]).build().unwrap();
    let mut met = Vec::new();
    for (need, draft, path) in missed {
        let scene = draft.build().unwrap();
        for (analysis, needs) in CAPABILITIES.into_iter().filter(|(_, needs)| needs.contains(&need)) {
            assert_eq!(analysis.lack(&plain), None);
            let Lack { need: first, .. } = analysis.lack(&scene).unwrap();
            // An earlier need may be missed by the same scene.
            let place = |need| needs.iter().position(|other| *other == need).unwrap();
            assert!(place(first) <= place(need), "{analysis:?} {first:?} {need:?}");
        }
        let lacks = CAPABILITIES.into_iter().filter_map(|(analysis, _)| analysis.lack(&scene));
        assert!(lacks.into_iter().any(|lack| lack == Lack { need, path }), "{need:?}");
        met.push(need);
    }
    // That of a bounce that repeats is told by the map.
    met.push(Need::RepeatingBounce);
    for need in CAPABILITIES.into_iter().flat_map(|(_, needs)| needs) {
        assert!(met.contains(need), "{need:?}");
    }
}
