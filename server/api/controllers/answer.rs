//! The request and the answer of `controllers`: weights, and the state feedback that is best for them.

use equipoise_physics::bounce::strike::Rod;
use equipoise_physics::control::{BounceModel, ClosedLoop, Design, NoDesign, STATE};
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use equipoise_physics::stability::contact_regime::{ContactRegime, contact_regime};
use equipoise_physics::stability::fixed_point::{FixedPoint, bounce_in_place};
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::jacobians::answer::Eigenvalue;
use crate::api::scene::{build_scene, read_draft, scene_to_json, scene_to_query};
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::stability::answer;
use crate::api::trajectories::answer::Choice;
use crate::charts::{Loop, closed_loop, significant};
use crate::http::Reader;

/// The fields of the gain, in the order of the state.
const FEEDBACK: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

/// Weights that keep the table's tilts small enough that laws hold from afar.
const WEIGHTS: ([f64; 4], f64) = ([1.0, 10.0, 0.1, 0.1], 10.0);

/// Residue of the α = κθ that is shown beside a law where the scene has no κ: that of the paper's first case.
const PROPORTIONAL: f64 = 0.2;

/// Points of the way of the eigenvalues over the factor on the gain.
const FACTORS: usize = 160;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// The scene, with whatever law it has; with a tilt gain where it has none, since a scene needs one to be built.
    pub scene: Scene,
    /// κ, if the scene has one.
    tilt_gain: Option<f64>,
    regime: ContactRegime,
    state: [f64; 4],
    input: f64,
}

impl Request {
    /// Reads a request.
    pub fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let draft = read_draft(reader);
        let sticks = reader.choice("contact", &[("frictionless", false), ("stick", true)]);
        let (mut state, mut input) = WEIGHTS;
        reader.within("weights", |weights| {
            weights.numbers("state", &STATE, &(0.0..=1e6), &mut state);
            input = weights.number("input", 1e-6..=1e6, "").unwrap_or(input);
        });
        let mut draft = draft?;
        let tilt_gain = match draft.get(Name::TiltGain) {
            Some(Value::Number(kappa)) => Some(kappa),
            _ => None,
        };
        // A law is what is asked for, so there need not be one.
        if draft.get(Name::TiltGain).is_none() && FEEDBACK.iter().all(|&name| draft.get(name).is_none()) {
            set(&mut draft, Name::TiltGain, Some(1.0));
        }
        let pointer = reader.pointer_to("scene");
        let scene = build_scene(draft, &pointer, reader.errors())?;
        let regime = match sticks {
            None => contact_regime(&scene.model()),
            Some(false) => ContactRegime::Frictionless,
            Some(true) if scene.value(Name::Slide) == Some(Value::Choice("matched")) => ContactRegime::VelocityMatched,
            Some(true) => ContactRegime::Sticking,
        };
        Some(Self { scene, tilt_gain, regime, state, input })
    }

    /// All that determines the answer beside the scene.
    pub fn rest(&self) -> impl Serialize {
        (contact_name(self.regime), self.state, self.input, self.tilt_gain)
    }
}

/// Sets a number of a draft; whether it is within its range.
fn set(draft: &mut Draft, name: Name, number: Option<f64>) -> bool {
    draft.set(name, number.map(Value::Number)).is_ok()
}

fn contact_name(regime: ContactRegime) -> &'static str {
    if regime == ContactRegime::Frictionless { "frictionless" } else { "stick" }
}

/// Numbers by the names of the state.
#[derive(Debug, Clone, Copy, Serialize)]
struct ByState {
    x: f64,
    theta: f64,
    x_dot: f64,
    theta_dot: f64,
}

impl From<[f64; 4]> for ByState {
    fn from([x, theta, x_dot, theta_dot]: [f64; 4]) -> Self {
        Self { x, theta, x_dot, theta_dot }
    }
}

