//! How much light the facets of rough glass lose into each other: a table for each index of refraction.

use super::albedo::{COSINES, FACETS, ROUGHNESSES, Row, alpha_of, between, direction, mean};
use super::ggx::Ggx;
use crate::fresnel::{dielectric, refract};
use crate::path_samples::PathSamples;

/// The light lost on both sides of a boundary.
#[derive(Clone, Debug)]
pub(crate) struct GlassTable {
    /// The index of refraction inside over the one outside.
    pub(crate) ior: f32,
    /// Outside and inside: a row for each roughness.
    sides: [Vec<LostRow>; 2],
    /// The shares let through of light from all sides, outside and inside.
    through: [f32; 2],
}

/// The share of light lost, by the cosine of the angle of view, and its mean.
#[derive(Clone, Copy, Debug)]
struct LostRow {
    columns: Row<f32>,
    mean: f32,
}

/// One side of a boundary of some roughness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GlassSide {
    columns: Row<f32>,
    /// The mean of the share lost of light from all directions; above zero.
    pub(crate) mean_lost: f32,
    /// Of light lost the share that comes out on the other side.
    pub(crate) through: f32,
}

impl GlassSide {
    /// The share of light that facets lose, from a direction of this cosine.
    #[inline]
    pub(crate) fn lost(&self, cosine: f32) -> f32 {
        let (below, share) = between(cosine, COSINES);
        let (a, b) = (self.columns[below], self.columns[below + 1]);
        a + share * (b - a)
    }

    /// Of light lost the share that comes out on the side of a direction of this height.
    #[inline]
    pub(crate) fn share_of(&self, z: f32) -> f32 {
        if z > 0.0 { 1.0 - self.through } else { self.through }
    }
}

impl GlassTable {
    /// Takes some milliseconds.
    pub(crate) fn new(ior: f32) -> Self {
        let etas = [1.0 / ior, ior];
        let rows = |eta: f32| (0..ROUGHNESSES).map(|row| lost_row(row, eta)).collect();
        Self { ior, sides: etas.map(rows), through: etas.map(mean_through) }
    }

    /// Outside and inside of a boundary of this alpha.
    pub(crate) fn sides(&self, alpha: f32) -> [GlassSide; 2] {
        let (below, share) = between(alpha.sqrt(), ROUGHNESSES);
        let blend = |a: f32, b: f32| a + share * (b - a);
        let side = |rows: &Vec<LostRow>| {
            let (a, b) = (&rows[below], &rows[below + 1]);
            let columns = std::array::from_fn(|i| blend(a.columns[i], b.columns[i]));
            GlassSide { columns, mean_lost: blend(a.mean, b.mean).max(1e-6), through: 0.0 }
        };
        let [mut outer, mut inner] = [side(&self.sides[0]), side(&self.sides[1])];

        // Lost light should come through as other light does. That it may run either way ties both sides together, and neither may let
        // through more than all.
        outer.through = self.through[0];
        inner.through = self.through[1] * outer.mean_lost / inner.mean_lost;
        let most = inner.through.max(1.0);
        outer.through /= most;
        inner.through /= most;
        [outer, inner]
    }
}

/// The share let through of light from all directions of one side.
fn mean_through(eta: f32) -> f32 {
    const STEPS: u32 = 4096;
    let through = |step: u32| {
        let cosine = (step as f32 + 0.5) / STEPS as f32;
        2.0 * cosine * (1.0 - dielectric(cosine, eta).reflectance)
    };
    (0..STEPS).map(through).sum::<f32>() / STEPS as f32
}

fn lost_row(row: usize, eta: f32) -> LostRow {
    let ggx = Ggx { alpha: alpha_of(row) };
    let kept = |column: usize| {
        let wo = direction(column);
        let facet = |index: u32| {
            let h = ggx.sample_visible(wo, PathSamples::seeded([0, 0], index, 0).pair(0));
            let interface = dielectric(wo.dot(h), eta);
            let mirrored = 2.0 * wo.dot(h) * h - wo;
            let bent = refract(-wo, h, eta, interface.cos_transmitted).normalize_or_zero();
            let seen = |share: f32, wi| share * ggx.masking_shadowing(wo, wi) / ggx.masking(wo);
            let mut sum = 0.0;
            if mirrored.z > 0.0 {
                sum += seen(interface.reflectance, mirrored);
            }
            if bent.z < 0.0 {
                sum += seen(1.0 - interface.reflectance, bent);
            }
            sum
        };
        (0..FACETS).map(facet).sum::<f32>() / FACETS as f32
    };
    let columns: Row<f32> = std::array::from_fn(|column| (1.0 - kept(column)).clamp(0.0, 1.0));
    LostRow { columns, mean: mean(&columns) }
}
