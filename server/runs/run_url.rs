//! The URL of a run: read from a request with everything that is wrong, and written so that it reads back as the same
//! run.

use equipoise_physics::body::Kick;
use equipoise_physics::scene::{FIELDS, Name, Value as FieldValue, field};
use form_urlencoded::Serializer;
use serde_json::{Map, Value};

use crate::api::scene::{has_angle, read_scene, read_value, scene_to_query, value_to_json};
use crate::http::request::reader::join;
use crate::http::request::scalar;
use crate::http::request::scalar::{LARGEST_EXACT, Source};
use crate::http::{Errors, Reader};
use crate::limits;
use crate::runs::clock::{Clock, ClockEntry, SPEEDS};
use crate::runs::run::{KICK_SPEED, KICK_SPIN, Run, refusal};

/// Where live runs are.
pub const PATH: &str = "/v1/live";

/// Run times that a clock may show, s: all that it comes to between the earliest and the latest time, at the highest speed. An
/// epoch in s instead of ms is 57 years ago, and its run can be paused as well.
const RUN_TIMES: std::ops::RangeInclusive<f64> = -2e14..=2e14;

/// How far the clocks of two servers may be apart, ms.
const CLOCK_SKEW_MS: u64 = 60_000;

/// Bytes kept free in a URL for the clock's entries and for a `from`, so that pausing never fails.
const CLOCK_ROOM: usize = limits::LIVE_CLOCK_ENTRIES * 100 + 40;

/// What a client asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// The run.
    pub run: Run,
    /// The first impact that it wants to see; none is the last one so far.
    pub from: Option<u64>,
}

/// Reads a run, released now, unix ms, unless it says when. None if something is wrong; then it is in the errors.
pub fn read(reader: &mut Reader<'_, '_>, now: u64) -> Option<RunRequest> {
    let scene = read_scene(reader);
    let speed = reader.number("speed", SPEEDS, "").unwrap_or(1.0);
    let epoch = reader.integer("epoch", 0..=LARGEST_EXACT);
    // Of a run that begins with this request, nothing is missed.
    let from = reader.integer("from", 1..=limits::LIVE_IMPACTS).or(epoch.is_none().then_some(1));
    let interventions = read_interventions(reader);
    let mut entries = Vec::new();
    reader.objects("clock", limits::LIVE_CLOCK_ENTRIES, |_, item| entries.push(clock_entry(item)));
    let mut run = Run::new(scene?, Clock::new(epoch.unwrap_or(now), speed));
    apply_all(&mut run, interventions, reader);
    for (index, entry) in entries.into_iter().enumerate() {
        let Some(entry) = entry else { continue };
        // What is done to a run before its release is noted at the release.
        let latest = now.saturating_add(CLOCK_SKEW_MS).max(run.clock.epoch());
        let pushed = if entry.wall > latest {
            Err(format!("wall is {} ms, which is still to come: it is {now} ms", entry.wall))
        } else {
            run.clock.push(entry)
        };
        if let Err(detail) = pushed {
            let pointer = format!("{}/{index}", reader.pointer_to("clock"));
            reader.errors().push(pointer, detail);
        }
    }
    Some(RunRequest { run, from })
}

/// Reads a run that has no clock: a scene and what is done to it. None if something is wrong; then it is in the errors.
pub fn read_unclocked(reader: &mut Reader<'_, '_>) -> Option<Run> {
    let scene = read_scene(reader);
    let interventions = read_interventions(reader);
    let mut run = Run::new(scene?, Clock::new(0, 1.0));
    apply_all(&mut run, interventions, reader);
    Some(run)
}

fn read_interventions(reader: &mut Reader<'_, '_>) -> Vec<Option<ReadIntervention>> {
    let mut interventions = Vec::new();
    reader.objects("interventions", limits::LIVE_INTERVENTIONS, |_, item| interventions.push(intervention(item)));
    interventions
}

