//! All formats carry the same numbers, are well-formed, and are chosen by the client.

use crate::margins::margin;
use crate::support::csv::Table;
use crate::support::{Answer, Server};
use serde_json::{Value, json};

const COLUMNS: [(&str, &str); 18] = [
    ("n", "n"),
    ("t", "t_s"),
    ("x", "x_m"),
    ("theta", "theta_rad"),
    ("x_dot", "x_dot_m_per_s"),
    ("y_dot", "y_dot_m_per_s"),
    ("theta_dot", "theta_dot_rad_per_s"),
    ("alpha", "alpha_rad"),
    ("table_velocity_x", "table_velocity_x_m_per_s"),
    ("table_velocity_y", "table_velocity_y_m_per_s"),
    ("impulse_normal", "impulse_normal_m_per_s"),
    ("impulse_tangential", "impulse_tangential_m_per_s"),
    ("contact_mode", "contact_mode"),
    ("energy", "energy_m2_per_s2"),
    ("flight_time", "flight_time_s"),
    ("contact_velocity", "contact_velocity_m_per_s"),
    ("clearance", "clearance_m"),
    ("error_estimate", "error_estimate_m_per_s"),
];

/// The value of a CSV cell.
fn value(cell: &str) -> Value {
    if cell.is_empty() { Value::Null } else { serde_json::from_str(cell).unwrap_or_else(|_| json!(cell)) }
}

/// True if two numbers are equal bit for bit, in any notation.
fn same(one: &Value, other: &Value) -> bool {
    match (one.as_f64(), other.as_f64()) {
        (Some(one), Some(other)) => one.to_bits() == other.to_bits(),
        _ => one == other,
    }
}

async fn all_formats(target: &str) -> [Answer; 3] {
    let server = Server::start();
    let json = server.get(target).await.expect(200);
    let csv = server.get(&format!("{target}&format=csv")).await.expect(200);
    let ndjson = server.get(&format!("{target}&format=ndjson")).await.expect(200);
    [json, csv, ndjson]
}

#[tokio::test]
async fn a_trajectory_has_the_same_numbers_in_every_format() {
    for preset in ["case-1", "case-3", "case-4", "point-mass", "still-lossy"] {
        let [json, csv, ndjson] = all_formats(&format!("/v1/trajectories?preset={preset}&bounces=60")).await;
        let whole = json.json();
        let count = whole["impacts"]["n"].as_array().unwrap().len();
        assert!(count > 10, "{preset}: {count}");
        let table = Table::parse(csv.text()).unwrap();
        assert_eq!(table.names, COLUMNS.map(|(_, name)| name), "{preset}");
        assert_eq!(table.rows.len(), count, "{preset}");
        let lines: Vec<Value> = ndjson.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(lines.len(), count + 1, "{preset}");
        for name in ["outcome", "method", "predictable_bounces", "notes"] {
            assert_eq!(lines[count]["end"][name], whole[name], "{preset}: {name}");
        }
        for (name, header) in COLUMNS {
            let column = whole["impacts"][name].as_array().unwrap();
            assert_eq!(column.len(), count, "{preset}: {name}");
            for (row, cell) in table.column(header).into_iter().enumerate() {
                assert!(same(&column[row], &value(cell)), "{preset}: {name}[{row}]: {} {cell}", column[row]);
                assert!(same(&column[row], &lines[row][name]), "{preset}: {name}[{row}]: {}", lines[row]);
            }
        }
    }
}

#[tokio::test]
async fn a_matrix_has_the_same_numbers_in_every_format() {
    for preset in ["case-1", "case-4", "point-mass"] {
        let [json, csv, ndjson] = all_formats(&format!("/v1/jacobians?preset={preset}")).await;
        let whole = json.json();
        let order = whole["state_order"].as_array().unwrap();
        let table = Table::parse(csv.text()).unwrap();
        assert_eq!(table.rows.len(), order.len(), "{preset}");
        for (index, row) in table.rows.iter().enumerate() {
            assert_eq!(json!(row[0]), order[index], "{preset}");
            for (column, cell) in row[1..].iter().enumerate() {
                assert!(same(&whole["matrix"][index][column], &value(cell)), "{preset}: [{index}][{column}] {cell}");
            }
        }
        assert_eq!(table.names[0], "component", "{preset}");
        assert_eq!(json!(table.names[1..]), whole["state_order"], "{preset}");
        let lines: Vec<Value> = ndjson.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(lines.len(), order.len() + 1, "{preset}");
        for (index, line) in lines[..order.len()].iter().enumerate() {
            assert_eq!(line["component"], order[index], "{preset}");
            for (column, name) in order.iter().enumerate() {
                assert!(same(&whole["matrix"][index][column], &line[name.as_str().unwrap()]), "{preset}: {line}");
            }
        }
    }
}

