//! The laws by which a table steers the energy: vertical, total, in one strike, and with a program of heights.

use equipoise_physics::analysis::boundary::boundary_coefficient;
use equipoise_physics::analysis::evidence::Judgement;
use equipoise_physics::analysis::jacobian::jacobian;
use equipoise_physics::analysis::periodic_orbits::{OrbitProblem, find};
use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::paper;
use crate::support::features::{Mix, Swing};
use crate::support::random::Random;
use crate::support::reference::differences;
use crate::support::rig::{with_numbers, worded};
use crate::support::scenes;
use crate::support::scenes::{Kind, judged, swing};

fn scene(numbers: &[(Name, f64)], others: &[(Name, Value)]) -> Scene {
    let body = [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0)];
    let mut draft = with_numbers(with_numbers(Draft::default(), &body), numbers);
    for &(name, value) in others {
        draft.set(name, Some(value)).unwrap();
    }
    draft.build().unwrap()
}

const TOTAL: (Name, Value) = (Name::EnergyMeasure, Value::Choice("total"));
const ONE_STRIKE: (Name, Value) = (Name::EnergyLaw, Value::Choice("one_strike"));

fn case_4(tilt_gain: f64, theta: f64, others: &[(Name, Value)]) -> Scene {
    let numbers = [
        (Name::Incline, std::f64::consts::FRAC_PI_4),
        (Name::Restitution, 0.5),
        (Name::EnergyGain, 0.165),
        (Name::TargetHeight, 0.25),
        (Name::Height, 0.25),
        (Name::TiltGain, tilt_gain),
        (Name::Theta, theta),
    ];
    scene(&numbers, others)
}

fn juggling(heights: &[f64], theta: f64) -> Scene {
    let program = (Name::Program, Value::Numbers(HeightProgram::new(heights).unwrap()));
    scene(&[(Name::TiltGain, 1.1), (Name::Height, 0.25), (Name::Theta, theta)], &[ONE_STRIKE, program])
}

/// ½|v|² + G l cos θ of a state after a strike, with the platform's own mathematics.
fn energy(scene: &Scene, state: &State) -> f64 {
    let rod = scene.parameters::<f64>();
    let spin = rod.radius_of_gyration * state.theta_dot;
    0.5 * (state.x_dot.powi(2) + state.y_dot.powi(2) + spin.powi(2))
        + rod.gravity * rod.contact_distance * state.theta.cos()
}

#[test]
fn one_strike_brings_the_energy_to_its_target() {
    let mut random = Random::new(1);
    let (mut struck, mut worst) = (0, 0.0_f64);
    for _ in 0..2000 {
        let scene = scenes::scene(&mut random, Kind::OneStrike);
        let Some(contact) = scene.orbit().ok().map(|mut orbit| orbit.advance()) else { continue };
        let Some(strike) =
            contact.strike.filter(|_| scene.assumed_restitution() == scene.parameters::<f64>().restitution)
        else {
            continue;
        };
        let target = scene.parameters::<f64>().target_energy;
        // A strike can take no more than the normal energy ½u² = −½v_nc P/γ at γ = 1.
        if strike.impulse_normal / -strike.push < 0.0 || strike.push == strike.normal_velocity {
            continue;
        }
        worst = worst.max((energy(&scene, &strike.after) / target - 1.0).abs());
        struck += 1;
    }
    assert!(struck > 500, "{struck}");
    assert!(worst <= 1e-14, "{worst:e}");
}

#[test]
fn juggling_holds_the_energy_after_every_strike() {
    let scene = juggling(&[0.2, 0.3], 0.02);
    let gravity = scene.gravity();
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    let ending = run(&mut scene.orbit().unwrap(), 3000, |contact| {
        let target = gravity * if contact.n % 2 == 1 { 0.2 } else { 0.3 };
        worst = worst.max((energy(&scene, &contact.strike.unwrap().after) / target - 1.0).abs());
        most = most.max(contact.state.theta.abs());
        true
    });
    assert_eq!(ending, Some(Ending::Completed));
    assert!(worst <= 3e-15, "{worst:e}");
    assert!(most < 0.1, "{most}");
}

