//! Programs of heights of the tables in the lanes: another target for each strike.

use crate::batch::lanes::{Rods, WIDTH};
use crate::batch::mask::{Mask, bits};
use crate::bounce::strike::Rod;
use crate::table::program::{HeightProgram, MOST_HEIGHTS};

/// Programs of heights, as energies; of lanes without one it keeps nothing.
pub(super) struct ProgramLanes {
    /// Lanes whose tables have one.
    pub(super) lanes: Mask,
    /// Target energies of one cycle, m²/s².
    targets: [[f64; MOST_HEIGHTS]; WIDTH],
    count: [usize; WIDTH],
    /// Place of the coming strike in the cycle.
    next: [usize; WIDTH],
}

impl ProgramLanes {
    pub(super) fn new() -> Self {
        Self { lanes: 0, targets: [[0.0; MOST_HEIGHTS]; WIDTH], count: [1; WIDTH], next: [0; WIDTH] }
    }

    /// Begins the program of the table in a lane, if it has one.
    pub(super) fn load(&mut self, lane: usize, rod: &Rod, program: Option<&HeightProgram>) {
        self.lanes &= !(1 << lane);
        let Some(program) = program else { return };
        self.lanes |= 1 << lane;
        for (n, target) in (1..).zip(&mut self.targets[lane]) {
            *target = program.applied(rod, n).target_energy;
        }
        (self.count[lane], self.next[lane]) = (program.heights().len(), 0);
    }

    /// Aims tables at the heights of their coming strikes.
    #[inline(never)]
    pub(super) fn aim(&mut self, rods: &mut Rods) {
        for lane in bits(self.lanes) {
            let next = self.next[lane];
            rods.aim(lane, self.targets[lane][next]);
            self.next[lane] = if next + 1 == self.count[lane] { 0 } else { next + 1 };
        }
    }
}
