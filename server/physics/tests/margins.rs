//! Margins over a box of bodies: closed forms at its corners, and no body inside that does worse.

use crate::support::budgets::fed_back;
use crate::support::random;
use crate::support::rig::{scene, worded};
use crate::support::turning::{turning, with};
use equipoise_physics::analysis::limits::{Parameter, limits_of};
use equipoise_physics::analysis::margins::judgement::NoMargins;
use equipoise_physics::analysis::margins::{OF_BODY, Tolerance, ToleranceMargins, margins_over_tolerances, refusal};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::scene::{FIELDS, FieldKind, GAINS, Name, Scene, Value};

fn over(scene: &Scene, fields: &[(Name, f64)]) -> Result<ToleranceMargins, String> {
    let tolerances: Vec<_> = fields.iter().map(|&(name, off)| Tolerance { name, off }).collect();
    margins_over_tolerances(scene, &tolerances, &mut || true).map_err(|error| match error {
        NoMargins::Because(why) => why,
        NoMargins::Stopped => panic!("nobody stopped it"),
    })
}

/// Value at which the upper end is least.
fn worst(margins: &ToleranceMargins, name: Name) -> f64 {
    margins.worst.iter().find(|(known, _)| *known == name).unwrap().1
}

#[test]
fn the_least_critical_gain_is_found_inside_the_box_too() {
    // Released at rest, V² l = 2G(y₀ − l) l is greatest at l = y₀/2 = 0.1: κ_c is least there, not at an end.
    let tolerances = [(Name::ContactDistance, 0.05), (Name::RadiusOfGyration, 0.004), (Name::Restitution, 0.0)];
    let margins = over(&scene(&[]), &tolerances).unwrap();
    let rho = 2.0_f64.sqrt() / 15.0 - 0.004;
    let expected = 1.0 + rho * rho / (2.0 * 0.1 * 0.1);
    assert!((margins.critical.least - expected).abs() < 1e-12, "{margins:?}");
    assert!((worst(&margins, Name::ContactDistance) - 0.1).abs() < 1e-6);
    assert!(margins.holds);
    assert!(!over(&scene(&[(Name::TiltGain, 1.45)]), &tolerances).unwrap().holds);
}

#[test]
fn no_body_in_the_box_is_beyond_what_is_said() {
    let scene = scene(&[
        (Name::Restitution, 0.5),
        (Name::EnergyGain, 0.165),
        (Name::TargetHeight, 0.25),
        (Name::ThetaDot, 0.3),
    ]);
    let tolerances = [(Name::ContactDistance, 0.004), (Name::RadiusOfGyration, 0.003), (Name::Restitution, 0.05)];
    let margins = over(&scene, &tolerances).unwrap();
    let mut random = random::Random::new(3);
    for _ in 0..500 {
        let mut draft = scene.draft();
        for (name, middle, off) in [
            (Name::ContactDistance, 0.4 / 3.0, 0.004),
            (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0, 0.003),
            (Name::Restitution, 0.5, 0.05),
        ] {
            draft.set(name, Some(Value::Number(middle + off * random.size(1e-3, 1.0)))).unwrap();
        }
        draft.set(Name::AssumedRestitution, Some(Value::Number(0.5))).unwrap();
        let sample = draft.build().unwrap();
        let fixed_point = small_deviations(&sample).unwrap().fixed_point;
        let linear = small_deviations(&sample).unwrap().linear;
        for (value, span) in [
            (linear.critical_tilt_gain, margins.critical),
            (fixed_point.apex_height, margins.apex_height),
            (linear.energy_eigenvalue, margins.energy_eigenvalue),
        ] {
            assert!(span.least <= value && value <= span.most, "{value} {span:?}");
        }
    }
}

#[test]
fn without_energy_feedback_there_is_no_margin_for_restitution() {
    let tolerances = [(Name::Restitution, 0.01)];
    let why = over(&scene(&[(Name::Restitution, 0.5)]), &tolerances).unwrap_err();
    assert!(why.contains("no bounce repeats"), "{why}");
    let exact = over(&scene(&[]), &[]).unwrap();
    assert_eq!(exact.critical.least, exact.critical.most);
}

const LENGTH: f64 = 0.4 / 3.0;

