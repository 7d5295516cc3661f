//! Benchmarks of one structure: complete, and consistent in themselves.

use raywood::{SimdLevel, StructureKind};
use raywood_lab::{Benchmark, BenchmarkOptions, RayKind, benchmark};
use raywood_render::{PreparedScene, RenderOptions, default_view};
use raywood_scene::{Scene, builtin};

fn small() -> BenchmarkOptions {
    let picture = RenderOptions { width: 64, height: 40, ..RenderOptions::default() };
    BenchmarkOptions { rays: 640, rounds: 3, threads: vec![2, 3, 2], picture }
}

fn run(scene: &Scene, kind: StructureKind) -> Benchmark {
    let mut prepared = PreparedScene::with_structure(scene, kind).expect("it builds");
    let level = prepared.structure().expect("no instances").simd_level();
    let view = default_view(&prepared, 1.6);
    let found = benchmark(&mut prepared, &view, &small(), |_| {}).expect("equal answers");
    assert_eq!(prepared.structure().expect("no instances").simd_level(), level);
    found
}

#[test]
fn every_kind_level_and_number_of_threads_is_measured() {
    let scene = builtin("sphereflake?depth=2").expect("a scene");
    let found = run(&scene, StructureKind::BvhWide);
    let levels: Vec<_> =
        SimdLevel::available().filter(|level| *level <= SimdLevel::active()).collect();
    assert_eq!((found.level, &found.levels), (Some(SimdLevel::active()), &levels));
    assert_eq!(found.clocks.iter().map(|clock| clock.threads).collect::<Vec<_>>(), [1, 2, 3]);
    assert!(found.clocks.iter().all(|clock| clock.hertz() > 1e7 && clock.cores <= clock.threads));

    assert_eq!(found.ray_sets.iter().map(|set| set.kind).collect::<Vec<_>>(), RayKind::ALL);
    assert_eq!(found.rays.len(), RayKind::ALL.len() * (levels.len() + 2));
    for set in &found.ray_sets {
        assert_eq!(found.by_level(set.kind).filter_map(|rays| rays.level).count(), levels.len());
        let threads: Vec<_> = found.by_threads(set.kind).map(|rays| rays.speed.threads).collect();
        assert_eq!(threads, [1, 2, 3]);
        assert!(set.hits <= set.rays && set.rays <= 640);
    }
    for rays in &found.rays {
        let speed = &rays.speed;
        assert_eq!(speed.timing.rounds(), 3);
        let product = speed.rays_per_second() * speed.seconds_per_ray();
        assert!((product - 1.0).abs() < 1e-9, "{product}");
        assert!(found.cycles_per_ray(speed) > 1.0);
    }

    let pictures = &found.pictures;
    assert_eq!((pictures.width, pictures.height, pictures.rays.primary), (64, 40, 64 * 40));
    let threads: Vec<_> = pictures.speeds.iter().map(|speed| speed.threads).collect();
    assert_eq!(threads, [1, 2, 3]);
    assert!(pictures.speeds.iter().all(|speed| speed.rays == pictures.rays.total()));
}

#[test]
fn structures_without_vector_instructions_are_measured_on_threads_alone() {
    let scene = builtin("terrain?n=16").expect("a scene");
    for kind in [StructureKind::KdTree, StructureKind::BruteForce] {
        let found = run(&scene, kind);
        assert_eq!((found.structure, found.level, found.levels.len()), (kind, None, 0));
        assert_eq!(found.rays.len(), RayKind::ALL.len() * 3);
    }
}

#[test]
fn nothing_to_see_is_no_trouble() {
    let found = run(&Scene::default(), StructureKind::default());
    assert_eq!(found.primitives, 0);
    assert!(found.ray_sets.iter().all(|set| set.hits == 0));
}
