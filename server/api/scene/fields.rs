//! Titles, symbols and prose of scene fields for clients, `/v1/fields`, and scenes in the contract: as they are asked for, answered, and set
//! during a run.
//!
//! Paths, units, ranges and defaults are not here: they come from the physics. The compiler asks for the words of every new field.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use equipoise_physics::map::polygon::{FARTHEST, FEWEST_VERTICES, MAX_VERTICES};
use equipoise_physics::scene::{
    FIELDS, Field, FieldError, FieldErrorKind, FieldKind, Name, VERTICES, Value as FieldValue,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::api::scene::write::{Resolved, value_to_json};
use crate::api::schemas::component;
use crate::schema_names;
use crate::words;

/// Words about a field for forms, error messages and the contract.
#[derive(Debug, Clone, Copy)]
pub struct FieldText {
    /// Title for forms.
    pub title: &'static str,
    /// Symbol in formulas; empty if there is none.
    pub symbol: &'static str,
    /// Meaning, in one sentence without a full stop.
    pub about: &'static str,
    /// Further sentences for the contract, without the last full stop; may be empty.
    pub detail: &'static str,
    /// Example of a value in a query; empty if there is none.
    pub example: &'static str,
}

/// Words about a field, without those that it may lack.
const fn text(title: &'static str, symbol: &'static str, about: &'static str) -> FieldText {
    FieldText { title, symbol, about, detail: "", example: "" }
}

impl FieldText {
    const fn detail(self, detail: &'static str) -> Self {
        Self { detail, ..self }
    }

    const fn example(self, example: &'static str) -> Self {
        Self { example, ..self }
    }
}

/// Words about a field.
#[rustfmt::skip]
pub fn field_text(name: Name) -> FieldText {
    match name {
        Name::ContactDistance => text("Contact distance", "l", "Distance from the centre of gravity to the contact point").example("0.13333333333333333")
            .detail("With `body.radius_of_gyration` it gives a rod"),
        Name::RadiusOfGyration => text("Radius of gyration", "ρ", "Radius of gyration about the centre of gravity").example("0.09428090415820635")
            .detail("Its square is the moment of inertia per unit mass"),
        Name::PointMass => text("Point mass", "", "A body without an angle: the table tilts by κ times the angle of its velocity")
            .detail("Excludes the other fields of `body`. False means the same as leaving it out"),
        Name::Offset => text("Offset", "d", "Distance of the centre of gravity from the axis of the rod").example("0")
            .detail("Positive to the right of an upright axis. `body.contact_distance` is then the distance along the axis. Angles of answers are those of the line from contact point to centre of gravity: the axis leans by arctan(d/a) more, and the table senses the axis"),
        Name::ContactVertex => text("Contact vertex", "", "Number of the vertex of a polygon that bounces, from 0; by default the lowest")
            .detail("There is no default if two vertices of the polygon as drawn are equally low. The vertex has to be a corner of the convex hull: otherwise another vertex always touches a flat table before it"),
        Name::Gravity => text("Gravity", "g", "Acceleration of gravity").example("9.81"),
        Name::Incline => text("Incline", "φ", "Angle of the plane of motion from horizontal; gravity in the plane is G = g sin φ").example("1.2"),
        Name::Drag => text("Drag", "c", "Rate at which the air takes the velocity of the centre of gravity, as on an air table").example("0")
            .detail("The velocity in the plane decays by v̇ = g − cv in flight. Default 0. The method `linear` answers 422. Likewise `air.rotation_drag`"),
        Name::RotationDrag => text("Drag of rotation", "c_θ", "Rate at which the air takes the angular velocity").example("0")
            .detail("θ̈ = −c_θθ̇ in flight. Default 0. Not for a point mass"),
        Name::Wind => text("Wind", "u", "Velocity of the air along x").example("0")
            .detail("`air.drag` takes the velocity relative to the air: ẍ = −c(ẋ − u) in flight, so the body drifts towards u. Default 0. It needs `air.drag`, and does nothing where that is 0"),
        Name::Restitution => text("Restitution", "e", "Coefficient of restitution").example("1"),
        Name::Friction => text("Friction", "μ", "Coefficient of Coulomb friction").example("0")
            .detail("A value above 0 is taken by `trajectories`, `live`, `live/events`, `jacobians`, `stability`, `regions`, `periodic-orbits`, `ladder`, `ensembles`, `controllers`, `catches`, `throws`, `previews`, `precision`, `fits` and batches of them. Requests with the method `linear` answer 422"),
        Name::Law => text("Restitution law", "", "Law of restitution; the laws differ only with friction").example("poisson"),
        Name::TiltGain => text("Tilt gain", "κ", "The table tilts by α = κθ").example("1.2")
            .detail("Required unless `table.feedback` is given"),
        Name::EnergyGain => text("Energy gain", "κ_E", "Gain of the feedback from missing energy to the table's speed").example("0")
            .detail("A gain other than 0 needs `table.target_height` or `table.program`"),
        Name::TargetHeight => text("Target height", "y*", "Height of the centre of gravity at the top of the wanted bounce; needed with an energy gain").example("0.25"),
        Name::EnergyMeasure => text("Energy measure", "", "Energy that the table measures and steers to G y*").example("total")
            .detail("`vertical`, the default: η = ½ẏ² + G l cos θ (eq. 28). `total`: E = ½(ẋ² + ẏ² + ρ²θ̇²) + G l cos θ, with which a swing neither grows nor dies out by the feedback. It has no effect without an energy gain"),
        Name::EnergyLaw => text("Energy law", "", "Law by which strikes bring the energy to its target").example("proportional")
            .detail("`proportional`, the default: the strike grows with `table.energy_gain` times the missing energy. `one_strike`: each strike brings the total energy to the target, with no gain; the table does not know of friction. A strike can take no more than the energy of the normal velocity; where that is too little the contact point stays on the table, and the run ends as `settled` or `sinking` unless the tilted table lifts it"),
        Name::Program => text("Program", "", "Target heights, one for each strike, in a cycle: juggling")
            .detail("Strike n takes the height number n, in a cycle, in place of `table.target_height`. A single bounce then does not repeat, so `stability` has no verdict; `periodic-orbits` has the orbit of a whole cycle"),
        Name::Strike => text("Strike", "", "Motion of the table along its normal at a strike").example("compensated")
            .detail("`compensated`: the table makes up the energy that restitution loses. `still`: it does not move"),
        Name::Slide => text("Slide", "", "Motion of the table along itself at a strike").example("none")
            .detail("`matched`: as fast as the contact point just before the strike. The method `linear` refuses it"),
        Name::FeedbackX => text("Gain of x", "K_x", "Gain of the state feedback α = −K·(x, θ, ẋ, θ̇) on the position, in place of the tilt gain"),
        Name::FeedbackTheta => text("Gain of θ", "K_θ", "Gain of the state feedback on the angle"),
        Name::FeedbackXDot => text("Gain of ẋ", "K_ẋ", "Gain of the state feedback on the horizontal velocity"),
        Name::FeedbackThetaDot => text("Gain of θ̇", "K_θ̇", "Gain of the state feedback on the angular velocity")
            .detail("Not for a point mass"),
        Name::AssumedRestitution => text("Assumed restitution", "ê", "Restitution that the table assumes; by default the true one"),
        Name::AngleBias => text("Angle bias", "b", "Constant error of the sensed angle: the table senses θ + b").example("0"),
        Name::TiltOffset => text("Tilt offset", "c", "Constant error of the tilt: the table tilts by c more than it should").example("0"),
        Name::TiltGainError => text("Tilt gain error", "ε_α", "Relative error of the tilt: the table tilts by 1 + ε_α times its law").example("0"),
        Name::SpeedError => text("Speed error", "ε_w", "Relative error of the table's speed: it moves along its normal at 1 + ε_w times its law").example("0")
            .detail("Not with `table.strike` `still`"),
        Name::TiltRate => text("Tilt rate", "α̇", "Turning of the table as it strikes").example("follows")
            .detail("`none`, also the default: the table does not turn as it strikes. `follows`: it follows α = κθ or its state feedback, so it turns at α̇ = κθ̇ or −(K_xẋ + K_θθ̇), and its surface moves by that besides. `corrected`: it turns so, and its law takes that off its speed, and off its slide with `table.slide` `matched`. It has no effect without `table.pivot`. Not with `noise.model` `plan`"),
        Name::PivotX => text("Pivot", "x_p", "Horizontal place of the pivot about which the table turns").example("0")
            .detail("By default the table turns about a pivot under each contact. It has no effect without `table.tilt_rate`"),
        Name::PivotDepth => text("Pivot depth", "p", "Depth of the pivot below the surface of the table, along its normal").example("0.05")
            .detail("Negative above it. Default 0. It has no effect without `table.tilt_rate`"),
        Name::Delay => text("Delay", "τ_d", "Time before a strike at which the table senses the body").example("0")
            .detail("In a shorter flight the table takes the state at its beginning. Unless the table predicts the flight, `periodic-orbits`, `precision`, `controllers`, `catches`, `throws` and the method `linear` answer 422"),
        Name::Prediction => text("Prediction", "", "Use that the table makes of the state sensed `table.delay` before the strike").example("flight")
            .detail("`none`, the default with a delay: it takes the state for that at the strike. `flight`: it carries the state on along the flight, which is exact but for `noise`"),
        Name::TableLength => text("Table length", "L", "Length of the table; a contact beyond one of its ends ends the run")
            .detail("The outcome is then `off_table`. The middle of the table is at x = 0. Catches, throws and the method `linear` answer 422"),
        Name::TiltLimit => text("Tilt limit", "α_max", "Largest tilt of the table; a strike that needs more ends the run").example("0.5")
            .detail("The outcome is then `beyond_limits`"),
        Name::TiltRateLimit => text("Tilt rate limit", "α̇_max", "Largest mean tilt rate from strike to strike").example("5"),
        Name::SpeedLimit => text("Speed limit", "v_max", "Largest speed of the table at a strike").example("1"),
        Name::StrokeLimit => text("Stroke limit", "s_max", "Longest vertical stroke of the table from strike to strike, along the cubic between their velocities").example("0.1"),
        Name::Height => text("Height", "y₀", "Height of the centre of gravity at release").example("0.2")
            .detail("Heights count from the height at which contacts happen"),
        Name::Theta => text("Angle", "θ₀", "Angle from upright at release").example("0.3")
            .detail("Counter-clockwise"),
        Name::ThetaDot => text("Spin", "θ̇₀", "Angular velocity at release").example("0.1")
            .detail("Counter-clockwise"),
        Name::X => text("Place", "x₀", "Horizontal position of the centre of gravity at release").example("0"),
        Name::XDot => text("Horizontal velocity", "ẋ₀", "Horizontal velocity at release").example("0.05"),
        Name::YDot => text("Vertical velocity", "ẏ₀", "Vertical velocity at release, upwards").example("-0.1"),
        Name::ToppleAngle => text("Topple angle", "θ_max", "A contact at this angle or more, to either side, counts as toppled").example("1.4")
            .detail("The run then ends as `toppled`"),
        Name::TimingSd => text("Timing noise", "σ_t", "Standard deviation of the error in the impact time on which the table acts").example("0"),
        Name::AngleSd => text("Angle noise", "σ_θ", "Standard deviation of the error in the angle that the table senses").example("0"),
        Name::XSd => text("Noise of the place", "σ_x", "Standard deviation of the error in the position that the table senses").example("0")
            .detail("It acts where `table.feedback.x` is given. Catches and throws answer 422; likewise with the next four"),
        Name::XDotSd => text("Noise of ẋ", "σ_ẋ", "Standard deviation of the error in the horizontal velocity that the table senses").example("0"),
        Name::YDotSd => text("Noise of ẏ", "σ_ẏ", "Standard deviation of the error in the vertical velocity that the table senses").example("0"),
        Name::ThetaDotSd => text("Noise of θ̇", "σ_θ̇", "Standard deviation of the error in the angular velocity that the table senses").example("0")
            .detail("Not for a point mass"),
        Name::RestitutionSd => text("Scatter of restitution", "σ_e", "Standard deviation of the restitution from impact to impact, about contact.restitution").example("0")
            .detail("A draw beyond 0 or 1 is cut to it"),
        Name::NoiseModel => text("Noise model", "", "Action of the table at a wrong time: it meets the body there (`strike`), or carries out the plan made for that time (`plan`)"),
        Name::Seed => text("Seed", "", "Seed of the noise"),
        Name::NoiseRun => text("Run", "", "Number of the run, in an ensemble with this seed"),
    }
}

/// Adds to errors of the physics what a client needs to mend its request.
pub fn explain(errors: Vec<FieldError>) -> Vec<FieldError> {
    let explained = |error: FieldError| match error.kind {
        FieldErrorKind::Missing(name) => {
            let row = name.row();
            let detail = format!("{} is missing: {}, {}", row.key(), field_text(name).about, row.limits());
            FieldError { detail, ..error }
        }
        FieldErrorKind::SaidTwice => {
            FieldError { detail: format!("{} (null takes a preset's back)", error.detail), ..error }
        }
        FieldErrorKind::Other => error,
    };
    errors.into_iter().map(explained).collect()
}

/// `GET /v1/fields`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Fields {
    items: Vec<FieldRow>,
}

