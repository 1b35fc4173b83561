//! Runs of polygons: those of the rod with the same l and ρ, bit for bit, until another vertex touches the table.

use crate::support::rig_runs::with_numbers;
use equipoise_physics::analysis::model_hierarchy::run_hierarchy;
use equipoise_physics::map::body::{Kick, Touch};
use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]];

/// A flat roof upside down: its ends come down long before it topples.
const WIDE: [[f64; 2]; 3] = [[0.0, 0.0], [0.15, 0.05], [-0.15, 0.05]];

fn draft(numbers: &[(Name, f64)]) -> Draft {
    with_numbers(Draft::default(), numbers)
}

/// The polygon, and the rod of its l and ρ.
fn pair(places: &[[f64; 2]], numbers: &[(Name, f64)]) -> (Scene, Scene) {
    let mut polygon = draft(numbers);
    polygon.set_vertices(Some(Vertices::new(places).unwrap()));
    let polygon = polygon.build().unwrap();
    let outline = *polygon.outline().unwrap();
    let lengths =
        [(Name::ContactDistance, outline.contact_distance()), (Name::RadiusOfGyration, outline.radius_of_gyration())];
    (polygon, draft(&[numbers, &lengths[..]].concat()).build().unwrap())
}

fn runs(scene: &Scene, impacts: u64) -> (Vec<[u64; 5]>, Ending) {
    let mut orbit = match scene.orbit() {
        Ok(orbit) => orbit,
        Err(no_contact) => return (Vec::new(), no_contact.ending(0.0, 0.0)),
    };
    let mut seen = Vec::new();
    let ending = run(&mut orbit, impacts, |contact| {
        let state = contact.state;
        seen.push([contact.t, state.theta, state.x_dot, state.y_dot, state.theta_dot].map(f64::to_bits));
        true
    });
    (seen, ending.unwrap())
}

#[test]
fn a_polygon_bounces_as_the_rod_until_another_vertex_touches() {
    let mut touched = 0;
    for places in [&TRIANGLE, &WIDE] {
        for theta in [0.0, 0.01, 0.05, 0.1, 0.2, 0.3] {
            for (spin, friction) in [(0.0, 0.0), (2.0, 0.0), (-40.0, 0.0), (0.5, 0.2)] {
                let numbers = [
                    (Name::Height, 0.5),
                    (Name::TiltGain, 1.1),
                    (Name::Theta, theta),
                    (Name::ThetaDot, spin),
                    (Name::Friction, friction),
                ];
                let (polygon, rod) = pair(places, &numbers);
                let (ours, ending) = runs(&polygon, 500);
                let (original, its) = runs(&rod, 500);
                assert_eq!(ours[..], original[..ours.len()], "{numbers:?}");
                match ending {
                    Ending::OtherVertex(_) => touched += 1,
                    ending => assert_eq!(ending, its),
                }
            }
        }
    }
    assert!((10..40).contains(&touched), "{touched}");
}

#[test]
fn a_wide_polygon_stops_where_the_rod_goes_on() {
    let numbers = [(Name::Height, 0.1), (Name::TiltGain, 1.3), (Name::Theta, 0.3)];
    let (polygon, rod) = pair(&WIDE, &numbers);
    let (_, ending) = runs(&rod, 500);
    assert_eq!(ending, Ending::Completed);
    let (contacts, ending) = runs(&polygon, 500);
    assert!(matches!(ending, Ending::OtherVertex(touch) if touch.vertex == 1 && touch.t > 0.2), "{ending:?}");
    assert_eq!(contacts.len(), 3);
}

#[test]
fn a_vertex_below_the_tilted_table_is_seen_before_all_else_at_a_contact() {
    // The table tilts by 1.6 rad against the body's 0.2: β = −1.4, and the edge to vertex 1 is 1.326 rad from the normal.
    let numbers = [(Name::Height, 0.2), (Name::TiltGain, 8.0), (Name::Theta, 0.2), (Name::ToppleAngle, 0.1)];
    let (polygon, rod) = pair(&TRIANGLE, &numbers);
    assert!(matches!(runs(&rod, 10).1, Ending::Toppled { .. }));
    let (contacts, ending) = runs(&polygon, 10);
    assert_eq!((contacts.len(), ending), (1, Ending::OtherVertex(Touch { vertex: 1, t: 0.0 })));
}

#[test]
fn the_true_triangle_never_touches_with_another_vertex() {
    let numbers = [(Name::Height, 0.2), (Name::TiltGain, 1.1), (Name::Theta, 0.3)];
    let (polygon, _) = pair(&TRIANGLE, &numbers);
    assert_eq!(runs(&polygon, 20_000).1, Ending::Completed);
}

