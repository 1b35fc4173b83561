//! Random requests from a seed: every resource that computes, every model, scenes from the whole ranges of their fields.

use equipoise_physics::scene::{FIELDS, Field, FieldKind};
use rand::RngExt;
use rand_xoshiro::SplitMix64;
use serde_json::{Map, Value, json};

/// A source of random requests.
pub(crate) struct Draw(pub(crate) SplitMix64);

/// A request to a resource.
pub(crate) struct Request {
    pub(crate) body: Value,
    /// The requested media type.
    pub(crate) accept: &'static str,
    pub(crate) gzip: bool,
}

/// The resources that take a scene.
pub(crate) const RESOURCES: [&str; 13] = [
    "trajectories",
    "jacobians",
    "stability",
    "regions",
    "ensembles",
    "periodic-orbits",
    "controllers",
    "ladder",
    "precision",
    "previews",
    "catches",
    "throws",
    "fits",
];

const PRESETS: [&str; 15] = [
    "case-1",
    "case-1",
    "case-1",
    "case-2",
    "case-3",
    "case-4",
    "case-5",
    "case-1-noise",
    "point-mass",
    "still-lossy",
    "case-2-figure",
    "critical-hard",
    "case-4-noise",
    "triangle-polygon",
    "",
];

impl Draw {
    fn below(&mut self, limit: u64) -> u64 {
        self.0.random_range(..limit)
    }

    fn unit(&mut self) -> f64 {
        self.0.random()
    }

    fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len() as u64) as usize]
    }

    /// A whole number up to a limit, uniform in its logarithm.
    fn count(&mut self, limit: u64) -> u64 {
        ((limit as f64).powf(self.unit()).round() as u64).clamp(1, limit)
    }

    /// A value of a field: at an end of its range, anywhere in it, or of any size.
    fn value(&mut self, field: &Field) -> Value {
        match field.kind {
            FieldKind::Number { minimum, maximum } => {
                let anywhere = minimum + (maximum - minimum) * self.unit();
                let sized = 10_f64.powf(-12.0 * self.unit());
                match self.below(10) {
                    0 => json!(minimum),
                    1 => json!(maximum),
                    2..=4 => json!(anywhere),
                    5..=7 => json!((maximum * sized).clamp(minimum, maximum)),
                    _ => json!((minimum * sized).clamp(minimum, maximum)),
                }
            }
            FieldKind::Integer { maximum } => json!(self.below(maximum)),
            FieldKind::Choice(words) => json!(self.one_of(words)),
            FieldKind::Flag => json!(true),
            FieldKind::Numbers { minimum, maximum, most } => {
                let count = 1 + self.below(most as u64);
                (0..count).map(|_| json!(minimum + (maximum - minimum) * self.unit())).collect()
            }
        }
    }

    /// A preset with no to many changes. With fewer changes, runs last longer.
    fn scene(&mut self, request: &mut Map<String, Value>) {
        let preset = self.one_of(&PRESETS);
        let mut scene = json!({});
        if preset.is_empty() {
            put(&mut scene, "body.contact_distance", json!(10_f64.powf(1.0 - 4.0 * self.unit())));
            put(&mut scene, "body.radius_of_gyration", json!(10_f64.powf(1.0 - 4.0 * self.unit())));
            put(&mut scene, "release.height", json!(10.0 + 90.0 * self.unit()));
            put(&mut scene, "table.tilt_gain", json!(1.0 + self.unit()));
        } else {
            request.insert("preset".to_owned(), json!(preset));
        }
        let wild = self.one_of(&[0.0, 0.0, 0.03, 0.1, 0.4]);
        for field in &FIELDS {
            let rare = field.path.starts_with("body.") || field.path.starts_with("table.feedback");
            if self.0.random_bool(if rare { 0.1 * wild } else { wild }) {
                let value = self.value(field);
                put(&mut scene, field.path, value);
            }
        }
        // Near upright, so that runs last; and the models that no preset has.
        if self.0.random_bool(0.6) {
            put(&mut scene, "release.theta", json!(0.3 * 10_f64.powf(-9.0 * self.unit())));
        }
        if self.0.random_bool(0.2) {
            put(&mut scene, "contact.friction", json!(self.unit()));
            put(&mut scene, "contact.law", json!(self.one_of(&["poisson", "newton", "stronge"])));
            put(&mut scene, "table.slide", json!(self.one_of(&["matched", "matched", "none"])));
        }
        if self.0.random_bool(0.2) {
            put(&mut scene, "noise.timing_sd", json!(10_f64.powf(-1.0 - 8.0 * self.unit())));
            put(&mut scene, "noise.angle_sd", json!(10_f64.powf(-1.0 - 8.0 * self.unit())));
            put(&mut scene, "noise.model", json!(self.one_of(&["strike", "plan"])));
        }
        if self.0.random_bool(0.1) {
            // State feedback takes the place of the tilt gain.
            put(&mut scene, "table.tilt_gain", Value::Null);
            put(&mut scene, "table.feedback.theta", json!(-1.0 - 0.5 * self.unit()));
            put(&mut scene, "table.feedback.x", json!(self.one_of(&[0.0, 0.018])));
            put(&mut scene, "table.feedback.x_dot", json!(0.023 * self.unit()));
            put(&mut scene, "table.feedback.theta_dot", json!(-0.031 * self.unit()));
        }
        if self.0.random_bool(0.15) {
            scene["body"] = self.polygon();
        }
        request.insert("scene".to_owned(), scene);
    }

    fn polygon(&mut self) -> Value {
        let count = 3 + self.below(30);
        let size = 10_f64.powf(-1.0 - self.unit());
        let places: Vec<Value> = (0..count)
            .map(|vertex| {
                let angle = std::f64::consts::TAU * (vertex as f64 + 0.5) / count as f64;
                json!([size * angle.sin(), -size * angle.cos() * (0.9 + 0.1 * self.unit())])
            })
            .collect();
        json!({"vertices": places})
    }

    fn axis(&mut self, count: u64) -> Value {
        let side = self.one_of(&[
            ("table.tilt_gain", 0.95, 1.6),
            ("release.theta", 0.0, 0.5),
            ("release.theta", 0.0, 1e-3),
            ("release.theta_dot", -200.0, 200.0),
            ("release.height", 0.2, 100.0),
            ("contact.restitution", 0.0, 1.0),
            ("table.energy_gain", 0.0, 0.5),
            ("gravity", 0.1, 100.0),
            ("body.radius_of_gyration", 0.01, 1.0),
        ]);
        let (field, from, to) = side;
        json!({"field": field, "from": from, "to": to, "count": count})
    }

    /// A request to a resource, which may be refused.
    pub(crate) fn request(&mut self, resource: &str) -> Request {
        let mut body = Map::new();
        self.scene(&mut body);
        let mut set = |name: &str, value: Value| drop(body.insert(name.to_owned(), value));
        let mut formats = vec!["application/json", "application/json", "text/csv", "application/x-ndjson"];
        let pictures = ["image/svg+xml", "image/png"];
        match resource {
            "trajectories" => {
                set("bounces", json!(self.count(100_000)));
                match self.below(5) {
                    0 => {}
                    1 => set("tolerance", json!(10_f64.powf(-30.0 * self.unit()))),
                    _ => set("method", json!(self.one_of(&["map", "linear", "extended"]))),
                }
                if self.0.random_bool(0.3) {
                    set("samples_per_flight", json!(self.count(256)));
                }
                formats.extend(pictures);
            }
            "jacobians" => {
                match self.below(3) {
                    0 => set("at", json!({"impact": self.count(10_000)})),
                    1 => {
                        let [theta, x_dot, y_dot, theta_dot] = [1e-3, 1e-3, -3.0, 1e-3].map(|size| size * self.unit());
                        let state = json!({"theta": theta, "x_dot": x_dot, "y_dot": y_dot, "theta_dot": theta_dot});
                        set("at", json!({ "state": state }));
                    }
                    _ => {}
                }
                set("period", json!(self.count(1000)));
            }
            "stability" => {
                set("bounces", json!(self.count(100_000)));
                set("basin", json!(self.0.random_bool(0.3)));
                if self.0.random_bool(0.3) {
                    let off = 10_f64.powf(-3.0 * self.unit() - 0.5);
                    let fields = ["body.contact_distance", "body.radius_of_gyration", "contact.restitution"];
                    set("tolerances", json!(fields.map(|field| json!({"field": field, "tolerance": off}))));
                }
                formats.extend(pictures);
            }
            "regions" => {
                let (columns, rows) = (self.count(200), self.count(200));
                set("x", self.axis(columns));
                set("y", self.axis(rows));
                set("bounces", json!(self.count(3000)));
                let quantities = ["survival", "max_theta", "residue", "spectral_radius", "caught", "rest_time"];
                let quantity = self.one_of(&quantities);
                set("quantity", json!(quantity));
                if ["caught", "rest_time"].contains(&quantity) {
                    let strategy = self.one_of(&["auto", "bounce_down", "plan", "brake"]);
                    set("catch", json!({"strategy": strategy, "hold": 0.1 + 59.9 * self.unit()}));
                }
                formats.extend(pictures);
            }
            "ensembles" => {
                set("runs", json!(self.count(20_000)));
                set("bounces", json!(self.count(20_000)));
                set("angles", json!(self.0.random_bool(0.3)));
                formats.extend(pictures);
            }
            "periodic-orbits" => {
                set("period", json!(self.one_of(&[1, 2, 3, 4, 8, 16, 64])));
                if self.0.random_bool(0.6) {
                    let [theta, x_dot, y_dot, theta_dot] = [0.4, 0.3, -2.0, 2.0].map(|size| size * self.unit());
                    let guess = json!({"theta": theta, "x_dot": x_dot, "y_dot": y_dot, "theta_dot": theta_dot});
                    set("guess", guess);
                } else if self.0.random_bool(0.5) {
                    set("period", json!(2));
                    set("family", json!("symmetric"));
                    set("theta", json!(0.6 * self.unit()));
                }
                if self.0.random_bool(0.5) {
                    let (field, from, to) = self.one_of(&[
                        ("table.tilt_gain", 1.05, 1.9),
                        ("release.height", 0.2, 2.0),
                        ("gravity", 1.0, 50.0),
                        ("body.radius_of_gyration", 0.05, 0.5),
                    ]);
                    let points = 1 + self.count(1999);
                    set("sweep", json!({"field": field, "from": from, "to": to, "points": points}));
                    formats.extend(pictures);
                }
            }
            "precision" => {
                set("bounces", json!(self.count(1000)));
                let names = ["map", "map_free", "linear", "extended"];
                set("methods", json!([self.one_of(&names)]));
                formats.extend(pictures);
            }
            "previews" => {
                set("bounces", json!(self.count(10_000)));
                formats = vec!["application/json"];
                formats.extend(pictures);
            }
            "catches" => {
                let strategy = self.one_of(&["auto", "bounce_down", "plan", "brake"]);
                set("strategy", json!(strategy));
                set("hold", json!(0.1 + 59.9 * self.unit()));
                set("hold_samples", json!(self.count(600) + 1));
                formats.extend(pictures);
            }
            "throws" => {
                set("apex", json!({"height": 2.0 * self.unit(), "theta": 6.0 * self.unit() - 3.0}));
                if self.0.random_bool(0.5) {
                    set("impact", json!(self.count(1000)));
                }
                formats.extend(pictures);
            }
            "fits" => {
                set("measured", self.measured());
                set("unknown", self.unknown());
                if self.0.random_bool(0.5) {
                    set("sd", json!({"t": 1e-3, "theta": 2e-3}));
                }
                formats.extend(pictures);
            }
            "controllers" => {
                if self.0.random_bool(0.5) {
                    set("contact", json!(self.one_of(&["frictionless", "stick"])));
                }
                formats.extend(pictures);
            }
            _ => {
                set("bounces", json!(self.count(20_000)));
                set("tolerance", json!(1e-6));
            }
        }
        Request { body: Value::Object(body), accept: self.one_of(&formats), gzip: self.0.random_bool(0.5) }
    }
}

