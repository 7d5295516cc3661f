//! Questions about space to scenes of instances, on several levels: moving spheres, frustums, triangles, other geometries, insides.

use std::ops::ControlFlow;
use std::sync::Arc;

use raywood::{
    Bvh, Frustum, Instance, Ray, SimdLevel, Spheres, Tlas, Transform, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, distance, shapes};

use crate::instance_space::{exact_transforms, flattened, on_lattice, overlapping, some_points};
use crate::instances::{friendly, nasty_transforms};

/// Pairs of points in and around a scene.
fn some_ways(bounds: &raywood::Aabb, count: usize, seed: u64) -> Vec<Ray> {
    let (from, to) = (some_points(bounds, count, seed), some_points(bounds, count, seed + 1));
    let ways = from.into_iter().zip(to).filter(|(from, to)| from != to);
    ways.map(|(from, to)| Ray::new(from, 0.5 * (to - from))).collect()
}

#[test]
fn moving_spheres_touch_what_they_do_in_the_flattened_scene_to_the_bit() {
    for level in SimdLevel::available() {
        let both = flattened(on_lattice(20, 21), &exact_transforms(), u32::MAX, level);
        let mut touched = 0;
        for (i, ray) in some_ways(&both.scene.bounds(), 800, 22).into_iter().enumerate() {
            let ray = ray.with_interval([0.0, -1.0][i % 2], [100.0, 2.0][i / 2 % 2]);
            let radius = [0.125, 0.0, 1.5][i % 3];
            let expected = both.flat.sphere_cast(&ray, radius).map(|hit| {
                let (instance, primitive) = both.numbers(hit.primitive);
                raywood::SphereHit { instance, primitive, ..hit }
            });
            assert_eq!(both.scene.sphere_cast(&ray, radius), expected, "{ray:?}, {radius}");
            touched += usize::from(expected.is_some());
        }
        assert!(touched > 100, "only {touched}");
    }
}

#[test]
fn moving_spheres_stay_spheres_under_any_transform() {
    let mut rng = Rng::new(23);
    let mesh = shapes::soup(40, 0.5, 24);
    let object = Arc::new(Bvh::build(mesh.clone()).expect("it builds"));
    let outer =
        Transform::rotation([1.0, 2.0, 3.0], 33.0).then(&Transform::scaling([3.0, 1.0, -0.2]));
    let mut touched = 0;
    for transform in friendly(&mut rng).into_iter().chain(nasty_transforms(&mut rng)) {
        let alone = Tlas::build(vec![Instance::new(Arc::clone(&object), transform)]);
        let alone = Arc::new(alone.expect("a good transform"));
        let nested = Tlas::build(vec![Instance::new(Arc::clone(&alone), outer)]).expect("good");
        let flat = shapes::mapped(&mesh, |p| outer.point(transform.point(p)));
        let bounds = flat.total_bounds();
        let reach = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        for ray in some_ways(&bounds, 40, rng.bits()) {
            let radius = rng.range(0.0, 0.1) * bounds.diagonal();
            let tolerance = 1e-5 * (reach + f64::from(radius + ray.origin.abs().max_element()));
            let found = nested.sphere_cast(&ray, radius);
            let gap = |t: f32| distance::to_mesh(ray.at(t), &flat) - f64::from(radius);
            let end = found.map_or(4.0, |hit| hit.t);
            for step in 0..20 {
                let t = end * step as f32 / 20.0;
                let is_free = t == end || gap(t) >= -tolerance;
                assert!(is_free, "{} at {t} before {found:?} of {ray:?}", gap(t));
            }
            if let Some(hit) = found {
                touched += 1;
                let own = distance::to_triangle(ray.at(hit.t), flat.corners(hit.primitive));
                let off = own - f64::from(radius);
                assert!(off <= tolerance && (hit.t == 0.0 || off >= -tolerance), "{off}: {hit:?}");
            }
        }
    }
    assert!(touched > 100, "only {touched}");
}

