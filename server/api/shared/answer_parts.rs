//! Parts of several answers: the model, the fixed point, an eigenvalue, the nearest vertex, the largest load of the actuators, and the picture of
//! a closed loop.

use equipoise_physics::analysis::method::RunMethod;
use equipoise_physics::analysis::{fixed_point, jacobian};
use equipoise_physics::control::bounce_model::{BounceModel, ClosedLoop};
use equipoise_physics::map::polygon::{Outline, VertexClearance};
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::model::{ModelLevel, ModelRequirement};
use nalgebra::Complex;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::model_words::{level_reason, model_reason};
use crate::charts::{Loop, closed_loop, significant};
use crate::words;

words! {
    /// A rung of the ladder of models: a point mass; the angle block of a rod in closed form (`linear`, if that method was chosen); the rod;
    /// the rod on a table that also reacts to its position; with constant errors of the rig; a turning table; a delay; drag; with friction or a
    /// table that moves along itself; with noise; with the outline of a polygon.
    pub Rung = ModelLevel::ALL.map(ModelLevel::name);
}

/// The simplest model that is exact for the scene.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Model")]
pub struct ModelChoice {
    /// Name of the model.
    #[schemars(with = "Rung")]
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
    /// The fields that require the rungs above the rod, from the lowest.
    pub forced: Vec<RequirementAnswer>,
}

/// A field that requires a rung.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Forced")]
pub struct RequirementAnswer {
    #[schemars(with = "Rung")]
    rung: &'static str,
    /// Dotted path in a scene.
    field: &'static str,
    /// The reason, in a sentence.
    detail: String,
}

impl RequirementAnswer {
    /// A requirement of a scene.
    pub fn new(scene: &Scene, ModelRequirement { level, path }: ModelRequirement) -> Self {
        Self { rung: level.name(), field: path, detail: level_reason(scene, level).unwrap_or_default() }
    }

    /// Path of the field.
    pub fn field(&self) -> &'static str {
        self.field
    }
}

impl ModelChoice {
    /// The model of a scene.
    pub fn of(scene: &Scene) -> Self {
        let forced = scene.requirements().into_iter().map(|requirement| RequirementAnswer::new(scene, requirement));
        Self { name: scene.model_level().name(), reason: model_reason(scene), forced: forced.collect() }
    }

    /// The model that a run method computes a scene with.
    pub(crate) fn by_method(scene: &Scene, method: RunMethod) -> Self {
        if method != RunMethod::Linear {
            return Self::of(scene);
        }
        let reason = "the linear solution is accurate enough here, or was asked for: the angle block of the linear map";
        Self { name: ModelLevel::Linear.name(), reason: reason.to_owned(), forced: Vec::new() }
    }
}

/// The upright bounce, just before its impact.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "FixedPoint")]
pub(crate) struct FixedPointAnswer {
    /// Place of the centre of gravity to which a constant error of the tilt has moved it, m. Absent at 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x: Option<f64>,
    /// Angle, rad.
    theta: f64,
    /// Horizontal velocity, m/s. It is `drift_speed` where the table holds the total energy, else 0.
    x_dot: f64,
    /// Vertical velocity, m/s.
    pub(crate) y_dot: f64,
    /// Angular velocity, rad/s.
    theta_dot: f64,
    /// Time from impact to impact, s.
    pub(crate) flight_time: f64,
    /// Height of the centre of gravity at the top, m.
    apex_height: f64,
}

impl From<fixed_point::FixedPoint> for FixedPointAnswer {
    fn from(fixed_point: fixed_point::FixedPoint) -> Self {
        let State { theta, x_dot, y_dot, theta_dot } = fixed_point.state();
        let fixed_point::FixedPoint { x, flight_time, apex_height, .. } = fixed_point;
        Self { x: (x != 0.0).then_some(x), theta, x_dot, y_dot, theta_dot, flight_time, apex_height }
    }
}

/// An eigenvalue of a linear map.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct Eigenvalue {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
    /// Modulus.
    pub modulus: f64,
}

