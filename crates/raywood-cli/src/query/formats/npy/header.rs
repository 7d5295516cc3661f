//! The header of an array: its type, order and shape.

use std::io::{self, Read};

use super::element::Element;
use crate::query::field::{self, Field};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// A longer header is refused before memory is spent on it.
const LONGEST: u32 = 1 << 16;

/// Numbers begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// What the header of an array tells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) element: Element,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<u64>,
    /// How many bytes come before the numbers.
    pub(super) length: u64,
}

/// Why there is no header.
#[derive(Debug)]
pub(super) enum HeaderError {
    Io(io::Error),
    Wrong(String),
}

impl Header {
    /// Reads a header.
    pub(super) fn read(reader: &mut dyn Read) -> Result<Self, HeaderError> {
        let mut start = [0; 8];
        read_exact(reader, &mut start)?;
        if start[..6] != *MAGIC {
            return wrong("not an array of numpy, as numpy.save writes it");
        }
        let length_bytes = match start[6] {
            1 => 2,
            2 | 3 => 4,
            version => return wrong(format!("version {version} of the format, expected 1 to 3")),
        };
        let mut length = [0; 4];
        read_exact(reader, &mut length[..length_bytes])?;
        let length = u32::from_le_bytes(length);
        if length > LONGEST {
            return wrong(format!("a header of {length} bytes, expected at most {LONGEST}"));
        }
        let mut text = vec![0; length as usize];
        read_exact(reader, &mut text)?;

        let text = String::from_utf8_lossy(&text);
        let Some((descr, fortran_order, shape)) = dictionary(&text) else {
            return wrong(format!(
                "a header that is no description of an array: {}",
                start_of(&text)
            ));
        };
        let Some(element) = Element::of_name(&descr) else {
            return wrong(format!(
                "an array of type {}, expected float32, float64 or integers",
                start_of(&descr)
            ));
        };
        let length = (start.len() + length_bytes) as u64 + u64::from(length);
        Ok(Self { element, fortran_order, shape, length })
    }
}

/// The beginning of a text, fit for a message.
fn start_of(text: &str) -> String {
    text.trim().chars().take(80).map(|c| if c.is_control() { '?' } else { c }).collect()
}

fn wrong<T>(message: impl Into<String>) -> Result<T, HeaderError> {
    Err(HeaderError::Wrong(message.into()))
}

fn read_exact(reader: &mut dyn Read, bytes: &mut [u8]) -> Result<(), HeaderError> {
    reader.read_exact(bytes).map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => {
            HeaderError::Wrong("not an array of numpy: it ends within the header".to_owned())
        }
        _ => HeaderError::Io(error),
    })
}

/// Type, order and shape of a dictionary with just these; a structured type as its text.
fn dictionary(text: &str) -> Option<(String, bool, Vec<u64>)> {
    let mut text = Text(text.trim());
    let (mut descr, mut fortran_order, mut shape) = (None, None, None);
    text.take("{")?;
    while text.take("}").is_none() {
        let key = text.string()?;
        text.take(":")?;
        match key {
            "descr" => descr = Some(text.string().or_else(|| text.list())?.to_owned()),
            "fortran_order" => {
                fortran_order =
                    text.take("True").map(|()| true).or_else(|| text.take("False").map(|()| false));
            }
            "shape" => shape = Some(text.shape()?),
            _ => return None,
        }
        if text.take(",").is_none() && !text.0.starts_with('}') {
            return None;
        }
    }
    text.0.is_empty().then_some((descr?, fortran_order?, shape?))
}

/// What is left of a text. Each step takes something from its beginning and the spaces behind it.
struct Text<'a>(&'a str);

impl<'a> Text<'a> {
    fn take(&mut self, what: &str) -> Option<()> {
        self.0 = self.0.strip_prefix(what)?.trim_start();
        Some(())
    }

