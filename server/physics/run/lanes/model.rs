//! The parts that all runs of a batch share, and which run fits into which batch.

use crate::map::body::Body;
use crate::map::friction::{RestitutionLaw, Slide};
use crate::map::strike::{EnergyFeedback, Rod};
use crate::map::table::control_law::Steering;
use crate::map::table::noise::{Noise, NoiseModel};
use crate::run::rules::Rules;

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
    /// True if the tables tilt beside their law ([`Body::constant_tilt`]).
    pub is_biased: bool,
    /// True if the tables sense the state some time before the strike ([`Body::lag`]).
    pub lags: bool,
    /// True if the tables turn as they strike, about a place or not, and corrected or not.
    pub turning: Option<(bool, bool)>,
    /// True if the tables have ends.
    pub has_ends: bool,
    /// True if the tables have limits.
    pub has_limits: bool,
    /// True if the tables err.
    pub errs: bool,
    /// True if they carry out what they plan ([`NoiseModel::Plan`]).
    pub plans: bool,
    /// True if they err in what they sense beside the angle.
    pub errs_in_state: bool,
    /// True if the restitution scatters.
    pub scatters: bool,
    /// True if the bodies are polygons, whose other vertices are looked at.
    pub has_vertices: bool,
}

impl BatchModel {
    /// Rods without friction on tables with a tilt gain.
    pub fn rods(energy_feedback: EnergyFeedback) -> Self {
        Self::shared(&Body::plain(Rod { energy_feedback, ..Rod::lossless(1.0, 1.0, 1.0) }), &Rules::BARE_MAP)
    }

    /// The model of the batch that can take the runs of a body; `None` for those that run alone. Lanes do not see drag, and no
    /// program of heights of a table that plans.
    pub fn of(body: &Body, rules: &Rules) -> Option<Self> {
        let model = Self::shared(body, rules);
        // Lanes hold the energy of every run that cannot settle and has neither friction nor noise.
        let holds = !rules.settles && body.friction.is_none() && body.noise.is_none();
        let fits = !(model.plans && body.program.is_some()) && body.drag.is_none() && rules.holds_energy == holds;
        fits.then_some(model)
    }

    fn shared(body: &Body, rules: &Rules) -> Self {
        let noise = body.noise.unwrap_or(Noise::NONE);
        Self {
            is_point: body.is_point,
            energy_feedback: body.rod.energy_feedback,
            friction: body.friction.map(|friction| (friction.law, friction.slide)),
            feeds_back: body.steering != Steering::TiltGain,
            is_biased: body.constant_tilt != 0.0,
            lags: body.lag != 0.0,
            turning: body.turning.map(|turning| (turning.place.is_some(), turning.is_corrected)),
            has_ends: rules.half_length.is_finite(),
            has_limits: rules.limits.is_some(),
            errs: body.noise.is_some(),
            plans: noise.model == NoiseModel::Plan,
            errs_in_state: noise.x_sd != 0.0 || noise.errs_in_velocity(),
            scatters: noise.restitution_sd != 0.0,
            has_vertices: body.outline.is_some(),
        }
    }

    /// Tells whether they are rods with nothing beyond the plain one.
    pub(super) fn is_plain_rod(self) -> bool {
        self == Self::rods(self.energy_feedback)
    }
}
