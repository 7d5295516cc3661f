//! Rough and smooth boundaries of dielectrics: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007.
//!
//! What facets lose into each other comes back in all directions, on both sides, shared out so that nothing is lost and light may run either way
//! (after Kulla and Conty 2017).
//!
//! Shares of light are told, not of radiance, which would grow by the square of the index of refraction in the denser medium and shrink again on its way out: who
//! looks from air at what is in glass, and at glass from air, sees the same; only lights inside of glass would tell.

use std::f32::consts::FRAC_1_PI;

use raywood::Vec3;
use raywood_scene::Rgb;

use super::albedo::SMOOTHEST;
use super::frame::cosine_hemisphere;
use super::ggx::Ggx;
use super::glass_table::{GlassSide, GlassTable};
use super::sample::{Density, Scattered};
use crate::fresnel::{dielectric, refract};

/// A boundary of dielectrics looked at from a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glass {
    wo: Vec3,
    /// The index of refraction on the side of `wo` over the one on the other.
    eta: f32,
    ggx: Ggx,
    /// The share let through of what is not mirrored.
    tint: Rgb,
    /// Of light that facets lose: what there is to know of both sides; `None` where they lose none.
    lost: Option<[GlassSide; 2]>,
}

impl Glass {
    /// `ior` is the index of refraction inside over the one outside, `outside` tells whether `wo` is outside. `table` is that of `ior`; without it
    /// nothing comes back of what facets lose.
    pub(crate) fn new(
        wo: Vec3,
        (ior, outside): (f32, bool),
        alpha: f32,
        tint: Rgb,
        table: Option<&GlassTable>,
    ) -> Self {
        let is_smooth = alpha < SMOOTHEST;
        let lost = table.filter(|_| !is_smooth).map(|table| {
            let [outer, inner] = table.sides(alpha);
            if outside { [outer, inner] } else { [inner, outer] }
        });
        let eta = if outside { 1.0 / ior } else { ior };
        Self { wo, eta, ggx: Ggx { alpha }, tint, lost }
    }

    fn is_smooth(&self) -> bool {
        self.ggx.alpha < SMOOTHEST
    }

    /// The share of light from `wo` that facets lose.
    fn lost_from(&self) -> f32 {
        self.lost.as_ref().map_or(0.0, |[here, _]| here.lost(self.wo.z))
    }

    /// What comes back of light from `wi`, times the cosine there; all but what is smooth.
    pub(crate) fn eval(&self, wi: Vec3) -> Rgb {
        if self.is_smooth() || wi.z == 0.0 {
            return Rgb::ZERO;
        }
        let color = if wi.z > 0.0 { Rgb::ONE } else { self.tint };
        let single = self
            .once(wi)
            .map_or(0.0, |once| once.share * once.facets * self.ggx.masking_shadowing(self.wo, wi));
        (single + self.many_times(wi)) * color
    }

    /// The density of [`sample`](Self::sample) per solid angle; all but what is smooth.
    pub(crate) fn density(&self, wi: Vec3) -> f32 {
        if self.is_smooth() || wi.z == 0.0 {
            return 0.0;
        }
        let lost = self.lost_from();
        let single =
            self.once(wi).map_or(0.0, |once| once.share * once.facets * self.ggx.masking(self.wo));
        let side = self.lost.as_ref().map_or(0.0, |[here, _]| here.share_of(wi.z));
        (1.0 - lost) * single + lost * side * FRAC_1_PI * wi.z.abs()
    }

    /// Chooses where light comes from: `choice` which way it went, `u` where from.
    pub(crate) fn sample(&self, mut choice: f32, u: [f32; 2]) -> Option<Scattered> {
        if self.is_smooth() {
            return Some(self.sample_smooth(choice));
        }
        let lost = self.lost_from();
        if choice < lost {
            let through = self.lost.as_ref().map_or(0.0, |[here, _]| here.through);
            let wi = cosine_hemisphere(u);
            return self.sampled(if choice < lost * through { -wi } else { wi });
        }
        choice = (choice - lost) / (1.0 - lost);

        let h = self.ggx.sample_visible(self.wo, u);
        let interface = dielectric(self.wo.dot(h), self.eta);
        if choice < interface.reflectance {
            let wi = 2.0 * self.wo.dot(h) * h - self.wo;
            return if wi.z > 0.0 { self.sampled(wi) } else { None };
        }
        let wi = refract(-self.wo, h, self.eta, interface.cos_transmitted).normalize_or_zero();
        if wi.z < 0.0 { self.sampled(wi) } else { None }
    }

    fn sampled(&self, wi: Vec3) -> Option<Scattered> {
        let density = self.density(wi);
        let weight = (1.0 / density) * self.eval(wi);
        let scattered = Scattered { wi, weight, density: Density::Angle(density) };
        (density > 0.0 && weight.is_finite()).then_some(scattered)
    }

    fn sample_smooth(&self, choice: f32) -> Scattered {
        let interface = dielectric(self.wo.z, self.eta);
        let through = (1.0 - interface.reflectance) * self.tint.max_element();
        let mirrored = interface.reflectance / (interface.reflectance + through);
        if choice < mirrored || through == 0.0 {
            let wi = Vec3::new(-self.wo.x, -self.wo.y, self.wo.z);
            let weight = Rgb::splat(interface.reflectance / mirrored);
            return Scattered { wi, weight, density: Density::Mirror };
        }
        let wi = refract(-self.wo, Vec3::Z, self.eta, interface.cos_transmitted);
        let weight = ((1.0 - interface.reflectance) / (1.0 - mirrored)) * self.tint;
        Scattered { wi, weight, density: Density::Mirror }
    }

    /// Light from `wi` that meets one facet: which share of it goes this way, and how many facets send it there.
    fn once(&self, wi: Vec3) -> Option<Once> {
        let (wo, eta) = (self.wo, self.eta);
        // The facet's normal lies between the directions, on either side by its index of refraction.
        let is_mirrored = wi.z > 0.0;
        let h = if is_mirrored { wo + wi } else { eta * wo + wi };
        let h = h.normalize_or_zero();
        let h = if h.z < 0.0 { -h } else { h };
        let (from, to) = (wo.dot(h), wi.dot(h));
        // A facet mirrors to the same side, and bends to the other.
        if from <= 0.0 || (to > 0.0) != is_mirrored {
            return None;
        }
        let reflectance = dielectric(from, eta).reflectance;
        let seen = self.ggx.distribution(h) / wo.z;
        if is_mirrored {
            return Some(Once { share: reflectance, facets: 0.25 * seen });
        }
        let stretch = eta * from + to;
        let facets = seen * from * to.abs() / (stretch * stretch);
        Some(Once { share: 1.0 - reflectance, facets })
    }

    /// Light from `wi` that meets several facets, times the cosine there.
    fn many_times(&self, wi: Vec3) -> f32 {
        let Some([here, there]) = &self.lost else { return 0.0 };
        let from = if wi.z > 0.0 { here } else { there };
        let lost = here.lost(self.wo.z) * from.lost(wi.z.abs());
        here.share_of(wi.z) * lost * FRAC_1_PI * wi.z.abs() / from.mean_lost
    }
}

/// Light that meets one facet.
struct Once {
    /// The share of it that goes this way.
    share: f32,
    /// How many facets send it, per solid angle, seen at the angle of `wo`, but for shadowing.
    facets: f32,
}
