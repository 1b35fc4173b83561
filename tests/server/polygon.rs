//! Polygons: derived quantities, refusals, and the vertex that ends a run.

use crate::margins;
use crate::support::Server;
use serde_json::{Value, json};

fn triangle() -> Value {
    json!([[0, 0], [0.05, 0.2], [-0.05, 0.2]])
}

/// A flat roof, upside down.
fn wide() -> Value {
    json!([[0, 0], [0.15, 0.05], [-0.15, 0.05]])
}

fn dropped(body: &Value, tilt_gain: f64, height: f64, theta: f64) -> Value {
    json!({"body": body, "table": {"tilt_gain": tilt_gain}, "release": {"height": height, "theta": theta}})
}

fn close(value: &Value, expected: f64, tolerance: f64) {
    let number = value.as_f64().unwrap_or(f64::NAN);
    assert!((number - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

#[tokio::test]
async fn the_true_triangle_says_that_no_other_vertex_touches_and_how_near_one_comes() {
    let server = Server::start();
    let scene = dropped(&json!({"vertices": triangle()}), 1.1, 0.2, 0.3);
    let answer = server.post("/v1/trajectories", &json!({"scene": scene, "bounces": 2000})).await.expect(200).json();
    assert_eq!(answer["outcome"]["kind"], "completed");
    assert_eq!(answer["model"]["name"], "polygon");
    assert_eq!(answer["model"]["forced"][0]["field"], "body.vertices");
    assert_eq!(
        answer["scene"]["body"],
        json!({"vertices": [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]], "contact_vertex": 0})
    );
    // About the centroid, two thirds of the height above the lower corner.
    let outline = &answer["derived"]["outline"];
    for (vertex, [x, y]) in [[0.0, -0.4 / 3.0], [0.05, 0.2 / 3.0], [-0.05, 0.2 / 3.0]].into_iter().enumerate() {
        close(&outline[vertex][0], x, 1e-15);
        close(&outline[vertex][1], y, 1e-15);
    }
    close(&answer["derived"]["contact_distance"], 0.4 / 3.0, 1e-15);
    let nearest = &answer["nearest_vertex"];
    close(&nearest["clearance"], 0.19787, 1e-5);
    let n = nearest["impact"].as_u64().unwrap() as usize;
    let impact = |column: &str| answer["impacts"][column][n - 1].as_f64().unwrap();
    assert_eq!(nearest["t"].as_f64().unwrap(), impact("t"));
    // By hand: heights of the two upper corners over the table's line through the lower one.
    let beta: f64 = impact("theta") - impact("alpha");
    let corner = if beta > 0.0 { -0.05 } else { 0.05 };
    close(&nearest["clearance"], corner * beta.sin() + 0.2 * beta.cos(), 1e-12);
    assert_eq!(nearest["vertex"], if beta > 0.0 { 2 } else { 1 });
    // The last line of NDJSON has it too; a rod has none.
    let lines =
        server.post("/v1/trajectories?format=ndjson", &json!({"scene": scene, "bounces": 2000})).await.expect(200);
    let last: Value = serde_json::from_str(lines.text().trim_end().rsplit('\n').next().unwrap()).unwrap();
    assert_eq!(last["end"]["nearest_vertex"], *nearest);
    assert_eq!(server.get("/v1/trajectories?preset=case-1").await.json().get("nearest_vertex"), None);
}

#[tokio::test]
async fn a_wide_polygon_ends_where_its_rod_goes_on() {
    let server = Server::start();
    let ask = async |scene: &Value| {
        server.post("/v1/trajectories", &json!({"scene": scene, "bounces": 500})).await.expect(200).json()
    };
    let polygon = ask(&dropped(&json!({"vertices": wide()}), 1.3, 0.1, 0.3)).await;
    let lengths =
        json!({"contact_distance": 0.1 / 3.0, "radius_of_gyration": (0.09_f64 / 24.0 + 0.0025 / 18.0).sqrt()});
    let rod = ask(&dropped(&lengths, 1.3, 0.1, 0.3)).await;
    assert_eq!(rod["outcome"]["kind"], "completed");
    let outcome = &polygon["outcome"];
    assert_eq!(outcome["kind"], "other_vertex");
    assert_eq!(outcome["bounces"], 3);
    assert!(outcome["detail"].as_str().unwrap().contains("vertex 1 of the body"), "{outcome}");
    // The touch comes after the last contact, when that vertex reaches y = 0.
    let since = outcome["t"].as_f64().unwrap() - polygon["impacts"]["t"][2].as_f64().unwrap();
    assert!(since > 0.2 && polygon["impacts"]["flight_time"][2].is_null(), "{outcome}");
    for column in ["theta", "y_dot", "x_dot"] {
        for n in 0..3 {
            close(&polygon["impacts"][column][n], rod["impacts"][column][n].as_f64().unwrap(), 1e-12);
        }
    }
    let request = json!({"scene": polygon["scene"], "bounces": 500});
    let ladder = server.post("/v1/ladder", &request).await.expect(200).json().to_string();
    assert!(ladder.contains("other_vertex") && ladder.contains("completed"), "{ladder}");
    let stability = server.post("/v1/stability", &json!({"scene": polygon["scene"]})).await.expect(200).json();
    assert_eq!(stability["nonlinear"]["outcome"]["kind"], "other_vertex", "{stability}");
}

#[tokio::test]
async fn a_polygon_is_the_same_in_json_and_in_a_query() {
    let server = Server::start();
    let scene = dropped(&json!({"vertices": triangle(), "contact_vertex": 0}), 1.1, 0.2, 0.3);
    let posted = server.post("/v1/trajectories", &json!({"scene": scene, "bounces": 5})).await.expect(200).json();
    let query = "scene.body.vertices.0.0=0&scene.body.vertices.0.1=0&scene.body.vertices.1.0=0.05&scene.body.vertices.1.1=0.2\
        &scene.body.vertices.2.0=-0.05&scene.body.vertices.2.1=0.2&scene.table.tilt_gain=1.1&scene.release.height=0.2\
        &scene.release.theta=0.3&bounces=5";
    assert_eq!(server.get(&format!("/v1/trajectories?{query}")).await.expect(200).json(), posted);
    let holes = query.replace("vertices.2.", "vertices.3.");
    let answer = server.get(&format!("/v1/trajectories?{holes}")).await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/body/vertices"]);
}

#[tokio::test]
async fn a_polygon_replaces_another_kind_of_body_whole_and_vertices_are_replaced_whole() {
    let server = Server::start();
    let body = async |preset: &str, body: Value| {
        let request = json!({"preset": preset, "scene": {"body": body}, "bounces": 1});
        server.post("/v1/trajectories", &request).await
    };
    let from_rod = body("case-1", json!({"vertices": triangle()})).await.expect(200).json();
    assert_eq!(from_rod["scene"]["body"]["contact_vertex"], 0);
    let square = json!([[0, 0], [0.1, 0.1], [0, 0.2], [-0.1, 0.1]]);
    let other = body("triangle-polygon", json!({"vertices": square})).await.expect(200).json();
    assert_eq!(other["scene"]["body"]["vertices"].as_array().unwrap().len(), 4);
    let rod = json!({"contact_distance": 0.1, "radius_of_gyration": 0.1});
    assert_eq!(body("triangle-polygon", rod.clone()).await.expect(200).json()["scene"]["body"], rod);
    let half = body("triangle-polygon", json!({"contact_distance": 0.1})).await.expect(422);
    assert_eq!(half.pointers(), ["/scene/body/radius_of_gyration"]);
    let upside_down = body("triangle-polygon", json!({"contact_vertex": 1})).await.expect(200).json();
    assert_eq!(upside_down["scene"]["body"]["contact_vertex"], 1);
}

#[tokio::test]
async fn what_is_no_polygon_says_why_and_where() {
    let server = Server::start();
    let many: Vec<Value> = (0..33).map(|n| json!([n as f64 * 0.1, (n * n) as f64 * 1e-3])).collect();
    let l_shape = json!([[0, 0], [0.3, 0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.4], [0, 0.4]]);
    let vertices = "/scene/body/vertices";
    let contact = "/scene/body/contact_vertex";
    for (body, pointer, words) in [
        (json!({"vertices": []}), vertices, "vertices are 0; a polygon has from 3 to 32"),
        (json!({"vertices": [[0, 0], [1, 1]]}), vertices, "vertices are 2"),
        (json!({"vertices": many}), vertices, "an array of 3 to 32 points"),
        (json!({"vertices": 7}), vertices, "vertices is 7"),
        (json!({"vertices": [[0, 0], [0.1], [0, 0.1]]}), "/scene/body/vertices/1", "it must be [x, y] in m"),
        (json!({"vertices": [[0, 0], [0.1, "0"], [0, 0.1]]}), "/scene/body/vertices/1/1", "y of vertex 1"),
        (json!({"vertices": [[0, 0], [11, 0], [0, 0.1]]}), "/scene/body/vertices/1/0", "from -10 to 10 m"),
        (json!({"vertices": [[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.1]]}), vertices, "cross or touch"),
        (json!({"vertices": [[0, 0], [-0.05, 0.2], [0.05, 0.2]]}), vertices, "clockwise; reverse their order"),
        (json!({"vertices": [[0, 0], [0.1, 0.1], [0.2, 0.2]]}), vertices, "flat"),
        (
            json!({"vertices": [[0, 0], [0.1, 0], [0.1, 0], [0, 0.1]]}),
            vertices,
            "vertices 1 and 2 are at the same place",
        ),
        (json!({"vertices": triangle(), "contact_vertex": 3}), contact, "of 3 vertices it must be from 0 to 2"),
        (json!({"vertices": triangle(), "contact_vertex": 0.5}), contact, "a whole number"),
        (json!({"vertices": l_shape}), contact, "vertices 0 and 1 are equally low"),
        (json!({"vertices": l_shape, "contact_vertex": 3}), contact, "convex hull"),
        (
            json!({"vertices": triangle(), "contact_distance": 0.1}),
            "/scene/body/contact_distance",
            "follows from vertices",
        ),
        (json!({"vertices": triangle(), "point": true}), vertices, "a point mass has no vertices"),
        (json!({"contact_vertex": 0}), contact, "there are none"),
    ] {
        let request = json!({"preset": "case-1", "scene": {"body": body}});
        let answer = server.post("/v1/trajectories", &request).await.expect(422).json();
        let errors = answer["errors"].as_array().unwrap();
        let said = |error: &Value| error["pointer"] == pointer && error["detail"].as_str().unwrap().contains(words);
        assert!(errors.iter().any(said), "{body}: {answer}");
    }
    // At the release another vertex is below the table's line.
    let scene = dropped(&json!({"vertices": triangle()}), 1.1, 0.03, 1.5);
    let answer = server.post("/v1/trajectories", &json!({"scene": scene})).await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/release/height"]);
}

#[tokio::test]
async fn what_is_derived_for_a_bounce_holds_for_a_polygon() {
    let server = Server::start();
    let scene = dropped(&json!({"vertices": triangle()}), 1.1, 0.2, 0.05);
    let lengths = json!({"contact_distance": 0.4 / 3.0, "radius_of_gyration": (0.01_f64 / 24.0 + 0.04 / 18.0).sqrt()});
    let rod = dropped(&lengths, 1.1, 0.2, 0.05);
    let (ours, its) = (
        server.post("/v1/jacobians", &json!({"scene": scene})).await.expect(200).json(),
        server.post("/v1/jacobians", &json!({"scene": rod})).await.expect(200).json(),
    );
    for (one, other) in ours["matrix"].as_array().unwrap().iter().zip(its["matrix"].as_array().unwrap()) {
        for (one, other) in one.as_array().unwrap().iter().zip(other.as_array().unwrap()) {
            close(one, other.as_f64().unwrap(), 1e-12);
        }
    }
    let stability = server.post("/v1/stability", &json!({"scene": scene})).await.expect(200).json();
    close(&margins::critical(&stability), 1.1484, 1e-4);
    // A region runs the polygon itself, so cells far from upright end as other_vertex.
    let region = json!({
        "scene": dropped(&json!({"vertices": wide()}), 1.3, 0.1, 0.0), "bounces": 100,
        "x": {"field": "release.theta", "from": 0.0, "to": 0.3, "count": 4},
        "y": {"field": "table.tilt_gain", "from": 1.2, "to": 1.3, "count": 2},
    });
    let region = server.post("/v1/regions", &region).await.expect(200).json();
    assert!(region["counts"]["other_vertex"].as_u64().unwrap() > 0, "{region}");
    let request = json!({"scene": scene, "method": "linear"});
    let answer = server.post("/v1/trajectories", &request).await.expect(422);
    assert_eq!(answer.pointers(), ["/method"], "{}", answer.text());
    // With 31 digits the run is that of the rod with the same lengths, up to the touch of another vertex.
    let fallen = dropped(&json!({"vertices": wide()}), 1.3, 0.1, 0.3);
    let run = async |method: &str| {
        let request = json!({"scene": fallen, "method": method});
        server.post("/v1/trajectories", &request).await.expect(200).json()
    };
    let (map, exact) = (run("map").await, run("extended").await);
    assert_eq!(map["outcome"]["kind"], "other_vertex", "{map}");
    for member in ["kind", "bounces"] {
        assert_eq!(map["outcome"][member], exact["outcome"][member]);
    }
    close(&exact["outcome"]["t"], map["outcome"]["t"].as_f64().unwrap(), 1e-12);
}
