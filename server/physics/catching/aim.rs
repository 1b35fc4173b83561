//! Aim of a strike: the tilt by a scheduled gain, and the motion that gives an impulse or height ratio ẏ_c⁺ = r|ẏ_c|.
//!
//! Without friction the impulse is along the table's normal. With friction the table moves along with the contact point, so that the
//! contact sticks, or slides from rest where friction cannot hold it. Either way P_t = s P_n with one slope s, all laws of restitution
//! agree, and the velocity of the contact point along the normal changes by (B + C s) P_n.

use crate::analysis::contact_regime::{ContactRegime, contact_regime};
use crate::control::bounce_model::BounceModel;
use crate::control::lqr::{DesignFailure, design, gain};
use crate::control::riccati::Step;
use crate::map::body::Body;
use crate::map::flight::{AirDrag, Decay};
use crate::map::friction::{Mobility, Slide, tangential_velocity};
use crate::map::strike::{PlannedTableMotion, Rod, State, Tilt};
use crate::map::table::control_law::Gains;
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::lasting_contact::{ContactMotion, TangentialForce};
use nalgebra::{Matrix4, Vector4};

/// A strike of a tilted table that is still free to choose its velocity.
#[derive(Clone, Copy, Debug)]
pub struct Aim<N = f64> {
    alpha: N,
    /// v_nc, m/s.
    normal_velocity: N,
    /// Velocity of the table along itself, m/s.
    tangential_velocity: N,
    /// (B + C s)/(1 + e).
    resistance: N,
    /// ẏ_c before the strike, m/s.
    pub contact_speed: N,
    /// ∂ẏ_c⁺/∂P_n.
    lift: N,
}

impl<N: Number> Aim<N> {
    /// A strike of a body in `state` by a table at `alpha`, rad. A contact that slides on the table is none that [`Self::motion`] holds for.
    pub fn new(body: &Body<N>, state: &State<N>, alpha: N) -> Self {
        let rod = &body.rod;
        let tilt = Tilt::new(state.theta, alpha, state.theta - alpha);
        let mobility = Mobility::new(rod, tilt.sin_beta, tilt.cos_beta());
        let rough = body.rough();
        let nothing = N::from_f64(0.0);
        let slope = rough.map_or(nothing, |friction| mobility.slope_from_rest(friction.coefficient));
        let along = rough.filter(|friction| friction.slide == Slide::Matched);
        let tangential_velocity = along.map_or(nothing, |_| tangential_velocity(rod, state, &tilt));
        let Mobility { tangential: a, normal: b, cross: c } = mobility;
        let one = N::from_f64(1.0);
        let (along_normal, along_table) = (b + c * slope, c + a * slope);
        let arm = rod.contact_distance * tilt.sin_beta;
        Self {
            alpha,
            normal_velocity: tilt.cos_alpha * state.y_dot - tilt.sin_alpha * state.x_dot + arm * state.theta_dot,
            tangential_velocity,
            resistance: along_normal / (one + rod.restitution),
            contact_speed: rod.contact_rise(state, tilt.sin_theta),
            lift: tilt.cos_alpha * along_normal + tilt.sin_alpha * along_table,
        }
    }

    /// P_n of a strike after which the contact point rises at `ratio` times the speed at which it came down, m/s.
    ///
    /// Without friction P = (1 + r)|ẏ_c|/(cos α + (l²/ρ²) sin β sin θ). Below 0 the table would have to pull.
    pub fn impulse_for(&self, ratio: N) -> N {
        -((N::from_f64(1.0) + ratio) * self.contact_speed) / self.lift
    }

    /// Motion of the table that comes towards the contact point at the relative speed `speed` (m/s) along its normal.
    pub fn approaching(&self, speed: N) -> PlannedTableMotion<N> {
        let Self { alpha, tangential_velocity, .. } = *self;
        PlannedTableMotion { alpha, normal_velocity: self.normal_velocity + speed, tangential_velocity }
    }

    /// Motion of the table that gives the normal impulse `impulse` (m/s): w = v_nc + P(B + C s)/(1 + e).
    pub fn motion(&self, impulse: N) -> PlannedTableMotion<N> {
        self.approaching(impulse * self.resistance)
    }
}

/// Law of the tilt at strikes of one height ratio r, α = −K(v)·(x, θ, ẋ, θ̇).
///
/// K(v) is that of the linear-quadratic regulator on the bounce model at contact speed v, with impulse (1 + r)v. Weights scaled by the flight
/// time τ make the sum over the bounces an integral over time as v → 0, and do not change K. In that limit, where τ = 2rv/G, the
/// strikes push with (1 + r)v/τ = (1 + r)G/(2r) on average, and K(v) tends to [`contact_gain`] under this push: at r = 1 to that of
/// a contact at rest. Below, bounces push harder than the weight because they also slow the body down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainSchedule {
    /// The body.
    pub body: Body,
    /// r.
    pub ratio: f64,
    /// Weights on (x, θ, ẋ, θ̇).
    pub state_weights: [f64; 4],
    /// Weight on α.
    pub input_weight: f64,
}

