//! `/v1/ensembles`: many runs of a scene, each with noise of its own.

use std::ops::Range;

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::surveys::ensemble::{
    Ensemble, EnsembleRuns, SHARES, SurvivalPoint, late_half_life, median_impacts, quantiles,
};
use prometheus_client::metrics::counter::Counter;

use crate::api::prelude::*;
use crate::api::shared::request_parts::{Tile, TileOf};
use crate::api::shared::table::{Cells, Column, about};
use crate::api::shared::write::Progress;
use crate::charts;
use crate::charts::{AnglesAt, SurvivalAt, survival_curve};

impl ComputedResource for EnsembleRequest {
    const NAME: &'static str = "ensembles";
    const SINGULAR: &'static str = "Ensemble";
    type Format = ProgressFormat;
    const WORK: Work<Self, ProgressFormat> =
        Work::InSlices { canonical: canonical_of, streamed: &[Format::Progress], compute };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<EnsembleAnswer>()
            .table("One row for each contact.", columns().map(RowColumn::word))
            .end::<EnsembleSummary>()
            .progress(&[PICTURE]);
    }
}

fn compute(
    request: &EnsembleRequest,
    format: ProgressFormat,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    bounces: &Counter,
) -> Result<(), Problem> {
    let ensemble = request.ensemble();
    // The blocks depend on the request alone, never on the machine.
    let block = request.block_runs();
    let (numbers, all) = (request.numbers(), request.runs());
    let only_run = if ensemble.is_uniform() {
        let first = |slice: &TimeSlice| ensemble.runs(0..1, &mut || slice.should_continue()).ok_or(Cancelled);
        let runs = slices.run_one(first)??;
        bounces.inc_by(runs.ends.iter().map(|end| end.impacts).sum());
        Some(runs)
    } else {
        None
    };
    let compute = |number: usize, slice: &TimeSlice| {
        let first = numbers.start + number as u64 * block;
        let range = first..(first + block).min(numbers.end);
        if let Some(run) = &only_run {
            return Some(run.repeated((range.end - range.start) as usize));
        }
        let runs = ensemble.runs(range, &mut || slice.should_continue())?;
        bounces.inc_by(runs.ends.iter().map(|end| end.impacts).sum());
        Some(runs)
    };
    let (mut runs, mut lines) = (EnsembleRuns::default(), Progress::default());
    let mut tell = |ended| {
        if format == ProgressFormat::Progress {
            out.send(lines.line(ended, all));
        }
    };
    tell(0);
    slices.parallel_map(all.div_ceil(block) as usize, compute, |others| {
        runs.append(others);
        tell(runs.ends.len() as u64);
    })?;
    let angles = std::mem::take(&mut runs.angles);
    let (mut sorted, mut found) = (Vec::with_capacity(angles.len()), Vec::with_capacity(angles.len()));
    let sort = |place: usize, _: &TimeSlice| {
        let mut angles = angles[place].clone();
        angles.sort_unstable_by(f64::total_cmp);
        let quantiles = quantiles(&angles);
        // Angles may be many, so they are kept only for an answer that has them.
        Some((if request.angles { angles } else { Vec::new() }, quantiles))
    };
    slices.parallel_map(angles.len(), sort, |(angles, quantiles)| {
        sorted.push(angles);
        found.push(quantiles);
    })?;
    slices.run_one(|slice| {
        let answer = EnsembleAnswer::new(request, &runs, sorted, &found);
        Ok(out.send_whole(format.write(&answer, slice)?, slice)?)
    })?
}

request_fields! {
    /// A request for an ensemble.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct EnsembleRequest {
        /// The scene, with the seed of the request.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// Number of runs, those of other tiles included. More than 20 000 have to be requested in tiles.
        pub runs: u64 = whole(1..=limits::ENSEMBLE_RUNS_IN_TILES).or(200),
        /// Largest number of contacts of each run.
        pub bounces: u64 = whole(1..=limits::BOUNCES).or(400),
        /// Seed of the noise, in place of the scene's own `noise.seed`.
        #[serde(skip)]
        pub seed: Option<u64> = exact_whole().optional(),
        /// Adds the angles themselves to JSON and Arrow.
        pub angles: bool = Flag,
        /// A share of the runs, at most 20 000: from number ⌊runs·index/of⌋ to below ⌊runs·(index + 1)/of⌋.
        pub tile: Tile = TileOf(limits::ENSEMBLE_RUNS_IN_TILES),
    }
}

