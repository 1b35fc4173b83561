//! The state at the first row, where the unknown fields act through a part of it that was not measured.

use super::{NOISE, T, THETA, X, measure, request, scene, with};
use crate::support::random::Random;
use equipoise_physics::fitting::{Fit, QualityKind, fit};
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

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
fn coverage(truth: &Scene, name: Name, fits: &[Fit]) -> (usize, usize) {
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
        let (of_case, held) = coverage(&truth, name, &fits);
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
