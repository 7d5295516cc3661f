//! Meshes that are read where they lie, in every form, and quads: the same as a plain mesh of the same triangles.

use std::sync::Arc;

use raywood::{
    Bvh, Geometry, Indices, MeshError, MeshView, Quads, Ray, Strided, TriangleMesh, Vec3, Vertices,
};
use raywood_testkit::{Rng, nasty, points, rays, shapes};

/// Holds a geometry to answer everything as a mesh of the same triangles in the same order.
fn same_as(geometry: &dyn Geometry, mesh: &TriangleMesh, what: &str) {
    let (own, plain) = (Bvh::build(geometry), Bvh::build(mesh));
    let (own, plain) = (own.expect("it builds"), plain.expect("it builds"));
    assert_eq!(own.validate(), Ok(()), "{what}");
    assert_eq!(own.geometry().len(), mesh.len(), "{what}");
    let rays = rays::against(mesh, 300, 91);
    let [mut own_hits, mut plain_hits] = [(); 2].map(|()| vec![None; rays.len()]);
    own.intersect_batch(&rays, &mut own_hits);
    plain.intersect_batch(&rays, &mut plain_hits);
    assert_eq!(own_hits, plain_hits, "{what}");
    for ray in &rays {
        let hit = own.intersect(ray);
        assert_eq!(hit, plain.intersect(ray), "{what}: {ray:?}");
        if let Some(hit) = hit {
            assert_eq!(own.surface_point(ray, &hit), plain.surface_point(ray, &hit), "{what}");
        }
        assert_eq!(own.crossings(ray), plain.crossings(ray), "{what}: {ray:?}");
    }
    for point in points::around(mesh, 50, 92) {
        let closest = own.closest_point(point, f32::INFINITY);
        assert_eq!(closest, plain.closest_point(point, f32::INFINITY), "{what}: {point:?}");
    }
}

/// Bytes of vertices with other things before, between and behind them.
fn interleaved(positions: &[Vec3], offset: usize, stride: usize) -> Vec<u8> {
    let mut bytes = vec![0xA5; offset];
    for position in positions {
        let start = bytes.len();
        position.to_array().iter().for_each(|x| bytes.extend(x.to_ne_bytes()));
        bytes.resize(start + stride, 0x5A);
    }
    bytes
}

#[test]
fn every_form_of_memory_is_the_same_mesh() {
    let meshes = nasty::all().into_iter().map(|nasty| (nasty.name, nasty.mesh));
    let soup = ("a soup", shapes::soup(300, 0.2, 93));
    for (name, mesh) in meshes.chain([soup]).filter(|(_, mesh)| mesh.positions().len() < 1 << 16) {
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        let flat = triangles.as_flattened();
        let short: Vec<u16> = flat.iter().map(|&index| index as u16).collect();
        let check = |what: &str, vertices: &dyn Vertices, indices: &dyn Indices| {
            let view = MeshView::new(vertices, indices).expect("a sound mesh");
            same_as(&view, &mesh, &format!("{name}, {what}"));
        };

        let arrays: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
        check("arrays and triples", &arrays, &triangles);
        check("vectors and numbers", &positions, &flat);
        check("short numbers", &arrays, &short);
        let pairs: Vec<[u16; 3]> = triangles.iter().map(|t| t.map(|index| index as u16)).collect();
        check("short triples", &arrays, &pairs);
        for (offset, stride) in [(0, 12), (4, 32), (1, 13), (7, 41)] {
            let bytes: Arc<[u8]> = interleaved(positions, offset, stride).into();
            let strided = Strided::of_bytes(bytes, offset, stride).expect("a sound stride");
            check(&format!("bytes {offset} {stride}"), &strided, &short);
        }
        let numbers: Vec<f32> =
            positions.iter().flat_map(|p| [9.0, p.x, p.y, p.z, f32::NAN]).collect();
        let strided = Strided::of_floats(&numbers, 1, 5).expect("a sound stride");
        check("numbers apart", &strided, &flat);

        // Without indices, and owned.
        let corners: Vec<Vec3> = (0..mesh.len() as u32).flat_map(|t| mesh.corners(t)).collect();
        same_as(&MeshView::soup(corners).expect("a sound soup"), &mesh, name);
        same_as(&Box::new(mesh.clone()), &mesh, name);
        same_as(&Arc::new(mesh.clone()), &mesh, name);
    }
}

