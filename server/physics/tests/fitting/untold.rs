//! Fields that the data do not tell.

use super::*;

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
