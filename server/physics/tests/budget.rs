//! Budgets of errors: closed forms of the linear limits, derivatives and runs on both sides of each limit, symmetry, an independent simulation.

use equipoise_physics::analysis::limits::limits_of;
use equipoise_physics::analysis::margins::budget::{Budget, ErrorBudget, budgeted_of, find_budget, most_runs};
use equipoise_physics::analysis::margins::judgement::{LimitedBy, NoMargins, VerdictLimit, gain_margins};
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::support::budgets::{BY_RUN, LINEAR, above, budget, fed_back, largest_modulus, of, scene, survives, with};
use crate::support::random::Random;
use crate::support::rig::Rig;

/// The two sides of an error, with the sign of each.
fn sides(error: &ErrorBudget) -> Vec<(f64, &VerdictLimit)> {
    let side = |sign: f64, limit: &'_ Option<VerdictLimit>| limit.as_ref().map(|_| sign);
    let below = side(-1.0, &error.below).zip(error.below.as_ref());
    let above = side(1.0, &error.above).zip(error.above.as_ref());
    below.into_iter().chain(above).collect()
}

/// Asserts that a run decides as the limits of a budget say, just inside and just outside.
fn assert_edges(scene: &Scene, budget: &Budget, impacts: u64) -> usize {
    let mut checked = 0;
    for error in &budget.errors {
        // The ends of gravity's range are not reached by sums.
        let least = if error.name == Name::Gravity { 0.1 } else { f64::NEG_INFINITY };
        let at = |value: f64| with(scene.draft(), &[(error.name, (error.reference + value).max(least))]);
        for (sign, limit) in sides(error) {
            let path = error.name.row().path;
            assert!(limit.value >= 0.0 && limit.accuracy >= 0.0, "{path}");
            assert!(limit.accuracy <= 5e-4 * limit.value.max(1e-6) || limit.value == 0.0, "{path}: {limit:?}");
            if limit.value > 0.0 {
                assert!(survives(&at(sign * limit.value), impacts), "{path} {sign} {limit:?}");
            }
            if limit.by == BY_RUN {
                assert!(!survives(&at(sign * (limit.value + limit.accuracy)), impacts), "{path} {sign} {limit:?}");
                assert!(limit.ending.is_some() && limit.linear.is_none_or(|linear| linear > limit.value));
                checked += 1;
            }
        }
    }
    checked
}

#[test]
fn limits_of_gain_errors_are_those_of_the_closed_form() {
    let mut random = Random::new(25);
    for _ in 0..40 {
        let length = random.between(0.05, 0.3);
        let rho = length * random.between(0.4, 1.0);
        let above_rod = length * random.between(0.3, 1.5);
        let width = rho * rho / (2.0 * above_rod * length);
        let kappa = 1.0 + random.between(0.2, 0.8) * width;
        let values = [
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, rho),
            (Name::Height, length + above_rod),
            (Name::Theta, 0.0),
            (Name::TiltGain, kappa),
        ];
        let found = budget(&scene(&values), 60);
        let gain = of(&found, Name::TiltGainError);
        // κ(1 + ε) is between 1 and κ_c = 1 + Gρ²/(V²l), V² = 2G(h − l).
        let expected = [1.0 - 1.0 / kappa, (1.0 + width) / kappa - 1.0];
        for ((_, limit), expected) in sides(gain).into_iter().zip(expected) {
            let expected_within = expected.min(if expected == 1.0 - 1.0 / kappa { 0.9 } else { 1.0 });
            assert!((limit.value - expected_within).abs() < 1e-8 * kappa, "{limit:?} {expected_within}");
            if expected < 0.9 {
                assert_eq!((limit.by, limit.linear), (LINEAR, Some(limit.value)));
                // Inside the root by a billionth, where eigenvalues are off the unit circle by more than rounding.
                let (accuracy, root) = (limit.accuracy, limit.value + 0.5 * limit.accuracy);
                assert!(accuracy < 4e-8 * limit.value && (root - expected_within).abs() < 1e-12 * kappa, "{limit:?}");
            } else {
                assert_eq!((limit.by, limit.linear, limit.accuracy), (LimitedBy::Range, None, 0.0));
            }
        }
        // Where nothing is lost the table stands still, and its speed has no error.
        assert_eq!(above(&found, Name::SpeedError).by, LimitedBy::Range);
    }
}

