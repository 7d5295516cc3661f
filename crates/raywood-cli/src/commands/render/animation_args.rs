//! Moving pictures: the options about cameras that move, and how their frames are called.

use std::path::{Path, PathBuf};

use raywood::Vec3;
use raywood_scene::{Camera, Scene};

use crate::failure::Failure;
use crate::parse::degrees;
use crate::view_args::camera_called;

/// The most frames.
const MOST_FRAMES: i64 = 1_000_000;

/// The options of animations.
#[derive(clap::Args)]
#[command(next_help_heading = "Animation")]
pub(crate) struct AnimationArgs {
    /// Render N pictures of a camera that moves
    ///
    /// It turns once around what it looks at, so that the last frame leads to the first again, or goes --through cameras of the scene. Files are numbered from 1 on where the name given by -o has %d or %04d, else before its ending: render_0001.png. Lights and exposure are those of the first
    /// frame.
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES),
        conflicts_with_all = ["checkpoint", "region", "tile"],
        hide_short_help = true
    )]
    pub(super) frames: Option<u32>,

    /// How far the camera turns [default: 360]
    ///
    /// Counter-clockwise seen from above; less than 0 is the other way round.
    #[arg(long, value_name = "DEGREES", value_parser = degrees, allow_hyphen_values = true, requires = "frames", hide_short_help = true)]
    turn: Option<f32>,

    /// Cameras to move through: N|NAME,... or all
    ///
    /// Those of the scene file or model, by their numbers, from 1, or names; `raywood info` lists them. The way is smooth and takes as long from each to the next. Where it ends with the camera with which it begins the last frame leads to the first again.
    #[arg(long, value_name = "CAMERAS", requires = "frames", conflicts_with_all = ["turn", "camera", "eye", "target", "fov"], hide_short_help = true)]
    through: Option<String>,

    /// Leave frames out whose files are there
    ///
    /// To go on where an animation was broken off: files are whole or not there. Whether they are of the same scene nobody looks.
    #[arg(long, requires = "frames", hide_short_help = true)]
    pub(super) skip_existing: bool,
}

impl AnimationArgs {
    /// The camera of each frame, if there are several. `first` is the camera of a picture that is no animation, `up` the direction that is up.
    ///
    /// # Errors
    ///
    /// The scene has no camera of a name.
    pub(super) fn cameras(
        &self,
        scene: &Scene,
        first: &Camera,
        up: Vec3,
    ) -> Result<Option<Vec<Camera>>, Failure> {
        let Some(frames) = self.frames else { return Ok(None) };
        let keys = match self.through.as_deref() {
            None => {
                let turn = self.turn.unwrap_or(360.0) / frames as f32;
                let turned = (0..frames).map(|frame| first.turned(up, turn * frame as f32));
                return Ok(Some(turned.collect()));
            }
            Some("all") => scene.cameras.clone(),
            Some(names) => names
                .split(',')
                .map(|name| camera_called(name.trim(), scene))
                .collect::<Result<_, _>>()?,
        };
        if keys.is_empty() {
            return Err(Failure::BadInput(format!(
                "{}: has no cameras for --through all",
                scene.name
            )));
        }
        let is_round = keys.len() > 2 && keys.first() == keys.last();
        // Of a round trip the last frame is one before the first.
        let steps = if is_round { frames } else { (frames - 1).max(1) };
        let moments = (0..frames).map(|frame| frame as f32 / steps as f32);
        Ok(Some(moments.filter_map(|moment| Camera::on_the_way(&keys, moment)).collect()))
    }

    /// The camera of the first frame as far as the lights are concerned, if it is one of the scene.
    pub(super) fn first_key(&self) -> Option<&str> {
        match self.through.as_deref()? {
            "all" => Some("1"),
            names => names.split(',').next().map(str::trim),
        }
    }
}

/// The name of a frame's file: its number in the place of `%d` or `%04d`, else before the ending.
///
/// # Errors
///
/// There is something else with `%` than one number.
pub(super) fn frame_path(pattern: &Path, number: u32) -> Result<PathBuf, Failure> {
    let name = pattern.file_name().unwrap_or_default().to_string_lossy();
    let Some((before, after)) = name.split_once('%') else {
        let stem = pattern.file_stem().unwrap_or_default().to_string_lossy();
        let ending = pattern.extension().map(|ending| format!(".{}", ending.to_string_lossy()));
        let ending = ending.unwrap_or_default();
        return Ok(pattern.with_file_name(format!("{stem}_{number:04}{ending}")));
    };
    let refuse = || {
        Failure::BadInput(format!(
            "{}: expected one number of the frame in the name, as %d or %04d",
            pattern.display()
        ))
    };
    let (width, after) = after.split_once('d').ok_or_else(refuse)?;
    let digits = match width {
        "" => Some(0),
        _ => width.strip_prefix('0').and_then(|width| width.parse::<u8>().ok()),
    };
    let digits = digits.filter(|_| !after.contains('%')).ok_or_else(refuse)?;
    let number = format!("{number:0digits$}", digits = digits.min(20).into());
    Ok(pattern.with_file_name(format!("{before}{number}{after}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_where_the_name_says() {
        let name = |pattern: &str, number| frame_path(Path::new(pattern), number).ok();
        for (pattern, expected) in [
            ("render.png", "render_0007.png"),
            ("out/a.b.exr", "out/a.b_0007.exr"),
            ("f%d.png", "f7.png"),
            ("out/%03d.jpg", "out/007.jpg"),
            ("100/f%02dx.png", "100/f07x.png"),
        ] {
            assert_eq!(name(pattern, 7), Some(expected.into()), "{pattern}");
        }
        assert_eq!(name("f%02d.png", 12345), Some("f12345.png".into()));
        for bad in ["f%s.png", "f%.png", "f%4d.png", "%d%d.png", "%d-%.png", "f%0d.png"] {
            assert_eq!(name(bad, 7), None, "{bad}");
        }
    }
}
