//! Extreme and invalid scenes: each gets an answer or a 422, never a panic, a hang, NaN or infinity.

use std::time::Duration;

use crate::support::Server;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;
use serde_json::{Map, Value, json};

const SCENES: u64 = 10_000;

/// A source of random scenes.
struct Draw(SplitMix64);

impl Draw {
    fn below(&mut self, limit: u64) -> u64 {
        self.0.random_range(..limit)
    }

    fn unit(&mut self) -> f64 {
        self.0.random()
    }

    /// A value of a field of `GET /v1/fields`: mostly within its range, often at an end of it, sometimes anything.
    fn value(&mut self, field: &Value) -> Value {
        if self.0.random_bool(0.02) {
            let exponent = self.unit() * 600.0 - 300.0;
            let wild =
                [json!(10_f64.powf(exponent)), json!(-10_f64.powf(exponent)), json!("nonsense"), json!([1]), json!({})];
            return wild[self.below(5) as usize].clone();
        }
        match field["kind"].as_str().unwrap() {
            "number" => {
                let (low, high) = (field["minimum"].as_f64().unwrap(), field["maximum"].as_f64().unwrap());
                match self.below(8) {
                    0 => json!(low),
                    1 => json!(high),
                    2 => json!(low + (high - low) * 1e-12),
                    3..=5 => json!((low + (high - low) * self.unit().powi(4)).clamp(low, high)),
                    _ => json!((low + (high - low) * self.unit()).clamp(low, high)),
                }
            }
            "integer" => json!(self.below(field["maximum"].as_u64().unwrap())),
            "choice" => {
                let choices = field["choices"].as_array().unwrap();
                choices[self.below(choices.len() as u64) as usize].clone()
            }
            _ => json!(true),
        }
    }

    /// A scene with some of its fields.
    fn scene(&mut self, fields: &[Value]) -> Value {
        let mut scene = json!({});
        for field in fields {
            let path = field["field"].as_str().unwrap();
            if field["kind"] == "vertices" {
                continue;
            }
            let wanted = match (field["required"] == json!(true), path) {
                (_, "body.point") => 0.05,
                // Without vertices this is an error.
                (_, "body.contact_vertex") => 0.01,
                (true, _) => 0.99,
                // State feedback takes the place of the tilt gain; mostly one of the two is an error.
                _ if path.starts_with("table.feedback") => 0.01,
                _ if path.starts_with("table.limits") => 0.05,
                _ => 0.4,
            };
            if self.0.random_bool(wanted) {
                put(&mut scene, path, self.value(field));
            }
        }
        // Otherwise most random releases would lie below the table.
        if self.0.random_bool(0.8) && scene.pointer("/body/contact_distance").is_some() {
            put(&mut scene, "release.height", json!(10.0 + 20.0 * self.unit()));
        }
        if self.0.random_bool(0.15) {
            scene["body"] = self.polygon();
        }
        scene
    }

    /// Mostly a star-shaped polygon, sometimes arbitrary points.
    fn polygon(&mut self) -> Value {
        let count = 3 + self.below(30);
        let size = 10_f64.powf(-3.0 * self.unit());
        let wild = self.0.random_bool(0.3);
        let places: Vec<Value> = (0..count)
            .map(|vertex| {
                if wild {
                    return json!([20.0 * self.unit() - 10.0, 20.0 * self.unit() - 10.0]);
                }
                let angle = std::f64::consts::TAU * (vertex as f64 + 0.9 * self.unit()) / count as f64;
                let radius = size * (0.2 + self.unit());
                json!([radius * angle.cos(), radius * angle.sin()])
            })
            .collect();
        if self.0.random_bool(0.5) {
            return json!({"vertices": places});
        }
        json!({"vertices": places, "contact_vertex": self.below(count + 1)})
    }
}

fn put(scene: &mut Value, path: &str, value: Value) {
    let mut at = scene;
    for part in path.split('.') {
        at = at.as_object_mut().unwrap().entry(part).or_insert_with(|| Value::Object(Map::new()));
    }
    *at = value;
}

