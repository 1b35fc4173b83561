//! Rigs that are not the ideal one: a bias of the sensed angle, a table that turns as it strikes, a delay, and air. The linear analysis of the
//! ideal rig does not see them.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::angle_history::{ANGLE, AngleHistory, CONTACT};
use crate::failure_cases::basin::residue;
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, with};
use equipoise_physics::analysis::evidence::{Evidence, evidence};
use equipoise_physics::analysis::linear_verdict::LinearVerdict;
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::{ARC, X_DOT};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

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
    ask: ("stability", "bounces=500"),
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

/// A pivot in the middle of the table, 5 cm below its surface.
pub(crate) const TURNING: FailureCase = FailureCase {
    name: "turning-table",
    title: "Elliptic on paper, pumped up by a table that turns as it strikes",
    method: "residue and margins of a table that does not turn",
    why: "The tilt gain is well inside the stable interval. The analysis takes the table as tilted but at rest in its turning, and a table that follows \
          α = κθ is not: it turns at κθ̇ when it strikes. Its surface then moves by that times the distance from the pivot, here a few cm/s. In first \
          order that changes the height of the next bounces by as much upwards as downwards, and the eigenvalues stay what they are. In second order \
          the surface moves up where the rod comes down while it swings out, on both sides. So every swing makes the bounce a little higher, until \
          the tilt gain is critical for its height.",
    impacts: 2_000,
    ask: ("stability", "bounces=500"),
    price: 8_000,
    scene: || built(about(rod(&[(Name::TiltGain, 1.1), (Name::Theta, 0.05)]), "follows")),
    find: |scene, impacts| {
        let ideal = built(about(scene.draft(), "none"));
        let known = built(about(scene.draft(), "corrected"));
        let mut says =
            vec![residue(&ideal), AngleHistory::of(&ideal, impacts).says("run on a table that does not turn")];
        says.extend(pump(scene));
        let course = AngleHistory::of(scene, impacts);
        says.push(course.says("run of the scene"));
        let detail = format!(
            "the run ends as `{}` at contact {}; with a law that corrects for the turning it has {} contacts",
            course.ending.name(),
            course.angles.len(),
            AngleHistory::of(&known, impacts).angles.len()
        );
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| {
        let curve = |label, style, points| Curve { label, style, points };
        let ideal = built(about(scene.draft(), "none"));
        Chart {
            title: TURNING.title,
            subtitle: "the speed of the body just before its contacts, against time".to_owned(),
            caption: pump(scene).map_or_else(String::new, |claim| format!("The pump: {}.", claim.detail)),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s"),
                y: ChartAxis::new("vertical speed", "−ẏ", "m/s"),
                curves: vec![
                    curve("does not turn", CurveStyle::Beside, speeds(&ideal, 200)),
                    curve("turns", CurveStyle::Truth, speeds(scene, impacts)),
                    curve("", CurveStyle::TruthDots, speeds(scene, impacts)),
                ],
            }],
        }
    },
};

/// A draft with a pivot, and a tilt rate at strikes by this word.
fn about(draft: Draft, word: &'static str) -> Draft {
    let mut draft = with(draft, &[(Name::PivotX, 0.0), (Name::PivotDepth, 0.05)]);
    draft.set(Name::TiltRate, Some(Value::Choice(word))).expect("a test builds every case");
    draft
}

/// Time and downward speed at the contacts of a run.
fn speeds(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    course(scene, impacts, |contact| -contact.state.y_dot)
}

/// The claim of the energy that the table gives to the swing.
fn pump(scene: &Scene) -> Option<MethodClaim> {
    let Evidence::Balances(balance) = evidence(scene, 0, &mut || true)? else { return None };
    let impacts = balance.bounces_until_critical()?;
    let swing = balance.swing?.ok()?;
    Some(MethodClaim {
        method: "energy of the swing in second order",
        verdict: "falls",
        value: Some(swing.energy),
        unit: Some("m²/s²"),
        detail: format!(
            "a swing of {:.4} rad gains {:.2e} m²/s² a bounce, so that the tilt gain is critical after about {impacts} bounces",
            swing.amplitude, swing.energy
        ),
    })
}

/// The scene with another bias.
fn biased(scene: &Scene, bias: f64) -> Scene {
    built(with(scene.draft(), &[(Name::AngleBias, bias)]))
}

/// Time and place at the contacts of a run.
fn places(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    course(scene, impacts, |contact| contact.x)
}

/// Time and a value at the contacts of a run.
fn course(scene: &Scene, impacts: u64, value: fn(&Contact) -> f64) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    if let Ok(mut orbit) = scene.orbit() {
        run(&mut orbit, impacts, |contact| {
            points.push((contact.t, value(contact)));
            true
        });
    }
    points
}

