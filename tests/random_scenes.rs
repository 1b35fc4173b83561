//! Random scenes through every resource, by POST and by the equivalent GET, in every format. Answers keep to the contract (the test
//! frame checks that) and agree in all formats. Refusals point to a part of the request.
//!
//! Extreme and broken requests are in `hostile` and `fuzzed`; correct numbers are in the other files.

mod support;

use std::net::SocketAddr;

use equipoise_physics::scene::{FIELDS, FieldKind, Name, VERTICES};
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Map, Value, json};
use tokio::runtime::Runtime;

use crate::support::contract::DOCUMENT;
use crate::support::socket::{impacts_in, now_ms, open, start};
use crate::support::tables::{Stream, Table};
use crate::support::{Answer, Server, contract};

/// A resource under test.
struct Resource {
    path: &'static str,
    /// True for a resource that takes only scenes without friction, noise and feedback.
    plain: bool,
    /// Number of CSV rows that its JSON gives.
    rows: fn(&Value) -> usize,
    /// Number of NDJSON lines, without the last one.
    lines: fn(&Value) -> usize,
    /// True if it has pictures.
    draws: bool,
    /// True if it measures clock times, so that no two answers are equal.
    measures: bool,
    /// True if it takes no GET.
    post_only: bool,
}

/// A resource with pictures, whose NDJSON lines are its CSV rows.
fn resource(path: &'static str, rows: fn(&Value) -> usize) -> Resource {
    Resource { path, plain: false, rows, lines: rows, draws: true, measures: false, post_only: false }
}

/// Tries a resource with random scenes and random parameters.
fn hold(resource: &Resource, parameters: impl Strategy<Value = Value>, cases: u32) {
    let (runtime, server) = (Runtime::new().expect("a runtime"), Server::start());
    hold_each(resource, parameters, cases, &runtime, |request, pixels| {
        runtime.block_on(ask(&server, resource, request, pixels))
    });
}

/// Makes random requests and tries each; `tried` returns true if the request was answered.
fn hold_each(
    resource: &Resource,
    parameters: impl Strategy<Value = Value>,
    cases: u32,
    runtime: &Runtime,
    tried: impl Fn(&Value, bool) -> bool,
) {
    let listed = runtime.block_on(Server::start().get("/v1/scenes")).json();
    let name = |preset: &Value| preset["name"].as_str().expect("a name").to_owned();
    let presets: Vec<String> = listed["items"].as_array().expect("presets").iter().map(name).collect();
    let answered = std::cell::Cell::new(0);
    let config =
        ProptestConfig { cases, failure_persistence: None, max_shrink_iters: 200, ..ProptestConfig::default() };
    proptest!(config, |(made in made(), mut request in parameters, pixels in prop::bool::weighted(0.05))| {
        made.put_into(&mut request, &presets, resource.plain);
        answered.set(answered.get() + u32::from(tried(&request, pixels)));
    });
    println!("{}: {} of {cases} answered", resource.path, answered.get());
    // Two fifths to nearly all requests are answered. The chance of less than a tenth is below one in ten million.
    assert!(answered.get() * 10 >= cases, "{}: only {} of {cases} answered", resource.path, answered.get());
}

