//! The materials of the forest, in the order of their numbers. Colours are those of vertices.

use crate::{Material, MaterialId, Rgb};

pub(super) const GROUND: MaterialId = 0;
pub(super) const WATER: MaterialId = 1;
pub(super) const BARK: MaterialId = 2;
pub(super) const LEAVES: MaterialId = 3;
pub(super) const STONE: MaterialId = 4;
pub(super) const TIMBER: MaterialId = 5;

pub(super) fn materials() -> Vec<Material> {
    let plain =
        |name: &str| Material { name: name.into(), diffuse: Rgb::ONE, ..Material::default() };
    vec![
        plain("ground"),
        Material {
            name: "water".into(),
            diffuse: Rgb::new(0.010, 0.020, 0.016),
            mirror: Rgb::splat(0.10),
            specular: Rgb::splat(0.5),
            shininess: 900.0,
            ..Material::default()
        },
        plain("bark"),
        Material { specular: Rgb::splat(0.035), shininess: 18.0, ..plain("leaves") },
        plain("stone"),
        Material { specular: Rgb::splat(0.04), shininess: 30.0, ..plain("timber") },
    ]
}
