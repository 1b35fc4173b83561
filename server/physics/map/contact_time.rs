//! End of a flight: the first time at which a point comes down to y = 0, found with a certificate, without sampling.
//!
//! A root is decided and certified in doubles, and carried over to other kinds of numbers ([`Flight::lift_root`]).
//!
//! For l θ̇² ≤ G the gap is concave, and Newton's method converges to its one root from the right. For a faster spin the flight is
//! cut at the inflections of the gap into convex and concave pieces. On each piece a down-crossing is found or excluded. Through air,
//! parabolas below the gap exclude one until Newton's iteration is certain of it.

use crate::map::flight::{AirDrag, Decay, Flight, Gap};
use crate::map::strike::State;
use crate::numbers::number::{Arithmetic, Number};
use std::cell::Cell;
use std::f64::consts::TAU;

/// Most pieces that one flight may be cut into, whatever its gravity and spin.
///
/// The contact point can be at y = 0 only while the centre of gravity is within l of it: once on the way up, once on the way
/// down. In there it is at or above y = 0 when it points up and at or below it when it points down, so it comes down within
/// three half turns. A turn has two inflections: that is at most 5 pieces each way. The rest is for rounding; a flight of so
/// many turns that its angle has no digits left passes the limit, and its run ends as `diverged`.
pub const MAX_PIECES: u32 = 32;

/// Most Newton steps for one root: a double root (grazing) halves its error a step, all others square it.
const MAX_STEPS: u32 = 128;

/// Most parabolas that bound one flight through air. A fast spin needs some tens for each of three half turns.
const MAX_PARABOLAS: u32 = 2048;

/// A flight was cut into more than [`MAX_PIECES`] pieces, or bounded by more than [`MAX_PARABOLAS`], without a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyPieces;

/// Time from the start of a flight to its end, s. It starts above y = 0, or on it upwards: t = 0 is not a contact.
#[inline(always)]
pub fn first_contact<N: Number>(flight: &Flight<N>) -> Result<N, TooManyPieces> {
    let mut rounded = flight.map(N::to_f64);
    let root = match short_flight(flight, &mut rounded) {
        Some(root) => root,
        None => look_for_contact(&rounded, || ())?,
    };
    Ok(flight.lift_root(root))
}

/// [`first_contact`] of a flight that may start on y = 0 and not rise: that ends at t = 0.
pub fn first_contact_from_rest<N: Number>(flight: &Flight<N>) -> Result<N, TooManyPieces> {
    let zero = N::from_f64(0.0);
    if flight.clearance.to_f64() == 0.0 && flight.gap(zero).falls() { Ok(zero) } else { first_contact(flight) }
}

/// Time at which a point first comes *down* through y = 0, s from the start of its flight; `None` if it never does.
/// It may start anywhere; from below (h₀ < 0, or h₀ = 0 moving down) it must rise through y = 0 first, not just to it.
pub fn first_descent<N: Number>(flight: &Flight<N>) -> Result<Option<N>, TooManyPieces> {
    let root = first_descent_before(&flight.map(N::to_f64), f64::INFINITY)?;
    Ok(root.map(|root| flight.lift_root(root)))
}

/// [`first_descent`], if it is up to a time `limit`, s: what lies beyond costs nothing.
pub fn first_descent_before(flight: &Flight, limit: f64) -> Result<Option<f64>, TooManyPieces> {
    let start = flight.gap(0.0);
    let rises = start.slope > 0.0 || (start.slope == 0.0 && start.bend > 0.0);
    let above = start.value > 0.0 || (start.value == 0.0 && rises);
    if !is_concave(flight) {
        return search(flight, || (), above, limit);
    }
    if !above && start.slope <= 0.0 {
        return Ok(None);
    }
    let end = latest_contact(flight).min(limit);
    if end <= 0.0 {
        return Ok(None);
    }
    let at_end = flight.gap(end);
    if at_end.value > 0.0 {
        // At the latest contact only rounding leaves it above.
        return Ok((end < limit).then_some(end));
    }
    if above {
        return look_for_contact(flight, || ()).map(|t| Some(t.min(limit)));
    }
    let (root, is_certain) = last_root(flight, || (), 0.0, end, at_end);
    Ok(is_certain.then_some(root))
}

