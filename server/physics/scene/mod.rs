//! What a user may say about a run: the table of fields, a draft that collects values, and the scene it becomes.
//!
//! Not here: how a scene is written down (JSON, query strings); which model runs it is [`crate::scene::model`].

mod draft;
mod fields;
pub mod model;
pub mod model_hierarchy;

pub use draft::{Draft, FieldError, VERTICES};
pub use fields::{FIELDS, Field, Kind, Name, Value, field};

use crate::body::Release;
use crate::body::polygon::{Outline, Vertices};
use crate::bounce::friction::{RestitutionLaw, Slide};
use crate::bounce::state::State;
use crate::table::actuator_load::ActuatorLimits;
use crate::table::control_law::Steering;
use crate::table::noise::Noise;

/// Which body bounces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyShape {
    /// A rod: any rigid body with one contact point below its centre of gravity.
    Rod {
        /// l, m.
        contact_distance: f64,
        /// ρ, m.
        radius_of_gyration: f64,
    },
    /// A point mass.
    Point,
}

/// How the table moves along its normal at a strike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Striking {
    /// It makes up what the bounce loses, eq. (25) and (28).
    Compensated,
    /// It does not move.
    Still,
}

/// A scene in which every value is in its range and nothing contradicts anything else. Made by [`Draft::build`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    pub(crate) body: BodyShape,
    /// Of a polygon.
    pub(crate) outline: Option<Outline>,
    /// G = g sin φ, m/s².
    pub(crate) gravity: f64,
    /// g, m/s².
    pub(crate) full_gravity: f64,
    /// φ, rad.
    pub(crate) incline: f64,
    pub(crate) restitution: f64,
    /// μ.
    pub(crate) friction: f64,
    pub(crate) law: RestitutionLaw,
    pub(crate) slide: Slide,
    pub(crate) steering: Steering,
    /// 0 with state feedback.
    pub(crate) tilt_gain: f64,
    /// ê, where it is said.
    pub(crate) assumed_restitution: Option<f64>,
    pub(crate) energy_gain: f64,
    /// Only with an energy gain.
    pub(crate) target_height: Option<f64>,
    pub(crate) strike: Striking,
    pub(crate) release: Release,
    pub(crate) topple_angle: f64,
    pub(crate) limits: Option<ActuatorLimits>,
    pub(crate) noise: Option<Noise>,
    draft: Draft,
}

impl Scene {
    /// The value of a field, its default included; none where the field does not apply.
    pub fn value(&self, name: Name) -> Option<Value> {
        self.draft.get(name)
    }

    /// The value of a field that is a number.
    pub fn number(&self, name: Name) -> Option<f64> {
        match self.value(name) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    /// What the scene was made of, with its defaults, to change a field and build again.
    pub fn draft(&self) -> Draft {
        self.draft
    }

    /// Which body bounces.
    pub fn body(&self) -> BodyShape {
        self.body
    }

    /// Its outline, where it is a polygon.
    pub fn outline(&self) -> Option<&Outline> {
        self.outline.as_ref()
    }

    /// The same with the rod of its l and ρ in place of a polygon.
    pub fn as_rod(&self) -> Self {
        let Some(outline) = self.outline else { return *self };
        let mut draft = self.draft;
        draft.set_vertices(None);
        let (contact_distance, radius_of_gyration) = (outline.contact_distance(), outline.radius_of_gyration());
        for (name, value) in [
            (Name::ContactVertex, None),
            (Name::ContactDistance, Some(Value::Number(contact_distance))),
            (Name::RadiusOfGyration, Some(Value::Number(radius_of_gyration))),
        ] {
            // Both are in their ranges, or it would be no polygon.
            let _ = draft.set(name, value);
        }
        draft.build().unwrap_or(*self)
    }

    /// The vertices of a polygon as they were given.
    pub fn vertices(&self) -> Option<&Vertices> {
        self.draft.vertices()
    }

    /// G = g sin φ, gravity in the plane of motion, m/s².
    pub fn gravity(&self) -> f64 {
        self.gravity
    }

    /// What starts the run.
    pub fn release(&self) -> &Release {
        &self.release
    }

    /// Angle and velocities at release.
    pub fn start(&self) -> &State {
        &self.release.state
    }
}
