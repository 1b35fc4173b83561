//! A throw: one strike that sends the body to an apex of chosen height and angle.
//!
//! Without friction the tilt and the speed of the table follow in closed form. With friction a search finds them on the exact strike: for
//! each tilt, one speed of the table gives the vertical velocity ẏ⁺, and the tilts are looked through from level to both sides until the
//! spin θ̇⁺ changes sides of the wanted one, so that of several tilts the least is found. Either way the throw that is returned is the exact
//! strike and the exact flight of that table, with what they miss of the target.

use crate::analysis::root::root;
use crate::catching::aim::{Aim, rise_before};
use crate::map::body::{Arrival, Body, NoContact, PreImpact, Release, Touch};
use crate::map::flight::{Decay, Flight};
use crate::map::strike::{PlannedTableMotion, Rod, State, Strike};
use crate::map::table::actuator_load::{ActuatorLoad, LimitViolation, Pose};
use crate::numbers::trig;
use crate::run::lasting_contact::moving_rate;
use crate::run::rules::{Rules, SPEED_LIMIT};
use crate::scene::Scene;
use std::convert::Infallible;
use std::f64::consts::FRAC_PI_2;
use thiserror::Error;

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
/// The table assumes the restitution that the scene's table assumes. It moves along itself as the scene says. `before` is the table at the strike
/// before with the flight since then, s, if there was one.
pub fn throw(
    scene: &Scene,
    coming: &PreImpact,
    before: Option<(Pose, f64)>,
    target: &ThrowTarget,
) -> Result<Throw, ThrowFailure> {
    if scene.is_point() {
        return Err(ThrowFailure::PointMass);
    }
    let (body, errors) = (thrown_body(scene), scene.leaning_errors());
    let sensed = State { theta: coming.state.theta + errors.angle_bias, ..coming.state };
    let sensed = PreImpact { state: sensed, ..*coming };
    let (wanted, iterations, told) = plan(&body, scene.specified_restitution(), &sensed, target)?;
    let motion = errors.executed(&told);
    let place = coming.x + body.rod.contact_distance * trig::sin_cos(coming.state.theta).0;
    let Rules { half_length: limit, limits, .. } = scene.rules();
    if place.abs() > limit {
        return Err(ThrowFailure::OffTable { place, limit });
    }
    let struck = PreImpact { plan: Some(motion), ..*coming };
    let strike = body.strike(&struck);
    let load = Pose::of(&strike).load(before);
    if let Some(violation) = limits.and_then(|limits| limits.exceeded(&load)) {
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
    let from = coming.height(&body.rod);
    let apex = apex(&body, from, coming.x, &strike);
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
        release: Release { x: coming.x, height: from, state: strike.after },
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
pub fn throw_from_contact(
    scene: &Scene,
    held: &PreImpact,
    pose: Pose,
    target: &ThrowTarget,
) -> Result<ThrowFromContact, ThrowFailure> {
    let body = thrown_body(scene);
    let rate = moving_rate(&body.rod, scene.limits().as_ref());
    let mut time = 0.0;
    for _ in 0..MOST_GUESSES {
        let coming = fallen(&body, held, time);
        let thrown = throw(scene, &coming, None, target)?;
        let change = (thrown.strike.alpha - pose.alpha).abs();
        let needed = if change == 0.0 { 0.0 } else { change / rate };
        if needed <= time {
            let load = if time > 0.0 { Pose::of(&thrown.strike).load(Some((pose, time))) } else { thrown.load };
            let load = ActuatorLoad { stroke: load.stroke.max((held.clearance - coming.clearance).abs()), ..load };
            if let Some(violation) = scene.limits().and_then(|limits| limits.exceeded(&load)) {
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
fn fallen(body: &Body, held: &PreImpact, time: f64) -> PreImpact {
    if time == 0.0 {
        return *held;
    }
    let flight = body.flight(held.state, held.clearance);
    PreImpact { x: held.x + flight.travel(time).0, state: flight.end(time), clearance: flight.gap(time).value, ..*held }
}

/// Velocities that a throw needs just after the strike.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WantedVelocities {
    /// ẏ⁺, m/s; √(2G(y_a − y)) without air.
    rise: f64,
    /// θ̇⁺, rad/s; (θ_a − θ)G/ẏ⁺ without air.
    spin: f64,
    /// Angle at the apex for each unit of spin, s.
    turning: f64,
}

impl WantedVelocities {
    fn new(body: &Body, coming: &PreImpact, target: &ThrowTarget) -> Result<Self, ThrowFailure> {
        let rod = &body.rod;
        let (_, cos_theta) = trig::sin_cos(coming.state.theta);
        if cos_theta <= 0.0 {
            return Err(ThrowFailure::Lying { theta: coming.state.theta });
        }
        let from = coming.height(rod);
        let way = target.height - from;
        if way <= 0.0 {
            return Err(ThrowFailure::TooLow { height: target.height, least: from });
        }
        let (rise, time) = rise_before(body, way, 0.0);
        let turning = body.drag.map_or(time, |drag| Decay::new(drag.rotational, time).way);
        let spin = (target.theta - coming.state.theta) / turning;
        let speed = rise.max(rod.contact_distance * spin.abs());
        // A speed that is not a number is too fast as well.
        if !speed.lt(&SPEED_LIMIT) {
            return Err(ThrowFailure::TooFast { speed });
        }
        if rise <= coming.state.y_dot {
            return Err(ThrowFailure::CannotPush { y_dot: coming.state.y_dot, rise });
        }
        Ok(Self { rise, spin, turning })
    }
}

/// The body of a scene on a table whose motion is planned from outside.
fn thrown_body(scene: &Scene) -> Body {
    let Body { rod, steering, friction, drag, outline, .. } = scene.running_model;
    Body { steering, friction, drag, outline, ..Body::plain(rod) }
}

/// Motion of a table that assumes the restitution `assumed`, with the velocities that it is to give and the steps of the search.
fn plan(
    body: &Body,
    assumed: f64,
    coming: &PreImpact,
    target: &ThrowTarget,
) -> Result<(WantedVelocities, u32, PlannedTableMotion), ThrowFailure> {
    let body = &Body { rod: Rod { restitution: assumed, ..body.rod }, outline: None, ..*body };
    let wanted = WantedVelocities::new(body, coming, target)?;
    let Some(friction) = body.rough() else {
        return Ok((wanted, 0, frictionless_motion(body, &coming.state, &wanted)));
    };
    let coming = PreImpact::at(coming.n, coming.x, coming.state);
    let mut search = Search { body, coming, wanted, steps: 0 };
    let found = search.least_tilt().map_err(|reach| {
        let angle = |spin: f64| coming.state.theta + spin * wanted.turning;
        let reach = reach.map(|(least, most)| (angle(least), angle(most)));
        ThrowFailure::AngleOutOfReach { theta: target.theta, friction: friction.coefficient, reach }
    })?;
    let motion = Aim::new(body, &coming.state, found.alpha).approaching(found.approach);
    Ok((wanted, search.steps, motion))
}

/// Without friction: with A = ẏ⁺ − ẏ and B = (ρ²/l)(θ̇⁺ − θ̇), tan α = (A sin θ − B)/(A cos θ) and P = A/cos α.
fn frictionless_motion(body: &Body, state: &State, wanted: &WantedVelocities) -> PlannedTableMotion {
    let (sin_theta, cos_theta) = trig::sin_cos(state.theta);
    let rho = body.rod.radius_of_gyration;
    let lift = wanted.rise - state.y_dot;
    let turn = rho * rho / body.rod.contact_distance * (wanted.spin - state.theta_dot);
    let alpha = libm::atan2(lift * sin_theta - turn, lift * cos_theta);
    let (_, cos_alpha) = trig::sin_cos(alpha);
    Aim::new(body, state, alpha).motion(lift / cos_alpha)
}

/// Apex of a flight after a strike that starts at height `from`, m.
fn apex(body: &Body, from: f64, x: f64, strike: &Strike) -> Apex {
    let flight = Flight { drag: body.drag, ..body.rod.flight(strike) };
    let t = flight.time_to_top();
    let (way, climb) = flight.travel(t);
    Apex { t, x: x + way, y: from + climb, theta: flight.end(t).theta }
}

/// Number of tilts that are tried on each side.
const TILTS: u32 = 96;

/// Largest number of doublings of a speed.
const MOST_DOUBLINGS: u32 = 128;

/// Largest error of a spin that counts as found, as a share of the spins involved.
const FOUND: f64 = 1e-10;

/// Search for the strike that gives the wanted velocities with the least tilt.
struct Search<'a> {
    body: &'a Body,
    coming: PreImpact,
    wanted: WantedVelocities,
    steps: u32,
}

/// A tilt, and the strike there that gives the wanted rise.
#[derive(Clone, Copy)]
struct Candidate {
    alpha: f64,
    /// Speed at which table and contact point approach each other along the normal, m/s.
    approach: f64,
    /// θ̇⁺ less the wanted one, rad/s.
    miss: f64,
}

impl Search<'_> {
    /// The strike with the least tilt. Fails with the least and largest spin reached, if any tilt gives the rise.
    fn least_tilt(&mut self) -> Result<Candidate, Option<(f64, f64)>> {
        let level = self.candidate(0.0);
        let (mut nearest, mut spins) = ([level; 2], Vec::from_iter(level.map(|level| level.miss + self.wanted.spin)));
        for ring in 1..=TILTS {
            let tilt = FRAC_PI_2 * f64::from(ring) / f64::from(TILTS + 1);
            let mut roots = Vec::new();
            for (last, alpha) in nearest.iter_mut().zip([tilt, -tilt]) {
                let next = self.candidate(alpha);
                roots.extend(last.zip(next).and_then(|(from, to)| self.between(&from, &to)));
                spins.extend(next.map(|next| next.miss + self.wanted.spin));
                *last = next;
            }
            if let Some(found) = roots.into_iter().min_by(|one, other| one.alpha.abs().total_cmp(&other.alpha.abs())) {
                return Ok(found);
            }
        }
        let least = spins.iter().copied().reduce(f64::min);
        Err(least.zip(spins.into_iter().reduce(f64::max)))
    }

    /// Angle and velocities after a strike.
    fn strike(&mut self, alpha: f64, approach: f64) -> State {
        self.steps += 1;
        let plan = Some(Aim::new(self.body, &self.coming.state, alpha).approaching(approach));
        self.body.strike(&PreImpact { plan, ..self.coming }).after
    }

    /// The strike at a tilt that gives the rise; `None` if no speed does.
    fn candidate(&mut self, alpha: f64) -> Option<Candidate> {
        let WantedVelocities { rise, spin, .. } = self.wanted;
        let missing = self.coming.state.y_dot - rise;
        let mut fast = -missing;
        let mut missed = self.strike(alpha, fast).y_dot - rise;
        for _ in 0..MOST_DOUBLINGS {
            if missed >= 0.0 || !fast.is_finite() {
                break;
            }
            fast *= 2.0;
            missed = self.strike(alpha, fast).y_dot - rise;
        }
        if !missed.ge(&0.0) {
            return None;
        }
        let miss = |approach| Ok::<_, Infallible>(Some(self.strike(alpha, approach).y_dot - rise));
        let Ok((approach, _)) = root([(fast, missed), (0.0, missing)], 0.0, miss);
        Some(Candidate { alpha, approach, miss: self.strike(alpha, approach).theta_dot - spin })
    }

    /// The strike between two tilts that gives the spin, if that lies between theirs.
    fn between(&mut self, from: &Candidate, to: &Candidate) -> Option<Candidate> {
        if from.miss == 0.0 {
            return Some(*from);
        }
        if (from.miss < 0.0) == (to.miss < 0.0) {
            return None;
        }
        let miss = |alpha| Ok::<_, Infallible>(self.candidate(alpha).map(|candidate| candidate.miss));
        let Ok((alpha, _)) = root([(to.alpha, to.miss), (from.alpha, from.miss)], 0.0, miss);
        let WantedVelocities { rise, spin, .. } = self.wanted;
        let scale = spin.abs() + self.coming.state.theta_dot.abs() + rise / self.body.rod.contact_distance;
        // A jump of the strike is no root.
        self.candidate(alpha).filter(|candidate| candidate.miss.abs() <= FOUND * scale)
    }
}

/// Largest tilt of a throw, rad: 80°. A steeper table throws to the side what it should lift, and no rig tilts so far.
pub const STEEPEST: f64 = 1.4;

/// Reason for which no strike throws a body to a target.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum ThrowFailure {
    #[error("a point mass has no angle to be thrown to")]
    PointMass,
    #[error("the contact point is at {place} m, and the table ends at {limit} m")]
    OffTable { place: f64, limit: f64 },
    #[error("the body lies at theta {theta} rad; a throw needs an angle within a quarter turn of upright")]
    Lying { theta: f64 },
    #[error("the apex at {height} m is not above the centre of gravity, which is at {least} m at the strike")]
    TooLow { height: f64, least: f64 },
    #[error(
        "the table would have to pull: the body rises at {y_dot} m/s before the strike and the throw needs {rise} m/s after it"
    )]
    CannotPush { y_dot: f64, rise: f64 },
    #[error("{}", out_of_reach(*theta, *friction, *reach))]
    AngleOutOfReach {
        theta: f64,
        friction: f64,
        /// Least and largest angle at the apex, rad, that tilts below a quarter turn reach; `None` if no tilt reaches the height.
        reach: Option<(f64, f64)>,
    },
    #[error("the strike needs a tilt of {alpha} rad; no throw tilts the table beyond {STEEPEST} rad")]
    TooSteep { alpha: f64 },
    #[error("the strike needs {0}")]
    BeyondLimits(LimitViolation),
    #[error("vertex {} {}", .0.vertex, met(.0))]
    OtherVertex(Touch),
    #[error("the contact point does not rise from the strike: its vertical velocity is {contact_rise} m/s")]
    ContactSinks { contact_rise: f64 },
    #[error("the contact point comes down to the table {t} s after the strike, before the apex at {apex} s")]
    ContactReturns { t: f64, apex: f64 },
    #[error("{time} s after giving way the table is not at the tilt of the throw; it tilts at {rate} rad/s")]
    OutrunsTable { rate: f64, time: f64 },
    #[error("the throw needs a speed of {speed} m/s")]
    TooFast { speed: f64 },
}

fn out_of_reach(theta: f64, friction: f64, reach: Option<(f64, f64)>) -> String {
    match reach {
        None => format!(
            "with friction {friction} no tilt below a quarter turn reaches the height of the apex with theta {theta} rad"
        ),
        Some((least, most)) => format!(
            "theta {theta} rad at the apex is out of reach with friction {friction}: tilts below a quarter turn reach {least} to {most} rad"
        ),
    }
}

fn met(touch: &Touch) -> String {
    match touch.t {
        0.0 => "is below the tilted table at the strike".to_owned(),
        t => format!("comes down to the table {t} s after the strike, before the apex"),
    }
}
