//! The request and the answer of `ensembles`: many runs of a scene, and what became of them.

use std::ops::Range;

use equipoise_physics::run::ending::Outcome;
use equipoise_physics::scene::model::Rung;
use equipoise_physics::scene::{Kind, Name, Scene, Value};
use equipoise_physics::surveys::ensemble::{Ensemble, Runs, SHARES, Survival, late_half_life, median_impacts};
use serde::{Serialize, Serializer};

use crate::api::scene::{Resolved, bounce_price, build_scene, has_angle, read_draft};
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::shared::tile::Tile;
use crate::api::trajectories::answer::Choice;
use crate::charts::{AnglesAt, SurvivalAt, SurvivalCurve, significant, survival_curve};
use crate::http::Reader;
use crate::limits;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// All runs.
    pub ensemble: Ensemble,
    /// Which of them.
    pub tile: Tile,
    /// Whether the angles themselves are in the answer.
    pub angles: bool,
}

impl Request {
    /// Reads a request.
    pub fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let draft = read_draft(reader);
        let said = reader.integer("runs", 1..=limits::ENSEMBLE_RUNS_IN_TILES);
        let is_known = said.is_some() || !reader.has("runs");
        let runs = said.unwrap_or(200);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(400);
        let Kind::Integer { maximum } = Name::Seed.row().kind else { return None };
        let seed = reader.integer("seed", 0..=maximum);
        let angles = reader.boolean("angles").unwrap_or(false);
        let is_tiled = reader.has("tile");
        let tile = Tile::read(reader, limits::ENSEMBLE_RUNS_IN_TILES);
        if let Some(tile) = tile.filter(|_| is_known) {
            check_tile(reader, tile, is_tiled, runs);
        }
        let mut draft = draft?;
        if let Some(seed) = seed
            && let Err(error) = draft.set(Name::Seed, Some(Value::Integer(seed)))
        {
            reader.refuse("seed", error.detail);
            return None;
        }
        let pointer = reader.pointer_to("scene");
        let scene = build_scene(draft, &pointer, reader.errors())?;
        let ensemble = Ensemble { scene, runs, impacts, angle_contacts: limits::ENSEMBLE_ANGLE_CONTACTS };
        Some(Self { ensemble, tile: tile?, angles })
    }

    /// The numbers of the runs of the tile.
    pub fn numbers(&self) -> Range<u64> {
        self.tile.share(self.ensemble.runs)
    }

    /// How many they are.
    pub fn runs(&self) -> u64 {
        let numbers = self.numbers();
        numbers.end - numbers.start
    }

    /// Price, in bounces of the plain rod.
    pub fn price(&self) -> u64 {
        let Ensemble { scene, impacts, angle_contacts, .. } = &self.ensemble;
        let bounces = impacts.saturating_mul(bounce_price(scene));
        let angles = limits::ENSEMBLE_ANGLE_PRICE * angle_contacts.min(impacts);
        let runs = self.runs().saturating_mul(bounces + limits::ENSEMBLE_RUN_PRICE + angles);
        runs.saturating_add(impacts * limits::ENSEMBLE_CONTACT_PRICE + limits::ENSEMBLE_ANSWER_PRICE)
    }

    /// How many angles are in the answer, at most.
    pub fn angles(&self) -> u64 {
        let watched = self.ensemble.angle_contacts.min(self.ensemble.impacts);
        if self.angles { self.runs() * watched } else { 0 }
    }
}

/// A tile has a run, and no more than one answer may have.
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

/// Which runs an answer is about.
#[derive(Debug, Serialize)]
struct Part {
    #[serde(flatten)]
    tile: Tile,
    first_run: u64,
    runs: u64,
}

/// The answer.
#[derive(Debug, Serialize)]
pub struct Answer<'a> {
    scene: Resolved<'a>,
    model: Choice,
    runs: u64,
    impacts: u64,
    seed: u64,
    tile: Part,
    #[serde(flatten)]
    summary: Summary,
    survival: Table,
    quantiles: Table,
    angles: Option<Vec<Vec<f64>>>,
    #[serde(skip)]
    curve: Vec<Survival>,
    #[serde(skip)]
    marks: Vec<AnglesAt>,
}

/// What the runs have in common, and what ends an answer as NDJSON.
#[derive(Debug, Serialize)]
pub struct Summary {
    survived: Survived,
    mean_impacts: f64,
    median_impacts: Option<u64>,
    half_life: Option<f64>,
    #[serde(serialize_with = "by_name")]
    counts: [u64; Outcome::ALL.len()],
    notes: Vec<String>,
}

/// Those that outlasted all contacts.
#[derive(Debug, Serialize)]
struct Survived {
    runs: u64,
    share: f64,
    lower: f64,
    upper: f64,
}

fn by_name<S: Serializer>(counts: &[u64; Outcome::ALL.len()], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(Outcome::ALL.into_iter().map(Outcome::name).zip(counts))
}

