//! The bounce that repeats: a fixed point of the return map, by Newton's iteration with dual numbers, and the quantities that are neutral there.
//!
//! Fixed points come in families where something is kept: the energy, the drift. Each direction of a family is an eigenvalue 1 of the
//! derivative A with a right vector along the family and a left vector, the kept quantity to first order. They are found from A: the null
//! vectors of A − 1 along which the fixed points go on. The member of the family is the one with the kept quantities of the release.

use crate::analysis::jacobian::eigenvalues;
use crate::analysis::return_map::{ARC, COMPONENTS, ReturnMap, SOLVED, SPIN, Vector, X, X_DOT, Y_DOT};
use crate::map::body::NoContact;
use crate::map::strike::Rod;
use crate::numbers::trig;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::Scene;
use nalgebra::{Complex, DMatrix, DVector};
use thiserror::Error;

const MOST_STEPS: usize = 60;

/// Distance of a modulus from 1 up to which an eigenvalue is on the unit circle.
pub const ON_CIRCLE: f64 = 1e-9;

/// The same of a double eigenvalue, which rounding moves by its square root.
pub(super) const ON_CIRCLE_TWICE: f64 = 1e-7;

/// Singular values of A − 1, in parts of the largest, up to which a direction counts as neutral: tried one after the other. Beside a fixed
/// point those of a family are small and not 0, and other directions may be slow.
const NEUTRAL: [f64; 5] = [0.05, 1e-3, 1e-5, 1e-8, EXACT];

/// The same at a fixed point, where that of a family is 0 but for rounding.
const EXACT: f64 = 1e-11;

/// Way of the angle from the guess, in parts of the bounce speed, beyond which another bounce that repeats may be nearer.
const FAR: f64 = 0.02;

/// Share of a change of its height that a bounce keeps, up to which the table holds that height.
const HOLDS: f64 = 0.99;

/// Way along a family, in parts of the bounce speed, by which it is tried whether fixed points go on.
const TRIED: f64 = 1e-3;

/// Share of the bounce speed that a step may change ẏ by.
const LONGEST: f64 = 0.3;

/// Share of the bounce speed of the guess below which a bounce counts as rest.
const AT_REST: f64 = 1e-3;

/// Share of the largest entry of a derivative up to which one is rounding.
const APART_FROM: f64 = 1e-12;

const MOST_CONTACTS: u64 = 10_000;

/// Change of the speed of such a bounce, in parts of it, that is small enough for a guess.
const SETTLED_HEIGHT: f64 = 1e-6;

/// Change of a state from bounce to bounce, in parts of the bounce speed, at which a run has settled.
const STAYS: f64 = 1e-13;

/// A direction in which fixed points form a family, and the quantity that is kept there.
#[derive(Clone, Debug)]
pub struct Neutral {
    /// Along the family, in the components of the map.
    pub right: DVector<f64>,
    /// The kept quantity to first order: left·right is 1, and 0 with the right vectors of the others.
    pub left: DVector<f64>,
}

/// A bounce that repeats.
#[derive(Clone, Debug)]
pub struct RepeatingBounce {
    /// The map that repeats it.
    pub map: ReturnMap,
    /// The state just before a contact.
    pub at: Vector,
    /// Largest component of the remainder, over the bounce speed.
    pub residual: f64,
    /// Derivative of the map.
    pub matrix: DMatrix<f64>,
    /// Neutral directions.
    pub neutral: Vec<Neutral>,
    /// Eigenvalues beside the neutral directions, largest modulus first.
    pub eigenvalues: Vec<Complex<f64>>,
}

/// Reason for which no bounce repeats.
#[derive(Clone, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum NoRepeatingBounce {
    #[error("the release comes to no contact")]
    NoContact,
    /// Each bounce, of this length (s), changes the state beside it by so much (m, m/s), in the mean over the quantities that nothing brings back.
    #[error("beside the upright bounce each one changes {}", self.moved().join(" and "))]
    Moves { at: Box<Vector>, change: Vector, flight_time: f64 },
    /// The table is level under an upright body beyond its ends only.
    #[error("the bounce in place is at x = {x} m, beyond the end of the table at {half_length} m")]
    BeyondTable { x: f64, half_length: f64 },
    #[error("bounces die out, down to the body at rest on the table")]
    Rests,
    #[error("Newton's iteration on the return map found no bounce that repeats")]
    NotFound,
}

