//! What becomes of a path where it meets a surface, or nothing.

use raywood_scene::Rgb;

use super::direct::Vertex;
use super::picture::Picture;
use super::shadow_rays::ShadowRays;
use super::walks::{Walk, Walked, Walks};
use crate::bsdf::frame::ShadingFrame;
use crate::bsdf::{Bsdf, Density, Substance, straight_share};
use crate::light_sampling::Lit;
use crate::path_samples::PathSamples;
use crate::shading::keep_on_side;
use crate::shadows::transmittance;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePixels};
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;

/// Has paths scatter at what they meet.
pub(super) struct Scatterer<'a> {
    pub(super) picture: &'a Picture<'a>,
    pub(super) tile: &'a Tile,
    pub(super) pixels: &'a mut TilePixels,
    pub(super) counts: &'a mut RayCounts,
    /// Where the rays wait that follow.
    pub(super) waiting: &'a mut Walks,
    pub(super) shadows: &'a mut ShadowRays,
}

/// The decisions of a path where it meets a surface, each with random numbers of its own.
#[derive(Clone, Copy)]
pub(super) enum Decision {
    /// Whether it goes straight on, and whether it ends.
    Straight,
    /// Which part of the surface scatters it, and which light without extent is asked.
    Part,
    Direction,
    /// Which shining surface and which part of the surroundings is asked.
    Light,
    LightPoint,
    Surroundings,
    /// Which colour is followed through glass that parts them.
    Color,
    /// Which part of a round light far away is asked.
    Disc,
}

/// The random numbers of a path where it meets a surface.
#[derive(Clone, Copy)]
pub(super) struct Dice {
    path: PathSamples,
    first: u32,
}

impl Dice {
    #[inline]
    pub(super) fn pair(self, decision: Decision) -> [f32; 2] {
        self.path.pair(self.first + decision as u32)
    }
}

/// Behind so many holes one after the other everything counts as whole.
const MOST_HOLES: u16 = 256;

/// From this depth on paths that bring little may end.
const FIRST_ROULETTE: u16 = 2;

/// The least cosine between the normal for shading and the direction back: at a silhouette an interpolated normal may point away.
const LEAST_COSINE: f32 = 1e-2;

