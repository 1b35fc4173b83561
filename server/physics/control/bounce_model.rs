//! The linear model of one bounce of any body about an upright bounce, from its map by dual numbers, and the closed loop of a gain on it.

use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::gain_range::{ByGain, StableGains};
use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::analysis::small_deviations::SmallDeviations;
use crate::map::body::{Body, PreImpact};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::map::table::control_law::{Gains, Steering};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::scene::Scene;
use nalgebra::{Complex, DMatrix, Matrix4, RowVector4, Vector4};

/// Names of the components of the state just before a contact, in the order of A, B and K.
pub const STATE: [&str; 4] = ["x", "theta", "x_dot", "theta_dot"];

const ALL: [usize; 4] = [0, 1, 2, 3];

/// Indices of θ and θ̇ in [`STATE`].
pub(crate) const ANGLE: [usize; 2] = [1, 3];

/// All of [`STATE`], or all but x.
pub fn states(with_x: bool) -> &'static [usize] {
    if with_x { &ALL } else { &ALL[1..] }
}

/// Largest spectral radius of a stable loop. Nearer to 1, rounding would decide.
pub const STABLE: f64 = 1.0 - 1e-9;

/// Rows and directions of the derivative of a bounce: those of [`STATE`], ẏ, and the tilt.
const DIRECTIONS: usize = 6;
const FALL: usize = 4;
const TILT: usize = 5;

/// One bounce about an upright one: s ↦ As + Bα, s just before a contact.
///
/// The height moves apart from s to first order, since the upright bounce is its own mirror image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BounceModel {
    /// A, in units of [`STATE`]: over a table that stays level.
    pub a: Matrix4<f64>,
    /// B, units of [`STATE`] per rad.
    pub b: Vector4<f64>,
    /// ∂ẏ⁺/∂ẏ of a table that does not tilt.
    pub height: f64,
    /// −α of each gain of 1, as a row: the unit matrix for a table that tilts by what its law says of the state at the strike.
    pub sensed: Matrix4<f64>,
    /// Change of s⁺ by each gain of 1 beside that by its tilt: by the turning of the table, if it turns as it strikes.
    pub dragged: Option<[Matrix4<f64>; 4]>,
}

/// The closed loop of a gain on a model.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoop {
    /// Eigenvalues of the loop, largest modulus first; without those of x and of the drift if K does not feed them back.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The largest modulus.
    pub spectral_radius: f64,
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

type Derivative = [[f64; DIRECTIONS]; DIRECTIONS];

/// The bounce of a body after a flight of `flown` s, by the law with these gains; `None` if no contact follows.
fn differentiated(body: &Body, at: &PreImpact, flown: f64, gains: [f64; 4]) -> Option<Derivative> {
    type N = Dual<DIRECTIONS>;
    let [x, theta, x_dot, theta_dot] = gains;
    let steering = Steering::Feedback(Gains { x, theta, x_dot, theta_dot });
    let table = Body { steering, noise: None, outline: None, constant_tilt: 0.0, ..*body };
    // Level at the bounce, wherever that is.
    let plan = table.late_motion(at.n, at.x, &at.state, 0.0, flown);
    let off = table.strike(&PreImpact { plan, ..PreImpact::at(at.n, at.x, at.state) }).alpha;
    let lifted: Body<N> = Body { constant_tilt: N::along(-off, TILT, 1.0), ..table.map(N::from_f64) };
    let State { theta, x_dot, y_dot, theta_dot } = at.state;
    let along = |value, direction| N::along(value, direction, 1.0);
    let (theta, x_dot, theta_dot) = (along(theta, 1), along(x_dot, 2), along(theta_dot, 3));
    let state = State { theta, x_dot, y_dot: along(y_dot, FALL), theta_dot };
    let x = along(at.x, 0);
    let plan = lifted.late_motion(at.n, x, &state, N::from_f64(0.0), N::from_f64(flown));
    let coming = PreImpact { plan, ..PreImpact::at(at.n, x, state) };
    let strike = lifted.strike(&coming);
    let arrival = (strike.contact_rise.value > 0.0).then(|| lifted.fly(&coming, &strike).ok())??;
    let State { theta, x_dot, y_dot, theta_dot } = arrival.state;
    Some([x + arrival.way, theta, x_dot, theta_dot, y_dot, strike.alpha].map(|number| number.partials))
}

