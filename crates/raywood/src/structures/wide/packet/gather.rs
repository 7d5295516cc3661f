//! Making a packet of rays.

use super::frame::Frame;
use super::kind::{Blocked, BlockedParallel, Closest, Kind, Reflected};
use super::meeting::{Meeting, NEARLY_ONE};
use super::triangles::ROUNDING;
use super::waiting::Waiters;
use super::{GROUP, Groups, LIMIT_ERROR, NONE, Packet, RAYS};
use crate::Ray;
use crate::simd::{Float, Simd};
use crate::structures::wide::WideBvh;
use crate::structures::wide::source::{Common, Source};

/// What rays pass by the point that they go to at is known up to so many roundings of its coordinates, and of products on the way.
const MEASURING_ROUNDINGS: f32 = 2.0;

/// Rays that rise more steeply against the packet's main axis do not come with it.
pub(super) const STEEPEST: f32 = 20.0;

/// With fewer rays a packet is not worth while.
pub(super) const FEWEST: u32 = 32;

/// Groups of fewer rays on average are brought together.
const ENOUGH: u32 = 12;

/// Rays in the order in which they come.
pub(super) const NUMBERS: [[u8; GROUP]; GROUP] = {
    let mut numbers = [[0; GROUP]; GROUP];
    let mut number = 0;
    while number < RAYS {
        numbers[number / GROUP][number % GROUP] = number as u8;
        number += 1;
    }
    numbers
};

impl Packet {
    /// Makes a packet of those that [wait](Self::waiting) of at most 256 rays. These wait no longer then, and the answer is what they have in common. If
    /// too few have anything in common there is no packet.
    #[inline(always)]
    pub(super) fn gather<S: Simd, R: Source, const ANY: bool>(
        &mut self,
        simd: S,
        rays: &R,
        tree: &WideBvh,
    ) -> Option<Common> {
        let waiting = self.waiting;
        let waiters = Waiters::new(rays, &waiting);
        if waiters.count < FEWEST as usize {
            return None;
        }
        let meeting = Meeting::of_two(&waiters, ANY)
            .or_else(|| Meeting::of_five(&waiters, ANY))
            .or_else(|| if ANY { None } else { Meeting::in_image(&waiters) });
        let Meeting { kind, point, offset, direction } = meeting?;
        // Known beforehand wherever it can be: the loop below is made for one kind then.
        let kind = R::COMMON.unwrap_or(kind);
        if ANY && R::COMMON.is_none() && kind == Common::Direction {
            self.gather_parallel(simd, rays, (point, direction), tree);
            return self.arrange::<S, BlockedParallel>(simd).then_some(kind);
        }
        if !ANY && R::COMMON.is_none() && kind == Common::Image {
            self.gather_image(simd, rays, (point, offset), direction, tree);
            return self.arrange::<S, Reflected>(simd).then_some(kind);
        }
        // Rays with a common end are looked at from there.
        self.frame = Frame::new(point, offset, direction);
        let turned = match kind {
            Common::Origin | Common::Direction | Common::Image => 1.0,
            Common::Target => -1.0,
        };

        let (zero, one, never) =
            (simd.splat16(0.0), simd.splat16(1.0), simd.splat16(f32::INFINITY));
        let turn = simd.splat16(turned);
        let z_turn = turn * simd.splat16(self.frame.sign);
        let allowed = simd.splat16(self.frame.offset);
        let origin = [simd.splat16(point.x), simd.splat16(point.y), simd.splat16(point.z)];
        let [x_axis, y_axis, z_axis] = self.frame.axes;
        let [center_x, center_y, center_z] = tree.parts.center.to_array();
        let (mut bounded, mut latest, mut farthest) = (0, zero, zero);
        let (mut misses, mut products) = (zero, zero);
        for group in 0..GROUP {
            let wanted = self.waiting.rays[group];
            self.members[group] = 0;
            if wanted == 0 {
                continue;
            }

            // Sixteen rays, coordinate by coordinate.
            let [ox, oy, oz, start, dx, dy, dz, end] = rays.columns(simd, group * GROUP);
            let d = [dx, dy, dz];

            // Which of them pass through the point, and where on their way.
            let (passed, length, from_start) = match kind {
                Common::Origin | Common::Direction | Common::Image => {
                    let [x, y, z] = [ox - origin[0], oy - origin[1], oz - origin[2]];
                    ([x, y, z], end, zero)
                }
                Common::Target => {
                    let nearly = simd.splat16(NEARLY_ONE).less_or_equal(end) & end.less(one);
                    let length = match R::COMMON {
                        Some(_) => one,
                        None => end.replaced(nearly, one),
                    };
                    let x = dx.mul_add(length, ox) - origin[0];
                    let y = dy.mul_add(length, oy) - origin[1];
                    let z = dz.mul_add(length, oz) - origin[2];
                    ([x, y, z], length, length.mul_add(simd.splat16(LIMIT_ERROR), length - end))
                }
            };
            let z = d[z_axis] * z_turn;
            let (x, y) = (d[x_axis] * turn, d[y_axis] * turn);
            let members = wanted
                & x.abs().less_or_equal(z * simd.splat16(STEEPEST))
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

            // How far from the tree they start, as far as that is not known.
            if kind == Common::Target && tree.parts.exist() {
                let x = (ox - simd.splat16(center_x)).abs();
                let y = (oy - simd.splat16(center_y)).abs();
                let z = (oz - simd.splat16(center_z)).abs();
                farthest = farthest.larger(zero.replaced(members, x.larger(y).larger(z)));
            }

            // Their slopes, and how far they reach.
            latest = latest.larger(zero.replaced(members, z * from_start));
            bounded |= members & end.less(never);
            let scale = one / z;
            let (x, y) = (x * scale, y * scale);
            // How far they pass by the point, as a rule much less than what is allowed, and the products that may have been rounded to find that.
            if kind == Common::Target {
                let by_z = passed[z_axis].abs();
                let by_x = x.abs().mul_add(by_z, passed[x_axis].abs());
                let by_y = y.abs().mul_add(by_z, passed[y_axis].abs());
                misses = misses.larger(zero.replaced(members, by_x.larger(by_y).larger(by_z)));
                if !S::FUSES {
                    let rounded = members & (one.less(length) | length.less(one));
                    let product = dx.abs().larger(dy.abs()).larger(dz.abs()) * length;
                    products = products.larger(zero.replaced(rounded, product));
                }
            }
            self.slopes[0][group] = zero.replaced(members, x).to_array();
            self.slopes[1][group] = zero.replaced(members, y).to_array();
            self.scales[group] = scale.to_array();
            // Divisions are slow, and here the length is known.
            let limit = match R::COMMON {
                Some(Common::Origin | Common::Direction | Common::Image) => zero,
                Some(Common::Target) => scale,
                None => scale / length,
            };
            let limit = limit * simd.splat16(1.0 - LIMIT_ERROR);
            let limit = never.replaced(members, limit);
            self.nearest[group] = limit.to_array();
            self.primitives[group] = [f32::from_bits(NONE); GROUP];
        }
        if kind == Common::Target {
            let size = point.abs().max_element() + products.greatest();
            self.frame.offset = misses.greatest() + MEASURING_ROUNDINGS * ROUNDING * size;
        }
        let from_center = (point - tree.parts.center).abs().max_element();
        let distance = from_center.max(farthest.greatest());
        self.frame.widen_for_parts(&tree.parts, distance);
        self.frame.widen_for_rounding(rays);
        self.is_bounded = bounded != 0;
        self.start = 1.0 / latest.greatest();
        self.numbers = NUMBERS;
        let is_packet = match ANY {
            true => self.arrange::<S, Blocked>(simd),
            false => self.arrange::<S, Closest>(simd),
        };
        is_packet.then_some(kind)
    }

