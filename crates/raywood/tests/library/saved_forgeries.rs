//! Saved trees that no honest writer writes, all checksums right: none makes loading or any query panic, hang or answer with primitives that are not there.

use std::fs;
use std::panic::catch_unwind;
use std::path::Path;

use raywood::{BuildOptions, BuildPreset, Bvh, Joined, SavedTree, Spheres};
use raywood_testkit::saved::{Forgery, ask_everything, correct_checksums};
use raywood_testkit::{Rng, shapes};

/// How many of the triangles are small ones, which are not cut.
const SMALL: u32 = 160;

/// A tree over some triangles, with parts.
fn honest() -> Forgery {
    let mesh = shapes::beams(SMALL as usize, 40);
    let options = BuildOptions { spatial_splits: 4.0, ..BuildPreset::Best.options() };
    let mut file = Vec::new();
    Bvh::build_with(mesh, &options).expect("it builds").save(&mut file).expect("it is saved");
    let forgery = Forgery::of(&file);
    assert!(forgery.sections.iter().any(|(name, _)| name == "parts"));
    forgery
}

/// A tree over triangles and spheres.
fn mixed() -> Forgery {
    let mesh = shapes::soup(40, 0.5, 1);
    let mut rng = Rng::new(2);
    let spheres = (0..40).map(|_| (rng.in_cube(), 0.2 * rng.unit())).collect();
    let spheres = Spheres::new(spheres).expect("spheres");
    let mut file = Vec::new();
    let joined = Joined { first: mesh, second: spheres };
    Bvh::build(joined).expect("it builds").save(&mut file).expect("it is saved");
    Forgery::of(&file)
}

/// Why a file is refused.
fn refusal(forgery: &Forgery) -> String {
    SavedTree::open(forgery.file()).expect_err("it is refused").to_string()
}

/// Loads a file and asks it everything if it loads; whether it did.
fn survives(file: Vec<u8>, seed: u64) -> bool {
    let outcome = catch_unwind(|| {
        let Ok(saved) = SavedTree::open(file.clone()) else { return false };
        if saved.spheres().as_slice().is_empty() {
            ask_everything(&saved.bvh(saved.mesh()).expect("it is its own"), seed);
        } else {
            let joined = Joined { first: saved.mesh(), second: saved.spheres() };
            ask_everything(&saved.bvh(joined).expect("it is its own"), seed);
        }
        true
    });
    outcome.unwrap_or_else(|_| panic!("seed {seed}: {file:?}"))
}

/// Bytes of a node, and where its children stand.
const NODE: usize = 448;
const CHILDREN: usize = 384;

/// What stands for a child that is not there.
const NOTHING: u32 = u32::MAX;

#[test]
fn honest_files_are_taken() {
    for forgery in [honest(), mixed()] {
        assert!(survives(forgery.file(), 1));
    }
}

#[test]
fn references_must_lead_somewhere() {
    let honest = honest();
    let lines = honest.sections[1].1.len() as u32 / 64;
    let root = honest.clone().get("tree", 28);
    assert_eq!(root & 63, 0, "the root is a node");
    for (reference, expected) in [
        (lines << 6, format!("a child in line {lines}, but there are {lines} lines")),
        ((lines - 6) << 6, format!("a child in line {}, but there are {lines} lines", lines - 6)),
        ((lines - 4) << 6 | 1, format!("a child in line {}, but", lines - 4)),
        (NOTHING - 1, "a child in line 67108863, but".to_owned()),
        (2, "a reference of no kind, 0x00000002".to_owned()),
        (NOTHING, "primitives without a root, or a root without primitives".to_owned()),
    ] {
        let mut forgery = honest.clone();
        forgery.set("tree", 28, reference);
        let error = refusal(&forgery);
        assert!(error.contains(&expected), "{reference:#x}: {error}");
        assert!(error.starts_with("section `tree`, byte 320: "), "{error}");
    }
    let mut forgery = honest.clone();
    forgery.set("nodes", CHILDREN, lines << 6);
    assert!(refusal(&forgery).starts_with("section `nodes`, byte 384: a child in line"));
    let mut forgery = honest;
    forgery.set("nodes", CHILDREN, NOTHING);
    assert!(refusal(&forgery).contains("a child's box is not in that of its parent"));
}

#[test]
fn no_node_is_reached_twice() {
    let honest = honest();
    let children: Vec<_> =
        (0..16).map(|lane| honest.clone().get("nodes", CHILDREN + 4 * lane)).collect();
    let node = children.iter().position(|child| child & 1 == 0).expect("a child that is a node");
    // Around in a circle.
    let mut circle = honest.clone();
    circle.set("nodes", CHILDREN + 4 * node, 0);
    assert!(refusal(&circle).contains("a second reference to the node in line 0"));
    // By two ways: a box is copied with the reference, so that nothing else is wrong.
    let other = (node + 1) % 16;
    let mut twice = honest;
    twice.set("nodes", CHILDREN + 4 * other, children[node]);
    for plane in 0..6 {
        let number = twice.get("nodes", 64 * plane + 4 * node);
        twice.set("nodes", 64 * plane + 4 * other, number);
    }
    let line = children[node] >> 6;
    assert!(refusal(&twice).contains(&format!("a second reference to the node in line {line}")));
}

