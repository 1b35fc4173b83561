//! The strike with Coulomb friction: Routh's impulse in the plane, followed along its normal part through sliding, sticking and
//! slip reversal, with restitution by Poisson, Newton or Stronge.
//!
//! It runs on numbers side by side; the caller decides its branches. The rest of a contact: [`crate::map::bounce`].

use crate::map::strike::{ContactMode, RISE_UNITS, Rod, State, Strike, TableMotion, Tilt};
use crate::numbers::number::{Arithmetic, Mask, Number};

/// Law of restitution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestitutionLaw {
    /// The normal impulse of restitution is e times that of compression.
    Poisson,
    /// The normal velocity after is −e times that before.
    Newton,
    /// The normal work of restitution is e² times that of compression.
    Stronge,
}

names!(RestitutionLaw: Poisson => "poisson", Newton => "newton", Stronge => "stronge");

/// Motion of the table along itself at a strike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slide {
    /// It does not.
    None,
    /// Moves as fast as the contact point just before.
    Matched,
}

names!(Slide: None => "none", Matched => "matched");

/// A contact with friction, and how the table moves along itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<N = f64> {
    /// μ.
    pub coefficient: N,
    /// Law of restitution.
    pub law: RestitutionLaw,
    /// Motion of the table along itself.
    pub slide: Slide,
}

/// Response of the contact point's velocity to an impulse at it: ∂v_t/∂P_t, ∂v_n/∂P_n and, of either by the other, C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mobility<N = f64> {
    /// A = 1 + l² cos²β/ρ².
    pub tangential: N,
    /// B = 1 + l² sin²β/ρ².
    pub normal: N,
    /// C = l² sin β cos β/ρ².
    pub cross: N,
}

/// An impulse per unit mass, m/s, and how it came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse<N = f64> {
    /// P_n.
    pub normal: N,
    /// P_t.
    pub tangential: N,
    /// Mode of the contact; of many side by side it is that of one of them.
    pub mode: ContactMode,
}

/// A question about an impact that decides which formula holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrictionBranch {
    /// Does the contact point slide forwards at first: v_t ≥ 0.
    Forward,
    /// Does it come to rest before the end?
    Rests,
    /// Can friction hold it then: |C| ≤ μA?
    Holds,
    /// Does it come to rest while still compressed?
    RestsEarly,
}

/// An answer to a [`FrictionBranch`], and how far it is from the other: a number that changes its sign there, beside its scale.
#[derive(Clone, Copy, Debug)]
pub struct Decision<N: Arithmetic = f64> {
    /// Which question.
    pub branch: FrictionBranch,
    /// The answer that holds.
    pub answer: N::Mask,
    /// Distance from the other answer.
    pub margin: N,
    /// Scale beside which the margin is small, > 0.
    pub scale: N,
}

/// Takes every answer that holds.
#[inline(always)]
pub fn actual_branch<N: Arithmetic>(decision: Decision<N>) -> N::Mask {
    decision.answer
}

impl<N: Arithmetic> Mobility<N> {
    /// Mobility of a contact point l from the centre of gravity, at sine and cosine of β.
    #[inline(always)]
    pub fn new(rod: &Rod<N>, sin_beta: N, cos_beta: N) -> Self {
        let one = N::from_f64(1.0);
        let lever = rod.contact_distance / rod.radius_of_gyration;
        let (across, along) = (lever * sin_beta, lever * cos_beta);
        Self { tangential: one + along * along, normal: one + across * across, cross: across * along }
    }
}

impl<N: Number> Mobility<N> {
    /// P_t/P_n of a contact point that is at rest on the table at first: −C/A where it sticks, ∓μ where it slides.
    pub(crate) fn slope_from_rest(&self, friction: N) -> N {
        let driven = self.cross.to_f64();
        if driven.abs() <= friction.to_f64() * self.tangential.to_f64() {
            -self.cross / self.tangential
        } else if driven > 0.0 {
            -friction
        } else {
            friction
        }
    }
}

mapped!(Friction: coefficient; same law, slide);

impl<N: Arithmetic> Friction<N> {
    /// A contact without friction, for a table that does not move by its law alone.
    #[inline(always)]
    pub(crate) fn smooth() -> Self {
        Self { coefficient: N::from_f64(0.0), law: RestitutionLaw::Poisson, slide: Slide::None }
    }

