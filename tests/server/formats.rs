//! All formats carry the same numbers, are well-formed, and are chosen by the client.

use std::io::Read;

use axum::http::Method;
use equipoise::limits;
use serde_json::{Value, json};

use crate::support::contract::DOCUMENT;
use crate::support::tables::{Stream, Table};
use crate::support::{Answer, Server};
use crate::verdict::margin;

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
    let arrow = Stream::parse(&arrow.body).unwrap();
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

// Columns as an Arrow stream: the same bits as in JSON, with units, nulls and the rest of the answer, in batches of bounded length.

const MEDIA_TYPE: &str = "application/vnd.apache.arrow.stream";

/// One request of each resource with columns, and with others that have special columns.
const TARGETS: [&str; 18] = [
    "/v1/trajectories?preset=case-1&bounces=60",
    "/v1/trajectories?preset=case-3&bounces=60&epoch_ms=1763675170123",
    "/v1/trajectories?preset=point-mass&bounces=9&samples_per_flight=2",
    "/v1/trajectories?preset=case-1&bounces=9&method=extended",
    "/v1/trajectories?preset=still-lossy&bounces=400&hold=2",
    "/v1/jacobians?preset=case-1",
    "/v1/stability?preset=case-4&bounces=100",
    "/v1/stability?preset=point-mass&bounces=100",
    "/v1/ensembles?preset=case-1-noise&runs=30&bounces=40",
    "/v1/ensembles?preset=case-1-noise&runs=30&bounces=40&angles=true&scene.release.theta=0.5",
    "/v1/periodic-orbits?preset=case-1",
    "/v1/periodic-orbits?preset=critical-hard&family=symmetric&theta=0.03&sweep.field=table.tilt_gain&sweep.from=1.1&sweep.to=1.2",
    "/v1/controllers?preset=case-1",
    "/v1/catches?preset=case-4",
    "/v1/throws?preset=case-4&apex.height=0.3",
    "/v1/ladder?preset=case-1&bounces=10",
    "/v1/regions?preset=case-4&x.field=table.tilt_gain&x.from=1&x.to=1.4&x.count=5&y.field=table.energy_gain&y.from=0&y.to=1&y.count=4&bounces=50",
    "/v1/regions?preset=case-1&x.field=contact.restitution&x.from=0&x.to=1&x.count=5&y.field=release.theta&y.from=-1&y.to=1&y.count=4&quantity=max_theta&bounces=9",
];

async fn stream(server: &Server, target: &str) -> Stream {
    let answer = server.get(&format!("{target}&format=arrow")).await.expect(200);
    assert_eq!(answer.media_type(), MEDIA_TYPE, "{target}");
    Stream::parse(&answer.body).unwrap_or_else(|fault| panic!("{target}: {fault}"))
}

/// Every column equals that of CSV, whose names end with the unit that Arrow has in its metadata.
#[tokio::test]
async fn columns_are_those_of_csv() {
    let server = Server::start();
    for target in TARGETS {
        let arrow = stream(&server, target).await;
        let csv = server.get(&format!("{target}&format=csv")).await.expect(200);
        let table = Table::parse(csv.text()).unwrap();
        assert!(!table.rows.is_empty(), "{target}");
        assert_eq!(arrow.rows(), table.rows.len(), "{target}");
        let names: Vec<&str> = arrow.names().into_iter().filter(|name| *name != "abs_theta").collect();
        assert_eq!(names.len(), table.names.len(), "{target}");
        for (index, (name, header)) in names.into_iter().zip(&table.names).enumerate() {
            let unit = arrow.about(name, "unit").unwrap_or_default();
            let in_csv = unit.replace('/', "_per_").replace('·', "_").replace('²', "2");
            let plain = name.trim_start_matches("abs_");
            let expected = if unit.is_empty() { plain.to_owned() } else { format!("{plain}_{in_csv}") };
            assert_eq!(*header, expected, "{target}");
            for (row, cell) in arrow.column(name).iter().enumerate() {
                let other = &table.rows[row][index];
                // Digits of 31 places are text in Arrow.
                let is_equal = same(cell, &value(other)) || cell.as_str() == Some(other);
                assert!(is_equal, "{target}: {name}[{row}]: {cell} {other}");
            }
        }
    }
}

