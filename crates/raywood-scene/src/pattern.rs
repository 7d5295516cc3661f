//! Solid patterns: colours that vary over a surface, computed from the point in space (Perlin 1985).

use raywood::Vec3;

use crate::Rgb;
use crate::noise::{cell_value, fractal3};

/// What modulates a diffuse colour over a surface, computed from the point in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pattern {
    /// Nothing: one colour all over.
    #[default]
    Plain,
    /// Cubes of alternating colour: the diffuse colour, and `other`.
    Checker {
        /// The second colour.
        other: Rgb,
        /// The edge of a cube.
        size: f32,
    },
    /// Marble: the diffuse colour, clouded, and crossed by thin veins.
    Marble {
        /// The colour of the veins.
        vein: Rgb,
        /// The distance between large veins, roughly.
        size: f32,
    },
    /// A floor of square marble tiles, chequered in x and z: the diffuse colour and `other`, each tile cut from
    /// another piece of stone, with a dark joint between tiles.
    Tiles {
        /// The colour of every second tile.
        other: Rgb,
        /// The edge of a tile.
        size: f32,
        /// The direction of the tiles' edges in x and z, unit length.
        edge: [f32; 2],
        /// The width of the joints.
        joint: f32,
    },
    /// Courses of blocks with joints, for walls that run along x or along z: the diffuse colour, each block a
    /// little different.
    Masonry {
        /// The length of a block.
        length: f32,
        /// The height of a course.
        height: f32,
        /// The width of the joints.
        joint: f32,
    },
}

/// Lattices are moved by this share of a cell, so that surfaces in their planes (a floor at height zero) lie
/// clearly on one side.
const OFF_LATTICE: f32 = 1.0 / 1024.0;

impl Pattern {
    /// The colour at a point in space of a surface whose diffuse colour is `base`.
    #[inline(always)]
    pub fn color(&self, base: Rgb, point: Vec3) -> Rgb {
        match *self {
            Self::Plain => base,
            Self::Checker { other, size } => {
                let cell = |x: f32| (x / size + OFF_LATTICE).floor() as i32;
                let sum = cell(point.x).wrapping_add(cell(point.y)).wrapping_add(cell(point.z));
                if sum & 1 == 0 { base } else { other }
            }
            Self::Marble { vein, size } => marble(base, vein, point / size),
            Self::Tiles { other, size, edge, joint } => {
                tiles(base, other, point, size, edge, joint)
            }
            Self::Masonry { length, height, joint } => masonry(base, point, length, height, joint),
        }
    }
}

/// Marble of one stone; veins about one apart.
#[inline(always)]
fn marble(base: Rgb, vein: Rgb, p: Vec3) -> Rgb {
    // Veins are where a folded noise crosses zero: thin sheets through space.
    let folds = fractal3(p, 4, 17);
    let sheet = (1.0 - 7.0 * folds.abs()).max(0.0);
    let clouds = 0.5 + 0.5 * fractal3(0.6 * p + Vec3::splat(31.7), 2, 5);
    let amount = (0.75 * sheet * sheet * (0.35 + clouds) + 0.25 * clouds).min(1.0);
    base + amount * (vein - base)
}

/// A chequered floor of marble tiles.
#[inline(always)]
fn tiles(a: Rgb, b: Rgb, p: Vec3, size: f32, edge: [f32; 2], joint: f32) -> Rgb {
    // Which tile, and how far from its nearest edge.
    let along = (p.x * edge[0] + p.z * edge[1]) / size + OFF_LATTICE;
    let across = (p.z * edge[0] - p.x * edge[1]) / size + OFF_LATTICE;
    let (i, k) = (along.floor(), across.floor());
    let from_edge = |t: f32| 0.5 - (t - t.floor() - 0.5).abs();
    let margin = from_edge(along).min(from_edge(across)) * size;
    let (i, k) = (i as i32, k as i32);
    let dark = i.wrapping_add(k) & 1 == 1;
    if margin < 0.5 * joint {
        return 0.25 * (a + b);
    }

    // Cut each tile from another place of the quarry; light stone has dark veins, dark stone light ones.
    let (base, contrast) = if dark { (b, a) } else { (a, b) };
    let place = |seed| 40.0 * cell_value(i, k, 0, seed);
    let stone = p / (1.1 * size) + Vec3::new(place(1), place(2), place(3));
    let tone = 0.88 + 0.24 * cell_value(i, k, 0, 4);
    marble(tone * base, base + 0.45 * (contrast - base), stone)
}

/// A wall of blocks in staggered courses.
#[inline(always)]
fn masonry(base: Rgb, p: Vec3, length: f32, height: f32, joint: f32) -> Rgb {
    // Along a wall only one of x and z changes, so their sum measures the length on walls of both directions.
    let course = p.y / height + OFF_LATTICE;
    let row = course.floor();
    let shift = if row as i32 & 1 == 0 { 0.0 } else { 0.5 };
    let along = (p.x + p.z) / length + shift + OFF_LATTICE;
    let block = along.floor();
    let from_edge = |t: f32| 0.5 - (t - t.floor() - 0.5).abs();
    let margin = (from_edge(along) * length).min(from_edge(course) * height);

    let (i, j) = (block as i32, row as i32);
    let tone = 0.86 + 0.26 * cell_value(i, j, 0, 1);
    let warmth = 0.03 * (cell_value(i, j, 0, 2) - 0.5);
    let grain = 1.0 + 0.10 * fractal3(p * 2.5, 3, 3);
    let color = (tone * grain) * Rgb::new(base.x * (1.0 + warmth), base.y, base.z * (1.0 - warmth));
    if margin < 0.5 * joint { 0.62 * color } else { color }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checker_alternates_and_a_surface_in_a_lattice_plane_is_not_speckled() {
        let (white, black) = (Rgb::ONE, Rgb::ZERO);
        let checker = Pattern::Checker { other: black, size: 2.0 };
        for noise in [-1e-4, 0.0, 1e-4] {
            let at = |x: f32, z: f32| checker.color(white, Vec3::new(x, noise, z));
            assert_eq!([at(1.0, 1.0), at(3.0, 1.0), at(3.0, 3.0)], [white, black, white]);
            assert_eq!(at(-1.0, 1.0), black);
        }
    }

    #[test]
    fn patterns_stay_near_their_colours_everywhere() {
        let (base, other) = (Rgb::splat(0.8), Rgb::splat(0.1));
        for pattern in [
            Pattern::Plain,
            Pattern::Checker { other, size: 0.5 },
            Pattern::Marble { vein: other, size: 0.7 },
            Pattern::Tiles { other, size: 0.5, edge: [0.6, 0.8], joint: 0.01 },
            Pattern::Masonry { length: 0.9, height: 0.4, joint: 0.01 },
        ] {
            for i in 0..5000 {
                let t = i as f32;
                let p = Vec3::new((0.37 * t).sin(), (0.51 * t).cos(), (0.11 * t).sin()) * t;
                let color = pattern.color(base, p);
                assert!(color.is_finite() && color.max_element() <= 1.1, "{pattern:?}: {color:?}");
                assert!(color.x.min(color.y).min(color.z) >= 0.0, "{pattern:?}: {color:?}");
            }
            // Broken points must not break the picture either.
            let _ = pattern.color(base, Vec3::splat(f32::NAN));
            let _ = pattern.color(base, Vec3::splat(f32::MAX));
        }
    }
}
