//! A body under a rough and colourless mirror, or a metal, which is a rough and coloured one, or some of both: what [opaque surfaces](super::opaque) are below their
//! layers.
//!
//! All here is plain numbers and has no branches, so that a loop over [many](super::mirrored_bodies) becomes vectors.

use std::f32::consts::{FRAC_1_PI, PI};

use raywood::Vec3;
use raywood_scene::{Rgb, luminance};

use super::albedo::{Albedo, SMOOTHEST};
use super::ggx::Ggx;
use super::stack::Shares;
use crate::fresnel::schlick;

/// What a body and its mirror are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ingredients {
    /// The colour of what is scattered in all directions, and of what a metal mirrors.
    pub(crate) base: Rgb,
    /// The share that is metal.
    pub(crate) metallic: f32,
    /// What is mirrored straight on by what is not metal, and whether that mirrors at all: 1 or 0.
    pub(crate) reflectance: Rgb,
    pub(crate) mirrors: f32,
    /// How rough the mirror is: the alpha of [`Ggx`].
    pub(crate) alpha: f32,
}

/// How light is shared between a mirror, layers over it and what lies below.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sharing {
    /// What is sent towards `wo` of light from all sides.
    pub(crate) seen: Shares,
    /// What is sent in the mean over all directions.
    pub(crate) mean: Shares,
    /// The mean of the mirror if no layers were over it.
    pub(crate) bare_mean: Albedo,
    /// How bright each of the layers is.
    pub(crate) layers: [f32; 2],
    /// What counts as lost at least, to divide by.
    pub(crate) least_lost: f32,
}

/// A mirror and its body looked at from a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MirroredBody {
    pub(crate) wo: Vec3,
    pub(crate) made_of: Ingredients,
    /// The body's colour, times what reaches it towards `wo`, divided by what reaches it in the mean.
    pub(crate) body: Rgb,
    /// The colour of light that was mirrored several times: of the mirror over the body alone, and of that and the metal.
    pub(crate) multiple_above: Rgb,
    pub(crate) multiple: Rgb,
    /// What is lost towards `wo`, and in all.
    pub(crate) lost: f32,
    pub(crate) lost_in_all: f32,
    /// The probabilities that a direction is chosen as the mirror has it, and evenly.
    pub(crate) mirror_share: f32,
    pub(crate) even_share: f32,
}

/// What comes back of light from a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    /// How much, times the cosine there.
    pub(crate) light: Rgb,
    /// How likely the direction is chosen, by solid angle.
    pub(crate) density: f32,
}

impl MirroredBody {
    /// Looks at it from `wo`. Tells also the shares in which directions are chosen as either layer has it.
    #[inline(always)]
    pub(crate) fn new(made_of: Ingredients, wo: Vec3, sharing: &Sharing) -> (Self, [f32; 2]) {
        let Ingredients { base, metallic, reflectance, mirrors, .. } = made_of;
        let &Sharing { seen, mean, bare_mean, layers, least_lost } = sharing;
        let is_mirror = mirrors > 0.0;
        // What does not reach the body.
        let above = |shares: Shares, multiple: Rgb| {
            let mirrored = shares.mirror.of(reflectance) + shares.lost() * multiple;
            (if is_mirror { mirrored } else { Rgb::ZERO }) + Rgb::splat(shares.layers)
        };

        let multiple_above = multiple_color(reflectance, bare_mean);
        let multiple_above = if is_mirror { multiple_above } else { Rgb::ZERO };
        let of_metal = multiple_color(base, bare_mean);
        let multiple = metallic * of_metal + (1.0 - metallic) * multiple_above;
        let left = (Rgb::ONE - above(mean, multiple_above)).max(Rgb::splat(1e-6));
        let color = (1.0 - metallic) * base;
        let reaches = Rgb::ONE - above(seen, multiple_above);

        // Choose by how much light each sends back.
        let of_body = (1.0 - metallic) * seen.mirror.of(reflectance);
        let of_body = if is_mirror { of_body } else { Rgb::ZERO };
        let mirrored = luminance(metallic * seen.mirror.of(base) + of_body);
        let scattered = luminance(color * reaches + seen.lost() * multiple);
        let all = mirrored + scattered + layers[0] + layers[1];
        let share = |part: f32| if all > 0.0 { part / all } else { 0.0 };
        let mirror_share = share(mirrored);
        let layer_shares = [share(layers[0]), share(layers[1])];
        let even_share = 1.0 - mirror_share - layer_shares[0] - layer_shares[1];
        let lost_in_all = PI * mean.lost();
        let body = Self {
            wo,
            made_of,
            body: color * divide(reaches, left),
            multiple_above,
            multiple,
            lost: seen.lost(),
            lost_in_all: if lost_in_all > least_lost { lost_in_all } else { least_lost },
            mirror_share,
            even_share: if even_share > 0.0 { even_share } else { 0.0 },
        };
        (body, layer_shares)
    }

