//! Trees that take on the places to which primitives moved: the same hits as of trees that are built there, in one shape for any number of threads, or an error and no change.

use raywood::{Aabb, Geometry, Hit, PreparedRay, PrimitiveHit, SurfacePoint};
use raywood::{
    AccelerationStructure, BuildPreset, Builder, Bvh, Bvh2, Joined, MeshError, Ray, RefitError,
    SimdLevel, Spheres, TriangleMesh, Vec3,
};
use raywood_testkit::saved::Forgery;
use raywood_testkit::{Rng, nasty, oracle, rays, shapes};

/// The mesh with every vertex elsewhere.
fn moved(mesh: &TriangleMesh, map: impl FnMut(&Vec3) -> Vec3) -> TriangleMesh {
    let positions = mesh.positions().iter().map(map).collect::<Vec<_>>();
    mesh.with_positions(positions).expect("finite, and as many")
}

/// Ways to move, gentle ones and rough ones.
fn moves(mesh: &TriangleMesh, seed: u64) -> Vec<(&'static str, TriangleMesh)> {
    let mut rng = Rng::new(seed);
    let far = 1e3 * rng.in_cube();
    // What is tiny already would be too small for numbers.
    let small = if mesh.total_bounds().diagonal() < 1e-20 { 1e6 } else { 1e-6 };
    vec![
        ("not at all", mesh.clone()),
        ("a wave", moved(mesh, |&p| p + 0.1 * Vec3::new((9.0 * p.y).sin(), 0.0, 0.0))),
        ("far away", moved(mesh, |&p| p + far)),
        ("each by itself", moved(mesh, |&p| p + rng.in_cube())),
        ("all over the place", moved(mesh, |_| 1e9 * rng.in_cube())),
        ("a millionth as large", moved(mesh, |&p| small * p)),
        ("flat", moved(mesh, |&p| Vec3::new(p.x, 0.0, p.z))),
        ("onto a point", moved(mesh, |_| Vec3::ONE)),
        ("turned over", moved(mesh, |&p| -1.0 * p)),
    ]
}

/// A mesh to which another has moved, and what rays hit there.
struct Pose {
    name: String,
    mesh: TriangleMesh,
    rays: Vec<(Ray, Option<Hit>)>,
}

/// Every nasty mesh in all its poses; the hits are those of a tree that is built there.
fn poses(count: usize) -> Vec<(TriangleMesh, Vec<Pose>)> {
    let pose = |number: usize, (way, mesh): (&str, TriangleMesh), name: &str| {
        let fresh = Bvh::build(&mesh).expect("it builds");
        let rays = rays::against(&mesh, count, number as u64).into_iter();
        let rays = rays.map(|ray| (ray, fresh.intersect(&ray))).collect();
        Pose { name: format!("{name}, {way}"), mesh, rays }
    };
    let all = nasty::all().into_iter().enumerate();
    all.map(|(number, nasty)| {
        let moves = moves(&nasty.mesh, number as u64).into_iter();
        let poses = moves.map(|way| pose(number, way, nasty.name)).collect();
        (nasty.mesh, poses)
    })
    .collect()
}

#[test]
fn boxes_of_what_stays_stay() {
    let soup = nasty::Nasty { name: "soup", mesh: shapes::soup(20_000, 0.05, 1) };
    for nasty in nasty::all().iter().chain([&soup]) {
        for preset in &BuildPreset::ALL[..4] {
            let built = Bvh::build_with(&nasty.mesh, &preset.options()).expect("it builds");
            let mut again = built.clone();
            let q = again.refit(&nasty.mesh).expect("nothing moved");
            assert_eq!(again.tree(), built.tree(), "{}, {}", nasty.name, preset.name());
            let expected = built.stats().q;
            assert!((q - expected).abs() <= 1e-9 * expected, "{}: {q} {expected}", nasty.name);
        }
    }
}

