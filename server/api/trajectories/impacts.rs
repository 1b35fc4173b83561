//! The impacts of a run, gathered one by one into a table.

use equipoise_physics::numbers::double_double::DoubleDouble;

use crate::api::shared::table::gather::Gathered;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::trajectories::columns;
use crate::api::trajectories::columns::{ExtendedRow, ImpactColumn, ImpactRow};

/// The impacts so far.
#[derive(Debug)]
pub(crate) struct Impacts(Vec<(&'static ImpactColumn, ColumnValues)>);

/// The values of a column so far.
#[derive(Debug)]
enum ColumnValues {
    Doubles(Gathered<ImpactRow>),
    Digits(fn(&ExtendedRow<'_>) -> Option<DoubleDouble>, Vec<Option<DoubleDouble>>),
}

impl Impacts {
    /// An empty table with room for some impacts. `dated` adds dates, `extended` columns with 31 digits.
    pub(crate) fn with_capacity(room: usize, dated: bool, extended: bool) -> Self {
        let values = |column: &ImpactColumn| match column.digits.filter(|_| extended) {
            Some(digits) => ColumnValues::Digits(digits, Vec::with_capacity(room)),
            None => ColumnValues::Doubles(Gathered::with_capacity(column.read, room)),
        };
        Self(columns::of_trajectories(dated).map(|column| (column, values(column))).collect())
    }

    /// Adds an impact.
    pub(crate) fn push(&mut self, row: &ImpactRow, extended: Option<&ExtendedRow<'_>>) {
        for (_, values) in &mut self.0 {
            match values {
                ColumnValues::Doubles(gathered) => gathered.push(row),
                ColumnValues::Digits(read, cells) => cells.push(extended.and_then(|row| read(row))),
            }
        }
    }

    /// The table of all impacts.
    pub(crate) fn into_table(self) -> Table {
        let column = |(column, values): (&ImpactColumn, ColumnValues)| {
            let cells = match values {
                ColumnValues::Doubles(gathered) => gathered.into_cells(),
                ColumnValues::Digits(_, cells) => Cells::Decimals(cells),
            };
            Column { name: column.name, unit: column.unit, cells }
        };
        Table(self.0.into_iter().map(column).collect())
    }
}
