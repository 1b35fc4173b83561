//! Small deviations from the bounce of a scene that repeats: the bounce, how they move, and the gains up to which they stay small.
//!
//! The plain rod with a tilt gain has closed forms for that. For any other scene it follows from the return map.

use crate::analysis::fixed_point::{FixedPoint, plain_bounce, plain_drift};
use crate::analysis::gain_range::StableGains;
use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict, PARABOLIC, class, energy_gains, linear_verdict};
use crate::analysis::repeating::{
    self, Neutral, NoRepeatingBounce, ON_CIRCLE, ON_CIRCLE_TWICE, RepeatingBounce, SceneMap, find_planned, settled,
};
use crate::analysis::return_map::{ReturnMap, SOLVED, Vector, X, X_DOT, Y_DOT};
use crate::map::strike::State;
use crate::scene::Scene;
use nalgebra::Complex;

/// Motion of small deviations beside the neutral directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// They die out.
    DiesOut,
    /// They circle: the eigenvalue λ above the real axis is on the unit circle.
    Circles(Complex<f64>),
    /// A real eigenvalue is on the unit circle, and no quantity is kept there.
    Silent(f64),
    /// An eigenvalue of this modulus is outside the unit circle.
    Grows(f64),
}

impl Motion {
    /// Tells whether they stay small to first order.
    pub fn is_bounded(self) -> bool {
        matches!(self, Self::DiesOut | Self::Circles(_))
    }
}

/// Small deviations from the bounce of a scene that repeats.
#[derive(Clone, Debug)]
pub struct SmallDeviations {
    /// The bounce.
    pub fixed_point: FixedPoint,
    /// Eigenvalues, with the ends of the gains that are known without a search.
    pub linear: LinearVerdict,
    /// Their motion.
    pub motion: Motion,
    /// True if a drift stays: nothing brings it back, or a wind keeps it.
    pub drifts: bool,
    /// Speed of the drift of the release, if it is neutral and known, m/s.
    pub drift: Option<f64>,
    /// The stable range of a factor on the state feedback, where it was searched ([`crate::analysis::losses::search_ends`]).
    pub feedback_range: Option<StableGains>,
    /// The bounce on its map, with the drift and the energy of the release; `None` where closed forms take its place.
    pub found: Option<RepeatingBounce>,
}

/// Small deviations from the bounce of a scene that repeats, or with a program of heights from the bounces.
pub fn small_deviations(scene: &Scene) -> Result<SmallDeviations, NoRepeatingBounce> {
    let scene = &scene.with_tilt_law();
    plain_bounce(scene).map_or_else(|| of_map(scene), |fixed_point| Ok(in_closed_form(scene, fixed_point)))
}

impl SmallDeviations {
    /// The same about the bounce without its drift, with all of a total energy that the table holds.
    pub fn without_drift(self, scene: &Scene) -> Result<Self, NoRepeatingBounce> {
        if self.fixed_point.x_dot == 0.0 {
            return Ok(self);
        }
        let RepeatingBounce { map, mut at, .. } = self.on_map(scene)?;
        at[X_DOT] = 0.0;
        let found = repeating::find(&map, &at, &at)?;
        Ok(match self.found {
            None => in_closed_form(&scene.with_tilt_law(), fixed_point_at(&map, &found.at)),
            Some(_) => about(scene, found, Some(0.0)),
        })
    }

    /// Factor a bounce of the deviation that dies out most slowly: the largest modulus below 1.
    pub fn slowest(&self) -> f64 {
        let moduli = self.linear.eigenvalues.iter().copied().map(modulus);
        moduli.filter(|value| *value < 1.0).fold(0.0, f64::max)
    }

    /// The drift that stays, m/s; 0 where none is known.
    pub fn lasting_drift(&self) -> f64 {
        self.drift.unwrap_or(self.fixed_point.x_dot)
    }

    /// The state just before a contact, with the drift of the release.
    pub fn state(&self) -> State {
        match &self.found {
            Some(bounce) => bounce.map.state(&bounce.at),
            None => State { x_dot: self.lasting_drift(), ..self.fixed_point.state() },
        }
    }

    /// The bounce on the map of the scene, with the drift and the energy of the release.
    pub fn on_map(&self, scene: &Scene) -> Result<RepeatingBounce, NoRepeatingBounce> {
        if let Some(found) = &self.found {
            return Ok(found.clone());
        }
        let map = ReturnMap::new(&scene.with_tilt_law().model(), 1);
        let at = map.vector(&self.state(), self.fixed_point.x);
        repeating::find(&map, &at, &at)
    }
}

fn in_closed_form(scene: &Scene, fixed_point: FixedPoint) -> SmallDeviations {
    let linear = linear_verdict(scene, &fixed_point);
    let drift = if fixed_point.x_dot == 0.0 { plain_drift(scene) } else { Some(fixed_point.x_dot) };
    let motion = linear.motion();
    SmallDeviations {
        fixed_point,
        linear,
        motion,
        drifts: !scene.model().is_point,
        drift,
        feedback_range: None,
        found: None,
    }
}