words! {
    /// Kind of a field. `numbers` is an array of numbers, `vertices` an array of points [x, y].
    FieldKindName = ["number", "integer", "boolean", "choice", "numbers", "vertices"];
}

/// One field.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Field")]
struct FieldRow {
    /// Dotted path in a scene, as `table.tilt_gain`.
    field: &'static str,
    /// Symbol in formulas; empty if there is none.
    symbol: &'static str,
    /// First part of `field`.
    group: &'static str,
    title: &'static str,
    about: &'static str,
    /// "1" for a field without a unit.
    unit: &'static str,
    #[schemars(with = "FieldKindName")]
    kind: &'static str,
    /// Least value; of an array, of each number.
    #[schemars(with = "Option<f64>")]
    minimum: Option<Value>,
    /// Greatest value; of an array, of each number.
    #[schemars(with = "Option<f64>")]
    maximum: Option<Value>,
    /// Null if there is none.
    #[schemars(with = "Option<FieldDefault>")]
    default: Option<Value>,
    /// True if a rod needs the field.
    required: bool,
    choices: Option<&'static [&'static str]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    count: Option<CountRange>,
    /// True if the field can be set during a live run.
    live: bool,
}

/// Default of a field.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "a schema alone: the value is JSON")]
enum FieldDefault {
    Number(f64),
    Text(String),
    Flag(bool),
}

