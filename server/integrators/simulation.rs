//! The result of a simulation: the contacts that a method saw, its ending and its work.

use equipoise_physics::map::strike::State;

/// One contact, as a method saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedImpact {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Time, s after release.
    pub t: f64,
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
}

/// Ending of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SimulationEnding {
    /// An ending that runs of the map have too.
    Run(equipoise_physics::run::ending::Ending),
    /// The rod is below the table and falls, and no contact was seen.
    Missed {
        /// Time at which that was noticed, s.
        t: f64,
    },
    /// It took all the steps that it was given.
    OutOfSteps {
        /// Number of steps.
        steps: u64,
    },
}

impl SimulationEnding {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run(ending) => ending.name(),
            Self::Missed { .. } => "missed",
            Self::OutOfSteps { .. } => "out_of_steps",
        }
    }
}

/// Work of a simulation: counts, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkCount {
    /// Steps, or looks at the flight, those that a method tried and gave up included.
    pub steps: u64,
    /// Evaluations of the right-hand side of the equations of motion.
    pub accelerations: u64,
    /// Evaluations of the gap between contact point and table.
    pub gaps: u64,
}

/// Result of a method on a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// The contacts that it saw.
    pub impacts: Vec<SimulatedImpact>,
    /// Ending of the run.
    pub ending: SimulationEnding,
    /// Work that it took.
    pub work: WorkCount,
}
