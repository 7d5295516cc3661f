//! Scenes in which instances move: at any time the hits are those of a scene whose instances stand still where they are then.

use std::sync::Arc;

use raywood::{
    Aabb, Bvh, Decision, Hit, Instance, InstanceError, QueryOptions, Ray, SimdLevel, Tlas,
    Traceable, Transform, TransformError, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, oracle, rays, shapes};

use crate::instances::friendly;

type Object = Bvh<TriangleMesh>;

fn bvh(mesh: TriangleMesh) -> Arc<Object> {
    Arc::new(Bvh::build(mesh).expect("it builds"))
}

/// A place, and another one not far away that something may move to.
fn motions(count: usize, rng: &mut Rng) -> Vec<(Transform, Option<Transform>)> {
    let all: Vec<_> = (0..count.div_ceil(6)).flat_map(|_| friendly(rng)).collect();
    let motion = |(number, first): (usize, &Transform)| {
        let turn = Transform::rotation(rng.direction(), rng.range(-80.0, 80.0));
        let size = Transform::scaling([rng.range(0.5, 1.5), rng.range(0.5, 1.5), 1.0]);
        let later = size.then(first).then(&turn).then(&Transform::translation(2.0 * rng.in_cube()));
        // Some stand still, and what cannot move so does, too.
        let moves = number % 4 != 3 && first.check_motion(&later).is_ok();
        (*first, moves.then_some(later))
    };
    all.iter().take(count).enumerate().map(motion).collect()
}

fn scene<B: Traceable>(
    object: &Arc<B>,
    motions: &[(Transform, Option<Transform>)],
    level: SimdLevel,
) -> Tlas<B> {
    let instance = |(number, (first, later)): (usize, &(Transform, Option<Transform>))| Instance {
        later: *later,
        mask: if number % 5 == 4 { 2 } else { 1 },
        ..Instance::new(Arc::clone(object), *first)
    };
    let instances = motions.iter().enumerate().map(instance).collect();
    let mut scene = Tlas::build(instances).expect("good transforms");
    scene.set_simd_level(level);
    scene
}

/// Where everything is at a time.
fn frozen<B: Traceable>(scene: &Tlas<B>, time: f32) -> Tlas<B> {
    let still = |instance: &Instance<B>| {
        let transform = match &instance.later {
            None => instance.transform,
            Some(later) => instance.transform.blended(later, time),
        };
        Instance { transform, later: None, ..instance.clone() }
    };
    let mut frozen =
        Tlas::build(scene.instances().iter().map(still).collect()).expect("good transforms");
    frozen.set_simd_level(scene.simd_level());
    frozen
}

fn some_rays(bounds: Aabb, count: usize, rng: &mut Rng) -> Vec<Ray> {
    let (center, size) = (bounds.center(), bounds.extent());
    let mut point = |reach: f32| center + reach * size * rng.in_cube();
    (0..count).map(|_| Ray::between(point(1.0), point(0.5))).collect()
}

/// That a scene at times answers every question about rays as the one that stands still; how many rays hit.
fn check_at<B: Traceable>(scene: &Tlas<B>, still: &Tlas<B>, rays: &[Ray], time: f32) -> usize {
    let mut count = 0;
    let (mut all, mut expected_all) = (Vec::new(), Vec::new());
    for ray in rays {
        let expected = still.intersect(ray);
        let hit = scene.intersect_at(ray, time);
        assert_eq!(hit, expected, "{time}: {ray:?}");
        assert_eq!(scene.occluded_at(ray, time), expected.is_some(), "{time}: {ray:?}");
        let options = || QueryOptions::new().mask(1).at(time);
        let masked = still.intersect_masked(ray, 1);
        assert_eq!(scene.intersect_with(ray, options()), masked, "{time}: {ray:?}");
        assert_eq!(scene.occluded_with(ray, options()), masked.is_some(), "{time}: {ray:?}");
        scene.all_hits_with(ray, QueryOptions::new().at(time), &mut all);
        still.all_hits(ray, &mut expected_all);
        assert_eq!(all, expected_all, "{time}: {ray:?}");
        scene.nearest_hits_with(ray, 2, QueryOptions::new().at(time), &mut all);
        still.nearest_hits(ray, 2, &mut expected_all);
        assert_eq!(all, expected_all, "{time}: {ray:?}");
        if let Some(hit) = hit {
            let point = scene.surface_point_at(ray, &hit, time);
            assert_eq!(point, still.surface_point(ray, &hit), "{time}: {ray:?}");
            count += 1;
        }
    }
    count
}

