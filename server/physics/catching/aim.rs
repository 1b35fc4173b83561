//! Aim of a strike: the motion of the table that gives a chosen impulse, or a chosen height ratio ẏ_c⁺ = r|ẏ_c|.
//!
//! Without friction the impulse is along the table's normal. With friction the table moves along with the contact point, so that the
//! contact sticks, or slides from rest where friction cannot hold it. Either way P_t = s P_n with one slope s, all laws of restitution
//! agree, and the velocity of the contact point along the normal changes by (B + C s) P_n.

use crate::bounce::friction::{Mobility, tangential_velocity};
use crate::bounce::strike::{PlannedTableMotion, Rod, State, Tilt};
use crate::numbers::number::Number;

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
    /// ẏ_c, m/s.
    contact_speed: N,
    /// ∂ẏ_c⁺/∂P_n.
    lift: N,
}

impl<N: Number> Aim<N> {
    /// A strike on `state` by a table at `alpha` (rad), for the restitution of the rod and the coefficient of friction μ.
    pub fn new(rod: &Rod<N>, friction: f64, state: &State<N>, alpha: N) -> Self {
        let tilt = Tilt::new(state.theta, alpha, state.theta - alpha);
        let cos_beta = tilt.cos_beta();
        let mobility = Mobility::new(rod, tilt.sin_beta, cos_beta);
        let (slope, tangential_velocity) = if friction == 0.0 {
            (N::from_f64(0.0), N::from_f64(0.0))
        } else {
            (slope_from_rest(&mobility, friction), tangential_velocity(rod, state, &tilt))
        };
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
    /// P = (1 + r)|ẏ_c|/(cos α + (l²/ρ²) sin β sin θ) without friction. The sign is that of the denominator: below 0 the table
    /// would have to pull.
    pub fn impulse_for(&self, ratio: N) -> N {
        -((N::from_f64(1.0) + ratio) * self.contact_speed) / self.lift
    }

    /// Motion of the table that gives the normal impulse `impulse` (m/s): w = v_nc + P(B + C s)/(1 + e).
    pub fn motion(&self, impulse: N) -> PlannedTableMotion<N> {
        PlannedTableMotion {
            alpha: self.alpha,
            normal_velocity: self.normal_velocity + impulse * self.resistance,
            tangential_velocity: self.tangential_velocity,
        }
    }
}

/// P_t/P_n of a contact point that is at rest on the table at first: −C/A where it sticks, ∓μ where it slides.
fn slope_from_rest<N: Number>(mobility: &Mobility<N>, friction: f64) -> N {
    let Mobility { tangential, cross, .. } = *mobility;
    let driven = cross.to_f64();
    if driven.abs() <= friction * tangential.to_f64() {
        -cross / tangential
    } else if driven > 0.0 {
        N::from_f64(-friction)
    } else {
        N::from_f64(friction)
    }
}