impl BounceModel {
    /// The upright bounce of a body from `at` on, under another law, flights of `flown` s; NaN if no contact follows.
    pub fn of(body: &Body, at: &PreImpact, flown: f64) -> Self {
        let level = differentiated(body, at, flown, [0.0; 4]).unwrap_or([[f64::NAN; DIRECTIONS]; DIRECTIONS]);
        let square = |found: &Derivative| Matrix4::from_fn(|row, column| found[row][column]);
        let a = square(&level);
        let b = Vector4::from_fn(|row, _| level[row][TILT]);
        let (mut sensed, mut dragged) = (Matrix4::identity(), [Matrix4::zeros(); 4]);
        for (index, dragged) in dragged.iter_mut().enumerate() {
            let mut gains = [0.0; 4];
            gains[index] = 1.0;
            let Some(found) = differentiated(body, at, flown, gains) else { continue };
            let tilt = RowVector4::from_fn(|_, column| found[TILT][column]);
            *dragged = square(&found) - a - b * tilt;
            sensed.set_row(index, &-tilt);
        }
        Self { a, b, height: level[FALL][FALL], sensed, dragged: body.turning.map(|_| dragged) }
    }

    /// The model about the bounce that repeats in a scene, by gains that its table is told.
    pub fn about(scene: &Scene, small: &SmallDeviations) -> Self {
        let FixedPoint { x, flight_time, .. } = small.fixed_point;
        Self::of(&scene.model(), &PreImpact::at(1, x, small.state()), flight_time).told(scene.tilt_factor())
    }

    /// The model of the upright bounce of a body that comes down at `speed` v > 0 (m/s) and rises at `ratio` times v, on a table that senses
    /// the state at the strike.
    pub fn rising(body: &Body, speed: f64, ratio: f64) -> Self {
        let rod = Rod {
            strike_gain: 1.0 + ratio,
            strike_gain_per_energy: 0.0,
            energy_feedback: EnergyFeedback::Vertical,
            ..body.rod
        };
        let upright = State { theta: 0.0, x_dot: 0.0, y_dot: -speed, theta_dot: 0.0 };
        let body = Body { rod, program: None, lag: 0.0, ..*body };
        Self::of(&body, &PreImpact::at(1, 0.0, upright), f64::INFINITY)
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

    /// The same by gains that are told to a table, which tilts by `factor` times its law.
    #[must_use]
    pub fn told(self, factor: f64) -> Self {
        let dragged = self.dragged.map(|parts| parts.map(|part| part * factor));
        Self { sensed: self.sensed * factor, dragged, ..self }
    }

    /// Effect of a gain beside its tilt.
    pub(crate) fn dragged_by(&self, gain: [f64; 4]) -> Matrix4<f64> {
        let parts = self.dragged.iter().flatten().zip(gain);
        parts.fold(Matrix4::zeros(), |sum, (part, gain)| sum + part * gain)
    }

    /// A, or the closed loop with a gain, for some of the states.
    pub fn part(&self, gain: [f64; 4], states: &[usize]) -> DMatrix<f64> {
        let matrix = self.a - self.b * (RowVector4::from(gain) * self.sensed) + self.dragged_by(gain);
        DMatrix::from_fn(states.len(), states.len(), |row, column| matrix[(states[row], states[column])])
    }

    /// The closed loop of a gain over some of the states. `None` if the eigenvalues do not converge.
    pub fn closed_loop(&self, gain: [f64; 4], states: &[usize]) -> Option<ClosedLoop> {
        let eigenvalues = eigenvalues(&self.part(gain, states))?;
        let spectral_radius = eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max);
        Some(ClosedLoop { eigenvalues, spectral_radius })
    }

    /// The range of factors on a gain for which its closed loop over some of the states is stable, or the one nearest to 1; `None` if eigenvalues do
    /// not converge.
    pub fn stable_factors(&self, gain: [f64; 4], states: &[usize]) -> Option<StableGains> {
        let closed = self.part(gain, states);
        let change = &closed - self.part([0.0; 4], states);
        ByGain { own: closed, per_gain: change }.stable(1.0, 0.0)
    }
}
