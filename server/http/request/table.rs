//! A table as a body, CSV or an Arrow stream: the same tree as the JSON that has its columns as arrays. Cells are text, as the values of a query.

use std::panic::catch_unwind;

use arrow_array::types::{Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type};
use arrow_array::types::{UInt8Type, UInt16Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch, cast::AsArray};
use arrow_ipc::reader::StreamReader;
use arrow_schema::{ArrowError, DataType};
use serde_json::{Map, Value};

use crate::http::problem::{Problem, shortened};
use crate::http::request::body::{ARROW, MediaType};
use crate::http::request::reader::{Errors, join};
use crate::http::request::suggestion::did_you_mean;

/// The table that a resource takes as a body in place of a field of its request.
#[derive(Debug)]
pub struct TableBody {
    /// The field: an object of columns.
    pub field: &'static str,
    /// Names of columns in a header, each with the column that it is and the factor to the unit of that column.
    pub columns: fn() -> Vec<(String, &'static str, f64)>,
    /// Names of further columns, which are left out.
    pub others: fn() -> Vec<String>,
    /// Largest number of rows.
    pub rows: usize,
}

impl TableBody {
    /// The fields of a request: those of the query and the table.
    ///
    /// # Errors
    /// 400 for a body that is no table, 422 for columns that are not known, or there twice, and for a table in the query.
    pub(super) fn fields_of(
        &self,
        mut fields: Map<String, Value>,
        media_type: &MediaType,
        body: &[u8],
    ) -> Result<Map<String, Value>, Problem> {
        let place = join("", self.field);
        if fields.contains_key(self.field) {
            return Err(Problem::invalid_at(
                place,
                format!("{} is the body; it is not read from the query", self.field),
            ));
        }
        let mut columns = Columns { table: self, known: (self.columns)(), errors: Errors::default() };
        let table = if media_type.is(&ARROW) { columns.of_arrow(body)? } else { columns.of_csv(body)? };
        columns.errors.into_result()?;
        fields.insert(self.field.to_owned(), Value::Object(table));
        Ok(fields)
    }
}

/// A header that is read.
struct Columns<'a> {
    table: &'a TableBody,
    known: Vec<(String, &'static str, f64)>,
    errors: Errors,
}

impl Columns<'_> {
    /// The columns of a header that are read: place, name and factor.
    fn of<'h>(&mut self, header: impl IntoIterator<Item = &'h str>) -> Vec<(usize, &'static str, f64)> {
        let (mut read, others) = (Vec::new(), (self.table.others)());
        for (place, written) in header.into_iter().enumerate() {
            // `t [s]`, `theta_dot (rad/s)` are `t_s`, `theta_dot_rad_per_s`.
            let name = written.trim_end_matches([']', ')']).replace([' ', '[', '('], "_").replace("__", "_");
            let name = name.replace('/', "_per_");
            let pointer = join(&join("", self.table.field), written);
            if let Some((_, column, factor)) = self.known.iter().find(|(known, ..)| *known == name) {
                if read.iter().any(|(_, other, _)| other == column) {
                    self.errors.push(pointer, format!("the column {column} is there twice"));
                }
                read.push((place, *column, *factor));
            } else if !others.contains(&name) {
                let known: Vec<&str> = self.known.iter().map(|(name, ..)| name.as_str()).collect();
                let (meant, listed) = (did_you_mean(&name, known.iter().copied()), known.join(", "));
                let shown = shortened(written);
                self.errors.push(pointer, format!("unknown column `{shown}`{meant}; known here: {listed}"));
            }
        }
        read
    }

    fn of_csv(&mut self, body: &[u8]) -> Result<Map<String, Value>, Problem> {
        let place = join("", self.table.field);
        let not_csv = |error: csv::Error| match error.kind() {
            csv::ErrorKind::UnequalLengths { .. } => Problem::invalid_at(place.clone(), error.to_string()),
            _ => Problem::not_readable(format!("the body is not CSV: {error}")),
        };
        if body.trim_ascii().is_empty() {
            return Err(Problem::invalid_at(
                place.clone(),
                format!("{} is empty: a table has a header and rows", self.table.field),
            ));
        }
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(body);
        let read = self.of(reader.headers().map_err(not_csv)?);
        let mut cells = vec![Vec::new(); read.len()];
        for row in reader.records() {
            let row = row.map_err(not_csv)?;
            for (column, (place, _, factor)) in cells.iter_mut().zip(&read) {
                let cell = row.get(*place).filter(|cell| !cell.is_empty());
                column.push(cell.map_or(Value::Null, |cell| Value::String(scaled(cell, *factor))));
            }
        }
        Ok(read.iter().zip(cells).map(|((_, name, _), cells)| ((*name).to_owned(), Value::Array(cells))).collect())
    }

    fn of_arrow(&mut self, body: &[u8]) -> Result<Map<String, Value>, Problem> {
        // A buffer beyond the end of its message is a panic of the library.
        let batches = catch_unwind(|| StreamReader::try_new(body, None)?.collect::<Result<Vec<_>, ArrowError>>());
        let batches = batches.unwrap_or_else(|_| Err(ArrowError::ParseError("a buffer is beyond the end".to_owned())));
        let batches: Vec<RecordBatch> = batches.map_err(|error| {
            Problem::not_readable(format!("the body is not a stream of Arrow without compression: {error}"))
        })?;
        let rows: usize = batches.iter().map(RecordBatch::num_rows).fold(0, usize::saturating_add);
        let (field, most) = (self.table.field, self.table.rows);
        if rows > most {
            return Err(Problem::invalid_at(
                join("", field),
                format!("{field} has {rows} rows; at most {most} are read"),
            ));
        }
        let Some(schema) = batches.first().map(RecordBatch::schema) else {
            return Err(Problem::invalid_at(join("", field), format!("{field} has no rows")));
        };
        let mut table = Map::new();
        for (place, name, factor) in self.of(schema.fields().iter().map(|field| field.name().as_str())) {
            let mut cells = Vec::with_capacity(rows);
            for column in batches.iter().map(|batch| batch.column(place)) {
                match numbers(column, factor) {
                    Some(numbers) => cells.extend(numbers),
                    None => {
                        let (pointer, kind) = (join(&join("", field), name), column.data_type());
                        self.errors.push(pointer, format!("{name} is of type {kind}; it must be numbers"));
                        break;
                    }
                }
            }
            table.insert(name.to_owned(), Value::Array(cells));
        }
        Ok(table)
    }
}

