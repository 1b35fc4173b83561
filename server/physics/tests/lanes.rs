//! Lanes and one orbit alone are the same: outcome, number of contacts and largest angle, bit for bit, over random rods.

use equipoise_physics::batch::batch_run::{
    LaneRunEnd, RunStart, run_batch, run_batch_on, run_batch_with_feedback, run_batch_with_friction,
    run_batch_with_friction_on,
};
use equipoise_physics::body::Body;
use equipoise_physics::body::general::GeneralBody;
use equipoise_physics::bounce::energy_feedback::EnergyFeedback;
use equipoise_physics::bounce::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::bounce::state::State;
use equipoise_physics::numbers::dispatch::InstructionSet;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::table::control_law::Steering;
use proptest::prelude::*;

prop_compose! {
    fn starts()(
        length in 0.02..2.0_f64, ratio in 0.2..1.5, tilt_gain in -0.5..2.5, near in any::<bool>(),
        theta in -1.0..1.0, x_dot in -1.0..1.0, y_dot in -4.0..-0.2, theta_dot in -30.0..30.0,
        energy_gain in prop_oneof![Just(0.0), -0.2..0.3], restitution in 0.2..1.0, above in 1.2..3.0,
        still in prop::bool::weighted(0.2),
    ) -> RunStart {
        let scale = if near { 0.05 } else { 1.0 };
        let energy_gain = if still { 0.0 } else { energy_gain };
        let settles = still || energy_gain != 0.0;
        RunStart {
            rod: Rod {
                contact_distance: length,
                radius_of_gyration: length * ratio,
                gravity: 9.81,
                restitution,
                tilt_gain,
                strike_gain: if still { 1.0 + restitution } else { 2.0 },
                strike_gain_per_energy: (1.0 + restitution) * energy_gain,
                target_energy: 9.81 * length * above,
                energy_feedback: EnergyFeedback::Vertical,
            },
            rules: Rules { topple_angle: std::f64::consts::FRAC_PI_2, settles, holds_energy: !settles, limits: None },
            state: State { theta: theta * scale, x_dot: x_dot * scale, y_dot, theta_dot: theta_dot * scale },
        }
    }
}

fn alone(start: &RunStart, impacts: u64) -> LaneRunEnd {
    alone_as(start.rod, start, impacts)
}

fn alone_as(body: impl Body, start: &RunStart, impacts: u64) -> LaneRunEnd {
    let mut orbit = Orbit::at(body, start.rules, start.state);
    let mut max_theta: f64 = 0.0;
    let ending = run(&mut orbit, impacts, |contact| {
        max_theta = max_theta.max(contact.state.theta.abs());
        true
    });
    LaneRunEnd { impacts: orbit.contacts(), outcome: ending.unwrap().into(), max_theta }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn lanes_are_orbits(starts in prop::collection::vec(starts(), 1..60), impacts in 1..400_u64) {
        let mut ends = vec![None; starts.len()];
        let mut next = starts.iter().copied().enumerate();
        run_batch(impacts, || next.next(), |number, end| ends[number] = Some(end), || true);
        for (start, end) in starts.iter().zip(ends) {
            prop_assert_eq!(end, Some(alone(start, impacts)), "{:?}", start);
        }
    }

    #[test]
    fn lanes_of_each_energy_feedback_are_orbits(
        starts in prop::collection::vec(starts(), 1..60), impacts in 1..400_u64,
        energy_feedback in prop_oneof![Just(EnergyFeedback::Total), Just(EnergyFeedback::OneStrike)],
        believed in prop_oneof![Just(2.0), 1.5..2.3],
    ) {
        let steered = |start: RunStart| {
            let strike_gain = if energy_feedback == EnergyFeedback::OneStrike { believed } else { start.rod.strike_gain };
            let rod = Rod { energy_feedback, strike_gain, ..start.rod };
            RunStart { rod, rules: Rules { settles: true, holds_energy: false, ..start.rules }, ..start }
        };
        let starts: Vec<_> = starts.into_iter().map(steered).collect();
        let mut ends = vec![None; starts.len()];
        let mut next = starts.iter().copied().enumerate();
        run_batch_with_feedback(energy_feedback, impacts, || next.next(), |number, end| ends[number] = Some(end), || true);
        for (start, end) in starts.iter().zip(ends) {
            prop_assert_eq!(end, Some(alone(start, impacts)), "{:?}", start);
        }
    }

    #[test]
    fn lanes_with_friction_are_orbits(
        starts in prop::collection::vec((starts(), 0.0..1.0), 1..60), impacts in 1..400_u64,
        law in prop_oneof![Just(RestitutionLaw::Poisson), Just(RestitutionLaw::Newton), Just(RestitutionLaw::Stronge)],
        slide in prop_oneof![Just(Slide::None), Just(Slide::Matched)],
    ) {
        let starts: Vec<_> = starts.into_iter().map(|(start, friction)| (without_held_energy(start), friction)).collect();
        let mut ends = vec![None; starts.len()];
        let mut next = starts.iter().enumerate().map(|(number, (start, friction))| (number, *start, *friction));
        run_batch_with_friction((law, slide), impacts, || next.next(), |number, end| ends[number] = Some(end), || true);
        for ((start, coefficient), end) in starts.iter().zip(ends) {
            let friction = Some(Friction { coefficient: *coefficient, law, slide });
            let general = GeneralBody { rod: start.rod, steering: Steering::TiltGain, program: None, friction, noise: None, outline: None };
            prop_assert_eq!(end, Some(alone_as(general, start, impacts)), "{:?} {:?}", start, friction);
        }
    }
}

