//! Lines that report the progress of work: at most one for each hundredth of it, and the answer as the last line.
//!
//! Lines depend on the work done and not on a clock, so the same request has the same lines. Each resource chooses the unit of
//! its work.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

/// A line that reports progress.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Progress")]
pub struct ProgressLine {
    progress: WorkDone,
}

/// Work done, in the unit of the resource.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct WorkDone {
    done: u64,
    /// The whole work.
    of: u64,
}

/// Progress reported so far.
#[derive(Debug, Default)]
pub struct Progress {
    hundredth: Option<u64>,
}

impl Progress {
    /// The line for `done` of `of`. Empty if its hundredth has been reported.
    pub fn line(&mut self, done: u64, of: u64) -> Vec<u8> {
        let hundredth = Some(100 * done / of.max(1));
        if self.hundredth == hundredth {
            return Vec::new();
        }
        self.hundredth = hundredth;
        let line = ProgressLine { progress: WorkDone { done, of } };
        // Two numbers are written without failure.
        [serde_json::to_vec(&line).unwrap_or_default().as_slice(), b"\n"].concat()
    }
}

/// The last line: an answer in JSON, and its pictures by name.
pub fn end(answer: &[u8], pictures: Vec<(&'static str, String)>) -> Vec<u8> {
    let pictures: serde_json::Map<String, Value> =
        pictures.into_iter().map(|(name, picture)| (name.to_owned(), Value::String(picture))).collect();
    let pictures = Value::Object(pictures).to_string();
    [b"{\"end\":", answer, b",\"pictures\":", pictures.as_bytes(), b"}\n"].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_a_line_for_each_hundredth() {
        let mut progress = Progress::default();
        let lines: Vec<_> = (0..=1000).map(|done| progress.line(done, 1000)).filter(|line| !line.is_empty()).collect();
        assert_eq!(lines.len(), 101);
        assert_eq!(lines[57], b"{\"progress\":{\"done\":570,\"of\":1000}}\n");
    }

    #[test]
    fn little_work_has_a_line_for_each_step() {
        let mut progress = Progress::default();
        assert!((0..=3).all(|done| !progress.line(done, 3).is_empty()));
        assert_eq!(Progress::default().line(0, 0), b"{\"progress\":{\"done\":0,\"of\":0}}\n");
    }
}
