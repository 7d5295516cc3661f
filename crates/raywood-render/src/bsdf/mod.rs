//! How surfaces scatter light: what they are made of, in the terms of a path tracer.
//!
//! All works in the [frame](frame::ShadingFrame) of a surface, whose z is the normal for shading on the side that light is looked at from. `wo` is where it
//! is looked at from, `wi` where it comes from; both are of unit length and point away from the surface.

mod albedo;
mod charlie;
pub(crate) mod frame;
mod ggx;
mod glass;
mod glass_table;
mod layer;
mod layer_table;
mod mirrored_bodies;
mod mirrored_body;
mod opaque;
mod sample;
mod stack;
mod substance;
#[cfg(test)]
mod tests;

use raywood::Vec3;
use raywood_scene::Rgb;

use glass::Glass;
pub(crate) use glass_table::GlassTable;
pub(crate) use layer::COAT_REFLECTANCE;
pub(crate) use mirrored_bodies::{Answers, MirroredBodies};
use opaque::Opaque;
pub(crate) use sample::{Density, Scattered};
pub(crate) use substance::{Substance, straight_share};

/// A surface looked at from a direction: the share of it that is opaque, and the share that is glass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bsdf {
    opaque: Option<Opaque>,
    glass: Option<Glass>,
    /// The share that is glass.
    glass_share: f32,
}

impl Bsdf {
    /// The substance looked at from `wo`, whose z is above zero. `outside` tells whether that is on the side that its own normal points to; `tables` hold that of its index of
    /// refraction, if it is glass and rough.
    pub(crate) fn new(
        substance: &Substance,
        wo: Vec3,
        outside: bool,
        tables: &[GlassTable],
    ) -> Self {
        let &Substance { opaque, glass_share, tint, ior, glass_alpha } = substance;
        let glass = (glass_share > 0.0).then(|| {
            let table = tables.iter().find(|table| table.ior == ior);
            Glass::new(wo, (ior, outside), glass_alpha, tint, table)
        });
        let opaque = (glass_share < 1.0).then(|| Opaque::new(opaque, wo));
        Self { opaque, glass, glass_share }
    }

    /// What comes back towards `wo` of light from `wi`, times the cosine there. Perfect mirrors and what bends at smooth surfaces are left out.
    pub(crate) fn eval(&self, wi: Vec3) -> Rgb {
        let opaque = self.opaque.as_ref().map_or(Rgb::ZERO, |opaque| opaque.eval(wi));
        match &self.glass {
            None => opaque,
            Some(glass) => (1.0 - self.glass_share) * opaque + self.glass_share * glass.eval(wi),
        }
    }

    /// The density by solid angle with which [`sample`](Self::sample) chooses `wi`, with the same left out.
    pub(crate) fn density(&self, wi: Vec3) -> f32 {
        let opaque = self.opaque.as_ref().map_or(0.0, |opaque| opaque.density(wi));
        match &self.glass {
            None => opaque,
            Some(glass) => (1.0 - self.glass_share) * opaque + self.glass_share * glass.density(wi),
        }
    }

    /// Chooses where light comes from, mostly from where much counts; `choice` and `u` are random numbers. `None` where it chose what does not count.
    pub(crate) fn sample(&self, choice: f32, u: [f32; 2]) -> Option<Scattered> {
        let share = self.glass_share;
        match (&self.opaque, &self.glass) {
            (None, None) => None,
            (Some(opaque), None) => opaque.sample(choice, u),
            (None, Some(glass)) => glass.sample(choice, u),
            (Some(opaque), Some(glass)) => {
                let scattered = if choice < share {
                    glass.sample(choice / share, u)?
                } else {
                    opaque.sample((choice - share) / (1.0 - share), u)?
                };
                if scattered.density == Density::Mirror {
                    return Some(scattered);
                }
                // Either may have chosen it.
                let density = self.density(scattered.wi);
                let weight = (1.0 / density) * self.eval(scattered.wi);
                Some(Scattered { weight, density: Density::Angle(density), ..scattered })
            }
        }
    }
}
