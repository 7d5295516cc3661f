//! A point of a surface on its way from the object's space into the world.

use super::transform::Inverse;
use super::{Transform, transform};
use crate::double::{Double3, cross, dot, double, scale, single, sub};
use crate::{SurfacePoint, Vec3};

/// A point of a surface in double precision, so that its way through several transforms costs no digits: what [`Traceable`](super::Traceable)s tell each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectPoint {
    position: Double3,
    /// Of unit length, or zero.
    normal: Double3,
    clearance: f64,
}

/// The room that rounding of rays on their way into the object's space takes, in terms of the clearance there: `docs/numerics.md`, "Instances".
const ROOM_FOR_RAYS: f64 = 2.0;

/// How much of the position's largest coordinate the next ray must start off the surface: four roundings.
const ROOM_FOR_POSITIONS: f64 = 2.0 * f32::EPSILON as f64;

impl From<SurfacePoint> for ObjectPoint {
    fn from(point: SurfacePoint) -> Self {
        let clearance = ROOM_FOR_RAYS * f64::from(point.clearance);
        Self {
            position: double(point.position),
            normal: unit_or_zero(double(point.normal)),
            clearance,
        }
    }
}

impl ObjectPoint {
    /// One on a triangle, whose normal is known to all digits.
    pub(super) fn on_triangle(corners: [Vec3; 3], point: &SurfacePoint) -> Self {
        let [p0, p1, p2] = corners.map(double);
        let normal = unit_or_zero(cross(sub(p1, p0), sub(p2, p0)));
        Self { normal, ..Self::from(*point) }
    }

    /// The point where an instance has it.
    pub(super) fn placed(&self, transform: &Transform, inverse: &Inverse) -> Self {
        let position = transform.point_in_double(self.position);
        let normal = inverse.normal(self.normal);
        // Heights above the surface are so much larger in the object's space.
        let height = dot(normal, normal).sqrt();
        let farthest = transform::largest(position.map(f64::abs));
        let room = if height > 0.0 { ROOM_FOR_RAYS * self.clearance / height } else { 0.0 };
        Self {
            position,
            normal: unit_or_zero(normal),
            clearance: room + ROOM_FOR_POSITIONS * farthest,
        }
    }

    /// The point, rounded once.
    pub(super) fn rounded(&self) -> SurfacePoint {
        SurfacePoint {
            position: single(self.position),
            normal: single(self.normal),
            clearance: (self.clearance as f32).next_up(),
        }
    }
}

/// The vector scaled to unit length, or zero if it is. Double precision squares all lengths of single precision, and of products of two.
fn unit_or_zero(v: Double3) -> Double3 {
    let largest = transform::largest(v.map(f64::abs));
    if !(largest > 0.0 && largest.is_finite()) {
        return [0.0; 3];
    }
    let v = scale(1.0 / largest, v);
    scale(1.0 / dot(v, v).sqrt(), v)
}
