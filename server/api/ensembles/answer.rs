//! The answer of `ensembles`: the survival curve of many runs, and the quantiles of their angles.

use std::borrow::Cow;

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::surveys::ensemble::{
    Ensemble, EnsembleRuns, SHARES, SurvivalPoint, late_half_life, median_impacts,
};
use serde::{Serialize, Serializer};

use crate::api::ensembles::request::EnsembleRequest;
use crate::api::formats::Tabular;
use crate::api::scene::{Resolved, has_angle};
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::shared::tile::Tile;
use crate::charts::AnglesAt;

/// The runs that an answer is about.
#[derive(Debug, Serialize)]
pub(super) struct EnsembleTile {
    #[serde(flatten)]
    pub(super) tile: Tile,
    first_run: u64,
    pub(super) runs: u64,
}

/// Answer of `/v1/ensembles`.
#[derive(Debug, Serialize)]
pub struct EnsembleAnswer<'a> {
    pub(super) scene: Resolved<'a>,
    model: ModelChoice,
    runs: u64,
    pub(super) impacts: u64,
    pub(super) seed: u64,
    pub(super) tile: EnsembleTile,
    #[serde(flatten)]
    pub(super) summary: Summary,
    survival: Table,
    quantiles: Table,
    angles: Option<Vec<Vec<f64>>>,
    /// Contacts at which angles are watched.
    #[serde(skip)]
    watched: Vec<u64>,
    #[serde(skip)]
    pub(super) curve: Vec<SurvivalPoint>,
    #[serde(skip)]
    pub(super) marks: Vec<AnglesAt>,
}

/// The statistics of all runs, which are the last line of NDJSON.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    pub(super) survived: Survived,
    mean_impacts: f64,
    pub(super) median_impacts: Option<u64>,
    half_life: Option<f64>,
    #[serde(serialize_with = "by_name")]
    pub(super) counts: [u64; EndingKind::ALL.len()],
    notes: Vec<String>,
}

/// The runs that outlast all contacts, with their share and its confidence interval.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Survived {
    pub(super) runs: u64,
    pub(super) share: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
}

fn by_name<S: Serializer>(counts: &[u64; EndingKind::ALL.len()], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(EndingKind::ALL.into_iter().map(EndingKind::name).zip(counts))
}

impl<'a> EnsembleAnswer<'a> {
    /// The answer for all runs of a tile, with the angles at the watched contacts and their quantiles. `runs` holds no angles.
    pub fn new(
        request: &'a EnsembleRequest,
        runs: &EnsembleRuns,
        angles: Vec<Vec<f64>>,
        quantiles: &[Option<[f64; SHARES.len()]>],
    ) -> Self {
        let EnsembleRequest { ensemble, tile, .. } = request;
        let Ensemble { scene, impacts, .. } = ensemble;
        let curve = runs.survival(*impacts);
        let watched = ensemble.watched();
        let alive = watched.iter().map(|n| &curve[(n - 1) as usize]).map(|at| at.at_risk - at.ended).collect();
        let marks = watched.iter().zip(quantiles).filter_map(|(&n, found)| Some(AnglesAt { n, quantiles: (*found)? }));
        let marks = marks.collect();
        let summary = Summary::new(request, runs, &curve);
        let seed = match scene.value(Name::Seed) {
            Some(Value::Integer(seed)) => seed,
            _ => 0,
        };
        Self {
            scene: Resolved(scene),
            model: ModelChoice::of(scene),
            runs: ensemble.runs,
            impacts: *impacts,
            seed,
            tile: EnsembleTile { tile: *tile, first_run: request.numbers().start, runs: request.runs() },
            summary,
            survival: survival_table(&curve),
            quantiles: quantile_table(watched.clone(), alive, quantiles),
            watched,
            angles: request.angles.then_some(angles),
            curve,
            marks,
        }
    }
}

