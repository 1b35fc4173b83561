//! Random mixes of the features that a scene may have beyond the plain rod. A new feature gets a row here.

use crate::support::random::Random;
use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

/// Range of a number.
#[derive(Clone, Copy)]
enum Range {
    Between(f64, f64),
    /// Uniform in its logarithm, of either sign.
    Size(f64, f64),
    /// The same above 0.
    Above(f64, f64),
    /// Height of the release above upright contact, as a share of it.
    Height(f64, f64),
    /// As a share of the upper bound of the energy gain.
    EnergyGain(f64, f64),
    /// As a share of the contact distance.
    Length(f64, f64),
    /// −κ.
    TiltGain,
    /// In three of ten cases longer than many flights, s.
    Delay,
}

use Range::{Above, Between, Delay, EnergyGain, Height, Length, Size, TiltGain};

/// A feature: its name, a group of which a scene has at most one, and its fields.
struct Feature(&'static str, &'static str, &'static [(Name, Range)], &'static [(Name, &'static [&'static str])]);

const LAWS: (Name, &[&str]) = (Name::Law, &["poisson", "newton", "stronge"]);
const FRICTION: (Name, Range) = (Name::Friction, Above(0.01, 1.0));
const DEPTH: (Name, Range) = (Name::PivotDepth, Size(0.001, 0.1));
const PLACE: (Name, Range) = (Name::PivotX, Size(0.001, 0.3));
const TARGET: (Name, Range) = (Name::TargetHeight, Height(0.8, 1.3));
const GAIN: (Name, Range) = (Name::EnergyGain, EnergyGain(0.05, 0.6));
const ANGLE_SD: (Name, Range) = (Name::AngleSd, Above(1e-4, 1e-2));
const TIMING: &[(Name, Range)] = &[(Name::TimingSd, Above(1e-4, 1e-2)), ANGLE_SD];
const SPIN_GAIN: (Name, Range) = (Name::FeedbackThetaDot, Size(0.0001, 0.005));
const LIMITS: &[(Name, Range)] = &[(Name::TiltLimit, Between(0.1, 0.6)), (Name::TiltRateLimit, Between(0.5, 4.0))];

const FEATURES: [Feature; 32] = [
    Feature("angle bias", "", &[(Name::AngleBias, Size(1e-4, 0.01))], &[]),
    Feature("tilt offset", "", &[(Name::TiltOffset, Size(1e-4, 0.01))], &[]),
    Feature("gain error", "", &[(Name::TiltGainError, Size(1e-3, 0.05))], &[]),
    Feature("speed error", "", &[(Name::SpeedError, Size(1e-3, 0.2))], &[]),
    Feature("offset", "", &[(Name::Offset, Length(1e-4, 0.05))], &[]),
    Feature("wrong belief", "", &[(Name::AssumedRestitution, Between(0.3, 1.0))], &[]),
    Feature("delay", "delay", &[(Name::Delay, Delay)], &[]),
    Feature("predicted delay", "delay", &[(Name::Delay, Delay)], &[(Name::Prediction, &["flight"])]),
    Feature("turning", "turning", &[DEPTH], &[(Name::TiltRate, &["follows"])]),
    Feature("turning in place", "turning", &[DEPTH, PLACE], &[(Name::TiltRate, &["follows"])]),
    Feature("turning, corrected", "turning", &[DEPTH, PLACE], &[(Name::TiltRate, &["corrected"])]),
    Feature("drag", "air", &[(Name::Drag, Above(1e-3, 3.0))], &[]),
    Feature("wind", "air", &[(Name::Drag, Above(1e-3, 3.0)), (Name::Wind, Size(0.01, 1.0))], &[]),
    Feature("rotation drag", "", &[(Name::RotationDrag, Above(1e-3, 3.0))], &[]),
    Feature("vertical energy", "energy", &[GAIN, TARGET], &[]),
    Feature("total energy", "energy", &[GAIN, TARGET], &[(Name::EnergyMeasure, &["total"])]),
    Feature("one strike", "energy", &[TARGET], &[(Name::EnergyLaw, &["one_strike"])]),
    Feature("program", "energy", &[], &[(Name::EnergyLaw, &["one_strike"])]),
    Feature("friction", "friction", &[FRICTION], &[LAWS]),
    Feature("matched friction", "friction", &[FRICTION], &[LAWS, (Name::Slide, &["matched"])]),
    Feature(
        "feedback",
        "feedback",
        &[
            (Name::FeedbackX, Size(0.01, 0.2)),
            (Name::FeedbackTheta, TiltGain),
            (Name::FeedbackXDot, Size(0.001, 0.05)),
            SPIN_GAIN,
        ],
        &[],
    ),
    Feature("feedback of the angle", "feedback", &[(Name::FeedbackTheta, TiltGain), SPIN_GAIN], &[]),
    Feature("still", "", &[], &[(Name::Strike, &["still"])]),
    Feature("incline", "", &[(Name::Incline, Between(0.2, 1.5))], &[]),
    Feature("triangle", "", &[], &[]),
    Feature("point mass", "", &[], &[]),
    Feature("length", "", &[(Name::TableLength, Between(0.2, 4.0))], &[]),
    Feature("limits", "", LIMITS, &[]),
    Feature("timing", "noise", TIMING, &[(Name::NoiseModel, &["strike"])]),
    Feature("plan", "noise", TIMING, &[(Name::NoiseModel, &["plan"])]),
    Feature(
        "sensing",
        "noise",
        &[
            ANGLE_SD,
            (Name::XSd, Above(1e-4, 0.01)),
            (Name::XDotSd, Above(1e-4, 0.03)),
            (Name::YDotSd, Above(1e-4, 0.05)),
            (Name::ThetaDotSd, Above(1e-4, 0.1)),
        ],
        &[],
    ),
    Feature("scatter", "noise", &[(Name::RestitutionSd, Above(1e-4, 0.05))], &[]),
];

