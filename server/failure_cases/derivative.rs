//! Derivatives of the map by differences: the step that is neither too long nor too short, and the graze that has none.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, with};
use equipoise_physics::analysis::jacobian::jacobian;
use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene};
use nalgebra::DMatrix;

/// A derivative over a long time.
pub(crate) const DIFFERENCES: FailureCase = FailureCase {
    name: "finite-differences",
    title: "No step is right for finite differences",
    method: "central finite differences",
    why: "A difference quotient is wrong by the curvature of the map where its step is long, and by rounding over the step where it \
          is short. Over a hundred bounces both have grown: the best of all steps leaves half of the digits, nobody knows \
          beforehand which step that is, and the usual 1e-6 leaves four. The determinant shows it without a reference, since \
          that of the true derivative is known exactly: it is the ratio of the contact speeds after and before, flight by \
          flight. Differentiating the formulas themselves, contact time included, has no step at all.",
    impacts: 100,
    ask: ("jacobians", "at.impact=1&period=100"),
    price: 40_000,
    scene: || built(rod(&[(Name::TiltGain, 1.1), (Name::Theta, 0.3)])),
    find: |scene, impacts| {
        let (state, exact, determinant) = reference(scene, impacts);
        let off = |matrix: &DMatrix<f64>| (matrix.determinant() / determinant - 1.0).abs();
        let verdict = |error: f64| if error < EXACT { "exact but for rounding" } else { "digits lost" };
        let difference = |method, step: f64| {
            let matrix = differences(scene, &state, impacts, step);
            let error = matrix.as_ref().map(|matrix| distance(matrix, &exact));
            let detail = match &matrix {
                Some(matrix) => format!("step {step:.0e}; its determinant is off by {:.1e}", off(matrix)),
                None => format!("step {step:.0e}; a run that starts so far aside ends before"),
            };
            MethodClaim { method, verdict: verdict(error.unwrap_or(1.0)), value: error, unit: None, detail }
        };
        let best = curve(scene, impacts).into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(1e-8, |best| best.0);
        let says = vec![
            difference("central differences, usual step", 1e-6),
            difference("central differences, long step", 1e-4),
            difference("central differences, short step", 1e-12),
            difference("central differences, the best of all steps", best),
            MethodClaim {
                method: "derivative of the formulas",
                verdict: verdict(off(&exact)),
                value: Some(off(&exact)),
                unit: None,
                detail: format!("its determinant is {} and has to be {determinant}", exact.determinant()),
            },
        ];
        let detail = format!(
            "errors are of the matrix over {impacts} contacts, as a share of its largest entry; det Df is the product of −ẏ_c⁺/ẏ_c⁻ \
             along the run, {determinant}, which the derivative of the formulas meets within {:.1e}",
            off(&exact)
        );
        Findings { truth: "exact but for rounding", detail, says }
    },
    picture: |scene, impacts| {
        let (_, exact, determinant) = reference(scene, impacts);
        let level = (exact.determinant() / determinant - 1.0).abs();
        let curve = |label, style, points| Curve { label, style, points };
        Chart {
            title: DIFFERENCES.title,
            subtitle: format!("error of the derivative over one contact and over {impacts}, against the step"),
            caption: "Errors are shares of the largest entry, measured against the derivative of the formulas, whose own error is \
                      that of its determinant. Steps are in m/s (m for ρθ)."
                .to_owned(),
            plots: vec![Plot {
                x: ChartAxis::new("step of the differences", "h", "").logarithmic(),
                y: ChartAxis::new("relative error", "", "").logarithmic().between(1e-16, 10.0),
                curves: vec![
                    curve("differences over 1 contact", CurveStyle::Second, self::curve(scene, 1)),
                    curve("over 100 contacts", CurveStyle::Wrong, self::curve(scene, impacts)),
                    curve("derivative of the formulas", CurveStyle::Truth, vec![(STEPS[0], level), (0.1, level)]),
                ],
            }],
        }
    },
};

