//! Derivatives through impacts with friction: against differences over every mode and law, on both sides of every kind of
//! kink, under the mirror, and at the fixed point in closed form.

use crate::support::random;
use equipoise_physics::analysis::jacobian::{Linearization, jacobian};
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{ContactMode, EnergyFeedback, Rod, State, Strike};
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use nalgebra::{DMatrix, Matrix4};

use random::Random;

/// A rod whose contact has friction.
#[derive(Clone, Copy, Debug)]
struct RoughRod {
    rod: Rod,
    friction: Friction,
}

impl RoughRod {
    fn general(&self) -> Body {
        Body { friction: Some(self.friction), ..Body::plain(self.rod) }
    }

    fn strike(&self, state: &State) -> Strike {
        self.general().strike(&PreImpact::at(1, 0.0, *state))
    }
}

const LAWS: [RestitutionLaw; 3] = [RestitutionLaw::Poisson, RestitutionLaw::Newton, RestitutionLaw::Stronge];
const SLIDES: [Slide; 2] = [Slide::None, Slide::Matched];
const STEP: f64 = 1e-6;

fn model(random: &mut Random, law: RestitutionLaw, slide: Slide) -> RoughRod {
    let length = random.between(0.05, 0.5);
    let restitution = random.between(0.1, 1.0);
    let energy_gain = random.between(0.0, 0.1);
    let rod = Rod {
        contact_distance: length,
        radius_of_gyration: length * random.between(0.4, 1.2),
        gravity: 9.81,
        restitution,
        tilt_gain: random.between(-1.0, 3.0),
        strike_gain: 2.0,
        strike_gain_per_energy: (1.0 + restitution) * energy_gain,
        target_energy: 9.81 * 1.5 * length,
        energy_feedback: EnergyFeedback::Vertical,
    };
    RoughRod { rod, friction: Friction { coefficient: random.size(0.01, 1.0).abs(), law, slide } }
}

fn state(random: &mut Random) -> State {
    State {
        theta: random.between(-0.6, 0.6),
        x_dot: random.between(-1.0, 1.0),
        y_dot: random.between(-4.0, -1.0),
        theta_dot: random.between(-6.0, 6.0),
    }
}

fn shifted(rough: &RoughRod, state: &State, column: usize, step: f64) -> State {
    let rho = rough.rod.radius_of_gyration;
    let mut shifted = *state;
    match column {
        0 => shifted.theta += step / rho,
        1 => shifted.x_dot += step,
        2 => shifted.y_dot += step,
        _ => shifted.theta_dot += step / rho,
    }
    shifted
}

fn distance(one: &DMatrix<f64>, other: &DMatrix<f64>) -> f64 {
    (one - other).amax() / one.amax()
}

/// Tells whether the contact after the flight is far from grazing, near which derivatives grow without bound.
fn calm(linearization: &Linearization) -> bool {
    linearization.contact_speed < -0.5 && linearization.matrix.amax() < 50.0
}

/// The derivative by differences to one side only, extrapolated.
fn one_sided_difference(rough: &RoughRod, state: &State, column: usize, step: f64) -> [f64; 4] {
    let end = |step: f64| {
        let mut orbit = Orbit::at(rough.general(), Rules::BARE_MAP, shifted(rough, state, column, step));
        orbit.advance();
        let State { theta, x_dot, y_dot, theta_dot } = *orbit.state();
        let rho = rough.rod.radius_of_gyration;
        [rho * theta, x_dot, y_dot, rho * theta_dot]
    };
    let (here, near, far) = (end(0.0), end(step), end(2.0 * step));
    std::array::from_fn(|row| (4.0 * near[row] - 3.0 * here[row] - far[row]) / (2.0 * step))
}

/// Tells whether each column of one-sided differences agrees with one of the sides, and each side is needed. `None` if the map is
/// too curved for the differences to decide.
fn sides_are_right(rough: &RoughRod, state: &State, sides: &[&DMatrix<f64>]) -> Option<bool> {
    let mut used = vec![sides.len() == 1; sides.len()];
    let mut right = true;
    for column in 0..4 {
        for sign in [1.0, -1.0] {
            let [difference, finer] =
                [STEP, 0.5 * STEP].map(|step| one_sided_difference(rough, state, column, sign * step));
            let apart = |one: &[f64], other: &[f64]| {
                one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / sides[0].amax()
            };
            if apart(&difference, &finer) > 1e-6 {
                return None;
            }
            let off: Vec<f64> = sides.iter().map(|side| apart(side.column(column).as_slice(), &finer)).collect();
            let near = (0..sides.len()).min_by(|&a, &b| off[a].total_cmp(&off[b])).unwrap();
            right &= off[near] < 2e-6;
            used[near] |= (0..off.len()).all(|side| side == near || off[side] > 5e-6);
        }
    }
    Some(right && used.into_iter().all(|used| used))
}

