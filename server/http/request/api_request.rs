//! A request to the API: the fields of a GET's query or of a POST's JSON body, and the wanted format. Both give the same tree of
//! fields.

use axum::body::Bytes;
use axum::extract::{FromRef, FromRequest, Request};
use axum::http::{Extensions, HeaderMap, Method};
use serde_json::{Map, Value};

use crate::compute::Peer;
use crate::http::problem::{Problem, ProblemError, shortened};
use crate::http::request::reader::{Errors, Reader, Source, join, retired};
use crate::http::request::tree;
use crate::http::request::tree::{ARROW, CSV, JSON, MediaType, NDJSON, TableBody};
use crate::limits;
use crate::limits::Limits;

/// A request for something computed. As an extractor it takes the body, so it comes last.
#[derive(Debug, Clone)]
pub struct ApiRequest {
    /// Fields of the JSON body, or of the body that the query stands for, without `format`.
    pub fields: Map<String, Value>,
    /// Source of the values: JSON or the text of a query.
    pub source: Source,
    /// Headers of the request.
    pub headers: HeaderMap,
    /// The client.
    pub peer: Peer,
    /// True for HEAD.
    pub(crate) is_head: bool,
    /// The format of the answer that the query asks for.
    pub(crate) format: Option<String>,
}

impl ApiRequest {
    /// A reader of all fields, which gathers errors in `errors`.
    pub fn reader<'v, 'e>(&'v self, errors: &'e mut Errors) -> Reader<'v, 'e> {
        Reader::new(&self.fields, String::new(), self.source, errors)
    }

    /// Reads all fields with `read`; a 422 has all errors.
    ///
    /// `read` must ask for every field that it knows, or the others count as unknown. If it returns None, it has recorded an error.
    pub fn read<'v, T>(&'v self, read: impl FnOnce(&mut Reader<'v, '_>) -> Option<T>) -> Result<T, Problem> {
        self.read_below("", read)
    }

    /// The same for fields of which all errors are below a pointer.
    pub(crate) fn read_below<'v, T>(
        &'v self,
        pointer: &str,
        read: impl FnOnce(&mut Reader<'v, '_>) -> Option<T>,
    ) -> Result<T, Problem> {
        let mut errors = Errors::default();
        let mut reader = Reader::new(&self.fields, pointer.to_owned(), self.source, &mut errors);
        let value = read(&mut reader);
        reader.finish();
        errors.into_result()?;
        value.ok_or_else(Problem::internal)
    }

    /// The request that a parameter of this one gives as a query. Errors are below `pointer`.
    ///
    /// # Errors
    /// A query that cannot be read, or one that asks for a format, which this request does.
    pub(crate) fn target(&self, pointer: &str, query: &str) -> Result<Self, Problem> {
        let read = Self::from_query(query, self.is_head, self.headers.clone(), self.peer);
        let target = read.map_err(|problem| Problem::invalid_at(pointer, problem.detail()))?;
        if target.format.is_some() {
            let detail = "`format` is no part of a target: it is about the answer, not about the scene";
            return Err(Problem::invalid_at(join(pointer, "format"), detail));
        }
        Ok(Self { format: self.format.clone(), ..target })
    }

    fn from_query(query: &str, is_head: bool, headers: HeaderMap, peer: Peer) -> Result<Self, Problem> {
        let (format, parameters) = split_format(query)?;
        Ok(Self { fields: tree::unfold(parameters)?, source: Source::Query, headers, peer, is_head, format })
    }

    pub(crate) fn from_body(query: &str, body: &[u8], headers: HeaderMap, peer: Peer) -> Result<Self, Problem> {
        let (format, parameters) = split_format(query)?;
        if !parameters.is_empty() {
            let error = |(name, _): (String, String)| ProblemError {
                pointer: name.split('.').fold(String::new(), |pointer, part| join(&pointer, part)),
                detail: match retired(&name) {
                    Some(advice) => format!("unknown field `{name}` ({advice})"),
                    None => format!(
                        "on POST only `format` is read from the query; `{}` belongs in the body",
                        shortened(&name)
                    ),
                },
            };
            return Err(Problem::invalid(parameters.into_iter().map(error).take(limits::ERRORS).collect()));
        }
        Ok(Self { fields: tree::object(body)?, source: Source::Json, headers, peer, is_head: false, format })
    }
}

impl<S: Send + Sync> FromRequest<S> for ApiRequest
where
    Limits: FromRef<S>,
{
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        Self::of(request, &Limits::from_ref(state), None).await
    }
}

