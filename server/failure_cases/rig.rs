//! Cases of tables. Rigs that are not the ideal one: a bias of the sensed angle, a table that turns as it strikes, a delay, and air, which the
//! linear analysis of the ideal rig does not see; and laws that balance and do not catch.

use equipoise_physics::analysis::evidence::{Evidence, evidence};
use equipoise_physics::analysis::jacobian::{eigenvalues, jacobian, modulus};
use equipoise_physics::analysis::linear_verdict::LinearVerdict;
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::{ARC, X_DOT};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Value::Number;
use equipoise_physics::scene::{Name, Scene, Value};
use nalgebra::DMatrix;

use crate::charts::{ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::case::{
    ANGLE, AngleHistory, BOUNCE, CONTACT, CasePicture, FailureCase, Findings, MethodClaim, STILL, TIME, at_contacts,
    changed, claim, rod_of,
};
use crate::failure_cases::linear::residue;

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
    scene: &[(Name::TiltGain, Number(1.1)), (Name::AngleBias, Number(0.002)), (Name::TableLength, Number(1.0))],
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
        let half_bias = biased(scene, 0.001);
        CasePicture {
            subtitle: "the place of the centre of gravity at the contacts, against time".to_owned(),
            caption: lean(scene).map_or_else(String::new, |claim| format!("The lean: {}.", claim.detail)),
            plots: vec![Plot::new(TIME, ChartAxis::new("place", "x", "m")).with(vec![
                Curve::new("no bias", CurveStyle::Beside, places(&biased(scene, 0.0), 20)),
                Curve::new("1 mrad", CurveStyle::BesideDots, places(&half_bias, impacts)),
                Curve::new("2 mrad", CurveStyle::Truth, places(scene, impacts)),
                Curve::new("", CurveStyle::TruthDots, places(scene, impacts)),
            ])],
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
    scene: &[
        (Name::TiltGain, Number(1.1)),
        (Name::Theta, Number(0.05)),
        (Name::PivotX, Number(0.0)),
        (Name::PivotDepth, Number(0.05)),
        (Name::TiltRate, Value::Choice("follows")),
    ],
    find: |scene, impacts| {
        let ideal = turning(scene, "none");
        let known = turning(scene, "corrected");
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
        let ideal = turning(scene, "none");
        CasePicture {
            subtitle: "the speed of the body just before its contacts, against time".to_owned(),
            caption: pump(scene).map_or_else(String::new, |claim| format!("The pump: {}.", claim.detail)),
            plots: vec![Plot::new(TIME, FALL_SPEED).with(vec![
                Curve::new("does not turn", CurveStyle::Beside, speeds(&ideal, 200)),
                Curve::new("turns", CurveStyle::Truth, speeds(scene, impacts)),
                Curve::new("", CurveStyle::TruthDots, speeds(scene, impacts)),
            ])],
        }
    },
};

/// The scene with a tilt rate at strikes by this word.
fn turning(scene: &Scene, word: &'static str) -> Scene {
    let mut draft = scene.draft();
    draft.set(Name::TiltRate, Some(Value::Choice(word))).expect("a test builds every case");
    draft.build().expect("a test builds every case")
}

/// Axis of downward speeds.
const FALL_SPEED: ChartAxis = ChartAxis::new("vertical speed", "−ẏ", "m/s");

/// Time and downward speed at the contacts of a run.
fn speeds(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    at_contacts(scene, impacts, |contact| (contact.t, -contact.state.y_dot))
}

/// The claim of the energy that the table gives to the swing.
fn pump(scene: &Scene) -> Option<MethodClaim> {
    let Evidence::Balances(balance) = evidence(scene, 0, &mut || true)? else { return None };
    let impacts = balance.bounces_until_critical()?;
    let swing = balance.swing?.ok()?;
    Some(claim(
        "energy of the swing in second order",
        "falls",
        Some(swing.energy),
        Some("m²/s²"),
        format!(
            "a swing of {:.4} rad gains {:.2e} m²/s² a bounce, so that the tilt gain is critical after about {impacts} bounces",
            swing.amplitude, swing.energy
        ),
    ))
}

/// The scene with another bias.
fn biased(scene: &Scene, bias: f64) -> Scene {
    changed(scene, &[(Name::AngleBias, bias)])
}

/// Time and place at the contacts of a run.
fn places(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    at_contacts(scene, impacts, |contact| (contact.t, contact.x))
}

/// The claim of the lean at which the table is square to the rod.
fn lean(scene: &Scene) -> Option<MethodClaim> {
    let Err(NoRepeatingBounce::Moves { at, change, flight_time }) = small_deviations(scene) else { return None };
    let (theta, acceleration) = (at[ARC] / scene.model().rod.radius_of_gyration, change[X_DOT] / flight_time);
    let ends = (2.0 * scene.rules().half_length / acceleration.abs()).sqrt();
    Some(claim(
        "lean with the bias in it",
        "falls",
        Some(acceleration),
        Some("m/s²"),
        format!(
            "square to the table at {theta:.4} rad, {acceleration:.3} m/s² aside, off the table after about {ends:.2} s"
        ),
    ))
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
    scene: &[(Name::TiltGain, Number(1.1)), (Name::Theta, Number(0.02)), (Name::Delay, Number(0.002))],
    find: |scene, impacts| {
        let ideal = changed(scene, &[(Name::Delay, 0.0)]);
        let course = AngleHistory::of(scene, impacts);
        let says = vec![
            residue(&ideal),
            AngleHistory::of(&ideal, impacts).says("run of the ideal rig"),
            closed_loop(scene),
            course.says("run of the scene"),
        ];
        Findings {
            truth: "falls",
            detail: format!("the run ends as `{}` at contact {}", course.ending.name(), course.angles.len()),
            says,
        }
    },
    picture: |scene, impacts| {
        let late = |label, style, delay: f64| {
            AngleHistory::of(&changed(scene, &[(Name::Delay, delay)]), impacts.min(400)).outline(label, style)
        };
        CasePicture {
            subtitle: "the largest angles at the contacts".to_owned(),
            caption: format!("By the delay as feedback: {}.", closed_loop(scene).detail),
            plots: vec![Plot::new(CONTACT, ANGLE).with(vec![
                late("no delay", CurveStyle::Beside, 0.0),
                late("1 ms", CurveStyle::BesideDots, 0.001),
                late("2 ms", CurveStyle::Truth, 0.002),
            ])],
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
    scene: &[
        (Name::TiltGain, Number(1.1)),
        (Name::Theta, Number(0.1)),
        (Name::Drag, Number(0.05)),
        (Name::RotationDrag, Number(0.05)),
    ],
    find: |scene, impacts| {
        let ideal = without_air(scene);
        let mut says = vec![residue(&ideal), AngleHistory::of(&ideal, impacts).says("run without air")];
        let course = AngleHistory::of(scene, impacts);
        let speeds = speeds(scene, impacts);
        let (first, last) = (speeds.first().copied().unwrap_or_default(), speeds.last().copied().unwrap_or_default());
        let height = |speed: f64| 500.0 * speed * speed / scene.gravity();
        says.push(claim("run of the scene", "dies out", Some(last.1), Some("m/s"), format!(
                "bounces of {:.0} mm at first have {:.1} mm at contact {}, after {:.1} s, with angles of at most {:.3} rad by then and {:.3} rad before",
                height(first.1),
                height(last.1),
                course.angles.len(),
                last.0,
                course.angles.iter().rev().take(20).fold(0.0, |most: f64, angle| most.max(angle.abs())),
                course.max()
            )));
        let repeats = if small_deviations(scene).is_ok() { "one bounce repeats" } else { "no bounce repeats" };
        Findings {
            truth: "dies out",
            detail: format!("every flight loses energy to the air and nothing gives it back: {repeats}"),
            says,
        }
    },
    picture: |scene, impacts| {
        let thinner = changed(scene, &[(Name::Drag, 0.01), (Name::RotationDrag, 0.01)]);
        CasePicture {
            subtitle: "the speed of the body just before its contacts, against time".to_owned(),
            caption: "Law: a flight at the speed u takes about the share 2cu/(3G) of it.".to_owned(),
            plots: vec![Plot::new(TIME, FALL_SPEED).with(vec![
                Curve::new("no air", CurveStyle::Beside, speeds(&without_air(scene), impacts.min(400))),
                Curve::new("1 % a second", CurveStyle::BesideDots, speeds(&thinner, impacts.min(400))),
                Curve::new("5 % a second", CurveStyle::Truth, speeds(scene, impacts)),
            ])],
        }
    },
};

fn without_air(scene: &Scene) -> Scene {
    changed(scene, &[(Name::Drag, 0.0), (Name::RotationDrag, 0.0)])
}

// Laws that balance a bounce or hold a contact, and do not catch: a low target, and a gain for the contact at the first strikes.

/// A target at the height of a body that stands on the table.
pub(crate) const LOW_TARGET: FailureCase = FailureCase {
    name: "low-target",
    title: "A target so low that the rod should stand",
    method: "geometric tail of the first flights",
    why: "Energy feedback holds any height, so a target at the height of a standing rod should bring it to rest. But the table strikes in \
          proportion to the contact speed and to the energy that is left, so near rest its effect is of third order: a strike turns the \
          speed v into v − av³ with a = (1 + e)κ_E/2. At the target the eigenvalue is 1. The speed falls as 2/(aGt), which is \
          slower than any geometric series: whatever flights the tail is taken from, it promises a rest that does not come. A table that \
          catches must strike with a ratio below 1, whatever the speed.",
    impacts: 5_000,
    ask: ("trajectories", "bounces=5000"),
    price: 11_000,
    scene: &[(Name::TiltGain, Number(1.1)), (Name::EnergyGain, Number(0.4)), (Name::TargetHeight, Number(0.4 / 3.0))],
    find: |scene, impacts| {
        let bounces = bounces(scene, impacts);
        let (t, speed) = bounces.last().copied().unwrap_or_default();
        let seconds = |method, verdict, value: Option<f64>, detail| claim(method, verdict, value, Some("s"), detail);
        let tail = |method, first: usize| {
            let end = geometric_limit(&bounces, first);
            let detail = match end {
                Some(end) => {
                    let there = bounces.iter().rev().find(|(t, _)| *t <= end).map_or(0.0, |(_, speed)| *speed);
                    format!("at rest at {end:.2} s; the run comes down at {:.1} mm/s there", 1e3 * there)
                }
                None => "its flights do not shrink".to_owned(),
            };
            seconds(method, if end.is_some() { "settles" } else { "goes on" }, end, detail)
        };
        let a = strength(scene);
        let gravity = scene.gravity();
        let expected = 2.0 / (a * gravity * t);
        let still_to_go = 2.0 / (a * gravity * 1e-3);
        let says = vec![
            tail("geometric tail of the first two flights", 0),
            tail("geometric tail of flights 1000 and 1001", 999),
            seconds(
                "slowing down as 2/(aGt)",
                "goes on",
                Some(still_to_go),
                format!("1 mm/s only after {still_to_go:.0} s, and {:.2e} strikes", 0.5e6 / a),
            ),
            seconds(
                "run of the scene",
                "goes on",
                Some(t),
                format!("comes down at {:.2} mm/s at contact {}", 1e3 * speed, bounces.len()),
            ),
        ];
        let detail = format!(
            "after {t:.1} s the contact speed is {:.2} mm/s; 2/(aGt) gives {:.2} mm/s",
            1e3 * speed,
            1e3 * expected
        );
        Findings { truth: "goes on", detail, says }
    },
    picture: |scene, impacts| {
        let bounces = bounces(scene, impacts);
        let last = bounces.last().copied().unwrap_or_default();
        let scale = 2.0 / (strength(scene) * scene.gravity());
        let tails = [(0, CurveStyle::Wrong, "tail of flights 1 and 2"), (999, CurveStyle::Second, "of 1000 and 1001")];
        let mut curves =
            vec![Curve::new("2/(aGt)", CurveStyle::Beside, vec![(0.5 * scale, 2.0), (100.0, 0.01 * scale)])];
        curves.extend(
            tails.into_iter().map(|(first, style, label)| Curve::new(label, style, geometric_tail(&bounces, first))),
        );
        curves.push(Curve::new("the run", CurveStyle::Truth, bounces));
        CasePicture {
            subtitle: "the speed at which the rod comes down, against time".to_owned(),
            caption: format!(
                "A geometric series of flights ends in a finite time. The run is at {:.2} mm/s after {:.1} s.",
                1e3 * last.1,
                last.0
            ),
            plots: vec![
                Plot::new(
                    TIME.logarithmic().between(0.1, 100.0),
                    ChartAxis::new("contact speed", "v", "m/s").logarithmic().between(1e-3, 2.0),
                )
                .with(curves),
            ],
        }
    },
};

/// The gain that holds a rod in contact, used from the first strike on.
pub(crate) const CONTACT_GAIN: FailureCase = FailureCase {
    name: "contact-gain",
    title: "The law that holds the rod, too early",
    method: "eigenvalues of the motion in contact",
    why: "The gain is the best one for a rod that stands on the table: there every deviation dies out. The rod only has to come down \
          first, with each bounce 0.7 times as fast as the one before. But a strike is not a push. At 1.5 m/s it turns the rod \
          by as much as the contact would in a quarter of a second, all at once and without a look in between, so the same \
          gain overshoots: a deviation is multiplied by −22. The law must follow the contact speed, from the discrete problem \
          of the strikes to the continuous one of the contact.",
    impacts: 100,
    ask: ("trajectories", "bounces=100"),
    price: 2_000,
    scene: &[
        CONTACT_LAW[0],
        CONTACT_LAW[1],
        CONTACT_LAW[2],
        CONTACT_LAW[3],
        STILL,
        // It comes down at the first contact speed from here.
        (Name::Height, Number(0.4 / 3.0 + FIRST_SPEED * FIRST_SPEED / (2.0 * 9.81))),
        (Name::Restitution, Number(0.7)),
        (Name::Theta, Number(3e-4)),
    ],
    find: |scene, impacts| {
        let contact = slowest_decay(scene);
        let factor = strike_factor(scene);
        let course = AngleHistory::of(scene, impacts);
        let mut says = vec![claim(
            "eigenvalues of the motion in contact",
            if contact < 0.0 { "bounded" } else { "falls" },
            Some(contact),
            Some("1/s"),
            "the largest real part; every deviation of a standing rod dies out".to_owned(),
        )];
        says.push(claim(
            "derivative of the first bounce",
            if factor > 1.0 { "falls" } else { "bounded" },
            Some(factor),
            None,
            format!("the largest modulus of its eigenvalues at {FIRST_SPEED} m/s"),
        ));
        says.push(course.says("run of the scene"));
        Findings {
            truth: "falls",
            detail: format!("a bounce multiplies a deviation by {factor:.2}; the run: {}", says[2].detail),
            says,
        }
    },
    picture: |scene, impacts| {
        let course = AngleHistory::of(scene, impacts);
        let factor = strike_factor(scene);
        let start = scene.start().theta;
        let count = course.angles.len();
        let numbered =
            |value: &dyn Fn(usize) -> f64| (0..count).map(|n| (n as f64 + 1.0, value(n))).collect::<Vec<_>>();
        let decay = slowest_decay(scene);
        let times: Vec<f64> = bounces(scene, impacts).iter().map(|(t, _)| *t).collect();
        let since = |n: usize| times.get(n).copied().unwrap_or_default() - times.first().copied().unwrap_or_default();
        let topple = scene.rules().topple_angle;
        CasePicture {
            subtitle: format!("the angle at the contacts, released at {start} rad"),
            caption: format!(
                "A bounce at {FIRST_SPEED} m/s multiplies a deviation by {factor:.1}. The run: {}.",
                course.says("").detail
            ),
            plots: vec![Plot::new(BOUNCE.between(1.0, count as f64 + 1.0), ANGLE).with(vec![
                Curve::new("topple angle", CurveStyle::Limit, vec![(1.0, topple), (count as f64 + 1.0, topple)]),
                Curve::new("decay in contact", CurveStyle::Wrong, numbered(&|n| start * libm::exp(decay * since(n)))),
                Curve::new("the run", CurveStyle::TruthDots, numbered(&|n| course.angles[n].abs())),
            ])],
        }
    },
};

/// Contact speed of the first strike, m/s.
const FIRST_SPEED: f64 = 1.5;

/// The optimal gain in contact for weights (1, 10, 0.1, 0.1) and 10, in four digits.
const CONTACT_LAW: [(Name, Value); 4] = [
    (Name::FeedbackX, Number(0.3162)),
    (Name::FeedbackTheta, Number(-2.9078)),
    (Name::FeedbackXDot, Number(0.3647)),
    (Name::FeedbackThetaDot, Number(-0.2463)),
];

/// a in v ↦ v − av³, s²/m².
fn strength(scene: &Scene) -> f64 {
    let rod = rod_of(scene);
    0.5 * (1.0 + rod.restitution) * scene.number(Name::EnergyGain).unwrap_or_default()
}

/// Times of the contacts (s) and speeds at which the contact point comes down (m/s).
fn bounces(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    let rod = rod_of(scene);
    at_contacts(scene, impacts, |contact| (contact.t, -rod.contact_speed(&contact.state)))
}

/// Time and speed of contact `first`, with the time and ratio of the two flights after it.
fn flights(bounces: &[(f64, f64)], first: usize) -> Option<((f64, f64), f64, f64)> {
    let [start, middle, end] = bounces.get(first..first + 3)? else { return None };
    let (one, other) = (middle.0 - start.0, end.0 - middle.0);
    Some((*start, one, other / one))
}

/// Time at which the flights would have ended if they shrank in proportion from contact `first` on, s.
fn geometric_limit(bounces: &[(f64, f64)], first: usize) -> Option<f64> {
    let (start, flight, ratio) = flights(bounces, first)?;
    (ratio < 1.0).then(|| start.0 + flight / (1.0 - ratio))
}

/// Contact speed of such flights against time.
fn geometric_tail(bounces: &[(f64, f64)], first: usize) -> Vec<(f64, f64)> {
    let Some((start, flight, ratio)) = flights(bounces, first) else { return Vec::new() };
    let mut point = (start, flight);
    let tail = std::iter::from_fn(|| {
        let ((t, speed), flight) = point;
        point = ((t + flight, speed * ratio), flight * ratio);
        Some((t, speed))
    });
    // A point for each hundredth of the speed is enough.
    let apart = (1.0 / (100.0 * (1.0 - ratio))).max(1.0) as usize;
    tail.step_by(apart).take_while(|(_, speed)| *speed > 1e-3).collect()
}

/// Largest real part of the eigenvalues of the motion in contact about upright, with the gain of the scene, 1/s.
fn slowest_decay(scene: &Scene) -> f64 {
    let rod = rod_of(scene);
    let (l, rho, gravity) = (rod.contact_distance, rod.radius_of_gyration, rod.gravity);
    // ẍ = −Gα and θ̈ = (Gl/ρ²)(θ − α) with α = −Ks.
    let stiffness = gravity * l / (rho * rho);
    let [x, theta, x_dot, theta_dot] = CONTACT_LAW.map(|(name, _)| scene.number(name).unwrap_or_default());
    let rows = [
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [x, theta, x_dot, theta_dot].map(|gain| gravity * gain),
        [x, theta + 1.0, x_dot, theta_dot].map(|gain| stiffness * gain),
    ];
    let closed = DMatrix::from_row_iterator(4, 4, rows.into_iter().flatten());
    let values = eigenvalues(&closed).unwrap_or_default();
    values.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max)
}

/// Largest modulus of the eigenvalues of one bounce at the first contact speed, upright.
fn strike_factor(scene: &Scene) -> f64 {
    let upright = State { theta: 0.0, x_dot: 0.0, y_dot: -FIRST_SPEED, theta_dot: 0.0 };
    let matrix = jacobian(&scene.model(), &upright, 1).map(|linearization| linearization.matrix);
    let values = matrix.ok().and_then(|matrix| eigenvalues(&matrix)).unwrap_or_default();
    values.into_iter().map(modulus).fold(0.0, f64::max)
}
