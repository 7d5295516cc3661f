//! Insides, moving spheres and other meshes in double precision, wherever they lie.

use std::ops::ControlFlow;

use raywood::{Bvh64, Ray64};
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
fn moving_spheres_stop_where_something_is_a_radius_away() {
    let mut rng = Rng::new(102);
    let mut touched = 0;
    for (at, size) in PLACES {
        let mesh = bumpy(3, at, size, &mut rng);
        let bvh = Bvh64::build(mesh).expect("it builds");
        for number in 0..200 {
            let place = |rng: &mut Rng, reach: f64| add(at, scaled(reach * size, in_cube(rng)));
            let (from, to) = (place(&mut rng, 3.0), place(&mut rng, 1.5));
            let ray = Ray64::new(from, scaled(0.5, sub(to, from))).with_interval(0.0, 4.0);
            let radius = [0.0, 0.01, 0.3][number % 3] * size;
            let gap = |t: f64| {
                bvh.closest_point(ray.at(t), f64::INFINITY).expect("a mesh").distance - radius
            };
            let tolerance = size * (1e-11 + 256.0 * step(at, size));
            let found = bvh.sphere_cast(&ray, radius);
            let end = found.map_or(4.0, |hit| hit.t);
            for step in 0..20 {
                let t = end * f64::from(step) / 20.0;
                assert!(t == end || gap(t) >= -tolerance, "{} at {t} before {found:?}", gap(t));
            }
            let Some(hit) = found else { continue };
            touched += 1;
            assert!(gap(hit.t) <= tolerance, "{} of {hit:?} at {at:?}", gap(hit.t));
            let apart = sub(ray.at(hit.t), hit.point);
            assert!((dot(apart, apart).sqrt() - radius).abs() <= tolerance || hit.t == 0.0);
        }
        let ray = Ray64::new(at, [0.0, 0.0, size]);
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(bvh.sphere_cast(&ray, bad), None);
        }
        assert_eq!(bvh.sphere_cast(&Ray64::new(at, [0.0; 3]), size), None);
    }
    assert!(touched > 300, "only {touched}");
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
