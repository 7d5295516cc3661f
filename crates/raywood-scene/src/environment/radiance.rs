//! Radiance pictures (`.hdr`): Greg Ward, "Real Pixels", Graphics Gems II, 1991, and the manual of Radiance, "File Formats".
//!
//! | part | contents |
//! | --- | --- |
//! | first line | `#?` and a name |
//! | header | lines `NAME=value`; `FORMAT=32-bit_rle_rgbe`, `EXPOSURE=` a factor that was multiplied already, several of them one after the other |
//! | empty line | |
//! | resolution | `-Y height +X width`: rows from the top, columns from the left |
//! | rows | four bytes a texel, red, green, blue and a common exponent, where ones in red, green and blue stand for the last texel again; or, after the bytes 2, 2 and the width, these four one after the other in runs: a byte above 128 and one that is repeated so often less 128, or a number of bytes and these |

use std::path::Path;

use super::Environment;
use crate::Rgb;
use crate::error::{LoadError, Place, quoted};

/// Decodes a picture.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Environment, LoadError> {
    let fault = |(at, message): Fault| LoadError::new(path, Place::Byte(at), message);
    let mut reader = Reader { bytes, at: 0 };
    let header = reader.header().map_err(fault)?;
    let Header { width, height, factor } = header;
    let most = Environment::LARGEST_EDGE;
    if !(1..=most).contains(&width) || !(1..=most).contains(&height) {
        let message = format!("a picture of {width}x{height}, expected edges from 1 to {most}");
        return Err(LoadError::new(path, Place::File, message));
    }

    // Row by row, so that no more memory is asked for than rows are there.
    let mut texels = Vec::new();
    let mut row = vec![[0u8; 4]; width as usize];
    for _ in 0..height {
        reader.row(&mut row).map_err(fault)?;
        texels.extend(row.iter().map(|&texel| factor * light(texel)));
    }
    let unsound = || LoadError::new(path, Place::File, "is no picture of surroundings");
    Environment::new(width, height, texels).ok_or_else(unsound)
}

/// Where something is wrong, and what.
type Fault = (usize, String);

/// What the header says.
struct Header {
    width: u32,
    height: u32,
    /// What makes radiance of the numbers.
    factor: f32,
}

