//! A verdict that Prometheus scrapes: the gauges are the numbers of the JSON answer, and `/v1/probe` gives those of a query.

use std::collections::BTreeMap;

use crate::margins::margin;
use crate::support::{Answer, Server};
use serde_json::Value;

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
