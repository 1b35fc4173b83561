//! Margins of fields in one shape: the values on both sides at which stability is lost, and the distances to them.

use equipoise_physics::analysis::gain_range::StableGains;
use equipoise_physics::analysis::repeating::RepeatingBounce;
use equipoise_physics::analysis::small_deviations::SmallDeviations;
use equipoise_physics::scene::{Name, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::outcome::BriefOutcome;
use crate::api::shared::table::{Read, RowColumn};
use crate::words;

words! {
    /// A field of the scene; with `table.feedback` a factor on its four gains.
    pub MarginField = [TILT_GAIN, ENERGY_GAIN, FEEDBACK];

    /// `small`: small deviations from the bounce that repeats. `release`: the run of this release over `bounces` contacts.
    pub MarginOf = [SMALL, RELEASE];
}

/// The tilt gain.
pub const TILT_GAIN: &str = "table.tilt_gain";
/// The energy gain.
pub const ENERGY_GAIN: &str = "table.energy_gain";
/// The factor on the gains of a state feedback.
pub const FEEDBACK: &str = "table.feedback";
/// Kind of the margins of small deviations.
pub const SMALL: &str = "small";
/// Kind of the margins of the run of the release.
pub const RELEASE: &str = "release";

/// The margins of a field.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Margin {
    /// The field.
    #[schemars(with = "MarginField")]
    pub field: &'static str,
    /// Unit of `value`, `limit`, `margin`, `least` and `most`; 1 for none.
    pub unit: &'static str,
    /// Motion that the margin is of.
    #[schemars(with = "MarginOf")]
    pub of: &'static str,
    /// Value in the scene; 1 for the factor.
    pub value: f64,
    /// The lower limit. Null if there is none.
    pub below: Option<MarginEnd>,
    /// The upper limit. Null if there is none.
    pub above: Option<MarginEnd>,
}

/// The limit of a field on one side.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct MarginEnd {
    /// Value at which it is lost.
    pub limit: f64,
    /// Distance of the value from the limit: positive inside, negative outside.
    pub margin: f64,
    /// Least margin over the tolerances of `stability`, or over the confidence region of `fits`. Null without them, and where it is not known.
    pub least: Option<f64>,
    /// Greatest margin over them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
    /// Standard deviation of the margin of a fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sd: Option<f64>,
    /// Bound on the error of a limit that was searched; for a release the distance to the nearest value found at which the run ends otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
    /// End of the run of the release beyond the limit. Absent where no scene has a value beyond.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcome: Option<BriefOutcome>,
    /// Loss in one sentence, of a limit that was searched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<String>,
}

impl MarginEnd {
    /// A limit with the margin to it; `None` for one that is not finite.
    pub fn new(limit: f64, margin: f64) -> Option<Self> {
        let end =
            Self { limit, margin, least: None, most: None, sd: None, accuracy: None, outcome: None, detail: None };
        limit.is_finite().then_some(end)
    }

    /// The lower limit of a value.
    pub fn below(limit: f64, value: f64) -> Option<Self> {
        Self::new(limit, value - limit)
    }

    /// The upper limit of a value.
    pub fn above(limit: f64, value: f64) -> Option<Self> {
        Self::new(limit, limit - value)
    }
}

impl Margin {
    /// The factor on the gains of a state feedback, with the ends of its stable range.
    pub fn of_feedback(StableGains { lower, upper }: StableGains) -> Self {
        // Without the feedback nothing settles either.
        let below = if lower > 0.0 { MarginEnd::below(lower, 1.0) } else { None };
        Self { field: FEEDBACK, unit: "1", of: SMALL, value: 1.0, below, above: MarginEnd::above(upper, 1.0) }
    }