/// Returns true if the request was answered, false if it was refused. Panics if anything is wrong.
async fn ask(server: &Server, resource: &Resource, request: &Value, pixels: bool) -> bool {
    let path = resource.path;
    let posted = server.post(path, request).await;
    let target = format!("{path}?{}", if resource.post_only { String::new() } else { query(request) });
    let formatted = async |format: &str| match resource.post_only {
        true => server.post(&format!("{path}?format={format}"), request).await,
        false => server.get(&format!("{target}&format={format}")).await,
    };
    let asked = if resource.post_only { server.post(path, request).await } else { server.get(&target).await };
    assert_eq!(asked.status, posted.status, "{target}: {request}");
    if posted.status == 422 {
        assert_eq!(asked.pointers(), posted.pointers(), "{request}");
        for pointer in posted.pointers() {
            let known = request.pointer(&pointer).is_some() || names_a_field(path, &pointer);
            assert!(known, "{pointer} of {request}");
        }
        return false;
    }
    assert_eq!(posted.status, 200, "{request}: {}", posted.text());
    if !resource.measures {
        assert_eq!(asked.etag(), posted.etag(), "{request}");
        assert!(asked.raw == posted.raw, "{request} by GET and by POST");
    }
    let json = posted.json();
    let csv = server.post(&format!("{path}?format=csv"), request).await.expect(200);
    let table = Table::parse(csv.text()).expect("RFC 4180");
    for cell in table.rows.iter().flatten() {
        let word = cell.trim_start_matches('-').to_ascii_lowercase();
        assert!(!["nan", "inf", "infinity"].contains(&word.as_str()), "{cell} in the CSV of {request}");
    }
    let lines = formatted("ndjson").await.expect(200).text().lines().count();
    assert_eq!((resource.lines)(&json) + 1, lines, "rows of JSON and lines of NDJSON, {request}");
    assert_eq!((resource.rows)(&json), table.rows.len(), "rows of JSON and CSV, {request}");
    let arrow = Stream::parse(&formatted("arrow").await.expect(200).body).expect("a stream");
    assert_eq!(arrow.rows(), table.rows.len(), "rows of Arrow and CSV, {request}");
    if !resource.measures {
        for (index, name) in arrow.names().into_iter().enumerate() {
            for (row, cell) in arrow.column(name).iter().enumerate() {
                let written = match cell {
                    Value::Null => String::new(),
                    Value::String(word) => word.clone(),
                    other => other.to_string(),
                };
                assert_eq!(written, table.rows[row][index], "{name} in Arrow and CSV, {request}");
            }
        }
    }
    if resource.draws {
        picture(formatted("svg").await, request);
        if pixels {
            picture(formatted("png").await, request);
        }
    }
    true
}

/// Length of an array, or of each column of a table.
fn length(part: &Value) -> usize {
    let columns = part.as_object().map(|columns| columns.values().next().expect("a column"));
    columns.unwrap_or(part).as_array().expect("an array").len()
}

/// A picture, or the error for a format that this request does not have.
fn picture(answer: Answer, request: &Value) {
    assert!(matches!(answer.status.as_u16(), 200 | 406 | 422), "{} for the picture of {request}", answer.status);
}

/// True if a pointer leads to a known field of a scene or of the request, which was left to its default or is missing.
fn names_a_field(path: &str, pointer: &str) -> bool {
    let ends = |path: &str| pointer.ends_with(&format!("/{}", path.replace('.', "/")));
    let body = &DOCUMENT["paths"][path]["post"]["requestBody"]["content"]["application/json"]["schema"];
    let asked = contract::resolved(body)["properties"].get(pointer.trim_start_matches('/'));
    asked.is_some() || FIELDS.iter().map(|row| row.path).chain([VERTICES, "body"]).any(ends)
}

fn object(parts: Vec<(&'static str, Option<Value>)>) -> Value {
    Value::Object(parts.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect())
}

fn maybe<S: Strategy>(strategy: S) -> impl Strategy<Value = Option<Value>>
where
    S::Value: Into<Value>,
{
    prop::option::of(strategy.prop_map(Into::into))
}

fn word(words: &'static [&'static str]) -> impl Strategy<Value = Value> {
    select(words).prop_map(|word| json!(word))
}

fn state() -> impl Strategy<Value = Value> {
    (-0.3..0.3, -0.3..0.3, -3.0..-0.2, -2.0..2.0).prop_map(|(theta, x_dot, y_dot, theta_dot)| {
        json!({"theta": theta, "x_dot": x_dot, "y_dot": y_dot, "theta_dot": theta_dot})
    })
}

#[test]
fn trajectories_of_random_scenes() {
    let parameters = (
        1..40_u64,
        maybe(0..4_u64),
        maybe(word(&["auto", "map", "linear", "extended"])),
        maybe((-15.0..-1.0).prop_map(|power| 10_f64.powf(power))),
        maybe(0..2_000_000_000_000_u64),
        prop::option::weighted(0.3, (1..20_u64, -1.0..1.0)),
        maybe(0.0..3.0),
    )
        .prop_map(|(impacts, samples, method, tolerance, epoch, kick, hold)| {
            let kick = kick.map(|(impact, speed)| json!([{"impact": impact, "kick": {"x_dot": speed}}]));
            object(vec![
                ("bounces", Some(json!(impacts))),
                ("samples_per_flight", samples),
                ("method", method),
                ("tolerance", tolerance),
                ("epoch_ms", epoch),
                ("interventions", kick),
                ("hold", hold),
            ])
        });
    let rows =
        |json: &Value| length(&json["impacts"]) + json.get("hold").filter(|hold| !hold.is_null()).map_or(0, length);
    hold(&resource("/v1/trajectories", rows), parameters, 40);
}

