//! Catches: the known figures of each strategy, every format, and refusals that name the field.

use axum::http::Method;
use serde_json::{Value, json};

use crate::failures::{case, says};
use crate::support::contract::DOCUMENT;
use crate::support::tables::Table;
use crate::support::{Server, contract, number, number_at, numbers};

/// Case 1 released at 0.25 m and 0.1 rad: it meets the table at 1.517 m/s.
const FALL: &str = "preset=case-1&scene.release.height=0.25&scene.release.theta=0.1";

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// Asserts that a figure is the printed one, to half a unit of its last digit.
#[track_caller]
fn printed(value: f64, figure: f64, unit: f64) {
    assert!((value - figure).abs() <= 0.5 * unit * (1.0 + 1e-9), "{value}, not {figure}");
}

async fn caught(server: &Server, query: &str) -> Value {
    let answer = server.get(&format!("/v1/catches?{FALL}&{query}")).await.expect(200).json();
    assert_eq!(answer["outcome"]["kind"], "held", "{query}: {}", answer["outcome"]);
    answer
}

#[tokio::test]
async fn bounces_die_down_within_the_printed_figures() {
    let server = Server::start();
    let fast = caught(&server, "strategy=bounce_down&ratio=0.5").await;
    let speeds = numbers(&fast["strikes"]["table_velocity"]);
    assert_eq!(speeds.len(), 9);
    printed(number_at(&fast, "/contact_from"), 0.464, 1e-3);
    printed(speeds[0], -0.353, 1e-3);
    printed(*speeds.last().unwrap(), -0.009, 1e-3);
    printed(number_at(&fast, "/demand/tilt"), 0.122, 1e-3);
    printed(number_at(&fast, "/upright_within/theta_1mrad"), 4.0, 0.1);
    printed(number_at(&fast, "/upright_within/x_1mm"), 5.4, 0.1);
    let slow = caught(&server, "strategy=bounce_down&ratio=0.9&hold_speed=0.002").await;
    assert_eq!(numbers(&slow["strikes"]["n"]).len(), 63);
    printed(number_at(&slow, "/contact_from"), 2.94, 1e-2);
    printed(number_at(&slow, "/demand/tilt"), 0.112, 1e-3);
    assert!(largest(&numbers(&slow["strikes"]["table_velocity"])) < 0.0865, "{}", slow["strikes"]);
}

#[tokio::test]
async fn plans_arrive_at_rest_within_the_printed_figures() {
    let server = Server::start();
    for (strikes, ratio, time, speed, last, tilt) in
        [(5, 1.0, 1.705, 0.026, -0.759, 0.157), (8, 0.8, 1.190, 0.148, -0.127, 0.215)]
    {
        let plan = caught(&server, &format!("strategy=plan&ratio={ratio}&strikes={strikes}")).await;
        let speeds = numbers(&plan["strikes"]["table_velocity"]);
        assert_eq!(speeds.len(), strikes + 1);
        printed(number_at(&plan, "/contact_from"), time, 1e-3);
        printed(largest(&speeds[..strikes]), speed, 1e-3);
        printed(speeds[strikes], last, 1e-3);
        printed(number_at(&plan, "/demand/tilt"), tilt, 1e-3);
        for name in ["x", "theta", "x_dot", "theta_dot"] {
            assert!(largest(&numbers(&plan["hold"][name])) < 1e-8, "{name}: {}", plan["hold"][name]);
        }
    }
}

#[tokio::test]
async fn a_braking_table_needs_the_printed_stroke() {
    let server = Server::start();
    let brake = caught(&server, "strategy=brake").await;
    assert_eq!(brake["strikes"]["n"], json!([]));
    assert_eq!(brake["settings"]["brake"], 9.81);
    printed(number_at(&brake, "/contact_from"), 0.155, 1e-3);
    printed(number_at(&brake, "/demand/speed"), 1.517, 1e-3);
    printed(number_at(&brake, "/demand/stroke"), 0.117, 1e-3);
    printed(number_at(&brake, "/demand/tilt"), 0.298, 1e-3);
    // N = (G + a)/(cos α + (l²/ρ²) sin β sin θ) while the body does not turn yet, with l²/ρ² = 2.
    let [theta, alpha, force] = ["theta", "alpha", "normal_force"].map(|name| brake["hold"][name][0].as_f64().unwrap());
    let expected = 2.0 * 9.81 / (alpha.cos() + 2.0 * (theta - alpha).sin() * theta.sin());
    assert!((force - expected).abs() < 1e-9, "{force} {expected}");
    assert!(number_at(&brake, "/demand/normal_force") >= force, "{}", brake["demand"]);
    // The table has come to rest 0.117 m lower.
    printed(-*numbers(&brake["hold"]["table_y"]).last().unwrap(), 0.117, 1e-3);
}

