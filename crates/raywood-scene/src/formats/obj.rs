//! Wavefront OBJ: polygons in text, with materials in MTL files beside it.
//!
//! Read: `v` (with weight or colour), `vn`, `vt` where materials have textures, `f` in every form of indices, `usemtl`, `mtllib`, `\` at
//! line ends. Passed over: `g`, `o`, `s` (a corner without `vn` is shaded flat). Left out with a warning: lines,
//! points, curves and surfaces.

use std::collections::HashMap;

use raywood::Vec3;

use super::notes::{Fault, NOT_FINITE, Notes, counted};
use super::raw_mesh::{RawMesh, TOO_MANY_CORNERS};
use super::text::Cursor;
use super::{Format, Input, mtl, polygon};
use crate::error::{LoadError, Place, quoted};
use crate::{Material, MaterialId, Rgb, Scene, srgb_to_linear};

pub(super) const FORMAT: Format = Format {
    name: "OBJ",
    extensions: &["obj"],
    description: "a Wavefront OBJ file",
    recognises,
    load,
};

static TOO_FEW_CORNERS: Fault = Fault {
    one: "face has fewer than three vertices",
    many: "faces have fewer than three vertices",
    remedy: "left out",
};

static NO_SUCH_NORMAL: Fault = Fault {
    one: "face corner names a normal that does not precede it",
    many: "face corners name a normal that does not precede them",
    remedy: "shaded flat there",
};

static BYTE_COLORS: Fault = Fault {
    one: "vertex colour is above 1",
    many: "vertex colours are above 1",
    remedy: "taken as out of 255",
};

static NO_SUCH_COORDINATES: Fault = Fault {
    one: "face corner names a texture coordinate that does not precede it",
    many: "face corners name texture coordinates that do not precede them",
    remedy: "taken as 0",
};

/// A corner's normal or texture coordinates where it has none.
const NONE: u32 = u32::MAX;

/// A corner of a face: its vertex, and its normal and texture coordinates or [`NONE`].
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    normal: u32,
    coordinates: u32,
}

/// Whether one of the first lines is a vertex or names a material file.
fn recognises(bytes: &[u8]) -> bool {
    let mut lines = bytes[..bytes.len().min(4096)].split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    lines.any(|line| line.starts_with(b"v ") || line.starts_with(b"mtllib "))
}

fn load(input: &Input<'_>) -> Result<Scene, LoadError> {
    let mut parser = Parser {
        cursor: Cursor::new(input.path, input.bytes),
        notes: Notes::new(input.path, input.options.strict),
        mesh: RawMesh::default(),
        normals: Vec::new(),
        corner_normals: Vec::new(),
        may_be_textured: memchr::memmem::find(input.bytes, b"mtllib").is_some(),
        coordinates: Vec::new(),
        corner_coordinates: Vec::new(),
        polygon: Vec::new(),
        libraries: Vec::new(),
        material: None,
        materials: HashMap::new(),
        left_out: Vec::new(),
    };
    parser.parse()?;
    parser.finish(input)
}

