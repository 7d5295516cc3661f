//! Scenes of instances answer as if everything in them were flattened, only without its memory.

use std::sync::Arc;

use raywood::{
    BuildPreset, Bvh, Geometry, Hit, Instance, InstanceError, Ray, SimdLevel, Spheres, Tlas,
    Traceable, Transform, TransformError, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, nasty, oracle, rays, shapes};

fn bvh(mesh: TriangleMesh) -> Arc<Bvh<TriangleMesh>> {
    Arc::new(Bvh::build(mesh).expect("it builds"))
}

fn scene<B: Traceable>(object: &Arc<B>, transforms: &[Transform]) -> Tlas<B> {
    let instances = transforms.iter().map(|&t| Instance::new(Arc::clone(object), t)).collect();
    Tlas::build(instances).expect("good transforms")
}

/// A rotation around a random axis.
fn turned(rng: &mut Rng) -> Transform {
    Transform::rotation(rng.direction(), rng.range(-180.0, 180.0))
}

/// Transforms of every kind that keep sizes about as they are.
pub(crate) fn friendly(rng: &mut Rng) -> Vec<Transform> {
    let moved = |t: Transform, rng: &mut Rng| t.then(&Transform::translation(3.0 * rng.in_cube()));
    let shear =
        Transform::from_rows([[1.0, 0.7, 0.0, 0.0], [0.0, 1.0, -0.4, 0.0], [0.2, 0.0, 1.0, 0.0]]);
    let kinds = [
        Transform::IDENTITY,
        turned(rng),
        Transform::scaling([2.0, 0.5, 1.0]).then(&turned(rng)),
        Transform::scaling([-1.0, 1.0, 1.0]).then(&turned(rng)),
        turned(rng).then(&Transform::scaling([1.0, -3.0, 0.7])),
        shear.then(&turned(rng)),
    ];
    kinds.map(|t| moved(t, rng)).to_vec()
}

