//! Scenes of instances that move, come and go: whatever an update decides, the hits are those of a scene that is built anew.

use std::sync::Arc;

use raywood::{
    BuildPreset, Bvh, Decision, Instance, InstanceError, Ray, SimdLevel, Tlas, Transform,
    TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, shapes};

type Scene = Tlas<Bvh<TriangleMesh>>;

/// A box of two to a side.
fn object() -> Arc<Bvh<TriangleMesh>> {
    let mesh = shapes::grid_box(1, Vec3::splat(-1.0), Vec3::ONE);
    Arc::new(Bvh::build(mesh).expect("it builds"))
}

/// A lattice of so many boxes to a side, turned.
fn lattice(side: usize) -> Scene {
    let object = object();
    let at = |number: usize| {
        let [x, y, z] = [number % side, number / side % side, number / side / side];
        let place = 5.0 * Vec3::new(x as f32, y as f32, z as f32);
        let transform = Transform::rotation([1.0, 2.0, 3.0], number as f32);
        let transform = transform.then(&Transform::translation(place));
        Instance { id: number as u32, ..Instance::new(Arc::clone(&object), transform) }
    };
    Tlas::build((0..side * side * side).map(at).collect()).expect("good transforms")
}

/// Rays into a scene, through it.
fn rays(scene: &Scene, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let (center, size) = (scene.bounds().center(), scene.bounds().extent());
    let mut point = |reach: f32| center + reach * size * rng.in_cube();
    (0..count).map(|_| Ray::between(point(1.0), point(0.6))).collect()
}

/// That hits are those of a scene that is built of the same instances; how many there are.
fn check(scene: &Scene, name: &str) -> usize {
    let fresh = Tlas::build(scene.instances().to_vec()).expect("good transforms");
    assert!(fresh.bounds() == scene.bounds(), "{name}");
    let rays = rays(scene, 1500, 3);
    let mut hits = 0;
    for ray in &rays {
        let hit = scene.intersect(ray);
        assert_eq!(hit, fresh.intersect(ray), "{name}: {ray:?}");
        assert_eq!(scene.occluded(ray), hit.is_some(), "{name}: {ray:?}");
        hits += usize::from(hit.is_some());
    }
    hits
}

#[test]
fn what_moves_a_little_moves_boxes() {
    let mut scene = lattice(8);
    let same = scene.update(1.5).expect("nothing moved");
    assert_eq!((same.decision, same.cost), (Decision::Refitted, same.built_cost));
    let mut rng = Rng::new(1);
    for step in 0..10 {
        for instance in scene.instances_mut() {
            let moved = Transform::translation(0.3 * rng.in_cube());
            instance.transform = instance.transform.then(&moved);
        }
        let update = scene.update(1.5).expect("good transforms");
        assert_eq!(update.decision, Decision::Refitted, "{update}");
        assert_eq!(update.built_cost, same.built_cost);
        assert!(check(&scene, &format!("step {step}")) > 200);
    }
    for &level in SimdLevel::ALL {
        scene.set_simd_level(level);
        check(&scene, level.name());
    }
}

#[test]
fn what_is_shuffled_is_built_anew() {
    let mut scene = lattice(10);
    let mut rng = Rng::new(2);
    let instances = scene.instances_mut();
    for place in (1..instances.len()).rev() {
        let other = rng.below(place + 1);
        let transform = instances[place].transform;
        instances[place].transform = instances[other].transform;
        instances[other].transform = transform;
    }
    let mut patient = scene.clone();
    let update = scene.update(1.5).expect("good transforms");
    assert_eq!(update.decision, Decision::Rebuilt, "{update}");
    assert!(update.refitted_cost > 3.0 * update.cost, "{update}");
    assert!(check(&scene, "shuffled") > 200);

    let refitted = patient.update(f64::INFINITY).expect("good transforms");
    assert_eq!(refitted.decision, Decision::Refitted);
    assert_eq!(refitted.cost, update.refitted_cost);
    assert!(check(&patient, "shuffled, with new boxes") > 200);
    assert_eq!(patient.update(1.5).expect("good transforms").decision, Decision::Rebuilt);
}

#[test]
fn instances_come_and_go() {
    let mut scene = lattice(4);
    let object = Arc::clone(&scene.instances()[0].object);
    let far = Transform::translation([100.0, 0.0, 0.0]);
    let number = scene.insert(Instance::new(Arc::clone(&object), far));
    assert_eq!(number, 64);
    let ray = Ray::new([100.0, 0.1, 50.0], [0.0, 0.0, -1.0]);
    assert!(!scene.occluded(&ray), "it counts from the next update on");
    assert_eq!(scene.update(1.5).expect("good transforms").decision, Decision::Rebuilt);
    assert_eq!(scene.intersect(&ray).map(|hit| hit.instance), Some(64));
    check(&scene, "one more");

    let removed = scene.remove(3).expect("it is there");
    assert_eq!(removed.id, 3);
    assert!(scene.remove(64).is_none() && scene.remove(usize::MAX).is_none());
    assert_eq!(scene.update(f64::INFINITY).expect("good transforms").decision, Decision::Rebuilt);
    assert_eq!(scene.intersect(&ray).map(|hit| hit.instance), Some(3), "the last took its number");
    check(&scene, "one less");

    // One in the place of another is as if it had moved.
    scene.remove(10);
    scene.insert(removed);
    assert_eq!(scene.update(f64::INFINITY).expect("good transforms").decision, Decision::Refitted);
    check(&scene, "another");

    while scene.remove(0).is_some() {}
    let update = scene.update(1.5).expect("nothing is legal");
    assert_eq!((update.decision, update.cost), (Decision::Rebuilt, 0.0));
    assert!(scene.bounds().is_empty() && !scene.occluded(&ray));
    assert_eq!(scene.update(1.5).expect("still nothing").decision, Decision::Refitted);
    scene.insert(Instance::new(object, far));
    assert_eq!(scene.update(1.5).expect("good transforms").decision, Decision::Rebuilt);
    assert!(scene.occluded(&ray));
}

