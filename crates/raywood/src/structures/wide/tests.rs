//! The wide tree on every level of instructions and with batches of every size, against the binary tree.

use super::node::Reference;
use super::{WideBvh, WideNode, batch, single};
use crate::geometry::TriangleBlock;
use crate::simd::{SimdLevel, dispatch_on};
use crate::structures::AccelerationStructure;
use crate::{
    BuildOptions, Bvh2, Counts, Hit, Joined, Ray, Spheres, TriangleMesh, TriangleTest, Vec3,
};

/// Random numbers from -1 to 1.
fn random(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}

type Things = Joined<TriangleMesh, Spheres>;

/// Triangles, some without area and some twice, and spheres among them.
fn things(triangles: usize, spheres: usize) -> Things {
    let mut random = random(7);
    let mut corners = Vec::new();
    for number in 0..triangles {
        let center = Vec3::new(random(), random(), random());
        let mut corner = || center + 0.2 * Vec3::new(random(), random(), random());
        let triangle = [corner(), corner(), corner()];
        match number % 50 {
            48 => corners.push([triangle[0]; 3]),
            49 => corners.push(*corners.last().expect("others came before")),
            _ => corners.push(triangle),
        }
    }
    let indices = (0..triangles as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let first = TriangleMesh::new(corners.into_flattened(), indices).expect("finite corners");
    let mut sphere = || ([random(), random(), random()], 0.1 + 0.05 * random());
    let second = Spheres::new((0..spheres).map(|_| sphere()).map(|(c, r)| (c.into(), r)).collect());
    Joined { first, second: second.expect("finite spheres") }
}

/// Rays from inside and outside, along axes, with all kinds of intervals, and some that are not valid.
fn rays(count: usize) -> Vec<Ray> {
    let mut random = random(8);
    let one = |number: usize| {
        let origin = 1.5 * Vec3::new(random(), random(), random());
        let direction = Vec3::new(random(), random(), random());
        match number % 16 {
            0 => Ray::new(origin, [0.0, 0.0, direction.z]),
            1 => Ray::new(origin, [direction.x, -0.0, 0.0]),
            2 => Ray::new(origin, direction).with_interval(0.5, 0.75),
            3 => Ray::new(origin, direction).with_interval(-2.0, 1.0),
            4 => Ray::new(origin, direction).with_interval(1.0, 0.0),
            5 => Ray::new(origin, [f32::NAN, 0.0, 1.0]),
            6 => Ray::new(origin, Vec3::ZERO),
            7 => Ray::new(origin, 1e20 * direction),
            8 => Ray::new(origin, 1e-20 * direction),
            _ => Ray::new(origin, direction),
        }
    };
    (0..count).map(one).collect()
}

#[test]
fn every_level_and_size_of_batch_answers_as_the_binary_tree() {
    for (triangles, spheres) in [(0, 0), (1, 0), (0, 1), (8, 0), (9, 3), (3000, 200)] {
        let things = things(triangles, spheres);
        let options = BuildOptions::default();
        let tree = WideBvh::build(&things, &options).expect("it builds");
        assert_eq!(tree.validate(&things), Ok(()));
        let binary = Bvh2::build(&things, &options).expect("it builds");
        let rays = rays(1000);
        let expected: Vec<_> =
            rays.iter().map(|ray| binary.intersect(&things, ray, &mut ())).collect();
        assert!(triangles < 1000 || expected.iter().flatten().count() > 300);

        for &level in SimdLevel::ALL.iter().filter(|level| level.is_available()) {
            let what = format!("{}, {triangles} triangles, {spheres} spheres", level.name());
            let (geometry, tree) = (&things, &tree);
            for (ray, expected) in rays.iter().zip(&expected) {
                let probe = &mut Counts::default();
                let hit =
                    dispatch_on(level, single::Closest::<_, false> { tree, geometry, ray, probe });
                assert_eq!(hit, *expected, "{what}: {ray:?}");
                let blocked =
                    dispatch_on(level, single::Any::<_, false> { tree, geometry, ray, probe });
                assert_eq!(blocked, expected.is_some(), "{what}: {ray:?}");
            }
            for size in [0, 1, 2, 63, 64, 65, 1000] {
                let rays = &rays[..size];
                // What was there before must not matter.
                let nonsense = Hit { t: 7.0, u: 7.0, v: 7.0, primitive: 7, instance: 7 };
                let hits = &mut vec![Some(nonsense); size][..];
                dispatch_on(
                    level,
                    batch::Closest::<_, _, false> { tree, geometry, rays, hits: &mut *hits },
                );
                assert!(*hits == expected[..size], "{what}: a batch of {size}");
                let occluded = &mut vec![true; size][..];
                dispatch_on(level, batch::Any::<_, false> { tree, geometry, rays, occluded });
                let right = occluded.iter().zip(&expected).all(|(o, hit)| *o == hit.is_some());
                assert!(right, "{what}: a batch of {size} for any hit");
            }
        }
    }
}

#[test]
fn one_vertex_far_away_is_no_reason_to_look_everywhere() {
    for far in [1e18, 1e20, 1e30] {
        let Joined { first, second } = things(3000, 0);
        let mut positions = first.positions().to_vec();
        positions[300].x = far;
        let first = TriangleMesh::new(positions, first.triangles().to_vec()).expect("finite");
        let things = Joined { first, second };
        let tree = WideBvh::build(&things, &BuildOptions::default()).expect("it builds");
        let binary = Bvh2::build(&things, &BuildOptions::default()).expect("it builds");
        // Without those that hardly move along an axis: of boxes along that nothing can be said.
        let rays = rays(2000).into_iter().enumerate().filter(|(number, _)| number % 16 > 8);
        let rays: Vec<_> = rays.map(|(_, ray)| ray).collect();
        let expected: Vec<_> =
            rays.iter().map(|ray| binary.intersect(&things, ray, &mut ())).collect();
        assert!(expected.iter().flatten().count() > 300);
        for &level in SimdLevel::ALL.iter().filter(|level| level.is_available()) {
            let (geometry, tree, rays) = (&things, &tree, &rays[..]);
            let mut probe = Counts::default();
            for (ray, expected) in rays.iter().zip(&expected) {
                let probe = &mut probe;
                let closest = single::Closest::<_, false> { tree, geometry, ray, probe };
                assert_eq!(dispatch_on(level, closest), *expected, "{far:e}: {ray:?}");
            }
            let each = probe.nodes / rays.len() as u64;
            assert!(each < 60, "{far:e}, {}: {each} nodes and leaves for a ray", level.name());
            let hits = &mut vec![None; rays.len()][..];
            let closest = batch::Closest::<_, _, false> { tree, geometry, rays, hits: &mut *hits };
            dispatch_on(level, closest);
            assert!(*hits == expected, "{far:e}: a batch");
        }
    }
}

#[test]
fn fast_tests_find_nearly_the_same() {
    let things = things(3000, 50);
    let options = BuildOptions { triangle_test: TriangleTest::Fast, ..Default::default() };
    let tree = &WideBvh::build(&things, &options).expect("it builds");
    let binary = Bvh2::build(&things, &options).expect("it builds");
    let rays = &rays(20_000)[..];
    for &level in SimdLevel::ALL.iter().filter(|level| level.is_available()) {
        let geometry = &things;
        let hits = &mut vec![None; rays.len()][..];
        dispatch_on(level, batch::Closest::<_, _, true> { tree, geometry, rays, hits: &mut *hits });
        let occluded = &mut vec![false; rays.len()][..];
        dispatch_on(level, batch::Any::<_, true> { tree, geometry, rays, occluded });
        let mut different = 0;
        for ((ray, hit), occluded) in rays.iter().zip(&*hits).zip(&*occluded) {
            let probe = &mut ();
            let alone =
                dispatch_on(level, single::Closest::<_, true> { tree, geometry, ray, probe });
            let near = |a: Option<Hit>, b: Option<Hit>| match (a, b) {
                (Some(a), Some(b)) => (a.t - b.t).abs() <= 1e-4 * a.t.abs(),
                (a, b) => a.is_none() && b.is_none(),
            };
            let expected = binary.intersect(&things, ray, probe);
            let same =
                near(expected, *hit) && near(expected, alone) && expected.is_some() == *occluded;
            different += usize::from(!same);
        }
        assert!(different <= rays.len() / 1000, "{}: {different}", level.name());
    }
}

#[test]
fn damage_is_noticed() {
    let things = things(500, 20);
    let tree = WideBvh::build(&things, &BuildOptions::default()).expect("it builds");
    let damaged = |damage: fn(&mut WideBvh)| {
        let mut tree = tree.clone();
        damage(&mut tree);
        assert!(tree.validate(&things).is_err());
    };
    fn root(tree: &mut WideBvh) -> &mut WideNode {
        tree.arena.get_mut(tree.root.line())
    }
    fn first_leaf(tree: &mut WideBvh) -> &mut TriangleBlock {
        let mut reference = tree.root;
        while !reference.is_leaf() {
            reference = tree.node(reference).children().next().expect("a child").1;
        }
        tree.arena.get_mut(reference.line())
    }
    damaged(|tree| root(tree).planes[0][0][0] += 10.0);
    damaged(|tree| root(tree).children[1] = root(tree).children[0]);
    damaged(|tree| root(tree).children[0] = Reference::NOTHING.0);
    damaged(|tree| root(tree).children[0] |= u32::MAX << 6);
    damaged(|tree| first_leaf(tree).primitives[0] = 100_000);
    damaged(|tree| first_leaf(tree).primitives[0] = first_leaf(tree).primitives[1]);
    damaged(|tree| {
        let primitive = first_leaf(tree).primitives[0];
        first_leaf(tree).set(0, primitive, [Vec3::ZERO; 3]);
    });
    damaged(|tree| tree.depth = 1);
    damaged(|tree| tree.primitives += 1);
    damaged(|tree| tree.arena.grow(7));
}

#[test]
fn most_leaves_are_full_and_most_nodes_have_many_children() {
    let things = things(20_000, 0);
    let tree = WideBvh::build(&things, &BuildOptions::default()).expect("it builds");
    let stats = tree.stats();
    assert!(stats.mean_leaf_primitives > 3.0, "{stats}");
    let children = (stats.nodes - 1) as f64 / (stats.nodes - stats.leaves) as f64;
    assert!(children > 8.0, "{children} children a node: {stats}");
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let things = things(40_000, 100);
    for preset in crate::BuildPreset::ALL {
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let build = || WideBvh::build(&things, &preset.options()).expect("it builds");
            pool.expect("a pool").install(build)
        };
        let one = build(1);
        for threads in [2, 3, 8] {
            assert!(build(threads) == one, "{}: {threads} threads", preset.name());
        }
    }
}
