//! Random errors of what the table senses and of its timing, and the scatter of restitution: normal deviates as a function of seed, run and
//! contact, so that no run depends on how many others there are, or on which thread takes it.

use crate::numbers::logarithm::ln_normal;
use crate::numbers::number::{Arithmetic, Number};
use crate::numbers::trig;
use rand_philox::philox4x32_10;

/// Meaning of a timing error for the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseModel {
    /// The paper's: it meets the object at the wrong time, wherever that then is.
    Strike,
    /// A real table: it carries out the plan made for the wrong time. The object meets that plane when it gets there.
    Plan,
}

names!(NoiseModel: Strike => "strike", Plan => "plan");

/// The noise of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation σ_t of the time that the table acts on, s.
    pub timing_sd: f64,
    /// Standard deviation of the angle that it senses, rad.
    pub angle_sd: f64,
    /// Standard deviation of the sensed place, m.
    pub x_sd: f64,
    /// Standard deviation of the sensed horizontal velocity, m/s.
    pub x_dot_sd: f64,
    /// Standard deviation of the sensed vertical velocity, m/s.
    pub y_dot_sd: f64,
    /// Standard deviation of the sensed angular velocity, rad/s.
    pub theta_dot_sd: f64,
    /// Standard deviation of the restitution from impact to impact.
    pub restitution_sd: f64,
    /// Time over which the table carries the state that it senses on to the strike, s: errors of velocities enter places and angles with it.
    pub horizon: f64,
    /// Meaning of a timing error.
    pub model: NoiseModel,
    /// Seed.
    pub seed: u64,
    /// Number of the run with this seed.
    pub run: u64,
}

impl Noise {
    /// No error.
    pub const NONE: Self = Self {
        timing_sd: 0.0,
        angle_sd: 0.0,
        x_sd: 0.0,
        x_dot_sd: 0.0,
        y_dot_sd: 0.0,
        theta_dot_sd: 0.0,
        restitution_sd: 0.0,
        horizon: 0.0,
        model: NoiseModel::Strike,
        seed: 0,
        run: 0,
    };

    /// Tells whether a velocity is sensed with an error.
    pub fn errs_in_velocity(&self) -> bool {
        [self.x_dot_sd, self.y_dot_sd, self.theta_dot_sd] != [0.0; 3]
    }
}

/// Errors of the sensed place (m) and velocities (m/s, rad/s) at one contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensingErrors<N = f64> {
    /// Error of x.
    pub x: N,
    /// Error of ẋ.
    pub x_dot: N,
    /// Error of ẏ.
    pub y_dot: N,
    /// Error of θ̇.
    pub theta_dot: N,
}

mapped!(SensingErrors: x, x_dot, y_dot, theta_dot);

/// Random errors at one contact, but for that of its time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactErrors<N = f64> {
    /// Error of the sensed angle, rad.
    pub(crate) angle: N,
    /// Errors of the sensed place and velocities; `None` if the table senses all of them exactly.
    pub(crate) sensing: Option<SensingErrors<N>>,
    /// Same as in [`Noise`], s.
    pub(crate) horizon: N,
    pub(crate) restitution: Option<N>,
}

mapped!(ContactErrors: angle, horizon; maybe sensing; optional restitution);

impl<N: Arithmetic> ContactErrors<N> {
    #[inline(always)]
    pub(crate) fn none() -> Self {
        let zero = N::from_f64(0.0);
        Self { angle: zero, sensing: None, horizon: zero, restitution: None }
    }
}

/// Blocks of random bits of one contact. Numbers of runs are below 2⁵³, so the highest byte of a counter is free to count blocks.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub(crate) enum Block {
    TimeAndAngle,
    /// x and ẋ.
    Along,
    /// ẏ and θ̇.
    Falling,
    /// Restitution, and a deviate that is not used.
    Restitution,
}

/// The errors at one contact, independent of each other and of those at any other contact, run or seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseSample {
    /// Error of the time, s.
    pub timing: f64,
    /// Error of the angle, rad.
    pub angle: f64,
}

impl Noise {
    /// The errors at contact `n`: a block of Philox4x32-10 (Salmon et al. 2011) with the seed as its key and (n, run) as its
    /// counter is 128 bits, just what one pair of normal deviates takes.
    #[inline(always)]
    pub fn draw(&self, n: u64) -> NoiseSample {
        let [first, second] = self.pair(n, Block::TimeAndAngle);
        NoiseSample { timing: self.timing_sd * first, angle: self.angle_sd * second }
    }

    /// Two normal deviates of contact `n`.
    #[inline(always)]
    pub(crate) fn pair(&self, n: u64, block: Block) -> [f64; 2] {
        let halves = |word: u64| [word as u32, (word >> 32) as u32];
        let ([n_low, n_high], [run_low, run_high]) = (halves(n), halves(self.run));
        let counter = [n_low, n_high, run_low, run_high | (block as u32) << 24];
        let [a, b, c, d] = philox4x32_10(counter, halves(self.seed));
        normals(joined(a, b), joined(c, d))
    }

