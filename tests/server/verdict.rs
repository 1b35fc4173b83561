//! The verdict beyond eigenvalues: rotation number, resonances, chaos, predictable impacts and the basin; and its code.

use equipoise::api::computed::stability::verdict::CODES;
use serde_json::{Value, json};

use crate::support::contract::DOCUMENT;
use crate::support::{Server, number, number_at};

async fn verdict(query: &str) -> Value {
    Server::start().get(&format!("/v1/stability?preset=case-1&{query}")).await.expect(200).json()
}

fn says(answer: &Value, words: &str) -> bool {
    answer["notes"].as_array().unwrap().iter().any(|note| note.as_str().unwrap().contains(words))
}

#[tokio::test]
async fn a_regular_run_turns_steadily() {
    let answer = verdict("scene.release.theta=0.001").await;
    let linear = number_at(&answer, "/linear/rotation") / std::f64::consts::TAU;
    assert_eq!(number_at(&answer, "/rotation_number/small"), linear);
    assert!((number_at(&answer, "/rotation_number/measured") - linear).abs() < 1e-6);
    let (p, q) =
        (number_at(&answer, "/rotation_number/resonance/p"), number_at(&answer, "/rotation_number/resonance/q"));
    let distance = number_at(&answer, "/rotation_number/resonance/distance");
    assert!((distance - (number_at(&answer, "/rotation_number/measured") - p / q).abs()).abs() < 1e-12 && q <= 8.0);
    assert_eq!(answer["chaos"]["chaotic"], false);
    assert_eq!(answer["chaos"]["bounces"], 500);
    assert!(answer["predictable_bounces"].is_null() && says(&answer, "predictable_bounces is null"));
    assert!(answer["basin"].is_null());
}

#[tokio::test]
async fn an_elliptic_run_that_is_chaotic_is_said_to_be() {
    let answer = verdict("scene.table.tilt_gain=1.1&scene.release.theta=0.34&bounces=500").await;
    assert_eq!(answer["verdict"]["text"], "elliptic, 500 bounces survived");
    assert_eq!(answer["chaos"]["chaotic"], true);
    assert!(answer["verdict"]["reason"].as_str().unwrap().contains("chaotic"), "{}", answer["verdict"]["reason"]);
}

#[tokio::test]
async fn a_chaotic_release_beside_a_strong_resonance_is_followed_until_it_leaves() {
    let answer = verdict("scene.table.tilt_gain=1.265755&scene.release.theta=0.15376&bounces=500").await;
    assert_eq!(answer["chaos"]["chaotic"], true);
    let horizon = number_at(&answer, "/predictable_bounces");
    assert!(horizon > 250.0 && horizon < 400.0, "{horizon}");
    // The run of the request survives; the release does not.
    assert_eq!(
        (&answer["verdict"]["text"], &answer["nonlinear"]["outcome"]["kind"]),
        (&"unstable".into(), &"completed".into())
    );
    assert!(answer["verdict"]["reason"].as_str().unwrap().contains("order 4"), "{}", answer["verdict"]["reason"]);
    let later = verdict("scene.table.tilt_gain=1.265755&scene.release.theta=0.15376&bounces=3000").await;
    assert_eq!(later["verdict"]["text"], "unstable");
    assert_eq!(later["nonlinear"]["outcome"]["kind"], "separating");
}

#[tokio::test]
async fn resonances_of_order_3_and_4_are_named_where_they_are() {
    for (tilt_gain, third, fourth) in [(1.1, false, false), (1.25, false, true), (1.375, true, false)] {
        let answer = verdict(&format!("scene.table.tilt_gain={tilt_gain}&scene.release.theta=0.01")).await;
        assert_eq!(
            (says(&answer, "resonance 1/3"), says(&answer, "resonance 1/4")),
            (third, fourth),
            "κ = {tilt_gain}"
        );
        let order = third.then_some(3).or(fourth.then_some(4));
        assert_eq!(answer["rotation_number"]["strong_resonance"]["q"].as_u64(), order, "κ = {tilt_gain}");
    }
}

