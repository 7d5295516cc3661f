//! How much memory builds take, counted, against what is said beforehand.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use raywood::{
    BuildError, BuildMemory, BuildOptions, BuildPreset, Builder, Bvh, Bvh2, Geometry, Instance,
    InstanceError, Structure, StructureKind, Tlas, Transform, TriangleMesh, Vec3,
};
use raywood_testkit::shapes;

/// The system's memory, with bytes counted as they come and go.
struct Counting;

static USED: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn count(more: usize) {
    PEAK.fetch_max(USED.fetch_add(more, Relaxed) + more, Relaxed);
}

// SAFETY: everything is the system's.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        // SAFETY: the caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        // SAFETY: the caller's.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        USED.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller's.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What something makes, and the bytes in use meanwhile, at most and in the end: the least of a few times, as the threads' queues grow now and then.
fn measured<T>(make: impl Fn() -> T) -> (T, usize, usize) {
    let measure = || {
        let before = USED.load(Relaxed);
        PEAK.store(before, Relaxed);
        let made = make();
        let since = |bytes: &AtomicUsize| bytes.load(Relaxed).saturating_sub(before);
        (made, since(&PEAK), since(&USED))
    };
    let (_, first_peak, first_left) = measure();
    let (made, peak, left) = measure();
    (made, peak.min(first_peak), left.min(first_left))
}

/// A mesh, by how many times at most what is said may be too high, and whether its triangles are scattered more than is expected.
struct Case {
    name: &'static str,
    mesh: TriangleMesh,
    most: f64,
    is_scattered: bool,
}

/// Meshes of different kinds and sizes.
fn cases() -> Vec<Case> {
    let sound = |corners: Vec<Vec3>, triangles: Vec<[u32; 3]>| {
        TriangleMesh::new(corners, triangles).expect("a sound mesh")
    };
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let case = |name, mesh, most| Case { name, mesh, most, is_scattered: false };
    let scattered = |name, mesh| Case { name, mesh, most: 2.3, is_scattered: true };
    vec![
        case("nothing", sound(vec![], vec![]), f64::INFINITY),
        case("one", sound(corners.clone(), vec![[0, 1, 2]]), f64::INFINITY),
        case("a few", shapes::soup(20, 0.1, 3), f64::INFINITY),
        case("some", shapes::soup(1000, 0.1, 3), 2.3),
        scattered("a scattered piece", shapes::soup(4096, 0.02, 3)),
        scattered("dust", shapes::soup(40_000, 0.001, 4)),
        case("soup", shapes::soup(60_000, 0.02, 3), 2.3),
        case("thick soup", shapes::soup(40_000, 0.1, 3), 2.3),
        case("sphere", shapes::uv_sphere(110, Vec3::ZERO, 1.0), 2.3),
        case("box", shapes::grid_box(65, Vec3::ZERO, Vec3::ONE), 2.3),
        // Nothing to divide space for.
        case("all in one place", sound(corners, vec![[0, 1, 2]; 20_000]), 4.0),
    ]
}

/// All that may change how much memory a structure takes.
fn all_options(kind: StructureKind) -> Vec<(String, BuildOptions)> {
    let mut all: Vec<_> = match kind {
        StructureKind::BvhWide => {
            BuildPreset::ALL.iter().map(|p| (p.name().to_owned(), p.options())).collect()
        }
        _ => vec![("default".to_owned(), BuildOptions::default())],
    };
    let small = |max_leaf_size| BuildOptions { max_leaf_size, ..BuildOptions::default() };
    let improved = BuildOptions { reinsertion_passes: Some(2), ..small(8) };
    match kind {
        StructureKind::UniformGrid | StructureKind::NestedGrid => {
            for grid_density in [1.0, 10.0] {
                let options = BuildOptions { grid_density, ..Default::default() };
                all.push((format!("density {grid_density}"), options));
            }
        }
        StructureKind::Octree => {
            let options = BuildOptions { octree_leaf_size: 3, ..Default::default() };
            all.push(("small leaves".to_owned(), options));
        }
        StructureKind::BvhWide => {
            for wide_builder in [Builder::Midpoint, Builder::Median, Builder::SahSweep] {
                let options = BuildOptions { wide_builder, ..Default::default() };
                all.push((format!("{wide_builder:?}"), options));
            }
        }
        StructureKind::BruteForce | StructureKind::KdTree => {}
        _ => all.extend([
            ("leaves of one".to_owned(), small(1)),
            ("leaves of two".to_owned(), small(2)),
            ("improved".to_owned(), improved),
        ]),
    }
    all
}

