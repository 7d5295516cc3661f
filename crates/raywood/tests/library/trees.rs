//! The invariants of trees: any input, any number of threads.

use raywood::AccelerationStructure;
use raywood::{
    Aabb, BuildError, BuildOptions, BuildPreset, Builder, Bvh2, Counts, Geometry, Hit, Ray,
    Structure, StructureKind, TriangleMesh, Vec3, WideBvh,
};
use raywood::{PreparedRay, PrimitiveHit, SurfacePoint};
use raywood_testkit::{nasty, shapes};

/// Boxes that cannot be hit: geometry for builders alone.
#[derive(Debug)]
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

/// The binary tree, which shows its builder.
fn binary<G: Geometry>(geometry: G, options: &BuildOptions) -> Structure<G> {
    Structure::build(StructureKind::BvhSahBinned, geometry, options).expect("it builds")
}

fn build(boxes: Vec<Aabb>) -> Structure<Boxes> {
    let wide = Structure::build(StructureKind::BvhWide, Boxes(boxes), &Default::default());
    let wide = wide.expect("it builds");
    wide.validate().expect("a valid wide tree");
    let bvh = binary(Boxes(wide.geometry().0.clone()), &Default::default());
    bvh.validate().expect("a valid tree");
    bvh
}

#[test]
fn every_mesh_gives_a_valid_tree() {
    for nasty in nasty::all() {
        let n = nasty.mesh.len();
        let bvh = binary(&nasty.mesh, &Default::default());
        bvh.validate().unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
        let stats = bvh.stats();
        assert_eq!(stats.primitives, n, "{}", nasty.name);
        assert!(stats.nodes <= (2 * n).saturating_sub(1), "{}: {stats}", nasty.name);
        assert_eq!(stats.nodes, (2 * stats.leaves).saturating_sub(1), "{}: {stats}", nasty.name);
        assert!(
            stats.max_leaf_primitives <= BuildOptions::default().max_leaf_size,
            "{}: {stats}",
            nasty.name
        );
        assert!(stats.q.is_finite(), "{}: {stats}", nasty.name);
        let tree = Bvh2::build(&nasty.mesh, &BuildOptions::default()).expect("it builds");
        assert_eq!(tree.bounds(), nasty.mesh.total_bounds(), "{}", nasty.name);
    }
}

#[test]
fn a_million_identical_boxes() {
    let stats = build(vec![Aabb::new([1.0; 3], [2.0; 3]); 1 << 20]).stats();
    assert_eq!(stats.max_leaf_primitives, 8);
    assert_eq!(stats.depth, 18);
}

#[test]
fn a_million_identical_centers() {
    let around = |i: usize| Aabb::new([-(i as f32); 3], [i as f32; 3]);
    let stats = build((0..1 << 20).map(around).collect()).stats();
    assert!(stats.depth <= 64, "{stats}");
}

/// Boxes of numbers at the ends of their range.
fn extreme_boxes() -> Vec<Vec<Aabb>> {
    let huge = f32::MAX;
    let mut with_a_huge_one: Vec<Aabb> =
        (0..1000).map(|i| Aabb::new([i as f32 * 1e-3; 3], [i as f32 * 1e-3 + 1e-4; 3])).collect();
    with_a_huge_one.push(Aabb::new([-huge; 3], [huge; 3]));
    vec![
        vec![Aabb::new([-huge; 3], [huge; 3]); 100],
        (0..100).map(|i| Aabb::new([-huge; 3], [i as f32; 3])).collect(),
        (0..100)
            .map(|i| Aabb::new([if i % 2 == 0 { -huge } else { huge }; 3], [huge; 3]))
            .collect(),
        (0..100).map(|i| Aabb::new([i as f32 * 1e-42; 3], [i as f32 * 1e-42; 3])).collect(),
        with_a_huge_one,
    ]
}

/// Each box a fraction of the last, over the whole range of numbers: splits cut off one at a time.
fn a_series() -> Vec<Aabb> {
    let boxes = (0..2500).map(|i| {
        let x = 2f32.powf(120.0 - 0.1 * i as f32);
        Aabb::new([x, 0.0, 0.0], [x, 1.0, 1.0])
    });
    boxes.collect()
}

#[test]
fn extreme_boxes_are_built() {
    extreme_boxes().into_iter().for_each(|boxes| drop(build(boxes)));
}

#[test]
fn a_series_that_would_make_a_deep_tree() {
    let stats = build(a_series()).stats();
    assert!(stats.depth <= 64, "{stats}");
}

