//! What a moving sphere touches first.

use crate::double::{Double3, add, dot, double, largest_magnitude, scale, single, sub};
use crate::geometry::swept_sphere;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::structures::wide::search::SearchStack;
use crate::structures::wide::sweep::Sweep;
use crate::{Bvh, Geometry, PreparedRay, Ray, Vec3, WideBvh, parallel};

/// Where a moving sphere first touches a geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereHit {
    /// How far the sphere has moved, in units of the direction's length; `t_min <= t < t_max`.
    pub t: f32,
    /// Where it touches.
    pub point: Vec3,
    /// The direction from there to the sphere's centre, of unit length: the normal of the sphere's bounce. Zero where the centre itself lies on the
    /// surface.
    pub normal: Vec3,
    /// What it touches; at exactly equal `t` the lowest number wins, of instances first the lowest of theirs.
    pub primitive: u32,
    /// Which instance of a scene; 0 where there are no instances.
    pub instance: u32,
}

impl<G: Geometry> Bvh<G> {
    /// What a sphere first touches whose centre moves along a ray: the least `t` of the ray's interval at which something is no further than `radius` from the
    /// centre; `t_min` where it overlaps something already. `None` if it touches nothing, and for invalid rays and a radius that is
    /// negative, infinite or NaN.
    ///
    /// Triangles are solved exactly, in double precision: `t` is right to some roundings, where the sphere grazes something to the square root of such. On its way from far
    /// away it is as exact as the ray. Other primitives are approached in steps by [`Geometry::closest_point`], until eight roundings of the coordinates are left.
    /// The same on all levels of instructions.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, TriangleMesh};
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]])?;
    /// let bvh = Bvh::build(&mesh)?;
    /// let ball = bvh.sphere_cast(&Ray::new([1.0, 1.0, 5.0], [0.0, 0.0, -1.0]), 0.5).expect("it lands");
    /// assert_eq!((ball.t, ball.point, ball.normal), (4.5, [1.0, 1.0, 0.0].into(), [0.0, 0.0, 1.0].into()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sphere_cast(&self, ray: &Ray, radius: f32) -> Option<SphereHit> {
        let prepared = PreparedRay::new(ray)?;
        if !(radius >= 0.0 && radius.is_finite()) {
            return None;
        }
        let (tree, geometry) = (&self.tree, &self.geometry);
        let cast = SphereCast { tree, geometry, ray: &prepared, radius };
        dispatch_on(tree.level(), cast)
    }

    /// [`sphere_cast`](Self::sphere_cast) for many spheres of the same radius, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn sphere_cast_batch(&self, rays: &[Ray], radius: f32, hits: &mut [Option<SphereHit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill(rays, hits, |ray| self.sphere_cast(ray, radius));
    }
}

/// Finds what a moving sphere touches first.
struct SphereCast<'a, G> {
    tree: &'a WideBvh,
    geometry: &'a G,
    ray: &'a PreparedRay,
    radius: f32,
}

impl<G: Geometry> Kernel for SphereCast<'_, G> {
    type Output = Option<SphereHit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<SphereHit> {
        let Self { tree, geometry, ray, radius } = self;
        let mut first = First::new(ray, radius);
        let mut sweep = Sweep::new(ray, [radius; 3], tree.reach(), |leaf, lane| {
            let primitive = leaf.block.primitives[lane];
            if leaf.others >> lane & 1 == 1 {
                first.approach(geometry, primitive);
            } else {
                first.test((0, primitive), leaf.block.corners(lane).map(double));
            }
            first.limit()
        });
        // It goes on to the end: what comes later may be touched earlier.
        let _ = tree.search(simd, &mut SearchStack::new(tree), &mut sweep);
        first.hit
    }
}

/// How many steps towards a primitive are made at most: more only where it is missed by next to nothing.
const STEPS: usize = 4096;

/// The first contact so far.
pub(crate) struct First<'a> {
    ray: &'a PreparedRay,
    radius: f32,
    pub(crate) hit: Option<SphereHit>,
}

