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
    assert!(refused(draft(&[(Name::AngleBias, 0.002)], &[])).contains("table.errors.angle_bias is 0.002"));
    assert!(refused(draft(&[(Name::TableLength, 0.5)], &[])).contains("ends of the table"));
    let beyond = |numbers: &[(Name, f64)], known: &[ModelLevel]| draft(numbers, &[]).build().unwrap().beyond(known);
    assert!(beyond(&[(Name::AngleBias, 0.002)], &[ModelLevel::Friction]).is_some());
    assert!(beyond(&[(Name::TiltGainError, 0.1), (Name::SpeedError, 0.1)], &[]).is_none(), "gains alone");
}
