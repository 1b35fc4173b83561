//! A tile: an even share of the rows or runs of work that is too much for one request.

use std::ops::Range;

use schemars::JsonSchema;
use serde::Serialize;

use crate::http::Reader;
use crate::http::request::fields::{Absence, FieldList, FieldSpec, Required, Whole, whole};

/// Share number `index`, from 0, of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Tile {
    /// Number of the share, from 0.
    pub index: u64,
    /// Number of shares.
    pub of: u64,
}

impl Tile {
    /// All of the work.
    const WHOLE: Self = Self { index: 0, of: 1 };

    /// The share's part of `count` rows or runs.
    pub fn share(&self, count: u64) -> Range<u64> {
        count * self.index / self.of..count * (self.index + 1) / self.of
    }
}

/// A tile, one of at most so many. Without it the tile is all of the work.
#[derive(Debug, Clone, Copy)]
pub struct TileOf(pub u64);

impl TileOf {
    fn index(self) -> Required<Whole> {
        whole(0..=self.0).required()
    }

    fn of(self) -> Required<Whole> {
        whole(1..=self.0).required()
    }
}

impl FieldSpec<Tile> for TileOf {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Tile> {
        if !reader.has(name) {
            return Some(Tile::WHOLE);
        }
        reader.within(name, |tile| {
            let (index, of) = (self.index().read(tile, "index"), self.of().read(tile, "of"));
            let (index, of) = (index?, of?);
            if index >= of {
                tile.refuse("index", format!("index is {index}; it must be from 0 to {}, below `of`", of - 1));
                return None;
            }
            Some(Tile { index, of })
        })?
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(name, |tile| {
            self.index().describe("index", "Number of the share, from 0.", tile);
            self.of().describe("of", "Number of shares.", tile);
        });
        list.may_be_absent(name);
        list.property(name, about, &schema);
    }
}
