//! The equations of motion of a body in contact, for as long as the kind of contact stays the same.

use crate::bounce::friction::Mobility;
use crate::contact::force::{ContactMotion, TangentialForce};
use crate::contact::request::HoldLaw;
use crate::contact::stance::Stance;
use crate::numbers::number::Number;
use crate::table::control_law::Gains;
use differential_equations::ode::ODE;

/// Longest step of the integrator, s, while the table goes to the tilt of its law in less than that.
const STEP_ON_THE_WAY: f64 = 1e-3;

/// x, θ, ẋ, θ̇ of the centre of gravity: m, rad, m/s, rad/s.
pub type Motion<N = f64> = [N; 4];

/// Kind of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mode {
    /// F = φN with a fixed φ: no friction, or sliding one way.
    Sliding(f64),
    /// On a table that moves along itself with the contact point: F does not accelerate that along the table, and is at most μN.
    Matched(f64),
    /// The contact point stays on one point of the table's surface.
    Sticking,
}

/// The way of the table to the tilt of its law, at a constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TiltWay {
    /// α at the beginning of the piece, rad.
    pub(super) from: f64,
    /// α̇, rad/s.
    pub(super) rate: f64,
}

impl TiltWay {
    /// α after `t` s, rad.
    pub(super) fn at(&self, t: f64) -> f64 {
        self.from + self.rate * t
    }
}

/// The equations of one kind of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Equations {
    pub(super) stance: Stance,
    pub(super) law: HoldLaw,
    /// The table on its way to the tilt of the law, if it is not there.
    pub(super) way: Option<TiltWay>,
    pub(super) mode: Mode,
    /// G + a, m/s².
    pub(super) gravity: f64,
}

impl HoldLaw {
    /// α, rad.
    pub(super) fn tilt<N: Number>(&self, motion: &Motion<N>) -> N {
        match self {
            Self::TiltGain(gain) => N::from_f64(*gain) * motion[1],
            Self::Feedback(gains) => fed_back(gains, motion),
            Self::Tilted(gains, constant) => fed_back(gains, motion) + N::from_f64(*constant),
            Self::CartPole(_) | Self::Level => N::from_f64(0.0),
        }
    }

    /// Acceleration of the table's surface along x, m/s².
    fn acceleration<N: Number>(&self, motion: &Motion<N>) -> N {
        match self {
            Self::CartPole(gains) => fed_back(gains, motion),
            Self::TiltGain(_) | Self::Feedback(_) | Self::Tilted(..) | Self::Level => N::from_f64(0.0),
        }
    }

    /// α̇, rad/s, from the motion and its derivative.
    pub(super) fn tilt_rate(&self, change: &Motion) -> f64 {
        match self {
            Self::Tilted(gains, _) => fed_back(gains, change),
            // The law is linear, so its rate is the law of the rates.
            Self::TiltGain(_) | Self::Feedback(_) | Self::CartPole(_) | Self::Level => self.tilt(change),
        }
    }
}

/// −K·(x, θ, ẋ, θ̇).
fn fed_back<N: Number>(gains: &Gains, &[x, theta, x_dot, theta_dot]: &Motion<N>) -> N {
    let gain = |value: f64| N::from_f64(value);
    -(gain(gains.x) * x + gain(gains.theta) * theta + gain(gains.x_dot) * x_dot + gain(gains.theta_dot) * theta_dot)
}

impl Equations {
    /// α `t` s after the beginning of the piece, rad.
    pub(super) fn tilt<N: Number>(&self, t: f64, motion: &Motion<N>) -> N {
        self.way.map_or_else(|| self.law.tilt(motion), |way| N::from_f64(way.at(t)))
    }

    /// True if the table has come to the tilt of its law.
    pub(super) fn has_arrived(&self, t: f64, motion: &Motion) -> bool {
        self.way.is_some_and(|way| (self.law.tilt(motion) - way.at(t)) * way.rate.signum() <= 0.0)
    }

    /// Longest step of the integrator, s: as long as the table is on its way, the time to a law that stands still.
    pub(super) fn longest_step(&self, motion: &Motion) -> f64 {
        let time = |way: TiltWay| ((self.law.tilt(motion) - way.from) / way.rate).max(STEP_ON_THE_WAY);
        self.way.map_or(f64::INFINITY, time)
    }

    /// Accelerations and the force of the table `t` s after the beginning of the piece.
    pub(super) fn accelerations<N: Number>(&self, t: f64, motion: &Motion<N>) -> ContactMotion<N> {
        let alpha = self.tilt(t, motion);
        let theta = motion[1] + N::from_f64(self.stance.turn);
        let rod = self.stance.rod.lift::<N>();
        let force = match self.mode {
            Mode::Sliding(share) => TangentialForce::Sliding(N::from_f64(share)),
            Mode::Matched(friction) => {
                let (sin_beta, cos_beta) = (theta - alpha).sincos();
                let mobility = Mobility::new(&rod, sin_beta, cos_beta);
                let share = -(mobility.cross / mobility.tangential);
                let limited = share.to_f64().clamp(-friction, friction);
                TangentialForce::Sliding(if limited == share.to_f64() { share } else { N::from_f64(limited) })
            }
            Mode::Sticking => TangentialForce::Sticking(self.law.acceleration(motion)),
        };
        ContactMotion::new(&rod, N::from_f64(self.gravity), [theta, motion[3], alpha], force)
    }

    /// Velocity of the contact point along x, m/s.
    pub(super) fn contact_speed(&self, motion: &Motion) -> f64 {
        let (_, cos) = crate::numbers::trig::sin_cos(motion[1] + self.stance.turn);
        motion[2] + self.stance.rod.contact_distance * cos * motion[3]
    }

    /// Place of the contact point along x, m.
    pub(super) fn contact_place(&self, motion: &Motion) -> f64 {
        let (sin, _) = crate::numbers::trig::sin_cos(motion[1] + self.stance.turn);
        motion[0] + self.stance.rod.contact_distance * sin
    }
}

impl ODE<f64, Motion> for Equations {
    fn diff(&self, t: f64, motion: &Motion, change: &mut Motion) {
        let ContactMotion { x_ddot, theta_ddot, .. } = self.accelerations(t, motion);
        *change = [motion[2], motion[3], x_ddot, theta_ddot];
    }
}