const TIMES: [f32; 6] = [0.0, 1.0, 0.5, 0.001, 0.37, 0.9999];

#[test]
fn at_any_time_a_scene_is_the_one_that_stands_still_there() {
    let mut rng = Rng::new(1);
    for mesh in [shapes::uv_sphere(6, Vec3::splat(0.2), 1.0), shapes::soup(60, 0.4, 3)] {
        let object = bvh(mesh);
        let motions = motions(24, &mut rng);
        for level in SimdLevel::available() {
            let scene = scene(&object, &motions, level);
            assert!(scene.moves());
            let rays = some_rays(scene.bounds(), 300, &mut rng);
            for time in TIMES.into_iter().chain([rng.unit(), rng.unit()]) {
                let count = check_at(&scene, &frozen(&scene, time), &rays, time);
                assert!(count > 30, "only {count} hits");
            }
        }
    }
}

/// Against brute force over triangles that are taken to where they are.
#[test]
fn moving_instances_are_hit_as_flattened_meshes() {
    let mut rng = Rng::new(2);
    let object = bvh(shapes::grid_box(2, -Vec3::ONE, Vec3::ONE));
    for (first, later) in motions(20, &mut rng) {
        let scene = scene(&object, &[(first, later)], SimdLevel::active());
        for _ in 0..3 {
            let time = rng.unit();
            let blend = first.blended(&later.unwrap_or(first), time);
            let flat = shapes::mapped(object.geometry(), |p| blend.point(p));
            for ray in rays::against(&flat, 200, 3) {
                oracle::check_closest(&flat, &ray, scene.intersect_at(&ray, time))
                    .unwrap_or_else(|e| panic!("{first:?} {later:?} {time}: {e}"));
                oracle::check_occluded(&flat, &ray, scene.occluded_at(&ray, time))
                    .unwrap_or_else(|e| panic!("{first:?} {later:?} {time}: {e}"));
            }
        }
    }
}

#[test]
fn scenes_that_move_in_scenes_that_move() {
    let mut rng = Rng::new(3);
    let object = bvh(shapes::uv_sphere(6, Vec3::ZERO, 1.0));
    let level = SimdLevel::active();
    let inner = Arc::new(scene(&object, &motions(5, &mut rng), level));
    let outer = scene(&inner, &motions(6, &mut rng), level);
    let rays = some_rays(outer.bounds(), 400, &mut rng);
    for time in TIMES {
        let still = Arc::new(frozen(&inner, time));
        let outer_still = frozen(&outer, time);
        let instances = outer_still.instances().iter().map(|instance| Instance {
            mask: instance.mask,
            ..Instance::new(Arc::clone(&still), instance.transform)
        });
        let still = Tlas::build(instances.collect()).expect("good transforms");
        assert!(!still.moves());
        assert!(check_at(&outer, &still, &rays, time) > 30);
    }
    // What only moves below moves, too.
    let outer = Tlas::build(vec![Instance::new(inner, Transform::IDENTITY)]).expect("it builds");
    assert!(outer.moves());
    let (mut later, mut same) = (vec![None; rays.len()], vec![None; rays.len()]);
    outer.intersect_batch_at(&rays, &vec![1.0; rays.len()], &mut later);
    outer.intersect_batch(&rays, &mut same);
    assert_ne!(later, same);
}