#[test]
fn jacobians_of_random_scenes() {
    let at = prop_oneof![
        Just(json!("fixed_point")),
        (1..20_u64).prop_map(|impact| json!({"impact": impact})),
        state().prop_map(|state| json!({"state": state})),
    ];
    let parameters = (maybe(at), maybe(1..5_u64)).prop_map(|(at, period)| object(vec![("at", at), ("period", period)]));
    hold(&Resource { draws: false, ..resource("/v1/jacobians", |json| length(&json["matrix"])) }, parameters, 60);
}

#[test]
fn verdicts_on_random_scenes() {
    let path =
        word(&["gravity", "release.height", "table.errors.speed", "table.delay", "table.pivot.depth", "air.drag"]);
    let tolerance = |field: &str, off: f64| json!({"field": field, "tolerance": off});
    let field = (path, 0.0..0.01).prop_map(move |(path, off)| tolerance(path.as_str().unwrap(), off));
    let off = (0.0..0.01, 0.0..0.01, 0.0..0.1, prop::option::of(field)).prop_map(
        move |(contact_distance, radius_of_gyration, restitution, further)| {
            let mut all = vec![
                tolerance("body.contact_distance", contact_distance),
                tolerance("body.radius_of_gyration", radius_of_gyration),
                tolerance("contact.restitution", restitution),
            ];
            all.extend(further);
            json!(all)
        },
    );
    let parameters = (1..200_u64, maybe(any::<bool>()), prop::bool::weighted(0.2), prop::option::weighted(0.2, off))
        .prop_map(|(impacts, basin, budget, off)| {
            let budget = budget.then_some(json!(true));
            object(vec![("bounces", Some(json!(impacts))), ("basin", basin), ("budget", budget), ("tolerances", off)])
        });
    hold(&resource("/v1/stability", |_| 1), parameters, 30);
}

#[test]
fn regions_about_random_scenes() {
    let axis = || {
        (0..USUAL.len(), 0.0..1.0, 0.0..1.0, 1..6_u64).prop_map(|(field, from, to, count)| {
            let (name, low, high) = USUAL[field];
            let at = |share: f64| low + share * (high - low);
            json!({"field": name.row().path, "from": at(from), "to": at(to), "count": count})
        })
    };
    let quantity = word(&["survival", "max_theta", "residue", "spectral_radius"]);
    let parameters = (axis(), axis(), 1..60_u64, maybe(quantity)).prop_map(|(x, y, impacts, quantity)| {
        object(vec![("x", Some(x)), ("y", Some(y)), ("bounces", Some(json!(impacts))), ("quantity", quantity)])
    });
    hold(
        &Resource {
            lines: |json| length(&json["y"]),
            ..resource("/v1/regions", |json| length(&json["x"]) * length(&json["y"]))
        },
        parameters,
        50,
    );
}

#[test]
fn ensembles_of_random_scenes() {
    let parameters = (1..8_u64, 1..60_u64, maybe(0..1_u64 << 53)).prop_map(|(runs, impacts, seed)| {
        object(vec![("runs", Some(json!(runs))), ("bounces", Some(json!(impacts))), ("seed", seed)])
    });
    hold(&resource("/v1/ensembles", |json| length(&json["survival"])), parameters, 40);
}

#[test]
fn periodic_orbits_of_random_scenes() {
    let sweep = (0.5..2.0, 0.01..1.0, 2..6_u64).prop_map(
        |(from, width, points)| json!({"field": "table.tilt_gain", "from": from, "to": from + width, "points": points}),
    );
    let parameters = prop_oneof![
        Just(json!({})),
        (1..4_u64, state()).prop_map(|(period, guess)| json!({"period": period, "guess": guess})),
        (0.05..0.5).prop_map(|theta| json!({"family": "symmetric", "theta": theta})),
        sweep.prop_map(|sweep| json!({"sweep": sweep})),
    ];
    let resource = Resource {
        plain: true,
        ..resource("/v1/periodic-orbits", |json| {
            json.get("branch").filter(|it| !it.is_null()).map_or_else(|| length(&json["states"]), length)
        })
    };
    hold(&resource, parameters, 60);
}