#[tokio::test]
async fn beyond_the_boundary_the_period_two_orbit_is_named() {
    let answer = verdict("scene.table.tilt_gain=1.505&scene.release.theta=0.01").await;
    assert_eq!(answer["verdict"]["text"], "bounded beyond the boundary, 2000 bounces survived");
    assert!(
        answer["verdict"]["reason"].as_str().unwrap().contains("period-2 orbit at θ = ±0.1"),
        "{}",
        answer["verdict"]["reason"]
    );
    assert!(answer["rotation_number"].is_null() && says(&answer, "rotation_number is null"));
}

#[tokio::test]
async fn the_basin_is_looked_for_when_asked() {
    let dent = verdict("basin=true&bounces=1000&scene.table.tilt_gain=1.266").await;
    let far = verdict("basin=true&bounces=1000").await;
    assert!(number_at(&dent, "/basin/unbroken") < 0.2 && number_at(&far, "/basin/unbroken") > 0.3);
    let (theta, unbroken) = (number_at(&far, "/basin/theta"), number_at(&far, "/basin/unbroken"));
    assert_eq!(theta == unbroken, far["basin"]["holes"].as_array().unwrap().is_empty());
    let server = Server::start();
    for preset in ["point-mass", "still-lossy"] {
        let answer = server.get(&format!("/v1/stability?preset={preset}&basin=true")).await.expect(200).json();
        let why = answer["no_basin"].as_str().unwrap();
        assert!(answer["basin"].is_null() && says(&answer, &format!("basin is null: {why}")), "{preset}");
    }
    server.get("/v1/stability?preset=case-1&basin=maybe").await.expect(422);
}

#[tokio::test]
async fn all_bounces_of_a_verdict_are_counted() {
    let server = Server::start();
    let bounces = async || {
        let text = server.get("/metrics").await.expect(200).text().to_owned();
        let line = text.lines().find(|line| line.starts_with("equipoise_bounces_total ")).unwrap();
        line.rsplit(' ').next().unwrap().parse::<u64>().unwrap()
    };
    server.get("/v1/stability?preset=case-1&bounces=600").await.expect(200);
    let watch = 5 * 500;
    assert_eq!(bounces().await, 600 + watch);
    // The basin: most angles of its fine scan survive.
    server.get("/v1/stability?preset=case-1&bounces=600&basin=true").await.expect(200);
    let basin = bounces().await - 2 * (600 + watch);
    assert!((128 * 600..=448 * 600).contains(&basin), "{basin}");
}

#[tokio::test]
async fn what_cannot_be_said_is_null_with_its_reason() {
    // An upright run, one that is too short, and one with errors at random.
    for query in
        ["preset=case-1&scene.release.theta=0", "preset=case-1&bounces=100", "preset=case-1&scene.noise.timing_sd=1e-4"]
    {
        let answer = Server::start().get(&format!("/v1/stability?{query}")).await.expect(200).json();
        assert!(answer["chaos"].is_null(), "{query}");
        assert!(says(&answer, "chaos is null") || says(&answer, "chaos and predictable_bounces are null"), "{query}");
    }
}

/// The answer of another preset.
async fn of(preset: &str, query: &str) -> Value {
    Server::start().get(&format!("/v1/stability?preset={preset}&{query}")).await.expect(200).json()
}

