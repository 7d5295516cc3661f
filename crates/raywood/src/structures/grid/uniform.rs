//! The uniform grid.

use super::build::Shape;
use super::pool::GridPool;
use crate::build::{BuildMemory, Work};
use crate::structures::{AccelerationStructure, StructureKind};
use crate::{BuildError, BuildOptions, Geometry, Hit, Probe, Ray};
use crate::{NodeView, ValidationError};

/// The most references a primitive.
const DUPLICATION: u64 = 8;

/// Space divided into equal cells, each with a list of the primitives that reach into it: Fujimoto, Tanaka and Iwata, "ARTS: Accelerated
/// Ray-Tracing System", IEEE Computer Graphics and Applications 1986; the walk of Amanatides and Woo 1987.
///
/// A ray walks from cell to cell and stops at the first whose hit lies before the next one. About
/// [`grid_density`](BuildOptions::grid_density) cells a primitive, so about as many cells along an axis as the cube root of that, and
/// O(cube root of N) a ray where primitives are spread evenly. Where they crowd in a corner, one cell holds them all.
///
/// Built in O(N) in two passes, the first of which counts. Memory is bounded: at most 8 references a primitive and 4096 more, and
/// where that would not do, as with long diagonal triangles, cells are made larger until it does; at most
/// [`grid_density`](BuildOptions::grid_density) cells a primitive. Four bytes each.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformGrid(GridPool);

impl UniformGrid {
    /// Builds the grid. O(N).
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
        BuildMemory::check(StructureKind::UniformGrid, geometry.len(), options)?;
        let density = f64::from(options.clamped().grid_density);
        Ok(Self(GridPool::build(geometry, &Shape { density, duplication: DUPLICATION }, work)?))
    }
}

impl AccelerationStructure for UniformGrid {
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
