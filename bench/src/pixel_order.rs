//! The order in which pixels are traced: tiles of 16 x 16 row by row, in each its sub-tiles of 4 x 4 row by row, in each its pixels row by
//! row. So every 16 rays in a row are neighbours on all sides, and so are every 256.

/// The edge of a tile in pixels.
pub(crate) const TILE: u32 = 16;

/// The edge of a sub-tile in pixels.
const SUB_TILE: u32 = 4;

/// The size of a picture in pixels, whole tiles each way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PictureSize {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl PictureSize {
    /// The picture that sets of rays are made of by default.
    pub(crate) const FULL: Self = Self { width: 1280, height: 800 };

    /// The picture of about the full one's shape with about so many pixels, at most those of the full one.
    pub(crate) fn with_about(pixels: u32) -> Self {
        let Self { width, height } = Self::FULL;
        let scale = (f64::from(pixels) / f64::from(width * height)).min(1.0).sqrt();
        let tiles = |edge: u32| ((f64::from(edge / TILE) * scale).round() as u32).max(1);
        Self { width: tiles(width) * TILE, height: tiles(height) * TILE }
    }
}

/// The pixels `[x, y]` of a picture in the order in which they are traced.
pub(crate) fn tiled_pixels(size: PictureSize) -> impl Iterator<Item = [u32; 2]> {
    let row_major =
        |columns: u32, rows: u32| (0..rows).flat_map(move |y| (0..columns).map(move |x| [x, y]));
    row_major(size.width / TILE, size.height / TILE).flat_map(move |tile| {
        row_major(TILE / SUB_TILE, TILE / SUB_TILE).flat_map(move |sub| {
            row_major(SUB_TILE, SUB_TILE)
                .map(move |pixel| [0, 1].map(|i| TILE * tile[i] + SUB_TILE * sub[i] + pixel[i]))
        })
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn pixels_come_by_tile_sub_tile_and_row() {
        let pixels: Vec<_> = tiled_pixels(PictureSize { width: 48, height: 32 }).collect();
        assert_eq!(pixels[..6], [[0, 0], [1, 0], [2, 0], [3, 0], [0, 1], [1, 1]]);
        // The second sub-tile, the second row of sub-tiles, the second tile, the second row of tiles.
        assert_eq!(pixels[16], [4, 0]);
        assert_eq!(pixels[64], [0, 4]);
        assert_eq!(pixels[256], [16, 0]);
        assert_eq!(pixels[3 * 256], [0, 16]);
        assert_eq!(pixels.last(), Some(&[47, 31]));
        assert_eq!(pixels.iter().collect::<HashSet<_>>().len(), 48 * 32);
    }

    #[test]
    fn smaller_pictures_keep_the_shape() {
        assert_eq!(PictureSize::with_about(1_024_000), PictureSize::FULL);
        assert_eq!(PictureSize::with_about(u32::MAX), PictureSize::FULL);
        assert_eq!(PictureSize::with_about(4096), PictureSize { width: 80, height: 48 });
        assert_eq!(PictureSize::with_about(1), PictureSize { width: 16, height: 16 });
    }
}
