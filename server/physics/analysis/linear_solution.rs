//! The linear solution about the fixed point in closed form, eq. (13) and (20) to (23): any impact at the cost of one.
//!
//! With u = τθ̇ and Greene's residue R the angle goes by θ' = (1 − 4R)θ + u, u' = u − 4Rθ, whose powers are sines (0 < R < 1),
//! hyperbolic sines or straight lines. Beyond the paper, ẏ is that of the exact energy, so that what is left out is of third
//! order in the angle; with energy feedback it is ẏ's own eigenvalue, and what is left out is of second.

use crate::analysis::linear_verdict::AngleClass;
use crate::analysis::small_deviations::{SmallDeviations, small_deviations};
use crate::map::strike::{Rod, State};
use crate::numbers::trig;
use crate::scene::Scene;
use crate::scene::capability::{Analysis, Lack};

/// Largest exponent of a growth that is multiplied as it is: e^709 is the largest double.
const MOST_GROWTH: f64 = 600.0;

/// The linear solution of one run.
#[derive(Clone, Copy, Debug)]
pub struct LinearSolution {
    rod: Rod,
    /// V, m/s.
    speed: f64,
    /// τ, s.
    flight_time: f64,
    residue: f64,
    class: AngleClass,
    /// Rotation or growth per bounce, rad or 1.
    exponent: f64,
    /// Eigenvalue of ẏ; `None` if the energy is exact.
    energy_eigenvalue: Option<f64>,
    /// Just before the first impact.
    start: State,
    t: f64,
    x: f64,
}

/// The linear state just before one impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearImpact {
    /// Time, s after release.
    pub t: f64,
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
}

/// The sentence on a field for which it does not apply.
pub(super) fn lacking(path: &str) -> String {
    format!("it does not see what {path} does")
}

impl LinearSolution {
    /// The linear solution of the run of a scene. Fails with the reason if there is none, in a sentence.
    pub fn of_scene(scene: &Scene) -> Result<Self, String> {
        if let Some(Lack { path, .. }) = Analysis::LinearSolution.lack(scene) {
            return Err(lacking(path));
        }
        let SmallDeviations { fixed_point, linear, .. } =
            small_deviations(scene).map_err(|why| format!("no bounce repeats: {why}"))?;
        let body = scene.model();
        let residue = linear.residue.filter(|_| body.is_plain_rod()).ok_or("the angle has no block of its own")?;
        // Parabolic powers are those of R = 0 or 1.
        let residue = if linear.class == AngleClass::Parabolic { residue.round() } else { residue };
        // In 31 digits: of a release just above the table doubles lose digits of the clearance.
        let orbit = scene.extended_orbit().map_err(|_| "the first contact is not found")?;
        let feeds_back = scene.energy_gain() != 0.0;
        if feeds_back && linear.energy_eigenvalue.abs() >= 1.0 {
            let eigenvalue = linear.energy_eigenvalue;
            return Err(format!("energy_gain drives the energy away: the eigenvalue of y_dot is {eigenvalue}"));
        }
        let root = |share: f64| 2.0 * libm::asin(share.sqrt());
        let exponent = match linear.class {
            AngleClass::Elliptic if residue <= 0.5 => root(residue),
            AngleClass::Elliptic => std::f64::consts::PI - root(1.0 - residue),
            _ => 2.0 * libm::asinh((-residue).max(residue - 1.0).max(0.0).sqrt()),
        };
        Ok(Self {
            speed: fixed_point.speed,
            flight_time: fixed_point.flight_time,
            residue,
            class: linear.class,
            exponent,
            energy_eigenvalue: feeds_back.then_some(linear.energy_eigenvalue),
            start: orbit.state().to_f64(),
            t: orbit.t().to_f64(),
            x: orbit.x().to_f64(),
            rod: body.rod,
        })
    }

    /// The state just before impact `n` (from 1).
    pub fn impact(&self, n: u64) -> LinearImpact {
        let m = n.saturating_sub(1);
        if m == 0 {
            return LinearImpact { t: self.t, x: self.x, state: self.start };
        }
        let (theta, u) = self.angle(m);
        LinearImpact { t: self.t + self.time(m), x: self.x + self.x_along(m, theta), state: self.state(theta, u, m) }
    }

    fn start_u(&self) -> f64 {
        self.flight_time * self.start.theta_dot
    }

    /// Distance of the first ẏ from its fixed point, m/s.
    fn start_excess(&self) -> f64 {
        self.start.y_dot + self.speed
    }

    fn is_at_lower_end(&self) -> bool {
        self.class == AngleClass::Parabolic && self.residue < 0.5
    }

    /// sin mσ / sin σ, or what takes its place: Chebyshev's U of index m − 1 at 1 − 2R.
    fn chebyshev(&self, m: u64) -> f64 {
        let count = m as f64;
        let size = match self.class {
            AngleClass::Parabolic => count,
            AngleClass::Elliptic => {
                let sine = 2.0 * (self.residue * (1.0 - self.residue)).sqrt();
                return trig::sin_cos(count * self.exponent).0 / sine;
            }
            AngleClass::Hyperbolic | AngleClass::Attracting => {
                libm::sinh(count * self.exponent) / libm::sinh(self.exponent)
            }
        };
        if self.residue > 0.5 && m.is_multiple_of(2) { -size } else { size }
    }

