//! The nearest hits, and which hits options let count, against what follows from all hits.

use std::panic::{AssertUnwindSafe, catch_unwind};

use raywood::{
    Aabb, BuildOptions, Bvh, Face, Geometry, Hit, Joined, PreparedRay, PrimitiveHit, QueryOptions,
    Ray, SimdLevel, Spheres, SurfacePoint, TriangleMesh, TriangleTest, Vec3,
};
use raywood_testkit::{Rng, nasty, oracle, rays, shapes};

/// A geometry whose primitives belong to the group of the remainder of their number by 5.
struct Grouped<G>(G);

impl<G: Geometry> Geometry for Grouped<G> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.0.bounds(primitive)
    }

    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        self.0.triangle(primitive)
    }

    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        self.0.intersect(primitive, ray)
    }

    // Not `intersect_all`: so the default is tested, too.

    fn mask(&self, primitive: u32) -> u32 {
        1 << (primitive % 5)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.0.surface_point(ray, hit)
    }
}

type Mixed = Grouped<Joined<TriangleMesh, Spheres>>;

/// Triangles and spheres all over each other.
fn mixed(seed: u64) -> Mixed {
    let mut rng = Rng::new(seed);
    let spheres = (0..300).map(|_| (rng.in_cube(), rng.range(0.01, 0.3))).collect();
    let second = Spheres::new(spheres).expect("sound spheres");
    Grouped(Joined { first: shapes::soup(1500, 0.3, seed), second })
}

fn some_rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    (0..count)
        .map(|i| {
            let ray = Ray::new(2.0 * rng.in_cube(), rng.direction());
            if i % 3 == 0 { ray.with_interval(-0.5, rng.range(0.0, 2.0)) } else { ray }
        })
        .collect()
}

/// A tree for each level of instructions.
fn trees<G: Geometry + Clone>(geometry: &G) -> Vec<Bvh<&G>> {
    let at = |level| {
        let mut bvh = Bvh::build(geometry).expect("it builds");
        bvh.set_simd_level(level);
        bvh
    };
    SimdLevel::available().map(at).collect()
}

fn all_hits<G: Geometry>(bvh: &Bvh<G>, ray: &Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    bvh.all_hits(ray, &mut hits);
    hits
}

/// Whether a ray meets the front of what it hits.
fn is_front<G: Geometry>(geometry: &G, ray: &Ray, hit: &Hit) -> bool {
    let normal = geometry.surface_point(ray, hit).normal.to_array().map(f64::from);
    let direction = ray.direction.to_array().map(f64::from);
    normal.iter().zip(direction).map(|(n, d)| n * d).sum::<f64>() < 0.0
}

#[test]
fn the_nearest_hits_are_the_first_of_all() {
    for (number, nasty) in nasty::all().iter().enumerate() {
        let trees = trees(&nasty.mesh);
        let mut hits = Vec::new();
        for (i, ray) in rays::against(&nasty.mesh, 600, number as u64).iter().enumerate() {
            for bvh in &trees {
                let all = all_hits(bvh, ray);
                for k in [0, 1, 2, 3, 7, 100, usize::MAX] {
                    bvh.nearest_hits(ray, k, &mut hits);
                    assert_eq!(hits, all[..k.min(all.len())], "{}, {k}: {ray:?}", nasty.name);
                }
            }
            if i % 4 == 0 {
                trees[0].nearest_hits(ray, 3, &mut hits);
                oracle::check_all(&nasty.mesh, ray, &hits, 3)
                    .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
            }
        }
    }
}

#[test]
fn spheres_are_met_where_double_precision_says() {
    let mut rng = Rng::new(5);
    let spheres: Vec<_> = (0..200).map(|_| (rng.in_cube(), rng.range(0.01, 0.5))).collect();
    let geometry = Spheres::new(spheres.clone()).expect("sound");
    let bvh = Bvh::build(&geometry).expect("it builds");
    let mut found = 0;
    for ray in some_rays(5000, 6) {
        let mut expected = Vec::new();
        for (primitive, &(center, radius)) in spheres.iter().enumerate() {
            let double = |v: Vec3| v.to_array().map(f64::from);
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (d, o, c) = (double(ray.direction), double(ray.origin), double(center));
            let m = [0, 1, 2].map(|i| o[i] - c[i]);
            let (a, b) = (dot(d, d), dot(m, d));
            let discriminant = b * b - a * (dot(m, m) - f64::from(radius) * f64::from(radius));
            if discriminant > 0.0 {
                let ts = [-1.0, 1.0].map(|sign| (-b + sign * discriminant.sqrt()) / a);
                expected.extend(ts.map(|t| (t, primitive as u32)));
            }
        }
        let interval = f64::from(ray.t_min)..f64::from(ray.t_max);
        expected.retain(|(t, _)| interval.contains(t));
        expected.sort_by(|a, b| a.0.total_cmp(&b.0));
        let hits = all_hits(&bvh, &ray);
        assert_eq!(hits.len(), expected.len(), "{ray:?}");
        for (hit, (t, primitive)) in hits.iter().zip(expected) {
            assert!((f64::from(hit.t) - t).abs() < 1e-5, "{hit:?} instead of {t}");
            assert!(hit.primitive == primitive || hits.iter().any(|h| h.primitive == primitive));
            found += 1;
        }
    }
    assert!(found > 10_000, "only {found} hits");
}

