//! Budgets of the delay and the pivot of a table: determinants, closed forms, derivatives and runs on both sides of limits, an independent simulation.

use crate::support::budgets;
use crate::support::rig;
use budgets::{BY_RUN, LINEAR, above, budget, fed_back, largest_modulus, of, scene, survives, with};
use equipoise_physics::analysis::margins::judgement::LimitedBy;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene, Value};
use rig::Rig;

#[test]
fn without_prediction_a_tilt_gain_has_no_delay_to_spend_and_state_feedback_has() {
    // The angle has the determinant 1 + (2Vl/ρ²)κτ, so any delay loses the verdict.
    let found = budget(&scene(&[(Name::Theta, 0.0)]), 100);
    let delay = of(&found, Name::Delay);
    assert_eq!((&delay.below, &delay.reason), (&None, &None));
    let limit = above(&found, Name::Delay);
    assert!(
        limit.value == 0.0 && limit.linear == Some(0.0) && limit.accuracy < 1e-9 && limit.by == LINEAR,
        "{limit:?}"
    );
    assert!(found.together.unwrap().sizes.iter().all(|(name, _)| *name != Name::Delay));
    let ideal = fed_back(&[(Name::Theta, 0.0)]);
    let limit = above(&budget(&ideal, 200), Name::Delay).clone();
    let linear = limit.linear.unwrap();
    let at = |delay: f64| largest_modulus(&with(ideal.draft(), &[(Name::Delay, delay)]));
    assert!(linear > 1e-4 && limit.value <= linear, "{limit:?}");
    assert!(at(linear * (1.0 - 1e-3)) < 1.0 + 1e-6 && at(linear * (1.0 + 1e-3)) > 1.0 + 1e-6, "{limit:?}");
}

#[test]
fn the_independent_simulation_settles_up_to_the_limit_of_the_delay() {
    let rig = fed_back(&[(Name::Theta, 0.002)]);
    let linear = above(&budget(&rig, 200), Name::Delay).linear.unwrap();
    let largest = |delay: f64| {
        let course = Rig::of(&with(rig.draft(), &[(Name::Delay, delay)])).course(400);
        course[300..].iter().map(|[_, _, theta, ..]| theta.abs()).fold(0.0, f64::max)
    };
    assert!(largest(linear * 0.97) < 0.002, "{} at {linear}", largest(linear * 0.97));
    assert!(largest(linear * 1.03) > 0.002, "{} at {linear}", largest(linear * 1.03));
}

