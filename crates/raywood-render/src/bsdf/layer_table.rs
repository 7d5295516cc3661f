//! How much light a layer over a surface sends back in all, and how much the mirror below it: tables of the integrals that have no closed form.

use std::sync::LazyLock;

use raywood::Vec3;

use super::albedo::{
    Albedo, AlbedoTable, COSINES, FACETS, ROUGHNESSES, Row, alpha_of, between, facets,
};
use super::charlie::Charlie;
use super::layer::COAT_REFLECTANCE;

/// All of one kind of layer.
#[derive(Debug)]
pub(crate) struct LayerTable {
    /// For each roughness of the layer.
    own: Vec<OwnRow>,
    /// For each roughness of the layer one for each of the mirror below.
    below: Vec<BelowRow>,
}

/// The share of light that a layer sends back, by the cosine of the angle of view, and its mean.
#[derive(Debug)]
struct OwnRow {
    columns: Row<f32>,
    mean: f32,
}

/// What a mirror below a layer sends back through it: by the cosine of the angle of view, before the layer takes its share on that side, and the mean of all after that.
#[derive(Debug)]
struct BelowRow {
    columns: Row<Albedo>,
    mean: Albedo,
}

/// What is known of a layer of some roughness over a mirror of some other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerRows {
    table: &'static LayerTable,
    /// The rows of the next smoother layer and the next smoother mirror, and the shares of the rougher ones.
    layer: (usize, f32),
    mirror: (usize, f32),
    /// See [`exponent`].
    exponent: f32,
}

/// That of clear coats, and that of sheen; made when they are first asked for, in about a tenth of a second.
pub(crate) static COAT: LazyLock<LayerTable> = LazyLock::new(|| {
    LayerTable::new(|alpha, cosine| {
        AlbedoTable::get().of_roughness(alpha).at(cosine).of(Vec3::splat(COAT_REFLECTANCE)).x
    })
});
pub(crate) static SHEEN: LazyLock<LayerTable> = LazyLock::new(|| LayerTable::new(sheen));

impl LayerRows {
    pub(crate) fn new(table: &'static LayerTable, alpha: f32, alpha_below: f32) -> Self {
        let place = |alpha: f32| between(alpha.sqrt(), ROUGHNESSES);
        let exponent = exponent(alpha_below);
        Self { table, layer: place(alpha), mirror: place(alpha_below), exponent }
    }

    /// The share of light from a direction of this cosine that the layer sends back.
    #[inline]
    pub(crate) fn own(&self, cosine: f32) -> f32 {
        let at = |row: usize| own_at(&self.table.own[row].columns, cosine);
        blend(self.layer, at)
    }

    /// What the mirror below sends back through the layer towards a direction of this cosine, of light from all around.
    #[inline]
    pub(crate) fn below(&self, cosine: f32) -> Albedo {
        let at = |row: usize| below_at(&self.table.below[row].columns, cosine);
        self.blend_below(at).times(self.leaves(cosine))
    }

    /// The factor that the layer leaves of what the mirror sends to, or gets from, a direction of this cosine.
    #[inline]
    pub(crate) fn leaves(&self, cosine: f32) -> f32 {
        let_through(self.own(cosine), self.exponent)
    }

    /// The means over all directions of both.
    #[inline]
    pub(crate) fn means(&self) -> (f32, Albedo) {
        let own = blend(self.layer, |row| self.table.own[row].mean);
        (own, self.blend_below(|row| self.table.below[row].mean))
    }

    #[inline]
    fn blend_below(&self, at: impl Fn(usize) -> Albedo) -> Albedo {
        let (layer, layer_share) = self.layer;
        let (mirror, mirror_share) = self.mirror;
        let [smoother, rougher] = [layer, layer + 1].map(|layer| {
            let first = layer * ROUGHNESSES + mirror;
            at(first).blend(at(first + 1), mirror_share)
        });
        smoother.blend(rougher, layer_share)
    }
}

#[inline]
fn blend((row, share): (usize, f32), at: impl Fn(usize) -> f32) -> f32 {
    let (a, b) = (at(row), at(row + 1));
    a + share * (b - a)
}

/// How much a layer that sends back so much leaves of light on its way in or out.
#[inline]
fn let_through(own: f32, exponent: f32) -> f32 {
    (1.0 - own).max(0.0).powf(exponent)
}

/// How often a layer takes its share of light that a mirror below it sends on: on the way in and on the way out, that is once each, but from a smooth mirror once in all, half of that each,
/// for what the layer then sends back down is mirrored again in the same direction. A rough one needs the whole: light from grazing angles, of which the layer leaves little, would come out steeply.
fn exponent(alpha_below: f32) -> f32 {
    const ROUGH: f32 = 0.15;
    0.5 + 0.5 * (alpha_below.sqrt() / ROUGH).min(1.0)
}

