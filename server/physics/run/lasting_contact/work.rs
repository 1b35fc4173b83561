//! The work that a motion in contact takes, known before it is followed.
//!
//! The work follows from the eigenvalues of the motion about upright. A mode λ takes steps of the integrator for each unit of |λ|t until it
//! has died out, or has grown so far that the body falls. From then on the fastest mode keeps the steps short, although it has died out
//! too: the method is explicit. The body is then at rest up to rounding, so that each step has many turns of x, θ and α to search for.
//!
//! The unit is a step, or the search for a turn, which takes about as long.

use crate::numbers::dual::Dual;
use crate::run::cancellation::CancellationCheck;
use crate::run::lasting_contact::equations::{ContactMotion, Mode, Piece, Stance, TableFall};
use crate::run::lasting_contact::request::{HoldEnding, HoldLaw, HoldRequest, LONGEST_HOLD, Motion};
use nalgebra::{Complex, Matrix4, RowVector4, Schur};
use std::iter::once;

/// Longest step, s.
pub(super) const LONGEST_STEP: f64 = 0.1;

/// Most kinds of contact in one motion.
pub(super) const MOST_PIECES: u32 = 1000;

/// Work of the beginning and the end of a contact.
const BEGINNING: f64 = 400.0;

/// Work for each unit of |λ|t of a mode that is still there.
const MOVING: f64 = 5.0;

/// |λ|t of a mode from which on it counts as one that swings without end.
const LASTING: f64 = 56.0;

/// Work for each unit of |λ|t of such a mode, and of friction on a table that moves along itself, which may reach its limit in every swing:
/// steps are short there.
const SWINGING: f64 = 30.0;

/// Change of size, in powers of e, over which a mode is followed: from 1 to the tolerance, or back.
const CHANGE: f64 = 28.0;

/// Work for each unit of |λ|t of the fastest mode at rest: a quarter of a step for the stability of the method, with its turns.
const AT_REST: f64 = 1.75;

/// Work of the beginning of a kind of contact: its first step is short, and its end is searched for.
pub(super) const PIECE: u32 = 4;

/// Kinds of contact for each unit of |λ|t of a contact that slides and sticks in turn.
const PIECES_PER_RADIAN: f64 = 1.0;

/// Kinds of contact of a rocking polygon over its vertices squared: the more of them, the less speed a landing takes.
const PIECES_PER_SQUARE: f64 = 2.0;

/// Largest allowed ratio of the work of a contact to that which its eigenvalues tell: they are of a motion near upright.
const SLACK: f64 = 2.0;

/// Most work of a contact with one tolerance: [`MOST_STEPS`] at rest, with their turns.
const MOST_WORK: f64 = 1e6;

/// Most steps of one piece. A contact that needs more is too fast to be followed.
pub(super) const MOST_STEPS: usize = 100_000;

/// Vertical velocity of a contact point, m/s, with which a table may meet it: a fall of 100 m at 100 m/s².
const FASTEST_TOUCHDOWN: f64 = 150.0;

/// Iterations of the search for eigenvalues.
const MOST_ITERATIONS: usize = 1000;

pub(super) struct Work<'a> {
    left: u32,
    check: CancellationCheck<'a>,
}

impl<'a> Work<'a> {
    pub(super) fn new(request: &HoldRequest, go_on: &'a mut dyn FnMut() -> bool) -> Self {
        let left = (SLACK * request.estimate()).min(MOST_WORK) as u32;
        Self { left, check: CancellationCheck::new(go_on) }
    }

    /// Takes a part of it. Fails with [`HoldEnding::TooLong`] beyond it, [`HoldEnding::Stopped`] if the caller stops.
    pub(super) fn take(&mut self, part: u32) -> Result<(), HoldEnding> {
        self.left = self.left.checked_sub(part).ok_or(HoldEnding::TooLong)?;
        if self.check.pass(part.into()) { Ok(()) } else { Err(HoldEnding::Stopped) }
    }
}

