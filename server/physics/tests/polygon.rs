//! Bodies drawn as polygons: closed forms, invariance, other ways of weighing them, what is no body, and which vertex
//! touches the table, against sampling.

use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::polygon::{FARTHEST, FLUSH, LENGTHS, MAX_VERTICES, Outline, PolygonError, Vertices};
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::trig;
use equipoise_physics::scene::{FieldKind, Name};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

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
    (outline.contact_distance(), outline.radius_of_gyration())
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
    assert_eq!(body.vertices()[5], [0.0, -body.contact_distance()]);
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
                prop_assert!((body.contact_distance() - l).abs() < 1e-12, "{} {l}", body.contact_distance());
                prop_assert!((body.radius_of_gyration().powi(2) - rho_squared).abs() < 1e-12);
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
                    prop_assert!((ours.radius_of_gyration() - original.radius_of_gyration()).abs() < 1e-12);
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
        let length = body.contact_distance();
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
            contact_distance: body.contact_distance(),
            gravity: 9.81,
            drag: None,
        };
        let (_, cos) = flight.sin_cos_theta;
        let height = |[x, y]: [f64; 2], t: f64| {
            let (sin_t, cos_t) = trig::sin_cos(theta + spin * t);
            clearance + body.contact_distance() * cos + t * (y_dot - 0.5 * 9.81 * t) + x * sin_t + y * cos_t
        };
        let touch = body.first_touch(&flight, arrival).unwrap();
        let samples = 3000;
        let mut sampled: Option<(usize, f64)> = None;
        for (vertex, place) in body.vertices().iter().enumerate().filter(|(_, it)| **it != [0.0, -body.contact_distance()]) {
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
    assert_eq!(near.contact_distance(), far.contact_distance());
    assert_eq!(near.radius_of_gyration(), far.radius_of_gyration());
    assert_eq!(near.vertices(), far.vertices());
}
