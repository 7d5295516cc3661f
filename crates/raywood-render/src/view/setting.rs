//! What the setting of a scene is: something to look at from outside, or to be in.

use raywood::{Aabb, Vec3};

use super::probes::Surroundings;
use crate::PreparedScene;

/// The setting of a scene, as probe rays from the middle of its bounding box tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// A thing, or things under the open sky: seen from outside.
    Outside,
    /// A room with one open side, like a stage: seen through it.
    Opening {
        /// The horizontal direction in which it is open, along an axis, unit length.
        towards: Vec3,
    },
    /// A closed room: seen from within.
    Inside,
}

/// From this share of rays stopped on, a place counts as closed: a courtyard open to the sky still is.
const CLOSED: f32 = 0.9;

/// From this share on, it counts as a room at all.
const ROOM: f32 = 0.65;

/// From this mean distance to what is around, as a share of the smallest extent, a place is wide enough to be in.
const ROOMY: f32 = 0.12;

impl Setting {
    /// Finds out. Within a room the walls show their fronts; within a solid thing, backs.
    pub fn of(prepared: &PreparedScene<'_>) -> Self {
        let bounds = prepared.bounds();
        if bounds.is_empty() {
            return Self::Outside;
        }
        let around = standpoints(&bounds).map(|point| Surroundings::of(prepared, point));

        // The median over the points: one may lie within a piece of furniture.
        let fronts = median(around.map(|a| a.fronts));
        let enclosed = median(around.map(|a| a.enclosed));
        if fronts < 0.6 || enclosed < ROOM {
            return Self::Outside;
        }
        // The gaps within a machine are enclosed by fronts too, but nobody could stand there.
        let extent = bounds.extent();
        let smallest = extent.x.min(extent.y).min(extent.z);
        if median(around.map(|a| a.distance)) < ROOMY * smallest {
            return Self::Outside;
        }
        if enclosed >= CLOSED {
            return Self::Inside;
        }

        // The open rays of all points together: mostly one way, and that a level one?
        let open = 0.2 * around.iter().fold(Vec3::ZERO, |sum, a| sum + a.open_towards);
        let axis = open.abs().max_axis();
        let towards = [Vec3::X, Vec3::Y, Vec3::Z][axis] * open[axis].signum();
        if open.abs().max_element() > 0.5 && axis != 1 {
            Self::Opening { towards }
        } else {
            Self::Outside
        }
    }
}

/// Five points at half height: the middle of the box, and a fifth of its length and width to each side.
pub(super) fn standpoints(bounds: &Aabb) -> [Vec3; 5] {
    let (center, extent) = (bounds.center(), bounds.extent());
    let (x, z) = (0.2 * extent.x * Vec3::X, 0.2 * extent.z * Vec3::Z);
    [center, center + x, center - x, center + z, center - z]
}

fn median(mut values: [f32; 5]) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values[2]
}
