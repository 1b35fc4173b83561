//! Refusals and nulls that the contract promises for each resource, checked against the server.

use std::collections::BTreeSet;

use axum::http::Method;
use serde_json::{Value, json};

use crate::support::contract::DOCUMENT;
use crate::support::{Server, contract};
use crate::verdict::margin;

/// A part of a scene by its name in `x-refuses`, and a scene that has it.
fn parts() -> Vec<(&'static str, Value)> {
    let feedback = json!({"tilt_gain": null, "feedback": {"theta": -2.9, "x_dot": 0.36, "theta_dot": -0.25}});
    let triangle = json!([[0, 0], [0.05, 0.2], [-0.05, 0.2]]);
    vec![
        ("contact.friction", json!({"contact": {"friction": 0.3}})),
        ("table.slide", json!({"table": {"slide": "matched"}})),
        ("table.feedback", json!({"table": feedback})),
        ("table.delay", json!({"table": {"delay": 0.002}})),
        ("noise", json!({"noise": {"timing_sd": 0.001}})),
        ("noise", json!({"noise": {"angle_sd": 0.001, "model": "plan"}})),
        ("table.limits", json!({"table": {"limits": {"tilt": 1}}})),
        ("body.vertices", json!({"body": {"vertices": triangle}, "table": {"tilt_gain": 1.07}})),
        ("body.point", json!({"body": {"point": true}, "table": {"tilt_gain": 0.4}, "release": {"theta": null}})),
    ]
}

/// The resources that take a scene: the POST operation, and the least parameters beside the scene.
fn resources() -> Vec<(&'static str, &'static Value, Value)> {
    let posted = contract::operations().into_iter().filter(|(_, method, _)| method == Method::POST);
    let resources = posted.filter(|(template, ..)| !template.contains('{')).map(|(template, _, operation)| {
        let beside = match template.trim_start_matches("/v1/") {
            "regions" => json!({
                "x": {"field": "contact.restitution", "from": 0.9, "to": 1, "count": 2},
                "y": {"field": "release.height", "from": 0.2, "to": 0.21, "count": 1},
                "bounces": 5,
            }),
            "precision" => json!({"bounces": 2, "methods": ["map"]}),
            "periodic-orbits" => json!({"period": 1}),
            "ensembles" => json!({"runs": 2, "bounces": 5}),
            "catches" | "controllers" | "jacobians" => json!({}),
            // An upright bounce, which every body and table can make.
            "fits" => {
                let jitter = |n: i32| 0.001 * f64::from(n * 7 % 3 - 1);
                let still: Vec<f64> = (0..8).map(jitter).collect();
                json!({
                    "measured": {
                        "t": (0..8).map(|n| f64::from(n) * 0.23 + jitter(n)).collect::<Vec<_>>(),
                        "y_dot": (0..8).map(|n| -1.14 + jitter(n + 1)).collect::<Vec<_>>(),
                        "theta": still, "theta_dot": still, "x": still, "x_dot": still,
                    },
                    "unknown": ["gravity"],
                })
            }
            "throws" => json!({"apex": {"height": 0.3}}),
            _ => json!({"bounces": 5}),
        };
        (template, operation, beside)
    });
    resources.collect()
}

fn asked(scene: &Value, beside: &Value) -> Value {
    let mut body = beside.clone();
    body["preset"] = json!("case-1");
    body["scene"] = scene.clone();
    body
}

#[tokio::test]
async fn every_resource_refuses_what_the_contract_lists_and_takes_the_rest() {
    let server = Server::start();
    let resources = resources();
    assert_eq!(resources.len(), 13);
    for (resource, operation, beside) in resources {
        let refused: BTreeSet<&str> =
            operation["x-refuses"].as_array().into_iter().flatten().map(|part| part.as_str().unwrap()).collect();
        let mut met = BTreeSet::new();
        for (part, scene) in parts() {
            met.insert(part);
            let answer = server.post(resource, &asked(&scene, &beside)).await;
            let is_refused = answer.status == 422;
            assert_eq!(is_refused, refused.contains(part), "{part}: {} {}", answer.request, answer.text());
            assert!(is_refused || answer.status == 200, "{part}: {}", answer.status);
            if is_refused {
                let pointer = format!("/scene/{}", part.replace('.', "/"));
                let pointers = answer.pointers();
                let names = |found: &String| found.starts_with(&pointer) || (part == "body.point" && found == "/scene");
                assert!(pointers.iter().all(names), "{resource}: {part}: {pointers:?}");
            }
        }
        assert!(refused.is_subset(&met), "{resource}: {refused:?}");
    }
}

/// The words between backticks.
fn quoted(text: &str) -> BTreeSet<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

