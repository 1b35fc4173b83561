//! Equations of the paper, evaluated as printed. Those of the linearized map, (10)–(23), (29), (37) and (38), stand beside the derivative of the
//! map; those of strike and flight, (1)–(9), (24)–(28) and (30)–(36), are taken at the first contact of a run.

use equipoise_physics::analysis::jacobian::{jacobian, modulus};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::strike::{Rod, State, Strike};
use equipoise_physics::numbers::trig;
use equipoise_physics::scene::Name::{Friction, TiltGain};
use equipoise_physics::scene::{Name, Scene};
use nalgebra::{DMatrix, DVector};

use crate::api::paper::item::Check;

/// The upright bounce of a scene, with the symbols of the paper's formulas.
struct Upright {
    /// |ẏ*|, m/s.
    speed: f64,
    l: f64,
    rho: f64,
    gravity: f64,
    gain: f64,
    /// Derivative of the map there.
    matrix: DMatrix<f64>,
}

impl Upright {
    fn of(scene: &Scene) -> Option<Self> {
        let rod = scene.parameters::<f64>();
        let fixed_point = small_deviations(scene).ok()?.fixed_point;
        let matrix = jacobian(&scene.model(), &fixed_point.state(), 1).ok()?.matrix;
        let speed = fixed_point.speed;
        let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
        Some(Self { speed, l, rho, gravity: rod.gravity, gain: rod.tilt_gain, matrix })
    }

    /// Gρ²/(ẏ*²l), the width of the stable range of κ by eq. (18).
    fn width(&self) -> f64 {
        self.gravity * self.rho * self.rho / (self.speed * self.speed * self.l)
    }
}

pub(super) fn speed(scene: &Scene) -> Option<Vec<Check>> {
    let upright = Upright::of(scene)?;
    let rod = scene.parameters::<f64>();
    let start = scene.start();
    let height = scene.number(Name::Height)?;
    let spin = rod.radius_of_gyration * start.theta_dot;
    let speeds = start.x_dot * start.x_dot + start.y_dot * start.y_dot + spin * spin;
    let (_, cosine) = equipoise_physics::numbers::trig::sin_cos(start.theta);
    let printed = -(2.0 * rod.gravity * (height - rod.contact_distance * cosine) + speeds).sqrt();
    Some(vec![Check::formula(["speed at the fixed point", "ẏ*", "m/s"], printed, -upright.speed)])
}

pub(super) fn linearization(scene: &Scene) -> Option<Vec<Check>> {
    let upright = Upright::of(scene)?;
    let mut orbit = scene.orbit().ok()?;
    let deviation = |state: &State| {
        DVector::from_vec(vec![
            upright.rho * state.theta,
            state.x_dot,
            state.y_dot + upright.speed,
            upright.rho * state.theta_dot,
        ])
    };
    let mut linear = deviation(orbit.state());
    for _ in 0..10 {
        linear = &upright.matrix * linear;
        orbit.advance();
    }
    let run = deviation(orbit.state());
    let names = [["angle at contact 11", "ρθ", "m"], ["spin at contact 11", "ρθ̇", "m/s"]];
    // The linear map leaves out terms of second order, 1e-8 here.
    Some([0, 3].iter().zip(names).map(|(&k, name)| Check::within(name, linear[k], run[k], 1e-8)).collect())
}

pub(super) fn entries(scene: &Scene) -> Option<Vec<Check>> {
    let Upright { speed, l, rho, gravity, gain, ref matrix } = Upright::of(scene)?;
    let y_dot = -speed;
    let printed = [
        (0, 0, "J₁₁", "1", 1.0 + 4.0 * y_dot * y_dot * (1.0 - gain) * l / (gravity * rho * rho)),
        (0, 3, "J₁₄", "s", -2.0 * y_dot / gravity),
        (1, 0, "J₂₁", "1/s", 2.0 * y_dot * gain / rho),
        (3, 0, "J₄₁", "1/s", 2.0 * y_dot * (gain - 1.0) * l / (rho * rho)),
        (3, 3, "J₄₄", "1", 1.0),
    ];
    Some(
        printed
            .map(|(row, column, symbol, unit, value)| {
                Check::formula(["entry of the Jacobian", symbol, unit], value, matrix[(row, column)])
            })
            .into(),
    )
}

