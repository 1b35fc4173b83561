//! Evidence on the stability of any scene, from its return map alone, and the verdict that ordered rules make of it.
//!
//! Not here: words ([`Judgement`] is data), and scenes whose closed forms are exact ([`crate::analysis`]).

use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::analysis::nonlinear_run::NonlinearRun;
use crate::analysis::repeating::{self, NoRepeatingBounce, RepeatingBounce, SceneMap};
use crate::analysis::return_map::{ReturnMap, Vector, X, X_DOT, Y_DOT};
use crate::analysis::swing::{NoSwingForm, SwingForm};
use crate::analysis::verdict::{DecidedBy, Verdict};
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::{Ending, EndingKind};
use crate::run::orbit::{Orbit, run};
use crate::scene::Scene;
use crate::surveys::ensemble::{Ensemble, wilson_interval};
use nalgebra::Complex;

/// Distance of a modulus from 1 up to which an eigenvalue is on the unit circle.
pub const ON_CIRCLE: f64 = 1e-9;

/// The same of a double eigenvalue 1, which rounding moves by its square root.
const ON_CIRCLE_TWICE: f64 = 1e-7;

/// Swing of the run that decides where the first orders of the map are silent, rad.
pub const SMALL_SWING: f64 = 1e-3;

/// Bounces of that run.
pub const SMALL_RUN: u64 = 5_000;

/// Runs of the ensemble of a scene with noise.
pub const NOISY_RUNS: u64 = 200;

/// Most bounces of each of them.
pub const NOISY_IMPACTS: u64 = 400;

/// Motion of small deviations beside the neutral directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// They die out.
    DiesOut,
    /// They circle: the eigenvalue λ above the real axis is on the unit circle.
    Circles(Complex<f64>),
    /// A real eigenvalue is on the unit circle, and no quantity is kept there.
    Silent(f64),
    /// An eigenvalue of this modulus is outside the unit circle.
    Grows(f64),
}

/// End of the run that decides where the first orders of the map are silent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallRun {
    /// Bounces that it went on for.
    pub impacts: u64,
    /// True if it went on for [`SMALL_RUN`] bounces.
    pub survived: bool,
    /// Largest |θ|, rad.
    pub max_theta: f64,
}

/// A bounce that repeats, with the motion of small deviations from it.
#[derive(Clone, Debug)]
pub struct Balance {
    /// The bounce.
    pub bounce: RepeatingBounce,
    /// Its map.
    pub map: ReturnMap,
    /// Length of the flights of its period, s.
    pub flight_time: f64,
    /// Eigenvalues, those of neutral directions as exactly 1, largest modulus first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Motion of small deviations.
    pub motion: Motion,
    /// True if a drift is neutral: nothing brings it back.
    pub drifts: bool,
    /// Normal form of the swing, if it circles.
    pub swing: Option<Result<SwingForm, NoSwingForm>>,
    /// |w| of the release, rad; 0 without a swing.
    pub amplitude: f64,
    /// The run from a small start, where it decides.
    pub small_run: Option<SmallRun>,
}

/// Evidence on a scene.
#[derive(Clone, Debug)]
pub enum Evidence {
    /// With noise: the share of an ensemble that survives.
    Ensemble {
        /// Runs that survived.
        survived: u64,
        /// All runs.
        runs: u64,
        /// Bounces of each.
        impacts: u64,
        /// Interval of the probability to survive, 95 %.
        interval: (f64, f64),
    },
    /// The release comes to no contact.
    NoContact,
    /// No bounce repeats.
    NothingRepeats {
        /// Reason.
        why: NoRepeatingBounce,
        /// Speed of the upright bounce at first, m/s.
        speed: f64,
    },
    /// A bounce repeats.
    Balances(Box<Balance>),
}

/// The verdict on a scene with its evidence.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// The verdict.
    pub verdict: Verdict,
    /// Evidence that decided.
    pub decided_by: DecidedBy,
    /// True if small deviations stay small to first order.
    pub says_bounded: bool,
    /// The evidence.
    pub evidence: Evidence,
    /// Bounces that it took.
    pub bounces: u64,
}

