//! What the tests of file formats share: files made on the spot, and the folder of real ones.

#![allow(dead_code, unreachable_pub)]

use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use raywood::Vec3;
use raywood_scene::{LoadError, LoadOptions, Scene, load_bytes, load_file};

/// A folder of its own for a test, removed at its end.
pub struct Folder(PathBuf);

impl Folder {
    /// An empty folder.
    pub fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("raywood-formats-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// The path of a name in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, contents).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Loads a file made of these bytes.
pub fn load(name: &str, contents: impl AsRef<[u8]>) -> Result<Scene, LoadError> {
    load_as(name, contents, false)
}

/// Loads a file made of these bytes, strictly.
pub fn load_strictly(name: &str, contents: impl AsRef<[u8]>) -> Result<Scene, LoadError> {
    load_as(name, contents, true)
}

fn load_as(name: &str, contents: impl AsRef<[u8]>, strict: bool) -> Result<Scene, LoadError> {
    let folder = Folder::new();
    let path = folder.write(name, contents);
    load_file(&path, &LoadOptions::default().with_strict(strict))
}

/// The error of a file made of these bytes, as printed, from the file's name on.
pub fn error_of(name: &str, contents: impl AsRef<[u8]>) -> String {
    let error = load(name, contents).expect_err("loads").to_string();
    check_error(&error);
    let start = error.find(name).expect("the error names the file");
    error[start..].to_owned()
}

/// An error is one line that names a file.
pub fn check_error(error: &str) {
    assert!(!error.is_empty() && error.len() < 600, "{error}");
    assert!(!error.chars().any(char::is_control), "{error:?} is not one line");
    assert!(error.contains(": "), "{error}");
}

/// Everything that must hold for any scene that was loaded, however broken its file.
pub fn check_scene(scene: &Scene) {
    let mesh = &scene.mesh;
    let (triangles, positions) = (mesh.triangles.triangles(), mesh.triangles.positions());
    assert_eq!(mesh.materials.len(), triangles.len());
    assert!(mesh.materials.iter().all(|&m| (m as usize) < scene.materials.len()));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == positions.len());
    assert!(mesh.colors.is_empty() || mesh.colors.len() == positions.len());
    for coordinates in &mesh.texture_coordinates {
        assert!(coordinates.is_empty() || coordinates.len() == positions.len());
        assert!(coordinates.iter().flatten().all(|x| x.is_finite()));
    }
    assert!(mesh.tangents.is_empty() || mesh.tangents.len() == positions.len());
    for material in &scene.materials {
        let images = material.textures.iter().flat_map(|textures| textures.all());
        assert!(images.into_iter().all(|texture| (texture.image as usize) < scene.images.len()));
    }
    for normal in &mesh.normals {
        let length = normal.length();
        assert!(length == 0.0 || (length - 1.0).abs() < 1e-5, "{normal:?}");
    }
    assert!(mesh.colors.iter().all(|c| c.is_finite() && c.x >= 0.0));
    let is_empty = triangles.is_empty() && scene.sphere_materials.is_empty();
    assert!(!is_empty || !scene.warnings.is_empty());
    for warning in &scene.warnings {
        assert!(!warning.chars().any(char::is_control), "{warning:?} is not one line");
    }
    for material in &scene.materials {
        for color in [material.diffuse, material.specular, material.mirror, material.transmission] {
            assert!(color.is_finite() && color.max_element() <= 1.0001, "{material:?}");
        }
        assert!(material.ior.is_finite() && material.ior >= 1.0, "{material:?}");
        assert!(material.emission.is_finite() && material.absorption.is_finite(), "{material:?}");
    }
    for camera in &scene.cameras {
        assert!(camera.eye.is_finite() && camera.target != camera.eye, "{camera:?}");
    }
    assert!(scene.lights.iter().all(|light| light.intensity.is_finite()));
}

/// Loads a file, strictly and not, and checks what comes of it; whether it loads at all.
pub fn survives(folder: &Folder, name: &str, contents: &[u8]) -> bool {
    let load = |strict| {
        load_bytes(&folder.path(name), contents, &LoadOptions::default().with_strict(strict))
    };
    let outcomes = catch_unwind(|| [load(false), load(true)]);
    let Ok([lax, strict]) = outcomes else { panic!("{name} panics: {contents:?}") };
    for error in [&lax, &strict].into_iter().filter_map(|outcome| outcome.as_ref().err()) {
        check_error(&error.to_string());
    }
    assert!(lax.is_ok() || strict.is_err(), "{name} loads only strictly: {contents:?}");
    lax.iter().for_each(check_scene);
    lax.is_ok()
}

/// The number of triangles.
pub fn triangle_count(scene: &Scene) -> usize {
    scene.mesh.triangles.triangles().len()
}

/// The area of all triangles.
pub fn area(scene: &Scene) -> f32 {
    let mesh = &scene.mesh.triangles;
    (0..triangle_count(scene) as u32)
        .map(|i| {
            let [a, b, c] = mesh.corners(i);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum()
}

/// The volume that a closed mesh holds; negative if its triangles show their insides.
pub fn volume(scene: &Scene) -> f32 {
    let mesh = &scene.mesh.triangles;
    let sixth = |i| {
        let [a, b, c]: [Vec3; 3] = mesh.corners(i);
        a.dot(b.cross(c)) / 6.0
    };
    (0..triangle_count(scene) as u32).map(sixth).sum()
}

/// The folder of real models, if this machine has it.
pub fn real_scenes() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    let folder = std::env::var_os("RAYWOOD_TEST_SCENES").map_or(beside, PathBuf::from);
    // The variable is relative to the workspace, tests run in their crate.
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let found = [folder.clone(), workspace.join(folder)].into_iter().find(|f| f.is_dir());
    if found.is_none() {
        println!("skipped: RAYWOOD_TEST_SCENES names no folder of real models");
    }
    found
}

/// A small deterministic random number generator (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// A number below `limit`.
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % limit as u64) as usize
    }
}