#[tokio::test]
async fn ten_thousand_random_scenes_are_answered() {
    let server = Server::start();
    let fields = server.get("/v1/fields").await.json()["items"].as_array().unwrap().clone();
    let mut draw = Draw(SplitMix64::seed_from_u64(1));
    let mut answered = std::collections::BTreeMap::<String, u64>::new();
    for _ in 0..SCENES {
        let scene = draw.scene(&fields);
        let request = json!({"scene": scene, "bounces": 1 + draw.below(300)});
        let answer = tokio::time::timeout(Duration::from_secs(60), server.post("/v1/trajectories", &request)).await;
        let answer = answer.unwrap_or_else(|_| panic!("no answer to {request}"));
        match answer.status.as_u16() {
            200 => {
                let kind = answer.json()["outcome"]["kind"].as_str().unwrap().to_owned();
                *answered.entry(kind).or_default() += 1;
                let text = String::from_utf8(answer.body.clone()).unwrap();
                assert!(!text.contains("NaN") && !text.contains("inf"), "{request}");
                for column in ["t", "x", "theta", "x_dot", "y_dot", "alpha", "energy", "contact_velocity"] {
                    let cells = answer.json()["impacts"][column].clone();
                    assert!(cells.as_array().unwrap().iter().all(Value::is_number), "{column} of {request}");
                }
            }
            422 => *answered.entry("422".to_owned()).or_default() += 1,
            other => panic!("{other} to {request}"),
        }
    }
    println!("{answered:?}");
    let outcomes = ["completed", "toppled", "separating", "sinking", "settled", "diverged", "other_vertex", "422"];
    for outcome in outcomes {
        assert!(answered.contains_key(outcome), "no scene ended as {outcome}: {answered:?}");
    }
}

/// A body that spins fast in little gravity, over a nearly vertical planned table. Half of its flights once took 30 ms; 20,000 of them
/// are one block.
#[tokio::test]
async fn scenes_as_dear_as_scenes_can_be_cost_what_others_do() {
    let scene = json!({
        "gravity": 0.1, "incline": 0.01,
        "body": {"contact_distance": 1, "radius_of_gyration": 1},
        "release": {"height": 100, "theta_dot": 164.18, "x_dot": 59.06, "y_dot": 100},
        "table": {"tilt_gain": -46.3055},
        "topple_angle": std::f64::consts::PI,
        "noise": {"model": "plan", "timing_sd": 0.01, "angle_sd": 0.01, "seed": 1},
    });
    let server = Server::start();
    let begin = std::time::Instant::now();
    let ensemble = server.post("/v1/ensembles", &json!({"scene": scene, "runs": 20_000, "bounces": 1})).await;
    let counts = ensemble.expect(200).json()["counts"].clone();
    assert_eq!(counts["diverged"], 0, "{counts}");
    println!("20,000 runs in {:.2} s: {counts}", begin.elapsed().as_secs_f64());
    assert!(begin.elapsed() < Duration::from_secs(30), "they took {:?}", begin.elapsed());
}

#[tokio::test]
async fn ensembles_of_random_scenes_are_answered() {
    let server = Server::start();
    let fields = server.get("/v1/fields").await.json()["items"].as_array().unwrap().clone();
    let mut draw = Draw(SplitMix64::seed_from_u64(2));
    let mut outcomes = std::collections::BTreeSet::new();
    for _ in 0..SCENES / 5 {
        let (runs, impacts) = (1 + draw.below(6), 1 + draw.below(200));
        let request =
            json!({"scene": draw.scene(&fields), "runs": runs, "bounces": impacts, "seed": draw.below(1 << 53)});
        let answer = tokio::time::timeout(Duration::from_secs(60), server.post("/v1/ensembles", &request)).await;
        let answer = answer.unwrap_or_else(|_| panic!("no answer to {request}"));
        assert!(matches!(answer.status.as_u16(), 200 | 422), "{} to {request}", answer.status);
        if answer.status == 200 {
            let counts = answer.json()["counts"].as_object().unwrap().clone();
            assert_eq!(counts.values().filter_map(Value::as_u64).sum::<u64>(), runs, "{request}");
            outcomes.extend(counts.into_iter().filter(|(_, count)| *count != json!(0)).map(|(name, _)| name));
        }
    }
    println!("{outcomes:?}");
    assert!(["completed", "toppled", "separating", "sinking", "missed"].iter().all(|name| outcomes.contains(*name)));
}
