//! A strike never pulls, keeps to the friction cone, balances momentum and energy, and obeys its law of restitution along the path of
//! the contact. The checks use 31 digits and the same velocities.

use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::friction::{Friction, Impulse, Mobility, RestitutionLaw, Slide, actual_branch};
use equipoise_physics::map::strike::{ContactMode, Rod, State, Strike};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::numbers::trig;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use super::numbers::Numbers;

const LAWS: [(RestitutionLaw, &str); 3] =
    [(RestitutionLaw::Poisson, "poisson"), (RestitutionLaw::Newton, "newton"), (RestitutionLaw::Stronge, "stronge")];

/// Allowed error of an identity, in roundings of its terms.
const ROUNDINGS: f64 = 64.0;

/// A contact, and velocities just before it.
pub(crate) fn check(data: &[u8]) {
    let numbers = Numbers::read(data);
    let law = LAWS[numbers.choice("law", LAWS.len())];
    impulse(&numbers, law.0);
    strike(&numbers, law.1);
}

/// Panics unless a value is zero up to the rounding of terms of the given size.
#[track_caller]
fn zero(what: &str, size: f64, terms: f64, of: &dyn std::fmt::Debug) {
    assert!(size.abs() <= ROUNDINGS * f64::EPSILON * terms, "{what}: off by {size}, of terms of {terms}: {of:?}");
}

/// Routh's impulse alone.
fn impulse(numbers: &Numbers, law: RestitutionLaw) {
    let rod = Rod::lossless(
        numbers.within("contact_distance", 1e-3..=10.0, 0.2),
        numbers.within("radius_of_gyration", 1e-3..=10.0, 0.1),
        1.0,
    );
    let (sin, cos) = trig::sin_cos(numbers.within("beta", -10.0..=10.0, 0.2));
    let mobility = Mobility::new(&rod, sin, cos);
    let friction = Friction { coefficient: numbers.within("friction", 0.0..=10.0, 0.3), law, slide: Slide::None };
    let restitution = numbers.within("restitution", 0.0..=1.0, 1.0);
    let tangential = numbers.within("tangential", -1e6..=1e6, 0.5);
    let normal = numbers.within("normal", -1e6..=-1e-9, -1.0);
    let strike =
        |tangential, mobility: &Mobility| friction.impulse(mobility, tangential, normal, restitution, actual_branch);
    let found = strike(tangential, &mobility);
    let of = (&friction, &mobility, tangential, normal, restitution, &found);
    let coefficient = friction.coefficient;
    assert!(found.normal.is_finite() && found.normal > 0.0, "{of:?}");
    let (pressed, rubbed) = (found.normal, found.tangential);
    assert!(rubbed.abs() <= coefficient * pressed * (1.0 + ROUNDINGS * f64::EPSILON), "out of the cone: {of:?}");
    // The mirror image is equal to the last bit. A contact at rest moves the way it is driven, which is mirrored too.
    if tangential != 0.0 || mobility.cross != 0.0 {
        let image = strike(-tangential, &Mobility { cross: -mobility.cross, ..mobility });
        assert_eq!((image.normal, -image.tangential, image.mode), (pressed, rubbed, found.mode), "mirrored: {of:?}");
    }
    Path::of(&friction, &mobility, tangential, normal).hold(&found, law, restitution, &of);
}

/// Path of the contact as the normal impulse grows: it slides with one slope ∂P_t/∂P_n, and after it has come to rest it goes on with
/// another.
struct Path {
    /// Velocities before the strike, along the table and along its normal.
    velocities: [DoubleDouble; 2],
    /// Normal impulse at which the sliding ends, if it does.
    turn: Option<DoubleDouble>,
    slopes: [DoubleDouble; 2],
    mobility: Mobility<DoubleDouble>,
    friction: DoubleDouble,
}

impl Path {
    fn of(friction: &Friction, mobility: &Mobility, tangential: f64, normal: f64) -> Self {
        let number = DoubleDouble::from;
        let Mobility { tangential: a, normal: b, cross: c } = *mobility;
        let (a, b, c, mu) = (number(a), number(b), number(c), number(friction.coefficient));
        let driven = if c.to_f64() >= 0.0 { -mu } else { mu };
        let sliding = match tangential {
            0.0 => driven,
            forward if forward > 0.0 => -mu,
            _ => mu,
        };
        let rate = a * sliding + c;
        let opposes = rate.to_f64() * tangential < 0.0 || (tangential == 0.0 && rate.to_f64() * c.to_f64() <= 0.0);
        let turn = (opposes && friction.coefficient > 0.0).then(|| -number(tangential) / rate);
        let holds = friction.coefficient * mobility.tangential >= mobility.cross.abs();
        let after = if holds { -c / a } else { driven };
        Self {
            velocities: [number(tangential), number(normal)],
            turn,
            slopes: [sliding, after],
            mobility: Mobility { tangential: a, normal: b, cross: c },
            friction: mu,
        }
    }

