//! The path tracer against what is known of light, and against Whitted's method where both must show the same.

use raywood::Vec3;
use raywood_render::{Integrator, RenderOptions};
use raywood_scene::{
    Camera, Clearcoat, LightKind, Material, MetallicRoughness, Pattern, Rgb, Scene, Sheen,
};

use crate::common::{
    assert_near, camera, clear, flat_background, image, level, light, look, matte, one_pixel, scene,
};

fn path(samples: u32) -> RenderOptions {
    let integrator = Integrator::by_name("path").expect("the path tracer");
    RenderOptions { integrator, samples, ..one_pixel() }
}

fn lamp(strength: f32) -> Material {
    Material { emission: Rgb::splat(strength), ..matte(0.0) }
}

fn metallic_roughness(metallic: f32, roughness: f32, transmission: f32) -> Material {
    let made_of = MetallicRoughness {
        base: Rgb::ONE,
        metallic,
        roughness,
        reflectance: Rgb::splat(0.04),
        transmission,
    };
    let shares = made_of.light_shares();
    Material {
        diffuse: shares.diffuse,
        transmission: shares.transmission,
        ior: if transmission > 0.0 { 1.5 } else { 1.0 },
        metallic_roughness: Some(made_of),
        ..Material::default()
    }
}

/// A camera whose pixel sees hardly more than a point.
fn narrow(eye: [f32; 3], target: [f32; 3]) -> Camera {
    Camera { fov_y: 0.05, ..camera(eye, target) }
}

/// A sphere above a floor lights the point below it as a disk of its size would: `albedo * light * (radius / height)^2`.
#[test]
fn a_sphere_lights_what_is_below_it() {
    let shining = scene(
        &[(level(0.0, 5.0, true), 0)],
        &[([0.0, 2.0, 0.0], 0.5, 1)],
        vec![matte(0.5), lamp(10.0)],
    );
    let options = RenderOptions { max_depth: 0, ..path(1024) };
    let (color, rays) = look(&shining, &narrow([1.0, 1.0, 0.0], [0.0; 3]), &options);
    assert_near(color, Rgb::splat(0.5 * 10.0 * 0.25 * 0.25), 2e-3);
    assert_eq!((rays.primary, rays.shadow), (1024, 1024));
    // And is seen itself.
    let (color, _) = look(&shining, &narrow([0.0, 2.0, 4.0], [0.0, 2.0, 0.0]), &path(4));
    assert_near(color, Rgb::splat(10.0), 1e-4);
}

/// A square of edge 2 at height 1 above a point: Lambert's formula for the irradiance by a polygon.
#[test]
fn a_square_lights_what_is_below_it() {
    let shining = scene(
        &[(level(0.0, 5.0, true), 0), (level(1.0, 1.0, false), 1)],
        &[],
        vec![matte(0.5), lamp(3.0)],
    );
    let options = RenderOptions { max_depth: 0, ..path(4096) };
    let (color, _) = look(&shining, &narrow([1.5, 0.5, 0.0], [0.0; 3]), &options);
    // Four triangles with the foot of the height, each (1 / (2 pi)) * 2 * 1/sqrt(2) * atan(1/sqrt(2)).
    let quarter = (0.5f32.sqrt() * 0.5f32.sqrt().atan()) / std::f32::consts::PI;
    assert_near(color, Rgb::splat(0.5 * 3.0 * 4.0 * quarter), 0.01);
}

#[test]
fn the_surroundings_light_what_is_below_them() {
    let mut open = scene(&[(level(0.0, 5.0, true), 0)], &[], vec![matte(0.5)]);
    open.background = flat_background(Rgb::new(1.0, 0.5, 0.25));
    let (color, _) = look(&open, &narrow([1.0, 1.0, 0.0], [0.0; 3]), &path(256));
    assert_near(color, 0.5 * Rgb::new(1.0, 0.5, 0.25), 5e-3);
}