#[test]
fn points_of_other_crates_are_points() {
    // One triangle and one ray, as those who use these crates have them.
    let glam = [glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y];
    let aligned = glam.map(glam::Vec3A::from);
    let nalgebra = glam.map(|p| nalgebra::Point3::new(p.x, p.y, p.z));
    let mint = glam.map(|p| mint::Point3 { x: p.x, y: p.y, z: p.z });
    let triangle = vec![[0, 1, 2]];
    let meshes = [
        TriangleMesh::new(glam.to_vec(), triangle.clone()),
        TriangleMesh::new(aligned.to_vec(), triangle.clone()),
        TriangleMesh::new(nalgebra.to_vec(), triangle.clone()),
        TriangleMesh::new(mint.to_vec(), triangle),
    ];
    let [first, ..] = &meshes;
    assert!(meshes.iter().all(|mesh| mesh.is_ok() && mesh == first));
    let views = (MeshView::soup(&glam), MeshView::soup(&nalgebra), MeshView::soup(&mint));
    assert!(views.0.is_ok() && views.1.is_ok() && views.2.is_ok());

    let view = MeshView::soup(&aligned).expect("a triangle");
    let bvh = Bvh::build(&view as &dyn Geometry).expect("it builds");
    let ray = Ray::new(glam::vec3(0.2, 0.2, 1.0), glam::Vec3::NEG_Z);
    let other =
        Ray::new(nalgebra::Point3::new(0.2, 0.2, 1.0), nalgebra::Vector3::new(0.0, 0.0, -1.0));
    assert_eq!(ray, other);
    let hit = bvh.intersect(&ray).expect("it hits");
    let point = glam::Vec3::from(bvh.surface_point(&ray, &hit).position.to_array());
    assert!(point.distance(glam::vec3(0.2, 0.2, 0.0)) < 1e-6);
    let mint = mint::Point3 { x: 0.2f32, y: 0.2, z: 2.0 };
    assert_eq!(bvh.closest_point(mint, 5.0).map(|closest| closest.distance), Some(2.0));
}