    /// Errors of place and velocities at contact `n`; `None` if all are exact. Only pairs that err are drawn.
    pub fn sensing(&self, n: u64) -> Option<SensingErrors> {
        let pair = |sds: [f64; 2], block| {
            if sds == [0.0; 2] {
                return sds;
            }
            let [first, second] = self.pair(n, block);
            [sds[0] * first, sds[1] * second]
        };
        let errs = self.x_sd != 0.0 || self.errs_in_velocity();
        errs.then(|| {
            let [x, x_dot] = pair([self.x_sd, self.x_dot_sd], Block::Along);
            let [y_dot, theta_dot] = pair([self.y_dot_sd, self.theta_dot_sd], Block::Falling);
            SensingErrors { x, x_dot, y_dot, theta_dot }
        })
    }

    /// Restitution of contact `n` about its mean `restitution`. A draw below 0 is 0 and one above 1 is 1.
    ///
    /// At e = 1 half of the draws are cut, which lowers the mean by σ_e/√(2π). One σ_e below it is 0.083 σ_e, at three 0.0004 σ_e.
    pub fn restitution(&self, n: u64, restitution: f64) -> f64 {
        let sd = self.restitution_sd;
        if sd == 0.0 {
            return restitution;
        }
        let [deviate, _] = self.pair(n, Block::Restitution);
        (restitution + sd * deviate).clamp(0.0, 1.0)
    }

    /// The errors at contact `n` but for that of its time, of a body with this restitution.
    pub(crate) fn errors<N: Number>(&self, n: u64, restitution: N) -> ContactErrors<N> {
        let scatters = self.restitution_sd != 0.0;
        let errors = ContactErrors {
            angle: self.angle_error(n),
            sensing: self.sensing(n),
            horizon: self.horizon,
            restitution: scatters.then(|| self.restitution(n, restitution.to_f64())),
        };
        errors.map(N::from_f64)
    }

    /// Error of the angle at contact `n`, rad; without one no number is drawn.
    pub fn angle_error(&self, n: u64) -> f64 {
        if self.angle_sd == 0.0 { 0.0 } else { self.draw(n).angle }
    }
}

/// Two independent standard normal deviates from 2 × 64 random bits (Box and Muller 1958), at most √(−2 ln 2⁻⁵³) = 8.6.
#[inline(always)]
fn normals(radial: u64, angular: u64) -> [f64; 2] {
    const TO_UNIT: f64 = 1.0 / (1u64 << 53) as f64;
    // From 2⁻⁵³ to 1, so that its logarithm is finite.
    let share = ((radial >> 11) + 1) as f64 * TO_UNIT;
    let turn = (angular >> 11) as f64 * TO_UNIT;
    let radius = (-2.0 * ln_normal(share)).sqrt();
    let (sin, cos) = trig::sin_cos_reducible(std::f64::consts::TAU * turn);
    [radius * cos, radius * sin]
}

#[inline(always)]
fn joined(low: u32, high: u32) -> u64 {
    u64::from(low) | u64::from(high) << 32
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Noise = Noise { timing_sd: 1.0, angle_sd: 1.0, ..Noise::NONE };

    #[test]
    fn the_generator_gives_its_published_answers() {
        // Counter, key and block, from kat_vectors of Random123, the reference implementation by its authors.
        let known: [([u32; 4], [u32; 2], [u32; 4]); 3] = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, block) in known {
            assert_eq!(philox4x32_10(counter, key), block);
            // And a draw takes its bits from just this block.
            let noise = Noise { seed: joined(key[0], key[1]), run: joined(counter[2], counter[3]), ..UNIT };
            let [first, second] = normals(joined(block[0], block[1]), joined(block[2], block[3]));
            assert_eq!(noise.draw(joined(counter[0], counter[1])), NoiseSample { timing: first, angle: second });
        }
    }

    #[test]
    fn the_ends_of_the_uniform_are_finite() {
        for radial in [0, 1, u64::MAX, u64::MAX - 1, 1 << 63] {
            for angular in [0, 1, u64::MAX, 1 << 62, 1 << 63, 3 << 62] {
                let [first, second] = normals(radial, angular);
                assert!(first.abs() < 8.6 && second.abs() < 8.6, "{radial} {angular}: {first} {second}");
            }
        }
        assert_eq!(normals(u64::MAX, 0), [0.0, 0.0]);
        let [largest, none] = normals(0, 0);
        assert!((largest - 8.571_674_348_652_906).abs() < 1e-14 && none == 0.0, "{largest}");
    }
}
