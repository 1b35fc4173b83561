//! Normal forms of the bounce: the first Lyapunov coefficient against its closed form and against runs, and soft or hard ends
//! of stability against what runs beyond them do.

use equipoise_physics::analysis::boundary::boundary_coefficient;
use equipoise_physics::analysis::contact_regime::contact_regime;
use equipoise_physics::analysis::evidence::Swing;
use equipoise_physics::analysis::jacobian::jacobian_at;
use equipoise_physics::analysis::limits::{Parameter, limits_of};
use equipoise_physics::analysis::losses::{SettledMotion, StabilityLoss, losses};
use equipoise_physics::analysis::normal_form::CriticalForm;
use equipoise_physics::analysis::periodic_orbits::multipliers::Bifurcation;
use equipoise_physics::analysis::repeating::{ON_CIRCLE, RepeatingBounce, find, find_planned, of_scene};
use equipoise_physics::analysis::return_map::{ReturnMap, Vector, X, X_DOT, Y_DOT};
use equipoise_physics::analysis::small_deviations::{Motion, small_deviations};
use equipoise_physics::analysis::swing::{NoSwingForm, SwingForm};
use equipoise_physics::control::bounce_model::states;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::scene::{Draft, Name, Scene};
use nalgebra::{Complex, DVector};

use crate::support::features;
use crate::support::features::{Mix, RANDOM, all_but};
use crate::support::random::Random;
use crate::support::rig::{with, worded};
use crate::support::scenes::{balance, escape_impacts, swing, upright_bounce};

const FEEDBACK: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

/// A scene of numbers, on a table that slides along as `slide` says.
fn scene_on(slide: &'static str, values: &[(Name, f64)]) -> Scene {
    with(worded(Draft::default(), &[(Name::Slide, slide)]), values)
}

fn scene(values: &[(Name, f64)]) -> Scene {
    scene_on("none", values)
}

/// The paper's body with these values beside it.
fn paper(values: &[(Name, f64)]) -> Scene {
    scene(&[&body()[..], values].concat())
}

fn body() -> [(Name, f64); 3] {
    [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0), (Name::Height, 0.2)]
}

/// The paper's cases 4 and 5 at a tilt gain and a small angle, released at the target height.
fn case_4(tilt_gain: f64, theta: f64) -> Scene {
    paper(&[
        (Name::Incline, std::f64::consts::FRAC_PI_4),
        (Name::Restitution, 0.5),
        (Name::EnergyGain, 0.165),
        (Name::TargetHeight, 0.25),
        (Name::Height, 0.25),
        (Name::TiltGain, tilt_gain),
        (Name::Theta, theta),
    ])
}

fn coefficient(scene: &Scene) -> Swing {
    swing(scene).unwrap()
}

fn ends(scene: &Scene) -> Vec<StabilityLoss> {
    let small = small_deviations(scene).unwrap();
    let (found, notes) = losses(scene, &small, boundary_coefficient(&scene.model(), &small.fixed_point));
    assert!(notes.is_empty(), "{notes:?}");
    found
}

/// λ S G² R³ (1 − 2R) / (V⁴ [λ² + 16(1 − λ)R(1 − R)]) with S = ρ²[1 + κ²ρ²/((κ − 1)²l²)].
fn closed_form(scene: &Scene) -> f64 {
    let rod = scene.parameters::<f64>();
    let fixed_point = small_deviations(scene).unwrap().fixed_point;
    let linear = small_deviations(scene).unwrap().linear;
    let (residue, loop_gain) = (linear.residue.unwrap(), 1.0 - linear.energy_eigenvalue);
    let (rho_squared, kappa) = (rod.radius_of_gyration.powi(2), rod.tilt_gain);
    let s = rho_squared * (1.0 + kappa * kappa * rho_squared / ((kappa - 1.0) * rod.contact_distance).powi(2));
    let below = loop_gain * loop_gain + 16.0 * (1.0 - loop_gain) * residue * (1.0 - residue);
    loop_gain * s * rod.gravity.powi(2) * residue.powi(3) * (1.0 - 2.0 * residue) / (fixed_point.speed.powi(4) * below)
}

