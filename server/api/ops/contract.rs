//! `/openapi.yaml`, the contract as it was written, and `/openapi.json`, the same for programs. `/openapi.json?formats=json` is the view
//! for generators of clients: the operations that answer JSON, and of their answers the JSON alone.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, Response, Uri};
use axum::routing::get;
use serde_json::Value;

use crate::api::app::App;
use crate::http::Problem;
use crate::http::request::tree;
use crate::http::response::representation::StaticAsset;

static YAML: LazyLock<StaticAsset> =
    LazyLock::new(|| StaticAsset::new("application/yaml", include_bytes!("../../../openapi.yaml").as_slice()));

/// The contract as JSON.
pub(crate) const WRITTEN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/openapi.json"));

static JSON: LazyLock<StaticAsset> = LazyLock::new(|| StaticAsset::new("application/json", WRITTEN));

static JSON_ONLY: LazyLock<StaticAsset> = LazyLock::new(|| {
    let mut document = serde_json::from_slice(WRITTEN).unwrap_or_default();
    keep_json(&mut document);
    StaticAsset::new("application/json", document.to_string().into_bytes())
});

/// Both paths.
pub fn routes() -> Router<App> {
    Router::new()
        .route("/openapi.yaml", get(async |headers: HeaderMap| YAML.answer(&headers)))
        .route("/openapi.json", get(json))
}

async fn json(uri: Uri, headers: HeaderMap) -> Result<Response<Body>, Problem> {
    let parameters = tree::parameters(uri.query().unwrap_or_default())?;
    match parameters.as_slice() {
        [] => JSON.answer(&headers),
        [(name, value)] if name == "formats" && value == "json" => JSON_ONLY.answer(&headers),
        [(name, _), ..] => Err(Problem::invalid_at(
            format!("/{name}"),
            "the only parameter here is `formats`, and its only value is `json`",
        )),
    }
}

/// The media types that generated clients read.
const KEPT: [&str; 2] = ["application/json", "application/problem+json"];

/// Leaves the operations that take and give JSON, without parameters on the form of the answer.
fn keep_json(document: &mut Value) {
    let parameters = document["components"]["parameters"].clone();
    let is_of_form = |reference: &Value| {
        let component = reference["$ref"].as_str().and_then(|reference| reference.rsplit('/').next());
        let name = component.and_then(|component| parameters[component]["name"].as_str());
        name == Some("format")
    };
    for response in document["components"]["responses"].as_object_mut().into_iter().flatten() {
        keep_json_content(response.1);
    }
    let responses = document["components"]["responses"].clone();
    let answers_json = |operation: &Value| {
        let body = &operation["requestBody"]["content"];
        let ok = &operation["responses"]["200"];
        let name = ok["$ref"].as_str().and_then(|reference| reference.rsplit('/').next());
        let ok = name.map_or(ok, |name| &responses[name]);
        let content = ok["content"].get(KEPT[0]);
        (body.is_null() || body.get(KEPT[0]).is_some())
            && (content.is_some() || ok.get("content").is_none())
            && !ok.is_null()
    };
    for (_, item) in document["paths"].as_object_mut().into_iter().flatten() {
        let Some(item) = item.as_object_mut() else { continue };
        item.retain(|method, operation| method == "parameters" || answers_json(operation));
        for operation in item.values_mut() {
            if let Some(parameters) = operation.get_mut("parameters").and_then(Value::as_array_mut) {
                parameters.retain(|parameter| !is_of_form(parameter));
            }
            if let Some(body) = operation.get_mut("requestBody") {
                keep_json_content(body);
            }
            for (_, response) in operation.get_mut("responses").and_then(Value::as_object_mut).into_iter().flatten() {
                keep_json_content(response);
            }
        }
    }
    if let Some(paths) = document["paths"].as_object_mut() {
        paths.retain(|_, item| item.as_object().is_some_and(|item| item.keys().any(|method| method != "parameters")));
    }
    keep_used(document);
}

/// Leaves the components that an operation leads to.
fn keep_used(document: &mut Value) {
    let (mut used, mut open) = (BTreeSet::new(), vec![&document["paths"]]);
    while let Some(node) = open.pop() {
        match node {
            Value::String(text) if text.starts_with("#/components/") && used.insert(text.clone()) => {
                open.extend(document.pointer(&text[1..]));
            }
            Value::Object(members) => open.extend(members.values()),
            Value::Array(items) => open.extend(items),
            _ => {}
        }
    }
    for kind in ["schemas", "parameters", "responses"] {
        let components = document["components"][kind].as_object_mut();
        if let Some(components) = components {
            components.retain(|name, _| used.contains(&format!("#/components/{kind}/{name}")));
        }
    }
}

fn keep_json_content(response: &mut Value) {
    if let Some(content) = response.get_mut("content").and_then(Value::as_object_mut)
        && content.contains_key(KEPT[0]) | content.contains_key(KEPT[1])
    {
        content.retain(|media_type, _| KEPT.contains(&media_type.as_str()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_of_json_has_no_other_form() {
        let mut document: Value = serde_json::from_slice(WRITTEN).unwrap();
        keep_json(&mut document);
        let paths = document["paths"].as_object().unwrap();
        assert!(paths.contains_key("/v1/stability") && paths.contains_key("/v1/scenes/{name}"));
        assert!(
            !paths.contains_key("/v1/live") && !paths.contains_key("/metrics") && !paths.contains_key("/openapi.yaml")
        );
        for other in ["text/csv", "application/x-ndjson\":", "image/png"] {
            let operations = paths.values().flat_map(|item| item.as_object().unwrap().values());
            let names = operations.filter_map(|operation| operation["responses"]["200"]["$ref"].as_str());
            for name in names.map(|name| name.rsplit('/').next().unwrap()) {
                assert!(document["components"]["responses"][name]["content"].get(other).is_none(), "{name}: {other}");
            }
        }
        let text = document["paths"].to_string() + &document["components"]["responses"].to_string();
        assert!(!text.contains("Format\"") && !text.contains("text/csv\":"));
        let schemas = document["components"]["schemas"].as_object().unwrap();
        assert!(schemas.contains_key("Stability") && !schemas.contains_key("LadderLine"));
    }
}
