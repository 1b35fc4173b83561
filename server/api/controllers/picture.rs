//! The picture of `controllers`: the closed loop on the unit circle.

use crate::api::controllers::answer::ControllerAnswer;
use crate::api::formats::Pictured;
use crate::api::shared::closed_loop::draw_closed_loop;
use crate::http::Problem;

impl Pictured for ControllerAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let title = format!("Closed loop on a {} contact", self.law.contact);
        Ok(draw_closed_loop(&title, &self.notes.join("; "), &self.linear_model, self.design.gain))
    }
}
