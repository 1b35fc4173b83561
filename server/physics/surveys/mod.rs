//! Surveys of many runs: stability maps over two fields, and ensembles with noise.

pub mod ensemble;
pub mod stability_map;
