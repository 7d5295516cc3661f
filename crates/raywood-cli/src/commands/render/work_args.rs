//! Long work: the options about what is kept, and which part of a picture is rendered.

use std::path::PathBuf;
use std::time::Duration;

use raywood_render::{Part, Region};

use crate::checkpoint::Begun;
use crate::failure::Failure;
use crate::parse::{Share, duration, region};

/// The options of long work.
#[derive(clap::Args)]
#[command(next_help_heading = "Long work")]
pub(crate) struct WorkArgs {
    /// Keep what is done, for --resume and merge
    ///
    /// A film: the sums of all samples, and what they are of. It is written every minute, at the end and on Ctrl-C (or the signals TERM and HUP), each time as a whole, so that whatever breaks the work off leaves the last one. `raywood merge` puts films together.
    #[arg(long, value_name = "FILE", help_heading = None::<&'static str>)]
    pub(super) checkpoint: Option<PathBuf>,

    /// Go on with the checkpoint, to the same picture
    ///
    /// The same, bit for bit, as without the break, for any number of threads (but not with --time). Where there is no file yet it begins anew, so that the same command can be given again and again. How the picture is shown and written may change, and --noise and --time (with other numbers, sums may differ in last digits); a film of anything else is refused. Of one that is finished the picture is written anew.
    #[arg(long, requires = "checkpoint", hide_short_help = true)]
    pub(super) resume: bool,

    /// How often what is done is kept [default: 1m]
    ///
    /// As 30s, 5m or 1h. Less often where that takes more than a fiftieth of the time.
    #[arg(long, value_name = "TIME", value_parser = duration, requires = "checkpoint", hide_short_help = true)]
    checkpoint_every: Option<Duration>,

    /// Render a rectangle of the picture alone
    ///
    /// Column and row of its upper left pixel, counted from 0, its width and its height. They are the same pixels, bit for bit, as in the whole picture.
    #[arg(long, value_name = "X,Y,W,H", value_parser = region, allow_hyphen_values = true, conflicts_with = "tile", hide_short_help = true)]
    region: Option<Region>,

    /// Render one of N shares, for `raywood merge`
    ///
    /// As 3/8 on the third of eight machines. Shares are tiles of 32x32 pixels, spread over the picture, so that all take about as long. Put together by `raywood merge` they are the same picture, bit for bit, as one rendered whole. No picture is written unless -o names one, which is black where others work.
    #[arg(long, value_name = "I/N", requires = "checkpoint", hide_short_help = true)]
    tile: Option<Share>,
}

impl WorkArgs {
    /// Which pixels are rendered.
    pub(super) fn part(&self) -> Part {
        match (self.region, self.tile) {
            (Some(region), _) => Part::Region(region),
            (None, Some(Share { number, count })) => Part::Share { index: number - 1, count },
            (None, None) => Part::Whole,
        }
    }

    /// How long rendering goes on before it is kept.
    pub(super) fn every(&self) -> Duration {
        self.checkpoint_every.unwrap_or(Duration::from_secs(60))
    }

    /// What is there to go on with.
    ///
    /// # Errors
    ///
    /// See [`Begun::new`].
    pub(super) fn begin(&self) -> Result<Option<Begun>, Failure> {
        self.checkpoint.as_deref().map(|path| Begun::new(path, self.resume)).transpose()
    }
}
