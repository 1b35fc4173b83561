//! Quantities that the paper prints, with their values as this server computes them: from the linear verdict, from the derivative of
//! the return map, or from runs.
//!
//! Not here: the printed values, which stand with the presets.

use equipoise_physics::analysis::jacobian::jacobian_at;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::numbers::trig;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Contact, run};
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Serialize, Serializer};

/// A quantity with a printed and a computed value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    CriticalTiltGain,
    BoundedTiltGain,
    BoundedAngle,
    AngleGrowth,
    FixedPointSpeed,
    GravityInPlane,
    UpperEnergyGain,
    EnergyEigenvalue,
    TargetEnergy,
    SettledEnergy,
    SettledVerticalEnergy,
    HelpedFriction,
    RadiusOfGyration,
    ReleaseSpin,
    SettledSpin,
    EigenvalueOfAngle,
    CriticalEigenvalue,
    SecondPower,
    Determinant,
}

impl Serialize for Quantity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Price of a value in closed form or of a short run, in bounces.
const CHEAP: u64 = 100;

/// Contacts after which a run counts as bounded.
const BOUNDED: u64 = 10_000;

/// The first contacts of a run that are left out before an energy counts as settled, and the last that is taken in.
const SETTLED: (u64, u64) = (2000, 4000);

/// Contacts of a run whose angle grows slowly, and of the windows at its start and at its end.
const GROWN: (u64, u64) = (30_000, 1000);

/// Thousandths of the largest friction tried; it is looked for from there downwards.
const FRICTION_THOUSANDTHS: u32 = 300;

/// Energy gains tried between that of the scene and the upper one.
const ENERGY_GAINS: u32 = 8;

impl Quantity {
    /// Name in answers, symbol and unit, and the price of the computed value, in bounces.
    const fn row(self) -> ([&'static str; 3], u64) {
        match self {
            Self::CriticalTiltGain => (["tilt_gain.critical", "κ_c", "1"], CHEAP),
            Self::BoundedTiltGain => (["tilt_gain.bounded", "κ", "1"], 10 * BOUNDED),
            Self::BoundedAngle => (["theta.bounded", "θ₀", "rad"], 40 * BOUNDED),
            Self::AngleGrowth => (["theta.growth", "growth of |θ|", "1"], GROWN.0),
            Self::FixedPointSpeed => (["fixed_point.y_dot", "ẏ*", "m/s"], CHEAP),
            Self::GravityInPlane => (["gravity.in_plane", "G", "m/s²"], CHEAP),
            Self::UpperEnergyGain => (["energy_gain.upper", "κ_E,max", "s²/m²"], CHEAP),
            Self::EnergyEigenvalue => (["energy_gain.eigenvalue", "λ of ẏ", "1"], CHEAP),
            Self::TargetEnergy => (["energy.target", "E", "m²/s²"], CHEAP),
            Self::SettledEnergy => (["energy.settled", "E", "m²/s²"], SETTLED.1),
            Self::SettledVerticalEnergy => (["vertical_energy.settled", "η", "m²/s²"], SETTLED.1),
            // Runs with friction last a few contacts.
            Self::HelpedFriction => (["friction.helped", "μ", "1"], 20_000),
            Self::RadiusOfGyration => (["body.radius_of_gyration", "ρ", "m"], CHEAP),
            Self::ReleaseSpin => (["release.theta_dot", "θ̇₀", "rad/s"], CHEAP),
            Self::SettledSpin => (["settled.theta_dot", "θ̇", "rad/s"], CHEAP),
            Self::EigenvalueOfAngle => (["angle_eigenvalue.im", "Im λ", "1"], CHEAP),
            Self::CriticalEigenvalue => (["angle_eigenvalue.critical", "λ at κ_c", "1"], CHEAP),
            Self::SecondPower => (["angle_eigenvector.second", "factor of c₄V₃", "1"], CHEAP),
            Self::Determinant => (["jacobian.determinant", "det J", "1"], CHEAP),
        }
    }

    /// Name in answers.
    pub(crate) const fn name(self) -> &'static str {
        self.row().0[0]
    }

