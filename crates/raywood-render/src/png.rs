//! Images as PNG files.

use std::io::{self, Write};

use crate::film::Image;
use crate::rgb_image::RgbImage;

/// Writes the image as a PNG of 8 bits a channel, marked as sRGB.
///
/// # Errors
///
/// What the writer answered.
pub fn write_png(image: &Image, writer: impl Write) -> io::Result<()> {
    // Row by row, so that no second copy of the whole image is made.
    let mut bytes = Vec::with_capacity(3 * image.width() as usize);
    write_rows(image.width(), image.height(), writer, |y, stream| {
        bytes.clear();
        bytes.extend(image.row(y).iter().flat_map(|&color| image.bytes(color)));
        stream.write_all(&bytes)
    })
}

impl RgbImage {
    /// Writes the image as a PNG of 8 bits a channel, marked as sRGB.
    ///
    /// # Errors
    ///
    /// What the writer answered; an image without pixels, which PNG does not know.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        write_rows(self.width(), self.height(), writer, |y, stream| stream.write_all(self.row(y)))
    }

    /// The image as the bytes of a PNG file, for pages that hold their pictures within them.
    ///
    /// # Errors
    ///
    /// An image without pixels.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        Ok(bytes)
    }
}

/// Writes a PNG whose rows `write_row` gives, three bytes a pixel.
fn write_rows(
    width: u32,
    height: u32,
    writer: impl Write,
    mut write_row: impl FnMut(u32, &mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut encoder = png::Encoder::new(writer, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut png = encoder.write_header().map_err(into_io)?;
    let mut stream = png.stream_writer().map_err(into_io)?;
    for y in 0..height {
        write_row(y, &mut stream)?;
    }
    stream.finish().map_err(into_io)?;
    png.finish().map_err(into_io)
}

/// The encoder's error as one of input and output, its cause kept.
fn into_io(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}
