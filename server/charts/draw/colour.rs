//! Colours: those of Okabe and Ito (2008), which people with any colour vision tell apart, the greys of the paper, and cividis for heat maps.

/// The paper of pictures, independent of the page around them.
pub(crate) const PAPER: &str = "#ffffff";
/// Edge of the paper.
pub(crate) const EDGE: &str = "#d5d8dc";
/// Most important text and marks; contrast 16:1 on paper.
pub(crate) const INK: &str = "#1b1f24";
/// Secondary text; contrast 7:1 on paper.
pub(crate) const SOFT_INK: &str = "#4d5560";
/// Frames and ticks of axes.
pub(crate) const AXIS: &str = "#6b7480";
/// Lines through zero.
pub(crate) const ZERO: &str = "#b9bfc7";
/// Lines at ticks.
pub(crate) const GRID: &str = "#eceef1";

pub(crate) const BLUE: &str = "#0072b2";
pub(crate) const GREEN: &str = "#009e73";
pub(crate) const ORANGE: &str = "#e69f00";
pub(crate) const SKY: &str = "#56b4e9";
pub(crate) const PURPLE: &str = "#cc79a7";
pub(crate) const VERMILION: &str = "#d55e00";
/// Light blue that every mark is visible on.
pub(crate) const PALE_BLUE: &str = "#e3f0f8";
/// Green for an area, and a lighter green behind it.
pub(crate) const LIGHT_GREEN: &str = "#9fd8c4";
pub(crate) const PALE_GREEN: &str = "#dff2eb";

/// Ground of the hatching for cells without a value.
pub(crate) const PALE_GREY: &str = "#eff0f2";
/// Hatching.
pub(crate) const HATCH: &str = "#8f97a1";

// cividis: the colours of a heat map. Equal steps of the value look equal with normal and with deficient colour vision, and lightness
// rises throughout, so that a grey print is readable.
//
// J. R. Nuñez, C. R. Anderton, R. S. Renslow: Optimizing colormaps with consideration for color vision deficiency to
// enable accurate interpretation of scientific data. PLoS ONE 13 (2018) e0199239. The table is that of matplotlib,
// rounded to eight bits a channel.

/// Number of colours.
pub(crate) const COLOURS: usize = 256;

/// All colours from the darkest on, six hexadecimal digits each.
const TABLE: &str = "\
    00224e00234f00245100255300255400265600275800285900285b00295d002a5f002a61002b62002c64002c66002d68\
    002e6a002e6c002f6d00306f0030700031700031710132710533710833700c34700f357012357014367016377018376f\
    1a386f1c396f1e3a6f203a6f213b6e233c6e243c6e263d6e273e6e293f6e2a3f6d2b406d2d416d2e416d2f426d31436d\
    32436d33446d34456c35456c36466c38476c39486c3a486c3b496c3c4a6c3d4a6c3e4b6c3f4c6c404c6c414d6c424e6c\
    434e6c444f6c45506c46516c47516c48526c49536c4a536c4b546c4c556c4d556c4e566c4f576c50576c51586d52596d\
    535a6d545a6d555b6d555c6d565c6d575d6d585e6d595e6e5a5f6e5b606e5c616e5d616e5e626e5e636f5f636f60646f\
    61656f62656f636670646770656870656870666970676a71686a71696b716a6c716b6d726c6d726c6e726d6f726e6f73\
    6f70737071737172747272747273747374757474757575757676767777767777777878777979777a7a787b7a787c7b78\
    7d7c787e7c787e7d787f7e78807f78817f788280798381798482798582798683798784788885788985788a86788b8778\
    8c88788d88788e89788f8a78908b78918b78928c78928d78938e78948e77958f779690779791779892779992779a9376\
    9b94769c95769d95769e96769f9775a09875a19975a29975a39a74a49b74a59c74a69c74a79d73a89e73a99f73aaa073\
    aba072aca172ada272aea371afa471b0a571b1a570b3a670b4a76fb5a86fb6a96fb7a96eb8aa6eb9ab6dbaac6dbbad6d\
    bcae6cbdae6cbeaf6bbfb06bc0b16ac1b26ac2b369c3b369c4b468c5b568c6b667c7b767c8b866c9b965cbb965ccba64\
    cdbb63cebc63cfbd62d0be62d1bf61d2c060d3c05fd4c15fd5c25ed6c35dd7c45cd9c55cdac65bdbc75adcc859ddc858\
    dec958dfca57e0cb56e1cc55e2cd54e4ce53e5cf52e6d051e7d150e8d24fe9d34eead34cebd44bedd54aeed649efd748\
    f0d846f1d945f2da44f3db42f5dc41f6dd3ff7de3ef8df3cf9e03afbe138fce236fde334fee434fee535fee636fee838";

/// A colour; 0 is the darkest. Indices beyond the last colour give the last one.
pub(crate) fn colour(index: usize) -> String {
    let at = 6 * index.min(COLOURS - 1);
    format!("#{}", &TABLE[at..at + 6])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance by the sRGB standard.
    fn luminance(index: usize) -> f64 {
        let digits = u32::from_str_radix(&colour(index)[1..], 16).expect("six digits");
        [(16, 0.2126), (8, 0.7152), (0, 0.0722)]
            .map(|(shift, weight)| {
                let share = f64::from(digits >> shift & 0xff) / 255.0;
                weight * if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
            })
            .iter()
            .sum()
    }

    #[test]
    fn the_table_is_whole_and_grows_lighter_but_for_rounding() {
        assert_eq!(TABLE.len(), 6 * COLOURS);
        assert_eq!((colour(0).as_str(), colour(255).as_str(), colour(999)), ("#00224e", "#fee838", colour(255)));
        for index in 1..COLOURS {
            // Two steps fall by less than this, as an effect of rounding to eight bits.
            assert!(luminance(index) > luminance(index - 1) - 4e-5, "{index}");
        }
    }
}
