//! Pictures of scenes with instances are those of the same scenes with everything copied.

use raywood::{Spheres, StructureKind, Transform, TriangleMesh, Vec3};
use raywood_render::{
    INTEGRATORS, Image, PrepareError, PreparedScene, Progress, RenderError, RenderOptions,
    choose_camera, default_view, heat_map, render,
};
use raywood_scene::{
    Camera, Instance, Instances, Light, LightKind, Material, Mesh, Pattern, Rgb, Scene, builtin,
};
use raywood_testkit::shapes;

/// A floor and a sphere in the world, and one bent sheet at places of every kind: turned, stretched, mirrored, sheared; glass, shining, and tinted ones.
pub(crate) fn scene() -> Scene {
    let ball = shapes::uv_sphere(12, Vec3::ZERO, 1.0);
    let floor = [[-8.0, -1.2, -8.0], [-8.0, -1.2, 8.0], [8.0, -1.2, 8.0], [8.0, -1.2, -8.0]];
    let mut positions: Vec<Vec3> = floor.map(Vec3::from).to_vec();
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mut normals = vec![Vec3::Y; 4];
    positions.extend(ball.positions());
    normals.extend(ball.positions().iter().map(|p| p.normalize_or_zero()));
    triangles.extend(ball.triangles().iter().map(|t| t.map(|corner| corner + 4)));
    let colors: Vec<_> =
        positions.iter().map(|p| Rgb::new(0.7, 0.5 + 0.3 * p.x.sin(), 0.5)).collect();
    let end = triangles.len() as u32;
    let materials = vec![
        Material {
            pattern: Pattern::Checker { other: Rgb::splat(0.2), size: 1.0 },
            ..Material::default()
        },
        Material { mirror: Rgb::splat(0.1), ..Material::default() },
        Material {
            name: "glass".into(),
            diffuse: Rgb::ZERO,
            transmission: Rgb::new(0.9, 1.0, 0.9),
            ior: 1.5,
            ..Material::default()
        },
        Material { emission: Rgb::new(3.0, 2.0, 1.0), ..Material::default() },
    ];
    let mut of_triangles = vec![0; 2];
    of_triangles.resize(end as usize, 1);

    let at = |shape: Transform, x: f32, z: f32| {
        let turn = Transform::rotation([1.0, 2.0, 0.5], 40.0);
        Instance::new(0, shape.then(&turn).then(&Transform::translation([x, 0.0, z])))
    };
    let shear =
        Transform::from_rows([[1.0, 0.6, 0.0, 0.0], [0.0, 1.0, -0.3, 0.0], [0.2, 0.0, 1.0, 0.0]]);
    let placed = vec![
        at(Transform::IDENTITY, -3.0, 0.0),
        Instance {
            tint: Rgb::new(1.5, 0.4, 0.4),
            ..at(Transform::scaling([1.2, 0.6, 0.4]), -1.0, 1.0)
        },
        at(Transform::scaling([-1.0, 1.0, 0.5]), 1.0, -1.5),
        at(shear, 3.0, -1.0),
        Instance { material: Some(2), ..at(Transform::scaling([0.6; 3]), 1.2, 2.0) },
        Instance { material: Some(3), ..at(Transform::scaling([0.2, 0.3, -0.2]), -0.2, 3.0) },
    ];
    Scene {
        mesh: Mesh {
            triangles: TriangleMesh::new(positions, triangles).expect("a mesh"),
            normals,
            colors,
            materials: of_triangles,
            ..Mesh::default()
        },
        spheres: Spheres::new(vec![(Vec3::new(3.2, -0.6, 2.0), 0.6)]).expect("a sphere"),
        sphere_materials: vec![1],
        instances: Instances::new(vec![2], end, placed).expect("good transforms"),
        materials,
        lights: vec![
            Light { name: String::new(), kind: LightKind::Ambient, intensity: Rgb::splat(0.2) },
            Light {
                name: String::new(),
                kind: LightKind::Point { position: Vec3::new(-3.0, 6.0, 5.0) },
                intensity: Rgb::splat(50.0),
            },
            Light {
                name: String::new(),
                kind: LightKind::directional(Vec3::new(-0.3, -0.9, -0.3).normalize_or_zero()),
                intensity: Rgb::splat(0.6),
            },
        ],
        cameras: vec![Camera {
            name: String::new(),
            eye: Vec3::new(0.0, 2.5, 9.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y: 45.0,
        }],
        up: Some(Vec3::Y),
        ..Scene::default()
    }
}

fn picture(scene: &Scene, options: &RenderOptions) -> Image {
    let prepared = PreparedScene::new(scene).expect("it builds");
    let view = default_view(&prepared, 1.6);
    render(&prepared, &view.camera, &view.lights, options, &Progress::new()).expect("a picture").0
}

#[test]
fn instances_look_as_copies_to_every_integrator() {
    let scene = scene();
    let mut flat = scene.clone();
    flat.flatten(1 << 20).expect("few triangles");
    assert!(flat.instances.is_empty());
    assert_eq!(flat.mesh.triangles.triangles().len() as u64, scene.visible_triangles());
    for integrator in &INTEGRATORS {
        // Single hits at edges differ, and numbers of triangles do.
        if integrator.name == "ids" {
            continue;
        }
        let samples = if integrator.name == "path" { 64 } else { 2 };
        let options = RenderOptions {
            width: 96,
            height: 60,
            samples,
            integrator,
            ..RenderOptions::default()
        };
        let [a, b] = [&scene, &flat].map(|scene| picture(scene, &options));
        let (mut differ, mut sums) = (0, [0.0f64; 2]);
        for y in 0..60 {
            for (p, q) in a.row(y).iter().zip(b.row(y)) {
                let difference = (*p - *q).abs().max_element();
                differ += usize::from(difference > 0.02 * (1.0 + p.max_element()));
                sums[0] += f64::from(p.x + p.y + p.z);
                sums[1] += f64::from(q.x + q.y + q.z);
            }
        }
        let share = differ as f64 / (96.0 * 60.0);
        let [a, b] = sums;
        // Paths that begin to differ by a rounding go other ways: their mean tells.
        let most = if integrator.name == "path" { 1.0 } else { 0.01 };
        assert!(share <= most, "{}: {share} of all pixels differ", integrator.name);
        assert!((a - b).abs() < 0.01 * b, "{}: {a}, copied {b}", integrator.name);
    }
}

#[test]
fn an_instance_of_everything_is_the_scene_to_every_pixel() {
    // All triangles of a built-in scene as one object, at its place.
    let whole = builtin("hall?detail=1").expect("a scene");
    let mut instanced = whole.clone();
    let end = whole.mesh.triangles.triangles().len() as u32;
    let placed = vec![Instance::new(0, Transform::IDENTITY)];
    instanced.instances = Instances::new(vec![0], end, placed).expect("an instance");
    assert!(instanced.bounds().contains(&whole.bounds()));
    let options = RenderOptions { width: 80, height: 50, samples: 1, ..RenderOptions::default() };
    let [a, b] = [&whole, &instanced].map(|scene| picture(scene, &options));
    let differ = (0..50)
        .flat_map(|y| a.row(y).iter().zip(b.row(y)))
        .filter(|(p, q)| (**p - **q).abs().max_element() > 0.01)
        .count();
    assert!(differ < 20, "{differ} pixels differ");
}

#[test]
fn views_see_instances() {
    let mut scene = scene();
    (scene.cameras, scene.lights) = (vec![], vec![]);
    let mut flat = scene.clone();
    flat.flatten(1 << 20).expect("few triangles");
    let [a, b] = [&scene, &flat]
        .map(|scene| choose_camera(&PreparedScene::new(scene).expect("it builds"), 1.6));
    // Boxes of turned things are larger than these.
    assert!((a.eye - b.eye).length() < 0.2 * b.eye.length(), "{a:?}, copied {b:?}");
}

#[test]
fn what_needs_one_structure_says_so() {
    let scene = scene();
    let error = PreparedScene::with_structure(&scene, StructureKind::KdTree).err().expect("none");
    let expected =
        PrepareError::Kind { kind: StructureKind::KdTree, visible: scene.visible_triangles() };
    assert_eq!(error, expected);
    let prepared = PreparedScene::new(&scene).expect("it builds");
    assert!(prepared.structure().is_none());
    assert_eq!(prepared.stats().primitives, scene.mesh.triangles.triangles().len() + 1);
    let view = default_view(&prepared, 1.6);
    let options = RenderOptions::default();
    let quantity = raywood_render::HeatQuantity::Nodes;
    let map = heat_map(&prepared, &view.camera, &options, quantity, &Progress::new());
    assert!(matches!(map, Err(RenderError::Instances)));
}

#[test]
fn the_forest_takes_little_memory() {
    let scene = builtin("forest").expect("a scene");
    assert!(scene.visible_triangles() >= 100_000_000, "{}", scene.visible_triangles());
    let unique = scene.mesh.triangles.triangles().len();
    assert!(unique < 2_500_000, "{unique}");
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let bytes = prepared.stats().bytes;
    assert!(bytes < 300_000_000, "{bytes}");
}
