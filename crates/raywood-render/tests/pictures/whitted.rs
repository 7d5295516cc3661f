//! Whitted's recursion on scenes whose colours can be computed by hand.

use crate::common::{
    assert_near, camera, clear, flat_background, image, level, light, look, matte, one_pixel, scene,
};
use raywood::Vec3;
use raywood_render::RenderOptions;
use raywood_scene::{Background, LightKind, Material, Pattern, Rgb};

const DOWN: LightKind = LightKind::directional(Vec3::new(0.0, -1.0, 0.0));

#[test]
fn a_diffuse_surface_follows_lamberts_law() {
    let slanted = LightKind::directional(Vec3::new(0.6, -0.8, 0.0));
    let mut scene = scene(&[(level(0.0, 5.0, true), 0)], &[], vec![matte(0.5)]);
    scene.lights = vec![light(slanted, 2.0), light(LightKind::Ambient, 0.1)];
    let eye = camera([0.0, 3.0, 1.0], [0.0, 0.0, 0.0]);
    let (color, rays) = look(&scene, &eye, &one_pixel());
    assert_near(color, Rgb::splat(0.5 * (2.0 * 0.8 + 0.1)), 1e-6);
    assert_eq!((rays.primary, rays.shadow, rays.reflection, rays.refraction), (1, 1, 0, 0));

    // A point light falls with the square of the distance.
    scene.lights = vec![light(LightKind::Point { position: Vec3::new(0.0, 2.0, 0.0) }, 2.0)];
    assert_near(look(&scene, &eye, &one_pixel()).0, Rgb::splat(0.5 * 2.0 / 4.0), 1e-6);
}

/// Seen from the side that the light does not reach, a sheet is dark, from whichever side it was made.
#[test]
fn light_from_behind_a_sheet_does_not_count() {
    for facing_up in [true, false] {
        let mut scene = scene(&[(level(0.0, 5.0, facing_up), 0)], &[], vec![matte(0.5)]);
        scene.lights = vec![light(DOWN, 1.0)];
        let above = look(&scene, &camera([0.0, 3.0, 1.0], [0.0; 3]), &one_pixel());
        assert_near(above.0, Rgb::splat(0.5), 1e-6);
        let below = look(&scene, &camera([0.0, -3.0, 1.0], [0.0; 3]), &one_pixel());
        assert_eq!((below.0, below.1.shadow), (Rgb::ZERO, 0));
    }
}

#[test]
fn opaque_things_between_surface_and_light_cast_shadows() {
    let lamp = LightKind::Point { position: Vec3::new(0.0, 4.0, 0.0) };
    for (center, shadowed) in
        [([0.0, 2.0, 0.0], true), ([2.0, 2.0, 0.0], false), ([0.0, 6.0, 0.0], false)]
    {
        let mut scene = scene(&[(level(0.0, 5.0, true), 0)], &[(center, 0.5, 0)], vec![matte(0.5)]);
        scene.lights = vec![light(lamp, 16.0)];
        let (color, _) = look(&scene, &camera([0.0, 1.0, 6.0], [0.0; 3]), &one_pixel());
        let expected = if shadowed { Rgb::ZERO } else { Rgb::splat(0.5) };
        assert_near(color, expected, 1e-6);
    }
}

/// A glass slab of thickness 2 over a lit floor.
fn slab_over_floor(glass: Material) -> raywood_scene::Scene {
    let mut scene = scene(
        &[(level(0.0, 9.0, true), 0), (level(1.0, 3.0, false), 1), (level(3.0, 3.0, true), 1)],
        &[],
        vec![matte(0.5), glass],
    );
    scene.lights = vec![light(DOWN, 1.0)];
    scene
}

