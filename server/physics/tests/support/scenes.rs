//! Random scenes of every kind from a seed, those beyond the plain rod, upright bounces, and verdicts.

use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::analysis::evidence::{Balance, Evidence, Judgement, SMALL_RUN, Swing, evidence, judge};
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::Rod;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::support::random::Random;
use crate::support::scenes;

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

/// Parts of a scene beyond the plain rod.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Parts {
    pub(crate) feedback: bool,
    pub(crate) friction: bool,
    pub(crate) noise: Option<&'static str>,
    /// Noise of place and velocities, and scatter of restitution.
    pub(crate) further: bool,
    /// A delay between sensing and strike, in some flights longer than these.
    pub(crate) late: bool,
}

/// Mixes of them.
pub(crate) const MIXES: [Parts; 14] = [
    Parts { feedback: true, friction: false, noise: None, further: false, late: false },
    Parts { feedback: false, friction: true, noise: None, further: false, late: false },
    Parts { feedback: true, friction: true, noise: None, further: false, late: false },
    Parts { feedback: false, friction: false, noise: Some("strike"), further: false, late: false },
    Parts { feedback: false, friction: false, noise: Some("plan"), further: false, late: false },
    Parts { feedback: true, friction: true, noise: Some("strike"), further: false, late: false },
    Parts { feedback: true, friction: true, noise: Some("plan"), further: false, late: false },
    Parts { feedback: false, friction: true, noise: Some("plan"), further: false, late: false },
    Parts { feedback: false, friction: false, noise: Some("strike"), further: true, late: false },
    Parts { feedback: true, friction: true, noise: Some("strike"), further: true, late: false },
    Parts { feedback: true, friction: false, noise: Some("plan"), further: true, late: false },
    Parts { feedback: false, friction: false, noise: None, further: false, late: true },
    Parts { feedback: true, friction: true, noise: None, further: false, late: true },
    Parts { feedback: true, friction: false, noise: Some("strike"), further: true, late: true },
];

/// Sets a number of a draft.
pub(crate) fn number(draft: &mut Draft, name: Name, number: f64) {
    draft.set(name, Some(Value::Number(number))).unwrap();
}

/// A random scene with these parts, of a kind that keeps its bounces.
pub(crate) fn mixed_scene(random: &mut Random, parts: Parts) -> Scene {
    let kinds = [Kind::Regular, Kind::Feedback, Kind::Total, Kind::Juggling];
    let kinds = if parts.friction { &kinds[..3] } else { &kinds[..] };
    let kind = kinds[random.between(0.0, kinds.len() as f64) as usize];
    let plain = scenes::scene(random, kind);
    let mut draft = plain.draft();
    if parts.feedback {
        let kappa = plain.number(Name::TiltGain).unwrap();
        draft.set(Name::TiltGain, None).unwrap();
        let rod: Rod = plain.parameters();
        let speed = (2.0 * rod.gravity * (plain.release().height - rod.contact_distance)).sqrt();
        let model = upright_bounce(&rod, speed, ContactRegime::Frictionless);
        // Half of the laws hold the rod, without friction at least.
        let random_law = [random.size(0.003, 0.3), -kappa, random.size(0.003, 0.3), random.size(0.001, 0.1)];
        let law = match design_lqr(&model, [1.0, 10.0, 0.1, 0.1], 10.0) {
            Ok(design) if random.between(0.0, 1.0) < 0.5 => design.gain,
            _ => random_law,
        };
        let names = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];
        for (name, gain) in names.into_iter().zip(law) {
            number(&mut draft, name, gain);
        }
        number(&mut draft, Name::X, random.size(0.001, 0.5));
    }
    if parts.friction {
        number(&mut draft, Name::Friction, random.between(0.02, 0.8));
        let law = ["poisson", "newton", "stronge"][random.between(0.0, 3.0) as usize];
        draft.set(Name::Law, Some(Value::Choice(law))).unwrap();
        let slide = ["none", "matched"][random.between(0.0, 2.0) as usize];
        draft.set(Name::Slide, Some(Value::Choice(slide))).unwrap();
    }
    if let Some(model) = parts.noise {
        draft.set(Name::NoiseModel, Some(Value::Choice(model))).unwrap();
        number(&mut draft, Name::TimingSd, random.size(1e-4, 1e-2).abs());
        number(&mut draft, Name::AngleSd, random.size(1e-4, 1e-2).abs());
        draft.set(Name::Seed, Some(Value::Integer(random.between(0.0, 1e6) as u64))).unwrap();
    }
    if parts.further {
        for (name, largest) in [
            (Name::XSd, 1e-2),
            (Name::XDotSd, 3e-2),
            (Name::YDotSd, 3e-2),
            (Name::ThetaDotSd, 0.1),
            (Name::RestitutionSd, 0.1),
        ] {
            number(&mut draft, name, random.size(1e-4, largest).abs());
        }
    }
    if parts.late {
        let long = random.between(0.0, 1.0) < 0.3;
        number(&mut draft, Name::Delay, if long { random.between(0.05, 0.5) } else { random.size(1e-4, 0.05).abs() });
        if parts.further {
            let word = ["none", "flight"][random.between(0.0, 2.0) as usize];
            draft.set(Name::Prediction, Some(Value::Choice(word))).unwrap();
        }
    }
    draft.build().unwrap()
}

/// A rod with a contact in this regime.
pub(crate) fn body_in(rod: &Rod, regime: ContactRegime) -> Body {
    let slide = if regime == ContactRegime::Sticking { Slide::None } else { Slide::Matched };
    let rough = Friction { coefficient: 1.0, law: RestitutionLaw::Poisson, slide };
    Body { friction: (regime != ContactRegime::Frictionless).then_some(rough), ..Body::plain(*rod) }
}

/// The model of a rod that bounces upright at `speed` V > 0 (m/s) on a table that makes up the loss.
pub(crate) fn upright_bounce(rod: &Rod, speed: f64, regime: ContactRegime) -> BounceModel {
    BounceModel::rising(&body_in(rod, regime), speed, 1.0)
}

/// The verdict on a scene with its run of some contacts.
pub(crate) fn judged(scene: &Scene, impacts: u64) -> Judgement {
    judge(scene, &run_nonlinear(scene, impacts, || true).unwrap(), SMALL_RUN, || true).unwrap()
}

/// The bounce that repeats in a scene, with the motion beside it.
pub(crate) fn balance(scene: &Scene) -> Balance {
    match evidence(scene, SMALL_RUN, &mut || true).unwrap() {
        Evidence::Balances(balance) => *balance,
        other => panic!("{other:?}"),
    }
}

/// The swing of a scene's release, where it has a normal form.
pub(crate) fn swing(scene: &Scene) -> Option<Swing> {
    balance(scene).swing?.ok()
}

/// 1/(2ℓA²), contacts after which a swing that grows has left.
pub(crate) fn escape_impacts(swing: &Swing) -> f64 {
    0.5 / (swing.form.growth * swing.amplitude * swing.amplitude)
}
