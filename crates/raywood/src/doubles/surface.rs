//! The point of a mesh of double precision that a ray hit, and the rays that start there.

use super::Ray64;
use crate::double::{Double3, add, cross, dot, scale, sub};

/// The clearance of a spawned ray per unit of a triangle's largest coordinate: 12 roundings, where the position is off by at most 9 along the normal.
const CLEARANCE: f64 = 6.0 * f64::EPSILON;

/// A point on a surface in double precision, with a bound on how far off it may be: what the next ray starts from. As a
/// [`SurfacePoint`](crate::SurfacePoint).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint64 {
    /// Where the point lies.
    pub position: [f64; 3],
    /// The geometric normal: unit length, on the side of `(p1-p0) x (p2-p0)`. Zero on a triangle without area.
    pub normal: [f64; 3],
    /// How far a new ray must start from [`position`](Self::position) along the normal so that rounding cannot bring it back to the same surface. A length,
    /// positive.
    pub clearance: f64,
}

impl SurfacePoint64 {
    /// The point `(1-u-v) p0 + u p1 + v p2` of a triangle whose largest coordinate is `largest`.
    pub(super) fn on_triangle([p0, p1, p2]: [Double3; 3], largest: f64, u: f64, v: f64) -> Self {
        let (e, f) = (sub(p1, p0), sub(p2, p0));
        let normal = cross(e, f);
        let length = dot(normal, normal).sqrt();
        Self {
            position: add(p0, add(scale(u, e), scale(v, f))),
            normal: if length > 0.0 { scale(1.0 / length, normal) } else { [0.0; 3] },
            clearance: CLEARANCE * largest,
        }
    }

    /// A ray from this point along `direction` that does not hit the surface it starts on: its origin is moved off the surface to the side that
    /// `direction` points to, by a distance that follows from the coordinates' size, never by a fixed epsilon.
    pub fn spawn(&self, direction: [f64; 3]) -> Ray64 {
        Ray64::new(self.origin_towards(direction), direction)
    }

    /// A ray from this point towards `target`, where `t` is 1, that hits neither the surface it starts on nor one that the target lies on: it ends
    /// [a little before](Ray64::short_of).
    pub fn spawn_towards(&self, target: [f64; 3]) -> Ray64 {
        Ray64::short_of(self.origin_towards(sub(target, self.position)), target)
    }

    /// Where rays start that leave this point to the side that `direction` points to.
    pub fn origin_towards(&self, direction: [f64; 3]) -> [f64; 3] {
        let side = if dot(direction, self.normal) < 0.0 { -1.0 } else { 1.0 };
        // Each coordinate is rounded away from the surface.
        [0, 1, 2].map(|axis| {
            let off = side * self.normal[axis] * self.clearance;
            let moved = self.position[axis] + off;
            match off {
                off if off > 0.0 => moved.next_up(),
                off if off < 0.0 => moved.next_down(),
                _ => moved,
            }
        })
    }
}
