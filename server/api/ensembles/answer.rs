//! The answer of `ensembles`: the survival curve of many runs, and the quantiles of their angles.

use std::borrow::Cow;

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::surveys::ensemble::{EnsembleRuns, SHARES, SurvivalPoint, late_half_life, median_impacts};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::api::ensembles::request::EnsembleRequest;
use crate::api::formats::Tabular;
use crate::api::scene::{Resolved, has_angle};
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::table::columns::{RowColumn, about, table_of};
use crate::api::shared::table::gather::Read;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::shared::tile::Tile;
use crate::api::vocabulary::counts;
use crate::{column_lists, schemas};

/// The runs that an answer is about.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct EnsembleTile {
    #[serde(flatten)]
    pub(super) tile: Tile,
    /// Number of the first run.
    first_run: u64,
    /// Number of runs.
    pub(super) runs: u64,
}

/// Answer of `/v1/ensembles`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Ensemble")]
pub struct EnsembleAnswer<'a> {
    pub(super) scene: Resolved<'a>,
    model: ModelChoice,
    /// Number of runs, those of other tiles included.
    runs: u64,
    /// Largest number of contacts of each run.
    pub(super) bounces: u64,
    /// The seed that was used.
    pub(super) seed: u64,
    /// The runs of this tile, which everything below is about.
    pub(super) tile: EnsembleTile,
    #[serde(flatten)]
    pub(super) summary: Summary,
    #[schemars(with = "SurvivalCurve")]
    survival: Table,
    #[schemars(with = "AngleQuantiles")]
    quantiles: Table,
    /// For each contact of `quantiles`, |θ| of the runs that continued after it, in order, rad. Null unless `angles` is requested.
    angles: Option<Vec<Vec<f64>>>,
    #[serde(skip)]
    pub(super) rows: Vec<ContactRow>,
    /// Contacts at which angles are watched.
    #[serde(skip)]
    watched: Vec<ContactRow>,
}

/// Statistics of the runs of a tile.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "EnsembleSummary")]
pub(super) struct Summary {
    pub(super) survived: Survived,
    /// Mean number of contacts of a run, including the last; a run that outlasts all contacts counts as `bounces`.
    mean_bounces: f64,
    /// The first contact after which at most half of the runs continue; null if more than half outlast all contacts.
    pub(super) median_bounces: Option<u64>,
    /// Number of contacts in which half of the runs end, over the second half of the contacts: ln 2 divided by the number of runs that ended
    /// there per run at risk. Null if none ended there.
    half_life: Option<f64>,
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "EnsembleCounts")]
    pub(super) counts: [u64; EndingKind::ALL.len()],
    notes: Vec<String>,
}

/// Number and share of the runs that outlast all contacts, and the 95 % interval of the share (Wilson 1927).
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(super) struct Survived {
    pub(super) runs: u64,
    pub(super) share: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
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
pub(super) struct ContactRow {
    /// Number of the contact.
    pub(super) n: u64,
    pub(super) at: SurvivalPoint,
    /// Quantiles of |θ| of the runs that go on, if angles are watched here and a run goes on.
    pub(super) quantiles: Option<[f64; SHARES.len()]>,
}

impl<'a> EnsembleAnswer<'a> {
    /// The answer for all runs of a tile, with the angles at the watched contacts and their quantiles. `runs` holds no angles.
    pub fn new(
        request: &'a EnsembleRequest,
        runs: &EnsembleRuns,
        angles: Vec<Vec<f64>>,
        quantiles: &[Option<[f64; SHARES.len()]>],
    ) -> Self {
        let EnsembleRequest { scene, bounces, tile, .. } = request;
        let curve = runs.survival(*bounces);
        let summary = Summary::new(request, runs, &curve);
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
            scene: Resolved(scene),
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

impl Tabular for EnsembleAnswer<'_> {
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
pub(super) fn is_noisy(scene: &Scene) -> bool {
    scene.requirements().iter().any(|requirement| requirement.level == ModelLevel::Noise)
}

impl Summary {
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
const QUANTILES: [RowColumn<ContactRow>; SHARES.len()] = quantiles(["q05", "q25", "q50", "q75", "q95"]);
const IN_CSV: [RowColumn<ContactRow>; SHARES.len()] =
    quantiles(["theta_q05", "theta_q25", "theta_q50", "theta_q75", "theta_q95"]);
const IN_ARROW: [RowColumn<ContactRow>; SHARES.len()] =
    quantiles(["abs_theta_q05", "abs_theta_q25", "abs_theta_q50", "abs_theta_q75", "abs_theta_q95"]);

/// Name of the angles themselves in Arrow.
const ANGLES: &str = "abs_theta";

const fn quantiles(names: [&'static str; SHARES.len()]) -> [RowColumn<ContactRow>; SHARES.len()] {
    const fn column<const WHICH: usize>(name: &'static str) -> RowColumn<ContactRow> {
        let read = Read::Sparse(|row: &ContactRow| row.quantiles.map(|quantiles| quantiles[WHICH]));
        RowColumn::new(name, "rad", "Quantile of |θ| over the runs that go on.", read)
    }
    let [q05, q25, q50, q75, q95] = names;
    [column::<0>(q05), column::<1>(q25), column::<2>(q50), column::<3>(q75), column::<4>(q95)]
}

/// Columns of a contact in CSV and NDJSON.
pub(super) fn columns() -> impl Iterator<Item = &'static RowColumn<ContactRow>> {
    SURVIVAL.iter().chain(&IN_CSV)
}
