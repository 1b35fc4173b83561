//! Laws of the table's energy feedback. Not here: the strike gain γ that they give ([`crate::bounce::strike`]).

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
