//! Analyses of the return map: the bounce that repeats, multipliers, normal forms, limits, periodic orbits, chaos, basins, and the verdict.

pub mod angle_feedback;
pub mod basin;
pub mod boundary;
pub mod contact_regime;
pub mod delayed_height;
pub mod evidence;
pub mod fixed_point;
pub mod jacobian;
pub mod linear_solution;
pub mod linear_verdict;
pub mod loss_of_stability;
pub mod margins;
pub mod method;
pub mod model_hierarchy;
pub mod nonlinear_run;
pub mod normal_form;
pub mod periodic_orbits;
pub mod regularity;
pub mod repeating;
pub mod return_map;
mod settled_run;
pub mod steady_drift;
pub mod swing;
pub mod upright_in_air;
pub mod verdict;
