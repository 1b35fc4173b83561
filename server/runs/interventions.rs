//! Interventions in a request: reads them with the scene of their run, and writes them as parameters of a query.

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::catching::throw::ThrowTarget;
use equipoise_physics::control::bounce_model::STATE;
use equipoise_physics::map::body::Kick;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{FIELDS, Field, Name, Scene, Value as FieldValue, field};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

use crate::api::computed::catches::request::strategy_name;
use crate::api::scene::read::SceneSpec;
use crate::api::scene::{Resolved, has_angle, read_value, value_to_query};
use crate::api::shared::refusal::lacking;
use crate::http::request::fields::{Absence, FieldList, FieldSpec, Fields, Number, Object, Or, number, whole};
use crate::http::request::reader;
use crate::http::request::reader::{Source, join};
use crate::http::{Errors, Reader};
use crate::limits;
use crate::request_fields;
use crate::runs::run::{KICK_SPEED, KICK_SPIN, Run, ThrowOrder};

/// Latest time of a throw, s: the run times of a live run's clock end there.
const THROW_TIMES: std::ops::RangeInclusive<f64> = 0.0..=2e14;

/// Error of a kick that would turn a point mass.
pub const NO_ANGLE: &str = "a point mass has no theta_dot; leave it out";

request_fields! {
    /// What happens at an impact: a `set`, a `kick`, a `catch` or a `throw`, or several.
    #[derive(Debug)]
    struct InterventionRequest {
        /// Number of the impact, from 1.
        impact: u64 = whole(1..=limits::LIVE_BOUNCES).required(),
        /// Fields set from the strike of this impact on.
        set: Vec<(Name, FieldValue)> = SetSpec,
        /// Velocities to add just after the impact.
        kick: Option<Kick> = KickSpec,
        /// A catch that begins with this impact. `{}` takes all defaults.
        catch: Option<CatchSettings> = Object.optional(),
        /// A throw at this impact, in place of the strike of the table's law. A body that is held after the impact before is thrown from the table,
        /// which first gives way and goes to the tilt of the throw. A throw that is impossible does not happen. Beside a `catch` it needs a time `t`.
        throw: Option<ThrowOrder> = Object.optional(),
    }
}

request_fields! {
    impl Kick {
        /// Added to the horizontal velocity, m/s.
        x_dot: f64 = number(-KICK_SPEED..=KICK_SPEED, "m/s").or(0.0),
        /// Added to the vertical velocity, m/s.
        y_dot: f64 = number(-KICK_SPEED..=KICK_SPEED, "m/s").or(0.0),
        /// Added to the angular velocity, rad/s.
        theta_dot: f64 = number(-KICK_SPIN..=KICK_SPIN, "rad/s").or(0.0),
    }
}

request_fields! {
    impl ThrowOrder {
        /// The top of the flight after the throw.
        apex: ThrowTarget = Object.required(),
        /// Earliest time of the throw of a body that is held, since the release, s. By default as soon as it is held.
        t: Option<f64> = number(THROW_TIMES, "s").optional(),
    }
}

/// The scene of a run, and its interventions.
#[derive(Debug, Clone, Copy)]
pub struct RunSpec;

impl FieldSpec<Run> for RunSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Run> {
        let scene: Option<Scene> = SceneSpec.read(reader, name);
        let mut interventions = Vec::new();
        let most = limits::LIVE_INTERVENTIONS;
        reader.objects("interventions", most, |_, item| interventions.push(read_intervention(item)));
        let mut run = Run::new(scene?);
        for (index, intervention) in interventions.into_iter().enumerate() {
            let Some(intervention) = intervention else { continue };
            let pointer = format!("{}/{index}", reader.pointer_to("interventions"));
            apply(&mut run, &intervention, &pointer, reader.errors());
        }
        Some(run)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        FieldSpec::<Scene>::describe(&SceneSpec, name, about, list);
        let item = json!({"$ref": "#/components/schemas/Intervention"});
        let all = json!({"type": "array", "maxItems": limits::LIVE_INTERVENTIONS, "default": [], "items": item});
        list.property("interventions", INTERVENTIONS, &all);
        list.parameter("interventions", INTERVENTION_PARAMETERS, json!({"type": "object"}), None);
    }
}

const INTERVENTIONS: &str = "Interventions during the run: fields set from the strike of an impact on, kicks just after it, and catches and throws. A run that \
    is caught ends with the outcome of its catch. The run then uses the map without error estimates: other methods and a `tolerance` are a 422.";

const INTERVENTION_PARAMETERS: &str = "Interventions during the run, by index from 0: `interventions.<i>.impact` with `interventions.<i>.set.<path of a field>`, \
    `interventions.<i>.kick.theta_dot`, `interventions.<i>.catch.strategy`, `interventions.<i>.throw.apex.height` and the other fields of an \
    Intervention. The parameter itself is never sent by this bare name.";