#[tokio::test]
async fn the_choice_is_told_with_what_rules_the_others_out() {
    let server = Server::start();
    let free = caught(&server, "").await;
    assert_eq!(free["strategy"]["name"], "bounce_down");
    assert_eq!(free["candidates"].as_array().unwrap().len(), 5);
    let slow = caught(&server, "scene.table.limits.speed=0.15").await;
    assert_eq!((&slow["settings"]["strategy"], &slow["settings"]["ratio"]), (&json!("bounce_down"), &json!(0.9)));
    let reason = slow["strategy"]["reason"].as_str().unwrap();
    assert!(reason.contains("bounce_down with ratio 0.5 ends as beyond_limits"), "{reason}");
    let first = &slow["candidates"][0]["outcome"];
    assert_eq!((&first["quantity"], &first["limit"], &first["unit"]), (&json!("speed"), &json!(0.15), &json!("m/s")));
    // Asked for by its own name, the strategy is the same catch.
    let named = caught(&server, "scene.table.limits.speed=0.15&strategy=bounce_down&ratio=0.9").await;
    for part in ["strikes", "hold", "outcome", "demand", "settings"] {
        assert_eq!(named[part], slow[part], "{part}");
    }
    assert_eq!((&named["candidates"], &named["strategy"]["reason"]), (&json!([]), &json!("as asked for")));
    let stiff = server.get(&format!("/v1/catches?{FALL}&scene.table.limits.tilt=0.02")).await.expect(200).json();
    assert_eq!(stiff["outcome"]["kind"], "beyond_limits");
    assert!(stiff["strategy"]["reason"].as_str().unwrap().contains("no strategy catches"), "{}", stiff["strategy"]);
}

#[tokio::test]
async fn a_plan_says_how_many_strikes_it_chose_and_why() {
    let server = Server::start();
    let chosen = caught(&server, "strategy=plan").await;
    let strikes = chosen["settings"]["strikes"].as_u64().unwrap();
    assert_eq!(numbers(&chosen["strikes"]["n"]).len() as u64, strikes + 1);
    let reason = format!("as asked for; its {strikes} strikes are the fewest with all tilts within 0.25 rad");
    assert_eq!(chosen["strategy"]["reason"], reason);
    assert!(number_at(&chosen, "/demand/tilt") <= 0.25, "{}", chosen["demand"]);
    let named = caught(&server, &format!("strategy=plan&strikes={strikes}")).await;
    assert_eq!((&named["strikes"], &named["hold"]), (&chosen["strikes"], &chosen["hold"]));
    assert_eq!(named["strategy"]["reason"], "as asked for");
    let wrong = "strategy=plan&scene.contact.restitution=0.6&scene.table.assumed_restitution=0.8";
    let notes = caught(&server, wrong).await["notes"].to_string();
    assert!(notes.contains("a restitution of 0.6 in place of 0.8, which the table assumed"), "{notes}");
}

#[tokio::test]
async fn a_motion_between_strikes_that_was_never_made_is_null() {
    let server = Server::start();
    let slow = caught(&server, "scene.table.limits.speed=0.15").await;
    let first = &slow["candidates"][0];
    assert_eq!(first["outcome"]["kind"], "beyond_limits");
    assert!(first["demand"]["stroke"].is_null() && first["demand"]["tilt_rate"].is_null(), "{}", first["demand"]);
    assert!(number_at(&slow, "/demand/stroke") > 0.0);
    let detail = slow["outcome"]["detail"].as_str().unwrap();
    assert!(detail.contains("to the end of the time asked for"), "{detail}");
}

