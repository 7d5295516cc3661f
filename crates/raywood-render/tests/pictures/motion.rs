//! Pictures of scenes in which instances move.

use raywood::{Transform, Vec3};
use raywood_render::{
    INTEGRATORS, Image, Integrator, PixelFilter, PreparedScene, Progress, RenderError,
    RenderOptions, Shutter, default_view, primitive_ids, render,
};
use raywood_scene::{Instance, Instances, Material, Rgb, Scene};

use crate::common::{camera, flat_background, image, matte, scene};

fn integrator(name: &str) -> &'static Integrator {
    Integrator::by_name(name).expect("it exists")
}

/// An upright square from -1 to 1 that shines, faces z and moves.
fn moving_square(first: Transform, later: Transform) -> Scene {
    let square = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let shining = Material { emission: Rgb::ONE, ..matte(1.0) };
    let mut scene = scene(&[(square, 0)], &[], vec![shining]);
    let moving = Instance { later: Some(later), ..Instance::new(0, first) };
    scene.instances = Instances::new(vec![0], 2, vec![moving]).expect("good transforms");
    scene
}

/// How much of the time from one to another a square covers a place that moves from -1 to 1 meanwhile, in the mean over a pixel.
fn coverage(x: f32, width: f32, Shutter { open, close }: Shutter) -> f32 {
    let place = |x: f32| {
        let (begins, ends) = ((x / 2.0).max(open), ((x + 2.0) / 2.0).min(close));
        (ends - begins).max(0.0) / (close - open)
    };
    (0..64).map(|step| place(x + width * ((step as f32 + 0.5) / 64.0 - 0.5))).sum::<f32>() / 64.0
}

#[test]
fn a_moving_square_leaves_a_ramp() {
    let at = |x: f32| Transform::translation([x, 0.0, 0.0]);
    let scene = moving_square(at(-1.0), at(1.0));
    let camera = camera([0.0, 0.0, 10.0], [0.0, 0.0, 0.0]);
    let pixel = 2.0 * 10.0 * 20.0f32.to_radians().tan() / 40.0;
    for name in ["whitted", "path", "albedo"] {
        for shutter in [Shutter::default(), Shutter { open: 0.25, close: 0.5 }] {
            let options = RenderOptions {
                width: 40,
                height: 40,
                samples: 1024,
                filter: PixelFilter::Box,
                shutter,
                integrator: integrator(name),
                ..RenderOptions::default()
            };
            let (image, _) = image(&scene, &camera, &options);
            let mut between = 0;
            for y in 18..22 {
                for x in 0..40 {
                    let found = image.pixel(x, y).x;
                    let expected = coverage(pixel * (x as f32 - 19.5), pixel, shutter);
                    assert!(
                        (found - expected).abs() < 0.03,
                        "{name} {shutter:?}: {found} at {x},{y}, expected {expected}"
                    );
                    between += usize::from(expected > 0.1 && expected < 0.9);
                }
            }
            assert!(between > 8, "{between}");
        }
    }
}

/// The scene of other tests, all instances of which move.
fn moving() -> Scene {
    let mut scene = crate::instances::scene();
    let mut placed = scene.instances.placed().to_vec();
    for (number, instance) in placed.iter_mut().enumerate() {
        let turn = Transform::rotation([0.3, 1.0, 0.2], 25.0 - 10.0 * number as f32);
        let away = Transform::translation([0.5, 0.2 * number as f32 - 0.4, 0.3]);
        let size = Transform::scaling([1.0, 1.2, 0.8]);
        let [x, y, z] = instance.transform.point(Vec3::ZERO).to_array();
        let to_middle = Transform::translation([-x, -y, -z]);
        let back = Transform::translation([x, y, z]);
        let change = to_middle.then(&turn).then(&size).then(&back).then(&away);
        instance.later = Some(instance.transform.then(&change));
    }
    let end = scene.mesh.triangles.triangles().len() as u32;
    scene.instances = Instances::new(vec![2], end, placed).expect("good transforms");
    scene
}

/// Everything where it is at a time.
fn frozen(scene: &Scene, time: f32) -> Scene {
    let still = |instance: &Instance| {
        let later = instance.later.unwrap_or(instance.transform);
        Instance { transform: instance.transform.blended(&later, time), later: None, ..*instance }
    };
    let placed = scene.instances.placed().iter().map(still).collect();
    let end = scene.mesh.triangles.triangles().len() as u32;
    let instances = Instances::new(vec![2], end, placed).expect("good transforms");
    Scene { instances, ..scene.clone() }
}

fn picture(scene: &Scene, options: &RenderOptions) -> Image {
    let prepared = PreparedScene::new(scene).expect("it builds");
    let view = default_view(&prepared, 1.6);
    render(&prepared, &view.camera, &view.lights, options, &Progress::new()).expect("a picture").0
}

const SIZE: (u32, u32) = (96, 60);

fn options(integrator: &'static Integrator, samples: u32, shutter: Shutter) -> RenderOptions {
    let (width, height) = SIZE;
    RenderOptions { width, height, samples, integrator, shutter, ..RenderOptions::default() }
}

/// The share of pixels that differ, and the sum of each picture.
fn compared(a: &Image, b: &Image) -> (f64, [f64; 2]) {
    let (mut differ, mut sums) = (0u32, [0.0f64; 2]);
    for y in 0..SIZE.1 {
        for (p, q) in a.row(y).iter().zip(b.row(y)) {
            let difference = (*p - *q).abs().max_element();
            differ += u32::from(difference > 0.02 * (1.0 + p.max_element()));
            sums[0] += f64::from(p.x + p.y + p.z);
            sums[1] += f64::from(q.x + q.y + q.z);
        }
    }
    (f64::from(differ) / f64::from(SIZE.0 * SIZE.1), sums)
}

