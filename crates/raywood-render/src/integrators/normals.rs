//! Normals as colours: from -1 to 1 in x, y and z as from 0 to 1 in red, green and blue.

use raywood_scene::Rgb;

use super::first_hits::{FirstHits, Shown};
use super::{Frame, Integrator};
use crate::path_samples::PathSamples;
use crate::stats::RayCounts;
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "normals",
    help: "normals for shading, -1 to 1 in x, y, z as 0 to 1 in red, green, blue",
    shows_light: false,
    start: |frame| Box::new(FirstHits { frame, shown: Normals }),
};

/// Normals for shading on the side of the eye, in the axes of the scene.
struct Normals;

impl Shown for Normals {
    const NOTHING: Rgb = Rgb::ZERO;

    fn show(
        &self,
        _frame: &Frame<'_>,
        surfaces: &Surfaces,
        _samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts {
        for (number, color) in colors.iter_mut().enumerate() {
            *color = 0.5 * (get(&surfaces.normals, number) + Rgb::ONE);
        }
        RayCounts::default()
    }
}
