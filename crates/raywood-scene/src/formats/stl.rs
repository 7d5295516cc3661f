//! STL, the stereolithography format (3D Systems 1988): triangles without any sharing of vertices, as text or in binary.
//!
//! Vertices at exactly the same place become one. The normals of the file are passed over: they are the triangles' own, where
//! they are right at all.

use raywood::Vec3;

use super::notes::{Fault, NOT_FINITE, Notes};
use super::raw_mesh::RawMesh;
use super::text::Cursor;
use super::{Format, Input};
use crate::Scene;
use crate::error::{LoadError, Place};

pub(super) const FORMAT: Format = Format {
    name: "STL",
    extensions: &["stl"],
    description: "an STL file",
    recognises: |bytes| is_binary(bytes) || bytes.starts_with(b"solid"),
    load,
};

/// A title that says nothing.
const HEADER: usize = 80;
/// Where the first facet is, after the title and the number of facets.
const FIRST_FACET: usize = HEADER + 4;
/// Normal, three corners, and two bytes for the writer's own use.
const FACET: usize = 50;

static NOT_THREE_CORNERS: Fault = Fault {
    one: "facet does not have three vertices",
    many: "facets do not have three vertices",
    remedy: "left out, or cut into triangles if there are more",
};

fn load(input: &Input<'_>) -> Result<Scene, LoadError> {
    let mut notes = Notes::new(input.path, input.options.strict);
    let mut welder = Welder::default();
    if is_text(input.bytes) {
        read_text(input, &mut welder, &mut notes)?;
    } else {
        read_binary(input, &mut welder, &mut notes)?;
    }
    let mesh = welder.mesh.finish(input)?;
    // The format does not say, but the programs that write it, for printing and machining, agree on z.
    let up = Some(Vec3::Z);
    Ok(Scene { mesh, up, warnings: notes.into_warnings(), ..Scene::default() })
}

/// The number of facets that the bytes after a binary file's title name.
fn facet_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..FIRST_FACET)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

/// Whether the file is exactly as long as a binary file with its number of facets.
fn is_binary(bytes: &[u8]) -> bool {
    facet_count(bytes)
        .is_some_and(|count| bytes.len() as u64 == FIRST_FACET as u64 + FACET as u64 * count as u64)
}

/// Whether the file is text: it begins with `solid`, as binary files must not but many do; those give themselves away by
/// their length, or by bytes that no text has.
fn is_text(bytes: &[u8]) -> bool {
    let begin = bytes.trim_ascii_start();
    let begin = begin.strip_prefix(b"\xef\xbb\xbf").unwrap_or(begin);
    let start = &bytes[..bytes.len().min(1024)];
    begin.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !is_binary(bytes)
        && !start.contains(&0)
}

/// Facets of 50 bytes each.
fn read_binary(input: &Input<'_>, welder: &mut Welder, notes: &mut Notes) -> Result<(), LoadError> {
    let bytes = input.bytes;
    let error =
        |at: usize, message: String| Err(LoadError::new(input.path, Place::Byte(at), message));
    let Some(count) = facet_count(bytes) else {
        let found = bytes.len();
        let message = format!(
            "the file ends: expected a title of 80 bytes and the number of facets, or text that begins with solid, found {found} bytes"
        );
        return error(found, message);
    };
    let facets = bytes[FIRST_FACET..].chunks_exact(FACET);
    if facets.len() < count {
        let message = format!("the file ends: {count} facets promised, {} are whole", facets.len());
        return error(bytes.len(), message);
    }
    let surplus = bytes.len() - FIRST_FACET - FACET * count;
    if surplus > 0 {
        notes.say(format!("{surplus} bytes after the last facet are left out"));
    }

    welder.reserve(count);
    for (i, facet) in facets.take(count).enumerate() {
        let number = |at: usize| {
            let bytes = facet[at..].first_chunk::<4>().copied().unwrap_or_default();
            f32::from_le_bytes(bytes)
        };
        let corner = |at: usize| Vec3::new(number(at), number(at + 4), number(at + 8));
        let corners = [corner(12), corner(24), corner(36)];
        for corner in corners {
            if !corner.is_finite() {
                notes.mend(&NOT_FINITE, || Place::Byte(FIRST_FACET + FACET * i))?;
            }
        }
        let triangle = corners.map(|corner| welder.vertex(corner));
        welder.mesh.triangles.push(triangle);
    }
    Ok(())
}

