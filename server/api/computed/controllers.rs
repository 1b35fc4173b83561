//! `/v1/controllers`: state feedback that balances in place.

use equipoise_physics::analysis::contact_regime::{ContactRegime, contact_regime};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::small_deviations::{SmallDeviations, small_deviations};
use equipoise_physics::control::bounce_model::{BounceModel, STATE, states};
use equipoise_physics::control::controller::{Controller, ControllerFailure, Wanted, design_controller};
use equipoise_physics::control::lqr::{DesignFailure, LqrDesign};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::scene::{Draft, FieldError, GAINS, Name, Scene, Value};
use schemars::Schema;
use serde_json::json;

use crate::api::prelude::*;
use crate::api::scene::{build_scene, complete_law, explain, scene_to_query};
use crate::api::shared::answer_parts::draw_closed_loop;
use crate::api::shared::margins::{HasMargins, Margin, MarginEnd, limits_of_feedback, margins_of_feedback};
use crate::api::shared::request_parts::Weights;
use crate::api::shared::write;

impl ComputedResource for ControllerRequest {
    const NAME: &'static str = "controllers";
    const SINGULAR: &'static str = "Controller";
    type Format = ChartFormat;
    const WORK: Work<Self, ChartFormat> = Work::Pure {
        canonical: ControllerRequest::canonical,
        compute: |request, format, slice, _| format.write(&ControllerAnswer::compute(request)?, slice),
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<ControllerAnswer>()
            .table("One row.", columns().map(|column| column.word()))
            .end_of::<ControllerAnswer>(ControllerAnswer::END)
            .refuses(Analysis::Controller);
    }
}

/// A request for a control law.
#[derive(Debug, Clone, Copy)]
pub struct ControllerRequest {
    /// The scene with its law; a tilt gain of 1 is added where it has none, since a scene needs one to be built.
    pub scene: Scene,
    /// κ, if the scene has one.
    pub tilt_gain: Option<f64>,
    /// Contact regime that the law is designed for.
    pub regime: ContactRegime,
    /// The weights.
    pub weights: Weights,
}

request_fields! {
    /// A request for a control law as it is read. The scene need not have a law.
    struct AskedLaw {
        /// The scene.
        scene: Draft = SceneSpec,
        /// Behaviour of the contact for which the law is designed. By default that of the scene near its fixed point: with any friction it sticks.
        contact: Option<bool> = choice(&[("frictionless", false), ("stick", true)]).optional(),
        /// Costs of a deviation and of a tilt. The law minimizes the sum of the weighted squares over all bounces, in SI units.
        weights: Weights = ObjectOfDefaults,
    }
}

impl Fields for ControllerRequest {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let AskedLaw { scene: mut draft, contact: sticks, weights } = AskedLaw::read_fields(reader)?;
        // The request is for a law, so the scene may have none.
        let tilt_gain = complete_law(&mut draft);
        let pointer = reader.pointer_to("scene");
        let scene = build_scene(draft, &pointer, reader.errors())?;
        if refuse_lacking(reader, &scene, Analysis::Controller) {
            return None;
        }
        let regime = match sticks {
            None => contact_regime(&scene.model()),
            Some(false) => ContactRegime::Frictionless,
            Some(true) if scene.value(Name::Slide) == Some(Value::Choice("matched")) => ContactRegime::VelocityMatched,
            Some(true) => ContactRegime::Sticking,
        };
        Some(Self { scene, tilt_gain, regime, weights })
    }

    fn describe_fields(list: &mut FieldList) {
        AskedLaw::describe_fields(list);
    }
}

impl ResourceRequest for ControllerRequest {
    fn work(&self) -> u64 {
        limits::CONTROLLER_PRICE
    }
}

impl ControllerRequest {
    fn canonical(&self) -> Vec<u8> {
        write::canonical(&self.scene, &(contact_name(self.regime), self.weights, self.tilt_gain))
    }
}

/// Name of a contact regime in requests and answers.
fn contact_name(regime: ContactRegime) -> &'static str {
    if regime == ContactRegime::Frictionless { "frictionless" } else { "stick" }
}

/// Residue of the law α = κθ that the design is compared with if the scene has no κ. It is that of the paper's first case.
const PROPORTIONAL: f64 = 0.2;

words! {
    /// The contact whose linear model this is about.
    pub LawContact = ["frictionless", "stick"];
    /// A state of the linear model.
    pub StateName = STATE;
}

