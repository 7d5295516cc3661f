//! How much rays that travel in packets share, and how much faster that makes them.

mod race;

use super::fit::range;
use super::lab::Subject;
use super::measure::spread_text;
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict, shapes};
use crate::figures::{Axis, BarChart, BarSeries, Cell, Chart, Table};
use crate::ray_sets::RayKind;
use race::{EDGES, Race, races};

pub(super) const ENTRY: Entry = Entry {
    id: "coherence",
    title: "What packets of rays share and gain",
    claim: "Rays that travel together through the tree share its nodes: packets can be up to 32 times faster for primary rays, and gain less \
            the less coherent the rays are.",
    measure,
};

/// The gain that is claimed.
const CLAIMED: f64 = 32.0;
/// What is a gain, and not an accident of the clock.
const GAIN: f64 = 1.1;

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let coarse = shapes::coarse_terrain();
    let simplest = Subject::new(&coarse, lab.is_quick())?;
    let mut all = Vec::new();
    for subject in lab.subjects() {
        all.extend(races(subject, lab.is_quick(), lab.rounds())?);
    }
    all.extend(races(&simplest, lab.is_quick(), lab.rounds())?);
    let method = format!(
        "Rays of {} pixels of a picture of {}, in blocks of 16 x 16 spread evenly over it, and those that follow from what they hit, 256 shadow \
         rays in a row towards one light. All are traced through one binary tree, one by one and in packets of 4 x 4, 8 x 8 and 16 x 16, by plain \
         code: no vector instructions on either side. A packet visits a node if at least one of its rays hits the box before its closest hit so \
         far. Coherence is the number of rays in the packet over the average number that hit a visited node: 1 is perfect, as many as there are \
         rays means that they share nothing. The rays per visited node bound what packets can save of the visits, but not of the tests of \
         triangles, which every ray has to itself. Besides the scenes asked for there is a coarse terrain, where a triangle covers thousands of \
         pixels: the simplest case for packets. One thread, medians of {} rounds taken in turn; {}.",
        lab.pick("2,048", "32,768"),
        lab.pick("320 x 200", "1280 x 800"),
        lab.rounds(),
        spread_text(all.iter().flat_map(|race| &race.timings))
    );
    let tables = vec![coherence_table(&all), nodes_table(&all), times_table(&all)];
    let shared = bars(
        &all,
        "Rays of a packet of 8 x 8 that hit a visited node: the most that visits can be saved",
        "rays per visited node",
        |race| race.packets[1].coherence.rays_per_node(),
    );
    let gained = bars(
        &all,
        "How many times faster than single rays the fastest packets are",
        "times faster",
        Race::best_speed_up,
    );
    let verdict = judge(&all);
    Ok(Findings { method, tables, charts: vec![shared, gained], verdict })
}

/// A table with a row for each race.
fn table(
    caption: &str,
    columns: &[&str],
    races: &[Race],
    cells: impl Fn(&Race) -> Vec<Cell>,
) -> Table {
    let mut table = Table::new(caption, &[&["scene", "rays"], columns].concat());
    let row = |race: &Race| {
        [vec![Cell::text(&race.scene), Cell::text(race.kind.name())], cells(race)].concat()
    };
    table.rows = races.iter().map(row).collect();
    table
}

fn coherence_table(races: &[Race]) -> Table {
    let columns =
        ["coherence 4 x 4", "8 x 8", "16 x 16", "rays per visited node 4 x 4", "8 x 8", "16 x 16"];
    table("What packets share", &columns, races, |race| {
        let coherence = race.packets.map(|p| Cell::Number(p.coherence.coherence(), 1));
        let shared = race.packets.map(|p| Cell::Number(p.coherence.rays_per_node(), 1));
        [coherence, shared].concat()
    })
}

fn nodes_table(races: &[Race]) -> Table {
    let columns = ["one by one", "4 x 4", "8 x 8", "16 x 16"];
    table("Nodes visited per ray", &columns, races, |race| {
        let packets = race.packets.map(|p| Cell::significant(p.cost.nodes));
        [vec![Cell::significant(race.single.nodes)], packets.to_vec()].concat()
    })
}

fn times_table(races: &[Race]) -> Table {
    let columns = [
        "ns per ray one by one",
        "4 x 4",
        "8 x 8",
        "16 x 16",
        "times faster 4 x 4",
        "8 x 8",
        "16 x 16",
    ];
    table("Time per ray", &columns, races, |race| {
        let single = vec![Cell::Number(race.single.nanoseconds, 0)];
        let times = race.packets.map(|p| Cell::Number(p.cost.nanoseconds, 0)).to_vec();
        let gains = race.packets.map(|p| Cell::Number(race.speed_up(&p), 2)).to_vec();
        [single, times, gains].concat()
    })
}

/// The race of a kind of ray on a scene, if there was one.
fn find<'a>(races: &'a [Race], scene: &str, kind: RayKind) -> Option<&'a Race> {
    races.iter().find(|race| race.scene == scene && race.kind == kind)
}

