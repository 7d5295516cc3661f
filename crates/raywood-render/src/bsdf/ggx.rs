//! The distribution of microfacets after Trowbridge and Reitz 1975, known as GGX, in the form of Walter et al., "Microfacet Models for Refraction
//! through Rough Surfaces", 2007; with Smith's shadowing for facets of correlated height (Heitz, "Understanding the Masking-Shadowing Function", JCGT
//! 2014).

use std::f32::consts::PI;

use raywood::Vec3;

use crate::sines::sin_cos_of_turn;

/// Microfacets of a surface that is equally rough in all directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ggx {
    /// How rough: the root mean square of the facets' slopes, roughly. Above zero.
    pub(crate) alpha: f32,
}

impl Ggx {
    /// How many facets have the normal `h`, per unit of area and solid angle.
    #[inline(always)]
    pub(crate) fn distribution(self, h: Vec3) -> f32 {
        let a2 = self.alpha * self.alpha;
        // Not from `1 - z^2`, of which nothing is left around the normal.
        let spread = h.x * h.x + h.y * h.y + a2 * (h.z * h.z);
        if h.z > 0.0 { a2 / (PI * spread * spread) } else { 0.0 }
    }

    /// Smith's auxiliary function of a direction on either side.
    #[inline(always)]
    fn lambda(self, w: Vec3) -> f32 {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    /// The share of facets that are seen from a direction.
    #[inline(always)]
    pub(crate) fn masking(self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// The share of facets that are seen from both directions.
    #[inline(always)]
    pub(crate) fn masking_shadowing(self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// The normal of a facet as they are seen from `wo`: Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023.
    #[inline(always)]
    pub(crate) fn sample_visible(self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        let stretch = |v: Vec3| Vec3::new(self.alpha * v.x, self.alpha * v.y, v.z);
        // No `normalize_or_zero`, which has branches: these are no shorter than alpha.
        let unit = |v: Vec3| v / v.length();
        // Of a hemisphere, which facets are once stretched, what is seen mirrors into a cap.
        let seen = unit(stretch(wo));
        let z = (1.0 - u[1]) * (1.0 + seen.z) - seen.z;
        let squared = 1.0 - z * z;
        let radius = if squared > 0.0 { squared.sqrt() } else { 0.0 };
        let (sin, cos) = sin_cos_of_turn(u[0]);
        let h = Vec3::new(radius * cos, radius * sin, z) + seen;
        unit(stretch(h))
    }
}