/// Between strikes there is a flight in closed form from the columns alone.
#[tokio::test]
async fn each_strike_follows_from_the_flight_after_the_last() {
    let server = Server::start();
    for scene in ["", "&scene.contact.restitution=0.6", "&scene.contact.friction=0.5&scene.table.slide=matched"] {
        let answer = server.get(&format!("/v1/catches?{FALL}{scene}&strategy=bounce_down")).await.expect(200).json();
        let strikes = &answer["strikes"];
        let at = |name: &str, row: usize| strikes[name][row].as_f64().unwrap();
        for row in 1..numbers(&strikes["n"]).len() {
            let time = at("flight_time", row - 1);
            let expected = [
                ("t", at("t", row - 1) + time),
                ("x", at("x", row - 1) + at("x_dot_after", row - 1) * time),
                ("theta", at("theta", row - 1) + at("theta_dot_after", row - 1) * time),
                ("x_dot", at("x_dot_after", row - 1)),
                ("y_dot", at("y_dot_after", row - 1) - 9.81 * time),
                ("theta_dot", at("theta_dot_after", row - 1)),
            ];
            for (name, expected) in expected {
                assert!((at(name, row) - expected).abs() < 1e-12, "{scene} {name} {row}");
            }
        }
    }
}

#[tokio::test]
async fn laws_that_do_not_catch_are_told_of() {
    let server = Server::start();
    let target = "scene.table.energy_gain=0.4&scene.table.target_height=0.1334";
    let answer = caught(&server, target).await;
    let notes = answer["notes"].to_string();
    assert!(notes.contains("the scene's own table would not catch"), "{notes}");
    let wrong = "scene.contact.restitution=0.6&scene.table.assumed_restitution=0.8&strategy=bounce_down";
    let notes = caught(&server, wrong).await["notes"].to_string();
    assert!(notes.contains("belief about restitution is wrong"), "{notes}");
}

#[tokio::test]
async fn rows_of_the_hold_are_as_many_as_asked_for_and_end_with_its_end() {
    let server = Server::start();
    let whole = caught(&server, "strategy=bounce_down&hold_samples=602").await;
    for most in [2, 3, 50, 200, 601] {
        let thin = caught(&server, &format!("strategy=bounce_down&hold_samples={most}")).await;
        let t = numbers(&thin["hold"]["t"]);
        assert!((2..=most).contains(&t.len()) && t.len() * 2 >= most, "{most}: {}", t.len());
        assert_eq!(t[0], number_at(&thin, "/contact_from"));
        let all = numbers(&whole["hold"]["t"]);
        assert_eq!(t.last(), all.last());
        assert!(t.iter().all(|t| all.contains(t)));
    }
    let longer = caught(&server, "strategy=bounce_down&hold=12").await;
    let t = numbers(&longer["hold"]["t"]);
    assert!((t.last().unwrap() - t[0] - 12.0).abs() < 1e-12);
    assert!(number_at(&longer, "/error_bound") < 1e-7, "{}", longer["error_bound"]);
}

#[tokio::test]
async fn the_same_catch_is_the_same_bytes_in_every_format() {
    let body = json!({"preset": "case-1", "scene": {"release": {"height": 0.25, "theta": 0.1}}, "strategy": "bounce_down",
        "weights": {"input": 8}, "hold": 3});
    let query = format!("{FALL}&strategy=bounce_down&weights.input=8&hold=3");
    let (server, other) = (Server::start(), Server::start());
    for format in ["json", "csv", "ndjson", "svg", "png"] {
        let target = format!("/v1/catches?{query}&format={format}");
        let one = server.get(&target).await.expect(200);
        let two = other.post(&format!("/v1/catches?format={format}"), &body).await.expect(200);
        assert!(one.raw == two.raw && one.etag() == two.etag(), "{format}");
        server.get_with(&target, &[("if-none-match", one.etag())]).await.expect(304);
        server.head(&target).await.expect(200);
    }
    let answer = server.post("/v1/catches", &body).await.json();
    let (strikes, hold) = (&answer["strikes"], &answer["hold"]);
    let csv = Table::parse(server.post("/v1/catches?format=csv", &body).await.text()).unwrap();
    let (struck, held) = (numbers(&strikes["t"]).len(), numbers(&hold["t"]).len());
    assert_eq!(csv.column("phase"), [vec!["strike"; struck], vec!["hold"; held]].concat());
    let cells = |name: &str| csv.column(name).iter().map(|cell| cell.parse::<f64>().ok()).collect::<Vec<_>>();
    let both = |name: &str| {
        let parts = [strikes, hold].into_iter().zip([struck, held]);
        let each = parts.flat_map(|(part, rows)| {
            (0..rows).map(|row| part.get(name).and_then(|column| column[row].as_f64())).collect::<Vec<_>>()
        });
        each.collect::<Vec<_>>()
    };
    for (header, name) in [
        ("t_s", "t"),
        ("theta_rad", "theta"),
        ("alpha_rad", "alpha"),
        ("y_dot_m_per_s", "y_dot"),
        ("table_velocity_m_per_s", "table_velocity"),
        ("normal_force_m_per_s2", "normal_force"),
    ] {
        assert_eq!(cells(header), both(name), "{name}");
    }
    let lines = server.post("/v1/catches?format=ndjson", &body).await;
    let end: Value = serde_json::from_str(lines.text().lines().last().unwrap()).unwrap();
    for part in ["outcome", "settings", "strategy", "demand", "reach", "contact_from", "upright_within", "notes"] {
        assert_eq!(end["end"][part], answer[part], "{part}");
    }
}

