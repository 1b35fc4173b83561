//! Lanes and one orbit alone are the same: outcome, number of contacts and largest angle, bit for bit, over random rods.

use crate::support::lone_runs;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{EnergyFeedback, Rod, State};
use equipoise_physics::map::table::control_law::{Gains, Steering};
use equipoise_physics::map::table::noise::Noise;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::numbers::dispatch::InstructionSet;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::lanes::batch_run::{LaneRunEnd, Watch, run_all, run_batch_on, run_watched};
use equipoise_physics::run::lanes::model::BatchModel;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use proptest::prelude::*;

use lone_runs::{alone, changes_energy, paths, rods};

/// A rod and the start of its run.
#[derive(Clone, Copy, Debug)]
struct Start {
    rod: Rod,
    rules: Rules,
    state: State,
}

impl Start {
    fn orbit(&self) -> Orbit {
        Orbit::at(Body::plain(self.rod), self.rules, self.state)
    }

    /// The same run with friction or a feedback.
    fn general(&self, steering: Steering, friction: Option<Friction>) -> Orbit {
        let body = Body { steering, friction, ..Body::plain(self.rod) };
        let holds_energy = self.rules.holds_energy && friction.is_none();
        Orbit::at(body, Rules { holds_energy, ..self.rules }, self.state)
    }

    fn point(&self) -> Orbit {
        let State { x_dot, y_dot, .. } = self.state;
        let rules = Rules { topple_angle: f64::INFINITY, ..self.rules };
        Orbit::at(Body::point(self.rod), rules, Body::point_state(x_dot, y_dot))
    }
}

prop_compose! {
    fn starts()(
        rod in rods(1.2), near in any::<bool>(), theta in -1.0..1.0_f64, x_dot in -1.0..1.0, y_dot in -4.0..-0.2,
        theta_dot in -30.0..30.0,
    ) -> Start {
        let (scale, settles) = (if near { 0.05 } else { 1.0 }, changes_energy(&rod));
        Start {
            rod,
            rules: Rules { topple_angle: std::f64::consts::FRAC_PI_2, settles, holds_energy: !settles, limits: None, half_length: f64::INFINITY },
            state: State { theta: theta * scale, x_dot: x_dot * scale, y_dot, theta_dot: theta_dot * scale },
        }
    }
}

prop_compose! {
    fn feedbacks()(theta in -2.5..0.5_f64, x in -0.2..0.2, x_dot in -0.2..0.2, theta_dot in -0.2..0.2) -> Steering {
        Steering::Feedback(Gains { x, theta, x_dot, theta_dot })
    }
}

fn energy_feedbacks() -> impl Strategy<Value = EnergyFeedback> {
    prop_oneof![Just(EnergyFeedback::Vertical), Just(EnergyFeedback::Total), Just(EnergyFeedback::OneStrike)]
}

fn contacts() -> impl Strategy<Value = (RestitutionLaw, Slide)> {
    let law = prop_oneof![Just(RestitutionLaw::Poisson), Just(RestitutionLaw::Newton), Just(RestitutionLaw::Stronge)];
    (law, prop_oneof![Just(Slide::None), Just(Slide::Matched)])
}

/// The start with another energy feedback, whose strike gain a table with another belief of e has.
fn steered(start: Start, energy_feedback: EnergyFeedback, believed: f64) -> Start {
    if energy_feedback == EnergyFeedback::Vertical {
        return start;
    }
    let strike_gain = if energy_feedback == EnergyFeedback::OneStrike { believed } else { start.rod.strike_gain };
    let rod = Rod { energy_feedback, strike_gain, ..start.rod };
    Start { rod, rules: Rules { settles: true, holds_energy: false, ..start.rules }, ..start }
}

fn model_of(orbits: &[Orbit], rules: &Rules) -> BatchModel {
    BatchModel::of(&orbits[0].body, rules).expect("they fit into lanes")
}

