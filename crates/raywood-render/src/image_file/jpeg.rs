//! JPEG: small pictures in sRGB, of which fine detail is lost.

use std::io;

use jpeg_encoder::{ColorType, Encoder, EncodingError, SamplingFactor};

use super::{Contents, ImageFormat, WriteAndSeek, WriteOptions, invalid};

/// The registry's line for this format.
pub(super) const FORMAT: ImageFormat = ImageFormat {
    name: "JPEG",
    endings: &["jpg", "jpeg"],
    bits: &[8],
    holds_light: false,
    has_layers: false,
    write,
};

/// From this quality on colours are as fine as brightness.
const FINE_COLORS: u8 = 90;

fn write(
    contents: &Contents<'_>,
    options: &WriteOptions,
    writer: &mut dyn WriteAndSeek,
) -> io::Result<()> {
    let (width, height) = contents.size();
    let (Ok(columns), Ok(rows)) = (u16::try_from(width), u16::try_from(height)) else {
        let most = u16::MAX;
        let message = format!("{width}x{height} pixels, but JPEG has at most {most}x{most}");
        return Err(invalid(message));
    };
    let mut encoder = Encoder::new(writer, options.quality);
    let is_fine = options.quality >= FINE_COLORS;
    let sampling = if is_fine { SamplingFactor::R_4_4_4 } else { SamplingFactor::R_4_2_0 };
    encoder.set_sampling_factor(sampling);
    let encoded = match contents {
        Contents::Computed(image, _) => {
            encoder.encode(&image.to_srgb8(), columns, rows, ColorType::Rgb)
        }
        Contents::Drawn(image) => encoder.encode(image.bytes(), columns, rows, ColorType::Rgb),
    };
    encoded.map_err(|error| match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    })
}
