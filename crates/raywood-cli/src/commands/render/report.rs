//! What `raywood render` says it did.

use std::path::Path;
use std::time::Duration;

use raywood::{StructureKind, StructureStats};
use raywood_render::{Ended, Part, RenderOptions, RenderStats, Shutter};
use raywood_scene::Scene;
use serde_json::{Value, json};

use super::{Args, Times};
use crate::exporters;
use crate::parse::Size;
use crate::picture::{Bounds, Heat, Passes};
use crate::print::{thousands, threads};

/// What was done and how long it took.
pub(super) struct Report<'a> {
    pub(super) args: &'a Args,
    /// The picture, if it was written.
    pub(super) output: Option<&'a Path>,
    /// The film, if it was kept.
    pub(super) checkpoint: Option<&'a Path>,
    pub(super) options: &'a RenderOptions,
    /// How many samples a pixel has.
    pub(super) samples: &'a str,
    pub(super) passes: Option<Passes>,
    pub(super) scene: &'a Scene,
    pub(super) kind: StructureKind,
    /// Whether the structure was saved with the scene.
    pub(super) is_saved: bool,
    pub(super) structure: StructureStats,
    pub(super) times: Times,
    pub(super) render: RenderStats,
    pub(super) heat: Option<Heat>,
    pub(super) bounds: Option<Bounds>,
    pub(super) exposure: f32,
    pub(super) write: Duration,
}

