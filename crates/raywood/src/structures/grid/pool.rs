//! Grids within grids: the cells and references of all of them in three arrays, and how rays go through them.

use super::dda::walk;
use super::lattice::Lattice;
use crate::traverse::mailbox::Mailbox;
use crate::traverse::nearest::{Nearest, blocks};
use crate::{Geometry, Hit, NodeView, PreparedRay, Probe, Ray};

/// Set in the only reference of a cell that holds a grid; the other bits are the grid's number. Primitive numbers leave it free.
const IS_GRID: u32 = 1 << 31;

/// A grid whose cells may hold grids: a lattice each, and the cells and references of all of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct GridPool {
    /// How many primitives the geometry has.
    pub(super) primitives: usize,
    /// How many of the first cells are as fine as they get.
    pub(super) tried: usize,
    /// Each grid's lattice and the place of its first cell. The first grid is the outermost; none if there is no primitive.
    pub(super) grids: Vec<(Lattice, usize)>,
    /// Where the references of each cell begin. Those of the next cell begin where they end.
    pub(super) starts: Vec<u32>,
    /// The primitives of all cells; of a cell with a grid, the grid's number.
    pub(super) references: Vec<u32>,
    /// Which cells hold anything, one bit each. Rays pass through many empty cells, and these bits stay in the cache where the starts,
    /// 32 times as large, do not.
    pub(super) occupied: Vec<u64>,
}

/// What a cell holds.
pub(super) enum Cell<'a> {
    /// Primitives, in ascending order.
    Primitives(&'a [u32]),
    /// The number of a grid of its own.
    Grid(usize),
}

/// The reference of a cell that holds a grid.
pub(super) fn reference_to_grid(number: usize) -> u32 {
    number as u32 | IS_GRID
}

impl GridPool {
    /// What the cell at a place holds.
    #[inline]
    pub(super) fn cell(&self, place: usize) -> Cell<'_> {
        match &self.references[self.starts[place] as usize..self.starts[place + 1] as usize] {
            &[grid] if grid & IS_GRID != 0 => Cell::Grid((grid & !IS_GRID) as usize),
            primitives => Cell::Primitives(primitives),
        }
    }

    /// Whether the cell at a place holds anything.
    #[inline]
    fn is_occupied(&self, place: usize) -> bool {
        self.occupied[place / 64] >> (place % 64) & 1 == 1
    }

    /// Notes which cells hold anything.
    pub(super) fn mark_occupied(&mut self) {
        let mut occupied = vec![0u64; self.starts.len().saturating_sub(1).div_ceil(64)];
        for (place, ends) in self.starts.windows(2).enumerate() {
            occupied[place / 64] |= u64::from(ends[0] < ends[1]) << (place % 64);
        }
        self.occupied = occupied;
    }

    /// The closest hit, the lowest primitive number among equally near ones.
    pub(super) fn closest<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        let ray = PreparedRay::new(ray)?;
        let (mut nearest, mut mailbox) = (Nearest::new(&ray), Mailbox::new());
        probe.nodes(1);
        self.walk_leaves(0, &ray, ray.t_max, probe, &mut |primitives, probe| {
            for &primitive in primitives {
                probe.references(1);
                if mailbox.is_new(primitive) {
                    probe.primitives(1);
                    nearest.test(geometry, &ray, primitive);
                }
            }
            Some(nearest.t_max())
        });
        nearest.into_hit()
    }

    /// Whether the ray meets any primitive in its interval.
    pub(super) fn occluded<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> bool {
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let mut mailbox = Mailbox::new();
        probe.nodes(1);
        let unblocked = self.walk_leaves(0, &ray, ray.t_max, probe, &mut |primitives, probe| {
            for &primitive in primitives {
                probe.references(1);
                if mailbox.is_new(primitive) {
                    probe.primitives(1);
                    if blocks(geometry, &ray, primitive) {
                        return None;
                    }
                }
            }
            Some(ray.t_max)
        });
        unblocked.is_none()
    }

    /// Walks a ray through a grid and the grids in its cells. `visit` is given the primitives of each cell, and answers with the distance up
    /// to which the ray is still of interest, which is returned at the end, or with `None` to end it all.
    fn walk_leaves<P: Probe>(
        &self,
        grid: usize,
        ray: &PreparedRay,
        t_max: f32,
        probe: &mut P,
        visit: &mut impl FnMut(&[u32], &mut P) -> Option<f32>,
    ) -> Option<f32> {
        let Some((lattice, first_cell)) = self.grids.get(grid) else { return Some(t_max) };
        probe.boxes(1);
        let mut t_max = t_max;
        walk(lattice, ray, t_max, |cell| {
            probe.nodes(1);
            let place = first_cell + cell;
            if !self.is_occupied(place) {
                return Some(t_max);
            }
            match self.cell(place) {
                Cell::Primitives(primitives) => t_max = visit(primitives, probe)?,
                Cell::Grid(inner) => t_max = self.walk_leaves(inner, ray, t_max, probe, visit)?,
            }
            Some(t_max)
        })?;
        Some(t_max)
    }

    /// Shows each grid and its cells. A cell that holds a grid has the grid in it, whose box is fitted to what lies in the cell.
    pub(super) fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        let Some((outermost, _)) = self.grids.first() else { return };
        visit(NodeView { bounds: outermost.bounds(), level: 0, references: None });
        let mut pending = vec![(0, 1)];
        while let Some((grid, level)) = pending.pop() {
            let (lattice, first_cell) = &self.grids[grid];
            for number in 0..lattice.cells() {
                let bounds = lattice.cell_bounds(lattice.place(number));
                let references = match self.cell(first_cell + number) {
                    Cell::Primitives(primitives) => Some(primitives.len()),
                    Cell::Grid(inner) => {
                        pending.push((inner, level + 1));
                        None
                    }
                };
                visit(NodeView { bounds, level, references });
            }
        }
    }

    /// Bytes of all grids.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.grids[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.references[..])
            + size_of_val(&self.occupied[..])
    }
}
