//! The body, the table and the contact at one moment: everything that ends or is recorded of a motion follows from it.

use crate::contact::equations::{Equations, Mode, Motion};
use crate::contact::force::{ContactForce, ContactMotion};
use crate::contact::record::HoldSample;
use crate::contact::request::{ContactStart, HoldLaw, HoldRequest, Touching};
use crate::numbers::trig;
use crate::table::actuator_load::{ActuatorLoad, LimitViolation};

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
        let moves_along =
            matches!(self.equations.mode, Mode::Matched(_)) || matches!(self.equations.law, HoldLaw::CartPole(_));
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
        if sample.theta.abs() >= self.request.topple_angle {
            return Some(Event::Toppled);
        }
        if self.equations.has_arrived(t, motion) {
            return Some(Event::Arrives);
        }
        self.request.limits.and_then(|limits| limits.exceeded(&moment.load)).map(Event::Limit)
    }
}