#[tokio::test]
async fn friction_is_taken_and_refused_where_its_field_says() {
    let server = Server::start();
    let scene = json!({"contact": {"friction": 0.3}});
    let (mut taken, mut refused) = (BTreeSet::new(), BTreeSet::new());
    for (resource, _, beside) in resources() {
        let answer = server.post(resource, &asked(&scene, &beside)).await;
        let side = if answer.status == 200 { &mut taken } else { &mut refused };
        side.insert(resource.trim_start_matches("/v1/"));
    }
    for (method, is_taken) in [("map", true), ("extended", true), ("linear", false)] {
        let body = asked(&scene, &json!({"bounces": 5, "method": method}));
        let answer = server.post("/v1/trajectories", &body).await;
        assert_eq!(answer.status == 200, is_taken, "{method}: {}", answer.text());
        if !is_taken {
            refused.insert(method);
        }
    }
    // The run falls at its third contact, so that its events end.
    let live = server.get("/v1/live/events?preset=case-1&scene.contact.friction=0.3&speed=20").await.expect(200);
    assert!(live.text().contains("event: end"), "{}", live.text());
    taken.extend(["live", "live/events"]);

    let friction = DOCUMENT["components"]["schemas"]["ScenePatch"].pointer("/properties/contact/properties/friction");
    let description = friction.unwrap()["description"].as_str().unwrap();
    let sentences: Vec<&str> = description.split(". ").collect();
    let sentence = |part: &str| *sentences.iter().find(|sentence| sentence.contains(part)).expect("a sentence");
    assert_eq!(quoted(sentence("is taken by")), taken);
    assert_eq!(quoted(sentence("answer 422")), refused);
}

#[tokio::test]
async fn methods_and_tolerances_apply_where_the_contract_says() {
    let server = Server::start();
    let all: BTreeSet<&str> = parts().iter().map(|(part, _)| *part).collect();
    for (request, pointer, expected) in [
        (json!({"method": "linear"}), "/method", all),
        (json!({"method": "extended"}), "", BTreeSet::new()),
        (json!({"tolerance": 1e-3}), "", BTreeSet::new()),
        (json!({"method": "map"}), "", BTreeSet::new()),
    ] {
        let mut refused = BTreeSet::new();
        for (part, scene) in parts() {
            let mut beside = request.clone();
            beside["bounces"] = json!(5);
            let answer = server.post("/v1/trajectories", &asked(&scene, &beside)).await;
            if answer.status == 422 {
                assert_eq!(answer.pointers(), [pointer], "{part}");
                refused.insert(part);
            }
        }
        assert_eq!(refused, expected, "{request}");
    }
    for (part, scene) in parts() {
        for quantity in ["survival", "max_theta", "residue", "spectral_radius"] {
            let side = |field, to| json!({"field": field, "from": 0.2, "to": to, "count": 1});
            let (x, y) = (side("release.height", 0.2), side("contact.restitution", 0.2));
            let beside = json!({"x": x, "y": y, "bounces": 3, "quantity": quantity});
            let answer = server.post("/v1/regions", &asked(&scene, &beside)).await;
            assert_eq!(answer.status, 200, "{part} {quantity}: {}", answer.text());
        }
    }
}

/// With noise the derivative, the orbit, the comparison and the map of residues are those of the same scene without it, and a note says so.
#[tokio::test]
async fn analyses_of_the_map_leave_noise_out() {
    let server = Server::start();
    let noise = json!({"noise": {"timing_sd": 0.001, "angle_sd": 0.001}});
    let side = |field, from, to| json!({"field": field, "from": from, "to": to, "count": 3});
    let map =
        json!({"x": side("table.tilt_gain", 1.0, 1.5), "y": side("release.height", 0.2, 0.3), "quantity": "residue"});
    for (resource, beside, members) in [
        ("jacobians", json!({}), &["matrix", "eigenvalues", "residue"][..]),
        ("jacobians", json!({"at": {"state": {"theta": 0.1, "x_dot": 0, "y_dot": -1, "theta_dot": 0}}}), &["matrix"]),
        ("periodic-orbits", json!({"period": 1}), &["states", "eigenvalues", "energy"]),
        ("precision", json!({"bounces": 4, "methods": ["map"]}), &["reference"]),
        ("regions", map, &["values"]),
    ] {
        let target = format!("/v1/{resource}");
        let quiet = server.post(&target, &asked(&json!({}), &beside)).await.expect(200).json();
        let noisy = server.post(&target, &asked(&noise, &beside)).await.expect(200).json();
        for member in members {
            assert_eq!(quiet[member], noisy[member], "{resource} {member}");
        }
        if resource != "regions" {
            assert!(noisy["notes"].to_string().contains("noise.timing_sd is 0.001, and the"), "{}", noisy["notes"]);
        }
    }
}

