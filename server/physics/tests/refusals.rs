//! Fields that contradict each other: the scene is refused, and the errors name the fields.

use crate::paper;
use crate::support::rig_runs::{with_numbers, worded};
use crate::support::turning::turning;
use equipoise_physics::analysis::method::{RunMethod, run_by};
use equipoise_physics::scene::model::ModelLevel;
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
    let drag = (Name::Drag, 0.2);
    let planned = (Name::NoiseModel, "plan");
    let timing = (Name::TimingSd, 0.001);
    let errors = [(Name::AngleBias, 0.1), (Name::TiltOffset, 0.1), (Name::Offset, 0.1)];
    let in_air = draft(&[drag], &[]).build().unwrap();
    let about = turning(&paper::scene(1.1, 0.1), "follows", Some(0.0), 0.0);
    let limited = |name| with_numbers(about, &[(name, 10.0)]);
    // Path of the error, and a word of its reason.
    let cases: [(Draft, &[(&str, &str)]); 16] = [
        (draft(&[drag, (Name::Delay, 0.01)], &[]), &[("air.drag", "table.delay")]),
        (draft(&[(Name::RotationDrag, 0.2), (Name::Delay, 0.01)], &[]), &[("air.rotation_drag", "table.delay")]),
        (draft(&[drag, timing], &[planned]), &[("air.drag", "noise.model")]),
        (turning(&in_air, "follows", Some(0.1), 0.05), &[("air.drag", "table.tilt_rate")]),
        (point(&[drag], &[]), &[("air.drag", "point mass")]),
        (limited(Name::TiltRateLimit), &[("table.limits.tilt_rate", "tilt_rate")]),
        (limited(Name::SpeedLimit), &[("table.limits.speed", "tilt_rate")]),
        (limited(Name::StrokeLimit), &[("table.limits.stroke", "tilt_rate")]),
        (worded(with_numbers(about, &[timing]), &[planned]), &[("table.tilt_rate", "noise.model")]),
        (point(&[], &[(Name::TiltRate, "follows")]), &[("table.tilt_rate", "")]),
        (draft(&[(Name::SpeedError, 0.1)], &[(Name::Strike, "still")]), &[("table.errors.speed", "")]),
        (
            draft(&[(Name::SpeedError, 0.1), (Name::TargetHeight, 0.2)], &[(Name::EnergyLaw, "one_strike")]),
            &[("table.errors.speed", "")],
        ),
        (
            point(&errors, &[]),
            &[("body.offset", ""), ("table.errors.angle_bias", ""), ("table.errors.tilt_offset", "")],
        ),
        (point(&[(Name::Delay, 0.01)], &[]), &[("table.delay", "")]),
        // A limit is allowed on a table that turns about the contact.
        (with_numbers(turning(&paper::scene(1.1, 0.1), "follows", None, 0.0), &[(Name::SpeedLimit, 10.0)]), &[]),
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
    for limit in [Name::TiltRateLimit, Name::StrokeLimit] {
        with_numbers(turning(&paper::scene(1.1, 0.1), "follows", None, 0.0), &[(limit, 10.0)]).build().unwrap();
    }
}

#[test]
fn methods_that_do_not_know_a_rig_say_so() {
    let refused = |draft: Draft| run_by(&draft.build().unwrap(), RunMethod::Linear, 10, |_| true).unwrap_err();
    assert!(refused(draft(&[(Name::AngleBias, 0.002)], &[])).contains("table.errors.angle_bias is 0.002"));
    assert!(refused(draft(&[(Name::TableLength, 0.5)], &[])).contains("ends of the table"));
    let beyond = |numbers: &[(Name, f64)], known: &[ModelLevel]| draft(numbers, &[]).build().unwrap().beyond(known);
    assert!(beyond(&[(Name::AngleBias, 0.002)], &[ModelLevel::Friction]).is_some());
    assert!(beyond(&[(Name::TiltGainError, 0.1), (Name::SpeedError, 0.1)], &[]).is_none(), "gains alone");
}