/// Largest share of the rise that doubles may miss where the root is looked for in them.
const RESOLVED: f64 = 0.01;

/// The length of a flight that rises too slowly for doubles, whose sum ẏ + lθ̇ sin θ is rounding: 2ẏ_c/(G − lθ̇² cos θ) without drag, where
/// that is so short that the gap is concave all the way, so that it has no other root. Where it is not, the contact point goes on rising,
/// and `rounded` is made to rise.
#[inline(always)]
fn short_flight<N: Number>(flight: &Flight<N>, rounded: &mut Flight) -> Option<f64> {
    if N::UNIT >= f64::EPSILON || rounded.clearance != 0.0 {
        return None;
    }
    let State { y_dot, theta_dot, .. } = flight.start;
    let rise = (y_dot + flight.contact_distance * theta_dot * flight.sin_cos_theta.0).to_f64();
    let State { y_dot, theta_dot, .. } = rounded.start;
    let (sin, cos) = rounded.sin_cos_theta;
    let turned = rounded.contact_distance * theta_dot * sin;
    let missed = (y_dot + turned - rise).abs();
    if rise <= 0.0 || missed <= RESOLVED * rise {
        return None;
    }
    let (linear, rotational) = rounded.drag_rates();
    let bend = (rounded.gravity + linear * y_dot) - (rounded.bulge() * cos - rotational * turned);
    let root = 2.0 * rise / bend;
    // Bound of the third derivative.
    let spin = theta_dot.abs();
    let change = linear * (rounded.gravity + linear * y_dot.abs())
        + rounded.contact_distance * spin * (spin + 2.0 * rotational) * (spin + 2.0 * rotational);
    if bend > 0.0 && 10.0 * change * root <= bend {
        return Some(root);
    }
    rounded.start.y_dot += 4.0 * f64::EPSILON * (y_dot.abs() + turned.abs());
    None
}

/// Number of times that [`first_contact`] evaluates the gap of a flight. It is done for that, so it is not for loops in a hurry.
pub fn evaluations(flight: &Flight) -> u64 {
    let count = Cell::new(0);
    let _ = look_for_contact(flight, || count.set(count.get() + 1));
    count.get()
}

#[inline(always)]
fn is_concave(flight: &Flight) -> bool {
    flight.drag.is_none() && flight.bulge() <= flight.gravity
}

/// [`first_descent_before`] where the gap is not concave.
fn search(flight: &Flight, evaluated: impl Fn() + Copy, above: bool, limit: f64) -> Result<Option<f64>, TooManyPieces> {
    match &flight.drag {
        Some(drag) => first_descent_in_air(flight, evaluated, drag, above, limit),
        None => first_descent_spinning(flight, evaluated, above, limit, &mut { MAX_PIECES }),
    }
}

/// [`first_contact`] where the gap is not concave.
// Takes copies, so that loops of concave gaps keep their own in registers.
#[cold]
#[inline(never)]
fn search_from_above(flight: Flight, evaluated: impl Fn() + Copy) -> Result<f64, TooManyPieces> {
    search(&flight, evaluated, true, f64::INFINITY)?.ok_or(TooManyPieces)
}

#[inline(always)]
fn gap_at(flight: &Flight, t: f64, evaluated: impl Fn()) -> Gap {
    evaluated();
    flight.ballistic_gap(t)
}

