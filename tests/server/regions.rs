//! Stability maps: each cell is the run of its own scene, tiles are bands of the whole map, and the number of threads does not matter.

use crate::support::Server;
use serde_json::{Value, json};

/// Tilt gain and release angle as sides, for the paper's body.
const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=14\
                   &y.field=release.theta&y.from=0&y.to=0.5&y.count=11&bounces=300";

#[tokio::test]
async fn a_cell_is_the_run_of_its_scene() {
    let server = Server::start();
    let map = server.get(MAP).await.expect(200).json();
    let names = map["outcome_names"].as_array().unwrap();
    let mut fell = 0;
    for (row, theta) in map["y"].as_array().unwrap().iter().enumerate() {
        for (column, kappa) in map["x"].as_array().unwrap().iter().enumerate() {
            let scene = json!({"table": {"tilt_gain": kappa}, "release": {"theta": theta}});
            let run =
                server.post("/v1/stability", &json!({"preset": "case-1", "scene": scene, "bounces": 300})).await.json();
            let code = map["outcomes"][row][column].as_u64().unwrap() as usize;
            assert_eq!(map["values"][row][column], run["nonlinear"]["outcome"]["bounces"], "{kappa} {theta}");
            assert_eq!(names[code], run["nonlinear"]["outcome"]["kind"], "{kappa} {theta}");
            fell += u64::from(names[code] != "completed");
        }
    }
    assert!(fell > 20 && fell < 140, "{fell} of 154 cells fell");
}

#[tokio::test]
async fn tiles_put_together_are_the_whole() {
    let server = Server::start();
    for quantity in ["survival", "max_theta", "residue", "spectral_radius"] {
        let target = format!("{MAP}&quantity={quantity}");
        let whole = server.get(&target).await.json();
        let csv = server.get(&format!("{target}&format=csv")).await;
        let ndjson = server.get(&format!("{target}&format=ndjson")).await;
        let (mut values, mut rows, mut lines) = (Vec::new(), Vec::new(), Vec::new());
        for index in 0..3 {
            let tile = format!("{target}&tile.index={index}&tile.of=3");
            values.extend(server.get(&tile).await.json()["values"].as_array().unwrap().clone());
            rows.extend(
                server
                    .get(&format!("{tile}&format=csv"))
                    .await
                    .text()
                    .lines()
                    .skip(1)
                    .map(str::to_owned)
                    .collect::<Vec<_>>(),
            );
            let text = server.get(&format!("{tile}&format=ndjson")).await.text().to_owned();
            lines.extend(
                text.lines().filter(|line| !line.starts_with("{\"end\"")).map(str::to_owned).collect::<Vec<_>>(),
            );
        }
        assert_eq!(json!(values), whole["values"], "{quantity}");
        assert_eq!(rows, csv.text().lines().skip(1).collect::<Vec<_>>(), "{quantity}");
        assert_eq!(lines, ndjson.text().lines().take(11).collect::<Vec<_>>(), "{quantity}");
    }
}

/// Limits of work and answer hold per tile: 10^9 cells are requested row by row, and each is the cell of the whole.
#[tokio::test]
async fn a_map_larger_than_any_answer_is_asked_for_in_tiles() {
    let server = Server::start();
    let map = MAP.replace("count=14", "count=31623").replace("count=11", "count=31623").replace("=300", "=3");
    let whole = server.get(&map).await.expect(422);
    assert!(whole.text().contains("size of the answer would be 2000028258 numbers"), "{}", whole.text());
    let tile = format!("{map}&tile.of=31623&tile.index=20000");
    let row = server.get(&tile).await.expect(200).json();
    let (x, y) = (row["x"].as_array().unwrap(), row["y"].as_array().unwrap());
    assert_eq!((x.len(), y.len(), row["values"][0].as_array().unwrap().len()), (31623, 1, 31623));
    assert_eq!(x[7777], json!(0.95 + (1.6 - 0.95) * (7777.0 / 31622.0)));
    assert_eq!(y[0], json!(0.5 * (20000.0 / 31622.0)));
    let csv = server.get(&format!("{tile}&format=csv")).await.expect(200);
    assert_eq!(csv.text().lines().count(), 1 + 31623);
    let value = &row["values"][0][7777];
    let cell = format!("{},{},{value},", x[7777], y[0]);
    assert!(csv.text().lines().nth(7778).unwrap().starts_with(&cell), "{cell}");
    let ndjson = server.get(&format!("{tile}&format=ndjson")).await.expect(200);
    let line: Value = serde_json::from_str(ndjson.text().lines().next().unwrap()).unwrap();
    assert_eq!((&line["row"], &line["values"]), (&json!(20000), &row["values"][0]));
    server.get(&format!("{tile}&format=svg")).await.expect(200);
}

