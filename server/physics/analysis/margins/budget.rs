//! Budget of the errors of a rig: for each the largest value that keeps the verdict of the rig without errors, alone and together. Friction, gravity
//! and the restitution that the table assumes have lines too: they may be other than in the scene.
//!
//! A value keeps the verdict if the scene with it has a verdict no worse, and its run survives. Where no bounce repeats beside the one without
//! the error (as with a constant tilt without feedback of x), and with noise, the run alone decides. An error of which no value that was tried
//! keeps the verdict has the limit 0.

use super::judgement::{Judge, LimitedBy, Loss, MOST_TRIED, NoMargins, Small, VerdictLimit, search};
use crate::analysis::verdict::{DecidedBy, Verdict};
use crate::map::table::pivot::TiltRate;
use crate::map::table::sensing::Prediction;
use crate::scene::{AIR, FIELDS, Field, FieldKind, Name, Scene, Value};

/// Errors besides all of `table.errors` and all standard deviations of `noise`. An error that is declared elsewhere has a line here.
const OTHER_ERRORS: [Name; 4] = [Name::Offset, Name::PivotX, Name::PivotDepth, Name::Delay];

/// Numbers that the rig may have other than the scene, in the order of their lines, before those of the errors.
const ASSUMED: [Name; 3] = [Name::Friction, Name::Gravity, Name::AssumedRestitution];

/// Fields of the pivot, which act on a table that turns as it strikes.
const PIVOT: [Name; 2] = [Name::PivotX, Name::PivotDepth];

/// Share of its range of the value by which an error asks for a model, where its price is looked up.
const TINY: f64 = 1e-6;

/// Rounds over the signs of all errors together, and most signs that are turned.
const SIGN_ROUNDS: usize = 2;
const MOST_TURNED: u64 = 8;

/// The fields that the budget of a scene has lines for, in their order.
pub fn budgeted_of(scene: &Scene) -> impl Iterator<Item = &'static Field> + use<> {
    ASSUMED.into_iter().map(Name::row).chain(errors_of(scene))
}

/// The errors of which a scene without errors has none.
fn errors_of(scene: &Scene) -> impl Iterator<Item = &'static Field> + use<> {
    listed(AIR.iter().any(|name| scene.value(*name).is_some()))
}

/// The errors of a rig in air, or without it.
pub(super) fn listed(in_air: bool) -> impl Iterator<Item = &'static Field> {
    FIELDS.iter().filter(move |row| {
        let is_listed =
            row.group() == "noise" || row.path.starts_with("table.errors.") || OTHER_ERRORS.contains(&row.name);
        let is_listed = is_listed || (in_air && AIR.contains(&row.name));
        is_listed && matches!(row.kind, FieldKind::Number { .. })
    })
}

/// Value from which the limits of a field count: 0 for an error, and the value in the scene for one that the rig may have another value of.
fn reference(scene: &Scene, name: Name) -> f64 {
    match name {
        Name::AssumedRestitution => scene.number(name).unwrap_or_else(|| scene.specified_restitution()),
        name if ASSUMED.contains(&name) => scene.number(name).unwrap_or(0.0),
        _ => 0.0,
    }
}

/// Least and greatest deviation of a field from its reference.
fn reach(scene: &Scene, row: &Field) -> (f64, f64) {
    let ((minimum, maximum), from) = (row.range(), reference(scene, row.name));
    (minimum - from, maximum - from)
}

/// Most searches of a limit by the budget of a scene: two for each line, and those of all errors together.
pub fn most_searches(scene: &Scene) -> u64 {
    2 * budgeted_of(scene).count() as u64 + 2 + MOST_TURNED
}

/// Most runs of the budget of a scene, with a scene as dear as theirs: those of each line, and those of all errors together.
pub fn most_runs(scene: &Scene) -> Vec<(u64, Scene)> {
    let every = with_every_error(scene);
    let (mut errors, mut found) = (0, Vec::new());
    for row in budgeted_of(scene).filter(|row| without_effect(scene, row.name).is_none()) {
        let (minimum, maximum) = reach(scene, row);
        let sides = u64::from(minimum < 0.0) + u64::from(maximum > 0.0);
        let end = if maximum > 0.0 { maximum } else { minimum };
        let alone = with_errors(scene, &[(row.name, end)], TINY).unwrap_or(every);
        errors += 1;
        found.push((sides * MOST_TRIED, alone));
    }
    found.push(((2 + MOST_TURNED) * MOST_TRIED + SIGN_ROUNDS as u64 * errors + 1, every));
    found
}

