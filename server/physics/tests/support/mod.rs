//! Random scenes, independent simulations and reference runs that several modules share.

pub(crate) mod budgets;
pub(crate) mod decimals;
pub(crate) mod evidence;
pub(crate) mod features;
pub(crate) mod lone_runs;
pub(crate) mod mixes;
pub(crate) mod random;
pub(crate) mod reference;
pub(crate) mod rig;
pub(crate) mod rig_runs;
pub(crate) mod scenes;
pub(crate) mod simple;
pub(crate) mod turning;
pub(crate) mod upright;
