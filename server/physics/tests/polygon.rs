//! Bodies drawn as polygons: closed forms, invariance, other ways of weighing them, what is no body, and which vertex
//! touches the table, against sampling.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use equipoise_physics::analysis::model_hierarchy::run_hierarchy;
use equipoise_physics::map::body::{Kick, Touch};
use equipoise_physics::map::contact_time::{first_contact, first_descent, first_descent_before};
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::polygon::{FARTHEST, FLUSH, LENGTHS, MAX_VERTICES, Outline, PolygonError, Vertices};
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::trig;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Draft, FieldKind, Name, Scene, Value};
use proptest::prelude::*;

use crate::support::rig::with_numbers;

/// The paper's, with its apex down.
const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]];

const L_SHAPE: [[f64; 2]; 6] = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.4], [0.0, 0.4]];

fn outline(places: &[[f64; 2]], contact_vertex: usize) -> Result<Outline, PolygonError> {
    Outline::new(&Vertices::new(places)?, contact_vertex)
}

/// Beginning of the error of a contact vertex that is no corner of the convex hull.
fn hidden(contact: usize) -> String {
    format!("contact_vertex {contact} is no corner of the polygon's convex hull")
}

fn weighed(places: &[[f64; 2]], contact_vertex: usize) -> (f64, f64) {
    let outline = outline(places, contact_vertex).unwrap();
    (outline.contact_distance, outline.radius_of_gyration)
}

#[track_caller]
fn assert_close(ours: f64, expected: f64) {
    assert!((ours - expected).abs() <= 1e-14 * expected.abs().max(1e-3), "{ours} is not {expected}");
}

fn regular(count: usize, radius: f64, turn: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|vertex| {
            let (sin, cos) = trig::sin_cos(TAU * vertex as f64 / count as f64 + turn);
            [radius * cos, radius * sin]
        })
        .collect()
}

#[test]
fn the_papers_triangle_weighs_what_it_weighs() {
    let (l, rho) = weighed(&TRIANGLE, 0);
    assert_close(l, 0.4 / 3.0);
    assert_close(rho, (0.01_f64 / 24.0 + 0.04 / 18.0).sqrt());
    assert!((rho - 0.05137).abs() < 5e-6, "the paper prints 0.09428");
}

#[test]
fn closed_forms() {
    let (l, rho) = weighed(&[[1.0, 2.0], [1.3, 2.0], [1.3, 2.4], [1.0, 2.4]], 2);
    assert_close(l, 0.25);
    assert_close(rho, (0.25_f64 / 12.0).sqrt());
    for count in 3..=MAX_VERTICES {
        let (l, rho) = weighed(&regular(count, 0.2, 0.3), count - 1);
        assert_close(l, 0.2);
        let (_, cos) = trig::sin_cos(TAU / count as f64);
        assert_close(rho, 0.2 * ((2.0 + cos) / 6.0).sqrt());
    }
    // Two rectangles: 0.3 × 0.1 and 0.1 × 0.3 above its left end.
    let (l, rho) = weighed(&L_SHAPE, 0);
    let centre: [f64; 2] = [0.5 * (0.15 + 0.05), 0.5 * (0.05 + 0.25)];
    assert_close(l, (centre[0] * centre[0] + centre[1] * centre[1]).sqrt());
    assert_close(rho, (0.1_f64 / 12.0 + (0.05 * 0.05 + 0.1 * 0.1)).sqrt());
}

#[test]
fn the_centre_of_gravity_stands_above_the_contact_vertex() {
    let body = outline(&L_SHAPE, 5).unwrap();
    assert_eq!(body.vertices()[5], [0.0, -body.contact_distance]);
    let upright = outline(&TRIANGLE, 0).unwrap();
    for (turned, [x, y]) in upright.vertices().iter().zip(TRIANGLE) {
        assert_close(turned[0], x);
        assert_close(turned[1], y - 0.4 / 3.0);
    }
}

