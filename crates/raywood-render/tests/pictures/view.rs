//! Default cameras and lights: a thing is seen from outside, a room from within, a stage through its opening.

use crate::common::{camera, level, light, matte, scene};
use raywood::{Aabb, TriangleMesh, Vec3};
use raywood_render::{
    CameraRays, PreparedScene, Progress, RenderOptions, Setting, choose_camera, default_view,
    render,
};
use raywood_scene::{LightKind, Scene};

type Quad = ([[f32; 3]; 4], u32);

/// The walls of a box from -w to w, h high on either side; their fronts face inwards.
fn room(w: [f32; 3]) -> Vec<Quad> {
    let [x, y, z] = w;
    let corner = |i: u32| {
        let side = |bit: u32, size: f32| if i >> bit & 1 == 0 { -size } else { size };
        [side(0, x), side(1, y), side(2, z)]
    };
    // Floor, ceiling, back, left, right, front.
    [[4, 5, 1, 0], [2, 3, 7, 6], [0, 1, 3, 2], [4, 0, 2, 6], [1, 5, 7, 3], [5, 4, 6, 7]]
        .map(|wall: [u32; 4]| (wall.map(corner), 0))
        .to_vec()
}

fn contains(bounds: &Aabb, point: Vec3) -> bool {
    bounds.contains(&Aabb::new(point, point))
}

/// A grid of `n` x `n` cells over -1 to 1, bent by a function of its place.
fn grid(n: u32, bend: impl Fn(f32, f32) -> Vec3) -> Scene {
    let at = |i: u32| 2.0 * i as f32 / n as f32 - 1.0;
    let positions: Vec<Vec3> = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i, j)))
        .map(|(i, j)| bend(at(i), at(j)))
        .collect();
    let cell = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    let triangles = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    let mut scene = Scene::default();
    scene.mesh.triangles = TriangleMesh::new(positions, triangles).expect("a mesh");
    scene
}

#[test]
fn a_closed_room_is_seen_and_lit_from_within() {
    for size in [0.01, 1.0, 1000.0] {
        let scene = scene(&room([3.0 * size, size, 2.0 * size]), &[], vec![matte(0.7)]);
        let prepared = PreparedScene::new(&scene).expect("a tree");
        assert_eq!(Setting::of(&prepared), Setting::Inside);
        let view = default_view(&prepared, 1.6);
        assert!(contains(&scene.bounds(), view.camera.eye));
        let mut points = 0;
        for light in &view.lights {
            if let LightKind::Point { position } = light.kind {
                assert!(contains(&scene.bounds(), position));
                points += 1;
            }
        }
        assert!(points >= 2);

        // And so one sees something: no pixel black, few burnt out.
        let options = RenderOptions { width: 32, height: 20, ..RenderOptions::default() };
        let (image, _) = render(&prepared, &view.camera, &view.lights, &options, &Progress::new())
            .expect("an image");
        assert!(image.pixels().iter().all(|c| c.x > 0.1));
        assert!(image.pixels().iter().filter(|c| c.x > 1.0).count() < 64);
    }
}

#[test]
fn a_stage_is_seen_through_its_opening() {
    for (open, towards) in [(5, Vec3::Z), (3, -Vec3::X), (4, Vec3::X), (2, -Vec3::Z)] {
        let mut walls = room([1.0; 3]);
        walls.remove(open);
        let scene = scene(&walls, &[], vec![matte(0.7)]);
        let prepared = PreparedScene::new(&scene).expect("a tree");
        assert_eq!(Setting::of(&prepared), Setting::Opening { towards });
        let camera = choose_camera(&prepared, 1.0);
        assert!((camera.eye - camera.target).normalize_or_zero().dot(towards) > 0.99);
    }
}

#[test]
fn a_tray_open_to_the_sky_is_seen_from_outside() {
    let mut walls = room([1.0; 3]);
    walls.remove(1);
    let scene = scene(&walls, &[], vec![matte(0.7)]);
    let prepared = PreparedScene::new(&scene).expect("a tree");
    assert_eq!(Setting::of(&prepared), Setting::Outside);
    assert!(choose_camera(&prepared, 1.6).eye.y > 1.0);
}

#[test]
fn a_solid_thing_is_seen_from_outside() {
    // The same walls, fronts outwards.
    let walls: Vec<Quad> =
        room([1.0; 3]).into_iter().map(|([a, b, c, d], m)| ([d, c, b, a], m)).collect();
    let scene = scene(&walls, &[], vec![matte(0.7)]);
    let prepared = PreparedScene::new(&scene).expect("a tree");
    assert_eq!(Setting::of(&prepared), Setting::Outside);
    let camera = default_view(&prepared, 1.6).camera;
    assert!(camera.eye.x > 1.0 && camera.eye.y > 1.0 && camera.eye.z > 1.0);
}

/// Between the plates of a closed machine there are fronts all around, but no room.
#[test]
fn gaps_within_a_machine_are_not_a_room() {
    let mut walls = room([1.0; 3]);
    for plate in -9..=9 {
        let y = 0.1 * plate as f32 + 0.05;
        walls.push((level(y - 0.01, 0.99, false), 0));
        walls.push((level(y + 0.01, 0.99, true), 0));
    }
    let scene = scene(&walls, &[], vec![matte(0.7)]);
    let prepared = PreparedScene::new(&scene).expect("a tree");
    assert_eq!(Setting::of(&prepared), Setting::Outside);
}

