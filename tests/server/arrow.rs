//! Columns as an Arrow stream: the same bits as in JSON, with units, nulls and the rest of the answer, in batches of bounded length.

use std::io::Read;

use crate::support::Server;
use crate::support::arrow::Stream;
use crate::support::contract::DOCUMENT;
use axum::http::Method;
use equipoise::limits;
use serde_json::{Value, json};

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

/// True if two values are equal, numbers bit for bit.
fn same(one: &Value, other: &Value) -> bool {
    match (one.as_f64(), other.as_f64()) {
        (Some(one), Some(other)) => one.to_bits() == other.to_bits(),
        _ => one == other,
    }
}

/// A cell of CSV.
fn value(cell: &str) -> Value {
    if cell.is_empty() { Value::Null } else { serde_json::from_str(cell).unwrap_or_else(|_| json!(cell)) }
}

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
        let table = crate::support::csv::Table::parse(csv.text()).unwrap();
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
