//! Contract and server agree: routes, examples, ranges of fields, and the document itself.
//!
//! The test frame holds every single answer to the contract, in every test of every file.
//!
//! That the document is what the code gives is tested in `tests/written.rs`.

use std::collections::BTreeSet;
use std::path::Path;

use axum::http::Method;
use equipoise::api::scene::fields::number;
use equipoise::live::client_message::ClientMessage;
use equipoise_physics::scene::{FIELDS, Field, Value as FieldValue, field};
use serde_json::{Value, json};

use crate::support::contract::DOCUMENT;
use crate::support::{Server, contract};

/// A path for a template.
fn path(template: &str) -> String {
    let name = if template.contains("failures") { "double-eigenvalue-soft" } else { "case-1" };
    template.replace("{name}", name).replace("{resource}", "stability")
}

/// SnakeYAML, which openapi-generator reads the contract with, takes at most 50 aliases of maps and lists.
#[test]
fn generators_can_read_the_document() {
    let aliases: Vec<&str> = contract::TEXT.lines().filter(|line| line.contains(": *")).collect();
    assert!(aliases.len() <= 50, "{} aliases: write some of them out: {aliases:#?}", aliases.len());
}

#[tokio::test]
async fn every_operation_is_routed() {
    let server = Server::start();
    for (template, method, _) in contract::operations() {
        let target = path(template);
        let answer = server.send(method, &target, &[("content-type", "application/json")], "").await;
        assert!(!matches!(answer.status.as_u16(), 404 | 405 | 500), "{}: {}", answer.request, answer.status);
    }
}

#[tokio::test]
async fn every_other_method_is_refused_with_those_there_are() {
    let server = Server::start();
    for template in contract::templates() {
        let item = &DOCUMENT["paths"][template];
        let mut allowed: BTreeSet<&str> = BTreeSet::new();
        for method in ["GET", "HEAD", "POST"] {
            if item.get(method.to_lowercase()).is_some() {
                allowed.insert(method);
            }
        }
        // Every GET has a HEAD. The upgrade to a WebSocket may refuse HEAD in its own way.
        if allowed.contains("GET") {
            allowed.insert("HEAD");
        }
        for method in ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"] {
            if !allowed.contains(method) {
                let method = Method::from_bytes(method.as_bytes()).unwrap();
                let answer = match method {
                    // If the router has no GET, the connection leaves out the body.
                    Method::HEAD => server.send_unheld(method, &path(template), &[], "").await.expect(405),
                    _ => server.send(method, &path(template), &[], "").await.expect(405),
                };
                let named: BTreeSet<&str> = answer.header("allow").unwrap().split(',').map(str::trim).collect();
                assert!(allowed.is_subset(&named), "{}: {named:?}, not {allowed:?}", answer.request);
            }
        }
    }
}

#[tokio::test]
async fn every_route_is_in_the_contract() {
    let routes = routes();
    assert!(routes.contains(&"/v1/trajectories".to_owned()), "{routes:?}");
    let templates: BTreeSet<&str> = contract::templates().collect();
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
    for route in &routes {
        // Files and folders of the page have routes but are not part of the API.
        if !web.join(&route[1..]).exists() {
            assert!(templates.contains(route.as_str()), "{route} is routed and not in the contract");
        }
    }
    for template in templates {
        assert!(routes.iter().any(|route| route == template), "{template} is not routed");
    }
}

/// The routes, read from the router's debug output; axum has no other list of them.
fn routes() -> Vec<String> {
    let app = equipoise::api::App::new(&equipoise::config::Config::default());
    let printed = format!("{:?}", equipoise::api::all(None).with_state::<()>(app));
    let quoted = printed.split('"').skip(1).step_by(2);
    quoted.filter(|text| text.starts_with('/') && !text.contains("__private__axum")).map(str::to_owned).collect()
}

#[tokio::test]
async fn every_example_of_a_body_runs() {
    let server = Server::start();
    let mut count = 0;
    for (template, method, operation) in contract::operations() {
        let media = &operation["requestBody"]["content"]["application/json"];
        for (name, example) in media["examples"].as_object().into_iter().flatten() {
            let body = &example["value"];
            let faults = contract::faults(&media["schema"], body);
            assert!(faults.is_empty(), "{method} {template} {name}: {faults:?}");
            server.post(template, body).await.expect(200);
            count += 1;
        }
    }
    assert!(count >= 10, "{count} examples");
}

#[tokio::test]
async fn every_example_of_a_query_runs() {
    let server = Server::start();
    let mut count = 0;
    for (template, _, operation) in contract::operations() {
        for query in operation["x-queries"].as_array().into_iter().flatten() {
            let query = query.as_str().unwrap();
            let target = if query.is_empty() { path(template) } else { format!("{}?{query}", path(template)) };
            server.get(&target).await.expect(200);
            count += 1;
        }
    }
    assert!(count >= 10, "{count} queries");
}

