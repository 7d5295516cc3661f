//! The image: linear light per pixel, and how it becomes the bits of a picture file.

use raywood_scene::{Rgb, linear_to_srgb};

use crate::rgb_image::RgbImage;
use crate::tone_map::{TONE_MAPS, ToneMap, soft_clip};

/// Rows of linear light, the first row on top. 1 is the white of a picture; lights and highlights may exceed it. Or rows of
/// [numbers](Self::from_numbers) that are no light.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<Rgb>,
    /// How light becomes what picture files show; numbers need nothing.
    tone_map: Option<&'static ToneMap>,
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
        Self { width, height, pixels, tone_map: Some(&TONE_MAPS[0]) }
    }

    /// An image of numbers from 0 to 1, such as normals, row after row: picture files hold them as they are, neither compressed nor encoded.
    ///
    /// # Panics
    ///
    /// If there are not `width * height` pixels.
    pub fn from_numbers(width: u32, height: u32, pixels: Vec<Rgb>) -> Self {
        Self { tone_map: None, ..Self::from_pixels(width, height, pixels) }
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

    /// The image with its light shown in another way; numbers stay as they are.
    #[must_use]
    pub fn with_tone_map(self, tone_map: &'static ToneMap) -> Self {
        Self { tone_map: self.tone_map.map(|_| tone_map), ..self }
    }

    /// Whether these are numbers and no light.
    pub fn are_numbers(&self) -> bool {
        self.tone_map.is_none()
    }

    /// A pixel of this image as picture files of 8 bits hold it.
    pub(crate) fn bytes(&self, pixel: Rgb) -> [u8; 3] {
        // The conversion from float to integer saturates, and takes NaN to zero.
        self.shown(pixel).map(|value| (255.0 * value + 0.5) as u8)
    }

    /// A pixel of this image as picture files of 16 bits hold it.
    pub(crate) fn words(&self, pixel: Rgb) -> [u16; 3] {
        self.shown(pixel).map(|value| (65_535.0 * value + 0.5) as u16)
    }

    /// A pixel as picture files show it, from 0 to 1, light encoded in sRGB.
    fn shown(&self, pixel: Rgb) -> [f32; 3] {
        match self.tone_map {
            None => pixel.to_array(),
            Some(tone_map) => tone_map.apply(pixel).to_array().map(linear_to_srgb),
        }
    }

    /// The image as picture files hold it.
    pub fn to_rgb_image(&self) -> RgbImage {
        RgbImage::from_bytes(self.width, self.height, self.to_srgb8())
    }
}

/// Linear light as three bytes of sRGB, [compressed](soft_clip) where it is bright. NaN becomes black.
pub fn srgb8(color: Rgb) -> [u8; 3] {
    // The conversion from float to integer saturates, and takes NaN to zero.
    soft_clip(color).to_array().map(|linear| (255.0 * linear_to_srgb(linear) + 0.5) as u8)
}
