//! Layers over an opaque surface: clear coats, which are rough mirrors, and the sheen of fibres.
//!
//! A layer adds its own light and leaves the rest to what lies below. Of what the mirror there sends on it takes its share on the way in and on the way out, so that light may run either
//! way; the body below gets all that neither sends back, so that nothing is lost at all. The shares are tables, computed for each pair of roughnesses.

use std::f32::consts::FRAC_1_PI;

use raywood::Vec3;
use raywood_scene::{Rgb, luminance};

use super::albedo::{Albedo, SMOOTHEST};
use super::charlie::Charlie;
use super::ggx::Ggx;
use super::layer_table::{COAT, LayerRows, SHEEN};
use crate::fresnel::schlick;
use crate::sines::sin_cos_of_turn;

/// What a clear coat mirrors of light straight on: an index of refraction of 1.5.
pub(crate) const COAT_REFLECTANCE: f32 = 0.04;

/// A clear coat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coat {
    /// The share of the surface that it covers.
    pub(crate) share: f32,
    /// How rough it is.
    pub(crate) alpha: f32,
}

/// The sheen of fibres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheen {
    /// What they send back of what they get, in each colour.
    pub(crate) color: Rgb,
    /// How far they lean.
    pub(crate) alpha: f32,
}

/// A layer of some kind, over a share of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// How much of the surface it covers.
    pub(crate) share: f32,
    /// The colour of its light; the brightest channel is 1.
    color: Rgb,
    kind: Kind,
    rows: LayerRows,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Coat(Ggx),
    Sheen(Charlie),
}

impl Layer {
    /// A clear coat with facets of this alpha, over a mirror with those of another.
    pub(crate) fn coat(share: f32, alpha: f32, alpha_below: f32) -> Self {
        let rows = LayerRows::new(&COAT, alpha, alpha_below);
        Self { share, color: Rgb::ONE, kind: Kind::Coat(Ggx { alpha }), rows }
    }

    /// Fibres that lean by this alpha, over a mirror with facets of another.
    pub(crate) fn sheen(share: f32, color: Rgb, alpha: f32, alpha_below: f32) -> Self {
        let rows = LayerRows::new(&SHEEN, alpha, alpha_below);
        Self { share, color, kind: Kind::Sheen(Charlie::new(alpha)), rows }
    }

    /// How much it sends back in all, where it is, and how much the mirror below.
    #[inline]
    pub(crate) fn shares(&self, cosine: f32) -> (f32, Albedo) {
        (self.rows.own(cosine), self.rows.below(cosine))
    }

    /// The means of these over all directions.
    #[inline]
    pub(crate) fn mean_shares(&self) -> (f32, Albedo) {
        self.rows.means()
    }

    /// The share that is left of what the mirror below sends from one direction to another, where the layer is.
    #[inline]
    pub(crate) fn leaves(&self, cosine: f32, other: f32) -> f32 {
        self.rows.leaves(cosine) * self.rows.leaves(other)
    }

    /// How bright its own light is towards a direction of this cosine.
    pub(crate) fn brightness(&self, cosine: f32) -> f32 {
        self.share * self.rows.own(cosine) * luminance(self.color)
    }

    /// The light that it sends back from `wi` to `wo`, times the cosine there; all but perfect mirrors.
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let light = match self.kind {
            Kind::Coat(ggx) if ggx.alpha < SMOOTHEST => return Rgb::ZERO,
            Kind::Coat(ggx) => {
                let h = (wo + wi).normalize_or_zero();
                let facets = ggx.distribution(h) * ggx.masking_shadowing(wo, wi) / (4.0 * wo.z);
                facets * fresnel(wo.dot(h))
            }
            Kind::Sheen(charlie) => charlie.eval(wo, wi),
        };
        (self.share * light) * self.color
    }

    /// The density of [`sample`](Self::sample) by solid angle; all but perfect mirrors.
    pub(crate) fn density(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self.kind {
            Kind::Coat(ggx) if ggx.alpha < SMOOTHEST => 0.0,
            Kind::Coat(ggx) => {
                let h = (wo + wi).normalize_or_zero();
                ggx.masking(wo) * ggx.distribution(h) / (4.0 * wo.z)
            }
            Kind::Sheen(_) => 0.5 * FRAC_1_PI,
        }
    }

    /// Chooses where light comes from. A perfect mirror tells what that counts.
    pub(crate) fn sample(&self, wo: Vec3, u: [f32; 2]) -> (Vec3, Option<Rgb>) {
        match self.kind {
            Kind::Coat(ggx) if ggx.alpha < SMOOTHEST => {
                let wi = Vec3::new(-wo.x, -wo.y, wo.z);
                (wi, Some((self.share * fresnel(wo.z)) * self.color))
            }
            Kind::Coat(ggx) => {
                let h = ggx.sample_visible(wo, u);
                (2.0 * wo.dot(h) * h - wo, None)
            }
            // From all sides alike: fibres are brightest where the cosine is least.
            Kind::Sheen(_) => {
                let (sin, cos) = sin_cos_of_turn(u[0]);
                let radius = (1.0 - u[1] * u[1]).sqrt();
                (Vec3::new(radius * cos, radius * sin, u[1]), None)
            }
        }
    }
}

/// What a facet of a clear coat mirrors.
#[inline]
fn fresnel(cosine: f32) -> f32 {
    schlick(Rgb::splat(COAT_REFLECTANCE), cosine).x
}