    /// θ and u after `m` bounces: A^m = U_{m−1} A − U_{m−2}.
    fn angle(&self, m: u64) -> (f64, f64) {
        let (theta, u) = (self.start.theta, self.start_u());
        // One bounce.
        let (next_theta, next_u) = ((1.0 - 4.0 * self.residue) * theta + u, u - 4.0 * self.residue * theta);
        if self.grows_beyond_doubles(m) {
            return (self.grown(m, next_theta, theta), self.grown(m, next_u, u));
        }
        let (now, before) = (self.chebyshev(m), self.chebyshev(m - 1));
        (now * next_theta - before * theta, now * next_u - before * u)
    }

    /// Tells whether U of index m − 1 may be beyond the range of doubles, however small what it multiplies.
    fn grows_beyond_doubles(&self, m: u64) -> bool {
        self.class == AngleClass::Hyperbolic && m as f64 * self.exponent > MOST_GROWTH
    }

    /// U_{m−1} `next` − U_{m−2} `start` where the U are beyond doubles: e^((m−1)s)/(2 sinh s) · (eˢ `next` ∓ `start`), the growing part
    /// alone. It stays 0 where that is 0.
    fn grown(&self, m: u64, next: f64, start: f64) -> f64 {
        let turns = self.residue > 0.5;
        let start = if turns { -start } else { start };
        let growing = (libm::exp(self.exponent) * next - start) / (2.0 * libm::sinh(self.exponent));
        let half = libm::exp(0.5 * (m - 1) as f64 * self.exponent);
        let size = if growing == 0.0 { 0.0 } else { growing * half * half };
        if turns && m.is_multiple_of(2) { -size } else { size }
    }

    /// ẋ per u along the motion: ẋ − this·u is the drift and stays.
    fn lever(&self) -> f64 {
        self.speed * self.rod.tilt_gain / (2.0 * self.residue)
    }

    fn state(&self, theta: f64, u: f64, m: u64) -> State {
        let x_dot = if self.is_at_lower_end() {
            let count = m as f64;
            let sum = count * self.start.theta + 0.5 * count * (count - 1.0) * self.start_u();
            self.start.x_dot - 2.0 * self.speed * self.rod.tilt_gain * sum
        } else {
            self.start.x_dot + self.lever() * (u - self.start_u())
        };
        let theta_dot = u / self.flight_time;
        let y_dot = match self.energy_eigenvalue {
            Some(eigenvalue) => -self.speed + power(eigenvalue, m) * self.start_excess(),
            None => self.on_energy(theta, x_dot, theta_dot),
        };
        State { theta, x_dot, y_dot, theta_dot }
    }

    /// −√(ẏ₀² − (ẋ² − ẋ₀²) − ρ²(θ̇² − θ̇₀²) + 2Gl(cos θ₀ − cos θ)), each difference by its factors.
    fn on_energy(&self, theta: f64, x_dot: f64, theta_dot: f64) -> f64 {
        let Self { start, rod, .. } = self;
        let rho = rod.radius_of_gyration;
        let aside = (x_dot - start.x_dot) * (x_dot + start.x_dot);
        let turned = rho * (theta_dot - start.theta_dot) * rho * (theta_dot + start.theta_dot);
        let (half_sum, _) = trig::sin_cos(0.5 * (theta + start.theta));
        let (half_way, _) = trig::sin_cos(0.5 * (theta - start.theta));
        let sunk = 4.0 * rod.gravity * rod.contact_distance * half_sum * half_way;
        -f64::max(start.y_dot * start.y_dot - aside - turned + sunk, 0.0).sqrt()
    }

    /// Σ of the flight times, 2|ẏ|/G at the end of each.
    fn time(&self, m: u64) -> f64 {
        let late = self.energy_eigenvalue.map_or(0.0, |eigenvalue| {
            eigenvalue * (1.0 - power(eigenvalue, m)) / (1.0 - eigenvalue) * self.start_excess()
        });
        m as f64 * self.flight_time - 2.0 * late / self.rod.gravity
    }

    /// Σ ẋτ over the flights.
    fn x_along(&self, m: u64, theta: f64) -> f64 {
        let (count, tau) = (m as f64, self.flight_time);
        if self.is_at_lower_end() {
            let twice = 0.5 * count * (count + 1.0) * self.start.theta
                + self.start_u() * (count - 1.0) * count * (count + 1.0) / 6.0;
            return tau * (count * self.start.x_dot - 2.0 * self.speed * self.rod.tilt_gain * twice);
        }
        let turned = theta - self.start.theta - count * self.start_u();
        tau * (count * self.start.x_dot + self.lever() * turned)
    }
}

/// base^m for |base| ≤ 1.
fn power(base: f64, m: u64) -> f64 {
    let (mut result, mut square, mut left) = (1.0, base, m);
    while left > 0 {
        if left & 1 == 1 {
            result *= square;
        }
        square *= square;
        left >>= 1;
    }
    result
}
