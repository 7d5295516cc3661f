//! The geometry that can be saved with its tree.

use crate::{Geometry, Joined, Spheres, TriangleMesh};

/// Geometry that can be [saved](crate::Bvh::save) with its tree: a [`TriangleMesh`], [`Spheres`], the one [`Joined`] with the other in this order, and references to these.
pub trait SavedGeometry: Geometry + Content {}

impl<G: Geometry + Content> SavedGeometry for G {}

/// What geometry is made of. Nobody else can implement it: what a file holds must be what readers know.
pub trait Content {
    /// The triangles and the spheres.
    #[doc(hidden)]
    fn content(&self) -> (Option<&TriangleMesh>, Option<&Spheres>);
}

impl Content for TriangleMesh {
    fn content(&self) -> (Option<&TriangleMesh>, Option<&Spheres>) {
        (Some(self), None)
    }
}

impl Content for Spheres {
    fn content(&self) -> (Option<&TriangleMesh>, Option<&Spheres>) {
        (None, Some(self))
    }
}

impl<A: IsMesh, B: IsSpheres> Content for Joined<A, B> {
    fn content(&self) -> (Option<&TriangleMesh>, Option<&Spheres>) {
        (Some(self.first.mesh()), Some(self.second.spheres()))
    }
}

impl<G: Content> Content for &G {
    fn content(&self) -> (Option<&TriangleMesh>, Option<&Spheres>) {
        (**self).content()
    }
}

/// A mesh, or a reference to one.
pub trait IsMesh {
    #[doc(hidden)]
    fn mesh(&self) -> &TriangleMesh;
}

impl IsMesh for TriangleMesh {
    fn mesh(&self) -> &TriangleMesh {
        self
    }
}

impl<M: IsMesh> IsMesh for &M {
    fn mesh(&self) -> &TriangleMesh {
        (**self).mesh()
    }
}

/// Spheres, or a reference to some.
pub trait IsSpheres {
    #[doc(hidden)]
    fn spheres(&self) -> &Spheres;
}

impl IsSpheres for Spheres {
    fn spheres(&self) -> &Spheres {
        self
    }
}

impl<S: IsSpheres> IsSpheres for &S {
    fn spheres(&self) -> &Spheres {
        (**self).spheres()
    }
}