#[test]
fn what_touches_frustums_and_triangles_is_that_of_the_flattened_scene() {
    let mut rng = Rng::new(25);
    let mut found = 0;
    for level in SimdLevel::available() {
        let mut both = flattened(on_lattice(20, 26), &exact_transforms(), u32::MAX, level);
        // What nobody sees lies nearer, for planes are as exact as what is farthest lets them.
        let nearer = |p: Vec3| if p.x < 1e8 { p } else { Vec3::splat(1e3) };
        let flat = shapes::mapped(both.flat.geometry(), nearer);
        both.flat = Bvh::build(flat).expect("it builds");
        for eye in some_points(&both.scene.bounds(), 300, 27) {
            let (forwards, size) = (rng.direction(), rng.range(0.5, 4.0));
            let right = forwards.cross(rng.direction()).normalize_or_zero();
            let up = forwards.cross(right);
            let corner = |depth: f32, x: f32, y: f32| {
                eye + depth * forwards + (depth * x) * right + (depth * y) * up
            };
            let around = [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)];
            let near = around.map(|(x, y)| corner(0.25 * size, x, y));
            let far = around.map(|(x, y)| corner(2.0 * size, x, y));
            let [a, b, c, d] = near;
            let [e, f, g, h] = far;
            let frustum = Frustum::from_corners([a, b, c, d, e, f, g, h]);
            let touching = overlapping(&both.scene, &frustum);
            assert_eq!(touching, both.overlapping(&frustum), "{frustum:?}");
            found += touching.len();

            let triangle = [a, f, h];
            let touching = overlapping(&both.scene, &triangle);
            assert_eq!(touching, both.overlapping(&triangle), "{triangle:?}");
            found += touching.len();
        }
        let broken = Frustum::from_planes([[f32::NAN; 4]; 6]);
        assert!(overlapping(&both.scene, &broken).is_empty());
        assert!(overlapping(&both.scene, &[Vec3::splat(f32::INFINITY); 3]).is_empty());
    }
    assert!(found > 500, "only {found}");
}

#[test]
fn what_touches_another_geometry_is_that_of_the_flattened_scene() {
    let mut found = 0;
    for level in SimdLevel::available() {
        let both = flattened(on_lattice(20, 28), &exact_transforms(), u32::MAX, level);
        let large = shapes::mapped(&shapes::soup(60, 0.7, 29), |p| 4.0 * p);
        let other = Bvh::build(large).expect("it builds");
        let mut expected = Vec::new();
        let _ = both.flat.overlapping_pairs(&other, |own, other| {
            expected.push((both.numbers(own), other));
            ControlFlow::Continue(())
        });
        let mut pairs = Vec::new();
        let _ = both.scene.overlapping_pairs(&other, |instance, own, other| {
            pairs.push(((instance, own), other));
            ControlFlow::Continue(())
        });
        expected.sort_unstable();
        pairs.sort_unstable();
        assert_eq!(pairs, expected);
        assert!(both.scene.overlaps_any_of(&other));
        found += pairs.len();

        // Of spheres at least those that the surface passes through.
        let balls: Vec<_> = large_balls();
        let spheres = Bvh::build(Spheres::new(balls.clone()).expect("sound")).expect("it builds");
        let mut pairs = Vec::new();
        let _ = both.scene.overlapping_pairs(&spheres, |instance, own, ball| {
            pairs.push(((instance, own), ball));
            ControlFlow::Continue(())
        });
        for (number, &(center, radius)) in (0..).zip(&balls) {
            for triangle in 0..both.flat.geometry().triangles().len() as u32 {
                let corners = both.flat.geometry().corners(triangle);
                let heights = corners.map(|p| (p - center).length() - radius);
                let [a, b, c] = heights;
                let passes = a.min(b).min(c) < -1e-3 && a.max(b).max(c) > 1e-3;
                let pair = (both.numbers(triangle), number);
                assert!(!passes || pairs.contains(&pair), "{pair:?}");
            }
        }
        assert!(pairs.len() < balls.len() * both.flat.geometry().triangles().len() / 4);
    }
    assert!(found > 100, "only {found}");
}

