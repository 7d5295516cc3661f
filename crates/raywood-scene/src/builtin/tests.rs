//! Tests of all built-in scenes, and of how they are asked for.

use std::collections::HashMap;

use super::*;
use crate::LightKind;
use modelling::{Part, is_closed, signed_volume};

/// Every scene at a small size.
fn small_scenes() -> Vec<Scene> {
    let queries =
        ["hall?detail=1", "whitted", "sphereflake?depth=3", "terrain?n=64", "forest?n=60", "mill"];
    assert_eq!(queries.len(), builtins().len(), "a scene is missing from this list");
    queries.map(|query| builtin(query).unwrap()).into()
}

#[test]
fn scenes_are_complete_and_consistent() {
    for scene in small_scenes() {
        let name = &scene.name;
        let mesh = &scene.mesh;
        let triangles = mesh.triangles.triangles();

        assert!(scene.bounds().is_finite() && !scene.bounds().is_empty(), "{name}");
        assert_eq!(mesh.materials.len(), triangles.len(), "{name}");
        assert_eq!(scene.sphere_materials.len(), scene.spheres.as_slice().len(), "{name}");
        let materials = mesh.materials.iter().chain(&scene.sphere_materials);
        let last = materials.max().copied().unwrap() as usize;
        assert!(last < scene.materials.len(), "{name}: material {last}");
        assert!(!scene.cameras.is_empty() && !scene.lights.is_empty(), "{name}");
        assert!(scene.warnings.is_empty(), "{name}");

        if !mesh.colors.is_empty() {
            assert_eq!(mesh.colors.len(), mesh.triangles.positions().len(), "{name}");
            assert!(mesh.colors.iter().all(|c| c.is_finite()), "{name}");
        }
        assert_eq!(mesh.normals.len(), mesh.triangles.positions().len(), "{name}");
        for &corner in triangles.iter().flatten() {
            let normal = mesh.normals[corner as usize];
            assert!((normal.length() - 1.0).abs() < 1e-4, "{name}: {normal:?} at {corner}");
        }
        for light in &scene.lights {
            if let LightKind::Directional { direction, .. } | LightKind::Spot { direction, .. } =
                light.kind
            {
                assert!((direction.length() - 1.0).abs() < 1e-5, "{name}: {light:?}");
            }
        }
    }
}

#[test]
fn shading_normals_agree_with_the_triangles_they_shade() {
    for scene in small_scenes() {
        let mesh = &scene.mesh;
        let agreeing = |(i, corners): (usize, &[u32; 3])| {
            let [a, b, c] = mesh.triangles.corners(i as u32);
            let normal = (b - a).cross(c - a);
            corners.iter().all(|&v| mesh.normals[v as usize].dot(normal) > 0.0)
        };
        let triangles = mesh.triangles.triangles();
        let count = triangles.iter().enumerate().filter(|&t| agreeing(t)).count();
        // At cusps (the arris between two flutes, a vault's springing) a smooth normal belongs to neither side.
        let share = count as f64 / triangles.len() as f64;
        assert!(share > 0.98, "{}: {share}", scene.name);
    }
}

#[test]
fn every_material_is_used() {
    for scene in small_scenes() {
        for (id, material) in scene.materials.iter().enumerate() {
            let used = |materials: &[u32]| materials.contains(&(id as u32));
            assert!(
                used(&scene.mesh.materials) || used(&scene.sphere_materials),
                "{}: {}",
                scene.name,
                material.name
            );
        }
    }
}

#[test]
fn glass_is_closed_with_its_front_outside() {
    for scene in small_scenes() {
        // Take the glass out of the mesh, material by material.
        let mut glass: HashMap<u32, Part> = HashMap::new();
        for (corners, &material) in
            scene.mesh.triangles.triangles().iter().zip(&scene.mesh.materials)
        {
            if scene.materials[material as usize].transmission.max_element() > 0.0 {
                glass.entry(material).or_default().triangles.push(*corners);
            }
        }
        if scene.name == "hall" {
            assert!(!glass.is_empty(), "the hall has an ornament of glass");
        }
        for (material, mut part) in glass {
            part.positions = scene.mesh.triangles.positions().to_vec();
            let name = &scene.materials[material as usize].name;
            assert!(is_closed(&part), "{}: {name}", scene.name);
            assert!(signed_volume(&part) > 0.0, "{}: {name}", scene.name);
        }
    }
}

#[test]
fn the_same_request_makes_the_same_scene_on_any_number_of_threads() {
    for query in [
        "hall?detail=1",
        "terrain?n=100&seed=3",
        "sphereflake?depth=2",
        "forest?n=9",
        "mill?turn=9",
    ] {
        let make = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| builtin(query)).unwrap()
        };
        let (one, three) = (make(1), make(3));
        assert_eq!(one.mesh, three.mesh, "{query}");
        assert_eq!(one.spheres, three.spheres, "{query}");
        assert_eq!(one.instances, three.instances, "{query}");
        assert_eq!((one.lights, one.cameras), (three.lights, three.cameras), "{query}");
    }
}

