//! Cases in which eigenvalues or single runs mislead: at κ_c and beyond it, where they are silent or cry wolf, and the next order of the normal
//! form decides; small neighbourhoods; bounces that end while the body swings; chaos beyond its horizon.

use equipoise_physics::analysis::boundary::{boundary_coefficient, period_two_angle};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::regularity::{TOLERANCE, measure_regularity};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::body::{Body, Release};
use equipoise_physics::map::strike::State;
use equipoise_physics::run::lanes::batch_run::run_all;
use equipoise_physics::run::lasting_contact::{ContactStart, Hold, HoldLaw, HoldRequest, HoldSample, hold};
use equipoise_physics::run::orbit::{Contact, Orbit};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::Value::Number;
use equipoise_physics::scene::{Name, Scene};

use crate::charts::{ChartAxis, Curve, CurveStyle, Plot, significant};
use crate::failure_cases::case::{
    ANGLE, AngleHistory, BOUNCE, CONTACT, CONTACT_ANGLE, CasePicture, FailureCase, Findings, MethodClaim, STILL, TIME,
    TRUE_RHO, at_contacts, changed, claim, eigenvalue, rod_of, upright,
};

/// The paper's rod exactly at κ_c: soft.
pub(crate) const SOFT: FailureCase = FailureCase {
    name: "double-eigenvalue-soft",
    title: "A double eigenvalue at κ_c, and nothing falls",
    method: "spectral radius of a computed Jacobian",
    why: "At κ_c both angle eigenvalues are −1 with a single Jordan block. Such a pair is the worst case of numerical linear \
          algebra: rounding by ε moves it by the square root of ε, so a computed modulus says stable, neutral or unstable by \
          the last bit of κ. Without rounding it is no better: |λ| = 1 decides nothing, and the linear map with its Jordan block \
          grows without bound. What decides is the next order: the boundary coefficient C is positive here, so the angle is \
          caught by the curvature of the map and stays small for ever as far as anyone has looked.",
    impacts: 20_000,
    ask: ("stability", "bounces=20000"),
    price: 45_000,
    scene: &[(Name::TiltGain, Number(1.5)), (Name::Theta, Number(1e-4))],
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let steeper = changed(scene, &[(Name::TiltGain, 1.5_f64.next_up())]);
        let linear = AngleHistory::linear(scene, &fixed_point, impacts);
        let mut says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            eigenvalue("the same with tilt_gain one unit in its last place more", &steeper, &fixed_point),
            linear.says("linear map, iterated"),
        ];
        let detail = decided(scene, &fixed_point, impacts, &mut says);
        Findings { truth: "bounded", detail, says }
    },
    picture: outlines,
};

/// The true triangle exactly at its κ_c: hard.
pub(crate) const HARD: FailureCase = FailureCase {
    name: "double-eigenvalue-hard",
    title: "A double eigenvalue at κ_c, and it falls",
    method: "spectral radius of a computed Jacobian",
    why: "The same eigenvalues as in the soft case, −1 twice, and the opposite fate. This is the triangle of the paper with the \
          radius of gyration that it really has. The boundary coefficient C is negative: beyond the linear terms the map \
          pushes outwards, so a start of 0.0001 rad falls within a thousand bounces. No property of the Jacobian, however \
          exactly computed, tells these two cases apart.",
    impacts: 2_000,
    ask: ("stability", "bounces=2000"),
    price: 4_000,
    // ρ² = b²/24 + h²/18 with b = 0.1 m, h = 0.2 m; κ_c = 1 + Gρ²/(V²l) = 1.1484375 in all its digits.
    scene: &[TRUE_RHO, (Name::TiltGain, Number(1.148_437_5)), (Name::Theta, Number(1e-4))],
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let mut says = vec![eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point)];
        let detail = decided(scene, &fixed_point, impacts, &mut says);
        Findings { truth: "falls", detail, says }
    },
    picture: outlines,
};

