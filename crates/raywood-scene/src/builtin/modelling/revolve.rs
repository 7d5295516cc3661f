//! Surfaces of revolution: a profile turned about the vertical axis.

use std::f32::consts::TAU;

use raywood::Vec3;

use super::{Cells, Part, Profile};

/// The surface of revolution of a profile: its `x` is the distance from the vertical axis, its `y` the height.
/// Going up the front is outside; where both ends of the profile lie on the axis the surface is closed.
pub fn revolve(profile: &Profile, segments: usize) -> Part {
    revolve_with(profile, segments, |radius, _, _| radius)
}

/// Like [`revolve`], with the radius changed by a function of radius, height and angle (in radians,
/// counter-clockwise from above): what flutes and twists a pillar. The function must leave a radius of zero alone.
pub fn revolve_with(
    profile: &Profile,
    segments: usize,
    radius: impl Fn(f32, f32, f32) -> f32,
) -> Part {
    let directions: Vec<_> = (0..segments)
        .map(|i| {
            let angle = TAU * i as f32 / segments as f32;
            (angle, angle.cos(), -angle.sin())
        })
        .collect();
    let mut part = Part::default();
    for run in profile.runs() {
        let v = Cells {
            count: if profile.is_ring() { run.len() } else { run.len() - 1 },
            closed: profile.is_ring(),
        };
        part.add_grid(Cells::closed(segments), v, |i, j| {
            let ((angle, x, z), [r, y]) = (directions[i], run[j]);
            let r = radius(r, y, angle);
            Vec3::new(r * x, y, r * z)
        });
    }
    part
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::super::{is_closed, signed_volume};
    use super::*;

    #[test]
    fn a_half_circle_becomes_a_closed_sphere_with_radial_normals() {
        let sphere = revolve(&Profile::start(0.0, -1.0).arc([0.0, 0.0], 1.0, 180.0, 48), 96);
        assert!(is_closed(&sphere));
        let exact = 4.0 / 3.0 * PI;
        assert!((signed_volume(&sphere) - exact).abs() < 0.01 * exact);
        for (p, n) in sphere.positions.iter().zip(&sphere.normals) {
            assert!(p.normalize_or_zero().dot(*n) > 0.999, "normal {n:?} at {p:?}");
        }
    }

    #[test]
    fn a_box_profile_becomes_a_closed_cylinder_with_sharp_edges() {
        let profile =
            Profile::start(0.0, 0.0).line_to(1.0, 0.0).line_to(1.0, 2.0).line_to(0.0, 2.0);
        let cylinder = revolve(&profile, 256);
        assert!(is_closed(&cylinder));
        assert!((signed_volume(&cylinder) - 2.0 * PI).abs() < 0.01);
        // Two vertices per rim point: one belongs to the side, one to the lid.
        assert!(cylinder.normals.iter().all(|n| n.y.abs() < 1e-4 || n.y.abs() > 0.9999));
    }
}