impl<'a> First<'a> {
    pub(crate) fn new(ray: &'a PreparedRay, radius: f32) -> Self {
        Self { ray, radius, hit: None }
    }

    /// How far the sphere moves at most until it touches something.
    pub(crate) fn limit(&self) -> f32 {
        self.hit.map_or(self.ray.t_max, |hit| hit.t)
    }

    /// Beyond that nothing is as near, not even after it is rounded.
    fn end(&self) -> f64 {
        f64::from(self.limit().next_up())
    }

    /// Where the centre is at `t`.
    fn center(&self, t: f64) -> Double3 {
        add(double(self.ray.origin), scale(t, double(self.ray.direction)))
    }

    /// Compares a triangle, by the numbers of its instance and its own.
    #[inline(never)]
    pub(crate) fn test(&mut self, numbers: (u32, u32), [a, b, c]: [Double3; 3]) {
        let origin = double(self.ray.origin);
        let corners = [sub(a, origin), sub(b, origin), sub(c, origin)];
        let (direction, radius) = (double(self.ray.direction), f64::from(self.radius));
        let t_min = f64::from(self.ray.t_min.max(f32::MIN));
        if let Some((t, point)) = swept_sphere(corners, direction, radius, t_min) {
            self.offer(numbers, t, add(origin, point));
        }
    }

    /// Compares a primitive of which only the closest point can be told: steps as long as the sphere can certainly move.
    #[inline(never)]
    fn approach<G: Geometry>(&mut self, geometry: &G, primitive: u32) {
        let direction = double(self.ray.direction);
        let speed = dot(direction, direction).sqrt();
        let end = self.end();
        let mut t = f64::from(self.ray.t_min.max(f32::MIN));
        for _ in 0..STEPS {
            let center = single(self.center(t));
            if !(t <= end && center.is_finite()) {
                return;
            }
            let Some(closest) = geometry.closest_point(primitive, center) else { return };
            let gap = closest.distance - self.radius;
            let rounding = 4.0 * f32::EPSILON * (center.abs().max_element() + self.radius);
            if gap.is_nan() {
                return;
            }
            if gap <= rounding {
                return self.offer((0, primitive), t, double(closest.point));
            }
            t += f64::from(gap) / speed;
        }
    }

    /// The same of a primitive that stands somewhere: `offset` tells the way from a point to its closest, as far as it is known, and `largest` the largest coordinate that is rounded on that way.
    pub(crate) fn approach_placed(
        &mut self,
        numbers: (u32, u32),
        largest: f64,
        offset: impl Fn(Double3) -> Option<Double3>,
    ) {
        let direction = double(self.ray.direction);
        let (speed, radius) = (dot(direction, direction).sqrt(), f64::from(self.radius));
        let end = self.end();
        let mut t = f64::from(self.ray.t_min.max(f32::MIN));
        for _ in 0..STEPS {
            let center = self.center(t);
            if !(t <= end && single(center).is_finite()) {
                return;
            }
            let Some(offset) = offset(center) else { return };
            let gap = dot(offset, offset).sqrt() - radius;
            let size = largest_magnitude(center).max(largest) + radius;
            if gap.is_nan() {
                return;
            }
            if gap <= 4.0 * f64::from(f32::EPSILON) * size {
                return self.offer(numbers, t, add(center, offset));
            }
            t += gap / speed;
        }
    }

    fn offer(&mut self, (instance, primitive): (u32, u32), t: f64, point: Double3) {
        let rounded = t as f32;
        let is_first = match &self.hit {
            None => self.ray.accepts(rounded),
            Some(hit) => (rounded, instance, primitive) < (hit.t, hit.instance, hit.primitive),
        };
        if is_first {
            let outwards = sub(self.center(t), point);
            let length = dot(outwards, outwards).sqrt();
            let normal = if length > 0.0 { scale(1.0 / length, outwards) } else { [0.0; 3] };
            let (point, normal) = (single(point), single(normal));
            self.hit = Some(SphereHit { t: rounded, point, normal, primitive, instance });
        }
    }
}
