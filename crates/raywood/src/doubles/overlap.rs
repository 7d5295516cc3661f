//! Which triangles of a mesh of double precision touch a region of space.

// Regions are sealed: how a search asks them is nobody else's business, although it is part of their trait.
#![allow(private_interfaces, private_bounds)]

use std::ops::ControlFlow;

use super::closest_point::{DISPLACEMENT, ROUNDINGS, distance_of_box};
use super::{Bvh64, LocalFrame, Ray64};
use crate::double::{Double3, dot, largest_magnitude, sub};
use crate::geometry::{
    TOUCH_SLACK, closest_to_zero, frustum_faces, is_left_of, triangles_touch_in_double,
};
use crate::{Aabb, parallel};

/// A region of space that triangles of double precision can touch: an [`Aabb64`], a [`Ball64`], a [`Frustum64`] or a triangle, `[[f64; 3]; 3]`. What each counts as touching is said with it.
///
/// Regions are solid: what lies inside touches them. A region that is empty, or not made of finite numbers where it says so, is touched by nothing.
pub trait Region64: Sync + Prepare {}

/// An axis-aligned box in double precision, corners included, as a [`Region64`].
///
/// What touches it are the triangles with a point in it: where a corner of theirs is one, exactly those; else within a few roundings of the triangle's size. It may reach to infinity; if it is empty
/// or has NaN nothing touches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb64 {
    /// The smallest coordinates.
    pub min: [f64; 3],
    /// The largest coordinates.
    pub max: [f64; 3],
}

/// All points no further from a centre than a radius, in double precision, as a [`Region64`].
///
/// What touches it are the triangles whose [closest point](Bvh64::closest_point) is no further away, as that distance is told. The radius may be zero or infinite; with one that is negative or NaN, or a
/// centre that is not finite, the ball is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball64 {
    /// The centre.
    pub center: [f64; 3],
    /// The radius.
    pub radius: f64,
}

/// The space between six planes in double precision, such as what a camera sees, as a [`Region64`].
///
/// What touches it are the triangles with a point in it, within a few roundings of the triangle's size and of its distance from the points that the planes are known by. If a number of it is not finite nothing
/// touches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum64 {
    /// Of each plane the normal, inwards, and a point on it: far from zero an offset would lose the digits that such a point keeps.
    planes: [(Double3, Double3); 6],
}

impl Aabb64 {
    /// The box with the given corners.
    pub fn new(min: [f64; 3], max: [f64; 3]) -> Self {
        Self { min, max }
    }
}

impl Ball64 {
    /// The ball with the given centre and radius.
    pub fn new(center: [f64; 3], radius: f64) -> Self {
        Self { center, radius }
    }
}

impl Frustum64 {
    /// The space on the inner side of six planes, each given by its normal, inwards, of any length, and by one of its points.
    pub fn from_planes(planes: [([f64; 3], [f64; 3]); 6]) -> Self {
        Self { planes }
    }

    /// The frustum with the given corners: four around its front, and behind them, in the same order, four around its back. Each face is the plane along both
    /// of its diagonals, so corners should lie in one.
    pub fn from_corners(corners: [[f64; 3]; 8]) -> Self {
        Self { planes: frustum_faces(corners) }
    }
}

impl Region64 for Aabb64 {}
impl Region64 for Ball64 {}
impl Region64 for Frustum64 {}

/// A triangle by its corners. What touches it are the triangles that have a point in common with it, within `2^-40` of the largest coordinate as they are seen from its first corner: of their sizes, however far from zero they
/// lie. If a corner is not finite nothing touches it.
impl Region64 for [[f64; 3]; 3] {}

/// What makes a region ready for a search.
pub(super) trait Prepare {
    /// The region as the search asks it; `None` if nothing touches it.
    #[doc(hidden)]
    fn prepare(&self) -> Option<Prepared>;
}

impl Prepare for Aabb64 {
    fn prepare(&self) -> Option<Prepared> {
        let Self { min, max } = *self;
        // NaN is not less or equal either.
        if !(0..3).all(|axis| min[axis] <= max[axis]) {
            return None;
        }
        // No mesh reaches further.
        let finite = |p: Double3| p.map(|x| x.clamp(-Ray64::GREATEST, Ray64::GREATEST));
        let (min, max) = (finite(min), finite(max));
        Some(Prepared::Planes([
            ([1.0, 0.0, 0.0], min),
            ([0.0, 1.0, 0.0], min),
            ([0.0, 0.0, 1.0], min),
            ([-1.0, 0.0, 0.0], max),
            ([0.0, -1.0, 0.0], max),
            ([0.0, 0.0, -1.0], max),
        ]))
    }
}

impl Prepare for Ball64 {
    fn prepare(&self) -> Option<Prepared> {
        let Self { center, radius } = *self;
        let is_usual = largest_magnitude(center) <= Ray64::GREATEST;
        let is_number = center.iter().all(|x| x.is_finite()) && radius >= 0.0;
        (is_usual && is_number).then_some(Prepared::Ball { center, radius })
    }
}

impl Prepare for [Double3; 3] {
    fn prepare(&self) -> Option<Prepared> {
        let is_usual = |x: &f64| x.abs() <= Ray64::GREATEST;
        self.as_flattened().iter().all(is_usual).then_some(Prepared::Triangle(*self))
    }
}

impl Prepare for Frustum64 {
    fn prepare(&self) -> Option<Prepared> {
        // Squares of what is longer could overflow; of what is shorter nothing would be left.
        let is_usual = |(normal, point): &(Double3, Double3)| {
            dot(*normal, *normal).is_finite() && point.iter().all(|x| x.abs() <= Ray64::GREATEST)
        };
        self.planes.iter().all(is_usual).then_some(Prepared::Planes(self.planes))
    }
}

