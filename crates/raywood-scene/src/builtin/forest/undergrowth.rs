//! What grows and lies between and before the trees: ferns, grass, reeds, water lilies, stones.

use std::f32::consts::TAU;

use raywood::Vec3;

use super::super::modelling::{Cells, Part, Placement};
use super::materials::{LEAVES, STONE};
use super::plant::{Joint, Leaf, Plant};
use super::random::Rng;
use crate::Rgb;
use crate::noise::fractal3;

/// A fern: fronds that rise and bend over, with leaflets on both sides.
pub(super) fn fern(seed: u64) -> Plant {
    let mut rng = Rng::new(seed);
    let mut plant = Plant::default();
    let fronds = 9 + rng.below(4);
    for frond in 0..fronds {
        let angle = TAU * (frond as f32 + rng.between(-0.3, 0.3)) / fronds as f32;
        let away = Vec3::new(angle.cos(), 0.0, angle.sin());
        let length = rng.between(0.55, 0.9);
        let at = |t: f32| length * (0.85 * t * away + (1.25 * t - 0.95 * t * t) * Vec3::Y);
        let joints =
            [0.0, 0.35, 0.7, 1.0].map(|t| Joint { position: at(t), radius: 0.007 - 0.006 * t });
        let stalk = Rgb::new(0.10, 0.14, 0.03);
        plant.stem(&joints, 3, LEAVES, |_| stalk);
        const PAIRS: usize = 17;
        for pair in 0..PAIRS {
            let t = 0.16 + 0.84 * pair as f32 / PAIRS as f32;
            let ahead = (at(t + 0.03) - at(t - 0.03)).normalize_or_zero();
            let side = ahead.cross(Vec3::Y).normalize_or_zero();
            let reach = 0.26 * length * (1.0 - t).powf(0.6) * (0.4 + 0.6 * (t * 5.0).min(1.0));
            let color = rng.between(0.75, 1.2) * Rgb::new(0.13, 0.26, 0.045);
            for hand in [-1.0f32, 1.0] {
                let along = (hand * side + 0.45 * ahead - 0.12 * Vec3::Y).normalize_or_zero();
                let across = along.cross(ahead.cross(side)).normalize_or_zero();
                let leaf = Leaf { base: at(t), along, across, length: reach, width: 0.045 };
                plant.leaf(&leaf, Vec3::Y, color, LEAVES);
            }
        }
    }
    plant
}

/// A patch of grass of a metre across, with a flower here and there.
pub(super) fn grass(seed: u64, flowers: usize) -> Plant {
    let mut rng = Rng::new(seed);
    let mut plant = Plant::default();
    let place = |rng: &mut Rng| {
        let (angle, reach) = (rng.angle(), 0.55 * rng.unit().sqrt());
        Vec3::new(reach * angle.cos(), -0.02, reach * angle.sin())
    };
    for _ in 0..150 {
        let (foot, turn) = (place(&mut rng), rng.angle());
        let lean = rng.between(0.15, 0.75) * Vec3::new(turn.cos(), 0.0, turn.sin());
        let size = (rng.between(0.10, 0.30), rng.between(0.008, 0.014));
        let dry = rng.unit() * rng.unit();
        let tint = |green: Rgb| (1.0 - dry) * green + dry * Rgb::new(0.27, 0.22, 0.09);
        let colors = [tint(Rgb::new(0.08, 0.14, 0.025)), tint(Rgb::new(0.23, 0.34, 0.07))];
        plant.blade(foot, lean, size, colors, LEAVES);
    }
    for _ in 0..flowers {
        let foot = place(&mut rng);
        let head = foot + rng.between(0.2, 0.34) * Vec3::Y + 0.05 * rng.vector();
        let joints = [foot, head].map(|position| Joint { position, radius: 0.0035 });
        plant.stem(&joints, 3, LEAVES, |_| Rgb::new(0.07, 0.13, 0.03));
        for petal in 0..8 {
            let turn = TAU * petal as f32 / 8.0;
            let along = Vec3::new(turn.cos(), 0.35, turn.sin()).normalize_or_zero();
            let across = Vec3::new(-turn.sin(), 0.0, turn.cos());
            let leaf = Leaf { base: head, along, across, length: 0.035, width: 0.02 };
            plant.leaf(&leaf, Vec3::Y, Rgb::new(0.75, 0.72, 0.66), LEAVES);
        }
    }
    plant
}

