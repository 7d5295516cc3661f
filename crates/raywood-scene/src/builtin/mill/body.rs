//! What of a mill stands still: a tower of plaster on a foot of stone, a gallery, a cap of shingles.

use std::f32::consts::TAU;

use raywood::Vec3;

use super::{PAINT, PANE, PLASTER, SHINGLES, STONE, WOOD};
use crate::MaterialId;
use crate::builtin::modelling::{Part, Placement, Profile, bar, cuboid, revolve};

/// How high the tower is, and its floor of the gallery.
const TOP: f32 = 8.9;
const FLOOR: f32 = 3.7;

/// How many sides things around the tower have.
const AROUND: usize = 64;

/// The tower's radius at a height.
fn radius(y: f32) -> f32 {
    3.05 - 1.05 * (y / TOP).clamp(0.0, 1.0)
}

/// All of it, its front towards z.
pub(super) fn body() -> Vec<(Part, MaterialId)> {
    let foot = Profile::start(0.0, -1.2).line_to(3.45, -1.2).line_to(3.35, 0.8);
    let foot = foot.line_to(radius(0.8) - 0.1, 0.95).line_to(0.0, 0.95);
    let tower = Profile::start(radius(0.8), 0.8).line_to(radius(TOP), TOP);
    let (mut paint, mut pane) = (Part::default(), Part::default());
    for (degrees, y) in [(0.0, 6.6), (-58.0, 2.4), (-70.0, 6.0), (62.0, 5.3), (120.0, 2.4)] {
        window(degrees, y, &mut paint, &mut pane);
    }
    door(-14.0, &mut paint);
    vec![
        (revolve(&foot, AROUND), STONE),
        (revolve(&tower, AROUND), PLASTER),
        (cap(), SHINGLES),
        (gallery(), WOOD),
        (paint, PAINT),
        (pane, PANE),
    ]
}

/// The cap, which overhangs the tower and ends in a knob.
fn cap() -> Part {
    let eaves = radius(TOP) + 0.35;
    let profile = Profile::start(0.0, TOP - 0.05)
        .line_to(eaves, TOP - 0.05)
        .line_to(eaves, TOP + 0.1)
        .curve_to([[eaves - 0.1, TOP + 1.5], [1.3, TOP + 2.6]], 0.22, TOP + 2.95, 24)
        .line_to(0.16, TOP + 3.15)
        .curve_to([[0.42, TOP + 3.3], [0.2, TOP + 3.6]], 0.0, TOP + 3.65, 12);
    revolve(&profile, AROUND)
}

/// The gallery around the tower, from which the sails are set: boards on struts, and a rail.
fn gallery() -> Part {
    let (inner, outer, posts) = (radius(FLOOR) - 0.1, radius(FLOOR) + 1.35, 28);
    let floor = Profile::start(inner, FLOOR - 0.12)
        .line_to(outer, FLOOR - 0.12)
        .line_to(outer, FLOOR)
        .line_to(inner, FLOOR);
    let mut part = revolve(&floor, AROUND);
    let around = |number: usize, radius: f32, y: f32| {
        let (sin, cos) = (TAU * number as f32 / posts as f32).sin_cos();
        Vec3::new(radius * sin, y, radius * cos)
    };
    for number in 0..posts {
        let at = |y: f32| around(number, outer - 0.08, y);
        let next = |y: f32| around(number + 1, outer - 0.08, y);
        part.add_part(&bar(at(FLOOR), at(FLOOR + 1.0), 0.09));
        part.add_part(&bar(at(FLOOR + 1.0), next(FLOOR + 1.0), 0.08));
        part.add_part(&bar(at(FLOOR + 0.5), next(FLOOR + 0.5), 0.05));
        if number % 2 == 0 {
            let foot = around(number, radius(2.2), 2.2);
            part.add_part(&bar(foot, around(number, outer - 0.15, FLOOR - 0.1), 0.12));
        }
    }
    part
}

/// What is set into the wall so many degrees from the front and so high, leaning as the wall does.
fn in_wall(degrees: f32, y: f32) -> Placement {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let radius = radius(y);
    let lean = (1.05 / TOP).atan().to_degrees();
    Placement::at(Vec3::new(radius * sin, y, radius * cos)).turned(degrees).tilted(-lean)
}

/// A window with a cross in a painted frame.
fn window(degrees: f32, y: f32, paint: &mut Part, pane: &mut Part) {
    let place = in_wall(degrees, y);
    let (wide, high) = (0.42, 0.62);
    let mut frame = Part::default();
    for [x, y, w, h] in [
        [-wide, 0.0, 0.07, high],
        [wide, 0.0, 0.07, high],
        [0.0, -high, wide, 0.07],
        [0.0, high, wide, 0.07],
        [0.0, 0.0, 0.03, high],
        [0.0, 0.15, wide, 0.03],
    ] {
        frame.add_part(&cuboid(Vec3::new(x - w, y - h, -0.2), Vec3::new(x + w, y + h, 0.1)));
    }
    paint.add_part(&frame.placed(&place));
    let glass = cuboid(Vec3::new(-wide, -high, -0.2), Vec3::new(wide, high, 0.05));
    pane.add_part(&glass.placed(&place));
}

/// A door of boards in the foot.
fn door(degrees: f32, paint: &mut Part) {
    let place = in_wall(degrees, 1.35);
    let mut door = Part::default();
    for board in 0..5 {
        let x = -0.65 + 0.26 * board as f32;
        door.add_part(&cuboid(Vec3::new(x + 0.01, -1.4, -0.4), Vec3::new(x + 0.25, 1.05, 0.42)));
    }
    door.add_part(&cuboid(Vec3::new(-0.85, 1.05, -0.4), Vec3::new(0.85, 1.25, 0.5)));
    paint.add_part(&door.placed(&place));
}
