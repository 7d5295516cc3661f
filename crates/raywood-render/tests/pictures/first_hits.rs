//! Pictures of what is seen first: normals, depth, albedo, numbers, ambient occlusion, edges.

use raywood::{Spheres, Vec3};
use raywood_render::{INTEGRATORS, Integrator, RenderOptions};
use raywood_scene::{
    Encoding, Material, Rgb, Scene, SurfaceTextures, Texture, TextureImage, linear_to_srgb,
};

use crate::common::{assert_near, camera, image, level, look, matte, one_pixel, scene};

fn options(name: &str) -> RenderOptions {
    let integrator = Integrator::by_name(name).expect("an integrator");
    RenderOptions { integrator, ..one_pixel() }
}

/// A red floor seen from 2 above, and where nothing is.
fn floor() -> Scene {
    let red = Material { diffuse: Rgb::new(0.8, 0.1, 0.2), ..matte(0.0) };
    scene(&[(level(0.0, 1.0, true), 0)], &[], vec![red])
}

#[test]
fn every_integrator_has_a_name_and_says_what_it_does() {
    for integrator in &INTEGRATORS {
        let found = Integrator::by_name(integrator.name).map(|found| found.name);
        assert_eq!(found, Some(integrator.name), "names are unique");
        assert!(integrator.help.len() > 10);
    }
    assert_eq!(RenderOptions::default().integrator.name, "whitted");
    assert!(Integrator::by_name("Whitted").is_none());
}

#[test]
fn normals_are_colours() {
    let (color, rays) =
        look(&floor(), &camera([0.3, 2.0, 0.2], [0.3, 0.0, 0.2]), &options("normals"));
    assert_near(color, Rgb::new(0.5, 1.0, 0.5), 1e-6);
    assert_eq!((rays.primary, rays.total()), (1, 1));
    // From below it is the other side, and beside it there is nothing.
    let below = camera([0.3, -2.0, 0.2], [0.3, 0.0, 0.2]);
    assert_near(look(&floor(), &below, &options("normals")).0, Rgb::new(0.5, 0.0, 0.5), 1e-6);
    let beside = camera([3.0, 2.0, 0.0], [3.0, 0.0, 0.0]);
    assert_eq!(look(&floor(), &beside, &options("normals")).0, Rgb::ZERO);
}

#[test]
fn numbers_are_written_as_they_are() {
    let view = camera([0.3, 2.0, 0.2], [0.3, 0.0, 0.2]);
    let (normals, _) = image(&floor(), &view, &options("normals"));
    assert_eq!(normals.to_srgb8(), [128, 255, 128]);
}

/// Two floors, of which the camera sees the nearer in one half of the picture and the farther in the other.
#[test]
fn depth_goes_from_the_nearest_to_the_farthest() {
    let half = [[-9.0, 0.0, 9.0], [0.0, 0.0, 9.0], [0.0, 0.0, -9.0], [-9.0, 0.0, -9.0]];
    let floors = scene(&[(half, 0), (level(-3.0, 9.0, true), 0)], &[], vec![matte(0.5)]);
    let view = camera([0.0, 1.0, 0.0], [0.0; 3]);
    let options = RenderOptions { width: 64, height: 64, ..options("depth") };
    let (picture, _) = image(&floors, &view, &options);
    let values: Vec<f32> = picture.pixels().iter().map(|pixel| pixel.x).collect();
    let (least, most) =
        (values.iter().copied().fold(1.0, f32::min), values.iter().copied().fold(0.0, f32::max));
    assert!(most > 0.99 && least < 0.01, "{least} to {most}");
    // Straight down at 1 and at 4, and askew at nearly as much: three quarters of the reciprocals lie between.
    let (down, far_down) = (picture.pixel(31, 31).x, picture.pixel(33, 31).x);
    let (a, b) = (down.max(far_down), down.min(far_down));
    assert!(a > 0.98 && (0.0..0.1).contains(&b), "{a} and {b}");
}

#[test]
fn albedo_is_the_colour_without_light() {
    let view = camera([0.3, 2.0, 0.2], [0.3, 0.0, 0.2]);
    let (color, _) = look(&floor(), &view, &options("albedo"));
    let encoded = [0.8, 0.1, 0.2].map(linear_to_srgb);
    assert_near(color, encoded.into(), 1e-6);
}

