//! Speed against accuracy: every method over its settings on one scene, what each run costs and how far it ends from the run with 31
//! digits.
//!
//! The work and the errors are the same everywhere; the times are of this machine at this moment. Not here: HTTP, and the methods
//! themselves.

use std::hint::black_box;

use equipoise_physics::analysis::linear_solution::LinearSolution;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::contact_time;
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;

use crate::compute::time_slices::{TimedWork, Timing, TimingBudget};
use crate::compute::{CancelFlag, Cancelled, TimeSlice, time_slices};
use crate::integrators::{Integrator, Location, Simulation, simulate};
use crate::limits;

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
    let timings = time_slices::time(&mut works, budget, &mut timed, slice)?;
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

/// A method of the chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedMethod {
    /// Name in requests and answers.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// Description in a sentence.
    pub about: &'static str,
    kind: MethodKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MethodKind {
    Map,
    MapFree,
    Linear,
    Extended,
    /// A general method for equations of motion, as a physics engine has it, without its setting.
    Integrator(Integrator),
}

const fn method(kind: MethodKind, name: &'static str, title: &'static str, about: &'static str) -> ComparedMethod {
    ComparedMethod { name, title, about, kind }
}

/// A general method.
const fn general(
    integrator: Integrator,
    name: &'static str,
    title: &'static str,
    about: &'static str,
) -> ComparedMethod {
    method(MethodKind::Integrator(integrator), name, title, about)
}

/// Runge-Kutta of order 4 with this treatment of contacts.
const fn runge_kutta(location: Location) -> Integrator {
    Integrator::RungeKutta { step: 0.0, location }
}

/// All of them, in the order of answers.
#[rustfmt::skip]
pub const METHODS: [ComparedMethod; 11] = [
    method(MethodKind::Map, "map", "map", "The map from contact to contact in closed form, which keeps rounding off the energy."),
    method(MethodKind::MapFree, "map_free", "map, energy left free", "The same map without the correction of its energy."),
    method(MethodKind::Linear, "linear", "linear solution", "Eq. (13) and (20) to (23), by the linear map of eq. (14)."),
    method(MethodKind::Extended, "extended", "map with 31 digits", "The map in double-double numbers: the reference of all errors."),
    general(Integrator::Adaptive { tolerance: 0.0 }, "adaptive", "Dormand-Prince 5(4), events",
        "A library's adaptive Runge-Kutta; contacts located by halving on its dense output."),
    general(runge_kutta(Location::Bisection), "runge_kutta_bisection", "RK4, contact bisected",
        "Runge-Kutta of order 4 with a fixed step; contacts located to the last digit."),
    general(runge_kutta(Location::Secant), "runge_kutta_secant", "RK4, contact on a chord",
        "The same; contacts where the chord of the gap over the step is zero."),
    general(runge_kutta(Location::StepEnd), "runge_kutta_step_end", "RK4, contact at step end",
        "The same; contacts at the end of the step in which they happen."),
    general(Integrator::Sampling { step: 0.0 }, "sampling", "sampled flight",
        "The exact parabola looked at on a grid of times; contacts halved between two looks."),
    general(Integrator::TimeStepping { step: 0.0 }, "time_stepping", "Moreau-Jean time stepping",
        "Velocities and impulses of whole steps, as engines of many contacts do it."),
    general(Integrator::Penalty { step: 0.0 }, "penalty", "spring-damper contact",
        "A stiff spring and a damper for the contact, moved by Runge-Kutta."),
];

/// A setting of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSetting {
    /// `step` or `tolerance`.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit; `1` for none.
    pub unit: &'static str,
}

/// Most points that the methods have together.
pub fn most_points(methods: &[ComparedMethod]) -> u64 {
    methods.iter().map(|method| method.kind.settings(1.0).len() as u64).sum()
}

impl MethodKind {
    /// Settings from the coarsest, `scale` being the power of ten below the mean flight, s.
    fn settings(self, scale: f64) -> Vec<Option<MethodSetting>> {
        let of = |name, unit, values: &[f64]| {
            values.iter().map(|&value| Some(MethodSetting { name, value, unit })).collect::<Vec<_>>()
        };
        match self {
            Self::Map | Self::MapFree | Self::Linear | Self::Extended => vec![None],
            Self::Integrator(Integrator::Adaptive { .. }) => of("tolerance", "1", &[1e-4, 1e-6, 1e-8, 1e-10, 1e-12]),
            Self::Integrator(
                Integrator::RungeKutta { .. }
                | Integrator::TimeStepping { .. }
                | Integrator::Penalty { .. }
                | Integrator::Sampling { .. },
            ) => of("step", "s", &[10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4].map(|parts| one_digit(scale / parts))),
        }
    }
}

