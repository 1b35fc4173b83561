//! The contact after the last bounce of a run that settles, as an answer.

use equipoise_physics::map::friction::Slide;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{
    Hold, HoldEnding, HoldRequest, HoldSample, LONGEST_HOLD, hold, rest_of_run,
};
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::catches::columns::OF_HOLD;
use crate::api::shared::refusal::{Refusal, lacking};
use crate::api::shared::table::columns::{ColumnWord, RowColumn, table_of};
use crate::api::shared::table::stacked::{stacked, stacked_words};
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::trajectories::columns::{DATES, date, trajectory_words};
use crate::words;

/// The contact: its samples and its end.
#[derive(Debug)]
pub(crate) struct HoldAnswer {
    /// Samples.
    pub(crate) samples: Vec<HoldSample>,
    /// End.
    pub(crate) end: HoldEnd,
}

/// Impacts and the contact after them as one table, for CSV and NDJSON. The columns do not depend on the outcome: a run that did not
/// settle has no rows in contact. With a known time of release the contact has dates too.
pub(crate) fn phases(impacts: &Table, samples: Option<&Table>, epoch: Option<u64>) -> Table {
    let mut contact = samples.cloned().unwrap_or_else(|| table_of(&OF_HOLD, &[]));
    let times = contact.0.iter().find(|column| column.name == "t").and_then(|column| column.cells.numbers());
    if let (Some(epoch), Some(times)) = (epoch, times) {
        let dates = times.into_iter().map(|t| Some(date(epoch, t))).collect();
        contact.0.push(Column { name: DATES, unit: "", cells: Cells::SparseCounts(dates) });
    }
    stacked(&[("impact", impacts), ("hold", &contact)])
}

/// What the contract says of the columns of [`phases`].
pub(crate) fn phase_words() -> Vec<ColumnWord> {
    stacked_words(&[trajectory_words(), OF_HOLD.iter().map(RowColumn::word).collect()])
}

words! {
    /// The end of a contact after the bounces.
    /// `completed`: the body stays in contact up to the end of `hold`.
    /// `contact_lost`: no table that pushes keeps the contact point at its height.
    /// `slipped`: a contact that has to stick needs more friction than there is.
    /// `toppled`: the angle reached `topple_angle`.
    /// `other_vertex`: another vertex of a polygon came down to the table.
    /// `rests_on_edge`: a polygon came to rest on an edge.
    /// `beyond_limits`: the contact needs more than `table.limits` allow.
    /// `off_table`: the contact point came to an end of the table (`table.length`).
    /// `too_long`: the motion could not be followed to its end, with twice the work by which the hold is priced.
    HoldEndKind = [
        "completed", "contact_lost", "slipped", "toppled", "other_vertex", "rests_on_edge", "beyond_limits", "off_table", "too_long"
    ];
    /// `frictionless`: the contact point slides freely.
    /// `matched`: the table moves along itself with the contact point, as at strikes with `slide: matched`, and its force along itself is at most
    /// μN.
    /// `coulomb`: the table does not move along itself; the contact point slides with the force μN against it until it rests, and sticks while
    /// that needs less.
    HoldContact = ["frictionless", "matched", "coulomb"];
}

/// The end of the contact that follows the bounces of a run. The table tilts about the contact point by the law of the scene.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct HoldEnd {
    /// Name of the ending.
    #[schemars(with = "HoldEndKind")]
    pub kind: &'static str,
    /// Run time of the end, s.
    pub t: f64,
    /// One sentence, with numbers.
    pub detail: String,
    /// Kind of contact.
    #[schemars(with = "HoldContact")]
    pub contact: &'static str,
    /// Bound on the error of the samples by two tolerances of the integrator, m/s. It bounds |δx| (m), |ρδθ| (m), |δẋ| and |ρδθ̇|. Null if the two
    /// solutions do not end alike.
    pub error_bound: Option<f64>,
    /// Times from which the body stays upright and in place.
    pub upright_within: UprightWithin,
}

