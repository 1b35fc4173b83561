//! The linear model of one bounce about the fixed point, and the closed loop of a gain on it.

use crate::analysis::contact_regime::ContactRegime;
use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::analysis::upright_in_air::UprightInAir;
use crate::control::margin::{StableGainRange, stable_gain_range};
use crate::map::flight::Decay;
use crate::map::strike::Rod;
use nalgebra::{Complex, DMatrix, Matrix4, RowVector4, Vector4};

/// Names of the components of the state just before a contact, in the order of A, B and K.
pub const STATE: [&str; 4] = ["x", "theta", "x_dot", "theta_dot"];

/// Indices of all of [`STATE`].
const ALL: [usize; 4] = [0, 1, 2, 3];

/// Indices of θ and θ̇ in [`STATE`].
pub(crate) const ANGLE: [usize; 2] = [1, 3];

/// Largest spectral radius of a stable loop. Nearer to 1, rounding would decide.
pub const STABLE: f64 = 1.0 - 1e-9;

/// One bounce about the fixed point: s ↦ As + Bα, s just before a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BounceModel {
    /// A, in units of [`STATE`].
    pub a: Matrix4<f64>,
    /// B, units of [`STATE`] per rad.
    pub b: Vector4<f64>,
    /// Change per speed of the table along itself, units of [`STATE`] per m/s; 0 without friction.
    by_table: Vector4<f64>,
    /// Change per −α̇ of a table that turns as it strikes, units of [`STATE`] per rad/s.
    dragged: Vector4<f64>,
}

/// The closed loop of a gain on a model.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoop {
    /// Eigenvalues of A − BK, largest modulus first; without those of x and of the drift if K does not feed
    /// them back.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The largest modulus.
    pub spectral_radius: f64,
    /// Range of factors on K that keep the loop stable; `None` if it is unstable, and where the table drags the contact as it turns.
    pub margin: Option<StableGainRange>,
}

impl ClosedLoop {
    /// Tells whether every small deviation that is fed back dies out.
    pub fn is_stable(&self) -> bool {
        self.spectral_radius <= STABLE
    }

    /// Bounces in which a small deviation shrinks to a tenth, in the long run; `None` for an unstable loop.
    pub fn bounces_per_decade(&self) -> Option<f64> {
        self.is_stable().then(|| std::f64::consts::LN_10 / -libm::log(self.spectral_radius.max(f64::MIN_POSITIVE)))
    }
}

impl BounceModel {
    /// The model of a rod that bounces upright at `speed` V > 0 (m/s) on a table that makes up the loss.
    pub fn new(rod: &Rod, speed: f64, regime: ContactRegime) -> Self {
        Self::with_ratio(rod, speed, 1.0, regime)
    }

    /// The model of one bounce that comes down at `speed` v > 0 (m/s) and rises at `ratio` r times v: flight time 2rv/G.
    ///
    /// To first order the normal impulse is (1 + r)v for every e and every law of restitution. With friction the contact therefore ends
    /// in sticking: the impulse P_t along the table takes the relative velocity ẋ + lθ̇ − vα of the contact point to 0. On a table that
    /// moves along with it ([`ContactRegime::VelocityMatched`]) this velocity is 0 already.
    pub fn with_ratio(rod: &Rod, speed: f64, ratio: f64, regime: ContactRegime) -> Self {
        let way = 2.0 * ratio * speed / rod.gravity;
        let flown = Decay { left: 1.0, way, fall: 0.5 * way * way };
        Self::with_flight(rod, speed, ratio, regime, (flown, flown))
    }

    /// The model of an upright bounce through air.
    pub fn in_air(rod: &Rod, bounce: &UprightInAir, regime: ContactRegime) -> Self {
        Self::with_flight(rod, bounce.speed, bounce.rise / bounce.speed, regime, (bounce.place, bounce.turn))
    }

