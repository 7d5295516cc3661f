//! Cameras and lights for scenes that bring none: what a person would choose who only sees the bounding box.

use raywood::{Aabb, Vec3};

use crate::{Axes, Camera, Light, LightKind, Rgb};

/// The vertical field of view of default cameras, in degrees: that of a 50 mm lens or so, free of distortion.
pub(crate) const FOV_Y: f32 = 35.0;

/// The share of the picture's width or height that the bounding box fills.
const FILL: f64 = 0.94;

/// A camera that shows the whole box from the front, the right and above, as large as it fits.
///
/// Where `up` is y the box is seen from `(0.6, 0.45, 1)`, where it is z from the same quarter. An empty box counts as
/// the unit cube. `aspect` is the picture's width over its height.
pub fn default_camera(bounds: &Aabb, up: Vec3, aspect: f32) -> Camera {
    frame_bounds(bounds, default_direction(up), up, aspect)
}

/// From where [`default_camera`] looks at a model: the front, the right and above.
pub fn default_direction(up: Vec3) -> Vec3 {
    let axes = Axes::new(up);
    0.6 * axes.across + 0.45 * axes.up + axes.along
}

/// A camera that looks at the box from the direction `from` (any length), with `up` upwards, as near as it can be while
/// the whole box is in the picture.
pub fn frame_bounds(bounds: &Aabb, from: Vec3, up: Vec3, aspect: f32) -> Camera {
    let include_corners = |mut framing: Framing| {
        let (center, half) = (framing.center, framing.half);
        for corner in 0..8 {
            framing.include_exact(
                [0, 1, 2]
                    .map(|i| center[i] + if corner >> i & 1 == 0 { -half[i] } else { half[i] }),
            );
        }
        framing
    };
    let nearest = include_corners(Framing::new(bounds, from, up, aspect));
    include_corners(nearest.centering()).camera()
}

/// A search for the nearest place from which a set of points can be seen whole, in a given direction.
///
/// Include every point, in any order and in as many parts as convenient. Then do the same once more with what
/// [`centering`](Self::centering) gives, and ask that for the camera.
#[derive(Clone, Debug)]
pub struct Framing {
    center: [f64; 3],
    half: [f64; 3],
    /// The picture's axes: right, up, and back towards the eye.
    axes: [[f64; 3]; 3],
    /// The slope of the picture's edges, width and height.
    slopes: [f64; 2],
    /// Where the eye is, along the axes; the first time, at the centre.
    eye: [f64; 3],
    /// Whether this is the second time.
    centers: bool,
    /// Of each of the four edges of the picture (left, right; bottom, top) the point that counts.
    extremes: [[Extreme; 2]; 2],
    up: Vec3,
}

/// The point that is farthest to one side.
#[derive(Clone, Copy, Debug)]
struct Extreme {
    /// How far: the first time beyond the plane through the eye at the picture's edge, the second time as a slope.
    reach: f64,
    /// Its distance from the middle of the picture, positive to this side.
    across: f64,
    /// Its distance before the eye.
    depth: f64,
}

impl Extreme {
    const NONE: Self = Self { reach: f64::NEG_INFINITY, across: 0.0, depth: 1.0 };

    /// The farther of two. A full order, so that the order in which points come does not matter.
    fn farther(self, other: Self) -> Self {
        let order = self
            .reach
            .total_cmp(&other.reach)
            .then(self.depth.total_cmp(&other.depth))
            .then(self.across.total_cmp(&other.across));
        if order.is_lt() { other } else { self }
    }
}

impl Framing {
    /// For points in a box, seen from the direction `from`, with `up` upwards.
    pub fn new(bounds: &Aabb, from: Vec3, up: Vec3, aspect: f32) -> Self {
        let (center, half) = center_and_half_extent(bounds);
        let back = from.normalize_or_zero();
        let back = if back == Vec3::ZERO { Vec3::Z } else { back };
        let right = up.cross(back).normalize_or_zero();
        let right = if right == Vec3::ZERO { back.orthonormal_basis().0 } else { right };

        let slope_y = (0.5 * f64::from(FOV_Y).to_radians()).tan() * FILL;
        let aspect = if aspect.is_finite() && aspect > 0.0 { f64::from(aspect) } else { 1.0 };
        Self {
            center,
            half,
            // Double precision, since boxes may be tiny and far from the origin.
            axes: [right, back.cross(right), back].map(double),
            slopes: [slope_y * aspect, slope_y],
            eye: [0.0; 3],
            centers: false,
            extremes: [[Extreme::NONE; 2]; 2],
            up: up.normalize_or_zero(),
        }
    }

    /// Demands that a point be in the picture.
    #[inline]
    pub fn include(&mut self, point: Vec3) {
        self.include_exact(double(point));
    }

    /// Demands everything that another search, otherwise the same, demands.
    pub fn merge(mut self, other: &Self) -> Self {
        for axis in 0..2 {
            for side in 0..2 {
                let both = self.extremes[axis][side].farther(other.extremes[axis][side]);
                self.extremes[axis][side] = both;
            }
        }
        self
    }