#[tokio::test]
async fn energy_feedback_is_weakly_unstable_or_weakly_attracting() {
    // The drift of case 5 lowers ℓ.
    for (preset, growth) in [("case-4", 0.0221), ("case-5", 0.02115)] {
        let answer = of(preset, "").await;
        assert_eq!(answer["verdict"]["text"], "weakly unstable, 2000 bounces survived", "{preset}");
        assert_eq!(answer["verdict"]["decided_by"], "lyapunov");
        assert_eq!(answer["linear"]["kind"], "elliptic");
        assert_eq!(answer["lyapunov"]["kind"], "repelling");
        assert!((number_at(&answer, "/lyapunov/coefficient") - growth).abs() < 2e-4);
    }
    let upright = of("case-4", "scene.release.theta=1e-20").await;
    assert_eq!(
        (&upright["lyapunov"]["kind"], &upright["lyapunov"]["escape_bounces"]),
        (&"repelling".into(), &Value::Null)
    );
    let reason = upright["verdict"]["reason"].as_str().unwrap();
    assert!(reason.contains("this release has none"), "{reason}");
    let answer = of("case-5", "scene.table.tilt_gain=1.2").await;
    assert_eq!(answer["verdict"]["text"], "weakly attracting, 2000 bounces survived");
    assert_eq!(
        (&answer["lyapunov"]["kind"], &answer["lyapunov"]["escape_bounces"]),
        (&"attracting".into(), &Value::Null)
    );
}

#[tokio::test]
async fn a_feedback_without_x_and_x_dot_leaves_the_drift() {
    let steered = "scene.release.x_dot=0.5&scene.release.theta=0.05&scene.table.energy_gain=0.45&scene.table.target_height=0.2\
                   &scene.table.energy_measure=total";
    let tilted = verdict(steered).await;
    let law = "scene.table.tilt_gain=null&scene.table.feedback.theta=-1.1";
    let fed_back = verdict(&format!("{steered}&{law}&basin=true")).await;
    assert_eq!(fed_back["verdict"]["text"], tilted["verdict"]["text"]);
    for part in ["fixed_point", "linear", "drift_speed", "lyapunov", "rotation_number"] {
        assert_eq!(fed_back[part], tilted[part], "{part}");
    }
    assert!(fed_back["notes"].to_string().contains("which is a tilt_gain of 1.1"), "{fed_back}");
    assert!(number_at(&fed_back, "/basin/theta") > 0.1);
    let damped = verdict(&format!("{steered}&{law}&scene.table.feedback.theta_dot=-0.02")).await;
    assert_eq!((&damped["verdict"]["text"], &damped["agree"]), (&"stable, drifting".into(), &true.into()), "{damped}");
    assert!(number_at(&damped, "/fixed_point/x_dot") == number_at(&damped, "/drift_speed"));
    // The drift is kept.
    let kept = |value: &&Value| (number_at(value, "/modulus") - 1.0).abs() < 1e-9;
    assert_eq!(damped["linear"]["eigenvalues"].as_array().unwrap().iter().filter(kept).count(), 1);
}

#[tokio::test]
async fn a_run_that_leaves_in_the_end_is_not_called_outside_the_basin() {
    for (theta, fall) in [(0.04, 1332), (0.02, 5354), (0.01, 21453)] {
        let query = format!("scene.table.energy_gain=0.45&scene.table.target_height=0.2&scene.release.theta={theta}");
        let short = verdict(&query).await;
        let long = verdict(&format!("{query}&bounces=30000")).await;
        assert_eq!(short["verdict"]["code"], if fall > 2000 { "weakly_unstable" } else { "unstable" });
        assert_eq!(
            (&long["verdict"]["text"], &long["nonlinear"]["outcome"]["bounces"]),
            (&json!("unstable"), &json!(fall))
        );
        assert!((number_at(&short, "/lyapunov/escape_bounces") / f64::from(fall) - 1.0).abs() < 0.02);
        for answer in [short, long] {
            assert_eq!(answer["verdict"]["decided_by"], "lyapunov");
            assert!(
                !answer["verdict"]["reason"].as_str().unwrap().contains("basin"),
                "{}",
                answer["verdict"]["reason"]
            );
        }
    }
}

#[tokio::test]
async fn lyapunov_is_null_with_a_note_where_it_does_not_apply() {
    for (preset, query) in [("case-1", ""), ("case-3", ""), ("point-mass", ""), ("still-lossy", "")] {
        let answer = of(preset, query).await;
        assert!(answer["lyapunov"].is_null() && says(&answer, "lyapunov"), "{preset}: {}", answer["notes"]);
    }
}