#[test]
fn trees_along_a_curve_are_sound_whatever_codes_can_tell_apart() {
    let mut lists = extreme_boxes();
    lists.push(a_series());
    // Far more in one place than a code can tell apart, and in several such places.
    lists.push(vec![Aabb::new([1.0; 3], [2.0; 3]); 1 << 20]);
    let places = |i: usize| [(i % 3) as f32 * 1e-3, 0.0, 1.0];
    lists.push((0..30_000).map(|i| Aabb::new(places(i), places(i))).collect());
    // A crowd that is small beside its distance to the others.
    let crowd = |i: usize| [(i % 100) as f32 * 1e-6, (i / 100) as f32 * 1e-6, 0.0];
    let mut crowded: Vec<_> = (0..10_000).map(|i| Aabb::new(crowd(i), crowd(i))).collect();
    crowded.push(Aabb::new([1e6; 3], [1e6; 3]));
    lists.push(crowded);
    lists.extend((0..20).map(|n| vec![Aabb::new([0.0; 3], [1.0; 3]); n]));

    for boxes in lists {
        let (n, boxes) = (boxes.len(), Boxes(boxes));
        for builder in [Builder::Lbvh, Builder::Hlbvh, Builder::Ploc] {
            for max_leaf_size in [1, 8] {
                let options = BuildOptions { max_leaf_size, ..Default::default() };
                let tree = Bvh2::build_by(builder, &boxes, &options).expect("it builds");
                tree.validate(&boxes).unwrap_or_else(|error| panic!("{builder:?}, {n}: {error}"));
                let stats = tree.stats();
                assert!(stats.depth <= 64, "{builder:?}, {n}: {stats}");
                assert!(stats.max_leaf_primitives <= max_leaf_size, "{builder:?}, {n}: {stats}");
            }
            let options = BuildOptions { wide_builder: builder, ..Default::default() };
            for options in [options, BuildPreset::Fastest.options()] {
                let tree = WideBvh::build(&boxes, &options).expect("it builds");
                tree.validate(&boxes).unwrap_or_else(|error| panic!("{builder:?}, {n}: {error}"));
            }
        }
    }
}

#[test]
fn a_crowd_far_from_the_rest_is_divided_by_place() {
    // Codes of the whole scene put all of the crowd into one cell; halves by number would overlap.
    let crowd = |i: usize| [(i % 100) as f32 * 1e-6, (i / 100) as f32 * 1e-6, 0.0];
    let mut boxes: Vec<_> = (0..10_000).map(|i| Aabb::new(crowd(i), crowd(i))).collect();
    let alone = Bvh2::build_by(Builder::Lbvh, &Boxes(boxes.clone()), &BuildOptions::default());
    boxes.push(Aabb::new([1e6; 3], [1e6; 3]));
    let together = Bvh2::build_by(Builder::Lbvh, &Boxes(boxes), &BuildOptions::default());
    let areas = |tree: &Bvh2, skip: usize| -> f64 {
        tree.nodes()[skip..].iter().map(|node| node.bounds().half_area()).sum()
    };
    // The root and its second child, the far box, aside.
    let (alone, together) = (alone.expect("it builds"), together.expect("it builds"));
    let (expected, found) = (areas(&alone, 0), areas(&together, 1));
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} and {expected}");
}

#[test]
fn leaves_follow_the_options() {
    let mesh = shapes::soup(3000, 0.05, 1);
    for max_leaf_size in [1, 2, 5] {
        let options = BuildOptions { max_leaf_size, ..Default::default() };
        let bvh = binary(&mesh, &options);
        bvh.validate().expect("a valid tree");
        assert!(bvh.stats().max_leaf_primitives <= max_leaf_size);
    }
    // Absurd values are brought into range.
    let options = BuildOptions {
        bins: 0,
        max_leaf_size: 0,
        node_cost: f32::NAN,
        primitive_cost: -1.0,
        ..Default::default()
    };
    binary(&mesh, &options).validate().expect("a valid tree");
    let options = BuildOptions {
        bins: usize::MAX,
        max_leaf_size: usize::MAX,
        node_cost: 1e30,
        primitive_cost: 1e-30,
        ..Default::default()
    };
    assert_eq!(binary(&mesh, &options).stats().nodes, 1);
}

#[test]
fn splits_lower_the_expected_cost() {
    let mesh = shapes::uv_sphere(60, Vec3::ZERO, 1.0);
    let tree = binary(&mesh, &Default::default()).stats();
    let options = BuildOptions { max_leaf_size: usize::MAX, node_cost: 1e30, ..Default::default() };
    let leaf = binary(&mesh, &options).stats();
    assert_eq!(leaf.q, 1.0 + mesh.len() as f64);
    assert!(tree.q < 0.01 * leaf.q, "{tree}");
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_tree_for_any_number_of_threads() {
    // Several pieces of the sets that are divided by all threads, and a last one that is not full.
    let mesh = shapes::soup(150_001, 0.02, 2);
    let build = |builder, threads| -> Bvh2 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let options = BuildOptions::default();
        pool.install(|| Bvh2::build_by(builder, &mesh, &options).expect("it builds"))
    };
    for builder in [Builder::SahBinned, Builder::Lbvh, Builder::Hlbvh, Builder::Ploc] {
        let one = build(builder, 1);
        for threads in [2, 3, 8] {
            assert!(build(builder, threads) == one, "{builder:?}: {threads} threads");
        }
    }
}