/// Columns of the JSON answer, by path, and the columns of Arrow that have them.
#[tokio::test]
async fn columns_and_rest_are_the_whole_of_json() {
    let server = Server::start();
    for target in TARGETS {
        let arrow = stream(&server, target).await;
        let mut whole = server.get(target).await.expect(200).json();
        let mut rest = arrow.rest();
        let members = whole.as_object_mut().unwrap();
        let missing: Vec<String> = members.keys().filter(|name| rest.get(name.as_str()).is_none()).cloned().collect();
        for name in &missing {
            let member = members.remove(name).unwrap();
            let Some(columns) = member.as_object().filter(|_| name != "counts") else { continue };
            if name == "quantiles" {
                continue;
            }
            // A column of a part stands in the rows of its phase, if there are phases.
            let phases = arrow.names().contains(&"phase").then(|| arrow.column("phase"));
            let phase = ["impacts", "strikes", "hold"].iter().position(|part| part == name);
            let phase = phase.map(|index| ["impact", "strike", "hold"][index]);
            for (column, values) in columns {
                let cells = arrow.column(column).into_iter().enumerate();
                let own = |row: usize| phases.as_ref().is_none_or(|phases| phases[row].as_str() == phase);
                let cells: Vec<Value> = cells.filter(|(row, _)| own(*row)).map(|(_, cell)| cell).collect();
                let values = values.as_array().unwrap();
                assert_eq!(cells.len(), values.len(), "{target}: {name}/{column}");
                assert!(cells.iter().zip(values).all(|(one, other)| same(one, other)), "{target}: {name}/{column}");
            }
        }
        // A map is sent before it is known which of its cells have no value.
        if target.starts_with("/v1/regions") {
            members.remove("notes");
            rest.as_object_mut().unwrap().remove("notes");
        }
        assert_eq!(Value::Object(members.clone()), rest, "{target}");
    }
}

/// Units and meanings of the impacts are those of the contract.
#[tokio::test]
async fn columns_say_what_they_are() {
    let arrow = stream(&Server::start(), TARGETS[0]).await;
    for name in arrow.names() {
        let mut property = &DOCUMENT["components"]["schemas"]["Impacts"]["properties"][name];
        if let Some(reference) = property["$ref"].as_str().filter(|_| property["description"].is_null()) {
            property = DOCUMENT.pointer(&reference[1..]).unwrap();
        }
        assert_eq!(arrow.about(name, "description"), property["description"].as_str(), "{name}");
        assert_eq!(arrow.about(name, "unit"), property["x-unit"].as_str().filter(|unit| *unit != "1"), "{name}");
    }
    let field = |name: &str| arrow.schema.field_with_name(name).unwrap().clone();
    assert!(!field("t").is_nullable() && field("flight_time").is_nullable());
}

/// Angles are those of JSON, at the contacts that JSON names; quantiles say in their names that they are of |θ|.
#[tokio::test]
async fn angles_stand_at_their_contacts() {
    let server = Server::start();
    let (arrow, whole) = (stream(&server, TARGETS[9]).await, server.get(TARGETS[9]).await.expect(200).json());
    let (angles, watched) = (arrow.column("abs_theta"), whole["quantiles"]["n"].as_array().unwrap());
    let mut expected = vec![Value::Null; arrow.rows()];
    for (n, angles) in watched.iter().zip(whole["angles"].as_array().unwrap()) {
        expected[n.as_u64().unwrap() as usize - 1] = angles.clone();
    }
    assert_eq!(angles, expected);
    assert!(
        angles.iter().flat_map(|list| list.as_array().into_iter().flatten()).any(|angle| angle.as_f64() > Some(0.1))
    );
    for (which, name) in ["q05", "q25", "q50", "q75", "q95"].into_iter().enumerate() {
        let column = arrow.column(&format!("abs_theta_{name}"));
        for (index, n) in watched.iter().enumerate() {
            assert!(same(&column[n.as_u64().unwrap() as usize - 1], &whole["quantiles"][name][index]), "{which}: {n}");
        }
    }
    assert!(arrow.about("abs_theta_q50", "description").unwrap().contains("|θ|"));
    assert_eq!(stream(&server, TARGETS[8]).await.names().last(), Some(&"abs_theta_q95"));
}

