//! From one kind of contact to the next: sliding, sticking, braking, a table on its way to its law, one vertex after another.

use crate::map::table::actuator_load::ActuatorLoad;
use crate::numbers::trig;
use crate::run::lasting_contact::equations::{
    ContactForce, ContactMotion, Equations, Landing, Mode, Motion, Stance, TiltWay,
};
use crate::run::lasting_contact::moment::{ContactSetting, Event, PieceEnd, Recorder, TableFall, Watch};
use crate::run::lasting_contact::request::{
    Hold, HoldEnding, HoldLaw, HoldRequest, HoldSample, StrikeBefore, Touching, moving_rate,
};
use crate::run::lasting_contact::work::{MOST_PIECES, PIECE, Work};

/// Angle of rocking, rad, below which the rest of the rocking is summed in closed form.
const LEAST_ROCKING: f64 = 1e-9;

/// Share of the time to come down again, for a body that rises from a vertex, after which that vertex may land.
const RISING_SHARE: f64 = 0.25;

/// Velocity of a contact point at rest, in units of the rounding of the velocities of which it is made.
const REST_UNITS: f64 = 8.0;

/// Difference of tilts, rad, that is rounding: the stop of a plan ends at the tilt of the law, apart from that.
const SAME_TILT: f64 = 1e-9;

/// A motion between two pieces.
struct Course<'a> {
    request: &'a HoldRequest,
    stance: Stance,
    t: f64,
    motion: Motion,
    /// Tilt of a table that may not be at the tilt of its law, rad.
    alpha: Option<f64>,
    /// The last moment.
    last: Option<HoldSample>,
    /// Vertex that has just left the table, and the time, s, for which it does not land again.
    rising: Option<(usize, f64)>,
}

/// Follows the motion with one tolerance of the integrator.
pub(super) fn follow(request: &HoldRequest, tolerance: f64, work: &mut Work<'_>) -> Hold {
    let start = request.start;
    let motion = [start.x, start.theta, start.x_dot, start.theta_dot];
    let stance = Stance::new(request);
    let mut course = Course { request, stance, t: start.t, motion, alpha: None, last: None, rising: None };
    if course.rocks() {
        course.stick();
    }
    let mut recorder = Recorder::new(request, &course.motion);
    let ending = course.go(&mut recorder, tolerance, work);
    course.record(recorder, ending)
}