    /// Symbol in formulas.
    pub(crate) const fn symbol(self) -> &'static str {
        self.row().0[1]
    }

    /// Unit, "1" for a pure number.
    pub(crate) const fn unit(self) -> &'static str {
        self.row().0[2]
    }

    /// Price of the computed value, in bounces.
    pub(crate) fn price(self) -> u64 {
        self.row().1
    }

    /// The value and its source. None if the scene has no such value, or if `go_on`, which is asked now and then, says no.
    pub(crate) fn compute(self, scene: &Scene, go_on: &dyn Fn() -> bool) -> Option<(f64, &'static str)> {
        let small = small_deviations(scene).ok();
        let (fixed_point, linear) = small.map(|small| (small.fixed_point, small.linear)).unzip();
        Some(match self {
            Self::CriticalTiltGain => {
                (linear?.critical_tilt_gain, "eq. (18), with V on the energy surface of the fixed point")
            }
            Self::BoundedTiltGain => (
                bounded_tilt_gain(scene, linear?.critical_tilt_gain, go_on)?,
                "the largest of κ_c, κ_c − 0.01, … at which the run lasts 10,000 contacts",
            ),
            Self::BoundedAngle => (
                bounded_angle(scene, go_on)?,
                "the largest of 0.01, 0.02, … rad up to which all runs last 10,000 contacts",
            ),
            Self::AngleGrowth => {
                (growth(scene, go_on)?, "the largest |θ| of contacts 29,001 to 30,000 over that of the first 1000")
            }
            Self::FixedPointSpeed => (-fixed_point?.speed, "the fixed point"),
            Self::GravityInPlane => (scene.gravity(), "g sin φ"),
            Self::UpperEnergyGain => (linear?.upper_energy_gain, "2/((1 + e)V²)"),
            Self::EnergyEigenvalue => (linear?.energy_eigenvalue, "1 − (1 + e)κ_E V²"),
            // E = ½V² + Gl = G y*, from the top of the bounce.
            Self::TargetEnergy => (scene.gravity() * fixed_point?.apex_height, "G y*"),
            Self::SettledEnergy => {
                (settled_energies(scene, go_on)?.0, "mean of ½(ẋ² + ẏ² + ρ²θ̇²) + Gl cos θ over contacts 2001 to 4000")
            }
            Self::SettledVerticalEnergy => {
                (settled_energies(scene, go_on)?.1, "mean of ½ẏ² + Gl cos θ over contacts 2001 to 4000")
            }
            Self::HelpedFriction => (
                helped_friction(scene, linear?.upper_energy_gain, go_on)?,
                "the largest of 0.001, 0.002, … 0.3 at which a κ_E above the scene's and up to 2/((1 + e)V²) gives more contacts",
            ),
            Self::RadiusOfGyration => match scene.outline() {
                Some(outline) => (outline.radius_of_gyration, "the vertices"),
                None => {
                    // Isosceles triangle of base b and height h: ρ² = b²/24 + h²/18.
                    ((0.1_f64 * 0.1 / 24.0 + 0.2 * 0.2 / 18.0).sqrt(), "b²/24 + h²/18 = ρ², base 0.1 m, height 0.2 m")
                }
            },
            Self::ReleaseSpin => (scene.start().theta_dot, "the scene"),
            Self::SettledSpin => (settled_spin(scene, go_on)?, "the last contact before the bounces end"),
            Self::EigenvalueOfAngle => {
                let parts = linear?.eigenvalues.into_iter().map(|Complex { im, .. }| im);
                (parts.fold(0.0, f64::max), "2√(R(1 − R))")
            }
            Self::CriticalEigenvalue => (-1.0, "R = 1: period doubling, with one Jordan block"),
            Self::SecondPower => (second_power(scene)?, "J²V₄ = V₄ + (factor)V₃, with V₃ = (J + I)V₄"),
            Self::Determinant => (determinant(scene)?, "the derivative from contact 1 to contact 2"),
        })
    }
}

