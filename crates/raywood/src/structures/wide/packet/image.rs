//! Rays that a plane mirror sends on: their lines meet behind it, in the image of the point that they come from.
//!
//! So everything is as for rays that start at that point, but that nothing counts before the mirror. Directions and origins of such rays were rounded, so their
//! lines pass by the image at some distance, which is measured, and taken into account as that by which shadow rays miss their light.

use super::frame::Frame;
use super::gather::{NUMBERS, STEEPEST};
use super::meeting::Meeting;
use super::triangles::ROUNDING;
use super::waiting::Waiters;
use super::{GROUP, NONE, Packet};
use crate::simd::{Float, Simd};
use crate::structures::wide::WideBvh;
use crate::structures::wide::source::{Common, Source};
use crate::{Ray, Vec3};

/// How many rays are looked at.
const SAMPLES: usize = 8;

/// A packet is made where at least so many of them agree: two of them always do.
const ENOUGH: usize = 3;

/// Lines that pass by the image at more than so many roundings of the coordinates do not belong to it.
const ROUNDINGS: f32 = 64.0 * f32::EPSILON;

/// What a ray passes by the image at is known up to so many roundings of its origin's distance.
const MEASURING_ROUNDINGS: f32 = 8.0;

/// Rays that start farther from the image, or closer by, do not come with the packet.
const FARTHEST: f32 = 1e15;
/// See [`FARTHEST`].
const NEAREST: f32 = 1e-15;

impl Meeting {
    /// The point before their starts where the lines of some rays meet, if there is any.
    #[cold]
    #[inline(never)]
    pub(super) fn in_image<R: Source>(rays: &Waiters<'_, R>) -> Option<Self> {
        let samples: [Ray; SAMPLES] =
            std::array::from_fn(|part| rays.ray((2 * part + 1) * rays.count / (2 * SAMPLES)));

        // Neighbours tend to be mirrored alike: see for each two of them who agrees.
        let mut best = 0u32;
        for pair in samples.windows(2) {
            if let Some(image) = Image::of(&pair[0], &pair[1]) {
                let agreeing = image.agreeing(&samples);
                if agreeing.count_ones() > best.count_ones() {
                    best = agreeing;
                }
            }
        }
        if (best.count_ones() as usize) < ENOUGH {
            return None;
        }

        // The two that are farthest apart know best where it is.
        let first = best.trailing_zeros() as usize;
        let last = (u32::BITS - 1 - best.leading_zeros()) as usize;
        let Image { point, allowed } = Image::of(&samples[first], &samples[last])?;
        let direction = samples[last].direction;
        Some(Self { kind: Common::Image, point, offset: allowed, direction })
    }
}

/// Where two lines meet.
struct Image {
    point: Vec3,
    /// How far a line that belongs to it may pass by.
    allowed: f32,
}

impl Image {
    /// Where the lines of two rays meet, if they do so before both starts.
    fn of(one: &Ray, other: &Ray) -> Option<Self> {
        let wide = |v: Vec3| [f64::from(v.x), f64::from(v.y), f64::from(v.z)];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let at =
            |from: [f64; 3], t: f64, d: [f64; 3]| [0, 1, 2].map(|axis| from[axis] + t * d[axis]);
        let (a, b) = (wide(one.origin), wide(other.origin));
        let (along_a, along_b) = (wide(one.direction), wide(other.direction));

        // Where each is closest to the other.
        let between = at(a, -1.0, b);
        let (aa, ab, bb) = (dot(along_a, along_a), dot(along_a, along_b), dot(along_b, along_b));
        let (from_a, from_b) = (dot(along_a, between), dot(along_b, between));
        let determinant = aa * bb - ab * ab;
        let (t_a, t_b) = (ab * from_b - bb * from_a, aa * from_b - ab * from_a);
        // Lines that are next to parallel meet far away, or anywhere. (NaN is no meeting either.)
        let meet = determinant > 1e-10 * aa * bb && t_a < 0.0 && t_b < 0.0;
        if !meet {
            return None;
        }
        let (on_a, on_b) = (at(a, t_a / determinant, along_a), at(b, t_b / determinant, along_b));
        let point = Vec3::from([0, 1, 2].map(|axis| (0.5 * (on_a[axis] + on_b[axis])) as f32));
        let size = point.abs().max(one.origin.abs()).max(other.origin.abs()).max_element();
        let image = Self { point, allowed: ROUNDINGS * size };
        (image.is_of(one) && image.is_of(other)).then_some(image)
    }

