//! The presets: the paper's cases and those beside them, with the numbers that the paper prints beside computed ones.
//!
//! A scene is a list of fields by name, so the compiler refuses fields that do not exist. A test builds every scene.

use std::f64::consts::FRAC_PI_4;
use std::sync::OnceLock;

use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::map::{friction, strike};
use equipoise_physics::scene::Name::{
    AngleSd, ContactDistance, ContactVertex, Drag, EnergyGain, EnergyLaw, EnergyMeasure, FeedbackTheta,
    FeedbackThetaDot, FeedbackX, FeedbackXDot, Friction, Height, Incline, PointMass, Program, RadiusOfGyration,
    Restitution, RotationDrag, Slide, SpeedLimit, Strike, StrokeLimit, TargetHeight, Theta, ThetaDot, TiltGain,
    TiltLimit, TimingSd, XDot,
};
use equipoise_physics::scene::Value::{Choice, Flag, Integer, Number, Numbers};
use equipoise_physics::scene::{Draft, Name, Striking, Value as FieldValue};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use crate::api::scene::Derived;
use crate::api::scene::fields::{PresetName, ScenePatch};
use crate::api::scene::quantity::Quantity;
use crate::api::scene::write::{Resolved, nested, value_to_json};
use crate::schema_names;

/// All presets.
pub fn all() -> &'static [Preset] {
    &PRESETS
}

/// The preset of this name.
pub fn find(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The names of all presets.
pub fn names() -> Vec<&'static str> {
    PRESETS.iter().map(|preset| preset.name).collect()
}

/// Meaning of the names of quantities, in the contract.
const QUANTITIES: &str = "A quantity: as in `stability` (`tilt_gain.critical`, `fixed_point.y_dot`, `energy_gain.upper`, `energy_gain.eigenvalue`); as in \
    the scene (`body.radius_of_gyration`, `release.theta_dot`); gravity · sin(incline) (`gravity.in_plane`); the largest tilt gain, \
    and angle at the release, up to which runs stay bounded (`tilt_gain.bounded`, `theta.bounded`); the swing late in a long run \
    over that at its start (`theta.growth`); the energy of the bounce in place (`energy.target`); means of the energy, and of η = \
    ½ẏ² + Gl cos θ, over late contacts (`energy.settled`, `vertical_energy.settled`); the friction up to which a larger energy gain \
    gives a run more contacts (`friction.helped`); the angular velocity at the end of the bounces (`settled.theta_dot`); of the \
    angle block, the imaginary part of an eigenvalue, the eigenvalue at κ_c, and there the factor of c₄V₃ in the second bounce of \
    eq. (38) (`angle_eigenvalue.im`, `angle_eigenvalue.critical`, `angle_eigenvector.second`); or the determinant from the first \
    contact to the second (`jacobian.determinant`).";

/// Schema of the names of all quantities that presets quote.
pub fn quantity_names() -> Value {
    json!({"type": "string", "enum": quantities(), "description": QUANTITIES})
}

/// Names of all quantities that presets quote.
fn quantities() -> Vec<&'static str> {
    let mut names = Vec::new();
    for printed in PRESETS.iter().flat_map(|preset| preset.printed) {
        if !names.contains(&printed.quantity.name()) {
            names.push(printed.quantity.name());
        }
    }
    names
}

/// A scene with a name.
#[derive(Debug, Clone)]
pub struct Preset {
    /// Name in requests.
    pub name: &'static str,
    title: &'static str,
    shows: &'static str,
    scene: &'static [(Name, FieldValue)],
    /// Vertices of a polygon, m; `None` for other bodies.
    vertices: &'static [[f64; 2]],
    printed: &'static [Printed],
    /// The answer, once it has been computed.
    shown: OnceLock<Shown>,
}

