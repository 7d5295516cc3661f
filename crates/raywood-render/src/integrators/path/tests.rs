//! What must hold of every way of finding light: all find the same.

use raywood::{Spheres, TriangleMesh, Vec3};
use raywood_scene::{
    Background, Camera, Clearcoat, Material, MetallicRoughness, Rgb, Scene, Sheen, Sky,
};

use super::heuristic::Strategy;
use super::picture::Picture;
use crate::PreparedScene;
use crate::integrators::{Frame, TileRenderer};
use crate::lights::Lights;
use crate::options::RenderOptions;
use crate::progress::Progress;
use crate::tiles::{TilePass, fill_tiles};

fn made_of(metallic: f32, roughness: f32) -> Material {
    let made_of = MetallicRoughness {
        base: Rgb::splat(0.7),
        metallic,
        roughness,
        reflectance: Rgb::splat(0.04),
        transmission: 0.0,
    };
    Material { metallic_roughness: Some(made_of), ..Material::default() }
}

fn lamp(strength: f32) -> Material {
    Material { diffuse: Rgb::ZERO, emission: Rgb::splat(strength), ..Material::default() }
}

/// A floor under a square lamp, a ball that shines and one that does not.
fn stage(floor: Material, lamp_light: f32, ball_light: f32, background: Rgb) -> Scene {
    let square = |y: f32, s: f32| [[-s, y, s], [s, y, s], [s, y, -s], [-s, y, -s]];
    let positions = [square(0.0, 4.0), square(2.0, 0.5)].concat();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let mut scene = Scene {
        materials: vec![floor, lamp(lamp_light), lamp(ball_light), Material::default()],
        background: Background { zenith: background, horizon: background, nadir: background },
        ..Scene::default()
    };
    scene.mesh.triangles = TriangleMesh::new(positions, triangles).expect("a mesh");
    scene.mesh.materials = vec![0, 0, 1, 1];
    let balls = vec![(Vec3::new(-1.5, 0.9, 0.0), 0.7), (Vec3::new(1.5, 0.5, -0.5), 0.5)];
    scene.spheres = Spheres::new(balls).expect("spheres");
    scene.sphere_materials = vec![2, 3];
    scene
}

/// The mean of the pixels of a picture of the floor, in light that was scattered once or twice.
fn light_of_floor(scene: &Scene, strategy: Strategy, samples: u32) -> f64 {
    light_of_prepared(&PreparedScene::new(scene).expect("a tree"), strategy, samples)
}

/// The same with whatever panorama is around the scene.
fn light_of_prepared(prepared: &PreparedScene<'_>, strategy: Strategy, samples: u32) -> f64 {
    // What is asked at the last surface, scattered rays meet a step later.
    let max_depth = if strategy == Strategy::Scattering { 2 } else { 1 };
    let options =
        RenderOptions { width: 16, height: 16, samples, max_depth, ..RenderOptions::default() };
    let (eye, target) = (Vec3::new(0.0, 1.5, 3.0), Vec3::new(0.0, 0.0, 0.5));
    let camera = Camera { name: String::new(), eye, target, up: Vec3::Y, fov_y: 30.0 };
    let progress = Progress::new();
    let lights = Lights::default();
    let frame = Frame::new(prepared, &lights, &camera, &options, &progress).expect("a camera");
    let picture = Picture { strategy, ..Picture::new(&frame) };
    let pass = TilePass::all(samples);
    let fill = |tile: &_, pixels: &mut _| picture.render_tile(tile, &pass, pixels);
    let (pixels, _) = fill_tiles((16, 16), Rgb::ZERO, 0, &progress, fill).expect("pixels");
    let sum = pixels.iter().map(|pixel| f64::from(pixel.y)).sum::<f64>();
    sum / (f64::from(samples) * pixels.len() as f64)
}

/// Asking lights, waiting for scattered rays to meet them, and both together find the same light, on surfaces of every kind, from every kind of light.
#[test]
fn all_ways_of_finding_light_agree() {
    let coat = Clearcoat { strength: 0.8, roughness: 0.3 };
    let sheen = Sheen { color: Rgb::ONE, roughness: 0.4 };
    let floors = [
        made_of(0.0, 1.0),
        made_of(0.0, 0.3),
        made_of(1.0, 0.5),
        made_of(1.0, 0.25),
        Material::default(),
        Material { clearcoat: Some(coat), ..made_of(0.5, 0.4) },
        Material { sheen: Some(sheen), ..Material::default() },
    ];
    let lights = [(4.0, 0.0, 0.0), (0.0, 6.0, 0.0), (0.0, 0.0, 0.5), (3.0, 2.0, 0.25)];
    for floor in &floors {
        for (lamp, ball, surroundings) in lights {
            let scene = stage(floor.clone(), lamp, ball, Rgb::splat(surroundings));
            let both = light_of_floor(&scene, Strategy::Both, 256);
            let asked = light_of_floor(&scene, Strategy::Lights, 1024);
            let met = light_of_floor(&scene, Strategy::Scattering, 4096);
            let near = |a: f64, b: f64| (a - b).abs() < 0.015 * b;
            assert!(
                both > 0.0 && near(both, met) && near(asked, met),
                "{both} and {asked}, but {met} by chance: {lamp} {ball} {surroundings} {:?}",
                floor.metallic_roughness
            );
        }
    }
}

/// The same of a sky by formula, which is much brighter around its sun.
#[test]
fn a_sky_is_found_in_all_ways() {
    for (floor, elevation) in
        [(made_of(0.0, 1.0), 25.0), (made_of(1.0, 0.5), 8.0), (made_of(1.0, 0.4), 60.0)]
    {
        let scene = stage(floor, 0.0, 0.0, Rgb::ZERO);
        let mut prepared = PreparedScene::new(&scene).expect("a tree");
        prepared.set_environment(Sky { elevation, azimuth: 20.0, turbidity: 3.0 }.panorama());
        let both = light_of_prepared(&prepared, Strategy::Both, 256);
        let asked = light_of_prepared(&prepared, Strategy::Lights, 1024);
        let met = light_of_prepared(&prepared, Strategy::Scattering, 4096);
        let near = |a: f64, b: f64| (a - b).abs() < 0.015 * b;
        assert!(both > 0.0 && near(both, met) && near(asked, met), "{both} {asked} {met}");
    }
}
