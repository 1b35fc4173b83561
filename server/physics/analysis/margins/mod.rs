//! Distance of a scene from the edge of stability when its body, or another number of it, deviates from the given one: small deviations over
//! a box of contact distances, radii of gyration, restitutions and values of further fields.
//!
//! The table keeps its gains and its assumed restitution. The errors of the rig have a budget of their own ([`budget`]).

pub mod budget;
pub mod judgement;

use crate::analysis::fixed_point::is_plain;
use crate::analysis::gain_range::StableGains;
use crate::analysis::limits::{Limit, NoLimits, Parameter, limits_of};
use crate::analysis::margins::budget::listed;
use crate::analysis::margins::judgement::NoMargins;
use crate::analysis::model_hierarchy::refused;
use crate::analysis::repeating::RepeatingBounce;
use crate::analysis::small_deviations::small_deviations;
use crate::scene::{Field, FieldKind, Name, Scene};

/// Fields that may have a tolerance in every box.
pub const OF_BODY: [Name; 3] = [Name::ContactDistance, Name::RadiusOfGyration, Name::Restitution];

/// Most fields with a tolerance besides those: the work grows with the power of their number.
pub const MOST_EXTRA: usize = 3;

/// Tolerance of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// The field, one of those that [`refusal`] lets through.
    pub name: Name,
    /// Tolerance in both directions, in the field's unit.
    pub off: f64,
}

/// Reason for which a field can have no tolerance; `None` if it can.
pub fn refusal(row: &Field) -> Option<String> {
    let path = row.path;
    let FieldKind::Number { .. } = row.kind else {
        return Some(format!("{path} has no numbers for values, so it has no tolerance"));
    };
    match row.name {
        Name::TiltGain => {
            Some(format!("the margin is that of {path} itself; an error of the table's tilt is table.errors.tilt_gain"))
        }
        name if name == Name::ToppleAngle || path.starts_with("table.limits.") => {
            Some(format!("{path} ends a run, and the linear verdict does not depend on it"))
        }
        _ if row.group() == "noise" => {
            Some(format!("{path} is random, and there is no linear verdict with noise; budget=true has its limit"))
        }
        _ => None,
    }
}

/// Range of a quantity over the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueRange {
    /// Minimum.
    pub least: f64,
    /// Maximum.
    pub most: f64,
}

/// The verdict over the whole box.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceMargins {
    /// The gain whose range is told: the tilt gain, or a factor on the gains of a state feedback.
    pub gain: Parameter,
    /// Lower end of its stable range: 1 for the tilt gain of most tables. Infinite where no gain balances.
    pub lower: ValueRange,
    /// Upper end of its stable range: κ_c of the tilt gain.
    pub critical: ValueRange,
    /// The values of the fields with a tolerance at which the upper end is least.
    pub worst: Vec<(Name, f64)>,
    /// Apex height of the centre of gravity in the bounce in place, m.
    pub apex_height: ValueRange,
    /// Eigenvalue of the energy.
    pub energy_eigenvalue: ValueRange,
    /// True if small deviations stay bounded for every body tried in the box, and the gain is between all its ends.
    pub holds: bool,
}

/// Quantities whose extremes are searched for, the least and the most of each of four.
const EXTREMES: usize = 8;

/// Most bodies of the margins with closed forms.
pub const MOST_BODIES: u64 = 11_000;

/// The same by the return map, where the range of the gain may have to be searched, which takes some 70 values of it.
pub const MOST_SEARCHED: u64 = 300;

/// Most rounds of the search, each over a smaller box about the best point so far.
const ROUNDS: usize = 24;

/// Grid points along each side of the box in the first round of the search, and the number of rounds, for so many sides and at most so many bodies
/// an extreme; at least the corners.
fn grid(sides: u32, most: usize) -> (usize, usize) {
    let points = [9, 7, 5, 4, 3].into_iter().find(|points: &usize| points.pow(sides) <= most * 3 / 5).unwrap_or(2);
    let later = most.saturating_sub(points.pow(sides)) / points.min(3).pow(sides);
    (points, (1 + later).min(ROUNDS))
}

