//! Evidence on the stability of any scene, from its return map, and the verdict that ordered rules make of it.
//!
//! Where the upright bounce and its eigenvalues have exact closed forms, those take the place of Newton's iteration. Not here: words
//! ([`Judgement`] is data).

use crate::analysis::boundary::{BoundaryCoefficient, boundary_coefficient};
use crate::analysis::fixed_point::{FixedPoint, drift_speed, find_fixed_point};
use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict, PARABOLIC, linear_verdict};
use crate::analysis::losses::{StabilityLoss, losses};
use crate::analysis::nonlinear_run::NonlinearRun;
use crate::analysis::repeating::{self, NoRepeatingBounce, RepeatingBounce, SceneMap, energy_gradient};
use crate::analysis::return_map::{ReturnMap, Vector, X, X_DOT, Y_DOT};
use crate::analysis::swing::{NoSwingForm, SwingForm};
use crate::analysis::verdict::{DecidedBy, Verdict};
use crate::control::bounce_model::ANGLE;
use crate::map::body::Body;
use crate::map::strike::{EnergyFeedback, State};
use crate::numbers::trig;
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

/// Fewest bounces of that run.
pub const SMALL_RUN: u64 = 5_000;

/// Most bounces of that run.
pub const LONGEST_SMALL_RUN: u64 = 20_000;

/// Logarithm of the growth of a small deviation after which the run has told whether it stays bounded.
const GROWN: f64 = 14.0;

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
    /// True if it went on for all bounces asked for.
    pub survived: bool,
    /// Largest |θ|, rad.
    pub max_theta: f64,
}

/// A bounce that repeats, with the motion of small deviations from it.
#[derive(Clone, Debug)]
pub struct Balance {
    /// The bounce.
    pub fixed_point: FixedPoint,
    /// Eigenvalues with the ends of the gains, in closed form or from the derivative of the map.
    pub linear: LinearVerdict,
    /// Motion of small deviations.
    pub motion: Motion,
    /// True if a drift is neutral: nothing brings it back.
    pub drifts: bool,
    /// Normal form of the swing, if it circles; `None` also for a strike that keeps the energy of a frictionless rod, whose swings circle.
    pub swing: Option<Result<Swing, NoSwingForm>>,
    /// C at κ_c.
    pub boundary: Option<BoundaryCoefficient>,
    /// Losses of stability at the ends of the gains.
    pub losses: Vec<StabilityLoss>,
    /// Reasons for losses that are missing.
    pub notes: Vec<String>,
    /// The run from a small start, where it decides.
    pub small_run: Option<SmallRun>,
}

