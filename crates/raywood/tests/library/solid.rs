//! What is inside closed meshes, soups and spheres, against exact sums of solid angles and known shapes.

use raywood::{Bvh, Joined, SimdLevel, Spheres, TriangleMesh, Vec3};
use raywood_testkit::{Rng, distance, nasty, points, shapes};

#[test]
fn near_what_summing_all_angles_gives_and_the_same_on_every_level() {
    let closed = [
        shapes::uv_sphere(40, Vec3::ZERO, 1.0),
        shapes::grid_box(12, Vec3::splat(-1.0), Vec3::ONE),
    ];
    let meshes = closed.into_iter().chain(nasty::all().into_iter().map(|nasty| nasty.mesh));
    for mesh in meshes {
        let points = points::around(&mesh, 300, 21);
        let size = mesh.total_bounds().diagonal();
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        let mut before: Option<Vec<f32>> = None;
        for level in SimdLevel::available() {
            bvh.set_simd_level(level);
            let solid = bvh.solid();
            let mut answers = vec![f32::NAN; points.len()];
            solid.winding_number_batch(&points, &mut answers);
            for (&point, &answer) in points.iter().zip(&answers) {
                assert_eq!(solid.winding_number(point).to_bits(), answer.to_bits());
                let expected = distance::winding_number(point, &mesh);
                // On the surface itself, or within rounding of a triangle without area, either side will do.
                let on_it = distance::to_mesh(point, &mesh) <= 1e-6 * f64::from(size);
                let off = (f64::from(answer) - expected).abs();
                assert!(off < 0.05 || on_it, "{answer}, not {expected}, around {point:?}");
            }
            let same = before.as_ref().is_none_or(|before| *before == answers);
            assert!(same, "{} differs", level.name());
            before = Some(answers);
        }
    }
}

#[test]
fn a_box_contains_what_lies_in_it_however_near_its_faces() {
    for (size, offset) in
        [(1.0f32, 0.0f32), (1e-6, 0.0), (1e9, 0.0), (1.0, 100.0), (1e15, 0.0), (1e-15, 0.0)]
    {
        let (min, max) = (Vec3::splat(offset - size), Vec3::splat(offset + size));
        let mesh = shapes::grid_box(7, min, max);
        let bvh = Bvh::build(&mesh).expect("it builds");
        let solid = bvh.solid();
        let mut rng = Rng::new(3);
        let mut near_faces = 0;
        for number in 0..4000 {
            let mut point = Vec3::splat(offset) + 1.2 * size * rng.in_cube();
            // Most of them right beside a face, an edge or a corner.
            let mut coordinates = point.to_array();
            for coordinate in coordinates.iter_mut().take(number % 4) {
                let face = if rng.unit() < 0.5 { min.x } else { max.x };
                *coordinate = if rng.unit() < 0.5 { face.next_up() } else { face.next_down() };
                near_faces += 1;
            }
            coordinates.rotate_left(rng.below(3));
            point = coordinates.into();
            let inside = (0..3).all(|axis| min.x < point[axis] && point[axis] < max.x);
            let outside = (0..3).any(|axis| point[axis] < min.x || max.x < point[axis]);
            assert!(
                inside
                    || outside
                    || (0..3).any(|axis| point[axis] == min.x || point[axis] == max.x)
            );
            if inside || outside {
                assert_eq!(
                    solid.contains(point),
                    inside,
                    "{point:?} in a box of {size} at {offset}"
                );
                let distance = solid.signed_distance(point).expect("a distance");
                assert_eq!(distance < 0.0, inside, "{point:?}: {distance}");
            }
        }
        assert!(near_faces > 3000);
    }
}

#[test]
fn signed_distances_of_a_sphere() {
    let mesh = shapes::uv_sphere(100, Vec3::new(1.0, 2.0, 3.0), 2.0);
    let bvh = Bvh::build(&mesh).expect("it builds");
    let solid = bvh.solid();
    let mut rng = Rng::new(4);
    let points: Vec<Vec3> =
        (0..3000).map(|_| Vec3::new(1.0, 2.0, 3.0) + 4.0 * rng.in_cube()).collect();
    let mut answers = vec![None; points.len()];
    solid.signed_distance_batch(&points, &mut answers);
    for (&point, answer) in points.iter().zip(answers) {
        let exact = (point - Vec3::new(1.0, 2.0, 3.0)).length() - 2.0;
        let found = answer.expect("a distance");
        assert!((found - exact).abs() < 2e-3, "{found}, not {exact}");
        assert_eq!(solid.signed_distance(point), Some(found));
    }
}

#[test]
fn soups_with_holes_are_solid_too() {
    // A sphere that lacks every fiftieth triangle, each of its own vertices, some twice.
    let whole = shapes::uv_sphere(40, Vec3::ZERO, 1.0);
    let mut corners = Vec::new();
    for triangle in 0..whole.triangles().len() as u32 {
        if triangle % 50 != 7 {
            corners.extend(whole.corners(triangle));
        }
    }
    let indices = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let soup = TriangleMesh::new(corners, indices).expect("finite");
    let bvh = Bvh::build(&soup).expect("it builds");
    let solid = bvh.solid();
    let mut rng = Rng::new(4);
    for _ in 0..2000 {
        let point = 1.5 * rng.in_cube();
        if (point.length() - 1.0).abs() > 0.05 {
            assert_eq!(solid.contains(point), point.length() < 1.0, "{point:?}");
        }
    }
}

#[test]
fn spheres_are_solid() {
    let spheres = Spheres::new(vec![(Vec3::ZERO, 1.0), (Vec3::new(0.5, 0.0, 0.0), 1.0)]);
    let things = Joined {
        first: shapes::grid_box(3, Vec3::new(5.0, 5.0, 5.0), Vec3::new(6.0, 6.0, 6.0)),
        second: spheres.expect("finite spheres"),
    };
    let bvh = Bvh::build(&things).expect("it builds");
    let solid = bvh.solid();
    assert!((solid.winding_number([0.2, 0.0, 0.0]) - 2.0).abs() < 0.05);
    assert!((solid.winding_number([-0.8, 0.0, 0.0]) - 1.0).abs() < 0.05);
    assert!((solid.winding_number([5.1, 5.5, 5.5]) - 1.0).abs() < 0.05);
    assert!(!solid.contains([0.0, 1.1, 0.0]));
    assert_eq!(solid.signed_distance([-0.75, 0.0, 0.0]), Some(-0.25));
}

#[test]
fn nothing_contains_nothing() {
    let no_mesh = TriangleMesh::default();
    let nothing = Bvh::build(&no_mesh).expect("it builds");
    assert!(!nothing.solid().contains([0.0; 3]));
    assert_eq!(nothing.solid().signed_distance([0.0; 3]), None);
    let mesh = shapes::uv_sphere(4, Vec3::ZERO, 1.0);
    let bvh = Bvh::build(&mesh).expect("it builds");
    for bad in [f32::NAN, f32::INFINITY] {
        assert!(!bvh.solid().contains([0.0, bad, 0.0]));
        assert_eq!(bvh.solid().signed_distance([bad, 0.0, 0.0]), None);
    }
}
