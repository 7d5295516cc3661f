//! Where rays come from: a slice of them, or a point that they share and what else each one has.
//!
//! Rays are made from this 16 at a time, coordinate by coordinate, or one by one where something goes on alone.

use crate::double::{Double3, double};
use crate::geometry::TriangleBlock;
use crate::simd::{Simd, as_rows};
use crate::{Ray, Vec3};

/// Rays of a batch, or of a packet of it.
pub(super) trait Source: Copy {
    /// Whether all rays pass through a point that is known.
    const COMMON: Option<Common>;

    /// That point.
    fn point(&self) -> Option<Vec3>;

    /// How many rays.
    fn len(&self) -> usize;

    /// A ray.
    fn ray(&self, number: usize) -> Ray;

    /// Whether a ray starts beside the triangle of that number, which is not in its way.
    #[inline(always)]
    fn starts_beside(&self, _number: usize, _primitive: u32) -> bool {
        false
    }

    /// Up to `count` rays from `start` on, as far as there are any.
    fn part(&self, start: usize, count: usize) -> Self;

    /// Sixteen rays from `start` on as columns: origins, starts, directions, ends. What is missing behind the last is no ray.
    fn columns<S: Simd>(&self, simd: S, start: usize) -> [S::F16; 8];

    /// Asks for the memory of all rays.
    fn prefetch<S: Simd>(&self, simd: S);

    /// Whether rays and triangles are rounded from double precision, which [decides](Self::settle) where single precision cannot tell.
    const IS_ROUNDED: bool = false;

    /// How far beside each other a point of a ray and one of a triangle may lie, along each axis, that are the same in truth.
    #[inline(always)]
    fn displacement(&self) -> f32 {
        0.0
    }

    /// Where a ray starts and where it goes, in truth.
    #[inline(always)]
    fn line(&self, number: usize) -> [Double3; 2] {
        let ray = self.ray(number);
        [double(ray.origin), double(ray.direction)]
    }

    /// The corners of the triangle in a lane, in truth.
    #[inline(always)]
    fn corners(&self, block: &TriangleBlock, lane: usize) -> [Double3; 3] {
        let [a, b, c] = block.corners(lane);
        [double(a), double(b), double(c)]
    }

    /// Of rounded rays: at which distance a ray hits a triangle, if it does so in truth, and nearer than another one that it certainly hits, or equally near
    /// with a lower number.
    fn settle(&self, _number: usize, _primitive: u32, _than: Option<u32>) -> Option<f32> {
        None
    }
}

/// What rays have in common.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Common {
    Origin,
    Target,
    /// The point is where one of them starts.
    Direction,
    /// A point that their lines meet in before the rays start.
    Image,
}

/// The part of a slice from `start` on, of at most `count` items.
#[inline(always)]
fn part<T>(items: &[T], start: usize, count: usize) -> &[T] {
    let start = start.min(items.len());
    &items[start..(start + count).min(items.len())]
}

impl Source for &[Ray] {
    const COMMON: Option<Common> = None;

    #[inline(always)]
    fn point(&self) -> Option<Vec3> {
        None
    }

    #[inline(always)]
    fn len(&self) -> usize {
        <[Ray]>::len(self)
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        self[number]
    }

    #[inline(always)]
    fn part(&self, start: usize, count: usize) -> Self {
        part(self, start, count)
    }

    #[inline(always)]
    fn columns<S: Simd>(&self, simd: S, start: usize) -> [S::F16; 8] {
        match self.get(start..).and_then(<[Ray]>::first_chunk) {
            Some(rays) => simd.columns(as_rows(rays)),
            None => {
                let rays = part(self, start, 16);
                let mut filled = [Ray::NONE; 16];
                filled[..rays.len()].copy_from_slice(rays);
                simd.columns(as_rows(&filled))
            }
        }
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self);
    }
}

/// Sixteen points or directions from `start` on as columns; what is missing is NaN.
#[inline(always)]
fn vectors<S: Simd>(simd: S, items: &[Vec3], start: usize) -> [S::F16; 3] {
    match items.get(start..).and_then(<[Vec3]>::first_chunk) {
        Some(items) => simd.vector_columns(items),
        None => {
            let items = part(items, start, 16);
            let mut filled = [Vec3::splat(f32::NAN); 16];
            filled[..items.len()].copy_from_slice(items);
            simd.vector_columns(&filled)
        }
    }
}

/// Rays from one point without an end: their directions.
#[derive(Clone, Copy)]
pub(super) struct FromPoint<'a> {
    pub(super) origin: Vec3,
    pub(super) directions: &'a [Vec3],
}

impl Source for FromPoint<'_> {
    const COMMON: Option<Common> = Some(Common::Origin);

    #[inline(always)]
    fn point(&self) -> Option<Vec3> {
        Some(self.origin)
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.directions.len()
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        Ray::new(self.origin, self.directions[number])
    }

    #[inline(always)]
    fn part(&self, start: usize, count: usize) -> Self {
        Self { directions: part(self.directions, start, count), ..*self }
    }

    #[inline(always)]
    fn columns<S: Simd>(&self, simd: S, start: usize) -> [S::F16; 8] {
        let [x, y, z] = vectors(simd, self.directions, start);
        let Vec3 { x: ox, y: oy, z: oz } = self.origin;
        let (ox, oy, oz) = (simd.splat16(ox), simd.splat16(oy), simd.splat16(oz));
        [ox, oy, oz, simd.splat16(0.0), x, y, z, simd.splat16(f32::INFINITY)]
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self.directions);
    }
}

/// Rays from points to one that they share: as [`Ray::between`], over the interval from 0 to `end`.
#[derive(Clone, Copy)]
pub(super) struct Towards<'a> {
    pub(super) target: Vec3,
    pub(super) points: &'a [Vec3],
    /// The primitives that they start beside; none if these are not known.
    pub(super) beside: &'a [u32],
    pub(super) end: f32,
}

impl Source for Towards<'_> {
    const COMMON: Option<Common> = Some(Common::Target);

    #[inline(always)]
    fn point(&self) -> Option<Vec3> {
        Some(self.target)
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.points.len()
    }

    #[inline(always)]
    fn ray(&self, number: usize) -> Ray {
        Ray::between(self.points[number], self.target).with_interval(0.0, self.end)
    }

    #[inline(always)]
    fn starts_beside(&self, number: usize, primitive: u32) -> bool {
        self.beside.get(number) == Some(&primitive)
    }

    #[inline(always)]
    fn part(&self, start: usize, count: usize) -> Self {
        let points = part(self.points, start, count);
        Self { points, beside: part(self.beside, start, count), ..*self }
    }

    #[inline(always)]
    fn columns<S: Simd>(&self, simd: S, start: usize) -> [S::F16; 8] {
        let [x, y, z] = vectors(simd, self.points, start);
        let Vec3 { x: tx, y: ty, z: tz } = self.target;
        let (dx, dy, dz) = (simd.splat16(tx) - x, simd.splat16(ty) - y, simd.splat16(tz) - z);
        [x, y, z, simd.splat16(0.0), dx, dy, dz, simd.splat16(self.end)]
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S) {
        simd.prefetch_slice(self.points);
    }
}
