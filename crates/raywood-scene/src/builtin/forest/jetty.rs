//! A small jetty of weathered timber that leads into the lake.

use raywood::Vec3;

use super::super::modelling::{Placement, cuboid};
use super::materials::TIMBER;
use super::plant::{Joint, Plant};
use super::random::Rng;
use crate::Rgb;
use crate::noise::fractal3;

const LENGTH: f32 = 9.5;
const WIDTH: f32 = 1.5;
/// Above the water.
const HEIGHT: f32 = 0.62;

/// The jetty, from the origin on land towards -z.
pub(super) fn jetty(seed: u64) -> Plant {
    let mut rng = Rng::new(seed);
    let mut plant = Plant::default();
    const PLANKS: usize = 46;
    let pitch = LENGTH / PLANKS as f32;
    for plank in 0..PLANKS {
        let z = -pitch * (plank as f32 + 0.5);
        let [shift, turn, lift] = [0.05, 1.1, 0.008].map(|most| rng.between(-most, most));
        let shade = rng.between(0.7, 1.25);
        let half = Vec3::new(0.5 * WIDTH, 0.022, 0.45 * pitch);
        let placement = Placement::at(Vec3::new(shift, HEIGHT + lift, z)).turned(turn);
        plant.part(&cuboid(-half, half), &placement, TIMBER, |point| shade * weathered(point));
    }
    for side in [-1.0f32, 1.0] {
        let x = 0.42 * WIDTH * side;
        let beam = cuboid(
            Vec3::new(x - 0.05, HEIGHT - 0.16, -LENGTH),
            Vec3::new(x + 0.05, HEIGHT - 0.025, 0.3),
        );
        plant.part(&beam, &Placement::IDENTITY, TIMBER, |point| 0.8 * weathered(point));
        for post in 0..5 {
            let z = -LENGTH * (post as f32 + 0.5) / 5.0;
            let x = (0.5 * WIDTH + 0.05) * side + rng.between(-0.02, 0.02);
            let top = HEIGHT + if post % 2 == 0 { 0.38 } else { -0.03 } + rng.between(0.0, 0.06);
            let foot = Vec3::new(x, -2.2, z);
            let head = Vec3::new(x + rng.between(-0.03, 0.03), top, z);
            let joints = [(foot, 0.085), (head, 0.08), (head + 0.012 * Vec3::Y, 0.001)];
            let joints = joints.map(|(position, radius)| Joint { position, radius });
            plant.stem(&joints, 12, TIMBER, |point| {
                let wet = ((0.18 - point.y) * 4.0).clamp(0.0, 0.7);
                (1.0 - wet) * weathered(point)
            });
        }
    }
    plant
}

/// Grey wood with its grain.
fn weathered(point: Vec3) -> Rgb {
    let grain = fractal3(Vec3::new(2.0 * point.x, 9.0 * point.y, 26.0 * point.z), 3, 71);
    Rgb::new(0.235, 0.195, 0.155) * (1.0 + 0.55 * grain)
}
