//! Normals as colours: from -1 to 1 in x, y and z as from 0 to 1 in red, green and blue.

use raywood_scene::Rgb;

use super::first_hits::{FirstHits, OfEach};
use super::{Frame, Integrator};
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "normals",
    help: "normals for shading, -1 to 1 in x, y, z as 0 to 1 in red, green, blue",
    shows_light: false,
    shows_all_materials: false,
    start: |frame| Box::new(FirstHits { frame, shown: OfEach(normal) }),
};

/// The normal for shading on the side of the eye, in the axes of the scene.
fn normal(_: &Frame<'_>, surfaces: &Surfaces, number: usize) -> Rgb {
    0.5 * (get(&surfaces.normals, number) + Rgb::ONE)
}
