//! An ODE library's Runge-Kutta 5(4) with steps of its own choice (Dormand and Prince 1980), and events on its dense output.
//!
//! The tolerance is for the flight, which is a parabola and has no error. So each step is ten times the last, for any tolerance, and the
//! method does not examine the gap within a step. The contact is located here, by halving on the dense output: the
//! library's own search for events is off by 4e-4 at the first contact of the paper's case 1.

use std::convert::Infallible;

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;
use equipoise_physics::run::ending::Ending;

use crate::integrators::motion::Motion;
use crate::integrators::simulation_run::{Halt, SimulationRun, bisect};

struct FreeFlight {
    gravity: f64,
}

impl ODE<f64, [f64; 6]> for FreeFlight {
    fn diff(&self, _: f64, motion: &[f64; 6], change: &mut [f64; 6]) {
        *change = [motion[3], motion[4], motion[5], 0.0, -self.gravity, 0.0];
    }
}

/// No flight is longer, s: the library wants an end.
const HORIZON: f64 = 1e6;

pub(crate) fn simulate(run: &mut SimulationRun, tolerance: f64) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    let mut t = 0.0;
    if at_contact {
        run.strike(t, &mut motion)?;
    }
    loop {
        t += fly(run, tolerance, t, &mut motion)?;
        run.strike(t, &mut motion)?;
    }
}

/// Integrates one flight, from just after a contact to the next one. Returns its duration, s.
fn fly(run: &mut SimulationRun, tolerance: f64, t: f64, motion: &mut Motion) -> Result<f64, Halt> {
    let flight = FreeFlight { gravity: run.rod.gravity };
    let mut solver = ExplicitRungeKutta::dopri5().rtol(tolerance).atol(tolerance).max_steps(usize::MAX);
    // The step control fails for numbers that are not finite, and for a tolerance below rounding.
    let failed = |_| Halt::from(Ending::Diverged { speed: motion.velocity[0].abs().max(motion.velocity[1].abs()) });
    let evaluations = solver.init(&flight, 0.0, HORIZON, &numbers(motion)).map_err(failed)?;
    run.work.accelerations += evaluations.function as u64;
    let mut gap = run.gap(motion);
    loop {
        run.step(t + solver.t(), &rod(solver.y()))?;
        let evaluations = solver.step(&flight).map_err(failed)?;
        run.work.accelerations += evaluations.function as u64;
        if matches!(solver.status(), Status::RejectedStep) {
            continue;
        }
        let next_gap = run.gap(&rod(solver.y()));
        if next_gap > 0.0 || (gap <= 0.0 && next_gap >= gap) {
            gap = next_gap;
            continue;
        }
        let begin = solver.t_prev();
        let end = solver.t();
        // Within the step the library has no reason to refuse; what it would leave out is the step's end.
        let mut dense =
            |part: f64| solver.interpolate((begin + part).min(end)).map_or(rod(solver.y()), |there| rod(&there));
        let part = bisect(end - begin, |part| run.gap(&dense(part)) > 0.0);
        *motion = dense(part);
        return Ok(begin + part);
    }
}

fn numbers(motion: &Motion) -> [f64; 6] {
    let ([x, y, theta], [x_dot, y_dot, theta_dot]) = (motion.place, motion.velocity);
    [x, y, theta, x_dot, y_dot, theta_dot]
}

fn rod(&[x, y, theta, x_dot, y_dot, theta_dot]: &[f64; 6]) -> Motion {
    Motion { place: [x, y, theta], velocity: [x_dot, y_dot, theta_dot] }
}