#[test]
fn shadow_rays_pass_through_glass_and_lose_what_it_takes() {
    let tint = Rgb::new(1.0, 0.5, 0.25);
    let absorption = Vec3::new(0.0, 0.1, 1.0);
    let glass = Material { transmission: tint, absorption, ..clear(1.5) };
    let scene = slab_over_floor(glass);
    // The eye looks below the slab, so that only the shadow ray passes it.
    let eye = camera([0.0, 0.5, 6.0], [0.0; 3]);
    let (color, rays) = look(&scene, &eye, &one_pixel());
    let left = Rgb::new(1.0, (-0.2f32).exp(), (-2.0f32).exp());
    assert_near(color, 0.5 * 0.96 * 0.96 * tint * tint * left, 1e-6);
    assert_eq!((rays.primary, rays.shadow), (1, 3));

    let opaque = RenderOptions { opaque_shadows: true, ..one_pixel() };
    let (color, rays) = look(&scene, &eye, &opaque);
    assert_eq!((color, rays.shadow), (Rgb::ZERO, 1));
}

/// Something opaque inside or behind glass still casts its full shadow.
#[test]
fn glass_does_not_open_a_way_through_what_is_opaque() {
    let mut scene = slab_over_floor(clear(1.5));
    scene.spheres = raywood::Spheres::new(vec![(Vec3::new(0.0, 5.0, 0.0), 1.0)]).expect("a sphere");
    scene.sphere_materials = vec![0];
    let (color, _) = look(&scene, &camera([0.0, 0.5, 6.0], [0.0; 3]), &one_pixel());
    assert_eq!(color, Rgb::ZERO);
}

#[test]
fn glass_absorbs_by_the_length_of_the_way_inside() {
    // An index of one bends and mirrors nothing: what is left is Beer's law alone.
    let absorption = Vec3::new(0.1, 0.5, 2.0);
    let filter = Material { absorption, ..clear(1.0) };
    let left = |length: f32| Rgb::from(absorption.to_array().map(|a| (-a * length).exp()));

    let mut slab = scene(
        &[(level(0.0, 3.0, false), 0), (level(2.0, 3.0, true), 0)],
        &[],
        vec![filter.clone()],
    );
    slab.background = flat_background(Rgb::ONE);
    let (color, rays) = look(&slab, &camera([0.3, 5.0, 0.0], [0.3, 0.0, 0.0]), &one_pixel());
    assert_near(color, left(2.0), 1e-5);
    assert_eq!((rays.reflection, rays.refraction), (0, 2));

    // The chord of a sphere, 0.6 off its centre with radius 1: 2 * 0.8. And from inside, where half of it is left.
    let mut ball = scene(&[], &[([0.0; 3], 1.0, 0)], vec![filter]);
    ball.background = flat_background(Rgb::ONE);
    let (color, _) = look(&ball, &camera([0.6, 5.0, 0.0], [0.6, 0.0, 0.0]), &one_pixel());
    assert_near(color, left(1.6), 1e-5);
    let (color, _) = look(&ball, &camera([0.6, 0.0, 0.0], [0.6, 5.0, 0.0]), &one_pixel());
    assert_near(color, left(0.8), 1e-5);
}

/// The closed sum over all reflections inside a slab, seen head-on before a background that is 1 in front and 0 behind
/// the eye, and the other way round.
#[test]
fn a_slab_lets_through_and_mirrors_the_sum_over_all_inner_reflections() {
    let (f, thickness) = (0.04f32, 2.0f32);
    let glass = Material { absorption: Vec3::splat(0.1), ..clear(1.5) };
    let e = (-0.1 * thickness).exp();
    let through = (1.0 - f).powi(2) * e / (1.0 - (f * e).powi(2));
    let back = f + f * (1.0 - f).powi(2) * e * e / (1.0 - (f * e).powi(2));
    for (below, above, expected) in [(1.0, 0.0, through), (0.0, 1.0, back)] {
        let mut scene = scene(
            &[(level(0.0, 3.0, false), 0), (level(thickness, 3.0, true), 0)],
            &[],
            vec![glass.clone()],
        );
        scene.background = Background {
            zenith: Rgb::splat(above),
            horizon: Rgb::splat(0.5),
            nadir: Rgb::splat(below),
        };
        let eye = camera([0.3, 5.0, 0.0], [0.3, 0.0, 0.0]);
        assert_near(look(&scene, &eye, &one_pixel()).0, Rgb::splat(expected), 1e-5);
    }
}

