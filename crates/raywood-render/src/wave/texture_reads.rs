//! What the textures of one material show at the surfaces of a wave.
//!
//! Colours are read over the ellipse that the ray stands for: several times along it where it is long, each from the level of the
//! image at which a texel is as large as a part of the ellipse (as "Feline" does: McCormack et al. 1999). So what is far away does not shimmer, and what is
//! seen from its edge is not blurred across. Numbers are read once.

use raywood_scene::{TexelBlend, Texture, blend_levels};

use super::WAVE;
use super::columns::{Column, whole_vectors};
use super::footprints::Footprints;
use crate::ray_cone::rough_log2;
use crate::textured::{Layer, Shown, TexturedMaterial};

/// How often a colour is read at most where a surface is seen from its edge.
const MOST_READS: usize = 4;

/// Where textures are read, in columns.
pub(crate) struct TextureReads {
    /// The middles of the ellipses on the image, and their longer axes.
    points: [Column; 2],
    axes: [Column; 2],
    /// How often each is read.
    reads: Column,
    /// The finer level that is read, and the share of the next.
    levels: [u32; WAVE],
    shares: Column,
    /// Texels of the finer level and of the next.
    finer: Blends,
    coarser: Blends,
    /// These texels as they lie in memory.
    fetched: [[[[u8; 4]; 4]; WAVE]; 2],
}

/// Blends of texels in columns.
struct Blends {
    texels: [[u32; WAVE]; 4],
    shares: [Column; 4],
}

impl Default for Blends {
    fn default() -> Self {
        Self { texels: [[0; WAVE]; 4], shares: [[0.0; WAVE]; 4] }
    }
}

impl Blends {
    #[inline(always)]
    fn set(&mut self, number: usize, blend: &TexelBlend) {
        for corner in 0..4 {
            self.texels[corner][number] = blend.texels[corner];
            self.shares[corner][number] = blend.shares[corner];
        }
    }

    #[inline(always)]
    fn texels(&self, number: usize) -> [u32; 4] {
        let [a, b, c, d] = &self.texels;
        [a[number], b[number], c[number], d[number]]
    }

    #[inline(always)]
    fn shares(&self, number: usize) -> [f32; 4] {
        let [a, b, c, d] = &self.shares;
        [a[number], b[number], c[number], d[number]]
    }
}

impl Default for TextureReads {
    fn default() -> Self {
        Self {
            points: [[0.0; WAVE]; 2],
            axes: [[0.0; WAVE]; 2],
            reads: [1.0; WAVE],
            levels: [0; WAVE],
            shares: [0.0; WAVE],
            finer: Blends::default(),
            coarser: Blends::default(),
            fetched: [[[[0; 4]; 4]; WAVE]; 2],
        }
    }
}

impl TextureReads {
    /// Reads all textures of a material at the surfaces of these numbers.
    #[inline(always)]
    pub(crate) fn read(
        &mut self,
        material: &TexturedMaterial<'_>,
        footprints: &[Footprints; 2],
        numbers: &[u8],
        shown: &mut [Shown],
    ) {
        let mut rest = &material.layers[..];
        while let Some((first, others)) = rest.split_first() {
            // All that are read in the same places.
            let count = 1 + others.iter().take_while(|layer| layer.follows).count();
            let (group, after) = rest.split_at(count);
            rest = after;
            self.choose(first, &footprints[usize::from(first.texture.set.min(1))], numbers);
            self.read_group(group, shown);
        }
    }