/// The nearest number of one digit, so that steps are what they read.
fn one_digit(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

/// The run of the reference.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceRun {
    /// Outcome.
    pub outcome: &'static str,
    /// Contacts, the last included.
    pub bounces: u64,
    /// Time of the last contact, s.
    pub t: f64,
    /// One unit in the last place of its last state, m or m/s: the resolution of doubles there.
    pub rounding: f64,
}

/// Reason for which there is no error of a method, or no run.
#[derive(Debug, Clone, PartialEq)]
pub enum Unavailable {
    /// The scene lacks what the analysis needs.
    Lacks(Analysis),
    /// In a sentence.
    Because(String),
}

/// The linear solution of a scene.
fn linear(scene: &Scene) -> Result<LinearSolution, Unavailable> {
    let analysis = Analysis::LinearSolution;
    match analysis.lack(scene) {
        Some(_) => Err(Unavailable::Lacks(analysis)),
        None => LinearSolution::of_scene(scene).map_err(Unavailable::Because),
    }
}

/// Result of a run.
#[derive(Clone, Debug)]
pub(crate) struct MethodRun {
    pub(crate) outcome: &'static str,
    /// Contacts, the last included, and the state just before that.
    pub(crate) bounces: u64,
    pub(crate) state: State,
    pub(crate) steps: u64,
    pub(crate) evaluations: Option<u64>,
}

/// A scene, made ready for all methods.
pub(crate) struct Subject<'a> {
    scene: &'a Scene,
    bounces: u64,
    model: Body,
    linear: Result<LinearSolution, Unavailable>,
    reference: ReferenceRun,
    state: State<DoubleDouble>,
}

impl<'a> Subject<'a> {
    pub(crate) fn new(scene: &'a Scene, bounces: u64, slice: &TimeSlice) -> Result<Self, Cancelled> {
        let zero = DoubleDouble::from_f64(0.0);
        let mut state = State { theta: zero, x_dot: zero, y_dot: zero, theta_dot: zero };
        let mut reference = ReferenceRun { outcome: Ending::Completed.name(), bounces: 0, t: 0.0, rounding: 0.0 };
        let ending = run_extended(scene, bounces, |contact| {
            state = contact.state;
            (reference.bounces, reference.t) = (contact.n, contact.t.to_f64());
            !contact.n.is_multiple_of(CHECK_INTERVAL) || slice.should_continue()
        });
        slice.check()?;
        reference.outcome = ending.map_or("diverged", Ending::name);
        let mut subject = Self { scene, bounces, model: scene.model(), linear: linear(scene), reference, state };
        let size = subject.size(&[state.theta, state.x_dot, state.y_dot, state.theta_dot].map(DoubleDouble::to_f64));
        subject.reference.rounding = f64::EPSILON * size;
        Ok(subject)
    }

    pub(crate) fn reference(&self) -> ReferenceRun {
        self.reference
    }

    /// Distance of a state from the reference's last one.
    pub(crate) fn error(&self, state: &State) -> f64 {
        let State { theta, x_dot, y_dot, theta_dot } = self.state;
        let off = |exact: DoubleDouble, value: f64| (exact - DoubleDouble::from_f64(value)).to_f64();
        let ours = *state;
        self.size(&[
            off(theta, ours.theta),
            off(x_dot, ours.x_dot),
            off(y_dot, ours.y_dot),
            off(theta_dot, ours.theta_dot),
        ])
    }

    /// The largest part, as a length or a velocity; a point mass has velocities only.
    fn size(&self, &[theta, x_dot, y_dot, theta_dot]: &[f64; 4]) -> f64 {
        let rho = if self.model.is_point { 0.0 } else { self.model.rod.radius_of_gyration };
        let parts = [rho * theta, x_dot, y_dot, rho * theta_dot].map(f64::abs);
        if parts.iter().any(|part| part.is_nan()) { f64::NAN } else { parts.into_iter().fold(0.0, f64::max) }
    }

    /// One run for its result; a reason where there is none.
    pub(crate) fn run(
        &self,
        kind: MethodKind,
        setting: Option<MethodSetting>,
        slice: &TimeSlice,
    ) -> Result<Result<MethodRun, Unavailable>, Cancelled> {
        slice.check()?;
        Ok(match kind {
            MethodKind::Map => self.map(self.rules()),
            MethodKind::MapFree => self.map(self.free()),
            MethodKind::Extended => Ok(MethodRun {
                outcome: self.reference.outcome,
                bounces: self.reference.bounces,
                state: State { theta: 0.0, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 },
                steps: self.reference.bounces,
                evaluations: None,
            }),
            MethodKind::Linear => self.linear.clone().map(|mut solution| MethodRun {
                outcome: Ending::Completed.name(),
                bounces: self.bounces,
                state: solution
                    .nth((self.bounces as usize).saturating_sub(1))
                    .map_or_else(State::default, |impact| impact.state),
                steps: self.bounces,
                evaluations: Some(self.bounces),
            }),
            MethodKind::Integrator(integrator) => match self.lacks(integrator) {
                None => Ok(self.simulated(with_setting(integrator, setting), slice)?),
                Some(lack) => Err(lack),
            },
        })
    }

