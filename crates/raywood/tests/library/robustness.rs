//! What Embree's own test program asks of a kernel, asked here: rays that are none and what they cost, geometry of random bits, a hundred thousand equal primitives, nothing at all, rays that
//! are switched off, many threads at once, and panics in what the caller brings along. Masks, culling and filters have `hit_options.rs`, watchers `watched_builds.rs`.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU32, Ordering};

use raywood::{
    Aabb, Ball, BuildPreset, Bvh, Counts, DynamicBvh, Geometry, Hit, HitColumns, Joined,
    PreparedRay, PrimitiveHit, Ray, RefitError, SimdLevel, Spheres, Structure, StructureKind,
    SurfacePoint, Tlas, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, rays, shapes};

/// The levels of instructions that this processor has.
fn levels() -> impl Iterator<Item = SimdLevel> {
    SimdLevel::ALL.iter().copied().filter(|level| level.is_available())
}

/// Rays that hit nothing because a number of them is none or infinite.
fn broken(good: &Ray) -> Vec<Ray> {
    let mut broken = Vec::new();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let with = |v: Vec3| {
                let mut v = v.to_array();
                v[axis] = value;
                Vec3::from(v)
            };
            broken.push(Ray { origin: with(good.origin), ..*good });
            broken.push(Ray { direction: with(good.direction), ..*good });
        }
        broken.push(Ray { origin: Vec3::splat(value), direction: Vec3::splat(value), ..*good });
    }
    broken.push(good.with_interval(f32::NAN, f32::NAN));
    broken
}

#[test]
fn rays_that_are_none_miss_and_cost_no_more_than_good_ones() {
    let mesh = shapes::soup(20_000, 0.05, 1);
    let good = Ray::new([-3.0, 0.1, 0.2], [1.0, 0.01, -0.03]);
    for &kind in StructureKind::ALL {
        let mut structure = Structure::build(kind, &mesh, &Default::default()).expect("it builds");
        for level in levels() {
            structure.set_simd_level(level);
            let cost = |ray: &Ray| {
                let mut counts = Counts::default();
                let hit = structure.intersect_probed(ray, &mut counts);
                let is_occluded = structure.occluded_probed(ray, &mut counts);
                assert_eq!(hit.is_some(), is_occluded);
                (hit, counts.nodes + counts.boxes + counts.primitives)
            };
            let (hit, usual) = cost(&good);
            assert!(hit.is_some() && usual > 10, "{}", kind.name());
            for ray in broken(&good) {
                let (hit, cost) = cost(&ray);
                assert_eq!(hit, None, "{}: {ray:?}", kind.name());
                assert!(2 * cost <= 5 * usual, "{}: {cost} of {usual}, {ray:?}", kind.name());
            }
        }
    }
}

#[test]
#[ignore = "looks at the clock: cargo test --release --test library -- --ignored rays_that_are_none_take"]
fn rays_that_are_none_take_no_more_time_than_good_ones() {
    let mesh = shapes::soup(200_000, 0.02, 1);
    let mut rng = Rng::new(2);
    let good: Vec<_> =
        (0..100_000).map(|_| Ray::between(2.0 * rng.in_cube(), rng.in_cube())).collect();
    let bad: Vec<_> = good
        .iter()
        .enumerate()
        .map(|(number, ray)| {
            let broken = broken(ray);
            broken[number % broken.len()]
        })
        .collect();
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    for level in levels() {
        bvh.set_simd_level(level);
        let mut hits: Vec<Option<Hit>> = vec![None; good.len()];
        let mut seconds = |rays: &[Ray]| {
            let mut least = f64::INFINITY;
            for _ in 0..9 {
                let start = std::time::Instant::now();
                bvh.intersect_batch(rays, &mut hits);
                least = least.min(start.elapsed().as_secs_f64());
            }
            least
        };
        let (usual, broken) = (seconds(&good), seconds(&bad));
        assert!(broken <= 2.5 * usual, "{level:?}: {broken} s instead of {usual} s");
    }
}

/// Triangles whose corners are random bits, those that are finite.
fn garbage(count: usize, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let mut number = || loop {
        let number = f32::from_bits(rng.bits() as u32);
        if number.is_finite() {
            return number;
        }
    };
    let positions: Vec<_> = (0..3 * count).map(|_| [number(), number(), number()]).collect();
    let triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(positions, triangles).expect("finite")
}

