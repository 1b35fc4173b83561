//! A throw: one strike that sends the body to an apex of chosen height and angle.
//!
//! Without friction the tilt and the speed of the table follow in closed form. With friction [`search`] finds them on the exact strike.
//! Either way the throw that is returned is the exact strike and the exact flight of that table, with what they miss of the target.

mod failure;
mod search;

pub use failure::{STEEPEST, ThrowFailure};

use crate::body::{Arrival, Body, NoContact, PreImpact, Release};
use crate::bounce::strike::{PlannedTableMotion, Rod, State, Strike};
use crate::catching::aim::Aim;
use crate::contact::moving_rate;
use crate::numbers::trig;
use crate::run::rules::SPEED_LIMIT;
use crate::scene::{BodyShape, Scene};
use crate::table::actuator_load::{ActuatorLoad, Pose};

/// Apex that a throw aims at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrowTarget {
    /// Height of the centre of gravity, m.
    pub height: f64,
    /// Angle there, rad: π further for half a turn, 2π for a whole one.
    pub theta: f64,
}

/// Apex of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apex {
    /// Time since the strike, s.
    pub t: f64,
    /// Place of the centre of gravity, m.
    pub x: f64,
    /// Height of the centre of gravity, m.
    pub y: f64,
    /// Angle, rad.
    pub theta: f64,
}

/// A throw: the strike, and the flight that it starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Throw {
    /// Motion of the table.
    pub motion: PlannedTableMotion,
    /// The strike of the scene's body on that table.
    pub strike: Strike,
    /// Apex of the flight.
    pub apex: Apex,
    /// Distance of the apex from the target, m: the larger of height and ρ times angle. It is rounding, unless the table assumes a
    /// restitution that is not the contact's.
    pub residual: f64,
    /// Steps of the search; 0 in closed form.
    pub iterations: u32,
    /// Load of the strike on the table.
    pub load: ActuatorLoad,
    /// The body just after the strike, as a release: a run that starts there has the flight of the throw.
    pub release: Release,
    /// End of the flight: the next contact, or the reason for which there is none.
    pub landing: Result<Arrival, NoContact>,
}

/// Throws the body of a scene, which comes to a strike or rests on the table, to an apex.
///
/// The table assumes the restitution that the scene's table assumes. It moves along itself as the scene says.
///
/// # Errors
/// The reason for which no strike throws it there.
pub fn throw(scene: &Scene, coming: &PreImpact, target: &ThrowTarget) -> Result<Throw, ThrowFailure> {
    if scene.body() == BodyShape::Point {
        return Err(ThrowFailure::PointMass);
    }
    if let Some(name) = scene.beyond_ideal_rig() {
        return Err(ThrowFailure::Rig(name));
    }
    let body = thrown_body(scene);
    let (wanted, iterations, motion) = plan(&body, scene.assumed_restitution(), coming, target)?;
    let struck = PreImpact { plan: Some(motion), ..*coming };
    let strike = body.strike(&struck);
    let load = Pose::of(&strike).load(None);
    if let Some(violation) = scene.limits.and_then(|limits| limits.exceeded(&load)) {
        return Err(ThrowFailure::BeyondLimits(violation));
    }
    if let Some(touch) = body.touches(&struck, &strike) {
        return Err(ThrowFailure::OtherVertex(touch));
    }
    if strike.approach >= 0.0 {
        return Err(ThrowFailure::CannotPush { y_dot: coming.state.y_dot, rise: wanted.rise });
    }
    if coming.clearance <= 0.0 && strike.contact_rise <= body.rise_rounding(&coming.state, &strike) {
        return Err(ThrowFailure::ContactSinks { contact_rise: strike.contact_rise });
    }
    let apex = apex(&body.rod, wanted.from, coming.x, &strike.after);
    let landing = body.fly(coming, &strike);
    match landing {
        Err(NoContact::OtherVertex(touch)) if touch.t <= apex.t => return Err(ThrowFailure::OtherVertex(touch)),
        Ok(Arrival { t, .. }) if t <= apex.t => return Err(ThrowFailure::ContactReturns { t, apex: apex.t }),
        Ok(_) | Err(_) => {}
    }
    if strike.alpha.abs() > STEEPEST {
        return Err(ThrowFailure::TooSteep { alpha: strike.alpha });
    }
    let turn = body.rod.radius_of_gyration * (apex.theta - target.theta);
    Ok(Throw {
        motion,
        strike,
        apex,
        residual: (apex.y - target.height).abs().max(turn.abs()),
        iterations,
        load,
        release: Release { x: coming.x, height: wanted.from, state: strike.after },
        landing,
    })
}

/// Most guesses of the time in which the table goes to the tilt of a throw. Each comes nearer by a digit or more.
const MOST_GUESSES: u32 = 64;

/// A throw from lasting contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrowFromContact {
    /// The throw.
    pub thrown: Throw,
    /// The body as it comes to the strike.
    pub coming: PreImpact,
    /// Time from the contact to the strike, s.
    pub time: f64,
}

