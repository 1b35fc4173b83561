//! Periodic orbits against what is known of them exactly: the symmetric family, κ_c, the sign and size of C.

use equipoise_physics::analysis::basin::find_basin;
use equipoise_physics::analysis::boundary::{boundary_coefficient, symmetric_orbit};
use equipoise_physics::analysis::jacobian::{eigenvalues, jacobian, jacobian_at};
use equipoise_physics::analysis::periodic_orbits::branch::{Branch, BranchStart, ParameterRange, follow};
use equipoise_physics::analysis::periodic_orbits::multipliers::{Bifurcation, Multipliers};
use equipoise_physics::analysis::periodic_orbits::{OrbitFailure, OrbitProblem, PeriodicOrbit, find};
use equipoise_physics::analysis::repeating;
use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use nalgebra::Complex;
use random::Random;

use crate::paper;
use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random;
use crate::support::rig::with;

fn scene(values: &[(Name, f64)]) -> Scene {
    with(paper::scene(1.1, 0.0).draft(), values)
}

fn critical(scene: &Scene) -> f64 {
    small_deviations(scene).unwrap().linear.critical_tilt_gain
}

fn tilt(
    scene: &Scene,
    period: usize,
    start: BranchStart,
    from: f64,
    to: f64,
    points: usize,
) -> Result<Branch, OrbitFailure> {
    follow(&ParameterRange { scene, name: Name::TiltGain, from, to }, period, start, points, || true)
}

/// ρ of the true triangle, whose boundary is hard.
const TRIANGLE: f64 = 0.051_370_116_691_408_15;

#[test]
fn the_symmetric_family_is_a_solution_as_it_stands() {
    for (kappa, theta) in [(1.55, 0.1), (1.55, 0.4), (1.3, 0.2), (1.7, -0.6), (1.52, 1e-3)] {
        let scene = scene(&[(Name::TiltGain, kappa)]);
        let setting = OrbitProblem::of(&scene).unwrap();
        let state = symmetric_orbit(&setting.body, theta).unwrap();
        let own = OrbitProblem { energy: Some(setting.body.rod.energy(&state)), ..setting };
        let orbit = find(&own, 2, &state).unwrap();
        assert!(orbit.residual < 1e-12, "{kappa} {theta}: {}", orbit.residual);
        assert_eq!(orbit.least_period, 2);
        let [one, other] = orbit.states[..] else { panic!() };
        for (found, exact) in [(one.theta, state.theta), (one.x_dot, state.x_dot), (one.y_dot, state.y_dot)] {
            assert!((found - exact).abs() < 1e-11, "{kappa} {theta}: {found} {exact}");
        }
        assert!((one.theta + other.theta).abs() < 1e-11 && orbit.drift.abs() < 1e-12);
        // From a little aside it comes back to an orbit of the same energy.
        let aside = State { theta: state.theta * 1.0001, ..state };
        let again = find(&own, 2, &aside).unwrap();
        assert!(again.residual < 1e-12 && again.drift.abs() < 1e-12);
    }
}

#[test]
fn the_upright_bounce_has_the_residue_of_the_closed_form() {
    for values in [vec![], vec![(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25)]] {
        for kappa in [0.95, 1.1, 1.3, 1.7] {
            let scene = scene(&[values.clone(), vec![(Name::TiltGain, kappa)]].concat());
            let setting = OrbitProblem::of(&scene).unwrap();
            let orbit = find(&setting, 1, &setting.upright()).unwrap();
            let linear = small_deviations(&scene).unwrap().linear;
            assert!((orbit.multipliers.residue.unwrap() - linear.residue.unwrap()).abs() < 1e-10, "{kappa}");
            assert_eq!(orbit.multipliers.stable, Some(linear.says_bounded()), "{kappa}");
        }
    }
}

