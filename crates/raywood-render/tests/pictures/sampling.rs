//! How pictures are sampled: in passes, until the noise is low, through filters and lenses.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use raywood_render::{
    Ended, Film, FilmPixel, Goal, Image, Integrator, Keeper, Lens, Part, PixelFilter,
    PreparedScene, Progress, Region, RenderError, RenderOptions, Shot, depth_at, key_exposure,
    noise, render, render_passes,
};
use raywood_scene::{Camera, Material, Rgb, Scene, luminance};

use crate::common::{
    camera, flat_background, image, level, matte, scene, still_life, still_life_camera,
};

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

fn path(width: u32, height: u32, samples: u32) -> RenderOptions {
    let integrator = Integrator::by_name("path").expect("the path tracer");
    RenderOptions { width, height, samples, integrator, ..RenderOptions::default() }
}

fn lamp(strength: f32) -> Material {
    Material { emission: Rgb::splat(strength), ..matte(0.0) }
}

/// A lamp over a floor with a ball: soft shadows, and so noise.
fn lit_floor() -> Scene {
    let lamp_below = level(2.0, 0.5, false);
    scene(
        &[(level(0.0, 3.0, true), 0), (lamp_below, 1)],
        &[([0.4, 0.3, 0.0], 0.3, 0)],
        vec![matte(0.7), lamp(8.0)],
    )
}

fn lit_floor_camera() -> Camera {
    camera([0.0, 1.2, 3.0], [0.0, 0.3, 0.0])
}

/// A whole picture, lit by the scene's lights.
fn shot<'a>(
    prepared: &'a PreparedScene<'a>,
    camera: &'a Camera,
    options: &'a RenderOptions,
) -> Shot<'a> {
    let lights = &prepared.scene().lights;
    Shot { scene: prepared, camera, lights, options, part: Part::Whole }
}

/// A film of passes, on so many threads.
fn film(scene: &Scene, view: &Camera, options: &RenderOptions, goal: Goal) -> (Film, Ended) {
    let prepared = PreparedScene::new(scene).expect("a tree");
    let mut film = Film::new(options.width, options.height).expect("a film");
    let shot = shot(&prepared, view, options);
    let (stats, ended) =
        render_passes(&shot, &goal, &mut film, &Progress::new(), None).expect("passes");
    let rays: u64 = film.pixels().iter().map(|pixel| u64::from(pixel.samples)).sum();
    assert_eq!(stats.rays.primary, rays);
    (film, ended)
}

fn mean(image: &Image) -> f32 {
    let sum: f32 = image.pixels().iter().map(|&pixel| luminance(pixel)).sum();
    sum / image.pixels().len() as f32
}

#[test]
fn passes_make_the_same_picture_as_all_at_once() {
    let scene = still_life();
    for integrator in ["whitted", "path", "ao", "normals"] {
        let integrator = Integrator::by_name(integrator).expect("a name");
        let options = RenderOptions { integrator, ..path(50, 35, 21) };
        let view = still_life_camera();
        let (film, ended) = film(&scene, &view, &options, Goal::default());
        assert_eq!((ended, film.samples()), (Ended::Samples, (21, 21)));
        let (whole, _) = image(&scene, &view, &options);
        let passes = film.image(integrator.shows_light);
        for (a, b) in passes.pixels().iter().zip(whole.pixels()) {
            let near = 1e-4 * b.max_element().max(0.01);
            assert!((*a - *b).abs().max_element() < near, "{integrator:?}: {a:?} was {b:?}");
        }
        assert_eq!(passes.are_numbers(), whole.are_numbers());
    }
}

