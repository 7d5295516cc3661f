//! The primary rays of a tile, one of each pixel at a time.

use raywood::{Hit, HitColumns, Vec3, Vectorized};
use raywood_scene::Rgb;

use super::queue::{Path, Traced, WAVE};
use crate::camera_rays::CameraRays;
use crate::sampling::PixelSamples;
use crate::tiles::Tile;

/// The pixels of a square of a tile, those of a block together.
#[derive(Default)]
pub(super) struct PrimaryRays {
    pixels: Vec<Pixel>,
    /// Where one ray of each goes.
    pub(super) directions: Vec<Vec3>,
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
        // Not `extend`, which would step through the nested ranges from outside, pixel by pixel.
        tile.pixels_in_blocks(square).for_each(|(number, [x, y])| {
            let samples = PixelSamples::new(x, y, samples);
            self.pixels.push(Pixel { number, place: [x, y], samples });
        });
    }

    /// How many pixels these are.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }
}

/// Finds out where ray `index` of every pixel goes.
pub(super) struct SendPrimary<'a> {
    pub(super) camera: &'a CameraRays,
    pub(super) primary: &'a mut PrimaryRays,
    pub(super) index: u32,
}

impl Vectorized for SendPrimary<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { camera, primary: PrimaryRays { pixels, directions: rays }, index } = self;

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
        rays.clear();
        rays.extend((0..count).map(|number| Vec3::new(x[number], y[number], z[number])));
    }
}

/// Primary rays that were traced.
pub(super) struct TracedPrimary<'a> {
    pub(super) eye: Vec3,
    pub(super) primary: &'a PrimaryRays,
    pub(super) hits: &'a HitColumns,
}

impl Traced for TracedPrimary<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.primary.directions.len()
    }

    #[inline(always)]
    fn origin(&self, _ray: usize) -> Vec3 {
        self.eye
    }

    #[inline(always)]
    fn direction(&self, ray: usize) -> Vec3 {
        self.primary.directions[ray]
    }

    #[inline(always)]
    fn path(&self, ray: usize) -> Path {
        // In air. (An eye inside glass is noticed when the ray leaves it.)
        let pixel = self.primary.pixels[ray].number as u16;
        Path { pixel, holes: 0, weight: Rgb::ONE, absorption: Rgb::ZERO, length: 0.0 }
    }

    #[inline(always)]
    fn hit(&self, ray: usize) -> Option<Hit> {
        self.hits.get(ray)
    }
}
