//! Trees improved by reinsertion: sound, no more costly than before, whatever they are built over.

use raywood::{Aabb, BuildOptions, Builder, Bvh2, Geometry, Hit, Ray, Structure, StructureKind};
use raywood::{AccelerationStructure, StructureStats, TriangleMesh, Vec3, WideBvh};
use raywood::{PreparedRay, PrimitiveHit, SurfacePoint};
use raywood_testkit::{Rng, nasty, shapes};

/// Boxes that cannot be hit: geometry for builders alone.
#[derive(Clone, Debug)]
struct Boxes(Vec<Aabb>);

impl Geometry for Boxes {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn bounds(&self, primitive: u32) -> Aabb {
        self.0[primitive as usize]
    }
    fn intersect(&self, _: u32, _: &PreparedRay) -> Option<PrimitiveHit> {
        None
    }
    fn surface_point(&self, ray: &Ray, _: &Hit) -> SurfacePoint {
        SurfacePoint { position: ray.origin, normal: Vec3::Y, clearance: 0.0 }
    }
}

const BUILDERS: [Builder; 4] =
    [Builder::Midpoint, Builder::Median, Builder::SahSweep, Builder::SahBinned];

fn options(passes: usize, share: f32) -> BuildOptions {
    let (reinsertion_passes, reinsertion_share) = (Some(passes), share);
    BuildOptions { reinsertion_passes, reinsertion_share, ..Default::default() }
}

/// Statistics of the tree without and with reinsertion, which is checked.
fn before_and_after<G: Geometry>(
    builder: Builder,
    geometry: &G,
    options: &BuildOptions,
) -> [StructureStats; 2] {
    let plain = BuildOptions { reinsertion_passes: Some(0), ..options.clone() };
    [&plain, options].map(|options| {
        let tree = Bvh2::build_by(builder, geometry, options).expect("it builds");
        tree.validate(geometry).expect("a valid tree");
        tree.stats()
    })
}

/// Triangles of very different sizes and shapes, in which top-down builders find no good splits.
fn mixed(count: usize) -> TriangleMesh {
    let mut rng = Rng::new(5);
    let mut point = || rng.in_cube();
    let mut corners = Vec::new();
    for number in 0..count {
        let center = point();
        let size = if number % 10 == 0 { 0.5 } else { 0.02 };
        let stretch = [Vec3::X, Vec3::Y, Vec3::Z][number % 3] * size;
        corners.extend([center, center + stretch, center + 0.01 * point()]);
    }
    let triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(corners, triangles).expect("finite corners")
}

#[test]
fn any_mesh_gives_a_valid_tree_that_costs_no_more() {
    for nasty in nasty::all() {
        for builder in BUILDERS {
            for share in [0.05, 1.0] {
                let [before, after] = before_and_after(builder, &nasty.mesh, &options(20, share));
                let what = format!("{builder:?} over {}", nasty.name);
                assert!(after.q <= before.q * (1.0 + 1e-9), "{what}: {before}, then {after}");
                assert_eq!(after.leaves, before.leaves, "{what}");
                assert_eq!(after.nodes, before.nodes, "{what}");
            }
        }
        let wide = Structure::build(StructureKind::BvhWide, &nasty.mesh, &options(20, 1.0));
        wide.expect("it builds").validate().unwrap_or_else(|e| panic!("{}: {e}", nasty.name));
    }
}

#[test]
fn bad_trees_become_much_better_and_good_ones_better() {
    let mesh = mixed(5000);
    for (builder, at_most) in
        [(Builder::Median, 0.75), (Builder::Midpoint, 0.8), (Builder::SahBinned, 0.95)]
    {
        let options = BuildOptions { max_leaf_size: 1, ..options(20, 1.0) };
        let [before, after] = before_and_after(builder, &mesh, &options);
        assert!(after.q < at_most * before.q, "{builder:?}: {before}, then {after}");
    }
}

