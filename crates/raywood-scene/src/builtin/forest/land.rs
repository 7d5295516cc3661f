//! The lie of the land: a lake in a hollow, a clearing at its shore, hills all around.

use rayon::prelude::*;
use raywood::Vec3;

use super::materials::{GROUND, WATER};
use super::plant::Plant;
use crate::Rgb;
use crate::noise::fractal3;

/// From the middle of the ground to its edge, in metres.
const REACH: f32 = 620.0;

/// How many cells the ground has along each side.
const CELLS: usize = 420;

/// From where the lake is looked at: the middle of the clearing.
pub(super) const CLEARING: [f32; 2] = [-1.0, 31.0];

/// The land of a seed.
pub(super) struct Land {
    seed: u32,
}

/// From 0 before `low` to 1 after `high`, smoothly.
pub(super) fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Land {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed }
    }

    /// Noise over the ground, about -1 to 1, that changes over so many metres.
    pub(super) fn noise(&self, x: f32, z: f32, over: f32, octaves: u32, which: u32) -> f32 {
        let place = Vec3::new(x / over, 7.3 * which as f32, z / over);
        fractal3(place, octaves, self.seed.wrapping_mul(31).wrapping_add(which))
    }

    /// How far from the lake's middle a place is, in terms of its shore, which is at 1.
    pub(super) fn shore(&self, x: f32, z: f32) -> f32 {
        let round = ((x / 44.0) * (x / 44.0) + ((z + 8.0) / 27.0) * ((z + 8.0) / 27.0)).sqrt();
        round + 0.16 * self.noise(x, z, 19.0, 3, 1) * (round * 1.2).min(1.0)
    }

    /// The height of the ground; the lake's surface is at 0.
    pub(super) fn height(&self, x: f32, z: f32) -> f32 {
        let shore = self.shore(x, z);
        if shore < 1.0 {
            return -3.5 * (1.0 - shore);
        }
        let beyond = shore - 1.0;
        let bank = 1.05 * (1.0 - (-2.4 * beyond).exp());
        let bumps = smooth_step(0.1, 1.2, beyond) * self.noise(x, z, 14.0, 4, 2);
        // Higher behind the lake than behind the eye.
        let behind = 0.30 + 0.70 * smooth_step(20.0, -130.0, z);
        let rise = smooth_step(0.35, 10.0, beyond);
        let ridges = 1.0 + 0.75 * self.noise(x, z, 150.0, 3, 3);
        bank + 0.9 * bumps + 64.0 * behind * rise * ridges
    }

    /// What the ground looks like: sand at the shore, grass in the open, leaves and moss under trees.
    fn color(&self, point: Vec3) -> Rgb {
        let (x, z) = (point.x, point.z);
        let fine = self.noise(x, z, 1.6, 4, 4);
        let coarse = self.noise(x, z, 9.0, 3, 5);
        let soil = Rgb::new(0.115, 0.080, 0.045) * (1.0 + 0.7 * fine);
        let moss = Rgb::new(0.070, 0.100, 0.025) * (1.0 + 0.6 * fine);
        let meadow = Rgb::new(0.12, 0.17, 0.045) * (1.0 + 0.5 * fine);
        let sand = Rgb::new(0.26, 0.21, 0.14) * (1.0 + 0.35 * fine);
        let mix = |a: Rgb, b: Rgb, share: f32| (1.0 - share) * a + share * b;
        let floor = mix(soil, moss, (0.45 + 1.1 * coarse).clamp(0.0, 1.0));
        let open = smooth_step(1.75, 1.25, self.shore(x, z) + 0.3 * coarse);
        let ground = mix(floor, meadow, open.max(self.clearing(x, z)));
        let wet = smooth_step(0.42, 0.10, point.y + 0.15 * coarse);
        let under = smooth_step(0.0, -1.2, point.y);
        mix(mix(ground, sand, wet), Rgb::new(0.03, 0.03, 0.02), under)
    }

    /// How much a place belongs to the clearing from which the lake is looked at.
    pub(super) fn clearing(&self, x: f32, z: f32) -> f32 {
        let (dx, dz) = ((x - CLEARING[0]) / 17.0, (z - CLEARING[1]) / 14.0);
        let away = (dx * dx + dz * dz).sqrt() + 0.25 * self.noise(x, z, 8.0, 2, 6);
        smooth_step(1.15, 0.85, away)
    }

    /// The ground, its cells small near the lake and large far away.
    pub(super) fn ground(&self) -> Plant {
        let side = CELLS + 1;
        let place = |i: usize| {
            let u = 2.0 * i as f32 / CELLS as f32 - 1.0;
            REACH * u * (0.12 + 0.88 * u * u)
        };
        let at = |i: usize, j: usize| {
            let (x, z) = (place(i), place(j) + 10.0);
            Vec3::new(x, self.height(x, z), z)
        };
        let vertex = |number: usize| {
            let position = at(number % side, number / side);
            // Over the same distance everywhere, so that normals do not show the cells.
            let Vec3 { x, z, .. } = position;
            let step = 0.35;
            let slope_x = (self.height(x + step, z) - self.height(x - step, z)) / (2.0 * step);
            let slope_z = (self.height(x, z + step) - self.height(x, z - step)) / (2.0 * step);
            let normal = Vec3::new(-slope_x, 1.0, -slope_z).normalize_or_zero();
            (position, normal, self.color(position))
        };
        let vertices: Vec<_> = (0..side * side).into_par_iter().map(vertex).collect();
        let mut ground = Plant::default();
        for (position, normal, color) in vertices {
            ground.positions.push(position);
            ground.normals.push(normal);
            ground.colors.push(color);
        }
        grid_triangles(&mut ground, CELLS, CELLS, GROUND);
        ground
    }

    /// The lake's surface, with small waves that only its normals have.
    pub(super) fn water(&self) -> Plant {
        const COLUMNS: usize = 280;
        const ROWS: usize = 180;
        let (low, high) = ([-64.0, -52.0], [64.0, 34.0]);
        let mut water = Plant::default();
        for j in 0..=ROWS {
            for i in 0..=COLUMNS {
                let x = low[0] + (high[0] - low[0]) * i as f32 / COLUMNS as f32;
                let z = low[1] + (high[1] - low[1]) * j as f32 / ROWS as f32;
                // A breeze in some places, calm in others.
                let breeze = 0.004 + 0.011 * smooth_step(-0.1, 0.5, self.noise(x, z, 28.0, 2, 7));
                let tilt = |which| self.noise(x, 1.8 * z, 1.9, 2, which);
                let normal = Vec3::new(breeze * tilt(8), 1.0, breeze * tilt(9));
                water.positions.push(Vec3::new(x, 0.0, z));
                water.normals.push(normal.normalize_or_zero());
                water.colors.push(Rgb::ONE);
            }
        }
        grid_triangles(&mut water, COLUMNS, ROWS, WATER);
        water
    }
}

/// The triangles of a grid of vertices, row by row, that faces up.
fn grid_triangles(plant: &mut Plant, columns: usize, rows: usize, material: crate::MaterialId) {
    let side = columns + 1;
    for j in 0..rows {
        for i in 0..columns {
            let a = (j * side + i) as u32;
            let (b, c, d) = (a + 1, a + 1 + side as u32, a + side as u32);
            match (i + j) % 2 {
                0 => plant.triangles.extend([[a, d, c], [a, c, b]]),
                _ => plant.triangles.extend([[a, d, b], [b, d, c]]),
            }
        }
    }
    plant.materials.resize(plant.triangles.len(), material);
}