    fn string(&mut self) -> Option<&'a str> {
        let quote = self.0.chars().next().filter(|&c| c == '\'' || c == '"')?;
        let (string, rest) = self.0[1..].split_once(quote)?;
        self.0 = rest.trim_start();
        Some(string)
    }

    /// A list, brackets within it included.
    fn list(&mut self) -> Option<&'a str> {
        let mut depth = 0;
        for (place, character) in self.0.char_indices() {
            match character {
                '[' => depth += 1,
                ']' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                let (list, rest) = self.0.split_at(place + character.len_utf8());
                self.0 = rest.trim_start();
                return list.starts_with('[').then_some(list);
            }
        }
        None
    }

    fn shape(&mut self) -> Option<Vec<u64>> {
        self.take("(")?;
        let mut shape = Vec::new();
        while self.take(")").is_none() {
            let end = self.0.find(|c: char| !c.is_ascii_digit())?;
            let (digits, rest) = self.0.split_at(end);
            shape.push(digits.parse().ok()?);
            // Python 2 wrote long numbers so.
            self.0 = rest.strip_prefix('L').unwrap_or(rest).trim_start();
            if self.take(",").is_none() && !self.0.starts_with(')') {
                return None;
            }
        }
        Some(shape)
    }
}

/// The header of an array to write, of this type (as Python writes it) and shape, in C order. It is as long for any number of rows.
pub(in crate::query) fn header(descr: &str, rows: u64, width: usize) -> Vec<u8> {
    let columns = if width > 1 { format!(" {width}") } else { String::new() };
    let dictionary = |rows: u64| {
        format!("{{'descr': {descr}, 'fortran_order': False, 'shape': ({rows},{columns}), }}")
    };
    let longest = MAGIC.len() + 4 + dictionary(u64::MAX).len() + 1;
    let length = longest.next_multiple_of(ALIGNMENT);
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    // The few columns there are never make it longer than 16 bits can tell.
    bytes.extend(((length - MAGIC.len() - 4) as u16).to_le_bytes());
    bytes.extend(dictionary(rows).as_bytes());
    bytes.resize(length - 1, b' ');
    bytes.push(b'\n');
    bytes
}

/// The type of a column of answers, as numpy calls it.
pub(in crate::query) fn column_type(field: Field) -> &'static str {
    match field.element() {
        field::Element::F32 => "<f4",
        field::Element::I32 => "<i4",
        field::Element::Bool => "|b1",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dictionaries_as_numpy_writes_them() {
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (100, 6), }   \n";
        assert_eq!(dictionary(text), Some(("<f4".to_owned(), false, vec![100, 6])));
        let text = "{\"shape\":(3L,),\"fortran_order\":True,\"descr\":\">f8\"}";
        assert_eq!(dictionary(text), Some((">f8".to_owned(), true, vec![3])));
        let text =
            "{'descr': [('a', '<f4', (3,)), ('b', '|b1')], 'fortran_order': False, 'shape': (), }";
        let (descr, _, shape) = dictionary(text).expect("a dictionary");
        assert_eq!((descr.as_str(), shape.len()), ("[('a', '<f4', (3,)), ('b', '|b1')]", 0));
        for bad in [
            "",
            "{",
            "{}",
            "{'descr': '<f4', 'fortran_order': False}",
            "{'descr': '<f4', 'fortran_order': 1, 'shape': (1,)}",
            "{'descr': '<f4' 'fortran_order': True, 'shape': (1,)}",
            "{'descr': '<f4', 'fortran_order': True, 'shape': (-1,)}",
            "{'descr': '<f4', 'fortran_order': True, 'shape': (99999999999999999999,)}",
            "{'descr': '<f4', 'fortran_order': True, 'shape': (1,)} x",
            "{'descr': [, 'fortran_order': True, 'shape': (1,)}",
            "{'descr': é, 'fortran_order': True, 'shape': (1,)}",
        ] {
            assert_eq!(dictionary(bad), None, "{bad}");
        }
    }

    #[test]
    fn what_is_written_can_be_read_and_is_as_long_for_any_number_of_rows() {
        let lengths = [0, 7, u64::MAX].map(|rows| {
            let bytes = header("'<f4'", rows, 3);
            let header = Header::read(&mut bytes.as_slice()).expect("a header");
            assert_eq!((header.shape, header.fortran_order), (vec![rows, 3], false));
            assert_eq!(header.length, bytes.len() as u64);
            bytes.len()
        });
        assert_eq!(lengths, [lengths[0]; 3]);
        assert_eq!(lengths[0] % ALIGNMENT, 0);
        assert_eq!(Header::read(&mut header("'<f4'", 7, 1).as_slice()).expect("one").shape, [7]);
    }
}
