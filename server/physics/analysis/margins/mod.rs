//! Distance of a scene from the edge of stability when its body, or another number of it, deviates from the given one: small deviations over
//! a box of contact distances, radii of gyration, restitutions and values of further fields.
//!
//! The table keeps its gains and its assumed restitution. The errors of the rig have a budget of their own ([`budget`]).

pub mod budget;
pub mod extra;
pub mod gains;
pub mod judgement;
pub mod limit_search;

use crate::analysis::fixed_point::is_plain;
use crate::analysis::gain_range::{StableGains, stable_gains};
use crate::analysis::limits::{Limit, NoLimits, Parameter, limits_of};
use crate::analysis::margins::extra::{ExtraTolerance, MOST_EXTRA, range_of};
use crate::analysis::model_hierarchy::refused;
use crate::analysis::small_deviations::small_deviations;
use crate::scene::{Name, Scene};

/// Tolerance of each parameter, in both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Tolerance of l, m.
    pub contact_distance: f64,
    /// Tolerance of ρ, m.
    pub radius_of_gyration: f64,
    /// Tolerance of e; the range is cut to 0 to 1.
    pub restitution: f64,
    /// Tolerances of further fields; the ranges are cut to those of the fields.
    pub further: [Option<ExtraTolerance>; MOST_EXTRA],
}

/// Sides of the box.
const SIDES: usize = 3 + MOST_EXTRA;

impl Tolerances {
    /// Sides of the box that are not points.
    fn sides(&self) -> u32 {
        let body = [self.contact_distance, self.radius_of_gyration, self.restitution];
        let further = self.further.iter().flatten().map(|field| field.off);
        body.into_iter().chain(further).filter(|off| *off != 0.0).count() as u32
    }
}

/// Parameters of a body in the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledBody {
    /// l, m.
    pub contact_distance: f64,
    /// ρ, m.
    pub radius_of_gyration: f64,
    /// e.
    pub restitution: f64,
    /// Values of the further fields.
    pub further: [Option<(Name, f64)>; MOST_EXTRA],
}

impl SampledBody {
    /// Value of a field; `None` for one that is the same in the whole box.
    pub fn value(&self, name: Name) -> Option<f64> {
        match name {
            Name::ContactDistance => Some(self.contact_distance),
            Name::RadiusOfGyration => Some(self.radius_of_gyration),
            Name::Restitution => Some(self.restitution),
            _ => self.further.iter().flatten().find(|(known, _)| *known == name).map(|(_, value)| *value),
        }
    }
}

/// Reason for which there are no margins.
#[derive(Clone, Debug, PartialEq)]
pub enum NoMargins {
    /// The search was cancelled.
    Stopped,
    /// One of the bodies has no verdict, for this reason.
    Because(String),
}

