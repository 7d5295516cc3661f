//! The header of a PLY file: which elements follow, and of what numbers each is made.

use std::path::Path;

use crate::error::{LoadError, Place, quoted, shortened};
use crate::formats::Input;
use crate::formats::text::Cursor;

/// How the values after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// One number, or a counted list of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A named value of an element.
#[derive(Debug)]
pub(super) struct Property {
    /// Shortened if long: none that means anything is, and others are only shown.
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A kind of thing in the file, and how many there are.
#[derive(Debug)]
pub(super) struct Element {
    /// Shortened as those of properties are.
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    /// The line that declares it.
    line: Place,
}

/// What a file begins with.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// How many bytes it takes.
    pub(super) length: usize,
}

impl Scalar {
    /// The type of a name, in the old or the new spelling.
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// How many bytes it takes in binary.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

impl Element {
    /// The size of one in binary, with empty lists.
    pub(super) fn least_size(&self) -> usize {
        let size = |property: &Property| match property.kind {
            Kind::Scalar(scalar) => scalar.size(),
            Kind::List { count, .. } => count.size(),
        };
        self.properties.iter().map(size).sum()
    }

    /// Whether all take the same number of bytes in binary.
    pub(super) fn has_fixed_size(&self) -> bool {
        self.properties.iter().all(|property| matches!(property.kind, Kind::Scalar(_)))
    }

    /// An error in its declaration.
    pub(super) fn error(&self, path: &Path, message: impl Into<String>) -> LoadError {
        LoadError::new(path, self.line.clone(), message)
    }
}

impl Header {
    /// Reads the header, and checks its promises against the bytes that follow it.
    pub(super) fn parse(input: &Input<'_>) -> Result<Self, LoadError> {
        let mut cursor = Cursor::new(input.path, input.bytes);
        if cursor.word() != b"ply" {
            cursor.set_offset(0);
            return Err(cursor.unexpected("`ply`, with which every PLY file begins"));
        }
        cursor.next_line();

        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            if cursor.at_end() {
                return Err(cursor.error("the file ends within its header, expected end_header"));
            }
            match cursor.word() {
                b"comment" | b"obj_info" | b"" => {}
                b"format" => encoding = Some(Self::encoding(&mut cursor)?),
                b"element" => elements.push(Self::element(&mut cursor)?),
                b"property" => {
                    let property = Self::property(&mut cursor)?;
                    let Some(element) = elements.last_mut() else {
                        return Err(cursor.error("a property before any element"));
                    };
                    element.properties.push(property);
                }
                b"end_header" => break,
                word => {
                    let found = quoted(word);
                    let expected = "expected format, element, property, comment or end_header";
                    return Err(cursor.error(format!("found {found}, {expected}")));
                }
            }
            cursor.next_line();
        }
        let Some(encoding) = encoding else {
            return Err(cursor.error("the header ends without a format line"));
        };
        cursor.skip_blanks();
        cursor.next_line();

        let header = Self { encoding, elements, length: cursor.offset() };
        header.check_counts(input)?;
        Ok(header)
    }

    /// `format ascii 1.0`
    fn encoding(cursor: &mut Cursor<'_>) -> Result<Encoding, LoadError> {
        match cursor.word() {
            b"ascii" => Ok(Encoding::Ascii),
            b"binary_little_endian" => Ok(Encoding::LittleEndian),
            b"binary_big_endian" => Ok(Encoding::BigEndian),
            word => {
                let found = quoted(word);
                let expected = "expected ascii, binary_little_endian or binary_big_endian";
                Err(cursor.error(format!("found {found}, {expected}")))
            }
        }
    }

    /// `element vertex 8`
    fn element(cursor: &mut Cursor<'_>) -> Result<Element, LoadError> {
        let name = shortened(cursor.word());
        cursor.skip_blanks();
        let count = cursor.integer().and_then(|count| usize::try_from(count).ok());
        let Some(count) = count else {
            return Err(cursor.unexpected("how many of the element there are"));
        };
        Ok(Element { name, count, properties: Vec::new(), line: cursor.place() })
    }

    /// `property float x` or `property list uchar int vertex_indices`
    fn property(cursor: &mut Cursor<'_>) -> Result<Property, LoadError> {
        let mut before = cursor.clone();
        let kind = if cursor.word() == b"list" {
            let count = Self::scalar(cursor)?;
            if count.is_float() {
                return Err(
                    cursor.error("a list's length has the type of a fraction, expected an integer")
                );
            }
            Kind::List { count, item: Self::scalar(cursor)? }
        } else {
            let kind = Kind::Scalar(Self::scalar(&mut before)?);
            *cursor = before;
            kind
        };
        let name = shortened(cursor.word());
        Ok(Property { name, kind })
    }

    /// The type of a number.
    fn scalar(cursor: &mut Cursor<'_>) -> Result<Scalar, LoadError> {
        let name = cursor.word();
        Scalar::named(name).ok_or_else(|| {
            let found = quoted(name);
            cursor.error(format!("found {found}, expected a type such as float, int or uchar"))
        })
    }

    /// Refuses promises that the bytes after the header cannot keep, before anything is allocated for them.
    fn check_counts(&self, input: &Input<'_>) -> Result<(), LoadError> {
        let mut left = (input.bytes.len() - self.length) as u128;
        for element in &self.elements {
            // In text, every value takes a digit and something that ends it, but for the last of the file.
            let least = match self.encoding {
                Encoding::Ascii => 2 * element.properties.len() as u128,
                _ => element.least_size() as u128,
            };
            let needed = least * element.count as u128;
            let spare = u128::from(self.encoding == Encoding::Ascii);
            if needed > left + spare {
                let (count, name) = (element.count, &element.name);
                let message = format!(
                    "the header promises {count} of element {name}, which take at least {needed} bytes, but only {left} follow"
                );
                return Err(element.error(input.path, message));
            }
            left = left.saturating_sub(needed);
        }
        Ok(())
    }
}