    /// Routh's impulse at velocities relative to the table just before, along it and along its normal, the latter < 0.
    ///
    /// v_n grows with P_n from v_n0, with one slope up to the end of sliding, and with another beyond. As long as it
    /// slides, all laws are the same.
    #[inline(always)]
    pub fn impulse(
        &self,
        mobility: &Mobility<N>,
        tangential: N,
        normal: N,
        restitution: N,
        mut decide: impl FnMut(Decision<N>) -> N::Mask,
    ) -> Impulse<N> {
        use FrictionBranch::{Forward, Holds, Rests, RestsEarly};
        let Mobility { tangential: a, normal: b, cross: c } = *mobility;
        let friction = self.coefficient;
        let (zero, one) = (N::from_f64(0.0), N::from_f64(1.0));
        let bounced = (one + restitution) * -normal;
        let starts_at_rest = tangential.magnitude().is_at_most(zero);
        let is_driven_forward = zero.is_at_most(c);
        // From rest it goes the way the normal impulse drives it.
        let forward = zero.is_less(tangential) | (starts_at_rest & is_driven_forward);
        let forward = decide(Decision { branch: Forward, answer: forward, margin: tangential, scale: -normal });
        // Friction acts against the sliding.
        let slope = N::select(forward, -friction, friction);
        let (driven, speed) = (N::select(forward, c, -c), N::select(forward, tangential, -tangential));
        let first = b + c * slope;
        let slowing = a * friction - driven;
        let (end_of_sliding, push) = (first * speed, bounced * slowing);
        let mut rests = zero.is_less(slowing) & !friction.magnitude().is_at_most(zero);
        if rests.any() {
            let margin = push - end_of_sliding;
            rests = rests & decide(Decision { branch: Rests, answer: zero.is_less(margin), margin, scale: push });
        }
        // End of compression for a contact that slides throughout.
        let alone = -normal / first;
        let slides = (one + restitution) * alone;
        if !rests.any() {
            let mode = if friction.is_zero().any() {
                ContactMode::Frictionless
            } else if starts_at_rest.any() {
                ContactMode::SlideThrough
            } else {
                ContactMode::Slide
            };
            return Impulse { normal: slides, tangential: slope * slides, mode };
        }
        let hold = friction * a;
        let margin = hold - c.magnitude();
        let holds = decide(Decision { branch: Holds, answer: zero.is_at_most(margin), margin, scale: hold });
        let beyond = N::select(holds, -c / a, N::select(is_driven_forward, -friction, friction));
        let second = b + c * beyond;
        let turn = speed / slowing;
        // v_n as the sliding ends.
        let middle = normal + first * turn;
        let end = match self.law {
            RestitutionLaw::Newton => turn + (restitution * -normal - middle) / second,
            RestitutionLaw::Poisson | RestitutionLaw::Stronge => {
                let answer = middle.is_less(zero);
                let early = decide(Decision { branch: RestsEarly, answer, margin: middle, scale: -normal });
                let compression = N::select(early, turn - middle / second, alone);
                if self.law == RestitutionLaw::Poisson {
                    (one + restitution) * compression
                } else {
                    let mut end = compression;
                    if early.any() {
                        // −2 of the work of compression.
                        let work = middle * middle / second - (normal + middle) * turn;
                        end = compression + restitution * (work / second).sqrt();
                    }
                    if !early.all() {
                        // 2 of the work of restitution that is left.
                        let bounce = restitution * normal;
                        let rest = (bounce * bounce - middle * middle) / first;
                        // Not the difference of the root and the velocity, which would cancel.
                        let late = turn + rest / (middle + (middle * middle + second * rest).sqrt());
                        end = N::select(early, end, late);
                    }
                    end
                }
            }
        };
        let mode = if holds.any() {
            ContactMode::Stick
        } else if starts_at_rest.any() {
            ContactMode::SlideThrough
        } else {
            ContactMode::ReverseSlide
        };
        Impulse {
            normal: N::select(rests, end, slides),
            tangential: N::select(rests, slope * turn + beyond * (end - turn), slope * slides),
            mode,
        }
    }

