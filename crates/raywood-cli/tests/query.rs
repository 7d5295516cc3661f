//! `raywood query`: arrays in, arrays out, held against the library.

mod support;

use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Output, Stdio};

use raywood::{Bvh, Hit, Ray, TriangleMesh, Vec3};
use serde_json::Value;
use support::{code, files, folder, raywood, run, stderr, stdout};

/// The corners of two tetrahedra, of which the second is larger, normals outwards.
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [4.0, 0.0, 0.0],
    [0.0, 4.0, 0.0],
    [0.0, 0.0, 4.0],
    [9.0, 1.0, 1.0],
    [17.0, 1.0, 1.0],
    [9.0, 9.0, 1.0],
    [9.0, 1.0, 9.0],
];
const FACES: [[u32; 3]; 8] =
    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [4, 6, 5], [4, 5, 7], [4, 7, 6], [5, 6, 7]];

fn tree() -> Bvh<TriangleMesh> {
    let mesh = TriangleMesh::new(CORNERS.to_vec(), FACES.to_vec()).expect("a mesh");
    Bvh::build(mesh).expect("a tree")
}

/// The model as a file in two objects.
fn write_model(folder: &Path) {
    let vertices = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = FACES.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    let (first, second) = faces.split_at(4);
    let text = vertices.concat() + "o first\n" + &first.concat() + "o second\n" + &second.concat();
    fs::write(folder.join("model.obj"), text).expect("a file");
}

/// Numbers between 0 and 1, the same every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }
}

/// Rows of origin, direction and interval; some not finite.
fn rays(count: usize) -> Vec<[f32; 8]> {
    let mut random = Random(7);
    (0..count)
        .map(|row| {
            let [mut origin, mut target] = [[0.0; 3], [0.0; 3]];
            origin.fill_with(|| 30.0 * random.next() - 10.0);
            target.fill_with(|| 10.0 * random.next());
            let [ox, oy, oz] = origin;
            let [x, y, z] = target;
            let t_max = if row % 5 == 0 { 0.5 } else { f32::INFINITY };
            let ox = if row % 97 == 3 { f32::NAN } else { ox };
            [ox, oy, oz, x - origin[0], y - oy, z - oz, 0.0, t_max]
        })
        .collect()
}

fn library_rays(rows: &[[f32; 8]]) -> Vec<Ray> {
    let ray = |&[ox, oy, oz, dx, dy, dz, t_min, t_max]: &[f32; 8]| {
        Ray::new([ox, oy, oz], [dx, dy, dz]).with_interval(t_min, t_max)
    };
    rows.iter().map(ray).collect()
}

fn closest(rows: &[[f32; 8]]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rows.len()];
    tree().intersect_batch(&library_rays(rows), &mut hits);
    hits
}

/// An array as numpy saves it: type, order and shape as Python writes them.
fn npy(descr: &str, order: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let mut header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while !(10 + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), bytes].concat()
}

fn little(numbers: impl IntoIterator<Item = f32>) -> Vec<u8> {
    numbers.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// The header and the numbers of an array.
fn split_npy(bytes: &[u8]) -> (String, &[u8]) {
    assert_eq!(bytes[..8], *b"\x93NUMPY\x01\x00");
    let length = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    (String::from_utf8(bytes[10..length].to_vec()).expect("text"), &bytes[length..])
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|&x| f32::from_le_bytes(x)).collect()
}

fn integers(bytes: &[u8]) -> Vec<i32> {
    bytes.as_chunks().0.iter().map(|&x| i32::from_le_bytes(x)).collect()
}

/// An array of an archive.
fn array_of(path: &Path, name: &str) -> (String, Vec<u8>) {
    let file = fs::File::open(path).expect("a file");
    let mut archive = zip::ZipArchive::new(file).expect("an archive");
    let mut bytes = Vec::new();
    let mut entry = archive.by_name(&format!("{name}.npy")).expect("an array");
    entry.read_to_end(&mut bytes).expect("the array");
    let (header, numbers) = split_npy(&bytes);
    (header, numbers.to_vec())
}

fn write_archive(path: &Path, arrays: &[(&str, Vec<u8>)], method: zip::CompressionMethod) {
    let mut archive = zip::ZipWriter::new(fs::File::create(path).expect("a file"));
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in arrays {
        archive.start_file(format!("{name}.npy"), options).expect("an entry");
        archive.write_all(bytes).expect("the entry");
    }
    archive.finish().expect("an archive");
}