/// A map is sent in batches as it is computed. Its bytes do not tell the number of threads, and tiles put together are the whole.
#[tokio::test]
async fn a_large_map_comes_in_batches() {
    let target = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=311\
                  &y.field=release.theta&y.from=0&y.to=0.5&y.count=41&bounces=60";
    let server = Server::with_permits(1);
    let target = format!("{target}&format=arrow");
    let whole = server.get(&target).await.expect(200);
    assert_eq!(whole.header("content-length"), None);
    for permits in [2, 8] {
        assert_eq!(Server::with_permits(permits).get(&target).await.expect(200).raw, whole.raw);
    }
    let packed = server.get_with(&target, &[("accept-encoding", "gzip")]).await.expect(200);
    assert_eq!((packed.header("content-encoding"), &packed.body), (Some("gzip"), &whole.body));
    let whole = Stream::parse(&whole.body).unwrap();
    assert!(whole.batches.len() > 4, "{} batches", whole.batches.len());
    let most = limits::REGION_BLOCK_CELLS.into_inner().1 as usize;
    assert!(whole.batches.iter().all(|batch| (1..=most).contains(&batch.num_rows())));
    let mut parts = vec![Vec::new(); whole.names().len()];
    for index in 0..3 {
        let tile = server.get(&format!("{target}&tile.index={index}&tile.of=3")).await.expect(200);
        let tile = Stream::parse(&tile.body).unwrap();
        for (part, name) in parts.iter_mut().zip(whole.names()) {
            part.extend(tile.column(name));
        }
    }
    for (part, name) in parts.into_iter().zip(whole.names()) {
        assert_eq!(part, whole.column(name), "{name}");
    }
}

/// A long run comes in batches that a reader can hold, with its words once.
#[tokio::test]
async fn a_long_run_comes_in_batches() {
    let server = Server::start();
    let target = "/v1/trajectories?preset=case-1&bounces=40000";
    let arrow = stream(&server, target).await;
    let lengths: Vec<usize> = arrow.batches.iter().map(|batch| batch.num_rows()).collect();
    assert_eq!(lengths, [limits::ARROW_BATCH_ROWS, limits::ARROW_BATCH_ROWS, 40_000 - 2 * limits::ARROW_BATCH_ROWS]);
    let whole = server.get(target).await.expect(200).json();
    for name in ["n", "theta", "contact_mode", "flight_time"] {
        assert_eq!(Value::Array(arrow.column(name)), whole["impacts"][name], "{name}");
    }
}

/// Decodes the gzip of an answer.
fn unpacked(raw: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    flate2::read::GzDecoder::new(raw).read_to_end(&mut body).unwrap();
    body
}

#[tokio::test]
async fn it_is_revalidated_and_compressed_like_other_formats() {
    let server = Server::start();
    for target in [TARGETS[0], TARGETS[16], TARGETS[8]] {
        let plain = server.get_with(target, &[("accept", MEDIA_TYPE)]).await.expect(200);
        let target = format!("{target}&format=arrow");
        assert_eq!(server.get(&target).await.expect(200).raw, plain.raw, "{target}");
        assert_eq!(Server::start().get(&target).await.expect(200).raw, plain.raw, "{target}");
        for method in [Method::GET, Method::HEAD] {
            server.send(method, &target, &[("if-none-match", plain.etag())], "").await.expect(304);
        }
        let head = server.head(&target).await.expect(200);
        assert_eq!((head.etag(), head.media_type()), (plain.etag(), MEDIA_TYPE), "{target}");
        let packed = server.get_with(&target, &[("accept-encoding", "gzip")]).await.expect(200);
        assert_eq!(unpacked(&packed.raw), plain.raw, "{target}");
        assert_ne!(packed.etag(), plain.etag(), "{target}");
    }
}

