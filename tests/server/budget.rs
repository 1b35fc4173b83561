//! The budget of the errors of a rig: its limits are those that verdicts on both sides of them confirm.

use crate::failures::number;
use crate::margins::margin;
use crate::support::Server;
use serde_json::{Value, json};

async fn ask(query: &str) -> Value {
    Server::start().get(&format!("/v1/stability?{query}")).await.expect(200).json()
}

/// The limit of an error of a budget.
fn limit<'a>(budget: &'a Value, path: &str, side: &str) -> &'a Value {
    let errors = budget["errors"].as_array().unwrap();
    &errors.iter().find(|error| error["field"] == path).unwrap_or_else(|| panic!("{path}: {budget}"))[side]
}

#[tokio::test]
async fn verdicts_and_runs_on_both_sides_of_each_limit_are_as_it_says() {
    let scene = "preset=case-1&scene.release.theta=0.05&scene.table.length=1&bounces=60";
    let answer = ask(&format!("{scene}&budget=true")).await;
    let budget = &answer["budget"];
    assert_eq!((&budget["verdict"]["code"], &budget["bounces"]), (&json!("elliptic"), &json!(60)));
    let mut compared = 0;
    for error in budget["errors"].as_array().unwrap() {
        let path = error["field"].as_str().unwrap();
        for (side, sign) in [("below", -1.0), ("above", 1.0)] {
            let limit = &error[side];
            let has_sign = !path.starts_with("noise.") && !["table.delay", "contact.friction"].contains(&path);
            // The table of case 1 cannot assume more than the true restitution, 1.
            let has_side = (has_sign || side == "above") && (path != "table.assumed_restitution" || side == "below");
            let is_without_effect = path.starts_with("table.pivot.");
            assert_eq!(error["reason"].is_null(), !is_without_effect, "{error}");
            assert_eq!(limit.is_null(), is_without_effect || !has_side, "{path}");
            if limit.is_null() || limit["decided_by"] == "range" {
                continue;
            }
            let (value, accuracy) = (number(&limit["value"]), number(&limit["accuracy"]));
            let from = number(&error["reference"]);
            let at = async |value: f64| ask(&format!("{scene}&scene.{path}={}", from + sign * value)).await;
            let (inside, outside) = (at(value).await, at(value + accuracy).await);
            assert_eq!(inside["nonlinear"]["outcome"]["kind"], "completed", "{path} {side}");
            if limit["decided_by"] == "nonlinear" {
                assert_eq!(outside["nonlinear"]["outcome"]["kind"], limit["outcome"]["kind"], "{path} {side}");
            } else {
                assert_eq!((&limit["decided_by"], &limit["outcome"]), (&json!("linear"), &Value::Null), "{path}");
                assert_eq!(limit["small"], limit["value"]);
                assert_eq!(inside["linear"]["kind"], "elliptic");
                assert_ne!(outside["linear"]["kind"], "elliptic", "{path} {side} {limit}");
            }
            compared += 1;
        }
    }
    assert!(compared >= 10, "{budget}");
    assert_eq!(limit(budget, "table.errors.angle_bias", "above")["outcome"]["kind"], "off_table");
    // All at once.
    let together = &budget["together"];
    let factor = number(&together["factor"]["value"]);
    let reference = |path: &Value| {
        let errors = budget["errors"].as_array().unwrap();
        number(&errors.iter().find(|error| error["field"] == *path).unwrap()["reference"])
    };
    let all = |factor: f64| {
        let sizes = together["sizes"].as_array().unwrap().iter();
        sizes.fold(scene.to_owned(), |query, size| {
            let value = reference(&size["field"]) + number(&size["value"]) * factor;
            format!("{query}&scene.{}={value}", size["field"].as_str().unwrap())
        })
    };
    assert!(factor > 0.0 && factor < 1.0, "{together}");
    assert_eq!(ask(&all(factor)).await["nonlinear"]["outcome"]["kind"], "completed");
    let beyond = factor + number(&together["factor"]["accuracy"]);
    assert_ne!(ask(&all(beyond)).await["nonlinear"]["outcome"]["kind"], "completed");
}

