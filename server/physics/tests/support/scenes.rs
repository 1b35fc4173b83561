//! Random scenes of every kind that can be computed without friction, from a seed.

use crate::support::random::Random;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

/// Kind of a random scene, by its motion or body.
#[allow(dead_code, reason = "not every test that shares this file draws every kind")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Regular,
    Small,
    Chaotic,
    Spinning,
    Still,
    Feedback,
    Grazing,
    Point,
    /// From the whole range of the fields.
    Wide,
    /// With a gain on the total energy.
    Total,
    /// With the law that brings the energy to its target in one strike, by a belief that may be wrong.
    OneStrike,
    /// With alternating heights, one strike each.
    Juggling,
}

#[allow(dead_code, reason = "as above")]
pub(crate) const KINDS: [Kind; 12] = [
    Kind::Regular,
    Kind::Small,
    Kind::Chaotic,
    Kind::Spinning,
    Kind::Still,
    Kind::Feedback,
    Kind::Grazing,
    Kind::Point,
    Kind::Wide,
    Kind::Total,
    Kind::OneStrike,
    Kind::Juggling,
];

/// A scene of this kind.
pub(crate) fn scene(random: &mut Random, kind: Kind) -> Scene {
    match kind {
        Kind::Wide => return wide(random),
        Kind::Point => return point(random),
        _ => {}
    }
    loop {
        let length = random.between(0.05, 0.5);
        let rho = length * random.between(0.3, 1.2);
        let above = length * random.between(0.2, 2.0);
        // The residue: (κ − 1) over the width of the stable interval, Gρ²/(V²l).
        let width = rho * rho / (2.0 * above * length);
        let residue = match kind {
            Kind::Chaotic => random.between(0.5, 1.3),
            Kind::Spinning | Kind::Grazing => random.between(-0.5, 1.5),
            _ => random.between(0.05, 0.95),
        };
        let (theta, theta_dot, x_dot) = match kind {
            Kind::Regular | Kind::Still | Kind::Feedback | Kind::Total | Kind::OneStrike | Kind::Juggling => {
                (random.size(0.003, 0.2), random.size(0.001, 0.5), random.size(0.001, 0.3))
            }
            Kind::Small => (random.size(1e-7, 1e-2), random.size(1e-7, 1e-2), random.size(1e-7, 1e-2)),
            Kind::Chaotic => (random.size(0.1, 0.7), random.size(0.1, 2.0), random.size(0.01, 0.5)),
            Kind::Spinning => (random.between(-1.2, 1.2), random.size(5.0, 40.0), random.size(0.01, 1.0)),
            Kind::Grazing | Kind::Point | Kind::Wide => {
                (random.size(0.3, 1.3), random.size(0.5, 12.0), random.size(0.01, 1.0))
            }
        };
        let mut values = vec![
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, rho),
            (Name::TiltGain, 1.0 + residue * width),
            (Name::Height, length + above),
            (Name::Theta, theta),
            (Name::ThetaDot, theta_dot),
            (Name::XDot, x_dot),
            (Name::Restitution, random.between(0.2, 1.0)),
        ];
        if random.between(0.0, 1.0) < 0.3 {
            values.push((Name::Incline, random.between(0.2, 1.5)));
        }
        let mut draft = Draft::default();
        if matches!(kind, Kind::OneStrike | Kind::Juggling) {
            draft.set(Name::EnergyLaw, Some(Value::Choice("one_strike"))).unwrap();
        }
        if kind == Kind::OneStrike {
            values.push((Name::TargetHeight, length + above * random.between(0.7, 1.5)));
            if random.between(0.0, 1.0) < 0.5 {
                values.push((Name::AssumedRestitution, random.between(0.2, 1.0)));
            }
        }
        if kind == Kind::Juggling {
            let heights: Vec<f64> = (0..3).map(|_| length + above * random.between(0.7, 1.5)).collect();
            draft.set(Name::Program, HeightProgram::new(&heights).map(Value::Numbers)).unwrap();
        }
        if kind == Kind::Total {
            draft.set(Name::EnergyMeasure, Some(Value::Choice("total"))).unwrap();
        }
        if matches!(kind, Kind::Feedback | Kind::Total) {
            // Around a share of its upper bound 2/((1 + e)V²), roughly.
            values.push((Name::EnergyGain, random.between(0.02, 0.8) / (2.0 * 9.81 * above)));
            values.push((Name::TargetHeight, length + above * random.between(0.7, 1.5)));
        }
        if kind == Kind::Still {
            draft.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
        }
        for (name, number) in values {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        if let Ok(scene) = draft.build() {
            return scene;
        }
    }
}

fn wide(random: &mut Random) -> Scene {
    loop {
        let length = random.size(1e-3, 10.0).abs();
        let mut draft = Draft::default();
        for (name, number) in [
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, random.size(1e-3, 10.0).abs()),
            (Name::Gravity, random.size(0.1, 100.0).abs()),
            (Name::Incline, random.between(0.01, 1.57)),
            (Name::TiltGain, random.size(1e-3, 100.0)),
            (Name::Height, length + random.size(1e-6, 90.0).abs()),
            (Name::Theta, random.size(1e-9, 1.5)),
            (Name::ThetaDot, random.size(1e-9, 200.0)),
            (Name::XDot, random.size(1e-9, 100.0)),
            (Name::YDot, random.size(1e-9, 100.0)),
            (Name::Restitution, random.between(0.0, 1.0)),
        ] {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        match (random.between(0.0, 4.0)) as u8 {
            0 => draft.set(Name::Strike, Some(Value::Choice("still"))).unwrap(),
            1 => {
                draft.set(Name::EnergyGain, Some(Value::Number(random.size(1e-6, 10.0)))).unwrap();
                draft.set(Name::TargetHeight, Some(Value::Number(random.size(1e-3, 100.0).abs()))).unwrap();
            }
            _ => {}
        }
        if let Ok(scene) = draft.build() {
            return scene;
        }
    }
}

fn point(random: &mut Random) -> Scene {
    let mut draft = Draft::default();
    for (name, number) in [
        (Name::TiltGain, random.between(-0.01, 1.01)),
        (Name::Incline, random.between(0.1, 1.57)),
        (Name::Height, random.between(0.01, 1.0)),
        (Name::XDot, random.size(1e-3, 1.0)),
    ] {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    draft.build().unwrap()
}