#[test]
fn bad_bounds_are_refused() {
    let good = Aabb::new([0.0; 3], [1.0; 3]);
    for bad in [
        Aabb::EMPTY,
        Aabb::new([f32::NAN, 0.0, 0.0], [1.0; 3]),
        Aabb::new([0.0; 3], [1.0, f32::NAN, 1.0]),
        Aabb::new([f32::NEG_INFINITY; 3], [1.0; 3]),
        Aabb::new([1.0, 0.0, 0.0], [0.0, 1.0, 1.0]),
    ] {
        for &kind in StructureKind::ALL {
            let boxes = Boxes(vec![good, good, bad, good]);
            let error = Structure::build(kind, boxes, &Default::default());
            let error = error.map(|_| ()).expect_err("it is refused");
            assert!(matches!(error, BuildError::BadBounds { primitive: 2, .. }), "{error}");
            assert!(error.to_string().starts_with("primitive 2 has the bounds"), "{error}");
        }
    }
}

#[test]
fn bad_meshes_are_refused() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let error =
        TriangleMesh::new(points.clone(), vec![[0, 1, 2], [0, 3, 2]]).expect_err("it is refused");
    assert_eq!(
        error.to_string(),
        "triangle 1 uses vertex 3, but there are 3 vertices (0 is the first)"
    );
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut points = points.clone();
        points[1][2] = bad;
        points.push([bad; 3]);
        let error = TriangleMesh::new(points, vec![[0, 1, 2]]).expect_err("it is refused");
        assert_eq!(
            error.to_string(),
            "2 vertices are NaN or infinite, the first of them is vertex 1"
        );
    }
}

#[test]
fn the_probe_counts_what_is_tested() {
    let mesh = shapes::soup(500, 0.1, 3);
    let whole = BuildOptions { max_leaf_size: usize::MAX, node_cost: 1e30, ..Default::default() };
    let leaf = binary(&mesh, &whole);
    let through = Ray::new([-5.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    let beside = Ray::new([-5.0, 9.0, 0.2], [1.0, 0.0, 0.0]);

    // One leaf: its box and, if that is hit, all triangles.
    let mut counts = Counts::default();
    leaf.intersect_probed(&through, &mut counts);
    assert_eq!(counts, Counts { nodes: 1, boxes: 1, primitives: 500 });
    leaf.intersect_probed(&beside, &mut counts);
    assert_eq!(counts, Counts { nodes: 1, boxes: 2, primitives: 500 });
    leaf.occluded_probed(&beside, &mut counts);
    assert_eq!(counts, Counts { nodes: 1, boxes: 3, primitives: 500 });

    // A tree: boxes in pairs below the root's, and far fewer triangles; the same answer as without a probe.
    let tree = binary(&mesh, &Default::default());
    let mut counts = Counts::default();
    assert_eq!(tree.intersect_probed(&through, &mut counts), leaf.intersect(&through));
    assert!(counts.boxes % 2 == 1 && counts.boxes > 1, "{counts:?}");
    assert!(counts.primitives < 250, "{counts:?}");
    assert_eq!(tree.stats().bytes, 32 * tree.stats().nodes + 4 * 500);
}

#[test]
fn presets_have_names_and_build_sound_trees_that_get_better() {
    let mesh = shapes::soup(3000, 0.1, 5);
    let mut costs = Vec::new();
    for &preset in BuildPreset::ALL {
        assert_eq!(BuildPreset::from_name(preset.name()), Some(preset));
        let tree = Structure::build(StructureKind::BvhWide, &mesh, &preset.options());
        let tree = tree.expect("it builds");
        tree.validate().expect("a sound tree");
        costs.push(tree.stats().q);
    }
    assert_eq!(BuildPreset::from_name("ultra"), None);
    assert_eq!(BuildPreset::default().options(), BuildOptions::default());
    let [fastest, .., best] = costs[..] else { panic!("several presets") };
    // What fast improves is the surface of boxes, which is not all that this measure counts.
    assert!(costs.iter().all(|cost| best <= *cost && *cost <= 1.02 * fastest), "{costs:?}");
}