/// A rod of any size with energy feedback, a residue from 0.03 to 0.97 and a loop gain (1 + e)κ_E V² from 0.02 to 1.9.
fn random_values(random: &mut Random, stuck: bool) -> Vec<(Name, f64)> {
    let length = random.between(0.05, 0.5);
    let rho = length * random.between(0.3, 1.2);
    let above = length * random.between(0.2, 2.0);
    let turning = rho * rho + if stuck { length * length } else { 0.0 };
    let width = turning / (2.0 * above * length);
    let restitution = random.between(0.0, 1.0);
    let gravity = 9.81;
    vec![
        (Name::ContactDistance, length),
        (Name::RadiusOfGyration, rho),
        (Name::TiltGain, 1.0 + width * random.between(0.03, 0.97)),
        (Name::Restitution, restitution),
        (Name::EnergyGain, random.between(0.02, 1.9) / ((1.0 + restitution) * 2.0 * gravity * above)),
        (Name::TargetHeight, length + above),
        (Name::Height, length + above),
    ]
}

#[test]
fn the_coefficient_is_its_closed_form() {
    let mut random = Random::new(11);
    let (mut repelling, mut attracting) = (0, 0);
    for _ in 0..500 {
        let scene = scene(&random_values(&mut random, false));
        let (found, expected) = (coefficient(&scene), closed_form(&scene));
        let residue = small_deviations(&scene).unwrap().linear.residue.unwrap();
        let growth = found.form.growth;
        assert!((growth - expected).abs() <= 1e-9 * expected.abs() + 1e-12, "R = {residue}: {growth} and {expected}");
        repelling += u32::from(growth > 0.0);
        attracting += u32::from(growth < 0.0);
        assert_eq!(growth > 0.0, residue < 0.5);
        assert!(found.amplitude < 1e-30, "upright never leaves");
    }
    assert!(repelling > 100 && attracting > 100);
}

#[test]
fn the_coefficients_of_the_papers_cases_are_those_measured() {
    let measured = [
        (1.02, 0.03199),
        (1.05, 0.03266),
        (1.1, 0.0221),
        (1.14, 0.0020),
        (1.15, -0.0057),
        (1.2, -0.0785),
        (1.25, -0.3670),
    ];
    for (tilt_gain, expected) in measured {
        let found = coefficient(&case_4(tilt_gain, 0.01)).form.growth;
        assert!((found - expected).abs() <= 0.02 * expected.abs() + 5e-5, "κ = {tilt_gain}: {found} and {expected}");
    }
}

/// ℓ as a run shows it: 1/A² falls by 2ℓ a bounce. A² is the quadratic form of (ρθ, ρθ̇) that the linear map keeps, averaged
/// over many bounces at both ends.
fn measured(scene: &Scene, impacts: u64) -> f64 {
    let fixed_point = small_deviations(scene).unwrap().fixed_point;
    let linear = jacobian_at(
        &scene.model(),
        0.0,
        &equipoise_physics::map::strike::State { theta: 0.0, x_dot: 0.0, y_dot: -fixed_point.speed, theta_dot: 0.0 },
        1,
    )
    .unwrap()
    .matrix;
    // For M = (a b; c d) of determinant 1: −c u² + (a − d) u v + b v² is kept, and the largest |u| on it is u² = 4b/(4 − trace²).
    let (a, b, c, d) = (linear[(0, 0)], linear[(0, 3)], linear[(3, 0)], linear[(3, 3)]);
    let rho = scene.parameters::<f64>().radius_of_gyration;
    let per_form = 4.0 * b / (4.0 - (a + d) * (a + d)) / (rho * rho);
    let mut orbit = scene.orbit().unwrap();
    let window = impacts / 10;
    let (mut early, mut late) = (0.0, 0.0);
    let ending = run(&mut orbit, impacts, |contact| {
        let (u, v) = (rho * contact.state.theta, rho * contact.state.theta_dot);
        let square = (-c * u * u + (a - d) * u * v + b * v * v) * per_form;
        if contact.n <= window {
            early += 1.0 / (square * window as f64);
        } else if contact.n > impacts - window {
            late += 1.0 / (square * window as f64);
        }
        true
    });
    assert_eq!(ending, Some(Ending::Completed));
    (early - late) / (2.0 * (impacts - window) as f64)
}

