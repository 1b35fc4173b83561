//! The picture of `trajectories`: the phase planes.

use equipoise_physics::scene::{Name, Scene};

use crate::api::formats::Pictured;
use crate::api::scene::has_angle;
use crate::api::trajectories::answer::TrajectoryAnswer;
use crate::charts::{PhasePlanes, phase_planes};
use crate::http::Problem;

impl Pictured for TrajectoryAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        let column = |name: &str| self.impacts.0.iter().find(|column| column.name == name)?.cells.numbers();
        let numbers = |name| column(name).unwrap_or_default();
        let theta_dot = column("theta_dot");
        Ok(phase_planes(&PhasePlanes {
            title: &format!("Contacts of {}", law(self.scene.0)),
            subtitle: &format!("{}: {}", self.outcome.kind, self.outcome.detail),
            theta: &numbers("theta"),
            theta_dot: theta_dot.as_deref(),
            x_dot: &numbers("x_dot"),
            y_dot: &numbers("y_dot"),
        }))
    }
}

/// Describes the body and the law of its table in a few words.
fn law(scene: &Scene) -> String {
    let body = if has_angle(scene) { "a rod" } else { "a point" };
    match scene.number(Name::TiltGain) {
        Some(gain) => format!("{body} with κ = {gain}"),
        None => format!("{body} with state feedback"),
    }
}
