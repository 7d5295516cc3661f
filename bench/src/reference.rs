//! The answers that all others are held against: those of the plain binary tree, one ray at a time, in scalar code; a sample of them is held
//! against brute force in double precision.

use rayon::prelude::*;
use raywood::{AccelerationStructure, BuildError, BuildOptions, Bvh2, Hit, Ray, TriangleMesh};
use raywood_testkit::oracle::{check_closest, check_occluded};

use crate::answers::Answers;
use crate::ray_sets::RaySet;

/// How many rays of each set brute force checks: each costs a test of every triangle in double precision.
const SAMPLE: usize = 16;

/// The mesh and the tree that answers.
pub(crate) struct Reference<'a> {
    mesh: &'a TriangleMesh,
    tree: Bvh2,
}

impl<'a> Reference<'a> {
    /// Builds the tree.
    ///
    /// # Errors
    ///
    /// The mesh is too large.
    pub(crate) fn build(mesh: &'a TriangleMesh) -> Result<Self, BuildError> {
        Ok(Self { mesh, tree: Bvh2::build(mesh, &BuildOptions::default())? })
    }

    /// The mesh.
    pub(crate) fn mesh(&self) -> &'a TriangleMesh {
        self.mesh
    }

    /// The closest hit of each ray.
    pub(crate) fn closest(&self, rays: &[Ray]) -> Vec<Option<Hit>> {
        rays.par_iter().map(|ray| self.tree.intersect(&self.mesh, ray, &mut ())).collect()
    }

    /// What each ray of the set should be answered.
    ///
    /// # Errors
    ///
    /// Brute force says otherwise about one of a sample of the rays.
    pub(crate) fn answers(&self, set: &RaySet) -> Result<Answers, String> {
        let sample: Vec<_> = (0..SAMPLE.min(set.rays.len()))
            .map(|i| set.rays[i * set.rays.len() / SAMPLE.min(set.rays.len())])
            .collect();
        if set.kind.any_hit() {
            let occluded = |ray: &Ray| self.tree.occluded(&self.mesh, ray, &mut ());
            sample.par_iter().try_for_each(|ray| check_occluded(self.mesh, ray, occluded(ray)))?;
            Ok(Answers::Any(set.rays.par_iter().map(occluded).collect()))
        } else {
            let closest = |ray: &Ray| self.tree.intersect(&self.mesh, ray, &mut ());
            sample.par_iter().try_for_each(|ray| check_closest(self.mesh, ray, closest(ray)))?;
            let hits = self.closest(&set.rays);
            Ok(Answers::closest(hits.iter().map(|hit| hit.map(|hit| hit.t))))
        }
    }
}
