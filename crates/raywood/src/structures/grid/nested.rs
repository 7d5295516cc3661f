//! The nested grid.

use super::build::Shape;
use super::pool::GridPool;
use crate::build::{BuildMemory, Work};
use crate::structures::{AccelerationStructure, StructureKind};
use crate::{BuildError, BuildOptions, Geometry, Hit, Probe, Ray};
use crate::{NodeView, ValidationError};

/// The most grids within each other.
const LEVELS: usize = 4;

/// A coarse grid whose crowded cells hold grids of their own: Jevans and Wyvill, "Adaptive Voxel Subdivision for Ray Tracing", Graphics
/// Interface 1989.
///
/// Empty space is crossed in large steps, and detail in a corner gets small cells where it is. A cell with more than eight
/// references gets a grid, of a quarter of [`grid_density`](BuildOptions::grid_density) cells a reference, fitted to what lies in the cell, if that at
/// least halves the primitives a cell holds; at most four grids within each other.
///
/// Built in O(N) a level. Memory is bounded as the uniform grid's: the outermost grid has at most 4 references a primitive and 4096 more, each
/// further level at most twice those of the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct NestedGrid(GridPool);

impl NestedGrid {
    /// Builds the grids. O(N).
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_in(geometry, options, Work::UNWATCHED)
    }

    /// Builds it as a part of some work.
    pub(crate) fn build_in<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        BuildMemory::check(StructureKind::NestedGrid, geometry.len(), options)?;
        let density = 0.25 * f64::from(options.clamped().grid_density);
        let [outermost, inner @ ..] = work.shares([1.0; LEVELS]);
        let mut grids = GridPool::build(geometry, &Shape { density, duplication: 4 }, outermost)?;
        for work in inner {
            grids.refine(geometry, &Shape { density, duplication: 2 }, work)?;
        }
        Ok(Self(grids))
    }
}

impl AccelerationStructure for NestedGrid {
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        self.0.closest(geometry, ray, probe)
    }

    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        self.0.occluded(geometry, ray, probe)
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        self.0.visit_nodes(visit);
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }

    fn primitives(&self) -> usize {
        self.0.primitives
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        self.0.check(geometry)
    }
}