#[test]
fn tolerances_of_further_fields_have_the_margins_of_their_closed_forms() {
    // κ_c = 1 + ρ²/(2l(h − l)) for a release at rest, whatever gravity.
    let kappa_c = |height: f64| 1.0 + 2.0 / 225.0 / (2.0 * LENGTH * (height - LENGTH));
    let margins = over(&scene(&[]), &[(Name::Height, 0.01), (Name::Gravity, 1.0)]).unwrap();
    let critical = margins.critical;
    assert!(
        (critical.least - kappa_c(0.21)).abs() < 1e-12 && (critical.most - kappa_c(0.19)).abs() < 1e-12,
        "{margins:?}"
    );
    let height = worst(&margins, Name::Height);
    assert!((height - 0.21).abs() < 1e-15 && (margins.apex_height.most - 0.21).abs() < 1e-15);
    // The table tilts by κ(1 + ε), which has to stay between 1 and κ_c.
    let gain = |off: f64| [(Name::TiltGainError, off)];
    for (kappa, off, holds) in [(1.1, 0.09, true), (1.1, 0.1, false), (1.4, 0.07, true), (1.4, 0.08, false)] {
        let margins = over(&scene(&[(Name::TiltGain, kappa)]), &gain(off)).unwrap();
        assert!((margins.critical.least - kappa_c(0.2) / (1.0 + off)).abs() < 1e-12, "{margins:?}");
        assert_eq!(margins.holds, holds, "{kappa} {off}");
    }
    // Values beyond the range of a field are cut off.
    let incline = over(&scene(&[]), &[(Name::Incline, 1.0)]).unwrap();
    assert!(worst(&incline, Name::Incline) <= std::f64::consts::FRAC_PI_2);
}

