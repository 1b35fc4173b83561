//! The hold as a live run tells it: samples of the body in contact, column by column. Their columns are those of `/v1/catches`.

use serde::{Serialize, Serializer};

use crate::api::catches::columns::{OF_HOLD, to_table};
use crate::runs::caught::HoldPart;

/// Samples of a hold.
#[derive(Debug, Clone)]
pub struct HoldMessage(pub HoldPart);

impl Serialize for HoldMessage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Columns<T> {
            columns: T,
        }
        Columns { columns: to_table(OF_HOLD.iter().copied(), self.0.samples()) }.serialize(serializer)
    }
}
