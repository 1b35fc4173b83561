//! Lanes and one orbit alone are the same: outcome, number of contacts and largest angle, bit for bit, over random rods.

use std::f64::consts::FRAC_PI_2;

use equipoise_physics::map::body::{Body, Release};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::polygon::{Outline, Vertices};
use equipoise_physics::map::strike::{EnergyFeedback, Rod, State};
use equipoise_physics::map::table::actuator_load::{ActuatorLimits, ActuatorLoad};
use equipoise_physics::map::table::control_law::{Gains, Steering};
use equipoise_physics::map::table::noise::{Noise, NoiseModel};
use equipoise_physics::map::table::pivot::TurningTable;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::numbers::dispatch::InstructionSet;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::lanes::batch_run::{LaneRunEnd, Watch, run_all, run_batch_on, run_watched};
use equipoise_physics::run::lanes::model::BatchModel;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use proptest::prelude::*;

use crate::support::simple::{alone, changes_energy, paths, rods};

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

// Lanes of polygons and of tables that err, and their orbits alone, are the same: outcome, number of contacts and largest angle, bit for
// bit, over random bodies and on every kind of instructions.

const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]];

/// Properties that all runs of a batch share.
#[derive(Clone, Copy, Debug)]
struct Kind {
    feedback: bool,
    contact: Option<(RestitutionLaw, Slide)>,
    energy_feedback: EnergyFeedback,
    errs: bool,
    has_vertices: bool,
    further: Further,
}

/// Parts of a table beside those.
#[derive(Clone, Copy, Debug)]
struct Further {
    is_biased: bool,
    lags: bool,
    is_point: bool,
    /// True for a pivot at a fixed place, and for a corrected one.
    turning: Option<(bool, bool)>,
    has_ends: bool,
    has_limits: bool,
    plans: bool,
    errs_in_state: bool,
    scatters: bool,
}

impl Further {
    const NONE: Self = Self {
        is_biased: false,
        lags: false,
        is_point: false,
        turning: None,
        has_ends: false,
        has_limits: false,
        plans: false,
        errs_in_state: false,
        scatters: false,
    };
}

prop_compose! {
    fn further_parts()(
        (is_biased, lags, is_point) in (any::<bool>(), any::<bool>(), prop::bool::weighted(0.2)),
        (has_ends, has_limits) in (prop::bool::weighted(0.3), prop::bool::weighted(0.3)),
        turning in prop_oneof![Just(None), any::<(bool, bool)>().prop_map(Some)],
        (plans, errs_in_state, scatters) in any::<(bool, bool, bool)>(),
    ) -> Further {
        Further { is_biased, lags, is_point, turning, has_ends, has_limits, plans, errs_in_state, scatters }
    }
}

prop_compose! {
    fn kinds()(
        feedback in prop::bool::weighted(0.3), rough in prop::bool::weighted(0.4),
        law in prop_oneof![Just(RestitutionLaw::Poisson), Just(RestitutionLaw::Newton), Just(RestitutionLaw::Stronge)],
        slide in prop_oneof![Just(Slide::None), Just(Slide::Matched)],
        energy_feedback in prop_oneof![
            Just(EnergyFeedback::Vertical), Just(EnergyFeedback::Total), Just(EnergyFeedback::OneStrike)
        ],
        (errs, has_vertices) in (any::<bool>(), prop::bool::weighted(0.4)),
        further in prop_oneof![1 => Just(Further::NONE), 2 => further_parts()],
    ) -> Kind {
        let contact = rough.then_some((law, slide));
        let has_vertices = has_vertices && !further.is_point;
        Kind { feedback, contact, energy_feedback, errs, has_vertices, further }
    }
}

/// Numbers of a run that its kind may need.
#[derive(Clone, Debug)]
struct Numbers {
    rod: Rod,
    gains: Gains,
    coefficient: f64,
    noise: Noise,
    places: Vec<[f64; 2]>,
    release: Release,
    topple_angle: f64,
    table: TableNumbers,
}

