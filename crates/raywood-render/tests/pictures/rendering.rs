//! What holds for every picture: the same for any number of threads, stoppable, refused when it makes no sense.

use std::time::{Duration, Instant};

use crate::common::{camera, one_pixel, still_life, still_life_camera};
use raywood::Vec3;
use raywood_render::{
    CameraError, CameraRays, PreparedScene, Progress, RenderError, RenderOptions, render,
};

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

#[test]
fn the_image_does_not_depend_on_the_number_of_threads() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let options = RenderOptions { width: 83, height: 61, samples: 5, ..RenderOptions::default() };
    let with = |threads| {
        pool(threads).install(|| {
            let progress = Progress::new();
            let (image, stats) =
                render(&prepared, &still_life_camera(), &scene.lights, &options, &progress)
                    .expect("an image");
            assert_eq!(progress.pixels_done(), 83 * 61);
            assert_eq!(progress.fraction(), 1.0);
            assert_eq!(stats.threads, threads);
            let bits: Vec<[u32; 3]> =
                image.pixels().iter().map(|c| c.to_array().map(f32::to_bits)).collect();
            (bits, stats.rays)
        })
    };
    let (one, rays) = with(1);
    assert_eq!(rays.primary, 83 * 61 * 5);
    assert!(rays.shadow > 0 && rays.reflection > 0 && rays.refraction > 0);
    for threads in [2, 7] {
        assert!(with(threads) == (one.clone(), rays), "{threads} threads");
    }
}

#[test]
fn a_cancelled_rendering_stops_within_a_tenth_of_a_second() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    // One tile of many samples: the wish must be heard inside a pixel.
    let options = RenderOptions {
        width: 16,
        height: 16,
        samples: RenderOptions::MOST_SAMPLES,
        ..RenderOptions::default()
    };
    let progress = Progress::new();
    let cancelled_at = std::thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(100));
            let now = Instant::now();
            progress.cancel();
            now
        });
        // Threads of its own, so that it waits for no other test.
        let result = pool(2).install(|| {
            render(&prepared, &still_life_camera(), &scene.lights, &options, &progress)
        });
        assert_eq!(result.err(), Some(RenderError::Cancelled));
        watcher.join().expect("the watcher")
    });
    // Generous, for machines that do something else meanwhile.
    assert!(cancelled_at.elapsed() < Duration::from_millis(500));
}

#[test]
fn what_was_cancelled_before_it_began_does_not_begin() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let progress = Progress::new();
    progress.cancel();
    let result = render(&prepared, &still_life_camera(), &[], &one_pixel(), &progress);
    assert_eq!(result.err(), Some(RenderError::Cancelled));
    assert_eq!(progress.pixels_done(), 0);
}

#[test]
fn options_that_make_no_sense_are_refused_by_name() {
    let good = RenderOptions::default();
    assert_eq!(good.validate(), Ok(()));
    let message = |options: RenderOptions| options.validate().expect_err("refused").to_string();
    let empty = message(RenderOptions { width: 0, ..good.clone() });
    assert!(empty.contains("0x800"), "{empty}");
    let huge = message(RenderOptions { width: 100_000, height: 100_000, ..good.clone() });
    assert!(huge.contains("100000x100000") && huge.contains("223.5 GiB"), "{huge}");
    let most = message(RenderOptions { width: u32::MAX, height: u32::MAX, ..good.clone() });
    assert!(most.contains("GiB"), "{most}");
    assert!(message(RenderOptions { samples: 0, ..good.clone() }).contains("0 samples"));
    assert!(message(RenderOptions { max_depth: 65, ..good.clone() }).contains("depth of 65"));
    for cutoff in [0.0, -1.0, 2.0, f32::NAN] {
        assert!(message(RenderOptions { cutoff, ..good.clone() }).contains("cut-off"));
    }
}

#[test]
fn cameras_that_see_nothing_are_refused() {
    let good = camera([0.0, 0.0, 5.0], [0.0; 3]);
    let error = |camera| CameraRays::new(&camera, 4, 4).expect_err("refused");
    let mut blind = good.clone();
    blind.eye.x = f32::NAN;
    assert_eq!(error(blind), CameraError::NotFinite);
    assert_eq!(error(camera([1.0; 3], [1.0; 3])), CameraError::NoDirection);
    for fov_y in [0.0, 180.0, -10.0, f32::NAN] {
        let narrow = raywood_scene::Camera { fov_y, ..good.clone() };
        assert!(matches!(error(narrow), CameraError::FieldOfView { .. }));
    }

    // And the renderer passes it on.
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let result =
        render(&prepared, &camera([1.0; 3], [1.0; 3]), &[], &one_pixel(), &Progress::new());
    assert_eq!(result.err(), Some(RenderError::Camera(CameraError::NoDirection)));
}

#[test]
fn camera_rays_go_through_the_pixels() {
    let camera = raywood_scene::Camera { fov_y: 90.0, ..camera([1.0, 2.0, 3.0], [1.0, 2.0, 0.0]) };
    let rays = CameraRays::new(&camera, 200, 100).expect("a camera");
    let near = |ray: raywood::Ray, expected: Vec3| {
        assert_eq!(ray.origin, camera.eye);
        assert!((ray.direction - expected.normalize_or_zero()).length() < 1e-6, "{ray:?}");
    };
    // Half the height is tan(45 degrees) = 1, half the width twice that.
    near(rays.ray(100.0, 50.0), Vec3::new(0.0, 0.0, -1.0));
    near(rays.ray(0.0, 0.0), Vec3::new(-2.0, 1.0, -1.0));
    near(rays.ray(200.0, 0.0), Vec3::new(2.0, 1.0, -1.0));
    near(rays.ray(0.0, 100.0), Vec3::new(-2.0, -1.0, -1.0));
    near(rays.ray(200.0, 100.0), Vec3::new(2.0, -1.0, -1.0));
}

#[test]
fn an_up_along_the_line_of_sight_is_replaced() {
    for (target, up) in
        [([0.0, 0.0, 0.0], Vec3::Z), ([0.0, 0.0, 0.0], Vec3::ZERO), ([0.0, -7.0, 5.0], Vec3::Y)]
    {
        let camera = raywood_scene::Camera { up, ..camera([0.0, 0.0, 5.0], target) };
        let rays = CameraRays::new(&camera, 10, 10).expect("a camera");
        let across = rays.ray(10.0, 5.0).direction - rays.ray(0.0, 5.0).direction;
        let down = rays.ray(5.0, 10.0).direction - rays.ray(5.0, 0.0).direction;
        assert!(across.length() > 0.1 && down.length() > 0.1);
        assert!(across.dot(down).abs() < 1e-5);
    }
}