#[test]
fn eigenvalues_cross_the_unit_circle_at_linear_limits() {
    // With energy feedback an error of the speed moves the height, and with it the energy's eigenvalue.
    let energy =
        scene(&[(Name::Theta, 0.0), (Name::Restitution, 0.5), (Name::EnergyGain, 0.4), (Name::TargetHeight, 0.25)]);
    for (ideal, names) in [
        (energy, vec![Name::SpeedError, Name::TiltGainError]),
        (fed_back(&[(Name::Theta, 0.0)]), vec![Name::TiltGainError]),
    ] {
        let found = budget(&ideal, 200);
        let mut crossed = 0;
        for name in names {
            for (sign, limit) in sides(of(&found, name)) {
                let Some(linear) = limit.linear else { continue };
                let at = |value: f64| with(ideal.draft(), &[(name, sign * value)]);
                let inside = largest_modulus(&at(linear * (1.0 - 1e-3)));
                assert!(inside < 1.0 + 1e-6, "{name:?} {sign}: {inside}");
                let outside = at(linear * (1.0 + 1e-3));
                if small_deviations(&outside).is_err() {
                    assert!(small_deviations(&at(linear)).is_ok());
                    continue;
                }
                let outside = largest_modulus(&outside);
                assert!(outside > 1.0 + 1e-5, "{name:?} {sign}: {outside}");
                crossed += 1;
            }
        }
        assert!(crossed > 1, "{found:?}");
    }
}

