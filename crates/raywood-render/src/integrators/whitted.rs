//! Whitted's ray tracing: Turner Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980.
//!
//! Each hit is lit by every light that a shadow ray reaches, and followed further where the surface mirrors or lets light
//! through. Light from all other directions is what the ambient light says.

use raywood::{Hit, Ray};
use raywood_scene::Rgb;

use super::{Frame, Integrator};
use crate::fresnel::{Interface, dielectric, refract, schlick};
use crate::lights::illuminate;
use crate::shading::{Surface, keep_on_side};
use crate::shadows::{Shadow, transmittance, visibility};
use crate::stats::RayCounts;
use crate::tiles::{TILE_SIZE, Tile, TilePixels};

/// The registry's line for this method.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "whitted",
    help: "direct light with sharp shadows, mirror reflection and refraction (Whitted 1980)",
    render_tile,
};

fn render_tile(frame: &Frame<'_>, tile: &Tile, pixels: &mut TilePixels) -> RayCounts {
    let samples = frame.options.samples;
    let mut tracer = Tracer::new(frame, pixels);
    for (row, y) in (tile.y..tile.y + tile.height).enumerate() {
        for (column, x) in (tile.x..tile.x + tile.width).enumerate() {
            let path = Path::from_eye(row * TILE_SIZE as usize + column);
            for ray in frame.camera.pixel_rays(x, y, samples) {
                if frame.progress.is_cancelled() {
                    return tracer.counts;
                }
                tracer.counts.primary += 1;
                tracer.follow(ray, path);
                tracer.trace_while(|waiting| waiting >= WAVE);
            }
        }
    }
    tracer.trace_while(|waiting| waiting > 0);
    let counts = tracer.counts;
    pixels.iter_mut().for_each(|pixel| *pixel = (1.0 / samples as f32) * *pixel);
    counts
}

/// How many rays are traced together. Structures are fastest when they get many at once.
const WAVE: usize = 1024;

/// How a ray came here.
#[derive(Clone, Copy)]
struct Path {
    /// The pixel of the tile that the light ends up in.
    pixel: usize,
    /// Reflections and refractions so far.
    depth: u32,
    /// What light along the ray counts in the pixel.
    weight: Rgb,
    /// Absorption of what the ray runs through, per unit of length.
    absorption: Rgb,
}

impl Path {
    /// A primary ray, in air. (An eye inside glass is noticed when the ray leaves it.)
    fn from_eye(pixel: usize) -> Self {
        Self { pixel, depth: 0, weight: Rgb::ONE, absorption: Rgb::ZERO }
    }
}

/// Follows the rays of a tile, a wave of them at a time, and adds up the light that they bring.
///
/// Rays that follow from others are waiting last and are traced first, so that few are ever waiting, however often light is split.
struct Tracer<'a> {
    frame: &'a Frame<'a>,
    pixels: &'a mut TilePixels,
    counts: RayCounts,
    /// The rays still to be traced, and the paths that they go on.
    waiting: (Vec<Ray>, Vec<Path>),
    /// Those of the current wave, and what they hit.
    wave: (Vec<Ray>, Vec<Path>),
    hits: Vec<Option<Hit>>,
    /// Rays towards lights, and the pixel and what the light adds to it if nothing is in the way.
    shadows: (Vec<Ray>, Vec<(usize, Rgb)>),
    blocked: Vec<bool>,
}

impl<'a> Tracer<'a> {
    fn new(frame: &'a Frame<'a>, pixels: &'a mut TilePixels) -> Self {
        Self {
            frame,
            pixels,
            counts: RayCounts::default(),
            waiting: Default::default(),
            wave: Default::default(),
            hits: Vec::new(),
            shadows: Default::default(),
            blocked: Vec::new(),
        }
    }

    /// Has a ray (its direction is of unit length) wait for its turn.
    fn follow(&mut self, ray: Ray, path: Path) {
        self.waiting.0.push(ray);
        self.waiting.1.push(path);
    }

    /// Traces wave after wave as long as the number of waiting rays asks for it and the rendering is not being stopped.
    fn trace_while(&mut self, goes_on: impl Fn(usize) -> bool) {
        while goes_on(self.waiting.0.len()) {
            if self.frame.progress.is_cancelled() {
                return;
            }
            self.trace_wave();
        }
    }

