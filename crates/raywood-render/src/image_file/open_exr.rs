//! OpenEXR: linear light as half or single floats, in one part; further layers are channels whose names begin with theirs, as in `normal.X`.

use std::io;

use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, ImageAttributes, Layer as Part,
    LayerAttributes, Text, WritableImage, f16,
};

use super::{Contents, ImageFormat, WriteAndSeek, WriteOptions};
use crate::layers::Values;

/// The registry's line for this format.
pub(super) const FORMAT: ImageFormat = ImageFormat {
    name: "OpenEXR",
    endings: &["exr"],
    bits: &[16, 32],
    holds_light: true,
    has_layers: true,
    write,
};

fn write(
    contents: &Contents<'_>,
    options: &WriteOptions,
    writer: &mut dyn WriteAndSeek,
) -> io::Result<()> {
    let (image, layers) = contents.light()?;
    let size = (image.width() as usize, image.height() as usize);
    let samples = |values: &mut dyn Iterator<Item = f32>, bits: u32| match bits {
        // Light beyond the range of halves is as bright as they can be: infinity spoils what is made of a picture.
        16 => FlatSamples::F16(values.map(|x| f16::from_f32(into_half_range(x))).collect()),
        _ => FlatSamples::F32(values.collect()),
    };

    let mut channels = Vec::new();
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        let mut values = image.pixels().iter().map(|pixel| pixel.to_array()[axis]);
        channels.push(AnyChannel::new(name, samples(&mut values, options.bits)));
    }
    for layer in layers {
        for (channel, values) in &layer.channels {
            let name = text(&format!("{}.{channel}", layer.name));
            let samples = match values {
                // Distances and places need all their digits, whatever light has.
                Values::Exact(values) => FlatSamples::F32(values.clone()),
                Values::Short(values) => samples(&mut values.iter().copied(), options.bits),
                Values::Whole(values) => FlatSamples::U32(values.clone()),
            };
            channels.push(AnyChannel::new(name, samples));
        }
    }

    let mut attributes = LayerAttributes::default();
    // One attribute for all: the crate keeps others in random order, and equal pictures are to be equal files.
    let mut comments = Vec::new();
    for (name, value) in &options.metadata {
        if name == "Software" {
            attributes.software_name = Some(text(value));
        } else {
            comments.push(format!("{name}: {value}"));
        }
    }
    attributes.comments = (!comments.is_empty()).then(|| text(&comments.join("\n")));
    let part =
        Part::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()));
    let mut picture = exr::prelude::Image::from_layer(part);
    picture.attributes = ImageAttributes {
        // The primaries and the white of sRGB.
        chromaticities: Some(Chromaticities {
            red: (0.64, 0.33).into(),
            green: (0.3, 0.6).into(),
            blue: (0.15, 0.06).into(),
            white: (0.3127, 0.329).into(),
        }),
        ..picture.attributes
    };
    picture.write().non_parallel().to_buffered(writer).map_err(|error| match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other),
    })
}

/// A text as files hold it: UTF-8, as everybody reads them.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

/// The nearest number that a half can hold, as long as this is no infinity.
fn into_half_range(x: f32) -> f32 {
    let most = f16::MAX.to_f32();
    x.clamp(-most, most)
}
