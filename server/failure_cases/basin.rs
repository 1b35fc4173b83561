//! Cases in which the linear analysis holds only in a small neighbourhood: a drift of the angle, a wide start, and a resonance.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::angle_history::AngleHistory;
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::eigenvalue::{eigenvalue, upright};
use crate::failure_cases::scenes::{built, rod, with};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene};

/// κ = 1: the table follows the rod, and nothing turns it back.
pub(crate) const DRIFT: FailureCase = FailureCase {
    name: "parallel-drift",
    title: "|λ| = 1 at κ = 1, and the angle drifts off",
    method: "spectral radius of the Jacobian",
    why: "At κ = 1 the table stands square to the rod at every strike, so no strike ever turns it: Greene's residue is 0 and both \
          angle eigenvalues are exactly +1. On the circle, therefore neutral, so a small deviation stays small? The two \
          eigenvalues share one eigenvector. What spin there is stays, and the angle grows by as much in every flight, linearly \
          and without bound, until the table would have to pull. A modulus of 1 says nothing without the Jordan block.",
    impacts: 100,
    ask: ("trajectories", "bounces=100"),
    price: 400,
    scene: || built(rod(&[(Name::TiltGain, 1.0), (Name::ThetaDot, 0.01)])),
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let course = AngleHistory::of(scene, impacts);
        let says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            course.says("run of the scene"),
        ];
        let spin = scene.start().theta_dot;
        let off = states(scene, impacts).iter().map(|(t, theta, _)| (theta - spin * t).abs()).fold(0.0, f64::max);
        let detail = format!(
            "the angle is {spin} rad/s times the time, within {off:.1e} rad at every contact; the run: {}",
            says[1].detail
        );
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| {
        let over_time = |scene: &Scene| states(scene, impacts).iter().map(|(t, theta, _)| (*t, *theta)).collect();
        let balanced = built(with(scene.draft(), &[(Name::TiltGain, 1.02)]));
        let curve = |label, style, points| Curve { label, style, points };
        Chart {
            title: DRIFT.title,
            subtitle: format!(
                "the angle at the contacts, released upright with a spin of {} rad/s",
                scene.start().theta_dot
            ),
            caption: format!(
                "The run: {}. At a tilt gain of 1.02 the same release circles about upright.",
                AngleHistory::of(scene, impacts).says("").detail
            ),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s"),
                y: ChartAxis::new("angle at the contact", "θ", "rad"),
                curves: vec![
                    curve("tilt gain 1.02", CurveStyle::BesideDots, over_time(&balanced)),
                    curve("the run", CurveStyle::Truth, over_time(scene)),
                    curve("", CurveStyle::TruthDots, over_time(scene)),
                ],
            }],
        }
    },
};

/// A start outside of the basin.
pub(crate) const WIDE: FailureCase = FailureCase {
    name: "wide-start",
    title: "Linearly stable, released too wide",
    method: "residue and margins of the linear analysis",
    why: "The tilt gain is well inside the stable interval: the residue is 0.6, small deviations circle, and so they do for ever \
          as far as anyone has looked. But stability of the fixed point speaks of a neighbourhood and does not say how large it \
          is. At 0.1 rad the run survives, at 0.3 rad it is outside of the basin and falls within a few bounces; no eigenvalue \
          and no margin of κ has moved meanwhile.",
    impacts: 2_000,
    ask: ("stability", "bounces=500&basin=true"),
    price: 5_000,
    scene: || built(rod(&[(Name::TiltGain, 1.3), (Name::Theta, 0.3)])),
    find: |scene, impacts| {
        let narrow = built(with(scene.draft(), &[(Name::Theta, 0.1)]));
        let says = vec![
            residue(scene),
            AngleHistory::of(&narrow, impacts).says("run from 0.1 rad"),
            AngleHistory::of(scene, impacts).says("run of the scene"),
        ];
        Findings { truth: "falls", detail: format!("the run: {}", says[2].detail), says }
    },
    picture: |scene, _| {
        let narrow = |theta: f64| built(with(scene.draft(), &[(Name::Theta, theta)]));
        let mut curves: Vec<Curve> = [0.05, 0.1, 0.15, 0.2]
            .iter()
            .map(|theta| plane("", CurveStyle::BesideDots, &narrow(*theta), 400))
            .collect();
        curves[0].label = "runs from 0.05 to 0.2 rad";
        curves.push(plane("the run from 0.3 rad", CurveStyle::Truth, scene, 400));
        curves.push(plane("", CurveStyle::TruthDots, scene, 400));
        Chart {
            title: WIDE.title,
            subtitle: "states just before the contacts; the linear analysis is that of the smallest loop".to_owned(),
            caption: format!("The run: {}.", AngleHistory::of(scene, 400).says("").detail),
            plots: vec![Plot { x: THETA, y: SPIN, curves }],
        }
    },
};