/// The swing of a release about a bounce that repeats.
#[derive(Clone, Debug)]
pub struct Swing {
    /// Its normal form.
    pub form: SwingForm,
    /// |w| of the release, rad.
    pub amplitude: f64,
    /// Place about which it swings, m.
    pub place: f64,
    /// Change of each kept quantity a bounce by this swing, along its neutral direction.
    pub shifts: Vec<f64>,
    /// Change of the energy a bounce by this swing, m²/s².
    pub energy: f64,
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
        let (verdict, decided_by) = match verdict {
            _ if survived => (verdict, decided_by),
            Verdict::WeaklyUnstable => (Verdict::Unstable, decided_by),
            _ => (Verdict::Unstable, if says_bounded { DecidedBy::Nonlinear } else { decided_by }),
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
    match (balance.motion, &balance.swing) {
        (Motion::Grows(_) | Motion::Silent(_), _) => beyond(balance),
        (Motion::DiesOut, _) if balance.drifts => (Verdict::StableDrifting, DecidedBy::Linear, true),
        (Motion::DiesOut, _) => (Verdict::StableInPlace, DecidedBy::Linear, true),
        (Motion::Circles(_), None) => (Verdict::Elliptic, DecidedBy::Linear, true),
        (Motion::Circles(_), Some(Ok(swing))) => {
            let verdict = match swing.form.course() {
                Course::Circles => return (Verdict::Elliptic, DecidedBy::Linear, true),
                Course::Grows | Course::Pumps | Course::Shifts => Verdict::WeaklyUnstable,
                Course::DiesOut | Course::Settles => Verdict::WeaklyAttracting,
            };
            (verdict, DecidedBy::Lyapunov, true)
        }
        // At a strong resonance the run from a small start decides.
        (Motion::Circles(_), Some(Err(_))) => match balance.small_run {
            Some(SmallRun { survived: true, .. }) => (Verdict::Elliptic, DecidedBy::Nonlinear, true),
            Some(SmallRun { survived: false, .. }) | None => (Verdict::Unstable, DecidedBy::Nonlinear, true),
        },
    }
}

/// The rules at and beyond an end of the stable range: the coefficient at κ_c, the run from a small start, and soft losses.
fn beyond(balance: &Balance) -> (Verdict, DecidedBy, bool) {
    let stays = balance.small_run.is_some_and(|run| run.survived);
    let at_end = matches!(balance.motion, Motion::Silent(value) if value < 0.0);
    match balance.boundary.filter(|_| at_end) {
        Some(BoundaryCoefficient { coefficient }) if coefficient <= 0.0 => {
            (Verdict::Unstable, DecidedBy::Boundary, false)
        }
        Some(_) if stays => (Verdict::BoundedBeyondBoundary, DecidedBy::Boundary, false),
        Some(_) => (Verdict::Unstable, DecidedBy::Nonlinear, false),
        None if !stays => (Verdict::Unstable, DecidedBy::Linear, false),
        None if balance.losses.iter().any(|loss| loss.is_soft() && loss.settles.is_some()) => {
            (Verdict::BoundedBeyondBoundary, DecidedBy::Boundary, false)
        }
        None => (Verdict::BoundedBeyondBoundary, DecidedBy::Nonlinear, false),
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

/// The evidence on a scene without noise. `None` once `go_on` returned false.
pub fn evidence(scene: &Scene, go_on: &mut impl FnMut() -> bool) -> Option<Evidence> {
    let Ok(orbit) = scene.orbit() else { return Some(Evidence::NoContact) };
    let judged = scene.with_tilt_law();
    let (mut balance, at) = match find_fixed_point(&judged) {
        Ok(place) => in_closed_form(&judged, &orbit, place),
        Err(_) => match from_map(&judged)? {
            Ok(found) => found,
            Err(nothing) => return Some(nothing),
        },
    };
    if matches!((balance.motion, &balance.swing), (Motion::Silent(_) | Motion::Grows(_), _) | (_, Some(Err(_)))) {
        balance.small_run = Some(small_run(scene, &balance, at, go_on)?);
    }
    Some(Evidence::Balances(Box::new(balance)))
}

/// A balance, and the state and place of its bounce.
type PlacedBalance = (Balance, (State, f64));

/// The balance of a scene whose upright bounce has a closed form, and the bounce as a vector.
fn in_closed_form(scene: &Scene, orbit: &Orbit, fixed_point: FixedPoint) -> PlacedBalance {
    let linear = linear_verdict(scene, &fixed_point);
    let model = scene.model();
    let motion = linear.motion();
    let drift = if fixed_point.x_dot == 0.0 { drift_speed(scene).unwrap_or(0.0) } else { fixed_point.x_dot };
    let beside = State { x_dot: drift, ..fixed_point.state() };
    let swing = match motion {
        Motion::Circles(eigenvalue) if !keeps_energy(&model) => {
            let map = ReturnMap::new(&model, 1);
            let reference = map.vector(orbit.state(), orbit.x());
            let mut at = map.vector(&beside, fixed_point.x);
            let found = if map.components().contains(&X) {
                // The place is that about which the release swings.
                at[X] = reference[X];
                repeating::find(&map, &at, &reference).map(|bounce| at[X] = bounce.at[X])
            } else {
                Ok(())
            };
            let bounce = found.and_then(|()| repeating::find(&map, &at, &at));
            Some(match bounce {
                Ok(bounce) => Swing::new(&map, &bounce, eigenvalue, &reference),
                Err(_) => Err(NoSwingForm::NoDerivative),
            })
        }
        Motion::Circles(_) | Motion::DiesOut | Motion::Silent(_) | Motion::Grows(_) => None,
    };
    let drifts = match &linear.closed_loop {
        Some(closed) => closed.eigenvalues.len() == ANGLE.len(),
        None => {
            let kept = linear.eigenvalues.iter().filter(|value| **value == Complex::new(1.0, 0.0)).count();
            !model.is_point && kept > usize::from(linear.energy_eigenvalue == 1.0)
        }
    };
    let boundary = boundary_coefficient(&model, &fixed_point);
    let (losses, notes) = losses(scene, &fixed_point, &linear, boundary);
    let boundary = boundary.or_else(|| losses.iter().find_map(StabilityLoss::boundary));
    let balance = Balance { fixed_point, linear, motion, drifts, swing, boundary, losses, notes, small_run: None };
    (balance, (beside, fixed_point.x))
}

/// Tells whether the strikes of a rod keep its energy: a swing of such a rod neither grows nor dies out.
fn keeps_energy(model: &Body) -> bool {
    let rough = model.friction.is_some_and(|friction| friction.coefficient != 0.0);
    let plain = model.turning.is_none() && model.drag.is_none() && model.feedback().is_none();
    let rod = &model.rod;
    plain
        && !rough
        && rod.strike_gain == 2.0
        && rod.strike_gain_per_energy == 0.0
        && rod.energy_feedback != EnergyFeedback::OneStrike
}

/// The balance of any scene from its return map, and the bounce as a vector; or the evidence that no bounce repeats. `None` if eigenvalues do
/// not converge.
fn from_map(scene: &Scene) -> Option<Result<PlacedBalance, Evidence>> {
    let Ok(SceneMap { map, reference, guess }) = SceneMap::of(scene) else { return Some(Err(Evidence::NoContact)) };
    let (map, bounce) = match repeating::find_planned(&map, &guess, &reference) {
        Ok(found) => found,
        Err(why) => return Some(Err(Evidence::NothingRepeats { why, speed: -guess[Y_DOT] })),
    };
    let mut eigenvalues = bounce.eigenvalues_beside()?;
    let motion = motion(&eigenvalues);
    let swing = match motion {
        Motion::Circles(eigenvalue) => Some(Swing::new(&map, &bounce, eigenvalue, &reference)),
        Motion::DiesOut | Motion::Silent(_) | Motion::Grows(_) => None,
    };
    let place = map.components().iter().position(|&index| index == X_DOT);
    let drifts = bounce
        .neutral
        .iter()
        .any(|neutral| place.is_some_and(|place| neutral.right[place].abs() > 1e-3 * neutral.right.amax()));
    eigenvalues.extend(bounce.neutral.iter().map(|_| Complex::new(1.0, 0.0)));
    sort_eigenvalues(&mut eigenvalues);
    let at = &bounce.at;
    let rise = at[Y_DOT] * at[Y_DOT] / (2.0 * scene.gravity());
    let fixed_point = FixedPoint {
        x: if map.components().contains(&X) { at[X] } else { 0.0 },
        x_dot: at[X_DOT],
        speed: -at[Y_DOT],
        flight_time: map.flight_time(at) / map.period() as f64,
        apex_height: map.body().contact_height(&map.state(at)) + rise,
    };
    let fall = map.components().iter().position(|&index| index == Y_DOT).unwrap_or_default();
    let linear = LinearVerdict::of_map(motion, eigenvalues, bounce.matrix[(fall, fall)]);
    let (boundary, losses, notes, small_run) = (None, Vec::new(), Vec::new(), None);
    let balance = Balance { fixed_point, linear, motion, drifts, swing, boundary, losses, notes, small_run };
    Some(Ok((balance, (map.state(at), at[X]))))
}

impl Balance {
    /// Bounces until a swing that gives energy to the bounce has brought it to the height at which R = 1, at the present rate; `None` if it does
    /// not.
    pub fn bounces_until_critical(&self) -> Option<u64> {
        let energy = self.swing.as_ref()?.as_ref().ok()?.energy;
        let speed = self.fixed_point.speed;
        // The speed grows by energy/V² of itself a bounce, and R with its square.
        let bounces = -0.5 * libm::log(self.linear.residue?) * speed * speed / energy;
        // A cast keeps to the range of the type.
        (energy > 0.0 && bounces.is_finite()).then_some(bounces as u64)
    }
}

impl Swing {
    /// The swing of a release, by its state at the first contact, about a bounce that repeats.
    fn new(
        map: &ReturnMap,
        bounce: &RepeatingBounce,
        eigenvalue: Complex<f64>,
        release: &Vector,
    ) -> Result<Self, NoSwingForm> {
        let form = SwingForm::new(map, bounce, eigenvalue)?;
        let amplitude = form.amplitude(map, bounce, release);
        let shifts: Vec<f64> = form.shifts.iter().map(|shift| shift * amplitude * amplitude).collect();
        let gradient = energy_gradient(map, &bounce.at);
        let along = bounce.neutral.iter().map(|neutral| gradient.dot(&neutral.right));
        let energy = along.zip(&shifts).map(|(energy, shift)| energy * shift).sum();
        Ok(Self { form, amplitude, place: bounce.at[X], shifts, energy })
    }
}

impl LinearVerdict {
    /// The verdict on a bounce by its eigenvalues alone, those of neutral directions as exactly 1; `height` is the response of ẏ to itself.
    fn of_map(motion: Motion, eigenvalues: Vec<Complex<f64>>, height: f64) -> Self {
        let (class, rotation) = match motion {
            Motion::DiesOut => (AngleClass::Attracting, None),
            Motion::Circles(value) => (AngleClass::Elliptic, Some(trig::acos(value.re.clamp(-1.0, 1.0)))),
            Motion::Silent(_) => (AngleClass::Parabolic, None),
            Motion::Grows(_) => (AngleClass::Hyperbolic, None),
        };
        Self {
            class,
            residue: None,
            rotation,
            eigenvalues,
            lower_tilt_gain: f64::INFINITY,
            critical_tilt_gain: f64::NEG_INFINITY,
            upper_energy_gain: f64::INFINITY,
            energy_eigenvalue: height,
            closed_loop: None,
        }
    }

    /// Motion of small deviations by a verdict in closed form.
    fn motion(&self) -> Motion {
        let height = self.energy_eigenvalue;
        if height.abs() > 1.0 + PARABOLIC {
            return Motion::Grows(height.abs());
        }
        if height < PARABOLIC - 1.0 {
            return Motion::Silent(-1.0);
        }
        let circling = self.eigenvalues.iter().find(|value| value.im > 0.0);
        match (self.class, circling) {
            (AngleClass::Attracting, _) => Motion::DiesOut,
            (AngleClass::Elliptic, Some(value)) => Motion::Circles(*value),
            (AngleClass::Parabolic, _) if self.residue.is_some_and(|residue| residue < 0.5) => Motion::Silent(1.0),
            (AngleClass::Elliptic | AngleClass::Parabolic, _) => Motion::Silent(-1.0),
            (AngleClass::Hyperbolic, _) => {
                let values = self.closed_loop.as_ref().map_or(&self.eigenvalues, |closed| &closed.eigenvalues);
                let largest = values.iter().copied().map(modulus).fold(0.0, f64::max);
                if largest > 1.0 + ON_CIRCLE { Motion::Grows(largest) } else { Motion::Silent(1.0) }
            }
        }
    }
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

/// The run from a small swing beside a bounce that repeats, long enough for a deviation that grows to show. `None` once `go_on` returned
/// false.
fn small_run(
    scene: &Scene,
    balance: &Balance,
    (mut start, x): (State, f64),
    go_on: &mut impl FnMut() -> bool,
) -> Option<SmallRun> {
    start.theta += SMALL_SWING;
    start.theta_dot += 0.5 * SMALL_SWING / balance.fixed_point.flight_time;
    let asked = match balance.motion {
        Motion::Grows(modulus) => {
            // A cast keeps to the range of the type.
            ((GROWN / libm::log(modulus)) as u64).clamp(SMALL_RUN, LONGEST_SMALL_RUN)
        }
        Motion::DiesOut | Motion::Circles(_) | Motion::Silent(_) => SMALL_RUN,
    };
    let mut orbit = Orbit::at(scene.running_model(), scene.rules(), start).moved(x);
    let mut max_theta: f64 = 0.0;
    let ending = run(&mut orbit, asked, |contact| {
        max_theta = max_theta.max(contact.state.theta.abs());
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    Some(SmallRun { impacts: orbit.contacts(), survived: ending == Ending::Completed, max_theta })
}
