//! `hall`: a vaulted hall by the sea in the light of a low sun, with polished floors, glass, gold and mirrors.

mod ends;
mod materials;
mod ornaments;
mod pillars;
mod plan;
mod shell;
mod stars;
mod trim;

use raywood::{Spheres, Vec3};

use super::modelling::{MeshBuilder, Placement};
use super::{Builtin, Parameter, Values};
use crate::{Background, Camera, Light, LightKind, Rgb, Scene};
use materials as m;
use plan::{PILLAR_X, pillar_rows};

pub(super) const ENTRY: Builtin = Builtin {
    name: "hall",
    description: "a vaulted hall by the sea: pillars, polished floors, glass, gold and mirrors",
    parameters: &[Parameter {
        name: "detail",
        description: "how finely curves are cut: triangles grow with its square",
        default: 2,
        min: 1,
        max: 6,
    }],
    build,
};

fn build(values: &Values) -> Scene {
    let detail = values.get("detail") as usize;
    let mut mesh = MeshBuilder::default();
    shell::add_shell(&mut mesh, detail);
    add_pillars(&mut mesh, detail);
    let balls = ornaments::add_ornaments(&mut mesh, detail);

    let spheres = balls.iter().map(|&(center, radius, _)| (center, radius)).collect();
    Scene {
        mesh: mesh.finish(),
        spheres: Spheres::new(spheres).expect("the spheres are finite"),
        sphere_materials: balls.iter().map(|&(_, _, material)| material).collect(),
        materials: m::materials(),
        lights: lights(),
        cameras: cameras(),
        background: Background {
            zenith: Rgb::new(0.00, 0.28, 0.80),
            horizon: Rgb::new(1.0, 0.88, 0.68),
            nadir: Rgb::new(0.20, 0.30, 0.36),
        },
        ..Scene::default()
    }
}

/// Two rows of pillars, fluted and twisted in turn.
fn add_pillars(mesh: &mut MeshBuilder, detail: usize) {
    let base_and_capital = pillars::base_and_capital(detail);
    let fluted = pillars::fluted_shaft(detail);
    let twisted = pillars::twisted_shaft(detail);
    for (row, z) in pillar_rows().enumerate() {
        for side in [-1.0, 1.0] {
            let place = Placement::at(Vec3::new(side * PILLAR_X, 0.0, z));
            mesh.add(&base_and_capital, &place, m::STONE);
            if row % 2 == 0 {
                mesh.add(&fluted, &place, m::SHAFT);
            } else {
                mesh.add(&twisted, &place, m::TWISTED_SHAFT);
            }
        }
    }
}

fn cameras() -> Vec<Camera> {
    let camera = |name: &str, eye, target, fov_y| Camera {
        name: name.into(),
        eye,
        target,
        up: Vec3::Y,
        fov_y,
    };
    vec![
        camera("nave", Vec3::new(-0.35, 1.55, 6.6), Vec3::new(0.12, 2.45, -6.0), 52.0),
        camera("aisle", Vec3::new(5.6, 1.6, 6.5), Vec3::new(4.2, 2.0, -10.0), 50.0),
        camera("door", Vec3::new(1.4, 1.7, -29.0), Vec3::new(-0.4, 3.0, -10.0), 55.0),
    ]
}

fn lights() -> Vec<Light> {
    let light = |name: &str, kind, intensity| Light { name: name.into(), kind, intensity };
    let up = |position| LightKind::Spot {
        position,
        direction: Vec3::Y,
        cos_inner: 0.70,
        cos_outer: 0.02,
    };
    let sun = Vec3::new(-0.80, -0.45, -0.40).normalize_or_zero();
    let window_light = Vec3::new(0.84, -0.46, -0.28).normalize_or_zero();
    vec![
        light("sky", LightKind::Ambient, Rgb::new(0.115, 0.125, 0.155)),
        light("sun", LightKind::directional(sun), Rgb::new(2.7, 2.0, 1.22)),
        // The blue of the sky comes in through the windows on the side away from the sun.
        light("windows", LightKind::directional(window_light), Rgb::new(0.26, 0.33, 0.46)),
        // The sun's patches on the floor send light up: lamps that shine only upwards stand in for them.
        light("bounce near", up(Vec3::new(0.9, 0.02, 4.2)), Rgb::new(20.0, 14.6, 9.2)),
        light("bounce far", up(Vec3::new(0.8, 0.02, -13.0)), Rgb::new(20.0, 14.6, 9.0)),
        light("bounce left", up(Vec3::new(-5.3, 0.02, -1.0)), Rgb::new(5.2, 4.1, 3.0)),
        // Daylight from behind the eye, and through the door.
        light(
            "front",
            LightKind::Point { position: Vec3::new(0.8, 3.0, 8.2) },
            Rgb::new(6.5, 6.0, 5.6),
        ),
        light(
            "door",
            LightKind::Spot {
                position: Vec3::new(0.0, 3.4, -30.0),
                direction: Vec3::new(0.0, -0.08, 1.0).normalize_or_zero(),
                cos_inner: 0.8,
                cos_outer: 0.2,
            },
            Rgb::new(9.0, 10.5, 13.0),
        ),
    ]
}