/// Judges a scene with its own run. `None` once `go_on` returned false.
pub fn judge(scene: &Scene, run: &NonlinearRun, mut go_on: impl FnMut() -> bool) -> Option<Judgement> {
    let survived = run.ending == Ending::Completed;
    let judgement = |verdict, decided_by, says_bounded, evidence, bounces| {
        // A run that ended is no balance, whatever small deviations do.
        let (verdict, decided_by) = if survived {
            (verdict, decided_by)
        } else {
            (Verdict::Unstable, if says_bounded { DecidedBy::Nonlinear } else { decided_by })
        };
        Some(Judgement { verdict, decided_by, says_bounded, evidence, bounces })
    };
    if scene.noise.is_some() {
        let ensemble = Ensemble { scene: *scene, runs: NOISY_RUNS, impacts: NOISY_IMPACTS, angle_contacts: 0 };
        let found = ensemble.runs(0..NOISY_RUNS, &mut go_on)?;
        let count = found.ends.iter().filter(|end| end.outcome == EndingKind::Completed).count() as u64;
        let bounces = found.ends.iter().map(|end| end.impacts).sum();
        let interval = wilson_interval(count, NOISY_RUNS);
        let evidence = Evidence::Ensemble { survived: count, runs: NOISY_RUNS, impacts: NOISY_IMPACTS, interval };
        return judgement(Verdict::Random, DecidedBy::Ensemble, interval.1 > 0.5, evidence, bounces);
    }
    let evidence = evidence(scene, &mut go_on)?;
    let bounces = match &evidence {
        Evidence::Balances(balance) => balance.small_run.map_or(0, |run| run.impacts),
        Evidence::Ensemble { .. } | Evidence::NoContact | Evidence::NothingRepeats { .. } => 0,
    };
    let (verdict, decided_by, says_bounded) = match &evidence {
        Evidence::Ensemble { .. } | Evidence::NoContact => (Verdict::Unstable, DecidedBy::Nonlinear, false),
        Evidence::NothingRepeats { .. } => (Verdict::Unstable, DecidedBy::FixedPoint, false),
        Evidence::Balances(balance) => decide(balance),
    };
    judgement(verdict, decided_by, says_bounded, evidence, bounces)
}

/// The rules for a bounce that repeats, in their order.
fn decide(balance: &Balance) -> (Verdict, DecidedBy, bool) {
    let by_run = |says_bounded| match balance.small_run {
        Some(SmallRun { survived: true, .. }) => (Verdict::BoundedBeyondBoundary, DecidedBy::Nonlinear, says_bounded),
        Some(SmallRun { survived: false, .. }) | None => (Verdict::Unstable, DecidedBy::Linear, says_bounded),
    };
    match (balance.motion, &balance.swing) {
        (Motion::Grows(_) | Motion::Silent(_), _) => by_run(false),
        (Motion::DiesOut, _) if balance.drifts => (Verdict::StableDrifting, DecidedBy::Linear, true),
        (Motion::DiesOut, _) => (Verdict::StableInPlace, DecidedBy::Linear, true),
        (Motion::Circles(_), Some(Ok(form))) => {
            let verdict = match form.course() {
                Course::Circles => return (Verdict::Elliptic, DecidedBy::Linear, true),
                Course::Grows | Course::Pumps | Course::Shifts => Verdict::WeaklyUnstable,
                Course::DiesOut | Course::Settles => Verdict::WeaklyAttracting,
            };
            (verdict, DecidedBy::Lyapunov, true)
        }
        // At a strong resonance the run from a small start decides.
        (Motion::Circles(_), Some(Err(_)) | None) => match balance.small_run {
            Some(SmallRun { survived: true, .. }) => (Verdict::Elliptic, DecidedBy::Nonlinear, true),
            Some(SmallRun { survived: false, .. }) | None => (Verdict::Unstable, DecidedBy::Nonlinear, true),
        },
    }
}

/// Course of a swing by its normal form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// It neither grows nor dies out to third order.
    Circles,
    /// It grows in third order.
    Grows,
    /// It dies out in third order.
    DiesOut,
    /// It pumps a kept quantity, which makes it grow.
    Pumps,
    /// It dies out while a kept quantity moves to a new value.
    Settles,
    /// It moves a kept quantity, bounce after bounce, which does not act back.
    Shifts,
}

