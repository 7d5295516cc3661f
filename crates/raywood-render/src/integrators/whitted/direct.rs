//! Light that comes straight from the lights, if nothing is in the way.

use raywood::{Ray, SimdLevel, Vec3};
use raywood_scene::Rgb;

use super::coloured::ColouredShadows;
use super::lit_points::{LitPoint, LitPoints, SendShadowRays, ShadowRays};
use super::queue::WAVE;
use super::surfaces::Surfaces;
use crate::integrators::Frame;
use crate::lights::Lights;
use crate::prepared::PreparedScene;
use crate::shadows::{Aim, LightMayPass};
use crate::stats::RayCounts;
use crate::tiles::TilePixels;

/// Points that wait for light, and shadow rays that wait to be traced.
#[derive(Default)]
pub(super) struct DirectLight {
    points: Box<LitPoints>,
    /// For each light.
    shadows: Vec<ShadowRays>,
    /// The rays of a light that has only a direction.
    parallel: Vec<Ray>,
    blocked: Vec<bool>,
    /// Of the rays of a light those that may meet something transparent: not zero.
    may_pass: Vec<u32>,
    coloured: ColouredShadows,
}

impl DirectLight {
    /// Forgets everything and makes room for so many lights.
    pub(super) fn reset(&mut self, lights: usize) {
        self.coloured.clear();
        self.shadows.resize_with(lights, ShadowRays::default);
        for shadows in &mut self.shadows {
            shadows.origins.clear();
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
        lights: &Lights,
        surfaces: &Surfaces,
        level: SimdLevel,
    ) {
        for (light, shadows) in lights.directed.iter().zip(&mut self.shadows) {
            level.run(SendShadowRays { light, surfaces, points: &self.points, shadows });
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
        let opaque = frame.options.opaque_shadows;
        let bounds = if opaque { &[] } else { frame.scene.transmissive_bounds() };
        let Self { shadows, parallel, blocked, may_pass, coloured, .. } = self;
        for (number, (light, shadows)) in frame.lights.directed.iter().zip(shadows).enumerate() {
            if shadows.origins.len() < fewest {
                continue;
            }
            // Whole packets, unless these are the last.
            let count = shadows.origins.len();
            let count = if fewest > 1 { count - count % WAVE } else { count };
            let origins = &shadows.origins[..count];
            let aim = Aim::at(light);
            blocked.resize(count, false);
            ask_whether_blocked(frame.scene, aim, origins, parallel, blocked);
            may_pass.clear();
            may_pass.resize(count, 0);
            if !bounds.is_empty() {
                level.run(LightMayPass { bounds, aim, origins, answers: may_pass });
            }

            counts.shadow += count as u64;
            let answers = blocked.iter().zip(&*may_pass);
            let rays = origins.iter().zip(&shadows.light[..count]);
            for ((origin, (pixel, brought)), (blocked, may_pass)) in rays.zip(answers) {
                if *blocked && *may_pass != 0 {
                    // Something transparent may be all that is in the way. The ray counts again, surface by surface.
                    counts.shadow -= 1;
                    coloured.push(aim.ray_from(*origin), number, *pixel, *brought);
                }
                // No branch, which would follow the edges of shadows.
                pixels[*pixel as usize] += if *blocked { Rgb::ZERO } else { *brought };
            }
            shadows.origins.drain(..count);
            shadows.light.drain(..count);
        }

        // Only many rays at a time keep enough of them in flight.
        let fewest = if fewest > 1 { WAVE } else { 1 };
        while coloured.len() >= fewest {
            coloured.advance(frame, pixels, counts);
        }
    }
}

/// Asks whether anything is between points and a light. `parallel` is memory.
fn ask_whether_blocked(
    scene: &PreparedScene<'_>,
    aim: Aim,
    origins: &[Vec3],
    parallel: &mut Vec<Ray>,
    blocked: &mut [bool],
) {
    match aim {
        Aim::Point(target) => {
            scene.structure().occluded_towards_serial(target, Ray::SHORT_END, origins, blocked);
        }
        Aim::Direction(_) => {
            parallel.clear();
            parallel.extend(origins.iter().map(|origin| aim.ray_from(*origin)));
            scene.structure().occluded_batch_serial(parallel, blocked);
        }
    }
}