/// One bounce about the fixed point, s ↦ a·s + b·α, the state s just before an impact in SI units.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct LinearModel {
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
}

/// The bounce in place that the law leads to at the height of the release or of the target, just before its impact. The law and its margins
/// are about this bounce. `/v1/stability` of the scene with the law is about the bounce on which its run settles, which is lower where a
/// swing loses height.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "ControllerFixedPoint", transform = always_placed)]
struct FixedPlace {
    x: f64,
    #[serde(flatten)]
    bounce: FixedPointAnswer,
}

/// The place is absent from [`FixedPointAnswer`] alone.
fn always_placed(schema: &mut Schema) {
    if let Some(x) = schema.pointer_mut("/properties/x") {
        *x = json!({"type": "number", "description": "Horizontal position of the centre of gravity, m."});
    }
}

/// K of the state feedback α = −K·(x, θ, ẋ, θ̇).
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct StateGain {
    /// Gain on the place, rad/m.
    x: f64,
    /// Gain on the angle.
    theta: f64,
    /// Gain on the horizontal velocity, rad·s/m.
    x_dot: f64,
    /// Gain on the angular velocity, s.
    theta_dot: f64,
}

impl From<[f64; 4]> for StateGain {
    fn from([x, theta, x_dot, theta_dot]: [f64; 4]) -> Self {
        Self { x, theta, x_dot, theta_dot }
    }
}

/// Difference of two bounces, in parts of the speed, that is rounding.
const SAME_BOUNCE: f64 = 1e-9;

/// A law on the linear model of a bounce.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct JudgedLaw {
    #[schemars(with = "LawContact")]
    contact: &'static str,
    gain: StateGain,
    /// True if every small deviation that is fed back decays.
    stable: bool,
    /// Eigenvalues of the closed loop, largest modulus first; without x if it is not fed back.
    eigenvalues: Vec<Eigenvalue>,
    spectral_radius: f64,
    /// Bounces in which a small deviation shrinks to a tenth, in the long run. Null if it does not.
    bounces_per_decade: Option<f64>,
    /// Margins of a factor on the whole gain: the factors between which the linear loop stays stable. Empty if it is not stable.
    margins: Vec<Margin>,
}

impl JudgedLaw {
    /// The law with a gain on a model, with or without x among the states; `None` if eigenvalues do not converge.
    fn new(regime: ContactRegime, gain: [f64; 4], model: &BounceModel, with_x: bool) -> Option<Self> {
        let closed = model.closed_loop(gain, states(with_x))?;
        let margins = if closed.is_stable() { model.stable_factors(gain, states(with_x)) } else { None };
        Some(Self {
            contact: contact_name(regime),
            gain: gain.into(),
            stable: closed.is_stable(),
            eigenvalues: closed.eigenvalues.iter().map(|&value| value.into()).collect(),
            spectral_radius: closed.spectral_radius,
            bounces_per_decade: closed.bounces_per_decade(),
            margins: margins.map(Margin::of_feedback).into_iter().collect(),
        })
    }
}

/// Requests that map from which angles and spins a run survives, with this law and with α = κθ. Paths are relative to the address of the server.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct RegionLinks {
    #[schemars(extend("format" = "uri-reference"))]
    designed: String,
    /// With κ of the scene or, without one, the κ of residue 0.2, as in case-1. On a contact that sticks to a table that only tilts, where no κ is
    /// stable, the κ of residue 0.2 without friction. At most 100.
    #[schemars(extend("format" = "uri-reference"))]
    proportional: String,
}

/// Answer of `/v1/controllers`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Controller")]
pub struct ControllerAnswer {
    /// The scene with the law as its `table.feedback`, ready to run.
    scene: Resolved,
    model: ModelChoice,
    weights: Weights,
    /// The states of the linear model, in the order of `matrices`.
    #[schemars(with = "Vec<StateName>")]
    state_order: &'static [&'static str],
    matrices: LinearModel,
    #[serde(flatten)]
    law: JudgedLaw,
    /// Residual of the Riccati equation, relative to the solution (Frobenius norms).
    residual: f64,
    /// Number of doublings.
    iterations: u32,
    fixed_point: FixedPlace,
    /// Change of `fixed_point.y_dot` by each bounce, m/s, where nothing holds the height, as with `air` or a wrong `table.assumed_restitution`: the
    /// law is about the bounce at the height of the release. Null where the bounce repeats.
    y_dot_change: Option<f64>,
    /// Eigenvalues on a table that stays level.
    open_loop: Vec<Eigenvalue>,
    /// Factor on a deviation of the height at each bounce: 1 if the table does not steer the energy.
    energy_eigenvalue: f64,
    /// The law on the contact of the scene, if it was designed for another contact.
    applied: Option<JudgedLaw>,
    /// The state feedback of the scene, on its own contact. Null without one.
    given: Option<JudgedLaw>,
    regions: RegionLinks,
    notes: Vec<String>,
    #[serde(skip)]
    linear_model: BounceModel,
    #[serde(skip)]
    design: LqrDesign,
}