/// The budget of one error.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorBudget {
    /// The error.
    pub name: Name,
    /// Value in the scene.
    pub value: f64,
    /// Value from which the limits count.
    pub reference: f64,
    /// Limit below the reference, as a positive distance from it; `None` if the field has no such values.
    pub below: Option<VerdictLimit>,
    /// Limit above the reference; `None` if the scene cannot have this error.
    pub above: Option<VerdictLimit>,
    /// Reason for which a limit that the range allows is missing, or for which the error is not in [`Budget::together`].
    pub reason: Option<String>,
}

impl ErrorBudget {
    /// The nearer limit, and the deviation there, with its sign.
    fn nearest(&self) -> Option<(&VerdictLimit, f64)> {
        let below = self.below.as_ref().map(|limit| (limit, -limit.value));
        let above = self.above.as_ref().map(|limit| (limit, limit.value));
        match (below, above) {
            (Some(below), Some(above)) if -below.1 < above.1 => Some(below),
            (below, above) => above.or(below),
        }
    }
}

/// The budget of errors in proportion.
#[derive(Clone, Debug, PartialEq)]
pub struct CommonBudget {
    /// Deviation of each field from its reference at the factor 1, in its unit.
    pub sizes: Vec<(Name, f64)>,
    /// Limit of the factor.
    pub factor: VerdictLimit,
}

/// The budget of a rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    /// Verdict that is kept, of the rig without errors, and the evidence that decided it; `None` where the run alone decides.
    pub verdict: Option<(Verdict, DecidedBy)>,
    /// Each error alone.
    pub errors: Vec<ErrorBudget>,
    /// All errors that a scene can have together, at the same share of their nearer limits, with the worst signs found.
    pub together: Option<CommonBudget>,
    /// The errors of the scene, all in proportion.
    pub present: Option<CommonBudget>,
    /// Contacts of all runs that were made for it.
    pub bounces: u64,
}

/// Reason for which an error alone does nothing to a scene; `None` if it does.
fn without_effect(scene: &Scene, name: Name) -> Option<String> {
    if is_still_pivot(scene, name) {
        let (rate, word) = (Name::TiltRate.row().path, TiltRate::None.name());
        return Some(format!("the pivot acts on a table that turns as it strikes, and {rate} is `{word}`"));
    }
    let (prediction, word) = (Name::Prediction, Prediction::Flight.name());
    (name == Name::Delay && scene.value(prediction) == Some(Value::Choice(word))).then(|| {
        format!(
            "{} is `{word}`, so the delay alone changes nothing; with it, errors of the sensed velocities grow",
            prediction.row().path
        )
    })
}

/// Tells whether a field is of the pivot of a table that does not turn as it strikes.
fn is_still_pivot(scene: &Scene, name: Name) -> bool {
    let rate = scene.value(Name::TiltRate);
    PIVOT.contains(&name) && rate.is_none_or(|rate| rate == Value::Choice(TiltRate::None.name()))
}

/// The scene without errors, and with the deviations of a direction at a distance.
fn with_errors(scene: &Scene, direction: &[(Name, f64)], distance: f64) -> Result<Scene, String> {
    let moved = direction.iter().map(|&(name, size)| {
        let value = reference(scene, name) + size * distance;
        // Rounding must not lead beyond the end of the range.
        let (minimum, maximum) = name.row().range();
        (name, Some(if ASSUMED.contains(&name) { value.clamp(minimum, maximum) } else { value }))
    });
    scene.with(errors_of(scene).map(|row| (row.name, None)).chain(moved))
}

/// The scene with every error that it can have, each too small to matter: the dearest one of a budget.
fn with_every_error(scene: &Scene) -> Scene {
    budgeted_of(scene).fold(*scene, |kept, row| {
        let value = reference(scene, row.name) + TINY * reach(scene, row).1;
        kept.with([(row.name, Some(value))]).unwrap_or(kept)
    })
}

/// The budget of a scene, by runs of up to `impacts` contacts. `go_on` is asked every few hundred bounces.
pub fn find_budget(scene: &Scene, impacts: u64, mut go_on: impl FnMut() -> bool) -> Result<Budget, NoMargins> {
    let ideal = with_errors(scene, &[], 0.0).map_err(NoMargins::Because)?;
    let mut judge = Judge::of(&ideal, impacts, &mut go_on)?;
    let mut errors = Vec::new();
    for row in budgeted_of(scene) {
        errors.push(alone(scene, row, &mut judge)?);
    }
    let together = together(scene, &mut errors, &mut judge)?;
    let present = present(scene, &mut judge)?;
    Ok(Budget { verdict: judge.kept, errors, together, present, bounces: judge.bounces })
}

