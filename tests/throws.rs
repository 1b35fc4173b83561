//! Throws: the apex is reached by the run of the answer's scene, chains into a catch, and impossible throws are refused with a reason.

mod support;

use std::f64::consts::PI;

use axum::http::Method;
use serde_json::{Value, json};
use support::contract::{self, DOCUMENT};
use support::tables::Table;
use support::{Server, number_at, numbers};

/// Vertical speed of a fall of case 1 from this height to the table, m/s.
fn fall(height: f64) -> f64 {
    (2.0 * 9.81 * (height - 0.4 / 3.0)).sqrt()
}

/// The highest point of the parabola through three samples of a flight: time, height, and the angle on the line through two of them.
fn apex_of_samples(flights: &Value) -> (f64, f64, f64) {
    let [t, y, theta] = ["t", "y", "theta"].map(|name| numbers(&flights[name]));
    let (mid, last) = (t.len() / 2, t.len() - 1);
    let slope = |from: usize, to: usize| (y[to] - y[from]) / (t[to] - t[from]);
    let bend = (slope(mid, last) - slope(0, mid)) / (t[last] - t[0]);
    let start = slope(0, mid) - bend * t[mid];
    let top = -start / (2.0 * bend);
    let spin = (theta[last] - theta[0]) / (t[last] - t[0]);
    (top, y[0] + top * (start + bend * top), theta[0] + spin * top)
}

#[tokio::test]
async fn a_half_turn_from_a_fall_has_the_known_tilt_and_speed() {
    let server = Server::start();
    let body = json!({"preset": "case-1", "state": {"y_dot": -fall(0.2)}, "apex": {"height": 0.4, "theta": PI}});
    let thrown = server.post("/v1/throws", &body).await.expect(200).json();
    assert!((number_at(&thrown, "/alpha") + 0.256).abs() < 5e-4, "{thrown}");
    assert!((number_at(&thrown, "/table_velocity") - 0.894).abs() < 5e-4, "{thrown}");
    assert!(number_at(&thrown, "/residual") < 1e-12 && number_at(&thrown, "/iterations") == 0.0, "{thrown}");
}

#[tokio::test]
async fn the_scene_of_the_answer_runs_to_the_apex_and_to_the_landing() {
    let server = Server::start();
    let states = [json!({}), json!({"theta": 0.2, "x": 0.3, "x_dot": -0.4, "y_dot": -1.2, "theta_dot": 1.5})];
    for scene in [json!({}), json!({"contact": {"restitution": 0.6}}), json!({"contact": {"friction": 0.4}})] {
        for state in &states {
            for (height, theta) in [(0.25, 0.0), (0.3, -0.2), (0.5, 0.3)] {
                let body = json!({"preset": "case-1", "scene": scene, "state": state,
                    "apex": {"height": height, "theta": theta}});
                let thrown = server.post("/v1/throws", &body).await.expect(200).json();
                let run = json!({"scene": thrown["scene"], "bounces": 1, "samples_per_flight": 256});
                let run = server.post("/v1/trajectories", &run).await.expect(200).json();
                let (t, y, angle) = apex_of_samples(&first_flight(&run["flights"]));
                assert!((t - number_at(&thrown, "/apex/t")).abs() < 1e-10, "{body}: {t}");
                assert!((y - height).abs() < 1e-10 && (angle - theta).abs() < 1e-9, "{body}: {y} {angle}");
                assert!((number_at(&thrown, "/apex/y") - height).abs() < 1e-9, "{thrown}");
                assert!((number_at(&thrown, "/apex/theta") - theta).abs() < 1e-9, "{thrown}");
                for name in ["t", "x", "theta", "x_dot", "y_dot", "theta_dot"] {
                    let landing = number_at(&thrown, &format!("/landing/{name}"));
                    let met = number_at(&run, &format!("/impacts/{name}/0"));
                    assert!((landing - met).abs() < 1e-10, "{body}: {name} {landing} {met}");
                }
            }
        }
    }
}

/// The samples of the fall from the release.
fn first_flight(flights: &Value) -> Value {
    let rows: Vec<usize> =
        numbers(&flights["impact"]).iter().enumerate().filter(|(_, n)| **n == 0.0).map(|(i, _)| i).collect();
    let column = |name: &str| json!(rows.iter().map(|&row| flights[name][row].clone()).collect::<Vec<_>>());
    json!({"t": column("t"), "y": column("y"), "theta": column("theta")})
}