#[test]
fn controllers_for_random_scenes() {
    let weights = (prop::collection::vec(0.0..100.0, 4), 0.01..100.0)
        .prop_map(|(state, input)| json!({"state": state, "input": input}));
    let parameters = (prop::option::of(weights), maybe(word(&["frictionless", "stick"])))
        .prop_map(|(weights, contact)| object(vec![("weights", weights), ("contact", contact)]));
    hold(&resource("/v1/controllers", |_| 1), parameters, 40);
}

#[test]
fn fits_of_random_scenes() {
    let flights = prop::collection::vec((0.05..0.6, -0.2..0.2, -1.0..1.0, prop::bool::weighted(0.1)), 2..30);
    // Most requests ask for lengths, gains and the release, a few for fields that hardly a scene has.
    let field = prop_oneof![8 => 0..USUAL_BODY_AND_LAW, 1 => 0..USUAL.len()];
    let unknown = prop::collection::vec(field, 1..3);
    let parameters = (flights, unknown, maybe(0.0005..0.01)).prop_map(|(flights, unknown, sd)| {
        let mut at = 0.0;
        let mut times = Vec::new();
        for (flight, ..) in &flights {
            at += flight;
            times.push(at);
        }
        let angles: Vec<_> = flights.iter().map(|&(_, theta, _, is_missing)| (!is_missing).then_some(theta)).collect();
        // Times and angles alone have fewer values than windows of such impacts have unknowns.
        let speeds: Vec<_> = flights.iter().map(|&(_, _, speed, _)| speed).collect();
        let paths: Vec<_> = unknown.iter().map(|&field| USUAL[field].0.row().path).collect();
        object(vec![
            ("measured", Some(json!({"t": times, "theta": angles, "x_dot": speeds, "theta_dot": speeds}))),
            ("unknown", Some(json!(paths))),
            ("sd", sd.map(|sd| json!({"t": sd}))),
        ])
    });
    hold(&Resource { post_only: true, ..resource("/v1/fits", |json| length(&json["residuals"])) }, parameters, 60);
}

/// Settings of a catch, contradictions included.
fn catch_settings() -> impl Strategy<Value = Value> {
    let strategy = maybe(word(&["auto", "bounce_down", "plan", "brake"]));
    let numbers = (prop::option::weighted(0.3, 0.05..1.0), prop::option::weighted(0.2, 4..12_u64));
    let brake = prop::option::weighted(0.2, 1.0..50.0);
    (strategy, numbers, brake, maybe(0.1..4.0), maybe(2..80_u64)).prop_map(
        |(strategy, (ratio, strikes), brake, hold, samples)| {
            object(vec![
                ("strategy", strategy),
                ("ratio", ratio.map(Value::from)),
                ("strikes", strikes.map(Value::from)),
                ("brake", brake.map(Value::from)),
                ("hold", hold),
                ("hold_samples", samples),
            ])
        },
    )
}

#[test]
fn catches_of_random_scenes() {
    let rows = |json: &Value| length(&json["strikes"]) + length(&json["hold"]);
    hold(&resource("/v1/catches", rows), catch_settings(), 60);
}

#[test]
fn throws_of_random_scenes() {
    let apex = (0.1..0.8, maybe(-7.0..7.0))
        .prop_map(|(height, theta)| object(vec![("height", Some(json!(height))), ("theta", theta)]));
    let parameters = (
        apex,
        prop::option::weighted(0.3, 1..20_u64),
        prop::option::weighted(0.3, state()),
        // A query cannot say an object without fields.
        prop::option::weighted(0.3, catch_settings().prop_filter("no fields", |it| *it != json!({}))),
    )
        .prop_map(|(apex, impact, state, catch)| {
            object(vec![("apex", Some(apex)), ("impact", impact.map(Value::from)), ("state", state), ("catch", catch)])
        });
    hold(&resource("/v1/throws", |_| 1), parameters, 60);
}

#[test]
fn ladders_of_random_scenes() {
    let parameters = (1..20_u64, maybe((-12.0..0.0).prop_map(|power| 10_f64.powf(power))))
        .prop_map(|(impacts, tolerance)| object(vec![("bounces", Some(json!(impacts))), ("tolerance", tolerance)]));
    hold(&Resource { draws: false, ..resource("/v1/ladder", |json| length(&json["rungs"])) }, parameters, 30);
}

