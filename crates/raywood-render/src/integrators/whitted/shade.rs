//! Shading: what light comes back along a ray from what it hit, and which rays follow.

use raywood::{Ray, Vec3, Vectorized};
use raywood_scene::Rgb;

use super::columns::get;
use super::direct::DirectLight;
use super::lit_points::LitPoint;
use super::queue::{Path, Queue, Traced};
use super::surfaces::Surfaces;
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

/// A wave that was traced, and memory for what it hit.
pub(super) struct ShadeWave<'a, 'b, W> {
    pub(super) shader: Shader<'a>,
    pub(super) wave: W,
    pub(super) surfaces: &'b mut Surfaces,
}

impl<W: Traced> Vectorized for ShadeWave<'_, '_, W> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { mut shader, wave, surfaces } = self;
        let scene = shader.frame.scene;
        surfaces.find(scene, &wave, |ray| {
            let path = wave.path(ray);
            shader.add(&path, path.weight * scene.background(wave.direction(ray)));
        });
        shader.direct.begin();
        for number in 0..surfaces.count() {
            shader.shade(&wave, surfaces, number);
        }
    }
}

impl Shader<'_> {
    /// Adds the light that comes back along a ray from the surface that it hit, and sends further rays.
    #[inline(always)]
    fn shade(&mut self, wave: &impl Traced, surfaces: &Surfaces, number: usize) {
        let surface = surfaces.get(self.frame.scene, number);
        let direction = get(&surfaces.directions, number);
        let path = wave.path(surfaces.ray(number));
        let material = surface.material;

        // Absorb on the way. From the inside of a surface the way led through its material, whatever came before.
        let absorption = if !surface.outside && material.transmissive {
            material.absorption
        } else {
            path.absorption
        };
        let weight = path.weight * transmittance(absorption, surfaces.distance(number));
        let here = Path { weight, absorption, ..path };

        // Share out the light between mirror and body.
        let cos_view = surface.cos_towards(direction);
        let (mirror, interface) = if material.transmissive {
            let interface = dielectric(cos_view, eta(&surface));
            (Rgb::splat(interface.reflectance), Some(interface))
        } else if material.mirrors {
            (schlick(material.mirror, cos_view), None)
        } else {
            (Rgb::ZERO, None)
        };

        self.lights(&surface, number, &here, Rgb::ONE - mirror);
        if mirror != Rgb::ZERO {
            // All rays but refracted ones leave the surface on this side.
            self.reflect(&surface, direction, &here, mirror, get(&surfaces.origins, number));
        }
        if let Some(interface) = interface {
            self.refract(&surface, direction, &here, interface);
        }
    }

    #[inline(always)]
    fn add(&mut self, path: &Path, light: Rgb) {
        self.pixels[path.pixel as usize] += light;
    }

    /// Adds what the surface sends out by itself and of the ambient light, and has the other lights look at it. `body` is the share that is
    /// not mirrored.
    #[inline(always)]
    fn lights(&mut self, surface: &Surface<'_>, number: usize, here: &Path, body: Rgb) {
        let material = surface.material;
        let diffuse = here.weight * (body * surface.diffuse);
        self.add(here, here.weight * material.emission + self.frame.lights.ambient * diffuse);
        if !material.shiny && diffuse == Rgb::ZERO {
            return;
        }
        let point = LitPoint {
            pixel: here.pixel,
            diffuse,
            specular: here.weight * material.specular,
            shininess: if material.shiny { Some(material.shininess) } else { None },
        };
        self.direct.light(number, point);
    }

    /// Follows the light that the surface mirrors, if it is worth a ray.
    #[inline(always)]
    fn reflect(
        &mut self,
        surface: &Surface<'_>,
        direction: Vec3,
        here: &Path,
        mirror: Rgb,
        origin: Vec3,
    ) {
        let Some(next) = self.next(here, mirror, here.absorption) else { return };
        self.counts.reflection += 1;
        let [reflected, _] = &mut *self.followers;
        reflected.push(Ray::new(origin, surface.mirrored(direction)), next);
    }

    /// Follows the light that the surface lets through, if it is worth a ray.
    #[inline(always)]
    fn refract(
        &mut self,
        surface: &Surface<'_>,
        direction: Vec3,
        here: &Path,
        interface: Interface,
    ) {
        let share = (1.0 - interface.reflectance) * surface.material.transmission;
        let absorption = if surface.outside { surface.material.absorption } else { Rgb::ZERO };
        let Some(next) = self.next(here, share, absorption) else { return };
        self.counts.refraction += 1;
        // Thin surfaces let rays straight on, whatever the normals say.
        let direction = if surface.material.ior == 1.0 {
            direction
        } else {
            let bent = refract(direction, surface.normal, eta(surface), interface.cos_transmitted);
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
