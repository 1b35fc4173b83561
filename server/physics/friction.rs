//! The strike with Coulomb friction: Routh's impulse in the plane, followed along its normal part through sliding, sticking and
//! slip reversal, with restitution by Poisson, Newton or Stronge.
//!
//! A body of its own, so that the rod without friction pays nothing for it. Flights are the rod's. Not here: derivatives, error
//! bounds and linear verdicts of it.

use crate::contact_time::TooManyPieces;
use crate::impact::{Rod, State, Strike};
use crate::map::{Body, Release};

/// Law of restitution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// The normal impulse of restitution is e times that of compression.
    Poisson,
    /// The normal velocity after is −e times that before.
    Newton,
    /// The normal work of restitution is e² times that of compression.
    Stronge,
}

/// How the table moves along itself at a strike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slide {
    /// It does not.
    None,
    /// As fast as the contact point just before.
    Matched,
}

/// What the contact did along the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Nothing held it.
    Frictionless,
    /// It slid one way from first to last.
    Slide,
    /// It was at rest, or came to rest, and stayed.
    Stick,
    /// It came to rest and slid on the other way.
    ReverseSlide,
    /// It was at rest and friction could not hold it.
    SlideOff,
}

impl Mode {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frictionless => "frictionless",
            Self::Slide => "slide",
            Self::Stick => "stick",
            Self::ReverseSlide => "reverse_slide",
            Self::SlideOff => "slide_off",
        }
    }
}

/// How the contact point's velocity answers to an impulse at it: ∂v_t/∂P_t, ∂v_n/∂P_n and, of either by the other, C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mobility {
    /// A = 1 + l² cos²β/ρ².
    pub tangential: f64,
    /// B = 1 + l² sin²β/ρ².
    pub normal: f64,
    /// C = l² sin β cos β/ρ².
    pub cross: f64,
}

/// An impulse per unit mass, m/s, and how it came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// P_n.
    pub normal: f64,
    /// P_t.
    pub tangential: f64,
    /// What the contact did.
    pub mode: Mode,
}

/// The normal velocity as the normal impulse grows: straight up to the end of the first sliding, and straight after it.
struct Course {
    /// Before, < 0.
    start: f64,
    /// dv_n/dP_n of the first stretch; not always positive.
    first: f64,
    /// P_n at its end; infinite where it has none.
    turn: f64,
    /// dv_n/dP_n beyond, always positive.
    second: f64,
}

impl Course {
    /// P_n at which the velocity comes up to `velocity`.
    fn reach(&self, velocity: f64) -> f64 {
        let rise = velocity - self.start;
        if self.first * self.turn >= rise {
            rise / self.first
        } else {
            self.turn + (rise - self.first * self.turn) / self.second
        }
    }

    /// P_n at which restitution has done e² of the work of compression, which ends at `compression`.
    fn reach_work(&self, compression: f64, restitution: f64) -> f64 {
        let Self { start, first, turn, second } = *self;
        let share = restitution * restitution;
        if compression >= turn {
            let middle = start + first * turn;
            let work = 0.5 * ((start + middle) * turn + middle * (compression - turn));
            return compression + (-2.0 * share * work / second).sqrt();
        }
        let work = -0.5 * share * start * compression;
        let alone = compression + (2.0 * work / first).sqrt();
        if alone <= turn {
            return alone;
        }
        let velocity = first * (turn - compression);
        let rest = work - 0.5 * velocity * (turn - compression);
        // Not the difference of the root and the velocity, which would cancel.
        turn + 2.0 * rest / (velocity + (velocity * velocity + 2.0 * second * rest).sqrt())
    }
}

impl Mobility {
    /// Of a contact point l from the centre of gravity, at sine and cosine of β.
    pub fn new(rod: &Rod, sin_beta: f64, cos_beta: f64) -> Self {
        let lever = rod.contact_distance / rod.radius_of_gyration;
        let (across, along) = (lever * sin_beta, lever * cos_beta);
        Self { tangential: 1.0 + along * along, normal: 1.0 + across * across, cross: across * along }
    }

