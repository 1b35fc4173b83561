//! Stability of a scene: the fixed point and its linear verdict, derivatives and normal forms of the map, how regular a run is, how
//! far aside it may start, and the verdict from all of them.

pub mod basin;
pub mod boundary;
pub mod contact_regime;
pub mod fixed_point;
pub mod jacobian;
pub mod linear_verdict;
pub mod loss_of_stability;
pub mod lyapunov;
pub mod margins;
pub mod nonlinear_run;
pub mod normal_form;
pub mod regularity;
mod settled_run;
pub mod verdict;