/// The value at a dotted path; null where anything on the way is.
fn at<'a>(answer: &'a Value, path: &str) -> &'a Value {
    path.split('.').fold(answer, |value, name| &value[name])
}

/// Scenes, and the members of `stability` that are null for exactly these scenes, as the contract says at each member.
#[tokio::test]
async fn stability_is_null_where_the_contract_says_and_its_notes_say_so() {
    const FIELDS: [&str; 11] = [
        "verdict",
        "linear",
        "linear.residue",
        "linear.rotation",
        "boundary",
        "drift_speed",
        "rotation_number",
        "chaos",
        "basin",
        "over_tolerances.worst",
        "over_tolerances.holds",
    ];
    let feedback = [
        "linear.residue",
        "linear.rotation",
        "boundary",
        "drift_speed",
        "rotation_number",
        "chaos",
        "over_tolerances.worst",
    ];
    let held = [
        "linear.residue",
        "linear.rotation",
        "boundary",
        "drift_speed",
        "rotation_number",
        "chaos",
        "over_tolerances.worst",
    ];
    let point = [
        "linear.residue",
        "linear.rotation",
        "boundary",
        "drift_speed",
        "rotation_number",
        "chaos",
        "basin",
        "over_tolerances.worst",
        "over_tolerances.holds",
    ];
    let mut lossy = FIELDS.to_vec();
    lossy.retain(|field| !["verdict", "drift_speed"].contains(field));
    let mut noisy = FIELDS[1..].to_vec();
    noisy.retain(|field| *field != "basin");
    let law = json!({"tilt_gain": null, "feedback": {"theta": 0.9, "x_dot": 0.03, "theta_dot": 0.05}});
    let triangle = json!([[0, 0], [0.05, 0.2], [-0.05, 0.2]]);
    let matched = json!({"contact": {"friction": 0.3}, "table": {"slide": "matched"}});
    let server = Server::start();
    for (scene, expected) in [
        (json!({}), &[][..]),
        (json!({"release": {"theta": 0}}), &["chaos"]),
        (json!({"table": {"tilt_gain": 1}}), &["drift_speed", "rotation_number", "chaos"]),
        (json!({"contact": {"friction": 0.3}}), &held),
        (matched, &[]),
        (json!({"table": law}), &feedback),
        (json!({"noise": {"timing_sd": 0.001}}), &noisy),
        (json!({"table": {"limits": {"tilt": 1}}}), &[]),
        (json!({"body": {"vertices": triangle}, "table": {"tilt_gain": 1.07}}), &[]),
        (json!({"body": {"point": true}, "table": {"tilt_gain": 0.4}, "release": {"theta": null}}), &point),
        (json!({"contact": {"restitution": 0.8}, "table": {"strike": "still"}}), &lossy),
    ] {
        let mut asked = json!({"preset": "case-1", "bounces": 510, "basin": true, "tolerances": [{"field": "body.contact_distance", "tolerance": 0.001}]});
        asked["scene"] = json!({"release": {"theta": 0.05}});
        let mut body = asked.clone();
        for (group, fields) in scene.as_object().unwrap() {
            for (name, value) in fields.as_object().unwrap() {
                body["scene"][group][name] = value.clone();
            }
        }
        let answer = server.post("/v1/stability", &body).await.expect(200).json();
        let null: Vec<&str> = FIELDS.into_iter().filter(|field| at(&answer, field).is_null()).collect();
        assert_eq!(null, expected, "{scene}: {}", answer["notes"]);
        let said = format!("{} {}", answer["notes"], answer["over_tolerances"]["reason"]);
        let is_part = |field: &&&str| {
            field.starts_with("over_tolerances.") || (answer["linear"].is_null() && field.starts_with("linear."))
        };
        for field in null.iter().filter(|field| !is_part(field)) {
            let name = field.rsplit('.').next().unwrap();
            assert!(said.contains(name), "{scene}: {field} is null without a word: {said}");
        }
    }
}

#[tokio::test]
async fn notes_give_the_reason_that_is_true() {
    let server = Server::start();
    let noisy = server.get("/v1/stability?preset=case-1-noise&bounces=50").await.json();
    assert!(noisy["drift_speed"].is_null());
    assert!(!noisy["notes"].to_string().contains("tilt_gain 1 "), "tilt_gain is 1.1: {}", noisy["notes"]);
    let sides = "x.field=release.height&x.from=0.2&x.to=0.2&x.count=1&y.field=gravity&y.from=9&y.to=9&y.count=1";
    let rough = format!("/v1/regions?preset=case-1&scene.contact.friction=0.3&{sides}&quantity=residue");
    let rough = server.get(&rough).await.json();
    assert_eq!(rough["values"], json!([[null]]));
    assert!(rough["notes"].to_string().contains("friction holds the contact"), "{}", rough["notes"]);
}

