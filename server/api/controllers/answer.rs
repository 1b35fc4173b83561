//! The answer of `controllers`: the state feedback that is optimal for the weights (LQR).

use std::borrow::Cow;

use equipoise_physics::analysis::contact_regime::{ContactRegime, contact_regime};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::control::bounce_model::{BounceModel, STATE, StableGainRange, states};
use equipoise_physics::control::controller::{Controller, ControllerFailure, Wanted, design_controller};
use equipoise_physics::control::lqr::{DesignFailure, LqrDesign};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::scene::{FieldError, GAINS, Name, Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::controllers::request::{ControllerRequest, contact_name};
use crate::api::formats::Tabular;
use crate::api::scene::{explain, scene_to_json, scene_to_query};
use crate::api::shared::eigenvalue::Eigenvalue;
use crate::api::shared::fixed_point::FixedPointAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::Refusal;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::shared::weights::Weights;
use crate::charts::significant;

/// Residue of the law α = κθ that the design is compared with if the scene has no κ. It is that of the paper's first case.
const PROPORTIONAL: f64 = 0.2;

#[derive(Debug, Clone, Serialize)]
struct LinearModel {
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct FixedPlace {
    x: f64,
    #[serde(flatten)]
    bounce: FixedPointAnswer,
}

#[derive(Debug, Clone, Serialize)]
struct GainMargin {
    lower: Option<f64>,
    upper: Option<f64>,
}

/// K of the state feedback α = −K·(x, θ, ẋ, θ̇).
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct StateGain {
    /// Of the place, rad/m.
    x: f64,
    /// Of the angle.
    theta: f64,
    /// Of the horizontal velocity, rad·s/m.
    x_dot: f64,
    /// Of the angular velocity, s.
    theta_dot: f64,
}

impl From<[f64; 4]> for StateGain {
    fn from([x, theta, x_dot, theta_dot]: [f64; 4]) -> Self {
        Self { x, theta, x_dot, theta_dot }
    }
}

/// A law and its closed loop.
#[derive(Debug, Clone, Serialize)]
pub(super) struct LawAnswer {
    pub(super) contact: &'static str,
    gain: StateGain,
    stable: bool,
    eigenvalues: Vec<Eigenvalue>,
    spectral_radius: f64,
    bounces_per_decade: Option<f64>,
    gain_margin: Option<GainMargin>,
}

impl LawAnswer {
    /// The law with a gain on a model, with or without x among the states; `None` if eigenvalues do not converge.
    fn new(regime: ContactRegime, gain: [f64; 4], model: &BounceModel, with_x: bool) -> Option<Self> {
        let closed = model.closed_loop(gain, with_x)?;
        let margin = model.margin(gain, states(with_x));
        Some(Self {
            contact: contact_name(regime),
            gain: gain.into(),
            stable: closed.is_stable(),
            eigenvalues: closed.eigenvalues.iter().map(|&value| value.into()).collect(),
            spectral_radius: closed.spectral_radius,
            bounces_per_decade: closed.bounces_per_decade(),
            gain_margin: margin.map(|StableGainRange { lower, upper }| GainMargin { lower, upper }),
        })
    }
}

/// URLs of maps of the basins of attraction.
#[derive(Debug, Clone, Serialize)]
struct RegionLinks {
    designed: String,
    proportional: String,
}

/// Answer of `/v1/controllers`.
#[derive(Debug, Clone, Serialize)]
pub struct ControllerAnswer {
    scene: Json,
    model: ModelChoice,
    weights: Weights,
    state_order: &'static [&'static str],
    linear: LinearModel,
    #[serde(flatten)]
    pub(super) law: LawAnswer,
    residual: f64,
    iterations: u32,
    fixed_point: FixedPlace,
    open_loop: Vec<Eigenvalue>,
    energy_eigenvalue: f64,
    applied: Option<LawAnswer>,
    given: Option<LawAnswer>,
    regions: RegionLinks,
    pub(super) notes: Vec<String>,
    #[serde(skip)]
    pub(super) linear_model: BounceModel,
    #[serde(skip)]
    pub(super) design: LqrDesign,
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
        let Controller { scene: designed, design, place, model, own, height } =
            design_controller(&scene, &wanted).map_err(refusal)?;
        let with_x = state[0] != 0.0;
        let open = model.closed_loop([0.0; 4], with_x).ok_or_else(slow)?;
        let own_regime = contact_regime(&scene.model());
        let judge = |gain: [f64; 4]| LawAnswer::new(own_regime, gain, &own, gain[0] != 0.0).ok_or_else(slow);
        let applied = (own_regime != regime).then(|| judge(design.gain)).transpose()?;
        let has_feedback = scene.value(Name::FeedbackTheta).is_some();
        let told = GAINS.map(|name| scene.number(name).unwrap_or(0.0));
        let given = has_feedback.then(|| judge(told)).transpose()?;
        let first = usize::from(!with_x);
        let mut answer = Self {
            scene: scene_to_json(&designed),
            model: ModelChoice::of(&designed),
            weights: weights,
            state_order: &STATE[first..],
            linear: LinearModel {
                a: (first..4).map(|row| (first..4).map(|column| model.a[(row, column)]).collect()).collect(),
                b: (first..4).map(|row| model.b[row]).collect(),
            },
            law: LawAnswer::new(regime, design.gain, &model, with_x).ok_or_else(slow)?,
            residual: design.residual,
            iterations: design.iterations,
            fixed_point: FixedPlace { x: place.x, bounce: FixedPoint { x: 0.0, ..place }.into() },
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
        if let Some(GainMargin { lower, upper }) = &self.law.gain_margin {
            let shown = |end: &Option<f64>| end.map_or("any factor".to_owned(), |it| significant(it, 4));
            notes.push(format!(
                "the linear loop stays stable while the whole gain is scaled by more than {} and less than {}",
                shown(lower),
                shown(upper)
            ));
        }
        if self.energy_eigenvalue == 1.0 {
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

impl Tabular for ControllerAnswer {
    /// The law in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        let number = |name, unit, value| Column { name, unit, cells: Cells::Sparse(vec![value]) };
        let (law, given) = (&self.law, self.given.as_ref());
        let margin = law.gain_margin.as_ref();
        Cow::Owned(Table(vec![
            Column { name: "contact", unit: "", cells: Cells::Words(vec![Some(law.contact)]) },
            number("gain_x", "rad_per_m", Some(law.gain.x)),
            number("gain_theta", "", Some(law.gain.theta)),
            number("gain_x_dot", "rad_s_per_m", Some(law.gain.x_dot)),
            number("gain_theta_dot", "s", Some(law.gain.theta_dot)),
            number("spectral_radius", "", Some(law.spectral_radius)),
            number("bounces_per_decade", "", law.bounces_per_decade),
            number("gain_margin_lower", "", margin.and_then(|it| it.lower)),
            number("gain_margin_upper", "", margin.and_then(|it| it.upper)),
            number("residual", "", Some(self.residual)),
            Column { name: "iterations", unit: "", cells: Cells::Counts(vec![self.iterations.into()]) },
            number("energy_eigenvalue", "", Some(self.energy_eigenvalue)),
            number("fixed_point_y_dot", "m_per_s", Some(self.fixed_point.bounce.y_dot)),
            number("fixed_point_flight_time", "s", Some(self.fixed_point.bounce.flight_time)),
            number("applied_spectral_radius", "", self.applied.as_ref().map(|it| it.spectral_radius)),
            number("given_spectral_radius", "", given.map(|it| it.spectral_radius)),
        ]))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &[]
    }

    fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End {
            scene: Json,
            notes: Vec<String>,
        }
        End { scene: self.scene.clone(), notes: self.notes.clone() }
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
    for (name, parameter, end) in [("x", "release.theta", 0.8), ("y", "release.theta_dot", spin)] {
        query.append_pair(&format!("{name}.parameter"), parameter);
        query.append_pair(&format!("{name}.from"), &(-end).to_string());
        query.append_pair(&format!("{name}.to"), &end.to_string());
        query.append_pair(&format!("{name}.count"), "81");
    }
    query.append_pair("impacts", "300").append_pair("quantity", "survival");
    format!("/v1/regions?{}", query.finish())
}
