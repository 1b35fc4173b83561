//! The failure gallery: on every case a common method is wrong. The truth is found here in another way than in the server.

use serde_json::Value;

use crate::support::{Server, number};

/// The cases by name.
async fn gallery(server: &Server) -> Vec<Value> {
    let answer = server.get("/v1/failures").await.expect(200).json();
    answer["items"].as_array().unwrap().clone()
}

pub(crate) async fn case(name: &str) -> Value {
    Server::start().get(&format!("/v1/failures/{name}")).await.expect(200).json()
}

/// The result of a method of a case. A part of the method's name finds it.
#[track_caller]
pub(crate) fn says<'a>(case: &'a Value, method: &str) -> &'a Value {
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
            assert_eq!(said["right"] == true, said["text"] == case["truth"]["text"], "{said}");
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
    assert_eq!(Value::from(names), crate::support::contract::DOCUMENT["components"]["schemas"]["FailureName"]["enum"]);
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

/// Tilt gain, minus κ_c, at which the mirror-symmetric orbit of period 2 has a given angle. It solves the condition of such an orbit,
/// Gρ²θ cos κθ = V²l sin((κ − 1)θ), at fixed energy or η, without the coefficient C.
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
        assert_eq!(case["truth"]["text"], truth);
        let bend = branch_offset(&case, 0.01) / 1e-4;
        assert_eq!(bend > 0.0, truth == "bounded", "{name}: {bend}");
        let scene = &case["scene"];
        let width = number(&scene["table"]["tilt_gain"]) - 1.0;
        let coefficient = case["says"].as_array().unwrap().iter().rev().nth(1).unwrap();
        assert!((bend / width - number(&coefficient["value"])).abs() < 0.01, "{name}: {bend} {coefficient}");
        // The eigenvalue test is silent, and one bit of κ makes it wrong by far more than rounding.
        let radius = number(&case["says"][0]["value"]);
        assert!((radius - 1.0).abs() < 1e-7 && case["says"][0]["text"] != "stable", "{radius}");
        let ask = case["ask"].as_str().unwrap().split("bounces=").next().unwrap().to_owned() + "bounces=100000";
        let run = &server.get(&ask).await.expect(200).json()["nonlinear"];
        assert_eq!(run["outcome"]["kind"] == "completed", truth == "bounded", "{name}: {run}");
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
    let ask = case["ask"].as_str().unwrap().replace("bounces=20000", "bounces=100000");
    let run = &server.get(&ask).await.expect(200).json()["nonlinear"];
    assert_eq!((&run["outcome"]["kind"], &run["outcome"]["bounces"]), (&"completed".into(), &100_000.into()));
    // The run swings from near upright to √2 times the orbit of period 2, by the amplitude equation.
    let (mut low, mut high) = (0.01, 0.3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if branch_offset(&case, middle) < 0.01 { low = middle } else { high = middle }
    }
    let swing = number(&run["max_theta"]) / low;
    assert!((swing / 2.0_f64.sqrt() - 1.0).abs() < 0.05, "{low} {run}");
}

/// The request of a case with some parameters replaced.
fn otherwise(case: &Value, resource: &str, changes: &[(&str, f64)]) -> String {
    let (path, query) = case["ask"].as_str().unwrap().split_once('?').unwrap();
    assert!(path.starts_with("/v1/"));
    let kept = query.split('&').filter(|part| {
        let name = part.split('=').next().unwrap();
        name.starts_with("scene.") && changes.iter().all(|(changed, _)| *changed != name)
    });
    let changed = changes.iter().map(|(name, value)| format!("{name}={value}"));
    let query: Vec<String> = kept.map(str::to_owned).chain(changed).collect();
    format!("/v1/{resource}?{}", query.join("&"))
}

