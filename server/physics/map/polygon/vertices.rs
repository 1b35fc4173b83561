//! The vertices of a polygon: whether they are one, and the centre of gravity and ρ of an even sheet of that shape.

use std::ops::RangeInclusive;
use thiserror::Error;

/// Fewest vertices.
pub const FEWEST_VERTICES: usize = 3;

/// Most vertices. Each flight examines all of them.
pub const MAX_VERTICES: usize = 32;

/// Farthest coordinate of a vertex from zero, m: a body of the greatest l, drawn anywhere about it.
pub const FARTHEST: f64 = 10.0;

/// Range of l and ρ, m: the same as for a rod.
pub const LENGTHS: RangeInclusive<f64> = 1e-3..=10.0;

/// Least area as a share of the diagonal squared. The centre of gravity of a thinner polygon has too few digits.
const THINNEST: f64 = 1e-9;

/// Reason for which vertices are no body, in words with numbers, limits and units. Vertices are counted from 0; edge i goes from vertex i to the
/// next.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{detail}")]
pub struct PolygonError {
    /// True if the choice of the contact vertex is wrong, and not the polygon.
    pub is_of_contact_vertex: bool,
    detail: String,
}

impl PolygonError {
    pub(super) fn new(detail: String) -> Self {
        Self { is_of_contact_vertex: false, detail }
    }

    pub(super) fn of_contact_vertex(detail: String) -> Self {
        Self { is_of_contact_vertex: true, detail }
    }

    fn flat(area: f64, least: f64) -> Self {
        Self::new(format!(
            "the polygon is flat: its area is {area} m², and at its length it must be {least} m² or more"
        ))
    }
}

/// The vertices of a polygon as they were given, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertices {
    pub(super) places: [[f64; 2]; MAX_VERTICES],
    pub(super) count: usize,
}

impl Vertices {
    /// Vertices in counter-clockwise order, m, wherever they lie. Fails if too few, too many, or one lies too far out.
    /// The check that they are a polygon comes with the contact vertex ([`Outline::new`](super::Outline::new)).
    pub fn new(places: &[[f64; 2]]) -> Result<Self, PolygonError> {
        let count = places.len();
        if !(FEWEST_VERTICES..=MAX_VERTICES).contains(&count) {
            let has = if count < FEWEST_VERTICES { "has" } else { "may have" };
            let detail = format!("vertices are {count}; a polygon {has} from {FEWEST_VERTICES} to {MAX_VERTICES}");
            return Err(PolygonError::new(detail));
        }
        for (vertex, place) in places.iter().enumerate() {
            if let Some(&coordinate) = place.iter().find(|it| !(-FARTHEST..=FARTHEST).contains(*it)) {
                return Err(PolygonError::new(format!(
                    "vertex {vertex} has a coordinate {coordinate} m; it must be from -{FARTHEST} to {FARTHEST} m"
                )));
            }
        }
        let mut vertices = Self { places: [[0.0; 2]; MAX_VERTICES], count };
        vertices.places[..count].copy_from_slice(places);
        Ok(vertices)
    }

    /// Each as x and y.
    pub fn places(&self) -> &[[f64; 2]] {
        &self.places[..self.count]
    }

    /// The lowest, which is the contact unless another is said. Fails if they are no polygon, or two are the lowest.
    pub fn lowest(&self) -> Result<usize, PolygonError> {
        self.check()?;
        let height = |vertex: usize| self.places[vertex][1];
        let lowest = (1..self.count).fold(0, |best, it| if height(it) < height(best) { it } else { best });
        match (lowest + 1..self.count).find(|&it| height(it) == height(lowest)) {
            Some(other) => Err(PolygonError::of_contact_vertex(format!(
                "contact_vertex is missing: it would be the lowest vertex, and vertices {lowest} and {other} are equally low"
            ))),
            None => Ok(lowest),
        }
    }

    /// Each edge: its number and its two ends.
    fn edges(&self) -> impl Iterator<Item = (usize, [f64; 2], [f64; 2])> {
        let places = self.places();
        (0..self.count).map(move |edge| (edge, places[edge], places[(edge + 1) % places.len()]))
    }

