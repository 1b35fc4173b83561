//! The words by which a scene names one of several alternatives.
//!
//! Each list is a match without a wildcard: the compiler asks for the word of a new alternative.

use crate::map::friction::{RestitutionLaw, Slide};
use crate::map::strike::{EnergyLaw, EnergyMeasure};
use crate::map::table::noise::NoiseModel;
use crate::map::table::pivot::TiltRate;
use crate::map::table::sensing::Prediction;
use crate::scene::Striking;

/// An alternative that a scene names by a word.
pub(super) trait Alternative: Copy + 'static {
    /// The first of them.
    const FIRST: Self;

    /// The alternative of this word.
    fn from_word(word: &str) -> Option<Self>;
}

macro_rules! words {
    ($type:ident: $first:ident => $first_word:literal $(, $other:ident => $other_word:literal)*) => {
        impl $type {
            /// Words of all alternatives.
            pub const WORDS: &'static [&'static str] = &[$first_word $(, $other_word)*];

            /// Word of this alternative.
            pub const fn word(self) -> &'static str {
                match self {
                    Self::$first => $first_word,
                    $(Self::$other => $other_word,)*
                }
            }
        }

        impl Alternative for $type {
            const FIRST: Self = Self::$first;

            fn from_word(word: &str) -> Option<Self> {
                [Self::$first $(, Self::$other)*].into_iter().find(|alternative| alternative.word() == word)
            }
        }
    };
}

words!(RestitutionLaw: Poisson => "poisson", Newton => "newton", Stronge => "stronge");
words!(Striking: Compensated => "compensated", Still => "still");
words!(Slide: None => "none", Matched => "matched");
words!(EnergyMeasure: Vertical => "vertical", Total => "total");
words!(EnergyLaw: Proportional => "proportional", OneStrike => "one_strike");
words!(TiltRate: None => "none", Follows => "follows", Corrected => "corrected");
words!(Prediction: None => "none", Flight => "flight");
words!(NoiseModel: Strike => "strike", Plan => "plan");
