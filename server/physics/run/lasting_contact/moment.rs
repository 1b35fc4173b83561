//! The body, the table and the contact at one moment; and one piece of the motion by the library's integrator, sampled so finely that no event is
//! missed, with everything that is kept of it: even samples, the largest values, and the times of coming to rest.

use crate::map::table::actuator_load::{ActuatorLoad, LimitViolation};
use crate::numbers::trig;
use crate::run::lasting_contact::equations::{ContactForce, ContactMotion, Equations, Mode, Motion};
use crate::run::lasting_contact::request::{ContactStart, HoldEnding, HoldRequest, HoldSample, MOST_SAMPLES, Touching};
use crate::run::lasting_contact::work::{LONGEST_STEP, MOST_STEPS, Work};
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::status::Status;
use std::mem::take;

/// Force over weight beyond which no table keeps the contact: the equation for the force has no solution near there.
const MOST_FORCE: f64 = 1e4;

/// Vertical motion of the table's surface, at a time of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TableFall {
    /// Height, m, velocity, m/s, and acceleration, m/s², upwards.
    pub(super) y: f64,
    pub(super) y_dot: f64,
    pub(super) y_ddot: f64,
}

impl TableFall {
    /// The motion at time `t` of the run, and the time at which a braking table stands, s. From that time on, exactly, it does not
    /// brake: the difference of both times would be rounded.
    pub(super) fn new(request: &HoldRequest, t: f64) -> (Self, f64) {
        let ContactStart { t: begin, table_speed: speed, .. } = request.start;
        let elapsed = t - begin;
        let Some(brake) = request.brake.filter(|brake| *brake > 0.0) else {
            return (Self { y: speed * elapsed, y_dot: speed, y_ddot: 0.0 }, f64::INFINITY);
        };
        let acceleration = -brake.copysign(speed);
        let stop = (speed / acceleration).abs();
        let stands = begin + stop;
        if t >= stands {
            return (Self { y: 0.5 * speed * stop, y_dot: 0.0, y_ddot: 0.0 }, stands);
        }
        let y = elapsed * (speed + 0.5 * acceleration * elapsed);
        (Self { y, y_dot: speed + acceleration * elapsed, y_ddot: acceleration }, stands)
    }
}

/// One moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    pub(super) sample: HoldSample,
    /// α̇, rad/s.
    pub(super) tilt_rate: f64,
    /// Load on the table.
    pub(super) load: ActuatorLoad,
    /// |F|/N.
    pub(super) needed_friction: f64,
    /// Velocity of the contact point along x, m/s.
    pub(super) contact_speed: f64,
}

/// End of a kind of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event {
    /// The table would have to pull, or to push without bound.
    Lost,
    /// |θ| reached the topple angle.
    Toppled,
    /// A limit of the table.
    Limit(LimitViolation),
    /// The contact point stops sliding.
    SlipStops,
    /// The contact point begins to slide; the friction that would be needed.
    Slips(f64),
    /// Another vertex comes down to the table.
    Lands(usize),
    /// The contact point passed an end of the table: where that is and the end, m.
    OffTable { place: f64, limit: f64 },
    /// The table has come to the tilt of its law.
    Arrives,
}

/// A motion of one kind of contact in its surroundings.
pub(super) struct ContactSetting<'a> {
    pub(super) request: &'a HoldRequest,
    pub(super) equations: Equations,
    /// Time of the run at the beginning of the piece, s.
    pub(super) begin: f64,
    /// Place of the contact point at the beginning of the contact, m.
    pub(super) origin: f64,
    /// A vertex that has just left the table and may be on it, up to rounding, until this time of the piece, s.
    pub(super) rising: Option<(usize, f64)>,
}