#[tokio::test]
async fn a_soft_loss_of_stability_is_told_from_a_hard_one() {
    // Beyond the upper end of κ_E the height flips softly.
    let query = "scene.table.target_height=0.2&scene.release.height=0.21&scene.release.theta=0.01";
    let within = verdict(&format!("{query}&scene.table.energy_gain=0.1")).await;
    let upper = number_at(&margin(&within, "table.energy_gain"), "/above/limit");
    let farther = format!("{query}&scene.table.energy_gain={}", 1.03 * upper);
    let left = verdict(&farther).await;
    let small = left["verdict"]["reason"].as_str().unwrap().contains("a run from this release left");
    assert!(
        left["verdict"]["code"] == "unstable" && small,
        "wide swings beside two heights: {}",
        left["verdict"]["reason"]
    );
    let beyond = verdict(&farther.replace("theta=0.01", "theta=0.001")).await;
    assert_eq!(
        beyond["verdict"]["text"], "bounded beyond the boundary, 2000 bounces survived",
        "{}",
        beyond["verdict"]["reason"]
    );
    assert_eq!(beyond["verdict"]["decided_by"], "boundary");
    let end = |answer: &Value, field: &str| {
        let ends = answer["loss_of_stability"].as_array().unwrap().clone();
        ends.into_iter().find(|end| end["field"] == field).unwrap_or_else(|| panic!("{field}: {answer}"))
    };
    let heights = &end(&beyond, "table.energy_gain")["heights"];
    assert!(heights[0].as_f64().unwrap() < 0.2 && heights[1].as_f64().unwrap() > 0.2, "{heights}");
    assert!(end(&within, "table.energy_gain")["heights"].is_null());
    // At the gain margin of the controller stability is lost softly, to a swing.
    let law = Server::start().get("/v1/controllers?preset=case-1").await.expect(200).json();
    let upper = number_at(&law, "/margins/0/above/limit");
    let gains = ["x", "theta", "x_dot", "theta_dot"]
        .map(|name| {
            format!(
                "scene.table.feedback.{name}={}",
                1.001 * upper * number_at(&law, &format!("/scene/table/feedback/{name}"))
            )
        })
        .join("&");
    let answer = verdict(&format!("{gains}&scene.table.tilt_gain=null&scene.release.theta=0.05&bounces=20000")).await;
    assert_eq!(
        answer["verdict"]["text"], "bounded beyond the boundary, 20000 bounces survived",
        "{}",
        answer["verdict"]["reason"]
    );
    let end = end(&answer, "table.feedback");
    assert_eq!((&end["kind"], &end["bifurcation"]), (&"soft".into(), &"period_doubling".into()));
    assert!((end["swing"].as_f64().unwrap() - 0.125).abs() < 0.01, "{end}");
    assert!((number_at(&answer, "/nonlinear/max_theta") - 0.125).abs() < 0.02);
}

#[tokio::test]
async fn the_code_of_a_verdict_stands_for_its_words() {
    assert_eq!(DOCUMENT["components"]["schemas"]["VerdictCode"]["enum"], json!(CODES));
    let server = Server::start();
    let mut seen = std::collections::BTreeSet::new();
    for query in [
        "preset=case-1",
        "preset=case-1&scene.table.tilt_gain=1.6",
        "preset=case-1&scene.table.tilt_gain=1.505&scene.release.theta=0.01",
        "preset=case-1-noise",
        "preset=case-4",
        "preset=point-mass",
        "preset=still-lossy",
        "preset=critical-hard",
    ] {
        let answer = server.get(&format!("/v1/stability?{query}&bounces=500")).await.expect(200).json();
        let words = answer["verdict"]["text"].as_str().unwrap();
        // The part before the length of the run; "stable, drifting" has no length.
        let name = if words.starts_with("stable") { words } else { words.split(',').next().unwrap() };
        let code = name.replace(',', "").replace(" the ", " ").replace(' ', "_");
        assert_eq!(answer["verdict"]["code"], code, "{query}: {words}");
        seen.insert(code);
    }
    assert!(seen.len() >= 4, "{seen:?}");
}

