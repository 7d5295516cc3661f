//! Films in files: what there is of a picture, and what it is of, so that it can go on later or be put together with others. `docs/film-format.md` specifies them.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Read, Write};

use raywood_scene::Rgb;

use crate::film::{Film, FilmPixel};
use crate::options::RenderOptions;
use crate::tiles::{TILE_SIZE, Tile};

/// The first bytes of every version. One is no ASCII, and line ends are among them: whatever takes the file for text damages them.
const SIGNATURE: [u8; 8] = *b"\x89RFILM\r\n";

/// The version of the format.
const VERSION: u32 = 1;

/// Bytes of the header.
const HEADER: usize = 64;

/// Bytes of a pixel.
const PIXEL: usize = 24;

/// The most bytes of all settings.
const MOST_SETTINGS: u32 = 1 << 24;

/// A film as files have it.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile<'a> {
    /// What there is of the picture.
    pub film: Cow<'a, Film>,
    /// What it is a picture of and how it is rendered, names and values: films whose settings are the same are of the same picture.
    pub settings: Vec<(String, String)>,
    /// How much of the light is shown if nobody says otherwise.
    pub exposure: f32,
    /// Whether it is light, or [numbers](crate::Image::from_numbers).
    pub is_light: bool,
    /// Whether there is no more to do.
    pub is_finished: bool,
}

/// Why bytes are no film that can be used. Prints as what follows the file's name.
#[derive(Debug)]
#[non_exhaustive]
pub enum FilmFileError {
    /// It could not be read.
    Io(io::Error),
    /// It begins otherwise than films do.
    NotAFilm,
    /// It has a version of the format that this version of the program does not read.
    Version {
        /// Its version.
        found: u32,
    },
    /// There are fewer bytes than there should be, or more.
    Length {
        /// How many there should be.
        expected: u64,
        /// How many there are; of a file that is too long at least so many.
        found: u64,
    },
    /// A checksum is not that of the bytes.
    Damaged {
        /// Of which: the header, the settings or the pixels.
        section: &'static str,
    },
    /// Something that is in no film, although the checksums are right.
    Invalid {
        /// What was found, and what was expected.
        problem: String,
    },
}

impl fmt::Display for FilmFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "could not be read: {error}"),
            Self::NotAFilm => f.write_str("is no film: it begins with other bytes"),
            Self::Version { found } => write!(
                f,
                "is a film of version {found} of the format; this program reads version {VERSION}"
            ),
            Self::Length { expected, found } if found < expected => {
                write!(f, "is cut off: {found} bytes, expected {expected}")
            }
            Self::Length { expected, .. } => {
                write!(
                    f,
                    "has bytes at its end that do not belong to it, expected {expected} bytes"
                )
            }
            Self::Damaged { section } => {
                write!(f, "is damaged: the checksum of the {section} is wrong")
            }
            Self::Invalid { problem } => write!(f, "is no film that can be used: {problem}"),
        }
    }
}

impl std::error::Error for FilmFileError {}

impl FilmFile<'_> {
    /// The value of a setting.
    pub fn setting(&self, name: &str) -> Option<&str> {
        let setting = self.settings.iter().find(|(other, _)| other == name);
        setting.map(|(_, value)| value.as_str())
    }

    /// Writes the film: of pixels only those of tiles with light. The same bytes wherever it is written. In small pieces: the writer should have a buffer.
    ///
    /// # Errors
    ///
    /// What the writer answered; settings of more than 16 MB.
    pub fn write(&self, mut writer: impl Write) -> io::Result<()> {
        let mut settings = Vec::new();
        for (name, value) in &self.settings {
            for text in [name, value] {
                settings.extend((text.len() as u32).to_le_bytes());
                settings.extend(text.as_bytes());
            }
        }
        if settings.len() as u64 > u64::from(MOST_SETTINGS) {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "settings of more than 16 MB"));
        }
        let film = &*self.film;
        let has_light = |tile: &Tile| pixels_of(film, tile).any(|pixel| pixel.samples > 0);
        let tiles: Vec<_> = (0..)
            .zip(tiles_in_rows(film.width(), film.height()))
            .filter(|(_, tile)| has_light(tile))
            .collect();

        // The checksum of the pixels goes before them, so they are made into bytes twice rather than kept.
        let put_all = |put: &mut dyn FnMut(&[u8]) -> io::Result<()>| {
            tiles.iter().try_for_each(|(number, _)| put(&u32::to_le_bytes(*number)))?;
            let mut pixels = tiles.iter().flat_map(|(_, tile)| pixels_of(film, tile));
            pixels.try_for_each(|pixel| put(&bytes_of(pixel)))
        };
        let mut checksum = crc32fast::Hasher::new();
        put_all(&mut |bytes| {
            checksum.update(bytes);
            Ok(())
        })?;

        let mut header = Vec::with_capacity(HEADER);
        header.extend(SIGNATURE);
        let flags = u32::from(self.is_light) | u32::from(self.is_finished) << 1;
        for number in [
            VERSION,
            settings.len() as u32,
            crc32fast::hash(&settings),
            film.width(),
            film.height(),
            tiles.len() as u32,
            checksum.finalize(),
            self.exposure.to_bits(),
            flags,
        ] {
            header.extend(number.to_le_bytes());
        }
        header.resize(HEADER - 4, 0);
        header.extend(crc32fast::hash(&header).to_le_bytes());
        writer.write_all(&header)?;
        writer.write_all(&settings)?;
        put_all(&mut |bytes| writer.write_all(bytes))?;
        writer.flush()
    }
}