#[test]
fn the_upright_bounce_changes_at_the_closed_forms() {
    for values in [vec![], vec![(Name::RadiusOfGyration, TRIANGLE)]] {
        let scene = scene(&values);
        let critical = critical(&scene);
        let branch = tilt(&scene, 1, BranchStart::Upright, 0.9, critical + 0.2, 200).unwrap();
        let changes: Vec<_> = branch.points.iter().filter_map(|point| Some((point.change?, point.parameter))).collect();
        assert_eq!(
            changes.iter().map(|change| change.0).collect::<Vec<_>>(),
            [Bifurcation::Pitchfork, Bifurcation::PeriodDoubling]
        );
        assert!(
            (changes[0].1 - 1.0).abs() < 1e-10 && (changes[1].1 - critical).abs() < 1e-10,
            "{changes:?} {critical}"
        );
    }
}

#[test]
fn the_branch_springs_from_the_critical_gain_to_its_side() {
    for (rho, soft) in [(2f64.sqrt() / 15.0, true), (TRIANGLE, false)] {
        let scene = scene(&[(Name::RadiusOfGyration, rho)]);
        let fixed_point = small_deviations(&scene).unwrap().fixed_point;
        let critical = critical(&scene);
        let coefficient = boundary_coefficient(&scene.model(), &fixed_point).unwrap();
        assert_eq!(coefficient > 0.0, soft);
        let branch = tilt(&scene, 2, BranchStart::Symmetric(0.03), critical - 0.02, critical + 0.05, 60).unwrap();
        let spring = &branch.points[0];
        assert!(spring.springs && spring.change == Some(Bifurcation::PeriodDoubling), "{:?}", branch.ends);
        assert!((spring.parameter - critical).abs() < 1e-10, "{} {critical}", spring.parameter);
        for point in branch.points.iter().filter(|point| (1e-3..0.05).contains(&point.orbit.max_theta())) {
            let theta = point.orbit.max_theta();
            let slope = (point.parameter - critical) / (theta * theta) / (critical - 1.0);
            assert!((slope - coefficient).abs() < 0.03 + 30.0 * theta * theta, "{theta}: {slope} {coefficient}");
            assert_eq!(point.orbit.multipliers.stable, Some(soft), "{theta}");
            assert_eq!(point.orbit.multipliers.residue.unwrap() > 0.0, soft);
            assert!(point.orbit.residual < 1e-11);
        }
    }
}

#[test]
fn with_energy_feedback_the_branch_is_hard() {
    let values =
        [(Name::Restitution, 0.5), (Name::EnergyGain, 0.165), (Name::TargetHeight, 0.25), (Name::Incline, 0.785)];
    let scene = scene(&values);
    let critical = critical(&scene);
    let coefficient = boundary_coefficient(&scene.model(), &small_deviations(&scene).unwrap().fixed_point).unwrap();
    let branch = tilt(&scene, 2, BranchStart::Symmetric(0.03), critical - 0.05, critical + 0.05, 60).unwrap();
    assert!((branch.points[0].parameter - critical).abs() < 1e-10, "{:?}", branch.ends);
    let point = &branch.points[branch.start];
    let slope = (point.parameter - critical) / (0.03 * 0.03) / (critical - 1.0);
    assert!((slope - coefficient).abs() < 0.05, "{slope} {coefficient}");
    assert_eq!(point.orbit.multipliers.stable, Some(false));
}

#[test]
fn a_branch_goes_round_its_fold_and_changes_are_where_the_residue_vanishes() {
    let scene = scene(&[(Name::RadiusOfGyration, TRIANGLE)]);
    let critical = critical(&scene);
    let branch = tilt(&scene, 2, BranchStart::Symmetric(0.03), critical - 0.05, critical + 0.5, 400).unwrap();
    let changes: Vec<_> = branch.points.iter().filter(|point| point.change.is_some()).collect();
    let kinds: Vec<_> = changes.iter().map(|point| point.change.unwrap()).collect();
    assert_eq!(kinds, [Bifurcation::PeriodDoubling, Bifurcation::Fold, Bifurcation::Pitchfork], "{:?}", branch.ends);
    assert!(changes.iter().all(|point| point.orbit.multipliers.residue.unwrap().abs() < 1e-10));
    assert!(changes.iter().all(|point| point.orbit.multipliers.stable.is_none()));
    // The fold is the least parameter of the branch, and hard becomes soft there.
    let fold = changes[1];
    assert!(branch.points.iter().all(|point| point.parameter >= fold.parameter - 1e-12));
    for point in &branch.points {
        let theta = point.orbit.max_theta();
        let between = theta > fold.orbit.max_theta() && theta < changes[2].orbit.max_theta();
        assert!(point.change.is_some() || point.orbit.multipliers.stable == Some(between), "{theta}");
    }
    assert!(branch.ends[1].contains("separating"), "{:?}", branch.ends);
}

