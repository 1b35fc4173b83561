//! Distance of a scene from the edge of stability when its body, or another number of it, deviates from the given one: the linear verdict over
//! a box of contact distances, radii of gyration, restitutions and values of further fields.
//!
//! The table keeps its gains and its assumed restitution. The errors of the rig have a budget of their own ([`budget`]).

pub mod budget;
pub mod extra;
pub mod gains;
pub mod judgement;
pub mod limit_search;

use crate::analysis::fixed_point::find_fixed_point;
use crate::analysis::linear_verdict::linear_verdict;
use crate::analysis::margins::extra::{ExtraTolerance, MOST_EXTRA, range_of};
use crate::analysis::model_hierarchy::refused;
use crate::scene::{FieldError, Name, Scene, Value};

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
    /// Most linear verdicts of the margins.
    pub fn most_verdicts(&self) -> u64 {
        let further = self.further.iter().flatten().count();
        let (first, later) = ((points(3 + further) as u64).pow(3 + further as u32), 3_u64.pow(3 + further as u32));
        (if further == 0 { 6 } else { 7 }) * (first + (rounds(3 + further) - 1) as u64 * later)
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
    /// κ_c.
    pub critical_tilt_gain: ValueRange,
    /// The body with the least κ_c.
    pub worst: SampledBody,
    /// Apex height of the centre of gravity in the bounce in place, m.
    pub apex_height: ValueRange,
    /// Eigenvalue of the energy.
    pub energy_eigenvalue: ValueRange,
    /// True if the linear verdict is stable for every body in the box.
    pub holds: bool,
}

/// Grid points along each side of the box in the first round of the search; fewer where many fields have tolerances.
const fn points(sides: usize) -> usize {
    match sides {
        0..=3 => 9,
        4 => 7,
        5 => 5,
        _ => 4,
    }
}

/// Linear verdicts between two questions whether to go on.
const VERDICTS_BETWEEN: u64 = 64;

/// Rounds of the search, each over a smaller box about the best point so far.
const ROUNDS: usize = 24;

/// Rounds where further fields have tolerances: the best point is then known to 1e-7 of the box, and the value at a smooth extreme to the square.
const FURTHER_ROUNDS: usize = 12;

const fn rounds(sides: usize) -> usize {
    if sides > 3 { FURTHER_ROUNDS } else { ROUNDS }
}

/// The linear verdict over a box of bodies.
///
/// `go_on` is asked every few dozen verdicts.
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
    refuse_underived(scene)?;
    for (place, tolerance) in tolerances.further.iter().enumerate() {
        let Some(tolerance) = tolerance else { continue };
        (low[3 + place], high[3 + place]) = range_of(scene, tolerance)?;
    }
    let names = tolerances.further.map(|tolerance| tolerance.map(|tolerance| tolerance.name));
    let mut lower = linear_verdict(scene, &find_fixed_point(scene)?).lower_tilt_gain;
    let mut verdicts = 0_u64;
    let mut extreme = |of: fn(&BounceProperties) -> f64| {
        search(low, high, |at| {
            verdicts += 1;
            if verdicts.is_multiple_of(VERDICTS_BETWEEN) && !go_on() {
                return Err(NoMargins::Stopped);
            }
            Ok(of(&bounce_properties(scene, &names, at)?))
        })
    };
    let (critical, worst) = extreme(|found| found.critical)?;
    let critical_tilt_gain = ValueRange { least: critical, most: -extreme(|found| -found.critical)?.0 };
    let energy_eigenvalue =
        ValueRange { least: extreme(|found| found.energy)?.0, most: -extreme(|found| -found.energy)?.0 };
    let apex_height = ValueRange { least: extreme(|found| found.apex)?.0, most: -extreme(|found| -found.apex)?.0 };
    if names.iter().any(Option::is_some) {
        lower = -extreme(|found| -found.lower)?.0;
    }
    let kappa = scene.tilt_gain;
    Ok(ToleranceMargins {
        critical_tilt_gain,
        worst: SampledBody {
            contact_distance: worst[0],
            radius_of_gyration: worst[1],
            restitution: worst[2],
            further: further_values(&names, &worst),
        },
        apex_height,
        energy_eigenvalue,
        holds: kappa > lower && kappa < critical && energy_eigenvalue.least > -1.0 && energy_eigenvalue.most <= 1.0,
    })
}

