//! The building: floors, arcades, outer walls with their windows, vaults and ribs.

use raywood::Vec3;

use super::super::modelling::{
    Arch, ArchedWall, GroinVault, MeshBuilder, Part, PathPoint, Placement, Profile, arch_path,
    cuboid, groin_vault, sweep,
};
use super::ends;
use super::materials as m;
use super::plan::*;
use super::stars::stars;
use super::trim::{boss, bracket, nave_wall_trim, roll_rib, window_trim};

/// Adds everything that is built of stone but the pillars.
pub(super) fn add_shell(mesh: &mut MeshBuilder, detail: usize) {
    add_floors(mesh);
    add_bays(mesh, detail);
    add_ribs_between_bays(mesh, detail);
    add_cornices(mesh);
    ends::add_end_walls(mesh, detail);
    ends::add_buttresses(mesh);
    ends::add_roofs(mesh);
    ends::add_surroundings(mesh);
}

/// A level rectangle that faces up.
pub(super) fn level(x: [f32; 2], z: [f32; 2], y: f32) -> Part {
    let mut part = Part::default();
    part.add_polygon(&[
        Vec3::new(x[0], y, z[1]),
        Vec3::new(x[1], y, z[1]),
        Vec3::new(x[1], y, z[0]),
        Vec3::new(x[0], y, z[0]),
    ]);
    part
}

/// A carpet of large diagonal tiles down the nave, between two red bands; plain tiles under pillars and aisles.
fn add_floors(mesh: &mut MeshBuilder) {
    let z = [LAST_Z - 0.5, FIRST_Z + 0.5];
    let (carpet, band, wall) = (2.10, 2.42, OUTER_X + OUTER_THICKNESS);
    let mut lay = |x, material| mesh.add(&level(x, z, 0.0), &Placement::IDENTITY, material);
    lay([-carpet, carpet], m::NAVE_FLOOR);
    for [near, far] in [[carpet, band], [-band, -carpet]] {
        lay([near, far], m::BORDER);
    }
    for [near, far] in [[band, wall], [-wall, -band]] {
        lay([near, far], m::AISLE_FLOOR);
    }
}

/// Adds what repeats from bay to bay: arcades, clerestory, outer walls, vaults with their diagonal ribs.
fn add_bays(mesh: &mut MeshBuilder, detail: usize) {
    let segments = 16 * detail;
    let arcade = ArchedWall {
        arch: ARCADE,
        sill: ARCADE_SPRING,
        width: BAY,
        bottom: ARCADE_SPRING,
        top: CORNICE,
        thickness: 2.0 * ARCADE_HALF_THICKNESS,
    };
    let clerestory = ArchedWall {
        arch: CLERESTORY,
        sill: CLERESTORY.spring,
        bottom: CORNICE,
        top: WALL_TOP,
        ..arcade
    };
    let outer = ArchedWall {
        arch: WINDOW,
        sill: WINDOW_SILL,
        width: BAY,
        bottom: 0.0,
        top: AISLE_TOP,
        thickness: OUTER_THICKNESS,
    };
    let mut nave_wall = arcade.faces(segments);
    nave_wall.add_part(&clerestory.faces(segments));
    let outer_wall = outer.faces(segments);
    // Courses of blocks would run askew over the inside of an arch: it is of plain stone, like the mouldings.
    let mut nave_trim = nave_wall_trim(segments, detail);
    nave_trim.add_part(&arcade.reveal(segments));
    nave_trim.add_part(&clerestory.reveal(segments));
    let mut window_trim = window_trim(segments, detail);
    window_trim.add_part(&outer.reveal(segments));
    let nave_vault = groin_vault(&NAVE_VAULT, 2 * segments);
    let aisle_vault = groin_vault(&AISLE_VAULT, segments);
    let nave_stars = stars(&NAVE_VAULT, 0.52);
    let aisle_stars = stars(&AISLE_VAULT, 0.52);
    let rib = roll_rib(0.10, 0.13, detail);
    let thin_rib = roll_rib(0.07, 0.08, detail);

    for z in bay_middles() {
        // Walls are drawn along x; a quarter turn puts their front towards the nave.
        for side in [-1.0f32, 1.0] {
            let towards_nave = -90.0 * side;
            let at = |x: f32| Placement::at(Vec3::new(side * x, 0.0, z)).turned(towards_nave);
            mesh.add(&nave_wall, &at(PILLAR_X), m::WALL);
            mesh.add(&nave_trim, &at(PILLAR_X), m::STONE);
            mesh.add(&outer_wall, &at(OUTER_X + 0.5 * OUTER_THICKNESS), m::WALL);
            mesh.add(&window_trim, &at(OUTER_X + 0.5 * OUTER_THICKNESS), m::STONE);

            let aisle = Placement::at(Vec3::new(side * AISLE_X, 0.0, z));
            mesh.add(&aisle_vault, &aisle, m::VAULT);
            mesh.add(&aisle_stars, &aisle, m::GOLD_LEAF);
            for sign in [1.0, -1.0] {
                let groin = AISLE_VAULT.groin_path(sign, segments);
                mesh.add(&sweep(&thin_rib, &groin, false), &aisle, m::STONE);
            }
        }
        let nave = Placement::at(Vec3::new(0.0, 0.0, z));
        mesh.add(&nave_vault, &nave, m::VAULT);
        mesh.add(&nave_stars, &nave, m::GOLD_LEAF);
        for sign in [1.0, -1.0] {
            let groin = NAVE_VAULT.groin_path(sign, 2 * segments);
            mesh.add(&sweep(&rib, &groin, false), &nave, m::STONE);
        }
        mesh.add(&boss(detail), &nave, m::GOLD);
    }
}

