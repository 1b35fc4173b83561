//! The table of fields, and drafts that become scenes or are refused.

use equipoise_physics::numbers::trig;
use equipoise_physics::scene::{Draft, FIELDS, Name, Value, field};

fn draft(values: &[(Name, f64)]) -> Draft {
    let mut draft = Draft::default();
    for &(name, number) in values {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft
}

const ROD: [(Name, f64); 4] =
    [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 0.094), (Name::TiltGain, 1.1), (Name::Height, 0.2)];

fn paths(draft: Draft) -> Vec<&'static str> {
    draft.build().unwrap_err().iter().map(|error| error.path).collect()
}

#[test]
fn defaults_are_filled_in() {
    let scene = draft(&ROD).build().unwrap();
    assert_eq!(scene.value(Name::Gravity), Some(Value::Number(9.81)));
    assert_eq!(scene.gravity(), 9.81);
    assert_eq!(scene.value(Name::TargetHeight), None);
}

#[test]
fn everything_missing_is_named_at_once() {
    assert_eq!(paths(Draft::default()), ["body", "table.tilt_gain", "release.height"]);
    assert_eq!(paths(draft(&ROD[1..])), ["body.contact_distance"]);
}

#[test]
fn contradictions_are_errors() {
    let mut point = draft(&ROD);
    point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    assert_eq!(paths(point), ["body.contact_distance", "body.radius_of_gyration"]);
    let mut still = draft(&ROD);
    still.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
    still.set(Name::EnergyGain, Some(Value::Number(0.1))).unwrap();
    assert_eq!(paths(still), ["table.energy_gain", "table.target_height"]);
}

#[test]
fn a_release_below_the_table_is_refused_and_one_on_it_is_not() {
    let mut low = draft(&ROD);
    low.set(Name::Height, Some(Value::Number(0.13))).unwrap();
    assert_eq!(paths(low), ["release.height"]);
    low.set(Name::Theta, Some(Value::Number(0.3))).unwrap();
    low.set(Name::Height, Some(Value::Number(0.4 / 3.0 * trig::sin_cos(0.3).1))).unwrap();
    low.build().unwrap();
}

#[test]
fn feedback_takes_the_place_of_the_tilt_gain() {
    let mut both = draft(&ROD);
    both.set(Name::FeedbackX, Some(Value::Number(1.0))).unwrap();
    assert_eq!(paths(both), ["table.tilt_gain"]);
    both.set(Name::TiltGain, None).unwrap();
    let scene = both.build().unwrap();
    assert_eq!(scene.value(Name::FeedbackThetaDot), Some(Value::Number(0.0)));
}

#[test]
fn noise_has_a_model_and_a_seed_where_there_is_any() {
    let quiet = draft(&[&ROD[..], &[(Name::TimingSd, 0.0)]].concat()).build().unwrap();
    assert_eq!(quiet.value(Name::Seed), None);
    let noisy = draft(&[&ROD[..], &[(Name::AngleSd, 0.01)]].concat()).build().unwrap();
    assert_eq!(noisy.value(Name::Seed), Some(Value::Integer(0)));
    assert_eq!(noisy.value(Name::NoiseModel), Some(Value::Choice("strike")));
}

#[test]
fn every_row_is_found_by_its_path_and_admits_its_default() {
    for (index, row) in FIELDS.iter().enumerate() {
        assert_eq!(row.name as usize, index, "{}", row.path);
        assert_eq!(field(row.path).map(|found| found.name), Some(row.name));
        assert!(row.default.is_none_or(|value| row.admits(value)), "{}", row.path);
    }
}

#[test]
fn numbers_that_are_not_finite_are_not_admitted() {
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!Name::TiltGain.row().admits(Value::Number(number)));
    }
}