/// A preset, of a body that is no polygon unless there are vertices.
const fn preset(
    name: &'static str,
    title: &'static str,
    shows: &'static str,
    scene: &'static [(Name, FieldValue)],
    vertices: &'static [[f64; 2]],
    printed: &'static [Printed],
) -> Preset {
    Preset { name, title, shows, scene, vertices, printed, shown: OnceLock::new() }
}

/// A number as the paper prints it, and why the computed one differs, if it does.
#[derive(Debug, Clone, Copy)]
struct Printed {
    quantity: Quantity,
    /// None if the paper leaves it out.
    value: Option<f64>,
    place: &'static str,
    why: Option<&'static str>,
    /// Fields that are changed for the computed value.
    with: &'static [(Name, FieldValue)],
}

schema_names! {
    QuantityName;
}

/// A number of a preset, printed or computed.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Quantity")]
struct Quoted {
    #[schemars(with = "QuantityName")]
    quantity: Quantity,
    symbol: &'static str,
    /// "1" for a number without unit.
    unit: &'static str,
    /// Null if the paper leaves it out, or states it in words.
    value: Option<f64>,
    /// Printed: table, equation or section. Computed: source of the value.
    r#where: &'static str,
    /// Reason for a difference between computed and printed value.
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<&'static str>,
    /// Changes to the scene for the computed value.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<ScenePatch>")]
    with: Option<Value>,
}

/// A preset as it is answered.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Preset")]
pub struct Shown {
    #[schemars(with = "PresetName")]
    name: &'static str,
    /// A short title.
    title: &'static str,
    /// What the scene demonstrates, in a sentence.
    shows: &'static str,
    scene: Resolved,
    derived: Derived,
    /// The values that the paper prints.
    printed: Vec<Quoted>,
    /// The same quantities, in the same order, as this server computes them.
    computed: Vec<Quoted>,
}

impl Shown {
    /// A quantity's printed value, its computed value, and why they differ.
    pub(crate) fn pair(&self, quantity: Quantity) -> Option<(Option<f64>, f64, Option<&'static str>)> {
        let printed = self.printed.iter().find(|quoted| quoted.quantity == quantity)?;
        let computed = self.computed.iter().find(|quoted| quoted.quantity == quantity)?;
        Some((printed.value, computed.value?, computed.why))
    }
}

impl Preset {
    /// The scene, to change and build.
    pub fn draft(&self) -> Draft {
        let mut draft = Draft::default();
        put(&mut draft, self.scene);
        if !self.vertices.is_empty() {
            draft.set_vertices(Vertices::new(self.vertices).ok());
        }
        draft
    }

    /// The answer: the resolved scene, and printed values beside computed ones, some of which are of runs. Computed once. None if
    /// `go_on` says no before it is complete.
    pub fn shown(&self, go_on: &dyn Fn() -> bool) -> Option<&Shown> {
        if self.shown.get().is_none() {
            let shown = self.compute(go_on).filter(|_| go_on())?;
            // Another thread that was faster has set the same.
            let _ = self.shown.set(shown);
        }
        self.shown.get()
    }

    /// Price of the answer, in bounces.
    pub fn price(&self) -> u64 {
        if self.shown.get().is_some() { 0 } else { self.printed.iter().map(|it| it.quantity.price()).sum() }
    }

    fn compute(&self, go_on: &dyn Fn() -> bool) -> Option<Shown> {
        // A test builds every preset.
        let scene = self.draft().build().ok()?;
        Some(Shown {
            name: self.name,
            title: self.title,
            shows: self.shows,
            scene: Resolved(scene),
            derived: Derived::of(&scene),
            printed: self.printed.iter().map(Printed::quoted).collect(),
            computed: self.printed.iter().filter_map(|it| it.computed(self.draft(), go_on)).collect(),
        })
    }
}

/// Sets fields of a draft. A test builds every scene of a preset, so there is nothing to report.
fn put(draft: &mut Draft, values: &[(Name, FieldValue)]) {
    for &(name, value) in values {
        let _ = draft.set(name, Some(value));
    }
}

