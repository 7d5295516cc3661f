//! How far eight triangles are from a point: bounds in single precision, that leave to double precision only what is about equally close.
//!
//! No closures and no `map` of arrays here, which the compiler does not inline where vectors are handled.
//!
//! As in `closest_point.rs` the closest point is that of the plane if it lies inside, else that of an edge. `docs/numerics.md` derives the errors.

use super::TriangleBlock;
use crate::Vec3;
use crate::simd::{Float, Simd};

/// Coordinates are scaled so that the largest lies below this. Products of up to four of them are then in range, and triangles of `2^-60` of it still
/// have an area.
const LARGEST: i32 = 24;

/// The error of a squared distance from an edge, per square of the largest coordinate; per square of it and the ratio of the longest edge's square to the area, of
/// one from a plane.
const EDGE_ERROR: f32 = 128.0 * f32::EPSILON / 2.0;
/// See [`EDGE_ERROR`].
const PLANE_ERROR: f32 = 512.0 * f32::EPSILON / 2.0;

/// The error of a corner's weight, per cube of the longest edge and the largest coordinate.
const WEIGHT_ERROR: f32 = 256.0 * f32::EPSILON / 2.0;

/// Squared areas below this may have lost digits to underflow.
const LEAST_AREA: f32 = 1e-28;

/// What underflow may take from a squared distance at most.
const UNDERFLOW: f32 = 64.0 * f32::MIN_POSITIVE;

/// A point as the origin of scaled coordinates: `scale * p + offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// A power of two.
    pub(crate) scale: f32,
    pub(crate) offset: [f32; 3],
}

impl Frame {
    /// That of a point among coordinates of up to `reach`, both finite.
    #[inline(always)]
    pub(crate) fn new(point: Vec3, reach: f32) -> Self {
        let largest = point.abs().max_element().max(reach);
        // The exponent of the largest, and a power of two with it the other way round; of zero and denormal numbers as of the least normal one.
        let exponent = ((largest.to_bits() >> 23) as i32 - 126).max(-102);
        let scale = f32::from_bits(((LARGEST - exponent + 127) as u32) << 23);
        Self { scale, offset: [-point.x * scale, -point.y * scale, -point.z * scale] }
    }

    /// The square of a distance in scaled coordinates, rounded up, at most the largest number.
    #[inline(always)]
    pub(crate) fn square(&self, distance: f32) -> f32 {
        let scaled = distance * self.scale;
        let square = scaled * scaled;
        (square + square * (8.0 * f32::EPSILON) + f32::MIN_POSITIVE).min(f32::MAX)
    }

    /// The square of the distance of sixteen boxes, at most four roundings of itself off.
    #[inline(always)]
    pub(crate) fn boxes<S: Simd>(&self, simd: S, planes: &[[[f32; 16]; 2]; 3]) -> S::F16 {
        let x = self.beside(simd, &planes[0], self.offset[0]);
        let y = self.beside(simd, &planes[1], self.offset[1]);
        let z = self.beside(simd, &planes[2], self.offset[2]);
        x.mul_add(x, y.mul_add(y, z * z))
    }

    /// How far the point lies beside sixteen slabs.
    #[inline(always)]
    fn beside<S: Simd>(&self, simd: S, [least, greatest]: &[[f32; 16]; 2], offset: f32) -> S::F16 {
        let (scale, zero, offset) =
            (simd.splat16(self.scale), simd.splat16(0.0), simd.splat16(offset));
        let below = simd.load16(least).mul_add(scale, offset);
        let above = simd.load16(greatest).mul_add(scale, offset);
        below.larger(zero - above).larger(zero)
    }
}

impl TriangleBlock {
    /// Bounds of the squares of the triangles' distances from a point, in scaled coordinates: none is less than the first or more than the second.
    #[inline(always)]
    pub(crate) fn squared_distances<S: Simd>(&self, simd: S, frame: &Frame) -> (S::F8, S::F8) {
        let a = self.corner_in(simd, frame, 0);
        let b = self.corner_in(simd, frame, 1);
        let c = self.corner_in(simd, frame, 2);
        squared_distances_of(simd, [a, b, c])
    }

