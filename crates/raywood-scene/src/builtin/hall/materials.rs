//! The materials of the hall.

use raywood::Vec3;

use crate::{Material, MaterialId, Pattern, Rgb};

/// The materials' numbers: their places in [`materials`].
pub(super) const NAVE_FLOOR: MaterialId = 0;
pub(super) const AISLE_FLOOR: MaterialId = 1;
pub(super) const BORDER: MaterialId = 2;
pub(super) const WALL: MaterialId = 3;
pub(super) const VAULT: MaterialId = 4;
pub(super) const STONE: MaterialId = 5;
pub(super) const SHAFT: MaterialId = 6;
pub(super) const TWISTED_SHAFT: MaterialId = 7;
pub(super) const GOLD: MaterialId = 8;
pub(super) const MIRROR: MaterialId = 9;
pub(super) const GLASS: MaterialId = 10;
pub(super) const RUBY_GLASS: MaterialId = 11;
pub(super) const SEA_GLASS: MaterialId = 12;
pub(super) const PORCELAIN: MaterialId = 13;
pub(super) const DARK_MARBLE: MaterialId = 14;
pub(super) const LAMP: MaterialId = 15;
pub(super) const IRON: MaterialId = 16;
pub(super) const SEA: MaterialId = 17;
pub(super) const TERRACE: MaterialId = 18;
pub(super) const GOLD_LEAF: MaterialId = 19;
pub(super) const ROOF: MaterialId = 20;

/// All materials, in the order of their numbers.
pub(super) fn materials() -> Vec<Material> {
    let glass = |name: &str, absorption: Vec3| Material {
        name: name.into(),
        diffuse: Rgb::ZERO,
        specular: Rgb::splat(0.6),
        shininess: 500.0,
        transmission: Rgb::splat(0.98),
        ior: 1.5,
        absorption,
        ..Material::default()
    };
    let polished = |name: &str, diffuse: Rgb, pattern: Pattern, mirror: f32| Material {
        name: name.into(),
        diffuse,
        pattern,
        specular: Rgb::splat(0.15),
        shininess: 180.0,
        mirror: Rgb::splat(mirror),
        ..Material::default()
    };
    let matt = |name: &str, diffuse: Rgb, pattern: Pattern| Material {
        name: name.into(),
        diffuse,
        pattern,
        ..Material::default()
    };
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    vec![
        polished(
            "nave floor",
            Rgb::new(0.76, 0.72, 0.64),
            Pattern::Tiles {
                other: Rgb::new(0.085, 0.100, 0.095),
                size: 0.80,
                edge: [diagonal, diagonal],
                joint: 0.008,
            },
            0.07,
        ),
        polished(
            "aisle floor",
            Rgb::new(0.62, 0.54, 0.42),
            Pattern::Tiles {
                other: Rgb::new(0.34, 0.22, 0.15),
                size: 0.55,
                edge: [1.0, 0.0],
                joint: 0.008,
            },
            0.05,
        ),
        polished(
            "border",
            Rgb::new(0.24, 0.055, 0.040),
            Pattern::Marble { vein: Rgb::new(0.62, 0.42, 0.34), size: 0.9 },
            0.06,
        ),
        matt(
            "wall",
            Rgb::new(0.69, 0.60, 0.48),
            Pattern::Masonry { length: 0.88, height: 0.42, joint: 0.012 },
        ),
        matt(
            "vault",
            Rgb::new(0.10, 0.20, 0.42),
            Pattern::Marble { vein: Rgb::new(0.16, 0.30, 0.52), size: 1.6 },
        ),
        matt(
            "stone",
            Rgb::new(0.75, 0.67, 0.545),
            Pattern::Marble { vein: Rgb::new(0.58, 0.49, 0.37), size: 0.6 },
        ),
        polished(
            "shaft",
            Rgb::new(0.77, 0.695, 0.585),
            Pattern::Marble { vein: Rgb::new(0.50, 0.38, 0.28), size: 0.55 },
            0.0,
        ),
        polished(
            "twisted shaft",
            Rgb::new(0.16, 0.26, 0.21),
            Pattern::Marble { vein: Rgb::new(0.58, 0.64, 0.56), size: 0.45 },
            0.0,
        ),
        Material {
            name: "gold".into(),
            diffuse: Rgb::new(0.22, 0.13, 0.03),
            specular: Rgb::new(0.9, 0.65, 0.28),
            shininess: 140.0,
            mirror: Rgb::new(0.80, 0.58, 0.24),
            ..Material::default()
        },
        Material {
            name: "mirror".into(),
            diffuse: Rgb::splat(0.01),
            specular: Rgb::splat(0.5),
            shininess: 600.0,
            mirror: Rgb::new(0.88, 0.89, 0.90),
            ..Material::default()
        },
        glass("glass", Vec3::new(0.10, 0.04, 0.07)),
        glass("ruby glass", Vec3::new(0.4, 7.5, 6.5)),
        glass("sea glass", Vec3::new(3.2, 0.45, 0.7)),
        polished(
            "porcelain",
            Rgb::new(0.07, 0.19, 0.50),
            Pattern::Marble { vein: Rgb::new(0.80, 0.84, 0.90), size: 0.35 },
            0.05,
        ),
        polished(
            "dark marble",
            Rgb::new(0.045, 0.045, 0.050),
            Pattern::Marble { vein: Rgb::new(0.40, 0.37, 0.33), size: 0.5 },
            0.06,
        ),
        Material {
            name: "lamp".into(),
            diffuse: Rgb::splat(0.2),
            emission: Rgb::new(1.0, 0.78, 0.46),
            ..Material::default()
        },
        matt("iron", Rgb::new(0.055, 0.050, 0.048), Pattern::Plain),
        Material {
            name: "sea".into(),
            diffuse: Rgb::new(0.02, 0.09, 0.12),
            mirror: Rgb::splat(0.04),
            ..Material::default()
        },
        matt(
            "terrace",
            Rgb::new(0.58, 0.52, 0.43),
            Pattern::Tiles {
                other: Rgb::new(0.50, 0.45, 0.38),
                size: 1.1,
                edge: [1.0, 0.0],
                joint: 0.012,
            },
        ),
        matt("gold leaf", Rgb::new(0.86, 0.60, 0.20), Pattern::Plain),
        matt(
            "roof",
            Rgb::new(0.40, 0.16, 0.09),
            Pattern::Masonry { length: 0.5, height: 0.14, joint: 0.012 },
        ),
    ]
}