/// Through a glass ball the world is upside down: looking past its centre above, one sees what is below.
#[test]
fn a_glass_ball_turns_the_world_upside_down() {
    let mut scene = scene(&[], &[([0.0; 3], 1.0, 0)], vec![clear(1.5)]);
    scene.background = Background {
        zenith: Rgb::new(1.0, 0.0, 0.0),
        horizon: Rgb::ZERO,
        nadir: Rgb::new(0.0, 0.0, 1.0),
    };
    let (above, _) = look(&scene, &camera([0.0, 0.5, 5.0], [0.0, 0.5, 0.0]), &one_pixel());
    assert!(above.z > 0.3 && above.z > 3.0 * above.x, "{above:?}");
    let (below, _) = look(&scene, &camera([0.0, -0.5, 5.0], [0.0, -0.5, 0.0]), &one_pixel());
    assert!(below.x > 0.3 && below.x > 3.0 * below.z, "{below:?}");
}

/// Looking up from under water: beyond the critical angle the surface is a perfect mirror, within it one sees out.
#[test]
fn under_water_the_surface_mirrors_beyond_the_critical_angle() {
    let water = clear(1.33);
    let mut scene = scene(&[(level(0.0, 1000.0, true), 0)], &[], vec![water]);
    scene.background = Background { zenith: Rgb::ONE, horizon: Rgb::ONE, nadir: Rgb::ZERO };
    let critical = (1.0f32 / 1.33).asin();
    let seen_at = |angle: f32| {
        let eye = camera([0.0, -1.0, 0.0], [angle.sin(), -1.0 + angle.cos(), 0.0]);
        look(&scene, &eye, &one_pixel())
    };
    let (inside, rays) = seen_at(critical - 0.01);
    assert!(inside.x > 0.3, "{inside:?}");
    assert_eq!((rays.reflection, rays.refraction), (1, 1));
    let (beyond, rays) = seen_at(critical + 0.01);
    // The mirrored ray goes down at more than 41 degrees off the horizon's dark.
    assert!(beyond.x < 0.3, "{beyond:?}");
    assert_eq!((rays.reflection, rays.refraction), (1, 0));
}

#[test]
fn a_mirror_shows_what_lies_at_the_mirrored_angle() {
    let lamp = Material { emission: Rgb::new(0.2, 0.4, 0.6), ..matte(0.0) };
    let silver = Material { mirror: Rgb::splat(0.9), ..matte(0.0) };
    let scene =
        scene(&[(level(0.0, 5.0, true), 0)], &[([4.0, 3.0, 0.0], 0.2, 1)], vec![silver, lamp]);
    let (color, rays) = look(&scene, &camera([-4.0, 3.0, 0.0], [0.0; 3]), &one_pixel());
    let schlick = 0.9 + 0.1 * (1.0f32 - 0.6).powi(5);
    assert_near(color, schlick * Rgb::new(0.2, 0.4, 0.6), 1e-6);
    assert_eq!((rays.reflection, rays.refraction), (1, 0));
    let (beside, _) = look(&scene, &camera([-4.0, 4.0, 0.0], [0.0; 3]), &one_pixel());
    assert_eq!(beside, Rgb::ZERO);
}

/// Two mirrors face each other: the depth ends it, or the cut-off does.
#[test]
fn recursion_ends_at_the_depth_or_at_the_cutoff() {
    let mirrors = |share: f32| {
        let silver = Material { mirror: Rgb::splat(share), ..matte(0.0) };
        scene(&[(level(0.0, 5.0, true), 0), (level(1.0, 5.0, false), 0)], &[], vec![silver])
    };
    let eye = camera([0.0, 0.5, 0.0], [0.0, 0.0, 0.0]);
    for depth in [0, 1, 7, RenderOptions::GREATEST_DEPTH] {
        let options = RenderOptions { max_depth: depth, ..one_pixel() };
        assert_eq!(look(&mirrors(1.0), &eye, &options).1.reflection, u64::from(depth));
    }
    // 0.1^3 is above 1/1024, 0.1^4 is not.
    let options = RenderOptions { cutoff: 1.0 / 1024.0, ..one_pixel() };
    assert_eq!(look(&mirrors(0.1), &eye, &options).1.reflection, 3);
}

