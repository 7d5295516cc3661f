//! The film: sums of light for each pixel, to which passes add. What is known of a picture that is not finished.

use raywood_scene::{Rgb, luminance};

use crate::image::Image;
use crate::options::RenderError;
use crate::part::{Part, Region};
use crate::tiles::{Tile, tiles_in_morton_order};

/// For each pixel the sum of its samples, their number, and how much the passes differ. Two films of the same picture with different samples
/// can be [merged](Self::merge).
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<FilmPixel>,
}

/// What a film knows of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmPixel {
    /// The sum of all samples.
    pub sum: Rgb,
    /// How many samples.
    pub samples: u32,
    /// How many passes.
    pub passes: u32,
    /// The sum over passes of the squared difference between the mean luminance of the pass and that of all, times the samples of the pass.
    pub deviation: f32,
}

impl FilmPixel {
    /// The mean of the samples; black without any.
    pub fn mean(&self) -> Rgb {
        (1.0 / self.samples.max(1) as f32) * self.sum
    }

    /// The variance of the mean's luminance, estimated from how much passes differ; infinite before the second.
    ///
    /// Exact for samples that have nothing to do with each other. Those of a pixel are spread better than that, passes differ from each other more
    /// than their sum from the truth, and the estimate is too large.
    pub fn variance(&self) -> f32 {
        match self.passes.checked_sub(1) {
            None | Some(0) => f32::INFINITY,
            Some(degrees) => self.deviation / (degrees as f32 * self.samples as f32),
        }
    }

    /// Adds what other passes found, by the formula for sums of squares of Chan, Golub and LeVeque, "Updating Formulae and a Pairwise Algorithm for Computing
    /// Sample Variances", 1979.
    pub fn merge(&mut self, other: &Self) {
        if other.samples == 0 {
            return;
        }
        if self.samples > 0 {
            let [n, m] = [self.samples as f32, other.samples as f32];
            let apart = luminance(other.mean()) - luminance(self.mean());
            self.deviation += apart * apart * (n * m / (n + m));
        }
        self.deviation += other.deviation;
        self.sum += other.sum;
        self.samples = self.samples.saturating_add(other.samples);
        self.passes = self.passes.saturating_add(other.passes);
    }
}

impl Film {
    /// A film without any light.
    ///
    /// # Errors
    ///
    /// The system refuses the memory.
    pub fn new(width: u32, height: u32) -> Result<Self, RenderError> {
        let count = width as usize * height as usize;
        let mut pixels = Vec::new();
        let bytes = Self::bytes(width, height);
        pixels.try_reserve_exact(count).map_err(|_| RenderError::OutOfMemory { bytes })?;
        pixels.resize(count, FilmPixel::default());
        Ok(Self { width, height, pixels })
    }

