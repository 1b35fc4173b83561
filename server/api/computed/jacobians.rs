//! `/v1/jacobians`: the derivative of the map.

use equipoise_physics::analysis::jacobian;
use equipoise_physics::analysis::jacobian::{Linearization, MOST_SIDES, TIED};
use equipoise_physics::analysis::linear_verdict::AngleClass;
use equipoise_physics::analysis::return_map::NAMES;
use equipoise_physics::analysis::small_deviations::{SmallDeviations, small_deviations};
use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;
use nalgebra::{Complex, DMatrix};
use serde_json::json;

use crate::api::prelude::*;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::request_parts::{PLACE, run_to_impact};
use crate::api::shared::table::{Cells, Column, ColumnKind};

impl ComputedResource for JacobianRequest {
    const NAME: &'static str = "jacobians";
    const SINGULAR: &'static str = "Jacobian";
    type Format = TableFormat;
    const WORK: Work<Self, TableFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| {
            let answer = JacobianAnswer::compute(request, || slice.should_continue())?;
            bounces.inc_by(request.period);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<JacobianAnswer>()
            .table("One row for each part of the state.", columns())
            .end::<JacobianAnswer>();
    }
}

/// The place at which to differentiate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum At {
    /// At the scene's fixed point.
    FixedPoint,
    /// At a place x, m, and a state just before a contact.
    State(f64, #[serde(serialize_with = "components")] State),
    /// At a contact of the scene's run.
    Impact(u64),
}

/// Price of a bounce with its derivatives, in bounces of the plain rod.
const BOUNCE_PRICE: u64 = 12;

/// A word, or an object with a state or the number of an impact.
#[derive(Debug, Clone, Copy)]
struct AtSpec;

request_fields! {
    /// A state just before an impact, with the position.
    struct PlacedState {
        /// Horizontal position of the centre of gravity. It matters only if the table feeds it back.
        x: f64 = PLACE.or(0.0),
        /// The state.
        state: State = Part,
    }
}

request_fields! {
    /// A given state.
    struct StateAt {
        /// A state just before an impact.
        state: PlacedState = Object.required(),
    }
}

request_fields! {
    /// The state at an impact of the run.
    struct ImpactAt {
        /// Number of an impact of the run, counted from 1.
        impact: u64 = whole(1..=limits::BOUNCES).required(),
    }
}

impl FieldSpec<At> for AtSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<At> {
        let Some(value) = reader.value(name) else { return Some(At::FixedPoint) };
        if value.is_string() {
            return reader.choice(name, &[("fixed_point", At::FixedPoint)]);
        }
        let read = |at: &mut Reader<'_, '_>| match (at.has("state"), at.has("impact")) {
            (true, false) => StateAt::read_fields(at).map(|at| At::State(at.state.x, at.state.state)),
            (false, true) => ImpactAt::read_fields(at).map(|at| At::Impact(at.impact)),
            _ => {
                at.refuse_whole("at must be \"fixed_point\", or have either `state` or `impact`");
                None
            }
        };
        reader.within(name, read).flatten()
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let word = json!({"type": "string", "enum": ["fixed_point"]});
        let others = "Or `at.impact`, or `at.state.y_dot` and what else of `at.state` is not 0.";
        list.parameter(name, &format!("{about} {others}"), word.clone(), Some(json!("fixed_point")));
        let (state, impact) =
            (list.nested(name, StateAt::describe_fields), list.nested(name, ImpactAt::describe_fields));
        list.may_be_absent(name);
        list.property(name, about, &json!({"oneOf": [word, state, impact], "default": "fixed_point"}));
    }
}

fn components<S: Serializer>(state: &State, serializer: S) -> Result<S::Ok, S::Error> {
    (state.theta, state.x_dot, state.y_dot, state.theta_dot).serialize(serializer)
}

request_fields! {
    /// A request for a derivative.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct JacobianRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// State at which to differentiate.
        pub at: At = AtSpec,
        /// Number of bounces to differentiate over.
        pub period: u64 = whole(1..=limits::PERIOD).or(1),
    }
}