#[test]
fn no_value_of_further_fields_in_the_box_is_beyond_what_is_said() {
    let energy = [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
    let air = [(Name::Drag, 0.05), (Name::RotationDrag, 0.05)];
    let mut random = random::Random::new(5);
    for (rig, fields) in [
        (scene(&energy), vec![(Name::SpeedError, 0.1), (Name::TiltGainError, 0.03), (Name::TargetHeight, 0.02)]),
        (scene(&[&energy[..], &air[..]].concat()), vec![(Name::Drag, 0.04), (Name::RotationDrag, 0.05)]),
        (scene(&[(Name::YDot, -0.3)]), vec![(Name::YDot, 0.2), (Name::ThetaDot, 0.3), (Name::XDot, 0.1)]),
    ] {
        let tolerances = [&[(Name::RadiusOfGyration, 0.001)], &fields[..]].concat();
        let margins = over(&rig, &tolerances).unwrap();
        for _ in 0..200 {
            let mut draft = rig.draft();
            let mut set = |name: Name, off: f64| {
                let middle = rig.number(name).unwrap_or(0.0);
                draft.set(name, Some(Value::Number(middle + off * random.between(-1.0, 1.0)))).unwrap();
            };
            set(Name::RadiusOfGyration, 0.001);
            fields.iter().for_each(|&(name, off)| set(name, off));
            let sample = draft.build().unwrap();
            let fixed_point = small_deviations(&sample).unwrap().fixed_point;
            let linear = small_deviations(&sample).unwrap().linear;
            for (value, span) in [
                (linear.critical_tilt_gain / sample.tilt_factor(), margins.critical),
                (fixed_point.apex_height, margins.apex_height),
                (linear.energy_eigenvalue, margins.energy_eigenvalue),
            ] {
                assert!(span.least <= value + 1e-12 && value <= span.most + 1e-12, "{value} {span:?} {fields:?}");
            }
        }
    }
}

#[test]
fn every_number_of_a_scene_has_a_tolerance_or_a_refusal_that_names_it() {
    let energy = [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
    let (mut taken, mut refused) = (Vec::new(), Vec::new());
    for rig in
        [scene(&[]), scene(&energy), scene(&[(Name::Drag, 0.05), (Name::EnergyGain, 0.1), (Name::TargetHeight, 0.2)])]
    {
        for row in FIELDS.iter().filter(|row| matches!(row.kind, FieldKind::Number { .. })) {
            if let Some(why) = refusal(row) {
                assert!(why.starts_with(row.path) || why.contains(&format!(" {} ", row.path)), "{why}");
                refused.push(row.path);
                continue;
            }
            let tolerances = [(row.name, 1e-3)];
            match over(&rig, &tolerances) {
                Ok(_) => taken.push(row.path),
                Err(why) => {
                    // Those of the body are named without their group.
                    let leaf = row.path.rsplit('.').next().unwrap();
                    let named = if OF_BODY.contains(&row.name) { leaf } else { row.path };
                    assert!(why.contains(named), "{}: {why}", row.path);
                    refused.push(row.path);
                }
            }
        }
    }
    for path in [
        "table.errors.speed",
        "table.errors.tilt_gain",
        "air.drag",
        "air.rotation_drag",
        "table.pivot.depth",
        "table.delay",
        "gravity",
    ] {
        assert!(taken.contains(&path), "{path}: {taken:?}");
    }
    // Where nothing brings back a drift, an error that leans the bounce leaves none that repeats; in air one does.
    for path in ["table.errors.angle_bias", "body.offset", "table.pivot.x", "noise.x_sd", "table.feedback.x"] {
        assert!(refused.contains(&path), "{path}: {refused:?}");
    }
    assert!(!taken.contains(&"noise.x_sd"), "{taken:?}");
}

#[test]
fn a_predicted_delay_changes_no_margin_and_a_search_can_be_stopped() {
    let mut draft = scene(&[]).draft();
    draft.set(Name::Prediction, Some(Value::Choice("flight"))).unwrap();
    let tolerances = [(Name::Delay, 0.01)];
    let (with, without) = (over(&draft.build().unwrap(), &tolerances), over(&scene(&[]), &[]));
    assert_eq!(with.unwrap().critical, without.unwrap().critical);
    let many = [(Name::Height, 0.01), (Name::Gravity, 0.1), (Name::YDot, 0.1)];
    let many = many.map(|(name, off)| Tolerance { name, off });
    let mut asked = 0;
    let stopped = margins_over_tolerances(&scene(&[]), &many, &mut || {
        asked += 1;
        asked < 3
    });
    assert_eq!((stopped, asked), (Err(NoMargins::Stopped), 3));
}

/// With feedback, a delay, a turning table and drag of the rotation alone: no body in the box is beyond what is said, and the corners are exact.
#[test]
fn margins_on_the_return_map_hold_every_body_and_have_their_closed_forms() {
    let feedback = fed_back(&[(Name::Theta, 0.0)]);
    let late = with(&feedback, &[(Name::Delay, 1e-4)]);
    let matched = worded(scene(&[(Name::Friction, 0.3), (Name::Theta, 0.0)]).draft(), &[(Name::Slide, "matched")]);
    let table = turning(&matched.build().unwrap(), "follows", None, 0.03).build().unwrap();
    let spins = scene(&[(Name::RotationDrag, 0.1), (Name::Theta, 0.0)]);
    let mut random = random::Random::new(9);
    for (rig, name, off) in [
        (&feedback, Name::FeedbackTheta, 0.02),
        (&late, Name::Delay, 5e-5),
        (&table, Name::PivotDepth, 0.005),
        (&spins, Name::RotationDrag, 0.05),
    ] {
        let margins = over(rig, &[(Name::RadiusOfGyration, 1e-3), (name, off)]).unwrap();
        assert!(margins.holds, "{name:?} {margins:?}");
        let gain = Parameter::of_gain(rig);
        assert_eq!(margins.gain == Parameter::FeedbackFactor, rig.number(GAINS[1]).is_some());
        for _ in 0..12 {
            let at = |middle: Name, off: f64, share: f64| (middle, rig.number(middle).unwrap_or(0.0) + off * share);
            let shares = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
            let sample = with(rig, &[at(Name::RadiusOfGyration, 1e-3, shares[0]), at(name, off, shares[1])]);
            let limits = limits_of(&sample, gain, &mut || true).unwrap();
            let upper = limits.upper.unwrap().value;
            let slack = 1e-6 * upper;
            assert!(margins.critical.least <= upper + slack && upper <= margins.critical.most + slack, "{name:?}");
            if let (Parameter::Field(_), Ok(_)) = (gain, small_deviations(&sample).map(|small| small.fixed_point)) {
                let linear = small_deviations(&sample).unwrap().linear;
                assert!((linear.critical_tilt_gain - upper).abs() < 1e-9, "{name:?} {upper}");
            }
        }
    }
}
