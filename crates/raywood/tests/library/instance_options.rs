//! Options, all hits and the nearest hits through scenes of instances, on several levels: what flattened scenes answer, and what follows from all hits.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use raywood::{
    Aabb, Bvh, Face, Geometry, Hit, Instance, Joined, PreparedRay, PrimitiveHit, QueryOptions, Ray,
    SimdLevel, Spheres, SurfacePoint, Tlas, Traceable, Transform, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, closed, oracle, rays, shapes};

use crate::instances::{friendly, nasty_transforms, thickness};

/// Triangles and spheres, each in one of five groups.
struct Grouped(Joined<TriangleMesh, Spheres>);

impl Geometry for Grouped {
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

    fn mask(&self, primitive: u32) -> u32 {
        1 << (primitive % 5)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.0.surface_point(ray, hit)
    }
}

/// Instances in groups of their own: bit by bit, all, and some in none.
fn grouped<B: Traceable>(object: &Arc<B>, transforms: &[Transform]) -> Vec<Instance<B>> {
    let masks = [u32::MAX, 0b00111, 0b11010, 0, 0b10101, u32::MAX];
    let pairs = transforms.iter().zip(masks.into_iter().cycle());
    pairs.map(|(&t, mask)| Instance { mask, ..Instance::new(Arc::clone(object), t) }).collect()
}

/// A scene of scenes, and what stands in the inner ones.
struct TwoLevels<G> {
    scene: Tlas<Tlas<Bvh<G>>>,
    inner: Arc<Tlas<Bvh<G>>>,
}

fn two_levels<G: Geometry + Send>(geometry: G, level: SimdLevel, seed: u64) -> TwoLevels<G> {
    let mut rng = Rng::new(seed);
    let mut bvh = Bvh::build(geometry).expect("it builds");
    bvh.set_simd_level(level);
    let mut inner = Tlas::build(grouped(&Arc::new(bvh), &friendly(&mut rng))).expect("good");
    inner.set_simd_level(level);
    let inner = Arc::new(inner);
    let mut scene = Tlas::build(grouped(&inner, &friendly(&mut rng))).expect("good");
    scene.set_simd_level(level);
    TwoLevels { scene, inner }
}

impl<G: Geometry + Send> TwoLevels<G> {
    /// The instances on both levels that a hit belongs to.
    fn of(&self, hit: &Hit) -> (&Instance<Tlas<Bvh<G>>>, &Instance<Bvh<G>>) {
        let (outer, rest) = self.scene.locate(hit.instance);
        let (inner, _) = self.inner.locate(rest);
        (&self.scene.instances()[outer], &self.inner.instances()[inner])
    }

    /// Whether a query with a mask sees a hit: only if it sees everything that this is in.
    fn sees(&self, mask: u32, hit: &Hit) -> bool {
        let (outer, inner) = self.of(hit);
        let primitive = inner.object.geometry().mask(hit.primitive);
        [outer.mask, inner.mask, primitive].iter().all(|other| other & mask != 0)
    }

    fn all_hits(&self, ray: &Ray) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.scene.all_hits(ray, &mut hits);
        hits
    }
}

fn mixed(seed: u64) -> Grouped {
    let mut rng = Rng::new(seed);
    let spheres = (0..30).map(|_| (rng.in_cube(), rng.range(0.05, 0.4))).collect();
    let second = Spheres::new(spheres).expect("sound spheres");
    Grouped(Joined { first: shapes::soup(120, 0.8, seed), second })
}

fn some_rays(bounds: &Aabb, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let (center, half) = (bounds.center(), 0.5 * bounds.extent());
    let mut near = move |reach: f32| center + reach * half * rng.in_cube();
    (0..count)
        .map(|i| {
            let (from, to) = (near(1.2), near(0.5));
            match i % 3 {
                0 => Ray::between(from, to),
                1 => Ray::new(from, to - from).with_interval(-0.5, 1.5),
                _ => Ray::new(from, to - from),
            }
        })
        .collect()
}

/// Whether a ray meets the side of the surface that its normal points to.
fn is_front(point: &SurfacePoint, ray: &Ray) -> bool {
    let (n, d) = (point.normal.to_array().map(f64::from), ray.direction.to_array().map(f64::from));
    n[0] * d[0] + n[1] * d[1] + n[2] * d[2] < 0.0
}