/// Ending of a case's run with some parameters replaced: its name and its contact.
async fn end(server: &Server, case: &Value, changes: &[(&str, f64)]) -> (String, u64) {
    let run =
        server.get(&otherwise(case, "stability", changes)).await.expect(200).json()["nonlinear"]["outcome"].clone();
    (run["kind"].as_str().unwrap().to_owned(), run["bounces"].as_u64().unwrap())
}

#[tokio::test]
async fn at_kappa_one_no_strike_turns_the_rod() {
    let server = Server::start();
    let case = case("parallel-drift").await;
    let run = server.get(case["ask"].as_str().unwrap()).await.expect(200).json();
    let (t, theta) = (run["impacts"]["t"].as_array().unwrap(), run["impacts"]["theta"].as_array().unwrap());
    for (t, theta) in t.iter().zip(theta) {
        assert!((number(theta) - 0.01 * number(t)).abs() < 1e-15, "{t} {theta}");
    }
    assert_eq!(run["outcome"]["kind"], "separating");
    assert!(number(theta.last().unwrap()) > 20.0 * number(&theta[0]), "{run}");
}

#[tokio::test]
async fn at_order_three_the_time_to_fall_is_inverse_to_the_start() {
    let server = Server::start();
    let case = case("order-three").await;
    let mut scaled = Vec::new();
    for theta in [0.002, 0.001, 0.0005, 0.00025] {
        let (outcome, impacts) = end(&server, &case, &[("scene.release.theta", theta), ("bounces", 20_000.0)]).await;
        assert_ne!(outcome, "completed", "{theta}");
        scaled.push(theta * impacts as f64);
    }
    // At a rotation of ⅓ turn the map is quadratic: dr/dn = c r², so n θ₀ is constant.
    assert!(scaled.iter().all(|value| (value / scaled[3] - 1.0).abs() < 0.05), "{scaled:?}");
    let calm = [("scene.release.theta", 0.2), ("scene.release.x_dot", 0.0), ("bounces", 100_000.0)];
    assert_eq!(end(&server, &case, &calm).await.0, "completed");
    // The drift does not change the eigenvalues: ⅓ turn.
    let speed = (2.0 * 9.81 * (0.2_f64 - 0.4 / 3.0)).sqrt();
    let at =
        [("at.state.theta", 0.0), ("at.state.x_dot", 0.4), ("at.state.y_dot", -speed), ("at.state.theta_dot", 0.0)];
    let jacobian = server.get(&otherwise(&case, "jacobians", &at)).await.expect(200).json();
    let third = jacobian["eigenvalues"].as_array().unwrap().iter().filter(|it| (number(&it["re"]) + 0.5).abs() < 1e-12);
    assert_eq!(third.count(), 2, "{jacobian}");
}

#[tokio::test]
async fn a_wide_start_is_outside_of_the_basin() {
    let server = Server::start();
    let case = case("wide-start").await;
    let basin = &server.get(case["ask"].as_str().unwrap()).await.expect(200).json()["basin"];
    assert!((0.15..0.3).contains(&number(&basin["theta"])), "{basin}");
    let narrow = [("scene.release.theta", 0.1), ("bounces", 100_000.0)];
    assert_eq!(end(&server, &case, &narrow).await, ("completed".to_owned(), 100_000));
    assert_eq!(end(&server, &case, &[("bounces", 10.0)]).await, ("sinking".to_owned(), 4));
}