#[test]
fn what_has_no_orbit_says_why() {
    let scene = scene(&[]);
    let setting = OrbitProblem::of(&scene).unwrap();
    let far = State { theta: 0.9, x_dot: 0.5, y_dot: -0.2, theta_dot: 3.0 };
    assert!(matches!(find(&setting, 3, &far), Err(OrbitFailure::Ends { .. } | OrbitFailure::NoConvergence { .. })));
    let beside = tilt(&scene, 2, BranchStart::Symmetric(0.1), 1.1, 1.2, 10).unwrap_err();
    assert!(beside.to_string().contains("no mirror-symmetric orbit"), "{beside}");
    let sweep = ParameterRange { scene: &scene, name: Name::TiltGain, from: 1.1, to: 1.2 };
    assert_eq!(follow(&sweep, 1, BranchStart::Upright, 10, || false).unwrap_err(), OrbitFailure::Cancelled);
}

/// From a guess to an orbit of the scene, which the run itself confirms.
fn come_back(kappa: f64, period: usize, theta: f64, x_dot: f64) -> PeriodicOrbit {
    let scene = scene(&[(Name::TiltGain, kappa)]);
    let setting = OrbitProblem::of(&scene).unwrap();
    let guess = State { theta, x_dot, y_dot: -setting.speed, theta_dot: 0.0 };
    let orbit = find(&setting, period, &guess).unwrap();
    assert_eq!(orbit.least_period, period);
    let mut run = Orbit::at(Body::plain(setting.body.rod), scene.rules(), orbit.states[0]);
    for n in 0..period {
        let (there, here) = (orbit.states[n], *run.state());
        assert!((there.theta - here.theta).abs() < 1e-11 && (there.y_dot - here.y_dot).abs() < 1e-11, "{n}");
        assert!(run.advance().ending.is_none());
    }
    let (start, end) = (orbit.states[0], *run.state());
    for (start, end) in [(start.theta, end.theta), (start.x_dot, end.x_dot), (start.theta_dot, end.theta_dot)] {
        assert!((start - end).abs() < 1e-11, "{start} {end}");
    }
    orbit
}

#[test]
fn orbits_of_period_three_and_four_spring_from_the_resonances() {
    // R = (κ − 1)/(κ_c − 1) = 1/2 at κ = 1.25: a pair, one stable and wide, one unstable, whose angle goes to 0 there as √.
    let mut last = f64::INFINITY;
    for (kappa, theta, wide) in [(1.27, 0.055, 0.11), (1.265, 0.04, 0.075), (1.26, 0.025, 0.055)] {
        let (unstable, stable) = (come_back(kappa, 4, theta, 0.4), come_back(kappa, 4, wide, 0.4));
        assert_eq!((unstable.multipliers.stable, stable.multipliers.stable), (Some(false), Some(true)), "{kappa}");
        assert!(unstable.max_theta() < stable.max_theta() && unstable.max_theta() < last);
        last = unstable.max_theta();
        let per_root = unstable.max_theta() / (kappa - 1.25).sqrt();
        assert!((1.0..1.1).contains(&per_root), "{kappa}: {per_root}");
        let at_rest = unstable.states.iter().any(|state| state.x_dot.abs() < 1e-12 && state.theta_dot.abs() < 1e-12);
        assert!(at_rest);
        if kappa > 1.26 {
            // It is what cuts the dent into the survival map: released at rest inside it a body stays, beyond it falls. Nearer
            // to the resonance the stable one still catches it.
            let basin = find_basin(&paper::scene(kappa, 0.01), 1000, || true).unwrap().unbroken;
            assert!((basin / unstable.max_theta() - 1.0).abs() < 0.05, "{kappa}: {basin}");
        }
    }
    // R = 3/4 at κ = 1.375.
    let angles =
        [(1.38, 0.005), (1.39, 0.015), (1.4, 0.02)].map(|(kappa, theta)| come_back(kappa, 3, theta, 0.4).max_theta());
    assert!(angles[0] < angles[1] && angles[1] < angles[2] && angles[0] < 0.13, "{angles:?}");
}

