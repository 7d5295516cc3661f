//! The image: linear light per pixel, and how it becomes the eight bits of a picture file.

use raywood_scene::{Rgb, linear_to_srgb};

use crate::rgb_image::RgbImage;

/// Rows of linear light, the first row on top. 1 is the white of a picture; lights and highlights may exceed it. Or rows of
/// [numbers](Self::from_numbers) that are no light.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<Rgb>,
    /// Whether these are numbers and no light.
    are_numbers: bool,
}

impl Image {
    /// An image from its pixels, row after row.
    ///
    /// # Panics
    ///
    /// If there are not `width * height` pixels.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<Rgb>) -> Self {
        assert_eq!(
            pixels.len() as u64,
            u64::from(width) * u64::from(height),
            "pixels of a {width}x{height} image"
        );
        Self { width, height, pixels, are_numbers: false }
    }

    /// An image of numbers from 0 to 1, such as normals, row after row: picture files hold them as they are, neither compressed nor encoded.
    ///
    /// # Panics
    ///
    /// If there are not `width * height` pixels.
    pub fn from_numbers(width: u32, height: u32, pixels: Vec<Rgb>) -> Self {
        Self { are_numbers: true, ..Self::from_pixels(width, height, pixels) }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row after row from the top.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    pub(crate) fn pixels_mut(&mut self) -> &mut [Rgb] {
        &mut self.pixels
    }

    /// The pixel in a column and a row, both counted from 0.
    ///
    /// # Panics
    ///
    /// If there is no such pixel.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        assert!(x < self.width, "column {x} of an image {} wide", self.width);
        self.row(y)[x as usize]
    }

    /// The pixels of a row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    pub fn row(&self, y: u32) -> &[Rgb] {
        let width = self.width as usize;
        &self.pixels[y as usize * width..][..width]
    }

    /// The image in sRGB, three bytes a pixel, row after row.
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.pixels.iter().flat_map(|&color| self.bytes(color)).collect()
    }

    /// A pixel of this image as picture files hold it.
    pub(crate) fn bytes(&self, pixel: Rgb) -> [u8; 3] {
        match self.are_numbers {
            true => pixel.to_array().map(|number| (255.0 * number + 0.5) as u8),
            false => srgb8(pixel),
        }
    }

    /// The image as picture files hold it.
    pub fn to_rgb_image(&self) -> RgbImage {
        RgbImage::from_bytes(self.width, self.height, self.to_srgb8())
    }
}

/// Linear light up to this stays as it is; brighter light is compressed into what is left below white.
const SHOULDER: f32 = 0.8;

/// Compresses light brighter than a picture can show, keeping its hue.
///
/// With `m` the largest channel: up to 0.8 nothing changes. Above, `m` becomes `0.8 + 0.2 (1 - exp((0.8 - m) / 0.2))`,
/// which goes on with the same slope and nears 1, and the other channels shrink in proportion.
pub fn soft_clip(color: Rgb) -> Rgb {
    let m = color.max_element();
    if m <= SHOULDER {
        return color;
    }
    if m == f32::INFINITY {
        return Rgb::from(color.to_array().map(|x| if x == m { 1.0 } else { 0.0 }));
    }
    let room = 1.0 - SHOULDER;
    let compressed = SHOULDER + room * (1.0 - ((SHOULDER - m) / room).exp());
    (compressed / m) * color
}

/// Linear light as three bytes of sRGB. NaN becomes black.
pub fn srgb8(color: Rgb) -> [u8; 3] {
    // The conversion from float to integer saturates, and takes NaN to zero.
    soft_clip(color).to_array().map(|linear| (255.0 * linear_to_srgb(linear) + 0.5) as u8)
}
