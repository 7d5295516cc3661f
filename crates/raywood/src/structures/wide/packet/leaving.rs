//! Rays that certainly leave the plane of a triangle: what shadow rays do with the triangle that they start on, and with its neighbours.
//!
//! They begin so close to these that the packet, which measures depths from the light, cannot tell on which side. Where the ray begins and where it goes can
//! be told apart much better by the ray itself.

use super::{GROUP, Packet};
use crate::Vec3;
use crate::double::{Double3, cross, dot, double, sub};
use crate::simd::{Float, Kernel, Simd};
use crate::structures::wide::source::Source;
use crate::structures::wide::step;

/// The plane of a triangle, in double precision.
pub(super) struct Plane {
    normal: Double3,
    corner: Double3,
    /// The size of the normal.
    size: f64,
}

/// What is computed here is off by less than this share of its largest term: a few roundings of double precision, and what the exact test of single
/// precision may add.
const ERROR: f64 = 1e-13;

/// The same but for the exact test, which for rays of double precision adds nothing.
const OWN_ERROR: f64 = 4e-15;

impl Plane {
    #[inline(always)]
    pub(super) fn of([a, b, c]: [Double3; 3]) -> Self {
        // Differences of single numbers are rounded in their last double digit, if at all.
        let (u, v) = (sub(b, a), sub(c, a));
        Self { normal: cross(u, v), corner: a, size: length(u) * length(v) }
    }

    /// Whether a ray starts beside the plane and goes away from it, beyond all doubt.
    #[inline(always)]
    pub(super) fn is_left_by<R: Source>(&self, [origin, direction]: [Double3; 2]) -> bool {
        let error = if R::IS_ROUNDED { OWN_ERROR } else { ERROR };
        let start = sub(origin, self.corner);
        let (height, rise) = (dot(self.normal, start), dot(self.normal, direction));
        let height_certain = height.abs() > error * self.size * length(start);
        let rise_certain = rise.abs() > error * self.size * length(direction);
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
        if R::IS_ROUNDED {
            return some & leaving_in_truth(packet, rays, group, some, &plane);
        }
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
            let line = [double(origin), double(direction)];
            *leaving = u32::from(plane.is_left_by::<R>(line)) << lane;
        }
        some & leaving.into_iter().fold(0, |all, lane| all | lane)
    }
}

/// The same of rays that are rounded, as they are in truth: one by one, for they are not in columns.
#[inline(always)]
fn leaving_in_truth<R: Source>(
    packet: &Packet,
    rays: &R,
    group: usize,
    some: u32,
    plane: &Plane,
) -> u32 {
    step::lanes(some)
        .filter(|&lane| plane.is_left_by::<R>(rays.line(usize::from(packet.numbers[group][lane]))))
        .fold(0, |all, lane| all | 1 << lane)
}

/// The sum of the coordinates' sizes: at least the length.
#[inline(always)]
fn length(v: Double3) -> f64 {
    v[0].abs() + v[1].abs() + v[2].abs()
}
