//! What closes the hall: end walls with doors and round windows, roofs, and the terrace and the sea around.

use raywood::Vec3;

use super::super::modelling::{
    Arch, ArchedWall, MeshBuilder, Part, Placement, arch_path, cuboid, sweep,
};
use super::materials as m;
use super::plan::*;
use super::shell::level;
use super::trim::{moulding, rose_window};

/// The walls at both ends of nave and aisles: a door each, a round window over the middle ones.
pub(super) fn add_end_walls(mesh: &mut MeshBuilder, detail: usize) {
    let segments = 24 * detail;
    let width = 2.0 * (PILLAR_X - ARCADE_HALF_THICKNESS);
    let thickness = 0.7;
    let below =
        ArchedWall { arch: DOOR, sill: 0.0, width, bottom: 0.0, top: ROSE.0 - 1.6, thickness };
    let upper_rose = ArchedWall {
        arch: Arch::round(ROSE.1, 0.0),
        sill: 0.0,
        width,
        bottom: 0.0,
        top: WALL_TOP - ROSE.0,
        thickness,
    };
    // The lower half of the round window is like the upper one, upside down.
    let half = ArchedWall { top: 1.6, ..upper_rose }.build(segments);
    let flip = |v: &Vec3| Vec3::new(-v.x, -v.y, v.z);
    let flipped = Part {
        positions: half.positions.iter().map(flip).collect(),
        normals: half.normals.iter().map(flip).collect(),
        triangles: half.triangles.clone(),
    };
    let rose_at = Placement::at(Vec3::new(0.0, ROSE.0, 0.0));
    let mut wall = below.build(segments);
    wall.add_part(&upper_rose.build(segments).placed(&rose_at));
    wall.add_part(&flipped.placed(&rose_at));
    let aisle_wall = ArchedWall {
        arch: Arch::round(0.95, 2.6),
        sill: 0.0,
        width: OUTER_X - PILLAR_X + ARCADE_HALF_THICKNESS,
        bottom: 0.0,
        top: WALL_TOP,
        thickness,
    };
    let aisle_center = 0.5 * (OUTER_X + PILLAR_X - ARCADE_HALF_THICKNESS);
    let aisle_wall = aisle_wall.build(segments);

    let front = Placement::at(Vec3::new(0.0, 0.0, 0.5 * thickness));
    let door_path = arch_path(&DOOR, 0.0, segments);
    let mut trim = sweep(&moulding(0.03, 0.34, 0.14, detail), &door_path, false).placed(&front);
    trim.add_part(&rose_window(segments, detail).placed(&rose_at));
    for (z, turn) in [(LAST_Z, 0.0), (FIRST_Z, 180.0)] {
        let at = |x: f32| Placement::at(Vec3::new(x, 0.0, z)).turned(turn);
        mesh.add(&wall, &at(0.0), m::WALL);
        mesh.add(&trim, &at(0.0), m::STONE);
        for side in [-1.0, 1.0] {
            mesh.add(&aisle_wall, &at(side * aisle_center), m::WALL);
        }
    }
}

/// The buttresses at the four corners, where outer walls and end walls meet.
pub(super) fn add_buttresses(mesh: &mut MeshBuilder) {
    let (inner, outer, reach) = (OUTER_X - 0.05, OUTER_X + OUTER_THICKNESS + 0.05, 0.42);
    for z in [FIRST_Z, LAST_Z] {
        for [left, right] in [[-outer, -inner], [inner, outer]] {
            let low = Vec3::new(left, 0.0, z - reach);
            let high = Vec3::new(right, AISLE_TOP + 0.3, z + reach);
            mesh.add(&cuboid(low, high), &Placement::IDENTITY, m::STONE);
        }
    }
}

/// The roofs over nave and aisles, and the gables.
pub(super) fn add_roofs(mesh: &mut MeshBuilder) {
    let end = 0.3;
    let (near, far) = (FIRST_Z + end, LAST_Z - end);
    let nave_eaves = PILLAR_X + ARCADE_HALF_THICKNESS + 0.15;
    let ridge = WALL_TOP + 1.7;
    let mut roofs = Part::default();
    let mut gables = Part::default();
    for side in [-1.0f32, 1.0] {
        // From the lower edge to the upper one; the lean-to of an aisle ends below the clerestory's windows.
        let nave = [[nave_eaves, WALL_TOP], [0.0, ridge]];
        let aisle = [[OUTER_X + OUTER_THICKNESS + 0.1, AISLE_TOP], [PILLAR_X, AISLE_TOP + 0.6]];
        for [[low_x, low_y], [high_x, high_y]] in [nave, aisle] {
            let mut corners = [
                Vec3::new(side * low_x, low_y, near),
                Vec3::new(side * low_x, low_y, far),
                Vec3::new(side * high_x, high_y, far),
                Vec3::new(side * high_x, high_y, near),
            ];
            if side < 0.0 {
                corners.reverse();
            }
            roofs.add_polygon(&corners);
        }
        for z in [FIRST_Z, LAST_Z] {
            let corner = |x: f32, y: f32, z: f32| Vec3::new(side * x, y, z);
            let outwards = if z == FIRST_Z { 0.35 } else { -0.35 };
            let mut gable = [
                corner(0.0, WALL_TOP, z + outwards),
                corner(nave_eaves, WALL_TOP, z + outwards),
                corner(0.0, ridge, z + outwards),
            ];
            if (side < 0.0) != (z == LAST_Z) {
                gable.reverse();
            }
            gables.add_polygon(&gable);
        }
    }
    mesh.add(&roofs, &Placement::IDENTITY, m::ROOF);
    mesh.add(&gables, &Placement::IDENTITY, m::WALL);
}

/// The terrace around the hall, and the sea that it overlooks.
pub(super) fn add_surroundings(mesh: &mut MeshBuilder) {
    let (x, z) = (13.0, [LAST_Z - 8.0, FIRST_Z + 8.0]);
    let terrace = cuboid(Vec3::new(-x, -3.0, z[0]), Vec3::new(x, -0.02, z[1]));
    mesh.add(&terrace, &Placement::IDENTITY, m::TERRACE);
    let far = 4000.0;
    mesh.add(&level([-far, far], [-far, far], -2.5), &Placement::IDENTITY, m::SEA);
}
