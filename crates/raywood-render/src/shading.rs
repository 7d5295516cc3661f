//! The surface at a hit, ready for shading: normals turned to the viewer, the material, the diffuse colour there.

use raywood::{Hit, Ray, SurfacePoint, Vec3};
use raywood_scene::Rgb;

use crate::PreparedScene;
use crate::fresnel::reflect;
use crate::prepared::{SurfaceMaterial, Which};

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

impl<'a> Surface<'a> {
    /// The surface at a hit of `ray`.
    #[inline(always)]
    pub(crate) fn new(prepared: &'a PreparedScene<'_>, ray: &Ray, hit: &Hit) -> Self {
        let point = prepared.structure().surface_point(ray, hit);
        let material = prepared.material_of(hit.primitive);
        let outside = ray.direction.dot(point.normal) <= 0.0;
        let geometric_normal = if outside { point.normal } else { -point.normal };
        let mut surface = Self {
            point,
            material,
            outside,
            geometric_normal,
            normal: geometric_normal,
            diffuse: material.pattern.color(material.diffuse, point.position),
        };

        // Interpolate what the mesh gives per vertex.
        if let Which::Triangle(triangle) = prepared.which(hit.primitive) {
            let mesh = &prepared.scene().mesh;
            if !(mesh.normals.is_empty() && mesh.colors.is_empty()) {
                let corners = mesh.triangles.triangles()[triangle as usize];
                if let Some(normal) = interpolate(&mesh.normals, corners, hit) {
                    surface.bend_normal(normal);
                }
                if let Some(color) = interpolate(&mesh.colors, corners, hit) {
                    surface.diffuse = surface.diffuse * color;
                }
            }
        }
        surface
    }

    /// Shades with an interpolated normal, turned to the side of the geometric one: files differ in which way they
    /// point. Vertices without a normal (zero) leave the geometric one.
    #[inline(always)]
    fn bend_normal(&mut self, interpolated: Vec3) {
        let normal = interpolated.normalize_or_zero();
        let side = normal.dot(self.geometric_normal);
        if side != 0.0 {
            self.normal = if side < 0.0 { -normal } else { normal };
        }
    }

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

/// A quantity given per vertex, at a hit; `None` where the mesh does not give it.
#[inline(always)]
fn interpolate(per_vertex: &[Vec3], corners: [u32; 3], hit: &Hit) -> Option<Vec3> {
    let [a, b, c] = corners.map(|vertex| per_vertex.get(vertex as usize).copied());
    Some((1.0 - hit.u - hit.v) * a? + hit.u * b? + hit.v * c?)
}