impl Report<'_> {
    /// For people.
    pub(super) fn as_text(&self) -> String {
        let Self { args, scene, kind, is_saved, structure, .. } = self;
        let Self { times: Times { load, build, view }, render, heat, bounds, write, .. } = self;
        let rays = render.rays;
        let seconds = |d: &Duration| format!("{:8.3} s", d.as_secs_f64());
        let mut text = format!("wrote {}: {}\n", self.written(), self.what());
        let mut line = |name: &str, value: String| text += &format!("  {name:<8}{value}\n");

        let spheres = match scene.spheres.as_slice().len() {
            0 => String::new(),
            n => format!(", {} spheres", thousands(n as u64)),
        };
        let triangles = thousands(scene.mesh.triangles.triangles().len() as u64);
        let shown = match scene.instances.placed().len() {
            0 => String::new(),
            instances => format!(
                ", {} of them to be seen by {} instances",
                thousands(scene.visible_triangles()),
                thousands(instances as u64)
            ),
        };
        line("load", format!("{}   {triangles} triangles{shown}{spheres}", seconds(load)));
        let megabytes = structure.bytes as f64 / 1e6;
        let (nodes, depth) = (thousands(structure.nodes as u64), structure.depth);
        let size = format!("{nodes} nodes, depth {depth}, {megabytes:.1} MB");
        let saved = if *is_saved { " as saved" } else { "" };
        line("build", format!("{}   {}{saved}, {size}", seconds(build), kind.name()));
        line("view", seconds(view));
        let [primary, shadow, reflection, refraction] =
            [rays.primary, rays.shadow, rays.reflection, rays.refraction].map(thousands);
        // Of a path tracer each primary ray begins a path.
        let paths = match args.integrator.name {
            "path" => format!("{:.2} million paths/s, ", render.million_paths_per_second()),
            _ => String::new(),
        };
        line(
            "render",
            format!(
                "{}   {paths}{:.1} million rays/s on {}",
                seconds(&render.elapsed),
                render.million_rays_per_second(),
                threads(render.threads)
            ),
        );
        if let Some(Passes { noise: Some(noise), .. }) = &self.passes {
            line("noise", format!("{:8.2} %", 100.0 * noise));
        }
        if let Some(lens) = self.options.lens {
            let (width, focus) = (2.0 * lens.radius, lens.focus);
            line("lens", format!("{width} wide, in focus at {focus}"));
        }
        if scene.instances.moves() {
            let Shutter { open, close } = self.options.shutter;
            line("shutter", format!("open from {open} to {close}"));
        }
        if let Some(Bounds { level, boxes, time }) = bounds {
            let boxes = thousands(*boxes as u64);
            line("bounds", format!("{}   {boxes} boxes of level {level}", seconds(time)));
        }
        if self.exposure != 1.0 {
            line("expose", format!("{:+.2} stops", self.exposure.log2()));
        }
        line("write", seconds(write));
        line(
            "rays",
            format!(
                "{primary} primary, {shadow} shadow, {reflection} reflection, {refraction} refraction"
            ),
        );
        if let Some(Heat { quantity, mean, max, scale, pixels_above }) = heat {
            let above = match pixels_above {
                0 => String::new(),
                above => format!(", {} pixels above", thousands(*above as u64)),
            };
            let label = quantity.label();
            let values = format!("mean {mean:.1}, maximum {max}, scale 0 to {scale}{above}");
            line("heat", format!("{label}: {values}"));
        }
        text
    }

    /// The picture in a few words.
    fn what(&self) -> String {
        let Args { scene, size: Size { width, height }, .. } = self.args;
        let part = match self.args.work.part() {
            Part::Whole => String::new(),
            Part::Region(region) => {
                format!(
                    " (region of {}x{} at {},{})",
                    region.width, region.height, region.x, region.y
                )
            }
            Part::Share { index, count } => format!(" (tile {}/{count})", u64::from(index) + 1),
        };
        format!("{scene} at {width}x{height}{part}, {} samples per pixel", self.samples)
    }

    /// The files.
    fn written(&self) -> String {
        let files = [self.output, self.checkpoint].into_iter().flatten();
        files.map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and ")
    }

    /// For programs.
    pub(super) fn as_json(&self) -> Value {
        let Self { args, scene, kind, is_saved, structure, .. } = self;
        let Self { times: Times { load, build, view }, render, heat, bounds, write, .. } = self;
        let rays = render.rays;
        json!({
            "scene": args.scene,
            "output": self.output.map(|path| path.display().to_string()),
            "checkpoint": self.checkpoint.map(|path| path.display().to_string()),
            "width": args.size.width,
            "height": args.size.height,
            "integrator": args.integrator.name,
            "exposure": self.exposure,
            "samples": self.options.samples,
            "seed": self.options.seed,
            "passes": self.passes.as_ref().map(|passes| json!({
                "fewest_samples": passes.samples.0,
                "most_samples": passes.samples.1,
                "mean_samples": passes.mean_samples,
                "noise": passes.noise,
                "ended": match passes.ended {
                    Ended::Samples => "samples",
                    Ended::Noise => "noise",
                    Ended::Time => "time",
                    Ended::Cancelled => "cancelled",
                },
            })),
            "lens": self.options.lens.map(|lens| json!({
                "radius": lens.radius, "focus": lens.focus,
            })),
            "shutter": scene.instances.moves().then(|| json!({
                "open": self.options.shutter.open, "close": self.options.shutter.close,
            })),
            "depth": args.depth,
            "threads": render.threads,
            "triangles": scene.mesh.triangles.triangles().len(),
            "visible_triangles": scene.visible_triangles(),
            "instances": scene.instances.placed().len(),
            "spheres": scene.spheres.as_slice().len(),
            "warnings": scene.warnings,
            "saved_tree": is_saved,
            "seconds": {
                "load": load.as_secs_f64(),
                "build": build.as_secs_f64(),
                "view": view.as_secs_f64(),
                "render": render.elapsed.as_secs_f64(),
                "write": write.as_secs_f64(),
            },
            "rays": {
                "primary": rays.primary,
                "shadow": rays.shadow,
                "reflection": rays.reflection,
                "refraction": rays.refraction,
                "total": rays.total(),
            },
            "million_rays_per_second": render.million_rays_per_second(),
            "million_paths_per_second": render.million_paths_per_second(),
            "heatmap": heat.as_ref().map(|heat| json!({
                "quantity": heat.quantity.name(),
                "mean": heat.mean,
                "max": heat.max,
                "scale": heat.scale,
                "pixels_above_scale": heat.pixels_above,
            })),
            "bounds": bounds.as_ref().map(|bounds| json!({
                "level": bounds.level, "boxes": bounds.boxes, "seconds": bounds.time.as_secs_f64(),
            })),
            "structure": exporters::structure(*kind, structure),
        })
    }
}