#[test]
fn options_leave_what_counts_of_all_hits_on_every_level() {
    let (mut left_out, mut left) = (0, 0);
    for level in SimdLevel::available() {
        let two = two_levels(mixed(1), level, 2);
        let scene = &two.scene;
        let mut hits = Vec::new();
        for (i, ray) in some_rays(&scene.bounds(), 1500, 3).iter().enumerate() {
            let all = two.all_hits(ray);
            assert!(all.iter().all(|hit| {
                let (outer, inner) = two.of(hit);
                outer.mask != 0 && inner.mask != 0
            }));
            let skipped = all.first().map_or((0, 0), |hit| (hit.instance, hit.primitive));
            let mask = 1 << (i % 5) | 1 << (i % 3);
            let cull = [None, Some(Face::Front), Some(Face::Back)][i % 3];
            let filter = |hit: &Hit| hit.instance % 3 != 1 && (10.0 * hit.t).fract() < 0.8;

            let mut options = QueryOptions::new().mask(mask).skip_in(skipped.0, skipped.1);
            if let Some(face) = cull {
                options = options.cull(face);
            }
            let options = options.filter(filter);
            let counts = |hit: &&Hit| {
                let front = is_front(&scene.surface_point(ray, hit), ray);
                let culled = cull == Some(if front { Face::Front } else { Face::Back });
                let is_skipped = (hit.instance, hit.primitive) == skipped;
                !is_skipped && two.sees(mask, hit) && !culled && filter(hit)
            };
            let expected: Vec<Hit> = all.iter().filter(counts).copied().collect();
            left_out += all.len() - expected.len();
            left += expected.len();

            scene.all_hits_with(ray, options, &mut hits);
            assert_eq!(hits, expected, "{ray:?}");
            scene.nearest_hits_with(ray, 2, options, &mut hits);
            assert_eq!(hits, expected[..expected.len().min(2)], "{ray:?}");
            assert_eq!(scene.intersect_with(ray, options), expected.first().copied(), "{ray:?}");
            assert_eq!(scene.occluded_with(ray, options), !expected.is_empty(), "{ray:?}");
        }
    }
    assert!(left_out > 10_000 && left > 1000, "{left_out} hits left out, {left} left");
}

#[test]
fn all_hits_are_those_of_the_flattened_scene() {
    for level in SimdLevel::available() {
        let two = two_levels(shapes::soup(60, 0.9, 5), level, 6);
        // Every primitive of every instance in order, those in no group without area far away.
        let (mut positions, mut sides) = (Vec::new(), Vec::new());
        for outer in two.scene.instances() {
            for inner in two.inner.instances() {
                let mirrored = outer.transform.mirrors() != inner.transform.mirrors();
                let seen = outer.mask != 0 && inner.mask != 0;
                let mesh = inner.object.geometry();
                for triangle in 0..mesh.len() as u32 {
                    let corners = mesh.corners(triangle);
                    let placed = corners.map(|p| outer.transform.point(inner.transform.point(p)));
                    positions.extend(if seen { placed } else { [Vec3::splat(1e6); 3] });
                    sides.push(if mirrored { -1.0 } else { 1.0 });
                }
            }
        }
        let count = two.inner.instances()[0].object.geometry().len() as u32;
        let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        let flat = TriangleMesh::new(positions, triangles.collect()).expect("sound");
        let in_flat = |hits: &[Hit]| -> Vec<Hit> {
            let number = |hit: &Hit| hit.instance * count + hit.primitive;
            hits.iter().map(|hit| Hit { primitive: number(hit), ..*hit }).collect()
        };

        let (mut found, mut culled) = (0, Vec::new());
        for ray in some_rays(&two.scene.bounds(), 1000, 7) {
            let all = two.all_hits(&ray);
            oracle::check_all(&flat, &ray, &in_flat(&all), usize::MAX).expect("all hits");
            found += all.len();

            // Sides by the flattened triangles, whose corners mirroring turns around.
            two.scene.all_hits_with(&ray, QueryOptions::new().cull(Face::Front), &mut culled);
            for (hit, own) in all.iter().zip(in_flat(&all)) {
                let [a, b, c] = flat.corners(own.primitive);
                let normal = sides[own.primitive as usize] * (b - a).cross(c - a);
                let slope = normal.dot(ray.direction);
                if slope.abs() > 1e-4 * normal.length() * ray.direction.length() {
                    assert_eq!(culled.contains(hit), slope > 0.0, "{hit:?} of {ray:?}");
                }
            }
        }
        assert!(found > 2000, "only {found} hits");
    }
}

