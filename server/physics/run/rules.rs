//! The rules of a run: every reason to end it and the order in which they are checked, written once.
//!
//! Runs of the map ([`crate::run::orbit`]), in doubles or with 31 digits, of the linear solution
//! ([`crate::analysis::method`]) and of general simulation methods differ in their numbers and flights. Each gives the quantities of
//! [`Checked`]; [`ending_by`] makes each [`Check`] with them. Lanes ([`crate::run::lanes`]) give a [`LaneContact`]. A new reason to end a run is
//! a new check, and the compiler then asks for its formula here, for single runs and for lanes. If the formula needs a new quantity, the
//! compiler asks each kind of run for it. The table of `docs/physics.md`, section 5, is in the same order.

use crate::map::body::{NoContact, Touch};
use crate::map::strike::Rebound;
use crate::map::table::actuator_load::{ActuatorLimits, ActuatorLoad};
use crate::numbers::number::{Arithmetic, Mask};
use crate::run::ending::Ending;
use crate::run::settling::{SETTLED_SHARE, stay, time_to_rest};

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

/// Declares the checks, phase by phase, in the order in which they are made.
macro_rules! checks {
    ($($(#[$about:meta])* $phase:ident { $($(#[$doc:meta])* $check:ident,)* })*) => {
        /// A reason to end a run at a contact.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Check {
            $($($(#[$doc])* $check,)*)*
        }

        impl Check {
            /// All checks in their order.
            pub const ALL: &[Self] = &[$($(Self::$check,)*)*];
        }

        $(
            $(#[$about])*
            #[inline(always)]
            pub fn $phase(contact: &mut impl Checked) -> Option<Ending> {
                $(
                    let ending = ending_by(contact, Check::$check);
                    if ending.is_some() {
                        return ending;
                    }
                )*
                None
            }
        )*

        impl<N: Arithmetic> LaneContact<N> {
            /// Tells where a run surely goes on past all checks.
            #[inline(always)]
            pub(crate) fn passes_all(&self) -> N::Mask {
                N::Mask::all_are(true) $($(& self.passes(Check::$check))*)*
            }
        }
    };
}

checks! {
    /// The ending of a run before the strike of a contact, if it ends there.
    before_strike {
        /// Another vertex than the one that bounces is below the line of the tilted table.
        OtherVertex,
        /// |θ| has reached the topple angle.
        Toppled,
        /// The contact point is beyond an end of the table.
        OffTable,
        /// The strike needs more of the table than its limits allow.
        BeyondLimits,
        /// The contact point does not approach the moving table.
        Separating,
    }
    /// The ending of a run between a strike and its flight, if it ends there.
    after_strike {
        /// A speed is beyond [`SPEED_LIMIT`] or has overflowed.
        TooFast,
        /// The contact point does not rise but for rounding: a dead stop, or no next contact from above.
        NotRising,
    }
    /// The ending of a run in the flight after a strike, if it ends there.
    after_flight {
        /// The flight meets no table: it sinks, misses the planned table, passes the work limit, or another vertex comes first.
        NoContact,
        /// The flight is too short beside the first: bounces have died out (Zeno).
        ShortFlight,
    }
}

/// One run at a contact. The checks of a phase use only quantities that are known by then.
pub trait Checked {
    /// The rules of the run.
    fn rules(&self) -> &Rules;

    /// Time of the contact, s.
    fn t(&self) -> f64;

    /// Another vertex that is below the line of the tilted table, if there is one.
    fn touch(&self) -> Option<Touch>;

    /// θ at the contact, rad.
    fn theta(&self) -> f64;

    /// Place of the contact point along x, from the middle of the table, m. Only runs on a table with ends are asked for it.
    fn contact_place(&self) -> f64;

    /// Load of the strike on the table. Only runs with limits are asked for it, once at each contact.
    fn load(&mut self) -> ActuatorLoad;

    /// Same as in [`crate::map::strike::Strike`], m/s.
    fn push(&self) -> f64;

    /// Velocity of the contact point relative to the table along its normal, m/s.
    fn approach(&self) -> f64;

    /// Same as [`speed_squared`], after the strike.
    fn speed_squared(&self) -> f64;

    /// Vertical velocity of the contact point after the strike, m/s.
    fn contact_rise(&self) -> f64;

    /// Size of a rise that is rounding, m/s.
    fn rise_rounding(&self) -> f64;

    /// Rebound of the contact point from the strike.
    fn rebound(&self) -> Rebound;

    /// Reason for which the flight meets no table, if there is one.
    fn no_contact(&self) -> Option<NoContact>;

    /// Length of the flight, s.
    fn flight_time(&self) -> f64;

    /// Lengths of the flights by which the run is judged.
    fn flights(&mut self) -> &mut FlightTimes;

    /// The time so many seconds after the contact, s.
    fn time_after(&self, seconds: f64) -> f64;
}

/// A contact of a rod whose table has neither limits nor ends, with the quantities of its checks. Those of later phases may be 0.
#[derive(Clone, Copy, Debug)]
pub struct RodContact {
    /// Rules of the run.
    pub rules: Rules,
    /// Angle, rad.
    pub theta: f64,
    /// Same as in [`Checked`], m/s.
    pub push: f64,
    /// Same as in [`Checked`], m/s.
    pub approach: f64,
    /// Same as in [`Checked`], m²/s².
    pub speed_squared: f64,
    /// Rebound of the contact point from the last strike.
    pub rebound: Rebound,
    /// Time of the contact at which the run would end, s.
    pub t: f64,
    /// Length of the flight, s.
    pub flight_time: f64,
    /// Flights by which the run is judged.
    pub flights: FlightTimes,
}

impl Checked for RodContact {
    fn rules(&self) -> &Rules {
        &self.rules
    }

    fn t(&self) -> f64 {
        self.t
    }

    fn touch(&self) -> Option<Touch> {
        None
    }

    fn theta(&self) -> f64 {
        self.theta
    }

    fn contact_place(&self) -> f64 {
        0.0
    }

    fn load(&mut self) -> ActuatorLoad {
        ActuatorLoad::default()
    }

    fn push(&self) -> f64 {
        self.push
    }

    fn approach(&self) -> f64 {
        self.approach
    }

    fn speed_squared(&self) -> f64 {
        self.speed_squared
    }

    fn contact_rise(&self) -> f64 {
        self.rebound.rise
    }

    fn rise_rounding(&self) -> f64 {
        self.rebound.rounding
    }

    fn rebound(&self) -> Rebound {
        self.rebound
    }

    fn no_contact(&self) -> Option<NoContact> {
        None
    }

    fn flight_time(&self) -> f64 {
        self.flight_time
    }

    fn flights(&mut self) -> &mut FlightTimes {
        &mut self.flights
    }

    fn time_after(&self, seconds: f64) -> f64 {
        self.t + seconds
    }
}

/// The ending of a run by a check, if it holds.
#[inline(always)]
fn ending_by(contact: &mut impl Checked, check: Check) -> Option<Ending> {
    match check {
        Check::OtherVertex => contact.touch().map(Ending::OtherVertex),
        Check::Toppled => contact.rules().toppled(contact.theta()),
        Check::OffTable => {
            let limit = contact.rules().half_length;
            if limit == f64::INFINITY {
                return None;
            }
            let place = contact.contact_place();
            (place.abs() > limit).then_some(Ending::OffTable { place, limit })
        }
        Check::BeyondLimits => {
            contact.rules().limits.as_ref()?;
            let load = contact.load();
            contact.rules().limits.as_ref()?.exceeded(&load).map(Ending::BeyondLimits)
        }
        Check::Separating => (contact.push() >= 0.0).then(|| Ending::Separating { approach: contact.approach() }),
        Check::TooFast => {
            let squared = contact.speed_squared();
            let is_too_fast = squared.is_nan() || squared > SPEED_LIMIT * SPEED_LIMIT;
            is_too_fast.then(|| Ending::Diverged { speed: squared.sqrt() })
        }
        Check::NotRising => {
            let rises = contact.contact_rise() > contact.rise_rounding();
            if rises { None } else { Some(stay(&contact.rebound(), contact.rules().settles, contact.t())) }
        }
        Check::NoContact => contact
            .no_contact()
            .map(|no_contact| no_contact.ending(contact.contact_rise(), contact.speed_squared().sqrt())),
        Check::ShortFlight => {
            if !contact.rules().settles {
                return None;
            }
            let mut flights = *contact.flights();
            let ending = flights.short_flight(contact);
            *contact.flights() = flights;
            ending
        }
    }
}

/// The runs in lanes at a contact.
#[derive(Clone, Copy)]
pub(crate) struct LaneContact<N: Arithmetic> {
    /// True where no other vertex may touch the table.
    pub(crate) is_clear: N::Mask,
    /// True where the contact point is between the ends of the table.
    pub(crate) is_on_table: N::Mask,
    /// True where the strike does not load the table beyond its limits.
    pub(crate) is_within_limits: N::Mask,
    /// |θ|, rad.
    pub(crate) size: N,
    pub(crate) topple_angle: N,
    /// Same as in [`crate::map::strike::Strike`], m/s.
    pub(crate) push: N,
    /// Velocities after the strike, m/s.
    pub(crate) x_dot: N,
    pub(crate) y_dot: N,
    pub(crate) contact_rise: N,
    /// A faster rise is more than rounding, m/s.
    pub(crate) sure_rise: N,
    /// True where the time of flight is found.
    pub(crate) is_found: N::Mask,
    /// s.
    pub(crate) flight_time: N,
    /// First flight of a run that can settle, s; 0 of others.
    pub(crate) first_flight: N,
}

impl<N: Arithmetic> LaneContact<N> {
    /// Tells where a run surely goes on past a check. Any other run is set apart, and the map itself decides; so a check may be too
    /// cautious here but never too bold. No comparison holds for a value that is not a number.
    #[inline(always)]
    fn passes(&self, check: Check) -> N::Mask {
        let (zero, fast) = (N::from_f64(0.0), N::from_f64(0.5 * SPEED_LIMIT));
        match check {
            Check::OtherVertex => self.is_clear,
            Check::OffTable => self.is_on_table,
            Check::BeyondLimits => self.is_within_limits,
            Check::Toppled => self.size.is_less(self.topple_angle),
            Check::Separating => self.push.is_less(zero),
            Check::TooFast => self.x_dot.magnitude().is_at_most(fast) & self.y_dot.magnitude().is_at_most(fast),
            Check::NotRising => self.sure_rise.is_less(self.contact_rise),
            Check::NoContact => self.is_found,
            Check::ShortFlight => (N::from_f64(SETTLED_SHARE) * self.first_flight).is_at_most(self.flight_time),
        }
    }
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

impl FlightTimes {
    /// The ending by [`Check::ShortFlight`] of a run that can settle.
    #[inline(always)]
    fn short_flight(&mut self, contact: &impl Checked) -> Option<Ending> {
        let flight_time = contact.flight_time();
        if self.first == 0.0 {
            self.first = flight_time;
        }
        let is_short = flight_time < SETTLED_SHARE * self.first;
        (is_short && contact.rebound().is_slow()).then(|| {
            let settle_time = contact.time_after(time_to_rest(flight_time, self.last));
            Ending::Settled { flight_time, settle_time }
        })
    }
}

impl Rules {
    /// The ending by [`Check::Toppled`] at the angle `theta`, rad.
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