    #[inline]
    fn include_exact(&mut self, point: [f64; 3]) {
        let offset = [0, 1, 2].map(|i| point[i] - self.center[i]);
        let depth = self.eye[2] - dot(offset, self.axes[2]);
        for axis in 0..2 {
            let across = dot(offset, self.axes[axis]) - self.eye[axis];
            for (side, across) in [-across, across].into_iter().enumerate() {
                let reach =
                    if self.centers { across / depth } else { across - self.slopes[axis] * depth };
                let extreme = &mut self.extremes[axis][side];
                if reach >= extreme.reach {
                    *extreme = extreme.farther(Extreme { reach, across, depth });
                }
            }
        }
    }

    /// The same search the second time: the eye is as far back as the points included so far demand, and has yet to move
    /// aside so that the margins on both sides are alike.
    pub fn centering(&self) -> Self {
        // Back until no point is beyond a plane, at least so far that eye and target differ; aside by the same reach.
        let least = self.half.into_iter().fold(0.0, f64::max);
        let reach = self.extremes.map(|sides| sides.map(|extreme| extreme.reach));
        let distance = (0..2)
            .map(|axis| 0.5 * (reach[axis][0] + reach[axis][1]) / self.slopes[axis])
            .fold(least, f64::max);
        let aside = reach.map(|[low, high]| if low.is_finite() { 0.5 * (high - low) } else { 0.0 });
        Self {
            eye: [aside[0], aside[1], distance],
            centers: true,
            extremes: [[Extreme::NONE; 2]; 2],
            ..self.clone()
        }
    }

    /// The camera. Without any points it looks at the middle of the box.
    pub fn camera(&self) -> Camera {
        if !self.centers {
            return self.centering().camera();
        }

        // The place between the two extremes from which both appear at the same angle: each weighs by the other's depth.
        let shift = self.extremes.map(|[low, high]| {
            (high.across * low.depth - low.across * high.depth) / (low.depth + high.depth)
        });
        let [right, up, back] = self.axes;
        let (x, y) = (self.eye[0] + shift[0], self.eye[1] + shift[1]);
        let target = [0, 1, 2].map(|i| self.center[i] + x * right[i] + y * up[i]);
        let eye = [0, 1, 2].map(|i| target[i] + self.eye[2] * back[i]);
        Camera {
            name: String::new(),
            eye: single(eye),
            target: single(target),
            up: self.up,
            fov_y: FOV_Y,
        }
    }
}

/// The box's centre, and half its extent, widened so far that the camera's coordinates can tell eye from target.
fn center_and_half_extent(bounds: &Aabb) -> ([f64; 3], [f64; 3]) {
    if bounds.is_empty() || !bounds.is_finite() {
        return ([0.0; 3], [0.5; 3]);
    }
    let (min, max) = (double(bounds.min), double(bounds.max));
    let center = [0, 1, 2].map(|i| 0.5 * (min[i] + max[i]));
    let mut half = [0, 1, 2].map(|i| 0.5 * (max[i] - min[i]));
    let coordinate = center.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let least = (coordinate * 64.0 * f64::from(f32::EPSILON)).max(1e-30);
    if half.iter().all(|&h| h < least) {
        half = [least; 3];
    }
    (center, half)
}

/// Lights for a scene seen from outside: a key light over the camera's left shoulder, a weak fill light from its
/// right, and ambient light. Both are directional, so the scene's size does not matter.
pub fn default_lights(camera: &Camera) -> Vec<Light> {
    // Level axes, so that light comes from above however steeply the camera looks.
    let up = camera.up.normalize_or_zero();
    let back = (camera.eye - camera.target).normalize_or_zero();
    let right = up.cross(back).normalize_or_zero();
    let right = if right == Vec3::ZERO { back.orthonormal_basis().0 } else { right };
    let level_back = right.cross(up);

    let directional = |name: &str, towards: Vec3, strength: f32| Light {
        name: name.into(),
        kind: LightKind::directional(-towards.normalize_or_zero()),
        intensity: Rgb::splat(strength),
    };
    vec![
        directional("key", -0.7 * right + 1.1 * up + 0.8 * level_back, 0.9),
        directional("fill", 0.9 * right + 0.35 * up + 0.5 * level_back, 0.18),
        ambient(0.17),
    ]
}

/// Light from all sides.
pub fn ambient(strength: f32) -> Light {
    Light { name: "ambient".into(), kind: LightKind::Ambient, intensity: Rgb::splat(strength) }
}

