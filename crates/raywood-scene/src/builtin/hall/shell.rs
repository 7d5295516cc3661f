//! The building: floors, arcades, walls with their windows, vaults and ribs.

use raywood::Vec3;

use super::super::modelling::{
    Arch, ArchedWall, MeshBuilder, Part, PathPoint, Placement, Profile, arch_path, bar, cuboid,
    groin_vault, sweep,
};
use super::materials as m;
use super::plan::*;
use super::stars::stars;

/// Adds everything that is built of stone but the pillars.
pub(super) fn add_shell(mesh: &mut MeshBuilder, detail: usize) {
    add_floors(mesh);
    add_bays(mesh, detail);
    add_ribs_between_bays(mesh, detail);
    add_cornices(mesh);
    add_end_walls(mesh, detail);
    add_surroundings(mesh);
}

/// A level rectangle that faces up.
fn level(x: [f32; 2], z: [f32; 2], y: f32) -> Part {
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

/// A closed section for ribs that hang from a vault: `x` across, `y` down into the room, a roll between two flat shoulders.
fn roll_rib(half_width: f32, depth: f32, detail: usize) -> Profile {
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
fn boss(detail: usize) -> Part {
    let profile = Profile::start(0.0, -0.26)
        .curve_to([[0.10, -0.25], [0.10, -0.20]], 0.16, -0.19, 4 * detail)
        .arc([0.16, -0.13], 1.0, 180.0, 4 * detail)
        .line_to(0.16, 0.02);
    let crown = Vec3::new(0.0, NAVE_VAULT.spring + NAVE_VAULT.rise, 0.0);
    super::super::modelling::revolve(&profile, 24 * detail).placed(&Placement::at(crown))
}

/// A moulding around an opening: `inner` is how far it reaches into the opening, `outer` how far over the wall, `height` how far out of it.
fn moulding(inner: f32, outer: f32, height: f32, detail: usize) -> Profile {
    let middle = 0.5 * (outer - inner);
    Profile::start(outer, -0.02)
        .line_to(outer, 0.45 * height)
        .line_to(middle + 0.03, 0.45 * height)
        .arc([middle, 0.45 * height], 0.55 * height / 0.03, 180.0, 4 * detail)
        .line_to(middle - 0.05, 0.45 * height)
        .line_to(-inner, 0.30 * height)
        .line_to(-inner, -0.02)
}

/// Mouldings of a nave wall, towards the nave: along the arcade's arch and around the clerestory's window, and the window's tracery.
fn nave_wall_trim(segments: usize, detail: usize) -> Part {
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
fn window_trim(segments: usize, detail: usize) -> Part {
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
fn ring(radius: f32, thickness: f32, segments: usize, detail: usize) -> Part {
    let path: Vec<_> = (0..2 * segments)
        .map(|i| {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / segments as f32).sin_cos();
            PathPoint { position: Vec3::new(radius * cos, radius * sin, 0.0), up: Vec3::Z }
        })
        .collect();
    sweep(&Profile::circle(thickness, 6 * detail), &path, true)
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
    let across = |v: &super::super::modelling::GroinVault| Arch {
        half_width: v.half_x,
        spring: v.spring,
        rise: v.rise,
    };
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

/// A bracket on a wall of the nave, towards +x, that carries a transverse arch: a moulded half cone under a slab.
fn bracket(detail: usize) -> Part {
    let profile = Profile::start(0.0, 5.98)
        .arc([0.0, 6.04], 1.0, 180.0, 4 * detail)
        .smooth()
        .line_to(0.03, 6.12)
        .curve_to([[0.06, 6.35], [0.24, 6.45]], 0.26, 6.70, 6 * detail)
        .line_to(0.30, 6.70)
        .arc([0.30, 6.745], 1.0, 180.0, 4 * detail)
        .line_to(0.27, 6.79)
        .line_to(0.27, 6.96);
    let mut part = super::super::modelling::revolve(&profile, 24 * detail);
    part.add_part(&cuboid(Vec3::new(-0.1, 6.95, -0.34), Vec3::new(0.36, VAULT_SPRING, 0.34)));
    part
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

/// The walls at both ends of nave and aisles: a door each, a round window over the middle ones.
fn add_end_walls(mesh: &mut MeshBuilder, detail: usize) {
    let segments = 24 * detail;
    let width = 2.0 * (PILLAR_X - ARCADE_HALF_THICKNESS);
    let thickness = 0.7;
    let below =
        ArchedWall { arch: DOOR, sill: 0.0, width, bottom: 0.0, top: ROSE.0 - 1.6, thickness };
    let half_rose = ArchedWall {
        arch: Arch::round(ROSE.1, 0.0),
        sill: 0.0,
        width,
        bottom: 0.0,
        top: 1.6,
        thickness,
    };
    // The lower half of the round window is the upper one upside down; the wall goes on above.
    let half = half_rose.build(segments);
    let flip = |v: &Vec3| Vec3::new(-v.x, -v.y, v.z);
    let flipped = Part {
        positions: half.positions.iter().map(flip).collect(),
        normals: half.normals.iter().map(flip).collect(),
        triangles: half.triangles.clone(),
    };
    let rose_at = Placement::at(Vec3::new(0.0, ROSE.0, 0.0));
    let mut wall = below.build(segments);
    wall.add_part(&half.placed(&rose_at));
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

/// A wheel of stone: a rim, a hub, spokes, and a circle between each two of them.
fn rose_window(segments: usize, detail: usize) -> Part {
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

/// The terrace around the hall, and the sea that it overlooks.
fn add_surroundings(mesh: &mut MeshBuilder) {
    let (x, z) = (13.0, [LAST_Z - 8.0, FIRST_Z + 8.0]);
    let terrace = cuboid(Vec3::new(-x, -3.0, z[0]), Vec3::new(x, -0.02, z[1]));
    mesh.add(&terrace, &Placement::IDENTITY, m::TERRACE);
    let far = 4000.0;
    mesh.add(&level([-far, far], [-far, far], -2.5), &Placement::IDENTITY, m::SEA);
}