/// A map of the paper's body, hashed (FNV-1a over contacts, outcome and the bits of the largest angle): the same number on
/// every path and on every CPU. It changes only when the numbers of answers do, and then CHANGELOG says so.
#[test]
fn every_kind_of_instructions_gives_the_same_bits() {
    const GOLDEN: u64 = 0xa2a1_67e7_f2f6_edcd;
    const GOLDEN_ROUGH: [(RestitutionLaw, [u64; 2]); 3] = [
        (RestitutionLaw::Poisson, [0x53c3_617b_a069_69e0, 0x2a29_45e5_4fc0_b45d]),
        (RestitutionLaw::Newton, [0xffbc_2451_2047_aa8c, 0xbc08_a5b3_c2af_c52a]),
        (RestitutionLaw::Stronge, [0xec71_3c15_df2a_6b0f, 0x04a4_66ca_7b5a_b01b]),
    ];
    let starts: Vec<RunStart> = (0..40 * 30)
        .map(|cell| {
            let (column, row) = (f64::from(cell % 40), f64::from(cell / 40));
            let rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.0 + column * 0.015);
            let rules = Rules { topple_angle: 1.5, settles: false, holds_energy: true, limits: None };
            let state = State { theta: row * 0.0175, x_dot: 0.0, y_dot: -1.15, theta_dot: 0.0 };
            RunStart { rod, rules, state }
        })
        .collect();
    let mut tried = 0;
    for path in InstructionSet::ALL.into_iter().filter(|path| path.is_there()) {
        let mut ends = vec![None; starts.len()];
        let mut next = starts.iter().copied().enumerate();
        run_batch_on(path, 300, || next.next(), |number, end| ends[number] = Some(end), || true);
        let hash = hash(&ends);
        assert_eq!(hash, GOLDEN, "{path:?}: {hash:#x}");
        for (law, golden) in GOLDEN_ROUGH {
            for (slide, golden) in [Slide::Matched, Slide::None].into_iter().zip(golden) {
                let mut next = starts.iter().enumerate().map(|(number, start)| {
                    let rod = Rod { restitution: 0.7, ..start.rod };
                    (number, without_held_energy(RunStart { rod, ..*start }), 0.01 * (number % 20) as f64)
                });
                let mut ends = vec![None; starts.len()];
                run_batch_with_friction_on(
                    path,
                    (law, slide),
                    300,
                    || next.next(),
                    |number, end| ends[number] = Some(end),
                    || true,
                );
                let hash = self::hash(&ends);
                assert_eq!(hash, golden, "{path:?}, {law:?}, {slide:?}: {hash:#x}");
            }
        }
        tried += 1;
    }
    assert!(tried > 0);
}

fn hash(ends: &[Option<LaneRunEnd>]) -> u64 {
    let words = ends.iter().flatten().flat_map(|end| [end.impacts, end.outcome as u64, end.max_theta.to_bits()]);
    words
        .flat_map(u64::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

fn without_held_energy(start: RunStart) -> RunStart {
    RunStart { rules: Rules { holds_energy: false, ..start.rules }, ..start }
}

#[test]
fn every_outcome_of_a_lane_occurs_and_a_sweep_can_be_stopped() {
    let rod = Rod::lossless(0.4 / 3.0, 0.094, 1.1);
    let rules = Rules { topple_angle: 1.5, settles: false, holds_energy: true, limits: None };
    let state = |theta, y_dot, theta_dot| State { theta, x_dot: 0.0, y_dot, theta_dot };
    let start = |rod, state| RunStart { rod, rules, state };
    let still = Rod { strike_gain: 1.5, ..rod };
    let wild = Rod { strike_gain_per_energy: 1e8, target_energy: 1e8, ..rod };
    let starts = [
        (start(rod, state(0.1, -1.0, 0.0)), EndingKind::Completed),
        (start(rod, state(1.6, -1.0, 0.0)), EndingKind::Toppled),
        (start(rod, state(0.0, 1.0, 0.0)), EndingKind::Separating),
        (start(Rod { tilt_gain: 3.0, ..rod }, state(0.4, -1.0, 0.0)), EndingKind::Sinking),
        (start(wild, state(0.1, -1.0, 0.0)), EndingKind::Diverged),
        (
            RunStart {
                rules: Rules { settles: true, holds_energy: false, ..rules },
                ..start(still, state(0.0, -1.0, 0.0))
            },
            EndingKind::Settled,
        ),
    ];
    let mut next = starts.iter().map(|(start, _)| *start).enumerate();
    let mut seen = vec![None; starts.len()];
    run_batch(100, || next.next(), |number, end| seen[number] = Some(end.outcome), || true);
    for ((start, outcome), seen) in starts.iter().zip(seen) {
        assert_eq!(seen, Some(*outcome));
        assert_eq!(alone(start, 100).outcome, *outcome);
    }
    let mut asked = 0;
    run_batch(
        u64::MAX,
        || Some((0, starts[0].0)),
        |_, _| (),
        || {
            asked += 1;
            asked < 5
        },
    );
    assert_eq!(asked, 5);
}
