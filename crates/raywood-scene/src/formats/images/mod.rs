//! The images that a model's textures name: read once each, decoded in parallel, with stand-ins for what is missing or broken.

mod decode;
mod heights;

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::hash::Hash;

use rayon::prelude::*;

use self::decode::{ImageError, Texels};
use super::notes::{Notes, counted};
use crate::error::{LoadError, Place};
use crate::{Encoding, ImageId, TextureImage};

/// The most texels of all images together, without their smaller levels: 2 GiB.
const MOST_TEXELS: u64 = 1 << 29;

/// What an image is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Use {
    /// The colour of a surface, and its opacity.
    Color,
    /// The colour of a surface that is cut out where alpha is less than this many billionths.
    Cutout(u32),
    /// Light that a surface sends out.
    Emission,
    /// Plain numbers that multiply others.
    Factors,
    /// How rough and how metallic it is.
    MetallicRoughness,
    /// Colours that multiply others.
    ColorFactors,
    /// Opacity: alpha, or how bright it is if it has none.
    Opacity,
    /// Normals.
    Normals,
    /// Normals, or if it is gray, heights, of which these are normals.
    Bumps,
}

impl Use {
    /// The use of what is cut out where alpha is less than that.
    pub(crate) fn cutout(cutoff: f32) -> Self {
        Self::Cutout((cutoff.clamp(0.0, 4.0) * 1e9) as u32)
    }

    fn encoding(self) -> Encoding {
        match self {
            Self::Color | Self::Cutout(_) | Self::Emission | Self::ColorFactors => Encoding::Srgb,
            _ => Encoding::Linear,
        }
    }

    fn cutoff(self) -> Option<f32> {
        match self {
            Self::Cutout(billionths) => Some(billionths as f32 * 1e-9),
            _ => None,
        }
    }

    /// What changes nothing.
    fn neutral(self) -> TextureImage {
        let texel = match self {
            Self::Emission => [0, 0, 0, 255],
            Self::Normals | Self::Bumps => [128, 128, 255, 255],
            // The factors that it would multiply are mostly 1, but more things are half-rough paint than rough metal.
            Self::MetallicRoughness => [255, 179, 0, 255],
            _ => [255; 4],
        };
        TextureImage::uniform(texel, self.encoding())
    }

    /// What says that something is wrong, where it is the colour that is missing.
    fn placeholder(self) -> TextureImage {
        match self {
            Self::Color | Self::Cutout(_) => checker().unwrap_or_else(|| self.neutral()),
            _ => self.neutral(),
        }
    }
}

/// A checker of magenta and black.
fn checker() -> Option<TextureImage> {
    const SIZE: u32 = 64;
    let texel = |i: u32| {
        let (x, y) = (i % SIZE / 8, i / SIZE / 8);
        if (x + y).is_multiple_of(2) { [255, 0, 255, 255] } else { [0, 0, 0, 255] }
    };
    let texels = (0..SIZE * SIZE).map(texel).collect();
    TextureImage::new(SIZE, SIZE, texels, Encoding::Srgb, None)
}

/// The images that textures ask for, each once for every use. `S` says where an image comes from.
#[derive(Debug)]
pub(crate) struct ImageRequests<S> {
    sources: Vec<S>,
    numbers: HashMap<S, usize>,
    requests: Vec<(usize, Use)>,
    known: HashMap<(usize, Use), ImageId>,
}

impl<S> Default for ImageRequests<S> {
    fn default() -> Self {
        Self {
            sources: Vec::new(),
            numbers: HashMap::new(),
            requests: Vec::new(),
            known: HashMap::new(),
        }
    }
}

impl<S: Clone + Eq + Hash + Sync> ImageRequests<S> {
    /// The number that an image is going to have.
    pub(crate) fn ask(&mut self, source: S, use_: Use) -> ImageId {
        let Self { sources, numbers, requests, known } = self;
        let number = *numbers.entry(source).or_insert_with_key(|source| {
            sources.push(source.clone());
            sources.len() - 1
        });
        *known.entry((number, use_)).or_insert_with(|| {
            requests.push((number, use_));
            (requests.len() - 1) as ImageId
        })
    }

