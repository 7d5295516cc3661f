//! Saved trees: what comes back is what was saved, and damage is found.

use std::io::ErrorKind;

use raywood::{
    AccelerationStructure, BuildOptions, BuildPreset, Bvh, Joined, Ray, SavedTree, SavedTreeError,
    SimdLevel, Spheres, StructureKind, TriangleMesh, TriangleTest, Vec3,
};
use raywood_testkit::saved::Forgery;
use raywood_testkit::{Rng, nasty, rays, shapes};

/// The bytes of a tree over a mesh.
fn saved(mesh: &TriangleMesh, options: &BuildOptions) -> Vec<u8> {
    let mut file = Vec::new();
    Bvh::build_with(mesh, options).expect("it builds").save(&mut file).expect("it is saved");
    file
}

/// A mesh of some nodes, for tests that look at every byte.
fn small() -> Vec<u8> {
    saved(&shapes::soup(70, 0.3, 1), &BuildPreset::Best.options())
}

#[test]
fn all_comes_back_to_the_bit() {
    let fast = BuildOptions { triangle_test: TriangleTest::Fast, ..BuildOptions::default() };
    let options = BuildPreset::ALL.iter().map(|preset| preset.options()).chain([fast]);
    let options: Vec<_> = options.collect();
    let mut parts = 0;
    for (number, nasty) in nasty::all().iter().enumerate() {
        let rays = rays::against(&nasty.mesh, 600, number as u64);
        for options in &options {
            let built = Bvh::build_with(&nasty.mesh, options).expect("it builds");
            let mut file = Vec::new();
            built.save(&mut file).expect("it is saved");
            parts +=
                usize::from(Forgery::of(&file).sections.iter().any(|(name, _)| name == "parts"));

            let saved = SavedTree::open(file).expect("it is sound");
            assert_eq!(saved.mesh(), &nasty.mesh, "{}", nasty.name);
            assert_eq!(saved.tree(), built.tree(), "{}", nasty.name);
            let loaded = saved.bvh(saved.mesh()).expect("it is its own");
            loaded.validate().unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
            let (mut expected, mut hits) = (vec![None; rays.len()], vec![None; rays.len()]);
            built.intersect_batch(&rays, &mut expected);
            loaded.intersect_batch(&rays, &mut hits);
            assert_eq!(hits, expected, "{}", nasty.name);
            for ray in &rays {
                assert_eq!(loaded.intersect(ray), built.intersect(ray), "{}", nasty.name);
                assert_eq!(loaded.occluded(ray), built.occluded(ray), "{}", nasty.name);
            }
        }
    }
    assert!(parts > 2, "spatial splits are among them: {parts}");
}

#[test]
fn random_trees_come_back() {
    let mut rng = Rng::new(77);
    for round in 0..200 {
        let (count, size) = (rng.below(400), 10f32.powf(rng.range(-6.0, 3.0)));
        let options = BuildOptions {
            wide_leaf_size: 1 + rng.below(8),
            max_leaf_size: 1 + rng.below(8),
            spatial_splits: if rng.below(2) == 0 { 0.0 } else { 2.0 },
            ..BuildPreset::ALL[rng.below(5)].options()
        };
        let mesh = shapes::soup(count, size, round);
        let built = Bvh::build_with(&mesh, &options).expect("it builds");
        let mut file = Vec::new();
        built.save(&mut file).expect("it is saved");
        let again = Forgery::of(&file).file();
        assert!(file == again, "as the format says, to the byte");
        let loaded = Bvh::load(file).expect("it is sound");
        assert_eq!((loaded.tree(), loaded.geometry()), (built.tree(), &mesh), "{options:?}");
    }
}