impl ResourceRequest for EnsembleRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let mut request = Self::read_fields(reader)?;
        if !reader.is_wrong("runs") {
            let is_tiled = reader.has("tile");
            check_tile(reader, request.tile, is_tiled, request.runs);
        }
        if let Some(seed) = request.seed {
            let mut draft = request.scene.draft();
            if let Err(error) = draft.set(Name::Seed, Some(Value::Integer(seed))) {
                reader.refuse("seed", error.detail);
            }
            request.scene = draft.build().ok()?;
        }
        Some(request)
    }

    fn work(&self) -> u64 {
        // One run stands for all of a uniform ensemble.
        let computed = if self.ensemble().is_uniform() { 1 } else { self.runs() };
        let angles = limits::ENSEMBLE_ANGLE_PRICE * limits::ENSEMBLE_ANGLE_CONTACTS.min(self.bounces);
        let runs = self.runs().saturating_mul(limits::ENSEMBLE_RUN_PRICE + angles);
        computed
            .saturating_mul(self.run_price())
            .saturating_add(runs)
            .saturating_add(self.bounces * limits::ENSEMBLE_CONTACT_PRICE + limits::ENSEMBLE_ANSWER_PRICE)
    }

    fn answer_numbers(&self) -> u64 {
        if self.angles { self.stored_angles() } else { 0 }
    }

    /// The angles, and the curve of survival.
    fn bytes(&self) -> u64 {
        const CURVE_COLUMNS: u64 = 5;
        let angle = if self.angles { limits::ENSEMBLE_LISTED_ANGLE_BYTES } else { limits::ENSEMBLE_ANGLE_BYTES };
        self.stored_angles() * angle + self.bounces * CURVE_COLUMNS * limits::NUMBER_BYTES
    }

    fn limit(limits: &Limits) -> Limit {
        limits.of_ensemble_work()
    }
}

impl EnsembleRequest {
    /// All runs.
    pub fn ensemble(&self) -> Ensemble {
        let Self { scene, runs, bounces, .. } = *self;
        Ensemble { scene, runs, impacts: bounces, angle_contacts: limits::ENSEMBLE_ANGLE_CONTACTS }
    }

    /// Range of run numbers in the tile.
    pub fn numbers(&self) -> Range<u64> {
        self.tile.share(self.runs)
    }

    /// Number of runs in the tile.
    pub fn runs(&self) -> u64 {
        let numbers = self.numbers();
        numbers.end - numbers.start
    }

    /// Number of runs in a block, which depends on the request alone.
    pub fn block_runs(&self) -> u64 {
        let runs = limits::ENSEMBLE_BLOCK_WORK / self.run_price().max(1);
        let (least, most) = limits::ENSEMBLE_BLOCK_RUNS.into_inner();
        let fewest = if self.ensemble().fits_lanes() { (self.runs() / 100).clamp(least, most) } else { 1 };
        runs.max(fewest)
    }

    /// Price of the bounces of a run, in bounces of the plain rod.
    fn run_price(&self) -> u64 {
        let ensemble = self.ensemble();
        if ensemble.fits_lanes() && !ensemble.is_uniform() {
            self.bounces.div_ceil(limits::ENSEMBLE_LANE_BOUNCES)
        } else {
            self.bounces.saturating_mul(bounce_price(&self.scene))
        }
    }

    /// Maximum number of angles that are stored for quantiles.
    fn stored_angles(&self) -> u64 {
        self.runs() * limits::ENSEMBLE_ANGLE_CONTACTS.min(self.bounces)
    }
}

/// Checks that a tile has at least one run, and at most as many as one answer may have.
fn check_tile(reader: &mut Reader<'_, '_>, tile: Tile, is_tiled: bool, runs: u64) {
    const MOST: u64 = limits::ENSEMBLE_RUNS;
    if tile.of > runs {
        reader.refuse("tile", format!("tile is one of {}, but there are only {runs} runs", tile.of));
    } else if runs.div_ceil(tile.of) > MOST {
        let least = runs.div_ceil(MOST);
        let (name, what) = match is_tiled {
            true => ("tile", format!("one tile of {} has {} runs", tile.of, runs.div_ceil(tile.of))),
            false => ("runs", format!("runs is {runs}")),
        };
        reader.refuse(
            name,
            format!("{what}; at most {MOST} are answered at once, so ask for one tile of {least} or more"),
        );
    }
}

/// The runs that an answer is about.
#[derive(Debug, Serialize, JsonSchema)]
struct EnsembleTile {
    #[serde(flatten)]
    tile: Tile,
    /// Number of the first run.
    first_run: u64,
    /// Number of runs.
    runs: u64,
}

