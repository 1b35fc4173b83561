//! The picture of `stability`: the eigenvalues on the unit circle, over κ or over the factor on a feedback.

use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;

use crate::api::formats::Pictured;
use crate::api::shared::closed_loop::draw_closed_loop;
use crate::api::shared::margins::{Margin, MarginEnd, SMALL, TILT_GAIN};
use crate::api::stability::answer::StabilityAnswer;
use crate::charts::{Eigenvalues, Spectrum, eigenvalues};
use crate::http::Problem;

impl Pictured for StabilityAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        let body = self.scene.0.with_tilt_law().model();
        if let (Some(gain), Some(place)) = (body.feedback(), &self.fixed_point) {
            let upright = State { theta: 0.0, x_dot: 0.0, y_dot: place.y_dot, theta_dot: 0.0 };
            let model = BounceModel::of(&body, &PreImpact::at(1, place.x.unwrap_or(0.0), upright), place.flight_time);
            let title = format!("Closed loop: {}", self.verdict.text);
            return Ok(draw_closed_loop(&title, &self.verdict.reason, &model, gain));
        }
        let values = self.eigenvalues();
        Ok(eigenvalues(&Eigenvalues {
            title: &format!("Eigenvalues of a {}", self.model.name.replace('_', " ")),
            verdict: &self.verdict.text,
            reason: &self.verdict.reason,
            linear: self.spectrum(&values).filter(|spectrum| !spectrum.lower.is_nan()),
        }))
    }
}

impl StabilityAnswer<'_> {
    fn eigenvalues(&self) -> Vec<(f64, f64)> {
        self.linear.iter().flat_map(|linear| &linear.eigenvalues).map(|value| (value.re, value.im)).collect()
    }

    /// The linear analysis as it is drawn. Without a tilt gain that balances, its numbers are NaN, and there is no path to draw.
    fn spectrum<'a>(&self, eigenvalues: &'a [(f64, f64)]) -> Option<Spectrum<'a>> {
        let linear = self.linear.as_ref()?;
        let margin = self.margins.iter().find(|margin| (margin.of, margin.field) == (SMALL, TILT_GAIN));
        let [tilt_gain, lower, critical] = margin.map_or([f64::NAN; 3], |Margin { value, below, above, .. }| {
            let limit = |end: &Option<MarginEnd>, none: f64| end.as_ref().map_or(none, |end| end.limit);
            [*value, limit(below, f64::NAN), limit(above, f64::INFINITY)]
        });
        let (residue, rotation) = (linear.residue, linear.rotation);
        Some(Spectrum { eigenvalues, tilt_gain, lower, critical, residue, rotation })
    }
}