impl NoRepeatingBounce {
    /// Tells whether a component of [`Vector`] moves but for rounding.
    pub fn moves(&self, component: usize) -> bool {
        let Self::Moves { change, .. } = self else { return false };
        let largest = change.iter().fold(0.0_f64, |size, part| size.max(part.abs()));
        change[component].abs() > 1e-3 * largest
    }

    /// The quantities that move, each with its change a bounce.
    pub fn moved(&self) -> Vec<String> {
        let Self::Moves { change, .. } = self else { return Vec::new() };
        let named = [(ARC, "ρθ", "m"), (X_DOT, "ẋ", "m/s"), (Y_DOT, "ẏ", "m/s"), (SPIN, "ρθ̇", "m/s"), (X, "x", "m")];
        named
            .into_iter()
            .filter(|(index, ..)| self.moves(*index))
            .map(|(index, name, unit)| format!("{name} by {} {unit}", change[index]))
            .collect()
    }
}

impl RepeatingBounce {
    /// A bounce with its derivative, of which neither neutral directions nor eigenvalues are known.
    pub(crate) fn bare(map: &ReturnMap, at: Vector, matrix: DMatrix<f64>) -> Self {
        Self { map: *map, at, residual: 0.0, matrix, neutral: Vec::new(), eigenvalues: Vec::new() }
    }

    /// Tells whether the bounce repeats at other places on the table, though strikes depend on the place.
    pub(crate) fn has_neutral_place(&self) -> bool {
        let is_along = |place: usize| self.neutral.iter().any(|it| it.right[place].abs() > EXACT * it.right.amax());
        self.map.place_of(X).is_some_and(is_along)
    }

    /// Tells whether a component moves apart from all others, to first order.
    pub(crate) fn moves_alone(&self, component: usize) -> bool {
        let size = self.matrix.amax();
        (0..self.matrix.nrows()).filter(|&other| other != component).all(|other| {
            self.matrix[(other, component)].abs().max(self.matrix[(component, other)].abs()) <= APART_FROM * size
        })
    }

    /// The projection that takes away what is along the neutral directions.
    pub(crate) fn beside(&self) -> DMatrix<f64> {
        let size = self.matrix.nrows();
        let neutral = self.neutral.iter().map(|neutral| &neutral.right * neutral.left.transpose());
        neutral.fold(DMatrix::identity(size, size), |beside, along| beside - along)
    }

    /// The derivative without its neutral directions.
    pub(crate) fn matrix_beside(&self) -> DMatrix<f64> {
        let beside = self.beside();
        &beside * &self.matrix * beside
    }

    /// The same with neutral directions, and the eigenvalues beside them.
    fn beside_neutral(mut self, neutral: Vec<Neutral>) -> Option<Self> {
        self.neutral = neutral;
        self.eigenvalues = eigenvalues(&self.matrix_beside())?;
        // Those of the neutral directions are 0 now.
        self.eigenvalues.truncate(self.matrix.nrows() - self.neutral.len());
        Some(self)
    }
}

/// The return map of a scene without its noise, and two states just before a contact.
#[derive(Clone, Copy, Debug)]
pub struct SceneMap {
    /// The map over its period.
    pub map: ReturnMap,
    /// State of its run just before the first contact.
    pub reference: Vector,
    /// The upright bounce of its height, with the drift and at the place of the release.
    pub guess: Vector,
}

impl SceneMap {
    /// That of a scene.
    pub fn of(scene: &Scene) -> Result<Self, NoContact> {
        let orbit = scene.orbit()?;
        let model = scene.model();
        let map = ReturnMap::of_cycle(&model);
        let reference = map.vector(orbit.state(), orbit.x());
        Ok(Self { map, reference, guess: steady(&map, upright(&map, &reference)) })
    }

    /// The bounce that repeats, with the kept quantities of the release.
    pub fn find(&self) -> Result<RepeatingBounce, NoRepeatingBounce> {
        let Self { map, reference, guess } = self;
        let mut in_place = *guess;
        in_place[X_DOT] = 0.0;
        // Where friction holds the contact, the drift of the release is far from the bounce, and the height may be.
        find_planned(map, guess, reference).or_else(|why| {
            find_planned(map, &in_place, reference)
                .or_else(|_| find_planned(map, &steady(map, in_place), reference))
                .or_else(|_| match why {
                    NoRepeatingBounce::NotFound | NoRepeatingBounce::Rests => self.settled().ok_or(why.clone()),
                    _ => Err(why.clone()),
                })
                .map_err(|_| why)
        })
    }

