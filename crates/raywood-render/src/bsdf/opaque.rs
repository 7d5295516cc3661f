//! What lets no light through: the metallic-roughness model of glTF 2.0 (appendix B), with the light that is scattered several times.
//!
//! A metal is a rough mirror. Anything else is a body that scatters light in all directions, under a rough and colourless mirror. The facets of both
//! are those of [`Ggx`] and mirror by Schlick's formula. What facets lose into each other comes back in all directions, coloured by
//! every reflection (Kulla and Conty 2017); the body has what the mirror leaves it, on the way in and on the way out, so that nothing is lost
//! and light may run either way (Kelemen and Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", 2001).

use std::f32::consts::{FRAC_1_PI, PI};

use raywood::Vec3;
use raywood_scene::{Rgb, luminance};

use super::albedo::{Albedo, Albedos, SMOOTHEST};
use super::frame::cosine_hemisphere;
use super::ggx::Ggx;
use super::sample::{Density, Scattered};
use crate::fresnel::schlick;

/// What an opaque surface is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpaqueSurface {
    /// The colour of what is scattered in all directions, and of what a metal mirrors.
    pub(crate) base: Rgb,
    /// The share that is metal.
    pub(crate) metallic: f32,
    /// What is mirrored straight on by what is not metal; `None` if it has no mirror at all.
    pub(crate) reflectance: Option<Rgb>,
    /// How rough the mirror is: the alpha of [`Ggx`]. Smooth below [`SMOOTHEST`].
    pub(crate) alpha: f32,
}

/// An opaque surface looked at from a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opaque {
    wo: Vec3,
    surface: OpaqueSurface,
    reflectance: Rgb,
    ggx: Ggx,
    albedos: Albedos,
    /// What the mirror sends towards `wo` of light from all sides.
    seen: Albedo,
    /// Of both materials the colour of light that was mirrored several times, and of the body.
    multiple: Rgb,
    body: Body,
    /// The probability that a direction is chosen as the mirror has it.
    mirror_share: f32,
}

/// The body below a mirror.
#[derive(Clone, Copy, Debug)]
struct Body {
    color: Rgb,
    /// The colours of the mirror's light that was mirrored several times.
    multiple: Rgb,
    /// What reaches the body towards `wo`, divided by what reaches it in the mean.
    reaches: Rgb,
}

impl Opaque {
    pub(crate) fn new(surface: OpaqueSurface, wo: Vec3) -> Self {
        let OpaqueSurface { base, metallic, reflectance, alpha } = surface;
        let has_mirror = reflectance.is_some() || metallic > 0.0;
        let albedos = Albedos::of_roughness(alpha);
        let seen = albedos.at(wo.z);
        let f0 = reflectance.unwrap_or(Rgb::ZERO);
        let coat = |albedo: Albedo, multiple: Rgb| match reflectance {
            Some(f0) => albedo.of(f0) + (1.0 - albedo.white) * multiple,
            None => Rgb::ZERO,
        };

        let of_coat = match reflectance {
            Some(f0) => multiple_color(f0, albedos.mean()),
            None => Rgb::ZERO,
        };
        let of_metal = multiple_color(base, albedos.mean());
        let multiple = metallic * of_metal + (1.0 - metallic) * of_coat;
        let left = (Rgb::ONE - coat(albedos.mean(), of_coat)).max(Rgb::splat(1e-6));
        let body = Body {
            color: (1.0 - metallic) * base,
            multiple: of_coat,
            reaches: divide(Rgb::ONE - coat(seen, of_coat), left),
        };

        // Choose by how much light either sends back.
        let metal_mirrors = metallic * seen.of(base);
        let coat_mirrors = (1.0 - metallic) * reflectance.map_or(Rgb::ZERO, |f0| seen.of(f0));
        let mirrored = luminance(metal_mirrors + coat_mirrors);
        let diffuse = body.color * (Rgb::ONE - coat(seen, of_coat));
        let scattered = luminance(diffuse + (1.0 - seen.white) * multiple);
        let all = mirrored + scattered;
        let mirror_share = if has_mirror && all > 0.0 { mirrored / all } else { 0.0 };
        let ggx = Ggx { alpha };
        Self { wo, surface, reflectance: f0, ggx, albedos, seen, multiple, body, mirror_share }
    }

