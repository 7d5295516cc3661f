//! `raywood info`: what is in a scene, and what its structure is like.

use raywood::{Geometry, SimdLevel, StructureKind, StructureStats};
use raywood_scene::{Clearcoat, LightKind, Material, Rgb, Scene};
use serde_json::{Value, json};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::exporters;
use crate::failure::Failure;
use crate::parse::structure_kind;
use crate::print::{self, thousands};
use crate::progress_bar::during_step;
use crate::scene_source::{self, Loaded};
use crate::simd_args::SimdArgs;

/// Tell what a scene holds, and what its structure is like.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:whitted
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, a scene file (TOML) that puts several together, or a scene saved by `raywood build`; `raywood scenes` lists the built-in scenes.
    #[arg(default_value = "builtin:hall", hide_default_value = true)]
    scene: String,

    /// Acceleration structure to build
    ///
    /// A wrong name is answered with those that exist.
    #[arg(long, value_name = "NAME", value_parser = structure_kind)]
    structure: Option<StructureKind>,

    #[command(flatten)]
    build: BuildArgs,

    #[command(flatten)]
    simd: SimdArgs,

    /// Refuse what is otherwise mended with a warning
    #[arg(long)]
    strict: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.simd.activate()?;
    let pool = thread_pool(None)?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let kind = args.structure.unwrap_or_default();
    let loaded = match kind == StructureKind::default() {
        true => loaded,
        false => loaded.without_instances("another structure")?,
    };
    let prepared = args.build.prepare(&loaded.scene, loaded.tree.as_ref(), kind, &pool)?;
    let stats = prepared.stats();
    let level = prepared.simd_level();
    if args.json {
        print::json(&as_json(&loaded, kind, &stats, level))
    } else {
        print::result(&as_text(&loaded, kind, &stats, level))
    }
}

fn as_text(
    Loaded { scene, time, .. }: &Loaded,
    kind: StructureKind,
    stats: &StructureStats,
    level: Option<SimdLevel>,
) -> String {
    let mesh = &scene.mesh;
    let bounds = scene.bounds();
    let point = |p: raywood::Vec3| format!("({}, {}, {})", p.x, p.y, p.z);
    let mut text = format!("{}: loaded in {:.3} s\n", scene.name, time.as_secs_f64());
    let mut line = |name: &str, value: &str| text += &format!("{name:<11}{value}\n");

    line("triangles", &thousands(mesh.triangles.len() as u64));
    if !scene.instances.is_empty() {
        let (objects, places) = (scene.instances.objects().len(), scene.instances.placed().len());
        let visible = thousands(scene.visible_triangles());
        let places = thousands(places as u64);
        line(
            "instances",
            &format!("{places} of {objects} objects, {visible} triangles to be seen"),
        );
    }
    line("vertices", &thousands(mesh.triangles.positions().len() as u64));
    if scene.spheres.len() > 0 {
        line("spheres", &thousands(scene.spheres.len() as u64));
    }
    let has_coordinates = mesh.texture_coordinates.iter().any(|set| !set.is_empty());
    let given = [
        (!mesh.normals.is_empty(), "normals"),
        (!mesh.colors.is_empty(), "colours"),
        (has_coordinates, "texture coordinates"),
        (!mesh.tangents.is_empty(), "tangents"),
    ];
    let given: Vec<_> = given.iter().filter(|(given, _)| *given).map(|(_, name)| *name).collect();
    line(
        "per vertex",
        if given.is_empty() { "positions only".into() } else { given.join(", ") }.as_str(),
    );
    if bounds.is_empty() {
        line("bounds", "empty");
    } else {
        line("bounds", &format!("{} to {}", point(bounds.min), point(bounds.max)));
    }
    line(
        "structure",
        &match scene.instances.is_empty() {
            true => format!("{}: {stats}", kind.name()),
            false => format!(
                "{}: a tree over trees, {} nodes, depth {} at most below, {:.1} MB",
                kind.name(),
                thousands(stats.nodes as u64),
                stats.depth,
                stats.bytes as f64 / 1e6
            ),
        },
    );
    line("traced by", instructions(level));

    line("materials", &scene.materials.len().to_string());
    for material in &scene.materials {
        line("", &format!("{}: {}", name_or(&material.name), describe(material)));
    }
    if !scene.images.is_empty() {
        let bytes: usize = scene.images.iter().map(|image| image.bytes()).sum();
        line("images", &format!("{}, {:.1} MB", scene.images.len(), bytes as f64 / 1e6));
    }
    if let Some(panorama) = &scene.environment {
        line("panorama", &format!("{} x {} texels", panorama.width(), panorama.height()));
    }
    line("lights", &scene.lights.len().to_string());
    for light in &scene.lights {
        line(
            "",
            &format!(
                "{}: {}, intensity {}",
                name_or(&light.name),
                light_kind(&light.kind),
                point(light.intensity)
            ),
        );
    }
    line("cameras", &scene.cameras.len().to_string());
    for camera in &scene.cameras {
        let (eye, target) = (point(camera.eye), point(camera.target));
        line(
            "",
            &format!("{}: from {eye} to {target}, {} degrees", name_or(&camera.name), camera.fov_y),
        );
    }
    text
}

