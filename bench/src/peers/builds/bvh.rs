//! `bvh`: its one way to build.

use bvh::bounding_hierarchy::BoundingHierarchy;
use bvh::bvh::Bvh;
use raywood::TriangleMesh;

use super::super::Peer;
use super::super::bvh::{ENTRY, Shape, Tree, shapes};
use super::{BuildEntry, Builder, Cost, measured};

pub(super) const BUILDS: &[BuildEntry] = &[BuildEntry {
    peer: ENTRY.name,
    preset: "build_par",
    settings: "the boxes of all shapes, and Bvh::build_par; traced as `nearest` and `clipped`; bytes and peak by the allocator, without the shapes, which are the caller's",
    prepare: |mesh, _| Ok(Box::new(Shapes { shapes: shapes(mesh), mesh })),
}];

struct Shapes<'a> {
    mesh: &'a TriangleMesh,
    shapes: Vec<Shape>,
}

impl Builder for Shapes<'_> {
    fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String> {
        let Self { mesh, shapes } = self;
        // In the mesh's order again: a build leaves nothing behind in the shapes but numbers of nodes.
        let (cost, tree) = measured(|| {
            for (number, shape) in (0..).zip(&mut *shapes) {
                shape.measure(mesh.corners(number));
            }
            Bvh::build_par(shapes)
        });
        Ok((cost, Box::new(Tree::new(tree, &shapes[..])?)))
    }
}
