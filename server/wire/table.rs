//! A table of results, defined once and written as JSON columns, CSV with units in its header, or NDJSON rows.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name in JSON.
    pub name: &'static str,
    /// What CSV adds to the name: the unit, as in `m_per_s`; empty for none.
    pub unit: &'static str,
    /// Its values.
    pub cells: Cells,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cells {
    /// Whole numbers.
    Counts(Vec<u64>),
    /// Numbers, all finite.
    Numbers(Vec<f64>),
    /// Numbers that need not exist.
    Sparse(Vec<Option<f64>>),
    /// Words that need not exist.
    Words(Vec<Option<&'static str>>),
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Counts(cells) => cells.len(),
            Self::Numbers(cells) => cells.len(),
            Self::Sparse(cells) => cells.len(),
            Self::Words(cells) => cells.len(),
        }
    }

    /// Writes one value as JSON does, or calls `absent`.
    fn write(&self, row: usize, out: &mut Vec<u8>, absent: impl FnOnce(&mut Vec<u8>)) {
        let number = |out: &mut Vec<u8>, value: f64| {
            // Writing to memory does not fail.
            let _ = serde_json::to_writer(out, &value);
        };
        match self {
            Self::Counts(cells) => out.extend_from_slice(cells[row].to_string().as_bytes()),
            Self::Numbers(cells) => number(out, cells[row]),
            Self::Sparse(cells) => match cells[row] {
                Some(value) if value.is_finite() => number(out, value),
                _ => absent(out),
            },
            Self::Words(cells) => match cells[row] {
                Some(word) => out.extend_from_slice(word.as_bytes()),
                None => absent(out),
            },
        }
    }
}

/// Columns of equal length; as JSON an object of arrays.
#[derive(Debug, Clone, PartialEq)]
pub struct Table(pub Vec<Column>);

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for column in &self.0 {
            map.serialize_entry(column.name, &column.cells)?;
        }
        map.end()
    }
}

impl Table {
    /// How many rows it has.
    pub fn rows(&self) -> usize {
        self.0.first().map_or(0, |column| column.cells.len())
    }

    /// RFC 4180, with a header; what does not exist is empty. No name or word needs quotes.
    pub fn to_csv(&self) -> Vec<u8> {
        let header: Vec<String> = self
            .0
            .iter()
            .map(
                |Column { name, unit, .. }| if unit.is_empty() { (*name).to_owned() } else { format!("{name}_{unit}") },
            )
            .collect();
        let mut out = header.join(",").into_bytes();
        out.extend_from_slice(b"\r\n");
        for row in 0..self.rows() {
            for (index, column) in self.0.iter().enumerate() {
                if index > 0 {
                    out.push(b',');
                }
                column.cells.write(row, &mut out, |_| ());
            }
            out.extend_from_slice(b"\r\n");
        }
        out
    }

    /// One JSON object a row, then `{"end": …}`, so that a truncated answer shows.
    pub fn to_ndjson(&self, end: &impl Serialize) -> Vec<u8> {
        let mut out = Vec::new();
        for row in 0..self.rows() {
            for (index, column) in self.0.iter().enumerate() {
                out.extend_from_slice(if index == 0 { b"{\"" } else { b",\"" });
                out.extend_from_slice(column.name.as_bytes());
                out.extend_from_slice(b"\":");
                let quote: &[u8] = match &column.cells {
                    Cells::Words(cells) if cells[row].is_some() => b"\"",
                    _ => b"",
                };
                out.extend_from_slice(quote);
                column.cells.write(row, &mut out, |out| out.extend_from_slice(b"null"));
                out.extend_from_slice(quote);
            }
            out.extend_from_slice(b"}\n");
        }
        out.extend_from_slice(b"{\"end\":");
        let _ = serde_json::to_writer(&mut out, end);
        out.extend_from_slice(b"}\n");
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_table_three_ways() {
        let table = Table(vec![
            Column { name: "n", unit: "", cells: Cells::Counts(vec![1, 2]) },
            Column { name: "t", unit: "s", cells: Cells::Numbers(vec![0.1, 1e21]) },
            Column { name: "flight_time", unit: "s", cells: Cells::Sparse(vec![Some(0.5), None]) },
            Column { name: "contact_mode", unit: "", cells: Cells::Words(vec![Some("stick"), None]) },
        ]);
        assert_eq!(
            serde_json::to_string(&table).unwrap(),
            r#"{"n":[1,2],"t":[0.1,1e+21],"flight_time":[0.5,null],"contact_mode":["stick",null]}"#
        );
        assert_eq!(
            String::from_utf8(table.to_csv()).unwrap(),
            "n,t_s,flight_time_s,contact_mode\r\n1,0.1,0.5,stick\r\n2,1e+21,,\r\n"
        );
        assert_eq!(
            String::from_utf8(table.to_ndjson(&"done")).unwrap(),
            "{\"n\":1,\"t\":0.1,\"flight_time\":0.5,\"contact_mode\":\"stick\"}\n\
             {\"n\":2,\"t\":1e+21,\"flight_time\":null,\"contact_mode\":null}\n{\"end\":\"done\"}\n"
        );
    }
}
