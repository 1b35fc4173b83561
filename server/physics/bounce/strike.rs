//! The strike: what the velocities, the table and the impulse are at one contact of the rod.
//!
//! Not here: when contacts happen ([`crate::bounce::contact_time`]) and whether a run goes on after one ([`crate::run::orbit`]).

use crate::bounce::friction::Mode;
use crate::numbers::number::Number;
use crate::run::settling::Rebound;

/// Angle and velocities of the rod just before a contact; the horizontal place is carried beside it, since nothing
/// depends on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<N = f64> {
    /// Angle from upright, counter-clockwise, rad.
    pub theta: N,
    /// Horizontal velocity of the centre of gravity, m/s.
    pub x_dot: N,
    /// Vertical velocity of the centre of gravity, m/s.
    pub y_dot: N,
    /// Angular velocity, rad/s.
    pub theta_dot: N,
}

/// A rod without friction on a table that tilts by α = κθ, with every way of striking it in one formula.
///
/// The table's velocity along its normal is that of eq. (28), or zero. Either way the impulse is
/// P = −γ v_nc / B with the *strike gain* γ = γ₀ + γ_E (η* − η): γ₀ = 2 where the table makes up the loss (then e
/// drops out), γ₀ = 1 + e where it stands still, and γ_E = (1 + e) κ_E.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod<N = f64> {
    /// l, centre of gravity to contact point, m.
    pub contact_distance: N,
    /// ρ, radius of gyration about the centre of gravity, m.
    pub radius_of_gyration: N,
    /// G, gravity in the plane, m/s².
    pub gravity: N,
    /// e, coefficient of restitution.
    pub restitution: N,
    /// κ, table tilt per angle.
    pub tilt_gain: N,
    /// γ₀, the strike gain at the wanted energy.
    pub strike_gain: N,
    /// γ_E, how much the strike gain grows per missing energy, s²/m².
    pub strike_gain_per_energy: N,
    /// η* = G y*, the wanted energy per unit mass, m²/s².
    pub target_energy: N,
}

/// What a strike takes from the angles alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt<N> {
    /// α, table tilt, rad.
    pub(crate) alpha: N,
    /// sin θ.
    pub(crate) sin_theta: N,
    /// 1 − cos θ.
    pub(crate) versine_theta: N,
    /// sin α.
    pub(crate) sin_alpha: N,
    /// cos α.
    pub(crate) cos_alpha: N,
    /// sin β of β = θ − α, the rod's angle from the table's normal.
    pub(crate) sin_beta: N,
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
    /// What the contact does along the table.
    pub mode: Mode,
    /// ẏ_c⁺, vertical velocity of the contact point just after, m/s.
    pub contact_rise: N,
    /// |v|² = ẋ² + ẏ² + ρ²θ̇² just before, m²/s².
    pub speed_squared: N,
    /// Energy per unit mass just before, above that of the rod at rest upright on the table: ½|v|² − G l (1 − cos θ), m²/s².
    /// Without the constant G l, slow bounces keep their digits.
    pub energy: N,
    /// What the strike adds to it, ½γ(γ − 2) v_nc²/B: nothing where the strike gain is 2.
    pub energy_gain: N,
}

impl<N: Number> Tilt<N> {
    /// Of a rod at θ = `theta` over a table at α = `alpha`, `beta` apart.
    #[inline(always)]
    pub(crate) fn new(theta: N, alpha: N, beta: N) -> Self {
        let (sin_theta, versine_theta) = theta.sin_versine();
        let (sin_alpha, cos_alpha) = alpha.sincos();
        let (sin_beta, _) = beta.sincos();
        Self { alpha, sin_theta, versine_theta, sin_alpha, cos_alpha, sin_beta }
    }

    /// cos β. Unlike the sine it loses nothing to a difference of angles.
    #[inline(always)]
    pub(crate) fn cos_beta(&self) -> N {
        self.cos_alpha * (N::from_f64(1.0) - self.versine_theta) + self.sin_alpha * self.sin_theta
    }
}

impl<N: Number> Rod<N> {
    /// The frictionless strike, eq. (24) with (27) and (28).
    #[inline(always)]
    pub fn strike(&self, before: &State<N>) -> Strike<N> {
        self.strike_with(before, &self.tilt(before.theta), self.leverage())
    }

    /// The table's tilt at an angle of the rod.
    #[inline(always)]
    pub(crate) fn tilt(&self, theta: N) -> Tilt<N> {
        // Without the rounding of α: the strike turns the rod by sin β, which is small beside θ.
        Tilt::new(theta, self.tilt_gain * theta, (N::from_f64(1.0) - self.tilt_gain) * theta)
    }