/// Throws a body from a table that has held it at the tilt and the velocity `pose`: the table gives way and goes to the tilt of the throw at
/// [`moving_rate`], while the body falls freely; then it strikes. A table that has the tilt of the throw strikes at once.
///
/// # Errors
/// The reason for which no strike throws it there.
pub fn throw_from_contact(
    scene: &Scene,
    held: &PreImpact,
    pose: Pose,
    target: &ThrowTarget,
) -> Result<ThrowFromContact, ThrowFailure> {
    let rod = scene.parameters();
    let rate = moving_rate(&rod, scene.limits.as_ref());
    let mut time = 0.0;
    for _ in 0..MOST_GUESSES {
        let coming = fallen(&rod, held, time);
        let thrown = throw(scene, &coming, target)?;
        let change = (thrown.strike.alpha - pose.alpha).abs();
        let needed = if change == 0.0 { 0.0 } else { change / rate };
        if needed <= time {
            let load = if time > 0.0 { Pose::of(&thrown.strike).load(Some((pose, time))) } else { thrown.load };
            let load = ActuatorLoad { stroke: load.stroke.max((held.clearance - coming.clearance).abs()), ..load };
            if let Some(violation) = scene.limits.and_then(|limits| limits.exceeded(&load)) {
                return Err(ThrowFailure::BeyondLimits(violation));
            }
            return Ok(ThrowFromContact { thrown: Throw { load, ..thrown }, coming, time });
        }
        if !needed.is_finite() {
            break;
        }
        time = needed;
    }
    Err(ThrowFailure::OutrunsTable { rate, time })
}

/// The body `time` s after the table has given way.
fn fallen(rod: &Rod, held: &PreImpact, time: f64) -> PreImpact {
    if time == 0.0 {
        return *held;
    }
    let PreImpact { x, state, clearance, .. } = *held;
    let (_, cos) = trig::sin_cos(state.theta);
    let theta = state.theta + state.theta_dot * time;
    let (_, cos_then) = trig::sin_cos(theta);
    let rise = time * (state.y_dot - 0.5 * rod.gravity * time);
    PreImpact {
        x: x + state.x_dot * time,
        state: State { theta, y_dot: state.y_dot - rod.gravity * time, ..state },
        clearance: clearance + rise + rod.contact_distance * (cos - cos_then),
        ..*held
    }
}

/// Velocities that a throw needs just after the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WantedVelocities {
    /// Height of the centre of gravity at the strike, m.
    from: f64,
    /// ẏ⁺ = √(2G(y_a − y)), m/s.
    rise: f64,
    /// θ̇⁺ = (θ_a − θ)G/ẏ⁺, rad/s.
    spin: f64,
}

impl WantedVelocities {
    fn new(rod: &Rod, coming: &PreImpact, target: &ThrowTarget) -> Result<Self, ThrowFailure> {
        let (_, cos_theta) = trig::sin_cos(coming.state.theta);
        if cos_theta <= 0.0 {
            return Err(ThrowFailure::Lying { theta: coming.state.theta });
        }
        let from = coming.clearance + rod.contact_distance * cos_theta;
        let way = target.height - from;
        if way <= 0.0 {
            return Err(ThrowFailure::TooLow { height: target.height, least: from });
        }
        let rise = (2.0 * rod.gravity * way).sqrt();
        let spin = (target.theta - coming.state.theta) * rod.gravity / rise;
        let speed = rise.max(rod.contact_distance * spin.abs());
        // A speed that is not a number is too fast as well.
        if !speed.lt(&SPEED_LIMIT) {
            return Err(ThrowFailure::TooFast { speed });
        }
        if rise <= coming.state.y_dot {
            return Err(ThrowFailure::CannotPush { y_dot: coming.state.y_dot, rise });
        }
        Ok(Self { from, rise, spin })
    }
}

/// The body of a scene on a table whose motion is planned from outside.
fn thrown_body(scene: &Scene) -> Body {
    Body {
        steering: scene.steering,
        friction: scene.contact_friction(),
        outline: scene.outline,
        ..Body::plain(scene.parameters())
    }
}

/// Motion of a table that assumes the restitution `assumed`, with the velocities that it is to give and the steps of the search.
fn plan(
    body: &Body,
    assumed: f64,
    coming: &PreImpact,
    target: &ThrowTarget,
) -> Result<(WantedVelocities, u32, PlannedTableMotion), ThrowFailure> {
    let rod = Rod { restitution: assumed, ..body.rod };
    let wanted = WantedVelocities::new(&rod, coming, target)?;
    match body.friction.filter(|friction| friction.coefficient != 0.0) {
        None => Ok((wanted, 0, frictionless_motion(&rod, &coming.state, &wanted))),
        Some(friction) => match search::motion(&rod, &friction, &coming.state, wanted.rise, wanted.spin) {
            Ok((motion, iterations)) => Ok((wanted, iterations, motion)),
            Err(reach) => {
                let time = wanted.rise / rod.gravity;
                let angle = |spin: f64| coming.state.theta + spin * time;
                let reach = reach.map(|(least, most)| (angle(least), angle(most)));
                Err(ThrowFailure::AngleOutOfReach { theta: target.theta, friction: friction.coefficient, reach })
            }
        },
    }
}

/// Motion of a table without friction: with A = ẏ⁺ − ẏ and B = (ρ²/l)(θ̇⁺ − θ̇), tan α = (A sin θ − B)/(A cos θ) and
/// P = A/cos α.
fn frictionless_motion(rod: &Rod, state: &State, wanted: &WantedVelocities) -> PlannedTableMotion {
    let (sin_theta, cos_theta) = trig::sin_cos(state.theta);
    let rho = rod.radius_of_gyration;
    let lift = wanted.rise - state.y_dot;
    let turn = rho * rho / rod.contact_distance * (wanted.spin - state.theta_dot);
    let alpha = libm::atan2(lift * sin_theta - turn, lift * cos_theta);
    let (_, cos_alpha) = trig::sin_cos(alpha);
    Aim::new(rod, 0.0, state, alpha).motion(lift / cos_alpha)
}

/// Apex of a flight that starts at height `from`, m.
fn apex(rod: &Rod, from: f64, x: f64, after: &State) -> Apex {
    let t = after.y_dot / rod.gravity;
    Apex { t, x: x + after.x_dot * t, y: from + 0.5 * after.y_dot * t, theta: after.theta + after.theta_dot * t }
}
