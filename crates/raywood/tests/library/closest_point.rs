//! Closest points against brute force in double precision, on friendly and nasty meshes and every level of instructions.

use std::ops::ControlFlow;

use raywood::{
    Aabb, Bvh, ClosestPoint, Geometry, Hit, Joined, PreparedRay, PrimitiveHit, PrimitivePoint, Ray,
    SimdLevel, Spheres, SurfacePoint, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, distance, nasty, points, shapes};

/// The answer by asking every primitive.
fn by_asking_all<G: Geometry>(geometry: &G, point: Vec3, max: f32) -> Option<ClosestPoint> {
    let all = (0..geometry.len() as u32).filter_map(|primitive| {
        let PrimitivePoint { point, distance, u, v } = geometry.closest_point(primitive, point)?;
        Some(ClosestPoint { point, distance, primitive, instance: 0, u, v })
    });
    all.filter(|found| found.distance <= max).min_by(|a, b| {
        (a.distance, a.primitive).partial_cmp(&(b.distance, b.primitive)).expect("numbers")
    })
}

fn friendly() -> Vec<(&'static str, TriangleMesh)> {
    vec![
        ("a sphere", shapes::uv_sphere(24, Vec3::new(0.3, -0.2, 0.1), 1.5)),
        ("a box", shapes::grid_box(8, Vec3::splat(-1.0), Vec3::splat(1.0))),
        ("a soup", shapes::soup(2000, 0.1, 3)),
    ]
}

fn all_meshes() -> impl Iterator<Item = (&'static str, TriangleMesh)> {
    friendly().into_iter().chain(nasty::all().into_iter().map(|nasty| (nasty.name, nasty.mesh)))
}

#[test]
fn the_same_as_asking_all_on_every_level() {
    for (name, mesh) in all_meshes() {
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        let points = points::around(&mesh, 400, 11);
        let size = mesh.total_bounds().diagonal();
        for max in [f32::INFINITY, 0.2 * size, 0.0] {
            let expected: Vec<_> =
                points.iter().map(|&point| by_asking_all(&mesh, point, max)).collect();
            for level in SimdLevel::available() {
                bvh.set_simd_level(level);
                let mut answers = vec![None; points.len()];
                bvh.closest_point_batch(&points, max, &mut answers);
                for ((point, answer), expected) in points.iter().zip(&answers).zip(&expected) {
                    let what = format!("{name}, {}, {point:?} up to {max}", level.name());
                    assert_eq!(answer, expected, "in a batch: {what}");
                    assert_eq!(bvh.closest_point(*point, max), *expected, "alone: {what}");
                }
            }
        }
    }
}

#[test]
fn as_far_as_double_precision_says() {
    for (name, mesh) in all_meshes() {
        let bvh = Bvh::build(&mesh).expect("it builds");
        for point in points::around(&mesh, 400, 12) {
            let expected = distance::to_mesh(point, &mesh);
            let Some(found) = bvh.closest_point(point, f32::INFINITY) else {
                assert!(mesh.triangles().is_empty(), "{name}: nothing found");
                continue;
            };
            let tolerance = distance::tolerance(point, &mesh, expected);
            let off = (f64::from(found.distance) - expected).abs();
            assert!(
                off <= tolerance || found.distance.is_infinite() && expected > f64::from(f32::MAX),
                "{name}: {point:?} is {expected} away, not {}",
                found.distance
            );

            // The point lies where it says, and the coordinates mean it.
            let [a, b, c] = mesh.corners(found.primitive);
            let meant = (1.0 - found.u - found.v) * a + found.u * b + found.v * c;
            let largest = point.abs().max(a.abs()).max(b.abs()).max(c.abs()).max_element();
            let off = (meant - found.point).abs().max_element();
            assert!(off <= 1e-6 * largest, "{name}: {meant:?} is not {:?}", found.point);
        }
    }
}

#[test]
fn what_is_no_question_has_no_answer() {
    let mesh = shapes::uv_sphere(8, Vec3::ZERO, 1.0);
    let bvh = Bvh::build(&mesh).expect("it builds");
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(bvh.closest_point([0.0, bad, 0.0], f32::INFINITY), None);
    }
    for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        assert_eq!(bvh.closest_point([0.0, 2.0, 0.0], bad), None);
    }
    // It does not matter for the others of a batch.
    let points = [Vec3::splat(f32::NAN), Vec3::new(0.0, 3.0, 0.0), Vec3::splat(f32::INFINITY)];
    let mut answers = [None; 3];
    bvh.closest_point_batch(&points, f32::INFINITY, &mut answers);
    assert_eq!(answers.map(|answer| answer.map(|found| found.distance)), [None, Some(2.0), None]);

    let no_mesh = TriangleMesh::default();
    let nothing = Bvh::build(&no_mesh).expect("it builds");
    assert_eq!(nothing.closest_point([0.0; 3], f32::INFINITY), None);
}

#[test]
fn spheres_and_triangles_together() {
    let mut rng = Rng::new(5);
    let spheres = (0..300).map(|_| (rng.in_cube(), 0.1 * rng.unit())).collect();
    let things = Joined {
        first: shapes::soup(500, 0.1, 3),
        second: Spheres::new(spheres).expect("finite spheres"),
    };
    let mut bvh = Bvh::build(&things).expect("it builds");
    let mut on_spheres = 0;
    for level in SimdLevel::available() {
        bvh.set_simd_level(level);
        let mut rng = Rng::new(6);
        for _ in 0..1000 {
            let point = 1.2 * rng.in_cube();
            let found = bvh.closest_point(point, f32::INFINITY);
            assert_eq!(found, by_asking_all(&things, point, f32::INFINITY));
            on_spheres += u32::from(found.is_some_and(|found| found.primitive >= 500));
        }
    }
    assert!(on_spheres > 300);
}

