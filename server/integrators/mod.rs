//! The bounce by general simulation methods, as people use them, to be charted against the exact map.
//!
//! Nothing that answers a user's scene uses them. The strike is [`Rod::strike`] throughout; what differs is how a method moves the
//! rod and how it notices that it meets the table. Times are in s, lengths in m, angles in rad.

mod adaptive;
mod course;
mod marching;
mod method;
mod motion;
mod penalty;
mod sampling;
mod simulation;
mod time_stepping;

use equipoise_physics::body::Release;
use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::run::rules::Rules;

use course::{Course, Halt};

pub use method::{Location, Method};
pub use penalty::STEPS_PER_CONTACT;
pub use simulation::{Ending, Impact, Simulation, Work};

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
