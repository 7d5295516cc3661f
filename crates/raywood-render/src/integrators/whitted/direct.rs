//! Light that comes straight from the lights, if nothing is in the way.

use raywood::{Ray, Vec3};
use raywood_scene::{Light, Rgb};

use crate::integrators::Frame;
use crate::lights::{Lights, illuminate};
use crate::shading::light_cosine;
use crate::shadows::{light_may_pass, ray_towards_light, visibility};
use crate::stats::RayCounts;
use crate::tiles::TilePixels;

/// A point that lights may reach.
pub(super) struct LitPoint {
    /// The pixel of the tile that it is seen in.
    pub(super) pixel: u32,
    pub(super) position: Vec3,
    /// Where shadow rays start.
    pub(super) origin: Vec3,
    /// Unit normals on the viewer's side.
    pub(super) geometric_normal: Vec3,
    pub(super) normal: Vec3,
    /// What light scattered in all directions, and in the highlight, counts in the pixel.
    pub(super) diffuse: Rgb,
    pub(super) specular: Rgb,
    /// The exponent of the highlight, if there is one.
    pub(super) shininess: Option<f32>,
    /// The direction that it is seen in, unit length.
    pub(super) view: Vec3,
}

/// The shadow rays of one light: all go to one point, or in one direction.
#[derive(Default)]
struct ShadowRays {
    rays: Vec<Ray>,
    /// To which pixel the light adds how much if nothing is in the way.
    light: Vec<(u32, Rgb)>,
}

/// Points that wait for light, and shadow rays that wait to be traced.
#[derive(Default)]
pub(super) struct DirectLight {
    points: Vec<LitPoint>,
    /// For each light.
    shadows: Vec<ShadowRays>,
    blocked: Vec<bool>,
}

impl DirectLight {
    /// Forgets everything and makes room for so many lights.
    pub(super) fn reset(&mut self, lights: usize) {
        self.points.clear();
        self.shadows.resize_with(lights, ShadowRays::default);
        for shadows in &mut self.shadows {
            shadows.rays.clear();
            shadows.light.clear();
        }
    }

    /// Has all lights look at a point.
    #[inline]
    pub(super) fn light(&mut self, point: LitPoint) {
        self.points.push(point);
    }

    /// Sends rays from all points to all lights that may reach them, light by light.
    pub(super) fn send_shadow_rays(&mut self, lights: &Lights) {
        for (light, shadows) in lights.directed.iter().zip(&mut self.shadows) {
            for point in &self.points {
                shadows.send(light, point);
            }
        }
        self.points.clear();
    }

    /// Traces the shadow rays of the lights that have at least `fewest`, and adds the light that arrives.
    pub(super) fn add(
        &mut self,
        frame: &Frame<'_>,
        fewest: usize,
        pixels: &mut TilePixels,
        counts: &mut RayCounts,
    ) {
        let coloured = !frame.options.opaque_shadows;
        for (light, shadows) in frame.lights.directed.iter().zip(&mut self.shadows) {
            let ShadowRays { rays, light: brought } = shadows;
            if rays.len() < fewest {
                continue;
            }
            self.blocked.resize(rays.len(), false);
            frame.scene.structure().occluded_batch_serial(rays, &mut self.blocked);
            for ((ray, (pixel, light_brought)), blocked) in
                rays.iter().zip(&*brought).zip(&self.blocked)
            {
                let pixel = &mut pixels[*pixel as usize];
                if !blocked {
                    counts.shadow += 1;
                    *pixel += *light_brought;
                } else if coloured && light_may_pass(frame.scene, ray) {
                    // Something transparent may be all that is in the way.
                    let share = visibility(frame.scene, *ray, light, frame.options.cutoff, counts);
                    *pixel += *light_brought * share;
                } else {
                    counts.shadow += 1;
                }
            }
            rays.clear();
            brought.clear();
        }
    }
}

impl ShadowRays {
    /// Sends a ray from a point to the light if that may reach it.
    #[inline]
    fn send(&mut self, light: &Light, point: &LitPoint) {
        let Some(at_point) = illuminate(light, point.position) else { return };
        let cosine = light_cosine(at_point.direction, point.normal, point.geometric_normal);
        if cosine <= 0.0 {
            return;
        }

        // Lambert's law, and Blinn's highlight (1977) around the direction halfway to the eye.
        let mut response = point.diffuse;
        if let Some(shininess) = point.shininess {
            let halfway = (at_point.direction - point.view).normalize_or_zero();
            let aligned = halfway.dot(point.normal).max(0.0);
            response += aligned.powf(shininess) * point.specular;
        }
        self.rays.push(ray_towards_light(light, point.origin));
        self.light.push((point.pixel, cosine * response * at_point.intensity));
    }
}
