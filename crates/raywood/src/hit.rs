//! The answer to a closest-hit query.

/// Where a ray first meets the geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Distance along the ray, in units of the direction's length; `t_min <= t < t_max`.
    pub t: f32,
    /// First surface coordinate. On a triangle the barycentric weight of `p1`: `p = (1-u-v) p0 + u p1 + v p2`.
    /// What it is on other primitives is said by their geometry.
    pub u: f32,
    /// Second surface coordinate. On a triangle the barycentric weight of `p2`.
    pub v: f32,
    /// Which primitive of the geometry; at exactly equal `t` the lowest number wins.
    pub primitive: u32,
    /// Which instance of a scene; 0 where there are no instances.
    pub instance: u32,
}

impl Hit {
    /// Distances that are told by different kernels, or by packets of different rays, differ by less than this share of themselves.
    pub const DISTANCE_TOLERANCE: f32 = 1.0 / 1024.0;

    /// Whether two answers to the same ray mean the same hit: at the same distance within [`DISTANCE_TOLERANCE`](Self::DISTANCE_TOLERANCE).
    ///
    /// Single rays are answered with the same numbers by every structure. Rays of a batch that share their origin are traced in packets, which round
    /// differently: usually in the last digits, and where two primitives lie that close either may be named.
    pub fn agrees_with(&self, other: &Self) -> bool {
        let greatest = self.t.abs().max(other.t.abs());
        (self.t - other.t).abs() <= Self::DISTANCE_TOLERANCE * greatest + f32::MIN_POSITIVE
    }
}

/// What hits of single and of double precision have in common: that they can be put in order.
pub(crate) trait RayHit: Copy {
    /// A distance along a ray.
    type Distance: Copy + PartialOrd;

    /// How far along the ray.
    fn distance(&self) -> Self::Distance;

    /// Which instance is hit, and which primitive.
    fn numbers(&self) -> (u32, u32);
}

impl RayHit for Hit {
    type Distance = f32;

    #[inline(always)]
    fn distance(&self) -> f32 {
        self.t
    }

    #[inline(always)]
    fn numbers(&self) -> (u32, u32) {
        (self.instance, self.primitive)
    }
}