impl Tabular for EnsembleAnswer<'_> {
    /// The curve, with the quantiles at the watched contacts.
    fn to_table(&self) -> Cow<'_, Table> {
        let Table(mut columns) = self.survival.clone();
        for (which, name) in QUANTILES.iter().enumerate() {
            let mut cells = vec![None; self.curve.len()];
            for at in &self.marks {
                cells[(at.n - 1) as usize] = Some(at.quantiles[which]);
            }
            columns.push(Column { name: name.1, unit: "rad", cells: Cells::Sparse(cells) });
        }
        Cow::Owned(Table(columns))
    }

    /// The same with names that say |θ|, and with the angles themselves on request.
    fn to_arrow_table(&self) -> Cow<'_, Table> {
        let Table(mut columns) = self.to_table().into_owned();
        for (which, column) in columns.iter_mut().rev().take(QUANTILES.len()).rev().enumerate() {
            column.name = IN_ARROW[which];
        }
        if let Some(angles) = &self.angles {
            let mut cells = vec![None; self.curve.len()];
            for (n, angles) in self.watched.iter().zip(angles) {
                cells[(n - 1) as usize] = Some(angles.clone());
            }
            columns.push(Column { name: ANGLES, unit: "rad", cells: Cells::Lists(cells) });
        }
        Cow::Owned(Table(columns))
    }

    fn about(&self, name: &str) -> &'static str {
        match name {
            "at_risk" => "Number of runs that reach the contact.",
            "ended" => "Number of runs that end at the contact.",
            "survival" => "Share of the runs that go on after the contact.",
            "lower" | "upper" => "Wilson interval of that share, 95 %.",
            ANGLES => "Angles of the runs that go on, without sign and in order.",
            _ if IN_ARROW.contains(&name) => "Quantile of |θ| over the runs that go on.",
            _ => "",
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
        let EnsembleRequest { ensemble, tile, .. } = request;
        let impacts = ensemble.impacts;
        let survived = runs.count(EndingKind::Completed);
        let (share, (lower, upper)) = curve.last().map_or((1.0, (0.0, 1.0)), |last| (last.share, last.interval));
        let (median, half_life) = (median_impacts(curve), late_half_life(curve));
        let mut notes = vec![
            "intervals are those of Wilson, 95 % at each contact by itself; quantiles of |θ| are over the runs that \
                 went on"
                .to_owned(),
        ];
        if tile.of > 1 {
            let (numbers, all) = (request.numbers(), ensemble.runs);
            notes.push(format!(
                "all of this is about runs {} to {} of {all}: counts of tiles add up to those of all, quantiles \
                 do not, their angles do",
                numbers.start,
                numbers.end - 1,
            ));
        }
        if !is_noisy(&ensemble.scene) {
            let detail = "the scene has no noise, so all runs are alike: give noise.timing_sd or noise.angle_sd";
            notes.push(detail.to_owned());
        }
        if !matches!(ensemble.scene.value(Name::NoiseRun), None | Some(Value::Integer(0))) {
            notes.push("noise.run is not looked at: the runs are those of all numbers".to_owned());
        }
        if survived > 0 {
            notes.push(format!(
                "mean_impacts counts runs that outlast all contacts as {impacts}, so it is a lower bound"
            ));
        }
        if median.is_none() {
            notes.push(format!("median_impacts is null: more than half of the runs outlast all {impacts} contacts"));
        }
        if half_life.is_none() {
            notes.push(
                "half_life is null: it is from the second half of the contacts, where no run ended or all at once"
                    .to_owned(),
            );
        }
        if !has_angle(&ensemble.scene) {
            notes.push(
                "quantiles are of the angle of the velocity from straight down: a point mass has no other".to_owned(),
            );
        }
        Self {
            survived: Survived { runs: survived, share, lower, upper },
            mean_impacts: runs.mean_impacts(),
            median_impacts: median,
            half_life,
            counts: EndingKind::ALL.map(|outcome| runs.count(outcome)),
            notes,
        }
    }
}

/// Names of the quantiles: in JSON; in CSV and NDJSON.
const QUANTILES: [(&str, &str); SHARES.len()] =
    [("q05", "theta_q05"), ("q25", "theta_q25"), ("q50", "theta_q50"), ("q75", "theta_q75"), ("q95", "theta_q95")];

/// Names of the quantiles in Arrow.
const IN_ARROW: [&str; SHARES.len()] =
    ["abs_theta_q05", "abs_theta_q25", "abs_theta_q50", "abs_theta_q75", "abs_theta_q95"];

/// Name of the angles themselves in Arrow.
const ANGLES: &str = "abs_theta";

fn survival_table(curve: &[SurvivalPoint]) -> Table {
    let counts = |count: &dyn Fn(&SurvivalPoint) -> u64| Cells::Counts(curve.iter().map(count).collect());
    let numbers = |number: &dyn Fn(&SurvivalPoint) -> f64| Cells::Numbers(curve.iter().map(number).collect());
    let columns = [
        ("n", Cells::Counts((1..=curve.len() as u64).collect())),
        ("at_risk", counts(&|at| at.at_risk)),
        ("ended", counts(&|at| at.ended)),
        ("survival", numbers(&|at| at.share)),
        ("lower", numbers(&|at| at.interval.0)),
        ("upper", numbers(&|at| at.interval.1)),
    ];
    Table(columns.into_iter().map(|(name, cells)| Column { name, unit: "", cells }).collect())
}

fn quantile_table(watched: Vec<u64>, alive: Vec<u64>, quantiles: &[Option<[f64; SHARES.len()]>]) -> Table {
    let mut columns = vec![
        Column { name: "n", unit: "", cells: Cells::Counts(watched) },
        Column { name: "alive", unit: "", cells: Cells::Counts(alive) },
    ];
    columns.extend(QUANTILES.iter().enumerate().map(|(which, (name, _))| {
        let cells = quantiles.iter().map(|found| found.map(|found| found[which])).collect();
        Column { name, unit: "rad", cells: Cells::Sparse(cells) }
    }));
    Table(columns)
}