pub(super) fn eigenvalues(scene: &Scene) -> Option<Vec<Check>> {
    let upright = Upright::of(scene)?;
    let linear = small_deviations(scene).ok()?.linear;
    let Upright { speed, l, rho, gravity, gain, .. } = upright;
    let (y2l, scale) = (speed * speed * l, gravity * rho * rho);
    let real = (2.0 * y2l * (1.0 - gain) + scale) / scale;
    let imaginary = 2.0 * y2l * (gain - 1.0).sqrt() * (scale - y2l * (gain - 1.0)).sqrt() / scale;
    let angle = linear.eigenvalues.iter().max_by(|a, b| a.im.total_cmp(&b.im))?;
    Some(vec![
        Check::formula(["real part", "Re λ₃", "1"], real, angle.re),
        Check::formula(["imaginary part", "Im λ₃", "1"], imaginary, angle.im),
    ])
}

pub(super) fn solution(scene: &Scene) -> Option<Vec<Check>> {
    let upright = Upright::of(scene)?;
    let start = scene.start();
    // Of an eigenvector (…, g, 0, h) of (14), g/h = J₂₁/J₄₁.
    let ratio = upright.matrix[(1, 0)] / upright.matrix[(3, 0)];
    let printed = start.x_dot - upright.rho * start.theta_dot * ratio;
    Some(vec![Check::within(
        ["constant of the drift", "c₁", "m/s"],
        printed,
        small_deviations(scene).ok()?.drift?,
        1e-4,
    )])
}

pub(super) fn stable_range(scene: &Scene) -> Option<Vec<Check>> {
    let linear = small_deviations(scene).ok()?.linear;
    let upright = Upright::of(scene)?;
    Some(vec![
        Check::formula(["lower end", "κ", "1"], 1.0, linear.lower_tilt_gain),
        Check::formula(["upper end", "κ_c", "1"], 1.0 + upright.width(), linear.critical_tilt_gain),
        Check::formula(["largest modulus between them", "|λ|", "1"], 1.0, linear.spectral_radius()),
    ])
}

pub(super) fn critical_gain_lossy(scene: &Scene) -> Option<Vec<Check>> {
    let upright = Upright::of(scene)?;
    let linear = small_deviations(scene).ok()?.linear;
    let printed = 1.0 + 2.0 * upright.width() / (1.0 + scene.parameters::<f64>().restitution);
    Some(vec![Check::formula(["critical tilt gain", "κ_c", "1"], printed, linear.critical_tilt_gain)])
}

pub(super) fn conservative(scene: &Scene) -> Option<Vec<Check>> {
    let linear = small_deviations(scene).ok()?.linear;
    let product: f64 = linear.eigenvalues.iter().copied().map(modulus).product();
    Some(vec![Check::formula(["product of the eigenvalues at the fixed point", "λ₃λ₄", "1"], 1.0, product)])
}

/// The first contact of a run, with the terms that the paper's formulas have in common.
struct FirstContact {
    rod: Rod,
    before: State,
    strike: Strike,
    /// sin and cos of θ, of α and of β = θ − α.
    theta: (f64, f64),
    alpha: (f64, f64),
    beta: (f64, f64),
    /// τ, s.
    flight_time: f64,
    /// State before the next contact.
    next: State,
}

impl FirstContact {
    fn of(scene: &Scene) -> Option<Self> {
        let rod = scene.parameters::<f64>();
        let mut orbit = scene.orbit().ok()?;
        let contact = orbit.advance();
        let (strike, before) = (contact.strike?, contact.state);
        let [theta, alpha, beta] = [before.theta, contact.alpha, before.theta - contact.alpha].map(trig::sin_cos);
        Some(Self { rod, before, strike, theta, alpha, beta, flight_time: contact.flight_time?, next: *orbit.state() })
    }

    /// Velocities (ẋ, ẏ, ρθ̇).
    fn velocities(&self, state: &State) -> [f64; 3] {
        [state.x_dot, state.y_dot, self.rod.radius_of_gyration * state.theta_dot]
    }

    /// The unit vector of eq. (2).
    fn normal(&self) -> [f64; 3] {
        let (l, rho) = (self.rod.contact_distance, self.rod.radius_of_gyration);
        let arm = l * self.beta.0;
        let factor = rho / (rho * rho + arm * arm).sqrt();
        [-self.alpha.0, self.alpha.1, l / rho * self.beta.0].map(|part| factor * part)
    }