#[tokio::test]
async fn a_throw_at_an_impact_starts_from_its_state() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-1&bounces=7").await.expect(200).json();
    let thrown = server.get("/v1/throws?preset=case-1&impact=7&apex.height=0.3").await.expect(200).json();
    assert_eq!(thrown["t"], run["impacts"]["t"][6]);
    for name in ["x", "theta", "x_dot", "y_dot", "theta_dot"] {
        assert_eq!(thrown["before"][name], run["impacts"][name][6], "{name}");
    }
    // The same state given in numbers gives the same throw.
    let body = json!({"preset": "case-1", "state": thrown["before"], "apex": {"height": 0.3}});
    let given = server.post("/v1/throws", &body).await.expect(200).json();
    for name in ["alpha", "table_velocity", "apex", "landing", "scene"] {
        assert_eq!(given[name], thrown[name], "{name}");
    }
    assert_eq!(given["t"], 0.0);
}

/// From rest: A = ẏ⁺ and P = A/cos α, so the table has half of B·P at e = 1, and the body leaves with the energy of the apex.
#[tokio::test]
async fn a_body_at_rest_is_pushed_up_by_the_table_alone() {
    let server = Server::start();
    let thrown = server.get("/v1/throws?preset=case-1&apex.height=0.25").await.expect(200).json();
    assert_eq!((number_at(&thrown, "/alpha"), number_at(&thrown, "/apex/x")), (0.0, 0.0));
    assert!((number_at(&thrown, "/impulse_normal") - fall(0.25)).abs() < 1e-14, "{thrown}");
    assert!((number_at(&thrown, "/table_velocity") - 0.5 * fall(0.25)).abs() < 1e-14, "{thrown}");
    assert_eq!(thrown["before"], json!({"x": 0.0, "theta": 0.0, "x_dot": 0.0, "y_dot": 0.0, "theta_dot": 0.0}));
    assert!((number_at(&thrown, "/demand/speed") - 0.5 * fall(0.25)).abs() < 1e-14, "{thrown}");
}

/// A strike at the contact point keeps ẋ cos θ + ẏ sin θ − (ρ²/l)θ̇, with any friction (physics.md, section 12).
#[tokio::test]
async fn the_centre_of_percussion_keeps_its_speed_along_the_body() {
    let server = Server::start();
    let (l, rho): (f64, f64) = (0.4 / 3.0, 2_f64.sqrt() / 15.0);
    for friction in [0.0, 0.2, 0.8] {
        for slide in ["none", "matched"] {
            let body = json!({"preset": "case-1", "scene": {"contact": {"friction": friction}, "table": {"slide": slide}},
                "state": {"theta": 0.1, "x_dot": 0.2, "y_dot": -1.0, "theta_dot": -0.5}, "apex": {"height": 0.3, "theta": 0.05}});
            let thrown = server.post("/v1/throws", &body).await.expect(200).json();
            let along = |side: &str| {
                let [theta, x_dot, y_dot, theta_dot] =
                    ["theta", "x_dot", "y_dot", "theta_dot"].map(|name| number_at(&thrown, &format!("/{side}/{name}")));
                x_dot * theta.cos() + y_dot * theta.sin() - rho * rho / l * theta_dot
            };
            assert!((along("before") - along("after")).abs() < 1e-14, "{friction} {slide}: {thrown}");
            assert!(number_at(&thrown, "/residual") < 1e-9, "{thrown}");
        }
    }
}

#[tokio::test]
async fn a_thrown_body_is_caught_as_its_scene_is() {
    let server = Server::start();
    for settings in [json!({}), json!({"strategy": "bounce_down", "ratio": 0.6, "hold": 2, "hold_samples": 50})] {
        let body = json!({"preset": "case-1", "apex": {"height": 0.25, "theta": 0.1}, "catch": settings});
        let thrown = server.post("/v1/throws", &body).await.expect(200).json();
        let mut alone = settings.clone();
        alone["scene"] = thrown["scene"].clone();
        assert_eq!(thrown["catch"], server.post("/v1/catches", &alone).await.expect(200).json(), "{settings}");
        assert_eq!(thrown["catch"]["outcome"]["kind"], "held", "{}", thrown["catch"]["outcome"]);
    }
    let without = server.get("/v1/throws?preset=case-1&apex.height=0.25").await.expect(200).json();
    assert_eq!(without["catch"], Value::Null);
}

#[tokio::test]
async fn a_wrong_belief_misses_the_apex_and_says_so() {
    let server = Server::start();
    let query = "preset=case-1&scene.contact.restitution=0.5&scene.table.assumed_restitution=0.7&apex.height=0.25";
    let thrown = server.get(&format!("/v1/throws?{query}")).await.expect(200).json();
    assert!(number_at(&thrown, "/residual") > 1e-3, "{thrown}");
    let lower = (number_at(&thrown, "/apex/y") - 0.25).abs();
    assert!((lower - number_at(&thrown, "/residual")).abs() < 1e-12, "{thrown}");
    assert!(thrown["notes"][0].as_str().unwrap().contains("assumes a restitution"), "{}", thrown["notes"]);
}