#[test]
fn spheres_are_their_surfaces() {
    let spheres = Spheres::new(vec![(Vec3::new(1.0, 0.0, 0.0), 2.0)]).expect("a sphere");
    let bvh = Bvh::build(&spheres).expect("it builds");
    let found = |point: [f32; 3]| {
        let found = bvh.closest_point(point, f32::INFINITY).expect("a point");
        (found.point.to_array(), found.distance)
    };
    assert_eq!(found([1.0, 5.0, 0.0]), ([1.0, 2.0, 0.0], 3.0));
    assert_eq!(found([1.0, 0.0, -0.5]), ([1.0, 0.0, -2.0], 1.5));
    assert_eq!(found([1.0, 0.0, 0.0]).1, 2.0);
}

/// A geometry that knows nothing of points.
struct Opaque;

impl Geometry for Opaque {
    fn len(&self) -> usize {
        20
    }

    fn bounds(&self, _: u32) -> Aabb {
        Aabb::new(Vec3::ZERO, Vec3::X)
    }

    fn intersect(&self, _: u32, _: &PreparedRay) -> Option<PrimitiveHit> {
        None
    }

    fn surface_point(&self, _: &Ray, _: &Hit) -> SurfacePoint {
        unreachable!("nothing is hit")
    }
}

#[test]
fn the_own_distance_as_a_limit_finds_it_again() {
    let mut rng = Rng::new(31);
    // Numbers of every size, so that most are nothing beside the largest.
    let mut number = move || rng.range(-1.0, 1.0) * 10f32.powi(rng.below(76) as i32 - 38);
    let mut point = move || Vec3::new(number(), number(), number());
    for _ in 0..300 {
        let corners = (0..60).map(|_| point()).collect::<Vec<_>>();
        let triangles = (0..20).map(|t| [3 * t, 3 * t + 1, (3 * t + 5) % 60]).collect();
        let first = TriangleMesh::new(corners, triangles).expect("sound");
        let balls = (0..20).map(|_| (point(), point().x.abs())).collect();
        let second = Spheres::new(balls).expect("sound");
        let mut bvh = Bvh::build(Joined { first, second }).expect("it builds");
        for level in SimdLevel::available() {
            bvh.set_simd_level(level);
            for _ in 0..20 {
                let point = point();
                let closest = bvh.closest_point(point, f32::INFINITY).expect("there is something");
                let again = bvh.closest_point(point, closest.distance);
                assert_eq!(again, Some(closest), "{}: {point:?}", level.name());
            }
        }
    }
    // A ball so large that what lies beside it is lost in its radius.
    let ball = Spheres::new(vec![(Vec3::new(1.5e38, 5.5, -7.5), 1.5e38)]).expect("sound");
    let bvh = Bvh::build(ball).expect("it builds");
    let closest = bvh.closest_point([-2.7e13, 5.5, -7.5], f32::INFINITY).expect("a ball");
    assert!(closest.distance >= 2.6e13, "{closest:?}");
    assert_eq!(bvh.closest_point([-2.7e13, 5.5, -7.5], closest.distance), Some(closest));
}

#[test]
fn what_cannot_tell_is_not_found() {
    let bvh = Bvh::build(Opaque).expect("it builds");
    assert_eq!(bvh.closest_point([0.5, 0.0, 0.0], f32::INFINITY), None);
}

#[test]
fn a_walk_of_ones_own_finds_the_closest_too() {
    for (name, mesh) in all_meshes() {
        let bvh = Bvh::build(&mesh).expect("it builds");
        for point in points::around(&mesh, 50, 13) {
            let expected = bvh.closest_point(point, f32::INFINITY).map(|found| found.distance);
            let mut least = f32::INFINITY;
            let mut seen = vec![false; mesh.triangles().len()];
            // Half the distance from the box, for its rounding.
            let bound = |bounds: &Aabb| {
                let beside = (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO);
                Some(0.5 * beside.max_element())
            };
            let flow = bvh.visit(bound, |primitive| {
                assert!(!std::mem::replace(&mut seen[primitive as usize], true), "{name}: twice");
                let found = mesh.closest_point(primitive, point).expect("a triangle");
                least = least.min(found.distance);
                ControlFlow::Continue(least)
            });
            assert_eq!(flow, ControlFlow::Continue(()));
            assert_eq!(least, expected.unwrap_or(f32::INFINITY), "{name}: {point:?}");
        }
        // All of them without a bound, none without a box, one with a break.
        let count = |bound: fn(&Aabb) -> Option<f32>, flow: ControlFlow<(), f32>| {
            let mut count = 0;
            let _ = bvh.visit(bound, |_| {
                count += 1;
                flow
            });
            count
        };
        let all = mesh.triangles().len();
        assert_eq!(count(|_| Some(0.0), ControlFlow::Continue(0.0)), all, "{name}");
        assert_eq!(count(|_| Some(f32::NAN), ControlFlow::Continue(f32::NAN)), all, "{name}");
        assert_eq!(count(|_| None, ControlFlow::Continue(0.0)), 0, "{name}");
        assert_eq!(count(|_| Some(0.0), ControlFlow::Break(())), all.min(1), "{name}");
    }
}