/// Arches across nave and aisles from pillar to pillar, and the brackets that carry those of the nave.
fn add_ribs_between_bays(mesh: &mut MeshBuilder, detail: usize) {
    let segments = 16 * detail;
    // Held like a moulding: x away from the opening, y along the nave.
    let section = |half: f32, depth: f32| {
        Profile::start(0.06, -half)
            .line_to(0.06, half)
            .line_to(-0.5 * depth, half)
            .line_to(-0.5 * depth, 0.7 * half)
            .arc([-0.5 * depth, 0.0], 0.7 * half / (0.5 * depth), 180.0, 6 * detail)
            .line_to(-0.5 * depth, -half)
            .line_to(0.06, -half)
    };
    let across = |v: &GroinVault| Arch { half_width: v.half_x, spring: v.spring, rise: v.rise };
    let nave_arch = across(&NAVE_VAULT);
    let nave =
        sweep(&section(0.22, 0.26), &arch_path(&nave_arch, VAULT_SPRING, 2 * segments), false);
    let aisle_arch = across(&AISLE_VAULT);
    let aisle =
        sweep(&section(0.20, 0.16), &arch_path(&aisle_arch, ARCADE_SPRING, segments), false);
    let bracket = bracket(detail);
    let pier = cuboid(Vec3::new(-0.22, 0.0, -0.30), Vec3::new(0.22, ARCADE_SPRING - 0.22, 0.30));
    let pier_slab = cuboid(Vec3::new(-0.27, 0.0, -0.36), Vec3::new(0.27, 0.22, 0.36));

    for z in pillar_rows() {
        mesh.add(&nave, &Placement::at(Vec3::new(0.0, 0.0, z)), m::STONE);
        for side in [-1.0f32, 1.0] {
            let x = side * (PILLAR_X - ARCADE_HALF_THICKNESS);
            let turned = if side > 0.0 { 180.0 } else { 0.0 };
            mesh.add(&bracket, &Placement::at(Vec3::new(x, 0.0, z)).turned(turned), m::STONE);
            mesh.add(&aisle, &Placement::at(Vec3::new(side * AISLE_X, 0.0, z)), m::STONE);
            let wall = Vec3::new(side * OUTER_X, 0.0, z);
            mesh.add(&pier, &Placement::at(wall), m::STONE);
            mesh.add(&pier_slab, &Placement::at(wall), m::STONE);
            let top = wall + Vec3::new(0.0, ARCADE_SPRING - 0.22, 0.0);
            mesh.add(&pier_slab, &Placement::at(top), m::STONE);
        }
    }
}

/// Long mouldings along the nave: the cornice under the clerestory.
fn add_cornices(mesh: &mut MeshBuilder) {
    // Held with y up: x towards the nave when the path leads along -z on the left and along +z on the right.
    let section = Profile::start(-0.05, CORNICE - 0.16)
        .line_to(0.05, CORNICE - 0.16)
        .curve_to([[0.06, CORNICE - 0.09], [0.15, CORNICE - 0.08]], 0.16, CORNICE - 0.02, 10)
        .line_to(0.20, CORNICE - 0.02)
        .line_to(0.20, CORNICE + 0.06)
        .line_to(-0.05, CORNICE + 0.06);
    for side in [-1.0f32, 1.0] {
        for x in [PILLAR_X - ARCADE_HALF_THICKNESS, PILLAR_X + ARCADE_HALF_THICKNESS] {
            let towards_nave = x < PILLAR_X;
            // The path's right-hand side is where the moulding stands out.
            let away = (side < 0.0) == towards_nave;
            // Cut at the pillars: slivers as long as the nave would cost precision.
            let mut path: Vec<_> = pillar_rows()
                .map(|z| PathPoint { position: Vec3::new(side * x, 0.0, z), up: Vec3::Y })
                .collect();
            if !away {
                path.reverse();
            }
            mesh.add(&sweep(&section, &path, false), &Placement::IDENTITY, m::STONE);
        }
    }
}