    /// The bounce to which its run settles, if it does and still bounces.
    pub(super) fn settled(&self) -> Option<RepeatingBounce> {
        let Self { map, reference, guess } = self;
        let orbit = Orbit::at(map.body, Rules::BARE_MAP, map.state(reference)).moved(reference[X]);
        let here = settled(map, orbit, &RepeatingBounce::bare(map, *guess, DMatrix::zeros(0, 0)))?;
        let bounces = |at: &Vector| map.flight_time(at) > AT_REST * map.flight_time(guess);
        find_planned(map, &here, &here).ok().filter(|found| bounces(&found.at))
    }
}

/// The bounce of a scene that repeats, or with a program the bounces, with the kept quantities of its release.
pub fn of_scene(scene: &Scene) -> Result<RepeatingBounce, NoRepeatingBounce> {
    SceneMap::of(scene).map_err(|_| NoRepeatingBounce::NoContact)?.find()
}

/// The upright state with the energy, the drift and the place of a state: what the angle takes away from the drift as it settles is left out.
pub(super) fn upright(map: &ReturnMap, state: &Vector) -> Vector {
    let mut upright = *state;
    if !map.body.is_point {
        let Rod { gravity, contact_distance, .. } = map.body.rod;
        let (_, versine) = trig::sin_versine(map.state(state).theta);
        let square =
            state[Y_DOT] * state[Y_DOT] + state[SPIN] * state[SPIN] - 2.0 * gravity * contact_distance * versine;
        (upright[ARC], upright[SPIN]) = (0.0, 0.0);
        upright[Y_DOT] = if square > 0.0 { -square.sqrt() } else { state[Y_DOT] };
    }
    upright
}

/// An upright state at the height to which the table brings it, and at the place at which it is level where strikes depend on that: by Newton's
/// iteration on each alone. The same height where every height is kept or none is. A drift that strikes change has no part in the height.
fn steady(map: &ReturnMap, upright: Vector) -> Vector {
    let place = map.place_of(X);
    let (Some(along), Some(fall)) = (map.place_of(X_DOT), map.place_of(Y_DOT)) else { return upright };
    let (mut at, first_speed) = (upright, upright[Y_DOT].abs());
    let (mut drift, mut is_settled) = (upright[X_DOT], false);
    if map.image(&at).is_some_and(|image| (image[X_DOT] - drift).abs() > SETTLED_HEIGHT * first_speed) {
        at[X_DOT] = 0.0;
    }
    for _ in 0..MOST_STEPS {
        let Some(here) = map.derivative(&at) else { break };
        let by_place = place.map_or(0.0, |place| here.matrix[(along, place)]);
        let (mut aside, speed) = (0.0, at[Y_DOT].abs());
        if by_place.abs() > APART_FROM {
            aside = here.image[X_DOT] - at[X_DOT];
            at[X] -= (here.image[X_DOT] - here.matrix[(along, along)] * at[X_DOT]) / by_place;
            (at[X_DOT], drift) = (0.0, 0.0);
        }
        let change = here.image[Y_DOT] - at[Y_DOT];
        if change.abs().max(aside.abs()) <= SETTLED_HEIGHT * speed {
            is_settled = true;
            break;
        }
        // A place that is not found yet says nothing about the height.
        if aside.abs() > SETTLED_HEIGHT * speed {
            continue;
        }
        // Where the height is left, as one that is too low for the air, the bounce that repeats is farther on.
        let slope = 1.0 - here.matrix[(fall, fall)];
        let most = LONGEST * speed;
        let step = if slope > 0.0 { (change / slope).clamp(-most, most) } else { most.copysign(change) };
        at[Y_DOT] += if change == 0.0 { 0.0 } else { step };
        if !at[Y_DOT].is_finite() || at[Y_DOT] >= -AT_REST * first_speed {
            break;
        }
    }
    if !is_settled {
        at[Y_DOT] = upright[Y_DOT];
    }
    at[X_DOT] = drift;
    at
}

