//! Pictures read back and compared.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// An 8-bit RGB picture, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three bytes a pixel.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// Reads a PNG file of 8-bit RGB.
    pub fn read(path: &Path) -> Result<Self, String> {
        let complain = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
        let file = File::open(path).map_err(|e| complain(&e))?;
        let mut reader =
            png::Decoder::new(BufReader::new(file)).read_info().map_err(|e| complain(&e))?;
        let info = reader.info();
        let (width, height) = (info.width as usize, info.height as usize);
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
            return Err(complain(&"not 8-bit RGB"));
        }
        let mut rgb = vec![0; width * height * 3];
        reader.next_frame(&mut rgb).map_err(|e| complain(&e))?;
        Ok(Self { width, height, rgb })
    }

    /// How much this picture differs from another of the same size.
    ///
    /// # Panics
    ///
    /// If the sizes differ.
    pub fn difference(&self, other: &Self) -> Difference {
        assert_eq!(
            (self.width, self.height),
            (other.width, other.height),
            "pictures of different size"
        );
        let differences = || self.rgb.iter().zip(&other.rgb).map(|(a, b)| a.abs_diff(*b));
        Difference {
            mean: differences().map(f64::from).sum::<f64>() / self.rgb.len().max(1) as f64,
            outliers: differences().filter(|&d| d > 8).count() as f64
                / self.rgb.len().max(1) as f64,
        }
    }

    /// How many different colours there are.
    pub fn colors(&self) -> usize {
        self.rgb.as_chunks::<3>().0.iter().collect::<std::collections::HashSet<_>>().len()
    }
}

/// How much two pictures differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean absolute difference of the channels, 0 to 255.
    pub mean: f64,
    /// The share of channels that differ by more than 8.
    pub outliers: f64,
}
