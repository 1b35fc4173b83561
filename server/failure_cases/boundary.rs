//! At κ_c and beyond it, where the eigenvalues are silent or cry wolf, and the next order of the normal form decides.

use crate::charts::{Chart, Curve, CurveStyle, Plot, significant};
use crate::failure_cases::angle_history::{ANGLE, AngleHistory, CONTACT};
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::eigenvalue::{eigenvalue, upright};
use crate::failure_cases::scenes::{built, rod, with};
use equipoise_physics::analysis::boundary::{boundary_coefficient, period_two_angle};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::scene::{Name, Scene};

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
    scene: || built(rod(&[(Name::TiltGain, 1.5), (Name::Theta, 1e-4)])),
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let steeper = built(with(scene.draft(), &[(Name::TiltGain, 1.5_f64.next_up())]));
        let linear = AngleHistory::linear(scene, &fixed_point, impacts);
        let mut says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            eigenvalue("the same with tilt_gain one unit in its last place more", &steeper, &fixed_point),
            linear.says("linear map, iterated"),
        ];
        let detail = decided(scene, &fixed_point, impacts, &mut says);
        Findings { truth: "bounded", detail, says }
    },
    picture: |scene, impacts| outlines(SOFT.title, scene, impacts, "what the linear map says"),
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
    scene: || {
        let rho = 0.051_370_116_691_408_14;
        built(rod(&[(Name::RadiusOfGyration, rho), (Name::TiltGain, 1.148_437_5), (Name::Theta, 1e-4)]))
    },
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let mut says = vec![eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point)];
        let detail = decided(scene, &fixed_point, impacts, &mut says);
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| outlines(HARD.title, scene, impacts, "what the linear map says"),
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
    scene: || {
        let loop_numbers = [(Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)];
        let numbers = [(Name::Incline, std::f64::consts::FRAC_PI_4), (Name::Restitution, 0.5), (Name::Theta, 1e-4)];
        // κ_c = 1 + ρ²/(2l(y* − l)) = 9/7.
        built(with(with(rod(&numbers), &loop_numbers), &[(Name::TiltGain, 9.0 / 7.0)]))
    },
    find: |scene, impacts| {
        let fixed_point = upright(scene);
        let without = built(with(scene.draft(), &[(Name::EnergyGain, 0.0)]));
        let mut says = vec![
            eigenvalue("spectral radius of the computed Jacobian", scene, &fixed_point),
            coefficient("boundary coefficient of the rod without feedback", &without, &fixed_point),
        ];
        let detail = decided(scene, &fixed_point, impacts, &mut says);
        Findings { truth: "falls", detail, says }
    },
    picture: |scene, impacts| outlines(HARD_WITH_FEEDBACK.title, scene, impacts, "what the linear map says"),
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
    scene: || built(rod(&[(Name::TiltGain, 1.51), (Name::Theta, 1e-3)])),
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
    picture: |scene, impacts| outlines(BEYOND.title, scene, impacts, "what the linear map says"),
};

fn coefficient(method: &'static str, scene: &Scene, fixed_point: &FixedPoint) -> MethodClaim {
    let value = boundary_coefficient(&scene.model(), fixed_point).map(|boundary| boundary.coefficient);
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

fn outlines(title: &'static str, scene: &Scene, impacts: u64, label: &'static str) -> Chart {
    let course = AngleHistory::of(scene, impacts);
    let fixed_point = upright(scene);
    let mut linear = AngleHistory::linear(scene, &fixed_point, impacts);
    linear.angles.truncate(4 * course.angles.len());
    let limit = scene.rules().topple_angle;
    let length = course.angles.len().max(linear.angles.len()) as f64;
    let end = Curve { label: "topple angle", style: CurveStyle::Limit, points: vec![(1.0, limit), (length, limit)] };
    let run = course.says("");
    Chart {
        title,
        subtitle: format!(
            "the largest angles of a run from {} rad at tilt gain {}",
            significant(scene.start().theta, 4),
            significant(scene.number(Name::TiltGain).unwrap_or_default(), 6)
        ),
        caption: format!("The run: {}.", run.detail),
        plots: vec![Plot {
            x: CONTACT,
            y: ANGLE,
            curves: vec![end, linear.outline(label, CurveStyle::Wrong), course.outline("the run", CurveStyle::Truth)],
        }],
    }
}