/// The linear boundary over tilt gain and angle is two vertical lines, κ = 1 and κ_c.
#[tokio::test]
async fn the_boundary_is_where_the_residue_is_0_or_1() {
    let server = Server::start();
    let map = server.get(MAP).await.json();
    let segments = map["limit_curves"].as_array().unwrap();
    assert!(!segments.is_empty());
    for segment in segments {
        let expected = if segment["residue"] == json!(0.0) { 1.0 } else { 1.5 };
        for x in segment["x"].as_array().unwrap() {
            assert!((x.as_f64().unwrap() - expected).abs() < 1e-9, "{segment}");
        }
    }
}

#[tokio::test]
async fn a_run_that_never_meets_the_table_ends_at_once() {
    // One scene misses the planned table after a high flight; the other one turns until another corner touches first.
    let thrown = json!({"body": {"contact_distance": 0.275, "radius_of_gyration": 0.265}, "table": {"tilt_gain": 1.75},
        "noise": {"model": "plan", "timing_sd": 0.0005}, "release": {"height": 0.275, "y_dot": 91.3}});
    let turned = json!({"body": {"vertices": [[0, 0], [0.1, 0.2], [-0.1, 0.2]]}, "table": {"tilt_gain": 1.75},
        "release": {"height": 0.5, "theta_dot": 5}});
    for (scene, expected) in [(thrown, "missed"), (turned, "other_vertex")] {
        let server = Server::start();
        let axis = |field, from, to| json!({"field": field, "from": from, "to": to, "count": 3});
        let request = json!({"scene": scene, "bounces": 9,
            "x": axis("release.theta_dot", -9.0, 9.0), "y": axis("table.tilt_gain", 0.5, 2.0)});
        let map = server.post("/v1/regions", &request).await.expect(200).json();
        let names = map["outcome_names"].as_array().unwrap();
        let mut seen = false;
        for (row, tilt_gain) in map["y"].as_array().unwrap().iter().enumerate() {
            for (column, spin) in map["x"].as_array().unwrap().iter().enumerate() {
                let mut alone = json!({"scene": scene, "bounces": 9});
                alone["scene"]["table"]["tilt_gain"] = tilt_gain.clone();
                alone["scene"]["release"]["theta_dot"] = spin.clone();
                let run = server.post("/v1/trajectories", &alone).await.expect(200).json();
                let code = map["outcomes"][row][column].as_u64().unwrap() as usize;
                assert_eq!(names[code], run["outcome"]["kind"], "{alone}");
                assert_eq!(map["values"][row][column], run["outcome"]["bounces"], "{alone}");
                seen |= map["values"][row][column] == 0 && names[code] == expected;
            }
        }
        assert!(seen, "none is {expected} before its first contact: {map}");
    }
}

#[tokio::test]
async fn scenes_that_cannot_be_have_no_run() {
    let server = Server::start();
    let target = "/v1/regions?preset=case-1&x.field=release.height&x.from=0.05&x.to=0.3&x.count=6\
                  &y.field=release.theta&y.from=0&y.to=0.2&y.count=3&bounces=50";
    let map = server.get(target).await.json();
    assert!(map["values"][0][0].is_null());
    assert_eq!(map["outcome_names"][map["outcomes"][0][0].as_u64().unwrap() as usize], "none");
    assert_eq!(map["values"][0][5], 50);
    let total: u64 = map["counts"].as_object().unwrap().values().filter_map(Value::as_u64).sum();
    assert_eq!(total, 18);
}

/// Scenes that do not fit into lanes run one by one.
#[tokio::test]
async fn point_masses_and_still_tables_have_maps_too() {
    let server = Server::start();
    for (target, outcome) in [
        ("preset=point-mass&x.field=table.tilt_gain&x.from=0.1&x.to=0.9&x.count=4", "completed"),
        ("preset=still-lossy&x.field=contact.restitution&x.from=0.2&x.to=0.6&x.count=4", "settled"),
    ] {
        let target = format!("/v1/regions?{target}&y.field=release.height&y.from=0.2&y.to=0.4&y.count=2&bounces=60");
        let map = server.get(&target).await.json();
        assert_eq!(map["counts"][outcome], 8, "{}", map["counts"]);
    }
}

#[tokio::test]
async fn what_cannot_be_mapped_is_named() {
    let server = Server::start();
    let side = |field: &str, to: f64| json!({"field": field, "from": 1.0, "to": to, "count": 4});
    let kappa = side("table.tilt_gain", 1.5);
    for (x, y, pointer) in [
        (kappa.clone(), kappa.clone(), "/y"),
        (kappa.clone(), side("table.strike", 1.5), "/y/field"),
        (side("table.tilt_gain", 1e4), side("release.height", 2.0), "/x/to"),
        (json!({"field": "table.tilt_gain"}), side("release.height", 2.0), "/x/count"),
    ] {
        let answer = server.post("/v1/regions", &json!({"preset": "case-1", "x": x, "y": y})).await;
        assert_eq!(answer.status, 422);
        let pointers: Vec<_> =
            answer.json()["errors"].as_array().unwrap().iter().map(|error| error["pointer"].clone()).collect();
        assert!(pointers.contains(&json!(pointer)), "{pointer}: {pointers:?}");
    }
    let huge = "preset=case-1&x.field=table.tilt_gain&x.from=1&x.to=2&x.count=4096&y.field=release.theta&y.from=0&y.to=1&y.count=400&bounces=100000";
    let answer = server.get(&format!("/v1/regions?{huge}")).await;
    assert_eq!(answer.status, 422);
    assert!(answer.text().contains("the limit is"), "{}", answer.text());
}

