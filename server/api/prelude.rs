//! Names that the resources share, imported as `use crate::api::prelude::*`.

pub(crate) use crate::api::contract::Description;
pub(crate) use crate::api::formats::{
    ChartFormat, FigureFormat, GaugeFormat, Pictured, ProgressFormat, TableFormat, Tabular, Watched, WriteAnswer,
};
pub(crate) use crate::api::resource::{ComputedResource, ResourceRequest, Work};
pub(crate) use crate::api::scene::read::{LawlessSceneSpec, SceneSpec};
pub(crate) use crate::api::scene::write::resolved;
pub(crate) use crate::api::scene::{Derived, Resolved, bounce_price, has_angle};
pub(crate) use crate::api::schemas::{ContactMode, counts};
pub(crate) use crate::api::shared::answer_parts::{Eigenvalue, FixedPointAnswer, LoadAnswer, ModelChoice};
pub(crate) use crate::api::shared::refusal::{Refusal, lacking, noiseless, refuse_lacking};
pub(crate) use crate::api::shared::table::{ColumnWord, Read, RowColumn, Table, table_of};
pub(crate) use crate::api::shared::write::canonical_of;
pub(crate) use crate::charts::significant;
pub(crate) use crate::compute::{Cancelled, TimeSlice, TimeSlices};
pub(crate) use crate::http::request::fields::{
    Absence, FieldList, FieldSpec, Fields, Flag, Object, ObjectOfDefaults, Part, choice, exact_whole, number, whole,
};
pub(crate) use crate::http::{BodyWriter, Format, Problem, Reader};
pub(crate) use crate::limits::{Limit, Limits};
pub(crate) use crate::{column_lists, limits, request_fields, schemas, words};
pub(crate) use equipoise_physics::scene::capability::Analysis;
pub(crate) use schemars::JsonSchema;
pub(crate) use serde::{Serialize, Serializer};
pub(crate) use std::borrow::Cow;