/// A tree of so many nodes below one another, each the only child, over a leaf of one triangle.
fn chain(nodes: u32) -> Forgery {
    let mesh = raywood::TriangleMesh::new(
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        vec![[0, 1, 2]],
    );
    let mut file = Vec::new();
    Bvh::build(mesh.expect("a mesh")).expect("it builds").save(&mut file).expect("it is saved");
    let mut forgery = Forgery::of(&file);
    let block = forgery.section("nodes").clone();
    let mut lines = Vec::new();
    for number in 0..nodes {
        let (mut planes, mut children) = (Vec::new(), vec![NOTHING; 16]);
        for plane in 0..6 {
            let (own, none) = match plane {
                0 | 2 | 4 => (0.0, f32::INFINITY),
                5 => (0.0, f32::NEG_INFINITY),
                _ => (1.0f32, f32::NEG_INFINITY),
            };
            planes.push(own);
            planes.extend([none; 15]);
        }
        let line = 7 * (number + 1);
        children[0] = if number + 1 == nodes { line << 6 | 1 } else { line << 6 };
        lines.extend(planes.iter().flat_map(|plane| plane.to_le_bytes()));
        lines.extend(children.iter().flat_map(|child| child.to_le_bytes()));
    }
    assert_eq!(lines.len(), NODE * nodes as usize);
    lines.extend(block);
    *forgery.section("nodes") = lines;
    forgery.set("tree", 28, 0);
    forgery
}

#[test]
fn trees_are_no_deeper_than_stacks() {
    for nodes in [1, 8, 9, 63, 64] {
        assert!(survives(chain(nodes).file(), 3), "{nodes} nodes");
    }
    for nodes in [65, 66, 5000] {
        assert!(refusal(&chain(nodes)).contains("more than 64 nodes above one another"));
    }
}

#[test]
fn numbers_must_be_in_range() {
    let honest = honest();
    let change = |section: &str, at: usize, number: u32| {
        let mut forgery = honest.clone();
        forgery.set(section, at, number);
        refusal(&forgery)
    };
    let (nan, infinite) = (f32::NAN.to_bits(), f32::INFINITY.to_bits());
    assert!(change("positions", 4, nan).contains("1 vertices are NaN or infinite"));
    assert!(change("triangles", 8, 600).contains("triangle 0 uses vertex 600, but there are 600"));
    assert!(change("tree", 0, nan).contains("the box around everything is empty or not finite"));
    assert!(change("tree", 12, infinite).contains("the box around everything"));
    assert!(change("tree", 24, 199).contains("199 primitives, but there are 200 triangles"));
    assert!(change("tree", 32, 2).contains("triangle test 2, expected 0 or 1"));
    assert!(change("tree", 36, 1).contains("expected zeros"));
    assert!(change("nodes", 0, nan).contains("a child's box is not in that of its parent"));
    assert!(change("nodes", 64, infinite).contains("a child's box is not in that of its parent"));
    assert!(change("parts", 28, 1 << 8).contains("bits of primitives that are not there"));

    // The first block stands behind the first node: its primitives, and a corner.
    let block = 7 * 64;
    assert!(change("nodes", block + 288, 200).contains("primitive 200, but there are 200"));
    // Of those that are cut, a leaf's box holds a part: not of small ones.
    let primitive = |lane: &usize| honest.clone().get("nodes", block + 288 + 4 * lane);
    let whole = (0..8).find(|lane| primitive(lane) < SMALL).expect("a small triangle");
    for corner in [nan, 9e9f32.to_bits()] {
        let refused = change("nodes", block + 4 * whole, corner);
        assert!(refused.contains("a triangle is not in its leaf's box"));
    }
}

#[test]
fn kinds_of_primitives_must_agree() {
    let mixed = mixed();
    // Fewer spheres, more triangles: as many primitives, but others.
    let mut forgery = mixed.clone();
    let one_less = forgery.section("spheres").len() - 16;
    forgery.section("spheres").truncate(one_less);
    let first = forgery.section("triangles")[..12].to_vec();
    forgery.section("triangles").extend(first);
    assert!(
        refusal(&forgery)
            .contains("primitive 40 is no triangle in its leaf, but not in the geometry")
    );
    let mut forgery = mixed;
    forgery.section("triangles").truncate(39 * 12);
    let sphere = forgery.section("spheres")[..16].to_vec();
    forgery.section("spheres").extend(sphere);
    assert!(
        refusal(&forgery)
            .contains("primitive 39 is a triangle in its leaf, but not in the geometry")
    );
}

