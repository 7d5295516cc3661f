//! Shadow rays that wait to be traced, and what they bring if they arrive.

use raywood::{Hit, Ray};
use raywood_scene::Rgb;

use super::picture::Picture;
use super::walks::Walk;
use crate::PreparedScene;
use crate::bsdf::straight_share;
use crate::shadows::{Aim, MOST_CROSSINGS, Passage, may_meet, passage};
use crate::stats::RayCounts;
use crate::textured::opacity_at;
use crate::tiles::TilePixels;

/// Whether a light has extent: then a path can find it by itself, through glass too; else light is let straight through glass, for it would never arrive.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    None,
    Some,
}

/// What a shadow ray brings if it arrives.
#[derive(Clone, Copy)]
struct Bringing {
    pixel: u16,
    /// How many surfaces were crossed.
    crossings: u16,
    extent: Extent,
    aim: Aim,
    /// When the ray looks at the scene, if anything moves there.
    time: f32,
    light: Rgb,
}

/// Shadow rays that wait.
#[derive(Default)]
pub(super) struct ShadowRays {
    rays: Vec<Ray>,
    bringing: Vec<Bringing>,
    /// Memory for times.
    times: Vec<f32>,
    blocked: Vec<bool>,
    /// Those that are blocked where something may let light through.
    crossing: Vec<Ray>,
    crossing_bringing: Vec<Bringing>,
    hits: Vec<Option<Hit>>,
}

impl ShadowRays {
    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.bringing.clear();
        self.crossing.clear();
        self.crossing_bringing.clear();
    }

    /// Has a ray wait that brings so much to the pixel of a path if it arrives.
    #[inline(always)]
    pub(super) fn push(&mut self, ray: Ray, aim: Aim, extent: Extent, walk: &Walk, light: Rgb) {
        self.rays.push(ray);
        let &Walk { pixel, time, .. } = walk;
        self.bringing.push(Bringing { pixel, crossings: 0, extent, aim, time, light });
    }

    /// Traces all rays, if at least `fewest` wait, and adds the light of those that arrive. Blocked ones that may have met what lets light through wait for as
    /// many again.
    pub(super) fn trace(
        &mut self,
        picture: &Picture<'_>,
        fewest: usize,
        pixels: &mut TilePixels,
        counts: &mut RayCounts,
    ) {
        if self.rays.len() < fewest {
            return;
        }
        let scene = picture.frame.scene;
        let Self { rays, bringing, times, blocked, .. } = self;
        blocked.clear();
        blocked.resize(rays.len(), false);
        find_times(scene, bringing, times);
        scene.tracer().occluded_batch(rays, times, blocked);
        counts.shadow += rays.len() as u64;
        let bounds = scene.transmissive_bounds(picture.frame.options.opaque_shadows);
        for ((ray, bringing), blocked) in rays.iter().zip(&*bringing).zip(&*blocked) {
            if !blocked {
                pixels[usize::from(bringing.pixel)] += bringing.light;
            } else if !bounds.is_empty() && may_meet(ray, bounds) {
                // It counts again, surface by surface.
                counts.shadow -= 1;
                self.crossing.push(*ray);
                self.crossing_bringing.push(*bringing);
            }
        }
        rays.clear();
        bringing.clear();
        while self.crossing.len() >= fewest {
            self.advance(picture, pixels, counts);
        }
    }

    /// Takes blocked rays to the next surface, adds the light of those that meet none, and has those wait again that it lets through.
    fn advance(&mut self, picture: &Picture<'_>, pixels: &mut TilePixels, counts: &mut RayCounts) {
        let Self { crossing: rays, crossing_bringing: bringing, times, hits, .. } = self;
        let scene = picture.frame.scene;
        let opaque = picture.frame.options.opaque_shadows;
        hits.resize(rays.len(), None);
        find_times(scene, bringing, times);
        scene.tracer().intersect_batch(rays, times, hits);
        counts.shadow += rays.len() as u64;

        let mut left = 0;
        for number in 0..rays.len() {
            let Bringing { pixel, crossings, extent, aim, time, light } = bringing[number];
            let (ray, hit) = ((&rays[number], time), &hits[number]);
            let Some(hit) = hit else {
                pixels[usize::from(pixel)] += light;
                continue;
            };
            let passed = match extent {
                Extent::None => passage(scene, ray, hit, opaque),
                Extent::Some => straight_passage(scene, ray, hit, opaque),
            };
            let Some(Passage { share, origin }) = passed else { continue };
            let (light, crossings) = (light * share, crossings + 1);
            if light.max_element() > 0.0 && u32::from(crossings) < MOST_CROSSINGS {
                rays[left] = aim.ray_from(origin);
                bringing[left] = Bringing { pixel, crossings, extent, aim, time, light };
                left += 1;
            }
        }
        rays.truncate(left);
        bringing.truncate(left);
    }
}

/// Finds out when rays look at the scene; leaves that out if nothing moves there.
fn find_times(scene: &PreparedScene<'_>, bringing: &[Bringing], times: &mut Vec<f32>) {
    times.clear();
    if scene.moves() {
        times.extend(bringing.iter().map(|bringing| bringing.time));
    }
}

/// What goes straight through a surface, as paths do: through holes, and through what does not bend light unless that is to be opaque.
fn straight_passage(
    scene: &PreparedScene<'_>,
    (ray, time): (&Ray, f32),
    hit: &Hit,
    opaque: bool,
) -> Option<Passage> {
    let material = scene.material_of(hit);
    let opacity = if material.perforated { opacity_at(scene, hit) } else { 1.0 };
    let whole = if opaque { Rgb::ZERO } else { straight_share(material) };
    let share = Rgb::splat(1.0 - opacity) + opacity * whole;
    let point = scene.tracer().surface_point(ray, hit, time);
    let passage = Passage { share, origin: point.origin_towards(ray.direction) };
    (share.max_element() > 0.0).then_some(passage)
}