/// Refuses a scene whose margins are not derived.
fn refuse_underived(scene: &Scene) -> Result<(), String> {
    if scene.model().feedback().is_some() {
        return Err("margins over tolerances are of a tilt gain; the table has state feedback".to_owned());
    }
    if scene.acting_turn().is_some() {
        return Err("margins over tolerances are not derived for a table that turns as it strikes".to_owned());
    }
    if scene.drag().is_some_and(|drag| drag.linear == 0.0) {
        return Err("margins over tolerances are not derived where the air drags the rotation alone".to_owned());
    }
    Ok(())
}

/// Values of the further fields at a point of the box.
fn further_values(names: &[Option<Name>; MOST_EXTRA], at: &[f64; SIDES]) -> [Option<(Name, f64)>; MOST_EXTRA] {
    std::array::from_fn(|place| names[place].map(|name| (name, at[3 + place])))
}

fn bounce_properties(
    scene: &Scene,
    names: &[Option<Name>; MOST_EXTRA],
    at: [f64; SIDES],
) -> Result<BounceProperties, String> {
    let [contact_distance, radius_of_gyration, restitution, ..] = at;
    let further = further_values(names, &at);
    let mut draft = scene.draft();
    let told = scene.specified_restitution();
    let mut values = vec![
        (Name::ContactDistance, contact_distance),
        (Name::RadiusOfGyration, radius_of_gyration),
        (Name::Restitution, restitution),
    ];
    if restitution != told && !scene.is_lossy() {
        values.push((Name::AssumedRestitution, told));
    }
    values.extend(further.iter().flatten());
    let of = |why: String| {
        let further: String = further
            .iter()
            .flatten()
            .map(|(name, value)| {
                let row = name.row();
                let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
                format!(", {} {value}{unit}", row.path)
            })
            .collect();
        format!(
            "at contact_distance {contact_distance} m, radius_of_gyration {radius_of_gyration} m and restitution {restitution}{further}: {why}"
        )
    };
    let has_further = further.iter().any(Option::is_some);
    let of_further = |why: String| if has_further { of(why) } else { why };
    for (name, value) in values {
        draft.set(name, Some(Value::Number(value))).map_err(|error| of_further(error.detail))?;
    }
    let first = |errors: Vec<FieldError>| errors.into_iter().next().map_or_else(String::new, |error| error.detail);
    let sample = draft.build().map_err(|errors| of_further(first(errors)))?;
    if has_further && sample.lag() != 0.0 {
        let why = "a table that does not predict its delay acts by state feedback, and margins over tolerances are of a tilt gain; budget=true has \
                   the limit of the delay";
        return Err(of(why.to_owned()));
    }
    if has_further {
        refuse_underived(&sample).map_err(of)?;
    }
    let fixed_point = find_fixed_point(&sample).map_err(of)?;
    let linear = linear_verdict(&sample, &fixed_point);
    // Gains by which the table acts, in terms of those of the scene in the middle.
    let acts = scene.tilt_factor() / sample.tilt_factor();
    Ok(BounceProperties {
        lower: linear.lower_tilt_gain * acts,
        critical: linear.critical_tilt_gain * acts,
        apex: fixed_point.apex_height,
        energy: linear.energy_eigenvalue,
    })
}

struct BounceProperties {
    lower: f64,
    critical: f64,
    apex: f64,
    energy: f64,
}

/// Minimum of a smooth function over a box, and its location: the best point of a grid, then of smaller grids about it.
fn search(
    low: [f64; SIDES],
    high: [f64; SIDES],
    mut value: impl FnMut([f64; SIDES]) -> Result<f64, NoMargins>,
) -> Result<(f64, [f64; SIDES]), NoMargins> {
    let sides = 3 + (3..SIDES).filter(|&side| low[side] != high[side]).count();
    let first = points(sides);
    let (mut from, mut to) = (low, high);
    let mut best = (f64::INFINITY, low);
    for round in 0..rounds(sides) {
        let points = if round == 0 { first } else { 3 };
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
