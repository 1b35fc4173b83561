//! The files of `docs/dashboards` against the server: every request of a dashboard gets an answer that it can read.
//!
//! `tests/dashboards/run` runs the real programs, if they are installed.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::csv::Table;
use crate::support::{Answer, Server};
use axum::http::Method;
use equipoise::config::Config;
use serde_json::{Map, Value, json};

const EPOCH: u64 = 1_763_675_170_123;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

fn shipped(name: &str) -> String {
    fs::read_to_string(folder().join("dashboards").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Replaces the variables that Grafana replaces before it sends a request.
fn filled_in(text: &str) -> String {
    text.replace("${tilt_gain}", "1.1").replace("${__from}", &EPOCH.to_string())
}

#[tokio::test]
async fn an_epoch_gives_every_row_its_time() {
    let server = Server::start();
    for query in ["preset=case-1", "preset=case-1&method=extended", "preset=still-lossy", "preset=point-mass"] {
        let target = format!("/v1/trajectories?{query}&bounces=40&samples_per_flight=3");
        let dated = format!("{target}&epoch_ms={EPOCH}");
        let (without, with) = (server.get(&target).await.expect(200), server.get(&dated).await.expect(200));
        assert_ne!(without.etag(), with.etag(), "{query}");
        let (without, mut with) = (without.json(), with.json());
        let mut columns = Vec::new();
        for table in ["impacts", "flights"] {
            let t = with[table]["t"].as_array().unwrap().clone();
            let time = with[table].as_object_mut().unwrap().remove("time_ms").unwrap();
            for (time, t) in time.as_array().unwrap().iter().zip(&t) {
                // Decimals with 32 digits are text.
                let t = t.as_f64().unwrap_or_else(|| t.as_str().unwrap().parse().unwrap());
                let error = time.as_u64().unwrap() as f64 - (EPOCH as f64 + 1e3 * t);
                assert!(error.abs() <= 0.5, "{query}: {table}: {time} is {error} ms off");
            }
            assert_eq!(time.as_array().unwrap().len(), t.len(), "{query}: {table}");
            columns.push(time);
        }
        assert_eq!(with, without, "{query}: all else is as without an epoch");
        let csv = server.get(&format!("{dated}&format=csv")).await.expect(200);
        let table = Table::parse(csv.text()).unwrap();
        assert_eq!(table.names[..3], ["n", "time_ms", "t_s"], "{query}");
        let cells: Vec<u64> = table.column("time_ms").iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(json!(cells), columns[0], "{query}");
        let ndjson = server.get(&format!("{dated}&format=ndjson")).await.expect(200);
        let lines: Vec<Value> = ndjson.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let times: Vec<&Value> = lines.iter().filter_map(|line| line.get("time_ms")).collect();
        assert_eq!(json!(times), columns[0], "{query}");
    }
}

#[tokio::test]
async fn an_epoch_is_a_date() {
    let server = Server::start();
    for epoch in ["-1", "0.5", "9007199254740992", "now"] {
        let target = format!("/v1/trajectories?preset=case-1&bounces=3&epoch_ms={epoch}");
        assert_eq!(server.get(&target).await.expect(422).pointers(), ["/epoch_ms"], "{epoch}");
    }
    for epoch in ["0", "9007199254740991"] {
        server.get(&format!("/v1/trajectories?preset=case-1&bounces=3&epoch_ms={epoch}")).await.expect(200);
    }
}

/// A query of Grafana's Infinity with its backend parser, as version 3.11 sends it.
async fn asked_by_infinity(server: &Server, query: &Value) -> Answer {
    let options = &query["url_options"];
    let accept = match query["type"].as_str() {
        Some("csv") => "text/csv; charset=utf-8",
        Some("json") => "application/json;q=0.9,text/plain",
        other => panic!("no panel has queries of type {other:?}"),
    };
    let mut headers = vec![("accept", accept), ("accept-encoding", "gzip"), ("user-agent", "Grafana/12.0")];
    let url = filled_in(query["url"].as_str().unwrap());
    let (path, parameters) = url.split_once('?').unwrap_or((&url, ""));
    // Go sorts the parameters of a query by name.
    let mut pairs: Vec<_> = form_urlencoded::parse(parameters.as_bytes()).collect();
    pairs.sort();
    let encoded = form_urlencoded::Serializer::new(String::new()).extend_pairs(pairs).finish();
    let target = if encoded.is_empty() { path.to_owned() } else { format!("{path}?{encoded}") };
    let method = options["method"].as_str().unwrap();
    let body = if method == "POST" {
        headers.push(("content-type", options["body_content_type"].as_str().expect("else it sends text/plain")));
        filled_in(options["data"].as_str().unwrap())
    } else {
        String::new()
    };
    let answer = server.send(method.parse().unwrap(), &target, &headers, &body).await.expect(200);
    assert_eq!(answer.header("content-encoding"), Some("gzip"), "{target}");
    answer
}

/// The rows that a root selector (GJSON) selects in an answer. `@group` turns an object of arrays into an array of objects.
fn rows(whole: &Value, selector: &str) -> Vec<Value> {
    let Some(path) = selector.strip_suffix(".@group") else {
        assert_eq!(selector, "", "a selector that this test does not know");
        return vec![whole.clone()];
    };
    let columns = whole[path].as_object().unwrap();
    let count = columns.values().map(|cells| cells.as_array().unwrap().len()).max().unwrap();
    let row = |index| columns.iter().map(|(name, cells)| (name.clone(), cells[index].clone())).collect::<Map<_, _>>();
    (0..count).map(|index| Value::Object(row(index))).collect()
}

/// The cells that a column of a panel shows.
fn cells(answer: &Answer, query: &Value, selector: &str) -> Vec<Value> {
    if query["type"] == "csv" {
        assert_eq!(answer.media_type(), "text/csv");
        let table = Table::parse(answer.text()).unwrap();
        return table.column(selector).into_iter().map(|cell| json!(cell)).collect();
    }
    assert_eq!(answer.media_type(), "application/json");
    let pointer = format!("/{}", selector.replace('.', "/"));
    let rows = rows(&answer.json(), query["root_selector"].as_str().unwrap());
    rows.iter().map(|row| row.pointer(&pointer).unwrap_or_else(|| panic!("no {selector} in {row}")).clone()).collect()
}

/// True if the backend parser accepts a value as a cell of this type.
fn is_read_as(kind: &str, cell: &Value) -> bool {
    match (kind, cell) {
        ("timestamp_epoch", Value::String(text)) => text.parse::<i64>().is_ok(),
        ("timestamp_epoch", cell) => cell.is_u64(),
        ("number", Value::String(text)) => text.parse::<f64>().is_ok(),
        ("number", cell) => cell.is_number(),
        ("string", cell) => cell.is_string(),
        _ => false,
    }
}

#[tokio::test]
async fn infinity_reads_what_the_panels_of_grafana_show() {
    let server = Server::start();
    let dashboard: Value = serde_json::from_str(&shipped("grafana/dashboards/equipoise.json")).unwrap();
    let source: Value = serde_saphyr::from_str(&shipped("grafana/datasources/equipoise.yaml")).unwrap();
    let mut types = std::collections::BTreeSet::new();
    for panel in dashboard["panels"].as_array().unwrap() {
        for query in panel["targets"].as_array().into_iter().flatten() {
            let title = &panel["title"];
            for name in ["uid", "type"] {
                assert_eq!(query["datasource"][name], source["datasources"][0][name], "{title}");
            }
            let answer = asked_by_infinity(&server, query).await;
            let columns = query["columns"].as_array().unwrap();
            assert!(!columns.is_empty(), "{title}");
            for column in columns {
                let (selector, kind) = (column["selector"].as_str().unwrap(), column["type"].as_str().unwrap());
                let cells = cells(&answer, query, selector);
                assert!(!cells.is_empty(), "{title}: {selector}");
                for cell in cells {
                    assert!(is_read_as(kind, &cell), "{title}: {selector}: {cell} is no {kind}");
                }
            }
            types.insert(format!("{} {}", query["type"], query["url_options"]["method"]));
        }
    }
    assert_eq!(types.len(), 3, "{types:?}");
}

/// The shipped files with their texts.
fn files(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push((path.display().to_string(), fs::read_to_string(&path).unwrap()));
        }
    }
}

