//! The primary rays of a tile, one of each pixel at a time.

use raywood::Vectorized;
use raywood_scene::Rgb;

use super::queue::{Path, Queue, WAVE};
use crate::camera_rays::CameraRays;
use crate::sampling::PixelSamples;
use crate::tiles::Tile;

/// The pixels of a square of a tile, those of a block together.
#[derive(Default)]
pub(super) struct PrimaryRays {
    pixels: Vec<Pixel>,
}

/// A pixel and where its primary rays pass.
struct Pixel {
    /// Its number in the tile.
    number: u32,
    /// Its column and row in the image.
    place: [u32; 2],
    samples: PixelSamples,
}

impl PrimaryRays {
    /// Takes the pixels of a square of a tile.
    pub(super) fn reset(&mut self, tile: &Tile, square: [u32; 2], samples: u32) {
        self.pixels.clear();
        self.pixels.extend(tile.pixels_in_blocks(square).map(|(number, [x, y])| Pixel {
            number,
            place: [x, y],
            samples: PixelSamples::new(x, y, samples),
        }));
    }

    /// How many pixels these are.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }
}

/// Makes ray `index` of every pixel the next wave.
pub(super) struct SendPrimary<'a> {
    pub(super) camera: &'a CameraRays,
    pub(super) primary: &'a PrimaryRays,
    pub(super) index: u32,
    pub(super) wave: &'a mut Queue,
}

impl Vectorized for SendPrimary<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { camera, primary: PrimaryRays { pixels }, index, wave } = self;
        wave.clear();

        // Where the rays pass, in columns.
        let count = pixels.len().min(WAVE);
        let mut seeds = [[0; WAVE]; 2];
        let mut places = [[0.0; WAVE]; 2];
        for (number, Pixel { place: [x, y], samples, .. }) in pixels[..count].iter().enumerate() {
            [seeds[0][number], seeds[1][number]] = samples.seeds();
            [places[0][number], places[1][number]] = [*x as f32 + 0.5, *y as f32 + 0.5];
        }
        if let Some(Pixel { samples, .. }) = pixels.first() {
            let point = samples.point(index);
            for dimension in 0..2 {
                for number in 0..count {
                    places[dimension][number] += point.offset(dimension, seeds[dimension][number]);
                }
            }
        }

        let mut directions = [[0.0; WAVE]; 3];
        for number in 0..count {
            let direction = camera.direction(places[0][number], places[1][number]);
            [directions[0][number], directions[1][number], directions[2][number]] =
                direction.to_array();
        }
        let [x, y, z] = &directions;
        wave.rays
            .extend((0..count).map(|number| camera.ray_along([x[number], y[number], z[number]])));
        // In air. (An eye inside glass is noticed when the ray leaves it.)
        wave.paths.extend(pixels[..count].iter().map(|pixel| Path {
            pixel: pixel.number,
            weight: Rgb::ONE,
            absorption: Rgb::ZERO,
        }));
    }
}