#[test]
fn ids_tell_materials_and_triangles_apart() {
    let floors = scene(
        &[(level(0.0, 1.0, true), 0), (level(-1.0, 4.0, true), 1)],
        &[],
        vec![matte(0.5), matte(0.5)],
    );
    let at = |x: f32, z: f32| {
        let view = camera([x, 2.0, z], [x, 0.0, z]);
        look(&floors, &view, &options("ids")).0
    };
    let (first, second, below) = (at(0.3, 0.6), at(-0.3, -0.6), at(2.0, 1.0));
    assert_ne!(first, second, "two triangles");
    let hue = |color: Rgb| (1.0 / color.max_element()) * color;
    assert_near(hue(first), hue(second), 1e-5);
    assert!((hue(first) - hue(below)).abs().max_element() > 0.2, "two materials");
    assert_eq!(first, at(0.3, 0.6));
}

/// A point half of whose sky is hidden by a wall that is near, and one whose sky is open.
#[test]
fn ambient_occlusion_tells_how_open_it_is() {
    let wall = [[0.0, 0.0, 9.0], [0.0, 0.0, -9.0], [0.0, 99.0, -9.0], [0.0, 99.0, 9.0]];
    let corner = scene(&[(level(0.0, 9.0, true), 0), (wall, 0)], &[], vec![matte(0.5)]);
    let at = |x: f32| {
        let view = camera([x, 3.0, 0.0], [x, 0.0, 0.0]);
        let options = RenderOptions { samples: 64, ..options("ao") };
        look(&corner, &raywood_scene::Camera { fov_y: 0.01, ..view }, &options)
    };
    let (open, rays) = at(8.9);
    assert!(open.x > 0.7, "{open:?}");
    assert_eq!((rays.primary, rays.shadow), (64, 256));
    let (beside, _) = at(0.001);
    assert!((0.45..0.55).contains(&beside.x), "{beside:?}");
}

#[test]
fn edges_are_lines_of_the_same_width_near_and_far() {
    // How many of a row of pixels across the diagonal of the floor are dark.
    let dark = |height: f32| {
        let view = camera([0.1, height, 0.2], [0.1, 0.0, 0.2]);
        let options = RenderOptions { width: 101, height: 1, ..options("wireframe") };
        let view = raywood_scene::Camera { fov_y: 0.4 / height, ..view };
        let (image, _) = image(&floor(), &view, &options);
        let line: f32 = image.row(0).iter().map(|pixel| (0.9 - pixel.x) / (0.9 - 0.08)).sum();
        line
    };
    let (near, far) = (dark(20.0), dark(200.0));
    assert!(
        (1.2..1.8).contains(&near) && (near / far - 1.0).abs() < 0.1,
        "{near} and {far} pixels"
    );
}

/// A veil that is half there: its own normal by half, what is behind it by half.
#[test]
fn holes_show_what_is_behind_by_its_share() {
    let texel = TextureImage::new(1, 1, vec![[255, 255, 255, 128]], Encoding::Srgb, None);
    let veil = Material {
        textures: Some(Box::new(SurfaceTextures {
            color: Some(Texture::new(0)),
            opacity: Some(1.0),
            ..SurfaceTextures::default()
        })),
        ..matte(0.5)
    };
    let mut scene = scene(&[(level(0.0, 1.0, true), 0)], &[], vec![veil, matte(0.5)]);
    scene.spheres = Spheres::new(vec![(Vec3::new(-2.0, -2.0, 0.0), 1.0)]).expect("a sphere");
    scene.sphere_materials = vec![1];
    scene.images = vec![texel.expect("an image")];
    scene.mesh.texture_coordinates[0] = vec![[0.5; 2]; 4];
    let view = camera([0.3, 2.0, 0.2], [0.3, 0.0, 0.2]);
    let (color, rays) = look(&scene, &view, &options("normals"));
    let share = 128.0 / 255.0;
    assert_near(color, share * Rgb::new(0.5, 1.0, 0.5), 2e-3);
    assert_eq!((rays.primary, rays.refraction), (1, 1));
}

#[test]
fn what_is_seen_first_does_not_depend_on_the_number_of_threads() {
    let still_life = crate::common::still_life();
    for integrator in INTEGRATORS.iter().filter(|integrator| integrator.name != "whitted") {
        let options =
            RenderOptions { width: 70, height: 50, samples: 3, integrator, ..one_pixel() };
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let view = crate::common::still_life_camera();
            pool.expect("threads").install(|| image(&still_life, &view, &options))
        };
        assert!(with(1) == with(2), "{}", integrator.name);
    }
}
