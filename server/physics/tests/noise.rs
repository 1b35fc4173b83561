//! Random errors of what the table senses: their bits, their distribution, and their independence.

use equipoise_physics::map::table::noise::{Noise, NoiseSample, SensingErrors};

const UNIT: Noise =
    Noise { timing_sd: 1.0, angle_sd: 1.0, x_sd: 1.0, x_dot_sd: 1.0, y_dot_sd: 1.0, theta_dot_sd: 1.0, ..Noise::NONE };

fn pairs(noise: Noise, count: u64) -> Vec<[f64; 2]> {
    (1..=count).map(|n| noise.draw(n)).map(|NoiseSample { timing, angle }| [timing, angle]).collect()
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
        (2, [-1.496_925_508_457_909_4, 0.489_510_378_271_340_75, -0.781_401_636_777_242_7, -0.394_536_825_370_496_06]),
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
fn no_deviation_is_no_error() {
    let exact = Noise { timing_sd: 0.0, angle_sd: 0.0, ..UNIT };
    for n in 0..1000 {
        assert_eq!(exact.draw(n), NoiseSample { timing: 0.0, angle: 0.0 });
    }
}
