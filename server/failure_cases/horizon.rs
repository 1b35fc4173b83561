//! A chaotic run beyond its horizon: what single runs say there, and what many of them say together.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::angle_history::AngleHistory;
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, with};
use equipoise_physics::analysis::regularity::{Centre, TOLERANCE, measure_regularity};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::body::Release;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lanes::batch_run::run_all;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene};

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
    scene: || built(rod(&[(Name::TiltGain, 1.54), (Name::Theta, 0.032)])),
    find: |scene, impacts| {
        let runs = [plainly(scene, impacts), aside(scene, impacts), uncorrected(scene, impacts)];
        let [one, other, third] = runs.each_ref().map(|course| course.angles.len());
        let differ = |end: usize| if end == one { "predictable" } else { "unpredictable" };
        let horizon = horizon(scene);
        let ends = |numbers| ends(scene, impacts, numbers);
        let medians = [median(&ends(0..RUNS)), median(&ends(RUNS..2 * RUNS))];
        let contact = |method, verdict, value: usize, detail| MethodClaim {
            method,
            verdict,
            value: Some(value as f64),
            unit: Some("contact"),
            detail,
        };
        let says = vec![
            contact("one run", "predictable", one, format!("{}; how sure that is, it does not say", ending(&runs[0]))),
            contact("a run from 1e-15 rad aside", differ(other), other, ending(&runs[1])),
            contact(
                "the same start without correction of the energy's rounding",
                differ(third),
                third,
                ending(&runs[2]),
            ),
            MethodClaim {
                method: "growth of the Jacobian product",
                verdict: if horizon.is_some() { "unpredictable" } else { "predictable" },
                value: horizon.map(|horizon| horizon as f64),
                unit: Some("contact"),
                detail: format!("from there on rounding has grown to {TOLERANCE} of the contact speed"),
            },
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
        let [one, other] = [plainly(scene, impacts), aside(scene, impacts)];
        let apart = one.angles.iter().zip(&other.angles).enumerate();
        let apart = apart.map(|(index, (a, b))| (index as f64 + 1.0, (a - b).abs())).collect();
        let horizon = horizon(scene).unwrap_or_default() as f64;
        let upright = |x: f64, y: f64| vec![(x, 0.0), (x, y)];
        let curve = |label, style, points| Curve { label, style, points };
        Chart {
            title: CHAOS.title,
            subtitle: "two runs whose starts differ by 1e-15 rad (left), and ensembles of such runs (right)".to_owned(),
            caption: format!(
                "Left: their difference reaches the size of the motion at the horizon, contact {horizon}. Right: the two runs end at \
                 contacts {} and {}; two ensembles of {RUNS} runs, {SPACING:.0e} rad apart, agree.",
                one.angles.len(),
                other.angles.len()
            ),
            plots: vec![
                Plot {
                    x: ChartAxis::new("contact", "n", ""),
                    y: ChartAxis::new("difference of the angles", "|Δθ|", "rad").logarithmic().between(1e-18, 1.0),
                    curves: vec![
                        curve("horizon", CurveStyle::Limit, vec![(horizon, 1e-18), (horizon, 1.0)]),
                        curve("", CurveStyle::TruthDots, apart),
                    ],
                },
                Plot {
                    x: ChartAxis::new("contact", "n", "").between(0.0, impacts as f64),
                    y: ChartAxis::new("share of runs still up", "", "").between(0.0, 1.0),
                    curves: vec![
                        curve("", CurveStyle::Limit, upright(horizon, 1.0)),
                        curve("single runs", CurveStyle::Wrong, upright(one.angles.len() as f64, 1.0)),
                        curve("", CurveStyle::Wrong, upright(other.angles.len() as f64, 1.0)),
                        curve("one ensemble", CurveStyle::Truth, survival(&ends(scene, impacts, 0..RUNS), impacts)),
                        curve("another", CurveStyle::Beside, survival(&ends(scene, impacts, RUNS..2 * RUNS), impacts)),
                    ],
                },
            ],
        }
    },
};

fn plainly(scene: &Scene, impacts: u64) -> AngleHistory {
    AngleHistory::of(scene, impacts)
}

fn aside(scene: &Scene, impacts: u64) -> AngleHistory {
    AngleHistory::of(&built(with(scene.draft(), &[(Name::Theta, scene.start().theta + 1e-15)])), impacts)
}

/// The map with its rounding errors as they come.
fn uncorrected(scene: &Scene, impacts: u64) -> AngleHistory {
    let rules = Rules { holds_energy: false, ..scene.rules() };
    let mut angles = Vec::new();
    let ending = Orbit::new(scene.model(), rules, scene.release()).ok().and_then(|mut orbit| {
        run(&mut orbit, impacts, |contact| {
            angles.push(contact.state.theta);
            true
        })
    });
    AngleHistory { angles, ending: ending.unwrap_or(Ending::Completed) }
}

fn ending(course: &AngleHistory) -> String {
    format!("ends as `{}` at contact {}", course.ending.name(), course.angles.len())
}

fn horizon(scene: &Scene) -> Option<u64> {
    let small = small_deviations(scene).ok()?;
    let centre = Centre::of(&small);
    measure_regularity(scene.orbit().ok()?, &centre, u64::MAX)?.predictable_impacts(TOLERANCE)
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