/// Features that draw random numbers in each run.
pub(crate) const RANDOM: [&str; 4] = ["timing", "plan", "sensing", "scatter"];

/// All features but these.
pub(crate) fn all_but(left_out: &[&str]) -> Vec<&'static str> {
    FEATURES.iter().map(|feature| feature.0).filter(|name| !left_out.contains(name)).collect()
}

/// Size of the deviations from the upright bounce at the release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Swing {
    Calm,
    Wide,
    /// So far that most runs end soon; with any tilt gain.
    Wild,
}

/// A random scene and its features.
pub(crate) struct Mix {
    pub(crate) features: Vec<&'static str>,
    pub(crate) scene: Scene,
    rod: Vec<(Name, Value)>,
    /// Fields of each feature.
    parts: Vec<Vec<(Name, Value)>>,
}

impl Mix {
    /// Draws up to four of these features, and again until there is such a scene.
    pub(crate) fn draw(random: &mut Random, swing: Swing, from: &[&str]) -> Self {
        loop {
            let mut drawn: Vec<&Feature> = Vec::new();
            for _ in 0..random.between(0.0, 5.0) as usize {
                let name = from[random.between(0.0, from.len() as f64) as usize];
                let feature = FEATURES.iter().find(|feature| feature.0 == name).unwrap();
                let excludes = |other: &&Feature| other.0 == name || other.1 == feature.1 && !other.1.is_empty();
                if !drawn.iter().any(excludes) {
                    drawn.push(feature);
                }
            }
            let shape = Shape::draw(random);
            let rod = shape.rod(random, swing);
            let parts: Vec<_> = drawn.iter().map(|it| shape.part(random, it)).collect();
            let features: Vec<_> = drawn.iter().map(|feature| feature.0).collect();
            if let Some(scene) = built(&rod, &parts, &features) {
                return Self { features, scene, rod, parts };
            }
        }
    }

    pub(crate) fn has(&self, any_of: &[&str]) -> bool {
        self.features.iter().any(|feature| any_of.contains(feature))
    }

    /// The same scene without one of its features, if there is such a scene.
    pub(crate) fn without(&self, feature: &str) -> Option<Scene> {
        let (mut parts, mut features) = (self.parts.clone(), self.features.clone());
        let index = features.iter().position(|name| *name == feature)?;
        parts.remove(index);
        features.remove(index);
        built(&self.rod, &parts, &features)
    }
}

