//! Wavefront OBJ: polygons in text, with materials in MTL files beside it.
//!
//! Read: `v` (with weight or colour), `vn`, `f` in every form of indices, `usemtl`, `mtllib`, `\` at line ends. Passed over:
//! `vt` (textures are not shown yet), `g`, `o`, `s` (a corner without `vn` is shaded flat). Left out with a warning: lines,
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

/// A corner's normal where it has none.
const NO_NORMAL: u32 = u32::MAX;

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
    /// The corners of the face being read: vertex and normal.
    polygon: Vec<(u32, u32)>,
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

    /// `f` and three or more corners.
    fn face(&mut self) -> Result<(), LoadError> {
        let start = self.cursor.offset();
        self.polygon.clear();
        let mut has_normals = false;
        while !self.at_statement_end() {
            let corner = self.corner()?;
            has_normals |= corner.1 != NO_NORMAL;
            self.polygon.push(corner);
        }
        if self.polygon.len() < 3 {
            return self.notes.mend(&TOO_FEW_CORNERS, || self.cursor.place_of(start));
        }

        let Self { polygon, mesh, corner_normals, .. } = self;
        let RawMesh { positions, triangles, .. } = mesh;
        if has_normals {
            corner_normals.resize(triangles.len(), [NO_NORMAL; 3]);
        }
        let careful = polygon::triangulate(
            polygon.len(),
            |i| positions[polygon[i].0 as usize],
            |triangle| {
                triangles.push(triangle.map(|i| polygon[i].0));
                if has_normals {
                    corner_normals.push(triangle.map(|i| polygon[i].1));
                }
            },
        );
        if careful {
            Ok(())
        } else {
            self.notes.mend(&TOO_MANY_CORNERS, || self.cursor.place_of(start))
        }
    }

    /// `7`, `7/3`, `7//5` or `7/3/5`: the vertex and the normal, counted from 0.
    #[inline]
    fn corner(&mut self) -> Result<(u32, u32), LoadError> {
        let start = self.cursor.offset();
        let Some(index) = self.cursor.integer() else {
            return Err(self.cursor.unexpected("a vertex index"));
        };
        let Some(vertex) = resolve(index, self.mesh.positions.len()) else {
            return Err(self.no_such_vertex(index));
        };

        let mut normal = NO_NORMAL;
        if self.cursor.take(b'/') {
            // The texture coordinate between the strokes may be missing, and is not used yet.
            self.cursor.integer();
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
        Ok((vertex, normal))
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
        if !self.corner_normals.is_empty() {
            self.corner_normals.resize(self.mesh.triangles.len(), [NO_NORMAL; 3]);
            split_by_normal(&mut self.mesh, &self.corner_normals, &self.normals);
        }

        let mut known = HashMap::new();
        for (operand, start) in &self.libraries {
            let place = || self.cursor.place_of(*start);
            mtl::load_named(input, operand, place, &mut self.notes, &mut known)?;
        }
        let mut materials = vec![Material::default(); self.materials.len()];
        let mut used: Vec<_> = self.materials.iter().map(|(name, id)| (*id, *name)).collect();
        used.sort_unstable();
        let mut unknown = Vec::new();
        for (id, name) in used {
            let material = &mut materials[id as usize];
            match name.map(|name| (name, known.get(name))) {
                Some((_, Some(found))) => material.clone_from(found),
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

        let mesh = self.mesh.finish(input)?;
        let warnings = self.notes.into_warnings();
        Ok(Scene { mesh, materials, warnings, ..Scene::default() })
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

/// Gives every vertex its normal. A vertex that faces use with several normals becomes several vertices: its first normal stays
/// with it, the others go to copies at the end, linked in a chain from the vertex.
fn split_by_normal(mesh: &mut RawMesh, corner_normals: &[[u32; 3]], normals: &[Vec3]) {
    /// No vertex yet, or the end of a chain.
    const NONE: u32 = u32::MAX;
    /// Chains stop growing here, so that no file makes searching them slow; one copy too many does no harm.
    const LONGEST: usize = 32;

    let mut normal_of = vec![NONE; mesh.positions.len()];
    let mut is_used = vec![false; mesh.positions.len()];
    let mut next = vec![NONE; mesh.positions.len()];
    for (triangle, wanted) in mesh.triangles.iter_mut().zip(corner_normals) {
        for (vertex, &wanted) in triangle.iter_mut().zip(wanted) {
            let original = *vertex as usize;
            if !is_used[original] {
                is_used[original] = true;
                normal_of[original] = wanted;
                continue;
            }
            let mut found = original;
            let mut length = 0;
            while normal_of[found] != wanted && next[found] != NONE && length < LONGEST {
                found = next[found] as usize;
                length += 1;
            }
            if normal_of[found] != wanted {
                let Ok(copy) = u32::try_from(mesh.positions.len()) else { continue };
                mesh.positions.push(mesh.positions[original]);
                if let Some(&color) = mesh.colors.get(original) {
                    mesh.colors.push(color);
                }
                normal_of.push(wanted);
                next.push(next[original]);
                next[original] = copy;
                found = copy as usize;
            }
            *vertex = found as u32;
        }
    }
    let normal = |&index: &u32| normals.get(index as usize).copied().unwrap_or(Vec3::ZERO);
    mesh.normals = normal_of.iter().map(normal).collect();
}