impl HoldRequest {
    /// Price of this contact: steps with both tolerances. [`super::HoldEnding::TooLong`] comes before twice that.
    pub fn work(&self) -> u64 {
        2 * self.estimate().min(MOST_WORK / SLACK) as u64
    }

    fn estimate(&self) -> f64 {
        let duration = self.duration.clamp(0.0, LONGEST_HOLD);
        let held = self.work_of(self.law, 0.0, duration);
        let braked = self.brake.filter(|brake| *brake > 0.0).map_or(0.0, |brake| {
            let speed = if self.start.table_speed != 0.0 { self.start.table_speed.abs() } else { FASTEST_TOUCHDOWN };
            let law = self.brake_law.unwrap_or(self.law);
            self.work_of(law, brake, duration.min(speed / brake))
        });
        BEGINNING + held + braked
    }

    /// Work of `duration`, s, by a law on a table that brakes at `brake`, m/s².
    fn work_of(&self, law: HoldLaw, brake: f64, duration: f64) -> f64 {
        let (stance, fall) =
            (Stance::new(self), TableFall { y: 0.0, y_dot: 0.0, y_ddot: brake, stands: f64::INFINITY });
        let (kind, slides) = self.kind(law);
        let sliding = slides.into_iter().flat_map(|friction| [Mode::Sliding(friction), Mode::Sliding(-friction)]);
        let work = once(kind)
            .chain(sliding)
            .map(|mode| {
                Piece { request: self, stance, law, way: None, mode, begin: 0.0, fall, rising: None }.work(duration)
            })
            .fold(0.0, f64::max);
        let vertices =
            self.body.outline.filter(|_| law == HoldLaw::Level).map_or(0, |outline| outline.vertices().len());
        let pieces = (PIECES_PER_SQUARE * (vertices * vertices) as f64).min(f64::from(MOST_PIECES));
        duration / LONGEST_STEP + work + f64::from(PIECE) * pieces
    }
}

impl Piece<'_> {
    /// Work of `duration`, s, about upright.
    fn work(&self, duration: f64) -> f64 {
        let modes = self.modes();
        let fastest = modes.iter().map(|mode| size(*mode)).fold(0.0, f64::max);
        let moving = modes.iter().map(|mode| size(*mode) * duration.min(CHANGE / mode.re.abs())).fold(0.0, f64::max);
        let pieces = match self.mode {
            Mode::Sliding(share) if share != 0.0 => f64::from(PIECE) * PIECES_PER_RADIAN,
            Mode::Sliding(_) | Mode::Matched(_) | Mode::Sticking => 0.0,
        };
        let lasting = if matches!(self.mode, Mode::Matched(_)) { 0.0 } else { LASTING };
        let swinging = (moving - lasting).max(0.0);
        MOVING * moving + (SWINGING - MOVING) * swinging + pieces * moving + AT_REST * fastest * duration
    }

    /// Eigenvalues of the motion about upright, 1/s.
    fn modes(&self) -> [Complex<f64>; 4] {
        let motion: Motion<Dual<4>> = std::array::from_fn(|place| Dual::along(0.0, place, 1.0));
        let ContactMotion { x_ddot, theta_ddot, .. } = self.accelerations(0.0, &motion);
        let [x_ddot, theta_ddot] = [x_ddot, theta_ddot].map(|acceleration| RowVector4::from(acceleration.partials));
        let speeds = [2, 3].map(|place| RowVector4::from_fn(|_, column| f64::from(u8::from(column == place))));
        let matrix = Matrix4::from_rows(&[speeds[0], speeds[1], x_ddot, theta_ddot]);
        let unknown = [Complex::new(0.0, matrix.norm()); 4];
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return unknown;
        }
        let schur = Schur::try_new(matrix, f64::EPSILON, MOST_ITERATIONS);
        schur.map_or(unknown, |schur| schur.complex_eigenvalues().into())
    }
}

fn size(mode: Complex<f64>) -> f64 {
    (mode.re * mode.re + mode.im * mode.im).sqrt()
}