impl ApiRequest {
    /// A request, of which a table may be the body.
    pub(crate) async fn of(request: Request, limits: &Limits, table: Option<&TableBody>) -> Result<Self, Problem> {
        let (parts, body) = request.into_parts();
        let query = parts.uri.query().unwrap_or_default();
        let peer = peer(&parts.extensions);
        if parts.method == Method::GET || parts.method == Method::HEAD {
            return Self::from_query(query, parts.method == Method::HEAD, parts.headers, peer);
        }
        let types: &[&MediaType] = if table.is_some() { &[&JSON, &CSV, &ARROW] } else { &[&JSON] };
        let media_type = MediaType::among(types, &parts.headers)?;
        let body = tree::read(body, &parts.headers, limits).await?;
        let Some(table) = table.filter(|_| !media_type.is(&JSON)) else {
            return Self::from_body(query, &body, parts.headers, peer);
        };
        let request = Self::from_query(query, false, parts.headers, peer)?;
        Ok(Self { fields: table.fields_of(request.fields, media_type, &body)?, ..request })
    }
}

/// The client of a request; [`Peer::NOBODY`] in a test without a socket.
pub fn peer(extensions: &Extensions) -> Peer {
    extensions.get().copied().unwrap_or(Peer::NOBODY)
}

/// Parameters of a query: name and value.
type Parameters = Vec<(String, String)>;

/// Separates the format of the answer from all other parameters: it is no part of the request.
fn split_format(query: &str) -> Result<(Option<String>, Parameters), Problem> {
    let (asked, others): (Vec<_>, Vec<_>) =
        tree::parameters(query)?.into_iter().partition(|(name, _)| name == "format");
    match asked.len() {
        0 | 1 => Ok((asked.into_iter().next().map(|(_, format)| format), others)),
        _ => Err(Problem::invalid_at("/format", "the parameter `format` is there twice")),
    }
}

// Batches: many requests in one body, one JSON object on each line (NDJSON).

/// A batch of requests. As an extractor it takes the body, so it comes last.
#[derive(Debug)]
pub struct NdjsonBatch {
    /// Format and headers for the answer to the batch; it has no fields.
    pub request: ApiRequest,
    body: Bytes,
}

impl NdjsonBatch {
    /// The requests on lines that are not blank.
    pub fn into_items(self) -> impl Iterator<Item = BatchItem> + Send {
        let mut rest = Some(self.body);
        let lines = std::iter::from_fn(move || {
            let mut line = rest.take()?;
            if let Some(end) = line.iter().position(|byte| *byte == b'\n') {
                let mut after = line.split_off(end);
                rest = Some(after.split_off(1));
            }
            Some(line)
        });
        let peer = self.request.peer;
        let numbered = lines.zip(1..).filter(|(line, _)| !line.trim_ascii().is_empty());
        numbered.map(move |(body, number)| BatchItem { number, body, peer })
    }
}

/// One request of a batch.
#[derive(Debug)]
pub struct BatchItem {
    /// Number of the line in the body, from 1.
    pub number: usize,
    body: Bytes,
    peer: Peer,
}

impl BatchItem {
    /// The request, as if it had been posted alone.
    pub fn request(&self) -> Result<ApiRequest, Problem> {
        ApiRequest::from_body("", &self.body, HeaderMap::new(), self.peer)
    }
}

impl<S: Send + Sync> FromRequest<S> for NdjsonBatch
where
    Limits: FromRef<S>,
{
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        let (parts, body) = request.into_parts();
        NDJSON.check(&parts.headers)?;
        let body = tree::read(body, &parts.headers, &Limits::from_ref(state)).await?;
        let peer = peer(&parts.extensions);
        let request = ApiRequest::from_body(parts.uri.query().unwrap_or_default(), b"{}", parts.headers, peer)?;
        if body.trim_ascii().is_empty() {
            return Err(Problem::not_readable("the body is empty; it must be a JSON object on each line"));
        }
        Ok(Self { request, body })
    }
}

#[cfg(test)]
mod tests {
    use axum::body::Body;
    use axum::http::header;
    use serde_json::json;

    use super::*;

    async fn ask(request: axum::http::request::Builder, body: impl Into<Body>) -> Result<ApiRequest, Problem> {
        ApiRequest::from_request(request.body(body.into()).unwrap(), &Limits::default()).await
    }

    fn post(media_type: &str) -> axum::http::request::Builder {
        Request::post("/v1/x").header(header::CONTENT_TYPE, media_type)
    }

