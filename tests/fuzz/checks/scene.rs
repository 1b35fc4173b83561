//! The scene of a POST: from the bytes of a body, through the same reader, to the scene that runs.

use equipoise::api::scene::{read_scene, scene_to_json, scene_to_query};
use equipoise::api::shared::model_words::model_reason;
use equipoise::http::request::tree;
use equipoise::http::{Errors, Problem, Reader, Source};
use equipoise_physics::scene::Scene;
use serde_json::{Map, Value};

use super::problem;

/// A body is read as JSON. Errors have pointers. A scene that is written out reads back as the same scene, from JSON and from a query.
pub(crate) fn check(body: &[u8]) {
    let fields = match tree::object(body) {
        Ok(fields) => fields,
        Err(refused) => return problem::hold(&refused, None, body.len()),
    };
    let sent = Value::Object(fields);
    let plain: Value = serde_json::from_slice(body).expect("what is read strictly is JSON");
    // Compared as text, so that the sign of zero counts.
    assert_eq!(sent.to_string(), plain.to_string());
    match read(sent.as_object().expect("it was one"), Source::Json) {
        Ok(scene) => hold(&scene),
        Err(refused) => problem::hold(&refused, Some(&sent), body.len()),
    }
}

/// Reads a scene as a resource without further parameters does.
pub(crate) fn read(fields: &Map<String, Value>, source: Source) -> Result<Scene, Problem> {
    let mut errors = Errors::default();
    let mut reader = Reader::new(fields, String::new(), source, &mut errors);
    let scene = read_scene(&mut reader);
    reader.finish();
    errors.into_result()?;
    Ok(scene.expect("where there is no scene, the errors say why"))
}

/// Panics unless a scene can be written out and read back.
pub(crate) fn hold(scene: &Scene) {
    let written = scene_to_json(scene).to_string();
    assert!(!written.contains("null"), "a number that is none: {written}");
    let body = format!("{{\"scene\":{written}}}");
    let again = tree::object(body.as_bytes()).and_then(|fields| read(&fields, Source::Json));
    let again = again.unwrap_or_else(|refused| panic!("{written} was refused: {refused:?}"));
    assert_eq!(again, *scene);
    assert_eq!(scene_to_json(&again).to_string(), written);
    let query = form_urlencoded::Serializer::new(String::new()).extend_pairs(scene_to_query(scene)).finish();
    let asked = super::query::tree(&query).and_then(|fields| read(&fields, Source::Query));
    let asked = asked.unwrap_or_else(|refused| panic!("{query} was refused: {refused:?}"));
    assert_eq!(scene_to_json(&asked).to_string(), written);
    // Every valid scene has a model and a reason for it.
    let _ = scene.model();
    assert!(!model_reason(scene).is_empty());
}