#[test]
fn geometry_of_random_bits_does_no_harm() {
    for seed in 0..4 {
        let mesh = garbage(700, seed);
        let mut rays = rays::against(&mesh, 400, seed);
        rays.extend(rays::against(&shapes::soup(10, 1.0, seed), 100, seed));
        for &kind in StructureKind::ALL {
            let structure = Structure::build(kind, &mesh, &Default::default()).expect("it builds");
            structure.validate().unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
            for ray in &rays {
                if let Some(hit) = structure.intersect(ray) {
                    assert!(ray.t_min <= hit.t && hit.t < ray.t_max, "{}", kind.name());
                    let _ = structure.surface_point(ray, &hit).spawn(Vec3::ONE);
                }
            }
        }
        for preset in BuildPreset::ALL {
            let mut bvh = Bvh::build_with(mesh.clone(), &preset.options()).expect("it builds");
            for level in levels() {
                bvh.set_simd_level(level);
                raywood_testkit::saved::ask_everything(&bvh, seed);
            }
            bvh.refit(garbage(700, seed + 100)).expect("as many");
            bvh.validate().unwrap_or_else(|error| panic!("{}: {error}", preset.name()));
            raywood_testkit::saved::ask_everything(&bvh, seed);
        }
    }
}

#[test]
fn a_hundred_thousand_equal_primitives_answer_every_query() {
    const COUNT: usize = 50_000;
    let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]; COUNT]);
    let spheres = Spheres::new(vec![(Vec3::new(0.0, 0.0, 5.0), 1.0); COUNT]);
    let both = Joined { first: mesh.expect("a mesh"), second: spheres.expect("spheres") };
    let ray = Ray::new([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]);
    for preset in BuildPreset::ALL {
        let name = preset.name();
        let mut bvh = Bvh::build_with(&both, &preset.options()).expect("it builds");
        bvh.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
        for level in levels() {
            bvh.set_simd_level(level);
            let hit = bvh.intersect(&ray).map(|hit| (hit.primitive, hit.t));
            assert_eq!(hit, Some((0, 1.0)), "{name}");
            let behind = bvh.intersect(&ray.with_interval(1.5, f32::INFINITY));
            assert_eq!(behind.map(|hit| hit.primitive), Some(COUNT as u32), "{name}");
            let mut hits = Vec::new();
            bvh.nearest_hits(&ray, 3, &mut hits);
            assert!(hits.iter().map(|hit| hit.primitive).eq(0..3), "{name}");
            // Each triangle once, each sphere twice.
            assert_eq!(bvh.crossings(&ray), 3 * COUNT, "{name}");
            let closest = bvh.closest_point([0.25, 0.25, -2.0], f32::INFINITY);
            let closest = closest.map(|closest| (closest.primitive, closest.distance));
            assert_eq!(closest, Some((0, 2.0)), "{name}");
            let mut touched = 0;
            let _ = bvh.overlapping(&Ball::new([0.25, 0.25, 0.0], 0.1), |_| {
                touched += 1;
                ControlFlow::Continue(())
            });
            assert_eq!(touched, COUNT, "{name}");
        }
    }
}

#[test]
fn nothing_answers_every_query() {
    let nothing = TriangleMesh::new(Vec::<Vec3>::new(), vec![]).expect("legal");
    let no_triangles = TriangleMesh::new(vec![Vec3::X], vec![]).expect("legal");
    let rays: Vec<_> = {
        let mut rng = Rng::new(3);
        (0..300).map(|_| Ray::new(rng.in_cube(), rng.direction())).collect()
    };
    let hit = Hit { t: 1.0, u: 0.0, v: 0.0, primitive: 1, instance: 0 };
    for mesh in [&nothing, &no_triangles] {
        for &kind in StructureKind::ALL {
            let structure = Structure::build(kind, mesh, &Default::default()).expect("it builds");
            structure.validate().unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
            let (mut hits, mut occluded) = (vec![Some(hit); rays.len()], vec![true; rays.len()]);
            structure.intersect_batch(&rays, &mut hits);
            structure.occluded_batch(&rays, &mut occluded);
            assert!(hits.iter().all(Option::is_none) && occluded.iter().all(|is| !is));
        }
        let mut scene = DynamicBvh::build(mesh.clone()).expect("it builds");
        for _ in 0..2 {
            raywood_testkit::saved::ask_everything(scene.bvh(), 1);
            assert!(scene.bvh().closest_point(Vec3::ZERO, f32::INFINITY).is_none());
            assert!(!scene.bvh().overlaps(&Ball::new(Vec3::ZERO, f32::INFINITY)));
            scene.update(mesh.clone()).expect("still nothing");
        }
    }
    let scene: Tlas<Bvh<TriangleMesh>> = Tlas::build(Vec::new()).expect("it builds");
    assert!(rays.iter().all(|ray| scene.intersect(ray).is_none() && !scene.occluded(ray)));
}

