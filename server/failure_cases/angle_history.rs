//! The angle along a run, as the map gives it and as the linear map would.

use crate::charts::{ChartAxis, Curve, CurveStyle};
use crate::failure_cases::case::MethodClaim;
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::Scene;

/// θ at the contacts of a run and how it ended.
pub(crate) struct AngleHistory {
    /// θ at contact 1 and on, rad.
    pub(crate) angles: Vec<f64>,
    pub(crate) ending: Ending,
}

impl AngleHistory {
    /// The history of a scene, up to a number of contacts.
    pub(crate) fn of(scene: &Scene, impacts: u64) -> Self {
        let mut angles = Vec::new();
        let ending = scene.orbit().ok().and_then(|mut orbit| {
            run(&mut orbit, impacts, |contact| {
                angles.push(contact.state.theta);
                true
            })
        });
        Self { angles, ending: ending.unwrap_or(Ending::Completed) }
    }

    /// The history of the linear map: θ' = (1 − 4R)θ + u, u' = u − 4Rθ with u = τθ̇.
    pub(crate) fn linear(scene: &Scene, fixed_point: &FixedPoint, impacts: u64) -> Self {
        let residue = small_deviations(scene).ok().and_then(|small| small.linear.residue).unwrap_or_default();
        let start = scene.start();
        let limit = scene.rules().topple_angle;
        let (mut theta, mut turn) = (start.theta, fixed_point.flight_time * start.theta_dot);
        let mut angles = Vec::new();
        for _ in 0..impacts {
            angles.push(theta);
            if theta.abs() >= limit {
                return Self { angles, ending: Ending::Toppled { theta, limit } };
            }
            turn -= 4.0 * residue * theta;
            theta += turn;
        }
        Self { angles, ending: Ending::Completed }
    }

    pub(crate) fn survived(&self) -> bool {
        self.ending == Ending::Completed
    }

    pub(crate) fn max(&self) -> f64 {
        self.angles.iter().map(|theta| theta.abs()).fold(0.0, f64::max)
    }

    /// The claim of the run about the angle.
    pub(crate) fn says(&self, method: &'static str) -> MethodClaim {
        let (verdict, end) = if self.survived() {
            ("bounded", format!("{} contacts survived", self.angles.len()))
        } else {
            ("falls", format!("ends as `{}` at contact {}", self.ending.name(), self.angles.len()))
        };
        let detail = format!("{end}; the largest angle at a contact is {:.4} rad", self.max());
        MethodClaim { method, verdict, value: Some(self.max()), unit: Some("rad"), detail }
    }

    /// |θ| against the number of the contact: the largest of each of some hundred stretches, each a few percent longer than
    /// the one before.
    pub(crate) fn outline(&self, label: &'static str, style: CurveStyle) -> Curve {
        let mut points = Vec::new();
        let mut first = 0;
        while first < self.angles.len() {
            let next = (first + 1 + first / 32).min(self.angles.len());
            let largest = (first..next).max_by(|a, b| self.angles[*a].abs().total_cmp(&self.angles[*b].abs()));
            points.extend(largest.map(|index| (index as f64 + 1.0, self.angles[index].abs())));
            first = next;
        }
        Curve { label, style, points }
    }
}

/// The axes of outlines.
pub(crate) const CONTACT: ChartAxis = ChartAxis::new("contact", "n", "").logarithmic();
pub(crate) const ANGLE: ChartAxis = ChartAxis::new("angle at the contact", "|θ|", "rad").logarithmic();