/// A polygon that is seen whole from a point within (no angle between neighbours there is half a turn), and that point.
fn stars() -> impl Strategy<Value = (Vec<[f64; 2]>, [f64; 2])> {
    (3_usize..=MAX_VERTICES).prop_flat_map(|count| {
        (proptest::collection::vec((0.05..1.0_f64, 0.1..0.9_f64), count), -3.0..3.0_f64, -3.0..3.0_f64).prop_map(
            move |(spokes, x, y)| {
                let places = spokes
                    .iter()
                    .enumerate()
                    .map(|(vertex, (radius, share))| {
                        let (sin, cos) = trig::sin_cos(TAU * (vertex as f64 + 0.5 * share) / count as f64);
                        [x + radius * cos, y + radius * sin]
                    })
                    .collect();
                (places, [x, y])
            },
        )
    })
}

/// Centre and ρ² from the triangles between the edges and a point within.
fn by_triangles(places: &[[f64; 2]], within: [f64; 2]) -> ([f64; 2], f64) {
    let triangles = || {
        (0..places.len()).map(|edge| {
            let (a, b) = (places[edge], places[(edge + 1) % places.len()]);
            let area = 0.5 * ((a[0] - within[0]) * (b[1] - within[1]) - (a[1] - within[1]) * (b[0] - within[0]));
            let centre = [(a[0] + b[0] + within[0]) / 3.0, (a[1] + b[1] + within[1]) / 3.0];
            let square = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
            (area, centre, (square(a, b) + square(b, within) + square(within, a)) / 36.0)
        })
    };
    let area: f64 = triangles().map(|it| it.0).sum();
    let mean = |axis: usize| triangles().map(|it| it.0 * it.1[axis]).sum::<f64>() / area;
    let centre = [mean(0), mean(1)];
    // The theorem of parallel axes.
    let inertia =
        triangles().map(|(part, at, own)| part * (own + (at[0] - centre[0]).powi(2) + (at[1] - centre[1]).powi(2)));
    (centre, inertia.sum::<f64>() / area)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn it_weighs_what_its_triangles_weigh((places, within) in stars(), pick in 0_usize..MAX_VERTICES) {
        let contact = pick % places.len();
        let (centre, rho_squared) = by_triangles(&places, within);
        let from = [places[contact][0] - centre[0], places[contact][1] - centre[1]];
        let l = (from[0] * from[0] + from[1] * from[1]).sqrt();
        match outline(&places, contact) {
            Ok(body) => {
                prop_assert!((body.contact_distance - l).abs() < 1e-12, "{} {l}", body.contact_distance);
                prop_assert!((body.radius_of_gyration.powi(2) - rho_squared).abs() < 1e-12);
            }
            Err(error) => prop_assert!(error.to_string().starts_with(&hidden(contact)), "{error}"),
        }
    }

    #[test]
    fn it_is_the_same_wherever_it_lies(
        (places, _) in stars(), turn in -PI..PI, x in -4.5..4.5, y in -4.5..4.5, first in 0_usize..MAX_VERTICES
    ) {
        let count = places.len();
        let (sin, cos) = trig::sin_cos(turn);
        let moved: Vec<_> = (0..count)
            .map(|vertex| places[(vertex + first) % count])
            .map(|[a, b]| [x + cos * a - sin * b, y + sin * a + cos * b])
            .collect();
        for contact in 0..count {
            match (outline(&moved, contact), outline(&places, (contact + first) % count)) {
                (Ok(ours), Ok(original)) => {
                    prop_assert!((ours.radius_of_gyration - original.radius_of_gyration).abs() < 1e-12);
                    for vertex in 0..count {
                        let (a, b) = (ours.vertices()[vertex], original.vertices()[(vertex + first) % count]);
                        prop_assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-11, "{a:?} {b:?}");
                    }
                }
                (ours, original) => prop_assert_eq!(ours.is_err(), original.is_err()),
            }
        }
    }

    /// Angles near those at which an edge lies on the table, to either side, and any others.
    #[test]
    fn a_vertex_is_below_the_table_where_the_nearest_is(
        (places, _) in stars(), pick in 0_usize..MAX_VERTICES, any in -PI..PI, off in -1e-8..1e-8,
    ) {
        let Ok(body) = outline(&places, pick % places.len()) else { return Ok(()) };
        let length = body.contact_distance;
        let from_contact = |[x, y]: [f64; 2]| [x, y + length];
        let size = body.vertices().iter().map(|&it| from_contact(it)).map(|[x, y]| x.hypot(y)).fold(0.0, f64::max);
        let flush = body.vertices().iter().map(|&it| from_contact(it)).flat_map(|[x, y]| {
            let angle = x.atan2(y);
            [angle - 0.5 * PI, angle + 0.5 * PI]
        });
        for beta in flush.flat_map(|beta| [beta, beta + off, beta + 1e-7 * off]).chain([any]) {
            let nearest = body.nearest(trig::sin_cos(beta));
            // The same size, up to rounding.
            if (nearest.clearance + FLUSH * size).abs() > 1e-15 {
                let below = (nearest.clearance < -FLUSH * size).then_some(nearest);
                prop_assert_eq!(body.below_table(beta), below, "{}", beta);
            }
        }
    }

    /// A corner of the hull is alone on one side of some line, and in no triangle of others.
    #[test]
    fn only_corners_of_the_hull_are_contacts((places, _) in stars()) {
        let count = places.len();
        let turns = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 1e-9
        };
        for (contact, from) in places.iter().enumerate() {
            let others: Vec<_> = places.iter().enumerate().filter(|(vertex, _)| *vertex != contact).map(|it| *it.1).collect();
            let alone = (0..180).any(|step| {
                let (sin, cos) = trig::sin_cos(TAU * f64::from(step) / 180.0);
                others.iter().all(|it| (it[0] - from[0]) * cos + (it[1] - from[1]) * sin > 0.0)
            });
            // The others stand in counter-clockwise order about the point within.
            let in_triangle = (0..count - 1).any(|i| (i + 1..count - 1).any(|j| (j + 1..count - 1).any(|k| {
                let (a, b, c) = (others[i], others[j], others[k]);
                turns(a, b, *from) && turns(b, c, *from) && turns(c, a, *from)
            })));
            let refused = match outline(&places, contact) {
                // So near to the centre of gravity that it is refused for that first.
                Err(error) if error.to_string().contains("m from the centre of gravity") => continue,
                Err(error) => error.to_string().starts_with(&hidden(contact)),
                Ok(_) => false,
            };
            prop_assert!(!(alone && refused) && (refused || !in_triangle), "{contact} {alone} {in_triangle} {refused}");
        }
    }

    #[test]
    fn the_first_touch_is_the_first_that_sampling_finds(
        (places, _) in stars(), theta in -2.0..2.0, spin in prop_oneof![-8.0..8.0, -60.0..60.0], y_dot in -1.0..4.0,
        clearance in prop_oneof![Just(0.0), 0.0..0.5], arrival in 0.01..1.0
    ) {
        let Some(body) = (0..places.len()).find_map(|contact| outline(&places, contact).ok()) else { return Ok(()) };
        let flight = Flight {
            start: State { theta, x_dot: 0.0, y_dot, theta_dot: spin },
            sin_cos_theta: trig::sin_cos(theta),
            clearance,
            contact_distance: body.contact_distance,
            gravity: 9.81,
            drag: None,
        };
        let (_, cos) = flight.sin_cos_theta;
        let height = |[x, y]: [f64; 2], t: f64| {
            let (sin_t, cos_t) = trig::sin_cos(theta + spin * t);
            clearance + body.contact_distance * cos + t * (y_dot - 0.5 * 9.81 * t) + x * sin_t + y * cos_t
        };
        let touch = body.first_touch(&flight, arrival).unwrap();
        let samples = 3000;
        let mut sampled: Option<(usize, f64)> = None;
        for (vertex, place) in body.vertices().iter().enumerate().filter(|(_, it)| **it != [0.0, -body.contact_distance]) {
            let mut above = height(*place, 0.0) > 1e-8;
            for sample in 1..=samples {
                let t = arrival * f64::from(sample) / f64::from(samples);
                if above && height(*place, t) < -1e-8 {
                    if sampled.is_none_or(|(_, best)| t < best) {
                        sampled = Some((vertex, t));
                    }
                    break;
                }
                above |= height(*place, t) > 1e-8;
            }
        }
        if let Some((vertex, t)) = sampled {
            let touch = touch.expect("sampling found one");
            prop_assert!(touch.t <= t, "{touch:?}, sampled {vertex} at {t}");
        }
        if let Some(touch) = touch {
            let place = body.vertices()[touch.vertex];
            let scale = 9.81 + 2.0 * spin * spin;
            prop_assert!(height(place, touch.t).abs() < 1e-11 * scale, "{touch:?}");
            prop_assert!(touch.t < arrival && height(place, touch.t + 1e-6) < 1e-12 * scale);
        }
    }
}

