//! What friction makes of the bounce near upright: where the contact sticks, how the rod then turns, and the eigenvalues of a
//! table that only tilts.
//!
//! Not here: the impulse itself ([`crate::bounce::friction`]), and what is concluded ([`crate::stability::linear_verdict`], [`crate::stability::verdict`]).

use crate::bounce::friction::Slide;
use crate::scene::{BodyShape, Scene};
use nalgebra::Complex;

/// What the contact does at the fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// It has no friction.
    Smooth,
    /// It sticks to a table that moves along with it.
    Matched,
    /// It sticks to a table that only tilts: v_t = 0 is inside the stick cone for any μ > 0.
    Held,
}

impl Scene {
    /// What the contact does at the fixed point.
    pub fn grip(&self) -> Grip {
        match (self.friction == 0.0, self.slide) {
            (true, _) => Grip::Smooth,
            (false, Slide::Matched) => Grip::Matched,
            (false, Slide::None) => Grip::Held,
        }
    }

    /// The square of the radius, m², that says how hard the rod is to turn by a strike: ρ² about its centre of gravity, or
    /// ρ² + l² about a contact that sticks.
    pub(crate) fn turning_radius_squared(&self, contact_distance: f64, radius_of_gyration: f64) -> f64 {
        let own = radius_of_gyration * radius_of_gyration;
        if self.grip() == Grip::Smooth { own } else { own + contact_distance * contact_distance }
    }

    /// |θ|, rad, up to which a matched contact sticks, for small angles: μ(ρ² + l²)/(l²|κ − 1|), from |C| ≤ μA. None where it
    /// sticks at every small angle, and for contacts that are not matched.
    pub fn stick_cone(&self) -> Option<f64> {
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else { return None };
        let turning = self.turning_radius_squared(contact_distance, radius_of_gyration);
        let excess = (self.tilt_gain - 1.0).abs();
        (self.grip() == Grip::Matched && excess > 0.0)
            .then(|| self.friction * turning / (contact_distance * contact_distance * excess))
    }

    /// What |v|² + 2Gy lacks, m²/s², of a quantity that a matched table keeps to second order about a bounce with the drift
    /// speed `drift`: 2lcθ̇ + κ(ρ² + l²)θ̇²/(κ − 1).
    ///
    /// Such a table works on the rod by P_t v_t = lsθ(ẋ − Vκθ + lθ̇) a strike, where s = 2Vl(κ − 1)/(ρ² + l²) and θ̇⁺ = θ̇ − sθ.
    /// With ẋ = c + (κρ² + l²)θ̇/((κ − 1)l) that is lc(θ̇ − θ̇⁺) + (lVκ/s)(θ̇² − θ̇⁺²): what it gives it takes back.
    pub(crate) fn lent(&self, drift: f64) -> f64 {
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else { return 0.0 };
        let excess = self.tilt_gain - 1.0;
        if self.grip() != Grip::Matched || excess == 0.0 {
            return 0.0;
        }
        let spin = self.start().theta_dot;
        let turning = self.turning_radius_squared(contact_distance, radius_of_gyration);
        2.0 * contact_distance * drift * spin + self.tilt_gain * turning * spin * spin / excess
    }

    /// −4lV²/(G(l² + ρ²)): the characteristic polynomial, at 1, of the derivative at the fixed point of speed V (m/s) where the
    /// contact is [`Grip::Held`]. It is negative, so an eigenvalue is beyond 1.
    pub fn held_polynomial_at_one(&self, speed: f64) -> f64 {
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else { return 0.0 };
        let turning = self.turning_radius_squared(contact_distance, radius_of_gyration);
        -4.0 * contact_distance * speed * speed / (self.gravity * turning)
    }

    /// The eigenvalues of θ, ẋ and θ̇ there: 0, since the contact's velocity along the table is always taken away, and
    /// λ = 1 + m ± √(m² + 2ν) with ν = 2lV²/(G(l² + ρ²)), m = ν(2 − κ)/2.
    pub(crate) fn held_eigenvalues(&self, speed: f64) -> [Complex<f64>; 3] {
        let nu = -0.5 * self.held_polynomial_at_one(speed);
        let mean = 0.5 * nu * (2.0 - self.tilt_gain);
        let root = (mean * mean + 2.0 * nu).sqrt();
        // Their product is −2ν; the smaller one by it, without cancellation.
        let large = if mean < 0.0 { mean - root } else { mean + root };
        [1.0 + large, 1.0 - 2.0 * nu / large, 0.0].map(|value| Complex::new(value, 0.0))
    }
}
