//! Pictures of surroundings: what shines from infinitely far away, all around, as panoramas by longitude and latitude.

mod open_exr;
mod radiance;
mod sky;

use std::f32::consts::PI;
use std::path::Path;

pub use self::sky::{Sky, SkyError};
use crate::Rgb;
use crate::error::{LoadError, Place};
use crate::load::read_file;

/// A panorama: row after row from the zenith down to the nadir, in linear light without limits.
///
/// Columns go once around, to the right as one sees it from inside; the middle of the picture lies in the direction opposite to
/// [`Axes::along`](crate::Axes::along), which is that of a camera that looks along -z where y is up.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    width: u32,
    height: u32,
    texels: Vec<Rgb>,
}

impl Environment {
    /// The most columns, and rows.
    pub const LARGEST_EDGE: u32 = 1 << 14;

    /// A panorama of `width` x `height` texels. Negative light and what is not a number counts as black, what is infinite as the largest number. O(texels).
    ///
    /// `None` if it is empty, larger than [`LARGEST_EDGE`](Self::LARGEST_EDGE), or has another number of texels.
    pub fn new(width: u32, height: u32, mut texels: Vec<Rgb>) -> Option<Self> {
        let edges = 1..=Self::LARGEST_EDGE;
        let fits = texels.len() as u64 == u64::from(width) * u64::from(height);
        if !(edges.contains(&width) && edges.contains(&height) && fits) {
            return None;
        }
        // Half of the largest, so that blends stay finite.
        let sound = |x: f32| if x > 0.0 { x.min(0.5 * f32::MAX) } else { 0.0 };
        for texel in &mut texels {
            *texel = Rgb::from(texel.to_array().map(sound));
        }
        Some(Self { width, height, texels })
    }

    /// A panorama of nothing at all.
    pub fn black() -> Self {
        Self { width: 1, height: 1, texels: vec![Rgb::ZERO] }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All texels, row after row.
    pub(crate) fn texels(&self) -> &[Rgb] {
        &self.texels
    }

    /// The texel in a column and a row, which must exist.
    fn texel(&self, column: u32, row: u32) -> Rgb {
        self.texels[row as usize * self.width as usize + column as usize]
    }

    /// The mean of the light from all directions. O(texels).
    pub fn mean_light(&self) -> Rgb {
        let (mut sum, mut all) = (Rgb::ZERO, 0.0);
        for (row, texels) in self.texels.chunks_exact(self.width as usize).enumerate() {
            // Rows near the poles stand for little of the sphere.
            let down = PI * (row as f32 + 0.5) / self.height as f32;
            let weight = down.sin() / self.width as f32;
            sum += texels.iter().fold(Rgb::ZERO, |sum, &texel| sum + weight * texel);
            all += down.sin();
        }
        (1.0 / all) * sum
    }

    /// The light from a direction, blended between texels: `turn` is the share of the way around, from 0 to 1, of the left edge to the right, `down` of the way
    /// from the zenith to the nadir.
    pub fn light(&self, turn: f32, down: f32) -> Rgb {
        let place = |share: f32, size: u32| share * size as f32 - 0.5;
        let (x, y) = (place(turn, self.width), place(down, self.height));
        let (left, top) = (x.floor(), y.floor());
        let (right_share, bottom_share) = (x - left, y - top);
        // Around there is no edge; beyond the poles there is nothing.
        let column = |x: f32| (x as i64).rem_euclid(i64::from(self.width)) as u32;
        let row = |y: f32| (y.max(0.0) as u32).min(self.height - 1);
        let line = |y: f32| {
            let [a, b] = [left, left + 1.0].map(|x| self.texel(column(x), row(y)));
            (1.0 - right_share) * a + right_share * b
        };
        (1.0 - bottom_share) * line(top) + bottom_share * line(top + 1.0)
    }
}

/// Loads a panorama from a Radiance or an OpenEXR file (`.hdr`, `.exr`); how it begins tells which.
///
/// # Errors
///
/// A file that cannot be read, is in another format, or is broken.
pub fn load_environment(path: &Path) -> Result<Environment, LoadError> {
    let bytes = read_file(path)?;
    let kind = match &bytes[..] {
        [b'#', b'?', ..] => return radiance::decode(path, &bytes),
        start if start.starts_with(&open_exr::MAGIC) => return open_exr::decode(path, &bytes),
        [] => "is empty",
        [0x89, b'P', b'N', b'G', ..] | [0xff, 0xd8, ..] => {
            "is a picture without light brighter than white"
        }
        _ => "is in no known format",
    };
    let expected = "expected a Radiance or OpenEXR picture (.hdr, .exr) of the surroundings";
    Err(LoadError::new(path, Place::File, format!("{kind}: {expected}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A white cap around the zenith counts by its share of the sphere, not of the picture.
    #[test]
    fn means_are_those_of_the_sphere() {
        for degrees in [0, 30, 90, 180] {
            let texel = |number: usize| if number < 2 * degrees { Rgb::ONE } else { Rgb::ZERO };
            let texels = (0..360).map(texel).collect();
            let mean = Environment::new(2, 180, texels).expect("a panorama").mean_light();
            let share = 0.5 * (1.0 - (degrees as f32).to_radians().cos());
            assert!((mean - Rgb::splat(share)).abs().max_element() < 1e-4, "{degrees}: {mean:?}");
        }
    }
}
