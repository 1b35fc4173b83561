//! The model that all runs of a batch share, and which run fits into which batch.

use crate::body::Body;
use crate::bounce::friction::{RestitutionLaw, Slide};
use crate::bounce::strike::EnergyFeedback;
use crate::run::rules::Rules;
use crate::table::control_law::Steering;
use crate::table::noise::{FurtherNoise, NoiseModel};

/// Model that all runs of a batch share. Their numbers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchModel {
    /// Bodies with an angle.
    Rod {
        /// Their contacts.
        contact: BatchContact,
        /// The energy feedback of their tables.
        energy_feedback: EnergyFeedback,
        /// Control law of the tilt.
        law: TiltLaw,
        /// True if the tables err, in time or in the angle that they sense.
        errs: bool,
        /// True if the bodies are polygons, whose other vertices are looked at.
        has_vertices: bool,
    },
    /// Point masses, with the energy feedback of their tables.
    Point(EnergyFeedback),
}

/// Kind of contact of all runs of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchContact {
    /// Without friction, on tables that move along their normal only.
    Smooth,
    /// With friction of one law and one way to slide.
    Rough(RestitutionLaw, Slide),
}

/// Kind of [`Steering`], without its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiltLaw {
    /// [`Steering::TiltGain`].
    TiltGain,
    /// [`Steering::Feedback`].
    Feedback,
}

impl From<&Steering> for TiltLaw {
    fn from(steering: &Steering) -> Self {
        match steering {
            Steering::TiltGain => Self::TiltGain,
            Steering::Feedback(_) => Self::Feedback,
        }
    }
}

impl BatchModel {
    /// Rods without friction on tables with a tilt gain.
    pub fn rods(energy_feedback: EnergyFeedback) -> Self {
        Self::Rod {
            contact: BatchContact::Smooth,
            energy_feedback,
            law: TiltLaw::TiltGain,
            errs: false,
            has_vertices: false,
        }
    }

    /// The model of the batch that can take the runs of a body; `None` for those that run alone. Lanes do not see limits or
    /// ends of the table, its turning, plans of a table that errs, errors beside those of timing and angle, a delay, a constant error of its tilt, or
    /// drag.
    pub fn of(body: &Body, rules: &Rules) -> Option<Self> {
        let Rules { settles, holds_energy, limits, half_length, .. } = *rules;
        // Lanes hold the energy of every run that cannot settle and has neither friction nor noise.
        let Body { steering, constant_tilt, turning, friction, noise, lag, drag, outline, .. } = body;
        let holds = !settles && friction.is_none() && noise.is_none();
        if limits.is_some() || half_length.is_finite() || holds_energy != holds {
            return None;
        }
        let energy_feedback = body.rod.energy_feedback;
        if body.is_point {
            return Some(Self::Point(energy_feedback));
        }
        let errs_more =
            noise.is_some_and(|noise| noise.model == NoiseModel::Plan || noise.further != FurtherNoise::NONE);
        let turns = turning.is_some_and(|turning| turning.acts(friction.as_ref()));
        if errs_more || turns || drag.is_some() || *constant_tilt != 0.0 || *lag != 0.0 {
            return None;
        }
        let contact =
            friction.map_or(BatchContact::Smooth, |friction| BatchContact::Rough(friction.law, friction.slide));
        let law = steering.into();
        let fits = match (contact, energy_feedback) {
            // Its law is for contacts without friction.
            (BatchContact::Rough(..), EnergyFeedback::OneStrike) => false,
            (BatchContact::Rough(..), EnergyFeedback::Vertical | EnergyFeedback::Total) | (BatchContact::Smooth, _) => {
                true
            }
        };
        let (errs, has_vertices) = (noise.is_some(), outline.is_some());
        fits.then_some(Self::Rod { contact, energy_feedback, law, errs, has_vertices })
    }
}
