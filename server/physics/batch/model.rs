//! The parts that all runs of a batch share, and which run fits into which batch.

use crate::body::Body;
use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::friction::{RestitutionLaw, Slide};
use crate::run::rules::Rules;
use crate::table::control_law::Steering;
use crate::table::noise::{FurtherNoise, NoiseModel};

/// Parts of the bodies and tables that all runs of a batch share. Their numbers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatchModel {
    /// True for point masses.
    pub is_point: bool,
    /// The energy feedback of their tables.
    pub energy_feedback: EnergyFeedback,
    /// Friction of one law and one way to slide, if any.
    pub friction: Option<(RestitutionLaw, Slide)>,
    /// True if the tables feed back the state.
    pub feeds_back: bool,
    /// True if the tables err, in time or in the angle that they sense.
    pub errs: bool,
    /// True if the bodies are polygons, whose other vertices are looked at.
    pub has_vertices: bool,
}

impl BatchModel {
    /// Rods without friction on tables with a tilt gain.
    pub fn rods(energy_feedback: EnergyFeedback) -> Self {
        Self { is_point: false, energy_feedback, friction: None, feeds_back: false, errs: false, has_vertices: false }
    }

    /// The model of the batch that can take the runs of a body; `None` for those that run alone. Lanes do not see limits or
    /// ends of the table, its turning, plans of a table that errs, errors beside those of timing and angle, a delay, a constant error of its tilt, or
    /// drag.
    pub fn of(body: &Body, rules: &Rules) -> Option<Self> {
        let Rules { settles, holds_energy, limits, half_length, .. } = *rules;
        let Body { rod, is_point, steering, constant_tilt, turning, program: _, friction, noise, lag, drag, outline } =
            body;
        // Lanes hold the energy of every run that cannot settle and has neither friction nor noise.
        let holds = !settles && friction.is_none() && noise.is_none();
        if limits.is_some() || half_length.is_finite() || holds_energy != holds {
            return None;
        }
        let errs_more =
            noise.is_some_and(|noise| noise.model == NoiseModel::Plan || noise.further != FurtherNoise::NONE);
        let turns = turning.is_some_and(|turning| turning.acts(friction.as_ref()));
        if errs_more || turns || drag.is_some() || *constant_tilt != 0.0 || *lag != 0.0 {
            return None;
        }
        Some(Self {
            is_point: *is_point,
            energy_feedback: rod.energy_feedback,
            friction: friction.map(|friction| (friction.law, friction.slide)),
            feeds_back: *steering != Steering::TiltGain,
            errs: noise.is_some(),
            has_vertices: outline.is_some(),
        })
    }

    /// Tells whether they are rods with nothing beyond the plain one.
    pub(super) fn is_plain_rod(self) -> bool {
        self == Self::rods(self.energy_feedback)
    }
}