/// Least and greatest number of values of an array. Absent where `kind` is neither `numbers` nor `vertices`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct CountRange {
    minimum: usize,
    maximum: usize,
}

impl Fields {
    /// The whole table. The vertices of a polygon, which are no single value, come last in their group.
    pub fn all() -> Self {
        let mut items: Vec<FieldRow> = FIELDS.iter().map(FieldRow::of).collect();
        let vertices = FieldRow::vertices();
        let place = items.iter().rposition(|row| row.group == vertices.group).map_or(0, |last| last + 1);
        items.insert(place, vertices);
        Self { items }
    }
}

impl FieldRow {
    fn of(row: &'static Field) -> Self {
        let (kind, minimum, maximum, choices) = match row.kind {
            FieldKind::Number { minimum, maximum } => ("number", Some(minimum.into()), Some(maximum.into()), None),
            FieldKind::Integer { maximum } => ("integer", Some(0.into()), Some(maximum.into()), None),
            FieldKind::Choice(choices) => ("choice", None, None, Some(choices)),
            FieldKind::Flag => ("boolean", None, None, None),
            FieldKind::Numbers { minimum, maximum, .. } => {
                ("numbers", Some(minimum.into()), Some(maximum.into()), None)
            }
        };
        let count = match row.kind {
            FieldKind::Numbers { most, .. } => Some(CountRange { minimum: 1, maximum: most }),
            _ => None,
        };
        let FieldText { title, symbol, about, .. } = field_text(row.name);
        Self {
            field: row.path,
            symbol,
            group: row.group(),
            title,
            about,
            unit: row.unit,
            kind,
            minimum,
            maximum,
            default: row.default.map(value_to_json),
            required: row.required,
            choices,
            count,
            live: row.live,
        }
    }

