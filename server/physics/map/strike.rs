//! The strike: what the velocities, the table and the impulse are at one contact of the rod, from the rod and its table to the rebound.

use crate::numbers::number::{Arithmetic, Mask, Number};

/// Angle and velocities of the rod just before a contact. Nothing depends on its horizontal place, which is kept apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

mapped!(State: theta, x_dot, y_dot, theta_dot);

impl<N: Number> State<N> {
    /// The state in doubles.
    pub fn to_f64(&self) -> State {
        self.map(N::to_f64)
    }
}

/// Energy that the table measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyMeasure {
    /// η = ½ẏ² + G l cos θ, eq. (28).
    Vertical,
    /// E = ½(ẋ² + ẏ² + ρ²θ̇²) + G l cos θ.
    Total,
}

names!(EnergyMeasure: Vertical => "vertical", Total => "total");

/// Law by which the table brings the energy to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyLaw {
    /// The strike gain grows with the missing energy, eq. (28).
    Proportional,
    /// One strike brings the total energy to the target.
    OneStrike,
}

names!(EnergyLaw: Proportional => "proportional", OneStrike => "one_strike");

/// Law from the energy before a strike to the strike gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyFeedback {
    /// γ = γ₀ + γ_E(η* − η).
    Vertical,
    /// γ = γ₀ + γ_E(E* − E).
    Total,
    /// γ = ½γ₀(1 + r) with r² = 1 + 2(E* − E)/u², u² = v_nc²/B: after a strike without friction the energy is E*. A strike can take no
    /// more than the normal energy ½u², so r is 0 where r² would be negative. The contact then does not leave the table.
    ///
    /// A table that moves at 1 + ε times its law has γ = (1 + e)(1 + (1 + ε)((1 + r)/(1 + ê) − 1)), which is ½γ₀(1 + r) + ½ε(1 + e)(r − 1)
    /// with its own γ₀.
    OneStrike,
}

/// A rod without friction on a table that tilts by α = κθ, with every way of striking it in one formula.
///
/// The table's velocity along its normal is that of eq. (28), of one of the other laws of [`EnergyFeedback`], or zero. Either way the
/// impulse is P = −γ v_nc / B with the *strike gain* γ = γ₀ + γ_E (η* − η): γ₀ = 2 where the table makes up the loss (then e
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
    /// γ_E, how much the strike gain grows per missing energy, s²/m². With [`EnergyFeedback::OneStrike`], how much more than ½γ₀ it grows with
    /// r: by an error of the table's speed.
    pub strike_gain_per_energy: N,
    /// η* = G y*, the wanted energy per unit mass, m²/s².
    pub target_energy: N,
    /// Law from the energy before a strike to the strike gain.
    pub energy_feedback: EnergyFeedback,
}

mapped!(
    Rod: contact_distance, radius_of_gyration, gravity, restitution, tilt_gain, strike_gain, strike_gain_per_energy, target_energy;
    same energy_feedback
);

impl<N: Arithmetic> Rod<N> {
    /// The rod at an impact of another restitution, which its table does not know of: γ is in proportion to 1 + e.
    #[inline(always)]
    pub(crate) fn meeting(&self, restitution: N) -> Self {
        let one = N::from_f64(1.0);
        let share = (one + restitution) / (one + self.restitution);
        Self {
            restitution,
            strike_gain: self.strike_gain * share,
            strike_gain_per_energy: self.strike_gain_per_energy * share,
            ..*self
        }
    }

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

    #[inline(always)]
    pub(crate) fn contact_rise(&self, state: &State<N>, sin_theta: N) -> N {
        state.y_dot + self.contact_distance * state.theta_dot * sin_theta
    }

    /// Energy per unit mass ½|v|² + G l cos θ at a contact, |v|² = ẋ² + ẏ² + ρ²θ̇², m²/s².
    pub fn energy(&self, state: &State<N>) -> N {
        let spin = self.radius_of_gyration * state.theta_dot;
        let speed_squared = state.x_dot * state.x_dot + state.y_dot * state.y_dot + spin * spin;
        N::from_f64(0.5) * speed_squared + self.gravity * self.contact_distance * state.theta.sincos().1
    }

    /// ẏ_c = ẏ + l θ̇ sin θ, vertical velocity of the contact point, m/s.
    #[inline(always)]
    pub fn contact_speed(&self, state: &State<N>) -> N {
        self.contact_rise(state, state.theta.sincos().0)
    }
}

impl Rod<f64> {
    /// The paper's plain case: every bounce keeps its energy, e = 1, g = 9.81 m/s². Lengths l and ρ in m, tilt gain κ.
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
            energy_feedback: EnergyFeedback::Vertical,
        }
    }

    /// The same rod in another kind of number.
    #[inline(always)]
    pub fn lift<N: Arithmetic>(&self) -> Rod<N> {
        self.map(N::from_f64)
    }
}