/// The neighbouring doubles between which something changes.
fn change<T: PartialEq>(mut from: f64, mut to: f64, what: impl Fn(f64) -> T) -> Option<[f64; 2]> {
    let first = what(from);
    if what(to) == first {
        return None;
    }
    for _ in 0..200 {
        let middle = 0.5 * (from + to);
        if what(middle) == first { from = middle } else { to = middle }
    }
    Some([from, to])
}

fn mode(rough: &RoughRod, state: &State) -> ContactMode {
    rough.strike(state).mode
}

/// Holds the derivative at a kink against differences; counts it if they could tell.
fn look(
    rough: &RoughRod,
    state: &State,
    modes: &[ContactMode],
    counts: &mut Vec<((RestitutionLaw, Vec<ContactMode>), u32)>,
) {
    let Ok(linearization) = jacobian(&(rough.general()), state, 1) else { return };
    let sides: Vec<&DMatrix<f64>> = if linearization.one_sided.is_empty() {
        vec![&linearization.matrix]
    } else {
        linearization.one_sided.iter().map(|side| &side.matrix).collect()
    };
    assert_eq!(*sides[0], linearization.matrix);
    let mut told: Vec<ContactMode> = linearization.one_sided.iter().map(|side| side.contact_mode).collect();
    if told.is_empty() {
        told.push(linearization.contact_mode);
    }
    told.sort_by_key(|mode| mode.name());
    let mut modes = modes.to_vec();
    modes.sort_by_key(|mode| mode.name());
    assert_eq!(told, modes, "{rough:?} {state:?}");
    if !calm(&linearization) {
        return;
    }
    if let Some(right) = sides_are_right(rough, state, &sides) {
        assert!(right, "{rough:?} {state:?} {linearization:?}");
        match counts.iter_mut().find(|(kind, _)| *kind == (rough.friction.law, modes.clone())) {
            Some((_, count)) => *count += 1,
            None => counts.push(((rough.friction.law, modes), 1)),
        }
    }
}

fn assert_seen(counts: &[((RestitutionLaw, Vec<ContactMode>), u32)], modes: &[ContactMode]) {
    for law in LAWS {
        let count = counts.iter().find(|(kind, _)| kind.0 == law && kind.1 == modes).map_or(0, |(_, count)| *count);
        assert!(count >= 5, "{law:?} {modes:?}: {count}");
    }
}

#[test]
fn where_the_sliding_ends_with_the_impact_both_sides_are_told() {
    let (mut random, mut counts) = (Random::new(11), Vec::new());
    for round in 0..6000 {
        let rough = model(&mut random, LAWS[round % 3], Slide::None);
        let start = state(&mut random);
        let at = |x_dot: f64| State { x_dot, ..start };
        let to = random.between(-4.0, 4.0);
        let Some(ends) = change(start.x_dot, to, |x_dot| mode(&rough, &at(x_dot)) == ContactMode::Slide) else {
            continue;
        };
        let modes = ends.map(|x_dot| mode(&rough, &at(x_dot)));
        let speed = |x_dot: f64| rough.strike(&at(x_dot)).impulse_tangential.abs();
        if speed(ends[0]) > 0.0 && !at_rest(&rough, &at(ends[0])) {
            look(&rough, &at(ends[1]), &modes, &mut counts);
        }
    }
    println!("{counts:?}");
    assert_seen(&counts, &[ContactMode::Slide, ContactMode::Stick]);
    assert_seen(&counts, &[ContactMode::ReverseSlide, ContactMode::Slide]);
}

/// v_t = cos α ẋ + sin α ẏ + l cos β θ̇, m/s.
fn sliding(rough: &RoughRod, state: &State) -> f64 {
    let strike = rough.strike(state);
    let (sin, cos) = strike.alpha.sin_cos();
    let along = rough.rod.contact_distance * (state.theta - strike.alpha).cos();
    cos * state.x_dot + sin * state.y_dot + along * state.theta_dot
}

fn at_rest(rough: &RoughRod, state: &State) -> bool {
    sliding(rough, state).abs() < 1e-9
}

#[test]
fn a_contact_at_rest_is_a_kink_only_outside_the_stick_cone() {
    let (mut random, mut counts) = (Random::new(12), Vec::new());
    for round in 0..6000 {
        let mut rough = model(&mut random, LAWS[round % 3], Slide::None);
        rough.friction.coefficient *= if round % 2 == 0 { 0.2 } else { 1.0 };
        let start = state(&mut random);
        let at = |x_dot: f64| State { x_dot, ..start };
        let Some([_, rest]) = change(-6.0, 6.0, |x_dot| sliding(&rough, &at(x_dot)) > 0.0) else { continue };
        let modes = [-1e-6, 1e-6].map(|aside| mode(&rough, &at(rest + aside)));
        let modes = if modes == [ContactMode::Stick; 2] { &modes[..1] } else { &modes };
        look(&rough, &at(rest), modes, &mut counts);
    }
    println!("{counts:?}");
    assert_seen(&counts, &[ContactMode::Stick]);
    assert_seen(&counts, &[ContactMode::ReverseSlide, ContactMode::Slide]);
}

