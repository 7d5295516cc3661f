//! The primary rays of a tile, one of each pixel at a time.

use super::{Traced, WAVE};
use crate::camera_rays::CameraRays;
use crate::integrators::Frame;
use crate::lens::Lens;
use crate::options::RenderOptions;
use crate::path_samples::PathSamples;
use crate::pixel_filter::PixelFilter;
use crate::sampling::PixelSamples;
use crate::tiles::Tile;
use raywood::{Hit, HitColumns, Ray, SimdLevel, Vec3, Vectorized};

/// The pixels of a square of a tile, those of a block together.
#[derive(Default)]
pub(crate) struct PrimaryRays {
    pixels: Vec<Pixel>,
    /// Where one ray of each goes.
    pub(crate) directions: Vec<Vec3>,
    /// Where it starts, if not at the eye; memory for the rays and what they hit.
    origins: Vec<Vec3>,
    /// When each looks at the scene, if anything moves there.
    times: Vec<f32>,
    rays: Vec<Ray>,
    found: Vec<Option<Hit>>,
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
    pub(crate) fn reset(&mut self, tile: &Tile, square: [u32; 2], options: &RenderOptions) {
        self.pixels.clear();
        self.origins.clear();
        self.times.clear();
        let &RenderOptions { samples, filter, seed, .. } = options;
        // Not `extend`, which would step through the nested ranges from outside, pixel by pixel.
        tile.pixels_in_blocks(square).for_each(|(number, place)| {
            let samples = PixelSamples::spread(place, samples, filter, seed);
            self.pixels.push(Pixel { number, place, samples });
        });
    }

    /// Finds out where ray `index` of every pixel goes, and what it hits.
    pub(crate) fn trace(
        &mut self,
        frame: &Frame<'_>,
        index: u32,
        level: SimdLevel,
        hits: &mut HitColumns,
    ) {
        let Frame { scene, camera, .. } = frame;
        level.run(SendPrimary { camera, primary: self, index });
        match camera.lens() {
            None if !scene.moves() => {
                scene.tracer().intersect_from(camera.eye(), &self.directions, hits);
            }
            lens => self.trace_one_by_one(frame, lens, index, hits),
        }
    }

    /// Has the rays pass through points of the lens, if there is one, and look at times, each its own, and finds what they hit.
    fn trace_one_by_one(
        &mut self,
        frame: &Frame<'_>,
        lens: Option<&Lens>,
        index: u32,
        hits: &mut HitColumns,
    ) {
        let Self { pixels, directions, origins, times, rays, found } = self;
        let Frame { scene, camera, options, .. } = frame;
        rays.clear();
        rays.extend(pixels.iter().zip(&*directions).map(|(pixel, &direction)| {
            let Some(lens) = lens else { return camera.ray_along(direction) };
            let path = PathSamples::seeded(pixel.place, index, options.seed);
            camera.through_lens(lens, direction, path)
        }));
        times.clear();
        if scene.moves() {
            times.extend(pixels.iter().map(|pixel| frame.time(pixel.place, index)));
        }
        origins.clear();
        origins.extend(rays.iter().map(|ray| ray.origin));
        directions.clear();
        directions.extend(rays.iter().map(|ray| ray.direction));
        found.resize(rays.len(), None);
        scene.tracer().intersect_batch(rays, times, found);
        *hits = HitColumns::new(rays.len());
        for (number, hit) in found.iter().enumerate() {
            let Some(hit) = hit else { continue };
            (hits.t[number], hits.u[number], hits.v[number]) = (hit.t, hit.u, hit.v);
            hits.primitive[number] = hit.primitive;
        }
        if scene.has_instances() {
            hits.instance = found.iter().map(|hit| hit.map_or(0, |hit| hit.instance)).collect();
        }
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
struct SendPrimary<'a> {
    camera: &'a CameraRays,
    primary: &'a mut PrimaryRays,
    index: u32,
}

impl Vectorized for SendPrimary<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { camera, primary, index } = self;
        let PrimaryRays { pixels, directions: rays, .. } = primary;

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
            // Once for the usual filter, so that its loop is one of vectors.
            for dimension in 0..2 {
                let places = &mut places[dimension][..count];
                let pairs = places.iter_mut().zip(&seeds[dimension][..count]);
                match samples.filter() {
                    PixelFilter::Tent => {
                        for (place, &seed) in pairs {
                            *place += point.offset(PixelFilter::Tent, dimension, seed);
                        }
                    }
                    filter => {
                        for (place, &seed) in pairs {
                            *place += point.offset(filter, dimension, seed);
                        }
                    }
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
    fn origin(&self, ray: usize) -> Vec3 {
        self.primary.origins.get(ray).copied().unwrap_or(self.eye)
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
    fn time(&self, ray: usize) -> f32 {
        self.primary.times.get(ray).copied().unwrap_or(0.0)
    }

    #[inline(always)]
    fn hit(&self, ray: usize) -> Option<Hit> {
        self.hits.get(ray)
    }
}