#[test]
fn runs_grow_and_shrink_by_it() {
    for tilt_gain in [1.02, 1.05, 1.1, 1.2, 1.25] {
        let scene = case_4(tilt_gain, 0.02);
        let (found, run) = (coefficient(&scene).form.growth, measured(&scene, 5_000));
        assert!((run / found - 1.0).abs() < 0.03, "κ = {tilt_gain}: {found}, in a run {run}");
    }
}

#[test]
fn matched_friction_has_it_too() {
    let mut random = Random::new(5);
    for _ in 0..12 {
        let mut values = random_values(&mut random, true);
        values.extend([(Name::Friction, 0.8), (Name::Theta, 0.01)]);
        let scene = scene_on("matched", &values);
        let found = coefficient(&scene).form.growth;
        let run = measured(&scene, 4_000);
        assert!((run - found).abs() <= 0.05 * found.abs() + 1e-3, "{values:?}: {found}, in a run {run}");
    }
}

#[test]
fn every_start_of_a_repelling_bounce_leaves_when_it_says() {
    for (theta, fall) in [(0.04, 1332), (0.02, 5354), (0.01, 21453)] {
        let scene =
            paper(&[(Name::TiltGain, 1.1), (Name::EnergyGain, 0.45), (Name::TargetHeight, 0.2), (Name::Theta, theta)]);
        let mut orbit = scene.orbit().unwrap();
        let ending = run(&mut orbit, 30_000, |_| true).unwrap();
        assert!(ending != Ending::Completed && orbit.contacts() == fall, "{ending:?} at {}", orbit.contacts());
        let escape = escape_impacts(&coefficient(&scene));
        assert!((escape / fall as f64 - 1.0).abs() < 0.02, "{escape} and {fall}");
    }
}

#[test]
fn where_it_does_not_apply_there_is_none() {
    let plain = balance(&paper(&[(Name::TiltGain, 1.1)]));
    assert!(matches!((plain.small.motion, plain.swing), (Motion::Circles(_), None)), "strikes keep the energy");
    // κ = 1 + R·Gρ²/(V²l) with R = ½: a quarter turn a bounce.
    let rod = case_4(1.1, 0.0);
    let critical = small_deviations(&rod).unwrap().linear.critical_tilt_gain;
    let quarter = balance(&case_4(0.5 * (1.0 + critical), 0.1));
    assert!(quarter.resonance.is_some_and(|it| it.order == 4 && it.share > 1.0), "{quarter:?}");
    // A third of a turn at R = ¾: mirror symmetry leaves nothing that resonates, and a drift breaks it.
    let third = case_4(1.0 + 0.75 * (critical - 1.0), 0.01);
    assert!(matches!(balance(&third).swing, Some(Ok(_))));
    let drifting = with(third.draft(), &[(Name::XDot, 0.2)]);
    assert!(matches!(balance(&drifting).swing, Some(Err(NoSwingForm::Resonance))));
    assert!(matches!(balance(&case_4(1.5, 0.1)).small.motion, Motion::Grows(_)));
    let high = balance(&paper(&[(Name::TiltGain, 1.1), (Name::EnergyGain, 1.1), (Name::TargetHeight, 0.2)]));
    assert!(matches!(high.small.motion, Motion::Grows(_)));
}

/// Weights under which laws are designed.
const WEIGHTS: ([f64; 4], f64) = ([1.0, 10.0, 0.1, 0.1], 10.0);

/// A rod with `factor` times the law that is best under the weights, and the factor above 1 at which it is lost.
fn steered(body: &[(Name, f64)], factor: impl Fn(f64) -> f64) -> Option<(Scene, f64)> {
    let rod = scene(&[body, &[(Name::TiltGain, 1.1)]].concat());
    let fixed_point = small_deviations(&rod).unwrap().fixed_point;
    let model = upright_bounce(&rod.parameters(), fixed_point.speed, contact_regime(&rod.model()));
    let design = design_lqr(&model, WEIGHTS.0, WEIGHTS.1).ok()?;
    let upper = model.stable_factors(design.gain, states(true))?.upper;
    let gain = design.gain.map(|gain| factor(upper) * gain);
    let values: Vec<_> = body.iter().copied().chain(FEEDBACK.into_iter().zip(gain)).collect();
    Some((scene(&values), upper))
}