impl Course<'_> {
    /// Goes on from piece to piece up to the ending.
    fn go(&mut self, recorder: &mut Recorder, tolerance: f64, work: &mut Work<'_>) -> HoldEnding {
        let request = self.request;
        let arrival = self.begin();
        recorder.load = arrival;
        let mut too_fast = request.rules.limits.and_then(|limits| limits.exceeded(&arrival)).map(Event::Limit);
        let origin = self.equations(Mode::Sticking).contact_place(&self.motion);
        let end = request.start.t + request.duration;
        for _ in 0..MOST_PIECES {
            if let Err(ending) = work.take(PIECE) {
                return ending;
            }
            let equations = self.equations(self.mode());
            let (_, stands) = TableFall::new(request, self.t);
            let until = if self.t < stands { end.min(stands) } else { end };
            let setting = ContactSetting { request, equations, begin: self.t, origin, rising: self.rising };
            let first = setting.moment(0.0, &self.motion);
            recorder.peak(&first);
            self.last = Some(first.sample);
            if recorder.samples.is_empty() {
                recorder.begin(first.sample);
            }
            let rising = self.rising.map_or(f64::INFINITY, |(_, until)| until);
            let longest_step = rising.min(equations.longest_step(&self.motion));
            let mut event = too_fast.take().or_else(|| setting.event(0.0, &first, &self.motion));
            if event.is_none() {
                if until <= self.t {
                    return HoldEnding::Completed;
                }
                let span = (until - self.t, longest_step, tolerance);
                let mut watch = Watch::new(setting, recorder);
                let (t, motion, piece_end) = watch.integrate(self.motion, span, work);
                event = watch.event;
                let last = watch.setting.moment(t, &motion);
                self.t = if piece_end == PieceEnd::Over { until } else { self.t + t };
                self.motion = motion;
                if equations.way.is_some() || self.law() != equations.law {
                    self.alpha = Some(last.sample.alpha);
                }
                recorder.peak(&last);
                self.last = Some(last.sample);
                match piece_end {
                    PieceEnd::Over if until == end => return HoldEnding::Completed,
                    PieceEnd::Over => continue,
                    PieceEnd::Given(ending) => return ending,
                    PieceEnd::Found => {}
                }
            }
            let Some(event) = event else { break };
            if let Some(ending) = self.go_on_after(event, recorder) {
                return ending;
            }
        }
        HoldEnding::TooLong
    }

    /// Takes over the table from the strike before: at its tilt if the contact begins with it. If there was time between them the table has come
    /// to the tilt of its law. Returns the load of that way.
    fn begin(&mut self) -> ActuatorLoad {
        let Some(StrikeBefore { alpha, time }) = self.request.start.before else { return ActuatorLoad::default() };
        if time > 0.0 {
            let change = (self.law().tilt(&self.motion) - alpha).abs();
            return ActuatorLoad { tilt_rate: (change / time).min(f64::MAX), ..ActuatorLoad::default() };
        }
        self.alpha = Some(alpha);
        ActuatorLoad::default()
    }

    /// True for a polygon on a level table.
    fn rocks(&self) -> bool {
        self.law() == HoldLaw::Level && self.request.body.outline.is_some()
    }

    fn sticks(&self) -> bool {
        self.request.touching != Touching::Frictionless
    }

    fn equations(&self, mode: Mode) -> Equations {
        let (fall, _) = TableFall::new(self.request, self.t);
        let gravity = self.request.body.rod.gravity + fall.y_ddot;
        let table = (fall.y_dot, fall.y_ddot);
        let (stance, air) = (self.stance, self.request.body.drag);
        Equations { stance, law: self.law(), way: self.way(), mode, gravity, air, table }
    }

    /// The way of the table to the tilt of its law, if it is not there.
    fn way(&self) -> Option<TiltWay> {
        let from = self.alpha?;
        let change = self.law().tilt(&self.motion) - from;
        let rate = moving_rate(&self.request.body.rod, self.request.rules.limits.as_ref());
        (change.abs() > SAME_TILT).then(|| TiltWay { from, rate: rate.copysign(change) })
    }

    /// The law of the table here.
    fn law(&self) -> HoldLaw {
        let (fall, _) = TableFall::new(self.request, self.t);
        let braking = self.request.brake_law.filter(|_| fall.y_ddot != 0.0);
        braking.unwrap_or(self.request.law)
    }

    /// The kind of contact that begins here.
    fn mode(&self) -> Mode {
        let (kind, slides) = self.request.kind(self.law());
        let Some(friction) = slides else { return kind };
        let sticking = self.equations(Mode::Sticking);
        let speed = sticking.contact_speed(&self.motion);
        let turn = self.stance.rod.contact_distance * self.motion[3].abs();
        if speed.abs() > REST_UNITS * f64::EPSILON * (self.motion[2].abs() + turn) {
            return Mode::Sliding(-friction.copysign(speed));
        }
        let ContactForce { normal, tangential } = sticking.accelerations(0.0, &self.motion).force;
        if tangential.abs() <= friction * normal { kind } else { Mode::Sliding(friction.copysign(tangential)) }
    }

    /// Stops the contact point, plastically: the angular momentum about it is kept.
    fn stick(&mut self) {
        if !self.sticks() {
            return;
        }
        let rod = self.stance.rod;
        let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
        let (_, cos) = trig::sin_cos(self.motion[1] + self.stance.turn);
        let about_contact = rho * rho + l * l;
        // Vertically the contact point rests already: ẏ = −lθ̇ sin θ.
        let lost = self.motion[2] + l * cos * self.motion[3];
        self.motion[3] -= l * cos * lost / about_contact;
        self.motion[2] = -l * cos * self.motion[3];
    }

    /// Goes on after an event, or ends.
    fn go_on_after(&mut self, event: Event, recorder: &mut Recorder) -> Option<HoldEnding> {
        self.rising = None;
        match event {
            Event::Lost => Some(HoldEnding::ContactLost),
            Event::Toppled => Some(HoldEnding::Toppled),
            Event::Limit(violation) => Some(HoldEnding::BeyondLimits(violation)),
            Event::OffTable { place, limit } => Some(HoldEnding::OffTable { place, limit }),
            Event::Slips(needed) if self.law().is_cart_pole() || self.rocks() => Some(HoldEnding::Slipped { needed }),
            // The contact point rests at this moment, to the last digit.
            Event::Slips(_) | Event::SlipStops => {
                self.motion[2] -= self.equations(Mode::Sticking).contact_speed(&self.motion);
                None
            }
            Event::Arrives => {
                self.alpha = None;
                None
            }
            // A landing on a table that tilts is not derived.
            Event::Lands(vertex) if self.rocks() && self.way().is_none() => self.land(vertex, recorder),
            Event::Lands(vertex) => Some(HoldEnding::OtherVertex(vertex)),
        }
    }

    /// Another vertex lands on the level table.
    fn land(&mut self, vertex: usize, recorder: &mut Recorder) -> Option<HoldEnding> {
        let Landing { ratio, needed_friction, bears, edge, stance } =
            self.stance.land(vertex, self.motion[1], self.sticks());
        recorder.least_friction = recorder.least_friction.max(needed_friction);
        if needed_friction > self.request.touching.coefficient() {
            return Some(HoldEnding::Slipped { needed: needed_friction });
        }
        let left = self.stance.vertex();
        let theta_dot = self.motion[3] * ratio.max(0.0);
        // The speed of the centre of gravity goes with the angular velocity about the new vertex.
        let before = self.stance;
        self.stance = stance;
        if self.sticks() {
            let (_, cos) = trig::sin_cos(self.motion[1] + stance.turn);
            self.motion[2] = -stance.rod.contact_distance * cos * theta_dot;
        }
        self.motion[3] = theta_dot;
        if !bears {
            return None;
        }
        let onto = self.time_to_return(self.stance, theta_dot);
        if ratio > 0.0 && theta_dot.abs() * onto >= LEAST_ROCKING {
            self.rising = Some((left, RISING_SHARE * onto));
            return None;
        }
        // The times on one vertex and the other form a geometric series in the product of both ratios.
        let back = stance.land(left, self.motion[1], self.sticks());
        let returned = self.time_to_return(before, theta_dot * back.ratio.max(0.0));
        let both = ratio.max(0.0) * back.ratio.max(0.0);
        let rest = if ratio > 0.0 { (onto + returned) / (1.0 - both) } else { 0.0 };
        let end = self.request.start.t + self.request.duration;
        if self.t + rest > end {
            self.t = end;
            self.last = self.last.map(|last| HoldSample { t: end, theta_dot, x_dot: self.motion[2], ..last });
            return Some(HoldEnding::Completed);
        }
        self.t += rest;
        self.last = self.last.map(|last| HoldSample {
            t: self.t,
            x_dot: if self.sticks() { 0.0 } else { last.x_dot },
            theta_dot: 0.0,
            normal_force: self.equations(Mode::Sticking).gravity,
            tangential_force: 0.0,
            ..last
        });
        Some(HoldEnding::RestsOnEdge { vertices: edge })
    }

    /// Time in which a small rise about this vertex at this angular velocity is over, s.
    fn time_to_return(&self, stance: Stance, theta_dot: f64) -> f64 {
        let mode = if self.sticks() { Mode::Sticking } else { Mode::Sliding(0.0) };
        let motion = [self.motion[0], self.motion[1], 0.0, 0.0];
        let ContactMotion { theta_ddot, .. } = Equations { stance, ..self.equations(mode) }.accelerations(0.0, &motion);
        (2.0 * theta_dot / theta_ddot).abs()
    }

    /// The answer, with the motion at its end.
    fn record(self, mut recorder: Recorder, ending: HoldEnding) -> Hold {
        if let Some(last) = self.last {
            recorder.end(last);
        }
        let (theta_within, x_within) = if ending == HoldEnding::Completed { recorder.within() } else { (None, None) };
        Hold {
            ending,
            t_end: self.t,
            theta_within,
            x_within,
            error_bound: f64::INFINITY,
            load: recorder.load,
            travel: recorder.travel(),
            most_theta: recorder.most_theta,
            least_friction: recorder.least_friction,
            samples: recorder.samples,
        }
    }
}