impl From<String> for NoMargins {
    fn from(why: String) -> Self {
        Self::Because(why)
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceMargins {
    /// The gain whose range is told: the tilt gain, or a factor on the gains of a state feedback.
    pub gain: Parameter,
    /// Lower end of its stable range: 1 for the tilt gain of most tables. Infinite where no gain balances.
    pub lower: ValueRange,
    /// Upper end of its stable range: κ_c of the tilt gain.
    pub critical: ValueRange,
    /// The body with the least upper end.
    pub worst: SampledBody,
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

/// Bodies between two questions whether to go on.
const BODIES_BETWEEN: u64 = 16;

/// Small deviations over a box of bodies.
///
/// `go_on` is asked every few bodies.
///
/// # Errors
/// [`NoMargins`].
pub fn margins_over_tolerances(
    scene: &Scene,
    tolerances: &Tolerances,
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
    let number = |name| scene.number(name).unwrap_or(f64::NAN);
    let middle = [Name::ContactDistance, Name::RadiusOfGyration, Name::Restitution].map(number);
    if middle.iter().any(|value| value.is_nan()) {
        return Err(NoMargins::Because("only a rod has lengths to be off".to_owned()));
    }
    let off = [tolerances.contact_distance, tolerances.radius_of_gyration, tolerances.restitution];
    let (mut low, mut high) = ([0.0; SIDES], [0.0; SIDES]);
    for side in 0..3 {
        low[side] = middle[side] - off[side];
        high[side] = middle[side] + off[side];
    }
    (low[2], high[2]) = (low[2].max(0.0), high[2].min(1.0));
    for (place, tolerance) in tolerances.further.iter().enumerate() {
        let Some(tolerance) = tolerance else { continue };
        (low[3 + place], high[3 + place]) = range_of(scene, tolerance)?;
    }
    let names = tolerances.further.map(|tolerance| tolerance.map(|tolerance| tolerance.name));
    let gain = Parameter::of_gain(scene);
    let closed = [low, high].into_iter().all(|at| sampled(scene, &names, at).is_ok_and(|it| is_plain(&it)));
    let most = if closed { MOST_BODIES } else { MOST_SEARCHED };
    let (points, rounds) = grid(tolerances.sides(), most as usize / EXTREMES);
    let (mut bodies, mut bounded) = (0_u64, true);
    let mut range = |of: fn(&BounceProperties) -> f64| {
        let mut least = |sign: f64| {
            search(low, high, points, rounds, |at| {
                bodies += 1;
                if bodies.is_multiple_of(BODIES_BETWEEN) && !go_on() {
                    return Err(NoMargins::Stopped);
                }
                let found = bounce_properties(scene, gain, &names, at, &mut *go_on)?;
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
        worst: SampledBody {
            contact_distance: worst[0],
            radius_of_gyration: worst[1],
            restitution: worst[2],
            further: further_values(&names, &worst),
        },
        apex_height,
        energy_eigenvalue,
        holds: bounded && value > lower.most && value < critical.least,
    })
}

/// Values of the further fields at a point of the box.
fn further_values(names: &[Option<Name>; MOST_EXTRA], at: &[f64; SIDES]) -> [Option<(Name, f64)>; MOST_EXTRA] {
    std::array::from_fn(|place| names[place].map(|name| (name, at[3 + place])))
}

/// The scene with the body and the further fields of a point of the box.
fn sampled(scene: &Scene, names: &[Option<Name>; MOST_EXTRA], at: [f64; SIDES]) -> Result<Scene, String> {
    let [contact_distance, radius_of_gyration, restitution, ..] = at;
    let told = scene.specified_restitution();
    let body = [
        (Name::ContactDistance, contact_distance),
        (Name::RadiusOfGyration, radius_of_gyration),
        (Name::Restitution, restitution),
    ];
    let assumed = (restitution != told && !scene.is_lossy()).then_some((Name::AssumedRestitution, told));
    let further = further_values(names, &at).into_iter().flatten();
    scene.with(body.into_iter().chain(assumed).chain(further).map(|(name, value)| (name, Some(value))))
}

fn bounce_properties(
    scene: &Scene,
    gain: Parameter,
    names: &[Option<Name>; MOST_EXTRA],
    at: [f64; SIDES],
    go_on: &mut dyn FnMut() -> bool,
) -> Result<BounceProperties, NoMargins> {
    let of = |why: String| {
        let [contact_distance, radius_of_gyration, restitution, ..] = at;
        let further = further_values(names, &at).into_iter().flatten().map(|(name, value)| {
            let row = name.row();
            let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
            format!(", {} {value}{unit}", row.path)
        });
        NoMargins::Because(format!(
            "at contact_distance {contact_distance} m, radius_of_gyration {radius_of_gyration} m and restitution {restitution}{}: {why}",
            further.collect::<String>()
        ))
    };
    let sample = sampled(scene, names, at).map_err(of)?;
    let small = small_deviations(&sample).map_err(|why| of(format!("no bounce repeats: {why}")))?;
    // Gains as they are told, whatever the table makes of them.
    let acts = if gain == Parameter::FeedbackFactor { 1.0 } else { sample.tilt_factor() };
    let of_map = || small.found().and_then(|(map, bounce)| stable_gains(map, bounce));
    let (lower, critical) = if small.is_closed() {
        (small.linear.lower_tilt_gain / acts, small.linear.critical_tilt_gain / acts)
    } else if let Some(StableGains { lower, upper }) = of_map() {
        (lower / acts, upper / acts)
    } else {
        searched(&sample, gain, go_on)?
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
        Err(NoLimits::NoNumber) => return Err(NoMargins::Because("the scene has no gain".to_owned())),
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
    low: [f64; SIDES],
    high: [f64; SIDES],
    first: usize,
    rounds: usize,
    mut value: impl FnMut([f64; SIDES]) -> Result<f64, NoMargins>,
) -> Result<(f64, [f64; SIDES]), NoMargins> {
    let (mut from, mut to) = (low, high);
    let mut best = (f64::INFINITY, low);
    for round in 0..rounds {
        let points = if round == 0 { first } else { first.min(3) };
        let counts: [usize; SIDES] = std::array::from_fn(|side| if from[side] == to[side] { 1 } else { points });
        let place = |side: usize, k: usize| {
            if k + 1 == counts[side] {
                to[side]
            } else {
                from[side] + (to[side] - from[side]) * k as f64 / (counts[side] - 1) as f64
            }
        };
        for number in 0..counts.iter().product() {
            // The last side changes fastest.
            let (mut left, mut at) = (number, low);
            for side in (0..SIDES).rev() {
                at[side] = place(side, left % counts[side]);
                left /= counts[side];
            }
            let found = value(at)?;
            if found < best.0 {
                best = (found, at);
            }
        }
        let shrink = if round == 0 { 1.0 / (first - 1) as f64 } else { 0.25 };
        for side in 0..SIDES {
            let reach = (to[side] - from[side]) * shrink;
            (from[side], to[side]) = ((best.1[side] - reach).max(low[side]), (best.1[side] + reach).min(high[side]));
        }
    }
    Ok(best)
}
