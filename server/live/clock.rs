//! The clock of a live run: maps wall time to run time. Pauses, steps and speeds are entries in it.
//!
//! The clock is a value: it never reads the time itself.

/// Slowest and fastest speed, in run time per wall time.
pub const SPEEDS: std::ops::RangeInclusive<f64> = 0.05..=20.0;

/// The run time and the speed from a wall time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockEntry {
    /// Unix time, ms.
    pub wall_ms: u64,
    /// Run time, s.
    pub run: f64,
    /// Run time per wall time; 0 is a pause.
    pub speed: f64,
}

/// Maps wall time to run time. Neither decreases from entry to entry.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    release: ClockEntry,
    entries: Vec<ClockEntry>,
}

impl Clock {
    /// A clock that shows 0 s at `epoch`, unix ms.
    pub fn new(epoch: u64, speed: f64) -> Self {
        Self { release: ClockEntry { wall_ms: epoch, run: 0.0, speed }, entries: Vec::new() }
    }

    /// Time of the release, unix ms.
    pub fn epoch(&self) -> u64 {
        self.release.wall_ms
    }

    /// Speed at the release.
    pub fn first_speed(&self) -> f64 {
        self.release.speed
    }

    /// Later changes, in their order.
    pub fn entries(&self) -> &[ClockEntry] {
        &self.entries
    }

    /// Adds an entry.
    ///
    /// # Errors
    /// The entry is before the last one in wall time or run time.
    pub fn push(&mut self, entry: ClockEntry) -> Result<(), String> {
        let last = self.last();
        if entry.wall_ms < last.wall_ms {
            return Err(format!("wall_ms is {} ms, before the {} ms of what it follows", entry.wall_ms, last.wall_ms));
        }
        if entry.run < last.run {
            return Err(format!("run is {} s, before the {} s of what it follows", entry.run, last.run));
        }
        self.entries.push(entry);
        Ok(())
    }

    /// The run time, s, at a wall time, unix ms; negative before the release.
    pub fn run_time(&self, wall: u64) -> f64 {
        let entry = self.entries.iter().rev().find(|entry| entry.wall_ms <= wall).unwrap_or(&self.release);
        entry.run + (wall as f64 - entry.wall_ms as f64) * 1e-3 * entry.speed
    }

    /// Wall time, unix ms, of a run time by the last entry; None while the clock is paused.
    pub fn wall_time(&self, run: f64) -> Option<f64> {
        let entry = self.last();
        (entry.speed > 0.0).then(|| entry.wall_ms as f64 + (run - entry.run) * 1e3 / entry.speed)
    }

    /// Wall time, unix ms, at which the clock comes to a run time, s. A step that shows or passes the run time has its date. A paused
    /// clock has the time of its pause for run times to come.
    pub fn date(&self, run: f64) -> u64 {
        let all = || std::iter::once(&self.release).chain(&self.entries);
        if let Some(shown) = all().find(|entry| entry.run == run) {
            return shown.wall_ms;
        }
        let before = all().take_while(|entry| entry.run < run).count();
        let (from, next) = (all().take(before).last().unwrap_or(&self.release), all().nth(before));
        let wall = match from.speed > 0.0 {
            true => (from.wall_ms as f64 + (run - from.run) * 1e3 / from.speed).round() as u64,
            false => next.unwrap_or(from).wall_ms,
        };
        next.map_or(wall, |next| wall.min(next.wall_ms))
    }

    /// Present speed; of a paused clock, the speed after the pause.
    pub fn speed(&self) -> f64 {
        self.entries.iter().rev().map(|entry| entry.speed).find(|speed| *speed > 0.0).unwrap_or(self.release.speed)
    }

    /// Tells whether the clock is paused.
    pub fn is_paused(&self) -> bool {
        self.last().speed == 0.0
    }

    /// Pauses the clock.
    pub fn pause(&mut self, wall: u64) {
        if !self.is_paused() {
            let run = self.run_time(self.not_before(wall));
            self.change(wall, run, 0.0);
        }
    }

    /// Resumes the clock.
    pub fn resume(&mut self, wall: u64) {
        if self.is_paused() {
            let (run, speed) = (self.last().run, self.speed());
            self.change(wall, run, speed);
        }
    }

    /// Changes the speed. A paused clock stays paused.
    pub fn set_speed(&mut self, wall: u64, speed: f64) {
        let (run, paused) = (self.run_time(self.not_before(wall)), self.is_paused());
        self.change(wall, run, speed);
        if paused {
            self.entries.push(ClockEntry { speed: 0.0, ..self.last() });
        }
    }

    /// Moves a paused clock to a run time.
    pub fn step(&mut self, wall: u64, run: f64) {
        let run = run.max(self.last().run);
        self.change(wall, run, 0.0);
    }

    /// Drops the oldest entries beyond `most`. Later wall times map to the same run times.
    pub fn forget_beyond(&mut self, most: usize) {
        let beyond = self.entries.len().saturating_sub(most);
        self.entries.drain(..beyond);
    }

    fn last(&self) -> ClockEntry {
        self.entries.last().copied().unwrap_or(self.release)
    }

