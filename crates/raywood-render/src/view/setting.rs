//! What the setting of a scene is: something to look at from outside, or to be in.

use raywood::{Aabb, Vec3};

use raywood_scene::Axes;

use super::probes::Surroundings;
use crate::PreparedScene;

/// The setting of a scene, as probe rays from the middle of its bounding box tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// A thing, or things under the open sky: seen from outside.
    Outside,
    /// A room with one open side, like a stage: seen through it.
    Opening {
        /// The level direction in which it is open, unit length.
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
        let axes = prepared.axes();
        let around = standpoints(&bounds, axes).map(|point| Surroundings::of(prepared, point));

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
        let (across, along) = (open.dot(axes.across), open.dot(axes.along));
        let (share, axis) =
            if across.abs() >= along.abs() { (across, axes.across) } else { (along, axes.along) };
        if share.abs() > 0.5 && share.abs() > open.dot(axes.up).abs() {
            Self::Opening { towards: share.signum() * axis }
        } else {
            Self::Outside
        }
    }
}

/// Five points at half height: the middle of the box, and a fifth of its length and width to each side.
pub(super) fn standpoints(bounds: &Aabb, axes: &Axes) -> [Vec3; 5] {
    let center = bounds.center();
    let [x, z] = [axes.across, axes.along].map(|axis| 0.2 * Axes::reach(bounds, axis) * axis);
    [center, center + x, center - x, center + z, center - z]
}

fn median(mut values: [f32; 5]) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values[2]
}
