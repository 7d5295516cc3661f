//! Depth as brightness: the nearer, the brighter.

use raywood_scene::Rgb;

use super::first_hits::{FirstHits, Shown};
use super::view_depths::ViewDepths;
use super::{Frame, Integrator};
use crate::path_samples::PathSamples;
use crate::stats::RayCounts;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "depth",
    help: "how far away things are: the nearest white, the farthest black, by the reciprocal",
    shows_light: false,
    start: |frame| Box::new(FirstHits { frame, shown: Depth { seen: ViewDepths::of(frame) } }),
};

/// Reciprocals of distances, which tell near things apart however far others are.
struct Depth {
    seen: ViewDepths,
}

impl Shown for Depth {
    const NOTHING: Rgb = Rgb::ZERO;

    fn show(
        &self,
        _frame: &Frame<'_>,
        surfaces: &Surfaces,
        _samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts {
        let ViewDepths { nearest, farthest, .. } = self.seen;
        let least = nearest / farthest;
        let range = (1.0 - least).max(f32::EPSILON);
        for (number, color) in colors.iter_mut().enumerate() {
            let share = (nearest / surfaces.lengths[number] - least) / range;
            *color = Rgb::splat(share.clamp(0.0, 1.0));
        }
        RayCounts::default()
    }
}
