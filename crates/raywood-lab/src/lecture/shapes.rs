//! Scenes for experiments, made by code so that they can have any number of triangles.

use std::f32::consts::TAU;

use raywood::{TriangleMesh, Vec3};
use raywood_scene::builtin::modelling::{MeshBuilder, Placement, Profile, revolve};
use raywood_scene::{Camera, Mesh, Scene, builtin};

use crate::rng::Rng;

/// The scenes that are measured when none is given; small ones if it must be quick.
pub fn default_scenes(quick: bool) -> Vec<Scene> {
    let names: &[&str] = if quick {
        &["terrain?n=48", "sphereflake?depth=3"]
    } else {
        &["hall", "terrain", "sphereflake"]
    };
    // A built-in scene that does not exist would be missed by the tests.
    let builtins = names.iter().filter_map(|name| builtin(name).ok());
    builtins.chain([soup(if quick { 4_000 } else { 200_000 })]).collect()
}

/// A landscape of few triangles, each of which covers thousands of pixels.
pub(super) fn coarse_terrain() -> Scene {
    // A built-in scene that does not exist would be missed by the tests.
    let scene = builtin("terrain?n=32").unwrap_or_default();
    Scene { name: "coarse terrain".to_owned(), ..scene }
}

/// So many random triangles in a cube. Their area in all is the same for any number, so that a ray flies equally far before it hits one.
pub(super) fn soup(count: usize) -> Scene {
    let mut rng = Rng::new(7);
    // A ray flies 1 on average where the areas together are twice the volume, for half of each is lost to its slant; the volume is 8.
    let area = 16.0 / count.max(1) as f32;
    let edge = (area * 4.0 / 3f32.sqrt()).sqrt();
    let mut positions = Vec::with_capacity(3 * count);
    for _ in 0..count {
        let mut coordinate = || 2.0 * rng.unit() - 1.0;
        let center = Vec3::new(coordinate(), coordinate(), coordinate());
        // An equilateral triangle around the centre, turned at random.
        let normal = rng.direction();
        let mut side = rng.direction().cross(normal).normalize_or_zero();
        if side == Vec3::ZERO {
            side = Vec3::new(normal.y, normal.z, normal.x).cross(normal).normalize_or_zero();
        }
        let other = normal.cross(side);
        let radius = edge / 3f32.sqrt();
        for corner in 0..3 {
            let (sin, cos) = (TAU * corner as f32 / 3.0).sin_cos();
            positions.push(center + radius * (cos * side + sin * other));
        }
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let camera = camera(Vec3::new(1.6, 1.3, 3.6), Vec3::ZERO);
    scene("soup", positions, triangles, camera)
}

/// A wavy sheet of about so many triangles: a surface, as scanned and modelled things are.
pub(super) fn sheet(count: usize) -> Scene {
    let cells = ((count as f32 / 2.0).sqrt().round() as u32).max(1);
    let height = |x: f32, z: f32| {
        let wave = |fx: f32, fz: f32, phase: f32| (fx * x + fz * z + phase).sin();
        0.14 * wave(3.1, 2.2, 0.3) + 0.07 * wave(-5.3, 7.1, 1.9) + 0.025 * wave(17.0, -13.0, 4.2)
    };
    let coordinate = |i: u32| 2.0 * i as f32 / cells as f32 - 1.0;
    let points = (0..=cells).flat_map(|row| (0..=cells).map(move |column| (column, row)));
    let positions = points.map(|(column, row)| {
        let (x, z) = (coordinate(column), coordinate(row));
        Vec3::new(x, height(x, z), z)
    });
    let quads = (0..cells).flat_map(|row| (0..cells).map(move |column| (column, row)));
    let triangles = quads.flat_map(|(column, row)| {
        let corner = row * (cells + 1) + column;
        let (right, below) = (corner + 1, corner + cells + 1);
        [[corner, below, right], [right, below, below + 1]]
    });
    let camera = camera(Vec3::new(0.9, 1.5, 2.1), Vec3::new(0.0, -0.05, 0.0));
    scene("sheet", positions.collect(), triangles.collect(), camera)
}

/// About so many triangles in a teapot as high as a hand, on the lawn of a stadium a hundred metres across.
pub(super) fn stadium(count: usize) -> Scene {
    teapot("teapot in a stadium", count, 1.0)
}

/// The same teapot, in a stadium as small as a room.
pub(super) fn room(count: usize) -> Scene {
    teapot("teapot in a room", count, 1.0 / 16.0)
}

fn teapot(name: &str, count: usize, scale: f32) -> Scene {
    let mut builder = MeshBuilder::default();
    // The lawn and the stands' steps: a few large triangles.
    let mut bowl = Profile::start(0.0, 0.0).line_to(35.0, 0.0);
    for step in 0..12 {
        let (x, y) = (35.0 + 1.25 * step as f32, 0.6 * (step + 1) as f32);
        bowl = bowl.line_to(x, y).line_to(x + 1.25, y);
    }
    builder.add(&revolve(&bowl, 24), &Placement::IDENTITY.scaled(scale), 0);

    // Its outline has about 60 pieces, each of two triangles per segment of the circumference.
    let segments = (count / 120).max(3);
    let pot = Profile::start(0.0, 0.0)
        .line_to(0.05, 0.0)
        .curve_to([[0.11, 0.03], [0.10, 0.12]], 0.05, 0.15, 40)
        .curve_to([[0.04, 0.16], [0.012, 0.165]], 0.012, 0.17, 12)
        .curve_to([[0.022, 0.18], [0.01, 0.19]], 0.0, 0.19, 8);
    builder.add(&revolve(&pot, segments), &Placement::IDENTITY, 0);

    let camera = camera(Vec3::new(0.18, 0.24, 0.34), Vec3::new(0.0, 0.085, 0.0));
    from_mesh(name, builder.finish(), camera)
}

fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera { name: String::new(), eye, target, up: Vec3::Y, fov_y: 40.0 }
}