#[tokio::test]
async fn every_example_of_a_parameter_runs() {
    let server = Server::start();
    for (template, method, operation) in contract::operations() {
        if method != Method::GET || !template.starts_with("/v1/") || template.starts_with("/v1/live") {
            continue;
        }
        let parameters: Vec<_> =
            operation["parameters"].as_array().into_iter().flatten().map(contract::resolved).collect();
        let takes_scene = parameters.iter().any(|parameter| parameter["name"] == "preset");
        for parameter in parameters {
            let Some(example) = parameter.get("example") else { continue };
            let faults = contract::faults(&parameter["schema"], example);
            assert!(faults.is_empty(), "{template}: {parameter}: {faults:?}");
            let text = example.as_str().map_or_else(|| example.to_string(), str::to_owned);
            let name = parameter["name"].as_str().unwrap();
            let base = operation["x-base-query"].as_str().unwrap_or("preset=case-1");
            let start = match (takes_scene, name) {
                (false, _) => String::new(),
                (_, "preset") => format!("{}&", base.trim_start_matches("preset=case-1")),
                _ => format!("{base}&"),
            };
            server.get(&format!("{}?{start}{name}={text}", path(template))).await.expect(200);
        }
    }
}

#[tokio::test]
async fn the_document_is_served_as_written() {
    let server = Server::start();
    let yaml = server.get("/openapi.yaml").await.expect(200);
    assert_eq!(yaml.text(), contract::TEXT);
    let json = server.get("/openapi.json").await.expect(200).json();
    assert_eq!(differences("", &DOCUMENT, &json), Vec::<String>::new());
}

/// Differences between two documents. Numbers are compared by value.
fn differences(place: &str, one: &Value, other: &Value) -> Vec<String> {
    match (one, other) {
        (Value::Object(left), Value::Object(right)) => {
            let names: BTreeSet<&String> = left.keys().chain(right.keys()).collect();
            let fields = names.into_iter().map(|name| (name, &one[name], &other[name]));
            fields.flat_map(|(name, one, other)| differences(&format!("{place}/{name}"), one, other)).collect()
        }
        (Value::Array(left), Value::Array(right)) if left.len() == right.len() => {
            let items = left.iter().zip(right).enumerate();
            items.flat_map(|(index, (one, other))| differences(&format!("{place}/{index}"), one, other)).collect()
        }
        (Value::Number(left), Value::Number(right)) if left.as_f64() == right.as_f64() => Vec::new(),
        _ if one == other => Vec::new(),
        _ => vec![format!("{place}: {one} and {other}")],
    }
}

#[test]
fn every_schema_compiles_and_every_reference_leads_somewhere() {
    fn walk(node: &Value) {
        match node {
            Value::Object(fields) => {
                contract::resolved(node);
                for (name, field) in fields {
                    if name == "schema" || name == "x-line" {
                        contract::validator(field);
                    }
                    walk(field);
                }
            }
            Value::Array(items) => items.iter().for_each(walk),
            _ => {}
        }
    }
    walk(&DOCUMENT);
    for (name, schema) in DOCUMENT["components"]["schemas"].as_object().unwrap() {
        contract::validator(&json!({ "$ref": format!("#/components/schemas/{name}") }));
        for example in schema["examples"].as_array().into_iter().flatten() {
            let faults = contract::faults(schema, example);
            assert!(faults.is_empty(), "{name}: {faults:?}");
        }
    }
}

#[test]
fn no_object_takes_fields_that_are_not_named() {
    fn walk(place: &str, node: &Value) {
        if let Some(fields) = node.as_object() {
            let is_schema = fields.get("properties").is_some_and(Value::is_object) && fields.contains_key("type");
            if is_schema {
                assert_eq!(fields.get("additionalProperties"), Some(&json!(false)), "{place}");
            }
            for (name, field) in fields {
                walk(&format!("{place}/{name}"), field);
            }
        }
        for (index, item) in node.as_array().into_iter().flatten().enumerate() {
            walk(&format!("{place}/{index}"), item);
        }
    }
    walk("", &DOCUMENT["components"]["schemas"]);
}

