//! Times work by the clock: many short looks at several pieces of work in turns, so that what else the machine does falls on all of them
//! alike, and the median of each.
//!
//! What is measured differs from one time to the next; nothing but `precision` may ask for it.

use std::time::{Duration, Instant};

use crate::compute::{CancelFlag, Cancelled, TimeSlice};

/// What was measured of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Seconds that doing it once takes: quartile, median, quartile of all looks.
    pub quartiles_s: [f64; 3],
    /// How many looks there were.
    pub repeats: usize,
}

/// How long to measure.
#[derive(Debug, Clone, Copy)]
pub struct TimingBudget {
    /// Time for each piece of work; one that takes long has three looks or three times this, whichever is less.
    pub time: Duration,
    /// Least time of one look: work that is shorter is done several times in it, since the clock has a grain.
    pub sample: Duration,
    /// Most looks at one piece of work.
    pub repeats: usize,
}

/// A piece of work; it may give up when it is cancelled.
pub type TimedWork<'a> = Box<dyn FnMut(&CancelFlag) + 'a>;

struct TimedSeries<'w, 'a> {
    work: &'w mut TimedWork<'a>,
    /// How often it is done in one look.
    times: u32,
    spent: Duration,
    samples_s: Vec<f64>,
}

/// Times all pieces of work in turns, and says of each when it has been `timed`. Others have their turn between two looks.
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
        // The first look finds caches cold, which long work does not feel.
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
    // Of an even number the lower one in the middle: what disturbs a look makes it longer.
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