fn apply_all(run: &mut Run, interventions: Vec<Option<ReadIntervention>>, reader: &mut Reader<'_, '_>) {
    for (index, read) in interventions.into_iter().enumerate() {
        let Some((impact, set, kick)) = read else { continue };
        let pointer = format!("{}/{index}", reader.pointer_to("interventions"));
        apply(run, impact, &set, kick, &pointer, reader.errors());
    }
}

fn apply(
    run: &mut Run,
    impact: u64,
    set: &[(Name, FieldValue)],
    kick: Option<Kick>,
    pointer: &str,
    errors: &mut Errors,
) {
    if !set.is_empty()
        && let Err(found) = run.set(impact, set)
    {
        for error in found {
            let place = if error.path.is_empty() { String::new() } else { format!("/set/{}", error.path) };
            errors.push(format!("{pointer}{}", place.replace('.', "/")), error.detail);
        }
    }
    if let Some(kick) = kick {
        if kick.theta_dot != 0.0 && !has_angle(run.scene()) {
            errors.push(format!("{pointer}/kick/theta_dot"), NO_ANGLE);
        } else if let Err(detail) = run.kick(impact, kick) {
            errors.push(pointer, detail);
        }
    }
}

/// Why a point mass cannot be turned.
pub const NO_ANGLE: &str = "a point mass has no theta_dot; leave it out";

type ReadIntervention = (u64, Vec<(Name, FieldValue)>, Option<Kick>);

fn intervention(item: &mut Reader<'_, '_>) -> Option<ReadIntervention> {
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
    if !item.has("set") && !item.has("kick") {
        item.refuse_whole("an intervention is a set or a kick, and this is neither");
    }
    Some((impact?, set?, kick.flatten()))
}

fn clock_entry(item: &mut Reader<'_, '_>) -> Option<ClockEntry> {
    item.require(&["wall", "run", "speed"]);
    let wall = item.integer("wall", 0..=LARGEST_EXACT);
    let run = item.number("run", RUN_TIMES, "s");
    let speed = item.number("speed", 0.0..=*SPEEDS.end(), "")?;
    if speed != 0.0 && speed < *SPEEDS.start() {
        let range = scalar::describe_range(&SPEEDS, "");
        item.refuse("speed", format!("speed is {speed}; it must be {range}, or 0 for a pause"));
        return None;
    }
    Some(ClockEntry { wall: wall?, run: run?, speed })
}

/// Reads a kick: velocities to add, of which there is at least one.
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

/// Reads the fields to set, nested or by dotted path. None if something is wrong; then it is in the errors.
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

/// The run's URL: path and query, without `from`.
pub fn url(run: &Run) -> String {
    let start = format!("{PATH}?");
    let length = start.len();
    let mut query = Serializer::for_suffix(start, length);
    query.extend_pairs(scene_to_query(run.scene()));
    query.append_pair("speed", &number(run.clock.first_speed()));
    query.append_pair("epoch", &run.clock.epoch().to_string());
    for (index, intervention) in run.interventions().iter().enumerate() {
        let start = format!("interventions.{index}");
        query.append_pair(&format!("{start}.impact"), &intervention.impact.to_string());
        for (name, value) in &intervention.set {
            query.append_pair(&format!("{start}.set.{}", name.row().path), &value_text(*value));
        }
        if let Some(kick) = intervention.kick {
            for (name, value) in [("x_dot", kick.x_dot), ("y_dot", kick.y_dot), ("theta_dot", kick.theta_dot)] {
                // One component has to stand there even in a kick of nothing.
                if value.to_bits() != 0 || (name == "x_dot" && kick == Kick::default()) {
                    query.append_pair(&format!("{start}.kick.{name}"), &number(value));
                }
            }
        }
    }
    for (index, entry) in run.clock.entries().iter().enumerate() {
        let start = format!("clock.{index}");
        query.append_pair(&format!("{start}.wall"), &entry.wall.to_string());
        query.append_pair(&format!("{start}.run"), &number(entry.run));
        query.append_pair(&format!("{start}.speed"), &number(entry.speed));
    }
    query.finish()
}

