//! Presets with friction: each does what its description says.

use crate::margins;
use crate::support::Server;
use serde_json::{Value, json};

const RIGS: [&str; 5] = ["rough-matched", "rough-feedback", "rough-noise", "rough-catch", "rough-juggling"];

fn numbers(column: &Value) -> Vec<f64> {
    column.as_array().expect("a column").iter().map(|value| value.as_f64().expect("a number")).collect()
}

#[tokio::test]
async fn every_rig_has_friction_and_bounces_on() {
    let server = Server::start();
    for rig in RIGS {
        let listed = server.get(&format!("/v1/scenes/{rig}")).await.expect(200).json();
        assert_eq!(listed["scene"]["contact"]["friction"], 0.3, "{rig}");
        let run = server.get(&format!("/v1/trajectories?preset={rig}&bounces=20000")).await.expect(200).json();
        assert_eq!(run["outcome"]["kind"], "completed", "{rig}: {}", run["outcome"]);
    }
}

#[tokio::test]
async fn verdicts_are_those_that_are_told() {
    let server = Server::start();
    let matched = server.get("/v1/stability?preset=rough-matched").await.expect(200).json();
    assert_eq!(matched["verdict"]["text"], "elliptic, 2000 bounces survived");
    // 1 + G(ρ² + l²)/(V²l), and without friction 1 + Gρ²/(V²l).
    let [l, height] = [0.4 / 3.0, 0.2];
    for (friction, extra) in [("0.3", l * l), ("0", 0.0)] {
        let scene = format!("preset=rough-matched&scene.contact.friction={friction}&scene.table.tilt_gain=1.2");
        let linear = server.get(&format!("/v1/stability?{scene}&bounces=10")).await.expect(200).json();
        let critical = 1.0 + (2.0 / 225.0 + extra) / (2.0 * (height - l) * l);
        assert!((margins::critical(&linear).as_f64().unwrap() - critical).abs() < 1e-9, "{linear}");
    }
    let still = server.get("/v1/trajectories?preset=rough-matched&scene.table.slide=none").await.expect(200).json();
    assert_ne!(still["outcome"]["kind"], "completed");
    assert!(still["outcome"]["bounces"].as_u64().unwrap() <= 10, "{}", still["outcome"]);
    for rig in ["rough-feedback", "rough-catch"] {
        let stable = server.get(&format!("/v1/stability?preset={rig}")).await.expect(200).json();
        assert_eq!(stable["verdict"]["text"], "stable in place", "{rig}");
        let run = server.get(&format!("/v1/trajectories?preset={rig}&bounces=1000")).await.expect(200).json();
        for column in ["x", "theta", "x_dot", "theta_dot"] {
            let last = numbers(&run["impacts"][column])[999];
            assert!(last.abs() < 1e-9, "{rig}: {column} is {last} after 1000 impacts");
        }
    }
}

#[tokio::test]
async fn feedback_is_that_of_the_controllers() {
    let server = Server::start();
    for (rig, places) in [("rough-feedback", 1e-1), ("rough-noise", 1e-2), ("rough-juggling", 1e-2)] {
        let listed = server.get(&format!("/v1/scenes/{rig}")).await.expect(200).json();
        let mut scene = listed["scene"].clone();
        let typed = scene["table"].as_object_mut().unwrap().remove("feedback").unwrap();
        scene["table"].as_object_mut().unwrap().remove("program");
        scene["table"]["target_height"] = scene["release"]["height"].clone();
        scene["noise"] = Value::Null;
        if scene["table"]["energy_gain"] == 0.0 {
            scene["table"].as_object_mut().unwrap().remove("target_height");
        }
        let designed =
            server.post("/v1/controllers", &json!({"scene": scene, "contact": "stick"})).await.expect(200).json();
        for (name, gain) in designed["gain"].as_object().unwrap() {
            let (gain, typed) = (gain.as_f64().unwrap(), typed[name].as_f64().unwrap());
            assert!((gain - typed).abs() <= places * gain.abs(), "{rig}: {name} is {typed}, designed {gain}");
        }
    }
}

#[tokio::test]
async fn rigs_with_noise_survive() {
    let server = Server::start();
    for rig in ["rough-noise", "rough-juggling"] {
        let target = format!("/v1/ensembles?preset={rig}&runs=1000&bounces=2000&seed=1");
        let runs = server.get(&target).await.expect(200).json();
        assert_eq!(runs["counts"]["completed"], 1000, "{rig}: {}", runs["counts"]);
    }
}

#[tokio::test]
async fn the_rig_to_catch_on_is_caught_from_its_release_and_from_its_bounces() {
    let server = Server::start();
    let caught = server.get("/v1/catches?preset=rough-catch").await.expect(200).json();
    assert_eq!(caught["outcome"]["kind"], "held", "{}", caught["outcome"]);
    let demand = |name: &str| caught["demand"][name].as_f64().unwrap();
    assert!(demand("tilt") <= 0.35 && demand("speed") <= 1.0 && demand("stroke") <= 0.03, "{}", caught["demand"]);
    for impact in [1, 2, 3, 5, 8, 20, 100, 500] {
        let request = json!({
            "preset": "rough-catch",
            "bounces": impact + 100,
            "interventions": [{"impact": impact, "catch": {}}],
        });
        let run = server.post("/v1/trajectories", &request).await.expect(200).json();
        assert_eq!(run["outcome"]["kind"], "held", "from impact {impact}: {}", run["outcome"]);
    }
}

#[tokio::test]
async fn the_juggling_rig_alternates_between_its_heights() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=rough-juggling&bounces=2000").await.expect(200).json();
    let heights: Vec<f64> = numbers(&run["impacts"]["energy"]).iter().map(|energy| energy / 9.81).collect();
    let mean = |parity: usize| {
        let of: Vec<f64> = heights.iter().skip(100 + parity).step_by(2).copied().collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    let (low, high) = (mean(0).min(mean(1)), mean(0).max(mean(1)));
    assert!((low - 0.21).abs() < 0.005 && (high - 0.27).abs() < 0.005, "{low} m and {high} m");
}
