//! What holds for every heat map: the counts of single rays, the same for any number of threads, drawn on one scale.

use crate::common::{still_life, still_life_camera};
use raywood::{Counts, Geometry, StructureKind};
use raywood_render::{
    CameraRays, HeatMap, HeatQuantity, PreparedScene, Progress, RenderError, RenderOptions,
    heat_map,
};

fn options(width: u32, height: u32, samples: u32) -> RenderOptions {
    RenderOptions { width, height, samples, ..RenderOptions::default() }
}

fn measure(
    prepared: &PreparedScene<'_>,
    options: &RenderOptions,
    quantity: HeatQuantity,
) -> HeatMap {
    let camera = still_life_camera();
    heat_map(prepared, &camera, options, quantity, &Progress::new()).expect("a heat map")
}

#[test]
fn without_a_structure_every_ray_tests_every_primitive() {
    let scene = still_life();
    let prepared = PreparedScene::with_structure(&scene, StructureKind::BruteForce).expect("one");
    let all = (scene.mesh.triangles.len() + scene.spheres.len()) as f32;
    for samples in [1, 3] {
        let map = measure(&prepared, &options(37, 21, samples), HeatQuantity::Primitives);
        assert_eq!(map.values, vec![all; 37 * 21]);
        assert_eq!((map.mean(), map.max()), (f64::from(all), all));
        assert_eq!(map.rays, 37 * 21 * u64::from(samples));
        assert!(map.default_maximum() >= all && map.pixels_above(map.default_maximum()) == 0);
    }
}

#[test]
fn a_pixel_is_the_mean_of_its_rays_counts_in_every_structure() {
    let scene = still_life();
    let (width, height, samples) = (23, 18, 3);
    let camera = CameraRays::new(&still_life_camera(), width, height).expect("a camera");
    for &kind in StructureKind::ALL {
        let prepared = PreparedScene::with_structure(&scene, kind).expect("a structure");
        for &quantity in HeatQuantity::ALL {
            let map = measure(&prepared, &options(width, height, samples), quantity);
            assert_eq!((map.quantity, map.structure), (quantity, kind));
            let mut values = map.values.iter();
            for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
                let of_ray = |ray| {
                    let mut counts = Counts::default();
                    prepared.structure().expect("no instances").intersect_probed(&ray, &mut counts);
                    match quantity {
                        HeatQuantity::Nodes => counts.nodes,
                        HeatQuantity::Boxes => counts.boxes,
                        HeatQuantity::Primitives => counts.primitives,
                        _ => counts.boxes + counts.primitives,
                    }
                };
                let sum: u64 = camera.pixel_rays(x, y, samples).map(of_ray).sum();
                let expected = (sum as f64 / f64::from(samples)) as f32;
                assert_eq!(values.next(), Some(&expected), "{kind:?} {quantity:?} at {x}, {y}");
            }
        }
    }
}

#[test]
fn the_map_does_not_depend_on_the_number_of_threads() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| measure(&prepared, &options(83, 61, 5), HeatQuantity::Tests))
    };
    let one = with(1);
    assert!(one.max() > 0.0);
    assert!([2, 7].into_iter().all(|threads| with(threads) == one));
}

#[test]
fn what_makes_no_sense_is_refused_and_what_was_cancelled_ends() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let refused = |options: &RenderOptions, progress: &Progress| {
        let camera = still_life_camera();
        heat_map(&prepared, &camera, options, HeatQuantity::Nodes, progress).err()
    };
    let empty = Some(RenderError::EmptyImage { width: 0, height: 5 });
    assert_eq!(refused(&options(0, 5, 1), &Progress::new()), empty);
    let none = Some(RenderError::Samples { samples: 0 });
    assert_eq!(refused(&options(5, 5, 0), &Progress::new()), none);
    let progress = Progress::new();
    progress.cancel();
    assert_eq!(refused(&options(5, 5, 1), &progress), Some(RenderError::Cancelled));
    assert_eq!(progress.pixels_done(), 0);
}

#[test]
fn a_few_hot_pixels_do_not_stretch_the_scale_and_maps_can_share_one() {
    let (quantity, structure) = (HeatQuantity::Boxes, StructureKind::Octree);
    let map = |most: f32, rest: f32| {
        let values = (0..1000).map(|i| if i < 4 { most } else { rest }).collect();
        HeatMap { width: 100, height: 10, quantity, structure, values, rays: 1000 }
    };
    let (hot, even) = (map(5000.0, 30.0), map(45.0, 45.0));
    assert_eq!((hot.default_maximum(), hot.pixels_above(30.0)), (30.0, 4));
    assert_eq!(even.default_maximum(), 50.0);
    assert_eq!(HeatMap::common_maximum([&hot, &even]), 50.0);
    assert_eq!(HeatMap::common_maximum([]), 1.0);
    // A small thing in a large picture: the scale is that of the thing.
    assert_eq!(map(12.0, 0.0).default_maximum(), 15.0);
    // Equal values have equal colours on a shared scale, whatever the map.
    assert_eq!(hot.picture(50.0).pixel(50, 5), map(0.0, 30.0).picture(50.0).pixel(50, 5));
    assert_ne!(hot.picture(50.0).pixel(50, 5), even.picture(50.0).pixel(50, 5));
}

#[test]
fn pictures_become_png_in_memory() {
    let scene = still_life();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let map = measure(&prepared, &options(120, 80, 1), HeatQuantity::Nodes);
    let maximum = map.default_maximum();
    let picture = map.with_legend(&map.picture(maximum), maximum);
    let bytes = picture.to_png().expect("a PNG");
    let mut reader =
        png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("a PNG header");
    let mut decoded = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut decoded).expect("pixels");
    assert_eq!((frame.width, frame.height), (picture.width(), picture.height()));
    assert_eq!(decoded, picture.bytes());
}
