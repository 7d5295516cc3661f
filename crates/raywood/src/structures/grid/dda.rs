//! The walk of a ray through a lattice, cell by cell: the 3D-DDA of Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray
//! Tracing", Eurographics 1987, made exact.
//!
//! Nothing is accumulated. The distance to a plane is `(plane - origin) * reciprocal`, as in the slab test of boxes, so it never
//! decreases from one plane to the next, rounding included, and the walk merges three sorted sequences.
//!
//! # Which cells a ray must visit
//!
//! Those that pass the slab test: entered no later than they are left, that distance [lengthened]. Then no hit is missed. Let a ray
//! hit a primitive whose box it enters at `near`, on an axis of its own in no cell later than this one's `near`. On each axis take
//! the last of the cells which the box touches that is entered by `near`: it is left after `near`, or is the last that the box
//! touches and so left no earlier than the box. The three name a cell that holds the primitive, passes the slab test, and is
//! entered no later than the hit.
//!
//! The plain walk visits one cell at a time and would turn only one way around an edge where it passes two planes at about the
//! same distance. Where that happens the cells on both sides are visited.

use super::lattice::{Lattice, Planes};
use crate::PreparedRay;
use crate::minmax::{larger, smaller};
use crate::traverse::slab::lengthened;

/// A lattice's axis as a ray sees it: cells are counted in the order in which the ray comes through them, `steps` from 0.
struct Axis<'a> {
    lattice: &'a Lattice,
    axis: usize,
    origin: f32,
    reciprocal: f32,
    /// The number of cells.
    count: i32,
    /// The number of cells, none if the ray never leaves its layer of them.
    crossed: i32,
    planes: Planes,
    /// Whether the ray goes towards smaller coordinates.
    backwards: bool,
}

impl Axis<'_> {
    /// The distance at which the ray enters cell `steps` and leaves the one before it. Never NaN if the axis is crossed at all.
    #[inline]
    fn entry(&self, steps: i32) -> f32 {
        let index = if self.backwards { self.count - steps } else { steps };
        (self.lattice.plane(self.axis, index) - self.origin) * self.reciprocal
    }

    /// The same for the next cell; infinite if there is none, or if the axis is not crossed.
    #[inline(always)]
    fn next(&self, steps: i32) -> f32 {
        let steps = steps + 1;
        let index = if self.backwards { self.count - steps } else { steps };
        let distance = (self.planes.inner(index) - self.origin) * self.reciprocal;
        if steps < self.crossed { distance } else { f32::INFINITY }
    }

    /// From the lattice's own count of cells to the ray's, or back.
    #[inline]
    fn turned(&self, steps: i32) -> i32 {
        if self.backwards { self.count - 1 - steps } else { steps }
    }

    /// Whether the ray never leaves its layer of cells. Then all distances are infinite, or NaN in a plane.
    #[inline]
    fn is_parallel(&self) -> bool {
        !self.reciprocal.is_finite()
    }

    /// The first cell that the ray has not clearly left at a distance, given the last that it has entered.
    fn first_active(&self, last: i32, distance: f32) -> i32 {
        let mut first = last;
        while !self.is_parallel() && first > 0 && lengthened(self.entry(first)) >= distance {
            first -= 1;
        }
        first
    }

    /// The last cell that the ray has entered by a distance.
    fn last_entered(&self, direction: f32, distance: f32) -> i32 {
        // A guess, put right.
        let guess = self.lattice.near(self.axis, self.origin + distance * direction);
        let mut steps = self.turned(guess);
        while steps + 1 < self.count && self.entry(steps + 1) <= distance {
            steps += 1;
        }
        while steps > 0 && self.entry(steps) > distance {
            steps -= 1;
        }
        steps
    }
}