impl Printed {
    const fn new(quantity: Quantity, value: f64, place: &'static str) -> Self {
        Self { value: Some(value), ..Self::without_value(quantity, place) }
    }

    /// A quantity that the paper uses and does not state.
    const fn without_value(quantity: Quantity, place: &'static str) -> Self {
        Self { quantity, value: None, place, why: None, with: &[] }
    }

    const fn because(self, why: &'static str) -> Self {
        Self { why: Some(why), ..self }
    }

    const fn with(self, with: &'static [(Name, FieldValue)]) -> Self {
        Self { with, ..self }
    }

    fn quoted(&self) -> Quoted {
        let Self { quantity, value, place, .. } = *self;
        let (symbol, unit) = (quantity.symbol(), quantity.unit());
        Quoted { quantity, symbol, unit, value, r#where: place, why: None, with: None }
    }

    fn computed(&self, mut draft: Draft, go_on: &dyn Fn() -> bool) -> Option<Quoted> {
        put(&mut draft, self.with);
        let (value, r#where) = self.quantity.compute(&draft.build().ok()?, go_on)?;
        let changes = self.with.iter().map(|&(name, value)| (name.row().path, as_given(value)));
        let with = (!self.with.is_empty()).then(|| nested(changes));
        Some(Quoted { value: Some(value), r#where, why: self.why, with, ..self.quoted() })
    }
}

/// A value as a person writes it: whole numbers without a decimal point.
fn as_given(value: FieldValue) -> Value {
    match value {
        FieldValue::Number(number) if number.fract() == 0.0 => Value::from(number as i64),
        value => value_to_json(value),
    }
}

/// l of the paper's triangle, m.
const LENGTH: (Name, FieldValue) = (ContactDistance, Number(0.4 / 3.0));

/// ρ by the paper's formula, m.
const RHO: (Name, FieldValue) = (RadiusOfGyration, Number(0.09428090415820635));

/// ρ of a triangle 0.1 m wide and 0.2 m high, m.
const TRUE_RHO: (Name, FieldValue) = (RadiusOfGyration, Number(0.05137011669140814));

/// A table that moves along itself with the contact point.
const MATCHED: (Name, FieldValue) = (Slide, Choice(friction::Slide::Matched.name()));

/// State feedback of `/v1/controllers` for a `matched` contact that sticks, with restitution 0.8 and bounces of 0.25 m.
const MATCHED_FEEDBACK: [(Name, FieldValue); 4] = [
    (FeedbackX, Number(0.027)),
    (FeedbackTheta, Number(-1.308)),
    (FeedbackXDot, Number(0.0381)),
    (FeedbackThetaDot, Number(-0.0682)),
];

const PRINTED_RHO: &str = "the printed radius of gyration is not that of the triangle; the paper's tables were computed with the printed one, and so are these cases";

#[rustfmt::skip]
static PRESETS: [Preset; 22] = [
    preset("case-1", "Case 1: dropped at an angle",
        "Released at rest at 0.3 rad, the rod circles about upright in ⟨θ, θ̇⟩ and ⟨ẋ, ẏ⟩ and never falls (Fig. 5).",
        &[LENGTH, RHO, (TiltGain, Number(1.1)), (Height, Number(0.2)), (Theta, Number(0.3))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.5, "Table 1"),
            Printed::new(Quantity::RadiusOfGyration, 0.09428, "section 2.1.2")
                .because(PRINTED_RHO),
            Printed::new(Quantity::FixedPointSpeed, -1.1937, "eq. (10)")
                .because("eq. (10) has l cos θ, which gives the speed of the first impact; the fixed point on the energy surface of the release has l, as Table 1 has for κ_critical, and less the energy of the drift"),
            Printed::new(Quantity::EigenvalueOfAngle, 0.3341, "eq. (15) as printed")
                .because("eq. (15) has 2ẏ*²l before the two roots and needs 2ẏ*√l; as printed, λ₃,₄ = 0.6 ± 0.334i have the modulus 0.687, against eq. (18)"),
            Printed::new(Quantity::Determinant, 1.0, "Appendix B")
                .because("the table tilts with the body, so the map does not keep volumes: det J = −ẏ_c⁺/ẏ_c⁻ of the next contact, which is 1 at the fixed point only. The map is reversible instead"),
            Printed::new(Quantity::BoundedAngle, 0.4, "section 2.1.3")
                .because("from 0.4 rad the run ends at its third contact, where the table would have to pull; from 0.34 rad it ends at contact 3167"),
        ]),
    preset("case-2", "Case 2: dropped with a spin",
        "Released upright with a spin of 0.1 rad/s, the rod circles and drifts sideways for ever (Table 1; Fig. 6 shows twice the spin).",
        &[LENGTH, RHO, (TiltGain, Number(1.1)), (Height, Number(0.2)), (Theta, Number(0.0)), (ThetaDot, Number(0.1))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.5, "Table 1")
                .because("the energy of the drift, −0.0733 m/s, never comes back to the bounce, which lowers V and raises κ_c"),
        ]),
    preset("case-2-figure", "Case 2 as drawn",
        "The spin of 0.2 rad/s that Fig. 6 was drawn with, twice that of Table 1.",
        &[LENGTH, RHO, (TiltGain, Number(1.1)), (Height, Number(0.2)), (Theta, Number(0.0)), (ThetaDot, Number(0.2))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.5, "Table 1")
                .because("the energy of the drift, −0.147 m/s, never comes back to the bounce, which lowers V and raises κ_c"),
            Printed::new(Quantity::ReleaseSpin, 0.1, "Table 1, case 2")
                .because("the caption of Fig. 6 has 0.2 rad/s; both are presets"),
        ]),
    preset("case-3", "Case 3: too much tilt",
        "Beyond κ_c = 1.5 the swings grow until the rod falls at its 49th contact (Fig. 7).",
        &[LENGTH, RHO, (TiltGain, Number(1.55)), (Height, Number(0.2)), (Theta, Number(0.1))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.5, "Table 1"),
        ]),
    preset("case-4", "Case 4: lossy, steered to a height",
        "Restitution 0.5 on an incline of 45°: the table makes up the loss and steers the bounce to 0.25 m (Fig. 8).",
        &[LENGTH, RHO, (Incline, Number(FRAC_PI_4)), (Restitution, Number(0.5)), (TiltGain, Number(1.1)), (EnergyGain, Number(0.165)), (TargetHeight, Number(0.25)), (Height, Number(0.2)), (Theta, Number(0.3))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.28, "Table 2, eq. (29)")
                .because("eq. (29) makes κ_c depend on restitution; it does not: eq. (18) holds, and Table 2 is its value"),
            Printed::new(Quantity::FixedPointSpeed, -1.27, "Table 2"),
            Printed::new(Quantity::TargetEnergy, 1.73, "Table 2"),
            Printed::new(Quantity::UpperEnergyGain, 1.653, "section 2.2.2")
                .because("the energy is held up to half of the printed limit: the eigenvalue is 1 − (1 + e)κ_E ẏ*²"),
            Printed::new(Quantity::EnergyEigenvalue, 0.9, "section 2.2.2, 1 − κ_E/κ_E,max")
                .because("the eigenvalue is 1 − (1 + e)κ_E ẏ*²: a gain of a tenth of the printed limit takes away 40 % of a deviation at every bounce, not 10 %"),
            Printed::without_value(Quantity::GravityInPlane, "Table 2 and Figs. 8 and 9 do not state it")
                .because("an incline of 45° gives the ẏ*, the E and the κ_E of about 0.1 κ_E,max that the paper prints"),
            Printed::new(Quantity::SettledEnergy, 1.73, "section 2.2.2 and Fig. 8, \"converges to the correct level\"")
                .because("the table steers η = ½ẏ² + Gl cos θ and not the energy, and the rod goes on swinging: what the swing and the sideways motion have comes on top"),
            Printed::new(Quantity::SettledVerticalEnergy, 1.73, "section 2.2.2"),
            Printed::without_value(Quantity::HelpedFriction, "section 2.2.3, \"increasing κ_E also prolongs the time that the object can be kept upright\"")
                .because("with more friction the run ends at the same contact or before it; in seconds it lasts a little longer, as the bounces are higher. The largest such μ grows with κ: it is 0.058 at κ = 1.2 and 0.08 at κ = 1.28"),
        ]),
    preset("case-5", "Case 5: lossy, dropped with a spin",
        "As case 4, released upright with a spin of 0.1 rad/s (Fig. 9).",
        &[LENGTH, RHO, (Incline, Number(FRAC_PI_4)), (Restitution, Number(0.5)), (TiltGain, Number(1.1)), (EnergyGain, Number(0.165)), (TargetHeight, Number(0.25)), (Height, Number(0.2)), (Theta, Number(0.0)), (ThetaDot, Number(0.1))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.28, "Table 2, eq. (29)")
                .because("eq. (29) makes κ_c depend on restitution; it does not: eq. (18) holds, and Table 2 is its value"),
            Printed::new(Quantity::FixedPointSpeed, -1.27, "Table 2"),
            Printed::new(Quantity::TargetEnergy, 1.73, "Table 2"),
            Printed::new(Quantity::UpperEnergyGain, 1.653, "section 2.2.2")
                .because("the energy is held up to half of the printed limit: the eigenvalue is 1 − (1 + e)κ_E ẏ*²"),
            Printed::new(Quantity::EnergyEigenvalue, 0.9, "section 2.2.2, 1 − κ_E/κ_E,max")
                .because("the eigenvalue is 1 − (1 + e)κ_E ẏ*²: a gain of a tenth of the printed limit takes away 40 % of a deviation at every bounce, not 10 %"),
            Printed::without_value(Quantity::GravityInPlane, "Table 2 and Figs. 8 and 9 do not state it")
                .because("an incline of 45° gives the ẏ*, the E and the κ_E of about 0.1 κ_E,max that the paper prints"),
            Printed::new(Quantity::AngleGrowth, 1.0, "section 2.2.2, \"then similar to the lossless case\"")
                .because("the lossless swing keeps its size. Energy feedback makes this one grow until |θ| reaches 0.354 rad after some 23,000 contacts: see lyapunov of /v1/stability"),
        ]),
    preset("critical-soft", "At κ_c: soft",
        "Exactly at κ_c the eigenvalues are silent. Here the boundary coefficient is 0.667: the swings stay bounded, as the paper's simulations did (Appendix C).",
        &[LENGTH, RHO, (TiltGain, Number(1.5)), (Height, Number(0.2)), (Theta, Number(0.01))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.5, "Table 1"),
            Printed::new(Quantity::CriticalEigenvalue, 1.0, "Appendix C")
                .because("both eigenvalues are −1: the swings change side at every bounce"),
            Printed::new(Quantity::BoundedAngle, 0.15, "section 2.1.3, up to and including κ_critical")
                .because("at κ_c runs from 0.15 rad fall within 100 contacts; those from 0.1 rad are still bounded after 100,000"),
            Printed::new(Quantity::BoundedTiltGain, 1.5, "section 2.1.3, from 0.15 rad")
                .because("from 0.15 rad runs just below κ_c fall too, and so does one at κ = 1.27, beside the resonance of order 4")
                .with(&[(Theta, Number(0.15))]),
            Printed::new(Quantity::SecondPower, 2.0, "Appendix C, eq. (38) at n = 2")
                .because("with λ = −1 the term is n(−1)^(n−1)c₄V₃: eq. (38) lacks the sign (−1)^(n−1)"),
        ]),
    preset("critical-hard", "At κ_c: hard",
        "The triangle's own radius of gyration turns the boundary coefficient negative, −0.188: at κ_c it falls at contact 71.",
        &[LENGTH, TRUE_RHO, (TiltGain, Number(1.1484375)), (Height, Number(0.2)), (Theta, Number(0.01))], &[],
        &[
            Printed::new(Quantity::RadiusOfGyration, 0.09428, "section 2.1.2")
                .because(PRINTED_RHO),
        ]),
    preset("true-triangle", "The triangle as it really is",
        "Case 1 with the radius of gyration that a triangle 0.1 m wide and 0.2 m high has: the range of stable κ shrinks from 1.5 to 1.148.",
        &[LENGTH, TRUE_RHO, (TiltGain, Number(1.07)), (Height, Number(0.2)), (Theta, Number(0.1))], &[],
        &[
            Printed::new(Quantity::RadiusOfGyration, 0.09428, "section 2.1.2")
                .because(PRINTED_RHO),
        ]),
    preset("triangle-polygon", "The triangle drawn as it is",
        "Case 1 with the paper's triangle as a polygon, 0.1 m wide and 0.2 m high on its apex: l and ρ follow from it, and no other vertex comes nearer to the table than 0.19 m. Case 1 is the same triangle with ρ as printed.",
        &[(ContactVertex, Integer(0)), (TiltGain, Number(1.1)), (Height, Number(0.2)), (Theta, Number(0.3))], &[[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]],
        &[
            Printed::new(Quantity::RadiusOfGyration, 0.09428, "section 2.1.2")
                .because("the printed radius of gyration is not that of the triangle"),
            Printed::new(Quantity::CriticalTiltGain, 1.5, "Table 1")
                .because("κ_c − 1 goes with ρ², and the triangle's ρ is 0.05137 m"),
        ]),
    preset("point-mass", "A point mass",
        "The paper's opening example: the angle of the velocity shrinks by 1 − 2κ at every bounce (eq. 4).",
        &[(PointMass, Flag(true)), (TiltGain, Number(0.4)), (Height, Number(0.2)), (XDot, Number(0.5))], &[],
        &[
            Printed::new(Quantity::CriticalTiltGain, 1.0, "section 2.1"),
        ]),
    preset("still-lossy", "A table that stands still",
        "With restitution 0.8 and nothing to make up for it, the bounces shrink to nothing in finite time (Zeno). Only they end there: what turns goes on turning.",
        &[LENGTH, RHO, (Restitution, Number(0.8)), (TiltGain, Number(0.0)), (Strike, Choice(Striking::Still.name())), (Height, Number(0.2)), (XDot, Number(0.1))], &[],
        &[
            Printed::new(Quantity::SettledSpin, 0.0, "section 3, to settle is to have zero relative velocity")
                .because("settled says that the bounces have died out in a finite time. The contact point stays on the table from then on, and the body goes on to turn: here, on a level table that stands still, it falls over")
                .with(&[(Restitution, Number(0.1)), (Theta, Number(0.1)), (XDot, Number(0.0))]),
        ]),
    preset("case-1-noise", "Case 1 with noise",
        "Case 1 on a table that errs by 10 ms in time (standard deviation) and meets the rod wherever it then is: of many runs some 45 % survive 400 bounces; with noise.model `plan` some 8 %, and half fall within 10.",
        &[LENGTH, RHO, (TiltGain, Number(1.1)), (Height, Number(0.2)), (Theta, Number(0.3)), (TimingSd, Number(0.01))], &[],
        &[]),
    preset("case-4-noise", "Case 4 with noise",
        "Case 4 on a table that errs by 10 ms in time (standard deviation): some 91 % of many runs survive 400 bounces; with noise.model `plan` some 11 %.",
        &[LENGTH, RHO, (Incline, Number(FRAC_PI_4)), (Restitution, Number(0.5)), (TiltGain, Number(1.1)), (EnergyGain, Number(0.165)), (TargetHeight, Number(0.25)), (Height, Number(0.2)), (Theta, Number(0.3)), (TimingSd, Number(0.01))], &[],
        &[]),
    preset("case-4-total", "Case 4 on its total energy",
        "Case 4 on a table that measures the energy of sideways motion and spin too: the energy comes to its target, and the swing keeps its size.",
        &[LENGTH, RHO, (Incline, Number(FRAC_PI_4)), (Restitution, Number(0.5)), (TiltGain, Number(1.1)), (EnergyGain, Number(0.165)), (TargetHeight, Number(0.25)), (EnergyMeasure, Choice(strike::EnergyMeasure::Total.name())), (Height, Number(0.2)), (Theta, Number(0.3))], &[],
        &[
            Printed::new(Quantity::TargetEnergy, 1.73, "Table 2"),
            Printed::new(Quantity::SettledEnergy, 1.73, "section 2.2.2 and Fig. 8, \"converges to the correct level\""),
            Printed::new(Quantity::AngleGrowth, 1.0, "section 2.2.2, \"then similar to the lossless case\""),
        ]),
    preset("air-table", "Case 4 on an air table",
        "Case 4 with the drag of an air table, 5 % of velocity and spin a second: the swing dies out, and the bounces settle somewhat below their target, because the law of the table does not know the air.",
        &[LENGTH, RHO, (Incline, Number(FRAC_PI_4)), (Drag, Number(0.05)), (RotationDrag, Number(0.05)), (Restitution, Number(0.5)), (TiltGain, Number(1.1)), (EnergyGain, Number(0.165)), (TargetHeight, Number(0.25)), (Height, Number(0.2)), (Theta, Number(0.3))], &[],
        &[]),
    preset("juggling", "Juggling",
        "Heights of 0.2 m and 0.3 m in turn: each strike brings the energy exactly to the next one.",
        &[LENGTH, RHO, (TiltGain, Number(1.1)), (EnergyLaw, Choice(strike::EnergyLaw::OneStrike.name())), (Program, Numbers(HeightProgram::of([0.2, 0.3]))), (Height, Number(0.25)), (Theta, Number(0.02))], &[],
        &[]),
    preset("rough-matched", "Friction: a table that moves along",
        "Friction 0.3 on a table that moves along itself with the contact point: the rod circles for ever. Friction widens the stable tilt gains from below 1.5 to below 2.5. A table that only tilts loses the rod within 10 bounces.",
        &[LENGTH, RHO, (Friction, Number(0.3)), MATCHED, (TiltGain, Number(1.8)), (Height, Number(0.2)), (Theta, Number(0.1))], &[],
        &[]),
    preset("rough-feedback", "Friction: state feedback",
        "Friction 0.3 on a table that only tilts. A tilt by place, angle and velocities, designed by /v1/controllers for a contact that sticks, brings the rod to rest above one place.",
        &[LENGTH, RHO, (Friction, Number(0.3)), (FeedbackX, Number(0.06)), (FeedbackTheta, Number(-3.2)), (FeedbackXDot, Number(1.08)), (FeedbackThetaDot, Number(-0.072)), (Height, Number(0.2)), (Theta, Number(0.1))], &[],
        &[]),
    preset("rough-noise", "A rig with friction, loss and noise",
        "Restitution 0.8, friction 0.3, and a table that errs by 5 ms and 5 mrad (standard deviations): state feedback and energy feedback keep the rod up, in all of 1000 runs of 2000 bounces.",
        &[LENGTH, RHO, (Restitution, Number(0.8)), (Friction, Number(0.3)), MATCHED, MATCHED_FEEDBACK[0], MATCHED_FEEDBACK[1], MATCHED_FEEDBACK[2], MATCHED_FEEDBACK[3], (EnergyGain, Number(0.2)), (TargetHeight, Number(0.25)), (Height, Number(0.25)), (Theta, Number(0.1)), (TimingSd, Number(0.005)), (AngleSd, Number(0.005))], &[],
        &[]),
    preset("rough-catch", "A rig to catch on",
        "The same rod and contact on a table that errs by nothing and has limits: tilt 0.35 rad, speed 1 m/s, stroke 30 mm. Within them /v1/catches holds the rod, from its release and from any bounce of its run.",
        &[LENGTH, RHO, (Restitution, Number(0.8)), (Friction, Number(0.3)), MATCHED, MATCHED_FEEDBACK[0], MATCHED_FEEDBACK[1], MATCHED_FEEDBACK[2], MATCHED_FEEDBACK[3], (EnergyGain, Number(0.2)), (TargetHeight, Number(0.25)), (TiltLimit, Number(0.35)), (SpeedLimit, Number(1.0)), (StrokeLimit, Number(0.03)), (Height, Number(0.25)), (Theta, Number(0.15))], &[],
        &[]),
    preset("rough-juggling", "Juggling on a rig",
        "The rig with friction, loss and noise, with targets of 0.2 m and 0.3 m in turn. Energy feedback gives about 0.21 m and 0.27 m, and all of 1000 runs last 2000 bounces.",
        &[LENGTH, RHO, (Restitution, Number(0.8)), (Friction, Number(0.3)), MATCHED, MATCHED_FEEDBACK[0], MATCHED_FEEDBACK[1], MATCHED_FEEDBACK[2], MATCHED_FEEDBACK[3], (EnergyGain, Number(0.2)), (Program, Numbers(HeightProgram::of([0.2, 0.3]))), (Height, Number(0.25)), (Theta, Number(0.1)), (TimingSd, Number(0.005)), (AngleSd, Number(0.005))], &[],
        &[]),
];

