//! The conformance matrix: every query of every structure, on every kind of geometry, in single and double precision, plain and through instances on two levels, with every option, against brute force
//! in double precision (`raywood_testkit::reference`), on all levels of instructions. What is not offered is named with the reason; `docs/conformance.md` has the table.
//!
//! A file for each axis: `axes.rs` (queries and options), `geometries.rs`, `questions.rs` (rays, points, regions, places of instances), `subjects/` (structures). `verdict.rs` compares, `table.rs` tells, and
//! `methods.rs` sees to it that no query is forgotten.

mod axes;
mod geometries;
mod methods;
mod questions;
mod subjects;
mod table;
mod verdict;

use std::collections::BTreeMap;

use raywood::{
    Aabb, BuildOptions, Bvh, Bvh2, Bvh64, DynamicBvh, SimdLevel, Structure, StructureKind,
    TriangleMesh64, Vec3,
};
use raywood_testkit::placement::Placement;
use raywood_testkit::reference::{Reference, Shape};

use axes::{Choice, Query};
use geometries::{Case, Primitive};
use questions::{ALONE, Frame, Questions, outer_places, places};
use subjects::{Answers, Packets, Subject, one_level, two_levels};
use table::Matrix;

/// How far a point is from a box, along the axis where that is farthest.
fn distance_of_box(point: Vec3, bounds: &Aabb) -> f32 {
    (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO).max_element()
}

/// What was answered first, of what must always be answered the same, to the bit.
#[derive(Default)]
struct Before(BTreeMap<(String, Query, Choice), Answers>);

/// What must give the same answers, to the bit: a structure on all levels of instructions, and to closest hits all of them, but for scenes, which are about something else.
fn group_of(column: &str, query: Query) -> &str {
    let is_scene = column.starts_with("`Tlas");
    if query.of_one() == Query::Closest && !is_scene { "" } else { column }
}

/// Asks everything of a subject.
fn examine(
    matrix: &mut Matrix,
    before: &mut Before,
    (column, geometry): (&str, &str),
    subject: &dyn Subject,
    questions: &Questions,
) {
    for &query in Query::ALL {
        for &choice in query.choices() {
            let answers = match subject.ask(query, choice, questions) {
                Ok(answers) => answers,
                Err(reason) => {
                    matrix.not_offered(column, geometry, (query, choice), reason);
                    continue;
                }
            };
            let what = || format!("{} {} of {column}, {geometry}", query.name(), choice.name());
            let has_packets = subject.has_packets(query);
            match verdict::check(questions, query, choice, &answers, !has_packets) {
                Ok(0) => matrix.wrong(format!("{}: nothing was compared", what())),
                Ok(compared) => matrix.covered(column, geometry, (query, choice), compared),
                Err(error) => matrix.wrong(format!("{}: {error}", what())),
            }

            // Packets round differently, and what is told first is not specified.
            if !has_packets && query != Query::ForEachHit {
                let key = (group_of(column, query).to_string(), query.of_one(), choice);
                let first = before.0.entry(key).or_insert_with(|| answers.clone());
                if *first != answers {
                    matrix.wrong(format!("{}: not as before, to the bit", what()));
                }
            }
        }
    }
}

/// Structures over a geometry, and instances of them.
fn examine_case(matrix: &mut Matrix, case: &Case) {
    let Case { name, geometry, primitives } = case;
    let mut before = Before::default();
    let reference = |inner: &[_], outer: &[_]| questions::reference(primitives, inner, outer);
    let alone = Questions::about(reference(ALONE, ALONE), Frame::SINGLE);
    for &kind in StructureKind::ALL {
        let built = Structure::build(kind, geometry.clone(), &BuildOptions::default());
        let column = format!("`{}`", kind.name());
        let subject = built.expect("it builds");
        examine(matrix, &mut before, (&column, name), &subject, &alone);
    }
    let tree = Bvh2::build(geometry, &BuildOptions::default()).expect("it builds");
    let packets = Packets(tree, geometry.clone());
    examine(matrix, &mut before, ("packets of `Bvh2`", name), &packets, &alone);

    // Of one that has changed, too.
    let mut changed = DynamicBvh::build(geometry.clone()).expect("it builds");
    changed.update(geometry.clone()).expect("as many primitives");
    examine(matrix, &mut before, ("`DynamicBvh`", name), &changed.into_bvh(), &alone);

    let one = Questions::about(reference(&places(), ALONE), Frame::SINGLE);
    let two = Questions::about(reference(&places()[1..5], &outer_places()), Frame::SINGLE);
    for level in SimdLevel::available() {
        let mut bvh = Bvh::build(geometry.clone()).expect("it builds");
        bvh.set_simd_level(level);
        examine(matrix, &mut before, ("`Bvh`", name), &bvh, &alone);
        examine(matrix, &mut before, ("`Tlas`", name), &one_level(bvh.clone()), &one);
        examine(matrix, &mut before, ("`Tlas` of `Tlas`", name), &two_levels(bvh), &two);
    }
}

/// Meshes of double precision, far away and small, so that single precision sees nothing of them.
fn examine_doubles(matrix: &mut Matrix) {
    let there = Placement::IDENTITY.scaled([2f64.powi(-10); 3]).moved([1e7, -1e7, 1e7]);
    let once = geometries::triangles();
    let corners: Vec<_> = [&once[..], &once[..]].concat();
    let place = |p: Vec3| there.point(p.to_array().map(f64::from));
    let corners: Vec<[[f64; 3]; 3]> = corners.iter().map(|t| t.map(place)).collect();
    let told = |&corners| Primitive {
        shape: Shape::Triangle(corners),
        mask: u32::MAX,
        tells_points: true,
    };
    let primitives: Vec<_> = corners.iter().map(told).collect();
    let reference = Reference {
        epsilon: 2f64.powi(-46),
        size: 2f64.powi(-8),
        ..questions::reference(&primitives, ALONE, ALONE)
    };
    let frame = Frame { origin: [1e7, -1e7, 1e7], scale: 2f64.powi(-10), is_single: false };
    let questions = Questions::about(reference, frame);
    let indices = (0..corners.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let mesh = TriangleMesh64::new(corners.as_flattened().to_vec(), indices).expect("a mesh");
    let mut bvh = Bvh64::build(mesh).expect("it builds");
    let mut before = Before::default();
    for level in SimdLevel::available() {
        bvh.set_simd_level(level);
        examine(matrix, &mut before, ("`Bvh64`", "triangles"), &bvh, &questions);
    }
}

#[test]
fn every_cell_agrees_with_brute_force_or_is_named() {
    let mut matrix = Matrix::default();
    for case in geometries::all() {
        examine_case(&mut matrix, &case);
    }
    examine_doubles(&mut matrix);
    matrix.expect_all_right();
    let page = matrix.page();
    println!("{page}");
    table::compare_with_docs(&page);
}