impl ControllerAnswer {
    /// Designs the law.
    ///
    /// # Errors
    /// The reason why the design failed.
    pub fn compute(request: &ControllerRequest) -> Result<Self, Refusal> {
        let ControllerRequest { scene, tilt_gain, regime, weights } = *request;
        let Weights { state, input } = weights;
        let slow = || ("/weights", "the eigenvalues of this law did not converge".to_owned());
        let wanted = Wanted { friction: friction(&scene, regime), state, input };
        let Controller { scene: designed, design, place, sinks, model, own, height } =
            design_controller(&scene, &wanted).map_err(refusal)?;
        let with_x = state[0] != 0.0;
        let open = model.closed_loop([0.0; 4], states(with_x)).ok_or_else(slow)?;
        let own_regime = contact_regime(&scene.model());
        let judge = |gain: [f64; 4], model: &BounceModel| {
            JudgedLaw::new(own_regime, gain, model, gain[0] != 0.0).ok_or_else(slow)
        };
        let applied = (own_regime != regime).then(|| judge(design.gain, &own)).transpose()?;
        let has_feedback = scene.value(Name::FeedbackTheta).is_some();
        let told = GAINS.map(|name| scene.number(name).unwrap_or(0.0));
        // About the bounce of the law itself, where one repeats that is another.
        let is_other = |small: &SmallDeviations| {
            let there = small.fixed_point;
            (there.speed - place.speed).abs().max((there.x - place.x).abs()) > SAME_BOUNCE * place.speed
        };
        let other = || small_deviations(&scene).ok().filter(is_other);
        let about_given = || other().map_or(own, |small| BounceModel::about(&scene, &small));
        let given = has_feedback.then(|| judge(told, &about_given())).transpose()?;
        let first = usize::from(!with_x);
        let mut answer = Self {
            scene: Resolved(designed),
            model: ModelChoice::of(&designed),
            weights,
            state_order: &STATE[first..],
            matrices: LinearModel {
                a: (first..4).map(|row| (first..4).map(|column| model.a[(row, column)]).collect()).collect(),
                b: (first..4).map(|row| model.b[row]).collect(),
            },
            law: JudgedLaw::new(regime, design.gain, &model, with_x).ok_or_else(slow)?,
            residual: design.residual,
            iterations: design.iterations,
            fixed_point: FixedPlace { x: place.x, bounce: FixedPoint { x: 0.0, ..place }.into() },
            y_dot_change: sinks,
            open_loop: open.eigenvalues.iter().map(|&value| value.into()).collect(),
            energy_eigenvalue: height,
            applied,
            given,
            regions: RegionLinks {
                designed: region(&designed, &place),
                proportional: region(&proportional(&scene, tilt_gain, &place)?, &place),
            },
            notes: Vec::new(),
            linear_model: model,
            design,
        };
        answer.notes = answer.notes_on(with_x, own_regime);
        Ok(answer)
    }

