//! Materials, and what is changed of those that models bring.

use raywood::Vec3;

use super::syntax::{Fields, Value};
use crate::error::LoadError;
use crate::{Clearcoat, LightShares, Material, MetallicRoughness, Pattern, Rgb, Sheen};

/// The keys of a material.
const KEYS: &[&str] = &[
    "color",
    "metallic",
    "roughness",
    "reflectance",
    "mirror",
    "specular",
    "shininess",
    "pattern",
    "transmission",
    "ior",
    "absorption",
    "emission",
    "clearcoat",
    "clearcoat_roughness",
    "sheen",
    "sheen_roughness",
    "dispersion",
    "textures",
];

/// Those of what is made of metal or not, and rough or smooth.
const METALLIC_ROUGHNESS: [&str; 3] = ["metallic", "roughness", "reflectance"];

/// Those of what shares out light in Whitted's terms.
const SHARES: [&str; 4] = ["mirror", "specular", "shininess", "pattern"];

/// How rough sheen is where no table says it: about as that of velvet.
const SHEEN_ROUGHNESS: f32 = 0.5;

/// What a table says of a material. What it does not say stays as it is.
#[derive(Clone, Debug, Default)]
pub(super) struct MaterialChange {
    color: Option<Rgb>,
    metallic: Option<f32>,
    roughness: Option<f32>,
    reflectance: Option<Rgb>,
    mirror: Option<Rgb>,
    specular: Option<Rgb>,
    shininess: Option<f32>,
    pattern: Option<Pattern>,
    transmission: Option<Rgb>,
    ior: Option<f32>,
    absorption: Option<Vec3>,
    emission: Option<Rgb>,
    clearcoat: Option<f32>,
    clearcoat_roughness: Option<f32>,
    sheen: Option<Rgb>,
    sheen_roughness: Option<f32>,
    dispersion: Option<f32>,
    textures: Option<bool>,
}

/// In which terms a change speaks.
#[derive(Clone, Copy, PartialEq)]
enum Terms {
    MetallicRoughness,
    Shares,
    /// In both.
    Either,
}

