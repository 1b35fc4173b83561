//! The upright bounce in place that a scene is to be balanced on, and the drift beside it.
//!
//! Not here: how a small deviation from it moves ([`crate::analysis::linear_verdict`]).

use crate::analysis::angle_feedback::AngleFeedback;
use crate::analysis::contact_regime::{ContactRegime, contact_regime, dragging_turn, lent_by_table};
use crate::analysis::delayed_height::DelayedHeight;
use crate::analysis::settled_run::settled_state;
use crate::analysis::upright_in_air::UprightInAir;
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::map::table::control_law::Steering;
use crate::map::table::program::HeightProgram;
use crate::numbers::rounded::rounded;
use crate::scene::model::ModelLevel;
use crate::scene::{BodyShape, Name, Scene, Striking};

/// Most rounds in which the speed of a bounce and the drift beside it are brought together; each gains some digits.
const MOST_ROUNDS: u32 = 32;

/// Change of the drift, as a share of the speed, at which they are together.
const SAME_DRIFT: f64 = 1e-15;

/// The upright bounce that a scene is to be balanced on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPoint {
    /// x*, m: 0 unless the table has a constant tilt c, and then c/K_x, where state feedback of x takes it back.
    pub x: f64,
    /// ẋ*, m/s: the drift speed c where the table holds the total energy, of which c² is a part; 0 elsewhere, where the bounce in
    /// place belongs to every drift.
    pub x_dot: f64,
    /// θ*, rad: 0 unless a constant tilt leaves the body a lean.
    pub theta: f64,
    /// θ̇*, rad/s.
    pub theta_dot: f64,
    /// V = |ẏ*|, m/s.
    pub speed: f64,
    /// 2V/G, s.
    pub flight_time: f64,
    /// Height of the centre of gravity at the top of the bounce, m.
    pub apex_height: f64,
}

impl FixedPoint {
    fn new(x_dot: f64, speed_squared: f64, gravity: f64, contact_distance: f64) -> Self {
        let speed = speed_squared.sqrt();
        Self {
            x: 0.0,
            x_dot,
            theta: 0.0,
            theta_dot: 0.0,
            speed,
            flight_time: 2.0 * speed / gravity,
            apex_height: contact_distance + speed_squared / (2.0 * gravity),
        }
    }

    /// The state just before a contact.
    pub fn state(&self) -> State {
        State { theta: self.theta, x_dot: self.x_dot, y_dot: -self.speed, theta_dot: self.theta_dot }
    }
}

/// Tells whether a scene is a rod or a point mass in closed form: with a tilt gain, without friction or with a contact that a table matches, and
/// with nothing else that acts on the body or errs.
pub fn is_plain(scene: &Scene) -> bool {
    let model = scene.model();
    let one_strike = scene.steers_energy() && scene.energy_feedback == EnergyFeedback::OneStrike;
    let rough = scene.friction != 0.0;
    model.feedback().is_none()
        && model.turning.is_none()
        && model.drag.is_none()
        && model.program.is_none()
        && model.constant_tilt == 0.0
        && model.lag == 0.0
        && contact_regime(&model) != ContactRegime::Sticking
        && !(one_strike && (rough || scene.speed_factor() != 1.0))
        && !(model.is_point && scene.is_rough())
}

/// c = ẋ − κρ²θ̇/((κ − 1)l), or ẋ − (κρ² + l²)θ̇/((κ − 1)l) where a matched contact sticks: the mean horizontal speed of a balanced
/// run, m/s. `None` if κ = 1, which drifts off in angle instead, where friction holds the contact, and for a point mass, whose
/// drift dies out.
///
/// With state feedback of θ and θ̇ alone it is [`AngleFeedback::drift`]; feedback of x or ẋ leaves none. It is not derived where a turning
/// table drags the contact along, nor for such feedback with a turning table.
pub fn drift_speed(scene: &Scene) -> Option<f64> {
    let scene = &scene.with_tilt_law();
    if scene.constant_tilt() != 0.0 {
        return None;
    }
    let model = scene.model();
    if model.feedback().is_some() {
        let feedback = AngleFeedback::of(scene).filter(|_| scene.acting_turn().is_none() && scene.drag().is_none())?;
        return place_and_drift(scene, feedback).ok().map(|(_, drift)| drift);
    }
    let regime = contact_regime(&model);
    let is_held = regime == ContactRegime::Sticking || dragging_turn(&model).is_some();
    if is_held || !scene.needs_at_most(&[ModelLevel::Turning, ModelLevel::Friction]) {
        return None;
    }
    let BodyShape::Rod { contact_distance, radius_of_gyration } = scene.body else { return None };
    let start = scene.start();
    let excess = scene.tilt_gain - 1.0;
    (excess != 0.0).then(|| {
        let lever = radius_of_gyration * radius_of_gyration / contact_distance;
        let stuck = if regime == ContactRegime::VelocityMatched { contact_distance } else { 0.0 };
        start.x_dot - (scene.tilt_gain * lever + stuck) * start.theta_dot / excess
    })
}