#[test]
fn runs_survive_just_inside_and_not_just_outside() {
    let energy = [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
    let mut checked = 0;
    for (scene, impacts) in [
        (scene(&[]), 150),
        (scene(&[(Name::TableLength, 0.5)]), 80),
        (scene(&energy), 150),
        (scene(&[(Name::Restitution, 0.7)]), 100),
        (fed_back(&[]), 200),
        (fed_back(&[(Name::TableLength, 0.6)]), 120),
    ] {
        let found = budget(&scene, impacts);
        checked += assert_edges(&scene, &found, impacts);
        let runs: u64 = most_runs(&scene).iter().map(|(runs, _)| runs).sum();
        assert!(found.bounces <= runs * impacts);
        let together = found.together.as_ref().unwrap();
        assert!(together.factor.value > 0.0 && together.factor.value <= 1.0, "{together:?}");
        let at = |factor: f64| {
            let values: Vec<_> = together
                .sizes
                .iter()
                .map(|(name, size)| (*name, of(&found, *name).reference + size * factor))
                .collect();
            survives(&with(scene.draft(), &values), impacts)
        };
        assert!(at(together.factor.value) && !at(together.factor.value + together.factor.accuracy), "{together:?}");
        // Each of them is at the nearer of its limits at the factor 1.
        for (name, size) in &together.sizes {
            let nearest =
                sides(of(&found, *name)).into_iter().map(|(_, limit)| limit.value).fold(f64::INFINITY, f64::min);
            assert_eq!(size.abs(), nearest);
        }
    }
    assert!(checked > 40, "{checked}");
}

#[test]
fn friction_gravity_and_the_assumed_restitution_come_first() {
    let lines = |found: &Budget| found.errors.iter().map(|error| error.name).take(3).collect::<Vec<_>>();
    let names = [Name::Friction, Name::Gravity, Name::AssumedRestitution];
    // Any friction loses the verdict of a tilt gain.
    let energy = [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
    for scene in [scene(&[]), scene(&[(Name::TiltGain, 1.45)]), scene(&energy)] {
        let found = budget(&scene, 200);
        assert_eq!(lines(&found), names);
        let friction = of(&found, Name::Friction);
        assert_eq!((friction.reference, &friction.below), (0.0, &None));
        let limit = above(&found, Name::Friction);
        assert_eq!((limit.value, limit.by), (0.0, LINEAR), "{limit:?}");
        assert!(limit.detail.contains("grows") && limit.detail.contains("eigenvalue"), "{limit:?}");
        let together = &found.together.as_ref().unwrap().sizes;
        assert!(together.iter().all(|(name, _)| *name != Name::Friction), "{together:?}");
    }
    // With a matched slide this gain needs some friction to stick, and more does no harm.
    let mut rough = scene(&[(Name::TiltGain, 2.0), (Name::Friction, 0.3)]).draft();
    rough.set(Name::Slide, Some(Value::Choice("matched"))).unwrap();
    let rough = rough.build().unwrap();
    let found = budget(&rough, 200);
    let friction = of(&found, Name::Friction);
    assert_eq!((friction.reference, above(&found, Name::Friction).by), (0.3, LimitedBy::Range));
    let below = friction.below.as_ref().unwrap();
    assert!(below.value > 0.1 && below.value < 0.3, "{below:?}");
    let at = |friction: f64| survives(&with(rough.draft(), &[(Name::Friction, friction)]), 200);
    assert!(at(0.3 - below.value) && !at(0.3 - below.value - below.accuracy), "{below:?}");
    // Restitution that the table takes for another one: its height goes on to grow or to fall.
    let lossy = budget(&scene(&[(Name::Restitution, 0.8)]), 100);
    let assumed = of(&lossy, Name::AssumedRestitution);
    assert_eq!((assumed.reference, assumed.value), (0.8, 0.8));
    for (_, limit) in sides(assumed) {
        assert!(limit.value > 0.0 && limit.value < 0.2 && limit.by == BY_RUN, "{limit:?}");
    }
}

#[test]
fn a_limit_names_the_loss() {
    // Swings die out, and without the speed that the law asks for they circle or grow.
    let attracting = [
        (Name::Incline, std::f64::consts::FRAC_PI_4),
        (Name::Restitution, 0.5),
        (Name::EnergyGain, 0.165),
        (Name::TargetHeight, 0.25),
        (Name::Theta, 0.05),
    ];
    let mut seen = 0;
    for (gain, impacts) in [(1.2, 300), (1.16, 300), (1.1, 100)] {
        let found = budget(&scene(&[&attracting[..], &[(Name::TiltGain, gain)]].concat()), impacts);
        let limits = found.errors.iter().flat_map(sides).map(|(_, limit)| limit);
        for limit in limits.chain(found.together.iter().map(|it| &it.factor)) {
            assert!(!limit.detail.contains("so small deviations circle"), "{limit:?}");
            seen += usize::from(limit.detail.contains("becomes"));
        }
    }
    assert!(seen > 1, "{seen}");
}

#[test]
fn the_independent_simulation_leaves_the_table_at_the_limit() {
    let (half, impacts) = (0.1, 12);
    let names = [Name::AngleBias, Name::TiltOffset, Name::Offset];
    let rig = scene(&[(Name::TableLength, 2.0 * half), (Name::Theta, 0.02), (Name::X, 0.03)]);
    let found = budget(&rig, impacts);
    for name in names {
        for (sign, limit) in sides(of(&found, name)) {
            assert_eq!((limit.by, limit.ending), (BY_RUN, Some("off_table")), "{name:?}");
            let stays = |value: f64| {
                let scene = with(rig.draft(), &[(name, sign * value)]);
                let length =
                    scene.number(Name::ContactDistance).unwrap().hypot(scene.number(Name::Offset).unwrap_or(0.0));
                let course = Rig::of(&scene).course(impacts as usize);
                course.iter().all(|[_, x, theta, ..]| (x + length * theta.sin()).abs() <= half)
            };
            assert!(stays(limit.value * 0.999) && !stays((limit.value + limit.accuracy) * 1.001), "{name:?} {sign}");
        }
    }
}

#[test]
fn a_release_seen_in_a_mirror_has_mirrored_limits() {
    let impacts = 60;
    let odd = [Name::AngleBias, Name::TiltOffset, Name::Offset];
    let straight = budget(&scene(&[(Name::Theta, 0.0)]), impacts);
    for error in &straight.errors {
        if odd.contains(&error.name) {
            assert_eq!(error.below, error.above, "{:?}", error.name);
        }
    }
    let release = [(Name::Theta, 0.04), (Name::ThetaDot, 0.1), (Name::XDot, -0.05), (Name::TableLength, 20.0)];
    let mirrored = [(Name::Theta, -0.04), (Name::ThetaDot, -0.1), (Name::XDot, 0.05), (Name::TableLength, 20.0)];
    let (one, other) = (budget(&scene(&release), impacts), budget(&scene(&mirrored), impacts));
    for (one, other) in one.errors.iter().zip(&other.errors) {
        if odd.contains(&one.name) {
            assert_eq!((&one.below, &one.above), (&other.above, &other.below), "{:?}", one.name);
        } else if [Name::TiltGainError, Name::SpeedError].contains(&one.name) {
            assert_eq!(one, other);
        }
    }
}

#[test]
fn with_feedback_of_the_place_a_constant_tilt_may_reach_the_end_of_the_table() {
    let half = 0.15;
    let scene = fed_back(&[(Name::Theta, 0.0), (Name::TableLength, 2.0 * half)]);
    let [x, theta] = [Name::FeedbackX, Name::FeedbackTheta].map(|name| scene.number(name).unwrap().abs());
    let found = budget(&scene, 400);
    let limit = above(&found, Name::TiltOffset);
    // x* = c/K_x.
    assert!((limit.linear.unwrap() - x * half).abs() < 1e-12, "{limit:?}");
    assert!(limit.value <= limit.linear.unwrap());
    let bias = above(&found, Name::AngleBias).linear.unwrap();
    assert!((theta * bias - x * half).abs() < 1e-12, "c = −K_θ b");
    // Without ends any tilt that the run survives is kept.
    assert_eq!(above(&budget(&fed_back(&[(Name::Theta, 0.0)]), 400), Name::TiltOffset).linear, None);
}

#[test]
fn the_errors_of_a_scene_have_a_common_factor() {
    let values = [(Name::AngleBias, 2e-5), (Name::TiltGainError, -0.01), (Name::AngleSd, 1e-4)];
    let (rig, impacts) = (scene(&values), 100);
    let found = budget(&rig, impacts);
    let present = found.present.as_ref().unwrap();
    assert_eq!(present.sizes, values);
    let at = |factor: f64| {
        let values: Vec<_> = values.iter().map(|(name, value)| (*name, value * factor)).collect();
        survives(&with(rig.draft(), &values), impacts)
    };
    assert!(at(present.factor.value) && !at(present.factor.value + present.factor.accuracy), "{present:?}");
    // The limits of each alone are of the rig without the others, and its verdict is the one to keep.
    let ideal = budget(&scene(&[]), impacts);
    for (one, other) in found.errors.iter().zip(&ideal.errors) {
        assert_eq!((&one.below, &one.above), (&other.below, &other.above));
    }
    assert_eq!((found.verdict.map(|(verdict, _)| verdict), ideal.present), (Some(Verdict::Elliptic), None));
}

#[test]
fn what_is_lost_without_errors_has_no_budget_and_a_search_can_be_stopped() {
    let because = |scene: &Scene| match find_budget(scene, 100, || true) {
        Err(NoMargins::Because(why)) => why,
        other => panic!("{other:?}"),
    };
    assert!(because(&scene(&[(Name::TiltGain, 1.6)])).contains("without errors"));
    assert!(because(&scene(&[(Name::TiltGain, 0.9), (Name::Theta, 0.0)])).contains("unstable without errors"));
    assert_eq!(find_budget(&scene(&[]), 1000, || false), Err(NoMargins::Stopped));
}

#[test]
fn errors_that_a_body_cannot_have_are_left_out_with_the_reason() {
    let mut point = Draft::default();
    point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    let found = budget(&with(point, &[(Name::TiltGain, 0.4), (Name::Height, 0.2)]), 100);
    for name in [Name::Offset, Name::ThetaDotSd] {
        let error = of(&found, name);
        assert!(error.above.is_none() && error.reason.as_ref().unwrap().contains("point mass"), "{error:?}");
    }
    // It senses the angle of its velocity, at a time.
    for name in [Name::AngleBias, Name::TiltOffset, Name::TimingSd] {
        let error = of(&found, name);
        assert!(error.above.is_some() && error.reason.is_none(), "{error:?}");
    }
    assert!(above(&found, Name::TiltGainError).value > 0.5, "κ between 0 and 1");
}

#[test]
fn limits_far_below_the_range_are_as_accurate() {
    let (rig, impacts) = (scene(&[(Name::TableLength, 0.5)]), 1000);
    let found = budget(&rig, impacts);
    let limit = above(&found, Name::AngleBias);
    assert!(limit.value > 1e-9 && limit.value < 2_f64.powi(-20) && limit.accuracy < 5e-4 * limit.value, "{limit:?}");
    let at = |value: f64| survives(&with(rig.draft(), &[(Name::AngleBias, value)]), impacts);
    assert!(at(limit.value) && !at(limit.value + limit.accuracy), "{limit:?}");
}

#[test]
fn every_error_of_the_table_and_every_noise_has_a_budget() {
    let paths: Vec<_> = budgeted_of(&scene(&[])).map(|row| row.path).collect();
    for path in [
        "body.offset",
        "table.errors.angle_bias",
        "table.errors.speed",
        "table.pivot.x",
        "table.pivot.depth",
        "table.delay",
        "noise.timing_sd",
        "noise.angle_sd",
    ] {
        assert!(paths.contains(&path), "{path}");
    }
    assert!(!paths.iter().any(|path| path.contains("seed") || path.contains("run")));
}

#[test]
fn margins_of_a_gain_are_those_of_small_deviations_and_of_the_run() {
    let impacts = 300;
    let ending = |scene: &Scene| EndingKind::from(run_nonlinear(scene, impacts, || true).unwrap().ending);
    let air = [(Name::Drag, 0.05), (Name::EnergyGain, 0.15), (Name::TargetHeight, 0.2)];
    for rig in [scene(&[(Name::Theta, 0.1)]), scene(&[(Name::TiltGain, 1.6)]), scene(&air), fed_back(&[])] {
        let found = gain_margins(&rig, impacts, &mut || true).unwrap();
        let small = limits_of(&rig, found.gain, &mut || true).unwrap();
        assert_eq!(found.small, small);
        let own = ending(&rig);
        let mut seen = 0;
        for (limit, sign) in found.release.iter().zip([-1.0, 1.0]) {
            let at = |distance: f64| found.gain.moved(&rig, small.value + sign * distance).unwrap();
            assert_eq!(ending(&at(limit.value)), own, "{limit:?}");
            if limit.by == BY_RUN {
                let beyond = ending(&at(limit.value + limit.accuracy));
                assert!(beyond != own && Some(beyond.name()) == limit.ending, "{limit:?}");
                seen += 1;
            }
        }
        assert!(seen > 0, "{found:?}");
    }
    assert_eq!(gain_margins(&scene(&[]), impacts, &mut || false), None);
}

// Budgets of the delay and the pivot of a table: determinants, closed forms, derivatives and runs on both sides of limits, an independent simulation.

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
        assert!(small_deviations(&rig).unwrap().found.is_some());
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
