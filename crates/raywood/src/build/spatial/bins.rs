//! Where to cut space: references sorted into bins, those that reach through several cut into as many parts.

use super::super::{Cancelled, PackedAabb, Primitive, Work};
use super::cut::{Plane, cut};
use crate::Geometry;

/// After so many references it is asked whether to go on.
pub(super) const PIECE: usize = 1 << 14;

/// The bins per axis.
const BINS: usize = 16;

/// A plane to cut at.
pub(super) struct Cut {
    pub(super) plane: Plane,
    /// What it costs, `N_l*A_l + N_r*A_r` in half areas, if all that it crosses is cut.
    pub(super) cost: f64,
}

/// The best plane to cut some references at, with the given box around them; `None` if there is none, or the work is cancelled.
pub(super) fn best_cut<G: Geometry>(
    geometry: &G,
    references: &[Primitive],
    bounds: &PackedAabb,
    work: Work<'_>,
) -> Option<Cut> {
    let along = |axis| {
        let slices = Slices::new(bounds, axis)?;
        Contents::of(geometry, references, &slices, work).ok()?.best_cut(&slices)
    };
    (0..3).filter_map(along).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Equal bins over a box along one axis.
struct Slices {
    axis: usize,
    start: f32,
    width: f32,
    scale: f32,
}

impl Slices {
    /// `None` where neighbouring planes cannot be told apart, or lie too far away.
    fn new(bounds: &PackedAabb, axis: usize) -> Option<Self> {
        let (start, extent) = (bounds.min()[axis], bounds.extent()[axis]);
        let (width, scale) = (extent / BINS as f32, BINS as f32 / extent);
        let slices = Self { axis, start, width, scale };
        let (first, last) = (slices.plane(1), slices.plane(BINS - 1));
        let apart = start < first && last - width < last && last < bounds.max()[axis];
        (apart && scale.is_finite() && extent.is_finite()).then_some(slices)
    }

    /// Where a bin begins.
    #[inline(always)]
    fn plane(&self, bin: usize) -> f32 {
        self.start + self.width * bin as f32
    }

    /// The bin in which a coordinate lies: at or after its beginning, before that of the next.
    #[inline(always)]
    fn bin(&self, x: f32) -> usize {
        let bin = (((x - self.start) * self.scale) as usize).min(BINS - 1);
        // Rounding may be off by one, and it is the planes that count.
        if bin > 0 && self.plane(bin) > x {
            bin - 1
        } else if bin + 1 < BINS && self.plane(bin + 1) <= x {
            bin + 1
        } else {
            bin
        }
    }

    /// The first and the last bin into which a box reaches, as [`Plane::side_of`] sees it.
    #[inline(always)]
    fn reached(&self, bounds: &PackedAabb) -> (usize, usize) {
        let (min, max) = (bounds.min()[self.axis], bounds.max()[self.axis]);
        let first = self.bin(min);
        let last = self.bin(max);
        let only_touched = last > first && self.plane(last) >= max;
        (first, last - usize::from(only_touched))
    }
}

/// What lies in the bins of an axis.
struct Contents {
    /// The boxes around the parts.
    bounds: [PackedAabb; BINS],
    /// How many references begin here.
    begin: [u32; BINS],
    /// How many end here.
    end: [u32; BINS],
}

impl Contents {
    fn of<G: Geometry>(
        geometry: &G,
        references: &[Primitive],
        slices: &Slices,
        work: Work<'_>,
    ) -> Result<Self, Cancelled> {
        let mut contents =
            Self { bounds: [PackedAabb::EMPTY; BINS], begin: [0; BINS], end: [0; BINS] };
        for piece in references.chunks(PIECE) {
            work.ask()?;
            for reference in piece {
                contents.take(geometry, reference, slices);
            }
        }
        Ok(contents)
    }

    /// Takes a reference into the bins that it reaches.
    #[inline(always)]
    fn take<G: Geometry>(&mut self, geometry: &G, reference: &Primitive, slices: &Slices) {
        let axis = slices.axis;
        let (mut first, mut last) = slices.reached(reference.bounds());
        if first < last && geometry.triangle(reference.number()).is_none() {
            // What cannot be cut lies where its centre is.
            first = slices.bin(reference.center()[axis]);
            last = first;
        }
        let mut rest = *reference;
        for bin in first..last {
            let plane = Plane { axis, place: slices.plane(bin + 1) };
            if let Some([left, right]) = cut(geometry, plane, &rest) {
                self.bounds[bin].grow(&left);
                rest = Primitive::new(rest.number(), right);
            }
        }
        self.bounds[last].grow(rest.bounds());
        self.begin[first] += 1;
        self.end[last] += 1;
    }

    /// The best plane between two bins.
    fn best_cut(&self, slices: &Slices) -> Option<Cut> {
        // From the right: the cost of what lies at or after each bin.
        let mut right_costs = [0.0; BINS];
        let (mut right, mut count) = (PackedAabb::EMPTY, 0);
        for bin in (1..BINS).rev() {
            right.grow(&self.bounds[bin]);
            count += self.end[bin];
            right_costs[bin] = f64::from(count) * right.half_area();
        }

        // From the left. With nothing on one side the cost is not a number, nought times infinity.
        let (mut left, mut count) = (PackedAabb::EMPTY, 0);
        let mut best = (0, f64::INFINITY);
        for (bin, right_cost) in right_costs.iter().enumerate().skip(1) {
            left.grow(&self.bounds[bin - 1]);
            count += self.begin[bin - 1];
            let cost = f64::from(count) * left.half_area() + right_cost;
            if cost < best.1 {
                best = (bin, cost);
            }
        }
        let (bin, cost) = best;
        let plane = Plane { axis: slices.axis, place: slices.plane(bin) };
        (bin > 0).then_some(Cut { plane, cost })
    }
}
