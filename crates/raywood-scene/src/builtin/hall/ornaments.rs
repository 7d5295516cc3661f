//! What stands in the hall: pedestals, spheres, a glass knot, vases, lamps, and the golden rings before the door.

use std::f32::consts::{PI, TAU};

use raywood::Vec3;

use super::super::modelling::{
    MeshBuilder, Part, PathPoint, Placement, Profile, bar, cuboid, revolve, revolve_with, sweep,
};
use super::materials as m;
use super::plan::{BAY, FIRST_Z, LAST_Z, NAVE_VAULT};
use crate::MaterialId;

/// A sphere: centre, radius and material.
pub(super) type Ball = (Vec3, f32, MaterialId);

/// Adds all ornaments made of triangles, and returns those that are analytic spheres.
pub(super) fn add_ornaments(mesh: &mut MeshBuilder, detail: usize) -> Vec<Ball> {
    let mut balls = Vec::new();

    // Near the eye: glass on the right, the knot on the left, each on a pedestal; a few balls lie on the floor.
    let pedestal = pedestal(detail);
    let on_pedestal = |x: f32, z: f32| Vec3::new(x, PEDESTAL_TOP, z);
    let mut stand = |x: f32, z: f32| {
        mesh.add(&pedestal, &Placement::at(Vec3::new(x, 0.0, z)), m::DARK_MARBLE);
        on_pedestal(x, z)
    };
    let right = stand(1.62, -0.6);
    let left = stand(-1.70, -0.9);
    let far_right = stand(1.62, -9.4);
    let far_left = stand(-1.62, -11.4);
    let cup = cup(detail);
    for top in [right, far_right, far_left] {
        mesh.add(&cup, &Placement::at(top), m::GOLD);
    }
    balls.push((right + Vec3::new(0.0, 0.50, 0.0), 0.46, m::GLASS));
    balls.push((far_right + Vec3::new(0.0, 0.50, 0.0), 0.46, m::MIRROR));
    balls.push((far_left + Vec3::new(0.0, 0.50, 0.0), 0.46, m::GOLD));
    let knot =
        glass_knot(detail).placed(&Placement::at(left + Vec3::new(0.0, 0.52, 0.0)).turned(20.0));
    mesh.add(&knot, &Placement::IDENTITY, m::SEA_GLASS);

    balls.push((Vec3::new(-1.22, 0.36, 2.3), 0.36, m::MIRROR));
    balls.push((Vec3::new(0.38, 0.20, 1.55), 0.20, m::RUBY_GLASS));
    balls.push((Vec3::new(0.78, 0.13, 1.15), 0.13, m::GOLD));

    // Vases along the arcades.
    let vase = vase(detail);
    let near = [(-2.75, 0.0), (2.75, 4.4)];
    let far = [(2.75, -11.0), (-2.75, -11.0), (2.75, -19.8), (-2.75, -19.8)];
    for (x, z) in near.into_iter().chain(far) {
        mesh.add(&vase, &Placement::at(Vec3::new(x, 0.0, z)), m::PORCELAIN);
    }

    // Lamps down the middle, under the bosses of every second bay.
    for bay in [2, 4, 6] {
        let z = FIRST_Z - BAY * (bay as f32 + 0.5);
        add_lamp(mesh, &mut balls, z, detail);
    }
    add_golden_rings(mesh, &mut balls, detail);
    balls
}

/// The height of a pedestal.
const PEDESTAL_TOP: f32 = 1.02;

