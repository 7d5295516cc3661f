//! The surface at a hit, ready for shading: normals turned to the viewer, the material, the diffuse colour there.

use raywood::{SurfacePoint, Vec3};
use raywood_scene::Rgb;

use crate::fresnel::reflect;
use crate::surface_material::SurfaceMaterial;

/// The surface that a ray hit.
pub(crate) struct Surface<'a> {
    /// Where, and where the next rays start.
    pub(crate) point: SurfacePoint,
    /// The material there.
    pub(crate) material: &'a SurfaceMaterial,
    /// Whether the ray came from outside: from the side that the surface's own normal points to.
    pub(crate) outside: bool,
    /// The geometric normal, unit length, turned to the side that the ray came from.
    pub(crate) geometric_normal: Vec3,
    /// The normal for shading, unit length, on the same side of the surface.
    pub(crate) normal: Vec3,
    /// The diffuse colour there: material, pattern and vertex colours.
    pub(crate) diffuse: Rgb,
}

impl Surface<'_> {
    /// Cosine between the normal for shading and the direction back along `direction`, at least zero: at a silhouette an
    /// interpolated normal may point away from the viewer.
    #[inline(always)]
    pub(crate) fn cos_towards(&self, direction: Vec3) -> f32 {
        (-direction.dot(self.normal)).clamp(0.0, 1.0)
    }

    /// The direction in which `direction` is mirrored. Where the normal for shading would send it below the surface, it
    /// is lifted to just above (Keller et al., "The Iray Light Transport Simulation", 2017, appendix).
    #[inline(always)]
    pub(crate) fn mirrored(&self, direction: Vec3) -> Vec3 {
        keep_on_side(reflect(direction, self.normal), self.geometric_normal)
    }
}

/// How much a light in direction `to_light` counts by its angle: the cosine with the normal for shading, zero from behind. All of unit length.
///
/// Light from below the true surface does not count, whatever the normal for shading says. So that this does not
/// show as dark triangles along the edge of the shadow, it fades out before: Chiang, Li and Burley, "Taming the
/// Shadow Terminator", 2019.
#[inline(always)]
pub(crate) fn light_cosine(to_light: Vec3, normal: Vec3, geometric_normal: Vec3) -> f32 {
    let geometric = to_light.dot(geometric_normal);
    let shading = to_light.dot(normal);
    let bend = normal.dot(geometric_normal);
    let ratio = geometric / (shading * bend);
    let faded = shading * ratio * (1.0 + ratio * (1.0 - ratio));
    let cosine = if ratio >= 1.0 { shading } else { faded };
    if (geometric > 0.0) & (shading > 0.0) { cosine } else { 0.0 }
}

/// A direction pushed to the side of the surface that `normal` points to, if it is not there yet.
#[inline(always)]
pub(crate) fn keep_on_side(direction: Vec3, normal: Vec3) -> Vec3 {
    const SMALLEST_COSINE: f32 = 1e-3;
    let cosine = direction.dot(normal);
    if cosine >= SMALLEST_COSINE {
        return direction;
    }
    (direction + (SMALLEST_COSINE - cosine) * normal).normalize_or_zero()
}

/// The normal for shading: an interpolated one, of any length, turned to the side of the geometric one, for files differ in which way theirs
/// point. Vertices without a normal (zero) leave the geometric one. Without branches and calls, so that a loop over many becomes vectors.
#[inline(always)]
pub(crate) fn bent_normal(interpolated: Vec3, geometric: Vec3) -> Vec3 {
    let normal = interpolated.normalize_or_zero();
    let side = normal.dot(geometric);
    let turned = if side < 0.0 { -normal } else { normal };
    if side != 0.0 { turned } else { geometric }
}
