//! One table of several, for CSV and NDJSON: their rows one after another.

use equipoise_physics::numbers::double_double::DoubleDouble;

use crate::api::shared::table::{Cells, Column, ColumnKind, ColumnWord, Table};
use crate::words;

words! {
    /// Part of a motion that a row is of.
    pub Phase = ["impact", "strike", "hold"];
}

/// Descriptions in the contract of the columns of [`stacked`].
pub fn stacked_words(parts: &[Vec<ColumnWord>]) -> Vec<ColumnWord> {
    let (name, kind) = ("phase", (ColumnKind::Word, false));
    let mut words = vec![ColumnWord { name, unit: "", about: "", kind, words: "Phase", only: "" }];
    for word in parts.iter().flatten() {
        if words.iter().all(|known| known.name != word.name) {
            let mut same = parts.iter().map(|part| part.iter().find(|own| own.name == word.name));
            let may_be_missing = same.any(|own| own.is_none_or(|own| own.kind.1));
            words.push(ColumnWord { kind: (word.kind.0, may_be_missing), ..*word });
        }
    }
    words
}

/// The rows of several parts, and the column `phase` first. A cell is empty where its part lacks the column. Columns of one name have one
/// kind of cells: that of the first part, or numbers of 32 digits in place of doubles.
pub fn stacked(parts: &[(&'static str, &Table)]) -> Table {
    let phase = parts.iter().flat_map(|(phase, table)| std::iter::repeat_n(Some(*phase), table.rows()));
    let mut columns = vec![Column { name: "phase", unit: "", cells: Cells::Words(phase.collect()) }];
    for column in parts.iter().flat_map(|(_, table)| &table.0) {
        if columns.iter().all(|known| known.name != column.name) {
            let same = |table: &'_ Table| table.0.iter().position(|own| own.name == column.name);
            let cells = parts.iter().map(|(_, table)| (same(table).map(|index| &table.0[index].cells), table.rows()));
            let cells = joined(&column.cells, &cells.collect::<Vec<_>>());
            columns.push(Column { name: column.name, unit: column.unit, cells });
        }
    }
    Table(columns)
}

/// The cells of a column in several parts, one after another; `kind` is one of them. A part without the column has the number of its rows.
fn joined(kind: &Cells, parts: &[(Option<&Cells>, usize)]) -> Cells {
    fn filled<T: Clone>(
        parts: &[(Option<&Cells>, usize)],
        read: impl Fn(&Cells) -> Option<Vec<Option<T>>>,
    ) -> Vec<Option<T>> {
        let each = parts.iter().map(|(cells, rows)| cells.and_then(&read).unwrap_or_else(|| vec![None; *rows]));
        each.flatten().collect()
    }
    macro_rules! same {
        ($kind:ident) => {
            Cells::$kind(filled(parts, |cells| match cells {
                Cells::$kind(cells) => Some(cells.clone()),
                _ => None,
            }))
        };
    }
    match kind {
        Cells::Words(_) => same!(Words),
        Cells::Flags(_) => same!(Flags),
        Cells::Texts(_) => same!(Texts),
        Cells::Lists(_) => same!(Lists),
        Cells::Counts(_) | Cells::SparseCounts(_) => Cells::SparseCounts(filled(parts, |cells| match cells {
            Cells::Counts(counts) => Some(counts.iter().copied().map(Some).collect()),
            Cells::SparseCounts(counts) => Some(counts.clone()),
            _ => None,
        })),
        Cells::Numbers(_) | Cells::Sparse(_) => Cells::Sparse(filled(parts, doubles)),
        Cells::Decimals(_) => Cells::Decimals(filled(parts, |cells| match cells {
            Cells::Decimals(decimals) => Some(decimals.clone()),
            _ => doubles(cells).map(|cells| cells.into_iter().map(|cell| cell.map(DoubleDouble::from)).collect()),
        })),
    }
}

/// Cells that are doubles, or none.
fn doubles(cells: &Cells) -> Option<Vec<Option<f64>>> {
    match cells {
        Cells::Numbers(numbers) => Some(numbers.iter().copied().map(Some).collect()),
        Cells::Sparse(numbers) => Some(numbers.clone()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn column(name: &'static str, cells: Cells) -> Column {
        Column { name, unit: "", cells }
    }

    #[test]
    fn rows_of_two_tables_stand_one_after_another() {
        let one = Table(vec![
            column("n", Cells::Counts(vec![1, 2])),
            column("t", Cells::Numbers(vec![0.5, 0.75])),
            column("mode", Cells::Words(vec![Some("stick"), None])),
        ]);
        let other =
            Table(vec![column("t", Cells::Numbers(vec![1.0])), column("force", Cells::Sparse(vec![Some(9.8)]))]);
        let both = stacked(&[("strike", &one), ("hold", &other)]);
        assert_eq!(
            serde_json::to_value(&both).unwrap(),
            json!({"phase": ["strike", "strike", "hold"], "n": [1, 2, null], "t": [0.5, 0.75, 1.0],
                "mode": ["stick", null, null], "force": [null, null, 9.8]})
        );
    }

    #[test]
    fn every_kind_of_cells_keeps_its_rows() {
        let kinds = [
            Cells::Counts(vec![7]),
            Cells::SparseCounts(vec![Some(7)]),
            Cells::Numbers(vec![0.5]),
            Cells::Sparse(vec![Some(0.5)]),
            Cells::Words(vec![Some("stick")]),
            Cells::Flags(vec![Some(true)]),
            Cells::Texts(vec![Some("why".to_owned())]),
            Cells::Decimals(vec![Some(DoubleDouble::from(0.5))]),
            Cells::Lists(vec![Some(vec![0.5, 0.75])]),
        ];
        for cells in kinds {
            let value = serde_json::to_value(&cells).unwrap()[0].clone();
            let (one, other) = (Table(vec![column("a", cells.clone())]), Table(vec![column("b", cells)]));
            let twice = stacked(&[("one", &one), ("other", &other), ("one", &one)]);
            assert_eq!(
                serde_json::to_value(&twice).unwrap(),
                json!({"phase": ["one", "other", "one"], "a": [value, null, value], "b": [null, value, null]})
            );
        }
    }

    #[test]
    fn doubles_stand_below_numbers_of_32_digits_in_their_form() {
        let one = Table(vec![column("t", Cells::Decimals(vec![Some(DoubleDouble::from(0.5))]))]);
        let other = Table(vec![column("t", Cells::Numbers(vec![0.75]))]);
        let cells = serde_json::to_value(stacked(&[("impact", &one), ("hold", &other)])).unwrap();
        let numbers: Vec<f64> =
            cells["t"].as_array().unwrap().iter().map(|cell| cell.as_str().unwrap().parse().unwrap()).collect();
        assert_eq!(numbers, [0.5, 0.75]);
    }
}