/// A small fluted column to put things on.
fn pedestal(detail: usize) -> Part {
    let mut part = cuboid(Vec3::new(-0.30, 0.0, -0.30), Vec3::new(0.30, 0.09, 0.30));
    let foot = Profile::start(0.27, 0.09)
        .arc([0.27, 0.115], 1.0, 180.0, 3 * detail)
        .line_to(0.25, 0.14)
        .curve_to([[0.21, 0.15], [0.205, 0.18]], 0.20, 0.20, 4 * detail);
    part.add_part(&revolve(&foot, 32 * detail));
    let shaft =
        Profile::start(0.20, 0.20).curve_to([[0.20, 0.4], [0.19, 0.6]], 0.18, 0.86, 8 * detail);
    part.add_part(&revolve_with(&shaft, 64 * detail, |radius, y, angle| {
        let ends = ((y - 0.22) / 0.04).clamp(0.0, 1.0) * ((0.84 - y) / 0.04).clamp(0.0, 1.0);
        radius * (1.0 - 0.08 * ends * (8.0 * angle).sin().abs())
    }));
    let head = Profile::start(0.18, 0.86)
        .curve_to([[0.185, 0.90], [0.22, 0.91]], 0.25, 0.93, 4 * detail)
        .line_to(0.25, 0.94);
    part.add_part(&revolve(&head, 32 * detail));
    let slab = Profile::start(0.0, 0.94)
        .line_to(0.29, 0.94)
        .arc([0.29, 0.98], 1.0, 180.0, 4 * detail)
        .line_to(0.0, PEDESTAL_TOP);
    part.add_part(&revolve(&slab, 48 * detail));
    part
}

/// A golden ring with a foot that holds a sphere of 0.46 m.
fn cup(detail: usize) -> Part {
    let profile = Profile::start(0.0, 0.0)
        .line_to(0.17, 0.0)
        .curve_to([[0.10, 0.03], [0.13, 0.06]], 0.20, 0.10, 5 * detail)
        .arc([0.20, 0.118], 1.0, 180.0, 4 * detail)
        .line_to(0.0, 0.02);
    revolve(&profile, 48 * detail)
}

/// A torus knot of solid glass that winds twice around its axis and three times through its hole.
pub(super) fn glass_knot(detail: usize) -> Part {
    let steps = 180 * detail;
    let path: Vec<_> = (0..steps)
        .map(|i| {
            let t = TAU * i as f32 / steps as f32;
            let (around, through) = (2.0 * t, 3.0 * t);
            let ring = Vec3::new(around.cos(), around.sin(), 0.0);
            let out = through.cos() * ring + Vec3::new(0.0, 0.0, through.sin());
            // Held by the direction out of the torus, which is never along the path and closes with it.
            PathPoint { position: 0.31 * ring + 0.135 * out, up: out }
        })
        .collect();
    sweep(&Profile::circle(0.072, 12 * detail), &path, true)
}

/// A vase of revolution, 1.25 m tall, closed.
pub(super) fn vase(detail: usize) -> Part {
    let profile = Profile::start(0.0, 0.0)
        .line_to(0.19, 0.0)
        .arc([0.19, 0.03], 1.0, 180.0, 3 * detail)
        .curve_to([[0.12, 0.10], [0.12, 0.14]], 0.15, 0.19, 5 * detail)
        .curve_to([[0.40, 0.42], [0.44, 0.82]], 0.17, 1.00, 10 * detail)
        .smooth()
        .curve_to([[0.12, 1.04], [0.12, 1.12]], 0.22, 1.22, 6 * detail)
        .smooth()
        .arc([0.212, 1.232], 1.0, 150.0, 3 * detail)
        .smooth()
        .curve_to([[0.10, 1.12], [0.10, 1.04]], 0.14, 0.98, 6 * detail)
        .curve_to([[0.30, 0.80], [0.20, 0.30]], 0.0, 0.25, 8 * detail);
    revolve(&profile, 36 * detail)
}

