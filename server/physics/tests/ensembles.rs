//! Statistics of ensembles: survival, intervals, quantiles, and the angles of runs that go on.

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::lanes::batch_run::LaneRunEnd;
use equipoise_physics::scene::{Draft, Name, Value};
use equipoise_physics::surveys::ensemble::{
    Ensemble, EnsembleRuns, late_half_life, median_impacts, quantiles, wilson_interval,
};

fn end(impacts: u64, outcome: EndingKind) -> LaneRunEnd {
    LaneRunEnd { impacts, outcome, max_theta: 0.0 }
}

fn ends(impacts: u64, ended: &[u64], completed: usize) -> EnsembleRuns {
    let fell = ended.iter().map(|&impacts| end(impacts, EndingKind::Toppled));
    let stood = std::iter::repeat_n(end(impacts, EndingKind::Completed), completed);
    EnsembleRuns { ends: fell.chain(stood).collect(), angles: Vec::new() }
}

#[test]
fn wilson_intervals_are_the_published_ones() {
    // R. G. Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
    for (successes, trials, lower, upper) in
        [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
    {
        let interval = wilson_interval(successes, trials);
        assert!((interval.0 - lower).abs() < 5e-5 && (interval.1 - upper).abs() < 5e-5, "{interval:?}");
        let mirrored = wilson_interval(trials - successes, trials);
        assert!((mirrored.0 - (1.0 - interval.1)).abs() < 1e-15 && (mirrored.1 - (1.0 - interval.0)).abs() < 1e-15);
    }
    for trials in [1, 2, 3, 7, 200, 20_000] {
        for successes in 0..=trials.min(200) {
            let (lower, upper) = wilson_interval(successes, trials);
            let share = successes as f64 / trials as f64;
            assert!(0.0 <= lower && lower <= share && share <= upper && upper <= 1.0, "{successes} {trials}");
            assert!(lower < upper, "{successes} of {trials}");
        }
    }
}

#[test]
fn quantiles_are_those_of_numpy() {
    assert_eq!(quantiles(&[]), None);
    assert_eq!(quantiles(&[0.3]), Some([0.3; 5]));
    assert_eq!(quantiles(&[0.0, 1.0, 2.0, 3.0, 4.0]), Some([0.2, 1.0, 2.0, 3.0, 3.8]));
    assert_eq!(quantiles(&[0.0, 1.0]), Some([0.05, 0.25, 0.5, 0.75, 0.95]));
}

#[test]
fn the_curve_counts_who_came_and_who_went_on() {
    let runs = ends(4, &[1, 3, 3, 4], 4);
    let curve = runs.survival(4);
    let counts: Vec<_> = curve.iter().map(|point| (point.at_risk, point.ended, point.share)).collect();
    assert_eq!(counts, [(8, 1, 0.875), (7, 0, 0.875), (7, 2, 0.625), (5, 1, 0.5)]);
    assert_eq!(curve[0].interval, wilson_interval(7, 8));
    assert_eq!((runs.mean_impacts(), median_impacts(&curve)), ((1 + 3 + 3 + 4 * 5) as f64 / 8.0, Some(4)));
    // A quarter of those at risk end at each of the last two contacts.
    assert!((late_half_life(&curve).unwrap() - std::f64::consts::LN_2 / (4.0_f64 / 3.0).ln()).abs() < 1e-14);
    let stands = ends(4, &[1, 1], 4).survival(4);
    assert_eq!((median_impacts(&stands), late_half_life(&stands)), (None, None));
    let falls = ends(4, &[1, 1, 4], 0).survival(4);
    assert_eq!((falls[3].share, falls[3].interval.0, median_impacts(&falls)), (0.0, 0.0, Some(1)));
}

#[test]
fn half_of_what_is_left_ends_within_the_half_life() {
    // A sixth of the runs still there ends at each contact.
    let mut left = 6_u64.pow(7);
    let mut ended = Vec::new();
    for n in 1..=6 {
        ended.extend(std::iter::repeat_n(n, (left / 6) as usize));
        left -= left / 6;
    }
    let curve = ends(6, &ended, left as usize).survival(6);
    let half_life = late_half_life(&curve).unwrap();
    assert!(((5.0_f64 / 6.0).powf(half_life) - 0.5).abs() < 1e-14, "{half_life}");
}

fn falling(runs: u64) -> Ensemble {
    let mut draft = Draft::default();
    for (name, value) in [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 0.094),
        (Name::TiltGain, 1.55),
        (Name::Height, 0.2),
        (Name::Theta, 0.1),
    ] {
        draft.set(name, Some(Value::Number(value))).unwrap();
    }
    Ensemble { scene: draft.build().unwrap(), runs, impacts: 50, angle_contacts: 11 }
}

#[test]
fn angles_are_those_of_runs_that_went_on() {
    let ensemble = falling(3);
    let watched = ensemble.watched();
    assert_eq!(watched, [1, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50]);
    let runs = ensemble.runs(0..3, &mut || true).unwrap();
    let last = runs.ends[0].impacts;
    assert!((5..50).contains(&last) && runs.count(EndingKind::Completed) == 0, "{:?}", runs.ends);
    for (n, angles) in watched.iter().zip(&runs.angles) {
        assert_eq!(angles.len(), if *n < last { 3 } else { 0 }, "{n}: {last}");
    }
    assert_eq!(runs.angles[0], [0.1; 3]);
    assert!(ensemble.is_uniform());
    assert_eq!(ensemble.runs(0..1, &mut || true).unwrap().repeated(3), runs);
    let mut parts = EnsembleRuns::default();
    for number in 0..3 {
        parts.append(ensemble.runs(number..number + 1, &mut || true).unwrap());
    }
    assert_eq!(parts, runs);
}

#[test]
fn few_contacts_are_all_watched() {
    for impacts in 1..=12 {
        let watched = Ensemble { impacts, ..falling(1) }.watched();
        assert_eq!(watched.len() as u64, impacts.min(11));
        assert_eq!((watched[0], watched[watched.len() - 1]), (1, impacts));
        assert!(watched.is_sorted_by(|one, other| one < other));
    }
}

#[test]
fn nobody_waits_no_more() {
    assert_eq!(falling(1000).runs(0..1000, &mut || false), None);
}