/// The claim of the lean at which the table is square to the rod.
fn lean(scene: &Scene) -> Option<MethodClaim> {
    let Err(NoRepeatingBounce::Moves { at, change, flight_time }) = small_deviations(scene) else { return None };
    let (theta, acceleration) = (at[ARC] / scene.model().rod.radius_of_gyration, change[X_DOT] / flight_time);
    let ends = (2.0 * scene.rules().half_length / acceleration.abs()).sqrt();
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

/// 2 ms from the camera to the strike.
pub(crate) const LATE: FailureCase = FailureCase {
    name: "late-sensing",
    title: "Elliptic on paper, falling with a delay of 2 ms",
    method: "residue and margins of the ideal rig",
    why: "The tilt gain is well inside the stable interval. This rig tilts by the angle that its camera saw 2 ms before the strike, a hundredth of a \
          flight. Between two strikes the angle grows at a constant rate, so the table acts by κθ − κτθ̇: a feedback of the angular velocity, and with \
          the wrong sign. The ideal bounce neither damps a swing nor feeds it. There is no margin to spend, and the delay feeds the swing at every \
          tilt gain above 0, by the square root of 1 + (2Vl/ρ²)κτ a bounce. A table that carries the angle on along the flight has the ideal bounce \
          again.",
    impacts: 2_000,
    ask: ("stability", "bounces=500"),
    price: 8_000,
    scene: || built(rod(&[(Name::TiltGain, 1.1), (Name::Theta, 0.02), (Name::Delay, 0.002)])),
    find: |scene, impacts| {
        let ideal = built(with(scene.draft(), &[(Name::Delay, 0.0)]));
        let course = AngleHistory::of(scene, impacts);
        let says = vec![
            residue(&ideal),
            AngleHistory::of(&ideal, impacts).says("run of the ideal rig"),
            closed_loop(scene),
            course.says("run of the scene"),
        ];
        let detail = format!("the run ends as `{}` at contact {}", course.ending.name(), course.angles.len());
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| {
        let late = |label, style, delay: f64| {
            AngleHistory::of(&built(with(scene.draft(), &[(Name::Delay, delay)])), impacts.min(400))
                .outline(label, style)
        };
        Chart {
            title: LATE.title,
            subtitle: "the largest angles at the contacts".to_owned(),
            caption: format!("By the delay as feedback: {}.", closed_loop(scene).detail),
            plots: vec![Plot {
                x: CONTACT,
                y: ANGLE,
                curves: vec![
                    late("no delay", CurveStyle::Beside, 0.0),
                    late("1 ms", CurveStyle::BesideDots, 0.001),
                    late("2 ms", CurveStyle::Truth, 0.002),
                ],
            }],
        }
    },
};

/// The claim of the linear verdict with the delay in it.
fn closed_loop(scene: &Scene) -> MethodClaim {
    let linear = small_deviations(scene).ok().map(|small| small.linear);
    let radius = linear.as_ref().map_or(f64::NAN, LinearVerdict::spectral_radius);
    let bounded = linear.is_some_and(|linear| linear.says_bounded());
    MethodClaim {
        method: "closed loop with the delay in it",
        verdict: if bounded { "bounded" } else { "falls" },
        value: Some(radius),
        unit: None,
        detail: format!(
            "the spectral radius is {radius:.6}, so a swing grows tenfold in {:.0} bounces",
            std::f64::consts::LN_10 / libm::log(radius)
        ),
    }
}

/// An air table whose film takes 5 % of the velocity in a second.
pub(crate) const AIR: FailureCase = FailureCase {
    name: "air-drag",
    title: "Elliptic on paper, braked to rest by the air of an air table",
    method: "residue and margins without air",
    why: "The table makes up all that the strike loses, so on paper every bounce is as high as the last, for ever. The film of air that carries the body \
          on an air table drags it by 5 % a second. Nothing gives that back: the table knows what the contact loses and not what the flight does. A bounce \
          at the speed u loses the share 2cu/(3G) of it, so the speed falls as 1/n and no bounce repeats. The same drag damps the swing: the rod stays \
          upright while its bounces die out. With energy feedback the height holds, below its target (preset air-table).",
    impacts: 2_000,
    ask: ("stability", "bounces=500"),
    price: 8_000,
    scene: || built(rod(&[(Name::TiltGain, 1.1), (Name::Theta, 0.1), (Name::Drag, 0.05), (Name::RotationDrag, 0.05)])),
    find: |scene, impacts| {
        let ideal = built(without_air(scene));
        let mut says = vec![residue(&ideal), AngleHistory::of(&ideal, impacts).says("run without air")];
        let course = AngleHistory::of(scene, impacts);
        let speeds = speeds(scene, impacts);
        let (first, last) = (speeds.first().copied().unwrap_or_default(), speeds.last().copied().unwrap_or_default());
        let height = |speed: f64| 500.0 * speed * speed / scene.gravity();
        says.push(MethodClaim {
            method: "run of the scene",
            verdict: "dies out",
            value: Some(last.1),
            unit: Some("m/s"),
            detail: format!(
                "bounces of {:.0} mm at first have {:.1} mm at contact {}, after {:.1} s, with angles of at most {:.3} rad by then and {:.3} rad before",
                height(first.1),
                height(last.1),
                course.angles.len(),
                last.0,
                course.angles.iter().rev().take(20).fold(0.0, |most: f64, angle| most.max(angle.abs())),
                course.max()
            ),
        });
        let repeats = if small_deviations(scene).is_ok() { "one bounce repeats" } else { "no bounce repeats" };
        let detail = format!("every flight loses energy to the air and nothing gives it back: {repeats}");
        Findings { truth: "dies out", detail, says }
    },
    picture: |scene, impacts| {
        let curve = |label, style, points| Curve { label, style, points };
        let thinner = built(with(scene.draft(), &[(Name::Drag, 0.01), (Name::RotationDrag, 0.01)]));
        Chart {
            title: AIR.title,
            subtitle: "the speed of the body just before its contacts, against time".to_owned(),
            caption: "Law: a flight at the speed u takes about the share 2cu/(3G) of it.".to_owned(),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s"),
                y: ChartAxis::new("vertical speed", "−ẏ", "m/s"),
                curves: vec![
                    curve("no air", CurveStyle::Beside, speeds(&built(without_air(scene)), impacts.min(400))),
                    curve("1 % a second", CurveStyle::BesideDots, speeds(&thinner, impacts.min(400))),
                    curve("5 % a second", CurveStyle::Truth, speeds(scene, impacts)),
                ],
            }],
        }
    },
};

fn without_air(scene: &Scene) -> Draft {
    with(scene.draft(), &[(Name::Drag, 0.0), (Name::RotationDrag, 0.0)])
}
