//! The values after the header of a PLY file, as text or in binary, behind one interface.

use std::path::Path;

use super::header::{Element, Kind, Scalar};
use crate::error::{LoadError, Place};
use crate::formats::Input;
use crate::formats::text::Cursor;

/// Reads the values of elements, one after the other.
pub(super) trait Values {
    /// The file's name.
    fn path(&self) -> &Path;
    /// Where in the file the next value stands.
    fn offset(&self) -> usize;
    /// Goes back to an element.
    fn set_offset(&mut self, offset: usize);
    /// How to name a place to a reader.
    fn place_of(&self, offset: usize) -> Place;
    /// Reads the single numbers of one element, each into its slot of `row`, and skips lists.
    fn row(&mut self, element: &Element, slots: &[usize], row: &mut [f32])
    -> Result<(), LoadError>;
    /// Reads one list of one element, as vertex indices, and skips the rest. Numbers that are no index become `u32::MAX`.
    fn list(
        &mut self,
        element: &Element,
        list: usize,
        indices: &mut Vec<u32>,
    ) -> Result<(), LoadError>;
    /// Skips all elements of a kind.
    fn skip(&mut self, element: &Element) -> Result<(), LoadError>;
    /// What to say if something follows the last element.
    fn surplus(&mut self) -> Option<String>;
}

/// Values as text: one line for each element, so that a missing number does not shift all that follow.
pub(super) struct Ascii<'a> {
    path: &'a Path,
    cursor: Cursor<'a>,
}

impl<'a> Ascii<'a> {
    /// The values that begin at an offset.
    pub(super) fn new(input: &Input<'a>, offset: usize) -> Self {
        let mut cursor = Cursor::new(input.path, input.bytes);
        cursor.set_offset(offset);
        Self { path: input.path, cursor }
    }

    /// Steps to the next line that has values.
    #[inline]
    fn begin(&mut self, element: &Element) -> Result<(), LoadError> {
        self.cursor.skip_space();
        if self.cursor.at_end() { Err(self.too_few(element)) } else { Ok(()) }
    }

    /// Checks that a line has no more values.
    #[inline]
    fn end(&mut self, element: &Element) -> Result<(), LoadError> {
        self.cursor.skip_blanks();
        if !self.cursor.at_line_end() {
            let expected =
                format!("the end of the line: all properties of {} are read", element.name);
            return Err(self.cursor.unexpected(&expected));
        }
        self.cursor.next_line();
        Ok(())
    }

    /// A number.
    #[inline]
    fn number(&mut self, element: &Element, property: usize) -> Result<f32, LoadError> {
        self.cursor.skip_blanks();
        match self.cursor.number() {
            Some(value) => Ok(value),
            None => Err(self.missing(element, property)),
        }
    }

    /// The length of a list, which the rest of the file must be able to hold.
    #[inline]
    fn length(&mut self, element: &Element, property: usize) -> Result<usize, LoadError> {
        self.cursor.skip_blanks();
        let length = self.cursor.integer().ok_or_else(|| self.missing(element, property))?;
        let most = self.cursor.remaining() / 2;
        usize::try_from(length).ok().filter(|&length| length <= most).ok_or_else(|| {
            let left = self.cursor.remaining();
            let message = format!("a list of {length} values, but only {left} bytes follow");
            self.cursor.error(message)
        })
    }

    #[cold]
    fn missing(&self, element: &Element, property: usize) -> LoadError {
        let name = &element.properties[property].name;
        self.cursor.unexpected(&format!("a number ({name} of {})", element.name))
    }

    #[cold]
    fn too_few(&self, element: &Element) -> LoadError {
        let (count, name) = (element.count, &element.name);
        self.cursor
            .error(format!("the file ends, but the header promises {count} of element {name}"))
    }
}

