//! How an object's boxes and triangles look from a region of the scene's space, in single precision and many at once: what is certainly too far away is left out, everything else is left to
//! double precision. `docs/numerics.md`, "Instances", derives the errors.
//!
//! No closures that take or return vectors, which the compiler does not inline.

use super::space::Affine;
use crate::double::{Double3, largest_magnitude};
use crate::geometry::{LANES, TriangleBlock, squared_distances_of};
use crate::simd::{Float, Simd};
use crate::structures::wide::search::Planes;

/// Coordinates are scaled so that none exceeds `2^24`, as [`squared_distances_of`] wants them.
const LARGEST: i64 = 24;

/// What rounding moves a coordinate at most, scaled as it is: one rounding of coefficients, six of products and sums up to `2^24`, two of differences between them, and some to spare.
const ROUNDING: f32 = 12.0;

/// The rounding of coordinates in double precision, per unit of their largest term.
const DOUBLE_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Scaled numbers beyond this could overflow when they are multiplied.
const LARGEST_FACTOR: f64 = 1e30;

/// By so much limits are longer, for the relative errors of squared distances.
const LENGTHENED: f64 = 1.0 + 16.0 * f32::EPSILON as f64;

/// A region's view of an object: coordinates of the scene with their origin in the middle of the region, scaled by a power of two.
pub(super) struct View {
    /// What a point of the object becomes: three factors, and where the object's origin lies.
    rows: [[f32; 4]; 3],
    /// How far the region reaches from its middle along each axis, and by how much boxes may be off.
    reach: [f32; 3],
    /// How far a point may be off.
    slack: f64,
    /// How much larger the coordinates are than the scene's.
    scale: f64,
    /// Whether the region's box is a point.
    of_point: bool,
}

/// Squared distances beyond which nothing counts, as the view has them.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Of boxes.
    pub(super) boxes: f32,
    /// Of triangles from a point.
    triangles: f32,
}