#[test]
fn noise_decides_the_same_for_any_number_of_threads_and_favours_no_side() {
    let scene = lit_floor();
    let goal = Goal { noise: Some(0.05), ..Goal::default() };
    let (mut sum, mut seeds) = (0.0, 0);
    for seed in 0..4 {
        let options = RenderOptions { seed, ..path(64, 48, 4096) };
        let with =
            |threads| pool(threads).install(|| film(&scene, &lit_floor_camera(), &options, goal));
        let (one, ended) = with(1);
        if seed == 0 {
            assert!(with(2) == (one.clone(), ended), "two threads");
        }
        let (fewest, most) = one.samples();
        assert_eq!(ended, Ended::Noise);
        assert!(fewest >= 16 && fewest < most && most < 4096, "{fewest} to {most} samples");
        assert!(noise(&one, &Part::Whole) <= 0.05);
        sum += mean(&one.image(true));
        seeds += 1;
    }

    // Many samples everywhere know the brightness: to a thousandth, as all pixels together are exact.
    let (reference, _) = image(&scene, &lit_floor_camera(), &path(64, 48, 1024));
    let (found, expected) = (sum / seeds as f32, mean(&reference));
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} is not {expected}");

    // And the error of pixels is what was asked for, not far below or above.
    let (film, _) = film(&scene, &lit_floor_camera(), &path(64, 48, 4096), goal);
    let squares =
        film.image(true).pixels().iter().zip(reference.pixels()).fold(0.0, |sum, (a, b)| {
            sum + ((luminance(*a) - luminance(*b)) / (luminance(*b) + 0.1 * expected)).powi(2)
        });
    let error = (squares / reference.pixels().len() as f32).sqrt();
    assert!((0.005..0.1).contains(&error), "{error} where 0.05 was asked for");
}

#[test]
fn what_was_stopped_goes_on_as_if_nothing_had_happened() {
    let scene = lit_floor();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let (view, options) = (lit_floor_camera(), path(100, 70, 96));
    let (whole, _) = film(&scene, &view, &options, Goal::default());

    let mut film = Film::new(100, 70).expect("a film");
    let passes = |film: &mut Film, progress: &Progress| {
        let shot = shot(&prepared, &view, &options);
        render_passes(&shot, &Goal::default(), film, progress, None)
    };
    let mut stops = 0;
    loop {
        let before = film.mean_samples();
        let (progress, is_over) = (Progress::new(), AtomicBool::new(false));
        let ended = std::thread::scope(|scope| {
            let watcher = scope.spawn(|| {
                // Until something more is there, or all was there too soon to be seen.
                let is_early = || progress.standing().samples == 0 && progress.fraction() < 0.3;
                while is_early() && !is_over.load(Ordering::Relaxed) {
                    std::thread::yield_now();
                }
                std::thread::sleep(Duration::from_millis(3));
                progress.cancel();
            });
            let ended = passes(&mut film, &progress);
            is_over.store(true, Ordering::Relaxed);
            watcher.join().expect("the watcher");
            ended
        });
        match ended {
            Ok((_, Ended::Samples)) => break,
            Ok((_, ended)) => assert_eq!(ended, Ended::Cancelled),
            Err(error) => assert_eq!(error, RenderError::Cancelled),
        }
        assert!(film.mean_samples() >= before);
        stops += 1;
        if stops == 20 {
            passes(&mut film, &Progress::new()).expect("the rest");
            break;
        }
    }
    assert!(film == whole, "after {stops} stops");
}

