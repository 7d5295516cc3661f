//! The smaller levels of an image: each texel the average of what it covers, of images of any size.

use super::{DECODER, Encoding, Level, TextureImage};
use crate::linear_to_srgb;

impl TextureImage {
    /// Adds all levels below the first; `None` if there is no memory for them.
    pub(super) fn build_pyramid(&mut self) -> Option<()> {
        let texels = self.texels.len();
        self.texels.try_reserve_exact(texels / 3 + 2 * 32).ok()?;

        // Linear light (or plain numbers) weighted by alpha, and alpha.
        let Level { mut width, mut height, .. } = self.levels[0];
        let colors = DECODER.color(self.encoding);
        let mut rows = Rows { width, height, texels: Vec::new() };
        let mut is_first = true;
        while width > 1 || height > 1 {
            let half = |edge: u32| (edge / 2).max(1);
            let (smaller_width, smaller_height) = (half(width), half(height));
            let mut smaller = Vec::new();
            let count = smaller_width as usize * smaller_height as usize;
            smaller.try_reserve_exact(count).ok()?;
            if is_first {
                // The large first level is decoded on the way, so that it never lies there as numbers.
                let read = |texel: [u8; 4]| {
                    let alpha = f32::from(texel[3]) / 255.0;
                    let alpha = match self.cutoff {
                        Some(cutoff) => f32::from(u8::from(alpha >= cutoff)),
                        None => alpha,
                    };
                    let weight = alpha.max(LEAST_WEIGHT);
                    let color = |i: usize| weight * colors[usize::from(texel[i])];
                    [color(0), color(1), color(2), alpha]
                };
                let source = &self.texels[..texels];
                shrink(source, (width, height), (smaller_width, smaller_height), read, |texel| {
                    smaller.push(texel);
                });
                is_first = false;
            } else {
                let from = (rows.width, rows.height);
                shrink(
                    &rows.texels,
                    from,
                    (smaller_width, smaller_height),
                    |t| t,
                    |texel| {
                        smaller.push(texel);
                    },
                );
            }
            (width, height) = (smaller_width, smaller_height);
            self.levels.push(Level { width, height, start: self.texels.len() });
            self.texels.extend(smaller.iter().map(|texel| encode(*texel, self.encoding)));
            rows = Rows { width, height, texels: smaller };
        }
        Some(())
    }
}

/// What is invisible still counts so much where nothing else is there, so that its colour is not lost.
const LEAST_WEIGHT: f32 = 1.0 / 4096.0;

/// A level as numbers.
struct Rows {
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

/// The bytes of a texel whose colour is weighted by its alpha.
fn encode([r, g, b, alpha]: [f32; 4], encoding: Encoding) -> [u8; 4] {
    let byte = |x: f32| (255.0 * x + 0.5) as u8;
    let weight = 1.0 / alpha.max(LEAST_WEIGHT);
    let color = |x: f32| match encoding {
        Encoding::Srgb => byte(linear_to_srgb(weight * x)),
        Encoding::Linear => byte(weight * x),
    };
    [color(r), color(g), color(b), byte(alpha)]
}

/// Averages over rectangles: every smaller texel covers as much of the larger ones as its share of the image.
fn shrink<T: Copy>(
    texels: &[T],
    from: (u32, u32),
    to: (u32, u32),
    read: impl Fn(T) -> [f32; 4],
    mut write: impl FnMut([f32; 4]),
) {
    let (columns, rows) = (covered(from.0, to.0), covered(from.1, to.1));
    for row in &rows {
        for column in &columns {
            let mut sum = [0.0; 4];
            for (y, y_share) in row.iter() {
                let line = &texels[y * from.0 as usize..][..from.0 as usize];
                for (x, x_share) in column.iter() {
                    let share = x_share * y_share;
                    for (sum, channel) in sum.iter_mut().zip(read(line[x])) {
                        *sum += share * channel;
                    }
                }
            }
            write(sum);
        }
    }
}

/// The texels of a row or column that one of the smaller image covers: the first, and the shares of up to three.
struct Covered {
    first: usize,
    shares: [f32; 3],
}

impl Covered {
    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        let present = self.shares.iter().take_while(|share| **share > 0.0);
        present.enumerate().map(|(i, share)| (self.first + i, *share))
    }
}

