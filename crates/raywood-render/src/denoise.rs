//! A filter against noise that is guided by features: Dammertz, Sewtz, Hanika and Lensch, "Edge-Avoiding A-Trous Wavelet Transform for Fast Global Illumination Filtering",
//! 2010, with weights by variance as the spatial part of Schied et al., "Spatiotemporal Variance-Guided Filtering", 2017.
//!
//! Light is averaged over neighbours that see the same surface, as far as they differ by no more than their noise. Colours of surfaces are divided out before and
//! multiplied in after, so that textures stay. What features do not tell (what mirrors and glass show, fine shadows among much noise) is blurred where it is no clearer than the noise.

use rayon::prelude::*;
use raywood_scene::{Rgb, luminance};

use crate::film::Film;
use crate::image::Image;
use crate::integrators::Features;

/// Passes, each with steps twice as wide as the last: in the end over some 60 pixels to each side.
const ROUNDS: u32 = 5;

/// By how many standard deviations neighbours may differ.
const DEVIATIONS: f32 = 4.0;

/// How sharply neighbours of another direction are left out: the power of the cosine.
const NORMAL_POWER: i32 = 64;

/// How far the albedo of neighbours may be away.
const ALBEDO_WIDTH: f32 = 0.2;

/// Darker colours of surfaces are not divided out further: what they show is mostly mirrored.
const LEAST_ALBEDO: f32 = 0.05;

/// Around a pixel whose variance is estimated, so many to each side are asked: passes are too few to know it from one alone.
const VARIANCE_RADIUS: i64 = 3;

/// The picture of a film with less noise, as light. Where there is no noise nothing changes. O(pixels), on the threads of the current rayon pool.
///
/// `None` if a pixel has less than two passes, as then nobody knows its noise, or if the features are not of as many pixels.
pub fn denoise(film: &Film, features: &Features) -> Option<Image> {
    let pixels = film.pixels();
    let has_all = [features.albedo.len(), features.normals.len(), features.depths.len()];
    if pixels.iter().any(|pixel| pixel.passes < 2) || has_all.iter().any(|&n| n != pixels.len()) {
        return None;
    }
    let grid = Grid { width: i64::from(film.width()), height: i64::from(film.height()) };
    let divisors: Vec<Rgb> = features
        .albedo
        .iter()
        .map(|albedo| Rgb::from(albedo.to_array().map(|x| x.max(LEAST_ALBEDO))))
        .collect();
    let guide = Guide::new(grid, features);

    // What surfaces gather, and its variance, known better by asking around.
    let scaled = |i: usize| pixels[i].variance() / luminance(divisors[i]).powi(2);
    let variances: Vec<f32> = (0..pixels.len()).map(scaled).collect();
    let mut light: Vec<Lit> = (0..pixels.len())
        .into_par_iter()
        .map(|i| {
            let [r, g, b] = pixels[i].mean().to_array();
            let divisor = divisors[i].to_array();
            let color = Rgb::new(r / divisor[0], g / divisor[1], b / divisor[2]);
            let (mut sum, mut weights) = (0.0, 0.0);
            grid.around(i, VARIANCE_RADIUS, 1, |j, _, _| {
                let weight = guide.weight(i, j, 1);
                sum += weight * variances[j];
                weights += weight;
            });
            Lit { color, variance: sum / weights }
        })
        .collect();
    for round in 0..ROUNDS {
        light = filtered(grid, &guide, &light, 1 << round);
    }

    let shown = light.iter().zip(&divisors).map(|(lit, &divisor)| lit.color * divisor);
    Some(Image::from_pixels(film.width(), film.height(), shown.collect()))
}

/// A pixel's light without the colour of its surface, and the variance of its luminance.
#[derive(Clone, Copy)]
struct Lit {
    color: Rgb,
    variance: f32,
}