impl ContactSetting<'_> {
    /// The moment `t` s after the beginning of the piece.
    pub(super) fn moment(&self, t: f64, motion: &Motion) -> Moment {
        let ContactMotion { force, x_ddot, theta_ddot } = self.equations.accelerations(t, motion);
        let ContactForce { normal, tangential } = force;
        let alpha = self.equations.tilt(t, motion);
        let t = self.begin + t;
        let (fall, _) = TableFall::new(self.request, t);
        let contact_speed = self.equations.contact_speed(motion);
        let moves_along = matches!(self.equations.mode, Mode::Matched(_)) || self.equations.law.is_cart_pole();
        let speed = if moves_along {
            (contact_speed * contact_speed + fall.y_dot * fall.y_dot).sqrt()
        } else {
            // Along its normal as fast as keeps the contact point at its height.
            let (sin, cos) = trig::sin_cos(alpha);
            let along_normal = -sin * contact_speed;
            let (x, y) = (-sin * along_normal, cos * along_normal + fall.y_dot);
            (x * x + y * y).sqrt()
        };
        let of_law = || self.equations.law.tilt_rate(&[motion[2], motion[3], x_ddot, theta_ddot]);
        let tilt_rate = self.equations.way.map_or_else(of_law, |way| way.rate);
        Moment {
            sample: HoldSample {
                t,
                x: motion[0],
                theta: motion[1],
                x_dot: motion[2],
                theta_dot: motion[3],
                alpha,
                normal_force: normal,
                tangential_force: tangential,
                table_y: fall.y,
                table_y_dot: fall.y_dot,
                table_x: if moves_along { self.equations.contact_place(motion) - self.origin } else { 0.0 },
            },
            tilt_rate,
            load: ActuatorLoad { tilt: alpha.abs(), tilt_rate: tilt_rate.abs(), speed, stroke: fall.y.abs() },
            needed_friction: (tangential / normal).abs(),
            contact_speed,
        }
    }

    /// The event that this moment, `t` s after the beginning of the piece, is beyond.
    pub(super) fn event(&self, t: f64, moment: &Moment, motion: &Motion) -> Option<Event> {
        let Moment { sample, contact_speed, needed_friction, .. } = moment;
        let normal = sample.normal_force;
        if !(normal > 0.0 && normal < MOST_FORCE * self.equations.gravity.abs()) {
            return Some(Event::Lost);
        }
        let friction = self.request.touching.coefficient();
        let slips = match (self.equations.mode, self.request.touching) {
            (Mode::Sliding(share), _) if share != 0.0 => {
                // Friction acts against the motion.
                (contact_speed * share > 0.0).then_some(Event::SlipStops)
            }
            (Mode::Sticking, Touching::Frictionless) => None,
            (Mode::Sticking, Touching::Coulomb(_) | Touching::Matched(_)) => {
                (*needed_friction > friction).then_some(Event::Slips(*needed_friction))
            }
            (Mode::Sliding(_) | Mode::Matched(_), _) => None,
        };
        if slips.is_some() {
            return slips;
        }
        let without = self.rising.filter(|(_, until)| t < *until).map(|(vertex, _)| vertex);
        if let Some((vertex, clearance)) = self.equations.stance.nearest(sample.theta, sample.alpha, without)
            && clearance < 0.0
        {
            return Some(Event::Lands(vertex));
        }
        if sample.theta.abs() >= self.request.rules.topple_angle {
            return Some(Event::Toppled);
        }
        let (place, limit) = (self.equations.contact_place(motion), self.request.rules.half_length);
        if place.abs() > limit {
            return Some(Event::OffTable { place, limit });
        }
        if self.equations.has_arrived(t, motion) {
            return Some(Event::Arrives);
        }
        self.request.rules.limits.and_then(|limits| limits.exceeded(&moment.load)).map(Event::Limit)
    }
}

/// Samples of the motion in each step of the integrator.
const SAMPLES: u32 = 8;

/// Reason for the end of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PieceEnd {
    /// The time is over.
    Over,
    /// An event ended it.
    Found,
    /// The motion is followed no further: the caller stopped it, its work limit was reached, or the equations have no solution any more.
    Given(HoldEnding),
}

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

impl Watch<'_> {
    /// Follows the motion from `start` over `span` (s) or up to an event. Returns time and motion there.
    pub(super) fn integrate(
        &mut self,
        start: Motion,
        (span, longest_step, tolerance): (f64, f64, f64),
        work: &mut Work<'_>,
    ) -> (f64, Motion, PieceEnd) {
        let equations = &{ self.setting.equations };
        let mut solver = ExplicitRungeKutta::dop853()
            .rtol(tolerance)
            .atol(tolerance)
            .h_max(longest_step.min(LONGEST_STEP))
            .max_steps(MOST_STEPS);
        let mut last = (0.0, start);
        // The library wants an end after the first step; steps beyond `span` are cut off here.
        if solver.init(equations, 0.0, f64::MAX, &start).is_err() {
            return (0.0, start, PieceEnd::Given(HoldEnding::TooLong));
        }
        loop {
            if let Err(ending) = work.take(1 + take(&mut self.searches)) {
                return (last.0, last.1, PieceEnd::Given(ending));
            }
            if solver.step(equations).is_err() || solver.y().iter().any(|it| !it.is_finite()) {
                return (last.0, last.1, PieceEnd::Given(HoldEnding::TooLong));
            }
            if matches!(solver.status(), Status::RejectedStep) {
                continue;
            }
            let (begin, end) = (solver.t_prev(), solver.t().min(span));
            let after = *solver.y();
            let stop = solver.t();
            // Within the step the library has no reason to refuse.
            let mut between =
                |t: f64| if t >= stop { after } else { solver.interpolate(t.max(begin)).unwrap_or(after) };
            for sample in 1..=SAMPLES {
                let t = if sample == SAMPLES {
                    end
                } else {
                    begin + (end - begin) * (f64::from(sample) / f64::from(SAMPLES))
                };
                let motion = between(t);
                if self.ends(t, &motion) {
                    let (t, motion) = first(last.0, (t, motion), &mut |t| {
                        let motion = between(t);
                        self.ends(t, &motion).then_some(motion)
                    });
                    self.pass(last, (t, motion), &mut between);
                    return (t, motion, PieceEnd::Found);
                }
                self.pass(last, (t, motion), &mut between);
                last = (t, motion);
            }
            if end >= span {
                return (last.0, last.1, PieceEnd::Over);
            }
        }
    }

    /// True if the motion at this time, s after the beginning of the piece, is beyond an event.
    fn ends(&mut self, t: f64, motion: &Motion) -> bool {
        let moment = self.setting.moment(t, motion);
        self.asked = Some((t, moment));
        let event = self.setting.event(t, &moment, motion);
        self.event = event.or(self.event);
        event.is_some()
    }

    /// Takes in the motion from one sample to the next.
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
fn change(low: f64, high: f64, positive: &mut dyn FnMut(f64) -> bool) -> f64 {
    let side = positive(low);
    first(low, (high, ()), &mut |t| (positive(t) != side).then_some(())).0
}
