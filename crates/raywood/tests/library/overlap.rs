//! What touches boxes, balls, frustums, triangles and other meshes, against brute force in double precision.

use std::ops::ControlFlow;

use raywood::{
    Aabb, Ball, Bvh, Frustum, Geometry, Joined, Region, SimdLevel, Spheres, TriangleMesh, Vec3,
};
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
                    // The tolerance takes a look at the whole mesh, so it is asked for last.
                    let near = || {
                        let tolerance = distance::tolerance(center, &mesh, distance);
                        (distance - f64::from(radius)).abs() <= tolerance
                    };
                    let right = told == (distance <= f64::from(radius)) || near();
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
    let no_mesh = TriangleMesh::default();
    let mut nothing = Bvh::build(&no_mesh).expect("it builds");
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
    let mesh = shapes::soup(500, 0.1, 3);
    let bvh = Bvh::build(&mesh).expect("it builds");
    let mut rng = Rng::new(34);
    let balls: Vec<Ball> = (0..1000).map(|_| Ball::new(rng.in_cube(), 0.1 * rng.unit())).collect();
    let mut answers = vec![false; balls.len()];
    bvh.overlaps_batch(&balls, &mut answers);
    let expected: Vec<bool> = balls.iter().map(|ball| bvh.overlaps(ball)).collect();
    assert_eq!(answers, expected);
    assert!(expected.contains(&true) && expected.contains(&false));
}

/// Whether two triangles must, and whether they may be told to touch.
fn must_and_may(corners: [Vec3; 3], other: [Vec3; 3]) -> (bool, bool) {
    let around = |across, beside| {
        let planes = overlap::planes_around(other, across, beside);
        overlap::triangle_in_planes(corners, &planes)
    };
    (around(1e-13, -1e-9), around(1e-9, 1e-9))
}

#[test]
fn triangles() {
    let mesh = shapes::soup(800, 0.3, 3);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let others = shapes::soup(60, 0.5, 8);
    let mut touched = 0;
    // Those of the mesh itself too: they touch themselves.
    let own = (0..40).map(|triangle| mesh.corners(triangle));
    for region in own.chain((0..60).map(|triangle| others.corners(triangle))) {
        let found = touching(&mut bvh, &region);
        touched += found.len();
        for triangle in 0..800 {
            let (must, may) = must_and_may(mesh.corners(triangle), region);
            let told = found.binary_search(&triangle).is_ok();
            assert!(if told { may } else { !must }, "{triangle} and {region:?}: {told}");
        }
    }
    assert!(touched > 200, "{touched}");
    assert!(touching(&mut bvh, &[Vec3::splat(f32::NAN), Vec3::ZERO, Vec3::ONE]).is_empty());
}