fn in_lanes(path: InstructionSet, model: BatchModel, orbits: &[Orbit], impacts: u64) -> Vec<LaneRunEnd> {
    let mut ends = vec![None; orbits.len()];
    let mut next = orbits.iter().copied().enumerate();
    let mut done = |number: usize, end| ends[number] = Some(end);
    assert!(run_batch_on(path, model, impacts, &mut || next.next(), &mut done, &mut || true));
    ends.into_iter().map(|end| end.expect("each run ends")).collect()
}

/// Holds lanes of all paths against the runs alone.
fn assert_alike(orbits: &[Orbit], rules: &Rules, impacts: u64) -> Result<(), TestCaseError> {
    let model = model_of(orbits, rules);
    let expected: Vec<LaneRunEnd> = orbits.iter().map(|orbit| alone(*orbit, impacts)).collect();
    for path in paths() {
        for ((orbit, end), expected) in orbits.iter().zip(in_lanes(path, model, orbits, impacts)).zip(&expected) {
            prop_assert_eq!(end, *expected, "{:?} {:?}", path, orbit);
            prop_assert_eq!(end.max_theta.to_bits(), expected.max_theta.to_bits());
        }
    }
    Ok(())
}

/// Parts of the bodies and tables of a batch, beside the plain rod's.
#[derive(Clone, Copy, Debug)]
struct Parts {
    feeds_back: bool,
    contact: Option<(RestitutionLaw, Slide)>,
    is_point: bool,
    has_program: bool,
    errs: bool,
    energy_feedback: EnergyFeedback,
    believed: f64,
}