/// Calls `visit` with the number of each cell that the ray may touch, in the order of entry but for rounding, each once.
///
/// `visit` answers with the distance beyond which cells are of no use any more, or with `None` to end the walk. `None` also if a visit ended
/// it. A cell costs two comparisons to choose the axis, one plane and its distance.
#[inline]
pub(super) fn walk(
    lattice: &Lattice,
    ray: &PreparedRay,
    t_max: f32,
    mut visit: impl FnMut(usize) -> Option<f32>,
) -> Option<()> {
    let axes = [0, 1, 2].map(|axis| {
        let (reciprocal, count) = (ray.reciprocal[axis], lattice.resolution(axis));
        Axis {
            lattice,
            axis,
            origin: ray.origin[axis],
            reciprocal,
            count,
            crossed: if reciprocal.is_finite() { count } else { 0 },
            planes: lattice.planes(axis),
            backwards: ray.entry_corner(axis) == 1,
        }
    });

    // Find the interval inside the lattice.
    let (mut distance, mut exit) = (ray.t_min, f32::INFINITY);
    for axis in &axes {
        if axis.is_parallel() {
            let origin = axis.origin;
            let planes = (lattice.plane(axis.axis, 0), lattice.plane(axis.axis, axis.count));
            if !(planes.0 <= origin && origin <= planes.1) {
                return Some(());
            }
        } else {
            distance = larger(axis.entry(0), distance);
            exit = smaller(axis.entry(axis.count), exit);
        }
    }
    let exit = lengthened(exit);
    let mut end = smaller(lengthened(t_max), exit);
    let meets = distance <= end;
    if !meets {
        return Some(());
    }

    // Find the first cell. A ray along a plane belongs to both sides, and so does every box that touches the plane: one
    // side will do.
    let mut steps = [0, 1, 2].map(|a| {
        let axis: &Axis<'_> = &axes[a];
        if axis.is_parallel() {
            axis.turned(lattice.last_reaching(a, axis.origin))
        } else {
            axis.last_entered(ray.direction[a], distance)
        }
    });
    let mut next = [0, 1, 2].map(|a| axes[a].next(steps[a]));
    let first = [0, 1, 2].map(|a| axes[a].first_active(steps[a], distance));
    visit_block(&axes, first, steps, &mut end, exit, &mut visit)?;

    // The cell's number and what a step along each axis adds to it; steps back wrap around.
    let mut number = lattice.number([0, 1, 2].map(|a| axes[a].turned(steps[a])));
    let strides = lattice.strides();
    let strides =
        [0, 1, 2].map(|a| if axes[a].backwards { strides[a].wrapping_neg() } else { strides[a] });
    loop {
        // Enter the next cell on the axis where that happens first.
        let a = usize::from(next[1] < next[0]);
        let a = if next[2] < next[a] { 2 } else { a };
        let previous = std::mem::replace(&mut distance, next[a]);
        // Hits lie before infinity, and there is no further cell.
        if distance > end || distance == f32::INFINITY {
            return Some(());
        }
        steps[a] += 1;
        next[a] = axes[a].next(steps[a]);
        number = number.wrapping_add(strides[a]);

        if distance > lengthened(previous) {
            end = smaller(lengthened(visit(number)?), exit);
        } else {
            // Two planes at about the same distance: on the other axes the cells just left still count.
            let first = [0, 1, 2].map(|b| match b == a {
                true => steps[b],
                false => axes[b].first_active(steps[b], distance),
            });
            visit_block(&axes, first, steps, &mut end, exit, &mut visit)?;
        }
    }
}

/// Visits all cells of a block, and moves the end of the walk as the visits say.
#[inline(never)]
fn visit_block(
    axes: &[Axis<'_>; 3],
    first: [i32; 3],
    last: [i32; 3],
    end: &mut f32,
    exit: f32,
    visit: &mut impl FnMut(usize) -> Option<f32>,
) -> Option<()> {
    for z in first[2]..=last[2] {
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let steps = [x, y, z];
                let index = [0, 1, 2].map(|a| axes[a].turned(steps[a]));
                *end = smaller(lengthened(visit(axes[0].lattice.number(index))?), exit);
            }
        }
    }
    Some(())
}