#[test]
fn sections_must_be_there_and_whole() {
    for name in ["tree", "nodes", "positions", "triangles"] {
        let mut forgery = honest();
        forgery.sections.retain(|(other, _)| other != name);
        assert_eq!(refusal(&forgery), format!("there is no section `{name}`"));
        let mut forgery = honest();
        forgery.section(name).pop();
        assert!(refusal(&forgery).contains("expected"), "{name}");
    }
    let mut twice = honest();
    twice.sections.push(("tree".to_owned(), Vec::new()));
    assert!(refusal(&twice).contains("there is a second section `tree`"));
    let mut odd = honest();
    odd.sections.push(("Odd".to_owned(), Vec::new()));
    assert!(refusal(&odd).contains("the name has something else"));
    let mut many = honest();
    many.sections.extend((0..256).map(|number| (format!("n{number}"), Vec::new())));
    assert!(refusal(&many).contains("sections, expected at most 256"));
    let mut parts = honest();
    parts.section("parts").extend([0; 8]);
    assert!(refusal(&parts).contains("but 200 primitives have 32"));
    // What a later version of the program may add is no reason to refuse a file.
    let mut unknown = honest();
    unknown.sections.insert(0, ("unknown".to_owned(), vec![1, 2, 3]));
    assert!(survives(unknown.file(), 4));
}

#[test]
fn lengths_do_not_overflow() {
    let file = honest().file();
    for at in [12, 16, 20, 64 + 16, 64 + 20, 64 + 24, 64 + 28, 64 + 36, 104 + 16, 104 + 24] {
        for number in [0, 1, 63, 64, 0x7fff_ffff, 0x8000_0000, u32::MAX - 63, u32::MAX] {
            let mut forged = file.clone();
            if forged[at..at + 4] == u32::to_le_bytes(number) {
                continue;
            }
            forged[at..at + 4].copy_from_slice(&number.to_le_bytes());
            correct_checksums(&mut forged);
            assert!(SavedTree::open(forged).is_err(), "{number:#x} at {at}");
        }
    }
    // Between sections there are zeros, which no checksum holds.
    let mut forged = file;
    let end = 64 + 5 * 40;
    assert_ne!(end % 64, 0);
    forged[end] = 1;
    assert!(SavedTree::open(forged).unwrap_err().to_string().contains("expected zeros before"));
}

#[test]
fn random_forgeries_do_no_harm() {
    let numbers = [
        0u32,
        1,
        2,
        63,
        64,
        65,
        448,
        0x3f80_0000,
        0x7f80_0000,
        0xff80_0000,
        0x7fc0_0000,
        u32::MAX - 2,
        u32::MAX,
    ];
    let mut rng = Rng::new(99);
    let (mut loaded, mut refused) = (0, 0);
    for round in 0..2000u64 {
        let mut forgery = if round % 2 == 0 { honest() } else { mixed() };
        for _ in 0..1 + rng.below(3) {
            let section = rng.below(forgery.sections.len());
            let (name, bytes) = &mut forgery.sections[section];
            let words = bytes.len() / 4;
            // Of nodes rather the first ones, where other nodes are referred to.
            let words = if *name == "nodes" && rng.below(2) == 0 { words.min(300) } else { words };
            let at = 4 * rng.below(words.max(1));
            let old = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            let new = match rng.below(4) {
                0 => numbers[rng.below(numbers.len())],
                1 => old ^ 1 << rng.below(32),
                2 => (rng.below(words.max(1)) as u32) << 6 | rng.below(2) as u32,
                _ => rng.bits() as u32,
            };
            bytes[at..at + 4].copy_from_slice(&new.to_le_bytes());
        }
        match survives(forgery.file(), round) {
            true => loaded += 1,
            false => refused += 1,
        }
    }
    // Both happens, or little is tested.
    assert!(loaded > 100 && refused > 100, "{loaded} loaded, {refused} refused");
}

#[test]
fn what_fuzzing_found_does_no_harm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/found/saved_tree");
    // A package on its own has no such folder.
    let Ok(entries) = fs::read_dir(&folder) else { return };
    let (mut loaded, mut refused) = (0, 0);
    for entry in entries {
        let path = entry.expect("an entry").path();
        let mut file = fs::read(&path).expect("a file");
        correct_checksums(&mut file);
        match survives(file, 1) {
            true => loaded += 1,
            false => refused += 1,
        }
    }
    assert!(loaded > 5 && refused > 5, "{loaded} loaded, {refused} refused");
}

#[test]
fn an_error_tells_the_place() {
    let mut forgery = honest();
    let start = 320 + 64;
    assert_eq!(start % 64, 0);
    let block = NODE + 288;
    forgery.set("nodes", block, 7777);
    let error = refusal(&forgery);
    assert_eq!(
        error,
        format!("section `nodes`, byte {}: primitive 7777, but there are 200", start + NODE)
    );
}