prop_compose! {
    fn parts()(
        feeds_back in prop::bool::weighted(0.4), contact in prop::option::weighted(0.4, contacts()), is_point in prop::bool::weighted(0.2),
        (has_program, errs) in (prop::bool::weighted(0.3), prop::bool::weighted(0.3)),
        energy_feedback in energy_feedbacks(), believed in prop_oneof![Just(2.0), 1.5..2.3],
    ) -> Parts {
        Parts { feeds_back, contact, is_point, has_program, errs, energy_feedback, believed }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn lanes_are_orbits(
        starts in prop::collection::vec((starts(), feedbacks(), -1.0..1.0_f64, 0.0..1.0_f64), 1..60), impacts in 1..400_u64,
        parts in parts(), heights in prop::collection::vec(0.1..1.0_f64, 1..7),
    ) {
        let orbit = |(start, feedback, x, coefficient): (Start, _, _, _)| {
            let Start { rod, rules, state } = steered(start, parts.energy_feedback, parts.believed);
            let body = if parts.is_point { Body::point(rod) } else { Body::plain(rod) };
            let body = Body {
                steering: if parts.feeds_back { feedback } else { Steering::TiltGain },
                friction: parts.contact.map(|(law, slide)| Friction { coefficient, law, slide }),
                program: HeightProgram::new(&heights).filter(|_| parts.has_program),
                noise: parts.errs.then_some(Noise { timing_sd: 2e-3, angle_sd: 1e-3, seed: 5, ..Noise::NONE }),
                ..body
            };
            let settles = rules.settles || parts.has_program;
            let holds_energy = !settles && parts.contact.is_none() && !parts.errs;
            let (topple_angle, state) = match parts.is_point {
                true => (f64::INFINITY, Body::point_state(state.x_dot, state.y_dot)),
                false => (rules.topple_angle, state),
            };
            Orbit::at(body, Rules { topple_angle, settles, holds_energy, ..rules }, state).moved(x)
        };
        let orbits: Vec<_> = starts.into_iter().map(orbit).collect();
        assert_alike(&orbits, orbits[0].rules(), impacts)?;
    }

    #[test]
    fn watched_angles_are_those_of_orbits(
        starts in prop::collection::vec(starts(), 1..40), impacts in 1..400_u64, step in 1..40_usize,
    ) {
        let orbits: Vec<_> = starts.iter().map(Start::orbit).collect();
        let contacts: Vec<u64> = (1..=impacts).step_by(step).collect();
        let mut seen = vec![Vec::new(); orbits.len()];
        let mut watch = Watch { contacts: &contacts, see: &mut |number, theta: f64| seen[number].push(theta.to_bits()) };
        let mut next = orbits.iter().copied().enumerate();
        prop_assert!(run_watched(impacts, &mut watch, &mut || next.next(), &mut |_, _| (), &mut || true));
        for (mut orbit, seen) in orbits.into_iter().zip(seen) {
            let mut expected = Vec::new();
            run(&mut orbit, impacts, |contact| {
                if contacts.contains(&contact.n) {
                    expected.push(contact.state.theta.to_bits());
                }
                true
            });
            prop_assert_eq!(seen, expected, "{:?}", orbit);
        }
    }

    #[test]
    fn runs_of_all_kinds_together_are_orbits(
        starts in prop::collection::vec((starts(), feedbacks(), 0..6_usize), 1..60), impacts in 1..300_u64,
        (law, slide) in contacts(),
    ) {
        let orbit = |(start, feedback, kind): (Start, _, _)| match kind {
            0 => start.orbit(),
            1 => start.point(),
            2 => start.general(feedback, None),
            3 => start.general(Steering::TiltGain, Some(Friction { coefficient: 0.3, law, slide })),
            4 => steered(start, EnergyFeedback::Total, 2.0).orbit(),
            // Of a rod that believes another energy than it has: no lane takes it.
            _ => Orbit::at(Body::plain(start.rod), Rules { holds_energy: !start.rules.holds_energy, ..start.rules }, start.state),
        };
        let orbits: Vec<_> = starts.into_iter().map(orbit).collect();
        let mut ends = vec![None; orbits.len()];
        let mut next = orbits.iter().copied().enumerate();
        let mut done = |number: usize, end| ends[number] = Some(end);
        prop_assert!(run_all(impacts, &mut || next.next(), &mut done, &mut || true));
        for (orbit, end) in orbits.iter().zip(ends) {
            prop_assert_eq!(end, Some(alone(*orbit, impacts)), "{:?}", orbit);
        }
    }
}

/// Rules of a run without friction that cannot settle; those of one that can have the same batch.
const RULES_OF_A_KIND: Rules = Rules {
    topple_angle: std::f64::consts::FRAC_PI_2,
    settles: false,
    holds_energy: true,
    limits: None,
    half_length: f64::INFINITY,
};

/// A map of the paper's body, hashed (FNV-1a over contacts, outcome and the bits of the largest angle): the same number on
/// every path and on every CPU. It changes only when the numbers of answers do, and then CHANGELOG says so.
#[test]
fn every_kind_of_instructions_gives_the_same_bits() {
    const GOLDEN: u64 = 0xa2a1_67e7_f2f6_edcd;
    const GOLDEN_POINT: u64 = 0xb3ed_aac1_66fe_6465;
    const GOLDEN_FEEDBACK: u64 = 0x41bc_81bd_d9e7_9a22;
    const GOLDEN_ROUGH: [(RestitutionLaw, [u64; 2]); 3] = [
        (RestitutionLaw::Poisson, [0x53c3_617b_a069_69e0, 0x2a29_45e5_4fc0_b45d]),
        (RestitutionLaw::Newton, [0xffbc_2451_2047_aa8c, 0xbc08_a5b3_c2af_c52a]),
        (RestitutionLaw::Stronge, [0xec71_3c15_df2a_6b0f, 0x04a4_66ca_7b5a_b01b]),
    ];
    let starts: Vec<Start> = (0..40 * 30)
        .map(|cell| {
            let (column, row) = (f64::from(cell % 40), f64::from(cell / 40));
            let rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.0 + column * 0.015);
            let rules = Rules { topple_angle: 1.5, ..RULES_OF_A_KIND };
            let state = State { theta: row * 0.0175, x_dot: 0.0, y_dot: -1.15, theta_dot: 0.0 };
            Start { rod, rules, state }
        })
        .collect();
    let points = starts.iter().map(|start| {
        let rod = Rod { tilt_gain: start.rod.tilt_gain - 1.0, ..start.rod };
        Start { rod, state: State { x_dot: start.state.theta, ..start.state }, ..*start }.point()
    });
    let feedbacks = starts.iter().map(|start| {
        let theta = -1.0 - 0.5 * start.rod.tilt_gain;
        let gains = Gains { x: 0.018, theta, x_dot: 0.023, theta_dot: -0.031 };
        start.general(Steering::Feedback(gains), None)
    });
    let mut maps = vec![
        ("rods".to_owned(), GOLDEN, starts.iter().map(Start::orbit).collect::<Vec<_>>()),
        ("points".to_owned(), GOLDEN_POINT, points.collect()),
        ("feedback".to_owned(), GOLDEN_FEEDBACK, feedbacks.collect()),
    ];
    for (law, golden) in GOLDEN_ROUGH {
        for (slide, golden) in [Slide::Matched, Slide::None].into_iter().zip(golden) {
            let orbits = starts.iter().enumerate().map(|(number, start)| {
                let rod = Rod { restitution: 0.7, ..start.rod };
                let friction = Friction { coefficient: 0.01 * (number % 20) as f64, law, slide };
                Start { rod, ..*start }.general(Steering::TiltGain, Some(friction))
            });
            maps.push((format!("{law:?}, {slide:?}"), golden, orbits.collect()));
        }
    }
    for (name, golden, orbits) in &maps {
        let rules = Rules { holds_energy: orbits[0].body.friction.is_none(), ..RULES_OF_A_KIND };
        let mut tried = 0;
        for path in paths() {
            let hash = hash(&in_lanes(path, model_of(orbits, &rules), orbits, 300));
            assert_eq!(hash, *golden, "{path:?}, {name}: {hash:#x}");
            tried += 1;
        }
        assert!(tried > 0);
    }
}

