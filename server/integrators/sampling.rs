//! The exact flight on a grid of times, as in scripts that know the parabola and not its contact time.
//!
//! The method misses a contact between two samples if the gap is open again at the second.

use std::convert::Infallible;

use equipoise_physics::map::flight::Flight;
use equipoise_physics::numbers::trig;

use crate::integrators::motion::Motion;
use crate::integrators::simulation_run::{Halt, SimulationRun, bisect};

pub(crate) fn simulate(run: &mut SimulationRun, step: f64) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    let mut contact_t = 0.0;
    let mut flight = if at_contact {
        let strike = run.strike(0.0, &mut motion)?;
        run.rod.flight(&strike)
    } else {
        Flight {
            start: motion.state(),
            sin_cos_theta: trig::sin_cos(motion.place[2]),
            clearance: run.gap(&motion),
            contact_distance: run.rod.contact_distance,
            gravity: run.rod.gravity,
            drag: None,
        }
    };
    loop {
        let mut looks = 0.0;
        let end = loop {
            run.step(contact_t, &motion)?;
            looks += 1.0;
            run.work.gaps += 1;
            if flight.gap(looks * step).value <= 0.0 {
                break looks * step;
            }
        };
        let begin = end - step;
        let t = begin
            + bisect(step, |part| {
                run.work.gaps += 1;
                flight.gap(begin + part).value > 0.0
            });
        motion = after(&motion, &flight, t);
        contact_t += t;
        let strike = run.strike(contact_t, &mut motion)?;
        flight = run.rod.flight(&strike);
    }
}

/// The rod a time after the start of its flight. Its height at a contact is that of a contact.
fn after(start: &Motion, flight: &Flight, t: f64) -> Motion {
    let end = flight.end(t);
    let x = start.place[0] + end.x_dot * t;
    let y = flight.contact_distance * trig::sin_cos(end.theta).1;
    Motion { place: [x, y, end.theta], velocity: [end.x_dot, end.y_dot, end.theta_dot] }
}
