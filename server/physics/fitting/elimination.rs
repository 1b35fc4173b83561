//! Elimination of the windows' own unknowns from the linearized problem, window by window, so that time is linear in their number.
//!
//! A window has rows (J_u | J_p | r). Their QR factor R is triangular: its upper rows give the step of the window's unknowns u from that of the
//! fields p, its lower ones are all that the window says about p. This is the Schur complement of the arrow-shaped normal
//! equations without squaring them (Golub and Pereyra 1973).

use nalgebra::DMatrix;

/// The linearized rows of a window, before and after their QR.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Unknowns of the window, in number.
    pub(super) own: usize,
    /// Rows (J_u | J_p | r), each over its standard deviation.
    pub(super) rows: DMatrix<f64>,
    /// Their factor, square and upper triangular.
    factor: DMatrix<f64>,
    /// Column norms of `rows`.
    norms: Vec<f64>,
}

/// Weight of the wish that unknowns of a window do not move, in place of data that say nothing about them.
const RIDGE: f64 = 1e-6;

/// A step of all unknowns.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) own: Vec<Vec<f64>>,
    pub(super) fields: Vec<f64>,
    /// Sum of squares that is left after it, to first order.
    pub(super) left: f64,
}

impl Step {
    /// Shares of this step and of another one together.
    pub(super) fn sum(&self, share: f64, (others, other): (f64, &Self)) -> Self {
        let sum = |one: &[f64], other: &[f64]| {
            one.iter().zip(other).map(|(one, other)| share * one + others * other).collect()
        };
        let own = self.own.iter().zip(&other.own).map(|(one, other)| sum(one, other)).collect();
        Self { own, fields: sum(&self.fields, &other.fields), left: self.left }
    }

    /// Size of a step, each unknown by its effect on the data.
    pub(super) fn size(&self, blocks: &[Block]) -> f64 {
        let squares = |block: &Block, own: &[f64]| {
            let changes = own.iter().chain(&self.fields).zip(&block.norms);
            changes.map(|(change, norm)| change * norm * change * norm).sum::<f64>()
        };
        blocks.iter().zip(&self.own).map(|(block, own)| squares(block, own)).sum::<f64>().sqrt()
    }
}

/// The triangular factor of a matrix with at least as many rows as columns.
fn triangular(matrix: DMatrix<f64>) -> DMatrix<f64> {
    matrix.qr().r()
}

impl Block {
    pub(super) fn new(own: usize, rows: DMatrix<f64>) -> Self {
        let (count, width) = rows.shape();
        let norms: Vec<f64> = (0..width).map(|column| rows.column(column).norm()).collect();
        let padded = rows.clone().resize_vertically(count.max(width), 0.0);
        Self { own, factor: triangular(padded), rows, norms }
    }

    /// The factor of the rows and of a wish that the window's unknowns stay, each with a weight times its column's norm.
    fn damped(&self, weight: f64) -> DMatrix<f64> {
        let width = self.factor.ncols();
        let mut matrix = self.factor.clone().resize_vertically(width + self.own, 0.0);
        for own in 0..self.own {
            let norm = if self.norms[own] > 0.0 { self.norms[own] } else { 1.0 };
            matrix[(width + own, own)] = (weight * norm).max(RIDGE);
        }
        triangular(matrix)
    }
}

/// All that windows say about the fields: the factor of (J_p | r) with their own unknowns eliminated.
pub(super) fn reduced(blocks: &[Block], fields: usize) -> (DMatrix<f64>, Vec<DMatrix<f64>>) {
    reduce(blocks, &vec![0.0; fields], 0.0)
}

fn reduce(blocks: &[Block], ridges: &[f64], damping: f64) -> (DMatrix<f64>, Vec<DMatrix<f64>>) {
    let fields = ridges.len();
    let width = fields + 1;
    let factors: Vec<_> = blocks.iter().map(|block| block.damped(damping)).collect();
    let mut stacked = DMatrix::zeros(blocks.len() * width + fields, width);
    for (place, (block, factor)) in blocks.iter().zip(&factors).enumerate() {
        stacked
            .view_mut((place * width, 0), (width, width))
            .copy_from(&factor.view((block.own, block.own), (width, width)));
    }
    for field in 0..fields {
        let squares: f64 = blocks.iter().map(|block| block.norms[block.own + field]).map(|norm| norm * norm).sum();
        stacked[(blocks.len() * width + field, field)] = (damping * squares.sqrt()).max(ridges[field]);
    }
    (triangular(stacked), factors)
}

