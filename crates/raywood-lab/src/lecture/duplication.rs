//! Structures that divide space mention primitives several times; a mailbox keeps rays from testing them as often.

use raywood::{BuildOptions, Structure, StructureKind};
use raywood_render::PreparedScene;

use super::fit::range;
use super::measure::Work;
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict};
use crate::figures::{Axis, BarChart, BarSeries, Cell, Chart, Table};

pub(super) const ENTRY: Entry = Entry {
    id: "duplication",
    title: "Primitives met more than once",
    claim: "Structures that divide space mention a primitive in every cell that it touches, so a ray would test it several times if it did not \
            remember what it has tested (mailboxing). A BVH mentions each primitive once.",
    measure,
};

const DIVIDING: &[StructureKind] = &[
    StructureKind::UniformGrid,
    StructureKind::NestedGrid,
    StructureKind::Octree,
    StructureKind::KdTree,
];
const ONCE: StructureKind = StructureKind::BvhSahBinned;

/// The share of tests that a mailbox must save to be worth its while.
const WORTH: f64 = 0.1;

/// A structure on a scene.
#[derive(Clone, Debug)]
struct Row {
    scene: String,
    kind: StructureKind,
    /// References per primitive.
    duplication: f64,
    /// References that a ray meets: the tests without a mailbox.
    met: f64,
    /// Tests that a ray makes.
    tested: f64,
}

impl Row {
    fn saved(&self) -> f64 {
        1.0 - self.tested / self.met
    }

    fn divides(&self) -> bool {
        self.kind != ONCE
    }
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let mut rows = Vec::new();
    for subject in lab.subjects() {
        let rays = subject.mixed_rays(lab.pick(1024, 2048))?;
        for &kind in DIVIDING.iter().chain([&ONCE]) {
            let surfaces = PreparedScene::surfaces(subject.scene);
            let structure = Structure::build(kind, &surfaces, &BuildOptions::default())?;
            let work = Work::of(&structure, &rays);
            // Where space is not divided there are no references to tell of but the tests.
            let met = if kind == ONCE { work.primitives() } else { work.references() };
            rows.push(Row {
                scene: subject.name().to_owned(),
                kind,
                duplication: structure.stats().duplication(),
                met,
                tested: work.primitives(),
            });
        }
    }
    let columns = [
        "scene",
        "structure",
        "references per primitive",
        "met per ray",
        "tested per ray",
        "saved",
    ];
    let mut table = Table::new("References, and what the mailbox saves", &columns);
    table.rows = rows.iter().map(cells).collect();
    let verdict = judge(&rows);
    let method = "Every scene is put into each structure. Primary, shadow, reflection and diffuse rays are followed, and counted are the references \
                  in the cells that they enter, which without a mailbox would all be tested, and the tests that are made with the mailbox of 32 \
                  primitives that each ray has. Nothing is timed."
        .to_owned();
    Ok(Findings { method, tables: vec![table], charts: vec![chart(&rows)], verdict })
}

fn cells(row: &Row) -> Vec<Cell> {
    vec![
        Cell::text(&row.scene),
        Cell::text(row.kind.name()),
        Cell::Number(row.duplication, 2),
        Cell::Number(row.met, 1),
        Cell::Number(row.tested, 1),
        if row.divides() { Cell::Share(row.saved()) } else { Cell::Nothing },
    ]
}

fn chart(rows: &[Row]) -> Chart {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let kinds = || DIVIDING.iter().chain([&ONCE]);
    let value = |scene: &str, kind: StructureKind| {
        rows.iter().find(|row| row.scene == scene && row.kind == kind).map(|row| row.duplication)
    };
    let series = |scene: &&str| BarSeries {
        name: (*scene).to_owned(),
        values: kinds().map(|&kind| value(scene, kind)).collect(),
    };
    Chart::Bars(BarChart {
        title: "References per primitive".to_owned(),
        value: Axis::linear("references per primitive"),
        decimals: 2,
        categories: kinds().map(|kind| kind.name().to_owned()).collect(),
        series: scenes.iter().map(series).collect(),
    })
}

fn judge(rows: &[Row]) -> Verdict {
    let (dividing, once): (Vec<_>, Vec<_>) = rows.iter().partition(|row| row.divides());
    // Rays that meet nothing have nothing to save.
    let saved: Vec<_> = dividing.iter().map(|row| row.saved()).filter(|s| s.is_finite()).collect();
    if saved.is_empty() {
        let explanation = "The rays meet no primitive.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    }
    let duplication = range(&dividing.iter().map(|row| row.duplication).collect::<Vec<_>>());
    let mentioned_once = once.iter().all(|row| row.duplication == 1.0);
    let worth = saved.iter().filter(|saved| **saved >= WORTH).count();
    let judgement = match (mentioned_once && duplication.0 > 1.0, worth) {
        (true, worth) if worth == saved.len() => Judgement::Holds,
        (_, 0) => Judgement::Fails,
        _ => Judgement::HoldsInPart,
    };
    let (low, high) = range(&saved);
    let explanation = format!(
        "There are {:.2} to {:.2} references per primitive where space is divided, and {} in the BVH. The mailbox saves {:.0} to {:.0} % of the \
         tests, at least {:.0} % in {worth} of {} cases.",
        duplication.0,
        duplication.1,
        if mentioned_once { "exactly one" } else { "not always one" },
        100.0 * low,
        100.0 * high,
        100.0 * WORTH,
        saved.len()
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::default_scenes;

    fn made_up(kind: StructureKind, duplication: f64, met: f64, tested: f64) -> Row {
        Row { scene: "scene".to_owned(), kind, duplication, met, tested }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let tree = made_up(ONCE, 1.0, 5.0, 5.0);
        let grid =
            |duplication, tested| made_up(StructureKind::UniformGrid, duplication, 10.0, tested);
        let judgement = |rows: &[Row]| judge(rows).judgement;
        assert_eq!(judgement(&[tree.clone(), grid(2.0, 5.0)]), Judgement::Holds);
        assert_eq!(
            judgement(&[tree.clone(), grid(2.0, 5.0), grid(2.0, 9.9)]),
            Judgement::HoldsInPart
        );
        assert_eq!(judgement(&[tree.clone(), grid(1.0, 5.0)]), Judgement::HoldsInPart);
        assert_eq!(judgement(&[tree.clone(), grid(2.0, 10.0)]), Judgement::Fails);
        assert_eq!(judgement(&[tree]), Judgement::NotMeasured);
    }

    #[test]
    fn references_are_never_fewer_than_primitives_or_tests() {
        let scenes = default_scenes(true);
        let lab = Lab::new(&scenes, true, 1).expect("scenes");
        let findings = measure(&lab).expect("findings");
        assert_eq!(findings.tables[0].rows.len(), scenes.len() * (DIVIDING.len() + 1));
        for row in &findings.tables[0].rows {
            let [
                _,
                _,
                Cell::Number(duplication, _),
                Cell::Number(met, _),
                Cell::Number(tested, _),
                _,
            ] = row[..]
            else {
                panic!("{row:?}")
            };
            assert!(duplication >= 1.0 && met >= tested && tested > 0.0, "{row:?}");
        }
        assert_ne!(findings.verdict.judgement, Judgement::Fails);
    }
}
