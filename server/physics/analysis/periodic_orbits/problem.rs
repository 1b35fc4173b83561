//! The problem that a periodic orbit solves: a rod with the energy and the drift that close its equations; and the reasons for which
//! there is no orbit.

use crate::analysis::repeating::upright_speed;
use crate::analysis::small_deviations::small_deviations;
use crate::map::body::Body;
use crate::map::strike::{Rod, State};
use crate::map::table::program::HeightProgram;
use crate::run::ending::Ending;
use crate::scene::Scene;
use crate::scene::model::ModelLevel;

/// Remainder of the equations, in parts of the scene's speed, up to which they count as solved.
pub(super) const SOLVED: f64 = 1e-11;

/// The body of an orbit and the conditions that close its equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitProblem {
    /// The body. Of one with a program of heights, periods are multiples of their number.
    pub body: Body,
    /// Energy per unit mass that orbits must have, ½|v|² + Gy at a contact, m²/s²; `None` if feedback sets it.
    pub energy: Option<f64>,
    /// V of the upright bounce, m/s: the scale of velocities.
    pub speed: f64,
    /// |θ| at which a contact has toppled, rad.
    pub topple_angle: f64,
    /// True for the rod with friction or without, whose strikes look at angle and velocities alone: its energy and its drift are free unless its
    /// table steers them. Of other bodies the map itself tells what is free.
    pub is_rod: bool,
    /// True if orbits must have no drift.
    pub rests: bool,
}

impl OrbitProblem {
    /// The problem of a scene without its noise. Its energy is that of the release without the drift, as for the fixed point, or the energy that the table
    /// holds: orbits have no drift.
    ///
    /// # Errors
    /// A sentence that says why the scene has no periodic orbits.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let scene = &scene.without_noise();
        let body = scene.model();
        let Rod { gravity, contact_distance, .. } = body.rod;
        let is_rod = !body.is_point && scene.needs_at_most(&[ModelLevel::Friction]);
        let speed = match &body.program {
            None if is_rod => {
                small_deviations(scene)
                    .and_then(|small| small.without_drift(scene))
                    .map_err(|why| format!("no bounce repeats: {why}"))?
                    .fixed_point
                    .speed
            }
            None => upright_speed(scene).ok_or("the release is too low for a bounce")?,
            Some(program) => speed_from(&body.rod, program)?,
        };
        let energy = 0.5 * speed * speed + gravity * contact_distance;
        let energy = (!scene.steers_energy()).then_some(energy);
        Ok(Self { body, energy, speed, topple_angle: scene.topple_angle, is_rod, rests: true })
    }

    /// The same with fewer conditions, in the order in which they are tried. What nothing keeps along an orbit has the value that the orbit gives it.
    pub(super) fn with_fewer_conditions(self) -> Vec<Self> {
        if self.is_rod {
            return vec![self];
        }
        let free = Self { energy: None, ..self };
        let mut tried = vec![self, free, Self { rests: false, ..self }, Self { rests: false, ..free }];
        tried.dedup();
        tried
    }

    /// The upright bounce, which is the orbit of period 1; with a program, the bounce before its first strike.
    pub fn upright(&self) -> State {
        State { theta: 0.0, x_dot: 0.0, y_dot: -self.speed, theta_dot: 0.0 }
    }
}

/// Speed of an upright bounce, m/s, at the first strike of a program: it comes from the last height.
fn speed_from(rod: &Rod, program: &HeightProgram) -> Result<f64, String> {
    let height = program.at(program.heights().len() as u64);
    let square = 2.0 * rod.gravity * (height - rod.contact_distance);
    let too_low = || format!("the last height of program is {height} m, which is not above {} m", rod.contact_distance);
    (square > 0.0).then(|| square.sqrt()).ok_or_else(too_low)
}

/// Reason for which there is no orbit.
#[derive(Clone, Debug, PartialEq)]
pub enum OrbitFailure {
    /// The run from the best state so far ends before it could come back.
    Ends {
        /// At which contact, from 1.
        contact: u64,
        /// How.
        ending: Ending,
    },
    /// The iteration came to no orbit.
    NoConvergence {
        /// Remainder of the equations, in parts of the scene's speed.
        residual: f64,
        /// Steps taken.
        steps: u32,
    },
    /// The iteration came to the body at rest on the table.
    AtRest {
        /// Largest |ẏ| before a contact, m/s.
        speed: f64,
    },
    /// The scene itself does not allow it here.
    Scene(String),
    /// Nobody wants it any more.
    Cancelled,
}

impl std::fmt::Display for OrbitFailure {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Ends { contact, ending } => {
                write!(formatter, "the run ends as `{}` at contact {contact}, before it could come back", ending.name())
            }
            Self::NoConvergence { residual, steps } => write!(
                formatter,
                "Newton's iteration found no orbit: after {steps} steps the equations are off by {residual} (no unit; \
                 {} is taken as solved)",
                SOLVED
            ),
            Self::AtRest { speed } => write!(
                formatter,
                "Newton's iteration came to the body at rest on the table (ẏ = {speed} m/s), which bounces no more: \
                 give another guess"
            ),
            Self::Scene(why) => formatter.write_str(why),
            Self::Cancelled => formatter.write_str("cancelled"),
        }
    }
}
