//! What the picture's file is like: the options about it, checked before any work is done.

use std::path::{Path, PathBuf};

use raywood_render::{IMAGE_FORMATS, ImageFormat, TONE_MAPS, ToneMap, WriteOptions};

use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::parse::{Exposure, exposure, tone_map, whole_number};
use crate::settings::Settings;

/// The options of the picture's file.
#[derive(clap::Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct ImageArgs {
    /// Picture: .png .jpg .exr .hdr [default: render.png]
    ///
    /// The ending chooses the format. PNG and JPEG hold what a screen shows; OpenEXR and Radiance (.hdr) hold the light as it was computed, linear and without limits.
    #[arg(
        short,
        long,
        value_name = "FILE",
        help_heading = None::<&'static str>
    )]
    output: Option<PathBuf>,

    /// Bits a channel: PNG 8 or 16, OpenEXR 16 or 32
    ///
    /// Else 8 for PNG and JPEG, 16 (half floats) for OpenEXR.
    #[arg(long, value_name = "N", hide_short_help = true)]
    bits: Option<u32>,

    /// Quality of JPEG, 1 to 100 [default: 90]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole_number(text, 1, 100), hide_short_help = true)]
    quality: Option<u32>,

    /// How bright light becomes what a screen shows
    #[arg(
        long,
        value_name = "NAME",
        value_parser = tone_map,
        hide_short_help = true,
        long_help = tone_maps_help()
    )]
    tone_map: Option<&'static ToneMap>,

    /// How bright, in stops; each doubles the light; or auto
    ///
    /// `auto` makes the picture's log-average brightness a middle grey of 0.18. Else 0, but for integrator `path`, where the picture is darkened until nine tenths of it are not too bright.
    #[arg(long, value_name = "STOPS|auto", value_parser = exposure, allow_hyphen_values = true, hide_short_help = true)]
    pub(crate) exposure: Option<Exposure>,

    /// What the file says of how it was made
    ///
    /// `none`; `settings`: version, integrator, samples, seed and the like, so that equal pictures are equal files; `full`: the command, the time it took and the threads, too. In texts of PNG, comments of OpenEXR and of Radiance files.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Metadata::Settings, hide_short_help = true)]
    metadata: Metadata,
}

/// How much a file says of how it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Metadata {
    None,
    Settings,
    Full,
}

/// All ways of tone mapping, a line each.
fn tone_maps_help() -> String {
    let line = |map: &ToneMap| format!("  {:<9} {}", map.name, map.help);
    let lines: Vec<_> = TONE_MAPS.iter().map(line).collect();
    format!(
        "How bright light becomes what a screen shows [default: {}]\n\n{}",
        TONE_MAPS[0].name,
        lines.join("\n")
    )
}

/// A file to write, and how.
pub(crate) struct ImageFile {
    pub(crate) path: PathBuf,
    pub(crate) file: OutputFile,
    pub(crate) format: &'static ImageFormat,
    pub(crate) options: WriteOptions,
}

/// What a picture is called if nobody says.
const DEFAULT_NAME: &str = "render.png";

impl ImageArgs {
    /// Whether the picture's name was given.
    pub(crate) fn is_named(&self) -> bool {
        self.output.is_some()
    }

