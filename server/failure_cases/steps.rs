//! Methods that go in steps: they invent stability and destroy it, miss contacts, and never come to rest.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::angle_history::AngleHistory;
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, rod_of};
use crate::integrators::{Integrator, Location, Simulation, SimulationEnding, simulate};
use equipoise_physics::map::body::Body;
use equipoise_physics::run::ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Name, Scene, Value};

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
    scene: || {
        let rho = 0.051_370_116_691_408_14;
        built(rod(&[(Name::RadiusOfGyration, rho), (Name::TiltGain, 1.105), (Name::Theta, 0.35)]))
    },
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
        beside(INVENTED.title, "Runge-Kutta with one secant step, 10 ms", scene, method, impacts)
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
    scene: || built(rod(&[(Name::TiltGain, 1.1), (Name::Theta, 0.3)])),
    find: |scene, impacts| {
        let says = vec![
            stepped("penalty contact, steps of 1 ms", scene, Integrator::Penalty { step: 1e-3 }, impacts),
            stepped("the same with steps of 0.1 ms", scene, Integrator::Penalty { step: 1e-4 }, impacts),
            AngleHistory::of(scene, 20_000).says("the map"),
        ];
        Findings { truth: "bounded", detail: format!("the run of the map: {}", says[2].detail), says }
    },
    picture: |scene, impacts| {
        beside(DESTROYED.title, "penalty contact, steps of 1 ms", scene, Integrator::Penalty { step: 1e-3 }, impacts)
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
    scene: || {
        built(rod(&[(Name::TiltGain, 1.1), (Name::Theta, -1.8), (Name::ThetaDot, 6.0), (Name::Height, 0.325_747)]))
    },
    find: |scene, impacts| {
        let truth = contacts(scene, impacts);
        let second = truth.get(1).map_or(f64::NAN, |contact| contact.0);
        let says = |method, times: Vec<f64>| {
            let value = times.get(1).copied();
            let found = value.is_some_and(|t| (t - second).abs() < 1e-6);
            let verdict = if found { "found" } else { "missed" };
            let detail = value.map_or("no second contact".to_owned(), |t| format!("its second contact is at {t:.6} s"));
            MethodClaim { method, verdict, value, unit: Some("s"), detail }
        };
        let stepped = |method| simulated(scene, method, impacts).impacts.iter().map(|impact| impact.t).collect();
        let says = vec![
            says("adaptive Runge-Kutta 5(4), tolerance 1e-9", stepped(Integrator::Adaptive { tolerance: 1e-9 })),
            says("the exact flight, looked at every 10 ms", stepped(Integrator::Sampling { step: 1e-2 })),
            says("the exact flight, looked at every 1 ms", stepped(Integrator::Sampling { step: 1e-3 })),
            says("the map", truth.iter().map(|contact| contact.0).collect()),
        ];
        let detail = format!("the tip meets the table at {second:.6} s, at {:.4} m/s", contact_speed(scene));
        Findings { truth: "found", detail, says }
    },
    picture: |scene, _| {
        let mut orbit = scene.orbit().expect("a test builds every case");
        let first = orbit.advance();
        let (strike, flight_time) =
            first.strike.zip(first.flight_time).expect("the first contact of this case is a strike");
        let flight = rod_of(scene).flight(&strike);
        let gap = |t: f64| (1e3 * t, 1e6 * flight.gap(t).value);
        let curve = |label, style, points| Curve { label, style, points };
        Chart {
            title: MISSED.title,
            subtitle: "the gap between tip and table after the first contact".to_owned(),
            caption: format!(
                "The tip meets the table {:.3} ms after the first contact and would be above it again by the next look. Looks every \
                 10 ms, from the first contact on.",
                1e3 * flight_time
            ),
            plots: vec![
                Plot {
                    x: ChartAxis::new("time after the contact", "t", "ms"),
                    y: ChartAxis::new("gap", "g", "µm"),
                    curves: vec![
                        curve("the gap", CurveStyle::Truth, (0..=260).map(|n| gap(5e-4 * f64::from(n))).collect()),
                        curve("looks", CurveStyle::WrongRings, (0..=13).map(|n| gap(1e-2 * f64::from(n))).collect()),
                        curve("the contact", CurveStyle::TruthDots, vec![(1e3 * flight_time, 0.0)]),
                    ],
                },
                Plot {
                    x: ChartAxis::new("time after the contact", "t", "ms").between(56.0, 74.0),
                    y: ChartAxis::new("gap", "g", "µm").between(-3.0, 12.0),
                    curves: vec![
                        curve("", CurveStyle::Truth, (560..=740).map(|n| gap(1e-4 * f64::from(n))).collect()),
                        curve("", CurveStyle::WrongRings, (6..=7).map(|n| gap(1e-2 * f64::from(n))).collect()),
                        curve("", CurveStyle::TruthDots, vec![(1e3 * flight_time, 0.0)]),
                    ],
                },
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
    scene: || {
        let mut draft = rod(&[(Name::TiltGain, 0.0), (Name::Restitution, 0.5)]);
        draft.set(Name::Strike, Some(Value::Choice("still"))).expect("a test builds every case");
        built(draft)
    },
    find: |scene, impacts| {
        let limit = limit(scene);
        let says = |method, simulation: Simulation| {
            let last = simulation.impacts.last().map(|impact| impact.t);
            let verdict = if matches!(
                simulation.ending,
                SimulationEnding::Run(equipoise_physics::run::ending::Ending::Settled { .. })
            ) {
                "settles"
            } else {
                "goes on"
            };
            let past = last.map_or(0.0, |last| last - limit);
            let detail = format!("its contact {} is {past:.3e} s past the limit", simulation.impacts.len());
            MethodClaim { method, verdict, value: last, unit: Some("s"), detail }
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
        let (ending, settle_time) = settled(scene, impacts);
        says.push(MethodClaim {
            method: "the map",
            verdict: if settle_time.is_some() { "settles" } else { "goes on" },
            value: settle_time,
            unit: Some("s"),
            detail: format!("ends as `{ending}`, at the limit of the sum of its flights"),
        });
        let detail = format!("at rest after t₀(1 + e)/(1 − e) = {limit} s, t₀ = √(2(y₀ − l)/G) being the fall");
        Findings { truth: "settles", detail, says }
    },
    picture: |scene, impacts| {
        let exact = contacts(scene, impacts);
        let fixed = Integrator::RungeKutta { step: 1e-3, location: Location::StepEnd };
        let stepped = simulated(scene, fixed, impacts);
        let numbered = |times: &mut dyn Iterator<Item = f64>| {
            times.enumerate().map(|(n, t)| (t, n as f64 + 1.0)).collect::<Vec<_>>()
        };
        let curve = |label, style, points| Curve { label, style, points };
        let limit = limit(scene);
        Chart {
            title: ZENO.title,
            subtitle: "the number of contacts against time".to_owned(),
            caption: format!(
                "The flights halve each time, and their sum is {limit:.6} s. Steps of 1 ms go on at their own pace."
            ),
            plots: vec![Plot {
                x: ChartAxis::new("time", "t", "s"),
                y: ChartAxis::new("contact", "n", ""),
                curves: vec![
                    curve("limit", CurveStyle::Limit, vec![(limit, 0.0), (limit, impacts as f64)]),
                    curve(
                        "Runge-Kutta, 1 ms",
                        CurveStyle::Wrong,
                        numbered(&mut stepped.impacts.iter().map(|impact| impact.t)),
                    ),
                    curve("the map", CurveStyle::TruthDots, numbered(&mut exact.iter().map(|contact| contact.0))),
                ],
            }],
        }
    },
};

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
        SimulationEnding::Missed { .. } | SimulationEnding::OutOfSteps { .. } => {
            equipoise_physics::run::ending::Ending::Diverged { speed: f64::NAN }
        }
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
fn beside(title: &'static str, name: &'static str, scene: &Scene, method: Integrator, impacts: u64) -> Chart {
    let (exact, stepped) = (AngleHistory::of(scene, impacts), course(&simulated(scene, method, impacts)));
    let dots =
        |course: &AngleHistory| course.angles.iter().enumerate().map(|(n, theta)| (n as f64 + 1.0, *theta)).collect();
    let curve = |label, style, points| Curve { label, style, points };
    Chart {
        title,
        subtitle: format!("the angle at the contacts, released at {} rad", scene.start().theta),
        caption: format!("The map: {}. The method: {}.", exact.says("").detail, stepped.says("").detail),
        plots: vec![Plot {
            x: ChartAxis::new("contact", "n", "").between(0.0, 100.0),
            y: ChartAxis::new("angle at the contact", "θ", "rad"),
            curves: vec![
                curve(name, CurveStyle::WrongRings, dots(&stepped)),
                curve("the map", CurveStyle::TruthDots, dots(&exact)),
            ],
        }],
    }
}

/// Times and contact speeds of the contacts of a run.
fn contacts(scene: &Scene, impacts: u64) -> Vec<(f64, f64)> {
    let rod = rod_of(scene);
    let mut contacts = Vec::new();
    if let Ok(mut orbit) = scene.orbit() {
        run(&mut orbit, impacts, |contact| {
            contacts.push((contact.t, rod.contact_speed(&contact.state)));
            true
        });
    }
    contacts
}

/// ẏ_c at the second contact, m/s.
fn contact_speed(scene: &Scene) -> f64 {
    contacts(scene, 2).get(1).map_or(f64::NAN, |contact| contact.1)
}

/// t₀(1 + e)/(1 − e), s, released upright and at rest.
fn limit(scene: &Scene) -> f64 {
    let rod = rod_of(scene);
    let fall = (2.0 * (scene.release().height - rod.contact_distance) / rod.gravity).sqrt();
    fall * (1.0 + rod.restitution) / (1.0 - rod.restitution)
}

/// End of the run, and the time when it comes to rest.
fn settled(scene: &Scene, impacts: u64) -> (&'static str, Option<f64>) {
    let ending = scene.orbit().ok().and_then(|mut orbit| run(&mut orbit, impacts, |_| true));
    let settle_time =
        if let Some(ending::Ending::Settled { settle_time, .. }) = ending { Some(settle_time) } else { None };
    (ending.map_or("unknown", ending::Ending::name), settle_time)
}
