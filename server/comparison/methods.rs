//! The methods of the chart and the settings that each of them is run with.

use crate::integrators::{Integrator, Location};

/// A method of the chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ComparedMethod {
    /// Name in requests and answers.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// Description in a sentence.
    pub about: &'static str,
    pub(super) kind: MethodKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MethodKind {
    Map,
    MapFree,
    Linear,
    Extended,
    Integrator(IntegratorKind),
}

/// A general method for equations of motion, as a physics engine has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum IntegratorKind {
    Adaptive,
    StepEnd,
    Secant,
    Bisection,
    TimeStepping,
    Penalty,
    Sampling,
}

/// All of them, in the order of answers.
pub const METHODS: [ComparedMethod; 11] = {
    const fn method(kind: MethodKind, name: &'static str, title: &'static str, about: &'static str) -> ComparedMethod {
        ComparedMethod { name, title, about, kind }
    }
    [
        method(
            MethodKind::Map,
            "map",
            "map",
            "The map from contact to contact in closed form, which keeps rounding off the energy.",
        ),
        method(
            MethodKind::MapFree,
            "map_free",
            "map, energy left free",
            "The same map without the correction of its energy.",
        ),
        method(
            MethodKind::Linear,
            "linear",
            "linear solution",
            "Eq. (13) and (20) to (23) in closed form, any impact at the same cost.",
        ),
        method(
            MethodKind::Extended,
            "extended",
            "map with 31 digits",
            "The map in double-double numbers: the reference of all errors.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::Adaptive),
            "adaptive",
            "Dormand-Prince 5(4), events",
            "A library's adaptive Runge-Kutta; contacts located by halving on its dense output.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::Bisection),
            "runge_kutta_bisection",
            "RK4, contact bisected",
            "Runge-Kutta of order 4 with a fixed step; contacts located to the last digit.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::Secant),
            "runge_kutta_secant",
            "RK4, contact on a chord",
            "The same; contacts where the chord of the gap over the step is zero.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::StepEnd),
            "runge_kutta_step_end",
            "RK4, contact at step end",
            "The same; contacts at the end of the step in which they happen.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::Sampling),
            "sampling",
            "sampled flight",
            "The exact parabola looked at on a grid of times; contacts halved between two looks.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::TimeStepping),
            "time_stepping",
            "Moreau-Jean time stepping",
            "Velocities and impulses of whole steps, as engines of many contacts do it.",
        ),
        method(
            MethodKind::Integrator(IntegratorKind::Penalty),
            "penalty",
            "spring-damper contact",
            "A stiff spring and a damper for the contact, moved by Runge-Kutta.",
        ),
    ]
};

/// A setting of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSetting {
    /// `step` or `tolerance`.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit; `1` for none.
    pub unit: &'static str,
}

/// Most points that the methods have together.
pub fn most_points(methods: &[ComparedMethod]) -> u64 {
    methods.iter().map(|method| method.kind.settings(1.0).len() as u64).sum()
}

impl MethodKind {
    /// Settings from the coarsest, `scale` being the power of ten below the mean flight, s.
    pub(super) fn settings(self, scale: f64) -> Vec<Option<MethodSetting>> {
        let of = |name, unit, values: &[f64]| {
            values.iter().map(|&value| Some(MethodSetting { name, value, unit })).collect::<Vec<_>>()
        };
        match self {
            Self::Map | Self::MapFree | Self::Linear | Self::Extended => vec![None],
            Self::Integrator(IntegratorKind::Adaptive) => of("tolerance", "1", &[1e-4, 1e-6, 1e-8, 1e-10, 1e-12]),
            Self::Integrator(
                IntegratorKind::StepEnd
                | IntegratorKind::Secant
                | IntegratorKind::Bisection
                | IntegratorKind::TimeStepping
                | IntegratorKind::Penalty
                | IntegratorKind::Sampling,
            ) => of("step", "s", &[10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4].map(|parts| one_digit(scale / parts))),
        }
    }
}

impl IntegratorKind {
    /// The integrator with the value of its setting.
    pub(super) fn with(self, value: f64) -> Integrator {
        let runge_kutta = |location| Integrator::RungeKutta { step: value, location };
        match self {
            Self::Adaptive => Integrator::Adaptive { tolerance: value },
            Self::StepEnd => runge_kutta(Location::StepEnd),
            Self::Secant => runge_kutta(Location::Secant),
            Self::Bisection => runge_kutta(Location::Bisection),
            Self::TimeStepping => Integrator::TimeStepping { step: value },
            Self::Penalty => Integrator::Penalty { step: value },
            Self::Sampling => Integrator::Sampling { step: value },
        }
    }
}

/// The nearest number of one digit, so that steps are what they read.
fn one_digit(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}