#[tokio::test]
async fn the_gain_of_the_tilt_may_err_up_to_its_margins() {
    let answer = ask("preset=case-1&scene.release.theta=0&bounces=50&budget=true").await;
    let gain = margin(&answer, "table.tilt_gain");
    for side in ["below", "above"] {
        let limit = limit(&answer["budget"], "table.errors.tilt_gain", side);
        assert!(
            (number(&limit["value"]) - number(&gain[side]["margin"]) / number(&gain["value"])).abs() < 1e-8,
            "{limit}"
        );
    }
    assert!(answer["budget"]["reason"].as_str().unwrap().contains("table.length"), "a table without ends");
}

#[tokio::test]
async fn a_delay_may_be_as_long_as_state_feedback_has_margin_for() {
    let scene = "preset=rough-feedback&bounces=100";
    let budget = ask(&format!("{scene}&budget=true")).await["budget"].clone();
    let delay = limit(&budget, "table.delay", "above");
    assert_eq!(delay["decided_by"], "linear", "{delay}");
    let value = number(&delay["value"]);
    let at = async |delay: f64| ask(&format!("{scene}&scene.table.delay={delay}")).await;
    assert_eq!(at(value * 0.999).await["verdict"]["code"], budget["verdict"]["code"]);
    let beyond = at(value * 1.001).await;
    assert_eq!(beyond["linear"]["kind"], "hyperbolic", "{beyond}");
    assert_eq!(
        beyond["verdict"]["code"], "bounded_beyond_boundary",
        "it is lost softly: {}",
        beyond["verdict"]["reason"]
    );
    // A tilt gain has none to spend.
    let answer = ask("preset=case-1&scene.table.delay=0.002&bounces=100&budget=true").await;
    assert_eq!(limit(&answer["budget"], "table.delay", "above")["value"], 0.0);
    assert_eq!(answer["budget"]["verdict"]["code"], "elliptic");
    assert_eq!(answer["budget"]["present"]["factor"]["value"], 0.0);
    let sizes = answer["budget"]["together"]["sizes"].to_string();
    assert!(sizes.contains("angle_bias") && !sizes.contains("delay"), "{sizes}");
}

#[tokio::test]
async fn a_pivot_has_limits_where_the_table_turns_as_it_strikes() {
    let scene = "preset=case-1&scene.table.tilt_rate=follows&bounces=200";
    let budget = ask(&format!("{scene}&budget=true")).await["budget"].clone();
    for side in ["below", "above"] {
        assert_eq!(limit(&budget, "table.pivot.x", side)["value"], 0.0, "{budget}");
        assert_eq!(limit(&budget, "table.pivot.depth", side)["decided_by"], "range", "{budget}");
    }
    assert_eq!(ask(&format!("{scene}&scene.table.pivot.x=0.00001")).await["verdict"]["code"], "unstable");
}

#[tokio::test]
async fn a_delay_without_a_limit_is_not_put_together_with_the_others() {
    let budget = ask("preset=air-table&bounces=60&scene.table.prediction=none&budget=true").await["budget"].clone();
    let errors = budget["errors"].as_array().unwrap();
    let of = |path: &str| errors.iter().find(|error| error["field"] == path).unwrap();
    let together = budget["together"]["sizes"].to_string();
    for (path, is_in) in [("air.drag", true), ("table.errors.tilt_gain", true), ("table.delay", false)] {
        assert_eq!(together.contains(&format!("\"{path}\"")), is_in, "{path}: {together}");
    }
    assert_eq!(of("table.delay")["above"]["value"], 0.0, "without air the gain circles");
}

#[tokio::test]
async fn presets_have_a_budget_within_the_limit_of_work() {
    for preset in ["case-1", "triangle-polygon", "air-table", "rough-feedback", "rough-noise"] {
        let budget = ask(&format!("preset={preset}&budget=true")).await["budget"].clone();
        assert_eq!(budget["bounces"], 2000, "{preset}");
        assert!(budget["errors"].as_array().is_some_and(|errors| errors.len() >= 15), "{preset}: {budget}");
    }
}