/// A strike of r = 0 leaves the contact point at rest along the normal, with what the strike could not take.
#[test]
fn a_strike_takes_no_more_than_the_normal_energy() {
    let low = |theta| {
        let numbers = [(Name::TiltGain, 1.1), (Name::Height, 0.2), (Name::TargetHeight, 0.1), (Name::Theta, theta)];
        scene(&numbers, &[ONE_STRIKE])
    };
    let upright = low(0.0).orbit().unwrap().advance();
    assert!(matches!(upright.ending, Some(Ending::Settled { .. })), "{upright:?}");
    assert_eq!(upright.strike.unwrap().after.y_dot, 0.0);
    let mut orbit = low(0.3).orbit().unwrap();
    let contact = orbit.advance();
    let strike = contact.strike.unwrap();
    assert_eq!(strike.push, strike.normal_velocity);
    let rod = low(0.3).parameters::<f64>();
    let (alpha, beta) = (strike.alpha, 0.3 - strike.alpha);
    let left = alpha.cos() * strike.after.y_dot - alpha.sin() * strike.after.x_dot
        + rod.contact_distance * beta.sin() * strike.after.theta_dot;
    assert!(left.abs() <= 1e-15, "{left:e}");
    assert!(matches!(contact.ending, Some(Ending::Sinking { .. })), "{contact:?}");
}

#[test]
fn total_energy_neither_pumps_nor_damps_a_swing() {
    for tilt_gain in [1.02, 1.05, 1.1, 1.15, 1.2, 1.25] {
        for others in [&[TOTAL][..], &[ONE_STRIKE, (Name::EnergyGain, Value::Number(0.0))][..]] {
            let scene = case_4(tilt_gain, 0.05, others);
            let found = swing(&scene).unwrap();
            assert_eq!(found.form.growth, 0.0, "{tilt_gain}: {found:?}");
        }
        let scene = case_4(tilt_gain, 0.05, &[]);
        let vertical = swing(&scene).unwrap();
        assert!(vertical.form.growth.abs() > 1e-3, "{tilt_gain}: {vertical:?}");
    }
}

/// ℓ measured on runs: 1/A² would fall by 2ℓ a bounce.
#[test]
fn runs_on_the_total_energy_stay_where_vertical_ones_leave() {
    let largest = |scene: &Scene| {
        let (mut first, mut last) = (0.0_f64, 0.0_f64);
        let ending = run(&mut scene.orbit().unwrap(), 20_000, |contact| {
            // The first contacts bring the energy to its target.
            let side = if contact.n <= 6000 { &mut first } else { &mut last };
            if (1001..=6000).contains(&contact.n) || contact.n > 15_000 {
                *side = side.max(contact.state.theta.abs());
            }
            true
        });
        (ending.unwrap().name(), first, last)
    };
    for (tilt_gain, x_dot) in [1.02, 1.05, 1.1, 1.2].into_iter().flat_map(|gain| [(gain, 0.0), (gain, 0.4)]) {
        let (ending, first, last) = largest(&case_4(tilt_gain, 0.05, &[TOTAL, (Name::XDot, Value::Number(x_dot))]));
        assert_eq!(ending, "completed", "{tilt_gain}");
        let measured = (1.0 / (first * first) - 1.0 / (last * last)) / (2.0 * 14_000.0);
        assert!(measured.abs() <= 1e-8 / (0.05 * 0.05), "{tilt_gain}: {measured:e}, {first} to {last}");
    }
    assert_ne!(largest(&case_4(1.05, 0.05, &[])).0, "completed");
}

