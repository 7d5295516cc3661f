//! Distances by brute force in double precision: Ericson, "Real-Time Collision Detection", 2005, section 5.1.5, which divides space by the feature that
//! is closest, with care for triangles without area.

use raywood::{TriangleMesh, Vec3};

use crate::oracle::{Point, cross, dot, double, length, sub};

/// The distance of a point from a triangle.
pub fn to_triangle(point: Vec3, corners: [Vec3; 3]) -> f64 {
    let p = double(point);
    of_triangle(corners.map(|corner| sub(double(corner), p)))
}

/// The distance of zero from a triangle.
pub fn of_triangle([a, b, c]: [Point; 3]) -> f64 {
    let normal = cross(sub(b, a), sub(c, a));
    let inside = |from: Point, to: Point| dot(cross(from, to), normal) > 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return dot(a, normal).abs() / length(normal);
    }
    [to_segment(a, b), to_segment(b, c), to_segment(c, a)].into_iter().fold(f64::INFINITY, f64::min)
}

/// The distance of zero from a segment.
fn to_segment(a: Point, b: Point) -> f64 {
    let edge = sub(b, a);
    let (from_start, from_end) = (-dot(a, edge), dot(b, edge));
    if from_start <= 0.0 {
        length(a)
    } else if from_end <= 0.0 {
        length(b)
    } else {
        length(cross(a, edge)) / length(edge)
    }
}

/// The least distance of a point from any triangle of a mesh; infinite if there is none.
pub fn to_mesh(point: Vec3, mesh: &TriangleMesh) -> f64 {
    (0..mesh.triangles().len() as u32)
        .map(|triangle| to_triangle(point, mesh.corners(triangle)))
        .fold(f64::INFINITY, f64::min)
}

/// How far single precision may be off a distance: one rounding of it, and what double precision loses of the coordinates.
pub fn tolerance(point: Vec3, mesh: &TriangleMesh, distance: f64) -> f64 {
    let bounds = mesh.total_bounds();
    let largest = point.abs().max(bounds.min.abs()).max(bounds.max.abs()).max_element();
    distance * f64::from(f32::EPSILON) + f64::from(largest) * 2f64.powi(-40) + 2f64.powi(-149)
}

/// How often a mesh goes around a point: the sum of the solid angles of all triangles.
pub fn winding_number(point: Vec3, mesh: &TriangleMesh) -> f64 {
    let p = double(point);
    let corners = |triangle: u32| mesh.corners(triangle).map(|corner| sub(double(corner), p));
    (0..mesh.triangles().len() as u32).map(|triangle| winding_of_triangle(corners(triangle))).sum()
}

/// The share of all directions from zero in which a triangle lies, with the sign of its side, by the tangent formula of its spherical excess.
pub fn winding_of_triangle(corners: [Point; 3]) -> f64 {
    let [a, b, c] = corners.map(|v| {
        let length = length(v);
        [v[0] / length, v[1] / length, v[2] / length]
    });
    let angle = 2.0 * dot(a, cross(b, c)).atan2(1.0 + dot(a, b) + dot(b, c) + dot(c, a));
    // At a corner there is no angle.
    if angle.is_nan() { 0.0 } else { angle / (4.0 * std::f64::consts::PI) }
}
