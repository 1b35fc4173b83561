//! Motion in lasting contact: after the last strike the contact point stays on the table, and the body slides, sticks or rocks.
//!
//! The contact point stays at the table's height; the table tilts about it. Between strikes a run is made of flights
//! ([`crate::run`]); here it is the solution of an ordinary differential equation, by a library's Runge-Kutta method of order 8.
//!
//! Kinds of contact: without friction the contact point slides. On a table with `slide: matched`, which moves along
//! itself with the contact point at each strike, the force is the limit of such strikes: F along the table does not accelerate the
//! contact point along it, and is at most μN. On a table that does not move along itself the contact slides with F = ∓μN until the
//! contact point rests, then sticks while |F| ≤ μN. A contact that sticks is not held by tilting: the table may balance it as a cart
//! balances a pole ([`HoldLaw::CartPole`]).

mod equations;
mod follow;
mod moment;
mod request;
mod work;

pub use equations::{ContactMotion, TangentialForce};
pub use request::{
    ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest, HoldSample, LONGEST_HOLD, MOST_SAMPLES, Motion, moving_rate,
    rest_of_run, work_of_rest,
};

use follow::follow;
use work::Work;

/// Absolute and relative tolerance of the integrator, per step.
const TOLERANCE: f64 = 1e-12;

/// Tolerance of the second solution, whose difference from the first bounds the error.
const ROUGH_TOLERANCE: f64 = 1e-10;

/// Follows a body in contact. `go_on` is asked now and then; the motion ends as [`HoldEnding::Stopped`] once it says `false`, and as
/// [`HoldEnding::TooLong`] once its work is used up.
pub fn hold(request: &HoldRequest, go_on: &mut dyn FnMut() -> bool) -> Hold {
    let request = &HoldRequest { duration: request.duration.clamp(0.0, LONGEST_HOLD), ..*request };
    let fine = follow(request, TOLERANCE, &mut Work::new(request, go_on));
    if fine.ending == HoldEnding::Stopped {
        return fine;
    }
    let rough = follow(request, ROUGH_TOLERANCE, &mut Work::new(request, go_on));
    if rough.ending == HoldEnding::Stopped {
        return rough;
    }
    let error_bound = fine.distance(&rough, request.body.rod.radius_of_gyration);
    Hold { error_bound, ..fine }
}

impl HoldSample {
    /// Largest of |δx|, |ρδθ|, |δẋ|, |ρδθ̇| to another sample.
    fn distance(&self, other: &Self, radius_of_gyration: f64) -> f64 {
        let angles = (self.theta - other.theta).abs().max((self.theta_dot - other.theta_dot).abs());
        let places = (self.x - other.x).abs().max((self.x_dot - other.x_dot).abs());
        places.max(radius_of_gyration * angles)
    }
}

impl Hold {
    /// Largest difference between the samples of two solutions; infinite if they do not end alike.
    fn distance(&self, other: &Self, radius_of_gyration: f64) -> f64 {
        let (Some(end), Some(others)) = (self.samples.last(), other.samples.last()) else { return f64::INFINITY };
        if !self.ending.is_alike(&other.ending) {
            return f64::INFINITY;
        }
        // The last samples are at the ends, which differ in time.
        let even = self.samples.len().min(other.samples.len()).saturating_sub(1);
        let pairs = self.samples.iter().zip(&other.samples).take(even).chain([(end, others)]);
        pairs.map(|(one, other)| one.distance(other, radius_of_gyration)).fold(0.0, f64::max)
    }
}
