//! Where the surfaces of a wave lie in texture coordinates, and how much of them each ray stands for, in columns.
//!
//! A ray stands for a cone as wide as a pixel, which widens on its way (Akenine-Moeller et al., "Texture Level of Detail Strategies for
//! Real-Time Ray Tracing", 2019); a surface cuts an ellipse out of it.

use super::WAVE;
use super::columns::{Column, get};
use super::surfaces::Surfaces;
use crate::PreparedScene;
use crate::prepared::Which;
use crate::ray_cone::{change, footprint};

/// A pair of texture coordinates, or a step in them, for each surface.
pub(crate) type Pairs = [Column; 2];

/// Points and ellipses in one set of texture coordinates.
#[derive(Clone)]
pub(crate) struct Footprints {
    /// The points.
    pub(crate) points: Pairs,
    /// The axes of the ellipses: along the ray's direction, and across.
    pub(crate) along: Pairs,
    pub(crate) across: Pairs,
    /// The steps from the first corner of the triangle to the others.
    pub(crate) steps: [Pairs; 2],
}

impl Default for Footprints {
    fn default() -> Self {
        let none = [[0.0; WAVE]; 2];
        Self { points: none, along: none, across: none, steps: [none; 2] }
    }
}

impl Footprints {
    /// Finds them for a set. `spread` is by how much cones widen on a way of length 1.
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        scene: &PreparedScene<'_>,
        surfaces: &Surfaces,
        set: usize,
        spread: f32,
    ) {
        let count = surfaces.count();
        let mesh = &scene.scene().mesh;
        let coordinates = &mesh.texture_coordinates[set];
        for number in 0..count {
            let Which::Triangle(triangle) = scene.which(surfaces.primitive(number)) else {
                continue;
            };
            let corners = mesh.triangles.triangles()[triangle as usize];
            let at = |i: usize| coordinates.get(corners[i] as usize).copied().unwrap_or([0.0; 2]);
            let (first, second, third) = (at(0), at(1), at(2));
            for axis in 0..2 {
                self.points[axis][number] = first[axis];
                self.steps[0][axis][number] = second[axis] - first[axis];
                self.steps[1][axis][number] = third[axis] - first[axis];
            }
        }

        for number in 0..count {
            let first = get(&surfaces.corners[0], number);
            let edges = [
                get(&surfaces.corners[1], number) - first,
                get(&surfaces.corners[2], number) - first,
            ];
            let steps = [
                [self.steps[0][0][number], self.steps[0][1][number]],
                [self.steps[1][0][number], self.steps[1][1][number]],
            ];
            let ellipse = footprint(
                get(&surfaces.directions, number),
                get(&surfaces.geometric_normals, number),
                spread * surfaces.lengths[number],
            );
            let [along, across] = change(edges, steps, ellipse);
            let (u, v) = (surfaces.weights[0][number], surfaces.weights[1][number]);
            for axis in 0..2 {
                self.points[axis][number] += u * steps[0][axis] + v * steps[1][axis];
                self.along[axis][number] = along[axis];
                self.across[axis][number] = across[axis];
            }
        }
    }
}