/// Null vectors of A − 1: of the right as columns, of the left as rows.
struct NullSpace {
    right: DMatrix<f64>,
    left: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl NullSpace {
    /// In scaled components, with singular values up to `share` of the largest counted as 0.
    fn of(matrix: &DMatrix<f64>, share: f64) -> Option<Self> {
        let size = matrix.nrows();
        let less = matrix - DMatrix::identity(size, size);
        let svd = less.try_svd(true, true, f64::EPSILON, 10_000)?;
        let (u, v_t) = (svd.u?, svd.v_t?);
        let largest = svd.singular_values.max().max(1.0);
        let null: Vec<usize> = (0..size).filter(|&n| svd.singular_values[n] <= share * largest).collect();
        let mut inverse = DMatrix::zeros(size, size);
        for n in (0..size).filter(|n| !null.contains(n)) {
            inverse += v_t.row(n).transpose() * u.column(n).transpose() / svd.singular_values[n];
        }
        let right = echelon(DMatrix::from_fn(size, null.len(), |row, n| v_t[(null[n], row)]));
        let left = DMatrix::from_fn(null.len(), size, |n, column| u[(column, null[n])]);
        Some(Self { right, left, inverse })
    }
}

/// Order in which components are taken apart in a space of null vectors: ẏ and ẋ, which are those of the energy and of the drift, first.
const APART: [usize; 5] = [Y_DOT, X_DOT, 0, 3, 4];

/// Another basis of the space of some columns, each with a component of its own where it is 1 and the others are 0, if they have them.
fn echelon(mut columns: DMatrix<f64>) -> DMatrix<f64> {
    let (rows, count) = columns.shape();
    let mut done = 0;
    let order = APART.into_iter().chain(5..rows.max(5)).filter(|&row| row < rows);
    for row in order {
        let Some(best) =
            (done..count).max_by(|&one, &other| columns[(row, one)].abs().total_cmp(&columns[(row, other)].abs()))
        else {
            break;
        };
        if columns[(row, best)].abs() < 1e-6 {
            continue;
        }
        columns.swap_columns(done, best);
        let pivot = columns[(row, done)];
        columns.column_mut(done).scale_mut(1.0 / pivot);
        for other in (0..count).filter(|&other| other != done) {
            let share = columns[(row, other)];
            let less = columns.column(done) * share;
            let mut column = columns.column_mut(other);
            column -= less;
        }
        done += 1;
    }
    for mut column in columns.column_iter_mut() {
        let size = column.amax();
        column.scale_mut(1.0 / size);
    }
    columns
}

/// The way from one state to another, in scaled components.
fn between(map: &ReturnMap, from: &Vector, to: &Vector, scale: &DVector<f64>) -> DVector<f64> {
    (map.reduced(to) - map.reduced(from)).component_mul(scale)
}

/// A derivative in scaled components.
fn scaled(matrix: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(scale.len(), scale.len(), |row, column| matrix[(row, column)] * scale[row] / scale[column])
}

/// Scales of the components of a map, so that all are speeds: lengths over the flight time, a tilt times the speed.
pub(super) fn scales(map: &ReturnMap, speed: f64) -> DVector<f64> {
    let gravity = map.body.rod.gravity;
    let per_flight = gravity / (2.0 * speed);
    let of = [per_flight, 1.0, 1.0, 1.0, per_flight, speed, 1.0, 1.0];
    DVector::from_iterator(map.components().len(), map.components().into_iter().map(|index| of[index]))
}

/// The bounce that repeats near `guess`, with the kept quantities of `reference`, a state of the run just before a contact. An energy that
/// strikes keep exactly is that of `reference` to all orders.
pub fn find(map: &ReturnMap, guess: &Vector, reference: &Vector) -> Result<RepeatingBounce, NoRepeatingBounce> {
    let newton = Newton { map, reference, keeps_energy: keeps_energy(map, guess) };
    let (mut nearest, mut failure) = (None, None);
    for share in NEUTRAL {
        match newton.solve(guess, share) {
            Ok(found) => {
                let way = turned(map, guess, &found.at);
                if nearest.as_ref().is_none_or(|(least, _)| way < *least) {
                    nearest = Some((way, found));
                }
                // Beside an eigenvalue 1 the iteration may come to a bounce far off, though one is here.
                if way <= FAR {
                    break;
                }
            }
            // What moves is said by the first try, which solves for all else.
            Err(why) => failure = failure.or(Some(why)),
        }
    }
    if let Some((_, found)) = nearest {
        let neutral = families(&found)?;
        return found.beside_neutral(neutral).ok_or(NoRepeatingBounce::NotFound);
    }
    let why = failure.unwrap_or(NoRepeatingBounce::NotFound);
    Err(if why.moves(X_DOT) { driven_aside(map, guess, reference).unwrap_or(why) } else { why })
}

/// Way of the angle and of the spin from one state to another, in parts of the bounce speed.
fn turned(map: &ReturnMap, from: &Vector, to: &Vector) -> f64 {
    let speed = from[Y_DOT].abs();
    let way = between(map, from, to, &scales(map, speed));
    let of_angle = [ARC, SPIN].into_iter().filter_map(|index| map.place_of(index));
    of_angle.fold(0.0_f64, |most, place| most.max(way[place].abs())) / speed
}

/// The bounce at which the angle stays, and each one changes the velocity.
fn driven_aside(map: &ReturnMap, guess: &Vector, reference: &Vector) -> Option<NoRepeatingBounce> {
    if map.body.is_point || map.has_place || !map.components().contains(&X_DOT) {
        return None;
    }
    // At the height that the table holds, or else at that of the reference.
    let holds = |bounce: &RepeatingBounce| {
        let kept = bounce.map.place_of(Y_DOT).map_or(1.0, |fall| bounce.matrix[(fall, fall)].abs());
        kept <= HOLDS && (0.5..=2.0).contains(&(bounce.at[Y_DOT] / guess[Y_DOT]))
    };
    let held = find(&map.holding(&[X_DOT]), guess, reference).ok().filter(holds);
    let RepeatingBounce { at, .. } = held.or_else(|| {
        let mut there = *guess;
        there[Y_DOT] = upright(map, reference)[Y_DOT];
        find(&map.holding(&[X_DOT, Y_DOT]), &there, reference).ok()
    })?;
    let image = map.image(&at)?;
    let mut change = [0.0; COMPONENTS];
    (change[X_DOT], change[Y_DOT]) = (image[X_DOT] - at[X_DOT], image[Y_DOT] - at[Y_DOT]);
    Some(NoRepeatingBounce::Moves { flight_time: map.flight_time(&at), at: Box::new(at), change })
}

/// [`find`], with the motion of the table as part of the state where its delay is longer than the flights.
pub fn find_planned(map: &ReturnMap, guess: &Vector, reference: &Vector) -> Result<RepeatingBounce, NoRepeatingBounce> {
    let found = find(map, guess, reference)?;
    if map.body.lag <= map.shortest_flight(&found.at) {
        return Ok(found);
    }
    let planning = map.planning();
    find(&planning, &planning.planned(&found.at), &planning.planned(reference))
}

/// The state before a contact to which a run about a bounce settles; `None` if it comes no nearer. The place may go on.
pub(super) fn settled(map: &ReturnMap, mut orbit: Orbit, about: &RepeatingBounce) -> Option<Vector> {
    let place = map.place_of(X).filter(|_| about.has_neutral_place());
    orbit.replace(map.body, Rules::BARE_MAP);
    let speed = about.at[Y_DOT].abs();
    let scale = scales(map, speed);
    let mut here = map.vector(orbit.state(), orbit.x());
    let moved = |one: &Vector, other: &Vector| {
        let mut way = between(map, one, other, &scale);
        place.into_iter().for_each(|place| way[place] = 0.0);
        way.amax()
    };
    let mut first = None;
    for _ in 0..MOST_CONTACTS / map.period {
        for _ in 0..map.period {
            orbit.advance().flight_time?;
        }
        let next = map.vector(orbit.state(), orbit.x());
        let change = moved(&here, &next);
        here = next;
        if change <= STAYS * speed {
            return Some(here);
        }
        let first = *first.get_or_insert(change);
        if !change.is_finite() || change > 1e3 * first.max(STAYS) {
            return None;
        }
    }
    (moved(&here, &map.image(&here)?) <= 0.1 * first?).then_some(here)
}

/// Newton's iteration. Beside the null vectors of A − 1 it solves P(s) = s, and along them it takes the kept quantities of the reference.
struct Newton<'a> {
    map: &'a ReturnMap,
    reference: &'a Vector,
    keeps_energy: bool,
}