    #[inline(always)]
    pub(crate) fn strike(
        &self,
        rod: &Rod<N>,
        before: &State<N>,
        tilt: &Tilt<N>,
        motion: TableMotion<'_, N>,
        leverage: N,
        decide: impl FnMut(Decision<N>) -> N::Mask,
    ) -> Strike<N> {
        let (zero, one) = (N::from_f64(0.0), N::from_f64(1.0));
        let mut strike = rod.strike_with(before, tilt, leverage);
        let Tilt { sin_alpha, cos_alpha, sin_beta, .. } = *tilt;
        let (across, along) = (rod.contact_distance * sin_beta, rod.contact_distance * tilt.cos_beta());
        let velocity = tangential_velocity(rod, before, tilt);
        match motion {
            TableMotion::ByLaw => {}
            TableMotion::Planned(plan) | TableMotion::Sensed(plan) => {
                let speed = plan.normal_velocity;
                strike.approach = strike.normal_velocity - speed;
                strike.push = (one + rod.restitution) * strike.approach;
                strike.table_velocity = (-(speed * sin_alpha), speed * cos_alpha);
            }
            TableMotion::Turning(surface) => {
                if let Some(speed) = surface.normal {
                    strike.approach = strike.approach - speed;
                    strike.push = (one + rod.restitution) * strike.approach;
                    let (x, y) = strike.table_velocity;
                    strike.table_velocity = (x - speed * sin_alpha, y + speed * cos_alpha);
                }
            }
        }
        let (table, relative) = match (self.slide, motion) {
            (Slide::None, TableMotion::ByLaw | TableMotion::Planned(_)) => (zero, velocity),
            (Slide::None, TableMotion::Turning(surface)) => (surface.tangential, velocity - surface.tangential),
            // Set, not computed: a difference of rounding would slide.
            (Slide::Matched, TableMotion::ByLaw) => (velocity, zero),
            (Slide::Matched, TableMotion::Planned(plan)) | (_, TableMotion::Sensed(plan)) => {
                let speed = plan.tangential_velocity;
                (speed, velocity - speed)
            }
            (Slide::Matched, TableMotion::Turning(surface)) if surface.is_matched => (velocity, zero),
            (Slide::Matched, TableMotion::Turning(surface)) => (velocity + surface.tangential, -surface.tangential),
        };
        let mobility = Mobility::new(rod, sin_beta, tilt.cos_beta());
        let impulse = self.impulse(&mobility, relative, strike.approach, rod.restitution, decide);
        let Impulse { normal, tangential, mode } = impulse;
        let after = State {
            theta: before.theta,
            x_dot: before.x_dot + (tangential * cos_alpha - normal * sin_alpha),
            y_dot: before.y_dot + (tangential * sin_alpha + normal * cos_alpha),
            theta_dot: before.theta_dot + (tangential * along + normal * across) * leverage,
        };
        let spin = rod.radius_of_gyration * after.theta_dot;
        let speed_squared = after.x_dot * after.x_dot + after.y_dot * after.y_dot + spin * spin;
        let (table_x, table_y) = strike.table_velocity;
        strike.table_velocity = (table_x + table * cos_alpha, table_y + table * sin_alpha);
        (strike.impulse_normal, strike.impulse_tangential, strike.mode) = (normal, tangential, mode);
        strike.contact_rise = rod.contact_rise(&after, tilt.sin_theta);
        strike.energy_gain = N::from_f64(0.5) * (speed_squared - strike.speed_squared);
        strike.after = after;
        strike
    }

    /// The table's velocity along itself where nothing delays it, m/s.
    #[inline(always)]
    pub(crate) fn table_speed(&self, rod: &Rod<N>, before: &State<N>, tilt: &Tilt<N>) -> N {
        match self.slide {
            Slide::None => N::from_f64(0.0),
            Slide::Matched => tangential_velocity(rod, before, tilt),
        }
    }
}

/// Same as [`Strike::rise_rounding`], of a strike with friction. Where the contact sticks, the velocity that is left of it is a difference
/// of terms that are 1 + l²/ρ² times as large.
#[inline(always)]
pub(crate) fn rise_rounding<N: Number>(rod: &Rod<N>, before: &State<N>, strike: &Strike<N>, unit: f64) -> f64 {
    let size = |number: N| number.to_f64().abs();
    let (length, rho) = (rod.contact_distance.to_f64(), rod.radius_of_gyration.to_f64());
    let lever = length / rho;
    let struck = (1.0 + lever * lever) * (size(strike.impulse_normal) + size(strike.impulse_tangential));
    strike.rise_rounding(before.y_dot, unit)
        + RISE_UNITS * unit * (size(before.x_dot) + length * size(before.theta_dot) + struck)
}

/// Velocity of the contact point along the table, m/s.
#[inline(always)]
pub(crate) fn tangential_velocity<N: Arithmetic>(rod: &Rod<N>, before: &State<N>, tilt: &Tilt<N>) -> N {
    let along = rod.contact_distance * tilt.cos_beta();
    tilt.cos_alpha * before.x_dot + tilt.sin_alpha * before.y_dot + along * before.theta_dot
}
