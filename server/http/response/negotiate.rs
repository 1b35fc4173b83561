//! Negotiation of format and content encoding (RFC 9110, section 12).
//!
//! `?format=` outranks `Accept`. JSON is the default, also for `*/*` and for lists without any format of the resource. The type of problems
//! says nothing about the format of an answer: clients of openapi-generator name it alone where an answer has no JSON.

use axum::http::{HeaderMap, HeaderName, header};

use crate::http::problem::{MEDIA_TYPE, Problem, shortened};

/// Format of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// One JSON object.
    Json,
    /// Comma-separated values with a header row (RFC 4180).
    Csv,
    /// One JSON object per line.
    Ndjson,
    /// Columns as an IPC stream of Arrow.
    Arrow,
    /// NDJSON with the progress of the work, and the answer last. Only `?format=` asks for it.
    Progress,
    /// A vector picture.
    Svg,
    /// A pixel picture.
    Png,
    /// Server-Sent Events.
    Events,
    /// Gauges for Prometheus.
    OpenMetrics,
    /// The same in the older text format of Prometheus.
    Prometheus,
}

impl Format {
    /// All formats.
    pub(crate) const ALL: [Format; 10] = [
        Format::Json,
        Format::Csv,
        Format::Ndjson,
        Format::Arrow,
        Format::Progress,
        Format::Svg,
        Format::Png,
        Format::Events,
        Format::OpenMetrics,
        Format::Prometheus,
    ];

    /// Name, in `?format=` too; value of `Content-Type`; and types and subtypes in `Accept` that stand for the format.
    const fn row(self) -> (&'static str, &'static str, &'static [(&'static str, &'static str)]) {
        match self {
            Format::Json => ("json", "application/json", &[("application", "json")]),
            Format::Csv => ("csv", "text/csv; charset=utf-8; header=present", &[("text", "csv")]),
            Format::Ndjson => (
                "ndjson",
                "application/x-ndjson",
                &[("application", "x-ndjson"), ("application", "ndjson"), ("application", "jsonl")],
            ),
            Format::Arrow => {
                ("arrow", "application/vnd.apache.arrow.stream", &[("application", "vnd.apache.arrow.stream")])
            }
            Format::Progress => ("progress", "application/x-ndjson", &[]),
            Format::Svg => ("svg", "image/svg+xml", &[("image", "svg+xml")]),
            Format::Png => ("png", "image/png", &[("image", "png")]),
            Format::Events => ("events", "text/event-stream", &[("text", "event-stream")]),
            Format::OpenMetrics => (
                "openmetrics",
                "application/openmetrics-text; version=1.0.0; charset=utf-8",
                &[("application", "openmetrics-text")],
            ),
            Format::Prometheus => ("prometheus", "text/plain; version=0.0.4; charset=utf-8", &[("text", "plain")]),
        }
    }

    /// Name, in `?format=` too.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// Value of `Content-Type`.
    pub fn media_type(self) -> &'static str {
        self.row().1
    }

    fn accepted_as(self) -> &'static [(&'static str, &'static str)] {
        self.row().2
    }

    /// Tells whether compression makes the bytes fewer.
    pub fn is_compressible(self) -> bool {
        !matches!(self, Format::Png | Format::Events)
    }
}

/// Chooses among `formats`, of which the first is the default: the one of the name that `?format=` asks for, or the one that the client accepts
/// most. 406 if there is none.
pub fn format(asked: Option<&str>, headers: &HeaderMap, formats: &[Format]) -> Result<Format, Problem> {
    let names = || formats.iter().map(|format| format.name()).collect::<Vec<_>>().join(", ");
    if let Some(asked) = asked {
        let found = formats.iter().find(|format| format.name() == asked).copied();
        return found.ok_or_else(|| {
            let elsewhere = if Format::ALL.iter().any(|format| format.name() == asked) { " here" } else { "" };
            let asked = shortened(asked);
            Problem::not_acceptable(format!("there is no format {asked:?}{elsewhere}; there is: {}", names()))
        });
    }
    let accept = list(headers, &header::ACCEPT);
    if accept.trim().is_empty() {
        return Ok(formats[0]);
    }
    let ranges: Vec<(&str, f32)> = items(&accept).filter(|(range, _)| !is_problem(range)).collect();
    if ranges.is_empty() && items(&accept).next().is_some() {
        return Ok(formats[0]);
    }
    // By weight, then by closeness, then by the order in `formats`; `max_by` returns the last of equals.
    let best = formats
        .iter()
        .rev()
        .map(|format| (weight(&ranges, *format), *format))
        .filter(|((weight, _), _)| *weight > 0.0)
        .max_by(|(one, _), (other, _)| one.partial_cmp(other).expect("weights are between 0 and 1"));
    best.map(|(_, format)| format).ok_or_else(|| {
        let accepted = formats.iter().filter(|format| !format.accepted_as().is_empty());
        let types: Vec<&str> = accepted.map(|format| format.media_type()).collect();
        let accept = shortened(&accept);
        Problem::not_acceptable(format!("Accept is {accept:?}; there is: {} (?format={})", types.join(", "), names()))
    })
}

