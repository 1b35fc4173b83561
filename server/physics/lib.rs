//! The bounce of a planar rigid body on a tilting table: return map, contact times, Jacobians, stability and control.
//!
//! It starts from Zumel and Erdmann, "Balancing of a Planar Bouncing Object"; "eq. (n)" in these pages is an equation of that
//! paper. Not here: requests, JSON, clocks and threads; those live in the server.
//!
//! From the ground up: [`numbers`] are kinds of arithmetic; [`map`] is one bounce of any body; [`run`] goes from contact to contact and ends;
//! [`scene`] is the set of values a user may give, with the body that they make. On these stand [`analysis`], [`control`], [`catching`],
//! [`fitting`] and [`surveys`].

/// Gives the alternatives of an enum their names in requests and answers.
macro_rules! names {
    ($type:ident: $($alternative:ident => $name:literal),+) => {
        impl $type {
            /// All of them, in their order.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$alternative),+];

            /// Name in requests and answers.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$alternative => $name),+
                }
            }
        }
    };
}

pub mod analysis;
pub mod catching;
pub mod control;
pub mod fitting;
pub mod map;
pub mod numbers;
pub mod run;
pub mod scene;
pub mod surveys;
