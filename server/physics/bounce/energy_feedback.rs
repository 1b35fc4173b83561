//! Energy feedback of the table: from the energy before a strike to the strike gain γ.

use crate::bounce::rod::Rod;
use crate::numbers::number::Number;

/// Energy that the table measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyMeasure {
    /// η = ½ẏ² + G l cos θ, eq. (28).
    Vertical,
    /// E = ½(ẋ² + ẏ² + ρ²θ̇²) + G l cos θ.
    Total,
}

/// Law by which the table brings the energy to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyLaw {
    /// The strike gain grows with the missing energy, eq. (28).
    Proportional,
    /// One strike brings the total energy to the target.
    OneStrike,
}

/// Law from the energy before a strike to the strike gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyFeedback {
    /// γ = γ₀ + γ_E(η* − η).
    Vertical,
    /// γ = γ₀ + γ_E(E* − E).
    Total,
    /// γ = ½γ₀(1 + r) with r² = 1 + 2(E* − E)/u², u² = v_nc²/B: after a strike without friction the energy is E*. A strike can take no
    /// more than the normal energy ½u², so r is 0 where r² would be negative. The contact then does not leave the table.
    OneStrike,
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

impl<N: Number> Rod<N> {
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
                let can = (normal_velocity.to_f64() < 0.0) & (square.to_f64() > 0.0);
                let ratio = if can { square.sqrt() } else { N::from_f64(0.0) };
                half * self.strike_gain * (one + ratio)
            }
        }
    }
}