/// Resonance of order 3, which a drift lets in.
pub(crate) const RESONANCE: FailureCase = FailureCase {
    name: "order-three",
    title: "Linearly stable, undone by a resonance of order 3",
    method: "residue and margins of the linear analysis",
    why: "At residue 3/4 small deviations turn by a third of a circle a bounce. At that one rotation inside the stable interval the \
          quadratic terms of the map add up bounce by bounce instead of averaging out. The mirror symmetry of the rod forbids \
          them as long as there is no drift, and then the same release survives two hundred times as wide. A sideways speed, \
          which leaves every eigenvalue as it is, breaks the symmetry: the stable loops shrink to a triangle and at the resonance \
          to nothing, so that every start falls, in a time that grows only as one over its size.",
    impacts: 2_000,
    ask: ("trajectories", "bounces=2000"),
    price: 14_000,
    // κ = 1 + 3/4 Gρ²/(V²l).
    scene: || built(rod(&[(Name::TiltGain, 1.375), (Name::Theta, 0.001), (Name::XDot, 0.4)])),
    find: |scene, impacts| {
        let run = |numbers: &[(Name, f64)]| AngleHistory::of(&built(with(scene.draft(), numbers)), impacts);
        let says = vec![
            residue(scene),
            run(&[(Name::XDot, 0.0)]).says("run without the drift"),
            run(&[(Name::XDot, 0.0), (Name::Theta, 0.2)]).says("run without the drift from 0.2 rad"),
            AngleHistory::of(scene, impacts).says("run of the scene"),
        ];
        let halved = run(&[(Name::Theta, 0.5 * scene.start().theta)]).says("").detail;
        let beside = run(&[(Name::TiltGain, OFF_RESONANCE)]).says("").detail;
        let detail = format!(
            "the run: {}. From half the angle: {halved}. From the same angle at tilt gain {OFF_RESONANCE}: {beside}",
            says[3].detail
        );
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, _| {
        let side = |kappa: f64, starts: &[f64], style: CurveStyle, label: &'static str| {
            let curves = starts.iter().enumerate().map(|(n, theta)| {
                let scene = built(with(scene.draft(), &[(Name::TiltGain, kappa), (Name::Theta, *theta)]));
                plane(if n == 0 { label } else { "" }, style, &scene, 800)
            });
            curves.collect::<Vec<_>>()
        };
        let axes = |curves| Plot { x: THETA.between(-0.06, 0.06), y: SPIN.between(-0.4, 0.4), curves };
        let mut off =
            side(OFF_RESONANCE, &[0.003, 0.006, 0.009, 0.012, 0.015], CurveStyle::BesideDots, "runs that survive");
        off.extend(side(OFF_RESONANCE, &[0.018], CurveStyle::TruthDots, ""));
        let kappa = scene.number(Name::TiltGain).unwrap_or_default();
        Chart {
            title: RESONANCE.title,
            subtitle: format!(
                "states just before the contacts, drifting at {} m/s, at tilt gain {kappa} (left) and {OFF_RESONANCE} (right)",
                scene.start().x_dot
            ),
            caption: "Left, at the resonance: every start leaves along three arms. Right, beside it: loops within a triangle \
                      survive, and a start outside of it leaves."
                .to_owned(),
            plots: vec![axes(side(kappa, &[0.001, 0.0015, 0.002, 0.003, 0.005], CurveStyle::TruthDots, "runs that fall")), axes(off)],
        }
    },
};

/// A tilt gain beside the resonance, at which small drifting loops survive.
const OFF_RESONANCE: f64 = 1.385;

const THETA: ChartAxis = ChartAxis::new("angle", "θ", "rad");
const SPIN: ChartAxis = ChartAxis::new("angular velocity", "θ̇", "rad/s");

/// Time, θ and θ̇ at the contacts of a run.
fn states(scene: &Scene, impacts: u64) -> Vec<(f64, f64, f64)> {
    let mut states = Vec::new();
    if let Ok(mut orbit) = scene.orbit() {
        run(&mut orbit, impacts, |contact| {
            states.push((contact.t, contact.state.theta, contact.state.theta_dot));
            true
        });
    }
    states
}

fn plane(label: &'static str, style: CurveStyle, scene: &Scene, impacts: u64) -> Curve {
    let points = states(scene, impacts).iter().map(|(_, theta, theta_dot)| (*theta, *theta_dot)).collect();
    Curve { label, style, points }
}

pub(super) fn residue(scene: &Scene) -> MethodClaim {
    let linear = small_deviations(scene).expect("a test builds every case").linear;
    let verdict = if linear.says_bounded() { "bounded" } else { "falls" };
    let detail = format!(
        "κ = {} is between {} and {:.6}, so small deviations circle",
        scene.number(Name::TiltGain).unwrap_or_default(),
        linear.lower_tilt_gain,
        linear.critical_tilt_gain
    );
    MethodClaim { method: "residue", verdict, value: linear.residue, unit: None, detail }
}
