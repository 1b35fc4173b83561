//! State feedback α = −K·(x, θ, ẋ, θ̇) on the return map of the bounce: the linear model of one bounce about the fixed point,
//! the gain that is best for given weights (LQR), and what any gain does to the model.
//!
//! Linear: how far from upright a law holds is asked of runs ([`crate::region`]). The energy is not fed back here; to first order
//! it moves by itself ([`crate::stability`]).

pub mod margin;
pub mod riccati;

use crate::grip::Grip;
use crate::impact::Rod;
use crate::jacobian::{eigenvalues, modulus};
use crate::loss::{End, Settles};
use crate::map::Ending;
use crate::rig::{Gains, Steering};
use crate::scene::{BodyShape, Scene};
use crate::stability::{FixedPoint, Nonlinear};
use crate::verdict::{DecidedBy, HigherOrder, Judgement, Verdict};
use margin::{Margin, margin};
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
pub struct Design {
    /// K, in the order of [`STATE`]; 0 for x where its weight is.
    pub gain: [f64; 4],
    /// How far the solution is off the Riccati equation, as a share of it.
    pub residual: f64,
    /// Doublings it took.
    pub iterations: u32,
}

/// Why there is no law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoDesign {
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
    pub margin: Option<Margin>,
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

impl Scene {
    /// K, where the table feeds the state back, in the order of [`STATE`].
    pub fn feedback(&self) -> Option<[f64; 4]> {
        match self.steering {
            Steering::TiltGain => None,
            Steering::Feedback(Gains { x, theta, x_dot, theta_dot }) => Some([x, theta, x_dot, theta_dot]),
        }
    }

    /// The upright bounce in place that a law with feedback comes to: where the strike neither takes energy nor gives any, on the
    /// energy of the release where that holds at any height. No drift is left, which is what sets it apart from that of a
    /// proportional tilt. Friction takes the energy of sideways motion and spin.
    ///
    /// # Errors
    /// Why there is none, in a sentence.
    pub fn bounce_in_place(&self) -> Result<FixedPoint, String> {
        if self.body() == BodyShape::Point {
            return Err("a point mass has no angle to feed back".to_owned());
        }
        let rod: Rod = self.parameters();
        let weight = rod.gravity * rod.contact_distance;
        let speed_squared = if rod.strike_gain_per_energy != 0.0 {
            2.0 * (rod.target_energy + (rod.strike_gain - 2.0) / rod.strike_gain_per_energy - weight)
        } else if rod.strike_gain != 2.0 {
            return Err(format!(
                "the table gives back {} of a bounce's normal speed and nothing steers its height, so no bounce repeats",
                rod.strike_gain - 1.0
            ));
        } else {
            let start = self.start();
            let spin = rod.radius_of_gyration * start.theta_dot;
            let mut kinetic = start.y_dot * start.y_dot;
            if self.grip() == Grip::Smooth {
                kinetic += start.x_dot * start.x_dot + spin * spin;
            }
            kinetic + 2.0 * (rod.gravity * self.release().height - weight)
        };
        if !speed_squared.is_finite() || speed_squared <= 0.0 {
            return Err(format!("the square of its speed would be {speed_squared} m²/s²: there is no upright bounce"));
        }
        let speed = speed_squared.sqrt();
        Ok(FixedPoint {
            speed,
            flight_time: 2.0 * speed / rod.gravity,
            apex_height: rod.contact_distance + speed_squared / (2.0 * rod.gravity),
        })
    }
}

impl Scene {
    /// What the state feedback of the scene does near a bounce in place; none where it has none.
    pub fn steered(&self, fixed_point: &FixedPoint) -> Option<ClosedLoop> {
        let gain = self.feedback()?;
        let model = BounceModel::new(&self.parameters(), fixed_point.speed, self.grip());
        model.closed_loop(gain, gain[0] != 0.0)
    }

