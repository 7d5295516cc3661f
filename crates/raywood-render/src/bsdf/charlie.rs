//! The distribution of fibres after Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017, known as Charlie, with their shadowing.

use std::f32::consts::PI;

use raywood::Vec3;

/// Fibres that stand off a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Charlie {
    /// How far they lean, from 0 to 1; above zero.
    alpha: f32,
}

impl Charlie {
    /// The least alpha: below, the fitted shadowing would let more light come back than there is.
    const LEAST_ALPHA: f32 = 0.07;

    pub(crate) fn new(alpha: f32) -> Self {
        Self { alpha: alpha.clamp(Self::LEAST_ALPHA, 1.0) }
    }

    /// What comes back towards `wo` of light from `wi`, times the cosine there, if fibres mirror everything; both are above the surface.
    #[inline]
    pub(crate) fn eval(self, wo: Vec3, wi: Vec3) -> f32 {
        let h = (wo + wi).normalize_or_zero();
        let exponent = 1.0 / self.alpha;
        let sin = (h.x * h.x + h.y * h.y).sqrt().min(1.0);
        let distribution = (2.0 + exponent) * sin.powf(exponent) / (2.0 * PI);
        let seen = 1.0 / (1.0 + self.lambda(wo.z) + self.lambda(wi.z));
        distribution * seen / (4.0 * wo.z)
    }

    /// Smith's auxiliary function, as it was fitted.
    #[inline]
    fn lambda(self, cosine: f32) -> f32 {
        if cosine < 0.5 {
            self.fit(cosine).exp()
        } else {
            (2.0 * self.fit(0.5) - self.fit(1.0 - cosine)).exp()
        }
    }

    /// Blended between curves for fibres that stand straight and that stand anyhow.
    #[inline]
    fn fit(self, x: f32) -> f32 {
        const STRAIGHT: [f32; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
        const ANYHOW: [f32; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
        let straight = (1.0 - self.alpha) * (1.0 - self.alpha);
        let [a, b, c, d, e] =
            std::array::from_fn(|i| ANYHOW[i] + straight * (STRAIGHT[i] - ANYHOW[i]));
        a / (1.0 + b * x.powf(c)) + d * x + e
    }
}