/// Ending of a run of a scene, and its contacts; None if the run is stopped or has no contact.
fn end_of(
    scene: &Scene,
    bounces: u64,
    go_on: &dyn Fn() -> bool,
    mut visit: impl FnMut(&Contact),
) -> Option<(Ending, u64)> {
    let mut orbit = scene.orbit().ok()?;
    let ending = run(&mut orbit, bounces, |contact| {
        visit(contact);
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    Some((ending, orbit.contacts()))
}

/// The scene with another number.
fn with(scene: &Scene, numbers: &[(Name, f64)]) -> Option<Scene> {
    let mut draft: Draft = scene.draft();
    for (name, number) in numbers {
        draft.set(*name, Some(Value::Number(*number))).ok()?;
    }
    draft.build().ok()
}

/// Tells whether the run of the scene with another number is bounded.
fn is_bounded(scene: &Scene, name: Name, number: f64, go_on: &dyn Fn() -> bool) -> bool {
    let changed = with(scene, &[(name, number)]);
    let end = changed.and_then(|scene| end_of(&scene, BOUNDED, go_on, |_| ()));
    end.is_some_and(|(ending, _)| ending == Ending::Completed)
}

/// The largest tilt gain at which the run is bounded, hundredth by hundredth from the critical one down to 1.
fn bounded_tilt_gain(scene: &Scene, critical: f64, go_on: &dyn Fn() -> bool) -> Option<f64> {
    let down = (0_u32..).map(|hundredths| critical - f64::from(hundredths) / 100.0);
    down.take_while(|&gain| gain > 1.0 && go_on()).find(|&gain| is_bounded(scene, Name::TiltGain, gain, go_on))
}

/// The largest angle at the release up to which all runs are bounded, hundredth by hundredth, rad.
fn bounded_angle(scene: &Scene, go_on: &dyn Fn() -> bool) -> Option<f64> {
    let angle = |hundredths: u32| f64::from(hundredths) / 100.0;
    let unbounded = (1_u32..).find(|&hundredths| !is_bounded(scene, Name::Theta, angle(hundredths), go_on))?;
    (unbounded > 1).then(|| angle(unbounded - 1))
}

/// The largest |θ| at the end of a long run over that at its start.
fn growth(scene: &Scene, go_on: &dyn Fn() -> bool) -> Option<f64> {
    let (contacts, window) = GROWN;
    let (mut first, mut last) = (0.0_f64, 0.0_f64);
    let (ending, _) = end_of(scene, contacts, go_on, |contact| {
        let theta = contact.state.theta.abs();
        if contact.n <= window {
            first = first.max(theta);
        } else if contact.n > contacts - window {
            last = last.max(theta);
        }
    })?;
    (ending == Ending::Completed).then_some(last / first)
}

/// Means of the energy and of η = ½ẏ² + Gl cos θ at the contacts of a run that has settled, m²/s².
fn settled_energies(scene: &Scene, go_on: &dyn Fn() -> bool) -> Option<(f64, f64)> {
    let rod = scene.parameters::<f64>();
    let (left_out, last) = SETTLED;
    let (mut energy, mut vertical) = (0.0, 0.0);
    let (ending, _) = end_of(scene, last, go_on, |contact| {
        if contact.n > left_out {
            let state = &contact.state;
            energy += rod.energy(state);
            let (_, cosine) = trig::sin_cos(state.theta);
            vertical += 0.5 * state.y_dot * state.y_dot + rod.gravity * rod.contact_distance * cosine;
        }
    })?;
    let count = (last - left_out) as f64;
    (ending == Ending::Completed).then_some((energy / count, vertical / count))
}

/// The largest friction at which a larger energy gain makes a run longer, in contacts; 0 where none does.
fn helped_friction(scene: &Scene, upper: f64, go_on: &dyn Fn() -> bool) -> Option<f64> {
    let own = scene.number(Name::EnergyGain)?;
    let contacts = |friction, energy_gain| {
        let changed = with(scene, &[(Name::Friction, friction), (Name::EnergyGain, energy_gain)])?;
        Some(end_of(&changed, BOUNDED, go_on, |_| ())?.1)
    };
    for friction in (1..=FRICTION_THOUSANDTHS).rev().map(|index| f64::from(index) / 1000.0) {
        let before = contacts(friction, own)?;
        let raised = |part: u32| own + (upper - own) * f64::from(part) / f64::from(ENERGY_GAINS);
        let gains = (1..=ENERGY_GAINS).map(raised);
        if gains.filter_map(|gain| contacts(friction, gain)).any(|after| after > before) {
            return Some(friction);
        }
    }
    Some(0.0)
}

/// θ̇ at the contact at which the bounces have died out, rad/s.
fn settled_spin(scene: &Scene, go_on: &dyn Fn() -> bool) -> Option<f64> {
    let mut spin = 0.0;
    let (ending, _) = end_of(scene, BOUNDED, go_on, |contact| spin = contact.state.theta_dot)?;
    matches!(ending, Ending::Settled { .. }).then_some(spin)
}

/// The derivative from the first contact of the scene's run to the second, or at its fixed point.
fn derivative(scene: &Scene, at_fixed_point: bool) -> Option<DMatrix<f64>> {
    let orbit = scene.orbit().ok()?;
    let mut state = *orbit.state();
    if at_fixed_point {
        state = small_deviations(scene).ok()?.fixed_point.state();
    }
    Some(jacobian_at(&scene.model(), orbit.x(), &state, 1).ok()?.matrix)
}

fn determinant(scene: &Scene) -> Option<f64> {
    Some(derivative(scene, false)?.determinant())
}

/// With J V₃ = −V₃ and J V₄ = −V₄ + V₃, eq. (37): the factor of V₃ in J²V₄ − V₄.
fn second_power(scene: &Scene) -> Option<f64> {
    let matrix = derivative(scene, true)?;
    let mut second = DVector::zeros(matrix.nrows());
    second[0] = 1.0;
    let once = &matrix * &second;
    let first = &once + &second;
    Some((&matrix * &once - &second).dot(&first) / first.dot(&first))
}