fn feedback_loss(scene: &Scene) -> StabilityLoss {
    let ends = ends(scene);
    let mut ends = ends.into_iter().filter(|loss| loss.end == Parameter::FeedbackFactor);
    ends.next().expect("an end of the feedback")
}

#[test]
fn a_law_just_beyond_its_margin_settles_on_the_swing_that_it_says() {
    let body = [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0),
        (Name::Height, 0.2),
        (Name::Theta, 0.05),
    ];
    for (beyond, tolerance) in [(1.001, 0.1), (1.0001, 0.02)] {
        let (scene, _) = steered(&body, |upper| beyond * upper).unwrap();
        let loss = feedback_loss(&scene);
        assert!(loss.is_soft() && (loss.value - 1.0 / beyond).abs() < 1e-9, "{loss:?}");
        let Some(SettledMotion::Swing(swing)) = loss.settles else { panic!("{loss:?}") };
        let mut largest: f64 = 0.0;
        let ending = run(&mut scene.orbit().unwrap(), 200_000, |contact| {
            if contact.n > 190_000 {
                largest = largest.max(contact.state.theta.abs());
            }
            true
        });
        assert_eq!(ending, Some(Ending::Completed));
        assert!((largest / swing - 1.0).abs() < tolerance, "{beyond}: {swing}, in a run {largest}");
        if beyond == 1.001 {
            assert!((largest - 0.125).abs() < 1e-3, "{largest}");
        }
    }
}

#[test]
fn soft_and_hard_laws_do_what_they_are_called() {
    let mut random = Random::new(3);
    let (mut soft, mut hard) = (0, 0);
    for _ in 0..60 {
        let length = random.between(0.05, 0.5);
        let body = [
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, length * random.between(0.3, 1.2)),
            (Name::Height, length * random.between(1.2, 3.0)),
            (Name::Theta, random.size(5e-4, 2e-3)),
        ];
        let Some((scene, _)) = steered(&body, |upper| 1.0002 * upper) else { continue };
        let loss = feedback_loss(&scene);
        let mut largest: f64 = 0.0;
        let ending = run(&mut scene.orbit().unwrap(), 300_000, |contact| {
            if contact.n > 290_000 {
                largest = largest.max(contact.state.theta.abs());
            }
            true
        })
        .unwrap();
        match loss.settles {
            Some(SettledMotion::Swing(swing)) if swing < 0.1 => {
                soft += 1;
                assert_eq!(ending, Ending::Completed, "{body:?} {loss:?}");
                assert!((largest / swing - 1.0).abs() < 0.1, "{body:?}: {loss:?}, in a run {largest}");
            }
            Some(_) => {}
            None => {
                hard += 1;
                // Nothing small holds it: it falls, or ends far away.
                assert!(
                    !loss.is_soft() && (ending != Ending::Completed || largest > 0.2),
                    "{body:?} {loss:?} {largest}"
                );
            }
        }
    }
    assert!(soft > 5, "{soft} soft, {hard} hard");
}

#[test]
fn the_margins_of_a_stable_law_have_both_their_ends() {
    let body = [(Name::ContactDistance, 0.2), (Name::RadiusOfGyration, 0.12), (Name::Height, 0.3), (Name::Theta, 0.01)];
    let (scene, upper) = steered(&body, |_| 1.0).unwrap();
    let ends: Vec<_> = ends(&scene).into_iter().filter(|loss| loss.end == Parameter::FeedbackFactor).collect();
    assert_eq!(ends.len(), 2);
    assert!(ends[0].value < 1.0 && (ends[1].value - upper).abs() < 1e-9 * upper);
    assert!(ends.iter().all(|loss| loss.settles.is_none()));
}

