//! How grids are built: the outermost first, then level by level those of its crowded cells.

use super::cells::{Cells, Content};
use super::pool::{Cell, GridPool, reference_to_grid};
use crate::build::{Cancelled, Work, driver};
use crate::{Aabb, BuildError, Geometry, parallel};

/// The most cells of one grid: a gibibyte of starts.
const MAX_CELLS: f64 = (1 << 28) as f64;

/// References that a grid may have beside those that its primitives give it the right to: a small grid may be fine.
const SPARE_REFERENCES: u64 = 4096;

/// Cells with more references than this are crowded.
const CROWD: usize = 8;

/// How many crowded cells are divided before the build asks whether to go on.
const STRETCH: usize = 1 << 12;

/// What a grid shall be like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// How many cells a primitive.
    pub(super) density: f64,
    /// The most references a primitive; fewer cells where there would be more.
    pub(super) duplication: u64,
}

impl Shape {
    /// A grid of this shape over some primitives.
    pub(super) fn grid_over<G: Geometry>(
        &self,
        content: &Content<'_, G>,
        spare: u64,
        work: Work<'_>,
    ) -> Result<Cells, Cancelled> {
        let primitives = content.primitives.len();
        let limit = (self.duplication * primitives as u64 + spare).min(u64::from(u32::MAX));
        content.divide((self.density * primitives as f64).clamp(1.0, MAX_CELLS), limit, work)
    }
}

impl GridPool {
    /// A single grid. The same for any number of threads.
    pub(super) fn build<G: Geometry>(
        geometry: &G,
        shape: &Shape,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        let [listing, filing] = work.shares([1.0, 9.0]);
        let bounds = driver::primitive_bounds(geometry, listing)?;
        let bounds: Vec<Aabb> = bounds.into_iter().map(Into::into).collect();
        if bounds.is_empty() {
            return Ok(Self::default());
        }
        let primitives: Vec<u32> = (0..bounds.len() as u32).collect();
        let content = Content { geometry, primitives: &primitives, bounds: &bounds };
        let cells = shape.grid_over(&content, SPARE_REFERENCES, filing)?;
        let Cells { lattice, starts, references } = cells;
        let mut grid = Self {
            primitives: bounds.len(),
            tried: 0,
            grids: vec![(lattice, 0)],
            starts,
            references,
            occupied: Vec::new(),
        };
        grid.mark_occupied();
        Ok(grid)
    }

    /// Gives each crowded cell of the innermost level a grid of its own, where that at least halves the mean list.
    pub(super) fn refine<G: Geometry>(
        &mut self,
        geometry: &G,
        shape: &Shape,
        work: Work<'_>,
    ) -> Result<(), Cancelled> {
        // Two more for each that there is: their places must fit 32 bits.
        if self.references.len() as u64 * (1 + shape.duplication) > u64::from(u32::MAX) {
            return work.done();
        }

        // Find the crowded cells; those of outer levels that are left have been tried before.
        let first_new = self.grids.partition_point(|(_, first)| *first < self.tried);
        let mut crowded = Vec::new();
        for (lattice, first) in &self.grids[first_new..] {
            crowded.extend((0..lattice.cells()).filter_map(
                |number| match self.cell(first + number) {
                    Cell::Primitives(p) if p.len() > CROWD => {
                        Some((first + number, lattice.widened_cell_bounds(lattice.place(number))))
                    }
                    _ => None,
                },
            ));
        }
        self.tried = self.starts.len().saturating_sub(1);

        // Divide each, all in parallel.
        let mut inner: Vec<Option<Cells>> = Vec::new();
        inner.resize_with(crowded.len(), || None);
        let divide = |(place, cell): &(usize, Aabb)| {
            let Cell::Primitives(primitives) = self.cell(*place) else { return None };
            let clip = |&primitive: &u32| geometry.clipped_bounds(primitive, cell);
            let bounds: Vec<Aabb> = primitives.iter().map(clip).collect();
            let content = Content { geometry, primitives, bounds: &bounds };
            let cells = shape.grid_over(&content, 0, Work::UNWATCHED).ok()?;
            let halved = 2 * cells.references.len() <= primitives.len() * cells.lattice.cells();
            halved.then_some(cells)
        };
        work.in_stretches_of(STRETCH, crowded.len(), |stretch| {
            parallel::fill(&crowded[stretch.clone()], &mut inner[stretch], divide);
        })?;

        // Append the new grids, and put their numbers in the place of what they divide.
        let mut divided =
            crowded.iter().zip(inner).filter_map(|((p, _), i)| Some((*p, i?))).peekable();
        if divided.peek().is_none() {
            return Ok(());
        }
        let (mut starts, mut references) = (vec![0], Vec::new());
        let mut appended = Vec::new();
        for place in 0..self.tried {
            match divided.next_if(|(crowded, _)| *crowded == place) {
                Some((_, cells)) => {
                    references.push(reference_to_grid(self.grids.len() + appended.len()));
                    appended.push(cells);
                }
                None => references.extend_from_slice(
                    &self.references[self.starts[place] as usize..self.starts[place + 1] as usize],
                ),
            }
            starts.push(references.len() as u32);
        }
        for cells in appended {
            self.grids.push((cells.lattice, starts.len() - 1));
            let before = references.len() as u32;
            starts.extend(cells.starts[1..].iter().map(|start| before + start));
            references.extend(cells.references);
        }
        (self.starts, self.references) = (starts, references);
        self.mark_occupied();
        work.ask()
    }
}
