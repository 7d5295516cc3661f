//! How much light rough mirrors send back in all: tables of the integrals that have no closed form.
//!
//! What facets mirror into other facets is lost to a model of single scattering; the share that is left tells how much there is to give back
//! (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017).

use std::sync::LazyLock;

use raywood::Vec3;

use super::ggx::Ggx;
use crate::path_samples::PathSamples;

/// Rows and columns of a table: cosines from 0 to 1, and square roots of alpha from 0 to 1.
pub(crate) const COSINES: usize = 32;
pub(crate) const ROUGHNESSES: usize = 32;

/// Below this alpha a surface counts as smooth.
pub(crate) const SMOOTHEST: f32 = 1e-3;

/// Shares of light, by the cosine of the angle of view.
pub(crate) type Row<T> = [T; COSINES];

/// Of light that comes back from a rough mirror: all of it if the facets mirror all, and the part that Schlick's fifth power adds at grazing angles.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Albedo {
    /// Where facets mirror everything.
    pub(crate) white: f32,
    /// Where they mirror `(1 - cosine)^5`.
    pub(crate) grazing: f32,
}

impl Albedo {
    /// Of facets that mirror `f0` straight on, and up to white at grazing angles.
    #[inline(always)]
    pub(crate) fn of(self, f0: Vec3) -> Vec3 {
        (self.white - self.grazing) * f0 + Vec3::splat(self.grazing)
    }

    #[inline(always)]
    pub(crate) fn times(self, factor: f32) -> Self {
        Self { white: factor * self.white, grazing: factor * self.grazing }
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { white: self.white + other.white, grazing: self.grazing + other.grazing }
    }

    #[inline(always)]
    pub(crate) fn blend(self, other: Self, share: f32) -> Self {
        let blend = |a: f32, b: f32| a + share * (b - a);
        Self { white: blend(self.white, other.white), grazing: blend(self.grazing, other.grazing) }
    }
}

/// The albedos of all roughnesses.
#[derive(Debug)]
pub(crate) struct AlbedoTable {
    /// Row after row: one for each roughness, with a column for each cosine.
    albedos: [Albedo; ROUGHNESSES * COSINES],
    /// Of each row the mean over all directions.
    means: [Albedo; ROUGHNESSES],
}

/// The albedos of one roughness, and their mean over all directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Albedos {
    table: &'static AlbedoTable,
    /// The last row that is not rougher, and the share of the next.
    row: usize,
    share: f32,
}

impl AlbedoTable {
    /// The one that there is.
    #[inline(always)]
    pub(crate) fn get() -> &'static Self {
        &TABLE
    }

    /// Those of a surface of this alpha.
    #[inline(always)]
    pub(crate) fn of_roughness(&'static self, alpha: f32) -> Albedos {
        let alpha = if alpha < SMOOTHEST { 0.0 } else { alpha };
        let (row, share) = between(alpha.sqrt(), ROUGHNESSES);
        Albedos { table: self, row, share }
    }
}

impl Albedos {
    /// Seen at an angle of this cosine.
    #[inline(always)]
    pub(crate) fn at(&self, cosine: f32) -> Albedo {
        let (column, share) = between(cosine, COSINES);
        let all = &self.table.albedos;
        let (smoother, rougher) = (self.row * COSINES + column, (self.row + 1) * COSINES + column);
        let a = all[smoother].blend(all[smoother + 1], share);
        let b = all[rougher].blend(all[rougher + 1], share);
        a.blend(b, self.share)
    }

    /// The mean over all directions.
    #[inline(always)]
    pub(crate) fn mean(&self) -> Albedo {
        let means = &self.table.means;
        means[self.row].blend(means[self.row + 1], self.share)
    }
}

/// The last of `count` places from 0 to 1 that is not above a number, and the share of the next.
#[inline(always)]
pub(crate) fn between(number: f32, count: usize) -> (usize, f32) {
    let place = number.clamp(0.0, 1.0) * (count - 1) as f32;
    let below = (place as usize).min(count - 2);
    (below, place - below as f32)
}

/// Twice the integral of `row` times the cosine, over cosines from 0 to 1: the mean over all directions of what is straight between its places.
pub(crate) fn mean(row: &Row<f32>) -> f32 {
    let step = 1.0 / (COSINES - 1) as f32;
    let part = |i: usize| {
        let (a, b) = (i as f32 * step, (i + 1) as f32 * step);
        // Simpson's rule, which is exact for what is straight times what is straight.
        let middle = 0.5 * (row[i] + row[i + 1]) * 0.5 * (a + b);
        step / 6.0 * (row[i] * a + 4.0 * middle + row[i + 1] * b)
    };
    2.0 * (0..COSINES - 1).map(part).sum::<f32>()
}

/// A direction of a cosine, not quite level.
pub(crate) fn direction(column: usize) -> Vec3 {
    let cosine = (column as f32 / (COSINES - 1) as f32).max(1e-4);
    Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

/// The alpha of a row of a table.
pub(crate) fn alpha_of(row: usize) -> f32 {
    let root = row as f32 / (ROUGHNESSES - 1) as f32;
    (root * root).max(SMOOTHEST)
}

/// How many facets stand for all.
pub(crate) const FACETS: u32 = 256;

/// Facets that are seen from `wo`: the cosine of where each mirrors light from, and what comes of that; the mean over all [`FACETS`] is the albedo. Those
/// that mirror other facets are left out.
pub(crate) fn facets(alpha: f32, wo: Vec3) -> impl Iterator<Item = (f32, Albedo)> {
    let ggx = Ggx { alpha };
    (0..FACETS).filter_map(move |index| {
        let h = ggx.sample_visible(wo, PathSamples::seeded([0, 0], index, 0).pair(0));
        let wi = 2.0 * wo.dot(h) * h - wo;
        (wi.z > 0.0).then(|| {
            let white = ggx.masking_shadowing(wo, wi) / ggx.masking(wo);
            let grazing = white * (1.0 - wo.dot(h)).clamp(0.0, 1.0).powi(5);
            (wi.z, Albedo { white, grazing })
        })
    })
}

/// Made when it is first asked for, in some milliseconds.
static TABLE: LazyLock<AlbedoTable> = LazyLock::new(|| {
    let place = |i: usize| albedo(i / COSINES, i % COSINES);
    let albedos: [Albedo; _] = std::array::from_fn(place);
    let mean_of = |row: usize| {
        let at = |column: usize| albedos[row * COSINES + column];
        let white = mean(&std::array::from_fn(|column| at(column).white));
        let grazing = mean(&std::array::from_fn(|column| at(column).grazing));
        Albedo { white, grazing }
    };
    AlbedoTable { albedos, means: std::array::from_fn(mean_of) }
});

/// A number of the table.
fn albedo(row: usize, column: usize) -> Albedo {
    if row == 0 {
        let cosine = column as f32 / (COSINES - 1) as f32;
        return Albedo { white: 1.0, grazing: (1.0 - cosine).powi(5) };
    }
    let sum = facets(alpha_of(row), direction(column))
        .fold(Albedo::default(), |sum, (_, mirrored)| sum.plus(mirrored));
    let share = 1.0 / FACETS as f32;
    Albedo { white: (share * sum.white).min(1.0), grazing: share * sum.grazing }
}
