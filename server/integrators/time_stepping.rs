//! Time stepping after Moreau (1988) and Jean (1999), as engines of many contacts do it: velocities and impulses of a whole step, the
//! gap at its middle, Newton's restitution between the velocities at its ends.
//!
//! With U the relative velocity along the normal, 0 ≤ U⁺ + e U⁻ ⊥ P ≥ 0 while the gap is closed. The table moves as the strike says,
//! so that impulse comes from the strike of the map, with its part along the table where there is friction; a step's share of gravity is
//! added, which a closed contact has to carry too. A contact is known to half a step: the method is of order 1.

use std::convert::Infallible;

use equipoise_physics::map::strike::{State, Strike};

use crate::integrators::motion::Motion;
use crate::integrators::simulation_run::{Halt, SimulationRun};

pub(crate) fn simulate(run: &mut SimulationRun, step: f64) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    if at_contact {
        run.strike(0.0, &mut motion)?;
    }
    // At a release from its contact height the strike has just been.
    let mut was_closed = at_contact;
    let (half, gravity) = (0.5 * step, run.rod.gravity);
    let mut steps = 0.0;
    loop {
        let t = steps * step;
        run.step(t, &motion)?;
        let middle = drift(&motion, half);
        let closed = run.gap(&middle) <= 0.0;
        let mut velocity = motion.velocity;
        velocity[1] -= gravity * step;
        // While a contact stays closed, only a table that is approached strikes again.
        if closed && (!was_closed || run.foresee(&middle).push < 0.0) {
            let strike = run.contact(t + half, &middle)?;
            run.leave(&strike.after, run.rebound_of(&strike, &middle))?;
            let direction = per_impulse(&middle.state(), &strike);
            let turn = run.rod.radius_of_gyration * direction[2];
            let weight = direction[0] * direction[0] + direction[1] * direction[1] + turn * turn;
            let impulse = strike.impulse_normal + step * gravity * direction[1] / weight;
            velocity = std::array::from_fn(|row| velocity[row] + direction[row] * impulse.max(0.0));
        }
        motion = drift(&Motion { velocity, ..middle }, half);
        was_closed = closed;
        steps += 1.0;
    }
}

fn drift(motion: &Motion, time: f64) -> Motion {
    Motion { place: std::array::from_fn(|row| motion.place[row] + time * motion.velocity[row]), ..*motion }
}

/// Change of the velocities by a unit of impulse along the table's normal, with what comes along the table by it; the strike shows it.
pub(crate) fn per_impulse(before: &State, strike: &Strike) -> [f64; 3] {
    let after = strike.after;
    [after.x_dot - before.x_dot, after.y_dot - before.y_dot, after.theta_dot - before.theta_dot]
        .map(|change| change / strike.impulse_normal)
}