#[inline(always)]
fn look_for_contact(flight: &Flight, evaluated: impl Fn() + Copy) -> Result<f64, TooManyPieces> {
    if !is_concave(flight) {
        return search_from_above(*flight, evaluated);
    }
    let start = if flight.clearance == 0.0 { guess(flight) } else { guess_from_above(flight) };
    let gap = gap_at(flight, start, evaluated);
    // For l θ̇² near G the guess may be off by many powers of ten, and Newton's method would only halve the error in each step.
    if gap.slope < 0.0 && start > 0.0 && gap.value > 0.25 * start * gap.slope {
        return Ok(last_root(flight, evaluated, 0.0, start, gap).0);
    }
    let end = latest_contact(flight);
    Ok(last_root(flight, evaluated, 0.0, end, gap_at(flight, end, evaluated)).0)
}

/// Start of the search for the contact time of a flight from the table.
/// To fourth order g = v t − a t²/2 − b t³/6 − c t⁴/24. With t = 2v/a · s the root solves s = 1 − P s² − Q s³, inverted
/// here as a series. It is a start and no more: Newton's first slope decides whether a good one.
#[inline(always)]
pub(crate) fn guess<N: Arithmetic>(flight: &Flight<N>) -> N {
    let number = N::from_f64;
    let State { y_dot, theta_dot, .. } = flight.start;
    let (sin, cos) = flight.sin_cos_theta;
    let speed = flight.contact_distance * theta_dot;
    let bulge = flight.bulge();
    let v = y_dot + speed * sin;
    let per_a = number(1.0) / (flight.gravity - bulge * cos);
    let rough = number(2.0) * v * per_a;
    let turn = theta_dot * rough;
    let curl = bulge * per_a;
    let p = curl * turn * sin * number(1.0 / 3.0);
    let q = curl * turn * turn * cos * number(1.0 / 12.0);
    rough * (((number(1.0) - q) - p) + number(2.0) * p * p)
}

/// Start of the search on a flight from above the table: the root of the gap to second order.
#[inline(always)]
pub(crate) fn guess_from_above<N: Arithmetic>(flight: &Flight<N>) -> N {
    let (zero, two) = (N::from_f64(0.0), N::from_f64(2.0));
    let (sin, cos) = flight.sin_cos_theta;
    let v = flight.start.y_dot + flight.contact_distance * flight.start.theta_dot * sin;
    let a = flight.gravity - flight.bulge() * cos;
    let square = v * v + two * a * flight.clearance;
    let root = N::select(zero.is_less(square), square, zero).sqrt();
    // Neither is a difference.
    N::select(v.is_less(zero), two * flight.clearance / (root - v), (v + root) / a)
}

/// The time by which the centre of gravity has fallen to y = −l, so that the contact came before or is there.
#[inline(always)]
pub(crate) fn latest_contact<N: Arithmetic>(flight: &Flight<N>) -> N {
    passes(flight, room(flight)).1
}

/// The time before which the centre of gravity is lower than y = −l; `None` if it stays so.
fn earliest_contact(flight: &Flight) -> Option<f64> {
    let (room, y_dot) = (room(flight), flight.start.y_dot);
    if room >= 0.0 {
        return Some(0.0);
    }
    (y_dot > 0.0 && y_dot * y_dot + 2.0 * flight.gravity * room >= 0.0).then(|| passes(flight, room).0)
}

/// Height of the centre of gravity above y = −l at the start, m.
#[inline(always)]
fn room<N: Arithmetic>(flight: &Flight<N>) -> N {
    let (zero, one) = (N::from_f64(0.0), N::from_f64(1.0));
    let (sin, cos) = flight.sin_cos_theta;
    // 1 + cos θ, near a rod that stands on its head too.
    let rise = N::select(cos.is_less(zero), sin * sin / (one - cos), one + cos);
    flight.clearance + flight.contact_distance * rise
}

