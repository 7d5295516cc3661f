//! The places where the paths of a wave scatter, in columns: how surfaces answer light is computed with vectors.

use raywood::Vec3;

use super::dice::{Pairs, pair_of};
use super::walks::Walk;
use crate::bsdf::frame::ShadingFrame;
use crate::bsdf::{Answers, Bsdf, Density, GlassTable, MirroredBodies, Substance};
use crate::shading::light_cosine;
use crate::wave::WAVE;
use crate::wave::columns::{Column, Columns, ZERO, get, set, whole_vectors};
use crate::wave::surfaces::Surfaces;

/// The least cosine between the normal for shading and the direction back: at a silhouette an interpolated normal may point away.
const LEAST_COSINE: f32 = 1e-2;

/// The places where the paths of a wave scatter: those of its surfaces, number for number. What does not scatter has columns too, which mean nothing.
pub(super) struct Vertices {
    /// The paths, as they are when they arrive.
    pub(super) walks: Vec<Walk>,
    /// 1 where a path scatters, else 0; and where it may go on after that.
    pub(super) scatters: Column,
    pub(super) goes_on: Column,
    /// What light along the paths counts in their pixels.
    pub(super) weights: Columns,
    /// 1 where light from behind may come through, else 0.
    pub(super) lets_through: Column,
    /// The normals that surfaces are shaded with, the frames around them, and where the paths came from in these.
    normals: Columns,
    frames: [Columns; 2],
    wos: Columns,
    /// Opaque surfaces without layers.
    bodies: MirroredBodies,
    /// The others, with their numbers: what they are, and how they look from where the paths came.
    substances: Vec<(usize, Substance)>,
    others: Vec<(usize, Bsdf)>,
}

/// Where scattered paths go.
pub(super) struct Scattering {
    /// The directions, in the frames of the surfaces.
    pub(super) wis: Columns,
    /// What light from there counts; zero where none does.
    pub(super) weights: Columns,
    /// How likely the directions were, by solid angle; infinite where there was no other.
    pub(super) densities: Column,
}

impl Default for Scattering {
    fn default() -> Self {
        Self { wis: ZERO, weights: ZERO, densities: [0.0; WAVE] }
    }
}

impl Default for Vertices {
    fn default() -> Self {
        let zero = [0.0; WAVE];
        Self {
            walks: Vec::new(),
            scatters: zero,
            goes_on: zero,
            weights: ZERO,
            lets_through: zero,
            normals: ZERO,
            frames: [ZERO; 2],
            wos: ZERO,
            bodies: MirroredBodies::default(),
            substances: Vec::new(),
            others: Vec::new(),
        }
    }
}

