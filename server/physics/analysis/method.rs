//! How a run is computed: by the linear solution, the map in doubles, or the map with 31 digits; and whether doubles are accurate enough.

use crate::analysis::linear_solution::{LinearImpact, LinearSolution, lacking};
use crate::map::body::PreImpact;
use crate::map::strike::State;
use crate::numbers::double_double::DoubleDouble;
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::run::error_estimate::{ErrorEstimate, run_with_bounds};
use crate::run::orbit::{ComingContact, Contact, ExtendedContact, ExtendedOrbit, Orbit, run};
use crate::run::rules;
use crate::run::rules::Rules;
use crate::scene::Scene;
use crate::scene::capability::{Analysis, Lack};

/// Method by which a run is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunMethod {
    /// [`crate::analysis::linear_solution`].
    Linear,
    /// [`crate::run::orbit`].
    Map,
    /// [`crate::run::orbit::ExtendedOrbit`].
    Extended,
}

names!(RunMethod: Linear => "linear", Map => "map", Extended => "extended");

/// One impact of a run by some method.
#[derive(Clone, Copy, Debug)]
pub struct ComputedImpact<'a> {
    /// In doubles.
    pub contact: Contact,
    /// Bound on the largest of |ρδθ| (m), |δẋ|, |δẏ| and |ρδθ̇| (m/s) just before it; infinite where nothing is known.
    pub error_estimate: f64,
    /// All its digits and the orbit that it is of, where the method has more than doubles.
    pub extended: Option<(&'a ExtendedOrbit, &'a ExtendedContact)>,
}

/// A method whose error estimate holds a tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodChoice {
    /// Which.
    pub method: RunMethod,
    /// Largest error estimate over the run, m/s.
    pub error_estimate: f64,
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

/// The map in doubles, or else with 31 digits, if its error estimate is at most `tolerance` (m/s, as the estimates are) at each of the first
/// `impacts` impacts, or up to the end of the run; or why neither is.
///
/// `go_on` is asked now and then; a `false` gives none.
pub fn choose_method(
    scene: &Scene,
    impacts: u64,
    tolerance: f64,
    mut go_on: impl FnMut() -> bool,
) -> Option<Result<MethodChoice, NoMethod>> {
    let (mut said, mut horizon) = (Vec::new(), 0);
    for method in [RunMethod::Map, RunMethod::Extended] {
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
        let name = method.name();
        match (run, lost) {
            (Err(why), _) => said.push(format!("{name} does not apply: {why}")),
            (Ok(_), Some(last)) => {
                horizon = horizon.max(last);
                said.push(format!("{name} holds {tolerance:e} m/s for {last} impacts"));
            }
            (Ok(None), None) => return None,
            (Ok(Some(_)), None) => {
                said.push(format!("the error estimate of {name} is at most {largest:.1e} m/s"));
                return Some(Ok(MethodChoice { method, error_estimate: largest, reason: said.join("; ") }));
            }
        }
    }
    let fewer = if horizon > 0 { format!("ask for at most {horizon} impacts, or ") } else { String::new() };
    let detail = format!(
        "no method holds a tolerance of {tolerance:e} m/s over {impacts} impacts: {}; {fewer}tolerate more",
        said.join("; ")
    );
    Some(Err(NoMethod { horizon, detail }))
}

/// Runs the scene by a method: visits impact after impact up to number `impacts`, or to the end of the run. The visitor may
/// stop it by returning `false`, and then there is no ending.
/// Fails with the reason, in a sentence, for which the method does not apply.
pub fn run_by(
    scene: &Scene,
    method: RunMethod,
    impacts: u64,
    mut visit: impl FnMut(&ComputedImpact<'_>) -> bool,
) -> Result<Option<Ending>, String> {
    match method {
        RunMethod::Linear => match Analysis::LinearRun.lack(scene) {
            Some(Lack { path, .. }) => Err(lacking(path)),
            None => Ok(run_linear(scene, LinearSolution::of_scene(scene)?, impacts, visit)),
        },
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
            let rod = orbit;
            let mut estimate = ErrorEstimate::of_extended_run(scene, orbit.t().to_f64());
            Ok(run(&mut orbit, impacts, |contact| {
                let error_estimate = estimate.bound();
                estimate.pass(contact);
                let rounded = contact.map(DoubleDouble::to_f64);
                visit(&ComputedImpact { contact: rounded, error_estimate, extended: Some((&rod, contact)) })
            }))
        }
    }
}

/// The linear solution knows no end of a run; those of the map are looked for at its states. Its error is at most the distance from the map's
/// run beside it and the error of that.
fn run_linear(
    scene: &Scene,
    solution: LinearSolution,
    impacts: u64,
    mut visit: impl FnMut(&ComputedImpact<'_>) -> bool,
) -> Option<Ending> {
    let (body, rules) = (scene.running_model(), Rules { topple_angle: scene.topple_angle(), ..Rules::BARE_MAP });
    let rho = body.rod.radius_of_gyration;
    let mut beside = scene.orbit().ok().map(|orbit| (orbit, ErrorEstimate::of_scene(scene, orbit.t())));
    let mut following = solution.skip(1);
    for (n, LinearImpact { t, x, state }) in (1..).zip(solution) {
        let coming = ComingContact { t, coming: PreImpact::at(n, x, state), before: None };
        let contact = Orbit::under_way(body, rules, &coming).advance();
        let ending = contact.ending.or_else(|| rules::completed(n, impacts));
        let bound = beside.as_ref().map_or(f64::INFINITY, |(orbit, estimate)| {
            let State { theta, x_dot, y_dot, theta_dot } = *orbit.state();
            let apart = [
                rho * (state.theta - theta),
                state.x_dot - x_dot,
                state.y_dot - y_dot,
                rho * (state.theta_dot - theta_dot),
            ];
            apart.into_iter().fold(0.0, |most: f64, part| most.max(part.abs())) + estimate.bound()
        });
        // Too near to an end to say on which side of it the run is.
        let margin = contact.strike.map_or(0.0, |strike| strike.contact_rise.min(-strike.approach));
        let safe = state.theta.abs() < 0.5 * scene.topple_angle() && 10.0 * bound < margin;
        let contact = Contact {
            flight_time: following.next().filter(|_| ending.is_none()).map(|next| next.t - t),
            ending,
            ..contact
        };
        let error_estimate = if safe { bound } else { f64::INFINITY };
        if !visit(&ComputedImpact { contact, error_estimate, extended: None }) {
            return None;
        }
        if ending.is_some() {
            return ending;
        }
        beside = beside.and_then(|(mut orbit, mut estimate)| {
            let contact = orbit.advance();
            estimate.pass(&contact);
            contact.flight_time.map(|_| (orbit, estimate))
        });
    }
    None
}
