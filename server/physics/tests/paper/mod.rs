//! The paper's body, for tests of what its runs do.

use equipoise_physics::scene::{Draft, Name, Scene, Value};

/// Released at rest from 0.2 m at this angle.
pub(crate) fn scene(tilt_gain: f64, theta: f64) -> Scene {
    let mut draft = Draft::default();
    for (name, value) in [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0),
        (Name::Height, 0.2),
        (Name::Theta, theta),
        (Name::TiltGain, tilt_gain),
    ] {
        draft.set(name, Some(Value::Number(value))).unwrap();
    }
    draft.build().unwrap()
}