#[test]
fn the_edge_of_the_stick_cone_is_a_kink() {
    let (mut random, mut counts) = (Random::new(13), Vec::new());
    for round in 0..6000 {
        let rough = model(&mut random, LAWS[round % 3], SLIDES[round / 3 % 2]);
        let start = state(&mut random);
        let with = |coefficient: f64| RoughRod { friction: Friction { coefficient, ..rough.friction }, ..rough };
        let Some(ends) = change(1.0, 0.01, |friction| mode(&with(friction), &start) == ContactMode::Stick) else {
            continue;
        };
        let modes = ends.map(|friction| mode(&with(friction), &start));
        if modes[1] != ContactMode::Slide {
            look(&with(ends[0]), &start, &modes, &mut counts);
        }
    }
    println!("{counts:?}");
    assert_seen(&counts, &[ContactMode::SlideThrough, ContactMode::Stick]);
    assert_seen(&counts, &[ContactMode::ReverseSlide, ContactMode::Stick]);
}

#[test]
fn the_end_of_compression_is_a_kink_for_poisson_alone() {
    let (mut random, mut counts) = (Random::new(14), Vec::new());
    for round in 0..6000 {
        let rough = model(&mut random, LAWS[round % 3], Slide::None);
        // The same approach γ v_nc/(1 + e) without restitution: the impact ends where compression does.
        let share = 1.0 / (1.0 + rough.rod.restitution);
        let dead = Rod {
            restitution: 0.0,
            strike_gain: rough.rod.strike_gain * share,
            strike_gain_per_energy: rough.rod.strike_gain_per_energy * share,
            ..rough.rod
        };
        let dead = RoughRod { rod: dead, ..rough };
        let start = state(&mut random);
        let at = |x_dot: f64| State { x_dot, ..start };
        let to = random.between(-4.0, 4.0);
        let Some([kink, _]) = change(start.x_dot, to, |x_dot| mode(&dead, &at(x_dot)) == ContactMode::Slide) else {
            continue;
        };
        let mode = mode(&rough, &at(kink));
        if mode != ContactMode::Slide && !at_rest(&rough, &at(kink)) {
            let modes = if rough.friction.law == RestitutionLaw::Poisson { vec![mode; 2] } else { vec![mode] };
            look(&rough, &at(kink), &modes, &mut counts);
        }
    }
    println!("{counts:?}");
    for law in LAWS {
        let times = if law == RestitutionLaw::Poisson { 2 } else { 1 };
        for mode in [ContactMode::Stick, ContactMode::ReverseSlide] {
            assert!(counts.iter().any(|((l, modes), count)| *l == law && *modes == vec![mode; times] && *count >= 5));
        }
    }
}

#[test]
fn at_the_fixed_point_it_has_a_closed_form() {
    let mut random = Random::new(9);
    for round in 0..60 {
        let mut rough = model(&mut random, LAWS[round % 3], SLIDES[round / 3 % 2]);
        rough.friction.coefficient = random.between(0.01, 1.0);
        let Rod { contact_distance: l, radius_of_gyration: rho, gravity: g, tilt_gain: kappa, .. } = rough.rod;
        let v = random.between(0.5, 3.0);
        // The wanted energy is that of this bounce.
        rough.rod.target_energy = g * l + 0.5 * v * v;
        let state = State { theta: 0.0, x_dot: 0.0, y_dot: -v, theta_dot: 0.0 };
        let ours = jacobian(&(rough.general()), &state, 1).unwrap();
        assert!(ours.one_sided.is_empty() && ours.contact_mode == ContactMode::Stick);
        let (k, tau) = (rho * rho + l * l, 2.0 * v / g);
        // ẋ and θ̇ after the strike, by θ, ẋ and θ̇.
        let (x, spin) = match rough.friction.slide {
            Slide::Matched => {
                ([-2.0 * v * (kappa * rho * rho + l * l) / k, 1.0, 0.0], [-2.0 * v * l * (kappa - 1.0) / k, 0.0, 1.0])
            }
            Slide::None => (
                [-v * (2.0 * l * l + kappa * rho * rho) / k, l * l / k, -rho * rho * l / k],
                [v * l * (2.0 - kappa) / k, -l / k, rho * rho / k],
            ),
        };
        let energy = 1.0 - rough.rod.strike_gain_per_energy * v * v;
        let expected = Matrix4::new(
            1.0 + tau * spin[0],
            rho * tau * spin[1],
            0.0,
            tau * spin[2],
            x[0] / rho,
            x[1],
            0.0,
            x[2] / rho,
            0.0,
            0.0,
            energy,
            0.0,
            spin[0],
            rho * spin[1],
            0.0,
            spin[2],
        );
        let expected = DMatrix::from_fn(4, 4, |row, column| expected[(row, column)]);
        assert!(distance(&expected, &ours.matrix) < 1e-13, "{expected} {}", ours.matrix);
    }
}