impl FilmFile<'static> {
    /// Reads a film. Takes no more memory than the film and the bytes that are there.
    ///
    /// # Errors
    ///
    /// It is no film, one of another version, cut off or damaged: see [`FilmFileError`].
    pub fn read(mut reader: impl Read) -> Result<Self, FilmFileError> {
        let mut header = Vec::new();
        take(&mut reader, HEADER as u64, &mut header)?;
        if !header.starts_with(&SIGNATURE) {
            return Err(FilmFileError::NotAFilm);
        }
        if header.len() < HEADER {
            let found = header.len() as u64;
            return Err(FilmFileError::Length { expected: HEADER as u64, found });
        }
        let number = |index: usize| u32_at(&header, SIGNATURE.len() + 4 * index);
        if crc32fast::hash(&header[..HEADER - 4]) != u32_at(&header, HEADER - 4) {
            // A header of another version may have its checksum elsewhere.
            return Err(match number(0) {
                VERSION => FilmFileError::Damaged { section: "header" },
                found => FilmFileError::Version { found },
            });
        }
        let [version, settings_len, settings_sum, width, height, tile_count, sum, exposure, flags] =
            std::array::from_fn(number);
        if version != VERSION {
            return Err(FilmFileError::Version { found: version });
        }
        let invalid = |problem: String| Err(FilmFileError::Invalid { problem });
        if Film::bytes(width, height) > RenderOptions::MOST_BYTES {
            return invalid(format!("{width}x{height} pixels are too many"));
        }
        let all_tiles =
            u64::from(width.div_ceil(TILE_SIZE)) * u64::from(height.div_ceil(TILE_SIZE));
        if u64::from(tile_count) > all_tiles {
            return invalid(format!("{tile_count} tiles, expected at most {all_tiles}"));
        }
        if settings_len > MOST_SETTINGS {
            return invalid(format!("{settings_len} bytes of settings, at most {MOST_SETTINGS}"));
        }

        // What is to be there follows from the numbers of the tiles, which come first.
        let start = HEADER as u64 + u64::from(settings_len) + 4 * u64::from(tile_count);
        let mut settings = Vec::new();
        take(&mut reader, settings_len.into(), &mut settings)?;
        let mut numbers = Vec::new();
        take(&mut reader, 4 * u64::from(tile_count), &mut numbers)?;
        let found = HEADER as u64 + (settings.len() + numbers.len()) as u64;
        if found < start {
            return Err(FilmFileError::Length { expected: start, found });
        }
        if crc32fast::hash(&settings) != settings_sum {
            return Err(FilmFileError::Damaged { section: "settings" });
        }
        let numbers: Vec<_> = numbers.chunks_exact(4).map(|bytes| u32_at(bytes, 0)).collect();
        let is_in_order = numbers.windows(2).all(|pair| pair[0] < pair[1]);
        if !is_in_order || numbers.last().is_some_and(|&last| u64::from(last) >= all_tiles) {
            return Err(FilmFileError::Damaged { section: "pixels" });
        }
        let tiles: Vec<_> = numbers.iter().map(|&number| tile_of(number, width, height)).collect();
        let count: u64 = tiles.iter().map(|tile| u64::from(tile.width * tile.height)).sum();
        let expected = start + PIXEL as u64 * count;
        let mut pixels = Vec::new();
        // One byte more tells of a file that is too long.
        take(&mut reader, PIXEL as u64 * count + 1, &mut pixels)?;
        let found = start + pixels.len() as u64;
        if found != expected {
            return Err(FilmFileError::Length { expected, found });
        }
        let mut checksum = crc32fast::Hasher::new();
        numbers.iter().for_each(|number| checksum.update(&number.to_le_bytes()));
        checksum.update(&pixels);
        if checksum.finalize() != sum {
            return Err(FilmFileError::Damaged { section: "pixels" });
        }

        let Ok(mut film) = Film::new(width, height) else {
            return invalid(format!("no memory for {width}x{height} pixels"));
        };
        let mut pixels = pixels.chunks_exact(PIXEL);
        for tile in &tiles {
            for y in tile.y..tile.y + tile.height {
                for (x, bytes) in (tile.x..tile.x + tile.width).zip(&mut pixels) {
                    *film.pixel_mut([x, y]) = pixel_of(bytes);
                }
            }
        }
        let [is_light, is_finished] = [flags & 1 != 0, flags & 2 != 0];
        let (film, settings) = (Cow::Owned(film), settings_of(&settings)?);
        Ok(Self { film, settings, exposure: f32::from_bits(exposure), is_light, is_finished })
    }
}