    /// Checks that they are a polygon whose outline does not meet itself, in counter-clockwise order.
    pub(super) fn check(&self) -> Result<(), PolygonError> {
        let places = self.places();
        for (b, place) in places.iter().enumerate() {
            if let Some(a) = places[..b].iter().position(|it| it == place) {
                return Err(PolygonError::new(format!(
                    "vertices {a} and {b} are at the same place; leave one of them out"
                )));
            }
        }
        let origin = places[0];
        let least = THINNEST * spread_squared(places);
        let double_areas = || self.edges().map(|(_, a, b)| cross(minus(a, origin), minus(b, origin)));
        let on_a_line = 0.5 * double_areas().map(f64::abs).sum::<f64>();
        if on_a_line < least {
            return Err(PolygonError::flat(on_a_line, least));
        }
        for (i, a, b) in self.edges() {
            for (j, c, d) in self.edges().skip(i + 1) {
                let meet = if j == i + 1 {
                    runs_back(a, b, d)
                } else if (j + 1) % self.count == i {
                    runs_back(c, a, b)
                } else {
                    cross_or_touch(a, b, c, d)
                };
                if meet {
                    return Err(PolygonError::new(format!(
                        "the edges that start at vertices {i} and {j} cross or touch; the outline must not meet itself"
                    )));
                }
            }
        }
        let area = 0.5 * double_areas().sum::<f64>();
        if area.abs() < least {
            return Err(PolygonError::flat(area.abs(), least));
        }
        if area < 0.0 {
            return Err(PolygonError::new("the vertices go clockwise; reverse their order".to_owned()));
        }
        Ok(())
    }

    /// The same polygon with its first vertex at 0, so that no digit depends on where it lies.
    pub(super) fn about_the_first(&self) -> Self {
        let origin = self.places[0];
        let mut moved = *self;
        for place in &mut moved.places[..self.count] {
            *place = minus(*place, origin);
        }
        moved
    }

    /// The centre of gravity of an even sheet, and ρ about it, m.
    /// Both are sums over the triangles between the edges and a point; that is 0, best a vertex, and then the centre itself.
    pub(super) fn centre_and_radius(&self) -> ([f64; 2], f64) {
        let (mut double_area, mut moment) = (0.0, [0.0; 2]);
        for (_, a, b) in self.edges() {
            let part = cross(a, b);
            double_area += part;
            moment = [moment[0] + part * (a[0] + b[0]), moment[1] + part * (a[1] + b[1])];
        }
        let centre = moment.map(|it| it / (3.0 * double_area));
        let mut inertia = 0.0;
        for (_, a, b) in self.edges() {
            let (a, b) = (minus(a, centre), minus(b, centre));
            inertia += cross(a, b) * (dot(a, a) + dot(a, b) + dot(b, b));
        }
        (centre, (inertia / (6.0 * double_area)).sqrt())
    }
}

pub(super) fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The diagonal of the upright rectangle about them, squared.
fn spread_squared(places: &[[f64; 2]]) -> f64 {
    let spread = |axis: usize| {
        let all = || places.iter().map(|it| it[axis]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    spread(0) * spread(0) + spread(1) * spread(1)
}

/// On which side of the line through a and b the point c lies; 0 where rounding does not tell, as on it.
fn side(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let (along, to) = (minus(b, a), minus(c, a));
    let (one, other) = (along[0] * to[1], along[1] * to[0]);
    let value = one - other;
    if value.abs() <= 4.0 * f64::EPSILON * (one.abs() + other.abs()) { 0.0 } else { value.signum() }
}

fn cross_or_touch(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    let apart =
        |axis: usize| a[axis].max(b[axis]) < c[axis].min(d[axis]) || c[axis].max(d[axis]) < a[axis].min(b[axis]);
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0 && !apart(0) && !apart(1)
}

/// Tells whether the edge from b to c lies on that from a to b.
fn runs_back(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
    side(a, b, c) == 0.0 && dot(minus(b, a), minus(c, b)) < 0.0
}