#[tokio::test]
async fn beyond_the_horizon_runs_part_and_their_distribution_stays() {
    let server = Server::start();
    let case = case("chaos").await;
    let horizon = number(&says(&case, "Jacobian product")["value"]) as usize;
    let angles = async |theta: f64| {
        let target = otherwise(&case, "trajectories", &[("scene.release.theta", theta), ("bounces", 3000.0)]);
        let run = server.get(&target).await.expect(200).json();
        run["impacts"]["theta"].as_array().unwrap().iter().map(number).collect::<Vec<f64>>()
    };
    let one = angles(0.032).await;
    let mut ends = Vec::new();
    for k in 1..=40 {
        // Other starts than those of the case, on the other side.
        let other = angles(0.032 - f64::from(k) * 1e-15).await;
        let apart = one.iter().zip(&other).map(|(a, b)| (a - b).abs());
        let (before, after) = (horizon / 2, horizon * 5 / 4);
        let early = apart.clone().take(before).fold(0.0, f64::max);
        assert!(early < 1e-3, "{k}: {early} before contact {before}");
        if k % 10 == 0 {
            let late = apart.take(after).fold(0.0, f64::max);
            assert!(late > 1e-2, "{k}: {late} by contact {after}");
        }
        ends.push(other.len());
    }
    ends.sort_unstable();
    assert!(ends[0] >= horizon && ends[4] < 350 && ends[35] > 1000, "{ends:?}");
    let median = number(&says(&case, "ensemble")["value"]);
    // The chance that fewer than 11 or more than 29 of 40 runs fall below the true median is 0.4 %.
    let below = ends.iter().filter(|end| (**end as f64) < median).count();
    assert!((11..=29).contains(&below), "{median} {ends:?}");
}

fn oracle() -> Value {
    serde_json::from_str(include_str!("../oracle/failures.json")).unwrap()
}

fn digits(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

#[tokio::test]
async fn the_derivative_of_the_formulas_meets_that_of_sixty_digits_and_no_difference_does() {
    let server = Server::start();
    let case = case("finite-differences").await;
    let rows = |matrix: &Value| -> Vec<f64> {
        matrix.as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap()).map(number).collect()
    };
    let truth = rows(&oracle()["derivative"]);
    let exact = rows(&server.get(case["ask"].as_str().unwrap()).await.expect(200).json()["matrix"]);
    let largest = truth.iter().map(|entry| entry.abs()).fold(0.0, f64::max);
    let error = exact.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    assert!(error < 2e-12, "{error}");
    assert!(number(&says(&case, "derivative of the formulas")["value"]) < 1e-11);
    for method in ["usual step", "long step", "short step", "best of all steps"] {
        let said = number(&says(&case, method)["value"]);
        assert!(said > 1e3 * error, "{method}: {said}");
    }
}