#[test]
fn rays_that_are_switched_off_answer_nothing_and_change_nothing_for_others() {
    let mesh = shapes::soup(5000, 0.1, 7);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let eye = Vec3::new(0.3, -0.4, 4.0);
    let place = |i: usize| 2.0 * (i as f32 + 0.5) / 16.0 - 1.0;
    let good: Vec<_> = (0..256)
        .map(|i| Ray::new(eye, Vec3::new(place(i % 16), place(i / 16), 0.0) - eye))
        .collect();
    // Every second one, all of a block, all but one, all.
    let choices: [&dyn Fn(usize) -> bool; 4] =
        [&|i| i % 2 == 1, &|i| i < 64, &|i| i != 77, &|_| true];
    for level in levels() {
        bvh.set_simd_level(level);
        for is_off in choices {
            let off = |(i, ray): (usize, &Ray)| {
                if is_off(i) { ray.with_interval(f32::INFINITY, f32::NEG_INFINITY) } else { *ray }
            };
            let rays: Vec<_> = good.iter().enumerate().map(off).collect();
            let stale = Hit { t: -7.0, u: 0.0, v: 0.0, primitive: 12345, instance: 0 };
            let (mut hits, mut occluded) = (vec![Some(stale); 256], vec![true; 256]);
            bvh.intersect_batch(&rays, &mut hits);
            bvh.occluded_batch(&rays, &mut occluded);
            for (i, ray) in good.iter().enumerate() {
                if is_off(i) {
                    assert_eq!((hits[i], occluded[i]), (None, false));
                    continue;
                }
                let alone = bvh.intersect(ray);
                assert_eq!(hits[i].map(|hit| hit.primitive), alone.map(|hit| hit.primitive));
                assert_eq!(occluded[i], alone.is_some());
            }
        }
    }
}

#[test]
fn many_threads_build_and_ask_at_once() {
    let shared = shapes::soup(20_000, 0.05, 1);
    let rays = rays::against(&shared, 2000, 4);
    let bvh = Bvh::build(&shared).expect("it builds");
    let expected: Vec<_> = rays.iter().map(|ray| bvh.intersect(ray)).collect();
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (bvh, shared, rays, expected) = (&bvh, &shared, &rays, &expected);
            scope.spawn(move || {
                for round in 0..4 {
                    // A tree of its own over the same mesh, and the tree of all.
                    let preset = BuildPreset::ALL[(thread + round) % BuildPreset::ALL.len()];
                    let own = Bvh::build_with(shared, &preset.options()).expect("it builds");
                    let mut hits = vec![None; rays.len()];
                    bvh.intersect_batch(rays, &mut hits);
                    let mut columns = HitColumns::default();
                    bvh.intersect_from(rays[0].origin, &[Vec3::X; 300], &mut columns);
                    for ((ray, hit), expected) in rays.iter().zip(&hits).zip(expected) {
                        assert_eq!(hit.is_some(), expected.is_some());
                        assert_eq!(bvh.intersect(ray), *expected);
                        assert_eq!(own.occluded(ray), expected.is_some());
                    }
                }
            });
        }
    });
}

/// A mesh, as primitives of the user's own, of which one panics as long as it is told to.
struct Brittle {
    mesh: TriangleMesh,
    /// Which primitive panics when it is asked for its bounds, and which when it is intersected.
    bounds: AtomicU32,
    intersect: AtomicU32,
}

impl Brittle {
    fn new(mesh: TriangleMesh) -> Self {
        Self { mesh, bounds: AtomicU32::new(u32::MAX), intersect: AtomicU32::new(u32::MAX) }
    }

    fn check(primitive: u32, brittle: &AtomicU32) {
        if primitive == brittle.load(Ordering::Relaxed) {
            // Without the message of a panic on stderr.
            resume_unwind(Box::new("brittle"));
        }
    }
}

impl Geometry for Brittle {
    fn len(&self) -> usize {
        self.mesh.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        Self::check(primitive, &self.bounds);
        self.mesh.bounds(primitive)
    }

    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        Self::check(primitive, &self.intersect);
        self.mesh.intersect(primitive, ray)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.mesh.surface_point(ray, hit)
    }
}

/// That it panics with what `Brittle` throws.
fn check_panic<T>(what: &str, act: impl FnOnce() -> T) {
    let Err(panic) = catch_unwind(AssertUnwindSafe(act)) else { panic!("{what}: no panic") };
    assert_eq!(panic.downcast_ref(), Some(&"brittle"), "{what}");
}

