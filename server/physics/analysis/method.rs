//! Which method is the cheapest that is accurate enough for a run: the linear solution, the map in doubles, or the map with 31
//! digits.
//!
//! A pure function: costs come from a table and not from a clock, so that the same question always gets the same answer.
//! The bound of a method says whether it is accurate enough.

use crate::analysis::linear_solution::{LinearSolution, lacking};
use crate::analysis::linear_verdict::AngleClass;
use crate::analysis::small_deviations::small_deviations;
use crate::map::body::PreImpact;
use crate::map::strike::State;
use crate::numbers::double_double::DoubleDouble;
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::run::error_estimate::{ErrorEstimate, run_with_bounds};
use crate::run::extended;
use crate::run::orbit::{Contact, run};
use crate::run::rules;
use crate::run::rules::{FlightTimes, RodContact, Rules};
use crate::scene::Scene;
use crate::scene::capability::{Analysis, Lack};

/// Method by which a run is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunMethod {
    /// [`crate::analysis::linear_solution`].
    Linear,
    /// [`crate::run::orbit`].
    Map,
    /// [`crate::run::extended`].
    Extended,
}

names!(RunMethod: Linear => "linear", Map => "map", Extended => "extended");

impl RunMethod {
    /// Cost of the states at so many impacts with their error estimates, in microseconds of one core as it was when this table
    /// was measured (AMD EPYC, Zen 4, 3.0 GHz).
    pub fn cost_us(self, impacts: u64) -> f64 {
        let (once, each) = match self {
            Self::Linear => (40.0, 0.1),
            Self::Map => (0.0, 0.5),
            Self::Extended => (0.0, 2.0),
        };
        once + each * impacts as f64
    }
}

/// One impact of a run by some method.
#[derive(Clone, Copy, Debug)]
pub struct ComputedImpact<'a> {
    /// In doubles.
    pub contact: Contact,
    /// Bound on the largest of |ρδθ| (m), |δẋ|, |δẏ| and |ρδθ̇| (m/s) just before it; infinite where nothing is known.
    pub error_estimate: f64,
    /// All its digits and the orbit that it is of, where the method has more than doubles.
    pub extended: Option<(&'a extended::ExtendedOrbit, &'a extended::ExtendedContact)>,
}

/// The method chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodChoice {
    /// Which.
    pub method: RunMethod,
    /// Largest error estimate over the run, m/s.
    pub error_estimate: f64,
    /// Cost by the table, µs.
    pub cost_us: f64,
    /// The next more expensive method that applies, and its cost, µs.
    pub next: Option<(RunMethod, f64)>,
    /// Reason, in a sentence.
    pub reason: String,
}

/// No method holds the tolerance over the run.
#[derive(Clone, Debug, PartialEq)]
pub struct NoMethod {
    /// Up to which impact the best method holds it.
    pub horizon: u64,
    /// Reason, in a sentence.
    pub detail: String,
}

/// Reach of a method within a tolerance.
enum MethodReach {
    /// Over all impacts, with this largest bound.
    All(f64),
    /// Up to this impact, at most.
    Until(u64),
    /// It does not apply.
    None(String),
}

/// The cheapest method whose error estimate is at most `tolerance` (m/s, as the estimates are) at each of the first
/// `impacts` impacts, or up to the end of the run; or why there is none.
///
/// `go_on` is asked now and then; a `false` gives none.
pub fn choose_method(
    scene: &Scene,
    impacts: u64,
    tolerance: f64,
    mut go_on: impl FnMut() -> bool,
) -> Option<Result<MethodChoice, NoMethod>> {
    let mut methods = RunMethod::ALL;
    methods.sort_by(|one, other| one.cost_us(impacts).total_cmp(&other.cost_us(impacts)));
    let (mut failed, mut horizon) = (Vec::new(), 0);
    for (index, method) in methods.into_iter().enumerate() {
        match reach(scene, method, impacts, tolerance, &mut go_on)? {
            MethodReach::All(error_estimate) => {
                let next = methods[index + 1..]
                    .iter()
                    .find(|dearer| **dearer != RunMethod::Linear || deviations_circle(scene));
                failed.push(format!("the error estimate of {} is at most {error_estimate:.1e} m/s", method.name()));
                return Some(Ok(MethodChoice {
                    method,
                    error_estimate,
                    cost_us: method.cost_us(impacts),
                    next: next.map(|dearer| (*dearer, dearer.cost_us(impacts))),
                    reason: failed.join("; "),
                }));
            }
            MethodReach::Until(last) => {
                horizon = horizon.max(last);
                failed.push(format!("{} holds {tolerance:e} m/s for {last} impacts", method.name()));
            }
            MethodReach::None(why) => failed.push(format!("{} does not apply: {why}", method.name())),
        }
    }
    let fewer = if horizon > 0 { format!("ask for at most {horizon} impacts, or ") } else { String::new() };
    let detail = format!(
        "no method holds a tolerance of {tolerance:e} m/s over {impacts} impacts: {}; {fewer}tolerate more",
        failed.join("; ")
    );
    Some(Err(NoMethod { horizon, detail }))
}

/// Tells whether small deviations circle, on a table for which the linear solution is derived: elsewhere it is soon off, and its bound
/// costs as much as a run.
pub fn deviations_circle(scene: &Scene) -> bool {
    Analysis::LinearSolution.lack(scene).is_none()
        && small_deviations(scene)
            .is_ok_and(|small| small.linear.class == AngleClass::Elliptic && small.linear.residue.is_some())
}

