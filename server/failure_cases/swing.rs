//! Bounces that end while the body does not come to rest: α = κθ takes nothing from the swing.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, rod_of};
use equipoise_physics::map::body::Body;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{ContactStart, Hold, HoldLaw, HoldRequest, HoldSample, hold};
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene, Value};

/// Bounces of half the height ratio on a table that tilts with the rod.
pub(crate) const SETTLED: FailureCase = FailureCase {
    name: "settled-swing",
    title: "The bounces end, and the rod swings on",
    method: "bounces that die out",
    why: "On a table that stands still half of the contact's normal speed is lost in each strike, and after 0.83 s the bounces are over. Where \
          they end even the angle stands, for a moment: it is the turning point of a swing. A table that tilts by κθ pushes \
          the same way whether the rod comes or goes, in bounces and in contact. So the map of angle and spin keeps areas, nothing of \
          the swing is lost, and the rod leans as far the other way, again and again. To bring it to rest the law has to \
          look at the spin too.",
    impacts: 400,
    ask: ("trajectories", "bounces=400"),
    price: 20_000,
    scene: || {
        let numbers = [(Name::TiltGain, 1.1), (Name::Restitution, 0.5), (Name::Theta, 0.1), (Name::Height, 0.25)];
        let mut draft = rod(&numbers);
        draft.set(Name::Strike, Some(Value::Choice("still"))).expect("a test builds every case");
        built(draft)
    },
    find: |scene, impacts| {
        let bounces = Bounces::of(scene, impacts);
        let swing = swing(scene, &bounces);
        let late = largest(&swing.samples[swing.samples.len() / 2..]);
        let spin = bounces.end.theta_dot;
        let says = vec![
            MethodClaim {
                method: "bounces that die out",
                verdict: if bounces.settle_time.is_some() { "at rest" } else { "swings" },
                value: bounces.settle_time,
                unit: Some("s"),
                detail: format!("the run ends as `settled` after {} contacts", bounces.angles.len()),
            },
            MethodClaim {
                method: "velocities at the end of the bounces",
                verdict: if spin.abs() < 1e-3 { "at rest" } else { "swings" },
                value: Some(spin),
                unit: Some("rad/s"),
                detail: format!(
                    "the body moves along x at {:.1e} m/s, and the contact does not move",
                    bounces.end.x_dot
                ),
            },
            MethodClaim {
                method: "forces at the end of the bounces",
                verdict: if bounces.end.theta.abs() > 1e-3 { "swings" } else { "at rest" },
                value: Some(bounces.end.theta),
                unit: Some("rad"),
                detail: format!(
                    "the table stands at {:.4} rad, so the rod is out of balance",
                    rod_of(scene).tilt_gain * bounces.end.theta
                ),
            },
            MethodClaim {
                method: "motion in contact",
                verdict: if late > 0.5 * bounces.end.theta.abs() { "swings" } else { "at rest" },
                value: Some(late),
                unit: Some("rad"),
                detail: format!("the largest angle from {:.0} s to {:.0} s", 0.5 * SWING_TIME, SWING_TIME),
            },
        ];
        let detail = format!(
            "the swing begins at {:.5} rad; after {:.0} s in contact it still reaches {late:.5} rad",
            bounces.end.theta, SWING_TIME
        );
        Findings { truth: "swings", detail, says }
    },
    picture: |scene, impacts| {
        let bounces = Bounces::of(scene, impacts);
        let swing = swing(scene, &bounces);
        let settled = bounces.end.t;
        let shown = settled + 5.0;
        let contact =
            swing.samples.iter().map(|sample| (sample.t, sample.theta)).filter(|(t, _)| *t <= shown).collect();
        let curve = |label, style, points| Curve { label, style, points };
        Chart {
            title: SETTLED.title,
            subtitle: "the angle at the contacts, and then in contact".to_owned(),
            caption: format!(
                "The bounces end at {settled:.3} s, at {:.4} rad. In contact the rod swings as far to the other side.",
                bounces.end.theta
            ),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s"),
                y: ChartAxis::new("angle", "θ", "rad"),
                curves: vec![
                    curve("end of the bounces", CurveStyle::Limit, vec![(settled, -0.15), (settled, 0.15)]),
                    curve("at rest", CurveStyle::Wrong, vec![(settled, bounces.end.theta), (shown, bounces.end.theta)]),
                    curve("bounces", CurveStyle::TruthDots, bounces.angles),
                    curve("in contact", CurveStyle::Truth, contact),
                ],
            }],
        }
    },
};

/// Time in contact that is followed, s.
const SWING_TIME: f64 = 30.0;

/// Contacts of a run that settles.
struct Bounces {
    /// Times, s, and angles, rad, of the contacts.
    angles: Vec<(f64, f64)>,
    /// Last contact.
    end: ContactStart,
    settle_time: Option<f64>,
}

impl Bounces {
    fn of(scene: &Scene, impacts: u64) -> Self {
        let mut angles = Vec::new();
        let mut end =
            ContactStart { t: 0.0, x: 0.0, theta: 0.0, x_dot: 0.0, theta_dot: 0.0, table_speed: 0.0, before: None };
        let mut settle_time = None;
        if let Ok(mut orbit) = scene.orbit() {
            let ending = run(&mut orbit, impacts, |contact| {
                let state = contact.state;
                angles.push((contact.t, state.theta));
                end = ContactStart {
                    t: contact.t,
                    x: contact.x,
                    theta: state.theta,
                    x_dot: state.x_dot,
                    theta_dot: state.theta_dot,
                    table_speed: 0.0,
                    before: None,
                };
                true
            });
            if let Some(Ending::Settled { settle_time: limit, .. }) = ending {
                settle_time = Some(limit);
            }
        }
        Self { angles, end, settle_time }
    }
}

/// The motion in contact after the bounces, by the law of the scene.
fn swing(scene: &Scene, bounces: &Bounces) -> Hold {
    let rod = rod_of(scene);
    let law = HoldLaw::tilt_gain(rod.tilt_gain);
    let request = HoldRequest::new(&Body::plain(rod), &scene.rules(), law, bounces.end, SWING_TIME);
    hold(&request, &mut || true)
}

fn largest(samples: &[HoldSample]) -> f64 {
    samples.iter().map(|sample| sample.theta.abs()).fold(0.0, f64::max)
}