impl View {
    /// That of a region in a box, of an object that reaches so far from zero along any axis in its own space.
    pub(super) fn new([min, max]: [Double3; 2], placed: &Affine, reach: f32) -> Self {
        let mut view = Self {
            rows: [[0.0; 4]; 3],
            reach: [f32::MAX; 3],
            slack: 0.0,
            scale: 1.0,
            of_point: min == max,
        };
        // Of a point exactly the point.
        let middle = [0, 1, 2].map(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
        let half = [0, 1, 2].map(|axis| 0.5 * max[axis] - 0.5 * min[axis]);
        let moved = [0, 1, 2].map(|axis| placed.rows[axis][3] - middle[axis]);
        let (mut largest, mut rounding) = (0.0f64, [0.0; 3]);
        for axis in 0..3 {
            let [x, y, z, from] = placed.rows[axis];
            let object = (x.abs() + y.abs() + z.abs()) * f64::from(reach);
            largest = largest.max(object + moved[axis].abs() + half[axis]);
            rounding[axis] = DOUBLE_ROUNDING * (object + from.abs() + middle[axis].abs());
        }
        let exponent = (largest.to_bits() >> 52) as i64 - 1022;
        let scale = f64::from_bits(((LARGEST - exponent.clamp(-900, 900) + 1023) as u64) << 52);
        let factors = placed.rows.map(|[x, y, z, _]| [scale * x, scale * y, scale * z]);
        // Where numbers are too large to be looked at in single precision, nothing is left out.
        if !factors.iter().all(|row| largest_magnitude(*row) < LARGEST_FACTOR)
            || !largest.is_finite()
        {
            return view;
        }
        for axis in 0..3 {
            let [x, y, z] = factors[axis].map(|factor| factor as f32);
            view.rows[axis] = [x, y, z, (scale * moved[axis]) as f32];
            let slack = f64::from(ROUNDING) + scale * rounding[axis];
            view.reach[axis] = (scale * half[axis] + slack) as f32;
            view.slack += slack;
        }
        view.scale = scale;
        view
    }

    /// The view's limits of a squared distance in the scene.
    pub(super) fn limits(&self, square: f64) -> Limits {
        let distance = self.scale * square.sqrt();
        let limit =
            |distance: f64| ((distance * distance * LENGTHENED) as f32).next_up().min(f32::MAX);
        Limits { boxes: limit(distance), triangles: limit(distance + self.slack) }
    }

    /// The boxes that may be as near as that, and squares of how far away they are at least.
    #[inline(always)]
    pub(super) fn boxes<S: Simd>(&self, simd: S, planes: &Planes, limit: f32) -> (u32, S::F16) {
        let zero = simd.splat16(0.0);
        let mut squares = zero;
        for axis in 0..3 {
            let [x, y, z, moved] = self.rows[axis];
            let (x0, x1) = sides(simd, planes, 0, x);
            let (y0, y1) = sides(simd, planes, 1, y);
            let (z0, z1) = sides(simd, planes, 2, z);
            let (x, y, z) = (simd.splat16(x), simd.splat16(y), simd.splat16(z));
            let (moved, reach) = (simd.splat16(moved), simd.splat16(self.reach[axis]));
            let least = x0.mul_add(x, y0.mul_add(y, z0.mul_add(z, moved)));
            let greatest = x1.mul_add(x, y1.mul_add(y, z1.mul_add(z, moved)));
            let gap = (least - reach).larger(zero - greatest - reach).larger(zero);
            squares = gap.mul_add(gap, squares);
        }
        let present = simd.load16(&planes[0][0]).less_or_equal(simd.load16(&planes[0][1]));
        let near = present & squares.less_or_equal(simd.splat16(limit));
        // Those that are not there are infinite, or no numbers.
        (near, simd.splat16(f32::MAX).replaced(present, squares))
    }

    /// The triangles of a block, of the chosen lanes, that may be as near as that.
    #[inline(always)]
    pub(super) fn triangles<S: Simd>(
        &self,
        simd: S,
        block: &TriangleBlock,
        chosen: u32,
        limits: Limits,
    ) -> Near<S> {
        let a = self.corner(simd, block, 0);
        let b = self.corner(simd, block, 1);
        let c = self.corner(simd, block, 2);
        let (lower, upper) = match self.of_point {
            true => squared_distances_of(simd, [a, b, c]),
            false => (self.gap(simd, [a, b, c]), simd.splat8(0.0)),
        };
        let mut near = Near { lanes: chosen, lower, upper };
        near.keep_within(simd, self, limits);
        near
    }

    /// The corners of one number.
    #[inline(always)]
    fn corner<S: Simd>(&self, simd: S, block: &TriangleBlock, corner: usize) -> [S::F8; 3] {
        let x = simd.load8(block.coordinates(corner, 0));
        let y = simd.load8(block.coordinates(corner, 1));
        let z = simd.load8(block.coordinates(corner, 2));
        [
            self.coordinate(simd, 0, x, y, z),
            self.coordinate(simd, 1, x, y, z),
            self.coordinate(simd, 2, x, y, z),
        ]
    }

    #[inline(always)]
    fn coordinate<S: Simd>(&self, simd: S, axis: usize, x: S::F8, y: S::F8, z: S::F8) -> S::F8 {
        let [a, b, c, moved] = self.rows[axis];
        let (a, b, c, moved) = (simd.splat8(a), simd.splat8(b), simd.splat8(c), simd.splat8(moved));
        x.mul_add(a, y.mul_add(b, z.mul_add(c, moved)))
    }

    /// The squares of how far the boxes of triangles are at least from the region's.
    #[inline(always)]
    fn gap<S: Simd>(&self, simd: S, [a, b, c]: [[S::F8; 3]; 3]) -> S::F8 {
        let zero = simd.splat8(0.0);
        let mut squares = zero;
        for axis in 0..3 {
            let reach = simd.splat8(self.reach[axis]);
            let least = a[axis].smaller(b[axis]).smaller(c[axis]);
            let greatest = a[axis].larger(b[axis]).larger(c[axis]);
            let gap = (least - reach).larger(zero - greatest - reach).larger(zero);
            squares = gap.mul_add(gap, squares);
        }
        squares
    }
}

/// The sides of boxes across an axis that a factor takes farthest down, and farthest up.
#[inline(always)]
fn sides<S: Simd>(simd: S, planes: &Planes, axis: usize, factor: f32) -> (S::F16, S::F16) {
    let is_negative = usize::from(factor < 0.0);
    (simd.load16(&planes[axis][is_negative]), simd.load16(&planes[axis][1 - is_negative]))
}

/// Triangles of a block that may be near.
pub(super) struct Near<S: Simd> {
    lanes: u32,
    /// Squares of distances that are not less.
    lower: S::F8,
    /// And, from a point, not more.
    upper: S::F8,
}

impl<S: Simd> Near<S> {
    /// Leaves out those that are certainly farther away.
    #[inline(always)]
    pub(super) fn keep_within(&mut self, simd: S, view: &View, limits: Limits) {
        let limit = if view.of_point { limits.triangles } else { limits.boxes };
        self.lanes &= self.lower.less_or_equal(simd.splat8(limit));
    }

    /// Takes the one that is probably the nearest.
    #[inline(always)]
    pub(super) fn take(&mut self, simd: S) -> Option<usize> {
        let lane = match self.lanes {
            0 => return None,
            one if one.is_power_of_two() => one.trailing_zeros(),
            several => (simd.least8(several, self.upper).1 & several).trailing_zeros(),
        };
        let lane = lane as usize % LANES;
        self.lanes &= !(1 << lane);
        Some(lane)
    }
}