/// Times at which the centre of gravity was and will be `drop`, m, lower than at the start, s: the roots of ½Gt² − ẏt − d, neither from a
/// difference, which would leave a fall in little gravity few digits.
#[inline(always)]
fn passes<N: Arithmetic>(flight: &Flight<N>, drop: N) -> (N, N) {
    let (zero, two) = (N::from_f64(0.0), N::from_f64(2.0));
    let y_dot = flight.start.y_dot;
    let square = y_dot * y_dot + two * flight.gravity * drop;
    let sum = y_dot.magnitude() + N::select(zero.is_less(square), square, zero).sqrt();
    let far = sum / flight.gravity;
    let near = N::select(zero.is_less(sum), two * drop / sum, zero);
    let falls = y_dot.is_less(zero);
    (N::select(falls, -far, -near), N::select(falls, near, far))
}

/// The last root of a gap that is concave from `from` to `t`, where it is `gap`, at or below zero or right of the root; and true if the gap is
/// above zero before it. Newton's iteration.
/// Every iterate after the first is right of the root and they decrease; so one that turns back has met rounding and is
/// the root. Passing the top proves that the gap is below zero all the way, or that the root is a double one to rounding; so does passing
/// `from`, since the tangent lies above the gap. The last step uses the second derivative too, as soon as what it leaves out is below half a
/// unit in the last place.
#[inline(always)]
fn last_root(flight: &Flight, evaluated: impl Fn() + Copy, from: f64, mut t: f64, mut gap: Gap) -> (f64, bool) {
    for steps in 0..MAX_STEPS {
        if gap.slope >= 0.0 || t < from {
            return (t, gap.value > 0.0 && t >= from);
        }
        let step = NewtonStep::new(flight, t, &gap);
        // A step most of the way back to zero would keep the rounding of the longer time.
        if step.left_out <= step.negligible && step.newton > -0.5 * t {
            return (step.refined, true);
        }
        if steps > 0 && step.newton >= 0.0 {
            return (t, true);
        }
        t += step.newton;
        gap = gap_at(flight, t, evaluated);
    }
    (t, false)
}

/// One step from `t`: Newton's, and one that uses the second derivative too.
pub(crate) struct NewtonStep<N> {
    pub(crate) newton: N,
    /// The better t.
    pub(crate) refined: N,
    /// Bound on the error of `refined`.
    pub(crate) left_out: N,
    /// Half a unit in the last place of t, and less.
    pub(crate) negligible: N,
}

impl<N: Arithmetic> NewtonStep<N> {
    #[inline(always)]
    pub(crate) fn new(flight: &Flight<N>, t: N, gap: &Gap<N>) -> Self {
        let number = N::from_f64;
        let spin = flight.start.theta_dot.magnitude();
        let stiffness = flight.gravity + flight.bulge();
        let per_slope = number(1.0) / gap.slope;
        let newton = -(gap.value * per_slope);
        let size = newton.magnitude();
        let bent = size * stiffness * per_slope.magnitude();
        Self {
            newton,
            refined: t + newton * (number(1.0) - number(0.5) * (gap.bend * per_slope) * newton),
            left_out: size * bent * (bent + size * spin),
            negligible: number(f64::EPSILON * 0.25) * t,
        }
    }
}

/// [`first_descent_before`] where l θ̇² > G, of a point that starts `above` y = 0 or not. `budget` counts pieces left.
fn first_descent_spinning(
    flight: &Flight,
    evaluated: impl Fn() + Copy,
    mut above: bool,
    limit: f64,
    budget: &mut u32,
) -> Result<Option<f64>, TooManyPieces> {
    let pieces = GapPieces::new(flight, evaluated);
    let latest = latest_contact(flight);
    let end = latest.min(limit);
    // While the centre of gravity is lower than −l, the point is below the table.
    let Some(enters) = earliest_contact(flight) else { return Ok(None) };
    // While it is higher than l, the rod cannot reach the table.
    let State { y_dot, .. } = flight.start;
    let (sin, cos) = flight.sin_cos_theta;
    let versine = if cos > 0.0 { sin * sin / (1.0 + cos) } else { 1.0 - cos };
    let height = flight.clearance - flight.contact_distance * versine;
    let reach = y_dot * y_dot + 2.0 * flight.gravity * height;
    let (leaves, returns) = if reach > 0.0 { passes(flight, height) } else { (end, end) };
    for (from, to, comes_back) in [(enters, leaves.min(end), false), (returns.max(enters), end, returns > 0.0)] {
        above |= reach > 0.0 && comes_back;
        if from < to
            && let Some(t) = pieces.first_down_crossing(from, to, &mut above, budget)?
        {
            return Ok(Some(t));
        }
    }
    Ok((above && latest < limit).then_some(latest))
}