/// All tiles of a picture, row after row.
fn tiles_in_rows(width: u32, height: u32) -> impl Iterator<Item = Tile> {
    let count = width.div_ceil(TILE_SIZE) * height.div_ceil(TILE_SIZE);
    (0..count).map(move |number| tile_of(number, width, height))
}

/// A tile by its number, row after row, which must exist.
fn tile_of(number: u32, width: u32, height: u32) -> Tile {
    let columns = width.div_ceil(TILE_SIZE);
    let [x, y] = [TILE_SIZE * (number % columns), TILE_SIZE * (number / columns)];
    Tile { x, y, width: TILE_SIZE.min(width - x), height: TILE_SIZE.min(height - y) }
}

/// The pixels of a tile, row after row.
fn pixels_of<'a>(film: &'a Film, tile: &Tile) -> impl Iterator<Item = &'a FilmPixel> {
    film.part([tile.x, tile.y], [tile.width, tile.height])
}

fn bytes_of(pixel: &FilmPixel) -> [u8; PIXEL] {
    let FilmPixel { sum, samples, passes, deviation } = pixel;
    let [red, green, blue] = sum.to_array().map(f32::to_bits);
    let numbers = [red, green, blue, *samples, *passes, deviation.to_bits()];
    let mut bytes = [0; PIXEL];
    for (place, number) in bytes.chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    bytes
}

fn pixel_of(bytes: &[u8]) -> FilmPixel {
    let [red, green, blue, samples, passes, deviation] =
        std::array::from_fn(|index| u32_at(bytes, 4 * index));
    let [red, green, blue, deviation] = [red, green, blue, deviation].map(f32::from_bits);
    FilmPixel { sum: Rgb::new(red, green, blue), samples, passes, deviation }
}

/// Names and values, which are the whole of some bytes.
fn settings_of(bytes: &[u8]) -> Result<Vec<(String, String)>, FilmFileError> {
    let mut rest = bytes;
    let mut text = || {
        let (length, after) = rest.split_first_chunk()?;
        let (text, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        rest = after;
        Some((String::from_utf8(text.to_vec()).ok()?, after.is_empty()))
    };
    let mut settings = Vec::new();
    let mut is_end = bytes.is_empty();
    while !is_end {
        let (Some((name, _)), Some((value, is_last))) = (text(), text()) else {
            let problem = "its settings are no pairs of texts".to_owned();
            return Err(FilmFileError::Invalid { problem });
        };
        settings.push((name, value));
        is_end = is_last;
    }
    Ok(settings)
}

/// The number at a byte of several.
fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut number = [0; 4];
    number.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(number)
}