/// One round: each pixel becomes the mean of 25, `step` apart, by weights.
fn filtered(grid: Grid, guide: &Guide<'_>, light: &[Lit], step: i64) -> Vec<Lit> {
    /// A cubic spline, from the middle outwards.
    const KERNEL: [f32; 3] = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];
    let luminances: Vec<f32> = light.iter().map(|lit| luminance(lit.color)).collect();
    (0..light.len())
        .into_par_iter()
        .map(|i| {
            // Nothing to remove, exactly nothing: keep what is there to the last digit.
            if light[i].variance == 0.0 {
                return light[i];
            }
            let allowed = DEVIATIONS * light[i].variance.sqrt();
            let (mut color, mut variance, mut weights) = (Rgb::ZERO, 0.0, 0.0);
            grid.around(i, 2, step, |j, x, y| {
                let apart = (luminances[i] - luminances[j]).abs();
                let kernel = KERNEL[x.unsigned_abs() as usize] * KERNEL[y.unsigned_abs() as usize];
                let distance = step * x.abs().max(y.abs());
                let weight = kernel * (-apart / allowed).exp() * guide.weight(i, j, distance);
                color += weight * light[j].color;
                variance += weight * weight * light[j].variance;
                weights += weight;
            });
            Lit { color: (1.0 / weights) * color, variance: variance / (weights * weights) }
        })
        .collect()
}

/// Rows and columns of pixels.
#[derive(Clone, Copy)]
struct Grid {
    width: i64,
    height: i64,
}

impl Grid {
    /// Visits pixels around one, itself too, every `step`th up to `radius` of them to each side: their numbers, columns and rows in steps.
    fn around(self, pixel: usize, radius: i64, step: i64, mut visit: impl FnMut(usize, i64, i64)) {
        let (x, y) = (pixel as i64 % self.width, pixel as i64 / self.width);
        for row in -radius..=radius {
            for column in -radius..=radius {
                let (i, j) = (x + step * column, y + step * row);
                if (0..self.width).contains(&i) && (0..self.height).contains(&j) {
                    visit((j * self.width + i) as usize, column, row);
                }
            }
        }
    }
}

/// What tells whether pixels see the same surface.
struct Guide<'a> {
    features: &'a Features,
    /// How much depths change from pixel to pixel.
    slopes: Vec<f32>,
}

impl<'a> Guide<'a> {
    fn new(grid: Grid, features: &'a Features) -> Self {
        let depths = &features.depths;
        let slope = |i: usize| {
            // The smaller of both sides, so that edges of things are no slopes.
            let (mut across, mut down) = (f32::INFINITY, f32::INFINITY);
            grid.around(i, 1, 1, |j, x, y| {
                let change = (depths[i] - depths[j]).abs();
                match (x.abs(), y.abs()) {
                    (1, 0) => across = across.min(change),
                    (0, 1) => down = down.min(change),
                    _ => {}
                }
            });
            let slope = across.max(down);
            if slope.is_finite() { slope } else { 0.0 }
        };
        let slopes = (0..depths.len()).into_par_iter().map(slope).collect();
        Self { features, slopes }
    }

    /// How much pixels that are so many pixels apart see the same, 0 to 1.
    #[inline]
    fn weight(&self, i: usize, j: usize, distance: i64) -> f32 {
        if i == j {
            return 1.0;
        }
        let Features { albedo, normals, depths, .. } = self.features;
        match (depths[i].is_finite(), depths[j].is_finite()) {
            (false, false) => return 1.0,
            (true, true) => {}
            _ => return 0.0,
        }
        let cosine = normals[i].normalize_or_zero().dot(normals[j].normalize_or_zero());
        // Twice the slope, and what rounding may be.
        let expected = 2.0 * self.slopes[i] * distance as f32 + 1e-3 * depths[i];
        let apart = (depths[i] - depths[j]).abs() / expected;
        let change = albedo[i] - albedo[j];
        let other = change.dot(change) / (ALBEDO_WIDTH * ALBEDO_WIDTH);
        cosine.max(0.0).powi(NORMAL_POWER) * (-apart - other).exp()
    }
}
