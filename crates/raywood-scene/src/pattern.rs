//! Solid patterns: colours that vary over a surface, computed from the point in space (Perlin 1985).

use raywood::Vec3;

use crate::Rgb;
use crate::noise::{LANES, cell_value, fractal3, fractal3_lanes};

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
                Floor { colors: [base, other], size, edge, joint }.color(point)
            }
            Self::Masonry { length, height, joint } => {
                Wall { base, length, height, joint }.color(point)
            }
        }
    }

    /// The [colours](Self::color) at the first `count` of many points, all given by columns: x, y, z; red, green, blue. Sixteen points at a time, in
    /// loops that become vectors where the caller is compiled for them. What follows the first `count` colours has no meaning.
    #[inline(always)]
    pub fn colors<const N: usize>(
        &self,
        base: Rgb,
        points: &[[f32; N]; 3],
        colors: &mut [[f32; N]; 3],
        count: usize,
    ) {
        let count = count.min(N);
        for start in (0..count).step_by(LANES) {
            let lanes = LANES.min(N - start);
            let mut place = [[0.0; LANES]; 3];
            for axis in 0..3 {
                place[axis][..lanes].copy_from_slice(&points[axis][start..start + lanes]);
            }
            let color = self.color_lanes(base, &place);
            for channel in 0..3 {
                colors[channel][start..start + lanes].copy_from_slice(&color[channel][..lanes]);
            }
        }
    }

    #[inline(always)]
    fn color_lanes(&self, base: Rgb, points: &Lanes) -> Lanes {
        match *self {
            Self::Marble { vein, size } => {
                let [mut bases, mut veins, mut stones] = [[[0.0; LANES]; 3]; 3];
                for lane in 0..LANES {
                    set(&mut bases, lane, base);
                    set(&mut veins, lane, vein);
                    set(&mut stones, lane, get(points, lane) / size);
                }
                marble_lanes(&bases, &veins, &stones)
            }
            Self::Tiles { other, size, edge, joint } => {
                Floor { colors: [base, other], size, edge, joint }.color_lanes(points)
            }
            Self::Masonry { length, height, joint } => {
                Wall { base, length, height, joint }.color_lanes(points)
            }
            Self::Plain | Self::Checker { .. } => {
                let mut colors = [[0.0; LANES]; 3];
                for lane in 0..LANES {
                    set(&mut colors, lane, self.color(base, get(points, lane)));
                }
                colors
            }
        }
    }
}

/// Three numbers for each of the points that are computed at once.
type Lanes = [[f32; LANES]; 3];

#[inline(always)]
fn get(columns: &Lanes, lane: usize) -> Vec3 {
    Vec3::new(columns[0][lane], columns[1][lane], columns[2][lane])
}

#[inline(always)]
fn set(columns: &mut Lanes, lane: usize, v: Vec3) {
    [columns[0][lane], columns[1][lane], columns[2][lane]] = v.to_array();
}

/// [`marble`] at many points, each of a stone of its own.
#[inline(always)]
fn marble_lanes(bases: &Lanes, veins: &Lanes, points: &Lanes) -> Lanes {
    let folds = fractal3_lanes(points, FOLD_OCTAVES, FOLD_SEED);
    let mut places = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        set(&mut places, lane, cloud_place(get(points, lane)));
    }
    let clouds = fractal3_lanes(&places, CLOUD_OCTAVES, CLOUD_SEED);
    let mut colors = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let (base, vein) = (get(bases, lane), get(veins, lane));
        set(&mut colors, lane, veined(base, vein, folds[lane], clouds[lane]));
    }
    colors
}

/// Marble of one stone; veins about one apart.
#[inline(always)]
fn marble(base: Rgb, vein: Rgb, p: Vec3) -> Rgb {
    let folds = fractal3(p, FOLD_OCTAVES, FOLD_SEED);
    let clouds = fractal3(cloud_place(p), CLOUD_OCTAVES, CLOUD_SEED);
    veined(base, vein, folds, clouds)
}

const FOLD_OCTAVES: u32 = 4;
const FOLD_SEED: u32 = 17;
const CLOUD_OCTAVES: u32 = 2;
const CLOUD_SEED: u32 = 5;

/// Where a stone's clouds are read.
#[inline(always)]
fn cloud_place(p: Vec3) -> Vec3 {
    0.6 * p + Vec3::splat(31.7)
}

/// The colour of marble with this noise for its folds and its clouds.
#[inline(always)]
fn veined(base: Rgb, vein: Rgb, folds: f32, clouds: f32) -> Rgb {
    // Veins are where a folded noise crosses zero: thin sheets through space.
    let sheet = 1.0 - 7.0 * folds.abs();
    let sheet = if sheet > 0.0 { sheet } else { 0.0 };
    let clouds = 0.5 + 0.5 * clouds;
    let amount = 0.75 * sheet * sheet * (0.35 + clouds) + 0.25 * clouds;
    let amount = if amount < 1.0 { amount } else { 1.0 };
    base + amount * (vein - base)
}

/// A floor of square tiles.
#[derive(Clone, Copy)]
struct Floor {
    colors: [Rgb; 2],
    size: f32,
    edge: [f32; 2],
    joint: f32,
}

/// A point of a tile: which stone, where in the quarry, and the colour of the joint if it is on one.
struct OnTile {
    base: Rgb,
    vein: Rgb,
    stone: Vec3,
    joint: Option<Rgb>,
}

