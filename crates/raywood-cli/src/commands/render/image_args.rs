//! What the picture's file is like: the options about it, checked before any work is done.

use std::path::PathBuf;

use raywood_render::{
    Aov, IMAGE_FORMATS, ImageFormat, RenderOptions, TONE_MAPS, ToneMap, WriteOptions,
};

use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::parse::{Aovs, Exposure, aovs, exposure, tone_map, whole_number};

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
        default_value = "render.png",
        hide_default_value = true,
        help_heading = None::<&'static str>
    )]
    pub(super) output: PathBuf,

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
    pub(super) exposure: Option<Exposure>,

    /// Layers beside the picture, for .exr: names or all
    #[arg(
        long,
        value_name = "NAME,...",
        value_parser = aovs,
        hide_short_help = true,
        long_help = aovs_help()
    )]
    aovs: Option<Aovs>,

    /// Remove noise, guided by surfaces
    ///
    /// For integrator `path`, or with --noise or --time. Neighbours that see the same surface are averaged as far as they differ by no more than their noise, which at least 8 rays per pixel tell; textures and edges stay. An a-trous filter, no neural network: fine shadows and what mirrors and glass show is smoothed where noise hides it.
    #[arg(long, hide_short_help = true)]
    pub(super) denoise: bool,

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

/// All layers, a line each.
fn aovs_help() -> String {
    let line = |aov: Aov| format!("  {:<9} {}", aov.name(), aov.help());
    format!(
        "Layers beside the picture, for .exr: names with commas, or all\n\nFrom the rays of the picture, as channels `normal.X` and the like\n\n{}",
        Aov::ALL.map(line).join("\n")
    )
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
    pub(super) file: OutputFile,
    pub(super) format: &'static ImageFormat,
    pub(super) options: WriteOptions,
}

impl ImageArgs {
    /// The file that is written, known to be writable.
    ///
    /// # Errors
    ///
    /// No known format, options that it has no use for, or a file that cannot be written.
    pub(super) fn file(&self, is_drawn: bool) -> Result<ImageFile, Failure> {
        let name = self.output.display();
        let refuse = |message: String| Err(Failure::BadInput(message));
        let Some(format) = ImageFormat::of_path(&self.output) else {
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
        if self.aovs.is_some() && !format.has_layers {
            return refuse(format!("{name}: {format} has no layers for --aovs: expected .exr"));
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
        Ok(ImageFile { file: OutputFile::new(&self.output)?, format, options })
    }

    /// The layers beside the picture.
    pub(super) fn aovs(&self) -> &[Aov] {
        self.aovs.as_ref().map_or(&[], |aovs| &aovs.0)
    }

    /// How light is shown.
    pub(super) fn tone_map(&self) -> &'static ToneMap {
        self.tone_map.unwrap_or(&TONE_MAPS[0])
    }

    /// What the file says of how it was made.
    pub(super) fn metadata(&self, made: &Made<'_>) -> Vec<(String, String)> {
        let &Made { options, samples, is_denoised, exposure, seconds, threads } = made;
        let mut entries = Vec::new();
        let mut say = |name: &str, text: String| entries.push((name.to_owned(), text));
        if self.metadata == Metadata::None {
            return entries;
        }
        say("Software", concat!("raywood ", env!("CARGO_PKG_VERSION")).to_owned());
        say("raywood:integrator", options.integrator.name.to_owned());
        say("raywood:samples", samples.to_owned());
        say("raywood:seed", options.seed.to_string());
        say("raywood:filter", options.filter.name().to_owned());
        say("raywood:depth", options.max_depth.to_string());
        if let Some(lens) = options.lens {
            say("raywood:lens", format!("radius {}, focus {}", lens.radius, lens.focus));
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
            say("raywood:seconds", format!("{seconds:.3}"));
            say("raywood:threads", threads.to_string());
        }
        entries
    }
}

/// How a picture was made.
#[derive(Clone, Copy)]
pub(super) struct Made<'a> {
    pub(super) options: &'a RenderOptions,
    /// How many samples a pixel has.
    pub(super) samples: &'a str,
    /// Whether noise was removed.
    pub(super) is_denoised: bool,
    /// How much of the light is shown; of files that hold light nothing else is known.
    pub(super) exposure: Option<f32>,
    pub(super) seconds: f64,
    pub(super) threads: usize,
}