/// What has been read so far.
struct Parser<'a> {
    cursor: Cursor<'a>,
    notes: Notes,
    /// Positions and colours as in the file; triangles with indices into them.
    mesh: RawMesh,
    /// The `vn` of the file.
    normals: Vec<Vec3>,
    /// Per triangle, its corners' normals; shorter where the last ones have none.
    corner_normals: Vec<[u32; 3]>,
    /// Whether any material may have textures; else texture coordinates are passed over.
    may_be_textured: bool,
    /// The `vt` of the file, v turned to run down.
    coordinates: Vec<[f32; 2]>,
    /// Per triangle, its corners' texture coordinates; shorter where the last ones have none.
    corner_coordinates: Vec<[u32; 3]>,
    /// The corners of the face being read.
    polygon: Vec<Corner>,
    /// The operands of `mtllib`.
    libraries: Vec<(&'a [u8], usize)>,
    /// The name that the triangles being read are of, if any.
    material: Option<&'a [u8]>,
    /// The names in use, and their numbers in order of first use.
    materials: HashMap<Option<&'a [u8]>, MaterialId>,
    /// Statements that are not understood, with how many there are and where the first is.
    left_out: Vec<(&'a [u8], usize, usize)>,
}

impl<'a> Parser<'a> {
    /// Reads all statements.
    fn parse(&mut self) -> Result<(), LoadError> {
        while !self.cursor.at_end() {
            self.cursor.skip_blanks_and_continuations();
            let start = self.cursor.offset();
            match self.cursor.word() {
                b"v" => self.vertex()?,
                b"f" => self.face()?,
                b"vn" => self.normal()?,
                b"vt" if self.may_be_textured => self.texture_coordinates()?,
                b"vt" | b"g" | b"o" | b"s" | b"" => {}
                b"usemtl" => {
                    self.end_material();
                    self.material = Some(self.cursor.rest_of_line());
                }
                b"mtllib" => self.libraries.push((self.cursor.rest_of_line(), start)),
                word if word.starts_with(b"#") => {
                    self.cursor.next_line();
                    continue;
                }
                word => self.leave_out(word, start)?,
            }
            self.skip_statement();
        }
        self.end_material();
        Ok(())
    }

    /// Steps to the next statement, over lines that a backslash joins (but in a comment it is just a backslash).
    fn skip_statement(&mut self) {
        self.cursor.skip_blanks();
        if !self.cursor.at_line_end() && self.cursor.peek() != Some(b'#') {
            while self.cursor.rest_of_line().ends_with(b"\\") && !self.cursor.at_end() {
                self.cursor.next_line();
            }
        }
        self.cursor.next_line();
    }

    /// Whether the statement ends here, be it with a comment.
    fn at_statement_end(&mut self) -> bool {
        self.cursor.skip_blanks_and_continuations();
        self.cursor.at_line_end() || self.cursor.peek() == Some(b'#')
    }

    /// Three numbers.
    fn vector(&mut self) -> Result<Vec3, LoadError> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            self.cursor.skip_blanks_and_continuations();
            match self.cursor.number() {
                Some(value) => *number = value,
                None => return Err(self.cursor.unexpected("a number (x, y and z)")),
            }
        }
        Ok(Vec3::from(numbers))
    }

    /// `v x y z`, and possibly `w` or `r g b`.
    fn vertex(&mut self) -> Result<(), LoadError> {
        let start = self.cursor.offset();
        let position = self.vector()?;
        if !position.is_finite() {
            self.notes.mend(&NOT_FINITE, || self.cursor.place_of(start))?;
        }

        let mut more = [0.0; 4];
        let mut count = 0;
        while count < more.len() && !self.at_statement_end() {
            match self.cursor.number() {
                Some(value) => more[count] = value,
                None => return Err(self.cursor.unexpected("a number (a weight or colour)")),
            }
            count += 1;
        }
        if count >= 3 {
            self.vertex_color([more[0], more[1], more[2]], start)?;
        } else if !self.mesh.colors.is_empty() {
            self.mesh.colors.push(Rgb::ONE);
        }
        self.mesh.positions.push(position);
        Ok(())
    }

    /// The colour of the vertex that is about to be added, as the eye sees it (sRGB), which is how the programs that write
    /// such files store it.
    fn vertex_color(&mut self, color: [f32; 3], start: usize) -> Result<(), LoadError> {
        let mut encoded = color;
        if color.iter().any(|&channel| channel > 1.0) {
            self.notes.mend(&BYTE_COLORS, || self.cursor.place_of(start))?;
            encoded = color.map(|channel| channel / 255.0);
        }
        self.mesh.colors.resize(self.mesh.positions.len(), Rgb::ONE);
        self.mesh.colors.push(Rgb::from(encoded.map(srgb_to_linear)));
        Ok(())
    }

    /// `vn x y z`.
    fn normal(&mut self) -> Result<(), LoadError> {
        let normal = self.vector()?;
        self.normals.push(normal);
        Ok(())
    }

    /// `vt u`, and possibly `v` and `w`.
    fn texture_coordinates(&mut self) -> Result<(), LoadError> {
        self.cursor.skip_blanks_and_continuations();
        let Some(u) = self.cursor.number() else {
            return Err(self.cursor.unexpected("a number (a texture coordinate)"));
        };
        self.cursor.skip_blanks_and_continuations();
        let v = self.cursor.number().unwrap_or(0.0);
        // In OBJ v runs up, in images down.
        self.coordinates.push([u, 1.0 - v]);
        Ok(())
    }

    /// `f` and three or more corners.
    fn face(&mut self) -> Result<(), LoadError> {
        let start = self.cursor.offset();
        self.polygon.clear();
        let (mut has_normals, mut has_coordinates) = (false, false);
        while !self.at_statement_end() {
            let corner = self.corner()?;
            has_normals |= corner.normal != NONE;
            has_coordinates |= corner.coordinates != NONE;
            self.polygon.push(corner);
        }
        if self.polygon.len() < 3 {
            return self.notes.mend(&TOO_FEW_CORNERS, || self.cursor.place_of(start));
        }

        let Self { polygon, mesh, corner_normals, corner_coordinates, .. } = self;
        let RawMesh { positions, triangles, .. } = mesh;
        if has_normals {
            corner_normals.resize(triangles.len(), [NONE; 3]);
        }
        if has_coordinates {
            corner_coordinates.resize(triangles.len(), [NONE; 3]);
        }
        let careful = polygon::triangulate(
            polygon.len(),
            |i| positions[polygon[i].vertex as usize],
            |triangle| {
                triangles.push(triangle.map(|i| polygon[i].vertex));
                if has_normals {
                    corner_normals.push(triangle.map(|i| polygon[i].normal));
                }
                if has_coordinates {
                    corner_coordinates.push(triangle.map(|i| polygon[i].coordinates));
                }
            },
        );
        if careful {
            Ok(())
        } else {
            self.notes.mend(&TOO_MANY_CORNERS, || self.cursor.place_of(start))
        }
    }

    /// `7`, `7/3`, `7//5` or `7/3/5`: vertex, texture coordinates and normal, here counted from 0.
    #[inline]
    fn corner(&mut self) -> Result<Corner, LoadError> {
        let start = self.cursor.offset();
        let Some(index) = self.cursor.integer() else {
            return Err(self.cursor.unexpected("a vertex index"));
        };
        let Some(vertex) = resolve(index, self.mesh.positions.len()) else {
            return Err(self.no_such_vertex(index));
        };

        let (mut normal, mut coordinates) = (NONE, NONE);
        if self.cursor.take(b'/') {
            // What is between the strokes may be missing.
            if let Some(index) = self.cursor.integer()
                && self.may_be_textured
            {
                match resolve(index, self.coordinates.len()) {
                    Some(found) => coordinates = found,
                    None => {
                        self.notes.mend(&NO_SUCH_COORDINATES, || self.cursor.place_of(start))?;
                    }
                }
            }
            if self.cursor.take(b'/')
                && let Some(index) = self.cursor.integer()
            {
                match resolve(index, self.normals.len()) {
                    Some(found) => normal = found,
                    None => self.notes.mend(&NO_SUCH_NORMAL, || self.cursor.place_of(start))?,
                }
            }
        }
        let ended =
            matches!(self.cursor.peek(), None | Some(b' ' | b'\t' | b'\n' | b'\r' | b'#' | b'\\'));
        if !ended {
            self.cursor.set_offset(start);
            let forms = "a corner like 7, 7/3, 7//5 or 7/3/5";
            return Err(self.cursor.unexpected(forms));
        }
        Ok(Corner { vertex, normal, coordinates })
    }

    /// A face corner names a vertex that is not there.
    #[cold]
    fn no_such_vertex(&self, index: i64) -> LoadError {
        if index == 0 {
            return self.cursor.error("face uses vertex 0, but the first vertex is 1");
        }
        let precede = match self.mesh.positions.len() {
            0 => "no vertices precede it".to_owned(),
            1 => "only 1 vertex precedes it".to_owned(),
            count => format!("only {count} vertices precede it"),
        };
        self.cursor.error(format!("face uses vertex {index}, but {precede}"))
    }

    /// Counts a statement that is not understood. A file that begins with one and has nothing else is no OBJ.
    fn leave_out(&mut self, word: &'a [u8], start: usize) -> Result<(), LoadError> {
        const MOST: usize = 16;
        if let Some((_, count, _)) = self.left_out.iter_mut().find(|(known, ..)| *known == word) {
            *count += 1;
        } else if self.left_out.len() < MOST {
            self.left_out.push((word, 1, start));
        } else if self.mesh.positions.is_empty() {
            let found = quoted(self.left_out[0].0);
            let place = self.cursor.place_of(self.left_out[0].2);
            let message = format!("found {found}, expected an OBJ statement such as v or f");
            return Err(self.cursor.error_at(place, message));
        }
        Ok(())
    }

    /// Gives the triangles read since the last `usemtl` their material.
    fn end_material(&mut self) {
        let triangles = self.mesh.triangles.len();
        if triangles > self.mesh.materials.len() {
            let next = self.materials.len() as MaterialId;
            let id = *self.materials.entry(self.material).or_insert(next);
            self.mesh.materials.resize(triangles, id);
        }
    }

    /// Puts normals to vertices and materials to names.
    fn finish(mut self, input: &Input<'_>) -> Result<Scene, LoadError> {
        self.say_what_is_left_out()?;
        let mut known = HashMap::new();
        for (operand, start) in &self.libraries {
            let place = || self.cursor.place_of(*start);
            mtl::load_named(input, operand, place, &mut self.notes, &mut known)?;
        }
        let mut materials = vec![Material::default(); self.materials.len()];
        let mut used: Vec<_> = self.materials.iter().map(|(name, id)| (*id, *name)).collect();
        used.sort_unstable();
        let mut unknown = Vec::new();
        let mut images = mtl::Images::default();
        for (id, name) in used {
            let material = &mut materials[id as usize];
            match name.map(|name| (name, known.get(name))) {
                Some((name, Some(found))) => {
                    let name = String::from_utf8_lossy(name).into_owned();
                    *material = found.material(name, &mut images);
                }
                Some((name, None)) => {
                    material.name = String::from_utf8_lossy(name).into_owned();
                    unknown.push(quoted(name));
                }
                // Colours of vertices are the whole colour where no material says otherwise.
                None if !self.mesh.colors.is_empty() => material.diffuse = Rgb::ONE,
                None => {}
            }
        }
        if !unknown.is_empty() {
            const SHOWN: usize = 3;
            let count = counted(unknown.len(), "material");
            let verb = if unknown.len() == 1 { "is" } else { "are" };
            let dots = if unknown.len() > SHOWN { ", ..." } else { "" };
            unknown.truncate(SHOWN);
            let problem =
                format!("{count} {verb} not defined by any file ({}{dots})", unknown.join(", "));
            self.notes.mend_line(Place::File, &problem, "shown in grey")?;
        }

        // Vertices by what their corners have; texture coordinates only where a texture reads them.
        if materials.iter().all(|material| material.textures.is_none()) {
            self.corner_coordinates.clear();
        }
        self.split_vertices();
        let error = |place, message| LoadError::new(input.path, place, message);
        let images = images.load(|file| file.read(), |_| Place::File, error, &mut self.notes)?;

        let mesh = self.mesh.finish(input)?;
        let warnings = self.notes.into_warnings();
        Ok(Scene { mesh, materials, images, warnings, ..Scene::default() })
    }

    /// Gives every vertex its normal and texture coordinates.
    fn split_vertices(&mut self) {
        let Self { mesh, normals, coordinates, corner_normals, corner_coordinates, .. } = self;
        let (has_normals, has_coordinates) =
            (!corner_normals.is_empty(), !corner_coordinates.is_empty());
        if !has_normals && !has_coordinates {
            return;
        }
        corner_normals.resize(mesh.triangles.len(), [NONE; 3]);
        corner_coordinates.resize(mesh.triangles.len(), [NONE; 3]);
        let corners = corner_normals.iter().zip(&*corner_coordinates);
        let corners: Vec<_> =
            corners.map(|(n, c)| [[n[0], c[0]], [n[1], c[1]], [n[2], c[2]]]).collect();
        let found = split(mesh, &corners);
        if has_normals {
            let normal = |[index, _]: &Attributes| normals.get(*index as usize).copied();
            mesh.normals = found.iter().map(|f| normal(f).unwrap_or(Vec3::ZERO)).collect();
        }
        if has_coordinates {
            let place = |[_, index]: &Attributes| coordinates.get(*index as usize).copied();
            mesh.texture_coordinates[0] =
                found.iter().map(|f| place(f).unwrap_or([0.0, 1.0])).collect();
        }
    }

    /// Says what was passed over: one line for lines and points, one for all else.
    fn say_what_is_left_out(&mut self) -> Result<(), LoadError> {
        if let [(word, _, start), ..] = self.left_out[..]
            && self.mesh.positions.is_empty()
            && self.libraries.is_empty()
        {
            let place = self.cursor.place_of(start);
            let message =
                format!("found {}, expected an OBJ statement such as v or f", quoted(word));
            return Err(self.cursor.error_at(place, message));
        }
        let (mut shapes, mut others) = (Vec::new(), Vec::new());
        for &(word, count, _) in &self.left_out {
            match word {
                b"l" => shapes.push(counted(count, "line statement")),
                b"p" => shapes.push(counted(count, "point statement")),
                _ => others.push(format!("{} ({count})", quoted(word))),
            }
        }
        if !shapes.is_empty() {
            let list = shapes.join(" and ");
            self.notes.say(format!("{list} left out: only faces are shown"));
        }
        if !others.is_empty() {
            let list = others.join(", ");
            self.notes.say(format!("statements left out because they are not known here: {list}"));
        }
        Ok(())
    }
}