/// The words of a text file. Some programs write them in capital letters.
const KEYWORDS: [(&[u8], Keyword); 7] = [
    (b"vertex", Keyword::Vertex),
    (b"facet", Keyword::Facet),
    (b"outer", Keyword::Outer),
    (b"endloop", Keyword::EndLoop),
    (b"endfacet", Keyword::EndFacet),
    (b"solid", Keyword::Solid),
    (b"endsolid", Keyword::EndSolid),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Keyword {
    Vertex,
    Facet,
    Outer,
    EndLoop,
    EndFacet,
    Solid,
    EndSolid,
}

/// `facet normal ... outer loop vertex x y z (three times) endloop endfacet`, over and over.
fn read_text(input: &Input<'_>, welder: &mut Welder, notes: &mut Notes) -> Result<(), LoadError> {
    let mut cursor = Cursor::new(input.path, input.bytes);
    // A facet takes about 250 bytes.
    welder.reserve(input.bytes.len() / 250);
    let mut corners = Vec::new();
    let mut last = None;
    loop {
        cursor.skip_space();
        let start = cursor.offset();
        if cursor.at_end() {
            break;
        }
        let word = cursor.word();
        let keyword = KEYWORDS.iter().find(|(name, _)| word.eq_ignore_ascii_case(name));
        last = keyword.map(|&(_, keyword)| keyword);
        match last {
            Some(Keyword::Vertex) => {
                let corner = vector(&mut cursor)?;
                if !corner.is_finite() {
                    notes.mend(&NOT_FINITE, || cursor.place_of(start))?;
                }
                corners.push(welder.vertex(corner));
            }
            Some(Keyword::EndFacet) => {
                if corners.len() != 3 {
                    notes.mend(&NOT_THREE_CORNERS, || cursor.place_of(start))?;
                }
                welder.mesh.push_polygon(&corners, notes, || cursor.place_of(start))?;
                corners.clear();
            }
            // What else the line says (a normal, a name) is passed over.
            Some(Keyword::Facet | Keyword::Solid | Keyword::EndSolid) => cursor.next_line(),
            Some(Keyword::Outer) => {
                cursor.word();
            }
            Some(Keyword::EndLoop) => {}
            None => {
                cursor.set_offset(start);
                let expected = "facet, outer loop, vertex, endloop, endfacet or endsolid";
                return Err(cursor.unexpected(expected));
            }
        }
    }
    match last {
        Some(Keyword::EndSolid) => Ok(()),
        Some(Keyword::EndFacet | Keyword::Solid) => {
            let problem = "the file ends without endsolid";
            notes.mend_line(cursor.place(), problem, "it may have been cut short")
        }
        _ => Err(cursor.error("the file ends within a facet, expected endfacet and endsolid")),
    }
}

/// Three numbers.
fn vector(cursor: &mut Cursor<'_>) -> Result<Vec3, LoadError> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        cursor.skip_blanks();
        match cursor.number() {
            Some(value) => *number = value,
            None => return Err(cursor.unexpected("a number (x, y and z)")),
        }
    }
    Ok(Vec3::from(numbers))
}

/// Makes vertices at exactly the same place one: a hash table of vertex numbers with linear probing.
#[derive(Default)]
struct Welder {
    mesh: RawMesh,
    /// Vertex numbers, or `EMPTY`; a power of two long, at most half full.
    table: Vec<u32>,
}

const EMPTY: u32 = u32::MAX;
/// Probing stops here, so that no choice of positions makes it slow; a vertex too many does no harm.
const LONGEST_PROBE: usize = 64;

impl Welder {
    /// Prepares for this many facets. A closed mesh has half as many vertices.
    fn reserve(&mut self, facets: usize) {
        self.mesh.triangles.reserve(facets);
        self.mesh.positions.reserve(facets / 2);
        self.table = vec![EMPTY; facets.max(8).next_power_of_two()];
    }

    /// The number of the vertex at a place.
    #[inline]
    fn vertex(&mut self, position: Vec3) -> u32 {
        // Both zeros are the same place.
        let position = position + Vec3::ZERO;
        if self.mesh.positions.len() * 2 >= self.table.len() {
            self.grow();
        }
        let mask = self.table.len() - 1;
        let mut slot = hash(position) & mask;
        for _ in 0..LONGEST_PROBE {
            let vertex = self.table[slot];
            if vertex == EMPTY {
                break;
            }
            if bits(self.mesh.positions[vertex as usize]) == bits(position) {
                return vertex;
            }
            slot = (slot + 1) & mask;
        }
        // A facet takes more than four bytes per vertex, and no file has 2^34 of them.
        let vertex = self.mesh.positions.len() as u32;
        self.mesh.positions.push(position);
        self.table[slot] = vertex;
        vertex
    }

    /// Doubles the table.
    fn grow(&mut self) {
        let size = 2 * self.table.len().max(8);
        self.table.clear();
        self.table.resize(size, EMPTY);
        for (vertex, &position) in (0..).zip(&self.mesh.positions) {
            let mut slot = hash(position) & (size - 1);
            let mut probes = 0;
            while self.table[slot] != EMPTY && probes < LONGEST_PROBE {
                slot = (slot + 1) & (size - 1);
                probes += 1;
            }
            self.table[slot] = vertex;
        }
    }
}

/// The coordinates' bits, which tell exact equality (of NaN too).
#[inline]
fn bits(p: Vec3) -> [u32; 3] {
    [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()]
}

/// A number that spreads positions over the table: multiplication by odd constants, and the high bits of the product.
#[inline]
fn hash(p: Vec3) -> usize {
    let [x, y, z] = bits(p).map(u64::from);
    let mixed =
        (x | y << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ z.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 32) as usize
}
