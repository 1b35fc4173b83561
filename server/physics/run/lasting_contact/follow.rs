//! From one kind of contact to the next: sliding, sticking, braking, a table on its way to its law, one vertex after another.

use crate::map::body::Touch;
use crate::map::table::actuator_load::ActuatorLoad;
use crate::numbers::trig;
use crate::run::ending::Ending;
use crate::run::lasting_contact::equations::{ContactMotion, Landing, Mode, Piece, Stance, TableFall, TiltWay};
use crate::run::lasting_contact::moment::{Event, Record};
use crate::run::lasting_contact::request::{Hold, HoldEnding, HoldLaw, HoldRequest, Motion, moving_rate};
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
    rising: Option<(usize, f64)>,
}

/// Follows the motion with one tolerance of the integrator.
pub(super) fn follow(request: &HoldRequest, tolerance: f64, work: &mut Work<'_>) -> Hold {
    let (start, stance) = (&request.start, Stance::new(request));
    let mut course = Course { request, stance, t: start.t, motion: start.motion(), alpha: None, rising: None };
    if course.rocks() {
        course.stick();
    }
    let load = course.take_over();
    let mut record = Record::new(request, course.piece(course.mode()).moment(0.0, course.motion), load);
    let ending = course.go(&mut record, tolerance, work).unwrap_or_else(|ending| ending);
    record.end(ending, course.t)
}

impl<'a> Course<'a> {
    /// Goes on from piece to piece up to the ending. Fails as [`Record::follow`] does, or after too many pieces.
    fn go(&mut self, record: &mut Record<'_>, tolerance: f64, work: &mut Work<'_>) -> Result<HoldEnding, HoldEnding> {
        let limits = self.request.rules.limits;
        let too_fast = limits.and_then(|limits| limits.exceeded(&record.hold.load));
        let mut too_fast = too_fast.map(|violation| Event::Ends(HoldEnding::Ended(Ending::BeyondLimits(violation))));
        let end = self.end();
        for _ in 0..MOST_PIECES {
            work.take(PIECE)?;
            let piece = self.piece(self.mode());
            let stands = piece.fall.stands;
            let until = if self.t < stands { end.min(stands) } else { end };
            record.last = piece.moment(0.0, self.motion);
            record.peak(&{ record.last });
            let mut event = too_fast.take().or_else(|| piece.event(&record.last));
            if event.is_none() {
                if until <= self.t {
                    return Ok(HoldEnding::Completed);
                }
                let followed = record.follow(&piece, until - self.t, tolerance, work);
                let last = record.last;
                record.peak(&last);
                self.t = if followed == Ok(None) { until } else { last.sample.t };
                self.motion = last.sample.motion();
                if piece.way.is_some() || self.law() != piece.law {
                    self.alpha = Some(last.sample.alpha);
                }
                event = followed?;
                if event.is_none() && until == end {
                    return Ok(HoldEnding::Completed);
                }
            }
            if let Some(event) = event
                && let Some(ending) = self.go_on_after(event, record)
            {
                return Ok(ending);
            }
        }
        Err(HoldEnding::TooLong)
    }

    /// Time at which the motion is followed no further, s.
    fn end(&self) -> f64 {
        self.request.start.t + self.request.duration
    }

    /// Takes over the table from the strike before: at its tilt if the contact begins with it. If there was time between them the table has come
    /// to the tilt of its law. Returns the load of that way.
    fn take_over(&mut self) -> ActuatorLoad {
        let mut load = ActuatorLoad::default();
        match self.request.start.before {
            Some((pose, time)) if time > 0.0 => {
                let change = (self.law().tilt(&self.motion) - pose.alpha).abs();
                load.tilt_rate = (change / time).min(f64::MAX);
            }
            before => self.alpha = before.map(|(pose, _)| pose.alpha),
        }
        load
    }

    /// True for a polygon on a level table.
    fn rocks(&self) -> bool {
        self.law() == HoldLaw::Level && self.request.body.outline.is_some()
    }

    fn sticks(&self) -> bool {
        self.request.body.rough().is_some()
    }