    /// The model of a bounce in whose flight the velocities of place and rotation decay like this.
    fn with_flight(
        rod: &Rod,
        speed: f64,
        ratio: f64,
        regime: ContactRegime,
        (place, turning): (Decay<f64>, Decay<f64>),
    ) -> Self {
        let (l, rho_squared) = (rod.contact_distance, rod.radius_of_gyration * rod.radius_of_gyration);
        // A sticking contact turns the rod about the contact point.
        let about_contact = rho_squared + l * l;
        let (light, heavy) = (rho_squared / about_contact, l * l / about_contact);
        let kick = (1.0 + ratio) * speed;
        // Derivatives of ẋ⁺ and θ̇⁺ by (θ, ẋ, θ̇) and by α.
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
                let tilted = kick - speed;
                (
                    ([-kick * heavy, heavy, -light * l], -tilted * light),
                    ([kick * lever, -lever, light], -tilted * lever),
                )
            }
        };
        let velocity = |([theta, x_dot, theta_dot], _): ([f64; 3], f64)| RowVector4::new(0.0, theta, x_dot, theta_dot);
        let (x_row, theta_row) = (velocity(x_dot), velocity(theta_dot));
        let a = Matrix4::from_rows(&[
            RowVector4::new(1.0, 0.0, 0.0, 0.0) + x_row * place.way,
            RowVector4::new(0.0, 1.0, 0.0, 0.0) + theta_row * turning.way,
            x_row * place.left,
            theta_row * turning.left,
        ]);
        let b = Vector4::new(
            place.way * x_dot.1,
            turning.way * theta_dot.1,
            place.left * x_dot.1,
            turning.left * theta_dot.1,
        );
        let by_drag = match regime {
            ContactRegime::Frictionless => [0.0, 0.0],
            ContactRegime::VelocityMatched | ContactRegime::Sticking => [light, l / about_contact],
        };
        let by_table = Vector4::new(
            place.way * by_drag[0],
            turning.way * by_drag[1],
            place.left * by_drag[0],
            turning.left * by_drag[1],
        );
        Self { a, b, by_table, dragged: Vector4::zeros() }
    }

    /// The same bounce on a table that turns about a pivot at a depth p (m) as it strikes, and drags a contact with friction along: a surface
    /// that moves at −α̇p along itself gives the contact −pρ²α̇/(ρ² + l²) more of P_t, with α̇ = −(K_xẋ + K_θθ̇).
    #[must_use]
    pub fn turning(self, depth: f64) -> Self {
        Self { dragged: self.by_table * depth, ..self }
    }

    /// The closed loop of a gain, with or without x among the states. `None` if the eigenvalues do not converge.
    pub fn closed_loop(&self, gain: [f64; 4], with_x: bool) -> Option<ClosedLoop> {
        self.closed_loop_of(gain, if with_x { &ALL } else { &ALL[1..] })
    }

    /// The states that a gain feeds back or that act on those, as indices of [`STATE`]. A place that is not fed back is left out, and so
    /// is a drift: if neither x nor ẋ is fed back and no friction takes ẋ away, both stay as they are.
    pub fn fed_back(&self, gain: [f64; 4]) -> &'static [usize] {
        let drifts = gain[2] == 0.0 && self.a[(1, 2)] == 0.0 && self.a[(3, 2)] == 0.0;
        match (gain[0] != 0.0, drifts) {
            (true, _) => &ALL,
            (false, false) => &ALL[1..],
            (false, true) => &ANGLE,
        }
    }

    /// A, or A − BK with a gain, for some of the states.
    pub fn part(&self, gain: [f64; 4], states: &[usize]) -> DMatrix<f64> {
        let mut matrix = self.a - self.b * RowVector4::from(gain);
        if self.dragged != Vector4::zeros() {
            matrix += self.dragged * RowVector4::new(0.0, 0.0, gain[0], gain[1]);
        }
        DMatrix::from_fn(states.len(), states.len(), |row, column| matrix[(states[row], states[column])])
    }

    /// The closed loop of a gain over some of the states. `None` if the eigenvalues do not converge.
    pub fn closed_loop_of(&self, gain: [f64; 4], states: &[usize]) -> Option<ClosedLoop> {
        let (open, closed) = (self.part([0.0; 4], states), self.part(gain, states));
        let eigenvalues = eigenvalues(&closed)?;
        let spectral_radius = eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max);
        // The range is derived for one input, and a turning table is a second one.
        let margin =
            (spectral_radius <= STABLE && self.dragged == Vector4::zeros()).then(|| stable_gain_range(&open, &closed));
        Some(ClosedLoop { eigenvalues, spectral_radius, margin })
    }
}