/// Generators make identifiers of names: letters and digits, in one case or another.
#[test]
fn names_make_different_identifiers() {
    fn identifiers<'n>(names: impl Iterator<Item = &'n str>) {
        let mut seen = BTreeSet::new();
        for name in names {
            let identifier: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
            assert!(seen.insert(identifier.to_lowercase()), "{name}");
        }
    }
    for (kind, components) in DOCUMENT["components"].as_object().unwrap() {
        identifiers(components.as_object().unwrap().keys().map(String::as_str));
        let has_dots = components.as_object().unwrap().keys().any(|name| name.contains(['.', '_']));
        assert!(!has_dots, "{kind}");
    }
    for item in DOCUMENT["paths"].as_object().unwrap().values() {
        for operation in item.as_object().unwrap().values() {
            let listed = item["parameters"].as_array().into_iter().chain(operation["parameters"].as_array()).flatten();
            identifiers(listed.map(|parameter| contract::resolved(parameter)["name"].as_str().unwrap()));
        }
    }
    for (name, schema) in DOCUMENT["components"]["schemas"].as_object().unwrap() {
        let paths = paths(schema, "");
        let is_keyword = |path: &String| path.split('.').any(|part| part == "class");
        assert!(!paths.iter().any(is_keyword), "{name}: {paths:?}");
    }
}

/// Dotted paths of the fields below an object of a schema.
fn paths(schema: &Value, group: &str) -> Vec<String> {
    let Some(fields) = schema["properties"].as_object() else { return vec![group.to_owned()] };
    let inner = |(name, field): (&String, &Value)| paths(field, format!("{group}.{name}").trim_start_matches('.'));
    fields.iter().flat_map(inner).collect()
}

#[tokio::test]
async fn the_fields_of_a_scene_are_those_of_the_contract() {
    let table = Server::start().get("/v1/fields").await.expect(200).json();
    let (mut differences, mut known) = (Vec::new(), BTreeSet::new());
    for field in table["items"].as_array().unwrap() {
        let path = field["field"].as_str().unwrap();
        known.insert(path.to_owned());
        let parts = path.split('.').flat_map(|part| ["/properties/", part]).collect::<String>();
        let Some(schema) = DOCUMENT["components"]["schemas"]["ScenePatch"].pointer(&parts) else {
            differences.push(format!("{path}: not in the contract"));
            continue;
        };
        if field["kind"] == "vertices" {
            let coordinate = &schema["items"]["items"];
            assert_eq!((path, &field["unit"]), ("body.vertices", &json!("m")));
            assert_eq!(field["count"], json!({"minimum": schema["minItems"], "maximum": schema["maxItems"]}));
            for end in ["minimum", "maximum"] {
                assert_eq!(field[end].as_f64(), coordinate[end].as_f64(), "{end}");
            }
            continue;
        }
        let words = schema["anyOf"].get(0).map(|of_words| &contract::resolved(of_words)["enum"]);
        let kind = words.map_or_else(|| schema["type"][0].as_str().unwrap(), |_| "string");
        let mut compare = |what: &str, table: &Value, contract: Option<&Value>| {
            let contract = contract.unwrap_or(&Value::Null);
            let equal = match (table.as_f64(), contract.as_f64()) {
                (Some(table), Some(contract)) => table == contract,
                _ => table == contract,
            };
            if !equal {
                differences.push(format!("{path}: {what} is {table} in the table and {contract} in the contract"));
            }
        };
        let numbers = if kind == "array" { &schema["items"] } else { schema };
        compare("minimum", &field["minimum"], numbers.get("minimum"));
        compare("maximum", &field["maximum"], numbers.get("maximum"));
        compare("default", &field["default"], schema.get("x-default"));
        if numbers.get("minimum").is_some() {
            compare("unit", &field["unit"], schema.get("x-unit"));
        }
        if field["symbol"] != json!("") {
            compare("symbol", &field["symbol"], schema.get("x-symbol"));
        }
        compare("choices", &field["choices"], words);
        compare("least count", &field["count"]["minimum"], schema.get("minItems"));
        compare("greatest count", &field["count"]["maximum"], schema.get("maxItems"));
        let kind = match kind {
            "string" => "choice",
            "array" => "numbers",
            other => other,
        };
        compare("kind", &field["kind"], Some(&json!(kind)));
    }
    assert!(["body.vertices", "table.program"].iter().all(|field| known.contains(*field)), "{known:?}");
    for name in paths(&DOCUMENT["components"]["schemas"]["ScenePatch"], "") {
        if !known.contains(&name) {
            differences.push(format!("{name}: not in the table"));
        }
    }
    assert!(differences.is_empty(), "{differences:#?}");
}

/// Schemas of the messages that clients of live runs send.
fn client_messages() -> impl Iterator<Item = &'static Value> {
    let sent = &DOCUMENT["paths"]["/v1/live"]["get"]["x-messages"]["client"];
    sent.as_array().unwrap().iter().map(contract::resolved)
}

#[test]
fn the_messages_of_clients_are_those_of_the_contract() {
    let said: BTreeSet<&str> =
        client_messages().map(|message| message["properties"]["type"]["const"].as_str().unwrap()).collect();
    assert_eq!(ClientMessage::names().collect::<BTreeSet<_>>(), said);
}

#[test]
fn the_documentation_has_units_and_defaults_of_the_table() {
    assert_eq!(differences_of_document(include_str!("../../docs/physics.md")), Vec::<String>::new());
}