/// The step of Levenberg and Marquardt with fields kept between bounds. A field moves little by itself where its column is below `ridges`.
pub(super) fn step(blocks: &[Block], bounds: &[(f64, f64)], ridges: &[f64], damping: f64) -> Step {
    let fields = bounds.len();
    let (factor, factors) = reduce(blocks, ridges, damping);
    let (moved, left) = solve_bounded(&factor, bounds);
    let own = blocks.iter().zip(&factors).map(|(block, factor)| {
        let right: Vec<f64> = (0..block.own)
            .map(|row| {
                let of_fields: f64 = (0..fields).map(|field| factor[(row, block.own + field)] * moved[field]).sum();
                -factor[(row, block.own + fields)] - of_fields
            })
            .collect();
        back_substitute(factor, right)
    });
    Step { own: own.collect(), left, fields: moved.clone() }
}

/// Solves an upper triangular system; what it does not determine is 0.
pub(super) fn back_substitute(factor: &DMatrix<f64>, mut right: Vec<f64>) -> Vec<f64> {
    for row in (0..right.len()).rev() {
        let known: f64 = (row + 1..right.len()).map(|column| factor[(row, column)] * right[column]).sum();
        let pivot = factor[(row, row)];
        right[row] = if pivot == 0.0 { 0.0 } else { (right[row] - known) / pivot };
    }
    right
}

/// The least squares of a factor (R | q) with each unknown between its bounds, and the sum that is left. An unknown that would leave its
/// range is put on its end, and the others are solved again.
fn solve_bounded(factor: &DMatrix<f64>, bounds: &[(f64, f64)]) -> (Vec<f64>, f64) {
    let fields = bounds.len();
    let mut held: Vec<Option<f64>> = bounds.iter().map(|(low, high)| (low == high).then_some(*low)).collect();
    loop {
        let free: Vec<usize> = (0..fields).filter(|&field| held[field].is_none()).collect();
        let mut matrix = DMatrix::zeros(factor.nrows(), free.len() + 1);
        for row in 0..factor.nrows() {
            for (place, &field) in free.iter().enumerate() {
                matrix[(row, place)] = factor[(row, field)];
            }
            let of_held: f64 = (0..fields).filter_map(|field| Some(factor[(row, field)] * held[field]?)).sum();
            matrix[(row, free.len())] = factor[(row, fields)] + of_held;
        }
        let solved = triangular(matrix);
        let right = (0..free.len()).map(|row| -solved[(row, free.len())]).collect();
        let moved = back_substitute(&solved, right);
        let outside = free.iter().zip(&moved).find(|(field, moved)| {
            let (low, high) = bounds[**field];
            !(low..=high).contains(*moved)
        });
        if let Some((&field, &moved)) = outside {
            let (low, high) = bounds[field];
            held[field] = Some(if moved > high { high } else { low });
            continue;
        }
        let mut step: Vec<f64> = held.iter().map(|held| held.unwrap_or(0.0)).collect();
        for (&field, &moved) in free.iter().zip(&moved) {
            step[field] = moved;
        }
        let left = solved[(free.len(), free.len())];
        return (step, left * left);
    }
}

/// Leverage of each row of each block: the share of it that the unknowns take. `reduced` and `factors` are those of [`reduced`].
pub(super) fn leverages(blocks: &[Block], reduced: &DMatrix<f64>, factors: &[DMatrix<f64>]) -> Vec<Vec<f64>> {
    let fields = reduced.ncols() - 1;
    let of_block = |(block, factor): (&Block, &DMatrix<f64>)| {
        (0..block.rows.nrows())
            .map(|row| {
                // a R⁻¹, by forward substitution through the columns.
                let forward = |factor: &DMatrix<f64>, values: &mut Vec<f64>| {
                    for column in 0..values.len() {
                        let known: f64 = (0..column).map(|k| values[k] * factor[(k, column)]).sum();
                        let pivot = factor[(column, column)];
                        values[column] = if pivot.abs() < RIDGE { 0.0 } else { (values[column] - known) / pivot };
                    }
                };
                let mut own: Vec<f64> = (0..block.own).map(|column| block.rows[(row, column)]).collect();
                forward(factor, &mut own);
                let mut of_fields: Vec<f64> = (0..fields)
                    .map(|field| {
                        let taken: f64 = (0..block.own).map(|k| own[k] * factor[(k, block.own + field)]).sum();
                        block.rows[(row, block.own + field)] - taken
                    })
                    .collect();
                forward(reduced, &mut of_fields);
                own.iter().chain(&of_fields).map(|value| value * value).sum()
            })
            .collect()
    };
    blocks.iter().zip(factors).map(of_block).collect()
}