    /// All images, in the order of their numbers. `fetch` gives the bytes of one, or says what is wrong; `place` says where in the model it is named.
    /// What is missing or broken is noted in one line, a checker in its place where it is a colour; so is what is in a format not known here.
    ///
    /// O(bytes and texels), on all threads of the current rayon pool.
    pub(crate) fn load<'b>(
        self,
        fetch: impl Fn(&S) -> Result<Cow<'b, [u8]>, String> + Sync,
        place: impl Fn(&S) -> Place + Sync,
        error: impl Fn(Place, String) -> LoadError + Sync,
        notes: &mut Notes,
    ) -> Result<Vec<TextureImage>, LoadError> {
        let Self { sources, requests, .. } = self;

        // What all of them ask for, before anything is allocated.
        let files: Vec<Result<Cow<'b, [u8]>, ImageError>> =
            sources.iter().map(|source| fetch(source).map_err(ImageError::Damaged)).collect();
        let mut total = 0u64;
        for (number, _) in &requests {
            let dimensions = files[*number].as_ref().map(|bytes| decode::dimensions(bytes));
            match dimensions {
                Ok(Ok((width, height))) => total += u64::from(width) * u64::from(height),
                Ok(Err(ImageError::TooLarge(message))) => {
                    return Err(error(place(&sources[*number]), message));
                }
                _ => {}
            }
        }
        if total > MOST_TEXELS {
            let message =
                format!("its images have {total} texels in all, expected at most {MOST_TEXELS}");
            return Err(error(Place::File, message));
        }

        // Every file once, then an image for each use.
        let texels: Vec<Result<Texels, ImageError>> = files
            .into_par_iter()
            .map(|file| file.and_then(|bytes| decode::decode(&bytes)))
            .collect();
        let mut faults = Faults::default();
        for (number, texels) in texels.iter().enumerate() {
            let place = || place(&sources[number]);
            match texels {
                Ok(_) => {}
                Err(ImageError::TooLarge(message)) => return Err(error(place(), message.clone())),
                Err(ImageError::Damaged(message)) => faults.damaged(place(), message),
                Err(ImageError::Unknown(format)) => faults.unknown(format),
            }
        }
        faults.say(notes)?;

        let image = |&(number, use_): &(usize, Use)| match &texels[number] {
            Ok(texels) => build(texels, use_)
                .ok_or_else(|| error(place(&sources[number]), decode::NO_MEMORY.to_owned())),
            Err(ImageError::Unknown(_)) => Ok(use_.neutral()),
            Err(_) => Ok(use_.placeholder()),
        };
        requests.par_iter().map(image).collect()
    }
}

/// The image of a file for a use; `None` if there is no memory for it.
fn build(texels: &Texels, use_: Use) -> Option<TextureImage> {
    let Texels { width, height, texels } = texels;
    let mut copy = Vec::new();
    // The smaller levels follow in the same array.
    copy.try_reserve_exact(texels.len() + texels.len() / 3 + 64).ok()?;
    copy.extend_from_slice(texels);
    match use_ {
        Use::Bumps if heights::are_heights(texels) => {
            heights::to_normals(texels, *width, *height, &mut copy);
        }
        Use::Opacity if texels.iter().any(|texel| texel[3] < 255) => {
            for texel in &mut copy {
                *texel = [texel[3], texel[3], texel[3], 255];
            }
        }
        _ => {}
    }
    TextureImage::new(*width, *height, copy, use_.encoding(), use_.cutoff())
}

/// What is wrong with images, counted.
#[derive(Default)]
struct Faults {
    damaged: usize,
    /// Where the first is, and what is wrong with it.
    first: Option<(Place, String)>,
    unknown: usize,
    formats: BTreeSet<&'static str>,
}

impl Faults {
    fn damaged(&mut self, place: Place, message: &str) {
        self.damaged += 1;
        self.first.get_or_insert_with(|| (place, message.to_owned()));
    }

    fn unknown(&mut self, format: &'static str) {
        self.unknown += 1;
        self.formats.insert(format);
    }

    /// Says it in a line for each kind.
    fn say(self, notes: &mut Notes) -> Result<(), LoadError> {
        if self.unknown > 0 {
            let formats = self.formats.into_iter().collect::<Vec<_>>().join(", ");
            let images = counted(self.unknown, "image");
            notes.say(format!("{images} left out: {formats} is not known here, PNG and JPEG are"));
        }
        let Some((place, message)) = self.first else { return Ok(()) };
        let problem = match self.damaged {
            1 => message,
            count => format!("{message} ({count} images in all are missing or broken)"),
        };
        notes.mend_line(place, &problem, "colours are shown as a magenta checker")
    }
}
