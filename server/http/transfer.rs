//! Transfer codings of requests (RFC 9112, section 6.1). Only `chunked` is supported; the HTTP library decodes it.

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};

use crate::http::problem::{Problem, shortened};

/// Refuses a body in an unsupported transfer coding: 501. The library decodes a final `chunked` and ignores the codings before it.
/// It refuses another final coding by itself, see [`not_implemented`].
pub fn check(headers: &HeaderMap) -> Result<(), Problem> {
    let values = headers.get_all(header::TRANSFER_ENCODING).iter();
    let text: Vec<_> = values.map(|value| String::from_utf8_lossy(value.as_bytes())).collect();
    let codings = || text.iter().flat_map(|value| value.split(',')).map(str::trim).filter(|coding| !coding.is_empty());
    if let Some(other) = codings().find(|coding| !coding.eq_ignore_ascii_case("chunked")) {
        return Err(not_implemented(Some(other)));
    }
    if codings().count() > 1 {
        return Err(closing(Problem::not_readable("the request is chunked more than once")));
    }
    Ok(())
}

/// 501: the transfer coding is not supported. The connection cannot be used any more.
pub fn not_implemented(coding: Option<&str>) -> Problem {
    let coding = coding.map_or_else(|| "one that does not end with chunked".to_owned(), shortened);
    let detail = format!("the transfer coding of the request is {coding}; only chunked is understood");
    closing(Problem::other(StatusCode::NOT_IMPLEMENTED, detail))
}

fn closing(problem: Problem) -> Problem {
    problem.header(header::CONNECTION, HeaderValue::from_static("close"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunked_alone_is_understood() {
        let status = |values: &[&'static str]| {
            let headers = values.iter().map(|value| (header::TRANSFER_ENCODING, HeaderValue::from_static(value)));
            check(&headers.collect()).err().map(|problem| problem.status().as_u16())
        };
        for fine in [&[][..], &["chunked"], &["Chunked"], &[" chunked ,"]] {
            assert_eq!(status(fine), None, "{fine:?}");
        }
        for other in [&["gzip, chunked"][..], &["gzip", "chunked"], &["identity,chunked"], &["x;a=\"b\", chunked"]] {
            assert_eq!(status(other), Some(501), "{other:?}");
        }
        for twice in [&["chunked, chunked"][..], &["chunked", "chunked"]] {
            assert_eq!(status(twice), Some(400), "{twice:?}");
        }
    }
}