#[derive(Debug, Clone, Serialize)]
struct Weights {
    state: ByState,
    input: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Linear {
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct Place {
    x: f64,
    #[serde(flatten)]
    bounce: answer::FixedPoint,
}

#[derive(Debug, Clone, Serialize)]
struct GainMargin {
    lower: Option<f64>,
    upper: Option<f64>,
}

/// A law and what it does.
#[derive(Debug, Clone, Serialize)]
struct Judged {
    contact: &'static str,
    gain: ByState,
    stable: bool,
    eigenvalues: Vec<Eigenvalue>,
    spectral_radius: f64,
    bounces_per_decade: Option<f64>,
    gain_margin: Option<GainMargin>,
}

impl Judged {
    fn new(regime: ContactRegime, gain: [f64; 4], closed: &ClosedLoop) -> Self {
        Self {
            contact: contact_name(regime),
            gain: gain.into(),
            stable: closed.is_stable(),
            eigenvalues: closed.eigenvalues.iter().map(|&value| value.into()).collect(),
            spectral_radius: closed.spectral_radius,
            bounces_per_decade: closed.bounces_per_decade(),
            gain_margin: closed.margin.map(|it| GainMargin { lower: it.lower, upper: it.upper }),
        }
    }
}

/// Where basins are to be seen.
#[derive(Debug, Clone, Serialize)]
struct Regions {
    designed: String,
    proportional: String,
}

/// The answer.
#[derive(Debug, Clone, Serialize)]
pub struct Controller {
    scene: Json,
    model: Choice,
    weights: Weights,
    state_order: &'static [&'static str],
    linear: Linear,
    #[serde(flatten)]
    law: Judged,
    residual: f64,
    iterations: u32,
    fixed_point: Place,
    open_loop: Vec<Eigenvalue>,
    energy_eigenvalue: f64,
    applied: Option<Judged>,
    given: Option<Judged>,
    regions: Regions,
    notes: Vec<String>,
    #[serde(skip)]
    linear_model: BounceModel,
    #[serde(skip)]
    design: Design,
}

/// A JSON pointer and a sentence.
type Refusal = (&'static str, String);

impl Controller {
    /// Designs the law.
    ///
    /// # Errors
    /// Why there is none.
    pub fn compute(request: &Request) -> Result<Self, Refusal> {
        let Request { scene, tilt_gain, regime, state, input } = *request;
        let slow = || ("/weights", "the eigenvalues of this law did not converge".to_owned());
        let place = bounce_in_place(&scene).map_err(|why| ("/scene", format!("there is no law to design: {why}")))?;
        let rod: Rod = scene.parameters();
        let model = BounceModel::new(&rod, place.speed, regime);
        let with_x = state[0] != 0.0;
        let design = model.design(state, input).map_err(|why| ("/weights", refusal(why)))?;
        let closed = model.closed_loop(design.gain, with_x).ok_or_else(slow)?;
        let open = model.closed_loop([0.0; 4], with_x).ok_or_else(slow)?;
        let designed = designed(&scene, design.gain)?;
        let own = contact_regime(&scene.model());
        let judge = |gain: [f64; 4]| {
            let closed = BounceModel::new(&rod, place.speed, own).closed_loop(gain, gain[0] != 0.0);
            closed.map(|closed| Judged::new(own, gain, &closed)).ok_or_else(slow)
        };
        let applied = (own != regime).then(|| judge(design.gain)).transpose()?;
        let given = scene.model().feedback().map(judge).transpose()?;
        let first = usize::from(!with_x);
        let energy_eigenvalue = 1.0 - rod.strike_gain_per_energy * place.speed * place.speed;
        let mut answer = Self {
            scene: scene_to_json(&designed),
            model: Choice::model(&designed),
            weights: Weights { state: state.into(), input },
            state_order: &STATE[first..],
            linear: Linear {
                a: (first..4).map(|row| (first..4).map(|column| model.a[(row, column)]).collect()).collect(),
                b: (first..4).map(|row| model.b[row]).collect(),
            },
            law: Judged::new(regime, design.gain, &closed),
            residual: design.residual,
            iterations: design.iterations,
            fixed_point: Place { x: 0.0, bounce: place.into() },
            open_loop: open.eigenvalues.iter().map(|&value| value.into()).collect(),
            energy_eigenvalue,
            applied,
            given,
            regions: Regions {
                designed: region(&designed, &place),
                proportional: region(&proportional(&scene, tilt_gain, &rod, &place)?, &place),
            },
            notes: Vec::new(),
            linear_model: model,
            design,
        };
        answer.notes = answer.notes_on(with_x, own);
        Ok(answer)
    }

    fn notes_on(&self, with_x: bool, own: ContactRegime) -> Vec<String> {
        let mut notes = Vec::new();
        let what = if with_x { "x, theta, x_dot and theta_dot" } else { "theta, x_dot and theta_dot" };
        if let Some(bounces) = self.law.bounces_per_decade {
            notes.push(format!(
                "every small deviation of {what} dies out, in the long run by a factor of ten in {} bounces; how large a deviation may be \
                 is not a linear matter: see regions",
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
                "the height of the bounce is not steered: what energy is left when the deviations have died out decides it \
                        (energy_gain steers it)"
                    .to_owned(),
            );
        } else if self.energy_eigenvalue.abs() >= 1.0 {
            notes.push(format!(
                "deviations of the height grow by {} a bounce: energy_gain is outside of its own limits, and no state feedback changes \
                 that",
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

    /// The law in one row.
    pub fn to_table(&self) -> Table {
        let number = |name, unit, value| Column { name, unit, cells: Cells::Sparse(vec![value]) };
        let (law, given) = (&self.law, self.given.as_ref());
        let margin = law.gain_margin.as_ref();
        Table(vec![
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
        ])
    }

    /// What ends it as NDJSON: the notes and the scene, which are no scalars.
    pub fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End {
            scene: Json,
            notes: Vec<String>,
        }
        End { scene: self.scene.clone(), notes: self.notes.clone() }
    }

    /// The eigenvalues on the unit circle, and their way as the gain is scaled, as SVG.
    pub fn to_picture(&self) -> String {
        let title = format!("Closed loop on a {} contact", self.law.contact);
        picture(&title, &self.notes.join("; "), &self.linear_model, self.design.gain)
    }
}

/// A law's loop as SVG.
pub(crate) fn picture(title: &str, caption: &str, model: &BounceModel, gain: [f64; 4]) -> String {
    let with_x = gain[0] != 0.0;
    let eigenvalues = |factor: f64| -> Vec<(f64, f64)> {
        let closed = model.closed_loop(gain.map(|gain| gain * factor), with_x);
        closed.iter().flat_map(|closed| &closed.eigenvalues).map(|value| (value.re, value.im)).collect()
    };
    let closed = model.closed_loop(gain, with_x);
    let margin = closed.as_ref().and_then(|closed| closed.margin);
    let (lower, upper) = (margin.and_then(|it| it.lower), margin.and_then(|it| it.upper));
    let high = upper.map_or(2.0, |upper| 1.0 + 1.4 * (upper - 1.0)).min(10.0);
    let low = lower.map_or(0.0, |lower| 1.0 - 1.4 * (1.0 - lower)).max(0.0);
    let way = (0..=FACTORS).map(|step| {
        let factor = low + (high - low) * step as f64 / FACTORS as f64;
        (factor, eigenvalues(factor))
    });
    let number = |value: f64| significant(value, 4);
    let [x, theta, x_dot, theta_dot] = gain.map(number);
    let subtitle = format!(
        "α = −K·(x, θ, ẋ, θ̇) with K = ({x}, {theta}, {x_dot}, {theta_dot}); largest |λ| = {}",
        number(closed.map_or(f64::NAN, |closed| closed.spectral_radius))
    );
    closed_loop(&Loop {
        title,
        subtitle: &subtitle,
        caption,
        closed: &eigenvalues(1.0),
        open: &eigenvalues(0.0),
        way: &way.collect::<Vec<_>>(),
        margin: (lower, upper),
    })
}

/// Why there is no law, in a sentence.
fn refusal(why: NoDesign) -> String {
    match why {
        NoDesign::Diverging => {
            "the Riccati equation has no solution that the doubling finds: a deviation that grows by itself has no \
                                weight, or the rod can hardly be steered at this speed"
                .to_owned()
        }
        NoDesign::Inaccurate(residual) => format!(
            "the Riccati equation is solved only to {residual:e} of the solution: weights or lengths are too far apart for doubles"
        ),
        NoDesign::Unseen(spectral_radius) => format!(
            "with these weights a deviation without a weight does not die out (spectral radius {spectral_radius}): give theta and, \
             without x, x_dot a weight above 0"
        ),
    }
}

/// The scene with a law in place of its own.
fn designed(scene: &Scene, gain: [f64; 4]) -> Result<Scene, Refusal> {
    let mut draft = scene.draft();
    set(&mut draft, Name::TiltGain, None);
    for (name, gain) in FEEDBACK.into_iter().zip(gain) {
        let said = gain != 0.0 || name == Name::FeedbackTheta;
        if !set(&mut draft, name, said.then_some(gain)) {
            let row = name.row();
            return Err((
                "/weights",
                format!("the law would have {} = {gain}, which must be {}", row.path, row.limits()),
            ));
        }
    }
    draft.build().map_err(unbuilt)
}

/// The scene with α = κθ: its own κ, or the one of residue [`PROPORTIONAL`]; on a contact that sticks to a table that only tilts,
/// where no κ holds, that of the contact without friction.
fn proportional(scene: &Scene, tilt_gain: Option<f64>, rod: &Rod, place: &FixedPoint) -> Result<Scene, Refusal> {
    let mut draft = scene.draft();
    for name in FEEDBACK {
        set(&mut draft, name, None);
    }
    let (length, rho) = (rod.contact_distance, rod.radius_of_gyration);
    let turning = if contact_regime(&scene.model()) == ContactRegime::VelocityMatched {
        rho * rho + length * length
    } else {
        rho * rho
    };
    let width = rod.gravity * turning / (place.speed * place.speed * length);
    let kappa = tilt_gain.unwrap_or_else(|| (1.0 + PROPORTIONAL * width).min(100.0));
    set(&mut draft, Name::TiltGain, Some(kappa));
    draft.build().map_err(unbuilt)
}

fn unbuilt(errors: Vec<equipoise_physics::scene::FieldError>) -> Refusal {
    let details: Vec<String> = errors.into_iter().map(|error| error.detail).collect();
    ("/scene", details.join("; "))
}

/// The basin of a scene's law over angle and spin of the release, as a request for `regions`.
fn region(scene: &Scene, place: &FixedPoint) -> String {
    // A turn of one radian during a flight, to two digits.
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