fn reach(
    scene: &Scene,
    method: RunMethod,
    impacts: u64,
    tolerance: f64,
    go_on: &mut impl FnMut() -> bool,
) -> Option<MethodReach> {
    if method == RunMethod::Linear && !deviations_circle(scene) {
        return Some(MethodReach::None("small deviations do not circle about a fixed point".to_owned()));
    }
    let (mut largest, mut lost) = (0.0, None);
    let run = run_by(scene, method, impacts, |impact| {
        let bound = impact.error_estimate;
        if bound.is_nan() || bound > tolerance {
            lost = Some(impact.contact.n - 1);
            return false;
        }
        largest = f64::max(largest, bound);
        !impact.contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    });
    match (run, lost) {
        (Err(why), _) => Some(MethodReach::None(why)),
        (Ok(_), Some(last)) => Some(MethodReach::Until(last)),
        (Ok(ending), None) => ending.map(|_| MethodReach::All(largest)),
    }
}

/// Runs the scene by a method: visits impact after impact up to number `impacts`, or to the end of the run. The visitor may
/// stop it by returning `false`, and then there is no ending.
///
/// # Errors
/// Reason for which the method does not apply, in a sentence.
pub fn run_by(
    scene: &Scene,
    method: RunMethod,
    impacts: u64,
    mut visit: impl FnMut(&ComputedImpact<'_>) -> bool,
) -> Result<Option<Ending>, String> {
    if method == RunMethod::Linear
        && let Some(Lack { path, .. }) = Analysis::LinearRun.lack(scene)
    {
        return Err(lacking(path));
    }
    match method {
        RunMethod::Linear => {
            let solution = LinearSolution::of_scene(scene)?;
            Ok(run_linear(scene, &solution, impacts, visit))
        }
        RunMethod::Map => {
            let orbit = match scene.orbit() {
                Ok(orbit) => orbit,
                Err(no_contact) => return Ok(Some(no_contact.ending(0.0, 0.0))),
            };
            let visit = |contact: &Contact, error_estimate| {
                visit(&ComputedImpact { contact: *contact, error_estimate, extended: None })
            };
            Ok(run_with_bounds(scene, &orbit, impacts, visit))
        }
        RunMethod::Extended => {
            let mut orbit = match scene.extended_orbit() {
                Ok(orbit) => orbit,
                Err(no_contact) => return Ok(Some(no_contact.ending(0.0, 0.0))),
            };
            let (rod, body) = (orbit, scene.running_model());
            let mut estimate = ErrorEstimate::of_extended_run(scene, orbit.t().to_f64());
            Ok(run(&mut orbit, impacts, |contact| {
                let error_estimate = estimate.bound();
                estimate.pass(contact);
                let clearance = contact.clearance.to_f64();
                let state = extended::in_doubles(&contact.state);
                let coming = PreImpact { clearance, ..PreImpact::at(contact.n, contact.x.to_f64(), state) };
                // A planned table is known to the run alone.
                let senses_otherwise = scene.noise.is_some() || scene.lag != 0.0;
                let strike = match contact.strike {
                    Some(strike) if senses_otherwise => strike.map(DoubleDouble::to_f64),
                    Some(_) | None => body.strike(&coming),
                };
                let rounded = Contact {
                    n: contact.n,
                    t: contact.t.to_f64(),
                    x: coming.x,
                    state: coming.state,
                    clearance,
                    alpha: if senses_otherwise { contact.alpha.to_f64() } else { strike.alpha },
                    strike: contact.strike.map(|_| strike),
                    flight_time: contact.flight_time.map(DoubleDouble::to_f64),
                    ending: contact.ending,
                };
                visit(&ComputedImpact { contact: rounded, error_estimate, extended: Some((&rod, contact)) })
            }))
        }
    }
}

/// The linear solution knows no end of a run; those of the map are looked for at its states.
fn run_linear(
    scene: &Scene,
    solution: &LinearSolution,
    impacts: u64,
    mut visit: impl FnMut(&ComputedImpact<'_>) -> bool,
) -> Option<Ending> {
    let body = scene.running_model();
    let mut next = solution.impact(1);
    for n in 1.. {
        let here = next;
        next = solution.impact(n + 1);
        let State { theta, .. } = here.state;
        let strike = body.strike(&PreImpact::at(n, here.x, here.state));
        let rounding = strike.rise_rounding(here.state.y_dot, f64::EPSILON);
        // The closed form has neither a limit of speed nor an end of its flights.
        let mut at = RodContact {
            rules: Rules { topple_angle: scene.topple_angle, ..Rules::BARE_MAP },
            theta,
            push: strike.push,
            approach: strike.approach,
            speed_squared: 0.0,
            rebound: strike.rebound(body.rod.contact_distance, rounding),
            t: 0.0,
            flight_time: f64::INFINITY,
            flights: FlightTimes::default(),
        };
        let ending = rules::before_strike(&mut at)
            .or_else(|| rules::after_strike(&mut at))
            .or_else(|| rules::after_flight(&mut at))
            .or_else(|| rules::completed(n, impacts));
        // Too near to an end to say on which side of it the run is.
        let margin = strike.contact_rise.min(-strike.approach);
        let safe = theta.abs() < 0.5 * scene.topple_angle && 10.0 * here.error_estimate < margin;
        let contact = Contact {
            n,
            t: here.t,
            x: here.x,
            state: here.state,
            clearance: 0.0,
            alpha: strike.alpha,
            strike: (strike.push < 0.0 && theta.abs() < scene.topple_angle).then_some(strike),
            flight_time: ending.is_none().then_some(next.t - here.t),
            ending,
        };
        let error_estimate = if safe { here.error_estimate } else { f64::INFINITY };
        if !visit(&ComputedImpact { contact, error_estimate, extended: None }) {
            return None;
        }
        if ending.is_some() {
            return ending;
        }
    }
    None
}
