//! What becomes of paths where they meet surfaces, or nothing.

use raywood::Vectorized;
use raywood_scene::Rgb;

use super::dice::{Decision, Dice, Pairs, pair_of};
use super::direct::brings;
use super::picture::Picture;
use super::vertices::{Scattering, Vertices};
use super::walks::{Walk, Walked, Walks};
use crate::bsdf::{Answers, Substance, straight_share};
use crate::light_sampling::Lit;
use crate::shading::keep_on_side;
use crate::shadows::transmittance;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePixels};
use crate::wave::WAVE;
use crate::wave::columns::{Columns, ZERO, get, set, whole_vectors};
use crate::wave::surfaces::Surfaces;

/// Behind so many holes one after the other everything counts as whole.
const MOST_HOLES: u16 = 256;

/// From this depth on paths that bring little may end.
const FIRST_ROULETTE: u16 = 2;

/// Where the light and the rays of paths go.
pub(super) struct Outlets<'a> {
    pub(super) picture: &'a Picture<'a>,
    pub(super) pixels: &'a mut TilePixels,
    pub(super) counts: &'a mut RayCounts,
    /// Where the rays wait that follow.
    pub(super) waiting: &'a mut Walks,
}

/// Has the paths of a wave arrive at the surfaces that they met: adds the light that these send out by themselves, lets through what goes straight on, and finds out
/// what the others scatter at.
pub(super) struct Arrive<'a, 'b, W> {
    pub(super) outlets: &'b mut Outlets<'a>,
    pub(super) tile: &'b Tile,
    pub(super) wave: &'b W,
    pub(super) surfaces: &'b Surfaces,
    pub(super) vertices: &'b mut Vertices,
    pub(super) dice: &'b mut Dice,
    /// Memory for random numbers.
    pub(super) pairs: &'b mut Pairs,
}

impl<W: Walked> Vectorized for Arrive<'_, '_, W> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let Self { tile, wave, surfaces, vertices, dice, pairs, .. } = &mut self;
        let count = surfaces.count();
        vertices.clear();
        for number in 0..count {
            let walk = wave.walk(surfaces.ray(number));
            dice.set(number, tile.place(u32::from(walk.pixel)), &walk);
        }
        dice.roll(Decision::Straight, count, pairs);
        for number in 0..count {
            self.arrive(number);
        }
        self.vertices.look_back(self.surfaces, &self.outlets.picture.glass);
    }
}

impl<W: Walked> Arrive<'_, '_, W> {
    #[inline(always)]
    fn arrive(&mut self, number: usize) {
        let Self { outlets, wave, surfaces, vertices, dice, pairs, .. } = self;
        let scene = outlets.picture.frame.scene;
        let material = surfaces.material(scene, number);
        let walk = wave.walk(surfaces.ray(number));

        // Absorb on the way. From the inside of a surface the way led through its material, whatever came before.
        let absorption = if material.transmissive && !surfaces.outside(number) {
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
            let direction = get(&surfaces.directions, number);
            let cosine = -direction.dot(get(&surfaces.geometric_normals, number));
            let (element, time) = (surfaces.element(number), walk.time);
            let lit = Lit { element, time, distance: since, cosine };
            outlets.add_emission(&here, material.opacity * material.emission, lit);
        }

        // Go on through what is not there, or does not bend light.
        let straight = straight_share(material);
        let probability = straight.max_element();
        if pairs[0][number] < probability && walk.holes < MOST_HOLES {
            outlets.counts.refraction += 1;
            let weight = (1.0 / probability) * (weight * straight);
            let next = Walk { weight, holes: walk.holes + 1, absorption: walk.absorption, ..here };
            let direction = get(&surfaces.directions, number);
            outlets.waiting.push(surfaces.point(number).spawn(direction), next);
            vertices.pass(here);
            return;
        }
        (here.holes, here.since) = (0, 0.0);

        let made_of = surfaces.made_of(scene, number);
        let mut substance = Substance::of(material, get(&surfaces.diffuse, number), made_of);
        if material.dispersion > 0.0 && substance.glass_share > 0.0 {
            let channel = here.only_color(dice.pair(number, Decision::Color)[0]);
            substance.ior = material.iors()[usize::from(channel)];
        }
        let goes_on = here.depth < outlets.picture.frame.options.max_depth as u16;
        vertices.scatter(here, &substance, goes_on);
    }
}

