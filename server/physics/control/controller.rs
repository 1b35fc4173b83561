//! A controller for the rig of a scene as it is: the bounce that repeats under the law, its linear model from the map, and the gain.
//!
//! The bounce, the model and the gain follow from each other. For most rigs the bounce does not depend on the gain, and one round is enough.

use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::analysis::repeating::{NoRepeatingBounce, RepeatingBounce, find, find_planned};
use crate::analysis::return_map::{ARC, PLANNED_SPEED, ReturnMap, SOLVED, SPIN, Vector, X, X_DOT, Y_DOT};
use crate::analysis::small_deviations::fixed_point_at;
use crate::control::bounce_model::BounceModel;
use crate::control::lqr::{DesignFailure, LqrDesign, design_lqr};
use crate::map::body::{Body, PreImpact};
use crate::map::friction::Friction;
use crate::numbers::rounded::rounded;
use crate::scene::{FieldError, GAINS, Name, Scene, Value};
use nalgebra::{Complex, DMatrix};

/// Most rounds in which the bounce and the law are brought together.
const MOST_ROUNDS: u32 = 40;

/// Angle, rad, up to which the body stands upright.
const UPRIGHT: f64 = 1e-9;

/// Distance from 1 up to which the eigenvalue of the height is 1 but for rounding.
const KEPT: f64 = 1e-12;

/// Weights of a law, and the contact that it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Friction of the contact that the law is for.
    pub friction: Option<Friction>,
    /// Weights on (x, θ, ẋ, θ̇).
    pub state: [f64; 4],
    /// Weight on the tilt.
    pub input: f64,
}

/// A designed law.
#[derive(Clone, Debug)]
pub struct Controller {
    /// The scene with the law.
    pub scene: Scene,
    /// The gains that the table is told, and how they were found.
    pub design: LqrDesign,
    /// The bounce in place.
    pub place: FixedPoint,
    /// Change of its ẏ by each bounce, m/s, where nothing holds its height.
    pub sinks: Option<f64>,
    /// The model of the bounce with the contact that the law is for, by gains that the table is told.
    pub model: BounceModel,
    /// That with the contact of the scene.
    pub own: BounceModel,
    /// Eigenvalue of the height, largest modulus: exactly 1 where nothing steers it.
    pub height: f64,
}

/// Reason for which there is no law.
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerFailure {
    /// No bounce in place can repeat, in a sentence.
    NoBounce(String),
    /// The design failed.
    Design(DesignFailure),
    /// A gain of the law is out of the range of its field.
    OutOfRange(Name, f64),
    /// The scene with the law cannot be built.
    Unbuilt(Vec<FieldError>),
}

/// Designs the law of a scene.
pub fn design_controller(scene: &Scene, wanted: &Wanted) -> Result<Controller, ControllerFailure> {
    let none = ControllerFailure::NoBounce;
    if scene.is_point() {
        return Err(none("a point mass has no angle to feed back".to_owned()));
    }
    if let Some(program) = scene.program() {
        let heights = program.heights();
        return Err(none(format!(
            "program has {} target heights in turn ({heights:?} m), so no bounce repeats after one strike",
            heights.len()
        )));
    }
    let given = scene.model();
    let speed = upright_speed(scene).ok_or_else(|| none("there is no upright bounce at this height".to_owned()))?;
    let (mut at, mut flown) = (upright(speed), 2.0 * speed / given.rod.gravity);
    for _ in 0..MOST_ROUNDS {
        let model = |body: &Body| {
            let state = ReturnMap::new(body, 1).state(&at);
            BounceModel::of(body, &PreImpact::at(1, at[X], state), flown).told(scene.tilt_factor())
        };
        let own = model(&given);
        if !own.height.is_finite() {
            return Err(none("the table gives an upright body no bounce, so no bounce repeats".to_owned()));
        }
        let is_own = given.friction == wanted.friction;
        let model = if is_own { own } else { model(&Body { friction: wanted.friction, ..given }) };
        let design = design_lqr(&model, wanted.state, wanted.input).map_err(ControllerFailure::Design)?;
        let designed = with_law(scene, design.gain)?;
        let found = upright_bounce(&designed).map_err(|why| none(format!("no bounce repeats: {why}")))?;
        let place = fixed_point_at(&found.map, &found.at);
        // But for rounding, and for a planned motion.
        let apart = |index: usize| (found.at[index] - at[index]).abs();
        let is_same = [ARC, X_DOT, Y_DOT, SPIN, X].into_iter().all(|n| apart(n) <= 10.0 * SOLVED * place.speed);
        (at, flown) = (found.at, place.flight_time);
        if is_same {
            refuse(&designed, &at).map_err(none)?;
            let place = FixedPoint { theta: 0.0, theta_dot: 0.0, ..place };
            let height = height_eigenvalue(&found);
            let change = found.map.image(&at).map(|image| image[Y_DOT] - at[Y_DOT]);
            let sinks = change.filter(|change| change.abs() > SOLVED * place.speed);
            return Ok(Controller { scene: designed, design, place, sinks, model, own, height });
        }
    }
    Err(none("the law and the bounce that repeats under it do not come together".to_owned()))
}

/// An upright body that comes down at a speed, m/s.
fn upright(speed: f64) -> Vector {
    let mut at = Vector::default();
    at[Y_DOT] = -speed;
    at
}

