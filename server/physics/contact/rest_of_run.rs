//! The contact that follows when the bounces of a run have died out, under the scene's own table.

use crate::contact::request::{ContactStart, HoldLaw, HoldRequest};
use crate::run::contact::Contact;
use crate::scene::{BodyShape, Scene};

/// The motion in contact for so long (s) after the last strike of a run that settled: it begins at `settle_time` (s), to which the body
/// drifts and turns as the strike left it. `None` for a point mass, without a strike, on a table whose turning acts on the body, and
/// in air that drags it: the motion in contact is not derived there.
///
/// The table goes on by the scene's law, α = κθ or its state feedback, tilting about the contact point. It moves along itself if
/// `table.slide` is `matched`.
pub fn rest_of_run(scene: &Scene, last: &Contact, settle_time: f64, duration: f64) -> Option<HoldRequest> {
    if scene.body == BodyShape::Point || scene.acting_turn().is_some() || scene.drag().is_some() {
        return None;
    }
    let start = ContactStart { table_speed: 0.0, ..ContactStart::after(last, &last.strike?, settle_time) };
    Some(under_scene(scene, start, duration))
}

/// Work by which the contact after the bounces of any run of a scene is priced, for so long (s).
pub fn work_of_rest(scene: &Scene, duration: f64) -> u64 {
    if scene.body == BodyShape::Point { 0 } else { under_scene(scene, ContactStart::default(), duration).work() }
}

/// A contact under the scene's own table.
fn under_scene(scene: &Scene, start: ContactStart, duration: f64) -> HoldRequest {
    let body = scene.running_model();
    let law = HoldLaw::of(scene.steering, &body.rod, scene.constant_tilt);
    HoldRequest::new(&body, &scene.rules(), law, start, duration)
}