#[test]
fn a_picture_is_the_same_however_often_it_is_paused_or_broken_off_and_whatever_its_parts() {
    let scene = lit_floor();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let view = lit_floor_camera();
    let whitted = Integrator::by_name("whitted").expect("a name");
    let in_one_pass = Goal { in_one_pass: true, ..Goal::default() };
    let noise = Goal { noise: Some(0.2), ..Goal::default() };
    for (goal, integrator, samples) in
        [(noise, path(1, 1, 1).integrator, 4096), (in_one_pass, whitted, 5)]
    {
        let options = RenderOptions { integrator, ..path(130, 70, samples) };
        let (whole, how) = film(&scene, &view, &options, goal);
        if goal.in_one_pass {
            assert!(whole.image(true) == image(&scene, &view, &options).0, "as at once");
        }
        let whole_shot = shot(&prepared, &view, &options);

        // Broken off in the middle of passes: what the keeper has seen last goes on in another film.
        let mut kept = Film::new(130, 70).expect("a film");
        for threads in [1, 2, 1, 3] {
            let mut film = kept.clone();
            let progress = Progress::new();
            let (mut calls, mut seen) = (0, None);
            let mut keep = |film: &Film| {
                calls += 1;
                seen = Some(film.clone());
                if calls == 3 {
                    progress.cancel();
                }
                Duration::ZERO
            };
            let keeper = Keeper { every: Duration::ZERO, keep: &mut keep };
            let passes = || render_passes(&whole_shot, &goal, &mut film, &progress, Some(keeper));
            match pool(threads).install(passes) {
                Ok((_, ended)) if ended == how => seen = Some(film),
                Ok((_, Ended::Cancelled)) | Err(RenderError::Cancelled) => {}
                other => panic!("{other:?}"),
            }
            kept = seen.expect("it was kept");
        }
        let ended = render_passes(&whole_shot, &goal, &mut kept, &Progress::new(), None);
        assert_eq!(ended.expect("the rest").1, how);
        assert!(kept == whole, "broken off");

        // In shares, one of which is there twice, the other time not as far; and in regions.
        let region = |x, y, width, height| Part::Region(Region { x, y, width, height });
        let share = |index| Part::Share { index, count: 3 };
        let parts = [
            vec![share(2), share(0), share(1)],
            vec![region(0, 0, 50, 70), region(40, 0, 90, 33), region(50, 33, 80, 37)],
        ];
        for parts in parts {
            let mut united = Film::new(130, 70).expect("a film");
            for part in parts {
                let mut film = Film::new(130, 70).expect("a film");
                let shot = Shot { part, ..whole_shot };
                let (_, ended) =
                    render_passes(&shot, &goal, &mut film, &Progress::new(), None).expect("a part");
                assert_eq!(ended, how);
                united.unite(&film);
                united.unite(&Film::new(130, 70).expect("a film"));
            }
            assert!(united == whole, "put together");
        }
        let nothing = [
            region(130, 0, 1, 1),
            region(0, 69, 1, 2),
            region(0, 0, 0, 1),
            Part::Share { index: 15, count: 16 },
        ];
        for part in nothing {
            let mut film = Film::new(130, 70).expect("a film");
            let shot = Shot { part, ..whole_shot };
            let error = render_passes(&shot, &goal, &mut film, &Progress::new(), None);
            assert!(matches!(error, Err(RenderError::NoPart { .. })), "{part:?}");
        }
    }
}

#[test]
fn films_are_cropped_and_united_by_tiles() {
    let pixels = (0..6).map(|number| one_sample(number as f32)).collect();
    let film = Film::from_pixels(3, 2, pixels).expect("a film");
    let region = Region { x: 1, y: 0, width: 2, height: 2 };
    let sums: Vec<_> = film.cropped(region).pixels().iter().map(|pixel| pixel.sum.x).collect();
    assert_eq!(sums, [1.0, 2.0, 4.0, 5.0]);
    let beyond = film.cropped(Region { x: 2, y: 1, width: 9, height: u32::MAX });
    assert_eq!((beyond.width(), beyond.height(), beyond.pixels().len()), (1, 1, 1));
    assert!(film.cropped(Region { x: 7, y: 7, width: 1, height: 1 }).pixels().is_empty());
}

fn one_sample(light: f32) -> FilmPixel {
    FilmPixel { sum: Rgb::splat(light), samples: 1, passes: 1, deviation: 0.0 }
}

#[test]
fn time_ends_a_picture_that_has_no_end() {
    let scene = lit_floor();
    let goal = Goal { time: Some(Duration::from_millis(300)), ..Goal::default() };
    let started = Instant::now();
    let (film, ended) = film(&scene, &lit_floor_camera(), &path(32, 24, 1 << 20), goal);
    assert_eq!(ended, Ended::Time);
    // Generous, for machines that do something else meanwhile.
    assert!(started.elapsed() < Duration::from_secs(3));
    let (fewest, most) = film.samples();
    assert!(fewest >= 1 && fewest == most);
}

