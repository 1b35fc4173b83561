//! Equations of the paper, evaluated as printed. Those of the linearized map, (10)–(23), (29), (37) and (38), stand beside the derivative of the
//! map; those of strike and flight, (1)–(9), (24)–(28) and (30)–(36), are taken at the first contact of a run.

use equipoise_physics::analysis::jacobian::{jacobian, modulus};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::strike::{Rod, State, Strike};
use equipoise_physics::numbers::trig;
use equipoise_physics::scene::Name::{Friction, Strike as Striking, TiltGain};
use equipoise_physics::scene::Value::{Choice, Number};
use equipoise_physics::scene::{Name, Scene};
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

/// Case 4 in the middle of its swing, so that all terms differ from 0.
const LOSSY: (&str, &[(Name, equipoise_physics::scene::Value)]) =
    ("case-4", &[(Name::ThetaDot, Number(0.5)), (Name::XDot, Number(0.1))]);

/// Case 4 on a table that does not move.
const STILL: (&str, &[(Name, equipoise_physics::scene::Value)]) = (
    "case-4",
    &[
        (Striking, Choice("still")),
        (Name::EnergyGain, Number(0.0)),
        (Name::ThetaDot, Number(0.5)),
        (Name::XDot, Number(0.1)),
    ],
);

/// Case 1 with friction: the first contact slides.
const SLIDING: (&str, &[(Name, equipoise_physics::scene::Value)]) =
    ("case-1", &[(Friction, Number(0.02)), (Name::XDot, Number(0.3))]);

/// Section 2.1, the lossless strike and the flight.
pub(super) const LOSSLESS: [Item; 4] = [
    Item {
        id: "reflection",
        place: "(1), (2), (6)",
        title: "The lossless strike is a reflection",
        printed: "Δv = −2 (n̂ᵀv⁻) n̂ with n̂ = ρ/√(ρ² + l² sin²β) · (−sin α, cos α, (l/ρ) sin β); v⁺ = (I − 2n̂n̂ᵀ) v⁻",
        scene: ("case-1", &[(Name::ThetaDot, Number(0.5)), (Name::XDot, Number(0.1))]),
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            Some(first.compare(first.reflected(1.0, [0.0; 3])))
        },
        ..PLAIN
    },
    Item {
        id: "point-mass",
        place: "(3), (4), (5), Fig. 2, Fig. 3",
        title: "The angle of a ball's velocity shrinks geometrically",
        printed: "θₙ₊₁ = θₙ − 2αₙ, with α = κθ: θₙ = (1 − 2κ)ⁿ θ₀",
        scene: ("point-mass", &[(TiltGain, Number(0.3))]),
        ask: ("trajectories", "bounces=20"),
        picture: true,
        checks: |scene| {
            let mut orbit = scene.orbit().ok()?;
            let angle = |state: &State| libm::atan2(state.x_dot, -state.y_dot);
            let gain = scene.number(TiltGain)?;
            let start = angle(orbit.state());
            let contact = orbit.advance();
            let mut checks = vec![Check::formula(
                ["angle at contact 2", "θ₁", "rad"],
                start - 2.0 * contact.alpha,
                angle(orbit.state()),
            )];
            (0..4).for_each(|_| {
                orbit.advance();
            });
            let printed = (0..5).fold(start, |angle, _| angle * (1.0 - 2.0 * gain));
            checks.push(Check::formula(["angle at contact 6", "θ₅", "rad"], printed, angle(orbit.state())));
            Some(checks)
        },
        ..PLAIN
    },
    Item {
        id: "flight",
        place: "(7), (8)",
        title: "The flight and the time of the next contact",
        printed: "ẏ(t) = ẏ₀ − Gt; ẋ and ρθ̇ stay; l cos θ₀ + ẏ₀t − ½Gt² = l cos(θ₀ + θ̇₀t) at the next contact",
        ask: ("trajectories", "bounces=10&samples_per_flight=8"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let (l, gravity, tau) = (first.rod.contact_distance, first.rod.gravity, first.flight_time);
            let start = first.strike.after;
            let (_, there) = trig::sin_cos(start.theta + start.theta_dot * tau);
            let left = l * first.theta.1 + start.y_dot * tau - 0.5 * gravity * tau * tau;
            Some(vec![
                Check::formula(
                    ["velocity at the next contact", "ẏ", "m/s"],
                    start.y_dot - gravity * tau,
                    first.next.y_dot,
                ),
                Check::formula(["right side of (8) beside its left side", "l cos θ", "m"], left, l * there),
            ])
        },
        ..PLAIN
    },
    Item {
        id: "recurrence",
        place: "(9)",
        title: "The return map",
        printed: "xₙ₊₁ = f(α, xₙ, τ(xₙ)) with x = (ρθ, ẋ, ẏ, ρθ̇)",
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let [x_dot, y_dot, spin] = first.reflected(1.0, [0.0; 3]);
            let (tau, rho) = (first.flight_time, first.rod.radius_of_gyration);
            Some(vec![
                Check::formula(
                    ["angle at contact 2", "θ", "rad"],
                    first.before.theta + spin / rho * tau,
                    first.next.theta,
                ),
                Check::formula(["velocity at contact 2", "ẋ", "m/s"], x_dot, first.next.x_dot),
                Check::formula(
                    ["velocity at contact 2", "ẏ", "m/s"],
                    y_dot - first.rod.gravity * tau,
                    first.next.y_dot,
                ),
            ])
        },
        ..PLAIN
    },
];

