//! Analytic spheres, alone and together with triangles.

use raywood::{
    Aabb, BuildPreset, Bvh, Geometry, Joined, Ray, Spheres, Structure, StructureKind, Vec3,
};
use raywood_testkit::{Rng, shapes};

#[test]
fn hits_from_outside_and_inside() {
    let spheres = Spheres::new(vec![(Vec3::new(0.0, 0.0, 5.0), 2.0)]).expect("a sphere");
    let bvh = Bvh::build(&spheres).expect("it builds");
    let t = |origin: [f32; 3], direction: [f32; 3]| {
        bvh.intersect(&Ray::new(origin, direction)).map(|hit| hit.t)
    };
    assert_eq!(t([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]), Some(3.0));
    assert_eq!(t([0.0, 0.0, 5.0], [0.0, 0.0, 2.0]), Some(1.0));
    assert_eq!(t([0.0, 0.0, 8.0], [0.0, 0.0, 1.0]), None);
    assert_eq!(t([3.0, 0.0, 0.0], [0.0, 0.0, 1.0]), None);
    let ray = Ray::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    assert!(bvh.occluded(&ray.with_interval(0.0, 3.5)));
    assert!(!bvh.occluded(&ray.with_interval(3.5, 6.5)));
}

#[test]
fn small_spheres_far_away_stay_round() {
    let mut rng = Rng::new(4);
    for distance in [1.0f32, 1e3, 1e6] {
        let center = distance * rng.direction();
        let radius = 1e-4 * distance;
        let spheres = Spheres::new(vec![(center, radius)]).expect("a sphere");
        let bvh = Bvh::build(&spheres).expect("it builds");
        for _ in 0..2000 {
            let (s, t) = (center / center.length()).orthonormal_basis();
            let (x, y) = (rng.range(-2.0, 2.0), rng.range(-2.0, 2.0));
            let distance_from_axis = (x * x + y * y).sqrt();
            if (distance_from_axis - 1.0).abs() < 0.01 {
                continue;
            }
            let ray = Ray::new(Vec3::ZERO, center + radius * (x * s + y * t));
            assert_eq!(bvh.occluded(&ray), distance_from_axis < 1.0, "{ray:?}");
        }
    }
}

#[test]
fn spawned_rays_leave_their_sphere() {
    let mut rng = Rng::new(5);
    for exponent in -6..=9 {
        let scale = 10f32.powi(exponent);
        for offset in [0.0, 10.0, 1e3] {
            let center = offset * scale * rng.direction();
            let spheres = Spheres::new(vec![(center, scale)]).expect("a sphere");
            let bvh = Bvh::build(&spheres).expect("it builds");
            for _ in 0..2000 {
                let from = center + 3.0 * scale * rng.direction();
                let ray = Ray::new(from, center + 0.5 * scale * rng.in_cube() - from);
                let hit = bvh.intersect(&ray).expect("the middle is hit");
                let point = bvh.surface_point(&ray, &hit);
                let direction = rng.direction();
                let out = if direction.dot(point.normal) < 0.0 { -direction } else { direction };
                assert!(
                    !bvh.occluded(&point.spawn(out)),
                    "scale {scale}, offset {offset}: {point:?}"
                );
                assert!(
                    bvh.occluded(&point.spawn(-out)),
                    "scale {scale}, offset {offset}: {point:?}"
                );
            }
        }
    }
}

