//! Reading an image at a point: wrapped, filtered within a level and between two.

use super::{DECODER, TextureImage};
use crate::texture::{Magnification, Texture, Wrap};

/// Four texels of a level, and the share of each. The same for all images of the same size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexelBlend {
    /// The numbers of the texels within their level.
    pub texels: [u32; 4],
    /// How much each counts; the sum is 1.
    pub shares: [f32; 4],
}

/// Where a texture finds the texels of images of one size.
///
/// What depends on the texture is numbers that choices are computed with, so that a loop over many points has no branches and becomes vectors.
#[derive(Clone, Copy, Debug)]
pub struct TexelGrid {
    columns: Edge,
    rows: Edge,
    /// 1 where colours jump from texel to texel close up, else 0.
    sharp: f32,
}

/// The texels along an edge of an image.
#[derive(Clone, Copy, Debug)]
struct Edge {
    size: u32,
    /// 1 for the way in which the image goes on, else 0: repeated, mirrored, clamped.
    repeats: f32,
    mirrors: f32,
    clamps: f32,
    /// All bits if it is repeated, else none.
    wraps: i32,
}

impl TexelGrid {
    /// Where a texture finds the texels of images of `size`: columns, rows.
    pub fn new(texture: &Texture, size: [u32; 2]) -> Self {
        let edge = |axis: usize| {
            let is = |wrap: Wrap| f32::from(u8::from(texture.wrap[axis] == wrap));
            Edge {
                size: size[axis].clamp(1, TextureImage::LARGEST_EDGE),
                repeats: is(Wrap::Repeat),
                mirrors: is(Wrap::Mirror),
                clamps: is(Wrap::Clamp),
                wraps: if texture.wrap[axis] == Wrap::Repeat { -1 } else { 0 },
            }
        };
        let is_sharp = texture.magnification == Magnification::Nearest;
        Self { columns: edge(0), rows: edge(1), sharp: f32::from(u8::from(is_sharp)) }
    }

    /// The texels around a point in a level, at most 31. `(0, 0)` is the upper left corner of the image, `(1, 1)` its lower right one. A point that is NaN gives
    /// some texels.
    #[inline(always)]
    pub fn blend(&self, level: u32, [u, v]: [f32; 2]) -> TexelBlend {
        let (x0, x1, x) = self.columns.neighbours(level, u);
        let (y0, y1, y) = self.rows.neighbours(level, v);
        let sharp = if level == 0 { self.sharp } else { 0.0 };
        let jump = |share: f32| {
            let jumped = if share < 0.5 { 0.0 } else { 1.0 };
            share + sharp * (jumped - share)
        };
        let (x, y) = (jump(x), jump(y));
        let width = self.columns.count(level);
        let (upper, lower) = (y0 * width, y1 * width);
        TexelBlend {
            texels: [
                (upper + x0) as u32,
                (upper + x1) as u32,
                (lower + x0) as u32,
                (lower + x1) as u32,
            ],
            shares: [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y],
        }
    }
}

impl Edge {
    /// How many texels a level has along the edge.
    #[inline(always)]
    fn count(&self, level: u32) -> i32 {
        let count = (self.size >> (level & 31)) as i32;
        if count > 1 { count } else { 1 }
    }

    /// The two texels whose middles lie around a place, and the share of the second.
    #[inline(always)]
    fn neighbours(&self, level: u32, place: f32) -> (i32, i32, f32) {
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let repeated = place - place.floor();
        let within = place - 2.0 * (0.5 * place).floor();
        let mirrored = least(within, 2.0 - within);
        let clamped = least(if place > 0.0 { place } else { 0.0 }, 1.0);
        let place = self.repeats * repeated + self.mirrors * mirrored + self.clamps * clamped;

        // From -0.5 to count - 0.5; a place that is NaN becomes 0.
        let count = self.count(level);
        let last = count - 1;
        let middle = place * count as f32 - 0.5;
        let low = middle.floor();
        let share = middle - low;
        let low = low as i32;
        let high = low + 1;
        // Before the first comes the last if the image is repeated, else the first again.
        let low = if low < 0 { last & self.wraps } else { low };
        let high = if high > last { last & !self.wraps } else { high };
        // In range whatever the arithmetic above did.
        let in_range = |i: i32| {
            let i = if i > 0 { i } else { 0 };
            if i < last { i } else { last }
        };
        (in_range(low), in_range(high), share)
    }
}