#[test]
fn beyond_its_upper_end_the_energy_gain_flips_to_two_heights() {
    let mut random = Random::new(17);
    for _ in 0..40 {
        let mut values = random_values(&mut random, false);
        let upper = {
            let scene = scene(&values);
            small_deviations(&scene).unwrap().linear.upper_energy_gain
        };
        // At the end itself the coefficient is that of the map.
        values[4].1 = upper;
        let at = scene(&values);
        let fixed_point = small_deviations(&at).unwrap().fixed_point;
        let eight = 8.0 / (fixed_point.speed * fixed_point.speed);
        let loss = ends(&at).into_iter().find(|loss| loss.end == Parameter::ENERGY_GAIN).unwrap();
        assert_eq!((loss.bifurcation, loss.kind()), (Bifurcation::PeriodDoubling, "soft"));
        assert_eq!(loss.coefficient, eight);
        let form = critical(&at, Parameter::Field(Name::EnergyGain));
        assert!((-form.growth / eight - 1.0).abs() < 1e-9, "{form:?}");
        values[4].1 = upper * random.between(1.005, 1.05);
        values[6].1 += 1e-3 * values[0].1;
        let beyond = scene(&values);
        let rod = beyond.parameters::<f64>();
        let loss = ends(&beyond).into_iter().find(|loss| loss.end == Parameter::ENERGY_GAIN).unwrap();
        let Some(SettledMotion::Heights { heights, .. }) = loss.settles else { panic!("{loss:?}") };
        let mut last = [0.0; 2];
        let ending = run(&mut beyond.orbit().unwrap(), 20_000, |contact| {
            let height = rod.contact_distance + contact.state.y_dot.powi(2) / (2.0 * rod.gravity);
            last = [last[1], height];
            true
        });
        assert_eq!(ending, Some(Ending::Completed));
        last.sort_by(f64::total_cmp);
        for (run, said) in last.iter().zip(heights) {
            assert!((run / said - 1.0).abs() < 1e-9, "{last:?} and {heights:?}");
        }
    }
}

#[test]
fn the_angle_on_two_heights_is_judged_over_both() {
    let at = |tilt_gain: f64, theta: f64| {
        paper(&[
            (Name::EnergyGain, 0.785),
            (Name::TargetHeight, 0.2),
            (Name::TiltGain, tilt_gain),
            (Name::Theta, theta),
            (Name::Height, 0.21),
        ])
    };
    let bounded =
        |tilt_gain: f64| match ends(&at(tilt_gain, 0.0)).into_iter().find(|loss| loss.end == Parameter::ENERGY_GAIN) {
            Some(StabilityLoss { settles: Some(SettledMotion::Heights { angle_bounded, .. }), .. }) => angle_bounded,
            other => panic!("{other:?}"),
        };
    let survives = |tilt_gain: f64| {
        run(&mut at(tilt_gain, 1e-6).orbit().unwrap(), 3_000, |contact| contact.state.theta.abs() < 1e-2)
            == Some(Ending::Completed)
    };
    for tilt_gain in [0.99, 1.05, 1.1, 1.3, 1.6] {
        assert_eq!(bounded(tilt_gain), survives(tilt_gain), "κ = {tilt_gain}");
    }
}

/// The normal form of a scene that has the critical value of a number.
fn critical(scene: &Scene, parameter: Parameter) -> CriticalForm {
    let fixed_point = small_deviations(scene).unwrap().fixed_point;
    let map = ReturnMap::new(&scene.model(), 1);
    let at = map.vector(&fixed_point.state(), fixed_point.x);
    let minus = Complex::new(-1.0, 0.0);
    CriticalForm::new(scene, parameter, &find_planned(&map, &at, &at).unwrap(), Some(minus)).unwrap()
}