/// Reason for which a scene with a turning table has no verdict, if it has none.
pub(super) fn undecided_turn(scene: &Scene) -> Option<String> {
    scene.acting_turn()?;
    let model = scene.model();
    let (regime, fed_back) = (contact_regime(&model), model.feedback().is_some());
    let drags = dragging_turn(&model).is_some();
    let decays = fed_back || drags;
    if regime == ContactRegime::Sticking {
        return None;
    }
    if !decays && (regime == ContactRegime::VelocityMatched || scene.steers_energy()) {
        let beside =
            if scene.steers_energy() { "table.energy_gain holds the height" } else { "the table moves along itself" };
        return Some(format!(
            "table.tilt_rate is `follows` with table.pivot.x, and {beside}: in first order the angle circles as on a table that does not turn, \
             and whether a swing then grows or dies out is decided in third order, which is not derived"
        ));
    }
    (drags && regime == ContactRegime::VelocityMatched && holds_total(scene)).then(|| {
        "table.tilt_rate turns a matched table, and the drift beside it, which the total energy has in it, is not derived".to_owned()
    })
}

/// The fixed point on the energy surface of the release, or that of the target height with energy feedback.
///
/// V² = |v₀|² + 2G(y₀ − l) − c²: drift energy never comes back, and what counts is the height above l, not above
/// l cos θ as in eq. (10). A matched table with friction lends some more. Friction on one that only tilts takes the
/// energy of sideways motion and spin, so there V² = ẏ₀² + 2G(y₀ − l). A table that holds the total energy holds that of the drift
/// too: V² = 2G(y* − l) − c².
///
/// # Errors
/// A sentence that says why there is none.
pub fn find_fixed_point(scene: &Scene) -> Result<FixedPoint, String> {
    let scene = &scene.with_tilt_law();
    if let Some(name) = scene.noise_field() {
        return Err(format!("{} scatters the bounces, so that none repeats", name.row().path));
    }
    refuse_mixes(scene)?;
    if scene.drag().is_some() {
        UprightInAir::refuse(scene)?;
    }
    let x = place_of_rest(scene)?;
    if scene.drag().is_some() {
        return Ok(FixedPoint { x, ..bounce_in_air(scene)? });
    }
    if scene.lag() != 0.0 {
        // A swing that is fed for so long may leave no energy for the bounce.
        refuse_longer_delay(scene, &bounce_in_place(scene)?)?;
    }
    if let Some(why) = undecided_turn(scene) {
        return Err(why);
    }
    let found = match AngleFeedback::of(scene).filter(|_| scene.acting_turn().is_none()) {
        Some(feedback) => place_and_drift(scene, feedback)?.0,
        None => upright_bounce(scene, held_drift(scene))?,
    };
    let decays = scene.model().feedback().is_some() || dragging_turn(&scene.model()).is_some();
    if scene.acting_turn().is_some() && decays && !scene.steers_energy() {
        let Some(State { y_dot, .. }) = settled_state(scene) else { return Ok(FixedPoint { x, ..found }) };
        let contact_distance = scene.parameters::<f64>().contact_distance;
        return Ok(FixedPoint { x, ..FixedPoint::new(0.0, y_dot * y_dot, scene.gravity, contact_distance) });
    }
    refuse_longer_delay(scene, &found)?;
    Ok(FixedPoint { x, ..found })
}

