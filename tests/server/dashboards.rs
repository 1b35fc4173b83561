//! The files of `docs/dashboards` against the server: every request of a dashboard gets an answer that it can read.
//!
//! `tests/dashboards/run` runs the real programs, if they are installed.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use axum::http::Method;
use equipoise::config::Config;
use serde_json::{Map, Value, json};

use crate::support::tables::Table;
use crate::support::{Answer, Server};
use crate::verdict::margin;

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

// A verdict that Prometheus scrapes: the gauges are the numbers of the JSON answer, and `/v1/probe` gives those of a query.

/// The header of Prometheus 2.42.
const PROMETHEUS: &str = "application/openmetrics-text;version=1.0.0,application/openmetrics-text;version=0.0.1;q=0.75,text/plain;version=0.0.4;q=0.5,*/*;q=0.1";

/// Samples by name and labels. Each family has its help, type and unit before its samples.
fn samples(answer: &Answer) -> BTreeMap<String, f64> {
    assert_eq!(answer.header("content-type"), Some("application/openmetrics-text; version=1.0.0; charset=utf-8"));
    let text = answer.text();
    assert!(text.ends_with("\n# EOF\n"), "{text}");
    let mut found = BTreeMap::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (name, value) = line.rsplit_once(' ').unwrap();
        let family = name.split('{').next().unwrap();
        assert!(text.contains(&format!("# TYPE {family} gauge\n")), "{line} has no type");
        assert!(text.contains(&format!("# HELP {family} ")), "{line} has no help");
        let before =
            found.insert(name.strip_prefix("equipoise_").unwrap().replace("stability_", ""), value.parse().unwrap());
        assert_eq!(before, None, "{line} is there twice");
    }
    found
}

/// Gauges, and pointers into the JSON answer.
const GAUGES: [(&str, &str); 11] = [
    ("energy_eigenvalue", "/linear/energy_eigenvalue"),
    ("residue", "/linear/residue"),
    ("rotation_radians", "/linear/rotation"),
    ("spectral_radius", "/linear/spectral_radius"),
    ("boundary_coefficient", "/boundary/coefficient"),
    ("lyapunov_coefficient_per_rad2", "/lyapunov/coefficient"),
    ("escape_bounces", "/lyapunov/escape_bounces"),
    ("drift_speed_meters_per_second", "/drift_speed"),
    ("run_bounces", "/nonlinear/outcome/bounces"),
    ("run_duration_seconds", "/nonlinear/outcome/t"),
    ("run_max_theta_radians", "/nonlinear/max_theta"),
];

#[tokio::test]
async fn gauges_are_the_numbers_of_the_answer() {
    let server = Server::start();
    let mut seen = BTreeMap::new();
    for query in ["case-1", "case-4", "case-1-noise", "critical-hard", "point-mass", "still-lossy"] {
        let target = format!("/v1/stability?preset={query}&bounces=300");
        let json = server.get(&target).await.expect(200).json();
        let gauges = samples(&server.get(&format!("{target}&format=openmetrics")).await.expect(200));
        for (name, pointer) in GAUGES {
            // Every digit arrives; a quantity that the scene does not have has no gauge.
            let expected = json.pointer(pointer).and_then(Value::as_f64);
            assert_eq!(gauges.get(name).copied(), expected, "{query}: {name}");
            seen.entry(name).and_modify(|seen| *seen |= expected.is_some()).or_insert(expected.is_some());
        }
        for (name, field) in [("tilt_gain", "table.tilt_gain"), ("energy_gain_s2_per_m2", "table.energy_gain")] {
            let margin = margin(&json, field);
            assert_eq!(gauges.get(name).copied(), margin["value"].as_f64(), "{query}: {name}");
            for side in ["below", "above"] {
                let labels = format!("{{field=\"{field}\",side=\"{side}\",of=\"small\",unit={}}}", margin["unit"]);
                for (gauge, number) in [("margin", "margin"), ("margin_limit", "limit"), ("margin_least", "least")] {
                    let found = gauges.get(&format!("{gauge}{labels}")).copied();
                    assert_eq!(found, margin[side][number].as_f64(), "{query}: {gauge}{labels}");
                }
            }
        }
        let survived = f64::from(u8::from(json["nonlinear"]["outcome"]["kind"] == "completed"));
        assert_eq!(gauges["run_survived"], survived, "{query}");
        assert_eq!(gauges.get("agree").copied(), json["agree"].as_bool().map(|it| f64::from(u8::from(it))), "{query}");
        for (family, label, pointer, all) in
            [("verdict", "verdict_code", "/verdict/code", 8), ("linear_kind", "kind", "/linear/kind", 4)]
        {
            let members: Vec<_> = gauges.iter().filter(|(name, _)| name.starts_with(&format!("{family}{{"))).collect();
            let Some(holds) = json.pointer(pointer).and_then(Value::as_str) else {
                assert!(members.is_empty(), "{query}: {members:?}");
                continue;
            };
            assert_eq!(members.len(), all, "{query}: {members:?}");
            assert_eq!(members.iter().map(|(_, value)| **value).sum::<f64>(), 1.0, "{query}: {members:?}");
            assert_eq!(gauges[&format!("{family}{{{label}=\"{holds}\"}}")], 1.0, "{query}: {members:?}");
        }
    }
    assert!(seen.values().all(|seen| *seen), "never shown: {seen:?}");
}