#[test]
fn other_seeds_have_other_noise_around_the_same_light() {
    let scene = lit_floor();
    let with = |seed| {
        let options = RenderOptions { seed, ..path(40, 30, 64) };
        image(&scene, &lit_floor_camera(), &options).0
    };
    let [first, second] = [with(0), with(1)];
    assert!(first == with(0) && first != second);
    assert!((mean(&first) / mean(&second) - 1.0).abs() < 0.01);
}

/// A small ball that shines, and nothing else, as far in front of the eye as asked.
fn star(distance: f32) -> (Scene, Camera) {
    let scene = scene(&[], &[([0.0, 0.0, -distance], 0.02 * distance, 0)], vec![lamp(1.0)]);
    (scene, camera([0.0; 3], [0.0, 0.0, -distance]))
}

/// The light of a picture in all, and the mean squared distance from its middle, along x, in pixels.
fn spread(image: &Image) -> (f32, f32) {
    let middle = 0.5 * image.width() as f32;
    let (mut light, mut squares) = (0.0, 0.0);
    for (i, pixel) in image.pixels().iter().enumerate() {
        let x = (i % image.width() as usize) as f32 + 0.5 - middle;
        light += pixel.x;
        squares += x * x * pixel.x;
    }
    (light, squares / light)
}

#[test]
fn filters_keep_the_light_and_spread_it_as_they_say() {
    let (scene, view) = star(5.0);
    let with = |filter| {
        let options =
            RenderOptions { width: 63, height: 63, samples: 1024, filter, ..path(1, 1, 1) };
        spread(&image(&scene, &view, &options).0)
    };
    // Pixels are themselves one wide: their middles are off by a twelfth. The ball is the same for all.
    let (light, squares) = with(PixelFilter::Box);
    let variances = [(PixelFilter::Tent, 1.0 / 6.0), (PixelFilter::BlackmanHarris, 0.1727)];
    for (filter, variance) in variances {
        let (other_light, other_squares) = with(filter);
        assert!((other_light / light - 1.0).abs() < 0.01, "{filter:?}: {other_light}, {light}");
        let more = other_squares - squares + 1.0 / 12.0;
        assert!((more - variance).abs() < 0.03, "{filter:?}: {more}, not {variance}");
    }
}

#[test]
fn a_lens_blurs_by_its_width_and_the_distance_from_focus() {
    let (size, distance, radius) = (64, 5.0, 0.1);
    for integrator in ["whitted", "path"] {
        let integrator = Integrator::by_name(integrator).expect("a name");
        let (scene, view) = star(distance);
        let with = |lens| {
            let options = RenderOptions { integrator, lens, ..path(size, size, 1024) };
            image(&scene, &view, &options).0
        };
        let sharp = with(None);
        let (light, squares) = spread(&sharp);
        // In focus nothing changes but the noise.
        let (focused_light, focused) = spread(&with(Some(Lens { radius, focus: distance })));
        assert!((focused / squares - 1.0).abs() < 0.02, "{focused} was {squares}");
        assert!((focused_light / light - 1.0).abs() < 0.01);
        assert!(with(Some(Lens { radius: 0.0, focus: 1.0 })) == sharp, "a pinhole");

        for focus in [3.0, 12.0] {
            // Similar triangles: the disk at the ball's distance, in pixels there; the mean square along an axis is a quarter of the radius squared.
            let disk = radius * (distance - focus).abs() / focus;
            let pixel = 2.0 * distance * 20.0f32.to_radians().tan() / size as f32;
            let expected = 0.25 * (disk / pixel).powi(2);
            let (blurred_light, blurred) = spread(&with(Some(Lens { radius, focus })));
            let more = blurred - squares;
            assert!((more / expected - 1.0).abs() < 0.05, "{focus}: {more} is not {expected}");
            assert!((blurred_light / light - 1.0).abs() < 0.02, "{focus}: light is lost");
        }
    }
}