#[test]
fn a_shutter_that_closes_at_once_shows_what_stands_still() {
    let scene = moving();
    for integrator in &INTEGRATORS {
        for time in [0.0, 0.6, 1.0] {
            // What is black in pictures of depth is decided by what is seen at time 0.
            if integrator.name == "depth" && time > 0.0 {
                continue;
            }
            // Lights are chosen by what they are at time 0, so that paths are others.
            let (samples, is_path) =
                if integrator.name == "path" { (64, true) } else { (2, false) };
            let still =
                picture(&frozen(&scene, time), &options(integrator, samples, Shutter::default()));
            let shutter = Shutter { open: time, close: time };
            let (share, [a, b]) =
                compared(&picture(&scene, &options(integrator, samples, shutter)), &still);
            let most = if is_path { 1.0 } else { 0.01 };
            assert!(share <= most, "{} at {time}: {share} differ", integrator.name);
            assert!((a - b).abs() < 0.01 * b, "{} at {time}: {a}, still {b}", integrator.name);
        }
    }
}

/// Shadows, mirror images, light through glass and from moving lamps: all are means over time.
#[test]
fn pictures_are_means_over_the_time() {
    let scene = moving();
    let shutter = Shutter { open: 0.1, close: 0.9 };
    for (name, samples) in [("whitted", 64), ("path", 256), ("normals", 64)] {
        let blurred = picture(&scene, &options(integrator(name), samples, shutter));
        let steps = 32;
        let mut sums = vec![Rgb::ZERO; (SIZE.0 * SIZE.1) as usize];
        for step in 0..steps {
            let time = 0.1 + 0.8 * (step as f32 + 0.5) / steps as f32;
            let of_time = RenderOptions {
                seed: step,
                ..options(integrator(name), samples / 8, Shutter::default())
            };
            let still = picture(&frozen(&scene, time), &of_time);
            for y in 0..SIZE.1 {
                for (sum, pixel) in sums[(y * SIZE.0) as usize..].iter_mut().zip(still.row(y)) {
                    *sum += (1.0 / steps as f32) * *pixel;
                }
            }
        }
        // Of blocks of pixels, whose noise is less.
        let (mut worst, mut total) = (0.0f64, [0.0f64; 2]);
        for top in (0..SIZE.1).step_by(12) {
            for left in (0..SIZE.0).step_by(12) {
                let mut block = [0.0f64; 2];
                for y in top..top + 12 {
                    for x in left..left + 12 {
                        let [p, q] = [blurred.pixel(x, y), sums[(y * SIZE.0 + x) as usize]];
                        block[0] += f64::from(p.x + p.y + p.z);
                        block[1] += f64::from(q.x + q.y + q.z);
                    }
                }
                total = [total[0] + block[0], total[1] + block[1]];
                worst = worst.max((block[0] - block[1]).abs() / (block[1] + 10.0));
            }
        }
        let mean = (total[0] - total[1]).abs() / total[1];
        assert!(mean < 0.005 && worst < 0.06, "{name}: {mean} in all, {worst} in a block");
    }
}

#[test]
fn what_stands_still_does_not_depend_on_the_shutter() {
    let scene = crate::instances::scene();
    for name in ["whitted", "path", "depth"] {
        let of = |open: f32, close: f32| {
            picture(&scene, &options(integrator(name), 4, Shutter { open, close }))
        };
        assert_eq!(of(0.0, 1.0), of(0.5, 0.5), "{name}");
    }
}

#[test]
fn ids_are_those_of_the_middle_of_the_time() {
    let at = |x: f32| Transform::translation([x, 0.0, 0.0]);
    let scene = moving_square(at(-1.0), at(1.0));
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let camera = camera([0.0, 0.0, 10.0], [0.0, 0.0, 0.0]);
    let options = RenderOptions { width: 40, height: 40, ..RenderOptions::default() };
    let seen = |shutter: Shutter| {
        let options = RenderOptions { shutter, ..options.clone() };
        let ids = primitive_ids(&prepared, &camera, &options, &Progress::new()).expect("ids");
        let row = &ids[20 * 40..21 * 40];
        let first = row.iter().position(|id| id[0] != u32::MAX).expect("the square");
        (first, row.iter().filter(|id| id[0] != u32::MAX).count())
    };
    // Eleven pixels are two wide.
    let (first, count) = seen(Shutter::default());
    assert!((14..16).contains(&first) && (10..13).contains(&count), "{first} {count}");
    let (first, _) = seen(Shutter { open: 1.0, close: 1.0 });
    assert!((19..22).contains(&first), "{first}");
}

#[test]
fn shutters_that_make_no_sense_are_refused() {
    let scene = moving_square(Transform::IDENTITY, Transform::translation([1.0, 0.0, 0.0]));
    let scene = Scene { background: flat_background(Rgb::ONE), ..scene };
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let camera = camera([0.0, 0.0, 10.0], [0.0, 0.0, 0.0]);
    for (open, close) in [(-0.1, 1.0), (0.0, 1.1), (0.6, 0.5), (f32::NAN, 1.0), (0.0, f32::NAN)] {
        let shutter = Shutter { open, close };
        let options = RenderOptions { shutter, ..RenderOptions::default() };
        let error = render(&prepared, &camera, &[], &options, &Progress::new()).err();
        let Some(RenderError::Shutter(found)) = error else { panic!("{shutter:?}: {error:?}") };
        let said = RenderError::Shutter(found).to_string();
        assert!(said.contains("must be from 0 to 1"), "{said}");
    }
}
