//! The strike: what the velocities, the table and the impulse are at one contact of the rod.
//!
//! Not here: when contacts happen ([`crate::bounce::contact_time`]) and whether a run goes on after one ([`crate::run::orbit`]).

use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::rebound::Rebound;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::tilt::Tilt;
use crate::numbers::number::{Arithmetic, Number};

/// Mode of a contact along the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactMode {
    /// No friction.
    Frictionless,
    /// It slid one way from first to last.
    Slide,
    /// It was at rest, or came to rest, and stayed.
    Stick,
    /// It came to rest and slid on the other way.
    ReverseSlide,
    /// It was at rest and friction could not hold it.
    SlideThrough,
}

impl ContactMode {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frictionless => "frictionless",
            Self::Slide => "slide",
            Self::Stick => "stick",
            Self::ReverseSlide => "reverse_slide",
            Self::SlideThrough => "slide_through",
        }
    }
}

/// All there is to know about one strike. Velocities are of the centre of gravity, impulses per unit mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strike<N = f64> {
    /// Angle and velocities just after it (the angle does not change).
    pub after: State<N>,
    /// α, table tilt, rad.
    pub alpha: N,
    /// sin θ, cos θ of the rod: the flight that follows starts from them.
    pub sin_cos_theta: (N, N),
    /// v_nc, velocity of the contact point along the table's normal just before, m/s.
    pub normal_velocity: N,
    /// γ v_nc, m/s: a table cannot pull, so there is a strike only where this is negative.
    pub push: N,
    /// γ v_nc/(1 + e), velocity of the contact point relative to the table, along its normal, just before, m/s. Its sign
    /// is that of `push`, which costs no division.
    pub approach: N,
    /// The table's velocity in x and y, m/s.
    pub table_velocity: (N, N),
    /// P_n, m/s.
    pub impulse_normal: N,
    /// P_t, m/s.
    pub impulse_tangential: N,
    /// Mode of the contact along the table.
    pub mode: ContactMode,
    /// ẏ_c⁺, vertical velocity of the contact point just after, m/s.
    pub contact_rise: N,
    /// |v|² = ẋ² + ẏ² + ρ²θ̇² just before, m²/s².
    pub speed_squared: N,
    /// Energy per unit mass just before, above that of the rod at rest upright on the table: ½|v|² − G l (1 − cos θ), m²/s².
    /// Without the constant G l, slow bounces keep their digits.
    pub energy: N,
    /// Energy that the strike adds, ½γ(γ − 2) v_nc²/B: nothing where the strike gain is 2.
    pub energy_gain: N,
}

impl<N: Copy> Strike<N> {
    /// The same strike in other numbers.
    #[inline(always)]
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> Strike<M> {
        let pair = |(one, other): (N, N)| (function(one), function(other));
        Strike {
            after: self.after.map(&function),
            alpha: function(self.alpha),
            sin_cos_theta: pair(self.sin_cos_theta),
            normal_velocity: function(self.normal_velocity),
            push: function(self.push),
            approach: function(self.approach),
            table_velocity: pair(self.table_velocity),
            impulse_normal: function(self.impulse_normal),
            impulse_tangential: function(self.impulse_tangential),
            mode: self.mode,
            contact_rise: function(self.contact_rise),
            speed_squared: function(self.speed_squared),
            energy: function(self.energy),
            energy_gain: function(self.energy_gain),
        }
    }
}

/// Quantities of a strike from which its gain follows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeasuredBounce<N> {
    /// G l cos θ, m²/s².
    pub(crate) potential: N,
    /// ẏ, m/s.
    pub(crate) y_dot: N,
    /// |v|², m²/s².
    pub(crate) speed_squared: N,
    /// v_nc, m/s.
    pub(crate) normal_velocity: N,
    /// B.
    pub(crate) mobility: N,
}

impl<N: Arithmetic> Rod<N> {
    /// γ, the strike gain.
    #[inline(always)]
    pub(crate) fn gain(&self, bounce: &MeasuredBounce<N>) -> N {
        let (half, one, two) = (N::from_f64(0.5), N::from_f64(1.0), N::from_f64(2.0));
        let MeasuredBounce { potential, y_dot, speed_squared, normal_velocity, mobility } = *bounce;
        match self.energy_feedback {
            EnergyFeedback::Vertical => {
                let energy = potential + half * y_dot * y_dot;
                self.strike_gain + self.strike_gain_per_energy * (self.target_energy - energy)
            }
            EnergyFeedback::Total => {
                let energy = potential + half * speed_squared;
                self.strike_gain + self.strike_gain_per_energy * (self.target_energy - energy)
            }
            EnergyFeedback::OneStrike => {
                let missing = self.target_energy - (potential + half * speed_squared);
                let square = one + two * missing * mobility / (normal_velocity * normal_velocity);
                // Where the contact point does not approach, the run ends as `separating` for any gain > 0.
                let zero = N::from_f64(0.0);
                let can = normal_velocity.is_less(zero) & zero.is_less(square);
                let ratio = N::select(can, square.sqrt(), zero);
                half * self.strike_gain * (one + ratio)
            }
        }
    }
}

