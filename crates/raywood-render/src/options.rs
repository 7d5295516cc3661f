//! What a rendering is asked for, and why it may be refused.

use std::fmt;

use raywood::StructureKind;

use crate::camera_rays::CameraError;
use crate::integrators::{INTEGRATORS, Integrator};
use crate::lens::Lens;
use crate::part::{Part, Region};
use crate::pixel_filter::PixelFilter;
use crate::shutter::Shutter;
use crate::tiles::TILE_SIZE;

/// What a rendering is asked for.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// Primary rays per pixel: 1 goes through the pixel's centre, more are spread over it.
    pub samples: u32,
    /// How the rays of a pixel are spread around it.
    pub filter: PixelFilter,
    /// What tells pictures of the same scene apart: another seed has other samples, and so other noise.
    pub seed: u32,
    /// The lens in front of the eye, else a pinhole.
    pub lens: Option<Lens>,
    /// When light comes in, of scenes in which something moves.
    pub shutter: Shutter,
    /// How often light may be mirrored or let through on its way to the eye: 0 shows neither. What lies beyond is black.
    pub max_depth: u32,
    /// Rays that would count less than this in a pixel, in units of white, are not traced. A step of an 8-bit sRGB
    /// image is 0.0003 in the darkest and 0.009 in the brightest parts.
    pub cutoff: f32,
    /// Whether transparent surfaces cast black shadows, rather than weakening and colouring the light.
    pub opaque_shadows: bool,
    /// The method of following light.
    pub integrator: &'static Integrator,
}

impl Default for RenderOptions {
    /// 1280 x 800 pixels of one ray each, depth 10, a cut-off of 1/1024.
    fn default() -> Self {
        Self {
            width: 1280,
            height: 800,
            samples: 1,
            filter: PixelFilter::default(),
            seed: 0,
            lens: None,
            shutter: Shutter::default(),
            max_depth: 10,
            cutoff: 1.0 / 1024.0,
            opaque_shadows: false,
            integrator: &INTEGRATORS[0],
        }
    }
}

impl RenderOptions {
    /// The most memory that an image may take while it is rendered: 2^27 pixels, less for very thin ones.
    pub const MOST_BYTES: u64 = 24 << 27;
    /// The most rays per pixel.
    pub const MOST_SAMPLES: u32 = 1 << 20;
    /// The greatest depth. It bounds the stack that the recursion needs.
    pub const GREATEST_DEPTH: u32 = 64;
    /// The smallest cut-off. With the depth it bounds the rays that one primary ray can cause.
    pub const SMALLEST_CUTOFF: f32 = 1e-5;

    /// The largest memory that rendering the image takes, in bytes, beside the scene: whole tiles and the image, 12 bytes a pixel.
    pub fn memory_bytes(&self) -> u64 {
        let in_tiles = |size: u32| u64::from(size.div_ceil(TILE_SIZE)) * u64::from(TILE_SIZE);
        let image = u64::from(self.width) * u64::from(self.height);
        let tiles = in_tiles(self.width).saturating_mul(in_tiles(self.height));
        image.saturating_add(tiles).saturating_mul(12)
    }

    /// Whether the options make sense.
    ///
    /// # Errors
    ///
    /// Which one does not.
    pub fn validate(&self) -> Result<(), RenderError> {
        let Self { width, height, .. } = *self;
        if width == 0 || height == 0 {
            return Err(RenderError::EmptyImage { width, height });
        }
        if self.memory_bytes() > Self::MOST_BYTES {
            return Err(RenderError::ImageTooLarge { width, height, bytes: self.memory_bytes() });
        }
        if !(1..=Self::MOST_SAMPLES).contains(&self.samples) {
            return Err(RenderError::Samples { samples: self.samples });
        }
        if self.max_depth > Self::GREATEST_DEPTH {
            return Err(RenderError::Depth { max_depth: self.max_depth });
        }
        if !(Self::SMALLEST_CUTOFF..=1.0).contains(&self.cutoff) {
            return Err(RenderError::Cutoff { cutoff: self.cutoff });
        }
        if let Some(lens) = self.lens.filter(|lens| !lens.is_sound()) {
            return Err(RenderError::Lens(lens));
        }
        if !self.shutter.is_sound() {
            return Err(RenderError::Shutter(self.shutter));
        }
        Ok(())
    }
}