impl ResourceRequest for JacobianRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let request = Self::read_fields(reader);
        if reader.has("method") {
            reader.refuse("method", "unknown field `method`: derivatives are exact; leave it out");
        }
        request
    }

    fn work(&self) -> u64 {
        let Self { scene, at, period } = self;
        let before = match at {
            At::Impact(impact) => impact * bounce_price(scene),
            At::FixedPoint | At::State(..) => 0,
        };
        limits::ANSWER_PRICE + before + period * BOUNCE_PRICE
    }
}

words! {
    /// A part of the state: ρθ and x in m, velocities and ρθ̇ in m/s; x with state feedback; with a delay that is longer than a flight, the
    /// motion of the table that is planned: a tilt in rad and two velocities.
    pub StateComponent = NAMES;

    /// Kind of a place at which the map is differentiated.
    pub JacobianPlaceKind = ["fixed_point", "state", "impact"];
}

/// The place of differentiation.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct JacobianPlace {
    #[schemars(with = "JacobianPlaceKind")]
    kind: &'static str,
    impact: Option<u64>,
    state: JacobianState,
}

/// The state there.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct JacobianState {
    /// Horizontal position, m. Only if the state has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    x: Option<f64>,
    /// Angle, rad.
    theta: f64,
    /// Horizontal velocity, m/s.
    x_dot: f64,
    /// Vertical velocity, m/s.
    y_dot: f64,
    /// Angular velocity, rad/s. Null for a point mass.
    theta_dot: Option<f64>,
}

/// Answer of `/v1/jacobians`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Jacobian")]
pub struct JacobianAnswer {
    scene: Resolved,
    model: ModelChoice,
    at: JacobianPlace,
    period: u64,
    /// Order of rows and columns.
    #[schemars(with = "Vec<StateComponent>")]
    state_order: Vec<&'static str>,
    matrix: Vec<Vec<f64>>,
    determinant: f64,
    eigenvalues: Vec<Eigenvalue>,
    /// Greene's residue of the angle block. Only at the fixed point. Null for a point mass, and where the angle has no pair of eigenvalues of
    /// its own whose product is 1.
    residue: Option<f64>,
    /// True if eigenvectors are missing. Only at the fixed point, where there is a residue.
    defective: Option<bool>,
    /// Time over the bounces, s.
    flight_time: f64,
    /// Vertical velocity of the contact point just before the next impact, m/s. The derivative grows without bound as this goes to 0.
    contact_velocity: f64,
    /// Mode of the first contact.
    #[schemars(with = "ContactMode")]
    contact_mode: &'static str,
    /// True if the map has a derivative there. With friction it has none at a change of the mode of a contact, or if sliding ends together with
    /// compression (law `poisson`): within a share of 1e-12 of the quantity that decides.
    smooth: bool,
    /// The derivatives on the sides of the kink, the first of them `matrix`. Empty if `smooth` is true.
    one_sided: Vec<OneSided>,
    /// Reasons for null values, and further remarks.
    notes: Vec<String>,
}

/// The derivative on one side of a kink.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct OneSided {
    /// Mode of the last contact on a kink.
    #[schemars(with = "ContactMode")]
    contact_mode: &'static str,
    matrix: Vec<Vec<f64>>,
    eigenvalues: Vec<Eigenvalue>,
}

/// Columns of the matrix.
fn columns() -> impl Iterator<Item = ColumnWord> {
    let column = |name, about, kind| ColumnWord { name, unit: "", about, kind: (kind, false), words: "", only: "" };
    let component = column("component", "Part of the state that is differentiated.", ColumnKind::Word);
    let by = NAMES.map(|name| column(name, "", ColumnKind::Number));
    let by = by.map(|by| if ["x_dot", "y_dot"].contains(&by.name) { by } else { by.only("if `state_order` has it") });
    std::iter::once(ColumnWord { words: "StateComponent", ..component }).chain(by)
}

