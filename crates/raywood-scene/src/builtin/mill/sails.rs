//! Four sails: lattices of laths on a spar, cloth over them, in a plane across the shaft.

use raywood::{Transform, Vec3};

use super::{CANVAS, PAINT, WOOD};
use crate::MaterialId;
use crate::builtin::modelling::{Cells, Part, Profile, bar, cuboid, revolve};

/// How long a sail is, from where its cloth begins, and how wide that is.
const LENGTH: f32 = 7.4;
const INNER: f32 = 1.5;
const WIDTH: f32 = 1.55;

/// How far before the axis of the tower sails turn, and how high.
const FORWARD: f32 = 3.35;
const HEIGHT: f32 = 10.15;

/// From the sails, whose shaft points along z, to their place on the mill: the shaft rises a little to the front.
pub(super) fn on_mill() -> Transform {
    Transform::rotation(Vec3::X, -9.0).then(&Transform::translation([0.0, HEIGHT, FORWARD]))
}

/// Four sails and the hub between them.
pub(super) fn sails() -> Vec<(Part, MaterialId)> {
    let (mut wood, mut paint, mut cloth) = (Part::default(), Part::default(), Part::default());
    for quarter in 0..4 {
        let turn = Transform::rotation(Vec3::Z, 90.0 * quarter as f32);
        wood.add_part(&turned(&frame(), &turn));
        cloth.add_part(&turned(&canvas(), &turn));
    }
    paint.add_part(&cuboid(Vec3::new(-0.42, -0.42, -0.34), Vec3::new(0.42, 0.42, 0.30)));
    // A cap on the hub.
    let cap = Profile::start(0.34, 0.0).arc([0.0, 0.0], 0.8, 90.0, 8);
    let forwards =
        Transform::rotation(Vec3::X, 90.0).then(&Transform::translation([0.0, 0.0, 0.30]));
    paint.add_part(&turned(&revolve(&cap, 24), &forwards));
    // The shaft that they turn on.
    wood.add_part(&bar(Vec3::new(0.0, 0.0, -1.8), Vec3::new(0.0, 0.0, -0.2), 0.5));
    vec![(wood, WOOD), (paint, PAINT), (cloth, CANVAS)]
}

/// The part where a rotation and a move take it.
fn turned(part: &Part, to: &Transform) -> Part {
    Part {
        positions: part.positions.iter().map(|&p| to.point(p)).collect(),
        normals: part.normals.iter().map(|&n| to.vector(n).normalize_or_zero()).collect(),
        triangles: part.triangles.clone(),
    }
}

/// How far a sail's cloth and laths are twisted to the back, `along` its length and `across`, so that wind turns it.
fn depth(along: f32, across: f32) -> f32 {
    let twist = 0.34 - 0.22 * (along - INNER) / (LENGTH - INNER);
    -twist * across
}

/// A point of the lattice.
fn lattice(along: f32, across: f32) -> Vec3 {
    Vec3::new(across, along, depth(along, across))
}

/// The wood of a sail that stands upright.
fn frame() -> Part {
    // The spar tapers in three pieces.
    let mut part = Part::default();
    for (from, to, width) in [(-0.4, 3.0, 0.30), (3.0, 5.6, 0.24), (5.6, LENGTH + 0.15, 0.18)] {
        part.add_part(&bar(Vec3::new(0.0, from, 0.0), Vec3::new(0.0, to, 0.0), width));
    }
    // A board before the spar, laths along and across behind it.
    for across in [-0.30, 0.52, 1.04, WIDTH] {
        part.add_part(&bar(lattice(INNER, across), lattice(LENGTH, across), 0.055));
    }
    let steps = 15;
    for step in 0..=steps {
        let along = INNER + (LENGTH - INNER) * step as f32 / steps as f32;
        part.add_part(&bar(lattice(along, -0.30), lattice(along, WIDTH), 0.05));
    }
    part
}

/// The cloth of a sail that stands upright: bellied by the wind, and a little furled at its end.
fn canvas() -> Part {
    let mut part = Part::default();
    let (columns, rows) = (14, 40);
    let end = LENGTH - 0.9;
    part.add_grid(Cells::open(columns), Cells::open(rows), |i, j| {
        let (u, v) = (i as f32 / columns as f32, j as f32 / rows as f32);
        let along = INNER + 0.05 + (end - INNER) * v;
        let across = 0.10 + (WIDTH - 0.14) * u * (1.0 - 0.22 * v * v * u);
        let bellied = 0.10 + 0.16 * (std::f32::consts::PI * u).sin() * (0.5 + 0.5 * v);
        lattice(along, across) + Vec3::new(0.0, 0.0, 0.04 + 0.5 * bellied)
    });
    part
}
