//! The frustum as a region: what a camera sees, or any convex space between six planes.

use super::Region;
use super::private::{Prepare, Touch};
use crate::double::{dot, double};
use crate::geometry::{Plane, TriangleBlock, frustum_faces, is_left_of};
use crate::simd::Simd;
use crate::structures::wide::search::{Planes, lanes};
use crate::{Geometry, Vec3};

/// The space between six planes, such as what a camera sees, as a [`Region`].
///
/// What touches it are the triangles with a point in it, within `2^-40` of the largest coordinate, and of other primitives those whose boxes are not
/// beyond one of the planes. If a number of it is not finite nothing touches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Of each plane the normal, inwards, and the offset.
    planes: [Plane; 6],
}

impl Frustum {
    /// The points with `a x + b y + c z + d >= 0` for all planes `[a, b, c, d]`.
    pub fn from_planes(planes: [[f32; 4]; 6]) -> Self {
        Self { planes: planes.map(|[a, b, c, d]| (double(Vec3::new(a, b, c)), f64::from(d))) }
    }

    /// The frustum with the given corners: four around its front, and behind them, in the same order, four around its back. Each face is the plane along both
    /// of its diagonals, so corners should lie in one.
    pub fn from_corners<P: Into<[f32; 3]>>(corners: [P; 8]) -> Self {
        let corners = corners.map(|corner| double(Vec3::from(corner.into())));
        let planes = frustum_faces(corners);
        Self { planes: planes.map(|(normal, point)| (normal, -dot(normal, point))) }
    }
}

impl Region for Frustum {}

impl Prepare for Frustum {
    fn prepare(&self, reach: f32) -> Option<impl Touch> {
        let planes = self.sound_planes()?;
        Some(Prepared { planes: planes.map(|plane| widened(plane, f64::from(reach))) })
    }
}

impl Frustum {
    /// The planes, if all their numbers are finite.
    fn sound_planes(&self) -> Option<[Plane; 6]> {
        let is_finite =
            |(normal, offset): &Plane| dot(*normal, *normal).is_finite() && offset.is_finite();
        self.planes.iter().all(is_finite).then_some(self.planes)
    }

    /// The frustum as it is seen in the space of something that is placed by these rows, and reaches so far from zero there.
    pub(crate) fn prepare_in(&self, rows: &[[f64; 4]; 3], reach: f32) -> Option<Prepared> {
        let column = |j: usize| [rows[0][j], rows[1][j], rows[2][j]];
        // Where the sums that are rounded end at most.
        let row =
            |[x, y, z, w]: &[f64; 4]| (x.abs() + y.abs() + z.abs()) * f64::from(reach) + w.abs();
        let farthest = rows.iter().map(row).fold(0.0, f64::max);
        let planes = self.sound_planes()?.map(|plane| {
            let (normal, offset) = widened(plane, farthest);
            let seen = [dot(normal, column(0)), dot(normal, column(1)), dot(normal, column(2))];
            (seen, offset + dot(normal, column(3)))
        });
        Some(Prepared { planes })
    }
}

/// A plane further out by what rounding may take of heights above it, of points that are no farther from zero along any axis.
fn widened((normal, offset): Plane, farthest: f64) -> Plane {
    let size = normal[0].abs() + normal[1].abs() + normal[2].abs();
    (normal, offset + SLACK * (size * farthest + offset.abs()))
}

/// The rounding of heights above planes, per unit of their largest term.
const SLACK: f64 = 1.0 / (1u64 << 42) as f64;

/// A frustum a little larger than given.
pub(crate) struct Prepared {
    planes: [Plane; 6],
}

impl Touch for Prepared {
    #[inline(always)]
    fn boxes<S: Simd>(&self, _: S, [x, y, z]: &Planes) -> u32 {
        let mut touching = 0;
        for (lane, (least, greatest)) in x[0].iter().zip(&x[1]).enumerate() {
            // Not those that are not there.
            touching |= u32::from(least <= greatest) << lane;
        }
        for (normal, offset) in &self.planes {
            // The corner that lies farthest inwards.
            let farthest = normal.map(|n| usize::from(n > 0.0));
            let (x, y, z) = (&x[farthest[0]], &y[farthest[1]], &z[farthest[2]]);
            for lane in lanes(touching) {
                let corner = [f64::from(x[lane]), f64::from(y[lane]), f64::from(z[lane])];
                touching &= !(u32::from(dot(*normal, corner) + offset < 0.0) << lane);
            }
        }
        touching
    }

    #[inline(always)]
    fn triangles<S: Simd>(&self, _: S, block: &TriangleBlock, chosen: u32) -> u32 {
        let mut touching = 0;
        for lane in lanes(chosen) {
            let corners = block.corners(lane).map(double);
            touching |= u32::from(is_left_of(corners, &self.planes)) << lane;
        }
        touching
    }

    fn primitive<G: Geometry>(&self, geometry: &G, primitive: u32) -> bool {
        let bounds = geometry.bounds(primitive);
        let (min, max) = (double(bounds.min), double(bounds.max));
        self.planes.iter().all(|(normal, offset)| {
            let farthest = [0, 1, 2].map(|i| if normal[i] > 0.0 { max[i] } else { min[i] });
            dot(*normal, farthest) + offset >= 0.0
        })
    }
}
