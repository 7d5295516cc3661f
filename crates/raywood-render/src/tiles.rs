//! The image cut into square tiles, in an order that keeps neighbours together.

use std::ops::Range;

use rayon::prelude::*;
use raywood_scene::Rgb;

use crate::options::RenderError;
use crate::progress::Progress;
use crate::stats::RayCounts;

/// The edge of a tile in pixels.
pub(crate) const TILE_SIZE: u32 = 32;

/// A rectangle of pixels: a whole square, or what is left of one at the image's right and lower edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    /// Its first column.
    pub(crate) x: u32,
    /// Its first row.
    pub(crate) y: u32,
    /// Columns, 1 to [`TILE_SIZE`].
    pub(crate) width: u32,
    /// Rows, 1 to [`TILE_SIZE`].
    pub(crate) height: u32,
}

/// The edge of the squares of pixels that a tile is divided into: one ray of each pixel is a wave.
pub(crate) const SQUARE_SIZE: u32 = 16;

/// The edge of the blocks of pixels that a square is divided into.
const BLOCK_SIZE: u32 = 4;

impl Tile {
    /// The column and row in the image of the pixel of a number in the tile.
    #[inline(always)]
    pub(crate) fn place(&self, pixel: u32) -> [u32; 2] {
        [self.x + pixel % TILE_SIZE, self.y + pixel / TILE_SIZE]
    }

    /// The upper left corners of its squares: columns and rows in the tile.
    pub(crate) fn squares(&self) -> impl Iterator<Item = [u32; 2]> {
        let squares = |size: u32| (0..size).step_by(SQUARE_SIZE as usize);
        let columns = self.width;
        squares(self.height).flat_map(move |row| squares(columns).map(move |column| [column, row]))
    }

    /// The pixels of a square, block after block of 4 x 4, so that any sixteen that follow each other are close together: their numbers in the
    /// tile, and their columns and rows in the image.
    pub(crate) fn pixels_in_blocks(
        &self,
        [left, top]: [u32; 2],
    ) -> impl Iterator<Item = (u32, [u32; 2])> {
        let Self { x, y, .. } = *self;
        let right = self.width.min(left + SQUARE_SIZE);
        let bottom = self.height.min(top + SQUARE_SIZE);
        let blocks = |range: Range<u32>| range.step_by(BLOCK_SIZE as usize);
        blocks(top..bottom)
            .flat_map(move |row| blocks(left..right).map(move |column| [column, row]))
            .flat_map(move |[column, row]| {
                let rows = row..(row + BLOCK_SIZE).min(bottom);
                let columns = column..(column + BLOCK_SIZE).min(right);
                rows.flat_map(move |row| columns.clone().map(move |column| [column, row]))
            })
            .map(move |[column, row]| (row * TILE_SIZE + column, [x + column, y + row]))
    }
}

/// What of a tile is rendered in a pass: for each of its squares, in their order, which samples of all its pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TilePass {
    pub(crate) samples:
        [Range<u32>; ((TILE_SIZE / SQUARE_SIZE) * (TILE_SIZE / SQUARE_SIZE)) as usize],
}

impl TilePass {
    /// The first samples of every square.
    pub(crate) fn all(samples: u32) -> Self {
        Self { samples: std::array::from_fn(|_| 0..samples) }
    }

    /// Whether nothing is rendered.
    pub(crate) fn is_empty(&self) -> bool {
        self.samples.iter().all(Range::is_empty)
    }

    /// The squares of a tile of which something is rendered, each with its samples.
    pub(crate) fn squares(&self, tile: &Tile) -> impl Iterator<Item = (Range<u32>, [u32; 2])> {
        let squares = self.samples.iter().cloned().zip(tile.squares());
        squares.filter(|(samples, _)| !samples.is_empty())
    }

    /// How many samples that are in all pixels of a tile.
    pub(crate) fn pixel_samples(&self, tile: &Tile) -> u64 {
        let count = |(samples, square): (Range<u32>, _)| {
            samples.len() as u64 * tile.pixels_in_blocks(square).count() as u64
        };
        self.squares(tile).map(count).sum()
    }
}

/// Something for each of a tile's pixels, row after row, each row [`TILE_SIZE`] long.
pub(crate) type TileOf<T> = [T; (TILE_SIZE * TILE_SIZE) as usize];

/// The colours of a tile's pixels.
pub(crate) type TilePixels = TileOf<Rgb>;

