//! Texture statements of MTL: options, then a file's name.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use crate::error::quoted;
use crate::formats::file_name;
use crate::formats::images::Use;
use crate::formats::text::Cursor;
use crate::load::read_file;
use crate::{Texture, TextureTransform, Wrap};

use super::Images;

/// A texture as a statement names it.
#[derive(Debug)]
pub(super) struct Map {
    file: Vec<u8>,
    /// `-s` and `-o`: by how much texture coordinates are scaled, then moved.
    scale: [f32; 2],
    offset: [f32; 2],
    clamp: bool,
    /// `-bm`: how strong bumps are.
    pub(super) strength: f32,
}

/// An image that a material file names: where it is, if it is anywhere, and what it is called.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ImageFile {
    path: Option<PathBuf>,
    name: Vec<u8>,
}

impl ImageFile {
    /// Its bytes, or what is wrong with it.
    pub(crate) fn read(&self) -> Result<Cow<'static, [u8]>, String> {
        let name = quoted(&self.name);
        let path = self.path.as_ref().ok_or_else(|| format!("the image {name} is not there"))?;
        let bytes = read_file(path);
        bytes.map(Cow::Owned).map_err(|error| format!("the image {name} {}", error.message()))
    }
}

impl Map {
    /// Reads what follows the statement's first word; nothing if no file is named.
    pub(super) fn read(cursor: &mut Cursor<'_>) -> Option<Self> {
        let mut map = Self {
            file: Vec::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamp: false,
            strength: 1.0,
        };
        loop {
            cursor.skip_blanks();
            let start = cursor.offset();
            match cursor.word() {
                b"-s" => numbers(cursor, &mut map.scale),
                b"-o" => numbers(cursor, &mut map.offset),

                b"-bm" => numbers(cursor, std::slice::from_mut(&mut map.strength)),
                b"-t" | b"-mm" | b"-boost" | b"-texres" => numbers(cursor, &mut []),
                b"-clamp" => map.clamp = cursor.word() == b"on",
                b"-blendu" | b"-blendv" | b"-cc" | b"-imfchan" | b"-type" => {
                    cursor.word();
                }
                _ => {
                    cursor.set_offset(start);
                    break;
                }
            }
        }
        map.file = cursor.rest_of_line().to_vec();
        (!map.file.is_empty()).then_some(map)
    }

    /// The texture, its image asked for.
    pub(super) fn texture(&self, folder: &Path, use_: Use, images: &mut Images) -> Texture {
        let path = file_name::find(folder, &self.file);
        let image = images.ask(ImageFile { path, name: self.file.clone() }, use_);
        // Here v runs upwards, in images downwards.
        let ([u, v], [x, y]) = (self.scale, self.offset);
        let transform = TextureTransform::new([x, 1.0 - v - y], 0.0, [u, v]);
        let wrap = if self.clamp { Wrap::Clamp } else { Wrap::Repeat };
        Texture { transform, wrap: [wrap; 2], ..Texture::new(image) }
    }
}

/// Reads up to three numbers, of which the first ones are wanted.
fn numbers(cursor: &mut Cursor<'_>, wanted: &mut [f32]) {
    for i in 0..3 {
        cursor.skip_blanks();
        let Some(number) = cursor.number() else { return };
        if let Some(wanted) = wanted.get_mut(i)
            && number.is_finite()
        {
            *wanted = number;
        }
    }
}
