//! The triangle test of Möller and Trumbore (1997) for libraries that bring none that hits both sides.

use raywood::Vec3;

/// A triangle made ready: a corner and the two edges that start there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    corner: Vec3,
    edges: [Vec3; 2],
}

impl Corner {
    pub(super) fn new([p0, p1, p2]: [Vec3; 3]) -> Self {
        Self { corner: p0, edges: [p1 - p0, p2 - p0] }
    }

    /// The distance at which a ray hits the triangle from either side, infinite where it does not.
    #[inline(always)]
    pub(super) fn intersect(&self, origin: Vec3, direction: Vec3) -> f32 {
        let [e1, e2] = self.edges;
        let p = direction.cross(e2);
        let inverse = 1.0 / e1.dot(p);
        let s = origin - self.corner;
        let q = s.cross(e1);
        let (u, v) = (s.dot(p) * inverse, direction.dot(q) * inverse);
        let t = e2.dot(q) * inverse;
        // A triangle seen edge-on has weights that are NaN or infinite.
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 { t } else { f32::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_are_hit_and_edge_on_is_not() {
        let triangle = Corner::new([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let above = Vec3::new(0.25, 0.5, 2.0);
        assert_eq!(triangle.intersect(above, -Vec3::Z), 2.0);
        assert_eq!(triangle.intersect(-1.0 * above, Vec3::Z), f32::INFINITY);
        assert_eq!(triangle.intersect(Vec3::new(0.25, 0.5, -2.0), Vec3::Z), 2.0);
        assert_eq!(triangle.intersect(above, Vec3::Z), f32::INFINITY);
        assert_eq!(triangle.intersect(Vec3::new(0.75, 0.5, 2.0), -Vec3::Z), f32::INFINITY);
        assert_eq!(triangle.intersect(Vec3::new(-1.0, 0.25, 0.0), Vec3::X), f32::INFINITY);
    }
}
