//! Energy that a table which turns as it strikes gives to a swing about the upright bounce, or takes.
//!
//! The tilt rate is 0 at the upright bounce, and beside it the surface pushes along the normal, which in first order changes the height
//! alone. So the linear analysis does not see it. Not here: friction, which the turning drags along ([`crate::analysis::contact_regime`]).

use crate::analysis::contact_regime::{ContactRegime, contact_regime};
use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict};
use crate::analysis::lyapunov::first_contact;
use crate::map::strike::Rod;
use crate::scene::Scene;

/// Energy that the strikes of a turning table give to a swing about upright, without friction and without energy feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingPump {
    /// A, rad: largest |θ| of the linear swing of the release.
    pub swing: f64,
    /// x̄ − x_p, m: mean distance of the body from the pivot at the first contact.
    pub distance: f64,
    /// Mean energy per bounce, m²/s².
    pub energy: f64,
    /// Bounces until the height has grown so far that R = 1, at the present rate; `None` if it does not grow.
    pub impacts: Option<u64>,
}

/// The pump of a scene whose angle circles; `None` for others.
///
/// With u = κθ̇(b + Λθ), b = x̄ − x_p and Λ = κρ²/((κ − 1)l) + l + κp, a strike gives the energy (1 + e)u|v_n| + ½(1 + e)²u². To first order in
/// the swing u moves the bounce speed by (1 + e)κb(θ′ − θ′₀)/τ, one bounce late, and with it the flight time. To second order the mean over a swing of amplitude A is
/// (1 + e)κ A²(RG/2V)[VΛ + (1 + e)κb²G/(2V)] per bounce.
pub fn swing_pump(scene: &Scene, fixed_point: &FixedPoint, linear: &LinearVerdict) -> Option<SwingPump> {
    let scene = &scene.with_tilt_law();
    let turning = scene.acting_turn().filter(|turning| turning.strikes())?;
    let (place, residue) = (turning.place?, linear.residue?);
    if linear.class != AngleClass::Elliptic || contact_regime(&scene.model()) != ContactRegime::Frictionless {
        return None;
    }
    let rod: Rod = scene.parameters();
    let Rod { contact_distance: l, radius_of_gyration: rho, gravity, tilt_gain: kappa, restitution, .. } = rod;
    let [arc, _, spin, x] = first_contact(scene).ok()?;
    let (theta, turned) = (arc / rho, fixed_point.flight_time * spin / rho);
    let sine = 2.0 * (residue * (1.0 - residue)).sqrt();
    let across = (turned - 2.0 * residue * theta) / sine;
    let swing = (theta * theta + across * across).sqrt();
    // x = x̄ + κρ²θ/((κ − 1)l) beside a drift.
    let aside = kappa * rho * rho / ((kappa - 1.0) * l);
    let distance = x - aside * theta - place;
    let speed = fixed_point.speed;
    let (push, per_speed) = ((1.0 + restitution) * kappa, 0.5 * gravity / speed);
    let lever = speed * (aside + l + kappa * turning.depth) + push * distance * distance * per_speed;
    let energy = push * swing * swing * residue * per_speed * lever;
    // The speed grows by energy/V² of itself a bounce, and R with its square.
    let impacts = -0.5 * libm::log(residue) * speed * speed / energy;
    // A cast keeps to the range of the type.
    let impacts = (energy > 0.0 && impacts.is_finite()).then_some(impacts as u64);
    Some(SwingPump { swing, distance, energy, impacts })
}