    /// ∂v_n/∂P_n before and after the turn.
    fn rate(&self, slope: DoubleDouble) -> DoubleDouble {
        self.mobility.normal + self.mobility.cross * slope
    }

    /// P_t, the normal velocity, and the work of the normal impulse, at a normal impulse.
    fn at(&self, pressed: DoubleDouble) -> [DoubleDouble; 3] {
        let half = DoubleDouble::from(0.5);
        let [_, normal] = self.velocities;
        let turn = self.turn.filter(|turn| (*turn - pressed).to_f64() < 0.0);
        let first = turn.unwrap_or(pressed);
        let middle = normal + self.rate(self.slopes[0]) * first;
        let work = half * (normal + middle) * first;
        let rest = pressed - first;
        let end = middle + self.rate(self.slopes[1]) * rest;
        [self.slopes[0] * first + self.slopes[1] * rest, end, work + half * (middle + end) * rest]
    }

    /// The normal impulse at which compression ends.
    fn compressed(&self) -> DoubleDouble {
        let [_, normal] = self.velocities;
        let rate = self.rate(self.slopes[0]);
        match self.turn.map(|turn| (turn, normal + rate * turn)) {
            Some((turn, middle)) if middle.to_f64() < 0.0 => turn - middle / self.rate(self.slopes[1]),
            _ => -normal / rate,
        }
    }

    /// Panics unless the path ends at this impulse by its law.
    fn hold(&self, found: &Impulse, law: RestitutionLaw, restitution: f64, of: &dyn std::fmt::Debug) {
        let (number, e) = (DoubleDouble::from, DoubleDouble::from(restitution));
        let [_, normal] = self.velocities;
        let pressed = number(found.normal);
        let [rubbed, end, work] = self.at(pressed);
        let Mobility { tangential: a, normal: b, cross: c } = self.mobility;
        let rates = (b + self.friction * c.magnitude()).to_f64();
        // Rounding of the impulse: the smallest rate is a difference and has the rounding of its terms.
        let least = self.slopes.map(|slope| self.rate(slope).to_f64().abs()).into_iter().fold(rates, f64::min);
        let off = rates / least;
        let moved = rates * found.normal * off;
        zero("P_t", (number(found.tangential) - rubbed).to_f64(), (self.friction * pressed).to_f64() * off, of);
        let speed = self.velocities[0] + a * number(found.tangential) + c * pressed;
        let speeds = (a.to_f64() * self.friction.to_f64() + c.to_f64().abs()) * found.normal * off;
        match found.mode {
            ContactMode::Stick => zero("it sticks", speed.to_f64(), speeds, of),
            ContactMode::ReverseSlide => assert!(
                speed.to_f64() * self.velocities[0].to_f64() <= ROUNDINGS * f64::EPSILON * speeds * speeds,
                "it does not turn: {of:?}"
            ),
            ContactMode::Slide => assert!(
                speed.to_f64() * self.velocities[0].to_f64() >= -ROUNDINGS * f64::EPSILON * speeds * speeds,
                "it turns: {of:?}"
            ),
            ContactMode::SlideThrough => assert_eq!(self.velocities[0].to_f64(), 0.0, "{of:?}"),
            ContactMode::Frictionless => assert_eq!(found.tangential, 0.0, "{of:?}"),
        }
        let compressed = self.compressed();
        match law {
            RestitutionLaw::Newton => zero("Newton", (end + e * normal).to_f64(), moved, of),
            RestitutionLaw::Poisson => {
                zero("Poisson", (pressed - (number(1.0) + e) * compressed).to_f64(), found.normal * off, of);
            }
            RestitutionLaw::Stronge => {
                let [.., least] = self.at(compressed);
                zero("Stronge", (work - least + e * e * least).to_f64(), moved * found.normal, of);
            }
        }
        let [t, n] = [self.velocities[0] + speed, normal + end];
        let gained = (number(found.tangential) * t + pressed * n).to_f64();
        let worked = moved * found.normal + speeds * found.normal;
        assert!(
            law == RestitutionLaw::Newton || gained <= ROUNDINGS * f64::EPSILON * worked,
            "it gains {gained} of terms of {worked}: {of:?}"
        );
    }
}

/// The whole strike of a scene, with a table that tilts and moves.
fn strike(numbers: &Numbers, law: &'static str) {
    let Some(scene) = scene(numbers, law) else { return };
    let before = State {
        theta: numbers.within("theta", -7.0..=7.0, 0.1),
        x_dot: numbers.within("x_dot", -1e6..=1e6, 0.3),
        y_dot: numbers.within("y_dot", -1e6..=1e6, -1.0),
        theta_dot: numbers.within("theta_dot", -1e6..=1e6, 1.0),
    };
    let model = scene.model();
    let found = model.strike(&PreImpact::at(1, numbers.within("x", -1e3..=1e3, 0.0), before));
    let rod = model.rod;
    // As in the return map: no strike if the table would have to pull, and no run at excessive speed.
    if found.push >= 0.0 || found.approach >= 0.0 || found.speed_squared > 1e12 {
        return;
    }
    balance(&scene, &rod, &before, &found);
}

