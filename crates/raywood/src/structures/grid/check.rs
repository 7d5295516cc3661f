//! The invariants of grids, checked.

use super::lattice::Lattice;
use super::pool::{Cell, GridPool};
use crate::{Aabb, Geometry, ValidationError};

impl GridPool {
    /// Checks that the references of each cell lie in range and ascend, and that every cell that a primitive reaches into (it
    /// [`overlaps`](Geometry::overlaps), and its [`clipped_bounds`](Geometry::clipped_bounds) there are not empty) refers to it or holds a grid in which this is so.
    /// O(references * log of those in a cell).
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold.
    pub(super) fn check<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        let (nodes, primitives) = (self.starts.len().saturating_sub(1), geometry.len());
        if primitives != self.primitives || self.grids.is_empty() != (primitives == 0) {
            return Err(ValidationError::NodeCount { nodes, primitives });
        }

        let mut reached = vec![0usize; self.grids.len()];
        reached.iter_mut().take(1).for_each(|outermost| *outermost = 1);
        let bad = |node| Err(ValidationError::BadReference { node });
        for node in 0..nodes {
            let (start, end) = (self.starts[node] as usize, self.starts[node + 1] as usize);
            if start > end || end > self.references.len() {
                return bad(node);
            }
            match self.cell(node) {
                Cell::Grid(grid) => match reached.get_mut(grid) {
                    Some(times) => *times += 1,
                    None => return bad(node),
                },
                Cell::Primitives(references) => {
                    let in_range = references.last().is_none_or(|&p| (p as usize) < primitives);
                    if !in_range || !references.is_sorted_by(|a, b| a < b) {
                        return bad(node);
                    }
                }
            }
        }
        if let Some(node) = reached.iter().position(|&times| times != 1) {
            return Err(ValidationError::NodeReached { node, times: reached[node] });
        }

        (0..primitives as u32).try_for_each(|primitive| {
            self.check_primitive(geometry, 0, primitive, geometry.bounds(primitive))
        })
    }

    /// Checks that all cells of a grid in which a primitive has a part know it; of the primitive only what lies in `part` counts.
    fn check_primitive<G: Geometry>(
        &self,
        geometry: &G,
        grid: usize,
        primitive: u32,
        part: Aabb,
    ) -> Result<(), ValidationError> {
        let (lattice, first_cell) = &self.grids[grid];
        let ranges = [0, 1, 2].map(|axis| touched(lattice, axis, part.min[axis], part.max[axis]));
        for z in ranges[2].clone() {
            for y in ranges[1].clone() {
                for x in ranges[0].clone() {
                    let node = first_cell + lattice.number([x, y, z]);
                    let cell = lattice.cell_bounds([x, y, z]).intersection(&part);
                    let content = geometry.clipped_bounds(primitive, &cell);
                    // The corner of a sphere's box holds no part of it.
                    if content.is_empty() || !geometry.overlaps(primitive, &cell) {
                        continue;
                    }
                    match self.cell(node) {
                        Cell::Grid(inner) => {
                            self.check_primitive(geometry, inner, primitive, content)?;
                        }
                        Cell::Primitives(known) if known.binary_search(&primitive).is_ok() => {}
                        Cell::Primitives(_) => {
                            return Err(ValidationError::NotReferenced { node, primitive });
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// The cells of an axis that an interval touches, found from the planes alone.
fn touched(lattice: &Lattice, axis: usize, low: f32, high: f32) -> std::ops::Range<i32> {
    let count = lattice.resolution(axis);
    let first = partition(count, |cell| lattice.plane(axis, cell + 1) < low);
    let end = partition(count, |cell| lattice.plane(axis, cell) <= high);
    first..end
}

/// How many of the first numbers below `count` fulfil a condition that holds up to some number and then no more.
fn partition(count: i32, holds: impl Fn(i32) -> bool) -> i32 {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}
