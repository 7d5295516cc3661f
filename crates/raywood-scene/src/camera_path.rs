//! Cameras that move: around what they look at, or smoothly from one to the next.

use raywood::{Transform, Vec3};

use crate::Camera;

impl Camera {
    /// The camera turned around its target by an angle in degrees, counter-clockwise for who looks against `axis`, which must not be zero.
    #[must_use]
    pub fn turned(&self, axis: Vec3, degrees: f32) -> Self {
        let rotation = Transform::rotation(axis, degrees);
        let eye = self.target + rotation.vector(self.eye - self.target);
        Self { eye, up: rotation.vector(self.up), ..self.clone() }
    }

    /// The camera of a moment on the way through some, of `0` at the first to `1` at the last, in equal times from each to the next. Eye, target, direction upwards and field of view follow
    /// the splines of Catmull and Rom, "A Class of Local Interpolating Splines", 1974, which pass through those of all cameras without corners. If the last is the first again the way is a
    /// round trip. `None` without cameras.
    pub fn on_the_way(cameras: &[Self], moment: f32) -> Option<Self> {
        let last = cameras.len().checked_sub(1)?;
        let first = &cameras[0];
        let is_round = last > 1 && *first == cameras[last];
        let at = moment.clamp(0.0, 1.0) * last as f32;
        let section = (at as usize).min(last.saturating_sub(1));
        let part = at - section as f32;

        // What lies before the first and behind the last: on a round trip the others, else their mirror images.
        let point = |of: &dyn Fn(&Self) -> Vec3, index: isize| {
            let inside = |index: usize| of(&cameras[index.min(last)]);
            match usize::try_from(index) {
                Ok(index) if index <= last => inside(index),
                Ok(_) if is_round => inside(1),
                Ok(_) => 2.0 * inside(last) - inside(last.saturating_sub(1)),
                Err(_) if is_round => inside(last - 1),
                Err(_) => 2.0 * inside(0) - inside(1),
            }
        };
        let spline = |of: &dyn Fn(&Self) -> Vec3| {
            let [a, b, c, d] = [-1, 0, 1, 2].map(|offset| point(of, section as isize + offset));
            let cubic = 3.0 * (b - c) + d - a;
            let square = 2.0 * a - 5.0 * b + 4.0 * c - d;
            b + 0.5 * part * (c - a + part * (square + part * cubic))
        };
        let fields = cameras.iter().map(|camera| camera.fov_y);
        let (least, most) = fields
            .fold((f32::MAX, f32::MIN), |(least, most), field| (least.min(field), most.max(field)));
        Some(Self {
            name: first.name.clone(),
            eye: spline(&|camera| camera.eye),
            target: spline(&|camera| camera.target),
            up: spline(&|camera| (1.0 / camera.up.length()) * camera.up),
            // Splines go a little too far where they turn round.
            fov_y: spline(&|camera| Vec3::splat(camera.fov_y)).x.clamp(least, most),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(eye: [f32; 3], fov_y: f32) -> Camera {
        let target = Vec3::new(0.0, 1.0, 0.0);
        Camera { name: String::new(), eye: eye.into(), target, up: Vec3::Y, fov_y }
    }

    fn assert_near(a: Vec3, b: Vec3) {
        assert!((a - b).length() < 1e-5, "{a:?} is not {b:?}");
    }

    #[test]
    fn turning_keeps_height_and_distance() {
        let first = camera([3.0, 2.0, 0.0], 35.0);
        assert_near(first.turned(Vec3::Y, 90.0).eye, Vec3::new(0.0, 2.0, -3.0));
        assert_near(first.turned(Vec3::Y, 360.0).eye, first.eye);
        let over = first.turned(Vec3::Z, 180.0);
        assert_near(over.eye, Vec3::new(-3.0, 0.0, 0.0));
        assert_near(over.up, Vec3::new(0.0, -1.0, 0.0));
    }

    #[test]
    fn ways_pass_through_all_cameras_without_corners() {
        let corners = [[0.0, 1.0, 5.0], [4.0, 1.0, 3.0], [5.0, 6.0, 0.0], [0.0, 1.0, 5.0]];
        let fields = [35.0, 20.0, 60.0, 35.0];
        let keys: Vec<_> =
            corners.into_iter().zip(fields).map(|(eye, fov)| camera(eye, fov)).collect();
        for keys in [&keys[..1], &keys[..2], &keys[..3], &keys[..]] {
            let last = keys.len() - 1;
            let at = |moment| Camera::on_the_way(keys, moment).expect("a camera");
            for (number, key) in keys.iter().enumerate() {
                let found = at(number as f32 / last.max(1) as f32);
                assert_near(found.eye, key.eye);
                assert!((found.fov_y - key.fov_y).abs() < 1e-3);
            }
            assert!((0..=100).all(|i| (20.0..=60.0).contains(&at(i as f32 / 100.0).fov_y)));
            // As fast in front of a camera as behind it.
            let step = 1e-3;
            for number in 1..last {
                let moment = number as f32 / last as f32;
                let [before, here, after] =
                    [moment - step, moment, moment + step].map(|moment| at(moment).eye);
                assert!(((here - before) - (after - here)).length() < 1e-3);
            }
        }
        // A straight way stays straight, and a round trip has no corner at its end.
        let straight = [camera([0.0; 3], 35.0), camera([2.0, 0.0, 0.0], 35.0)];
        let half = Camera::on_the_way(&straight, 0.25).expect("a camera");
        assert_near(half.eye, Vec3::new(0.5, 0.0, 0.0));
        let at = |moment| Camera::on_the_way(&keys, moment).expect("a camera").eye;
        let [out, back] = [at(1e-3) - at(0.0), at(1.0) - at(1.0 - 1e-3)];
        assert!((out - back).length() < 1e-3, "{out:?} and {back:?}");
        assert_eq!(Camera::on_the_way(&[], 0.5), None);
    }
}