#[cfg(test)]
mod tests {
    use std::sync::OnceLock;

    use equipoise_physics::scene::Draft;

    use super::*;

    fn shown(preset: &Preset) -> &Shown {
        preset.shown(&|| true).unwrap()
    }

    #[test]
    fn every_preset_builds_and_computes_what_it_quotes() {
        for preset in all() {
            let built = preset.draft().build();
            assert!(built.is_ok(), "{}: {built:?}", preset.name);
            let mut draft = Draft::default();
            let all = preset.scene.iter().chain(preset.printed.iter().flat_map(|printed| printed.with));
            assert!(all.into_iter().all(|&(name, value)| draft.set(name, Some(value)).is_ok()), "{}", preset.name);
            assert_eq!(preset.draft().vertices().is_some(), !preset.vertices.is_empty(), "{}", preset.name);
            let shown = shown(preset);
            assert_eq!(shown.printed.len(), shown.computed.len(), "{}", preset.name);
            assert!(shown.computed.iter().all(|it| it.value.is_some_and(f64::is_finite)), "{}", preset.name);
        }
    }

    #[test]
    fn a_value_that_differs_from_the_printed_one_says_why() {
        for preset in all() {
            let shown = shown(preset);
            for (printed, computed) in shown.printed.iter().zip(&shown.computed) {
                let (Some(print), Some(value)) = (printed.value, computed.value) else {
                    assert!(computed.why.is_some(), "{}: {printed:?} {computed:?}", preset.name);
                    continue;
                };
                let same = (print - value).abs() <= 0.004 * print.abs();
                assert!(same || computed.why.is_some(), "{}: {printed:?} {computed:?}", preset.name);
            }
        }
    }

    #[test]
    fn whoever_leaves_ends_the_work_and_leaves_nothing_half_done() {
        let preset = find("case-1").unwrap().clone();
        let fresh = Preset { shown: OnceLock::new(), ..preset };
        assert!(fresh.price() > 100_000);
        let asked = std::cell::Cell::new(0);
        let leave = || {
            asked.set(asked.get() + 1);
            asked.get() < 3
        };
        assert!(fresh.shown(&leave).is_none());
        assert!(asked.get() < 100, "asked {} times after the client had gone", asked.get());
        assert_eq!(fresh.shown(&|| true).unwrap().computed.len(), fresh.printed.len());
        assert_eq!(fresh.price(), 0);
    }
}
