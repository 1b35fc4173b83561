//! Stability with friction: eigenvalues against the derivative, drift and energy against long runs, the stick cone, and a table
//! that only tilts.

use crate::support::evidence::judged;
use crate::support::random;
use crate::support::rig_runs::{with, with_numbers, worded};
use equipoise_physics::analysis::basin::find_basin;
use equipoise_physics::analysis::boundary::{boundary_coefficient, period_two_angle, symmetric_orbit};
use equipoise_physics::analysis::contact_regime::{
    ContactRegime, contact_regime, stick_cone, sticking_polynomial_at_one,
};
use equipoise_physics::analysis::gain_range::stable_gains;
use equipoise_physics::analysis::jacobian::{eigenvalues, jacobian};
use equipoise_physics::analysis::limits::{Parameter, limits_of};
use equipoise_physics::analysis::linear_verdict::AngleClass;
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::control::bounce_model::{BounceModel, states};
use equipoise_physics::map::strike::ContactMode;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, GAINS, Name, Scene, Value};
use equipoise_physics::surveys::stability_map::{MapAxis, MapOutcome, MapQuantity, StabilityMap};
use random::Random;

const L: f64 = 0.4 / 3.0;
const RHO: f64 = 0.094_280_904_158_206_35;
/// ρ² + l².
const TURNING: f64 = RHO * RHO + L * L;

fn scene(slide: &'static str, values: &[(Name, f64)]) -> Scene {
    let plain = [(Name::ContactDistance, L), (Name::RadiusOfGyration, RHO), (Name::Friction, 0.3), (Name::Height, 0.2)];
    with(worded(with_numbers(Draft::default(), &plain), &[(Name::Slide, slide)]), values)
}

