//! Cases in which numerical methods are wrong. Those that go in steps invent stability and destroy it, miss contacts, and never come to rest.

use equipoise_physics::analysis::jacobian::jacobian;
use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::Value::Number;
use equipoise_physics::scene::{Name, Scene};
use nalgebra::DMatrix;

use crate::charts::{ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::case::{
    AngleHistory, BOUNCE, CONTACT_ANGLE, CasePicture, FailureCase, Findings, MethodClaim, STILL, TIME, TRUE_RHO,
    at_contacts, changed, claim, rod_of,
};
use crate::integrators::{Integrator, Location, Simulation, SimulationEnding, simulate};

/// A run that falls and is kept up by the steps.
pub(crate) const INVENTED: FailureCase = FailureCase {
    name: "invented-stability",
    title: "A step that keeps the rod up",
    method: "Runge-Kutta of order 4, contacts by one secant step",
    why: "A flight is a parabola, which Runge-Kutta follows without error: everything that is off comes from the contacts. One secant \
          step puts each of them a little off its place, and the strike there changes energy and angle by as little. The start \
          is just outside of the basin, where a little decides: the true run falls, the computed one is pushed inside and \
          circles on as if the rod were stable. The result looks smoother than the truth, and nothing in it gives it away; \
          only smaller steps do.",
    impacts: 400,
    ask: ("trajectories", "bounces=400"),
    price: 130_000,
    scene: &[TRUE_RHO, (Name::TiltGain, Number(1.105)), (Name::Theta, Number(0.35))],
    find: |scene, impacts| {
        let secant = |step| Integrator::RungeKutta { step, location: Location::Secant };
        let says = vec![
            stepped("Runge-Kutta with one secant step, 10 ms", scene, secant(1e-2), impacts),
            stepped("the same with steps of 1 ms", scene, secant(1e-3), impacts),
            AngleHistory::of(scene, impacts).says("the map"),
        ];
        Findings { truth: "falls", detail: format!("the run of the map: {}", says[2].detail), says }
    },
    picture: |scene, impacts| {
        let method = Integrator::RungeKutta { step: 1e-2, location: Location::Secant };
        beside("Runge-Kutta with one secant step, 10 ms", scene, method, impacts)
    },
};

/// The paper's first case, thrown down by a contact that takes time.
pub(crate) const DESTROYED: FailureCase = FailureCase {
    name: "destroyed-stability",
    title: "A contact model that throws the rod down",
    method: "penalty contact, steps of 1 ms",
    why: "The paper's first case circles for ever as far as anyone has looked. A spring and a damper in place of the strike hold the \
          rod for some sixteen steps, a fifteenth of a flight, in which the rod turns on, gravity works on, and the table pushes \
          where the rod no longer is. What it adds to each bounce is small and always \
          on the same side, so it adds up, and the rod falls within a few contacts. A stiffer spring needs smaller steps, and \
          only delays it.",
    impacts: 400,
    ask: ("stability", "bounces=20000"),
    price: 220_000,
    scene: &[(Name::TiltGain, Number(1.1)), (Name::Theta, Number(0.3))],
    find: |scene, impacts| {
        let says = vec![
            stepped("penalty contact, steps of 1 ms", scene, Integrator::Penalty { step: 1e-3 }, impacts),
            stepped("the same with steps of 0.1 ms", scene, Integrator::Penalty { step: 1e-4 }, impacts),
            AngleHistory::of(scene, 20_000).says("the map"),
        ];
        Findings { truth: "bounded", detail: format!("the run of the map: {}", says[2].detail), says }
    },
    picture: |scene, impacts| {
        beside("penalty contact, steps of 1 ms", scene, Integrator::Penalty { step: 1e-3 }, impacts)
    },
};

/// A contact between two looks.
pub(crate) const MISSED: FailureCase = FailureCase {
    name: "missed-contact",
    title: "A contact between two looks",
    method: "event detection by the sign of the gap",
    why: "The rod spins through upright, and for a moment its tip would be below the table. A method that looks for a change of \
          sign at the ends of its steps sees the gap open before and open after, and flies on. The steps of an adaptive \
          integrator are worst: the flight is a parabola, which costs it nothing, so it takes steps as long as the flight, \
          whatever its tolerance. No tolerance and no step excludes such a contact; convex and concave pieces of the gap do.",
    impacts: 10,
    ask: ("trajectories", "bounces=10"),
    price: 3_000,
    scene: &[
        (Name::TiltGain, Number(1.1)),
        (Name::Theta, Number(-1.8)),
        (Name::ThetaDot, Number(6.0)),
        (Name::Height, Number(0.325_747)),
    ],
    find: |scene, impacts| {
        let truth = times(scene, impacts);
        let second = truth.get(1).copied().unwrap_or(f64::NAN);
        let says = |method, times: Vec<f64>| {
            let value = times.get(1).copied();
            let found = value.is_some_and(|t| (t - second).abs() < 1e-6);
            let verdict = if found { "found" } else { "missed" };
            let detail = value.map_or("no second contact".to_owned(), |t| format!("its second contact is at {t:.6} s"));
            claim(method, verdict, value, Some("s"), detail)
        };
        let stepped = |method| simulated(scene, method, impacts).impacts.iter().map(|impact| impact.t).collect();
        let says = vec![
            says("adaptive Runge-Kutta 5(4), tolerance 1e-9", stepped(Integrator::Adaptive { tolerance: 1e-9 })),
            says("the exact flight, looked at every 10 ms", stepped(Integrator::Sampling { step: 1e-2 })),
            says("the exact flight, looked at every 1 ms", stepped(Integrator::Sampling { step: 1e-3 })),
            says("the map", truth),
        ];
        Findings {
            truth: "found",
            detail: format!("the tip meets the table at {second:.6} s, at {:.4} m/s", flight(scene).1),
            says,
        }
    },
    picture: |scene, _| {
        let mut orbit = scene.orbit().expect("a test builds every case");
        let first = orbit.advance();
        let (strike, flight_time) =
            first.strike.zip(first.flight_time).expect("the first contact of this case is a strike");
        let flight = rod_of(scene).flight(&strike);
        let gap = |t: f64| (1e3 * t, 1e6 * flight.gap(t).value);
        CasePicture {
            subtitle: "the gap between tip and table after the first contact".to_owned(),
            caption: format!(
                "The tip meets the table {:.3} ms after the first contact and would be above it again by the next look. Looks every \
                 10 ms, from the first contact on.",
                1e3 * flight_time
            ),
            plots: vec![
                Plot::new(TIME_AFTER, GAP).with(vec![
                    Curve::new("the gap", CurveStyle::Truth, (0..=260).map(|n| gap(5e-4 * f64::from(n))).collect()),
                    Curve::new("looks", CurveStyle::WrongRings, (0..=13).map(|n| gap(1e-2 * f64::from(n))).collect()),
                    Curve::new("the contact", CurveStyle::TruthDots, vec![(1e3 * flight_time, 0.0)]),
                ]),
                Plot::new(TIME_AFTER.between(56.0, 74.0), GAP.between(-3.0, 12.0)).with(vec![
                    Curve::new("", CurveStyle::Truth, (560..=740).map(|n| gap(1e-4 * f64::from(n))).collect()),
                    Curve::new("", CurveStyle::WrongRings, (6..=7).map(|n| gap(1e-2 * f64::from(n))).collect()),
                    Curve::new("", CurveStyle::TruthDots, vec![(1e3 * flight_time, 0.0)]),
                ]),
            ],
        }
    },
};

/// Bounces without number in a finite time.
pub(crate) const ZENO: FailureCase = FailureCase {
    name: "zeno",
    title: "Infinitely many bounces in a third of a second",
    method: "fixed or adaptive steps with event detection",
    why: "On a table that stands still, every flight is half as long as the one before: there are infinitely many, and together they \
          take a finite time, after which the rod is at rest. A method that goes from event to event or from step to step has no \
          way past that time that is not wrong: fixed steps go on bouncing at the size of a step for ever, and exact event \
          location makes more and more of ever shorter flights, until it counts rounding errors as bounces. The map sees the \
          flights shrink in proportion and gives the limit of their sum.",
    impacts: 100,
    ask: ("trajectories", "bounces=100"),
    price: 12_000,
    scene: &[STILL, (Name::TiltGain, Number(0.0)), (Name::Restitution, Number(0.5))],
    find: |scene, impacts| {
        let limit = limit(scene);
        let says = |method, simulation: Simulation| {
            let last = simulation.impacts.last().map(|impact| impact.t);
            let verdict = if matches!(simulation.ending, SimulationEnding::Run(Ending::Settled { .. })) {
                "settles"
            } else {
                "goes on"
            };
            let past = last.map_or(0.0, |last| last - limit);
            let detail = format!("its contact {} is {past:.3e} s past the limit", simulation.impacts.len());
            claim(method, verdict, last, Some("s"), detail)
        };
        let fixed = Integrator::RungeKutta { step: 1e-3, location: Location::StepEnd };
        let mut says = vec![
            says("Runge-Kutta, steps of 1 ms", simulated(scene, fixed, impacts)),
            says(
                "Moreau and Jean's time stepping, 1 ms",
                simulated(scene, Integrator::TimeStepping { step: 1e-3 }, impacts),
            ),
            says(
                "adaptive Runge-Kutta 5(4) with event location",
                simulated(scene, Integrator::Adaptive { tolerance: 1e-9 }, impacts),
            ),
        ];
        let course = AngleHistory::of(scene, impacts);
        let (ending, settle_time) = (course.ending.name(), course.settle_time());
        says.push(claim(
            "the map",
            if settle_time.is_some() { "settles" } else { "goes on" },
            settle_time,
            Some("s"),
            format!("ends as `{ending}`, at the limit of the sum of its flights"),
        ));
        Findings {
            truth: "settles",
            detail: format!("at rest after t₀(1 + e)/(1 − e) = {limit} s, t₀ = √(2(y₀ − l)/G) being the fall"),
            says,
        }
    },
    picture: |scene, impacts| {
        let exact = times(scene, impacts);
        let fixed = Integrator::RungeKutta { step: 1e-3, location: Location::StepEnd };
        let stepped = simulated(scene, fixed, impacts);
        let numbered = |times: &mut dyn Iterator<Item = f64>| {
            times.enumerate().map(|(n, t)| (t, n as f64 + 1.0)).collect::<Vec<_>>()
        };
        let limit = limit(scene);
        CasePicture {
            subtitle: "the number of contacts against time".to_owned(),
            caption: format!(
                "The flights halve each time, and their sum is {limit:.6} s. Steps of 1 ms go on at their own pace."
            ),
            plots: vec![Plot::new(TIME, BOUNCE).with(vec![
                Curve::new("limit", CurveStyle::Limit, vec![(limit, 0.0), (limit, impacts as f64)]),
                Curve::new(
                    "Runge-Kutta, 1 ms",
                    CurveStyle::Wrong,
                    numbered(&mut stepped.impacts.iter().map(|impact| impact.t)),
                ),
                Curve::new("the map", CurveStyle::TruthDots, numbered(&mut exact.iter().copied())),
            ])],
        }
    },
};

/// Axes of the gap after a contact.
const TIME_AFTER: ChartAxis = ChartAxis::new("time after the contact", "t", "ms");
const GAP: ChartAxis = ChartAxis::new("gap", "g", "µm");

/// Steps after which a method is given up. No case takes as many.
const MOST_STEPS: u64 = 2_000_000;

fn simulated(scene: &Scene, method: Integrator, impacts: u64) -> Simulation {
    let run = (&Body::plain(rod_of(scene)), &scene.rules(), scene.release());
    simulate(method, run, impacts, MOST_STEPS, &mut || true).expect("nobody stops it")
}

fn course(simulation: &Simulation) -> AngleHistory {
    let angles = simulation.impacts.iter().map(|impact| impact.state.theta).collect();
    let ending = match simulation.ending {
        SimulationEnding::Run(ending) => ending,
        SimulationEnding::Missed { .. } | SimulationEnding::OutOfSteps { .. } => Ending::Diverged { speed: f64::NAN },
    };
    AngleHistory { angles, ending }
}

fn stepped(name: &'static str, scene: &Scene, method: Integrator, impacts: u64) -> MethodClaim {
    let simulation = simulated(scene, method, impacts);
    let mut says = course(&simulation).says(name);
    says.detail += &format!("; {} steps", simulation.work.steps);
    says
}

/// The angles of a method and of the map.
fn beside(name: &'static str, scene: &Scene, method: Integrator, impacts: u64) -> CasePicture {
    let (exact, stepped) = (AngleHistory::of(scene, impacts), course(&simulated(scene, method, impacts)));
    let dots =
        |course: &AngleHistory| course.angles.iter().enumerate().map(|(n, theta)| (n as f64 + 1.0, *theta)).collect();
    CasePicture {
        subtitle: format!("the angle at the contacts, released at {} rad", scene.start().theta),
        caption: format!("The map: {}. The method: {}.", exact.says("").detail, stepped.says("").detail),
        plots: vec![Plot::new(BOUNCE.between(0.0, 100.0), CONTACT_ANGLE).with(vec![
            Curve::new(name, CurveStyle::WrongRings, dots(&stepped)),
            Curve::new("the map", CurveStyle::TruthDots, dots(&exact)),
        ])],
    }
}

/// Times of the contacts of a run, s.
fn times(scene: &Scene, impacts: u64) -> Vec<f64> {
    at_contacts(scene, impacts, |contact| contact.t)
}

/// t₀(1 + e)/(1 − e), s, released upright and at rest.
fn limit(scene: &Scene) -> f64 {
    let rod = rod_of(scene);
    let fall = (2.0 * (scene.release().height - rod.contact_distance) / rod.gravity).sqrt();
    fall * (1.0 + rod.restitution) / (1.0 - rod.restitution)
}

// Derivatives of the map by differences: the step that is neither too long nor too short, and the graze that has none.

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
    scene: &[(Name::TiltGain, Number(1.1)), (Name::Theta, Number(0.3))],
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
            claim(method, verdict(error.unwrap_or(1.0)), error, None, detail)
        };
        let best = curve(scene, impacts).into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(1e-8, |best| best.0);
        let says = vec![
            difference("central differences, usual step", 1e-6),
            difference("central differences, long step", 1e-4),
            difference("central differences, short step", 1e-12),
            difference("central differences, the best of all steps", best),
            claim(
                "derivative of the formulas",
                verdict(off(&exact)),
                Some(off(&exact)),
                None,
                format!("its determinant is {} and has to be {determinant}", exact.determinant()),
            ),
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
        CasePicture {
            subtitle: format!("error of the derivative over one contact and over {impacts}, against the step"),
            caption: "Errors are shares of the largest entry, measured against the derivative of the formulas, whose own error is \
                      that of its determinant. Steps are in m/s (m for ρθ)."
                .to_owned(),
            plots: vec![Plot::new(ChartAxis::new("step of the differences", "h", "").logarithmic(), ChartAxis::new("relative error", "", "").logarithmic().between(1e-16, 10.0)).with(vec![
                    Curve::new("differences over 1 contact", CurveStyle::Second, curve(scene, 1)),
                    Curve::new("over 100 contacts", CurveStyle::Wrong, curve(scene, impacts)),
                    Curve::new("derivative of the formulas", CurveStyle::Truth, vec![(STEPS[0], level), (0.1, level)]),
                ])],
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
    scene: &[
        (Name::TiltGain, Number(1.1)),
        (Name::Theta, Number(-1.8)),
        (Name::ThetaDot, Number(6.0)),
        (Name::Height, Number(0.325_747_320_128_15)),
    ],
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
            claim(method, verdict, Some(here), None, detail)
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
            Curve::new(label, style, points.collect())
        };
        CasePicture {
            subtitle: "the largest entry of the derivative, towards the graze (left)".to_owned(),
            caption: "Each point is a release a little lower than the one from which the contact is missed.".to_owned(),
            plots: vec![
                Plot::new(
                    ChartAxis::new("contact speed", "|ẏ|", "m/s").logarithmic(),
                    ChartAxis::new("largest entry of the derivative", "", "").logarithmic(),
                )
                .with(vec![
                    curve("differences, step 1e-6", CurveStyle::Wrong, 1e-6),
                    curve("differences, step 1e-8", CurveStyle::Second, 1e-8),
                    curve("derivative of the formulas", CurveStyle::Truth, 0.0),
                ]),
            ],
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
    changed(scene, &[(Name::Height, height)])
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

// The root that is always there: a contact ends at t = 0 of its own flight, and the search for the next one finds it again.

/// A rod that chatters as it topples over a table that stands still.
pub(crate) const TRIVIAL_ROOT: FailureCase = FailureCase {
    name: "trivial-root",
    title: "The contact just left is found again",
    method: "Newton's iteration on the gap, or a search that starts a little later",
    why: "After a strike the gap between tip and table is 0 at t = 0, so the equation for the next contact always has a root that is \
          none. Newton's iteration finds it whenever the flight is short. The usual remedy, to start the search a millisecond \
          later, passes over every flight that is shorter than that: here the rod chatters as it topples over, the next contact \
          comes sooner, and the search finds the tip below the table already, on its way through. Dividing t out of the \
          equation analytically leaves the true root alone, however near.",
    impacts: 30,
    ask: ("trajectories", "bounces=30"),
    price: 500,
    scene: &[STILL, (Name::TiltGain, Number(0.0)), (Name::Restitution, Number(0.5)), (Name::Theta, Number(0.05))],
    find: |scene, impacts| {
        let Short { contact, flight, flight_time, arrives, .. } = short(scene, impacts);
        let newton = newton(&flight);
        let late = search(&flight);
        let verdict = |t: Option<f64>| match t {
            None => "no contact",
            Some(t) if (t - flight_time).abs() <= 1e-9 * flight_time => "next contact",
            Some(t) if t <= 1e-3 * flight_time => "contact just left",
            Some(_) => "a later contact",
        };
        let says = |method, t: Option<f64>, detail| claim(method, verdict(t), t, Some("s"), detail);
        let below = flight.gap(NUDGE).value;
        let says = vec![
            says(
                "Newton's iteration on the gap from t = 1 µs",
                newton,
                "it falls back onto the root at t = 0".to_owned(),
            ),
            says(
                "search for a change of sign from t = 1 ms",
                late,
                format!("the tip is {:.2e} m below the table at its first look", -below),
            ),
            says(
                "the gap with t divided out",
                Some(flight_time),
                format!(
                    "the tip comes down at {:.3e} m/s, and the gap there is {:.1e} m",
                    -arrives,
                    flight.gap(flight_time).value
                ),
            ),
        ];
        let detail = format!(
            "the flight after contact {contact} takes {flight_time:.6e} s; before it the gap is open, at half of it by {:.2e} m, and after \
             it the gap would be negative",
            flight.gap(0.5 * flight_time).value
        );
        Findings { truth: "next contact", detail, says }
    },
    picture: |scene, impacts| {
        let Short { contact, flight, flight_time, .. } = short(scene, impacts);
        let gap = |t: f64| (1e3 * t, 1e6 * flight.gap(t).value);
        let line = (0..=200).map(|n| gap(0.006 * f64::from(n) * NUDGE)).collect();
        let depth = 1.1 * gap(1.2 * NUDGE).1;
        CasePicture {
            subtitle: format!("the gap between tip and table after contact {contact}"),
            caption: format!(
                "Newton's iteration from the left gives t = 0; a search from 1 ms on starts below the table. The next contact is at \
                 {:.4} ms.",
                1e3 * flight_time
            ),
            plots: vec![Plot::new(TIME_AFTER, GAP).with(vec![
                Curve::new("start of the search", CurveStyle::Limit, vec![(1e3 * NUDGE, depth), (1e3 * NUDGE, -depth)]),
                Curve::new("the gap", CurveStyle::Truth, line),
                Curve::new("found, or looked at first", CurveStyle::WrongRings, vec![(0.0, 0.0), gap(NUDGE)]),
                Curve::new("next contact", CurveStyle::TruthDots, vec![(1e3 * flight_time, 0.0)]),
            ])],
        }
    },
};

/// Delay of the search and step of its grid, s.
const NUDGE: f64 = 1e-3;

/// A flight that is shorter than the nudge.
struct Short {
    /// After which contact.
    contact: u64,
    flight: Flight,
    flight_time: f64,
    /// ẏ_c at its end, m/s.
    arrives: f64,
}

/// The first of them in a run.
fn short(scene: &Scene, impacts: u64) -> Short {
    let rod = rod_of(scene);
    let mut orbit = scene.orbit().expect("a test builds every case");
    let mut next = || {
        let contact = orbit.advance();
        let (strike, flight_time) = (contact.strike?, contact.flight_time?);
        let arrives = rod.contact_speed(orbit.state());
        Some(Short { contact: contact.n, flight: rod.flight(&strike), flight_time, arrives })
    };
    let found = (0..impacts).map_while(|_| next()).find(|short| short.flight_time < NUDGE);
    found.expect("a test computes every case")
}

/// Newton's iteration on the gap as it is.
fn newton(flight: &Flight) -> Option<f64> {
    let mut t = 1e-6;
    for _ in 0..100 {
        let gap = flight.gap(t);
        let next = t - gap.value / gap.slope;
        if next == t {
            break;
        }
        t = next;
    }
    Some(t.max(0.0))
}

/// The first change of sign from + to − on a grid that starts at the nudge, up to a second.
fn search(flight: &Flight) -> Option<f64> {
    let is_open = |index: &u32| flight.gap(f64::from(*index) * NUDGE).value > 0.0;
    (1..1000).find(|index| is_open(index) && !is_open(&(index + 1))).map(|index| f64::from(index) * NUDGE)
}