impl Scatterer<'_> {
    /// Adds the light of the surroundings to a path that meets nothing.
    pub(super) fn miss(&mut self, wave: &impl Walked, ray: usize) {
        let walk = wave.walk(ray);
        let scene = self.picture.frame.scene;
        let direction = wave.direction(ray);
        let asked = match &self.picture.environment {
            Some(environment) if walk.density.is_finite() => environment.density(scene, direction),
            _ => 0.0,
        };
        let weight = self.picture.strategy.weight_of_scattering(walk.density, asked);
        self.add(&walk, weight * (walk.weight * scene.background(direction)));
    }

    /// Adds the light that a path finds at a surface, and has it go on.
    pub(super) fn scatter(&mut self, wave: &impl Walked, surfaces: &Surfaces, number: usize) {
        let scene = self.picture.frame.scene;
        let surface = surfaces.get(scene, number);
        let direction = get(&surfaces.directions, number);
        let walk = wave.walk(surfaces.ray(number));
        let material = surface.material;

        // Absorb on the way. From the inside of a surface the way led through its material, whatever came before.
        let absorption = if !surface.outside && material.transmissive {
            material.absorption
        } else {
            walk.absorption
        };
        let distance = surfaces.distance(number);
        let weight = walk.weight * transmittance(absorption, distance);
        let length = walk.length + distance;
        let since = walk.since + distance;
        let mut here = Walk { weight, absorption, length, since, ..walk };

        if material.emission != Rgb::ZERO {
            let cosine = -direction.dot(surface.geometric_normal);
            let lit = Lit { element: surfaces.element(number), distance: since, cosine };
            self.add_emission(&here, material.opacity * material.emission, lit);
        }

        // Go on through what is not there, or does not bend light.
        let place = self.tile.place(u32::from(walk.pixel));
        let seed = self.picture.frame.options.seed;
        let path = PathSamples::seeded(place, walk.sample, seed);
        let first = (u32::from(walk.depth) << 16) | (u32::from(walk.holes) << 4);
        let dice = Dice { path, first };
        let [straight_choice, roulette] = dice.pair(Decision::Straight);
        let straight = straight_share(material);
        let probability = straight.max_element();
        if straight_choice < probability && walk.holes < MOST_HOLES {
            self.counts.refraction += 1;
            let weight = (1.0 / probability) * (weight * straight);
            let next = Walk { weight, holes: walk.holes + 1, absorption: walk.absorption, ..here };
            self.waiting.push(surface.point.spawn(direction), next);
            return;
        }
        (here.holes, here.since) = (0, 0.0);

        // Look at the surface from where the path came.
        let back = -direction;
        let lack = LEAST_COSINE - back.dot(surface.normal);
        let normal = if lack > 0.0 {
            (surface.normal + lack * back).normalize_or_zero()
        } else {
            surface.normal
        };
        let frame = ShadingFrame::around(normal);
        let made_of = surfaces.made_of(scene, number);
        let mut substance = Substance::of(material, surface.diffuse, made_of);
        if material.dispersion > 0.0 && substance.glass_share > 0.0 {
            let channel = here.only_color(dice.pair(Decision::Color)[0]);
            substance.ior = material.iors()[usize::from(channel)];
        }
        let wo = frame.to_local(back);
        let bsdf = Bsdf::new(&substance, wo, surface.outside, &self.picture.glass);

        let goes_on = here.depth < self.picture.frame.options.max_depth as u16;
        let vertex = Vertex { surface: &surface, normal, frame, bsdf: &bsdf, walk: &here, goes_on };
        vertex.ask_lights(self.picture, dice, self.shadows);
        if goes_on {
            self.go_on(&vertex, dice, roulette);
        }
    }

    /// Adds what a surface sends out by itself, weighted by how likely it was to be asked.
    fn add_emission(&mut self, here: &Walk, emission: Rgb, lit: Lit) {
        let asked = match &self.picture.area {
            Some(area) if here.density.is_finite() => area.density(self.picture.frame.scene, lit),
            _ => 0.0,
        };
        let weight = self.picture.strategy.weight_of_scattering(here.density, asked);
        self.add(here, weight * (here.weight * emission));
    }

    /// Chooses where the path goes next, and whether it does.
    fn go_on(&mut self, vertex: &Vertex<'_>, dice: Dice, roulette: f32) {
        let Vertex { surface, frame, bsdf, walk: here, .. } = vertex;
        let [choice, _] = dice.pair(Decision::Part);
        let Some(scattered) = bsdf.sample(choice, dice.pair(Decision::Direction)) else { return };
        let direction = frame.to_world(scattered.wi);
        let is_reflected = scattered.wi.z > 0.0;

        // Keep it on its side of the true surface.
        let side = if is_reflected { surface.geometric_normal } else { -surface.geometric_normal };
        let (direction, share, density) = match scattered.density {
            Density::Mirror => (keep_on_side(direction, side), 1.0, f32::INFINITY),
            Density::Angle(density) => (direction, vertex.bent_share(direction), density),
        };
        let mut weight = share * (here.weight * scattered.weight);

        // Let paths that bring little end, and the others bring more for it.
        if here.depth >= FIRST_ROULETTE {
            let survival = weight.max_element().min(0.95);
            if roulette >= survival {
                return;
            }
            weight = (1.0 / survival) * weight;
        }
        if !(weight.max_element() > 0.0 && weight.is_finite()) {
            return;
        }
        let absorption = match (is_reflected, surface.outside) {
            (true, _) => here.absorption,
            (false, true) => surface.material.absorption,
            (false, false) => Rgb::ZERO,
        };
        let count =
            if is_reflected { &mut self.counts.reflection } else { &mut self.counts.refraction };
        *count += 1;
        let next = Walk { weight, absorption, density, depth: here.depth + 1, ..**here };
        self.waiting.push(surface.point.spawn(direction), next);
    }

    #[inline]
    fn add(&mut self, walk: &Walk, light: Rgb) {
        if light.is_finite() {
            self.pixels[usize::from(walk.pixel)] += light;
        }
    }
}