/// Reeds with a few bulrushes.
pub(super) fn reeds(seed: u64) -> Plant {
    let mut rng = Rng::new(seed);
    let mut plant = Plant::default();
    for _ in 0..42 {
        let (angle, reach, turn) = (rng.angle(), 0.5 * rng.unit().sqrt(), rng.angle());
        let foot = Vec3::new(reach * angle.cos(), -0.4, reach * angle.sin());
        let lean = rng.between(0.05, 0.35) * Vec3::new(turn.cos(), 0.0, turn.sin());
        let size = (rng.between(1.0, 1.9), rng.between(0.014, 0.024));
        let dry = 0.6 * rng.unit();
        let tint = |green: Rgb| (1.0 - dry) * green + dry * Rgb::new(0.30, 0.25, 0.11);
        let colors = [tint(Rgb::new(0.05, 0.08, 0.02)), tint(Rgb::new(0.15, 0.22, 0.05))];
        plant.blade(foot, lean, size, colors, LEAVES);
    }
    for _ in 0..5 {
        let (angle, reach) = (rng.angle(), 0.4 * rng.unit().sqrt());
        let foot = Vec3::new(reach * angle.cos(), -0.4, reach * angle.sin());
        let top = foot + rng.between(1.5, 1.9) * Vec3::Y + 0.12 * rng.vector();
        let joint = |share: f32, radius: f32| Joint {
            position: (1.0 - share) * foot + share * top,
            radius,
        };
        plant.stem(&[joint(0.0, 0.006), joint(1.12, 0.003)], 4, LEAVES, |_| {
            Rgb::new(0.14, 0.17, 0.05)
        });
        let head = [joint(0.88, 0.004), joint(0.89, 0.018), joint(0.99, 0.018), joint(1.0, 0.004)];
        plant.stem(&head, 7, LEAVES, |_| Rgb::new(0.085, 0.045, 0.022));
    }
    plant
}

/// Leaves of water lilies on the water, and a flower.
pub(super) fn lilies(seed: u64) -> Plant {
    let mut rng = Rng::new(seed);
    let mut plant = Plant::default();
    for pad in 0..7 {
        let (angle, reach) = (rng.angle(), 0.75 * rng.unit().sqrt());
        let center =
            Vec3::new(reach * angle.cos(), 0.012 + 0.003 * pad as f32, reach * angle.sin());
        let (radius, turn) = (rng.between(0.13, 0.24), rng.angle());
        let color = rng.between(0.8, 1.2) * Rgb::new(0.06, 0.13, 0.035);
        let mut part = Part::default();
        // A disc with a notch.
        let rim = |step: usize| {
            let angle = turn + 0.25 + (TAU - 0.5) * step as f32 / 15.0;
            center + radius * Vec3::new(angle.cos(), 0.05 * (3.0 * angle).sin(), -angle.sin())
        };
        for step in 0..15 {
            part.add_polygon(&[center, rim(step), rim(step + 1)]);
        }
        plant.part(&part, &Placement::IDENTITY, LEAVES, |_| color);
    }
    let head = Vec3::new(0.1, 0.05, 0.05);
    for ring in 0..3 {
        for petal in 0..8 {
            let turn = TAU * (petal as f32 + 0.5 * ring as f32) / 8.0;
            let rise = 0.25 + 0.5 * ring as f32;
            let along = Vec3::new(turn.cos(), rise, turn.sin()).normalize_or_zero();
            let across = Vec3::new(-turn.sin(), 0.0, turn.cos());
            let leaf = Leaf { base: head, along, across, length: 0.10, width: 0.045 };
            let color = Rgb::new(0.85, 0.72 - 0.1 * ring as f32, 0.74 - 0.08 * ring as f32);
            plant.leaf(&leaf, Vec3::Y, color, LEAVES);
        }
    }
    plant
}

/// A stone of about a metre, with moss on its top.
pub(super) fn stone(seed: u64) -> Plant {
    let mut rng = Rng::new(seed);
    let shift = 40.0 * rng.vector();
    let flat = rng.between(0.55, 0.8);
    let mut part = Part::default();
    part.add_grid(Cells::closed(28), Cells::open(16), |i, j| {
        let (turn, down) = (TAU * i as f32 / 28.0, 0.5 * TAU * j as f32 / 16.0);
        // From below upwards, so that the front is outside; ends that meet exactly.
        let (sin, cos) =
            if j % 16 == 0 { (0.0, if j == 0 { 1.0 } else { -1.0 }) } else { down.sin_cos() };
        let point = Vec3::new(sin * turn.cos(), -cos, -sin * turn.sin());
        let bumps = fractal3(1.4 * point + shift, 4, 21);
        let radius = 0.5 * (1.0 + 0.55 * bumps);
        Vec3::new(radius * point.x, flat * radius * point.y, radius * point.z)
    });
    let mut plant = Plant::default();
    plant.part(&part, &Placement::IDENTITY, STONE, |point| {
        let grain = fractal3(9.0 * point + shift, 4, 33);
        let moss = (point.y * 3.2 + 1.6 * grain - 0.25).clamp(0.0, 0.85);
        let grey = Rgb::new(0.20, 0.19, 0.17) * (1.0 + 0.8 * grain);
        (1.0 - moss) * grey + moss * Rgb::new(0.075, 0.105, 0.025)
    });
    plant
}
