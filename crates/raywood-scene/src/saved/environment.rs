//! The section `environment` of a saved scene: the panorama around it. `docs/format.md` specifies it.

use super::stored::{Fault, Reader, Stored};
use crate::{Environment, Rgb};

/// Width and height, and then the texels.
impl Stored for Environment {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.width().put(bytes);
        self.height().put(bytes);
        self.texels().iter().for_each(|texel| texel.put(bytes));
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        const TEXEL: usize = size_of::<Rgb>();
        let start = reader.at;
        let fault = |problem: String| Fault { at: start, problem };
        let [width, height] = <[u32; 2]>::get(reader)?;
        let largest = Self::LARGEST_EDGE;
        if !((1..=largest).contains(&width) && (1..=largest).contains(&height)) {
            let problem = format!("a panorama of {width} x {height}, expected 1 to {largest} each");
            return Err(fault(problem));
        }
        let bytes = reader.take(TEXEL * width as usize * height as usize)?;
        let mut texels = Reader { bytes, at: 0 };
        let texels: Result<_, _> =
            (0..bytes.len() / TEXEL).map(|_| Rgb::get(&mut texels)).collect();
        Self::new(width, height, texels?)
            .ok_or_else(|| fault("it has another number of texels".to_owned()))
    }
}