/// Empty tables have their columns too.
#[tokio::test]
async fn a_stream_without_rows_has_a_schema() {
    let target = "/v1/trajectories?preset=case-1&scene.topple_angle=0.01&scene.release.theta=1";
    let server = Server::start();
    let whole = server.get(target).await.expect(200).json();
    let arrow = stream(&server, target).await;
    assert_eq!(arrow.rows(), whole["impacts"]["n"].as_array().unwrap().len());
    assert_eq!(arrow.names().len(), whole["impacts"].as_object().unwrap().len());
}

/// Forms of earlier versions are refused, with advice.
#[tokio::test]
async fn forms_that_are_gone_are_told() {
    let server = Server::start();
    for (target, pointer) in [
        (format!("{}&layout=grid&format=arrow", TARGETS[16]), "/layout"),
        (format!("{}&end=none&format=ndjson", TARGETS[0]), "/end"),
        ("/v1/scenes?end=none".to_owned(), "/end"),
    ] {
        let problem = server.get(&target).await.expect(422);
        assert!(problem.pointers() == [pointer] && problem.text().contains("gone since 0.3"), "{}", problem.text());
    }
    let post = server.post("/v1/stability?format=ndjson&end=none", &json!({"preset": "case-1"})).await.expect(422);
    assert!(post.text().contains("gone since 0.3"), "{}", post.text());
    let dial = server.get("/v1/stability?preset=case-1&dial=true").await.expect(422);
    assert!(dial.pointers() == ["/dial"] && dial.text().contains("`format=svg` draws it"), "{}", dial.text());
}

// PNG pictures: the drawing of the SVG, with the same bytes everywhere, and an answer like any other.

const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.6&x.to=1.4&x.count=8\
                   &y.field=release.theta&y.from=0.02&y.to=0.08&y.count=4&bounces=300";

const PICTURED: [&str; 9] = [
    MAP,
    "/v1/trajectories?preset=case-1",
    "/v1/stability?preset=case-4",
    "/v1/controllers?preset=case-1",
    "/v1/periodic-orbits?preset=case-1&family=symmetric&theta=0.05&sweep.field=table.tilt_gain&sweep.from=1.4\
     &sweep.to=1.7&sweep.points=20",
    "/v1/failures/order-three",
    "/v1/ensembles?preset=case-1-noise&runs=50",
    "/v1/catches?preset=case-1&scene.release.theta=0.1&strategy=bounce_down",
    "/v1/throws?preset=case-1&apex.height=0.3&apex.theta=0.1",
];

fn formatted(target: &str, format: &str) -> String {
    format!("{target}{}format={format}", if target.contains('?') { '&' } else { '?' })
}

/// Width, height and the pixels, four bytes each.
fn decoded(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut pixels).expect("all pixels");
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
    (frame.width as usize, frame.height as usize, pixels)
}

#[tokio::test]
async fn pixels_are_the_drawing_at_its_own_size() {
    let server = Server::start();
    for target in PICTURED {
        let drawing = server.get(&formatted(target, "svg")).await.expect(200);
        let picture = server.get(&formatted(target, "png")).await.expect(200);
        assert_eq!(picture.media_type(), "image/png");
        let (width, height, pixels) = decoded(&picture.raw);
        let root = roxmltree::Document::parse(drawing.text()).unwrap();
        let size = |name| root.root_element().attribute(name).unwrap().parse::<f64>().unwrap();
        assert!((width as f64 - size("width")).abs() < 1.0 && (height as f64 - size("height")).abs() < 1.0, "{target}");
        let at = |x: usize, y: usize| &pixels[4 * (y * width + x)..][..4];
        assert_eq!(at(width / 2, 4), [255; 4], "{target}: paper");
        assert_eq!(at(0, 0)[3], 0, "{target}: nothing outside of its rounded corner");
        // The title has dark pixels, so text is drawn.
        let dark = (20..44).flat_map(|y| (28..300).map(move |x| (x, y))).filter(|(x, y)| at(*x, *y)[0] < 90).count();
        assert!(dark > 200, "{target}: {dark} dark pixels in the title");
    }
}