/// White things of every kind cannot be told from surroundings that are one everywhere.
#[test]
fn white_furnace() {
    let mut materials = vec![matte(1.0), clear(1.5)];
    for roughness in [0.0, 0.3, 0.7, 1.0] {
        materials.push(metallic_roughness(0.0, roughness, 0.0));
        materials.push(metallic_roughness(1.0, roughness, 0.0));
        materials.push(metallic_roughness(0.0, roughness, 1.0));
    }
    for material in materials {
        let mut furnace = scene(&[], &[([0.0; 3], 1.0, 0)], vec![material.clone()]);
        furnace.background = flat_background(Rgb::ONE);
        let options = RenderOptions { width: 8, height: 8, max_depth: 64, ..path(1024) };
        let view = Camera { fov_y: 20.0, ..camera([0.0, 0.0, 6.0], [0.0; 3]) };
        let (image, _) = image(&furnace, &view, &options);
        let mean = image.pixels().iter().map(|pixel| pixel.y).sum::<f32>() / 64.0;
        assert!((mean - 1.0).abs() < 0.01, "{mean} of 1: {:?}", material.metallic_roughness);
    }
}

/// A flat floor, a mirror and a ball of glass, in the light of lamps without extent. So many steps show the floor in the mirror and through the glass, but none of the
/// light that either throws on the floor, which Whitted's method does not know.
#[test]
fn whitted_and_path_agree_on_mirrors_and_glass() {
    let checks = Material {
        pattern: Pattern::Checker { other: Rgb::new(0.6, 0.1, 0.05), size: 0.5 },
        ..matte(0.8)
    };
    let silver = Material { mirror: Rgb::new(0.9, 0.8, 0.7), ..matte(0.0) };
    let glass = Material { absorption: Vec3::new(0.5, 0.1, 0.4), ..clear(1.5) };
    let lights = [
        light(LightKind::Point { position: Vec3::new(-3.0, 5.0, 4.0) }, 30.0),
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
    ];
    let ball = ([0.0, 0.0, 0.0], 0.9, 1);
    for (material, max_depth) in [(silver, 1), (glass, 2)] {
        let mut scene =
            scene(&[(level(-1.0, 8.0, true), 0)], &[ball], vec![checks.clone(), material]);
        scene.lights = lights.to_vec();
        let options = RenderOptions { width: 24, height: 16, max_depth, ..path(512) };
        let view = camera([0.5, 1.0, 4.0], [0.0, -0.2, 0.0]);
        let (traced, _) = image(&scene, &view, &options);
        let whitted = RenderOptions { integrator: RenderOptions::default().integrator, ..options };
        let (expected, _) = image(&scene, &view, &whitted);
        let mut off = Rgb::ZERO;
        for (traced, expected) in traced.pixels().iter().zip(expected.pixels()) {
            let difference = *traced - *expected;
            let tolerance = 0.02 + 0.05 * expected.max_element();
            assert!(difference.abs().max_element() < tolerance, "{traced:?} is not {expected:?}");
            off += (1.0 / 384.0) * difference;
        }
        assert!(off.abs().max_element() < 2e-3, "off by {off:?} in the mean");
    }
}

/// A box with a red wall on the left, a green one on the right, and a lamp below the ceiling.
fn cornell_box() -> Scene {
    let wall = |x: f32| [[x, 0.0, 1.0], [x, 0.0, -1.0], [x, 2.0, -1.0], [x, 2.0, 1.0]];
    let back = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 2.0, -1.0], [-1.0, 2.0, -1.0]];
    let colored = |color: Rgb| Material { diffuse: color, ..matte(0.0) };
    scene(
        &[
            (level(0.0, 1.0, true), 0),
            (level(2.0, 1.0, false), 0),
            (back, 0),
            (wall(-1.0), 1),
            (wall(1.0), 2),
            (level(1.99, 0.3, false), 3),
        ],
        &[],
        vec![
            matte(0.7),
            colored(Rgb::new(0.7, 0.05, 0.05)),
            colored(Rgb::new(0.05, 0.7, 0.05)),
            lamp(15.0),
        ],
    )
}