/// Numbers that the further parts of a table may need.
#[derive(Clone, Copy, Debug)]
struct TableNumbers {
    constant_tilt: f64,
    lag: f64,
    place: f64,
    depth: f64,
    half_length: f64,
    limits: ActuatorLimits,
    noise: Noise,
}

impl TableNumbers {
    const NONE: Self = Self {
        constant_tilt: 0.0,
        lag: 0.0,
        place: 0.0,
        depth: 0.0,
        half_length: 1.0,
        limits: ActuatorLoad { tilt: 1.0, tilt_rate: 1.0, speed: 1.0, stroke: 1.0 },
        noise: Noise::NONE,
    };
}

prop_compose! {
    fn table_numbers()(
        constant_tilt in -0.01..0.01_f64, lag in prop_oneof![1e-4..0.02_f64, 0.02..1.0], place in -0.3..0.3_f64,
        depth in prop_oneof![Just(0.0), -0.1..0.1_f64], half_length in 0.05..3.0_f64,
        (x_sd, x_dot_sd, y_dot_sd) in (0.0..0.01_f64, prop_oneof![Just(0.0), 1e-4..0.02_f64], 1e-4..0.02_f64),
        (tilt, tilt_rate, speed, stroke) in (0.05..3.0_f64, 0.1..100.0_f64, 0.5..5.0_f64, 1e-3..0.5_f64),
        (theta_dot_sd, horizon) in (1e-3..0.1_f64, prop_oneof![Just(0.0), 1e-3..0.5_f64]), restitution_sd in 1e-3..0.3_f64,
    ) -> TableNumbers {
        let noise = Noise { x_sd, x_dot_sd, y_dot_sd, theta_dot_sd, restitution_sd, horizon, ..Noise::NONE };
        let limits = ActuatorLoad { tilt, tilt_rate, speed, stroke };
        TableNumbers { constant_tilt, lag, place, depth, half_length, limits, noise }
    }
}

prop_compose! {
    /// A polygon on the vertex at 0: wide ones soon touch the table with another one.
    fn polygons()(wide in 0.1..1.2_f64, spokes in prop::collection::vec(0.05..0.4_f64, 3..8)) -> Vec<[f64; 2]> {
        let last = spokes.len() as f64 - 1.0;
        let ray = |(place, length): (usize, &f64)| {
            let angle = wide * (1.0 - 2.0 * place as f64 / last);
            [length * angle.sin(), length * angle.cos()]
        };
        std::iter::once([0.0, 0.0]).chain(spokes.iter().enumerate().map(ray)).collect()
    }
}

prop_compose! {
    fn noises()(
        timing_sd in prop_oneof![Just(0.0), 1e-6..0.03_f64], angle_sd in prop_oneof![Just(0.0), 1e-6..0.03_f64],
        seed in any::<u64>(), run in any::<u64>(),
    ) -> Noise {
        Noise { timing_sd, angle_sd, seed, run, ..Noise::NONE }
    }
}

prop_compose! {
    fn numbers()(
        rod in rods(1.01), near in any::<bool>(), above in 1.01..3.0_f64,
        (theta, x_dot, y_dot, theta_dot) in (-1.0..1.0, -1.0..1.0, -4.0..1.0, -30.0..30.0),
        noise in noises(), places in polygons(), coefficient in 0.0..1.0,
        (theta_gain, x_gain) in (-2.5..0.5_f64, -0.05..0.05_f64), topple_angle in 0.5..FRAC_PI_2, table in table_numbers(),
    ) -> Numbers {
        let scale = if near { 0.05 } else { 1.0 };
        let gains = Gains { x: x_gain, theta: theta_gain, x_dot: x_gain, theta_dot: -x_gain };
        let state = State { theta: theta * scale, x_dot: x_dot * scale, y_dot, theta_dot: theta_dot * scale };
        let release = Release { x: 0.1 * x_dot, height: rod.contact_distance * above, state };
        Numbers { rod, gains, coefficient, noise, places, release, topple_angle, table }
    }
}