/// J₃₃ = 1 − (1 + e)κ_E V² for either measure, and (e − ê)/(1 + ê) for one strike; all else as without feedback.
#[test]
fn derivatives_are_those_of_the_closed_forms_and_of_finite_differences() {
    let mut random = Random::new(2);
    for kind in [Kind::Total, Kind::OneStrike] {
        let mut compared = 0;
        for _ in 0..400 {
            let scene = scenes::scene(&mut random, kind);
            let Ok(fixed_point) = small_deviations(&scene).map(|small| small.fixed_point) else { continue };
            let model = scene.model();
            let upright = fixed_point.state();
            let exact = jacobian(&model, &upright, 1).unwrap();
            let linear = small_deviations(&scene).unwrap().linear;
            let eigenvalue = linear.energy_eigenvalue;
            let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-12 * exact.matrix.amax().max(1.0);
            assert!(near(exact.matrix[(2, 2)], eigenvalue), "{kind:?}: {} {eigenvalue}", exact.matrix[(2, 2)]);
            let trace = 3.0 - 4.0 * linear.residue.unwrap() + eigenvalue;
            assert!(near(exact.matrix.trace(), trace), "{kind:?}: {} {trace}", exact.matrix.trace());
            assert!(near(exact.matrix.determinant(), eigenvalue), "{kind:?}: {}", exact.matrix.determinant());
            let differences = differences(&ReturnMap::new(&model, 1), 0.0, &upright, 1e-6).unwrap();
            let off = (&exact.matrix - &differences).amax() / exact.matrix.amax();
            assert!(off <= 1e-7, "{kind:?}: {off:e}\n{}\n{}", exact.matrix, differences);
            let end = exact.end;
            assert!((end.y_dot / upright.y_dot - 1.0).abs() <= 1e-12, "{kind:?}: it comes back");
            assert!(
                end.x_dot == upright.x_dot
                    && upright.x_dot == small_deviations(&scene).ok().and_then(|small| small.drift).unwrap(),
                "{kind:?}"
            );
            compared += 1;
        }
        assert!(compared > 200, "{kind:?}: {compared}");
    }
}

/// On the surface of the target energy the map is that without losses, and so is the coefficient at κ_c.
#[test]
fn the_boundary_is_that_without_losses() {
    let lossless =
        scene(&[(Name::Incline, std::f64::consts::FRAC_PI_4), (Name::Height, 0.25), (Name::TiltGain, 1.1)], &[]);
    let of =
        |scene: &Scene| boundary_coefficient(&scene.model(), &small_deviations(scene).unwrap().fixed_point).unwrap();
    let expected = of(&lossless);
    for others in [&[TOTAL][..], &[ONE_STRIKE, (Name::EnergyGain, Value::Number(0.0))][..]] {
        let found = of(&case_4(1.1, 0.0, others));
        assert!((found - expected).abs() <= 1e-13, "{found} {expected}");
    }
    assert!(of(&case_4(1.1, 0.0, &[])) < 0.0);
}

#[test]
fn a_wrong_belief_settles_where_the_closed_form_says() {
    let mut random = Random::new(3);
    let mut seen = 0;
    for _ in 0..200 {
        let (restitution, assumed) = (random.between(0.2, 1.0), random.between(0.2, 1.0));
        let numbers = [
            (Name::Restitution, restitution),
            (Name::AssumedRestitution, assumed),
            (Name::TargetHeight, 0.25),
            (Name::Height, 0.3),
            (Name::TiltGain, 1.1),
        ];
        let scene = scene(&numbers, &[ONE_STRIKE]);
        let fixed_point = small_deviations(&scene).unwrap().fixed_point;
        let mut orbit = scene.orbit().unwrap();
        for _ in 0..200 {
            orbit.advance();
        }
        assert!((orbit.state().y_dot + fixed_point.speed).abs() <= 1e-13, "{restitution} {assumed}");
        seen += 1;
    }
    assert_eq!(seen, 200);
}