impl SwingForm {
    /// The course of the swing.
    pub fn course(&self) -> Course {
        let size: f64 = self.shifts.iter().zip(&self.growths).map(|(a, b)| (a * b).abs()).sum();
        let pumped = self.pumped();
        if self.shifts.iter().all(|shift| *shift == 0.0) {
            match self.growth {
                growth if growth > 0.0 => Course::Grows,
                growth if growth < 0.0 => Course::DiesOut,
                _ => Course::Circles,
            }
        } else if size <= crate::analysis::swing::ROUNDING * modulus(self.cubic) {
            Course::Shifts
        } else if pumped > 0.0 {
            Course::Pumps
        } else {
            Course::Settles
        }
    }
}

/// The evidence on a scene without noise.
fn evidence(scene: &Scene, go_on: &mut impl FnMut() -> bool) -> Option<Evidence> {
    let Ok(SceneMap { map, reference, guess }) = SceneMap::of(scene) else { return Some(Evidence::NoContact) };
    let (map, bounce) = match repeating::find_planned(&map, &guess, &reference) {
        Ok(found) => found,
        Err(why) => return Some(Evidence::NothingRepeats { why, speed: -guess[Y_DOT] }),
    };
    let eigenvalues_beside = bounce.eigenvalues_beside()?;
    let motion = motion(&eigenvalues_beside);
    let swing = match motion {
        Motion::Circles(eigenvalue) => Some(SwingForm::new(&map, &bounce, eigenvalue)),
        Motion::DiesOut | Motion::Silent(_) | Motion::Grows(_) => None,
    };
    let amplitude = match &swing {
        Some(Ok(form)) => form.amplitude(&map, &bounce, &reference),
        Some(Err(_)) | None => 0.0,
    };
    let decides = matches!((motion, &swing), (Motion::Silent(_) | Motion::Grows(_), _) | (_, Some(Err(_))));
    let small_run = if decides { Some(small_run(scene, &map, &bounce.at, go_on)?) } else { None };
    let place = map.components().iter().position(|&index| index == X_DOT);
    let drifts = bounce
        .neutral
        .iter()
        .any(|neutral| place.is_some_and(|place| neutral.right[place].abs() > 1e-3 * neutral.right.amax()));
    let mut all = eigenvalues_beside;
    all.extend(bounce.neutral.iter().map(|_| Complex::new(1.0, 0.0)));
    sort_eigenvalues(&mut all);
    Some(Evidence::Balances(Box::new(Balance {
        flight_time: map.flight_time(&bounce.at),
        bounce,
        map,
        eigenvalues: all,
        motion,
        drifts,
        swing,
        amplitude,
        small_run,
    })))
}

/// Motion of small deviations, by their eigenvalues.
fn motion(values: &[Complex<f64>]) -> Motion {
    let largest = values.first().copied().map_or(0.0, modulus);
    let near = |value: &Complex<f64>, place: f64| modulus(*value - Complex::new(place, 0.0)) <= ON_CIRCLE_TWICE;
    if let Some(place) = [1.0, -1.0].into_iter().find(|&place| values.iter().any(|value| near(value, place)))
        && largest <= 1.0 + ON_CIRCLE_TWICE
    {
        return Motion::Silent(place);
    }
    if largest > 1.0 + ON_CIRCLE {
        Motion::Grows(largest)
    } else if let Some(circling) = values.iter().find(|value| value.im > 0.0 && modulus(**value) >= 1.0 - ON_CIRCLE) {
        Motion::Circles(*circling)
    } else {
        Motion::DiesOut
    }
}

/// The run from a small swing beside a bounce that repeats. `None` once `go_on` returned false.
fn small_run(scene: &Scene, map: &ReturnMap, at: &Vector, go_on: &mut impl FnMut() -> bool) -> Option<SmallRun> {
    let mut start = map.state(at);
    start.theta += SMALL_SWING;
    let mut orbit = Orbit::at(scene.running_model(), scene.rules(), start).moved(at[X]);
    let mut max_theta: f64 = 0.0;
    let ending = run(&mut orbit, SMALL_RUN, |contact| {
        max_theta = max_theta.max(contact.state.theta.abs());
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    Some(SmallRun { impacts: orbit.contacts(), survived: ending == Ending::Completed, max_theta })
}
