//! What the rays of a packet have in common, judged by a few of them.

use super::waiting::Waiters;
use crate::structures::wide::source::{Common, Source};
use crate::{Ray, Vec3};

/// Points are taken for one that differ by no more than so many roundings of the coordinates on the way.
const ROUNDINGS: f32 = 4.0 * f32::EPSILON;

/// Rays that end from here on, and before one, are taken for such that stop a little before the point that they go to.
pub(super) const NEARLY_ONE: f32 = 0.99;

/// Where most rays of a packet meet, judged by two of them or, where these do not agree, by five: whatever one of these is, the others decide.
pub(super) struct Meeting {
    pub(super) kind: Common,
    pub(super) point: Vec3,
    /// How far a ray may pass by the point, along each axis.
    pub(super) offset: f32,
    /// The direction of one of the rays, seen from the point.
    pub(super) direction: Vec3,
}

/// Of five rays so many decide: there may be others that meet elsewhere, whose turn comes later.
const ENOUGH: usize = 2;

impl Meeting {
    /// Where two of the rays say that all meet, if they agree.
    #[inline(always)]
    pub(super) fn of_two<R: Source>(rays: &Waiters<'_, R>, any: bool) -> Option<Self> {
        let (one, other) = (rays.ray(rays.count / 2), rays.ray(0));
        let (kind, point) = match (R::COMMON, rays.source().point()) {
            (Some(kind), Some(point)) => (kind, point),
            _ if one.origin == other.origin => (Common::Origin, one.origin),
            _ if any && is_parallel(&one, &other) => (Common::Direction, one.origin),
            _ => (Common::Target, one.at(length(&one))),
        };
        let (turn, offset) = match kind {
            Common::Origin | Common::Direction | Common::Image => (1.0, 0.0),
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
    pub(super) fn of_five<R: Source>(rays: &Waiters<'_, R>, any: bool) -> Option<Self> {
        let samples = [2, 0, 4, 1, 3].map(|part| rays.ray(part * (rays.count - 1) / 4));
        let (kind, point) = match (R::COMMON, rays.source().point()) {
            (Some(kind), Some(point)) => (kind, point),
            _ => Self::looked_for(&samples, any)?,
        };
        let (turn, offset) = match kind {
            Common::Origin | Common::Direction | Common::Image => (1.0, 0.0),
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
        if let Some(point) = origins.into_iter().find(|point| starting(*point) >= ENOUGH) {
            return Some((Common::Origin, point));
        }
        let is_common = |ray: &&Ray| {
            let parallel = samples.iter().filter(|other| is_parallel(ray, other));
            ray.origin.is_finite() && parallel.count() >= ENOUGH
        };
        if let Some(ray) = samples.iter().filter(|_| any).find(is_common) {
            return Some((Common::Direction, ray.origin));
        }
        let is_target = |ray: &&Ray| {
            let point = ray.at(length(ray));
            let most = allowance(point, ray.origin);
            let close = |ray: &&Ray| passed(ray, point) <= most;
            point.is_finite() && samples.iter().filter(close).count() >= ENOUGH
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
