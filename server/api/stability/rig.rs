//! Effects of the constant errors of a rig, and of a turning table, on a verdict, as part of the answer.

use equipoise_physics::analysis::contact_regime::{ContactRegime, contact_regime};
use equipoise_physics::analysis::evidence::{Balance, Swing};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::{ARC, SPIN, X_DOT};
use equipoise_physics::analysis::small_deviations::{Motion, SmallDeviations, small_deviations};
use equipoise_physics::scene::{Name, Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Motion aside of a body that the table balances, where no bounce repeats in place: to which a constant error of the tilt, or a wind, drives it.
/// Absent without one, and with state feedback of x, which takes it back at `fixed_point.x`. All are null where the angle stays nowhere.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "SteadyDrift")]
pub(super) struct SteadyDriftAnswer {
    /// Lean at which the angle stays, rad.
    pub(super) theta: Option<f64>,
    /// Horizontal acceleration while the drift is slow, m/s².
    pub(super) acceleration: Option<f64>,
    /// Steady horizontal velocity, m/s: with state feedback of x_dot, and in air.
    speed: Option<f64>,
    /// Time after which a body that started at rest in the middle has left the table, if `table.length` is given, s.
    pub(super) time_on_table: Option<f64>,
}

impl SteadyDriftAnswer {
    /// The motion of a scene, if no bounce of it stays in place.
    pub(super) fn of(scene: &Scene, small: Result<&SmallDeviations, &NoRepeatingBounce>) -> Option<Self> {
        let half_length = scene.rules().half_length;
        let (theta, acceleration, speed, time) = match small {
            Ok(SmallDeviations { fixed_point, drifts: true, drift: None, .. }) => {
                let time = half_length / fixed_point.x_dot.abs();
                (Some(fixed_point.theta), Some(0.0), Some(fixed_point.x_dot), time)
            }
            Err(why @ NoRepeatingBounce::Moves { at, change, flight_time }) if why.moves(X_DOT) => {
                let theta = at[ARC] / scene.model().rod.radius_of_gyration;
                let acceleration = change[X_DOT] / flight_time;
                let turns = why.moves(ARC) || why.moves(SPIN) || theta.abs() >= FRAC_PI_2;
                let [theta, acceleration] = [theta, acceleration].map(|part| (!turns).then_some(part));
                let time = acceleration.map_or(f64::INFINITY, |it| (2.0 * half_length / it.abs()).sqrt());
                (theta, acceleration, None, time)
            }
            _ => return None,
        };
        Some(Self { theta, acceleration, speed, time_on_table: Some(time).filter(|time| time.is_finite()) })
    }
}

/// Energy that a table which turns as it strikes (`table.tilt_rate`) gives to a swing at each bounce, to second order in the angle. Present with
/// a pivot at a place at which the angle circles, where a swing moves a kept quantity.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "SwingPump")]
pub(super) struct SwingPumpAnswer {
    /// Largest angle of the swing of the release by the linear map, rad.
    swing: f64,
    /// Mean distance of the body from the pivot at the first contact, m.
    distance: f64,
    /// Mean change of the energy per bounce and unit mass, m²/s².
    energy: f64,
    /// Number of bounces until the height is critical, at the present rate. Null if the height does not grow.
    critical_bounces: Option<u64>,
}

impl SwingPumpAnswer {
    /// The pump of a scene whose table turns about a place as it strikes.
    pub(super) fn of(scene: &Scene, balance: &Balance) -> Option<Self> {
        let place = scene.acting_turn()?.place?;
        let Swing { amplitude, place: swings_at, shifts, energy, .. } = balance.swing.as_ref()?.as_ref().ok()?;
        if shifts.iter().all(|shift| *shift == 0.0) {
            return None;
        }
        let critical_bounces = balance.bounces_until_critical();
        Some(Self { swing: *amplitude, distance: swings_at - place, energy: *energy, critical_bounces })
    }
}

/// Sentences on the height of a bounce, if nothing steers it and strikes or air change the energy of a swing.
pub(super) fn height_note(scene: &Scene, balance: &Balance) -> Option<String> {
    let SmallDeviations { fixed_point, motion, .. } = &balance.small;
    if let (Some(drag), Some(height)) = (scene.drag(), scene.target_height(1))
        && drag.linear != 0.0
    {
        return Some(format!(
            "the law of the table does not know the air: with target_height {height} m the bounce has its top at {} m, where strikes give back what \
             flights lose",
            fixed_point.apex_height
        ));
    }
    let changes = scene.acting_turn().is_some() || scene.drag().is_some();
    (changes && !scene.steers_energy()).then(|| {
        if *motion == Motion::DiesOut {
            "fixed_point has the height at which the run settles, since a swing changes the energy as long as it lasts; if the run does not settle, it \
             has that of the release"
        } else {
            "fixed_point has the height of the release, which a swing changes as long as it lasts"
        }
        .to_owned()
    })
}

/// Sentences on gains that the table has by its errors, which are not those that it was given.
pub(super) fn gain_notes(scene: &Scene) -> Vec<String> {
    let errors = scene.table_errors();
    let mut notes = Vec::new();
    if errors.tilt_gain != 0.0 {
        notes.push(format!(
            "margins of table.tilt_gain are of the gain as it is set; the table tilts by {} times its law, and reason has the gain by which it acts",
            scene.tilt_factor()
        ));
    }
    if errors.speed != 0.0 && scene.steers_energy() {
        notes.push(format!(
            "margins of table.energy_gain are of the gain as it is set; the table moves at {} times its law",
            scene.speed_factor()
        ));
    }
    notes
}

/// Sentences on a delay that the table does not predict: the law by which it acts, and the growth of a swing.
pub(super) fn delay_notes(scene: &Scene, fixed_point: &FixedPoint) -> Vec<String> {
    let (lag, model) = (scene.lag(), scene.model());
    if lag > fixed_point.flight_time {
        return vec![format!(
            "table.delay is {lag} s and the bounce takes {} s from strike to strike: the table strikes by a state from before the last strike, and \
             the motion that it has planned is a part of the state",
            fixed_point.flight_time
        )];
    }
    let Some([x, theta, x_dot, theta_dot]) = model.feedback().filter(|_| lag != 0.0) else { return Vec::new() };
    let mut notes = vec![format!(
        "table.delay without prediction is the state feedback K = ({x}, {theta}, {x_dot}, {theta_dot}) of (x, theta, x_dot, theta_dot) at the \
         strike: K_x_dot − K_x·delay and K_theta_dot − K_theta·delay"
    )];
    if x == 0.0 && x_dot == 0.0 && contact_regime(&model) == ContactRegime::Frictionless {
        let rod = model.rod;
        let turning = rod.radius_of_gyration * rod.radius_of_gyration;
        let determinant = 1.0 + 2.0 * fixed_point.speed * rod.contact_distance * theta_dot / turning;
        if determinant > 1.0 && scene.number(Name::TiltGain).is_some() {
            notes.push(format!(
                "a swing of the angle grows by the square root of {determinant} a bounce, the determinant 1 + (2Vl/ρ²)K_theta_dot: with a \
                 delay and without prediction no tilt_gain above 0 balances"
            ));
        }
    }
    notes
}

/// Friction that the note on a verdict without friction looks at.
const SOME_FRICTION: f64 = 1e-4;

/// Sentence on a verdict without friction that any friction loses; `None` if a little of it keeps the linear verdict bounded.
pub(super) fn friction_note(scene: &Scene) -> Option<String> {
    if scene.number(Name::Friction) != Some(0.0) {
        return None;
    }
    let mut draft = scene.draft();
    draft.set(Name::Friction, Some(Value::Number(SOME_FRICTION))).ok()?;
    let rough = match draft.build() {
        Ok(rough) => rough,
        Err(errors) => {
            let why = errors.into_iter().next()?.detail;
            return Some(format!(
                "the verdict is of a contact without friction, and such a scene cannot have any: {why}"
            ));
        }
    };
    let linear = small_deviations(&rough).ok()?.linear;
    let radius = linear.spectral_radius();
    if linear.says_bounded() || !radius.is_finite() {
        return None;
    }
    let law =
        if scene.model().feedback().is_some() { "this feedback does not balance" } else { "no tilt_gain balances" };
    Some(format!(
        "the verdict is of a contact without friction: with contact.friction {SOME_FRICTION} the contact sticks to the table, and small deviations grow \
         (spectral radius {radius}). With friction {law} unless table.slide is `matched`; budget=true has the limit"
    ))
}