#[test]
fn the_boundary_coefficient_is_that_of_the_map() {
    let mut random = Random::new(23);
    for slide in ["none", "matched", "none"] {
        for number in 0..20 {
            let mut values = random_values(&mut random, slide == "matched");
            if slide == "matched" {
                values.push((Name::Friction, 0.4));
            }
            if number % 2 == 0 {
                values.retain(|(name, _)| !matches!(name, Name::EnergyGain | Name::TargetHeight));
            }
            let scene = scene_on(slide, &values);
            let fixed_point = small_deviations(&scene).unwrap().fixed_point;
            let kappa = small_deviations(&scene).unwrap().linear.critical_tilt_gain;
            let scene = with(scene.draft(), &[(Name::TiltGain, kappa)]);
            let coefficient = boundary_coefficient(&scene.model(), &fixed_point).unwrap();
            let form = critical(&scene, Parameter::Field(Name::TiltGain));
            let found = form.branch / (kappa - 1.0);
            assert!((found - coefficient).abs() < 1e-11 * coefficient.abs().max(1.0), "{slide} {coefficient} {form:?}");
            assert_eq!((form.bifurcation, form.pumped), (Bifurcation::PeriodDoubling, 0.0));
        }
    }
}

#[test]
fn the_boundary_coefficient_beside_a_held_drift_is_that_of_orbits_of_two_bounces() {
    let draft = || worded(Draft::default(), &[(Name::EnergyMeasure, "total")]);
    let held = |kappa: f64, drift: f64| {
        let values = [(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2), (Name::TiltGain, kappa), (Name::XDot, drift)];
        with(draft(), &[&body()[..], &values[..]].concat())
    };
    let without = balance(&held(1.1, 0.0)).boundary.unwrap();
    let near = balance(&held(1.1, 1e-4)).boundary.unwrap();
    assert!((near / without - 1.0).abs() < 1e-5, "{near} {without}");
    for drift in [0.1, 0.3] {
        let found = balance(&held(1.1, drift));
        let coefficient = found.boundary.unwrap();
        let critical = found.small.linear.critical_tilt_gain;
        for theta in [0.01_f64, 0.02] {
            let kappa = critical + (critical - 1.0) * coefficient * theta * theta;
            let scene = held(kappa, drift);
            let bounce = small_deviations(&scene).unwrap().fixed_point;
            let map = ReturnMap::new(&scene.model(), 2);
            let spin = scene.gravity() * theta / bounce.speed;
            let x_dot = bounce.x_dot + kappa * theta * bounce.speed;
            let start = map.vector(&State { theta, x_dot, theta_dot: spin, ..bounce.state() }, 0.0);
            let orbit = find(&map, &start, &start).unwrap();
            let swings = map.state(&orbit.at).theta;
            assert!(
                (swings / theta - 1.0).abs() < 2.0 * theta,
                "{drift}: {swings} at {theta}, {coefficient} {orbit:?}"
            );
        }
    }
}

#[test]
fn beyond_a_soft_end_in_air_a_swing_of_the_size_that_it_says_stays() {
    let mut random = Random::new(31);
    let (mut soft, mut hard) = (0, 0);
    for number in 0..20 {
        let mut values = random_values(&mut random, false);
        let drag = random.between(0.05, 1.0);
        values.push((Name::RotationDrag, drag));
        if number % 4 < 2 {
            values.push((Name::Drag, 0.3 * drag));
        }
        values[2].1 = 1.0 + 0.5 * (values[2].1 - 1.0);
        values[4].1 *= 0.4;
        let draft = worded(Draft::default(), &[(Name::EnergyMeasure, ["total", "vertical"][number % 2])]);
        let scene = with(draft, &values);
        let loss = ends(&scene).into_iter().find(|loss| loss.end == Parameter::TILT_GAIN).unwrap();
        // A search finds the same end.
        let searched = limits_of(&scene, Parameter::Field(Name::TiltGain), &mut || true).unwrap();
        let found = if searched.bounded { searched.upper } else { searched.lower }.unwrap();
        assert!((found.value - loss.value).abs() < 1e-10, "{found:?} {loss:?}");
        let swing: f64 = 0.005;
        let beyond = loss.value + loss.coefficient.abs() * (loss.value - 1.0) * swing * swing;
        let scene = with(scene.draft(), &[(Name::TiltGain, beyond)]);
        let start = State { theta: 0.2 * swing, ..small_deviations(&scene).unwrap().fixed_point.state() };
        let mut orbit = Orbit::at(scene.running_model(), scene.rules(), start);
        let mut largest: f64 = 0.0;
        let ending = run(&mut orbit, 100_000, |contact| {
            if contact.n > 99_000 {
                largest = largest.max(contact.state.theta.abs());
            }
            true
        });
        if loss.is_soft() {
            soft += 1;
            assert_eq!(ending, Some(Ending::Completed), "{loss:?} {scene:?}");
            assert!((largest / swing - 1.0).abs() < 0.01, "{largest} {loss:?} {scene:?}");
        } else {
            hard += 1;
            assert_ne!(ending, Some(Ending::Completed), "{loss:?} {scene:?}");
        }
    }
    assert!(soft > 4 && hard > 4, "{soft} {hard}");
}

