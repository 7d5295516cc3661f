//! The outside of a glTF file: the chunks of a `.glb`, and the buffers and images that the JSON names.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::Root;

use super::document::Document;
use crate::error::{LoadError, Place, quoted};
use crate::files_read;
use crate::formats::Input;
use crate::formats::notes::Notes;
use crate::load::read_file;

/// The parts of a file: where its JSON begins, the JSON, and the binary chunk if there is one.
pub(super) struct Parts<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Takes a file apart.
pub(super) fn split<'a>(input: &Input<'a>, notes: &mut Notes) -> Result<Parts<'a>, LoadError> {
    const HEADER: usize = 12;
    let bytes = input.bytes;
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return Ok(Parts { json, binary: None });
    }

    let error = |at: usize, message: String| LoadError::new(input.path, Place::Byte(at), message);
    let word = |at: usize| {
        let bytes = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        let ends = || {
            error(bytes_len(input), "the file ends, expected the header of a GLB chunk".to_owned())
        };
        bytes.map(|bytes| u32::from_le_bytes(*bytes)).ok_or_else(ends)
    };
    let version = word(4)?;
    if version != 2 {
        return Err(error(4, format!("found version {version}, expected 2")));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        let message = format!("the file ends, but the header promises {length} bytes");
        return Err(error(bytes.len(), message));
    }
    if length < bytes.len() {
        notes.say(format!("{} bytes after the end of the GLB are left out", bytes.len() - length));
    }

    // The JSON comes first, then possibly the binary chunk; others are extensions, to be skipped.
    let (mut json, mut binary) = (None, None);
    let mut at = HEADER;
    while at < length {
        let (size, kind) = (word(at)? as usize, word(at + 4)?.to_le_bytes());
        let start = at + 8;
        let Some(chunk) = bytes[..length].get(start..).and_then(|rest| rest.get(..size)) else {
            let left = length.saturating_sub(start);
            return Err(error(
                at,
                format!("found a chunk of {size} bytes, but only {left} follow"),
            ));
        };
        match &kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ if json.is_none() => {
                let kind = quoted(&kind);
                return Err(error(at + 4, format!("found a chunk {kind}, expected `JSON` first")));
            }
            _ => {}
        }
        // Chunks begin at multiples of four.
        at = start + size.next_multiple_of(4);
    }
    match json {
        Some(json) => Ok(Parts { json, binary }),
        None => Err(error(length, "the file ends, expected a JSON chunk".to_owned())),
    }
}

/// The length of the file.
fn bytes_len(input: &Input<'_>) -> usize {
    input.bytes.len()
}

/// The contents of all buffers, each at least as long as promised.
pub(super) fn buffers<'a>(
    input: &Input<'a>,
    root: &Root,
    binary: Option<&'a [u8]>,
) -> Result<Vec<Cow<'a, [u8]>>, LoadError> {
    let buffer = |(i, buffer): (usize, &gltf_json::Buffer)| {
        let error = |message: String| {
            LoadError::new(input.path, Place::Json(format!("buffers[{i}]")), message)
        };
        let bytes = match (&buffer.uri, binary) {
            (Some(uri), _) => match uri.strip_prefix("data:") {
                Some(data) => Cow::Owned(decode(data).map_err(error)?),
                None => Cow::Owned(read_file(&file_beside(input.path, uri).map_err(error)?)?),
            },
            (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
            (None, _) => {
                return Err(error("has no uri, and the file no binary chunk for it".to_owned()));
            }
        };
        let (found, promised) = (bytes.len(), buffer.byte_length.0);
        if (found as u64) < promised {
            return Err(error(format!("{found} bytes found, but byteLength promises {promised}")));
        }
        Ok(bytes)
    };
    root.buffers.iter().enumerate().map(buffer).collect()
}

impl Document<'_> {
    /// The bytes of an image, or what is wrong with it.
    pub(super) fn image(&self, index: usize) -> Result<Cow<'_, [u8]>, String> {
        let image = self.root.images.get(index).ok_or("is not there")?;
        if let Some(uri) = &image.uri {
            return match uri.strip_prefix("data:") {
                Some(data) => decode(data).map(Cow::Owned),
                None => {
                    let bytes = read_file(&file_beside(self.path, uri)?);
                    let name = quoted(uri.as_bytes());
                    bytes.map(Cow::Owned).map_err(|e| format!("the file {name} {}", e.message()))
                }
            };
        }
        let view = image.buffer_view.ok_or("has neither uri nor bufferView")?;
        let view = self.root.buffer_views.get(view.value()).ok_or("has no bufferView")?;
        let buffer = self.buffers.get(view.buffer.value()).ok_or("has no buffer")?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0);
        let range = end
            .and_then(|end| buffer.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        range.map(Cow::Borrowed).ok_or_else(|| "reaches past the end of its buffer".to_owned())
    }
}

/// The file that a URI names, relative to the folder of the glTF file.
fn file_beside(path: &Path, uri: &str) -> Result<PathBuf, String> {
    let shown = quoted(uri.as_bytes());
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    if scheme.is_some_and(|s| s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric())) {
        return Err(format!("found uri {shown}, expected a file's name or data:"));
    }
    let Ok(name) = String::from_utf8(percent_decode(uri.as_bytes())) else {
        return Err(format!("found uri {shown}, which is not UTF-8"));
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    // A name that holds a percent sign of its own may not have been encoded.
    let decoded = folder.join(&name);
    let file = if decoded.exists() { decoded } else { folder.join(uri) };
    if !file.exists() {
        files_read::note(&file);
        return Err(format!("names the file {shown}, which is not there"));
    }
    Ok(file)
}

/// The bytes of a data URI, after `data:`.
fn decode(data: &str) -> Result<Vec<u8>, String> {
    let Some((kind, payload)) = data.split_once(',') else {
        return Err("found a data URI without a comma, expected data:...;base64,...".to_owned());
    };
    if !kind.ends_with(";base64") {
        return Ok(percent_decode(payload.as_bytes()));
    }
    let lenient = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let engine = GeneralPurpose::new(&STANDARD, lenient);
    engine.decode(payload).map_err(|error| format!("found a data URI that is not base64: {error}"))
}

/// `%20` and the like as the bytes they stand for.
fn percent_decode(text: &[u8]) -> Vec<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let mut decoded = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        match *after {
            [high, low, ..] if byte == b'%' => match (digit(high), digit(low)) {
                (Some(high), Some(low)) => {
                    decoded.push((high * 16 + low) as u8);
                    rest = &after[2..];
                }
                _ => decoded.push(byte),
            },
            _ => decoded.push(byte),
        }
    }
    decoded
}