impl Values for Ascii<'_> {
    fn path(&self) -> &Path {
        self.path
    }

    fn offset(&self) -> usize {
        self.cursor.offset()
    }

    fn set_offset(&mut self, offset: usize) {
        self.cursor.set_offset(offset);
    }

    fn place_of(&self, offset: usize) -> Place {
        let mut cursor = self.cursor.clone();
        cursor.set_offset(offset);
        cursor.skip_space();
        cursor.place()
    }

    #[inline]
    fn row(
        &mut self,
        element: &Element,
        slots: &[usize],
        row: &mut [f32],
    ) -> Result<(), LoadError> {
        self.begin(element)?;
        for (i, (property, &slot)) in element.properties.iter().zip(slots).enumerate() {
            match property.kind {
                Kind::Scalar(_) => row[slot] = self.number(element, i)?,
                Kind::List { .. } => {
                    for _ in 0..self.length(element, i)? {
                        self.number(element, i)?;
                    }
                }
            }
        }
        self.end(element)
    }

    #[inline]
    fn list(
        &mut self,
        element: &Element,
        list: usize,
        indices: &mut Vec<u32>,
    ) -> Result<(), LoadError> {
        self.begin(element)?;
        for (i, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(_) => {
                    self.number(element, i)?;
                }
                Kind::List { .. } if i == list => {
                    for _ in 0..self.length(element, i)? {
                        self.cursor.skip_blanks();
                        let index =
                            self.cursor.integer().ok_or_else(|| self.missing(element, i))?;
                        indices.push(u32::try_from(index).unwrap_or(u32::MAX));
                    }
                }
                Kind::List { .. } => {
                    for _ in 0..self.length(element, i)? {
                        self.number(element, i)?;
                    }
                }
            }
        }
        self.end(element)
    }

    fn skip(&mut self, element: &Element) -> Result<(), LoadError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        for _ in 0..element.count {
            self.begin(element)?;
            self.cursor.next_line();
        }
        Ok(())
    }

    fn surplus(&mut self) -> Option<String> {
        self.cursor.skip_space();
        if self.cursor.at_end() {
            return None;
        }
        Some(format!("{}: what follows the last element is left out", self.cursor.place()))
    }
}

/// Values in binary, little-endian or not.
pub(super) struct Binary<'a, const LITTLE: bool> {
    path: &'a Path,
    /// The bytes of the file up to `at` have been read.
    bytes: &'a [u8],
    at: usize,
}

impl<'a, const LITTLE: bool> Binary<'a, LITTLE> {
    /// The values that begin at an offset.
    pub(super) fn new(input: &Input<'a>, offset: usize) -> Self {
        Self { path: input.path, bytes: input.bytes, at: offset }
    }

    /// The next bytes.
    #[inline]
    fn take(&mut self, length: usize, element: &Element) -> Result<&'a [u8], LoadError> {
        match self.bytes[self.at..].get(..length) {
            Some(bytes) => {
                self.at += length;
                Ok(bytes)
            }
            None => Err(self.too_few(length, element)),
        }
    }

    #[cold]
    fn too_few(&self, length: usize, element: &Element) -> LoadError {
        let left = self.bytes.len() - self.at;
        let message = format!(
            "the file ends within an element {}: {length} more bytes expected, {left} follow",
            element.name
        );
        LoadError::new(self.path, Place::Byte(self.at), message)
    }

    /// A list's length, and its bytes.
    #[inline]
    fn items(
        &mut self,
        count: Scalar,
        item: Scalar,
        element: &Element,
    ) -> Result<&'a [u8], LoadError> {
        let start = self.at;
        let length = integer::<LITTLE>(count, self.take(count.size(), element)?);
        let size = usize::try_from(length).ok().and_then(|n| n.checked_mul(item.size()));
        match size {
            Some(size) => self.take(size, element),
            None => {
                let message = format!("found a list of {length} values, expected none or more");
                Err(LoadError::new(self.path, Place::Byte(start), message))
            }
        }
    }
}