/// A column of a verdict's CSV row: name, unit, and pointer into the JSON answer.
const VERDICT: [(&str, &str, &str); 34] = [
    ("verdict", "", "/verdict/text"),
    ("verdict_code", "", "/verdict/code"),
    ("decided_by", "", "/verdict/decided_by"),
    ("reason", "", "/verdict/reason"),
    ("agree", "", "/agree"),
    ("linear_kind", "", "/linear/kind"),
    ("residue", "", "/linear/residue"),
    ("rotation", "rad", "/linear/rotation"),
    ("spectral_radius", "", "/linear/spectral_radius"),
    ("tilt_gain", "", "/margins/0/value"),
    ("energy_gain", "s2_per_m2", "/margins/1/value"),
    ("boundary_coefficient", "", "/boundary/coefficient"),
    ("boundary_kind", "", "/boundary/kind"),
    ("drift_speed", "m_per_s", "/drift_speed"),
    ("outcome", "", "/nonlinear/outcome/kind"),
    ("bounces", "", "/nonlinear/outcome/bounces"),
    ("t", "s", "/nonlinear/outcome/t"),
    ("max_theta", "rad", "/nonlinear/max_theta"),
    ("energy_eigenvalue", "", "/linear/energy_eigenvalue"),
    ("fixed_point_y_dot", "m_per_s", "/fixed_point/y_dot"),
    ("fixed_point_flight_time", "s", "/fixed_point/flight_time"),
    ("rotation_number_measured", "", "/rotation_number/measured"),
    ("rotation_number_small", "", "/rotation_number/small"),
    ("resonance_p", "", "/rotation_number/resonance/p"),
    ("resonance_q", "", "/rotation_number/resonance/q"),
    ("resonance_distance", "", "/rotation_number/resonance/distance"),
    ("chaos_indicator", "", "/chaos/indicator"),
    ("chaotic", "", "/chaos/chaotic"),
    ("predictable_bounces", "", "/predictable_bounces"),
    ("basin_theta", "rad", "/basin/theta"),
    ("basin_unbroken", "rad", "/basin/unbroken"),
    ("lyapunov_coefficient", "per_rad2", "/lyapunov/coefficient"),
    ("lyapunov_kind", "", "/lyapunov/kind"),
    ("escape_bounces", "", "/lyapunov/escape_bounces"),
];

#[tokio::test]
async fn a_verdict_is_one_row() {
    for preset in ["case-1", "case-4", "critical-hard", "still-lossy", "point-mass"] {
        let [json, csv, ndjson] = all_formats(&format!("/v1/stability?preset={preset}&bounces=600&basin=true")).await;
        let whole = json.json();
        let table = Table::parse(csv.text()).unwrap();
        assert_eq!(table.rows.len(), 1, "{preset}");
        let line: Value = serde_json::from_str(ndjson.text().lines().next().unwrap()).unwrap();
        for (index, (name, unit, pointer)) in VERDICT.into_iter().enumerate() {
            let expected = whole.pointer(pointer).unwrap_or(&Value::Null);
            let header = if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") };
            assert_eq!(table.names[index], header, "{preset}");
            assert!(same(expected, &value(&table.rows[0][index])), "{preset}: {name}: {:?}", table.rows[0]);
            assert!(same(expected, &line[name]), "{preset}: {name}: {line}");
        }
        for field in ["tilt_gain", "energy_gain", "feedback"] {
            let margin = margin(&whole, &format!("table.{field}"));
            for (side, number) in [("below", "limit"), ("above", "limit"), ("below", "margin"), ("above", "margin")] {
                let name = format!("{field}_{side}_{number}");
                let header = if field == "energy_gain" { format!("{name}_s2_per_m2") } else { name.clone() };
                let index = table.names.iter().position(|own| *own == header).unwrap_or_else(|| panic!("no {header}"));
                assert!(same(&margin[side][number], &value(&table.rows[0][index])), "{preset}: {name}: {margin}");
                assert!(same(&margin[side][number], &line[&name]), "{preset}: {name}: {line}");
            }
        }
    }
}

