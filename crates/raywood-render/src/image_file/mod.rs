//! Picture files: each format a file, and a line in [`IMAGE_FORMATS`].

mod jpeg;
mod open_exr;
mod png;
mod radiance;

use std::fmt;
use std::io::{self, Seek, Write};
use std::path::Path;

use crate::image::Image;
use crate::layers::Layer;
use crate::rgb_image::RgbImage;

pub use png::write_png;

/// A format of picture files.
pub struct ImageFormat {
    /// Its name.
    pub name: &'static str,
    /// How the names of files end, lower case, the usual one first.
    pub endings: &'static [&'static str],
    /// How many bits a channel may have; the first is the default.
    pub bits: &'static [u32],
    /// Whether files hold light as it is, linear and without limits. Else they hold what a screen shows, in sRGB.
    pub holds_light: bool,
    /// Whether files can have more layers than the picture.
    pub has_layers: bool,
    write: fn(&Contents<'_>, &WriteOptions, &mut dyn WriteAndSeek) -> io::Result<()>,
}

/// All formats; the first is the default.
pub static IMAGE_FORMATS: [ImageFormat; 4] =
    [png::FORMAT, open_exr::FORMAT, radiance::FORMAT, jpeg::FORMAT];

/// What a file is to hold.
#[derive(Clone, Copy, Debug)]
pub enum Contents<'a> {
    /// Light as it was computed, or numbers, and what else is known of each pixel.
    Computed(&'a Image, &'a [Layer]),
    /// What was drawn into; no format that [holds light](ImageFormat::holds_light) takes it.
    Drawn(&'a RgbImage),
}

/// How a file is written.
#[derive(Clone, Debug)]
pub struct WriteOptions {
    /// Bits a channel; one of those of the format.
    pub bits: u32,
    /// Of formats that lose something: 1 the smallest files, 100 the best pictures.
    pub quality: u8,
    /// What the file says of how it was made: names and texts. Formats that have no place for them leave them out.
    pub metadata: Vec<(String, String)>,
}

impl WriteOptions {
    /// The usual ones of a format: quality 90, no metadata.
    pub fn of(format: &ImageFormat) -> Self {
        Self { bits: format.bits[0], quality: 90, metadata: Vec::new() }
    }
}

/// Where a file is written; some formats go back in it.
pub trait WriteAndSeek: Write + Seek {}

impl<W: Write + Seek> WriteAndSeek for W {}

impl ImageFormat {
    /// The format that the ending of a path names.
    pub fn of_path(path: &Path) -> Option<&'static Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        IMAGE_FORMATS.iter().find(|format| format.endings.contains(&ending.as_str()))
    }

    /// Writes a file.
    ///
    /// # Errors
    ///
    /// What the writer answered; a picture without pixels, a number of bits that the format does not have, or a drawing where light is expected.
    pub fn write(
        &self,
        contents: Contents<'_>,
        options: &WriteOptions,
        mut writer: impl Write + Seek,
    ) -> io::Result<()> {
        if !self.bits.contains(&options.bits) {
            return Err(invalid(format!("{} bits a channel, which {self} lacks", options.bits)));
        }
        (self.write)(&contents, options, &mut writer)
    }
}

impl fmt::Display for ImageFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Debug for ImageFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ImageFormat").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Contents<'_> {
    /// Columns and rows.
    fn size(&self) -> (u32, u32) {
        match self {
            Self::Computed(image, _) => (image.width(), image.height()),
            Self::Drawn(image) => (image.width(), image.height()),
        }
    }

    /// The image and the layers, for formats that hold light.
    fn light(&self) -> io::Result<(&Image, &[Layer])> {
        match *self {
            Self::Computed(image, layers) => Ok((image, layers)),
            Self::Drawn(_) => Err(invalid("a drawing holds no light".to_owned())),
        }
    }
}

/// What was asked for cannot be written.
fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}
