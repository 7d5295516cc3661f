//! Features of what each pixel sees first, as numbers without limits: for denoisers, and for layers beside a picture.

use raywood::Ray;
use raywood_scene::{Camera, Rgb};

use super::first_hits::{FirstHits, MOST_HOLES, OfEach, Shown};
use super::{Frame, TileRenderer};
use crate::PreparedScene;
use crate::lights::Lights;
use crate::options::{RenderError, RenderOptions};
use crate::progress::Progress;
use crate::stats::RayCounts;
use crate::textured::opacity_at;
use crate::tiles::{TILE_SIZE, TilePass, fill_tiles};
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;

/// What is known of a picture's pixels, row after row from the top. Means over the rays of a pixel; what has holes counts by its share.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    /// The share of the light that surfaces send back, linear; 0 where nothing is seen.
    pub albedo: Vec<Rgb>,
    /// Normals for shading on the side of the eye; 0 where nothing is seen, shorter where they differ.
    pub normals: Vec<Rgb>,
    /// Where surfaces are; 0 where nothing is seen.
    pub positions: Vec<Rgb>,
    /// How far in front of the eye surfaces are, along the line of sight; infinite where nothing is seen.
    pub depths: Vec<f32>,
    /// The share of the rays that meet something.
    pub coverage: Vec<f32>,
}

/// Follows the first `samples` camera rays of each pixel of a picture to what they meet, on the threads of the current rayon pool.
///
/// # Errors
///
/// As [`render`](crate::render).
pub fn features(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    samples: u32,
    progress: &Progress,
) -> Result<Features, RenderError> {
    options.validate()?;
    let lights = Lights::default();
    let frame = Frame::new(scene, &lights, camera, options, progress)?;
    let places = means(&FirstHits { frame: &frame, shown: OfEach(place) }, samples)?;
    let depths = means(&FirstHits { frame: &frame, shown: OfEach(depth) }, samples)?;
    let coverage: Vec<f32> = depths.iter().map(|depth| depth.y).collect();
    let of_covered =
        |sum: f32, coverage: f32| if coverage > 0.0 { sum / coverage } else { f32::INFINITY };
    Ok(Features {
        albedo: means(&FirstHits { frame: &frame, shown: OfEach(albedo) }, samples)?,
        normals: means(&FirstHits { frame: &frame, shown: OfEach(normal) }, samples)?,
        positions: places
            .iter()
            .zip(&coverage)
            .map(
                |(&place, &coverage)| if coverage > 0.0 { (1.0 / coverage) * place } else { place },
            )
            .collect(),
        depths: depths.iter().map(|depth| of_covered(depth.x, depth.y)).collect(),
        coverage,
    })
}

/// The numbers of a primitive, its material and its instance where nothing is seen.
pub const NO_ID: u32 = u32::MAX;

/// Which primitive, material and instance the middle of each pixel sees (0 in scenes without instances), row after row from the top; [`NO_ID`] where nothing is. Through holes, without any lens, and in the middle of the time that the shutter is open.
///
/// # Errors
///
/// As [`render`](crate::render).
pub fn ids(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &Progress,
) -> Result<Vec<[u32; 3]>, RenderError> {
    options.validate()?;
    let lights = Lights::default();
    let frame = Frame::new(scene, &lights, camera, options, progress)?;
    let time = options.shutter.middle();
    let (size, bytes) = ((options.width, options.height), options.memory_bytes());
    let (ids, _) = fill_tiles(size, [NO_ID; 3], bytes, progress, |tile, pixels| {
        for row in 0..tile.height {
            for column in 0..tile.width {
                let [x, y] = [tile.x + column, tile.y + row].map(|x| x as f32 + 0.5);
                let ray = frame.camera.ray(x, y);
                pixels[(row * TILE_SIZE + column) as usize] = id(scene, ray, time);
            }
        }
        let primary = u64::from(tile.width * tile.height);
        RayCounts { primary, ..RayCounts::default() }
    })?;
    Ok(ids)
}

/// What a ray meets first at a time that is there by half at least.
fn id(scene: &PreparedScene<'_>, mut ray: Ray, time: f32) -> [u32; 3] {
    for hole in 0..=MOST_HOLES {
        let Some(hit) = scene.tracer().intersect_at(&ray, time) else { return [NO_ID; 3] };
        let is_there = hole == MOST_HOLES
            || !scene.material_of(&hit).perforated
            || opacity_at(scene, &hit) >= 0.5;
        if is_there {
            return [hit.primitive, scene.material_index(&hit) as u32, hit.instance];
        }
        ray = scene.tracer().surface_point(&ray, &hit, time).spawn(ray.direction);
    }
    [NO_ID; 3]
}

/// The means of what is shown.
fn means<S: Shown>(shown: &FirstHits<'_, S>, samples: u32) -> Result<Vec<Rgb>, RenderError> {
    let Frame { options, progress, .. } = shown.frame;
    let (size, bytes) = ((options.width, options.height), options.memory_bytes());
    let pass = TilePass::all(samples.clamp(1, options.samples));
    let share = 1.0 / samples.clamp(1, options.samples) as f32;
    let (pixels, _) = fill_tiles(size, Rgb::ZERO, bytes, progress, |tile, pixels| {
        let rays = shown.render_tile(tile, &pass, pixels);
        pixels.iter_mut().for_each(|pixel| *pixel = share * *pixel);
        rays
    })?;
    Ok(pixels)
}

/// What a surface scatters, mirrors and lets through.
fn albedo(frame: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    let surface = surfaces.get(frame.scene, number);
    let material = surface.material;
    (surface.diffuse + material.mirror + material.transmission).min(Rgb::ONE)
}

/// Its normal for shading.
fn normal(_: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    get(&surfaces.normals, number)
}

/// Where it is.
fn place(_: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    get(&surfaces.positions, number)
}

/// How far in front of the eye it is, and that there is one.
fn depth(frame: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    let along = frame.camera.depth_along(get(&surfaces.directions, number));
    Rgb::new(along * surfaces.lengths[number], 1.0, 0.0)
}
