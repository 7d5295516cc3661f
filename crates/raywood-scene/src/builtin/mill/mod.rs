//! `mill`: tower mills on a hill by the sea, whose sails turn while the picture is taken.

mod body;
mod land;
mod sails;

use raywood::{Transform, Vec3};

use super::modelling::{MeshBuilder, Placement};
use super::{Builtin, Parameter, Values};
use crate::{Background, Camera, Instance, Instances, Light, LightKind};
use crate::{Material, MaterialId, Pattern, Rgb, Scene};

pub(super) const ENTRY: Builtin = Builtin {
    name: "mill",
    description: "windmills above the sea, whose sails turn while the shutter is open",
    parameters: &[
        Parameter {
            name: "turn",
            description: "degrees by which the sails turn",
            default: 16,
            min: 0,
            max: 60,
        },
        Parameter {
            name: "seed",
            description: "where trees stand",
            default: 5,
            min: 0,
            max: u32::MAX as u64,
        },
    ],
    build,
};

const GRASS: MaterialId = 0;
const SEA: MaterialId = 1;
const PLASTER: MaterialId = 2;
const STONE: MaterialId = 3;
const SHINGLES: MaterialId = 4;
const WOOD: MaterialId = 5;
const PAINT: MaterialId = 6;
const PANE: MaterialId = 7;
const CANVAS: MaterialId = 8;
const LEAVES: MaterialId = 9;
const BARK: MaterialId = 10;

/// Objects: what stands under the sails, the sails, and trees.
const BODY: u32 = 0;
const SAILS: u32 = 1;
const TREES: [u32; 2] = [2, 3];

/// A mill: where it stands, how large it is, to where it looks (degrees from z, counter-clockwise from above), and by how much its sails are turned.
struct Mill {
    place: [f32; 2],
    size: f32,
    looks: f32,
    turned: f32,
}

const MILLS: [Mill; 3] = [
    Mill { place: [0.0, 0.0], size: 1.0, looks: 24.0, turned: 33.0 },
    Mill { place: [-44.0, -58.0], size: 0.9, looks: 40.0, turned: 8.0 },
    Mill { place: [30.0, -74.0], size: 0.85, looks: 12.0, turned: 61.0 },
];

fn build(values: &Values) -> Scene {
    let (turn, seed) = (values.get("turn") as f32, values.get("seed") as u32);
    let mut all = MeshBuilder::default();
    let here = Placement::IDENTITY;
    all.add(&land::ground(), &here, GRASS);
    all.add(&land::sea(), &here, SEA);

    let mut starts = Vec::new();
    for object in [body::body(), sails::sails(), land::poplar(), land::oak()] {
        starts.push(all.triangle_count() as u32);
        for (part, material) in object {
            all.add(&part, &here, material);
        }
    }
    let mut placed = Vec::new();
    for mill in &MILLS {
        mill.place(turn, &mut placed);
    }
    placed.extend(land::trees(seed, &MILLS.map(|mill| mill.place)));
    let end = all.triangle_count() as u32;
    let instances = Instances::new(starts, end, placed)
        .expect("objects stand in order, and no sail turns by half a circle");
    Scene {
        mesh: all.finish(),
        instances,
        materials: materials(),
        lights: lights(),
        cameras: vec![Camera {
            name: "camera".into(),
            eye: Vec3::new(-4.5, 4.6, 30.0),
            target: Vec3::new(-1.6, 8.9, 0.0),
            up: Vec3::Y,
            fov_y: 44.0,
        }],
        background: Background {
            zenith: Rgb::new(0.07, 0.24, 0.62),
            horizon: Rgb::new(0.98, 0.86, 0.70),
            nadir: Rgb::new(0.10, 0.12, 0.10),
        },
        ..Scene::default()
    }
}

impl Mill {
    /// Its body, and its sails, which turn by so many degrees.
    fn place(&self, turn: f32, placed: &mut Vec<Instance>) {
        let [x, z] = self.place;
        let to_world = Transform::scaling([self.size; 3])
            .then(&Transform::rotation(Vec3::Y, self.looks))
            .then(&Transform::translation([x, land::height(x, z) - 0.15, z]));
        placed.push(Instance::new(BODY, to_world));
        // Counter-clockwise as seen from the front, as mills do.
        let sails = |degrees: f32| {
            Transform::rotation(Vec3::Z, degrees).then(&sails::on_mill()).then(&to_world)
        };
        let later = (turn > 0.0).then(|| sails(self.turned + turn));
        placed.push(Instance { later, ..Instance::new(SAILS, sails(self.turned)) });
    }
}

fn lights() -> Vec<Light> {
    let light = |name: &str, kind, intensity| Light { name: name.into(), kind, intensity };
    let sun = Vec3::new(0.74, -0.46, -0.50).normalize_or_zero();
    let kind = LightKind::Directional { direction: sun, angular_radius: 0.27f32.to_radians() };
    vec![
        light("sky", LightKind::Ambient, Rgb::new(0.30, 0.36, 0.46)),
        light("sun", kind, Rgb::new(2.6, 2.15, 1.5)),
    ]
}

/// The materials, in the order of their numbers.
fn materials() -> Vec<Material> {
    let matt = |name: &str, diffuse, pattern| Material {
        name: name.into(),
        diffuse,
        pattern,
        ..Material::default()
    };
    let plain = |name: &str, diffuse| matt(name, diffuse, Pattern::Plain);
    vec![
        matt(
            "grass",
            Rgb::new(0.16, 0.25, 0.055),
            Pattern::Marble { vein: Rgb::new(0.20, 0.27, 0.07), size: 5.0 },
        ),
        Material {
            name: "sea".into(),
            diffuse: Rgb::new(0.02, 0.09, 0.12),
            mirror: Rgb::splat(0.04),
            ..Material::default()
        },
        plain("plaster", Rgb::new(0.80, 0.76, 0.68)),
        matt(
            "stone",
            Rgb::new(0.42, 0.38, 0.33),
            Pattern::Masonry { length: 0.6, height: 0.3, joint: 0.02 },
        ),
        matt(
            "shingles",
            Rgb::new(0.24, 0.10, 0.07),
            Pattern::Masonry { length: 0.3, height: 0.16, joint: 0.015 },
        ),
        plain("wood", Rgb::new(0.23, 0.13, 0.07)),
        plain("paint", Rgb::new(0.05, 0.17, 0.14)),
        Material {
            name: "pane".into(),
            diffuse: Rgb::splat(0.02),
            specular: Rgb::splat(0.4),
            shininess: 300.0,
            mirror: Rgb::splat(0.05),
            ..Material::default()
        },
        plain("canvas", Rgb::new(0.86, 0.79, 0.66)),
        plain("leaves", Rgb::new(0.10, 0.17, 0.045)),
        plain("bark", Rgb::new(0.16, 0.11, 0.07)),
    ]
}
