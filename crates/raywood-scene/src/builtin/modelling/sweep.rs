//! Sweeps: surfaces that a profile leaves behind when it moves along a path.

use raywood::Vec3;

use super::{Cells, Part, Profile};

/// A point of a path and how the profile is held there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Where the profile's origin goes.
    pub position: Vec3,
    /// What the profile's `y` points to, as far as the path's direction allows. Its `x` is path direction x up.
    pub up: Vec3,
}

/// The surface that a profile leaves behind along a path; the path's ends stay open, or join where it is `closed`.
///
/// Looking along the path with `up` upwards, the profile's `x` goes to the right. The front is as [`Profile`] says.
pub fn sweep(profile: &Profile, path: &[PathPoint], closed: bool) -> Part {
    // At each point of the path, find the axes of the profile's plane.
    let count = path.len();
    let frames: Vec<_> = (0..count)
        .map(|i| {
            let next = if closed { (i + 1) % count } else { (i + 1).min(count - 1) };
            let previous = if closed { (i + count - 1) % count } else { i.saturating_sub(1) };
            let along = (path[next].position - path[previous].position).normalize_or_zero();
            let side = along.cross(path[i].up).normalize_or_zero();
            (path[i].position, side, side.cross(along))
        })
        .collect();

    let u = Cells { count: if closed { count } else { count - 1 }, closed };
    let mut part = Part::default();
    for run in profile.runs() {
        let v = Cells {
            count: if profile.is_ring() { run.len() } else { run.len() - 1 },
            closed: profile.is_ring(),
        };
        part.add_grid(u, v, |i, j| {
            let ((position, side, up), [x, y]) = (frames[i], run[j]);
            position + x * side + y * up
        });
    }
    part
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{PI, TAU};

    use super::super::{is_closed, signed_volume};
    use super::*;

    #[test]
    fn a_swept_circle_is_a_closed_torus_with_its_front_outside() {
        let path: Vec<_> = (0..96)
            .map(|i| {
                let (sin, cos) = (TAU * i as f32 / 96.0).sin_cos();
                PathPoint { position: Vec3::new(2.0 * cos, 0.0, -2.0 * sin), up: Vec3::Y }
            })
            .collect();
        let torus = sweep(&Profile::circle(0.5, 32), &path, true);
        assert_eq!(torus.triangles.len(), 96 * 32 * 2);
        assert!(is_closed(&torus));
        let exact = 2.0 * PI * PI * 2.0 * 0.25;
        assert!((signed_volume(&torus) - exact).abs() < 0.02 * exact);
    }
}