impl GainSchedule {
    /// K at a contact speed `speed` > 0, m/s.
    pub fn gain(&self, speed: f64) -> Result<Gains, DesignFailure> {
        let model = BounceModel::rising(&self.body, speed, self.ratio);
        Ok(gains(gain(&model, self.state_weights, self.input_weight)?.gain))
    }
}

/// K of a table that tilts in lasting contact and pushes with `push` (m/s²): the regulator of the motion about upright, without air
/// ẍ = −push·α, θ̈ = push·(l/ρ²)(θ − α). At push G the contact rests; at G + a the table brakes at a. A contact that sticks to a table that
/// moves along with it turns about the contact point, with ρ² + l² in place of ρ².
pub fn contact_gain(
    body: &Body,
    push: f64,
    state_weights: [f64; 4],
    input_weight: f64,
) -> Result<Gains, DesignFailure> {
    let sticks = contact_regime(body) != ContactRegime::Frictionless;
    let (a, b) = contact_model(body, push, |rod, theta, alpha| {
        let (sin_beta, cos_beta) = (theta - alpha).sincos();
        let mobility = Mobility::new(rod, sin_beta, cos_beta);
        let share = if sticks { -(mobility.cross / mobility.tangential) } else { Dual::from_f64(0.0) };
        (alpha, TangentialForce::Sliding(share))
    });
    Ok(gains(design(Step::Time, &a, &b, state_weights, input_weight)?.gain))
}

/// K of a level table whose surface accelerates along x by a = −K·(x, θ, ẋ, θ̇), m/s², under a contact that sticks: without air
/// (l² + ρ²)θ̈ = l(push·θ + a), ẍ = a − lθ̈. A table tilted by α that moves along with the contact does the same with a = −push·α.
pub fn cart_pole_gain(
    body: &Body,
    push: f64,
    state_weights: [f64; 4],
    input_weight: f64,
) -> Result<Gains, DesignFailure> {
    let (a, b) = contact_model(body, push, |_, _, alpha| {
        (Dual::from_f64(0.0), TangentialForce::Sticking(-(Dual::from_f64(push) * alpha)))
    });
    let tilt = design(Step::Time, &a, &b, state_weights, input_weight)?.gain;
    Ok(gains(tilt.map(|gain| -(push * gain))))
}

/// A and B of ṡ = As + Bα about upright in contact with a table that pushes with `push` (m/s²), whose tilt and force follow from the rod, θ
/// and α.
fn contact_model(
    body: &Body,
    push: f64,
    table: impl Fn(&Rod<Dual<5>>, Dual<5>, Dual<5>) -> (Dual<5>, TangentialForce<Dual<5>>),
) -> (Matrix4<f64>, Vector4<f64>) {
    let [_, theta, x_dot, theta_dot, alpha] = std::array::from_fn(|index| Dual::along(0.0, index, 1.0));
    let rod = body.rod.lift();
    let (tilt, force) = table(&rod, theta, alpha);
    let fall = Dual::from_f64(0.0);
    let air = body.drag.map(|air| air.map(Dual::from_f64).taken([x_dot, fall, theta_dot]));
    let motion = ContactMotion::new(&rod, Dual::from_f64(push), [theta, theta_dot, tilt], force, air);
    let rows = [x_dot, theta_dot, motion.x_ddot, motion.theta_ddot].map(|row| row.partials);
    (Matrix4::from_fn(|row, column| rows[row][column]), Vector4::from_fn(|row, _| rows[row][4]))
}

fn gains([x, theta, x_dot, theta_dot]: [f64; 4]) -> Gains {
    Gains { x, theta, x_dot, theta_dot }
}

/// Most steps of the search for a flight through air; each doubles the digits.
const MOST_FLIGHT_STEPS: u32 = 40;

/// ẏ, m/s, at the beginning of a flight that ends `above` its beginning (m) at `y_dot`, m/s, and its time, s.
pub(super) fn rise_before(body: &Body, above: f64, y_dot: f64) -> (f64, f64) {
    let gravity = body.rod.gravity;
    let rise = (y_dot * y_dot + 2.0 * gravity * above).max(0.0).sqrt();
    let (mut found, mut t) = (rise, (rise - y_dot) / gravity);
    let Some(AirDrag { linear, .. }) = body.drag.filter(|drag| drag.linear != 0.0) else { return (found, t) };
    let number = Dual::<1>::from_f64;
    for _ in 0..MOST_FLIGHT_STEPS {
        // ẏ = U·e^(−ct) − Gs and y = Us − Gr at the end.
        let Decay { left, way, fall } = Decay::new(number(linear), Dual::along(t, 0, 1.0));
        let rise = (number(y_dot) + number(gravity) * way) / left;
        let missed = rise * way - number(gravity) * fall - number(above);
        let step = missed.value / missed.partials[0];
        (found, t) = (rise.value, t - step);
        if step.abs() <= f64::EPSILON * t {
            break;
        }
    }
    (found, t)
}
