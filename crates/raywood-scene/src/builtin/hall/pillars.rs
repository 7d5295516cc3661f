//! The pillars: plinth, moulded base, fluted or twisted shaft, and a capital with leaves and volutes.

use std::f32::consts::{PI, TAU};

use raywood::Vec3;

use super::super::modelling::{
    Cells, Part, PathPoint, Placement, Profile, cuboid, revolve, revolve_with, sweep,
};
use super::plan::ARCADE_SPRING;

/// Where the shaft begins and ends.
const SHAFT_BOTTOM: f32 = 0.72;
const SHAFT_TOP: f32 = 3.52;
/// Where the capital's bell ends and the slab on it begins.
const BELL_TOP: f32 = 4.14;
/// The shaft's radius at its lower and upper end.
const RADIUS_BOTTOM: f32 = 0.40;
const RADIUS_TOP: f32 = 0.335;

/// Everything of a pillar but the shaft, standing on the origin. `detail` multiplies the number of segments.
pub(super) fn base_and_capital(detail: usize) -> Part {
    let mut part = Part::default();
    let square = |part: &mut Part, half: f32, low: f32, high: f32| {
        part.add_part(&cuboid(Vec3::new(-half, low, -half), Vec3::new(half, high, half)));
    };

    // The base: a plinth, then the Attic sequence of torus, scotia and torus.
    square(&mut part, 0.60, 0.0, 0.20);
    square(&mut part, 0.565, 0.20, 0.25);
    let base = Profile::start(0.50, 0.25)
        .line_to(0.49, 0.25)
        .arc([0.49, 0.325], 1.0, 180.0, 5 * detail)
        .line_to(0.47, 0.40)
        .line_to(0.47, 0.425)
        .curve_to([[0.395, 0.43], [0.395, 0.53]], 0.445, 0.545, 5 * detail)
        .line_to(0.445, 0.565)
        .arc([0.445, 0.615], 1.0, 180.0, 5 * detail)
        .line_to(0.425, 0.665)
        .line_to(0.425, 0.69)
        .curve_to([[0.405, 0.69], [0.40, 0.70]], RADIUS_BOTTOM, SHAFT_BOTTOM, 2 * detail);
    part.add_part(&revolve(&base, 24 * detail));

    // The capital: a ring at the neck, a bell, leaves in two rows, volutes under the corners, and the slab.
    let bell = Profile::start(RADIUS_TOP, SHAFT_TOP)
        .line_to(RADIUS_TOP + 0.015, SHAFT_TOP)
        .arc([RADIUS_TOP + 0.015, SHAFT_TOP + 0.03], 1.0, 180.0, 4 * detail)
        .line_to(RADIUS_TOP - 0.01, SHAFT_TOP + 0.06)
        .curve_to([[0.325, 3.80], [0.35, 4.03]], 0.455, BELL_TOP - 0.03, 6 * detail)
        .line_to(0.455, BELL_TOP);
    part.add_part(&revolve(&bell, 24 * detail));
    for i in 0..8 {
        let turned = |half: f32| Placement::IDENTITY.turned(45.0 * (i as f32 + half));
        part.add_part(&leaf(0.30, detail).placed(&turned(0.5)));
        part.add_part(&leaf(0.47, detail).placed(&turned(0.0)));
    }
    for i in 0..4 {
        let corner = Placement::IDENTITY.turned(45.0 + 90.0 * i as f32);
        part.add_part(&volute(detail).placed(&corner));
    }
    square(&mut part, 0.50, BELL_TOP, 4.20);
    square(&mut part, 0.56, 4.20, 4.31);
    square(&mut part, 0.525, 4.31, ARCADE_SPRING);
    part
}

/// A shaft with twenty flutes that end below the capital and above the base.
pub(super) fn fluted_shaft(detail: usize) -> Part {
    revolve_with(&shaft_profile(16 * detail), 80 * detail, |radius, y, angle| {
        let ends = ramp(y - SHAFT_BOTTOM - 0.05, 0.07) * ramp(SHAFT_TOP - 0.07 - y, 0.07);
        radius * (1.0 - 0.075 * ends * (10.0 * angle).sin().abs())
    })
}