#[test]
fn where_a_delay_or_a_pivot_has_no_closed_form_the_map_gives_its_limit() {
    let impacts = 120;
    let mut matched = scene(&[(Name::Friction, 0.3)]).draft();
    matched.set(Name::Slide, Some(Value::Choice("matched"))).unwrap();
    let matched = matched.build().unwrap();
    // On a matched table too a delay feeds every swing of a tilt gain.
    let limit = above(&budget(&matched, impacts), Name::Delay).clone();
    assert_eq!((limit.value, limit.by, limit.linear), (0.0, LINEAR, Some(0.0)), "{limit:?}");
    let swing = |delay: f64| {
        let mut halves = [0.0_f64; 2];
        run(&mut with(matched.draft(), &[(Name::Delay, delay)]).orbit().unwrap(), impacts, |contact| {
            let half = &mut halves[usize::from(2 * contact.n > impacts)];
            *half = half.max(contact.state.theta.abs());
            true
        });
        halves[1] / halves[0]
    };
    assert!(swing(1e-3) > 1.01 && swing(0.0) < 1.001, "{} {}", swing(1e-3), swing(0.0));
    // A pivot aside makes a swing no worse that energy feedback makes grow: the run decides.
    let energy = [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
    let rig = turning(&energy, "follows");
    let limit = above(&budget(&rig, impacts), Name::PivotX).clone();
    assert!(limit.by == BY_RUN && limit.value > 0.0 && limit.linear.is_none(), "{limit:?}");
    let at = |value: f64| survives(&with(rig.draft(), &[(Name::PivotX, value)]), impacts);
    assert!(at(limit.value) && !at(limit.value + limit.accuracy), "{limit:?}");
    for rig in [with(matched.draft(), &[(Name::Delay, 1e-3)]), with(rig.draft(), &[(Name::PivotX, 1e-3)])] {
        assert!(!small_deviations(&rig).unwrap().is_closed());
    }
}

#[test]
fn a_delay_that_is_predicted_has_a_reason_in_place_of_limits() {
    let mut draft = scene(&[(Name::Delay, 0.01), (Name::ThetaDotSd, 1e-4)]).draft();
    draft.set(Name::Prediction, Some(Value::Choice("flight"))).unwrap();
    let rig = draft.build().unwrap();
    let found = budget(&rig, 60);
    let delay = of(&found, Name::Delay);
    assert_eq!((&delay.above, delay.value), (&None, 0.01));
    assert!(delay.reason.as_ref().unwrap().contains("table.prediction"), "{delay:?}");
    // With it the errors of the scene are larger, so it is one of those.
    assert_eq!(found.present.unwrap().sizes, [(Name::Delay, 0.01), (Name::ThetaDotSd, 1e-4)]);
}

#[test]
fn a_rig_with_a_delay_or_a_pivot_has_the_limits_of_the_one_without() {
    let impacts = 80;
    let late = budget(&scene(&[(Name::Delay, 0.002)]), impacts);
    let ideal = budget(&scene(&[]), impacts);
    assert_eq!(late.verdict.map(|(verdict, _)| verdict), Some(Verdict::Elliptic));
    for (one, other) in late.errors.iter().zip(&ideal.errors) {
        assert_eq!((&one.below, &one.above), (&other.below, &other.above), "{:?}", one.name);
    }
    let present = late.present.unwrap();
    assert_eq!((present.sizes, present.factor.value, present.factor.by), (vec![(Name::Delay, 0.002)], 0.0, LINEAR));
}

fn turning(values: &[(Name, f64)], rate: &'static str) -> Scene {
    let mut draft = scene(values).draft();
    draft.set(Name::TiltRate, Some(Value::Choice(rate))).unwrap();
    draft.build().unwrap()
}

#[test]
fn a_pivot_has_limits_on_a_table_that_turns_as_it_strikes() {
    for still in [scene(&[]), turning(&[(Name::PivotX, 0.1), (Name::PivotDepth, 0.1)], "none")] {
        let found = budget(&still, 60);
        for name in [Name::PivotX, Name::PivotDepth] {
            let error = of(&found, name);
            assert!(error.below.is_none() && error.above.is_none(), "{error:?}");
            assert!(error.reason.as_ref().unwrap().contains("table.tilt_rate"), "{error:?}");
        }
        assert_eq!(found.present, None);
    }
    let impacts = 150;
    let found = budget(&turning(&[], "follows"), impacts);
    // At any fixed place the surface strikes in step with the swing, which grows.
    for limit in [above(&found, Name::PivotX), of(&found, Name::PivotX).below.as_ref().unwrap()] {
        assert!(limit.value == 0.0 && matches!(limit.by, LimitedBy::Verdict(_)), "{limit:?}");
    }
    // Under the contact it moves along itself, which without friction does nothing.
    assert_eq!(above(&found, Name::PivotDepth).by, LimitedBy::Range);
    let corrected = budget(&turning(&[], "corrected"), impacts);
    assert!([Name::PivotX, Name::PivotDepth].iter().all(|name| above(&corrected, *name).by == LimitedBy::Range));
    // A pivot in the middle is at a fixed place too.
    let present = budget(&turning(&[(Name::PivotX, 0.0)], "follows"), impacts).present.unwrap();
    assert_eq!((present.sizes, present.factor.value), (vec![(Name::PivotX, 0.0)], 0.0));
}

#[test]
fn errors_of_a_turning_table_and_of_its_senses_are_put_together() {
    // A corrected pivot loses nothing here.
    let energy = [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
    let (rig, impacts) = (turning(&energy, "corrected"), 100);
    let found = budget(&rig, impacts);
    let (depth, noise) = (of(&found, Name::PivotDepth), of(&found, Name::YDotSd));
    assert!(above(&found, Name::PivotDepth).by == LimitedBy::Range && noise.above.as_ref().unwrap().by == BY_RUN);
    assert_eq!((&depth.reason, &noise.reason), (&None, &None));
    let together = found.together.as_ref().unwrap();
    let names: Vec<_> = together.sizes.iter().map(|(name, _)| *name).collect();
    assert!(names.contains(&Name::YDotSd), "{names:?}");
    let at = |factor: f64| {
        let value = |name, size| of(&found, name).reference + size * factor;
        let values: Vec<_> = together.sizes.iter().map(|&(name, size)| (name, value(name, size))).collect();
        survives(&with(rig.draft(), &values), impacts)
    };
    assert!(at(together.factor.value) && together.factor.value > 0.0, "{together:?}");
}

#[test]
fn the_depth_of_a_pivot_under_a_matched_contact_has_the_limit_of_its_closed_form() {
    let values = [(Name::Theta, 0.0), (Name::Friction, 0.3), (Name::TiltGain, 1.05)];
    let mut draft = turning(&values, "follows").draft();
    draft.set(Name::Slide, Some(Value::Choice("matched"))).unwrap();
    let rig = draft.build().unwrap();
    let place = small_deviations(&rig).unwrap().fixed_point;
    let [length, rho] = [Name::ContactDistance, Name::RadiusOfGyration].map(|name| rig.number(name).unwrap());
    let gravity = rig.gravity();
    let (turning, kappa) = (rho * rho + length * length, 1.05);
    // κ < (1 + q)/(q + lp/(2(ρ² + l²))), q = V²l/(G(ρ² + l²)).
    let q = place.speed * place.speed * length / (gravity * turning);
    let expected = ((1.0 + q) / kappa - q) * 2.0 * turning / length;
    let found = budget(&rig, 100);
    let limit = above(&found, Name::PivotDepth);
    assert!((limit.linear.unwrap() - expected).abs() < 1e-6 * expected, "{limit:?} {expected}");
    // One above the surface drives the angle.
    let below = of(&found, Name::PivotDepth).below.as_ref().unwrap();
    assert_eq!((below.value, below.by), (0.0, LINEAR));
}