/// Fields that a fit may have to find.
const UNKNOWN: [&str; 8] = [
    "table.tilt_gain",
    "body.radius_of_gyration",
    "body.contact_distance",
    "gravity",
    "contact.friction",
    "contact.restitution",
    "release.theta",
    "table.errors.tilt_offset",
];

impl Draw {
    /// Impacts that swing, with noise. No scene need make them.
    fn measured(&mut self) -> Value {
        let (rows, gaps) = (2 + self.count(998), self.0.random_bool(0.2));
        let (flight, swing, turn) = (0.1 + 0.3 * self.unit(), 0.3 * self.unit(), 1.5 * self.unit());
        let noise = 10_f64.powf(-2.0 - 2.0 * self.unit());
        let mut n = 0;
        let (mut numbers, mut times, mut angles) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..rows {
            n += if gaps { self.count(20) } else { 1 };
            numbers.push(n);
            times.push(n as f64 * flight + 0.3 * flight * noise * self.unit());
            angles.push(swing * (n as f64 * turn).sin() + noise * (self.unit() - 0.5));
        }
        json!({"n": numbers, "t": times, "theta": angles})
    }

    fn unknown(&mut self) -> Value {
        let first = self.below(UNKNOWN.len() as u64) as usize;
        let count = self.count(UNKNOWN.len() as u64) as usize;
        (0..count).map(|place| json!(UNKNOWN[(first + place) % UNKNOWN.len()])).collect()
    }
}

/// Sets a field of a scene by its dotted path.
pub(crate) fn put(scene: &mut Value, path: &str, value: Value) {
    let mut at = scene;
    for part in path.split('.') {
        if !at.is_object() {
            *at = json!({});
        }
        at = at.as_object_mut().expect("an object").entry(part).or_insert(Value::Null);
    }
    *at = value;
}