/// Refuses mixes of parts for each of which a closed form holds, and for both of which none does.
fn refuse_mixes(scene: &Scene) -> Result<(), String> {
    let path = |name: Name| name.row().path;
    let (drag, turns) = (scene.drag_field(), scene.acting_turn().map(|_| Name::TiltRate));
    let late = (scene.lag() != 0.0).then_some(Name::Delay);
    let one_strike = scene.steers_energy() && scene.energy_feedback == EnergyFeedback::OneStrike;
    let one_strike = one_strike.then_some(Name::EnergyLaw);
    let rough = (scene.friction != 0.0).then_some(Name::Friction);
    let wrong_speed = (scene.speed_factor() != 1.0).then_some(Name::SpeedError);
    for (one, other) in [(drag, late), (drag, turns), (late, turns), (one_strike, rough), (one_strike, wrong_speed)] {
        if let (Some(one), Some(other)) = (one, other) {
            return Err(format!(
                "{} and {} are in one scene, and no closed form holds for both",
                path(one),
                path(other)
            ));
        }
    }
    if scene.body != BodyShape::Point {
        return Ok(());
    }
    let fed_back = (scene.steering != Steering::TiltGain).then_some(Name::FeedbackTheta);
    let slides = scene.is_rough().then_some(rough.unwrap_or(Name::Slide));
    let tilted = if scene.constant_tilt() == 0.0 { None } else { scene.first_error() };
    match drag.or(late).or(turns).or(fed_back).or(slides).or(tilted) {
        Some(name) => Err(format!("the body is a point mass, and no closed form holds for it with {}", path(name))),
        None => Ok(()),
    }
}

/// The upright bounce in air that drags the body. Drag of place takes energy in each flight and leaves no drift, so that one bounce repeats at most.
/// Drag of rotation alone takes energy from swings, and the bounce that is left keeps its height: that at which the run settles.
fn bounce_in_air(scene: &Scene) -> Result<FixedPoint, String> {
    let (gravity, contact_distance) = (scene.gravity, scene.parameters::<f64>().contact_distance);
    if scene.drag().is_some_and(|drag| drag.linear != 0.0) {
        let UprightInAir { speed, flight_time, climb, .. } = UprightInAir::repeating(scene)?;
        return Ok(FixedPoint {
            flight_time,
            apex_height: contact_distance + climb,
            ..FixedPoint::new(0.0, speed * speed, gravity, contact_distance)
        });
    }
    let found = upright_bounce(scene, 0.0)?;
    if scene.steers_energy() && !holds_total(scene) {
        return Ok(found);
    }
    let Some(settled) = settled_state(scene) else { return Ok(found) };
    let x_dot = if holds_total(scene) { settled.x_dot } else { 0.0 };
    Ok(FixedPoint::new(x_dot, settled.y_dot * settled.y_dot, gravity, contact_distance))
}

/// Refuses a bounce that is shorter than the delay of its table.
fn refuse_longer_delay(scene: &Scene, bounce: &FixedPoint) -> Result<(), String> {
    let (delay, flight_time) = (scene.lag(), bounce.flight_time);
    if delay < flight_time {
        return Ok(());
    }
    Err(format!(
        "table.delay is {delay} s and the bounce takes {flight_time} s from strike to strike: the table would strike by a state from before the \
         last strike, for which the analysis is not derived"
    ))
}

/// The fixed point of the same scene without the drift: [`find_fixed_point`], but with all of a total energy that is held.
///
/// # Errors
/// A sentence that says why there is none.
pub fn find_bounce_without_drift(scene: &Scene) -> Result<FixedPoint, String> {
    let scene = &scene.with_tilt_law();
    if scene.drag().is_some() {
        return find_fixed_point(scene);
    }
    let x = place_of_rest(scene)?;
    Ok(FixedPoint { x, ..upright_bounce(scene, 0.0)? })
}

/// x*, m: where the table is level under an upright body. A table without feedback of x and without a constant tilt is so everywhere.
///
/// # Errors
/// A sentence that says why it is level nowhere, or only beyond its ends.
fn place_of_rest(scene: &Scene) -> Result<f64, String> {
    let tilt = scene.constant_tilt();
    if tilt == 0.0 {
        return Ok(0.0);
    }
    let beside = format!("the table tilts by {} rad beside its law (table.errors, body.offset)", rounded(tilt));
    let gain = scene.model().feedback().map_or(0.0, |[x, ..]| x);
    if gain == 0.0 {
        return Err(format!("{beside}, so no bounce repeats in place"));
    }
    let x = tilt / gain;
    if x.abs() > scene.half_length {
        return Err(format!(
            "{beside}, and the feedback of x takes that back at x = {} m, beyond the end of the table at {} m",
            rounded(x),
            scene.half_length
        ));
    }
    Ok(x)
}

/// Tells whether the table holds the total energy, and with it that of the drift.
fn holds_total(scene: &Scene) -> bool {
    match scene.energy_feedback {
        EnergyFeedback::Vertical => false,
        EnergyFeedback::Total | EnergyFeedback::OneStrike => scene.steers_energy(),
    }
}

/// c, m/s, where the table holds the total energy; 0 elsewhere.
fn held_drift(scene: &Scene) -> f64 {
    if holds_total(scene) { drift_speed(scene).unwrap_or(0.0) } else { 0.0 }
}