/// A lamp at a place along the nave: a golden hoop with glowing globes, hung from the crown of the vault.
fn add_lamp(mesh: &mut MeshBuilder, balls: &mut Vec<Ball>, z: f32, detail: usize) {
    let (height, radius) = (5.55, 0.78);
    let hoop = Profile::outline(8 * detail, |a| [radius + 0.032 * a.cos(), 0.055 * a.sin()]);
    let at = Placement::at(Vec3::new(0.0, height, z));
    mesh.add(&revolve(&hoop, 64 * detail), &at, m::GOLD);
    let stem = Profile::start(0.0, -0.26)
        .arc([0.0, -0.18], 1.0, 180.0, 5 * detail)
        .line_to(0.025, -0.09)
        .line_to(0.025, 0.75)
        .arc([0.0, 0.80], 1.0, 120.0, 5 * detail);
    mesh.add(&revolve(&stem, 24 * detail), &at, m::GOLD);
    let chain = bar(
        Vec3::new(0.0, 0.80, 0.0),
        Vec3::new(0.0, NAVE_VAULT.spring + NAVE_VAULT.rise - height - 0.1, 0.0),
        0.022,
    );
    mesh.add(&chain, &at, m::IRON);
    for i in 0..8 {
        let angle = TAU * (i as f32 + 0.5) / 8.0;
        let out = Vec3::new(angle.cos(), 0.0, angle.sin());
        if i % 2 == 0 {
            mesh.add(&bar(Vec3::new(0.0, 0.7, 0.0), radius * out, 0.014), &at, m::IRON);
            mesh.add(&bar(Vec3::ZERO, radius * out, 0.022), &at, m::GOLD);
        }
        let candle = Profile::start(0.0, 0.03)
            .curve_to([[0.05, 0.03], [0.03, 0.09]], 0.06, 0.11, 3 * detail)
            .line_to(0.0, 0.11);
        let place = Placement::at(Vec3::new(radius * out.x, height, z + radius * out.z));
        mesh.add(&revolve(&candle, 12 * detail), &place, m::GOLD);
        balls.push((place.point(Vec3::new(0.0, 0.185, 0.0)), 0.082, m::LAMP));
    }
}

/// The end of the perspective: three steps before the door, and on them golden rings around a sphere of glass.
fn add_golden_rings(mesh: &mut MeshBuilder, balls: &mut Vec<Ball>, detail: usize) {
    let z = LAST_Z + 5.2;
    for (step, radius) in [1.75f32, 1.40, 1.05].into_iter().enumerate() {
        let (low, high) = (0.16 * step as f32, 0.16 * (step + 1) as f32);
        let profile = Profile::start(radius, low)
            .line_to(radius, high - 0.03)
            .arc([radius - 0.03, high - 0.03], 1.0, 90.0, 3 * detail)
            .line_to(0.0, high);
        let material = if step % 2 == 0 { m::DARK_MARBLE } else { m::STONE };
        mesh.add(&revolve(&profile, 64 * detail), &Placement::at(Vec3::new(0.0, 0.0, z)), material);
    }
    let foot = Profile::start(0.42, 0.48)
        .curve_to([[0.40, 0.60], [0.10, 0.62]], 0.09, 0.80, 10 * detail)
        .line_to(0.09, 0.98)
        .arc([0.0, 1.02], 1.0, 130.0, 4 * detail);
    mesh.add(&revolve(&foot, 48 * detail), &Placement::at(Vec3::new(0.0, 0.0, z)), m::GOLD);

    let middle = Vec3::new(0.0, 2.28, z);
    for (radius, turn, tilt) in
        [(1.20f32, 0.0f32, 90.0f32), (1.08, 35.0, 68.0), (0.96, -50.0, 20.0)]
    {
        let band = Profile::outline(10 * detail, |a| [radius + 0.040 * a.cos(), 0.075 * a.sin()]);
        let place = Placement::at(middle).turned(turn).tilted(tilt);
        mesh.add(&revolve(&band, 96 * detail), &place, m::GOLD);
    }
    balls.push((middle, 0.58, m::GLASS));
    // Beads where the outermost ring is held.
    for angle in [0.0, 0.5 * PI, PI, 1.5 * PI] {
        let bead = middle + Vec3::new(1.20 * angle.cos(), 1.20 * angle.sin(), 0.0);
        balls.push((bead, 0.10, m::GOLD));
    }
}
