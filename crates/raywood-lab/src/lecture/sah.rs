//! Trees by the surface area heuristic against trees by midpoint splits.

use raywood::{BuildOptions, Structure, StructureKind};
use raywood_render::PreparedScene;

use super::fit::{geometric_mean, range};
use super::measure::{Work, nanoseconds, spread_text, time};
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict};
use crate::figures::{Axis, BarChart, BarSeries, Cell, Chart, Table};

pub(super) const ENTRY: Entry = Entry {
    id: "sah",
    title: "What the surface area heuristic gains",
    claim: "A tree built by the surface area heuristic is about twice as efficient as one split at midpoints.",
    measure,
};

const BUILDERS: [StructureKind; 2] = [StructureKind::BvhMidpoint, StructureKind::BvhSahBinned];

/// Gains from here on count as about twice: as ratios they are nearer to 2 than to 1.
const ABOUT_TWICE: f64 = std::f64::consts::SQRT_2;
/// Gains from here on count at all.
const SOME: f64 = 1.1;

/// A tree on a scene.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    q: f64,
    nodes: f64,
    primitives: f64,
    nanoseconds: f64,
}

/// Both trees on a scene.
#[derive(Clone, Debug)]
struct Row {
    scene: String,
    midpoint: Cost,
    sah: Cost,
}

impl Row {
    fn gain(&self, of: impl Fn(&Cost) -> f64) -> f64 {
        of(&self.midpoint) / of(&self.sah)
    }

    fn gains(&self) -> [f64; 3] {
        [self.gain(|c| c.q), self.gain(|c| c.nodes + c.primitives), self.gain(|c| c.nanoseconds)]
    }
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let mut rows = Vec::new();
    let mut timings = Vec::new();
    for subject in lab.subjects() {
        let rays = subject.mixed_rays(lab.pick(1024, 16_384))?;
        let surfaces = PreparedScene::surfaces(subject.scene);
        let build = |kind| Structure::build(kind, &surfaces, &BuildOptions::default());
        let structures = [build(BUILDERS[0])?, build(BUILDERS[1])?];
        let contestants = [(&structures[0], rays.as_slice()), (&structures[1], rays.as_slice())];
        let measured = time(&contestants, lab.rounds());
        let cost = |i: usize| {
            let work = Work::of(&structures[i], &rays);
            Cost {
                q: structures[i].stats().q,
                nodes: work.nodes(),
                primitives: work.primitives(),
                nanoseconds: nanoseconds(&measured[i], rays.len()),
            }
        };
        rows.push(Row { scene: subject.name().to_owned(), midpoint: cost(0), sah: cost(1) });
        timings.extend(measured);
    }

    let columns = ["scene", "builder", "Q", "nodes per ray", "primitives per ray", "ns per ray"];
    let mut table = Table::new("Both trees on each scene", &columns);
    for row in &rows {
        for (kind, cost) in BUILDERS.iter().zip([row.midpoint, row.sah]) {
            table.rows.push(vec![
                Cell::text(&row.scene),
                Cell::text(kind.name()),
                Cell::Number(cost.q, 1),
                Cell::Number(cost.nodes, 1),
                Cell::Number(cost.primitives, 1),
                Cell::Number(cost.nanoseconds, 0),
            ]);
        }
    }
    let method = format!(
        "Each scene gets both trees, and both the same primary, shadow, reflection and diffuse rays on one thread, in turn: medians of {} rounds, {}. \
         Q is the expected cost of a ray that passes through the scene, sum over nodes of P(node) (C_aabb + N_tri C_tri).",
        lab.rounds(),
        spread_text(&timings)
    );
    let verdict = judge(&rows);
    Ok(Findings { method, tables: vec![table], charts: vec![chart(&rows)], verdict })
}

fn chart(rows: &[Row]) -> Chart {
    let names = ["by Q", "by nodes and primitives per ray", "by time"];
    let series = |(i, name): (usize, &&str)| BarSeries {
        name: (*name).to_owned(),
        values: rows.iter().map(|row| Some(row.gains()[i])).collect(),
    };
    Chart::Bars(BarChart {
        title: "How many times better the surface area heuristic is than midpoint splits"
            .to_owned(),
        value: Axis::linear("midpoint / surface area heuristic"),
        decimals: 2,
        categories: rows.iter().map(|row| row.scene.clone()).collect(),
        series: names.iter().enumerate().map(series).collect(),
    })
}

fn judge(rows: &[Row]) -> Verdict {
    let gains = |i: usize| rows.iter().map(|row| row.gains()[i]).collect::<Vec<_>>();
    let (q, steps, times) = (gains(0), gains(1), gains(2));
    let means = [&q, &steps, &times].map(|gains| geometric_mean(gains));
    if means.iter().any(|mean| !mean.is_finite()) {
        let explanation = "The rays meet no node.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    }
    let [q, steps, times] = [q, steps, times].map(|gains| range(&gains));
    let judgement = match means[1].min(means[2]) {
        gain if gain >= ABOUT_TWICE => Judgement::Holds,
        gain if gain >= SOME => Judgement::HoldsInPart,
        _ => Judgement::Fails,
    };
    let explanation = format!(
        "Over {} the tree by the surface area heuristic does {:.2} times as well in steps per ray ({:.2} to {:.2}), {:.2} times in time ({:.2} to \
         {:.2}) and {:.2} times in Q ({:.2} to {:.2}), as geometric means. From {ABOUT_TWICE:.2} on, nearer to 2 than to 1, this counts as about twice.",
        if rows.len() == 1 { "one scene".to_owned() } else { format!("{} scenes", rows.len()) },
        means[1],
        steps.0,
        steps.1,
        means[2],
        times.0,
        times.1,
        means[0],
        q.0,
        q.1
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::default_scenes;

    fn made_up(gain: f64) -> Row {
        let sah = Cost { q: 10.0, nodes: 10.0, primitives: 5.0, nanoseconds: 100.0 };
        let midpoint = Cost {
            q: 10.0 * gain,
            nodes: 10.0 * gain,
            primitives: 5.0 * gain,
            nanoseconds: 100.0 * gain,
        };
        Row { scene: "scene".to_owned(), midpoint, sah }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let judgement = |gains: &[f64]| {
            judge(&gains.iter().map(|gain| made_up(*gain)).collect::<Vec<_>>()).judgement
        };
        assert_eq!(judgement(&[2.0, 1.8]), Judgement::Holds);
        assert_eq!(judgement(&[1.2, 1.4]), Judgement::HoldsInPart);
        assert_eq!(judgement(&[1.0, 0.8]), Judgement::Fails);
        assert_eq!(judgement(&[]), Judgement::NotMeasured);
    }

    #[test]
    fn the_heuristic_saves_steps() {
        let scenes = default_scenes(true);
        let lab = Lab::new(&scenes, true, 1).expect("scenes");
        let findings = measure(&lab).expect("findings");
        let Chart::Bars(bars) = &findings.charts[0] else { panic!("bars") };
        let steps: Vec<_> = bars.series[1].values.iter().map(|v| v.expect("a gain")).collect();
        assert!(geometric_mean(&steps) > 1.0, "{steps:?}");
    }
}
