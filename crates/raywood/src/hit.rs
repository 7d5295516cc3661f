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
