//! How much rays that travel in packets share.

use raywood::{BuildOptions, Bvh2};
use raywood_render::PreparedScene;

use super::fit::range;
use super::lab::{PACKET, Subject};
use super::packet_walk::{PacketCounts, walk};
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict};
use crate::figures::{Axis, BarChart, BarSeries, Cell, Chart, Table};
use crate::ray_sets::RayKind;

pub(super) const ENTRY: Entry = Entry {
    id: "coherence",
    title: "What packets of rays share",
    claim: "Rays that travel together through the tree share its nodes: packets can be up to 32 times faster for primary rays, and gain less \
            the less coherent the rays are.",
    measure,
};

/// The gain that is claimed.
const CLAIMED: f64 = 32.0;
/// What still counts as a great gain.
const GREAT: f64 = 8.0;

/// Packets of one kind on one scene.
#[derive(Clone, Debug)]
struct Row {
    scene: String,
    kind: RayKind,
    counts: PacketCounts,
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let mut rows = Vec::new();
    for subject in lab.subjects() {
        rows.extend(packets(subject)?);
    }
    let columns =
        ["scene", "rays", "packets", "nodes per packet", "rays per visited node", "coherence"];
    let mut table = Table::new("Packets of 64 rays in the binary tree", &columns);
    table.rows = rows.iter().map(cells).collect();
    let method = format!(
        "The {PACKET} rays of 8 x 8 neighbouring pixels of a picture of {} pixels, and those that follow from what they hit, walk through the \
         binary tree together; a node is visited if at least one of them hits its box before its closest hit so far. Coherence is the number of \
         rays in the packet over the average number that hit a visited node: 1 is perfect, {PACKET} means that they share nothing. The rays per \
         visited node bound what packets can save. There is no fast kernel for packets yet, so this is counted, not timed: how near a \
         kernel comes to the bound is still to be measured.",
        lab.pick("320 x 200", "1280 x 800")
    );
    let verdict = judge(&rows);
    Ok(Findings { method, tables: vec![table], charts: vec![chart(&rows)], verdict })
}

/// Every kind of ray of a scene in packets; no row for a kind of which there are none.
fn packets(subject: &Subject<'_>) -> Result<Vec<Row>, LectureError> {
    let prepared = subject.prepared()?;
    let surfaces = PreparedScene::surfaces(subject.scene);
    let tree = Bvh2::build(&surfaces, &BuildOptions::default())?;
    let mut rows = Vec::new();
    for &kind in RayKind::ALL {
        let mut counts = PacketCounts::default();
        for packet in prepared.rays(kind).chunks(PACKET) {
            walk(&tree, &surfaces, packet, kind.any_hit(), &mut counts);
        }
        if counts.nodes > 0 {
            rows.push(Row { scene: subject.name().to_owned(), kind, counts });
        }
    }
    Ok(rows)
}

fn cells(Row { scene, kind, counts }: &Row) -> Vec<Cell> {
    vec![
        Cell::text(scene),
        Cell::text(kind.name()),
        Cell::Count(counts.packets),
        Cell::Number(counts.nodes as f64 / counts.packets as f64, 0),
        Cell::Number(counts.rays_per_node(), 1),
        Cell::Number(counts.coherence(), 1),
    ]
}

fn chart(rows: &[Row]) -> Chart {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let value = |scene: &str, kind: RayKind| {
        let row = rows.iter().find(|row| row.scene == scene && row.kind == kind);
        row.map(|row| row.counts.rays_per_node())
    };
    let series = |&kind: &RayKind| BarSeries {
        name: format!("{} rays", kind.name()),
        values: scenes.iter().map(|scene| value(scene, kind)).collect(),
    };
    Chart::Bars(BarChart {
        title: "Rays of a packet of 64 that hit a visited node: the most that packets can save"
            .to_owned(),
        value: Axis::linear("rays per visited node"),
        decimals: 1,
        categories: scenes.iter().map(|scene| (*scene).to_owned()).collect(),
        series: RayKind::ALL.iter().map(series).collect(),
    })
}

fn judge(rows: &[Row]) -> Verdict {
    let of_kind = |kind: RayKind| {
        let rows = rows.iter().filter(move |row| row.kind == kind);
        rows.map(|row| row.counts.rays_per_node()).collect::<Vec<_>>()
    };
    let (primary, diffuse) = (of_kind(RayKind::Primary), of_kind(RayKind::Diffuse));
    if primary.is_empty() {
        let explanation = "No primary ray meets the scene.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    }
    let (primary, diffuse) = (range(&primary), range(&diffuse));
    // In each scene, diffuse rays must be the less coherent ones; where there are none there is nothing to hold primary rays against.
    let coherence = |scene: &str, kind: RayKind| {
        let row = rows.iter().find(|row| row.scene == scene && row.kind == kind);
        row.map(|row| row.counts.rays_per_node())
    };
    let falls = rows.iter().filter(|row| row.kind == RayKind::Primary).all(|row| {
        coherence(&row.scene, RayKind::Diffuse).is_some_and(|d| d < row.counts.rays_per_node())
    });
    let judgement = match primary.1 {
        most if most >= CLAIMED && falls => Judgement::Holds,
        most if most >= GREAT => Judgement::HoldsInPart,
        _ => Judgement::Fails,
    };
    let of_diffuse = match diffuse.1.is_finite() {
        true => format!(", of diffuse rays {:.1} to {:.1}", diffuse.0, diffuse.1),
        false => String::new(),
    };
    let explanation = format!(
        "Of a packet's 64 primary rays {:.1} to {:.1} hit a visited node{of_diffuse}. So packets can save at most a factor of {:.0} of the visits \
         of primary rays, where {CLAIMED:.0} is claimed. This judges the bound; the time is not measured yet.",
        primary.0, primary.1, primary.1
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::default_scenes;

    fn made_up(kind: RayKind, hits: u64) -> Row {
        let counts = PacketCounts { packets: 1, rays: 64, nodes: 10, hits: 10 * hits };
        Row { scene: "scene".to_owned(), kind, counts }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let judgement = |primary: u64, diffuse: u64| {
            judge(&[made_up(RayKind::Primary, primary), made_up(RayKind::Diffuse, diffuse)])
                .judgement
        };
        assert_eq!(judgement(40, 5), Judgement::Holds);
        assert_eq!(judgement(40, 50), Judgement::HoldsInPart);
        assert_eq!(judgement(20, 5), Judgement::HoldsInPart);
        assert_eq!(judgement(4, 2), Judgement::Fails);
        assert_eq!(judge(&[made_up(RayKind::Primary, 40)]).judgement, Judgement::HoldsInPart);
        assert_eq!(judge(&[]).judgement, Judgement::NotMeasured);
    }

    #[test]
    fn primary_rays_share_more_than_diffuse_ones() {
        let scenes = default_scenes(true);
        let lab = Lab::new(&scenes, true, 1).expect("scenes");
        for subject in lab.subjects() {
            let rows = packets(subject).expect("packets");
            for row in &rows {
                let coherence = row.counts.coherence();
                assert!((1.0..=64.0).contains(&coherence), "{row:?}");
            }
            let shared = |kind| {
                let row = rows.iter().find(|row| row.kind == kind);
                row.map_or(0.0, |row| row.counts.rays_per_node())
            };
            assert!(shared(RayKind::Primary) > shared(RayKind::Diffuse), "{}", subject.name());
        }
    }
}