/// Answer of `/v1/ensembles`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Ensemble")]
pub struct EnsembleAnswer {
    scene: Resolved,
    model: ModelChoice,
    /// Number of runs, those of other tiles included.
    runs: u64,
    /// Largest number of contacts of each run.
    bounces: u64,
    /// The seed that was used.
    seed: u64,
    /// The runs of this tile, which everything below is about.
    tile: EnsembleTile,
    #[serde(flatten)]
    summary: EnsembleSummary,
    #[schemars(with = "SurvivalCurve")]
    survival: Table,
    #[schemars(with = "AngleQuantiles")]
    quantiles: Table,
    /// For each contact of `quantiles`, |θ| of the runs that continued after it, in order, rad. Null unless `angles` is requested.
    angles: Option<Vec<Vec<f64>>>,
    #[serde(skip)]
    rows: Vec<ContactRow>,
    /// Contacts at which angles are watched.
    #[serde(skip)]
    watched: Vec<ContactRow>,
}

/// Statistics of the runs of a tile.
#[derive(Debug, Serialize, JsonSchema)]
struct EnsembleSummary {
    survived: Survived,
    /// Mean number of contacts of a run, including the last; a run that outlasts all contacts counts as `bounces`.
    mean_bounces: f64,
    /// The first contact after which at most half of the runs continue; null if more than half outlast all contacts.
    median_bounces: Option<u64>,
    /// Number of contacts in which half of the runs end, over the second half of the contacts: ln 2 divided by the number of runs that ended
    /// there per run at risk. Null if none ended there.
    half_life: Option<f64>,
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "EnsembleCounts")]
    counts: [u64; EndingKind::ALL.len()],
    notes: Vec<String>,
}

/// Number and share of the runs that outlast all contacts, and the 95 % interval of the share (Wilson 1927).
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct Survived {
    runs: u64,
    share: f64,
    lower: f64,
    upper: f64,
}

schemas! {
    /// Number of runs by outcome.
    EnsembleCounts = counts(EndingKind::ALL.map(EndingKind::name));
}

column_lists! {
    /// The survival curve: one entry for each contact from 1 to `bounces`.
    SurvivalCurve = SURVIVAL.iter().map(RowColumn::word);
    /// Quantiles of |θ| just before a contact over the runs that continued after it, rad. At up to 200 evenly spaced contacts; linear between
    /// angles in order, as in R and NumPy.
    AngleQuantiles = ALIVE.iter().chain(&QUANTILES).map(RowColumn::word);
}

fn by_name<S: Serializer>(counts: &[u64; EndingKind::ALL.len()], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(EndingKind::ALL.into_iter().map(EndingKind::name).zip(counts))
}

/// A contact of all runs of a tile.
#[derive(Debug, Clone, Copy)]
struct ContactRow {
    /// Number of the contact.
    n: u64,
    at: SurvivalPoint,
    /// Quantiles of |θ| of the runs that go on, if angles are watched here and a run goes on.
    quantiles: Option<[f64; SHARES.len()]>,
}

impl EnsembleAnswer {
    /// The answer for all runs of a tile, with the angles at the watched contacts and their quantiles. `runs` holds no angles.
    pub fn new(
        request: &EnsembleRequest,
        runs: &EnsembleRuns,
        angles: Vec<Vec<f64>>,
        quantiles: &[Option<[f64; SHARES.len()]>],
    ) -> Self {
        let EnsembleRequest { scene, bounces, tile, .. } = request;
        let curve = runs.survival(*bounces);
        let summary = EnsembleSummary::new(request, runs, &curve);
        let mut rows: Vec<_> = (1..).zip(curve).map(|(n, at)| ContactRow { n, at, quantiles: None }).collect();
        let mut watched = Vec::new();
        for (n, quantiles) in request.ensemble().watched().into_iter().zip(quantiles) {
            let row = &mut rows[(n - 1) as usize];
            row.quantiles = *quantiles;
            watched.push(*row);
        }
        let seed = match scene.value(Name::Seed) {
            Some(Value::Integer(seed)) => seed,
            _ => 0,
        };
        Self {
            scene: Resolved(*scene),
            model: ModelChoice::of(scene),
            runs: request.runs,
            bounces: *bounces,
            seed,
            tile: EnsembleTile { tile: *tile, first_run: request.numbers().start, runs: request.runs() },
            summary,
            survival: table_of(&SURVIVAL, &rows),
            quantiles: table_of(ALIVE.iter().chain(&QUANTILES), &watched),
            angles: request.angles.then_some(angles),
            rows,
            watched,
        }
    }
}

