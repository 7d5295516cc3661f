//! The ray-triangle test of double precision: that of `geometry/watertight.rs`, one precision up.
//!
//! Plain double precision answers where its errors are certainly small enough, for the side of an edge as for a distance. What is left is computed from the
//! original numbers with twice the digits, and signs of these exactly, so that triangles that share an edge agree about it.

use super::twofold::{Twofold, cross, difference_of_products, dot};
use super::twofold::{sign_between, sign_of_difference};
use super::{Hit64, Ray64};
use crate::double::Double3;
use crate::{SimdLevel, Vectorized};

/// As in single precision: an edge function's error is at most this times the triangle's reach across the ray times its reach in all.
const EDGE_ERROR: f64 = 8.0 * f64::EPSILON;

/// The error of the normal's product with a vector is at most this times the longest edges times the sum of the vector's coordinates.
const NORMAL_ERROR: f64 = 8.0 * f64::EPSILON;

/// Distances and weights that plain double precision may have wrong by more than this share are computed again: 2^-40, about 9e-13.
const TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

/// The axes in an order in which the last is the direction's largest and the triangle's orientation is kept: see [`PreparedRay`](crate::PreparedRay).
static AXES: [[usize; 3]; 6] = [[1, 2, 0], [2, 1, 0], [2, 0, 1], [0, 2, 1], [0, 1, 2], [1, 0, 2]];

/// A valid [`Ray64`] together with what depends on it alone. Coordinates are in the order of its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRay64 {
    origin: Double3,
    direction: Double3,
    /// How much the first two coordinates grow per last one.
    slopes: [f64; 2],
    pub(crate) t_min: f64,
    pub(crate) t_max: f64,
    axes: [usize; 3],
    level: SimdLevel,
}

/// A triangle as a ray sees it.
struct Seen {
    /// The corners in the order of the ray's axes.
    corners: [Double3; 3],
    /// The first corner relative to the ray's origin.
    first: Double3,
    /// The edge functions: twice the areas that the ray spans with the edges opposite of each corner.
    edges: [f64; 3],
    /// What the edge functions may be off by.
    edge_error: f64,
}

/// What a triangle's plane is to a ray, as plain double precision sees it.
struct Crossed {
    distance: f64,
    error: f64,
}