    fn vertices() -> Self {
        Self {
            field: VERTICES,
            symbol: "",
            group: "body",
            title: "Vertices",
            about: "Corners [x, y] of a polygon, counter-clockwise, in place of the two lengths",
            unit: "m",
            kind: "vertices",
            minimum: Some((-FARTHEST).into()),
            maximum: Some(FARTHEST.into()),
            default: None,
            required: false,
            choices: None,
            count: Some(CountRange { minimum: FEWEST_VERTICES, maximum: MAX_VERTICES }),
            live: false,
        }
    }
}

impl JsonSchema for Resolved {
    fn schema_name() -> Cow<'static, str> {
        "Scene".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({"$ref": "#/components/schemas/Scene"})
    }
}

schema_names! {
    pub PresetName;
    pub ScenePatch;
}

/// A number for people: multiples of π as such.
pub fn number(value: f64) -> String {
    match value {
        PI => "π".to_owned(),
        FRAC_PI_2 => "π/2".to_owned(),
        _ if value == -PI => "-π".to_owned(),
        _ => value.to_string(),
    }
}

/// Range and default of a field in a sentence; empty if it has neither.
pub(super) fn range(row: &Field) -> String {
    let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
    let default = match row.default {
        Some(FieldValue::Number(value)) => Some(number(value)),
        Some(FieldValue::Choice(word)) => Some(format!("`{word}`")),
        Some(value) => Some(value.to_string()),
        None => None,
    };
    let range = match row.kind {
        FieldKind::Numbers { minimum, maximum, most } => {
            Some(format!("from 1 to {most} numbers, each from {} to {}{unit}", number(minimum), number(maximum)))
        }
        FieldKind::Number { minimum, maximum } => {
            Some(format!("from {} to {}{unit}", number(minimum), number(maximum)))
        }
        FieldKind::Integer { maximum } => Some(format!("from 0 to {maximum}")),
        FieldKind::Choice(_) | FieldKind::Flag => None,
    };
    let parts: Vec<String> = range.into_iter().chain(default.map(|value| format!("by default {value}"))).collect();
    let mut sentence = parts.join(", ");
    if let Some(first) = sentence.get(..1).map(str::to_uppercase) {
        sentence.replace_range(..1, &first);
        sentence.push('.');
    }
    sentence
}