    /// Whether the line of a ray passes.
    fn is_of(&self, ray: &Ray) -> bool {
        let axis = ray.direction.abs().max_axis();
        let back = (ray.origin[axis] - self.point[axis]) / ray.direction[axis];
        let passed = (ray.at(-back) - self.point).abs().max_element();
        back > 0.0 && passed <= self.allowed
    }

    /// Which rays' lines pass, a bit for each.
    fn agreeing(&self, rays: &[Ray; SAMPLES]) -> u32 {
        let bits = rays.iter().enumerate().map(|(place, ray)| u32::from(self.is_of(ray)) << place);
        bits.fold(0, |all, bit| all | bit)
    }
}

impl Packet {
    /// As [`gather`](Packet::gather), with rays without an end whose lines pass by a point, none farther than `allowed`.
    #[inline(always)]
    pub(super) fn gather_image<S: Simd, R: Source>(
        &mut self,
        simd: S,
        rays: &R,
        (point, allowed): (Vec3, f32),
        direction: Vec3,
        tree: &WideBvh,
    ) {
        self.frame = Frame::new(point, 0.0, direction);
        let [x_axis, y_axis, z_axis] = self.frame.axes;
        let sign = simd.splat16(self.frame.sign);
        let (zero, one, never) =
            (simd.splat16(0.0), simd.splat16(1.0), simd.splat16(f32::INFINITY));
        let steepest = simd.splat16(STEEPEST);
        let allowed = simd.splat16(allowed);
        let from_center = (point - tree.parts.center).abs().max_element();
        let point = [simd.splat16(point.x), simd.splat16(point.y), simd.splat16(point.z)];
        let (mut misses, mut farthest) = (zero, zero);
        for group in 0..GROUP {
            let wanted = self.waiting.rays[group];
            self.members[group] = 0;
            if wanted == 0 {
                continue;
            }

            // Sixteen rays, their slopes, and where they start as seen from the point.
            let [ox, oy, oz, start, dx, dy, dz, end] = rays.columns(simd, group * GROUP);
            let (o, d) = ([ox, oy, oz], [dx, dy, dz]);
            let depth = d[z_axis] * sign;
            let scale = one / depth;
            let (x, y) = (d[x_axis] * scale, d[y_axis] * scale);
            let from_x = o[x_axis] - point[x_axis];
            let from_y = o[y_axis] - point[y_axis];
            let from_z = (o[z_axis] - point[z_axis]) * sign;

            // How far they pass by.
            let by_x = (zero - x).mul_add(from_z, from_x).abs();
            let by_y = (zero - y).mul_add(from_z, from_y).abs();
            let by = by_x.larger(by_y);
            let members = wanted
                & by_x.less_or_equal(allowed)
                & by_y.less_or_equal(allowed)
                & x.abs().less_or_equal(steepest)
                & y.abs().less_or_equal(steepest)
                & simd.splat16(Ray::SHORTEST_DIRECTION).less_or_equal(depth)
                & depth.less(simd.splat16(1.0 / Ray::SHORTEST_DIRECTION))
                & simd.splat16(NEAREST).less(from_z)
                & from_z.less(simd.splat16(FARTHEST))
                & never.less_or_equal(end)
                & start.less_or_equal(zero)
                & zero.less_or_equal(start);
            self.members[group] = members;
            misses = misses.larger(zero.replaced(members, by));
            let size = from_x.abs().larger(from_y.abs()).larger(from_z);
            farthest = farthest.larger(zero.replaced(members, size));

            self.slopes[0][group] = zero.replaced(members, x).to_array();
            self.slopes[1][group] = zero.replaced(members, y).to_array();
            self.scales[group] = scale.to_array();
            self.starts[group] = never.replaced(members, from_z).to_array();
            self.nearest[group] = never.replaced(members, zero).to_array();
            self.primitives[group] = [f32::from_bits(NONE); GROUP];
        }
        let roundings = MEASURING_ROUNDINGS * ROUNDING;
        let farthest = farthest.greatest();
        self.frame.offset = misses.greatest() + roundings * farthest;
        self.frame.widen_for_parts(&tree.parts, from_center + farthest);
        self.frame.widen_for_rounding(rays);
        self.is_bounded = false;
        self.start = f32::INFINITY;
        self.numbers = NUMBERS;
    }
}
