//! `raywood scenes`: lists the built-in scenes.

use raywood_scene::builtins;
use serde_json::json;

use crate::failure::Failure;
use crate::print;
use crate::scene_source::BUILTIN_PREFIX;

/// List the built-in scenes and their parameters.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.json {
        let scenes = builtins().iter().map(|scene| {
            let parameters = scene.parameters.iter().map(|p| {
                json!({ "name": p.name, "description": p.description, "default": p.default, "min": p.min, "max": p.max })
            });
            json!({
                "name": format!("{BUILTIN_PREFIX}{}", scene.name),
                "description": scene.description,
                "parameters": parameters.collect::<Vec<_>>(),
            })
        });
        return print::json(&scenes.collect());
    }

    let mut text = String::new();
    for scene in builtins() {
        text += &format!("{BUILTIN_PREFIX}{}\n    {}\n", scene.name, scene.description);
        for p in scene.parameters {
            text += &format!(
                "    ?{}={}  {} ({} to {})\n",
                p.name, p.default, p.description, p.min, p.max
            );
        }
    }
    text +=
        "\nParameters follow the name, joined by `&`: raywood render 'builtin:terrain?n=1024'\n";
    print::result(&text)
}