#[test]
fn precision_on_random_scenes() {
    let methods = select(vec!["map", "map_free", "linear", "extended", "sampling", "time_stepping", "penalty"]);
    let parameters = (1..6_u64, prop::collection::btree_set(methods, 1..3)).prop_map(|(impacts, methods)| {
        object(vec![("bounces", Some(json!(impacts))), ("methods", Some(json!(methods)))])
    });
    let points = |json: &Value| length(&json["points"]);
    hold(&Resource { measures: true, ..resource("/v1/precision", points) }, parameters, 8);
}

// Random scenes and the requests for them.

/// Typical values of a lab. Other fields are drawn from their whole range.
const USUAL: [(Name, f64, f64); 30] = [
    (Name::ContactDistance, 0.05, 0.5),
    (Name::RadiusOfGyration, 0.03, 0.5),
    (Name::Gravity, 1.0, 10.0),
    (Name::Incline, 0.1, 1.57),
    (Name::Restitution, 0.3, 1.0),
    (Name::Friction, 0.0, 0.6),
    (Name::TiltGain, 0.5, 3.0),
    (Name::EnergyGain, -0.1, 0.3),
    (Name::TargetHeight, 0.2, 0.8),
    (Name::Theta, -0.3, 0.3),
    (Name::ThetaDot, -2.0, 2.0),
    (Name::XDot, -0.5, 0.5),
    (Name::TimingSd, 0.0, 0.002),
    (Name::AngleSd, 0.0, 0.01),
    (Name::XSd, 0.0, 0.005),
    (Name::XDotSd, 0.0, 0.02),
    (Name::YDotSd, 0.0, 0.02),
    (Name::ThetaDotSd, 0.0, 0.05),
    (Name::RestitutionSd, 0.0, 0.05),
    (Name::Offset, -0.01, 0.01),
    (Name::AngleBias, -0.01, 0.01),
    (Name::TiltOffset, -0.01, 0.01),
    (Name::TiltGainError, -0.1, 0.1),
    (Name::SpeedError, -0.1, 0.1),
    (Name::TableLength, 0.2, 5.0),
    (Name::PivotX, -0.5, 0.5),
    (Name::PivotDepth, -0.1, 0.1),
    (Name::Delay, 0.0, 0.05),
    (Name::Drag, 0.0, 0.5),
    (Name::RotationDrag, 0.0, 0.5),
];

/// Number of fields at the beginning of [`USUAL`] that are of the body, the contact and the law of the table.
const USUAL_BODY_AND_LAW: usize = 9;

/// Ingredients of a random scene: for each field, its place in its range, if it is set; and the body.
#[derive(Clone, Debug)]
struct Made {
    fields: Vec<Option<(f64, bool)>>,
    above: f64,
    body: Body,
    tilts: Tilts,
    noisy: bool,
}

#[derive(Clone, Debug)]
enum Body {
    Preset(usize),
    Rod,
    Point,
    /// Radii of the corners, in order.
    Polygon(Vec<f64>),
}

/// Control law of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tilts {
    Gain,
    Feedback,
}

prop_compose! {
    fn made()(
        fields in prop::collection::vec(prop::option::weighted(0.35, (0.0..=1.0, prop::bool::weighted(0.15))), FIELDS.len()),
        above in 0.0..1.0,
        body in prop_oneof![
            2 => (0..64_usize).prop_map(Body::Preset),
            5 => Just(Body::Rod),
            1 => Just(Body::Point),
            2 => prop::collection::vec(0.05..0.2, 3..9).prop_map(Body::Polygon),
        ],
        tilts in prop_oneof![6 => Just(Tilts::Gain), 1 => Just(Tilts::Feedback)],
        // Rarely, because half of the resources refuse it.
        noisy in prop::bool::weighted(0.3),
    ) -> Made {
        Made { fields, above, body, tilts, noisy }
    }
}

