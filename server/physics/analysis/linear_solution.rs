//! The linear solution about the fixed point, eq. (13) and (20) to (23), by the linear map of eq. (14), impact after impact.
//!
//! With Greene's residue R the angle goes by θ̇' = θ̇ − 4Rθ/τ, θ' = θ + τθ̇', the place by ẋ' = ẋ − 2Vκθ, x' = x + τẋ'. Beyond the paper, ẏ is that
//! of the exact energy, so that what is left out is of third order in the angle; with energy feedback it is ẏ's own eigenvalue, and what is left out
//! is of second.

use crate::analysis::linear_verdict::AngleClass;
use crate::analysis::small_deviations::{SmallDeviations, small_deviations};
use crate::map::strike::{Rod, State};
use crate::numbers::compensated_sum::CompensatedSum;
use crate::numbers::trig;
use crate::scene::Scene;
use crate::scene::capability::{Analysis, Lack};

/// The linear solution of one run: its impacts, without an end.
#[derive(Clone, Copy, Debug)]
pub struct LinearSolution {
    rod: Rod,
    /// V, m/s.
    speed: f64,
    /// τ, s.
    flight_time: f64,
    residue: f64,
    /// Eigenvalue of ẏ; `None` if the energy is exact.
    energy_eigenvalue: Option<f64>,
    /// Just before the first impact.
    start: State,
    /// Just before the next impact.
    state: State,
    t: CompensatedSum,
    x: CompensatedSum,
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
        let start = orbit.state().to_f64();
        Ok(Self {
            speed: fixed_point.speed,
            flight_time: fixed_point.flight_time,
            residue,
            energy_eigenvalue: feeds_back.then_some(linear.energy_eigenvalue),
            start,
            state: start,
            t: CompensatedSum::of(orbit.t().to_f64()),
            x: CompensatedSum::of(orbit.x().to_f64()),
            rod: body.rod,
        })
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
}

impl Iterator for LinearSolution {
    type Item = LinearImpact;

    fn next(&mut self) -> Option<LinearImpact> {
        let Self { rod, speed, flight_time, residue, state, .. } = *self;
        let impact = LinearImpact { t: self.t.value, x: self.x.value, state };
        let x_dot = state.x_dot - 2.0 * speed * rod.tilt_gain * state.theta;
        let theta_dot = state.theta_dot - 4.0 * residue * state.theta / flight_time;
        let theta = state.theta + flight_time * theta_dot;
        // Distance of ẏ from its fixed point, m/s.
        let excess = self.energy_eigenvalue.map(|eigenvalue| eigenvalue * (state.y_dot + speed));
        let y_dot = excess.map_or_else(|| self.on_energy(theta, x_dot, theta_dot), |excess| excess - speed);
        self.state = State { theta, x_dot, y_dot, theta_dot };
        self.t.add(flight_time - 2.0 * excess.unwrap_or(0.0) / rod.gravity);
        self.x.add(flight_time * x_dot);
        Some(impact)
    }
}
