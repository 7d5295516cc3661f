//! Features beside a picture, and the filter against noise that they guide.

use raywood::Vec3;
use raywood_render::{
    Features, Film, FilmPixel, Goal, Image, Integrator, NO_ID, Part, PreparedScene, Progress,
    RenderOptions, Shot, denoise, features, primitive_ids, render_passes,
};
use raywood_scene::{Camera, LightKind, Material, Rgb, Scene};

use crate::common::{assert_near, camera, flat_background, image, level, light, matte, scene};

fn options(width: u32, height: u32, samples: u32) -> RenderOptions {
    let integrator = Integrator::by_name("path").expect("the path tracer");
    RenderOptions { width, height, samples, integrator, ..RenderOptions::default() }
}

fn features_of(scene: &Scene, view: &Camera, options: &RenderOptions) -> Features {
    let prepared = PreparedScene::new(scene).expect("a tree");
    features(&prepared, view, options, options.samples, &Progress::new()).expect("features")
}

#[test]
fn features_are_those_of_the_surface_that_is_seen() {
    // Half of the picture sees a wall that leans away, the other half nothing.
    let wall = [[-9.0, -9.0, -4.0], [0.0, -9.0, -4.0], [0.0, 9.0, -4.0], [-9.0, 9.0, -4.0]];
    let grey = Material { diffuse: Rgb::new(0.5, 0.25, 0.125), ..matte(0.0) };
    let scene = scene(&[(wall, 1)], &[], vec![matte(0.0), grey]);
    let view = camera([0.0; 3], [0.0, 0.0, -1.0]);
    let options = options(8, 8, 16);
    let found = features_of(&scene, &view, &options);
    let (left, right, edge) = (8 * 4 + 1, 8 * 4 + 6, 8 * 4 + 4);
    assert_near(found.albedo[left], Rgb::new(0.5, 0.25, 0.125), 1e-5);
    assert_near(found.normals[left], Vec3::Z, 1e-5);
    // In front of the eye, not along the ray; and at the middle of the pixel.
    assert!((found.depths[left] - 4.0).abs() < 1e-4 && found.coverage[left] == 1.0);
    let x = -2.5 * (2.0 * 4.0 * 20.0f32.to_radians().tan() / 8.0);
    assert!((found.positions[left].x - x).abs() < 0.05, "{:?}", found.positions[left]);
    assert_eq!((found.depths[right], found.coverage[right]), (f32::INFINITY, 0.0));
    assert_eq!((found.albedo[right], found.positions[right]), (Rgb::ZERO, Rgb::ZERO));
    // Where only some rays meet it, distances are those of these.
    assert!(found.coverage[edge] > 0.0 && found.coverage[edge] < 0.5);
    assert!((found.depths[edge] - 4.0).abs() < 1e-3);

    let prepared = PreparedScene::new(&scene).expect("a tree");
    let ids = primitive_ids(&prepared, &view, &options, &Progress::new()).expect("ids");
    assert_eq!((ids[left][1], ids[right]), (1, [NO_ID; 3]));
    assert!(ids[left][0] < 2 && ids[edge] == [NO_ID; 3]);
}

/// A film of which all passes found the same: without noise.
fn exact(image: &Image) -> Film {
    let pixel =
        |&light: &Rgb| FilmPixel { sum: 8.0 * light, samples: 8, passes: 2, deviation: 0.0 };
    let pixels = image.pixels().iter().map(pixel).collect();
    Film::from_pixels(image.width(), image.height(), pixels).expect("a film")
}