fn hash(ends: &[LaneRunEnd]) -> u64 {
    let words = ends.iter().flat_map(|end| [end.impacts, end.outcome as u64, end.max_theta.to_bits()]);
    words
        .flat_map(u64::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[test]
fn every_outcome_of_a_lane_occurs_and_a_sweep_can_be_stopped() {
    let rod = Rod::lossless(0.4 / 3.0, 0.094, 1.1);
    let rules = Rules { topple_angle: 1.5, ..RULES_OF_A_KIND };
    let state = |theta, y_dot, theta_dot| State { theta, x_dot: 0.0, y_dot, theta_dot };
    let start = |rod, state| Start { rod, rules, state };
    let still = Rod { strike_gain: 1.5, ..rod };
    let wild = Rod { strike_gain_per_energy: 1e8, target_energy: 1e8, ..rod };
    let settling =
        Start { rules: Rules { settles: true, holds_energy: false, ..rules }, ..start(still, state(0.0, -1.0, 0.0)) };
    let runs = [
        (start(rod, state(0.1, -1.0, 0.0)), EndingKind::Completed),
        (start(rod, state(1.6, -1.0, 0.0)), EndingKind::Toppled),
        (start(rod, state(0.0, 1.0, 0.0)), EndingKind::Separating),
        (start(Rod { tilt_gain: 3.0, ..rod }, state(0.4, -1.0, 0.0)), EndingKind::Sinking),
        (start(wild, state(0.1, -1.0, 0.0)), EndingKind::Diverged),
        (settling, EndingKind::Settled),
    ]
    .map(|(start, outcome)| (start.orbit(), outcome));
    let model = BatchModel::rods(EnergyFeedback::Vertical);
    let mut next = runs.iter().map(|(orbit, _)| *orbit).enumerate();
    let mut seen = vec![None; runs.len()];
    let mut done = |number: usize, end: LaneRunEnd| seen[number] = Some(end.outcome);
    assert!(run_batch_on(InstructionSet::best(), model, 100, &mut || next.next(), &mut done, &mut || true));
    for ((orbit, outcome), seen) in runs.iter().zip(seen) {
        assert_eq!(seen, Some(*outcome));
        assert_eq!(alone(*orbit, 100).outcome, *outcome);
    }
    let mut asked = 0;
    let mut go_on = || {
        asked += 1;
        asked < 5
    };
    assert!(!run_batch_on(
        InstructionSet::best(),
        model,
        u64::MAX,
        &mut || Some((0, runs[0].0)),
        &mut |_, _| (),
        &mut go_on
    ));
    assert_eq!(asked, 5);
}
