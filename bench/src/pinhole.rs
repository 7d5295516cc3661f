//! The camera of the benchmark, a pinhole whose formula is written down so that anybody can make the same rays.

use raywood::{Ray, Vec3};

use crate::pixel_order::PictureSize;

type Double = [f64; 3];

/// A pinhole camera; up is +y.
///
/// With `F = normalize(target - eye)`, `R = normalize(F x (0, 1, 0))`, `U = R x F` and `k = tan(fov_y / 2)`, the ray through the pixel
/// `(x, y)` of `W` x `H` has the direction
/// `normalize(F + (2 (x + 1/2) / W - 1) k (W / H) R + (1 - 2 (y + 1/2) / H) k U)`, computed in double precision and rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pinhole {
    pub(crate) eye: Vec3,
    forward: Double,
    right: Double,
    up: Double,
    tan: f64,
}

impl Pinhole {
    /// The camera at `eye` that looks at `target`; `tan` is the tangent of half the angle from the picture's bottom to its top.
    ///
    /// # Errors
    ///
    /// There is no such camera: it would look straight up or down, or nowhere.
    pub(crate) fn new(eye: Vec3, target: Vec3, tan: f32) -> Result<Self, String> {
        let [e, t] = [eye, target].map(|point| point.to_array().map(f64::from));
        let forward = normalize([t[0] - e[0], t[1] - e[1], t[2] - e[2]]);
        let right = forward.and_then(|forward| normalize(cross(forward, [0.0, 1.0, 0.0])));
        let (Some(forward), Some(right)) = (forward, right) else {
            return Err(
                "the eye must not be at, straight above or straight below the target".into()
            );
        };
        if !(tan > 0.0 && tan.is_finite()) {
            return Err(format!("the tangent must be a number above 0, not {tan}"));
        }
        Ok(Self { eye, forward, right, up: cross(right, forward), tan: tan.into() })
    }

    /// The ray through the centre of a pixel.
    pub(crate) fn ray(&self, [x, y]: [u32; 2], size: PictureSize) -> Ray {
        let [width, height] = [size.width, size.height].map(f64::from);
        let across = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * self.tan * (width / height);
        let upwards = (1.0 - 2.0 * (f64::from(y) + 0.5) / height) * self.tan;
        let direction =
            [0, 1, 2].map(|i| self.forward[i] + across * self.right[i] + upwards * self.up[i]);
        // Its part along `forward` is one: it has a length.
        let direction = normalize(direction).unwrap_or(self.forward);
        Ray::new(self.eye, direction.map(|x| x as f32))
    }
}

fn cross(a: Double, b: Double) -> Double {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector scaled to unit length, if it has a direction.
fn normalize(v: Double) -> Option<Double> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_follow_the_formula() {
        let camera = Pinhole::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -7.0), 0.5)
            .expect("a camera");
        // Forward -z, right +x, up +y. The pixel right of and below the middle of 4 x 2.
        let size = PictureSize { width: 4, height: 2 };
        let ray = camera.ray([2, 1], size);
        assert_eq!(ray.origin, Vec3::new(1.0, 2.0, 3.0));
        let (a, b) = (0.25f64 * 0.5 * 2.0, -0.5 * 0.5);
        let length = (1.0 + a * a + b * b).sqrt();
        let expected = [a / length, b / length, -1.0 / length].map(|x| x as f32);
        assert_eq!(ray.direction.to_array(), expected);
        assert_eq!((ray.t_min, ray.t_max), (0.0, f32::INFINITY));
        // Opposite pixels are mirrored.
        let other = camera.ray([1, 0], size).direction;
        assert_eq!(other.to_array(), [-expected[0], -expected[1], expected[2]]);
    }

    #[test]
    fn cameras_without_direction_are_refused() {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        for target in [eye, eye + Vec3::Y, eye - Vec3::Y] {
            assert!(Pinhole::new(eye, target, 0.5).is_err(), "{target:?}");
        }
        for tan in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Pinhole::new(eye, Vec3::ZERO, tan).is_err(), "{tan}");
        }
    }
}