    /// The margins of small deviations of a scene with a tilt law: of the gains as they are set, whatever the table makes of them. A gain of which no
    /// value is stable has none.
    pub fn of_small(scene: &Scene, small: &SmallDeviations) -> Vec<Self> {
        let linear = &small.linear;
        let own = |name| scene.number(name).unwrap_or_default();
        let (tilts, moves) = (scene.tilt_factor(), scene.speed_factor());
        let (kappa, energy_gain) = (own(Name::TiltGain), own(Name::EnergyGain));
        let tilt_gain = linear.lower_tilt_gain.is_finite().then(|| Self {
            field: TILT_GAIN,
            unit: Name::TiltGain.row().unit,
            of: SMALL,
            value: kappa,
            below: MarginEnd::below(linear.lower_tilt_gain / tilts, kappa),
            above: MarginEnd::above(linear.critical_tilt_gain / tilts, kappa),
        });
        let upper = MarginEnd::above(linear.upper_energy_gain / moves, energy_gain);
        let energy_gain = upper.map(|upper| Self {
            field: ENERGY_GAIN,
            unit: Name::EnergyGain.row().unit,
            of: SMALL,
            value: energy_gain,
            // Without the feedback nothing moves the height.
            below: MarginEnd::below(linear.lower_energy_gain / moves, energy_gain).filter(|_| scene.steers_energy()),
            above: Some(upper),
        });
        let has_feedback = scene.model().feedback().is_some();
        let range = small.feedback_range.or_else(|| small.found.as_ref().and_then(RepeatingBounce::stable_gains));
        let range = range.filter(|StableGains { lower, upper }| has_feedback && lower < upper);
        let feedback = range.map(Self::of_feedback);
        [tilt_gain, energy_gain, feedback].into_iter().flatten().collect()
    }

    /// The end on a side.
    pub fn end(&self, side: Side) -> Option<&MarginEnd> {
        match side {
            Side::Below => self.below.as_ref(),
            Side::Above => self.above.as_ref(),
        }
    }
}

/// A side of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Lower values.
    Below,
    /// Higher values.
    Above,
}

impl Side {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Below, Self::Above];

    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Below => "below",
            Self::Above => "above",
        }
    }
}

/// A row with margins.
pub trait HasMargins {
    /// The margins.
    fn margins(&self) -> &[Margin];

    /// A number of an end of a margin.
    fn end(&self, of: &str, field: &str, side: Side, read: fn(&MarginEnd) -> Option<f64>) -> Option<f64> {
        read(self.margins().iter().find(|margin| (margin.of, margin.field) == (of, field))?.end(side)?)
    }
}

/// Columns of a number of both ends of fields: for each field the first part of the names, the motion, the field and its unit.
macro_rules! columns {
    ($number:literal, $about:literal, $read:expr; $($prefix:literal $of:ident $field:ident $unit:literal),+) => {
        [$(
            RowColumn::new(
                concat!($prefix, "_below_", $number),
                $unit,
                $about,
                Read::Sparse(|row| row.end($of, $field, Side::Below, $read)),
            ),
            RowColumn::new(
                concat!($prefix, "_above_", $number),
                $unit,
                $about,
                Read::Sparse(|row| row.end($of, $field, Side::Above, $read)),
            ),
        )+]
    };
    (gains: $number:literal, $about:literal, $read:expr) => {
        columns!($number, $about, $read; "tilt_gain" SMALL TILT_GAIN "", "energy_gain" SMALL ENERGY_GAIN "s²/m²", "feedback" SMALL FEEDBACK "")
    };
    (release: $number:literal, $about:literal, $read:expr) => {
        columns!($number, $about, $read; "release_tilt_gain" RELEASE TILT_GAIN "", "release_feedback" RELEASE FEEDBACK "")
    };
}

/// Limits of a state feedback for small deviations.
pub const fn limits_of_feedback<Row: HasMargins>() -> [RowColumn<Row>; 2] {
    columns!("limit", "Value at which it is lost.", |end| Some(end.limit); "feedback" SMALL FEEDBACK "")
}

/// Margins of it.
pub const fn margins_of_feedback<Row: HasMargins>() -> [RowColumn<Row>; 2] {
    columns!("margin", "Distance to it.", |end| Some(end.margin); "feedback" SMALL FEEDBACK "")
}

/// Limits of the gains for small deviations.
pub const fn limits<Row: HasMargins>() -> [RowColumn<Row>; 6] {
    columns!(gains: "limit", "Value at which it is lost.", |end| Some(end.limit))
}

/// Margins of them.
pub const fn margins<Row: HasMargins>() -> [RowColumn<Row>; 6] {
    columns!(gains: "margin", "Distance to it.", |end| Some(end.margin))
}

/// Least margins over tolerances.
pub const fn least<Row: HasMargins>() -> [RowColumn<Row>; 6] {
    columns!(gains: "least", "Least distance to it over the tolerances.", |end| end.least)
}

/// Limits of the gains for the run of the release.
pub const fn release_limits<Row: HasMargins>() -> [RowColumn<Row>; 4] {
    columns!(release: "limit", "Value at which the run ends otherwise.", |end| Some(end.limit))
}

/// Margins of them.
pub const fn release_margins<Row: HasMargins>() -> [RowColumn<Row>; 4] {
    columns!(release: "margin", "Distance to it.", |end| Some(end.margin))
}
