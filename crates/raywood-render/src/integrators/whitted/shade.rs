//! Shading: what light comes back along a ray from what it hit, and which rays follow.

use raywood::{Hit, Ray, Vec3, Vectorized};
use raywood_scene::Rgb;

use super::direct::DirectLight;
use super::lit_points::LitPoint;
use super::queue::{Path, Queue};
use crate::fresnel::{Interface, dielectric, refract, schlick};
use crate::integrators::Frame;
use crate::shading::{Surface, keep_on_side};
use crate::shadows::transmittance;
use crate::stats::RayCounts;
use crate::tiles::TilePixels;

/// Shades the hits of a wave.
pub(super) struct Shader<'a> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) pixels: &'a mut TilePixels,
    pub(super) counts: &'a mut RayCounts,
    pub(super) direct: &'a mut DirectLight,
    /// Where mirrored rays wait, and those that are let through.
    pub(super) followers: &'a mut [Queue; 2],
    /// Whether rays may follow at all.
    pub(super) goes_on: bool,
}

/// A wave that was traced.
pub(super) struct ShadeWave<'a, 'b> {
    pub(super) shader: Shader<'a>,
    pub(super) wave: &'b Queue,
    pub(super) hits: &'b [Option<Hit>],
}

impl Vectorized for ShadeWave<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { mut shader, wave, hits } = self;
        for ((ray, path), hit) in wave.rays.iter().zip(&wave.paths).zip(hits) {
            shader.shade(ray, path, hit.as_ref());
        }
    }
}

impl Shader<'_> {
    /// Adds the light that comes back along a ray from what it hit, and sends further rays.
    #[inline(always)]
    pub(super) fn shade(&mut self, ray: &Ray, path: &Path, hit: Option<&Hit>) {
        let frame = self.frame;
        let Some(hit) = hit else {
            self.add(path, path.weight * frame.scene.background(ray.direction));
            return;
        };
        let surface = Surface::new(frame.scene, ray, hit);
        let material = surface.material;

        // Absorb on the way. From the inside of a surface the way led through its material, whatever came before.
        let absorption = if !surface.outside && material.transmissive {
            material.absorption
        } else {
            path.absorption
        };
        let weight = path.weight * transmittance(absorption, hit.t);
        let here = Path { weight, absorption, ..*path };

        // Share out the light between mirror and body.
        let cos_view = surface.cos_towards(ray.direction);
        let (mirror, interface) = if material.transmissive {
            let interface = dielectric(cos_view, eta(&surface));
            (Rgb::splat(interface.reflectance), Some(interface))
        } else if material.mirrors {
            (schlick(material.mirror, cos_view), None)
        } else {
            (Rgb::ZERO, None)
        };

        // All rays but refracted ones leave the surface on this side.
        let origin = surface.point.origin_towards(surface.geometric_normal);
        self.lights(&surface, ray, &here, Rgb::ONE - mirror, origin);
        if mirror != Rgb::ZERO {
            self.reflect(&surface, ray, &here, mirror, origin);
        }
        if let Some(interface) = interface {
            self.refract(&surface, ray, &here, interface);
        }
    }

    #[inline(always)]
    fn add(&mut self, path: &Path, light: Rgb) {
        self.pixels[path.pixel as usize] += light;
    }

    /// Adds what the surface sends out by itself and of the ambient light, and has the other lights look at it. `body` is the share that is
    /// not mirrored.
    #[inline(always)]
    fn lights(&mut self, surface: &Surface<'_>, ray: &Ray, here: &Path, body: Rgb, origin: Vec3) {
        let material = surface.material;
        let diffuse = here.weight * (body * surface.diffuse);
        self.add(here, here.weight * material.emission + self.frame.lights.ambient * diffuse);
        if !material.shiny && diffuse == Rgb::ZERO {
            return;
        }
        self.direct.light(LitPoint {
            pixel: here.pixel,
            position: surface.point.position,
            origin,
            geometric_normal: surface.geometric_normal,
            normal: surface.normal,
            diffuse,
            view: ray.direction,
            specular: here.weight * material.specular,
            shininess: if material.shiny { Some(material.shininess) } else { None },
        });
    }

    /// Follows the light that the surface mirrors, if it is worth a ray.
    #[inline(always)]
    fn reflect(
        &mut self,
        surface: &Surface<'_>,
        ray: &Ray,
        here: &Path,
        mirror: Rgb,
        origin: Vec3,
    ) {
        let Some(next) = self.next(here, mirror, here.absorption) else { return };
        self.counts.reflection += 1;
        let [reflected, _] = &mut *self.followers;
        reflected.push(Ray::new(origin, surface.mirrored(ray.direction)), next);
    }

    /// Follows the light that the surface lets through, if it is worth a ray.
    #[inline(always)]
    fn refract(&mut self, surface: &Surface<'_>, ray: &Ray, here: &Path, interface: Interface) {
        let share = (1.0 - interface.reflectance) * surface.material.transmission;
        let absorption = if surface.outside { surface.material.absorption } else { Rgb::ZERO };
        let Some(next) = self.next(here, share, absorption) else { return };
        self.counts.refraction += 1;
        // Thin surfaces let rays straight on, whatever the normals say.
        let direction = if surface.material.ior == 1.0 {
            ray.direction
        } else {
            let bent =
                refract(ray.direction, surface.normal, eta(surface), interface.cos_transmitted);
            keep_on_side(bent.normalize_or_zero(), -surface.geometric_normal)
        };
        let [_, refracted] = &mut *self.followers;
        refracted.push(surface.point.spawn(direction), next);
    }

    /// The path after one more bounce that keeps `share` of the light; `None` if that is one too many or too weak to see.
    #[inline(always)]
    fn next(&self, here: &Path, share: Rgb, absorption: Rgb) -> Option<Path> {
        let weight = here.weight * share;
        let goes_on = self.goes_on && weight.max_element() >= self.frame.options.cutoff;
        goes_on.then_some(Path { weight, absorption, ..*here })
    }
}

/// The index of refraction on the ray's side over the one on the other.
#[inline(always)]
fn eta(surface: &Surface<'_>) -> f32 {
    if surface.outside { 1.0 / surface.material.ior } else { surface.material.ior }
}
