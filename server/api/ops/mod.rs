//! Resources for operators: health, metrics, the contract and the page.

pub mod contract;
pub mod health;
pub mod metrics;
pub mod page;
