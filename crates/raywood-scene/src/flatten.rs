//! Scenes with instances as scenes without: every instance becomes triangles of its own.

use std::fmt;

use raywood::Transform;

use crate::mesh_join::MeshJoin;
use crate::{Instance, Rgb, Scene};

/// Why a scene is not written out: it shows more triangles than are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyTriangles {
    /// How many it shows.
    pub visible: u64,
    /// How many are allowed.
    pub most: u64,
}

impl fmt::Display for TooManyTriangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { visible, most } = self;
        write!(
            f,
            "its instances show {visible} triangles in all, of which at most {most} are copied"
        )
    }
}

impl std::error::Error for TooManyTriangles {}

impl Scene {
    /// How many triangles there are to be seen, those of instances counted as often as they are shown.
    pub fn visible_triangles(&self) -> u64 {
        let own = self.instances.own_triangles(&self.mesh.triangles);
        u64::from(own) + self.instances.visible_triangles()
    }

    /// Copies the objects to all places where they stand, so that the mesh holds all that is to be seen and there are no instances. Triangles of mirrored instances have their corners in
    /// the other order, so that they face the same way. What moves is copied where it is at time 0. Instances with a [tint](Instance::tint) get it as colours of vertices.
    ///
    /// # Errors
    ///
    /// That would be more than `most` triangles; the scene stays as it was.
    pub fn flatten(&mut self, most: u64) -> Result<(), TooManyTriangles> {
        if self.instances.is_empty() {
            return Ok(());
        }
        let visible = self.visible_triangles();
        let most = most.min(u64::from(u32::MAX));
        if visible > most {
            return Err(TooManyTriangles { visible, most });
        }
        let instances = std::mem::take(&mut self.instances);
        let mesh = &self.mesh;
        let mut all = MeshJoin::default();
        let own = instances.own_triangles(&mesh.triangles);
        all.add(mesh, 0..own, (&Transform::IDENTITY, Rgb::ONE), |own| own);
        let objects: Vec<_> = instances.objects().collect();
        for Instance { object, transform, later: _, material, tint } in instances.placed() {
            let triangles = objects[*object as usize].clone();
            all.add(mesh, triangles, (transform, *tint), |own| material.or(own));
        }
        self.mesh = all.finish().expect("positions are finite, and indices count them");
        Ok(())
    }
}
