//! The height of the upright bounce of a table that moves by the speed that it has sensed some time before the strike.

use crate::map::strike::EnergyFeedback;
use crate::scene::Scene;

/// Most steps of the search of a speed.
const MOST_STEPS: u32 = 100;

/// The upright bounce at which such a table comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayedHeight {
    /// V, m/s.
    pub speed: f64,
    /// Derivative of the speed at a contact by that at the contact before it.
    pub eigenvalue: f64,
}

impl DelayedHeight {
    /// The bounce of a scene with `held` (m/s) of drift in the energy that the table holds; `None` if the table does not move, or senses at
    /// once.
    ///
    /// A body that comes down at u is sensed at û = u − Gτ, τ before the contact. With M = (1 − ê)/(1 + ê), the missing energy
    /// ε₀ = G(y* − l) of a body at rest, less ½c² if the drift is measured, and the proportional law, the table rises at
    /// (M + κ_E(ε₀ − ½û²))û, so that u′ = eu + (1 + e)(M + κ_E(ε₀ − ½û²))û. At rest
    /// ½qû³ − bû + (1 − e)Gτ = 0, q = (1 + e)κ_E, b = qε₀ + (1 + e)M − (1 − e),
    /// and du′/du = 1 + (1 − e)Gτ/û − qû². With the law of one strike u′ = eu + s(û + √C) − (1 + e)û, s = (1 + e)/(1 + ê), C = 2ε₀.
    pub fn of(scene: &Scene, held: f64) -> Option<Result<Self, String>> {
        scene.moves_late().then(|| Self::at_rest(scene, held))
    }

    fn at_rest(scene: &Scene, held: f64) -> Result<Self, String> {
        let rod = scene.parameters::<f64>();
        let (e, lag) = (rod.restitution, scene.lag());
        let fall = rod.gravity * lag;
        if !scene.steers_energy() {
            return Err(format!(
                "{}: that speed is {fall} m/s less than at the strike, and nothing steers the height, so no bounce repeats",
                scene.belief()
            ));
        }
        let kinetic = match rod.energy_feedback {
            EnergyFeedback::Vertical => 0.0,
            EnergyFeedback::Total | EnergyFeedback::OneStrike => 0.5 * held * held,
        };
        let missing = rod.target_energy - rod.gravity * rod.contact_distance - kinetic;
        let none = || {
            format!(
                "no bounce at a target of {missing} m²/s² above rest repeats: {}, {fall} m/s less than at the strike",
                scene.belief()
            )
        };
        let share = (1.0 + e) / (1.0 + scene.assumed_restitution());
        let (seen, eigenvalue) = if rod.energy_feedback == EnergyFeedback::OneStrike {
            let speed = (share * (2.0 * missing).sqrt() + (1.0 + e - share) * fall) / (2.0 - share);
            (speed - fall, share - 1.0)
        } else {
            let gain = rod.strike_gain_per_energy;
            let slope = gain * missing + (rod.strike_gain - (1.0 + e)) - (1.0 - e);
            let loss = (1.0 - e) * fall;
            if gain <= 0.0 {
                return Err(format!("{}; with energy_gain {} this is not derived", none(), scene.energy_gain));
            }
            let seen = largest_root(0.5 * gain, slope, loss);
            (seen, 1.0 + loss / seen - gain * seen * seen)
        };
        if !(seen.is_finite() && seen > 0.0) {
            return Err(none());
        }
        Ok(Self { speed: seen + fall, eigenvalue })
    }
}

/// The largest root of ax³ − bx + d, a > 0 and d ≥ 0, by Newton's steps from above, where the cubic is convex; NaN if there is none above 0.
fn largest_root(a: f64, b: f64, d: f64) -> f64 {
    let least = (b / (3.0 * a)).sqrt();
    let at = |x: f64| (a * x * x - b) * x + d;
    if least.is_nan() || at(least) > 0.0 {
        return f64::NAN;
    }
    let mut x = (b / a).sqrt();
    for _ in 0..MOST_STEPS {
        let next = (x - at(x) / (3.0 * a * x * x - b)).max(least);
        if next >= x {
            break;
        }
        x = next;
    }
    x
}
