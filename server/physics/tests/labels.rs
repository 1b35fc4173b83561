//! Verdicts on random scenes against labels that runs alone give them: from a swing of 10⁻⁴ and of 10⁻² rad, 20,000 bounces each.

use crate::support::evidence::judged;
use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random::Random;
use crate::support::rig_runs::with_numbers;
use equipoise_physics::analysis::evidence::Judgement;
use equipoise_physics::analysis::verdict::{DecidedBy, Verdict};
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

/// Bounces of a run that labels.
const BOUNCES: u64 = 20_000;

/// Bounces over which a swing is measured.
const WINDOW: u64 = 1_000;

/// Bounces of the run that a verdict rests on.
const JUDGED: u64 = 500;

/// Swing below which rounding may feed it, rad.
const ROUNDED: f64 = 1e-9;

/// Course of a run from a small swing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    /// It ended at this contact.
    Ended(u64),
    /// It went on, and its swing came from the first size to the second, rad.
    Swings(f64, f64),
}

fn course(scene: &Scene) -> Course {
    let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
    let mut orbit = scene.orbit().unwrap();
    let ending = run(&mut orbit, BOUNCES, |contact| {
        let side = match contact.n {
            n if n <= WINDOW => 0,
            n if n > BOUNCES - WINDOW => 1,
            _ => return true,
        };
        sums[side] += contact.state.theta;
        squares[side] += contact.state.theta * contact.state.theta;
        true
    });
    if ending != Some(Ending::Completed) {
        return Course::Ended(orbit.contacts());
    }
    let [first, last] = [0, 1].map(|side| {
        let mean = sums[side] / WINDOW as f64;
        (2.0 * (squares[side] / WINDOW as f64 - mean * mean).max(0.0)).sqrt()
    });
    Course::Swings(first, last)
}

/// The scene released with this swing and no spin.
fn swinging(scene: &Scene, theta: f64) -> Option<Scene> {
    let mut draft = scene.draft();
    draft.set(Name::Theta, Some(Value::Number(theta))).ok()?;
    draft.set(Name::ThetaDot, Some(Value::Number(0.0))).ok()?;
    draft.build().ok()
}

/// Tells what is false in a verdict; `None` if nothing is.
fn falsehood(judgement: &Judgement, own: Course) -> Option<&'static str> {
    let verdict = judgement.verdict;
    match own {
        Course::Ended(contact) if contact > JUDGED => match verdict {
            Verdict::StableInPlace | Verdict::StableDrifting | Verdict::WeaklyAttracting | Verdict::Elliptic => {
                Some("it holds, and its run ends later")
            }
            Verdict::BoundedBeyondBoundary => Some("it is bounded, and its run ends later"),
            Verdict::WeaklyUnstable | Verdict::Random | Verdict::Unstable => None,
        },
        Course::Ended(_) => (verdict != Verdict::Unstable).then_some("its run ended, and it is not unstable"),
        Course::Swings(first, last) => {
            let (grows, shrinks) = (last > 2.0 * first + ROUNDED, last < 0.5 * first - ROUNDED);
            let stays = last < 1.05 * first + ROUNDED;
            match verdict {
                Verdict::StableInPlace | Verdict::StableDrifting if grows => Some("small deviations grow"),
                // Wide swings beat, and some are chaotic.
                Verdict::Elliptic if first < 0.02 && (grows || shrinks) => {
                    Some("the swing of an elliptic bounce changes")
                }
                Verdict::WeaklyAttracting if grows => Some("a swing that is to die out grows"),
                Verdict::WeaklyUnstable if shrinks => Some("a swing that is to grow dies out"),
                // Where no bounce repeats, the height goes.
                Verdict::Unstable if stays && judgement.decided_by != DecidedBy::FixedPoint => {
                    Some("small deviations stay small for 20,000 bounces")
                }
                _ => None,
            }
        }
    }
}

/// `CASES` and `SEED` of the environment give other scenes.
#[test]
fn verdicts_agree_with_runs() {
    let number = |name, or| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(or);
    let (cases, seed) = (number("CASES", 120), number("SEED", 2811));
    let mut random = Random::new(seed);
    let (mut labelled, mut wrong) = (0, Vec::new());
    for _ in 0..cases {
        let mix = Mix::draw(&mut random, Swing::Calm, &all_but(&RANDOM));
        for theta in [1e-4, 1e-2] {
            let Some(scene) = swinging(&mix.scene, theta).filter(|scene| scene.orbit().is_ok()) else { continue };
            let judgement = judged(&scene, JUDGED);
            labelled += 1;
            let own = course(&scene);
            if let Some(what) = falsehood(&judgement, own) {
                let (verdict, by) = (judgement.verdict, judgement.decided_by);
                wrong.push(format!(
                    "{what}: {verdict:?} by {by:?} at θ = {theta}, {own:?}, {:?}\n  {judgement:?}\n  {:?}",
                    mix.features, scene
                ));
            }
        }
    }
    for line in &wrong {
        eprintln!("{line}");
    }
    assert!(wrong.is_empty(), "{} of {labelled} verdicts are false", wrong.len());
}

/// The air lets the height sink to 1 mm of bounce; there a swing of 10⁻⁴ rad in a wind changes the speed of the bounce by more than it is.
#[test]
fn a_swing_as_fast_as_the_bounce_that_the_height_sinks_to_is_judged_by_its_run() {
    let scene = with_numbers(
        Draft::default(),
        &[
            (Name::ContactDistance, 0.139_643_294_504_357_64),
            (Name::RadiusOfGyration, 0.134_117_561_851_588_7),
            (Name::Restitution, 0.893_586_188_208_686),
            (Name::TiltGain, 1.203_876_482_775_146_7),
            (Name::TiltGainError, 0.015_620_354_716_695_106),
            (Name::SpeedError, 0.001_291_410_212_477_611),
            (Name::Drag, 0.434_790_208_460_496_76),
            (Name::Wind, 0.089_835_321_491_842_16),
            (Name::Height, 0.267_286_806_991_976_93),
            (Name::Theta, 1e-4),
            (Name::X, 0.001_723_983_988_785_118_3),
            (Name::XDot, -0.018_331_887_161_309_79),
        ],
    );
    let scene = scene.build().unwrap();
    let judgement = judged(&scene, JUDGED);
    assert!(matches!(course(&scene), Course::Ended(contact) if contact > JUDGED));
    assert_eq!((judgement.verdict, judgement.decided_by), (Verdict::Unstable, DecidedBy::Nonlinear), "{judgement:?}");
}