/// An index of OBJ (from 1, or from the end backwards) as an index from 0, if there is such an element.
#[inline]
fn resolve(index: i64, count: usize) -> Option<u32> {
    let count = i64::try_from(count).ok()?;
    let from_zero = if index > 0 { index - 1 } else { count + index };
    let in_range = index != 0 && from_zero >= 0 && from_zero < count;
    if in_range { u32::try_from(from_zero).ok() } else { None }
}

/// The numbers of a corner's normal and texture coordinates, or [`NONE`].
type Attributes = [u32; 2];

/// Tells every vertex its normal and texture coordinates. A vertex that faces use with several becomes several vertices: the first stay with it, the others
/// go to copies at the end, linked in a chain from the vertex.
fn split(mesh: &mut RawMesh, corners: &[[Attributes; 3]]) -> Vec<Attributes> {
    /// Chains stop growing here, so that no file makes searching them slow; one copy too many does no harm.
    const LONGEST: usize = 32;

    // No vertex yet, or the end of a chain, is `NONE` as well.
    let mut attributes_of = vec![[NONE; 2]; mesh.positions.len()];
    let mut is_used = vec![false; mesh.positions.len()];
    let mut next = vec![NONE; mesh.positions.len()];
    for (triangle, wanted) in mesh.triangles.iter_mut().zip(corners) {
        for (vertex, &wanted) in triangle.iter_mut().zip(wanted) {
            let original = *vertex as usize;
            if !is_used[original] {
                is_used[original] = true;
                attributes_of[original] = wanted;
                continue;
            }
            let mut found = original;
            let mut length = 0;
            while attributes_of[found] != wanted && next[found] != NONE && length < LONGEST {
                found = next[found] as usize;
                length += 1;
            }
            if attributes_of[found] != wanted {
                let Ok(copy) = u32::try_from(mesh.positions.len()) else { continue };
                mesh.positions.push(mesh.positions[original]);
                if let Some(&color) = mesh.colors.get(original) {
                    mesh.colors.push(color);
                }
                attributes_of.push(wanted);
                next.push(next[original]);
                next[original] = copy;
                found = copy as usize;
            }
            *vertex = found as u32;
        }
    }
    attributes_of
}
