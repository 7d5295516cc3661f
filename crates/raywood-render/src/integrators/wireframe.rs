//! The edges of triangles, as lines of the same width near and far: Baerentzen et al., "Single-pass Wireframe Rendering", 2006.

use raywood_scene::Rgb;

use super::first_hits::{FirstHits, Shown};
use super::{Frame, Integrator};
use crate::path_samples::PathSamples;
use crate::prepared::Which;
use crate::ray_cone::{change, footprint};
use crate::stats::RayCounts;
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "wireframe",
    help: "the edges of triangles, over surfaces lit from the eye",
    shows_light: false,
    shows_all_materials: false,
    start: |frame| Box::new(FirstHits { frame, shown: Wireframe }),
};

/// Lines over a light grey.
struct Wireframe;

/// From an edge so far on, in pixels, there is nothing of its line.
const HALF_WIDTH: f32 = 1.0;

const LINE: Rgb = Rgb::new(0.08, 0.1, 0.16);

impl Shown for Wireframe {
    const NOTHING: Rgb = Rgb::ONE;

    fn show(
        &self,
        frame: &Frame<'_>,
        surfaces: &Surfaces,
        _samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts {
        let pixel_width = frame.camera.pixel_width();
        for (number, color) in colors.iter_mut().enumerate() {
            let facing = -get(&surfaces.directions, number).dot(get(&surfaces.normals, number));
            let surface = Rgb::splat(0.45 + 0.45 * facing.clamp(0.0, 1.0));
            let distance = match frame.scene.which(surfaces.primitive(number)) {
                Which::Triangle(_) => edge_distance(surfaces, number, pixel_width),
                Which::Sphere(_) => HALF_WIDTH,
            };
            let share = (distance / HALF_WIDTH).clamp(0.0, 1.0);
            *color = share * surface + (1.0 - share) * LINE;
        }
        RayCounts::default()
    }
}

/// How far from the nearest edge of its triangle a point is, in pixels: each barycentric weight is zero on an edge and grows across it, as fast as it
/// changes over the width of a pixel.
fn edge_distance(surfaces: &Surfaces, number: usize, pixel_width: f32) -> f32 {
    let first = get(&surfaces.corners[0], number);
    let edges =
        [get(&surfaces.corners[1], number) - first, get(&surfaces.corners[2], number) - first];
    let axes = footprint(
        get(&surfaces.directions, number),
        get(&surfaces.geometric_normals, number),
        pixel_width * surfaces.lengths[number],
    );
    let [[du, dv], [eu, ev]] = change(edges, [[1.0, 0.0], [0.0, 1.0]], axes);
    let (u, v) = (surfaces.weights[0][number], surfaces.weights[1][number]);
    [(u, du, eu), (v, dv, ev), (1.0 - u - v, du + dv, eu + ev)]
        .into_iter()
        .map(|(weight, along, across)| {
            weight / (along * along + across * across).sqrt().max(f32::MIN_POSITIVE)
        })
        .fold(f32::INFINITY, f32::min)
}
