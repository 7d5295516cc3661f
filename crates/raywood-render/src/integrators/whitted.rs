//! Whitted's ray tracing: Turner Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980.
//!
//! Each hit is lit by every light that a shadow ray reaches, and followed further where the surface mirrors or lets light
//! through. Light from all other directions is what the ambient light says.

use raywood::Ray;
use raywood_scene::Rgb;

use super::{Frame, Integrator, sample_pixels};
use crate::fresnel::{Interface, dielectric, refract, schlick};
use crate::lights::illuminate;
use crate::shading::{Surface, keep_on_side};
use crate::shadows::{transmittance, visibility};
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePixels};

/// The registry's line for this method.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "whitted",
    help: "direct light with sharp shadows, mirror reflection and refraction (Whitted 1980)",
    render_tile,
};

fn render_tile(frame: &Frame<'_>, tile: &Tile, pixels: &mut TilePixels) -> RayCounts {
    let mut tracer = Tracer { frame, counts: RayCounts::default() };
    sample_pixels(frame, tile, pixels, |ray| {
        tracer.counts.primary += 1;
        tracer.radiance(ray, &Path::FROM_EYE)
    });
    tracer.counts
}

/// What the recursion hands down: how the ray came here.
struct Path {
    /// Reflections and refractions so far.
    depth: u32,
    /// What light along the ray counts in the pixel.
    weight: Rgb,
    /// Absorption of what the ray runs through, per unit of length.
    absorption: Rgb,
}

impl Path {
    /// A primary ray, in air. (An eye inside glass is noticed when the ray leaves it.)
    const FROM_EYE: Self = Self { depth: 0, weight: Rgb::ONE, absorption: Rgb::ZERO };
}

struct Tracer<'a> {
    frame: &'a Frame<'a>,
    counts: RayCounts,
}

impl Tracer<'_> {
    /// The light that comes back along a ray (its direction is of unit length).
    fn radiance(&mut self, ray: &Ray, path: &Path) -> Rgb {
        let frame = self.frame;
        let Some(hit) = frame.scene.structure().intersect(ray) else {
            return frame.scene.background(ray.direction);
        };
        let surface = Surface::new(frame.scene, ray, &hit);
        let material = surface.material;

        // Absorb on the way. From the inside of a surface the way led through its material, whatever came before.
        let absorption = if !surface.outside && material.transmissive {
            material.absorption
        } else {
            path.absorption
        };
        let passed = transmittance(absorption, hit.t);
        let here = Path { depth: path.depth, weight: path.weight * passed, absorption };

        // Share out the light between mirror and body.
        let cos_view = surface.cos_towards(ray.direction);
        let (mirror, interface) = if material.transmissive {
            let interface = self.interface(&surface, cos_view);
            (Rgb::splat(interface.reflectance), Some(interface))
        } else if material.mirrors {
            (schlick(material.mirror, cos_view), None)
        } else {
            (Rgb::ZERO, None)
        };
        let body = Rgb::ONE - mirror;

        let mut light = material.emission + self.direct_light(&surface, ray, body);
        if mirror != Rgb::ZERO {
            light += self.reflected(&surface, ray, &here, mirror);
        }
        if let Some(interface) = interface {
            light += self.refracted(&surface, ray, &here, interface);
        }
        passed * light
    }

    /// What the surface sends back of the lights that reach it. `body` is the share that is not mirrored.
    fn direct_light(&mut self, surface: &Surface<'_>, ray: &Ray, body: Rgb) -> Rgb {
        let frame = self.frame;
        let diffuse = body * surface.diffuse;
        let mut sum = frame.lights.ambient * diffuse;
        let shiny = surface.material.shiny;
        if !shiny && diffuse == Rgb::ZERO {
            return sum;
        }
        for light in &frame.lights.directed {
            let Some(at_point) = illuminate(light, surface.point.position) else { continue };
            let cosine = surface.light_cosine(at_point.direction);
            if cosine <= 0.0 {
                continue;
            }

            // Lambert's law, and Blinn's highlight (1977) around the direction halfway to the eye.
            let mut response = diffuse;
            if shiny {
                let halfway = (at_point.direction - ray.direction).normalize_or_zero();
                let aligned = halfway.dot(surface.normal).max(0.0);
                response += aligned.powf(surface.material.shininess) * surface.material.specular;
            }
            let visible = visibility(
                frame.scene,
                &surface.point,
                &at_point,
                frame.options.opaque_shadows,
                frame.options.cutoff,
                &mut self.counts,
            );
            sum += cosine * response * at_point.intensity * visible;
        }
        sum
    }

    /// The boundary that a ray meets at a transmissive surface.
    fn interface(&self, surface: &Surface<'_>, cos_view: f32) -> Interface {
        dielectric(cos_view, eta(surface))
    }

    /// The light that the surface mirrors, if it is worth a ray.
    fn reflected(&mut self, surface: &Surface<'_>, ray: &Ray, here: &Path, mirror: Rgb) -> Rgb {
        let Some(next) = self.next(here, mirror, here.absorption) else { return Rgb::ZERO };
        self.counts.reflection += 1;
        let direction = surface.mirrored(ray.direction);
        mirror * self.radiance(&surface.point.spawn(direction), &next)
    }

    /// The light that the surface lets through, if it is worth a ray.
    fn refracted(
        &mut self,
        surface: &Surface<'_>,
        ray: &Ray,
        here: &Path,
        interface: Interface,
    ) -> Rgb {
        let share = (1.0 - interface.reflectance) * surface.material.transmission;
        let absorption = if surface.outside { surface.material.absorption } else { Rgb::ZERO };
        let Some(next) = self.next(here, share, absorption) else { return Rgb::ZERO };
        self.counts.refraction += 1;
        // Thin surfaces let rays straight on, whatever the normals say.
        let direction = if surface.material.ior == 1.0 {
            ray.direction
        } else {
            let bent =
                refract(ray.direction, surface.normal, eta(surface), interface.cos_transmitted);
            keep_on_side(bent.normalize_or_zero(), -surface.geometric_normal)
        };
        share * self.radiance(&surface.point.spawn(direction), &next)
    }

    /// The path after one more bounce that keeps `share` of the light; `None` if that is one too many, too weak to see,
    /// or the rendering is being stopped.
    fn next(&self, here: &Path, share: Rgb, absorption: Rgb) -> Option<Path> {
        let weight = here.weight * share;
        let options = self.frame.options;
        let goes_on = here.depth < options.max_depth
            && weight.max_element() >= options.cutoff
            && !self.frame.progress.is_cancelled();
        goes_on.then_some(Path { depth: here.depth + 1, weight, absorption })
    }
}

/// The index of refraction on the ray's side over the one on the other.
fn eta(surface: &Surface<'_>) -> f32 {
    if surface.outside { 1.0 / surface.material.ior } else { surface.material.ior }
}