/// With energy feedback nothing holds the energy of the orbit, and a body at rest comes back to where it is as well.
#[test]
fn a_body_at_rest_is_no_orbit() {
    let scene = scene(&[
        (Name::ContactDistance, 0.133_333_333_333_333_33),
        (Name::RadiusOfGyration, 0.0943),
        (Name::Restitution, 0.8),
        (Name::TiltGain, 1.586_879_881_383_113_3),
        (Name::EnergyGain, 0.293_585_777_945_332_1),
        (Name::TargetHeight, 0.2),
        (Name::Height, 0.2),
        (Name::Theta, 0.1),
    ]);
    let guess = State {
        theta: -0.287_964_957_657_113_1,
        x_dot: 0.0,
        y_dot: -0.809_501_632_179_172_8,
        theta_dot: 2.022_569_393_062_793,
    };
    let found = find(&OrbitProblem::of(&scene).unwrap(), 2, &guess);
    assert!(matches!(found, Err(OrbitFailure::AtRest { .. })), "{found:?}");
}

/// The largest difference between the eigenvalues of an orbit and those of the derivative over its period.
fn off_the_jacobian(setting: &OrbitProblem, orbit: &PeriodicOrbit) -> f64 {
    off_the_jacobian_of(&Body::plain(setting.body.rod), orbit)
}

fn off_the_jacobian_of(model: &Body, orbit: &PeriodicOrbit) -> f64 {
    let matrix = jacobian(model, &orbit.states[0], orbit.states.len() as u64).unwrap().matrix;
    let mut expected = eigenvalues(&matrix).unwrap();
    let mut largest: f64 = 0.0;
    for found in &orbit.multipliers.eigenvalues {
        let away = |value: &Complex<f64>| (value - found).norm();
        let (place, _) =
            expected.iter().enumerate().min_by(|one, other| away(one.1).total_cmp(&away(other.1))).unwrap();
        largest = largest.max(away(&expected.swap_remove(place)) / found.norm().max(1.0));
    }
    largest
}

#[test]
fn with_energy_feedback_eigenvalues_are_those_of_the_derivative() {
    let scene = scene(&[(Name::TiltGain, 1.24), (Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2)]);
    let setting = OrbitProblem::of(&scene).unwrap();
    let orbit = find(&setting, 4, &State { theta: 0.2, x_dot: 0.0, y_dot: -1.1, theta_dot: 0.0 }).unwrap();
    assert!(off_the_jacobian(&setting, &orbit) < 1e-8, "{:?}", orbit.multipliers);
    // No eigenvalue is 1, which was imposed once.
    let one = Complex::new(1.0, 0.0);
    let nearest = orbit.multipliers.eigenvalues.iter().map(|value| (value - one).norm()).fold(f64::INFINITY, f64::min);
    assert!((nearest - 0.0019).abs() < 1e-4, "{:?}", orbit.multipliers);
    // Other orbits along a branch, and the upright bounce, whose drift has the eigenvalue 1.
    let branch = tilt(&scene, 2, BranchStart::Symmetric(0.1), 1.2, 1.6, 40).unwrap();
    assert!(branch.points.len() > 10);
    for point in branch.points.iter().filter(|point| point.change.is_none()) {
        let setting = OrbitProblem::of(&self::scene(&[
            (Name::TiltGain, point.parameter),
            (Name::EnergyGain, 0.2),
            (Name::TargetHeight, 0.2),
        ]))
        .unwrap();
        let off = off_the_jacobian(&setting, &point.orbit);
        assert!(off < 1e-6, "{}: {off} {:?}", point.parameter, point.orbit.multipliers);
    }
    let upright = find(&setting, 1, &setting.upright()).unwrap();
    assert!(upright.multipliers.eigenvalues.contains(&one) && off_the_jacobian(&setting, &upright) < 1e-12);
}

