//! Light that comes straight from the lights, if nothing is in the way.

use raywood::{Aabb, Ray, SimdLevel, Vec3};
use raywood_scene::Rgb;

use super::coloured::ColouredShadows;
use super::lit_points::{LitPoint, LitPoints, SendShadowRays, ShadowRays};
use crate::integrators::Frame;
use crate::prepared::PreparedScene;
use crate::shadows::{Aim, LightMayPass};
use crate::stats::RayCounts;
use crate::tiles::TilePixels;
use crate::wave::WAVE;
use crate::wave::surfaces::Surfaces;

/// Points that wait for light, and shadow rays that wait to be traced.
#[derive(Default)]
pub(super) struct DirectLight {
    points: Box<LitPoints>,
    /// For each light.
    shadows: Vec<ShadowRays>,
    /// The rays of a light that has only a direction.
    parallel: Vec<Ray>,
    blocked: Vec<bool>,
    suspects: Suspects,
    coloured: ColouredShadows,
}

impl DirectLight {
    /// Forgets everything and makes room for so many lights.
    pub(super) fn reset(&mut self, lights: usize) {
        self.coloured.clear();
        self.shadows.resize_with(lights, ShadowRays::default);
        for shadows in &mut self.shadows {
            shadows.origins.clear();
            shadows.times.clear();
            shadows.primitives.clear();
            shadows.light.clear();
        }
    }

    /// Forgets the surfaces of the last wave.
    #[inline(always)]
    pub(super) fn begin(&mut self) {
        self.points.clear();
    }

    /// Has all lights look at a surface of the wave.
    #[inline(always)]
    pub(super) fn light(&mut self, surface: usize, point: LitPoint) {
        self.points.set(surface, point);
    }

    /// Sends rays from all surfaces of the wave to all lights that may reach them, light by light.
    pub(super) fn send_shadow_rays(
        &mut self,
        frame: &Frame<'_>,
        surfaces: &Surfaces,
        level: SimdLevel,
    ) {
        let (points, moves) = (&*self.points, frame.scene.moves());
        for (light, shadows) in frame.lights.directed.iter().zip(&mut self.shadows) {
            level.run(SendShadowRays { light, surfaces, points, moves, shadows });
        }
    }

    /// Traces the shadow rays of the lights that have at least `fewest`, and adds the light that arrives. What may have passed something transparent
    /// waits for as many.
    pub(super) fn add(
        &mut self,
        frame: &Frame<'_>,
        fewest: usize,
        level: SimdLevel,
        pixels: &mut TilePixels,
        counts: &mut RayCounts,
    ) {
        let bounds = frame.scene.transmissive_bounds(frame.options.opaque_shadows);
        let Self { shadows, parallel, blocked, suspects, coloured, .. } = self;
        for (number, (light, shadows)) in frame.lights.directed.iter().zip(shadows).enumerate() {
            if shadows.origins.len() < fewest {
                continue;
            }
            // Whole packets, unless these are the last.
            let count = shadows.origins.len();
            let count = if fewest > 1 { count - count % WAVE } else { count };
            let (origins, primitives) = (&shadows.origins[..count], &shadows.primitives[..count]);
            let times = &shadows.times[..count.min(shadows.times.len())];
            let aim = Aim::at(light);
            blocked.resize(count, false);
            let rays = (origins, times, primitives);
            ask_whether_blocked(frame.scene, aim, rays, parallel, blocked);
            counts.shadow += count as u64;
            for ((pixel, brought), blocked) in shadows.light[..count].iter().zip(&*blocked) {
                // No branch, which would follow the edges of shadows.
                pixels[*pixel as usize] += if *blocked { Rgb::ZERO } else { *brought };
            }

            // Something transparent may be all that is in the way of those that are blocked.
            if !bounds.is_empty() {
                suspects.find(bounds, aim, origins, blocked, level);
                for (ray, origin) in suspects.passing() {
                    // It counts again, surface by surface.
                    counts.shadow -= 1;
                    let (pixel, brought) = shadows.light[ray];
                    let time = times.get(ray).copied().unwrap_or(0.0);
                    coloured.push((aim.ray_from(origin), time), number, pixel, brought);
                }
            }
            let timed = times.len();
            shadows.times.drain(..timed);
            shadows.origins.drain(..count);
            shadows.primitives.drain(..count);
            shadows.light.drain(..count);
        }

        // Only many rays at a time keep enough of them in flight.
        while coloured.len() >= fewest {
            coloured.advance(frame, pixels, counts);
        }
    }
}

/// Blocked rays to a light, of which some may meet something transparent.
#[derive(Default)]
struct Suspects {
    /// Which rays are blocked, and where they start.
    rays: Vec<usize>,
    origins: Vec<Vec3>,
    /// Not zero where something transparent may be in the way.
    answers: Vec<u32>,
}

impl Suspects {
    /// Finds out which of the blocked rays may meet something in the boxes.
    fn find(
        &mut self,
        bounds: &[Aabb],
        aim: Aim,
        origins: &[Vec3],
        blocked: &[bool],
        level: SimdLevel,
    ) {
        let Self { rays, origins: starts, answers } = self;
        rays.clear();
        rays.extend(
            blocked.iter().enumerate().filter(|(_, blocked)| **blocked).map(|(ray, _)| ray),
        );
        starts.clear();
        starts.extend(rays.iter().map(|&ray| origins[ray]));
        answers.clear();
        answers.resize(rays.len(), 0);
        level.run(LightMayPass { bounds, aim, origins: starts, answers });
    }

    /// Those that may, and where they start.
    fn passing(&self) -> impl Iterator<Item = (usize, Vec3)> + '_ {
        let all = self.rays.iter().zip(&self.origins).zip(&self.answers);
        all.filter(|(_, answer)| **answer != 0).map(|((ray, origin), _)| (*ray, *origin))
    }
}

/// Asks whether anything is between points, beside the primitives of these numbers, and a light. `parallel` is memory.
fn ask_whether_blocked(
    scene: &PreparedScene<'_>,
    aim: Aim,
    (origins, times, primitives): (&[Vec3], &[f32], &[u32]),
    parallel: &mut Vec<Ray>,
    blocked: &mut [bool],
) {
    match aim {
        Aim::Point(target) => {
            let end = Ray::SHORT_END;
            let tracer = scene.tracer();
            tracer.occluded_from_surfaces(target, end, (origins, times), primitives, blocked);
        }
        Aim::Direction(_) => {
            parallel.clear();
            parallel.extend(origins.iter().map(|origin| aim.ray_from(*origin)));
            scene.tracer().occluded_batch(parallel, times, blocked);
        }
    }
}