#[tokio::test]
async fn prometheus_gets_open_metrics_and_others_get_json() {
    let server = Server::start();
    let target = "/v1/stability?preset=case-1&bounces=100";
    let asked = server.get(&format!("{target}&format=openmetrics")).await.expect(200);
    let negotiated = server.get_with(target, &[("accept", PROMETHEUS)]).await.expect(200);
    assert_eq!((negotiated.text(), negotiated.etag()), (asked.text(), asked.etag()));
    for accept in ["*/*", "application/*", "application/json;q=0.9,text/plain"] {
        let answer = server.get_with(target, &[("accept", accept)]).await.expect(200);
        assert_eq!(answer.media_type(), "application/json", "{accept}");
    }
    server.get("/v1/trajectories?preset=case-1&format=openmetrics").await.expect(406);
}

#[tokio::test]
async fn a_probe_is_the_verdict_on_its_target() {
    let server = Server::start();
    let direct = server.get("/v1/stability?preset=case-1&bounces=100&format=openmetrics").await.expect(200);
    for target in ["preset%3Dcase-1%26bounces%3D100", "bounces%3D100%26preset%3Dcase-1&format=openmetrics"] {
        for accept in [PROMETHEUS, "*/*", "application/openmetrics-text"] {
            let probed =
                server.get_with(&format!("/v1/probe?target={target}"), &[("accept", accept)]).await.expect(200);
            assert_eq!((probed.text(), probed.etag()), (direct.text(), direct.etag()), "{target}, {accept}");
        }
    }
    // The older text format of Prometheus, for collectors that know no other.
    let target = "/v1/probe?target=preset%3Dcase-1%26bounces%3D100";
    let plain = server.get_with(target, &[("accept", "text/plain")]).await.expect(200);
    assert_eq!(plain.header("content-type"), Some("text/plain; version=0.0.4; charset=utf-8"));
    assert_eq!(plain.text(), server.get(&format!("{target}&format=prometheus")).await.expect(200).text());
    // Gauges have the same lines in both, but for the end.
    assert_eq!(plain.text(), direct.text().trim_end_matches("# EOF\n"));
    assert_ne!(plain.etag(), direct.etag());
    let held = direct.etag().to_owned();
    let again = [("if-none-match", held.as_str())];
    server.get_with("/v1/probe?target=preset%3Dcase-1%26bounces%3D100", &again).await.expect(304);
}

#[tokio::test]
async fn errors_of_a_target_are_below_it() {
    let server = Server::start();
    for (query, pointers) in [
        ("", vec!["/target"]),
        ("target=", vec!["/target"]),
        ("target=preset%3Dno-such", vec!["/target/preset"]),
        ("target=preset%3Dcase-1&color=red", vec!["/color"]),
        // The target is not encoded, so that its second part is a parameter of the probe.
        ("target=preset=case-1&bounces=100", vec!["/bounces"]),
        ("target=preset%3Dcase-1%26bounces%3D0%26color%3Dred", vec!["/target/bounces", "/target/color"]),
        ("target=preset%3Dcase-1%26scene.table.tilt_gain%3D5000", vec!["/target/scene/table/tilt_gain"]),
        ("target=preset%3Dcase-1%26format%3Djson", vec!["/target/format"]),
        ("target=a%3D%2525%26a%3D1", vec!["/target"]),
    ] {
        let problem = server.get(&format!("/v1/probe?{query}")).await.expect(422);
        let mut found = problem.pointers();
        found.sort();
        assert_eq!(found, pointers, "{query}");
    }
    server.get("/v1/probe?target=preset%3Dcase-1&format=json").await.expect(406);
}