/// What each of `to` texels covers of `from`, at least as many and at most three each.
fn covered(from: u32, to: u32) -> Vec<Covered> {
    let scale = f64::from(from) / f64::from(to);
    (0..to)
        .map(|i| {
            // Multiples of a ratio of small integers: rounding must not make a sliver of the next texel.
            let (start, end) = (f64::from(i) * scale, f64::from(i + 1) * scale);
            let first = (start + 1e-6) as usize;
            let share = |k: usize| {
                let (low, high) = ((first + k) as f64, (first + k + 1) as f64);
                let inside = high.min(end).min(f64::from(from)) - low.max(start);
                if inside > 1e-6 { (inside / scale) as f32 } else { 0.0 }
            };
            Covered { first, shares: [share(0), share(1), share(2)] }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::srgb_to_linear;

    /// An image of plain numbers whose texels a function of column and row gives.
    fn image(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> TextureImage {
        let at = |i: u32| texel(i % width, i / width);
        let texels = (0..width * height).map(at).collect();
        TextureImage::new(width, height, texels, Encoding::Linear, None).expect("a sound image")
    }

    #[test]
    fn the_last_level_is_the_mean_of_images_of_any_size() {
        for (width, height) in [(1, 1), (2, 2), (5, 3), (7, 1), (1, 13), (64, 33), (255, 31)] {
            let gray = |x: u32, y: u32| [(x * 37 + y * 91) as u8, (x * 255 / width) as u8, 7, 255];
            let image = image(width, height, gray);
            let sum = |channel: usize| -> f64 {
                image.texels().iter().map(|texel| f64::from(texel[channel])).sum()
            };
            let (texels, last) = image.level(image.levels.len() - 1);
            assert_eq!((last.width, last.height, texels.len()), (1, 1, 1), "{width}x{height}");
            for (channel, found) in texels[0].map(f64::from).into_iter().enumerate() {
                let mean = sum(channel) / f64::from(width * height);
                assert!((found - mean).abs() <= 0.51, "{width}x{height}: {found}, not {mean}");
            }
        }
    }

    #[test]
    fn colours_are_averaged_as_light() {
        let texels = vec![[0, 0, 0, 255], [255, 255, 255, 255]];
        let image = TextureImage::new(2, 1, texels, Encoding::Srgb, None).expect("a sound image");
        let mean = f32::from(image.level(1).0[0][0]) / 255.0;
        assert!((srgb_to_linear(mean) - 0.5).abs() < 0.01, "{mean}");
    }

    #[test]
    fn what_is_invisible_does_not_bleed_into_the_rest() {
        let leaf = [10, 200, 30, 255];
        let texel = |x: u32, _: u32| if x == 0 { leaf } else { [255, 0, 255, 0] };
        let image = image(4, 1, texel);
        assert_eq!(image.level(2).0[0][..3], leaf[..3]);
        assert!((63..=64).contains(&image.level(2).0[0][3]));
        assert!(!image.is_opaque());
    }

    #[test]
    fn from_afar_a_cutout_covers_as_much_as_close_up() {
        // Of every four texels one is there; their alphas alone would average to less than the cut-off.
        let texel = |x: u32, y: u32| [0, 0, 0, if x & 1 == 0 && y & 1 == 0 { 140 } else { 90 }];
        let texels = (0..64).map(|i| texel(i % 8, i / 8)).collect();
        let image =
            TextureImage::new(8, 8, texels, Encoding::Srgb, Some(0.5)).expect("a sound image");
        for level in 1..4 {
            assert!(image.level(level).0.iter().all(|t| t[3] == 64), "level {level}");
        }
    }

    #[test]
    fn images_that_cannot_be_are_refused() {
        let new = |width, height, count| {
            TextureImage::new(width, height, vec![[0; 4]; count], Encoding::Srgb, None)
        };
        assert!(new(0, 1, 0).is_none() && new(2, 2, 3).is_none());
        assert!(new(TextureImage::LARGEST_EDGE + 1, 1, 16385).is_none());
        assert!(new(3, 2, 6).is_some_and(|image| !image.is_opaque()));
    }
}
