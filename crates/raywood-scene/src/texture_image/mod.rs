//! Images for textures: pyramids of ever smaller images (mip maps, Williams, "Pyramidal Parametrics", 1983), read with linear filters
//! within and between their levels.

mod pyramid;
mod read;

pub use read::{TexelBlend, TexelGrid, blend_levels};

use std::sync::LazyLock;

use crate::srgb_to_linear;

/// How the numbers of an image's colour channels are meant. Alpha is always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colours as the eye sees them; made linear when they are read.
    Srgb,
    /// Plain numbers: normals, roughness and the like.
    Linear,
}

/// An image as textures read it, in levels of half the width and height each, down to one texel.
///
/// Four bytes a texel, a third more for the smaller levels. Small levels are averages of linear light, weighted by opacity, so that what
/// is invisible bleeds into nothing.
#[derive(Clone, PartialEq)]
pub struct TextureImage {
    levels: Vec<Level>,
    texels: Vec<[u8; 4]>,
    encoding: Encoding,
    cutoff: Option<f32>,
    opaque: bool,
}

/// A level of the pyramid: where its texels are, row after row from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Level {
    width: u32,
    height: u32,
    start: usize,
}

impl TextureImage {
    /// The most columns, and rows.
    pub const LARGEST_EDGE: u32 = 1 << 14;

    /// An image of `width` x `height` texels (red, green, blue, alpha), row after row from the top. O(texels).
    ///
    /// With `cutoff` it is a cut-out: what has less alpha is not there, the rest is whole. From afar, where a pixel sees many texels, alpha is then
    /// the share of them that is there, so that leaves neither shimmer nor wither.
    ///
    /// `None` if it is empty, larger than [`LARGEST_EDGE`](Self::LARGEST_EDGE), has another number of texels, or more than there is memory for.
    pub fn new(
        width: u32,
        height: u32,
        texels: Vec<[u8; 4]>,
        encoding: Encoding,
        cutoff: Option<f32>,
    ) -> Option<Self> {
        let edges = 1..=Self::LARGEST_EDGE;
        let fits = texels.len() as u64 == u64::from(width) * u64::from(height);
        if !(edges.contains(&width) && edges.contains(&height) && fits) {
            return None;
        }
        let visible = |texel: &[u8; 4]| match cutoff {
            Some(cutoff) => f32::from(texel[3]) / 255.0 >= cutoff,
            None => texel[3] == 255,
        };
        let opaque = texels.iter().all(visible);
        let first = Level { width, height, start: 0 };
        let mut image = Self { levels: vec![first], texels, encoding, cutoff, opaque };
        image.build_pyramid()?;
        Some(image)
    }

    /// An image of one texel.
    pub fn uniform(texel: [u8; 4], encoding: Encoding) -> Self {
        let levels = vec![Level { width: 1, height: 1, start: 0 }];
        let opaque = texel[3] == 255;
        Self { levels, texels: vec![texel], encoding, cutoff: None, opaque }
    }

    /// Columns of the image itself.
    pub fn width(&self) -> u32 {
        self.levels[0].width
    }

    /// Rows of the image itself.
    pub fn height(&self) -> u32 {
        self.levels[0].height
    }

    /// The texels of the image itself, row after row from the top.
    pub fn texels(&self) -> &[[u8; 4]] {
        let count = self.width() as usize * self.height() as usize;
        &self.texels[..count]
    }

    /// How its colours are meant.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Of a cut-out, the least alpha that is there.
    pub fn cutoff(&self) -> Option<f32> {
        self.cutoff
    }

    /// Whether nothing shines through anywhere.
    pub fn is_opaque(&self) -> bool {
        self.opaque
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> usize {
        self.texels.len() * 4
    }

    /// The texels of a level, and its size.
    #[cfg(test)]
    fn level(&self, level: usize) -> (&[[u8; 4]], Level) {
        let level = self.levels[level];
        let count = level.width as usize * level.height as usize;
        (&self.texels[level.start..level.start + count], level)
    }
}

impl std::fmt::Debug for TextureImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { encoding, cutoff, .. } = self;
        write!(f, "TextureImage({}x{}, {encoding:?}, {cutoff:?})", self.width(), self.height())
    }
}

/// What the bytes of colour channels stand for.
struct Decoder {
    srgb: [f32; 256],
    linear: [f32; 256],
}

static DECODER: LazyLock<Decoder> = LazyLock::new(|| {
    let table = |decode: fn(f32) -> f32| {
        let mut table = [0.0; 256];
        for (byte, entry) in table.iter_mut().enumerate() {
            *entry = decode(byte as f32 / 255.0);
        }
        table
    };
    Decoder { srgb: table(srgb_to_linear), linear: table(|x| x) }
});

impl Decoder {
    /// The table of colour channels.
    #[inline(always)]
    fn color(&self, encoding: Encoding) -> &[f32; 256] {
        match encoding {
            Encoding::Srgb => &self.srgb,
            Encoding::Linear => &self.linear,
        }
    }
}