fn is_problem(range: &str) -> bool {
    MEDIA_TYPE.as_bytes().eq_ignore_ascii_case(range.as_bytes())
}

/// Weight of a format, and closeness of the range that gives it: 3 for its name, 2 for its type, 1 for `*/*`.
fn weight(ranges: &[(&str, f32)], format: Format) -> (f32, u8) {
    let mut best = (0.0, 0);
    for (range, q) in ranges {
        let Some((kind, subtype)) = range.split_once('/') else { continue };
        for (own_kind, own_subtype) in format.accepted_as() {
            let closeness = match (kind.eq_ignore_ascii_case(own_kind), subtype.eq_ignore_ascii_case(own_subtype)) {
                (true, true) => 3,
                (true, false) if subtype == "*" => 2,
                _ if kind == "*" && subtype == "*" => 1,
                _ => 0,
            };
            if closeness > best.1 {
                best = (*q, closeness);
            }
        }
    }
    best
}

/// Content encoding of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Not compressed.
    Identity,
    /// Compressed (RFC 1952).
    Gzip,
}

impl Encoding {
    /// Name in `Content-Encoding`.
    pub fn name(self) -> &'static str {
        match self {
            Encoding::Identity => "identity",
            Encoding::Gzip => "gzip",
        }
    }
}

/// Encoding by `Accept-Encoding`: gzip if it weighs at least as much as none, or none if it is there for a `part` of the bytes.
/// 406 if the client refuses both.
pub fn encoding(headers: &HeaderMap, part: bool) -> Result<Encoding, Problem> {
    let accept = list(headers, &header::ACCEPT_ENCODING);
    let codings: Vec<(&str, f32)> = items(&accept).collect();
    let named = |name: &str| codings.iter().find(|(coding, _)| coding.eq_ignore_ascii_case(name)).map(|(_, q)| *q);
    let gzip = named("gzip").or(named("x-gzip")).or(named("*")).unwrap_or(0.0);
    let identity = named("identity").or(named("*").filter(|q| *q == 0.0));
    match (gzip > 0.0, identity) {
        (true, Some(identity)) if identity > gzip => Ok(Encoding::Identity),
        (true, identity) if part && identity != Some(0.0) => Ok(Encoding::Identity),
        (true, _) => Ok(Encoding::Gzip),
        (false, Some(0.0)) => {
            let accept = shortened(&accept);
            Err(Problem::not_acceptable(format!("Accept-Encoding is {accept:?}; there is: gzip, identity")))
        }
        (false, _) => Ok(Encoding::Identity),
    }
}

/// All lines of a header, joined into one list.
pub fn list(headers: &HeaderMap, name: &HeaderName) -> String {
    let lines: Vec<&str> = headers.get_all(name).iter().filter_map(|value| value.to_str().ok()).collect();
    lines.join(", ")
}

