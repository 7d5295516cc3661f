//! Shading: what light comes back along a ray from what it hit, and which rays follow.

use raywood::{Ray, SimdLevel, Vec3, Vectorized};
use raywood_scene::Rgb;

use super::direct::DirectLight;
use super::lit_points::LitPoint;
use super::queue::{Followed, Followers, Path};
use crate::fresnel::{Interface, dielectric, refract, schlick_to};
use crate::integrators::Frame;
use crate::shading::{Surface, keep_on_side};
use crate::shadows::transmittance;
use crate::stats::RayCounts;
use crate::tiles::TilePixels;
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;
use crate::wave::textured_surfaces::{TextureMemory, TextureSurfaces};

/// Shades the hits of a wave.
pub(super) struct Shader<'a> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) pixels: &'a mut TilePixels,
    pub(super) counts: &'a mut RayCounts,
    pub(super) direct: &'a mut DirectLight,
    /// Where the rays wait that follow.
    pub(super) followers: Followers<'a>,
    /// Whether rays may follow at all.
    pub(super) goes_on: bool,
}

/// A wave that was traced, and memory for what it hit.
pub(super) struct ShadeWave<'a, 'b, W> {
    pub(super) shader: Shader<'a>,
    pub(super) wave: W,
    pub(super) surfaces: &'b mut Surfaces,
    pub(super) memory: &'b mut TextureMemory,
    /// What loops are compiled for.
    pub(super) level: SimdLevel,
}

impl<W: Followed> Vectorized for ShadeWave<'_, '_, W> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { mut shader, wave, surfaces, memory, level } = self;
        let scene = shader.frame.scene;
        let spread = shader.frame.spread();
        surfaces.find(scene, &wave, |ray| {
            let path = wave.path(ray);
            shader.add(&path, path.weight * scene.background(wave.direction(ray)));
        });
        if scene.is_textured() {
            surfaces.find_lengths(&wave);
            level.run(TextureSurfaces { scene, surfaces: &mut *surfaces, memory, spread });
        }
        shader.direct.begin();
        for number in 0..surfaces.count() {
            shader.shade(&wave, surfaces, number);
        }
    }
}

impl Shader<'_> {
    /// Adds the light that comes back along a ray from the surface that it hit, and sends further rays.
    #[inline(always)]
    fn shade(&mut self, wave: &impl Followed, surfaces: &Surfaces, number: usize) {
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
        let length = path.length + surfaces.distance(number);
        let mut here = Path { weight, absorption, length, ..path };

        // Go on through what is not there.
        if material.opacity < 1.0 && path.holes < MOST_HOLES {
            self.go_straight(&surface, direction, &here, path.absorption);
            here.weight = material.opacity * weight;
            if here.weight == Rgb::ZERO {
                return;
            }
        }
        here.holes = 0;

        // Share out the light between mirror and body.
        let cos_view = surface.cos_towards(direction);
        let (mirror, interface) = if material.transmissive {
            let interface = dielectric(cos_view, eta(&surface));
            (Rgb::splat(interface.reflectance), Some(interface))
        } else if material.mirrors {
            (schlick_to(material.mirror, material.grazing, cos_view), None)
        } else {
            (Rgb::ZERO, None)
        };
        let [coat, coat_edge] = material.coat_mirror;
        let mirror = if coat_edge > 0.0 && interface.is_none() {
            // Of what it lets through, what is below mirrors its share.
            let coat = schlick_to(Rgb::splat(coat), coat_edge, cos_view);
            coat + (Rgb::ONE - coat) * mirror
        } else {
            mirror
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
        self.pixels[usize::from(path.pixel)] += light;
    }

    /// Adds what the surface sends out by itself and of the ambient light, and has the other lights look at it. `body` is the share that is
    /// not mirrored.
    #[inline(always)]
    fn lights(&mut self, surface: &Surface<'_>, number: usize, here: &Path, body: Rgb) {
        let material = surface.material;
        let diffuse = here.weight * (body * surface.diffuse);
        let ambient = material.ambient * self.frame.lights.ambient;
        self.add(here, here.weight * material.emission + ambient * diffuse);
        if !material.shiny && diffuse == Rgb::ZERO {
            return;
        }
        let point = LitPoint {
            pixel: here.pixel.into(),
            diffuse,
            specular: here.weight * material.specular,
            shininess: if material.shiny { Some(material.shininess) } else { None },
        };
        self.direct.light(number, point);
    }

    /// Follows the light that comes through holes in the surface, if it is worth a ray. That is no step of the path, but there is an end to it too.
    #[inline(always)]
    fn go_straight(
        &mut self,
        surface: &Surface<'_>,
        direction: Vec3,
        here: &Path,
        absorption: Rgb,
    ) {
        let weight = (1.0 - surface.material.opacity) * here.weight;
        if weight.max_element() < self.frame.options.cutoff {
            return;
        }
        self.counts.refraction += 1;
        let next = Path { weight, absorption, holes: here.holes + 1, ..*here };
        self.followers.straight.push(surface.point.spawn(direction), next);
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
        self.followers.mirrored.push(Ray::new(origin, surface.mirrored(direction)), next);
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
        self.followers.refracted.push(surface.point.spawn(direction), next);
    }

    /// The path after one more bounce that keeps `share` of the light; `None` if that is one too many or too weak to see.
    #[inline(always)]
    fn next(&self, here: &Path, share: Rgb, absorption: Rgb) -> Option<Path> {
        let weight = here.weight * share;
        let goes_on = self.goes_on && weight.max_element() >= self.frame.options.cutoff;
        goes_on.then_some(Path { weight, absorption, ..*here })
    }
}

/// Behind so many holes one after the other everything counts as whole.
const MOST_HOLES: u16 = 256;

/// The index of refraction on the ray's side over the one on the other.
#[inline(always)]
fn eta(surface: &Surface<'_>) -> f32 {
    if surface.outside { 1.0 / surface.material.ior } else { surface.material.ior }
}
