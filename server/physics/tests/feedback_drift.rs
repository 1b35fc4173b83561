//! The drift that a state feedback of θ and θ̇ alone leaves to the body: fixed point, linear verdict and verdict against long runs; and the
//! growth of a swing beside a drift.

use crate::paper;
use crate::support::evidence::{judged, swing};
use crate::support::random;
use crate::support::rig_runs::{with_numbers, worded};
use crate::support::scenes;
use equipoise_physics::analysis::evidence::Judgement;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene};
use random::Random;
use scenes::Kind;

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

const TOTAL: &[(Name, &str)] = &[(Name::EnergyMeasure, "total")];
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
    for (numbers, words, speed) in [(&[][..], &[][..], 1.144), (&STEERED[..], TOTAL, 1.029), (&STEERED[..], &[], 1.144)]
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
        with(&case_1(), &[STEERED[0], STEERED[1], (Name::FeedbackTheta, -2.9), (Name::FeedbackXDot, 0.36)], TOTAL);
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