impl<N: Arithmetic> Rod<N> {
    /// The frictionless strike, eq. (24) with (27) and (28).
    #[inline(always)]
    pub fn strike(&self, before: &State<N>) -> Strike<N> {
        self.strike_with(before, &self.tilt(before.theta), self.leverage())
    }

    /// [`Rod::strike`] with what it needs of the angle and of the rod.
    #[inline(always)]
    pub(crate) fn strike_with(&self, before: &State<N>, tilt: &Tilt<N>, leverage: N) -> Strike<N> {
        let one = N::from_f64(1.0);
        let half = N::from_f64(0.5);
        let State { theta, x_dot, y_dot, theta_dot } = *before;
        let Tilt { alpha, sin_theta, versine_theta, sin_alpha, cos_alpha, sin_beta, .. } = *tilt;
        let cos_theta = one - versine_theta;
        // Eq. (32) in the plane's axes.
        let arm = self.contact_distance * sin_beta;
        let normal_velocity = cos_alpha * y_dot - sin_alpha * x_dot + arm * theta_dot;
        let weight = self.gravity * self.contact_distance;
        let spin = self.radius_of_gyration * theta_dot;
        let speed_squared = x_dot * x_dot + y_dot * y_dot + spin * spin;
        // B = 1 + l² sin²β / ρ², what the contact point weighs along the normal, eq. (33). Near upright it rounds to 1 and
        // the strike loses no digit, which a common factor ρ² would cost.
        let turn = arm * leverage;
        let mobility = one + arm * turn;
        let potential = weight * cos_theta;
        let gain = self.gain(&MeasuredBounce { potential, y_dot, speed_squared, normal_velocity, mobility });
        let push = gain * normal_velocity;
        let impulse = -push / mobility;
        let share = gain / (one + self.restitution);
        let table = normal_velocity * (one - share);
        let after = State {
            theta,
            x_dot: x_dot - impulse * sin_alpha,
            y_dot: y_dot + impulse * cos_alpha,
            theta_dot: theta_dot + impulse * turn,
        };
        Strike {
            after,
            alpha,
            sin_cos_theta: (sin_theta, cos_theta),
            normal_velocity,
            push,
            approach: share * normal_velocity,
            table_velocity: (-(table * sin_alpha), table * cos_alpha),
            impulse_normal: impulse,
            impulse_tangential: N::from_f64(0.0),
            mode: ContactMode::Frictionless,
            contact_rise: self.contact_rise(&after, sin_theta),
            speed_squared,
            energy: half * speed_squared - weight * versine_theta,
            energy_gain: half * (N::from_f64(2.0) - gain) * impulse * normal_velocity,
        }
    }
}

impl<N: Arithmetic> Rod<N> {
    /// Brings the velocities after the strike onto the energy that the run should have at this contact, and gives that
    /// which it should have at the next.
    ///
    /// Flights conserve energy and a strike changes it by a known amount, so what the state before the strike is off is
    /// rounding. A strike is linear in the velocities: correcting them after it is as good as before it, and off the
    /// critical path. It holds the slow growth of phase errors: a tenth of the error after 100 bounces (`tests/accuracy.rs`).
    #[inline(always)]
    pub fn hold_energy(&self, strike: &mut Strike<N>, energy: N) -> N {
        let stretch = (energy - strike.energy) / strike.speed_squared;
        let State { x_dot, y_dot, theta_dot, .. } = &mut strike.after;
        for velocity in [x_dot, y_dot, theta_dot] {
            *velocity = *velocity + *velocity * stretch;
        }
        strike.contact_rise = self.contact_rise(&strike.after, strike.sin_cos_theta.0);
        energy + strike.energy_gain
    }
}

/// Minimum rise of the contact point, in units in the last place of the terms of its sum. Anything smaller is rounding noise around
/// zero.
pub(crate) const RISE_UNITS: f64 = 8.0;

impl<N: Number> Strike<N> {
    /// w, velocity of the table along its normal, m/s, up positive.
    pub fn table_speed(&self) -> N {
        self.normal_velocity - self.approach
    }

    /// Tells whether the contact point rises from the table, by more than rounding. `y_dot` is ẏ before, m/s; `unit` the relative size of one
    /// unit in the last place.
    #[inline(always)]
    pub fn rises(&self, y_dot: N, unit: f64) -> bool {
        self.contact_rise.to_f64() > self.rise_rounding(y_dot, unit)
    }

    /// Size of a rise that is rounding, m/s, of a strike without friction: arguments as for [`Strike::rises`].
    #[inline(always)]
    pub fn rise_rounding(&self, y_dot: N, unit: f64) -> f64 {
        let terms = y_dot.to_f64().abs() + self.after.y_dot.to_f64().abs() + self.approach.to_f64().abs();
        RISE_UNITS * unit * terms
    }

    /// The contact point, `contact_distance` (m) from the centre of gravity, just after the strike.
    #[cold]
    pub fn rebound(&self, contact_distance: N, rounding: f64) -> Rebound {
        let (sin_alpha, cos_alpha) = self.alpha.sincos();
        let aside = self.after.x_dot + contact_distance * self.after.theta_dot * self.sin_cos_theta.1;
        let along_normal = cos_alpha * self.contact_rise - sin_alpha * aside;
        Rebound { rise: self.contact_rise.to_f64(), along_normal: along_normal.to_f64(), rounding }
    }
}