    /// Where the picture is written.
    pub(crate) fn path(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new(DEFAULT_NAME))
    }

    /// The file that is written, known to be writable.
    ///
    /// # Errors
    ///
    /// No known format, options that it has no use for, or a file that cannot be written.
    pub(crate) fn file(&self, is_drawn: bool) -> Result<ImageFile, Failure> {
        self.file_at(self.path(), is_drawn)
    }

    /// The same of a file of another name.
    pub(crate) fn file_at(&self, path: &Path, is_drawn: bool) -> Result<ImageFile, Failure> {
        let name = path.display();
        let refuse = |message: String| Err(Failure::BadInput(message));
        let Some(format) = ImageFormat::of_path(path) else {
            let names: Vec<_> = IMAGE_FORMATS.iter().map(|format| format.name).collect();
            let endings = IMAGE_FORMATS.iter().flat_map(|format| format.endings);
            let endings: Vec<_> = endings.map(|ending| format!(".{ending}")).collect();
            return refuse(format!(
                "{name}: pictures are written as {}: the name must end in one of {}",
                names.join(", "),
                endings.join(", ")
            ));
        };

        let mut options = WriteOptions::of(format);
        options.bits = self.bits.unwrap_or(options.bits);
        if !format.bits.contains(&options.bits) {
            let bits: Vec<_> = format.bits.iter().map(ToString::to_string).collect();
            return refuse(format!(
                "{name}: --bits {}: {format} has {} bits a channel",
                options.bits,
                bits.join(" or ")
            ));
        }
        if let Some(quality) = self.quality {
            if format.name != "JPEG" {
                return refuse(format!("{name}: --quality is of JPEG: {format} loses nothing"));
            }
            options.quality = quality as u8;
        }
        if format.holds_light {
            if is_drawn {
                return refuse(format!(
                    "{name}: {format} holds light, but heat maps and bounds are drawn: expected .png or .jpg"
                ));
            }
            let unused =
                [("--tone-map", self.tone_map.is_some()), ("--exposure", self.exposure.is_some())];
            if let Some((option, _)) = unused.into_iter().find(|(_, is_given)| *is_given) {
                return refuse(format!(
                    "{name}: {format} holds light as it is, {option} is for what a screen shows: expected .png or .jpg"
                ));
            }
        }
        Ok(ImageFile { path: path.to_owned(), file: OutputFile::new(path)?, format, options })
    }

    /// How light is shown.
    pub(crate) fn tone_map(&self) -> &'static ToneMap {
        self.tone_map.unwrap_or(&TONE_MAPS[0])
    }

    /// What the file says of how it was made.
    pub(crate) fn metadata(&self, made: &Made<'_>) -> Vec<(String, String)> {
        let &Made { settings, samples, is_denoised, exposure, seconds, threads } = made;
        let mut entries = Vec::new();
        let mut say = |name: &str, text: String| entries.push((name.to_owned(), text));
        if self.metadata == Metadata::None {
            return entries;
        }
        say("Software", concat!("raywood ", env!("CARGO_PKG_VERSION")).to_owned());
        let setting = |option| settings.value(option).map(str::to_owned);
        let known = [
            ("raywood:integrator", setting("--integrator")),
            ("raywood:samples", Some(samples.to_owned())),
            ("raywood:seed", setting("--seed")),
            ("raywood:filter", setting("--filter")),
            ("raywood:depth", setting("--depth")),
            ("raywood:lens", setting("lens")),
        ];
        for (name, text) in known {
            text.into_iter().for_each(|text| say(name, text));
        }
        if is_denoised {
            say("raywood:denoised", "yes".to_owned());
        }
        if let Some(exposure) = exposure {
            say("raywood:exposure", format!("{:+} stops", exposure.log2()));
            say("raywood:tone-map", self.tone_map().name.to_owned());
        }
        if self.metadata == Metadata::Full {
            let arguments = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
            say("raywood:command", arguments.collect::<Vec<_>>().join(" "));
            if let Some(seconds) = seconds {
                say("raywood:seconds", format!("{seconds:.3}"));
            }
            say("raywood:threads", threads.to_string());
        }
        entries
    }
}

/// How a picture was made.
#[derive(Clone, Copy)]
pub(crate) struct Made<'a> {
    /// What it is of.
    pub(crate) settings: &'a Settings,
    /// How many samples a pixel has.
    pub(crate) samples: &'a str,
    /// Whether noise was removed.
    pub(crate) is_denoised: bool,
    /// How much of the light is shown; of files that hold light nothing else is known.
    pub(crate) exposure: Option<f32>,
    /// How long the rendering took, if it was one.
    pub(crate) seconds: Option<f64>,
    pub(crate) threads: usize,
}
