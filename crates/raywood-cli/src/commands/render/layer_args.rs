//! What is made of a picture beside it or after it from its scene: the options about layers and noise.

use raywood_render::Aov;

use crate::failure::Failure;
use crate::image_args::ImageFile;
use crate::parse::{Aovs, aovs};

/// The options of layers.
#[derive(clap::Args)]
#[command(next_help_heading = "Picture")]
pub(crate) struct LayerArgs {
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
}

impl LayerArgs {
    /// The layers beside the picture.
    pub(super) fn aovs(&self) -> &[Aov] {
        self.aovs.as_ref().map_or(&[], |aovs| &aovs.0)
    }

    /// Whether a file has a place for them.
    ///
    /// # Errors
    ///
    /// It has none.
    pub(super) fn check(&self, file: &ImageFile) -> Result<(), Failure> {
        let ImageFile { path, format, .. } = file;
        if self.aovs.is_some() && !format.has_layers {
            return Err(Failure::BadInput(format!(
                "{}: {format} has no layers for --aovs: expected .exr",
                path.display()
            )));
        }
        Ok(())
    }
}

/// All layers, a line each.
fn aovs_help() -> String {
    let line = |aov: Aov| format!("  {:<9} {}", aov.name(), aov.help());
    format!(
        "Layers beside the picture, for .exr: names with commas, or all\n\nFrom the rays of the picture, as channels `normal.X` and the like\n\n{}",
        Aov::ALL.map(line).join("\n")
    )
}
