//! What touches boxes and balls, against brute force in double precision.

use std::ops::ControlFlow;

use raywood::{Aabb, Ball, Bvh, Geometry, Joined, Region, SimdLevel, Spheres, TriangleMesh, Vec3};
use raywood_testkit::{Rng, distance, nasty, overlap, points, shapes};

fn meshes() -> impl Iterator<Item = (&'static str, TriangleMesh)> {
    let friendly = [
        ("a sphere", shapes::uv_sphere(24, Vec3::new(0.3, -0.2, 0.1), 1.5)),
        ("a soup", shapes::soup(2000, 0.1, 3)),
    ];
    friendly.into_iter().chain(nasty::all().into_iter().map(|nasty| (nasty.name, nasty.mesh)))
}

/// What touches a region, in ascending order: on all levels the same, none twice.
fn touching<G: Geometry, R: Region>(bvh: &mut Bvh<G>, region: &R) -> Vec<u32> {
    let mut answers = SimdLevel::available().map(|level| {
        bvh.set_simd_level(level);
        let mut found = Vec::new();
        let flow = bvh.overlapping(region, |primitive| {
            found.push(primitive);
            ControlFlow::Continue(())
        });
        assert_eq!(flow, ControlFlow::Continue(()));
        found.sort_unstable();
        assert!(found.windows(2).all(|pair| pair[0] != pair[1]), "twice");
        assert_eq!(bvh.overlaps(region), !found.is_empty());
        found
    });
    let first = answers.next().expect("a level");
    assert!(answers.all(|other| other == first), "levels differ");
    first
}

/// The largest coordinate of a mesh and a point.
fn largest(mesh: &TriangleMesh, point: Vec3) -> f64 {
    let bounds = mesh.total_bounds();
    let largest = point.abs().max(bounds.min.abs()).max(bounds.max.abs()).max_element();
    f64::from(largest)
}

/// Sizes of regions from nothing to more than everything.
fn sizes(mesh: &TriangleMesh) -> [f32; 4] {
    let size = if mesh.triangles().is_empty() { 1.0 } else { mesh.total_bounds().diagonal() };
    [0.0, 0.01 * size, 0.2 * size, 3.0 * size]
}

#[test]
fn boxes() {
    for (name, mesh) in meshes() {
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        let mut rng = Rng::new(31);
        for point in points::around(&mesh, 8, 32) {
            for size in sizes(&mesh) {
                let half = Vec3::new(size * rng.unit(), size * rng.unit(), size * rng.unit());
                let region = Aabb::new(point - half, point + half);
                if !region.is_finite() {
                    continue;
                }
                let found = touching(&mut bvh, &region);
                let margin =
                    2f64.powi(-40) * largest(&mesh, region.max.abs().max(region.min.abs()));
                for triangle in 0..mesh.triangles().len() as u32 {
                    let inside = |margin: f64| {
                        let planes = overlap::planes_of(&region, margin);
                        overlap::triangle_in_planes(mesh.corners(triangle), &planes)
                    };
                    let told = found.binary_search(&triangle).is_ok();
                    let right = if told { inside(margin) } else { !inside(-margin) };
                    assert!(right, "{name}: triangle {triangle} and {region:?}: {told}");
                }
            }
        }
    }
}

#[test]
fn balls() {
    for (name, mesh) in meshes() {
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        for center in points::around(&mesh, 16, 33) {
            for radius in sizes(&mesh).into_iter().chain([f32::INFINITY]) {
                let found = touching(&mut bvh, &Ball { center, radius });
                for triangle in 0..mesh.triangles().len() as u32 {
                    let distance = distance::to_triangle(center, mesh.corners(triangle));
                    let told = found.binary_search(&triangle).is_ok();
                    let tolerance = distance::tolerance(center, &mesh, distance);
                    let near = (distance - f64::from(radius)).abs() <= tolerance;
                    let right = near || told == (distance <= f64::from(radius));
                    assert!(
                        right,
                        "{name}: {triangle}, {center:?}, {distance} and {radius}: {told}"
                    );
                }
            }
        }
    }
}

