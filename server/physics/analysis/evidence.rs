//! Evidence on the stability of any scene, and the verdict that ordered rules make of it.

use crate::analysis::boundary::boundary_coefficient;
use crate::analysis::jacobian::modulus;
use crate::analysis::losses::{StabilityLoss, losses};
use crate::analysis::nonlinear_run::{NonlinearRun, run_nonlinear};
use crate::analysis::repeating::{self, NoRepeatingBounce, RepeatingBounce, energy_gradient, keeps_energy, scales};
use crate::analysis::return_map::{ReturnMap, Vector, X, X_DOT, Y_DOT};
use crate::analysis::small_deviations::{Motion, SmallDeviations, small_deviations};
use crate::analysis::swing::{NoSwingForm, Resonance, SwingForm, amplitude_of, eigenvectors};
use crate::analysis::verdict::{DecidedBy, Verdict};
use crate::map::strike::State;
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::{Ending, EndingKind};
use crate::run::orbit::{Orbit, run};
use crate::scene::Scene;
use crate::surveys::ensemble::{Ensemble, wilson_interval};
use nalgebra::{Complex, DVector};

/// Swing of the run that decides where the first orders of the map are silent, for a release without one, rad.
pub const SMALL_SWING: f64 = 1e-3;

/// Swing of a release, rad, up to which it counts as one at the bounce itself.
const LEAST_SWING: f64 = 1e-7;

/// Share of its speed by which a swing may change a bounce, to first order: half of that with which it would end. Beyond, the run decides.
const LARGEST_CHANGE: f64 = 0.5;

/// Times the swing of a release beyond which a swing has widened, whatever its normal form says.
const WIDENED: f64 = 4.0;

/// Growth over the second half of that run from which on nothing bounds a deviation yet.
const STILL_GROWS: f64 = 1.5;

/// Part of a deviation that grows to first order, in parts of the bounce speed, up to which a run stays beside it; one that begins so far off follows.
pub const SMALL_GROWING: f64 = 1e-3;

/// Share of the bounce speed up to which a body that still bounces is at rest, over the last of so many parts of a run.
const AT_REST: f64 = 1e-3;
const LAST: u64 = 100;

/// Bounces of that run. Chaotic swings that stay bounded for a while have left by then.
pub const SMALL_RUN: u64 = 20_000;

/// Bounces over which a drift moves the place, where that matters to a swing.
const MOVED: f64 = 5_000.0;

/// Way, m, up to which such a drift is rounding.
const LEAST_WAY: f64 = 1e-9;

/// Share of a drift up to which two are the same.
const SAME_DRIFT: f64 = 1e-6;

/// Bounces up to which a drift that takes the body off its table counts.
const LEAVES: f64 = 1e6;

/// Most bounces that are told, 2⁵³: every reader of JSON keeps them exact, and more are rounding.
const MOST_TOLD: f64 = (1_u64 << 53) as f64;

/// Runs of the ensemble of a scene with noise.
pub const NOISY_RUNS: u64 = 200;

/// Most bounces of each of them.
pub const NOISY_IMPACTS: u64 = 400;

/// End of the run that decides where the first orders of the map are silent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallRun {
    /// True if it is that of the release, and not of [`SMALL_SWING`].
    pub is_own: bool,
    /// Bounces that it went on for.
    pub impacts: u64,
    /// True if it went on for all bounces asked for, and still bounces.
    pub survived: bool,
    /// True if it went on for all of them, and has come to rest.
    pub rests: bool,
    /// Largest |θ| over the first and over the second half of the bounces asked for, rad.
    pub halves: [f64; 2],
    /// The same of the part of the deviation that grows to first order, in parts of the bounce speed; 0 where none does.
    pub growing: [f64; 2],
}

impl SmallRun {
    /// Largest |θ|, rad.
    pub fn max_theta(&self) -> f64 {
        self.halves[0].max(self.halves[1])
    }

    /// Tells whether the swing, or what grows to first order, still grew in the second half: by half, or by the root of what a factor a bounce makes
    /// of a small one if that is less. Nothing bounds it yet.
    pub fn grew(&self, factor: f64) -> bool {
        let least = libm::pow(factor, 0.25 * self.impacts as f64);
        let grows = |[early, late]: [f64; 2], least: f64| late > early * least;
        grows(self.halves, least) || grows(self.growing, least.min(STILL_GROWS))
    }
}

