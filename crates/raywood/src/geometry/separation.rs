//! Whether a triangle and a box overlap: the separating axes of Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", Journal of
//! Graphics Tools 2001.

use crate::{Aabb, Vec3};

/// The error of a moved corner and of its products with an edge, per unit of the largest coordinate and of the edge: sixteen
/// roundings in double precision. Both count at most thirteen.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The error of a corner's distance from the triangle's plane, per unit of the largest coordinate and of two edges' lengths: sixty-four
/// roundings. The normal of a sliver is the difference of two nearly equal products, so its error is not relative to itself.
const PLANE_ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Whether the triangle has a point in the cell, touching included.
///
/// Conservative: in double precision, against a cell larger by the rounding errors. Most answers come after a few comparisons; the longest way
/// takes some hundred operations and no memory, a small part of what clipping takes.
pub(crate) fn triangle_overlaps(corners: [Vec3; 3], cell: &Aabb) -> bool {
    let bounds = Aabb::of_points(corners);
    if bounds.intersection(cell).is_empty() {
        return false;
    }
    if corners.iter().any(|&corner| cell.contains(&Aabb { min: corner, max: corner })) {
        return true;
    }

    // Move the cell's centre to the origin.
    let largest = [bounds.min, bounds.max, cell.min, cell.max]
        .into_iter()
        .fold(Vec3::ZERO, |largest, corner| largest.max(corner.abs()));
    let largest = f64::from(largest.max_element());
    let (min, max) = (cell.min.to_array().map(f64::from), cell.max.to_array().map(f64::from));
    let center = [0, 1, 2].map(|i| 0.5 * (min[i] + max[i]));
    let half = [0, 1, 2].map(|i| 0.5 * (max[i] - min[i]) + ROUNDING * largest);
    let [a, b, c] = corners.map(|corner| {
        let corner = corner.to_array().map(f64::from);
        [0, 1, 2].map(|i| corner[i] - center[i])
    });
    let edge = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|i| to[i] - from[i]);
    let edges = [edge(a, b), edge(b, c), edge(c, a)];

    // The triangle's plane.
    let [e, f, _] = edges;
    let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let distance = normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2];
    let reach = normal[0].abs() * half[0] + normal[1].abs() * half[1] + normal[2].abs() * half[2];
    if distance.abs() > reach + PLANE_ROUNDING * length(e) * length(f) * largest {
        return false;
    }

    // The products of edges and axes. Both ends of an edge lie equally far along its own: the first of them and the corner
    // across will do.
    let ends = [(a, c), (b, a), (c, b)];
    edges.into_iter().zip(ends).all(|(edge, (from, across))| {
        [(1, 2), (2, 0), (0, 1)].into_iter().all(|(i, j)| {
            let along = |p: [f64; 3]| edge[i] * p[j] - edge[j] * p[i];
            let (from, across) = (along(from), along(across));
            let reach = edge[i].abs() * half[j] + edge[j].abs() * half[i];
            from.min(across) <= reach && -reach <= from.max(across)
        })
    })
}

/// The largest coordinate's absolute value.
fn length(edge: [f64; 3]) -> f64 {
    edge[0].abs().max(edge[1].abs()).max(edge[2].abs())
}
