//! The linear solution about the fixed point in closed form, eq. (13) and (20) to (23): the state at any impact at the cost of
//! one, with a bound on what it leaves out.
//!
//! With u = τθ̇ and Greene's residue R the angle goes by θ' = (1 − 4R)θ + u, u' = u − 4Rθ, whose powers are sines (0 < R < 1),
//! hyperbolic sines or straight lines. Beyond the paper, ẏ is that of the exact energy, so that what is left out is of third
//! order in the angle; with energy feedback it is ẏ's own eigenvalue, and what is left out is of second.
//! Not here: the bound itself ([`bound`]), point masses, and tables that stand still, which have no fixed point.

mod bound;
mod closed_form;
mod truncation_error;

pub use bound::SAFETY;
pub use closed_form::{LinearImpact, LinearSolution};

use crate::analysis::linear_verdict::AngleClass;
use crate::analysis::small_deviations::{SmallDeviations, small_deviations};
use crate::run::extended;
use crate::scene::Scene;
use crate::scene::capability::{Analysis, Lack};
use truncation_error::TruncationError;

/// The sentence on a field for which it does not apply.
pub(super) fn lacking(path: &str) -> String {
    format!("it does not see what {path} does")
}

impl LinearSolution {
    /// The linear solution of the run of a scene.
    ///
    /// # Errors
    /// The reason if there is none, in a sentence.
    pub fn of_scene(scene: &Scene) -> Result<Self, String> {
        if let Some(Lack { path, .. }) = Analysis::LinearSolution.lack(scene) {
            return Err(lacking(path));
        }
        let SmallDeviations { fixed_point, linear, .. } =
            small_deviations(scene).map_err(|why| format!("no bounce repeats: {why}"))?;
        let body = scene.model();
        let Some(residue) = linear.residue.filter(|_| body.is_plain_rod()) else {
            return Err("the angle has no block of its own".to_owned());
        };
        // The left-out terms must belong to the same residue as the powers of the map; parabolic powers are those of R = 0 or 1.
        let residue = if linear.class == AngleClass::Parabolic { residue.round() } else { residue };
        let unknown = |_| "the first contact is not found".to_owned();
        scene.orbit().map_err(|_| unknown(()))?;
        // In 31 digits: of a release just above the table doubles lose digits of the clearance.
        let orbit = scene.extended_orbit().map_err(|_| unknown(()))?;
        let feeds_back = scene.energy_gain != 0.0;
        if feeds_back && linear.energy_eigenvalue.abs() >= 1.0 {
            let eigenvalue = linear.energy_eigenvalue;
            return Err(format!("energy_gain drives the energy away: the eigenvalue of y_dot is {eigenvalue}"));
        }
        let root = |share: f64| 2.0 * libm::asin(share.sqrt());
        let exponent = match linear.class {
            AngleClass::Elliptic if residue <= 0.5 => root(residue),
            AngleClass::Elliptic => std::f64::consts::PI - root(1.0 - residue),
            AngleClass::Hyperbolic | AngleClass::Parabolic | AngleClass::Attracting if residue < 0.0 => {
                2.0 * libm::asinh((-residue).sqrt())
            }
            AngleClass::Hyperbolic | AngleClass::Parabolic | AngleClass::Attracting => {
                2.0 * libm::asinh(f64::max(residue - 1.0, 0.0).sqrt())
            }
        };
        let mut solution = Self {
            extended: scene.parameters(),
            speed: fixed_point.speed,
            flight_time: fixed_point.flight_time,
            residue,
            class: linear.class,
            exponent,
            energy_eigenvalue: feeds_back.then_some(linear.energy_eigenvalue),
            start: extended::in_doubles(orbit.state()),
            t: orbit.t().to_f64(),
            x: orbit.x().to_f64(),
            rod: body.rod,
            circling: [TruncationError::default(); 2],
        };
        if solution.class == AngleClass::Elliptic {
            solution.circling = solution.on_circle(0.0);
            if feeds_back {
                let [always, first] = solution.circling;
                let aside = always.y_dot.max(first.y_dot) / (1.0 - linear.energy_eigenvalue.abs());
                solution.circling = solution.on_circle(aside);
            }
        }
        Ok(solution)
    }

    /// The state just before impact `n` (from 1), and how far it may be off.
    pub fn impact(&self, n: u64) -> LinearImpact {
        let m = n.saturating_sub(1);
        if m == 0 {
            return self.first();
        }
        let (theta, u) = self.angle(m);
        let (state, along) = (self.state(theta, u, m), self.x_along(m, theta));
        let (error_estimate, t_error) = self.errors(m, &state);
        LinearImpact { t: self.t + self.time(m), x: self.x + along, state, error_estimate, t_error }
    }
}