#[test]
fn a_drift_takes_its_part_of_a_total_energy_that_is_held() {
    let with = |x_dot| [(Name::XDot, x_dot), (Name::TiltGain, 1.1), (Name::Height, 0.25), (Name::TargetHeight, 0.2)];
    let drifting = with(0.5);
    let proportional: Vec<_> = drifting.into_iter().chain([(Name::EnergyGain, 0.45)]).collect();
    let believing: Vec<_> =
        drifting.into_iter().chain([(Name::Restitution, 0.8), (Name::AssumedRestitution, 0.9)]).collect();
    let mut speeds = Vec::new();
    for scene in [scene(&proportional, &[TOTAL]), scene(&drifting, &[ONE_STRIKE]), scene(&believing, &[ONE_STRIKE])] {
        let fixed_point = small_deviations(&scene).unwrap().fixed_point;
        let (mut orbit, mut exact) = (scene.orbit().unwrap(), scene.extended_orbit().unwrap());
        assert_eq!(run(&mut orbit, 2000, |_| true), Some(Ending::Completed));
        (0..500).for_each(|_| assert_eq!(exact.advance().ending, None));
        for State { x_dot, y_dot, .. } in [*orbit.state(), exact.state().to_f64()] {
            assert!(
                (y_dot + fixed_point.speed).abs() < 1e-12 && (x_dot - 0.5).abs() < 1e-12,
                "{y_dot} {fixed_point:?}"
            );
        }
        speeds.push(fixed_point.speed);
    }
    // 2G(y* − l) − c².
    let expected = (2.0 * 9.81 * (0.2 - 0.4 / 3.0) - 0.25_f64).sqrt();
    assert!((speeds[0] - expected).abs() < 1e-12 && speeds[0] == speeds[1] && speeds[2] != speeds[0], "{speeds:?}");
    let fast = scene(&with(1.5), &[ONE_STRIKE]);
    assert!(small_deviations(&fast).is_err());
    // Orbits of a period have no drift, so that they have all of the energy.
    let upright = OrbitProblem::of(&scene(&proportional, &[TOTAL])).unwrap().upright();
    assert!((upright.y_dot + (2.0 * 9.81 * (0.2 - 0.4 / 3.0_f64)).sqrt()).abs() < 1e-12, "{upright:?}");
}

/// A release near the fixed point with a drift of up to 0.7 V, the angle on either side of the boundary.
#[test]
fn with_a_drift_runs_do_what_the_linear_verdict_says() {
    let mut random = Random::new(5);
    let (mut bounded, mut left) = (0, 0);
    while bounded < 60 || left < 20 {
        let kind = if random.between(0.0, 1.0) < 0.5 { Kind::Total } else { Kind::OneStrike };
        let mut draft = scenes::scene(&mut random, kind).draft();
        let mut set = |name, number| draft.set(name, Some(Value::Number(number))).unwrap();
        for name in [Name::Theta, Name::ThetaDot, Name::XDot] {
            set(name, 0.0);
        }
        let Ok(in_place) = small_deviations(&draft.build().unwrap()).map(|small| small.fixed_point) else { continue };
        let mut set = |name, number| draft.set(name, Some(Value::Number(number))).unwrap();
        set(Name::Theta, 1e-6);
        set(Name::ThetaDot, 1e-6);
        set(Name::XDot, random.between(-0.7, 0.7) * in_place.speed);
        let Ok(small) = draft.build().map_err(drop).and_then(|it| small_deviations(&it).map_err(drop)) else {
            continue;
        };
        let critical = small.linear.critical_tilt_gain;
        let share = if random.between(0.0, 1.0) < 0.7 { random.between(0.05, 0.95) } else { random.between(1.1, 1.5) };
        draft.set(Name::TiltGain, Some(Value::Number(1.0 + share * (critical - 1.0)))).unwrap();
        let scene = draft.build().unwrap();
        let fixed_point = small_deviations(&scene).unwrap().fixed_point;
        let linear = small_deviations(&scene).unwrap().linear;
        assert!((linear.residue.unwrap() - share).abs() < 1e-4, "{share}: the drift hardly depends on κ");
        if linear.energy_eigenvalue.abs() > 0.98 {
            continue;
        }
        let mut most = 0.0_f64;
        let mut orbit = scene.orbit().unwrap();
        run(&mut orbit, 1500, |contact| {
            most = most.max(contact.state.theta.abs());
            true
        });
        assert_eq!(linear.says_bounded(), most < 1e-3, "{share} {most}");
        if linear.says_bounded() {
            let State { x_dot, y_dot, .. } = *orbit.state();
            let off = (y_dot + fixed_point.speed).abs() + (x_dot - fixed_point.x_dot).abs();
            assert!(off < 1e-3 * fixed_point.speed, "{off:e}, {:?} {fixed_point:?}", orbit.state());
            bounded += 1;
        } else {
            left += 1;
        }
    }
}

#[test]
fn a_program_of_one_height_is_a_target_height() {
    for (one, other) in [(juggling(&[0.3], 0.1), None), (juggling(&[0.3, 0.3, 0.3], 0.1), None::<f64>)] {
        let target = scene(
            &[(Name::TiltGain, 1.1), (Name::Height, 0.25), (Name::Theta, 0.1), (Name::TargetHeight, 0.3)],
            &[ONE_STRIKE],
        );
        let (mut orbit, mut same) = (one.orbit().unwrap(), target.orbit().unwrap());
        for _ in 0..100 {
            assert_eq!(orbit.advance(), same.advance());
        }
        assert_eq!((one.model(), other), (target.model(), None));
    }
}

