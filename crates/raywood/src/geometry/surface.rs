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
    #[inline(always)]
    pub fn origin_towards(&self, direction: impl Into<Vec3>) -> Vec3 {
        self.offset(direction.into().dot(self.normal))
    }

    /// The position moved off the surface to the given side of the normal, each coordinate rounded away from it.
    #[inline(always)]
    fn offset(&self, side: f32) -> Vec3 {
        let n = if side < 0.0 { -self.normal } else { self.normal };
        let move_off = |p: f32, n: f32| next_towards(p + n * self.clearance, n);
        let p = self.position;
        Vec3::new(move_off(p.x, n.x), move_off(p.y, n.y), move_off(p.z, n.z))
    }
}

/// The next number on the side of a direction's sign; the number itself where that is zero. Unlike [`f32::next_up`] and [`f32::next_down`] without
/// branches, which would follow the normals' signs at random.
#[inline(always)]
fn next_towards(x: f32, direction: f32) -> f32 {
    let bits = x.to_bits();
    let outwards = (x > 0.0) == (direction > 0.0);
    let next = if outwards { bits.wrapping_add(1) } else { bits.wrapping_sub(1) };
    let next = if x == 0.0 { f32::from_bits(1).copysign(direction) } else { f32::from_bits(next) };
    if direction == 0.0 || !x.is_finite() { x } else { next }
}

#[cfg(test)]
mod tests {
    use super::next_towards;

    #[test]
    fn the_next_number_is_that_of_the_standard_library() {
        let numbers = [0.0, -0.0, 1e-45, -1e-45, f32::MIN_POSITIVE, 1.0, -1.0, 0.3, -7e30];
        for x in numbers.into_iter().chain([f32::MAX, f32::MIN]) {
            assert_eq!(next_towards(x, 0.5).to_bits(), x.next_up().to_bits(), "{x}");
            assert_eq!(next_towards(x, -0.5).to_bits(), x.next_down().to_bits(), "{x}");
            assert_eq!(next_towards(x, 0.0).to_bits(), x.to_bits());
            assert_eq!(next_towards(x, -0.0).to_bits(), x.to_bits());
        }
    }
}