/// A contact that is hardly one.
pub(crate) const GRAZE: FailureCase = FailureCase {
    name: "grazing",
    title: "A derivative without bound at a graze",
    method: "central finite differences",
    why: "After its first strike the rod turns through upright and its tip just touches the table: the contact speed ẏ_c is nearly 0. \
          The contact time follows the gap by −1/ẏ_c, so the derivative of the map grows without bound towards the graze, and \
          beyond it the contact is missed and the flight jumps to the next one. A difference quotient reaches \
          across the jump and reports the jump over its step: a number that settles, and looks like an answer. The contact speed \
          beside a derivative says how far it can be trusted.",
    impacts: 2,
    ask: ("jacobians", "at.impact=1"),
    price: 2_000,
    scene: || {
        built(rod(&[
            (Name::TiltGain, 1.1),
            (Name::Theta, -1.8),
            (Name::ThetaDot, 6.0),
            (Name::Height, 0.325_747_320_128_15),
        ]))
    },
    find: |scene, _| {
        let edge = edge(scene);
        // At the scene, and a hundred times nearer in contact speed.
        let near = at_height(scene, edge - 1e-4 * (edge - scene.release().height));
        let speeds = [scene, &near].map(|scene| flight(scene).1);
        let largest = |scene: &Scene, step: f64| {
            let (state, exact, _) = reference(scene, 1);
            if step == 0.0 {
                exact.amax()
            } else {
                differences(scene, &state, 1, step).map_or(0.0, |matrix| matrix.amax())
            }
        };
        let says = |method, step: f64| {
            let [here, there] = [largest(scene, step), largest(&near, step)];
            // Against the law: inverse to the contact speed.
            let verdict = match there / here {
                growth if growth < 2.0 => "settles",
                growth if (growth * speeds[1] / speeds[0] - 1.0).abs() < 0.1 => "grows without bound",
                _ => "jumps",
            };
            let detail =
                format!("the largest entry is {here:.3e} here and {there:.3e} a hundred times nearer to the graze");
            MethodClaim { method, verdict, value: Some(here), unit: None, detail }
        };
        let [misses, touches] = [edge + 1e-9, edge - 1e-9].map(|height| flight(&at_height(scene, height)).0);
        let detail = format!(
            "contact speeds {:.3e} and {:.3e} m/s; released from 1 nm below {edge:.9} m the rod touches after a flight of {touches:.5} s, \
             from 1 nm above it after one of {misses:.5} s",
            speeds[0], speeds[1]
        );
        let says = vec![
            says("central differences, usual step 1e-6", 1e-6),
            says("central differences, step 1e-8", 1e-8),
            says("derivative of the formulas", 0.0),
        ];
        Findings { truth: "grows without bound", detail, says }
    },
    picture: |scene, _| {
        let edge = edge(scene);
        let family: Vec<Scene> =
            (0..32).map(|n| at_height(scene, edge - 1e-4 * libm::pow(10.0, -0.25 * f64::from(n)))).collect();
        let curve = |label, style, step: f64| {
            let points = family.iter().map(|scene| {
                let (state, exact, _) = reference(scene, 1);
                let matrix = if step == 0.0 { Some(exact) } else { differences(scene, &state, 1, step) };
                (-flight(scene).1, matrix.map_or(f64::NAN, |matrix| matrix.amax()))
            });
            Curve { label, style, points: points.collect() }
        };
        Chart {
            title: GRAZE.title,
            subtitle: "the largest entry of the derivative, towards the graze (left)".to_owned(),
            caption: "Each point is a release a little lower than the one from which the contact is missed.".to_owned(),
            plots: vec![Plot {
                x: ChartAxis::new("contact speed", "|ẏ|", "m/s").logarithmic(),
                y: ChartAxis::new("largest entry of the derivative", "", "").logarithmic(),
                curves: vec![
                    curve("differences, step 1e-6", CurveStyle::Wrong, 1e-6),
                    curve("differences, step 1e-8", CurveStyle::Second, 1e-8),
                    curve("derivative of the formulas", CurveStyle::Truth, 0.0),
                ],
            }],
        }
    },
};

/// Relative error up to which a derivative over a hundred contacts is called exact but for rounding.
const EXACT: f64 = 1e-11;

/// Half decades of steps.
const STEPS: [f64; 23] = [
    1e-13, 3e-13, 1e-12, 3e-12, 1e-11, 3e-11, 1e-10, 3e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 3e-6, 1e-5, 3e-5,
    1e-4, 3e-4, 1e-3, 3e-3, 1e-2,
];

/// The state before the first contact, the derivative from there over `period` contacts, and the determinant that it has to
/// have: the product of −ẏ_c⁺/ẏ_c⁻.
fn reference(scene: &Scene, period: u64) -> (State, DMatrix<f64>, f64) {
    let model = scene.model();
    let state = *scene.orbit().expect("a test builds every case").state();
    let mut orbit = Orbit::at(model, Rules::BARE_MAP, state);
    let mut determinant = 1.0;
    for _ in 0..period {
        let rise = orbit.advance().strike.map_or(f64::NAN, |strike| strike.contact_rise);
        determinant *= -rise / model.contact_speed(orbit.state());
    }
    let exact = jacobian(&model, &state, period).expect("a test computes every case").matrix;
    (state, exact, determinant)
}

/// Central differences over a period with a step, m/s (m for ρθ); `None` if a run that starts so far aside ends before.
fn differences(scene: &Scene, state: &State, period: u64, step: f64) -> Option<DMatrix<f64>> {
    let map = ReturnMap::new(&scene.model(), period);
    map.differences(&map.vector(state, 0.0), step)
}

fn distance(matrix: &DMatrix<f64>, exact: &DMatrix<f64>) -> f64 {
    (matrix - exact).amax() / exact.amax()
}

/// Errors of the differences over the steps with which they can be had.
fn curve(scene: &Scene, period: u64) -> Vec<(f64, f64)> {
    let (state, exact, _) = reference(scene, period);
    let error = |step| Some((step, distance(&differences(scene, &state, period, step)?, &exact)));
    STEPS.into_iter().filter_map(error).collect()
}

fn at_height(scene: &Scene, height: f64) -> Scene {
    built(with(scene.draft(), &[(Name::Height, height)]))
}

/// Length of the flight after the first contact, s, and the contact speed at its end, m/s.
fn flight(scene: &Scene) -> (f64, f64) {
    let mut orbit = scene.orbit().expect("a test builds every case");
    let flight_time = orbit.advance().flight_time.unwrap_or(f64::NAN);
    (flight_time, scene.model().contact_speed(orbit.state()))
}

/// The height of release above which the contact that grazes is missed, m.
fn edge(scene: &Scene) -> f64 {
    let grazes = flight(scene).0;
    let (mut low, mut high) = (scene.release().height, scene.release().height + 1e-4);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return low;
        }
        if flight(&at_height(scene, middle)).0 < 1.5 * grazes { low = middle } else { high = middle }
    }
}