/// Items of a list with their weights. An item with an invalid weight is left out.
fn items(list: &str) -> impl Iterator<Item = (&str, f32)> {
    list.split(',').filter_map(|item| {
        let mut parts = item.split(';').map(str::trim);
        let name = parts.next().filter(|name| !name.is_empty())?;
        let q = parts.find_map(|part| part.strip_prefix("q=").or(part.strip_prefix("Q=")));
        let q = q.map_or(Some(1.0), |q| q.trim().parse().ok())?;
        (0.0..=1.0).contains(&q).then_some((name, q))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(name: HeaderName, value: &str) -> HeaderMap {
        [(name, value.parse().unwrap())].into_iter().collect()
    }

    #[test]
    fn accept_chooses_a_format() {
        const ALL: [Format; 4] = [Format::Json, Format::Csv, Format::Ndjson, Format::Svg];
        for (accept, expected) in [
            ("*/*", Some(Format::Json)),
            ("", Some(Format::Json)),
            ("application/json", Some(Format::Json)),
            ("APPLICATION/JSON; charset=utf-8", Some(Format::Json)),
            ("text/csv", Some(Format::Csv)),
            ("text/*", Some(Format::Csv)),
            ("application/*", Some(Format::Json)),
            ("application/x-ndjson", Some(Format::Ndjson)),
            ("application/jsonl", Some(Format::Ndjson)),
            // Grafana's Infinity: text/plain outranks JSON, and there is no text/plain.
            ("application/json;q=0.9,text/plain", Some(Format::Json)),
            ("text/plain, application/json;q=0.9, */*;q=0.1", Some(Format::Json)),
            ("text/csv;q=0.5, application/json;q=0.4", Some(Format::Csv)),
            ("text/csv, */*", Some(Format::Csv)),
            ("text/csv, application/json", Some(Format::Json)),
            ("application/json;q=0, */*", Some(Format::Csv)),
            // An <img> in Chromium, then a page.
            ("image/avif,image/webp,image/apng,image/svg+xml,image/*,*/*;q=0.8", Some(Format::Svg)),
            ("text/html,application/xhtml+xml,application/xml;q=0.9,image/avif,*/*;q=0.8", Some(Format::Json)),
            ("text/plain", None),
            ("application/problem+json", Some(Format::Json)),
            ("application/problem+json, text/csv", Some(Format::Csv)),
            ("application/problem+json, image/png", None),
            ("application/json;q=0", None),
            ("image/png", None),
            ("nonsense", None),
            ("application/json;q=2", None),
        ] {
            let found = format(None, &headers(header::ACCEPT, accept), &ALL);
            assert_eq!(found.as_ref().ok().copied(), expected, "{accept}");
            if let Err(problem) = found {
                assert_eq!(problem.status(), 406);
                assert!(problem.detail().contains("text/csv") && problem.detail().contains("?format=json, csv"));
            }
        }
        assert_eq!(format(None, &HeaderMap::new(), &ALL).unwrap(), Format::Json);
    }

    #[test]
    fn the_parameter_outranks_the_header() {
        let accept = headers(header::ACCEPT, "application/json");
        assert_eq!(format(Some("csv"), &accept, &[Format::Json, Format::Csv]).unwrap(), Format::Csv);
        let problem = format(Some("svg"), &accept, &[Format::Json, Format::Csv]).unwrap_err();
        assert_eq!(problem.detail(), "there is no format \"svg\" here; there is: json, csv");
        assert!(format(Some("JSON"), &accept, &[Format::Json]).is_err());
    }

    #[test]
    fn progress_is_told_to_who_asks_for_it_by_name() {
        let formats = [Format::Progress, Format::Ndjson];
        for accept in ["*/*", "application/x-ndjson", "application/*"] {
            assert_eq!(format(None, &headers(header::ACCEPT, accept), &formats).unwrap(), Format::Ndjson, "{accept}");
        }
        assert_eq!(format(Some("progress"), &HeaderMap::new(), &formats).unwrap(), Format::Progress);
        let problem = format(None, &headers(header::ACCEPT, "text/plain"), &formats).unwrap_err();
        assert_eq!(problem.detail().matches("ndjson").count(), 2, "{}", problem.detail());
    }

    #[test]
    fn encoding_is_negotiated() {
        for (accept, expected) in [
            ("gzip", Some(Encoding::Gzip)),
            ("GZIP", Some(Encoding::Gzip)),
            ("gzip, deflate, br, zstd", Some(Encoding::Gzip)),
            ("*", Some(Encoding::Gzip)),
            ("", Some(Encoding::Identity)),
            ("br", Some(Encoding::Identity)),
            ("gzip;q=0", Some(Encoding::Identity)),
            ("gzip;q=0, *", Some(Encoding::Identity)),
            ("gzip;q=0.5, identity", Some(Encoding::Identity)),
            ("gzip;q=0.5, identity;q=0.1", Some(Encoding::Gzip)),
            ("identity;q=0, gzip;q=0.1", Some(Encoding::Gzip)),
            ("br, identity;q=0", None),
            ("*;q=0", None),
            ("identity, *;q=0", Some(Encoding::Identity)),
        ] {
            let headers = headers(header::ACCEPT_ENCODING, accept);
            assert_eq!(encoding(&headers, false).ok(), expected, "{accept}");
            let is_refused = accept.contains("identity;q=0,") || expected.is_none();
            let part = if is_refused { expected } else { Some(Encoding::Identity) };
            assert_eq!(encoding(&headers, true).ok(), part, "{accept}");
        }
        assert_eq!(encoding(&HeaderMap::new(), false).unwrap(), Encoding::Identity);
    }
}