#[test]
fn spheres_come_back_with_and_without_triangles() {
    let mesh = shapes::grid_box(3, Vec3::splat(-1.0), Vec3::ONE);
    let mut rng = Rng::new(3);
    let spheres = (0..60).map(|_| (2.0 * rng.in_cube(), 0.3 * rng.unit())).collect();
    let spheres = Spheres::new(spheres).expect("spheres");
    let joined = Joined { first: &mesh, second: &spheres };
    let rays: Vec<_> =
        (0..2000).map(|_| Ray::between(4.0 * rng.direction(), rng.in_cube())).collect();

    let mut file = Vec::new();
    let built = Bvh::build(joined).expect("it builds");
    built.save(&mut file).expect("it is saved");
    let error = Bvh::load(file.clone()).expect_err("not triangles alone").to_string();
    assert_eq!(error, "the tree is over 108 triangles and 60 spheres, expected triangles alone");
    let saved = SavedTree::open(file).expect("it is sound");
    assert_eq!((saved.mesh(), saved.spheres()), (&mesh, &spheres));
    let loaded = saved.bvh(Joined { first: saved.mesh(), second: saved.spheres() });
    let loaded = loaded.expect("it is its own");
    let is_sphere = |ray: &&Ray| loaded.intersect(ray).is_some_and(|hit| hit.primitive >= 108);
    assert!(rays.iter().filter(is_sphere).count() > 100);
    for ray in &rays {
        assert_eq!(loaded.intersect(ray), built.intersect(ray));
    }
    let error = saved.bvh(saved.mesh()).expect_err("the spheres are missing").to_string();
    assert_eq!(error, "the tree is over 168 primitives, expected 108 primitives");

    let mut file = Vec::new();
    let built = Bvh::build(&spheres).expect("it builds");
    built.save(&mut file).expect("it is saved");
    let saved = SavedTree::open(file).expect("it is sound");
    let loaded = saved.bvh(saved.spheres()).expect("it is its own");
    assert!(saved.mesh().triangles().is_empty());
    for ray in &rays {
        assert_eq!(loaded.intersect(ray), built.intersect(ray));
    }
}

#[test]
fn a_saved_tree_is_a_structure() {
    let mesh = shapes::soup(500, 0.2, 8);
    let saved = SavedTree::open(saved(&mesh, &BuildOptions::default())).expect("it is sound");
    let mut structure = saved.structure(saved.mesh()).expect("it is its own");
    assert_eq!(structure.kind(), StructureKind::BvhWide);
    let built = Bvh::build(&mesh).expect("it builds");
    for &level in SimdLevel::ALL {
        structure.set_simd_level(level);
        for ray in rays::against(&mesh, 200, 4) {
            assert_eq!(structure.intersect(&ray), built.intersect(&ray));
        }
    }
}

#[test]
fn the_bytes_depend_on_the_tree_alone() {
    let mesh = shapes::soup(30_000, 0.1, 5);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let [one, three] =
        [1, 3].map(|threads| pool(threads).install(|| saved(&mesh, &BuildPreset::Best.options())));
    assert!(one == three);
    // Another level of instructions traces the tree; it is not part of it.
    let mut portable = Bvh::build_with(&mesh, &BuildPreset::Best.options()).expect("it builds");
    portable.set_simd_level(SimdLevel::Portable);
    let mut file = Vec::new();
    portable.save(&mut file).expect("it is saved");
    assert!(one == file);
    let loaded = Bvh::load(file).expect("it is sound");
    assert_eq!(loaded.simd_level(), SimdLevel::active());
}

/// Bytes that begin at an address which is so far from a multiple of 64.
struct Moved {
    bytes: Vec<u8>,
    start: usize,
}

impl Moved {
    fn by(offset: usize, file: &[u8]) -> Self {
        let mut bytes = vec![0; file.len() + 128];
        let start = bytes.as_ptr().align_offset(64) + offset;
        bytes[start..start + file.len()].copy_from_slice(file);
        bytes.truncate(start + file.len());
        Self { bytes, start }
    }
}

impl AsRef<[u8]> for Moved {
    fn as_ref(&self) -> &[u8] {
        &self.bytes[self.start..]
    }
}

#[test]
fn aligned_memory_is_used_where_it_is() {
    let mesh = shapes::soup(300, 0.2, 9);
    let file = saved(&mesh, &BuildOptions::default());
    let built = Bvh::build(&mesh).expect("it builds");
    for offset in [0, 1, 4, 8, 63] {
        let moved = Moved::by(offset, &file);
        let memory = moved.as_ref().as_ptr_range();
        let loaded = Bvh::load(moved).expect("it is sound");
        let is_in_place = memory.contains(&loaded.geometry().positions().as_ptr().cast());
        assert_eq!(is_in_place, offset % 4 == 0, "moved by {offset}");
        assert_eq!(loaded.tree(), built.tree(), "moved by {offset}");
        // What is in place needs the owner of the memory, which a clone holds too.
        let clone = loaded.clone();
        drop(loaded);
        clone.validate().expect("it is valid");
    }
}

#[test]
fn nothing_can_be_saved() {
    let empty = TriangleMesh::default();
    let file = saved(&empty, &BuildOptions::default());
    let loaded = Bvh::load(file).expect("it is sound");
    assert!(!loaded.occluded(&Ray::new([0.0; 3], [0.0, 0.0, 1.0])));
    assert_eq!(loaded.tree(), Bvh::build(&empty).expect("it builds").tree());
    assert_eq!(loaded.tree().primitives(), 0);
}

