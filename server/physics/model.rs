//! Chooses the smallest model that is exact for a scene, and says why.

use crate::contact_time::TooManyPieces;
use crate::impact::{Rod, State, Strike};
use crate::map::{Body, Orbit, Release, Rules};
use crate::number::Number;
use crate::point::Point;
use crate::scene::{BodyShape, Scene, Striking};

/// The rungs of the ladder of models, from the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rung {
    /// A point mass.
    Point,
    /// The rod that loses nothing, or whose table makes up just what it loses.
    Rod,
    /// The rod on a table that stands still and takes energy away.
    RodStill,
    /// The rod with feedback of its energy.
    RodEnergy,
}

impl Rung {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Rod => "rod",
            Self::RodStill => "rod_still",
            Self::RodEnergy => "rod_energy",
        }
    }
}

/// The model that runs a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// A rod; its strike gain says which of the rungs it stands on.
    Rod(Rod),
    /// A point mass.
    Point(Point),
}

impl Scene {
    /// The smallest model that is exact for this scene.
    pub fn model(&self) -> Model {
        match self.body {
            BodyShape::Rod { .. } => Model::Rod(self.parameters()),
            BodyShape::Point => Model::Point(Point::new(self.parameters())),
        }
    }

    /// The parameters of its strikes and flights in any kind of number: what is derived from the fields is derived in it. A
    /// point mass has those of a rod of no length.
    pub fn parameters<N: Number>(&self) -> Rod<N> {
        let number = N::from_f64;
        let (contact_distance, radius_of_gyration) = match self.body {
            BodyShape::Rod { contact_distance, radius_of_gyration } => (contact_distance, radius_of_gyration),
            BodyShape::Point => (0.0, 1.0),
        };
        let restitution = number(self.restitution);
        let one_and_restitution = number(1.0) + restitution;
        let gravity = number(self.full_gravity) * number(self.incline).sincos().0;
        Rod {
            contact_distance: number(contact_distance),
            radius_of_gyration: number(radius_of_gyration),
            gravity,
            restitution,
            tilt_gain: number(self.tilt_gain),
            strike_gain: match self.strike {
                Striking::Compensated => number(2.0),
                Striking::Still => one_and_restitution,
            },
            strike_gain_per_energy: one_and_restitution * number(self.energy_gain),
            target_energy: gravity * number(self.target_height.unwrap_or(0.0)),
        }
    }

    /// When its runs end.
    pub fn rules(&self) -> Rules {
        Rules {
            topple_angle: match self.body {
                BodyShape::Rod { .. } => self.topple_angle,
                BodyShape::Point => f64::INFINITY,
            },
            settles: self.is_lossy(),
            holds_energy: !self.is_lossy(),
        }
    }

    /// Whether bounces lose energy that nothing gives back.
    pub fn is_lossy(&self) -> bool {
        self.strike == Striking::Still && self.restitution < 1.0
    }

    /// A run of the scene from its release.
    ///
    /// # Errors
    /// [`TooManyPieces`], which the ranges of a scene exclude.
    pub fn orbit(&self) -> Result<Orbit<Model>, TooManyPieces> {
        Orbit::new(self.model(), self.rules(), &self.release)
    }

    /// Which rung of the ladder the scene needs.
    pub fn rung(&self) -> Rung {
        match self.body {
            BodyShape::Point => Rung::Point,
            BodyShape::Rod { .. } if self.energy_gain != 0.0 => Rung::RodEnergy,
            BodyShape::Rod { .. } if self.is_lossy() => Rung::RodStill,
            BodyShape::Rod { .. } => Rung::Rod,
        }
    }

    /// What in the scene asked for this rung, in a sentence.
    pub fn rung_reason(&self) -> String {
        let e = self.restitution;
        match self.rung() {
            Rung::Point => "the body is a point: its table follows the angle of its velocity (eq. 3)".to_owned(),
            Rung::RodEnergy => {
                format!(
                    "energy_gain is {} s²/m², so the table's speed depends on the energy (eq. 28)",
                    self.energy_gain
                )
            }
            Rung::RodStill => {
                format!("the table stands still and restitution is {e}, so every bounce loses energy (eq. 24)")
            }
            Rung::Rod if e == 1.0 => "nothing is lost at a bounce (eq. 1), and nothing else was asked for".to_owned(),
            Rung::Rod => {
                format!(
                    "the table makes up all that restitution {e} loses (eq. 25), so the run is that of restitution 1"
                )
            }
        }
    }
}

/// Calls the same method of whichever body it is: a branch that a run always takes the same way, not a virtual call.
macro_rules! either {
    ($model:expr, $body:ident => $call:expr) => {
        match $model {
            Model::Rod($body) => $call,
            Model::Point($body) => $call,
        }
    };
}

impl Body for Model {
    fn fall(&self, release: &Release) -> Result<(f64, State), TooManyPieces> {
        either!(self, body => body.fall(release))
    }

    #[inline(always)]
    fn strike(&self, before: &State) -> Strike {
        either!(self, body => Body::strike(body, before))
    }

    #[inline(always)]
    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64 {
        either!(self, body => Body::hold_energy(body, strike, energy))
    }

    #[inline(always)]
    fn fly(&self, strike: &Strike) -> Result<(f64, State), TooManyPieces> {
        either!(self, body => body.fly(strike))
    }

    fn contact_distance(&self) -> f64 {
        either!(self, body => body.contact_distance())
    }

    fn contact_height(&self, state: &State) -> f64 {
        either!(self, body => body.contact_height(state))
    }

    fn energy(&self, state: &State) -> f64 {
        either!(self, body => Body::energy(body, state))
    }

    fn contact_speed(&self, state: &State) -> f64 {
        either!(self, body => Body::contact_speed(body, state))
    }
}