pub(super) fn description(row: &Field, with_detail: bool) -> String {
    let text = field_text(row.name);
    let detail = if with_detail { text.detail } else { "" };
    let sentences = [text.about, detail].into_iter().filter(|part| !part.is_empty()).map(|part| format!("{part}."));
    let all: Vec<String> = sentences.chain([range(row)]).filter(|part| !part.is_empty()).collect();
    all.join(" ")
}

/// An example of a value in a query.
pub(super) fn example(row: &Field) -> Option<Value> {
    let text = field_text(row.name).example;
    let number = serde_json::from_str(text).ok();
    number.or((!text.is_empty()).then(|| json!(text)))
}

/// The values that a field takes.
pub(super) fn value_schema(row: &Field) -> Value {
    let mut schema = match row.kind {
        FieldKind::Number { minimum, maximum } => json!({"type": "number", "minimum": minimum, "maximum": maximum}),
        FieldKind::Integer { maximum } => {
            let mut schema = json!({"type": "integer", "minimum": 0, "maximum": maximum});
            // Generated clients take 32 bits otherwise.
            if maximum > i32::MAX as u64 {
                schema["format"] = json!("int64");
            }
            schema
        }
        FieldKind::Choice(_) => json!({"$ref": format!("#/components/schemas/{}", component(row.path))}),
        FieldKind::Flag => json!({"type": "boolean"}),
        FieldKind::Numbers { minimum, maximum, most } => json!({
            "type": "array", "minItems": 1, "maxItems": most, "items": {"type": "number", "minimum": minimum, "maximum": maximum},
        }),
    };
    if let Some(value) = row.default {
        schema["x-default"] = value_to_json(value);
    }
    if !matches!(row.kind, FieldKind::Choice(_) | FieldKind::Flag) {
        schema["x-unit"] = json!(row.unit);
    }
    let symbol = field_text(row.name).symbol;
    if !symbol.is_empty() {
        schema["x-symbol"] = json!(symbol);
    }
    schema
}

/// Schemas of the fields that are one of some words. Each has a name, because generators declare one type for each.
pub fn choices() -> impl Iterator<Item = (String, Value)> {
    FIELDS.iter().filter_map(|row| match row.kind {
        FieldKind::Choice(words) => Some((component(row.path), json!({"type": "string", "enum": words}))),
        _ => None,
    })
}

fn field_schema(path: &str) -> Value {
    let Some(row) = FIELDS.iter().find(|row| row.path == path) else { return vertices() };
    let mut schema = value_schema(row);
    schema["description"] = json!(description(row, true));
    schema
}

const VERTICES_WORD: &str = "A polygon: vertices [x, y] of a sheet of even density, in metres, counter-clockwise, anywhere in the plane. The outline must not meet itself. \
    Centre of gravity, l and ρ follow from it. The polygon is turned so that at θ = 0 the centre of gravity is straight above the contact vertex. It \
    bounces as the rod of that l and ρ. The run ends as `other_vertex` as soon as another vertex touches the table.";

fn vertices() -> Value {
    json!({
        "type": "array",
        "minItems": 3,
        "maxItems": MAX_VERTICES,
        "items": {
            "type": "array", "minItems": 2, "maxItems": 2,
            "items": {"type": "number", "minimum": -FARTHEST, "maximum": FARTHEST},
        },
        "x-unit": "m",
        "description": VERTICES_WORD,
    })
}

