//! Depth of field: the options about the lens.

use raywood_render::{Lens, PreparedScene, depth_at};
use raywood_scene::Camera;

use crate::failure::Failure;
use crate::parse::{Focus, Size, above_zero, focus};

/// The options of the lens.
#[derive(clap::Args)]
#[command(next_help_heading = "Depth of field")]
pub(crate) struct LensArgs {
    /// Width of the lens's opening, in the scene's units
    ///
    /// The larger, the more is blurred what lies before and behind the plane of focus.
    #[arg(long, value_name = "WIDTH", value_parser = above_zero, group = "opening", hide_short_help = true)]
    aperture: Option<f32>,

    /// The opening as an f-number, as 2.8
    ///
    /// As of a camera of the same field of view whose picture is 24 mm high, in a scene whose unit is the metre.
    #[arg(long, value_name = "N", value_parser = above_zero, group = "opening", hide_short_help = true)]
    f_number: Option<f32>,

    /// What is sharp: a distance, or a pixel X,Y
    ///
    /// A distance from the eye along the line of sight, or what is seen at a pixel, counted from the upper left corner. Else what is seen in the middle.
    #[arg(long, value_name = "DISTANCE|X,Y", value_parser = focus, requires = "opening", hide_short_help = true)]
    focus: Option<Focus>,
}

impl LensArgs {
    /// The lens, if one is asked for.
    ///
    /// # Errors
    ///
    /// Nothing is seen where the focus should be, or the camera sees nothing.
    pub(super) fn lens(
        &self,
        prepared: &PreparedScene<'_>,
        camera: &Camera,
        Size { width, height }: Size,
    ) -> Result<Option<Lens>, Failure> {
        if self.aperture.is_none() && self.f_number.is_none() {
            return Ok(None);
        }
        let depth =
            |place| depth_at(prepared, camera, (width, height), place).map_err(Failure::bad_input);
        let focus = match self.focus {
            Some(Focus::Distance(distance)) => distance,
            Some(Focus::Pixel([x, y])) => {
                if x >= width as f32 || y >= height as f32 {
                    return Err(Failure::BadInput(format!(
                        "--focus {x},{y}: the picture has {width}x{height} pixels"
                    )));
                }
                depth([x + 0.5, y + 0.5])?.ok_or_else(|| {
                    Failure::BadInput(format!(
                        "--focus {x},{y}: nothing is seen there, expected a pixel with something, or a distance"
                    ))
                })?
            }
            // Where nothing is, what the camera is turned to.
            None => depth([0.5 * width as f32, 0.5 * height as f32])?
                .unwrap_or((camera.target - camera.eye).length()),
        };
        Ok(Some(match (self.aperture, self.f_number) {
            (_, Some(f_number)) => Lens::of_f_number(f_number, camera.fov_y, focus),
            (aperture, None) => Lens { radius: 0.5 * aperture.unwrap_or(0.0), focus },
        }))
    }
}