/// The cosine of a column: they lie closer towards grazing angles, where most changes.
fn cosine_of(column: usize) -> f32 {
    let root = column as f32 / (COSINES - 1) as f32;
    (root * root).max(1e-4)
}

/// The last column whose cosine is not above one, and the share of the next.
#[inline]
fn column_of(cosine: f32) -> (usize, f32) {
    between(cosine.max(0.0).sqrt(), COSINES)
}

#[inline]
fn own_at(columns: &Row<f32>, cosine: f32) -> f32 {
    let (below, share) = column_of(cosine);
    columns[below] + share * (columns[below + 1] - columns[below])
}

#[inline]
fn below_at(columns: &Row<Albedo>, cosine: f32) -> Albedo {
    let (below, share) = column_of(cosine);
    columns[below].blend(columns[below + 1], share)
}

/// Cosines, and how much each counts in a mean over all directions: several for each column, as what lies between them is used too.
fn cosines() -> impl Iterator<Item = (f32, f32)> {
    const STEPS: usize = 8 * COSINES;
    let cosine = |step: usize| (step as f32 + 0.5) / STEPS as f32;
    (0..STEPS).map(move |step| (cosine(step), 2.0 * cosine(step) / STEPS as f32))
}

impl LayerTable {
    /// `own` tells what a layer of an alpha sends back towards a direction of a cosine.
    fn new(own: impl Fn(f32, f32) -> f32) -> Self {
        let own = (0..ROUGHNESSES).map(|row| {
            let columns = std::array::from_fn(|column| own(alpha_of(row), cosine_of(column)));
            let mean = cosines().map(|(cosine, weight)| weight * own_at(&columns, cosine)).sum();
            OwnRow { columns, mean }
        });
        let own: Vec<OwnRow> = own.collect();
        let through = |layer: usize, mirror: usize, cosine: f32| {
            let alpha = if mirror == 0 { 0.0 } else { alpha_of(mirror) };
            let_through(own_at(&own[layer].columns, cosine), exponent(alpha))
        };

        // Which light facets mirror is the same below all layers.
        let below = (0..ROUGHNESSES).map(|mirror| {
            let mut rows = vec![[Albedo::default(); COSINES]; ROUGHNESSES];
            for column in 0..COSINES {
                mirrored(mirror, column, |cosine, of_facet| {
                    for (layer, row) in rows.iter_mut().enumerate() {
                        row[column] =
                            row[column].plus(of_facet.times(through(layer, mirror, cosine)));
                    }
                });
            }
            rows
        });
        let by_mirror: Vec<_> = below.collect();
        let below = (0..ROUGHNESSES * ROUGHNESSES).map(|number| {
            let (layer, mirror) = (number / ROUGHNESSES, number % ROUGHNESSES);
            let columns = by_mirror[mirror][layer];
            let mean = cosines().fold(Albedo::default(), |sum, (cosine, weight)| {
                let seen = below_at(&columns, cosine).times(through(layer, mirror, cosine));
                sum.plus(seen.times(weight))
            });
            BelowRow { columns, mean }
        });
        Self { below: below.collect(), own }
    }
}

/// Tells of facets of a row, seen at the cosine of a column, at which cosine each mirrors light, and what it adds to the albedo.
fn mirrored(row: usize, column: usize, mut tell: impl FnMut(f32, Albedo)) {
    let cosine = cosine_of(column);
    let wo = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    if row == 0 {
        return tell(wo.z, Albedo { white: 1.0, grazing: (1.0 - wo.z).powi(5) });
    }
    for (cosine, of_facet) in facets(alpha_of(row), wo) {
        tell(cosine, of_facet.times(1.0 / FACETS as f32));
    }
}

/// The share of light that white fibres send back, of light from all around: the mean over a grid of directions, finer towards the horizon, where they are bright.
fn sheen(alpha: f32, cosine: f32) -> f32 {
    const STEPS: u32 = 32;
    let cosine = cosine.max(1e-2);
    let charlie = Charlie::new(alpha);
    let wo = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let place = |step: u32| (step as f32 + 0.5) / STEPS as f32;
    let mut sum = 0.0;
    for row in 0..STEPS {
        let root = place(row);
        let z = root * root;
        let radius = (1.0 - z * z).sqrt();
        for column in 0..STEPS {
            let turn = place(column);
            let (sin, cos) = (std::f32::consts::PI * turn * turn).sin_cos();
            let wi = Vec3::new(radius * cos, radius * sin, z);
            sum += charlie.eval(wo, wi) * 2.0 * root * 2.0 * turn;
        }
    }
    2.0 * std::f32::consts::PI * sum / (STEPS * STEPS) as f32
}