/// A region as a search asks it.
// There is one for each search, on the stack.
#[allow(clippy::large_enum_variant)]
pub(super) enum Prepared {
    /// What lies on the inner side of planes, by their normals and points.
    Planes([(Double3, Double3); 6]),
    /// A triangle.
    Triangle([Double3; 3]),
    /// What lies no further from a centre than a radius.
    Ball { center: Double3, radius: f64 },
}

impl Prepared {
    /// Whether what lies in a box of the tree, which stands in the frame, may touch the region.
    fn may_touch(&self, bounds: &Aabb, frame: &LocalFrame) -> bool {
        match self {
            Self::Planes(planes) => planes.iter().all(|(normal, point)| {
                let point = frame.point(*point);
                // From the plane to the corner that lies farthest inwards.
                let inwards = [0, 1, 2].map(|axis| {
                    let [min, max] = [bounds.min[axis], bounds.max[axis]].map(f64::from);
                    (if normal[axis] > 0.0 { max } else { min }) - point[axis]
                });
                let size = normal[0].abs() + normal[1].abs() + normal[2].abs();
                let rounding = DISPLACEMENT + f64::EPSILON * 8.0 * largest_magnitude(point);
                dot(*normal, inwards) + size * rounding >= 0.0
            }),
            Self::Triangle(corners) => {
                let corners = corners.map(|corner| frame.point(corner));
                let farthest = corners.map(largest_magnitude).into_iter().fold(1.0, f64::max);
                let rounding = DISPLACEMENT + 4.0 * TOUCH_SLACK * farthest;
                (0..3).all(|axis| {
                    let [a, b, c] = corners.map(|corner| corner[axis]);
                    let [min, max] = [bounds.min[axis], bounds.max[axis]].map(f64::from);
                    min - rounding <= a.max(b).max(c) && a.min(b).min(c) <= max + rounding
                })
            }
            Self::Ball { center, radius } => {
                let distance = distance_of_box(frame.point(*center), bounds);
                distance - DISPLACEMENT - ROUNDINGS * distance <= frame.length(*radius)
            }
        }
    }

    /// Whether a triangle touches the region.
    fn touches(&self, corners: [Double3; 3]) -> bool {
        match self {
            Self::Planes(planes) => {
                // Seen from one of its corners, so that no digits are lost however far from zero it lies. Differences are rounded in order: a corner on a plane stays there.
                let origin = corners[0];
                let planes = planes.map(|(normal, point)| {
                    let from = sub(point, origin);
                    (normal, -dot(normal, from))
                });
                is_left_of(corners.map(|corner| sub(corner, origin)), &planes)
            }
            Self::Triangle(own) => {
                let seen = |triangle: [Double3; 3]| triangle.map(|corner| sub(corner, own[0]));
                triangles_touch_in_double(seen(*own), seen(corners))
            }
            Self::Ball { center, radius } => {
                let (offset, ..) = closest_to_zero(corners.map(|corner| sub(corner, *center)));
                dot(offset, offset).sqrt() <= *radius
            }
        }
    }
}

impl Bvh64 {
    /// Tells `visit` the number of each triangle that touches a region, once, in no particular order, until it breaks. O(log N) and what it costs to look at those found and their
    /// neighbours; boxes are looked at one by one, so it takes some times as long as [`Bvh::overlapping`](crate::Bvh::overlapping), whose bounds come from vectors.
    ///
    /// ```
    /// use raywood::{Aabb64, Ball64, Bvh64, TriangleMesh64};
    /// use std::ops::ControlFlow;
    ///
    /// // Two panes, ten micrometres apart, a million metres away.
    /// let pane = |z| [[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]];
    /// let positions = [pane(1e6), pane(1e6 + 1e-5)].concat();
    /// let bvh = Bvh64::build(TriangleMesh64::new(positions, vec![[0, 1, 2], [3, 4, 5]])?)?;
    ///
    /// let mut found = Vec::new();
    /// let _ = bvh.overlapping(&Aabb64::new([0.0, 0.0, 1e6 + 5e-6], [1.0, 1.0, 1e6 + 2e-5]), |triangle| {
    ///     found.push(triangle);
    ///     ControlFlow::Continue(())
    /// });
    /// assert_eq!(found, [1]);
    /// assert!(!bvh.overlaps(&Ball64::new([0.0, 0.0, 1e6 + 5e-6], 4e-6)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overlapping<R: Region64>(
        &self,
        region: &R,
        mut visit: impl FnMut(u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(region) = region.prepare() else { return ControlFlow::Continue(()) };
        let bound = |bounds: &Aabb| region.may_touch(bounds, &self.frame).then_some(0.0);
        self.tree.visit_primitives(bound, |triangle| {
            if region.touches(self.mesh.corners(triangle)) {
                visit(triangle)?;
            }
            ControlFlow::Continue(0.0)
        })
    }

    /// Whether anything touches a region: [`overlapping`](Self::overlapping) up to the first.
    pub fn overlaps<R: Region64>(&self, region: &R) -> bool {
        self.overlapping(region, |_| ControlFlow::Break(())).is_break()
    }

    /// [`overlaps`](Self::overlaps) for many regions, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn overlaps_batch<R: Region64>(&self, regions: &[R], answers: &mut [bool]) {
        assert_eq!(regions.len(), answers.len(), "as many answers as regions");
        parallel::fill(regions, answers, |region| self.overlaps(region));
    }
}