// Normal forms of random scenes against their return maps: the growth of a swing, and the quantities that it moves.

/// Bounces over which a swing is followed.
const BOUNCES: usize = 4_000;

/// Bounces at each end over which its amplitude is averaged.
const WINDOW: usize = 400;

/// Growth that is aimed at, of the logarithm of the amplitude.
const GROWTH: f64 = 0.08;

/// Growth below which the parts of second order hide it.
const LEAST: f64 = 0.01;

/// Distance of λ, λ², λ³ and λ⁴ from 1.
const RESONANT: f64 = 0.1;

/// Way, m, that a swing may take the place, where strikes depend on it.
const FARTHEST: f64 = 1e-3;

/// Share of the bounce speed that a kept quantity is moved by at most.
const MOVED: f64 = 0.003;

/// Swings that are tried at most, rad.
const WIDEST: f64 = 0.01;

/// A swing with its normal form.
struct Case {
    map: ReturnMap,
    bounce: RepeatingBounce,
    form: SwingForm,
}

/// Course of a swing over its bounces.
struct Course {
    /// Change of the logarithm of its amplitude from the first window to the last.
    growth: f64,
    /// Change of each kept quantity.
    shifts: Vec<f64>,
}

impl Case {
    /// `None` where a random scene has no pair on the unit circle, or one without a form.
    fn draw(random: &mut Random) -> Option<(Self, Mix)> {
        let mix = Mix::draw(random, features::Swing::Calm, &all_but(&RANDOM));
        let mut bounce = of_scene(&mix.scene.with_tilt_law()).ok()?;
        let map = bounce.map;
        // A drift moves the place, and with it the coefficients where strikes depend on it.
        if map.components().contains(&X) && !bounce.neutral.is_empty() {
            let mut still = bounce.at;
            still[X_DOT] = 0.0;
            bounce = find(&map, &still, &still).ok().filter(|found| found.at[X_DOT] == 0.0)?;
        }
        let pair = |value: &Complex<f64>| value.im > 0.0 && (value.norm_sqr() - 1.0).abs() < 2.0 * ON_CIRCLE;
        let values = bounce.eigenvalues.clone();
        let others = values.iter().filter(|value| value.norm_sqr() > (1.0 - 1e-3_f64).powi(2)).count();
        let eigenvalue = values.into_iter().find(pair)?;
        let form = SwingForm::new(&bounce, eigenvalue).ok().filter(|_| others == 2)?;
        // Near a strong resonance the terms of higher order are large.
        let near = |order: i32| (eigenvalue.powi(order) - Complex::new(1.0, 0.0)).norm_sqr() < RESONANT * RESONANT;
        if (1..=4).any(near) || eigenvalue.re.abs() > 1.0 - RESONANT {
            return None;
        }
        Some((Self { map, bounce, form }, mix))
    }

    /// |w|² of a swing that grows or dies out by [`GROWTH`], rad².
    fn size(&self) -> f64 {
        let bounces = BOUNCES as f64;
        let speed = self.bounce.at[Y_DOT].abs();
        let least = self.form.shifts.iter().map(|shift| shift.abs() * bounces).fold(0.0, f64::max);
        let growth = GROWTH / (bounces * self.form.growth.abs() + 0.5 * bounces * bounces * self.form.pumped().abs());
        growth.min(MOVED * speed / least)
    }