#[test]
fn panics_of_a_geometry_pass_through_and_leave_trees_usable() {
    let mesh = shapes::soup(3000, 0.1, 1);
    let geometry = Brittle::new(mesh.clone());
    let rays = rays::against(&mesh, 1500, 2);
    for &kind in StructureKind::ALL {
        let name = kind.name();
        geometry.bounds.store(1234, Ordering::Relaxed);
        check_panic(name, || Structure::build(kind, &geometry, &Default::default()).map(|_| ()));
        geometry.bounds.store(u32::MAX, Ordering::Relaxed);

        let structure = Structure::build(kind, &geometry, &Default::default()).expect("it builds");
        let expected: Vec<_> = rays.iter().map(|ray| structure.intersect(ray)).collect();
        let hit = expected.iter().flatten().next().expect("a hit");
        geometry.intersect.store(hit.primitive, Ordering::Relaxed);
        let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
        check_panic(name, || rays.iter().filter_map(|ray| structure.intersect(ray)).count());
        check_panic(name, || structure.intersect_batch(&rays, &mut hits));
        let _ = catch_unwind(AssertUnwindSafe(|| structure.occluded_batch(&rays, &mut occluded)));
        geometry.intersect.store(u32::MAX, Ordering::Relaxed);

        structure.intersect_batch(&rays, &mut hits);
        structure.occluded_batch(&rays, &mut occluded);
        for (number, ray) in rays.iter().enumerate() {
            assert_eq!(structure.intersect(ray), expected[number], "{name}");
            assert_eq!(hits[number].is_some(), expected[number].is_some(), "{name}");
            assert_eq!(occluded[number], expected[number].is_some(), "{name}");
        }
        structure.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn panics_while_a_tree_changes_leave_one_that_can_change_again() {
    let mesh = shapes::soup(3000, 0.1, 1);
    let moved = || Brittle::new(shapes::mapped(&mesh, |p| 1.5 * p + Vec3::X));
    let mut bvh = Bvh::build(Brittle::new(mesh.clone())).expect("it builds");
    let mut scene = DynamicBvh::build(Brittle::new(mesh.clone())).expect("it builds");
    for brittle in [0, 1700, 2999] {
        let bad = || {
            let geometry = moved();
            geometry.bounds.store(brittle, Ordering::Relaxed);
            geometry
        };
        check_panic("refit", || bvh.refit(bad()));
        check_panic("update", || scene.update(bad()));
        // What was being changed may be anything, but harms nobody.
        raywood_testkit::saved::ask_everything(&bvh, 1);
        raywood_testkit::saved::ask_everything(scene.bvh(), 1);
        assert!(matches!(
            bvh.refit(Brittle::new(shapes::soup(5, 1.0, 1))),
            Err(RefitError::PrimitiveCount { .. })
        ));
        bvh.refit(moved()).expect("as many");
        scene.update(moved()).expect("sound boxes");
        let fresh = Bvh::build(moved()).expect("it builds");
        for ray in rays::against(&fresh.geometry().mesh, 500, 3) {
            let expected = fresh.intersect(&ray);
            assert_eq!(bvh.intersect(&ray), expected);
            assert_eq!(scene.bvh().intersect(&ray), expected);
        }
        bvh.validate().expect("it is whole again");
        scene.bvh().validate().expect("it is whole again");
    }
}

#[test]
fn panics_of_visitors_pass_through() {
    let bvh = Bvh::build(shapes::soup(3000, 0.1, 1)).expect("it builds");
    let brittle = |_: u32| -> ControlFlow<()> { resume_unwind(Box::new("brittle")) };
    let everywhere = Aabb::new([-9.0; 3], [9.0; 3]);
    check_panic("overlapping", || bvh.overlapping(&everywhere, brittle));
    check_panic("pairs", || bvh.overlapping_pairs(&bvh, |first, _| brittle(first)));
    check_panic("visit", || bvh.visit(|_| Some(0.0), |_| resume_unwind(Box::new("brittle"))));
    check_panic("bound", || {
        bvh.visit(|_| resume_unwind(Box::new("brittle")), |_| ControlFlow::Continue(0.0))
    });
    let mut told = 0;
    let _ = bvh.overlapping(&everywhere, |_| {
        told += 1;
        ControlFlow::Continue(())
    });
    assert_eq!(told, 3000);
    bvh.validate().expect("the tree is as it was");
}