impl From<Complex<f64>> for Eigenvalue {
    fn from(value: Complex<f64>) -> Self {
        Self { re: value.re, im: value.im, modulus: jacobian::modulus(value) }
    }
}

/// For a polygon: the vertex, other than the contact vertex, that was nearest to the table at any contact. It shows how far the run is from
/// ending as `other_vertex`. Absent for other bodies, and without a contact.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct NearestVertex {
    /// Number of the vertex, from 0.
    vertex: usize,
    /// Distance of the vertex from the line of the table, m. Negative below it.
    clearance: f64,
    /// Number of the impact.
    impact: u64,
    /// Time since the release, s.
    t: f64,
}

impl NearestVertex {
    /// The nearer of the nearest vertex so far and the nearest at a contact.
    pub(crate) fn or(so_far: Option<Self>, outline: &Outline, contact: &Contact) -> Self {
        let VertexClearance { vertex, clearance } = outline.nearest(sin_cos(contact.state.theta - contact.alpha));
        match so_far {
            Some(nearest) if nearest.clearance <= clearance => nearest,
            _ => Self { vertex, clearance, impact: contact.n, t: contact.t },
        }
    }
}

/// Largest motions that the run requires of the table, to compare with what a rig can do.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Demand")]
pub struct LoadAnswer {
    /// Largest tilt at a strike, rad.
    tilt: f64,
    /// Largest mean tilt rate from one strike to the next, and the largest tilt rate in the contact of a catch, rad/s.
    tilt_rate: f64,
    /// Largest speed of the table at a strike, m/s.
    speed: f64,
    /// Longest vertical stroke of the table between two strikes, from its lowest to its highest point, m. The table is at y = 0 at each strike
    /// and moves as a cubic in time with the velocities of both strikes, which is the path of least mean square acceleration.
    stroke: f64,
}

impl From<ActuatorLoad> for LoadAnswer {
    fn from(ActuatorLoad { tilt, tilt_rate, speed, stroke }: ActuatorLoad) -> Self {
        Self { tilt, tilt_rate, speed, stroke }
    }
}

/// Number of factors on the gain at which the eigenvalues' path is drawn.
const FACTORS: usize = 160;

/// The eigenvalues of a law's closed loop on the unit circle, and their path as the gain is scaled, as SVG.
pub(crate) fn draw_closed_loop(title: &str, caption: &str, model: &BounceModel, gain: [f64; 4]) -> String {
    let states = model.fed_back(gain);
    let eigenvalues = |factor: f64| -> Vec<(f64, f64)> {
        let closed = model.closed_loop(gain.map(|gain| gain * factor), states);
        closed.iter().flat_map(|closed| &closed.eigenvalues).map(|value| (value.re, value.im)).collect()
    };
    let closed = model.closed_loop(gain, states);
    let is_stable = closed.as_ref().is_some_and(ClosedLoop::is_stable);
    let margin = model.stable_factors(gain, states).filter(|_| is_stable);
    let lower = margin.map(|it| it.lower).filter(|lower| *lower > 0.0);
    let upper = margin.map(|it| it.upper).filter(|upper| upper.is_finite());
    let high = upper.map_or(2.0, |upper| 1.0 + 1.4 * (upper - 1.0)).min(10.0);
    let low = lower.map_or(0.0, |lower| 1.0 - 1.4 * (1.0 - lower)).max(0.0);
    let way = (0..=FACTORS).map(|step| {
        let factor = low + (high - low) * step as f64 / FACTORS as f64;
        (factor, eigenvalues(factor))
    });
    let number = |value: f64| significant(value, 4);
    let [x, theta, x_dot, theta_dot] = gain.map(number);
    let subtitle = format!(
        "α = −K·(x, θ, ẋ, θ̇) with K = ({x}, {theta}, {x_dot}, {theta_dot}); largest |λ| = {}",
        number(closed.map_or(f64::NAN, |closed| closed.spectral_radius))
    );
    closed_loop(&Loop {
        title,
        subtitle: &subtitle,
        caption,
        closed: &eigenvalues(1.0),
        open: &eigenvalues(0.0),
        way: &way.collect::<Vec<_>>(),
        margin: (lower, upper),
    })
}