/// The vertices stand before the contact vertex, which is one of them.
pub(super) fn with_vertices(path: &'static str) -> Vec<&'static str> {
    if path == Name::ContactVertex.row().path { vec![VERTICES, path] } else { vec![path] }
}

/// Forms in which a scene stands in the contract.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// As it is asked for: null takes a value back.
    Patch,
    /// As it is answered.
    Answer,
    /// As it is set during a run.
    Live,
}

/// A scene as it is asked for.
pub fn patch() -> Value {
    let mut schema = tree(Form::Patch, "");
    schema["description"] =
        json!("A scene, or what changes in that of the preset. Null takes a value of the preset back.");
    schema["type"] = json!("object");
    schema
}

/// A scene as it is answered.
pub fn scene() -> Value {
    let mut schema = tree(Form::Answer, "");
    schema["description"] = json!("The scene with all defaults. It is valid in a request.");
    schema
}

/// The fields that can be set during a run, nested or by dotted path.
pub fn live_fields() -> Value {
    let mut schema = tree(Form::Live, "");
    for row in FIELDS.iter().filter(|row| row.live) {
        schema["properties"][row.path] = field_schema(row.path);
    }
    schema["description"] = json!("Fields that can be set during a run, nested or by dotted path.");
    schema["minProperties"] = json!(1);
    schema
}

/// The same by dotted path alone.
pub fn live_paths() -> Map<String, Value> {
    let live = FIELDS.iter().filter(|row| row.live);
    live.map(|row| (row.path.to_owned(), field_schema(row.path))).collect()
}

/// An object of the fields below `group` (empty or ending in a dot).
fn tree(form: Form, group: &str) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    let paths = FIELDS.iter().filter(|row| form != Form::Live || row.live).flat_map(|row| with_vertices(row.path));
    for path in paths.filter(|path| form != Form::Live || *path != VERTICES) {
        let Some(rest) = path.strip_prefix(group) else { continue };
        let (key, is_group) = rest.split_once('.').map_or((rest, false), |(key, _)| (key, true));
        if properties.contains_key(key) {
            continue;
        }
        let schema = match (form, is_group, key) {
            (Form::Answer, true, "body") => bodies(),
            (_, true, _) => tree(form, &format!("{group}{key}.")),
            (_, false, _) => field_schema(path),
        };
        properties.insert(key.to_owned(), if form == Form::Patch { or_null(schema) } else { schema });
    }
    if form == Form::Answer {
        let below = FIELDS.iter().filter(|row| is_always_answered(row)).filter_map(|row| row.path.strip_prefix(group));
        for key in below.map(|rest| rest.split('.').next().unwrap_or(rest)) {
            if !required.contains(&key) {
                required.push(key);
            }
        }
    }
    let mut schema = json!({"type": "object", "additionalProperties": false});
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema["properties"] = Value::Object(properties);
    schema
}

fn or_null(mut schema: Value) -> Value {
    match schema.as_object_mut().and_then(|schema| schema.shift_remove("$ref")) {
        Some(of_words) => schema["anyOf"] = json!([{"$ref": of_words}, {"type": "null"}]),
        None => schema["type"] = json!([schema["type"], "null"]),
    }
    schema
}

/// Tells whether every scene that is answered has the field. A point mass has no angle, and state feedback no tilt gain.
fn is_always_answered(row: &Field) -> bool {
    let depends = matches!(row.name, Name::Theta | Name::ThetaDot | Name::TiltGain);
    (row.default.is_some() || row.required) && !depends
}

/// The three kinds of body, each with all of its fields.
fn bodies() -> Value {
    let [length, rho, offset, point, contact_vertex] =
        [Name::ContactDistance, Name::RadiusOfGyration, Name::Offset, Name::PointMass, Name::ContactVertex]
            .map(|name| name.row().path);
    let kinds = [
        ("A rod.", vec![length, rho], vec![offset]),
        ("A point mass.", vec![point], vec![]),
        ("A polygon.", vec![VERTICES, contact_vertex], vec![]),
    ];
    let body = |(about, paths, optional): (&str, Vec<&str>, Vec<&str>)| {
        let key = |path: &&str| path.trim_start_matches("body.").to_owned();
        let properties: Map<_, _> = paths.iter().chain(&optional).map(|path| (key(path), field_schema(path))).collect();
        json!({
            "type": "object",
            "description": about,
            "additionalProperties": false,
            "required": paths.iter().map(key).collect::<Vec<_>>(),
            "properties": properties,
        })
    };
    json!({"oneOf": kinds.map(body)})
}
