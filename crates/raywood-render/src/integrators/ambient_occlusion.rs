//! Ambient occlusion: how open the surroundings of each point are (Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", 1998).

use std::cell::RefCell;

use raywood::{Ray, Vec3};
use raywood_scene::Rgb;

use super::first_hits::{FirstHits, Shown};
use super::view_depths::ViewDepths;
use super::{Frame, Integrator};
use crate::bsdf::frame::cosine_hemisphere;
use crate::path_samples::PathSamples;
use crate::stats::RayCounts;
use crate::wave::columns::get;
use crate::wave::surfaces::Surfaces;

/// The registry's line for this picture.
pub(super) const INTEGRATOR: Integrator = Integrator {
    name: "ao",
    help: "ambient occlusion: how open the surroundings are, up to a quarter of the way to the eye",
    shows_light: false,
    shows_all_materials: false,
    start: |frame| Box::new(FirstHits { frame, shown: Occlusion::of(frame) }),
};

/// How many rays look around from what a primary ray hits.
const RAYS: u32 = 4;

/// Surroundings up to a distance: a quarter of the median distance from the eye to what it sees.
struct Occlusion {
    reach: f32,
}

impl Occlusion {
    fn of(frame: &Frame<'_>) -> Self {
        Self { reach: 0.25 * ViewDepths::of(frame).median }
    }
}

/// Rays of a wave, and which of them something is in the way of.
#[derive(Default)]
struct Around {
    rays: Vec<Ray>,
    /// When they look, if anything moves.
    times: Vec<f32>,
    blocked: Vec<bool>,
}

thread_local! {
    /// Kept from wave to wave, so that none asks for memory.
    static AROUND: RefCell<Around> = RefCell::default();
}

impl Shown for Occlusion {
    const NOTHING: Rgb = Rgb::ONE;

    fn show(
        &self,
        frame: &Frame<'_>,
        surfaces: &Surfaces,
        samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts {
        AROUND.with_borrow_mut(|Around { rays, times, blocked }| {
            rays.clear();
            times.clear();
            for number in 0..colors.len() {
                let normal = get(&surfaces.normals, number);
                let geometric = get(&surfaces.geometric_normals, number);
                if frame.scene.moves() {
                    times.extend([surfaces.time(number); RAYS as usize]);
                }
                let (s, t) = normal.orthonormal_basis();
                for ray in 0..RAYS {
                    let [x, y, z] = cosine_hemisphere(samples(number).pair(ray)).to_array();
                    let direction: Vec3 = x * s + y * t + z * normal;
                    // What an interpolated normal sends below the surface sees nothing.
                    let end = if direction.dot(geometric) > 0.0 { self.reach } else { 0.0 };
                    let ray = Ray::new(get(&surfaces.origins, number), direction);
                    rays.push(ray.with_interval(0.0, end));
                }
            }
            blocked.clear();
            blocked.resize(rays.len(), false);
            frame.scene.tracer().occluded_batch(rays, times, blocked);
            let is_open = |(blocked, ray): &(&bool, &Ray)| !**blocked && ray.t_max > 0.0;
            let rays_of = rays.chunks_exact(RAYS as usize);
            let answers = blocked.chunks_exact(RAYS as usize).zip(rays_of);
            for (color, (blocked, rays)) in colors.iter_mut().zip(answers) {
                let open = blocked.iter().zip(rays).filter(is_open).count();
                *color = Rgb::splat(open as f32 / RAYS as f32);
            }
            RayCounts { shadow: rays.len() as u64, ..RayCounts::default() }
        })
    }
}
