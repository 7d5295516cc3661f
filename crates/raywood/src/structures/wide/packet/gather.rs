//! Making a packet of rays.

use super::frame::Frame;
use super::{GROUP, Groups, NONE, Packet, RAYS};
use crate::simd::{Float, Simd};
use crate::structures::wide::source::{self, Source};
use crate::{Ray, Vec3};

/// Rays that rise more steeply against the packet's main axis do not come with it.
const STEEPEST: f32 = 20.0;

/// With fewer rays a packet is not worth while.
const FEWEST: u32 = 32;

/// Points are taken for one that differ by no more than so many roundings of the coordinates on the way.
const ROUNDINGS: f32 = 4.0 * f32::EPSILON;

/// Rays that end from here on, and before one, are taken for such that stop a little before the point that they go to.
const NEARLY_ONE: f32 = 0.99;

/// Rays in the order in which they come.
const NUMBERS: [[u8; GROUP]; GROUP] = {
    let mut numbers = [[0; GROUP]; GROUP];
    let mut number = 0;
    while number < RAYS {
        numbers[number / GROUP][number % GROUP] = number as u8;
        number += 1;
    }
    numbers
};

/// What rays may have in common.
enum Common {
    Origin(Vec3),
    /// A point that they go to.
    Target(Vec3),
}

impl Common {
    /// What most rays have in common, judged by a few of them.
    fn of<R: Source>(rays: &R, any: bool) -> Option<Self> {
        let middle = rays.ray(rays.len() / 2);
        match R::COMMON {
            Some(source::Common::Origin) => return Some(Self::Origin(middle.origin)),
            Some(source::Common::Target) => return Some(Self::Target(middle.at(1.0))),
            None => {}
        }
        let samples = [0, 1, 2, 3, 4].map(|part| rays.ray(part * (rays.len() - 1) / 4));
        let middle = samples[2];
        if samples.iter().filter(|ray| ray.origin == middle.origin).count() >= 3 {
            return Some(Self::Origin(middle.origin));
        }
        let point = middle.at(length(&middle));
        let most = allowance(point, middle.origin);
        let close = |ray: &&Ray| passed(ray, point) <= most;
        (any && point.is_finite() && samples.iter().filter(close).count() >= 3)
            .then_some(Self::Target(point))
    }
}

/// At which distance a ray is at the point that it goes to: where it ends, or where a ray [between](Ray::between) points would end that
/// stops a little before.
fn length(ray: &Ray) -> f32 {
    if (NEARLY_ONE..1.0).contains(&ray.t_max) { 1.0 } else { ray.t_max }
}

/// How far a ray passes by the point that it goes to.
fn passed(ray: &Ray, point: Vec3) -> f32 {
    (ray.at(length(ray)) - point).abs().max_element()
}

/// How far a ray from `origin` may pass by the point that it goes to by rounding.
fn allowance(point: Vec3, origin: Vec3) -> f32 {
    ROUNDINGS * point.abs().max(origin.abs()).max_element()
}