/// A run as [`RunSpec`], with the time of its contact after the bounces.
#[derive(Debug, Clone, Copy)]
pub struct HeldRunSpec;

/// Time for which a run goes on in contact after its bounces, s.
fn hold() -> Or<Number, f64> {
    number(0.0..=limits::HOLD_TIME, "s").or(0.0)
}

impl FieldSpec<Run> for HeldRunSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Run> {
        let hold = hold().read(reader, "hold");
        Some(RunSpec.read(reader, name)?.holding(hold?))
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        RunSpec.describe(name, about, list);
        let about = "Time for which a run that ended as `settled` is followed in contact, under its own table, s.";
        hold().describe("hold", about, list);
    }
}

/// Everything that determines a run.
impl Serialize for Run {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (Resolved(**self.scene()), self.hold(), intervention_parameters(self)).serialize(serializer)
    }
}

/// Fields to set in a run; none if it is absent.
struct SetSpec;

impl FieldSpec<Vec<(Name, FieldValue)>> for SetSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Vec<(Name, FieldValue)>> {
        let (source, pointer) = (reader.source(), reader.pointer_to(name));
        match reader.value(name) {
            None => Some(Vec::new()),
            Some(Value::Object(fields)) => read_set(fields, &pointer, source, reader.errors()),
            Some(other) => {
                reader.refuse(name, format!("{name} is {}; it must be an object", reader::shown(other)));
                None
            }
        }
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        list.property(name, about, &json!({"$ref": "#/components/schemas/LiveFields"}));
    }
}

/// A kick with at least one of its velocities.
struct KickSpec;

impl FieldSpec<Option<Kick>> for KickSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Option<Kick>> {
        Some(reader.within(name, read_kick).flatten())
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let mut schema = list.nested(name, Kick::describe_fields);
        schema["minProperties"] = json!(1);
        list.property(name, about, &schema);
    }
}

/// The schema of an intervention.
pub fn intervention_schema() -> Value {
    let mut list = FieldList::default();
    InterventionRequest::describe_fields(&mut list);
    let mut schema = list.into_schema();
    schema["description"] = json!(
        "What happens at an impact: a `set`, a `kick`, a `catch` or a `throw`, or several. Beside a `catch`, a `throw` needs a time `t`."
    );
    schema
}

fn apply(run: &mut Run, intervention: &InterventionRequest, pointer: &str, errors: &mut Errors) {
    let InterventionRequest { impact, set, kick, catch, throw } = intervention;
    if !set.is_empty()
        && let Err(found) = run.set(*impact, set)
    {
        for error in found {
            let place = if error.path.is_empty() { String::new() } else { format!("/set/{}", error.path) };
            errors.push(format!("{pointer}{}", place.replace('.', "/")), error.detail);
        }
    }
    if let Some(kick) = kick {
        if kick.theta_dot != 0.0 && !has_angle(run.scene()) {
            errors.push(format!("{pointer}/kick/theta_dot"), NO_ANGLE);
        } else if let Err(detail) = run.kick(*impact, *kick) {
            errors.push(pointer, detail);
        }
    }
    if (catch.is_some() || throw.is_some())
        && let Some(detail) = lacking(run.scene(), if catch.is_some() { Analysis::Catch } else { Analysis::Throw })
    {
        let name = if catch.is_some() { "catch" } else { "throw" };
        errors.push(format!("{pointer}/{name}"), detail);
        return;
    }
    // A catch takes the place of a throw at the same impact, so it comes first.
    let caught = catch.map_or(Ok(()), |settings| run.catch(*impact, settings));
    if let Err(detail) = caught.and_then(|()| throw.map_or(Ok(()), |order| run.throw(*impact, order))) {
        errors.push(pointer, detail);
    }
}

fn read_intervention(item: &mut Reader<'_, '_>) -> Option<InterventionRequest> {
    let intervention = InterventionRequest::read_fields(item);
    if ["set", "kick", "catch", "throw"].iter().all(|name| !item.has(name)) {
        item.refuse_whole("an intervention is a set, a kick, a catch or a throw, and this is none of them");
    }
    if let Some(InterventionRequest { catch: Some(_), throw: Some(ThrowOrder { t: None, .. }), .. }) = &intervention {
        item.refuse(
            "throw",
            "a catch and a throw act at the same impact; leave one of them out, or give the throw a time t",
        );
    }
    intervention
}

/// Reads a kick: velocities to add, at least one of them.
pub fn read_kick(reader: &mut Reader<'_, '_>) -> Option<Kick> {
    let kick = Kick::read_fields(reader);
    if !["x_dot", "y_dot", "theta_dot"].iter().any(|name| reader.has(name)) {
        reader.refuse_whole("a kick needs x_dot, y_dot or theta_dot");
        return None;
    }
    kick
}

