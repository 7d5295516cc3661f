//! PNG: pictures in sRGB of 8 or 16 bits a channel, without loss.

use std::io::{self, Write};

use super::{Contents, ImageFormat, WriteAndSeek, WriteOptions};
use crate::image::Image;
use crate::rgb_image::RgbImage;

/// The registry's line for this format.
pub(super) const FORMAT: ImageFormat = ImageFormat {
    name: "PNG",
    endings: &["png"],
    bits: &[8, 16],
    holds_light: false,
    has_layers: false,
    write,
};

fn write(
    contents: &Contents<'_>,
    options: &WriteOptions,
    writer: &mut dyn WriteAndSeek,
) -> io::Result<()> {
    let header = Header { bits: options.bits, metadata: &options.metadata };
    match *contents {
        Contents::Computed(image, _) => write_image(image, &header, writer),
        Contents::Drawn(image) if options.bits == 8 => write_drawing(image, &header, writer),
        // Each value v of 255 is 257 v of 65535: the same byte twice.
        Contents::Drawn(image) => write_rows(contents.size(), &header, writer, |y, stream| {
            let words: Vec<u8> = image.row(y).iter().flat_map(|&byte| [byte; 2]).collect();
            stream.write_all(&words)
        }),
    }
}

/// Writes the image as a PNG of 8 bits a channel, marked as sRGB.
///
/// # Errors
///
/// What the writer answered; an image without pixels, which PNG does not know.
pub fn write_png(image: &Image, writer: impl Write) -> io::Result<()> {
    write_image(image, &Header::PLAIN, writer)
}

impl RgbImage {
    /// Writes the image as a PNG of 8 bits a channel, marked as sRGB.
    ///
    /// # Errors
    ///
    /// What the writer answered; an image without pixels, which PNG does not know.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        write_drawing(self, &Header::PLAIN, writer)
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

/// What a file says before its pixels.
struct Header<'a> {
    bits: u32,
    metadata: &'a [(String, String)],
}

impl Header<'_> {
    const PLAIN: Self = Self { bits: 8, metadata: &[] };
}

fn write_image(image: &Image, header: &Header<'_>, writer: impl Write) -> io::Result<()> {
    // Row by row, so that no second copy of the whole image is made.
    let mut bytes = Vec::with_capacity(6 * image.width() as usize);
    write_rows((image.width(), image.height()), header, writer, |y, stream| {
        bytes.clear();
        let row = image.row(y).iter();
        match header.bits {
            16 => bytes.extend(row.flat_map(|&c| image.words(c)).flat_map(u16::to_be_bytes)),
            _ => bytes.extend(row.flat_map(|&color| image.bytes(color))),
        }
        stream.write_all(&bytes)
    })
}

fn write_drawing(image: &RgbImage, header: &Header<'_>, writer: impl Write) -> io::Result<()> {
    let size = (image.width(), image.height());
    write_rows(size, header, writer, |y, stream| stream.write_all(image.row(y)))
}

/// Writes a PNG whose rows `write_row` gives, three channels a pixel.
fn write_rows(
    (width, height): (u32, u32),
    header: &Header<'_>,
    writer: impl Write,
    mut write_row: impl FnMut(u32, &mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut encoder = png::Encoder::new(writer, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let is_deep = header.bits == 16;
    encoder.set_depth(if is_deep { png::BitDepth::Sixteen } else { png::BitDepth::Eight });
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (name, text) in header.metadata {
        // International text: names of files may be in any script.
        encoder.add_itxt_chunk(name.clone(), text.clone()).map_err(into_io)?;
    }
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
