//! Every problem has a 4xx status, errors whose pointers lead somewhere, and a size bounded by that of the request.

use equipoise::http::{Problem, ProblemError};
use equipoise::limits;
use equipoise_physics::scene::{FIELDS, VERTICES};
use serde_json::Value;

/// Names outside `FIELDS` that a problem may point to although they were not sent.
const NAMES: &[&str] = &["preset", "scene", "body", "type", "value", "impact", "wall_ms", "run", "speed"];

/// Longest sentence about one field, characters. It quotes a part of the input, and known names in full.
const LONGEST: usize = 1500;

/// Panics unless this is a proper answer to `sent`, a request of some bytes; `None` if the request is not one JSON value.
pub(crate) fn hold(problem: &Problem, sent: Option<&Value>, bytes: usize) {
    let (status, errors) = (problem.status().as_u16(), problem.errors());
    assert!(status == 400 || status == 422, "{problem:?}");
    assert!(errors.len() <= limits::ERRORS, "{} errors", errors.len());
    assert_eq!(status == 422, !errors.is_empty(), "every error of a field has its place: {problem:?}");
    assert!(!problem.detail().is_empty() && problem.detail().chars().count() <= LONGEST + 20, "{problem:?}");
    let written = problem.to_json().len();
    assert!(written <= 64 * 1024 + 16 * bytes, "a problem of {written} bytes about {bytes}");
    for ProblemError { pointer, detail } in errors {
        assert!(!detail.is_empty() && detail.chars().count() <= LONGEST, "{pointer}: {detail}");
        assert!(pointer.is_empty() || pointer.starts_with('/'), "{pointer}");
        let escapes = pointer.split('~').skip(1);
        assert!(escapes.into_iter().all(|rest| rest.starts_with(['0', '1'])), "{pointer} is no pointer");
        if let Some(sent) = sent {
            // A query may leave `scene` out of its names; errors are about the body with it.
            let leads = [Some(pointer.as_str()), pointer.strip_prefix("/scene")].into_iter().flatten().any(|pointer| {
                sent.pointer(pointer).is_some() || is_missing(sent, pointer, detail) || names_a_field(pointer)
            });
            assert!(leads, "{pointer} leads nowhere: {detail}");
        }
    }
}

/// True if `detail` calls a field missing, and the object in which it is missing was sent.
fn is_missing(sent: &Value, pointer: &str, detail: &str) -> bool {
    let place = pointer.rsplit_once('/').and_then(|(parent, name)| Some((sent.pointer(parent)?.as_object()?, name)));
    place.is_some_and(|(object, name)| !object.contains_key(name) && detail == format!("{name} is missing"))
}

/// True if a pointer ends with the path of a field.
fn names_a_field(pointer: &str) -> bool {
    let ends = |path: &str| {
        let rest = pointer.strip_suffix(&path.replace('.', "/")).or_else(|| pointer.strip_suffix(path));
        rest.is_some_and(|rest| rest.ends_with('/'))
    };
    FIELDS.iter().map(|row| row.path).chain([VERTICES]).chain(NAMES.iter().copied()).any(ends)
}
