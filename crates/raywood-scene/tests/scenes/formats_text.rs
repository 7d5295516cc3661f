//! OBJ, MTL, PLY and STL: known contents, known counts, and what is said about faults.

use crate::formats_support::{
    CUBE, Folder, area, check_scene, cube_ply, error_of, load, load_strictly, square_stl,
    triangle_count, volume,
};
use raywood::Vec3;
use raywood_scene::{LoadOptions, Material, Place, load_file, srgb_to_linear};

/// The cube as OBJ statements, with this between vertices and faces.
fn cube_obj(between: &str) -> String {
    let mut obj = String::new();
    for [x, y, z] in CUBE.0 {
        obj += &format!("v {x} {y} {z}\n");
    }
    obj += between;
    for [a, b, c, d] in CUBE.1 {
        obj += &format!("f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1);
    }
    obj
}

#[test]
fn obj_cube() {
    let scene = load("cube.obj", cube_obj("")).unwrap();
    check_scene(&scene);
    assert_eq!(triangle_count(&scene), 12);
    assert_eq!(scene.mesh.triangles.positions().len(), 8);
    assert_eq!(scene.bounds().min, Vec3::splat(-1.0));
    assert_eq!(scene.bounds().max, Vec3::splat(1.0));
    assert!((volume(&scene) - 8.0).abs() < 1e-5);
    assert_eq!(scene.name, "cube.obj");
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(scene.materials, [Material::default()]);
}

#[test]
fn obj_forms_of_indices_and_lines() {
    let text = "v 0 0 0\r\nv 1 0 0 1.0\r\n  v\t1 1 0\\\r\n\r\nv 0 \\\n 1 0 # the last\nvn 0 0 2\nvt 0 0\n\
        f 1/1 2/1 3/1\nf 1//1 2//-1 3//1\nf -4/1/1 -3/-1/-1 -1/1/1\nf 1 2\\\n 3 4 # all\n# f 9 9 9 \\\nf 1 2 3";
    let scene = load("forms.obj", text).unwrap();
    check_scene(&scene);
    assert_eq!(triangle_count(&scene), 6);
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(area(&scene), 3.0);

    // Corners with and without a normal are different vertices.
    let triangles = scene.mesh.triangles.triangles();
    let normal = |triangle: usize| scene.mesh.normals[triangles[triangle][0] as usize];
    assert_eq!([normal(0), normal(1), normal(2)], [Vec3::ZERO, Vec3::Z, Vec3::Z]);
    assert_eq!(scene.mesh.triangles.positions().len(), 4 + 4);
}

#[test]
fn obj_concave_polygon_keeps_its_area() {
    // An L, wound clockwise from its inner corner.
    let text = "v 1 1 5\nv 1 2 5\nv 0 2 5\nv 0 0 5\nv 2 0 5\nv 2 1 5\nf 1 2 3 4 5 6\n";
    let scene = load("l.obj", text).unwrap();
    assert_eq!(triangle_count(&scene), 4);
    assert!((area(&scene) - 3.0).abs() < 1e-6);
}

#[test]
fn obj_colors_are_srgb() {
    let text = "v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 0 0 0\nf 1 2 3\n";
    let scene = load("colors.obj", text).unwrap();
    let half = srgb_to_linear(0.5);
    assert_eq!(scene.mesh.colors, [Vec3::ONE, Vec3::new(1.0, half, 0.0), Vec3::ZERO]);
    assert_eq!(scene.materials[0].diffuse, Vec3::ONE);

    let text = "v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 0 0 255\nf 1 2 3\n";
    let scene = load("bytes.obj", text).unwrap();
    assert_eq!(scene.mesh.colors, [Vec3::X, Vec3::Y, Vec3::Z]);
    assert!(scene.warnings[0].contains("above 1"), "{:?}", scene.warnings);
}

#[test]
fn obj_faults_name_their_line() {
    let prefix = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let cases = [
        ("f 1 2 4\n", "t.obj:4: face uses vertex 4, but only 3 vertices precede it"),
        ("\nf 1 2 -4\n", "t.obj:5: face uses vertex -4, but only 3 vertices precede it"),
        ("f 0 1 2\n", "t.obj:4: face uses vertex 0, but the first vertex is 1"),
        ("f 1 2 x\n", "t.obj:4: found `x`, expected a vertex index"),
        ("f 1 2 3.5\n", "t.obj:4: found `3.5`, expected a corner like 7, 7/3, 7//5 or 7/3/5"),
        ("v 1 2\n", "t.obj:4: the line ends, expected a number (x, y and z)"),
        ("v 1 2", "t.obj:4: the file ends, expected a number (x, y and z)"),
        ("v 1 2 3e\n", "t.obj:4: found `3e`, expected a number (x, y and z)"),
        ("f 99999999999999999999 1 2\n", "t.obj:4: face uses vertex 9223372036854775807"),
    ];
    for (text, expected) in cases {
        let error = error_of("t.obj", format!("{prefix}{text}"));
        assert!(error.starts_with(expected), "{text:?}: {error}, expected {expected}");
    }
}

#[test]
fn obj_mended_faults_are_counted_or_refused() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 1\nv 1 -1.#INF 2\nf 1 2 3\nf 1 2 4\nf 3 2 5\nf 1 2\nf 1//7 2//1 3\nl 1 2\nvw 1\n";
    let scene = load("faults.obj", text).unwrap();
    check_scene(&scene);
    assert_eq!(triangle_count(&scene), 2);
    assert_eq!(
        scene.warnings,
        [
            "2 vertices are NaN or infinite (the first: line 4): the triangles that use them are left out",
            "1 face has fewer than three vertices (line 9): left out",
            "2 face corners name a normal that does not precede them (the first: line 10): shaded flat there",
            "1 line statement left out: only faces are shown",
            "statements left out because they are not known here: `vw` (1)",
        ]
    );
    let error = load_strictly("faults.obj", text).unwrap_err();
    assert_eq!(*error.place(), Place::Line(4));
    assert_eq!(error.message(), "vertex is NaN or infinite");
}