    /// Chooses where and how often, and from which levels.
    #[inline(always)]
    fn choose(&mut self, layer: &Layer<'_>, footprints: &Footprints, numbers: &[u8]) {
        let Texture { transform, .. } = layer.texture;
        let (width, height) = (layer.image.width() as f32, layer.image.height() as f32);
        let last = layer.image.last_level();
        let count = whole_vectors(numbers.len());

        // Gather, so that the rest is columns.
        let mut along = [[0.0; WAVE]; 2];
        let mut across = [[0.0; WAVE]; 2];
        for (place, &number) in numbers.iter().enumerate() {
            let number = usize::from(number);
            for axis in 0..2 {
                self.points[axis][place] = footprints.points[axis][number];
                along[axis][place] = footprints.along[axis][number];
                across[axis][place] = footprints.across[axis][number];
            }
        }

        let is_color = layer.is_color();
        for place in 0..count {
            let point = transform.point([self.points[0][place], self.points[1][place]]);
            let along = transform.step([along[0][place], along[1][place]]);
            let across = transform.step([across[0][place], across[1][place]]);

            // The squares of the axes' lengths, in texels.
            let squared = |[u, v]: [f32; 2]| {
                let (x, y) = (u * width, v * height);
                x * x + y * y + f32::MIN_POSITIVE
            };
            let (first, second) = (squared(along), squared(across));
            let is_first = first >= second;
            let (long, short) = if is_first { (first, second) } else { (second, first) };
            let axis = if is_first { along } else { across };

            // Each reading stands for a part that is up to half as long again as it is wide.
            let more = |ratio: f32| if long > ratio * ratio * short { 1.0 } else { 0.0 };
            let reads = 1.0 + more(2.25) + more(3.75) + more(5.25);
            let reads = if is_color & (long > 1.0) { reads } else { 1.0 };
            // Numbers are read from the level in the middle between length and width.
            let (long_log, short_log) = (0.5 * rough_log2(long), 0.5 * rough_log2(short));
            // The logarithm of 1, 2, 3 or 4.
            let part = if reads > 2.5 { 0.415 * reads + 0.34 } else { reads - 1.0 };
            let level = if is_color { long_log - part } else { 0.5 * (long_log + short_log) };
            let (finer, share) = blend_levels(level, last);
            let nearest = finer + if share >= 0.5 { 1 } else { 0 };

            self.points[0][place] = point[0];
            self.points[1][place] = point[1];
            self.axes[0][place] = axis[0];
            self.axes[1][place] = axis[1];
            self.reads[place] = reads;
            self.levels[place] = if is_color { finer } else { nearest };
            self.shares[place] = if is_color { share } else { 0.0 };
        }
    }

    /// Reads layers in the same places.
    #[inline(always)]
    fn read_group(&mut self, group: &[Layer<'_>], shown: &mut [Shown]) {
        let [first, ..] = group else { return };
        let count = shown.len().min(WAVE);
        let grid = first.grid;
        let Self { points, axes, reads, levels, shares, finer, coarser, fetched } = self;
        let most = reads[..count].iter().fold(1.0f32, |a, &b| if a > b { a } else { b });
        for read in 0..(most as usize).min(MOST_READS) {
            // Where this reading is, of all that there are along the ellipse.
            let point = |place: usize| {
                let along = (read as f32 + 0.5) / reads[place] - 0.5;
                let u = points[0][place] + along * axes[0][place];
                [u, points[1][place] + along * axes[1][place]]
            };
            let whole = whole_vectors(count);
            for (place, level) in levels[..whole].iter().enumerate() {
                finer.set(place, &grid.blend(*level, point(place)));
            }
            if first.is_color() {
                for (place, level) in levels[..whole].iter().enumerate() {
                    coarser.set(place, &grid.blend(*level + 1, point(place)));
                }
            }

            // Those that are read so often.
            let mut places = [0u8; WAVE];
            let mut wanted = 0;
            for (place, &reads) in reads[..count].iter().enumerate() {
                places[wanted] = place as u8;
                wanted += usize::from((read as f32) < reads);
            }
            let places = places[..wanted].iter().map(|&place| usize::from(place));

            for layer in group {
                // Fetch all texels before any is needed: most are far from each other, and waits for memory overlap.
                let (image, [near, far]) = (layer.image, &mut *fetched);
                for place in places.clone() {
                    near[place] = image.fetch(levels[place], finer.texels(place));
                }
                if first.is_color() {
                    for place in places.clone() {
                        // Where one level is enough, any texel will do.
                        let next = u32::from(shares[place] > 0.0);
                        let [a, b, c, d] = coarser.texels(place);
                        let texels = [next * a, next * b, next * c, next * d];
                        far[place] = image.fetch(levels[place] + next, texels);
                    }
                }

                for place in places.clone() {
                    let (level, share) = (levels[place], shares[place]);
                    let mut color = image.mix(level, near[place], finer.shares(place));
                    if share > 0.0 {
                        let next = image.mix(level + 1, far[place], coarser.shares(place));
                        for channel in 0..4 {
                            color[channel] += share * (next[channel] - color[channel]);
                        }
                    }
                    let weight = 1.0 / reads[place];
                    let sum = &mut shown[place][layer.slot as usize];
                    for channel in 0..4 {
                        let before = if read == 0 { 0.0 } else { sum[channel] };
                        sum[channel] = before + weight * color[channel];
                    }
                }
            }
        }
    }
}
