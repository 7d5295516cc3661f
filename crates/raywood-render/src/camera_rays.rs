//! Rays from the eye through the pixels of a picture.

use std::fmt;

use raywood::{Ray, Vec3};
use raywood_scene::Camera;

use crate::bounds_overlay::Projection;
use crate::lens::Lens;
use crate::options::RenderOptions;
use crate::path_samples::PathSamples;
use crate::sampling::PixelSamples;

/// Why nothing can be seen through a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CameraError {
    /// The eye, the target or the up vector is NaN or infinite.
    NotFinite,
    /// The eye is where the target is, so there is no direction of view.
    NoDirection,
    /// The field of view is not above 0 and below 180 degrees.
    FieldOfView {
        /// What it is, in degrees.
        fov_y: f32,
    },
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => write!(f, "the camera's eye, target and up must be finite numbers"),
            Self::NoDirection => {
                write!(f, "the camera's eye and target are the same point: move one of them")
            }
            Self::FieldOfView { fov_y } => {
                write!(
                    f,
                    "the camera's field of view is {fov_y} degrees: it must be above 0 and below 180"
                )
            }
        }
    }
}

impl std::error::Error for CameraError {}

/// A camera in front of a grid of pixels: a pinhole, or a thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRays {
    eye: Vec3,
    /// The direction to the picture's upper left corner, and the steps from pixel to pixel.
    corner: Vec3,
    step_x: Vec3,
    step_y: Vec3,
    /// The line of sight, unit length.
    forward: Vec3,
    lens: Option<Lens>,
}

impl CameraRays {
    /// Rays for a picture of `width` x `height` square pixels.
    ///
    /// An `up` along the line of sight, or zero, is replaced by another direction: y, or z where y is no better.
    ///
    /// # Errors
    ///
    /// The camera holds NaN or infinity, has no direction of view, or an impossible field of view.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Result<Self, CameraError> {
        let Camera { eye, target, up, fov_y, .. } = *camera;
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if !(fov_y > 0.0 && fov_y < 180.0) {
            return Err(CameraError::FieldOfView { fov_y });
        }
        // Halved, so that two points at the far ends of the number range still have a difference.
        let forward = (0.5 * target - 0.5 * eye).normalize_or_zero();
        if forward == Vec3::ZERO {
            return Err(CameraError::NoDirection);
        }

        // Right and up of the picture. The first `up` that is not within a thousandth of the line of sight will do.
        let right = [up.normalize_or_zero(), Vec3::Y, Vec3::Z]
            .map(|up| forward.cross(up))
            .into_iter()
            .find(|right| right.length() > 1e-3)
            .map_or(Vec3::X, Vec3::normalize_or_zero);
        let up = right.cross(forward);

        // The picture at distance 1, in steps of pixels.
        let half_height = (0.5 * fov_y.to_radians()).tan();
        let pixel = 2.0 * half_height / height as f32;
        let (step_x, step_y) = (pixel * right, -pixel * up);
        let corner = forward - (0.5 * width as f32) * step_x - (0.5 * height as f32) * step_y;
        Ok(Self { eye, corner, step_x, step_y, forward, lens: None })
    }

    /// The same camera with a lens, if there is any.
    #[must_use]
    pub fn with_lens(self, lens: Option<Lens>) -> Self {
        // A lens without extent is a pinhole, whose rays are traced faster.
        Self { lens: lens.filter(|lens| lens.radius > 0.0), ..self }
    }

    /// The lens, if the camera is no pinhole.
    #[inline(always)]
    pub(crate) fn lens(&self) -> Option<&Lens> {
        self.lens.as_ref()
    }

    /// How far in front of the eye a point on a ray of this direction is, by unit of length along the ray.
    pub(crate) fn depth_along(&self, direction: Vec3) -> f32 {
        self.forward.dot(direction)
    }

    /// The ray through a point of the lens that meets what the ray through its middle, of this direction, meets in the plane of focus.
    #[inline]
    pub(crate) fn through_lens(&self, lens: &Lens, direction: Vec3, path: PathSamples) -> Ray {
        let axes = [self.step_x, -self.step_y].map(Vec3::normalize_or_zero);
        let offset = lens.point(path.pair(PathSamples::LENS), axes);
        let focused = lens.focus / self.depth_along(direction) * direction;
        Ray::new(self.eye + offset, (focused - offset).normalize_or_zero())
    }

    /// The ray through a point of the picture, in pixels from its upper left corner (the first pixel's centre is
    /// `(0.5, 0.5)`). Its direction is of unit length.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        self.ray_along(self.direction(x, y))
    }

    /// The direction of unit length through a point of the picture.
    #[inline(always)]
    pub(crate) fn direction(&self, x: f32, y: f32) -> Vec3 {
        let direction = self.corner + x * self.step_x + y * self.step_y;
        direction / direction.length()
    }

    /// How wide a pixel is at distance 1, in the middle of the picture.
    pub(crate) fn pixel_width(&self) -> f32 {
        self.step_x.length()
    }

    /// Where all rays start.
    #[inline(always)]
    pub(crate) fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The ray from the eye in a direction.
    #[inline(always)]
    pub(crate) fn ray_along(&self, direction: impl Into<[f32; 3]>) -> Ray {
        Ray::new(self.eye, direction)
    }

    /// The primary rays of the pixel in column `x` and row `y`: [`PixelSamples`] says where they pass. Through the middle of the lens.
    #[inline]
    pub fn pixel_rays(&self, x: u32, y: u32, samples: u32) -> impl Iterator<Item = Ray> {
        let options = RenderOptions { samples, ..RenderOptions::default() };
        self.with_lens(None).rays_of([x, y], &options)
    }

    /// The primary rays of a pixel in a picture of these options.
    pub(crate) fn rays_of(
        self,
        place: [u32; 2],
        options: &RenderOptions,
    ) -> impl Iterator<Item = Ray> + use<> {
        let &RenderOptions { samples, filter, seed, .. } = options;
        let pattern = PixelSamples::spread(place, samples, filter, seed);
        let [x, y] = place.map(|x| x as f32 + 0.5);
        (0..samples).map(move |index| {
            let [dx, dy] = pattern.offset(index);
            match &self.lens {
                None => self.ray(x + dx, y + dy),
                Some(lens) => {
                    let path = PathSamples::seeded(place, index, seed);
                    self.through_lens(lens, self.direction(x + dx, y + dy), path)
                }
            }
        })
    }

    /// Where points appear in the picture: the inverse of [`ray`](Self::ray).
    pub(crate) fn projection(&self) -> Projection {
        Projection::new(self.eye, [self.step_x, self.step_y, self.corner])
    }
}