/// Places of a curve of the picture in the units of its panel, as its data attributes tell them.
fn curve(picture: &roxmltree::Document<'_>, panel: &str, name: &str) -> Vec<(f64, f64)> {
    let nodes = || picture.descendants();
    let frame = nodes().find(|node| node.attribute("data-panel") == Some(panel)).unwrap();
    let read = |name: &str| frame.attribute(name).unwrap().parse::<f64>().unwrap();
    let ends = |name: &str| -> Vec<f64> {
        frame.attribute(name).unwrap().split(' ').map(|end| end.parse().unwrap()).collect()
    };
    let ([left, top, width, height], x, y) = (["x", "y", "width", "height"].map(read), ends("data-x"), ends("data-y"));
    let paths = nodes().filter(|node| node.attribute("data-curve") == Some(name));
    let places = paths.flat_map(|path| {
        let points = path.attribute("d").unwrap().split(['M', 'L']).filter(|point| !point.is_empty());
        points.map(|point| {
            let mut numbers = point.trim_end_matches("h0").split(' ').map(|number| number.parse::<f64>().unwrap());
            (numbers.next().unwrap(), numbers.next().unwrap())
        })
    });
    let inside = places.filter(|(px, py)| {
        (left - 0.1..=left + width + 0.1).contains(px) && (top - 0.1..=top + height + 0.1).contains(py)
    });
    inside
        .map(|(px, py)| (x[0] + (px - left) / width * (x[1] - x[0]), y[1] - (py - top) / height * (y[1] - y[0])))
        .collect()
}

#[tokio::test]
async fn the_picture_has_the_stroke_and_every_strike() {
    let server = Server::start();
    for query in ["strategy=plan&ratio=1&strikes=5", "strategy=bounce_down", "strategy=brake"] {
        let answer = caught(&server, query).await;
        let text = server.get(&format!("/v1/catches?{FALL}&{query}&format=svg")).await.expect(200);
        let picture = roxmltree::Document::parse(text.text()).unwrap();
        let strikes = &answer["strikes"];
        for (panel, column) in [("alpha", "alpha"), ("table_speed", "table_velocity")] {
            let (t, values) = (numbers(&strikes["t"]), numbers(&strikes[column]));
            let drawn = curve(&picture, panel, "strikes");
            assert_eq!(drawn.len(), t.len(), "{query}: {panel}");
            let range = 1e-2 * largest(&values).max(1e-3);
            for ((x, y), (t, value)) in drawn.into_iter().zip(t.into_iter().zip(values)) {
                assert!((x - t).abs() < 0.02 && (y - value).abs() < range.max(0.01), "{panel}: {x} {y}, {t} {value}");
            }
        }
        // From the lowest to the highest place of the table: on its way from one strike to the next, 17 points each, and in contact.
        let height = |name| curve(&picture, "table_y", name).into_iter().map(|(_, y)| y).collect::<Vec<_>>();
        let span = |heights: &[f64]| {
            heights.iter().fold(0.0_f64, |most, y| most.max(*y))
                - heights.iter().fold(0.0_f64, |least, y| least.min(*y))
        };
        let drawn = height("way").chunks(17).map(span).fold(span(&height("contact")), f64::max);
        let stroke = number_at(&answer, "/demand/stroke");
        assert!(drawn < 1.03 * stroke && drawn > 0.9 * stroke, "{query}: {drawn} {stroke}");
        for panel in ["theta", "y", "x"] {
            assert!(curve(&picture, panel, "body").len() > 17, "{query}: {panel}");
        }
    }
}