impl Newton<'_> {
    fn solve(&self, guess: &Vector, share: f64) -> Result<RepeatingBounce, NoRepeatingBounce> {
        let map = self.map;
        let first_speed = guess[Y_DOT].abs();
        let mut at = *guess;
        let mut last = f64::INFINITY;
        for step in 0..MOST_STEPS {
            let speed = at[Y_DOT].abs();
            let Some(here) = map.derivative(&at) else { break };
            let scale = scales(map, speed);
            let Some(null) = NullSpace::of(&scaled(&here.matrix, &scale), share) else { break };
            let residual = between(map, &at, &here.image, &scale);
            let mut change = -(&null.inverse * &residual);
            change += self.along_family(&null, &at, &change, &scale);
            let size = change.amax() / speed;
            if !size.is_finite() {
                break;
            }
            let off = residual.amax() / speed;
            if size <= 1e-14 || (step > 4 && size >= 0.5 * last && size <= 1e-9) {
                let stays = (&null.left * &residual).amax() / speed;
                if null.left.nrows() > 0 && stays > SOLVED {
                    return Err(NoRepeatingBounce::Moves {
                        flight_time: map.flight_time(&at),
                        at: Box::new(at),
                        change: moves(map, &null, &residual, &scale),
                    });
                }
                if off > SOLVED {
                    break;
                }
                if speed <= AT_REST * first_speed {
                    return Err(NoRepeatingBounce::Rests);
                }
                return Ok(RepeatingBounce { residual: off, ..RepeatingBounce::bare(map, at, here.matrix) });
            }
            last = size;
            let fall = map.place_of(Y_DOT).map_or(0.0, |place| change[place].abs() / speed);
            // The place may be far off, and what it does is linear in it.
            let place = map.place_of(X);
            let beside = change.iter().enumerate().filter(|(index, _)| Some(*index) != place);
            let turned = beside.fold(0.0_f64, |most, (_, change)| most.max(change.abs())) / speed;
            let share = (LONGEST / fall.max(LONGEST)).min(1.0 / turned.max(1.0));
            at = map.moved(&at, &change.component_div(&scale).scale(share));
            if at[Y_DOT] >= -AT_REST * first_speed {
                return Err(NoRepeatingBounce::Rests);
            }
        }
        Err(NoRepeatingBounce::NotFound)
    }

    /// The part of a step along the family: to the kept quantities of the reference.
    fn along_family(&self, null: &NullSpace, at: &Vector, change: &DVector<f64>, scale: &DVector<f64>) -> DVector<f64> {
        let (map, mut rows) = (self.map, null.left.clone());
        let none = DVector::zeros(scale.len());
        if rows.is_empty() {
            return none;
        }
        let mut missing = &rows * (between(map, at, self.reference, scale) - change);
        let largest = |fall: usize| {
            let size = |row: &usize| rows[(*row, fall)].abs();
            (0..rows.nrows()).max_by(|one, other| size(one).total_cmp(&size(other))).map(|pivot| (pivot, fall))
        };
        if let Some((pivot, fall)) = map.place_of(Y_DOT).filter(|_| self.keeps_energy).and_then(largest)
            && rows[(pivot, fall)] != 0.0
        {
            // The energy itself in place of one of the quantities, the others without a part along ẏ.
            for other in (0..rows.nrows()).filter(|&other| other != pivot) {
                let share = rows[(other, fall)] / rows[(pivot, fall)];
                let less = rows.row(pivot) * share;
                let mut row = rows.row_mut(other);
                row -= less;
                missing[other] -= share * missing[pivot];
            }
            let energy = |vector: &Vector| map.body.energy(&map.state(vector));
            let gradient = energy_gradient(map, at).component_div(scale);
            rows.row_mut(pivot).copy_from(&gradient.transpose());
            missing[pivot] = energy(self.reference) - energy(at) - gradient.dot(change);
        }
        let system = &rows * &null.right;
        system.svd(true, true).solve(&missing, 1e-9).map_or(none, |shares| &null.right * shares)
    }
}

