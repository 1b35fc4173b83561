//! A simulation of friction of its own, to hold the map against: the impulse followed through its changes, flights by halving; random rods and
//! their runs alone, to hold lanes against.

use equipoise_physics::map::strike::{EnergyFeedback, Rod};
use equipoise_physics::numbers::dispatch::InstructionSet;
use equipoise_physics::run::lanes::batch_run::LaneRunEnd;
use equipoise_physics::run::orbit::{Orbit, run};
use proptest::prelude::*;

/// A rod on a table with friction, from the equations of the impulse and of the flight alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simple {
    pub(crate) l: f64,
    pub(crate) rho: f64,
    pub(crate) kappa: f64,
    pub(crate) e: f64,
    pub(crate) mu: f64,
    pub(crate) still: bool,
    pub(crate) law: &'static str,
    /// θ, ẋ, ẏ, θ̇ just before a contact.
    pub(crate) state: [f64; 4],
}

const G: f64 = 9.81;

impl Simple {
    /// The velocities after a strike, by the impulse as its normal part grows: v_t and v_n are followed through every change of
    /// their slopes. `None` if the table could only pull.
    fn strike(&self) -> Option<[f64; 3]> {
        let Self { l, rho, e, .. } = *self;
        let [theta, x_dot, y_dot, theta_dot] = self.state;
        let (alpha, beta) = (self.kappa * theta, (1.0 - self.kappa) * theta);
        let lever = (l / rho) * (l / rho);
        let (a, b, c) = (
            1.0 + lever * beta.cos() * beta.cos(),
            1.0 + lever * beta.sin() * beta.sin(),
            lever * beta.sin() * beta.cos(),
        );
        let v_n = alpha.cos() * y_dot - alpha.sin() * x_dot + l * beta.sin() * theta_dot;
        let v_t = alpha.cos() * x_dot + alpha.sin() * y_dot + l * beta.cos() * theta_dot;
        let table = if self.still { 0.0 } else { -(1.0 - e) / (1.0 + e) * v_n };
        let start = v_n - table;
        if start >= 0.0 {
            return None;
        }
        // Segments of P_n, with the slope dP_t/dP_n on each.
        let sign = if v_t == 0.0 { c.signum() } else { v_t.signum() };
        let slide = -self.mu * sign;
        let meets = -v_t / (a * slide + c);
        let (turn, then) = if meets >= 0.0 && (a * slide + c) * v_t <= 0.0 && v_t != 0.0 {
            (meets, if (c / a).abs() <= self.mu { -c / a } else { -self.mu * c.signum() })
        } else if v_t == 0.0 && (c / a).abs() <= self.mu {
            (0.0, -c / a)
        } else {
            (f64::INFINITY, slide)
        };
        // v_n after the normal impulse p.
        let (first, second) = (b + c * slide, b + c * then);
        let normal = |p: f64| start + first * p.min(turn) + second * (p - turn).max(0.0);
        let reach = |target: f64| {
            let p = (target - start) / first;
            if p <= turn { p } else { turn + (target - (start + first * turn)) / second }
        };
        // Work of the normal impulse up to p, the integral of v_n.
        let work = |p: f64| {
            let q = p.min(turn);
            0.5 * (start + normal(q)) * q + if p > turn { 0.5 * (normal(turn) + normal(p)) * (p - turn) } else { 0.0 }
        };
        let compressed = reach(0.0);
        let end = match self.law {
            "poisson" => (1.0 + e) * compressed,
            "newton" => reach(-e * start),
            _ => {
                let wanted = -e * e * work(compressed);
                let (mut low, mut high) = (compressed, compressed + 1.0);
                while work(high) - work(compressed) < wanted {
                    high += high - compressed;
                }
                for _ in 0..200 {
                    let middle = 0.5 * (low + high);
                    if work(middle) - work(compressed) < wanted { low = middle } else { high = middle }
                }
                low
            }
        };
        let p_t = slide * end.min(turn) + then * (end - turn).max(0.0);
        Some([
            x_dot + p_t * alpha.cos() - end * alpha.sin(),
            y_dot + p_t * alpha.sin() + end * alpha.cos(),
            theta_dot + (p_t * l * beta.cos() + end * l * beta.sin()) / (rho * rho),
        ])
    }