/// The light of a texel: mantissas in the middle of their steps, and the exponent that they share.
fn light([r, g, b, exponent]: [u8; 4]) -> Rgb {
    if exponent == 0 {
        return Rgb::ZERO;
    }
    // The exponent is off by 128, and mantissas count 256ths.
    let scale = (i32::from(exponent) - 136) as f32;
    scale.exp2() * Rgb::new(f32::from(r) + 0.5, f32::from(g) + 0.5, f32::from(b) + 0.5)
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn fault<T>(&self, message: impl Into<String>) -> Result<T, Fault> {
        Err((self.at, message.into()))
    }

    /// The next so many bytes.
    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let bytes = self.bytes;
        match bytes.get(self.at..).and_then(|rest| rest.get(..count)) {
            Some(taken) => {
                self.at += count;
                Ok(taken)
            }
            None => self.fault("the picture ends here, but more rows are expected"),
        }
    }

    /// The next line, without its end.
    fn line(&mut self) -> Result<&'a [u8], Fault> {
        const LONGEST: usize = 1 << 12;
        let rest = &self.bytes[self.at..];
        let Some(length) = rest.iter().take(LONGEST).position(|&byte| byte == b'\n') else {
            return self.fault("expected a line of a header");
        };
        self.at += length + 1;
        Ok(rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length]))
    }

    fn header(&mut self) -> Result<Header, Fault> {
        let mut exposure = 1.0f32;
        loop {
            let start = self.at;
            let line = self.line()?;
            if line.is_empty() {
                break;
            }
            if let Some(format) = line.strip_prefix(b"FORMAT=") {
                if format != b"32-bit_rle_rgbe" {
                    let found = quoted(format);
                    return Err((start, format!("format {found}, expected 32-bit_rle_rgbe")));
                }
            } else if let Some(value) = line.strip_prefix(b"EXPOSURE=") {
                let number = std::str::from_utf8(value).ok().and_then(|v| v.trim().parse().ok());
                let number = number.filter(|number: &f32| number.is_normal() && *number > 0.0);
                let Some(number) = number else {
                    let found = quoted(value);
                    return Err((start, format!("exposure {found}, expected a number above 0")));
                };
                exposure *= number;
            }
        }

        let start = self.at;
        let line = self.line()?;
        let words: Vec<_> = line.split(|&byte| byte == b' ').collect();
        let number = |word: &[u8]| std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        match words[..] {
            [b"-Y", height, b"+X", width] => match (number(width), number(height)) {
                (Some(width), Some(height)) => {
                    let factor = 1.0 / exposure;
                    Ok(Header { width, height, factor })
                }
                _ => Err((start, format!("resolution {}, expected two numbers", quoted(line)))),
            },
            _ => {
                let found = quoted(line);
                Err((start, format!("resolution {found}, expected -Y HEIGHT +X WIDTH")))
            }
        }
    }

    /// The next row, texel by texel: ones in red, green and blue repeat the last one, several of them by the digits of a number, the lowest first.
    fn plain_row(&mut self, row: &mut [[u8; 4]]) -> Result<(), Fault> {
        let (mut column, mut shift) = (0, 0);
        while column < row.len() {
            let start = self.at;
            let taken = self.take(4)?;
            let texel = [taken[0], taken[1], taken[2], taken[3]];
            if texel[..3] != [1, 1, 1] {
                row[column] = texel;
                (column, shift) = (column + 1, 0);
                continue;
            }
            let count = usize::from(texel[3]) << shift;
            if count == 0 || column == 0 || count > row.len() - column {
                return Err((start, "a run that is empty or longer than its row".to_owned()));
            }
            let last = row[column - 1];
            row[column..column + count].fill(last);
            (column, shift) = (column + count, (shift + 8).min(16));
        }
        Ok(())
    }

    /// The next row.
    fn row(&mut self, row: &mut [[u8; 4]]) -> Result<(), Fault> {
        let width = row.len();
        let [high, low] = [(width >> 8) as u8, width as u8];
        let in_runs =
            (8..1 << 15).contains(&width) && self.bytes[self.at..].starts_with(&[2, 2, high, low]);
        if !in_runs {
            return self.plain_row(row);
        }
        self.at += 4;
        for channel in 0..4 {
            let mut column = 0;
            while column < width {
                let count = usize::from(self.take(1)?[0]);
                let (count, repeats) =
                    if count > 128 { (count - 128, true) } else { (count, false) };
                if count == 0 || count > width - column {
                    return self.fault("a run that is empty or longer than its row");
                }
                let values = self.take(if repeats { 1 } else { count })?;
                for (i, texel) in row[column..column + count].iter_mut().enumerate() {
                    texel[channel] = values[if repeats { 0 } else { i }];
                }
                column += count;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(resolution: &str, rows: &[u8]) -> Vec<u8> {
        let header = format!("#?RADIANCE\n# made\nFORMAT=32-bit_rle_rgbe\n\n{resolution}\n");
        [header.as_bytes(), rows].concat()
    }

    fn decoded(bytes: &[u8]) -> Result<Environment, String> {
        decode(Path::new("sky.hdr"), bytes).map_err(|error| error.to_string())
    }

    #[test]
    fn plain_rows_and_rows_in_runs_are_read() {
        let plain = picture("-Y 1 +X 2", &[127, 63, 0, 129, 0, 0, 0, 0]);
        let sky = decoded(&plain).expect("a sky");
        // Mantissas are in the middle of their steps.
        let first = Rgb::new(127.5, 63.5, 0.5);
        assert_eq!(sky.texels, [(1.0 / 128.0) * first, Rgb::ZERO]);

        // A texel that is repeated twice.
        let sky = decoded(&picture("-Y 1 +X 3", &[9, 8, 7, 136, 1, 1, 1, 2])).expect("a sky");
        assert_eq!(sky.texels, [Rgb::new(9.5, 8.5, 7.5); 3]);

        // Eight texels: three alike and five on their own in red, all alike in the others.
        let runs = [2, 2, 0, 8, 131, 9, 5, 1, 2, 3, 4, 5, 136, 7, 136, 8, 136, 136];
        let sky = decoded(&picture("-Y 1 +X 8", &runs)).expect("a sky");
        let reds: Vec<f32> = sky.texels.iter().map(|texel| texel.x - 0.5).collect();
        assert_eq!(reds, [9.0, 9.0, 9.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert!(sky.texels.iter().all(|texel| (texel.y, texel.z) == (7.5, 8.5)));
    }

    #[test]
    fn exposures_are_taken_back() {
        let bytes = b"#?RGBE\nEXPOSURE=2\nEXPOSURE= 4\n\n-Y 1 +X 1\n\x7f\x7f\x7f\x81";
        let sky = decoded(bytes).expect("a sky");
        assert_eq!(sky.texels, [Rgb::splat(127.5 / 128.0 / 8.0)]);
    }

    #[test]
    fn broken_pictures_are_refused_with_their_place() {
        let message = |bytes: &[u8]| decoded(bytes).expect_err("refused");
        let sound = picture("-Y 2 +X 8", &[2, 2, 0, 8, 136, 1, 136, 1, 136, 1, 136, 128]);
        assert!(message(&sound).contains("byte 64: the picture ends here"), "{}", message(&sound));
        for length in 0..sound.len() {
            message(&sound[..length]);
        }
        for (resolution, rows, expected) in [
            ("-Y 1 +X 0", &[][..], "0x1"),
            ("-Y 99999 +X 9", &[], "9x99999"),
            ("+Y 1 +X 1", &[], "expected -Y HEIGHT +X WIDTH"),
            ("-Y one +X 1", &[], "two numbers"),
            ("-Y 1 +X 8", &[2, 2, 0, 8, 137, 1], "longer than its row"),
            ("-Y 1 +X 8", &[2, 2, 0, 8, 0], "empty"),
            ("-Y 1 +X 3", &[1, 1, 1, 2], "empty or longer"),
            ("-Y 1 +X 3", &[9, 9, 9, 129, 1, 1, 1, 3], "longer than its row"),
        ] {
            let said = message(&picture(resolution, rows));
            assert!(said.starts_with("sky.hdr: ") && said.contains(expected), "{said}");
        }
        assert!(message(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n").contains("32-bit_rle_rgbe"));
        assert!(message(b"#?RADIANCE\nEXPOSURE=nan\n\n").contains("above 0"));
    }
}
