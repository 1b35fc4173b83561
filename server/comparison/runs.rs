//! One run of one method, for its result or for the clock. Not here: which methods and settings there are.

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

use crate::comparison::methods::{IntegratorKind, MethodKind, MethodSetting};
use crate::compute::{CancelFlag, Cancelled, TimeSlice};
use crate::integrators;
use crate::integrators::simulate;
use crate::limits;

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
            MethodKind::Linear => self.linear.clone().map(|solution| MethodRun {
                outcome: Ending::Completed.name(),
                bounces: self.bounces,
                state: solution.impact(self.bounces).state,
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
                    (1..=self.bounces).for_each(|n| _ = black_box(solution.impact(n)));
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
    fn lacks(&self, integrator: IntegratorKind) -> Option<Unavailable> {
        let analysis =
            if integrator == IntegratorKind::Penalty { Analysis::PenaltySimulation } else { Analysis::Simulation };
        analysis.lack(self.scene).map(|_| Unavailable::Lacks(analysis))
    }

    fn simulate(
        &self,
        method: integrators::Integrator,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<integrators::Simulation> {
        let (rules, release) = (self.rules(), self.scene.release());
        let most = limits::PRECISION_STEPS;
        simulate(method, (&self.model, &rules, release), self.bounces, most, go_on)
    }

    fn simulated(&self, method: integrators::Integrator, slice: &TimeSlice) -> Result<MethodRun, Cancelled> {
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

fn with_setting(integrator: IntegratorKind, setting: Option<MethodSetting>) -> integrators::Integrator {
    integrator.with(setting.map_or(f64::NAN, |setting| setting.value))
}