fn rough(slide: &'static str, values: &[(Name, f64)]) -> Scene {
    let mut draft = scene(values).draft();
    draft.set(Name::Slide, Some(Value::Choice(slide))).unwrap();
    draft.build().unwrap()
}

#[test]
fn a_matched_contact_that_sticks_has_the_symmetric_family_too() {
    let mut random = Random::new(3);
    let (mut found, mut slides) = (0, 0);
    while found < 200 {
        let l = random.between(0.05, 0.4);
        let rho = l * random.between(0.2, 1.2);
        let values = [
            (Name::ContactDistance, l),
            (Name::RadiusOfGyration, rho),
            (Name::Height, l * random.between(1.2, 3.0)),
            (Name::Friction, random.between(0.1, 0.9)),
            (Name::Restitution, random.between(0.2, 1.0)),
            (Name::TiltGain, random.between(1.2, 4.0)),
        ];
        let scene = rough("matched", &values);
        let setting = OrbitProblem::of(&scene).unwrap();
        let theta = random.between(-0.5, 0.5);
        let Some(state) = symmetric_orbit(&setting.body, theta) else {
            slides += 1;
            continue;
        };
        let own = OrbitProblem { energy: Some(setting.body.rod.energy(&state)), ..setting };
        let Ok(orbit) = find(&own, 2, &state) else { continue };
        found += 1;
        assert!((orbit.states[0].theta - theta).abs() < 1e-9 && orbit.residual < 1e-11, "{scene:?}");
        assert!(off_by_31_digits(&scene, &orbit) < 1e-9, "{scene:?}");
        // As without friction, two eigenvalues are 1.
        let ones = orbit.multipliers.eigenvalues.iter().filter(|value| **value == Complex::new(1.0, 0.0)).count();
        assert_eq!(ones, 2, "{:?} {scene:?}", orbit.multipliers);
        let size = orbit.multipliers.spectral_radius();
        assert!(off_the_jacobian_of(&scene.model(), &orbit) < 1e-3 * size, "{:?} {scene:?}", orbit.multipliers);
    }
    assert!(slides > 20, "{slides}");
}

#[test]
fn orbits_with_friction_are_followed_and_are_those_of_the_map() {
    // Softly beyond κ_c = 2.5 of the paper's body on a matched table, and orbits of period 4 of one that only tilts, with energy feedback.
    let matched = rough("matched", &[(Name::Friction, 0.3), (Name::TiltGain, 2.5)]);
    let branch = tilt(&matched, 2, BranchStart::Symmetric(0.05), 2.45, 2.7, 60).unwrap();
    assert!(branch.points.len() > 20);
    for point in &branch.points {
        let there = rough("matched", &[(Name::Friction, 0.3), (Name::TiltGain, point.parameter)]);
        assert!(off_by_31_digits(&there, &point.orbit) < 1e-9, "{}", point.parameter);
        assert!(
            point.change.is_some() || point.orbit.multipliers.stable == Some(true),
            "{:?}",
            point.orbit.multipliers
        );
    }
    let springs = branch.points.iter().find(|point| point.springs).expect("the branch springs from the upright bounce");
    assert!((springs.parameter - 2.5).abs() < 1e-6, "{}", springs.parameter);
    let tilting = rough("none", &[(Name::Friction, 0.05), (Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2)]);
    let setting = OrbitProblem::of(&tilting).unwrap();
    let upright = find(&setting, 1, &setting.upright()).unwrap();
    assert!(off_by_31_digits(&tilting, &upright) < 1e-12 && upright.multipliers.stable == Some(false), "{upright:?}");
    assert!(off_the_jacobian_of(&tilting.model(), &upright) < 1e-9, "{:?}", upright.multipliers);
    assert_eq!(symmetric_orbit(&setting.body, 0.1), None);
}

