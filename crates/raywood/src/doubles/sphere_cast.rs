//! What a moving sphere touches first of a mesh of double precision.

use std::ops::ControlFlow;

use super::closest_point::DISPLACEMENT;
use super::{Bvh64, Ray64};
use crate::double::{Double3, add, dot, largest_magnitude, scale, sub};
use crate::geometry::swept_sphere;
use crate::{Aabb, parallel};

/// Where a moving sphere first touches a mesh of double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereHit64 {
    /// How far the sphere has moved, in units of the direction's length; `t_min <= t < t_max`.
    pub t: f64,
    /// Where it touches.
    pub point: [f64; 3],
    /// The direction from there to the sphere's centre, of unit length: the normal of the sphere's bounce. Zero where the centre itself lies on the
    /// surface.
    pub normal: [f64; 3],
    /// What it touches; at exactly equal `t` the lowest number wins.
    pub primitive: u32,
}

/// The rounding of coordinates in the frame, and of what is computed with them.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Bvh64 {
    /// What a sphere first touches whose centre moves along a ray: the least `t` of the ray's interval at which something is no further than `radius` from the
    /// centre; `t_min` where it overlaps something already. `None` if it touches nothing, and for invalid rays and a radius that is
    /// negative, NaN or beyond [`Ray64::GREATEST`].
    ///
    /// Triangles are solved as by [`Bvh::sphere_cast`](crate::Bvh::sphere_cast), seen from the ray's origin: so `t` is right to some roundings of the way from there, where the sphere grazes something to the square
    /// root of such. Boxes are looked at one by one, as of [`closest_point`](Self::closest_point).
    ///
    /// ```
    /// use raywood::{Bvh64, Ray64, TriangleMesh64};
    ///
    /// // A floor of some micrometres, a million metres away.
    /// let [x, e] = [1e6, 1.0 / 1048576.0];
    /// let floor = vec![[x, 0.0, 0.0], [x + 4.0 * e, 0.0, 0.0], [x, 4.0 * e, 0.0]];
    /// let bvh = Bvh64::build(TriangleMesh64::new(floor, vec![[0, 1, 2]])?)?;
    /// let ball = bvh.sphere_cast(&Ray64::new([x + e, e, 5.0 * e], [0.0, 0.0, -e]), 0.5 * e).expect("it lands");
    /// assert_eq!((ball.t, ball.point), (4.5, [x + e, e, 0.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sphere_cast(&self, ray: &Ray64, radius: f64) -> Option<SphereHit64> {
        if !(ray.is_valid() && (0.0..=Ray64::GREATEST).contains(&radius)) {
            return None;
        }
        let swept = Swept::of(ray, radius, self);
        let mut first: Option<SphereHit64> = None;
        let limit =
            |first: &Option<SphereHit64>| (first.map_or(ray.t_max, |hit| hit.t) as f32).next_up();
        // Before that it can touch nothing.
        let reach = 8.0 * Ray64::GREATEST / largest_magnitude(ray.direction);
        let t_min = ray.t_min.max(-reach);
        let _ = self.tree.visit_primitives(
            |bounds| swept.entry(bounds),
            |triangle| {
                let corners = self.mesh.corners(triangle).map(|corner| sub(corner, ray.origin));
                if let Some((t, point)) = swept_sphere(corners, ray.direction, radius, t_min) {
                    let is_first = match &first {
                        None => ray.t_min <= t && t < ray.t_max,
                        Some(hit) => (t, triangle) < (hit.t, hit.primitive),
                    };
                    if is_first {
                        first = Some(contact(ray, t, point, triangle));
                    }
                }
                ControlFlow::Continue(limit(&first))
            },
        );
        first
    }

    /// [`sphere_cast`](Self::sphere_cast) for many spheres of the same radius, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn sphere_cast_batch(&self, rays: &[Ray64], radius: f64, hits: &mut [Option<SphereHit64>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill(rays, hits, |ray| self.sphere_cast(ray, radius));
    }
}

/// A contact at `t`, at a point that is seen from the ray's origin.
fn contact(ray: &Ray64, t: f64, point: Double3, primitive: u32) -> SphereHit64 {
    let outwards = sub(scale(t, ray.direction), point);
    let length = dot(outwards, outwards).sqrt();
    let normal = if length > 0.0 { scale(1.0 / length, outwards) } else { [0.0; 3] };
    SphereHit64 { t, point: add(ray.origin, point), normal, primitive }
}

/// A moving sphere among the boxes of the tree, which stand in the frame.
struct Swept {
    origin: Double3,
    direction: Double3,
    /// How much larger boxes are, for the sphere and for what is rounded.
    radius: f64,
    t_min: f64,
    t_max: f64,
}

impl Swept {
    fn of(ray: &Ray64, radius: f64, bvh: &Bvh64) -> Self {
        let origin = bvh.frame.point(ray.origin);
        let radius = bvh.frame.length(radius);
        let rounding = DISPLACEMENT + ROUNDING * (largest_magnitude(origin) + radius + 1.0);
        let direction = ray.direction.map(|x| bvh.frame.length(x));
        let Ray64 { t_min, t_max, .. } = *ray;
        Self { origin, direction, radius: radius + rounding, t_min, t_max }
    }

    /// When the sphere may begin to touch a box at the earliest, rounded downwards; `None` if it does not.
    fn entry(&self, bounds: &Aabb) -> Option<f32> {
        let (mut entry, mut exit) = (self.t_min, self.t_max);
        for axis in 0..3 {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            let low = f64::from(bounds.min[axis]) - self.radius - origin;
            let high = f64::from(bounds.max[axis]) + self.radius - origin;
            if direction != 0.0 {
                let (a, b) = (low / direction, high / direction);
                entry = entry.max(a.min(b));
                exit = exit.min(a.max(b));
            } else if low > 0.0 || high < 0.0 {
                return None;
            }
        }
        let slack = ROUNDING * (entry.abs() + exit.abs());
        // Where both are infinite nothing is known of them.
        (entry <= exit + slack || slack.is_nan()).then(|| (entry as f32).next_down())
    }
}