#[test]
fn the_nearest_hits_are_the_first_of_all_and_visits_end_when_told() {
    for level in SimdLevel::available() {
        let two = two_levels(mixed(8), level, 9);
        let mut hits = Vec::new();
        let (mut most, mut asked) = (0, Vec::new());
        for ray in some_rays(&two.scene.bounds(), 500, 10) {
            let all = two.all_hits(&ray);
            let order = |hit: &Hit| (hit.t, hit.instance, hit.primitive);
            assert!(all.windows(2).all(|pair| order(&pair[0]) <= order(&pair[1])), "{all:?}");
            most = most.max(all.len());
            for k in [0, 1, 2, 3, 7, 100, usize::MAX] {
                two.scene.nearest_hits(&ray, k, &mut hits);
                assert_eq!(hits, all[..k.min(all.len())], "{k}: {ray:?}");
            }
            assert_eq!(two.scene.crossings(&ray), all.len());
            for enough in [1, 2, 5] {
                let mut told = Vec::new();
                let flow = two.scene.for_each_hit(&ray, |hit| {
                    told.push(hit);
                    if told.len() < enough {
                        ControlFlow::Continue(())
                    } else {
                        ControlFlow::Break(())
                    }
                });
                assert_eq!(flow.is_break(), all.len() >= enough);
                assert_eq!(told.len(), enough.min(all.len()));
                assert!(told.iter().all(|hit| all.contains(hit)));
            }

            // A filter is asked of every hit once, as the scene tells of it.
            asked.clear();
            let refuse = |hit: &Hit| {
                asked.push(*hit);
                false
            };
            two.scene.all_hits_with(&ray, QueryOptions::new().filter(refuse), &mut hits);
            asked.sort_by(|a, b| order(a).partial_cmp(&order(b)).expect("numbers"));
            assert!(hits.is_empty() && asked == all, "{ray:?}");
        }
        assert!(most > 10, "never more than {most} hits");
    }
}

#[test]
fn closed_objects_are_crossed_an_even_number_of_times_from_outside_and_an_odd_from_inside() {
    let mut rng = Rng::new(11);
    let outer =
        Transform::rotation([1.0, -2.0, 0.5], 70.0).then(&Transform::scaling([-2.0, 1.0, 1.0]));
    let mut crossed = 0;
    for closed::Closed { name, mesh } in closed::all() {
        let size = mesh.total_bounds().diagonal();
        let center = mesh.total_bounds().center();
        let solid = Bvh::build(mesh.clone()).expect("it builds");
        let object = Arc::new(solid);
        // Where numbers are fine enough for places outside.
        for transform in nasty_transforms(&mut rng).iter().filter(|t| thickness(t) > 1e-4) {
            let alone = Tlas::build(vec![Instance::new(Arc::clone(&object), *transform)]);
            let alone = Arc::new(alone.expect("a good transform"));
            let nested = Tlas::build(vec![Instance::new(Arc::clone(&alone), outer)]).expect("good");
            for i in 0..40 {
                let [a, b, _] = mesh.corners(rng.below(mesh.len()) as u32);
                let target = [a, 0.5 * (a + b), a + rng.unit() * (b - a), center][i % 4];
                let from = transform.point(center + 3.0 * size * rng.direction());
                let ray = Ray::new(from, transform.point(target) - from);
                if !ray.is_valid() {
                    continue;
                }
                let count = alone.crossings(&ray);
                assert_eq!(count % 2, 0, "{name}: {transform:?}, {ray:?}");
                crossed += count;
                let ray = Ray::new(outer.point(ray.origin), outer.vector(ray.direction));
                let count = nested.crossings(&ray);
                assert_eq!(count % 2, 0, "{name}, nested: {transform:?}, {ray:?}");
                crossed += count;
            }
        }
    }
    assert!(crossed > 20_000, "only {crossed} crossings");

    let ball = Arc::new(Bvh::build(closed::icosphere(3, Vec3::ZERO, 1.0)).expect("it builds"));
    for transform in friendly(&mut rng) {
        let scene = Tlas::build(vec![Instance::new(Arc::clone(&ball), transform)]).expect("good");
        for i in 0..300u32 {
            let ray = Ray::new(transform.point(0.5 * rng.in_cube()), rng.direction());
            assert_eq!(scene.crossings(&ray), 1, "{i}: {transform:?}, {ray:?}");
            // The inside of what is mirrored is its back, as of everything.
            let back = scene.intersect_with(&ray, QueryOptions::new().cull(Face::Front));
            assert!(back.is_some() && back == scene.intersect(&ray));
            assert!(!scene.occluded_with(&ray, QueryOptions::new().cull(Face::Back)));
        }
    }
}

