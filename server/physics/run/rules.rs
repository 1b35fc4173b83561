//! The rules of a run: every reason to end it and the order in which they are checked, written once.
//!
//! Runs in doubles ([`crate::run::orbit`]), with 31 digits ([`crate::run::extended`]), of the linear solution
//! ([`crate::run::method`]) and of general simulation methods differ in their numbers and flights. Each says in [`Checked`] how it
//! makes each [`Check`]; lanes ([`crate::batch`]) say it in [`CheckedByMask`]. A new reason to end a run is a new check, and the
//! compiler then asks all of them for it. The table of `docs/physics.md`, section 5, is in the same order.

use crate::body::Touch;
use crate::bounce::rebound::Rebound;
use crate::run::ending::Ending;
use crate::run::settling::{SETTLED_SHARE, stay, time_to_rest};
use crate::table::actuator_load::ActuatorLimits;

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
                    let ending = contact.ending_by(Check::$check);
                    if ending.is_some() {
                        return ending;
                    }
                )*
                None
            }
        )*

        /// Many runs at a contact, side by side: the checks as masks.
        pub(crate) trait CheckedByMask {
            /// Tells whether the run surely goes on past a check; false where that is not sure.
            fn passes(&self, check: Check) -> bool;

            /// Tells whether the run surely goes on past all checks.
            #[inline(always)]
            fn passes_all(&self) -> bool {
                true $($(& self.passes(Check::$check))*)*
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

/// One run at a contact, with what it knows of it so far.
pub trait Checked {
    /// The ending of the run by a check, if it holds.
    fn ending_by(&mut self, check: Check) -> Option<Ending>;
}

/// [`Ending::Completed`] at the contact with the last number asked for; checked when nothing else has ended the run.
#[inline(always)]
pub fn completed(n: u64, impacts: u64) -> Option<Ending> {
    (n >= impacts).then_some(Ending::Completed)
}

/// The ending by [`Check::OtherVertex`].
#[inline(always)]
pub fn other_vertex(touch: Option<Touch>) -> Option<Ending> {
    touch.map(Ending::OtherVertex)
}

/// The ending by [`Check::Toppled`] at θ, rad.
#[inline(always)]
pub fn toppled(theta: f64, topple_angle: f64) -> Option<Ending> {
    (theta.abs() >= topple_angle).then_some(Ending::Toppled { theta, limit: topple_angle })
}

/// The ending by [`Check::Separating`]: `push` and `approach` as in [`crate::bounce::strike::Strike`], m/s.
#[inline(always)]
pub fn separating(push: f64, approach: f64) -> Option<Ending> {
    (push >= 0.0).then_some(Ending::Separating { approach })
}

/// ẋ² + ẏ² + l²θ̇² after a strike, m²/s²; `spin` is lθ̇.
#[inline(always)]
pub fn speed_squared(x_dot: f64, y_dot: f64, spin: f64) -> f64 {
    x_dot * x_dot + y_dot * y_dot + spin * spin
}

/// The ending by [`Check::TooFast`].
#[inline(always)]
pub fn too_fast(speed_squared: f64) -> Option<Ending> {
    let is_too_fast = speed_squared.is_nan() || speed_squared > SPEED_LIMIT * SPEED_LIMIT;
    is_too_fast.then(|| Ending::Diverged { speed: speed_squared.sqrt() })
}

/// The ending by [`Check::NotRising`] of a strike at time `t`, s, after which the contact point rises by `contact_rise`, m/s;
/// a rise up to `rounding` is none.
#[inline(always)]
pub fn not_rising(
    contact_rise: f64,
    rounding: f64,
    settles: bool,
    t: f64,
    rebound: impl FnOnce() -> Rebound,
) -> Option<Ending> {
    let rises = contact_rise > rounding;
    if rises { None } else { Some(stay(&rebound(), settles, t)) }
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
    /// The ending by [`Check::ShortFlight`] of a run that can settle. `after` gives the time so many seconds after the contact at
    /// which the flight began.
    #[inline(always)]
    pub fn short_flight(
        &mut self,
        flight_time: f64,
        rebound: impl FnOnce() -> Rebound,
        after: impl FnOnce(f64) -> f64,
    ) -> Option<Ending> {
        if self.first == 0.0 {
            self.first = flight_time;
        }
        let is_short = flight_time < SETTLED_SHARE * self.first;
        (is_short && rebound().is_slow()).then(|| {
            let settle_time = after(time_to_rest(flight_time, self.last));
            Ending::Settled { flight_time, settle_time }
        })
    }
}

impl Rules {
    /// The map alone: nothing but what the physics itself forbids ends a run, and nothing is corrected.
    pub const BARE_MAP: Self = Self { topple_angle: f64::INFINITY, settles: false, holds_energy: false, limits: None };
}
