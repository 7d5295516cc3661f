//! OpenEXR pictures (`.exr`), read by the crate `exr`: channels R, G and B of the first part that has them, scan lines or tiles.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{MetaData, ReadChannels, ReadLayers, Vec2, read};

use super::Environment;
use crate::Rgb;
use crate::error::{LoadError, Place};

/// How a file begins.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Decodes a picture. What its data window covers is the panorama, wherever the window is.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Environment, LoadError> {
    let refuse = |message: String| LoadError::new(path, Place::File, message);
    let broken = |error: exr::error::Error| refuse(format!("is no sound OpenEXR picture: {error}"));

    // Look at the sizes before memory is asked for.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), true).map_err(broken)?;
    let most = Environment::LARGEST_EDGE as usize;
    for header in &meta.headers {
        let Vec2(width, height) = header.layer_size;
        if width > most || height > most {
            let message = format!("a picture of {width}x{height}, expected edges from 1 to {most}");
            return Err(refuse(message));
        }
        // Every block has an entry of eight bytes in a table.
        if header.chunk_count > bytes.len() / 8 {
            return Err(refuse("ends before its table of blocks does".to_owned()));
        }
    }
    let has_colors = meta.headers.iter().any(|header| {
        let has = |name: &str| header.channels.list.iter().any(|channel| channel.name.eq(name));
        !header.deep && has("R") && has("G") && has("B")
    });
    if !has_colors {
        let message = "has no channels R, G and B, expected a picture in colours";
        return Err(refuse(message.to_owned()));
    }

    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size: Vec2<usize>, _| (size.width(), vec![Rgb::ZERO; size.area()]),
            |(width, texels), place, (r, g, b): (f32, f32, f32)| {
                texels[place.y() * *width + place.x()] = Rgb::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .pedantic()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    let Vec2(width, height) = image.layer_data.size;
    let (_, texels) = image.layer_data.channel_data.pixels;
    Environment::new(width as u32, height as u32, texels)
        .ok_or_else(|| refuse("is no picture of surroundings".to_owned()))
}

#[cfg(test)]
mod tests {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
        WritableImage, f16,
    };

    use super::*;

    /// A picture of 3 x 2 texels; the channels' names, and numbers that tell them apart.
    fn picture(names: [&str; 3], encoding: Encoding, half: bool) -> Vec<u8> {
        let channel = |axis: usize| {
            let values = (0..6).map(|i| (i + 1) as f32 * [0.5, 1.0, 1024.0][axis]);
            let samples = match half {
                true => FlatSamples::F16(values.map(f16::from_f32).collect()),
                false => FlatSamples::F32(values.collect()),
            };
            AnyChannel::new(names[axis], samples)
        };
        let channels = AnyChannels::sort([0, 1, 2].map(channel).into_iter().collect());
        let layer = Layer::new((3, 2), LayerAttributes::default(), encoding, channels);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).expect("a picture");
        bytes.into_inner()
    }

    fn decoded(bytes: &[u8]) -> Result<Environment, String> {
        decode(Path::new("sky.exr"), bytes).map_err(|error| error.to_string())
    }

    #[test]
    fn light_is_read_as_it_is() {
        for half in [false, true] {
            for encoding in
                [Encoding::UNCOMPRESSED, Encoding::FAST_LOSSLESS, Encoding::SMALL_LOSSLESS]
            {
                let sky = decoded(&picture(["R", "G", "B"], encoding, half)).expect("a sky");
                assert_eq!((sky.width(), sky.height()), (3, 2));
                let expected = |i| (i + 1) as f32 * Rgb::new(0.5, 1.0, 1024.0);
                assert_eq!(sky.texels, [0, 1, 2, 3, 4, 5].map(expected));
            }
        }
    }

    #[test]
    fn what_is_no_picture_in_colours_is_refused() {
        let said = decoded(&picture(["X", "Y", "Z"], Encoding::UNCOMPRESSED, false));
        let said = said.expect_err("refused");
        assert!(said.starts_with("sky.exr: has no channels R, G and B"), "{said}");

        let sound = picture(["R", "G", "B"], Encoding::SMALL_LOSSLESS, false);
        for length in 0..sound.len() {
            let said = decoded(&sound[..length]).expect_err("refused");
            assert!(said.starts_with("sky.exr: "), "{said}");
        }
        // Whatever a byte is changed to, there is a picture or an error.
        for place in 0..sound.len() {
            for flipped in [1, 0x80, 0xff] {
                let mut broken = sound.clone();
                broken[place] ^= flipped;
                let _ = decoded(&broken);
            }
        }
    }
}