    /// 1/ρ², 1/m²: of all that a strike needs, what depends on the rod alone and costs a division.
    #[inline(always)]
    pub(crate) fn leverage(&self) -> N {
        N::from_f64(1.0) / (self.radius_of_gyration * self.radius_of_gyration)
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
        // η of eq. (28).
        let weight = self.gravity * self.contact_distance;
        let bounce_energy = weight * cos_theta + half * y_dot * y_dot;
        let gain = self.strike_gain + self.strike_gain_per_energy * (self.target_energy - bounce_energy);
        // B = 1 + l² sin²β / ρ², what the contact point weighs along the normal, eq. (33). Near upright it rounds to 1 and
        // the strike loses no digit, which a common factor ρ² would cost.
        let turn = arm * leverage;
        let push = gain * normal_velocity;
        let impulse = -push / (one + arm * turn);
        let share = gain / (one + self.restitution);
        let table = normal_velocity * (one - share);
        let after = State {
            theta,
            x_dot: x_dot - impulse * sin_alpha,
            y_dot: y_dot + impulse * cos_alpha,
            theta_dot: theta_dot + impulse * turn,
        };
        let spin = self.radius_of_gyration * theta_dot;
        let speed_squared = x_dot * x_dot + y_dot * y_dot + spin * spin;
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
            mode: Mode::Frictionless,
            contact_rise: self.contact_rise(&after, sin_theta),
            speed_squared,
            energy: half * speed_squared - weight * versine_theta,
            energy_gain: half * (N::from_f64(2.0) - gain) * impulse * normal_velocity,
        }
    }
}

impl<N: Copy> Rod<N> {
    /// The same rod in other numbers.
    #[inline(always)]
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> Rod<M> {
        Rod {
            contact_distance: function(self.contact_distance),
            radius_of_gyration: function(self.radius_of_gyration),
            gravity: function(self.gravity),
            restitution: function(self.restitution),
            tilt_gain: function(self.tilt_gain),
            strike_gain: function(self.strike_gain),
            strike_gain_per_energy: function(self.strike_gain_per_energy),
            target_energy: function(self.target_energy),
        }
    }
}

impl<N: Copy> State<N> {
    /// The same state in other numbers.
    #[inline(always)]
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> State<M> {
        State {
            theta: function(self.theta),
            x_dot: function(self.x_dot),
            y_dot: function(self.y_dot),
            theta_dot: function(self.theta_dot),
        }
    }
}

impl<N: Number> Rod<N> {
    /// ẏ_c = ẏ + l θ̇ sin θ, m/s.
    #[inline(always)]
    pub(crate) fn contact_rise(&self, state: &State<N>, sin_theta: N) -> N {
        state.y_dot + self.contact_distance * state.theta_dot * sin_theta
    }

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
    /// Whether the contact point rises from the table, by more than rounding. `y_dot` is ẏ before, m/s; `unit` the relative size of one
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

impl Rod<f64> {
    /// The paper's plain case: struck so that every bounce keeps its energy, e = 1, g = 9.81 m/s². Lengths l and ρ in m, tilt
    /// gain κ.
    pub const fn lossless(contact_distance: f64, radius_of_gyration: f64, tilt_gain: f64) -> Self {
        Self {
            contact_distance,
            radius_of_gyration,
            gravity: 9.81,
            restitution: 1.0,
            tilt_gain,
            strike_gain: 2.0,
            strike_gain_per_energy: 0.0,
            target_energy: 0.0,
        }
    }

    /// The same rod in another kind of number.
    #[inline(always)]
    pub fn lift<N: Number>(&self) -> Rod<N> {
        self.map(N::from_f64)
    }

    /// Energy per unit mass ½|v|² + G l cos θ at a contact, |v|² = ẋ² + ẏ² + ρ²θ̇², m²/s².
    pub fn energy(&self, state: &State) -> f64 {
        let spin = self.radius_of_gyration * state.theta_dot;
        let (_, cos) = crate::numbers::trig::sin_cos(state.theta);
        0.5 * (state.x_dot * state.x_dot + state.y_dot * state.y_dot + spin * spin)
            + self.gravity * self.contact_distance * cos
    }

    /// ẏ_c = ẏ + l θ̇ sin θ, vertical velocity of the contact point, m/s.
    #[inline(always)]
    pub fn contact_speed(&self, state: &State) -> f64 {
        let (sin, _) = crate::numbers::trig::sin_cos(state.theta);
        state.y_dot + self.contact_distance * state.theta_dot * sin
    }
}
