//! PLY, the Stanford polygon format (Turk 1994): a header that declares elements and their properties, then their values
//! as text or in binary of either byte order.
//!
//! Read: `vertex` with `x y z`, `nx ny nz` and `red green blue` (integers are taken as sRGB, floats as linear light), in
//! any order and of any number type; `face` with the list `vertex_indices` (or `vertex_index`); `tristrips`. Other elements and
//! properties are skipped.

use raywood::Vec3;

use self::header::{Element, Encoding, Header, Kind, Scalar};
use self::values::{Ascii, Binary, Values};
use super::notes::{Fault, NOT_FINITE, Notes};
use super::raw_mesh::RawMesh;
use super::{Format, Input};
use crate::error::LoadError;
use crate::{Material, Rgb, Scene, srgb_to_linear};

mod header;
mod values;

pub(super) const FORMAT: Format = Format {
    name: "PLY",
    extensions: &["ply"],
    description: "a PLY file",
    recognises: |bytes| bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r"),
    load,
};

static TOO_FEW_CORNERS: Fault = Fault {
    one: "face has fewer than three vertices",
    many: "faces have fewer than three vertices",
    remedy: "left out",
};

fn load(input: &Input<'_>) -> Result<Scene, LoadError> {
    let header = Header::parse(input)?;
    let mut reader =
        Reader { notes: Notes::new(input.path, input.options.strict), mesh: RawMesh::default() };
    match header.encoding {
        Encoding::Ascii => reader.read(&header, Ascii::new(input, header.length))?,
        Encoding::LittleEndian => {
            reader.read(&header, Binary::<true>::new(input, header.length))?;
        }
        Encoding::BigEndian => {
            reader.read(&header, Binary::<false>::new(input, header.length))?;
        }
    }

    let Reader { mesh, notes } = reader;
    let colored = !mesh.colors.is_empty();
    let mesh = mesh.finish(input)?;
    // Colours of vertices are the whole colour: there is no material to multiply.
    let diffuse = if colored { Rgb::ONE } else { Material::default().diffuse };
    let materials = vec![Material { diffuse, ..Material::default() }];
    Ok(Scene { mesh, materials, warnings: notes.into_warnings(), ..Scene::default() })
}

/// What has been read so far.
struct Reader {
    notes: Notes,
    mesh: RawMesh,
}

impl Reader {
    /// Reads the elements in the order of the file, except that faces wait for the vertices that they name.
    fn read<V: Values>(&mut self, header: &Header, mut values: V) -> Result<(), LoadError> {
        let mut waiting = Vec::new();
        let vertices = header.elements.iter().position(|element| element.name == "vertex");
        for (i, element) in header.elements.iter().enumerate() {
            let start = values.offset();
            match &*element.name {
                "vertex" if Some(i) == vertices => self.vertices(element, &mut values)?,
                "face" | "tristrips" if vertices.is_some_and(|v| i < v) => {
                    values.skip(element)?;
                    waiting.push((element, start));
                }
                "face" => self.faces(element, &mut values)?,
                "tristrips" => self.strips(element, &mut values)?,
                name => {
                    values.skip(element)?;
                    if element.count > 0 {
                        let count = element.count;
                        self.notes.say(format!("elements left out: {name} ({count})"));
                    }
                }
            }
        }
        if let Some(surplus) = values.surplus() {
            self.notes.say(surplus);
        }
        for (element, start) in waiting {
            values.set_offset(start);
            match &*element.name {
                "face" => self.faces(element, &mut values)?,
                _ => self.strips(element, &mut values)?,
            }
        }
        Ok(())
    }