impl Floor {
    #[inline(always)]
    fn at(self, p: Vec3) -> OnTile {
        let Self { colors: [a, b], size, edge, joint } = self;
        // Which tile, and how far from its nearest edge.
        let along = (p.x * edge[0] + p.z * edge[1]) / size + OFF_LATTICE;
        let across = (p.z * edge[0] - p.x * edge[1]) / size + OFF_LATTICE;
        let (i, k) = (along.floor(), across.floor());
        let from_edge = |t: f32| 0.5 - (t - t.floor() - 0.5).abs();
        let (to_side, to_end) = (from_edge(along), from_edge(across));
        let margin = if to_side < to_end { to_side } else { to_end } * size;
        let (i, k) = (i as i32, k as i32);
        let dark = i.wrapping_add(k) & 1 == 1;

        // Cut each tile from another place of the quarry; light stone has dark veins, dark stone light ones.
        let base = if dark { b } else { a };
        let contrast = if dark { a } else { b };
        let place = |seed| 40.0 * cell_value(i, k, 0, seed);
        let tone = 0.88 + 0.24 * cell_value(i, k, 0, 4);
        OnTile {
            base: tone * base,
            vein: base + 0.45 * (contrast - base),
            stone: p / (1.1 * size) + Vec3::new(place(1), place(2), place(3)),
            joint: if margin < 0.5 * joint { Some(0.25 * (a + b)) } else { None },
        }
    }

    /// A chequered floor of marble tiles.
    #[inline(always)]
    fn color(self, p: Vec3) -> Rgb {
        let OnTile { base, vein, stone, joint } = self.at(p);
        joint.unwrap_or_else(|| marble(base, vein, stone))
    }

    #[inline(always)]
    fn color_lanes(self, points: &Lanes) -> Lanes {
        let mut joints = [0; LANES];
        let [mut bases, mut veins, mut stones] = [[[0.0; LANES]; 3]; 3];
        for (lane, on_joint) in joints.iter_mut().enumerate() {
            let OnTile { base, vein, stone, joint } = self.at(get(points, lane));
            set(&mut bases, lane, base);
            set(&mut veins, lane, vein);
            set(&mut stones, lane, stone);
            *on_joint = u32::from(joint.is_some());
        }
        let mut colors = marble_lanes(&bases, &veins, &stones);
        let between = 0.25 * (self.colors[0] + self.colors[1]);
        for (lane, on_joint) in joints.iter().enumerate() {
            let color = get(&colors, lane);
            set(&mut colors, lane, if *on_joint != 0 { between } else { color });
        }
        colors
    }
}

/// A wall of blocks in staggered courses.
#[derive(Clone, Copy)]
struct Wall {
    base: Rgb,
    length: f32,
    height: f32,
    joint: f32,
}

impl Wall {
    /// Where the grain of the stone at a point is read.
    #[inline(always)]
    fn grain_place(p: Vec3) -> Vec3 {
        p * 2.5
    }

    #[inline(always)]
    fn color(self, p: Vec3) -> Rgb {
        self.grained(p, fractal3(Self::grain_place(p), GRAIN_OCTAVES, GRAIN_SEED))
    }

    #[inline(always)]
    fn color_lanes(self, points: &Lanes) -> Lanes {
        let mut places = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            set(&mut places, lane, Self::grain_place(get(points, lane)));
        }
        let grain = fractal3_lanes(&places, GRAIN_OCTAVES, GRAIN_SEED);
        let mut colors = [[0.0; LANES]; 3];
        for (lane, grain) in grain.iter().enumerate() {
            set(&mut colors, lane, self.grained(get(points, lane), *grain));
        }
        colors
    }

    /// The colour at a point with this noise for its grain.
    #[inline(always)]
    fn grained(self, p: Vec3, grain: f32) -> Rgb {
        let Self { base, length, height, joint } = self;
        // Along a wall only one of x and z changes, so their sum measures the length on walls of both directions.
        let course = p.y / height + OFF_LATTICE;
        let row = course.floor();
        let shift = if row as i32 & 1 == 0 { 0.0 } else { 0.5 };
        let along = (p.x + p.z) / length + shift + OFF_LATTICE;
        let block = along.floor();
        let from_edge = |t: f32| 0.5 - (t - t.floor() - 0.5).abs();
        let (to_side, to_end) = (from_edge(along) * length, from_edge(course) * height);
        let margin = if to_side < to_end { to_side } else { to_end };

        let (i, j) = (block as i32, row as i32);
        let tone = 0.86 + 0.26 * cell_value(i, j, 0, 1);
        let warmth = 0.03 * (cell_value(i, j, 0, 2) - 0.5);
        let grain = 1.0 + 0.10 * grain;
        let color =
            (tone * grain) * Rgb::new(base.x * (1.0 + warmth), base.y, base.z * (1.0 - warmth));
        let share = if margin < 0.5 * joint { 0.62 } else { 1.0 };
        share * color
    }
}

const GRAIN_OCTAVES: u32 = 3;
const GRAIN_SEED: u32 = 3;

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

                // Of columns the same colours come, wherever in them a point is.
                let mut points = [[t; 37]; 3];
                let place = i % 37;
                [points[0][place], points[1][place], points[2][place]] = p.to_array();
                let mut colors = [[f32::NAN; 37]; 3];
                pattern.colors(base, &points, &mut colors, place + 1);
                assert_eq!([0, 1, 2].map(|channel| colors[channel][place]), color.to_array());
            }
            // Broken points must not break the picture either.
            let _ = pattern.color(base, Vec3::splat(f32::NAN));
            let _ = pattern.color(base, Vec3::splat(f32::MAX));
        }
    }
}