impl JacobianAnswer {
    /// Differentiates the map of a scene.
    ///
    /// # Errors
    /// The reason why there is no derivative.
    pub fn compute(request: &JacobianRequest, go_on: impl FnMut() -> bool) -> Result<Self, Refusal> {
        let JacobianRequest { ref scene, at, period } = *request;
        // The run has its random errors, the derivative has none.
        let nominal = &scene.without_noise();
        let model = match at {
            At::Impact(impact) => nominal.model().from_contact(impact),
            At::FixedPoint | At::State(..) => nominal.model(),
        };
        let (x, state) = place(scene, at, go_on)?;
        let pointer = match at {
            At::FixedPoint => "/at",
            At::State(..) => "/at/state",
            At::Impact(_) => "/at/impact",
        };
        let derivative = jacobian::jacobian_at(&model, x, &state, period).map_err(|contact| {
            let why =
                contact.ending.map_or_else(String::new, |ending| Outcome::new(ending, contact.n, contact.t).detail);
            (pointer, format!("the map has no derivative here: it does not reach the next contact ({why})"))
        })?;
        let Linearization {
            matrix,
            determinant,
            order: state_order,
            flight_time,
            contact_speed: contact_velocity,
            contact_mode,
            one_sided,
            ..
        } = derivative;
        let matrices = || std::iter::once(&matrix).chain(one_sided.iter().map(|side| &side.matrix));
        if !matrices().flat_map(|matrix| matrix.iter()).all(|entry| entry.is_finite()) {
            return Err(Refusal::At(
                pointer,
                format!("the derivative over {period} contacts is beyond double precision"),
            ));
        }
        let mut notes = vec![format!(
            "derivatives grow without bound at grazing; here the contact point comes down at {contact_velocity} m/s"
        )];
        notes.extend(noiseless(scene, "the derivative"));
        let fed_back = scene.model().feedback().is_some();
        if state_order.len() > jacobian::state_order(&model).len() {
            notes.push(format!(
                "a flight is shorter than table.delay, {} s: the table plans its motion before the last strike, and that motion belongs to the state. \
                 Here it is the one that the table plans for this state",
                scene.running_model().lag
            ));
        }
        let (turns, drags) = (scene.acting_turn().is_some(), scene.running_model().drag.is_some());
        let linear = match at {
            At::FixedPoint if scene.program().is_none() => small_deviations(nominal)
                .ok()
                .filter(|small| small.found.is_none() || small.linear.residue.is_some())
                .map(|small| small.linear),
            _ => None,
        };
        let (eigenvalues, residue, defective) = if let Some(linear) = &linear {
            let values = linear.eigenvalues.iter().map(|&value| power(value, period)).collect::<Vec<_>>();
            let residue = linear.residue.map(|residue| residue_over(residue, period));
            (values, residue, Some(linear.class == AngleClass::Parabolic))
        } else {
            let whose = match (fed_back, turns) {
                _ if scene.running_model().lag != 0.0 => "a table without a delay",
                _ if drags => "a flight without drag",
                (true, _) => "a table without state feedback",
                (false, true) => "a table that does not turn as it strikes",
                (false, false) => "a fixed point in closed form",
            };
            notes.push(format!("residue and defective are null: they belong to {whose}"));
            (eigenvalues_of(&matrix, pointer)?, None, None)
        };
        if !one_sided.is_empty() {
            notes.push(format!(
                "smooth is false: what the contact does along the table changes here, or when; the quantity that decides is \
                 within {TIED} of its scale. matrix is the first of one_sided, which has at most {MOST_SIDES}"
            ));
        }
        let one_sided = one_sided.iter().map(|side| {
            Ok(OneSided {
                contact_mode: side.contact_mode.name(),
                matrix: rows(&side.matrix),
                eigenvalues: eigenvalues_of(&side.matrix, pointer)?.into_iter().map(Eigenvalue::from).collect(),
            })
        });
        let one_sided = one_sided.collect::<Result<Vec<_>, (&'static str, String)>>()?;
        if linear.is_some() && residue.is_none() {
            let why = if has_angle(scene) {
                "the contact sticks to a table that only tilts, so the angle has no block of its own"
            } else {
                "a point mass has no angle to circle"
            };
            notes.push(format!("residue is null: {why}"));
        }
        Ok(Self {
            scene: Resolved(*scene),
            model: ModelChoice::of(scene),
            at: JacobianPlace {
                kind: match at {
                    At::FixedPoint => "fixed_point",
                    At::State(..) => "state",
                    At::Impact(_) => "impact",
                },
                impact: match at {
                    At::Impact(impact) => Some(impact),
                    At::FixedPoint | At::State(..) => None,
                },
                state: JacobianState {
                    x: state_order.contains(&"x").then_some(x),
                    theta: state.theta,
                    x_dot: state.x_dot,
                    y_dot: state.y_dot,
                    theta_dot: has_angle(scene).then_some(state.theta_dot),
                },
            },
            period,
            state_order,
            determinant,
            matrix: rows(&matrix),
            eigenvalues: eigenvalues.into_iter().map(Eigenvalue::from).collect(),
            residue,
            defective,
            flight_time,
            contact_velocity,
            contact_mode: contact_mode.name(),
            smooth: one_sided.is_empty(),
            one_sided,
            notes,
        })
    }
}

impl Tabular for JacobianAnswer {
    /// A row for each component of the state at the end.
    fn to_table(&self) -> Cow<'_, Table> {
        let mut columns = vec![Column {
            name: "component",
            unit: "",
            cells: Cells::Words(self.state_order.iter().map(|&name| Some(name)).collect()),
        }];
        for (index, name) in self.state_order.iter().enumerate() {
            let cells = Cells::Numbers(self.matrix.iter().map(|row| row[index]).collect());
            columns.push(Column { name, unit: "", cells });
        }
        Cow::Owned(Table(columns))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["matrix"]
    }