impl MaterialChange {
    /// Reads a table.
    pub(super) fn read(value: Value<'_>) -> Result<Self, LoadError> {
        let fields = value.fields("a material", KEYS)?;
        let given = |keys: &[&'static str]| keys.iter().find_map(|key| fields.get(key));
        if let (Some(one), Some(other)) = (given(&METALLIC_ROUGHNESS), given(&SHARES)) {
            let message = format!(
                "`{}` and `{}` are terms of different kinds of material: use {}, or else {}",
                one.key,
                other.key,
                METALLIC_ROUGHNESS.join(", "),
                SHARES.join(", ")
            );
            return Err(other.error(message));
        }

        let unit = |value: Value<'_>| value.number_in(0.0..=1.0);
        let share = |value: Value<'_>| value.color(1.0);
        let light = |value: Value<'_>| value.color(f32::MAX);
        Ok(Self {
            color: fields.read("color", share)?,
            metallic: fields.read("metallic", unit)?,
            roughness: fields.read("roughness", unit)?,
            reflectance: fields.read("reflectance", share)?,
            mirror: fields.read("mirror", share)?,
            specular: fields.read("specular", share)?,
            shininess: fields.read("shininess", |value| value.number_in(0.0..=1e6))?,
            pattern: fields.read("pattern", pattern)?,
            transmission: fields.read("transmission", share)?,
            ior: fields.read("ior", |value| value.number_in(1.0..=10.0))?,
            absorption: fields.read("absorption", light)?,
            emission: fields.read("emission", light)?,
            clearcoat: fields.read("clearcoat", unit)?,
            clearcoat_roughness: fields.read("clearcoat_roughness", unit)?,
            sheen: fields.read("sheen", share)?,
            sheen_roughness: fields.read("sheen_roughness", unit)?,
            dispersion: fields.read("dispersion", |value| value.number_in(0.0..=f32::MAX))?,
            textures: fields.read("textures", textures)?,
        })
    }

    fn terms(&self) -> Terms {
        let Self { metallic, roughness, reflectance, .. } = self;
        let Self { mirror, specular, shininess, pattern, .. } = self;
        if metallic.is_some() || roughness.is_some() || reflectance.is_some() {
            Terms::MetallicRoughness
        } else if mirror.is_some() || specular.is_some() || shininess.is_some() || pattern.is_some()
        {
            Terms::Shares
        } else {
            Terms::Either
        }
    }

    /// The material that a table describes by itself.
    pub(super) fn material(&self, name: &str) -> Material {
        let mut material = Material { name: name.to_owned(), ..Material::default() };
        // What lets light through is clear and bends it, unless the table says otherwise.
        if self.transmission.is_some_and(|share| share != Rgb::ZERO) {
            material.ior = 1.5;
            material.diffuse = Rgb::ZERO;
            if self.terms() != Terms::Shares {
                material.metallic_roughness = Some(plain(Rgb::ONE, 0.0));
            }
        }
        self.apply(&mut material);
        material
    }

    /// Changes a material. Its textures stay, unless the table takes them away, and multiply what it says.
    pub(super) fn apply(&self, material: &mut Material) {
        if self.textures == Some(false) {
            material.textures = None;
        }
        if self.transmission.is_some() && material.transmission == Rgb::ZERO {
            material.ior = material.ior.max(1.5);
        }
        material.ior = self.ior.unwrap_or(material.ior);
        material.absorption = self.absorption.unwrap_or(material.absorption);
        material.emission = self.emission.unwrap_or(material.emission);
        material.dispersion = self.dispersion.unwrap_or(material.dispersion);
        self.apply_layers(material);

        let before = material.metallic_roughness;
        let made_of = match self.terms() {
            Terms::MetallicRoughness => Some(before.unwrap_or_else(|| {
                let transmission = material.transmission.max_element().clamp(0.0, 1.0);
                MetallicRoughness { transmission, ..plain(material.diffuse.min(Rgb::ONE), 1.0) }
            })),
            Terms::Shares => None,
            Terms::Either => before,
        };
        material.metallic_roughness = made_of.map(|made_of| self.changed(made_of));
        match material.metallic_roughness {
            // Where nothing changed, what is let through by veils stays too.
            after if after.is_some() && after == before => {}
            Some(made_of) => set_shares(material, &made_of),
            None => self.apply_shares(material),
        }
    }

    /// What lies over the material. A layer of which nothing is to be seen is none.
    fn apply_layers(&self, material: &mut Material) {
        let coat = material.clearcoat.unwrap_or_default();
        let strength = self.clearcoat.unwrap_or(coat.strength);
        let roughness = self.clearcoat_roughness.unwrap_or(coat.roughness);
        material.clearcoat = (strength > 0.0).then_some(Clearcoat { strength, roughness });

        let none = Sheen { color: Rgb::ZERO, roughness: SHEEN_ROUGHNESS };
        let sheen = material.sheen.unwrap_or(none);
        let color = self.sheen.unwrap_or(sheen.color);
        let roughness = self.sheen_roughness.unwrap_or(sheen.roughness);
        material.sheen = (color != Rgb::ZERO).then_some(Sheen { color, roughness });
    }

    fn apply_shares(&self, material: &mut Material) {
        material.diffuse = self.color.unwrap_or(material.diffuse);
        material.mirror = self.mirror.unwrap_or(material.mirror);
        material.specular = self.specular.unwrap_or(material.specular);
        material.shininess = self.shininess.unwrap_or(material.shininess);
        material.pattern = self.pattern.unwrap_or(material.pattern);
        material.transmission = self.transmission.unwrap_or(material.transmission);
    }

    fn changed(&self, made_of: MetallicRoughness) -> MetallicRoughness {
        let of_ior = self.ior.map(|ior| Rgb::splat(((ior - 1.0) / (ior + 1.0)).powi(2)));
        let mut base = self.color.unwrap_or(made_of.base);
        let mut transmission = made_of.transmission;
        // One number says how much is let through, and the colour tints it.
        if let Some(share) = self.transmission {
            transmission = share.max_element();
            if share != Rgb::splat(transmission) {
                base = (1.0 / transmission) * share * base;
            }
        }
        MetallicRoughness {
            base,
            metallic: self.metallic.unwrap_or(made_of.metallic),
            roughness: self.roughness.unwrap_or(made_of.roughness),
            reflectance: self.reflectance.or(of_ior).unwrap_or(made_of.reflectance),
            transmission,
        }
    }
}

/// A body without metal.
fn plain(base: Rgb, roughness: f32) -> MetallicRoughness {
    let reflectance = Rgb::splat(0.04);
    MetallicRoughness { base, metallic: 0.0, roughness, reflectance, transmission: 0.0 }
}

/// Has a material look as what it is made of.
fn set_shares(material: &mut Material, made_of: &MetallicRoughness) {
    let LightShares { diffuse, specular, shininess, mirror, transmission, .. } =
        made_of.light_shares();
    (material.diffuse, material.specular, material.shininess) = (diffuse, specular, shininess);
    (material.mirror, material.transmission) = (mirror, transmission);
    material.pattern = Pattern::Plain;
}

/// Textures can be taken away.
fn textures(value: Value<'_>) -> Result<bool, LoadError> {
    match value.boolean() {
        Ok(false) => Ok(false),
        _ => Err(value.expected("false, which takes away all textures of the material")),
    }
}

fn pattern(value: Value<'_>) -> Result<Pattern, LoadError> {
    let kinds = ["plain", "checker", "marble", "tiles", "masonry"];
    let all = ["kind", "color", "size", "joint", "angle", "length", "height"];
    let kind = value.fields("`pattern`", &all)?.require("kind")?.word(&kinds)?;
    let own: &[&str] = match kind {
        "checker" | "marble" => &["kind", "color", "size"],
        "tiles" => &["kind", "color", "size", "joint", "angle"],
        "masonry" => &["kind", "length", "height", "joint"],
        _ => &["kind"],
    };
    let fields = value.fields(kind, own)?;
    let color = |fields: &Fields<'_>| fields.require("color")?.color(1.0);
    let length = |key: &'static str| fields.require(key)?.above_zero();
    let joint = || Ok(fields.read("joint", |v| v.number_in(0.0..=f32::MAX))?.unwrap_or(0.0));
    Ok(match kind {
        "checker" => Pattern::Checker { other: color(&fields)?, size: length("size")? },
        "marble" => Pattern::Marble { vein: color(&fields)?, size: length("size")? },
        "tiles" => {
            let angle = fields.read("angle", Value::number)?.unwrap_or(0.0).to_radians();
            Pattern::Tiles {
                other: color(&fields)?,
                size: length("size")?,
                edge: [angle.cos(), angle.sin()],
                joint: joint()?,
            }
        }
        "masonry" => Pattern::Masonry {
            length: length("length")?,
            height: length("height")?,
            joint: joint()?,
        },
        _ => Pattern::Plain,
    })
}
