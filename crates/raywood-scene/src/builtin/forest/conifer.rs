//! Spruces: a straight trunk, whorls of branches, and on their twigs needles in tufts.

use std::f32::consts::TAU;

use raywood::Vec3;

use super::materials::{BARK, LEAVES};
use super::plant::{Joint, Leaf, Plant};
use super::random::Rng;
use crate::Rgb;
use crate::noise::fractal3;

/// How tall, in metres.
const HEIGHT: f32 = 23.0;

/// From this share of the height on there are branches.
const BRANCHES_FROM: f32 = 0.07;

/// The length of the lowest branches.
const LONGEST: f32 = 3.6;

/// A spruce, its foot at the origin. `fullness` is how dense its branches are: 1 is usual.
pub(super) fn spruce(seed: u64, fullness: f32) -> Plant {
    let mut rng = Rng::new(seed);
    let mut plant = Plant::default();
    let joints: Vec<_> = (0..=14)
        .map(|piece| {
            let share = piece as f32 / 14.0;
            let sway = 0.05 * share * rng.vector();
            let flare = 0.5 * (-16.0 * share).exp();
            let position = Vec3::new(sway.x, HEIGHT * share - 0.3, sway.z);
            Joint { position, radius: 0.27 * (1.0 + flare - 0.97 * share) }
        })
        .collect();
    plant.stem(&joints, 10, BARK, bark);

    let whorls = (46.0 * fullness.sqrt()) as usize;
    for whorl in 0..whorls {
        // Nearer to each other towards the top.
        let share = (whorl as f32 + rng.between(-0.3, 0.3)).max(0.0) / whorls as f32;
        let height = HEIGHT * (BRANCHES_FROM + (0.985 - BRANCHES_FROM) * share.powf(0.92));
        let count = (7.0 * fullness.sqrt() + rng.between(-1.0, 1.0)) as usize;
        let turn = rng.angle();
        let shape = (1.0 - share).powf(0.82) * (0.72 + 0.28 * (share * 9.0).min(1.0));
        for branch in 0..count {
            let angle = turn + (branch as f32 + rng.between(-0.25, 0.25)) * TAU / count as f32;
            let length = (LONGEST * shape * rng.between(0.7, 1.1)).max(0.18);
            let from = Vec3::new(0.0, height + rng.between(-0.12, 0.12), 0.0);
            add_branch(&mut plant, &mut rng, from, angle, length, share);
        }
    }
    plant
}

fn bark(point: Vec3) -> Rgb {
    let grain = fractal3(Vec3::new(9.0 * point.x, 3.0 * point.y, 9.0 * point.z), 3, 17);
    Rgb::new(0.125, 0.088, 0.062) * (1.0 + 0.7 * grain)
}

/// A branch that hangs down from the trunk and bends up again at its end, steeper the higher it grows.
fn add_branch(plant: &mut Plant, rng: &mut Rng, from: Vec3, angle: f32, length: f32, share: f32) {
    let (sin, cos) = angle.sin_cos();
    let away = Vec3::new(cos, 0.0, sin);
    let droop = 0.52 - 0.95 * share;
    let at = |t: f32| {
        let fall = -droop * t + 0.30 * t * t;
        from + length * t * away + (length * fall) * Vec3::Y
    };
    let joints: Vec<_> = (0..=4)
        .map(|piece| {
            let t = piece as f32 / 4.0;
            Joint { position: at(t), radius: (0.012 + 0.010 * length) * (1.0 - 0.85 * t) }
        })
        .collect();
    plant.stem(&joints, 3, BARK, bark);

    // Twigs to both sides, longest in the middle, and one at the end.
    let side = Vec3::new(-sin, 0.0, cos);
    let twigs = (length * 6.5) as usize + 3;
    for twig in 0..twigs {
        let t = 0.16 + 0.84 * (twig as f32 + rng.unit()) / twigs as f32;
        let base = at(t);
        let ahead = (at((t + 0.05).min(1.05)) - at(t - 0.05)).normalize_or_zero();
        let hand = if twig % 2 == 0 { 1.0 } else { -1.0 };
        let sag = Vec3::new(0.0, rng.between(-0.35, 0.05), 0.0);
        let direction = (ahead + hand * rng.between(0.7, 1.2) * side + sag).normalize_or_zero();
        let reach = (0.30 * length * (1.15 - t) + 0.16) * rng.between(0.75, 1.2);
        add_needles(plant, rng, base, direction, reach.min(0.95), away);
    }
    let ahead = (at(1.0) - at(0.85)).normalize_or_zero();
    add_needles(plant, rng, at(0.93), ahead, 0.3, away);
}

/// Needles along a twig: flat tufts on both sides and above, each as wide as needles are long.
fn add_needles(
    plant: &mut Plant,
    rng: &mut Rng,
    base: Vec3,
    direction: Vec3,
    length: f32,
    outwards: Vec3,
) {
    let flat = direction.cross(Vec3::Y).normalize_or_zero();
    let tufts = (length / 0.13) as usize + 1;
    let mix = rng.unit();
    let old = (1.0 - mix) * Rgb::new(0.034, 0.088, 0.036) + mix * Rgb::new(0.062, 0.130, 0.042);
    for tuft in 0..tufts {
        let t = tuft as f32 / tufts as f32;
        let from = base + (length * t) * direction;
        // What grew this year is lighter.
        let color = (1.0 + 0.6 * t) * old;
        for side in [-1.0f32, 1.0] {
            let spread = side * rng.between(0.45, 0.75);
            let up = Vec3::new(0.0, rng.between(-0.05, 0.3), 0.0);
            let along = (direction + spread * flat + up).normalize_or_zero();
            let across = (Vec3::Y + 0.8 * rng.vector()).cross(along).normalize_or_zero();
            let leaf = Leaf { base: from, along, across, length: 0.26, width: 0.085 };
            let facing = (0.5 * outwards + Vec3::Y).normalize_or_zero();
            plant.leaf(&leaf, facing, color, LEAVES);
        }
    }
}
