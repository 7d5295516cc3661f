//! How bright a picture should be: light has no scale of its own, and nobody knows beforehand how much of it a room gathers.

use raywood_scene::{Camera, Light, luminance};

use crate::PreparedScene;
use crate::image::Image;
use crate::options::{RenderError, RenderOptions};
use crate::progress::Progress;
use crate::render::render;

/// The brightness from which on pictures compress light.
const BRIGHT: f32 = 0.8;

/// The share of pixels that may be brighter.
const MAY_BE_BRIGHTER: f32 = 0.1;

/// A small picture of the same scene by the same method: what can be known of a picture's light before, or without, all of its pixels. The same for any number of threads.
pub(crate) fn preview(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    lights: &[Light],
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Image, RenderError> {
    const WIDTH: u32 = 64;
    options.validate()?;
    let height = u64::from(WIDTH) * u64::from(options.height) / u64::from(options.width);
    let height = height.clamp(1, u64::from(4 * WIDTH)) as u32;
    let small = RenderOptions { width: WIDTH, height, samples: 4, ..options.clone() };
    render(scene, camera, lights, &small, progress).map(|(image, _)| image)
}

/// The factor, at most 1, with which nine tenths of the pixels stay below where bright light is compressed: found from a small picture of the same scene, which is the same for
/// any number of threads.
///
/// # Errors
///
/// As [`render`].
pub fn exposure_for(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    lights: &[Light],
    options: &RenderOptions,
    progress: &Progress,
) -> Result<f32, RenderError> {
    let image = preview(scene, camera, lights, options, progress)?;
    let mut brightness: Vec<f32> = image.pixels().iter().map(|&pixel| luminance(pixel)).collect();
    brightness.sort_unstable_by(f32::total_cmp);
    let place = ((1.0 - MAY_BE_BRIGHTER) * brightness.len() as f32) as usize;
    let bright = brightness[place.min(brightness.len() - 1)];
    Ok(if bright > BRIGHT && bright.is_finite() { BRIGHT / bright } else { 1.0 })
}

/// The factor that makes the log-average of the brightness of all pixels that are lit a middle grey of 0.18: the key of Reinhard et al., "Photographic Tone
/// Reproduction for Digital Images", 2002. 1 for a black picture.
pub fn key_exposure(image: &Image) -> f32 {
    const MIDDLE_GREY: f64 = 0.18;
    let lit = image.pixels().iter().map(|&pixel| luminance(pixel));
    let logarithms =
        lit.filter(|light| light.is_normal() && *light > 0.0).map(|l| f64::from(l.ln()));
    let (count, sum) = logarithms.fold((0u64, 0.0), |(count, sum), log| (count + 1, sum + log));
    if count == 0 { 1.0 } else { (MIDDLE_GREY / (sum / count as f64).exp()) as f32 }
}

impl Image {
    /// The image with so much of its light.
    #[must_use]
    pub fn exposed(mut self, factor: f32) -> Self {
        if factor != 1.0 {
            self.pixels_mut().iter_mut().for_each(|pixel| *pixel = factor * *pixel);
        }
        self
    }
}
