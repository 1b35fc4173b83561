//! Chooses the smallest model that is exact for a scene, and says why.

use crate::contact_time::TooManyPieces;
use crate::friction::{Mode, RoughRod, Slide};
use crate::impact::{Rod, State, Strike};
use crate::map::{Body, Orbit, Release, Rules};
use crate::number::Number;
use crate::point::Point;
use crate::scene::{BodyShape, FieldError, Name, Scene, Striking};

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
    /// The rod on a table with friction, or that moves along itself.
    Friction,
}

impl Rung {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Rod => "rod",
            Self::RodStill => "rod_still",
            Self::RodEnergy => "rod_energy",
            Self::Friction => "friction",
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
    /// A rod with friction.
    Rough(RoughRod),
}

impl Model {
    /// What the contact does along the table in a strike at this state, and the impulse per unit mass there, m/s.
    pub fn contact(&self, before: &State) -> (Mode, f64) {
        match self {
            Self::Rod(_) | Self::Point(_) => (Mode::Frictionless, 0.0),
            Self::Rough(rough) => {
                let (_, impulse) = rough.strike_with_impulse(before);
                (impulse.mode, impulse.tangential)
            }
        }
    }
}

impl Scene {
    /// The smallest model that is exact for this scene.
    pub fn model(&self) -> Model {
        match self.body {
            BodyShape::Rod { .. } if self.is_rough() => Model::Rough(RoughRod {
                rod: self.parameters(),
                friction: self.friction,
                law: self.law,
                slide: self.slide,
            }),
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
            holds_energy: !self.is_lossy() && !self.is_rough(),
        }
    }

    /// Whether bounces lose energy that nothing gives back.
    pub fn is_lossy(&self) -> bool {
        self.strike == Striking::Still && self.restitution < 1.0
    }

    /// Whether the contact has friction or the table moves along itself.
    pub fn is_rough(&self) -> bool {
        self.friction != 0.0 || self.slide != Slide::None
    }

    /// Why what is derived for frictionless contacts does not hold, with the field that makes it so; none where it does.
    pub fn roughness(&self) -> Option<FieldError> {
        let name = if self.friction != 0.0 { Name::Friction } else { Name::Slide };
        let path = name.row().path;
        self.is_rough().then(|| FieldError {
            path,
            detail: format!("{path} is {}; this is not available with friction in this version", self.shown(name)),
        })
    }

    fn shown(&self, name: Name) -> String {
        self.value(name).map_or_else(String::new, |value| value.to_string())
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
            BodyShape::Rod { .. } if self.is_rough() => Rung::Friction,
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
            Rung::Friction if self.friction == 0.0 => {
                "slide is `matched`, so the table moves along itself, and friction is 0".to_owned()
            }
            Rung::Friction => format!(
                "friction is {}, so the impulse has a part along the table (law `{}`, slide `{}`)",
                self.friction,
                self.shown(Name::Law),
                self.shown(Name::Slide)
            ),
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
            Model::Rough($body) => $call,
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