impl Made {
    /// The scene of a request, and its preset if it has one. Most scenes are free of contradictions.
    fn put_into(&self, request: &mut Value, presets: &[String], plain: bool) {
        let mut scene = json!({});
        let tilts = if plain { Tilts::Gain } else { self.tilts };
        let is_point = matches!(self.body, Body::Point);
        match &self.body {
            Body::Preset(index) => request["preset"] = json!(presets[index % presets.len()]),
            Body::Rod => {}
            Body::Point => put(&mut scene, Name::PointMass.row().path, json!(true)),
            Body::Polygon(radii) => {
                let corner = |(index, radius): (usize, &f64)| {
                    let angle = std::f64::consts::TAU * (index as f64 / radii.len() as f64 - 0.25);
                    json!([radius * angle.cos(), radius * angle.sin()])
                };
                put(&mut scene, VERTICES, radii.iter().enumerate().map(corner).collect());
            }
        }
        let said = |name: Name| self.fields[name as usize].is_some();
        let second = |name: Name| self.fields[name as usize].is_some_and(|(share, _)| share >= 0.5);
        let still = second(Name::Strike);
        let one_strike = second(Name::EnergyLaw) && !still;
        for row in &FIELDS {
            let group = row.group();
            let fits = match row.name {
                Name::Friction | Name::Slide if plain => false,
                _ if plain && ["table.feedback.", "noise."].iter().any(|group| row.path.starts_with(group)) => false,
                Name::PointMass => false,
                Name::ContactDistance | Name::RadiusOfGyration => matches!(self.body, Body::Rod),
                Name::ContactVertex => false,
                Name::Theta | Name::ThetaDot | Name::Friction | Name::Slide | Name::Law if is_point => false,
                Name::EnergyGain | Name::AssumedRestitution | Name::EnergyLaw if still => false,
                Name::EnergyGain | Name::EnergyMeasure | Name::Friction if one_strike => false,
                Name::TargetHeight if said(Name::Program) => false,
                Name::TiltGain => tilts == Tilts::Gain,
                _ if row.path.starts_with("table.feedback.") => tilts == Tilts::Feedback,
                // Many resources refuse rigs that are not ideal, so few scenes have one.
                Name::Offset => self.above > 0.85 && !plain && matches!(self.body, Body::Rod),
                Name::SpeedError if still || one_strike => false,
                Name::TableLength => self.above > 0.85 && !plain,
                // A table does not turn and plan, and nothing is a limit of its motion then.
                Name::TiltRate | Name::PivotX | Name::PivotDepth => self.above > 0.8 && !plain && !is_point,
                Name::NoiseModel if self.above > 0.8 => false,
                Name::Drag | Name::RotationDrag | Name::Wind => {
                    let has_air = (0.2..0.35).contains(&self.above) && !plain && matches!(self.body, Body::Rod);
                    has_air && (row.name != Name::Wind || said(Name::Drag))
                }
                Name::Delay | Name::Prediction => (0.5..0.7).contains(&self.above) && !plain && !is_point,
                _ if row.path.starts_with("table.errors.") => self.above > 0.85 && !plain && !is_point,
                // Limits of the table end a run soon, so few scenes have them.
                _ if row.path.starts_with("table.limits.") => self.above < 0.2,
                _ => group != "noise" || (self.noisy && !is_point),
            };
            let needed = match row.name {
                Name::TargetHeight => one_strike || (said(Name::EnergyGain) && !still),
                _ => row.required && !matches!(self.body, Body::Preset(_)),
            };
            if fits && (said(row.name) || needed) {
                put(&mut scene, row.path, self.value(row.name));
            }
        }
        let takes_back = [
            (Name::TiltGain, tilts == Tilts::Feedback),
            (Name::TargetHeight, said(Name::Program)),
            (Name::EnergyGain, one_strike),
        ];
        for (name, _) in takes_back.into_iter().filter(|(_, back)| *back && matches!(self.body, Body::Preset(_))) {
            put(&mut scene, name.row().path, Value::Null);
        }
        if !matches!(self.body, Body::Preset(_)) {
            let length = scene.pointer("/body/contact_distance").and_then(Value::as_f64).unwrap_or(0.3);
            put(&mut scene, Name::Height.row().path, json!(length * (1.0 + self.above)));
        }
        if scene != json!({}) {
            request["scene"] = scene;
        }
    }

    fn value(&self, name: Name) -> Value {
        let (share, anything) = self.fields[name as usize].unwrap_or((0.5, false));
        match name.row().kind {
            FieldKind::Number { minimum, maximum } => {
                let usual = USUAL.iter().find(|(usual, ..)| *usual == name && !anything);
                let (low, high) = usual.map_or((minimum, maximum), |(_, low, high)| (*low, *high));
                json!((low + share * (high - low)).clamp(minimum, maximum))
            }
            FieldKind::Integer { maximum } => json!((share * maximum as f64) as u64),
            FieldKind::Choice(words) => json!(words[((share * words.len() as f64) as usize).min(words.len() - 1)]),
            FieldKind::Flag => json!(true),
            FieldKind::Numbers { minimum, maximum, most } => {
                let (_, low, high) =
                    USUAL.iter().find(|(usual, ..)| *usual == Name::TargetHeight).expect("it is there");
                let (low, high) = if anything { (minimum, maximum) } else { (*low, *high) };
                let count = 1 + (share * most as f64) as usize % most;
                (0..count)
                    .map(|n| json!((low + (high - low) * (share + 0.618 * n as f64).fract()).clamp(minimum, maximum)))
                    .collect()
            }
        }
    }
}

