//! A cursor over a text file, made for speed: numbers are parsed where they stand, and lines are counted only when a
//! message has to name one.

use std::path::Path;

use crate::error::{LoadError, Place, quoted};

/// A place in the bytes of a text file, moving forward.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

/// Whether a byte ends a line. Lone carriage returns do, as in very old files.
fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// Whether a byte ends a word.
fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

impl<'a> Cursor<'a> {
    /// A cursor at the beginning (after a byte order mark, if there is one).
    pub(crate) fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { path, bytes, at }
    }

    /// How many bytes lie behind the cursor.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// Moves the cursor.
    pub(crate) fn set_offset(&mut self, offset: usize) {
        self.at = offset.min(self.bytes.len());
    }

    /// How many bytes lie ahead.
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Whether nothing lies ahead.
    pub(crate) fn at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// The byte ahead.
    #[inline]
    pub(crate) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// Steps over the byte ahead if it is this one.
    #[inline]
    pub(crate) fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// The line that the cursor stands in.
    pub(crate) fn place(&self) -> Place {
        self.place_of(self.at)
    }

    /// The line of a byte.
    pub(crate) fn place_of(&self, offset: usize) -> Place {
        let before = &self.bytes[..offset.min(self.bytes.len())];
        let newlines = memchr::memchr_iter(b'\n', before).count();
        if newlines == 0 {
            return Place::Line(1 + memchr::memchr_iter(b'\r', before).count());
        }
        Place::Line(1 + newlines)
    }

    /// An error in the line that the cursor stands in.
    #[cold]
    pub(crate) fn error(&self, message: impl Into<String>) -> LoadError {
        LoadError::new(self.path, self.place(), message)
    }

    /// An error elsewhere in the file.
    #[cold]
    pub(crate) fn error_at(&self, place: Place, message: impl Into<String>) -> LoadError {
        LoadError::new(self.path, place, message)
    }

    /// An error that names the word ahead.
    #[cold]
    pub(crate) fn unexpected(&self, expected: &str) -> LoadError {
        let mut ahead = self.clone();
        match ahead.word() {
            b"" if ahead.at_end() => self.error(format!("the file ends, expected {expected}")),
            b"" => self.error(format!("the line ends, expected {expected}")),
            word => self.error(format!("found {}, expected {expected}", quoted(word))),
        }
    }

    /// Steps over blanks within the line.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | 0x0b | 0x0c)) {
            self.at += 1;
        }
    }

    /// Steps over blanks within the line, and over line ends that a backslash hides.
    #[inline]
    pub(crate) fn skip_blanks_and_continuations(&mut self) {
        self.skip_blanks();
        while self.peek() == Some(b'\\') {
            let rest = &self.bytes[self.at + 1..];
            match rest {
                [b'\r', b'\n', ..] => self.at += 3,
                [b'\n' | b'\r', ..] => self.at += 2,
                [] => self.at += 1,
                _ => return,
            }
            self.skip_blanks();
        }
    }

    /// Steps over blanks and line ends.
    #[inline]
    pub(crate) fn skip_space(&mut self) {
        while self.peek().is_some_and(is_space) {
            self.at += 1;
        }
    }

    /// Whether the line has nothing more; blanks must have been skipped.
    #[inline]
    pub(crate) fn at_line_end(&self) -> bool {
        self.peek().is_none_or(is_line_end)
    }

    /// Steps to the beginning of the next line.
    #[inline]
    pub(crate) fn next_line(&mut self) {
        // Mostly the line end is right here.
        match (self.peek(), self.bytes.get(self.at + 1)) {
            (Some(b'\n'), _) => self.at += 1,
            (Some(b'\r'), Some(b'\n')) => self.at += 2,
            (None, _) => {}
            _ => match memchr::memchr2(b'\n', b'\r', &self.bytes[self.at..]) {
                None => self.at = self.bytes.len(),
                Some(distance) => {
                    let end = self.at + distance;
                    let pair = self.bytes[end] == b'\r' && self.bytes.get(end + 1) == Some(&b'\n');
                    self.at = end + 1 + usize::from(pair);
                }
            },
        }
    }

    /// The rest of the line without blanks at its ends. The cursor stays in the line, at its end.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let ahead = &self.bytes[self.at..];
        let length = memchr::memchr2(b'\n', b'\r', ahead).unwrap_or(ahead.len());
        self.at += length;
        ahead[..length].trim_ascii()
    }

    /// The word ahead, empty at the end of the line; steps over it and the blanks before it.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let ahead = &self.bytes[self.at..];
        let length = ahead.iter().position(|&byte| is_space(byte)).unwrap_or(ahead.len());
        self.at += length;
        &ahead[..length]
    }

    /// The number ahead, if there is one and a space or the end follows it. NaN and infinity count as numbers, in the
    /// spelling of any C library. Blanks must have been skipped.
    #[inline]
    pub(crate) fn number(&mut self) -> Option<f32> {
        let ahead = &self.bytes[self.at..];
        let (value, length) = fast_float2::parse_partial::<f32, _>(ahead).ok()?;
        if ahead.get(length).is_some_and(|&byte| !is_space(byte)) {
            return self.unusual_number();
        }
        self.at += length;
        Some(value)
    }

    /// Not-a-numbers of other spellings: `1.#IND`, `1.#QNAN`, `-1.#INF`, `nan(ind)`, and Fortran's `1d-3`; a
    /// number with a comment or a backslash right after it.
    #[cold]
    fn unusual_number(&mut self) -> Option<f32> {
        let mut after = self.clone();
        let word = after.word().to_ascii_lowercase();
        let unsigned = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(&word);
        let sign = if word.starts_with(b"-") { -1.0 } else { 1.0 };
        let value = if unsigned.starts_with(b"1.#inf") {
            sign * f32::INFINITY
        } else if unsigned.starts_with(b"1.#") || unsigned.starts_with(b"nan(") {
            f32::NAN
        } else if let Some(at) = memchr::memchr2(b'#', b'\\', &word) {
            let value = fast_float2::parse(&word[..at]).ok()?;
            after.at = self.at + at;
            value
        } else {
            let with_e: Vec<u8> = word.iter().map(|&b| if b == b'd' { b'e' } else { b }).collect();
            fast_float2::parse(&with_e).ok()?
        };
        self.at = after.at;
        Some(value)
    }

    /// The decimal integer ahead, if there is one; what follows it is not looked at. One of more than 18 digits is as large as
    /// can be, which is out of every range it is compared with.
    #[inline]
    pub(crate) fn integer(&mut self) -> Option<i64> {
        let ahead = &self.bytes[self.at..];
        let (negative, unsigned) = match ahead.split_first() {
            Some((b'-', rest)) => (true, rest),
            Some((b'+', rest)) => (false, rest),
            _ => (false, ahead),
        };
        let mut value = 0i64;
        let mut digits = 0;
        for byte in unsigned {
            let digit = byte.wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
            digits += 1;
        }
        if digits == 0 {
            return None;
        }
        if digits > 18 {
            value = i64::MAX;
        }
        self.at += ahead.len() - unsigned.len() + digits;
        Some(if negative { -value } else { value })
    }
}