/// A shaft like a rope of six strands.
pub(super) fn twisted_shaft(detail: usize) -> Part {
    revolve_with(&shaft_profile(28 * detail), 42 * detail, |radius, y, angle| {
        let ends = ramp(y - SHAFT_BOTTOM - 0.05, 0.25) * ramp(SHAFT_TOP - 0.05 - y, 0.25);
        // Strands are round outside and meet in a valley.
        let strand = (3.0 * (angle - 2.0 * y)).sin().abs().sqrt();
        radius * (1.0 - 0.26 * ends * (1.0 - strand))
    })
}

/// The shaft's outline: it tapers, with the slight swelling that keeps a straight pillar from looking hollow.
fn shaft_profile(rows: usize) -> Profile {
    let middle = |t: f32| SHAFT_BOTTOM + t * (SHAFT_TOP - SHAFT_BOTTOM);
    Profile::start(RADIUS_BOTTOM, SHAFT_BOTTOM).curve_to(
        [[RADIUS_BOTTOM, middle(0.33)], [RADIUS_BOTTOM - 0.012, middle(0.66)]],
        RADIUS_TOP,
        SHAFT_TOP,
        rows,
    )
}

/// Rises smoothly from 0 to 1 over a length.
fn ramp(x: f32, length: f32) -> f32 {
    let t = (x / length).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A leaf on the side of the bell towards +x, `height` tall, with lobed edges, a midrib and a tip that curls over.
fn leaf(height: f32, detail: usize) -> Part {
    let (rows, columns) = (8 * detail, 3 * detail);
    let mut part = Part::default();
    part.add_grid(Cells::open(columns), Cells::open(rows), |i, j| {
        let s = 2.0 * i as f32 / columns as f32 - 1.0;
        let t = j as f32 / rows as f32;
        // The spine climbs along the bell, leans out, and turns down at the tip.
        let curl = PI * 1.15 * ramp(t - 0.55, 0.45);
        let lean = 0.045 * t + 0.13 * t * t * t;
        let out = 0.345 + 0.10 * height * t + lean + 0.055 * curl.sin().max(0.0);
        let up = SHAFT_TOP
            + 0.06
            + height * (t.min(0.86) + 0.10 * curl.sin() - 0.07 * (1.0 - curl.cos()));
        // The outline swells, has lobes, and closes at the tip.
        let swell = (0.55 + 0.9 * t * (1.0 - t)) * (1.0 - t * t * t * t).max(0.0).sqrt();
        let lobes = 1.0 - 0.16 * (5.0 * PI * t).sin().abs();
        let width = 0.135 * swell * lobes;
        let hollow = swell * (0.045 * s * s - 0.025 * (1.0 - s.abs()).powi(4));
        Vec3::new(out - hollow, up, -width * s)
    });
    part
}

/// A spiral that grows out of the bell and rolls up under the slab's corner, in the plane z = 0 towards +x.
fn volute(detail: usize) -> Part {
    let steps = 20 * detail;
    let path: Vec<_> = (0..=steps)
        .map(|i| {
            let t = i as f32 / steps as f32;
            let angle = PI * 1.1 - t * TAU * 1.6;
            let radius = 0.115 * (1.0 - 0.80 * t);
            let roll = Vec3::new(0.545 + radius * angle.cos(), 4.02 + radius * angle.sin(), 0.0);
            PathPoint { position: roll, up: Vec3::Z }
        })
        .collect();
    let mut part = sweep(&Profile::circle(0.026, 4 * detail), &path, false);
    let eye = Profile::start(0.0, -0.034).arc([0.0, 0.0], 1.0, 180.0, 4 * detail);
    part.add_part(&revolve(&eye, 8 * detail).placed(&Placement::at(Vec3::new(0.545, 4.02, 0.0))));
    part
}