    /// Brings the rays into an order in which groups are compact, if need be, and tells whether there are enough of them.
    #[inline(always)]
    fn arrange<S: Simd, K: Kind>(&mut self, simd: S) -> bool {
        let count = self.members.iter().map(|members| members.count_ones()).sum::<u32>();
        if count < FEWEST {
            return false;
        }
        self.waiting = self.waiting.without(&self.members);
        self.measure::<S, K>(simd);
        let mut scattered = self.scattered(simd);
        let live = self.groups.live;
        if count < live.count_ones() * ENOUGH {
            // Where others come between the rays, as such to another light do, sorting also brings them together in fewer groups.
            scattered = live;
        }
        let is_sorted = scattered.count_ones() > 1;
        self.sorted = if is_sorted { scattered } else { 0 };
        if is_sorted {
            self.sort::<S, K>(simd, scattered);
            self.measure::<S, K>(simd);
            scattered = self.scattered(simd);
        }
        self.wide = scattered;
        true
    }

    /// Computes what the rays of each group have in common.
    #[inline(always)]
    fn measure<S: Simd, K: Kind>(&mut self, simd: S) {
        self.groups = Groups::with_slack(self.frame.slack);
        let above = simd.splat16(f32::INFINITY);
        let below = simd.splat16(f32::NEG_INFINITY);
        let groups = &mut self.groups;
        groups.least = simd.least_of_rows(&self.nearest).to_array();
        if K::LATE {
            groups.begin_at(simd, simd.least_of_rows(&self.starts));
        }
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
        self.groups.look_again::<S, K>(simd);
    }
}