#[test]
fn touching_counts() {
    let mesh = shapes::grid_box(1, Vec3::ZERO, Vec3::ONE);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    assert!(!touching(&mut bvh, &Aabb::new([1.0, 1.0, 1.0], [2.0, 2.0, 2.0])).is_empty());
    let beside = 1f32.next_up();
    assert!(touching(&mut bvh, &Aabb::new([beside, 0.0, 0.0], [2.0, 2.0, 2.0])).is_empty());
    assert!(!touching(&mut bvh, &Ball::new([0.5, 0.5, 3.0], 2.0)).is_empty());
    assert!(touching(&mut bvh, &Ball::new([0.5, 0.5, 3.0], 2f32.next_down())).is_empty());
    assert!(!touching(&mut bvh, &Ball::new([0.0; 3], 0.0)).is_empty());
}

#[test]
fn regions_that_hold_nothing_or_everything() {
    let mesh = shapes::uv_sphere(8, Vec3::ZERO, 1.0);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let all = mesh.triangles().len();
    let infinite = Vec3::splat(f32::INFINITY);
    assert_eq!(touching(&mut bvh, &Aabb { min: -infinite, max: infinite }).len(), all);
    assert_eq!(touching(&mut bvh, &Ball::new([9.0, 0.0, 0.0], f32::INFINITY)).len(), all);
    for empty in [
        Aabb::EMPTY,
        Aabb::new([1.0, 0.0, 0.0], [0.0, 1.0, 1.0]),
        Aabb::new([f32::NAN, 0.0, 0.0], [1.0, 1.0, 1.0]),
        Aabb::new([0.0, 0.0, 0.0], [1.0, f32::NAN, 1.0]),
    ] {
        assert!(touching(&mut bvh, &empty).is_empty(), "{empty:?}");
    }
    for empty in [
        Ball::new([0.0; 3], -1.0),
        Ball::new([0.0; 3], f32::NAN),
        Ball::new([f32::NAN, 0.0, 0.0], f32::INFINITY),
    ] {
        assert!(touching(&mut bvh, &empty).is_empty(), "{empty:?}");
    }
    let mut nothing = Bvh::build(TriangleMesh::default()).expect("it builds");
    assert!(touching(&mut nothing, &Aabb { min: -infinite, max: infinite }).is_empty());
    assert!(touching(&mut nothing, &Ball::new([0.0; 3], f32::INFINITY)).is_empty());
}

#[test]
fn spheres_are_touched_by_what_reaches_their_surface() {
    let spheres = Spheres::new(vec![(Vec3::new(0.5, 0.0, 0.0), 2.0)]).expect("finite");
    let things = Joined { first: shapes::soup(100, 0.1, 3), second: spheres };
    let mut bvh = Bvh::build(&things).expect("it builds");
    let mut touches =
        |min: [f32; 3], max: [f32; 3]| touching(&mut bvh, &Aabb::new(min, max)).contains(&100);
    assert!(touches([2.0, -0.1, -0.1], [3.0, 0.1, 0.1]));
    // Inside, and in a corner of its box.
    assert!(!touches([0.0, -0.5, -0.5], [1.0, 0.5, 0.5]));
    assert!(!touches([2.2, 1.8, 1.8], [3.0, 3.0, 3.0]));
    let mut touches = |center: [f32; 3], radius: f32| {
        touching(&mut bvh, &Ball::new(center, radius)).contains(&100)
    };
    assert!(touches([5.5, 0.0, 0.0], 3.0) && !touches([5.5, 0.0, 0.0], 2.9));
    assert!(touches([1.5, 0.0, 0.0], 1.0) && !touches([1.5, 0.0, 0.0], 0.9));
}

#[test]
fn batches_answer_as_single_regions_do() {
    let bvh = Bvh::build(shapes::soup(500, 0.1, 3)).expect("it builds");
    let mut rng = Rng::new(34);
    let balls: Vec<Ball> = (0..1000).map(|_| Ball::new(rng.in_cube(), 0.1 * rng.unit())).collect();
    let mut answers = vec![false; balls.len()];
    bvh.overlaps_batch(&balls, &mut answers);
    let expected: Vec<bool> = balls.iter().map(|ball| bvh.overlaps(ball)).collect();
    assert_eq!(answers, expected);
    assert!(expected.contains(&true) && expected.contains(&false));
}
