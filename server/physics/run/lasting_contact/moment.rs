//! The body, the table and the contact at one moment, the events that end a piece, and one piece of the motion by the library's integrator,
//! with everything that is kept of it: even samples, the largest values, and the times of coming to rest.

use crate::map::polygon::VertexClearance;
use crate::map::table::actuator_load::ActuatorLoad;
use crate::numbers::trig;
use crate::run::ending::Ending;
use crate::run::lasting_contact::equations::{ContactMotion, Mode, Piece, Stance, TableFall};
use crate::run::lasting_contact::request::{Hold, HoldEnding, HoldRequest, HoldSample, MOST_SAMPLES, Motion};
use crate::run::lasting_contact::work::{LONGEST_STEP, MOST_STEPS, Work};
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::status::Status;
use std::mem::take;

/// Force over weight beyond which no table keeps the contact: the equation for the force has no solution near there.
const MOST_FORCE: f64 = 1e4;

/// One moment of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    /// Time from the beginning of the piece, s.
    pub(super) t: f64,
    pub(super) sample: HoldSample,
    /// α̇, rad/s.
    pub(super) tilt_rate: f64,
    pub(super) load: ActuatorLoad,
}

/// End of a kind of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event {
    Ends(HoldEnding),
    /// The contact point stops sliding.
    SlipStops,
    /// The contact point begins to slide; the friction that would be needed.
    Slips(f64),
    /// Another vertex comes down to the table.
    Lands(usize),
    /// The table has come to the tilt of its law.
    Arrives,
}

impl Piece<'_> {
    /// The moment `t` s after the beginning of the piece.
    pub(super) fn moment(&self, t: f64, motion: Motion) -> Moment {
        let ContactMotion { normal, tangential, x_ddot, theta_ddot } = self.accelerations(t, &motion);
        let alpha = self.tilt(t, &motion);
        let time = self.begin + t;
        let fall = TableFall::at(self.request, time);
        let contact_speed = self.stance.contact_speed(&motion);
        let moves_along = matches!(self.mode, Mode::Matched(_)) || self.law.is_cart_pole();
        let (speed, table_x) = if moves_along {
            let start = &self.request.start;
            let origin = Stance::new(self.request).contact_place(&start.motion());
            let speed = (contact_speed * contact_speed + fall.y_dot * fall.y_dot).sqrt();
            (speed, self.stance.contact_place(&motion) - origin)
        } else {
            // Along its normal as fast as keeps the contact point at its height.
            let (sin, cos) = trig::sin_cos(alpha);
            let along_normal = -sin * contact_speed;
            let (x, y) = (-sin * along_normal, cos * along_normal + fall.y_dot);
            ((x * x + y * y).sqrt(), 0.0)
        };
        let of_law = || self.law.tilt_rate(&[motion[2], motion[3], x_ddot, theta_ddot]);
        let tilt_rate = self.way.map_or_else(of_law, |way| way.rate);
        let [x, theta, x_dot, theta_dot] = motion;
        Moment {
            t,
            sample: HoldSample {
                t: time,
                x,
                theta,
                x_dot,
                theta_dot,
                alpha,
                normal_force: normal,
                tangential_force: tangential,
                table_y: fall.y,
                table_y_dot: fall.y_dot,
                table_x,
            },
            tilt_rate,
            load: ActuatorLoad { tilt: alpha.abs(), tilt_rate: tilt_rate.abs(), speed, stroke: fall.y.abs() },
        }
    }

    /// The event that a moment is beyond.
    pub(super) fn event(&self, moment: &Moment) -> Option<Event> {
        let Moment { t, sample, load, .. } = moment;
        let (motion, normal, needed) = (&sample.motion(), sample.normal_force, sample.needed_friction());
        if !(normal > 0.0 && normal < MOST_FORCE * self.gravity().abs()) {
            return Some(Event::Ends(HoldEnding::ContactLost));
        }
        match self.mode {
            // Friction acts against the motion.
            Mode::Sliding(share) if share != 0.0 && self.stance.contact_speed(motion) * share > 0.0 => {
                return Some(Event::SlipStops);
            }
            Mode::Sticking if self.request.body.rough().is_some_and(|friction| needed > friction.coefficient) => {
                return Some(Event::Slips(needed));
            }
            Mode::Sliding(_) | Mode::Matched(_) | Mode::Sticking => {}
        }
        let without = self.rising.filter(|(_, until)| t < until).map(|(vertex, _)| vertex);
        let nearest = self.stance.nearest(sample.theta, sample.alpha, without);
        if let Some(VertexClearance { vertex, .. }) = nearest.filter(|nearest| nearest.clearance < 0.0) {
            return Some(Event::Lands(vertex));
        }
        let place = || self.stance.contact_place(motion);
        let ending = self.request.rules.before_strike(sample.theta, [-1.0, 0.0], || None, place, || *load);
        if self.has_arrived(*t, motion) && !matches!(ending, Some(Ending::Toppled { .. } | Ending::OffTable { .. })) {
            return Some(Event::Arrives);
        }
        ending.map(|ending| Event::Ends(HoldEnding::Ended(ending)))
    }
}

