//! Random scenes, independent simulations and reference runs that several modules share.

pub(crate) mod budgets;
pub(crate) mod decimals;
pub(crate) mod features;
pub(crate) mod random;
pub(crate) mod reference;
pub(crate) mod rig;
pub(crate) mod scenes;
pub(crate) mod simple;
pub(crate) mod turning;
