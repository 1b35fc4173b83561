//! Friction over HTTP: derivatives with their sides.

mod support;

use serde_json::json;
use support::Server;

#[tokio::test]
async fn a_derivative_names_what_the_contact_does() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.3&scene.table.slide=matched&scene.release.theta=0.05";
    let exact = server.get(&format!("/v1/jacobians?{rough}&at.impact=5&period=3")).await.json();
    assert_eq!(
        (&exact["contact_mode"], &exact["smooth"], &exact["one_sided"]),
        (&json!("stick"), &json!(true), &json!([]))
    );
    let differences =
        server.get(&format!("/v1/jacobians?{rough}&at.impact=5&period=3&method=finite_difference")).await.json();
    for row in 0..4 {
        for column in 0..4 {
            let entry = |answer: &serde_json::Value| answer["matrix"][row][column].as_f64().unwrap();
            assert!((entry(&exact) - entry(&differences)).abs() < 1e-6, "{exact} {differences}");
        }
    }
}

#[tokio::test]
async fn on_a_kink_both_sides_are_told() {
    let server = Server::start();
    // At rest along the table, where friction is too small to hold: v_t = cos α ẋ + sin α ẏ + l cos β θ̇ = 0.
    let (theta, y_dot, kappa, l) = (-0.4_f64, -1.5, 2.0, 0.4 / 3.0);
    let alpha = kappa * theta;
    let theta_dot = -alpha.sin() * y_dot / (l * (theta - alpha).cos());
    let body = json!({
        "preset": "case-1",
        "scene": {"contact": {"friction": 0.05}, "table": {"tilt_gain": kappa}},
        "at": {"state": {"theta": theta, "y_dot": y_dot, "theta_dot": theta_dot}},
    });
    let answer = server.post("/v1/jacobians", &body).await.json();
    assert_eq!(answer["smooth"], false, "{answer}");
    let sides = answer["one_sided"].as_array().unwrap();
    let mut modes: Vec<_> = sides.iter().map(|side| side["contact_mode"].as_str().unwrap()).collect();
    modes.sort_unstable();
    assert_eq!(modes, ["reverse_slide", "slide"]);
    assert_eq!(answer["matrix"], sides[0]["matrix"]);
    assert_ne!(sides[0]["matrix"], sides[1]["matrix"]);
    assert_eq!(sides[1]["eigenvalues"].as_array().unwrap().len(), 4);
}