/// The pieces between the inflections of the gap, at cos(θ + θ̇t) = G/(l θ̇²).
struct GapPieces<'a, E> {
    flight: &'a Flight,
    evaluated: E,
    /// |θ̇|, and θ seen so that it grows.
    spin: f64,
    angle: f64,
    /// The gap is convex where the angle is within this of a whole turn.
    half_width: f64,
}

impl<'a, E: Fn() + Copy> GapPieces<'a, E> {
    fn new(flight: &'a Flight, evaluated: E) -> Self {
        let State { theta, theta_dot, .. } = flight.start;
        let bulge = flight.contact_distance * theta_dot * theta_dot;
        Self {
            flight,
            evaluated,
            spin: theta_dot.abs(),
            angle: theta * theta_dot.signum(),
            half_width: libm::acos(flight.gravity / bulge),
        }
    }

    fn gap(&self, t: f64) -> Gap {
        gap_at(self.flight, t, self.evaluated)
    }

    fn time_of(&self, angle: f64) -> f64 {
        (angle - self.angle) / self.spin
    }

    /// `above` tells whether the point has been above y = 0; it is updated.
    fn first_down_crossing(
        &self,
        from: f64,
        to: f64,
        above: &mut bool,
        budget: &mut u32,
    ) -> Result<Option<f64>, TooManyPieces> {
        let angle = self.angle + self.spin * from;
        let mut turn = ((angle + self.half_width) / TAU).floor();
        let mut convex = angle - TAU * turn < self.half_width;
        let (mut a, mut at_a) = (from, self.gap(from));
        loop {
            *budget = budget.checked_sub(1).ok_or(TooManyPieces)?;
            let boundary = if convex {
                TAU * turn + self.half_width
            } else {
                turn += 1.0;
                TAU * turn - self.half_width
            };
            let b = self.time_of(boundary).clamp(a, to);
            let at_b = self.gap(b);
            let crossing = match (*above, convex) {
                (true, true) => self.in_convex(a, at_a, b, at_b),
                (true, false) => self.in_concave(a, at_a, b, at_b),
                // A convex gap that starts below zero can only cross upwards.
                (false, true) => None,
                (false, false) => self.in_concave_from_below(a, at_a, b, at_b),
            };
            *above |= at_b.value > 0.0;
            if crossing.is_some() || b >= to {
                return Ok(crossing);
            }
            (a, at_a, convex) = (b, at_b, !convex);
        }
    }

    /// A concave gap that starts positive, or at zero going up, crosses once if it ends at or below zero.
    fn in_concave(&self, a: f64, at_a: Gap, b: f64, at_b: Gap) -> Option<f64> {
        if a > 0.0 && at_a.value <= 0.0 && at_a.slope < 0.0 {
            return Some(a);
        }
        if at_b.value > 0.0 || b <= a {
            return None;
        }
        Some(if at_b.slope < 0.0 { last_root(self.flight, self.evaluated, a, b, at_b).0 } else { b })
    }

    /// A concave gap that starts below zero and ends there crosses twice or not at all.
    fn in_concave_from_below(&self, a: f64, at_a: Gap, b: f64, at_b: Gap) -> Option<f64> {
        if at_a.slope <= 0.0 || at_b.value > 0.0 || at_b.slope >= 0.0 || b <= a {
            return None;
        }
        let (root, is_certain) = last_root(self.flight, self.evaluated, a, b, at_b);
        is_certain.then_some(root)
    }