/// Largest change of a contact over its period by the map with 31 digits, over its speed.
fn off_by_31_digits(scene: &Scene, orbit: &PeriodicOrbit) -> f64 {
    let model = scene.model();
    let map = ReturnMap::new(&model, orbit.states.len() as u64);
    let start = map.vector(&orbit.states[0], orbit.places[0]);
    let late = model.lag > map.shortest_flight(&start);
    let (map, start) = if late { (map.planning(), map.planning().planned(&start)) } else { (map, start) };
    let Some(end) = map.image(&start.map(DoubleDouble::from)) else { return f64::INFINITY };
    let off = |index: usize| (end[index] - DoubleDouble::from(start[index])).to_f64().abs();
    map.components().into_iter().map(off).fold(0.0, f64::max) / orbit.states[0].y_dot.abs()
}

#[test]
fn any_mix_of_features_has_its_bounce_as_an_orbit() {
    let mut random = Random::new(21);
    let from = all_but(&[]);
    let (mut found, mut beyond, mut missing) = (0, 0, Vec::new());
    let (mut points, mut noisy) = (0, 0);
    while found < 250 {
        let mix = Mix::draw(&mut random, Swing::Calm, &from);
        let Ok(setting) = OrbitProblem::of(&mix.scene) else { continue };
        // An orbit is of the map without random errors.
        let scene = mix.scene.without_noise();
        let period = mix.scene.program().map_or(1, |program| program.heights().len());
        let orbit = match find(&setting, period, &setting.upright()) {
            Ok(orbit) => orbit,
            Err(_) => {
                // No bounce repeats, or one at which something ends.
                if let Ok(bounce) = repeating::of_scene(&scene) {
                    missing.push((mix.features.clone(), bounce.at));
                }
                continue;
            }
        };
        found += 1;
        beyond += u32::from(!setting.is_rod);
        points += u32::from(mix.has(&["point mass"]));
        noisy += u32::from(mix.has(&RANDOM));
        let off = off_by_31_digits(&scene, &orbit);
        assert!(off < 1e-10, "{off:e} {:?} {orbit:?}", mix.features);
        if !setting.is_rod {
            let start = orbit.states[0];
            let exact = jacobian_at(&scene.model(), orbit.places[0], &start, period as u64).unwrap();
            if exact.one_sided.is_empty() && exact.matrix.nrows() == orbit.multipliers.eigenvalues.len() {
                // An eigenvalue 1 of a defective matrix is known to some digits.
                for value in eigenvalues(&exact.matrix).unwrap() {
                    let away = |other: &Complex<f64>| (value - other).norm();
                    let nearest = orbit.multipliers.eigenvalues.iter().map(away).fold(f64::INFINITY, f64::min);
                    assert!(
                        nearest < 1e-3 * (1.0 + value.norm()),
                        "{value} {:?} {:?}",
                        mix.features,
                        orbit.multipliers
                    );
                }
            }
        }
    }
    println!("{beyond} of {found}, missing {missing:?}");
    assert!(beyond > 60 && missing.len() * 20 < found, "{beyond} {missing:?}");
    assert!(points > 10 && noisy > 10, "{points} {noisy}");
}

/// The angle of the velocity of a point mass becomes 1 − 2κ of itself at each bounce, eq. (4): the drift dies out for 0 < κ < 1 and changes its sign
/// for ever at κ = 1, where an orbit of period 2 is free.
#[test]
fn the_bounce_of_a_point_mass_has_the_multiplier_of_its_angle() {
    let point = |kappa: f64| {
        let mut draft = Draft::default();
        draft.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
        with(draft, &[(Name::TiltGain, kappa), (Name::Height, 0.2), (Name::XDot, 0.1)])
    };
    for kappa in [0.2, 0.5, 0.9, 1.2, -0.1] {
        let setting = OrbitProblem::of(&point(kappa)).unwrap();
        let orbit = find(&setting, 1, &setting.upright()).unwrap();
        let Multipliers { eigenvalues, residue, stable, .. } = &orbit.multipliers;
        let beside =
            eigenvalues.iter().map(|value| (value.re - (1.0 - 2.0 * kappa)).abs()).fold(f64::INFINITY, f64::min);
        assert!(beside < 1e-12 && eigenvalues.len() == 2, "{eigenvalues:?}");
        assert_eq!((*residue, *stable), (None, Some((0.0..=1.0).contains(&kappa))), "{kappa}");
    }
    let branch = tilt(&point(0.5), 1, BranchStart::Upright, 0.5, 1.3, 60).unwrap();
    let change = branch.points.iter().find(|point| point.change.is_some()).unwrap();
    assert_eq!(change.change, Some(Bifurcation::PeriodDoubling));
    assert!((change.parameter - 1.0).abs() < 1e-9, "{}", change.parameter);
}