/// Why there is no image.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RenderError {
    /// Somebody asked to stop.
    Cancelled,
    /// No columns or no rows.
    EmptyImage {
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
    },
    /// It would take more than [`RenderOptions::MOST_BYTES`].
    ImageTooLarge {
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
        /// The memory that it would take.
        bytes: u64,
    },
    /// The system refuses the memory.
    OutOfMemory {
        /// The memory that the rendering takes.
        bytes: u64,
    },
    /// No rays per pixel, or more than [`RenderOptions::MOST_SAMPLES`].
    Samples {
        /// Rays asked for.
        samples: u32,
    },
    /// Deeper than [`RenderOptions::GREATEST_DEPTH`].
    Depth {
        /// The depth asked for.
        max_depth: u32,
    },
    /// Not between [`RenderOptions::SMALLEST_CUTOFF`] and 1.
    Cutoff {
        /// The cut-off asked for.
        cutoff: f32,
    },
    /// No light passes, or nothing in front of the eye is in focus.
    Lens(Lens),
    /// It does not open and then close within the time from 0 to 1.
    Shutter(Shutter),
    /// The structure has no such level to show.
    NoSuchLevel {
        /// The kind of structure.
        structure: StructureKind,
        /// The level asked for; the root's is 0.
        level: usize,
        /// How many levels there are.
        levels: usize,
    },
    /// What is to be shown is that of one structure, but the scene has instances, and a tree over trees.
    Instances,
    /// A part of the picture without any of its pixels, or one that reaches beyond it.
    NoPart {
        /// What was asked for.
        part: Part,
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
    },
    /// Nothing can be seen through the camera.
    Camera(CameraError),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gib = |bytes: u64| bytes as f64 / (1u64 << 30) as f64;
        match self {
            Self::Cancelled => write!(f, "cancelled"),
            Self::EmptyImage { width, height } => {
                write!(f, "an image of {width}x{height} pixels is empty: both must be at least 1")
            }
            Self::ImageTooLarge { width, height, bytes } => {
                write!(
                    f,
                    "an image of {width}x{height} pixels would take {:.1} GiB of memory: at most {:.1} GiB are allowed",
                    gib(*bytes),
                    gib(RenderOptions::MOST_BYTES)
                )
            }
            Self::OutOfMemory { bytes } => {
                write!(
                    f,
                    "the image takes {:.1} GiB of memory, which the system refuses",
                    gib(*bytes)
                )
            }
            Self::Samples { samples } => {
                let most = RenderOptions::MOST_SAMPLES;
                write!(f, "{samples} samples per pixel: must be from 1 to {most}")
            }
            Self::Depth { max_depth } => {
                let greatest = RenderOptions::GREATEST_DEPTH;
                write!(f, "a depth of {max_depth}: must be from 0 to {greatest}")
            }
            Self::Cutoff { cutoff } => {
                let smallest = RenderOptions::SMALLEST_CUTOFF;
                write!(f, "a cut-off of {cutoff}: must be from {smallest} to 1")
            }
            Self::Lens(Lens { radius, focus }) => write!(
                f,
                "a lens of radius {radius} in focus at {focus}: both must be finite, the focus above 0"
            ),
            Self::Shutter(Shutter { open, close }) => write!(
                f,
                "a shutter that opens at {open} and closes at {close}: both must be from 0 to 1, and it must not close before it opens"
            ),
            Self::NoSuchLevel { structure, level, levels } => {
                let name = structure.name();
                match levels.checked_sub(1) {
                    None => write!(f, "there is no level {level}: the {name} is empty"),
                    Some(0) => write!(f, "there is no level {level}: the {name} has level 0 only"),
                    Some(deepest) => {
                        write!(f, "there is no level {level}: the {name} has levels 0 to {deepest}")
                    }
                }
            }
            Self::Instances => write!(
                f,
                "the scene has instances, and no single structure of which tests or boxes could be shown"
            ),
            Self::NoPart { part: Part::Region(region), width, height } => {
                let Region { x, y, width: w, height: h } = region;
                write!(
                    f,
                    "a region of {w}x{h} pixels at {x},{y} does not lie in a picture of {width}x{height}"
                )
            }
            Self::NoPart { part, width, height } => {
                let tiles = Part::Whole.tile_count(*width, *height);
                let tiles =
                    format!("a picture of {width}x{height} pixels has {tiles} tiles of 32x32");
                match part {
                    Part::Share { index, count } => {
                        write!(f, "share {} of {count} has no tile: {tiles}", u64::from(*index) + 1)
                    }
                    _ => f.write_str(&tiles),
                }
            }
            Self::Camera(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RenderError {}

impl From<CameraError> for RenderError {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}
