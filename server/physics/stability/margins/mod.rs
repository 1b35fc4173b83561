//! Distance of a scene from the edge of stability when its body deviates from the given one: the linear verdict over a box
//! of contact distances, radii of gyration and restitutions.
//!
//! The table keeps its gains and its assumed restitution. The errors of the rig have a budget of their own ([`budget`]).

pub mod budget;
pub mod judgement;
pub mod limit_search;

use crate::scene::{Name, Scene, Value};
use crate::stability::fixed_point::find_fixed_point;
use crate::stability::linear_verdict::linear_verdict;

/// Tolerance of each parameter, in both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Tolerance of l, m.
    pub contact_distance: f64,
    /// Tolerance of ρ, m.
    pub radius_of_gyration: f64,
    /// Tolerance of e; the range is cut to 0 to 1.
    pub restitution: f64,
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

/// Grid points along each side of the box in the first round of the search.
const POINTS: usize = 9;

/// Rounds of the search, each over a smaller box about the best point so far.
const ROUNDS: usize = 24;

/// The linear verdict over a box of bodies.
///
/// # Errors
/// A sentence that says why one of the bodies has no verdict.
pub fn margins_over_tolerances(scene: &Scene, tolerances: &Tolerances) -> Result<ToleranceMargins, String> {
    if scene.outline().is_some() {
        return margins_over_tolerances(&scene.as_rod(), tolerances);
    }
    let scene = &scene.with_tilt_law();
    let number = |name| scene.number(name).unwrap_or(f64::NAN);
    let middle = [Name::ContactDistance, Name::RadiusOfGyration, Name::Restitution].map(number);
    if middle.iter().any(|value| value.is_nan()) {
        return Err("only a rod has lengths to be off".to_owned());
    }
    let off = [tolerances.contact_distance, tolerances.radius_of_gyration, tolerances.restitution];
    let (mut low, mut high) = (middle, middle);
    for side in 0..3 {
        low[side] -= off[side];
        high[side] += off[side];
    }
    (low[2], high[2]) = (low[2].max(0.0), high[2].min(1.0));
    if scene.model().feedback().is_some() {
        return Err("margins over tolerances are of a tilt gain; the table has state feedback".to_owned());
    }
    if scene.acting_turn().is_some() {
        return Err("margins over tolerances are not derived for a table that turns as it strikes".to_owned());
    }
    if scene.drag().is_some_and(|drag| drag.linear == 0.0) {
        return Err("margins over tolerances are not derived where the air drags the rotation alone".to_owned());
    }
    let lower = linear_verdict(scene, &find_fixed_point(scene)?).lower_tilt_gain;
    let extreme = |of: fn(&BounceProperties) -> f64| search(low, high, |at| Ok(of(&bounce_properties(scene, at)?)));
    let (critical, worst) = extreme(|found| found.critical)?;
    let (most, _) = extreme(|found| -found.critical)?;
    let span = |of: fn(&BounceProperties) -> f64, negative: fn(&BounceProperties) -> f64| {
        Ok::<_, String>(ValueRange { least: extreme(of)?.0, most: -extreme(negative)?.0 })
    };
    let energy_eigenvalue = span(|found| found.energy, |found| -found.energy)?;
    let kappa = scene.tilt_gain;
    Ok(ToleranceMargins {
        critical_tilt_gain: ValueRange { least: critical, most: -most },
        worst: SampledBody { contact_distance: worst[0], radius_of_gyration: worst[1], restitution: worst[2] },
        apex_height: span(|found| found.apex, |found| -found.apex)?,
        energy_eigenvalue,
        holds: kappa > lower && kappa < critical && energy_eigenvalue.least > -1.0 && energy_eigenvalue.most <= 1.0,
    })
}

fn bounce_properties(
    scene: &Scene,
    [contact_distance, radius_of_gyration, restitution]: [f64; 3],
) -> Result<BounceProperties, String> {
    let mut draft = scene.draft();
    let told = scene.told_restitution();
    let mut values = vec![
        (Name::ContactDistance, contact_distance),
        (Name::RadiusOfGyration, radius_of_gyration),
        (Name::Restitution, restitution),
    ];
    if restitution != told && !scene.is_lossy() {
        values.push((Name::AssumedRestitution, told));
    }
    for (name, value) in values {
        draft.set(name, Some(Value::Number(value))).map_err(|error| error.detail)?;
    }
    let scene =
        draft.build().map_err(|errors| errors.into_iter().next().map_or_else(String::new, |error| error.detail))?;
    let of = |why: String| {
        format!(
            "at contact_distance {contact_distance} m, radius_of_gyration {radius_of_gyration} m and restitution {restitution}: {why}"
        )
    };
    let fixed_point = find_fixed_point(&scene).map_err(of)?;
    let linear = linear_verdict(&scene, &fixed_point);
    Ok(BounceProperties {
        critical: linear.critical_tilt_gain,
        apex: fixed_point.apex_height,
        energy: linear.energy_eigenvalue,
    })
}

struct BounceProperties {
    critical: f64,
    apex: f64,
    energy: f64,
}

/// Minimum of a smooth function over a box, and its location: the best point of a grid, then of smaller grids about it.
fn search(
    low: [f64; 3],
    high: [f64; 3],
    value: impl Fn([f64; 3]) -> Result<f64, String>,
) -> Result<(f64, [f64; 3]), String> {
    let (mut from, mut to) = (low, high);
    let mut best = (f64::INFINITY, low);
    for round in 0..ROUNDS {
        let points = if round == 0 { POINTS } else { 3 };
        let places = |side: usize| {
            let (from, to) = (from[side], to[side]);
            let count = if from == to { 1 } else { points };
            (0..count)
                .map(move |k| if k + 1 == count { to } else { from + (to - from) * k as f64 / (count - 1) as f64 })
        };
        for l in places(0) {
            for rho in places(1) {
                for e in places(2) {
                    let found = value([l, rho, e])?;
                    if found < best.0 {
                        best = (found, [l, rho, e]);
                    }
                }
            }
        }
        let shrink = if round == 0 { 1.0 / (POINTS - 1) as f64 } else { 0.25 };
        for side in 0..3 {
            let reach = (to[side] - from[side]) * shrink;
            (from[side], to[side]) = ((best.1[side] - reach).max(low[side]), (best.1[side] + reach).min(high[side]));
        }
    }
    Ok(best)
}
