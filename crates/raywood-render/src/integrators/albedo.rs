//! The share of light that surfaces send back, without any light: what denoisers ask for.

use raywood_scene::{Rgb, linear_to_srgb};

use super::first_hits::{FirstHits, OfEach};
use super::{Frame, Integrator};
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "albedo",
    help: "colours of surfaces without light and shadow",
    shows_light: false,
    shows_all_materials: false,
    start: |frame| Box::new(FirstHits { frame, shown: OfEach(albedo) }),
};

/// What a surface scatters, mirrors, lets through and sends out, up to white, encoded in sRGB.
fn albedo(frame: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    let surface = surfaces.get(frame.scene, number);
    let material = surface.material;
    let all = surface.diffuse + material.mirror + material.transmission + material.emission;
    Rgb::from(all.min(Rgb::ONE).to_array().map(linear_to_srgb))
}