/// Change of a state a bounce along the neutral directions, by the residual that nothing beside them takes away.
fn moves(map: &ReturnMap, null: &NullSpace, residual: &DVector<f64>, scale: &DVector<f64>) -> Vector {
    let pairing = &null.left * &null.right;
    let shares = pairing.svd(true, true).solve(&(&null.left * residual), 1e-9);
    let along = shares.map_or_else(|_| residual.clone(), |shares| &null.right * shares);
    map.moved(&[0.0; COMPONENTS], &along.component_div(scale))
}

/// Derivative of the energy ½|v|² + Gl cos θ by the components of a map.
pub(super) fn energy_gradient(map: &ReturnMap, at: &Vector) -> DVector<f64> {
    let rod = &map.body.rod;
    let (sin, _) = trig::sin_cos(map.state(at).theta);
    let arc = -rod.gravity * rod.contact_distance * sin / rod.radius_of_gyration;
    let of = [arc, at[X_DOT], at[Y_DOT], at[SPIN], 0.0, 0.0, 0.0, 0.0];
    DVector::from_iterator(map.components().len(), map.components().into_iter().map(|index| of[index]))
}

/// Tells whether strikes keep the energy: over bounces beside the upright one it stays but for rounding.
pub(crate) fn keeps_energy(map: &ReturnMap, near: &Vector) -> bool {
    let speed = near[Y_DOT].abs();
    let aside = [(0.02, 0.05, -0.03), (-0.05, 0.1, 0.04)];
    aside.into_iter().all(|(theta, x_dot, spin)| {
        let mut start = *near;
        start[ARC] = theta * map.body.rod.radius_of_gyration;
        start[X_DOT] = x_dot * speed;
        start[SPIN] = spin * speed;
        let energy = |vector: &Vector| map.body.energy(&map.state(vector));
        map.image(&start).is_some_and(|end| (energy(&end) - energy(&start)).abs() <= 1e-12 * speed * speed)
    })
}