#[test]
fn sections_besides_come_back() {
    let bvh = Bvh::build(shapes::soup(10, 0.3, 2)).expect("it builds");
    let mut file = Vec::new();
    let large = vec![7; 3 << 20];
    let besides: [(&str, &[u8]); 3] = [("my.notes-2", b"some"), ("empty", b""), ("x", &large)];
    bvh.save_with(&besides, &mut file).expect("it is saved");
    let saved = SavedTree::open(file).expect("it is sound");
    for (name, bytes) in besides {
        assert_eq!(saved.section(name), Some(bytes));
    }
    assert_eq!(saved.section("other"), None);
    let names: Vec<_> = saved.sections().map(|(name, _)| name).collect();
    let expected = ["tree", "nodes", "positions", "triangles", "my.notes-2", "empty", "x"];
    assert_eq!(names, expected);
    assert!(format!("{saved:?}").contains("\"my.notes-2\": 4"));

    for names in
        [&["nodes"][..], &[""], &["a name"], &["Upper"], &["seventeen-letters"], &["a", "a"]]
    {
        let besides: Vec<_> = names.iter().map(|&name| (name, &b""[..])).collect();
        let error = bvh.save_with(&besides, Vec::new()).expect_err("a wrong name");
        assert_eq!(error.kind(), ErrorKind::InvalidInput, "{names:?}");
    }
    let names: Vec<_> = (0..300).map(|number| format!("n{number}")).collect();
    let besides: Vec<_> = names.iter().map(|name| (&**name, &b""[..])).collect();
    assert!(bvh.save_with(&besides, Vec::new()).is_err(), "too many");
    bvh.save_with(&besides[..250], Vec::new()).expect("not too many");
}

#[test]
fn a_writer_that_fails_is_told_of() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let bvh = Bvh::build(shapes::soup(10, 0.3, 2)).expect("it builds");
    assert_eq!(bvh.save(Full).expect_err("it is full").kind(), ErrorKind::StorageFull);
}

#[test]
fn every_cut_is_found() {
    let file = small();
    for length in 0..file.len() {
        let error = Bvh::load(file[..length].to_vec()).expect_err("it is cut off");
        let is_told = match error {
            SavedTreeError::NotASavedTree => length < 8,
            SavedTreeError::Length { expected, found } => {
                found == length as u64 && expected > found
            }
            _ => false,
        };
        assert!(is_told, "{length} bytes: {error}");
    }
    let mut longer = file;
    longer.push(0);
    assert!(matches!(Bvh::load(longer), Err(SavedTreeError::Length { .. })));
}

#[test]
fn every_flipped_bit_is_found() {
    let file = small();
    for byte in 0..file.len() {
        let mut damaged = file.clone();
        damaged[byte] ^= 1 << (byte % 8);
        let error = Bvh::load(damaged).expect_err("it is damaged");
        assert_eq!(
            matches!(error, SavedTreeError::NotASavedTree),
            byte < 8,
            "byte {byte}: {error}"
        );
        assert_eq!(
            matches!(error, SavedTreeError::Version { .. }),
            (8..12).contains(&byte),
            "byte {byte}: {error}"
        );
    }
}

#[test]
fn other_versions_are_refused_by_name() {
    let mut forgery = Forgery::of(&small());
    let mut error = |version| {
        forgery.version = version;
        Bvh::load(forgery.file()).expect_err("another version").to_string()
    };
    assert_eq!(
        error(0),
        "is a saved tree of version 0 of the format, an older one; expected version 1; save it again from its model"
    );
    assert!(error(2).contains("version 2 of the format, a newer one; expected version 1"));
    // Whatever the rest of the header may be in another version.
    let mut file = forgery.file();
    file[12..64].fill(0xff);
    assert_eq!(Bvh::load(file).expect_err("it is"), SavedTreeError::Version { found: 2 });
}

#[test]
fn foreign_files_are_told_from_damaged_ones() {
    for foreign in [&b""[..], b"ply\nformat ascii 1.0\n", b"\x89PNG\r\n\x1a\n", b"glTF\x02\0\0\0"] {
        let error = Bvh::load(foreign.to_vec()).expect_err("no tree");
        assert_eq!(error, SavedTreeError::NotASavedTree);
    }
    // What a transfer as text does.
    let text = small().split(|&byte| byte == b'\r').flatten().copied().collect::<Vec<_>>();
    assert_eq!(Bvh::load(text).expect_err("damaged"), SavedTreeError::NotASavedTree);
}
