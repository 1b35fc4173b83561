//! The needs of each analysis. Refusals, notes and a paragraph of the contract follow from this table.

use super::fields::LIMITS;
use super::{Name, Scene, VERTICES};
use crate::map::body::Body;
use crate::map::strike::EnergyFeedback;

/// An analysis that does not take every scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Analysis {
    /// Motion of a run by the linear map of small deviations.
    LinearSolution,
    /// A whole run by it, with its ending.
    LinearRun,
    /// Derivative of the map at its fixed point.
    JacobianAtFixedPoint,
    /// Mirror-symmetric orbits of period 2.
    SymmetricOrbit,
    /// Map of residues or spectral radii.
    LinearMap,
    /// Releases at rest from which a run survives.
    Basin,
    /// Law of state feedback that is optimal for given weights.
    Controller,
    /// End of a run at rest on the table.
    Catch,
    /// Strike that gives the body an apex.
    Throw,
    /// Motion in contact after the bounces.
    LastingContact,
    /// Simulation by a general method.
    Simulation,
    /// The same with a contact of springs and dampers.
    PenaltySimulation,
}

/// Property of a scene or of its map that an analysis needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// An angle of the body.
    Angle,
    /// A bounce that repeats, which the map tells and no field.
    RepeatingBounce,
    /// The paper's rod, without anything that changes its bounces.
    PlainRod,
    /// No limits and no ends of the table, and no vertices.
    NoEndings,
    /// A table that steers the vertical energy or none.
    VerticalEnergy,
    /// A table that strikes by the state at the strike.
    PresentState,
    /// A table that turns as it strikes drags no contact along.
    NoDragging,
    /// A table that does not act by its turning.
    NoTurning,
    /// Flights without air.
    NoAir,
    /// A contact without friction.
    NoFriction,
}

/// The table: each analysis with its needs, in the order in which they are looked at.
pub const CAPABILITIES: [(Analysis, &[Need]); 12] = {
    use Analysis::*;
    use Need::*;
    [
        (LinearRun, &[PlainRod, NoEndings, VerticalEnergy, Angle, RepeatingBounce]),
        (LinearSolution, &[PlainRod, VerticalEnergy, Angle, RepeatingBounce]),
        (JacobianAtFixedPoint, &[RepeatingBounce]),
        (SymmetricOrbit, &[Angle]),
        (LinearMap, &[NoTurning]),
        (Basin, &[Angle]),
        (Controller, &[Angle, RepeatingBounce]),
        (Catch, &[Angle]),
        (Throw, &[Angle]),
        (LastingContact, &[Angle, PresentState, NoDragging]),
        (Simulation, &[Angle, NoAir, PresentState]),
        (PenaltySimulation, &[Angle, NoAir, PresentState, NoTurning, NoFriction]),
    ]
};

/// A need that a scene does not meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lack {
    /// The need.
    pub need: Need,
    /// Path of the field because of which it is not met.
    pub path: &'static str,
}

impl Analysis {
    /// The needs of the analysis.
    pub fn needs(self) -> &'static [Need] {
        CAPABILITIES.iter().find(|(analysis, _)| *analysis == self).map_or(&[], |(_, needs)| needs)
    }

    /// The first need that the fields of a scene do not meet.
    pub fn lack(self, scene: &Scene) -> Option<Lack> {
        self.needs().iter().find_map(|&need| Some(Lack { need, path: need.missing(scene)? }))
    }
}

impl Need {
    /// Path of the field because of which a scene does not meet the need, if there is one.
    fn missing(self, scene: &Scene) -> Option<&'static str> {
        let Body { rod, is_point, turning, friction, lag, outline, .. } = &scene.running_model;
        let name = match self {
            Self::RepeatingBounce => None,
            Self::PlainRod => return scene.first_beyond_rod(),
            Self::Angle => is_point.then_some(Name::PointMass),
            Self::NoEndings if outline.is_some() => return Some(VERTICES),
            Self::NoEndings => [Name::TableLength].into_iter().chain(LIMITS).find(|&name| scene.value(name).is_some()),
            Self::VerticalEnergy => match rod.energy_feedback {
                EnergyFeedback::Vertical => None,
                EnergyFeedback::Total => Some(Name::EnergyMeasure),
                EnergyFeedback::OneStrike => Some(Name::EnergyLaw),
            }
            .filter(|_| scene.steers_energy()),
            Self::PresentState => (*lag != 0.0).then_some(Name::Delay),
            Self::NoDragging => {
                turning.is_some_and(|turning| turning.drags(friction.as_ref())).then_some(Name::PivotDepth)
            }
            Self::NoTurning => scene.acting_turn().map(|_| Name::TiltRate),
            Self::NoAir => scene.drag_field(),
            Self::NoFriction => scene.running_model.rough().map(|_| Name::Friction),
        };
        name.map(|name| name.row().path)
    }
}
