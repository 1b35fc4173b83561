//! The basin of release angles against runs one by one.

use crate::paper;
use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use equipoise_physics::analysis::basin::{NoBasin, find_basin, sides};
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::{Name, Scene, Value};
use paper::scene;

fn survives(tilt_gain: f64, theta: f64, impacts: u64) -> bool {
    run_nonlinear(&scene(tilt_gain, theta), impacts, || true).unwrap().ending == Ending::Completed
}

#[test]
fn edges_and_holes_are_where_runs_fall() {
    for tilt_gain in [1.1, 1.2, 1.3, 1.375, 1.45] {
        let basin = find_basin(&scene(tilt_gain, 0.01), 1000, || true).unwrap();
        println!("κ = {tilt_gain}: {basin:?}");
        assert!(basin.unbroken <= basin.theta && basin.tolerance < 1e-6);
        for edge in [basin.theta, basin.unbroken] {
            assert!(survives(tilt_gain, edge, 1000), "κ = {tilt_gain}: {edge}");
            // Not all of them need to: at the outer edge angles that fall and survive are mixed at every scale.
            let falls = |step: i32| !survives(tilt_gain, edge + basin.tolerance * f64::from(step) / 20.0, 1000);
            assert!((1..=21).any(falls), "κ = {tilt_gain}: {edge}");
        }
        assert_eq!(basin.holes.is_empty(), basin.unbroken == basin.theta);
        for (from, to) in &basin.holes {
            assert!(basin.unbroken < *from && from <= to && *to < basin.theta);
            assert!(!survives(tilt_gain, *from, 1000) && !survives(tilt_gain, *to, 1000));
        }
    }
    // The dent beyond the order-4 resonance, R = 1/2.
    let width = |tilt_gain| find_basin(&scene(tilt_gain, 0.01), 1000, || true).unwrap().unbroken;
    println!("{}", width(1.266));
    assert!(width(1.266) < 0.2 && width(1.1) > 0.3);
}

#[test]
fn below_one_nothing_survives_and_a_search_can_be_stopped() {
    assert!(find_basin(&scene(0.9, 0.01), 1000, || true).unwrap().theta < 1e-4);
    assert_eq!(find_basin(&scene(1.1, 0.01), 100_000, || false), Err(NoBasin::Stopped));
}

/// A scene with other values; those of `Name::TiltGain` and of lengths may be cleared.
fn with(base: &Scene, values: &[(Name, Option<f64>)], vertices: Option<Vertices>) -> Scene {
    let mut draft = base.draft();
    for &(name, number) in values {
        draft.set(name, number.map(Value::Number)).unwrap();
    }
    if vertices.is_some() {
        draft.set_vertices(vertices);
    }
    draft.build().unwrap()
}

/// Runs that lanes do not hold are made one by one, and the edges are where they fall.
#[test]
fn feedback_limits_polygons_and_programs_have_a_basin_too() {
    let case_1 = scene(1.1, 0.01);
    let law = [(Name::FeedbackTheta, Some(-1.1)), (Name::FeedbackThetaDot, Some(-0.02)), (Name::TiltGain, None)];
    let limited = with(&case_1, &[(Name::TiltLimit, Some(0.2))], None);
    // The third vertex hangs low on one side.
    let lengths = [(Name::ContactDistance, None), (Name::RadiusOfGyration, None)];
    let vertices = Vertices::new(&[[0.0, 0.0], [0.08, 0.02], [0.05, 0.2], [-0.05, 0.2]]).unwrap();
    let polygon = with(&case_1, &[lengths[0], lengths[1], (Name::TiltGain, Some(1.03))], Some(vertices));
    let mut juggling = case_1.draft();
    juggling.set(Name::EnergyLaw, Some(Value::Choice("one_strike"))).unwrap();
    juggling.set(Name::Program, HeightProgram::new(&[0.2, 0.25]).map(Value::Numbers)).unwrap();
    for (name, base) in [
        ("feedback", with(&case_1, &law, None)),
        ("limits", limited),
        ("polygon", polygon),
        ("program", juggling.build().unwrap()),
    ] {
        let basin = find_basin(&base, 300, || true).unwrap();
        println!("{name}: {basin:?}");
        assert!(basin.unbroken > 0.02 && basin.theta < 1.5, "{name}: {basin:?}");
        let survives = |theta: f64| {
            let at = |theta: f64| with(&base, &[(Name::Theta, Some(theta))], None);
            let lasts = |theta| run_nonlinear(&at(theta), 300, || true).unwrap().ending == Ending::Completed;
            lasts(theta) && (base.outline().is_none() || lasts(-theta))
        };
        assert!(survives(basin.unbroken) && survives(basin.theta), "{name}");
        assert!((1..=21).any(|step| !survives(basin.unbroken + basin.tolerance * f64::from(step) / 20.0)), "{name}");
        assert_eq!(find_basin(&base, 100_000, || false), Err(NoBasin::Stopped), "{name}");
    }
}

/// The basin of any mix of features: the run survives at its edges, on both sides, and does not just beyond the unbroken one.
#[test]
fn any_mix_of_features_has_a_basin() {
    let mut random = Random::new(11);
    let (mut found, mut one_sided) = (0, 0);
    while found < 12 {
        let mix = Mix::draw(&mut random, Swing::Calm, &all_but(&["length", "limits"]));
        let zero = [Name::X, Name::XDot, Name::ThetaDot].map(|name| (name, Some(0.0)));
        let base = with(&mix.scene, &zero, None);
        let Ok(basin) = find_basin(&base, 60, || true) else { continue };
        found += u32::from(!mix.features.is_empty());
        one_sided += u32::from(sides(&base) == 1);
        let lasts = |theta: f64| {
            let mut draft = base.draft();
            draft.set(Name::Theta, Some(Value::Number(theta))).unwrap();
            // A polygon may not be released at every angle.
            draft.build().is_ok_and(|scene| run_nonlinear(&scene, 60, || true).unwrap().ending == Ending::Completed)
        };
        let survives = |theta: f64| lasts(theta) && lasts(-theta);
        assert!(survives(basin.unbroken) && survives(basin.theta), "{:?}: {basin:?}", mix.features);
        assert!(
            basin.unbroken > 1.4
                || (1..=21).any(|step| !survives(basin.unbroken + basin.tolerance * f64::from(step) / 20.0)),
            "{:?}: {basin:?}",
            mix.features
        );
    }
    assert!(one_sided > 2, "{one_sided}");
}

#[test]
fn what_does_not_survive_from_upright_has_no_basin() {
    let sinking =
        with(&scene(1.1, 0.01), &[(Name::AssumedRestitution, Some(1.0)), (Name::Restitution, Some(0.6))], None);
    assert!(matches!(find_basin(&sinking, 300, || true), Err(NoBasin::Because(why)) if why.contains("upright")));
}