    /// v⁺ = v⁻ − (1 + e) n̂ n̂ᵀ (v⁻ − v_table), eqs. (1), (24) and (36).
    fn reflected(&self, restitution: f64, table: [f64; 3]) -> [f64; 3] {
        let (normal, before) = (self.normal(), self.velocities(&self.before));
        let along: f64 = (0..3).map(|k| normal[k] * (before[k] - table[k])).sum();
        [0, 1, 2].map(|k| before[k] - (1.0 + restitution) * along * normal[k])
    }

    /// Printed velocities after the strike beside those of the map.
    fn compare(&self, printed: [f64; 3]) -> Vec<Check> {
        let after = self.velocities(&self.strike.after);
        let names =
            [["velocity x after", "ẋ⁺", "m/s"], ["velocity y after", "ẏ⁺", "m/s"], ["spin after", "ρθ̇⁺", "m/s"]];
        (0..3).map(|k| Check::formula(names[k], printed[k], after[k])).collect()
    }

    /// Velocity of the contact point, eq. (26).
    fn contact_velocity(&self) -> (f64, f64) {
        let arm = self.rod.contact_distance * self.before.theta_dot;
        (self.before.x_dot + arm * self.theta.1, self.before.y_dot + arm * self.theta.0)
    }

    /// Components of a velocity along the table and along its normal.
    fn in_table_frame(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x * self.alpha.1 + y * self.alpha.0, y * self.alpha.1 - x * self.alpha.0)
    }

    /// Velocity of the table along its normal.
    fn table_speed(&self) -> f64 {
        self.in_table_frame(self.strike.table_velocity).1
    }

    /// l sin β and l cos β.
    fn arms(&self) -> (f64, f64) {
        let l = self.rod.contact_distance;
        (l * self.beta.0, l * self.beta.1)
    }

    /// ρ².
    fn rho_squared(&self) -> f64 {
        self.rod.radius_of_gyration * self.rod.radius_of_gyration
    }

    /// ρ²(θ̇⁺ − θ̇⁻), the moment of the impulse.
    fn moment(&self) -> f64 {
        self.rho_squared() * (self.strike.after.theta_dot - self.before.theta_dot)
    }

    /// ρ²/(ρ² + l² sin²β).
    fn share(&self) -> f64 {
        let (rho2, (arm, _)) = (self.rho_squared(), self.arms());
        rho2 / (rho2 + arm * arm)
    }
}

pub(super) fn reflection(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    Some(first.compare(first.reflected(1.0, [0.0; 3])))
}

pub(super) fn point_mass(scene: &Scene) -> Option<Vec<Check>> {
    let mut orbit = scene.orbit().ok()?;
    let angle = |state: &State| libm::atan2(state.x_dot, -state.y_dot);
    let gain = scene.number(TiltGain)?;
    let start = angle(orbit.state());
    let contact = orbit.advance();
    let mut checks =
        vec![Check::formula(["angle at contact 2", "θ₁", "rad"], start - 2.0 * contact.alpha, angle(orbit.state()))];
    (0..4).for_each(|_| {
        orbit.advance();
    });
    let printed = (0..5).fold(start, |angle, _| angle * (1.0 - 2.0 * gain));
    checks.push(Check::formula(["angle at contact 6", "θ₅", "rad"], printed, angle(orbit.state())));
    Some(checks)
}

pub(super) fn flight(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let (l, gravity, tau) = (first.rod.contact_distance, first.rod.gravity, first.flight_time);
    let start = first.strike.after;
    let (_, there) = trig::sin_cos(start.theta + start.theta_dot * tau);
    let left = l * first.theta.1 + start.y_dot * tau - 0.5 * gravity * tau * tau;
    Some(vec![
        Check::formula(["velocity at the next contact", "ẏ", "m/s"], start.y_dot - gravity * tau, first.next.y_dot),
        Check::formula(["right side of (8) beside its left side", "l cos θ", "m"], left, l * there),
    ])
}

