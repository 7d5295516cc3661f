//! No structure at all: every ray tests every primitive. The reference that the others are held against.

use super::AccelerationStructure;
use crate::traverse::nearest::{Nearest, blocks};
use crate::{BuildError, BuildOptions, Geometry, Hit, PreparedRay, Probe, Ray, StructureStats};
use crate::{ValidationError, build::driver};

/// Every ray tests every primitive: O(N) a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct BruteForce {
    primitives: u32,
}

impl BruteForce {
    /// Counts the primitives, and checks their boxes as every other structure does.
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, _: &BuildOptions) -> Result<Self, BuildError> {
        let primitives = driver::primitive_bounds(geometry)?.len() as u32;
        Ok(Self { primitives })
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
        probe.primitives(self.primitives as usize);
        for primitive in 0..self.primitives {
            nearest.test(geometry, &ray, primitive);
        }
        nearest.into_hit()
    }

    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = PreparedRay::new(ray) else { return false };
        (0..self.primitives).any(|primitive| {
            probe.primitives(1);
            blocks(geometry, &ray, primitive)
        })
    }

    fn stats(&self) -> StructureStats {
        let primitives = self.primitives as usize;
        StructureStats { primitives, references: primitives, ..StructureStats::default() }
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