fn succeed(folder: &Path, arguments: &str) -> Output {
    let output = run(folder, arguments);
    assert_eq!((code(&output), complaints(&output).as_str()), (0, ""), "{arguments}");
    output
}

/// What is said on standard error, but for rows that are not finite: many tests have some.
fn complaints(output: &Output) -> String {
    let said = stderr(output);
    said.split_inclusive('\n').filter(|line| !line.contains("not finite and miss")).collect()
}

fn with_input(folder: &Path, arguments: &str, input: &[u8]) -> Output {
    let mut command = raywood(folder);
    command.args(arguments.split_whitespace()).stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    // A command that refuses its input need not read all of it.
    let _ = child.stdin.take().expect("a pipe").write_all(input);
    child.wait_with_output().expect("the command ends")
}

/// Writes the rows in every form, and tells the files' names.
fn write_rays(folder: &Path, rows: &[[f32; 8]]) -> Vec<String> {
    let count = rows.len();
    let eight = |n: usize| format!("({n}, 8)");
    let columns = |range: std::ops::Range<usize>| -> Vec<f32> {
        rows.iter().flat_map(|row| row[range.clone()].to_vec()).collect()
    };
    let all = || rows.iter().flatten().copied();
    let by_column: Vec<f32> = (0..8).flat_map(|c| rows.iter().map(move |row| row[c])).collect();
    let double: Vec<u8> = all().flat_map(|x| f64::from(x).to_le_bytes()).collect();
    let big: Vec<u8> = all().flat_map(f32::to_be_bytes).collect();
    let big_double: Vec<u8> = by_column.iter().flat_map(|&x| f64::from(x).to_be_bytes()).collect();
    let vectors = |range| npy("<f4", "False", &format!("({count}, 3)"), &little(columns(range)));
    let numbers =
        |n: usize| npy("<f4", "False", &format!("({count},)"), &little(columns(n..n + 1)));
    let fortran = npy("<f4", "True", &eight(count), &little(by_column));
    let files = [
        ("c.npy", npy("<f4", "False", &eight(count), &little(all()))),
        ("double.npy", npy("<f8", "False", &eight(count), &double)),
        ("big.npy", npy(">f4", "False", &eight(count), &big)),
        ("fortran.npy", fortran.clone()),
        ("big_fortran.npy", npy(">f8", "True", &eight(count), &big_double)),
    ];
    for (name, bytes) in &files {
        fs::write(folder.join(name), bytes).expect("a file");
    }
    let zero = npy("<f8", "False", "()", &0f64.to_le_bytes());
    let arrays = [
        ("origins", vectors(0..3)),
        ("directions", vectors(3..6)),
        ("t_max", numbers(7)),
        ("t_min", zero),
    ];
    write_archive(&folder.join("parts.npz"), &arrays, zip::CompressionMethod::Stored);
    write_archive(&folder.join("packed.npz"), &arrays, zip::CompressionMethod::Deflated);
    let one = [("arr_0", fortran)];
    write_archive(&folder.join("fortran.npz"), &one, zip::CompressionMethod::Deflated);

    let names = "t_max,dx,dy,DZ, ox,oy,oz\n".to_owned();
    let csv = rows.iter().fold(names, |text, [ox, oy, oz, dx, dy, dz, _, t_max]| {
        let t_max = if t_max.is_finite() { t_max.to_string() } else { String::new() };
        text + &format!("{t_max},{dx},{dy},{dz},{ox},\"{oy}\",{oz}\r\n")
    });
    fs::write(folder.join("rays.csv"), csv).expect("a file");
    let json = rows.iter().map(|[ox, oy, oz, dx, dy, dz, _, t_max]| {
        let finite = |x: &f32| if x.is_finite() { Value::from(*x) } else { Value::Null };
        let (ox, t_max) = (finite(ox), finite(t_max));
        let value = serde_json::json!({ "origin": [ox, oy, oz], "direction": [dx, dy, dz], "t_max": t_max });
        format!("{value}\n\n")
    });
    fs::write(folder.join("rays.jsonl"), json.collect::<String>()).expect("a file");
    let names = files.iter().map(|(name, _)| *name);
    names
        .chain(["parts.npz", "packed.npz", "fortran.npz", "rays.csv", "rays.jsonl"])
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_form_of_input_gives_the_hits_of_the_library() {
    let folder = folder("query-input");
    write_model(&folder);
    let rows = rays(1000);
    let hits = closest(&rows);
    let t: Vec<_> = hits.iter().map(|hit| hit.map_or(f32::INFINITY, |hit| hit.t)).collect();
    let primitives: Vec<_> =
        hits.iter().map(|hit| hit.map_or(-1, |hit| hit.primitive as i32)).collect();
    assert!((100..900).contains(&hits.iter().flatten().count()), "hits and misses");
    assert!(primitives.iter().any(|&p| p >= 4) && primitives.iter().any(|p| (0..4).contains(p)));
    for name in write_rays(&folder, &rows) {
        succeed(&folder, &format!("query model.obj --rays {name} -o hits.npz"));
        let path = folder.join("hits.npz");
        assert_eq!(floats(&array_of(&path, "t").1), t, "{name}");
        assert_eq!(integers(&array_of(&path, "primitive").1), primitives, "{name}");

        // The same through a pipe.
        let format = name.rsplit('.').next().expect("an ending");
        let bytes = fs::read(folder.join(&name)).expect("the file");
        let arguments = "query model.obj --rays - --columns t --format npy";
        let output = with_input(&folder, &format!("{arguments} --input-format {format}"), &bytes);
        assert_eq!((code(&output), complaints(&output).as_str()), (0, ""), "{name}");
        let (header, numbers) = split_npy(&output.stdout);
        assert!(header.contains("'<f4'") && header.contains("(1000,)"), "{name}: {header}");
        assert_eq!(floats(numbers), t, "{name}");
    }
}

#[test]
fn every_form_of_output_holds_the_same() {
    let folder = folder("query-output");
    write_model(&folder);
    let rows = rays(500);
    write_rays(&folder, &rows);
    let (hits, rays, tree) = (closest(&rows), library_rays(&rows), tree());
    for name in ["hits.npz", "hits.npy", "hits.csv", "hits.jsonl"] {
        let output = succeed(&folder, &format!("query model.obj --rays c.npy -o {name}"));
        let summary = stdout(&output);
        let count = hits.iter().flatten().count();
        assert!(summary.starts_with(&format!("{name}: 500 rays in ")), "{summary}");
        assert!(summary.ends_with(&format!(" {count} hit something\n")), "{summary}");
    }

    let npz = folder.join("hits.npz");
    let (header, positions) = array_of(&npz, "position");
    assert!(header.contains("'<f4'") && header.contains("(500, 3)"), "{header}");
    let [u, v, positions, normals] =
        [array_of(&npz, "u").1, array_of(&npz, "v").1, positions, array_of(&npz, "normal").1]
            .map(|bytes| floats(&bytes));
    let npy = fs::read(folder.join("hits.npy")).expect("a file");
    let (header, records) = split_npy(&npy);
    let expected = "'descr': [('t', '<f4'), ('primitive', '<i4'), ('u', '<f4'), ('v', '<f4'), \
        ('position', '<f4', (3,)), ('normal', '<f4', (3,))]";
    assert!(header.contains(expected), "{header}");
    assert_eq!(records.len(), 500 * 40);
    let csv = fs::read_to_string(folder.join("hits.csv")).expect("a file");
    let mut lines = csv.lines();
    let names = "t,primitive,u,v,position_x,position_y,position_z,normal_x,normal_y,normal_z";
    assert_eq!(lines.next(), Some(names));
    let json = fs::read_to_string(folder.join("hits.jsonl")).expect("a file");

    for (i, ((hit, line), object)) in hits.iter().zip(lines).zip(json.lines()).enumerate() {
        let mut expected = [f32::NAN; 10];
        (expected[0], expected[1]) = (f32::INFINITY, -1.0);
        if let Some(hit) = hit {
            let point = tree.surface_point(&rays[i], hit);
            expected[..4].copy_from_slice(&[hit.t, hit.primitive as f32, hit.u, hit.v]);
            expected[4..7].copy_from_slice(&point.position.to_array());
            expected[7..].copy_from_slice(&point.normal.to_array());
        }
        let bits = |numbers: &[f32]| -> Vec<_> {
            numbers.iter().map(|x| if x.is_nan() { None } else { Some(x.to_bits()) }).collect()
        };
        let fields: Vec<f32> = line.split(',').map(|x| x.parse().expect("a number")).collect();
        assert_eq!(bits(&fields), bits(&expected), "{line}");
        let record = &records[40 * i..40 * (i + 1)];
        let mut numbers = floats(record);
        numbers[1] = integers(record)[1] as f32;
        assert_eq!(bits(&numbers), bits(&expected));
        assert_eq!(bits(&[u[i], v[i]]), bits(&expected[2..4]));
        assert_eq!(bits(&positions[3 * i..3 * i + 3]), bits(&expected[4..7]));
        assert_eq!(bits(&normals[3 * i..3 * i + 3]), bits(&expected[7..]));
        let object: Value = serde_json::from_str(object).expect("JSON");
        match hit {
            None => assert!(object.as_object().expect("one").values().all(Value::is_null)),
            Some(hit) => {
                assert_eq!(object["t"].as_f64().map(|t| t as f32), Some(hit.t));
                assert_eq!(object["primitive"], hit.primitive);
                assert_eq!(object["position"][1].as_f64().map(|y| y as f32), Some(expected[5]));
            }
        }
    }
}

#[test]
fn lists_of_hits_have_offsets_or_the_number_of_their_ray() {
    let folder = folder("query-all");
    write_model(&folder);
    let rows = rays(700);
    write_rays(&folder, &rows);
    let lists = tree().all_hits_batch(&library_rays(&rows));
    assert!(lists.iter().any(|hits| hits.len() >= 4), "rays through both");
    let primitives: Vec<_> = lists.hits().iter().map(|hit| hit.primitive as i32).collect();
    let t: Vec<_> = lists.hits().iter().map(|hit| hit.t).collect();
    let numbers: Vec<_> =
        lists.iter().enumerate().flat_map(|(ray, hits)| vec![ray as i64; hits.len()]).collect();
    let arguments = "query model.obj --rays rays.csv --kind all --columns primitive,t -o";
    for name in ["all.npz", "all.npy", "all.csv", "all.jsonl"] {
        succeed(&folder, &format!("{arguments} {name}"));
    }

    let npz = folder.join("all.npz");
    let long = |bytes: &[u8]| -> Vec<_> {
        bytes.as_chunks().0.iter().map(|&x| i64::from_le_bytes(x)).collect()
    };
    let offsets: Vec<_> = lists.offsets().iter().map(|&offset| offset as i64).collect();
    assert_eq!(long(&array_of(&npz, "offsets").1), offsets);
    assert_eq!(integers(&array_of(&npz, "primitive").1), primitives);
    assert_eq!(floats(&array_of(&npz, "t").1), t);

    let npy = fs::read(folder.join("all.npy")).expect("a file");
    let (header, records) = split_npy(&npy);
    let shape = format!("'shape': ({},)", t.len());
    assert!(header.contains(&shape) && header.contains("[('ray', '<i8'), "), "{header}");
    let rays: Vec<_> = records.chunks_exact(16).flat_map(|record| long(&record[..8])).collect();
    assert_eq!(rays, numbers);
    let csv = fs::read_to_string(folder.join("all.csv")).expect("a file");
    let lines = numbers.iter().zip(&primitives).zip(&t);
    let expected = lines.map(|((ray, primitive), t)| format!("{ray},{primitive},{t:?}\n"));
    assert_eq!(csv, "ray,primitive,t\n".to_owned() + &expected.collect::<String>());
    let json = fs::read_to_string(folder.join("all.jsonl")).expect("a file");
    assert_eq!(json.lines().count(), rows.len());
    for (line, hits) in json.lines().zip(lists.iter()) {
        let object: Value = serde_json::from_str(line).expect("JSON");
        let found: Vec<_> = object["hits"].as_array().expect("a list").iter().collect();
        assert_eq!(found.len(), hits.len());
        assert!(found.iter().zip(hits).all(|(found, hit)| found["primitive"] == hit.primitive));
    }
}

#[test]
fn every_kind_answers_as_the_library_does() {
    let folder = folder("query-kinds");
    write_model(&folder);
    let rows = rays(300);
    write_rays(&folder, &rows);
    let tree = tree();
    let column = |arguments: &str| {
        let text = stdout(&succeed(&folder, &format!("query model.obj {arguments}")));
        text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let rays = library_rays(&rows);
    let expected: Vec<_> = rays.iter().map(|ray| tree.occluded(ray).to_string()).collect();
    assert_eq!(column("--rays c.npy --kind any"), expected);
    let expected: Vec<_> = rays.iter().map(|ray| tree.crossings(ray).to_string()).collect();
    assert_eq!(column("--rays c.npy --kind count"), expected);

    let points: Vec<Vec3> =
        rows.iter().map(|row| Vec3::new(row[0], row[1], row[2] / 2.0)).collect();
    let points: Vec<_> = points.into_iter().chain([Vec3::new(0.5, 0.5, 0.5)]).collect();
    let bytes = little(points.iter().flat_map(|point| point.to_array()));
    let array = npy("<f4", "False", &format!("({}, 3)", points.len()), &bytes);
    fs::write(folder.join("points.npy"), array).expect("a file");
    let solid = tree.solid();
    let expected: Vec<_> = points.iter().map(|&point| solid.contains(point).to_string()).collect();
    assert!(expected.iter().any(|inside| inside == "true"));
    assert_eq!(column("--points points.npy --kind inside"), expected);
    let number = |x: Option<f32>| x.map_or("NaN".to_owned(), |x| format!("{x:?}"));
    let expected: Vec<_> =
        points.iter().map(|&point| number(solid.signed_distance(point))).collect();
    assert_eq!(column("--points points.npy --kind signed-distance"), expected);
    let expected: Vec<_> =
        points.iter().map(|&point| format!("{:?}", solid.winding_number(point))).collect();
    let arguments = "--points points.npy --kind inside --columns winding_number";
    assert_eq!(column(arguments), expected);
    let closest = |point: &Vec3| match tree.closest_point(*point, 5.0) {
        Some(closest) => {
            let [x, y, z] = closest.point.to_array();
            format!("{:?},{},{x:?},{y:?},{z:?},0", closest.distance, closest.primitive)
        }
        None => "inf,-1,NaN,NaN,NaN,-1".to_owned(),
    };
    let expected: Vec<_> = points.iter().map(closest).collect();
    let columns = "--max-distance 5 --columns distance,primitive,position,material";
    assert_eq!(column(&format!("--points points.npy {columns}")), expected);
}

#[test]
fn many_rays_are_answered_piece_by_piece_as_one_batch() {
    let folder = folder("query-many");
    write_model(&folder);
    let count = 3 * 65_536 + 1000;
    let rows = rays(count);
    let bytes = little(rows.iter().flatten().copied());
    fs::write(folder.join("many.npy"), npy("<f4", "False", &format!("({count}, 8)"), &bytes))
        .expect("a file");
    let expected: Vec<_> =
        closest(&rows).iter().map(|hit| hit.map_or(f32::INFINITY, |hit| hit.t)).collect();
    for threads in [1, 3] {
        let options = format!("--columns t -o t.npy --threads {threads}");
        succeed(&folder, &format!("query model.obj --rays many.npy {options}"));
        let bytes = fs::read(folder.join("t.npy")).expect("a file");
        assert_eq!(floats(split_npy(&bytes).1), expected);
    }
    let offsets = tree().all_hits_batch(&library_rays(&rows)).into_parts().1;
    succeed(&folder, "query model.obj --rays many.npy --kind all --columns t -o all.npz");
    let (_, bytes) = array_of(&folder.join("all.npz"), "offsets");
    let found = bytes.as_chunks().0.iter().map(|&x| i64::from_le_bytes(x) as usize);
    assert!(found.eq(offsets));
    assert_eq!(code(&run(&folder, "query model.obj --rays many.npy --build fastest -o b.csv")), 0);
    let csv = fs::read_to_string(folder.join("b.csv")).expect("a file");
    assert_eq!(csv.lines().count(), count + 1);
}

#[test]
fn no_rays_give_no_rows() {
    let folder = folder("query-none");
    write_model(&folder);
    fs::write(folder.join("none.npy"), npy("<f4", "False", "(0, 6)", &[])).expect("a file");
    fs::write(folder.join("none.csv"), "ox,oy,oz,dx,dy,dz\n").expect("a file");
    fs::write(folder.join("none.jsonl"), "").expect("a file");
    for name in ["none.npy", "none.csv", "none.jsonl"] {
        succeed(&folder, &format!("query model.obj --rays {name} --kind all -o out.npz"));
        let (header, bytes) = array_of(&folder.join("out.npz"), "offsets");
        assert!(header.contains("(1,)") && bytes == [0; 8], "{name}: {header}");
        let text = stdout(&succeed(&folder, &format!("query model.obj --rays {name} --kind any")));
        assert_eq!(text, "hit\n");
    }
}

#[test]
fn bad_input_is_told_in_one_line_and_leaves_no_file() {
    let folder = folder("query-bad");
    write_model(&folder);
    let six = |rows: usize| vec![0; 24 * rows];
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("a file");
    write("short.npy", &npy("<f4", "False", "(10, 6)", &six(7)));
    write("fortran.npy", &npy("<f4", "True", "(10, 6)", &six(7)));
    write("shape.npy", &npy("<f4", "False", "(10, 5)", &six(10)));
    write("deep.npy", &npy("<f4", "False", "(2, 2, 6)", &six(4)));
    write("complex.npy", &npy("<c8", "False", "(10, 6)", &six(20)));
    write("huge.npy", &npy("<f4", "False", "(9223372036854775807, 6)", &six(1)));
    write("text.npy", b"these are no rays");
    write("empty.npy", b"");
    write("long.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\xff{");
    write("text.npz", b"these are no rays");
    write("names.csv", b"a,b,c\n1,2,3\n");
    write("word.csv", b"ox,oy,oz,dx,dy,dz\n0,0,5,0,0,-1\n0,0,five,0,0,-1\n");
    write("fields.csv", b"ox,oy,oz,dx,dy,dz\n0,0,5,0,0,-1\n0,0,5,0,0\n");
    write("nothing.csv", b"");
    write("bare.csv", b"1,2,3\n4,5,6\n");
    write(
        "quote.csv",
        &[&b"ox,oy,oz,dx,dy,dz\n\""[..], &b"0,0,5,0,0,-1\n".repeat(200_000)].concat(),
    );
    write("lines.csv", b"\"x\",y,z\n0,0,\"two\n\x1b[31mlines of more than forty characters\"\n");
    write("nan.csv", b"0,0,5,0,0,-1\n0,NaN,5,0,0,-1\n");
    write("broken.jsonl", b"{\"origin\": [0,0,5], \"direction\": [0,0,-1]}\n{\"origin\": [0,0,5]");
    write("key.jsonl", b"\n{\"origin\": [0,0,5]}\n");
    write("two.jsonl", b"{\"origin\": [0,0], \"direction\": [0,0,-1]}\n");
    write("rays.xyz", b"");
    let vectors = |rows: usize| npy("<f4", "False", &format!("({rows}, 3)"), &vec![0; 12 * rows]);
    let stored = zip::CompressionMethod::Stored;
    write_archive(&folder.join("alone.npz"), &[("origins", vectors(3))], stored);
    let arrays = [("origins", vectors(3)), ("directions", vectors(4))];
    write_archive(&folder.join("differ.npz"), &arrays, stored);
    write_archive(
        &folder.join("damaged.npz"),
        &[("rays", npy("<f4", "False", "(10, 6)", &six(10)))],
        stored,
    );
    let names: Vec<_> = (0..100).map(|n| format!("{n}\n{}", "x".repeat(1000))).collect();
    let arrays: Vec<_> = names.iter().map(|name| (name.as_str(), vectors(1))).collect();
    write_archive(&folder.join("names.npz"), &arrays, stored);
    let mut damaged = fs::read(folder.join("damaged.npz")).expect("a file");
    damaged[250] ^= 1;
    write("damaged.npz", &damaged);

    let before = files(&folder).len();
    for (arguments, expected) in [
        ("--rays short.npy", "short.npy: ends in row 7, expected 10 rows as its shape says"),
        ("--rays fortran.npy", "fortran.npy: ends in row"),
        ("--rays shape.npy", "shape.npy: shape (10, 5), expected (N, 6)"),
        ("--rays deep.npy", "deep.npy: shape (2, 2, 6), expected (N, 6)"),
        ("--points short.npy", "short.npy: shape (10, 6), expected (N, 3)"),
        (
            "--rays complex.npy",
            "complex.npy: an array of type <c8, expected float32, float64 or integers",
        ),
        ("--rays huge.npy", "huge.npy: shape (9223372036854775807, 6) is too large"),
        ("--rays text.npy", "text.npy: not an array of numpy"),
        ("--rays empty.npy", "empty.npy: not an array of numpy"),
        ("--rays long.npy", "long.npy: a header of 4294967295 bytes"),
        ("--rays text.npz", "text.npz: not an archive"),
        ("--rays names.csv", "names.csv:1: no column `origin_x`"),
        ("--rays word.csv", "word.csv:3: `origin_z` is `five`, expected a number"),
        ("--rays fields.csv", "fields.csv:3: 5 fields, expected 6 as in the first line"),
        ("--rays nothing.csv", "nothing.csv: empty, expected a line of names"),
        ("--rays bare.csv", "bare.csv:1: 3 numbers and no names, expected a line of names"),
        ("--rays quote.csv", "quote.csv:2: a line or quotation of more than 1048576 bytes"),
        (
            "--points lines.csv",
            r"lines.csv:2: `z` is `two\n\u{1b}[31mlines of more than forty charac...`, expected a number",
        ),
        ("--rays nan.csv --strict", "nan.csv: row 1 (from 0) is not finite"),
        ("--rays short.npy --max-hits 3", "--max-hits is for --kind all"),
        ("--rays broken.jsonl", "broken.jsonl:2: not JSON from column"),
        ("--rays key.jsonl", "key.jsonl:2: no `direction`"),
        ("--rays two.jsonl", "two.jsonl:1: `origin` is not an array of three numbers"),
        ("--rays rays.xyz", "rays.xyz: its ending tells no format"),
        ("--rays missing.npy", "missing.npy: no such file"),
        (
            "--rays alone.npz",
            "alone.npz: has `origins`, expected `origins` and `directions`, or `rays`",
        ),
        ("--rays names.npz", r"names.npz: has `0\nxxxxxxx"),
        ("--points names.npz", "...` and 92 more, expected `points`"),
        ("--rays differ.npz", "differ.npz: array `directions`: shape (4, 3), expected (3, 3)"),
        ("--rays damaged.npz", "damaged.npz: array `rays`: its checksum is wrong"),
        ("--rays short.npy --kind inside", "--kind inside is asked of points"),
        ("--rays short.npy --columns t,hue", "no column `hue`, expected some of t, primitive"),
        ("--rays short.npy --max-distance 3", "--max-distance is for --kind closest-point"),
    ] {
        for output in ["out.npz", "out.npy", "out.csv", "out.jsonl"] {
            let output = run(&folder, &format!("query model.obj {arguments} -o {output}"));
            let said = stderr(&output);
            assert_eq!(code(&output), 2, "{arguments}: {said}");
            assert!(said.starts_with("raywood: error: ") && said.contains(expected), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
            assert!(said.len() < 600, "{said}");
        }
        assert_eq!(files(&folder).len(), before, "{arguments} left a file");
    }
    assert_eq!(code(&run(&folder, "query model.obj")), 2, "neither rays nor points");
    assert_eq!(code(&run(&folder, "query model.obj --rays short.npy -o out.dat")), 2);
    assert_eq!(code(&run(&folder, "query missing.obj --rays shape.npy")), 2);
    let output = run(&folder, "query model.obj --rays nan.csv -o ./nan.csv");
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("it is what is read"), "{}", stderr(&output));
    assert!(fs::read(folder.join("nan.csv")).expect("it is still there").starts_with(b"0,0,5"));
}

#[test]
fn what_is_not_used_is_told_and_a_reader_may_leave() {
    let folder = folder("query-pipe");
    write_model(&folder);
    let csv = "id,x,y,z\n7,1,1,0.5\n8,,1,0.5\n";
    let arguments = "query model.obj --points - --kind inside";
    let output = with_input(&folder, arguments, csv.as_bytes());
    assert_eq!(stdout(&output), "inside\ntrue\nfalse\n");
    let warning = "raywood: warning: standard input: column `id` is not used\n\
        raywood: warning: standard input: 1 of the points are not finite and miss, the first in row 1 (from 0)\n";
    assert_eq!((code(&output), stderr(&output).as_str()), (0, warning));

    // Only of the first, and in short, where there are very many.
    let names: String = (0..100).map(|n| format!(",{n}{}", "x".repeat(1000))).collect();
    let output = with_input(&folder, arguments, format!("x,y,z{names}\n").as_bytes());
    let said = stderr(&output);
    let last = "raywood: warning: standard input: further columns that are not used: 84\n";
    assert!(said.ends_with(last) && said.lines().count() == 17 && said.len() < 2000, "{said}");

    let rows = rays(100_000);
    let bytes = little(rows.iter().flatten().copied());
    fs::write(folder.join("r.npy"), npy("<f4", "False", "(100000, 8)", &bytes)).expect("a file");
    let mut command = raywood(&folder);
    command.args(["query", "model.obj", "--rays", "r.npy"]).stdout(Stdio::piped());
    let mut child = command.stderr(Stdio::piped()).spawn().expect("the command starts");
    let mut start = [0; 2];
    child.stdout.take().expect("a pipe").read_exact(&mut start).expect("output");
    let output = child.wait_with_output().expect("the command ends");
    assert_eq!((code(&output), stderr(&output).as_str(), start), (0, "", *b"t,"));
}

#[test]
fn lines_of_numbers_are_read_however_they_end_and_whatever_precedes_them() {
    let folder = folder("query-csv");
    write_model(&folder);
    let ask = |rays: &str, options: &str| {
        let arguments = format!("query model.obj --rays - --columns t {options}");
        let output = with_input(&folder, &arguments, rays.as_bytes());
        assert_eq!((code(&output), stderr(&output).as_str()), (0, ""), "{rays:?}");
        stdout(&output)
    };
    // The second misses, the third ends before the surface.
    let expected = "t\n5.0\ninf\ninf\n";
    let names = "ox,oy,oz,dx,dy,dz,t_min,t_max";
    let lines = ["0.5,0.5,-5,0,0,1,0,", "0.5,0.5,-5,0,0,-1,,inf", "0.5,0.5,-5,0,0,1,0,4.5"];
    for start in ["", "\u{feff}", "\n"] {
        for end in ["\n", "\r\n"] {
            let numbers = lines.join(end);
            assert_eq!(ask(&format!("{start}{numbers}"), ""), expected, "no names, no last end");
            assert_eq!(ask(&format!("{start}{names}{end}{numbers}{end}{end}"), ""), expected);
        }
    }
    assert_eq!(ask("0.5, 0.5, -5, 0, 0, 1\n", ""), "t\n5.0\n");
    let object = "\u{feff}{\"origin\": [0.5, 0.5, -5], \"direction\": [0, 0, 1]}\r\n";
    assert_eq!(ask(object, "--input-format jsonl"), "t\n5.0\n");
}

#[test]
fn lists_can_be_limited_to_the_nearest_hits() {
    let folder = folder("query-nearest");
    write_model(&folder);
    let rows = rays(300);
    write_rays(&folder, &rows);
    let lists = tree().nearest_hits_batch(&library_rays(&rows), 3);
    assert!(lists.iter().any(|hits| hits.len() == 3) && lists.iter().any(<[_]>::is_empty));
    succeed(&folder, "query model.obj --rays c.npy --kind all --max-hits 3 --columns t -o all.npz");
    let t: Vec<_> = lists.hits().iter().map(|hit| hit.t).collect();
    assert_eq!(floats(&array_of(&folder.join("all.npz"), "t").1), t);
}

#[test]
fn rows_that_are_not_finite_are_counted() {
    let folder = folder("query-nan");
    write_model(&folder);
    write_rays(&folder, &rays(200));
    for file in ["c.npy", "parts.npz", "rays.csv", "rays.jsonl"] {
        let output = run(&folder, &format!("query model.obj --rays {file} -o out.npy"));
        let expected = format!(
            "raywood: warning: {file}: 3 of the rays are not finite and miss, the first in row 3 (from 0)\n"
        );
        assert_eq!((code(&output), stderr(&output)), (0, expected));
        let output = run(&folder, &format!("query model.obj --rays {file} -o out.npy --strict"));
        assert_eq!(code(&output), 2, "{file}");
    }
}

#[test]
fn damaged_input_is_an_error_or_read_but_never_a_panic() {
    let folder = folder("query-damage");
    write_model(&folder);
    let names = write_rays(&folder, &rays(20));
    let mut random = Random(11);
    let mut refused = 0;
    for name in names {
        let whole = fs::read(folder.join(&name)).expect("a file");
        for round in 0..40 {
            let mut bytes = whole.clone();
            let place = (random.next() * bytes.len() as f32) as usize;
            match round % 4 {
                0 => bytes.truncate(place),
                // Where headers are.
                1 => bytes[place % 128] = (256.0 * random.next()) as u8,
                2 => bytes[place] ^= 1 << (round % 8),
                _ => {
                    let end = bytes.len().min(place + 4);
                    bytes[place..end].fill(0xff);
                }
            }
            fs::write(folder.join(format!("damaged-{name}")), bytes).expect("a file");
            let arguments = format!("query model.obj --rays damaged-{name} -o out.npy");
            let output = run(&folder, &arguments);
            assert!(matches!(code(&output), 0 | 2), "{name}, round {round}: {}", stderr(&output));
            assert!(!stderr(&output).contains("panicked"), "{name}, round {round}");
            refused += usize::from(code(&output) == 2);
        }
    }
    assert!(refused > 100, "{refused}");
}