#[test]
fn a_plane_in_focus_is_as_sharp_as_through_a_pinhole() {
    // A wall with an edge, seen along its normal: every point of it is in the plane of focus.
    let wall = |x: f32, y: f32| [[-x, -y, -4.0], [0.0, -y, -4.0], [0.0, y, -4.0], [-x, y, -4.0]];
    let mut scene = scene(&[(wall(9.0, 9.0), 0)], &[], vec![lamp(1.0)]);
    scene.background = flat_background(Rgb::ZERO);
    let view = camera([0.0; 3], [0.0, 0.0, -1.0]);
    let with = |lens| image(&scene, &view, &RenderOptions { lens, ..path(33, 33, 64) }).0;
    let (sharp, focused) = (with(None), with(Some(Lens { radius: 0.8, focus: 4.0 })));
    for (a, b) in sharp.pixels().iter().zip(focused.pixels()) {
        assert!((a.x - b.x).abs() < 0.02, "{a:?} became {b:?}");
    }
    let blurred = with(Some(Lens { radius: 0.8, focus: 2.0 }));
    let row = |image: &Image| image.row(16).iter().filter(|p| p.x > 0.05 && p.x < 0.95).count();
    assert!(row(&sharp) <= 3 && row(&blurred) > 8, "{} and {}", row(&sharp), row(&blurred));

    let prepared = PreparedScene::new(&scene).expect("a tree");
    let depth = |place| depth_at(&prepared, &view, (33, 33), place).expect("a camera");
    assert!((depth([1.5, 20.0]).expect("the wall") - 4.0).abs() < 1e-4);
    assert_eq!(depth([30.0, 16.0]), None);
}

#[test]
fn f_numbers_mean_what_photographers_say() {
    // 50 mm behind 24 mm: 26.99 degrees; f/2 is 25 mm wide.
    let fov = 2.0 * (12.0f32 / 50.0).atan().to_degrees();
    let lens = Lens::of_f_number(2.0, fov, 3.0);
    assert!((lens.radius - 0.0125).abs() < 1e-6 && lens.focus == 3.0);
}

#[test]
fn lenses_and_films_that_make_no_sense_are_refused() {
    for (radius, focus) in [(-1.0, 1.0), (f32::NAN, 1.0), (0.1, 0.0), (0.1, f32::INFINITY)] {
        let lens = Some(Lens { radius, focus });
        let error = RenderOptions { lens, ..RenderOptions::default() }.validate();
        let said = error.expect_err("refused").to_string();
        assert!(said.starts_with("a lens of radius "), "{said}");
    }
    assert!(Film::from_pixels(2, 2, Vec::new()).is_none());
    // What fits at once may not fit in passes, and is told before any memory is taken.
    let scene = lit_floor();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let options = path(11_584, 11_584, 1);
    assert_eq!(options.validate(), Ok(()));
    let mut film = Film::new(1, 1).expect("a film");
    let (view, progress) = (lit_floor_camera(), Progress::new());
    let mut passes = |options: &RenderOptions, progress: &Progress| {
        let shot = shot(&prepared, &view, options);
        render_passes(&shot, &Goal::default(), &mut film, progress, None)
    };
    let error = passes(&options, &progress);
    assert!(matches!(error, Err(RenderError::ImageTooLarge { .. })));
    let cancelled = Progress::new();
    cancelled.cancel();
    let options = path(1, 1, 1);
    let error = passes(&options, &cancelled);
    assert_eq!(error.err(), Some(RenderError::Cancelled));
    assert!(render(&prepared, &view, &[], &options, &Progress::new()).is_ok());
}

#[test]
fn the_key_is_the_log_average_of_what_is_lit() {
    let of = |lights: &[f32]| {
        let pixels = lights.iter().map(|&light| Rgb::splat(light)).collect();
        key_exposure(&Image::from_pixels(lights.len() as u32, 1, pixels))
    };
    assert!((of(&[0.5; 3]) - 0.36).abs() < 1e-5);
    // The geometric mean of 1 and 4 is 2; black does not count.
    assert!((of(&[1.0, 0.0, 4.0, f32::NAN]) - 0.09).abs() < 1e-5);
    assert_eq!(of(&[0.0]), 1.0);
}
