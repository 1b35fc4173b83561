//! Searches between two values of a number at which something differs: halving, and the root of a function.

/// Most steps to a root.
const MOST_STEPS: usize = 60;

/// A value of a number at which something is as at the start of a search, and one farther on at which it is not, each with what was found there.
pub(super) struct Bracket<T> {
    pub(super) kept: (f64, T),
    pub(super) lost: (f64, T),
}

impl<T> Bracket<T> {
    /// Narrows the bracket by halving it. `at` tells what is found at a value near one that is kept, and whether it is kept.
    pub(super) fn halve<E>(
        &mut self,
        most: usize,
        mut at: impl FnMut(f64, &T) -> Result<(T, bool), E>,
    ) -> Result<(), E> {
        for _ in 0..most {
            let middle = 0.5 * (self.kept.0 + self.lost.0);
            if middle == self.kept.0 || middle == self.lost.0 {
                break;
            }
            let (found, is_kept) = at(middle, &self.kept.1)?;
            *(if is_kept { &mut self.kept } else { &mut self.lost }) = (middle, found);
        }
        Ok(())
    }
}

/// Root of a function between two arguments, given with its values of different signs there, and the last step to it (T. R. Chandrupatla 1997).
/// Values up to `rounding` count as 0. The search ends where the function has no value.
pub(crate) fn root<E>(
    [mut a, mut b]: [(f64, f64); 2],
    rounding: f64,
    mut function: impl FnMut(f64) -> Result<Option<f64>, E>,
) -> Result<(f64, f64), E> {
    let mut share = 0.5;
    let (mut value, mut step) = (a.0, f64::INFINITY);
    for _ in 0..MOST_STEPS {
        let argument = a.0 + share * (b.0 - a.0);
        let Some(found) = function(argument)? else { return Ok((argument, (argument - value).abs())) };
        let c = if (found < 0.0) == (a.1 < 0.0) { a } else { std::mem::replace(&mut b, a) };
        a = (argument, found);
        let secant = if a.1 == 0.0 { a.0 } else { a.0 - a.1 * (b.0 - a.0) / (b.1 - a.1) };
        (value, step) = (secant, (secant - value).abs());
        if a.1.abs() <= rounding {
            return Ok((value, 0.0));
        }
        let least = f64::EPSILON * a.0.abs() / (b.0 - a.0).abs();
        if least > 0.25 {
            break;
        }
        let (xi, phi) = ((a.0 - b.0) / (c.0 - b.0), (a.1 - b.1) / (c.1 - b.1));
        share = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            a.1 / (b.1 - a.1) * c.1 / (b.1 - c.1) + (c.0 - a.0) / (b.0 - a.0) * a.1 / (c.1 - a.1) * b.1 / (c.1 - b.1)
        } else {
            0.5
        };
        share = share.clamp(least, 1.0 - least);
    }
    Ok((value, step))
}
