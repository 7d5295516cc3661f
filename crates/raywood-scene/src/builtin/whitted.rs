//! `whitted`: a homage to the picture in Whitted, "An Improved Illumination Model for Shaded Display", 1980.

use raywood::{Spheres, Vec3};

use super::modelling::{MeshBuilder, Part, Placement};
use super::{Builtin, Values};
use crate::{Background, Camera, Light, LightKind, Material, Pattern, Rgb, Scene};

pub(super) const ENTRY: Builtin = Builtin {
    name: "whitted",
    description: "a glass and a mirror sphere over a chequered floor, after the picture of 1980",
    parameters: &[],
    build,
};

const FLOOR: u32 = 0;
const GLASS: u32 = 1;
const MIRROR: u32 = 2;

fn build(_: &Values) -> Scene {
    // The floor ends before the horizon, as a board under the sky.
    let mut floor = Part::default();
    floor.add_polygon(&[
        Vec3::new(-8.0, 0.0, 6.0),
        Vec3::new(8.0, 0.0, 6.0),
        Vec3::new(8.0, 0.0, -24.0),
        Vec3::new(-8.0, 0.0, -24.0),
    ]);
    let mut mesh = MeshBuilder::default();
    mesh.add(&floor, &Placement::IDENTITY, FLOOR);

    let spheres = vec![(Vec3::new(0.52, 1.66, 0.0), 0.92), (Vec3::new(-1.16, 1.02, -1.9), 0.84)];
    Scene {
        mesh: mesh.finish(),
        spheres: Spheres::new(spheres).expect("the spheres are finite"),
        sphere_materials: vec![GLASS, MIRROR],
        materials: materials(),
        lights: vec![
            Light {
                name: "ambient".into(),
                kind: LightKind::Ambient,
                intensity: Rgb::new(0.20, 0.22, 0.27),
            },
            Light {
                name: "lamp".into(),
                kind: LightKind::Point { position: Vec3::new(-4.5, 9.0, 5.5) },
                intensity: Rgb::new(112.0, 108.0, 100.0),
            },
        ],
        cameras: vec![Camera {
            name: "camera".into(),
            eye: Vec3::new(-0.10, 2.35, 5.2),
            target: Vec3::new(-0.20, 1.22, 0.0),
            up: Vec3::Y,
            fov_y: 38.0,
        }],
        background: Background {
            zenith: Rgb::new(0.05, 0.14, 0.44),
            horizon: Rgb::new(0.30, 0.52, 0.82),
            nadir: Rgb::new(0.20, 0.40, 0.70),
        },
        ..Scene::default()
    }
}

/// The materials, in the order of their numbers.
fn materials() -> Vec<Material> {
    vec![
        Material {
            name: "floor".into(),
            diffuse: Rgb::new(0.78, 0.04, 0.02),
            pattern: Pattern::Checker { other: Rgb::new(0.86, 0.66, 0.03), size: 1.0 },
            ..Material::default()
        },
        Material {
            name: "glass".into(),
            diffuse: Rgb::ZERO,
            specular: Rgb::splat(0.8),
            shininess: 600.0,
            transmission: Rgb::splat(0.98),
            ior: 1.5,
            ..Material::default()
        },
        Material {
            name: "mirror".into(),
            diffuse: Rgb::splat(0.03),
            specular: Rgb::splat(0.7),
            shininess: 300.0,
            mirror: Rgb::new(0.86, 0.87, 0.90),
            ..Material::default()
        },
    ]
}
