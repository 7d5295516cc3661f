//! What lets no light through: the metallic-roughness model of glTF 2.0 (appendix B), with the light that is scattered several times.
//!
//! A metal is a rough mirror. Anything else is a body that scatters light in all directions, under a rough and colourless mirror. The facets of both
//! are those of [GGX](super::ggx) and mirror by Schlick's formula. What facets lose into each other comes back in all directions, coloured by
//! every reflection (Kulla and Conty 2017); the body has what the mirror leaves it, on the way in and on the way out, so that nothing is lost
//! and light may run either way (Kelemen and Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", 2001). Over all that there may
//! be [layers](super::layer), which share in light before.

use raywood::Vec3;
use raywood_scene::Rgb;

use super::frame::cosine_hemisphere;
use super::layer::{Coat, Sheen};
use super::mirrored_body::{Ingredients, MirroredBody, Sharing};
use super::sample::{Density, Scattered};
use super::stack::Stack;

/// What an opaque surface is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpaqueSurface {
    /// The colour of what is scattered in all directions, and of what a metal mirrors.
    pub(crate) base: Rgb,
    /// The share that is metal.
    pub(crate) metallic: f32,
    /// What is mirrored straight on by what is not metal; `None` if it has no mirror at all.
    pub(crate) reflectance: Option<Rgb>,
    /// How rough the mirror is: the alpha of [`Ggx`](super::ggx::Ggx). Smooth below [`SMOOTHEST`](super::albedo::SMOOTHEST).
    pub(crate) alpha: f32,
    /// A clear coat, if there is one.
    pub(crate) coat: Option<Coat>,
    /// The sheen of fibres, if there are any, where no coat is.
    pub(crate) sheen: Option<Sheen>,
}

impl OpaqueSurface {
    /// Whether there are no layers over it.
    #[inline(always)]
    pub(crate) fn is_bare(&self) -> bool {
        self.coat.is_none() && self.sheen.is_none()
    }

    /// What it is made of below its layers.
    #[inline(always)]
    pub(crate) fn ingredients(&self) -> Ingredients {
        Ingredients {
            base: self.base,
            metallic: self.metallic,
            reflectance: self.reflectance.unwrap_or(Rgb::ZERO),
            mirrors: if self.reflectance.is_some() { 1.0 } else { 0.0 },
            alpha: self.alpha,
        }
    }
}

/// An opaque surface looked at from a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opaque {
    body: MirroredBody,
    stack: Stack,
    /// The probabilities that a direction is chosen as either layer has it.
    layer_shares: [f32; 2],
}

impl Opaque {
    pub(crate) fn new(surface: OpaqueSurface, wo: Vec3) -> Self {
        let stack = Stack::new(surface.alpha, surface.coat, surface.sheen);
        let sharing = Sharing {
            seen: stack.at(wo.z),
            mean: stack.mean(),
            bare_mean: stack.mirror.mean(),
            layers: stack.layers_brightness(wo.z),
            least_lost: stack.least_lost(),
        };
        let (body, layer_shares) = MirroredBody::new(surface.ingredients(), wo, &sharing);
        Self { body, stack, layer_shares }
    }

    /// What comes back of light from `wi`, times the cosine there; all but perfect mirrors.
    pub(crate) fn eval(&self, wi: Vec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let wo = self.body.wo;
        let leaves = self.stack.leaves(wo.z, wi.z);
        let below = self.body.answer(wi, self.stack.at(wi.z), leaves).light;
        if self.stack.is_bare() { below } else { below + self.stack.layers_eval(wo, wi) }
    }

    /// The density of [`sample`](Self::sample) per solid angle; all but perfect mirrors.
    pub(crate) fn density(&self, wi: Vec3) -> f32 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        // Shares and what layers leave do not matter for it.
        let below = self.body.answer(wi, Default::default(), 1.0).density;
        if self.stack.is_bare() {
            return below;
        }
        below + self.stack.layers_density(self.layer_shares, self.body.wo, wi)
    }

    /// Chooses where light comes from: `choice` which part of the surface, `u` where from.
    pub(crate) fn sample(&self, mut choice: f32, u: [f32; 2]) -> Option<Scattered> {
        let wo = self.body.wo;
        if choice < self.body.mirror_share {
            let wi = self.body.mirrored(u);
            if self.body.is_smooth() {
                let weight = self.body.perfect_mirror(self.stack.leaves(wo.z, wo.z));
                return Some(Scattered { wi, weight, density: Density::Mirror });
            }
            return (wi.z > 0.0).then(|| self.sampled(wi));
        }
        choice -= self.body.mirror_share;
        for (layer, share) in self.stack.layers.iter().zip(self.layer_shares) {
            let Some(layer) = layer else { continue };
            if choice < share {
                return match layer.sample(wo, u) {
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
