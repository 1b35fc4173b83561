//! Margins have one shape in all resources.

use serde_json::{Value, json};

use crate::support::Server;

/// The margins of a field for small deviations; null if it has none.
pub(crate) fn margin(answer: &Value, field: &str) -> Value {
    let all = answer["margins"].as_array().unwrap();
    all.iter().find(|margin| margin["field"] == field && margin["of"] == "small").cloned().unwrap_or_default()
}

/// The upper limit of the tilt gain.
pub(crate) fn critical(answer: &Value) -> Value {
    margin(answer, "table.tilt_gain")["above"]["limit"].clone()
}

/// The smallest of some margins.
fn smallest(margins: &Value) -> Option<f64> {
    let ends = margins.as_array().unwrap().iter().flat_map(|margin| [&margin["below"], &margin["above"]]);
    ends.filter(|end| end.is_object()).map(|end| end["margin"].as_f64().unwrap()).min_by(f64::total_cmp)
}

#[tokio::test]
async fn the_smallest_margin_is_found_in_the_same_way_everywhere() {
    let server = Server::start();
    let stability = server.get("/v1/stability?preset=case-1&bounces=50").await.expect(200).json();
    assert!((smallest(&stability["margins"]).unwrap() - 0.1).abs() < 1e-12, "{}", stability["margins"]);
    let law = server.get("/v1/controllers?preset=case-1").await.expect(200).json();
    let found = smallest(&law["margins"]).unwrap();
    assert!(found > 0.0 && found < 1.0, "{}", law["margins"]);
    // The law of the controller has the same margins as a scene.
    let fed = server.post("/v1/stability", &json!({"scene": law["scene"], "bounces": 50})).await.expect(200).json();
    let (one, other) = (&law["margins"][0], margin(&fed, "table.feedback"));
    for side in ["below", "above"] {
        let limit = |margin: &Value| margin[side]["limit"].as_f64();
        assert!((limit(one).unwrap_or(0.0) - limit(&other).unwrap_or(0.0)).abs() < 1e-6, "{one} {other}");
    }
    assert!(margin(&fed, "table.tilt_gain").is_null());
}

#[tokio::test]
async fn a_margin_is_the_distance_to_its_limit_and_negative_beyond() {
    let server = Server::start();
    for gain in [0.9, 1.1, 1.6] {
        let target = format!("/v1/stability?preset=case-1&bounces=10&scene.table.tilt_gain={gain}");
        let found = margin(&server.get(&target).await.expect(200).json(), "table.tilt_gain");
        for (side, sign) in [("below", 1.0), ("above", -1.0)] {
            let end = &found[side];
            assert_eq!(end["margin"].as_f64(), Some(sign * (gain - end["limit"].as_f64().unwrap())), "{gain}: {found}");
            assert!(end["least"].is_null(), "{found}");
        }
    }
}

#[tokio::test]
async fn an_old_name_is_refused_with_the_new_one() {
    let server = Server::start();
    let y = "y.field=release.theta&y.from=0&y.to=1&y.count=2";
    for (target, new) in [
        (
            format!("regions?preset=case-1&x.parameter=gravity&x.from=9&x.to=10&x.count=2&{y}"),
            "since 0.3 it is `field`",
        ),
        (
            "periodic-orbits?preset=case-1&sweep.parameter=gravity&sweep.from=9&sweep.to=10".to_owned(),
            "since 0.3 it is `field`",
        ),
        (
            "stability?preset=case-1&tolerances.0.parameter=gravity&tolerances.0.tolerance=1".to_owned(),
            "since 0.3 it is `field`",
        ),
        (
            "stability?preset=case-1&tolerances.restitution=0.01".to_owned(),
            "since 0.3 it is a list of {field, tolerance}",
        ),
        ("stability?preset=case-1&gain_margins=true".to_owned(), "since 0.3 it is `release_margins`"),
    ] {
        let refused = server.get(&format!("/v1/{target}")).await.expect(422);
        assert!(refused.text().contains(new), "{target}: {}", refused.text());
    }
}
