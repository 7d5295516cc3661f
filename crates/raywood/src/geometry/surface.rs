//! The point that a ray hit, and the rays that start there.

use crate::{Ray, Vec3};

/// A point on a surface, with a bound on how far off it may be: what the next ray starts from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where the point lies.
    pub position: Vec3,
    /// The geometric normal: unit length, on the side that the primitive's own orientation gives
    /// (`(p1-p0) x (p2-p0)` of a triangle). Zero on a primitive without area.
    pub normal: Vec3,
    /// How far a new ray must start from [`position`](Self::position) along the normal so that rounding, in the
    /// position and in the next intersection test, cannot bring it back to the same surface. A length, positive.
    pub clearance: f32,
}

impl SurfacePoint {
    /// A ray from this point along `direction` that does not hit the surface it starts on.
    ///
    /// The origin is moved off the surface to the side that `direction` points to, by a distance that follows from
    /// the coordinates' size, never by a fixed epsilon.
    #[inline]
    pub fn spawn(&self, direction: impl Into<Vec3>) -> Ray {
        let direction = direction.into();
        Ray::new(self.origin_towards(direction), direction)
    }

    /// A ray from this point towards `target`, where `t` is 1, that hits neither the surface it starts on nor one that the target lies
    /// on: it ends [a little before](Ray::short_of).
    #[inline]
    pub fn spawn_towards(&self, target: impl Into<Vec3>) -> Ray {
        let target = target.into();
        Ray::short_of(self.origin_towards(target - self.position), target)
    }

    /// Where rays start that leave this point to the side that `direction` points to: for whoever sends many.
    #[inline]
    pub fn origin_towards(&self, direction: impl Into<Vec3>) -> Vec3 {
        self.offset(direction.into().dot(self.normal))
    }

    /// The position moved off the surface to the given side of the normal, each coordinate rounded away from it.
    #[inline]
    fn offset(&self, side: f32) -> Vec3 {
        let n = if side < 0.0 { -self.normal } else { self.normal };
        let move_off = |p: f32, n: f32| {
            let moved = p + n * self.clearance;
            if n > 0.0 {
                moved.next_up()
            } else if n < 0.0 {
                moved.next_down()
            } else {
                moved
            }
        };
        let p = self.position;
        Vec3::new(move_off(p.x, n.x), move_off(p.y, n.y), move_off(p.z, n.z))
    }
}