impl PreparedRay64 {
    /// Prepares a valid ray. What is computed does not depend on the level of instructions, only how fast it is.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray64, level: SimdLevel) -> Self {
        let (o, d) = (&ray.origin, &ray.direction);
        let [dx, dy, dz] = [d[0].abs(), d[1].abs(), d[2].abs()];
        let main = usize::from(!(dx >= dy && dx >= dz)) * (1 + usize::from(dy < dz));
        let axes = AXES[2 * main + usize::from(d[main] < 0.0)];
        let [x, y, z] = axes;
        let direction = [d[x], d[y], d[z]];
        Self {
            origin: [o[x], o[y], o[z]],
            direction,
            slopes: [direction[0] / direction[2], direction[1] / direction[2]],
            t_min: ray.t_min,
            t_max: ray.t_max,
            axes,
            level,
        }
    }

    /// Where the ray hits a triangle, edges and vertices included, if it does so within its interval and not beyond `limit`. The distance depends on the ray and the triangle
    /// alone.
    #[inline(always)]
    pub(crate) fn hit_distance(&self, corners: [Double3; 3], limit: f64) -> Option<f64> {
        self.distance::<false>(corners, limit)
    }

    /// The same, but of the triangles around an edge or a vertex that the ray passes through one of those in front is hit and one of those behind, as by `cross_triangle` of single precision.
    #[inline(always)]
    pub(crate) fn crossing_distance(&self, corners: [Double3; 3], limit: f64) -> Option<f64> {
        self.distance::<true>(corners, limit)
    }

    /// Where the ray hits a triangle; with `ONCE` as a [crossing](Self::crossing_distance).
    #[inline(always)]
    fn distance<const ONCE: bool>(&self, corners: [Double3; 3], limit: f64) -> Option<f64> {
        let seen = self.see(corners);
        let [e0, e1, e2] = seen.edges;
        let least = smaller(smaller(e0, e1), e2);
        let greatest = larger(larger(e0, e1), e2);
        if least < -seen.edge_error && greatest > seen.edge_error {
            return None;
        }
        // Most that are asked for are hit, but elsewhere.
        let crossed = self.crossed(&seen);
        if self.is_elsewhere(&crossed, limit) {
            return None;
        }
        let certain = least > seen.edge_error || greatest < -seen.edge_error;
        if !(certain || self.level.run(Inside::<ONCE> { ray: self, corners: &seen.corners })) {
            return None;
        }
        let t = self.certain_distance(&seen, &crossed)?;
        (self.t_min <= t && t < self.t_max).then_some(t)
    }

    /// The hit with a triangle that the ray is known to hit at that distance.
    #[inline(always)]
    pub(crate) fn hit_at(&self, t: f64, primitive: u32, corners: [Double3; 3]) -> Hit64 {
        let [x, y, z] = self.axes;
        let [p, q, r] = corners;
        let (u, v) = self.weights(t, [[p[x], p[y], p[z]], [q[x], q[y], q[z]], [r[x], r[y], r[z]]]);
        Hit64 { t, u, v, primitive }
    }

    /// Whether a ray that hits a triangle meets its front: the side that its normal `(p1-p0) x (p2-p0)` points to.
    pub(crate) fn meets_front(&self, corners: [Double3; 3]) -> bool {
        let [x, y, z] = self.axes;
        let corners = corners.map(|p| [p[x], p[y], p[z]]);
        let rise = self.level.run(Rise { ray: self, corners: &corners });
        // Where the ray runs backwards along its last axis, the order of the axes mirrors space.
        if self.direction[2] < 0.0 { rise > 0.0 } else { rise < 0.0 }
    }

    /// The hit with a triangle that the ray is known to hit within its interval; `None` of one that is seen edge-on after all.
    #[inline(always)]
    pub(crate) fn known_hit(&self, primitive: u32, corners: [Double3; 3]) -> Option<Hit64> {
        let t = self.known_distance(corners)?;
        Some(self.hit_at(t, primitive, corners))
    }

    /// The distance of a triangle that the ray is known to hit within its interval.
    #[inline(always)]
    pub(crate) fn known_distance(&self, corners: [Double3; 3]) -> Option<f64> {
        let seen = self.see(corners);
        self.certain_distance(&seen, &self.crossed(&seen))
    }

    #[inline(always)]
    fn see(&self, corners: [Double3; 3]) -> Seen {
        let [x, y, z] = self.axes;
        let corners = [
            [corners[0][x], corners[0][y], corners[0][z]],
            [corners[1][x], corners[1][y], corners[1][z]],
            [corners[2][x], corners[2][y], corners[2][z]],
        ];
        let (a, b, c) = (self.moved(corners[0]), self.moved(corners[1]), self.moved(corners[2]));
        let (sa, sb, sc) = (self.sheared(a), self.sheared(b), self.sheared(c));
        let edges = [
            sc[0] * sb[1] - sc[1] * sb[0],
            sa[0] * sc[1] - sa[1] * sc[0],
            sb[0] * sa[1] - sb[1] * sa[0],
        ];
        let reach = larger(
            largest_of_three([sa[0], sa[1], sb[0]]),
            largest_of_three([sb[1], sc[0], sc[1]]),
        );
        let along = larger(larger(a[2].abs(), b[2].abs()), c[2].abs());
        let edge_error = EDGE_ERROR * reach * (reach + along);
        Seen { corners, first: a, edges, edge_error }
    }

    /// A point relative to the origin.
    #[inline(always)]
    fn moved(&self, p: Double3) -> Double3 {
        [p[0] - self.origin[0], p[1] - self.origin[1], p[2] - self.origin[2]]
    }

    /// Where a vector leads across the ray.
    #[inline(always)]
    fn sheared(&self, p: Double3) -> [f64; 2] {
        [p[0] - self.slopes[0] * p[2], p[1] - self.slopes[1] * p[2]]
    }

    /// Where the ray crosses the triangle's plane, and how far off that may be; infinitely far where the ray runs along the plane as far as can be told.
    #[inline(always)]
    fn crossed(&self, seen: &Seen) -> Crossed {
        let [p0, p1, p2] = &seen.corners;
        let e = [p1[0] - p0[0], p1[1] - p0[1], p1[2] - p0[2]];
        let f = [p2[0] - p0[0], p2[1] - p0[1], p2[2] - p0[2]];
        let normal =
            [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let height = product(normal, seen.first);
        let rise = product(normal, self.direction);
        let size = NORMAL_ERROR * largest_of_three(e) * largest_of_three(f);
        let height_error = size * sum_of_sizes(seen.first);
        let rise_error = size * sum_of_sizes(self.direction);
        let reciprocal = 1.0 / rise;
        let distance = height * reciprocal;
        // The true rise is more than half of it then. Else nothing is known, and neither is where that is NaN.
        let error = match 2.0 * rise_error < rise.abs() {
            true => 2.0 * (height_error + distance.abs() * rise_error) * reciprocal.abs(),
            false => f64::INFINITY,
        };
        Crossed { distance, error }
    }

    /// Whether a hit lies outside of the ray's interval or beyond the limit, beyond all doubt.
    #[inline(always)]
    fn is_elsewhere(&self, crossed: &Crossed, limit: f64) -> bool {
        let error = crossed.error + crossed.distance.abs() * TOLERANCE;
        crossed.distance + error < self.t_min || limit < crossed.distance - error
    }

    /// The distance of a triangle that the ray is known to meet.
    #[inline(always)]
    fn certain_distance(&self, seen: &Seen, crossed: &Crossed) -> Option<f64> {
        if crossed.error <= TOLERANCE * crossed.distance.abs() {
            return Some(crossed.distance);
        }
        self.level.run(Distance { ray: self, corners: &seen.corners })
    }

    /// The weights of the second and the third corner, at a distance from the ray's origin.
    ///
    /// The origin is brought next to the triangle first, with both halves of what rounding divides: from there plain double precision is as good as the
    /// triangle's shape. That the distance is off does not matter, for what is along the ray does not count.
    #[inline(always)]
    fn weights(&self, t: f64, corners: [Double3; 3]) -> (f64, f64) {
        let [p0, p1, p2] = corners;
        let near = [self.near(t, p0, 0), self.near(t, p0, 1), self.near(t, p0, 2)];
        let e = [p1[0] - p0[0], p1[1] - p0[1], p1[2] - p0[2]];
        let f = [p2[0] - p0[0], p2[1] - p0[1], p2[2] - p0[2]];
        let along = larger(larger(e[2].abs(), f[2].abs()), near[2].abs());
        let (r, e, f) = (self.sheared(near), self.sheared(e), self.sheared(f));
        let determinant = e[0] * f[1] - e[1] * f[0];
        let reach =
            larger(largest_of_three([r[0], r[1], e[0]]), largest_of_three([e[1], f[0], f[1]]));
        if 2.0 * EDGE_ERROR * reach * (reach + along) <= TOLERANCE * determinant.abs() {
            let reciprocal = 1.0 / determinant;
            let u = (r[0] * f[1] - r[1] * f[0]) * reciprocal;
            let v = (e[0] * r[1] - e[1] * r[0]) * reciprocal;
            return (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
        }
        self.level.run(Weights { ray: self, corners: &corners })
    }

    /// A coordinate of the point at a distance, relative to a point close to it.
    #[inline(always)]
    fn near(&self, t: f64, point: Double3, axis: usize) -> f64 {
        let way = Twofold::product(t, self.direction[axis]);
        let there = Twofold::difference(self.origin[axis], -way.high);
        (there.high - point[axis]) + (there.low + way.low)
    }

    /// A corner as it lies across the ray, times the direction's last coordinate. It depends on the corner and the ray alone, so that neighbours agree.
    #[inline(always)]
    fn picture(&self, p: &Double3) -> [Twofold; 2] {
        let at = |axis: usize| Twofold::difference(p[axis], self.origin[axis]);
        let [dx, dy, dz] = self.direction;
        let z = at(2);
        [at(0) * dz - z * dx, at(1) * dz - z * dy]
    }
}

/// Whether the ray passes inside of a triangle or through its edges, by exact signs in a picture of twice the digits; with `ONCE` where the ray, moved aside by next to nothing, passes inside.
struct Inside<'a, const ONCE: bool> {
    ray: &'a PreparedRay64,
    corners: &'a [Double3; 3],
}