fn scene(name: &str, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, camera: Camera) -> Scene {
    // The triangles above name only vertices that there are, and finite ones.
    let triangles = TriangleMesh::new(positions, triangles).unwrap_or_default();
    from_mesh(name, Mesh { triangles, ..Mesh::default() }, camera)
}

fn from_mesh(name: &str, mesh: Mesh, camera: Camera) -> Scene {
    let (name, cameras) = (name.to_owned(), vec![camera]);
    Scene { name, mesh, cameras, up: Some(Vec3::Y), ..Scene::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_about_as_many_triangles_as_asked_for() {
        for count in [5_000, 20_000] {
            for scene in [soup(count), sheet(count), stadium(count)] {
                let made = scene.mesh.triangles.triangles().len() as f64;
                let ratio = made / count as f64;
                assert!((0.9..1.7).contains(&ratio), "{}: {made} for {count}", scene.name);
            }
        }
        assert_eq!(default_scenes(true).len(), 3);
        assert_eq!(default_scenes(false).len(), 4);
    }

    #[test]
    fn a_soup_has_the_same_area_for_any_number() {
        let area = |count: usize| {
            let scene = soup(count);
            let mesh = &scene.mesh.triangles;
            let double = |t: u32| {
                let [a, b, c] = mesh.corners(t);
                (b - a).cross(c - a).length()
            };
            (0..count as u32).map(double).sum::<f32>() / 2.0
        };
        assert!((area(100) - 16.0).abs() < 0.01 && (area(5000) - 16.0).abs() < 0.01);
    }

    #[test]
    fn the_teapot_is_small_in_its_stadium() {
        for (scene, size) in [(stadium(5_000), 90.0), (room(5_000), 5.0)] {
            assert!(scene.bounds().extent().x > size, "{}", scene.name);
            let positions = scene.mesh.triangles.positions();
            let small = positions.iter().filter(|p| p.length() < 0.3).count();
            assert!(2 * small > positions.len(), "{}", scene.name);
        }
    }
}
