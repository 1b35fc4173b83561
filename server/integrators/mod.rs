//! The bounce by general simulation methods, as people use them, to be charted against the exact map.
//!
//! Answers about a user's scene do not use them. The strike is that of the map, [`Body::strike`](equipoise_physics::map::body::Body::strike),
//! throughout; methods differ in how they move the rod and how they notice that it meets the table. Times are in s, lengths in m, angles
//! in rad.

mod methods;
mod simulation;

use equipoise_physics::map::body::{Body, Release};
use equipoise_physics::run::rules::Rules;

use crate::integrators::simulation::{Halt, SimulationRun};

pub use crate::integrators::methods::{Location, STEPS_PER_CONTACT};
pub use simulation::{SimulatedImpact, Simulation, SimulationEnding, WorkCount};

/// A method with its setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// Runge-Kutta of order 4 with a fixed step. A contact shows by the sign of the gap at the end of a step.
    RungeKutta {
        /// Step, s.
        step: f64,
        /// Treatment of a contact within a step.
        location: Location,
    },
    /// Dormand and Prince's Runge-Kutta 5(4) with steps of its own choice, as ODE libraries have it. A contact shows by the sign of
    /// the gap at the end of a step and is located on the dense output.
    Adaptive {
        /// Absolute and relative tolerance.
        tolerance: f64,
    },
    /// Moreau and Jean's time stepping with the midpoint rule: a contact is closed for a whole step, and known only to the step.
    TimeStepping {
        /// Step, s.
        step: f64,
    },
    /// A spring and a damper along the table's normal in place of the strike, moved by Runge-Kutta of order 4.
    Penalty {
        /// Step, s; the spring is as stiff as [`STEPS_PER_CONTACT`] of them allow.
        step: f64,
    },
    /// The exact flight, evaluated on a grid of times.
    Sampling {
        /// Interval of the grid, s.
        step: f64,
    },
}

impl Integrator {
    /// The method with another setting: its step, s, or its tolerance.
    #[must_use]
    pub fn with(self, value: f64) -> Self {
        match self {
            Self::RungeKutta { location, .. } => Self::RungeKutta { step: value, location },
            Self::Adaptive { .. } => Self::Adaptive { tolerance: value },
            Self::TimeStepping { .. } => Self::TimeStepping { step: value },
            Self::Penalty { .. } => Self::Penalty { step: value },
            Self::Sampling { .. } => Self::Sampling { step: value },
        }
    }
}

/// Runs a method from the release for so many contacts and at most so many steps. `go_on` is asked every few thousand steps, and there
/// is no answer once it says `false`.
///
/// The reasons for which a run ends are those of [`equipoise_physics::run::orbit::Orbit`], in the same order. Steps that are not positive end as `out_of_steps`.
pub fn simulate(
    method: Integrator,
    (body, rules, release): (&Body, &Rules, &Release),
    impacts: u64,
    most_steps: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Simulation> {
    let mut run = SimulationRun::new(*body, *rules, *release, impacts, most_steps, go_on);
    let Err(halt) = match method {
        Integrator::RungeKutta { step, location } => methods::marching(&mut run, step, location),
        Integrator::Adaptive { tolerance } => methods::adaptive(&mut run, tolerance),
        Integrator::TimeStepping { step } => methods::time_stepping(&mut run, step),
        Integrator::Penalty { step } => methods::penalty(&mut run, step),
        Integrator::Sampling { step } => methods::sampling(&mut run, step),
    };
    match halt {
        Halt::Stopped => None,
        Halt::Ended(ending) => Some(Simulation { impacts: run.impacts, ending, work: run.work }),
    }
}