/// Transforms that look for trouble: tiny, huge, far away, flat, all of these at once.
pub(crate) fn nasty_transforms(rng: &mut Rng) -> Vec<Transform> {
    let mut all = friendly(rng);
    for exponent in [-6, -3, 3, 6] {
        let size = 10f32.powi(exponent);
        let far = Transform::translation(1000.0 * size * rng.in_cube());
        all.push(Transform::scaling([size; 3]).then(&turned(rng)));
        all.push(Transform::scaling([-size, size, size]).then(&turned(rng)).then(&far));
        all.push(Transform::scaling([size, 1.0, 1.0]).then(&far));
        all.push(Transform::scaling([1.0, size, 1.0 / size]));
    }
    for steep in [10.0, 1e3] {
        let shear = Transform::from_rows([
            [1.0, steep, 0.0, 5.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]);
        all.push(shear.then(&turned(rng)));
        all.push(turned(rng).then(&Transform::scaling([1.0, 1.0, 1.0 / steep])).then(&turned(rng)));
    }
    all
}

/// The mesh where a transform takes it.
fn flattened(mesh: &TriangleMesh, transform: &Transform) -> TriangleMesh {
    shapes::mapped(mesh, |p| transform.point(p))
}

#[test]
fn an_instance_in_its_place_is_the_object_to_the_bit() {
    for entry in nasty::all() {
        let object = bvh(entry.mesh);
        let scene = scene(&object, &[Transform::IDENTITY]);
        for ray in rays::against(object.geometry(), 1000, 1) {
            assert_eq!(scene.intersect(&ray), object.intersect(&ray), "{}: {ray:?}", entry.name);
            assert_eq!(scene.occluded(&ray), object.occluded(&ray), "{}: {ray:?}", entry.name);
        }
    }
}

#[test]
fn an_instance_is_hit_as_the_flattened_mesh() {
    let mut rng = Rng::new(1);
    for mesh in [
        shapes::soup(60, 0.4, 3),
        shapes::uv_sphere(6, Vec3::splat(0.2), 1.0),
        shapes::grid_box(2, -Vec3::ONE, Vec3::ONE),
    ] {
        let object = bvh(mesh);
        for transform in friendly(&mut rng) {
            let scene = scene(&object, &[transform]);
            let flat = flattened(object.geometry(), &transform);
            let mut hits = 0;
            for ray in rays::against(&flat, 600, 2) {
                let hit = scene.intersect(&ray);
                oracle::check_closest(&flat, &ray, hit)
                    .unwrap_or_else(|e| panic!("{transform:?}: {e}"));
                oracle::check_occluded(&flat, &ray, scene.occluded(&ray))
                    .unwrap_or_else(|e| panic!("{transform:?}: {e}"));
                hits += u32::from(hit.is_some());
            }
            assert!(hits > 100, "only {hits} hits");
        }
    }
}

/// What the scene of all instances must answer, from scenes of one instance each.
fn best_of_each(scenes: &[Tlas<Bvh<TriangleMesh>>], ray: &Ray) -> Option<Hit> {
    let hits = scenes
        .iter()
        .zip(0..)
        .filter_map(|(scene, instance)| scene.intersect(ray).map(|hit| Hit { instance, ..hit }));
    hits.min_by(|a, b| (a.t, a.instance).partial_cmp(&(b.t, b.instance)).expect("numbers"))
}

#[test]
fn a_scene_is_the_nearest_of_its_instances_on_every_level() {
    let mut rng = Rng::new(2);
    for entry in nasty::all() {
        let mut object = Bvh::build(entry.mesh).expect("it builds");
        let mut transforms = nasty_transforms(&mut rng);
        // Some twice, so that hits are equally near.
        transforms.extend_from_within(..6);
        let mut targets: Vec<Ray> = Vec::new();
        for transform in &transforms {
            for ray in rays::against(object.geometry(), 40, rng.bits()) {
                let (origin, direction) =
                    (transform.point(ray.origin), transform.vector(ray.direction));
                targets.push(Ray { origin, direction, ..ray });
            }
        }
        let mut ties = 0;
        for level in SimdLevel::available() {
            object.set_simd_level(level);
            let shared = Arc::new(object.clone());
            let each: Vec<_> = transforms.iter().map(|&t| scene(&shared, &[t])).collect();
            let mut all = scene(&shared, &transforms);
            all.set_simd_level(level);
            for ray in &targets {
                let hit = all.intersect(ray);
                assert_eq!(hit, best_of_each(&each, ray), "{} {level:?}: {ray:?}", entry.name);
                assert_eq!(all.occluded(ray), hit.is_some(), "{} {level:?}: {ray:?}", entry.name);
                ties += usize::from(hit.is_some_and(|hit| hit.instance < 6));
            }
        }
        assert!(
            ties > 0 || object.geometry().len() < 100,
            "{}: no hit of what is there twice",
            entry.name
        );
    }
}

/// How thick the cube from -1 to 1 is where a transform takes it, in terms of how far it reaches from zero.
pub(crate) fn thickness(transform: &Transform) -> f64 {
    let rows = transform.rows().map(|row| row.map(f64::from));
    let column = |j: usize| rows.map(|row| row[j]);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let height = |j: usize| {
        let normal = cross(column((j + 1) % 3), column((j + 2) % 3));
        dot(normal, column(j)).abs() / dot(normal, normal).sqrt()
    };
    let reach = rows.as_flattened().iter().fold(0.0, |reach: f64, number| reach.max(number.abs()));
    height(0).min(height(1)).min(height(2)) / reach
}

#[test]
fn no_ray_leaks_from_inside_of_an_instance() {
    let mut rng = Rng::new(3);
    for mesh in [shapes::uv_sphere(10, Vec3::ZERO, 1.0), shapes::grid_box(3, -Vec3::ONE, Vec3::ONE)]
    {
        let object = bvh(mesh);
        for transform in nasty_transforms(&mut rng) {
            let alone = scene(&object, &[transform]);
            // The same within another, turned, where numbers are fine enough for places inside.
            let is_thick = thickness(&transform) > 1e-4;
            let outer = Transform::rotation([1.0, 2.0, 3.0], 33.0)
                .then(&Transform::scaling([3.0, 1.0, 0.2]));
            let nested = scene(&Arc::new(alone.clone()), &[outer]);
            for number in 0..3000 {
                let from = 0.5 * rng.in_cube();
                let positions = object.geometry().positions();
                let target = positions[rng.below(positions.len())];
                let other = positions[rng.below(positions.len())];
                let direction = match number % 3 {
                    0 => rng.direction(),
                    1 => target - from,
                    _ => 0.5 * (target + other) - from,
                };
                let ray = Ray::new(transform.point(from), transform.vector(direction));
                assert!(alone.intersect(&ray).is_some(), "{transform:?}: {ray:?} leaks");
                assert!(alone.occluded(&ray), "{transform:?}: {ray:?} is not blocked");
                if !is_thick {
                    continue;
                }
                let ray = Ray::new(outer.point(ray.origin), outer.vector(ray.direction));
                assert!(nested.intersect(&ray).is_some(), "nested {transform:?}: {ray:?} leaks");
                assert!(nested.occluded(&ray), "nested {transform:?}: {ray:?} is not blocked");
            }
        }
    }
}

#[test]
fn flat_things_far_away_are_met_by_rays_that_aim_at_them() {
    // The boxes of these have no thickness to spare: whatever is forgotten in them shows.
    let mut rng = Rng::new(4);
    let square =
        shapes::mapped(&shapes::grid_box(1, -Vec3::ONE, Vec3::ONE), |p| Vec3::new(p.x, p.y, 0.0));
    let object = bvh(square);
    for _ in 0..300 {
        let place = Transform::translation(10f32.powf(rng.range(0.0, 5.0)) * rng.in_cube());
        let transform = match rng.below(3) {
            0 => Transform::rotation([0.0, 0.0, 1.0], rng.range(0.0, 90.0)),
            1 => Transform::scaling([rng.range(0.1, 10.0), 1.0, 1.0]),
            _ => turned(&mut rng),
        };
        let transform = transform.then(&place);
        let scene = scene(&object, &[transform]);
        for _ in 0..50 {
            // Along the plane nearly, from near and far: what is certain is that the middle is met.
            let height = 10f32.powf(rng.range(-1.0, 1.0));
            let across = 10f32.powf(rng.range(0.0, 3.0)) * height;
            let from =
                Vec3::new(across * rng.range(-1.0, 1.0), across * rng.range(-1.0, 1.0), height);
            let from = transform.point(from);
            let ray = Ray::new(
                from,
                transform.point(0.1 * Vec3::new(rng.unit(), rng.unit(), 0.0)) - from,
            );
            if ray.origin.abs().max_element() * 1e-5 > 0.1 {
                continue;
            }
            assert!(scene.intersect(&ray).is_some(), "{transform:?}: {ray:?}");
        }
    }
}

#[test]
fn spawned_rays_leave_the_surfaces_of_instances() {
    let mut rng = Rng::new(5);
    let mut spawned = 0;
    for exponent in -6..=9 {
        let scale = 10f32.powi(exponent);
        for offset in [Vec3::ZERO, Vec3::new(0.3, 7.0, -2.0), Vec3::new(1000.0, 10.0, -700.0)] {
            for (mesh, inner_offset) in [
                (shapes::grid_box(3, -Vec3::ONE, Vec3::ONE), Vec3::ZERO),
                (shapes::uv_sphere(24, Vec3::ZERO, 1.0), Vec3::ZERO),
                (shapes::grid_box(1, Vec3::splat(99.0), Vec3::splat(101.0)), Vec3::splat(100.0)),
            ] {
                let object = bvh(mesh);
                let shapes = [
                    turned(&mut rng),
                    Transform::scaling([-1.0, 0.1, 3.0]).then(&turned(&mut rng)),
                    Transform::from_rows([
                        [1.0, 2.0, 0.0, 0.0],
                        [0.0, 1.0, 0.0, 0.0],
                        [0.0, 0.5, 1.0, 0.0],
                    ]),
                ];
                for shape in shapes {
                    let transform = Transform::translation(-inner_offset)
                        .then(&shape)
                        .then(&Transform::scaling([scale; 3]))
                        .then(&Transform::translation(scale * offset));
                    let alone = scene(&object, &[transform]);
                    let outer = turned(&mut rng).then(&Transform::scaling([1.0, 2.0, -1.0]));
                    let nested = scene(&Arc::new(alone.clone()), &[outer]);
                    let whole = transform.then(&outer);
                    for _ in 0..100 {
                        spawned += leaves(&alone, &transform, inner_offset, scale, &mut rng);
                        spawned += leaves(&nested, &whole, inner_offset, scale, &mut rng);
                    }
                }
            }
        }
    }
    assert!(spawned > 60_000, "only {spawned} rays");
}

/// Sends a ray into a convex instance and others on from where it hits; how many.
fn leaves<B: Traceable>(
    scene: &Tlas<B>,
    transform: &Transform,
    center: Vec3,
    scale: f32,
    rng: &mut Rng,
) -> usize {
    let target = transform.point(center + 0.5 * rng.in_cube());
    let from = transform.point(center + 4.0 * rng.direction());
    let ray = Ray::new(from, target - from);
    let hit = scene.intersect(&ray).expect("the inside is met");
    let point = scene.surface_point(&ray, &hit);
    assert!((point.normal.length() - 1.0).abs() < 1e-5);
    // Mirrored or not, normals point outwards.
    assert!(
        point.normal.dot(ray.direction) < 1e-3 * ray.direction.length(),
        "scale {scale}: {point:?}"
    );

    let direction = rng.direction();
    let out = if direction.dot(point.normal) < 0.0 { -direction } else { direction };
    let away = point.spawn(out);
    assert!(!scene.occluded(&away), "scale {scale}: {away:?} hits {:?}", scene.intersect(&away));
    let light = point.position + 3.0 * scale * out;
    assert!(!scene.occluded(&point.spawn_towards(light)), "scale {scale}: no light at {point:?}");
    let inside = transform.point(center + 0.5 * rng.in_cube());
    let inwards = point.spawn(inside - point.position);
    assert!(scene.occluded(&inwards), "scale {scale}: {inwards:?} leaks");
    3
}

#[test]
fn points_lie_where_rays_hit() {
    let mut rng = Rng::new(6);
    let object = Arc::new(
        Bvh::build(Spheres::new(vec![(Vec3::X, 1.0)]).expect("a sphere")).expect("it builds"),
    );
    for transform in friendly(&mut rng) {
        let scene = scene(&object, &[transform]);
        for _ in 0..200 {
            let target = transform.point(Vec3::X + 0.5 * rng.in_cube());
            let from = transform.point(5.0 * rng.direction());
            let ray = Ray::new(from, target - from);
            let hit = scene.intersect(&ray).expect("it hits");
            let point = scene.surface_point(&ray, &hit);
            assert!((point.position - ray.at(hit.t)).length() < 1e-4, "{point:?}");
            // An ellipsoid is convex, and smooth: beside the point it lies behind the normal.
            assert!(point.normal.dot(transform.point(Vec3::X) - point.position) < 0.0);
            let (s, _) = point.normal.orthonormal_basis();
            let beside = Ray::new(point.position + 1e-2 * point.normal + 1e-3 * s, -point.normal);
            assert!(scene.occluded(&beside));
        }
    }
}

#[test]
fn instances_are_numbered_through_all_levels() {
    let object = bvh(shapes::grid_box(1, -Vec3::ONE, Vec3::ONE));
    let row = |count: usize| {
        let transforms: Vec<_> =
            (0..count).map(|i| Transform::translation([4.0 * i as f32, 0.0, 0.0])).collect();
        Arc::new(scene(&object, &transforms))
    };
    let at = |row: &Arc<_>, y: f32| {
        Instance::new(Arc::clone(row), Transform::translation([0.0, y, 0.0]))
    };
    let (three, none, two) = (row(3), row(0), row(2));
    let scene = Tlas::build(vec![at(&three, 0.0), at(&none, 4.0), at(&two, 8.0), at(&three, 12.0)])
        .expect("it builds");
    assert_eq!(scene.instances().len(), 4);
    let mut expected = 0;
    for (index, (count, y)) in [(3, 0.0), (0, 4.0), (2, 8.0), (3, 12.0)].into_iter().enumerate() {
        for inner in 0..count {
            let hit = scene
                .intersect(&Ray::new([4.0 * inner as f32, y, 9.0], [0.1, 0.1, -9.0]))
                .expect("it hits");
            assert_eq!(hit.instance, expected);
            assert_eq!(scene.locate(hit.instance), (index, inner));
            expected += 1;
        }
    }
}

#[test]
fn masks_hide_instances_on_every_level() {
    let object = bvh(shapes::grid_box(1, -Vec3::ONE, Vec3::ONE));
    let at = |z: f32, mask: u32| Instance {
        mask,
        id: z as u32,
        ..Instance::new(Arc::clone(&object), Transform::translation([0.0, 0.0, z]))
    };
    let inner = Arc::new(
        Tlas::build(vec![at(0.0, 1), at(4.0, 2), at(8.0, 0), at(12.0, 6)]).expect("it builds"),
    );
    let outer = Tlas::build(vec![Instance {
        mask: 3,
        ..Instance::new(Arc::clone(&inner), Transform::IDENTITY)
    }])
    .expect("it builds");
    let ray = Ray::new([0.1, 0.2, -5.0], [0.0, 0.0, 1.0]);
    for (mask, seen, seen_by_outer) in [
        (1, Some(0), Some(0)),
        (2, Some(1), Some(1)),
        (4, Some(3), None),
        (6, Some(1), Some(1)),
        (8, None, None),
        (0, None, None),
        (u32::MAX, Some(0), Some(0)),
    ] {
        let number = |hit: Option<Hit>| hit.map(|hit| hit.instance);
        assert_eq!(number(inner.intersect_masked(&ray, mask)), seen);
        assert_eq!(inner.occluded_masked(&ray, mask), seen.is_some());
        assert_eq!(number(outer.intersect_masked(&ray, mask)), seen_by_outer);
        assert_eq!(outer.occluded_masked(&ray, mask), seen_by_outer.is_some());
        let (mut hits, mut blocked) = (vec![None; 5], vec![false; 5]);
        inner.intersect_batch_masked(&[ray; 5], mask, &mut hits);
        inner.occluded_batch_masked(&[ray; 5], mask, &mut blocked);
        assert!(
            hits.iter().all(|hit| number(*hit) == seen)
                && blocked.iter().all(|&b| b == seen.is_some())
        );
    }
    assert_eq!(inner.instances()[3].id, 12);
}

#[test]
fn distances_are_those_of_the_scene_whatever_the_scale() {
    let object = bvh(shapes::grid_box(2, -Vec3::ONE, Vec3::ONE));
    for scale in [1e-6, 1.0, 1e6] {
        let scene = scene(&object, &[Transform::scaling([scale; 3])]);
        for length in [1e-30, 1e-6, 1.0, 1e6, 1e30] {
            let expected = f64::from(4.0 * scale) / f64::from(length);
            if !(1e-37..1e37).contains(&expected) {
                continue;
            }
            let ray = Ray::new([0.3 * scale, 0.2 * scale, 5.0 * scale], [0.0, 0.0, -length]);
            let hit = scene
                .intersect(&ray)
                .unwrap_or_else(|| panic!("scale {scale}, length {length}: a miss"));
            assert!(
                (f64::from(hit.t) - expected).abs() <= 1e-6 * expected,
                "{} instead of {expected}",
                hit.t
            );
            let (near, far) = ((0.9 * expected) as f32, (1.1 * expected) as f32);
            assert!(scene.occluded(&ray.with_interval(near, far)));
            assert!(!scene.occluded(&ray.with_interval(0.0, near)));
            let behind =
                scene.intersect(&ray.with_interval(far, f32::INFINITY)).expect("the other side");
            assert!((f64::from(behind.t) - 1.5 * expected).abs() <= 1e-6 * expected);
            let point = scene.surface_point(&ray, &hit);
            assert!((point.position.z - scale).abs() <= 1e-6 * scale, "{point:?}");
        }
    }
}

#[test]
fn intervals_hold_to_the_bit_where_distances_end() {
    let object = bvh(shapes::grid_box(2, -Vec3::ONE, Vec3::ONE));
    let cases = [
        // Usual distances, unusual lengths.
        (1e-10, 1e12),
        (1e15, 1e-10),
        // Next to the least numbers, and less.
        (1e-19, 1e19),
        (1e-20, 1e19),
        (1e-21, 1e20),
        (1e-22, 1e22),
        (1e-22, 1e23),
        // Next to the largest, the far side beyond it, both beyond.
        (1e19, 1e-18),
        (7e19, 1e-18),
        (1e20, 1e-18),
    ];
    let mut found = [0; 3];
    for (scale, length) in cases {
        let scene = scene(&object, &[Transform::scaling([scale; 3])]);
        let whole = Ray::new([0.3 * scale, 0.2 * scale, 5.0 * scale], [0.0, 0.0, -length]);
        let first_from =
            |t| scene.intersect(&whole.with_interval(t, f32::INFINITY)).map(|hit| hit.t);
        let near = first_from(0.0);
        let far = near.and_then(|near| first_from(near.next_up()));
        let sides: Vec<f32> = near.into_iter().chain(far).collect();
        found[sides.len()] += 1;
        for (side, distance) in sides.iter().zip([4.0, 6.0]) {
            let expected = distance * f64::from(scale) / f64::from(length);
            let error = 1e-6 * expected + f64::from(f32::from_bits(1));
            assert!((f64::from(*side) - expected).abs() <= error, "{scale}, {length}: {side}");
        }

        let mut ends = vec![-1.0, -0.0, 0.0, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY];
        ends.extend(sides.iter().flat_map(|t| [t.next_down(), *t, t.next_up(), 1.25 * t]));
        for &t_min in &ends {
            for &t_max in &ends {
                let ray = whole.with_interval(t_min, t_max);
                let (hit, occluded) = (scene.intersect(&ray), scene.occluded(&ray));
                let what =
                    format!("scale {scale}, length {length}, {t_min} to {t_max} of {sides:?}");
                assert_eq!(hit.is_some(), occluded, "{what}");
                assert!(hit.is_none_or(|hit| t_min <= hit.t && hit.t < t_max), "{what}: {hit:?}");
                // Hits next to an end of the interval may lie on either side of it by the object's own rounding; but not by that of tiny distances.
                let at_end = |t: f32, end: f32| t > 1e-40 && (end - t).abs() <= 1e-6 * t;
                if !sides.iter().any(|t| at_end(*t, t_min) || at_end(*t, t_max)) {
                    let expected = sides.iter().copied().find(|t| t_min <= *t && *t < t_max);
                    assert_eq!(hit.map(|hit| hit.t), expected, "{what}");
                }
            }
        }
    }
    assert_eq!(found, [1, 1, 8], "scenes of which none, one and both sides are hit");
}

#[test]
fn what_moves_counts_from_the_next_rebuild_on() {
    let mut rng = Rng::new(7);
    let object = bvh(shapes::uv_sphere(8, Vec3::ZERO, 1.0));
    let places = |rng: &mut Rng| -> Vec<_> {
        (0..500).map(|_| Transform::translation(30.0 * rng.in_cube())).collect()
    };
    let mut moving = scene(&object, &places(&mut rng));
    let rays: Vec<_> = (0..500).map(|_| Ray::new(30.0 * rng.in_cube(), rng.direction())).collect();
    let answers =
        |scene: &Tlas| -> Vec<_> { rays.iter().map(|ray| scene.intersect(ray)).collect() };
    for _ in 0..3 {
        let (before, next) = (answers(&moving), places(&mut rng));
        next.iter().enumerate().for_each(|(i, &t)| moving.set_transform(i, t));
        assert_eq!(answers(&moving), before);
        moving.rebuild().expect("good transforms");
        let fresh = scene(&object, &next);
        assert_eq!(answers(&moving), answers(&fresh));
        assert_ne!(answers(&moving), before);

        // What cannot be built leaves everything as it was.
        moving.set_transform(77, Transform::scaling([1.0, 0.0, 1.0]));
        let error = moving.rebuild().expect_err("flat");
        assert_eq!(
            error,
            InstanceError::BadTransform { instance: 77, error: TransformError::Singular }
        );
        assert_eq!(answers(&moving), answers(&fresh));
    }
}

#[test]
fn builds_and_batches_give_the_same_hits() {
    let mut rng = Rng::new(8);
    let object = bvh(shapes::soup(200, 0.3, 1));
    let instances: Vec<_> = (0..300)
        .map(|_| {
            let place = Transform::translation(20.0 * rng.in_cube());
            Instance::new(Arc::clone(&object), turned(&mut rng).then(&place))
        })
        .collect();
    let rays: Vec<_> = (0..3000).map(|_| Ray::new(20.0 * rng.in_cube(), rng.direction())).collect();
    let reference = Tlas::build(instances.clone()).expect("it builds");
    let expected: Vec<_> = rays.iter().map(|ray| reference.intersect(ray)).collect();
    assert!(expected.iter().flatten().count() > 500);
    for &preset in BuildPreset::ALL {
        let scene = Tlas::build_with(instances.clone(), &preset.options()).expect("it builds");
        let mut hits = vec![None; rays.len()];
        scene.intersect_batch(&rays, &mut hits);
        for ((ray, hit), expected) in rays.iter().zip(&hits).zip(&expected) {
            assert_eq!(scene.intersect(ray), *expected, "{preset:?}");
            match (hit, expected) {
                (Some(hit), Some(expected)) => {
                    assert!(hit.agrees_with(expected), "{hit:?} {expected:?}");
                }
                _ => assert_eq!(hit, expected, "{ray:?}"),
            }
        }
        let mut blocked = vec![false; rays.len()];
        scene.occluded_batch(&rays, &mut blocked);
        assert!(blocked.iter().zip(&expected).all(|(&blocked, hit)| blocked == hit.is_some()));
    }
}

#[test]
fn bad_instances_are_refused_by_number() {
    let object = bvh(shapes::grid_box(1, -Vec3::ONE, Vec3::ONE));
    let refused = |transform: Transform| {
        let good = Instance::new(Arc::clone(&object), Transform::IDENTITY);
        let bad = Instance::new(Arc::clone(&object), transform);
        Tlas::build(vec![good.clone(), good, bad.clone(), bad]).expect_err("a bad transform")
    };
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in 0..12 {
            let mut rows = *Transform::IDENTITY.rows();
            rows[place / 4][place % 4] = value;
            let error = refused(Transform::from_rows(rows));
            assert_eq!(
                error,
                InstanceError::BadTransform { instance: 2, error: TransformError::NotFinite }
            );
            assert!(error.to_string().contains("instance 2"), "{error}");
        }
    }
    let flat = [
        Transform::scaling([0.0; 3]),
        Transform::scaling([1.0, 0.0, 1.0]),
        Transform::from_rows([[1.0, 2.0, 3.0, 0.0], [2.0, 4.0, 6.0, 0.0], [0.0, 0.0, 1.0, 0.0]]),
        // Flat but for the last digits.
        Transform::rotation([1.0, 2.0, 3.0], 40.0)
            .then(&Transform::scaling([1.0, 1.0, 1e-9]))
            .then(&Transform::rotation([3.0, -1.0, 0.5], 70.0)),
    ];
    for transform in flat {
        assert_eq!(
            refused(transform),
            InstanceError::BadTransform { instance: 2, error: TransformError::Singular }
        );
    }
    let error =
        refused(Transform::scaling([3e38; 3]).then(&Transform::translation([3e38, 0.0, 0.0])));
    assert!(matches!(error, InstanceError::BadBounds { instance: 2, .. }), "{error}");
}