impl Tabular for EnsembleAnswer {
    /// The curve, with the quantiles at the watched contacts.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(columns(), &self.rows))
    }

    /// The same with names that say |θ|, and with the angles themselves on request.
    fn to_arrow_table(&self) -> Cow<'_, Table> {
        let Table(mut columns) = table_of(SURVIVAL.iter().chain(&IN_ARROW), &self.rows);
        if let Some(angles) = &self.angles {
            let mut cells = vec![None; self.rows.len()];
            for (row, angles) in self.watched.iter().zip(angles) {
                cells[(row.n - 1) as usize] = Some(angles.clone());
            }
            columns.push(Column { name: ANGLES, unit: "rad", cells: Cells::Lists(cells) });
        }
        Cow::Owned(Table(columns))
    }

    fn about(&self, name: &str) -> &'static str {
        match name {
            ANGLES => "Angles of the runs that go on, without sign and in order.",
            _ => about(SURVIVAL.iter().chain(&IN_ARROW), name),
        }
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["survival", "quantiles", "angles"]
    }

    fn end(&self) -> impl Serialize {
        &self.summary
    }
}

/// Tells whether a scene has noise.
fn is_noisy(scene: &Scene) -> bool {
    scene.requirements().iter().any(|requirement| requirement.level == ModelLevel::Noise)
}

impl EnsembleSummary {
    fn new(request: &EnsembleRequest, runs: &EnsembleRuns, curve: &[SurvivalPoint]) -> Self {
        let EnsembleRequest { scene, bounces, tile, .. } = request;
        let survived = runs.count(EndingKind::Completed);
        let (share, (lower, upper)) = curve.last().map_or((1.0, (0.0, 1.0)), |last| (last.share, last.interval));
        let (median, half_life) = (median_impacts(curve), late_half_life(curve));
        let mut notes = vec![
            "intervals are those of Wilson, 95 % at each contact by itself; quantiles of |θ| are over the runs that \
                 went on"
                .to_owned(),
        ];
        if tile.of > 1 {
            let (numbers, all) = (request.numbers(), request.runs);
            notes.push(format!(
                "all of this is about runs {} to {} of {all}: counts of tiles add up to those of all, quantiles \
                 do not, their angles do",
                numbers.start,
                numbers.end - 1,
            ));
        }
        if !is_noisy(scene) {
            let detail = "the scene has no noise, so all runs are alike: give noise.timing_sd or noise.angle_sd";
            notes.push(detail.to_owned());
        }
        if !matches!(scene.value(Name::NoiseRun), None | Some(Value::Integer(0))) {
            notes.push("noise.run is not looked at: the runs are those of all numbers".to_owned());
        }
        if survived > 0 {
            notes.push(format!(
                "mean_bounces counts runs that outlast all contacts as {bounces}, so it is a lower bound"
            ));
        }
        if median.is_none() {
            notes.push(format!("median_bounces is null: more than half of the runs outlast all {bounces} contacts"));
        }
        if half_life.is_none() {
            notes.push(
                "half_life is null: it is from the second half of the contacts, where no run ended or all at once"
                    .to_owned(),
            );
        }
        if !has_angle(scene) {
            notes.push(
                "quantiles are of the angle of the velocity from straight down: a point mass has no other".to_owned(),
            );
        }
        Self {
            survived: Survived { runs: survived, share, lower, upper },
            mean_bounces: runs.mean_impacts(),
            median_bounces: median,
            half_life,
            counts: EndingKind::ALL.map(|outcome| runs.count(outcome)),
            notes,
        }
    }
}

/// Columns of the survival curve.
const SURVIVAL: [RowColumn<ContactRow>; 6] = [
    RowColumn::new("n", "", "", Read::Count(|row| row.n)),
    RowColumn::new("at_risk", "", "Number of runs that reach the contact.", Read::Count(|row| row.at.at_risk)),
    RowColumn::new("ended", "", "Number of runs that end at the contact.", Read::Count(|row| row.at.ended)),
    RowColumn::new("survival", "", "Share of the runs that go on after the contact.", Read::Number(|row| row.at.share)),
    RowColumn::new("lower", "", "Wilson interval of that share, 95 %.", Read::Number(|row| row.at.interval.0)),
    RowColumn::new("upper", "", "Wilson interval of that share, 95 %.", Read::Number(|row| row.at.interval.1)),
];

/// Columns of the quantiles in JSON before them.
const ALIVE: [RowColumn<ContactRow>; 2] = [
    RowColumn::new("n", "", "", Read::Count(|row| row.n)),
    RowColumn::new("alive", "", "Runs that go on after the contact.", Read::Count(|row| row.at.at_risk - row.at.ended)),
];

