//! Interventions in a request: reads them with the scene of their run, and writes them as parameters of a query.

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::catching::throw::ThrowTarget;
use equipoise_physics::control::bounce_model::STATE;
use equipoise_physics::map::body::Kick;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{FIELDS, Field, Name, Value as FieldValue, field};
use serde_json::{Map, Value};

use crate::api::catches::request::strategy_name;
use crate::api::scene::{has_angle, read_scene, read_value, value_to_query};
use crate::api::shared::refusal::lacking;
use crate::http::request::fields::Fields;
use crate::http::request::reader::join;
use crate::http::request::scalar;
use crate::http::request::scalar::Source;
use crate::http::{Errors, Reader};
use crate::limits;
use crate::runs::run::{KICK_SPEED, KICK_SPIN, Run, ThrowOrder};

/// Latest time of a throw, s: the run times of a live run's clock end there.
const THROW_TIMES: std::ops::RangeInclusive<f64> = 0.0..=2e14;

/// Error of a kick that would turn a point mass.
pub const NO_ANGLE: &str = "a point mass has no theta_dot; leave it out";

/// One entry of `interventions`, valid by itself but not yet applied to a run.
#[derive(Debug)]
pub struct InterventionRequest {
    impact: u64,
    set: Vec<(Name, FieldValue)>,
    kick: Option<Kick>,
    catch: Option<CatchSettings>,
    throw: Option<ThrowOrder>,
}

/// Reads a scene and its interventions. Returns None if something is wrong; the reader then has the errors.
pub fn read_run(reader: &mut Reader<'_, '_>) -> Option<Run> {
    let scene = read_scene(reader);
    let interventions = read_interventions(reader);
    let mut run = Run::new(scene?);
    apply_interventions(&mut run, interventions, reader);
    Some(run)
}

/// Reads the time for which a run goes on in contact after its bounces, s; 0 without it.
pub fn read_hold(reader: &mut Reader<'_, '_>) -> f64 {
    reader.number("hold", 0.0..=limits::HOLD_TIME, "s").unwrap_or(0.0)
}

/// Reads `interventions`. An entry that is not valid is None; the reader then has the errors.
pub fn read_interventions(reader: &mut Reader<'_, '_>) -> Vec<Option<InterventionRequest>> {
    let mut interventions = Vec::new();
    reader.objects("interventions", limits::LIVE_INTERVENTIONS, |_, item| interventions.push(read_intervention(item)));
    interventions
}

/// Applies interventions to a run in their order. The reader gets an error for each that the run refuses.
pub fn apply_interventions(run: &mut Run, all: Vec<Option<InterventionRequest>>, reader: &mut Reader<'_, '_>) {
    for (index, intervention) in all.into_iter().enumerate() {
        let Some(intervention) = intervention else { continue };
        let pointer = format!("{}/{index}", reader.pointer_to("interventions"));
        apply(run, &intervention, &pointer, reader.errors());
    }
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
    item.require(&["impact"]);
    let impact = item.integer("impact", 1..=limits::LIVE_IMPACTS);
    let (source, pointer) = (item.source(), item.pointer_to("set"));
    let set = match item.value("set") {
        None => Some(Vec::new()),
        Some(Value::Object(fields)) => read_set(fields, &pointer, source, item.errors()),
        Some(other) => {
            item.refuse("set", format!("set is {}; it must be an object", scalar::shown(other)));
            None
        }
    };
    let kick = item.within("kick", read_kick);
    let catch = item.within("catch", CatchSettings::read_fields).flatten();
    let throw = item.within("throw", read_throw);
    if ["set", "kick", "catch", "throw"].iter().all(|name| !item.has(name)) {
        item.refuse_whole("an intervention is a set, a kick, a catch or a throw, and this is none of them");
    }
    if catch.is_some() && throw.flatten().is_some_and(|order| order.t.is_none()) {
        item.refuse(
            "throw",
            "a catch and a throw act at the same impact; leave one of them out, or give the throw a time t",
        );
    }
    Some(InterventionRequest { impact: impact?, set: set?, kick: kick.flatten(), catch, throw: throw.flatten() })
}

/// Reads a throw: its apex, and the time of the throw of a body that is held.
pub fn read_throw(reader: &mut Reader<'_, '_>) -> Option<ThrowOrder> {
    reader.require(&["apex"]);
    let target = reader.within("apex", ThrowTarget::read_fields).flatten();
    let t = reader.number("t", THROW_TIMES, "s");
    Some(ThrowOrder { target: target?, t })
}

/// Reads a kick: velocities to add, at least one of them.
pub fn read_kick(reader: &mut Reader<'_, '_>) -> Option<Kick> {
    let x_dot = reader.number("x_dot", -KICK_SPEED..=KICK_SPEED, "m/s");
    let y_dot = reader.number("y_dot", -KICK_SPEED..=KICK_SPEED, "m/s");
    let theta_dot = reader.number("theta_dot", -KICK_SPIN..=KICK_SPIN, "rad/s");
    if !["x_dot", "y_dot", "theta_dot"].iter().any(|name| reader.has(name)) {
        reader.refuse_whole("a kick needs x_dot, y_dot or theta_dot");
        return None;
    }
    Some(Kick {
        x_dot: x_dot.unwrap_or_default(),
        y_dot: y_dot.unwrap_or_default(),
        theta_dot: theta_dot.unwrap_or_default(),
    })
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
        if let Some(ThrowOrder { target, t }) = intervention.throw {
            push("throw.apex.height", number_text(target.height));
            push("throw.apex.theta", number_text(target.theta));
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
