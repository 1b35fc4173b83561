//! State feedback α = −K·(x, θ, ẋ, θ̇) on the return map of any body: the linear model of one bounce, the closed loop of any gain,
//! the gain that is optimal for given weights (LQR), and the factors on a gain that keep the loop stable.
//!
//! The analysis is linear; runs show how far from upright a law holds ([`crate::surveys::stability_map`]). The energy is not fed back
//! here: to first order it moves independently of the angle.

pub mod bounce_model;
pub mod controller;
pub mod lqr;
pub mod riccati;