#[test]
fn hits_are_those_of_a_tree_that_is_built_there() {
    let mut hits = 0;
    for (mesh, poses) in poses(150) {
        for preset in BuildPreset::ALL {
            let mut bvh = Bvh::build_with(mesh.clone(), &preset.options()).expect("it builds");
            // One after the other, with the same tree.
            for Pose { name, mesh, rays } in &poses {
                let name = format!("{name}, {}", preset.name());
                bvh.refit(mesh.clone()).expect("as many");
                bvh.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
                let (rays, expected): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
                let mut batch = vec![None; rays.len()];
                bvh.intersect_batch(&rays, &mut batch);
                for ((ray, expected), of_batch) in rays.iter().zip(expected).zip(batch) {
                    assert_eq!(bvh.intersect(ray), expected, "{name}: {ray:?}");
                    assert_eq!(bvh.occluded(ray), expected.is_some(), "{name}: {ray:?}");
                    let agree = match (&of_batch, &expected) {
                        (Some(a), Some(b)) => a.agrees_with(b),
                        (a, b) => a.is_none() && b.is_none(),
                    };
                    assert!(agree, "{name}: {of_batch:?}, {expected:?}");
                    hits += usize::from(expected.is_some());
                }
            }
        }
    }
    assert!(hits > 5000, "only {hits} hits");
}

#[test]
fn random_meshes_that_move_at_random_are_hit_where_they_are() {
    let mut rng = Rng::new(100);
    for round in 0..60 {
        let (count, size) = (1 + rng.below(600), 10f32.powf(rng.range(-3.0, 0.0)));
        let mesh = shapes::soup(count, size, round);
        let preset = BuildPreset::ALL[rng.below(5)];
        let mut bvh = Bvh::build_with(mesh.clone(), &preset.options()).expect("it builds");
        for _ in 0..3 {
            let scale = 10f32.powf(rng.range(-6.0, 9.0));
            let (shake, place) = (rng.unit(), 3.0 * scale * rng.in_cube());
            let shaken = moved(&mesh, |&p| place + scale * (p + shake * rng.in_cube()));
            bvh.refit(shaken.clone()).expect("as many");
            bvh.validate().expect("it is valid");
            for ray in rays::against(&shaken, 60, round) {
                oracle::check_closest(&shaken, &ray, bvh.intersect(&ray)).expect("the closest");
                oracle::check_occluded(&shaken, &ray, bvh.occluded(&ray)).expect("it is blocked");
            }
        }
    }
}

#[test]
fn every_level_of_instructions_traces_it() {
    let mesh = shapes::soup(3000, 0.1, 5);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let all = moves(&mesh, 6);
    let (_, mesh) = &all[3];
    bvh.refit(mesh).expect("as many");
    for &level in SimdLevel::ALL {
        bvh.set_simd_level(level);
        for ray in rays::against(mesh, 2000, 7) {
            oracle::check_closest(mesh, &ray, bvh.intersect(&ray)).expect("it is the closest");
            oracle::check_occluded(mesh, &ray, bvh.occluded(&ray)).expect("it is blocked");
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let mesh = shapes::soup(60_000, 0.02, 8);
    let all = moves(&mesh, 9);
    let (_, shaken) = &all[3];
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut bvh = Bvh::build(&mesh).expect("it builds");
            let q = bvh.refit(shaken).expect("as many");
            let mut binary = Bvh2::build(&mesh, &Default::default()).expect("it builds");
            (q, bvh.tree().clone(), binary.refit(shaken).expect("as many"), binary)
        })
    };
    let one = of(1);
    for threads in [2, 5] {
        assert!(one == of(threads), "{threads} threads");
    }
    assert!(one.0 > 1.5 * Bvh::build(shaken).expect("it builds").stats().q);
}

#[test]
fn binary_trees_of_every_builder_take_moves_on() {
    let poses = poses(60);
    for builder in [
        Builder::Midpoint,
        Builder::Median,
        Builder::SahSweep,
        Builder::SahBinned,
        Builder::Lbvh,
        Builder::Hlbvh,
        Builder::Ploc,
    ] {
        for (mesh, poses) in &poses {
            let built = Bvh2::build_by(builder, mesh, &Default::default()).expect("it builds");
            let mut tree = built.clone();
            for Pose { name, mesh: moved, rays } in poses {
                let q = tree.refit(moved).expect("as many");
                let name = format!("{builder:?}, {name}");
                tree.validate(moved).unwrap_or_else(|error| panic!("{name}: {error}"));
                let expected = tree.stats().q;
                assert!((q - expected).abs() <= 1e-9 * expected, "{name}: {q} {expected}");
                for (ray, expected) in rays {
                    assert_eq!(tree.intersect(moved, ray, &mut ()), *expected, "{name}");
                }
            }
            tree.refit(mesh).expect("as many");
            assert_eq!(tree, built, "{builder:?}");
        }
    }
}