#[test]
fn scenes_may_be_empty_and_rays_broken() {
    let empty = Tlas::<Bvh<TriangleMesh>>::build(vec![]).expect("legal");
    let ray = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
    assert!(empty.intersect(&ray).is_none() && !empty.occluded(&ray) && empty.bounds().is_empty());
    let nothing = bvh(TriangleMesh::new(Vec::<Vec3>::new(), vec![]).expect("legal"));
    let something = bvh(shapes::grid_box(1, -Vec3::ONE, Vec3::ONE));
    let scene = Tlas::build(vec![
        Instance::new(nothing, Transform::IDENTITY),
        Instance::new(something, Transform::IDENTITY),
    ])
    .expect("legal");
    assert_eq!(scene.intersect(&ray).map(|hit| hit.instance), Some(1));
    for value in [f32::NAN, f32::INFINITY] {
        for bad in [
            Ray::new([value, 0.0, 0.0], [0.0, 0.0, 1.0]),
            Ray::new([0.0; 3], [0.0, value, 1.0]),
            Ray::new([0.0; 3], [0.0; 3]),
            ray.with_interval(f32::NAN, value),
            ray.with_interval(1.0, 0.5),
        ] {
            assert!(scene.intersect(&bad).is_none() && !scene.occluded(&bad), "{bad:?}");
        }
    }
}
