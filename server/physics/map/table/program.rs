//! Target heights that a table takes one after another, one for each strike: juggling.

use crate::map::strike::Rod;
use crate::numbers::number::Number;

/// Most heights of a program. A longer one would be a curve, and every scene would carry it.
pub const MOST_HEIGHTS: usize = 16;

/// Target heights of the centre of gravity, m, one for each strike, in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightProgram {
    heights: [f64; MOST_HEIGHTS],
    count: usize,
}

impl HeightProgram {
    /// The program of these heights; `None` for none of them, or for more than [`MOST_HEIGHTS`].
    pub fn new(heights: &[f64]) -> Option<Self> {
        let mut program = Self { heights: [0.0; MOST_HEIGHTS], count: heights.len() };
        program.heights.get_mut(..heights.len()).filter(|place| !place.is_empty())?.copy_from_slice(heights);
        Some(program)
    }

    /// The program of so many heights, at most [`MOST_HEIGHTS`] and at least one; the compiler counts them.
    pub const fn of<const N: usize>(heights: [f64; N]) -> Self {
        const { assert!(N > 0 && N <= MOST_HEIGHTS) };
        let mut program = Self { heights: [0.0; MOST_HEIGHTS], count: N };
        let mut n = 0;
        while n < N {
            program.heights[n] = heights[n];
            n += 1;
        }
        program
    }

    /// The heights of one cycle.
    pub fn heights(&self) -> &[f64] {
        &self.heights[..self.count]
    }

    /// The target height of strike `n` (from 1).
    #[inline]
    pub fn at(&self, n: u64) -> f64 {
        self.heights[(n.saturating_sub(1) % self.count as u64) as usize]
    }

    /// The program whose strike 1 is strike `n` of this one.
    #[must_use]
    pub fn from_strike(mut self, n: u64) -> Self {
        let first = (n.saturating_sub(1) % self.count as u64) as usize;
        self.heights[..self.count].rotate_left(first);
        self
    }

    /// The rod whose table aims at the height of strike `n`.
    #[inline(always)]
    pub fn applied<N: Number>(&self, rod: &Rod<N>, n: u64) -> Rod<N> {
        Rod { target_energy: rod.gravity * N::from_f64(self.at(n)), ..*rod }
    }
}