/// Whether the run's URL is too long to be asked for, once its clock is full.
pub fn is_too_long(run: &Run) -> bool {
    let mut run = run.clone();
    run.clock = Clock::new(run.clock.epoch(), run.clock.first_speed());
    url(&run).len() + CLOCK_ROOM > limits::URL_BYTES
}

/// Shortest text that reads back to the same double.
fn number(value: f64) -> String {
    Value::from(value).to_string()
}

fn value_text(value: FieldValue) -> String {
    match value_to_json(value) {
        Value::String(text) => text,
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::request::query;
    use crate::runs::run::tests::case;
    use proptest::prelude::*;

    const NOW: u64 = LARGEST_EXACT;

    fn read_url(url: &str) -> Result<RunRequest, Vec<(String, String)>> {
        read_url_at(url, NOW)
    }

    fn read_url_at(url: &str, now: u64) -> Result<RunRequest, Vec<(String, String)>> {
        let query = url.strip_prefix("/v1/live?").unwrap();
        let fields = query::unfold(query::parameters(query).unwrap()).unwrap();
        let mut errors = Errors::default();
        let mut reader = Reader::new(&fields, String::new(), Source::Query, &mut errors);
        let request = read(&mut reader, now);
        reader.finish();
        match errors.into_result() {
            Ok(()) => Ok(request.unwrap()),
            Err(problem) => Err(problem.into_errors().into_iter().map(|error| (error.pointer, error.detail)).collect()),
        }
    }

    #[derive(Debug, Clone)]
    enum Did {
        Set(Name, f64),
        Kick(f64, f64, f64),
        Pause,
        Resume,
        Speed(f64),
        Step,
    }

    fn did() -> impl Strategy<Value = Did> {
        prop_oneof![
            (-100.0..=100.0).prop_map(|value| Did::Set(Name::TiltGain, value)),
            (0.0..=1.0).prop_map(|value| Did::Set(Name::Restitution, value)),
            (0.01..=3.0).prop_map(|value| Did::Set(Name::ToppleAngle, value)),
            (-1.0..=1.0, -1.0..=1.0, -2.0..=2.0).prop_map(|(x, y, theta)| Did::Kick(x, y, theta)),
            Just(Did::Kick(0.0, -0.0, 0.0)),
            Just(Did::Pause),
            Just(Did::Resume),
            Just(Did::Step),
            (0.05..=20.0).prop_map(Did::Speed),
        ]
    }

    proptest! {
        #[test]
        fn a_url_reads_back_as_the_same_run(
            preset in 0..crate::api::scene::presets::all().len(), speed in 0.05..=20.0, epoch in 0..LARGEST_EXACT / 2,
            from in proptest::option::of(1_u64..1000),
            all in proptest::collection::vec((0_u64..3, 0_u64..100_000, did()), 0..40),
        ) {
            let scene = crate::api::scene::presets::all()[preset].draft().build().unwrap();
            let mut run = Run::new(scene, Clock::new(epoch, speed));
            let (mut impact, mut wall) = (1, epoch);
            for (impacts, time, did) in all {
                (impact, wall) = (impact + impacts, wall + time);
                match did {
                    Did::Set(name, value) => drop(run.set(impact, &[(name, FieldValue::Number(value))])),
                    Did::Kick(x_dot, y_dot, theta_dot) => {
                        let theta_dot = if has_angle(&scene) { theta_dot } else { 0.0 };
                        run.kick(impact, Kick { x_dot, y_dot, theta_dot }).unwrap();
                    }
                    Did::Pause => run.clock.pause(wall),
                    Did::Resume => run.clock.resume(wall),
                    Did::Speed(speed) => run.clock.set_speed(wall, speed),
                    Did::Step => {
                        run.clock.pause(wall);
                        run.clock.step(wall, run.clock.run_time(wall) + 0.1);
                    }
                }
                run.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
            }
            let mut text = url(&run);
            if let Some(from) = from {
                text += &format!("&from={from}");
            }
            prop_assert_eq!(read_url(&text).unwrap(), RunRequest { run, from });
        }
    }

    #[test]
    fn a_run_paused_before_its_release_reads_back() {
        let (now, released) = (1_000_000, 5_000_000);
        let mut run = Run::new(*case("case-1").scene(), Clock::new(released, 1.0));
        run.clock.pause(now);
        assert_eq!(read_url_at(&url(&run), now).unwrap().run, run);
        run.clock.resume(released + 2);
        assert_eq!(read_url_at(&url(&run), now).unwrap_err()[0].0, "/clock/1");
    }

    #[test]
    fn a_run_of_long_ago_or_far_ahead_reads_back_when_it_is_paused() {
        for (now, released) in [(1_800_000_000_000, 18_001), (LARGEST_EXACT, 0), (0, LARGEST_EXACT)] {
            let mut run = Run::new(*case("case-2").scene(), Clock::new(released, *SPEEDS.end()));
            run.clock.set_speed(now, 1.0);
            run.clock.pause(now);
            assert_eq!(read_url_at(&url(&run), now).unwrap().run, run, "released at {released}");
        }
    }

    #[test]
    fn the_defaults_are_now_at_normal_speed() {
        let request = read_url("/v1/live?preset=case-1").unwrap();
        assert_eq!((request.run.clock, request.from), (Clock::new(NOW, 1.0), Some(1)));
    }

    #[test]
    fn everything_wrong_is_told_at_once() {
        let errors = read_url(
            "/v1/live?preset=case-1&speed=100&epoch=-1&from=0&interventions.0.impact=2&interventions.0.set.gravity=1&\
             interventions.1.impact=x&interventions.1.kick.theta_dot=900&interventions.2.kick.spin=1&\
             interventions.3.impact=1&clock.0.wall=1&clock.0.run=0&clock.0.speed=0.01&colour=red",
        )
        .unwrap_err();
        let pointers: Vec<_> = errors.iter().map(|(pointer, _)| pointer.as_str()).collect();
        let expected = [
            "/speed",
            "/epoch",
            "/from",
            "/interventions/0/set/gravity",
            "/interventions/1/impact",
            "/interventions/1/kick/theta_dot",
            "/interventions/2/impact",
            "/interventions/2/kick",
            "/interventions/2/kick/spin",
            "/interventions/3",
            "/clock/0/speed",
            "/colour",
        ];
        assert_eq!(pointers, expected, "{errors:?}");
        assert!(errors[3].1.starts_with("gravity cannot be changed while a run is live"));
    }

    #[test]
    fn what_a_change_contradicts_is_told_at_its_intervention() {
        let errors = read_url(
            "/v1/live?preset=case-1&interventions.0.impact=2&interventions.0.set.table.energy_gain=1&\
             interventions.1.impact=1&interventions.1.kick.x_dot=1",
        )
        .unwrap_err();
        assert_eq!(errors[0].0, "/interventions/0/set/table/target_height");
        let point = "/v1/live?preset=point-mass&interventions.0.impact=2&interventions.0.kick.theta_dot=1";
        assert_eq!(read_url(point).unwrap_err()[0].0, "/interventions/0/kick/theta_dot");
    }

    #[test]
    fn a_full_run_still_fits_a_url() {
        let mut run = case("case-2");
        let mut impact = 0;
        while !is_too_long(&run) && impact < limits::LIVE_INTERVENTIONS as u64 {
            impact += 1;
            let _ = run.kick(impact, Kick { x_dot: 0.123_456_789_012_345_6, ..Kick::default() });
        }
        assert!(impact > 50, "{impact}");
        for change in 1..100_u64 {
            run.clock.set_speed(1_763_675_170_123 + change * 1000, 0.123_456_789_012_345_6 + change as f64 / 100.0);
        }
        run.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
        assert!(url(&run).len() <= limits::URL_BYTES + 200, "{}", url(&run).len());
    }
}