    fn notes_on(&self, with_x: bool, own: ContactRegime) -> Vec<String> {
        let mut notes = Vec::new();
        let what = if with_x { "x, theta, x_dot and theta_dot" } else { "theta, x_dot and theta_dot" };
        if let Some(bounces) = self.law.bounces_per_decade {
            notes.push(format!(
                "every small deviation of {what} dies out, in the long run by a factor of ten in {} bounces; how \
                 large a deviation may be is not a linear matter: see regions",
                significant(bounces, 3)
            ));
        }
        if !with_x {
            notes.push("x has no weight and is left out: the body comes to rest wherever it then is".to_owned());
        }
        for Margin { below, above, .. } in &self.law.margins {
            let shown =
                |end: &Option<MarginEnd>| end.as_ref().map_or("any factor".to_owned(), |end| significant(end.limit, 4));
            notes.push(format!(
                "the linear loop stays stable while the whole gain is scaled by more than {} and less than {}",
                shown(below),
                shown(above)
            ));
        }
        if let Some(change) = self.y_dot_change {
            let (way, course) =
                if change > 0.0 { ("loses", "is lost after") } else { ("gains", "has twice its speed after") };
            notes.push(format!(
                "no bounce repeats: each one changes y_dot by {change} m/s. The law and its margins are about the upright bounce of {} m/s, which \
                 {way} height and {course} about {} bounces at this rate (energy_gain would hold it)",
                self.fixed_point.bounce.y_dot.abs(),
                (self.fixed_point.bounce.y_dot / change).abs().ceil()
            ));
        } else if self.energy_eigenvalue == 1.0 {
            notes.push(
                "the height of the bounce is not steered: what energy is left when the deviations have died out \
                 decides it (energy_gain steers it)"
                    .to_owned(),
            );
        } else if self.energy_eigenvalue.abs() >= 1.0 {
            notes.push(format!(
                "deviations of the height grow by {} a bounce: energy_gain is outside of its own limits, and no state \
                 feedback changes that",
                self.energy_eigenvalue
            ));
        }
        if let Some(applied) = &self.applied {
            let verdict = if applied.stable { "stable" } else { "not stable" };
            let name = contact_name(own);
            notes.push(format!(
                "the law is for a contact that is {}, that of the scene is {name}: there it is {verdict} (`applied`)",
                self.law.contact
            ));
        }
        if let Some(given) = self.given.as_ref().filter(|given| given.gain.x == 0.0) {
            notes.push(format!(
                "the law that the scene has does not feed x back, so that x is left out of what is `given`; it is {}",
                if given.stable { "stable without it" } else { "not stable" }
            ));
        }
        notes
    }
}

impl HasMargins for ControllerAnswer {
    fn margins(&self) -> &[Margin] {
        &self.law.margins
    }
}

/// All columns of a row.
fn columns() -> impl Iterator<Item = RowColumn<ControllerAnswer>> {
    COLUMNS.into_iter().chain(limits_of_feedback()).chain(margins_of_feedback())
}

/// Columns of a law.
const COLUMNS: [RowColumn<ControllerAnswer>; 14] = [
    RowColumn::new("contact", "", "", Read::Word(|it: &ControllerAnswer| Some(it.law.contact))).among("LawContact"),
    RowColumn::new("gain_x", "rad/m", "", Read::Sparse(|it| Some(it.law.gain.x))),
    RowColumn::new("gain_theta", "", "", Read::Sparse(|it| Some(it.law.gain.theta))),
    RowColumn::new("gain_x_dot", "rad·s/m", "", Read::Sparse(|it| Some(it.law.gain.x_dot))),
    RowColumn::new("gain_theta_dot", "s", "", Read::Sparse(|it| Some(it.law.gain.theta_dot))),
    RowColumn::new("spectral_radius", "", "", Read::Sparse(|it| Some(it.law.spectral_radius))),
    RowColumn::new("bounces_per_decade", "", "", Read::Sparse(|it| it.law.bounces_per_decade)),
    RowColumn::new("residual", "", "", Read::Sparse(|it| Some(it.residual))),
    RowColumn::new("iterations", "", "", Read::Count(|it| it.iterations.into())),
    RowColumn::new("energy_eigenvalue", "", "", Read::Sparse(|it| Some(it.energy_eigenvalue))),
    RowColumn::new("fixed_point_y_dot", "m/s", "", Read::Sparse(|it| Some(it.fixed_point.bounce.y_dot))),
    RowColumn::new("fixed_point_flight_time", "s", "", Read::Sparse(|it| Some(it.fixed_point.bounce.flight_time))),
    RowColumn::new("applied_spectral_radius", "", "", Read::Sparse(|it| Some(it.applied.as_ref()?.spectral_radius))),
    RowColumn::new("given_spectral_radius", "", "", Read::Sparse(|it| Some(it.given.as_ref()?.spectral_radius))),
];

impl Tabular for ControllerAnswer {
    const END: &'static [&'static str] = &["scene", "notes"];

    /// The law in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(&columns().collect::<Vec<_>>(), std::slice::from_ref(self)))
    }
}