#[test]
fn the_hall_has_many_triangles_of_uneven_size() {
    let scene = builtin(DEFAULT_BUILTIN).unwrap();
    let mesh = &scene.mesh.triangles;
    assert!(mesh.triangles().len() >= 250_000, "{}", mesh.triangles().len());
    let area = |i: usize| {
        let [a, b, c] = mesh.corners(i as u32);
        0.5 * (b - a).cross(c - a).length()
    };
    let small = (0..mesh.triangles().len()).filter(|&i| area(i) < 1e-3).count();
    let large = (0..mesh.triangles().len()).filter(|&i| area(i) > 10.0).count();
    assert!(small > 100_000 && large >= 10, "{small} small, {large} large");
}

#[test]
fn parameters_scale_scenes_as_documented() {
    let triangles = |query: &str| builtin(query).unwrap().mesh.triangles.triangles().len();
    for n in [1, 2, 100, 333] {
        assert_eq!(triangles(&format!("terrain?n={n}")), 2 * n * n + 2);
    }
    for depth in 0..=5 {
        let scene = builtin(&format!("sphereflake?depth={depth}")).unwrap();
        let expected = (9usize.pow(depth + 1) - 1) / 8;
        assert_eq!(scene.spheres.as_slice().len(), expected);
    }
    assert_eq!(builtin("sphereflake").unwrap().spheres.as_slice().len(), 66_430);
    assert!(3 * triangles("hall?detail=1") < triangles("hall?detail=2"));

    // A seed changes the land.
    let [a, b] = ["terrain?n=50&seed=1", "terrain?n=50&seed=2"].map(|q| builtin(q).unwrap());
    assert_ne!(a.mesh, b.mesh);
    for seed in [0, u32::MAX] {
        assert!(builtin(&format!("terrain?seed={seed}&n=8")).is_ok());
    }
}

#[test]
fn touching_spheres_of_the_flake_do_not_overlap_their_parents() {
    let scene = builtin("sphereflake?depth=1").unwrap();
    let spheres = scene.spheres.as_slice();
    let (parent, radius) = spheres[0];
    for &(center, r) in &spheres[1..] {
        assert!(((center - parent).length() - (radius + r)).abs() < 1e-5);
    }
}

#[test]
fn entries_are_well_formed() {
    assert_eq!(builtins()[0].name, DEFAULT_BUILTIN);
    for (i, entry) in builtins().iter().enumerate() {
        assert!(builtins()[..i].iter().all(|other| other.name != entry.name));
        assert!(!entry.description.contains('\n'));
        for (k, p) in entry.parameters.iter().enumerate() {
            assert!((p.min..=p.max).contains(&p.default), "{}: {}", entry.name, p.name);
            assert!(entry.parameters[..k].iter().all(|other| other.name != p.name));
        }
    }
}

#[test]
fn refusals_are_one_line_and_say_what_exists() {
    let refusal = |query: &str| builtin(query).unwrap_err().to_string();
    let cases = [
        (
            "terain?n=8",
            "there is no built-in scene 'terain', did you mean 'terrain'? (there are: hall, whitted, sphereflake, \
             terrain, forest, mill)",
        ),
        (
            "",
            "there is no built-in scene '' (there are: hall, whitted, sphereflake, terrain, forest, mill)",
        ),
        (
            "terrain?sed=8",
            "the scene 'terrain' has no parameter 'sed', did you mean 'seed'? (there are: n, seed)",
        ),
        ("whitted?n=1", "the scene 'whitted' has no parameters, but 'n' is given"),
        (
            "terrain?n=0",
            "the parameter 'n' of the scene 'terrain' is '0', but must be a whole number from 1 to 4096",
        ),
        (
            "sphereflake?depth=1e9",
            "the parameter 'depth' of the scene 'sphereflake' is '1e9', but must be a whole number from 0 to 7",
        ),
        (
            "terrain?n",
            "the parameter 'n' of the scene 'terrain' is '', but must be a whole number from 1 to 4096",
        ),
        ("terrain?n=4&n=5", "the parameter 'n' of the scene 'terrain' is given more than once"),
    ];
    for (query, expected) in cases {
        assert_eq!(refusal(query), expected);
    }
    assert!(builtin("whitted?").is_ok());
    assert!(builtin("terrain?&seed=1&").is_ok());
}

#[test]
fn sails_turn_as_far_as_they_are_asked_to() {
    let moving = |query: &str| {
        let scene = builtin(query).unwrap();
        let placed = scene.instances.placed().to_vec();
        placed.into_iter().filter(|instance| instance.later.is_some()).collect::<Vec<_>>()
    };
    assert!(moving("mill?turn=0").is_empty());
    for (query, degrees) in [("mill", 16.0f32), ("mill?turn=60", 60.0)] {
        let sails = moving(query);
        assert_eq!(sails.len(), 3);
        for sail in sails {
            // Where the end of a sail goes from, and to, around the hub.
            let [first, later] = [sail.transform, sail.later.unwrap()];
            let spar = raywood::Vec3::new(0.0, 7.0, 0.0);
            let (from, to) = (first.vector(spar), later.vector(spar));
            let cosine = from.dot(to) / (from.length() * to.length());
            assert!((cosine - degrees.to_radians().cos()).abs() < 1e-4, "{query}");
            // Counter-clockwise as seen from before the mill.
            assert!(from.cross(to).dot(first.vector(raywood::Vec3::Z)) > 0.0);
        }
    }
}
