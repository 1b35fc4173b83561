//! The bounce of a planar rigid body on a tilting table: map, contact times, Jacobians and stability.
//!
//! Not here: requests, JSON, clocks and threads; those live in the server.