/// The paper's fourth case at κ_c: feedback of the energy makes the boundary hard.
pub(crate) const HARD_WITH_FEEDBACK: FailureCase = FailureCase {
    name: "hard-by-feedback",
    title: "Feedback of the energy turns a soft boundary hard",
    method: "boundary coefficient of the rod without feedback",
    why: "The rod is that of the soft case. But the table also steers the height, and a controller that holds the energy of the \
          vertical bounce lets swings feed on it: it refills what the angle takes. The linear verdict does not see it, since the \
          energy is an eigenvalue of its own, well inside the circle. The coefficient that holds with feedback is negative for \
          every rod.",
    impacts: 2_000,
    ask: ("stability", "bounces=2000"),
    price: 4_000,
    // κ_c = 1 + ρ²/(2l(y* − l)) = 9/7.
    scene: &[
        (Name::Incline, Number(std::f64::consts::FRAC_PI_4)),
        (Name::Restitution, Number(0.5)),
        (Name::Theta, Number(1e-4)),
        (Name::EnergyGain, Number(0.165)),
        (Name::TargetHeight, Number(0.25)),
        (Name::TiltGain, Number(9.0 / 7.0)),
    ],
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let without = changed(scene, &[(Name::EnergyGain, 0.0)]);
        let mut says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            coefficient("boundary coefficient of the rod without feedback", &without, &fixed_point),
        ];
        let detail = decided(scene, &fixed_point, impacts, &mut says);
        Findings { truth: "falls", detail, says }
    },
    picture: outlines,
};

/// The paper's rod a little beyond κ_c.
pub(crate) const BEYOND: FailureCase = FailureCase {
    name: "beyond-critical",
    title: "An eigenvalue beyond the circle, and it stays up",
    method: "spectral radius of the Jacobian",
    why: "Just beyond κ_c the upright bounce is truly unstable: |λ| = 1.33, and a deviation grows a thousandfold in 25 bounces. \
          The linear analysis ends there and says that the rod falls. But with C > 0 a pair of mirror-symmetric orbits of \
          period 2 has branched off and catches it: the run leaves upright, swings from side to side, and comes no nearer \
          to falling.",
    impacts: 20_000,
    ask: ("stability", "bounces=20000"),
    price: 45_000,
    scene: &[(Name::TiltGain, Number(1.51)), (Name::Theta, Number(1e-3))],
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let mut says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            AngleHistory::linear(scene, &fixed_point, impacts).says("linear map, iterated"),
        ];
        let mut detail = decided(scene, &fixed_point, impacts, &mut says);
        if let Some(theta) = period_two_angle(&scene.model(), scene.rules().topple_angle, &fixed_point) {
            detail += &format!("; the orbit of period 2 that holds it has an angle of {theta:.4} rad");
        }
        Findings { truth: "bounded", detail, says }
    },
    picture: outlines,
};

fn coefficient(method: &'static str, scene: &Scene, fixed_point: &FixedPoint) -> MethodClaim {
    let value = boundary_coefficient(&scene.model(), fixed_point);
    let verdict = if value.is_some_and(|value| value > 0.0) { "bounded" } else { "falls" };
    let detail = "the sign of C in κ − κ_c ≈ a C θ², on which the orbits of period 2 branch off at κ_c".to_owned();
    MethodClaim { method, verdict, value, unit: None, detail }
}

/// The methods that are right: the boundary coefficient and the run. How the truth is known.
fn decided(scene: &Scene, fixed_point: &FixedPoint, impacts: u64, says: &mut Vec<MethodClaim>) -> String {
    let course = AngleHistory::of(scene, impacts);
    let coefficient = coefficient("boundary coefficient", scene, fixed_point);
    let value = coefficient.value.unwrap_or_default();
    let run = course.says("run of the scene");
    let detail = format!("C = {value:.4}; the run: {}", run.detail);
    says.extend([coefficient, run]);
    detail
}