#[test]
fn a_square_on_its_corner_lands_on_its_edge() {
    // Corner 0 is the contact; at θ = 45° its edge to corner 1 lies on the table, and flush is not below.
    let square = outline(&regular(4, 0.1, -0.5 * PI), 0).unwrap();
    for (beta, vertex, clearance) in [(0.0, 1, 0.1), (0.1, 3, 0.1 * (0.1_f64.cos() - 0.1_f64.sin()))] {
        let nearest = square.nearest(trig::sin_cos(beta));
        assert_close(nearest.clearance, clearance);
        assert!(beta == 0.0 || nearest.vertex == vertex, "{nearest:?}");
        assert_eq!(square.below_table(beta), None);
    }
    assert_eq!(square.below_table(FRAC_PI_4), None);
    assert_eq!(square.below_table(FRAC_PI_4 + 1e-6).map(|it| it.vertex), Some(3));
    assert_eq!(square.below_table(-FRAC_PI_4 - 1e-6).map(|it| it.vertex), Some(1));
}

#[test]
fn a_vertex_below_after_a_strike_has_to_rise_first() {
    // Corner 3 is 5 mm below y = 0 just after the strike. Without spin it rises with the contact vertex, and comes down
    // before it; with the spin that lowers it, it never comes up.
    let square = outline(&regular(4, 0.1, -0.5 * PI), 0).unwrap();
    let theta = FRAC_PI_4 + 0.0354;
    let flight = |theta_dot: f64, y_dot| Flight {
        start: State { theta, x_dot: 0.0, y_dot, theta_dot },
        sin_cos_theta: trig::sin_cos(theta),
        clearance: 0.0,
        contact_distance: 0.1,
        gravity: 9.81,
        drag: None,
    };
    let arrival = 2.0 / 9.81;
    let rising = square.first_touch(&flight(0.0, 1.0), arrival).unwrap().unwrap();
    assert_eq!(rising.vertex, 3);
    let depth = 0.1 * 2.0_f64.sqrt() * trig::sin_cos(0.0354).0;
    assert_close(rising.t, (1.0 + (1.0 - 2.0 * 9.81 * depth).sqrt()) / 9.81);
    assert_eq!(square.first_touch(&flight(0.0, 0.2), 0.4 / 9.81).unwrap(), None, "it never comes up");
    assert_eq!(square.first_touch(&flight(12.0, 1.0), 0.1).unwrap(), None, "it sinks at once");
}

