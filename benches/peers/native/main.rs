//! The peers in Rust: equipoise's return map and rapier2d on the paper's case 1, timed with one clock. Each prints one line of JSON,
//! as the Python peers do, with the error that `../scene.py` defines. With the argument `--short` rapier2d leaves out its slowest settings.
//!
//! The Python peers and the table are made by `../run`.

use std::time::Instant;

use equipoise_physics::map::body::Release;
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use rapier2d_f64::prelude::*;
use serde_json::{Value, json};

const CASE_1: Rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.1);
const RULES: Rules = Rules { topple_angle: std::f64::consts::FRAC_PI_2, settles: false, holds_energy: true, limits: None, half_length: f64::INFINITY };
const RELEASE: Release =
    Release { x: 0.0, height: 0.2, state: State { theta: 0.3, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 } };
const IMPACTS: usize = 100;

/// t, x, θ, ẋ, ẏ, θ̇ just before an impact.
type Impact = [f64; 6];

fn main() {
    let reference: Value = serde_json::from_str(include_str!("../../../tests/reference/case-1.json")).expect("JSON");
    let setting = "the exact map, energy held";
    report(&reference, "equipoise", &version("equipoise-physics"), setting, 20_000, map);
    let steps: &[f64] =
        if std::env::args().any(|argument| argument == "--short") { &[1e-3] } else { &[1e-3, 1e-4, 1e-5] };
    for &step in steps {
        let setting = format!("step {step:?} s, double precision");
        report(&reference, "rapier2d", &version("rapier2d-f64"), &setting, 1, || engine(step));
    }
}

/// The version of a package in the lock file.
fn version(package: &str) -> String {
    let lock = include_str!("Cargo.lock");
    let entry = lock.split("[[package]]").find(|entry| entry.contains(&format!("name = \"{package}\"\n")));
    let version = entry.and_then(|entry| entry.split("version = \"").nth(1)?.split('"').next());
    version.unwrap_or("unknown").to_owned()
}

/// Runs a peer several times and prints its line: the best time, and its distance from the reference.
fn report(reference: &Value, name: &str, version: &str, setting: &str, rounds: u32, peer: impl Fn() -> Vec<Impact>) {
    let mut best = f64::INFINITY;
    let mut impacts = peer();
    for _ in 0..rounds {
        let begin = Instant::now();
        impacts = peer();
        best = best.min(begin.elapsed().as_nanos() as f64);
    }
    let error = |n: usize| {
        let impact = impacts.get(n - 1)?;
        let exact =
            |name: &str| reference["states"][name][n - 1].as_str().expect("digits").parse::<f64>().expect("a number");
        let rho = CASE_1.radius_of_gyration;
        let compared = [("theta", 2, rho), ("x_dot", 3, 1.0), ("y_dot", 4, 1.0), ("theta_dot", 5, rho)];
        Some(
            compared
                .map(|(name, place, length)| (impact[place] - exact(name)).abs() * length)
                .into_iter()
                .fold(0.0, f64::max),
        )
    };
    let line = json!({
        "name": name,
        "version": version,
        "setting": setting,
        "ns_per_bounce": best / impacts.len() as f64,
        "impacts": impacts.len(),
        "error_at_1": error(1),
        "error_at_10": error(10),
        "error_at_100": error(100),
    });
    println!("{line}");
}

fn map() -> Vec<Impact> {
    let mut impacts = Vec::with_capacity(IMPACTS);
    let mut orbit = Orbit::new(std::hint::black_box(CASE_1), RULES, &RELEASE).expect("a first contact");
    run(&mut orbit, IMPACTS as u64, |contact| {
        let State { theta, x_dot, y_dot, theta_dot } = contact.state;
        impacts.push([contact.t, contact.x, theta, x_dot, y_dot, theta_dot]);
        true
    });
    impacts
}

/// Longest time of a run, s.
const SECONDS: f64 = 30.0;

/// A ball at the rod's end on a half-space that is tilted before every step. An impact is a step in which more than gravity acts on a
/// falling contact point.
fn engine(dt: f64) -> Vec<Impact> {
    const RADIUS: f64 = 1e-3;
    let Rod { contact_distance: l, radius_of_gyration: rho, gravity, tilt_gain, .. } = CASE_1;
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -gravity);
    world.integration_parameters.dt = dt;
    let rod = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.0, RELEASE.height))
        .rotation(RELEASE.state.theta)
        .additional_mass_properties(MassProperties::new(Vector::new(0.0, 0.0), 1.0, rho * rho))
        .can_sleep(false)
        .build();
    let rod = world.bodies.insert(rod);
    let smooth = |collider: ColliderBuilder| collider.restitution(1.0).friction(0.0).density(0.0).build();
    let end = smooth(ColliderBuilder::ball(RADIUS).translation(Vector::new(0.0, -l)));
    world.colliders.insert_with_parent(end, rod, &mut world.bodies);
    let table = world.bodies.insert(RigidBodyBuilder::kinematic_position_based().build());
    let plane = smooth(ColliderBuilder::cuboid(5.0, 0.5).translation(Vector::new(0.0, -0.5 - RADIUS)));
    world.colliders.insert_with_parent(plane, table, &mut world.bodies);

    let pose = |world: &PhysicsWorld| {
        let rod = &world.bodies[rod];
        let (place, velocity) = (rod.translation(), rod.linvel());
        (place.y, [0.0, place.x, rod.rotation().angle(), velocity.x, velocity.y, rod.angvel()])
    };
    let mut impacts: Vec<Impact> = Vec::new();
    let (mut height, mut before) = pose(&world);
    for step in 0..(SECONDS / dt) as u32 {
        let [_, x, theta, x_dot, y_dot, theta_dot] = before;
        world.bodies[table].set_position(Pose::new(Vector::new(x + l * theta.sin(), 0.0), tilt_gain * theta), true);
        world.step();
        let (next_height, now) = pose(&world);
        let jump = (now[3] - x_dot).hypot(now[4] - y_dot + gravity * dt).hypot(rho * (now[5] - theta_dot));
        let t = f64::from(step) * dt;
        let falls = y_dot + l * theta_dot * theta.sin() < 0.0;
        // Later steps of the same strike do not count.
        let is_new = impacts.last().is_none_or(|last| t - last[0] > 0.02);
        if falls && is_new && jump > 20.0 * gravity * dt && height < 1.5 * l {
            impacts.push([t, x, theta, x_dot, y_dot, theta_dot]);
        }
        if impacts.len() == IMPACTS || next_height < -l || now[2].abs() > std::f64::consts::FRAC_PI_2 {
            break;
        }
        (height, before) = (next_height, now);
    }
    impacts
}