/// Samples of the motion in each step of the integrator.
const SAMPLES: u32 = 8;

/// Least time between two samples, s.
const SAMPLE_STEP: f64 = 0.01;

/// |θ| that counts as upright, rad.
const UPRIGHT: f64 = 1e-3;

/// |x| that counts as in place, m.
const IN_PLACE: f64 = 1e-3;

/// A motion as it is followed: the answer so far, and its last moment.
pub(super) struct Record<'a> {
    pub(super) hold: Hold,
    pub(super) last: Moment,
    request: &'a HoldRequest,
    /// Least and largest place of a table that moves along itself, m.
    places: (f64, f64),
    /// Number of even samples so far.
    count: usize,
}

impl<'a> Record<'a> {
    /// A motion that begins at this moment, on a table that has come there with this load.
    pub(super) fn new(request: &'a HoldRequest, first: Moment, load: ActuatorLoad) -> Self {
        let within = |coordinate: f64, half_width: f64| (coordinate.abs() <= half_width).then_some(request.start.t);
        let HoldSample { t, x, theta, .. } = first.sample;
        let hold = Hold {
            samples: vec![first.sample],
            ending: HoldEnding::Completed,
            t_end: t,
            theta_within: within(theta, UPRIGHT),
            x_within: within(x, IN_PLACE),
            error_bound: f64::INFINITY,
            load,
            travel: 0.0,
            most_theta: 0.0,
            least_friction: 0.0,
        };
        Self { hold, last: first, request, places: (0.0, 0.0), count: 1 }
    }

    pub(super) fn end(mut self, ending: HoldEnding, t_end: f64) -> Hold {
        let last = self.last.sample;
        if self.hold.samples.last().is_none_or(|before| before.t < last.t) {
            self.hold.samples.push(last);
        }
        if ending != HoldEnding::Completed {
            (self.hold.theta_within, self.hold.x_within) = (None, None);
        }
        Hold { ending, t_end, travel: self.places.1 - self.places.0, ..self.hold }
    }

    pub(super) fn peak(&mut self, moment: &Moment) {
        let hold = &mut self.hold;
        hold.load = hold.load.or(moment.load);
        hold.most_theta = hold.most_theta.max(moment.sample.theta.abs());
        hold.least_friction = hold.least_friction.max(moment.sample.needed_friction());
        let (low, high) = self.places;
        self.places = (low.min(moment.sample.table_x), high.max(moment.sample.table_x));
    }

