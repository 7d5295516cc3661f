//! Measuring a heat map: the primary rays of a picture, followed to their closest hits while a probe counts.

use raywood::{Counts, StructureKind};
use raywood_scene::Camera;

use super::HeatQuantity;
use crate::PreparedScene;
use crate::camera_rays::CameraRays;
use crate::options::{RenderError, RenderOptions};
use crate::progress::Progress;
use crate::stats::RayCounts;
use crate::tiles::{TILE_SIZE, fill_tiles};

/// How much a structure does for each pixel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// What was counted.
    pub quantity: HeatQuantity,
    /// The kind of structure that was watched.
    pub structure: StructureKind,
    /// The mean over a pixel's primary rays, row after row from the top: `width * height` numbers, none below zero.
    pub values: Vec<f32>,
    /// How many rays were followed.
    pub rays: u64,
}

/// Counts what the scene's structure does to find the closest hits of all primary rays, on the threads of the current rayon pool.
///
/// Size and number of samples are those of the options, and the rays the same as [`render`](crate::render) sends from the eye. The map is
/// the same, bit for bit, for any number of threads.
///
/// # Errors
///
/// Options or a camera that make no sense, too little memory, or [`RenderError::Cancelled`] after [`Progress::cancel`].
pub fn heat_map(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    quantity: HeatQuantity,
    progress: &Progress,
) -> Result<HeatMap, RenderError> {
    options.validate()?;
    let &RenderOptions { width, height, samples, lens, .. } = options;
    let camera = CameraRays::new(camera, width, height)?.with_lens(lens);
    let structure = scene.structure().ok_or(RenderError::Instances)?;
    let bytes = options.memory_bytes();
    let (values, rays) = fill_tiles((width, height), 0.0, bytes, progress, |tile, pixels| {
        for (row, y) in (tile.y..tile.y + tile.height).enumerate() {
            for (column, x) in (tile.x..tile.x + tile.width).enumerate() {
                let mut counts = Counts::default();
                for ray in camera.rays_of([x, y], options) {
                    if progress.is_cancelled() {
                        return RayCounts::default();
                    }
                    structure.intersect_probed(&ray, &mut counts);
                }
                let mean = quantity.of(&counts) as f64 / f64::from(samples);
                pixels[row * TILE_SIZE as usize + column] = mean as f32;
            }
        }
        let primary = u64::from(tile.width * tile.height) * u64::from(samples);
        RayCounts { primary, ..RayCounts::default() }
    })?;
    Ok(HeatMap { width, height, quantity, structure: structure.kind(), values, rays: rays.primary })
}

impl HeatMap {
    /// The mean over all pixels, which is that over all rays; 0 without pixels.
    pub fn mean(&self) -> f64 {
        self.values.iter().copied().map(f64::from).sum::<f64>() / self.values.len().max(1) as f64
    }

    /// The largest value of a pixel; 0 without pixels.
    pub fn max(&self) -> f32 {
        self.values.iter().copied().fold(0.0, f32::max)
    }

    /// The least value that is at least as large as `percent` of all values; 0 without pixels. O(pixels).
    pub fn percentile(&self, percent: f64) -> f32 {
        nearest_rank(self.values.clone(), percent)
    }

    /// How many pixels are above a value.
    pub fn pixels_above(&self, value: f32) -> usize {
        self.values.iter().filter(|&&other| other > value).count()
    }

    /// The percentile of the pixels for which anything was counted at all: how large a thing is in its picture does not change it.
    pub(super) fn percentile_of_counted(&self, percent: f64) -> f32 {
        let counted = self.values.iter().copied().filter(|&value| value > 0.0);
        nearest_rank(counted.collect(), percent)
    }
}

/// The percentile of some values by the definition of nearest rank; 0 without values.
fn nearest_rank(mut values: Vec<f32>, percent: f64) -> f32 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let rank = (percent / 100.0 * values.len() as f64).ceil() as usize;
    let index = rank.saturating_sub(1).min(last);
    *values.select_nth_unstable_by(index, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_maximum_and_percentiles_of_known_values() {
        // A hundred pixels, 1 to 100, in an order that is not sorted.
        let values: Vec<f32> = (0..100).map(|i| ((i * 37) % 100 + 1) as f32).collect();
        let (quantity, structure) = (HeatQuantity::Nodes, StructureKind::KdTree);
        let map = HeatMap { width: 20, height: 5, quantity, structure, values, rays: 100 };
        assert_eq!((map.mean(), map.max()), (50.5, 100.0));
        let percentiles = [0.0, 0.5, 1.0, 50.0, 99.0, 99.5, 100.0, 1e9, f64::NAN];
        let expected = [1.0, 1.0, 1.0, 50.0, 99.0, 100.0, 100.0, 100.0, 1.0];
        assert_eq!(percentiles.map(|percent| map.percentile(percent)), expected);
        assert_eq!(map.pixels_above(97.0), 3);

        let nothing = HeatMap { width: 0, height: 0, values: vec![], ..map };
        assert_eq!((nothing.mean(), nothing.max(), nothing.percentile(50.0)), (0.0, 0.0, 0.0));
    }
}
