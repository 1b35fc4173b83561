//! The library's integrator over one piece of the motion, sampled so finely that the observer misses no event.

use crate::contact::equations::{Equations, Motion};
use crate::contact::work::{LONGEST_STEP, MOST_STEPS, Work, WorkEnd};
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::status::Status;

/// Samples of the motion that the observer gets in each step of the integrator.
const SAMPLES: u32 = 8;

/// Reason for the end of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PieceEnd {
    /// The time is over.
    Over,
    /// The observer ended it.
    Found,
    /// The caller stopped it.
    Stopped,
    /// The work limit was reached, or the equations have no solution any more.
    Stuck,
}

/// Takes part in the integration.
pub(super) trait Observer {
    /// True if the motion at this time, s after the beginning of the piece, is beyond the end of the piece.
    fn ends(&mut self, t: f64, motion: &Motion) -> bool;

    /// Takes in the motion from one sample to the next.
    fn pass(&mut self, from: (f64, Motion), to: (f64, Motion), between: &mut dyn FnMut(f64) -> Motion);

    /// Number of turns that were searched for since the last question.
    fn searches(&mut self) -> u32;
}

/// Integrates from `start` over `span` (s) or up to the end that the observer sees. Returns time and motion there.
pub(super) fn integrate(
    equations: &Equations,
    start: Motion,
    (span, longest_step, tolerance): (f64, f64, f64),
    observer: &mut impl Observer,
    work: &mut Work<'_>,
) -> (f64, Motion, PieceEnd) {
    let mut solver = ExplicitRungeKutta::dop853()
        .rtol(tolerance)
        .atol(tolerance)
        .h_max(longest_step.min(LONGEST_STEP))
        .max_steps(MOST_STEPS);
    let mut last = (0.0, start);
    // The library wants an end after the first step; steps beyond `span` are cut off here.
    if solver.init(equations, 0.0, f64::MAX, &start).is_err() {
        return (0.0, start, PieceEnd::Stuck);
    }
    loop {
        match work.take(1 + observer.searches()) {
            Ok(()) => {}
            Err(WorkEnd::UsedUp) => return (last.0, last.1, PieceEnd::Stuck),
            Err(WorkEnd::Stopped) => return (last.0, last.1, PieceEnd::Stopped),
        }
        if solver.step(equations).is_err() || solver.y().iter().any(|it| !it.is_finite()) {
            return (last.0, last.1, PieceEnd::Stuck);
        }
        if matches!(solver.status(), Status::RejectedStep) {
            continue;
        }
        let (begin, end) = (solver.t_prev(), solver.t().min(span));
        let after = *solver.y();
        let stop = solver.t();
        // Within the step the library has no reason to refuse.
        let mut between = |t: f64| if t >= stop { after } else { solver.interpolate(t.max(begin)).unwrap_or(after) };
        for sample in 1..=SAMPLES {
            let t =
                if sample == SAMPLES { end } else { begin + (end - begin) * (f64::from(sample) / f64::from(SAMPLES)) };
            let motion = between(t);
            if observer.ends(t, &motion) {
                let (t, motion) = first(last.0, (t, motion), &mut |t| {
                    let motion = between(t);
                    observer.ends(t, &motion).then_some(motion)
                });
                observer.pass(last, (t, motion), &mut between);
                return (t, motion, PieceEnd::Found);
            }
            observer.pass(last, (t, motion), &mut between);
            last = (t, motion);
        }
        if end >= span {
            return (last.0, last.1, PieceEnd::Over);
        }
    }
}

/// The first time at which `at` has a value, to the last digit, between one without and one with it.
fn first<T>(mut low: f64, mut high: (f64, T), at: &mut dyn FnMut(f64) -> Option<T>) -> (f64, T) {
    loop {
        let middle = 0.5 * (low + high.0);
        if middle <= low || middle >= high.0 {
            return high;
        }
        match at(middle) {
            Some(value) => high = (middle, value),
            None => low = middle,
        }
    }
}

/// The time between `low` and `high` at which `positive` changes, to the last digit.
pub(super) fn change(mut low: f64, mut high: f64, positive: &mut dyn FnMut(f64) -> bool) -> f64 {
    let side = positive(low);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if positive(middle) == side { low = middle } else { high = middle }
    }
}
