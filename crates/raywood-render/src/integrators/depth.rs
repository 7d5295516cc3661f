//! Depth as brightness: the nearer, the brighter.

use raywood_scene::Rgb;

use super::first_hits::{FirstHits, OfEach};
use super::view_depths::ViewDepths;
use super::{Frame, Integrator};
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "depth",
    help: "how far away things are: the nearest white, the farthest black, by the reciprocal",
    shows_light: false,
    shows_all_materials: false,
    start: |frame| Box::new(FirstHits { frame, shown: OfEach(depth(ViewDepths::of(frame))) }),
};

/// Reciprocals of distances, which tell near things apart however far others are.
fn depth(
    ViewDepths { nearest, farthest, .. }: ViewDepths,
) -> impl Fn(&Frame<'_>, &Surfaces, usize) -> Rgb + Sync {
    let least = nearest / farthest;
    let range = (1.0 - least).max(f32::EPSILON);
    move |_, surfaces, number| {
        let share = (nearest / surfaces.lengths[number] - least) / range;
        Rgb::splat(share.clamp(0.0, 1.0))
    }
}
