//! The primary rays of a tile, one of each pixel at a time.

use super::{Traced, WAVE};
use crate::camera_rays::CameraRays;
use crate::sampling::PixelSamples;
use crate::tiles::Tile;
use raywood::{Hit, HitColumns, Vec3, Vectorized};

/// The pixels of a square of a tile, those of a block together.
#[derive(Default)]
pub(crate) struct PrimaryRays {
    pixels: Vec<Pixel>,
    /// Where one ray of each goes.
    pub(crate) directions: Vec<Vec3>,
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
    pub(crate) fn reset(&mut self, tile: &Tile, square: [u32; 2], samples: u32) {
        self.pixels.clear();
        // Not `extend`, which would step through the nested ranges from outside, pixel by pixel.
        tile.pixels_in_blocks(square).for_each(|(number, [x, y])| {
            let samples = PixelSamples::new(x, y, samples);
            self.pixels.push(Pixel { number, place: [x, y], samples });
        });
    }

    /// How many pixels these are.
    pub(crate) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// The number in its tile of the pixel that a ray belongs to.
    #[inline(always)]
    pub(crate) fn pixel(&self, ray: usize) -> u16 {
        self.pixels[ray].number as u16
    }
}

/// Finds out where ray `index` of every pixel goes.
pub(crate) struct SendPrimary<'a> {
    pub(crate) camera: &'a CameraRays,
    pub(crate) primary: &'a mut PrimaryRays,
    pub(crate) index: u32,
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
pub(crate) struct TracedPrimary<'a> {
    pub(crate) eye: Vec3,
    pub(crate) primary: &'a PrimaryRays,
    pub(crate) hits: &'a HitColumns,
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
    fn travelled(&self, _ray: usize) -> f32 {
        0.0
    }

    #[inline(always)]
    fn hit(&self, ray: usize) -> Option<Hit> {
        self.hits.get(ray)
    }
}