/// Chooses where the paths of a wave go next, and whether they do.
pub(super) struct GoOn<'a, 'b> {
    pub(super) outlets: &'b mut Outlets<'a>,
    pub(super) surfaces: &'b Surfaces,
    pub(super) vertices: &'b mut Vertices,
    pub(super) dice: &'b Dice,
    /// Of the decision whether a path goes straight on, whose second numbers are left.
    pub(super) straight: &'b Pairs,
    pub(super) memory: &'b mut GoOnMemory,
}

/// Memory for choosing where paths go.
pub(super) struct GoOnMemory {
    choices: Pairs,
    u: Pairs,
    scattering: Scattering,
    answers: Answers,
    /// Where they go, in the world.
    directions: Columns,
}

impl Default for GoOnMemory {
    fn default() -> Self {
        let none = [[0.0; WAVE]; 2];
        Self {
            choices: none,
            u: none,
            scattering: Scattering::default(),
            answers: Answers::default(),
            directions: ZERO,
        }
    }
}

impl Vectorized for GoOn<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { outlets, surfaces, vertices, dice, straight, memory } = self;
        let GoOnMemory { choices, u, scattering, answers, directions } = memory;
        let count = surfaces.count();
        dice.roll(Decision::Part, count, choices);
        dice.roll(Decision::Direction, count, u);
        vertices.choose(choices, u, count, answers, scattering);

        // Light from the other side of the true surface does not count; perfect mirrors are kept on theirs.
        for number in 0..whole_vectors(count) {
            let direction = vertices.frame(number).to_world(get(&scattering.wis, number));
            let geometric = get(&surfaces.geometric_normals, number);
            let share = vertices.bent_share(number, geometric, direction);
            let share = if scattering.densities[number] == f32::INFINITY { 1.0 } else { share };
            let weight =
                share * (get(&vertices.weights, number) * get(&scattering.weights, number));
            set(directions, number, direction);
            set(&mut scattering.weights, number, weight);
        }

        for number in 0..count {
            let mut weight = get(&scattering.weights, number);
            let lives = (vertices.scatters[number] > 0.0) & (vertices.goes_on[number] > 0.0);
            if !(lives & brings(weight)) {
                continue;
            }
            let here = vertices.walks[number];
            // Let paths that bring little end, and the others bring more for it.
            if here.depth >= FIRST_ROULETTE {
                let survival = weight.max_element().min(0.95);
                if pair_of(straight, number)[1] >= survival {
                    continue;
                }
                weight = (1.0 / survival) * weight;
            }
            let is_reflected = scattering.wis[2][number] > 0.0;
            let mut direction = get(directions, number);
            if scattering.densities[number] == f32::INFINITY {
                let geometric = get(&surfaces.geometric_normals, number);
                direction =
                    keep_on_side(direction, if is_reflected { geometric } else { -geometric });
            }
            let material = surfaces.material(outlets.picture.frame.scene, number);
            let absorption = match (is_reflected, surfaces.outside(number)) {
                (true, _) => here.absorption,
                (false, true) => material.absorption,
                (false, false) => Rgb::ZERO,
            };
            let counts = &mut *outlets.counts;
            let counter =
                if is_reflected { &mut counts.reflection } else { &mut counts.refraction };
            *counter += 1;
            let density = scattering.densities[number];
            let next = Walk { weight, absorption, density, depth: here.depth + 1, ..here };
            outlets.waiting.push(surfaces.point(number).spawn(direction), next);
        }
    }
}

impl Outlets<'_> {
    /// Adds the light of the surroundings to a path that meets nothing.
    #[inline(always)]
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

    /// Adds what a surface sends out by itself, weighted by how likely it was to be asked.
    fn add_emission(&mut self, here: &Walk, emission: Rgb, lit: Lit) {
        let asked = match &self.picture.area {
            Some(area) if here.density.is_finite() => area.density(self.picture.frame.scene, lit),
            _ => 0.0,
        };
        let weight = self.picture.strategy.weight_of_scattering(here.density, asked);
        self.add(here, weight * (here.weight * emission));
    }

    #[inline(always)]
    fn add(&mut self, walk: &Walk, light: Rgb) {
        if light.is_finite() {
            self.pixels[usize::from(walk.pixel)] += light;
        }
    }
}
