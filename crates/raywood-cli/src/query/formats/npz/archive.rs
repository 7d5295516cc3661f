//! The arrays in an archive, each of which can be read at the same time as others.

use std::io::{self, Read};

use flate2::Crc;
use flate2::read::DeflateDecoder;
use raywood_scene::quoted;
use zip::{CompressionMethod, ZipArchive};

use super::super::npy::NpyArray;
use crate::failure::Failure;
use crate::query::input::{Bytes, Input, Stream};

/// An archive of arrays.
pub(super) struct Archive {
    pub(super) input: Input,
    bytes: Bytes,
    entries: Vec<Entry>,
}

/// An array, and where it lies.
#[derive(Clone)]
struct Entry {
    name: String,
    start: u64,
    length: u64,
    method: CompressionMethod,
    encrypted: bool,
    checksum: u32,
}

impl Archive {
    /// Reads the list of arrays.
    pub(super) fn open(input: Input) -> Result<Self, Failure> {
        let bytes = input.bytes()?;
        let reader = bytes.open(0).map_err(|error| input.cannot_read(&error))?;
        let complain = |error: zip::result::ZipError| {
            input.complain(format_args!("not an archive as numpy.savez writes it: {error}"))
        };
        let mut archive = ZipArchive::new(reader).map_err(complain)?;
        let mut entries = Vec::new();
        for number in 0..archive.len() {
            let file = archive.by_index_raw(number).map_err(complain)?;
            let path = file.name().map_err(complain)?;
            if let (Some(name), Some(start)) = (path.strip_suffix(".npy"), file.data_start()) {
                entries.push(Entry {
                    name: name.to_owned(),
                    start,
                    length: file.compressed_size(),
                    method: file.compression(),
                    encrypted: file.encrypted(),
                    checksum: file.crc32(),
                });
            }
        }
        Ok(Self { input, bytes, entries })
    }

    /// The names of the arrays.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|entry| entry.name.as_str())
    }

    /// The first array that has one of these names.
    pub(super) fn array(&self, names: &[&str]) -> Result<Option<NpyArray>, Failure> {
        let found = names.iter().find_map(|name| self.entries.iter().find(|e| e.name == *name));
        let Some(entry) = found else { return Ok(None) };
        let label = format!("array {}: ", quoted(entry.name.as_bytes()));
        if entry.encrypted
            || !matches!(entry.method, CompressionMethod::Stored | CompressionMethod::Deflated)
        {
            return Err(self.input.complain(format_args!(
                "{label}encrypted or compressed in an unknown way, expected what numpy writes"
            )));
        }
        let open = || self.open_entry(entry);
        let stream = open().map_err(|error| self.input.cannot_read(&error))?;
        NpyArray::open(&self.input, label, stream, |_, start, columns| {
            let column = |&offset: &u64| {
                let mut stream = open()?;
                skip(&mut stream, start + offset)?;
                Ok(stream)
            };
            columns.iter().map(column).collect()
        })
        .map(Some)
    }

    /// The bytes of an array.
    fn open_entry(&self, entry: &Entry) -> io::Result<Stream> {
        let packed = self.bytes.open(entry.start)?.take(entry.length);
        let stream: Stream = match entry.method {
            CompressionMethod::Deflated => Box::new(DeflateDecoder::new(packed)),
            _ => Box::new(packed),
        };
        Ok(Box::new(Checked { stream, crc: Crc::new(), checksum: entry.checksum }))
    }
}

/// Reads past the first bytes of a stream.
fn skip(stream: &mut Stream, count: u64) -> io::Result<()> {
    io::copy(&mut stream.take(count), &mut io::sink()).map(drop)
}

/// Compares the checksum at the end.
struct Checked {
    stream: Stream,
    crc: Crc,
    checksum: u32,
}

impl Read for Checked {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.stream.read(bytes)?;
        self.crc.update(&bytes[..count]);
        if count == 0 && !bytes.is_empty() && self.crc.sum() != self.checksum {
            let message = "its checksum is wrong: the archive is damaged";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(count)
    }
}
