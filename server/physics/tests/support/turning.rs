//! Scenes with tables that turn as they strike, and their runs.

use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Contact, run};
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::support::rig;

/// Sets a number of a draft.
pub(crate) fn number(draft: &mut Draft, name: Name, number: f64) {
    draft.set(name, Some(Value::Number(number))).unwrap();
}

/// The scene with a table that turns about a pivot at a place, or under the contact.
pub(crate) fn turning(scene: &Scene, word: &'static str, place: Option<f64>, depth: f64) -> Draft {
    let mut draft = scene.draft();
    draft.set(Name::TiltRate, Some(Value::Choice(word))).unwrap();
    draft.set(Name::PivotX, place.map(Value::Number)).unwrap();
    number(&mut draft, Name::PivotDepth, depth);
    draft
}

/// The scene with other numbers.
pub(crate) fn with(scene: &Scene, values: &[(Name, f64)]) -> Scene {
    rig::with(scene.draft(), values)
}

/// Contacts of a run, and its ending.
pub(crate) fn contacts(scene: &Scene, impacts: u64) -> (Vec<Contact>, Ending) {
    let mut contacts = Vec::new();
    let ending = match scene.orbit() {
        Ok(mut orbit) => run(&mut orbit, impacts, |contact| {
            contacts.push(*contact);
            true
        }),
        Err(no_contact) => Some(no_contact.ending(0.0, 0.0)),
    };
    (contacts, ending.unwrap())
}

/// t, x, θ, ẋ, ẏ, θ̇ at a contact.
pub(crate) fn numbers(contact: &Contact) -> [f64; 6] {
    let State { theta, x_dot, y_dot, theta_dot } = contact.state;
    [contact.t, contact.x, theta, x_dot, y_dot, theta_dot]
}
