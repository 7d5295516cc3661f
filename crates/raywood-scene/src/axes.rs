//! Which way is up in a scene.

use raywood::{Aabb, Vec3};

use crate::Scene;

/// An orthonormal, right-handed basis: up, and two level directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// The first level direction: x where that is level.
    pub across: Vec3,
    /// Up.
    pub up: Vec3,
    /// The second level direction: z where y is up.
    pub along: Vec3,
}

impl Axes {
    /// The axes for a direction that is up; y if it has no length.
    pub fn new(up: Vec3) -> Self {
        let up = match up.normalize_or_zero() {
            Vec3::ZERO => Vec3::Y,
            up => up,
        };
        let across = Vec3::X - Vec3::X.dot(up) * up;
        let across = if across.length() > 0.1 { across } else { Vec3::Z.cross(up) };
        let across = across.normalize_or_zero();
        Self { across, up, along: across.cross(up) }
    }

    /// A vector given by its parts across, along and up.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        v.x * self.across + v.y * self.along + v.z * self.up
    }

    /// The parts of a vector across, along and up.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.across), v.dot(self.along), v.dot(self.up))
    }

    /// How far a box reaches along a direction of unit length.
    pub fn reach(bounds: &Aabb, direction: Vec3) -> f32 {
        bounds.extent().dot(direction.abs())
    }
}

impl Scene {
    /// Which way is up: as the scene says, else as it looks. O(number of triangles) in the latter case.
    pub fn axes(&self) -> Axes {
        Axes::new(self.up.unwrap_or_else(|| guess_up(self)))
    }
}

/// Which direction is up in a scene that does not say: y, as most formats and programs do, or z for a terrain in a world
/// where z is up: flat, not quite level, and nowhere overhanging.
fn guess_up(scene: &Scene) -> Vec3 {
    let extent = scene.bounds().extent();
    let width = extent.x.min(extent.y);
    if !(extent.z > 0.002 * width && extent.z < 0.35 * width) {
        return Vec3::Y;
    }
    let mesh = &scene.mesh.triangles;
    let count = mesh.triangles().len();
    let facing_up = (0..count as u32)
        .filter(|&triangle| {
            let [a, b, c] = mesh.corners(triangle);
            (b - a).cross(c - a).z > 0.0
        })
        .count();
    if count > 0 && facing_up as f32 > 0.98 * count as f32 { Vec3::Z } else { Vec3::Y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_are_orthonormal_and_right_handed() {
        assert_eq!(Axes::new(Vec3::Y), Axes { across: Vec3::X, up: Vec3::Y, along: Vec3::Z });
        assert_eq!(Axes::new(Vec3::ZERO).up, Vec3::Y);
        for up in [Vec3::Z, Vec3::X, -Vec3::Y, Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 1e-9, 0.0)]
        {
            let Axes { across, up, along } = Axes::new(up);
            for axis in [across, up, along] {
                assert!((axis.length() - 1.0).abs() < 1e-6);
            }
            assert!(across.dot(up).abs() < 1e-6 && up.dot(along).abs() < 1e-6);
            assert!((across.cross(up) - along).length() < 1e-6);
        }
    }
}
