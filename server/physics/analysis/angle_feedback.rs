//! State feedback of θ and θ̇ alone, α = κθ + dθ̇: it leaves the body a drift that no strike takes away.

use crate::analysis::contact_regime::{ContactRegime, contact_regime};
use crate::control::bounce_model::BounceModel;
use crate::map::body::PreImpact;
use crate::map::strike::State;
use crate::scene::Scene;
use nalgebra::Vector4;

/// Most bounces until the height counts as settled.
const MOST_BOUNCES: u32 = 10_000;

/// Change of the speed over a bounce, as a share of it, below which it has settled.
const SETTLED: f64 = 1e-14;

/// The gains of a feedback of θ and θ̇ alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleFeedback {
    /// κ = −K_θ.
    pub tilt_gain: f64,
    /// d = −K_θ̇, s.
    pub rate_gain: f64,
}

impl AngleFeedback {
    /// The feedback of a scene whose table leaves a drift as it is; `None` if x or ẋ is fed back, if friction takes the drift away, and
    /// for κ = 1, at which the angle itself drifts off.
    pub fn of(scene: &Scene) -> Option<Self> {
        let model = scene.model();
        let [x, theta, x_dot, theta_dot] = model.feedback()?;
        let drifts = x == 0.0 && x_dot == 0.0 && contact_regime(&model) != ContactRegime::Sticking;
        (drifts && theta != -1.0).then_some(Self { tilt_gain: -theta, rate_gain: -theta_dot })
    }

    /// c, m/s: the mean horizontal speed of the run of a scene whose bounces settle at `speed` V (m/s) beside a drift of about `drift`
    /// (m/s). `None` if the run comes to no contact.
    ///
    /// To first order a strike of normal impulse P at an upright bounce takes away the part of ẋ + Bθ̇ that B = −(κρ² + s)/((κ − 1)l), with
    /// s = l² where a matched contact sticks and 0 without friction, leaves over: P dθ̇/(1 − κ). The flights of constant length 2V/G sum
    /// that up, so
    /// c = ẋ + Bθ̇ + Gd(θ − 2Vθ̇/G)/(1 − κ)
    /// stays. Bounces until the height has settled go by the linear model of each.
    pub fn drift(&self, scene: &Scene, speed: f64, drift: f64) -> Option<f64> {
        let Self { tilt_gain, rate_gain } = *self;
        let (rod, model) = (scene.parameters::<f64>(), scene.model());
        let regime = contact_regime(&model);
        let orbit = scene.orbit().ok()?;
        let first = orbit.state();
        let mut state = Vector4::new(orbit.x(), first.theta, first.x_dot, first.theta_dot);
        let mut down = -first.y_dot;
        for _ in 0..MOST_BOUNCES {
            let upright = State { theta: 0.0, x_dot: drift, y_dot: -down, theta_dot: 0.0 };
            let up = if scene.lag() == 0.0 {
                rod.strike(&upright).after.y_dot
            } else {
                model.strike(&PreImpact::at(1, 0.0, upright)).after.y_dot
            };
            if up <= 0.0 || (up - down).abs() <= SETTLED * down {
                break;
            }
            let bounce = BounceModel::with_ratio(&rod, down, up / down, regime);
            state = bounce.a * state + bounce.b * (tilt_gain * state[1] + rate_gain * state[3]);
            down = up;
        }
        let [_, theta, x_dot, theta_dot]: [f64; 4] = state.into();
        let lever = rod.radius_of_gyration * rod.radius_of_gyration / rod.contact_distance;
        let stuck = if regime == ContactRegime::VelocityMatched { rod.contact_distance } else { 0.0 };
        let back = theta - 2.0 * speed / rod.gravity * theta_dot;
        let excess = tilt_gain - 1.0;
        Some(x_dot - ((tilt_gain * lever + stuck) * theta_dot + rod.gravity * rate_gain * back) / excess)
    }

    /// Energy per unit mass, m²/s², that a table which moves along with the contact gives to a run about the bounce of `speed` V (m/s) until
    /// its swing has died out; 0 without friction, and if the swing does not die out.
    ///
    /// A strike of the model turns the contact point along the table by P_t = 2Vl²(α − θ)/(ρ² + l²) while the table moves at
    /// v_t = ẋ − Vα + lθ̇ along itself, so it works by P_t v_t.
    pub fn lent_energy(&self, scene: &Scene, speed: f64) -> f64 {
        let regime = contact_regime(&scene.model());
        let (rod, Ok(orbit)) = (scene.parameters::<f64>(), scene.orbit()) else { return 0.0 };
        if regime != ContactRegime::VelocityMatched {
            return 0.0;
        }
        let bounce = BounceModel::new(&rod, speed, regime);
        let first = orbit.state();
        let l = rod.contact_distance;
        let share = 2.0 * speed * l * l / (rod.radius_of_gyration * rod.radius_of_gyration + l * l);
        let mut state = Vector4::new(0.0, first.theta, first.x_dot, first.theta_dot);
        let mut sum = 0.0;
        for _ in 0..MOST_BOUNCES {
            let alpha = self.tilt_gain * state[1] + self.rate_gain * state[3];
            let work = share * (alpha - state[1]) * (state[2] - speed * alpha + l * state[3]);
            sum += work;
            if work.abs() <= SETTLED * speed * speed {
                return sum;
            }
            state = bounce.a * state + bounce.b * alpha;
        }
        0.0
    }
}