    /// A convex gap falls towards its first zero, if it has one, and Newton from the left never passes it; past the lowest
    /// point there is none.
    fn in_convex(&self, a: f64, at_a: Gap, b: f64, at_b: Gap) -> Option<f64> {
        if at_a.slope >= 0.0 || b <= a {
            return None;
        }
        if at_a.value <= 0.0 {
            return Some(a);
        }
        if at_b.value > 0.0 && at_b.slope <= 0.0 {
            return None;
        }
        let (mut t, mut gap) = (a, at_a);
        for _ in 0..MAX_STEPS {
            let next = t - gap.value / gap.slope;
            if next > b {
                return if at_b.value > 0.0 { None } else { Some(b) };
            }
            if next <= t {
                break;
            }
            (t, gap) = (next, self.gap(next));
            if gap.slope >= 0.0 {
                return if gap.value > 0.0 { None } else { Some(t) };
            }
        }
        Some(t)
    }
}

struct Bounds {
    /// Most by which the centre of gravity is accelerated downwards, m/s², and upwards.
    falling: f64,
    rising: f64,
    /// Most by which the turning accelerates the contact point, m/s².
    spinning: f64,
    /// Most by which the third derivative of the gap exceeds the second, 1/s.
    quickness: f64,
    /// Height of the centre of gravity above y = 0, m, and its velocity, m/s.
    height: f64,
    y_dot: f64,
}

impl Bounds {
    /// Bounds from the time on to which the velocities have decayed like this.
    fn from(flight: &Flight, drag: &AirDrag, (place, turn): &(Decay<f64>, Decay<f64>)) -> Self {
        let Flight { start, sin_cos_theta, clearance, contact_distance, gravity, .. } = *flight;
        let AirDrag { linear, rotational, .. } = *drag;
        let omega = (start.theta_dot * turn.left).abs();
        // ÿ = −(G + cẏ₀)e^(−ct) keeps its sign.
        let pull = (gravity + linear * start.y_dot) * place.left;
        Self {
            falling: pull.max(0.0),
            rising: (-pull).max(0.0),
            // l|ω² cos θ − c_θω sin θ|, and |ω| only decays.
            spinning: contact_distance * omega * (omega * omega + rotational * rotational).sqrt(),
            quickness: omega + linear.max(4.0 * rotational),
            height: (clearance + contact_distance * sin_cos_theta.1) + (start.y_dot * place.way - gravity * place.fall),
            y_dot: start.y_dot * place.left - gravity * place.way,
        }
    }
}

/// Least time in which a height ≥ 0 with rate `slope` may fall to 0, accelerated by `most` at most; infinite if never.
fn time_to_fall(height: f64, slope: f64, most: f64) -> f64 {
    let root = (slope * slope + 2.0 * most * height).sqrt();
    // Neither is a difference.
    if slope > 0.0 {
        (slope + root) / most
    } else if height == 0.0 {
        0.0
    } else {
        2.0 * height / (root - slope)
    }
}