    /// A wall clock that was set back must not move the run back.
    fn not_before(&self, wall: u64) -> u64 {
        wall.max(self.last().wall_ms)
    }

    fn change(&mut self, wall: u64, run: f64, speed: f64) {
        let wall = self.not_before(wall);
        // A pause followed by another one, or of no length, has no effect any more.
        if self.entries.last().is_some_and(|last| last.speed == 0.0 && (speed == 0.0 || last.wall_ms == wall)) {
            self.entries.pop();
            if self.entries.last().is_some_and(|last| last.speed > 0.0 && last.wall_ms == wall && speed > 0.0) {
                self.entries.pop();
            }
        }
        self.entries.push(ClockEntry { wall_ms: wall, run, speed });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn run_time_follows_the_entries() {
        let mut clock = Clock::new(1000, 2.0);
        assert_eq!((clock.run_time(500), clock.run_time(3000)), (-1.0, 4.0));
        assert_eq!(clock.wall_time(4.0), Some(3000.0));
        clock.pause(3000);
        clock.pause(3500);
        assert_eq!((clock.run_time(9000), clock.wall_time(5.0), clock.is_paused()), (4.0, None, true));
        clock.step(9000, 4.5);
        clock.set_speed(9500, 0.5);
        assert_eq!((clock.is_paused(), clock.speed(), clock.run_time(20_000)), (true, 0.5, 4.5));
        clock.resume(10_000);
        assert_eq!((clock.is_paused(), clock.run_time(12_000), clock.run_time(2000)), (false, 5.5, 2.0));
        clock.set_speed(12_000, 1.0);
        assert_eq!((clock.run_time(13_000), clock.speed()), (6.5, 1.0));
    }

    #[test]
    fn many_steps_are_one_entry_and_the_speed_is_kept() {
        let mut clock = Clock::new(0, 1.0);
        clock.set_speed(1000, 4.0);
        clock.pause(2000);
        for step in 0..100 {
            clock.step(3000 + step, 10.0 + step as f64);
        }
        assert_eq!((clock.entries().len(), clock.speed(), clock.run_time(5000)), (2, 4.0, 109.0));
    }

    #[test]
    fn forgetting_changes_nothing_from_now_on() {
        let mut clock = Clock::new(0, 1.0);
        for change in 1..100_u64 {
            clock.set_speed(change * 1000, if change.is_multiple_of(2) { 1.0 } else { 0.5 });
        }
        clock.pause(100_000);
        let mut shorter = clock.clone();
        shorter.forget_beyond(4);
        assert_eq!(shorter.entries().len(), 4);
        assert_eq!((shorter.run_time(123_000), shorter.speed()), (clock.run_time(123_000), clock.speed()));
    }

    #[test]
    fn a_run_time_has_the_date_at_which_the_clock_shows_it() {
        let mut clock = Clock::new(1000, 2.0);
        assert_eq!([0.0, 1.0, 4.0, 0.001_26].map(|run| clock.date(run)), [1000, 1500, 3000, 1001]);
        clock.pause(3000);
        assert_eq!([3.9, 4.0, 9.0].map(|run| clock.date(run)), [2950, 3000, 3000]);
        // A step takes the place of the pause before it, and its run time has its date.
        clock.step(9000, 4.5);
        assert_eq!([4.0, 4.5].map(|run| clock.date(run)), [3000, 9000]);
        clock.resume(10_000);
        clock.set_speed(12_000, 0.5);
        assert_eq!([4.5, 4.6, 8.5, 9.0].map(|run| clock.date(run)), [9000, 10_050, 12_000, 13_000]);
    }

    proptest! {
        /// The clock shows a run time at its date, and did not show it a millisecond before.
        #[test]
        fn dates_are_the_inverse_of_run_times(
            speed in 0.05..=20.0,
            changes in proptest::collection::vec((1_u64..100_000, proptest::option::of(0.05..=20.0)), 0..12),
            share in 0.0..1.0,
        ) {
            let (mut clock, mut wall) = (Clock::new(5000, speed), 5000);
            for (after, speed) in changes {
                wall += after;
                match speed {
                    Some(speed) if clock.is_paused() => (clock.resume(wall), clock.set_speed(wall, speed)).1,
                    Some(speed) => clock.set_speed(wall, speed),
                    None => clock.pause(wall),
                }
            }
            let run = share * clock.run_time(wall + 1000);
            let date = clock.date(run);
            prop_assert!(clock.run_time(date + 1) >= run, "{run} at {date} of {clock:?}");
            prop_assert!(date == 5000 || clock.run_time(date - 1) <= run, "{run} at {date} of {clock:?}");
        }
    }

    #[test]
    fn nothing_goes_back() {
        let mut clock = Clock::new(1000, 1.0);
        clock.pause(2000);
        clock.resume(1500);
        assert_eq!(clock.run_time(2500), 1.5);
        assert!(clock.push(ClockEntry { wall_ms: 1999, run: 5.0, speed: 1.0 }).unwrap_err().contains("1999 ms"));
        assert!(clock.push(ClockEntry { wall_ms: 2000, run: 0.5, speed: 1.0 }).unwrap_err().contains("0.5 s"));
    }
}
