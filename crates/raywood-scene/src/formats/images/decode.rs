//! PNG and JPEG files to texels, with limits on what a file may cost.

use png::{ColorType, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::TextureImage;

/// Why there are no texels.
#[derive(Debug)]
pub(super) enum ImageError {
    /// Nobody may ask for so much.
    TooLarge(String),
    /// It is not there, or broken.
    Damaged(String),
    /// It is in a format that is not known here.
    Unknown(&'static str),
}

/// Texels: red, green, blue, alpha, row after row from the top.
pub(super) struct Texels {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) texels: Vec<[u8; 4]>,
}

/// The formats of images, told by how they begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Jpeg,
}

/// Formats that models name but nobody reads here.
const OTHERS: &[(&[u8], &str)] = &[
    (b"RIFF", "WebP"),
    (b"\xabKTX", "KTX"),
    (b"DDS ", "DDS"),
    (b"BM", "BMP"),
    (b"GIF8", "GIF"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"8BPS", "PSD"),
    (b"#?RADIANCE", "Radiance HDR"),
    (b"v/1\x01", "OpenEXR"),
];

fn kind(bytes: &[u8]) -> Result<Kind, ImageError> {
    if bytes.starts_with(b"\x89PNG") {
        return Ok(Kind::Png);
    }
    if bytes.starts_with(b"\xff\xd8") {
        return Ok(Kind::Jpeg);
    }
    let other = OTHERS.iter().find(|(start, _)| bytes.starts_with(start));
    match other {
        Some((_, name)) => Err(ImageError::Unknown(name)),
        None if bytes.get(4..12).is_some_and(|b| b == b"ftypavif") => {
            Err(ImageError::Unknown("AVIF"))
        }
        None => Err(damaged("is neither PNG nor JPEG")),
    }
}

/// Columns and rows, from the header alone: large images, and headers that promise more than the bytes can hold, are refused before
/// anything is allocated.
pub(super) fn dimensions(bytes: &[u8]) -> Result<(u32, u32), ImageError> {
    let (width, height, most) = match kind(bytes)? {
        Kind::Png => {
            let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
            decoder.ignore_checksums(true);
            let info = decoder.read_header_info().map_err(|e| damaged(&e.to_string()))?;
            let bits = info.bits_per_pixel() as u64;
            // A byte of deflate's makes 1032 bytes at most.
            let most = (bytes.len() as u64).saturating_mul(1032 * 8) / bits.max(1);
            (u64::from(info.width), u64::from(info.height), most)
        }
        Kind::Jpeg => {
            let mut decoder = JpegDecoder::new(ZCursor::new(bytes));
            decoder.decode_headers().map_err(|e| damaged(&e.to_string()))?;
            let info = decoder.info().ok_or_else(|| damaged("has no header"))?;
            // Of every block of 8 x 8 texels at least one bit is written.
            let most = (bytes.len() as u64).saturating_mul(512);
            (info.width.into(), info.height.into(), most)
        }
    };
    let edge = u64::from(TextureImage::LARGEST_EDGE);
    if width > edge || height > edge {
        let message = format!("has {width}x{height} texels, expected at most {edge}x{edge}");
        return Err(ImageError::TooLarge(message));
    }
    // Both are at most 2^14.
    if width * height == 0 {
        return Err(damaged("is empty"));
    }
    // Blocks at the edges may be cut.
    if width * height > most.saturating_add(64 * (width + height)) {
        let found = bytes.len();
        return Err(damaged(&format!("promises {width}x{height} texels, but has {found} bytes")));
    }
    Ok((width as u32, height as u32))
}

/// All texels.
pub(super) fn decode(bytes: &[u8]) -> Result<Texels, ImageError> {
    let (width, height) = dimensions(bytes)?;
    let count = width as usize * height as usize;
    let texels = match kind(bytes)? {
        Kind::Png => png_texels(bytes, count)?,
        Kind::Jpeg => jpeg_texels(bytes)?,
    };
    if texels.len() == count {
        Ok(Texels { width, height, texels })
    } else {
        Err(damaged("has fewer texels than promised"))
    }
}

fn png_texels(bytes: &[u8], count: usize) -> Result<Vec<[u8; 4]>, ImageError> {
    let broken = |error: png::DecodingError| damaged(&error.to_string());
    let limits = png::Limits { bytes: count.saturating_mul(8).saturating_add(1 << 20) };
    let mut decoder = png::Decoder::new_with_limits(std::io::Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    decoder.ignore_checksums(true);
    let mut reader = decoder.read_info().map_err(broken)?;
    let size = reader.output_buffer_size().ok_or_else(|| damaged("is too large"))?;
    let mut buffer = zeroed(size)?;
    reader.next_frame(&mut buffer).map_err(broken)?;

    let mut texels = Vec::new();
    texels.try_reserve_exact(count).map_err(|_| too_large())?;
    match reader.output_color_type().0 {
        ColorType::Rgba => texels.extend_from_slice(buffer.as_chunks::<4>().0),
        ColorType::Rgb => {
            texels.extend(buffer.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]));
        }
        ColorType::GrayscaleAlpha => {
            texels.extend(buffer.as_chunks::<2>().0.iter().map(|&[gray, a]| [gray, gray, gray, a]));
        }
        _ => texels.extend(buffer.iter().map(|&gray| [gray, gray, gray, 255])),
    }
    Ok(texels)
}

fn jpeg_texels(bytes: &[u8]) -> Result<Vec<[u8; 4]>, ImageError> {
    let edge = TextureImage::LARGEST_EDGE as usize;
    let options = DecoderOptions::default()
        .set_max_width(edge)
        .set_max_height(edge)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let buffer = decoder.decode().map_err(|error| damaged(&error.to_string()))?;
    let texels = buffer.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]);
    Ok(texels.collect())
}

fn zeroed(size: usize) -> Result<Vec<u8>, ImageError> {
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(size).map_err(|_| too_large())?;
    buffer.resize(size, 0);
    Ok(buffer)
}

fn damaged(message: &str) -> ImageError {
    ImageError::Damaged(message.to_owned())
}

fn too_large() -> ImageError {
    ImageError::TooLarge(NO_MEMORY.to_owned())
}

/// The system gives no memory for it.
pub(super) const NO_MEMORY: &str = "is larger than the memory there is";
