//! The upright bounce in place that a scene is to be balanced on, and the drift beside it.
//!
//! Not here: how a small deviation from it moves ([`crate::stability::linear_verdict`]).

use crate::body::general::{Gains, Steering};
use crate::bounce::strike::Rod;
use crate::scene::model::Rung;
use crate::scene::{BodyShape, Scene, Striking};
use crate::stability::contact_regime::Grip;

/// The rungs above the plain rod that can be judged linearly.
pub const JUDGED: [Rung; 3] = [Rung::Rod, Rung::RodWithX, Rung::Friction];

/// The upright bounce in place that a scene is to be balanced on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPoint {
    /// V = |ẏ*|, m/s.
    pub speed: f64,
    /// 2V/G, s.
    pub flight_time: f64,
    /// Height of the centre of gravity at the top of the bounce, m.
    pub apex_height: f64,
}

impl Scene {
    /// c = ẋ − κρ²θ̇/((κ − 1)l), or ẋ − (κρ² + l²)θ̇/((κ − 1)l) where a matched contact sticks: the mean horizontal speed of a balanced
    /// run, m/s. None where κ = 1, which drifts off in angle instead, where friction holds the contact, and for a point mass, whose
    /// drift dies out.
    pub fn drift_speed(&self) -> Option<f64> {
        if self.beyond(&[Rung::Friction]).is_some() || self.grip() == Grip::Held {
            return None;
        }
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else { return None };
        let start = self.start();
        let excess = self.tilt_gain - 1.0;
        (excess != 0.0).then(|| {
            let lever = radius_of_gyration * radius_of_gyration / contact_distance;
            let stuck = if self.grip() == Grip::Matched { contact_distance } else { 0.0 };
            start.x_dot - (self.tilt_gain * lever + stuck) * start.theta_dot / excess
        })
    }

    /// The fixed point on the energy surface of the release, or that of the target height with energy feedback.
    ///
    /// V² = |v₀|² + 2G(y₀ − l) − c²: drift energy never comes back, and what counts is the height above l, not above
    /// l cos θ as in eq. (10). A matched table with friction lends some more. Friction on one that only tilts takes the
    /// energy of sideways motion and spin, so there V² = ẏ₀² + 2G(y₀ − l).
    ///
    /// # Errors
    /// Why there is none, in a sentence.
    pub fn fixed_point(&self) -> Result<FixedPoint, String> {
        if let Some(error) = self.beyond(&JUDGED) {
            return Err(error.detail);
        }
        if self.feedback().is_some() {
            return self.bounce_in_place();
        }
        if self.is_lossy() {
            return Err(format!(
                "{}: every bounce loses energy, so no bounce repeats",
                match self.strike {
                    Striking::Still => format!("the table stands still and restitution is {}", self.restitution),
                    Striking::Compensated => self.belief(),
                }
            ));
        }
        if self.energy_gain == 0.0 && self.assumed_restitution() < self.restitution {
            return Err(format!("{}: every bounce gains energy, so no bounce repeats", self.belief()));
        }
        let (contact_distance, radius_of_gyration) = match self.body {
            BodyShape::Rod { contact_distance, radius_of_gyration } => (contact_distance, radius_of_gyration),
            BodyShape::Point => (0.0, 0.0),
        };
        let speed_squared = if let Some(height) = self.target_height {
            let settled = height + self.height_error();
            let room = settled - contact_distance;
            if room <= 0.0 {
                let why =
                    if settled == height { String::new() } else { format!(", where {} holds it,", self.belief()) };
                return Err(format!(
                    "target_height {settled} m{why} is not above contact_distance {contact_distance} m"
                ));
            }
            2.0 * self.gravity * room
        } else {
            let start = self.start();
            let spin = radius_of_gyration * start.theta_dot;
            let drift = self.drift_speed().unwrap_or(0.0);
            let mut kinetic = start.y_dot * start.y_dot;
            if self.grip() != Grip::Held {
                kinetic += start.x_dot * start.x_dot + spin * spin + self.lent(drift);
            }
            let available = kinetic + 2.0 * self.gravity * (self.release.height - contact_distance);
            if available - drift * drift <= 0.0 {
                return Err(format!(
                    "the release has {available} m²/s² for bouncing upright and the drift at {drift} m/s takes {} m²/s²: no \
                     upright bounce has that energy",
                    drift * drift
                ));
            }
            available - drift * drift
        };
        let speed = speed_squared.sqrt();
        Ok(FixedPoint {
            speed,
            flight_time: 2.0 * speed / self.gravity,
            apex_height: contact_distance + speed_squared / (2.0 * self.gravity),
        })
    }

    fn belief(&self) -> String {
        format!("the table believes restitution {} and meets {}", self.assumed_restitution(), self.restitution)
    }

    /// How far above the target height the energy feedback comes to rest, m: where the strike gain is 2 for an assumed restitution
    /// ê, κ_E(η* − η) = 2(ê − e)/((1 + e)(1 + ê)). Nothing without feedback, or where ê is e.
    pub fn height_error(&self) -> f64 {
        let (e, assumed) = (self.restitution, self.assumed_restitution());
        if self.energy_gain == 0.0 || e == assumed {
            return 0.0;
        }
        2.0 * (e - assumed) / ((1.0 + e) * (1.0 + assumed) * self.energy_gain * self.gravity)
    }

    /// K, where the table feeds the state back, in the order of [`STATE`].
    pub fn feedback(&self) -> Option<[f64; 4]> {
        match self.steering {
            Steering::TiltGain => None,
            Steering::Feedback(Gains { x, theta, x_dot, theta_dot }) => Some([x, theta, x_dot, theta_dot]),
        }
    }

    /// The upright bounce in place that a law with feedback comes to: where the strike neither takes energy nor gives any, on the
    /// energy of the release where that holds at any height. No drift is left, which is what sets it apart from that of a
    /// proportional tilt. Friction takes the energy of sideways motion and spin.
    ///
    /// # Errors
    /// Why there is none, in a sentence.
    pub fn bounce_in_place(&self) -> Result<FixedPoint, String> {
        if self.body() == BodyShape::Point {
            return Err("a point mass has no angle to feed back".to_owned());
        }
        let rod: Rod = self.parameters();
        let weight = rod.gravity * rod.contact_distance;
        let speed_squared = if rod.strike_gain_per_energy != 0.0 {
            2.0 * (rod.target_energy + (rod.strike_gain - 2.0) / rod.strike_gain_per_energy - weight)
        } else if rod.strike_gain != 2.0 {
            return Err(format!(
                "the table gives back {} of a bounce's normal speed and nothing steers its height, so no bounce repeats",
                rod.strike_gain - 1.0
            ));
        } else {
            let start = self.start();
            let spin = rod.radius_of_gyration * start.theta_dot;
            let mut kinetic = start.y_dot * start.y_dot;
            if self.grip() == Grip::Smooth {
                kinetic += start.x_dot * start.x_dot + spin * spin;
            }
            kinetic + 2.0 * (rod.gravity * self.release().height - weight)
        };
        if !speed_squared.is_finite() || speed_squared <= 0.0 {
            return Err(format!("the square of its speed would be {speed_squared} m²/s²: there is no upright bounce"));
        }
        let speed = speed_squared.sqrt();
        Ok(FixedPoint {
            speed,
            flight_time: 2.0 * speed / rod.gravity,
            apex_height: rod.contact_distance + speed_squared / (2.0 * rod.gravity),
        })
    }
}