impl<'a> Answer<'a> {
    /// From all runs of a tile, and the angles and their quantiles at the contacts it watched; the runs have none any more.
    pub fn new(
        request: &'a Request,
        runs: &Runs,
        angles: Vec<Vec<f64>>,
        quantiles: &[Option<[f64; SHARES.len()]>],
    ) -> Self {
        let Request { ensemble, tile, .. } = request;
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
            model: Choice::model(scene),
            runs: ensemble.runs,
            impacts: *impacts,
            seed,
            tile: Part { tile: *tile, first_run: request.numbers().start, runs: request.runs() },
            summary,
            survival: survival_table(&curve),
            quantiles: quantile_table(watched, alive, quantiles),
            angles: request.angles.then_some(angles),
            curve,
            marks,
        }
    }

    /// The curve as rows of CSV or NDJSON, with the quantiles at those contacts that have them.
    pub fn rows(&self) -> Table {
        let Table(mut columns) = self.survival.clone();
        for (which, name) in QUANTILES.iter().enumerate() {
            let mut cells = vec![None; self.curve.len()];
            for at in &self.marks {
                cells[(at.n - 1) as usize] = Some(at.quantiles[which]);
            }
            columns.push(Column { name: name.1, unit: "rad", cells: Cells::Sparse(cells) });
        }
        Table(columns)
    }

    /// What stands beside the rows.
    pub fn summary(&self) -> &Summary {
        &self.summary
    }

    /// The survival curve and the quantiles, as SVG.
    pub fn to_picture(&self) -> String {
        let Survived { runs, share, lower, upper } = self.summary.survived;
        let percent = |share: f64| significant(100.0 * share, 3);
        let counts = Outcome::ALL.into_iter().zip(self.summary.counts).filter(|(_, count)| *count > 0);
        let counts: Vec<_> = counts.map(|(outcome, count)| format!("{count} {}", outcome.name())).collect();
        let median = match self.summary.median_impacts {
            Some(median) => format!("half have ended by contact {median}"),
            None => "more than half outlast them all".to_owned(),
        };
        let caption = format!(
            "{runs} of {} runs outlast {} contacts: {} %, with 95 % confidence {} to {} % (Wilson, at each contact by \
             itself); {median}. Angles are those of the runs still going.",
            self.tile.runs,
            self.impacts,
            percent(share),
            percent(lower),
            percent(upper),
        );
        let Tile { index, of } = self.tile.tile;
        let part = if of > 1 { format!(", tile {} of {of}", index + 1) } else { String::new() };
        let points =
            self.curve.iter().map(|at| SurvivalAt { at_risk: at.at_risk, share: at.share, interval: at.interval });
        survival_curve(&SurvivalCurve {
            title: &format!("Survival of {} runs {}", self.tile.runs, noise_in_words(self.scene.0)),
            subtitle: &format!("seed {}{part}; {}", self.seed, counts.join(", ")),
            caption: &caption,
            curve: &points.collect::<Vec<_>>(),
            angles: &self.marks,
        })
    }
}

/// What noise a scene has, for a title.
fn noise_in_words(scene: &Scene) -> String {
    let Some(Value::Choice(model)) = scene.value(Name::NoiseModel).filter(|_| is_noisy(scene)) else {
        return "without noise".to_owned();
    };
    let said = |name| scene.number(name).filter(|sd| *sd > 0.0);
    let timing = said(Name::TimingSd).map(|sd| format!(", σ_t = {} ms", significant(1e3 * sd, 3)));
    let angle = said(Name::AngleSd).map(|sd| format!(", σ_θ = {} rad", significant(sd, 3)));
    format!("with {model} noise{}{}", timing.unwrap_or_default(), angle.unwrap_or_default())
}

fn is_noisy(scene: &Scene) -> bool {
    scene.forced().iter().any(|forced| forced.rung == Rung::Noise)
}

impl Summary {
    fn new(request: &Request, runs: &Runs, curve: &[Survival]) -> Self {
        let Request { ensemble, tile, .. } = request;
        let impacts = ensemble.impacts;
        let survived = runs.count(Outcome::Completed);
        let (share, (lower, upper)) = curve.last().map_or((1.0, (0.0, 1.0)), |last| (last.share, last.interval));
        let (median, half_life) = (median_impacts(curve), late_half_life(curve));
        let mut notes = vec![
            "intervals are those of Wilson, 95 % at each contact by itself; quantiles of |θ| are over the runs that went on"
                .to_owned(),
        ];
        if tile.of > 1 {
            let (numbers, all) = (request.numbers(), ensemble.runs);
            notes.push(format!(
                "all of this is about runs {} to {} of {all}: counts of tiles add up to those of all, quantiles do not, their angles do",
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
            counts: Outcome::ALL.map(|outcome| runs.count(outcome)),
            notes,
        }
    }
}

/// The names of quantiles in JSON, and in CSV and NDJSON.
const QUANTILES: [(&str, &str); SHARES.len()] =
    [("q05", "theta_q05"), ("q25", "theta_q25"), ("q50", "theta_q50"), ("q75", "theta_q75"), ("q95", "theta_q95")];

fn survival_table(curve: &[Survival]) -> Table {
    let counts = |count: &dyn Fn(&Survival) -> u64| Cells::Counts(curve.iter().map(count).collect());
    let numbers = |number: &dyn Fn(&Survival) -> f64| Cells::Numbers(curve.iter().map(number).collect());
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