/// The bounce of a scene on which its run settles, and the state whose kept quantities it has; without one that does, those of its release.
pub(super) fn settled_bounce(
    scene: &Scene,
    of_scene: &SceneMap,
) -> Result<(RepeatingBounce, Vector), NoRepeatingBounce> {
    let SceneMap { map: own, mut reference, .. } = *of_scene;
    let mut bounce = of_scene.find()?;
    let leaves_height =
        bounce.map.place_of(Y_DOT).is_some_and(|fall| bounce.matrix[(fall, fall)].abs() > 1.0 + ON_CIRCLE);
    if leaves_height
        && let Some(settled) = of_scene.settled().filter(|settled| motion(&settled.eigenvalues) == Motion::DiesOut)
    {
        // The table has several bounces, and another one draws the run to it.
        (reference, bounce) = (settled.at, settled);
    }
    // A run that settles has the drift and the energy on which it does.
    let settles = motion(&bounce.eigenvalues) == Motion::DiesOut && !bounce.neutral.is_empty();
    let settled = settles.then(|| scene.orbit().ok().and_then(|orbit| settled(&own, orbit, &bounce))).flatten();
    let goes_on = bounce.has_neutral_place();
    if settled.is_some() || goes_on {
        reference = settled.unwrap_or(reference);
        let (guess, mut member) = (settled.unwrap_or(bounce.at), reference);
        if goes_on {
            // Beside a drift that moves the place no bounce repeats: the one that is meant has none.
            member[X_DOT] = 0.0;
        }
        bounce = find_planned(&own, &guess, &member).unwrap_or(bounce);
    }
    Ok((bounce, reference))
}

fn of_map(scene: &Scene) -> Result<SmallDeviations, NoRepeatingBounce> {
    let of_scene = SceneMap::of(scene).map_err(|_| NoRepeatingBounce::NoContact)?;
    let (bounce, reference) = settled_bounce(scene, &of_scene)?;
    let half_length = scene.rules().half_length;
    let drift = lasting_drift(&bounce, &bounce.map.planned(&reference));
    if bounce.map.has_place && drift.is_none() && bounce.at[X].abs() > half_length {
        return Err(NoRepeatingBounce::BeyondTable { x: bounce.at[X], half_length });
    }
    Ok(about(scene, bounce, drift))
}

/// Small deviations from a bounce of the map of a scene, with the drift of the release, if it is neutral.
fn about(scene: &Scene, bounce: RepeatingBounce, drift: Option<f64>) -> SmallDeviations {
    let (map, motion) = (&bounce.map, motion(&bounce.eigenvalues));
    let mut fixed_point = fixed_point_at(map, &in_place(&bounce));
    if bounce.has_neutral_place() {
        // The same bounce belongs to every place.
        fixed_point.x = 0.0;
    }
    let mut linear = LinearVerdict::of_map(motion, &bounce);
    if let Some(StableGains { lower, upper }) = bounce.stable_gains()
        && map.body.feedback().is_none()
    {
        (linear.lower_tilt_gain, linear.critical_tilt_gain) = (lower, upper);
    }
    [linear.lower_energy_gain, linear.upper_energy_gain] = energy_gains(scene, &fixed_point, linear.residue);
    // A wind or a table that is level at a speed alone keeps a drift that nothing else does.
    let is_kept = !map.has_place && fixed_point.x_dot.abs() > SOLVED * fixed_point.speed;
    let drifts = drift.is_some() || is_kept;
    SmallDeviations { fixed_point, linear, motion, drifts, drift, feedback_range: None, found: Some(bounce) }
}

/// A state just before a contact that repeats.
pub(crate) fn fixed_point_at(map: &ReturnMap, at: &Vector) -> FixedPoint {
    let State { theta, theta_dot, .. } = map.state(at);
    FixedPoint {
        x: if map.has_place { at[X] } else { 0.0 },
        x_dot: at[X_DOT],
        // The angle of a point mass is that of its velocity.
        theta: if map.body.is_point { 0.0 } else { theta },
        theta_dot: if map.body.is_point { 0.0 } else { theta_dot },
        speed: -at[Y_DOT],
        flight_time: map.flight_time(at) / map.period as f64,
        apex_height: map.apex_height(at),
    }
}

/// The bounce without its drift, where the same bounce belongs to every drift.
fn in_place(bounce: &RepeatingBounce) -> Vector {
    let (map, mut at) = (&bounce.map, bounce.at);
    at[X_DOT] = 0.0;
    let repeats = map.image(&at).is_some_and(|image| map.is_near(&at, &image));
    if repeats { at } else { bounce.at }
}

/// Drift of a release beside a bounce, to first order, m/s; `None` where a drift is not neutral.
fn lasting_drift(bounce: &RepeatingBounce, release: &Vector) -> Option<f64> {
    let off = bounce.map.reduced(release) - bounce.map.reduced(&bounce.at);
    let along = bounce.map.place_of(X_DOT)?;
    let part = |neutral: &Neutral| {
        let part = neutral.right[along];
        (part.abs() > 1e-3 * neutral.right.amax()).then(|| part * neutral.left.dot(&off))
    };
    let parts: Vec<f64> = bounce.neutral.iter().filter_map(part).collect();
    (!parts.is_empty()).then(|| {
        let drift = bounce.at[X_DOT] + parts.iter().sum::<f64>();
        // Of a release without drift it is rounding.
        if drift.abs() < f64::EPSILON * bounce.at[Y_DOT].abs() { 0.0 } else { drift }
    })
}

