//! Bounds over a picture: in the right places, faint where hidden, for every structure, level, thread count and camera.

use crate::common::{camera, matte, scene, still_life, still_life_camera};
use raywood::{StructureKind, Vec3};
use raywood_render::{
    BoundsOverlay, CameraRays, PreparedScene, Progress, RenderError, RenderOptions, RgbImage,
    bounds_overlay,
};
use raywood_scene::{Camera, Scene};

const GREY: [u8; 3] = [128; 3];

fn options(width: u32, height: u32) -> RenderOptions {
    RenderOptions { width, height, ..RenderOptions::default() }
}

fn overlay(
    prepared: &PreparedScene<'_>,
    camera: &Camera,
    (width, height): (u32, u32),
    level: usize,
) -> BoundsOverlay {
    let options = options(width, height);
    bounds_overlay(prepared, camera, &options, level, &Progress::new()).expect("an overlay")
}

/// A ball of radius 1: its box has corners at -1 and 1.
fn ball() -> Scene {
    scene(&[], &[([0.0; 3], 1.0, 0)], vec![matte(0.5)])
}

/// The lines of the root of a scene over grey.
fn drawn(scene: &Scene, camera: &Camera, size: (u32, u32)) -> RgbImage {
    let prepared = PreparedScene::new(scene).expect("a tree");
    let mut picture = RgbImage::filled(size.0, size.1, GREY);
    overlay(&prepared, camera, size, 0).draw_over(&mut picture);
    picture
}

/// The pixel whose ray passes a point most closely: found by trying all.
fn pixel_of(rays: &CameraRays, (width, height): (u32, u32), point: Vec3) -> (u32, u32) {
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let miss = |&(x, y): &(u32, u32)| {
        let ray = rays.ray(x as f32 + 0.5, y as f32 + 0.5);
        (point - ray.origin).normalize_or_zero().cross(ray.direction).length()
    };
    all.min_by(|a, b| miss(a).total_cmp(&miss(b))).expect("a pixel")
}

/// How far from grey a pixel is.
fn strength(picture: &RgbImage, (x, y): (u32, u32)) -> u32 {
    let pixel = picture.pixel(x, y).expect("a pixel");
    pixel.iter().map(|&byte| u32::from(byte.abs_diff(128))).sum()
}

#[test]
fn edges_lie_where_the_rays_of_their_points_go() {
    let size = (150, 100);
    let eye = [3.1, 2.3, 4.7];
    let view = camera(eye, [0.1, 0.0, 0.0]);
    let rays = CameraRays::new(&view, size.0, size.1).expect("a camera");
    let picture = drawn(&ball(), &view, size);
    let mut on_edges = Vec::new();
    for step in 0..=60 {
        let along = -1.0 + step as f32 / 30.0;
        for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            for point in [[along, a, b], [a, along, b], [a, b, along]] {
                let pixel = pixel_of(&rays, size, point.into());
                assert!(strength(&picture, pixel) > 15, "{point:?} at {pixel:?}");
                on_edges.push(pixel);
            }
        }
    }
    // Nothing is drawn elsewhere.
    for (x, y) in (0..100).flat_map(|y| (0..150).map(move |x| (x, y))) {
        let far = on_edges.iter().all(|&(ex, ey)| ex.abs_diff(x).max(ey.abs_diff(y)) > 3);
        assert!(!far || strength(&picture, (x, y)) == 0, "something at {x}, {y}");
    }
}

#[test]
fn lines_behind_surfaces_are_fainter() {
    let size = (200, 200);
    let view = camera([0.0, 0.0, 5.0], [0.0; 3]);
    let rays = CameraRays::new(&view, size.0, size.1).expect("a camera");
    let picture = drawn(&ball(), &view, size);
    let at = |point: [f32; 3]| strength(&picture, pixel_of(&rays, size, point.into()));
    // The middles of the upper edges: the nearer one is in sight, the farther one behind the ball, whose outline hides it.
    let (near, far) = (at([0.0, 1.0, 1.0]), at([0.0, 1.0, -1.0]));
    assert!(far > 10 && near > 2 * far, "{near} and {far}");
    // The farther corners stand out beside the ball.
    assert!(at([0.97, 1.0, -1.0]) > 2 * far);
}