/// Before a background that is one everywhere, what neither emits nor absorbs cannot be told from it.
#[test]
fn mirrors_and_glass_neither_lose_nor_gain_light() {
    let silver = Material { mirror: Rgb::ONE, ..matte(0.0) };
    let mut scene = scene(
        &[],
        &[([-1.0, 0.0, 0.0], 0.9, 0), ([1.0, 0.0, 0.0], 0.9, 1), ([0.0, 1.2, -1.0], 0.7, 2)],
        vec![clear(1.5), silver, clear(1.2)],
    );
    scene.background = flat_background(Rgb::ONE);
    let options = RenderOptions {
        width: 64,
        height: 48,
        max_depth: 40,
        cutoff: 1e-4,
        ..RenderOptions::default()
    };
    let (image, _) = image(&scene, &camera([0.0, 0.5, 6.0], [0.0; 3]), &options);
    for &color in image.pixels() {
        assert_near(color, Rgb::ONE, 5e-3);
    }
}

/// Inside a white box nothing is brighter than direct light makes it, and every pixel is a number.
#[test]
fn a_closed_white_box_stays_bounded() {
    let s = 2.0;
    let wall = |a: [f32; 3], b: [f32; 3], c: [f32; 3], d: [f32; 3]| ([a, b, c, d], 0);
    let walls = [
        wall([-s, -s, -s], [-s, -s, s], [s, -s, s], [s, -s, -s]),
        wall([-s, s, -s], [s, s, -s], [s, s, s], [-s, s, s]),
        wall([-s, -s, -s], [s, -s, -s], [s, s, -s], [-s, s, -s]),
        wall([-s, -s, s], [-s, s, s], [s, s, s], [s, -s, s]),
        wall([-s, -s, -s], [-s, s, -s], [-s, s, s], [-s, -s, s]),
        wall([s, -s, -s], [s, -s, s], [s, s, s], [s, s, -s]),
    ];
    let glossy = Material { mirror: Rgb::splat(0.2), ..matte(0.0) };
    let mut scene = scene(
        &walls,
        &[([0.7, -1.2, -0.5], 0.6, 1), ([-0.8, -1.0, -0.9], 0.8, 2)],
        vec![matte(1.0), clear(1.5), glossy],
    );
    scene.lights = vec![
        light(LightKind::Point { position: Vec3::new(0.0, 1.0, 0.0) }, 1.0),
        light(LightKind::Ambient, 0.1),
    ];
    let options = RenderOptions { width: 96, height: 64, samples: 2, ..RenderOptions::default() };
    let (image, _) = image(&scene, &camera([0.0, 0.0, 1.9], [0.0; 3]), &options);
    for &color in image.pixels() {
        // The ceiling, 1 above the lamp, is the brightest: 1 + 0.1.
        assert!(color.is_finite() && color.max_element() <= 1.11, "{color:?}");
    }
    // The camera's own wall is behind it; all others are lit, so nothing seen directly is black.
    assert!(image.pixel(0, 0).max_element() > 0.1);
}

/// A floor at a height where interpolation rounds to either side of a layer of cubes.
#[test]
fn a_checked_floor_between_two_layers_of_cubes_does_not_flicker() {
    let checks =
        Material { pattern: Pattern::Checker { other: Rgb::ZERO, size: 0.1 }, ..matte(1.0) };
    let mut scene = scene(&[(level(0.3, 5.0, true), 0)], &[], vec![checks]);
    scene.lights = vec![light(LightKind::Ambient, 1.0)];
    let seen = |column: f32, row: f32| {
        let (x, z) = (0.1 * column, 0.1 * row);
        let eye = camera([x + 0.1, 3.0, z + 5.0], [x, 0.3, z]);
        look(&scene, &eye, &one_pixel()).0.x
    };
    let base = seen(0.5, 0.5);
    for column in -6..6 {
        for row in -6..6 {
            let expected = if (column + row) % 2 == 0 { base } else { 1.0 - base };
            for (dx, dz) in [(0.1, 0.2), (0.9, 0.3), (0.4, 0.8)] {
                assert_eq!(seen(column as f32 + dx, row as f32 + dz), expected);
            }
        }
    }
}

