//! The flight of a body between two contacts, in closed form: ballistic, or through air that drags it.
//!
//! Forces of the air are proportional to velocity, for place and rotation: v̇ = g − c(v − u) with the wind u along x, and θ̈ = −c_θθ̇. Exponential decay and its integrals are
//! accurate for any rate from 0 on: a power series for z = ct up to 1/8, and for a longer time as many doublings as it takes. All terms of a
//! doubling are positive, so that nothing cancels, and no exponential of a platform or library is needed.

use crate::map::strike::{PlannedTableMotion, Rod, State, Strike, Tilt};
use crate::numbers::number::{Arithmetic, Mask, Number};

/// A flight, from the moment it starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight<N = f64> {
    /// Angle and velocities at its start.
    pub start: State<N>,
    /// sin θ, cos θ at its start.
    pub sin_cos_theta: (N, N),
    /// h₀, height of the contact point above y = 0 at its start, m: 0 after a strike.
    pub clearance: N,
    /// l, m.
    pub contact_distance: N,
    /// G, m/s².
    pub gravity: N,
    /// Air that drags the body.
    pub drag: Option<AirDrag<N>>,
}

mapped!(Flight: clearance, contact_distance, gravity; pairs sin_cos_theta; parts start; vanishing drag);

/// Rates at which the air takes velocities away, and its own velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirDrag<N = f64> {
    /// c, 1/s, of the velocity of the centre of gravity.
    pub linear: N,
    /// c_θ, 1/s, of the angular velocity.
    pub rotational: N,
    /// u, m/s, velocity of the air along x.
    pub wind: N,
}

mapped!(AirDrag: linear, rotational, wind);

/// The gap between contact point and y = 0 with its derivatives in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<N = f64> {
    /// g, m.
    pub value: N,
    /// g', m/s: the vertical velocity of the contact point.
    pub slope: N,
    /// g'', m/s².
    pub bend: N,
}

impl<N: Arithmetic> AirDrag<N> {
    /// Drag with these rates, 1/s, of air that does not move; `None` if both are 0.
    #[inline(always)]
    pub fn new(linear: N, rotational: N) -> Option<Self> {
        Self { linear, rotational, wind: N::from_f64(0.0) }.unless_zero()
    }

    #[inline(always)]
    pub(crate) fn unless_zero(self) -> Option<Self> {
        let is_none = self.linear.is_zero() & self.rotational.is_zero();
        (!is_none.all()).then_some(self)
    }

    pub(crate) fn decays(&self, t: N) -> (Decay<N>, Decay<N>) {
        let Self { linear, rotational, .. } = *self;
        let (place, are_alike) = (Decay::new(linear, t), (rotational - linear).is_zero());
        let turn = if are_alike.all() { place } else { Decay::new(rotational, t) };
        (place, Decay::select(are_alike, place, turn))
    }

    /// Rates at which the air takes ẋ, ẏ (m/s²) and θ̇ (rad/s²) in a flight.
    #[inline(always)]
    pub(crate) fn taken(&self, [x_dot, y_dot, theta_dot]: [N; 3]) -> [N; 3] {
        [self.linear * (x_dot - self.wind), self.linear * y_dot, self.rotational * theta_dot]
    }

    /// The state of a flight some time before another, with the way along x between them, m. `decays` are those of that time.
    #[inline(always)]
    pub(crate) fn before(&self, (place, turn): &(Decay<N>, Decay<N>), gravity: N, state: &State<N>) -> (N, State<N>) {
        let State { theta, x_dot, y_dot, theta_dot } = *state;
        let push = self.push();
        let (along, spin) = ((x_dot - push * place.way) / place.left, theta_dot / turn.left);
        let then = State {
            theta: theta - turn.way * spin,
            x_dot: along,
            y_dot: (y_dot + gravity * place.way) / place.left,
            theta_dot: spin,
        };
        (place.way * along + push * place.fall, then)
    }

    /// cu, m/s²: acceleration along x of a body at rest.
    #[inline(always)]
    pub(crate) fn push(&self) -> N {
        self.linear * self.wind
    }
}

impl<N: Number> Gap<N> {
    /// Tells whether a contact point that is at y = 0 goes down from there or stays.
    #[inline(always)]
    pub(crate) fn falls(&self) -> bool {
        let slope = self.slope.to_f64();
        slope < 0.0 || (slope == 0.0 && self.bend.to_f64() <= 0.0)
    }
}