    /// The flight after velocities, by halving: its gap is concave, so that after its top it has one root.
    fn fly(&self, [_, y_dot, theta_dot]: [f64; 3]) -> f64 {
        let theta = self.state[0];
        let rise = y_dot + self.l * theta_dot * theta.sin();
        // g/t, with 1 − cos and θ̇t − sin in forms that do not cancel.
        let per_t = |t: f64| {
            let u = theta_dot * t;
            let half = (0.5 * u).sin();
            let lag = if u.abs() < 0.1 {
                u * u * u / 6.0 * (1.0 - u * u / 20.0 * (1.0 - u * u / 42.0 * (1.0 - u * u / 72.0)))
            } else {
                u - u.sin()
            };
            rise - 0.5 * G * t + self.l * (theta.cos() * 2.0 * half * half - theta.sin() * lag) / t
        };
        let (mut low, mut high) = (0.0, 4.0 * (y_dot.abs() + (y_dot * y_dot + 4.0 * G * self.l).sqrt()) / G);
        for _ in 0..2000 {
            let middle = if low == 0.0 { 0.5 * high } else { 0.5 * (low + high) };
            if per_t(middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
            if high - low <= 1e-15 * low {
                break;
            }
        }
        high
    }

    /// Time at which the run comes to rest after `t`, s; `None` if it ends otherwise, or not within 3000 contacts.
    pub(crate) fn rest(mut self, mut t: f64) -> Option<(f64, f64)> {
        let (mut first, mut last) = (0.0, 0.0);
        for contact in 0..3000 {
            let theta = self.state[0];
            if theta.abs() >= std::f64::consts::FRAC_PI_2 {
                return None;
            }
            let after = self.strike()?;
            let [x_dot, y_dot, theta_dot] = after;
            let rise = y_dot + self.l * theta_dot * theta.sin();
            let contact_speed = (x_dot + self.l * theta_dot * theta.cos()).hypot(rise);
            if rise <= 1e-11 && contact == 0 && contact_speed < 1e-11 {
                return Some((t, 0.0));
            }
            if rise <= 0.0 || self.l * theta_dot * theta_dot > 0.95 * G {
                return None;
            }
            let flight = self.fly(after);
            if contact == 0 {
                first = flight;
            }
            if flight < 1e-11 * first && contact_speed < 1e-9 * first * G {
                return Some((t + flight / (1.0 - flight / last), first));
            }
            (t, last) = (t + flight, flight);
            self.state = [theta + theta_dot * flight, x_dot, y_dot - G * flight, theta_dot];
        }
        None
    }
}

prop_compose! {
    /// Rods on tables of all kinds, with a target energy of at least so much, in that of the rod at rest upright.
    pub(crate) fn rods(least_energy: f64)(
        length in 0.02..2.0_f64, ratio in 0.2..1.5, tilt_gain in -0.5..2.5, energy_gain in prop_oneof![Just(0.0), -0.2..0.3],
        restitution in 0.2..1.0, above in least_energy..3.0, still in prop::bool::weighted(0.2),
    ) -> Rod {
        let energy_gain = if still { 0.0 } else { energy_gain };
        Rod {
            contact_distance: length,
            radius_of_gyration: length * ratio,
            gravity: 9.81,
            restitution,
            tilt_gain,
            strike_gain: if still { 1.0 + restitution } else { 2.0 },
            strike_gain_per_energy: (1.0 + restitution) * energy_gain,
            target_energy: 9.81 * length * above,
            energy_feedback: EnergyFeedback::Vertical,
        }
    }
}

/// True if the table changes the energy, so that a run can settle.
pub(crate) fn changes_energy(rod: &Rod) -> bool {
    rod.strike_gain < 2.0 || rod.strike_gain_per_energy != 0.0
}

/// End of a run outside lanes.
pub(crate) fn alone(mut orbit: Orbit, impacts: u64) -> LaneRunEnd {
    let mut max_theta: f64 = 0.0;
    let ending = run(&mut orbit, impacts, |contact| {
        max_theta = max_theta.max(contact.state.theta.abs());
        true
    });
    LaneRunEnd { impacts: orbit.contacts(), outcome: ending.unwrap().into(), max_theta }
}

/// Kinds of instructions that this CPU has.
pub(crate) fn paths() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL.into_iter().filter(|path| path.is_there())
}
