//! Images as PNG files.

use std::io::{self, Write};

use crate::film::{Image, srgb8};

/// Writes the image as a PNG of 8 bits a channel, marked as sRGB.
///
/// # Errors
///
/// What the writer answered.
pub fn write_png(image: &Image, writer: impl Write) -> io::Result<()> {
    let mut encoder = png::Encoder::new(writer, image.width(), image.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut png = encoder.write_header().map_err(into_io)?;

    // Row by row, so that no second copy of the whole image is made.
    let mut stream = png.stream_writer().map_err(into_io)?;
    let mut bytes = Vec::with_capacity(3 * image.width() as usize);
    for y in 0..image.height() {
        bytes.clear();
        bytes.extend(image.row(y).iter().flat_map(|&color| srgb8(color)));
        stream.write_all(&bytes)?;
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