    /// Routh's impulse: at velocities relative to the table just before (along it, and along its normal, the latter < 0).
    pub fn impulse(&self, tangential: f64, normal: f64, friction: f64, law: Law, restitution: f64) -> Impulse {
        let Self { tangential: a, normal: b, cross: c } = *self;
        let holds = c.abs() <= friction * a;
        // From rest it slides the way the normal impulse drives it; the slope dP_t/dP_n is against the sliding.
        let beyond = if holds { -c / a } else { -friction.copysign(c) };
        let (slope, turn, mode, after) = if tangential == 0.0 {
            (beyond, 0.0, Mode::Frictionless, if holds { Mode::Stick } else { Mode::SlideOff })
        } else {
            let slope = -friction.copysign(tangential);
            let slowing = -(c + a * slope) * tangential.signum();
            let turn = if slowing > 0.0 { tangential.abs() / slowing } else { f64::INFINITY };
            (slope, turn, Mode::Slide, if holds { Mode::Stick } else { Mode::ReverseSlide })
        };
        let course = Course { start: normal, first: b + c * slope, turn, second: b + c * beyond };
        let compression = course.reach(0.0);
        let end = match law {
            Law::Poisson => (1.0 + restitution) * compression,
            Law::Newton => course.reach(-restitution * normal),
            Law::Stronge => course.reach_work(compression, restitution),
        };
        let (tangential, mode) =
            if end <= turn { (slope * end, mode) } else { (slope * turn + beyond * (end - turn), after) };
        Impulse { normal: end, tangential, mode: if friction == 0.0 { Mode::Frictionless } else { mode } }
    }
}

/// A rod whose contact has friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughRod {
    /// The rod and its table without it.
    pub rod: Rod,
    /// μ.
    pub friction: f64,
    /// Law of restitution.
    pub law: Law,
    /// How the table moves along itself.
    pub slide: Slide,
}

impl RoughRod {
    /// The strike, and its impulse.
    // Out of the loop of the frictionless bounce, which shares its code with this one.
    #[inline(never)]
    pub fn strike_with_impulse(&self, before: &State) -> (Strike, Impulse) {
        let rod = &self.rod;
        let tilt = rod.tilt(before.theta);
        let mut strike = rod.strike_with(before, &tilt, rod.leverage());
        let (sin_alpha, cos_alpha, sin_beta) = (tilt.sin_alpha, tilt.cos_alpha, tilt.sin_beta);
        let (_, cos_beta) = crate::trig::sin_cos((1.0 - rod.tilt_gain) * before.theta);
        let along = rod.contact_distance * cos_beta;
        let velocity = cos_alpha * before.x_dot + sin_alpha * before.y_dot + along * before.theta_dot;
        let (table, relative) = match self.slide {
            Slide::None => (0.0, velocity),
            Slide::Matched => (velocity, 0.0),
        };
        let mobility = Mobility::new(rod, sin_beta, cos_beta);
        let impulse = mobility.impulse(relative, strike.approach, self.friction, self.law, rod.restitution);
        let Impulse { normal, tangential, .. } = impulse;
        let across = rod.contact_distance * sin_beta;
        let after = State {
            theta: before.theta,
            x_dot: before.x_dot + (tangential * cos_alpha - normal * sin_alpha),
            y_dot: before.y_dot + (tangential * sin_alpha + normal * cos_alpha),
            theta_dot: before.theta_dot + (tangential * along + normal * across) * rod.leverage(),
        };
        let spin = rod.radius_of_gyration * after.theta_dot;
        let speed_squared = after.x_dot * after.x_dot + after.y_dot * after.y_dot + spin * spin;
        strike.table_velocity.0 += table * cos_alpha;
        strike.table_velocity.1 += table * sin_alpha;
        strike.impulse_normal = normal;
        strike.contact_rise = after.y_dot + rod.contact_distance * after.theta_dot * tilt.sin_theta;
        strike.energy_gain = 0.5 * (speed_squared - strike.speed_squared);
        strike.after = after;
        (strike, impulse)
    }
}

impl Body for RoughRod {
    fn fall(&self, release: &Release) -> Result<(f64, State), TooManyPieces> {
        self.rod.fall(release)
    }

    fn strike(&self, before: &State) -> Strike {
        self.strike_with_impulse(before).0
    }

    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64 {
        self.rod.hold_energy(strike, energy)
    }

    #[inline(always)]
    fn fly(&self, strike: &Strike) -> Result<(f64, State), TooManyPieces> {
        self.rod.fly(strike)
    }

    fn contact_distance(&self) -> f64 {
        self.rod.contact_distance
    }

    fn contact_height(&self, state: &State) -> f64 {
        self.rod.contact_height(state)
    }

    fn energy(&self, state: &State) -> f64 {
        self.rod.energy(state)
    }

    fn contact_speed(&self, state: &State) -> f64 {
        self.rod.contact_speed(state)
    }
}
