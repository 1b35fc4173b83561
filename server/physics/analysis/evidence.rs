//! Evidence on the stability of any scene, from its return map, and the verdict that ordered rules make of it.
//!
//! Exact closed forms of the upright bounce and its eigenvalues take the place of Newton's iteration, if there are any. Not here: words
//! ([`Judgement`] is data).

use crate::analysis::boundary::{BoundaryCoefficient, boundary_coefficient};
use crate::analysis::fixed_point::{FixedPoint, drift_speed, find_fixed_point};
use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict, PARABOLIC, linear_verdict};
use crate::analysis::losses::{StabilityLoss, losses};
use crate::analysis::nonlinear_run::NonlinearRun;
use crate::analysis::repeating::{
    self, Neutral, NoRepeatingBounce, ON_CIRCLE, RepeatingBounce, SceneMap, energy_gradient,
};
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

/// The same of a double eigenvalue 1, which rounding moves by its square root.
const ON_CIRCLE_TWICE: f64 = 1e-7;

/// Swing of the run that decides where the first orders of the map are silent, for a release without one, rad.
pub const SMALL_SWING: f64 = 1e-3;

/// Swing of a release, rad, up to which it counts as one at the bounce itself.
const LEAST_SWING: f64 = 1e-7;

/// Bounces of that run. Chaotic swings that stay bounded for a while have left by then.
pub const SMALL_RUN: u64 = 20_000;

/// Bounces over which a drift moves the place, where that matters to a swing.
const MOVED: f64 = 5_000.0;

/// Bounces up to which a drift that takes the body off its table counts.
const LEAVES: f64 = 1e6;

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
    /// True if it is that of the release, and not of [`SMALL_SWING`].
    pub is_own: bool,
    /// Bounces that it went on for.
    pub impacts: u64,
    /// True if it went on for all bounces asked for.
    pub survived: bool,
    /// Largest |θ|, rad.
    pub max_theta: f64,
    /// The same over its second half, rad.
    pub late_theta: f64,
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
    /// Speed of the drift, where it is neutral and that of the release is known, m/s; 0 elsewhere.
    pub drift: f64,
    /// Bounces after which the drift takes the body off its table, if it does within a million.
    pub leaves: Option<u64>,
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
    /// Reason for which the bounce has no closed form, if it has none.
    pub underived: Option<String>,
}