#[test]
fn bounds_hold_every_hit() {
    let mut rng = Rng::new(6);
    let spheres = (0..300).map(|_| (rng.in_cube(), 0.3 * rng.unit())).collect();
    let spheres = Spheres::new(spheres).expect("spheres");
    let bvh = Bvh::build(&spheres).expect("it builds");
    bvh.validate().expect("a valid tree");
    let brute_force = |ray: &Ray| {
        let mut nearest: Option<(f64, usize)> = None;
        for (number, (center, radius)) in spheres.as_slice().iter().enumerate() {
            let double = |v: Vec3| v.to_array().map(f64::from);
            let (o, d, c, r) =
                (double(ray.origin), double(ray.direction), double(*center), f64::from(*radius));
            let oc = [o[0] - c[0], o[1] - c[1], o[2] - c[2]];
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (a, b, c) = (dot(d, d), dot(oc, d), dot(oc, oc) - r * r);
            let discriminant = b * b - a * c;
            if discriminant > 0.0 {
                for t in [(-b - discriminant.sqrt()) / a, (-b + discriminant.sqrt()) / a] {
                    if t >= 0.0 && nearest.is_none_or(|(nearest, _)| t < nearest) {
                        nearest = Some((t, number));
                    }
                }
            }
        }
        nearest
    };
    let mut hits = 0;
    for _ in 0..5000 {
        let ray = Ray::new(1.5 * rng.in_cube(), rng.direction());
        let (answer, expected) = (bvh.intersect(&ray), brute_force(&ray));
        assert_eq!(
            answer.map(|hit| hit.primitive as usize),
            expected.map(|(_, number)| number),
            "{ray:?}"
        );
        if let (Some(hit), Some((t, number))) = (answer, expected) {
            assert!((f64::from(hit.t) - t).abs() < 1e-6);
            let point = bvh.surface_point(&ray, &hit);
            let (center, radius) = spheres.as_slice()[number];
            assert!(((point.position - center).length() - radius).abs() < 1e-6);
            assert!((point.normal.length() - 1.0).abs() < 1e-6);
            hits += 1;
        }
    }
    assert!(hits > 1000, "only {hits} hits");
}

#[test]
fn triangles_and_spheres_in_one_tree() {
    let mesh = shapes::grid_box(4, Vec3::splat(-1.0), Vec3::ONE);
    let spheres =
        Spheres::new(vec![(Vec3::new(3.0, 0.0, 0.0), 1.0), (Vec3::ZERO, 0.5)]).expect("spheres");
    let joined = Joined { first: &mesh, second: &spheres };
    let triangles = mesh.len() as u32;
    assert_eq!(joined.len() as u32, triangles + 2);
    let bvh = Bvh::build(joined).expect("it builds");
    bvh.validate().expect("a valid tree");
    assert!(bvh.tree().bounds().contains(&Aabb::new([-1.0; 3], [3.9, 1.0, 1.0])));

    let hit = |x: f32, direction: f32| {
        let ray = Ray::new([x, 0.1, 0.05], [direction, 0.0, 0.0]);
        bvh.intersect(&ray).map(|hit| (hit.primitive, bvh.surface_point(&ray, &hit).normal.x))
    };
    let (primitive, normal) = hit(10.0, -1.0).expect("the outer sphere");
    assert!(primitive == triangles && normal > 0.99);
    let (primitive, normal) = hit(1.5, -1.0).expect("the box");
    assert!(primitive < triangles && normal == 1.0);
    let (primitive, normal) = hit(0.9, -1.0).expect("the inner sphere");
    assert!(primitive == triangles + 1 && normal > 0.9);
}

#[test]
fn trees_of_every_preset_hold_triangles_and_spheres_alike() {
    // So close together that leaves have some of both.
    let mesh = shapes::soup(400, 0.2, 1);
    let mut rng = Rng::new(6);
    let spheres = (0..400).map(|_| (rng.in_cube(), rng.range(0.01, 0.1))).collect();
    let joined = Joined { first: mesh, second: Spheres::new(spheres).expect("spheres") };
    let brute = Structure::build(StructureKind::BruteForce, &joined, &Default::default());
    let brute = brute.expect("nothing is built");
    let rays: Vec<_> = (0..2000).map(|_| Ray::new(rng.in_cube(), rng.direction())).collect();
    for preset in BuildPreset::ALL {
        let bvh = Bvh::build_with(&joined, &preset.options()).expect("it builds");
        bvh.validate().unwrap_or_else(|error| panic!("{}: {error}", preset.name()));
        for ray in &rays {
            assert_eq!(bvh.intersect(ray), brute.intersect(ray), "{}: {ray:?}", preset.name());
        }
    }
}

#[test]
fn bad_spheres_are_refused() {
    for (center, radius) in [
        (Vec3::new(f32::NAN, 0.0, 0.0), 1.0),
        (Vec3::new(0.0, f32::INFINITY, 0.0), 1.0),
        (Vec3::ZERO, -1.0),
        (Vec3::ZERO, f32::NAN),
        (Vec3::ZERO, f32::INFINITY),
        (Vec3::splat(f32::MAX), f32::MAX),
    ] {
        let error =
            Spheres::new(vec![(Vec3::ZERO, 1.0), (center, radius)]).expect_err("it is refused");
        assert!(error.to_string().starts_with("sphere 1 at ("), "{error}");
    }
}