#[test]
fn up_is_z_for_a_terrain_over_the_xy_plane_only() {
    let hills = |x: f32, y: f32| 0.1 * (3.0 * x).sin() * (4.0 * y).cos();
    let over_xy = grid(20, |x, y| Vec3::new(x, y, hills(x, y)));
    let up_of = |scene: &Scene| choose_camera(&PreparedScene::new(scene).expect("a tree"), 1.6).up;
    assert_eq!(up_of(&over_xy), Vec3::Z);
    let over_xz = grid(20, |x, y| Vec3::new(x, hills(x, y), -y));
    assert_eq!(up_of(&over_xz), Vec3::Y);
    // A picture on a wall, and a plate with two sides, stand upright.
    let picture = grid(20, |x, y| Vec3::new(x, y, 0.0));
    assert_eq!(up_of(&picture), Vec3::Y);
    let plate = scene(&room([3.0, 2.0, 0.2]), &[], vec![]);
    assert_eq!(up_of(&plate), Vec3::Y);
}

/// A small dense thing on a wide floor is what the picture is about.
#[test]
fn the_camera_goes_where_the_detail_is() {
    let mut ball = grid(40, |x, y| {
        let (a, b) = (3.1 * x, 1.5 * y);
        0.5 * Vec3::new(b.cos() * a.sin(), b.sin(), b.cos() * a.cos())
    });
    let mut positions = ball.mesh.triangles.positions().to_vec();
    let mut triangles = ball.mesh.triangles.triangles().to_vec();
    let first = positions.len() as u32;
    positions.extend(level(-0.5, 20.0, true).map(Vec3::from));
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    ball.mesh.triangles = TriangleMesh::new(positions, triangles).expect("a mesh");
    let camera = choose_camera(&PreparedScene::new(&ball).expect("a tree"), 1.6);
    assert!((camera.eye - camera.target).length() < 6.0, "{camera:?}");
    assert!(camera.target.length() < 1.0);
}

/// A model fills the picture, and a vertex that no triangle uses does not matter.
#[test]
fn surfaces_rather_than_their_box_fill_the_picture() {
    let slope = |x: f32, y: f32| Vec3::new(x, x + y, -y);
    let mut scene = grid(4, slope);
    let camera = choose_camera(&PreparedScene::new(&scene).expect("a tree"), 1.6);
    let mut positions = scene.mesh.triangles.positions().to_vec();
    positions.push(Vec3::splat(1e6));
    let triangles = scene.mesh.triangles.triangles().to_vec();
    scene.mesh.triangles = TriangleMesh::new(positions, triangles).expect("a mesh");
    assert_eq!(choose_camera(&PreparedScene::new(&scene).expect("a tree"), 1.6), camera);

    // Every vertex is in the picture, and on each pair of opposite sides one comes near the edge or nothing could.
    let rays = CameraRays::new(&camera, 160, 100).expect("a camera");
    let forward = rays.ray(80.0, 50.0).direction;
    let across =
        (rays.ray(160.0, 50.0).direction - rays.ray(0.0, 50.0).direction).normalize_or_zero();
    let up = across.cross(forward);
    let (half_height, half_width) = (17.5f32.to_radians().tan(), 1.6 * 17.5f32.to_radians().tan());
    let mut reach = 0.0f32;
    for &vertex in &scene.mesh.triangles.positions()[..25] {
        let d = vertex - camera.eye;
        let depth = d.dot(forward);
        let (x, y) = (d.dot(across) / depth / half_width, d.dot(up) / depth / half_height);
        reach = reach.max(x.abs()).max(y.abs());
    }
    assert!((0.92..0.96).contains(&reach), "{reach}");
}

#[test]
fn a_scene_without_anything_has_a_view_all_the_same() {
    let scene = Scene::default();
    let prepared = PreparedScene::new(&scene).expect("a tree");
    let view = default_view(&prepared, 1.6);
    let options = RenderOptions { width: 4, height: 3, ..RenderOptions::default() };
    let (image, stats) = render(&prepared, &view.camera, &view.lights, &options, &Progress::new())
        .expect("an image");
    assert_eq!(stats.rays.total(), 12);
    assert!(image.pixels().iter().all(|color| color.is_finite()));
}

#[test]
fn a_scenes_own_camera_and_lights_are_kept() {
    let mut scene = scene(&room([1.0; 3]), &[], vec![matte(0.7)]);
    scene.cameras = vec![camera([0.0, 0.0, 9.0], [0.0; 3])];
    scene.lights = vec![light(LightKind::Ambient, 0.5)];
    let view = default_view(&PreparedScene::new(&scene).expect("a tree"), 1.6);
    assert_eq!(view.camera, scene.cameras[0]);
    assert_eq!(view.lights, scene.lights);

    // Of a room seen from outside the outer walls are lit.
    scene.lights.clear();
    let view = default_view(&PreparedScene::new(&scene).expect("a tree"), 1.6);
    assert!(view.lights.iter().all(|l| !matches!(l.kind, LightKind::Point { .. })));
}
