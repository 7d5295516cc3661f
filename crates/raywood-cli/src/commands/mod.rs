//! The subcommands, one per file. To add one, write its file and name it here.

mod bench;
mod build;
mod compare;
mod info;
mod lecture;
mod merge;
mod query;
mod render;
mod scenes;

use clap::Subcommand;

use crate::failure::Failure;

/// What to do.
#[derive(Subcommand)]
pub(crate) enum Command {
    // Its short help fills a screen already.
    #[command(mut_arg("simd", |arg| arg.hide_short_help(true)))]
    #[command(mut_arg("preset", |arg| arg.hide_short_help(true)))]
    Render(Box<render::Args>),
    Merge(merge::Args),
    Build(build::Args),
    Compare(compare::Args),
    Bench(bench::Args),
    Query(query::Args),
    Info(info::Args),
    Lecture(lecture::Args),
    Scenes(scenes::Args),
}

impl Command {
    /// Does it.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Render(args) => render::run(args),
            Self::Merge(args) => merge::run(args),
            Self::Build(args) => build::run(args),
            Self::Compare(args) => compare::run(args),
            Self::Bench(args) => bench::run(args),
            Self::Query(args) => query::run(args),
            Self::Info(args) => info::run(args),
            Self::Lecture(args) => lecture::run(args),
            Self::Scenes(args) => scenes::run(args),
        }
    }
}

/// The threads that all work of a command runs on.
fn thread_pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()
        .map_err(|error| Failure::while_running(format!("cannot start the threads: {error}")))
}