impl<N: Arithmetic> Flight<N> {
    /// g(t), the height of the contact point, with its derivatives.
    #[inline(always)]
    pub fn gap(&self, t: N) -> Gap<N> {
        match &self.drag {
            None => self.ballistic_gap(t),
            Some(drag) => self.gap_in_air(drag, t),
        }
    }

    /// g(t) = h₀ + ẏt − ½Gt² + l cos θ − l cos(θ + θ̇t), eq. (8).
    /// The two cosines are written as l (sin θ sin u + cos θ (1 − cos u)), u = θ̇t, so that with h₀ = 0 the trivial root
    /// t = 0 is divided out analytically and short flights keep their relative accuracy.
    #[inline(always)]
    pub(crate) fn ballistic_gap(&self, t: N) -> Gap<N> {
        let State { y_dot, theta_dot, .. } = self.start;
        let (sin, versine) = (theta_dot * t).sin_versine();
        let (sin_theta, cos_theta) = self.sin_cos_theta;
        let (reach_x, reach_y) = (self.contact_distance * sin_theta, self.contact_distance * cos_theta);
        let spin = self.contact_distance * theta_dot;
        let (speed_x, speed_y) = (spin * cos_theta, spin * sin_theta);
        let fall = self.gravity * t;
        let turned = speed_x * sin - speed_y * versine;
        Gap {
            value: (self.clearance + t * (y_dot - N::from_f64(0.5) * fall)) + (reach_x * sin + reach_y * versine),
            slope: ((y_dot + speed_y) - fall) + turned,
            bend: (speed_x - (speed_x * versine + speed_y * sin)) * theta_dot - self.gravity,
        }
    }

    // Apart, so that loops without air stay small; likewise below.
    #[inline(never)]
    fn gap_in_air(&self, drag: &AirDrag<N>, t: N) -> Gap<N> {
        self.gap_decayed(drag, &drag.decays(t))
    }

    /// g(t) = h₀ + ẏs − Gr + l cos θ − l cos(θ + θ̇s_θ) without its root 0; s is [`Decay::way`], r [`Decay::fall`].
    #[inline(always)]
    pub(crate) fn gap_decayed(&self, drag: &AirDrag<N>, (place, turn): &(Decay<N>, Decay<N>)) -> Gap<N> {
        let Self { start, sin_cos_theta: (sin_theta, cos_theta), clearance, contact_distance, gravity, .. } = *self;
        let State { y_dot, theta_dot, .. } = start;
        let (sin, versine) = (theta_dot * turn.way).sin_versine();
        let omega = theta_dot * turn.left;
        let sin_then = sin_theta + (cos_theta * sin - sin_theta * versine);
        let cos_then = cos_theta - (cos_theta * versine + sin_theta * sin);
        let turned = contact_distance * (sin_theta * sin + cos_theta * versine);
        let pull = gravity + drag.linear * y_dot;
        let braked = drag.rotational * sin_then;
        Gap {
            value: (clearance + (y_dot * place.way - gravity * place.fall)) + turned,
            slope: (y_dot * place.left - gravity * place.way) + contact_distance * omega * sin_then,
            bend: contact_distance * omega * (omega * cos_then - braked) - pull * place.left,
        }
    }

    /// Angle and velocities after a time `t`.
    #[inline(always)]
    pub fn end(&self, t: N) -> State<N> {
        let State { theta, x_dot, y_dot, theta_dot } = self.start;
        match &self.drag {
            None => State { theta: theta + theta_dot * t, x_dot, y_dot: y_dot - self.gravity * t, theta_dot },
            Some(drag) => self.end_in_air(drag, t),
        }
    }

    #[inline(never)]
    fn end_in_air(&self, drag: &AirDrag<N>, t: N) -> State<N> {
        let (place, turn) = drag.decays(t);
        let State { theta, x_dot, y_dot, theta_dot } = self.start;
        State {
            theta: theta + theta_dot * turn.way,
            x_dot: x_dot * place.left + drag.push() * place.way,
            y_dot: y_dot * place.left - self.gravity * place.way,
            theta_dot: theta_dot * turn.left,
        }
    }

    /// Way of the centre of gravity along x and up after a time `t`, m.
    #[inline(always)]
    pub fn travel(&self, t: N) -> (N, N) {
        let State { x_dot, y_dot, .. } = self.start;
        match &self.drag {
            None => (x_dot * t, t * (y_dot - N::from_f64(0.5) * (self.gravity * t))),
            Some(drag) => self.travel_in_air(drag, t),
        }
    }

