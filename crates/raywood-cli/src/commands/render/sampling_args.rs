//! How many rays a pixel has, and where they go: the options about it.

use std::time::Duration;

use raywood_render::{Goal, PixelFilter, RenderOptions, Shutter};

use crate::parse::{duration, noise, pixel_filter, shutter};

/// The options of sampling.
#[derive(clap::Args)]
#[command(next_help_heading = "Sampling")]
pub(crate) struct SamplingArgs {
    /// Rays per pixel [default: 4]
    ///
    /// With --noise or --time the most [default: 65536].
    #[arg(short = 'n', long, value_name = "N", help_heading = None::<&'static str>)]
    samples: Option<u32>,

    /// Stop where the relative error is so small
    ///
    /// As 0.02 or 2%. The picture is rendered in passes of 4 to 16 rays a pixel. A square of 16x16 pixels is done when it has at least 16 rays a pixel and the root mean square of its pixels' standard errors, estimated from how much the passes differ, is so small a share of its mean brightness (and a tenth of that of the whole picture). The same picture for any number of threads.
    #[arg(long, value_name = "ERROR", value_parser = noise, hide_short_help = true)]
    noise: Option<f32>,

    /// Stop after so long, as 30s, 5m or 1h
    ///
    /// As many passes as fit; each of all pixels.
    #[arg(long, value_name = "TIME", value_parser = duration, hide_short_help = true)]
    time: Option<Duration>,

    /// How rays are spread: tent, box, blackman-harris
    ///
    /// `tent` over two pixels' width, `box` over the pixel alone, `blackman-harris` over three pixels, but mostly near. All rays weigh the same.
    #[arg(long, value_name = "NAME", value_parser = pixel_filter, default_value = "tent", hide_short_help = true)]
    filter: PixelFilter,

    /// When the shutter opens and closes, as 0,0.5
    ///
    /// Both from 0 to 1, the time in which instances move that have `to` in a scene file: from where they stand to there. Each ray from the eye has a time between the two, and all rays that follow from it have the same, so that what moves is blurred. Equal numbers show everything where it is at that time. Pictures in which nothing moves do not depend on it. Heat maps, bounds and what --focus finds are of time 0.
    #[arg(long, value_name = "OPEN,CLOSE", value_parser = shutter, default_value = "0,1", hide_short_help = true)]
    shutter: Shutter,

    /// Another seed has other noise
    #[arg(long, value_name = "N", default_value_t = 0, hide_short_help = true)]
    seed: u32,
}

impl SamplingArgs {
    /// Puts them into the options of a picture.
    pub(super) fn apply(&self, options: &mut RenderOptions) {
        let most = if self.goal().is_open() { 1 << 16 } else { 4 };
        options.samples = self.samples.unwrap_or(most);
        options.filter = self.filter;
        options.shutter = self.shutter;
        options.seed = self.seed;
    }

    /// When the picture is done.
    pub(super) fn goal(&self) -> Goal {
        Goal { noise: self.noise, time: self.time, in_one_pass: false }
    }
}