/// The two levels of an image that are blended for a pixel that sees some texels along an edge, whose number's logarithm to base 2 is `level`: the finer
/// one, and the share of the next. `last` is the last level.
///
/// Near a whole number that level alone is read (the share is 0), between two both are. Without branches.
#[inline(always)]
pub fn blend_levels(level: f32, last: u32) -> (u32, f32) {
    let level = if level > 0.0 { level } else { 0.0 };
    let level = if level < last as f32 { level } else { last as f32 };
    let finer = level as u32;
    // Twice as steep in the middle half, level at its ends.
    let share = 2.0 * (level - finer as f32) - 0.5;
    let share = if share > 0.0 { share } else { 0.0 };
    if share < 1.0 { (finer, share) } else { (finer + 1, 0.0) }
}

impl TextureImage {
    /// The number of the last level, which is a single texel.
    pub fn last_level(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// What a blend of texels of a level shows: linear red, green, blue, and alpha, 0 to 1. Of a cut-out alpha is the share that is there.
    ///
    /// # Panics
    ///
    /// If the blend is one of a larger image, or of another level.
    #[inline(always)]
    pub fn show(&self, level: u32, blend: &TexelBlend) -> [f32; 4] {
        self.mix(level, self.fetch(level, blend.texels), blend.shares)
    }

    /// Texels of a level by their numbers, as they lie in memory: for whoever reads many points of large images, and has them all fetched before the first is
    /// needed, so that the waits for memory overlap.
    ///
    /// # Panics
    ///
    /// If there is no such level, or if it has not as many texels.
    #[inline(always)]
    pub fn fetch(&self, level: u32, texels: [u32; 4]) -> [[u8; 4]; 4] {
        let all = &self.texels[self.levels[level as usize].start..];
        let [a, b, c, d] = texels;
        [all[a as usize], all[b as usize], all[c as usize], all[d as usize]]
    }

    /// What texels show that were [fetched](Self::fetch) from a level, blended in these shares: see [`show`](Self::show).
    #[inline(always)]
    pub fn mix(&self, level: u32, texels: [[u8; 4]; 4], shares: [f32; 4]) -> [f32; 4] {
        let colors = DECODER.color(self.encoding);
        let mut sum = [0.0; 4];
        for (&[r, g, b, a], &share) in texels.iter().zip(&shares) {
            sum[0] += share * colors[usize::from(r)];
            sum[1] += share * colors[usize::from(g)];
            sum[2] += share * colors[usize::from(b)];
            sum[3] += share * f32::from(a);
        }
        sum[3] *= 1.0 / 255.0;
        // The image itself is there or not.
        if let Some(cutoff) = self.cutoff
            && level == 0
        {
            sum[3] = if sum[3] >= cutoff { 1.0 } else { 0.0 };
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::srgb_to_linear;
    use crate::texture_image::Encoding;

    /// A row of four gray texels: 0, 80, 160, 240.
    fn ramp(encoding: Encoding) -> TextureImage {
        let texels = (0..4).map(|i| [80 * i, 80 * i, 80 * i, 255]).collect();
        TextureImage::new(4, 1, texels, encoding, None).expect("a sound image")
    }

    fn texture(wrap: Wrap, magnification: Magnification) -> Texture {
        Texture { wrap: [wrap; 2], magnification, ..Texture::new(0) }
    }

    fn read(image: &TextureImage, texture: &Texture, point: [f32; 2], level: f32) -> [f32; 4] {
        let (finer, share) = blend_levels(level, image.last_level());
        let grid = TexelGrid::new(texture, [image.width(), image.height()]);
        let at = |level: u32| image.show(level, &grid.blend(level, point));
        let first = at(finer);
        if share == 0.0 {
            return first;
        }
        let second = at(finer + 1);
        [0, 1, 2, 3].map(|i| first[i] + share * (second[i] - first[i]))
    }

    /// The bytes that a texture shows at places along the row, a quarter each a texel.
    fn bytes(wrap: Wrap, magnification: Magnification, quarters: &[f32]) -> Vec<u8> {
        let (image, texture) = (ramp(Encoding::Linear), texture(wrap, magnification));
        let read = |u: &f32| read(&image, &texture, [0.25 * u, 0.5], 0.0)[0];
        quarters.iter().map(|u| (255.0 * read(u) + 0.5) as u8).collect()
    }

    #[test]
    fn beyond_its_edges_an_image_goes_on_as_it_is_wrapped() {
        let middles = [-1.5, -0.5, 0.5, 1.5, 3.5, 4.5, 5.5, 8.5];
        for magnification in [Magnification::Nearest, Magnification::Linear] {
            let repeated = bytes(Wrap::Repeat, magnification, &middles);
            assert_eq!(repeated, [160, 240, 0, 80, 240, 0, 80, 0]);
            let mirrored = bytes(Wrap::Mirror, magnification, &middles);
            assert_eq!(mirrored, [80, 0, 0, 80, 240, 240, 160, 0]);
            let clamped = bytes(Wrap::Clamp, magnification, &middles);
            assert_eq!(clamped, [0, 0, 0, 80, 240, 240, 240, 240]);
        }
    }

    #[test]
    fn between_middles_colours_blend_or_jump() {
        let between = [0.75, 1.0, 1.25, 4.0];
        assert_eq!(bytes(Wrap::Repeat, Magnification::Linear, &between), [20, 40, 60, 120]);
        assert_eq!(bytes(Wrap::Clamp, Magnification::Linear, &between), [20, 40, 60, 240]);
        let jumps = bytes(Wrap::Repeat, Magnification::Nearest, &[0.75, 0.99, 1.01, 1.25]);
        assert_eq!(jumps, [0, 0, 80, 80]);
    }

    #[test]
    fn levels_blend_and_srgb_is_made_linear_once() {
        let image = ramp(Encoding::Srgb);
        let texture = texture(Wrap::Repeat, Magnification::Linear);
        let at = |level: f32| read(&image, &texture, [0.375, 0.5], level)[0];
        assert!((at(0.0) - srgb_to_linear(80.0 / 255.0)).abs() < 1e-6);
        assert_eq!(at(-7.0), at(0.0));
        let mean: f32 = (0..4).map(|i| srgb_to_linear(80.0 * i as f32 / 255.0)).sum::<f32>() / 4.0;
        assert!((at(2.0) - mean).abs() < 0.005 && at(99.0) == at(2.0), "{} {mean}", at(2.0));
        assert!((at(1.5) - 0.5 * (at(1.0) + at(2.0))).abs() < 1e-6);
        assert_eq!([at(1.1), at(1.9)], [at(1.0), at(2.0)]);
        assert!((at(1.375) - (0.75 * at(1.0) + 0.25 * at(2.0))).abs() < 1e-6);
    }

    #[test]
    fn a_cutout_is_there_or_not_close_up() {
        let texels = vec![[9, 9, 9, 0], [9, 9, 9, 255]];
        let image =
            TextureImage::new(2, 1, texels, Encoding::Srgb, Some(0.5)).expect("a sound image");
        let texture = texture(Wrap::Clamp, Magnification::Linear);
        let alpha = |u: f32, level: f32| read(&image, &texture, [u, 0.5], level)[3];
        assert_eq!([alpha(0.45, 0.0), alpha(0.55, 0.0)], [0.0, 1.0]);
        assert!((alpha(0.5, 1.0) - 0.5).abs() < 0.01);
    }

    #[test]
    fn broken_points_and_levels_read_some_texel() {
        let image = ramp(Encoding::Linear);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for magnification in [Magnification::Nearest, Magnification::Linear] {
                let texture = texture(wrap, magnification);
                for x in [f32::NAN, f32::INFINITY, -f32::INFINITY, 3e38, -3e38, 1e-45, -1e-45] {
                    for level in [0.0, 1.0, f32::NAN, f32::INFINITY, -f32::INFINITY] {
                        let color = read(&image, &texture, [x, -x], level);
                        assert!(color.iter().all(|c| (0.0..=1.001).contains(c) || c.is_nan()));
                    }
                }
            }
        }
    }
}
