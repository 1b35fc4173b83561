//! The methods that can be simulated, with their settings.

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
        /// Step, s; the spring is as stiff as [`STEPS_PER_CONTACT`](super::STEPS_PER_CONTACT) of them allow.
        step: f64,
    },
    /// The exact flight, looked at on a grid of times.
    Sampling {
        /// From one look to the next, s.
        step: f64,
    },
}

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

impl Integrator {
    /// Name in answers.
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