impl<const ONCE: bool> Vectorized for Inside<'_, ONCE> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let [a, b, c] = self.corners.each_ref().map(|p| self.ray.picture(p));
        let side = |p: [Twofold; 2], q: [Twofold; 2]| {
            let sign = sign_of_difference(p[0], q[1], p[1], q[0]);
            // The ray moved by `e` along x and `e^2` along y adds `e (p.y - q.y) + e^2 (q.x - p.x)`.
            match sign {
                0 if ONCE => match sign_between(p[1], q[1]) {
                    0 => sign_between(q[0], p[0]),
                    sign => sign,
                },
                sign => sign,
            }
        };
        let sides = [side(c, b), side(a, c), side(b, a)];
        if ONCE {
            // Still zero where two corners are seen as one.
            return sides == [1; 3] || sides == [-1; 3];
        }
        // All zero: it is seen edge-on, or has no area.
        let some = |sign: i32| sides.contains(&sign);
        some(1) != some(-1)
    }
}

/// The distance of a triangle that the ray meets, with twice the digits.
struct Distance<'a> {
    ray: &'a PreparedRay64,
    corners: &'a [Double3; 3],
}

impl Vectorized for Distance<'_> {
    type Output = Option<f64>;

    #[inline(always)]
    fn run(self) -> Option<f64> {
        let Self { ray, corners: [p0, p1, p2] } = self;
        let normal = normal(self.corners);
        let height = dot(normal, between(p0, &ray.origin));
        let [dx, dy, dz] = ray.direction;
        let rise = normal[0] * dx + normal[1] * dy + normal[2] * dz;
        if rise.high == 0.0 {
            return None;
        }

        // Of a triangle that is all but edge-on not even twice the digits tell where it is met, but it is inside of its own box.
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (a, b, c) = (p0[axis], p1[axis], p2[axis]);
            let to = |plane: f64| (plane - ray.origin[axis]) / ray.direction[axis];
            let [one, other] = [to(a.min(b).min(c)), to(a.max(b).max(c))];
            // NaN, of a ray along a side of the box, bounds nothing.
            near = near.max(one.min(other));
            far = far.min(one.max(other));
        }
        let room = |t: f64| t.abs() * (4.0 * f64::EPSILON);
        let t = height.ratio(rise);
        Some(t.max(near - room(near)).min(far + room(far)))
    }
}