#[test]
fn options_leave_what_counts_of_all_hits() {
    let geometry = mixed(1);
    let levels = SimdLevel::available().map(|level| {
        let mut bvh = Bvh::build(&geometry).expect("it builds");
        bvh.set_simd_level(level);
        bvh
    });
    let mut left_out = 0;
    for bvh in levels {
        let mut hits = Vec::new();
        for (i, ray) in some_rays(4000, 2).iter().enumerate() {
            let all = all_hits(&bvh, ray);
            let skipped = all.first().map_or(0, |hit| hit.primitive);
            let mask = 1 << (i % 5) | 1 << (i % 3);
            let cull = [None, Some(Face::Front), Some(Face::Back)][i % 3];
            let filter = |hit: &Hit| hit.primitive % 3 != 1 && (10.0 * hit.t).fract() < 0.8;

            let mut options = QueryOptions::new().mask(mask).skip(skipped);
            if let Some(face) = cull {
                options = options.cull(face);
            }
            let options = options.filter(filter);
            let expected: Vec<Hit> = all
                .iter()
                .filter(|hit| {
                    let front = is_front(&geometry, ray, hit);
                    let culled = cull == Some(if front { Face::Front } else { Face::Back });
                    hit.primitive != skipped
                        && mask & geometry.mask(hit.primitive) != 0
                        && !culled
                        && filter(hit)
                })
                .copied()
                .collect();
            left_out += all.len() - expected.len();

            bvh.all_hits_with(ray, options, &mut hits);
            assert_eq!(hits, expected, "{ray:?}");
            bvh.nearest_hits_with(ray, 2, options, &mut hits);
            assert_eq!(hits, expected[..expected.len().min(2)], "{ray:?}");
            assert_eq!(bvh.intersect_with(ray, options), expected.first().copied(), "{ray:?}");
            assert_eq!(bvh.occluded_with(ray, options), !expected.is_empty(), "{ray:?}");
        }
    }
    assert!(left_out > 10_000, "only {left_out} hits left out");
}

#[test]
fn options_that_ask_for_nothing_change_nothing() {
    for (number, nasty) in nasty::all().iter().enumerate() {
        for triangle_test in [TriangleTest::Watertight, TriangleTest::Fast] {
            let options = BuildOptions { triangle_test, ..Default::default() };
            let mut bvh = Bvh::build_with(&nasty.mesh, &options).expect("it builds");
            for level in SimdLevel::available() {
                bvh.set_simd_level(level);
                for ray in rays::against(&nasty.mesh, 500, number as u64) {
                    let plain = bvh.intersect(&ray);
                    let none = QueryOptions::new();
                    assert_eq!(bvh.intersect_with(&ray, none), plain, "{}: {ray:?}", nasty.name);
                    assert_eq!(bvh.occluded_with(&ray, none), plain.is_some(), "{}", nasty.name);
                }
            }
        }
    }
}

#[test]
fn the_lowest_number_that_counts_wins_among_equals() {
    let copies = nasty::all().into_iter().find(|n| n.name == "every triangle five times");
    let mesh = copies.expect("it is in the list").mesh;
    let bvh = Bvh::build(&mesh).expect("it builds");
    let mut compared = 0;
    for ray in rays::against(&mesh, 5000, 5) {
        let Some(hit) = bvh.intersect(&ray) else { continue };
        // Copies stand 60 apart, at the same distance.
        let options = QueryOptions::new().filter(|hit: &Hit| hit.primitive >= 120);
        assert_eq!(
            bvh.intersect_with(&ray, options),
            Some(Hit { primitive: hit.primitive + 120, ..hit })
        );
        compared += 1;
    }
    assert!(compared > 2000, "only {compared} hits");
}

