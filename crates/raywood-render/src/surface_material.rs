//! A material in the form that shading reads.

use raywood::Vec3;
use raywood_scene::{Clearcoat, Material, Pattern, Rgb, Sheen};

use crate::bsdf::COAT_REFLECTANCE;

/// What shading reads of a [`Material`]: the same numbers, made safe (in range, not NaN), with the questions asked at
/// every hit already answered.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceMaterial {
    pub(crate) diffuse: Rgb,
    pub(crate) pattern: Pattern,
    pub(crate) specular: Rgb,
    pub(crate) shininess: f32,
    pub(crate) mirror: Rgb,
    /// The share mirrored at grazing angles.
    pub(crate) grazing: f32,
    pub(crate) transmission: Rgb,
    pub(crate) ior: f32,
    pub(crate) absorption: Vec3,
    pub(crate) emission: Rgb,
    /// What lies over it; without strength or colour nothing.
    pub(crate) coat: Clearcoat,
    pub(crate) sheen: Sheen,
    /// What a coat mirrors looked at straight on and from its edge, as far as it is a perfect mirror.
    pub(crate) coat_mirror: [f32; 2],
    /// By how much the index of refraction differs for red and for blue light.
    pub(crate) dispersion: f32,
    /// Whether any light gets through.
    pub(crate) transmissive: bool,
    /// Whether the surface mirrors as `mirror` says.
    pub(crate) mirrors: bool,
    /// Whether lights leave a highlight.
    pub(crate) shiny: bool,
    /// Whether there may be points where not all of the surface is there.
    pub(crate) perforated: bool,
    /// How much of the surface is there; the rest lets rays straight on.
    pub(crate) opacity: f32,
    /// How much of the ambient light arrives.
    pub(crate) ambient: f32,
}

impl SurfaceMaterial {
    /// The numbers of a material.
    pub(crate) fn new(material: &Material) -> Self {
        let mut safe = Self {
            diffuse: material.diffuse,
            pattern: material.pattern,
            specular: material.specular,
            shininess: material.shininess,
            mirror: material.mirror,
            grazing: 1.0,
            transmission: material.transmission,
            ior: material.ior,
            absorption: positive(material.absorption),
            emission: positive(material.emission),
            coat: material.clearcoat.unwrap_or_default(),
            sheen: material.sheen.unwrap_or_default(),
            coat_mirror: [0.0; 2],
            dispersion: 0.0,
            transmissive: false,
            mirrors: false,
            shiny: false,
            perforated: false,
            opacity: 1.0,
            ambient: 1.0,
        };
        safe.make_safe();
        safe.make_layers_safe();
        // No index is less than 1, that of the air around.
        let spread = (safe.ior - 1.0) * finite_or(material.dispersion, 0.0).max(0.0) / 40.0;
        safe.dispersion = spread.clamp(0.0, (safe.ior - 1.0).max(0.0));
        safe
    }

    /// The indices of refraction for red, green and blue light.
    #[inline]
    pub(crate) fn iors(&self) -> [f32; 3] {
        [self.ior - self.dispersion, self.ior, self.ior + self.dispersion]
    }

    /// Brings numbers into their range and answers the questions that follow from them.
    #[inline(always)]
    pub(crate) fn make_safe(&mut self) {
        self.diffuse = positive(self.diffuse);
        self.transmission = share(self.transmission);
        self.transmissive = self.transmission.max_element() > 0.0;
        self.mirror = if self.transmissive { Rgb::ZERO } else { share(self.mirror) };
        self.mirrors = self.mirror.max_element() > 0.0;
        self.specular = positive(self.specular);
        self.shiny = self.specular.max_element() > 0.0;
        self.shininess = finite_or(self.shininess, 50.0).max(0.0);
        let ior = finite_or(self.ior, 1.0);
        self.ior = if ior > 0.0 { ior } else { 1.0 };
    }

    /// The same of the coat and the sheen.
    #[inline]
    pub(crate) fn make_layers_safe(&mut self) {
        let unit = |x: f32| finite_or(x, 0.0).clamp(0.0, 1.0);
        self.coat =
            Clearcoat { strength: unit(self.coat.strength), roughness: unit(self.coat.roughness) };
        self.sheen.color = share(self.sheen.color);
        self.sheen.roughness = unit(self.sheen.roughness);
        // As much of it is mirror as of anything that is not metal.
        let smooth = (1.0 - self.coat.roughness / 0.25).max(0.0);
        let mirror = smooth * self.coat.strength;
        self.coat_mirror = [COAT_REFLECTANCE * mirror, mirror];
    }
}

#[inline(always)]
fn finite_or(x: f32, other: f32) -> f32 {
    if x.is_finite() { x } else { other }
}

/// Each channel from 0 to 1.
#[inline(always)]
fn share(color: Rgb) -> Rgb {
    positive(color).min(Rgb::ONE)
}

#[inline(always)]
fn positive(color: Rgb) -> Rgb {
    let channel = |x: f32| finite_or(x, 0.0).max(0.0);
    Rgb::new(channel(color.x), channel(color.y), channel(color.z))
}