    /// Whether the mirror is perfect.
    fn is_smooth(&self) -> bool {
        self.surface.alpha < SMOOTHEST
    }

    /// The colour of a facet's mirror.
    #[inline]
    fn fresnel(&self, cosine: f32) -> Rgb {
        let OpaqueSurface { base, metallic, reflectance, .. } = self.surface;
        let metal = metallic * schlick(base, cosine);
        match reflectance {
            Some(f0) => metal + (1.0 - metallic) * schlick(f0, cosine),
            None => metal,
        }
    }

    /// What comes back of light from `wi`, times the cosine there; all but perfect mirrors.
    pub(crate) fn eval(&self, wi: Vec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let from = self.albedos.at(wi.z);
        let Body { color, multiple, reaches } = self.body;
        let arrives = match self.surface.reflectance {
            Some(_) => Rgb::ONE - from.of(self.reflectance) - (1.0 - from.white) * multiple,
            None => Rgb::ONE,
        };
        let mut all = (FRAC_1_PI * wi.z) * (color * reaches * arrives);
        if self.is_smooth() {
            return all;
        }
        let lost = (1.0 - self.seen.white) * (1.0 - from.white);
        let lost_in_all = (PI * (1.0 - self.albedos.mean().white)).max(1e-6);
        all += (wi.z * lost / lost_in_all) * self.multiple;

        let h = (self.wo + wi).normalize_or_zero();
        let facets = self.ggx.distribution(h) * self.ggx.masking_shadowing(self.wo, wi);
        all + (facets / (4.0 * self.wo.z)) * self.fresnel(self.wo.dot(h))
    }

    /// The density of [`sample`](Self::sample) per solid angle; all but perfect mirrors.
    pub(crate) fn density(&self, wi: Vec3) -> f32 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let scattered = (1.0 - self.mirror_share) * FRAC_1_PI * wi.z;
        if self.is_smooth() {
            return scattered;
        }
        let h = (self.wo + wi).normalize_or_zero();
        let facets = self.ggx.masking(self.wo) * self.ggx.distribution(h) / (4.0 * self.wo.z);
        scattered + self.mirror_share * facets
    }

    /// Chooses where light comes from: `choice` which part of the surface, `u` where from.
    pub(crate) fn sample(&self, choice: f32, u: [f32; 2]) -> Option<Scattered> {
        if choice < self.mirror_share {
            let h = if self.is_smooth() { Vec3::Z } else { self.ggx.sample_visible(self.wo, u) };
            let wi = 2.0 * self.wo.dot(h) * h - self.wo;
            if self.is_smooth() {
                let weight = (1.0 / self.mirror_share) * self.fresnel(self.wo.z);
                return Some(Scattered { wi, weight, density: Density::Mirror });
            }
            return (wi.z > 0.0).then(|| self.sampled(wi));
        }
        let wi = cosine_hemisphere(u);
        (wi.z > 0.0).then(|| self.sampled(wi))
    }

    fn sampled(&self, wi: Vec3) -> Scattered {
        let density = self.density(wi);
        Scattered { wi, weight: (1.0 / density) * self.eval(wi), density: Density::Angle(density) }
    }
}

/// The colour of light that facets mirrored more than once (Kulla and Conty 2017): a geometric series of the mean of Schlick's formula.
fn multiple_color(f0: Rgb, mean: Albedo) -> Rgb {
    let fresnel = f0 + (1.0 / 21.0) * (Rgb::ONE - f0);
    let series = Rgb::ONE - (1.0 - mean.white) * fresnel;
    divide(mean.white * (fresnel * fresnel), series.max(Rgb::splat(1e-6)))
}

#[inline]
fn divide(a: Rgb, b: Rgb) -> Rgb {
    Rgb::new(a.x / b.x, a.y / b.y, a.z / b.z)
}
