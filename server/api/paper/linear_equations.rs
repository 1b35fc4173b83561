//! Equations of the linearized map: (10)–(23), (29), (37), (38). Each is evaluated as printed, beside the derivative of the map.

use equipoise_physics::analysis::jacobian::{jacobian, modulus};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Name;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::Value::Number;
use nalgebra::{DMatrix, DVector};

use crate::api::paper::item::{Check, Item, Kind, PLAIN};
use crate::api::scene::quantity::Quantity;

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

/// Section 2.1.2.
pub(super) const ITEMS: [Item; 6] = [
    Item {
        id: "speed",
        place: "(10)",
        title: "Speed of the upright bounce",
        printed: "ẏ* = −√(2G(y₀ − l cos θ) + v₀ᵀv₀)",
        ask: ("stability", "bounces=2000"),
        checks: |scene| {
            let upright = Upright::of(scene)?;
            let rod = scene.parameters::<f64>();
            let start = scene.start();
            let height = scene.number(Name::Height)?;
            let spin = rod.radius_of_gyration * start.theta_dot;
            let speeds = start.x_dot * start.x_dot + start.y_dot * start.y_dot + spin * spin;
            let (_, cosine) = equipoise_physics::numbers::trig::sin_cos(start.theta);
            let printed = -(2.0 * rod.gravity * (height - rod.contact_distance * cosine) + speeds).sqrt();
            Some(vec![Check::formula(["speed at the fixed point", "ẏ*", "m/s"], printed, -upright.speed)])
        },
        why: Some(
            "Eq. (10) gives the speed of the first impact. The upright bounce of the same energy has l in place of l cos θ, and the energy \
             of the drift less: ẏ* = −√(2G(y₀ − l) + v₀ᵀv₀ − c²). Table 1's κ_critical is computed with it",
        ),
        ..PLAIN
    },
    Item {
        id: "linearization",
        place: "(11), (12), (13)",
        title: "The linear map near the upright bounce",
        printed: "δxₙ = [J(x*)]ⁿ δx₀",
        scene: ("case-1", &[(Name::Theta, Number(1e-4))]),
        ask: ("trajectories", "bounces=20&method=linear"),
        checks: |scene| {
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
        },
        ..PLAIN
    },
    Item {
        id: "jacobian",
        place: "(14)",
        title: "The Jacobian at the upright bounce",
        printed: "J₁₁ = 1 + 4ẏ*²(1 − κ)l/(Gρ²), J₁₄ = −2ẏ*/G, J₂₁ = 2ẏ*κ/ρ, J₄₁ = 2ẏ*(κ − 1)l/ρ², 1 on the rest of the diagonal",
        ask: ("jacobians", "at=fixed_point"),
        checks: |scene| {
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
        },
        ..PLAIN
    },
    Item {
        id: "eigenvalues",
        place: "(15)",
        title: "The eigenvalues of the angle",
        printed: "λ₃,₄ = [2ẏ*²l(1 − κ) + Gρ² ± 2ẏ*²l √(κ − 1) √(ẏ*²l(κ − 1) − Gρ²)]/(Gρ²)",
        ask: ("stability", "bounces=2000&format=svg"),
        checks: |scene| {
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
        },
        why: Some(
            "(15) has the factor 2ẏ*²l before the two roots and needs 2ẏ*√l. κ = 1.1 then gives 0.6 ± 0.8i, of modulus 1, as (18) says",
        ),
        ..PLAIN
    },
    Item {
        id: "solution",
        place: "(16), (20)–(23)",
        title: "The solution of the linear map",
        printed: "δxₙ = c₁(0, 1, 0, 0) + c₂(0, 0, 1, 0) + 2 Re(c₃ e^(jσn) (a + jb, g, 0, h)), c₁ = δx₀ − (ρδθ₀/h) g",
        scene: ("case-2", &[]),
        ask: ("trajectories", "bounces=200"),
        picture: true,
        checks: |scene| {
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
        },
        why: Some(
            "(21)–(23) lack dots: c₁ = δẋ₀ − (ρδθ̇₀/h) g, c₂ = δẏ₀ − ẏ*, and the first two terms of c₃ have δθ̇₀. With the dots c₁ is the \
             drift of the balanced rod",
        ),
        ..PLAIN
    },
    Item {
        id: "stable-range",
        place: "(17), (18), (19)",
        title: "The stable range of the tilt gain",
        printed: "κ < 1: unstable; 1 < κ < 1 + Gρ²/(ẏ*²l): |λ₃,₄| = 1, stable; above: unstable",
        ask: ("stability", "bounces=2000"),
        checks: |scene| {
            let linear = small_deviations(scene).ok()?.linear;
            let upright = Upright::of(scene)?;
            Some(vec![
                Check::formula(["lower end", "κ", "1"], 1.0, linear.lower_tilt_gain),
                Check::formula(["upper end", "κ_c", "1"], 1.0 + upright.width(), linear.critical_tilt_gain),
                Check::formula(["largest modulus between them", "|λ|", "1"], 1.0, linear.spectral_radius()),
            ])
        },
        ..PLAIN
    },
];

/// Section 2.2.2: the critical gain of a lossy contact.
pub(super) const LOSSY_GAIN: Item = Item {
    id: "critical-gain-lossy",
    place: "(29)",
    title: "The critical tilt gain with restitution",
    printed: "κ_critical = 1 + 2Gρ²/((1 + e)ẏ*²l)",
    scene: ("case-4", &[]),
    ask: ("stability", "bounces=2000"),
    checks: |scene| {
        let upright = Upright::of(scene)?;
        let linear = small_deviations(scene).ok()?.linear;
        let printed = 1.0 + 2.0 * upright.width() / (1.0 + scene.parameters::<f64>().restitution);
        Some(vec![Check::formula(["critical tilt gain", "κ_c", "1"], printed, linear.critical_tilt_gain)])
    },
    why: Some(
        "κ_c does not depend on e: the table makes up for the loss, so that the strike is that of the lossless case. (18) holds, and Table 2's 1.28 is its value",
    ),
    ..PLAIN
};

/// Appendices B and C.
pub(super) const APPENDICES: [Item; 2] = [
    Item {
        id: "conservative",
        kind: Kind::Claim,
        place: "Appendix B",
        title: "Determinant and pairs of eigenvalues",
        printed: "det J = 1; with λ also 1/λ is an eigenvalue",
        ask: ("jacobians", "at.impact=1"),
        checks: |scene| {
            let linear = small_deviations(scene).ok()?.linear;
            let product: f64 = linear.eigenvalues.iter().copied().map(modulus).product();
            Some(vec![Check::formula(["product of the eigenvalues at the fixed point", "λ₃λ₄", "1"], 1.0, product)])
        },
        quoted: &[("case-1", Quantity::Determinant)],
        ..PLAIN
    },
    Item {
        id: "jordan",
        place: "(37), (38)",
        title: "At κ_critical",
        printed: "λ₃,₄ = 1; δxₙ = … + (c₃(−1)ⁿ + n c₄) V₃ + c₄(−1)ⁿ V₄",
        scene: ("critical-soft", &[]),
        ask: ("stability", "bounces=20000"),
        quoted: &[("critical-soft", Quantity::CriticalEigenvalue), ("critical-soft", Quantity::SecondPower)],
        ..PLAIN
    },
];
