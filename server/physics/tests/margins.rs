//! Margins over a box of bodies: closed forms at its corners, and no body inside that does worse.

use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::stability::fixed_point::find_fixed_point;
use equipoise_physics::stability::linear_verdict::linear_verdict;
use equipoise_physics::stability::margins::{Tolerances, margins_over_tolerances};

mod paper;
#[path = "support/random.rs"]
mod random;

fn scene(values: &[(Name, f64)]) -> Scene {
    let mut draft = paper::scene(1.1, 0.1).draft();
    for &(name, number) in values {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft.build().unwrap()
}

#[test]
fn the_least_critical_gain_is_found_inside_the_box_too() {
    // Released at rest, V² l = 2G(y₀ − l) l is greatest at l = y₀/2 = 0.1: κ_c is least there, not at an end.
    let tolerances = Tolerances { contact_distance: 0.05, radius_of_gyration: 0.004, restitution: 0.0 };
    let margins = margins_over_tolerances(&scene(&[]), &tolerances).unwrap();
    let rho = 2.0_f64.sqrt() / 15.0 - 0.004;
    let expected = 1.0 + rho * rho / (2.0 * 0.1 * 0.1);
    assert!((margins.critical_tilt_gain.least - expected).abs() < 1e-12, "{margins:?}");
    assert!((margins.worst.contact_distance - 0.1).abs() < 1e-6);
    assert!(margins.holds);
    assert!(!margins_over_tolerances(&scene(&[(Name::TiltGain, 1.45)]), &tolerances).unwrap().holds);
}

#[test]
fn no_body_in_the_box_is_beyond_what_is_said() {
    let scene = scene(&[
        (Name::Restitution, 0.5),
        (Name::EnergyGain, 0.165),
        (Name::TargetHeight, 0.25),
        (Name::ThetaDot, 0.3),
    ]);
    let tolerances = Tolerances { contact_distance: 0.004, radius_of_gyration: 0.003, restitution: 0.05 };
    let margins = margins_over_tolerances(&scene, &tolerances).unwrap();
    let mut random = random::Random::new(3);
    for _ in 0..500 {
        let mut draft = scene.draft();
        for (name, middle, off) in [
            (Name::ContactDistance, 0.4 / 3.0, 0.004),
            (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0, 0.003),
            (Name::Restitution, 0.5, 0.05),
        ] {
            draft.set(name, Some(Value::Number(middle + off * random.size(1e-3, 1.0)))).unwrap();
        }
        draft.set(Name::AssumedRestitution, Some(Value::Number(0.5))).unwrap();
        let sample = draft.build().unwrap();
        let fixed_point = find_fixed_point(&sample).unwrap();
        let linear = linear_verdict(&sample, &fixed_point);
        for (value, span) in [
            (linear.critical_tilt_gain, margins.critical_tilt_gain),
            (fixed_point.apex_height, margins.apex_height),
            (linear.energy_eigenvalue, margins.energy_eigenvalue),
        ] {
            assert!(span.least <= value && value <= span.most, "{value} {span:?}");
        }
    }
}

#[test]
fn without_energy_feedback_there_is_no_margin_for_restitution() {
    let tolerances = Tolerances { restitution: 0.01, ..Tolerances::default() };
    let why = margins_over_tolerances(&scene(&[(Name::Restitution, 0.5)]), &tolerances).unwrap_err();
    assert!(why.contains("no bounce repeats"), "{why}");
    let exact = margins_over_tolerances(&scene(&[]), &Tolerances::default()).unwrap();
    assert_eq!(exact.critical_tilt_gain.least, exact.critical_tilt_gain.most);
}