#[tokio::test]
async fn every_address_in_the_files_is_answered() {
    const HOST: &str = "http://127.0.0.1:8080";
    let server = Server::start();
    let mut found = vec![("dashboards.md".to_owned(), fs::read_to_string(folder().join("dashboards.md")).unwrap())];
    files(&folder().join("dashboards"), &mut found);
    let embedding = Server::with(&Config { allow_embedding: true, ..Config::default() });
    let (mut count, mut shown_count) = (0, 0);
    for (file, text) in found {
        for (place, rest) in text.split(HOST).skip(1).enumerate() {
            let end = rest.find(|c: char| c.is_whitespace() || "\"'`)<>\\".contains(c)).unwrap_or(rest.len());
            let target = filled_in(&rest[..end]).replace("&amp;", "&");
            let target = if target.is_empty() { "/" } else { &target };
            // An event stream does not end, so only its head is requested.
            let method = if target.starts_with("/v1/live/events") { Method::HEAD } else { Method::GET };
            let answer = server.send(method, target, &[], "").await;
            assert_eq!(answer.status.as_u16(), 200, "{file}: {target}: {}", String::from_utf8_lossy(&answer.body));
            // The request of a browser for a picture or frame on a page of another site, with embedding allowed.
            let before = text.split(HOST).take(place + 1).last().unwrap_or_default();
            let shown = [("<img", "image"), ("<iframe", "iframe")]
                .into_iter()
                .find(|(tag, _)| before.rfind('<').is_some_and(|start| before[start..].starts_with(tag)));
            if let Some((_, destination)) = shown {
                let headers = [("sec-fetch-site", "cross-site"), ("sec-fetch-dest", destination)];
                embedding.get_with(target, &headers).await.expect(200);
                server.get_with(target, &headers).await.expect(403);
                shown_count += 1;
            }
            count += 1;
        }
    }
    assert!(count >= 8, "{count} addresses");
    assert_eq!(shown_count, 5, "pictures and frames");
}