/// Small deviations over a box of bodies. `go_on` is asked for each.
pub fn margins_over_tolerances(
    scene: &Scene,
    tolerances: &[Tolerance],
    go_on: &mut dyn FnMut() -> bool,
) -> Result<ToleranceMargins, NoMargins> {
    if scene.outline().is_some() {
        let rod = scene.as_rod().map_err(|errors| refused(&errors))?;
        return margins_over_tolerances(&rod, tolerances, go_on);
    }
    if scene.has_noise() {
        return Err(NoMargins::Because("with noise small deviations do not stay small".to_owned()));
    }
    let scene = &scene.with_tilt_law();
    if OF_BODY.iter().any(|name| scene.number(*name).is_none()) {
        return Err(NoMargins::Because("only a rod has lengths to be off".to_owned()));
    }
    let mut ordered = tolerances.to_vec();
    ordered.sort_by_key(|it| OF_BODY.iter().position(|name| *name == it.name).unwrap_or(OF_BODY.len()));
    let sides = ordered.iter().map(|it| Side::of(scene, it)).collect::<Result<Vec<_>, String>>()?;
    let gain = Parameter::of_gain(scene);
    let is_closed = |end: fn(&Side) -> f64| sampled(scene, &at(&sides, end)).is_ok_and(|it| is_plain(&it));
    let most = if is_closed(|side| side.low) && is_closed(|side| side.high) { MOST_BODIES } else { MOST_SEARCHED };
    let wide = tolerances.iter().filter(|tolerance| tolerance.off != 0.0).count();
    let (points, rounds) = grid(wide as u32, most as usize / EXTREMES);
    let mut bounded = true;
    let mut range = |of: fn(&BounceProperties) -> f64| {
        let mut least = |sign: f64| {
            search(&sides, points, rounds, |at| {
                if !go_on() {
                    return Err(NoMargins::Stopped);
                }
                let found = bounce_properties(scene, gain, at, &mut *go_on)?;
                bounded &= found.bounded;
                Ok(sign * of(&found))
            })
        };
        let (least_value, worst) = least(1.0)?;
        Ok::<_, NoMargins>((ValueRange { least: least_value, most: -least(-1.0)?.0 }, worst))
    };
    let (critical, worst) = range(|found| found.critical)?;
    let (energy_eigenvalue, _) = range(|found| found.energy)?;
    let (apex_height, _) = range(|found| found.apex)?;
    let (lower, _) = range(|found| found.lower)?;
    let value = gain.value(scene).unwrap_or(f64::NAN);
    Ok(ToleranceMargins {
        gain,
        lower,
        critical,
        worst,
        apex_height,
        energy_eigenvalue,
        holds: bounded && value > lower.most && value < critical.least,
    })
}

#[derive(Clone, Copy)]
struct Side {
    name: Name,
    low: f64,
    high: f64,
}

impl Side {
    /// The value in the scene with its tolerance, cut to the range of the field but for a length of the body. Errors that the scene leaves out are 0.
    fn of(scene: &Scene, tolerance: &Tolerance) -> Result<Self, String> {
        let Tolerance { name, off } = *tolerance;
        let row = name.row();
        let is_error = name != Name::PivotX && listed(true).any(|error| error.name == name);
        let Some(middle) = scene.number(name).or(is_error.then_some(0.0)) else {
            return Err(format!("the scene has no {}, about which values could lie; give it one", row.path));
        };
        let is_length = matches!(name, Name::ContactDistance | Name::RadiusOfGyration);
        let (minimum, maximum) = if is_length { (f64::NEG_INFINITY, f64::INFINITY) } else { row.range() };
        Ok(Self { name, low: (middle - off).max(minimum), high: (middle + off).min(maximum) })
    }

    /// So many evenly spaced values, one where the side has no length.
    fn grid(&self, points: usize) -> Vec<f64> {
        let steps = if self.low == self.high { 0 } else { points - 1 };
        let value = |k: usize| self.low + (self.high - self.low) * k as f64 / steps as f64;
        (0..steps).map(value).chain([self.high]).collect()
    }
}

/// Values of the fields at a point of the box.
type Point = [(Name, f64)];

/// The point of the box with a value on each side.
fn at(sides: &[Side], value: impl Fn(&Side) -> f64) -> Vec<(Name, f64)> {
    sides.iter().map(|side| (side.name, value(side))).collect()
}

/// Value of a field of the body at a point of the box.
fn value(scene: &Scene, at: &Point, name: Name) -> f64 {
    let own = at.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    own.or_else(|| scene.number(name)).unwrap_or(f64::NAN)
}