#[test]
fn a_spot_shines_into_its_cone_and_fades_towards_its_edge() {
    let mut scene = scene(&[(level(0.0, 9.0, true), 0)], &[], vec![matte(1.0)]);
    let spot = LightKind::Spot {
        position: Vec3::new(0.0, 1.0, 0.0),
        direction: Vec3::new(0.0, -1.0, 0.0),
        cos_inner: 0.9,
        cos_outer: 0.7,
    };
    scene.lights = vec![light(spot, 1.0)];
    // The cosine at the light is that at the floor, and the distance its reciprocal: cosine^3 times the fall-off.
    for (cosine, falloff) in [(0.95f32, 1.0), (0.8, 0.25), (0.75, 0.0625), (0.69, 0.0)] {
        let x = (1.0 - cosine * cosine).sqrt() / cosine;
        let (color, _) = look(&scene, &camera([x, 3.0, 0.1], [x, 0.0, 0.0]), &one_pixel());
        assert_near(color, Rgb::splat(cosine.powi(3) * falloff), 1e-4);
    }
}

/// Where a bent normal would mirror the view down through the surface, it is mirrored along it instead.
#[test]
fn bent_normals_never_send_reflections_below_the_surface() {
    let silver = Material { mirror: Rgb::ONE, ..matte(0.0) };
    let mut scene = scene(&[(level(0.0, 5.0, true), 0)], &[], vec![silver]);
    scene.background = Background { zenith: Rgb::ONE, horizon: Rgb::ONE, nadir: Rgb::ZERO };
    scene.mesh.normals = vec![Vec3::new(-0.6, 0.8, 0.0); 4];
    let (color, _) = look(&scene, &camera([-4.0, 0.4, 0.0], [0.0; 3]), &one_pixel());
    assert_near(color, Rgb::ONE, 1e-6);
    scene.mesh.normals = vec![Vec3::new(0.6, 0.8, 0.0); 4];
    let (color, _) = look(&scene, &camera([-4.0, 0.4, 0.0], [0.0; 3]), &one_pixel());
    assert_near(color, Rgb::ONE, 1e-6);
}

#[test]
fn a_surface_without_a_material_gets_the_default() {
    let mut scene = scene(&[(level(0.0, 5.0, true), 7)], &[], vec![]);
    scene.lights = vec![light(LightKind::Ambient, 1.0)];
    let (color, _) = look(&scene, &camera([0.0, 3.0, 1.0], [0.0; 3]), &one_pixel());
    assert_near(color, Material::default().diffuse, 1e-6);
}

/// Normals per vertex bend the shading, whichever way they point, but never let light through from behind.
#[test]
fn shading_normals_are_turned_towards_the_viewer() {
    let mut scene = scene(&[(level(0.0, 5.0, true), 0)], &[], vec![matte(1.0)]);
    scene.lights = vec![light(DOWN, 1.0)];
    let eye = camera([0.0, 3.0, 1.0], [0.0; 3]);
    for sign in [1.0, -1.0] {
        scene.mesh.normals = vec![sign * Vec3::new(0.6, 0.8, 0.0); 4];
        assert_near(look(&scene, &eye, &one_pixel()).0, Rgb::splat(0.8), 1e-6);
        let below = camera([0.0, -3.0, 1.0], [0.0; 3]);
        assert_eq!(look(&scene, &below, &one_pixel()).0, Rgb::ZERO);
    }
    // Vertices without a normal leave the triangle's own.
    scene.mesh.normals = vec![Vec3::ZERO; 4];
    assert_near(look(&scene, &eye, &one_pixel()).0, Rgb::ONE, 1e-6);
}

#[test]
fn vertex_colours_multiply_the_diffuse_colour() {
    let mut scene = scene(&[(level(0.0, 5.0, true), 0)], &[], vec![matte(0.5)]);
    scene.lights = vec![light(LightKind::Ambient, 1.0)];
    scene.mesh.colors = vec![Rgb::new(1.0, 0.5, 0.0); 4];
    let (color, _) = look(&scene, &camera([0.0, 3.0, 1.0], [0.0; 3]), &one_pixel());
    assert_near(color, Rgb::new(0.5, 0.25, 0.0), 1e-6);
}