    /// A film from its pixels, row after row from the top; `None` if there are not as many.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<FilmPixel>) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        (pixels.len() as u64 == count).then_some(Self { width, height, pixels })
    }

    /// The memory that a film takes, in bytes.
    pub fn bytes(width: u32, height: u32) -> u64 {
        let pixels = u64::from(width) * u64::from(height);
        pixels.saturating_mul(size_of::<FilmPixel>() as u64)
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
    pub fn pixels(&self) -> &[FilmPixel] {
        &self.pixels
    }

    /// The pixel in a column and a row, which must exist.
    pub(crate) fn pixel_mut(&mut self, [x, y]: [u32; 2]) -> &mut FilmPixel {
        &mut self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The fewest and the most samples of a pixel; zeros without pixels.
    pub fn samples(&self) -> (u32, u32) {
        self.samples_in(&Part::Whole)
    }

    /// The fewest and the most samples of a pixel of a part.
    pub fn samples_in(&self, part: &Part) -> (u32, u32) {
        let samples = part.pixels(self).map(|pixel| pixel.samples);
        (samples.clone().min().unwrap_or(0), samples.max().unwrap_or(0))
    }

    /// The mean number of samples of a pixel; 0 without pixels.
    pub fn mean_samples(&self) -> f64 {
        self.mean_samples_in(&Part::Whole)
    }

    /// The mean number of samples of a pixel of a part.
    pub fn mean_samples_in(&self, part: &Part) -> f64 {
        let samples = part.pixels(self).map(|pixel| u64::from(pixel.samples));
        let (count, sum) = samples.fold((0u64, 0), |(count, sum), one| (count + 1, sum + one));
        sum as f64 / count.max(1) as f64
    }

    /// Adds what another film of the same picture found.
    ///
    /// # Panics
    ///
    /// If the sizes differ.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes of films");
        for (pixel, other) in self.pixels.iter_mut().zip(&other.pixels) {
            pixel.merge(other);
        }
    }

    /// Takes from another film of the same picture, with the same samples, the tiles of which it has more.
    ///
    /// # Panics
    ///
    /// If the sizes differ.
    pub fn unite(&mut self, other: &Self) {
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes of films");
        let samples = |film: &Self, tile: &Tile| -> u64 {
            let pixels = film.part([tile.x, tile.y], [tile.width, tile.height]);
            pixels.map(|pixel| u64::from(pixel.samples)).sum()
        };
        for tile in tiles_in_morton_order(self.width, self.height) {
            if samples(other, &tile) > samples(self, &tile) {
                for row in tile.y..tile.y + tile.height {
                    let start = row as usize * self.width as usize + tile.x as usize;
                    let pixels = start..start + tile.width as usize;
                    self.pixels[pixels.clone()].copy_from_slice(&other.pixels[pixels]);
                }
            }
        }
    }

    /// The means of all pixels, as light or as [numbers](Image::from_numbers).
    pub fn image(&self, is_light: bool) -> Image {
        let means = self.pixels.iter().map(FilmPixel::mean).collect();
        match is_light {
            true => Image::from_pixels(self.width, self.height, means),
            false => Image::from_numbers(self.width, self.height, means),
        }
    }

    /// The pixels in a rectangle alone; of its size, less what is beyond the film.
    #[must_use]
    pub fn cropped(&self, region: Region) -> Self {
        let Region { x, y, width, height } = region;
        let pixels = self.part([x, y], [width, height]).copied().collect();
        let within = |start: u32, size: u32, all: u32| size.min(all.saturating_sub(start));
        let (width, height) = (within(x, width, self.width), within(y, height, self.height));
        Self { width, height, pixels }
    }

    /// The pixels in a rectangle, of which as much counts as there is.
    pub(crate) fn part(
        &self,
        [left, top]: [u32; 2],
        [width, height]: [u32; 2],
    ) -> impl Iterator<Item = &FilmPixel> + Clone {
        let within = |start: u32, size: u32, all: u32| {
            start.min(all) as usize..start.saturating_add(size).min(all) as usize
        };
        let columns = within(left, width, self.width);
        let rows = within(top, height, self.height);
        rows.flat_map(move |row| {
            let start = row * self.width as usize;
            &self.pixels[start + columns.start..start + columns.end]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(sum: f32, samples: u32) -> FilmPixel {
        FilmPixel { sum: Rgb::splat(sum), samples, passes: 1, deviation: 0.0 }
    }

    /// The weighted sum of squares, from its definition.
    #[test]
    fn passes_of_any_size_add_up_to_mean_and_variance() {
        let passes = [(3.0, 2), (5.0, 4), (8.0, 4), (20.0, 16)];
        let mut pixel = FilmPixel::default();
        assert_eq!((pixel.mean(), pixel.variance()), (Rgb::ZERO, f32::INFINITY));
        for (sum, samples) in passes {
            pixel.merge(&pass(sum, samples));
        }
        let mean = 36.0 / 26.0;
        assert!((pixel.mean().x - mean).abs() < 1e-6);
        let deviation: f32 = passes
            .iter()
            .map(|&(sum, samples)| samples as f32 * (sum / samples as f32 - mean).powi(2))
            .sum();
        assert!((pixel.variance() - deviation / (3.0 * 26.0)).abs() < 1e-6);

        // In any order, and together with others.
        let mut halves = [FilmPixel::default(); 2];
        for (i, (sum, samples)) in passes.into_iter().enumerate() {
            halves[i % 2].merge(&pass(sum, samples));
        }
        let [mut first, second] = halves;
        first.merge(&second);
        first.merge(&FilmPixel::default());
        assert_eq!((first.samples, first.passes), (26, 4));
        assert!((first.variance() - pixel.variance()).abs() < 1e-6);
    }

    /// Of independent samples the estimate is right on average: the variance of dice is 35/12.
    #[test]
    fn the_variance_of_independent_samples_is_found() {
        let mut random = 12345u32;
        let mut die = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) % 6 + 1
        };
        let mut mean = 0.0;
        for _ in 0..2000 {
            let mut pixel = FilmPixel::default();
            for samples in [4, 4, 8] {
                pixel.merge(&pass((0..samples).map(|_| die()).sum::<u32>() as f32, samples));
            }
            mean += f64::from(pixel.variance()) / 2000.0;
        }
        let expected = 35.0 / 12.0 / 16.0;
        assert!((mean / expected - 1.0).abs() < 0.1, "{mean} is not {expected}");
    }
}
