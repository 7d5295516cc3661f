//! The land: hills above the sea, and trees on them.

use raywood::{Transform, Vec3};

use super::{BARK, LEAVES, TREES};
use crate::builtin::modelling::{Cells, Part, Profile, revolve, revolve_with};
use crate::{Instance, MaterialId, Rgb};

/// How far the land reaches from its middle.
const REACH: f32 = 240.0;

/// How far the sea does.
const SEA_REACH: f32 = 6000.0;

/// The height of the land, above the sea or below.
pub(super) fn height(x: f32, z: f32) -> f32 {
    let hill = |cx: f32, cz: f32, width: f32, high: f32| {
        let (dx, dz) = ((x - cx) / width, (z - cz) / width);
        high / (1.0 + dx * dx + dz * dz).powi(2)
    };
    let rolling = (0.11 * x + 1.0).sin() * (0.09 * z).cos() + 0.5 * (0.23 * x - 0.17 * z).sin();
    let hills =
        hill(0.0, 0.0, 26.0, 3.2) + hill(-46.0, -60.0, 34.0, 7.0) + hill(32.0, -78.0, 36.0, 6.0);
    // The shore, a long way behind.
    let shore = 0.10 * (z + 118.0 + 16.0 * (0.035 * x).sin()).min(0.0);
    hills + 0.32 * rolling + shore
}

/// The land as a grid, finer in the middle.
pub(super) fn ground() -> Part {
    let cells = 220;
    let place = |number: usize| {
        let share = 2.0 * number as f32 / cells as f32 - 1.0;
        REACH * share * (0.25 + 0.75 * share * share)
    };
    let mut part = Part::default();
    part.add_grid(Cells::open(cells), Cells::open(cells), |i, j| {
        let (x, z) = (place(i), -place(j));
        Vec3::new(x, height(x, z), z)
    });
    part
}

/// The sea, which lies a little below the land.
pub(super) fn sea() -> Part {
    let (reach, level) = (SEA_REACH, -1.6);
    let mut part = Part::default();
    part.add_polygon(&[
        Vec3::new(-reach, level, reach),
        Vec3::new(reach, level, reach),
        Vec3::new(reach, level, -reach),
        Vec3::new(-reach, level, -reach),
    ]);
    part
}

/// A poplar, seven units high.
pub(super) fn poplar() -> Vec<(Part, MaterialId)> {
    let crown = Profile::start(0.0, 0.7)
        .curve_to([[1.5, 0.9], [1.25, 3.6]], 0.75, 5.0, 18)
        .curve_to([[0.5, 6.0], [0.25, 6.7]], 0.0, 7.0, 12)
        .smooth();
    let crown = revolve_with(&crown, 28, |radius, y, angle| {
        let bumps = (5.0 * angle + 2.3 * y).sin() + (3.0 * angle - 4.1 * y).sin();
        radius * (1.0 + 0.10 * bumps)
    });
    vec![(crown, LEAVES), (trunk(1.2, 0.16), BARK)]
}

/// A round tree, five units high.
pub(super) fn oak() -> Vec<(Part, MaterialId)> {
    let mut crown = Part::default();
    for [x, y, z, size] in
        [[0.0, 3.3, 0.0, 1.7], [1.2, 2.8, 0.3, 1.2], [-1.1, 2.7, 0.5, 1.25], [0.1, 2.9, -1.2, 1.2]]
    {
        let ball = Profile::start(0.0, -size).arc([0.0, 0.0], 0.85, 180.0, 20);
        let ball = revolve_with(&ball, 26, |radius, y, angle| {
            radius * (1.0 + 0.07 * ((6.0 * angle + 3.0 * y).sin() + (4.0 * angle - 5.0 * y).cos()))
        });
        let mut ball = ball;
        ball.positions.iter_mut().for_each(|p| *p += Vec3::new(x, y, z));
        crown.add_part(&ball);
    }
    vec![(crown, LEAVES), (trunk(2.6, 0.26), BARK)]
}

fn trunk(height: f32, radius: f32) -> Part {
    let profile = Profile::start(1.6 * radius, -0.6).curve_to(
        [[radius, 0.1], [0.9 * radius, 0.5 * height]],
        0.7 * radius,
        height,
        6,
    );
    revolve(&profile, 12)
}

/// Trees in groups, none of them near a mill or before the eye.
pub(super) fn trees(seed: u32, mills: &[[f32; 2]]) -> Vec<Instance> {
    let mut state = seed.wrapping_mul(0x9e37_79b9) ^ 0x51ed_270b;
    let mut unit = move || {
        // A linear congruential generator, its better bits.
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut trees = Vec::new();
    for _ in 0..900 {
        let (x, z) = (240.0 * (unit() - 0.5), 30.0 - 150.0 * unit());
        let (size, degrees, shade, sort) = (unit(), 360.0 * unit(), unit(), unit());
        let grove = (0.07 * x + 0.5).sin() + (0.06 * z - 0.2 * x.abs().sqrt()).cos();
        let free = |&[mx, mz]: &[f32; 2]| (x - mx).hypot(z - mz) > 13.0;
        let before_eye = z > -14.0 && x.abs() < 18.0 + 0.3 * (14.0 + z);
        let y = height(x, z);
        if grove < 0.75 || before_eye || !mills.iter().all(free) || y < -0.6 {
            continue;
        }
        let size = 0.55 + 0.75 * size;
        let transform = Transform::scaling([size, size * (0.9 + 0.3 * shade), size])
            .then(&Transform::rotation(Vec3::Y, degrees))
            .then(&Transform::translation([x, y, z]));
        let tint = (0.75 + 0.6 * shade) * Rgb::new(0.9 + 0.5 * sort, 1.0, 0.9);
        let tree = TREES[usize::from(sort > 0.45)];
        trees.push(Instance { tint, ..Instance::new(tree, transform) });
    }
    trees
}
