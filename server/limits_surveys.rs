//! Fixed limits of regions and ensembles, with their units, meanings and reasons; part of `limits`.

use std::ops::RangeInclusive;

/// Values along one side of a region. A row is in memory as a whole, with its x values as text: about 10 MB. A region larger than one
/// answer is requested in tiles.
pub const REGION_SIDE: u64 = 100_000;

/// Work of one block of a region, which a thread computes at a time, in bounces in lanes: about 10 ms, so that other requests do not
/// wait longer.
pub const REGION_BLOCK_WORK: u64 = 1_000_000;

/// Price of a cell of a region besides its bounces, in bounces in lanes: the scene, the first flight, and writing.
pub const REGION_CELL_PRICE: u64 = 60;

/// Price of a bounce of a table with a program of heights, in bounces in lanes: every strike has its own height.
pub const REGION_PROGRAM_PRICE: u64 = 2;

/// Price of a cell that cannot run in lanes, besides its bounces, in bounces in lanes.
pub const REGION_ALONE_CELL_PRICE: u64 = 350;

/// Price of a cell with a quantity of the linear analysis, in bounces in lanes.
pub const REGION_LINEAR_CELL_PRICE: u64 = 200;

/// Price of a bounce of the plain rod, in bounces in lanes: catches are priced in the former.
pub const REGION_PLAIN_PRICE: u64 = 6;

/// Price of a region besides its cells and its linear boundary, in bounces in lanes: the picture, about 5 ms.
pub const REGION_ANSWER_PRICE: u64 = 400_000;

/// Price of a bounce in lanes on a table that errs, in other bounces in lanes.
pub const REGION_NOISE_PRICE: u64 = 4;

/// Price of a bounce outside lanes, in bounces in lanes: on a table with limits or a program of heights it takes 12, on one that errs in
/// its plan 35.
pub const REGION_ALONE_PRICE: u64 = 20;

/// Most memory of a cell of a region, with its value and its outcome, bytes: 36 as JSON, 48 as PNG.
pub const REGION_CELL_BYTES: u64 = 64;

/// Cells of one block: enough to fill the lanes, and few enough that rows are sent as they are done.
pub const REGION_BLOCK_CELLS: RangeInclusive<u64> = 64..=2048;

/// Nodes along a side of the grid on which the linear boundary of a region is found.
pub const REGION_BOUNDARY_NODES: usize = 49;

/// Runs of an ensemble in one answer. The interval of a share is then within 0.7 %.
pub const ENSEMBLE_RUNS: u64 = 20_000;

/// Runs of an ensemble in tiles. Counts of so many still add up exactly in double precision.
pub const ENSEMBLE_RUNS_IN_TILES: u64 = 1_000_000_000;

/// Work of one block of an ensemble, in bounces: about 10 ms, as for regions. A single run may take more.
pub const ENSEMBLE_BLOCK_WORK: u64 = 50_000;

/// Fewest runs of a block in lanes, a hundredth of all between these: enough to fill the lanes, and few enough that progress is told.
pub const ENSEMBLE_BLOCK_RUNS: RangeInclusive<u64> = 16..=64;

/// Bounces in lanes on a table that errs for the price of one of the plain rod.
pub const ENSEMBLE_LANE_BOUNCES: u64 = 2;

/// Price of an ensemble besides its runs, in bounces: the summary and the picture, about 6 ms.
pub const ENSEMBLE_ANSWER_PRICE: u64 = 80_000;

/// Price of a run of an ensemble besides its bounces, in bounces: the model and the first flight.
pub const ENSEMBLE_RUN_PRICE: u64 = 10;

/// Price of each contact of the survival curve, in bounces: the interval, and writing.
pub const ENSEMBLE_CONTACT_PRICE: u64 = 20;

/// Price of each stored angle, in bounces: sorting and writing.
pub const ENSEMBLE_ANGLE_PRICE: u64 = 2;

/// Contacts at which an ensemble stores the angle of each run, for quantiles: with `ENSEMBLE_RUNS` 4 million numbers, as many as an
/// answer may have.
pub const ENSEMBLE_ANGLE_CONTACTS: u64 = 200;

/// Most memory of a stored angle of an ensemble that is not in the answer, bytes: 24, sorted.
pub const ENSEMBLE_ANGLE_BYTES: u64 = 32;

/// The same of an angle that is, with its text, bytes: 81.
pub const ENSEMBLE_LISTED_ANGLE_BYTES: u64 = 96;
