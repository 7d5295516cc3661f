//! Making a packet of rays.

use super::frame::Frame;
use super::{GROUP, Groups, NONE, Packet, RAYS};
use crate::simd::{Float, Simd};
use crate::structures::wide::source::{Common, Source};
use crate::{Ray, Vec3};

/// Rays that rise more steeply against the packet's main axis do not come with it.
const STEEPEST: f32 = 20.0;

/// With fewer rays a packet is not worth while.
const FEWEST: u32 = 32;

/// Groups of fewer rays on average are brought together.
const ENOUGH: u32 = 12;

/// Points are taken for one that differ by no more than so many roundings of the coordinates on the way.
const ROUNDINGS: f32 = 4.0 * f32::EPSILON;

/// Rays that end from here on, and before one, are taken for such that stop a little before the point that they go to.
const NEARLY_ONE: f32 = 0.99;

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

/// Where most rays of a packet meet, judged by two of them or, where these do not agree, by five: whatever one of these is, the others decide.
struct Meeting {
    kind: Common,
    point: Vec3,
    /// How far a ray may pass by the point, along each axis.
    offset: f32,
    /// The direction of one of the rays, seen from the point.
    direction: Vec3,
}

/// Of five rays so many decide.
const MOST: usize = 3;

impl Meeting {
    /// Where two of the rays say that all meet, if they agree.
    #[inline(always)]
    fn of_two<R: Source>(rays: &R, any: bool) -> Option<Self> {
        let (one, other) = (rays.ray(rays.len() / 2), rays.ray(0));
        let (kind, point) = match (R::COMMON, rays.point()) {
            (Some(kind), Some(point)) => (kind, point),
            _ if one.origin == other.origin => (Common::Origin, one.origin),
            _ if any && is_parallel(&one, &other) => (Common::Direction, one.origin),
            _ => (Common::Target, one.at(length(&one))),
        };
        let (turn, offset) = match kind {
            Common::Origin | Common::Direction => (1.0, 0.0),
            Common::Target => (-1.0, allowance(point, one.origin.abs().max(other.origin.abs()))),
        };
        let meet = R::COMMON.is_some()
            || kind == Common::Origin
            || kind == Common::Direction && point.is_finite()
            || any && passed(&other, point) <= offset && point.is_finite();
        let axis = one.direction.abs().max_axis();
        let same_way = axis == other.direction.abs().max_axis()
            && one.direction[axis] * other.direction[axis] > 0.0;
        let agree = meet && same_way && offset < f32::INFINITY;
        agree.then_some(Self { kind, point, offset, direction: turn * one.direction })
    }

    /// Where most of five rays meet.
    #[cold]
    #[inline(never)]
    fn of_five<R: Source>(rays: &R, any: bool) -> Option<Self> {
        let samples = [2, 0, 4, 1, 3].map(|part| rays.ray(part * (rays.len() - 1) / 4));
        let (kind, point) = match (R::COMMON, rays.point()) {
            (Some(kind), Some(point)) => (kind, point),
            _ => Self::looked_for(&samples, any)?,
        };
        let (turn, offset) = match kind {
            Common::Origin | Common::Direction => (1.0, 0.0),
            Common::Target => {
                let origins = samples.iter().map(|ray| ray.origin).filter(|o| o.is_finite());
                (-1.0, origins.map(|origin| allowance(point, origin)).fold(0.0, f32::max))
            }
        };

        // The main axis of most of them, and which way along it; of parallel rays the direction that most of them have.
        let directions = samples.map(|ray| turn * ray.direction);
        let way = |direction: &Vec3| {
            let axis = direction.abs().max_axis();
            direction.is_finite().then_some((axis, direction[axis] < 0.0))
        };
        let ways = directions.each_ref().map(way);
        let alike = |one: usize, other: usize| match kind {
            Common::Direction => directions[one] == directions[other],
            _ => ways[one] == ways[other],
        };
        let votes = |place: &usize| (0..ways.len()).filter(|other| alike(*place, *other)).count();
        let best = (0..ways.len()).filter(|place| ways[*place].is_some()).max_by_key(votes)?;
        Some(Self { kind, point, offset, direction: directions[best] })
    }

    /// A point that most of some rays start at or, if `any` hit is looked for, go to; or where one of them starts if most have its direction.
    fn looked_for(samples: &[Ray; 5], any: bool) -> Option<(Common, Vec3)> {
        let starting = |point: Vec3| samples.iter().filter(|ray| ray.origin == point).count();
        let origins = samples.iter().map(|ray| ray.origin);
        if let Some(point) = origins.into_iter().find(|point| starting(*point) >= MOST) {
            return Some((Common::Origin, point));
        }
        let is_common = |ray: &&Ray| {
            let parallel = samples.iter().filter(|other| is_parallel(ray, other));
            ray.origin.is_finite() && parallel.count() >= MOST
        };
        if let Some(ray) = samples.iter().filter(|_| any).find(is_common) {
            return Some((Common::Direction, ray.origin));
        }
        let is_target = |ray: &&Ray| {
            let point = ray.at(length(ray));
            let most = allowance(point, ray.origin);
            let close = |ray: &&Ray| passed(ray, point) <= most;
            point.is_finite() && samples.iter().filter(close).count() >= MOST
        };
        let ray = samples.iter().filter(|_| any).find(is_target)?;
        Some((Common::Target, ray.at(length(ray))))
    }
}

