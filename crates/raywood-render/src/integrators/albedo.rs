//! The share of light that surfaces send back, without any light: what denoisers ask for.

use raywood_scene::{Rgb, linear_to_srgb};

use super::first_hits::{FirstHits, Shown};
use super::{Frame, Integrator};
use crate::path_samples::PathSamples;
use crate::stats::RayCounts;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "albedo",
    help: "colours of surfaces without light and shadow",
    shows_light: false,
    start: |frame| Box::new(FirstHits { frame, shown: Albedo }),
};

/// What surfaces scatter, mirror, let through and send out, up to white, encoded in sRGB.
struct Albedo;

impl Shown for Albedo {
    const NOTHING: Rgb = Rgb::ZERO;

    fn show(
        &self,
        frame: &Frame<'_>,
        surfaces: &Surfaces,
        _samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts {
        for (number, color) in colors.iter_mut().enumerate() {
            let surface = surfaces.get(frame.scene, number);
            let material = surface.material;
            let all = surface.diffuse + material.mirror + material.transmission + material.emission;
            *color = Rgb::from(all.min(Rgb::ONE).to_array().map(linear_to_srgb));
        }
        RayCounts::default()
    }
}
