//! Joins routes and middleware: the server as one value, which tests can use without a socket.

use axum::Router;

use crate::api;
use crate::api::App;
use crate::middleware::{apply_layers, not_found};

/// The whole server.
pub fn router(app: App) -> Router {
    apply_layers(api::all(app.config.web.as_deref()).fallback(not_found), app)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::Body;
    use axum::extract::State;
    use axum::http::{self, Request, Response, header};
    use axum::routing::get;
    use http_body_util::BodyExt;
    use serde_json::Value;
    use tower::ServiceExt;

    use crate::BUILD;
    use crate::compute::{Price, TimeSlice};
    use crate::config::Config;
    use crate::http::{ApiRequest, Errors, Format, Problem, REQUEST_ID, Resource};
    use crate::limits;
    use crate::limits::Limits;

    async fn send(request: Request<Body>) -> Response<Body> {
        let app = App::new(&Config::default());
        let broken = Router::new()
            .route("/panics", get(async || -> &'static str { panic!("on purpose") }))
            .route("/speaks", get(async || (axum::http::StatusCode::IM_A_TEAPOT, "short and stout")));
        let router = apply_layers(api::all(None).merge(broken).fallback(not_found), app);
        router.oneshot(request).await.unwrap()
    }

    async fn problem_of(response: Response<Body>) -> Value {
        assert_eq!(response.headers()[header::CONTENT_TYPE], "application/problem+json");
        assert_eq!(response.headers()["equipoise-build"], BUILD);
        assert!(response.headers().contains_key(header::CONTENT_SECURITY_POLICY));
        let status = response.status().as_u16();
        let id = response.headers()[REQUEST_ID].to_str().unwrap().to_owned();
        let problem: Value = serde_json::from_slice(&response.into_body().collect().await.unwrap().to_bytes()).unwrap();
        assert_eq!(problem["status"], status);
        assert_eq!(problem["request_id"], id);
        problem
    }

    #[tokio::test]
    async fn every_error_is_a_problem() {
        let long = format!("/{}", "x".repeat(limits::URL_BYTES));
        for (method, path, status) in [
            ("GET", "/nowhere", 404),
            ("GET", "/v1/%ff", 404),
            ("DELETE", "/health/live", 405),
            ("BREW", "/metrics", 405),
            ("GET", "/panics", 500),
            ("GET", "/speaks", 418),
            ("GET", long.as_str(), 414),
        ] {
            let request = Request::builder().method(method).uri(path).body(Body::empty()).unwrap();
            let response = send(request).await;
            assert_eq!(response.status(), status, "{method} {path:.20}");
            if status == 405 {
                assert_eq!(response.headers()[header::ALLOW], "GET, HEAD");
            }
            let problem = problem_of(response).await;
            if status == 405 {
                assert!(problem["detail"].as_str().unwrap().ends_with("it takes GET, HEAD"), "{problem}");
            }
            assert!(!problem["detail"].as_str().unwrap().contains("on purpose"));
        }
    }

    #[tokio::test]
    async fn a_panic_in_work_is_a_500_too_and_the_next_request_succeeds() {
        let dear = crate::compute::Price::bounces(limits::INLINE_BOUNCES + 1);
        let pool = crate::compute::Pool::new(1, &Limits::default());
        let work = get(async move |uri: axum::http::Uri| {
            let panics = uri.query().is_some();
            pool.run(dear, move |_| if panics { panic!("deep") } else { Ok::<_, Problem>("fine") }).await
        });
        let app = App::new(&Config::default());
        let router = apply_layers(Router::new().route("/works", work), app);
        for _ in 0..3 {
            let ask = async |target| router.clone().oneshot(Request::get(target).body(Body::empty()).unwrap()).await;
            assert_eq!(problem_of(ask("/works?panic").await.unwrap()).await["status"], 500);
            assert_eq!(ask("/works").await.unwrap().status(), 200);
        }
    }

    #[tokio::test]
    async fn head_is_get_without_the_body() {
        for path in ["/openapi.yaml", "/openapi.json", "/health/live"] {
            let get = send(Request::get(path).body(Body::empty()).unwrap()).await;
            let head = send(Request::head(path).body(Body::empty()).unwrap()).await;
            assert_eq!(head.status(), 200, "{path}");
            for name in [header::CONTENT_TYPE, header::CACHE_CONTROL] {
                assert_eq!(get.headers()[&name], head.headers()[&name]);
            }
            assert_eq!(get.headers().get(header::ETAG), head.headers().get(header::ETAG));
            let length = get.into_body().collect().await.unwrap().to_bytes().len();
            assert_eq!(head.headers()[header::CONTENT_LENGTH], length.to_string());
            assert!(head.into_body().collect().await.unwrap().to_bytes().is_empty());
        }
    }

    #[tokio::test]
    async fn the_contract_is_the_same_twice() {
        let response = send(Request::get("/openapi.json").body(Body::empty()).unwrap()).await;
        let json: Value = serde_json::from_slice(&response.into_body().collect().await.unwrap().to_bytes()).unwrap();
        assert!(json["openapi"].as_str().unwrap().starts_with("3.1"));
    }

    #[tokio::test]
    async fn a_server_that_closes_is_live_but_not_ready() {
        let app = App::new(&Config::default());
        let ask = async |path: &str| {
            let request = Request::get(path).body(Body::empty()).unwrap();
            router(app.clone()).oneshot(request).await.unwrap().status().as_u16()
        };
        assert_eq!((ask("/health/live").await, ask("/health/ready").await), (200, 200));
        app.close();
        assert_eq!((ask("/health/live").await, ask("/health/ready").await), (200, 503));
        app.closing().await;
    }

    /// A resource like all others: read, price, answer.
    async fn squares(State(app): State<App>, api_request: ApiRequest) -> Result<Response<Body>, Problem> {
        const RESOURCE: Resource = Resource { name: "squares", formats: &[Format::Json, Format::Csv] };
        let mut errors = Errors::default();
        let mut reader = api_request.reader(&mut errors);
        let count = reader.integer("count", 1..=1_000_000).unwrap_or(3);
        let factor =
            reader.within("scale", |scale| scale.number("factor", 0.0..=10.0, "m").unwrap_or(1.0)).unwrap_or(1.0);
        reader.finish();
        errors.into_result()?;
        let price = Price::bounces(count).times(100).within(&app.config.limits.of_work())?;
        let canonical = serde_json::to_vec(&(count, factor)).expect("numbers");
        let metrics = app.metrics.clone();
        let compute = move |format: Format, slice: &TimeSlice| {
            let squares: Vec<f64> = (0..count).map(|n| (n * n) as f64 * factor).collect();
            slice.check()?;
            metrics.bounces.inc_by(count);
            Ok(match format {
                Format::Csv => {
                    squares.iter().fold("square_m\r\n".to_owned(), |csv, n| csv + &format!("{n}\r\n")).into()
                }
                _ => serde_json::to_vec(&squares).expect("numbers"),
            })
        };
        api_request.respond(&app.answers, &RESOURCE, &canonical, price, compute).await
    }

    async fn text_of(response: Response<Body>) -> String {
        String::from_utf8(response.into_body().collect().await.unwrap().to_bytes().to_vec()).unwrap()
    }

    #[tokio::test]
    async fn a_resource_follows_the_rules_of_all() {
        let app = App::new(&Config::default());
        let router = apply_layers(Router::new().route("/v1/squares", get(squares).post(squares)), app);
        let send = async |request: http::request::Builder, body: &'static str| {
            router.clone().oneshot(request.body(Body::from(body)).unwrap()).await.unwrap()
        };
        let get = send(Request::get("/v1/squares?count=4&scale.factor=0.5"), "").await;
        let json = || Request::post("/v1/squares").header(header::CONTENT_TYPE, "application/json");
        let post = send(json(), r#"{"scale": {"factor": 5e-1}, "count": 4}"#).await;
        assert_eq!(get.headers()[header::ETAG], post.headers()[header::ETAG]);
        let head = send(Request::head("/v1/squares?count=4&scale.factor=0.5"), "").await;
        let lasting = |response: &Response<Body>| {
            let mut headers = response.headers().clone();
            assert!(headers.remove(REQUEST_ID).is_some());
            headers
        };
        assert_eq!(lasting(&head), lasting(&get));
        assert_eq!(text_of(head).await, "");
        let tag = get.headers()[header::ETAG].clone();
        assert_eq!((text_of(get).await, text_of(post).await), ("[0.0,0.5,2.0,4.5]".into(), "[0.0,0.5,2.0,4.5]".into()));
        let again = Request::get("/v1/squares?scale.factor=.50&count=4").header(header::IF_NONE_MATCH, tag);
        assert_eq!(send(again, "").await.status(), 304);
        assert_eq!(
            text_of(send(Request::get("/v1/squares?format=csv&count=2"), "").await).await,
            "square_m\r\n0\r\n1\r\n"
        );

        let dear = problem_of(send(Request::get("/v1/squares?count=1000000"), "").await).await;
        assert_eq!(
            dear["errors"][0]["detail"],
            "the work of this request would be 100000000 bounces; the limit is 30000000 bounces"
        );
        let wrong = problem_of(send(json(), r#"{"count": "4", "scale": {"factor": 11, "x": 1}}"#).await).await;
        let pointers: Vec<&Value> = wrong["errors"].as_array().unwrap().iter().map(|error| &error["pointer"]).collect();
        assert_eq!(pointers, ["/count", "/scale/factor", "/scale/x"]);
        assert_eq!(problem_of(send(Request::get("/v1/squares?format=svg"), "").await).await["status"], 406);
    }
}