#[tokio::test]
async fn plotjuggler_finds_its_curves_in_the_csv() {
    let text = shipped("plotjuggler/equipoise.xml");
    let layout = roxmltree::Document::parse(&text).unwrap();
    let guide = fs::read_to_string(folder().join("dashboards.md")).unwrap();
    let command = guide.lines().find(|line| line.contains("-o run.csv")).expect("how to get the file");
    let target = command.split("http://127.0.0.1:8080").nth(1).unwrap().trim_end_matches('\'');
    let csv = Server::start().get(target).await.expect(200);
    let table = Table::parse(csv.text()).unwrap();
    let mut curves = 0;
    for node in layout.descendants().filter(roxmltree::Node::is_element) {
        match node.tag_name().name() {
            "curve" => {
                // A curve in a plane has its own name and those of its two columns.
                let names = match (node.attribute("curve_x"), node.attribute("curve_y")) {
                    (Some(x), Some(y)) => vec![x, y],
                    _ => vec![node.attribute("name").unwrap()],
                };
                for name in names {
                    assert!(table.column(name).iter().any(|cell| cell.parse::<f64>().is_ok()), "{name}");
                }
                curves += 1;
            }
            "fileInfo" => assert_eq!(node.attribute("filename"), Some("run.csv")),
            "parameters" | "default" => {
                // PlotJuggler reads whole numbers in this range as milliseconds since 1970.
                let axis = table.column(node.attribute("time_axis").unwrap());
                let dates = axis.iter().map(|cell| cell.parse::<u64>().unwrap());
                assert!(dates.clone().all(|date| (1_400_000_000_000..2_000_000_000_000).contains(&date)));
                assert!(dates.is_sorted(), "{axis:?}");
            }
            _ => {}
        }
    }
    assert!(curves >= 4, "{curves} curves");
}

#[tokio::test]
async fn metrics_are_text_for_every_collector() {
    let server = Server::start();
    let prometheus = "application/openmetrics-text;version=1.0.0,application/openmetrics-text;version=0.0.1;q=0.75,\
                      text/plain;version=0.0.4;q=0.5,*/*;q=0.1";
    for (accept, media_type, end) in [
        (prometheus, "application/openmetrics-text", true),
        ("text/plain;version=0.0.4", "text/plain", false),
        ("*/*", "text/plain", false),
    ] {
        let answer = server.get_with("/metrics", &[("accept", accept)]).await.expect(200);
        assert_eq!(answer.media_type(), media_type, "{accept}");
        assert_eq!(answer.header("vary"), Some("Accept"), "{accept}");
        assert_eq!(answer.text().ends_with("# EOF\n"), end, "{accept}");
    }
}
