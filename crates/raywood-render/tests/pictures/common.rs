//! What the tests of pictures share: small scenes and one-pixel renderings.

use raywood::{Spheres, TriangleMesh, Vec3};
use raywood_render::{Image, PreparedScene, Progress, RayCounts, RenderOptions, render};
use raywood_scene::{Background, Camera, Light, LightKind, Material, Pattern, Rgb, Scene};

pub(crate) fn flat_background(color: Rgb) -> Background {
    Background { zenith: color, horizon: color, nadir: color }
}

pub(crate) fn camera(eye: [f32; 3], target: [f32; 3]) -> Camera {
    Camera { name: String::new(), eye: eye.into(), target: target.into(), up: Vec3::Y, fov_y: 40.0 }
}

pub(crate) fn light(kind: LightKind, intensity: f32) -> Light {
    Light { name: String::new(), kind, intensity: Rgb::splat(intensity) }
}

pub(crate) fn matte(diffuse: f32) -> Material {
    Material { diffuse: Rgb::splat(diffuse), ..Material::default() }
}

pub(crate) fn clear(ior: f32) -> Material {
    Material { transmission: Rgb::ONE, ior, ..matte(0.0) }
}

/// A scene of the given quadrilaterals (corners counter-clockwise seen from outside) and spheres, black all around.
pub(crate) fn scene(
    quads: &[([[f32; 3]; 4], u32)],
    spheres: &[([f32; 3], f32, u32)],
    materials: Vec<Material>,
) -> Scene {
    let (mut positions, mut triangles, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for (corners, material) in quads {
        let first = positions.len() as u32;
        positions.extend_from_slice(corners);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        ids.extend([*material; 2]);
    }
    let mut scene = Scene { materials, background: flat_background(Rgb::ZERO), ..Scene::default() };
    scene.mesh.triangles = TriangleMesh::new(positions, triangles).expect("a mesh");
    scene.mesh.materials = ids;
    scene.spheres =
        Spheres::new(spheres.iter().map(|&(c, r, _)| (c.into(), r)).collect()).expect("spheres");
    scene.sphere_materials = spheres.iter().map(|&(_, _, material)| material).collect();
    scene
}

/// A horizontal square of half-width `size` around the y axis that faces up, or down.
pub(crate) fn level(y: f32, size: f32, up: bool) -> [[f32; 3]; 4] {
    let s = size;
    let facing_up = [[-s, y, s], [s, y, s], [s, y, -s], [-s, y, -s]];
    let [a, b, c, d] = facing_up;
    if up { facing_up } else { [d, c, b, a] }
}

/// The image of a scene with these options.
pub(crate) fn image(scene: &Scene, camera: &Camera, options: &RenderOptions) -> (Image, RayCounts) {
    let prepared = PreparedScene::new(scene).expect("a tree");
    let (image, stats) =
        render(&prepared, camera, &scene.lights, options, &Progress::new()).expect("an image");
    (image, stats.rays)
}

/// Options for a single pixel, which looks along the camera's axis, without any cut-off to speak of.
pub(crate) fn one_pixel() -> RenderOptions {
    RenderOptions {
        width: 1,
        height: 1,
        cutoff: RenderOptions::SMALLEST_CUTOFF,
        max_depth: 20,
        ..RenderOptions::default()
    }
}

/// What the camera sees straight ahead, and the rays that took.
pub(crate) fn look(scene: &Scene, camera: &Camera, options: &RenderOptions) -> (Rgb, RayCounts) {
    let (image, rays) = image(scene, camera, options);
    (image.pixel(0, 0), rays)
}

/// A picture with a bit of everything: glass, mirror, checks, lights of all kinds.
pub(crate) fn still_life() -> Scene {
    let checks = Material {
        pattern: Pattern::Checker { other: Rgb::new(0.6, 0.1, 0.05), size: 0.5 },
        ..matte(0.8)
    };
    let glass = Material { absorption: Vec3::new(0.5, 0.1, 0.4), ..clear(1.5) };
    let mirror = Material { mirror: Rgb::splat(0.9), specular: Rgb::ONE, ..matte(0.05) };
    let mut scene = scene(
        &[(level(-1.0, 8.0, true), 0)],
        &[([-0.8, 0.0, 0.0], 0.9, 1), ([1.2, -0.2, -0.6], 0.8, 2), ([0.4, -0.7, 1.1], 0.3, 3)],
        vec![checks, glass, mirror, matte(0.5)],
    );
    scene.background = Background::default();
    scene.lights = vec![
        light(LightKind::Point { position: Vec3::new(-3.0, 5.0, 4.0) }, 40.0),
        light(LightKind::directional(Vec3::new(-0.6, -0.8, 0.0)), 0.4),
        light(
            LightKind::Spot {
                position: Vec3::new(3.0, 4.0, 2.0),
                direction: Vec3::new(-0.6, -0.8, 0.0),
                cos_inner: 0.95,
                cos_outer: 0.8,
            },
            10.0,
        ),
        light(LightKind::Ambient, 0.2),
    ];
    scene
}

pub(crate) fn still_life_camera() -> Camera {
    camera([0.5, 1.0, 6.0], [0.0, -0.2, 0.0])
}

pub(crate) fn assert_near(actual: Rgb, expected: Rgb, tolerance: f32) {
    let off = (actual - expected).abs().max_element();
    assert!(off <= tolerance, "{actual:?} is not {expected:?} (off by {off})");
}