/// A checkered floor with a ball, in front of the sky, and so many lamps above what is seen.
fn checkered(lamps: usize) -> (Scene, Camera) {
    let checks = Material {
        pattern: raywood_scene::Pattern::Checker { other: Rgb::new(0.6, 0.1, 0.05), size: 0.5 },
        ..matte(0.8)
    };
    let lamp = Material { emission: Rgb::splat(30.0), ..matte(0.0) };
    let mut spheres = vec![([0.0, 0.5, 0.0], 0.5, 1)];
    spheres.extend((0..lamps).map(|number| {
        let (sin, cos) = (number as f32 / lamps as f32 * std::f32::consts::TAU).sin_cos();
        ([3.5 * sin, 3.0, 3.5 * cos], 0.15, 2)
    }));
    let mut scene = scene(&[(level(0.0, 4.0, true), 0)], &spheres, vec![checks, matte(0.5), lamp]);
    scene.background = flat_background(Rgb::new(0.2, 0.3, 0.6));
    (scene, camera([0.0, 1.5, 4.0], [0.0, 0.3, 0.0]))
}

/// The same in the sun, without lamps.
fn sunny() -> (Scene, Camera) {
    let (mut scene, view) = checkered(0);
    let direction = Vec3::new(-0.6, -0.8, 0.0);
    scene.lights = vec![light(LightKind::directional(direction), 1.0)];
    (scene, view)
}

#[test]
fn what_has_no_noise_stays_as_it_is() {
    let (scene, view) = sunny();
    let options = options(80, 50, 16);
    let found = features_of(&scene, &view, &options);
    let (picture, _) = image(&scene, &view, &options);
    let denoised = denoise(&exact(&picture), &found).expect("a picture");
    for (a, b) in denoised.pixels().iter().zip(picture.pixels()) {
        assert!((*a - *b).abs().max_element() <= 1e-5 * b.max_element(), "{b:?} became {a:?}");
    }
}

#[test]
fn noise_falls_and_edges_and_textures_stay() {
    // A path asks one of the lamps, near or far: that is noise, and as much on the ball as on the checks.
    let (scene, view) = checkered(12);
    let few = options(80, 50, 16);
    let found = features_of(&scene, &view, &few);
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let mut film = Film::new(80, 50).expect("a film");
    let (camera, lights, part) = (&view, &scene.lights, Part::Whole);
    let shot = Shot { scene: &prepared, camera, lights, options: &few, part };
    render_passes(&shot, &Goal::default(), &mut film, &Progress::new(), None).expect("passes");
    let (reference, _) = image(&scene, &view, &options(80, 50, 4096));
    let error = |image: &Image, pixels: &[usize]| {
        let squares = pixels.iter().map(|&pixel| {
            let off = image.pixels()[pixel] - reference.pixels()[pixel];
            off.dot(off)
        });
        (squares.sum::<f32>() / pixels.len() as f32).sqrt()
    };
    // At edges sixteen samples are off by how much of either side they saw, which is no noise of the light.
    let same = |a: usize, b: usize| {
        (found.albedo[a] - found.albedo[b]).abs().max_element() < 0.02
            && found.normals[a].dot(found.normals[b]) > 0.9
    };
    let all: Vec<usize> = (0..80 * 50).collect();
    let is_inside = |&pixel: &usize| {
        let (x, y) = (pixel % 80, pixel / 80);
        (1..79).contains(&x)
            && (1..49).contains(&y)
            && [1, 80].iter().all(|step| same(pixel, pixel - step) && same(pixel, pixel + step))
    };
    let inside: Vec<usize> = all.iter().copied().filter(is_inside).collect();
    let (noisy, denoised) = (film.image(true), denoise(&film, &found).expect("a picture"));
    assert!(inside.len() > 400, "{} pixels inside", inside.len());
    assert!(error(&denoised, &all) < error(&noisy, &all));
    let (before, after) = (error(&noisy, &inside), error(&denoised, &inside));
    assert!(after < 0.7 * before, "an error of {before} became {after}");
    // No light is lost.
    let sum = |image: &Image| image.pixels().iter().map(|p| p.x + p.y + p.z).sum::<f32>();
    assert!((sum(&denoised) / sum(&reference) - 1.0).abs() < 0.02);
    // Another size, or too few passes.
    let small = Film::new(1, 1).expect("a film");
    assert!(denoise(&small, &found).is_none());
}
