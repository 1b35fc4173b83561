//! The path of the angle's eigenvalues over the tilt gain, in closed form, as polylines.

/// Points in each part of a trail.
const SAMPLES: usize = 64;

/// Smallest and largest distance that the residue is drawn beyond 0 and 1.
const BEYOND: f64 = 0.1;
const FARTHEST: f64 = 0.6;

/// The eigenvalues that are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// λ² − (2 − 4R)λ + 1 = 0: the pair of a rod, R Greene's residue.
    Pair,
    /// λ = 1 − 2R with R = κ: a point mass.
    Single,
}

impl Law {
    /// The eigenvalues (re, im) at a residue, the outer or upper one first. A single eigenvalue is returned twice.
    pub(crate) fn at(self, residue: f64) -> [(f64, f64); 2] {
        let half_trace = 1.0 - 2.0 * residue;
        if self == Self::Single {
            return [(half_trace, 0.0); 2];
        }
        let off_circle = residue * (residue - 1.0);
        if off_circle <= 0.0 {
            let imaginary = 2.0 * (-off_circle).sqrt();
            return [(half_trace, imaginary), (half_trace, -imaginary)];
        }
        let outer = half_trace + (2.0 * off_circle.sqrt()).copysign(half_trace);
        // Their product is 1, which keeps the digits that a difference would lose.
        [(outer, 0.0), (1.0 / outer, 0.0)]
    }
}

/// Residues and eigenvalues of one part of the path.
pub(crate) type Part = Vec<(f64, [(f64, f64); 2])>;

/// The path below the stable interval, in it and beyond it.
pub(crate) struct Trail {
    pub(crate) law: Law,
    pub(crate) below: Part,
    pub(crate) stable: Part,
    pub(crate) beyond: Part,
}

impl Trail {
    /// The path, long enough to show a scene at this residue, within bounds.
    pub(crate) fn around(law: Law, residue: f64) -> Self {
        let residue = if residue.is_nan() { 0.0 } else { residue };
        let low = (residue - 0.5 * BEYOND).clamp(-FARTHEST, -BEYOND);
        let high = (residue + 0.5 * BEYOND).clamp(1.0 + BEYOND, 1.0 + FARTHEST);
        // Steps shrink with their square towards 0 and 1, where the pair leaves the circle like a square root.
        let part = |residue: fn(f64, f64) -> f64, end: f64| {
            let sample = |n: usize| residue(n as f64 / SAMPLES as f64, end);
            (0..=SAMPLES).map(|n| (sample(n), law.at(sample(n)))).collect()
        };
        Self {
            law,
            below: part(|u, end| end * (1.0 - u) * (1.0 - u), low),
            stable: part(|u, _| u * u * (3.0 - 2.0 * u), 1.0),
            beyond: part(|u, end| 1.0 + (end - 1.0) * u * u, high),
        }
    }

    /// First and last residue.
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.below.first().map_or(0.0, |point| point.0), self.beyond.last().map_or(1.0, |point| point.0))
    }

    /// Smallest and largest real part.
    pub(crate) fn real_ends(&self) -> (f64, f64) {
        let parts = self.below.iter().chain(&self.stable).chain(&self.beyond);
        parts.fold((0.0, 0.0), |(low, high), (_, [(re, _), _])| (low.min(*re), high.max(*re)))
    }

    /// Largest |λ|.
    pub(crate) fn reach(&self) -> f64 {
        let parts = self.below.iter().chain(&self.stable).chain(&self.beyond);
        parts.map(|(_, [first, _])| modulus(*first)).fold(1.0, f64::max)
    }
}

/// |λ|.
pub(crate) fn modulus((re, im): (f64, f64)) -> f64 {
    (re * re + im * im).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pair_solves_its_equation() {
        for residue in [-3.0, -0.1, -1e-12, 0.0, 0.2, 0.75, 1.0, 1.0 + 1e-12, 1.1, 40.0] {
            for (re, im) in Law::Pair.at(residue) {
                let trace = 2.0 - 4.0 * residue;
                let real = re * re - im * im - trace * re + 1.0;
                let imaginary = 2.0 * re * im - trace * im;
                let scale = 1.0 + re * re;
                assert!(
                    real.abs() <= 1e-14 * scale && imaginary.abs() <= 1e-14 * scale,
                    "{residue}: {real} {imaginary}"
                );
            }
        }
    }

    #[test]
    fn the_trail_reaches_the_scene_within_bounds() {
        for (residue, low, high) in
            [(0.2, -0.1, 1.1), (1.3, -0.1, 1.35), (-40.0, -0.6, 1.1), (f64::INFINITY, -0.1, 1.6)]
        {
            let ends = Trail::around(Law::Pair, residue).ends();
            assert!((ends.0 - low).abs() < 1e-12 && (ends.1 - high).abs() < 1e-12, "{residue}: {ends:?}");
        }
    }
}