/// How fast a ray rises above a triangle's plane, times the normal's length: with twice the digits, so that its sign is right.
struct Rise<'a> {
    ray: &'a PreparedRay64,
    corners: &'a [Double3; 3],
}

impl Vectorized for Rise<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let [dx, dy, dz] = self.ray.direction;
        let normal = normal(self.corners);
        (normal[0] * dx + normal[1] * dy + normal[2] * dz).high
    }
}

/// The normal of a triangle, as long as twice its area.
#[inline(always)]
fn normal([p0, p1, p2]: &[Double3; 3]) -> [Twofold; 3] {
    cross(between(p1, p0), between(p2, p0))
}

/// The difference of two points.
#[inline(always)]
fn between(p: &Double3, q: &Double3) -> [Twofold; 3] {
    [0, 1, 2].map(|axis| Twofold::difference(p[axis], q[axis]))
}

/// The weights of the second and the third corner of a triangle that the ray meets, with twice the digits.
struct Weights<'a> {
    ray: &'a PreparedRay64,
    corners: &'a [Double3; 3],
}

impl Vectorized for Weights<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn run(self) -> (f64, f64) {
        let [a, b, c] = self.corners.each_ref().map(|p| self.ray.picture(p));
        let side =
            |p: [Twofold; 2], q: [Twofold; 2]| difference_of_products(p[0], q[1], p[1], q[0]);
        let edges = [side(c, b), side(a, c), side(b, a)];
        let sum = edges[0] + edges[1] + edges[2];
        let weight = |edge: Twofold| edge.ratio(sum).clamp(0.0, 1.0);
        (weight(edges[1]), weight(edges[2]))
    }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn largest_of_three([a, b, c]: Double3) -> f64 {
    larger(larger(a.abs(), b.abs()), c.abs())
}

#[inline(always)]
fn sum_of_sizes([a, b, c]: Double3) -> f64 {
    a.abs() + b.abs() + c.abs()
}

#[inline(always)]
fn product(a: Double3, b: Double3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
