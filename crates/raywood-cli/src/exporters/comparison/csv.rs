//! Comma-separated values: one line per structure and kind of rays. Names of structures and kinds need no quotes, and all else is numbers.

use super::Compared;

const HEADER: &str = "structure,build_seconds,build_spread,bytes,nodes,leaves,empty_leaves,depth,\
                      references,primitives,q,ray_kind,rays,million_rays_per_second,spread,\
                      nodes_per_ray,boxes_per_ray,primitives_per_ray\n";

pub(super) fn write(Compared { comparison, .. }: &Compared<'_>) -> String {
    let mut text = HEADER.to_owned();
    for structure in &comparison.structures {
        let (build, stats) = (&structure.build, &structure.stats);
        for traces in &structure.traces {
            let counts = &traces.counts;
            let per_ray = |count: u64| traces.per_ray(count).to_string();
            let fields = [
                structure.kind.name().to_owned(),
                build.median().to_string(),
                build.spread().to_string(),
                stats.bytes.to_string(),
                stats.nodes.to_string(),
                stats.leaves.to_string(),
                stats.empty_leaves.to_string(),
                stats.depth.to_string(),
                stats.references.to_string(),
                stats.primitives.to_string(),
                stats.q.to_string(),
                traces.kind.name().to_owned(),
                traces.rays.to_string(),
                traces.million_rays_per_second().to_string(),
                traces.timing.spread().to_string(),
                per_ray(counts.nodes),
                per_ray(counts.boxes),
                per_ray(counts.primitives),
            ];
            text += &fields.join(",");
            text += "\n";
        }
    }
    text
}
