//! Faults of the data, and fields for which there is no fit.

use super::*;

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