/// Reads the fields to set, nested or by dotted path. Returns None if something is wrong; `errors` then says it.
pub fn read_set(
    fields: &Map<String, Value>,
    pointer: &str,
    source: Source,
    errors: &mut Errors,
) -> Option<Vec<(Name, FieldValue)>> {
    let (before, mut set) = (errors.len(), Vec::new());
    read_group(fields, "", pointer, source, errors, &mut set);
    if set.is_empty() && errors.len() == before {
        errors.push(pointer, "there is nothing to set; name a field, as in `table.tilt_gain`");
    }
    set.sort_by_key(|(name, _)| *name as usize);
    if let Some(twice) = set.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        errors.push(pointer, format!("{} is there twice", twice[0].0.row().path));
    }
    (errors.len() == before).then_some(set)
}

fn read_group(
    fields: &Map<String, Value>,
    group: &str,
    pointer: &str,
    source: Source,
    errors: &mut Errors,
    set: &mut Vec<(Name, FieldValue)>,
) {
    for (key, value) in fields {
        let path = if group.is_empty() { key.clone() } else { format!("{group}.{key}") };
        let pointer = join(pointer, key);
        if let Some(row) = field(&path) {
            match refusal(row).map_or_else(|| read_value(row, value, source), Err) {
                Ok(Some(value)) => set.push((row.name, value)),
                Ok(None) => errors.push(pointer, format!("{path} is null; give a value")),
                Err(error) if row.live => errors.push(pointer, format!("{} {error}", row.key())),
                Err(error) => errors.push(pointer, error),
            }
        } else if let (Value::Object(inner), true) =
            (value, FIELDS.iter().any(|row| row.path.starts_with(&format!("{path}."))))
        {
            read_group(inner, &path, &pointer, source, errors, set);
        } else {
            let live: Vec<_> = FIELDS.iter().filter(|row| row.live).map(|row| row.path).collect();
            let shown = crate::http::problem::shortened(&path);
            errors.push(pointer, format!("unknown field `{shown}`; in a live run you can set {}", live.join(", ")));
        }
    }
}

/// The error of a field that cannot be set in a run; None if it can be set.
fn refusal(row: &Field) -> Option<String> {
    (!row.live).then(|| format!("{} cannot be changed while a run is live; start another run with it", row.path))
}

/// Query parameters that read back as the interventions of a run.
pub fn intervention_parameters(run: &Run) -> Vec<(String, String)> {
    let mut parameters = Vec::new();
    for (index, intervention) in run.interventions().iter().enumerate() {
        let prefix = format!("interventions.{index}");
        parameters.push((format!("{prefix}.impact"), intervention.impact.to_string()));
        for (name, value) in &intervention.set {
            parameters.extend(value_to_query(format!("{prefix}.set.{}", name.row().path), *value));
        }
        if let Some(kick) = intervention.kick {
            for (name, value) in [("x_dot", kick.x_dot), ("y_dot", kick.y_dot), ("theta_dot", kick.theta_dot)] {
                // A kick of zero still needs one component.
                if value.to_bits() != 0 || (name == "x_dot" && kick == Kick::default()) {
                    parameters.push((format!("{prefix}.kick.{name}"), number_text(value)));
                }
            }
        }
        let mut push = |name: &str, value: String| parameters.push((format!("{prefix}.{name}"), value));
        if let Some(settings) = &intervention.catch {
            catch_parameters(settings, |name, value| push(&format!("catch.{name}"), value));
        }
        if let Some(ThrowOrder { apex, t }) = intervention.throw {
            push("throw.apex.height", number_text(apex.height));
            push("throw.apex.theta", number_text(apex.theta));
            if let Some(t) = t {
                push("throw.t", number_text(t));
            }
        }
    }
    parameters
}

/// Writes the settings of a catch, without those that have their defaults.
fn catch_parameters(settings: &CatchSettings, mut push: impl FnMut(&str, String)) {
    let CatchSettings { strategy, ratio, strikes, brake, state_weights, input_weight, hold_speed, hold } = settings;
    let default = CatchSettings::default();
    // An object needs a field to be there.
    push("strategy", strategy_name(*strategy).to_owned());
    for (name, value) in [("ratio", *ratio), ("strikes", strikes.map(f64::from)), ("brake", *brake)] {
        if let Some(value) = value {
            push(name, if name == "strikes" { value.to_string() } else { number_text(value) });
        }
    }
    for (name, (value, known)) in STATE.iter().zip(state_weights.iter().zip(default.state_weights)) {
        if value.to_bits() != known.to_bits() {
            push(&format!("weights.state.{name}"), number_text(*value));
        }
    }
    for (name, value, known) in [
        ("weights.input", *input_weight, default.input_weight),
        ("hold_speed", *hold_speed, default.hold_speed),
        ("hold", *hold, default.hold),
    ] {
        if value.to_bits() != known.to_bits() {
            push(name, number_text(value));
        }
    }
}

/// Shortest text that reads back to the same double.
pub fn number_text(value: f64) -> String {
    Value::from(value).to_string()
}
