//! Insides, moving spheres and other meshes in double precision, wherever they lie.

use std::ops::ControlFlow;

use raywood::Bvh64;
use raywood_testkit::Rng;

use crate::doubles::{PLACES, add, bumpy, in_cube, scaled, sub};

type Point = [f64; 3];

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Single steps of coordinates there, in units of the mesh's size.
fn step(at: Point, size: f64) -> f64 {
    f64::EPSILON * at.iter().fold(0.0, |most: f64, x| most.max(x.abs())) / size
}

#[test]
fn inside_is_told_right_next_to_the_surface() {
    let mut rng = Rng::new(101);
    for (at, size) in PLACES {
        let mesh = bumpy(3, at, size, &mut rng);
        let bvh = Bvh64::build(mesh.clone()).expect("it builds");
        let solid = bvh.solid();
        assert!((solid.winding_number(at) - 1.0).abs() < 0.05);
        let (mut points, mut sides) = (Vec::new(), Vec::new());
        for triangle in 0..mesh.triangles().len() as u32 {
            let [a, b, c] = mesh.corners(triangle);
            let normal = cross(sub(b, a), sub(c, a));
            let normal = scaled(1.0 / dot(normal, normal).sqrt(), normal);
            let middle = add(a, scaled(1.0 / 3.0, add(sub(b, a), sub(c, a))));
            for height in [64.0 * step(at, size) + 1e-13, 1e-9 + 64.0 * step(at, size)] {
                for side in [-1.0, 1.0] {
                    points.push(add(middle, scaled(side * height * size, normal)));
                    sides.push(side < 0.0);
                }
            }
        }
        let mut windings = vec![0.0; points.len()];
        solid.winding_number_batch(&points, &mut windings);
        let mut distances = vec![None; points.len()];
        solid.signed_distance_batch(&points, &mut distances);
        for (number, (&point, &is_inside)) in points.iter().zip(&sides).enumerate() {
            let told = solid.contains(point);
            assert_eq!(told, is_inside, "{number} at {at:?}, {}", windings[number]);
            assert_eq!(windings[number], solid.winding_number(point));
            assert_eq!(distances[number], solid.signed_distance(point));
            let closest = bvh.closest_point(point, f64::INFINITY).expect("a mesh");
            assert_eq!(distances[number].map(f64::abs), Some(closest.distance));
        }
        for bad in [f64::NAN, f64::INFINITY, 1e60] {
            assert_eq!(solid.winding_number([0.0, bad, 0.0]), 0.0);
            assert_eq!(solid.signed_distance([0.0, bad, 0.0]), None);
        }
    }
}

#[test]
fn pairs_are_those_of_triangles_one_by_one() {
    let mut rng = Rng::new(103);
    let mut found = 0;
    for (at, size) in PLACES {
        let bvh = Bvh64::build(bumpy(3, at, size, &mut rng)).expect("it builds");
        // Of another size, so that its frame is another one.
        let beside = add(at, scaled(0.7 * size, in_cube(&mut rng)));
        let other = bumpy(2, beside, 0.3 * size, &mut rng);
        let mut expected = Vec::new();
        for number in 0..other.triangles().len() as u32 {
            let _ = bvh.overlapping(&other.corners(number), |own| {
                expected.push((own, number));
                ControlFlow::Continue(())
            });
        }
        let other = Bvh64::build(other).expect("it builds");
        let mut pairs = Vec::new();
        let _ = bvh.overlapping_pairs(&other, |own, number| {
            pairs.push((own, number));
            ControlFlow::Continue(())
        });
        expected.sort_unstable();
        pairs.sort_unstable();
        assert_eq!(pairs, expected, "at {at:?}");
        assert_eq!(bvh.overlaps_any_of(&other), !pairs.is_empty());
        let mut swapped = Vec::new();
        let _ = other.overlapping_pairs(&bvh, |number, own| {
            swapped.push((own, number));
            ControlFlow::Continue(())
        });
        swapped.sort_unstable();
        assert_eq!(swapped, pairs, "at {at:?}");
        found += pairs.len();
    }
    assert!(found > 20, "only {found}");
}
