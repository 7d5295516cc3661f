//! Rays that certainly leave the plane of a triangle: what shadow rays do with the triangle that they start on, and with its neighbours.
//!
//! They begin so close to these that the packet, which measures depths from the light, cannot tell on which side. Where the ray begins and where it goes can
//! be told apart much better by the ray itself.

use super::{GROUP, Packet};
use crate::simd::{Float, Kernel, Simd};
use crate::structures::wide::source::Source;
use crate::{Ray, Vec3};

/// The plane of a triangle, in double precision.
pub(super) struct Plane {
    normal: [f64; 3],
    corner: [f64; 3],
    /// The size of the normal.
    size: f64,
}

/// What is computed here is off by less than this share of its largest term: a few roundings of double precision.
const ERROR: f64 = 1e-13;

impl Plane {
    #[inline(always)]
    pub(super) fn of([a, b, c]: [Vec3; 3]) -> Self {
        let [a, b, c] = [a, b, c].map(wide);
        // Differences of single numbers are rounded in their last double digit, if at all.
        let (u, v) = (minus(b, a), minus(c, a));
        let normal =
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        Self { normal, corner: a, size: length(u) * length(v) }
    }

    /// Whether the ray starts beside the plane and goes away from it, beyond all doubt.
    #[inline]
    pub(super) fn is_left_by(&self, ray: &Ray) -> bool {
        self.is_left(ray.origin, ray.direction)
    }

    #[inline(always)]
    fn is_left(&self, origin: Vec3, direction: Vec3) -> bool {
        let direction = wide(direction);
        let start = minus(wide(origin), self.corner);
        let (height, rise) = (dot(self.normal, start), dot(self.normal, direction));
        let height_certain = height.abs() > ERROR * self.size * length(start);
        let rise_certain = rise.abs() > ERROR * self.size * length(direction);
        // The exact test rounds the distance: to zero, which counts, if it is less than the smallest number.
        let far_enough = height.abs() > f64::from(f32::MIN_POSITIVE) * rise.abs();
        (height * rise > 0.0) & height_certain & rise_certain & far_enough
    }
}

/// Which of some rays of a group certainly leave the plane of a triangle: where a packet starts on a surface it is asked for all of them, and sixteen at
/// a time take a tenth of the time.
pub(super) struct Leaving<'a, R> {
    pub(super) packet: &'a Packet,
    pub(super) rays: &'a R,
    pub(super) group: usize,
    pub(super) some: u32,
    pub(super) plane: Plane,
}

impl<R: Source> Kernel for Leaving<'_, R> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u32 {
        let Self { packet, rays, group, some, plane } = self;

        // The rays in columns.
        let mut origins = [[0.0; GROUP]; 3];
        let mut directions = [[0.0; GROUP]; 3];
        if packet.sorted >> group & 1 == 0 {
            let [ox, oy, oz, _, dx, dy, dz, _] = rays.columns(simd, group * GROUP);
            origins = [ox.to_array(), oy.to_array(), oz.to_array()];
            directions = [dx.to_array(), dy.to_array(), dz.to_array()];
        } else {
            for lane in (0..GROUP).filter(|lane| some >> lane & 1 == 1) {
                let ray = rays.ray(usize::from(packet.numbers[group][lane]));
                for axis in 0..3 {
                    origins[axis][lane] = ray.origin[axis];
                    directions[axis][lane] = ray.direction[axis];
                }
            }
        }

        // As one by one, without a branch.
        let mut leaving = [0; GROUP];
        for (lane, leaving) in leaving.iter_mut().enumerate() {
            let origin = Vec3::new(origins[0][lane], origins[1][lane], origins[2][lane]);
            let direction =
                Vec3::new(directions[0][lane], directions[1][lane], directions[2][lane]);
            *leaving = u32::from(plane.is_left(origin, direction)) << lane;
        }
        some & leaving.into_iter().fold(0, |all, lane| all | lane)
    }
}

#[inline(always)]
fn wide(v: Vec3) -> [f64; 3] {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

#[inline(always)]
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The sum of the coordinates' sizes: at least the length.
#[inline(always)]
fn length(v: [f64; 3]) -> f64 {
    v[0].abs() + v[1].abs() + v[2].abs()
}