/// A number out of exactly its bytes. (Were there fewer, it would be zero.)
#[inline]
fn number<const LITTLE: bool>(scalar: Scalar, bytes: &[u8]) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(bits::<LITTLE>(bytes) as u32)),
        Scalar::F64 => f64::from_bits(bits::<LITTLE>(bytes)),
        _ => integer::<LITTLE>(scalar, bytes) as f64,
    }
}

/// An integer out of exactly its bytes; a fraction is cut off.
#[inline]
fn integer<const LITTLE: bool>(scalar: Scalar, bytes: &[u8]) -> i64 {
    let bits = bits::<LITTLE>(bytes);
    match scalar {
        Scalar::I8 => i64::from(bits as i8),
        Scalar::I16 => i64::from(bits as i16),
        Scalar::I32 => i64::from(bits as i32),
        Scalar::U8 | Scalar::U16 | Scalar::U32 => bits as i64,
        Scalar::F32 | Scalar::F64 => number::<LITTLE>(scalar, bytes) as i64,
    }
}

/// The bytes of a number as the low bits of a word.
#[inline]
fn bits<const LITTLE: bool>(bytes: &[u8]) -> u64 {
    macro_rules! word {
        ($type:ty, $bytes:expr) => {
            if LITTLE { <$type>::from_le_bytes($bytes) } else { <$type>::from_be_bytes($bytes) }
        };
    }
    match *bytes {
        [a] => u64::from(a),
        [a, b] => u64::from(word!(u16, [a, b])),
        [a, b, c, d] => u64::from(word!(u32, [a, b, c, d])),
        [a, b, c, d, e, f, g, h] => word!(u64, [a, b, c, d, e, f, g, h]),
        _ => 0,
    }
}

impl<const LITTLE: bool> Values for Binary<'_, LITTLE> {
    fn path(&self) -> &Path {
        self.path
    }

    fn offset(&self) -> usize {
        self.at
    }

    fn set_offset(&mut self, offset: usize) {
        self.at = offset.min(self.bytes.len());
    }

    fn place_of(&self, offset: usize) -> Place {
        Place::Byte(offset)
    }

    #[inline]
    fn row(
        &mut self,
        element: &Element,
        slots: &[usize],
        row: &mut [f32],
    ) -> Result<(), LoadError> {
        for (property, &slot) in element.properties.iter().zip(slots) {
            match property.kind {
                Kind::Scalar(scalar) => {
                    let bytes = self.take(scalar.size(), element)?;
                    row[slot] = number::<LITTLE>(scalar, bytes) as f32;
                }
                Kind::List { count, item } => {
                    self.items(count, item, element)?;
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn list(
        &mut self,
        element: &Element,
        list: usize,
        indices: &mut Vec<u32>,
    ) -> Result<(), LoadError> {
        for (i, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(scalar) => {
                    self.take(scalar.size(), element)?;
                }
                Kind::List { count, item } => {
                    let items = self.items(count, item, element)?;
                    if i == list {
                        let mut rest = items;
                        while let Some((bytes, after)) = rest.split_at_checked(item.size())
                            && !bytes.is_empty()
                        {
                            let index = integer::<LITTLE>(item, bytes);
                            indices.push(u32::try_from(index).unwrap_or(u32::MAX));
                            rest = after;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn skip(&mut self, element: &Element) -> Result<(), LoadError> {
        if element.has_fixed_size() {
            // Cannot overflow: the header's promise was checked against the bytes that are there.
            self.take(element.least_size() * element.count, element)?;
            return Ok(());
        }
        for _ in 0..element.count {
            for property in &element.properties {
                match property.kind {
                    Kind::Scalar(scalar) => {
                        self.take(scalar.size(), element)?;
                    }
                    Kind::List { count, item } => {
                        self.items(count, item, element)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn surplus(&mut self) -> Option<String> {
        let left = self.bytes.len() - self.at;
        (left > 0).then(|| format!("{left} bytes after the last element are left out"))
    }
}
