//! The verdicts, and the evidence that decides them. Not here: how it is decided ([`crate::analysis::evidence`]).

/// The verdict on a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A small deviation dies out.
    StableInPlace,
    /// A small deviation of the angle dies out, and the drift of the release stays.
    StableDrifting,
    /// The linear analysis says that the angle circles, and the run did for as long as it was watched; no theorem says more.
    Elliptic,
    /// The angle circles in first order, and the swing dies out in third.
    WeaklyAttracting,
    /// The angle circles in first order, and every swing grows in third.
    WeaklyUnstable,
    /// At or beyond an end of the linear verdict, yet bounded around what branches off there, for as long as it was watched.
    BoundedBeyondBoundary,
    /// With noise: the run survived, as others do with a probability.
    Random,
    /// The body falls, or would fall from a slightly different start.
    Unstable,
}

names!(
    Verdict: StableInPlace => "stable in place", StableDrifting => "stable, drifting", Elliptic => "elliptic",
        WeaklyAttracting => "weakly attracting", WeaklyUnstable => "weakly unstable",
        BoundedBeyondBoundary => "bounded beyond the boundary", Random => "random", Unstable => "unstable"
);

impl Verdict {
    /// True if small deviations stay small: they die out or circle, and no swing grows in third order.
    pub fn holds(self) -> bool {
        match self {
            Self::StableInPlace | Self::StableDrifting | Self::Elliptic | Self::WeaklyAttracting => true,
            Self::WeaklyUnstable | Self::BoundedBeyondBoundary | Self::Random | Self::Unstable => false,
        }
    }
}

/// Evidence that decided a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecidedBy {
    /// Eigenvalues, by residue.
    Linear,
    /// The run of the scene.
    Nonlinear,
    /// Loss of stability at an end of the linear verdict.
    Boundary,
    /// The first Lyapunov coefficient.
    Lyapunov,
    /// No bounce repeats.
    FixedPoint,
    /// An ensemble of runs with noise.
    Ensemble,
}

names!(
    DecidedBy: Linear => "linear", Nonlinear => "nonlinear", Boundary => "boundary", Lyapunov => "lyapunov",
        FixedPoint => "fixed_point", Ensemble => "ensemble"
);