    fn piece(&self, mode: Mode) -> Piece<'a> {
        let Self { request, stance, t, rising, .. } = *self;
        Piece { request, stance, law: self.law(), way: self.way(), mode, begin: t, fall: self.fall(), rising }
    }

    fn fall(&self) -> TableFall {
        TableFall::at(self.request, self.t)
    }

    fn way(&self) -> Option<TiltWay> {
        let from = self.alpha?;
        let change = self.law().tilt(&self.motion) - from;
        let rate = moving_rate(&self.request.body.rod, self.request.rules.limits.as_ref());
        (change.abs() > SAME_TILT).then(|| TiltWay { from, rate: rate.copysign(change) })
    }

    fn law(&self) -> HoldLaw {
        let brakes = self.fall().y_ddot != 0.0;
        self.request.brake_law.filter(|_| brakes).unwrap_or(self.request.law)
    }

    fn mode(&self) -> Mode {
        let (kind, slides) = self.request.kind(self.law());
        let Some(friction) = slides else { return kind };
        let speed = self.stance.contact_speed(&self.motion);
        let turn = self.stance.rod.contact_distance * self.motion[3].abs();
        if speed.abs() > REST_UNITS * f64::EPSILON * (self.motion[2].abs() + turn) {
            return Mode::Sliding(-friction.copysign(speed));
        }
        let ContactMotion { normal, tangential, .. } = self.piece(Mode::Sticking).accelerations(0.0, &self.motion);
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
    fn go_on_after(&mut self, event: Event, record: &mut Record<'_>) -> Option<HoldEnding> {
        self.rising = None;
        match event {
            Event::Ends(ending) => return Some(ending),
            Event::Slips(needed) if self.law().is_cart_pole() || self.rocks() => {
                return Some(HoldEnding::Slipped { needed });
            }
            // The contact point rests at this moment, to the last digit.
            Event::Slips(_) | Event::SlipStops => self.motion[2] -= self.stance.contact_speed(&self.motion),
            Event::Arrives => self.alpha = None,
            // A landing on a table that tilts is not derived.
            Event::Lands(vertex) if self.rocks() && self.way().is_none() => return self.land(vertex, record),
            Event::Lands(vertex) => return Some(HoldEnding::Ended(Ending::OtherVertex(Touch { vertex, t: 0.0 }))),
        }
        None
    }

    /// Another vertex lands on the level table.
    fn land(&mut self, vertex: usize, record: &mut Record<'_>) -> Option<HoldEnding> {
        let before = self.stance;
        let Landing { ratio, needed_friction, bears, stance } = before.land(vertex, self.motion[1], self.sticks());
        record.hold.least_friction = record.hold.least_friction.max(needed_friction);
        if self.request.body.rough().is_some_and(|friction| needed_friction > friction.coefficient) {
            return Some(HoldEnding::Slipped { needed: needed_friction });
        }
        let left = before.vertex;
        let theta_dot = self.motion[3] * ratio.max(0.0);
        // The speed of the centre of gravity goes with the angular velocity about the new vertex.
        self.stance = stance;
        if self.sticks() {
            let (_, cos) = trig::sin_cos(self.motion[1] + stance.turn);
            self.motion[2] = -stance.rod.contact_distance * cos * theta_dot;
        }
        self.motion[3] = theta_dot;
        if !bears {
            return None;
        }
        let onto = self.time_to_return(stance, theta_dot);
        if ratio > 0.0 && theta_dot.abs() * onto >= LEAST_ROCKING {
            self.rising = Some((left, RISING_SHARE * onto));
            return None;
        }
        // The times on one vertex and the other form a geometric series in the product of both ratios.
        let back = stance.land(left, self.motion[1], self.sticks());
        let returned = self.time_to_return(before, theta_dot * back.ratio.max(0.0));
        let both = ratio.max(0.0) * back.ratio.max(0.0);
        let rest = if ratio > 0.0 { (onto + returned) / (1.0 - both) } else { 0.0 };
        let (rests, last) = (self.t + rest <= self.end(), &mut record.last.sample);
        self.t = if rests { self.t + rest } else { self.end() };
        last.t = self.t;
        if !rests {
            (last.theta_dot, last.x_dot) = (theta_dot, self.motion[2]);
            return Some(HoldEnding::Completed);
        }
        (last.theta_dot, last.tangential_force) = (0.0, 0.0);
        if self.sticks() {
            last.x_dot = 0.0;
        }
        last.normal_force = self.request.body.rod.gravity + self.fall().y_ddot;
        Some(HoldEnding::RestsOnEdge { vertices: [left.min(vertex), left.max(vertex)] })
    }

    /// Time in which a small rise about this vertex at this angular velocity is over, s.
    fn time_to_return(&self, stance: Stance, theta_dot: f64) -> f64 {
        let mode = if self.sticks() { Mode::Sticking } else { Mode::Sliding(0.0) };
        let motion = [self.motion[0], self.motion[1], 0.0, 0.0];
        let piece = Piece { stance, ..self.piece(mode) };
        (2.0 * theta_dot / piece.accelerations(0.0, &motion).theta_ddot).abs()
    }
}
