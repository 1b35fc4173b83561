//! The picture of `stability`: the eigenvalues on the unit circle, over κ or over the factor on a feedback.

use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::stability::contact_regime::contact_regime;

use crate::api::formats::Pictured;
use crate::api::shared::closed_loop::draw_closed_loop;
use crate::api::stability::answer::StabilityAnswer;
use crate::charts::{Eigenvalues, Spectrum, eigenvalues};
use crate::http::Problem;

impl Pictured for StabilityAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        if let (Some(gain), Some(place)) = (self.scene.0.model().feedback(), &self.fixed_point) {
            let model =
                BounceModel::new(&self.scene.0.parameters(), -place.y_dot, contact_regime(&self.scene.0.model()));
            let title = format!("Closed loop: {}", self.verdict.as_deref().unwrap_or("no verdict"));
            return Ok(draw_closed_loop(&title, &self.reason, &model, gain));
        }
        let values: Vec<(f64, f64)> =
            self.linear.iter().flat_map(|linear| &linear.eigenvalues).map(|value| (value.re, value.im)).collect();
        Ok(eigenvalues(&Eigenvalues {
            title: &format!("Eigenvalues of a {}", self.model.name.replace('_', " ")),
            verdict: self.verdict.as_deref(),
            reason: &self.reason,
            linear: self.linear.as_ref().and_then(|linear| {
                let tilt_gain = linear.tilt_gain.as_ref()?;
                Some(Spectrum {
                    eigenvalues: &values,
                    tilt_gain: tilt_gain.value,
                    lower: tilt_gain.lower,
                    critical: tilt_gain.critical,
                    residue: linear.residue,
                    rotation: linear.rotation,
                })
            }),
        }))
    }
}
