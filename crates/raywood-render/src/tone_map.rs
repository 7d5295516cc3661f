//! Tone mapping: how light of any brightness becomes what a screen can show.

use std::fmt;

use raywood_scene::{Rgb, luminance};

/// A way to make linear light from 0 to 1 of linear light without limits, both with the primaries of sRGB.
#[derive(Clone, Copy)]
pub struct ToneMap {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub help: &'static str,
    apply: fn(Rgb) -> Rgb,
}

/// All ways; the first is the default.
pub static TONE_MAPS: [ToneMap; 6] = [
    ToneMap {
        name: "soft",
        help: "light up to 0.8 as it is, what is brighter compressed below white, hues kept",
        apply: soft_clip,
    },
    ToneMap { name: "none", help: "what is brighter than white cut off", apply: |color| color },
    ToneMap {
        name: "reinhard",
        help: "brightness compressed so that 4 becomes white (Reinhard et al. 2002)",
        apply: reinhard,
    },
    ToneMap {
        name: "aces",
        help: "the look of film by the Academy's ACES, in Hill's fit: more contrast",
        apply: aces,
    },
    ToneMap {
        name: "agx",
        help: "Sobotka's AgX, base look: colours of bright light fade as on film",
        apply: agx,
    },
    ToneMap {
        name: "neutral",
        help: "Khronos PBR Neutral: colours of materials as they are, highlights compressed",
        apply: neutral,
    },
];

impl ToneMap {
    /// The way of this name.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        TONE_MAPS.iter().find(|tone_map| tone_map.name == name)
    }

    /// The colour that is shown: each channel from 0 to 1. Negative light and NaN become black.
    pub fn apply(&self, color: Rgb) -> Rgb {
        // The comparison takes NaN to zero; half of the largest number has room for sums.
        let sound = |x: f32| if x > 0.0 { x.min(0.5 * f32::MAX) } else { 0.0 };
        let shown = (self.apply)(Rgb::from(color.to_array().map(sound)));
        Rgb::from(shown.to_array().map(|x| x.clamp(0.0, 1.0)))
    }
}

impl fmt::Debug for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ToneMap").field("name", &self.name).finish_non_exhaustive()
    }
}