    /// By the slow equations of the normal form, in steps of one bounce.
    fn predicted(&self, size: f64) -> Course {
        let (mut square, mut moved) = (size, vec![0.0; self.form.shifts.len()]);
        let mut logarithms = Vec::new();
        for _ in 0..BOUNCES {
            logarithms.push(0.5 * square.ln());
            let pushed: f64 = moved.iter().zip(&self.form.growths).map(|(moved, growth)| moved * growth).sum();
            for (moved, shift) in moved.iter_mut().zip(&self.form.shifts) {
                *moved += shift * square;
            }
            square *= (2.0 * (self.form.growth * square + pushed)).exp();
        }
        Course { growth: between_ends(&logarithms), shifts: moved }
    }

    /// By the map, from w = √size or i√size; `None` if the map ends or the place moves.
    fn followed(&self, size: f64, turned: bool) -> Option<Course> {
        let w = if turned { Complex::new(0.0, size.sqrt()) } else { Complex::new(size.sqrt(), 0.0) };
        let start = self.map.moved(&self.bounce.at, &self.form.right.map(|part| 2.0 * (w * part).re));
        let mut at = start;
        let mut logarithms = Vec::new();
        for _ in 0..BOUNCES {
            logarithms.push(self.form.amplitude(&self.bounce, &at).ln());
            at = self.map.image(&at)?;
        }
        let moved = |vector: &Vector| -> DVector<f64> { self.map.reduced(vector) };
        let change = moved(&at) - moved(&start);
        if self.map.components().contains(&X) && (at[X] - start[X]).abs() > FARTHEST {
            return None;
        }
        let shifts = self.bounce.neutral.iter().map(|neutral| neutral.left.dot(&change)).collect();
        Some(Course { growth: between_ends(&logarithms), shifts })
    }
}

fn between_ends(logarithms: &[f64]) -> f64 {
    let mean = |window: &[f64]| window.iter().sum::<f64>() / window.len() as f64;
    mean(&logarithms[logarithms.len() - WINDOW..]) - mean(&logarithms[..WINDOW])
}

/// The mean over two starts a quarter of a swing apart, whose parts of second order are opposite. `CASES` and `SEED` of the environment give
/// other scenes.
#[test]
fn swings_grow_and_move_kept_quantities_as_their_normal_forms_say() {
    let number = |name, or| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(or);
    let (cases, seed) = (number("CASES", 40), number("SEED", 77));
    let mut random = Random::new(seed);
    let (mut tried, mut ended, mut growing, mut moving, mut wrong) = (0, 0, 0, 0, Vec::new());
    while tried < cases {
        let Some((case, mix)) = Case::draw(&mut random) else { continue };
        let size = case.size();
        let said = case.predicted(size);
        let counts = said.growth.abs() > LEAST;
        if size.sqrt() > WIDEST || !(counts || said.shifts.iter().any(|shift| *shift != 0.0)) {
            continue;
        }
        let [Some(one), Some(other)] = [false, true].map(|turned| case.followed(size, turned)) else {
            ended += 1;
            continue;
        };
        tried += 1;
        let courses = [one, other];
        let mean = |of: &dyn Fn(&Course) -> f64| 0.5 * (of(&courses[0]) + of(&courses[1]));
        let grown = mean(&|course| course.growth);
        growing += usize::from(counts);
        if counts && (grown - said.growth).abs() > 0.1 * said.growth.abs() {
            wrong.push(format!(
                "{:?}: growth {grown}, {} said, |w| {}, {:?}",
                mix.features,
                said.growth,
                size.sqrt(),
                case.form
            ));
        }
        for (index, shift) in said.shifts.iter().enumerate().filter(|(_, shift)| **shift != 0.0) {
            let moved = mean(&|course| course.shifts[index]);
            moving += 1;
            if (moved - shift).abs() > 0.1 * shift.abs() {
                wrong.push(format!("{:?}: shift {moved}, {shift} said, {:?}", mix.features, case.form));
            }
        }
    }
    for line in &wrong {
        eprintln!("{line}");
    }
    eprintln!("{growing} swings, {moving} kept quantities");
    assert!(ended <= cases, "{ended} swings end or move their place, beside {cases} that do not");
    assert!(wrong.is_empty(), "{} of {tried} swings do not go as their normal forms say", wrong.len());
}