/// The limits of one error, all others being 0.
fn alone(scene: &Scene, row: &Field, judge: &mut Judge<'_>) -> Result<ErrorBudget, NoMargins> {
    let reference = reference(scene, row.name);
    let value = scene.number(row.name).unwrap_or(reference);
    let (mut reason, mut limits) = (without_effect(scene, row.name), [None, None]);
    let (minimum, maximum) = reach(scene, row);
    let is_possible = reason.is_none();
    for (limit, end) in limits.iter_mut().zip([minimum, maximum]).filter(|(_, end)| is_possible && *end != 0.0) {
        match with_errors(scene, &[(row.name, end.signum())], TINY * end.abs()) {
            Err(why) => reason = Some(why),
            Ok(_) => *limit = Some(along(scene, &[(row.name, end.signum())], end.abs(), judge)?),
        }
    }
    let [below, above] = limits;
    Ok(ErrorBudget { name: row.name, value, reference, below, above, reason })
}

fn along(scene: &Scene, direction: &[(Name, f64)], end: f64, judge: &mut Judge<'_>) -> Result<VerdictLimit, NoMargins> {
    let scenes = |distance| with_errors(scene, direction, distance);
    let (small, by_run_alone) = match judge.small(&scenes, end)? {
        Small::Bounded(limit) => (limit, false),
        Small::NothingRepeats => (None, true),
    };
    search(end, small, |distance| match scenes(distance) {
        Err(why) => Ok(Some(Loss::refused(why))),
        Ok(scene) => judge.judge(&scene, by_run_alone),
    })
}

/// Sizes of the errors that have a limit, each at the nearer of both. Of errors that contradict one another the first is taken, and one that
/// loses the verdict before one that does not; the others have the reason.
fn sizes_together(scene: &Scene, errors: &mut [ErrorBudget]) -> Vec<(Name, f64)> {
    let mut sizes: Vec<(Name, f64)> = Vec::new();
    for is_harmless in [false, true] {
        for error in &mut *errors {
            let Some((limit, size)) = error.nearest() else { continue };
            if size == 0.0 || (limit.by == LimitedBy::Range) != is_harmless {
                continue;
            }
            sizes.push((error.name, size));
            if let Err(why) = with_errors(scene, &sizes, TINY) {
                sizes.pop();
                error.reason.get_or_insert(format!("it is not in `together`: {why}"));
            }
        }
    }
    sizes.sort_by_key(|(name, _)| *name as usize);
    sizes
}

/// All errors that have a limit, at the same share of the nearer of both. Signs are turned one by one where that is worse.
fn together(
    scene: &Scene,
    errors: &mut [ErrorBudget],
    judge: &mut Judge<'_>,
) -> Result<Option<CommonBudget>, NoMargins> {
    let mut sizes = sizes_together(scene, errors);
    if sizes.len() < 2 {
        return Ok(None);
    }
    let mut factor = along(scene, &sizes, 1.0, judge)?;
    let mut turned = 0;
    for _ in 0..SIGN_ROUNDS {
        for place in 0..sizes.len() {
            let (name, size) = sizes[place];
            let (low, high) = reach(scene, name.row());
            let is_signed = (low..=high).contains(&-size);
            if !is_signed || factor.value == 0.0 || turned == MOST_TURNED {
                continue;
            }
            sizes[place].1 = -size;
            let kept = match with_errors(scene, &sizes, factor.value) {
                Ok(scene) => judge.judge(&scene, false)?.is_none(),
                Err(_) => true,
            };
            if kept {
                sizes[place].1 = size;
            } else {
                factor = along(scene, &sizes, factor.value, judge)?;
                turned += 1;
            }
        }
    }
    Ok(Some(CommonBudget { sizes, factor }))
}

/// The errors of the scene in proportion, up to the range of the first.
fn present(scene: &Scene, judge: &mut Judge<'_>) -> Result<Option<CommonBudget>, NoMargins> {
    let mut end = f64::INFINITY;
    let mut sizes = Vec::new();
    for row in errors_of(scene) {
        let (Some(value), FieldKind::Number { minimum, maximum }) = (scene.number(row.name), row.kind) else {
            continue;
        };
        // A pivot at 0 is at a fixed place too; without a value it is under the contact.
        if (value != 0.0 || row.name == Name::PivotX) && !is_still_pivot(scene, row.name) {
            sizes.push((row.name, value));
            end = end.min(if value < 0.0 { minimum / value } else { maximum / value });
        }
    }
    if sizes.is_empty() {
        return Ok(None);
    }
    let end = if end.is_finite() { end } else { 1.0 };
    let factor = along(scene, &sizes, end, judge)?;
    Ok(Some(CommonBudget { sizes, factor }))
}