#[tokio::test]
async fn requests_that_contradict_themselves_are_refused() {
    let server = Server::start();
    for (query, pointer, words) in [
        ("strategy=drop", "/strategy", "one of"),
        ("ratio=0.5", "/ratio", "is for the strategy bounce_down or plan, and strategy is auto"),
        ("strategy=brake&ratio=0.5", "/ratio", "and strategy is brake"),
        ("strategy=bounce_down&ratio=1", "/ratio", "from 0.05 to 0.98 (no unit)"),
        ("strategy=plan&ratio=1.2", "/ratio", "from 0.05 to 1"),
        ("strikes=5", "/strikes", "is for the strategy plan, and strategy is auto"),
        ("strategy=bounce_down&strikes=5", "/strikes", "is for the strategy plan, and strategy is bounce_down"),
        ("strategy=plan&strikes=500", "/strikes", "from 4 to 40"),
        ("strategy=plan&brake=5", "/brake", "is for the strategy brake, and strategy is plan"),
        ("strategy=brake&brake=0", "/brake", "from 0.01 to 10000 m/s²"),
        ("hold=0", "/hold", "from 0.1 to 60 s"),
        ("hold=61", "/hold", "from 0.1 to 60 s"),
        ("hold_samples=1", "/hold_samples", "from 2 to 602"),
        ("hold_speed=1", "/hold_speed", "from 0.0001 to 0.1 m/s"),
        ("weights.input=0", "/weights/input", "0.000001"),
        ("bounces=5", "/bounces", "unknown field"),
        ("scene.release.height=0", "/scene/release/height", "height"),
    ] {
        let answer = server.get(&format!("/v1/catches?preset=case-1&{query}")).await.expect(422);
        assert_eq!(answer.pointers(), [pointer], "{query}: {}", answer.text());
        assert!(answer.text().contains(words), "{query}: {}", answer.text());
    }
    let caught = "preset=point-mass&interventions.0.impact=2&interventions.0.catch.strategy=brake";
    for (target, pointer) in [
        ("/v1/catches?preset=point-mass", "/scene/body/point"),
        ("/v1/catches?scene.body.point=true&scene.release.height=0.2", "/scene/body/point"),
        ("/v1/throws?preset=point-mass&apex.height=0.3", "/scene/body/point"),
        (&format!("/v1/trajectories?{caught}"), "/interventions/0/catch"),
    ] {
        let answer = server.get(target).await.expect(422);
        assert_eq!(answer.pointers(), [pointer], "{}", answer.text());
        assert!(answer.text().contains("needs a body with an angle of its own"));
    }
    let schema = &DOCUMENT["components"]["schemas"]["CatchRequest"];
    for body in [json!({"preset": "case-1", "hold": 61}), json!({"preset": "case-1", "strategy": "drop"})] {
        assert!(!contract::faults(schema, &body).is_empty(), "{body}");
    }
    server.send(Method::DELETE, "/v1/catches", &[], "").await.expect(405);
}

#[tokio::test]
async fn a_scene_needs_no_law_to_be_caught() {
    let server = Server::start();
    let body = json!({"contact_distance": 0.2, "radius_of_gyration": 0.1});
    let scene = json!({"body": body, "release": {"height": 0.35, "theta": 0.05}});
    let answer = server.post("/v1/catches", &json!({"scene": scene})).await.expect(200).json();
    assert_eq!(answer["outcome"]["kind"], "held", "{}", answer["outcome"]);
    // The law of the scene has no part in it.
    let mut steep = scene.clone();
    steep["table"] = json!({"tilt_gain": 7});
    let other = server.post("/v1/catches", &json!({"scene": steep})).await.expect(200).json();
    assert_eq!((&other["strikes"], &other["hold"]), (&answer["strikes"], &answer["hold"]));
}

#[tokio::test]
async fn work_beyond_the_limit_is_refused_with_its_price() {
    let mut config = equipoise::config::Config::default();
    config.limits.work = 100_000;
    let server = Server::with(&config);
    let answer = server.get(&format!("/v1/catches?{FALL}&strategy=plan")).await.expect(422);
    assert!(answer.text().contains("the limit is 100000 bounces"), "{}", answer.text());
    server.get(&format!("/v1/catches?{FALL}&strategy=bounce_down")).await.expect(200);
}

