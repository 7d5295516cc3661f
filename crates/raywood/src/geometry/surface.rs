//! The point that a ray hit, and the rays that start there.

use crate::{Ray, Vec3};

/// The clearance of a spawned ray per unit of a triangle's largest coordinate: 12 roundings. The position is off by at most
/// 9 of them along the normal, and the next ray's test of the triangle is exact where it matters: `docs/numerics.md`.
const TRIANGLE_CLEARANCE: f32 = 6.0 * f32::EPSILON;

/// The same of discs, capsules, cylinders and boxes, per unit of their largest coordinate: 20 roundings. The position is off by less than 2 of them, and what is left is
/// more than a ray falls by over any straight part of the surface if its direction or the normal is off by 4 roundings.
pub(super) const ROUND_CLEARANCE: f32 = 10.0 * f32::EPSILON;

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
    /// The point `(1-u-v) p0 + u p1 + v p2` of the triangle with these corners. Without branches and calls, so that a loop over many becomes
    /// vectors.
    #[inline(always)]
    pub fn on_triangle([p0, p1, p2]: [Vec3; 3], u: f32, v: f32) -> Self {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let largest = p0.abs().max(p1.abs()).max(p2.abs());
        Self {
            position: (1.0 - u - v) * p0 + u * p1 + v * p2,
            normal: unit_normal([p0, p1, p2]),
            clearance: TRIANGLE_CLEARANCE * larger(larger(largest.x, largest.y), largest.z),
        }
    }

    /// The point of a sphere that lies on the ray `origin + t * direction`, or nearest to what rounding leaves of it.
    #[inline(always)]
    pub fn on_sphere(center: Vec3, radius: f32, origin: Vec3, direction: Vec3, t: f32) -> Self {
        // The point on the ray is as wrong as the ray is long; pushed onto the sphere it is as exact as the radius.
        let outwards =
            |o: f32, d: f32, c: f32| f64::from(o) + f64::from(t) * f64::from(d) - f64::from(c);
        let n = [
            outwards(origin.x, direction.x, center.x),
            outwards(origin.y, direction.y, center.y),
            outwards(origin.z, direction.z, center.z),
        ];
        let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let n = [n[0] / length, n[1] / length, n[2] / length];
        let place = |c: f32, n: f64| (f64::from(c) + n * f64::from(radius)) as f32;
        Self {
            position: Vec3::new(
                place(center.x, n[0]),
                place(center.y, n[1]),
                place(center.z, n[2]),
            ),
            normal: Vec3::new(n[0] as f32, n[1] as f32, n[2] as f32),
            clearance: 4.0 * f32::EPSILON * (center.abs().max_element() + radius),
        }
    }

    /// A ray from this point along `direction` that does not hit the surface it starts on.
    ///
    /// The origin is moved off the surface to the side that `direction` points to, by a distance that follows from
    /// the coordinates' size, never by a fixed epsilon.
    #[inline]
    pub fn spawn(&self, direction: impl Into<[f32; 3]>) -> Ray {
        let direction = Vec3::from(direction.into());
        Ray::new(self.origin_towards(direction), direction)
    }

    /// A ray from this point towards `target`, where `t` is 1, that hits neither the surface it starts on nor one that the target lies
    /// on: it ends [a little before](Ray::short_of).
    #[inline]
    pub fn spawn_towards(&self, target: impl Into<[f32; 3]>) -> Ray {
        let target = Vec3::from(target.into());
        Ray::short_of(self.origin_towards(target - self.position), target)
    }

    /// Where rays start that leave this point to the side that `direction` points to: for whoever sends many.
    #[inline(always)]
    pub fn origin_towards(&self, direction: impl Into<[f32; 3]>) -> Vec3 {
        self.offset(Vec3::from(direction.into()).dot(self.normal))
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

/// The unit normal of a triangle, zero if it has no area. In double precision, where the product of two tiny or huge edges neither vanishes
/// nor overflows and slivers keep their direction.
#[inline(always)]
fn unit_normal(corners: [Vec3; 3]) -> Vec3 {
    // No `map` of arrays, which the compiler does not always inline.
    let [p0, p1, p2] = corners;
    let difference = |a: f32, b: f32| f64::from(a) - f64::from(b);
    let edge = |p: Vec3| [difference(p.x, p0.x), difference(p.y, p0.y), difference(p.z, p0.z)];
    let (a, b) = (edge(p1), edge(p2));
    let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    if length > 0.0 {
        Vec3::new((n[0] / length) as f32, (n[1] / length) as f32, (n[2] / length) as f32)
    } else {
        Vec3::ZERO
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
