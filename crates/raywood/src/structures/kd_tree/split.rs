//! Choosing a plane by the surface area heuristic: MacDonald and Booth 1990; the sweep over events and the side of planar primitives
//! after Wald and Havran, "On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)", 2006.

use super::halves;
use crate::{Aabb, BuildOptions, parallel};

/// Sets larger than this are binned first.
const EXACT: usize = 512;

/// The bins along each axis.
const BINS: usize = 32;

/// A primitive's part in a cell.
#[derive(Clone, Copy)]
pub(super) struct Reference {
    pub(super) bounds: Aabb,
    pub(super) primitive: u32,
}

/// A plane, and where those primitives go that lie in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub(super) axis: usize,
    pub(super) position: f32,
    planar_left: bool,
    cost: f64,
}

impl Split {
    /// On which sides of the plane a box lies: left, right or both.
    #[inline]
    pub(super) fn sides(&self, bounds: &Aabb) -> (bool, bool) {
        let (low, high) = (bounds.min[self.axis], bounds.max[self.axis]);
        let planar = low == self.position && high == self.position;
        (
            low < self.position || (planar && self.planar_left),
            high > self.position || (planar && !self.planar_left),
        )
    }
}

/// The expected cost of a ray through a cell, as a share of one that goes on with `count` primitives.
struct CostModel<'a> {
    cell: &'a Aabb,
    area: f64,
    node_cost: f64,
    primitive_cost: f64,
    empty_bonus: f64,
}

impl CostModel<'_> {
    /// The plane with the given numbers of primitives below, in and above it, if it lies inside the cell.
    fn candidate(&self, axis: usize, position: f32, counts: [usize; 3]) -> Option<Split> {
        if !(self.cell.min[axis] < position && position < self.cell.max[axis]) {
            return None;
        }
        let [below, above] = halves(self.cell, axis, position).map(|half| half.half_area());
        let [left, planar, right] = counts;
        let cost = |left: usize, right: usize| {
            let tests = (below * left as f64 + above * right as f64) / self.area;
            let factor = if left == 0 || right == 0 { 1.0 - self.empty_bonus } else { 1.0 };
            factor * (self.node_cost + self.primitive_cost * tests)
        };
        let (to_left, to_right) = (cost(left + planar, right), cost(left, planar + right));
        let planar_left = to_left <= to_right;
        Some(Split { axis, position, planar_left, cost: to_left.min(to_right) })
    }
}

/// The cheaper of two splits, the first of equal ones.
fn cheaper(a: Option<Split>, b: Option<Split>) -> Option<Split> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.cost < a.cost { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// The plane that makes the cell cheapest, or `None` if a leaf is cheaper still.
pub(super) fn choose(
    references: &[Reference],
    cell: &Aabb,
    options: &BuildOptions,
) -> Option<Split> {
    let model = CostModel {
        cell,
        area: cell.half_area(),
        node_cost: f64::from(options.node_cost),
        primitive_cost: f64::from(options.primitive_cost),
        empty_bonus: f64::from(options.kd_empty_bonus),
    };
    let leaf_cost = model.primitive_cost * references.len() as f64;
    let worthwhile = |split: Split| (split.cost < leaf_cost).then_some(split);
    // A cell without area (points or a line) makes NaN of every cost, and no split is worthwhile.
    if references.len() > EXACT {
        let split = binned(references, &model).and_then(worthwhile);
        if split.is_some() {
            return split;
        }
    }
    let splits = (0..3).map(|axis| swept(references, &model, axis));
    splits.reduce(cheaper).flatten().and_then(worthwhile)
}

/// Tries the planes between equal bins on each axis. O(N).
fn binned(references: &[Reference], model: &CostModel<'_>) -> Option<Split> {
    // Count in which bin each primitive begins and in which it ends.
    let extent = model.cell.max - model.cell.min;
    let scale = extent.to_array().map(|extent| BINS as f32 / extent);
    let bin =
        |axis: usize, x: f32| (((x - model.cell.min[axis]) * scale[axis]) as usize).min(BINS - 1);
    let counts = parallel::fold(
        references,
        [[[0usize; 2]; BINS]; 3],
        |counts, reference| {
            for (axis, counts) in counts.iter_mut().enumerate() {
                counts[bin(axis, reference.bounds.min[axis])][0] += 1;
                counts[bin(axis, reference.bounds.max[axis])][1] += 1;
            }
        },
        |all, part| {
            let pairs = all.as_flattened_mut().as_flattened_mut().iter_mut();
            pairs.zip(part.as_flattened().as_flattened()).for_each(|(all, part)| *all += part);
        },
    );

    // Sweep: what begins before the plane lies left, what ends after it right.
    let mut best = None;
    for (axis, counts) in counts.iter().enumerate() {
        let (mut left, mut right) = (0, references.len());
        for (number, [begin, end]) in counts.iter().enumerate().take(BINS - 1) {
            left += begin;
            right -= end;
            let position = model.cell.min[axis] + (number + 1) as f32 / scale[axis];
            best = cheaper(best, model.candidate(axis, position, [left, 0, right]));
        }
    }
    best
}

/// Tries every plane on an axis at which a primitive's part begins or ends. O(N log N).
fn swept(references: &[Reference], model: &CostModel<'_>, axis: usize) -> Option<Split> {
    // Nothing can be cut off an axis along which all primitives span the whole cell.
    let (low, high) = (model.cell.min[axis], model.cell.max[axis]);
    let spans = |r: &Reference| r.bounds.min[axis] <= low && r.bounds.max[axis] >= high;
    if references.iter().all(spans) {
        return None;
    }

    let sorted = |values: &mut Vec<f32>| values.sort_unstable_by(f32::total_cmp);
    let mut begins: Vec<f32> = references.iter().map(|r| r.bounds.min[axis]).collect();
    let mut ends: Vec<f32> = references.iter().map(|r| r.bounds.max[axis]).collect();
    let planar = |r: &&Reference| r.bounds.min[axis] == r.bounds.max[axis];
    let mut planars: Vec<f32> =
        references.iter().filter(planar).map(|r| r.bounds.min[axis]).collect();
    [&mut begins, &mut ends, &mut planars].into_iter().for_each(sorted);

    // Merge the three: at each position, count what lies below, in and above it.
    let mut best = None;
    let (mut begun, mut ended, mut flat) = (0, 0, 0);
    while ended < ends.len() {
        // Every part ends where or after it begins, so there is an end left as long as there is a beginning.
        let position = begins.get(begun).map_or(ends[ended], |&begin| begin.min(ends[ended]));
        let run = |values: &[f32], from: usize| {
            from + values[from..].iter().take_while(|&&x| x <= position).count()
        };
        let flat_end = run(&planars, flat);
        let in_plane = flat_end - flat;
        flat = flat_end;
        ended = run(&ends, ended);
        let counts = [begun, in_plane, references.len() - ended];
        best = cheaper(best, model.candidate(axis, position, counts));
        begun = run(&begins, begun);
    }
    best
}