/// Section 2.2: restitution, energy feedback, friction.
pub(super) const EXTENSIONS: [Item; 4] = [
    Item {
        id: "inelastic",
        place: "(24)",
        title: "A lossy strike of a moving table",
        printed: "v⁺ = (I − (1 + e) n̂n̂ᵀ) v⁻ + (1 + e) n̂n̂ᵀ v_table",
        scene: LOSSY,
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let (x, y) = first.strike.table_velocity;
            Some(first.compare(first.reflected(first.rod.restitution, [x, y, 0.0])))
        },
        ..PLAIN
    },
    Item {
        id: "compensation",
        place: "(25), (26), (27)",
        title: "The table makes up for the loss",
        printed: "v_table = −(1 − e)/(1 + e) v⁻, or −(1 − e)/(1 + e) n̂n̂ᵀ(ẋ_c, ẏ_c, 0) with ẋ_c = ẋ + lθ̇ cos θ, ẏ_c = ẏ + lθ̇ sin θ",
        scene: ("case-4", &[(Name::EnergyGain, Number(0.0)), (Name::ThetaDot, Number(0.5)), (Name::XDot, Number(0.1))]),
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let e = first.rod.restitution;
            let speed = -(1.0 - e) / (1.0 + e) * first.in_table_frame(first.contact_velocity()).1;
            let mut checks = first.compare(first.reflected(1.0, [0.0; 3]));
            checks.push(Check::formula(
                ["speed of the table along its normal", "v_table", "m/s"],
                speed,
                first.table_speed(),
            ));
            Some(checks)
        },
        why: Some(
            "With (25) the strike is that of the lossless case, as the paper says. As a velocity of the table, (27) needs the contact \
             point's speed along the normal itself: n̂ has length 1 in (x, y, ρθ) and not in the plane, so its first two components \
             alone would be too slow by ρ²/(ρ² + l² sin²β)",
        ),
        ..PLAIN
    },
    Item {
        id: "energy-feedback",
        place: "(28)",
        title: "Energy feedback",
        printed: "v_table = −[(1 − e)/(1 + e) + κ_E(η* − η)] v_contact, η* = Gy*, η = Gl cos θ + ½ẏ²",
        scene: LOSSY,
        ask: ("trajectories", "bounces=100"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let Rod { gravity, contact_distance, restitution: e, .. } = first.rod;
            let target = gravity * scene.number(Name::TargetHeight)?;
            let eta = gravity * contact_distance * first.theta.1 + 0.5 * first.before.y_dot * first.before.y_dot;
            let factor = (1.0 - e) / (1.0 + e) + scene.number(Name::EnergyGain)? * (target - eta);
            let speed = -factor * first.in_table_frame(first.contact_velocity()).1;
            Some(vec![Check::formula(
                ["speed of the table along its normal", "v_table", "m/s"],
                speed,
                first.table_speed(),
            )])
        },
        ..PLAIN
    },
    Item {
        id: "friction-moment",
        place: "(30), Fig. 10",
        title: "The moment of an impulse with friction",
        printed: "M = P_n l sin β + P_t l cos β, with P_t = μP_n sgn(−v_tc) while it slides",
        scene: SLIDING,
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
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
        },
        ..PLAIN
    },
];

/// Appendix A, the dynamics of an impact.
pub(super) const IMPACT: [Item; 3] = [
    Item {
        id: "impulses",
        place: "(31), (32), (33)",
        title: "Impulses and the velocity of the contact point",
        printed: "v_t − v_t0 = P_t, v_n − v_n0 = P_n, ρ²(ω − ω₀) = P_t l cos β + P_n l sin β (m = 1); v_tc = v_t + lω cos β, v_nc = v_n + lω sin β",
        scene: SLIDING,
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let Strike { after, impulse_normal, impulse_tangential, normal_velocity, .. } = first.strike;
            let before = first.in_table_frame((first.before.x_dot, first.before.y_dot));
            let then = first.in_table_frame((after.x_dot, after.y_dot));
            let (sine, cosine) = first.arms();
            let rho2 = first.rho_squared();
            // Eq. (33) along the normal, beside (32) after the strike.
            let start = before.1 + first.before.theta_dot * sine;
            let printed =
                start + sine * cosine / rho2 * impulse_tangential + (rho2 + sine * sine) / rho2 * impulse_normal;
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
        },
        ..PLAIN
    },
    Item {
        id: "newton",
        place: "(34), (35)",
        title: "Newton's impact without friction",
        printed: "P_t = 0, P_n = −(1 + e) ρ²/(ρ² + l² sin²β) v_nc0, P_ω = l sin β P_n (m = 1)",
        scene: STILL,
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            let Strike { impulse_normal, impulse_tangential, normal_velocity, .. } = first.strike;
            let printed = -(1.0 + first.rod.restitution) * first.share() * normal_velocity;
            Some(vec![
                Check::formula(["tangential impulse per unit mass", "P_t", "m/s"], 0.0, impulse_tangential),
                Check::formula(["normal impulse per unit mass", "P_n", "m/s"], printed, impulse_normal),
                Check::formula(["moment per unit mass", "P_ω", "m²/s"], first.arms().0 * printed, first.moment()),
            ])
        },
        ..PLAIN
    },
    Item {
        id: "lossy-reflection",
        place: "(36)",
        title: "The strike in the axes of the plane",
        printed: "Δv = −(1 + e) n̂n̂ᵀ v⁻",
        scene: STILL,
        ask: ("trajectories", "bounces=10"),
        checks: |scene| {
            let first = FirstContact::of(scene)?;
            Some(first.compare(first.reflected(first.rod.restitution, [0.0; 3])))
        },
        ..PLAIN
    },
];