/// A value of every race as bars, by scene and kind.
fn bars(races: &[Race], title: &str, label: &str, value: impl Fn(&Race) -> f64) -> Chart {
    let mut scenes: Vec<&str> = races.iter().map(|race| race.scene.as_str()).collect();
    scenes.dedup();
    let series = |&kind: &RayKind| BarSeries {
        name: format!("{} rays", kind.name()),
        values: scenes.iter().map(|scene| find(races, scene, kind).map(&value)).collect(),
    };
    Chart::Bars(BarChart {
        title: title.to_owned(),
        value: Axis::linear(label),
        decimals: 1,
        categories: scenes.iter().map(|scene| (*scene).to_owned()).collect(),
        series: RayKind::ALL.iter().map(series).collect(),
    })
}

/// The claim has two parts: the gain of primary rays, and that less coherent rays gain less. Wrong answers are worth nothing, however fast.
fn judge(races: &[Race]) -> Verdict {
    let of_kind = |kind: RayKind, value: fn(&Race) -> f64| {
        let races = races.iter().filter(|race| race.kind == kind);
        range(&races.map(value).collect::<Vec<_>>())
    };
    let gain = |kind| of_kind(kind, Race::best_speed_up);
    let shared = |kind| of_kind(kind, |race| race.packets[1].coherence.rays_per_node());
    let (primary, diffuse) = (gain(RayKind::Primary), gain(RayKind::Diffuse));
    if !primary.1.is_finite() {
        let explanation = "No primary ray meets the scene.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    }

    // In each scene, diffuse rays must gain less; where there are none there is nothing to hold primary rays against.
    let falls = races.iter().filter(|race| race.kind == RayKind::Primary).all(|race| {
        let diffuse = find(races, &race.scene, RayKind::Diffuse);
        diffuse.is_some_and(|diffuse| diffuse.best_speed_up() < race.best_speed_up())
    });
    let wrong: usize = races.iter().map(|race| race.wrong).sum();
    let judgement = match primary.1 {
        most if wrong > 0 || most < GAIN => Judgement::Fails,
        most => Judgement::by_conditions(&[most >= CLAIMED, falls]),
    };

    let answers: usize = races.iter().map(|race| EDGES.len() * race.rays).sum();
    let agreement = match wrong {
        0 => format!("All {answers} answers are those of single rays, to the bit."),
        _ => format!("{wrong} of {answers} answers differ from those of single rays!"),
    };
    let of_diffuse = match diffuse.1.is_finite() {
        true => format!(
            ", {:.1} to {:.1} of the diffuse ones, which packets make {:.2} to {:.2} times as fast",
            shared(RayKind::Diffuse).0,
            shared(RayKind::Diffuse).1,
            diffuse.0,
            diffuse.1
        ),
        false => String::new(),
    };
    let explanation = format!(
        "The fastest packets trace primary rays {:.2} to {:.2} times as fast as single rays on the same tree, where up to {CLAIMED:.0} is claimed: of 64 \
         rays {:.1} to {:.1} hit a visited node{of_diffuse}. Visits are shared, but not tests of triangles, and nothing here uses vector \
         instructions. {agreement}",
        primary.0,
        primary.1,
        shared(RayKind::Primary).0,
        shared(RayKind::Primary).1,
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::race::{Cost, Packets};
    use super::*;
    use raywood::Coherence;

    fn made_up(kind: RayKind, speed_up: f64, wrong: usize) -> Race {
        let coherence = Coherence { nodes: 10, rays: 640, hitting: 100 };
        let cost = |nanoseconds| Cost { nodes: 1.0, nanoseconds };
        let packets =
            [1.0, speed_up, 0.5].map(|gain| Packets { coherence, cost: cost(100.0 / gain) });
        let scene = "scene".to_owned();
        Race { scene, kind, rays: 256, single: cost(100.0), packets, wrong, timings: Vec::new() }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let judgement = |primary: f64, diffuse: f64, wrong: usize| {
            judge(&[
                made_up(RayKind::Primary, primary, wrong),
                made_up(RayKind::Diffuse, diffuse, 0),
            ])
            .judgement
        };
        assert_eq!(judgement(40.0, 5.0, 0), Judgement::Holds);
        assert_eq!(judgement(40.0, 50.0, 0), Judgement::HoldsInPart);
        assert_eq!(judgement(2.0, 1.0, 0), Judgement::HoldsInPart);
        assert_eq!(judgement(2.0, 3.0, 0), Judgement::Fails);
        assert_eq!(judgement(1.0, 0.5, 0), Judgement::Fails);
        assert_eq!(judgement(40.0, 5.0, 1), Judgement::Fails);
        assert_eq!(judge(&[made_up(RayKind::Primary, 40.0, 0)]).judgement, Judgement::HoldsInPart);
        assert_eq!(judge(&[]).judgement, Judgement::NotMeasured);
    }

    #[test]
    fn every_kind_of_ray_has_its_rows() {
        let scenes = crate::lecture::default_scenes(true);
        let lab = Lab::new(&scenes, true, 1).expect("scenes");
        let findings = measure(&lab).expect("findings");
        for table in &findings.tables {
            assert_eq!(table.rows.len(), (scenes.len() + 1) * RayKind::ALL.len());
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()));
        }
    }
}
