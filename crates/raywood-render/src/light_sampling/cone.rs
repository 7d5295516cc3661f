//! The cone of directions in which a round light is seen (Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", 1996).

use std::f32::consts::PI;

use raywood::Vec3;

use crate::sines::sin_cos_of_turn;

/// Directions up to an angle from an axis.
pub(crate) struct Cone {
    /// One less the cosine of its half angle.
    height: f32,
}

impl Cone {
    /// That in which a sphere is seen at a distance from its centre; `None` from inside or from the surface.
    pub(crate) fn around_sphere(distance: f32, radius: f32) -> Option<Self> {
        let sin2 = (radius / distance) * (radius / distance);
        // Not `1 - cos`, of which nothing is left of what is far away.
        (sin2 < 1.0).then(|| Self { height: sin2 / (1.0 + (1.0 - sin2).sqrt()) })
    }

    /// That of a half angle in radians, up to all directions.
    pub(crate) fn of_half_angle(angle: f32) -> Self {
        let sin = (0.5 * angle.clamp(0.0, PI)).sin();
        Self { height: 2.0 * sin * sin }
    }

    pub(crate) fn solid_angle(&self) -> f32 {
        2.0 * PI * self.height
    }

    /// A direction within it, evenly distributed, around an axis of unit length.
    pub(crate) fn sample(&self, axis: Vec3, [u, v]: [f32; 2]) -> Vec3 {
        let below = u * self.height;
        let radius = (below * (2.0 - below)).max(0.0).sqrt();
        let (sin, cos) = sin_cos_of_turn(v);
        let (s, t) = axis.orthonormal_basis();
        (radius * cos) * s + (radius * sin) * t + (1.0 - below) * axis
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of radius `sin a` at distance 1 is seen up to the angle `a`, and directions reach just that far.
    #[test]
    fn cones_of_spheres_and_of_angles_agree() {
        for angle in [1e-4f32, 0.00465, 0.3, 1.2] {
            let by_angle = Cone::of_half_angle(angle);
            let by_sphere = Cone::around_sphere(1.0, angle.sin()).expect("from outside");
            let near = (by_angle.height - by_sphere.height).abs() < 1e-5 * by_angle.height;
            assert!(near, "{angle}: {} {}", by_angle.height, by_sphere.height);
            let edge = by_angle.sample(Vec3::Z, [1.0, 0.1]);
            assert!((edge.x.hypot(edge.y).atan2(edge.z) - angle).abs() < 1e-5 * angle + 1e-7);
            assert!((edge.length() - 1.0).abs() < 1e-6);
        }
        assert!((Cone::of_half_angle(0.5 * PI).solid_angle() - 2.0 * PI).abs() < 1e-5);
        assert!(Cone::around_sphere(1.0, 1.0).is_none());
    }
}