/// The fixed point with the drift speed `held`, m/s, in the energy that the table holds.
fn upright_bounce(scene: &Scene, held: f64) -> Result<FixedPoint, String> {
    let model = scene.model();
    if model.feedback().is_some() {
        return bounce_in_place(scene);
    }
    if let Some(program) = scene.program() {
        return Err(no_single_bounce(program));
    }
    if scene.is_lossy() {
        return Err(format!(
            "{}: every bounce loses energy, so no bounce repeats",
            match scene.strike {
                Striking::Still => format!("the table stands still and restitution is {}", scene.restitution),
                Striking::Compensated => scene.belief(),
            }
        ));
    }
    if !scene.steers_energy() && scene.assumed_restitution() < scene.restitution {
        return Err(format!("{}: every bounce gains energy, so no bounce repeats", scene.belief()));
    }
    let (contact_distance, radius_of_gyration) = match scene.body {
        BodyShape::Rod { contact_distance, radius_of_gyration } => (contact_distance, radius_of_gyration),
        BodyShape::Point => (0.0, 0.0),
    };
    let speed_squared = if let Some(height) = scene.target_height {
        let settled = height + height_error(scene);
        let room = settled - contact_distance;
        if !settled.is_finite() {
            return Err(format!("{}: every bounce gains energy, so no bounce repeats", scene.belief()));
        }
        if room <= 0.0 {
            let why = if settled == height { String::new() } else { format!(", where {} holds it,", scene.belief()) };
            return Err(format!("target_height {settled} m{why} is not above contact_distance {contact_distance} m"));
        }
        let available = 2.0 * scene.gravity * room;
        let share = match scene.energy_feedback {
            EnergyFeedback::OneStrike => held_share(scene),
            EnergyFeedback::Vertical | EnergyFeedback::Total => 1.0,
        };
        let taken = share * share * held * held;
        if available - taken <= 0.0 {
            return Err(format!(
                "the target leaves {available} m²/s² for bouncing upright and the drift at {held} m/s takes {taken} m²/s² of the total \
                 energy that the table holds: no upright bounce has that energy"
            ));
        }
        available - taken
    } else {
        let start = scene.start();
        let spin = radius_of_gyration * start.theta_dot;
        let drift = drift_speed(scene).unwrap_or(0.0);
        let mut kinetic = start.y_dot * start.y_dot;
        if contact_regime(&model) != ContactRegime::Sticking {
            kinetic += start.x_dot * start.x_dot + spin * spin + lent_by_table(&model, start, drift);
        }
        let available = kinetic + 2.0 * scene.gravity * (scene.release.height - contact_distance);
        if available - drift * drift <= 0.0 {
            return Err(format!(
                "the release has {available} m²/s² for bouncing upright and the drift at {drift} m/s takes {} m²/s²: no \
                 upright bounce has that energy",
                drift * drift
            ));
        }
        available - drift * drift
    };
    Ok(FixedPoint::new(held, speed_squared, scene.gravity, contact_distance))
}

fn no_single_bounce(program: &HeightProgram) -> String {
    let heights = program.heights();
    format!(
        "program has {} target heights in turn ({heights:?} m), so no bounce repeats after one strike; /v1/periodic-orbits has the orbit \
         of period {}",
        heights.len(),
        heights.len()
    )
}

/// Height above the target height at which the energy feedback comes to rest, m: the strike gain is 2 there for an assumed restitution
/// ê, κ_E(η* − η) = 2(ê − e)/((1 + e)(1 + ê)). Nothing without feedback, or where ê is e; not derived in air, and 0.
///
/// With [`EnergyFeedback::OneStrike`] the speeds of upright bounces follow u ↦ (s − 1)u + s√C, s = (1 + e)/(1 + ê), C = 2G(y* − l). They
/// come to rest at u² = C s²/(2 − s)²; at s = 2 nowhere, and the height is infinite. With a drift c, C is 2G(y* − l) − c².
pub fn height_error(scene: &Scene) -> f64 {
    let (e, assumed) = (scene.restitution, scene.assumed_restitution());
    if let Some(delayed) = DelayedHeight::of(scene, 0.0) {
        let rod = scene.parameters::<f64>();
        let height = |speed: f64| rod.contact_distance + 0.5 * speed * speed / rod.gravity;
        return delayed.map_or(0.0, |delayed| height(delayed.speed) - scene.target_height.unwrap_or(0.0));
    }
    if !scene.steers_energy() || e == assumed || scene.drag().is_some_and(|drag| drag.linear != 0.0) {
        return 0.0;
    }
    if let (EnergyFeedback::OneStrike, Some(height)) = (scene.energy_feedback, scene.target_height) {
        let contact_distance = scene.parameters::<f64>().contact_distance;
        let share = held_share(scene);
        return (share * share - 1.0) * (height - contact_distance);
    }
    2.0 * (e - assumed) / ((1.0 + e) * (1.0 + assumed) * scene.energy_gain * scene.gravity)
}

