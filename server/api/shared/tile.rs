//! A tile: an even share of the rows or runs of work that is too much for one request.

use std::ops::Range;

use serde::Serialize;

use crate::http::Reader;

/// Share number `index`, from 0, of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Tile {
    /// Number of the share, from 0.
    pub index: u64,
    /// Number of shares.
    pub of: u64,
}

impl Tile {
    /// All of the work.
    const WHOLE: Self = Self { index: 0, of: 1 };

    /// Reads `tile`, one of at most `most`. Without it the tile is all of the work.
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

    /// The share's part of `count` rows or runs.
    pub fn share(&self, count: u64) -> Range<u64> {
        count * self.index / self.of..count * (self.index + 1) / self.of
    }
}