/// The run of these numbers; `None` for no polygon, and without a first contact.
fn orbit(kind: Kind, numbers: &Numbers) -> Option<Orbit> {
    let Numbers { mut rod, gains, coefficient, mut noise, places, mut release, topple_angle, table } = numbers.clone();
    let outline = match kind.has_vertices {
        true => Some(Outline::new(&Vertices::new(&places).ok()?, 0).ok()?),
        false => None,
    };
    if let Some(outline) = &outline {
        let above = release.height / rod.contact_distance;
        (rod.contact_distance, rod.radius_of_gyration) = (outline.contact_distance, outline.radius_of_gyration);
        (rod.target_energy, release.height) =
            (9.81 * rod.contact_distance * above, rod.contact_distance * above.max(1.01));
    }
    rod.energy_feedback = kind.energy_feedback;
    let friction = kind.contact.map(|(law, slide)| Friction { coefficient, law, slide });
    let settles = changes_energy(&rod) || kind.energy_feedback == EnergyFeedback::OneStrike || friction.is_some();
    let holds_energy = !settles && !kind.errs;
    let Further { is_biased, lags, is_point, turning, has_ends, has_limits, plans, errs_in_state, scatters } =
        kind.further;
    noise.model = if plans { NoiseModel::Plan } else { NoiseModel::Strike };
    if errs_in_state {
        let Noise { timing_sd, angle_sd, model, seed, run, .. } = noise;
        noise = Noise { timing_sd, angle_sd, model, seed, run, ..table.noise };
    }
    noise.restitution_sd = if scatters { table.noise.restitution_sd } else { 0.0 };
    let half_length = if has_ends { table.half_length } else { f64::INFINITY };
    let body = Body {
        steering: if kind.feedback { Steering::Feedback(gains) } else { Steering::TiltGain },
        friction,
        noise: kind.errs.then_some(noise),
        outline,
        constant_tilt: if is_biased { table.constant_tilt } else { 0.0 },
        lag: if lags { table.lag } else { 0.0 },
        turning: turning.map(|(is_placed, is_corrected)| TurningTable {
            place: is_placed.then_some(table.place),
            depth: table.depth,
            is_corrected,
        }),
        ..if is_point { Body::point(rod) } else { Body::plain(rod) }
    };
    if is_point {
        (release.state.theta, release.state.theta_dot) = (0.0, 0.0);
    }
    Orbit::new(
        body,
        Rules { topple_angle, settles, holds_energy, limits: has_limits.then_some(table.limits), half_length },
        &release,
    )
    .ok()
}

fn ended_in_lanes(path: InstructionSet, model: BatchModel, orbits: &[Orbit], impacts: u64) -> Vec<Option<LaneRunEnd>> {
    let mut ends = vec![None; orbits.len()];
    let mut next = orbits.iter().copied().enumerate();
    run_batch_on(path, model, impacts, &mut || next.next(), &mut |number, end| ends[number] = Some(end), &mut || true);
    ends
}

fn model_of_kind(kind: Kind) -> BatchModel {
    let Kind { feedback, contact, energy_feedback, errs, has_vertices, .. } = kind;
    let rods = BatchModel::rods(energy_feedback);
    BatchModel { friction: contact, feeds_back: feedback, errs, has_vertices, ..rods }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn lanes_of_bodies_are_orbits(
        kind in kinds(), numbers in prop::collection::vec(numbers(), 1..60), impacts in 1..300_u64,
    ) {
        let numbers: Vec<_> = numbers.iter().filter_map(|numbers| Some((numbers, orbit(kind, numbers)?))).collect();
        let model = |orbit: &Orbit| BatchModel::of(&orbit.body, orbit.rules());
        let Some(first) = numbers.first().map(|(_, orbit)| model(orbit).expect("lanes take it")) else { return Ok(()) };
        let numbers: Vec<_> = numbers.into_iter().filter(|(_, orbit)| model(orbit) == Some(first)).collect();
        let orbits: Vec<_> = numbers.iter().map(|(_, orbit)| *orbit).collect();
        let expected: Vec<_> = orbits.iter().map(|orbit| Some(alone(*orbit, impacts))).collect();
        for path in paths() {
            let ends = ended_in_lanes(path, first, &orbits, impacts);
            for ((numbers, _), (end, expected)) in numbers.iter().zip(ends.iter().zip(&expected)) {
                prop_assert_eq!(end, expected, "{:?} {:?} {:?}", path, kind, numbers);
            }
        }
    }
}

