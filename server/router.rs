//! Puts routes and middleware together: the server as one value, which tests can ask without a socket.

use axum::Router;

use crate::middleware::{not_found, surround};
use crate::routes::{self, App};

/// The whole server.
pub fn router(app: App) -> Router {
    surround(routes::all().fallback(not_found), app)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::Body;
    use axum::http::{Request, Response, header};
    use axum::routing::get;
    use http_body_util::BodyExt;
    use serde_json::Value;
    use tower::ServiceExt;

    use crate::BUILD;
    use crate::config::Config;
    use crate::limits;

    async fn send(request: Request<Body>) -> Response<Body> {
        let app = App::new(&Config::default());
        let broken = Router::new()
            .route("/panics", get(async || -> &'static str { panic!("on purpose") }))
            .route("/speaks", get(async || (axum::http::StatusCode::IM_A_TEAPOT, "short and stout")));
        let router = surround(routes::all().merge(broken).fallback(not_found), app);
        router.oneshot(request).await.unwrap()
    }

    async fn problem_of(response: Response<Body>) -> Value {
        assert_eq!(response.headers()[header::CONTENT_TYPE], "application/problem+json");
        assert_eq!(response.headers()["equipoise-build"], BUILD);
        assert!(response.headers().contains_key(header::CONTENT_SECURITY_POLICY));
        let status = response.status().as_u16();
        let problem: Value = serde_json::from_slice(&response.into_body().collect().await.unwrap().to_bytes()).unwrap();
        assert_eq!(problem["status"], status);
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
    async fn a_panic_in_work_is_a_500_too() {
        let dear = crate::compute::Price::bounces(limits::INLINE_BOUNCES + 1);
        let pool = crate::compute::Pool::new(1);
        let work =
            get(async move || pool.run(dear, |_| -> Result<String, crate::http::Problem> { panic!("deep") }).await);
        let app = App::new(&Config::default());
        let router = surround(Router::new().route("/works", work), app);
        let response = router.oneshot(Request::get("/works").body(Body::empty()).unwrap()).await.unwrap();
        assert_eq!(problem_of(response).await["status"], 500);
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
}