#[test]
fn colours_bleed_from_wall_to_floor() {
    let at = |x: f32, max_depth: u32| {
        let view = narrow([x, 1.0, 0.9], [x, 0.0, 0.0]);
        look(&cornell_box(), &view, &RenderOptions { max_depth, ..path(2048) }).0
    };
    let (left, middle, right) = (at(-0.9, 8), at(0.0, 8), at(0.9, 8));
    assert!(left.x > 1.15 * left.y, "red near the red wall: {left:?}");
    assert!(right.y > 1.15 * right.x, "green near the green wall: {right:?}");
    assert!((middle.x / middle.y - 1.0).abs() < 0.05, "neither in the middle: {middle:?}");
    // Direct light alone has no colour, and is less.
    let direct = at(-0.9, 0);
    assert!((direct.x / direct.y - 1.0).abs() < 1e-3 && direct.x < left.x, "{direct:?}");
}

/// A veil that lets half of the light straight on, without extent or with, halves the light below it.
#[test]
fn veils_let_light_straight_on() {
    for lamp_strength in [0.0, 20.0] {
        let veiled = |veil: Material| {
            let mut scene = scene(
                &[(level(0.0, 5.0, true), 0), (level(1.0, 5.0, true), 1)],
                &[([0.0, 3.0, 0.0], 0.5, 2)],
                vec![matte(0.5), veil, lamp(lamp_strength)],
            );
            let sun = LightKind::directional(Vec3::new(0.0, -1.0, 0.0));
            if lamp_strength == 0.0 {
                scene.lights.push(light(sun, 1.0));
                scene.spheres = raywood::Spheres::default();
                scene.sphere_materials.clear();
            }
            look(&scene, &narrow([0.5, 0.9, 0.0], [0.0; 3]), &path(1024)).0
        };
        let thin = |share: f32| Material { transmission: Rgb::splat(share), ..matte(0.0) };
        let (half, all) = (veiled(thin(0.5)), veiled(thin(1.0)));
        assert!(all.x > 0.1, "{all:?}");
        assert_near(half, 0.5 * all, 0.02 * all.x);
    }
}

/// A smooth coat on what is black mirrors four hundredths of light straight on and all from its edge, with both methods.
#[test]
fn a_clear_coat_mirrors() {
    let coat = Clearcoat { strength: 1.0, roughness: 0.0 };
    let coated = Material { clearcoat: Some(coat), ..matte(0.0) };
    let mut floor = scene(&[(level(0.0, 50.0, true), 0)], &[], vec![coated]);
    floor.background = flat_background(Rgb::ONE);
    let seen =
        |eye: [f32; 3], options: &RenderOptions| look(&floor, &narrow(eye, [0.0; 3]), options).0;
    for options in [one_pixel(), path(64)] {
        assert_near(seen([0.0, 3.0, 1e-3], &options), Rgb::splat(0.04), 1e-3);
        let at_sixty = 0.04 + 0.96 * 0.5f32.powi(5);
        assert_near(seen([3.0f32.sqrt(), 1.0, 0.0], &options), Rgb::splat(at_sixty), 2e-3);
        let half = Clearcoat { strength: 0.5, ..coat };
        let mut floor = floor.clone();
        floor.materials[0].clearcoat = Some(half);
        let (half, _) = look(&floor, &narrow([0.0, 3.0, 1e-3], [0.0; 3]), &options);
        assert_near(half, Rgb::splat(0.02), 1e-3);
    }
}