#[test]
fn juggling_is_a_periodic_orbit_of_a_whole_cycle() {
    let heights = [0.2, 0.3, 0.24];
    let scene = juggling(&heights, 0.0);
    let problem = OrbitProblem::of(&scene).unwrap();
    let orbit = find(&problem, 3, &problem.upright()).unwrap();
    assert_eq!(orbit.least_period, 3);
    let weight = 0.4 / 3.0;
    for (n, state) in orbit.states.iter().enumerate() {
        let before = heights[(n + 2) % 3];
        let speed = (2.0 * scene.gravity() * (before - weight)).sqrt();
        assert!((state.y_dot + speed).abs() <= 1e-12 && state.theta == 0.0, "{n}: {state:?} {speed}");
    }
    let product = jacobian(&scene.model(), &orbit.states[0], 3).unwrap().matrix;
    assert!(product[(2, 2)].abs() <= 1e-12, "one strike forgets the energy: {product}");
    assert_eq!(orbit.multipliers.stable, Some(true), "{:?}", orbit.multipliers);
    let rotated = jacobian(&scene.model().from_contact(2), &orbit.states[1], 3).unwrap();
    assert!((rotated.end.y_dot - orbit.states[1].y_dot).abs() <= 1e-12, "it comes back from contact 2 too");
}

/// A table that brings the energy to its target moves at 1 + ε times its law, whatever it believes, and does not know of friction.
#[test]
fn one_strike_with_an_error_of_the_speed_and_with_friction_moves_by_its_law() {
    let mut random = Random::new(2803);
    let mut compared = 0;
    while compared < 500 {
        let features = ["one strike", "program", "speed error", "friction", "wrong belief", "feedback", "incline"];
        let mix = Mix::draw(&mut random, Swing::Wide, &features);
        if !mix.has(&["one strike", "program"]) || !mix.has(&["speed error", "friction"]) {
            continue;
        }
        let mut draft = mix.scene.draft();
        for name in [Name::SpeedError, Name::Friction] {
            draft.set(name, Some(Value::Number(0.0))).unwrap();
        }
        let ideal = draft.build().unwrap().model();
        let error = mix.scene.number(Name::SpeedError).unwrap_or(0.0);
        let Ok(mut orbit) = mix.scene.orbit() else { continue };
        for _ in 0..5 {
            let (coming, strike) = orbit.foresee();
            let law = ideal.strike(&coming).table_speed();
            assert!((strike.table_speed() - (1.0 + error) * law).abs() < 1e-13 * (1.0 + law.abs()), "{:?}", mix.scene);
            compared += 1;
            if orbit.advance().flight_time.is_none() {
                break;
            }
        }
    }
}

// The drift that a state feedback of θ and θ̇ alone leaves to the body: fixed point, linear verdict and verdict against long runs; and the
// growth of a swing beside a drift.

