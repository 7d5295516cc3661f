//! The section `images` of a saved scene: the images that textures name, one after the other, without their smaller levels. `docs/format.md` specifies it.

use super::stored::{Fault, Reader, Stored, stored_enum};
use crate::{Encoding, TextureImage};

stored_enum!(Encoding { 0 => Srgb {}, 1 => Linear {} });

/// Width and height, encoding and cut-off, and then the texels.
impl Stored for TextureImage {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.width().put(bytes);
        self.height().put(bytes);
        self.encoding().put(bytes);
        self.cutoff().put(bytes);
        bytes.extend(self.texels().as_flattened());
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let start = reader.at;
        let fault = |problem: String| Fault { at: start, problem };
        let [width, height] = <[u32; 2]>::get(reader)?;
        let (encoding, cutoff) = <(Encoding, Option<f32>)>::get(reader)?;
        let largest = Self::LARGEST_EDGE;
        if !((1..=largest).contains(&width) && (1..=largest).contains(&height)) {
            let problem = format!("an image of {width} x {height}, expected 1 to {largest} each");
            return Err(fault(problem));
        }
        let bytes = reader.take(4 * width as usize * height as usize)?;
        let texels = bytes.as_chunks().0.to_vec();
        Self::new(width, height, texels, encoding, cutoff)
            .ok_or_else(|| fault("there is no memory for an image".to_owned()))
    }
}