fn large_balls() -> Vec<(Vec3, f32)> {
    let mut rng = Rng::new(30);
    (0..8).map(|_| (4.0 * rng.in_cube(), rng.range(0.5, 1.5))).collect()
}

#[test]
fn inside_is_what_is_inside_of_any_instance() {
    let mut rng = Rng::new(31);
    let mesh = shapes::uv_sphere(12, Vec3::new(0.3, 0.0, -0.2), 1.0);
    let object = Arc::new(Bvh::build(mesh.clone()).expect("it builds"));
    let mut transforms = friendly(&mut rng);
    transforms.truncate(8);
    let inner = transforms.iter().map(|&t| Instance::new(Arc::clone(&object), t)).collect();
    let inner = Arc::new(Tlas::build(inner).expect("good transforms"));
    let outer = [
        Transform::IDENTITY,
        Transform::scaling([-1.0, 3.0, 0.5]).then(&Transform::rotation([1.0, 1.0, 0.0], 40.0)),
    ];
    let outer_instances = outer.iter().map(|&t| Instance::new(Arc::clone(&inner), t)).collect();
    let scene = Tlas::build(outer_instances).expect("good transforms");
    let flat: Vec<TriangleMesh> = outer
        .iter()
        .flat_map(|o| transforms.iter().map(move |i| (o, i)))
        .map(|(o, i)| shapes::mapped(&mesh, |p| o.point(i.point(p))))
        .collect();
    let solid = scene.solid();
    let points: Vec<_> =
        flat.iter().flat_map(|mesh| some_points(&mesh.total_bounds(), 40, rng.bits())).collect();
    let (mut inside, mut outside) = (0, 0);
    let mut answers = vec![None; points.len()];
    solid.signed_distance_batch(&points, &mut answers);
    for (&point, answer) in points.iter().zip(answers) {
        let least = flat.iter().map(|mesh| distance::to_mesh(point, mesh)).fold(1e9, f64::min);
        let windings = flat.iter().map(|mesh| distance::winding_number(point, mesh).abs());
        let expected = windings.fold(0.0, f64::max) > 0.5;
        if least > 1e-4 {
            assert_eq!(solid.contains(point), expected, "{point:?}");
            assert_eq!(answer.map(|distance| distance < 0.0), Some(expected));
        }
        assert_eq!(answer, solid.signed_distance(point));
        let distance = f64::from(answer.expect("there is a surface")).abs();
        assert!((distance - least).abs() <= 1e-5 * (1.0 + least + f64::from(point.length())));
        (inside, outside) = (inside + usize::from(expected), outside + usize::from(!expected));
    }
    assert!(inside > 100 && outside > 100, "{inside}, {outside}");
    assert!(!solid.contains([f32::NAN, 0.0, 0.0]) && !solid.contains([f32::INFINITY; 3]));
    let nothing = Tlas::<Bvh<TriangleMesh>>::build(vec![]).expect("legal");
    assert_eq!(nothing.solid().signed_distance([0.0; 3]), None);

    // A floor has no inside, and takes nothing away from what stands on it.
    let floor = TriangleMesh::new(
        vec![[-9.0, -9.0, -2.0], [9.0, -9.0, -2.0], [0.0, 9.0, -2.0]],
        vec![[0, 1, 2]],
    );
    let floor = Arc::new(Bvh::build(floor.expect("sound")).expect("it builds"));
    let both =
        vec![Instance::new(object, Transform::IDENTITY), Instance::new(floor, Transform::IDENTITY)];
    let scene = Tlas::build(both).expect("good transforms");
    let solid = scene.solid();
    assert!(solid.contains([0.0, 0.0, 0.0]) && !solid.contains([0.0, 0.0, -2.5]));
}