fn balance(scene: &Scene, rod: &Rod, before: &State, found: &Strike) {
    let of = (scene, before, found);
    let Strike { after, impulse_normal: pressed, impulse_tangential: rubbed, .. } = *found;
    let (sin, cos) = trig::sin_cos(found.alpha);
    let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
    let (sin_theta, cos_theta) = found.sin_cos_theta;
    let (across, along) = (l * (sin_theta * cos - cos_theta * sin), l * (cos_theta * cos + sin_theta * sin));
    assert!([pressed, rubbed, after.x_dot, after.y_dot, after.theta_dot].iter().all(|it| it.is_finite()), "{of:?}");
    assert!(pressed >= 0.0, "it pulls: {of:?}");
    let coefficient = scene.number(Name::Friction).unwrap_or_default();
    assert!(rubbed.abs() <= coefficient * pressed * (1.0 + ROUNDINGS * f64::EPSILON), "out of the cone: {of:?}");
    assert_eq!(after.theta, before.theta, "{of:?}");
    let thrust = pressed + rubbed.abs();
    let momentum = [
        ("momentum along x", after.x_dot - before.x_dot - (rubbed * cos - pressed * sin), before.x_dot.abs() + thrust),
        ("momentum along y", after.y_dot - before.y_dot - (rubbed * sin + pressed * cos), before.y_dot.abs() + thrust),
    ];
    for (what, off, terms) in momentum {
        zero(what, off, terms, &of);
    }
    // The angles have rounding errors, and so does the lever.
    let lever = l * (1.0 + before.theta.abs() + found.alpha.abs());
    let spin = (rubbed * along + pressed * across) / (rho * rho);
    let spins = before.theta_dot.abs() + thrust * lever / (rho * rho);
    zero("angular momentum", after.theta_dot - before.theta_dot - spin, spins, &of);
    let energy =
        |state: &State| 0.5 * (state.x_dot * state.x_dot + state.y_dot * state.y_dot + (rho * state.theta_dot).powi(2));
    let energies = energy(before)
        + energy(&after)
        + thrust * (before.x_dot.abs() + before.y_dot.abs())
        + thrust * thrust * (1.0 + (lever / rho).powi(2))
        + thrust * lever * before.theta_dot.abs();
    zero("energy", energy(&after) - energy(before) - found.energy_gain, energies, &of);
    if scene.value(Name::Law) != Some(Value::Choice("newton")) && coefficient != 0.0 {
        return;
    }
    // Newton's law, which equals the others without friction: v_n⁺ − v_table = −e (v_n − v_table).
    let normal = |state: &State| cos * state.y_dot - sin * state.x_dot + across * state.theta_dot;
    let table = cos * found.table_velocity.1 - sin * found.table_velocity.0;
    let speeds = before.x_dot.abs()
        + before.y_dot.abs()
        + lever * (before.theta_dot.abs() + after.theta_dot.abs())
        + table.abs()
        + thrust * (1.0 + (lever / rho).powi(2));
    let restored = normal(&after) - table + rod.restitution * (normal(before) - table);
    zero("restitution", restored, speeds, &of);
}

/// A scene of a rod; `None` if the input contradicts itself.
fn scene(numbers: &Numbers, law: &'static str) -> Option<Scene> {
    let mut draft = Draft::default();
    let still = numbers.choice("still", 2) == 1;
    let matched = numbers.choice("matched", 2) == 1;
    let energy_gain = if still { 0.0 } else { numbers.within("energy_gain", -10.0..=10.0, 0.0) };
    for (name, value) in [
        (Name::ContactDistance, numbers.within("contact_distance", 1e-3..=10.0, 0.2)),
        (Name::RadiusOfGyration, numbers.within("radius_of_gyration", 1e-3..=10.0, 0.1)),
        (Name::Gravity, numbers.within("gravity", 0.1..=100.0, 9.81)),
        (Name::Restitution, numbers.within("restitution", 0.0..=1.0, 1.0)),
        (Name::Friction, numbers.within("friction", 0.0..=10.0, 0.3)),
        (Name::EnergyGain, energy_gain),
        (Name::TargetHeight, numbers.within("target_height", 1e-3..=100.0, 0.4)),
        (Name::TiltGain, numbers.within("tilt_gain", -100.0..=100.0, 1.1)),
        (Name::Height, 50.0),
    ] {
        draft.set(name, Some(Value::Number(value))).expect("within its range");
    }
    for (name, word) in [
        (Name::Law, law),
        (Name::Strike, if still { "still" } else { "compensated" }),
        (Name::Slide, if matched { "matched" } else { "none" }),
    ] {
        draft.set(name, Some(Value::Choice(word))).expect("a word of the field");
    }
    let assumed = numbers.within("assumed_restitution", -1.0..=1.0, -1.0);
    if assumed >= 0.0 && !still {
        draft.set(Name::AssumedRestitution, Some(Value::Number(assumed))).expect("within its range");
    }
    draft.build().ok()
}