impl Vertices {
    /// Forgets all paths.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.walks.clear();
        self.substances.clear();
        self.others.clear();
    }

    /// Has the next path end here, or go straight on.
    #[inline(always)]
    pub(super) fn pass(&mut self, walk: Walk) {
        self.scatters[self.walks.len()] = 0.0;
        self.walks.push(walk);
    }

    /// Has the next path scatter at a surface that is made of this.
    #[inline(always)]
    pub(super) fn scatter(&mut self, walk: Walk, substance: &Substance, goes_on: bool) {
        let number = self.walks.len();
        self.scatters[number] = 1.0;
        self.goes_on[number] = f32::from(u8::from(goes_on));
        self.lets_through[number] = f32::from(u8::from(substance.glass_share > 0.0));
        set(&mut self.weights, number, walk.weight);
        self.walks.push(walk);
        self.bodies.set(number, &substance.opaque);
        if substance.glass_share > 0.0 || !substance.opaque.is_bare() {
            self.substances.push((number, *substance));
        }
    }

    /// Looks at the surfaces from where the paths came.
    #[inline(always)]
    pub(super) fn look_back(&mut self, surfaces: &Surfaces, glass: &[GlassTable]) {
        let count = surfaces.count();
        for number in 0..whole_vectors(count) {
            let back = -get(&surfaces.directions, number);
            let normal = get(&surfaces.normals, number);
            let lack = LEAST_COSINE - back.dot(normal);
            let lifted = normal + lack * back;
            let normal = if lack > 0.0 { lifted / lifted.length() } else { normal };
            let frame = ShadingFrame::around(normal);
            set(&mut self.normals, number, normal);
            set(&mut self.frames[0], number, frame.s);
            set(&mut self.frames[1], number, frame.t);
            set(&mut self.wos, number, frame.to_local(back));
        }
        self.bodies.look_from(&self.wos, count);
        for (number, substance) in &self.substances {
            let wo = get(&self.wos, *number);
            let bsdf = Bsdf::new(substance, wo, surfaces.outside(*number), glass);
            self.others.push((*number, bsdf));
        }
    }

    /// The frame of a surface.
    #[inline(always)]
    pub(super) fn frame(&self, number: usize) -> ShadingFrame {
        let [s, t] = &self.frames;
        let n = get(&self.normals, number);
        ShadingFrame { s: get(s, number), t: get(t, number), n }
    }

    /// How much of light from a direction counts: none where the true surface lies between, and less where the normal for shading would leave the edge of its shadow
    /// jagged: see [`light_cosine`].
    #[inline(always)]
    pub(super) fn bent_share(&self, number: usize, geometric: Vec3, direction: Vec3) -> f32 {
        let normal = get(&self.normals, number);
        let (shading, true_cosine) = (direction.dot(normal), direction.dot(geometric));
        let share = light_cosine(direction, normal, geometric) / shading;
        let is_above = (shading > 0.0) & (true_cosine > 0.0);
        let is_below = (shading < 0.0) & (true_cosine < 0.0);
        let below = if is_below { 1.0 } else { 0.0 };
        if is_above { share } else { below }
    }

    /// What comes back of light from a direction each, and how likely these are chosen; perfect mirrors and what bends at smooth surfaces are left out.
    #[inline(always)]
    pub(super) fn answer(&mut self, wis: &Columns, count: usize, answers: &mut Answers) {
        self.bodies.answer(wis, count, answers);
        for (number, bsdf) in &self.others {
            let wi = get(wis, *number);
            set(&mut answers.light, *number, bsdf.eval(wi));
            answers.densities[*number] = bsdf.density(wi);
        }
    }

    /// Chooses where light comes from, mostly from where much counts: the first of `choices` which part of the surface, `u` where from.
    #[inline(always)]
    pub(super) fn choose(
        &mut self,
        choices: &Pairs,
        u: &Pairs,
        count: usize,
        answers: &mut Answers,
        scattering: &mut Scattering,
    ) {
        self.bodies.choose(choices, u, count, &mut scattering.wis);
        self.bodies.answer(&scattering.wis, count, answers);
        for number in 0..whole_vectors(count) {
            let body = self.bodies.get(number);
            let density = answers.densities[number];
            let light = get(&answers.light, number);
            let rough = if density > 0.0 { 1.0 / density } else { 0.0 } * light;
            let [choice, _] = pair_of(choices, number);
            let is_perfect = (choice < body.mirror_share) & body.is_smooth();
            let perfect = body.perfect_mirror(1.0);
            set(&mut scattering.weights, number, if is_perfect { perfect } else { rough });
            scattering.densities[number] = if is_perfect { f32::INFINITY } else { density };
        }
        for (number, bsdf) in &self.others {
            let [choice, _] = pair_of(choices, *number);
            let scattered = bsdf.sample(choice, pair_of(u, *number));
            let weight = scattered.map_or(Vec3::ZERO, |scattered| scattered.weight);
            set(&mut scattering.weights, *number, weight);
            let Some(scattered) = scattered else { continue };
            set(&mut scattering.wis, *number, scattered.wi);
            scattering.densities[*number] = match scattered.density {
                Density::Angle(density) => density,
                Density::Mirror => f32::INFINITY,
            };
        }
    }
}