#[tokio::test]
async fn a_batch_catches_line_by_line() {
    let lines = "{\"preset\": \"case-1\"}\n{\"preset\": \"point-mass\"}\n";
    let headers = [("content-type", "application/x-ndjson")];
    let answer = Server::start().send(Method::POST, "/v1/batches/catches", &headers, lines).await.expect(200);
    let lines: Vec<Value> = answer.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines[0]["answer"]["strategy"]["name"], "bounce_down");
    assert_eq!(lines[1]["problem"]["errors"][0]["pointer"], "/scene/body/point");
}

#[tokio::test]
async fn the_requests_of_the_documentation_run() {
    let server = Server::start();
    let document = include_str!("../../docs/catching.md");
    let targets: Vec<&str> =
        document.split("http://127.0.0.1:8080").skip(1).map(|rest| rest.split('\'').next().unwrap()).collect();
    assert!(targets.len() >= 6, "{targets:?}");
    for target in targets {
        server.get(target).await.expect(200);
    }
}

/// A stiff law takes short steps for as long as it holds the body.
#[tokio::test]
async fn a_stiff_contact_is_priced_by_its_time_and_its_law_wherever_it_is() {
    let mut config = equipoise::config::Config::default();
    config.limits.work = 8_000_000;
    let server = Server::with(&config);
    let weights = |x_dot: f64| json!({"state": {"x": 74.42, "theta": 1.0586, "x_dot": x_dot, "theta_dot": 6.086}, "input": 1.5844});
    let scene = json!({
        "body": {"contact_distance": 0.26666, "radius_of_gyration": 0.09428},
        "gravity": 100,
        "release": {"height": 0.4953801761714569, "theta": 8.638759733036068e-10},
        "contact": {"restitution": 0.08326182002870598},
        "table": {"tilt_gain": 1, "energy_gain": 2, "target_height": 0.008597157074011702},
    });
    let catch = |hold: f64, x_dot: f64| json!({"strategy": "bounce_down", "weights": weights(x_dot), "hold": hold});
    for (hold, x_dot, status) in [(60.0, 2874.3, 422), (6.0, 2874.3, 200)] {
        let mut alone = catch(hold, x_dot);
        alone["scene"] = scene.clone();
        server.post("/v1/catches", &alone).await.expect(status);
        let interventions = json!([{"impact": 1, "catch": catch(hold, x_dot)}]);
        let run = json!({"scene": scene, "bounces": 100, "interventions": interventions});
        server.post("/v1/trajectories", &run).await.expect(status);
        server.post("/v1/previews", &run).await.expect(status);
        let throw = json!({"scene": scene, "apex": {"height": 0.5}, "catch": catch(hold, x_dot)});
        server.post("/v1/throws", &throw).await.expect(status);
    }
}

// The laws of the failure gallery that do not catch.

#[tokio::test]
async fn a_low_target_slows_the_bounces_as_two_over_a_g_t() {
    let case = case("low-target").await;
    assert_eq!(case["truth"]["text"], "goes on");
    let (gravity, a) = (9.81, 0.4);
    // Upright, a strike turns the contact speed v into v − av³, and the flight after it takes 2v/G.
    let mut speed = (2.0 * gravity * (0.2 - 0.4 / 3.0_f64)).sqrt();
    let mut t = speed / gravity;
    let run = Server::start().get(case["ask"].as_str().unwrap()).await.expect(200).json();
    let column = |name: &str| run["impacts"][name].as_array().unwrap().clone();
    let (times, speeds) = (column("t"), column("contact_velocity"));
    assert_eq!(times.len(), 5000);
    for (computed, found) in times.iter().zip(&speeds) {
        assert!((number(computed) / t - 1.0).abs() < 1e-12, "{computed} {t}");
        assert!((number(found) / -speed - 1.0).abs() < 1e-11, "{found} {speed}");
        speed -= a * speed.powi(3);
        t += 2.0 * speed / gravity;
    }
    let asymptotic = -number(&speeds[4999]) * a * gravity * number(&times[4999]) / 2.0;
    assert!((0.95..1.0).contains(&asymptotic), "{asymptotic}");
    // Every geometric tail ends before the run has slowed down, the earlier one first.
    let tails = ["first two", "1000 and 1001"].map(|method| number(&says(&case, method)["value"]));
    assert!(tails[0] < tails[1] && tails[1] < number(&says(&case, "run of")["value"]), "{tails:?}");
}

