//! Pictures of 8 bits a channel: what files hold, and what text, legends and lines are drawn into.

use raywood_scene::{Rgb, linear_to_srgb, srgb_to_linear};

/// Rows of pixels in sRGB, three bytes each, the first row on top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl RgbImage {
    /// An image of one colour.
    pub fn filled(width: u32, height: u32, color: [u8; 3]) -> Self {
        let bytes = color.repeat(width as usize * height as usize);
        Self { width, height, bytes }
    }

    /// An image from its bytes, row after row.
    ///
    /// # Panics
    ///
    /// If there are not three bytes for each of `width * height` pixels.
    pub fn from_bytes(width: u32, height: u32, bytes: Vec<u8>) -> Self {
        assert_eq!(
            bytes.len() as u64,
            3 * u64::from(width) * u64::from(height),
            "bytes of a {width}x{height} image"
        );
        Self { width, height, bytes }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, three bytes each, row after row from the top.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes of a row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    pub fn row(&self, y: u32) -> &[u8] {
        let length = 3 * self.width as usize;
        &self.bytes[y as usize * length..][..length]
    }

    /// The pixel in a column and a row, both counted from 0; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        let start = self.start(x, y)?;
        Some([self.bytes[start], self.bytes[start + 1], self.bytes[start + 2]])
    }

    /// Mixes a colour of linear light into a pixel: `share` 0 changes nothing, 1 covers. Nothing happens outside the image.
    pub(crate) fn blend(&mut self, x: u32, y: u32, color: Rgb, share: f32) {
        let Some(start) = self.start(x, y) else { return };
        for (byte, light) in self.bytes[start..start + 3].iter_mut().zip(color.to_array()) {
            let below = srgb_to_linear(f32::from(*byte) / 255.0);
            let mixed = below + share.clamp(0.0, 1.0) * (light - below);
            *byte = (255.0 * linear_to_srgb(mixed) + 0.5) as u8;
        }
    }

    /// Sets the pixels of a rectangle; what of it lies outside the image is left out.
    pub(crate) fn fill(&mut self, x: u32, y: u32, width: u32, height: u32, color: [u8; 3]) {
        for row in y..y.saturating_add(height).min(self.height) {
            for column in x..x.saturating_add(width).min(self.width) {
                if let Some(start) = self.start(column, row) {
                    self.bytes[start..start + 3].copy_from_slice(&color);
                }
            }
        }
    }

    /// This image in the middle of the top of a larger one, and `below` at its bottom; the rest is of the given colour.
    pub(crate) fn stacked_on(&self, below: &Self, color: [u8; 3]) -> Self {
        let width = self.width.max(below.width);
        let mut stack = Self::filled(width, self.height + below.height, color);
        for (image, top) in [(self, 0), (below, self.height)] {
            let left = (width - image.width) / 2;
            for y in 0..image.height {
                let start = 3 * ((top + y) as usize * width as usize + left as usize);
                let row = image.row(y);
                stack.bytes[start..start + row.len()].copy_from_slice(row);
            }
        }
        stack
    }

    fn start(&self, x: u32, y: u32) -> Option<usize> {
        let inside = x < self.width && y < self.height;
        inside.then(|| 3 * (y as usize * self.width as usize + x as usize))
    }
}
