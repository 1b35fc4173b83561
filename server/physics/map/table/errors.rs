//! Constant errors of a rig: biases, which no average over bounces removes.
//!
//! All of them together are other gains of the table's laws and one constant tilt beside them.

use crate::map::strike::PlannedTableMotion;
use crate::numbers::number::Number;

/// Constant errors of a table, and of the place of the centre of gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableErrors<N = f64> {
    /// b, rad: the table senses θ + b.
    pub angle_bias: N,
    /// c, rad: the table tilts by c more than it should.
    pub tilt_offset: N,
    /// ε_α: the table tilts by 1 + ε_α times what its law says.
    pub tilt_gain: N,
    /// ε_w: the table moves along its normal at 1 + ε_w times what its law says.
    pub speed: N,
    /// d, m: distance of the centre of gravity from the axis of the rod.
    pub offset: N,
}

impl<N: Number> TableErrors<N> {
    /// Errors in the order of their declaration.
    pub(crate) fn of([angle_bias, tilt_offset, tilt_gain, speed, offset]: [N; 5]) -> Self {
        Self { angle_bias, tilt_offset, tilt_gain, speed, offset }
    }

    /// (1 + ε_α) times a gain of the tilt.
    pub(crate) fn tilting(&self, gain: N) -> N {
        scaled(gain, self.tilt_gain)
    }

    /// (1 + ε_w) times a gain of the table's speed.
    pub(crate) fn moving(&self, gain: N) -> N {
        scaled(gain, self.speed)
    }

    /// The motion of a table that is told `told`.
    pub(crate) fn executed(&self, told: &PlannedTableMotion<N>) -> PlannedTableMotion<N> {
        PlannedTableMotion {
            alpha: self.tilting(told.alpha) + self.tilt_offset,
            normal_velocity: self.moving(told.normal_velocity),
            ..*told
        }
    }

    /// l = √(a² + d²), m: distance of the contact point from the centre of gravity, which is `along` (m) from it along the axis of the rod.
    pub(crate) fn contact_distance(&self, along: N) -> N {
        if self.offset.is_zero() { along } else { (along * along + self.offset * self.offset).sqrt() }
    }

    /// δ = arctan(d/a), rad: angle of the axis when the centre of gravity is above the contact point.
    pub(crate) fn lean(&self, along: N) -> N {
        if self.offset.is_zero() { self.offset } else { N::angle_of(self.offset, along) }
    }

    /// (1 + ε_w)(1 − ê)/(1 + ê): the table's velocity along its normal over −v_nc, at the wanted energy.
    pub(crate) fn make_up(&self, assumed: N) -> N {
        let one = N::from_f64(1.0);
        self.moving((one - assumed) / (one + assumed))
    }

    /// Tilt of the table beside its law of the true angle, rad: κ(b + δ) + c for a gain κ that has its error in it.
    pub(crate) fn constant_tilt(&self, gain: N, lean: N) -> N {
        let bias = self.angle_bias + lean;
        if bias.is_zero() { self.tilt_offset } else { gain * bias + self.tilt_offset }
    }
}

impl TableErrors {
    /// The restitution that a table without an error of its speed would have to assume to move as this one, which assumes `assumed`.
    pub(crate) fn effective_restitution(&self, assumed: f64) -> f64 {
        if self.speed == 0.0 {
            return assumed;
        }
        let made_up = self.make_up(assumed);
        (1.0 - made_up) / (1.0 + made_up)
    }
}

/// (1 + ε) times a number: the number itself without an error.
fn scaled<N: Number>(value: N, error: N) -> N {
    if error.is_zero() { value } else { value * (N::from_f64(1.0) + error) }
}