impl LinearVerdict {
    /// The verdict on a bounce by its eigenvalues beside the neutral directions; those are exactly 1.
    fn of_map(motion_of_all: Motion, bounce: &RepeatingBounce) -> Self {
        let fall = bounce.map.place_of(Y_DOT).unwrap_or_default();
        let height = bounce.matrix[(fall, fall)];
        let is_height =
            |value: &Complex<f64>| modulus(*value - Complex::new(height, 0.0)) <= PARABOLIC * (1.0 + height.abs());
        let (mut eigenvalues, is_alone) = (bounce.eigenvalues.clone(), bounce.moves_alone(fall));
        let mut of_angle = eigenvalues.clone();
        if let Some(place) = of_angle.iter().position(is_height).filter(|_| is_alone) {
            of_angle.remove(place);
        }
        let pairs = (0..of_angle.len()).flat_map(|n| (0..n).map(move |m| (n, m)));
        let is_reciprocal =
            |&(n, m): &(usize, usize)| modulus(of_angle[n] * of_angle[m] - Complex::new(1.0, 0.0)) <= PARABOLIC;
        let residue = pairs.filter(is_reciprocal).map(|(n, m)| 0.25 * (2.0 - (of_angle[n] + of_angle[m]).re)).next();
        let motion = if is_alone { motion(&of_angle) } else { motion_of_all };
        let class = match (residue, motion) {
            (Some(residue), _) => class(residue),
            (None, Motion::DiesOut) => AngleClass::Attracting,
            (None, Motion::Circles(_)) => AngleClass::Elliptic,
            (None, Motion::Silent(_)) => AngleClass::Parabolic,
            (None, Motion::Grows(_)) => AngleClass::Hyperbolic,
        };
        let rotation = match motion {
            Motion::Circles(value) => Some(libm::acos(value.re.clamp(-1.0, 1.0))),
            _ => None,
        };
        eigenvalues.resize(bounce.matrix.nrows(), Complex::new(1.0, 0.0));
        sort_eigenvalues(&mut eigenvalues);
        Self {
            class,
            residue,
            rotation,
            eigenvalues,
            lower_tilt_gain: f64::INFINITY,
            critical_tilt_gain: f64::NEG_INFINITY,
            lower_energy_gain: 0.0,
            upper_energy_gain: f64::INFINITY,
            // Exactly 1 where the energy is kept.
            energy_eigenvalue: if (height - 1.0).abs() <= PARABOLIC { 1.0 } else { height },
        }
    }

    /// Motion of small deviations by a verdict in closed form.
    pub(super) fn motion(&self) -> Motion {
        let height = self.energy_eigenvalue;
        if height.abs() > 1.0 + PARABOLIC {
            return Motion::Grows(height.abs());
        }
        if height < PARABOLIC - 1.0 {
            return Motion::Silent(-1.0);
        }
        let circling = self.eigenvalues.iter().find(|value| value.im > 0.0);
        match (self.class, circling) {
            (AngleClass::Attracting, _) => Motion::DiesOut,
            (AngleClass::Elliptic, Some(value)) => Motion::Circles(*value),
            (AngleClass::Parabolic, _) if self.residue.is_some_and(|residue| residue < 0.5) => Motion::Silent(1.0),
            (AngleClass::Elliptic | AngleClass::Parabolic, _) => Motion::Silent(-1.0),
            (AngleClass::Hyperbolic, _) => {
                let largest = self.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max);
                let turns = self.eigenvalues.iter().any(|value| value.re <= ON_CIRCLE - 1.0);
                match largest > 1.0 + ON_CIRCLE {
                    true => Motion::Grows(largest),
                    // As a point mass at κ = 1.
                    false => Motion::Silent(if turns { -1.0 } else { 1.0 }),
                }
            }
        }
    }
}

/// Motion of small deviations, by their eigenvalues.
fn motion(values: &[Complex<f64>]) -> Motion {
    let largest = values.first().copied().map_or(0.0, modulus);
    let near = |value: &Complex<f64>, place: f64| modulus(*value - Complex::new(place, 0.0)) <= ON_CIRCLE_TWICE;
    if let Some(place) = [1.0, -1.0].into_iter().find(|&place| values.iter().any(|value| near(value, place)))
        && largest <= 1.0 + ON_CIRCLE_TWICE
    {
        return Motion::Silent(place);
    }
    if largest > 1.0 + ON_CIRCLE {
        Motion::Grows(largest)
    } else if let Some(circling) = values.iter().find(|value| value.im > 0.0 && modulus(**value) >= 1.0 - ON_CIRCLE) {
        Motion::Circles(*circling)
    } else {
        Motion::DiesOut
    }
}
