//! A branch of periodic orbits along a parameter: pseudo-arclength continuation (H. B. Keller, 1977), which goes round
//! folds, and the places on it where stability changes, located.

use crate::analysis::periodic_orbits::multipliers::Bifurcation;
use crate::analysis::periodic_orbits::orbit::{
    ClosedOrbit, OrbitFailure, ParameterPath, PeriodicOrbit, ScaledPoint, SearchPlane, at_share, correct, share_of,
    symmetric_orbit_on_path, with_fewer_conditions,
};
use crate::analysis::root::root;
use crate::map::body::PreImpact;
use crate::map::strike::State;
use crate::scene::{Name, Scene};

/// Step along the branch at first, and at most; θ in rad, velocities in parts of the scene's, the parameter of its range.
const FIRST_STEP: f64 = 5e-3;
const LONGEST_STEP: f64 = 2e-2;
/// Step under which the branch is given up.
const SHORTEST_STEP: f64 = 1e-7;
/// cos of the angle by which the branch may turn in a step; beyond it the step is halved.
const LARGEST_TURN: f64 = 0.97;
/// Newton steps of a correction up to which the next step may be longer.
const EASY: u32 = 3;
/// Most changes that are located.
const MOST_CHANGES: usize = 32;
/// Value of a test up to which it is 0.
const ZERO: f64 = 1e-14;
/// Difference between orbit and half-way orbit, in parts of the scales, under which they are the same.
const HALVED: f64 = 1e-6;

/// A range of a scene's field.
#[derive(Clone, Copy, Debug)]
pub struct ParameterRange<'a> {
    /// The scene at every other field.
    pub scene: &'a Scene,
    /// The field, which must be a number.
    pub name: Name,
    /// First value of the parameter.
    pub from: f64,
    /// Last value; not equal to `from`.
    pub to: f64,
}

/// Start of a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BranchStart {
    /// Near the upright bounce, at `from`.
    Upright,
    /// Near a state, at `from`.
    Near(State),
    /// At the mirror-symmetric orbit of period 2 through an angle, rad; the branch goes both ways from there.
    Symmetric(f64),
}

/// An orbit on a branch.
#[derive(Clone, Debug)]
pub struct BranchPoint {
    /// Value of the parameter.
    pub parameter: f64,
    /// The orbit.
    pub orbit: PeriodicOrbit,
    /// Change of stability at this point; only at points that were located for it.
    pub change: Option<Bifurcation>,
    /// True if the branch begins or ends here at an orbit of half the period.
    pub springs: bool,
}

/// A branch, in its order.
#[derive(Clone, Debug)]
pub struct Branch {
    /// Points in order.
    pub points: Vec<BranchPoint>,
    /// Index of the point it was followed from.
    pub start: usize,
    /// Reasons for its ends, at its first point (if it was followed both ways) and at its last.
    pub ends: Vec<String>,
}

/// Follows a branch through its range, over at most `points` points besides those located; `go_on` is asked at each.
/// Fails where there is no orbit to start from. A branch that cannot go on is an answer, with the reason.
pub fn follow(
    sweep: &ParameterRange<'_>,
    period: usize,
    start: BranchStart,
    points: usize,
    mut go_on: impl FnMut() -> bool,
) -> Result<Branch, OrbitFailure> {
    let mut path = ParameterPath::along(sweep.scene, sweep.name, sweep.from, sweep.to)?;
    let near = |state| SearchPlane::at_parameter(path.place(&PreImpact::at(1, 0.0, state), 0.0));
    let plane = match start {
        BranchStart::Symmetric(theta) => SearchPlane::at(0, symmetric_orbit_on_path(&path, theta)?),
        BranchStart::Upright => near(path.start.upright()),
        BranchStart::Near(state) => near(state),
    };
    let first = with_fewer_conditions(&mut path, |path| correct(path, period, &plane.point, &plane))?;
    let lead = |along: ScaledPoint| first.closed.tangent(&along).ok_or_else(|| no_tangent(&first));
    let mut trail = BranchFollower { path: &path, period, budget: points.saturating_sub(1), changes: MOST_CHANGES };
    let own = trail.point(&first, None)?;
    let BranchStart::Symmetric(theta) = start else {
        let (mut after, end) = trail.walk(&first, lead(path.direction(path.components.len(), 1.0))?, &mut go_on)?;
        after.insert(0, own);
        return Ok(Branch { points: after, start: 0, ends: vec![end] });
    };
    // Inwards first, to where it springs from, with at most half of the points.
    let outwards = lead(path.direction(0, theta.signum()))?;
    let all = trail.budget;
    trail.budget = all / 2;
    let (mut before, inner) = trail.walk(&first, -&outwards, &mut go_on)?;
    trail.budget += all - all / 2;
    let (after, outer) = trail.walk(&first, outwards, &mut go_on)?;
    before.reverse();
    let start = before.len();
    before.push(own);
    before.extend(after);
    Ok(Branch { points: before, start, ends: vec![inner, outer] })
}

