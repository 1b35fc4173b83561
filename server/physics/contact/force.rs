//! The force of the table on a body whose contact point stays at the table's height, in any kind of number.
//!
//! With the force N n + F t at the contact point, unit mass, β = θ − α and the mobilities A, B, C of
//! [`crate::bounce::friction`], the contact point accelerates by A F + C N along the table and C F + B N along its normal, beside
//! gravity and lθ̇². It stays at the table's height if the vertical part vanishes:
//!
//! (cos α + (l²/ρ²) sin β sin θ) N + (sin α + (l²/ρ²) cos β sin θ) F = G − lθ̇² cos θ.
//!
//! A table that accelerates upwards at a has G + a in place of G.

use crate::bounce::strike::Rod;
use crate::numbers::number::Number;

/// Decides the force along the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TangentialForce<N = f64> {
    /// F = φN with this φ: sliding, or no friction at all.
    Sliding(N),
    /// The contact point does not accelerate along x but by this, m/s², as the table's surface does.
    Sticking(N),
}

/// The force of the table per unit mass, m/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce<N = f64> {
    /// N, along the table's normal.
    pub normal: N,
    /// F, along the table.
    pub tangential: N,
}

/// Accelerations of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMotion<N = f64> {
    /// The force that causes them.
    pub force: ContactForce<N>,
    /// ẍ of the centre of gravity, m/s².
    pub x_ddot: N,
    /// θ̈, rad/s².
    pub theta_ddot: N,
}

impl<N: Number> ContactMotion<N> {
    /// The motion at angle θ, angular velocity and tilt α on a table with this force, under `gravity` G + a.
    ///
    /// The normal force may come out negative: then no table keeps the contact.
    pub fn new(rod: &Rod<N>, gravity: N, [theta, theta_dot, alpha]: [N; 3], force: TangentialForce<N>) -> Self {
        let (sin_theta, cos_theta) = theta.sincos();
        let (sin_alpha, cos_alpha) = alpha.sincos();
        let (sin_beta, cos_beta) = (theta - alpha).sincos();
        let l = rod.contact_distance;
        let leverage = l / (rod.radius_of_gyration * rod.radius_of_gyration);
        let spin = l * theta_dot * theta_dot;
        let load = gravity - spin * cos_theta;
        let force = match force {
            TangentialForce::Sliding(share) => {
                let by_normal = cos_alpha + l * leverage * sin_beta * sin_theta;
                let by_tangential = sin_alpha + l * leverage * cos_beta * sin_theta;
                let normal = load / (by_normal + share * by_tangential);
                ContactForce { normal, tangential: share * normal }
            }
            TangentialForce::Sticking(acceleration) => {
                // The force in x and y: (1 + l² cos²θ/ρ²)X + (l² sin θ cos θ/ρ²)Y = a + lθ̇² sin θ and likewise along y. The determinant
                // is 1 + l²/ρ².
                let along = acceleration + spin * sin_theta;
                let (xx, yy) = (l * leverage * cos_theta * cos_theta, l * leverage * sin_theta * sin_theta);
                let xy = l * leverage * sin_theta * cos_theta;
                let one = N::from_f64(1.0);
                let determinant = one + l * leverage;
                let x = ((one + yy) * along - xy * load) / determinant;
                let y = ((one + xx) * load - xy * along) / determinant;
                ContactForce { normal: cos_alpha * y - sin_alpha * x, tangential: cos_alpha * x + sin_alpha * y }
            }
        };
        let ContactForce { normal, tangential } = force;
        Self {
            force,
            x_ddot: cos_alpha * tangential - sin_alpha * normal,
            theta_ddot: leverage * (sin_beta * normal + cos_beta * tangential),
        }
    }
}