/// One test, so that no other allocates meanwhile.
#[test]
fn what_is_said_is_enough_and_not_far_too_much() {
    // Threads allocate when they start, which they may still be doing when the first small builds are over.
    #[cfg(feature = "rayon")]
    rayon::broadcast(|_| ());
    let mut wrong = Vec::new();
    for Case { name, mesh, most, is_scattered } in &cases() {
        let n = mesh.len();
        for &kind in StructureKind::ALL {
            for (what, options) in all_options(kind) {
                let said = BuildMemory::of(kind, n, &options);
                let limited = |limit| BuildOptions { memory_limit: Some(limit), ..options.clone() };
                let build = |limit| Structure::build(kind, mesh, &limited(limit));
                let (built, peak, left) = measured(|| build(said.peak));
                let what = format!("{} ({what}) over {name}", kind.name());
                let each = |bytes: usize| bytes as f64 / n as f64;
                println!(
                    "{what}: {:.1} of {:.1} bytes a primitive, {:.1} of {:.1} in the end",
                    each(peak),
                    each(said.peak),
                    each(left),
                    each(said.structure),
                );

                // With just as much it is built, unless there is no telling.
                let mut check = |is_right: bool, why: &str| {
                    if !is_right {
                        wrong.push(format!("{what}: {why}"));
                    }
                };
                check(peak <= said.peak, "more is held than was said");
                match built {
                    Ok(_) => {
                        let is_enough = left <= said.structure || *is_scattered;
                        check(is_enough, "more is left than was said");
                        // What no preset does, and what divides space, is known less well.
                        let is_rare = |rare: &&str| what.contains(rare);
                        let is_rare = ["Midpoint", "Median", "grid", "octree"].iter().any(is_rare);
                        let most = if is_rare { 1.6 * most } else { *most };
                        check(
                            said.peak as f64 <= most * peak.max(1) as f64,
                            "far too much was said",
                        );
                    }
                    Err(BuildError::MemoryLimit { needed, limit }) => {
                        check(limit == said.peak && needed > limit, "refused for nothing");
                        check(*is_scattered && kind == StructureKind::BvhWide, "refused");
                    }
                    Err(error) => check(false, &error.to_string()),
                }

                // With less it is refused, and nothing is allocated.
                let limit = said.peak - 1;
                let (refused, peak, _) = measured(|| build(limit).err());
                let error = BuildError::MemoryLimit { needed: said.peak, limit };
                assert_eq!((refused, peak), (Some(error), 0), "{what}");
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    binary_trees_and_scenes_of_instances_are_refused_too();
}

fn binary_trees_and_scenes_of_instances_are_refused_too() {
    let mesh = shapes::soup(1000, 0.1, 3);
    let options = BuildOptions { memory_limit: Some(50_000), ..Default::default() };
    for builder in [Builder::SahBinned, Builder::Lbvh] {
        let refused = Bvh2::build_by(builder, &mesh, &options).err();
        assert!(matches!(refused, Some(BuildError::MemoryLimit { limit: 50_000, .. })));
    }
    let said = Bvh::build_with(&mesh, &options).err().map(|error| error.to_string());
    let needed = BuildMemory::of(StructureKind::BvhWide, mesh.len(), &options).peak;
    let expected = format!(
        "the build may take {needed} bytes of memory, more than the 50000 that it is allowed"
    );
    assert_eq!(said, Some(expected));
    let bvh = Arc::new(Bvh::build(&mesh).expect("it builds"));
    let instances: Vec<_> =
        (0..1000).map(|_| Instance::new(Arc::clone(&bvh), Transform::IDENTITY)).collect();
    let refused = Tlas::build_with(instances, &options).err();
    assert!(matches!(refused, Some(InstanceError::Build(BuildError::MemoryLimit { .. }))));
}
