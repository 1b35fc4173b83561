//! The whole contract: the parts that follow from the code, and the part that is written by hand, which wins where both say something.
//!
//! The part by hand has short forms, which its first comment lists. They are written out here.

use serde_json::{Map, Value, json};

use crate::api::contract::{errors, header_references, reference};
use crate::api::shared::refusal::exceptions;

/// The media types that come first, in this order.
const MEDIA_ORDER: [&str; 3] = ["application/json", "text/csv", "application/x-ndjson"];

/// The document of both parts.
pub fn document(parts: Value, by_hand: Value) -> Value {
    let mut document = by_hand;
    for (path, item) in each(&mut document["paths"]) {
        write_out_operation(item, parts["paths"].get(path));
    }
    for (name, response) in each(&mut document["components"]["responses"]) {
        write_out_response(response, &parts["components"]["responses"][name]);
    }
    for (_, schema) in each(&mut document["components"]["schemas"]) {
        write_out_description(schema);
    }
    merge(&mut document, parts);
    if let Some(about) = document["info"]["description"].as_str() {
        document["info"]["description"] = json!(about.replace("{exceptions}\n", &exceptions()));
    }
    for (_, response) in each(&mut document["components"]["responses"]) {
        // Generators take the first.
        if let Some(content) = response.get_mut("content").and_then(Value::as_object_mut) {
            sort(content, &MEDIA_ORDER);
        }
        add_build(response);
    }
    let responses = document["components"]["responses"].clone();
    for (path, item) in each(&mut document["paths"]) {
        let Some(item) = item.as_object_mut() else { continue };
        for (_, operation) in item.iter_mut().filter(|(_, operation)| operation.is_object()) {
            complete_operation(operation);
            if let Some(content) = operation.pointer_mut("/requestBody/content").and_then(Value::as_object_mut) {
                sort(content, &MEDIA_ORDER);
            }
        }
        if let Some(head) = item.get("get").filter(|_| path.starts_with("/v1/")).and_then(|get| head(get, &responses)) {
            item.insert("head".to_owned(), head);
        }
        let summary = item.get("get").map(|get| get["summary"].clone());
        if let (Some(post), Some(summary)) = (item.get_mut("post"), summary)
            && post.get("summary").is_none()
        {
            post["summary"] = summary;
        }
        for operation in item.values_mut().filter_map(Value::as_object_mut) {
            sort(operation, &OPERATION_ORDER);
        }
        sort(item, &METHOD_ORDER);
    }
    document["components"]["schemas"].as_object_mut().into_iter().for_each(Map::sort_keys);
    document
}

/// Each member of an object.
fn each(object: &mut Value) -> impl Iterator<Item = (&String, &mut Value)> {
    object.as_object_mut().into_iter().flatten()
}

/// Writes out a path: its members are those of its GET, or of its POST if it has no other; `examples` are bodies of its POST.
fn write_out_operation(item: &mut Value, of_code: Option<&Value>) {
    let Some(mut members) = item.as_object_mut().map(std::mem::take) else { return };
    let mut post = json!({});
    if let Some(Value::Object(examples)) = members.shift_remove("examples") {
        let example = |(name, mut value): (String, Value)| {
            let summary = value.as_object_mut().and_then(|value| value.shift_remove("summary"));
            (name, json!({"summary": summary, "value": value}))
        };
        let examples: Map<_, _> = examples.into_iter().map(example).collect();
        post["requestBody"]["content"]["application/json"]["examples"] = Value::Object(examples);
    }
    if let Some(body) = members.get_mut("requestBody") {
        write_out_content(body, &Value::Null);
    }
    let mut responses = json!({});
    if let Some(answer) = members.shift_remove("answer") {
        responses["200"] = reference("responses", answer.as_str().unwrap_or_default());
    }
    if let Some(Value::Array(statuses)) = members.shift_remove("errors") {
        let statuses: Vec<_> = statuses.iter().map(Value::to_string).collect();
        merge(&mut responses, errors(&statuses.iter().map(String::as_str).collect::<Vec<_>>()));
    }
    let mut operation = Value::Object(members);
    merge(&mut operation, json!({"responses": responses}));
    if of_code.is_some_and(|item| item.get("get").is_none()) {
        merge(&mut operation, post);
        *item = json!({"post": operation});
    } else {
        *item = json!({"get": operation});
        if post["requestBody"].is_object() {
            item["post"] = post;
        }
    }
}

