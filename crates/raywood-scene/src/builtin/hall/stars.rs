//! The stars: gold leaf on the blue of the vaults.

use std::f32::consts::PI;

use raywood::Vec3;

use super::super::modelling::{GroinVault, Part};

/// Five-pointed stars all over the underside of a vault, `spacing` apart.
pub(super) fn stars(vault: &GroinVault, spacing: f32) -> Part {
    let mut part = Part::default();
    let row_height = spacing * 0.75f32.sqrt();
    let rows = (vault.half_z / row_height) as i32;
    let columns = (vault.half_x / spacing) as i32 + 1;
    for row in -rows..=rows {
        // Rows are staggered, and a star is on the middle line of every second one.
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        for column in -columns..=columns {
            let x = spacing * (column as f32 + shift);
            let z = row_height * row as f32;
            // Keep clear of the ribs: those around the bay and those over the diagonals.
            let (u, v) = (x.abs() / vault.half_x, z.abs() / vault.half_z);
            let from_edge = (vault.half_x - x.abs()).min(vault.half_z - z.abs());
            if (u - v).abs() * vault.half_z > 0.26 && from_edge > 0.32 && u.min(v) < 0.9 {
                add_star(&mut part, vault.surface(x, z), 0.16 * spacing);
            }
        }
    }
    part
}

/// Adds a star that lies on a surface.
fn add_star(part: &mut Part, (position, normal): (Vec3, Vec3), radius: f32) {
    // Clear of the vault's facets, which bulge above the true surface's chords by less.
    let center = position + 0.02 * normal;
    let (s, t) = normal.orthonormal_basis();
    let tip = |i: i32| {
        let (sin, cos) = (PI * i as f32 / 5.0).sin_cos();
        let length = if i % 2 == 0 { radius } else { 0.42 * radius };
        center + length * (cos * s + sin * t)
    };
    for i in 0..10 {
        part.add_polygon(&[center, tip(i), tip(i + 1)]);
    }
}