pub(super) fn recurrence(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let [x_dot, y_dot, spin] = first.reflected(1.0, [0.0; 3]);
    let (tau, rho) = (first.flight_time, first.rod.radius_of_gyration);
    Some(vec![
        Check::formula(["angle at contact 2", "θ", "rad"], first.before.theta + spin / rho * tau, first.next.theta),
        Check::formula(["velocity at contact 2", "ẋ", "m/s"], x_dot, first.next.x_dot),
        Check::formula(["velocity at contact 2", "ẏ", "m/s"], y_dot - first.rod.gravity * tau, first.next.y_dot),
    ])
}

pub(super) fn inelastic(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let (x, y) = first.strike.table_velocity;
    Some(first.compare(first.reflected(first.rod.restitution, [x, y, 0.0])))
}

pub(super) fn compensation(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let e = first.rod.restitution;
    let speed = -(1.0 - e) / (1.0 + e) * first.in_table_frame(first.contact_velocity()).1;
    let mut checks = first.compare(first.reflected(1.0, [0.0; 3]));
    checks.push(Check::formula(["speed of the table along its normal", "v_table", "m/s"], speed, first.table_speed()));
    Some(checks)
}

pub(super) fn energy_feedback(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let Rod { gravity, contact_distance, restitution: e, .. } = first.rod;
    let target = gravity * scene.number(Name::TargetHeight)?;
    let eta = gravity * contact_distance * first.theta.1 + 0.5 * first.before.y_dot * first.before.y_dot;
    let factor = (1.0 - e) / (1.0 + e) + scene.number(Name::EnergyGain)? * (target - eta);
    let speed = -factor * first.in_table_frame(first.contact_velocity()).1;
    Some(vec![Check::formula(["speed of the table along its normal", "v_table", "m/s"], speed, first.table_speed())])
}

pub(super) fn friction_moment(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let (sine, cosine) = first.arms();
    let along = first.in_table_frame(first.contact_velocity()).0;
    let Strike { impulse_normal, impulse_tangential, .. } = first.strike;
    let friction = -scene.number(Friction)? * impulse_normal * along.signum();
    Some(vec![
        Check::formula(["tangential impulse per unit mass", "P_t", "m/s"], friction, impulse_tangential),
        Check::formula(
            ["moment per unit mass", "M", "m²/s"],
            impulse_normal * sine + friction * cosine,
            first.moment(),
        ),
    ])
}

pub(super) fn impulses(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let Strike { after, impulse_normal, impulse_tangential, normal_velocity, .. } = first.strike;
    let before = first.in_table_frame((first.before.x_dot, first.before.y_dot));
    let then = first.in_table_frame((after.x_dot, after.y_dot));
    let (sine, cosine) = first.arms();
    let rho2 = first.rho_squared();
    // Eq. (33) along the normal, beside (32) after the strike.
    let start = before.1 + first.before.theta_dot * sine;
    let printed = start + sine * cosine / rho2 * impulse_tangential + (rho2 + sine * sine) / rho2 * impulse_normal;
    Some(vec![
        Check::formula(["change along the table", "P_t", "m/s"], impulse_tangential, then.0 - before.0),
        Check::formula(["change along the normal", "P_n", "m/s"], impulse_normal, then.1 - before.1),
        Check::formula(
            ["moment per unit mass", "P_ω", "m²/s"],
            impulse_tangential * cosine + impulse_normal * sine,
            first.moment(),
        ),
        Check::formula(["contact point along the normal, before", "v_nc", "m/s"], start, normal_velocity),
        Check::formula(
            ["contact point along the normal, after", "v_nc", "m/s"],
            printed,
            then.1 + after.theta_dot * sine,
        ),
    ])
}

pub(super) fn newton(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    let Strike { impulse_normal, impulse_tangential, normal_velocity, .. } = first.strike;
    let printed = -(1.0 + first.rod.restitution) * first.share() * normal_velocity;
    Some(vec![
        Check::formula(["tangential impulse per unit mass", "P_t", "m/s"], 0.0, impulse_tangential),
        Check::formula(["normal impulse per unit mass", "P_n", "m/s"], printed, impulse_normal),
        Check::formula(["moment per unit mass", "P_ω", "m²/s"], first.arms().0 * printed, first.moment()),
    ])
}

pub(super) fn lossy_reflection(scene: &Scene) -> Option<Vec<Check>> {
    let first = FirstContact::of(scene)?;
    Some(first.compare(first.reflected(first.rod.restitution, [0.0; 3])))
}