    /// Traces the rays that wait last, and then all shadow rays from what they hit.
    fn trace_wave(&mut self) {
        let structure = self.frame.scene.structure();
        let start = self.waiting.0.len().saturating_sub(WAVE);
        let (mut rays, mut paths) = std::mem::take(&mut self.wave);
        rays.clear();
        paths.clear();
        rays.extend(self.waiting.0.drain(start..));
        paths.extend(self.waiting.1.drain(start..));
        let mut hits = std::mem::take(&mut self.hits);
        hits.resize(rays.len(), None);
        structure.intersect_batch_serial(&rays, &mut hits);
        for ((ray, path), hit) in rays.iter().zip(&paths).zip(&hits) {
            self.shade(ray, path, hit.as_ref());
        }
        (self.wave, self.hits) = ((rays, paths), hits);

        let (shadow_rays, light) = &mut self.shadows;
        self.blocked.resize(shadow_rays.len(), false);
        structure.occluded_batch_serial(shadow_rays, &mut self.blocked);
        for (&(pixel, light), _) in
            light.iter().zip(&self.blocked).filter(|(_, blocked)| !**blocked)
        {
            self.pixels[pixel] += light;
        }
        shadow_rays.clear();
        light.clear();
    }

    /// Adds the light that comes back along a ray from what it hit, and sends further rays.
    fn shade(&mut self, ray: &Ray, path: &Path, hit: Option<&Hit>) {
        let frame = self.frame;
        let Some(hit) = hit else {
            self.pixels[path.pixel] += path.weight * frame.scene.background(ray.direction);
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

        self.pixels[path.pixel] += here.weight * material.emission;
        self.direct_light(&surface, ray, &here, Rgb::ONE - mirror);
        if mirror != Rgb::ZERO {
            self.reflect(&surface, ray, &here, mirror);
        }
        if let Some(interface) = interface {
            self.refract(&surface, ray, &here, interface);
        }
    }

    /// Adds what the surface sends back of the lights that reach it, or sends a ray to find out whether they do. `body` is the share that is
    /// not mirrored.
    fn direct_light(&mut self, surface: &Surface<'_>, ray: &Ray, here: &Path, body: Rgb) {
        let frame = self.frame;
        let diffuse = body * surface.diffuse;
        self.pixels[here.pixel] += here.weight * frame.lights.ambient * diffuse;
        let shiny = surface.material.shiny;
        if !shiny && diffuse == Rgb::ZERO {
            return;
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
            let light = here.weight * (cosine * response * at_point.intensity);
            let options = frame.options;
            match Shadow::of(frame.scene, &surface.point, &at_point, options.opaque_shadows) {
                Shadow::Plain(ray) => {
                    self.counts.shadow += 1;
                    self.shadows.0.push(ray);
                    self.shadows.1.push((here.pixel, light));
                }
                Shadow::Coloured(ray) => {
                    let counts = &mut self.counts;
                    let share = visibility(frame.scene, ray, &at_point, options.cutoff, counts);
                    self.pixels[here.pixel] += light * share;
                }
            }
        }
    }

    /// Follows the light that the surface mirrors, if it is worth a ray.
    fn reflect(&mut self, surface: &Surface<'_>, ray: &Ray, here: &Path, mirror: Rgb) {
        let Some(next) = self.next(here, mirror, here.absorption) else { return };
        self.counts.reflection += 1;
        let direction = surface.mirrored(ray.direction);
        self.follow(surface.point.spawn(direction), next);
    }

    /// Follows the light that the surface lets through, if it is worth a ray.
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
        self.follow(surface.point.spawn(direction), next);
    }

    /// The path after one more bounce that keeps `share` of the light; `None` if that is one too many or too weak to see.
    fn next(&self, here: &Path, share: Rgb, absorption: Rgb) -> Option<Path> {
        let weight = here.weight * share;
        let options = self.frame.options;
        let goes_on = here.depth < options.max_depth && weight.max_element() >= options.cutoff;
        goes_on.then_some(Path { depth: here.depth + 1, weight, absorption, ..*here })
    }
}

/// The index of refraction on the ray's side over the one on the other.
fn eta(surface: &Surface<'_>) -> f32 {
    if surface.outside { 1.0 / surface.material.ior } else { surface.material.ior }
}
