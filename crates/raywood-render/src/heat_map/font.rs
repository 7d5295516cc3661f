//! Text in pictures: Noto Sans Mono, rasterised beforehand in a few sizes.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use raywood_scene::{Rgb, srgb_to_linear};

use crate::rgb_image::RgbImage;

/// A size of the font. All characters are equally wide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Font {
    raster: RasterHeight,
    /// How much larger than its raster a character is drawn.
    scale: u32,
}

/// The sizes, smallest first.
const SIZES: [Font; 6] = [
    Font { raster: RasterHeight::Size16, scale: 1 },
    Font { raster: RasterHeight::Size20, scale: 1 },
    Font { raster: RasterHeight::Size24, scale: 1 },
    Font { raster: RasterHeight::Size32, scale: 1 },
    Font { raster: RasterHeight::Size24, scale: 2 },
    Font { raster: RasterHeight::Size32, scale: 2 },
];

impl Font {
    /// The smallest size.
    pub(super) const SMALLEST: Self = SIZES[0];

    /// The size whose lines are the highest that are not above `height`, or the smallest.
    pub(super) fn of_height(height: u32) -> Self {
        let fitting = SIZES.into_iter().rev().find(|font| font.height() <= height);
        fitting.unwrap_or(Self::SMALLEST)
    }

    /// The height of a line.
    pub(super) const fn height(self) -> u32 {
        self.raster.val() as u32 * self.scale
    }

    /// The width of a character.
    pub(super) const fn width(self) -> u32 {
        get_raster_width(FontWeight::Regular, self.raster) as u32 * self.scale
    }

    /// Draws a line of text whose upper left corner is at `(x, y)`. Characters beyond ASCII become question marks.
    pub(super) fn draw(self, image: &mut RgbImage, (x, y): (u32, u32), text: &str, color: [u8; 3]) {
        let color = Rgb::from(color.map(|byte| srgb_to_linear(f32::from(byte) / 255.0)));
        let glyph = |c| get_raster(c, FontWeight::Regular, self.raster);
        for (left, c) in (x..).step_by(self.width() as usize).zip(text.chars()) {
            let Some(glyph) = glyph(c).or_else(|| glyph('?')) else { continue };
            let at = |column: i64, row: i64| match (column.try_into(), row.try_into()) {
                (Ok(column), Ok(row)) => f32::from(glyph.pixel(column, row).unwrap_or(0)) / 255.0,
                _ => 0.0,
            };
            for row in 0..self.height() {
                for column in 0..self.width() {
                    let coverage = match self.scale {
                        1 => at(column.into(), row.into()),
                        scale => enlarged(&at, column, row, scale),
                    };
                    if coverage > 0.0 {
                        image.blend(left + column, y + row, color, coverage);
                    }
                }
            }
        }
    }
}

/// The coverage of a pixel of an enlarged character: interpolated between the raster's pixels, then made steeper, so that edges are as
/// sharp as those of the raster.
fn enlarged(at: &impl Fn(i64, i64) -> f32, column: u32, row: u32, scale: u32) -> f32 {
    let scale = scale as f32;
    let [(x, fx), (y, fy)] = [column, row].map(|place| {
        let place = (place as f32 + 0.5) / scale - 0.5;
        (place.floor() as i64, place - place.floor())
    });
    let in_row = |y| at(x, y) + fx * (at(x + 1, y) - at(x, y));
    let smooth = in_row(y) + fy * (in_row(y + 1) - in_row(y));
    (scale * (smooth - 0.5) + 0.5).clamp(0.0, 1.0)
}
