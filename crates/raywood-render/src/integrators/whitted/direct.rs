//! Light that comes straight from the lights, if nothing is in the way.

use raywood::SimdLevel;

use super::coloured::ColouredShadows;
use super::lit_points::{LitPoint, LitPoints, SendShadowRays, ShadowRays};
use super::queue::WAVE;
use crate::integrators::Frame;
use crate::lights::Lights;
use crate::shadows::LightMayPass;
use crate::stats::RayCounts;
use crate::tiles::TilePixels;

/// Points that wait for light, and shadow rays that wait to be traced.
#[derive(Default)]
pub(super) struct DirectLight {
    points: Box<LitPoints>,
    /// For each light.
    shadows: Vec<ShadowRays>,
    blocked: Vec<bool>,
    /// Of the rays of a light those that may meet something transparent: not zero.
    may_pass: Vec<u32>,
    coloured: ColouredShadows,
}

impl DirectLight {
    /// Forgets everything and makes room for so many lights.
    pub(super) fn reset(&mut self, lights: usize) {
        self.points.clear();
        self.coloured.clear();
        self.shadows.resize_with(lights, ShadowRays::default);
        for shadows in &mut self.shadows {
            shadows.rays.clear();
            shadows.light.clear();
        }
    }

    /// Has all lights look at a point.
    #[inline(always)]
    pub(super) fn light(&mut self, point: LitPoint) {
        self.points.push(point);
    }

    /// Sends rays from all points to all lights that may reach them, light by light.
    pub(super) fn send_shadow_rays(&mut self, lights: &Lights, level: SimdLevel) {
        for (light, shadows) in lights.directed.iter().zip(&mut self.shadows) {
            level.run(SendShadowRays { light, points: &self.points, shadows });
        }
        self.points.clear();
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
        let lights = frame.lights.directed.len();
        for (number, shadows) in self.shadows[..lights].iter_mut().enumerate() {
            if shadows.rays.len() < fewest {
                continue;
            }
            // Whole packets, unless these are the last.
            let count = shadows.rays.len();
            let count = if fewest > 1 { count - count % WAVE } else { count };
            let (rays, brought) = (&shadows.rays[..count], &shadows.light[..count]);
            self.blocked.resize(rays.len(), false);
            frame.scene.structure().occluded_batch_serial(rays, &mut self.blocked);
            self.may_pass.clear();
            self.may_pass.resize(rays.len(), 0);
            if !bounds.is_empty() {
                level.run(LightMayPass { bounds, rays, answers: &mut self.may_pass });
            }
            let answers = self.blocked.iter().zip(&self.may_pass);
            for ((ray, (pixel, brought)), (blocked, may_pass)) in
                rays.iter().zip(brought).zip(answers)
            {
                if !blocked {
                    counts.shadow += 1;
                    pixels[*pixel as usize] += *brought;
                } else if *may_pass != 0 {
                    // Something transparent may be all that is in the way.
                    self.coloured.push(*ray, number, *pixel, *brought);
                } else {
                    counts.shadow += 1;
                }
            }
            shadows.rays.drain(..count);
            shadows.light.drain(..count);
        }

        // Only many rays at a time keep enough of them in flight.
        let fewest = if fewest > 1 { WAVE } else { 1 };
        while self.coloured.len() >= fewest {
            self.coloured.advance(frame, pixels, counts);
        }
    }
}