#[test]
fn what_is_no_mesh_is_refused() {
    let positions = [[0.0f32; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let new = |indices: &[u16]| MeshView::new(&positions, indices).map(|_| ());
    assert_eq!(new(&[0, 1, 2, 2, 1, 0]), Ok(()));
    assert_eq!(new(&[]), Ok(()));
    assert_eq!(
        new(&[0, 1, 2, 2, 1, 3]),
        Err(MeshError::IndexOutOfRange { triangle: 1, index: 3, positions: 3 })
    );
    let left_over = new(&[0, 1, 2, 0]).expect_err("one is left over");
    assert!(left_over.to_string().starts_with("4 indices,"), "{left_over}");
    let left_over = MeshView::soup(&positions[..2]).expect_err("one is missing");
    assert!(left_over.to_string().starts_with("2 vertices,"), "{left_over}");
    let bad = [[0.0; 3], [f32::NAN; 3], [f32::INFINITY; 3]];
    let error = MeshView::new(&bad, &[0u32, 0, 0][..]).map(|_| ());
    assert_eq!(error, Err(MeshError::NotFinite { first: 1, count: 2 }));

    // Strides, and memory that ends too soon.
    let bytes = interleaved(&positions.map(Vec3::from), 8, 16);
    let error = Strided::of_bytes(&bytes, 0, 11).map(|_| ()).expect_err("they overlap");
    assert_eq!(error.to_string(), "a stride of 11 bytes, but a vertex takes 12");
    let error = Strided::of_floats([0.0f32; 4], 0, 2).map(|_| ()).expect_err("they overlap");
    assert_eq!(error.to_string(), "a stride of 2 numbers, but a vertex takes 3");
    let count = |bytes: &[u8], offset| {
        Strided::of_bytes(bytes, offset, 16).map_or(usize::MAX, |strided| strided.len())
    };
    // What follows the last vertex may be missing, nothing of the vertex itself.
    assert_eq!(count(&bytes, 8), 3);
    assert_eq!(count(&bytes[..bytes.len() - 4], 8), 3);
    assert_eq!(count(&bytes[..bytes.len() - 5], 8), 2);
    assert_eq!(count(&bytes, 44), 1);
    assert_eq!(count(&bytes, 45), 0);
    assert_eq!(count(&bytes, usize::MAX), 0);
    let strided = Strided::of_bytes(&bytes, 8, 16).expect("a sound stride");
    assert_eq!(strided.take(2).map(|fewer| fewer.len()), Ok(2));
    let error = strided.take(4).map(|_| ()).expect_err("there are three");
    assert_eq!(error.to_string(), "4 vertices were asked for, but the memory has 3");
    let huge = Strided::of_bytes(&bytes, 8, usize::MAX).expect("a sound stride");
    assert_eq!((huge.len(), huge.position(0)), (1, Vec3::ZERO));
}

#[test]
fn quads_are_two_triangles_each() {
    // A crumpled sheet: no quad is flat.
    let mut rng = Rng::new(94);
    let side = 20;
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let places = (0..(side + 1) * (side + 1)).map(|n| (n % (side + 1), n / (side + 1)));
    let positions: Vec<Vec3> =
        places.map(|(x, y)| Vec3::new(x as f32, y as f32, 0.0) + 0.3 * rng.in_cube()).collect();
    let quads: Vec<_> = (0..side * side)
        .map(|n| (n % side, n / side))
        .map(|(x, y)| [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)])
        .collect();
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, d], [c, d, b]]).collect();
    let mesh = TriangleMesh::new(positions.clone(), triangles).expect("a sound mesh");
    let sheet = Quads::new(positions.clone(), quads.clone()).expect("sound quads");
    same_as(&sheet, &mesh, "a sheet");

    // A hit's place on its quad is where the corners say it is.
    let bvh = Bvh::build(&sheet as &dyn Geometry).expect("it builds");
    for _ in 0..1000 {
        let from = Vec3::new(rng.range(1.0, 19.0), rng.range(1.0, 19.0), 9.0);
        let ray = Ray::new(from, [0.0, 0.0, -1.0]);
        let hit = bvh.intersect(&ray).expect("no ray slips through");
        let (quad, [u, v]) = sheet.quad(&hit);
        let [a, b, c, d] = sheet.quads()[quad as usize].map(|corner| positions[corner as usize]);
        let expected = if u + v <= 1.0 {
            a + u * (b - a) + v * (d - a)
        } else {
            c + (1.0 - u) * (d - c) + (1.0 - v) * (b - c)
        };
        assert!((ray.at(hit.t) - expected).length() < 1e-5, "{hit:?}");
    }

    let error = Quads::new(positions.clone(), vec![quads[0], [0, 1, 2, 441]]);
    let error = error.expect_err("there is no such vertex");
    assert_eq!(
        error.to_string(),
        "quad 1 uses vertex 441, but there are 441 vertices (0 is the first)"
    );
    let error = Quads::new(vec![[f32::NAN; 3]; 4], vec![[0, 1, 2, 3]]).expect_err("NaN");
    assert_eq!(error, MeshError::NotFinite { first: 0, count: 4 });
    let middle = (1.0 / 3.0) * (positions[0] + positions[1] + positions[22]);
    let triangle = Quads::new(positions, vec![[0, 1, 22, 22]]).expect("a triangle");
    let bvh = Bvh::build(&triangle as &dyn Geometry).expect("it builds");
    assert!(bvh.occluded(&Ray::new(middle + 5.0 * Vec3::Z, [0.0, 0.0, -1.0])));
}