fn built(rod: &[(Name, Value)], parts: &[Vec<(Name, Value)>], features: &[&str]) -> Option<Scene> {
    let mut draft = Draft::default();
    for &(name, value) in rod.iter().chain(parts.iter().flatten()) {
        draft.set(name, Some(value)).unwrap();
        if name == Name::FeedbackTheta {
            draft.set(Name::TiltGain, None).unwrap();
        }
    }
    if features.contains(&"triangle") {
        let Value::Number(length) = rod[0].1 else { return None };
        draft.set(Name::ContactDistance, None).unwrap();
        draft.set(Name::RadiusOfGyration, None).unwrap();
        let (width, height) = (0.6 * length, 1.5 * length);
        draft.set_vertices(Some(Vertices::new(&[[0.0, 0.0], [width, height], [-width, height]]).unwrap()));
    }
    if features.contains(&"point mass") {
        for name in [Name::ContactDistance, Name::RadiusOfGyration, Name::Theta, Name::ThetaDot, Name::ThetaDotSd] {
            draft.set(name, None).unwrap();
        }
        draft.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
        // Its drift dies out for 0 < κ < 1.
        for (name, sign) in [(Name::TiltGain, 1.0), (Name::FeedbackTheta, -1.0)] {
            if let Some(Value::Number(gain)) = draft.get(name) {
                draft.set(name, Some(Value::Number(sign * (gain.abs() - 0.6)))).unwrap();
            }
        }
        if features.contains(&"feedback") {
            draft.set(Name::FeedbackThetaDot, None).unwrap();
        }
    }
    draft.build().ok()
}

/// Lengths of a rod, its height above upright contact, m, and a gain within its limits.
struct Shape {
    length: f64,
    rho: f64,
    above: f64,
    kappa: f64,
}

impl Shape {
    fn draw(random: &mut Random) -> Self {
        let length = random.between(0.05, 0.3);
        let rho = length * random.between(0.3, 1.0);
        let above = length * random.between(0.3, 1.5);
        let kappa = 1.0 + random.between(0.1, 0.9) * rho * rho / (2.0 * above * length);
        Self { length, rho, above, kappa }
    }

    fn rod(&self, random: &mut Random, swing: Swing) -> Vec<(Name, Value)> {
        let (theta, theta_dot, x_dot) = match swing {
            Swing::Calm => (0.05, 0.2, 0.2),
            Swing::Wide => (0.2, 1.0, 0.3),
            Swing::Wild => (0.6, 6.0, 1.0),
        };
        let wild = swing == Swing::Wild;
        let values = [
            (Name::ContactDistance, self.length),
            (Name::RadiusOfGyration, self.rho),
            (Name::Height, self.length + self.above * if wild { random.between(1.0, 5.0) } else { 1.0 }),
            (Name::TiltGain, if wild { random.between(-1.0, 3.0) } else { self.kappa }),
            (Name::Theta, random.size(0.01 * theta, theta)),
            (Name::ThetaDot, random.size(0.01 * theta_dot, theta_dot)),
            (Name::XDot, random.size(0.001, x_dot)),
            (Name::X, random.size(0.001, 0.2)),
            (Name::Restitution, random.between(0.3, 1.0)),
        ];
        values.map(|(name, number)| (name, Value::Number(number))).to_vec()
    }

    fn number(&self, random: &mut Random, range: Range) -> f64 {
        match range {
            Between(low, high) => random.between(low, high),
            Size(low, high) => random.size(low, high),
            Above(low, high) => random.size(low, high).abs(),
            Height(low, high) => self.length + self.above * random.between(low, high),
            EnergyGain(low, high) => random.between(low, high) / (2.0 * 9.81 * self.above),
            Length(low, high) => self.length * random.size(low, high),
            TiltGain => -self.kappa,
            Delay if random.between(0.0, 1.0) < 0.3 => random.between(0.1, 0.6),
            Delay => random.size(1e-4, 0.05).abs(),
        }
    }

    fn part(&self, random: &mut Random, Feature(name, group, numbers, words): &Feature) -> Vec<(Name, Value)> {
        let mut part: Vec<_> =
            numbers.iter().map(|&(name, range)| (name, Value::Number(self.number(random, range)))).collect();
        for (name, words) in *words {
            part.push((*name, Value::Choice(words[random.between(0.0, words.len() as f64) as usize])));
        }
        if *group == "noise" {
            part.push((Name::Seed, Value::Integer(random.between(0.0, 1e9) as u64)));
        }
        if *name == "program" {
            let heights = [(); 3].map(|()| self.number(random, Height(0.7, 1.5)));
            part.push((Name::Program, Value::Numbers(HeightProgram::new(&heights).unwrap())));
        }
        part
    }
}
