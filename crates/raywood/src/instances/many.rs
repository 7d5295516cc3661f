//! Batches of rays through scenes of instances: those that meet an instance go there together.

use super::place::{Placement, is_nearer};
use super::times::{AtStart, When};
use super::{Built, Tlas, Traceable};
use crate::structures::wide::top_many::{DONE, Visitor};
use crate::{Hit, PreparedRay, Ray};

/// How many rays at most go through the tree together. Always the same ones of a batch, so that no answer depends on threads.
pub(super) const MOST: usize = 1024;

/// As many rays at least go through an instance as one batch: preparing one takes about as long as tracing some thirty rays one by one, and only large ones become full packets.
const FEWEST_TOGETHER: usize = 128;

impl<B: Traceable> Tlas<B> {
    /// The closest hits of at most [`MOST`] rays with what the mask lets see.
    pub(super) fn closest_of_many(&self, rays: &[Ray], mask: u32, hits: &mut [Option<Hit>]) {
        self.closest_of_many_when(AtStart, rays, mask, hits);
    }

    /// The same, each at its time.
    pub(super) fn closest_of_many_when(
        &self,
        when: impl When,
        rays: &[Ray],
        mask: u32,
        hits: &mut [Option<Hit>],
    ) {
        hits.fill(None);
        let placements = &self.built.placements[..];
        let (seen, numbers, found) = (vec![], vec![], vec![]);
        let visitor = Closest { placements, when, rays, mask, hits, seen, numbers, found };
        self.built.tree.walk_many(self.level, &self.built.prepared(rays), visitor);
    }

    /// Whether anything that the mask lets see blocks rays, at most [`MOST`].
    pub(super) fn any_of_many(&self, rays: &[Ray], mask: u32, occluded: &mut [bool]) {
        self.any_of_many_when(AtStart, rays, mask, occluded);
    }

    /// The same, each at its time.
    pub(super) fn any_of_many_when(
        &self,
        when: impl When,
        rays: &[Ray],
        mask: u32,
        occluded: &mut [bool],
    ) {
        occluded.fill(false);
        let placements = &self.built.placements[..];
        let visitor = Any { placements, when, rays, mask, occluded, seen: vec![], found: vec![] };
        self.built.tree.walk_many(self.level, &self.built.prepared(rays), visitor);
    }
}

impl<B> Built<B> {
    /// The rays as boxes are tested against them, each with its margin; `None` for what is no ray.
    fn prepared(&self, rays: &[Ray]) -> Vec<Option<(PreparedRay, f32)>> {
        rays.iter().map(|ray| Some((PreparedRay::new(ray)?, self.margin.of(ray)))).collect()
    }
}

/// Looks for closest hits.
struct Closest<'a, B, W> {
    placements: &'a [Placement<B>],
    when: W,
    rays: &'a [Ray],
    mask: u32,
    hits: &'a mut [Option<Hit>],
    /// Rays as an instance sees them, their numbers, and what they hit.
    seen: Vec<Ray>,
    numbers: Vec<u32>,
    found: Vec<Option<Hit>>,
}

impl<B, W> Closest<'_, B, W> {
    /// Takes a hit if it is nearer than what the ray has; returns the ray's limit from there on.
    #[inline(always)]
    fn take(&mut self, ray: u32, hit: Option<Hit>, limit: f32) -> f32 {
        let best = &mut self.hits[ray as usize];
        match hit {
            Some(hit) if is_nearer(&hit, best.as_ref()) => {
                *best = Some(hit);
                limit.min(hit.t)
            }
            _ => limit,
        }
    }
}

impl<B: Traceable, W: When> Visitor for Closest<'_, B, W> {
    #[inline(always)]
    fn one(&mut self, entry: u32, ray: u32, limit: f32) -> f32 {
        let place = &self.placements[entry as usize];
        if place.mask & self.mask == 0 {
            return limit;
        }
        let seen = self.when.seen(place, ray, &self.rays[ray as usize]);
        let (object, within) = (&*place.object, seen.limit(limit));
        let hit = self.when.intersect(object, ray, &seen.ray, within, self.mask);
        self.take(ray, hit.map(|hit| place.in_scene(&hit, &seen)), limit)
    }

    #[inline(always)]
    fn several(&mut self, entry: u32, rays: &[u32], limits: &mut [f32]) {
        let place = &self.placements[entry as usize];
        if place.mask & self.mask == 0 {
            return;
        }
        if rays.len() < FEWEST_TOGETHER {
            for &ray in rays {
                limits[ray as usize] = self.one(entry, ray, limits[ray as usize]);
            }
            return;
        }
        self.seen.clear();
        self.numbers.clear();
        for &number in rays {
            let (ray, limit) = (&self.rays[number as usize], limits[number as usize]);
            let seen = self.when.seen(place, number, ray);
            if seen.unit == 1.0 {
                // What lies as far as the best hit counts as well: it may be of a lower instance.
                let t_max = ray.t_max.min(limit.next_up());
                self.seen.push(Ray { t_max, ..seen.ray });
                self.numbers.push(number);
            } else {
                limits[number as usize] = self.one(entry, number, limit);
            }
        }
        self.found.clear();
        self.found.resize(self.seen.len(), None);
        let Self { when, seen, numbers, found, .. } = self;
        when.intersect_many(&*place.object, numbers, seen, self.mask, found);
        for place_of_ray in 0..self.found.len() {
            let number = self.numbers[place_of_ray];
            let hit = self.found[place_of_ray]
                .map(|hit| Hit { instance: place.first + hit.instance, ..hit });
            let limit = limits[number as usize];
            limits[number as usize] = self.take(number, hit, limit);
        }
    }
}

/// Looks for any hits.
struct Any<'a, B, W> {
    placements: &'a [Placement<B>],
    when: W,
    rays: &'a [Ray],
    mask: u32,
    occluded: &'a mut [bool],
    /// Rays as an instance sees them, and whether it blocks them.
    seen: Vec<Ray>,
    found: Vec<bool>,
}

impl<B: Traceable, W: When> Visitor for Any<'_, B, W> {
    #[inline(always)]
    fn one(&mut self, entry: u32, ray: u32, limit: f32) -> f32 {
        let place = &self.placements[entry as usize];
        if place.mask & self.mask == 0 {
            return limit;
        }
        let seen = self.when.seen(place, ray, &self.rays[ray as usize]).ray;
        if self.when.occluded(&*place.object, ray, &seen, self.mask) {
            self.occluded[ray as usize] = true;
            return DONE;
        }
        limit
    }

    #[inline(always)]
    fn several(&mut self, entry: u32, rays: &[u32], limits: &mut [f32]) {
        let place = &self.placements[entry as usize];
        if place.mask & self.mask == 0 {
            return;
        }
        if rays.len() < FEWEST_TOGETHER {
            for &ray in rays {
                limits[ray as usize] = self.one(entry, ray, limits[ray as usize]);
            }
            return;
        }
        self.seen.clear();
        let seen = |&number: &u32| self.when.seen(place, number, &self.rays[number as usize]).ray;
        self.seen.extend(rays.iter().map(seen));
        self.found.clear();
        self.found.resize(rays.len(), false);
        let Self { when, seen, found, .. } = self;
        when.occluded_many(&*place.object, rays, seen, self.mask, found);
        for (&number, &blocked) in rays.iter().zip(&self.found) {
            if blocked {
                self.occluded[number as usize] = true;
                limits[number as usize] = DONE;
            }
        }
    }
}