/// Columns of the quantiles: in JSON; in CSV and NDJSON; in Arrow.
const QUANTILES: [RowColumn<ContactRow>; SHARES.len()] = quantile_columns(["q05", "q25", "q50", "q75", "q95"]);
const IN_CSV: [RowColumn<ContactRow>; SHARES.len()] =
    quantile_columns(["theta_q05", "theta_q25", "theta_q50", "theta_q75", "theta_q95"]);
const IN_ARROW: [RowColumn<ContactRow>; SHARES.len()] =
    quantile_columns(["abs_theta_q05", "abs_theta_q25", "abs_theta_q50", "abs_theta_q75", "abs_theta_q95"]);

/// Name of the angles themselves in Arrow.
const ANGLES: &str = "abs_theta";

const fn quantile_columns(names: [&'static str; SHARES.len()]) -> [RowColumn<ContactRow>; SHARES.len()] {
    const fn column<const WHICH: usize>(name: &'static str) -> RowColumn<ContactRow> {
        let read = Read::Sparse(|row: &ContactRow| row.quantiles.map(|quantiles| quantiles[WHICH]));
        RowColumn::new(name, "rad", "Quantile of |θ| over the runs that go on.", read)
    }
    let [q05, q25, q50, q75, q95] = names;
    [column::<0>(q05), column::<1>(q25), column::<2>(q50), column::<3>(q75), column::<4>(q95)]
}

/// Columns of a contact in CSV and NDJSON.
fn columns() -> impl Iterator<Item = &'static RowColumn<ContactRow>> {
    SURVIVAL.iter().chain(&IN_CSV)
}

/// Name of the picture.
const PICTURE: &str = "survival";

impl Pictured for EnsembleAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let Survived { runs, share, lower, upper } = self.summary.survived;
        let percent = |share: f64| significant(100.0 * share, 3);
        let counts = EndingKind::ALL.into_iter().zip(self.summary.counts).filter(|(_, count)| *count > 0);
        let counts: Vec<_> = counts.map(|(outcome, count)| format!("{count} {}", outcome.name())).collect();
        let median = match self.summary.median_bounces {
            Some(median) => format!("half have ended by contact {median}"),
            None => "more than half outlast them all".to_owned(),
        };
        let caption = format!(
            "{runs} of {} runs outlast {} contacts: {} %, with 95 % confidence {} to {} % (Wilson, at each contact by \
             itself); {median}. Angles are those of the runs still going.",
            self.tile.runs,
            self.bounces,
            percent(share),
            percent(lower),
            percent(upper),
        );
        let Tile { index, of } = self.tile.tile;
        let part = if of > 1 { format!(", tile {} of {of}", index + 1) } else { String::new() };
        let points = self.rows.iter().map(|ContactRow { at, .. }| SurvivalAt {
            at_risk: at.at_risk,
            share: at.share,
            interval: at.interval,
        });
        let marks = self.rows.iter().filter_map(|row| Some(AnglesAt { n: row.n, quantiles: row.quantiles? }));
        Ok(survival_curve(&charts::SurvivalCurve {
            title: &format!("Survival of {} runs {}", self.tile.runs, noise_in_words(&self.scene.0)),
            subtitle: &format!("seed {}{part}; {}", self.seed, counts.join(", ")),
            caption: &caption,
            curve: &points.collect::<Vec<_>>(),
            angles: &marks.collect::<Vec<_>>(),
        }))
    }
}

impl Watched for EnsembleAnswer {
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem> {
        Ok(vec![(PICTURE, self.to_picture()?)])
    }
}

/// Describes the noise of a scene, for a title.
fn noise_in_words(scene: &Scene) -> String {
    let Some(Value::Choice(model)) = scene.value(Name::NoiseModel).filter(|_| is_noisy(scene)) else {
        return "without noise".to_owned();
    };
    let said = |name| scene.number(name).filter(|sd| *sd > 0.0);
    let timing = said(Name::TimingSd).map(|sd| format!(", σ_t = {} ms", significant(1e3 * sd, 3)));
    let angle = said(Name::AngleSd).map(|sd| format!(", σ_θ = {} rad", significant(sd, 3)));
    let further: String = [
        (Name::XSd, "σ_x", " m"),
        (Name::XDotSd, "σ_ẋ", " m/s"),
        (Name::YDotSd, "σ_ẏ", " m/s"),
        (Name::ThetaDotSd, "σ_θ̇", " rad/s"),
        (Name::RestitutionSd, "σ_e", ""),
    ]
    .into_iter()
    .filter_map(|(name, symbol, unit)| said(name).map(|sd| format!(", {symbol} = {}{unit}", significant(sd, 3))))
    .collect();
    format!("with {model} noise{}{}{further}", timing.unwrap_or_default(), angle.unwrap_or_default())
}