/// [`first_descent_before`] through air, of a point that starts `above` y = 0 or below it.
/// All velocities decay, so a bound on the second derivative of the gap from now on is known in closed form: g″ ≥ −M. The parabola with the
/// gap's value and slope and with −M for its second derivative lies below the gap, so the gap has no zero before that of the parabola.
/// From there the next parabola starts. The steps never pass a zero, and near a simple one they square the error. They end where Newton's
/// iteration provably converges to the zero ahead, and that is the only one (Kantorovich's condition).
fn first_descent_in_air(
    flight: &Flight,
    evaluated: impl Fn() + Copy,
    drag: &AirDrag,
    mut above: bool,
    limit: f64,
) -> Result<Option<f64>, TooManyPieces> {
    let length = flight.contact_distance;
    let mut t = 0.0;
    for _ in 0..MAX_PARABOLAS {
        if t > limit {
            return Ok(None);
        }
        evaluated();
        let decays = drag.decays(t);
        let gap = flight.gap_decayed(drag, &decays);
        let bounds = Bounds::from(flight, drag, &decays);
        let step = if above {
            let most = bounds.falling + bounds.spinning;
            if gap.slope < 0.0 && is_certain(&gap, most + bounds.rising) {
                let t = converged(flight, evaluated, drag, t, (gap, bounds));
                return Ok((t <= limit).then_some(t));
            }
            // Only rounding brings it to 0 or below.
            if t > 0.0 && gap.value <= 0.0 && gap.slope <= 0.0 {
                return Ok(Some(t));
            }
            let own = time_to_fall(gap.value.max(0.0), gap.slope, most);
            // While the centre of gravity is higher than l, the point cannot reach the table.
            let spare = bounds.height - length;
            let clear = if spare > 0.0 { time_to_fall(spare, bounds.y_dot, bounds.falling) } else { 0.0 };
            own.max(clear)
        } else {
            if gap.slope > 0.0 && gap.value >= 0.0 {
                above = true;
                continue;
            }
            let own = time_to_fall(-gap.value.min(0.0), -gap.slope, bounds.rising + bounds.spinning);
            // While the centre of gravity is lower than −l, the point is below the table; one that falls there never rises again.
            let lack = bounds.height + length;
            let buried = if lack >= 0.0 {
                0.0
            } else if bounds.y_dot <= 0.0 {
                return Ok(None);
            } else {
                time_to_fall(-lack, -bounds.y_dot, bounds.rising)
            };
            let step = own.max(buried);
            if gap.slope > 0.0 && step <= 2.0 * f64::EPSILON * t {
                above = true;
                continue;
            }
            step
        };
        if !step.is_finite() {
            return if above { Err(TooManyPieces) } else { Ok(None) };
        }
        let stands = step <= 2.0 * f64::EPSILON * t;
        if stands && above && t > 0.0 {
            return Ok(Some(t));
        }
        // A step in which the point moves by less than rounding.
        let rounding = (2.0 * f64::EPSILON * length / (bounds.falling + bounds.rising + bounds.spinning)).sqrt();
        t += if stands { rounding } else { step };
    }
    Err(TooManyPieces)
}

/// Kantorovich's condition: a falling gap has one zero within twice a Newton step, if |second derivative| ≤ `most`.
fn is_certain(gap: &Gap, most: f64) -> bool {
    2.0 * most * gap.value.abs() <= gap.slope * gap.slope
}

/// Most Newton steps: from where it is certain that there is one zero each squares the error; at a double zero each halves it.
const MAX_STEPS_IN_AIR: u32 = 64;

/// The zero near `t`, where the gap is like this and does not rise, by Newton's iteration.
fn converged(
    flight: &Flight,
    evaluated: impl Fn(),
    drag: &AirDrag,
    mut t: f64,
    (mut gap, mut bounds): (Gap, Bounds),
) -> f64 {
    let mut last = f64::INFINITY;
    for _ in 0..MAX_STEPS_IN_AIR {
        if gap.slope >= 0.0 {
            return t;
        }
        let newton = -gap.value / gap.slope;
        let size = newton.abs();
        if size >= last || newton <= -t {
            return t;
        }
        let bent = size * (bounds.falling + bounds.rising + bounds.spinning) / gap.slope.abs();
        // The second derivative too; that leaves out terms of third order.
        let left_out = size * bent * (bent + size * bounds.quickness);
        if left_out <= 0.25 * f64::EPSILON * t {
            return t + newton * (1.0 - 0.5 * (gap.bend / gap.slope) * newton);
        }
        t += newton;
        last = size;
        evaluated();
        let decays = drag.decays(t);
        (gap, bounds) = (flight.gap_decayed(drag, &decays), Bounds::from(flight, drag, &decays));
    }
    t
}

#[cfg(test)]
#[path = "contact_time_tests.rs"]
mod tests;
