//! Opaque surfaces without layers, those of a wave, in columns: what most surfaces of most scenes are, computed with vectors.

use super::albedo::{Albedo, AlbedoTable};
use super::frame::cosine_hemisphere;
use super::mirrored_body::{Answer, Ingredients, MirroredBody, Sharing};
use super::opaque::OpaqueSurface;
use super::stack::Shares;
use crate::wave::WAVE;
use crate::wave::columns::{Column, Columns, ZERO, get, set, whole_vectors};

/// Surfaces looked at from a direction each.
pub(crate) struct MirroredBodies {
    wos: Columns,
    bases: Columns,
    metallic: Column,
    reflectances: Columns,
    mirrors: Column,
    alphas: Column,
    bodies: Columns,
    multiples_above: Columns,
    multiples: Columns,
    lost: Column,
    lost_in_all: Column,
    mirror_shares: Column,
    even_shares: Column,
    /// The albedos of the mirrors: at the angle of a direction, and in the mean.
    albedos: [Column; 2],
    means: [Column; 2],
}

/// What surfaces do with light from a direction each.
pub(crate) struct Answers {
    /// What comes back, times the cosine.
    pub(crate) light: Columns,
    /// How likely the directions are chosen, by solid angle.
    pub(crate) densities: Column,
}

impl Default for Answers {
    fn default() -> Self {
        Self { light: ZERO, densities: [0.0; WAVE] }
    }
}

impl Default for MirroredBodies {
    fn default() -> Self {
        let (zero, none) = ([0.0; WAVE], [[0.0; WAVE]; 2]);
        Self {
            wos: ZERO,
            bases: ZERO,
            metallic: zero,
            reflectances: ZERO,
            mirrors: zero,
            alphas: zero,
            bodies: ZERO,
            multiples_above: ZERO,
            multiples: ZERO,
            lost: zero,
            lost_in_all: zero,
            mirror_shares: zero,
            even_shares: zero,
            albedos: none,
            means: none,
        }
    }
}

impl MirroredBodies {
    /// Tells what a surface is made of; layers are passed over.
    #[inline(always)]
    pub(crate) fn set(&mut self, number: usize, surface: &OpaqueSurface) {
        let Ingredients { base, metallic, reflectance, mirrors, alpha } = surface.ingredients();
        set(&mut self.bases, number, base);
        set(&mut self.reflectances, number, reflectance);
        self.metallic[number] = metallic;
        self.mirrors[number] = mirrors;
        self.alphas[number] = alpha;
    }

    /// Looks at the first `count` surfaces from these directions, in their frames.
    #[inline(always)]
    pub(crate) fn look_from(&mut self, wos: &Columns, count: usize) {
        let count = whole_vectors(count);
        let table = AlbedoTable::get();
        for number in 0..count {
            let mean = table.of_roughness(self.alphas[number]).mean();
            (self.means[0][number], self.means[1][number]) = (mean.white, mean.grazing);
        }
        self.look_up(wos, count);
        for number in 0..count {
            let bare_mean = albedo(&self.means, number);
            let sharing = Sharing {
                seen: bare(albedo(&self.albedos, number)),
                mean: bare(bare_mean),
                bare_mean,
                layers: [0.0; 2],
                least_lost: Shares::LEAST_LOST,
            };
            let made_of = self.made_of(number);
            let (found, _) = MirroredBody::new(made_of, get(wos, number), &sharing);
            set(&mut self.wos, number, found.wo);
            set(&mut self.bodies, number, found.body);
            set(&mut self.multiples_above, number, found.multiple_above);
            set(&mut self.multiples, number, found.multiple);
            self.lost[number] = found.lost;
            self.lost_in_all[number] = found.lost_in_all;
            self.mirror_shares[number] = found.mirror_share;
            self.even_shares[number] = found.even_share;
        }
    }

    /// What comes back of light from these directions, and how likely each is chosen.
    #[inline(always)]
    pub(crate) fn answer(&mut self, wis: &Columns, count: usize, answers: &mut Answers) {
        let count = whole_vectors(count);
        self.look_up(wis, count);
        for number in 0..count {
            let from = bare(albedo(&self.albedos, number));
            let Answer { light, density } = self.get(number).answer(get(wis, number), from, 1.0);
            set(&mut answers.light, number, light);
            answers.densities[number] = density;
        }
    }

    /// Chooses where light comes from: the first of `choices` which part of the surface, `u` where from. Light that counts nothing may come from there.
    #[inline(always)]
    pub(crate) fn choose(
        &self,
        choices: &[Column; 2],
        u: &[Column; 2],
        count: usize,
        wis: &mut Columns,
    ) {
        for number in 0..whole_vectors(count) {
            let body = self.get(number);
            let u = [u[0][number], u[1][number]];
            let (mirrored, even) = (body.mirrored(u), cosine_hemisphere(u));
            let is_mirrored = choices[0][number] < body.mirror_share;
            set(wis, number, if is_mirrored { mirrored } else { even });
        }
    }

    /// A surface by itself.
    #[inline(always)]
    pub(crate) fn get(&self, number: usize) -> MirroredBody {
        MirroredBody {
            wo: get(&self.wos, number),
            made_of: self.made_of(number),
            body: get(&self.bodies, number),
            multiple_above: get(&self.multiples_above, number),
            multiple: get(&self.multiples, number),
            lost: self.lost[number],
            lost_in_all: self.lost_in_all[number],
            mirror_share: self.mirror_shares[number],
            even_share: self.even_shares[number],
        }
    }

    #[inline(always)]
    fn made_of(&self, number: usize) -> Ingredients {
        Ingredients {
            base: get(&self.bases, number),
            metallic: self.metallic[number],
            reflectance: get(&self.reflectances, number),
            mirrors: self.mirrors[number],
            alpha: self.alphas[number],
        }
    }

    /// Looks up the albedos of the mirrors at the angles of directions.
    #[inline(always)]
    fn look_up(&mut self, directions: &Columns, count: usize) {
        let table = AlbedoTable::get();
        for number in 0..count {
            let albedos = table.of_roughness(self.alphas[number]);
            let found = albedos.at(get(directions, number).z);
            (self.albedos[0][number], self.albedos[1][number]) = (found.white, found.grazing);
        }
    }
}

#[inline(always)]
fn albedo([white, grazing]: &[Column; 2], number: usize) -> Albedo {
    Albedo { white: white[number], grazing: grazing[number] }
}

/// What a mirror without layers sends.
#[inline(always)]
fn bare(mirror: Albedo) -> Shares {
    Shares { layers: 0.0, mirror }
}
