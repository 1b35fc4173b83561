//! Laws that balance a bounce or hold a contact, and do not catch: a low target, and a gain for the contact at the first strikes.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::angle_history::{ANGLE, AngleHistory};
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, rod_of};
use equipoise_physics::analysis::jacobian::{eigenvalues, jacobian, modulus};
use equipoise_physics::map::strike::State;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene, Value};
use nalgebra::DMatrix;

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
    scene: || {
        let l = 0.4 / 3.0;
        built(rod(&[(Name::TiltGain, 1.1), (Name::EnergyGain, LOW_TARGET_GAIN), (Name::TargetHeight, l)]))
    },
    find: |scene, impacts| {
        let bounces = bounces(scene, impacts);
        let (t, speed) = bounces.last().copied().unwrap_or_default();
        let seconds = |method, verdict, value: Option<f64>, detail| MethodClaim {
            method,
            verdict,
            value,
            unit: Some("s"),
            detail,
        };
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
        let curve = |label, style, points| Curve { label, style, points };
        let tails = [(0, CurveStyle::Wrong, "tail of flights 1 and 2"), (999, CurveStyle::Second, "of 1000 and 1001")];
        let mut curves = vec![curve("2/(aGt)", CurveStyle::Beside, vec![(0.5 * scale, 2.0), (100.0, 0.01 * scale)])];
        curves.extend(
            tails.into_iter().map(|(first, style, label)| curve(label, style, geometric_tail(&bounces, first))),
        );
        curves.push(curve("the run", CurveStyle::Truth, bounces));
        Chart {
            title: LOW_TARGET.title,
            subtitle: "the speed at which the rod comes down, against time".to_owned(),
            caption: format!(
                "A geometric series of flights ends in a finite time. The run is at {:.2} mm/s after {:.1} s.",
                1e3 * last.1,
                last.0
            ),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s").logarithmic().between(0.1, 100.0),
                y: ChartAxis::new("contact speed", "v", "m/s").logarithmic().between(1e-3, 2.0),
                curves,
            }],
        }
    },
};

/// κ_E of the low target, s²/m².
const LOW_TARGET_GAIN: f64 = 0.4;

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
    scene: || {
        // It comes down at 1.5 m/s from here.
        let height = 0.4 / 3.0 + FIRST_SPEED * FIRST_SPEED / (2.0 * 9.81);
        let mut draft = rod(&CONTACT_LAW);
        for (name, value) in [(Name::Height, height), (Name::Restitution, 0.7), (Name::Theta, 3e-4)] {
            draft.set(name, Some(Value::Number(value))).expect("a test builds every case");
        }
        draft.set(Name::Strike, Some(Value::Choice("still"))).expect("a test builds every case");
        built(draft)
    },
    find: |scene, impacts| {
        let contact = slowest_decay(scene);
        let factor = strike_factor(scene);
        let course = AngleHistory::of(scene, impacts);
        let mut says = vec![MethodClaim {
            method: "eigenvalues of the motion in contact",
            verdict: if contact < 0.0 { "bounded" } else { "falls" },
            value: Some(contact),
            unit: Some("1/s"),
            detail: "the largest real part; every deviation of a standing rod dies out".to_owned(),
        }];
        says.push(MethodClaim {
            method: "derivative of the first bounce",
            verdict: if factor > 1.0 { "falls" } else { "bounded" },
            value: Some(factor),
            unit: None,
            detail: format!("the largest modulus of its eigenvalues at {FIRST_SPEED} m/s"),
        });
        says.push(course.says("run of the scene"));
        let detail = format!("a bounce multiplies a deviation by {factor:.2}; the run: {}", says[2].detail);
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| {
        let course = AngleHistory::of(scene, impacts);
        let factor = strike_factor(scene);
        let start = scene.start().theta;
        let count = course.angles.len();
        let numbered =
            |value: &dyn Fn(usize) -> f64| (0..count).map(|n| (n as f64 + 1.0, value(n))).collect::<Vec<_>>();
        let curve = |label, style, points| Curve { label, style, points };
        let decay = slowest_decay(scene);
        let times: Vec<f64> = bounces(scene, impacts).iter().map(|(t, _)| *t).collect();
        let since = |n: usize| times.get(n).copied().unwrap_or_default() - times.first().copied().unwrap_or_default();
        let topple = scene.rules().topple_angle;
        Chart {
            title: CONTACT_GAIN.title,
            subtitle: format!("the angle at the contacts, released at {start} rad"),
            caption: format!(
                "A bounce at {FIRST_SPEED} m/s multiplies a deviation by {factor:.1}. The run: {}.",
                course.says("").detail
            ),
            plots: vec![Plot {
                x: ChartAxis::new("contact", "n", "").between(1.0, count as f64 + 1.0),
                y: ANGLE,
                curves: vec![
                    curve("topple angle", CurveStyle::Limit, vec![(1.0, topple), (count as f64 + 1.0, topple)]),
                    curve("decay in contact", CurveStyle::Wrong, numbered(&|n| start * libm::exp(decay * since(n)))),
                    curve("the run", CurveStyle::TruthDots, numbered(&|n| course.angles[n].abs())),
                ],
            }],
        }
    },
};

/// Contact speed of the first strike, m/s.
const FIRST_SPEED: f64 = 1.5;

/// The optimal gain in contact for weights (1, 10, 0.1, 0.1) and 10, in four digits.
const CONTACT_LAW: [(Name, f64); 4] = [
    (Name::FeedbackX, 0.3162),
    (Name::FeedbackTheta, -2.9078),
    (Name::FeedbackXDot, 0.3647),
    (Name::FeedbackThetaDot, -0.2463),
];

/// a in v ↦ v − av³, s²/m².
fn strength(scene: &Scene) -> f64 {
    let rod = rod_of(scene);
    0.5 * (1.0 + rod.restitution) * scene.number(Name::EnergyGain).unwrap_or_default()
}

/// Times of the contacts (s) and speeds at which the contact point comes down (m/s).
fn bounces(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    let rod = rod_of(scene);
    let mut bounces = Vec::new();
    if let Ok(mut orbit) = scene.orbit() {
        run(&mut orbit, impacts, |contact| {
            bounces.push((contact.t, -rod.contact_speed(&contact.state)));
            true
        });
    }
    bounces
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
