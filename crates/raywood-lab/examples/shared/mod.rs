//! What examples that build structures over a scene share: `SCENE THREADS STRUCTURE[:PRESET]...` on the command line.

use rayon::ThreadPool;
use raywood::{BuildPreset, StructureKind};
use raywood_scene::{LoadOptions, Scene, builtin, load_file};

/// What the command line asks for.
pub(crate) struct Builds {
    pub(crate) scene: Scene,
    pub(crate) pool: ThreadPool,
    /// The structures, each with a preset, `balanced` if none is named.
    pub(crate) builds: Vec<(StructureKind, BuildPreset)>,
}

impl Builds {
    /// Reads the command line and the scene.
    pub(crate) fn from_args() -> Self {
        let mut args = std::env::args().skip(1);
        let name = args.next().expect("scene");
        let threads = args.next().and_then(|threads| threads.parse().ok()).expect("threads");
        let build = |text: String| {
            let (kind, preset) = text.split_once(':').unwrap_or((&text, "balanced"));
            let preset = BuildPreset::from_name(preset).expect("a preset");
            (StructureKind::from_name(kind).expect("a structure"), preset)
        };
        let scene = match name.strip_prefix("builtin:") {
            Some(name) => builtin(name).expect("a scene"),
            None => load_file(name.as_ref(), &LoadOptions::default()).expect("a scene"),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        Self { scene, pool, builds: args.map(build).collect() }
    }
}
