//! Radiance pictures (`.hdr`): linear light of 8 bits a channel and a common exponent. What files are made of is written down where they are read, in
//! `raywood-scene`.

use std::io;

use raywood_scene::Rgb;

use super::{Contents, ImageFormat, WriteAndSeek, WriteOptions};

/// The registry's line for this format.
pub(super) const FORMAT: ImageFormat = ImageFormat {
    name: "Radiance",
    endings: &["hdr", "pic"],
    bits: &[8],
    holds_light: true,
    has_layers: false,
    write,
};

/// Rows of so many texels are written in runs; others have no room for their length, or would be taken for such.
const RUN_WIDTHS: std::ops::Range<u32> = 8..1 << 15;

fn write(
    contents: &Contents<'_>,
    options: &WriteOptions,
    writer: &mut dyn WriteAndSeek,
) -> io::Result<()> {
    let (image, _) = contents.light()?;
    let (width, height) = (image.width(), image.height());
    writeln!(writer, "#?RADIANCE")?;
    for (name, text) in &options.metadata {
        // A comment is a line.
        writeln!(writer, "# {name}: {}", text.replace(['\n', '\r'], " "))?;
    }
    write!(writer, "FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n")?;

    let (mut row, mut bytes) = (Vec::new(), Vec::new());
    for y in 0..height {
        row.clear();
        row.extend(image.row(y).iter().map(|&color| texel(color)));
        bytes.clear();
        if RUN_WIDTHS.contains(&width) {
            bytes.extend([2, 2, (width >> 8) as u8, width as u8]);
            for channel in 0..4 {
                let column: Vec<u8> = row.iter().map(|texel| texel[channel]).collect();
                push_runs(&column, &mut bytes);
            }
        } else {
            bytes.extend(row.iter().flatten());
        }
        writer.write_all(&bytes)?;
    }
    Ok(())
}

/// A colour as mantissas, cut off, and the exponent of the largest, so that this has all its eight bits. Readers take mantissas for the middle of their steps.
fn texel(color: Rgb) -> [u8; 4] {
    let channels = color.to_array().map(|x| if x > 0.0 { x.min(f32::MAX) } else { 0.0 });
    let largest = channels[0].max(channels[1]).max(channels[2]);
    // The least exponent that has a sign of its own; below is black.
    let least = (-127.0f32).exp2();
    if largest < least {
        return [0; 4];
    }
    // largest = mantissa * 2^exponent with the mantissa from one half to below 1.
    let exponent = (f64::from(largest).log2().floor() as i32 + 1).min(127);
    let scale = 256.0 * f64::from(-exponent).exp2();
    let [r, g, b] = channels.map(|x| (f64::from(x) * scale).min(255.0) as u8);
    // Three ones would say that the last texel is repeated; of the largest there is no such mantissa.
    [r, g, b, (exponent + 128) as u8]
}

/// Appends one channel of a row: runs of at least four as their length and value, all else as it is.
fn push_runs(mut values: &[u8], bytes: &mut Vec<u8>) {
    const SHORTEST: usize = 4;
    while !values.is_empty() {
        let run = |from: usize| values[from..].iter().take_while(|&&v| v == values[from]).count();
        let start = (0..values.len().min(128)).find(|&from| run(from) >= SHORTEST);
        match start {
            Some(0) => {
                let length = run(0).min(127);
                bytes.extend([128 + length as u8, values[0]]);
                values = &values[length..];
            }
            start => {
                let length = start.unwrap_or(values.len().min(128));
                bytes.push(length as u8);
                bytes.extend(&values[..length]);
                values = &values[length..];
            }
        }
    }
}