#[tokio::test]
async fn towards_the_graze_the_derivative_times_the_contact_speed_is_a_constant() {
    let server = Server::start();
    let case = case("grazing").await;
    let edge = digits(&oracle()["graze"]["height"]);
    let mut products = Vec::new();
    for below in [1e-6, 1e-8, 1e-10] {
        let height = [("scene.release.height", edge - below), ("at.impact", 1.0)];
        let jacobian = server.get(&otherwise(&case, "jacobians", &height)).await.expect(200).json();
        let entries = jacobian["matrix"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
        let largest = entries.map(|entry| number(entry).abs()).fold(0.0, f64::max);
        products.push(-number(&jacobian["contact_velocity"]) * largest);
    }
    assert!(products.iter().all(|product| (product / products[2] - 1.0).abs() < 0.05), "{products:?}");
    // The last digits of the height decide the next contact.
    let mut found = Vec::new();
    for beside in [-1e-12, 1e-12] {
        let changes = [("scene.release.height", edge + beside), ("bounces", 2.0)];
        let run = server.get(&otherwise(&case, "trajectories", &changes)).await.expect(200).json();
        found.push(number(&run["impacts"]["flight_time"][0]));
    }
    assert!((found[0] - digits(&oracle()["graze"]["flight_time"])).abs() < 1e-5 && found[1] > 0.12, "{found:?}");
}

#[tokio::test]
async fn every_flight_of_the_chatter_is_that_of_sixty_digits() {
    let server = Server::start();
    let case = case("trivial-root").await;
    let run = server.get(case["ask"].as_str().unwrap()).await.expect(200).json();
    let flights = run["impacts"]["flight_time"].as_array().unwrap();
    let truth = oracle()["chatter"].clone();
    for (flight, truth) in flights.iter().zip(truth.as_array().unwrap()) {
        assert!((number(flight) - digits(truth)).abs() < 1e-15, "{flight} {truth}");
    }
    let said = number(&says(&case, "divided out")["value"]);
    assert!((said / digits(&truth[8]) - 1.0).abs() < 1e-11, "{said}");
    assert_eq!(says(&case, "Newton")["value"], 0.0);
    assert_eq!(says(&case, "change of sign")["value"], Value::Null);
}

#[tokio::test]
async fn smaller_steps_come_to_what_the_map_says_of_invented_and_destroyed_stability() {
    let server = Server::start();
    let invented = case("invented-stability").await;
    // The true run ends long before rounding could matter.
    for beside in [-1e-9, 0.0, 1e-9] {
        let changes = [("scene.release.theta", 0.35 + beside), ("bounces", 400.0)];
        assert_eq!(end(&server, &invented, &changes).await, ("sinking".to_owned(), 23), "{beside}");
    }
    assert!(says(&invented, "1 ms")["detail"].as_str().unwrap().contains("at contact 23"), "{invented}");
    // The paper's first case, which the references of 30 digits follow for 100 contacts.
    let destroyed = case("destroyed-stability").await;
    assert_eq!(end(&server, &destroyed, &[("bounces", 100_000.0)]).await, ("completed".to_owned(), 100_000));
    let contacts = |said: &Value| {
        let detail = said["detail"].as_str().unwrap();
        detail.split("at contact ").nth(1).unwrap().split(';').next().unwrap().parse::<u32>().unwrap()
    };
    let (coarse, fine) = (contacts(says(&destroyed, "steps of 1 ms")), contacts(says(&destroyed, "steps of 0.1 ms")));
    assert!(coarse < fine && fine < 100, "smaller steps delay it: {coarse}, {fine}");
}

#[tokio::test]
async fn the_contact_that_is_missed_is_there() {
    let case = case("missed-contact").await;
    let found = number(&says(&case, "the map")["value"]);
    // Rigid flight after the first contact, from the state in the answer: the gap changes sign twice.
    let run = Server::start().get(case["ask"].as_str().unwrap()).await.expect(200).json();
    let first = |name: &str| number(&run["impacts"][name][0]);
    let (l, rho) = (0.4 / 3.0, 0.094_280_904_158_206_35_f64);
    let (theta, alpha) = (first("theta"), 1.1 * first("theta"));
    let arm = l * (theta - alpha).sin();
    let normal = alpha.cos() * first("y_dot") - alpha.sin() * first("x_dot") + arm * first("theta_dot");
    let impulse = -2.0 * normal / (1.0 + (arm / rho).powi(2));
    let (rise, turn) = (first("y_dot") + impulse * alpha.cos(), first("theta_dot") + impulse * arm / (rho * rho));
    let gap = |t: f64| rise * t - 0.5 * 9.81 * t * t + l * theta.cos() - l * (theta + turn * t).cos();
    let flight = found - first("t");
    assert!(gap(flight - 1e-5) > 1e-9 && gap(flight + 1e-5) < -1e-9, "{} {}", gap(flight - 1e-5), gap(flight + 1e-5));
    assert!((1..1000).all(|n| gap(flight * f64::from(n) / 1000.0) > 0.0));
    let look = (flight / 1e-2).ceil() * 1e-2;
    assert!(gap(look) > 0.0, "open again at the next look");
    for method in ["adaptive", "every 10 ms"] {
        assert!(number(&says(&case, method)["value"]) > found + 0.05);
    }
}

#[tokio::test]
async fn the_bounces_end_where_their_geometric_series_does() {
    let case = case("zeno").await;
    let limit = 3.0 * (2.0 * (0.2_f64 - 0.4 / 3.0) / 9.81).sqrt();
    assert!((number(&says(&case, "the map")["value"]) - limit).abs() < 1e-15);
    for method in ["Runge-Kutta, steps", "Moreau", "event location"] {
        assert!(number(&says(&case, method)["value"]) > limit, "{method} has gone past the end");
    }
}