#[test]
fn what_is_no_triangle_moves_too() {
    let mut rng = Rng::new(3);
    let mesh = shapes::soup(100, 0.2, 4);
    let mut balls = || {
        let ball = |rng: &mut Rng| (2.0 * rng.in_cube(), 0.3 * rng.unit());
        Spheres::new((0..100).map(|_| ball(&mut rng)).collect()).expect("spheres")
    };
    let (before, after) = (balls(), balls());
    let mut bvh = Bvh::build(Joined { first: &mesh, second: &before }).expect("it builds");
    let shaken = moved(&mesh, |&p| -1.0 * p);
    let joined = Joined { first: &shaken, second: &after };
    bvh.refit(joined).expect("as many");
    bvh.validate().expect("it is valid");
    let fresh = Bvh::build(joined).expect("it builds");
    let mut spheres = 0;
    for ray in rays::against(&shaken, 3000, 5) {
        let expected = fresh.intersect(&ray);
        assert_eq!(bvh.intersect(&ray), expected);
        spheres += usize::from(expected.is_some_and(|hit| hit.primitive >= 100));
    }
    assert!(spheres > 300, "{spheres}");
}

#[test]
fn clones_keep_what_they_have() {
    let mesh = shapes::soup(2000, 0.1, 12);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let (old, before) = (bvh.clone(), bvh.tree().stats());
    let all = moves(&mesh, 3);
    bvh.refit(&all[2].1).expect("as many");
    old.validate().expect("it is as it was");
    assert_eq!(old.tree().stats(), before);
    assert_ne!(old.tree(), bvh.tree());
    for ray in rays::against(&mesh, 500, 2) {
        oracle::check_closest(&mesh, &ray, old.intersect(&ray)).expect("it is the closest");
    }
}

/// Boxes, some of which are wrong.
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

    fn surface_point(&self, _: &Ray, _: &Hit) -> SurfacePoint {
        unreachable!("nothing is hit")
    }
}

#[test]
fn what_cannot_be_taken_on_changes_nothing() {
    let mesh = shapes::soup(10_000, 0.1, 4);
    let mut wide = Bvh::build(&mesh).expect("it builds").tree().clone();
    let mut binary = Bvh2::build(&mesh, &Default::default()).expect("it builds");
    let before = (wide.clone(), binary.clone());

    let good: Vec<_> = (0..10_000).map(|primitive| mesh.bounds(primitive)).collect();
    let mut refuse = |boxes: &[Aabb], expected: &str| {
        let boxes = Boxes(boxes.to_vec());
        let errors =
            [wide.refit(&boxes), binary.refit(&boxes)].map(|refit| refit.expect_err(expected));
        assert!(errors.iter().all(|error| error.to_string().contains(expected)), "{errors:?}");
        assert!((&wide, &binary) == (&before.0, &before.1), "{expected}");
    };
    refuse(&good[1..], "a tree over 10000 primitives cannot take on the places of 9999");
    refuse(&[], "the places of 0");
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut bad = good.clone();
            for primitive in [7000, 9000] {
                let mut min = bad[primitive].min.to_array();
                min[axis] = value;
                bad[primitive].min = min.into();
            }
            refuse(&bad, "primitive 7000 has the bounds");
        }
    }
    let mut empty = good;
    empty[3] = Aabb::EMPTY;
    refuse(&empty, "primitive 3 has the bounds");

    let positions = mesh.positions();
    let few = mesh.with_positions(positions[1..].to_vec()).expect_err("one is missing");
    assert_eq!(few, MeshError::PositionCount { before: 30_000, now: 29_999 });
    let mut odd = positions.to_vec();
    (odd[5].x, odd[17].z) = (f32::NAN, f32::INFINITY);
    let odd = mesh.with_positions(odd).expect_err("they are not finite");
    assert_eq!(odd, MeshError::NotFinite { first: 5, count: 2 });
}