    /// The corners of one number in scaled coordinates.
    #[inline(always)]
    fn corner_in<S: Simd>(&self, simd: S, frame: &Frame, corner: usize) -> [S::F8; 3] {
        let scale = simd.splat8(frame.scale);
        let (x, y, z) =
            (self.coordinates(corner, 0), self.coordinates(corner, 1), self.coordinates(corner, 2));
        [
            simd.load8(x).mul_add(scale, simd.splat8(frame.offset[0])),
            simd.load8(y).mul_add(scale, simd.splat8(frame.offset[1])),
            simd.load8(z).mul_add(scale, simd.splat8(frame.offset[2])),
        ]
    }
}

/// Bounds of the squares of eight triangles' distances from zero: none is less than the first or more than the second. No coordinate exceeds `2^24`.
#[inline(always)]
pub(crate) fn squared_distances_of<S: Simd>(simd: S, [a, b, c]: [[S::F8; 3]; 3]) -> (S::F8, S::F8) {
    let zero = simd.splat8(0.0);
    let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));

    // How large everything is.
    let reach = largest(a).larger(largest(b)).larger(largest(c));
    let longest = largest(ab).larger(largest(bc)).larger(largest(ca));
    let square = reach * reach;

    // The edges, whose error the square root of rounding divides out: a point a little beside the closest is hardly further away.
    let edges = square_to_edge(simd, a, ab)
        .smaller(square_to_edge(simd, b, bc))
        .smaller(square_to_edge(simd, c, ca));
    let edge_error = square.mul_add(simd.splat8(EDGE_ERROR), simd.splat8(UNDERFLOW));

    // The plane, and on which side of each edge the point lies.
    let normal = cross(ca, ab);
    let area = dot(normal, normal);
    let reciprocal = simd.splat8(1.0) / area;
    let height = dot(normal, a);
    let plane = height * (height * reciprocal);
    let size = normal[0].abs() + normal[1].abs() + normal[2].abs();
    let shape = longest * longest * size * reciprocal;
    let plane_error = square.mul_add(shape * simd.splat8(PLANE_ERROR), edge_error);
    let weight = dot(normal, cross(b, bc))
        .smaller(dot(normal, cross(c, ca)))
        .smaller(dot(normal, cross(a, ab)));
    let weight_error = (longest * longest * (longest * reach))
        .mul_add(simd.splat8(WEIGHT_ERROR), simd.splat8(f32::MIN_POSITIVE));

    let sound = simd.splat8(LEAST_AREA).less(area);
    let possibly_inside = (zero - weight_error).less_or_equal(weight);
    let certainly_inside = sound & weight_error.less(weight);
    let beside = edges - edge_error;
    let below = beside.smaller(plane - plane_error);
    let lower = beside.replaced(possibly_inside, below).replaced(possibly_inside & !sound, zero);
    let upper = (edges + edge_error).replaced(certainly_inside, plane + plane_error);
    (lower.larger(zero), upper)
}

/// The square of the distance of zero from edges, by where these begin and how they run on.
#[inline(always)]
fn square_to_edge<S: Simd>(simd: S, from: [S::F8; 3], edge: [S::F8; 3]) -> S::F8 {
    let (zero, one) = (simd.splat8(0.0), simd.splat8(1.0));
    let share = (zero - dot(from, edge)) / dot(edge, edge);
    // NaN, of an edge without length, becomes zero.
    let share = share.larger(zero).smaller(one);
    let x = share.mul_add(edge[0], from[0]);
    let y = share.mul_add(edge[1], from[1]);
    let z = share.mul_add(edge[2], from[2]);
    x.mul_add(x, y.mul_add(y, z * z))
}

/// The largest coordinate's absolute value.
#[inline(always)]
fn largest<F: Float>([x, y, z]: [F; 3]) -> F {
    x.larger_magnitude(y).larger(z.abs())
}

#[inline(always)]
fn sub<F: Float>([ax, ay, az]: [F; 3], [bx, by, bz]: [F; 3]) -> [F; 3] {
    [ax - bx, ay - by, az - bz]
}

#[inline(always)]
fn cross<F: Float>([ax, ay, az]: [F; 3], [bx, by, bz]: [F; 3]) -> [F; 3] {
    [
        az.negated_mul_add(by, ay * bz),
        ax.negated_mul_add(bz, az * bx),
        ay.negated_mul_add(bx, ax * by),
    ]
}

#[inline(always)]
fn dot<F: Float>([ax, ay, az]: [F; 3], [bx, by, bz]: [F; 3]) -> F {
    ax.mul_add(bx, ay.mul_add(by, az * bz))
}