#[test]
fn triangles_in_one_plane_and_without_area() {
    let mesh =
        TriangleMesh::new(vec![[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]], vec![[0, 1, 2]]);
    let mesh = mesh.expect("finite");
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let mut touches = |corners: [[f32; 3]; 3]| {
        let region = corners.map(Vec3::from);
        let before = touching(&mut bvh, &region).len() == 1;
        let [a, b, c] = region;
        assert_eq!(touching(&mut bvh, &[c, a, b]).len() == 1, before, "{corners:?}");
        assert_eq!(touching(&mut bvh, &[b, a, c]).len() == 1, before, "{corners:?}");
        before
    };
    // Inside, around, across, beside, in one edge, in one corner.
    assert!(touches([[1.0, 1.0, 1.0], [1.5, 1.0, 1.0], [1.0, 1.5, 1.0]]));
    assert!(touches([[-9.0, -9.0, 1.0], [30.0, -9.0, 1.0], [-9.0, 30.0, 1.0]]));
    assert!(touches([[-1.0, 1.0, 1.0], [9.0, 1.0, 1.0], [9.0, 1.5, 1.0]]));
    assert!(!touches([[3.0, 3.0, 1.0], [3.0, 2.0, 1.0], [2.0, 3.0, 1.0]]));
    assert!(touches([[4.0, 4.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]));
    assert!(touches([[4.0, 0.0, 1.0], [5.0, 0.0, 1.0], [5.0, 1.0, 2.0]]));
    // Points and segments, on it, through it and beside it.
    assert!(
        touches([[1.0; 3]; 3]) && touches([[2.0, 2.0, 1.0]; 3]) && !touches([[1.0, 1.0, 1.1]; 3])
    );
    let through = |x: f32| [[x, 1.0, 0.0], [x, 1.0, 2.0], [x, 1.0, 2.0]];
    assert!(touches(through(1.0)) && touches(through(3.0)) && !touches(through(3.1)));
    assert!(!touches([[1.0, 1.0, 2.0], [1.0, 1.0, 1.5], [1.0, 1.0, 1.2]]));
    assert!(touches([[1.0, 1.0, 2.0], [1.0, 1.0, 1.5], [1.0, 1.0, 1.0]]));
}

#[test]
fn frustums() {
    let mesh = shapes::soup(1000, 0.2, 3);
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let mut rng = Rng::new(35);
    let mut found_some = 0;
    for _ in 0..150 {
        // A view from a point along an axis of its own.
        let (eye, forwards) = (1.5 * rng.in_cube(), rng.direction());
        let (right, up) = forwards.orthonormal_basis();
        let width = 0.1 + 0.3 * rng.unit();
        let corner = |x: f32, y: f32, z: f32| eye + z * (forwards + width * (x * right + y * up));
        let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let front = around.map(|(x, y)| corner(x, y, 0.2));
        let back = around.map(|(x, y)| corner(x, y, 1.5));
        let [a, b, c, d] = front;
        let [e, f, g, h] = back;
        let found = touching(&mut bvh, &Frustum::from_corners([a, b, c, d, e, f, g, h]));
        found_some += usize::from(!found.is_empty());

        // The same by planes of its own making.
        let double = |v: Vec3| v.to_array().map(f64::from);
        let plane = |normal: Vec3, through: Vec3| {
            let (n, p) = (double(normal), double(through));
            (n, -(n[0] * p[0] + n[1] * p[1] + n[2] * p[2]))
        };
        let planes = |margin: f64| {
            let sides = [
                right + width * forwards,
                width * forwards - right,
                up + width * forwards,
                width * forwards - up,
            ];
            let mut planes: Vec<_> = sides.map(|side| plane(side, eye)).into();
            planes.extend([plane(forwards, front[0]), plane(-forwards, back[0])]);
            planes.iter_mut().for_each(|plane| plane.1 += margin);
            planes
        };
        for triangle in 0..1000 {
            let inside =
                |margin| overlap::triangle_in_planes(mesh.corners(triangle), &planes(margin));
            let told = found.binary_search(&triangle).is_ok();
            assert!(if told { inside(1e-5) } else { !inside(-1e-5) }, "{triangle}: {told}");
        }
    }
    assert!(found_some > 50, "{found_some}");

    let mut all = |planes: [[f32; 4]; 6]| touching(&mut bvh, &Frustum::from_planes(planes)).len();
    assert_eq!(all([[0.0, 0.0, 0.0, 1.0]; 6]), 1000);
    assert_eq!(all([[0.0, 0.0, 0.0, -1.0]; 6]), 0);
    assert_eq!(all([[f32::NAN, 0.0, 0.0, 1.0]; 6]), 0);
}

#[test]
fn pairs_of_two_geometries() {
    let (first, second) = (shapes::soup(400, 0.3, 3), shapes::soup(30, 0.6, 9));
    let mut bvh = Bvh::build(&first).expect("it builds");
    let other = Bvh::build(&second).expect("it builds");
    for level in SimdLevel::available() {
        bvh.set_simd_level(level);
        let (mut found, mut reverse) = (Vec::new(), Vec::new());
        let _ = bvh.overlapping_pairs(&other, |a, b| {
            found.push((a, b));
            ControlFlow::Continue(())
        });
        let _ = other.overlapping_pairs(&bvh, |b, a| {
            reverse.push((a, b));
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        reverse.sort_unstable();
        assert_eq!(found, reverse);
        assert!(found.windows(2).all(|pair| pair[0] != pair[1]) && found.len() > 50);
        for a in 0..400 {
            for b in 0..30 {
                let (must, may) = must_and_may(first.corners(a), second.corners(b));
                let told = found.binary_search(&(a, b)).is_ok();
                assert!(if told { may } else { !must }, "{a} and {b}: {told}");
            }
        }
    }
    assert!(bvh.overlaps_any_of(&other));
    let far = shapes::uv_sphere(4, Vec3::splat(9.0), 1.0);
    let far = Bvh::build(&far).expect("it builds");
    let no_mesh = TriangleMesh::default();
    let nothing = Bvh::build(&no_mesh).expect("it builds");
    assert!(
        !bvh.overlaps_any_of(&far)
            && !bvh.overlaps_any_of(&nothing)
            && !nothing.overlaps_any_of(&bvh)
    );
    let ball = Spheres::new(vec![(Vec3::splat(9.0), 1.0)]).expect("finite");
    let ball = Bvh::build(&ball).expect("it builds");
    assert!(
        ball.overlaps_any_of(&far) && far.overlaps_any_of(&ball) && !bvh.overlaps_any_of(&ball)
    );
}
