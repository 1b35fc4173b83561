//! Random requests whose work is mostly lasting contact: catches, throws with a catch, runs that are held, caught and thrown, and their
//! previews. Weights, gains, gravity and the body are from wide ranges, so that some contacts are stiff.

use rand::RngExt;
use serde_json::{Map, Value, json};

use crate::draw::{Draw, Request};

/// The resources whose answers have contacts.
pub(crate) const CONTACTS: [&str; 4] = ["catches", "throws", "trajectories", "previews"];

impl Draw {
    /// A number between two, uniform in its logarithm.
    fn sized(&mut self, from: f64, to: f64) -> f64 {
        from * (to / from).powf(self.0.random::<f64>())
    }

    /// A request to one of [`CONTACTS`], which may be refused.
    pub(crate) fn contact(&mut self, resource: &str) -> Request {
        let mut body = match resource {
            "catches" => self.settings(),
            "throws" => {
                let apex = json!({"height": 0.1 + self.0.random::<f64>(), "theta": self.sized(1e-3, 1.0)});
                Map::from_iter([("apex".to_owned(), apex), ("catch".to_owned(), Value::Object(self.settings()))])
            }
            _ => {
                let mut body = Map::from_iter([("bounces".to_owned(), json!(self.0.random_range(5..200)))]);
                let interventions: Vec<Value> = (0..self.0.random_range(0..4)).map(|_| self.intervention()).collect();
                if resource == "trajectories" && self.0.random_bool(0.7) {
                    body.insert("hold".to_owned(), json!(self.sized(0.1, 60.0)));
                }
                body.insert("interventions".to_owned(), Value::Array(interventions));
                body
            }
        };
        if resource == "catches" {
            body.insert("hold_samples".to_owned(), json!(self.0.random_range(2..=600)));
        }
        body.insert("scene".to_owned(), self.held_scene());
        Request { body: Value::Object(body), accept: "application/json", gzip: false }
    }

    /// A catch, a throw, a kick or a change of the law.
    fn intervention(&mut self) -> Value {
        let impact = self.0.random_range(1..30);
        match self.0.random_range(0..5) {
            0 | 1 => json!({"impact": impact, "catch": self.settings()}),
            2 => {
                json!({"impact": impact, "throw": {"apex": {"height": 0.1 + self.0.random::<f64>(), "theta": 0.1}, "t": 1.0}})
            }
            3 => json!({"impact": impact, "kick": {"x_dot": self.sized(1e-3, 1.0)}}),
            _ => json!({"impact": impact, "set": {"table.tilt_gain": 1.0 + self.sized(1e-2, 50.0)}}),
        }
    }

    /// Settings of a catch.
    fn settings(&mut self) -> Map<String, Value> {
        let strategy = ["auto", "bounce_down", "plan", "brake"][self.0.random_range(0..4)];
        let mut settings = Map::from_iter([
            ("strategy".to_owned(), json!(strategy)),
            ("hold".to_owned(), json!(self.sized(0.1, 60.0))),
            ("hold_speed".to_owned(), json!(self.sized(1e-4, 0.1))),
        ]);
        if self.0.random_bool(0.6) {
            let state =
                ["x", "theta", "x_dot", "theta_dot"].map(|name| (name.to_owned(), json!(self.sized(1e-2, 1e4))));
            let weights = json!({"state": Map::from_iter(state), "input": self.sized(1e-2, 1e2)});
            settings.insert("weights".to_owned(), weights);
        }
        if self.0.random_bool(0.5) {
            match strategy {
                "bounce_down" => settings.insert("ratio".to_owned(), json!(0.05 + 0.93 * self.0.random::<f64>())),
                "plan" => settings.insert("strikes".to_owned(), json!(self.0.random_range(4..=40))),
                "brake" => settings.insert("brake".to_owned(), json!(self.sized(1e-2, 1e4))),
                _ => None,
            };
        }
        settings
    }

    /// A scene whose body comes to the table nearly upright.
    fn held_scene(&mut self) -> Value {
        let length = if self.0.random_bool(0.5) { 0.13333 } else { self.sized(1e-3, 10.0) };
        let gyration = if self.0.random_bool(0.4) { 0.7 * length } else { self.sized(0.01, 10.0) * length };
        let mut scene = json!({
            "body": {"contact_distance": length, "radius_of_gyration": gyration.clamp(1e-3, 10.0)},
            "release": {"height": 1.01 * length + self.sized(1e-2, 10.0), "theta": self.sized(1e-10, 0.5)},
            "contact": {"restitution": self.0.random::<f64>()},
            "table": {"tilt_gain": 1.0 + self.sized(1e-2, 3.0)},
            "gravity": if self.0.random_bool(0.5) { 9.81 } else { self.sized(0.1, 100.0) },
        });
        if self.0.random_bool(0.4) {
            // Bounces that die down, so that a hold follows.
            scene["table"]["strike"] = json!("still");
            scene["contact"]["restitution"] = json!(0.5 * self.0.random::<f64>());
        }
        if self.0.random_bool(0.3) {
            scene["contact"]["friction"] = json!(self.sized(1e-2, 10.0));
            scene["table"]["slide"] = json!(["matched", "none"][self.0.random_range(0..2)]);
        }
        if self.0.random_bool(0.15) {
            let count = self.0.random_range(3..24);
            let places = (0..count).map(|vertex| {
                let angle = std::f64::consts::TAU * (f64::from(vertex) + 0.5) / f64::from(count);
                json!([0.1 * angle.sin(), -0.1 * angle.cos()])
            });
            scene["body"] = json!({"vertices": places.collect::<Vec<_>>()});
            scene["release"]["height"] = json!(0.2 + self.0.random::<f64>());
        }
        scene
    }
}