fn double(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn single(v: [f64; 3]) -> Vec3 {
    let limit = f64::from(f32::MAX);
    Vec3::from(v.map(|x| x.clamp(-limit, limit) as f32))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a box in the camera's picture: from -1 to 1 across the width and height.
    fn project(camera: &Camera, bounds: &Aabb, aspect: f64) -> Vec<[f64; 2]> {
        let forward = (camera.target - camera.eye).normalize_or_zero();
        let right = forward.cross(camera.up).normalize_or_zero();
        let [right, up, forward] = [right, right.cross(forward), forward].map(double);
        let slope = (0.5 * f64::from(camera.fov_y).to_radians()).tan();
        let (min, max, eye) = (double(bounds.min), double(bounds.max), double(camera.eye));
        (0..8)
            .map(|corner| {
                let p =
                    [0, 1, 2].map(|i| if corner >> i & 1 == 0 { min[i] } else { max[i] } - eye[i]);
                let depth = dot(p, forward);
                assert!(depth > 0.0, "a corner behind the eye");
                [dot(p, right) / (depth * slope * aspect), dot(p, up) / (depth * slope)]
            })
            .collect()
    }

    #[test]
    fn every_box_is_in_the_picture_and_fills_it() {
        let boxes = [
            Aabb::new([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
            Aabb::new([0.0, 0.0, 0.0], [100.0, 1.0, 2.0]),
            Aabb::new([0.0, 0.0, 0.0], [1.0, 200.0, 2.0]),
            Aabb::new([3.0, 4.0, 5.0], [3.0, 8.0, 9.0]),
            Aabb::new([0.0, 0.0, 0.0], [50.0, 40.0, 3.0]),
            Aabb::new([1e-12, 0.0, 0.0], [2e-12, 3e-12, 1e-12]),
            Aabb::new([-1e18, -1e18, -1e18], [1e18, 1e18, 1e18]),
            Aabb::new([1000.0, 1000.0, 1000.0], [1001.0, 1002.0, 1001.0]),
        ];
        for bounds in boxes {
            for aspect in [0.5, 1.0, 1.6, 3.0] {
                let camera = default_camera(&bounds, Vec3::Y, aspect);
                let corners = project(&camera, &bounds, f64::from(aspect));
                for axis in 0..2 {
                    let side = |sign: f64| {
                        corners.iter().fold(f64::MIN, |r, corner| r.max(sign * corner[axis]))
                    };
                    let (low, high) = (side(-1.0), side(1.0));
                    assert!((low - high).abs() < 0.05, "{bounds:?}: margins {low} and {high}");
                }
                let reach = corners.iter().flatten().fold(0.0, |r: f64, x| r.max(x.abs()));
                assert!(reach <= 0.96, "{bounds:?} at {aspect} reaches to {reach}");
                assert!(reach >= 0.92, "{bounds:?} at {aspect} only reaches to {reach}");
            }
        }
    }

    #[test]
    fn boxes_without_extent_have_a_usable_camera() {
        for bounds in [
            Aabb::EMPTY,
            Aabb::new([0.0; 3], [0.0; 3]),
            Aabb::new([1e6; 3], [1e6; 3]),
            Aabb::new([f32::MIN; 3], [f32::MAX; 3]),
        ] {
            let camera = default_camera(&bounds, Vec3::Y, 1.6);
            assert!(camera.eye.is_finite() && camera.target.is_finite() && camera.up.is_finite());
            assert_ne!(camera.eye, camera.target);
        }
    }

    #[test]
    fn z_up_is_seen_from_above_too() {
        let camera = default_camera(&Aabb::new([0.0; 3], [100.0, 80.0, 10.0]), Vec3::Z, 1.6);
        assert_eq!(camera.up, Vec3::Z);
        assert!(camera.eye.z > camera.target.z && camera.eye.y < camera.target.y);
    }

    #[test]
    fn points_can_be_included_in_parts() {
        let bounds = Aabb::new([-1.0; 3], [1.0; 3]);
        let points =
            [Vec3::new(-1.0, 0.0, 0.5), Vec3::new(1.0, -1.0, 1.0), Vec3::new(0.0, 1.0, -1.0)];
        let empty = Framing::new(&bounds, default_direction(Vec3::Y), Vec3::Y, 1.5);
        let all = |mut framing: Framing| {
            points.iter().for_each(|&p| framing.include(p));
            framing
        };
        let in_parts = |framing: Framing| {
            let [mut part, mut rest] = [framing.clone(), framing];
            part.include(points[0]);
            points[1..].iter().for_each(|&p| rest.include(p));
            part.merge(&rest)
        };
        let whole = all(all(empty.clone()).centering());
        assert_eq!(in_parts(in_parts(empty).centering()).camera(), whole.camera());
        // Fewer points can be seen from nearer.
        let distance = |camera: Camera| (camera.eye - camera.target).length();
        assert!(distance(whole.camera()) < distance(default_camera(&bounds, Vec3::Y, 1.5)));
    }

    #[test]
    fn the_key_light_comes_from_above_and_from_the_viewers_side() {
        let camera = default_camera(&Aabb::new([-1.0; 3], [1.0; 3]), Vec3::Y, 1.6);
        let lights = default_lights(&camera);
        let LightKind::Directional { direction, .. } = lights[0].kind else {
            panic!("not directional")
        };
        assert!(direction.y < -0.5);
        assert!(direction.dot(camera.target - camera.eye) > 0.0);
        assert!((direction.length() - 1.0).abs() < 1e-6);
        assert!(lights[0].intensity.max_element() > 2.0 * lights[1].intensity.max_element());
    }
}
