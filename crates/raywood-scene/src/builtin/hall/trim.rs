//! What the masons carve: mouldings, ribs, brackets, tracery.

use raywood::Vec3;

use super::super::modelling::{
    Part, PathPoint, Placement, Profile, arch_path, bar, cuboid, revolve, sweep,
};
use super::plan::*;

/// A closed section for ribs that hang from a vault: `x` across, `y` down into the room, a roll between two flat
/// shoulders.
pub(super) fn roll_rib(half_width: f32, depth: f32, detail: usize) -> Profile {
    let (w, d) = (half_width, depth);
    Profile::start(-w, -0.05)
        .line_to(w, -0.05)
        .line_to(w, 0.45 * d)
        .line_to(0.62 * w, 0.45 * d)
        .arc([0.0, 0.45 * d], 0.55 * d / (0.62 * w), 180.0, 4 * detail)
        .line_to(-w, 0.45 * d)
        .line_to(-w, -0.05)
}

/// The knob where the ribs meet at the crown.
pub(super) fn boss(detail: usize) -> Part {
    let profile = Profile::start(0.0, -0.26)
        .curve_to([[0.10, -0.25], [0.10, -0.20]], 0.16, -0.19, 4 * detail)
        .arc([0.16, -0.13], 1.0, 180.0, 4 * detail)
        .line_to(0.16, 0.02);
    let crown = Vec3::new(0.0, NAVE_VAULT.spring + NAVE_VAULT.rise, 0.0);
    revolve(&profile, 24 * detail).placed(&Placement::at(crown))
}

/// A moulding around an opening: `inner` is how far it reaches into the opening, `outer` how far over the wall,
/// `height` how far out of it.
pub(super) fn moulding(inner: f32, outer: f32, height: f32, detail: usize) -> Profile {
    let middle = 0.5 * (outer - inner);
    Profile::start(outer, -0.02)
        .line_to(outer, 0.45 * height)
        .line_to(middle + 0.03, 0.45 * height)
        .arc([middle, 0.45 * height], 0.55 * height / 0.03, 180.0, 4 * detail)
        .line_to(middle - 0.05, 0.45 * height)
        .line_to(-inner, 0.30 * height)
        .line_to(-inner, -0.02)
}

/// Mouldings of a nave wall, towards the nave: along the arcade's arch and around the clerestory's window, and the
/// window's tracery.
pub(super) fn nave_wall_trim(segments: usize, detail: usize) -> Part {
    let front = Placement::at(Vec3::new(0.0, 0.0, ARCADE_HALF_THICKNESS));
    let mut part = Part::default();
    let arch = sweep(
        &moulding(0.03, 0.24, 0.10, detail),
        &arch_path(&ARCADE, ARCADE_SPRING, segments),
        false,
    );
    part.add_part(&arch.placed(&front));
    // The same on the side of the aisle, half a turn around.
    part.add_part(&arch.placed(&front).placed(&Placement::IDENTITY.turned(180.0)));
    let window = sweep(
        &moulding(0.03, 0.14, 0.08, detail),
        &arch_path(&CLERESTORY, CLERESTORY.spring, segments),
        false,
    );
    part.add_part(&window.placed(&front));

    // Tracery: two mullions and a circle between them.
    let (ring_y, ring_r) = (CLERESTORY.spring + 1.18, 0.56);
    part.add_part(
        &ring(ring_r, 0.05, segments, detail).placed(&Placement::at(Vec3::new(0.0, ring_y, 0.0))),
    );
    for x in [-ring_r, ring_r] {
        let top = CLERESTORY.spring + CLERESTORY.rise * 0.93;
        part.add_part(&bar(
            Vec3::new(x, CLERESTORY.spring - 0.05, 0.0),
            Vec3::new(x, top, 0.0),
            0.09,
        ));
    }
    part
}

/// Mouldings of a window of the outer walls, inside, and its sill.
pub(super) fn window_trim(segments: usize, detail: usize) -> Part {
    let inside = Placement::at(Vec3::new(0.0, 0.0, 0.5 * OUTER_THICKNESS));
    let path = arch_path(&WINDOW, WINDOW_SILL, segments);
    let mut part = sweep(&moulding(0.02, 0.20, 0.09, detail), &path, false).placed(&inside);
    let half = WINDOW.half_width + 0.26;
    part.add_part(&cuboid(
        Vec3::new(-half, WINDOW_SILL - 0.12, 0.4 * OUTER_THICKNESS),
        Vec3::new(half, WINDOW_SILL + 0.012, 0.5 * OUTER_THICKNESS + 0.14),
    ));
    part
}

/// An upright ring around the z axis.
pub(super) fn ring(radius: f32, thickness: f32, segments: usize, detail: usize) -> Part {
    let path: Vec<_> = (0..2 * segments)
        .map(|i| {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / segments as f32).sin_cos();
            PathPoint { position: Vec3::new(radius * cos, radius * sin, 0.0), up: Vec3::Z }
        })
        .collect();
    sweep(&Profile::circle(thickness, 6 * detail), &path, true)
}

/// A bracket on a wall of the nave, towards +x, that carries a transverse arch: a moulded half cone under a slab.
pub(super) fn bracket(detail: usize) -> Part {
    let profile = Profile::start(0.0, 5.98)
        .arc([0.0, 6.04], 1.0, 180.0, 4 * detail)
        .smooth()
        .line_to(0.03, 6.12)
        .curve_to([[0.06, 6.35], [0.24, 6.45]], 0.26, 6.70, 6 * detail)
        .line_to(0.30, 6.70)
        .arc([0.30, 6.745], 1.0, 180.0, 4 * detail)
        .line_to(0.27, 6.79)
        .line_to(0.27, 6.96);
    let mut part = revolve(&profile, 24 * detail);
    part.add_part(&cuboid(Vec3::new(-0.1, 6.95, -0.34), Vec3::new(0.36, VAULT_SPRING, 0.34)));
    part
}

/// A wheel of stone: a rim, a hub, spokes, and a circle between each two of them.
pub(super) fn rose_window(segments: usize, detail: usize) -> Part {
    let mut part = ring(ROSE.1, 0.09, segments, detail);
    part.add_part(&ring(0.30, 0.055, segments, detail));
    let petal = ring(0.275, 0.040, segments / 2, detail);
    for i in 0..10 {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / 10.0).sin_cos();
        let spoke = Vec3::new(cos, sin, 0.0);
        part.add_part(&bar(0.30 * spoke, ROSE.1 * spoke, 0.06));
        let (sin, cos) = (std::f32::consts::TAU * (i as f32 + 0.5) / 10.0).sin_cos();
        let middle = Vec3::new(0.94 * cos, 0.94 * sin, 0.0);
        part.add_part(&petal.placed(&Placement::at(middle)));
    }
    part
}