    #[inline(never)]
    fn travel_in_air(&self, drag: &AirDrag<N>, t: N) -> (N, N) {
        let Decay { way, fall, .. } = Decay::new(drag.linear, t);
        let State { x_dot, y_dot, .. } = self.start;
        (x_dot * way + drag.push() * fall, y_dot * way - self.gravity * fall)
    }

    /// l θ̇², m/s²: up to G the gap of a ballistic flight is concave.
    #[inline(always)]
    pub(crate) fn bulge(&self) -> N {
        self.contact_distance * self.start.theta_dot * self.start.theta_dot
    }
}

impl<N: Number> Flight<N> {
    /// c and c_θ, 1/s, in doubles.
    #[inline(always)]
    pub(crate) fn drag_rates(&self) -> (f64, f64) {
        self.drag.map_or((0.0, 0.0), |drag| (drag.linear.to_f64(), drag.rotational.to_f64()))
    }

    /// A root of the gap found in doubles, carried over to this kind of number by Newton's iteration: in dual numbers that
    /// is the exact derivative of the implicit contact time, ∂τ = −∂g/ẏ_c⁻.
    #[inline(always)]
    pub fn lift_root(&self, root: f64) -> N {
        if N::UNIT < f64::EPSILON {
            return self.refine_root(root);
        }
        let mut t = N::from_f64(root);
        for _ in 0..N::NEWTON_STEPS {
            let gap = self.gap(t);
            t = t - gap.value / gap.slope;
        }
        t
    }

    /// A root of the gap found in doubles, with all digits of a number that has more.
    fn refine_root(&self, root: f64) -> N {
        let State { y_dot, theta_dot, .. } = self.start.map(N::to_f64);
        let ((linear, rotational), spin) = (self.drag_rates(), theta_dot.abs());
        // Bounds of the second derivative (m/s²), and of the third as a multiple of it (1/s).
        let pull = self.gravity.to_f64() + linear * y_dot.abs();
        let bend = pull + self.contact_distance.to_f64() * spin * (spin + rotational);
        let quickness = spin + linear.max(4.0 * rotational);
        let mut t = N::from_f64(root);
        let mut last = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            let gap = self.gap(t);
            let step = gap.value / gap.slope;
            let size = step.to_f64().abs();
            // Steps that shrink no more have met rounding, or a graze that doubles see and these digits do not.
            if size.is_nan() || size >= last {
                break;
            }
            // The second derivative too (Chebyshev), a term that doubles hold. The third order is left out.
            let bent = 0.5 * step.to_f64() * gap.bend.to_f64() / gap.slope.to_f64();
            let next = t - (step + N::from_f64(step.to_f64() * bent));
            // The trivial root at the start is no contact.
            if next.to_f64() <= 0.0 {
                break;
            }
            t = next;
            let stiffness = bend / gap.slope.to_f64().abs() + quickness;
            if size * (size * stiffness) * (size * stiffness) <= NEGLIGIBLE * root {
                break;
            }
            last = size;
        }
        t
    }
}

/// Most steps of Newton's iteration to the last digit: one does, except where the rod grazes the table.
const MAX_STEPS: u32 = 64;

/// Share of a root below which what a step leaves out no longer counts.
const NEGLIGIBLE: f64 = 1e-33;

impl<N: Arithmetic> Rod<N> {
    /// The flight that follows a strike.
    #[inline(always)]
    pub fn flight(&self, strike: &Strike<N>) -> Flight<N> {
        Flight {
            start: strike.after,
            sin_cos_theta: strike.sin_cos_theta,
            clearance: N::from_f64(0.0),
            contact_distance: self.contact_distance,
            gravity: self.gravity,
            drag: None,
        }
    }
}

impl Flight {
    /// Time to the top of a flight that rises, s.
    pub fn time_to_top(&self) -> f64 {
        let (rise, gravity) = (self.start.y_dot, self.gravity);
        match self.drag {
            Some(AirDrag { linear, .. }) if linear != 0.0 => libm::log1p(linear * rise / gravity) / linear,
            Some(_) | None => rise / gravity,
        }
    }
}

