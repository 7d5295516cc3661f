//! Whether a ray crosses a triangle, by a rule under which it crosses a closed surface an even number of times: for queries that count.
//!
//! The test in `watertight.rs` counts an edge with both triangles that share it, so that the closest hit is never lost. Whoever counts needs exactly one of
//! them. So here the ray is thought to be moved aside, by less than any number: Edelsbrunner and Mücke, "Simulation of Simplicity", ACM
//! Transactions on Graphics 1990. Then it meets no edge and no vertex, and what it crosses follows from signs that are exact. `docs/numerics.md` tells
//! what they are exact about.

use super::{PreparedRay, PrimitiveHit};
use crate::Vec3;
use crate::double::single_distance;

/// A vertex as the ray sees it: relative to the origin, sheared so that the ray is the third axis (not yet scaled).
#[derive(Clone, Copy)]
struct Seen {
    x: f64,
    y: f64,
    depth: f64,
}

/// What a ray sees of a vertex. It depends on these two alone, so that all triangles around a vertex have the same numbers for it.
fn seen(ray: &PreparedRay, vertex: Vec3) -> Seen {
    let [x, y, z] = ray.axes.numbers();
    let [dx, dy, dz] = [x, y, z].map(|axis| f64::from(ray.direction[axis]));
    let p = |axis: usize| f64::from(vertex[axis]) - f64::from(ray.origin[axis]);
    Seen { x: p(x) - dx / dz * p(z), y: p(y) - dy / dz * p(z), depth: p(z) }
}

/// The edge function `p.x q.y - p.y q.x`, off by two roundings of itself at most: Kahan's product difference, with both errors (Jeannerod, Louvet
/// and Muller, Mathematics of Computation 2013).
fn edge(p: Seen, q: Seen) -> f64 {
    let (left, right) = (p.x * q.y, p.y * q.x);
    (left - right) + (p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right))
}

/// On which side the moved ray passes an edge, as a sign: exact, and the opposite for the same edge the other way round. Zero only where both vertices are
/// seen as one.
fn side(p: Seen, q: Seen) -> f64 {
    // Where the rounded products differ they differ as the exact ones do; where they do not, their errors tell.
    let (left, right) = (p.x * q.y, p.y * q.x);
    if left != right {
        return left - right;
    }
    let rest = p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right);
    // The ray moved by `e` along x and `e^2` along y adds `e (p.y - q.y) + e^2 (q.x - p.x)`.
    [rest, p.y - q.y, q.x - p.x].into_iter().find(|&sign| sign != 0.0).unwrap_or(0.0)
}

/// The crossing of a ray with a triangle at `t_min <= t < t_max`, each point of a closed surface being crossed by exactly one triangle in front and behind.
///
/// Everything in double precision and independent of how the corners are ordered, up to the orientation. A triangle that is seen as a line is never crossed.
pub(crate) fn cross_triangle(ray: &PreparedRay, corners: [Vec3; 3]) -> Option<PrimitiveHit> {
    let [a, b, c] = corners.map(|corner| seen(ray, corner));
    let sides = [side(c, b), side(a, c), side(b, a)];
    if !(sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)) {
        return None;
    }

    // All of one sign or zero, and not all zero: the weights are right to a few roundings of themselves, the depth to a few of the farthest corner's.
    let [w, u, v] = [edge(c, b), edge(a, c), edge(b, a)];
    let sum = w + u + v;
    let depth = (w * a.depth + u * b.depth + v * c.depth) / sum;
    let t = depth / f64::from(ray.direction[ray.axes.numbers()[2]]);

    let rounded = single_distance(t);
    let hit = PrimitiveHit { t: rounded, u: (u / sum) as f32, v: (v / sum) as f32 };
    ray.accepts(rounded).then_some(hit)
}

/// Whether a ray that hits the triangle meets its front: the side that its normal `(p1-p0) x (p2-p0)` points to.
pub(crate) fn meets_front(ray: &PreparedRay, corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| seen(ray, corner));
    edge(c, b) + edge(a, c) + edge(b, a) > 0.0
}
