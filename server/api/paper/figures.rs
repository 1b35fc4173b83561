//! Tables, figures and claims of the paper, by the runs of the presets.

use equipoise_physics::catching::catch;
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::scene::{Name, Scene, Value};

use crate::api::paper::item::{Check, Item, Kind, PLAIN};
use crate::api::paper::linear_equations::LOSSY_GAIN;
use crate::api::scene::quantity::Quantity;

/// A figure of the phase planes of a run.
const PLANES: Item = Item { kind: Kind::Figure, ask: ("trajectories", "bounces=2000"), picture: true, ..PLAIN };

/// α = κθ at the first contact.
fn tilt(scene: &Scene) -> Option<Vec<Check>> {
    let contact = scene.orbit().ok()?.advance();
    let printed = scene.parameters::<f64>().tilt_gain * contact.state.theta;
    Some(vec![Check::formula(["table tilt at the first contact", "α", "rad"], printed, contact.alpha)])
}

/// Velocities of the body at the end of a catch: those of the table, which stands.
fn caught(scene: &Scene) -> Option<Vec<Check>> {
    let settings = CatchSettings { strategy: Some(Strategy::BounceDown), ..CatchSettings::default() };
    let hold = catch(scene, &settings, None, &mut || true).ok()?.hold?;
    let end = hold.samples.last()?;
    let at_rest = |words, value| Check::within(words, 0.0, value, 1e-3);
    Some(vec![
        at_rest(["horizontal velocity after the hold", "ẋ", "m/s"], end.x_dot),
        at_rest(["angular velocity after the hold", "θ̇", "rad/s"], end.theta_dot),
    ])
}

/// Section 2.1.3.
pub(super) const LOSSLESS: [Item; 8] = [
    Item {
        id: "figure-1",
        kind: Kind::Figure,
        place: "Fig. 1",
        title: "The geometry of the system",
        printed: "β = θ − α; α, β and θ count counter-clockwise; α = κθ",
        checks: tilt,
        why: Some("The scene shows these symbols at the first contact"),
        ..PLAIN
    },
    Item {
        id: "table-1",
        kind: Kind::Table,
        place: "Table 1",
        title: "The lossless cases",
        printed: "κ_critical = 1.5 in cases 1 to 3; case 2 starts with θ̇₀ = 0.1 rad/s",
        ask: ("stability", "bounces=2000"),
        quoted: &[
            ("case-1", Quantity::CriticalTiltGain),
            ("case-2", Quantity::CriticalTiltGain),
            ("case-3", Quantity::CriticalTiltGain),
            ("case-2-figure", Quantity::ReleaseSpin),
        ],
        ..PLAIN
    },
    Item {
        id: "figure-4",
        kind: Kind::Figure,
        place: "Fig. 4",
        title: "The simulated triangle",
        printed: "isosceles, 0.10 m wide and 0.20 m high, ρ = 9.428 cm",
        scene: ("triangle-polygon", &[]),
        ask: ("trajectories", "bounces=2000"),
        picture: true,
        quoted: &[("triangle-polygon", Quantity::RadiusOfGyration)],
        ..PLAIN
    },
    Item {
        id: "figure-5",
        place: "Fig. 5",
        title: "Case 1: both planes are centred on the origin",
        printed: "θ₀ = 0.3 rad, θ̇₀ = 0, κ = 1.1",
        ..PLANES
    },
    Item {
        id: "figure-6",
        place: "Fig. 6",
        title: "Case 2: the rod drifts",
        printed: "θ₀ = 0, θ̇₀ = 0.2 rad/s, κ = 1.1",
        scene: ("case-2-figure", &[]),
        ..PLANES
    },
    Item {
        id: "figure-7",
        place: "Fig. 7",
        title: "Case 3: the swings grow until it falls",
        printed: "θ₀ = 0.1 rad, κ = 1.55 > κ_critical",
        scene: ("case-3", &[]),
        ..PLANES
    },
    Item {
        id: "angles",
        kind: Kind::Claim,
        place: "section 2.1.3",
        title: "The angles that are stable",
        printed: "stable for angular deviations up to about ±0.4 rad",
        ask: (
            "regions",
            "x.field=release.theta&x.from=0&x.to=0.5&x.count=101&y.field=table.tilt_gain&y.from=1.1&y.to=1.1&y.count=1",
        ),
        quoted: &[("case-1", Quantity::BoundedAngle)],
        ..PLAIN
    },
    Item {
        id: "angles-critical",
        kind: Kind::Claim,
        place: "section 2.1.3, at κ_critical",
        title: "Small angles up to the critical gain",
        printed: "±0.15 rad or less is stable up to and including κ_critical",
        scene: ("critical-soft", &[]),
        ask: ("stability", "bounces=20000"),
        quoted: &[("critical-soft", Quantity::BoundedAngle), ("critical-soft", Quantity::BoundedTiltGain)],
        ..PLAIN
    },
];