fn outlines(scene: &Scene, impacts: u64) -> CasePicture {
    let course = AngleHistory::of(scene, impacts);
    let fixed_point = upright(scene);
    let mut linear = AngleHistory::linear(scene, &fixed_point, impacts);
    linear.angles.truncate(4 * course.angles.len());
    let limit = scene.rules().topple_angle;
    let length = course.angles.len().max(linear.angles.len()) as f64;
    let end = Curve::new("topple angle", CurveStyle::Limit, vec![(1.0, limit), (length, limit)]);
    let run = course.says("");
    CasePicture {
        subtitle: format!(
            "the largest angles of a run from {} rad at tilt gain {}",
            significant(scene.start().theta, 4),
            significant(scene.number(Name::TiltGain).unwrap_or_default(), 6)
        ),
        caption: format!("The run: {}.", run.detail),
        plots: vec![Plot::new(CONTACT, ANGLE).with(vec![
            end,
            linear.outline("what the linear map says", CurveStyle::Wrong),
            course.outline("the run", CurveStyle::Truth),
        ])],
    }
}

// Cases in which the linear analysis holds only in a small neighbourhood: a drift of the angle, a wide start, and a resonance.

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
    scene: &[(Name::TiltGain, Number(1.0)), (Name::ThetaDot, Number(0.01))],
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let course = AngleHistory::of(scene, impacts);
        let says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            course.says("run of the scene"),
        ];
        let spin = scene.start().theta_dot;
        let off = angles(scene, impacts).iter().map(|(t, theta)| (theta - spin * t).abs()).fold(0.0, f64::max);
        let detail = format!(
            "the angle is {spin} rad/s times the time, within {off:.1e} rad at every contact; the run: {}",
            says[1].detail
        );
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| {
        let balanced = changed(scene, &[(Name::TiltGain, 1.02)]);
        CasePicture {
            subtitle: format!(
                "the angle at the contacts, released upright with a spin of {} rad/s",
                scene.start().theta_dot
            ),
            caption: format!(
                "The run: {}. At a tilt gain of 1.02 the same release circles about upright.",
                AngleHistory::of(scene, impacts).says("").detail
            ),
            plots: vec![Plot::new(TIME, CONTACT_ANGLE).with(vec![
                Curve::new("tilt gain 1.02", CurveStyle::BesideDots, angles(&balanced, impacts)),
                Curve::new("the run", CurveStyle::Truth, angles(scene, impacts)),
                Curve::new("", CurveStyle::TruthDots, angles(scene, impacts)),
            ])],
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
    scene: &[(Name::TiltGain, Number(1.3)), (Name::Theta, Number(0.3))],
    find: |scene, impacts| {
        let narrow = changed(scene, &[(Name::Theta, 0.1)]);
        let says = vec![
            residue(scene),
            AngleHistory::of(&narrow, impacts).says("run from 0.1 rad"),
            AngleHistory::of(scene, impacts).says("run of the scene"),
        ];
        Findings { truth: "falls", detail: format!("the run: {}", says[2].detail), says }
    },
    picture: |scene, _| {
        let narrow = |theta: f64| changed(scene, &[(Name::Theta, theta)]);
        let mut curves: Vec<Curve> = [0.05, 0.1, 0.15, 0.2]
            .iter()
            .map(|theta| plane("", CurveStyle::BesideDots, &narrow(*theta), 400))
            .collect();
        curves[0].label = "runs from 0.05 to 0.2 rad";
        curves.push(plane("the run from 0.3 rad", CurveStyle::Truth, scene, 400));
        curves.push(plane("", CurveStyle::TruthDots, scene, 400));
        CasePicture {
            subtitle: "states just before the contacts; the linear analysis is that of the smallest loop".to_owned(),
            caption: format!("The run: {}.", AngleHistory::of(scene, 400).says("").detail),
            plots: vec![Plot::new(THETA, SPIN).with(curves)],
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
    scene: &[(Name::TiltGain, Number(1.375)), (Name::Theta, Number(0.001)), (Name::XDot, Number(0.4))],
    find: |scene, impacts| {
        let run = |numbers: &[(Name, f64)]| AngleHistory::of(&changed(scene, numbers), impacts);
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
                let scene = changed(scene, &[(Name::TiltGain, kappa), (Name::Theta, *theta)]);
                plane(if n == 0 { label } else { "" }, style, &scene, 800)
            });
            curves.collect::<Vec<_>>()
        };
        let axes = |curves| Plot::new(THETA.between(-0.06, 0.06), SPIN.between(-0.4, 0.4)).with(curves);
        let mut off =
            side(OFF_RESONANCE, &[0.003, 0.006, 0.009, 0.012, 0.015], CurveStyle::BesideDots, "runs that survive");
        off.extend(side(OFF_RESONANCE, &[0.018], CurveStyle::TruthDots, ""));
        let kappa = scene.number(Name::TiltGain).unwrap_or_default();
        CasePicture {
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

/// Time and θ at the contacts of a run.
fn angles(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    at_contacts(scene, impacts, |contact| (contact.t, contact.state.theta))
}

fn plane(label: &'static str, style: CurveStyle, scene: &Scene, impacts: u64) -> Curve {
    Curve::new(label, style, at_contacts(scene, impacts, |contact| (contact.state.theta, contact.state.theta_dot)))
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

// Bounces that end while the body does not come to rest: α = κθ takes nothing from the swing.

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
    scene: &[
        STILL,
        (Name::TiltGain, Number(1.1)),
        (Name::Restitution, Number(0.5)),
        (Name::Theta, Number(0.1)),
        (Name::Height, Number(0.25)),
    ],
    find: |scene, impacts| {
        let (end, course) = (last_contact(scene, impacts), AngleHistory::of(scene, impacts));
        let settle_time = course.settle_time();
        let swing = swing(scene, end);
        let late = largest(&swing.samples[swing.samples.len() / 2..]);
        let spin = end.theta_dot;
        let says = vec![
            claim(
                "bounces that die out",
                if settle_time.is_some() { "at rest" } else { "swings" },
                settle_time,
                Some("s"),
                format!("the run ends as `settled` after {} contacts", course.angles.len()),
            ),
            claim(
                "velocities at the end of the bounces",
                if spin.abs() < 1e-3 { "at rest" } else { "swings" },
                Some(spin),
                Some("rad/s"),
                format!("the body moves along x at {:.1e} m/s, and the contact does not move", end.x_dot),
            ),
            claim(
                "forces at the end of the bounces",
                if end.theta.abs() > 1e-3 { "swings" } else { "at rest" },
                Some(end.theta),
                Some("rad"),
                format!(
                    "the table stands at {:.4} rad, so the rod is out of balance",
                    rod_of(scene).tilt_gain * end.theta
                ),
            ),
            claim(
                "motion in contact",
                if late > 0.5 * end.theta.abs() { "swings" } else { "at rest" },
                Some(late),
                Some("rad"),
                format!("the largest angle from {:.0} s to {:.0} s", 0.5 * SWING_TIME, SWING_TIME),
            ),
        ];
        let detail = format!(
            "the swing begins at {:.5} rad; after {:.0} s in contact it still reaches {late:.5} rad",
            end.theta, SWING_TIME
        );
        Findings { truth: "swings", detail, says }
    },
    picture: |scene, impacts| {
        let end = last_contact(scene, impacts);
        let swing = swing(scene, end);
        let settled = end.t;
        let shown = settled + 5.0;
        let contact =
            swing.samples.iter().map(|sample| (sample.t, sample.theta)).filter(|(t, _)| *t <= shown).collect();
        CasePicture {
            subtitle: "the angle at the contacts, and then in contact".to_owned(),
            caption: format!(
                "The bounces end at {settled:.3} s, at {:.4} rad. In contact the rod swings as far to the other side.",
                end.theta
            ),
            plots: vec![Plot::new(TIME, THETA).with(vec![
                Curve::new("end of the bounces", CurveStyle::Limit, vec![(settled, -0.15), (settled, 0.15)]),
                Curve::new("at rest", CurveStyle::Wrong, vec![(settled, end.theta), (shown, end.theta)]),
                Curve::new("bounces", CurveStyle::TruthDots, angles(scene, impacts)),
                Curve::new("in contact", CurveStyle::Truth, contact),
            ])],
        }
    },
};

/// Time in contact that is followed, s.
const SWING_TIME: f64 = 30.0;

/// The last contact of a run that settles.
fn last_contact(scene: &Scene, impacts: u64) -> ContactStart {
    let start = |contact: &Contact| {
        let State { theta, x_dot, theta_dot, .. } = contact.state;
        ContactStart { t: contact.t, x: contact.x, theta, x_dot, theta_dot, table_speed: 0.0, before: None }
    };
    at_contacts(scene, impacts, start).pop().expect("a test computes every case")
}

/// The motion in contact after the bounces, by the law of the scene.
fn swing(scene: &Scene, end: ContactStart) -> Hold {
    let rod = rod_of(scene);
    let law = HoldLaw::tilt_gain(rod.tilt_gain);
    let request = HoldRequest::new(&Body::plain(rod), &scene.rules(), law, end, SWING_TIME);
    hold(&request, &mut || true)
}

fn largest(samples: &[HoldSample]) -> f64 {
    samples.iter().map(|sample| sample.theta.abs()).fold(0.0, f64::max)
}

// A chaotic run beyond its horizon: what single runs say there, and what many of them say together.

/// Runs of one ensemble, and how far apart their starts are, rad.
const RUNS: usize = 256;
const SPACING: f64 = 1e-13;

/// The paper's rod beyond κ_c, where runs about the orbits of period 2 are chaotic.
pub(crate) const CHAOS: FailureCase = FailureCase {
    name: "chaos",
    title: "A single run beyond its horizon",
    method: "one simulation, however accurate",
    why: "Neighbouring runs part by a constant factor a bounce here, so that a difference in the last digit of a double has grown \
          to the size of the motion after some hundred and fifty contacts. Beyond that horizon every computed run is a run of \
          the rod, but not of this start: another compiler, another order of the same sums or 1e-15 rad at release give another \
          end. No smaller step and no higher order moves the horizon by more than a few bounces for each digit. What stays is the \
          distribution, and an ensemble measures it.",
    impacts: 3_000,
    ask: ("stability", "bounces=3000"),
    price: 2 * RUNS as u64 * 3_000 / 6 + 15_000,
    scene: &[(Name::TiltGain, Number(1.54)), (Name::Theta, Number(0.032))],
    find: |scene, impacts| {
        let runs = [AngleHistory::of(scene, impacts), aside(scene, impacts), uncorrected(scene, impacts)];
        let [one, other, third] = runs.each_ref().map(|course| course.angles.len());
        let differ = |end: usize| if end == one { "predictable" } else { "unpredictable" };
        let horizon = horizon(scene);
        let ends = |numbers| ends(scene, impacts, numbers);
        let medians = [median(&ends(0..RUNS)), median(&ends(RUNS..2 * RUNS))];
        let contact =
            |method, verdict, value: usize, detail| claim(method, verdict, Some(value as f64), Some("contact"), detail);
        let says = vec![
            contact("one run", "predictable", one, format!("{}; how sure that is, it does not say", ending(&runs[0]))),
            contact("a run from 1e-15 rad aside", differ(other), other, ending(&runs[1])),
            contact(
                "the same start without correction of the energy's rounding",
                differ(third),
                third,
                ending(&runs[2]),
            ),
            claim(
                "growth of the Jacobian product",
                if horizon.is_some() { "unpredictable" } else { "predictable" },
                horizon.map(|horizon| horizon as f64),
                Some("contact"),
                format!("from there on rounding has grown to {TOLERANCE} of the contact speed"),
            ),
            contact(
                "ensemble",
                "unpredictable",
                medians[0],
                format!(
                    "half of {RUNS} runs from starts {SPACING:.0e} rad apart have ended by contact {}; of {RUNS} others, by contact {}",
                    medians[0], medians[1]
                ),
            ),
        ];
        let apart = runs[0].angles.iter().zip(&runs[1].angles).position(|(a, b)| (a - b).abs() > TOLERANCE);
        let detail = format!(
            "runs from 1e-15 rad aside of each other are {TOLERANCE} rad apart at contact {}, and end at contacts {one} and {other}",
            apart.map_or(one, |index| index + 1)
        );
        Findings { truth: "unpredictable", detail, says }
    },
    picture: |scene, impacts| {
        let [one, other] = [AngleHistory::of(scene, impacts), aside(scene, impacts)];
        let apart = one.angles.iter().zip(&other.angles).enumerate();
        let apart = apart.map(|(index, (a, b))| (index as f64 + 1.0, (a - b).abs())).collect();
        let horizon = horizon(scene).unwrap_or_default() as f64;
        let upright = |x: f64, y: f64| vec![(x, 0.0), (x, y)];
        CasePicture {
            subtitle: "two runs whose starts differ by 1e-15 rad (left), and ensembles of such runs (right)".to_owned(),
            caption: format!(
                "Left: their difference reaches the size of the motion at the horizon, contact {horizon}. Right: the two runs end at \
                 contacts {} and {}; two ensembles of {RUNS} runs, {SPACING:.0e} rad apart, agree.",
                one.angles.len(),
                other.angles.len()
            ),
            plots: vec![
                Plot::new(
                    BOUNCE,
                    ChartAxis::new("difference of the angles", "|Δθ|", "rad").logarithmic().between(1e-18, 1.0),
                )
                .with(vec![
                    Curve::new("horizon", CurveStyle::Limit, vec![(horizon, 1e-18), (horizon, 1.0)]),
                    Curve::new("", CurveStyle::TruthDots, apart),
                ]),
                Plot::new(
                    BOUNCE.between(0.0, impacts as f64),
                    ChartAxis::new("share of runs still up", "", "").between(0.0, 1.0),
                )
                .with(vec![
                    Curve::new("", CurveStyle::Limit, upright(horizon, 1.0)),
                    Curve::new("single runs", CurveStyle::Wrong, upright(one.angles.len() as f64, 1.0)),
                    Curve::new("", CurveStyle::Wrong, upright(other.angles.len() as f64, 1.0)),
                    Curve::new("one ensemble", CurveStyle::Truth, survival(&ends(scene, impacts, 0..RUNS), impacts)),
                    Curve::new("another", CurveStyle::Beside, survival(&ends(scene, impacts, RUNS..2 * RUNS), impacts)),
                ]),
            ],
        }
    },
};

fn aside(scene: &Scene, impacts: u64) -> AngleHistory {
    AngleHistory::of(&changed(scene, &[(Name::Theta, scene.start().theta + 1e-15)]), impacts)
}

/// The map with its rounding errors as they come.
fn uncorrected(scene: &Scene, impacts: u64) -> AngleHistory {
    let rules = Rules { holds_energy: false, ..scene.rules() };
    AngleHistory::of_orbit(Orbit::new(scene.model(), rules, scene.release()).ok(), impacts)
}

fn ending(course: &AngleHistory) -> String {
    format!("ends as `{}` at contact {}", course.ending.name(), course.angles.len())
}

fn horizon(scene: &Scene) -> Option<u64> {
    let small = small_deviations(scene).ok()?;
    measure_regularity(scene.orbit().ok()?, &small, u64::MAX)?.predictable_impacts(TOLERANCE)
}

/// At which contacts the runs of an ensemble end, upwards: those whose starts have these numbers.
fn ends(scene: &Scene, impacts: u64, numbers: std::ops::Range<usize>) -> Vec<u64> {
    let mut orbits = numbers.filter_map(|number| {
        let mut release: Release = *scene.release();
        // The scene's own start is not one of them.
        release.state.theta += SPACING * (number as f64 + 1.0);
        Some((number, Orbit::new(scene.model(), scene.rules(), &release).ok()?))
    });
    let mut ends = Vec::new();
    run_all(impacts, &mut || orbits.next(), &mut |_, end| ends.push(end.impacts), &mut || true);
    ends.sort_unstable();
    ends
}

fn median(ends: &[u64]) -> usize {
    ends.get(ends.len() / 2).map_or(0, |end| *end as usize)
}

/// The share of the runs that are up, in steps; those that survived have no end.
fn survival(ends: &[u64], impacts: u64) -> Vec<(f64, f64)> {
    let share = |ended: usize| 1.0 - ended as f64 / ends.len() as f64;
    let fallen = ends.iter().filter(|end| **end < impacts).enumerate();
    let steps = fallen.flat_map(|(n, end)| [(*end as f64, share(n)), (*end as f64, share(n + 1))]);
    std::iter::once((0.0, 1.0)).chain(steps).collect()
}