#[tokio::test]
async fn pictures_are_drawn() {
    let server = Server::start();
    for target in ["/v1/trajectories?preset=case-1", "/v1/stability?preset=case-1", "/v1/stability?preset=still-lossy"]
    {
        let picture = server.get(&format!("{target}&format=svg")).await.expect(200);
        assert_eq!(picture.media_type(), "image/svg+xml");
        let text = picture.text();
        assert!(text.contains("<title"), "{target}: a picture says what it is");
        for outside in ["<script", "href=\"http", "url(http", "@import"] {
            assert!(!text.contains(outside), "{target}: {outside}");
        }
    }
    let points = server.get("/v1/trajectories?preset=point-mass&format=svg").await.expect(200);
    assert!(!points.text().is_empty());
}

#[tokio::test]
async fn the_format_is_the_one_asked_for() {
    let server = Server::start();
    for (accept, expected) in [
        ("*/*", "application/json"),
        ("", "application/json"),
        ("application/json", "application/json"),
        ("text/csv", "text/csv"),
        ("application/x-ndjson", "application/x-ndjson"),
        ("image/svg+xml", "image/svg+xml"),
        ("text/csv;q=0.5, application/json;q=0.4", "text/csv"),
        ("text/csv;q=0.4, application/json;q=0.5", "application/json"),
        ("application/json;q=0, text/csv", "text/csv"),
        // Grafana's Infinity.
        ("application/json;q=0.9,text/plain", "application/json"),
        // An <img> in Chromium, and a page.
        ("image/avif,image/webp,image/apng,image/svg+xml,image/*,*/*;q=0.8", "image/svg+xml"),
        ("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8", "application/json"),
    ] {
        let target = "/v1/trajectories?preset=case-1&bounces=3";
        let answer = server.get_with(target, &[("accept", accept)]).await.expect(200);
        assert_eq!(answer.media_type(), expected, "{accept}");
        let asked = server.get_with(&format!("{target}&format=csv"), &[("accept", accept)]).await.expect(200);
        assert_eq!(asked.media_type(), "text/csv", "{accept}: format outranks Accept");
    }
}

#[tokio::test]
async fn format_is_a_parameter_of_post_as_well() {
    let server = Server::start();
    let body = json!({"preset": "case-1", "bounces": 3});
    let post = server.post("/v1/trajectories?format=csv", &body).await.expect(200);
    let get = server.get("/v1/trajectories?preset=case-1&bounces=3&format=csv").await.expect(200);
    assert_eq!(post.text(), get.text());
    let inside = json!({"preset": "case-1", "format": "csv"});
    assert_eq!(server.post("/v1/trajectories", &inside).await.expect(422).pointers(), ["/format"]);
}

#[tokio::test]
async fn large_answers_are_compressed_for_those_who_can_read_it() {
    let server = Server::start();
    for target in ["/v1/trajectories?preset=case-1", "/v1/trajectories?preset=case-1&format=csv", "/openapi.yaml"] {
        let plain = server.get(target).await.expect(200);
        assert_eq!(plain.header("content-encoding"), None);
        let packed = server.get_with(target, &[("accept-encoding", "gzip, deflate, br")]).await.expect(200);
        assert_eq!(packed.header("content-encoding"), Some("gzip"), "{target}");
        assert!(packed.raw.len() < plain.raw.len() * 2 / 3, "{target}: {} of {}", packed.raw.len(), plain.raw.len());
        assert_eq!(packed.body, plain.body, "{target}");
        let refused = server.get_with(target, &[("accept-encoding", "gzip;q=0")]).await.expect(200);
        assert_eq!(refused.header("content-encoding"), None, "{target}");
    }
}

#[tokio::test]
async fn numbers_survive_the_round_trip() {
    let server = Server::start();
    for gain in [1.1, 1.0 + f64::EPSILON, 0.1 + 0.2, 1.4999999999999998, 5e-324, -0.0] {
        let body = json!({"preset": "case-1", "scene": {"table": {"tilt_gain": gain}}, "bounces": 1});
        let post = server.post("/v1/trajectories", &body).await.expect(200).json();
        let target = format!("/v1/trajectories?preset=case-1&bounces=1&scene.table.tilt_gain={gain:e}");
        let get = server.get(&target).await.expect(200).json();
        for answer in [&post, &get] {
            let back = answer["scene"]["table"]["tilt_gain"].as_f64().unwrap();
            assert_eq!(back.to_bits(), gain.to_bits(), "{gain:e} came back as {back:e}");
        }
        assert_eq!(post, get);
    }
}