#[test]
fn what_is_no_body_says_why() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let reversed: Vec<_> = square.iter().rev().copied().collect();
    let bow_tie = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let spike = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.0], [0.5, 1.0]];
    let pinched = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let with_midpoint = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let small = [[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]];
    let large = [[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]];
    let cases: [(&[[f64; 2]], usize, &str); 15] = [
        (&square[..2], 0, "vertices are 2; a polygon has from 3 to 32"),
        (&[[0.5, 0.5]; 33], 0, "vertices are 33; a polygon may have from 3 to 32"),
        (&[[0.0, 0.0], [10.5, 0.0], [0.0, 1.0]], 0, "vertex 1 has a coordinate 10.5 m; it must be from -10 to 10 m"),
        (&[[0.0, 0.0], [1.0, 0.0], [0.0, f64::NAN]], 0, "vertex 2 has a coordinate NaN m; it must be from -10 to 10 m"),
        (&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0]], 0, "vertices 1 and 3 are at the same place"),
        (&bow_tie, 0, "the edges that start at vertices 0 and 2 cross or touch"),
        (&spike, 0, "the edges that start at vertices 0 and 1 cross or touch"),
        (&pinched, 0, "the edges that start at vertices 0 and 2 cross or touch"),
        (&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]], 0, "the polygon is flat: its area is 0 m²"),
        (&reversed, 0, "the vertices go clockwise; reverse their order"),
        (&square, 4, "contact_vertex is 4; of 4 vertices it must be from 0 to 3"),
        (&with_midpoint, 1, "contact_vertex 1 is no corner of the polygon's convex hull"),
        (&L_SHAPE, 3, "contact_vertex 3 is no corner of the polygon's convex hull"),
        (&small, 0, "the polygon has a radius of gyration of 0.00033333333333333"),
        (&large, 0, "contact_vertex 0 is 14.1421356237309"),
    ];
    for (places, contact, expected) in cases {
        let error = outline(places, contact).expect_err(expected).to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    assert!(outline(&with_midpoint, 0).is_ok(), "a straight corner is a corner, though no contact");
}

