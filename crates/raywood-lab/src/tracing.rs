//! Tracing a set of rays by the clock, on the threads of the current rayon pool.

use raywood::{Geometry, Ray, Structure};

use crate::ray_sets::{RayKind, RaySet};
use crate::timing::seconds;

/// A round in which a structure traces a set of rays shall not take much longer; a slower structure traces a sample of the set.
const ROUND_SECONDS: f64 = 0.2;

/// The rays by which the speed of a structure is guessed, for each thread.
const PILOT_RAYS: usize = 16;

/// The seconds that the structure takes for the rays.
pub(crate) fn trace<G: Geometry>(structure: &Structure<G>, kind: RayKind, rays: &[Ray]) -> f64 {
    if kind.any_hit() {
        let mut blocked = vec![false; rays.len()];
        seconds(|| structure.occluded_batch(rays, &mut blocked)).0
    } else {
        let mut hits = vec![None; rays.len()];
        seconds(|| structure.intersect_batch(rays, &mut hits)).0
    }
}

/// How many of the rays the structure can trace in a round: all, but of a slow structure only what a few rays make expect.
pub(crate) fn affordable<G: Geometry>(structure: &Structure<G>, set: &RaySet) -> usize {
    let all = set.rays.len();
    let threads = rayon::current_num_threads();
    // First a ray a thread, which even the slowest can trace in time. Then more, if that was no trouble; and again: a machine that does other
    // things too makes a few rays look slow now and then, but not every time.
    let mut guess = threads;
    for few in [threads, PILOT_RAYS * threads, PILOT_RAYS * threads, PILOT_RAYS * threads] {
        let pilot: Vec<_> = set.sample(few).into_iter().map(|index| set.rays[index]).collect();
        let per_ray = trace(structure, set.kind, &pilot) / pilot.len().max(1) as f64;
        guess = guess.max((ROUND_SECONDS / per_ray.max(1e-9)) as usize);
        // Few and cold, they are slower than most.
        if 4 * guess >= all {
            return all;
        }
        if guess < few {
            break;
        }
    }
    guess
}
