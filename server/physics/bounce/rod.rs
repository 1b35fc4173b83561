//! The rod and its table in numbers: lengths, gravity, gains; and the quantities that follow from them and a state.

use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::state::State;
use crate::bounce::tilt::Tilt;
use crate::numbers::number::Arithmetic;

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
    /// γ_E, how much the strike gain grows per missing energy, s²/m².
    pub strike_gain_per_energy: N,
    /// η* = G y*, the wanted energy per unit mass, m²/s².
    pub target_energy: N,
    /// Law from the energy before a strike to the strike gain.
    pub energy_feedback: EnergyFeedback,
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
            energy_feedback: self.energy_feedback,
        }
    }
}

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

    /// ẏ_c = ẏ + l θ̇ sin θ, m/s.
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
            energy_feedback: EnergyFeedback::Vertical,
        }
    }

    /// The same rod in another kind of number.
    #[inline(always)]
    pub fn lift<N: Arithmetic>(&self) -> Rod<N> {
        self.map(N::from_f64)
    }
}