    fn end(&self) -> impl Serialize {
        self
    }
}

/// The state at which to differentiate.
fn place(scene: &Scene, at: At, go_on: impl FnMut() -> bool) -> Result<(f64, State), Refusal> {
    match at {
        At::FixedPoint => {
            let SmallDeviations { fixed_point, .. } = small_deviations(&scene.without_noise())
                .map_err(|why| ("/at", format!("the scene has no fixed point: {why}")))?;
            Ok((fixed_point.x, fixed_point.state()))
        }
        At::State(x, state) if has_angle(scene) => Ok((x, state)),
        At::State(x, State { theta, x_dot, y_dot, theta_dot }) => {
            if theta != 0.0 || theta_dot != 0.0 {
                return Err(Refusal::At(
                    "/at/state",
                    "a point mass has no theta and no theta_dot; leave them out".to_owned(),
                ));
            }
            Ok((x, Body::point_state(x_dot, y_dot)))
        }
        At::Impact(impact) => {
            let before = run_to_impact(scene, impact, "/at/impact", go_on)?.coming;
            Ok((before.x, before.state))
        }
    }
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

fn eigenvalues_of(matrix: &DMatrix<f64>, pointer: &'static str) -> Result<Vec<Complex<f64>>, (&'static str, String)> {
    jacobian::eigenvalues(matrix).ok_or((pointer, "the eigenvalues of this derivative did not converge".to_owned()))
}

fn power(value: Complex<f64>, exponent: u64) -> Complex<f64> {
    (1..exponent).fold(value, |product, _| product * value)
}

/// Residue of the angle over some bounces by that over one: 1 − 2R = cos σ, by Chebyshev's polynomials.
fn residue_over(residue: f64, period: u64) -> f64 {
    let cosine = 1.0 - 2.0 * residue;
    let (mut before, mut last) = (1.0, cosine);
    for _ in 1..period {
        (before, last) = (last, 2.0 * cosine * last - before);
    }
    if period == 1 { residue } else { 0.5 * (1.0 - last) }
}
