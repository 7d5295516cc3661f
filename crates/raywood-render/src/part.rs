//! The part of a picture that is rendered: all of it, what lies in a rectangle, or the share of one of several machines.
//!
//! Parts are made of whole tiles, as what rays of a tile hit may depend, in last digits, on the others that are traced with them: so pixels are the same, bit for bit, whichever part
//! they are rendered in.

use crate::film::{Film, FilmPixel};
use crate::options::RenderError;
use crate::tiles::{Tile, tiles_in_morton_order};

/// Which pixels of a picture are rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// All.
    #[default]
    Whole,
    /// Those in a rectangle, and what else the tiles have that it touches.
    Region(Region),
    /// Every tile whose number along Morton's curve leaves the remainder `index` when divided by `count`: all shares have nearly as many tiles, spread over the picture.
    Share {
        /// From 0, below `count`.
        index: u32,
        /// How many shares there are, at least 1.
        count: u32,
    },
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The first column.
    pub x: u32,
    /// The first row, from the top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Region {
    /// Whether it has pixels, all of them in a picture of this size.
    pub fn is_within(&self, width: u32, height: u32) -> bool {
        let fits = |start: u32, size: u32, all: u32| {
            size > 0 && start.checked_add(size).is_some_and(|end| end <= all)
        };
        fits(self.x, self.width, width) && fits(self.y, self.height, height)
    }

    /// Whether a tile has pixels of it.
    fn touches(&self, tile: &Tile) -> bool {
        let overlap = |start: u32, size: u32, other: u32, other_size: u32| {
            start < other + other_size && other < start.saturating_add(size)
        };
        overlap(self.x, self.width, tile.x, tile.width)
            && overlap(self.y, self.height, tile.y, tile.height)
    }
}

impl Part {
    /// Its tiles in a picture of this size, in Morton order.
    pub(crate) fn tiles(&self, width: u32, height: u32) -> Vec<Tile> {
        let mut tiles = tiles_in_morton_order(width, height);
        match *self {
            Self::Whole => {}
            Self::Region(region) => tiles.retain(|tile| region.touches(tile)),
            Self::Share { index, count } => {
                let mut numbers = (0..count.max(1)).cycle();
                tiles.retain(|_| numbers.next() == Some(index));
            }
        }
        tiles
    }

    /// Whether it has pixels of a picture of this size, and none beyond.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoPart`].
    pub fn validate(self, width: u32, height: u32) -> Result<(), RenderError> {
        let is_within = match self {
            Self::Whole => true,
            Self::Region(region) => region.is_within(width, height),
            Self::Share { index, count } => index < count && self.tile_count(width, height) > 0,
        };
        if is_within { Ok(()) } else { Err(RenderError::NoPart { part: self, width, height }) }
    }

    /// How many tiles it has in a picture of this size.
    pub fn tile_count(&self, width: u32, height: u32) -> usize {
        self.tiles(width, height).len()
    }

    /// The pixels of a film that it has, tile by tile.
    pub fn pixels<'a>(&self, film: &'a Film) -> impl Iterator<Item = &'a FilmPixel> + Clone {
        let tiles = self.tiles(film.width(), film.height());
        tiles.into_iter().flat_map(|tile| film.part([tile.x, tile.y], [tile.width, tile.height]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (200, 130);

    fn count(part: Part) -> Vec<u32> {
        let mut covered = vec![0; (SIZE.0 * SIZE.1) as usize];
        for tile in part.tiles(SIZE.0, SIZE.1) {
            for y in tile.y..tile.y + tile.height {
                for x in tile.x..tile.x + tile.width {
                    covered[(y * SIZE.0 + x) as usize] += 1;
                }
            }
        }
        covered
    }

    #[test]
    fn shares_have_every_pixel_once_and_as_many_tiles() {
        for shares in [1, 2, 3, 7, 35, 40] {
            let mut all = vec![0; (SIZE.0 * SIZE.1) as usize];
            let mut tiles = Vec::new();
            for index in 0..shares {
                let part = Part::Share { index, count: shares };
                all.iter_mut().zip(count(part)).for_each(|(sum, one)| *sum += one);
                tiles.push(part.tile_count(SIZE.0, SIZE.1));
            }
            assert!(all.iter().all(|&covered| covered == 1), "{shares} shares");
            let (fewest, most) = (tiles.iter().min(), tiles.iter().max());
            assert!(most.zip(fewest).is_some_and(|(most, fewest)| most - fewest <= 1));
        }
    }

    #[test]
    fn regions_have_all_their_pixels_and_no_tile_beside() {
        for (x, y, width, height) in
            [(0, 0, 200, 130), (31, 31, 2, 2), (199, 129, 1, 1), (40, 70, 9, 9)]
        {
            let region = Region { x, y, width, height };
            assert!(region.is_within(SIZE.0, SIZE.1));
            let covered = count(Part::Region(region));
            for row in y..y + height {
                for column in x..x + width {
                    assert_eq!(covered[(row * SIZE.0 + column) as usize], 1, "{column}, {row}");
                }
            }
            for tile in Part::Region(region).tiles(SIZE.0, SIZE.1) {
                let is_beside = tile.x >= x + width
                    || tile.y >= y + height
                    || tile.x + tile.width <= x
                    || tile.y + tile.height <= y;
                assert!(!is_beside, "{tile:?} beside {region:?}");
            }
        }
        let nothing = [(0, 0, 0, 1), (200, 0, 1, 1), (0, 100, 1, 31), (u32::MAX, 0, u32::MAX, 1)];
        for (x, y, width, height) in nothing {
            assert!(!Region { x, y, width, height }.is_within(SIZE.0, SIZE.1));
        }
    }
}
