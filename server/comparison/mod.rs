//! Speed against accuracy: every method over its settings on one scene, what each run costs and how far it ends from the run with 31
//! digits.
//!
//! The work and the errors are the same everywhere; the times are of this machine at this moment. Not here: HTTP, and the methods
//! themselves.

mod methods;
mod runs;

pub use methods::{ComparedMethod, METHODS, MethodSetting, most_points};
pub use runs::{ReferenceRun, Unavailable};

use equipoise_physics::scene::Scene;

use crate::compute::stopwatch::{TimedWork, Timing, TimingBudget};
use crate::compute::{CancelFlag, Cancelled, TimeSlice, stopwatch};
use crate::limits;
use methods::MethodKind;
use runs::{MethodRun, Subject};

/// One method with one setting.
#[derive(Clone, Debug)]
pub struct WorkPrecisionPoint {
    /// The method.
    pub method: ComparedMethod,
    /// The setting, if the method has one.
    pub setting: Option<MethodSetting>,
    /// Clock time of the whole run; `None` without a run.
    pub timing: Option<Timing>,
    /// Contacts that it saw.
    pub bounces: u64,
    /// Steps, looks or bounces.
    pub steps: u64,
    /// Evaluations of the equations of motion and of the gap; `None` in numbers of 31 digits.
    pub evaluations: Option<u64>,
    /// Largest of |ρδθ| (m), |δẋ|, |δẏ|, |ρδθ̇| (m/s) just before the reference's last contact.
    pub error: Option<f64>,
    /// Outcome of the run, or `unavailable`.
    pub outcome: &'static str,
    /// Reason for which there is no error, or no run.
    pub reason: Option<Unavailable>,
    /// True if no point is both faster and more accurate.
    pub pareto: bool,
    /// True if no point takes fewer evaluations and is more accurate.
    pub pareto_evaluations: bool,
}

impl WorkPrecisionPoint {
    /// Quartile, median, quartile of the time of a contact, ns.
    pub fn cost_ns(&self) -> Option<[f64; 3]> {
        let timing = self.timing.filter(|_| self.bounces > 0)?;
        Some(timing.quartiles_s.map(|time_s| time_s * 1e9 / self.bounces as f64))
    }

    /// Steps for a contact.
    pub fn steps_per_bounce(&self) -> Option<f64> {
        (self.bounces > 0).then(|| self.steps as f64 / self.bounces as f64)
    }

    /// Evaluations for a contact.
    pub fn evaluations_per_bounce(&self) -> Option<f64> {
        self.evaluations.filter(|_| self.bounces > 0).map(|count| count as f64 / self.bounces as f64)
    }
}

/// The chart of a scene.
#[derive(Clone, Debug)]
pub struct WorkPrecisionChart {
    /// The run that errors are measured from.
    pub reference: ReferenceRun,
    /// All points, method by method.
    pub points: Vec<WorkPrecisionPoint>,
    /// Notes on points that were left out.
    pub notes: Vec<String>,
}

/// The power of ten below a time; 1 s for none.
fn power_of_ten(time: f64) -> f64 {
    let text = format!("{time:e}");
    let power = text.split_once('e').filter(|_| time.is_finite() && time > 0.0);
    power.and_then(|(_, power)| format!("1e{power}").parse().ok()).unwrap_or(1.0)
}

/// Runs and times `methods` over `bounces` contacts of a scene. `progress` hears how much of how much is done: of each point its run,
/// and its timing.
pub fn chart(
    scene: &Scene,
    bounces: u64,
    methods: &[ComparedMethod],
    progress: &mut dyn FnMut(u64, u64),
    slice: &TimeSlice,
) -> Result<WorkPrecisionChart, Cancelled> {
    let subject = Subject::new(scene, bounces, slice)?;
    let reference = subject.reference();
    let scale = power_of_ten(reference.t / reference.bounces.max(1) as f64);
    let mut notes = Vec::new();
    let mut wanted = Vec::new();
    let mut left_out = Vec::new();
    for &method in methods {
        for setting in method.kind.settings(scale) {
            if let Some(MethodSetting { name: "step", value, .. }) = setting
                && reference.t / value > 0.9 * limits::PRECISION_STEPS as f64
            {
                left_out.push(value);
            } else {
                wanted.push((method, setting));
            }
        }
    }
    let of = 2 * wanted.len() as u64;
    progress(0, of);
    let mut points = Vec::with_capacity(wanted.len());
    for (method, setting) in wanted {
        let done = subject.run(method.kind, setting, slice)?;
        points.push(point(&subject, method, setting, done));
        progress(points.len() as u64, of);
    }
    if scene.rules().limits.is_some() {
        notes.push("table.limits end none of these runs: general methods do not look at them".to_owned());
    }
    if scene.rules().half_length.is_finite() {
        notes.push("table.length ends none of these runs: no method but the map looks at it".to_owned());
    }
    if scene.vertices().is_some() {
        notes.push("no other vertex ends any of these runs: general methods do not look for them".to_owned());
    }
    if let Some(coarsest) = left_out.into_iter().reduce(f64::max) {
        notes.push(format!(
            "steps of {coarsest} s and finer are left out: they would take more than about {} steps",
            limits::PRECISION_STEPS
        ));
    }
    measure(&subject, &mut points, progress, slice)?;
    mark(&mut points, |point| point.cost_ns().map(|cost| cost[1]), |point| &mut point.pareto);
    mark(&mut points, WorkPrecisionPoint::evaluations_per_bounce, |point| &mut point.pareto_evaluations);
    Ok(WorkPrecisionChart { reference, points, notes })
}

