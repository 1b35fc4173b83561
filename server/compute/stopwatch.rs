//! Measures the time of several pieces of work: many short samples in turns, so that other load on the machine falls on all of them
//! alike, and the median of each.
//!
//! The result differs from one measurement to the next; only `precision` may use it.

use std::time::{Duration, Instant};

use crate::compute::{CancelFlag, Cancelled, TimeSlice};

/// The measured time of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Time of one execution, s: quartile, median, quartile of all samples.
    pub quartiles_s: [f64; 3],
    /// Number of samples.
    pub repeats: usize,
}

/// Bounds of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct TimingBudget {
    /// Time for each piece of work. Long work gets three samples or three times this time, whichever is less.
    pub time: Duration,
    /// Least time of one sample. Shorter work is repeated within it, because of the resolution of the clock.
    pub sample: Duration,
    /// Most samples of one piece of work.
    pub repeats: usize,
}

/// A piece of work to measure. It may return early when it is cancelled.
pub type TimedWork<'a> = Box<dyn FnMut(&CancelFlag) + 'a>;

struct TimedSeries<'w, 'a> {
    work: &'w mut TimedWork<'a>,
    /// Executions in one sample.
    times: u32,
    spent: Duration,
    samples_s: Vec<f64>,
}

/// Measures all pieces of work in turns, and calls `timed` for each that is done. Other jobs may run between two samples.
pub fn time(
    works: &mut [TimedWork<'_>],
    budget: TimingBudget,
    timed: &mut dyn FnMut(),
    slice: &TimeSlice,
) -> Result<Vec<Timing>, Cancelled> {
    let goes_on = |series: &TimedSeries<'_, '_>| {
        let samples = series.samples_s.len();
        let few = samples < 3 && series.spent < 3 * budget.time;
        samples == 0 || few || (series.spent < budget.time && samples < budget.repeats)
    };
    let mut all_series = Vec::with_capacity(works.len());
    for work in works {
        let first = sample(work, 1, slice)?;
        let times = (budget.sample.as_secs_f64() / first.as_secs_f64().max(1e-9)).ceil().clamp(1.0, 1e6) as u32;
        let mut series = TimedSeries { work, times, spent: first, samples_s: Vec::new() };
        // The first sample finds cold caches, which does not matter for long work.
        if times == 1 {
            series.samples_s.push(first.as_secs_f64());
        }
        if !goes_on(&series) {
            timed();
        }
        all_series.push(series);
    }
    while all_series.iter().any(goes_on) {
        for series in all_series.iter_mut().filter(|series| goes_on(series)) {
            let taken = sample(series.work, series.times, slice)?;
            series.spent += taken;
            series.samples_s.push(taken.as_secs_f64() / f64::from(series.times));
            if !goes_on(series) {
                timed();
            }
        }
    }
    Ok(all_series.into_iter().map(|series| timing(series.samples_s)).collect())
}

fn sample(work: &mut TimedWork<'_>, times: u32, slice: &TimeSlice) -> Result<Duration, Cancelled> {
    let start = Instant::now();
    for _ in 0..times {
        work(slice.cancel());
    }
    let taken = start.elapsed();
    slice.check().map(|()| taken)
}

fn timing(mut samples_s: Vec<f64>) -> Timing {
    samples_s.sort_by(f64::total_cmp);
    // For an even number, the lower of the two in the middle: disturbances only make samples longer.
    let at = |share: f64| samples_s[((samples_s.len() - 1) as f64 * share).floor() as usize];
    Timing { quartiles_s: [at(0.25), at(0.5), at(0.75)], repeats: samples_s.len() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    const BUDGET: TimingBudget =
        TimingBudget { time: Duration::from_millis(40), sample: Duration::from_millis(2), repeats: 5 };

    #[test]
    fn short_work_is_repeated_and_long_work_is_done_once() {
        let (short, long) = (Cell::new(0), Cell::new(0));
        let mut works: Vec<TimedWork<'_>> = vec![
            Box::new(|_| short.set(short.get() + 1)),
            Box::new(|_| {
                long.set(long.get() + 1);
                std::thread::sleep(3 * BUDGET.time);
            }),
        ];
        let mut timed = Vec::new();
        let timings = time(&mut works, BUDGET, &mut || timed.push(long.get()), &TimeSlice::unbounded()).unwrap();
        drop(works);
        assert_eq!((timings[0].repeats, timings[1].repeats, long.get()), (5, 1, 1));
        assert_eq!(timed, [1, 1], "each is said once");
        assert!(short.get() > 100, "{} times", short.get());
        assert!(timings[0].quartiles_s[1] < 1e-4 && timings[1].quartiles_s[1] >= 0.12, "{timings:?}");
    }

    #[test]
    fn what_nobody_waits_for_is_given_up() {
        let mut works: Vec<TimedWork<'_>> = vec![Box::new(|cancel| cancel.set())];
        assert_eq!(time(&mut works, BUDGET, &mut || {}, &TimeSlice::unbounded()), Err(Cancelled));
    }
}