#[test]
fn objects_may_become_empty_and_back() {
    let mut scene = lattice(3);
    let full = Arc::clone(&scene.instances()[5].object);
    let empty = Arc::new(Bvh::build(TriangleMesh::default()).expect("it builds"));
    for (object, number) in [(&empty, 5), (&empty, 7), (&full, 5), (&full, 7)] {
        scene.instances_mut()[number].object = Arc::clone(object);
        let update = scene.update(f64::INFINITY).expect("good transforms");
        assert_eq!(update.decision, Decision::Rebuilt);
        check(&scene, "some are empty");
    }
    // As many are empty as before, but others.
    scene.instances_mut()[5].object = Arc::clone(&empty);
    scene.update(1.5).expect("good transforms");
    scene.instances_mut()[5].object = full;
    scene.instances_mut()[6].object = empty;
    assert_eq!(scene.update(f64::INFINITY).expect("good").decision, Decision::Rebuilt);
    check(&scene, "others are empty");
}

#[test]
fn what_cannot_be_placed_changes_nothing() {
    let mut scene = lattice(4);
    let before = scene.clone();
    let good = scene.instances().to_vec();
    let huge = Transform::translation([3e38, 0.0, 0.0]);
    for (number, transform, expected) in [
        (7, Transform::scaling([1.0, 0.0, 1.0]), "the transform of instance 7 flattens space"),
        (0, Transform::translation([f32::NAN, 0.0, 0.0]), "of instance 0 has a coefficient"),
        (63, Transform::scaling([3e38; 3]).then(&huge), "instance 63 has the bounds"),
    ] {
        // Everything else moves; of several the first is told of.
        for instance in scene.instances_mut() {
            instance.transform = instance.transform.then(&Transform::scaling([2.0; 3]));
        }
        scene.set_transform(number, transform);
        scene.set_transform(63, transform);
        for error in [scene.update(1.5).expect_err(expected), scene.rebuild().expect_err(expected)]
        {
            assert!(error.to_string().contains(expected), "{error}");
            let is_right = match error {
                InstanceError::BadTransform { instance, .. } => instance == number,
                InstanceError::BadBounds { instance, .. } => instance == number,
                _ => false,
            };
            assert!(is_right, "{error:?}");
        }
        assert!(scene.bounds() == before.bounds());
        for ray in rays(&before, 500, 1) {
            assert_eq!(scene.intersect(&ray), before.intersect(&ray));
        }
        *scene.instances_mut() = good.clone();
    }
    assert_eq!(scene.update(1.5).expect("all is as it was").decision, Decision::Refitted);
}

#[test]
fn threads_decide_nothing() {
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut scene = lattice(17);
            let mut updates = Vec::new();
            for degrees in [0.001, 1.0] {
                for (number, instance) in scene.instances_mut().iter_mut().enumerate() {
                    // Each by another angle, so that those far from the axis come among each other.
                    let turned = Transform::rotation([0.0, 0.3, 1.0], degrees * number as f32);
                    instance.transform = instance.transform.then(&turned);
                }
                let update = scene.update(1.5).expect("good transforms");
                let hits: Vec<_> =
                    rays(&scene, 300, 5).iter().map(|r| scene.intersect(r)).collect();
                updates.push((update, hits));
            }
            updates
        })
    };
    let one = of(1);
    let decisions: Vec<_> = one.iter().map(|(update, _)| update.decision).collect();
    assert_eq!(decisions, [Decision::Refitted, Decision::Rebuilt]);
    for threads in [2, 3] {
        assert_eq!(one, of(threads));
    }
}

#[test]
fn every_preset_takes_changes_on() {
    let mut rng = Rng::new(8);
    for preset in BuildPreset::ALL {
        let instances = lattice(6).instances().to_vec();
        let mut scene = Tlas::build_with(instances, &preset.options()).expect("good transforms");
        for step in 0..6 {
            for _ in 0..40 {
                let number = rng.below(scene.instances().len());
                let place = Transform::translation(30.0 * rng.unit() * rng.in_cube());
                scene.set_transform(number, place);
            }
            if step % 3 == 2 {
                let copy = scene.instances()[step].clone();
                scene.insert(copy);
            }
            scene.update(1.2).expect("good transforms");
            check(&scene, preset.name());
        }
    }
}