#[test]
fn options_that_ask_for_nothing_change_nothing() {
    let mut rng = Rng::new(12);
    let mesh = shapes::grid_box(2, -Vec3::ONE, Vec3::ONE);
    let mut object = Bvh::build(mesh.clone()).expect("it builds");
    for level in SimdLevel::available() {
        object.set_simd_level(level);
        let mut transforms = nasty_transforms(&mut rng);
        // Some twice, so that hits are equally near.
        transforms.extend_from_within(..6);
        let instances = grouped(&Arc::new(object.clone()), &transforms);
        let mut scene = Tlas::build(instances).expect("good transforms");
        scene.set_simd_level(level);
        let mut found = 0;
        for transform in &transforms {
            for ray in rays::against(&mesh, 150, 13) {
                let origin = transform.point(ray.origin);
                let ray = Ray { origin, direction: transform.vector(ray.direction), ..ray };
                let plain = scene.intersect(&ray);
                assert_eq!(scene.intersect_with(&ray, QueryOptions::new()), plain, "{ray:?}");
                let blocked = scene.occluded_with(&ray, QueryOptions::new());
                assert_eq!(blocked, plain.is_some(), "{ray:?}");
                let masked = scene.intersect_masked(&ray, 2);
                assert_eq!(scene.intersect_with(&ray, QueryOptions::new().mask(2)), masked);
                found += usize::from(plain.is_some());
            }
        }
        assert!(found > 1000, "only {found} hits");
    }
}

#[test]
fn batches_answer_as_single_rays_do() {
    let two = two_levels(mixed(14), SimdLevel::active(), 15);
    let rays = some_rays(&two.scene.bounds(), 1200, 16);
    let (all, nearest) = (two.scene.all_hits_batch(&rays), two.scene.nearest_hits_batch(&rays, 3));
    for (number, ray) in rays.iter().enumerate() {
        let expected = two.all_hits(ray);
        assert_eq!(all.of(number), expected);
        assert_eq!(nearest.of(number), &expected[..expected.len().min(3)]);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("a pool");
    assert_eq!(pool.install(|| two.scene.all_hits_batch(&rays)), all);
}

#[test]
fn panics_in_closures_pass_through_and_bad_rays_find_nothing() {
    let two = two_levels(mixed(17), SimdLevel::active(), 18);
    let scene = &two.scene;
    let ray = some_rays(&scene.bounds(), 100, 19)
        .into_iter()
        .max_by_key(|ray| scene.crossings(ray))
        .expect("there are rays");
    let before = two.all_hits(&ray);
    let refuse = |_: &Hit| -> bool { panic!("at once") };
    let closest =
        AssertUnwindSafe(|| scene.intersect_with(&ray, QueryOptions::new().filter(refuse)));
    assert!(catch_unwind(closest).is_err());
    let all = AssertUnwindSafe(|| scene.for_each_hit(&ray, |_| panic!("at once")));
    assert!(catch_unwind(all).is_err());
    assert_eq!(two.all_hits(&ray), before);

    let empty = Tlas::<Bvh<TriangleMesh>>::build(vec![]).expect("legal");
    assert_eq!(empty.crossings(&ray), 0);
    let bad = [
        Ray::new([f32::NAN, 0.0, 0.0], [0.0, 0.0, 1.0]),
        Ray::new([0.0; 3], [0.0; 3]),
        ray.with_interval(0.0, f32::NAN),
    ];
    let mut hits = before;
    for ray in bad {
        scene.nearest_hits(&ray, 5, &mut hits);
        assert!(hits.is_empty() && two.all_hits(&ray).is_empty(), "{ray:?}");
        let options = QueryOptions::new();
        assert!(
            scene.intersect_with(&ray, options).is_none() && !scene.occluded_with(&ray, options)
        );
    }
}