/// Times from which the body stays upright and in place up to the end of a completed hold. Null if it does not get there.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct UprightWithin {
    /// Time from which |θ| stays within 1 mrad, s.
    pub theta_1mrad: Option<f64>,
    /// Time from which |x| stays within 1 mm, s.
    pub x_1mm: Option<f64>,
}

impl HoldAnswer {
    /// Follows a run that ended at its `last` contact for `duration` s more. `Err` has a reason if it did not settle.
    ///
    /// # Errors
    /// Cancelled work.
    pub(crate) fn compute(
        scene: &Scene,
        (ending, last): (Ending, Option<&Contact>),
        duration: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Result<Self, String>, Refusal> {
        let (Ending::Settled { settle_time, .. }, Some(last)) = (ending, last) else {
            return Ok(Err(format!("hold is absent: the run ended as `{}`, not as `settled`", ending.name())));
        };
        if let Some(why) = lacking(scene, Analysis::LastingContact) {
            return Ok(Err(format!("hold is absent: {why}")));
        }
        let Some(request) = rest_of_run(scene, last, settle_time, duration) else {
            return Ok(Err("hold is absent: the last contact has no strike".to_owned()));
        };
        let held = hold(&request, go_on);
        if held.ending == HoldEnding::Stopped {
            return Err(Refusal::Cancelled);
        }
        let end = HoldEnd::new(&request, &held);
        Ok(Ok(Self { samples: held.samples, end }))
    }
}

impl HoldEnd {
    fn new(request: &HoldRequest, held: &Hold) -> Self {
        let (t, theta) = (held.t_end, held.samples.last().map_or(0.0, |last| last.theta));
        let (kind, detail) = match held.ending {
            HoldEnding::Completed => ("completed", format!("the body stays in contact up to t = {t} s")),
            HoldEnding::ContactLost => {
                ("contact_lost", format!("at t = {t} s, no pushing table keeps the contact point at its height"))
            }
            HoldEnding::Slipped { needed } => (
                "slipped",
                format!(
                    "at t = {t} s, sticking needs a friction of {needed}; contact.friction is {}",
                    request.friction().map_or(0.0, |friction| friction.coefficient)
                ),
            ),
            HoldEnding::Toppled => (
                "toppled",
                format!(
                    "at t = {t} s, the angle {theta} rad had reached topple_angle {} rad",
                    request.rules.topple_angle
                ),
            ),
            HoldEnding::OtherVertex(vertex) => {
                ("other_vertex", format!("at t = {t} s, vertex {vertex} of the body came down to the table"))
            }
            HoldEnding::RestsOnEdge { vertices: [one, other] } => {
                ("rests_on_edge", format!("at t = {t} s, the body rests on vertices {one} and {other}"))
            }
            HoldEnding::BeyondLimits(limit) => (
                "beyond_limits",
                format!(
                    "at t = {t} s, the contact asks for a {} of {} {}; table.limits.{} is {} {}",
                    limit.quantity, limit.value, limit.unit, limit.quantity, limit.limit, limit.unit
                ),
            ),
            HoldEnding::OffTable { place, limit } => (
                "off_table",
                format!("at t = {t} s, the contact point is at {place} m, beyond the end of the table at {limit} m"),
            ),
            HoldEnding::Stopped | HoldEnding::TooLong => (
                "too_long",
                format!(
                    "at t = {t} s, the contact changes too often, or too fast, to be followed up to {LONGEST_HOLD} s"
                ),
            ),
        };
        Self {
            kind,
            t,
            detail,
            contact: match request.friction().map(|friction| friction.slide) {
                None => "frictionless",
                Some(Slide::Matched) => "matched",
                Some(Slide::None) => "coulomb",
            },
            error_bound: Some(held.error_bound).filter(|bound| bound.is_finite()),
            upright_within: UprightWithin { theta_1mrad: held.theta_within, x_1mm: held.x_within },
        }
    }
}
