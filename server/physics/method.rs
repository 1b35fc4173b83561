//! Which method is the cheapest that is accurate enough for a run: the linear solution, the map in doubles, or the map with 31
//! digits.
//!
//! A pure function: costs come from a table and not from a clock, so that the same question always gets the same answer.
//! Whether a method is accurate enough is its own bound's to say.

use crate::impact::State;
use crate::map::Body;
use crate::scene::Scene;
use crate::stability::Class;

/// How a run is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`crate::linear`].
    Linear,
    /// [`crate::map`].
    Map,
    /// [`crate::extended`].
    Extended,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Map, Self::Extended];

    /// Its name in requests and answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Map => "map",
            Self::Extended => "extended",
        }
    }

    /// What the states at so many impacts cost with their error estimates, in microseconds of one core as it was when this table
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

/// The method chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Which.
    pub method: Method,
    /// Its largest error estimate over the run, m/s.
    pub error_estimate: f64,
    /// What it costs, microseconds of the table.
    pub cost_us: f64,
    /// The next dearer one that applies and its cost, if there is one.
    pub next: Option<(Method, f64)>,
    /// Why, in a sentence.
    pub reason: String,
}

/// No method holds the tolerance over the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Up to which impact the best method holds it.
    pub horizon: u64,
    /// What it says, in a sentence.
    pub detail: String,
}

/// How far a method holds a tolerance.
enum Reach {
    /// Over all impacts, with this largest bound.
    All(f64),
    /// Up to this impact, at most.
    Until(u64),
    /// It does not apply.
    None(String),
}

impl Scene {
    /// The cheapest method whose error estimate is at most `tolerance` (m/s, as the estimates are) at each of the first
    /// `impacts` impacts, or up to the end of the run; or why there is none.
    ///
    /// `go_on` is asked now and then; a `false` gives none.
    pub fn choose_method(
        &self,
        impacts: u64,
        tolerance: f64,
        mut go_on: impl FnMut() -> bool,
    ) -> Option<Result<Choice, Refusal>> {
        let mut methods = Method::ALL;
        methods.sort_by(|one, other| one.cost_us(impacts).total_cmp(&other.cost_us(impacts)));
        let (mut failed, mut horizon) = (Vec::new(), 0);
        for (index, method) in methods.into_iter().enumerate() {
            match self.reach(method, impacts, tolerance, &mut go_on)? {
                Reach::All(error_estimate) => {
                    let next = methods[index + 1..].iter().find(|dearer| **dearer != Method::Linear || self.circles());
                    failed.push(format!("the error estimate of {} is at most {error_estimate:.1e} m/s", method.name()));
                    return Some(Ok(Choice {
                        method,
                        error_estimate,
                        cost_us: method.cost_us(impacts),
                        next: next.map(|dearer| (*dearer, dearer.cost_us(impacts))),
                        reason: failed.join("; "),
                    }));
                }
                Reach::Until(last) => {
                    horizon = horizon.max(last);
                    failed.push(format!("{} holds {tolerance:e} m/s for {last} impacts", method.name()));
                }
                Reach::None(why) => failed.push(format!("{} does not apply: {why}", method.name())),
            }
        }
        let fewer = if horizon > 0 { format!("ask for at most {horizon} impacts, or ") } else { String::new() };
        let detail = format!(
            "no method holds a tolerance of {tolerance:e} m/s over {impacts} impacts: {}; {fewer}tolerate more",
            failed.join("; ")
        );
        Some(Err(Refusal { horizon, detail }))
    }

    /// Whether small deviations circle: elsewhere the linear solution is soon off, and its bound costs as much as a run.
    fn circles(&self) -> bool {
        self.fixed_point()
            .is_ok_and(|point| self.linear(&point).class == Class::Elliptic && self.linear(&point).residue.is_some())
    }

    fn reach(&self, method: Method, impacts: u64, tolerance: f64, go_on: &mut impl FnMut() -> bool) -> Option<Reach> {
        let lost = || Some(Reach::None("the first contact is not found".to_owned()));
        match method {
            Method::Linear => self.linear_reach(impacts, tolerance, go_on),
            Method::Map => {
                let Ok(mut orbit) = self.orbit() else { return lost() };
                let mut estimate = self.error_estimate(orbit.t());
                follow(impacts, tolerance, go_on, || {
                    let bound = estimate.bound();
                    let contact = orbit.advance();
                    estimate.pass(&contact);
                    (bound, contact.flight_time.is_some())
                })
            }
            Method::Extended => {
                let Ok(mut orbit) = self.extended_orbit() else { return lost() };
                let first = orbit.t().to_f64();
                let mut estimate = self.extended_error_estimate(first);
                follow(impacts, tolerance, go_on, || {
                    let bound = estimate.bound();
                    let contact = orbit.advance();
                    estimate.pass_extended(&contact);
                    (bound, contact.flight_time.is_some())
                })
            }
        }
    }

    fn linear_reach(&self, impacts: u64, tolerance: f64, go_on: &mut impl FnMut() -> bool) -> Option<Reach> {
        if !self.circles() {
            return Some(Reach::None("small deviations do not circle about a fixed point".to_owned()));
        }
        let solution = match self.linear_solution() {
            Ok(solution) => solution,
            Err(why) => return Some(Reach::None(why)),
        };
        let body = self.model();
        let mut n = 0;
        follow(impacts, tolerance, go_on, || {
            n += 1;
            let impact = solution.impact(n);
            // The linear solution knows no end of a run: it has to stay away from every one.
            let State { theta, .. } = impact.state;
            let strike = Body::strike(&body, &impact.state);
            let margin = (strike.contact_rise).min(-strike.approach);
            let safe = theta.abs() < 0.5 * self.topple_angle && 10.0 * impact.error_estimate < margin;
            (if safe { impact.error_estimate } else { f64::INFINITY }, true)
        })
    }
}

/// Asks for the bounds of one impact after the other, each with whether the run goes on.
fn follow(
    impacts: u64,
    tolerance: f64,
    go_on: &mut impl FnMut() -> bool,
    mut next: impl FnMut() -> (f64, bool),
) -> Option<Reach> {
    let mut largest = 0.0;
    for n in 0..impacts {
        if n.is_multiple_of(1024) && !go_on() {
            return None;
        }
        let (bound, flies) = next();
        if bound.is_nan() || bound > tolerance {
            return Some(Reach::Until(n));
        }
        largest = f64::max(largest, bound);
        if !flies {
            break;
        }
    }
    Some(Reach::All(largest))
}