#[test]
fn a_vertex_that_comes_down_in_the_fall_ends_the_run_before_its_first_contact() {
    // Thrown so that it turns by about −90° before the contact vertex would come down.
    let numbers = [(Name::Height, 1.0), (Name::TiltGain, 1.1), (Name::ThetaDot, -4.0)];
    let (polygon, _) = pair(&TRIANGLE, &numbers);
    let (contacts, ending) = runs(&polygon, 10);
    assert_eq!(contacts.len(), 0);
    let Ending::OtherVertex(touch) = ending else { panic!("{ending:?}") };
    let (_, [x, y]) = (touch.vertex, polygon.outline().unwrap().vertices()[touch.vertex]);
    let (sin, cos) = equipoise_physics::numbers::trig::sin_cos(-4.0 * touch.t);
    let height = 1.0 - 0.5 * 9.81 * touch.t * touch.t + x * sin + y * cos;
    assert!(height.abs() < 1e-14, "{height}");
}

#[test]
fn a_kicked_polygon_is_looked_at_too() {
    let numbers = [(Name::Height, 0.2), (Name::TiltGain, 1.1)];
    let (polygon, rod) = pair(&TRIANGLE, &numbers);
    let kick = Kick { theta_dot: -8.0, ..Default::default() };
    let kicked = |scene: &Scene| {
        let mut orbit = Orbit::new(scene.running_model(), scene.rules(), scene.release()).unwrap();
        orbit.advance_kicked(kick).ending
    };
    assert_eq!(kicked(&rod), None);
    assert!(matches!(kicked(&polygon), Some(Ending::OtherVertex(_))));
}

#[test]
fn the_ladder_leaves_the_other_vertices_out_below_the_last_level() {
    let numbers = [(Name::Height, 0.1), (Name::TiltGain, 1.3), (Name::Theta, 0.3)];
    let (polygon, rod) = pair(&WIDE, &numbers);
    assert_eq!(polygon.as_rod().unwrap(), rod);
    let steps = run_hierarchy(&polygon, 100, || true).unwrap();
    let levels: Vec<_> = steps.iter().map(|step| step.level).collect();
    assert_eq!(levels, [ModelLevel::Linear, ModelLevel::Rod, ModelLevel::Polygon]);
    assert_eq!(steps[1].scene, Some(rod));
    let (as_rod, own) = (steps[1].run.as_ref().unwrap(), steps[2].run.as_ref().unwrap());
    assert_eq!(as_rod.ending, Ending::Completed);
    assert!(matches!(own.ending, Ending::OtherVertex(_)) && own.impacts == 3, "{own:?}");
}

#[test]
fn what_a_scene_says_of_a_polygon_is_checked() {
    let release = [(Name::Height, 0.2), (Name::TiltGain, 1.1)];
    let errors = |draft: Draft| -> Vec<_> {
        draft.build().unwrap_err().into_iter().map(|error| (error.path, error.detail)).collect()
    };
    let mut both = draft(&[&release[..], &[(Name::ContactDistance, 0.1)]].concat());
    both.set_vertices(Some(Vertices::new(&TRIANGLE).unwrap()));
    assert_eq!(
        errors(both),
        [(
            "body.contact_distance",
            "contact_distance follows from vertices, which are given too; leave one of them out".to_owned()
        )]
    );
    let mut stray = draft(&[&release[..], &[(Name::ContactDistance, 0.1), (Name::RadiusOfGyration, 0.1)]].concat());
    stray.set(Name::ContactVertex, Some(Value::Integer(0))).unwrap();
    assert_eq!(errors(stray)[0].0, "body.contact_vertex");
    let mut point = draft(&release);
    point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    point.set_vertices(Some(Vertices::new(&TRIANGLE).unwrap()));
    assert_eq!(errors(point)[0].0, "body.vertices");
    let mut clockwise = draft(&release);
    clockwise.set_vertices(Some(Vertices::new(&[TRIANGLE[0], TRIANGLE[2], TRIANGLE[1]]).unwrap()));
    assert_eq!(errors(clockwise)[0].0, "body.vertices");
    let mut beyond = draft(&release);
    beyond.set_vertices(Some(Vertices::new(&TRIANGLE).unwrap()));
    beyond.set(Name::ContactVertex, Some(Value::Integer(3))).unwrap();
    assert_eq!(errors(beyond)[0].0, "body.contact_vertex");
    // The contact vertex is above the table and another one is not.
    let mut low = draft(&[(Name::Height, 0.03), (Name::TiltGain, 1.1), (Name::Theta, 1.5)]);
    low.set_vertices(Some(Vertices::new(&TRIANGLE).unwrap()));
    let error = errors(low);
    assert!(error[0].0 == "release.height" && error[0].1.contains("puts vertex 2"), "{error:?}");
}
