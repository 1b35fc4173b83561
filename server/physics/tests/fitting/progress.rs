//! Progress of fits: it rises, it changes no bit of the fit, and a fit that is told to stop stops.

use equipoise_physics::fitting::{FitFailure, FitProgress, FitStage, fit, fit_watched};

use super::{NOISE, T, cases, measure, request};
use crate::support::random::Random;

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
        let watched = fit_watched(&asked, &mut |now| told.push(*now), &mut || true);
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
    fit_watched(&asked, &mut |_| all += 1, counts).unwrap();
    assert!(looks > 20, "{case}: {looks} looks");
    for last in 1..looks {
        let (mut left, mut told) = (last, 0);
        let stops = &mut || {
            left -= i64::from(left > 0);
            left > 0
        };
        let stopped = fit_watched(&asked, &mut |_| told += 1, stops);
        assert_eq!(stopped.unwrap_err(), FitFailure::Cancelled, "{case}: at look {last}");
        assert!(told < all, "{case}: at look {last} of {looks}");
    }
}