impl Packet {
    /// Makes the packet of at most 256 rays. Numbers of rays that do not fit in are appended to `rest`, counted from `first`; if none are left
    /// there is no packet, and the answer is `false`.
    #[inline(always)]
    pub(super) fn gather<S: Simd, R: Source, const ANY: bool>(
        &mut self,
        simd: S,
        rays: &R,
        rest: &mut Vec<usize>,
        first: usize,
    ) -> bool {
        let common = if rays.len() < FEWEST as usize { None } else { Common::of(rays, ANY) };
        let Some(common) = common else {
            rest.extend(first..first + rays.len());
            return false;
        };
        let middle = rays.ray(rays.len() / 2);
        // Rays with a common end are looked at from there.
        let (point, turned) = match common {
            Common::Origin(origin) => {
                self.frame = Frame::new(origin, 0.0, middle.direction);
                (origin, 1.0)
            }
            Common::Target(target) => {
                let offset = allowance(target, middle.origin);
                self.frame = Frame::new(target, offset, -middle.direction);
                (target, -1.0)
            }
        };

        let (zero, one, never) =
            (simd.splat16(0.0), simd.splat16(1.0), simd.splat16(f32::INFINITY));
        let turn = simd.splat16(turned);
        let z_turn = turn * simd.splat16(self.frame.sign);
        let allowed = simd.splat16(self.frame.offset);
        let origin = [simd.splat16(point.x), simd.splat16(point.y), simd.splat16(point.z)];
        let [x_axis, y_axis, z_axis] = self.frame.axes;
        let (mut count, mut bounded, mut latest) = (0, 0, zero);
        for group in 0..GROUP {
            // Sixteen rays, coordinate by coordinate; what is missing behind the last is no ray.
            let here = rays.len().saturating_sub(group * GROUP).min(GROUP);
            let [ox, oy, oz, start, dx, dy, dz, end] = rays.columns(simd, group * GROUP);
            let d = [dx, dy, dz];

            // Which of them pass through the point, and where on their way.
            let (passed, length, from_start) = match common {
                Common::Origin(_) => {
                    let [x, y, z] = [ox - origin[0], oy - origin[1], oz - origin[2]];
                    ([x, y, z], end, zero)
                }
                Common::Target(_) => {
                    let nearly = simd.splat16(NEARLY_ONE).less_or_equal(end) & end.less(one);
                    let length = match R::COMMON {
                        Some(_) => one,
                        None => end.replaced(nearly, one),
                    };
                    let x = dx.mul_add(length, ox) - origin[0];
                    let y = dy.mul_add(length, oy) - origin[1];
                    let z = dz.mul_add(length, oz) - origin[2];
                    ([x, y, z], length, length - end)
                }
            };
            let z = d[z_axis] * z_turn;
            let (x, y) = (d[x_axis] * turn, d[y_axis] * turn);
            let members = x.abs().less_or_equal(z * simd.splat16(STEEPEST))
                & y.abs().less_or_equal(z * simd.splat16(STEEPEST))
                & simd.splat16(Ray::SHORTEST_DIRECTION).less_or_equal(z)
                & z.less(simd.splat16(1.0 / Ray::SHORTEST_DIRECTION))
                & zero.less(end)
                & start.less_or_equal(zero)
                & zero.less_or_equal(start)
                & passed[0].abs().less_or_equal(allowed)
                & passed[1].abs().less_or_equal(allowed)
                & passed[2].abs().less_or_equal(allowed);
            self.members[group] = members;
            if members.count_ones() as usize != here {
                let missing = (0..here).filter(|lane| members >> lane & 1 == 0);
                rest.extend(missing.map(|lane| first + group * GROUP + lane));
            }

            // Their slopes, and how far they reach.
            latest = latest.larger(zero.replaced(members, z * from_start));
            bounded |= members & end.less(never);
            let scale = one / z;
            let (x, y) = (x * scale, y * scale);
            self.slopes[0][group] = zero.replaced(members, x).to_array();
            self.slopes[1][group] = zero.replaced(members, y).to_array();
            self.scales[group] = scale.to_array();
            // Divisions are slow, and here the length is known.
            let limit = match R::COMMON {
                Some(source::Common::Origin) => zero,
                Some(source::Common::Target) => scale,
                None => scale / length,
            };
            let limit = limit * simd.splat16(1.0 - 1.0 / (1 << 20) as f32);
            let limit = never.replaced(members, limit);
            self.nearest[group] = limit.to_array();
            self.primitives[group] = [f32::from_bits(NONE); GROUP];
            count += members.count_ones();
        }
        self.is_bounded = bounded != 0;
        self.start = 1.0 / latest.greatest();
        self.numbers = NUMBERS;
        self.measure(simd);
        let scattered = self.scattered(simd);
        let is_sorted = count >= FEWEST && scattered.count_ones() > 1;
        self.sorted = if is_sorted { scattered } else { 0 };
        if is_sorted {
            self.sort(simd, scattered);
            self.measure(simd);
        }
        self.groups.live != 0
    }

    /// Computes what the rays of each group have in common.
    #[inline(always)]
    fn measure<S: Simd>(&mut self, simd: S) {
        self.groups = Groups::NONE;
        let above = simd.splat16(f32::INFINITY);
        let below = simd.splat16(f32::NEG_INFINITY);
        let groups = &mut self.groups;
        groups.least = simd.least_of_rows(&self.nearest).to_array();
        for axis in 0..2 {
            groups.slopes[axis][0] = simd.least_of_rows(&self.slopes[axis]).to_array();
            groups.slopes[axis][1] = simd.greatest_of_rows(&self.slopes[axis]).to_array();
        }
        for (group, &members) in self.members.iter().enumerate() {
            groups.live |= u32::from(members != 0) << group;
            if members != 0xffff {
                // Lanes without a ray do not count.
                for axis in 0..2 {
                    let slopes = simd.load16(&self.slopes[axis][group]);
                    groups.slopes[axis][0][group] = above.replaced(members, slopes).least();
                    groups.slopes[axis][1][group] = below.replaced(members, slopes).greatest();
                }
            }
        }
        self.groups.prepare(simd);
        self.groups.look_again(simd);
    }
}
