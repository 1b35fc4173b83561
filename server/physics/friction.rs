//! The strike with Coulomb friction: Routh's impulse in the plane, followed along its normal part through sliding, sticking and
//! slip reversal, with restitution by Poisson, Newton or Stronge.
//!
//! Flights are the rod's, and what else a contact needs is in [`crate::rig`]. Not here: derivatives, error bounds and linear
//! verdicts.

use crate::impact::{Rod, State, Strike, Tilt};
use crate::map::Plan;

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

/// A contact with friction, and how the table moves along itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// μ.
    pub coefficient: f64,
    /// Law of restitution.
    pub law: Law,
    /// How the table moves along itself.
    pub slide: Slide,
}

impl Friction {
    /// The strike of a rod over a table tilted like this, which moves as it was planned if it was.
    // Out of the loop of the frictionless bounce, which shares its code with this one.
    #[inline(never)]
    pub(crate) fn strike(&self, rod: &Rod, before: &State, tilt: &Tilt<f64>, plan: Option<&Plan>) -> Strike {
        let mut strike = rod.strike_with(before, tilt, rod.leverage());
        let Tilt { sin_alpha, cos_alpha, sin_beta, .. } = *tilt;
        let (_, cos_beta) = crate::trig::sin_cos(tilt.beta);
        let (across, along) = (rod.contact_distance * sin_beta, rod.contact_distance * cos_beta);
        let velocity = tangential_velocity(rod, before, tilt, cos_beta);
        if let Some(plan) = plan {
            strike.approach = strike.normal_velocity - plan.normal_velocity;
            strike.push = (1.0 + rod.restitution) * strike.approach;
            strike.table_velocity = (-plan.normal_velocity * sin_alpha, plan.normal_velocity * cos_alpha);
        }
        let (table, relative) = match (self.slide, plan) {
            (Slide::None, _) => (0.0, velocity),
            // Set, not computed: a difference of rounding would slide.
            (Slide::Matched, None) => (velocity, 0.0),
            (Slide::Matched, Some(plan)) => (plan.tangential_velocity, velocity - plan.tangential_velocity),
        };
        let mobility = Mobility::new(rod, sin_beta, cos_beta);
        let Impulse { normal, tangential, mode } =
            mobility.impulse(relative, strike.approach, self.coefficient, self.law, rod.restitution);
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
        (strike.impulse_normal, strike.impulse_tangential, strike.mode) = (normal, tangential, mode);
        strike.contact_rise = rod.contact_rise(&after, tilt.sin_theta);
        strike.energy_gain = 0.5 * (speed_squared - strike.speed_squared);
        strike.after = after;
        strike
    }

    /// The table's velocity along itself where nothing delays it, m/s.
    pub(crate) fn table_speed(&self, rod: &Rod, before: &State, tilt: &Tilt<f64>) -> f64 {
        match self.slide {
            Slide::None => 0.0,
            Slide::Matched => tangential_velocity(rod, before, tilt, crate::trig::sin_cos(tilt.beta).1),
        }
    }
}

/// Velocity of the contact point along the table, m/s.
fn tangential_velocity(rod: &Rod, before: &State, tilt: &Tilt<f64>, cos_beta: f64) -> f64 {
    let along = rod.contact_distance * cos_beta;
    tilt.cos_alpha * before.x_dot + tilt.sin_alpha * before.y_dot + along * before.theta_dot
}