fn sampled(scene: &Scene, at: &Point) -> Result<Scene, String> {
    let told = scene.specified_restitution();
    let is_other = value(scene, at, Name::Restitution) != told;
    let assumed = (is_other && !scene.is_lossy()).then_some((Name::AssumedRestitution, told));
    scene.with(assumed.into_iter().chain(at.iter().copied()).map(|(name, value)| (name, Some(value))))
}

fn bounce_properties(
    scene: &Scene,
    gain: Parameter,
    at: &Point,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<BounceProperties, NoMargins> {
    let of = |why: String| {
        let further = at.iter().filter(|(name, _)| !OF_BODY.contains(name)).map(|(name, value)| {
            let row = name.row();
            let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
            format!(", {} {value}{unit}", row.path)
        });
        let [contact_distance, radius_of_gyration, restitution] = OF_BODY.map(|name| value(scene, at, name));
        NoMargins::Because(format!(
            "at contact_distance {contact_distance} m, radius_of_gyration {radius_of_gyration} m and restitution {restitution}{}: {why}",
            further.collect::<String>()
        ))
    };
    let sample = sampled(scene, at).map_err(of)?;
    let small = small_deviations(&sample).map_err(|why| of(format!("no bounce repeats: {why}")))?;
    // Gains as they are told, whatever the table makes of them.
    let acts = if gain == Parameter::FeedbackFactor { 1.0 } else { sample.tilt_factor() };
    let closed = StableGains { lower: small.linear.lower_tilt_gain, upper: small.linear.critical_tilt_gain };
    let (lower, critical) = match small.found.as_ref().map_or(Some(closed), RepeatingBounce::stable_gains) {
        Some(StableGains { lower, upper }) => (lower / acts, upper / acts),
        None => searched(&sample, gain, go_on)?,
    };
    Ok(BounceProperties {
        lower,
        critical,
        apex: small.fixed_point.apex_height,
        energy: small.linear.energy_eigenvalue,
        bounded: small.motion.is_bounded(),
    })
}

/// The ends of the stable range of a gain by a search, as far as the search knows them: outside the range the near end.
fn searched(scene: &Scene, gain: Parameter, go_on: &mut dyn FnMut() -> bool) -> Result<(f64, f64), NoMargins> {
    let limits = match limits_of(scene, gain, go_on) {
        Ok(limits) => limits,
        Err(NoLimits::Stopped) => return Err(NoMargins::Stopped),
        Err(NoLimits::NoNumber) => return Err("the scene has no gain".to_owned().into()),
    };
    let (lower, upper) = if limits.bounded { (limits.lower, limits.upper) } else { (limits.upper, limits.lower) };
    let none = if limits.bounded { f64::NEG_INFINITY } else { f64::INFINITY };
    let value = |limit: Option<Limit>, none: f64| limit.map_or(none, |limit| limit.value);
    Ok((value(lower, none), value(upper, -none)))
}

struct BounceProperties {
    lower: f64,
    critical: f64,
    apex: f64,
    energy: f64,
    bounded: bool,
}

/// Minimum of a smooth function over a box, and its location: the best point of a grid, then of smaller grids about it.
fn search(
    sides: &[Side],
    first: usize,
    rounds: usize,
    mut value: impl FnMut(&Point) -> Result<f64, NoMargins>,
) -> Result<(f64, Vec<(Name, f64)>), NoMargins> {
    let mut within = sides.to_vec();
    let mut best = (f64::INFINITY, at(sides, |side| side.low));
    for round in 0..rounds {
        let points = if round == 0 { first } else { first.min(3) };
        let grids: Vec<Vec<f64>> = within.iter().map(|side| side.grid(points)).collect();
        for number in 0..grids.iter().map(Vec::len).product() {
            // The last side changes fastest.
            let (mut left, mut at) = (number, best.1.clone());
            for (part, grid) in at.iter_mut().zip(&grids).rev() {
                part.1 = grid[left % grid.len()];
                left /= grid.len();
            }
            let found = value(&at)?;
            if found < best.0 {
                best = (found, at);
            }
        }
        let shrink = if round == 0 { 1.0 / (first - 1) as f64 } else { 0.25 };
        for ((within, side), (_, middle)) in within.iter_mut().zip(sides).zip(&best.1) {
            let reach = (within.high - within.low) * shrink;
            (within.low, within.high) = ((middle - reach).max(side.low), (middle + reach).min(side.high));
        }
    }
    Ok(best)
}