/// Sections 2.2.2 to 3.
pub(super) const EXTENSIONS: [Item; 11] = [
    LOSSY_GAIN,
    Item {
        id: "energy-gain",
        kind: Kind::Claim,
        place: "section 2.2.2",
        title: "The range of the energy gain",
        printed: "0 < κ_E < 4/((1 + e)ẏ*²); the eigenvalue of ẏ is 1 − κ_E/κ_E,max",
        scene: ("case-4", &[]),
        ask: ("stability", "bounces=2000"),
        quoted: &[("case-4", Quantity::UpperEnergyGain), ("case-4", Quantity::EnergyEigenvalue)],
        ..PLAIN
    },
    Item {
        id: "table-2",
        kind: Kind::Table,
        place: "Table 2",
        title: "The cases with energy feedback",
        printed: "ẏ* = −1.27 m/s, κ_critical = 1.28, κ_E = 0.165, E = 1.73",
        scene: ("case-4", &[]),
        ask: ("stability", "bounces=2000"),
        quoted: &[
            ("case-4", Quantity::FixedPointSpeed),
            ("case-4", Quantity::CriticalTiltGain),
            ("case-4", Quantity::TargetEnergy),
            ("case-4", Quantity::GravityInPlane),
        ],
        ..PLAIN
    },
    Item {
        id: "figure-8",
        place: "Fig. 8",
        title: "Case 4: the energy settles",
        printed: "converges to the correct energy level, E = 1.73",
        scene: ("case-4", &[]),
        quoted: &[("case-4", Quantity::SettledEnergy), ("case-4", Quantity::SettledVerticalEnergy)],
        ..PLANES
    },
    Item {
        id: "figure-9",
        place: "Fig. 9",
        title: "Case 5: then like the lossless case",
        printed: "then the behaviour of the system is similar to the lossless case",
        scene: ("case-5", &[]),
        quoted: &[("case-5", Quantity::AngleGrowth)],
        ..PLANES
    },
    Item {
        id: "friction",
        kind: Kind::Claim,
        place: "section 2.2.3",
        title: "Friction and the energy gain",
        printed: "increasing κ_E also prolongs the time that the object can be kept upright",
        scene: ("case-4", &[]),
        ask: ("trajectories", "bounces=2000"),
        quoted: &[("case-4", Quantity::HelpedFriction)],
        ..PLAIN
    },
    Item {
        id: "figure-11",
        place: "Fig. 11",
        title: "Case 1 with noise",
        printed: "remains stable in a similar range, with 10 ms of Gaussian noise in the time of impact",
        scene: ("case-1-noise", &[]),
        why: Some("One run says little: of many runs of case 1 under this noise some 45 % survive 400 bounces"),
        ..PLANES
    },
    Item {
        id: "figure-12",
        place: "Fig. 12",
        title: "Case 4 with noise",
        printed: "as Fig. 11, for case 4",
        scene: ("case-4-noise", &[]),
        why: Some("Of many runs of case 4 under this noise some 91 % survive 400 bounces"),
        ..PLANES
    },
    Item {
        id: "settling",
        kind: Kind::Claim,
        place: "section 3",
        title: "To settle is to come to rest",
        printed: "the stable state of catching is zero relative velocity",
        scene: ("still-lossy", &[]),
        ask: ("trajectories", "bounces=2000"),
        quoted: &[("still-lossy", Quantity::SettledSpin)],
        ..PLAIN
    },
    Item {
        id: "catching",
        kind: Kind::Claim,
        place: "section 3",
        title: "Catching is the dual problem",
        printed: "we would like to plan the movements of the hand so that the object does not fall or bounce away, but settles there",
        scene: ("case-1", &[(Name::Height, Value::Number(0.25)), (Name::Theta, Value::Number(0.1))]),
        ask: ("catches", "strategy=bounce_down"),
        picture: true,
        checks: caught,
        why: Some(
            "The paper leaves this open. Neither its energy feedback nor α = κθ settles the object. Strikes that each halve the contact \
             speed do, with a tilt that follows position and velocities, and then the table holds it",
        ),
        ..PLAIN
    },
    Item {
        id: "radius",
        kind: Kind::Claim,
        place: "section 2.1.2",
        title: "The stable range with the triangle's own radius of gyration",
        printed: "κ_critical = 1.5",
        scene: ("triangle-polygon", &[]),
        ask: ("stability", "bounces=2000"),
        quoted: &[("triangle-polygon", Quantity::CriticalTiltGain)],
        ..PLAIN
    },
];