#[test]
fn obj_of_something_else_is_refused() {
    let error = error_of("text.obj", "Dear reader,\nthis is a letter.\n");
    assert!(error.starts_with("text.obj:1: found `Dear`, expected an OBJ statement"), "{error}");
}

#[test]
fn mtl_materials() {
    let folder = Folder::new();
    let obj = cube_obj("mtllib no such.mtl\nmtllib my materials.mtl\nusemtl  red paint\n");
    let faces = "usemtl mirror\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl veil\nf 1 2 3\nusemtl chalk\nf 1 2 3\n";
    let path = folder.write("model.obj", obj + faces);
    folder.write(
        "my materials.mtl",
        "Kd 9 9 9\nnewmtl red paint\nKd 0.8 0.1 0.1 # red\nKs 0.5\nNs 200\nKe 1 2 3\nillum 2\nmap_Kd -s 1 1 1 paint.png\n\
         newmtl mirror\r\nKd 0 0 0\r\nKs 0.9 0.9 0.8\r\nillum 3\r\n\
         newmtl glass\nNi 1.5\nTf 0.9 1 0.9\nillum 7\n\
         \tnewmtl veil\n\tTr 0.25\n\tKd 1 7 1\n\tNi 1.5\n\tillum 2\nd wrong\n",
    );
    let scene = load_file(&path, &LoadOptions::default()).unwrap();
    check_scene(&scene);

    let [red, mirror, glass, veil, chalk] = &scene.materials[..] else {
        panic!("{:?}", scene.materials)
    };
    assert_eq!(red.name, "red paint");
    assert_eq!(red.diffuse, Vec3::new(0.8, 0.1, 0.1));
    assert_eq!((red.specular, red.shininess), (Vec3::splat(0.5), 200.0));
    assert_eq!(red.emission, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!((red.mirror, red.transmission), (Vec3::ZERO, Vec3::ZERO));
    assert_eq!(mirror.mirror, Vec3::new(0.9, 0.9, 0.8));
    assert_eq!((glass.ior, glass.transmission), (1.5, Vec3::new(0.9, 1.0, 0.9)));
    assert_eq!(glass.diffuse, Vec3::ZERO);
    assert_eq!((veil.ior, veil.transmission), (1.0, Vec3::splat(0.25)));
    assert_eq!(veil.diffuse, Vec3::splat(0.75));
    assert_eq!(chalk.diffuse, Material::default().diffuse);

    assert_eq!(scene.mesh.materials[..12], [0; 12]);
    assert_eq!(scene.mesh.materials[12..], [1, 2, 3, 4]);
    let said = scene.warnings.join("\n");
    for expected in [
        "line 9: material file `no such.mtl` is not there",
        "the image `paint.png` is not there: colours are shown as a magenta checker",
        "my materials.mtl: line 22: found `wrong`, expected a number: left at its default",
        "1 material is not defined by any file (`chalk`): shown in grey",
    ] {
        assert!(said.contains(expected), "{expected:?} is not in\n{said}");
    }
}

#[test]
fn ply_of_every_encoding() {
    let mut text = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 8\nproperty double z\nproperty list uchar short junk\nproperty float y\nproperty float32 x\nelement other 1\nproperty list int8 float more\nelement face 6\nproperty uchar flag\nproperty list uint8 uint vertex_index\nend_header\n".to_owned();
    for [x, y, z] in CUBE.0 {
        text += &format!(" {z} 2 7 -7 {y}\t{x} \n\n");
    }
    text += "3 1 2 3\n";
    for [a, b, c, d] in CUBE.1 {
        text += &format!("1 4 {a} {b} {c} {d}\r\n");
    }
    for file in [text.into_bytes(), cube_ply(true), cube_ply(false)] {
        let scene = load("cube.ply", file).unwrap();
        check_scene(&scene);
        assert_eq!(triangle_count(&scene), 12);
        assert_eq!(scene.mesh.triangles.positions().len(), 8);
        assert!((volume(&scene) - 8.0).abs() < 1e-5);
    }
}

#[test]
fn ply_faces_before_vertices_normals_colors_and_strips() {
    let text = "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nelement vertex 4\nproperty uchar blue\nproperty uchar green\nproperty uchar red\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
        8 0 1 2 3 -1 1 3 2\n0 0 255 0 0 2 0 0 0\n0 255 0 0 0 2 1 0 0\n255 0 0 0 0 2 0 1 0\n0 188 0 0 0 0 1 1 0\n";
    let scene = load("strips.ply", text).unwrap();
    check_scene(&scene);
    assert_eq!(scene.mesh.triangles.triangles(), [[0, 1, 2], [2, 1, 3], [1, 3, 2]]);
    let green = Vec3::new(0.0, srgb_to_linear(188.0 / 255.0), 0.0);
    assert_eq!(scene.mesh.colors, [Vec3::X, Vec3::Y, Vec3::Z, green]);
    assert_eq!(scene.mesh.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::ZERO]);
    assert_eq!(scene.materials[0].diffuse, Vec3::ONE);
}