#[test]
fn batches_at_times_answer_as_single_rays() {
    let mut rng = Rng::new(4);
    for (cells, count) in [(6, 40), (9, 2)] {
        let object = bvh(shapes::uv_sphere(cells, Vec3::ZERO, 1.0));
        let motions = motions(count, &mut rng);
        for level in SimdLevel::available() {
            let scene = scene(&object, &motions, level);
            let eye = scene.bounds().max + 2.0 * Vec3::ONE;
            // So many from one point that they go through instances together, and some that are none.
            let mut rays: Vec<_> = (0..3000)
                .map(|_| Ray::between(eye, scene.bounds().center() + rng.in_cube()))
                .collect();
            rays.extend(some_rays(scene.bounds(), 2000, &mut rng));
            for number in (0..rays.len()).step_by(97) {
                rays[number].direction.x = f32::NAN;
            }
            let times: Vec<_> = rays.iter().map(|_| rng.range(-0.2, 1.2)).collect();
            let (mut hits, mut blocked) = (vec![None; rays.len()], vec![false; rays.len()]);
            scene.intersect_batch_at(&rays, &times, &mut hits);
            scene.occluded_batch_at(&rays, &times, &mut blocked);
            let mut count = 0;
            for (number, (ray, &time)) in rays.iter().zip(&times).enumerate() {
                let (hit, expected) = (hits[number], scene.intersect_at(ray, time));
                let agrees = match (&expected, &hit) {
                    (Some(expected), Some(hit)) => hit.agrees_with(expected),
                    (None, None) => true,
                    _ => false,
                };
                assert!(agrees, "{time}: {ray:?} hits {hit:?}, alone {expected:?}");
                assert_eq!(blocked[number], expected.is_some(), "{time}: {ray:?}");
                count += usize::from(expected.is_some());
            }
            assert!(count > 500, "only {count} hits");
            let (mut serial, mut serial_blocked) = (vec![None; rays.len()], vec![true; rays.len()]);
            scene.intersect_batch_at_serial(&rays, &times, &mut serial);
            scene.occluded_batch_at_serial(&rays, &times, &mut serial_blocked);
            assert!(serial == hits && serial_blocked == blocked);
        }
    }
}

#[test]
fn without_a_time_it_is_time_zero() {
    let mut rng = Rng::new(5);
    let object = bvh(shapes::uv_sphere(6, Vec3::ZERO, 1.0));
    let scene = scene(&object, &motions(20, &mut rng), SimdLevel::active());
    let still = frozen(&scene, 0.0);
    let rays = some_rays(scene.bounds(), 1000, &mut rng);
    let (mut hits, mut expected) = (vec![None; rays.len()], vec![None; rays.len()]);
    scene.intersect_batch(&rays, &mut hits);
    still.intersect_batch(&rays, &mut expected);
    for (number, ray) in rays.iter().enumerate() {
        let hit = still.intersect(ray);
        assert_eq!(scene.intersect(ray), hit);
        assert_eq!(scene.occluded(ray), hit.is_some());
        assert_eq!(hits[number].is_some(), expected[number].is_some());
        for time in [-3.0, f32::NAN, f32::NEG_INFINITY, -0.0] {
            assert_eq!(scene.intersect_at(ray, time), hit, "{time}");
        }
        for time in [1.5, f32::INFINITY] {
            assert_eq!(scene.intersect_at(ray, time), scene.intersect_at(ray, 1.0), "{time}");
        }
        let point = ray.origin;
        assert_eq!(
            scene.closest_point(point, f32::INFINITY),
            still.closest_point(point, f32::INFINITY)
        );
    }
}

/// A ray that leaves a convex body leaves it at the time of the hit; one that goes on inside comes out once.
#[test]
fn rays_leave_moving_surfaces_without_an_epsilon() {
    let mut rng = Rng::new(6);
    let object = bvh(shapes::uv_sphere(9, Vec3::ZERO, 1.0));
    for (first, later) in motions(60, &mut rng) {
        let far = Transform::translation(1000.0 * rng.in_cube());
        let motion = (first.then(&far), later.map(|later| later.then(&far)));
        let scene = scene(&object, &[motion], SimdLevel::active());
        for ray in some_rays(scene.bounds(), 300, &mut rng) {
            let time = rng.unit();
            let Some(hit) = scene.intersect_at(&ray, time) else { continue };
            let point = scene.surface_point_at(&ray, &hit, time);
            let (normal, along) = (point.normal, ray.direction);
            let outside = along.dot(normal) < 0.0;
            let mirrored = along - 2.0 * along.dot(normal) * normal;
            let count = |direction: Vec3| {
                let (mut hits, next) = (Vec::new(), point.spawn(direction));
                scene.all_hits_with(&next, QueryOptions::new().at(time), &mut hits);
                hits.len()
            };
            assert_eq!(count(mirrored) % 2, usize::from(!outside), "{time}: {ray:?}");
            assert_eq!(count(along) % 2, usize::from(outside), "{time}: {ray:?}");
        }
    }
}

#[test]
fn boxes_hold_all_that_instances_pass_through() {
    let mut rng = Rng::new(7);
    let object = bvh(shapes::uv_sphere(6, Vec3::splat(0.3), 1.0));
    for motion in motions(60, &mut rng) {
        let bounds = scene(&object, &[motion], SimdLevel::active()).bounds();
        let (first, later) = (motion.0, motion.1.unwrap_or(motion.0));
        for step in 0..=50 {
            let blend = first.blended(&later, step as f32 / 50.0);
            for &point in object.geometry().positions() {
                let there = blend.point(point);
                assert!(bounds.min.min(there) == bounds.min && bounds.max.max(there) == bounds.max);
            }
        }
    }
}

