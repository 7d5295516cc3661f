//! Where points and edges appear in a picture, in homogeneous coordinates (Riesenfeld 1981; Blinn and Newell, "Clipping Using Homogeneous
//! Coordinates", 1978): an edge is clipped before anything is divided, so that it may pass the eye.

use raywood::Vec3;

/// The inverse of [`CameraRays::ray`](crate::CameraRays::ray), in double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    eye: [f64; 3],
    rows: [[f64; 3]; 3],
}

/// A point of space: `x / w` and `y / w` are its place in the picture, in pixels from the upper left corner, and `w` its depth, the
/// distance along the line of sight.
pub(super) type Homogeneous = [f64; 3];

/// An edge as it appears in the picture: between two places, each with the reciprocal of its depth, which is linear between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    pub(super) from: [f32; 2],
    pub(super) to: [f32; 2],
    /// The reciprocals of the depths at both ends.
    pub(super) inverse_depth: [f32; 2],
}

impl Projection {
    /// From the eye and the directions' steps: a ray through `(x, y)` has direction `x * columns[0] + y * columns[1] + columns[2]`.
    pub(crate) fn new(eye: Vec3, columns: [Vec3; 3]) -> Self {
        let [a, b, c] = columns.map(wide);
        // Rows of the inverse matrix, by Cramer's rule.
        let determinant = dot(a, cross(b, c));
        let rows = [cross(b, c), cross(c, a), cross(a, b)].map(|row| row.map(|x| x / determinant));
        Self { eye: wide(eye), rows }
    }

    /// Where a point appears.
    pub(super) fn project(&self, point: Vec3) -> Homogeneous {
        let point = wide(point);
        let from_eye = [0, 1, 2].map(|axis| point[axis] - self.eye[axis]);
        self.rows.map(|row| dot(row, from_eye))
    }

    /// The depth that a unit of length along a direction adds.
    pub(super) fn depth_along(&self, direction: Vec3) -> f32 {
        dot(self.rows[2], wide(direction)) as f32
    }
}

/// A picture's edges, widened by a margin, and the eye's plane: for each, how far inside a point is.
pub(super) fn inside([x, y, w]: Homogeneous, [width, height]: [f64; 2], margin: f64) -> [f64; 5] {
    let (m, right, below) = (margin, width + margin, height + margin);
    [w, x + m * w, right * w - x, y + m * w, below * w - y]
}

/// The part of an edge that is in front of the eye and within the picture widened by a margin; `None` if nothing is.
pub(super) fn clip(a: Homogeneous, b: Homogeneous, size: [f64; 2], margin: f64) -> Option<Segment> {
    let [mut in_a, mut in_b] = [a, b].map(|end| inside(end, size, margin));
    // At the eye itself nothing can be divided. The sides bound what is in front of it, however near.
    let near = 1e-9 * a[2].abs().max(b[2].abs());
    in_a[0] -= near;
    in_b[0] -= near;

    let (mut start, mut end) = (0.0f64, 1.0f64);
    for (at_a, at_b) in in_a.into_iter().zip(in_b) {
        match (at_a >= 0.0, at_b >= 0.0) {
            (true, true) => {}
            (false, true) => start = start.max(at_a / (at_a - at_b)),
            (true, false) => end = end.min(at_a / (at_a - at_b)),
            (false, false) => return None,
        }
    }
    if start > end {
        return None;
    }
    let at = |share: f64| {
        let [x, y, w] = [0, 1, 2].map(|i| (1.0 - share) * a[i] + share * b[i]);
        [x / w, y / w, 1.0 / w].map(|x| x as f32)
    };
    let ([x0, y0, q0], [x1, y1, q1]) = (at(start), at(end));
    let finite = [x0, y0, q0, x1, y1, q1].iter().all(|x| x.is_finite());
    finite.then_some(Segment { from: [x0, y0], to: [x1, y1], inverse_depth: [q0, q1] })
}

fn wide(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use raywood_scene::Camera;
    use raywood_testkit::Rng;

    use super::*;
    use crate::CameraRays;

    fn camera_rays(eye: Vec3, target: Vec3, up: Vec3, fov_y: f32) -> CameraRays {
        let camera = Camera { name: String::new(), eye, target, up, fov_y };
        CameraRays::new(&camera, 640, 400).expect("a camera")
    }

    /// A point on the ray through a place of the picture appears at that place, at its depth.
    #[test]
    fn projection_is_the_inverse_of_the_cameras_rays() {
        let mut rng = Rng::new(5);
        for _ in 0..2000 {
            let [eye, target, up] = [(); 3].map(|()| 9.0 * rng.in_cube());
            let rays = camera_rays(eye, target, up, rng.range(1.0, 150.0));
            let (x, y, t) = (rng.range(0.0, 640.0), rng.range(0.0, 400.0), rng.range(0.1, 100.0));
            let ray = rays.ray(x, y);
            let projection = rays.projection();
            let [px, py, w] = projection.project(ray.origin + t * ray.direction);
            let off = (px / w - f64::from(x)).hypot(py / w - f64::from(y));
            // Rounding of the point moves it by parts of 1e-7 of its distance from the origin.
            assert!(off < 0.05 * f64::from(1.0 + 10.0 / t), "{off} pixels at {x}, {y}, {t}");
            let depth = t * projection.depth_along(ray.direction);
            assert!((w as f32 - depth).abs() <= 1e-5 * (10.0 + depth), "{w} {depth}");
        }
    }

    #[test]
    fn edges_are_clipped_at_the_eye_and_the_sides() {
        let rays = camera_rays(Vec3::ZERO, -Vec3::Z, Vec3::Y, 90.0);
        let projection = rays.projection();
        let clipped = |a: [f32; 3], b: [f32; 3]| {
            let [a, b] = [a, b].map(|point| projection.project(point.into()));
            clip(a, b, [640.0, 400.0], 4.0)
        };
        // Straight through the middle: half a field of view is 200 pixels at depth 1.
        let level = clipped([-0.5, 0.0, -1.0], [0.5, 0.0, -1.0]).expect("in sight");
        let off = |place: [f32; 2], x: f32, y: f32| (place[0] - x).hypot(place[1] - y);
        assert!(off(level.from, 220.0, 200.0) + off(level.to, 420.0, 200.0) < 1e-3, "{level:?}");
        assert_eq!(level.inverse_depth, [1.0, 1.0]);
        // From behind the eye to before it: the visible part begins at the lower side.
        let passing = clipped([0.0, -1.0, 5.0], [0.0, -1.0, -10.0]).expect("in sight");
        assert!((passing.from[1] - 404.0).abs() < 1e-3, "{passing:?}");
        assert!((passing.to[1] - 220.0).abs() < 1e-3, "{passing:?}");
        // Behind, beside, through the eye itself, and not a number.
        assert_eq!(clipped([-1.0, 0.0, 1.0], [1.0, 0.0, 1.0]), None);
        assert_eq!(clipped([50.0, 0.0, -1.0], [50.0, 1.0, -1.0]), None);
        assert_eq!(clipped([0.0; 3], [0.0; 3]), None);
        let through = clipped([0.0, 0.0, 3.0], [0.0, 0.0, -3.0]).expect("in sight");
        assert!(off(through.to, 320.0, 200.0) < 1e-3, "{through:?}");
        assert_eq!(clipped([f32::NAN, 0.0, -1.0], [0.0, 0.0, -1.0]), None);
    }
}