    /// The run for the clock, without preparation, counting or recording.
    pub(crate) fn race(&self, kind: MethodKind, setting: Option<MethodSetting>, cancel: &CancelFlag) {
        match kind {
            MethodKind::Map => _ = black_box(self.bounce(self.rules(), |_| ())),
            MethodKind::MapFree => _ = black_box(self.bounce(self.free(), |_| ())),
            MethodKind::Extended => {
                _ = black_box(run_extended(self.scene, self.bounces, |contact| {
                    black_box(contact.n) > 0 && !cancel.is_set()
                }))
            }
            MethodKind::Linear => {
                if let Ok(solution) = &self.linear {
                    solution.take(self.bounces as usize).for_each(|impact| _ = black_box(impact));
                }
            }
            MethodKind::Integrator(integrator) => {
                if self.lacks(integrator).is_none() {
                    let method = with_setting(integrator, setting);
                    _ = black_box(self.simulate(method, &mut || !cancel.is_set()));
                }
            }
        }
    }

    /// The rules that every method has; only the map checks the limits and the ends of the table.
    fn rules(&self) -> Rules {
        Rules { limits: None, half_length: f64::INFINITY, ..self.scene.rules() }
    }

    fn free(&self) -> Rules {
        Rules { holds_energy: false, ..self.rules() }
    }

    fn map(&self, rules: Rules) -> Result<MethodRun, Unavailable> {
        let parameters = self.model.rod;
        let mut evaluations = 0;
        let last = self.bounce(rules, |contact| {
            let flight = contact.strike.filter(|strike| strike.contact_rise > 0.0);
            evaluations += flight.map_or(0, |strike| {
                contact_time::evaluations(&Flight { drag: self.model.drag, ..parameters.flight(&strike) })
            });
        });
        let (bounces, state, outcome) =
            last.ok_or_else(|| Unavailable::Because("the first contact is not found".to_owned()))?;
        Ok(MethodRun { outcome, bounces, state, steps: bounces, evaluations: Some(evaluations) })
    }

    /// The map from the release on: number and state of the last contact, and how it ended.
    #[inline]
    fn bounce(&self, rules: Rules, mut visit: impl FnMut(&orbit::Contact)) -> Option<(u64, State, &'static str)> {
        let mut orbit = Orbit::new(self.model, rules, self.scene.release()).ok()?;
        let (mut n, mut state) = (0, *orbit.state());
        let ending = orbit::run(&mut orbit, self.bounces, |contact| {
            (n, state) = (contact.n, contact.state);
            visit(contact);
            true
        })?;
        Some((n, state, ending.name()))
    }

    /// The need of a general method that the scene does not meet, if there is one.
    fn lacks(&self, integrator: Integrator) -> Option<Unavailable> {
        let analysis = match integrator {
            Integrator::Penalty { .. } => Analysis::PenaltySimulation,
            _ => Analysis::Simulation,
        };
        analysis.lack(self.scene).map(|_| Unavailable::Lacks(analysis))
    }

    fn simulate(&self, method: Integrator, go_on: &mut dyn FnMut() -> bool) -> Option<Simulation> {
        let (rules, release) = (self.rules(), self.scene.release());
        let most = limits::PRECISION_STEPS;
        simulate(method, (&self.model, &rules, release), self.bounces, most, go_on)
    }

    fn simulated(&self, method: Integrator, slice: &TimeSlice) -> Result<MethodRun, Cancelled> {
        let simulation = self.simulate(method, &mut || slice.should_continue()).ok_or(Cancelled)?;
        let last = simulation.impacts.last();
        let work = simulation.work;
        Ok(MethodRun {
            outcome: simulation.ending.name(),
            bounces: last.map_or(0, |impact| impact.n),
            state: last.map_or(self.scene.release().state, |impact| impact.state),
            steps: work.steps,
            evaluations: Some(work.accelerations + work.gaps),
        })
    }
}

fn run_extended(scene: &Scene, bounces: u64, visit: impl FnMut(&orbit::ExtendedContact) -> bool) -> Option<Ending> {
    // General methods look neither at other vertices nor at the limits of the table.
    let mut orbit =
        Orbit::new(Body { outline: None, ..scene.body_in() }, Rules { limits: None, ..scene.rules() }, scene.release())
            .ok()?;
    orbit::run(&mut orbit, bounces, visit)
}

fn with_setting(integrator: Integrator, setting: Option<MethodSetting>) -> Integrator {
    integrator.with(setting.map_or(f64::NAN, |setting| setting.value))
}
