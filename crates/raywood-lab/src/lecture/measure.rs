//! What a ray costs: nodes, primitives, references, and time.

use std::hint::black_box;

use raywood::{Geometry, Probe, Structure};

use super::lab::KindRay;
use crate::timing::{Timing, seconds, take_turns};

/// What rays do, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Work {
    nodes: u64,
    primitives: u64,
    references: u64,
    rays: u64,
}

impl Probe for Work {
    #[inline]
    fn nodes(&mut self, count: usize) {
        self.nodes += count as u64;
    }

    #[inline]
    fn primitives(&mut self, count: usize) {
        self.primitives += count as u64;
    }

    #[inline]
    fn references(&mut self, count: usize) {
        self.references += count as u64;
    }
}

impl Work {
    /// Counts what rays do in a structure.
    pub(super) fn of<G: Geometry>(structure: &Structure<G>, rays: &[KindRay]) -> Self {
        let mut work = Self { rays: rays.len() as u64, ..Self::default() };
        for KindRay { ray, any_hit } in rays {
            if *any_hit {
                structure.occluded_probed(ray, &mut work);
            } else {
                structure.intersect_probed(ray, &mut work);
            }
        }
        work
    }

    fn per_ray(&self, count: u64) -> f64 {
        count as f64 / self.rays.max(1) as f64
    }

    /// Nodes or cells that a ray enters.
    pub(super) fn nodes(&self) -> f64 {
        self.per_ray(self.nodes)
    }

    /// Primitives that a ray is tested against.
    pub(super) fn primitives(&self) -> f64 {
        self.per_ray(self.primitives)
    }

    /// Nodes and primitives of a ray: its work, whatever the machine.
    pub(super) fn steps(&self) -> f64 {
        self.nodes() + self.primitives()
    }

    /// References that a ray meets.
    pub(super) fn references(&self) -> f64 {
        self.per_ray(self.references)
    }
}

/// At most so many of the rays, spread evenly over all of them.
pub(super) fn thinned(rays: &[KindRay], count: usize) -> Vec<KindRay> {
    let count = count.min(rays.len());
    (0..count).map(|i| rays[i * rays.len() / count]).collect()
}

/// As many of the rays as take about so many steps in all, but not less than a few: so that slow structures do not take all the time.
pub(super) fn affordable<G: Geometry>(
    structure: &Structure<G>,
    rays: &[KindRay],
    steps: f64,
) -> Vec<KindRay> {
    const FEW: usize = 64;
    let per_ray = Work::of(structure, &thinned(rays, FEW)).steps().max(1.0);
    thinned(rays, ((steps / per_ray) as usize).max(FEW))
}

/// Traces rays one after the other on this thread.
pub(super) fn trace<G: Geometry>(structure: &Structure<G>, rays: &[KindRay]) {
    for KindRay { ray, any_hit } in rays {
        if *any_hit {
            black_box(structure.occluded(ray));
        } else {
            black_box(structure.intersect(ray));
        }
    }
}

/// Times structures in turn, each on its rays, on this thread.
pub(super) fn time<G: Geometry>(
    contestants: &[(&Structure<G>, &[KindRay])],
    rounds: usize,
) -> Vec<Timing> {
    let run = |i: usize| {
        let (structure, rays) = contestants[i];
        Some(seconds(|| trace(structure, rays)).0)
    };
    take_turns(contestants.len(), rounds, run).unwrap_or_default()
}

/// Nanoseconds per ray; NaN without rays.
pub(super) fn nanoseconds(timing: &Timing, rays: usize) -> f64 {
    1e9 * timing.median() / rays as f64
}

/// How far times spread, as the method's text says it.
pub(super) fn spread_text<'a>(timings: impl IntoIterator<Item = &'a Timing>) -> String {
    let mut spreads: Vec<_> = timings.into_iter().map(Timing::spread).collect();
    spreads.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| {
        let place = share * spreads.len().saturating_sub(1) as f64;
        100.0 * spreads.get(place.round() as usize).copied().unwrap_or(0.0)
    };
    format!(
        "half of the rounds lay about \u{b1}{:.1} % around their median (\u{b1}{:.1} % in the noisiest tenth of the measurements)",
        at(0.5),
        at(0.9)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::shapes;
    use raywood::{BuildOptions, Ray, StructureKind};

    #[test]
    fn slow_structures_get_fewer_rays() {
        let scene = shapes::soup(1_000);
        let ray = Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
        let rays = vec![KindRay { ray, any_hit: false }; 5_000];
        let rays_for = |kind| {
            let mesh = &scene.mesh.triangles;
            let structure = Structure::build(kind, mesh, &BuildOptions::default());
            affordable(&structure.expect("a structure"), &rays, 1e6).len()
        };
        assert_eq!(rays_for(StructureKind::BruteForce), 999);
        assert_eq!(rays_for(StructureKind::BvhSahBinned), 5_000);
        assert_eq!(thinned(&rays, 7).len(), 7);
        assert!(thinned(&[], 7).is_empty());
    }
}