/// Tilt of the table with the sines and cosines of a strike.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt<N> {
    /// α, table tilt, rad.
    pub(crate) alpha: N,
    pub(crate) sin_theta: N,
    /// 1 − cos θ.
    pub(crate) versine_theta: N,
    pub(crate) sin_alpha: N,
    pub(crate) cos_alpha: N,
    /// sin β of β = θ − α, the rod's angle from the table's normal.
    pub(crate) sin_beta: N,
}

impl<N: Arithmetic> Tilt<N> {
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

/// A table that moves as it was planned before the contact, whatever it then meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedTableMotion<N = f64> {
    /// α, rad.
    pub alpha: N,
    /// The table's velocity along its normal, m/s.
    pub normal_velocity: N,
    /// The table's velocity along itself, m/s.
    pub tangential_velocity: N,
}

mapped!(PlannedTableMotion: alpha, normal_velocity, tangential_velocity);

/// Velocity that a turning table has at the contact beside that of its law, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceMotion<N = f64> {
    /// Along its normal; `None` if the law of the table has taken it off, or the pivot is under the contact.
    pub normal: Option<N>,
    /// Along itself.
    pub tangential: N,
    /// True if a table that moves along itself with the contact point takes this velocity into account.
    pub is_matched: bool,
}

/// Motion of the table that a contact meets.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TableMotion<'a, N> {
    ByLaw,
    Planned(&'a PlannedTableMotion<N>),
    /// That of a law and of its turning, by what the table senses.
    Sensed(&'a PlannedTableMotion<N>),
    /// That of its law, and of its turning beside it.
    Turning(&'a SurfaceMotion<N>),
}

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

names!(
    ContactMode: Frictionless => "frictionless", Slide => "slide", Stick => "stick", ReverseSlide => "reverse_slide",
        SlideThrough => "slide_through"
);

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
    /// γ v_nc/(1 + e), the contact point's normal velocity relative to the table just before, m/s. Signed as `push`.
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

mapped!(
    Strike: alpha, normal_velocity, push, approach, impulse_normal, impulse_tangential, contact_rise, speed_squared, energy, energy_gain;
    pairs sin_cos_theta, table_velocity; parts after; same mode
);

impl<N: Arithmetic> Rod<N> {
    /// γ, the strike gain, by G l cos θ (m²/s²), ẏ (m/s), |v|² (m²/s²), v_nc (m/s) and B.
    #[inline(always)]
    fn gain(&self, potential: N, y_dot: N, speed_squared: N, normal_velocity: N, mobility: N) -> N {
        let (half, one, two) = (N::from_f64(0.5), N::from_f64(1.0), N::from_f64(2.0));
        let has_feedback =
            self.energy_feedback == EnergyFeedback::OneStrike || !self.strike_gain_per_energy.is_zero().all();
        if !has_feedback {
            return self.strike_gain;
        }
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
                let gain = half * self.strike_gain * (one + ratio);
                let by_error = self.strike_gain_per_energy;
                N::select(by_error.is_zero(), gain, gain + by_error * (ratio - one))
            }
        }
    }

    /// The frictionless strike, eq. (24) with (27) and (28).
    #[inline(always)]
    pub fn strike(&self, before: &State<N>) -> Strike<N> {
        self.strike_with(before, &self.tilt(before.theta), self.leverage())
    }

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
        let gain = self.gain(potential, y_dot, speed_squared, normal_velocity, mobility);
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

    /// Brings the velocities after the strike onto the run's energy at this contact. Returns the energy at the next.
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

/// Minimum rise of the contact point, in ulps of the terms of its sum. Anything smaller is rounding noise around zero.
pub(crate) const RISE_UNITS: f64 = 8.0;

impl<N: Number> Strike<N> {
    /// w, velocity of the table along its normal, m/s, up positive.
    pub fn table_speed(&self) -> N {
        self.normal_velocity - self.approach
    }

    /// Rise that is rounding, m/s, without friction. `y_dot` is ẏ before, m/s; `unit` the relative size of one ulp.
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

/// Largest speed of a contact point at rest along the table's normal, in speeds of its rise. A contact point that comes to rest has
/// both in proportion, 1/cos α apart where it sticks; one that grazes y = 0 leaves the table at the speed of the bounce.
const REST_RATIO: f64 = 1e3;

/// Velocity of the contact point just after a strike, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rebound {
    /// Vertical part ẏ_c⁺.
    pub rise: f64,
    /// Part along the table's normal.
    pub along_normal: f64,
    /// Size of a rise that is rounding.
    pub rounding: f64,
}

impl Rebound {
    /// Tells whether the contact point is at rest but for rounding.
    pub fn has_stopped(&self) -> bool {
        self.rise.abs() <= self.rounding && self.is_slow()
    }

    /// Tells whether the contact point is as slow along the table's normal as it is upwards, so that a short flight is not a graze.
    pub fn is_slow(&self) -> bool {
        self.along_normal.abs() <= REST_RATIO * self.rise.max(self.rounding)
    }
}