/// The neutral directions of a repeating bounce: null vectors of A − 1 along which the fixed points go on, and those that A − 1 takes to one
/// of them, as a drift moves the place.
fn families(found: &RepeatingBounce) -> Result<Vec<Neutral>, NoRepeatingBounce> {
    let speed = found.at[Y_DOT].abs();
    let scale = scales(&found.map, speed);
    let scaled = scaled(&found.matrix, &scale);
    let null = NullSpace::of(&scaled, EXACT).ok_or(NoRepeatingBounce::NotFound)?;
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in null.right.column_iter() {
        let step = column * (TRIED * speed);
        if goes_on(found, &null, &step.component_div(&scale), &scale) {
            kept.push(column.into_owned());
        }
    }
    if kept.is_empty() {
        return Ok(Vec::new());
    }
    // The space of the eigenvalue 1 with its blocks, ours first.
    let identity = DMatrix::identity(scale.len(), scale.len());
    let less = &scaled - &identity;
    let twice = NullSpace::of(&(&less * &less + identity), EXACT).ok_or(NoRepeatingBounce::NotFound)?;
    let family = DMatrix::from_columns(&kept);
    let onto = family.clone().pseudo_inverse(1e-9).map_err(|_| NoRepeatingBounce::NotFound)?;
    let outside = |vector: &DVector<f64>| (vector - &family * (&onto * vector)).amax();
    let (mut partners, mut others) = (Vec::new(), Vec::new());
    for column in twice.right.column_iter() {
        let own = column - &family * (&onto * column);
        if own.amax() > 1e-6 {
            let led = &less * &own;
            let is_partner = outside(&led) <= 1e-9 && led.amax() > 1e-9;
            if is_partner { &mut partners } else { &mut others }.push(own);
        }
    }
    let count = kept.len() + partners.len();
    let all = DMatrix::from_columns(&[kept, partners, others].concat());
    if all.ncols() != twice.left.nrows() {
        return Err(NoRepeatingBounce::NotFound);
    }
    let left = (&twice.left * &all).try_inverse().ok_or(NoRepeatingBounce::NotFound)? * &twice.left;
    Ok((0..count)
        .map(|n| Neutral {
            right: all.column(n).component_div(&scale),
            left: left.row(n).transpose().component_mul(&scale),
        })
        .collect())
}

/// Tells whether a fixed point lies beside another, a step along a null vector away: Newton's iteration beside the null vectors takes
/// away the whole residual.
fn goes_on(found: &RepeatingBounce, null: &NullSpace, step: &DVector<f64>, scale: &DVector<f64>) -> bool {
    let (map, speed) = (&found.map, found.at[Y_DOT].abs());
    let mut at = map.moved(&found.at, step);
    let mut off = f64::INFINITY;
    for _ in 0..8 {
        let Some(image) = map.image(&at) else { return false };
        let residual = between(map, &at, &image, scale);
        off = residual.amax() / speed;
        if off <= SOLVED {
            return true;
        }
        at = map.moved(&at, &(-(&null.inverse * residual)).component_div(scale));
    }
    off <= SOLVED
}
