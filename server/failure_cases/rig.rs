//! A rig that is not the ideal one: a bias of the sensed angle, which the linear analysis of the ideal rig does not see.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::angle_history::AngleHistory;
use crate::failure_cases::basin::residue;
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, with};
use equipoise_physics::control::steady_drift::SteadyDrift;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene};

/// 2 mrad of bias on a table of 1 m.
pub(crate) const BIAS: FailureCase = FailureCase {
    name: "biased-angle",
    title: "Elliptic on paper, off the table with a bias of 2 mrad",
    method: "residue and margins of the ideal rig",
    why: "The tilt gain is well inside the stable interval, and the ideal rod bounces on for as long as anyone has looked. This rig senses \
          the angle 2 mrad too large, a tenth of a degree, and noise of that size would average out. A bias does not: the table is square to \
          the rod not when it is upright but when it leans by c/(κ − 1), eleven times the constant tilt c. There nothing turns it back, and every \
          strike pushes it the same way. The angle stays bounded as promised; the place grows with the square of time, until the table \
          ends.",
    impacts: 2_000,
    ask: ("stability", "impacts=500"),
    price: 8_000,
    scene: || built(rod(&[(Name::TiltGain, 1.1), (Name::AngleBias, 0.002), (Name::TableLength, 1.0)])),
    find: |scene, impacts| {
        let ideal = biased(scene, 0.0);
        let mut says = vec![residue(&ideal), AngleHistory::of(&ideal, impacts).says("run of the ideal rig")];
        says.extend(lean(scene));
        let course = AngleHistory::of(scene, impacts);
        says.push(course.says("run of the scene"));
        let end = places(scene, impacts).last().copied().unwrap_or_default();
        let detail = format!(
            "the run ends as `{}` at contact {}, after {:.2} s and at x = {:.3} m, with angles of at most {:.3} rad",
            course.ending.name(),
            course.angles.len(),
            end.0,
            end.1,
            course.max()
        );
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| {
        let curve = |label, style, points| Curve { label, style, points };
        let half_bias = biased(scene, 0.001);
        Chart {
            title: BIAS.title,
            subtitle: "the place of the centre of gravity at the contacts, against time".to_owned(),
            caption: lean(scene).map_or_else(String::new, |claim| format!("The lean: {}.", claim.detail)),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s"),
                y: ChartAxis::new("place", "x", "m"),
                curves: vec![
                    curve("no bias", CurveStyle::Beside, places(&biased(scene, 0.0), 20)),
                    curve("1 mrad", CurveStyle::BesideDots, places(&half_bias, impacts)),
                    curve("2 mrad", CurveStyle::Truth, places(scene, impacts)),
                    curve("", CurveStyle::TruthDots, places(scene, impacts)),
                ],
            }],
        }
    },
};

/// The scene with another bias.
fn biased(scene: &Scene, bias: f64) -> Scene {
    built(with(scene.draft(), &[(Name::AngleBias, bias)]))
}

/// Time and place at the contacts of a run.
fn places(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    if let Ok(mut orbit) = scene.orbit() {
        run(&mut orbit, impacts, |contact| {
            places.push((contact.t, contact.x));
            true
        });
    }
    places
}

/// The claim of the lean at which the table is square to the rod.
fn lean(scene: &Scene) -> Option<MethodClaim> {
    let drift = SteadyDrift::of(scene)?;
    let SteadyDrift::Accelerates { theta, acceleration: Some(acceleration) } = drift else { return None };
    let ends = drift.time_on_table(scene.rules().half_length).unwrap_or_default();
    Some(MethodClaim {
        method: "lean with the bias in it",
        verdict: "falls",
        value: Some(acceleration),
        unit: Some("m/s²"),
        detail: format!(
            "square to the table at {theta:.4} rad, {acceleration:.3} m/s² aside, off the table after about {ends:.2} s"
        ),
    })
}