/// The bounce that repeats; where nothing holds its height, the bounce at the height of the release or of the target that repeats but for that.
fn upright_bounce(scene: &Scene) -> Result<RepeatingBounce, NoRepeatingBounce> {
    let body = scene.model();
    let map = ReturnMap::new(&body, 1);
    let mut guess = upright(upright_speed(scene).ok_or(NoRepeatingBounce::NotFound)?);
    // Where the table is level.
    let tilt = body.strike(&PreImpact::at(1, 0.0, map.state(&guess))).alpha;
    if let Some([x, _, x_dot, _]) = body.feedback().filter(|_| tilt != 0.0) {
        let (index, gain) = if x == 0.0 { (X_DOT, x_dot) } else { (X, x) };
        guess[index] = tilt / gain;
    }
    // The energy of the release, all of its fall in ẏ.
    let (start, rho) = (scene.start(), body.rod.radius_of_gyration);
    let mut reference = guess;
    (reference[X_DOT], reference[SPIN], reference[X]) = (start.x_dot, rho * start.theta_dot, scene.release().x);
    if let Some(speed) = release_speed(scene) {
        reference[Y_DOT] = -speed;
    }
    // Where the kept quantities of the release are no height, that of the guess.
    let why = match find_planned(&map, &guess, &reference).or_else(|_| find_planned(&map, &guess, &guess)) {
        Err(why @ (NoRepeatingBounce::Moves { .. } | NoRepeatingBounce::Rests)) => why,
        other => return other,
    };
    let Ok(RepeatingBounce { at, .. }) = find(&map.holding(&[Y_DOT]), &guess, &guess) else { return Err(why) };
    // A table that plans before the last strike plans for another height.
    if body.lag > map.shortest_flight(&at) {
        return Err(why);
    }
    let here = map.derivative(&at).ok_or(why)?;
    Ok(RepeatingBounce::bare(&map, at, here.matrix))
}

/// Refuses a bounce that is not upright, or not on the table.
fn refuse(scene: &Scene, at: &Vector) -> Result<(), String> {
    let theta = at[ARC] / scene.model().rod.radius_of_gyration;
    let tilt = scene.running_model.constant_tilt;
    let beside = format!("the table tilts by {} rad beside its law (table.errors, body.offset)", rounded(tilt));
    if theta.abs() > UPRIGHT {
        let leans =
            format!("the body is balanced at {} rad and {} m/s and not upright", rounded(theta), rounded(at[X_DOT]));
        return Err(if tilt == 0.0 {
            format!(
                "a wind or the turning of the table pushes the body aside, so that {leans}, and a law is about an upright bounce"
            )
        } else {
            format!("{beside}, and without a gain on x {leans}; give x a weight")
        });
    }
    if at[X].abs() > scene.rules().half_length {
        return Err(format!(
            "{beside}, and the law takes that back at x = {} m, beyond the end of the table at {} m",
            rounded(at[X]),
            scene.rules().half_length
        ));
    }
    Ok(())
}

/// The eigenvalue of largest modulus of the height: of ẏ and, where the table has planned its speed before the last strike, of that.
fn height_eigenvalue(RepeatingBounce { map, matrix, .. }: &RepeatingBounce) -> f64 {
    let even: Vec<usize> = [Y_DOT, PLANNED_SPEED].into_iter().filter_map(|index| map.place_of(index)).collect();
    let part = DMatrix::from_fn(even.len(), even.len(), |row, column| matrix[(even[row], even[column])]);
    let largest = eigenvalues(&part).map_or(Complex::new(f64::NAN, 0.0), |values| values[0]);
    let value = if largest.im == 0.0 { largest.re } else { modulus(largest) };
    if (value - 1.0).abs() <= KEPT { 1.0 } else { value }
}

/// Speed of an upright body that falls from a height, m, with a vertical velocity, m/s.
fn fallen(scene: &Scene, height: f64, y_dot: f64) -> Option<f64> {
    let rod = scene.parameters::<f64>();
    let square = y_dot * y_dot + 2.0 * rod.gravity * (height - rod.contact_distance);
    (square > 0.0).then(|| square.sqrt())
}

/// Speed of a body that falls upright from the height of the release, m/s.
fn release_speed(scene: &Scene) -> Option<f64> {
    fallen(scene, scene.release().height, scene.start().y_dot)
}

/// Speed of the upright bounce at first, m/s: that of the target height, or of the release.
fn upright_speed(scene: &Scene) -> Option<f64> {
    scene.target_height(1).map_or_else(|| release_speed(scene), |height| fallen(scene, height, 0.0))
}

fn with_law(scene: &Scene, gain: [f64; 4]) -> Result<Scene, ControllerFailure> {
    let mut draft = scene.draft();
    let mut set = |name, value: Option<f64>| draft.set(name, value.map(Value::Number)).is_ok();
    set(Name::TiltGain, None);
    for (name, gain) in GAINS.into_iter().zip(gain) {
        let said = gain != 0.0 || name == Name::FeedbackTheta;
        if !set(name, said.then_some(gain)) {
            return Err(ControllerFailure::OutOfRange(name, gain));
        }
    }
    draft.build().map_err(ControllerFailure::Unbuilt)
}