/// Numbers over tolerances in JSON, with the name that each has in the other formats.
fn numbers_over_tolerances(name: &str, value: &Value, found: &mut Vec<(String, f64)>) {
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(key, value)| numbers_over_tolerances(&format!("{name}_{key}"), value, found));
        }
        Value::Number(number) => found.push((name.to_owned(), number.as_f64().unwrap())),
        Value::Bool(flag) => found.push((name.to_owned(), f64::from(u8::from(*flag)))),
        _ => {}
    }
}

#[tokio::test]
async fn all_formats_have_the_margins_over_tolerances_and_the_basin() {
    let server = Server::start();
    let (further, off) = ("tolerances.1.field=gravity", "tolerances.1.tolerance=0.1");
    let query = format!(
        "preset=case-4&bounces=100&basin=true&tolerances.0.field=body.contact_distance&tolerances.0.tolerance=0.001&{further}&{off}"
    );
    let target = format!("/v1/stability?{query}");
    let [json, csv, ndjson] = all_formats(&target).await;
    let (whole, table) = (json.json(), Table::parse(csv.text()).unwrap());
    let line: Value = serde_json::from_str(ndjson.text().lines().next().unwrap()).unwrap();
    let arrow = server.get(&format!("{target}&format=arrow")).await.expect(200);
    let arrow = crate::support::arrow::Stream::parse(&arrow.body).unwrap();
    let scraped = server.get(&format!("{target}&format=openmetrics")).await.expect(200);
    let probe = format!("/v1/probe?target={}", query.replace('=', "%3D").replace('&', "%26"));
    let probed = server.get(&probe).await.expect(200);
    assert_eq!(scraped.text(), probed.text());
    let gauge = |name: &str| {
        let prefixes = ["", "_meters", "_radians"].map(|unit| format!("equipoise_stability_{name}{unit} "));
        let found = scraped.text().lines().find_map(|line| prefixes.iter().find_map(|name| line.strip_prefix(name)));
        found.unwrap_or_else(|| panic!("no gauge of {name}")).parse::<f64>().unwrap()
    };
    let cell = |name: &str| {
        let place = table
            .names
            .iter()
            .position(|own| [name, &format!("{name}_m"), &format!("{name}_rad")].contains(&own.as_str()));
        value(&table.rows[0][place.unwrap_or_else(|| panic!("no column of {name}"))])
    };
    let mut numbers = Vec::new();
    numbers_over_tolerances("over_tolerances", &whole["over_tolerances"], &mut numbers);
    assert_eq!(numbers.len(), 5, "{numbers:?}");
    numbers.push(("basin_theta".to_owned(), whole["basin"]["theta"].as_f64().unwrap()));
    numbers.push(("basin_unbroken".to_owned(), whole["basin"]["unbroken"].as_f64().unwrap()));
    for (name, expected) in numbers {
        let number = |value: &Value| value.as_f64().or(value.as_bool().map(|flag| f64::from(u8::from(flag))));
        let found = [cell(&name), line[&name].clone(), arrow.column(&name)[0].clone()];
        for (value, format) in found.iter().zip(["csv", "ndjson", "arrow"]) {
            assert_eq!(number(value), Some(expected), "{name} in {format}");
        }
        assert_eq!(gauge(&name), expected, "{name} in openmetrics");
    }
    let worst = whole["over_tolerances"]["worst"].as_array().unwrap();
    let (fields, units) = (["body.contact_distance", "gravity"], ["m", "m/s²"]);
    for ((field, unit), worst) in fields.into_iter().zip(units).zip(worst) {
        let name = format!("over_tolerances_worst{{field=\"{field}\",unit=\"{unit}\"}}");
        assert_eq!(gauge(&name), worst["value"].as_f64().unwrap());
    }
    let list: Value = worst.iter().map(|field| field["value"].clone()).collect();
    let column = "over_tolerances_worst";
    assert_eq!((&cell(column), &line[column], &arrow.column(column)[0]), (&list, &list, &list));
    let above = margin(&whole, "table.tilt_gain")["above"]["least"].clone();
    assert!(above.is_number(), "{whole}");
    let column = "tilt_gain_above_least";
    assert_eq!((&cell(column), &line[column], &arrow.column(column)[0]), (&above, &above, &above));
    let gauge = scraped.text().lines().find_map(|line| {
        line.strip_prefix(r#"equipoise_margin_least{field="table.tilt_gain",side="above",of="small",unit="1"} "#)
    });
    assert_eq!(gauge.unwrap().parse::<f64>().ok(), above.as_f64());
}