/// s/(2 − s) with s = (1 + e)/(1 + ê): the speed that [`EnergyFeedback::OneStrike`] settles at, over the speed that it aims at.
fn held_share(scene: &Scene) -> f64 {
    (1.0 + scene.restitution) / (1.0 + 2.0 * scene.assumed_restitution() - scene.restitution)
}

/// The upright bounce in place that a law with feedback comes to: where the strike neither takes energy nor gives any, on the
/// energy of the release where that holds at any height. No drift is left, which is what sets it apart from that of a
/// proportional tilt. Friction takes the energy of sideways motion and spin.
///
/// # Errors
/// A sentence that says why there is none.
pub fn bounce_in_place(scene: &Scene) -> Result<FixedPoint, String> {
    bounce_beside(scene, 0.0, None)
}

/// [`bounce_in_place`] with a drift c (m/s) beside it, which takes its part of an energy that is kept or held. A matched table with friction
/// that leaves the drift has `lent` (m²/s²) to the run by then.
///
/// # Errors
/// Same as [`bounce_in_place`].
fn bounce_beside(scene: &Scene, drift: f64, lent: Option<f64>) -> Result<FixedPoint, String> {
    if scene.body() == BodyShape::Point {
        return Err("a point mass has no angle to feed back".to_owned());
    }
    if let Some(program) = scene.program() {
        return Err(no_single_bounce(program));
    }
    let rod: Rod = scene.parameters();
    let weight = rod.gravity * rod.contact_distance;
    if scene.lag() != 0.0 && contact_regime(&scene.model()) == ContactRegime::VelocityMatched {
        return Err("with slide `matched` the table misses the speed of the contact by a delay, for which the bounce is not derived".to_owned());
    }
    let held = if holds_total(scene) { drift } else { 0.0 };
    if let Some(delayed) = DelayedHeight::of(scene, held) {
        let speed = delayed?.speed;
        return Ok(FixedPoint::new(held, speed * speed, rod.gravity, rod.contact_distance));
    }
    let available = if rod.energy_feedback == EnergyFeedback::OneStrike {
        2.0 * (rod.target_energy + rod.gravity * height_error(scene) - weight)
    } else if rod.strike_gain_per_energy != 0.0 {
        2.0 * (rod.target_energy + (rod.strike_gain - 2.0) / rod.strike_gain_per_energy - weight)
    } else if rod.strike_gain != 2.0 {
        return Err(format!(
            "the table gives back {} of a bounce's normal speed and nothing steers its height, so no bounce repeats",
            rod.strike_gain - 1.0
        ));
    } else {
        let start = scene.start();
        let spin = rod.radius_of_gyration * start.theta_dot;
        let mut kinetic = start.y_dot * start.y_dot;
        if let Some(lent) = lent.or((contact_regime(&scene.model()) == ContactRegime::Frictionless).then_some(0.0)) {
            kinetic += start.x_dot * start.x_dot + spin * spin - drift * drift + 2.0 * lent;
        }
        kinetic + 2.0 * (rod.gravity * scene.release().height - weight)
    };
    let share = if rod.energy_feedback == EnergyFeedback::OneStrike { held_share(scene) } else { 1.0 };
    let taken = share * held;
    let speed_squared = available - taken * taken;
    if !speed_squared.is_finite() || speed_squared <= 0.0 {
        return Err(format!("the square of its speed would be {speed_squared} m²/s²: there is no upright bounce"));
    }
    Ok(FixedPoint::new(held, speed_squared, rod.gravity, rod.contact_distance))
}

/// The bounce and the drift (m/s) of a feedback of θ and θ̇ alone, each with the other.
fn place_and_drift(scene: &Scene, feedback: AngleFeedback) -> Result<(FixedPoint, f64), String> {
    let mut drift = scene.start().x_dot;
    let mut place = bounce_beside(scene, 0.0, None)?;
    for _ in 0..MOST_ROUNDS {
        let known = drift;
        drift = feedback.drift(scene, place.speed, known).ok_or("the release comes to no contact")?;
        place = bounce_beside(scene, drift, Some(feedback.lent_energy(scene, place.speed)))?;
        if (drift - known).abs() <= SAME_DRIFT * place.speed {
            break;
        }
    }
    Ok((place, drift))
}
