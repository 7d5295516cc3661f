//! What lets no light through: the metallic-roughness model of glTF 2.0 (appendix B), with the light that is scattered several times.
//!
//! A metal is a rough mirror. Anything else is a body that scatters light in all directions, under a rough and colourless mirror. The facets of both
//! are those of [`Ggx`] and mirror by Schlick's formula. What facets lose into each other comes back in all directions, coloured by
//! every reflection (Kulla and Conty 2017); the body has what the mirror leaves it, on the way in and on the way out, so that nothing is lost
//! and light may run either way (Kelemen and Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", 2001). Over all that there may
//! be [layers](super::layer), which share in light before.

use std::f32::consts::{FRAC_1_PI, PI};

use raywood::Vec3;
use raywood_scene::{Rgb, luminance};

use super::albedo::{Albedo, SMOOTHEST};
use super::frame::cosine_hemisphere;
use super::ggx::Ggx;
use super::layer::{Coat, Sheen};
use super::sample::{Density, Scattered};
use super::stack::{Shares, Stack};
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
    /// A clear coat, if there is one.
    pub(crate) coat: Option<Coat>,
    /// The sheen of fibres, if there are any, where no coat is.
    pub(crate) sheen: Option<Sheen>,
}

/// An opaque surface looked at from a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opaque {
    wo: Vec3,
    surface: OpaqueSurface,
    reflectance: Rgb,
    ggx: Ggx,
    stack: Stack,
    /// What the layers and the mirror send towards `wo` of light from all sides.
    seen: Shares,
    /// What they send in the mean over all directions.
    mean: Shares,
    /// Of both materials the colour of light that was mirrored several times, and of the body.
    multiple: Rgb,
    body: Body,
    /// The probabilities that a direction is chosen as the mirror has it, and as either layer has it.
    mirror_share: f32,
    layer_shares: [f32; 2],
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
        let OpaqueSurface { base, metallic, reflectance, alpha, coat, sheen } = surface;
        let has_mirror = reflectance.is_some() || metallic > 0.0;
        let stack = Stack::new(alpha, coat, sheen);
        let (seen, mean) = (stack.at(wo.z), stack.mean());
        let bare_mean = stack.mirror.mean();
        let f0 = reflectance.unwrap_or(Rgb::ZERO);
        // What does not reach the body.
        let above = |shares: Shares, multiple: Rgb| match reflectance {
            Some(f0) => shares.mirror.of(f0) + shares.lost() * multiple + Rgb::splat(shares.layers),
            None => Rgb::splat(shares.layers),
        };

        let of_coat = match reflectance {
            Some(f0) => multiple_color(f0, bare_mean),
            None => Rgb::ZERO,
        };
        let of_metal = multiple_color(base, bare_mean);
        let multiple = metallic * of_metal + (1.0 - metallic) * of_coat;
        let left = (Rgb::ONE - above(mean, of_coat)).max(Rgb::splat(1e-6));
        let body = Body {
            color: (1.0 - metallic) * base,
            multiple: of_coat,
            reaches: divide(Rgb::ONE - above(seen, of_coat), left),
        };

        // Choose by how much light each sends back.
        let metal_mirrors = metallic * seen.mirror.of(base);
        let body_mirrors =
            (1.0 - metallic) * reflectance.map_or(Rgb::ZERO, |f0| seen.mirror.of(f0));
        let mirrored = luminance(metal_mirrors + body_mirrors);
        let layers = stack.layers_brightness(wo.z);
        let diffuse = body.color * (Rgb::ONE - above(seen, of_coat));
        let scattered = luminance(diffuse + seen.lost() * multiple);
        let all = mirrored + scattered + layers[0] + layers[1];
        let share = |part: f32| if all > 0.0 { part / all } else { 0.0 };
        let mirror_share = if has_mirror { share(mirrored) } else { 0.0 };
        let layer_shares = layers.map(share);
        let (reflectance, ggx) = (f0, Ggx { alpha });
        Self {
            wo,
            surface,
            reflectance,
            ggx,
            stack,
            seen,
            mean,
            multiple,
            body,
            mirror_share,
            layer_shares,
        }
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
        let from = self.stack.at(wi.z);
        let Body { color, multiple, reaches } = self.body;
        let arrives = match self.surface.reflectance {
            Some(_) => {
                let mirrored = from.mirror.of(self.reflectance);
                Rgb::ONE - mirrored - from.lost() * multiple - Rgb::splat(from.layers)
            }
            None => Rgb::splat(1.0 - from.layers),
        };
        let mut all = (FRAC_1_PI * wi.z) * (color * reaches * arrives);
        if !self.stack.is_bare() {
            all += self.stack.layers_eval(self.wo, wi);
        } else if self.is_smooth() {
            return all;
        }
        let lost = self.seen.lost() * from.lost();
        let lost_in_all = (PI * self.mean.lost()).max(self.stack.least_lost());
        all += (wi.z * lost / lost_in_all) * self.multiple;
        if self.is_smooth() {
            return all;
        }

        let h = (self.wo + wi).normalize_or_zero();
        let facets = self.ggx.distribution(h) * self.ggx.masking_shadowing(self.wo, wi);
        let facets = facets * self.stack.leaves(self.wo.z, wi.z);
        all + (facets / (4.0 * self.wo.z)) * self.fresnel(self.wo.dot(h))
    }

    /// The density of [`sample`](Self::sample) per solid angle; all but perfect mirrors.
    pub(crate) fn density(&self, wi: Vec3) -> f32 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let [coat, sheen] = self.layer_shares;
        let rest = (1.0 - self.mirror_share - coat - sheen).max(0.0);
        let mut scattered = rest * FRAC_1_PI * wi.z;
        if !self.stack.is_bare() {
            scattered += self.stack.layers_density(self.layer_shares, self.wo, wi);
        }
        if self.is_smooth() {
            return scattered;
        }
        let h = (self.wo + wi).normalize_or_zero();
        let facets = self.ggx.masking(self.wo) * self.ggx.distribution(h) / (4.0 * self.wo.z);
        scattered + self.mirror_share * facets
    }

    /// Chooses where light comes from: `choice` which part of the surface, `u` where from.
    pub(crate) fn sample(&self, mut choice: f32, u: [f32; 2]) -> Option<Scattered> {
        if choice < self.mirror_share {
            let h = if self.is_smooth() { Vec3::Z } else { self.ggx.sample_visible(self.wo, u) };
            let wi = 2.0 * self.wo.dot(h) * h - self.wo;
            if self.is_smooth() {
                let share = self.stack.leaves(self.wo.z, self.wo.z) / self.mirror_share;
                let weight = share * self.fresnel(self.wo.z);
                return Some(Scattered { wi, weight, density: Density::Mirror });
            }
            return (wi.z > 0.0).then(|| self.sampled(wi));
        }
        choice -= self.mirror_share;
        for (layer, share) in self.stack.layers.iter().zip(self.layer_shares) {
            let Some(layer) = layer else { continue };
            if choice < share {
                return match layer.sample(self.wo, u) {
                    (wi, Some(mirrored)) => {
                        let weight = (1.0 / share) * mirrored;
                        Some(Scattered { wi, weight, density: Density::Mirror })
                    }
                    (wi, None) => (wi.z > 0.0).then(|| self.sampled(wi)),
                };
            }
            choice -= share;
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