#[tokio::test]
async fn what_can_be_set_live_is_what_the_contract_says() {
    let table = Server::start().get("/v1/fields").await.expect(200).json();
    let fields = table["items"].as_array().unwrap().iter();
    let live: BTreeSet<&str> =
        fields.filter(|field| field["live"] == true).map(|field| field["field"].as_str().unwrap()).collect();
    let set = DOCUMENT["components"]["schemas"]["LiveSet"]["properties"].as_object().unwrap();
    let said: BTreeSet<&str> = set.keys().map(String::as_str).filter(|name| *name != "type").collect();
    assert_eq!(live, said);
}

#[tokio::test]
async fn every_preset_is_named_and_can_be_sent_back() {
    let server = Server::start();
    let presets = server.get("/v1/scenes").await.expect(200).json();
    let names: Vec<&Value> = presets["items"].as_array().unwrap().iter().map(|preset| &preset["name"]).collect();
    assert_eq!(json!(names), DOCUMENT["components"]["schemas"]["PresetName"]["enum"]);
    for preset in presets["items"].as_array().unwrap() {
        let name = preset["name"].as_str().unwrap();
        assert_eq!(server.get(&format!("/v1/scenes/{name}")).await.expect(200).json(), *preset);
        let quantities = |side: &str| -> Vec<String> {
            preset[side].as_array().unwrap().iter().map(|quantity| quantity["quantity"].to_string()).collect()
        };
        assert_eq!(quantities("printed"), quantities("computed"), "{name}");
        // The scene in an answer is a valid request, and gives the same scene.
        let named = server.post("/v1/trajectories", &json!({"preset": name, "bounces": 3})).await.expect(200).json();
        let sent = json!({"scene": preset["scene"], "bounces": 3});
        let faults = contract::faults(&DOCUMENT["components"]["schemas"]["TrajectoryRequest"], &sent);
        assert!(faults.is_empty(), "{name}: {faults:?}");
        let spelled = server.post("/v1/trajectories", &sent).await.expect(200).json();
        assert_eq!(named, spelled, "{name}");
        let again = json!({"scene": named["scene"], "bounces": 3});
        assert_eq!(server.post("/v1/trajectories", &again).await.expect(200).json(), named, "{name}");
    }
}

// The table of symbols in `docs/physics.md` against the table of scene fields: units and defaults.

/// Differences of the documentation from the table.
fn differences_of_document(document: &str) -> Vec<String> {
    let (mut differences, mut seen) = (Vec::new(), Vec::new());
    for line in document.lines().filter(|line| line.starts_with('|')) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [_, paths, units, meaning] = cells[..] else { continue };
        let rows: Vec<&Field> = paths.split('`').skip(1).step_by(2).flat_map(expanded).filter_map(field).collect();
        let units: Vec<&str> = units.split(", ").filter(|unit| !unit.is_empty()).collect();
        seen.extend(rows.iter().map(|row| row.path));
        for (index, row) in rows.iter().enumerate() {
            let unit = if units.len() == rows.len() { units.get(index) } else { units.first() };
            if *unit.unwrap_or(&"1") != row.unit && rows.len() <= 4 {
                differences.push(format!("{} is in {unit:?}, and in the table of fields in {}", row.path, row.unit));
            }
            if !has_default(row, meaning) {
                differences.push(format!("the default of {} is not that of the table of fields: {meaning}", row.path));
            }
        }
    }
    let missing = FIELDS.iter().filter(|row| !seen.contains(&row.path));
    differences.extend(missing.map(|row| format!("{} is not in the table of symbols", row.path)));
    differences
}

/// The paths that a name with alternatives in braces, or with a star at its end, stands for.
fn expanded(name: &str) -> Vec<&str> {
    if let Some(group) = name.strip_suffix('*') {
        return FIELDS.iter().map(|row| row.path).filter(|path| path.starts_with(group)).collect();
    }
    let Some((group, rest)) = name.split_once('{') else { return vec![name] };
    let keys: Vec<&str> = rest.trim_end_matches('}').split(", ").collect();
    let matches = |path: &&str| path.strip_prefix(group).is_some_and(|key| keys.contains(&key));
    FIELDS.iter().map(|row| row.path).filter(matches).collect()
}

/// Tells whether a text that names a default names the default of the field.
fn has_default(row: &Field, meaning: &str) -> bool {
    let said = match row.default {
        Some(FieldValue::Number(value)) => format!("default {}", number(value)),
        Some(FieldValue::Choice(word)) => format!("`{word}` (default)"),
        Some(FieldValue::Integer(_) | FieldValue::Flag(_) | FieldValue::Numbers(_)) | None => return true,
    };
    !meaning.contains("default") || meaning.contains(&said)
}