#[test]
fn orbits_of_other_bodies_change_where_their_linear_analysis_says() {
    // In air that takes the spin the end of the gains is known in closed form, and the orbit of period 2 springs from it.
    let dragged = scene(&[(Name::RotationDrag, 0.3), (Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2)]);
    let critical = critical(&dragged);
    let branch = tilt(&dragged, 1, BranchStart::Upright, 1.05, critical + 0.1, 100).unwrap();
    let change = branch.points.iter().find(|point| point.change.is_some()).unwrap();
    assert_eq!(change.change, Some(Bifurcation::PeriodDoubling), "{:?}", branch.ends);
    assert!((change.parameter - critical).abs() < 1e-9, "{} {critical}", change.parameter);
    let twice = tilt(&dragged, 2, BranchStart::Symmetric(0.05), critical - 0.1, critical + 0.1, 60).unwrap();
    let spring = twice.points.iter().find(|point| point.springs).expect("the branch springs from the bounce");
    assert!((spring.parameter - critical).abs() < 1e-9, "{} {critical}", spring.parameter);
    for point in &twice.points {
        let there = with(dragged.draft(), &[(Name::TiltGain, point.parameter)]);
        assert!(off_by_31_digits(&there, &point.orbit) < 1e-10);
    }
    // The branch is hard: a run from beside it leaves by its largest eigenvalue each period.
    let hard = twice.points.iter().find(|point| point.orbit.max_theta() > 0.1).unwrap();
    assert_eq!(hard.orbit.multipliers.stable, Some(false));
    let there = with(dragged.draft(), &[(Name::TiltGain, hard.parameter)]);
    let map = ReturnMap::new(&there.model(), 2);
    let at = map.vector(&hard.orbit.states[0], 0.0).map(DoubleDouble::from);
    let (mut one, mut other) = (at, at);
    other[0] = other[0] + DoubleDouble::from(1e-15);
    let mut apart = Vec::new();
    for _ in 0..40 {
        (one, other) = (map.image(&one).unwrap(), map.image(&other).unwrap());
        apart.push((other[0] - one[0]).to_f64());
    }
    let grown = apart[39] / apart[38];
    let largest = hard.orbit.multipliers.eigenvalues[0].re;
    assert!((grown / largest - 1.0).abs() < 1e-4, "{grown} {largest}");
    // State feedback of the place too: where a pair of the closed loop leaves the circle.
    let mut draft = scene(&[]).draft();
    for (name, value) in [
        (Name::TiltGain, None),
        (Name::FeedbackX, Some(0.03)),
        (Name::FeedbackTheta, Some(-1.2)),
        (Name::FeedbackXDot, Some(0.03)),
        (Name::FeedbackThetaDot, Some(-0.02)),
    ] {
        draft.set(name, value.map(Value::Number)).unwrap();
    }
    let fed = draft.build().unwrap();
    let radius = |gain: f64| {
        let there = with(fed.draft(), &[(Name::FeedbackX, gain)]);
        small_deviations(&there).unwrap().linear.spectral_radius()
    };
    let range = ParameterRange { scene: &fed, name: Name::FeedbackX, from: 0.005, to: 3.0 };
    let branch = follow(&range, 1, BranchStart::Upright, 200, || true).unwrap();
    for point in &branch.points {
        let bounded = radius(point.parameter) < 1.0;
        assert!(point.change.is_some() || point.orbit.multipliers.stable == Some(bounded), "{}", point.parameter);
        if point.change.is_some() {
            assert!((radius(point.parameter) - 1.0).abs() < 1e-9, "{:?} {}", point.change, point.parameter);
        }
    }
    assert!(branch.points.iter().any(|point| point.change.is_some()), "{:?}", branch.ends);
}