impl<N: Arithmetic> PlannedTableMotion<N> {
    /// A flight as seen from the planned table, a plane that moves along its normal. It was set out to strike the state `seen` at the time
    /// `struck` (s), with the contact at y = 0.
    /// The body flies as over a level table: with β for θ, and gravity's part along the normal.
    #[inline(always)]
    pub(crate) fn relative(&self, flight: &Flight<N>, struck: N, seen: &State<N>) -> Flight<N> {
        let alpha = self.alpha;
        let Tilt { sin_theta, sin_alpha, cos_alpha, .. } = Tilt::new(seen.theta, alpha, seen.theta - alpha);
        let length = flight.contact_distance;
        let State { theta, x_dot, y_dot, theta_dot } = flight.start;
        let (sin, cos) = flight.sin_cos_theta;
        // The contact point at the start of the flight, from the planned one at the planned time.
        let across = length * (sin - sin_theta) - flight.travel(struck).0;
        let above = flight.clearance * cos_alpha - sin_alpha * across + self.normal_velocity * struck;
        Flight {
            start: State {
                theta: theta - alpha,
                x_dot: N::from_f64(0.0),
                y_dot: cos_alpha * y_dot - sin_alpha * x_dot - self.normal_velocity,
                theta_dot,
            },
            sin_cos_theta: (sin * cos_alpha - cos * sin_alpha, cos * cos_alpha + sin * sin_alpha),
            clearance: above,
            contact_distance: length,
            gravity: match flight.drag {
                None => flight.gravity * cos_alpha,
                // The air moves past the plane.
                Some(drag) => flight.gravity * cos_alpha + drag.linear * self.normal_velocity + drag.push() * sin_alpha,
            },
            drag: flight.drag,
        }
    }

    /// Velocity of the contact point along the normal of the table, relative to it, m/s.
    pub(crate) fn approach(&self, rod: &Rod<N>, state: &State<N>) -> N {
        let (sin_theta, cos_theta) = state.theta.sincos();
        let (sin, cos) = self.alpha.sincos();
        let spin = rod.contact_distance * state.theta_dot;
        cos * (state.y_dot + spin * sin_theta) - sin * (state.x_dot + spin * cos_theta) - self.normal_velocity
    }
}

/// Largest z = ct for which the series is summed.
const SERIES_END: f64 = 0.125;

/// z = ct beyond which e^(−z) is 0 in doubles.
const NOTHING_LEFT: f64 = 800.0;

/// A velocity that decays at a rate c, after a time t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay<N> {
    /// e^(−ct): share of the velocity that is left.
    pub left: N,
    /// (1 − e^(−ct))/c, s: way of a body that starts at 1 m/s. It is t for c = 0.
    pub way: N,
    /// (t − way)/c, s²: way of a body that starts at rest and is pulled by 1 m/s². It is t²/2 for c = 0.
    pub fall: N,
}

impl<N: Arithmetic> Decay<N> {
    /// The decay at a `rate` (1/s, not negative) over a time `t` (s, not negative).
    pub fn new(rate: N, t: N) -> Self {
        let number = N::from_f64;
        let (zero, one, half) = (number(0.0), number(1.0), number(0.5));
        let (is_free, free) = (rate.is_zero(), Self { left: one, way: t, fall: half * t * t });
        if is_free.all() {
            return free;
        }
        let is_over = number(NOTHING_LEFT).is_less(rate * t);
        let (mut part, mut doublings) = (t, zero);
        loop {
            let is_long = number(SERIES_END).is_less(rate * part) & !is_over;
            if !is_long.any() {
                break;
            }
            part = N::select(is_long, half * part, part);
            doublings = N::select(is_long, doublings + one, doublings);
        }
        let z = rate * part;
        // (z − 1 + e^(−z))/z² = (1 − z/3 (1 − z/4 (1 − …)))/2.
        let mut series = one;
        for term in (3..=N::SERIES_TERMS).rev() {
            series = one - z / number(f64::from(term)) * series;
        }
        let series = half * series;
        let mean = one - z * series;
        let mut decay = Self { left: one - z * mean, way: part * mean, fall: part * part * series };
        loop {
            let doubles = zero.is_less(doublings);
            if !doubles.any() {
                break;
            }
            let Self { left, way, fall } = decay;
            let twice = Self { left: left * left, way: way * (one + left), fall: fall + fall + way * way };
            decay = Self::select(doubles, twice, decay);
            doublings = doublings - one;
        }
        if is_over.any() {
            let way = one / rate;
            decay = Self::select(is_over, Self { left: zero, way, fall: (t - way) * way }, decay);
        }
        Self::select(is_free, free, decay)
    }

    #[inline(always)]
    pub(crate) fn select(mask: N::Mask, yes: Self, no: Self) -> Self {
        Self {
            left: N::select(mask, yes.left, no.left),
            way: N::select(mask, yes.way, no.way),
            fall: N::select(mask, yes.fall, no.fall),
        }
    }
}