/// A map of the paper's triangle, plain and on tables that err, hashed (FNV-1a over contacts, outcome and the bits of the largest angle):
/// the same number on every path and on every CPU. It changes only when the numbers of answers do, and then CHANGELOG says so.
#[test]
fn every_kind_of_instructions_gives_the_same_bits_of_bodies() {
    const GOLDEN: [(bool, bool, u64); 3] = [
        (false, true, 0x9f0c_0b10_c8e3_61fc),
        (true, false, 0xae1a_c55f_a937_fbf7),
        (true, true, 0x371f_0796_e7cd_d02e),
    ];
    for (errs, has_vertices, golden) in GOLDEN {
        let kind = Kind {
            feedback: false,
            contact: None,
            energy_feedback: EnergyFeedback::Vertical,
            errs,
            has_vertices,
            further: Further::NONE,
        };
        let orbits: Vec<_> = (0..40 * 30_u64)
            .map(|cell| {
                let (column, row) = ((cell % 40) as f64, (cell / 40) as f64);
                let numbers = Numbers {
                    rod: Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.0 + column * 0.006),
                    gains: Gains::default(),
                    coefficient: 0.0,
                    noise: Noise { timing_sd: 0.001, angle_sd: 0.0002, seed: 7, run: cell, ..Noise::NONE },
                    places: TRIANGLE.to_vec(),
                    release: Release {
                        x: 0.0,
                        height: 0.2,
                        state: State { theta: row * 0.0175, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 },
                    },
                    topple_angle: 1.5,
                    table: TableNumbers::NONE,
                };
                orbit(kind, &numbers).unwrap()
            })
            .collect();
        let completed = orbits.iter().filter(|orbit| alone(**orbit, 300).outcome == EndingKind::Completed).count();
        assert!((100..1100).contains(&completed), "{kind:?}: {completed}");
        for path in paths() {
            let hash = hash_of_ended(&ended_in_lanes(path, model_of_kind(kind), &orbits, 300));
            assert_eq!(hash, golden, "{path:?}, {kind:?}: {hash:#x}");
        }
    }
}

fn hash_of_ended(ends: &[Option<LaneRunEnd>]) -> u64 {
    let words = ends.iter().flatten().flat_map(|end| [end.impacts, end.outcome as u64, end.max_theta.to_bits()]);
    words
        .flat_map(u64::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[test]
fn a_batch_takes_what_lanes_see() {
    let noise = Noise { timing_sd: 0.01, ..Noise::NONE };
    let rules = |holds_energy| Rules {
        topple_angle: 1.5,
        settles: false,
        holds_energy,
        limits: None,
        half_length: f64::INFINITY,
    };
    let body = |noise, outline| Body { noise, outline, ..Body::plain(Rod::lossless(0.4 / 3.0, 0.094, 1.1)) };
    let outline = Outline::new(&Vertices::new(&TRIANGLE).unwrap(), 0).unwrap();
    for (noise, outline) in [(None, Some(outline)), (Some(noise), None), (Some(noise), Some(outline))] {
        let kind = Kind {
            feedback: false,
            contact: None,
            energy_feedback: EnergyFeedback::Vertical,
            errs: noise.is_some(),
            has_vertices: outline.is_some(),
            further: Further::NONE,
        };
        assert_eq!(BatchModel::of(&body(noise, outline), &rules(noise.is_none())), Some(model_of_kind(kind)));
    }
    let plan = Noise { model: NoiseModel::Plan, ..noise };
    let program = HeightProgram::new(&[0.2, 0.3]);
    assert_eq!(BatchModel::of(&Body { program, ..body(Some(plan), None) }, &rules(false)), None);
}