#[test]
fn blends_are_linear_and_exact_at_both_ends() {
    let mut rng = Rng::new(8);
    for (first, later) in motions(60, &mut rng) {
        let later = later.unwrap_or(first);
        assert_eq!((first.blended(&later, 0.0), first.blended(&later, 1.0)), (first, later));
        assert_eq!(first.blended(&first, 0.3), first);
        let middle = first.blended(&later, 0.5);
        for (row, (a, b)) in middle.rows().iter().zip(first.rows().iter().zip(later.rows())) {
            for (entry, (a, b)) in row.iter().zip(a.iter().zip(b)) {
                assert_eq!(*entry, ((f64::from(*a) + f64::from(*b)) / 2.0) as f32);
            }
        }
    }
}

#[test]
fn what_cannot_move_so_is_refused() {
    let object = bvh(shapes::grid_box(1, -Vec3::ONE, Vec3::ONE));
    let turned = |degrees| Transform::rotation([0.3, 1.0, 0.2], degrees);
    let flat = Transform::scaling([1.0, 0.0, 1.0]);
    let nan = Transform::translation([f32::NAN, 0.0, 0.0]);
    for (first, later, error) in [
        (turned(0.0), turned(180.0), Some(TransformError::FlatBetween)),
        (turned(20.0), turned(200.0), Some(TransformError::FlatBetween)),
        (turned(0.0), turned(179.999), Some(TransformError::FlatBetween)),
        (turned(0.0), turned(178.0), None),
        (turned(0.0), turned(-120.0), None),
        (
            Transform::IDENTITY,
            Transform::scaling([-1.0, 1.0, 1.0]),
            Some(TransformError::FlatBetween),
        ),
        (Transform::IDENTITY, flat, Some(TransformError::Singular)),
        (flat, Transform::IDENTITY, Some(TransformError::Singular)),
        (Transform::IDENTITY, nan, Some(TransformError::NotFinite)),
        (Transform::scaling([1e-2; 3]), Transform::scaling([10.0; 3]), None),
        (
            Transform::scaling([1e-3; 3]),
            Transform::scaling([1e4; 3]),
            Some(TransformError::FlatBetween),
        ),
    ] {
        let still = Instance::new(Arc::clone(&object), Transform::IDENTITY);
        let moving = Instance::new(Arc::clone(&object), first).moving_to(later);
        let found = Tlas::build(vec![still, moving]).err();
        let expected = error.map(|error| InstanceError::BadTransform { instance: 1, error });
        assert_eq!(found, expected, "{first:?} to {later:?}");
        assert_eq!(first.check_motion(&later).err(), error);
    }
    let message = TransformError::FlatBetween.to_string();
    assert!(message.contains("half a circle"), "{message}");
    let beyond = Transform::translation([f32::MAX, 0.0, 0.0]);
    let far = Instance::new(object, Transform::IDENTITY).moving_to(beyond);
    assert!(matches!(Tlas::build(vec![far]), Err(InstanceError::BadBounds { instance: 0, .. })));
}

#[test]
fn updates_take_on_other_motions() {
    let object = bvh(shapes::grid_box(1, -Vec3::ONE, Vec3::ONE));
    let at = |x: f32| Instance::new(Arc::clone(&object), Transform::translation([x, 0.0, 0.0]));
    let mut scene = Tlas::build((0..50).map(|x| at(5.0 * x as f32)).collect()).expect("it builds");
    assert!(!scene.moves());
    let ray = Ray::new([35.0, 8.0, 9.0], [0.0, 0.0, -1.0]);
    scene.instances_mut()[7].later = Some(Transform::translation([35.0, 16.0, 0.0]));
    let update = scene.update(1e9).expect("good transforms");
    assert_eq!(update.decision, Decision::Refitted);
    assert!(scene.moves() && scene.bounds().max.y >= 17.0);
    let hit: Option<Hit> = scene.intersect_at(&ray, 0.5);
    assert_eq!(hit.map(|hit| (hit.instance, hit.t)), Some((7, 8.0)));
    assert!(!scene.occluded_at(&ray, 0.4) && !scene.occluded_at(&ray, 0.6));
    scene.instances_mut()[7].later = None;
    scene.rebuild().expect("good transforms");
    assert!(!scene.moves() && scene.bounds().max.y < 2.0);
}
