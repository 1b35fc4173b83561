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

    const UNIT: Noise = Noise {
        timing_sd: 1.0,
        angle_sd: 1.0,
        x_sd: 1.0,
        x_dot_sd: 1.0,
        y_dot_sd: 1.0,
        theta_dot_sd: 1.0,
        ..Noise::NONE
    };

    fn pairs(noise: Noise, count: u64) -> Vec<[f64; 2]> {
        (1..=count).map(|n| noise.draw(n)).map(|NoiseSample { timing, angle }| [timing, angle]).collect()
    }

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
    fn the_bits_are_the_same_everywhere() {
        let scaled = Noise { timing_sd: 0.01, angle_sd: 0.002, seed: 42, run: 7, ..UNIT };
        // As an independent program in another language writes them.
        let drawn = [1, 2, 1 << 40].map(|n| scaled.draw(n)).map(|draw| (draw.timing, draw.angle));
        let expected = [
            (0.006430517087700217, 0.0024874819970712933),
            (0.0016157004282462736, -0.0006417178356275524),
            (0.008153461829551659, -0.0013828879717927367),
        ];
        assert_eq!(drawn, expected);
    }

    #[test]
    fn further_bits_are_the_same_everywhere() {
        let noise = Noise { seed: 42, run: 7, ..UNIT };
        // By the same independent program.
        let expected = [
            (1, [1.998_683_221_473_965_8, -0.606_985_613_882_709, -0.414_033_014_071_454_4, 0.701_187_843_488_220_6]),
            (
                2,
                [
                    -1.496_925_508_457_909_4,
                    0.489_510_378_271_340_75,
                    -0.781_401_636_777_242_7,
                    -0.394_536_825_370_496_06,
                ],
            ),
        ];
        for (n, [x, x_dot, y_dot, theta_dot]) in expected {
            assert_eq!(noise.sensing(n), Some(SensingErrors { x, x_dot, y_dot, theta_dot }));
            let sensed = Noise { x_dot_sd: 0.5, seed: 42, run: 7, ..Noise::NONE }.sensing(n);
            assert_eq!(sensed, Some(SensingErrors { x_dot: 0.5 * x_dot, ..SensingErrors::default() }));
        }
        let scattered = Noise { restitution_sd: 0.125, seed: 42, run: 7, ..Noise::NONE };
        assert_eq!(scattered.restitution(1, 0.5), 0.5 + 0.125 * -1.477_764_338_891_572_2);
        assert_eq!(scattered.sensing(1), None);
    }

    #[test]
    fn a_restitution_stays_in_its_range_with_the_bias_of_what_is_cut() {
        let count = 400_000_u64;
        let sd = 0.02;
        let noise = Noise { restitution_sd: sd, ..Noise::NONE };
        // −σ(φ(a) − a(1 − Φ(a))) for a cut a σ above the mean.
        for (above, bias) in [(0.0, -0.398_942_3), (1.0, -0.083_315_5), (3.0, -0.000_382_2)] {
            let nominal = 1.0 - above * sd;
            let drawn: Vec<f64> = (1..=count).map(|n| noise.restitution(n, nominal)).collect();
            assert!(drawn.iter().all(|e| (0.0..=1.0).contains(e)));
            let mean = drawn.iter().sum::<f64>() / count as f64;
            let off = (mean - nominal) / sd - bias;
            assert!(off.abs() < 4.0 / (count as f64).sqrt(), "{above}: {off}");
            // The cut at 0 is its mirror image: E[clamp(σz)] = σ/√(2π).
            let low = (1..=count).map(|n| noise.restitution(n, 0.0)).sum::<f64>() / count as f64;
            assert!((low / sd - 0.398_942_3).abs() < 4.0 / (count as f64).sqrt());
        }
    }

    #[test]
    fn the_errors_of_one_contact_are_normal_and_independent() {
        let count = 400_000_u64;
        let noise = Noise { restitution_sd: 1e-3, ..UNIT };
        let drawn: Vec<[f64; 7]> = (1..=count)
            .map(|n| {
                let (NoiseSample { timing, angle }, sensed) = (noise.draw(n), noise.sensing(n).unwrap());
                let SensingErrors { x, x_dot, y_dot, theta_dot } = sensed;
                [timing, angle, x, x_dot, y_dot, theta_dot, (noise.restitution(n, 0.5) - 0.5) / 1e-3]
            })
            .collect();
        let mean = |of: &dyn Fn(&[f64; 7]) -> f64| drawn.iter().map(of).sum::<f64>() / count as f64;
        let within = |mean: f64, expected: f64, spread: f64, what: (usize, usize)| {
            assert!((mean - expected).abs() < 4.5 * spread / (count as f64).sqrt(), "{what:?}: {mean} for {expected}");
        };
        for one in 0..7 {
            within(mean(&|errors| errors[one]), 0.0, 1.0, (one, one));
            within(mean(&|errors| errors[one].powi(2)), 1.0, 2.0_f64.sqrt(), (one, one));
            within(mean(&|errors| errors[one].powi(3)), 0.0, 15.0_f64.sqrt(), (one, one));
            within(mean(&|errors| errors[one].powi(4)), 3.0, 96.0_f64.sqrt(), (one, one));
            let beyond_two = |errors: &[f64; 7]| f64::from(u8::from(errors[one].abs() > 2.0));
            within(mean(&beyond_two), 0.045_500_263_9, 0.208_4, (one, one));
            for other in 0..one {
                within(mean(&|errors| errors[one] * errors[other]), 0.0, 1.0, (one, other));
                within(mean(&|errors| (errors[one] * errors[other]).powi(2)), 1.0, 8.0_f64.sqrt(), (one, other));
            }
        }
    }

    #[test]
    fn contacts_runs_and_seeds_have_nothing_to_do_with_each_other() {
        let count = 100_000_u64;
        let base = pairs(UNIT, count);
        let others = [
            pairs(Noise { run: 1, ..UNIT }, count),
            pairs(Noise { seed: 1, ..UNIT }, count),
            pairs(Noise { run: 1 << 32, ..UNIT }, count),
            pairs(Noise { seed: 1 << 32, ..UNIT }, count),
            pairs(UNIT, count + 1).split_off(1),
        ];
        for (which, other) in others.iter().enumerate() {
            for (of, from) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let correlation = base.iter().zip(other).map(|(a, b)| a[of] * b[from]).sum::<f64>() / count as f64;
                assert!(correlation.abs() < 4.5 / (count as f64).sqrt(), "{which} {of} {from}: {correlation}");
            }
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

    #[test]
    fn no_deviation_is_no_error() {
        let exact = Noise { timing_sd: 0.0, angle_sd: 0.0, ..UNIT };
        for n in 0..1000 {
            assert_eq!(exact.draw(n), NoiseSample { timing: 0.0, angle: 0.0 });
        }
    }
}