/// Computes something for every pixel of an image, tile by tile on the threads of the current rayon pool; gives the rows from the top,
/// and the rays that all tiles together traced. The same for any number of threads if `fill` depends on its tile alone.
///
/// `bytes` is what an error says about memory. `fill` should ask `progress` now and then whether to stop.
pub(crate) fn fill_tiles<T: Copy + Send>(
    (width, height): (u32, u32),
    blank: T,
    bytes: u64,
    progress: &Progress,
    fill: impl Fn(&Tile, &mut TileOf<T>) -> RayCounts + Sync,
) -> Result<(Vec<T>, RayCounts), RenderError> {
    // Give each tile its own pixels, so that threads share nothing while they work.
    let out_of_memory = |_| RenderError::OutOfMemory { bytes };
    let tiles = tiles_in_morton_order(width, height);
    let mut work: Vec<(Tile, TileOf<T>)> = Vec::new();
    work.try_reserve_exact(tiles.len()).map_err(out_of_memory)?;
    let mut pixels = Vec::new();
    pixels.try_reserve_exact(width as usize * height as usize).map_err(out_of_memory)?;
    work.extend(tiles.into_iter().map(|tile| (tile, [blank; _])));

    // One tile is the unit that idle threads steal.
    progress.start(u64::from(width) * u64::from(height));
    let rays = work
        .par_iter_mut()
        .with_max_len(1)
        .map(|(tile, pixels)| {
            if progress.is_cancelled() {
                return RayCounts::default();
            }
            let rays = fill(tile, pixels);
            progress.add(u64::from(tile.width * tile.height));
            rays
        })
        .sum();
    if progress.is_cancelled() {
        return Err(RenderError::Cancelled);
    }

    // Put the tiles together.
    pixels.resize(width as usize * height as usize, blank);
    for (tile, part) in &work {
        for (row, part) in
            part.chunks_exact(TILE_SIZE as usize).enumerate().take(tile.height as usize)
        {
            let start = (tile.y as usize + row) * width as usize + tile.x as usize;
            let columns = tile.width as usize;
            pixels[start..start + columns].copy_from_slice(&part[..columns]);
        }
    }
    Ok((pixels, rays))
}

/// All tiles of an image along Morton's curve (1966): tiles that are near in time are near in the picture, so the
/// threads share what lies in the caches.
pub(crate) fn tiles_in_morton_order(width: u32, height: u32) -> Vec<Tile> {
    let mut tiles = Vec::new();
    for row in 0..height.div_ceil(TILE_SIZE) {
        for column in 0..width.div_ceil(TILE_SIZE) {
            let (x, y) = (column * TILE_SIZE, row * TILE_SIZE);
            tiles.push(Tile {
                x,
                y,
                width: TILE_SIZE.min(width - x),
                height: TILE_SIZE.min(height - y),
            });
        }
    }
    tiles.sort_unstable_by_key(|tile| morton(tile.x / TILE_SIZE, tile.y / TILE_SIZE));
    tiles
}

/// The bits of two numbers in turn: x the even ones, y the odd ones.
fn morton(x: u32, y: u32) -> u64 {
    spread(x) | spread(y) << 1
}

/// Puts a zero between any two bits.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    x = (x | x << 16) & 0x0000_ffff_0000_ffff;
    x = (x | x << 8) & 0x00ff_00ff_00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333_3333_3333;
    (x | x << 1) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (100, 7), (5, 300)] {
            let mut covered = vec![0; (width * height) as usize];
            for tile in tiles_in_morton_order(width, height) {
                for y in tile.y..tile.y + tile.height {
                    for x in tile.x..tile.x + tile.width {
                        covered[(y * width + x) as usize] += 1;
                    }
                }
            }
            assert!(covered.iter().all(|&count| count == 1), "{width} x {height}");
        }
    }

    #[test]
    fn squares_cover_each_pixel_of_a_tile_once() {
        for (width, height) in [(1, 1), (32, 32), (17, 32), (16, 7), (5, 30)] {
            let tile = Tile { x: 64, y: 96, width, height };
            let mut covered = [0; (TILE_SIZE * TILE_SIZE) as usize];
            for square in tile.squares() {
                for (number, [x, y]) in tile.pixels_in_blocks(square) {
                    assert_eq!(number, (y - 96) * TILE_SIZE + x - 64);
                    assert!(x - 64 < width && y - 96 < height);
                    covered[number as usize] += 1;
                }
            }
            assert!(covered.iter().all(|&count| count <= 1));
            assert_eq!(covered.iter().sum::<u32>(), width * height, "{width} x {height}");
        }
    }

    #[test]
    fn the_order_is_mortons() {
        let edge = TILE_SIZE;
        let tiles = tiles_in_morton_order(4 * edge, 4 * edge);
        let order: Vec<_> = tiles.iter().map(|t| (t.x / edge, t.y / edge)).collect();
        assert_eq!(order[..8], [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (3, 0), (2, 1), (3, 1)]);
        assert_eq!(order[8], (0, 2));
    }
}
