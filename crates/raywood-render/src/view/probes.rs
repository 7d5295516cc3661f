//! Probe rays: what lies around a point.

use raywood::{Ray, Vec3};

use crate::PreparedScene;

/// What rays in all directions from a point find.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// The share of rays that hit anything.
    pub(super) enclosed: f32,
    /// The share of those that hit the front of a surface: within a solid they all hit backs.
    pub(super) fronts: f32,
    /// The mean direction of the rays that hit nothing: of length one if they all go the same way, zero if they go
    /// everywhere alike.
    pub(super) open_towards: Vec3,
    /// The geometric mean of the distances to what was hit.
    pub(super) distance: f32,
}

/// Rays per point.
const RAYS: u32 = 256;

impl Surroundings {
    /// Looks around.
    pub(super) fn of(prepared: &PreparedScene<'_>, point: Vec3) -> Self {
        let (mut hits, mut fronts, mut logarithms, mut open) = (0, 0, 0.0, Vec3::ZERO);
        for index in 0..RAYS {
            let ray = Ray::new(point, direction(index, RAYS));
            match prepared.tracer().intersect(&ray) {
                None => open += ray.direction,
                Some(hit) => {
                    hits += 1;
                    logarithms += hit.t.max(f32::MIN_POSITIVE).ln();
                    let normal = prepared.tracer().surface_point(&ray, &hit, 0.0).normal;
                    fronts += u32::from(normal.dot(ray.direction) < 0.0);
                }
            }
        }
        let share = |part: u32, whole: u32| part as f32 / whole.max(1) as f32;
        Self {
            enclosed: share(hits, RAYS),
            fronts: share(fronts, hits),
            open_towards: open / (RAYS - hits).max(1) as f32,
            distance: (logarithms / hits.max(1) as f32).exp(),
        }
    }
}

/// One of `count` directions that cover the sphere evenly: along a spiral whose turns are the golden angle apart.
fn direction(index: u32, count: u32) -> Vec3 {
    const GOLDEN_ANGLE: f32 = 2.399_963_2;
    let y = 1.0 - (2 * index + 1) as f32 / count as f32;
    let radius = (1.0 - y * y).max(0.0).sqrt();
    let (sin, cos) = (index as f32 * GOLDEN_ANGLE).sin_cos();
    Vec3::new(radius * cos, y, radius * sin)
}
