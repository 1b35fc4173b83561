//! State feedback α = −K·(x, θ, ẋ, θ̇) on the return map of the bounce: the linear model of one bounce about the fixed point,
//! the gain that is best for given weights (LQR), and what any gain does to the model.
//!
//! Linear: how far from upright a law holds is asked of runs ([`crate::surveys::stability_map`]). The energy is not fed back here; to first order
//! it moves by itself ([`crate::stability::linear_verdict`]).

pub mod margin;
pub mod riccati;

use crate::bounce::rod::Rod;
use crate::stability::contact_regime::ContactRegime;
use crate::stability::jacobian::{eigenvalues, modulus};
use margin::{StableGainRange, margin};
use nalgebra::{Complex, DMatrix, Matrix3, Matrix4, RowVector4, Vector3, Vector4};

/// Names of the components of the state just before a contact, in the order of A, B and K.
pub const STATE: [&str; 4] = ["x", "theta", "x_dot", "theta_dot"];

/// A spectral radius up to which a loop is called stable: nearer to 1 rounding decides.
pub const STABLE: f64 = 1.0 - 1e-9;

/// Residual of the Riccati equation above which its solution has no digits to be trusted.
pub const RESIDUAL: f64 = 1e-8;

/// One bounce about the fixed point: s ↦ As + Bα, s just before a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BounceModel {
    /// A, in units of [`STATE`].
    pub a: Matrix4<f64>,
    /// B, units of [`STATE`] per rad.
    pub b: Vector4<f64>,
}

/// A law that was designed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LqrDesign {
    /// K, in the order of [`STATE`]; 0 for x where its weight is.
    pub gain: [f64; 4],
    /// How far the solution is off the Riccati equation, as a share of it.
    pub residual: f64,
    /// Doublings it took.
    pub iterations: u32,
}

/// Why there is no law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DesignFailure {
    /// The doubling did not converge.
    Diverging,
    /// It converged to what is off the equation by this share.
    Inaccurate(f64),
    /// It did, and with the law some deviation that no weight sees does not die out: the spectral radius.
    Unseen(f64),
}

/// What a gain does to the model.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoop {
    /// Eigenvalues of A − BK, largest modulus first; without x where K does not feed it back, which then is just carried along.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The largest modulus.
    pub spectral_radius: f64,
    /// Factors on K between which it stays stable; none where it is not.
    pub margin: Option<StableGainRange>,
}

impl ClosedLoop {
    /// Whether every small deviation that is fed back dies out.
    pub fn is_stable(&self) -> bool {
        self.spectral_radius <= STABLE
    }

    /// Bounces in which a small deviation becomes a tenth, in the long run; none where it does not.
    pub fn bounces_per_decade(&self) -> Option<f64> {
        self.is_stable().then(|| std::f64::consts::LN_10 / -libm::log(self.spectral_radius.max(f64::MIN_POSITIVE)))
    }
}

impl BounceModel {
    /// The model of a rod that bounces at `speed` V > 0 (m/s) upright on a table that makes up the loss.
    ///
    /// To first order the normal impulse is 2V, whatever e and the law of restitution; so with friction the contact sticks in the
    /// end, and its impulse P_t along the table brings the contact point's relative velocity ẋ + lθ̇ − Vα to rest. On a table
    /// that slides along ([`ContactRegime::VelocityMatched`]) it is at rest already.
    pub fn new(rod: &Rod, speed: f64, regime: ContactRegime) -> Self {
        let (l, rho_squared) = (rod.contact_distance, rod.radius_of_gyration * rod.radius_of_gyration);
        // Inertia about the contact point, which is what a sticking contact turns the rod about.
        let about_contact = rho_squared + l * l;
        let (light, heavy) = (rho_squared / about_contact, l * l / about_contact);
        let kick = 2.0 * speed;
        // ẋ⁺ and θ̇⁺ by (θ, ẋ, θ̇) and by α.
        let (x_dot, theta_dot) = match regime {
            ContactRegime::Frictionless => {
                let turn = kick * l / rho_squared;
                (([0.0, 1.0, 0.0], -kick), ([turn, 0.0, 1.0], -turn))
            }
            ContactRegime::VelocityMatched => {
                let turn = kick * l / about_contact;
                (([-kick * heavy, 1.0, 0.0], -kick * light), ([turn, 0.0, 1.0], -turn))
            }
            ContactRegime::Sticking => {
                let lever = l / about_contact;
                (([-kick * heavy, heavy, -light * l], -speed * light), ([kick * lever, -lever, light], -speed * lever))
            }
        };
        let flight_time = kick / rod.gravity;
        let velocity = |([theta, x_dot, theta_dot], _): ([f64; 3], f64)| RowVector4::new(0.0, theta, x_dot, theta_dot);
        let (x_row, theta_row) = (velocity(x_dot), velocity(theta_dot));
        let a = Matrix4::from_rows(&[
            RowVector4::new(1.0, 0.0, 0.0, 0.0) + x_row * flight_time,
            RowVector4::new(0.0, 1.0, 0.0, 0.0) + theta_row * flight_time,
            x_row,
            theta_row,
        ]);
        let b = Vector4::new(flight_time * x_dot.1, flight_time * theta_dot.1, x_dot.1, theta_dot.1);
        Self { a, b }
    }

    /// The law α = −K·s with the least sum of sᵀ diag(`state`) s + `input` α² over all bounces.
    ///
    /// Where x has no weight it is left out, and K with it: what does not matter is not to be steered.
    ///
    /// # Errors
    /// [`DesignFailure`].
    pub fn design(&self, state: [f64; 4], input: f64) -> Result<LqrDesign, DesignFailure> {
        let (gain, residual, iterations) = if state[0] == 0.0 {
            let (a, b): (Matrix3<f64>, Vector3<f64>) =
                (self.a.fixed_view::<3, 3>(1, 1).into(), self.b.fixed_rows::<3>(1).into());
            let found = riccati::solve(&a, &b, &Vector3::new(state[1], state[2], state[3]), input);
            let found = found.ok_or(DesignFailure::Diverging)?;
            ([0.0, found.gain[0], found.gain[1], found.gain[2]], found.residual, found.iterations)
        } else {
            let found = riccati::solve(&self.a, &self.b, &state.into(), input).ok_or(DesignFailure::Diverging)?;
            (found.gain.into(), found.residual, found.iterations)
        };
        if residual.is_nan() || residual > RESIDUAL {
            return Err(DesignFailure::Inaccurate(residual));
        }
        let spectral_radius = self.closed_loop(gain, state[0] != 0.0).map_or(f64::NAN, |it| it.spectral_radius);
        if spectral_radius <= STABLE {
            Ok(LqrDesign { gain, residual, iterations })
        } else {
            Err(DesignFailure::Unseen(spectral_radius))
        }
    }

    /// What a gain does, with or without x among the states. None where the eigenvalues do not converge.
    pub fn closed_loop(&self, gain: [f64; 4], with_x: bool) -> Option<ClosedLoop> {
        let first = usize::from(!with_x);
        let part = |matrix: &Matrix4<f64>| -> DMatrix<f64> {
            matrix.view((first, first), (4 - first, 4 - first)).clone_owned()
        };
        let (open, closed) = (part(&self.a), part(&(self.a - self.b * RowVector4::from(gain))));
        let eigenvalues = eigenvalues(&closed)?;
        let spectral_radius = eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max);
        let margin = (spectral_radius <= STABLE).then(|| margin(&open, &closed));
        Some(ClosedLoop { eigenvalues, spectral_radius, margin })
    }
}
