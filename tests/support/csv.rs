//! A strict RFC 4180 reader: CRLF line ends, rows of one width, quotes only around whole cells.

/// A header row and the rows under it.
pub(crate) struct Table {
    pub(crate) names: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a text. Errors name the broken rule.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if !text.ends_with("\r\n") {
            return Err("the last line does not end with CRLF".into());
        }
        if text.replace("\r\n", "").contains(['\r', '\n']) {
            return Err("a line ends with something else than CRLF".into());
        }
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(false).from_reader(text.as_bytes());
        let mut rows: Vec<Vec<String>> = Vec::new();
        for row in reader.records() {
            rows.push(row.map_err(|error| error.to_string())?.iter().map(str::to_owned).collect());
        }
        if rows.is_empty() {
            return Err("no header row".into());
        }
        let names = rows.remove(0);
        Ok(Self { names, rows })
    }

    /// The cells of a column.
    #[track_caller]
    pub(crate) fn column(&self, name: &str) -> Vec<&str> {
        let index = self.names.iter().position(|known| known == name);
        let index = index.unwrap_or_else(|| panic!("no column {name} among {:?}", self.names));
        self.rows.iter().map(|row| row[index].as_str()).collect()
    }
}
