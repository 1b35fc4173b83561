//! The picture of `periodic-orbits`: the branch diagram.

use crate::api::formats::Pictured;
use crate::api::periodic_orbits::answer::PeriodicOrbitAnswer;
use crate::api::scene::field_text;
use crate::charts::{Branches, StabilityChange as Mark, branches};
use crate::http::Problem;

impl Pictured for PeriodicOrbitAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        let no_branch = || Problem::invalid_at("/sweep", "the picture is of a branch; give a sweep");
        let sweep = self.sweep.as_ref().ok_or_else(no_branch)?;
        let (row, text) = (sweep.range.field.row(), field_text(sweep.range.field));
        let points: Vec<_> = self
            .points
            .iter()
            .map(|point| (point.parameter, point.orbit.max_theta(), point.orbit.multipliers.stable))
            .collect();
        let marks: Vec<_> = self
            .points
            .iter()
            .filter_map(|point| {
                let kind = point.change?.name();
                Some(Mark { at: (point.parameter, point.orbit.max_theta()), kind })
            })
            .collect();
        Ok(branches(&Branches {
            title: &format!("Orbits of period {}", self.period),
            name: text.title,
            symbol: text.symbol,
            unit: if row.unit == "1" { "" } else { row.unit },
            ends: (sweep.range.from, sweep.range.to),
            points: &points,
            changes: &marks,
            critical: self.critical,
        }))
    }
}
