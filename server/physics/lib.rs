//! The bounce of a planar rigid body on a tilting table: return map, contact times, Jacobians, stability and control.
//!
//! It starts from Zumel and Erdmann, "Balancing of a Planar Bouncing Object"; "eq. (n)" in these pages is an equation of that
//! paper. Not here: requests, JSON, clocks and threads; those live in the server.
//!
//! ```
//! use equipoise_physics::{Scene, stability};
//!
//! // Lengths in m, angles in rad; every field is in [`scene::FIELDS`].
//! let text = "body.contact_distance=0.3 body.radius_of_gyration=0.3 table.tilt_gain=1.1 release.height=1 release.theta=0.1";
//! let scene: Scene = text.parse().expect("every field is within its limits");
//!
//! let judged = stability(&scene);
//! assert_eq!(judged.verdict.name(), "elliptic");
//!
//! let orbit = scene.orbit().expect("the body comes down");
//! let largest = orbit.into_contacts().take(1000).map(|contact| contact.state.theta.abs()).fold(0.0, f64::max);
//! assert!(largest < 0.3, "{largest} rad");
//! ```
//!
//! From the ground up: [`numbers`] are kinds of arithmetic; [`map`] is one bounce of any body; [`run`] goes from contact to contact and ends;
//! [`scene`] is the set of values a user may give, with the body that they make. On these stand [`analysis`], [`control`], [`catching`],
//! [`fitting`] and [`surveys`].

/// An enum whose alternatives have names in requests and answers.
pub(crate) trait Named: Copy {
    /// The first alternative.
    const FIRST: Self;

    /// The alternative of this name.
    fn named(name: &str) -> Option<Self>;
}

/// Gives the alternatives of an enum their names in requests and answers.
macro_rules! names {
    ($type:ident: $first:ident => $first_name:literal $(, $other:ident => $other_name:literal)*) => {
        impl $type {
            /// Names of all alternatives, in their order.
            pub const NAMES: &'static [&'static str] = &[$first_name $(, $other_name)*];

            /// All alternatives, in their order.
            pub const ALL: [Self; Self::NAMES.len()] = [Self::$first $(, Self::$other)*];

            /// Name in requests and answers.
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_name,
                    $(Self::$other => $other_name,)*
                }
            }
        }

        impl crate::Named for $type {
            const FIRST: Self = Self::$first;

            fn named(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|alternative| alternative.name() == name)
            }
        }
    };
}

/// Gives a struct of numbers the same in other numbers, part by part in this order, and a way through its numbers beside those of another: an
/// optional part only where both have it. A vanishing part is none where all its numbers are 0.
macro_rules! mapped {
    ($type:ident: $($number:ident),* $(; pairs $($pair:ident),+)? $(; parts $($part:ident),+)? $(; maybe $($maybe:ident),+)?
        $(; optional $($optional:ident),+)? $(; vanishing $vanishing:ident)? $(; same $($same:ident),+)?) => {
        #[allow(dead_code, unreachable_pub, reason = "not every struct needs both, nor for others")]
        impl<N: Copy> $type<N> {
            /// The same in other numbers.
            #[inline(always)]
            pub fn map<M: crate::numbers::number::Arithmetic>(&self, function: impl Fn(N) -> M) -> $type<M> {
                $type {
                    $($number: function(self.$number),)*
                    $($($pair: (function(self.$pair.0), function(self.$pair.1)),)+)?
                    $($($part: self.$part.map(&function),)+)?
                    $($($maybe: self.$maybe.map(|part| part.map(&function)),)+)?
                    $($($optional: self.$optional.map(&function),)+)?
                    $($vanishing: self.$vanishing.and_then(|part| part.map(&function).unless_zero()),)?
                    $($($same: self.$same,)+)?
                }
            }

            #[inline(always)]
            pub(crate) fn zip<M: Copy>(&mut self, other: &$type<M>, visit: &mut impl FnMut(&mut N, M)) {
                $(visit(&mut self.$number, other.$number);)*
                $($(visit(&mut self.$pair.0, other.$pair.0); visit(&mut self.$pair.1, other.$pair.1);)+)?
                $($(self.$part.zip(&other.$part, visit);)+)?
                $($(if let (Some(part), Some(other)) = (&mut self.$maybe, &other.$maybe) {
                    part.zip(other, visit);
                })+)?
                $($(if let (Some(number), Some(other)) = (&mut self.$optional, other.$optional) {
                    visit(number, other);
                })+)?
                $(if let (Some(part), Some(other)) = (&mut self.$vanishing, &other.$vanishing) {
                    part.zip(other, visit);
                })?
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

pub use analysis::evidence::stability;
pub use scene::Scene;
