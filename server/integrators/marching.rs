//! Runge-Kutta of order 4 with a fixed step, the first thing that is tried.
//!
//! A free flight is a parabola, which the method follows without error: all that is off comes from the contacts. One that begins and
//! ends within a step is not seen.

use std::convert::Infallible;

use crate::integrators::simulation_run::{Halt, SimulationRun, bisect};

/// Treatment of a contact within a step, by a method with fixed steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// The strike is at the end of the step.
    StepEnd,
    /// The step is done again up to where the chord of the gap is zero.
    Secant,
    /// The step is done again and again, until the contact is known to the last digit.
    Bisection,
}

pub(crate) fn simulate(run: &mut SimulationRun, step: f64, location: Location) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    // Steps are counted from the last contact, so that rounding of t does not add up.
    let (mut contact_t, mut steps) = (0.0, 0.0);
    if at_contact {
        run.strike(0.0, &mut motion)?;
    }
    let mut gap = run.gap(&motion);
    loop {
        let t = contact_t + steps * step;
        run.step(t, &motion)?;
        let next = run.fly(&motion, step);
        let next_gap = run.gap(&next);
        // After a strike at the end of a step the contact point may be below the table, on its way up.
        let falls = next_gap < gap;
        if next_gap > 0.0 || (gap <= 0.0 && !falls) {
            (motion, gap, steps) = (next, next_gap, steps + 1.0);
            continue;
        }
        let part = match location {
            Location::StepEnd => step,
            Location::Secant if gap > 0.0 => step * (gap / (gap - next_gap)),
            Location::Secant => 0.0,
            Location::Bisection => bisect(step, |part| {
                let there = run.fly(&motion, part);
                run.gap(&there) > 0.0
            }),
        };
        motion = if location == Location::StepEnd { next } else { run.fly(&motion, part) };
        (contact_t, steps) = (t + part, 0.0);
        run.strike(contact_t, &mut motion)?;
        gap = run.gap(&motion);
    }
}