    #[tokio::test]
    async fn a_query_and_a_body_are_the_same_tree() {
        let get = ask(Request::get("/v1/x?a.b=1&format=csv"), "").await.unwrap();
        assert_eq!((Value::Object(get.fields), get.source), (json!({"a": {"b": "1"}}), Source::Query));
        assert_eq!(get.format.as_deref(), Some("csv"));
        let post = Request::post("/v1/x?format=csv").header(header::CONTENT_TYPE, "application/json; charset=UTF-8");
        let post = ask(post, r#"{"a": {"b": 1}}"#).await.unwrap();
        assert_eq!((Value::Object(post.fields), post.source), (json!({"a": {"b": 1}}), Source::Json));
        assert_eq!(post.format.as_deref(), Some("csv"));
    }

    #[tokio::test]
    async fn format_is_asked_for_in_the_query_only() {
        let query = Request::post("/v1/x?bounces=3&a.b=1").header(header::CONTENT_TYPE, "application/json");
        let problem = ask(query, "{}").await.unwrap_err();
        let pointers: Vec<&str> = problem.errors().iter().map(|error| error.pointer.as_str()).collect();
        assert_eq!((problem.status().as_u16(), pointers), (422, vec!["/bounces", "/a/b"]));
        assert_eq!(ask(Request::get("/v1/x?format=csv&format=json"), "").await.unwrap_err().status(), 422);
    }

    #[tokio::test]
    async fn only_json_is_read() {
        for media_type in
            ["text/plain", "application/x-www-form-urlencoded", "application/json; charset=utf-16", "json"]
        {
            let problem = ask(post(media_type), "{}").await.unwrap_err();
            assert_eq!(problem.status(), 415, "{media_type}");
        }
        assert_eq!(ask(Request::post("/v1/x"), "{}").await.unwrap_err().status(), 415);
        let packed = post("application/json").header(header::CONTENT_ENCODING, "gzip");
        assert_eq!(ask(packed, "{}").await.unwrap_err().status(), 415);
        assert!(ask(post("application/merge-patch+json"), "{}").await.is_ok());
    }

    #[tokio::test]
    async fn bodies_are_bounded_announced_or_not() {
        let large = format!("{{\"a\": \"{}\"}}", "x".repeat(Limits::default().body_bytes));
        assert_eq!(ask(post("application/json"), large.clone()).await.unwrap_err().status(), 413);
        let announced = post("application/json").header(header::CONTENT_LENGTH, large.len());
        assert_eq!(ask(announced, large).await.unwrap_err().status(), 413);
    }

    #[tokio::test]
    async fn what_is_not_json_is_400() {
        assert_eq!(ask(post("application/json"), "{,}").await.unwrap_err().status(), 400);
        assert_eq!(ask(Request::get("/v1/x?a=%ff"), "").await.unwrap_err().status(), 400);
    }

    async fn lines(query: &str, body: &'static str) -> Result<NdjsonBatch, Problem> {
        let request = Request::post(format!("/v1/x{query}")).header(header::CONTENT_TYPE, "application/jsonl");
        NdjsonBatch::from_request(request.body(Body::from(body)).unwrap(), &Limits::default()).await
    }

    #[tokio::test]
    async fn each_line_is_a_request_of_its_own() {
        let lines = lines("?format=ndjson", "{\"a\": 1}\r\n\n  \t\n{\"a\": }\n{}").await.unwrap();
        let asks: Vec<_> = lines.into_items().map(|line| (line.number, line.request())).collect();
        let numbers: Vec<usize> = asks.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, [1, 4, 5]);
        assert_eq!(asks[0].1.as_ref().unwrap().fields["a"], 1);
        assert_eq!(asks[1].1.as_ref().unwrap_err().status(), 400);
        assert!(asks[2].1.as_ref().unwrap().fields.is_empty());
    }

    #[tokio::test]
    async fn no_line_and_other_parameters_are_refused() {
        assert_eq!(lines("", " \n\r\n").await.unwrap_err().status(), 400);
        assert_eq!(lines("?bounces=3", "{}").await.unwrap_err().status(), 422);
    }

    #[tokio::test]
    async fn json_alone_is_not_lines() {
        let request = Request::post("/v1/x").header(header::CONTENT_TYPE, "application/json").body(Body::from("{}"));
        assert_eq!(NdjsonBatch::from_request(request.unwrap(), &Limits::default()).await.unwrap_err().status(), 415);
    }
}