    /// Positions, normals and colours.
    fn vertices<V: Values>(&mut self, element: &Element, values: &mut V) -> Result<(), LoadError> {
        // Where each property goes: three places each for position, normal and colour, and one for all else.
        const OTHER: usize = 9;
        const NAMES: [&[&str]; OTHER] = [
            &["x"],
            &["y"],
            &["z"],
            &["nx", "normal_x"],
            &["ny", "normal_y"],
            &["nz", "normal_z"],
            &["red", "r", "diffuse_red"],
            &["green", "g", "diffuse_green"],
            &["blue", "b", "diffuse_blue"],
        ];
        let place_of = |name: &str| NAMES.iter().position(|names| names.contains(&name));
        let slots: Vec<usize> = element
            .properties
            .iter()
            .map(|property| match property.kind {
                Kind::Scalar(_) => place_of(&property.name).unwrap_or(OTHER),
                Kind::List { .. } => OTHER,
            })
            .collect();
        let has = |places: std::ops::Range<usize>| places.into_iter().all(|p| slots.contains(&p));
        if element.count > 0 && !has(0..3) {
            let message = "the vertices have no properties x, y and z";
            return Err(element.error(values.path(), message));
        }
        let (has_normals, has_colors) = (has(3..6), has(6..9));
        let red = slots.iter().position(|&slot| slot == 6);
        let scale = match red.map(|i| element.properties[i].kind) {
            Some(Kind::Scalar(Scalar::U8 | Scalar::I8)) => Some(255.0),
            Some(Kind::Scalar(Scalar::F32 | Scalar::F64)) | None => None,
            Some(_) => Some(65535.0),
        };
        let decoded: Vec<f32> = (0..=255).map(|i| srgb_to_linear(i as f32 / 255.0)).collect();
        let linear = |value: f32| match scale {
            None => value,
            Some(255.0) => decoded[(value.clamp(0.0, 255.0)) as usize],
            Some(scale) => srgb_to_linear((value / scale).clamp(0.0, 1.0)),
        };

        // The header's promise has been checked against the bytes that are there, so this allocates no more than those.
        self.mesh.positions.reserve_exact(element.count);
        if has_normals {
            self.mesh.normals.reserve_exact(element.count);
        }
        if has_colors {
            self.mesh.colors.reserve_exact(element.count);
        }
        let mut row = [0.0f32; OTHER + 1];
        for _ in 0..element.count {
            let start = values.offset();
            values.row(element, &slots, &mut row)?;
            let position = Vec3::new(row[0], row[1], row[2]);
            if !position.is_finite() {
                self.notes.mend(&NOT_FINITE, || values.place_of(start))?;
            }
            self.mesh.positions.push(position);
            if has_normals {
                self.mesh.normals.push(Vec3::new(row[3], row[4], row[5]));
            }
            if has_colors {
                self.mesh.colors.push(Rgb::new(linear(row[6]), linear(row[7]), linear(row[8])));
            }
        }
        Ok(())
    }

    /// Polygons.
    fn faces<V: Values>(&mut self, element: &Element, values: &mut V) -> Result<(), LoadError> {
        let list = self.index_list(element, values)?;
        let colored = element.properties.iter().any(|p| p.name == "red" || p.name == "diffuse_red");
        if colored && self.mesh.colors.is_empty() && element.count > 0 {
            self.notes.say("colours of faces are not shown, only those of vertices");
        }
        self.mesh.triangles.reserve(element.count);
        let mut corners = Vec::new();
        for _ in 0..element.count {
            let start = values.offset();
            corners.clear();
            values.list(element, list, &mut corners)?;
            let outside = |corner: &&u32| **corner as usize >= self.mesh.positions.len();
            if let Some(&corner) = corners.iter().find(outside) {
                return Err(self.no_such_vertex(values, start, corner));
            }
            if corners.len() < 3 {
                self.notes.mend(&TOO_FEW_CORNERS, || values.place_of(start))?;
            }
            self.mesh.push_polygon(&corners, &mut self.notes, || values.place_of(start))?;
        }
        Ok(())
    }

    /// Triangle strips, with -1 between one strip and the next.
    fn strips<V: Values>(&mut self, element: &Element, values: &mut V) -> Result<(), LoadError> {
        let list = self.index_list(element, values)?;
        let mut corners = Vec::new();
        for _ in 0..element.count {
            let start = values.offset();
            corners.clear();
            values.list(element, list, &mut corners)?;
            for strip in corners.split(|&corner| corner == u32::MAX) {
                let outside = |corner: &&u32| **corner as usize >= self.mesh.positions.len();
                if let Some(&corner) = strip.iter().find(outside) {
                    return Err(self.no_such_vertex(values, start, corner));
                }
                for (i, corners) in strip.windows(3).enumerate() {
                    let [a, b, c] = [corners[0], corners[1], corners[2]];
                    // Every other triangle of a strip runs the other way round.
                    let triangle = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    if a != b && b != c && c != a {
                        self.mesh.triangles.push(triangle);
                    }
                }
            }
        }
        Ok(())
    }

    /// The property that lists the vertices of a face.
    fn index_list<V: Values>(&self, element: &Element, values: &V) -> Result<usize, LoadError> {
        let is_list = |name: &str| name == "vertex_indices" || name == "vertex_index";
        let found = element
            .properties
            .iter()
            .position(|p| is_list(&p.name) && matches!(p.kind, Kind::List { .. }));
        match found {
            Some(list) => Ok(list),
            None if element.count == 0 => Ok(0),
            None => {
                let message = format!("{} has no property list vertex_indices", element.name);
                Err(element.error(values.path(), message))
            }
        }
    }

    /// A face names a vertex that is not there.
    #[cold]
    fn no_such_vertex<V: Values>(&self, values: &V, start: usize, corner: u32) -> LoadError {
        let count = self.mesh.positions.len();
        let vertex = match corner {
            u32::MAX => "a negative or too large vertex index".to_owned(),
            _ => format!("vertex {corner}"),
        };
        let message =
            format!("face uses {vertex}, but there are {count} vertices (0 is the first)");
        LoadError::new(values.path(), values.place_of(start), message)
    }
}