fn point(
    subject: &Subject<'_>,
    method: ComparedMethod,
    setting: Option<MethodSetting>,
    done: Result<MethodRun, Unavailable>,
) -> WorkPrecisionPoint {
    let reference = subject.reference();
    let mut point = WorkPrecisionPoint {
        method,
        setting,
        timing: None,
        bounces: 0,
        steps: 0,
        evaluations: None,
        error: None,
        outcome: "unavailable",
        reason: None,
        pareto: false,
        pareto_evaluations: false,
    };
    let because = |why| Some(Unavailable::Because(why));
    let done = match done {
        Ok(done) => done,
        Err(reason) => return WorkPrecisionPoint { reason: Some(reason), ..point },
    };
    (point.bounces, point.steps, point.evaluations) = (done.bounces, done.steps, done.evaluations);
    point.outcome = done.outcome;
    if method.kind == MethodKind::Extended {
        point.reason = because("it is the reference that errors are measured from".to_owned());
    } else if (done.outcome, done.bounces) != (reference.outcome, reference.bounces) {
        let (outcome, bounces) = (reference.outcome, reference.bounces);
        point.reason = because(format!(
            "its run is {} after {} contacts, and the reference {outcome} after {bounces}",
            done.outcome, done.bounces
        ));
    } else {
        let error = subject.error(&done.state);
        point.error = Some(error).filter(|error| error.is_finite());
        if point.error.is_none() {
            point.reason = because("its state is not finite".to_owned());
        }
    }
    point
}

/// Times all runs there were, in turns.
fn measure(
    subject: &Subject<'_>,
    points: &mut [WorkPrecisionPoint],
    progress: &mut dyn FnMut(u64, u64),
    slice: &TimeSlice,
) -> Result<(), Cancelled> {
    let of = 2 * points.len() as u64;
    let mut ran: Vec<&mut WorkPrecisionPoint> =
        points.iter_mut().filter(|point| point.outcome != "unavailable").collect();
    let mut works: Vec<TimedWork<'_>> = ran
        .iter()
        .map(|point| {
            let (kind, setting) = (point.method.kind, point.setting);
            Box::new(move |cancel: &CancelFlag| subject.race(kind, setting, cancel)) as TimedWork<'_>
        })
        .collect();
    let budget = TimingBudget {
        time: limits::PRECISION_TIME,
        sample: limits::PRECISION_SAMPLE,
        repeats: limits::PRECISION_REPEATS,
    };
    let mut done = of - works.len() as u64;
    let mut timed = || {
        done += 1;
        progress(done, of);
    };
    let timings = stopwatch::time(&mut works, budget, &mut timed, slice)?;
    for (point, timing) in ran.iter_mut().zip(timings) {
        point.timing = Some(timing);
    }
    Ok(())
}

/// Marks the points of the Pareto front. A point is on it if no other is at most as expensive and as inaccurate, and less in one of the two.
fn mark(
    points: &mut [WorkPrecisionPoint],
    cost: impl Fn(&WorkPrecisionPoint) -> Option<f64>,
    flag: impl Fn(&mut WorkPrecisionPoint) -> &mut bool,
) {
    let places: Vec<Option<(f64, f64)>> = points.iter().map(|point| cost(point).zip(point.error)).collect();
    for (point, place) in points.iter_mut().zip(&places) {
        let beats = |own: (f64, f64), other: (f64, f64)| other.0 <= own.0 && other.1 <= own.1 && other != own;
        *flag(point) = place.is_some_and(|own| !places.iter().flatten().any(|other| beats(own, *other)));
    }
}
