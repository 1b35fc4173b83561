//! The picture of `previews`: a card with the headline, the scene and the orbit.

use equipoise_physics::run::ending::EndingKind;

use crate::api::formats::Pictured;
use crate::api::previews::answer::PreviewAnswer;
use crate::api::scene::has_angle;
use crate::api::shared::outcome::RunEnding;
use crate::charts::{Card, CardPlane, card};
use crate::http::Problem;

impl Pictured for PreviewAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        let drawing = &self.drawing;
        Ok(card(&Card {
            title: &self.title,
            text: &self.text,
            goes_on: self.outcome.ending == RunEnding::Bouncing(EndingKind::Completed),
            path: &drawing.path,
            release: &drawing.release,
            contact: drawing.contact.as_ref(),
            plane: CardPlane {
                symbols: if has_angle(self.scene.0) { ("θ", "θ̇") } else { ("ẋ", "ẏ") },
                states: &drawing.states,
            },
        }))
    }
}