/// A cube from -1 to 1 with its outside outside, as corners and quads.
pub const CUBE: ([[f32; 3]; 8], [[u32; 4]; 6]) = (
    [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
    ],
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
);

/// The cube as a binary PLY file of this byte order, with `i32` indices.
pub fn cube_ply(little: bool) -> Vec<u8> {
    let order = if little { "little" } else { "big" };
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for number in CUBE.0.iter().flatten() {
        file.extend(if little { number.to_le_bytes() } else { number.to_be_bytes() });
    }
    for face in CUBE.1 {
        file.push(4);
        for index in face {
            file.extend(if little { index.to_le_bytes() } else { index.to_be_bytes() });
        }
    }
    file
}

/// Two triangles as a binary STL file.
pub fn square_stl() -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file.extend(2u32.to_le_bytes());
    for corners in [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0f32]]] {
        file.extend([0; 12]);
        for [x, y] in corners {
            file.extend([x, y, 0.0].map(f32::to_le_bytes).concat());
        }
        file.extend([0; 2]);
    }
    file
}

/// A GLB of a JSON and a binary chunk.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    for (size, kind, chunk) in [(json.len(), b"JSON", json), (binary.len(), b"BIN\0", binary)] {
        if file.len() == 4 {
            file.extend(2u32.to_le_bytes());
            file.extend((length as u32).to_le_bytes());
        }
        file.extend((size as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// The cube as the buffer of a glTF file: 96 bytes of positions, then 36 indices of one byte.
pub fn cube_buffer() -> Vec<u8> {
    let mut buffer: Vec<u8> = CUBE.0.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    for [a, b, c, d] in CUBE.1 {
        buffer.extend([a, b, c, a, c, d].map(|i| i as u8));
    }
    buffer
}

/// The JSON of the cube, with these members besides.
pub fn cube_json(more: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},{more}
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"buffers":[{{"byteLength":132}}],
"bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":36}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[-1,-1,-1],"max":[1,1,1]}},
{{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"}}]}}"#
    )
}

/// A PNG of these texels.
pub fn png(width: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, texels.len() as u32 / width);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(texels.as_flattened()).unwrap();
    bytes
}

/// A gray JPEG of one block of 8 x 8 texels, 64 brighter than the middle: the constant coefficient alone, by tables of one code each.
pub fn jpeg() -> Vec<u8> {
    let mut bytes = vec![0xff, 0xd8];
    bytes.extend([0xff, 0xdb, 0, 67, 0]);
    bytes.extend([1; 64]);
    bytes.extend([0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0]);
    // The constant coefficient has 10 bits; all others end at once.
    for (class, symbol) in [(0x00, 10), (0x10, 0)] {
        bytes.extend([0xff, 0xc4, 0, 20, class, 1]);
        bytes.extend([0; 15]);
        bytes.push(symbol);
    }
    bytes.extend([0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0]);
    // Code 0, the ten bits of 512, code 0, and ones to the end of the byte.
    bytes.extend([0b0100_0000, 0b0000_1111, 0xff, 0xd9]);
    bytes
}

/// A square of two triangles with both sets of texture coordinates and a tangent, materials and images as given; `images` are the buffer's further
/// contents.
pub fn textured_square(more: &str, images: &[&[u8]]) -> Vec<u8> {
    let floats: &[f32] = &[
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, // first set
        0.0, 0.5, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0, // second set
        2.0, 0.0, 0.0, -1.0, 2.0, 0.0, 0.0, -1.0, 2.0, 0.0, 0.0, -1.0, 2.0, 0.0, 0.0, -1.0,
    ];
    let mut buffer: Vec<u8> = floats.iter().flat_map(|f| f.to_le_bytes()).collect();
    buffer.extend([0, 1, 2, 0, 2, 3, 0, 0]);
    let views = [(0, 48), (48, 32), (80, 32), (112, 64), (176, 6)];
    let mut views: Vec<String> = views
        .map(|(start, length)| {
            format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}}}"#)
        })
        .into();
    for image in images {
        let (start, length) = (buffer.len(), image.len());
        views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}}}"#));
        buffer.extend_from_slice(image);
    }
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},{more}"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"material":0,"indices":4,
        "attributes":{{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2,"TANGENT":3}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"}},
        {{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}},
        {{"bufferView":3,"componentType":5126,"count":4,"type":"VEC4"}},
        {{"bufferView":4,"componentType":5121,"count":6,"type":"SCALAR"}}],
        "buffers":[{{"byteLength":{}}}],"bufferViews":[{}]}}"#,
        buffer.len(),
        views.join(",")
    );
    glb(&json, &buffer)
}