#[tokio::test]
async fn the_margins_of_the_energy_gain_are_the_ways_to_its_ends() {
    let server = Server::start();
    for gain in [-0.1, 0.0, 0.1, 0.165, 0.5, 0.8, 0.9] {
        let target = format!("/v1/stability?preset=case-4&bounces=10&scene.table.energy_gain={gain}");
        let answer = server.get(&target).await.json();
        let found = margin(&answer, "table.energy_gain");
        let upper = found["above"]["limit"].as_f64().unwrap();
        assert_eq!(found["above"]["margin"], json!(upper - gain), "{gain}");
        let below = &found["below"];
        assert!(
            below.is_null() || (&below["limit"], &below["margin"]) == (&json!(0.0), &json!(gain)),
            "{gain}: {found}"
        );
        assert_eq!(below.is_null(), gain == 0.0, "without the feedback nothing moves the height: {found}");
        let eigenvalue = answer["linear"]["energy_eigenvalue"].as_f64().unwrap();
        let nearer = f64::min(gain, upper - gain);
        assert_eq!(nearer > 0.0, eigenvalue.abs() < 1.0, "{gain}: {answer}");
    }
}

#[tokio::test]
async fn orbits_have_the_energy_of_the_release_less_that_of_its_drift() {
    let server = Server::start();
    for (x_dot, theta_dot, height) in [(0.0, 0.0, 0.2), (0.3, 0.0, 0.2), (-0.2, 0.5, 0.22)] {
        let release = json!({"height": height, "theta": 0, "x_dot": x_dot, "theta_dot": theta_dot});
        let body = json!({"preset": "case-1", "scene": {"release": release}, "period": 1});
        let orbit = server.post("/v1/periodic-orbits", &body).await.expect(200).json();
        let verdict = json!({"preset": "case-1", "scene": {"release": release}, "bounces": 1});
        let drift = server.post("/v1/stability", &verdict).await.json()["drift_speed"].as_f64().unwrap();
        let spin = 2.0_f64.sqrt() / 15.0 * theta_dot;
        let release_energy = 0.5 * (x_dot * x_dot + spin * spin) + 9.81 * height;
        let energy = orbit["energy"].as_f64().unwrap();
        assert!((energy - (release_energy - 0.5 * drift * drift)).abs() < 1e-12, "{energy}, drift {drift}");
        assert!(drift == 0.0 || energy < release_energy, "{energy}");
    }
    // With an energy gain the height follows from the table, not from the release.
    for height in [0.2, 0.3] {
        let target = format!("/v1/periodic-orbits?preset=case-4&period=1&scene.release.height={height}");
        let energy = server.get(&target).await.expect(200).json()["energy"].as_f64().unwrap();
        let wanted = 9.81 * std::f64::consts::FRAC_PI_4.sin() * 0.25;
        assert!((energy - wanted).abs() < 1e-12, "{height}: {energy}, not {wanted}");
    }
}

#[tokio::test]
async fn a_state_in_a_query_needs_its_vertical_velocity_alone() {
    let server = Server::start();
    let alone = server.get("/v1/jacobians?preset=case-1&at.state.y_dot=-1.1").await.expect(200).json();
    assert_eq!(alone["at"]["state"], json!({"theta": 0.0, "x_dot": 0.0, "y_dot": -1.1, "theta_dot": 0.0}));
    let without = server.get("/v1/jacobians?preset=case-1&at.state.theta=0.1").await.expect(422);
    assert_eq!(without.pointers(), ["/at/state/y_dot"]);
}

#[tokio::test]
async fn a_settled_run_has_ended_its_bounces_and_not_its_turning() {
    let server = Server::start();
    let scene = json!({"contact": {"restitution": 0.1}, "release": {"theta": 0.1, "x_dot": 0}});
    let body = json!({"preset": "still-lossy", "scene": scene, "bounces": 100});
    let run = server.post("/v1/trajectories", &body).await.expect(200).json();
    assert_eq!(run["outcome"]["kind"], "settled");
    let last = |column: &str| run["impacts"][column].as_array().unwrap().last().unwrap().as_f64().unwrap();
    assert!(last("contact_velocity").abs() < 1e-8 && last("theta_dot") > 1.0, "{}", run["outcome"]);
}