#[test]
fn trees_show_their_builders_unless_asked_for_more() {
    let mesh = mixed(2000);
    let default = BuildOptions::default();
    for builder in BUILDERS {
        let build =
            |options: &BuildOptions| Bvh2::build_by(builder, &mesh, options).expect("it builds");
        assert!(build(&default) == build(&options(0, 0.05)), "{builder:?}");
        assert!(build(&default) != build(&options(4, 1.0)), "{builder:?}");
    }
    let build = |options: &BuildOptions| WideBvh::build(&mesh, options).expect("it builds");
    assert!(build(&default) == build(&options(0, 0.05)));
    assert!(build(&default) != build(&options(4, 0.05)));
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_tree_for_any_number_of_threads() {
    let mesh = mixed(40_000);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let options = options(4, 0.5);
            let binary = Bvh2::build(&mesh, &options).expect("it builds");
            (binary, WideBvh::build(&mesh, &options).expect("it builds"))
        })
    };
    let one = build(1);
    for threads in [2, 7] {
        assert!(build(threads) == one, "{threads} threads give another tree");
    }
}

#[test]
fn a_few_primitives() {
    let mut rng = Rng::new(3);
    for count in 0..8 {
        for _ in 0..20 {
            let boxes = (0..count).map(|_| {
                let corner = rng.in_cube();
                Aabb::new(corner, corner + Vec3::splat(0.5))
            });
            let boxes = Boxes(boxes.collect());
            let options = BuildOptions { max_leaf_size: 1, ..options(10, 1.0) };
            let [before, after] = before_and_after(Builder::Median, &boxes, &options);
            assert!(after.q <= before.q * (1.0 + 1e-9), "{before}, then {after}");
            let wide = WideBvh::build(&boxes, &options).expect("it builds");
            wide.validate(&boxes).expect("a valid tree");
        }
    }
}

#[test]
fn a_million_boxes_that_no_search_can_tell_apart() {
    let million = 1 << 20;
    let options = BuildOptions { max_leaf_size: 1, ..options(4, 1.0) };
    let identical = vec![Aabb::new([1.0; 3], [2.0; 3]); million];
    let points = vec![Aabb::new([1.0; 3], [1.0; 3]); million];
    let lines = (0..million).map(|i| Aabb::new([0.0; 3], [i as f32, 0.0, 0.0])).collect();
    let around = (0..million).map(|i| Aabb::new([-(i as f32); 3], [i as f32; 3])).collect();
    for boxes in [identical, points, lines, around] {
        before_and_after(Builder::SahBinned, &Boxes(boxes), &options);
    }
}

#[test]
fn extreme_boxes() {
    let huge = f32::MAX;
    let same = vec![Aabb::new([-huge; 3], [huge; 3]); 100];
    let growing = (0..100).map(|i| Aabb::new([-huge; 3], [i as f32; 3])).collect();
    let tiny = (0..100).map(|i| Aabb::new([i as f32 * 1e-42; 3], [i as f32 * 2e-42; 3])).collect();
    for boxes in [same, growing, tiny] {
        let options = BuildOptions { max_leaf_size: 1, ..options(10, 1.0) };
        let [before, after] = before_and_after(Builder::Median, &Boxes(boxes), &options);
        assert!(after.q <= before.q * (1.0 + 1e-9), "{before}, then {after}");
    }
}

#[test]
fn no_leaf_comes_to_lie_too_deep() {
    // The cheapest tree is a chain with thousands of links: each box holds all that come after it.
    let nested = |count| (0..count).map(|i| 2f32.powf(60.0 - 0.04 * i as f32));
    let boxes: Vec<_> = nested(3000).map(|x| Aabb::new([-x; 3], [x; 3])).collect();
    for builder in BUILDERS {
        let options = BuildOptions { max_leaf_size: 1, ..options(40, 1.0) };
        let [before, after] = before_and_after(builder, &Boxes(boxes.clone()), &options);
        assert!(after.q <= before.q * (1.0 + 1e-9), "{before}, then {after}");
        assert!(after.depth <= 64, "{after}");
        WideBvh::build(&Boxes(boxes.clone()), &options).expect("it builds");
    }
}

#[test]
fn absurd_options_are_brought_into_range() {
    let mesh = shapes::soup(500, 0.2, 4);
    for share in [f32::NAN, -1.0, 0.0, f32::INFINITY] {
        before_and_after(Builder::SahBinned, &mesh, &options(usize::MAX, share));
    }
}