/// Reads so many bytes, or as many as there are.
fn take(reader: &mut impl Read, count: u64, bytes: &mut Vec<u8>) -> Result<(), FilmFileError> {
    reader.by_ref().take(count).read_to_end(bytes).map_err(FilmFileError::Io)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A film of 2x3 tiles, the last ones of which are small, with light in some.
    fn film_file() -> FilmFile<'static> {
        let mut film = Film::new(40, 70).expect("a film");
        for (number, tile) in (0..).zip(tiles_in_rows(40, 70)) {
            if number % 2 == 0 {
                continue;
            }
            for y in tile.y..tile.y + tile.height {
                for x in tile.x..tile.x + tile.width {
                    *film.pixel_mut([x, y]) = FilmPixel {
                        sum: Rgb::new(x as f32, -0.0, 1e-40 * y as f32),
                        samples: 4 + number,
                        passes: 2,
                        deviation: 0.25,
                    };
                }
            }
        }
        let setting = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        FilmFile {
            film: Cow::Owned(film),
            settings: vec![setting("scene", "Glühwürmchen"), setting("", "")],
            exposure: 0.3,
            is_light: true,
            is_finished: false,
        }
    }

    fn bytes(file: &FilmFile<'_>) -> Vec<u8> {
        let mut bytes = Vec::new();
        file.write(&mut bytes).expect("bytes");
        bytes
    }

    #[test]
    fn films_come_back_to_the_bit() {
        let file = film_file();
        let read = FilmFile::read(&*bytes(&file)).expect("a film");
        assert_eq!(read, file);
        assert_eq!(read.film.pixels()[32].sum.y.to_bits(), (-0.0f32).to_bits());
        assert_eq!((read.setting("scene"), read.setting("a")), (Some("Glühwürmchen"), None));
        let film = Cow::Owned(Film::new(1, 1).expect("a film"));
        let empty = FilmFile { film, settings: vec![], ..file };
        assert_eq!(bytes(&empty).len(), HEADER);
        assert_eq!(FilmFile::read(&*bytes(&empty)).expect("a film"), empty);
    }

    #[test]
    fn whatever_is_cut_off_added_or_changed_is_found() {
        let whole = bytes(&film_file());
        for length in 0..whole.len() {
            let error = FilmFile::read(&whole[..length]).expect_err("it is cut off").to_string();
            let is_said = error.starts_with("is cut off: ") || length < SIGNATURE.len();
            assert!(is_said, "{length}: {error}");
        }
        let longer = [&whole[..], &[0]].concat();
        let error = FilmFile::read(&*longer).expect_err("it is too long").to_string();
        assert!(error.starts_with("has bytes at its end"), "{error}");
        for at in 0..whole.len() {
            for bit in [0, 7] {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                assert!(FilmFile::read(&*damaged).is_err(), "byte {at}");
            }
        }
    }

    /// Whoever computes the right checksums of wrong contents is told, too.
    #[test]
    fn forged_films_are_refused_without_much_memory() {
        let whole = bytes(&film_file());
        let forged = |index: usize, value: u32| {
            let mut bytes = whole.clone();
            let at = SIGNATURE.len() + 4 * index;
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            let sum = crc32fast::hash(&bytes[..HEADER - 4]);
            bytes[HEADER - 4..HEADER].copy_from_slice(&sum.to_le_bytes());
            FilmFile::read(&*bytes).expect_err("it is forged").to_string()
        };
        for (index, value, expected) in [
            (0, 2, "is a film of version 2 of the format"),
            (1, u32::MAX, "is no film that can be used: 4294967295 bytes of settings"),
            (3, u32::MAX, "is no film that can be used: 4294967295x70 pixels are too many"),
            (3, 0, "is no film that can be used: 3 tiles, expected at most 0"),
            (4, 20_000, "is cut off: "),
            (5, 7, "is no film that can be used: 7 tiles, expected at most 6"),
            (5, 6, ""),
        ] {
            let said = forged(index, value);
            assert!(said.starts_with(expected), "{index}, {value}: {said}");
        }
        for bad in [&[1u8, 0, 0][..], &[1, 0, 0, 0, b'a'], &[1, 0, 0, 0, 0xff, 0, 0, 0, 0]] {
            let error = settings_of(bad).expect_err("no settings").to_string();
            assert!(error.ends_with("its settings are no pairs of texts"), "{error}");
        }
    }
}
