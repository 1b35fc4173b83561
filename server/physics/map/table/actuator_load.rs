//! Load of a run on the table: tilt, tilt rate between strikes, speed and stroke. It decides whether a real table can do it.
//!
//! Between two strikes a rig is free to choose the motion. The values here are the least that any rig needs.

use crate::map::strike::Strike;
use crate::numbers::number::Arithmetic;
use thiserror::Error;

/// The table at a strike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<N = f64> {
    /// α, rad.
    pub alpha: N,
    /// Velocity in x and y, m/s.
    pub velocity: (N, N),
}

/// Load on the table: of one strike and the way to it, or the largest over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActuatorLoad<N = f64> {
    /// |α|, rad.
    pub tilt: N,
    /// |Δα| over the time between the strikes, rad/s: less than the largest rate of any way there.
    pub tilt_rate: N,
    /// Speed at a strike, m/s.
    pub speed: N,
    /// Vertical way between the strikes, m: from end to end of the cubic that leaves y = 0 at the one's velocity and comes back to
    /// it at the other's, the way of least mean square acceleration.
    pub stroke: N,
}

/// Largest load that the table can do; infinite where nothing limits it. Units as in [`ActuatorLoad`].
pub type ActuatorLimits = ActuatorLoad;

/// A limit that a strike goes beyond.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("a {quantity} of {value} {unit}; the table's limit is {limit} {unit}")]
pub struct LimitViolation {
    /// Which: a name of [`ActuatorLoad`]'s.
    pub quantity: &'static str,
    /// Value that the strike needs.
    pub value: f64,
    /// Limit of the table.
    pub limit: f64,
    /// The unit of both.
    pub unit: &'static str,
}

impl Pose {
    /// The table at this strike.
    #[inline(always)]
    pub fn of(strike: &Strike) -> Self {
        Self { alpha: strike.alpha, velocity: strike.table_velocity }
    }

    /// Load of this strike, after the last one and the flight between them, s, if there was one.
    #[inline(never)]
    pub fn load(&self, last: Option<(Self, f64)>) -> ActuatorLoad {
        let (x, y) = self.velocity;
        let (tilt_rate, stroke) = last.map_or((0.0, 0.0), |(last, time)| {
            // The least flights are so short that this would be infinite.
            let rate = ((self.alpha - last.alpha).abs() / time).min(f64::MAX);
            (rate, stroke(last.velocity.1, y, time))
        });
        ActuatorLoad { tilt: self.alpha.abs(), tilt_rate, speed: (x * x + y * y).sqrt(), stroke }
    }
}

mapped!(Pose: alpha; pairs velocity);
mapped!(ActuatorLoad: tilt, tilt_rate, speed, stroke);

impl<N: Arithmetic> Pose<N> {
    /// Bound on the load of this strike: the load itself but for the stroke. `time` of the last flight, s; 0 for none.
    #[inline(always)]
    pub(crate) fn most_load(&self, last: &Self, time: N) -> ActuatorLoad<N> {
        let ((x, y), (_, last_y)) = (self.velocity, last.velocity);
        let is_first = time.is_zero();
        // Either half of [`height_between`] is at most 4/27 of its speed times the time. The rest is for rounding.
        let share = N::from_f64(4.0 / 27.0 * (1.0 + 1e-9));
        let zero = N::from_f64(0.0);
        ActuatorLoad {
            tilt: self.alpha.magnitude(),
            tilt_rate: N::select(is_first, zero, (self.alpha - last.alpha).magnitude() / time),
            speed: (x * x + y * y).sqrt(),
            stroke: N::select(is_first, zero, share * time * (y.magnitude() + last_y.magnitude())),
        }
    }
}

impl<N: Arithmetic> ActuatorLoad<N> {
    #[inline(always)]
    pub(crate) fn is_within(&self, limits: &Self) -> N::Mask {
        self.tilt.is_at_most(limits.tilt)
            & self.tilt_rate.is_at_most(limits.tilt_rate)
            & self.speed.is_at_most(limits.speed)
            & self.stroke.is_at_most(limits.stroke)
    }
}

/// Height of the table at the share `s` of the time between two strikes, m: time·s(1 − s)(v₀(1 − s) − v₁s), the cubic that leaves y = 0
/// at v₀ and comes back to it at v₁, in m/s.
#[inline(always)]
pub fn height_between((v0, v1): (f64, f64), time: f64, s: f64) -> f64 {
    time * s * (1.0 - s) * (v0 * (1.0 - s) - v1 * s)
}

/// Maximum minus minimum of the height between two strikes over 0 ≤ s ≤ 1, m.
fn stroke(v0: f64, v1: f64, time: f64) -> f64 {
    // The derivative 3(v₀ + v₁)s² − (4v₀ + 2v₁)s + v₀ has two real roots: its discriminant is 4(v₀² + v₀v₁ + v₁²).
    let height = |s: f64| height_between((v0, v1), time, s);
    let half = 2.0 * v0 + v1;
    let root = (v0 * v0 + v0 * v1 + v1 * v1).sqrt();
    // Without cancellation: the root of the same sign first, the other from their product v₀/(3(v₀ + v₁)).
    let large = half + root.copysign(half);
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for s in [v0 / large, large / (3.0 * (v0 + v1))] {
        if (0.0..=1.0).contains(&s) {
            low = low.min(height(s));
            high = high.max(height(s));
        }
    }
    high - low
}

/// Largest load of a run so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadTracker {
    /// The most of each.
    pub most: ActuatorLoad,
    last: Option<(Pose, f64)>,
}

impl LoadTracker {
    /// Nothing so far, after this strike and this flight, s, if there was one.
    pub fn after(last: Option<(Pose, f64)>) -> Self {
        Self { last, ..Self::default() }
    }

    /// Takes in the next strike of the run, and the flight after it, s, if there is one.
    #[inline(always)]
    pub fn track(&mut self, strike: &Strike, flight_time: Option<f64>) {
        let pose = Pose::of(strike);
        self.most = self.most.or(pose.load(self.last));
        self.last = flight_time.map(|time| (pose, time));
    }

    /// Takes in the load of a contact, after which the next strike does not follow the last one.
    pub fn hold(&mut self, load: ActuatorLoad) {
        *self = Self { most: self.most.or(load), last: None };
    }

    /// The last strike and the flight after it, s.
    pub fn last(&self) -> Option<(Pose, f64)> {
        self.last
    }
}

impl ActuatorLoad {
    /// The more of each.
    #[inline]
    pub fn or(mut self, other: Self) -> Self {
        self.zip(&other, &mut |most, other: f64| *most = most.max(other));
        self
    }

    /// By name, with the unit.
    pub fn quantities(&self) -> [(&'static str, f64, &'static str); 4] {
        [
            ("tilt", self.tilt, "rad"),
            ("tilt_rate", self.tilt_rate, "rad/s"),
            ("speed", self.speed, "m/s"),
            ("stroke", self.stroke, "m"),
        ]
    }

    /// The first of these limits that `load` goes beyond.
    #[inline(never)]
    pub fn exceeded(&self, load: &ActuatorLoad) -> Option<LimitViolation> {
        let pairs = load.quantities().into_iter().zip(self.quantities());
        pairs
            .filter(|((_, value, _), (_, limit, _))| value > limit)
            .map(|((quantity, value, unit), (_, limit, _))| LimitViolation { quantity, value, limit, unit })
            .next()
    }
}
