//! The answer to a closest-hit query.

/// Where a ray first meets the geometry.
///
/// # Equally near hits
///
/// One rule holds for every query that names a primitive, in single and in double precision, for every structure, number of threads and level of instructions: of what is exactly as near, as distances are
/// told, the lowest instance is named, and of that the lowest primitive. So closest hits, contacts of moving spheres and closest points go by `(t, instance, primitive)`, or the distance instead of `t`;
/// lists of hits have all of them in this order; and what [options](crate::QueryOptions) leave out does not take part. "Exactly" means that the numbers are the same: two triangles that share an edge may see the same
/// ray hit it at distances that differ by a rounding, and then the nearer one is named.
///
/// The rule ends where distances are not those of single rays. Rays of a batch that travel together ([`agrees_with`](Self::agrees_with)) may name any of those that lie that close. In a [`Tlas`](crate::Tlas) an
/// object chooses among its own primitives by the distances in its own space, which may differ where those of the scene are one after rounding.
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