    /// Follows a piece from the last moment over `span` (s) or to an event, which it returns. Sampling misses no event.
    /// Fails with the ending if the caller stops it, its work is used up, or the equations have no solution any more.
    pub(super) fn follow(
        &mut self,
        piece: &Piece<'_>,
        span: f64,
        tolerance: f64,
        work: &mut Work<'_>,
    ) -> Result<Option<Event>, HoldEnding> {
        let start = self.last.sample.motion();
        let mut solver = ExplicitRungeKutta::dop853()
            .rtol(tolerance)
            .atol(tolerance)
            .h_max(piece.longest_step(&start).min(LONGEST_STEP))
            .max_steps(MOST_STEPS);
        // The library wants an end after the first step; steps beyond `span` are cut off here.
        solver.init(piece, 0.0, f64::MAX, &start).map_err(|_| HoldEnding::TooLong)?;
        let mut searches = 0;
        loop {
            work.take(1 + take(&mut searches))?;
            if solver.step(piece).is_err() || solver.y().iter().any(|it| !it.is_finite()) {
                return Err(HoldEnding::TooLong);
            }
            if matches!(solver.status(), Status::RejectedStep) {
                continue;
            }
            let (begin, stop, after) = (solver.t_prev(), solver.t(), *solver.y());
            let end = stop.min(span);
            // Within the step the library has no reason to refuse.
            let mut between =
                |t: f64| if t >= stop { after } else { solver.interpolate(t.max(begin)).unwrap_or(after) };
            for sample in 1..=SAMPLES {
                let t = if sample == SAMPLES {
                    end
                } else {
                    begin + (end - begin) * (f64::from(sample) / f64::from(SAMPLES))
                };
                let here = piece.moment(t, between(t));
                let found = piece.event(&here).map(|event| {
                    first(self.last.t, (t, (here, event)), &mut |t| {
                        let moment = piece.moment(t, between(t));
                        piece.event(&moment).map(|event| (moment, event))
                    })
                });
                let here = found.map_or(here, |(_, (moment, _))| moment);
                searches += self.pass(piece, here, &mut between);
                if let Some((_, (_, event))) = found {
                    return Ok(Some(event));
                }
            }
            if end >= span {
                return Ok(None);
            }
        }
    }

    /// Takes in the motion from the last moment to another. Returns the number of searches for turns.
    fn pass(&mut self, piece: &Piece<'_>, to: Moment, between: &mut dyn FnMut(f64) -> Motion) -> u32 {
        let from = self.last;
        // Times at which x, θ or α turns: between them all three are monotone.
        let mut turns = [to.t; 3];
        let rates = |moment: &Moment| [moment.sample.x_dot, moment.sample.theta_dot, moment.tilt_rate];
        for (index, turn) in turns.iter_mut().enumerate() {
            if (rates(&from)[index] > 0.0) != (rates(&to)[index] > 0.0) {
                *turn = change(from.t, to.t, &mut |t| {
                    let motion = between(t);
                    0.0 < if index < 2 { motion[2 + index] } else { piece.moment(t, motion).tilt_rate }
                });
            }
        }
        turns.sort_by(f64::total_cmp);
        let mut low = from.t;
        for t in turns {
            let here = if t < to.t { piece.moment(t, between(t)) } else { to };
            self.peak(&here);
            let Hold { theta_within, x_within, .. } = &mut self.hold;
            for (coordinate, half_width, within) in [(1, UPRIGHT, theta_within), (0, IN_PLACE, x_within)] {
                let is_out = |motion: &Motion| motion[coordinate].abs() > half_width;
                let entry = || piece.begin + change(low, t, &mut |t| is_out(&between(t)));
                *within = if is_out(&here.sample.motion()) { None } else { Some(within.unwrap_or_else(entry)) };
            }
            low = t;
        }
        let HoldRequest { start, duration, .. } = self.request;
        let step = SAMPLE_STEP.max(duration / (MOST_SAMPLES - 2) as f64);
        while self.count + 1 < MOST_SAMPLES {
            let due = start.t + step * self.count as f64;
            let t = due - piece.begin;
            if t > to.t {
                break;
            }
            if t >= from.t {
                self.hold.samples.push(HoldSample { t: due, ..piece.moment(t, between(t)).sample });
            }
            self.count += 1;
        }
        self.last = to;
        turns.iter().map(|t| u32::from(*t < to.t)).sum()
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
