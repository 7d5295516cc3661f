//! Where a part goes: turned, scaled and moved.

use raywood::Vec3;

/// A rotation, a uniform scale and a move, in this order; never a mirror image, so fronts stay in front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    axes: [Vec3; 3],
    origin: Vec3,
}

impl Placement {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { axes: [Vec3::X, Vec3::Y, Vec3::Z], origin: Vec3::ZERO };

    /// Moves the part's origin to a point.
    pub const fn at(origin: Vec3) -> Self {
        Self { origin, ..Self::IDENTITY }
    }

    /// The same, turned first about the vertical through the part's origin, counter-clockwise seen from above, in
    /// degrees.
    pub fn turned(self, degrees: f32) -> Self {
        // Quarter turns are exact, so that walls at right angles meet without a gap.
        let (sin, cos) = match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            other => other.to_radians().sin_cos(),
        };
        let [x, y, z] = self.axes;
        Self { axes: [cos * x - sin * z, y, cos * z + sin * x], ..self }
    }

    /// The same, tilted first about the part's own x axis, in degrees: at 90 what was up points along z.
    pub fn tilted(self, degrees: f32) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [x, y, z] = self.axes;
        Self { axes: [x, cos * y + sin * z, cos * z - sin * y], ..self }
    }

    /// The same, the part scaled first.
    pub fn scaled(self, factor: f32) -> Self {
        Self { axes: self.axes.map(|axis| factor * axis), ..self }
    }

    /// Where a point of the part comes to lie.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.origin + p.x * self.axes[0] + p.y * self.axes[1] + p.z * self.axes[2]
    }

    /// Where a unit vector of the part comes to point, unit length again.
    pub fn direction(&self, d: Vec3) -> Vec3 {
        (d.x * self.axes[0] + d.y * self.axes[1] + d.z * self.axes[2]).normalize_or_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counter_clockwise_from_above_and_come_first() {
        let quarter = Placement::at(Vec3::new(5.0, 0.0, 0.0)).turned(90.0);
        assert_eq!(quarter.point(Vec3::X), Vec3::new(5.0, 0.0, -1.0));
        assert_eq!(quarter.point(Vec3::Z), Vec3::new(6.0, 0.0, 0.0));
        let [a, b] = [Placement::IDENTITY.turned(89.9999), Placement::IDENTITY.turned(90.0)];
        assert!((a.point(Vec3::X) - b.point(Vec3::X)).length() < 1e-5);
        let tilted = Placement::IDENTITY.tilted(90.0).point(Vec3::Y);
        assert!((tilted - Vec3::Z).length() < 1e-6);
    }
}