#[test]
fn the_closed_form_has_the_eigenvalues_of_the_derivative() {
    for slide in ["matched", "none"] {
        for law in ["poisson", "newton", "stronge"] {
            for kappa in [-1.0, 0.5, 1.1, 1.8, 2.3, 2.9, 6.0] {
                for energy_gain in [0.0, 0.2] {
                    let values = [
                        (Name::TiltGain, kappa),
                        (Name::Restitution, 0.6),
                        (Name::EnergyGain, energy_gain),
                        (Name::TargetHeight, 0.25),
                    ];
                    let mut draft = scene(slide, &values).draft();
                    draft.set(Name::Law, Some(Value::Choice(law))).unwrap();
                    let scene = draft.build().unwrap();
                    let point = small_deviations(&scene).unwrap().fixed_point;
                    let state = State { theta: 0.0, x_dot: 0.0, y_dot: -point.speed, theta_dot: 0.0 };
                    let linear = small_deviations(&scene).unwrap().linear;
                    let exact = eigenvalues(&jacobian(&scene.model(), &state, 1).unwrap().matrix).unwrap();
                    // Each has one near it: their order is not certain where moduli are equal.
                    for value in &linear.eigenvalues {
                        let near = exact.iter().map(|other| (other - value).norm()).fold(f64::INFINITY, f64::min);
                        assert!(near < 1e-6, "{slide} {law} {kappa} {energy_gain}: {exact:?} {linear:?}");
                    }
                    let critical = 1.0 + scene.gravity() * TURNING / (point.speed * point.speed * L);
                    if slide == "matched" {
                        assert!((linear.critical_tilt_gain - critical).abs() < 1e-12);
                        assert_eq!(linear.class == AngleClass::Elliptic, kappa > 1.0 && kappa < critical);
                    } else {
                        assert!(linear.spectral_radius() > 1.0 && linear.residue.is_none());
                        let at_one: f64 = linear
                            .eigenvalues
                            .iter()
                            .filter(|value| (value.re - linear.energy_eigenvalue).abs() > 1e-9)
                            .map(|value| 1.0 - value.re)
                            .product();
                        assert!(
                            (at_one - sticking_polynomial_at_one(&scene.parameters(), point.speed)).abs() < 1e-9
                                && at_one < 0.0
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_boundary_is_where_runs_begin_to_leave() {
    // Half-way between bounces: how far a deviation of 1e-7 gets.
    let reach = |kappa: f64| {
        let mut orbit = scene("matched", &[(Name::TiltGain, kappa), (Name::Theta, 1e-7)]).orbit().unwrap();
        let mut largest: f64 = 0.0;
        run(&mut orbit, 300, |contact| {
            largest = largest.max(contact.state.theta.abs());
            true
        });
        largest
    };
    let still = scene("matched", &[(Name::TiltGain, 2.0)]);
    let critical = small_deviations(&still).unwrap().linear.critical_tilt_gain;
    assert!((critical - 2.5).abs() < 1e-12, "{critical}");
    assert!(reach(critical - 0.01) < 1e-5 && reach(critical + 0.01) > 1e-3);
    assert!(reach(1.01) < 1e-5 && reach(0.99) > 1e-3);
}

#[test]
fn a_matched_run_drifts_as_said_and_takes_back_what_it_lends() {
    for kappa in [1.2, 1.7, 2.2] {
        let values = [(Name::TiltGain, kappa), (Name::Theta, 0.01), (Name::ThetaDot, 0.05), (Name::XDot, 0.02)];
        let scene = scene("matched", &values);
        let drift = small_deviations(&scene).ok().and_then(|small| small.drift).unwrap();
        let speed = small_deviations(&scene).unwrap().fixed_point.speed;
        let mut orbit = scene.orbit().unwrap();
        let body = orbit.body;
        let kept = |state: &State| {
            let spin = state.theta_dot;
            body.energy(state) + L * drift * spin + 0.5 * kappa * TURNING * spin * spin / (kappa - 1.0)
        };
        let expected = 0.5 * speed * speed + 0.5 * drift * drift + scene.gravity() * L;
        let (mut off, mut swing, mut last) = (0.0_f64, 0.0_f64, (0.0, 0.0));
        let ending = run(&mut orbit, 20_000, |contact| {
            off = off.max((kept(&contact.state) - expected).abs());
            swing = swing.max((body.energy(&contact.state) - 0.5 * speed * speed - scene.gravity() * L).abs());
            last = (contact.t, contact.x);
            true
        });
        assert_eq!(ending, Some(Ending::Completed));
        println!("κ = {kappa}: off by {off:.1e}, energy by {swing:.1e}; drift {} said {drift}", last.1 / last.0);
        assert!(off < 1e-3 * swing, "{off:e} {swing:e}");
        assert!((last.1 / last.0 - drift).abs() < 1e-2 * drift.abs().max(0.02), "{} {drift}", last.1 / last.0);
    }
}

#[test]
fn the_stick_cone_is_where_a_matched_contact_begins_to_slide() {
    for (friction, kappa) in [(0.01, 2.0), (0.02, 0.4), (0.05, 2.4)] {
        let cone =
            stick_cone(&scene("matched", &[(Name::Friction, friction), (Name::TiltGain, kappa)]).model()).unwrap();
        assert!((cone - friction * TURNING / (L * L * (kappa - 1.0_f64).abs())).abs() < 1e-15);
        for (share, mode) in [(0.99, ContactMode::Stick), (1.01, ContactMode::SlideThrough)] {
            let values = [(Name::Friction, friction), (Name::TiltGain, kappa), (Name::Theta, share * cone)];
            let strike = scene("matched", &values).orbit().unwrap().advance().strike.unwrap();
            assert_eq!(strike.mode, mode, "{friction} {kappa} {share}");
        }
    }
}

#[test]
fn a_table_that_only_tilts_falls_and_the_verdict_says_why() {
    let scene = scene("none", &[(Name::Friction, 0.05), (Name::TiltGain, 1.1), (Name::Theta, 0.05)]);
    assert_eq!(contact_regime(&scene.model()), ContactRegime::Sticking);
    let nonlinear = run_nonlinear(&scene, 1000, || true).unwrap();
    assert!(nonlinear.impacts <= 10, "{nonlinear:?}");
    let point = small_deviations(&scene).unwrap().fixed_point;
    let found = judged(&scene, 1000);
    assert!(found.verdict == Verdict::Unstable && !found.says_bounded, "{found:?}");
    assert!(
        small_deviations(&scene).ok().and_then(|small| small.drift).is_none()
            && boundary_coefficient(&scene.model(), &point).is_none()
    );
}

/// Beyond the κ_c without friction, 1.5, a run falls where its release is outside of the stick cone, and survives where its swing,
/// θ₀/√(1 − R), stays inside.
#[test]
fn the_stick_cone_shows_in_a_region_over_friction_and_tilt_gain() {
    let theta = 0.02;
    let region = StabilityMap {
        scene: scene("matched", &[(Name::Theta, theta), (Name::TiltGain, 2.0)]).draft(),
        x: MapAxis { name: Name::Friction, from: 0.001, to: 0.06, count: 40 },
        y: MapAxis { name: Name::TiltGain, from: 1.6, to: 2.4, count: 25 },
        impacts: 1000,
        quantity: MapQuantity::Survival,
        catch: CatchSettings::default(),
    };
    let cells = region.cells(0..40 * 25, &mut || true).unwrap();
    let (mut inside, mut outside) = (0, 0);
    for (index, cell) in cells.iter().enumerate() {
        let scene = region.scene(index % 40, index / 40).unwrap();
        let cone = stick_cone(&scene.model()).unwrap();
        let residue = small_deviations(&scene).unwrap().linear.residue.unwrap();
        let survived = cell.outcome == Some(MapOutcome::Run(EndingKind::Completed));
        if theta / (1.0 - residue).sqrt() < cone {
            inside += 1;
            assert!(survived, "{index} {cell:?} {cone}");
        } else if theta > cone {
            outside += 1;
            assert!(!survived, "{index} {cell:?} {cone}");
        }
    }
    assert!(inside > 100 && outside > 100, "{inside} {outside}");
    // The boundary of the linear verdict is that of a matched table, for any friction.
    let residues =
        StabilityMap { quantity: MapQuantity::Residue, y: MapAxis { from: 2.0, to: 3.0, ..region.y }, ..region };
    let ends = residues.boundary(9, &mut || true).unwrap();
    assert!(
        !ends.is_empty()
            && ends
                .iter()
                .all(|(level, from, to)| *level == 1.0 && (from[1] - 2.5).abs() < 1e-9 && (to[1] - 2.5).abs() < 1e-9)
    );
}

#[test]
fn a_matched_table_has_a_basin_and_one_that_only_tilts_has_none() {
    let basin = |slide| find_basin(&scene(slide, &[(Name::TiltGain, 1.3)]), 300, || true).unwrap();
    let (matched, held) = (basin("matched"), basin("none"));
    assert!(matched.unbroken > 0.1 && held.theta < 1e-3, "{matched:?} {held:?}");
}

/// Tests that a state turns into its mirror image over one bounce.
fn is_mirrored(scene: &Scene, state: State) -> bool {
    let mut orbit = Orbit::at(scene.model(), Rules::BARE_MAP, state);
    orbit.advance();
    let after = *orbit.state();
    let off = [
        after.theta + state.theta,
        after.x_dot + state.x_dot,
        after.y_dot - state.y_dot,
        after.theta_dot + state.theta_dot,
    ];
    off.iter().all(|off| off.abs() < 1e-12)
}

/// κ − κ_c ≈ aCθ² on the orbits of period 2, on the quantity that the table conserves to second order, or at its target height.
#[test]
fn the_coefficient_at_the_boundary_is_that_of_the_orbits_that_branch_off() {
    let mut random = Random::new(11);
    let (mut soft, mut hard) = (0, 0);
    for _ in 0..300 {
        let l = random.between(0.05, 0.4);
        let rho = l * random.between(0.1, 1.2);
        let height = l * (1.0 + random.between(0.2, 2.0));
        let steered = random.between(0.0, 1.0) < 0.5;
        let gain = if steered { 0.3 / (2.0 * 9.81 * (height - l)) } else { 0.0 };
        let mut values = vec![
            (Name::ContactDistance, l),
            (Name::RadiusOfGyration, rho),
            (Name::Friction, random.between(0.1, 0.9)),
            (Name::Height, height),
            (Name::TiltGain, 1.1),
            (Name::Restitution, random.between(0.2, 1.0)),
        ];
        if steered {
            values.extend([(Name::EnergyGain, gain), (Name::TargetHeight, height)]);
        }
        let upright = scene("matched", &values);
        let point = small_deviations(&upright).unwrap().fixed_point;
        let critical = small_deviations(&upright).unwrap().linear.critical_tilt_gain;
        let coefficient = boundary_coefficient(&upright.model(), &point).unwrap().coefficient;
        if critical > 50.0 || coefficient.abs() < 0.05 {
            continue;
        }
        if coefficient > 0.0 {
            soft += 1
        } else {
            hard += 1
        }
        let at = |share: f64| {
            let kappa = critical + (critical - 1.0) * coefficient * share * share;
            let mut draft = upright.draft();
            draft.set(Name::TiltGain, Some(Value::Number(kappa))).unwrap();
            draft.build().unwrap()
        };
        let small = 2e-3 / (1.0 + critical);
        let there = at(small);
        let theta = period_two_angle(&there.model(), 1.5, &point).unwrap();
        assert!((theta / small - 1.0).abs() < 1e-3, "{theta} {small} {coefficient} {critical}");
        // The orbit itself, by the map.
        let friction = there.model().friction.map(|friction| friction.coefficient);
        let orbit = symmetric_orbit(&there.parameters(), friction, theta).unwrap();
        let speed = orbit.speed_squared.sqrt();
        let (x_dot, theta_dot) = (orbit.slope * speed, there.gravity() * theta / speed);
        let state = State { theta, x_dot, y_dot: -speed, theta_dot };
        // With a gain on the energy the height must be the target's, which the angle is found for.
        assert!(is_mirrored(&there, state), "{there:?}");
    }
    assert!(soft > 50 && hard > 50, "{soft} {hard}");
}

/// At κ_c a soft loss keeps small starts bounded, and a hard one lets them fall.
#[test]
fn runs_at_the_boundary_of_a_matched_table_do_as_the_coefficient_says() {
    for (rho, height, energy_gain) in [(RHO, 0.2, 0.0), (0.3 * L, 0.16, 0.0), (RHO, 0.2, 0.1), (0.3 * L, 0.145, 0.0)] {
        let mut values = vec![(Name::RadiusOfGyration, rho), (Name::Height, height), (Name::TiltGain, 1.1)];
        if energy_gain != 0.0 {
            values.extend([(Name::EnergyGain, energy_gain), (Name::TargetHeight, height)]);
        }
        let upright = scene("matched", &values);
        let point = small_deviations(&upright).unwrap().fixed_point;
        let critical = small_deviations(&upright).unwrap().linear.critical_tilt_gain;
        let coefficient = boundary_coefficient(&upright.model(), &point).unwrap().coefficient;
        values[2].1 = critical;
        values.push((Name::Theta, 1e-4));
        let run = run_nonlinear(&scene("matched", &values), 20_000, || true).unwrap();
        println!("κ_c {critical} C {coefficient}: {:?} at {} with {}", run.ending, run.impacts, run.max_theta);
        assert_eq!(coefficient > 0.0, run.ending == Ending::Completed, "{coefficient}");
    }
}

/// The scene with a state feedback of this factor.
fn steered(scene: &Scene, factor: f64) -> Scene {
    let gains = GAINS.map(|name| (name, factor * scene.number(name).unwrap()));
    with(scene.draft(), &gains)
}

/// The release of a swing loses height before the body rests: margins are those of the bounce that is left.
#[test]
fn margins_of_a_feedback_are_those_of_the_bounce_on_which_the_run_settles() {
    let gains = [0.06, -3.2, 1.08, -0.072];
    let values = GAINS.into_iter().zip(gains).chain([(Name::Theta, 0.1)]);
    let scene = scene("none", &values.collect::<Vec<_>>());
    let small = small_deviations(&scene).unwrap();
    let (map, bounce) = small.found().unwrap();
    let range = stable_gains(map, bounce).unwrap();
    let near = |one: f64, other: f64| assert!((one - other).abs() < 1e-8, "{one} {other}");
    // By the search of limits, and by the model that judges the law of a scene beside a designed one.
    let found = limits_of(&scene, Parameter::FeedbackFactor, &mut || true).unwrap();
    near(found.lower.unwrap().value, range.lower);
    near(found.upper.unwrap().value, range.upper);
    let model = BounceModel::about(&scene, &small).stable_factors(gains, states(true)).unwrap();
    near(model.lower, range.lower);
    near(model.upper, range.upper);
    // And by runs beside it.
    for (end, inward) in [(range.lower, 1.0), (range.upper, -1.0)] {
        for (factor, stays) in [(end * (1.0 + 1e-3 * inward), true), (end * (1.0 - 1e-3 * inward), false)] {
            let start = State { theta: 1e-6, ..small.state() };
            let mut orbit = Orbit::at(steered(&scene, factor).model(), Rules::BARE_MAP, start);
            let mut last = 0.0;
            let ending = run(&mut orbit, 20_000, |contact| {
                last = contact.state.theta.abs();
                true
            });
            assert_eq!(ending == Some(Ending::Completed) && last < 1e-7, stays, "{factor}: {ending:?} {last}");
        }
    }
}