    #[inline(always)]
    fn ggx(&self) -> Ggx {
        Ggx { alpha: self.made_of.alpha }
    }

    /// Whether the mirror is perfect.
    #[inline(always)]
    pub(crate) fn is_smooth(&self) -> bool {
        self.made_of.alpha < SMOOTHEST
    }

    /// The colour of a facet's mirror.
    #[inline(always)]
    fn fresnel(&self, cosine: f32) -> Rgb {
        let Ingredients { base, metallic, reflectance, mirrors, .. } = self.made_of;
        let over_body = (mirrors * (1.0 - metallic)) * schlick(reflectance, cosine);
        metallic * schlick(base, cosine) + over_body
    }

    /// What comes back of light from `wi`, and how likely [`mirrored`](Self::mirrored) and even directions together choose it; perfect mirrors are left out. `from` are the shares
    /// at the angle of `wi`, `leaves` is what layers leave of what is mirrored once.
    #[inline(always)]
    pub(crate) fn answer(&self, wi: Vec3, from: Shares, leaves: f32) -> Answer {
        let wo = self.wo;
        let mirrored = from.mirror.of(self.made_of.reflectance);
        let arrives = Rgb::ONE - mirrored - from.lost() * self.multiple_above;
        let arrives = if self.made_of.mirrors > 0.0 { arrives } else { Rgb::ONE };
        let scattered = (FRAC_1_PI * wi.z) * (self.body * (arrives - Rgb::splat(from.layers)));
        let lost = self.lost * from.lost();
        let many_times = (wi.z * lost / self.lost_in_all) * self.multiple;

        let h = wo + wi;
        let h = h / h.length();
        let facets = self.ggx().distribution(h) / (4.0 * wo.z);
        let arriving = facets * self.ggx().masking_shadowing(wo, wi) * leaves;
        let once = arriving * self.fresnel(wo.dot(h));
        let chosen = self.mirror_share * (self.ggx().masking(wo) * facets);
        let is_smooth = self.is_smooth();
        let (once, chosen) = if is_smooth { (Rgb::ZERO, 0.0) } else { (once, chosen) };

        let light = scattered + many_times + once;
        let density = self.even_share * FRAC_1_PI * wi.z + chosen;
        let is_above = wi.z > 0.0;
        Answer {
            light: if is_above { light } else { Rgb::ZERO },
            density: if is_above { density } else { 0.0 },
        }
    }

    /// Where light comes from that the mirror sends to `wo`: of a perfect one there is one direction, else `u` are random numbers.
    #[inline(always)]
    pub(crate) fn mirrored(&self, u: [f32; 2]) -> Vec3 {
        let h = self.ggx().sample_visible(self.wo, u);
        let h = if self.is_smooth() { Vec3::Z } else { h };
        2.0 * self.wo.dot(h) * h - self.wo
    }

    /// What light from there counts if the mirror is perfect and layers leave so much of it.
    #[inline(always)]
    pub(crate) fn perfect_mirror(&self, leaves: f32) -> Rgb {
        (leaves / self.mirror_share) * self.fresnel(self.wo.z)
    }
}

/// The colour of light that facets mirrored more than once (Kulla and Conty 2017): a geometric series of the mean of Schlick's formula.
#[inline(always)]
fn multiple_color(f0: Rgb, mean: Albedo) -> Rgb {
    let fresnel = f0 + (1.0 / 21.0) * (Rgb::ONE - f0);
    let series = Rgb::ONE - (1.0 - mean.white) * fresnel;
    divide(mean.white * (fresnel * fresnel), series.max(Rgb::splat(1e-6)))
}

#[inline(always)]
fn divide(a: Rgb, b: Rgb) -> Rgb {
    Rgb::new(a.x / b.x, a.y / b.y, a.z / b.z)
}
