//! Everything that is kept of a motion in contact: even samples, the largest values, and the times of coming to rest.

use crate::contact::equations::Motion;
use crate::contact::moment::{ContactSetting, Event, Moment};
use crate::contact::record::{HoldSample, MOST_SAMPLES};
use crate::contact::request::HoldRequest;
use crate::contact::solver::{Observer, change};
use crate::table::actuator_load::ActuatorLoad;
use std::mem::take;

/// Least time between two samples, s.
const SAMPLE_STEP: f64 = 0.01;

/// |θ| that counts as upright, rad.
const UPRIGHT: f64 = 1e-3;

/// |x| that counts as in place, m.
const IN_PLACE: f64 = 1e-3;

/// The last time at which a coordinate was out of its band.
#[derive(Clone, Copy, Debug)]
struct Band {
    /// Index in [`Motion`].
    coordinate: usize,
    half_width: f64,
    since: f64,
    outside: bool,
}

impl Band {
    fn new(coordinate: usize, half_width: f64, t: f64, motion: &Motion) -> Self {
        Self { coordinate, half_width, since: t, outside: motion[coordinate].abs() > half_width }
    }

    /// Takes in a piece on which the coordinate is monotone.
    fn pass(&mut self, from: f64, to: (f64, Motion), begin: f64, between: &mut dyn FnMut(f64) -> Motion) {
        let Self { coordinate, half_width, outside, .. } = *self;
        let is_out = |motion: &Motion| motion[coordinate].abs() > half_width;
        self.outside = is_out(&to.1);
        if outside && !self.outside {
            self.since = begin + change(from, to.0, &mut |t| is_out(&between(t)));
        }
    }

    fn within(&self) -> Option<f64> {
        (!self.outside).then_some(self.since)
    }
}

/// Samples and extremes of a motion so far.
#[derive(Clone, Debug)]
pub(super) struct Recorder {
    pub(super) samples: Vec<HoldSample>,
    pub(super) load: ActuatorLoad,
    pub(super) most_theta: f64,
    pub(super) least_friction: f64,
    /// Least and largest place of a table that moves along itself, m.
    places: (f64, f64),
    theta: Band,
    x: Band,
    start: f64,
    step: f64,
    count: usize,
}

impl Recorder {
    pub(super) fn new(request: &HoldRequest, motion: &Motion) -> Self {
        let steps = (MOST_SAMPLES - 2) as f64;
        let t = request.start.t;
        Self {
            samples: Vec::new(),
            load: ActuatorLoad::default(),
            most_theta: 0.0,
            least_friction: 0.0,
            places: (0.0, 0.0),
            theta: Band::new(1, UPRIGHT, t, motion),
            x: Band::new(0, IN_PLACE, t, motion),
            start: t,
            step: SAMPLE_STEP.max(request.duration / steps),
            count: 0,
        }
    }

    /// Times from which θ and x stay within their bands.
    pub(super) fn within(&self) -> (Option<f64>, Option<f64>) {
        (self.theta.within(), self.x.within())
    }

    /// Way of the table along itself, m.
    pub(super) fn travel(&self) -> f64 {
        self.places.1 - self.places.0
    }

    /// Takes in the largest values at a moment.
    pub(super) fn peak(&mut self, moment: &Moment) {
        self.load = self.load.or(moment.load);
        self.most_theta = self.most_theta.max(moment.sample.theta.abs());
        self.least_friction = self.least_friction.max(moment.needed_friction);
        let (low, high) = self.places;
        self.places = (low.min(moment.sample.table_x), high.max(moment.sample.table_x));
    }

    /// The next sample is due at this time, s, unless there are enough.
    fn due(&self) -> f64 {
        if self.count + 1 < MOST_SAMPLES { self.start + self.step * self.count as f64 } else { f64::INFINITY }
    }

    /// Takes in the first sample.
    pub(super) fn begin(&mut self, sample: HoldSample) {
        self.samples.push(sample);
        self.count = 1;
    }

    /// Adds the last moment, if it is not a sample.
    pub(super) fn end(&mut self, sample: HoldSample) {
        if self.samples.last().is_none_or(|last| last.t < sample.t) {
            self.samples.push(sample);
        }
    }
}

/// A recorder at work on one piece.
pub(super) struct Watch<'a> {
    pub(super) setting: ContactSetting<'a>,
    pub(super) recorder: &'a mut Recorder,
    /// The event that ended the piece.
    pub(super) event: Option<Event>,
    /// The last moment, and the one of the last question with its time.
    last: Option<Moment>,
    asked: Option<(f64, Moment)>,
    searches: u32,
}

impl<'a> Watch<'a> {
    pub(super) fn new(setting: ContactSetting<'a>, recorder: &'a mut Recorder) -> Self {
        Self { setting, recorder, event: None, last: None, asked: None, searches: 0 }
    }

    /// Times between two looks at which x, θ or α turns, in order.
    fn turns(
        &self,
        (a, before, from): (f64, &Moment, &Motion),
        (b, after, to): (f64, &Moment, &Motion),
        between: &mut dyn FnMut(f64) -> Motion,
    ) -> [f64; 3] {
        let mut turns = [b; 3];
        if (from[2] > 0.0) != (to[2] > 0.0) {
            turns[0] = change(a, b, &mut |t| between(t)[2] > 0.0);
        }
        if (from[3] > 0.0) != (to[3] > 0.0) {
            turns[1] = change(a, b, &mut |t| between(t)[3] > 0.0);
        }
        if (before.tilt_rate > 0.0) != (after.tilt_rate > 0.0) {
            turns[2] = change(a, b, &mut |t| self.setting.moment(t, &between(t)).tilt_rate > 0.0);
        }
        turns.sort_by(f64::total_cmp);
        turns
    }
}

impl Observer for Watch<'_> {
    fn ends(&mut self, t: f64, motion: &Motion) -> bool {
        let moment = self.setting.moment(t, motion);
        self.asked = Some((t, moment));
        let event = self.setting.event(t, &moment, motion);
        self.event = event.or(self.event);
        event.is_some()
    }

    fn pass(&mut self, from: (f64, Motion), to: (f64, Motion), between: &mut dyn FnMut(f64) -> Motion) {
        let before = self.last.unwrap_or_else(|| self.setting.moment(from.0, &from.1));
        let asked = self.asked.filter(|(t, _)| *t == to.0).map(|(_, moment)| moment);
        let after = asked.unwrap_or_else(|| self.setting.moment(to.0, &to.1));
        let mut low = from.0;
        let turns = self.turns((from.0, &before, &from.1), (to.0, &after, &to.1), between);
        self.searches += turns.iter().map(|t| u32::from(*t < to.0)).sum::<u32>();
        for t in turns {
            let here = if t < to.0 { between(t) } else { to.1 };
            let moment = if t < to.0 { self.setting.moment(t, &here) } else { after };
            self.recorder.peak(&moment);
            for band in [&mut self.recorder.theta, &mut self.recorder.x] {
                band.pass(low, (t, here), self.setting.begin, between);
            }
            low = t;
        }
        loop {
            let due = self.recorder.due();
            let t = due - self.setting.begin;
            if t > to.0 {
                break;
            }
            if t >= from.0 {
                let sample = self.setting.moment(t, &between(t)).sample;
                self.recorder.samples.push(HoldSample { t: due, ..sample });
            }
            self.recorder.count += 1;
        }
        self.last = Some(after);
    }

    fn searches(&mut self) -> u32 {
        take(&mut self.searches)
    }
}