/// A map has the same bytes on 1, 2, 3 and 8 threads, with its rows in order.
#[tokio::test]
async fn threads_do_not_show() {
    let map = MAP.replace("count=14", "count=137").replace("count=11", "count=53");
    for rest in ["&quantity=max_theta", "&format=ndjson", "&format=csv", "&format=svg", "&tile.index=1&tile.of=3"] {
        for headers in [&[][..], &[("accept-encoding", "gzip")]] {
            let target = format!("{map}{rest}");
            let one = Server::with_permits(1).get_with(&target, headers).await.expect(200);
            for permits in [2, 3, 8] {
                let other = Server::with_permits(permits).get_with(&target, headers).await.expect(200);
                assert_eq!(one.raw, other.raw, "{rest}: {permits} threads");
            }
        }
    }
}

/// Release angle and spin as sides, for catches of the paper's body.
const CATCHES: &str = "/v1/regions?preset=case-1&x.field=release.theta&x.from=-0.5&x.to=0.5&x.count=7\
                       &y.field=release.theta_dot&y.from=-2&y.to=2&y.count=4&catch.strategy=bounce_down";

#[tokio::test]
async fn a_cell_of_catches_is_the_catch_of_its_scene() {
    let server = Server::start();
    let map = server.get(&format!("{CATCHES}&quantity=rest_time")).await.expect(200).json();
    let whether = server.get(&format!("{CATCHES}&quantity=caught")).await.expect(200).json();
    assert_eq!(map["outcomes"], whether["outcomes"]);
    assert_eq!((&map["counts"], map["limit_curves"].as_array().unwrap().len()), (&whether["counts"], 0));
    let names = map["outcome_names"].as_array().unwrap();
    let mut caught = 0;
    for (row, theta_dot) in map["y"].as_array().unwrap().iter().enumerate() {
        for (column, theta) in map["x"].as_array().unwrap().iter().enumerate() {
            let scene = json!({"release": {"theta": theta, "theta_dot": theta_dot}});
            let request = json!({"preset": "case-1", "scene": scene, "strategy": "bounce_down"});
            let catch = server.post("/v1/catches", &request).await.expect(200).json();
            let code = map["outcomes"][row][column].as_u64().unwrap() as usize;
            assert_eq!(names[code], catch["outcome"]["kind"], "{theta} {theta_dot}");
            let upright = &catch["upright_within"];
            let both = upright["theta_1mrad"].as_f64().zip(upright["x_1mm"].as_f64());
            let rest = both.map_or(Value::Null, |(theta, x)| json!(theta.max(x)));
            assert_eq!(map["values"][row][column], rest, "{theta} {theta_dot}");
            let is_held = u64::from(names[code] == "held");
            assert_eq!(whether["values"][row][column], is_held, "{theta} {theta_dot}");
            caught += is_held;
        }
    }
    assert_eq!(map["counts"]["held"], caught);
    assert!((10..28).contains(&caught), "{caught} of 28 cells are caught");
}

#[tokio::test]
async fn catches_come_in_tiles_rows_and_pictures_and_need_no_law() {
    let server = Server::start();
    let target = format!("{CATCHES}&quantity=caught&catch.hold=1");
    let whole = server.get(&target).await.expect(200).json();
    let mut values = Vec::new();
    for index in 0..2 {
        let tile = server.get(&format!("{target}&tile.index={index}&tile.of=2")).await.expect(200).json();
        values.extend(tile["values"].as_array().unwrap().clone());
    }
    assert_eq!(json!(values), whole["values"]);
    let csv = server.get(&format!("{target}&format=csv")).await.expect(200);
    assert!(
        csv.text().starts_with("release.theta_rad,release.theta_dot_rad_per_s,caught,outcome\r\n"),
        "{}",
        csv.text()
    );
    assert_eq!(csv.text().lines().count(), 29);
    assert!(server.get(&format!("{target}&format=svg")).await.expect(200).text().contains("caught"));
    let body = json!({
        "scene": {"body": {"contact_distance": 0.13, "radius_of_gyration": 0.09}, "release": {"height": 0.2}},
        "x": {"field": "release.theta", "from": 0.0, "to": 0.2, "count": 2},
        "y": {"field": "contact.restitution", "from": 0.5, "to": 1.0, "count": 2},
        "quantity": "caught", "catch": {"hold": 1},
    });
    assert_eq!(server.post("/v1/regions", &body).await.expect(200).json()["counts"]["held"], 4);
    let refused = server.get(&format!("{CATCHES}&quantity=survival")).await.expect(422).json();
    assert_eq!(refused["errors"][0]["pointer"], "/catch");
    let dear = target.replace("x.count=7", "x.count=400").replace("y.count=4", "y.count=400");
    assert!(server.get(&dear).await.expect(422).text().contains("bounces"));
}