#[test]
fn a_contact_vertex_at_the_centre_of_gravity() {
    // A 2 × 2 square with a notch from above; the deeper the notch's tip, the lower the centre, and they meet.
    let notched = |tip: f64| [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, tip], [-1.0, 1.0]];
    // The notch is a triangle of area 1 − t with its centre at (2 + t)/3: −(1 − t)(2 + t)/(3(3 + t)) = t.
    let tip = 3.0_f64.sqrt() - 2.0;
    let error = outline(&notched(tip), 3).unwrap_err();
    assert!(error.is_of_contact_vertex);
    let words = error.to_string();
    let distance = words.strip_prefix("contact_vertex 3 is ").and_then(|rest| rest.split_once(" m from the centre"));
    assert!(distance.unwrap().0.parse::<f64>().unwrap() < 1e-15, "{words}");
}

#[test]
fn the_contact_is_the_lowest_unless_another_is_said() {
    assert_eq!(Vertices::new(&TRIANGLE).unwrap().lowest(), Ok(0));
    let error = Vertices::new(&L_SHAPE).unwrap().lowest().unwrap_err();
    assert!(error.is_of_contact_vertex);
    assert_eq!(
        error.to_string(),
        "contact_vertex is missing: it would be the lowest vertex, and vertices 0 and 1 are equally low"
    );
}

#[test]
fn lengths_are_those_of_a_rod() {
    for name in [Name::ContactDistance, Name::RadiusOfGyration] {
        let (minimum, maximum) = (*LENGTHS.start(), *LENGTHS.end());
        assert_eq!(name.row().kind, FieldKind::Number { minimum, maximum });
    }
    assert_eq!(FARTHEST, *LENGTHS.end());
}

/// Whose doubles far from the origin are those near it, moved without rounding.
#[test]
fn no_digit_is_lost_by_lying_far_away() {
    let near = [[0.0, 0.0], [0.00390625, 0.009765625], [-0.00390625, 0.01171875]];
    let far = near.map(|[x, y]| [x + 9.5, y - 8.25]);
    let (near, far) = (outline(&near, 0).unwrap(), outline(&far, 0).unwrap());
    assert_eq!(near.contact_distance, far.contact_distance);
    assert_eq!(near.radius_of_gyration, far.radius_of_gyration);
    assert_eq!(near.vertices(), far.vertices());
}

// Runs of polygons: those of the rod with the same l and ρ, bit for bit, until another vertex touches the table.

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
        [(Name::ContactDistance, outline.contact_distance), (Name::RadiusOfGyration, outline.radius_of_gyration)];
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

// Times at which a point comes down through y = 0: against dense sampling with bisection, and where the answer is known.

fn flight(theta: f64, theta_dot: f64, y_dot: f64, clearance: f64, contact_distance: f64) -> Flight {
    Flight {
        start: State { theta, x_dot: 0.3, y_dot, theta_dot },
        sin_cos_theta: trig::sin_cos(theta),
        clearance,
        contact_distance,
        gravity: 9.81,
        drag: None,
    }
}

fn found(flight: &Flight) -> Option<f64> {
    first_descent(flight).unwrap()
}

