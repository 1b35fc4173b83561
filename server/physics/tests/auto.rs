//! The chosen method is within the tolerance, and doubles are nearly always chosen where they would do, over the random scenes on
//! which the error estimates are held.

use crate::support::random;
use crate::support::scenes;
use equipoise_physics::analysis::method::{RunMethod, choose_method, run_by};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit;
use equipoise_physics::scene::Scene;

/// A run with 31 digits: its states just before each impact, and how it ended.
struct Exact {
    states: Vec<[DoubleDouble; 4]>,
    ending: &'static str,
    rho: f64,
    is_point: bool,
}

fn exact(scene: &Scene, impacts: u64) -> Exact {
    let mut orbit = scene.extended_orbit().unwrap();
    let rho = orbit.body.rod.radius_of_gyration.to_f64();
    let mut states = Vec::new();
    let ending = orbit::run(&mut orbit, impacts, |contact| {
        let state = contact.state;
        states.push([state.theta, state.x_dot, state.y_dot, state.theta_dot]);
        true
    });
    Exact { states, ending: ending.unwrap().name(), rho, is_point: scene.model().rod.contact_distance == 0.0 }
}

/// The largest error of a method's states; `None` if it ends otherwise or does not apply.
fn error(scene: &Scene, method: RunMethod, impacts: u64, exact: &Exact) -> Option<f64> {
    let (mut worst, mut made) = (0.0_f64, 0);
    let ending: Ending = run_by(scene, method, impacts, |impact| {
        let state = impact.contact.state;
        let ours = [state.theta, state.x_dot, state.y_dot, state.theta_dot];
        let turned = if exact.is_point { 0.0 } else { exact.rho };
        let scales = [turned, 1.0, 1.0, if exact.is_point { 0.0 } else { exact.rho }];
        if let Some(reference) = exact.states.get(made) {
            for ((ours, reference), scale) in ours.into_iter().zip(reference).zip(scales) {
                worst = worst.max(scale * (*reference - ours.into()).to_f64().abs());
            }
        }
        made += 1;
        true
    })
    .ok()??;
    (ending.name() == exact.ending && made == exact.states.len()).then_some(worst)
}

/// m/s. Between the last two is the rounding of doubles itself, where a bound of some ten errors is often the wrong side of it.
const TOLERANCES: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12, 1e-20];

#[test]
fn the_choice_holds_and_is_nearly_always_the_cheaper() {
    let (mut chosen, mut cheapest, mut refused) = ([0; 2], 0, 0);
    for kind in scenes::KINDS {
        let mut source = random::Random::new(31);
        for run in 0..112 {
            let scene = scenes::scene(&mut source, kind);
            let impacts = [20, 100, 400, 2000][run % 4];
            let tolerance = TOLERANCES[run % TOLERANCES.len()];
            let Ok(choice) = choose_method(&scene, impacts, tolerance, || true).unwrap() else {
                refused += 1;
                continue;
            };
            chosen[usize::from(choice.method == RunMethod::Extended)] += 1;
            let exact = exact(&scene, impacts);
            if choice.method != RunMethod::Extended {
                let off = error(&scene, choice.method, impacts, &exact);
                assert!(off.is_some_and(|off| off <= tolerance), "{kind:?} {run}: {choice:?} is off by {off:?}");
            }
            let would_do = error(&scene, RunMethod::Map, impacts, &exact).is_some_and(|off| off <= tolerance);
            cheapest += usize::from(choice.method == RunMethod::Map || !would_do);
        }
    }
    let all: usize = chosen.iter().sum();
    println!("map, extended chosen {chosen:?} times, {refused} refused; {cheapest} of {all} were the cheapest");
    assert!(all > 800 && chosen.iter().all(|times| *times > 10), "{chosen:?}");
    assert!(cheapest * 100 >= all * 95, "{cheapest} of {all}");
}