#[tokio::test]
async fn every_cell_has_its_colour() {
    let server = Server::start();
    let map = server.get(MAP).await.expect(200).json();
    let drawing = server.get(&format!("{MAP}&format=svg")).await.expect(200);
    let (width, _, pixels) = decoded(&server.get(&format!("{MAP}&format=png")).await.expect(200).raw);
    // Place of the cells in the drawing: matrix(width 0 0 -height left bottom).
    let place = drawing.text().split("matrix(").nth(1).unwrap().split(')').next().unwrap();
    let place: Vec<f64> = place.split(' ').map(|number| number.parse().unwrap()).collect();
    let (mut completed, mut fell) = (0, 0);
    for row in 0..4 {
        for column in 0..8 {
            let x = place[4] + (column as f64 + 0.5) * place[0];
            let y = place[5] + (row as f64 + 0.5) * place[3];
            let pixel = &pixels[4 * (y as usize * width + x as usize)..][..4];
            let value = map["values"][row][column].as_u64().unwrap();
            if value == 300 {
                completed += 1;
                assert_eq!(pixel, [0xfe, 0xe8, 0x38, 0xff], "{row} {column}");
            } else {
                fell += 1;
                assert!(value < 100 && pixel[2] > pixel[0], "{row} {column}: {value} is {pixel:?}");
            }
        }
    }
    assert!(completed > 5 && fell > 5, "{completed} {fell}");
}

#[tokio::test]
async fn the_same_picture_is_the_same_bytes_and_is_not_compressed_again() {
    for target in PICTURED {
        let target = formatted(target, "png");
        let (server, other) = (Server::start(), Server::start());
        let one = server.get(&target).await.expect(200);
        let two = other.get_with(&target, &[("accept-encoding", "gzip")]).await.expect(200);
        assert_eq!((&one.raw, one.etag()), (&two.raw, two.etag()), "{target}");
        assert_eq!(two.header("content-encoding"), None, "{target}");
        server.get_with(&target, &[("if-none-match", one.etag())]).await.expect(304);
        let head = server.send(Method::HEAD, &target, &[], "").await.expect(200);
        assert_eq!(head.header("etag"), one.header("etag"), "{target}");
        assert_eq!(head.header("content-type"), Some("image/png"), "{target}");
    }
}

#[tokio::test]
async fn an_image_may_ask_by_accept_and_a_matrix_has_no_picture() {
    let server = Server::start();
    let asked = server.get_with(MAP, &[("accept", "image/png")]).await.expect(200);
    assert_eq!(asked.media_type(), "image/png");
    // In the Accept header of an <img>, SVG is the closest match.
    let image = server.get_with(MAP, &[("accept", "image/avif,image/svg+xml,image/*,*/*;q=0.8")]).await.expect(200);
    assert_eq!(image.media_type(), "image/svg+xml");
    server.get("/v1/jacobians?preset=case-1&format=png").await.expect(406);
    server.get("/v1/periodic-orbits?preset=case-1&period=1&format=png").await.expect(422);
}

#[tokio::test]
async fn what_a_mean_hides_is_counted() {
    let server = Server::start();
    // Each drawn cell stands for two cells.
    let target = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1.3&x.to=1.6&x.count=1024\
                  &y.field=release.theta&y.from=0.15&y.to=0.15&y.count=1&bounces=40";
    let map = server.get(target).await.expect(200).json();
    let outcomes = map["outcomes"][0].as_array().unwrap();
    let mixed = outcomes.chunks(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(mixed > 0 && mixed < 512, "{mixed}");
    let drawing = server.get(&formatted(target, "svg")).await.expect(200);
    assert!(drawing.text().contains(&format!("Mixed are {mixed}: ")), "{mixed}: {}", drawing.text());
}
