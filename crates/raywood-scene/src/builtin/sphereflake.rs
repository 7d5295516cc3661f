//! `sphereflake`: the fractal of spheres of Haines, "A Proposal for Standard Graphics Environments", 1987.

use raywood::{Spheres, Vec3};

use super::modelling::{MeshBuilder, Part, Placement};
use super::{Builtin, Parameter, Values};
use crate::{Background, Camera, Light, LightKind, Material, MaterialId, Pattern, Rgb, Scene};

pub(super) const ENTRY: Builtin = Builtin {
    name: "sphereflake",
    description: "a fractal of mirroring spheres, nine on each, (9^(depth+1) - 1) / 8 in all",
    parameters: &[Parameter {
        name: "depth",
        description: "how often spheres carry smaller ones: 5 makes 66,430 spheres, 7 makes 5,380,840",
        default: 5,
        min: 0,
        max: 7,
    }],
    build,
};

const FLOOR: u32 = 0;
/// The materials of the spheres begin here: one for each of the first generations, then the last.
const METALS: u32 = 1;
const METAL_COUNT: u32 = 4;

fn build(values: &Values) -> Scene {
    let depth = values.get("depth") as u32;
    let mut flake = Flake::with_capacity((9usize.pow(depth + 1) - 1) / 8);
    // The whole flake leans a little towards the camera, to show its crown.
    let axis = Vec3::new(0.16, 1.0, 0.42).normalize_or_zero();
    flake.grow(Vec3::new(0.0, 1.98, 0.0), 1.0, axis, (0, depth));

    let mut floor = Part::default();
    floor.add_polygon(&[
        Vec3::new(-60.0, 0.0, 60.0),
        Vec3::new(60.0, 0.0, 60.0),
        Vec3::new(60.0, 0.0, -60.0),
        Vec3::new(-60.0, 0.0, -60.0),
    ]);
    let mut mesh = MeshBuilder::default();
    mesh.add(&floor, &Placement::IDENTITY, FLOOR);

    Scene {
        mesh: mesh.finish(),
        spheres: Spheres::new(flake.spheres).expect("the spheres are finite"),
        sphere_materials: flake.materials,
        materials: materials(),
        lights: lights(),
        cameras: vec![Camera {
            name: "camera".into(),
            eye: Vec3::new(-1.5, 1.35, 5.9),
            target: Vec3::new(-0.02, 2.10, 0.0),
            up: Vec3::Y,
            fov_y: 35.0,
        }],
        background: Background {
            zenith: Rgb::new(0.005, 0.035, 0.20),
            horizon: Rgb::new(0.30, 0.47, 0.70),
            nadir: Rgb::new(0.10, 0.12, 0.15),
        },
        ..Scene::default()
    }
}

/// The spheres, and the material of each.
struct Flake {
    spheres: Vec<(Vec3, f32)>,
    materials: Vec<MaterialId>,
}

impl Flake {
    fn with_capacity(count: usize) -> Self {
        Self { spheres: Vec::with_capacity(count), materials: Vec::with_capacity(count) }
    }

    /// Adds a sphere of a generation and, up to the last one, nine spheres of a third of its size on it: six around
    /// its equator and three around the pole to which `axis` points.
    fn grow(&mut self, center: Vec3, radius: f32, axis: Vec3, (generation, last): (u32, u32)) {
        self.spheres.push((center, radius));
        self.materials.push(METALS + generation.min(METAL_COUNT - 1));
        if generation == last {
            return;
        }
        let (s, t) = axis.orthonormal_basis();
        let ring = |count: u32, turn: f32, latitude: f32| {
            let (up, out) = latitude.to_radians().sin_cos();
            (0..count).map(move |i| {
                let angle = (turn + 360.0 * i as f32 / count as f32).to_radians();
                (out * (angle.cos() * s + angle.sin() * t) + up * axis).normalize_or_zero()
            })
        };
        for direction in ring(6, 0.0, 0.0).chain(ring(3, 30.0, 54.735_6)) {
            let child = radius / 3.0;
            self.grow(
                center + (radius + child) * direction,
                child,
                direction,
                (generation + 1, last),
            );
        }
    }
}

fn lights() -> Vec<Light> {
    let light = |name: &str, kind, intensity| Light { name: name.into(), kind, intensity };
    let sun = Vec3::new(-0.58, -0.55, -0.62).normalize_or_zero();
    vec![
        light("ambient", LightKind::Ambient, Rgb::new(0.13, 0.15, 0.19)),
        light("sun", LightKind::directional(sun), Rgb::new(2.1, 1.8, 1.4)),
        light(
            "fill",
            LightKind::Point { position: Vec3::new(-7.0, 4.0, 5.0) },
            Rgb::new(9.0, 12.0, 17.0),
        ),
    ]
}

/// The materials, in the order of their numbers.
fn materials() -> Vec<Material> {
    let metal = |name: &str, color: Rgb| Material {
        name: name.into(),
        diffuse: 0.34 * color,
        specular: Rgb::splat(0.5),
        shininess: 220.0,
        mirror: 0.66 * color,
        ..Material::default()
    };
    vec![
        Material {
            name: "floor".into(),
            diffuse: Rgb::new(0.66, 0.62, 0.55),
            pattern: Pattern::Checker { other: Rgb::new(0.10, 0.13, 0.19), size: 1.2 },
            mirror: Rgb::splat(0.08),
            ..Material::default()
        },
        metal("silver", Rgb::new(0.95, 0.94, 0.92)),
        metal("gold", Rgb::new(1.00, 0.74, 0.32)),
        metal("copper", Rgb::new(1.00, 0.46, 0.24)),
        metal("brass", Rgb::new(1.00, 0.70, 0.30)),
    ]
}
