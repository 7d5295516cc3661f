//! Colours that colour-blind readers can tell apart, on light and dark ground.
//!
//! Charts are drawn in the colours for light ground; on dark ground the page's style replaces each by its lighter sister. The hues follow
//! Okabe and Ito, "Color universal design" (2008), darkened or lightened until each stands out from its ground; marks of different
//! shapes and a dashed line tell series apart where colour does not.

use plotters::style::RGBColor;

/// A colour on light and on dark ground.
#[derive(Clone, Copy)]
pub(super) struct Shade {
    light: u32,
    dark: u32,
}

impl Shade {
    /// The colour that charts are drawn in.
    pub(super) fn drawn(self) -> RGBColor {
        let [_, red, green, blue] = self.light.to_be_bytes();
        RGBColor(red, green, blue)
    }

    /// The same for HTML.
    pub(super) fn html(self) -> String {
        format!("#{:06X}", self.light)
    }
}

/// The colours of series, in order; after the last comes the first again.
pub(super) const SERIES: [Shade; 10] = [
    Shade { light: 0x0067A5, dark: 0x56B4E9 },
    Shade { light: 0xC04A00, dark: 0xFF8A4C },
    Shade { light: 0x00805C, dark: 0x2FC79A },
    Shade { light: 0xA84C8C, dark: 0xE29AC8 },
    Shade { light: 0x9A6A00, dark: 0xF0B429 },
    Shade { light: 0x5B4FC4, dark: 0xA79CFF },
    Shade { light: 0x6B6B00, dark: 0xD9D660 },
    Shade { light: 0x7A3B3B, dark: 0xD79A9A },
    Shade { light: 0x2B7F8F, dark: 0x7CD3E0 },
    Shade { light: 0x4A4A4A, dark: 0xC4C4C4 },
];

/// Lines to compare with.
pub(super) const IDEAL: Shade = Shade { light: 0x767676, dark: 0x9A9A9A };
/// Text.
pub(super) const INK: Shade = Shade { light: 0x3C4043, dark: 0xC9CDD2 };
/// The axes.
pub(super) const AXIS: Shade = Shade { light: 0x9AA0A6, dark: 0x6B7178 };
/// The lines of the grid.
pub(super) const GRID: Shade = Shade { light: 0xE3E5E8, dark: 0x33373C };

/// Style rules that replace each drawn colour by its sister for dark ground.
pub(super) fn dark_rules() -> String {
    let shades = SERIES.iter().chain([&IDEAL, &INK, &AXIS, &GRID]);
    shades
        .map(|shade| {
            let (light, dark) = (shade.html(), shade.dark);
            format!("svg [stroke=\"{light}\"]{{stroke:#{dark:06X}}}svg [fill=\"{light}\"]{{fill:#{dark:06X}}}")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance by WCAG 2.
    fn luminance(color: u32) -> f64 {
        let [_, r, g, b] = color.to_be_bytes().map(|byte| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    fn contrast(a: u32, b: u32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_colour_stands_out_from_both_grounds() {
        for shade in SERIES.iter().chain([&IDEAL, &INK]) {
            assert!(contrast(shade.light, 0xFFFFFF) >= 4.0, "{:06X}", shade.light);
            assert!(contrast(shade.dark, 0x1B1E22) >= 4.0, "{:06X}", shade.dark);
        }
    }

    #[test]
    fn no_two_colours_are_drawn_alike() {
        let mut drawn: Vec<_> =
            SERIES.iter().chain([&IDEAL, &INK, &AXIS, &GRID]).map(|shade| shade.light).collect();
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn.len(), SERIES.len() + 4);
    }
}