#[tokio::test]
async fn a_body_that_comes_down_beyond_the_topple_angle_is_told_of() {
    let server = Server::start();
    let thrown =
        server.get(&format!("/v1/throws?preset=case-1&apex.height=0.6&apex.theta={PI}")).await.expect(200).json();
    assert!((number_at(&thrown, "/landing/theta")).abs() > 1.6, "{thrown}");
    assert!(thrown["notes"][0].as_str().unwrap().contains("topple_angle"), "{}", thrown["notes"]);
}

#[tokio::test]
async fn the_same_throw_is_the_same_bytes_in_every_format() {
    let query = "preset=case-1&apex.height=0.3&apex.theta=0.1&catch.strategy=bounce_down";
    let body = json!({"preset": "case-1", "apex": {"height": 0.3, "theta": 0.1}, "catch": {"strategy": "bounce_down"}});
    let (server, other) = (Server::start(), Server::start());
    for format in ["json", "csv", "ndjson", "svg", "png"] {
        let target = format!("/v1/throws?{query}&format={format}");
        let one = server.get(&target).await.expect(200);
        let two = other.post(&format!("/v1/throws?format={format}"), &body).await.expect(200);
        assert!(one.raw == two.raw && one.etag() == two.etag(), "{format}");
        server.get_with(&target, &[("if-none-match", one.etag())]).await.expect(304);
        server.head(&target).await.expect(200);
    }
    let json = server.post("/v1/throws", &body).await.json();
    let csv = Table::parse(server.post("/v1/throws?format=csv", &body).await.text()).unwrap();
    let cell = |name: &str| csv.column(name)[0].parse::<f64>().unwrap();
    assert_eq!(csv.rows.len(), 1);
    for (name, pointer) in [
        ("alpha_rad", "/alpha"),
        ("apex_y_m", "/apex/y"),
        ("landing_theta_rad", "/landing/theta"),
        ("y_dot_after_m_per_s", "/after/y_dot"),
        ("theta_dot_rad_per_s", "/before/theta_dot"),
    ] {
        assert_eq!(cell(name), number_at(&json, pointer), "{name}");
    }
    assert_eq!(csv.column("caught"), ["held"]);
    let line: Value =
        serde_json::from_str(server.post("/v1/throws?format=ndjson", &body).await.text().lines().next().unwrap())
            .unwrap();
    assert_eq!(line["impulse_normal"], json["impulse_normal"]);
}

#[tokio::test]
async fn impossible_throws_are_refused_with_a_reason() {
    let server = Server::start();
    for (query, pointer, words) in [
        ("", "/apex", "apex is missing"),
        ("apex.theta=1", "/apex/height", "height is missing"),
        ("apex.height=-1", "/apex/height", "from 0 to 100 m"),
        ("apex.height=0.3&apex.theta=1000", "/apex/theta", "from -100 to 100 rad"),
        ("apex.height=0.1", "/apex/height", "is not above the centre of gravity, which is at 0.1333"),
        ("apex.height=0.3&impact=3&state.theta=0.1", "/impact", "leave one of them out"),
        ("apex.height=0.3&impact=0", "/impact", "from 1 to 100000"),
        ("apex.height=0.3&scene.table.tilt_gain=5&impact=500", "/impact", "the run ends as"),
        ("apex.height=0.3&state.theta=2", "/state", "quarter turn"),
        ("apex.height=0.3&state.y_dot=3", "/apex", "would have to pull"),
        ("apex.height=0.3&state.speed=1", "/state/speed", "unknown field"),
        ("apex.height=0.3&apex.x=1", "/apex/x", "unknown field"),
        ("apex.height=0.3&scene.table.limits.speed=0.1", "/scene/table/limits/speed", "limit is 0.1 m/s"),
        ("apex.height=0.3&catch.strikes=4", "/catch/strikes", "is for the strategy plan, and strategy is auto"),
        ("apex.height=0.3&catch.brake=4&catch.strategy=plan", "/catch/brake", "is for the strategy brake"),
        ("apex.height=0.3&catch.hold=100", "/catch/hold", "from 0.1 to 60 s"),
        ("apex.height=90&apex.theta=100&scene.gravity=100", "/apex", "must be"),
    ] {
        let answer = server.get(&format!("/v1/throws?preset=case-1&{query}")).await.expect(422);
        assert_eq!(answer.pointers(), [pointer], "{query}: {}", answer.text());
        assert!(answer.text().contains(words), "{query}: {}", answer.text());
    }
    let answer = server.get("/v1/throws?preset=point-mass&apex.height=0.3").await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/body/point"]);
    let schema = &DOCUMENT["components"]["schemas"]["ThrowRequest"];
    for body in [json!({"preset": "case-1"}), json!({"preset": "case-1", "apex": {"height": 200}})] {
        assert!(!contract::faults(schema, &body).is_empty(), "{body}");
        server.post("/v1/throws", &body).await.expect(422);
    }
    server.send(Method::PUT, "/v1/throws", &[], "").await.expect(405);
}