fn no_tangent(solution: &ClosedOrbit) -> OrbitFailure {
    OrbitFailure::NoConvergence { residual: solution.closed.residual(), steps: solution.steps }
}

/// A place of a walk along a branch: the orbit there, and the direction in which the branch goes on.
struct Walked {
    solution: ClosedOrbit,
    leads: ScaledPoint,
    orbit: PeriodicOrbit,
}

struct BranchFollower<'a> {
    path: &'a ParameterPath,
    period: usize,
    budget: usize,
    changes: usize,
}

impl BranchFollower<'_> {
    fn point(&self, solution: &ClosedOrbit, change: Option<Bifurcation>) -> Result<BranchPoint, OrbitFailure> {
        let share = share_of(&solution.place);
        let orbit = PeriodicOrbit::new(&self.path.problem(share)?, solution)?;
        Ok(BranchPoint { parameter: self.path.parameter(share), orbit, change, springs: false })
    }

    /// Goes on from a solution along a direction: the points after it, and why they end.
    fn walk(
        &mut self,
        first: &ClosedOrbit,
        direction: ScaledPoint,
        go_on: &mut impl FnMut() -> bool,
    ) -> Result<(Vec<BranchPoint>, String), OrbitFailure> {
        let mut points = Vec::new();
        let orbit = self.point(first, None)?.orbit;
        let mut here = Walked { solution: first.clone(), leads: direction, orbit };
        let mut step = FIRST_STEP;
        while self.budget > 0 {
            if !go_on() {
                return Err(OrbitFailure::Cancelled);
            }
            let (mut solution, mut leads) = match self.step(&here, step) {
                Ok(found) => found,
                Err(_) if step > SHORTEST_STEP => {
                    step *= 0.5;
                    continue;
                }
                Err(failure) => return Ok((points, format!("the branch could not be followed further: {failure}"))),
            };
            let (from, share) = (share_of(&here.solution.place), share_of(&solution.place));
            let end = share.clamp(0.0, 1.0);
            let is_end = share != end;
            if is_end {
                if from == end {
                    return Ok((points, self.reached(end)));
                }
                let part = (end - from) / (share - from);
                let guess = &here.solution.place + (&solution.place - &here.solution.place) * part;
                solution = self.at_share(guess, end, self.period)?;
                leads = solution.closed.tangent(&here.leads).ok_or_else(|| no_tangent(&solution))?;
            }
            let point = match self.point(&solution, None) {
                Ok(point) => point,
                Err(failure) => return Ok((points, format!("the branch ends: {failure}"))),
            };
            if let Some(point) = self.springs(&here.solution, &solution).filter(|_| !is_end) {
                let detail =
                    format!("the branch springs from an orbit of period {} at {}", self.period / 2, point.parameter);
                points.push(point);
                return Ok((points, detail));
            }
            if solution.steps <= EASY && here.leads.dot(&leads) > 1.0 - 0.3 * (1.0 - LARGEST_TURN) {
                step = f64::min(1.5 * step, LONGEST_STEP);
            }
            let next = Walked { solution, leads, orbit: point.orbit.clone() };
            self.locate(&mut points, &here, &next);
            points.push(point);
            if is_end {
                return Ok((points, self.reached(end)));
            }
            here = next;
            self.budget -= 1;
        }
        Ok((points, "the branch goes on beyond the limit of points".to_owned()))
    }

    fn reached(&self, end: f64) -> String {
        format!("the branch reaches the end of the range at {}", self.path.parameter(end))
    }

    /// One step: the solution in a plane across it and the direction there, if the branch does not turn too much on the way.
    fn step(&self, here: &Walked, step: f64) -> Result<(ClosedOrbit, ScaledPoint), OrbitFailure> {
        let point = &here.solution.place + &here.leads * step;
        let plane = SearchPlane { normal: here.leads.clone(), point };
        let next = correct(self.path, self.period, &plane.point, &plane)?;
        let leads = next.closed.tangent(&here.leads).ok_or_else(|| no_tangent(&next))?;
        let astray = (&next.place - &plane.point).norm() > 0.3 * step || here.leads.dot(&leads) < LARGEST_TURN;
        if astray && step > SHORTEST_STEP {
            return Err(no_tangent(&here.solution));
        }
        Ok((next, leads))
    }

    /// The orbit near a guess at a share of the range.
    fn at_share(&self, guess: ScaledPoint, share: f64, period: usize) -> Result<ClosedOrbit, OrbitFailure> {
        let plane = SearchPlane::at_parameter(at_share(guess, share));
        correct(self.path, period, &plane.point, &plane)
    }

    /// Difference of the states half a period apart, as a vector.
    fn half_way(&self, solution: &ClosedOrbit) -> Option<ScaledPoint> {
        let contacts = &solution.closed.contacts;
        if !self.period.is_multiple_of(2) {
            return None;
        }
        let share = share_of(&solution.place);
        let [here, there] = [0, self.period / 2].map(|n| self.path.place(&contacts[n], share));
        Some(there - here)
    }

    /// Where, between two points, the branch went through an orbit of half the period: beyond it come the same orbits again.
    fn springs(&mut self, here: &ClosedOrbit, next: &ClosedOrbit) -> Option<BranchPoint> {
        let (one, other) = (self.half_way(here)?, self.half_way(next)?);
        if one.norm() < HALVED || other.norm() < HALVED || one.dot(&other) >= 0.0 {
            return None;
        }
        let part = one.norm() / (one.norm() + other.norm());
        let middle = |solution: &ClosedOrbit| Some(&solution.place + 0.5 * self.half_way(solution)?);
        let (start, end) = (middle(here)?, middle(next)?);
        let guess = &start + (&end - &start) * part;
        // The half orbit's eigenvalue −1, by the secant rule in the parameter.
        let test = |share: f64| {
            let half = self.at_share(guess.clone(), share, self.period / 2).ok()?;
            let orbit = PeriodicOrbit::new(&self.path.problem(share).ok()?, &half).ok()?;
            Some((orbit.multipliers.test(Bifurcation::PeriodDoubling), half))
        };
        let (mut a, mut b) = (share_of(&guess), share_of(&guess) + 1e-4);
        let mut at_a = test(a)?.0;
        for _ in 0..40 {
            let (at_b, half) = test(b)?;
            if at_b.abs() < ZERO || at_b == at_a || (b - a).abs() < 1e-16 {
                let whole = self.at_share(half.place, b, self.period).ok()?;
                let point = self.point(&whole, Some(Bifurcation::PeriodDoubling)).ok()?;
                return Some(BranchPoint { springs: true, ..point });
            }
            let c = b - at_b * (b - a) / (at_b - at_a);
            (a, at_a, b) = (b, at_b, c);
        }
        None
    }

    /// Locates every change of stability between two points, and puts them behind those there are.
    fn locate(&mut self, points: &mut Vec<BranchPoint>, here: &Walked, next: &Walked) {
        let mut found: Vec<(f64, BranchPoint)> = Vec::new();
        // Along a fold the branch turns back.
        let turns = share_of(&here.leads) * share_of(&next.leads) < 0.0;
        let at_one = if turns { Bifurcation::Fold } else { Bifurcation::Pitchfork };
        for kind in [at_one, Bifurcation::PeriodDoubling, Bifurcation::NeimarkSacker] {
            let [low, high] = [here, next].map(|walked| walked.orbit.multipliers.test(kind));
            let is_pair = kind == Bifurcation::NeimarkSacker;
            let noise = if is_pair { 1e-7 } else { 1e-12 };
            let crosses = low.abs() > noise && high.abs() > noise && (low < 0.0) != (high < 0.0);
            // The test of the pair changes sign also for two real eigenvalues λ and 1/λ, which changes no stability.
            let counts = !is_pair || here.orbit.multipliers.stable != next.orbit.multipliers.stable;
            if !crosses || !counts || self.changes == 0 {
                continue;
            }
            if let Some((s, solution)) = self.zero(here, next, kind)
                && let Ok(point) = self.point(&solution, Some(kind))
            {
                self.changes -= 1;
                found.push((s, point));
            }
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0));
        points.extend(found.into_iter().map(|(_, point)| point));
    }

    /// Zero of a test along the branch, and how far along it is.
    fn zero(&self, here: &Walked, next: &Walked, kind: Bifurcation) -> Option<(f64, ClosedOrbit)> {
        let test = |orbit: &PeriodicOrbit| orbit.multipliers.test(kind);
        let (start, tangent) = (&here.solution.place, &here.leads);
        let chord = &next.solution.place - start;
        let way = tangent.dot(&chord);
        let mut last = None;
        root([(way, test(&next.orbit)), (0.0, test(&here.orbit))], ZERO, |s| {
            let plane = SearchPlane { normal: tangent.clone(), point: start + tangent * s };
            let solution = correct(self.path, self.period, &(start + &chord * (s / way)), &plane)?;
            let value = test(&self.point(&solution, None)?.orbit);
            last = Some((s, solution));
            Ok::<_, OrbitFailure>(Some(value))
        })
        .ok()?;
        last
    }
}