/// The friction of a contact in this regime: that of the scene, where it is its own.
fn friction(scene: &Scene, regime: ContactRegime) -> Option<Friction> {
    let own = scene.model().friction;
    let slide = match regime {
        ContactRegime::Frictionless => return own.filter(|friction| friction.coefficient == 0.0),
        ContactRegime::VelocityMatched => Slide::Matched,
        ContactRegime::Sticking => Slide::None,
    };
    let sticks = Friction { coefficient: 1.0, law: RestitutionLaw::Poisson, slide };
    Some(own.filter(|friction| friction.coefficient != 0.0).unwrap_or(sticks))
}

/// The reason why there is no law, with the field that it is about.
fn refusal(why: ControllerFailure) -> Refusal {
    let detail = match why {
        ControllerFailure::NoBounce(why) => {
            return Refusal::At("/scene", format!("there is no law to design: {why}"));
        }
        ControllerFailure::Unbuilt(errors) => return unbuilt(errors),
        ControllerFailure::OutOfRange(name, gain) => {
            let row = name.row();
            format!("the law would have {} = {gain}, which must be {}", row.path, row.limits())
        }
        ControllerFailure::Design(DesignFailure::Diverging) => {
            "the Riccati equation has no solution that the doubling finds: a deviation that grows by itself has no \
             weight, or the rod can hardly be steered at this speed"
                .to_owned()
        }
        ControllerFailure::Design(DesignFailure::Inaccurate(residual)) => format!(
            "the Riccati equation is solved only to {residual:e} of the solution: weights or lengths are too far apart for doubles"
        ),
        ControllerFailure::Design(DesignFailure::Unseen(spectral_radius)) => format!(
            "with these weights a deviation without a weight does not die out (spectral radius {spectral_radius}): give theta and, \
             without x, x_dot a weight above 0"
        ),
    };
    Refusal::At("/weights", detail)
}

/// The scene with the law α = κθ: κ is `tilt_gain`, or else that of residue [`PROPORTIONAL`]. A contact that sticks to a table that
/// only tilts is unstable for every κ, so it gets the κ of the contact without friction.
fn proportional(scene: &Scene, tilt_gain: Option<f64>, place: &FixedPoint) -> Result<Scene, Refusal> {
    let mut draft = scene.draft();
    let model = scene.model();
    let (length, rho) = (model.rod.contact_distance, model.rod.radius_of_gyration);
    let turning =
        if contact_regime(&model) == ContactRegime::VelocityMatched { rho * rho + length * length } else { rho * rho };
    let width = model.rod.gravity * turning / (place.speed * place.speed * length);
    let kappa = tilt_gain.unwrap_or_else(|| (1.0 + PROPORTIONAL * width).min(100.0));
    for (name, value) in GAINS.map(|name| (name, None)).into_iter().chain([(Name::TiltGain, Some(kappa))]) {
        draft.set(name, value.map(Value::Number)).map_err(|error| unbuilt(vec![error]))?;
    }
    draft.build().map_err(unbuilt)
}

fn unbuilt(errors: Vec<FieldError>) -> Refusal {
    let details: Vec<String> = explain(errors).into_iter().map(|error| error.detail).collect();
    Refusal::At("/scene", details.join("; "))
}

/// URL of `regions` that maps the basin of a scene's law over angle and spin of the release.
fn region(scene: &Scene, place: &FixedPoint) -> String {
    // Spin by one radian during a flight, to two digits.
    let spin: f64 = format!("{:.1e}", 1.0 / place.flight_time).parse().unwrap_or(1.0);
    let spin = spin.clamp(0.01, 200.0);
    let mut query = form_urlencoded::Serializer::new(String::new());
    query.extend_pairs(scene_to_query(scene));
    for (name, field, end) in [("x", "release.theta", 0.8), ("y", "release.theta_dot", spin)] {
        query.append_pair(&format!("{name}.field"), field);
        query.append_pair(&format!("{name}.from"), &(-end).to_string());
        query.append_pair(&format!("{name}.to"), &end.to_string());
        query.append_pair(&format!("{name}.count"), "81");
    }
    query.append_pair("bounces", "300").append_pair("quantity", "survival");
    format!("/v1/regions?{}", query.finish())
}

impl Pictured for ControllerAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let title = format!("Closed loop on a {} contact", self.law.contact);
        Ok(draw_closed_loop(&title, &self.notes.join("; "), &self.linear_model, self.design.gain))
    }
}