/// The first change from above to not above among many samples, refined by bisection.
fn sampled(flight: &Flight, samples: u32) -> Option<f64> {
    let State { y_dot, .. } = flight.start;
    let room = flight.clearance.abs() + 2.0 * flight.contact_distance;
    let end = (y_dot + (y_dot * y_dot + 2.0 * flight.gravity * room).sqrt()) / flight.gravity * 1.01;
    let above = |t| flight.gap(t).value > 0.0;
    let times = (1..=samples).map(|sample| end * f64::from(sample) / f64::from(samples));
    let start = flight.gap(0.0);
    let mut before = (start.value > 0.0 || (start.value == 0.0 && start.slope > 0.0)).then_some(0.0);
    for t in times {
        match (before, above(t)) {
            (_, true) => before = Some(t),
            (Some(mut low), false) => {
                let mut high = t;
                for _ in 0..200 {
                    let middle = 0.5 * (low + high);
                    *(if above(middle) { &mut low } else { &mut high }) = middle;
                }
                return Some(high);
            }
            (None, false) => {}
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn it_is_the_first_that_sampling_finds(
        theta in -3.2..3.2, spin in prop_oneof![-8.0..8.0, -200.0..200.0], y_dot in -4.0..5.0,
        share in prop_oneof![Just(0.0), -1.0..1.0], contact_distance in 0.02..2.0
    ) {
        let flight = flight(theta, spin, y_dot, 0.5 * share * contact_distance, contact_distance);
        let start = flight.gap(0.0);
        if start.value == 0.0 && start.slope.abs() < 1e-3 {
            return Ok(());
        }
        let (found, sampled) = (found(&flight), sampled(&flight, 4000));
        if let Some(sampled) = sampled {
            let found = found.expect("sampling found one");
            prop_assert!(found <= sampled * (1.0 + 1e-9), "found {found}, sampled {sampled}");
        }
        if let Some(found) = found {
            // An earlier one than sampling saw is a root all the same, and comes down.
            let gap = flight.gap(found);
            let scale = flight.gravity + contact_distance * spin * spin;
            prop_assert!(found > 0.0 && gap.value.abs() <= 1e-13 * (1.0 + scale), "{gap:?}");
            prop_assert!(gap.slope <= 1e-6 * scale, "{gap:?}");
            let grazes = gap.slope.abs() < 1e-3 * scale;
            prop_assert!(grazes || sampled.is_some_and(|it| it - found <= 1e-9), "found {found}, sampled {sampled:?}");
        }
    }

    #[test]
    fn from_above_it_is_the_first_contact(
        theta in -1.5..1.5, spin in prop_oneof![-8.0..8.0, -200.0..200.0], y_dot in -4.0..5.0,
        clearance in prop_oneof![Just(0.0), 0.0..0.5]
    ) {
        let flight = flight(theta, spin, y_dot, clearance, 0.13);
        if clearance == 0.0 && flight.gap(0.0).slope <= 0.0 {
            return Ok(());
        }
        prop_assert_eq!(found(&flight), first_contact(&flight).ok());
    }

    #[test]
    fn a_limit_changes_nothing_before_it(
        theta in -3.2..3.2, spin in prop_oneof![-8.0..8.0, -200.0..200.0], y_dot in -4.0..5.0, clearance in -0.2..0.2, limit in 0.0..2.0
    ) {
        let flight = flight(theta, spin, y_dot, clearance, 0.13);
        let (all, before) = (found(&flight), first_descent_before(&flight, limit).unwrap());
        let expected = all.filter(|t| *t <= limit);
        // Pieces cut at the limit converge from elsewhere.
        let same = match (before, expected) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-10,
            (a, b) => a == b || (all.unwrap_or(limit) - limit).abs() < 1e-10,
        };
        prop_assert!(same, "{before:?} {expected:?}");
    }

    /// Raised until it all but grazes: it comes down as soon as it is above, and not before.
    #[test]
    fn a_point_that_grazes_from_below(theta in -3.2..3.2, spin in -8.0..8.0, y_dot in 0.5..4.0) {
        let low = flight(theta, spin, y_dot, 0.0, 0.13);
        if low.gap(0.0).slope <= 0.1 {
            return Ok(());
        }
        // The top, by bisection of the slope of a concave gap.
        let (mut left, mut right) = (0.0, 2.0);
        for _ in 0..200 {
            let middle = 0.5 * (left + right);
            *(if low.gap(middle).slope > 0.0 { &mut left } else { &mut right }) = middle;
        }
        let top = low.gap(left).value;
        for share in [1e-2, 1e-6, 1e-10, 1e-13] {
            let raised = Flight { clearance: -top * (1.0 - share), ..low };
            let down = found(&raised).expect("it comes above");
            prop_assert!(down > left - 1e-7 && raised.gap(down).value.abs() < 1e-14 * (1.0 + top), "{down} {left}");
            prop_assert_eq!(found(&Flight { clearance: -top * (1.0 + share), ..low }), None);
        }
    }
}

#[test]
fn a_point_without_spin_falls_as_a_stone() {
    // −0.1 + 2t − 4.905 t² = 0.
    let stone = flight(0.4, 0.0, 2.0, -0.1, 0.13);
    let down = (2.0 + (4.0_f64 - 4.0 * 4.905 * 0.1).sqrt()) / 9.81;
    assert!((found(&stone).unwrap() - down).abs() < 1e-15);
    assert_eq!(found(&Flight { clearance: -0.3, ..stone }), None, "it rises 0.204 m");
    assert_eq!(found(&flight(0.4, 0.0, -2.0, -0.1, 0.13)), None, "it is below and falls");
    assert_eq!(found(&flight(0.4, 0.0, -2.0, 0.0, 0.13)), None, "it is on it and falls");
    assert_eq!(found(&flight(0.4, 0.0, 0.0, 0.0, 0.13)), None);
    assert!((found(&flight(0.4, 0.0, 2.0, 0.0, 0.13)).unwrap() - 4.0 / 9.81).abs() < 1e-15);
    assert!((found(&flight(0.4, 0.0, 0.0, 0.981, 0.13)).unwrap() - 0.2_f64.sqrt()).abs() < 1e-15);
    assert_eq!(found(&flight(0.4, 0.0, 3.0, -50.0, 0.13)), None, "far below");
}

#[test]
fn a_fast_one_from_below_comes_round_and_down_again() {
    // A point 5 mm below turns 20 times a second about a centre that floats up: it rises within its first half turn.
    let wheel = flight(0.0, 40.0 * std::f64::consts::PI, 0.0, -0.005, 0.1);
    let down = found(&wheel).unwrap();
    assert!((0.02..0.05).contains(&down), "{down}");
    assert!(wheel.gap(down).value.abs() < 1e-13 && wheel.gap(down).slope < -1.0);
    // So deep that it never comes up.
    assert_eq!(found(&Flight { clearance: -0.3, ..wheel }), None);
}

/// A nearly vertical table: gravity along its normal is small, so the body stays below it for hours.
#[test]
fn what_is_below_for_hours_is_not_looked_at_turn_by_turn() {
    // The centre rises from 1.52 m to 0.72 m below in eleven hours. Within 1 m the point comes up and down in one turn.
    let slow = Flight { gravity: 1e-9, ..flight(0.5, 200.0, 4e-5, -2.4, 1.0) };
    let enters = (4e-5 - (1.6e-9_f64 - 2e-9 * (1.4 - 0.5_f64.cos())).sqrt()) / 1e-9;
    let down = found(&slow).expect("it comes up");
    assert!((enters..enters + 3.0).contains(&down), "{down} s, and it is near from {enters} s on");
    assert!(slow.gap(down).value.abs() < 1e-9 && slow.gap(down).slope < 0.0, "{:?}", slow.gap(down));
    // One that rises to 1.02 m below and no further.
    assert_eq!(found(&Flight { clearance: -2.7, ..slow }), None);
}

#[test]
fn an_angle_without_digits_says_so() {
    // It is away for six centuries and turns 3e16 times, of which a double resolves every eighth.
    let endless = Flight { gravity: 1e-6, ..flight(0.5, 1e7, 1e4, 1.1, 1.0) };
    assert!(first_contact(&endless).is_err() && first_descent(&endless).is_err());
}
