//! Motion aside of a body whose table tilts by a constant beside its law: there is no bounce in place.
//!
//! Not here: state feedback of x, which has one, farther on ([`crate::analysis::small_deviations`]).

use crate::analysis::contact_regime::{ContactRegime, contact_regime};
use crate::numbers::trig;
use crate::scene::{BodyShape, Scene};
use std::f64::consts::FRAC_PI_2;

/// Motion to which a constant tilt drives a body that the table balances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SteadyDrift {
    /// The body leans at an angle at which the table is square to it, and every strike drives it aside.
    Accelerates {
        /// θ = −c/(κ − 1), rad.
        theta: f64,
        /// −G tan θ, m/s², while the drift is slow beside the bounce; `None` where friction holds the contact.
        acceleration: Option<f64>,
    },
    /// Feedback of ẋ holds the body upright at a velocity at which the table is level.
    Moves {
        /// c/K_ẋ, m/s.
        speed: f64,
    },
    /// The table is square to the body at no angle below π/2, so that the angle leaves too.
    Turns,
}

impl SteadyDrift {
    /// The motion of a scene; `None` without a constant tilt, with feedback of x, for a point mass, and in air that drags the body.
    ///
    /// A strike turns the body by sin β, β = θ − α with α = κθ + c. At β = 0 it has the impulse P along the table's normal, with
    /// P cos α = 2V for the bounce, so ẋ changes by −2V tan α in a flight of 2V/G.
    pub fn of(scene: &Scene) -> Option<Self> {
        let tilt = scene.constant_tilt();
        if tilt == 0.0 || scene.drag().is_some() || scene.body() == BodyShape::Point {
            return None;
        }
        let [x, theta, x_dot, _] = scene.model().feedback().unwrap_or([0.0, -scene.tilt_gain, 0.0, 0.0]);
        if x != 0.0 {
            return None;
        }
        if x_dot != 0.0 {
            return Some(Self::Moves { speed: tilt / x_dot });
        }
        let lean = tilt / (1.0 + theta);
        if !lean.is_finite() || lean.abs() >= FRAC_PI_2 {
            return Some(Self::Turns);
        }
        let (sin, cos) = trig::sin_cos(lean);
        let slips = contact_regime(&scene.model()) != ContactRegime::Sticking;
        Some(Self::Accelerates { theta: lean, acceleration: slips.then(|| -scene.gravity() * (sin / cos)) })
    }

    /// Time, s, after which a body that started at rest in the middle has left a table with ends at ±`half_length` (m).
    pub fn time_on_table(&self, half_length: f64) -> Option<f64> {
        match *self {
            Self::Accelerates { acceleration, .. } => {
                acceleration.map(|acceleration| (2.0 * half_length / acceleration.abs()).sqrt())
            }
            Self::Moves { speed } => Some(half_length / speed.abs()),
            Self::Turns => None,
        }
        .filter(|time| time.is_finite())
    }
}