/// A scene with other numbers and words; a feedback takes the place of the tilt gain.
fn with(scene: &Scene, numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Option<Scene> {
    let mut draft = scene.draft();
    if numbers.iter().any(|(name, _)| *name == Name::FeedbackTheta) {
        draft.set(Name::TiltGain, None).unwrap();
    }
    worded(with_numbers(draft, numbers), words).build().ok()
}

/// Case 1 with energy feedback, a drift of 0.5 m/s and a swing.
fn case_1() -> Scene {
    with_numbers(paper::scene(1.1, 0.02).draft(), &[(Name::XDot, 0.5)]).build().unwrap()
}

const TOTAL_WORD: &[(Name, &str)] = &[(Name::EnergyMeasure, "total")];
const STEERED: [(Name, f64); 2] = [(Name::EnergyGain, 0.45), (Name::TargetHeight, 0.2)];

fn judge(scene: &Scene) -> Judgement {
    judged(scene, 2000)
}

/// Mean horizontal speed and mean |ẏ| at the contacts of the second half of a run; `None` if it ends early.
fn settled(scene: &Scene, impacts: u64) -> Option<[f64; 2]> {
    let (mut x, mut t, mut y_dot, mut count) = ([0.0; 2], [0.0; 2], 0.0, 0.0);
    let ending = run(&mut scene.orbit().unwrap(), impacts, |contact| {
        if contact.n == impacts / 2 {
            (x[0], t[0]) = (contact.x, contact.t);
        }
        if contact.n >= impacts / 2 {
            (x[1], t[1], y_dot, count) = (contact.x, contact.t, y_dot - contact.state.y_dot, count + 1.0);
        }
        true
    });
    (ending == Some(Ending::Completed)).then(|| [(x[1] - x[0]) / (t[1] - t[0]), y_dot / count])
}

#[test]
fn feedback_of_the_angle_alone_is_judged_as_the_tilt_gain_that_it_is() {
    let law = [(Name::FeedbackTheta, -1.1)];
    for (numbers, words, speed) in
        [(&[][..], &[][..], 1.144), (&STEERED[..], TOTAL_WORD, 1.029), (&STEERED[..], &[], 1.144)]
    {
        let tilted = with(&case_1(), numbers, words).unwrap();
        let fed_back = with(&tilted, &law, &[]).unwrap();
        let fixed_point = small_deviations(&fed_back).unwrap().fixed_point;
        assert!((fixed_point.speed - speed).abs() < 1e-3, "{}", fixed_point.speed);
        assert_eq!(small_deviations(&tilted).map(|small| small.fixed_point), Ok(fixed_point));
        assert_eq!(
            small_deviations(&tilted).ok().and_then(|small| small.drift),
            small_deviations(&fed_back).ok().and_then(|small| small.drift)
        );
        let linear = small_deviations(&fed_back).unwrap().linear;
        assert_eq!(small_deviations(&tilted).unwrap().linear, linear);
        assert!(linear.residue.is_some() && linear.spectral_radius() == 1.0);
        assert_eq!(judge(&fed_back).verdict, judge(&tilted).verdict);
    }
    assert_eq!(judge(&with(&case_1(), &law, &[]).unwrap()).verdict, Verdict::Elliptic);
    // Feedback of ẋ takes the drift away.
    let braked =
        with(&case_1(), &[STEERED[0], STEERED[1], (Name::FeedbackTheta, -2.9), (Name::FeedbackXDot, 0.36)], TOTAL_WORD);
    let braked = braked.unwrap();
    assert_eq!(
        (
            small_deviations(&braked).unwrap().fixed_point.x_dot,
            small_deviations(&braked).ok().and_then(|small| small.drift)
        ),
        (0.0, None)
    );
}

#[test]
fn runs_settle_on_the_drift_and_the_height_said() {
    let mut random = Random::new(7);
    let mut judged = [0; 5];
    let mut worst = [0.0_f64; 2];
    while judged.iter().sum::<usize>() < 300 {
        let kind = (random.between(0.0, 5.0)) as usize;
        let base = match kind {
            0 | 4 => scenes::scene(&mut random, Kind::Regular),
            1 => scenes::scene(&mut random, Kind::Total),
            2 => scenes::scene(&mut random, Kind::OneStrike),
            _ => scenes::scene(&mut random, Kind::Feedback),
        };
        let size = random.size(1e-4, 1e-2).abs();
        let Ok(at) = small_deviations(&with(&base, &[(Name::XDot, 0.0)], &[]).unwrap()).map(|small| small.fixed_point)
        else {
            continue;
        };
        let tilt_gain = base.number(Name::TiltGain).unwrap();
        let numbers = [
            (Name::Theta, size * random.between(-1.0, 1.0)),
            (Name::ThetaDot, size / at.flight_time * random.between(-1.0, 1.0)),
            (Name::XDot, at.speed * random.between(-0.5, 0.5)),
            (Name::FeedbackTheta, -tilt_gain),
            // From damping to undamped: a strike turns by a share of up to 0.6 of θ̇.
            (
                Name::FeedbackThetaDot,
                -random.between(0.1, 0.3) * base.number(Name::RadiusOfGyration).unwrap().powi(2)
                    / (at.speed * base.number(Name::ContactDistance).unwrap()),
            ),
            (Name::Friction, if kind == 4 { 0.3 } else { 0.0 }),
        ];
        let words: &[_] = if kind == 4 { &[(Name::Slide, "matched")] } else { &[] };
        let Some(scene) = with(&base, &numbers, words) else { continue };
        let Ok(fixed_point) = small_deviations(&scene).map(|small| small.fixed_point) else { continue };
        let linear = small_deviations(&scene).unwrap().linear;
        if linear.spectral_radius() > 0.97 {
            continue;
        }
        let Some([drift, speed]) = settled(&scene, 4000) else { panic!("{scene:?}") };
        let said = small_deviations(&scene).ok().and_then(|small| small.drift).unwrap();
        let off = [(drift - said).abs() / at.speed, (speed - fixed_point.speed).abs() / at.speed];
        for (worst, off) in worst.iter_mut().zip(off) {
            *worst = worst.max(off / size);
        }
        judged[kind] += 1;
        assert_eq!(judge(&scene).verdict, Verdict::StableDrifting);
    }
    assert!(worst.iter().all(|worst| *worst < 0.2) && judged.iter().all(|count| *count > 30), "{worst:?} {judged:?}");
}

/// The growth of 1/A² over a run, by the largest |θ| of its first and last contacts, per contact; `None` if the run ends early.
fn growth(scene: &Scene, impacts: u64) -> Option<f64> {
    const WINDOW: u64 = 4000;
    let mut largest = [0.0_f64; 2];
    let ending = run(&mut scene.orbit().unwrap(), impacts, |contact| {
        if contact.n <= WINDOW {
            largest[0] = largest[0].max(contact.state.theta.abs());
        } else if contact.n > impacts - WINDOW {
            largest[1] = largest[1].max(contact.state.theta.abs());
        }
        true
    });
    let [first, last] = largest.map(|theta| 1.0 / (theta * theta));
    (ending == Some(Ending::Completed)).then_some(0.5 * (first - last) / (impacts - WINDOW) as f64)
}

/// ℓ beside a drift is that of runs with the drift: continuous, and of another sign where theirs is.
#[test]
fn the_lyapunov_coefficient_beside_a_drift_is_that_of_runs() {
    const IMPACTS: u64 = 60_000;
    let mut random = Random::new(5);
    let (mut compared, mut turned) = (0, 0);
    while compared < 25 {
        let l = random.between(0.05, 0.4);
        let rho = l * random.between(0.2, 1.2);
        let above = l * random.between(0.2, 2.0);
        let speed_squared = 2.0 * 9.81 * above;
        let residue = random.between(0.05, 0.95);
        let restitution = random.between(0.3, 1.0);
        let numbers = [
            (Name::ContactDistance, l),
            (Name::RadiusOfGyration, rho),
            (Name::Height, l + above),
            (Name::TargetHeight, l + above),
            (Name::TiltGain, 1.0 + residue * rho * rho / (2.0 * above * l)),
            (Name::Restitution, restitution),
            (Name::EnergyGain, random.between(0.1, 1.6) / ((1.0 + restitution) * speed_squared)),
            (Name::XDot, 0.0),
            (Name::Theta, 0.01),
        ];
        let Some(scene) = with(&case_1(), &numbers, &[]) else { continue };
        let Some(own) = swing(&scene) else { continue };
        let amplitude = (0.1 / (own.form.growth.abs() * IMPACTS as f64)).sqrt();
        let turns = own.form.eigenvalue.im.atan2(own.form.eigenvalue.re) / std::f64::consts::TAU;
        if (turns - 0.25).abs() < 0.03 || amplitude > 0.05 {
            continue;
        }
        let theta = (Name::Theta, 0.01 * amplitude / own.amplitude);
        let drifting = |share: f64| with(&scene, &[theta, (Name::XDot, share * speed_squared.sqrt())], &[]).unwrap();
        let Some(still) = growth(&drifting(0.0), IMPACTS) else { continue };
        for share in [1e-6, 0.02, 0.2] {
            let Some(growth) = growth(&drifting(share), IMPACTS) else { continue };
            let beside = swing(&drifting(share)).unwrap().form.growth;
            assert!((growth - beside).abs() < 0.1 * still.abs(), "{share} {growth} {beside} {still}");
            turned += u32::from(beside * own.form.growth < 0.0);
        }
        compared += 1;
    }
    assert!(turned > 0, "{turned}");
}
