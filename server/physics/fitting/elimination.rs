//! Elimination of the windows' own unknowns from the linearized problem, window by window, so that time is linear in their number.
//!
//! A window has rows (J_u | J_p | r). Their QR factor R is triangular: its upper rows give the step of the window's unknowns u from that of the
//! fields p, its lower ones are all that the window says about p. This is the Schur complement of the arrow-shaped normal
//! equations without squaring them (Golub and Pereyra 1973).

use nalgebra::{DMatrix, DVector};

/// The linearized rows of a window, before and after their QR.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Unknowns of the window, in number.
    pub(super) own: usize,
    /// Rows (J_u | J_p | r), each over its standard deviation.
    pub(super) rows: DMatrix<f64>,
    /// Their factor, square and upper triangular.
    factor: DMatrix<f64>,
    norms: Vec<f64>,
}

/// Weight of the wish that unknowns of a window do not move, in place of data that say nothing about them.
const RIDGE: f64 = 1e-6;

#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) own: Vec<DVector<f64>>,
    pub(super) fields: DVector<f64>,
    /// Sum of squares that is left after it, to first order.
    pub(super) left: f64,
}

/// R⁻¹q for the first unknowns of a factor; 0 where it does not determine them.
fn solved(factor: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let count = right.len();
    let square = factor.view((0, 0), (count, count));
    square.solve_upper_triangular(right).unwrap_or_else(|| DVector::zeros(count))
}

impl Block {
    pub(super) fn new(own: usize, rows: DMatrix<f64>) -> Self {
        let (count, width) = rows.shape();
        let norms = rows.column_iter().map(|column| column.norm()).collect();
        let padded = rows.clone().resize_vertically(count.max(width), 0.0);
        Self { own, factor: padded.qr().r(), rows, norms }
    }

    /// The factor of the rows and of a wish that the window's unknowns stay, each with a weight times its column's norm.
    fn damped(&self, weight: f64) -> DMatrix<f64> {
        let width = self.factor.ncols();
        let mut matrix = self.factor.clone().resize_vertically(width + self.own, 0.0);
        for own in 0..self.own {
            let norm = if self.norms[own] > 0.0 { self.norms[own] } else { 1.0 };
            matrix[(width + own, own)] = (weight * norm).max(RIDGE);
        }
        matrix.qr().r()
    }
}

/// All that windows say about the fields: the factor of (J_p | r) with their own unknowns eliminated, and the factors of the windows. A field
/// moves little by itself where its column is below `ridges`.
pub(super) fn reduce(blocks: &[Block], ridges: &[f64], damping: f64) -> (DMatrix<f64>, Vec<DMatrix<f64>>) {
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
    (stacked.qr().r(), factors)
}

/// The step of Levenberg and Marquardt with fields kept between bounds.
pub(super) fn step(blocks: &[Block], bounds: &[(f64, f64)], ridges: &[f64], damping: f64) -> Step {
    let (factor, factors) = reduce(blocks, ridges, damping);
    let (fields, left) = solve_bounded(&factor, bounds);
    let own = blocks.iter().zip(&factors).map(|(block, factor)| {
        let rows = factor.rows(0, block.own);
        let right = rows.column(block.own + fields.len()) + rows.columns(block.own, fields.len()) * &fields;
        -solved(factor, &right)
    });
    Step { own: own.collect(), left, fields }
}

/// The least squares of a factor (R | q) with each unknown between its bounds, and the sum that is left. An unknown that would leave its
/// range is put on its end, and the others are solved again.
fn solve_bounded(factor: &DMatrix<f64>, bounds: &[(f64, f64)]) -> (DVector<f64>, f64) {
    let fields = bounds.len();
    let mut held: Vec<Option<f64>> = bounds.iter().map(|(low, high)| (low == high).then_some(*low)).collect();
    loop {
        let free: Vec<usize> = (0..fields).filter(|&field| held[field].is_none()).collect();
        let mut step = DVector::from_iterator(fields, held.iter().map(|held| held.unwrap_or(0.0)));
        let right = factor.column(fields) + factor.columns(0, fields) * &step;
        let mut matrix = factor.select_columns(&free).insert_column(free.len(), 0.0);
        matrix.set_column(free.len(), &right);
        let less = matrix.qr().r();
        let moved = -solved(&less, &less.column(free.len()).rows(0, free.len()).into_owned());
        for (&field, &moved) in free.iter().zip(&moved) {
            step[field] = moved;
        }
        let outside = free.iter().find(|&&field| !(bounds[field].0..=bounds[field].1).contains(&step[field]));
        let Some(&field) = outside else {
            let left = less[(free.len(), free.len())];
            return (step, left * left);
        };
        held[field] = Some(if step[field] > bounds[field].1 { bounds[field].1 } else { bounds[field].0 });
    }
}

/// Leverage of each row of the blocks, one after another: the share of it that the unknowns take.
pub(super) fn leverages(blocks: &[Block], ridges: &[f64]) -> Vec<f64> {
    let (reduced, factors) = reduce(blocks, ridges, 0.0);
    // R⁻ᵀ of some rows, each in a column.
    let divided = |factor: &DMatrix<f64>, rows: DMatrix<f64>| {
        let square = factor.view((0, 0), (rows.nrows(), rows.nrows()));
        square.tr_solve_upper_triangular(&rows).unwrap_or_else(|| rows.map(|_| 0.0))
    };
    let of_block = |(block, factor): (&Block, &DMatrix<f64>)| {
        let own = divided(factor, block.rows.columns(0, block.own).transpose());
        let taken = factor.view((0, block.own), (block.own, ridges.len())).tr_mul(&own);
        let fields = divided(&reduced, block.rows.columns(block.own, ridges.len()).transpose() - taken);
        let taken = own.column_iter().zip(fields.column_iter());
        Vec::from_iter(taken.map(|(own, fields)| own.norm_squared() + fields.norm_squared()))
    };
    blocks.iter().zip(&factors).flat_map(of_block).collect()
}
