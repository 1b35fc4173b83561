//! The bounce by general simulation methods, as people use them, to be charted against the exact map.
//!
//! Nothing that answers a user's scene uses them. The strike is [`Rod::strike`] throughout; what differs is how a method moves the
//! rod and how it notices that it meets the table. Times are in s, lengths in m, angles in rad.

mod adaptive;
mod course;
mod marching;
mod motion;
mod penalty;
mod sampling;
mod time_stepping;

use equipoise_physics::body::Release;
use equipoise_physics::bounce::strike::{Rod, State};
use equipoise_physics::run::orbit::Rules;

use course::{Course, Halt};

pub use penalty::STEPS_PER_CONTACT;

/// A method with its setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Runge-Kutta of order 4 with a fixed step. A contact shows by the sign of the gap at the end of a step.
    RungeKutta {
        /// Step, s.
        step: f64,
        /// What is done about a contact within a step.
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
    /// The exact flight, looked at on a grid of times.
    Sampling {
        /// From one look to the next, s.
        step: f64,
    },
}

/// What a method with fixed steps does about a contact within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// The strike is at the end of the step.
    StepEnd,
    /// The step is done again up to where the chord of the gap is zero.
    Secant,
    /// The step is done again and again, until the contact is known to the last digit.
    Bisection,
}

impl Method {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::RungeKutta { .. } => "runge_kutta",
            Self::Adaptive { .. } => "adaptive",
            Self::TimeStepping { .. } => "time_stepping",
            Self::Penalty { .. } => "penalty",
            Self::Sampling { .. } => "sampling",
        }
    }
}

/// One contact, as a method saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Its number, from 1.
    pub n: u64,
    /// When, s after release.
    pub t: f64,
    /// Where the centre of gravity is, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
}

/// Why a simulation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// As runs of the map end.
    Run(equipoise_physics::run::ending::Ending),
    /// The rod is below the table and falls, and no contact was seen.
    Missed {
        /// When that was noticed, s.
        t: f64,
    },
    /// It took all the steps that it was given.
    OutOfSteps {
        /// How many.
        steps: u64,
    },
}

impl Ending {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run(ending) => ending.name(),
            Self::Missed { .. } => "missed",
            Self::OutOfSteps { .. } => "out_of_steps",
        }
    }
}

/// What a simulation took: counts, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps, or looks at the flight, those that a method tried and gave up included.
    pub steps: u64,
    /// Evaluations of the right-hand side of the equations of motion.
    pub accelerations: u64,
    /// Evaluations of the gap between contact point and table.
    pub gaps: u64,
}

/// What a method made of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// The contacts that it saw.
    pub impacts: Vec<Impact>,
    /// Why it ended.
    pub ending: Ending,
    /// What it took.
    pub work: Work,
}

/// Runs a method from the release for so many contacts and at most so many steps. `go_on` is asked every few thousand steps, and there
/// is no answer once it says `false`.
///
/// The reasons for which a run ends are those of [`equipoise_physics::run::orbit::Orbit`], in the same order. Steps that are not positive end as `out_of_steps`.
pub fn simulate(
    method: Method,
    (rod, rules, release): (&Rod, &Rules, &Release),
    impacts: u64,
    most_steps: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Simulation> {
    let mut course = Course::new(*rod, *rules, *release, impacts, most_steps, go_on);
    let Err(halt) = match method {
        Method::RungeKutta { step, location } => marching::run(&mut course, step, location),
        Method::Adaptive { tolerance } => adaptive::run(&mut course, tolerance),
        Method::TimeStepping { step } => time_stepping::run(&mut course, step),
        Method::Penalty { step } => penalty::run(&mut course, step),
        Method::Sampling { step } => sampling::run(&mut course, step),
    };
    match halt {
        Halt::Stopped => None,
        Halt::Ended(ending) => Some(Simulation { impacts: course.impacts, ending, work: course.work }),
    }
}
