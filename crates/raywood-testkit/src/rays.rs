//! Rays that look for trouble in a mesh.

use raywood::{Geometry, Ray, TriangleMesh, Vec3};

use crate::Rng;

/// About `count` rays against a mesh: at random into its bounds, from inside and outside, through vertices and edges, along the
/// axes in the planes of vertices, within faces, of very short and long directions, over limited intervals.
pub fn against(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let bounds = mesh.total_bounds();
    let (center, half) = match bounds.is_empty() {
        true => (Vec3::ZERO, Vec3::ONE),
        // At least a little room on every axis, so that rays can start beside a flat mesh.
        false => {
            (bounds.center(), (0.5 * bounds.extent()).max(Vec3::splat(1e-3 * bounds.diagonal())))
        }
    };
    let near = |rng: &mut Rng, reach: f32| center + reach * half * rng.in_cube();

    (0..count)
        .map(|i| {
            let from = near(&mut rng, if i % 3 == 0 { 1.0 } else { 4.0 });
            let to = match mesh.len() {
                0 => near(&mut rng, 1.0),
                n => {
                    let [p0, p1, p2] = mesh.corners(rng.below(n) as u32);
                    let (u, v) = (rng.unit(), rng.unit());
                    match i % 7 {
                        0 => p0,
                        1 => 0.5 * (p0 + p1),
                        2 => p1 + u * (p2 - p1),
                        3 => (1.0 - u) * p0 + u * (1.0 - v) * p1 + u * v * p2,
                        4 => return axis_parallel(&mut rng, from, p0),
                        5 => return Ray::new(p0 - (p1 - p0), p1 - p0),
                        _ => near(&mut rng, 1.0),
                    }
                }
            };
            let direction = to - from;
            match i % 5 {
                0 => Ray::new(from, 1e-3 * direction),
                1 => Ray::new(from, 1e3 * direction),
                2 => Ray::between(from, from + 1.5 * direction),
                3 => Ray::new(from, direction).with_interval(0.5, 2.0),
                _ => Ray::new(from, direction),
            }
        })
        .collect()
}

/// A ray along an axis, in the planes of a point's other coordinates, or of one of them.
fn axis_parallel(rng: &mut Rng, from: Vec3, point: Vec3) -> Ray {
    let axis = rng.below(3);
    let shared = rng.below(4);
    let coordinate =
        |other: usize| if other == axis || shared == other { from[other] } else { point[other] };
    let origin = Vec3::new(coordinate(0), coordinate(1), coordinate(2));
    let mut direction = [0.0, -0.0, 0.0];
    direction[axis] = if point[axis] >= from[axis] { 1.0 } else { -1.0 };
    Ray::new(origin, direction)
}

/// A ray inside the box from `-half` to `half`, from near one of its long edges to a point on a face very near an edge.
pub fn towards_an_edge(rng: &mut Rng, half: Vec3, nearness: f32) -> Ray {
    let z = rng.range(-0.5, 0.5) * half.z.min(10.0);
    let beside = |rng: &mut Rng| nearness * rng.range(0.1, 1.0);
    let from = Vec3::new(half.x - beside(rng), beside(rng) - half.y, z);
    let off_the_edge = nearness * 10f32.powf(rng.range(-7.0, 0.0));
    let to_z = z + nearness * rng.range(-3.0, 3.0);
    let target = match rng.below(2) {
        0 => Vec3::new(half.x, off_the_edge - half.y, to_z),
        _ => Vec3::new(half.x - off_the_edge, -half.y, to_z),
    };
    Ray::new(from, target - from)
}