// Margins have one shape in all resources.

/// The margins of a field for small deviations; null if it has none.
pub(crate) fn margin(answer: &Value, field: &str) -> Value {
    let all = answer["margins"].as_array().unwrap();
    all.iter().find(|margin| margin["field"] == field && margin["of"] == "small").cloned().unwrap_or_default()
}

/// The upper limit of the tilt gain.
pub(crate) fn critical(answer: &Value) -> Value {
    margin(answer, "table.tilt_gain")["above"]["limit"].clone()
}

/// The smallest of some margins.
fn smallest(margins: &Value) -> Option<f64> {
    let ends = margins.as_array().unwrap().iter().flat_map(|margin| [&margin["below"], &margin["above"]]);
    ends.filter(|end| end.is_object()).map(|end| end["margin"].as_f64().unwrap()).min_by(f64::total_cmp)
}

#[tokio::test]
async fn the_smallest_margin_is_found_in_the_same_way_everywhere() {
    let server = Server::start();
    let stability = server.get("/v1/stability?preset=case-1&bounces=50").await.expect(200).json();
    assert!((smallest(&stability["margins"]).unwrap() - 0.1).abs() < 1e-12, "{}", stability["margins"]);
    let law = server.get("/v1/controllers?preset=case-1").await.expect(200).json();
    let found = smallest(&law["margins"]).unwrap();
    assert!(found > 0.0 && found < 1.0, "{}", law["margins"]);
    // The law of the controller has the same margins as a scene.
    let fed = server.post("/v1/stability", &json!({"scene": law["scene"], "bounces": 50})).await.expect(200).json();
    let (one, other) = (&law["margins"][0], margin(&fed, "table.feedback"));
    for side in ["below", "above"] {
        let limit = |margin: &Value| margin[side]["limit"].as_f64();
        assert!((limit(one).unwrap_or(0.0) - limit(&other).unwrap_or(0.0)).abs() < 1e-6, "{one} {other}");
    }
    assert!(margin(&fed, "table.tilt_gain").is_null());
}

#[tokio::test]
async fn a_margin_is_the_distance_to_its_limit_and_negative_beyond() {
    let server = Server::start();
    for gain in [0.9, 1.1, 1.6] {
        let target = format!("/v1/stability?preset=case-1&bounces=10&scene.table.tilt_gain={gain}");
        let found = margin(&server.get(&target).await.expect(200).json(), "table.tilt_gain");
        for (side, sign) in [("below", 1.0), ("above", -1.0)] {
            let end = &found[side];
            assert_eq!(end["margin"].as_f64(), Some(sign * (gain - end["limit"].as_f64().unwrap())), "{gain}: {found}");
            assert!(end["least"].is_null(), "{found}");
        }
    }
}

#[tokio::test]
async fn an_old_name_is_refused_with_the_new_one() {
    let server = Server::start();
    let y = "y.field=release.theta&y.from=0&y.to=1&y.count=2";
    for (target, new) in [
        (
            format!("regions?preset=case-1&x.parameter=gravity&x.from=9&x.to=10&x.count=2&{y}"),
            "since 0.3 it is `field`",
        ),
        (
            "periodic-orbits?preset=case-1&sweep.parameter=gravity&sweep.from=9&sweep.to=10".to_owned(),
            "since 0.3 it is `field`",
        ),
        (
            "stability?preset=case-1&tolerances.0.parameter=gravity&tolerances.0.tolerance=1".to_owned(),
            "since 0.3 it is `field`",
        ),
        (
            "stability?preset=case-1&tolerances.restitution=0.01".to_owned(),
            "since 0.3 it is a list of {field, tolerance}",
        ),
        ("stability?preset=case-1&gain_margins=true".to_owned(), "since 0.3 it is `release_margins`"),
    ] {
        let refused = server.get(&format!("/v1/{target}")).await.expect(422);
        assert!(refused.text().contains(new), "{target}: {}", refused.text());
    }
}

// The budget of the errors of a rig: its limits are those that verdicts on both sides of them confirm.

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
