//! Some primitives of a geometry side by side, for building a part of a tree: one type, whatever the geometry is.

use crate::{Aabb, Geometry, Hit, PreparedRay, PrimitiveHit, Ray, SurfacePoint, Vec3};

/// The primitives, numbered from 0.
pub(super) struct Gathered(Vec<Item>);

/// What trees ask of a primitive.
#[derive(Clone, Copy)]
enum Item {
    Triangle([Vec3; 3]),
    Other { bounds: Aabb, ball: Option<(Vec3, f32)> },
}

impl Gathered {
    /// The primitives of these numbers.
    pub(super) fn of<G: Geometry>(geometry: &G, numbers: &[u32]) -> Self {
        let item = |&number: &u32| match geometry.triangle(number) {
            Some(corners) => Item::Triangle(corners),
            None => Item::Other {
                bounds: geometry.bounds(number),
                ball: geometry.bounding_ball(number),
            },
        };
        Self(numbers.iter().map(item).collect())
    }
}

impl Geometry for Gathered {
    fn len(&self) -> usize {
        self.0.len()
    }

    #[inline(always)]
    fn bounds(&self, primitive: u32) -> Aabb {
        match self.0[primitive as usize] {
            Item::Triangle([a, b, c]) => Aabb { min: a.min(b).min(c), max: a.max(b).max(c) },
            Item::Other { bounds, .. } => bounds,
        }
    }

    #[inline(always)]
    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        match self.0[primitive as usize] {
            Item::Triangle(corners) => Some(corners),
            Item::Other { .. } => None,
        }
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        match self.0[primitive as usize] {
            Item::Triangle(_) => None,
            Item::Other { ball, .. } => ball,
        }
    }

    // Never asked: whoever traces the tree has the geometry itself.
    fn intersect(&self, _: u32, _: &PreparedRay) -> Option<PrimitiveHit> {
        None
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        SurfacePoint { position: ray.at(hit.t), normal: Vec3::ZERO, clearance: 0.0 }
    }
}