#[tokio::test]
async fn the_gain_of_the_contact_overshoots_at_the_first_strike() {
    let server = Server::start();
    let case = case("contact-gain").await;
    assert_eq!(case["truth"]["text"], "falls");
    let gain = ["x", "theta", "x_dot", "theta_dot"].map(|name| number(&case["scene"]["table"]["feedback"][name]));
    let (l, rho_squared, gravity, ratio) = (0.4 / 3.0, 2.0 / 225.0, 9.81, 0.7);
    let tilt = |s: [f64; 4]| -gain.iter().zip(s).map(|(gain, s)| gain * s).sum::<f64>();
    // Strike of the impulse (1 + r)v, then a flight of 2rv/G: by power iteration.
    let growth = |speed: f64| {
        let (impulse, flight) = ((1.0 + ratio) * speed, 2.0 * ratio * speed / gravity);
        let mut s = [0.0, 1.0, 0.0, 0.0];
        let mut growth = 0.0;
        for _ in 0..100 {
            let alpha = tilt(s);
            let x_dot = s[2] - impulse * alpha;
            let theta_dot = s[3] + impulse * l / rho_squared * (s[1] - alpha);
            s = [s[0] + flight * x_dot, s[1] + flight * theta_dot, x_dot, theta_dot];
            growth = s.iter().map(|s| s * s).sum::<f64>().sqrt();
            s = s.map(|s| s / growth);
        }
        growth
    };
    assert!((growth(1.5) - 21.9).abs() < 0.05, "{}", growth(1.5));
    assert!((number(&says(&case, "derivative")["value"]) / growth(1.5) - 1.0).abs() < 1e-9);
    assert!(growth(0.005) < 1.0, "near the contact the gain is right");
    // The contact itself, by small steps: the same gain brings the rod to rest.
    let mut s = [0.0, 0.01, 0.0, 0.0];
    let step = 1e-4;
    for _ in 0..100_000 {
        let alpha = tilt(s);
        let [x, theta, x_dot, theta_dot] = s;
        let (x_dot, theta_dot) =
            (x_dot - step * gravity * alpha, theta_dot + step * gravity * l / rho_squared * (theta - alpha));
        s = [x + step * x_dot, theta + step * theta_dot, x_dot, theta_dot];
    }
    assert!(s.iter().all(|s| s.abs() < 1e-5), "{s:?}");
    let decay = number(&says(&case, "motion in contact")["value"]);
    assert!((decay + 1.104).abs() < 1e-3, "{decay}");
    let run = server.get(case["ask"].as_str().unwrap()).await.expect(200).json();
    assert_ne!(run["outcome"]["kind"], "settled", "{run}");
}

#[tokio::test]
async fn the_swing_after_the_bounces_comes_back_to_its_angle() {
    let case = case("settled-swing").await;
    assert_eq!(case["truth"]["text"], "swings");
    let settled = number(&says(&case, "bounces that die out")["value"]);
    assert!((settled - 0.8278).abs() < 1e-4, "{settled}");
    let begin = number(&says(&case, "forces")["value"]);
    assert!((begin + 0.11361).abs() < 1e-5, "{begin}");
    // A body at rest on a table at κθ, by small steps: N keeps the contact point at its height.
    let (l, rho_squared, gravity, kappa) = (0.4 / 3.0, 2.0 / 225.0, 9.81, 1.1);
    let turn = |theta: f64, spin: f64| {
        let (alpha, beta) = (kappa * theta, theta - kappa * theta);
        let push =
            (gravity - l * spin * spin * theta.cos()) / (alpha.cos() + l * l / rho_squared * beta.sin() * theta.sin());
        push * l / rho_squared * beta.sin()
    };
    let (mut theta, mut spin, mut most) = (begin, 0.0_f64, 0.0_f64);
    let step = 1e-4;
    for _ in 0..100_000 {
        // Leapfrog: it keeps the reversibility of the motion.
        let middle = theta + 0.5 * step * spin;
        spin += step * turn(middle, spin);
        theta = middle + 0.5 * step * spin;
        most = most.max(theta);
    }
    assert!((most / -begin - 1.0).abs() < 1e-3, "it turns at {most} rad on the other side");
    let late = number(&says(&case, "motion in contact")["value"]);
    assert!((late / most - 1.0).abs() < 5e-3, "{late} {most}");
}