/// Writes out a response: a text is its description; a text as a media type is the description of its schema; a list as the parameters of a
/// link are fields of the answer's scene.
fn write_out_response(response: &mut Value, of_code: &Value) {
    write_out_description(response);
    write_out_content(response, &of_code["content"]);
    let links = response.get_mut("links").and_then(Value::as_object_mut);
    for parameters in links.into_iter().flatten().filter_map(|(_, link)| link.get_mut("parameters")) {
        if let Value::Array(fields) = parameters {
            let field = |path: &str| {
                let pointer = path.replace('.', "/");
                (format!("scene.{path}"), json!(format!("$response.body#/scene/{pointer}")))
            };
            *parameters = Value::Object(fields.iter().filter_map(Value::as_str).map(field).collect());
        }
    }
}

/// Writes out the media types of a response or a body.
fn write_out_content(part: &mut Value, of_code: &Value) {
    let content = part.get_mut("content").and_then(Value::as_object_mut);
    for (media_type, media) in content.into_iter().flatten().filter(|(_, media)| media.is_string()) {
        let mut schema = json!({"description": media.take()});
        if of_code.get(media_type).is_none() {
            schema["type"] = json!("string");
        }
        *media = json!({"schema": schema});
    }
}

/// Writes out a text, which is a description.
fn write_out_description(part: &mut Value) {
    if part.is_string() {
        *part = json!({"description": part.take()});
    }
}

/// Adds what every operation has.
fn complete_operation(operation: &mut Value) {
    let mut every = json!({"tags": ["Operation"], "responses": errors(&["421"])});
    // An operation without a security of its own may need the token.
    if operation.get("security").is_none() {
        merge(&mut every, json!({"responses": errors(&["401"])}));
    }
    merge(operation, every);
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    for (status, response) in responses.iter_mut() {
        if status != "101" && response.get("$ref").is_none() {
            add_build(response);
        }
    }
    responses.sort_keys();
}

/// Gives a response the header of the build, which every answer has.
fn add_build(response: &mut Value) {
    merge(response, json!({"headers": header_references(&["equipoise-build"])}));
}

const METHOD_ORDER: [&str; 4] = ["parameters", "get", "head", "post"];

const OPERATION_ORDER: [&str; 10] = [
    "tags",
    "operationId",
    "x-refuses",
    "summary",
    "description",
    "parameters",
    "x-base-query",
    "x-queries",
    "requestBody",
    "responses",
];

/// Sorts the members of an object; others come last.
fn sort(object: &mut Map<String, Value>, order: &[&str]) {
    let mut members: Vec<_> = std::mem::take(object).into_iter().collect();
    members.sort_by_key(|(key, _)| order.iter().position(|known| known == key).unwrap_or(order.len()));
    object.extend(members);
}

/// The HEAD of a GET whose answer is one document; None for a stream.
fn head(get: &Value, responses: &Value) -> Option<Value> {
    let answer = get["responses"]["200"]["$ref"].as_str()?.rsplit('/').next()?;
    let headers = &responses[answer]["headers"];
    headers.get("Vary")?;
    let of = |status: &str| match status {
        "200" if headers.get("ETag").is_none() => Some("HeadOfPrecision"),
        "200" => Some("Head"),
        "206" | "416" => None,
        "304" => Some("NotModified"),
        "401" => Some("HeadOfUnauthorized"),
        "503" => Some("HeadOfOverloaded"),
        _ => Some("HeadOfProblem"),
    };
    let statuses = get["responses"].as_object()?.keys();
    let responses: Map<_, _> =
        statuses.filter_map(|status| Some((status.clone(), reference("responses", of(status)?)))).collect();
    let name = get["operationId"].as_str()?;
    let name = name.strip_prefix("get").or_else(|| name.strip_prefix("list"))?;
    let mut head = json!({
        "tags": get["tags"],
        "operationId": format!("head{name}"),
        "summary": format!("{}, headers only", get["summary"].as_str()?),
    });
    if let Some(parameters) = get.get("parameters") {
        head["parameters"] = parameters.clone();
    }
    head["responses"] = Value::Object(responses);
    Some(head)
}

/// Merges a document into another, whose own values win.
fn merge(into: &mut Value, other: Value) {
    if let (Some(into), Value::Object(other)) = (into.as_object_mut(), other) {
        for (key, value) in other {
            match into.get_mut(&key) {
                Some(own) => merge(own, value),
                None => {
                    into.insert(key, value);
                }
            }
        }
    }
}