/// A bounce that repeats, with the motion of small deviations from it.
#[derive(Clone, Debug)]
pub struct Balance {
    /// The bounce with its eigenvalues, and the motion of small deviations.
    pub small: SmallDeviations,
    /// Bounces after which the drift takes the body off its table, if it does within a million.
    pub leaves: Option<u64>,
    /// Normal form of the swing, if it circles; `None` also for a strike that keeps the energy of a frictionless rod, whose swings circle.
    pub swing: Option<Result<Swing, NoSwingForm>>,
    /// |w| of the release, rad, where small deviations circle.
    pub amplitude: Option<f64>,
    /// The strong resonance of the release, where its normal form does not tell whether the swing leaves: the run does.
    pub resonance: Option<Resonance>,
    /// C at κ_c.
    pub boundary: Option<f64>,
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
    /// Normal form of the swing.
    pub form: SwingForm,
    /// |w| of the release, rad.
    pub amplitude: f64,
    /// Share of the speed of the bounce by which it changes that, to first order.
    pub of_speed: f64,
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
    /// With noise: the share of an ensemble of [`NOISY_RUNS`] that survives.
    Ensemble {
        /// Runs that survived.
        survived: u64,
        /// Bounces of all.
        bounces: u64,
        /// Interval of the probability to survive, 95 %.
        interval: (f64, f64),
    },
    /// The release comes to no contact.
    NoContact,
    /// No bounce repeats.
    NothingRepeats(NoRepeatingBounce),
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

/// Contacts of the run by which [`stability`] checks a scene.
const CHECKED: u64 = 2000;

/// Share of a small deviation that is left after [`CHECKED`] bounces, above which it dies out slowly.
const SLOW: f64 = 0.1;

/// The verdict on a scene, with a run of 2000 contacts as a check.
pub fn stability(scene: &Scene) -> Judgement {
    // Behind a pointer, so that nothing is compiled anew for this call.
    let go_on: &mut dyn FnMut() -> bool = &mut || true;
    let judged = run_nonlinear(scene, CHECKED, &mut *go_on).and_then(|run| judge(scene, &run, SMALL_RUN, go_on));
    judged.unwrap_or_else(|| unreachable!("nothing stops the analysis"))
}

/// Judges a scene with its own run, and with `most` bounces of one where the first orders of the map are silent. `None` once `go_on` returned false.
pub fn judge(scene: &Scene, run: &NonlinearRun, most: u64, mut go_on: impl FnMut() -> bool) -> Option<Judgement> {
    let evidence = evidence(scene, most, &mut go_on)?;
    let (verdict, decided_by, says_bounded, bounces) = match &evidence {
        Evidence::Ensemble { interval, bounces, .. } => {
            (Verdict::Random, DecidedBy::Ensemble, interval.1 > 0.5, *bounces)
        }
        Evidence::NoContact => (Verdict::Unstable, DecidedBy::Nonlinear, false, 0),
        Evidence::NothingRepeats(_) => (Verdict::Unstable, DecidedBy::FixedPoint, false, 0),
        Evidence::Balances(balance) => {
            let (is_bounded, leaves) = (balance.small.motion.is_bounded(), balance.leaves.is_some());
            let ended = (Verdict::Unstable, DecidedBy::FixedPoint);
            let (verdict, by) = if is_bounded && leaves { ended } else { balance.between_ends() };
            (verdict, by, is_bounded && !leaves, balance.small_run.map_or(0, |run| run.impacts))
        }
    };
    // A run that ended is no balance, whatever small deviations do.
    let (verdict, decided_by) = match verdict {
        _ if run.ending == Ending::Completed => (verdict, decided_by),
        Verdict::WeaklyUnstable => (Verdict::Unstable, decided_by),
        _ => (Verdict::Unstable, if says_bounded { DecidedBy::Nonlinear } else { decided_by }),
    };
    Some(Judgement { verdict, decided_by, says_bounded, evidence, bounces })
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
    /// It turns with a quarter turn, and grows in third order ([`SwingForm::locks`]).
    Locks,
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

/// The evidence on a scene, with `most` bounces of a run where the first orders of the map are silent. `None` once `go_on` returned false.
pub fn evidence(scene: &Scene, most: u64, go_on: &mut impl FnMut() -> bool) -> Option<Evidence> {
    if scene.has_noise() {
        let ensemble = Ensemble { scene: *scene, runs: NOISY_RUNS, impacts: NOISY_IMPACTS, angle_contacts: 0 };
        let found = ensemble.runs(0..NOISY_RUNS, go_on)?;
        let (survived, bounces) = (found.count(EndingKind::Completed), found.ends.iter().map(|end| end.impacts).sum());
        return Some(Evidence::Ensemble { survived, bounces, interval: wilson_interval(survived, NOISY_RUNS) });
    }
    let Ok(orbit) = scene.orbit() else { return Some(Evidence::NoContact) };
    let judged = scene.with_tilt_law();
    let small = match small_deviations(&judged) {
        Ok(small) => small,
        Err(why) => return Some(Evidence::NothingRepeats(why)),
    };
    let mut balance = Balance::new(&judged, &orbit, small);
    // A run of no more bounces would repeat the one that checks the scene.
    let is_longer = most > CHECKED;
    // A drift that no first order tells may take the body off its table.
    let may_leave = is_longer && balance.small.drifts && scene.rules().half_length.is_finite();
    let decides = match (balance.small.motion, &balance.swing) {
        (Motion::Circles(_) | Motion::DiesOut, _) if may_leave => true,
        (Motion::Silent(_) | Motion::Grows(_), _) | (Motion::Circles(_), Some(Err(_))) => true,
        (Motion::Circles(_), _) if !balance.form_tells() => true,
        (Motion::Circles(_), Some(Ok(swing))) => {
            swing.farther.is_some() || matches!(swing.course(), Course::DiesOut | Course::Settles)
        }
        (Motion::Circles(_), None) => false,
        // A drift takes the body away from the place; and where a small swing dies out slowly, one of the size of the release may grow.
        (Motion::DiesOut, _) => {
            (is_longer && libm::pow(balance.small.slowest(), CHECKED as f64) > SLOW)
                || balance.small.drifts && ReturnMap::of_cycle(&judged.model()).has_place
        }
    };
    if decides {
        balance.small_run = Some(small_run(scene, &balance.small, most, go_on)?);
    }
    Some(Evidence::Balances(Box::new(balance)))
}

/// Bounces after which a drift of the release takes the body off the table of a scene, if it does within [`LEAVES`].
fn leaves(scene: &Scene, place: f64, small: &SmallDeviations) -> Option<u64> {
    let drift = small.lasting_drift();
    // The way of the bounce itself where it has this drift: strikes may change ẋ.
    let of_map = small.found.as_ref().filter(|bounce| (bounce.at[X_DOT] - drift).abs() <= SAME_DRIFT * drift.abs());
    let of_map =
        of_map.and_then(|bounce| Some((bounce.map.image(&bounce.at)?[X] - bounce.at[X]) / bounce.map.period as f64));
    let way = of_map.unwrap_or(drift * small.fixed_point.flight_time);
    let bounces = (scene.rules().half_length - place * way.signum()) / way.abs();
    // A cast keeps to the range of the type.
    (small.drifts && bounces <= LEAVES).then_some(bounces as u64)
}

impl Balance {
    fn new(scene: &Scene, orbit: &Orbit, small: SmallDeviations) -> Self {
        let model = scene.model();
        let (mut swing, mut resonance, mut amplitude) = (None, None, None);
        if let Motion::Circles(eigenvalue) = small.motion {
            let map = ReturnMap::new(&model, 1);
            let at = map.vector(&small.state(), small.fixed_point.x);
            // A swing of a rod whose strikes keep the energy neither grows nor dies out.
            if small.found.is_none() && keeps_energy(&map, &at) {
                let bounce = map.derivative(&at).map(|here| RepeatingBounce::bare(&map, at, here.matrix));
                let release = map.vector(orbit.state(), orbit.x());
                amplitude = bounce.as_ref().and_then(|bounce| amplitude_of(bounce, eigenvalue, &release));
                resonance =
                    bounce.zip(amplitude).and_then(|(bounce, size)| Resonance::about(&bounce, eigenvalue, size));
            } else {
                let found = small.on_map(scene).map_err(|_| NoSwingForm::NoDerivative).and_then(|bounce| {
                    let release = bounce.map.planned(&bounce.map.vector(orbit.state(), orbit.x()));
                    let moved = if small.drifts { small.lasting_drift() * small.fixed_point.flight_time } else { 0.0 };
                    Swing::new(&bounce, eigenvalue, &release, moved)
                });
                resonance = found.as_ref().ok().and_then(|swing| swing.form.resonance(swing.amplitude));
                amplitude = found.as_ref().ok().map(|swing| swing.amplitude);
                swing = Some(found);
            }
        }
        let boundary = boundary_coefficient(&model, &small.fixed_point);
        let (losses, notes) = losses(scene, &small, boundary);
        let boundary = boundary.or_else(|| losses.iter().find_map(StabilityLoss::boundary));
        let leaves = leaves(scene, orbit.x(), &small);
        Self { small, leaves, swing, amplitude, resonance, boundary, losses, notes, small_run: None }
    }

    /// Tells whether the swing of the release is small enough for its normal form to tell whether it leaves.
    fn form_tells(&self) -> bool {
        self.resonance.is_none() && !matches!(&self.swing, Some(Ok(swing)) if swing.is_wide())
    }

    /// Tells whether the run that decides ended while its swing still grew.
    pub fn grows_on(&self) -> bool {
        matches!((self.small.motion, self.small_run), (Motion::Grows(factor), Some(run)) if run.grew(factor))
    }

    /// Tells whether the run that decides ended with a swing that is far wider than that of its release.
    fn widened(&self) -> bool {
        let run = self.small_run.filter(|run| run.is_own);
        run.zip(self.amplitude).is_some_and(|(run, amplitude)| run.halves[1] > WIDENED * amplitude)
    }

    fn left(&self) -> bool {
        self.small_run.is_some_and(|run| !run.survived)
    }

    /// The verdict on a table without ends, whatever the run did, and the evidence that decides it: rules in their order.
    pub fn between_ends(&self) -> (Verdict, DecidedBy) {
        let (motion, left) = (self.small.motion, self.left());
        match (motion, &self.swing) {
            (Motion::Grows(_) | Motion::Silent(_), _) => self.beyond(),
            (Motion::DiesOut, _) if left => (Verdict::Unstable, DecidedBy::Nonlinear),
            (Motion::DiesOut, _) if self.small.drifts => (Verdict::StableDrifting, DecidedBy::Linear),
            (Motion::DiesOut, _) => (Verdict::StableInPlace, DecidedBy::Linear),
            (Motion::Circles(_), swing) if left && (swing.is_none() || !self.form_tells()) => {
                (Verdict::Unstable, DecidedBy::Nonlinear)
            }
            // Near a strong resonance it may do what its normal form does not tell.
            (Motion::Circles(_), None | Some(Ok(Swing { farther: None, .. }))) if self.widened() => {
                (Verdict::WeaklyUnstable, DecidedBy::Nonlinear)
            }
            (Motion::Circles(_), None) => (Verdict::Elliptic, DecidedBy::Linear),
            // Without a normal form the run from a small start decides.
            (Motion::Circles(_), Some(Err(_))) => {
                let stays = self.small_run.is_some_and(|run| run.survived);
                (if stays { Verdict::Elliptic } else { Verdict::Unstable }, DecidedBy::Nonlinear)
            }
            // A drift makes the strikes depend on the time: the run tells.
            (Motion::Circles(_), Some(Ok(Swing { farther: Some(_), .. }))) if left => {
                (Verdict::WeaklyUnstable, DecidedBy::Nonlinear)
            }
            (Motion::Circles(_), Some(Ok(Swing { farther: Some(_), .. })))
                if self.small_run.is_some_and(|run| run.halves[1] < 0.5 * run.max_theta()) =>
            {
                (Verdict::WeaklyAttracting, DecidedBy::Nonlinear)
            }
            (Motion::Circles(_), Some(Ok(swing))) => match swing.course() {
                Course::Grows | Course::Pumps | Course::Shifts | Course::Locks => {
                    (Verdict::WeaklyUnstable, DecidedBy::Lyapunov)
                }
                _ if left => (Verdict::Unstable, DecidedBy::Nonlinear),
                Course::Circles => (Verdict::Elliptic, DecidedBy::Linear),
                Course::DiesOut | Course::Settles => (Verdict::WeaklyAttracting, DecidedBy::Lyapunov),
            },
        }
    }

    /// The rules at and beyond an end of the stable range: the coefficient at κ_c, the run from a small start, and soft losses.
    fn beyond(&self) -> (Verdict, DecidedBy) {
        let stays = self.small_run.is_some_and(|run| run.survived);
        let grows = self.grows_on();
        let at_end = matches!(self.small.motion, Motion::Silent(value) if value < 0.0);
        let is_soft = self.losses.iter().any(|loss| loss.is_soft() && loss.settles.is_some());
        match self.boundary.filter(|_| at_end) {
            Some(coefficient) if coefficient <= 0.0 => (Verdict::Unstable, DecidedBy::Boundary),
            Some(_) if stays => (Verdict::BoundedBeyondBoundary, DecidedBy::Boundary),
            Some(_) => (Verdict::Unstable, DecidedBy::Nonlinear),
            None if !stays => (Verdict::Unstable, DecidedBy::Linear),
            None if is_soft => (Verdict::BoundedBeyondBoundary, DecidedBy::Boundary),
            None if grows => (Verdict::Unstable, DecidedBy::Linear),
            None => (Verdict::BoundedBeyondBoundary, DecidedBy::Nonlinear),
        }
    }

    /// Bounces until a swing that gives energy to the bounce has raised it to R = 1, at the present rate, if it does.
    pub fn bounces_until_critical(&self) -> Option<u64> {
        let energy = self.swing.as_ref()?.as_ref().ok()?.energy;
        let speed = self.small.fixed_point.speed;
        // The speed grows by energy/V² of itself a bounce, and R with its square.
        let bounces = -0.5 * libm::log(self.small.linear.residue?) * speed * speed / energy;
        (energy > 0.0 && bounces < MOST_TOLD).then_some(bounces as u64)
    }
}

impl Swing {
    /// The swing of a release, by its state at the first contact, about a bounce that repeats, beside a drift that moves the place by `moved` (m) a
    /// bounce. Where strikes depend on the place, the course of the swing is that farther on, and the rest is of the release.
    fn new(
        bounce: &RepeatingBounce,
        eigenvalue: Complex<f64>,
        release: &Vector,
        moved: f64,
    ) -> Result<Self, NoSwingForm> {
        let map = &bounce.map;
        let form = SwingForm::new(bounce, eigenvalue)?;
        let amplitude = form.amplitude(bounce, release);
        let shifts: Vec<f64> = form.shifts.iter().map(|shift| shift * amplitude * amplitude).collect();
        let gradient = energy_gradient(map, &bounce.at);
        let along = bounce.neutral.iter().map(|neutral| gradient.dot(&neutral.right));
        let energy = along.zip(&shifts).map(|(energy, shift)| energy * shift).sum();
        let change = map.place_of(Y_DOT).map_or(0.0, |fall| 2.0 * modulus(form.right[fall]) * amplitude);
        let of_speed = change / bounce.at[Y_DOT].abs();
        let mut farther = None;
        let way = MOVED * moved;
        if way.abs() > LEAST_WAY && map.has_place {
            let mut there = bounce.at;
            there[X] += way;
            if let Ok(bounce) = repeating::find(map, &there, &there) {
                farther = Some(SwingForm::new(&bounce, eigenvalue)?.course());
            }
        }
        Ok(Self { form, amplitude, of_speed, place: bounce.at[X], shifts, energy, farther })
    }

    /// Bounces in which a swing as large as that of the release leaves upright, 1/(2ℓA₀²), to third order; `None` where it does not grow, and for
    /// a release that does not swing but for rounding.
    pub fn escape_bounces(&self) -> Option<f64> {
        let (growth, amplitude) = (self.form.growth, self.amplitude);
        let bounces = 0.5 / (growth * amplitude * amplitude);
        (growth > 0.0 && bounces < MOST_TOLD).then_some(bounces)
    }

    /// Tells whether it changes the speed of the bounce so much that no normal form tells whether it leaves.
    pub fn is_wide(&self) -> bool {
        self.of_speed > LARGEST_CHANGE
    }

    /// The course of the swing, where a drift takes it.
    pub fn course(&self) -> Course {
        self.farther.unwrap_or_else(|| self.course_here())
    }

    /// The course of the swing where it is.
    pub fn course_here(&self) -> Course {
        let is_alone = self.shifts.iter().all(|shift| *shift == 0.0);
        if is_alone && self.form.locks(self.amplitude) { Course::Locks } else { self.form.course() }
    }
}

/// The part of a deviation that grows to first order: p·(s − s*) with the left eigenvector p of the largest eigenvalue.
struct GrowingPart {
    bounce: RepeatingBounce,
    /// Right and left eigenvector. |p·(s − s*)| is in parts of the bounce speed.
    right: DVector<Complex<f64>>,
    left: DVector<Complex<f64>>,
}

impl GrowingPart {
    fn of(scene: &Scene, small: &SmallDeviations) -> Option<Self> {
        let Motion::Grows(_) = small.motion else { return None };
        let bounce = small.on_map(&scene.with_tilt_law()).ok().filter(|bounce| !bounce.map.plans)?;
        let (right, left) = eigenvectors(&bounce.matrix, *bounce.eigenvalues.first()?)?;
        let speed = bounce.at[Y_DOT].abs();
        let size = right.map(modulus).component_mul(&scales(&bounce.map, speed)).amax();
        let unit = Complex::new(size / speed, 0.0);
        Some(Self { right: right / unit, left: left * unit, bounce })
    }

    fn size(&self, state: &State, x: f64) -> f64 {
        let RepeatingBounce { map, at, .. } = &self.bounce;
        let off = map.reduced(&map.vector(state, x)) - map.reduced(at);
        modulus(self.left.iter().zip(off.iter()).map(|(p, off)| p * *off).sum())
    }

    /// A state and a place, moved along the right eigenvector.
    fn moved(&self, (state, x): (State, f64)) -> (State, f64) {
        let map = &self.bounce.map;
        let moved = map.moved(&map.vector(&state, x), &self.right.map(|part| part.re * SMALL_GROWING));
        (map.state(&moved), if map.has_place { moved[X] } else { x })
    }
}

/// The run of a release on which its own verdict rests where the first orders are silent; that of a small deviation for a release that is at the
/// bounce itself, or stays beside what grows. `None` once `go_on` returned false.
fn small_run(scene: &Scene, small: &SmallDeviations, most: u64, go_on: &mut impl FnMut() -> bool) -> Option<SmallRun> {
    let growing = GrowingPart::of(scene, small);
    let released = scene.orbit().ok().filter(|orbit| {
        let State { theta, theta_dot, .. } = *orbit.state();
        let swings = theta.abs().max((theta_dot * small.fixed_point.flight_time).abs()) > LEAST_SWING;
        // A double eigenvalue 1 tells itself by a spin only.
        let tells = swings && !matches!(small.motion, Motion::Silent(value) if value > 0.0);
        tells || growing.as_ref().is_some_and(|part| part.size(orbit.state(), orbit.x()) > LEAST_SWING)
    });
    let own = released.map(|mut orbit| followed(&mut orbit, true, small, growing.as_ref(), most, go_on));
    match own {
        Some(run) if growing.is_none() || run.is_none_or(|run| !run.survived || run.growing[1] > SMALL_GROWING) => run,
        _ => {
            let swinging = || {
                let mut start = small.state();
                start.theta += SMALL_SWING;
                start.theta_dot += 0.5 * SMALL_SWING / small.fixed_point.flight_time;
                (start, small.fixed_point.x)
            };
            let start = released.map_or_else(swinging, |orbit| (*orbit.state(), orbit.x()));
            let (start, x) = growing.as_ref().map_or(start, |part| part.moved(start));
            let mut orbit = Orbit::at(scene.running_model(), scene.rules(), start).moved(x);
            followed(&mut orbit, false, small, growing.as_ref(), most, go_on)
        }
    }
}

/// Follows a run for `most` bounces; `None` once `go_on` returned false. One that has come to rest has not survived.
fn followed(
    orbit: &mut Orbit,
    is_own: bool,
    small: &SmallDeviations,
    part: Option<&GrowingPart>,
    most: u64,
    go_on: &mut impl FnMut() -> bool,
) -> Option<SmallRun> {
    let period = part.map_or(1, |part| part.bounce.map.period);
    let (mut halves, mut growing, mut last_speed) = ([0.0_f64; 2], [0.0_f64; 2], 0.0_f64);
    let ending = run(orbit, most, |contact| {
        let half = usize::from(contact.n > most / 2);
        halves[half] = halves[half].max(contact.state.theta.abs());
        if contact.n + most / LAST > most {
            last_speed = last_speed.max(contact.state.y_dot.abs());
        }
        if let Some(part) = part.filter(|_| (contact.n - 1).is_multiple_of(period)) {
            growing[half] = growing[half].max(part.size(&contact.state, contact.x));
        }
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    let is_over = ending != Ending::Completed;
    let rests = !is_over && most >= LAST && last_speed <= AT_REST * small.fixed_point.speed;
    Some(SmallRun { impacts: orbit.contacts(), is_own, survived: !is_over && !rests, rests, halves, growing })
}
