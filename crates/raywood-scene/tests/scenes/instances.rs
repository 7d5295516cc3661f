//! Scenes with instances: what glTF shares and what it copies, and scenes in which all is copied.

use raywood::{Transform, TriangleMesh, Vec3};
use raywood_scene::{
    Instance, Instances, InstancesError, Mesh, Rgb, Scene, TooManyTriangles, save_scene,
};

use crate::formats_support::{check_scene, glb, load, triangle_count};

/// A closed box from -1 to 1 of `cells` times `cells` quads a side, its outside outside: positions and triangles.
fn grid_box(cells: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for side in 0..6 {
        let (axis, sign) = (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
        let first = positions.len() as u32;
        for j in 0..=cells {
            for i in 0..=cells {
                let [u, v] = [i, j].map(|k| 2.0 * k as f32 / cells as f32 - 1.0);
                let mut point = [0.0; 3];
                point[axis] = sign;
                point[(axis + 1) % 3] = sign * u;
                point[(axis + 2) % 3] = v;
                positions.push(point);
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let a = first + j * (cells + 1) + i;
                let (b, c, d) = (a + 1, a + cells + 2, a + cells + 1);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (positions, triangles)
}

/// A file with the box of so many cells at these nodes.
fn file(cells: u32, nodes: &str) -> Vec<u8> {
    let (positions, triangles) = grid_box(cells);
    let mut buffer: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let start = buffer.len();
    buffer.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
    let (all, indices) = (buffer.len(), buffer.len() - start);
    let (vertices, corners) = (positions.len(), 3 * triangles.len());
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}},
        {{"bufferView":1,"componentType":5125,"count":{corners},"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{start}}},{{"buffer":0,"byteOffset":{start},"byteLength":{indices}}}],
        "buffers":[{{"byteLength":{all}}}]}}"#
    );
    glb(&json, &buffer)
}

/// Nodes in a row, each of another shape; every tenth is flat, so that there is no way back.
fn nodes(count: usize) -> String {
    let node = |number: usize| {
        let scale = match number % 10 {
            3 => "[-1,1,1]",
            5 => "[0.5,2,1]",
            9 => "[1,0,1]",
            _ => "[1,1,1]",
        };
        let x = 10 * number;
        format!(r#"{{"mesh":0,"translation":[{x},0,0],"rotation":[0,0.6,0,0.8],"scale":{scale}}}"#)
    };
    (0..count).map(node).collect::<Vec<_>>().join(",")
}

/// Volume and bounds of a scene whose instances are copied.
fn measured(mut scene: Scene) -> (f32, Vec3, Vec3) {
    scene.flatten(u64::MAX).unwrap();
    check_scene(&scene);
    (crate::formats_support::volume(&scene), scene.bounds().min, scene.bounds().max)
}

#[test]
fn meshes_that_many_nodes_show_are_shared() {
    // 6 * 6 * 6 * 2 = 432 triangles.
    let scene = load("many.glb", file(6, &nodes(200))).unwrap();
    check_scene(&scene);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.instances.objects().len(), 1);
    assert_eq!(scene.instances.placed().len(), 180);
    // What is flat is copied, and comes first.
    assert_eq!(scene.instances.own_triangles(&scene.mesh.triangles), 20 * 432);
    assert_eq!(triangle_count(&scene), 21 * 432);
    assert_eq!(scene.visible_triangles(), 200 * 432);

    // Boxes of turned boxes are larger, but hold all.
    let bounds = scene.bounds();
    let (volume, min, max) = measured(scene);
    assert!(bounds.min.min(min) == bounds.min && bounds.max.max(max) == bounds.max, "{bounds:?}");
    // Mirrored ones still show their outsides.
    let expected = 180.0 * 8.0;
    assert!((volume - expected).abs() < 0.02 * expected, "{volume}");
}

#[test]
fn small_or_few_meshes_are_copied() {
    for (cells, count, what) in [(6, 100, "few"), (3, 2000, "small"), (6, 1, "one")] {
        let scene = load("few.glb", file(cells, &nodes(count))).unwrap();
        assert!(scene.instances.is_empty(), "{what}");
        assert_eq!(triangle_count(&scene) as u32, 12 * cells * cells * count as u32, "{what}");
    }
}

#[test]
fn triangles_that_are_dropped_leave_objects_where_they_are() {
    let (mut bytes, bad) = (file(6, &nodes(200)), f32::NAN.to_le_bytes());
    // The first coordinate of a vertex in the middle of a side belongs to six triangles.
    let json_length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let vertex = 20 + json_length + 8 + 12 * (3 * 7 + 3);
    bytes[vertex..vertex + 4].copy_from_slice(&bad);
    let scene = load("bad.glb", bytes).unwrap();
    check_scene(&scene);
    assert!(!scene.warnings.is_empty());
    assert_eq!(scene.instances.own_triangles(&scene.mesh.triangles), 20 * 426);
    assert_eq!(scene.visible_triangles(), 200 * 426);
}

/// A triangle in the world and another one as an object.
fn two_triangles(placed: Vec<Instance>) -> Scene {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let positions = corners.iter().chain(&corners).copied().collect();
    let mesh = Mesh {
        triangles: TriangleMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap(),
        normals: vec![Vec3::Z; 6],
        tangents: vec![[1.0, 0.0, 0.0, 1.0]; 6],
        materials: vec![0, 1],
        ..Mesh::default()
    };
    let instances = Instances::new(vec![1], 2, placed).unwrap();
    Scene { mesh, instances, ..Scene::default() }
}

#[test]
fn copies_face_where_instances_do() {
    let mirrored = Transform::scaling([-1.0, 2.0, 1.0]);
    let slanted =
        Transform::from_rows([[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0]]);
    let red = Rgb::new(2.0, 0.5, 0.5);
    let mut scene = two_triangles(vec![
        Instance { tint: red, ..Instance::new(0, mirrored) },
        Instance { material: Some(7), ..Instance::new(0, slanted) },
    ]);
    scene.flatten(3).unwrap();
    let mesh = &scene.mesh;
    assert_eq!(mesh.triangles.triangles().len(), 3);
    assert_eq!(mesh.materials, [0, 1, 7]);
    assert_eq!(mesh.colors[3..6], [red; 3]);
    assert_eq!(mesh.colors[..3], [Rgb::ONE; 3]);
    // What is mirrored still shows its front to +z, and its bitangent is mirrored.
    let [a, b, c] = mesh.triangles.corners(1);
    assert!((b - a).cross(c - a).z > 0.0);
    assert_eq!(mesh.tangents[3], [-1.0, 0.0, 0.0, -1.0]);
    assert_eq!(mesh.normals[3], Vec3::Z);
    // Normals stay upright on what is sheared.
    let [a, b, c] = mesh.triangles.corners(2);
    let upright = (b - a).cross(c - a).normalize_or_zero();
    assert!((mesh.normals[6] - upright).length() < 1e-6, "{:?}", mesh.normals[6]);
}

#[test]
fn too_many_triangles_stay_instances() {
    let placed = vec![Instance::new(0, Transform::IDENTITY); 9];
    let mut scene = two_triangles(placed);
    let before = scene.instances.clone();
    let error = scene.flatten(9).unwrap_err();
    assert_eq!(error, TooManyTriangles { visible: 10, most: 9 });
    assert!(error.to_string().contains("10 triangles"), "{error}");
    assert_eq!(scene.instances, before);

    // Nor can they be saved.
    let tree = raywood::Bvh::build(scene.mesh.triangles.clone()).unwrap();
    let error = save_scene(&scene, &tree, Vec::new()).unwrap_err();
    assert!(error.to_string().contains("instances"), "{error}");
}

#[test]
fn instances_of_nothing_are_errors() {
    let at = |object| vec![Instance::new(object, Transform::IDENTITY)];
    let missing = InstancesError::NoSuchObject { instance: 0, object: 2, objects: 2 };
    assert_eq!(Instances::new(vec![0, 5], 9, at(2)), Err(missing));
    let unordered = Err(InstancesError::Unordered { object: 1 });
    assert_eq!(Instances::new(vec![0, 5], 4, at(0)), unordered);
    let flat = vec![Instance::new(0, Transform::scaling([1.0, 0.0, 1.0]))];
    let error = Instances::new(vec![0], 4, flat).unwrap_err();
    assert!(error.to_string().starts_with("the transform of instance 0"), "{error}");

    // Objects that reach beyond the mesh show what is there.
    let mut scene = two_triangles(vec![]);
    scene.instances = Instances::new(vec![1, 7], 9, at(1)).unwrap();
    assert!(scene.bounds().is_finite());
    scene.flatten(100).unwrap();
    assert_eq!(triangle_count(&scene), 1);
}
