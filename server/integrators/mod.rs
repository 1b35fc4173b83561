//! The bounce by general simulation methods, as people use them, to be charted against the exact map.
//!
//! Nothing that answers a user's scene uses them. The strike is [`Rod::strike`] throughout; what differs is how a method moves the
//! rod and how it notices that it meets the table. Times are in s, lengths in m, angles in rad.

mod adaptive;
mod integrator;
mod marching;
mod motion;
mod penalty;
mod sampling;
mod simulation;
mod simulation_run;
mod time_stepping;

use equipoise_physics::body::Release;
use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::run::rules::Rules;

use simulation_run::{Halt, SimulationRun};

pub use integrator::{Integrator, Location};
pub use penalty::STEPS_PER_CONTACT;
pub use simulation::{SimulatedImpact, Simulation, SimulationEnding, WorkCount};

/// Runs a method from the release for so many contacts and at most so many steps. `go_on` is asked every few thousand steps, and there
/// is no answer once it says `false`.
///
/// The reasons for which a run ends are those of [`equipoise_physics::run::orbit::Orbit`], in the same order. Steps that are not positive end as `out_of_steps`.
pub fn simulate(
    method: Integrator,
    (rod, rules, release): (&Rod, &Rules, &Release),
    impacts: u64,
    most_steps: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Simulation> {
    let mut run = SimulationRun::new(*rod, *rules, *release, impacts, most_steps, go_on);
    let Err(halt) = match method {
        Integrator::RungeKutta { step, location } => marching::simulate(&mut run, step, location),
        Integrator::Adaptive { tolerance } => adaptive::simulate(&mut run, tolerance),
        Integrator::TimeStepping { step } => time_stepping::simulate(&mut run, step),
        Integrator::Penalty { step } => penalty::simulate(&mut run, step),
        Integrator::Sampling { step } => sampling::simulate(&mut run, step),
    };
    match halt {
        Halt::Stopped => None,
        Halt::Ended(ending) => Some(Simulation { impacts: run.impacts, ending, work: run.work }),
    }
}
