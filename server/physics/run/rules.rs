//! The rules of a run: every reason to end it and the order in which they are checked, written once.
//!
//! Runs of the map ([`crate::run::orbit`]), in doubles or with 31 digits, and of general simulation methods differ in their numbers and
//! flights. They ask the same three functions: [`Rules::before_strike`], [`Rules::after_strike`] and [`Rules::after_flight`]. A check that needs a
//! new quantity is a new argument, so the compiler asks each kind of run for it. Lanes ([`crate::run::lanes`]) have a formula for each kind of
//! ending that surely excludes it. The table of `docs/physics.md`, section 5, is in the order of the checks.

use crate::map::body::{NoContact, Touch};
use crate::map::strike::Rebound;
use crate::map::table::actuator_load::{ActuatorLimits, ActuatorLoad};
use crate::run::ending::Ending;

/// A run that loses energy has settled (Zeno) when a flight is shorter than this share of its first.
pub const SETTLED_SHARE: f64 = 1e-9;

/// Fastest speed, m/s, of the centre of gravity or of the contact point about it, that a run may reach: beyond it
/// doubles no longer resolve a flight, and only a wrong energy feedback gets there.
pub const SPEED_LIMIT: f64 = 1e6;

/// Settings that decide, beside the physics, when a run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// |θ| at which a contact counts as toppled, rad; infinite for a body without an angle.
    pub topple_angle: f64,
    /// True where strikes take energy away, always or at times, so that a run can settle.
    pub settles: bool,
    /// True where rounding is kept off the energy ([`crate::run::orbit::Orbit`]). It is not where a settling run loses energy to
    /// G l (1 − cos θ).
    pub holds_energy: bool,
    /// Limits of the table, if it has any.
    pub limits: Option<ActuatorLimits>,
    /// Half the length of the table, m; infinite if it has no ends.
    pub half_length: f64,
}

impl Rules {
    /// The ending of a run before the strike of a contact at the angle `theta` (rad), if it ends there: another vertex than the one that bounces
    /// is below the line of the tilted table, |θ| has reached the topple angle, the contact point is beyond an end of the table, the strike needs
    /// more of the table than its limits allow, or the contact point does not approach the moving table.
    ///
    /// `push` and `approach` (m/s) are those of [`crate::map::strike::Strike`]. The place of the contact point along x from the middle of the table
    /// (m) is asked for only on a table with ends, and the load only on one with limits.
    #[inline(always)]
    pub fn before_strike(
        &self,
        theta: f64,
        [push, approach]: [f64; 2],
        touch: impl FnOnce() -> Option<Touch>,
        contact_place: impl FnOnce() -> f64,
        load: impl FnOnce() -> ActuatorLoad,
    ) -> Option<Ending> {
        if let Some(touch) = touch() {
            return Some(Ending::OtherVertex(touch));
        }
        let toppled = self.toppled(theta);
        if toppled.is_some() {
            return toppled;
        }
        let limit = self.half_length;
        if limit != f64::INFINITY {
            let place = contact_place();
            if place.abs() > limit {
                return Some(Ending::OffTable { place, limit });
            }
        }
        if let Some(limits) = &self.limits
            && let Some(violation) = limits.exceeded(&load())
        {
            return Some(Ending::BeyondLimits(violation));
        }
        (push >= 0.0).then_some(Ending::Separating { approach })
    }

    /// The ending of a run between a strike at time `t` (s) and its flight, if it ends there: a speed is beyond [`SPEED_LIMIT`] or has overflowed, or
    /// the contact point does not rise (m/s) but for rounding: a dead stop, or no next contact from above.
    #[inline(always)]
    pub fn after_strike(
        &self,
        t: f64,
        speed_squared: f64,
        [rise, rounding]: [f64; 2],
        rebound: impl FnOnce() -> Rebound,
    ) -> Option<Ending> {
        if speed_squared.is_nan() || speed_squared > SPEED_LIMIT * SPEED_LIMIT {
            return Some(Ending::Diverged { speed: speed_squared.sqrt() });
        }
        if rise > rounding {
            return None;
        }
        let rebound = rebound();
        Some(if self.settles && rebound.has_stopped() {
            Ending::Settled { flight_time: 0.0, settle_time: t }
        } else {
            Ending::Sinking { contact_rise: rebound.rise.min(0.0) }
        })
    }

    /// The ending of a run in the flight after a strike, if it ends there: the flight meets no table, since it sinks, misses the planned table,
    /// passes the work limit, or another vertex comes first; or it is too short beside the first, since bounces have died out (Zeno).
    ///
    /// `flight` is its length, s. `time_after` is the time so many seconds after the contact.
    #[inline(always)]
    pub fn after_flight(
        &self,
        flight: Result<f64, NoContact>,
        flights: &mut FlightTimes,
        [contact_rise, speed_squared]: [f64; 2],
        rebound: impl FnOnce() -> Rebound,
        time_after: impl FnOnce(f64) -> f64,
    ) -> Option<Ending> {
        let flight_time = match flight {
            Ok(flight_time) => flight_time,
            Err(no_contact) => return Some(no_contact.ending(contact_rise, speed_squared.sqrt())),
        };
        if !self.settles {
            return None;
        }
        if flights.first == 0.0 {
            flights.first = flight_time;
        }
        let is_short = flight_time < SETTLED_SHARE * flights.first;
        (is_short && rebound().is_slow()).then(|| {
            // By the geometric series of the flights.
            let ratio = flight_time / flights.last;
            let rest = if ratio < 1.0 { flight_time / (1.0 - ratio) } else { flight_time };
            Ending::Settled { flight_time, settle_time: time_after(rest) }
        })
    }

    /// The ending of a run whose angle, rad, has reached the topple angle.
    #[inline(always)]
    pub fn toppled(&self, theta: f64) -> Option<Ending> {
        let limit = self.topple_angle;
        (theta.abs() >= limit).then_some(Ending::Toppled { theta, limit })
    }

    /// The map alone: nothing but what the physics itself forbids ends a run, and nothing is corrected.
    pub const BARE_MAP: Self = Self {
        topple_angle: f64::INFINITY,
        settles: false,
        holds_energy: false,
        limits: None,
        half_length: f64::INFINITY,
    };
}

/// [`Ending::Completed`] at the contact with the last number asked for; checked when nothing else has ended the run.
#[inline(always)]
pub fn completed(n: u64, impacts: u64) -> Option<Ending> {
    (n >= impacts).then_some(Ending::Completed)
}

/// ẋ² + ẏ² + l²θ̇² after a strike, m²/s²; `spin` is lθ̇.
#[inline(always)]
pub fn speed_squared(x_dot: f64, y_dot: f64, spin: f64) -> f64 {
    x_dot * x_dot + y_dot * y_dot + spin * spin
}

/// Lengths of the flights by which a run that can settle is judged, s; 0 until there is one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlightTimes {
    /// The first flight of the run.
    pub first: f64,
    /// The flight before the present one.
    pub last: f64,
}
