//! Analyses of the return map: the bounce that repeats, multipliers, normal forms, limits, periodic orbits, chaos, basins, and the verdict.

pub mod basin;
pub mod boundary;
pub mod contact_regime;
pub mod evidence;
pub mod fixed_point;
pub mod gain_range;
pub mod jacobian;
pub mod limits;
pub mod linear_solution;
pub mod linear_verdict;
pub mod losses;
pub mod margins;
pub mod method;
pub mod model_hierarchy;
pub mod nonlinear_run;
pub mod normal_form;
pub mod periodic_orbits;
pub mod regularity;
pub mod repeating;
pub mod return_map;
pub(crate) mod root;
pub mod small_deviations;
pub mod swing;
pub mod verdict;
