//! A tile of work that is too much for one request: an even share of its rows or runs, which come one after the other.

use std::ops::Range;

use serde::Serialize;

use crate::http::Reader;

/// Share number `index`, from 0, of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Tile {
    /// Which.
    pub index: u64,
    /// Of how many.
    pub of: u64,
}

impl Tile {
    /// All of it.
    const WHOLE: Self = Self { index: 0, of: 1 };

    /// Reads `tile`, of which there may be so many; all of it where none is said.
    pub fn read(reader: &mut Reader<'_, '_>, most: u64) -> Option<Self> {
        if !reader.has("tile") {
            return Some(Self::WHOLE);
        }
        reader.within("tile", |tile| {
            tile.require(&["index", "of"]);
            let (index, of) = (tile.integer("index", 0..=most), tile.integer("of", 1..=most));
            let (index, of) = (index?, of?);
            if index >= of {
                tile.refuse("index", format!("index is {index}; it must be from 0 to {}, below `of`", of - 1));
                return None;
            }
            Some(Self { index, of })
        })?
    }

    /// Which of so many are its own.
    pub fn share(&self, count: u64) -> Range<u64> {
        count * self.index / self.of..count * (self.index + 1) / self.of
    }
}
