//! Fits of scenes to runs with noise added: estimates, intervals, outliers, missed and doubled impacts.

use equipoise_physics::fitting::{
    self, DataError, Fit, FitFailure, FitProgress, FitRequest, FitStage, Measured, QualityKind,
};
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::numbers::dual::Dual;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::support::random::Random;
use crate::support::rig::{with_numbers, worded};

const THETA: usize = 0;
const X_DOT: usize = 1;
const Y_DOT: usize = 2;
const THETA_DOT: usize = 3;
const X: usize = 4;
const T: usize = 5;
/// Noise of a lab: 2 mrad, 1 mm, 1 ms.
const NOISE: [f64; 6] = [2e-3, 1e-2, 1e-2, 5e-2, 1e-3, 1e-3];
const LENGTHS: [(Name, f64); 2] = [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 0.094_280_904)];

fn scene(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Scene {
    with_numbers(worded(with_numbers(Draft::default(), &LENGTHS), words), numbers).build().unwrap()
}

fn with(scene: &Scene, name: Name, value: f64) -> Scene {
    let mut draft = scene.draft();
    draft.set(name, Some(Value::Number(value))).unwrap();
    draft.build().unwrap()
}

/// A normal deviate: the sum of twelve uniform ones is too short in its tails, so Box and Muller's.
fn normal(random: &mut Random) -> f64 {
    let radius = (-2.0 * random.between(f64::MIN_POSITIVE, 1.0).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.between(0.0, 1.0)).cos()
}

/// Impacts of a run with noise, on a clock that does not start at the release.
fn measure(scene: &Scene, impacts: u64, columns: &[usize], noise: f64, random: &mut Random) -> Measured {
    let mut measured = Measured::default();
    run(&mut scene.orbit().unwrap(), impacts, |contact| {
        let state = contact.state;
        let values = [state.theta, state.x_dot, state.y_dot, state.theta_dot, contact.x, contact.t + 12.3];
        for &column in columns {
            measured.columns[column].push(Some(values[column] + noise * NOISE[column] * normal(random)));
        }
        true
    });
    measured
}

fn request(scene: &Scene, measured: Measured, unknown: &[Name]) -> FitRequest {
    FitRequest { scene: *scene, measured, unknown: unknown.to_vec(), sd: [None; 6] }
}

fn fit(request: &FitRequest, go_on: &mut dyn FnMut() -> bool) -> Result<Fit, FitFailure> {
    fitting::fit(request, &mut |_| {}, go_on)
}

fn fitted(request: &FitRequest) -> Fit {
    fit(request, &mut || true).unwrap()
}

fn case_1() -> Scene {
    scene(&[(Name::TiltGain, 1.1), (Name::Height, 0.2), (Name::Theta, 0.2)], &[])
}

/// A kind of run, its unknown fields, and the columns that are measured.
type Case = (&'static str, Scene, &'static [Name], &'static [usize]);

/// Rods, with friction, feedback, energy feedback on an incline, a wrong belief and a still table.
fn cases() -> Vec<Case> {
    let still = [(Name::TiltGain, 1.05), (Name::Restitution, 0.985), (Name::Theta, 0.01), (Name::Height, 0.5)];
    let incline = [
        (Name::Incline, std::f64::consts::FRAC_PI_4),
        (Name::Restitution, 0.5),
        (Name::Theta, 0.2),
        (Name::TiltGain, 1.1),
        (Name::EnergyGain, 0.165),
        (Name::TargetHeight, 0.25),
        (Name::Height, 0.2),
    ];
    let rough = [
        (Name::TiltGain, 1.3),
        (Name::Height, 0.2),
        (Name::Theta, 0.1),
        (Name::Friction, 0.5),
        (Name::Restitution, 0.8),
    ];
    let feedback =
        [(Name::FeedbackTheta, -1.1), (Name::FeedbackThetaDot, -0.01), (Name::Height, 0.2), (Name::Theta, 0.2)];
    let wrong = [
        (Name::Restitution, 0.795),
        (Name::AssumedRestitution, 0.8),
        (Name::Theta, 0.1),
        (Name::TiltGain, 1.1),
        (Name::Height, 0.3),
    ];
    let rig = [(Name::TiltGain, 1.2), (Name::Height, 0.2), (Name::Theta, 0.1), (Name::TiltOffset, 0.003)];
    let sliding = [
        (Name::TiltGain, 1.1),
        (Name::Restitution, 0.8),
        (Name::Height, 0.2),
        (Name::Theta, 0.1),
        (Name::Friction, 0.02),
    ];
    vec![
        ("rod", case_1(), &[Name::TiltGain, Name::Gravity], &[THETA, T]),
        ("release", case_1(), &[Name::TiltGain, Name::Height, Name::Theta], &[THETA, T]),
        (
            "rough",
            scene(&rough, &[(Name::Slide, "matched")]),
            &[Name::TiltGain, Name::RadiusOfGyration],
            &[THETA, X, T],
        ),
        ("feedback", scene(&feedback, &[]), &[Name::FeedbackTheta, Name::FeedbackThetaDot], &[THETA, T]),
        ("incline", scene(&incline, &[]), &[Name::TiltGain, Name::EnergyGain, Name::TargetHeight], &[THETA, T]),
        ("wrong belief", scene(&wrong, &[]), &[Name::Restitution, Name::TiltGain], &[THETA, T]),
        ("rig", scene(&rig, &[]), &[Name::TiltOffset, Name::TiltGain], &[THETA, X, T]),
        ("still", scene(&still, &[(Name::Strike, "still")]), &[Name::Restitution, Name::TiltGain], &[THETA, T]),
        ("falling", scene(&sliding, &[]), &[Name::Friction, Name::TiltGain], &[THETA, X, T]),
    ]
}

/// Fits of `sets` data sets of each case; the share of 95 % intervals that hold the true value, and the mean error of each unknown over its
/// standard deviation.
fn coverage(sets: usize, impacts: &[u64], random: &mut Random) -> (f64, Vec<(&'static str, Name, f64, usize)>) {
    let (mut inside, mut told, mut errors) = (0, 0, Vec::new());
    for (case, scene, unknown, columns) in cases() {
        let mut sums = vec![(0.0, 0); unknown.len()];
        for set in 0..sets {
            let measured = measure(&scene, impacts[set % impacts.len()], columns, 1.0, random);
            let first = unknown.iter().fold(scene, |scene_so_far, &name| {
                let value = scene.number(name).unwrap() * random.between(0.93, 1.07);
                let (minimum, maximum) = if name == Name::Restitution { (0.0, 1.0) } else { (-100.0, 100.0) };
                with(&scene_so_far, name, value.clamp(minimum, maximum))
            });
            let mut asked = request(&first, measured, unknown);
            if set % 2 == 0 {
                asked.sd = std::array::from_fn(|column| columns.contains(&column).then_some(NOISE[column]));
            }
            // No fit is no wrong one; `told` counts them below.
            let Ok(found) = fit(&asked, &mut || true) else { continue };
            if found.quality.kind != QualityKind::Good {
                continue;
            }
            for (estimate, sum) in found.estimates.iter().zip(&mut sums) {
                let (Some(sd), Some((low, high))) = (estimate.sd, estimate.interval) else { continue };
                let truth = scene.number(estimate.name).unwrap();
                told += 1;
                inside += usize::from((low..=high).contains(&truth));
                *sum = (sum.0 + (estimate.value - truth) / sd, sum.1 + 1);
                // Four times the half width of the interval, which is 8 standard deviations, or more where few values estimate those.
                let off = (estimate.value - truth).abs() / (high - low);
                assert!(off < 2.0, "{case}: {estimate:?} for {truth}, {:?}", found.quality);
            }
        }
        let names = unknown.iter().zip(sums);
        errors.extend(names.map(|(&name, (sum, count))| (case, name, sum / f64::from(count.max(1)), count as usize)));
    }
    let sets = (sets * cases().iter().map(|case| case.2.len()).sum::<usize>()) as f64;
    assert!(f64::from(told) > 0.9 * sets, "{told} of {sets} estimates are told");
    (inside as f64 / f64::from(told), errors)
}

#[test]
fn intervals_hold_the_true_value_as_often_as_they_say() {
    let (share, errors) = coverage(40, &[20, 40, 60, 100], &mut Random::new(18));
    assert!((0.92..=0.98).contains(&share), "{share}");
    for (case, name, mean, count) in errors {
        // A fifth of a standard deviation, and what a mean of so many is off by itself.
        assert!(mean.abs() < 0.2 + 3.0 / (count as f64).sqrt(), "{case} {name:?}: {mean}");
    }
}

#[test]
#[ignore = "takes a minute: 1000 data sets"]
fn intervals_of_a_thousand_data_sets_hold_the_true_value() {
    let (share, errors) = coverage(125, &[20, 60, 100, 200], &mut Random::new(5));
    assert!((0.92..=0.98).contains(&share), "{share}");
    for (case, name, mean, count) in errors {
        assert!(mean.abs() < 0.2 + 2.5 / (count as f64).sqrt(), "{case} {name:?}: {mean}");
    }
}

#[test]
fn derivatives_by_fields_are_those_of_runs_with_31_digits() {
    let numbers = [
        (Name::RadiusOfGyration, 0.09),
        (Name::Gravity, 9.81),
        (Name::Restitution, 0.7),
        (Name::TiltGain, 1.2),
        (Name::Height, 0.25),
        (Name::ContactDistance, 0.13),
        (Name::Theta, 0.2),
        (Name::ThetaDot, 0.3),
        (Name::XDot, 0.1),
        (Name::EnergyGain, 0.2),
        (Name::TargetHeight, 0.2),
        (Name::AssumedRestitution, 0.75),
    ];
    let scene = scene(&numbers, &[]);
    let along = |name: Name, value: f64| match numbers[..5].iter().position(|&(other, _)| other == name) {
        Some(place) => Dual::<5>::along(value, place, 1.0),
        None => Dual::from_f64(value),
    };
    let (body, release) = (scene.body_by(along), scene.release_by(along));
    let first = body.fall_to(&release, None).unwrap();
    let mut orbit = Orbit::at(body, Rules::BARE_MAP, first.state);
    orbit.advance();
    let State { theta, x_dot, y_dot, theta_dot } = *orbit.state();
    let found = [theta, x_dot, y_dot, theta_dot, release.x + first.way + orbit.x(), first.t + orbit.t()];
    for (field, &(name, value)) in numbers[..5].iter().enumerate() {
        // The second impact of the run, with 31 digits: a difference over 1e-7 of the field has 14 of them right.
        let second = |value: f64| {
            let mut orbit = with(&scene, name, value).extended_orbit().unwrap();
            orbit.advance();
            let State { theta, x_dot, y_dot, theta_dot } = *orbit.state();
            [theta, x_dot, y_dot, theta_dot, orbit.x(), orbit.t()]
        };
        let (high, low) = (value * (1.0 + 1e-7), value * (1.0 - 1e-7));
        for ((above, below), found) in second(high).into_iter().zip(second(low)).zip(found) {
            let (expected, found) = ((above - below).to_f64() / (high - low), found.partials[field]);
            assert!((found - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{name:?}: {found} for {expected}");
        }
    }
}

#[test]
fn exact_data_give_the_exact_fields() {
    for (case, scene, unknown, columns) in cases() {
        let measured = measure(&scene, 30, columns, 0.0, &mut Random::new(1));
        let first = unknown.iter().fold(scene, |found, &name| with(&found, name, scene.number(name).unwrap() * 0.97));
        let found = fitted(&request(&first, measured, unknown));
        for estimate in &found.estimates {
            let truth = scene.number(estimate.name).unwrap();
            assert!((estimate.value / truth - 1.0).abs() < 1e-5, "{case}: {estimate:?} for {truth}");
            assert_eq!(found.scene.number(estimate.name), Some(estimate.value));
        }
    }
}

#[test]
fn a_release_far_from_the_data_does_not_matter_where_it_is_not_asked_for() {
    let scene = case_1();
    let measured = measure(&scene, 40, &[THETA, T], 1.0, &mut Random::new(3));
    let elsewhere = with(&with(&scene, Name::Theta, -0.05), Name::TiltGain, 1.2);
    let found = fitted(&request(&elsewhere, measured, &[Name::TiltGain]));
    let (low, high) = found.estimates[0].interval.unwrap();
    assert!(low < 1.1 && 1.1 < high && high - low < 0.05, "{:?}", found.estimates[0]);
}

#[test]
fn outliers_are_found_and_named() {
    for (seed, column, row, size) in [(1, THETA, 10, 0.1), (2, T, 25, 0.02), (3, THETA, 0, -0.05), (4, THETA, 39, 0.2)]
    {
        let scene = case_1();
        let mut measured = measure(&scene, 40, &[THETA, T], 1.0, &mut Random::new(seed));
        let clean = fitted(&request(&scene, measured.clone(), &[Name::TiltGain]));
        measured.columns[column][row] = measured.columns[column][row].map(|value| value + size);
        let found = fitted(&request(&scene, measured, &[Name::TiltGain]));
        let outliers: Vec<(usize, usize)> = (found.rows.iter())
            .flat_map(|row| (0..6).filter(|&column| row.outliers[column]).map(|column| (row.row, column)))
            .collect();
        assert_eq!(outliers, [(row, column)], "{:?}", found.notes);
        assert!(found.notes.iter().any(|note| note.contains(&format!("row {}", row + 1))), "{:?}", found.notes);
        let (clean, found) = (&clean.estimates[0], &found.estimates[0]);
        assert!((found.value - clean.value).abs() < clean.sd.unwrap(), "{found:?} {clean:?}");
    }
}

#[test]
fn missed_and_doubled_impacts_are_found_and_named() {
    for (case, scene, unknown, columns) in cases() {
        let clean = measure(&scene, 40, columns, 1.0, &mut Random::new(9));
        if clean.rows() < 40 || case == "still" {
            continue;
        }
        let mut missed = clean.clone();
        let mut doubled = clean.clone();
        for &column in columns {
            missed.columns[column].remove(17);
            let again = clean.columns[column][22].map(|value| if column == T { value + 0.03 } else { value });
            doubled.columns[column].insert(23, again);
        }
        let best = fitted(&request(&scene, clean, unknown));
        for (measured, word) in [(missed, "missed"), (doubled, "doubled")] {
            let found = fitted(&request(&scene, measured, unknown));
            assert!(found.notes.iter().any(|note| note.contains(word)), "{case} {word}: {:?}", found.notes);
            assert_eq!(found.rows.last().unwrap().n, 40, "{case} {word}");
            for (found, best) in found.estimates.iter().zip(&best.estimates) {
                let Some(sd) = best.sd else { continue };
                assert!((found.value - best.value).abs() < 2.0 * sd, "{case} {word}: {found:?} {best:?}");
            }
        }
    }
}

#[test]
fn numbers_with_gaps_are_honoured() {
    let scene = case_1();
    let full = measure(&scene, 60, &[THETA, T], 1.0, &mut Random::new(4));
    let mut measured = Measured::default();
    for row in (0..60).filter(|row| row % 5 != 2) {
        measured.n.push(row as u64 + 1);
        for column in [THETA, T] {
            measured.columns[column].push(full.columns[column][row].filter(|_| row % 7 != 3 || column == T));
        }
    }
    let found = fitted(&request(&scene, measured, &[Name::TiltGain, Name::Gravity]));
    assert_eq!(found.quality.kind, QualityKind::Good, "{:?}", found.quality);
    for estimate in found.estimates {
        let (low, high) = estimate.interval.unwrap();
        assert!((low..=high).contains(&scene.number(estimate.name).unwrap()), "{estimate:?}");
    }
}

#[test]
fn a_wrong_model_is_said_to_be_wrong() {
    let scene = scene(
        &[
            (Name::TiltGain, 1.1),
            (Name::Height, 0.3),
            (Name::Theta, 0.1),
            (Name::Restitution, 0.8),
            (Name::AssumedRestitution, 0.82),
        ],
        &[],
    );
    let measured = measure(&scene, 60, &[THETA, T], 1.0, &mut Random::new(2));
    let mut draft = scene.draft();
    draft.set(Name::AssumedRestitution, None).unwrap();
    let mut asked = request(&draft.build().unwrap(), measured, &[Name::TiltGain]);
    asked.sd = [Some(NOISE[THETA]), None, None, None, None, Some(NOISE[T])];
    let found = fitted(&asked);
    let kind = found.quality.kind;
    assert!(matches!(kind, QualityKind::NotExplained | QualityKind::NotFollowed), "{:?}", found.quality);
}

#[test]
fn errors_of_the_rig_are_0_where_the_scene_leaves_them_out() {
    let rig = with(&case_1(), Name::TiltOffset, 0.004);
    let measured = measure(&rig, 60, &[THETA, X, T], 1.0, &mut Random::new(12));
    let found = fitted(&request(&case_1(), measured.clone(), &[Name::TiltOffset]));
    let (low, high) = found.estimates[0].interval.unwrap();
    assert!(low < 0.004 && 0.004 < high && high - low < 0.002, "{:?}", found.estimates[0]);
    // A bias b of the sensed angle tilts the table by κb, as an offset does.
    let both = fitted(&request(&case_1(), measured, &[Name::TiltOffset, Name::AngleBias]));
    for estimate in both.estimates {
        assert!(estimate.detail.unwrap().contains("only a combination"), "{:?}", estimate.name);
    }
}

// Faults of the data, and fields for which there is no fit.

#[test]
fn faults_of_the_data_are_named() {
    let scene = case_1();
    let clean = measure(&scene, 20, &[THETA, T], 1.0, &mut Random::new(2));
    let fault = |change: &dyn Fn(&mut Measured)| {
        let mut measured = clean.clone();
        change(&mut measured);
        match fit(&request(&scene, measured, &[Name::TiltGain]), &mut || true) {
            Err(FitFailure::Data(DataError { column, row, detail })) => (column, row, detail),
            other => panic!("{other:?}"),
        }
    };
    let (column, row, _) = fault(&|measured| measured.columns[T].swap(4, 5));
    assert_eq!((column, row), ("t", Some(5)));
    let (column, _, detail) =
        fault(&|measured| measured.columns[T].iter_mut().for_each(|t| *t = t.map(|t| t * 1000.0)));
    assert!(column == "t" && detail.contains("ms"), "{detail}");
    let (column, _, detail) =
        fault(&|measured| measured.columns[THETA].iter_mut().for_each(|theta| *theta = theta.map(f64::to_degrees)));
    assert!(column == "theta" && detail.contains("degrees"), "{detail}");
    // A swing of 3° is within π, but most of it would be upside down.
    let (column, row, detail) = fault(&|measured| {
        for (place, theta) in measured.columns[THETA].iter_mut().enumerate() {
            *theta = Some(3.0 * (0.8 * place as f64).sin());
        }
    });
    assert!(column == "theta" && row.is_none() && detail.contains("degrees"), "{detail}");
    let (_, _, detail) = fault(&|measured| measured.columns.iter_mut().for_each(|column| column.truncate(1)));
    assert!(detail.contains("at least 2"), "{detail}");
    let (column, _, _) = fault(&|measured| measured.columns[T].clear());
    assert_eq!(column, "t");
    let (column, row, _) = fault(&|measured| measured.n = vec![3; 20]);
    assert_eq!((column, row), ("n", Some(1)));
}

#[test]
fn other_units_and_signs_are_named() {
    let clean = measure(&case_1(), 20, &[THETA, X_DOT, Y_DOT, THETA_DOT, X, T], 1.0, &mut Random::new(2));
    fitted(&request(&case_1(), clean.clone(), &[Name::TiltGain]));
    for (column, factor, name, word) in [
        (THETA_DOT, 57.3, "theta_dot", "degrees"),
        (THETA_DOT, -1.0, "theta_dot", "sign"),
        (X_DOT, 1e3, "x_dot", "mm or cm"),
        (X, 100.0, "x_dot", "mm or cm"),
        (Y_DOT, 100.0, "y_dot", "cm/s"),
        (Y_DOT, -1.0, "y_dot", "less than 0"),
        (T, 100.0, "t", "ms"),
    ] {
        let mut measured = clean.clone();
        measured.columns[column].iter_mut().for_each(|value| *value = value.map(|value| value * factor));
        let refused = fit(&request(&case_1(), measured, &[Name::TiltGain]), &mut || true);
        let Err(FitFailure::Data(DataError { column, detail, .. })) = refused else { panic!("{name}: {refused:?}") };
        assert!(column == name && detail.contains(word), "{name}: {column}: {detail}");
    }
}

#[test]
fn fields_that_cannot_be_unknown_are_refused() {
    let scene = case_1();
    let measured = measure(&scene, 20, &[THETA, T], 1.0, &mut Random::new(2));
    for unknown in
        // A gain of the energy needs a target, and a state feedback takes the place of the tilt gain.
        [
            &[Name::TiltGain, Name::TiltGain] as &[Name],
            &[Name::Law],
            &[Name::AssumedRestitution],
            &[Name::TimingSd],
            &[Name::EnergyGain],
            &[Name::FeedbackX],
        ]
    {
        let refused = fit(&request(&scene, measured.clone(), unknown), &mut || true);
        assert!(matches!(refused, Err(FitFailure::Unknown(_, _))), "{unknown:?}: {refused:?}");
    }
    let lengths = [Name::ContactDistance, Name::RadiusOfGyration, Name::Height];
    let others = [Name::TiltGain, Name::Gravity, Name::Restitution, Name::Theta, Name::ThetaDot, Name::XDot];
    let nine = [&lengths[..], &others].concat();
    let refused = fit(&request(&scene, measured.clone(), &nine), &mut || true);
    assert!(matches!(refused, Err(FitFailure::Unknown(8, _))), "{refused:?}");
    let refused = fit(&request(&scene, measured.clone(), &[]), &mut || true);
    assert!(matches!(refused, Err(FitFailure::Unknown(0, _))), "{refused:?}");
    let cancelled = fit(&request(&scene, measured.clone(), &[Name::TiltGain]), &mut || false);
    assert_eq!(cancelled.unwrap_err(), FitFailure::Cancelled);
    let few = Measured {
        columns: measured.columns.map(|column| column.into_iter().take(3).collect()),
        ..Measured::default()
    };
    let few = fit(&request(&scene, few, &[Name::TiltGain]), &mut || true);
    assert!(matches!(few, Err(FitFailure::TooFew { .. })), "{few:?}");
}

// Progress of fits: it rises, it changes no bit of the fit, and a fit that is told to stop stops.

#[test]
fn a_fit_that_is_watched_is_the_same_and_its_progress_rises() {
    let (mut random, mut fits) = (Random::new(77), 0);
    for (case, scene, unknown, columns) in cases() {
        let mut asked = request(&scene, measure(&scene, 40, columns, 1.0, &mut random), unknown);
        // One time is an outlier.
        for time in asked.measured.columns[T].iter_mut().skip(20).take(1) {
            *time = time.map(|t| t + 10.0 * NOISE[T]);
        }
        let mut told: Vec<FitProgress> = Vec::new();
        let watched = fitting::fit(&asked, &mut |now| told.push(*now), &mut || true);
        assert_eq!(format!("{watched:?}"), format!("{:?}", fit(&asked, &mut || true)), "{case}");
        assert_eq!((told[0].done, told[0].iterations, told[0].residual), (0, 0, None), "{case}");
        for pair in told.windows(2) {
            let [before, after] = [pair[0], pair[1]];
            assert!(before.done <= after.done && after.done <= after.of && before.of == after.of, "{case}: {pair:?}");
            assert!(before.iterations <= after.iterations, "{case}: {pair:?}");
            let is_same_search = (before.stage, before.search) == (after.stage, after.search);
            assert!(!is_same_search || after.iterations == before.iterations + 1, "{case}: {pair:?}");
            assert_eq!(after.residual.is_none(), after.stage == FitStage::Beside, "{case}: {pair:?}");
        }
        let last = told.last().unwrap().iterations;
        fits += watched.map_or(0, |fit| {
            assert_eq!(last, fit.iterations, "{case}");
            1
        });
    }
    // A run that falls after a few impacts has no fit.
    assert!(fits >= 8, "{fits} fits");
}

#[test]
fn a_fit_stops_wherever_it_is_told_to() {
    let (case, scene, unknown, columns) = cases().swap_remove(0);
    let asked = request(&scene, measure(&scene, 100, columns, 1.0, &mut Random::new(5)), unknown);
    let mut looks = 0;
    let mut all = 0;
    let counts = &mut || {
        looks += 1;
        true
    };
    fitting::fit(&asked, &mut |_| all += 1, counts).unwrap();
    assert!(looks > 20, "{case}: {looks} looks");
    for last in 1..looks {
        let (mut left, mut told) = (last, 0);
        let stops = &mut || {
            left -= i64::from(left > 0);
            left > 0
        };
        let stopped = fitting::fit(&asked, &mut |_| told += 1, stops);
        assert_eq!(stopped.unwrap_err(), FitFailure::Cancelled, "{case}: at look {last}");
        assert!(told < all, "{case}: at look {last} of {looks}");
    }
}

// The state at the first row, where the unknown fields act through a part of it that was not measured.

/// Data sets of each case.
const SETS: u64 = 80;

/// Fits of data sets of a rig. The scene of a fit has another first value, and its release is in the middle of the table, where that of the
/// data is not. `places` is the number of places that are kept.
fn fits(truth: &Scene, name: Name, columns: &[usize], places: usize) -> Vec<Fit> {
    let value = truth.number(name).unwrap_or(0.0);
    let of_set = |set: u64| {
        let mut random = Random::new(40 + set);
        let mut measured = measure(truth, 40 + set % 3 * 20, columns, 1.0, &mut random);
        measured.columns[X].iter_mut().skip(places).for_each(|place| *place = None);
        let off = random.between(-0.5, 0.5) * value.abs().max(0.02);
        let first = if set.is_multiple_of(5) && name != Name::TiltGain { 0.0 } else { value + off };
        let mut asked = request(&with(&with(truth, name, first), Name::X, 0.0), measured, &[name]);
        if set.is_multiple_of(2) {
            asked.sd = std::array::from_fn(|column| columns.contains(&column).then_some(NOISE[column]));
        }
        fit(&asked, &mut || true).ok()
    };
    (0..SETS).filter_map(of_set).collect()
}

/// Number of good fits that tell the field, and of those whose interval holds the true value.
fn coverage_of(truth: &Scene, name: Name, fits: &[Fit]) -> (usize, usize) {
    let value = truth.number(name).unwrap_or(0.0);
    let good = fits.iter().filter(|fit| fit.quality.kind == QualityKind::Good);
    let told: Vec<(f64, f64)> = good.filter_map(|fit| fit.estimates[0].interval).collect();
    (told.len(), told.iter().filter(|(low, high)| (*low..=*high).contains(&value)).count())
}

const GAIN: [(Name, f64); 1] = [(Name::TiltGain, 1.1)];
const FEEDBACK: [(Name, f64); 4] =
    [(Name::FeedbackX, 0.05), (Name::FeedbackTheta, -1.1), (Name::FeedbackXDot, 0.02), (Name::FeedbackThetaDot, -0.02)];

/// A body that is released beside the middle of the table.
fn aside(law: &[(Name, f64)], more: &[(Name, f64)], words: &[(Name, &'static str)]) -> Scene {
    let numbers = [(Name::Height, 0.2), (Name::Theta, 0.02), (Name::X, 0.05)];
    scene(&[&numbers, law, more].concat(), words)
}

/// The same over a table that turns about a pivot.
fn pivoted(law: &[(Name, f64)], more: &[(Name, f64)]) -> Scene {
    aside(law, &[&[(Name::PivotX, 0.03)], more].concat(), &[(Name::TiltRate, "follows")])
}

#[test]
fn a_start_that_was_not_measured_is_an_unknown_too() {
    let spin = (Name::ThetaDot, 0.1);
    let (mut told, mut inside) = (0, 0);
    for (about, truth, name, columns, places) in [
        ("pivot, all places", pivoted(&GAIN, &[]), Name::PivotX, &[THETA, X, T][..], usize::MAX),
        ("pivot and spin, all places", pivoted(&GAIN, &[spin]), Name::PivotX, &[THETA, X, T], usize::MAX),
        ("pivot, one place", pivoted(&GAIN, &[]), Name::PivotX, &[THETA, X, T], 1),
        ("pivot and feedback of the place", pivoted(&FEEDBACK, &[]), Name::PivotX, &[THETA, T], 0),
        ("depth of the pivot", pivoted(&GAIN, &[(Name::PivotDepth, 0.01)]), Name::PivotDepth, &[THETA, T], 0),
        ("gain over a pivot", pivoted(&GAIN, &[]), Name::TiltGain, &[THETA, T], 0),
        ("feedback of the place", aside(&FEEDBACK, &[], &[]), Name::FeedbackX, &[THETA, T], 0),
    ] {
        let fits = fits(&truth, name, columns, places);
        let (of_case, held) = coverage_of(&truth, name, &fits);
        assert!(of_case >= 60 && held as f64 > 0.85 * of_case as f64, "{about}: {held} of {of_case} of {}", fits.len());
        (told, inside) = (told + of_case, inside + held);
    }
    let share = inside as f64 / told as f64;
    assert!((0.92..=0.98).contains(&share), "{inside} of {told}");
}

#[test]
fn a_field_that_acts_as_a_shift_of_an_unmeasured_place_is_not_told() {
    let bias = (Name::AngleBias, 0.004);
    for (about, truth, name) in [
        ("pivot", pivoted(&GAIN, &[]), Name::PivotX),
        ("pivot and spin", pivoted(&GAIN, &[(Name::ThetaDot, 0.1)]), Name::PivotX),
        ("bias beside feedback of the place", aside(&FEEDBACK, &[bias], &[]), Name::AngleBias),
        ("offset beside feedback of the place", aside(&FEEDBACK, &[(Name::TiltOffset, 0.004)], &[]), Name::TiltOffset),
    ] {
        let found = fits(&truth, name, &[THETA, T], 0);
        assert!(found.len() > 70, "{about}: {}", found.len());
        for fit in found {
            let estimate = &fit.estimates[0];
            assert!(!estimate.is_identifiable() && estimate.interval.is_none(), "{about}: {estimate:?}");
            let detail = estimate.detail.as_deref().unwrap();
            let says_why =
                detail.contains("as a shift of the place x does") && detail.contains("measure x of one impact");
            assert!(says_why || fit.quality.kind == QualityKind::NotConverged, "{about}: {detail}");
        }
    }
}

#[test]
fn notes_say_what_is_taken_as_known_of_the_start() {
    let truth = scene(&[(Name::TiltGain, 1.1), (Name::Height, 0.2), (Name::Theta, 0.05)], &[]);
    let measured = measure(&truth, 30, &[THETA, T], 1.0, &mut Random::new(1));
    let found = fit(&request(&truth, measured.clone(), &[Name::TiltGain, Name::Theta]), &mut || true).unwrap();
    let note = found.notes.iter().find(|note| note.contains("from the release")).expect("a note on the release");
    assert!(note.contains("release.height = 0.2 m") && !note.contains("release.theta ="), "{note}");
    let found = fit(&request(&truth, measured.clone(), &[Name::TiltGain]), &mut || true).unwrap();
    assert!(found.notes.iter().all(|note| !note.contains("release")), "{:?}", found.notes);

    let mut draft: Draft = truth.draft();
    draft.set(Name::EnergyGain, Some(Value::Number(0.1))).unwrap();
    draft.set(Name::Program, Some(Value::Numbers(HeightProgram::new(&[0.2, 0.22]).unwrap()))).unwrap();
    let juggling = draft.build().unwrap();
    let mut measured = measure(&juggling, 30, &[THETA, T], 1.0, &mut Random::new(1));
    let says_strike = |fit: &Fit| fit.notes.iter().any(|note| note.contains("strike 1 of the 2 of table.program"));
    let found = fit(&request(&juggling, measured.clone(), &[Name::TiltGain]), &mut || true).unwrap();
    assert!(says_strike(&found), "{:?}", found.notes);
    measured.n = (1..=30).collect();
    let found = fit(&request(&juggling, measured, &[Name::TiltGain]), &mut || true).unwrap();
    assert!(!says_strike(&found), "{:?}", found.notes);
}

// Fields that the data do not tell.

#[test]
fn a_field_without_effect_is_not_told() {
    // Restitution drops out where the table makes up the loss, by the strike gain 2.
    let scene = scene(&[(Name::TiltGain, 1.1), (Name::Height, 0.2), (Name::Theta, 0.2), (Name::Restitution, 0.6)], &[]);
    let measured = measure(&scene, 50, &[THETA, T], 1.0, &mut Random::new(6));
    let of = |unknown: &[Name]| fitted(&request(&scene, measured.clone(), unknown));
    let says = |fit: &Fit, word: &str| fit.notes.iter().any(|note| note.contains(word));
    let both = of(&[Name::Restitution, Name::TiltGain]);
    assert!(!both.estimates[0].is_identifiable() && both.estimates[1].is_identifiable());
    assert!(both.estimates[0].detail.as_ref().unwrap().contains("makes up"), "{:?}", both.estimates[0]);
    assert_eq!(both.scene.number(Name::Restitution), Some(0.6));
    assert!(says(&both, "mixes") && says(&both, "contact.restitution = 0.6"), "{:?}", both.notes);
    // It may be the only one.
    let alone = of(&[Name::Restitution]);
    assert!(!alone.estimates[0].is_identifiable() && alone.covariance == [[0.0]], "{alone:?}");
    assert!(says(&alone, "is the one that was given"), "{:?}", alone.notes);
    let told = of(&[Name::TiltGain]);
    assert!(told.kept.is_none() && told.notes.is_empty(), "{:?}", told.notes);
}

#[test]
fn a_tilt_gain_without_any_tilt_is_not_told() {
    let scene = with(&case_1(), Name::Theta, 0.0);
    for seed in 0..100 {
        let measured = measure(&scene, 60, &[THETA, T], 1.0, &mut Random::new(seed));
        let found = fitted(&request(&scene, measured, &[Name::TiltGain]));
        let is_good = found.quality.kind == QualityKind::Good;
        assert!(!(is_good && found.estimates[0].is_identifiable()), "{seed}: {:?}", found.estimates[0]);
    }
}

#[test]
fn fields_of_which_only_a_combination_acts_are_not_told() {
    // The motion of a lossless rod depends on its lengths through l/ρ² and l alone, and times and angles have no length in them but by gravity.
    let scene = case_1();
    let measured = measure(&scene, 50, &[THETA, T], 1.0, &mut Random::new(8));
    let unknown = [Name::ContactDistance, Name::RadiusOfGyration, Name::Gravity];
    let found = fitted(&request(&scene, measured, &unknown));
    assert!(found.estimates.iter().all(|estimate| !estimate.is_identifiable()), "{:?}", found.estimates);
}

#[test]
fn a_contact_distance_with_a_mirror_is_not_told() {
    // Where the contact sticks, l acts on the angle through l/(l² + ρ²), which is the same at ρ²/l.
    let numbers = [
        (Name::ContactDistance, 0.0894),
        (Name::RadiusOfGyration, 0.0631),
        (Name::Gravity, 3.362),
        (Name::TiltGain, 1.115),
        (Name::Friction, 0.6),
        (Name::Restitution, 0.75),
        (Name::AssumedRestitution, 0.751),
        (Name::Height, 0.22),
        (Name::Theta, 0.1),
    ];
    let scene = scene(&numbers, &[(Name::Slide, "matched")]);
    for (seed, first) in (0..10).flat_map(|seed| [0.06, 0.0894, 0.11].map(|first| (seed, first))) {
        let measured = measure(&scene, 20, &[THETA, T], 1.0, &mut Random::new(seed));
        let mut asked =
            request(&with(&scene, Name::ContactDistance, first), measured, &[Name::ContactDistance, Name::TiltGain]);
        asked.sd = std::array::from_fn(|column| [THETA, T].contains(&column).then_some(NOISE[column]));
        let found = fitted(&asked);
        let estimate = &found.estimates[0];
        let is_near = (estimate.value - 0.0894).abs() < 6.0 * estimate.sd.unwrap_or(f64::INFINITY);
        assert!(is_near, "{seed}, from {first}: {estimate:?} {:?}", found.quality);
    }
}

#[test]
fn a_gain_and_an_inertia_of_a_short_small_swing_are_told_right_or_not_at_all() {
    // The frequency of a small swing tells (κ − 1)/ρ² alone. In these sets of a thousand the fit slid along that valley to its end.
    let scene = with(&case_1(), Name::Theta, 0.1);
    let names = [Name::TiltGain, Name::RadiusOfGyration];
    let mut random = Random::new(11);
    let mut untold = 0;
    for set in 0..1200 {
        let measured = measure(&scene, 20, &[THETA, T], 1.0, &mut random);
        let first = names
            .iter()
            .fold(scene, |so_far, &name| with(&so_far, name, scene.number(name).unwrap() * random.between(0.93, 1.07)));
        if ![5, 210, 675, 1149].contains(&set) {
            continue;
        }
        let found = fitted(&request(&first, measured, &names));
        for estimate in &found.estimates {
            let Some((low, high)) = estimate.interval else {
                untold += 1;
                assert!(estimate.detail.is_some() && found.kept.as_ref().unwrap().contains(estimate.name.row().path));
                continue;
            };
            let off = (estimate.value - scene.number(estimate.name).unwrap()).abs();
            let half = (high - estimate.value).max(estimate.value - low);
            assert!(off < 2.5 * half, "{set}: {:?}", found.estimates);
        }
    }
    assert!(untold > 0);
}
