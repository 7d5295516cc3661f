//! How deep the picture is at each pixel: what lines are compared with to tell whether a surface hides them.

use rayon::prelude::*;
use raywood::Structure;

use crate::camera_rays::CameraRays;
use crate::options::{RenderError, RenderOptions};
use crate::prepared::Surfaces;
use crate::progress::Progress;
use crate::stats::RayCounts;
use crate::tiles::{TILE_SIZE, fill_tiles};

/// The depth beyond which lines are hidden, for each pixel: that of the deepest surface in the pixel and those around it, infinite where one of them
/// sees none.
///
/// So a line that lies on a surface, as those of tight boxes do, is not hidden by the surface's own slope between two pixels.
pub(super) fn depths(
    structure: &Structure<Surfaces<'_>>,
    camera: &CameraRays,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Vec<f32>, RenderError> {
    let (width, height) = (options.width as usize, options.height as usize);
    let bytes = options.memory_bytes();
    let projection = camera.projection();
    let size = (options.width, options.height);
    let (depths, _) = fill_tiles(size, f32::INFINITY, bytes, progress, |tile, pixels| {
        for (row, y) in (tile.y..tile.y + tile.height).enumerate() {
            if progress.is_cancelled() {
                return RayCounts::default();
            }
            for (column, x) in (tile.x..tile.x + tile.width).enumerate() {
                let ray = camera.ray(x as f32 + 0.5, y as f32 + 0.5);
                if let Some(hit) = structure.intersect(&ray) {
                    let depth = hit.t * projection.depth_along(ray.direction);
                    pixels[row * TILE_SIZE as usize + column] = depth;
                }
            }
        }
        RayCounts { primary: u64::from(tile.width * tile.height), ..RayCounts::default() }
    })?;

    let mut deepest = Vec::new();
    deepest.try_reserve_exact(depths.len()).map_err(|_| RenderError::OutOfMemory { bytes })?;
    deepest.resize(depths.len(), 0.0);
    deepest.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        for (x, deepest) in row.iter_mut().enumerate() {
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            let around = rows.clone().flat_map(|y| &depths[y * width..][columns.clone()]);
            // A thousandth more, for the curve of surfaces and the rounding of distances.
            *deepest = 1.001 * around.copied().fold(0.0, f32::max);
        }
    });
    Ok(deepest)
}