#[test]
fn ply_faults_name_their_place() {
    let header = |encoding: &str, vertices: &str, faces: &str| {
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    let cases = [
        (header("ascii", "4294967296", "1") + points, "t.ply:3: the header promises 4294967296"),
        (
            header("binary_little_endian", "4294967295", "0"),
            "t.ply:3: the header promises 4294967295",
        ),
        (header("binary_big_endian", "0", "99999999999999999999"), "t.ply:7: the header promises"),
        (header("ascii", "-1", "0"), "t.ply:3: "),
        (
            header("ascii", "3", "1") + points + "3 0 1 3\n",
            "t.ply:13: face uses vertex 3, but there are 3",
        ),
        (header("ascii", "3", "1") + points + "3 0 1 -1\n", "t.ply:13: face uses a negative"),
        (
            header("ascii", "3", "2") + points + "3 0 1\n3 0 1 2\n",
            "t.ply:13: the line ends, expected a number (vertex_indices",
        ),
        (
            header("ascii", "3", "1") + points + "3 0 1 2 5\n",
            "t.ply:13: found `5`, expected the end of the line",
        ),
        (
            header("ascii", "3", "1") + points + "255 0 1 2\n",
            "t.ply:13: a list of 255 values, but only",
        ),
        (
            header("ascii", "3", "1") + points + "         ",
            "t.ply:13: the file ends, but the header promises 1",
        ),
        (
            header("ascii", "3", "1") + "0 0 0\n1 0 a\n0 1 0\n3 0 1 2",
            "t.ply:11: found `a`, expected a number (z of vertex)",
        ),
        (header("utf8", "3", "1"), "t.ply:2: found `utf8`, expected ascii"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\n".to_owned(),
            "t.ply:4: the file ends within its header",
        ),
        ("ply\nproperty float x\n".to_owned(), "t.ply:2: a property before any element"),
        (
            "ply\nformat ascii 1.0\nelement a 1\nproperty vec3 x\n".to_owned(),
            "t.ply:4: found `vec3`, expected a type",
        ),
        ("ply\nend_header\n".to_owned(), "t.ply:2: the header ends without a format"),
        ("solid\n".to_owned(), "t.ply:1: found `solid`, expected `ply`"),
    ];
    for (text, expected) in cases {
        let error = error_of("t.ply", &text);
        assert!(error.starts_with(expected), "{text:?}: {error}, expected {expected}");
    }
    let element = "n".repeat(900);
    let long =
        format!("ply\nformat ascii 1.0\nelement {element} 4\nproperty float x\nend_header\n1\n");
    let error = error_of("t.ply", &long);
    assert!(error.contains(&format!("promises 4 of element {}...,", &element[..40])), "{error}");

    // Binary: one index out of range, and a list that reaches past the end.
    let mut file = cube_ply(true);
    let first_face = file.len() - 6 * 17;
    file[first_face + 1] = 8;
    let expected = format!("t.ply: byte {first_face}: face uses vertex 8, but there are 8");
    assert!(error_of("t.ply", &file).starts_with(&expected), "{}", error_of("t.ply", &file));
    file[first_face + 1] = 0;
    file[first_face] = 255;
    let expected = format!("t.ply: byte {}: the file ends within an element face", first_face + 1);
    assert!(error_of("t.ply", &file).starts_with(&expected), "{}", error_of("t.ply", &file));
}

#[test]
fn ply_mended_faults_are_counted_or_refused() {
    let mut file = cube_ply(true);
    let first_vertex = file.len() - 6 * 17 - 8 * 12;
    file[first_vertex..first_vertex + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    file.extend(b"tail");
    let scene = load("nan.ply", &file).unwrap();
    check_scene(&scene);
    // Three quads meet in a corner; of each, the triangles with the corner are gone.
    assert_eq!(triangle_count(&scene), 12 - 3 * 2 + scene_triangles_without_corner(&scene));
    assert!(
        scene.warnings[0].starts_with("1 vertex is NaN or infinite (byte"),
        "{:?}",
        scene.warnings
    );
    assert_eq!(scene.warnings[1], "4 bytes after the last element are left out");
    let error = load_strictly("nan.ply", &file).unwrap_err();
    assert_eq!(*error.place(), Place::Byte(first_vertex));
}

/// How many triangles of the three quads at corner 0 do not use it.
fn scene_triangles_without_corner(scene: &raywood_scene::Scene) -> usize {
    let quads = CUBE.1.iter().filter(|quad| quad.contains(&0));
    let is_within = |t: &[u32; 3], q: &[u32; 4]| t.iter().all(|i| q.contains(i));
    let triangles = scene.mesh.triangles.triangles();
    assert!(triangles.iter().flatten().all(|&i| i != 0));
    quads.map(|quad| triangles.iter().filter(|t| is_within(t, quad)).count()).sum()
}

#[test]
fn stl_binary_and_text() {
    let mut solid = square_stl();
    solid[..5].copy_from_slice(b"solid");
    let mut long = square_stl();
    long.extend(b"trailing");
    let text = "solid square\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 -0\n   vertex 1 1 0\n  endloop\n endfacet\n FACET NORMAL nan 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1e0 1 0\n   VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\nendsolid square\n";
    for file in [square_stl(), solid, long, text.as_bytes().to_vec()] {
        let scene = load("square.stl", file).unwrap();
        check_scene(&scene);
        assert_eq!(triangle_count(&scene), 2);
        assert_eq!(scene.mesh.triangles.positions().len(), 4, "vertices are shared");
        assert_eq!(area(&scene), 1.0);
    }
    assert_eq!(load("s.stl", square_stl()).unwrap().warnings, [""; 0]);
    let endless = text.replace("endsolid square", "");
    let scene = load("s.stl", &endless).unwrap();
    assert!(scene.warnings[0].contains("without endsolid"), "{:?}", scene.warnings);
    assert!(load_strictly("s.stl", &endless).is_err());
}

#[test]
fn stl_faults_name_their_place() {
    let file = square_stl();
    let cut = error_of("t.stl", &file[..file.len() - 1]);
    assert!(
        cut.starts_with("t.stl: byte 183: the file ends: 2 facets promised, 1 are whole"),
        "{cut}"
    );
    let mut huge = file.clone();
    huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let huge = error_of("t.stl", huge);
    assert!(huge.contains("4294967295 facets promised"), "{huge}");
    let text = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n";
    let error = error_of("t.stl", text);
    assert_eq!(error, "t.stl:4: the line ends, expected a number (x, y and z)");
    let error = error_of("t.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n");
    assert!(error.starts_with("t.stl:5: the file ends within a facet"), "{error}");
    assert!(error_of("t.stl", "hello").starts_with("t.stl: byte 5: the file ends"));

    let mut file = square_stl();
    file[96..100].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let scene = load("t.stl", &file).unwrap();
    assert_eq!(triangle_count(&scene), 1);
    assert!(scene.warnings[0].starts_with("1 vertex is NaN or infinite (byte 84)"));
    assert_eq!(*load_strictly("t.stl", &file).unwrap_err().place(), Place::Byte(84));
}

#[test]
fn welding_is_exact_for_many_vertices() {
    // A strip of 3,000 quads, each as two triangles on its own.
    let mut file = vec![0; 80];
    file.extend(6000u32.to_le_bytes());
    for i in 0..3000 {
        let x = i as f32 * 0.1;
        let next = (i + 1) as f32 * 0.1;
        for corners in [[[x, 0.0], [next, 0.0], [next, 1.0]], [[x, 0.0], [next, 1.0], [x, 1.0]]] {
            file.extend([0; 12]);
            file.extend(corners.map(|[x, y]| [x, y, 0.0].map(f32::to_le_bytes).concat()).concat());
            file.extend([0; 2]);
        }
    }
    let scene = load("strip.stl", file).unwrap();
    assert_eq!(triangle_count(&scene), 6000);
    assert_eq!(scene.mesh.triangles.positions().len(), 6002);
    assert!((area(&scene) - 300.0).abs() < 0.1);
}
