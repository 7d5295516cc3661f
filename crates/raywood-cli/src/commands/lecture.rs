//! `raywood lecture`: the claims of the lecture on accelerating ray tracing as experiments.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::ValueEnum;
use raywood_lab::lecture::{EXPERIMENTS, Entry, Lab, default_scenes};

use super::thread_pool;
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::print;
use crate::progress_bar::during_step;
use crate::report::experiments::{self, Run};
use crate::scene_source;
use crate::simd_args::SimdArgs;

/// Measure what is said about ray tracing structures, claim by claim.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file or built-in scene, else several built-in ones
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, a scene file (TOML) that puts several together, or a scene saved by `raywood build`; `raywood scenes` lists the built-in scenes. Some experiments make their own scenes as well, because they need such of many sizes.
    scene: Option<String>,

    /// Write a page with all tables and charts
    ///
    /// One file that needs no other and can be opened in any browser.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    /// Print verdicts as text, or all as json
    #[arg(long, value_name = "FORMAT", default_value = "text", hide_possible_values = true)]
    format: Format,

    /// Seconds instead of minutes, with small scenes
    #[arg(long)]
    quick: bool,

    /// Only some experiments, else all
    ///
    /// A wrong name is answered with those that exist.
    #[arg(long, value_name = "ID,...", value_delimiter = ',', value_parser = experiment)]
    only: Vec<&'static Entry>,

    /// Most threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    #[command(flatten)]
    simd: SimdArgs,
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// The verdicts, to read.
    Text,
    /// Everything, for programs.
    Json,
}

/// The experiment of a name.
fn experiment(id: &str) -> Result<&'static Entry, String> {
    EXPERIMENTS.iter().find(|entry| entry.id == id).ok_or_else(|| {
        let ids: Vec<_> = EXPERIMENTS.iter().map(|entry| entry.id).collect();
        format!("expected some of {}", ids.join(", "))
    })
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    args.simd.activate()?;
    let output = args.html.as_deref().map(OutputFile::new).transpose()?;
    let started = Instant::now();
    let pool = thread_pool(args.threads.map(usize::from))?;
    let scenes = match &args.scene {
        Some(name) => {
            let load = || pool.install(|| scene_source::load(name, false));
            vec![during_step("loading", load)?.without_instances("the lecture")?.scene]
        }
        None => during_step("making scenes", || pool.install(|| default_scenes(args.quick))),
    };
    let threads = pool.current_num_threads();
    let lab = Lab::new(&scenes, args.quick, threads).map_err(Failure::bad_input)?;
    for scene in &scenes {
        for warning in &scene.warnings {
            print::warning(format_args!("{}: {warning}", scene.name));
        }
    }

    let mut experiments = Vec::new();
    for (number, entry) in (1..).zip(EXPERIMENTS) {
        // As often as it is asked for, and in the lecture's order.
        if !args.only.is_empty() && !args.only.iter().any(|wanted| wanted.id == entry.id) {
            continue;
        }
        let step = format!("experiment {number} of {}: {}", EXPERIMENTS.len(), entry.title);
        let experiment = during_step(&step, || pool.install(|| entry.run(&lab)));
        experiments.push(experiment.map_err(Failure::bad_input)?);
    }

    let names: Vec<_> = lab.scene_names().map(str::to_owned).collect();
    let seconds = started.elapsed().as_secs_f64();
    let run = Run { scenes: &names, threads, quick: args.quick, seconds };
    if let Some(output) = &output {
        let page = experiments::as_html(&run, &experiments)?;
        output.write(|writer: &mut dyn Write| writer.write_all(page.as_bytes()))?;
    }
    match args.format {
        Format::Json => print::json(&experiments::as_json(&run, &experiments)),
        Format::Text => {
            let mut text = experiments::as_text(&experiments);
            if let Some(path) = &args.html {
                text += &format!("wrote {}\n", path.display());
            }
            print::result(&text)
        }
    }
}
