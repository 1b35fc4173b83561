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

/// Gives a struct of numbers the same in other numbers, part by part in this order.
macro_rules! mapped {
    ($type:ident: $($number:ident),* $(; pairs $($pair:ident),+)? $(; parts $($part:ident),+)? $(; maybe $($maybe:ident),+)?
        $(; optional $($optional:ident),+)? $(; same $($same:ident),+)?) => {
        impl<N: Copy> $type<N> {
            /// The same in other numbers.
            #[inline(always)]
            pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> $type<M> {
                $type {
                    $($number: function(self.$number),)*
                    $($($pair: (function(self.$pair.0), function(self.$pair.1)),)+)?
                    $($($part: self.$part.map(&function),)+)?
                    $($($maybe: self.$maybe.map(|part| part.map(&function)),)+)?
                    $($($optional: self.$optional.map(&function),)+)?
                    $($($same: self.$same,)+)?
                }
            }
        }
    };
}

/// Lets a struct go through its numbers with those of another.
macro_rules! zipped {
    ($type:ident: $($number:ident),+) => {
        impl<N> $type<N> {
            #[inline(always)]
            pub(crate) fn zip<M: Copy>(&mut self, other: &$type<M>, visit: &mut impl FnMut(&mut N, M)) {
                $(visit(&mut self.$number, other.$number);)+
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
