//! Random scenes beyond the plain rod: with state feedback, friction and noise, alone and together.

use crate::support::random::Random;
use crate::support::scenes;
use crate::support::scenes::Kind;
use crate::support::upright::upright_bounce;
use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::map::strike::Rod;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

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
pub(crate) fn scene(random: &mut Random, parts: Parts) -> Scene {
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