/// The swing of a release about a bounce that repeats.
#[derive(Clone, Debug)]
pub struct Swing {
    /// Normal form of the swing.
    pub form: SwingForm,
    /// |w| of the release, rad.
    pub amplitude: f64,
    /// Place about which it swings, m.
    pub place: f64,
    /// Change of each kept quantity a bounce by this swing, along its neutral direction.
    pub shifts: Vec<f64>,
    /// Change of the energy a bounce by this swing, m²/s².
    pub energy: f64,
    /// Course of the swing where a drift has taken it, if strikes depend on the place.
    pub farther: Option<Course>,
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
        /// Reason for which there is no closed form either.
        underived: String,
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

/// Judges a scene with its own run, and with `most` bounces of one where the first orders of the map are silent. `None` once `go_on` returned false.
pub fn judge(scene: &Scene, run: &NonlinearRun, most: u64, mut go_on: impl FnMut() -> bool) -> Option<Judgement> {
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
    let evidence = evidence(scene, most, &mut go_on)?;
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
    match balance.motion {
        Motion::DiesOut | Motion::Circles(_) if balance.leaves.is_some() => {
            (Verdict::Unstable, DecidedBy::FixedPoint, false)
        }
        _ => between_ends(balance),
    }
}

/// The rules but for the ends of the table.
fn between_ends(balance: &Balance) -> (Verdict, DecidedBy, bool) {
    match (balance.motion, &balance.swing) {
        (Motion::Grows(_) | Motion::Silent(_), _) => beyond(balance),
        (Motion::DiesOut, _) if balance.left() => (Verdict::Unstable, DecidedBy::Nonlinear, true),
        (Motion::DiesOut, _) if balance.drifts => (Verdict::StableDrifting, DecidedBy::Linear, true),
        (Motion::DiesOut, _) => (Verdict::StableInPlace, DecidedBy::Linear, true),
        (Motion::Circles(_), None) => (Verdict::Elliptic, DecidedBy::Linear, true),
        // A drift makes the strikes depend on the time: the run tells.
        (Motion::Circles(_), Some(Ok(Swing { farther: Some(_), .. }))) if balance.left() => {
            (Verdict::WeaklyUnstable, DecidedBy::Nonlinear, true)
        }
        (Motion::Circles(_), Some(Ok(Swing { farther: Some(_), .. })))
            if balance.small_run.is_some_and(|run| run.late_theta < 0.5 * run.max_theta) =>
        {
            (Verdict::WeaklyAttracting, DecidedBy::Nonlinear, true)
        }
        (Motion::Circles(_), Some(Ok(swing))) => {
            let verdict = match swing.course() {
                Course::Circles => return (Verdict::Elliptic, DecidedBy::Linear, true),
                Course::Grows | Course::Pumps | Course::Shifts => Verdict::WeaklyUnstable,
                Course::DiesOut | Course::Settles if balance.left() => {
                    return (Verdict::Unstable, DecidedBy::Nonlinear, true);
                }
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

/// The evidence on a scene without noise, with `most` bounces of a run where the first orders of the map are silent. `None` once `go_on` returned
/// false.
pub fn evidence(scene: &Scene, most: u64, go_on: &mut impl FnMut() -> bool) -> Option<Evidence> {
    let Ok(orbit) = scene.orbit() else { return Some(Evidence::NoContact) };
    let judged = scene.with_tilt_law();
    let (mut balance, at) = match find_fixed_point(&judged) {
        Ok(place) => in_closed_form(&judged, &orbit, place),
        Err(underived) => match from_map(&judged, underived)? {
            Ok(found) => found,
            Err(nothing) => return Some(nothing),
        },
    };
    let decides = match (balance.motion, &balance.swing) {
        (Motion::Silent(_) | Motion::Grows(_), _) | (Motion::Circles(_), Some(Err(_))) => true,
        (Motion::Circles(_), Some(Ok(swing))) => {
            swing.farther.is_some() || matches!(swing.course(), Course::DiesOut | Course::Settles)
        }
        (Motion::Circles(_), None) => false,
        // A drift takes the body away from the pivot.
        (Motion::DiesOut, _) => balance.drifts && judged.acting_turn().is_some_and(|turning| turning.strikes()),
    };
    if decides {
        balance.small_run = Some(small_run(scene, &balance, at, most, go_on)?);
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
            if map.components().contains(&X) {
                // A drift moves the place, which is first that about which the release swings.
                at[X_DOT] = 0.0;
                at[X] = reference[X];
                if let Ok(bounce) = repeating::find(&map, &at, &reference) {
                    at[X] = bounce.at[X];
                }
            }
            Some(match repeating::find(&map, &at, &at) {
                Ok(bounce) => {
                    Swing::beside_drift(&map, &bounce, eigenvalue, &reference, drift * fixed_point.flight_time)
                }
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
    let map = ReturnMap::new(&model, 1);
    let drift = if drifts && scene.rules().half_length.is_finite() {
        // Air and friction change the drift of the release before it stays.
        let at = map.vector(&fixed_point.state(), fixed_point.x);
        let reference = map.vector(orbit.state(), orbit.x());
        repeating::find(&map, &at, &at)
            .map_or(drift, |bounce| lasting_drift(&map, &bounce, &reference).unwrap_or(drift))
    } else {
        drift
    };
    let leaves = if drifts { leaves(scene, orbit.x(), drift, fixed_point.flight_time) } else { None };
    let balance = Balance {
        fixed_point,
        linear,
        motion,
        drifts,
        drift,
        leaves,
        swing,
        boundary,
        losses,
        notes,
        small_run: None,
        underived: None,
    };
    (balance, (beside, fixed_point.x))
}

/// Drift of a release beside a bounce, to first order, m/s; `None` where a drift is not neutral.
fn lasting_drift(map: &ReturnMap, bounce: &RepeatingBounce, release: &Vector) -> Option<f64> {
    let off = map.reduced(release) - map.reduced(&bounce.at);
    let along = map.components().iter().position(|&index| index == X_DOT)?;
    let part = |neutral: &Neutral| {
        let part = neutral.right[along];
        (part.abs() > 1e-3 * neutral.right.amax()).then(|| part * neutral.left.dot(&off))
    };
    let parts: Vec<f64> = bounce.neutral.iter().filter_map(part).collect();
    (!parts.is_empty()).then(|| bounce.at[X_DOT] + parts.iter().sum::<f64>())
}

/// Bounces of a flight time (s) after which a drift (m/s) takes a body at a place (m) off the table of a scene, if it does within [`LEAVES`].
fn leaves(scene: &Scene, place: f64, drift: f64, flight_time: f64) -> Option<u64> {
    let bounces = (scene.rules().half_length - place * drift.signum()) / (drift.abs() * flight_time);
    // A cast keeps to the range of the type.
    (bounces <= LEAVES).then_some(bounces as u64)
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
fn from_map(scene: &Scene, underived: String) -> Option<Result<PlacedBalance, Evidence>> {
    let Ok(SceneMap { map, reference, guess }) = SceneMap::of(scene) else { return Some(Err(Evidence::NoContact)) };
    let (map, bounce) = match repeating::find_planned(&map, &guess, &reference) {
        Ok(found) => found,
        Err(why) => return Some(Err(Evidence::NothingRepeats { why, speed: -guess[Y_DOT], underived })),
    };
    let reference = map.with_plan(&reference);
    let mut eigenvalues = bounce.eigenvalues_beside()?;
    let motion = motion(&eigenvalues);
    let lasting = lasting_drift(&map, &bounce, &reference);
    let drift = lasting.unwrap_or(bounce.at[X_DOT]);
    // A wind or a table that is level at a speed alone keeps a drift that nothing else does.
    let is_kept = !map.components().contains(&X) && drift.abs() > repeating::SOLVED * bounce.at[Y_DOT].abs();
    let drifts = lasting.is_some() || is_kept;
    let flown = map.flight_time(&bounce.at);
    let swing = match motion {
        Motion::Circles(eigenvalue) => {
            let moved = if drifts { drift * flown / map.period() as f64 } else { 0.0 };
            Some(Swing::beside_drift(&map, &bounce, eigenvalue, &reference, moved))
        }
        Motion::DiesOut | Motion::Silent(_) | Motion::Grows(_) => None,
    };
    eigenvalues.extend(bounce.neutral.iter().map(|_| Complex::new(1.0, 0.0)));
    sort_eigenvalues(&mut eigenvalues);
    let at = &bounce.at;
    let rise = at[Y_DOT] * at[Y_DOT] / (2.0 * scene.gravity());
    let fixed_point = FixedPoint {
        x: if map.components().contains(&X) { at[X] } else { 0.0 },
        x_dot: at[X_DOT],
        speed: -at[Y_DOT],
        flight_time: flown / map.period() as f64,
        apex_height: map.body().contact_height(&map.state(at)) + rise,
    };
    let fall = map.components().iter().position(|&index| index == Y_DOT).unwrap_or_default();
    let linear = LinearVerdict::of_map(motion, eigenvalues, bounce.matrix[(fall, fall)]);
    let leaves = if drifts { leaves(scene, reference[X], drift, fixed_point.flight_time) } else { None };
    let (boundary, losses, notes) = (None, Vec::new(), Vec::new());
    let balance = Balance {
        fixed_point,
        linear,
        motion,
        drifts,
        drift,
        leaves,
        swing,
        boundary,
        losses,
        notes,
        small_run: None,
        underived: Some(underived),
    };
    Some(Ok((balance, (map.state(at), at[X]))))
}

impl Balance {
    /// Tells whether the run that decides ended.
    fn left(&self) -> bool {
        self.small_run.is_some_and(|run| !run.survived)
    }

    /// The verdict on a table without ends, whatever the run did, and the evidence that decides it.
    pub fn between_ends(&self) -> (Verdict, DecidedBy) {
        let (verdict, decided_by, _) = between_ends(self);
        (verdict, decided_by)
    }

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
        Ok(Self { form, amplitude, place: bounce.at[X], shifts, energy, farther: None })
    }

    /// The same beside a drift that moves the place by `moved` (m) a bounce: where strikes depend on the place, the course of the swing is that
    /// farther on, and the rest is of the release.
    fn beside_drift(
        map: &ReturnMap,
        bounce: &RepeatingBounce,
        eigenvalue: Complex<f64>,
        release: &Vector,
        moved: f64,
    ) -> Result<Self, NoSwingForm> {
        let mut swing = Self::new(map, bounce, eigenvalue, release)?;
        if moved != 0.0 && map.components().contains(&X) {
            let mut there = bounce.at;
            there[X] += MOVED * moved;
            if let Ok(bounce) = repeating::find(map, &there, &there) {
                swing.farther = Some(SwingForm::new(map, &bounce, eigenvalue)?.course());
            }
        }
        Ok(swing)
    }

    /// The course of the swing.
    pub fn course(&self) -> Course {
        self.farther.unwrap_or_else(|| self.form.course())
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

/// The run of a release on which its own verdict rests where the first orders are silent; that of a small swing for a release that is at the
/// bounce itself. `None` once `go_on` returned false.
fn small_run(
    scene: &Scene,
    balance: &Balance,
    (mut start, x): (State, f64),
    most: u64,
    go_on: &mut impl FnMut() -> bool,
) -> Option<SmallRun> {
    let released = scene.orbit().ok().filter(|orbit| {
        let State { theta, theta_dot, .. } = *orbit.state();
        let swings = theta.abs().max((theta_dot * balance.fixed_point.flight_time).abs()) > LEAST_SWING;
        // A double eigenvalue 1 tells itself by a spin only.
        swings && !matches!(balance.motion, Motion::Silent(value) if value > 0.0)
    });
    let mut orbit = released.unwrap_or_else(|| {
        start.theta += SMALL_SWING;
        start.theta_dot += 0.5 * SMALL_SWING / balance.fixed_point.flight_time;
        Orbit::at(scene.running_model(), scene.rules(), start).moved(x)
    });
    let mut halves = [0.0_f64; 2];
    let ending = run(&mut orbit, most, |contact| {
        let half = &mut halves[usize::from(contact.n > most / 2)];
        *half = half.max(contact.state.theta.abs());
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    let [early_theta, late_theta] = halves;
    Some(SmallRun {
        impacts: orbit.contacts(),
        is_own: released.is_some(),
        survived: ending == Ending::Completed,
        max_theta: early_theta.max(late_theta),
        late_theta,
    })
}