#[test]
fn nothing_moves_nowhere() {
    let nothing = TriangleMesh::default();
    let mut bvh = Bvh::build(&nothing).expect("it builds");
    assert_eq!(bvh.refit(&nothing), Ok(0.0));
    let one = shapes::soup(1, 0.1, 1);
    assert_eq!(bvh.refit(&one), Err(RefitError::PrimitiveCount { tree: 0, geometry: 1 }));
    bvh.validate().expect("it is valid");
}

/// Bytes of a node, and where its children stand.
const NODE: usize = 448;
const CHILDREN: usize = 384;

#[test]
fn loaded_trees_are_copied_before_they_change() {
    let mesh = shapes::soup(3000, 0.1, 3);
    let mut file = Vec::new();
    let built = Bvh::build(mesh.clone()).expect("it builds");
    built.save(&mut file).expect("it is saved");
    let mut loaded = Bvh::load(file).expect("it is sound");
    let other = loaded.clone();
    let (_, shaken) = &moves(&mesh, 1)[3];
    for _ in 0..2 {
        loaded.refit(shaken.clone()).expect("as many");
        loaded.validate().expect("it is valid");
    }
    assert_eq!(other.tree(), built.tree());
}

#[test]
fn forged_trees_that_are_none_are_refused() {
    // All boxes are the same, so that leaves can be exchanged.
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let indices = (0..500).map(|number| [3 * number, 3 * number + 1, 3 * number + 2]);
    let mesh = TriangleMesh::new([triangle; 500].as_flattened().to_vec(), indices.collect());
    let mut file = Vec::new();
    let built = Bvh::build(mesh.expect("finite")).expect("it builds");
    built.save(&mut file).expect("it is saved");
    let mut forgery = Forgery::of(&file);
    // A leaf of the first node in the place of one in another, which lies behind it.
    let child = |forgery: &mut Forgery, at: usize| forgery.get("nodes", at);
    let node = (0..16)
        .map(|lane| child(&mut forgery, CHILDREN + 4 * lane))
        .find(|child| child & 1 == 0)
        .expect("a node below the root");
    let node = (node as usize >> 6) * 64;
    assert!(node >= NODE);
    let leaf_in = |forgery: &mut Forgery, node: usize| {
        let places = (0..16).map(|lane| node + CHILDREN + 4 * lane);
        places.into_iter().find(|&place| {
            let child = forgery.get("nodes", place);
            child != u32::MAX && child & 1 == 1
        })
    };
    let first = leaf_in(&mut forgery, node).expect("a leaf");
    let reference = child(&mut forgery, first);
    let others = (0..16).map(|lane| child(&mut forgery, CHILDREN + 4 * lane)).collect::<Vec<_>>();
    let other = others
        .into_iter()
        .filter(|child| child & 1 == 0)
        .map(|child| (child as usize >> 6) * 64)
        .find(|&other| other != node)
        .expect("another node");
    let second = leaf_in(&mut forgery, other).expect("a leaf");
    forgery.set("nodes", second, reference);

    for offset in [0, 1] {
        // In place, or copied because it is not aligned.
        let bytes = [vec![0; offset], forgery.file()].concat();
        let mut loaded = Bvh::load(Offset(bytes, offset)).expect("it is sound");
        let before = loaded.clone();
        let same = loaded.geometry().clone();
        let error = loaded.refit(same).expect_err("two references lead to one leaf");
        assert!(matches!(error, RefitError::NotATree { .. }), "{error}");
        assert_eq!(loaded.tree(), before.tree());
        drop(before);
        assert!(loaded.refit(loaded.geometry().clone()).is_err(), "and again");
    }
}

/// Bytes from the given one on.
struct Offset(Vec<u8>, usize);

impl AsRef<[u8]> for Offset {
    fn as_ref(&self) -> &[u8] {
        &self.0[self.1..]
    }
}