    /// Whether a law with feedback is stable in place, by its closed loop, its normal form and a run.
    pub(crate) fn judge_law(&self, closed: &ClosedLoop, higher: &HigherOrder, run: &Nonlinear) -> Judgement {
        let survived = run.ending == Ending::Completed;
        let (stable, radius) = (closed.is_stable(), closed.spectral_radius);
        let fell = format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts);
        let what = if closed.eigenvalues.len() == STATE.len() {
            "x, theta, x_dot and theta_dot"
        } else {
            "theta, x_dot and theta_dot"
        };
        let (verdict, decided_by, reason) = match (stable, survived) {
            (true, true) => (
                Verdict::StableInPlace,
                DecidedBy::Linear,
                format!("every small deviation of {what} dies out: the closed loop has spectral radius {radius}"),
            ),
            (true, false) => (
                Verdict::Unstable,
                DecidedBy::Nonlinear,
                format!(
                    "{fell}, although the closed loop has spectral radius {radius}: the start is outside the basin"
                ),
            ),
            (false, _) => {
                let grows = format!(
                    "a small deviation does not die out: the closed loop has spectral radius {radius}, which must be below 1"
                );
                match (higher.settled_beyond(End::FeedbackFactor), survived) {
                    (Some((loss, Settles::Swing(swing))), true) => (
                        Verdict::BoundedBeyondBoundary,
                        DecidedBy::Boundary,
                        format!(
                            "{grows}; but stability is lost softly, at {} times these gains ({}), so that a swing grows to about \
                             {swing} rad and no further; this run came to {} rad",
                            loss.value,
                            loss.bifurcation.name(),
                            run.max_theta
                        ),
                    ),
                    (_, true) => (Verdict::Unstable, DecidedBy::Linear, format!("{grows}; this run has not left yet")),
                    (_, false) => (Verdict::Unstable, DecidedBy::Linear, format!("{grows}; {fell}")),
                }
            }
        };
        Judgement { verdict, decided_by, agree: stable == survived, reason }
    }
}

impl BounceModel {
    /// The model of a rod that bounces at `speed` V > 0 (m/s) upright on a table that makes up the loss.
    ///
    /// To first order the normal impulse is 2V, whatever e and the law of restitution; so with friction the contact sticks in the
    /// end, and its impulse P_t along the table brings the contact point's relative velocity ẋ + lθ̇ − Vα to rest. On a table
    /// that slides along ([`Grip::Matched`]) it is at rest already.
    pub fn new(rod: &Rod, speed: f64, grip: Grip) -> Self {
        let (l, rho_squared) = (rod.contact_distance, rod.radius_of_gyration * rod.radius_of_gyration);
        // Inertia about the contact point, which is what a sticking contact turns the rod about.
        let about_contact = rho_squared + l * l;
        let (light, heavy) = (rho_squared / about_contact, l * l / about_contact);
        let kick = 2.0 * speed;
        // ẋ⁺ and θ̇⁺ by (θ, ẋ, θ̇) and by α.
        let (x_dot, theta_dot) = match grip {
            Grip::Smooth => {
                let turn = kick * l / rho_squared;
                (([0.0, 1.0, 0.0], -kick), ([turn, 0.0, 1.0], -turn))
            }
            Grip::Matched => {
                let turn = kick * l / about_contact;
                (([-kick * heavy, 1.0, 0.0], -kick * light), ([turn, 0.0, 1.0], -turn))
            }
            Grip::Held => {
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
    /// [`NoDesign`].
    pub fn design(&self, state: [f64; 4], input: f64) -> Result<Design, NoDesign> {
        let (gain, residual, iterations) = if state[0] == 0.0 {
            let (a, b): (Matrix3<f64>, Vector3<f64>) =
                (self.a.fixed_view::<3, 3>(1, 1).into(), self.b.fixed_rows::<3>(1).into());
            let found = riccati::solve(&a, &b, &Vector3::new(state[1], state[2], state[3]), input);
            let found = found.ok_or(NoDesign::Diverging)?;
            ([0.0, found.gain[0], found.gain[1], found.gain[2]], found.residual, found.iterations)
        } else {
            let found = riccati::solve(&self.a, &self.b, &state.into(), input).ok_or(NoDesign::Diverging)?;
            (found.gain.into(), found.residual, found.iterations)
        };
        if residual.is_nan() || residual > RESIDUAL {
            return Err(NoDesign::Inaccurate(residual));
        }
        let spectral_radius = self.closed_loop(gain, state[0] != 0.0).map_or(f64::NAN, |it| it.spectral_radius);
        if spectral_radius <= STABLE {
            Ok(Design { gain, residual, iterations })
        } else {
            Err(NoDesign::Unseen(spectral_radius))
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