fn put(scene: &mut Value, path: &str, value: Value) {
    let mut at = scene;
    for part in path.split('.') {
        at = at.as_object_mut().expect("a group").entry(part).or_insert_with(|| Value::Object(Map::new()));
    }
    *at = value;
}

/// The query equivalent of a body. A null becomes the word `null`.
fn query(body: &Value) -> String {
    fn below(path: &str, value: &Value, into: &mut Vec<(String, String)>) {
        let inner = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match value {
            Value::Object(fields) => fields.iter().for_each(|(name, value)| below(&inner(name), value, into)),
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(index, item)| below(&inner(&index.to_string()), item, into));
            }
            Value::String(text) => into.push((path.to_owned(), text.clone())),
            other => into.push((path.to_owned(), other.to_string())),
        }
    }
    let mut parameters = Vec::new();
    below("", body, &mut parameters);
    form_urlencoded::Serializer::new(String::new()).extend_pairs(parameters).finish()
}

// Live runs of random scenes: the same impacts and ending as the trajectory, or the same refusal.

/// Speed of the runs.
const SPEED: f64 = 20.0;

#[test]
fn live_runs_of_random_scenes() {
    let (runtime, server) = (Runtime::new().expect("a runtime"), Server::start());
    let (_app, address) = runtime.block_on(start());
    let resource = resource("/v1/live", |_| 0);
    hold_each(
        &resource,
        (1..15_u64).prop_map(|impacts| json!({"bounces": impacts, "method": "map"})),
        60,
        &runtime,
        |request, _| runtime.block_on(watched(&server, address, request)),
    );
}

/// Watches a run. Returns true if there was one.
async fn watched(server: &Server, address: SocketAddr, request: &Value) -> bool {
    let impacts = request["bounces"].as_u64().expect("a number");
    let mut scene = request.clone();
    scene.as_object_mut().expect("an object").retain(|name, _| ["preset", "scene"].contains(&name.as_str()));
    let told = server.post("/v1/trajectories", request).await;
    let trajectory = told.json();
    // Released so long ago that the last impact is due.
    let t = trajectory["outcome"]["t"].as_f64().unwrap_or_default();
    let epoch = now_ms() as f64 - 1000.0 * (t / SPEED).ceil();
    if epoch < 0.0 {
        return false;
    }
    let url = format!("/v1/live?{}&speed={SPEED}&epoch_ms={epoch}&from=1", query(&scene));
    let mut client = open(address, &url).await;
    let first = client.next().await;
    if first["type"] == "problem" && told.status == 422 {
        assert_eq!((&first["status"], &first["errors"]), (&json!(422), &trajectory["errors"]), "{url}");
        return false;
    }
    assert_eq!(told.status, 200, "{url}");
    // The rest of the run may be too expensive.
    if first["type"] == "problem" {
        assert!(first["detail"].as_str().is_some_and(|it| it.contains("catching up")), "{first} to {url}");
        return false;
    }
    let ends = trajectory["outcome"]["kind"] != "completed";
    let mut rows = Vec::new();
    let end = loop {
        if !ends && rows.len() as u64 >= impacts {
            rows.truncate(impacts as usize);
            break None;
        }
        let message = client.next().await;
        if message["type"] == "end" {
            break Some(message);
        }
        rows.extend(impacts_in(&message));
    };
    let columns = trajectory["impacts"].as_object().expect("columns");
    let listed = columns["n"].as_array().expect("a column").len();
    assert_eq!(rows.len(), listed, "{url}");
    for (place, row) in rows.iter().enumerate() {
        for name in
            ["n", "t", "x", "theta", "x_dot", "y_dot", "theta_dot", "alpha", "energy", "contact_velocity", "clearance"]
        {
            assert_eq!(row[name], columns[name][place], "{name} of impact {} in {url}", place + 1);
        }
    }
    if let Some(end) = end {
        assert_eq!(end["outcome"], trajectory["outcome"], "{url}");
        assert_eq!(end["demand"], trajectory["demand"], "{url}");
    }
    true
}
