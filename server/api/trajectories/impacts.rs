//! The impacts of a run, gathered one by one into a table.

use equipoise_physics::numbers::double_double::DoubleDouble;

use crate::api::shared::table::gather::Gathered;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::trajectories::columns;
use crate::api::trajectories::columns::{ExtendedRow, ImpactColumn, ImpactRow};

/// Impacts that are put into the columns together: they stay in the nearest cache until then.
const BLOCK: usize = 32;

/// The impacts so far.
#[derive(Debug)]
pub(crate) struct Impacts {
    /// The last impacts, which are not yet in the columns of doubles.
    rows: Vec<ImpactRow>,
    columns: Vec<(&'static ImpactColumn, ColumnValues)>,
    /// True if there are columns with 31 digits.
    is_extended: bool,
}

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
            None => ColumnValues::Doubles(Gathered::with_capacity(column.row.read, room)),
        };
        let columns = columns::of_trajectories(dated).map(|column| (column, values(column))).collect();
        Self { rows: Vec::with_capacity(BLOCK), columns, is_extended: extended }
    }

    /// Adds an impact.
    pub(crate) fn push(&mut self, row: ImpactRow, extended: Option<&ExtendedRow<'_>>) {
        if self.is_extended {
            for (_, values) in &mut self.columns {
                if let ColumnValues::Digits(read, cells) = values {
                    cells.push(extended.and_then(|row| read(row)));
                }
            }
        }
        self.rows.push(row);
        if self.rows.len() == BLOCK {
            self.put_into_columns();
        }
    }

    fn put_into_columns(&mut self) {
        for (_, values) in &mut self.columns {
            if let ColumnValues::Doubles(gathered) = values {
                gathered.extend(&self.rows);
            }
        }
        self.rows.clear();
    }

    /// The table of all impacts.
    pub(crate) fn into_table(mut self) -> Table {
        self.put_into_columns();
        let column = |(column, values): (&ImpactColumn, ColumnValues)| {
            let cells = match values {
                ColumnValues::Doubles(gathered) => gathered.into_cells(),
                ColumnValues::Digits(_, cells) => Cells::Decimals(cells),
            };
            Column { name: column.row.name, unit: column.row.unit, cells }
        };
        Table(self.columns.into_iter().map(column).collect())
    }
}