#[test]
fn filters_are_asked_of_no_hit_twice_and_keep_what_they_learn() {
    let geometry = mixed(3);
    let bvh = Bvh::build(&geometry).expect("it builds");
    let mut hits = Vec::new();
    for ray in some_rays(2000, 4) {
        let mut asked = Vec::new();
        let mut filter = |hit: &Hit| {
            asked.push(*hit);
            false
        };
        bvh.all_hits_with(&ray, QueryOptions::new().filter(&mut filter), &mut hits);
        assert!(hits.is_empty());
        asked.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
        assert_eq!(asked, all_hits(&bvh, &ray), "{ray:?}");

        let mut asked = Vec::new();
        let mut filter = |hit: &Hit| {
            asked.push((hit.primitive, hit.t.to_bits()));
            false
        };
        assert_eq!(bvh.intersect_with(&ray, QueryOptions::new().filter(&mut filter)), None);
        assert!(!bvh.occluded_with(&ray, QueryOptions::new().filter(|_: &Hit| false)));
        let count = asked.len();
        asked.sort_unstable();
        asked.dedup();
        assert_eq!(asked.len(), count, "{ray:?}");
    }
}

#[test]
fn a_panic_in_a_closure_passes_through_and_harms_nothing() {
    let geometry = mixed(7);
    let bvh = Bvh::build(&geometry).expect("it builds");
    let ray = Ray::new([-3.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    let before = all_hits(&bvh, &ray);
    assert!(before.len() > 10);
    let mut asked = 0;
    let mut filter = |_: &Hit| {
        asked += 1;
        assert!(asked < 3, "enough");
        false
    };
    let options = QueryOptions::new().filter(&mut filter);
    let answer = catch_unwind(AssertUnwindSafe(|| bvh.intersect_with(&ray, options)));
    let message = *answer.expect_err("it panicked").downcast::<&str>().expect("with a message");
    assert_eq!((message, asked), ("enough", 3));
    let visit = AssertUnwindSafe(|| bvh.for_each_hit(&ray, |_| panic!("at once")));
    assert!(catch_unwind(visit).is_err());

    assert_eq!(all_hits(&bvh, &ray), before);
    assert_eq!(bvh.intersect(&ray).map(|hit| hit.t), before.first().map(|hit| hit.t));
    bvh.validate().expect("the tree is as it was");
}

#[test]
fn batches_answer_as_single_rays_do() {
    let geometry = mixed(8);
    let bvh = Bvh::build(&geometry).expect("it builds");
    let mut one = Vec::new();
    for count in [0, 1, 511, 513, 5000] {
        let rays = some_rays(count, 9);
        let all = bvh.all_hits_batch(&rays);
        let nearest = bvh.nearest_hits_batch(&rays, 4);
        assert_eq!((all.len(), nearest.len(), all.is_empty()), (count, count, count == 0));
        assert_eq!(all.offsets().last(), Some(&all.hits().len()));
        for (number, ray) in rays.iter().enumerate() {
            bvh.all_hits(ray, &mut one);
            assert_eq!(all.of(number), one, "{ray:?}");
            bvh.nearest_hits(ray, 4, &mut one);
            assert_eq!(nearest.of(number), one, "{ray:?}");
        }
        let (hits, offsets) = all.clone().into_parts();
        assert!(all.iter().flatten().eq(&hits) && offsets.is_sorted());
    }
    for threads in [1, 3] {
        let rays = some_rays(3000, 10);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        assert_eq!(pool.install(|| bvh.all_hits_batch(&rays)), bvh.all_hits_batch(&rays));
    }
}

#[test]
fn what_is_empty_or_invalid_has_no_hits() {
    let nothing = TriangleMesh::new(Vec::<Vec3>::new(), vec![]).expect("legal");
    let empty = Bvh::build(&nothing).expect("it builds");
    let geometry = mixed(1);
    let full = Bvh::build(&geometry).expect("it builds");
    let good = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
    let bad = [
        Ray::new([f32::NAN, 0.0, 0.0], [0.0, 0.0, 1.0]),
        Ray::new([0.0; 3], [0.0, f32::INFINITY, 1.0]),
        good.with_interval(0.0, f32::NAN),
    ];
    let mut hits = all_hits(&full, &good);
    assert!(!hits.is_empty());
    empty.nearest_hits(&good, 3, &mut hits);
    assert!(hits.is_empty() && empty.crossings(&good) == 0);
    for ray in bad {
        let options = QueryOptions::new().cull(Face::Back);
        full.nearest_hits(&ray, 3, &mut hits);
        assert!(hits.is_empty() && all_hits(&full, &ray).is_empty(), "{ray:?}");
        assert!(full.intersect_with(&ray, options).is_none() && !full.occluded_with(&ray, options));
    }
}