/// Fibres are bright from the side, and what Whitted's method leaves out of them is told.
#[test]
fn sheen_is_bright_from_the_side() {
    let sheen = Sheen { color: Rgb::new(1.0, 0.5, 0.0), roughness: 0.5 };
    let velvet = Material { sheen: Some(sheen), ..matte(0.0) };
    let mut floor = scene(&[(level(0.0, 50.0, true), 0)], &[], vec![velvet]);
    floor.background = flat_background(Rgb::ONE);
    let seen = |eye: [f32; 3]| look(&floor, &narrow(eye, [0.0; 3]), &path(1024)).0;
    let (above, beside) = (seen([0.0, 3.0, 1e-3]), seen([3.0, 0.3, 0.0]));
    assert!(beside.x > 5.0 * above.x && beside.x < 1.0, "{above:?} {beside:?}");
    assert!((beside.y / beside.x - 0.5).abs() < 0.01 && beside.z == 0.0, "{beside:?}");
    assert_eq!(one_pixel().integrator.left_out(&floor), ["sheen"]);
    assert!(path(1).integrator.left_out(&floor).is_empty());
}

/// Glass that parts colours loses nothing of any: in light of one from everywhere it cannot be seen. A beam behind it comes out in colours.
#[test]
fn glass_parts_colours() {
    let with = |dispersion: f32, roughness: f32| {
        let glass = metallic_roughness(0.0, roughness, 1.0);
        let glass = Material { dispersion, ..glass };
        let mut ball = scene(&[], &[([0.0; 3], 1.0, 0)], vec![glass]);
        ball.background = flat_background(Rgb::ONE);
        ball
    };
    let off_centre = Camera { fov_y: 2.0, ..camera([0.5, 0.3, 4.0], [0.5, 0.3, 0.0]) };
    for roughness in [0.0, 0.4] {
        let options = RenderOptions { max_depth: 64, ..path(1 << 14) };
        let (seen, _) = look(&with(2.0, roughness), &off_centre, &options);
        assert_near(seen, Rgb::ONE, 0.02);
    }

    // Light from the upper half alone: seen along the border each colour shows another share of it.
    let border = |dispersion: f32| {
        let mut ball = with(dispersion, 0.0);
        ball.background.nadir = Rgb::ZERO;
        look(&ball, &off_centre, &path(1 << 14)).0
    };
    let (parted, whole) = (border(2.0), border(0.0));
    assert!((whole.x - whole.z).abs() < 1e-4, "{whole:?}");
    assert!((parted.x - parted.z).abs() > 5e-3, "{parted:?}");
}

/// Below the edge of a roof half of a round sun is seen, and as far to either side as its angle reaches none or all of it: the shares that the chord leaves of a disc.
#[test]
fn round_lights_far_away_have_soft_shadows() {
    const ANGLE: f32 = 0.1;
    // Reaches up to x = 0, as seen from above.
    let roof = [[-9.0, 1.0, 9.0], [0.0, 1.0, 9.0], [0.0, 1.0, -9.0], [-9.0, 1.0, -9.0]];
    let mut scene = scene(&[(level(0.0, 9.0, true), 0), (roof, 0)], &[], vec![matte(0.5)]);
    let direction = Vec3::new(0.0, -1.0, 0.0);
    let sun = LightKind::Directional { direction, angular_radius: ANGLE };
    scene.lights = vec![light(sun, 1.0)];
    let floor = |x: f32, options: RenderOptions| {
        let options = RenderOptions { max_depth: 0, ..options };
        look(&scene, &narrow([x, 0.5, 0.0], [x, 0.0, 1e-3]), &options).0.x
    };
    let visible = |x: f32| {
        let edge = (x / ANGLE.tan()).clamp(-1.0, 1.0);
        0.5 + (edge.asin() + edge * (1.0 - edge * edge).sqrt()) / std::f32::consts::PI
    };
    for x in [-0.11, -0.05, 0.0, 0.03, 0.08, 0.11] {
        let seen = floor(x, path(4096));
        assert!((seen - 0.5 * visible(x)).abs() < 3e-3, "{x}: {seen} for {}", visible(x));
    }
    // Whitted's method has sharp ones.
    let whitted = [-0.01, 0.01].map(|x| floor(x, one_pixel()));
    assert!(whitted[0] == 0.0 && (whitted[1] - 0.5).abs() < 1e-5, "{whitted:?}");
}
