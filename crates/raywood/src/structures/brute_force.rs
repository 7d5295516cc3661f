//! No structure at all: every ray tests every primitive. The reference that the others are held against.

use super::{AccelerationStructure, StructureKind};
use crate::build::{BuildMemory, PackedAabb, Work, driver};
use crate::traverse::nearest::{Nearest, blocks};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Hit, NodeView};
use crate::{PreparedRay, Probe, Ray, ValidationError};

/// Every ray tests every primitive: O(N) a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct BruteForce {
    primitives: u32,
    bounds: Aabb,
}

impl BruteForce {
    /// Counts the primitives, and checks their boxes as every other structure does.
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
        BuildMemory::check(StructureKind::BruteForce, geometry.len(), options)?;
        let boxes = driver::primitive_bounds(geometry, work)?;
        let bounds = boxes.iter().copied().fold(PackedAabb::EMPTY, PackedAabb::union).into();
        Ok(Self { primitives: boxes.len() as u32, bounds })
    }
}

impl AccelerationStructure for BruteForce {
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        let ray = PreparedRay::new(ray)?;
        let mut nearest = Nearest::new(&ray);
        probe.nodes(1);
        probe.primitives(self.primitives as usize);
        for primitive in 0..self.primitives {
            nearest.test(geometry, &ray, primitive);
        }
        nearest.into_hit()
    }

    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = PreparedRay::new(ray) else { return false };
        probe.nodes(1);
        (0..self.primitives).any(|primitive| {
            probe.primitives(1);
            blocks(geometry, &ray, primitive)
        })
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        if self.primitives > 0 {
            let references = Some(self.primitives as usize);
            visit(NodeView { bounds: self.bounds, level: 0, references });
        }
    }

    fn bytes(&self) -> usize {
        0
    }

    fn primitives(&self) -> usize {
        self.primitives as usize
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        let primitives = geometry.len();
        if primitives == self.primitives as usize {
            Ok(())
        } else {
            Err(ValidationError::NodeCount { nodes: self.primitives as usize, primitives })
        }
    }
}
