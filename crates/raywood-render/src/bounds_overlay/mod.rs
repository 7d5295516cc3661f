//! Overlays of bounds: the boxes or cells of a level of the structure, as lines over a picture.
//!
//! Shown are the nodes of the level and the leaves above it, so that together they hold everything in the scene; leaves without
//! primitives are left out. Lines behind surfaces are fainter, and so are boxes of a few pixels, which else would cover the picture.

mod depth;
mod lines;
mod projection;

use raywood::{NodeView, Structure};
use raywood_scene::{Camera, Rgb};

use crate::PreparedScene;
use crate::camera_rays::CameraRays;
use crate::options::{RenderError, RenderOptions};
use crate::prepared::Surfaces;
use crate::progress::Progress;
use crate::rgb_image::RgbImage;
use lines::{Covered, Lines};

pub(crate) use projection::Projection;

/// Lines over a picture of the same size.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundsOverlay {
    lines: Covered,
    /// How many boxes or cells are shown; some may lie outside the picture.
    boxes: usize,
}

/// Draws the bounds of a level of the scene's structure as the camera sees them, for pictures of the options' size, on the threads of the current
/// rayon pool. The root's level is 0.
///
/// The lines are the same, bit for bit, for any number of threads. The memory does not depend on the number of boxes; the time is that of
/// one ray per pixel and of drawing every line.
///
/// # Errors
///
/// Options or a camera that make no sense, too little memory, [`RenderError::NoSuchLevel`], or [`RenderError::Cancelled`] after
/// [`Progress::cancel`].
pub fn bounds_overlay(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    level: usize,
    progress: &Progress,
) -> Result<BoundsOverlay, RenderError> {
    options.validate()?;
    let structure = scene.structure().ok_or(RenderError::Instances)?;
    check_level(structure, level)?;
    let camera = CameraRays::new(camera, options.width, options.height)?;
    let depths = depth::depths(structure, &camera, options, progress)?;

    let mut lines = Lines::new(camera.projection(), depths, options)?;
    let mut boxes = 0;
    structure.visit_nodes(&mut |node| {
        if is_shown(&node, level) && !progress.is_cancelled() {
            boxes += 1;
            lines.add_box(&node.bounds);
        }
    });
    if progress.is_cancelled() {
        return Err(RenderError::Cancelled);
    }
    Ok(BoundsOverlay { lines: lines.finish(), boxes })
}

/// Whether the structure has a level.
///
/// # Errors
///
/// [`RenderError::NoSuchLevel`] if not.
fn check_level(structure: &Structure<Surfaces<'_>>, level: usize) -> Result<(), RenderError> {
    let mut levels = 0;
    structure.visit_nodes(&mut |node| levels = levels.max(node.level + 1));
    match level < levels {
        true => Ok(()),
        false => Err(RenderError::NoSuchLevel { structure: structure.kind(), level, levels }),
    }
}

/// Whether the bounds of a node are drawn.
fn is_shown(node: &NodeView, level: usize) -> bool {
    match node.references {
        Some(0) => false,
        Some(_) => node.level <= level,
        None => node.level == level,
    }
}

impl BoundsOverlay {
    /// How many boxes or cells there are on the level, with the leaves above it; some may lie outside the picture.
    pub fn boxes(&self) -> usize {
        self.boxes
    }

    /// Draws the lines over a picture. What of them lies outside it is left out.
    pub fn draw_over(&self, picture: &mut RgbImage) {
        // A hue that neither the heat map nor many scenes have, on a dark seam: to be seen on white as on black.
        const LINE: Rgb = Rgb::new(1.0, 0.06, 0.25);
        const SEAM: Rgb = Rgb::ZERO;
        for (x, y, line, seam) in self.lines.pixels() {
            picture.blend(x, y, SEAM, 0.4 * seam);
            picture.blend(x, y, LINE, line);
        }
    }
}
