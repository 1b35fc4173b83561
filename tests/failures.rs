//! The failure gallery: on every case the usual method is wrong, and what is true is found here by another way than the
//! server's.

mod support;

use serde_json::Value;
use support::Server;

/// The cases by name.
async fn gallery(server: &Server) -> Vec<Value> {
    let answer = server.get("/v1/failures").await.expect(200).json();
    answer["failures"].as_array().unwrap().clone()
}

async fn case(name: &str) -> Value {
    Server::start().get(&format!("/v1/failures/{name}")).await.expect(200).json()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// What a method of a case says; the method is found by a part of its name.
#[track_caller]
fn says<'a>(case: &'a Value, method: &str) -> &'a Value {
    let found = case["says"].as_array().unwrap().iter().find(|said| said["method"].as_str().unwrap().contains(method));
    found.unwrap_or_else(|| panic!("{case}: no {method}"))
}

#[tokio::test]
async fn on_every_case_the_usual_method_is_wrong() {
    let server = Server::start();
    for case in gallery(&server).await {
        let says = case["says"].as_array().unwrap();
        assert_eq!(says[0]["right"], false, "{case}");
        assert!(says.iter().any(|said| said["right"] == true), "{case}");
        for said in says {
            assert_eq!(said["right"] == true, said["verdict"] == case["truth"]["verdict"], "{said}");
        }
    }
}

#[tokio::test]
async fn every_case_is_found_by_its_name_with_its_picture_and_its_question() {
    let server = Server::start();
    for case in gallery(&server).await {
        let name = case["name"].as_str().unwrap();
        assert_eq!(server.get(&format!("/v1/failures/{name}")).await.expect(200).json(), case);
        let picture = server.get(case["picture"].as_str().unwrap()).await.expect(200);
        assert_eq!(picture.media_type(), "image/svg+xml", "{name}");
        let asked = server.get(case["ask"].as_str().unwrap()).await.expect(200).json();
        assert_eq!(asked["scene"], case["scene"], "{name}: it asks of another scene");
    }
}

#[tokio::test]
async fn the_names_are_those_of_the_contract() {
    let names: Vec<Value> = gallery(&Server::start()).await.iter().map(|case| case["name"].clone()).collect();
    assert_eq!(Value::from(names), support::contract::DOCUMENT["components"]["schemas"]["FailureName"]["enum"]);
}

#[tokio::test]
async fn an_unknown_case_is_told_which_there_are() {
    let server = Server::start();
    let problem = server.get("/v1/failures/success").await.expect(404).json();
    for case in gallery(&server).await {
        assert!(problem["detail"].as_str().unwrap().contains(case["name"].as_str().unwrap()), "{problem}");
    }
}

#[tokio::test]
async fn the_same_bytes_twice_and_none_for_who_has_them() {
    let (one, other) = (Server::start(), Server::start());
    for target in ["/v1/failures", "/v1/failures/beyond-critical?format=svg"] {
        let (first, second) = (one.get(target).await.expect(200), other.get(target).await.expect(200));
        assert_eq!(first.raw, second.raw, "{target}");
        other.get_with(target, &[("if-none-match", first.etag())]).await.expect(304);
    }
}

/// The tilt gain at which the mirror-symmetric orbit of period 2 has this angle, less κ_c: from the condition of such an
/// orbit, Gρ²θ cos κθ = V²l sin((κ − 1)θ), and from what is held, without the coefficient C.
fn branch_offset(case: &Value, theta: f64) -> f64 {
    let scene = &case["scene"];
    let (l, rho) = (number(&scene["body"]["contact_distance"]), number(&scene["body"]["radius_of_gyration"]));
    let gravity = number(&scene["gravity"]) * number(&scene["incline"]).sin();
    let feedback = number(&scene["table"]["energy_gain"]) > 0.0;
    let top = if feedback { number(&scene["table"]["target_height"]) } else { number(&scene["release"]["height"]) };
    let upright = 2.0 * gravity * (top - l);
    let too_much = |kappa: f64| {
        let speed_squared = gravity * rho * rho * theta * (kappa * theta).cos() / (l * ((kappa - 1.0) * theta).sin());
        let aside = speed_squared * (kappa * theta).tan().powi(2) + (rho * gravity * theta).powi(2) / speed_squared;
        let held = if feedback { 0.0 } else { aside };
        speed_squared + held - 2.0 * gravity * l * (1.0 - theta.cos()) - upright
    };
    let critical = 1.0 + gravity * rho * rho / (upright * l);
    let (mut low, mut high) = (critical - 0.1 * (critical - 1.0), critical + 0.1 * (critical - 1.0));
    assert!(too_much(low) > 0.0 && too_much(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if too_much(middle) > 0.0 { low = middle } else { high = middle }
    }
    low - critical
}

#[tokio::test]
async fn at_the_boundary_the_branch_itself_says_which_way_it_bends() {
    let server = Server::start();
    for (name, truth) in
        [("double-eigenvalue-soft", "bounded"), ("double-eigenvalue-hard", "falls"), ("hard-by-feedback", "falls")]
    {
        let case = case(name).await;
        assert_eq!(case["truth"]["verdict"], truth);
        let bend = branch_offset(&case, 0.01) / 1e-4;
        assert_eq!(bend > 0.0, truth == "bounded", "{name}: {bend}");
        let scene = &case["scene"];
        let width = number(&scene["table"]["tilt_gain"]) - 1.0;
        let coefficient = case["says"].as_array().unwrap().iter().rev().nth(1).unwrap();
        assert!((bend / width - number(&coefficient["value"])).abs() < 0.01, "{name}: {bend} {coefficient}");
        // Silent, and by the last bit of κ even wrong, by far more than rounding.
        let radius = number(&case["says"][0]["value"]);
        assert!((radius - 1.0).abs() < 1e-7 && case["says"][0]["verdict"] != "stable", "{radius}");
        let ask = case["ask"].as_str().unwrap().split("impacts=").next().unwrap().to_owned() + "impacts=100000";
        let run = &server.get(&ask).await.expect(200).json()["nonlinear"];
        assert_eq!(run["outcome"] == "completed", truth == "bounded", "{name}: {run}");
    }
    let soft = case("double-eigenvalue-soft").await;
    let off = number(&says(&soft, "one unit in its last place")["value"]) - 1.0;
    assert!(off > 1e-9, "rounding by 1e-16 has moved it by {off}");
}

#[tokio::test]
async fn beyond_the_boundary_a_run_stays_about_the_orbit_that_caught_it() {
    let case = case("beyond-critical").await;
    assert!(number(&case["says"][0]["value"]) > 1.3);
    let server = Server::start();
    let ask = case["ask"].as_str().unwrap().replace("impacts=20000", "impacts=100000");
    let run = &server.get(&ask).await.expect(200).json()["nonlinear"];
    assert_eq!((&run["outcome"], &run["impacts"]), (&"completed".into(), &100_000.into()));
    // It swings from near upright to nearly as far beyond the orbit of period 2, by √2 in the amplitude equation.
    let (mut low, mut high) = (0.01, 0.3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if branch_offset(&case, middle) < 0.01 { low = middle } else { high = middle }
    }
    let swing = number(&run["max_theta"]) / low;
    assert!((swing / 2.0_f64.sqrt() - 1.0).abs() < 0.05, "{low} {run}");
}