/// A cell in the unit of its column. A cell that is no number stays, and its reader refuses it.
fn scaled(cell: &str, factor: f64) -> String {
    match cell.parse::<f64>() {
        Ok(number) if factor != 1.0 => (number * factor).to_string(),
        _ => cell.to_owned(),
    }
}

/// The cells of a column of numbers.
fn numbers(column: &dyn Array, factor: f64) -> Option<Vec<Value>> {
    fn of<T: ArrowPrimitiveType<Native: ToString>>(column: &dyn Array, factor: f64) -> Vec<Value> {
        let cell = |cell: Option<T::Native>| {
            cell.map_or(Value::Null, |number| Value::String(scaled(&number.to_string(), factor)))
        };
        column.as_primitive::<T>().iter().map(cell).collect()
    }
    Some(match column.data_type() {
        DataType::Null => vec![Value::Null; column.len()],
        DataType::Float64 => of::<Float64Type>(column, factor),
        DataType::Float32 => of::<Float32Type>(column, factor),
        DataType::Int64 => of::<Int64Type>(column, factor),
        DataType::Int32 => of::<Int32Type>(column, factor),
        DataType::Int16 => of::<Int16Type>(column, factor),
        DataType::Int8 => of::<Int8Type>(column, factor),
        DataType::UInt64 => of::<UInt64Type>(column, factor),
        DataType::UInt32 => of::<UInt32Type>(column, factor),
        DataType::UInt16 => of::<UInt16Type>(column, factor),
        DataType::UInt8 => of::<UInt8Type>(column, factor),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::request::body::CSV;
    use serde_json::json;

    const TABLE: TableBody = TableBody {
        field: "measured",
        columns: || {
            [("t", "t", 1.0), ("t_s", "t", 1.0), ("theta_deg", "theta", 0.5)]
                .map(|(name, column, factor)| (name.to_owned(), column, factor))
                .into()
        },
        others: || vec!["y_m".to_owned()],
        rows: 3,
    };

    fn read(body: &str) -> Result<Value, Problem> {
        let fields = TABLE.fields_of(Map::new(), &CSV, body.as_bytes())?;
        Ok(fields["measured"].clone())
    }

    #[test]
    fn tables_of_spreadsheets_are_read() {
        let wanted = json!({"t": ["1", "2.50"], "theta": ["2", null]});
        for body in [
            "t,theta_deg\n1,4\n2.50,\n",
            "\u{feff}t_s,theta_deg\r\n1,4\r\n2.50,\r\n",
            "\"t [s]\",y_m,\"theta (deg)\"\n\"1\",x,\"4\"\n\"2.50\",\"a, \"\"b\"\"\",\"\"",
        ] {
            assert_eq!(read(body).unwrap(), wanted, "{body}");
        }
        assert_eq!(read("t\n1e-3\nx\n").unwrap(), json!({"t": ["1e-3", "x"]}));
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_place() {
        for body in ["", " \n", "t,theta_deg\n1\n"] {
            assert_eq!(read(body).unwrap_err().status(), 422, "{body:?}");
        }
        for (body, pointer, detail) in [
            ("t_ms\n1", "/measured/t_ms", "unknown column `t_ms` (did you mean `t_s`?); known here: t, t_s, theta_deg"),
            ("t,t_s\n1,1", "/measured/t_s", "the column t is there twice"),
        ] {
            let problem = read(body).unwrap_err();
            let error = &problem.errors()[0];
            assert_eq!(
                (problem.status().as_u16(), error.pointer.as_str(), error.detail.as_str()),
                (422, pointer, detail)
            );
        }
        assert_eq!(TABLE.fields_of(Map::new(), &ARROW, b"ARROW1").unwrap_err().status(), 400);
    }
}
