//! Which primitives lie in which cell of a lattice: counted, then written.

use super::lattice::{Block, Lattice};
use crate::build::{Cancelled, Work};
use crate::{Aabb, Geometry, parallel};

/// Sets larger than this are worked on in parallel.
const PARALLEL_PRIMITIVES: usize = 8192;

/// About how many tasks share the cells then. Each goes over all primitives, so there must not be many.
const TASKS: usize = 16;

/// The cells of one lattice: those of cell `i` are `references[starts[i]..starts[i + 1]]`, in ascending order.
pub(super) struct Cells {
    pub(super) lattice: Lattice,
    pub(super) starts: Vec<u32>,
    pub(super) references: Vec<u32>,
}

/// What is to be put into cells.
pub(super) struct Content<'a, G> {
    pub(super) geometry: &'a G,
    /// The primitives, in ascending order.
    pub(super) primitives: &'a [u32],
    /// The box around each, or around its part that matters.
    pub(super) bounds: &'a [Aabb],
}

impl<G: Geometry> Content<'_, G> {
    /// Puts the primitives into about `cells` cells, fewer if it takes more than `limit` references.
    ///
    /// The limit is kept by counting the cells that the boxes touch, each time with half as many cells: O(N log cells).
    pub(super) fn divide(
        &self,
        cells: f64,
        limit: u64,
        work: Work<'_>,
    ) -> Result<Cells, Cancelled> {
        let [measuring, reaching, counting, writing] = work.shares([2.0, 8.0, 1.0, 1.0]);
        let around = |all: &mut Aabb, bounds: &Aabb| *all = all.union(*bounds);
        let bounds = parallel::fold(self.bounds, Aabb::EMPTY, around, around);
        let mut target = cells;
        let (lattice, blocks) = loop {
            let lattice = Lattice::new(&bounds, target);
            let touched = |i: usize| lattice.touched(&self.bounds[i]);
            let blocks =
                parallel::map_watched(self.bounds.len(), measuring.without_progress(), touched)?;
            let add = |sum: &mut u64, block: &Block| *sum += block.cells();
            let references = parallel::fold(&blocks, 0, add, |sum, part| *sum += part);
            if references <= limit || lattice.cells() == 1 {
                break (lattice, blocks);
            }
            target = (0.5 * target).min(lattice.cells() as f64 - 1.0);
        };

        measuring.done()?;

        // Count, sum up, write.
        let members = |i: usize| self.members(&lattice, &blocks[i], i);
        let members = parallel::map_watched(blocks.len(), reaching, members)?;
        let filing =
            Filing { content: self, lattice: &lattice, blocks: &blocks, members: &members, work };
        let mut counts = vec![0u32; lattice.cells()];
        filing.count(0, &mut counts);
        counting.done()?;
        let mut starts = Vec::with_capacity(counts.len() + 1);
        let mut sum = 0;
        starts.push(0);
        starts.extend(counts.iter().map(|count| {
            sum += count;
            sum
        }));
        let mut references = vec![0u32; sum as usize];
        filing.write(0, &starts, &mut references);
        writing.done()?;
        Ok(Cells { lattice, starts, references })
    }

    /// The cells of a block that the primitive itself reaches, one bit each, counted along x, then y, then z. All of them if it is a row,
    /// and of more than 64 cells the first 64.
    fn members(&self, lattice: &Lattice, block: &Block, number: usize) -> u64 {
        if block.is_row() {
            return u64::MAX;
        }
        let primitive = self.primitives[number];
        block
            .indices()
            .take(64)
            .zip(0..)
            .filter(|&(cell, _)| self.reaches(lattice, primitive, cell))
            .fold(0, |members, (_, bit)| members | 1 << bit)
    }

    /// Whether a primitive whose box touches a cell has a part there itself.
    fn reaches(&self, lattice: &Lattice, primitive: u32, cell: [i32; 3]) -> bool {
        self.geometry.overlaps(primitive, &lattice.widened_cell_bounds(cell))
    }
}

/// The passes over all primitives. Each task owns a stretch of cells and goes over all primitives in ascending order, so that
/// nothing is shared, no order is left to chance and nothing needs sorting.
struct Filing<'a, G> {
    content: &'a Content<'a, G>,
    lattice: &'a Lattice,
    blocks: &'a [Block],
    /// Of each block the cells that its primitive reaches: asked once, needed twice and by several tasks.
    members: &'a [u64],
    /// To be asked before each task.
    work: Work<'a>,
}

impl<G: Geometry> Filing<'_, G> {
    /// Whether a stretch of so many cells is shared out further.
    fn is_divided(&self, cells: usize) -> bool {
        cfg!(feature = "rayon")
            && self.blocks.len() > PARALLEL_PRIMITIVES
            && cells > 1
            && cells > self.lattice.cells() / TASKS
    }

    /// Counts the references of the cells from `first` on.
    fn count(&self, first: usize, counts: &mut [u32]) {
        if self.is_divided(counts.len()) {
            let half = counts.len() / 2;
            let (low, high) = counts.split_at_mut(half);
            parallel::join_if(true, || self.count(first, low), || self.count(first + half, high));
        } else {
            self.for_each(first, counts.len(), |cell, _| counts[cell] += 1);
        }
    }

    /// Writes the references of the cells from `first` on: one more start than cells.
    fn write(&self, first: usize, starts: &[u32], references: &mut [u32]) {
        let cells = starts.len() - 1;
        if self.is_divided(cells) {
            let half = cells / 2;
            let (low, high) = references.split_at_mut((starts[half] - starts[0]) as usize);
            parallel::join_if(
                true,
                || self.write(first, &starts[..=half], low),
                || self.write(first + half, &starts[half..], high),
            );
        } else {
            let mut ends: Vec<u32> = starts[..cells].iter().map(|s| s - starts[0]).collect();
            self.for_each(first, cells, |cell, primitive| {
                references[ends[cell] as usize] = primitive;
                ends[cell] += 1;
            });
        }
    }

    /// Calls `f` with cell and primitive for each primitive and each of its cells among the `cells` from `first` on, which are
    /// counted from 0.
    fn for_each(&self, first: usize, cells: usize, mut f: impl FnMut(usize, u32)) {
        if self.work.ask().is_err() {
            return;
        }
        let mine = first..first + cells;
        let blocks = self.blocks.iter().zip(self.members);
        for ((block, &members), &primitive) in blocks.zip(self.content.primitives) {
            let (low, high) = (block.first.map(i32::from), block.last.map(i32::from));
            if self.lattice.number(high) < mine.start || mine.end <= self.lattice.number(low) {
                continue;
            }
            let is_row = block.is_row();
            for (place, index) in block.indices().enumerate() {
                let cell = self.lattice.number(index);
                let is_member = || {
                    is_row
                        || match place {
                            ..64 => members >> place & 1 == 1,
                            _ => self.content.reaches(self.lattice, primitive, index),
                        }
                };
                if mine.contains(&cell) && is_member() {
                    f(cell - first, primitive);
                }
            }
        }
    }
}