#[tokio::test]
async fn a_wrong_request_for_a_budget_names_the_field() {
    for (query, pointer) in [
        ("preset=case-1&budget=perhaps", "/budget"),
        ("preset=case-1&budget=true&scene.table.delay=-0.001", "/scene/table/delay"),
        ("preset=case-1&budget=true&scene.table.pivot.depth=11", "/scene/table/pivot/depth"),
        ("preset=case-1&budget=true&scene.table.tilt_rate=fast", "/scene/table/tilt_rate"),
        ("preset=point-mass&budget=true&scene.noise.theta_dot_sd=0.001", "/scene/noise/theta_dot_sd"),
    ] {
        let refused = Server::start().get(&format!("/v1/stability?{query}")).await.expect(422).json();
        assert_eq!(refused["errors"][0]["pointer"], pointer, "{refused}");
    }
}

#[tokio::test]
async fn the_errors_of_the_scene_have_a_factor_and_the_budget_is_absent_unless_asked_for() {
    let ideal = "preset=case-1&scene.release.theta=0.05&scene.table.length=1&bounces=60";
    let scene = format!("{ideal}&scene.table.errors.angle_bias=0.002");
    let present = ask(&format!("{scene}&budget=true")).await["budget"]["present"].clone();
    assert_eq!(present["sizes"], json!([{"field": "table.errors.angle_bias", "unit": "rad", "value": 0.002}]));
    assert!(number(&present["factor"]["value"]) < 1.0, "this rig leaves its table: {present}");
    let ideal = ask(&format!("{ideal}&budget=true")).await;
    let alone = limit(&ideal["budget"], "table.errors.angle_bias", "above");
    let factor = number(&present["factor"]["value"]);
    assert!((factor * 0.002 - number(&alone["value"])).abs() <= 2.0 * number(&alone["accuracy"]), "{present} {alone}");
    assert!(ideal["budget"]["present"].is_null());
    assert!(ask(&scene).await.get("budget").is_none());
}

#[tokio::test]
async fn what_falls_without_errors_has_no_budget_and_a_dear_one_is_refused() {
    let lost = ask("preset=case-1&scene.table.tilt_gain=1.6&bounces=200&budget=true").await["budget"].clone();
    assert!(lost["errors"].is_null() && lost["together"].is_null(), "{lost}");
    assert!(lost["reason"].as_str().unwrap().contains("without errors"), "{lost}");
    let refused = Server::start().get("/v1/stability?preset=case-1&bounces=100000&budget=true").await.expect(422);
    assert!(refused.text().contains("work of this request"), "{}", refused.text());
}

#[tokio::test]
async fn margins_of_the_gain_are_of_small_deviations_and_of_the_release() {
    let scene = "preset=case-1&bounces=200";
    let answer = ask(&format!("{scene}&release_margins=true")).await;
    let small = margin(&answer, "table.tilt_gain");
    let release = answer["margins"].as_array().unwrap().iter().find(|margin| margin["of"] == "release").unwrap();
    assert_eq!((&release["field"], &release["value"]), (&json!("table.tilt_gain"), &json!(1.1)));
    for side in ["below", "above"] {
        assert!(number(&small[side]["accuracy"]) < 1e-9 && small[side]["detail"].is_string(), "{small}");
        let (value, accuracy) = (number(&release[side]["limit"]), number(&release[side]["accuracy"]));
        let sign = if side == "below" { -1.0 } else { 1.0 };
        let outcome = async |gain: f64| {
            ask(&format!("{scene}&scene.table.tilt_gain={gain}")).await["nonlinear"]["outcome"]["kind"].clone()
        };
        assert_eq!(outcome(value).await, answer["nonlinear"]["outcome"]["kind"], "{side}");
        assert_eq!(outcome(value + sign * accuracy).await, release[side]["outcome"]["kind"], "{side}");
    }
    // A factor on the gains of a state feedback, which air moves off its closed form.
    let answer = ask("preset=rough-feedback&bounces=100&scene.air.rotation_drag=0.1&release_margins=true").await;
    let small = margin(&answer, "table.feedback");
    assert_eq!(small["value"], json!(1.0));
    assert!(number(&small["below"]["limit"]) < 1.0 && number(&small["above"]["limit"]) > 1.0, "{small}");
    let plain = ask("preset=case-1").await;
    assert!(plain["margins"].as_array().unwrap().iter().all(|margin| margin["of"] == "small"), "{plain}");
}
