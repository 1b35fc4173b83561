//! A table of results, defined once and written as JSON columns, CSV with units in its header, NDJSON rows, or an Arrow stream.

pub mod arrow;
pub mod columns;
pub mod gather;
pub mod rest;
pub mod stacked;

use std::io::{self, Write};

use equipoise_physics::numbers::double_double::DoubleDouble;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in JSON.
    pub name: &'static str,
    /// Unit, which CSV appends to the name: `m/s` or `m_per_s`. Empty for none.
    pub unit: &'static str,
    /// Values.
    pub cells: Cells,
}

/// A name with its unit for the header of CSV: `rad/s` and `rad_per_s` are written as `_rad_per_s`.
pub fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" | "1" => name.to_owned(),
        _ => format!("{name}_{}", unit.replace('/', "_per_").replace('·', "_").replace('²', "2")),
    }
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cells {
    /// Whole numbers.
    Counts(Vec<u64>),
    /// Numbers, all finite.
    Numbers(Vec<f64>),
    /// Numbers, or none.
    Sparse(Vec<Option<f64>>),
    /// Whole numbers, or none.
    SparseCounts(Vec<Option<u64>>),
    /// Words, or none.
    Words(Vec<Option<&'static str>>),
    /// Yes, no, or none.
    Flags(Vec<Option<bool>>),
    /// Sentences, or none.
    Texts(Vec<Option<String>>),
    /// Numbers of 32 digits as text, or none.
    #[serde(serialize_with = "decimals")]
    Decimals(Vec<Option<DoubleDouble>>),
    /// Lists of numbers, or none.
    Lists(Vec<Option<Vec<f64>>>),
}

fn decimals<S: Serializer>(cells: &[Option<DoubleDouble>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(cells.iter().map(|cell| cell.map(Digits)))
}

/// A number of 32 digits as text.
struct Digits(DoubleDouble);

impl Serialize for Digits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Counts(cells) => cells.len(),
            Self::Numbers(cells) => cells.len(),
            Self::Sparse(cells) => cells.len(),
            Self::SparseCounts(cells) => cells.len(),
            Self::Words(cells) => cells.len(),
            Self::Flags(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
            Self::Decimals(cells) => cells.len(),
            Self::Lists(cells) => cells.len(),
        }
    }

    /// All values as doubles, if every one exists.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Self::Numbers(cells) => Some(cells.clone()),
            Self::Sparse(cells) => cells.iter().copied().collect(),
            Self::Decimals(cells) => cells.iter().map(|cell| cell.map(DoubleDouble::to_f64)).collect(),
            _ => None,
        }
    }

    /// Writes one value as JSON, `null` included.
    fn write_json(&self, row: usize, out: &mut Vec<u8>) {
        // Writing to memory does not fail.
        let _ = match self {
            Self::Counts(cells) => serde_json::to_writer(out, &cells[row]),
            Self::Numbers(cells) => serde_json::to_writer(out, &cells[row]),
            Self::Sparse(cells) => serde_json::to_writer(out, &cells[row]),
            Self::SparseCounts(cells) => serde_json::to_writer(out, &cells[row]),
            Self::Words(cells) => serde_json::to_writer(out, &cells[row]),
            Self::Flags(cells) => serde_json::to_writer(out, &cells[row]),
            Self::Texts(cells) => serde_json::to_writer(out, &cells[row]),
            Self::Decimals(cells) => serde_json::to_writer(out, &cells[row].map(Digits)),
            Self::Lists(cells) => serde_json::to_writer(out, &cells[row]),
        };
    }

    /// Writes one value as CSV: numbers as in JSON, texts in quotes where necessary, nothing for none.
    fn write_csv(&self, row: usize, out: &mut Vec<u8>) {
        let text = match self {
            Self::Words(cells) => cells[row],
            Self::Texts(cells) => cells[row].as_deref(),
            Self::Decimals(cells) => {
                if let Some(number) = cells[row] {
                    // Writing to memory does not fail.
                    let _ = write!(out, "{number}");
                }
                return;
            }
            Self::Lists(cells) => {
                if cells[row].is_some() {
                    out.push(b'"');
                    self.write_json(row, out);
                    out.push(b'"');
                }
                return;
            }
            Self::Counts(_) | Self::Numbers(_) | Self::Sparse(_) | Self::SparseCounts(_) | Self::Flags(_) => {
                let start = out.len();
                self.write_json(row, out);
                if out[start..] == *b"null" {
                    out.truncate(start);
                }
                return;
            }
        };
        let text = text.unwrap_or_default();
        if text.contains([',', '"', '\r', '\n']) {
            out.extend_from_slice(format!("\"{}\"", text.replace('"', "\"\"")).as_bytes());
        } else {
            out.extend_from_slice(text.as_bytes());
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
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.0.first().map_or(0, |column| column.cells.len())
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rows() * self.0.len()
    }

    /// Length of the names of a row in NDJSON with their signs, bytes.
    pub fn names_bytes(&self) -> usize {
        self.0.iter().map(|column| column.name.len() + "\"\":".len()).sum()
    }

    /// Writes CSV by RFC 4180, with a header. A value that does not exist is an empty cell.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        let header: Vec<String> = self.0.iter().map(|Column { name, unit, .. }| with_unit(name, unit)).collect();
        out.write_all(header.join(",").as_bytes())?;
        out.write_all(b"\r\n")?;
        let mut line = Vec::new();
        for row in 0..self.rows() {
            line.clear();
            for (index, column) in self.0.iter().enumerate() {
                if index > 0 {
                    line.push(b',');
                }
                column.cells.write_csv(row, &mut line);
            }
            line.extend_from_slice(b"\r\n");
            out.write_all(&line)?;
        }
        Ok(())
    }

    /// Writes one JSON object for each row, then `{"end": …}`, so that a truncated answer is recognised.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_ndjson(&self, end: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
        let mut line = Vec::new();
        for row in 0..self.rows() {
            line.clear();
            for (index, column) in self.0.iter().enumerate() {
                line.extend_from_slice(if index == 0 { b"{\"" } else { b",\"" });
                line.extend_from_slice(column.name.as_bytes());
                line.extend_from_slice(b"\":");
                column.cells.write_json(row, &mut line);
            }
            line.extend_from_slice(b"}\n");
            out.write_all(&line)?;
        }
        out.write_all(b"{\"end\":")?;
        serde_json::to_writer(&mut *out, end)?;
        out.write_all(b"}\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut out = Vec::new();
        write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn one_table_three_ways() {
        let table = Table(vec![
            Column { name: "n", unit: "", cells: Cells::Counts(vec![1, 2]) },
            Column { name: "t", unit: "s", cells: Cells::Numbers(vec![0.1, 1e21]) },
            Column { name: "flight_time", unit: "s", cells: Cells::Sparse(vec![Some(0.5), None]) },
            Column { name: "contact_mode", unit: "", cells: Cells::Words(vec![Some("stick"), None]) },
            Column { name: "why", unit: "", cells: Cells::Texts(vec![None, Some("a, \"b\"".to_owned())]) },
        ]);
        assert_eq!(
            serde_json::to_string(&table).unwrap(),
            r#"{"n":[1,2],"t":[0.1,1e+21],"flight_time":[0.5,null],"contact_mode":["stick",null],"why":[null,"a, \"b\""]}"#
        );
        assert_eq!(
            text(|out| table.write_csv(out)),
            "n,t_s,flight_time_s,contact_mode,why\r\n1,0.1,0.5,stick,\r\n2,1e+21,,,\"a, \"\"b\"\"\"\r\n"
        );
        assert_eq!(
            text(|out| table.write_ndjson(&"done", out)),
            "{\"n\":1,\"t\":0.1,\"flight_time\":0.5,\"contact_mode\":\"stick\",\"why\":null}\n\
             {\"n\":2,\"t\":1e+21,\"flight_time\":null,\"contact_mode\":null,\"why\":\"a, \\\"b\\\"\"}\n{\"end\":\"done\"}\n"
        );
    }
}