#[test]
fn the_eye_may_be_anywhere() {
    let ball = ball();
    let size = (64, 40);
    // Inside, on a face, on an edge, at a corner, far away, at the end of numbers.
    for eye in [
        [0.1, 0.2, 0.3],
        [1.0, 0.2, 0.3],
        [1.0, 1.0, 0.3],
        [1.0; 3],
        [1e6, 1e3, 7.0],
        [3e38, -3e38, 3e38],
    ] {
        for target in [[0.0; 3], [5.0, 1.0, 0.0], [1.0, 1.0, -9.0]] {
            for fov_y in [1e-3, 40.0, 179.99] {
                let view = Camera { fov_y, ..camera(eye, target) };
                let picture = drawn(&ball, &view, size);
                assert_eq!(picture.bytes().len(), 3 * 64 * 40);
            }
        }
    }
    // From inside, the edges ahead are seen.
    let inside = drawn(&ball, &camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0]), size);
    assert_eq!(strength(&inside, (0, 0)), 0);
    let wide = Camera { fov_y: 120.0, ..camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0]) };
    assert!(drawn(&ball, &wide, size).bytes().iter().any(|&byte| byte != 128));
    for size in [(1, 1), (1, 300), (300, 1)] {
        drawn(&ball, &wide, size);
    }
}

#[test]
fn every_level_of_every_structure_holds_the_whole_scene() {
    let scene = still_life();
    for &kind in StructureKind::ALL {
        let prepared = PreparedScene::with_structure(&scene, kind).expect("a structure");
        let levels = prepared.stats().depth;
        assert!(levels >= 1);
        for level in 0..levels {
            // Interior nodes of the level, and leaves down to it that are not empty.
            let mut expected = 0;
            prepared.structure().expect("no instances").visit_nodes(&mut |node| match node
                .references
            {
                None if node.level == level => expected += 1,
                Some(1..) if node.level <= level => expected += 1,
                _ => {}
            });
            let drawn = overlay(&prepared, &still_life_camera(), (48, 30), level);
            assert_eq!(drawn.boxes(), expected, "{kind:?} level {level}");
            assert!(expected > 0);
        }
        let beyond = RenderError::NoSuchLevel { structure: kind, level: levels, levels };
        let options = options(48, 30);
        let answer =
            bounds_overlay(&prepared, &still_life_camera(), &options, levels, &Progress::new());
        assert_eq!(answer.err(), Some(beyond));
    }
}

#[test]
fn a_scene_without_surfaces_has_no_levels() {
    let nothing = Scene::default();
    let prepared = PreparedScene::new(&nothing).expect("a tree");
    let answer =
        bounds_overlay(&prepared, &still_life_camera(), &options(8, 8), 0, &Progress::new());
    let message = answer.expect_err("nothing").to_string();
    assert_eq!(message, "there is no level 0: the bvh-wide is empty");
}

#[test]
fn the_lines_do_not_depend_on_the_number_of_threads() {
    let scene = still_life();
    let prepared = PreparedScene::with_structure(&scene, StructureKind::KdTree).expect("a tree");
    let deepest = prepared.stats().depth - 1;
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| overlay(&prepared, &still_life_camera(), (170, 130), deepest))
    };
    let one = with(1);
    assert!([2, 7].into_iter().all(|threads| with(threads) == one));
    let mut picture = RgbImage::filled(170, 130, GREY);
    one.draw_over(&mut picture);
    assert!(picture.bytes().iter().any(|&byte| byte != 128));
}

#[test]
fn what_was_cancelled_ends() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let progress = Progress::new();
    progress.cancel();
    let answer = bounds_overlay(&prepared, &still_life_camera(), &options(8, 8), 0, &progress);
    assert_eq!(answer.err(), Some(RenderError::Cancelled));
}