/// The instructions in words.
fn instructions(level: Option<SimdLevel>) -> &'static str {
    level.map_or("scalar instructions", |level| level.name())
}

fn name_or(name: &str) -> &str {
    if name.is_empty() { "(unnamed)" } else { name }
}

fn light_kind(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
        LightKind::Directional { .. } => "directional",
        LightKind::Ambient => "ambient",
    }
}

/// A material in a few words.
fn describe(material: &Material) -> String {
    let color = |c: Rgb| format!("({:.2}, {:.2}, {:.2})", c.x, c.y, c.z);
    let mut parts = vec![];
    let mut part = |name: &str, c: Rgb| {
        if c != Rgb::ZERO {
            parts.push(format!("{name} {}", color(c)));
        }
    };
    part("diffuse", material.diffuse);
    part("mirror", material.mirror);
    part("transmission", material.transmission);
    part("absorption", material.absorption);
    part("emission", material.emission);
    if material.transmission != Rgb::ZERO {
        parts.push(format!("ior {}", material.ior));
    }
    if material.specular != Rgb::ZERO {
        parts.push(format!(
            "highlight {} exponent {:.0}",
            color(material.specular),
            material.shininess
        ));
    }
    if let Some(Clearcoat { strength, roughness }) = material.clearcoat {
        parts.push(format!("clear coat {strength:.2} roughness {roughness:.2}"));
    }
    if let Some(sheen) = material.sheen {
        parts.push(format!("sheen {} roughness {:.2}", color(sheen.color), sheen.roughness));
    }
    if material.dispersion > 0.0 {
        parts.push(format!("dispersion {:.2}", material.dispersion));
    }
    if parts.is_empty() { "black".to_owned() } else { parts.join(", ") }
}

fn as_json(
    Loaded { scene, time, .. }: &Loaded,
    kind: StructureKind,
    stats: &StructureStats,
    level: Option<SimdLevel>,
) -> Value {
    let bounds = scene.bounds();
    json!({
        "scene": scene.name,
        "load_seconds": time.as_secs_f64(),
        "triangles": scene.mesh.triangles.len(),
        "visible_triangles": scene.visible_triangles(),
        "objects": scene.instances.objects().len(),
        "instances": scene.instances.placed().len(),
        "vertices": scene.mesh.triangles.positions().len(),
        "spheres": scene.spheres.len(),
        "bounds": if bounds.is_empty() { Value::Null } else {
            json!({ "min": bounds.min.to_array(), "max": bounds.max.to_array() })
        },
        "materials": materials(scene),
        "lights": scene.lights.iter().map(|light| json!({
            "name": light.name, "kind": light_kind(&light.kind), "intensity": light.intensity.to_array(),
        })).collect::<Vec<_>>(),
        "cameras": scene.cameras.iter().map(|camera| json!({
            "name": camera.name, "eye": camera.eye.to_array(), "target": camera.target.to_array(),
            "up": camera.up.to_array(), "fov_y_degrees": camera.fov_y,
        })).collect::<Vec<_>>(),
        "warnings": scene.warnings,
        "structure": exporters::structure(kind, stats),
        "simd": level.map(SimdLevel::name),
    })
}

fn materials(scene: &Scene) -> Vec<Value> {
    let one = |m: &Material| {
        json!({
            "name": m.name, "diffuse": m.diffuse.to_array(), "mirror": m.mirror.to_array(),
            "transmission": m.transmission.to_array(), "ior": m.ior, "absorption": m.absorption.to_array(),
            "specular": m.specular.to_array(), "shininess": m.shininess, "emission": m.emission.to_array(),
            "clearcoat": m.clearcoat.map(|coat| json!({ "strength": coat.strength, "roughness": coat.roughness })),
            "sheen": m.sheen.map(|sheen| json!({ "color": sheen.color.to_array(), "roughness": sheen.roughness })),
            "dispersion": m.dispersion,
        })
    };
    scene.materials.iter().map(one).collect()
}
