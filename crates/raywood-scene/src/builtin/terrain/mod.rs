//! `terrain`: a mountainous island in a calm sea, a fractal heightfield of as many triangles as asked for.

mod colors;
mod heights;

use rayon::prelude::*;
use raywood::{TriangleMesh, Vec3};

use super::{Builtin, Parameter, Values};
use crate::{Background, Camera, Light, LightKind, Material, MaterialId, Mesh, Rgb, Scene};
use colors::ground_color;
use heights::{Heights, SIZE};

pub(super) const ENTRY: Builtin = Builtin {
    name: "terrain",
    description: "an eroded, snow-capped island in a calm sea, 2 n^2 + 2 triangles",
    parameters: &[
        Parameter {
            name: "n",
            description: "cells along each side: 512 makes 524,290 triangles, 2048 makes 8,388,610",
            default: 512,
            min: 1,
            max: 4096,
        },
        Parameter {
            name: "seed",
            description: "which island",
            default: 11,
            min: 0,
            max: u32::MAX as u64,
        },
    ],
    build,
};

const LAND: MaterialId = 0;
const SEA: MaterialId = 1;

/// Half the extent of the sea: far enough that its edge meets the horizon.
const SEA_EXTENT: f32 = 60_000.0;

fn build(values: &Values) -> Scene {
    let (n, seed) = (values.get("n") as usize, values.get("seed") as u32);
    let eye = Vec3::new(-1800.0, 0.0, 8200.0);
    let heights = Heights::new(seed);
    // Wherever the seed puts land, the eye stays well above it.
    let eye = Vec3::new(eye.x, 420.0 + heights.at(eye.x, eye.z).max(0.0), eye.z);
    Scene {
        mesh: island(n, &heights, eye),
        materials: materials(),
        lights: lights(),
        cameras: vec![Camera {
            name: "camera".into(),
            eye,
            target: Vec3::new(0.0, 560.0, 0.0),
            up: Vec3::Y,
            fov_y: 31.0,
        }],
        background: Background {
            zenith: Rgb::new(0.01, 0.22, 0.66),
            horizon: Rgb::new(0.90, 0.83, 0.68),
            nadir: Rgb::new(0.10, 0.16, 0.22),
        },
        ..Scene::default()
    }
}

/// The land as a grid of `n` by `n` cells, two triangles each, and the sea as two large triangles.
fn island(n: usize, heights: &Heights, eye: Vec3) -> Mesh {
    let side = n + 1;
    let place = |i: usize| SIZE * (i as f32 / n as f32 - 0.5);

    // Heights first, for the normals come from their differences. Each row is computed by itself, so the result
    // does not depend on how rows are shared out to threads.
    let mut grid = vec![0.0f32; side * side];
    grid.par_chunks_mut(side).enumerate().for_each(|(j, row)| {
        for (i, height) in row.iter_mut().enumerate() {
            *height = heights.at(place(i), place(j));
        }
    });

    let mut normals = vec![Vec3::ZERO; side * side];
    let mut colors = vec![Rgb::ZERO; side * side];
    let mut positions = vec![Vec3::ZERO; side * side];
    let rows = normals.par_chunks_mut(side).zip(colors.par_chunks_mut(side));
    rows.zip(positions.par_chunks_mut(side)).enumerate().for_each(
        |(j, ((normals, colors), positions))| {
            for i in 0..side {
                let (left, right) = (i.saturating_sub(1), (i + 1).min(n));
                let (before, behind) = (j.saturating_sub(1), (j + 1).min(n));
                let rise_x = grid[j * side + right] - grid[j * side + left];
                let rise_z = grid[behind * side + i] - grid[before * side + i];
                let along_x = place(right) - place(left);
                let along_z = place(behind) - place(before);
                normals[i] =
                    Vec3::new(-rise_x / along_x, 1.0, -rise_z / along_z).normalize_or_zero();
                positions[i] = Vec3::new(place(i), grid[j * side + i], place(j));
                colors[i] = ground_color(positions[i], normals[i], eye);
            }
        },
    );

    // Two triangles a cell, fronts up, diagonals alternating so that no direction is preferred.
    let mut triangles = vec![[0u32; 3]; 2 * n * n + 2];
    triangles[..2 * n * n].par_chunks_mut(2 * n).enumerate().for_each(|(j, row)| {
        for (i, pair) in row.chunks_exact_mut(2).enumerate() {
            let a = (j * side + i) as u32;
            let (b, c, d) = (a + 1, a + 1 + side as u32, a + side as u32);
            if (i + j) % 2 == 0 {
                pair.copy_from_slice(&[[a, d, c], [a, c, b]]);
            } else {
                pair.copy_from_slice(&[[a, d, b], [b, d, c]]);
            }
        }
    });

    // The sea.
    let first = positions.len() as u32;
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)] {
        positions.push(Vec3::new(x * SEA_EXTENT, 0.0, z * SEA_EXTENT));
        normals.push(Vec3::Y);
        colors.push(Rgb::ONE);
    }
    triangles[2 * n * n] = [first, first + 1, first + 2];
    triangles[2 * n * n + 1] = [first, first + 2, first + 3];
    let mut materials = vec![LAND; 2 * n * n];
    materials.extend([SEA; 2]);

    let triangles =
        TriangleMesh::new(positions, triangles).expect("heights are finite, indices in range");
    Mesh { triangles, normals, colors, materials, ..Mesh::default() }
}

fn lights() -> Vec<Light> {
    let light = |name: &str, kind, intensity| Light { name: name.into(), kind, intensity };
    let sun = Vec3::new(0.88, -0.36, -0.22).normalize_or_zero();
    vec![
        light("sky", LightKind::Ambient, Rgb::new(0.15, 0.20, 0.32)),
        light("sun", LightKind::directional(sun), Rgb::new(2.5, 1.85, 1.20)),
    ]
}

/// The materials, in the order of their numbers.
fn materials() -> Vec<Material> {
    vec![
        // The colours of the land are those of its vertices.
        Material { name: "land".into(), diffuse: Rgb::ONE, ..Material::default() },
        Material {
            name: "sea".into(),
            diffuse: Rgb::new(0.015, 0.05, 0.07),
            mirror: Rgb::splat(0.05),
            ..Material::default()
        },
    ]
}
