//! How grids are built: the outermost first, then level by level those of its crowded cells.

use super::cells::{Cells, Content};
use super::pool::GridPool;
use crate::build::driver;
use crate::{Aabb, BuildError, Geometry};

/// The most cells of one grid: a gibibyte of starts.
const MAX_CELLS: f64 = (1 << 28) as f64;

/// References that a grid may have beside those that its primitives give it the right to: a small grid may be fine.
const SPARE_REFERENCES: u64 = 4096;

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
    pub(super) fn grid_over<G: Geometry>(&self, content: &Content<'_, G>, spare: u64) -> Cells {
        let primitives = content.primitives.len();
        let limit = (self.duplication * primitives as u64 + spare).min(u64::from(u32::MAX));
        content.divide((self.density * primitives as f64).clamp(1.0, MAX_CELLS), limit)
    }
}

impl GridPool {
    /// A single grid. The same for any number of threads.
    pub(super) fn build<G: Geometry>(geometry: &G, shape: &Shape) -> Result<Self, BuildError> {
        let bounds: Vec<Aabb> =
            driver::primitive_bounds(geometry)?.into_iter().map(Into::into).collect();
        if bounds.is_empty() {
            return Ok(Self::default());
        }
        let primitives: Vec<u32> = (0..bounds.len() as u32).collect();
        let content = Content { geometry, primitives: &primitives, bounds: &bounds };
        let Cells { lattice, starts, references } = shape.grid_over(&content, SPARE_REFERENCES);
        Ok(Self {
            primitives: bounds.len(),
            levels: 1,
            grids: vec![(lattice, 0)],
            starts,
            references,
        })
    }
}