/// Whether two rays have the same direction and no end.
fn is_parallel(one: &Ray, other: &Ray) -> bool {
    one.direction == other.direction && one.t_max == f32::INFINITY && other.t_max == f32::INFINITY
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
    /// there is no packet. Otherwise the answer is what its rays have in common. `reach` is that of the tree, which parallel rays need to know.
    #[inline(always)]
    pub(super) fn gather<S: Simd, R: Source, const ANY: bool>(
        &mut self,
        simd: S,
        rays: &R,
        rest: &mut Vec<usize>,
        (first, reach): (usize, f32),
    ) -> Option<Common> {
        let meeting = (rays.len() >= FEWEST as usize)
            .then(|| Meeting::of_two(rays, ANY).or_else(|| Meeting::of_five(rays, ANY)))
            .flatten();
        let Some(Meeting { kind, point, offset, direction }) = meeting else {
            rest.extend(first..first + rays.len());
            return None;
        };
        // Known beforehand wherever it can be: the loop below is made for one kind then.
        let kind = R::COMMON.unwrap_or(kind);
        if ANY && R::COMMON.is_none() && kind == Common::Direction {
            self.gather_parallel(simd, rays, rest, (point, direction), (first, reach));
            return self.arrange::<S, true>(simd).then_some(kind);
        }
        // Rays with a common end are looked at from there.
        self.frame = Frame::new(point, offset, direction);
        let turned = match kind {
            Common::Origin | Common::Direction => 1.0,
            Common::Target => -1.0,
        };

        let (zero, one, never) =
            (simd.splat16(0.0), simd.splat16(1.0), simd.splat16(f32::INFINITY));
        let turn = simd.splat16(turned);
        let z_turn = turn * simd.splat16(self.frame.sign);
        let allowed = simd.splat16(self.frame.offset);
        let origin = [simd.splat16(point.x), simd.splat16(point.y), simd.splat16(point.z)];
        let [x_axis, y_axis, z_axis] = self.frame.axes;
        let (mut bounded, mut latest) = (0, zero);
        for group in 0..GROUP {
            // Sixteen rays, coordinate by coordinate; what is missing behind the last is no ray.
            let here = rays.len().saturating_sub(group * GROUP).min(GROUP);
            let [ox, oy, oz, start, dx, dy, dz, end] = rays.columns(simd, group * GROUP);
            let d = [dx, dy, dz];

            // Which of them pass through the point, and where on their way.
            let (passed, length, from_start) = match kind {
                Common::Origin | Common::Direction => {
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
                Some(Common::Origin | Common::Direction) => zero,
                Some(Common::Target) => scale,
                None => scale / length,
            };
            let limit = limit * simd.splat16(1.0 - 1.0 / (1 << 20) as f32);
            let limit = never.replaced(members, limit);
            self.nearest[group] = limit.to_array();
            self.primitives[group] = [f32::from_bits(NONE); GROUP];
        }
        self.is_bounded = bounded != 0;
        self.start = 1.0 / latest.greatest();
        self.numbers = NUMBERS;
        self.arrange::<S, false>(simd).then_some(kind)
    }

    /// Brings the rays into an order in which groups are compact, if need be, and tells whether there are any.
    #[inline(always)]
    fn arrange<S: Simd, const PARALLEL: bool>(&mut self, simd: S) -> bool {
        self.measure::<S, PARALLEL>(simd);
        let mut scattered = self.scattered(simd);
        let count = self.members.iter().map(|members| members.count_ones()).sum::<u32>();
        let live = self.groups.live;
        if count < live.count_ones() * ENOUGH {
            // Where others come between the rays, as such to another light do, sorting also brings them together in fewer groups.
            scattered = live;
        }
        let is_sorted = count >= FEWEST && scattered.count_ones() > 1;
        self.sorted = if is_sorted { scattered } else { 0 };
        if is_sorted {
            self.sort(simd, scattered);
            self.measure::<S, PARALLEL>(simd);
        }
        self.groups.live != 0
    }

    /// Computes what the rays of each group have in common.
    #[inline(always)]
    fn measure<S: Simd, const PARALLEL: bool>(&mut self, simd: S) {
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
        self.groups.look_again::<S, PARALLEL>(simd);
    }
}
