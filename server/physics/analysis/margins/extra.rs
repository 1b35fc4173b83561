//! Tolerances of fields besides the three of the body: fields that may have one, and the range that follows.

use super::budget::errors_of_any_rig;
use crate::scene::{Field, FieldKind, Name, Scene};

/// Most further fields with a tolerance in one box: the work grows with the power of their number.
pub const MOST_EXTRA: usize = 3;

/// Tolerance of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtraTolerance {
    /// The field, one of those that [`refusal`] lets through.
    pub name: Name,
    /// Tolerance in both directions, in the field's unit.
    pub off: f64,
}

/// Reason for which a field can have no tolerance among the further ones; `None` if it can.
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

/// Range of a field in the box: its value in the scene with the tolerance, cut to the range of the field. Errors that the scene leaves out
/// are 0.
///
/// # Errors
/// A sentence that names the field and says why it has no range.
pub(super) fn range_of(scene: &Scene, tolerance: &ExtraTolerance) -> Result<(f64, f64), String> {
    let (row, off) = (tolerance.name.row(), tolerance.off);
    let (minimum, maximum) = row.range();
    let is_error = row.name != Name::PivotX && errors_of_any_rig().any(|error| error.name == row.name);
    let middle = scene.number(row.name).or(is_error.then_some(0.0));
    let Some(middle) = middle else {
        return Err(format!("the scene has no {}, about which values could lie; give it one", row.path));
    };
    Ok(((middle - off).max(minimum), (middle + off).min(maximum)))
}