impl PartialEq for ToneMap {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Linear light up to this stays as it is; brighter light is compressed into what is left below white.
const SHOULDER: f32 = 0.8;

/// Compresses light brighter than a picture can show, keeping its hue.
///
/// With `m` the largest channel: up to 0.8 nothing changes. Above, `m` becomes `0.8 + 0.2 (1 - exp((0.8 - m) / 0.2))`,
/// which goes on with the same slope and nears 1, and the other channels shrink in proportion.
pub fn soft_clip(color: Rgb) -> Rgb {
    let m = color.max_element();
    if m <= SHOULDER {
        return color;
    }
    if m == f32::INFINITY {
        return Rgb::from(color.to_array().map(|x| if x == m { 1.0 } else { 0.0 }));
    }
    let room = 1.0 - SHOULDER;
    let compressed = SHOULDER + room * (1.0 - ((SHOULDER - m) / room).exp());
    (compressed / m) * color
}

/// Reinhard et al., "Photographic Tone Reproduction for Digital Images", 2002, equation 4, on luminance.
fn reinhard(color: Rgb) -> Rgb {
    /// The luminance that becomes white.
    const WHITE: f32 = 4.0;
    let light = luminance(color);
    (1.0 + light / (WHITE * WHITE)) / (1.0 + light) * color
}

/// The reference and output transforms of ACES as fitted by Stephen Hill (in "BakingLab" by Neubelt and Pettineo): to a wider gamut, through a curve, and back.
fn aces(color: Rgb) -> Rgb {
    const INTO: [[f32; 3]; 3] =
        [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
    const BACK: [[f32; 3]; 3] = [
        [1.60475, -0.53108, -0.07367],
        [-0.10208, 1.10813, -0.00605],
        [-0.00327, -0.07276, 1.07602],
    ];
    let curve = |x: f32| {
        // Divided by x where squares would overflow.
        if x > 1e6 {
            return 1.0 / 0.983_729;
        }
        (x * (x + 0.024_578_6) - 0.000_090_537) / (x * (0.983_729 * x + 0.432_951) + 0.238_081)
    };
    transformed(&BACK, Rgb::from(transformed(&INTO, color).to_array().map(curve)))
}

/// Troy Sobotka, "AgX", 2022: colours moved together, logarithms from 10 stops below middle grey to 6.5 above, a sigmoid, and the
/// move taken back. The matrices are those of Benjamin Wrensch, "Minimal AgX Implementation", 2023, the sigmoid is Sobotka's own.
fn agx(color: Rgb) -> Rgb {
    const INSET: [[f32; 3]; 3] = [
        [0.842_479_06, 0.078_433_6, 0.079_223_745],
        [0.042_328_242, 0.878_468_64, 0.079_166_13],
        [0.042_375_655, 0.078_433_6, 0.879_143],
    ];
    const OUTSET: [[f32; 3]; 3] = [
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_85, 1.151_903_1, -0.098_961_18],
        [-0.052_971_635, -0.098_043_45, 1.151_073_7],
    ];
    const MIDDLE_GREY: f32 = 0.18;
    const STOPS_BELOW: f32 = 10.0;
    const STOPS: f32 = 16.5;
    let curve = |x: f32| {
        let stops = (x / MIDDLE_GREY).log2() + STOPS_BELOW;
        agx_sigmoid((stops / STOPS).clamp(0.0, 1.0))
    };
    let curved = Rgb::from(transformed(&INSET, color).to_array().map(curve));
    // The sigmoid's values are meant for a screen of gamma 2.2.
    Rgb::from(transformed(&OUTSET, curved).to_array().map(|x| x.max(0.0).powf(2.2)))
}

/// From (0, 0) to (1, 1), with a slope of 2 where middle grey becomes one half; it bends by the power 3 below and 3.25 above.
fn agx_sigmoid(x: f32) -> f32 {
    const PIVOT: f32 = 10.0 / 16.5;
    let (away, reach, power) =
        if x < PIVOT { (x - PIVOT, PIVOT, 3.0) } else { (x - PIVOT, 1.0 - PIVOT, 3.25) };
    // So that the end of the reach comes out one half away from the middle.
    let bend = ((4.0 * reach).powf(power) - 1.0) / reach.powf(power);
    0.5 + 2.0 * away / (1.0 + bend * away.abs().powf(power)).powf(1.0 / power)
}

/// The Khronos Group, "PBR Neutral Tone Mapper", 2024: what reflects of dark things taken off, then only what nears white is compressed, and fades.
fn neutral(color: Rgb) -> Rgb {
    const FRESNEL: f32 = 0.04;
    const START: f32 = 0.8 - FRESNEL;
    const DESATURATION: f32 = 0.15;
    let [r, g, b] = color.to_array();
    let least = r.min(g).min(b);
    let offset = if least < 2.0 * FRESNEL { least - 6.25 * least * least } else { FRESNEL };
    let color = color - Rgb::splat(offset);
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let faded = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (1.0 - faded) * (new_peak / peak * color) + Rgb::splat(faded * new_peak)
}

/// The product of a matrix, row by row, and a colour.
fn transformed(rows: &[[f32; 3]; 3], color: Rgb) -> Rgb {
    Rgb::from(rows.map(|row| Rgb::from(row).dot(color)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(name: &str, light: f32) -> f32 {
        let shown = ToneMap::by_name(name).expect("a tone map").apply(Rgb::splat(light));
        let [r, g, b] = shown.to_array();
        assert!((r - g).abs() < 2e-3 && (g - b).abs() < 2e-3, "{name}: grey becomes {shown:?}");
        g
    }

    /// Points of the curves as their papers and references give them.
    #[test]
    fn curves_pass_through_their_known_points() {
        let near = |name: &str, light: f32, expected: f32| {
            let shown = grey(name, light);
            assert!((shown - expected).abs() < 1e-3, "{name}: {light} becomes {shown}");
        };
        near("none", 0.5, 0.5);
        near("none", 3.0, 1.0);
        near("soft", 0.5, 0.5);
        // L (1 + L / 16) / (1 + L).
        near("reinhard", 1.0, 1.0625 / 2.0);
        near("reinhard", 4.0, 1.0);
        // Hill's rational fit at 1: (1.0245786 - 0.000090537) / (0.983729 + 0.4329510 + 0.238081).
        near("aces", 1.0, 0.6191);
        near("aces", 0.18, 0.1055);
        // Middle grey becomes one half on a screen of gamma 2.2, 6.5 stops more are white, 10 less black.
        near("agx", 0.18, 0.5f32.powf(2.2));
        near("agx", 0.18 * 6.5f32.exp2(), 1.0);
        near("agx", 0.18 * (-10.0f32).exp2(), 0.0);
        // Below 0.08 a square root, then less by 0.04; the peak 1 - 0.24^2 / (1.96 + 0.24 - 0.76).
        near("neutral", 0.04, 6.25 * 0.04 * 0.04);
        near("neutral", 0.5, 0.46);
        near("neutral", 2.0, 1.0 - 0.0576 / 1.44);
    }

    #[test]
    fn more_light_is_never_darker_and_nothing_leaves_the_range() {
        for map in &TONE_MAPS {
            let mut last = 0.0;
            for step in 0..400 {
                let light = (0.1 * (step as f32 - 200.0)).exp2();
                let shown = grey(map.name, light);
                assert!(shown >= last - 1e-6, "{}: {light} is darker", map.name);
                last = shown;
            }
            for bad in [f32::NAN, f32::INFINITY, -1.0, f32::MAX, f32::MIN_POSITIVE] {
                for color in [Rgb::splat(bad), Rgb::new(bad, 0.5, 0.0), Rgb::new(0.0, 0.1, bad)] {
                    let shown = map.apply(color).to_array();
                    let is_sound = shown.iter().all(|x| (0.0..=1.0).contains(x));
                    assert!(is_sound, "{}: {color:?} becomes {shown:?}", map.name);
                }
            }
        }
    }

    /// The sigmoid against the polynomial of sixth order that Wrensch fitted to it, whose mean square error he gives as 3.7e-6.
    #[test]
    fn the_sigmoid_of_agx_is_what_others_fitted() {
        for step in 0..=100 {
            let x = 0.01 * step as f32;
            let fitted = ((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x * x
                + 0.1191 * x
                - 0.002_32;
            assert!((agx_sigmoid(x) - fitted).abs() < 8e-3, "at {x}: {} {fitted}", agx_sigmoid(x));
        }
    }
}
