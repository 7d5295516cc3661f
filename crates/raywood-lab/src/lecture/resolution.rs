//! The resolution of a uniform grid: which is right depends on the scene, and for some scenes none is.

use raywood::{BuildOptions, Structure, StructureKind};
use raywood_render::PreparedScene;

use super::fit::range;
use super::lab::Subject;
use super::measure::{affordable, nanoseconds, spread_text, time};
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict, shapes};
use crate::figures::{Axis, BarChart, BarSeries, Cell, Chart, Plot, Series, Table};
use crate::timing::Timing;

pub(super) const ENTRY: Entry = Entry {
    id: "resolution",
    title: "No resolution of a grid is right",
    claim: "What resolution of a uniform grid is best depends on the scene; where much detail sits in a small part of a large space, as a teapot \
            in a stadium, none is good. Structures that divide crowded places further cope.",
    measure,
};

/// Cells per primitive that are tried.
const DENSITIES: &[f64] = &[0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Structures that divide crowded places further.
const ADAPTIVE: &[StructureKind] = &[
    StructureKind::NestedGrid,
    StructureKind::Octree,
    StructureKind::KdTree,
    StructureKind::BvhSahBinned,
];

/// By which factor rays must be slower at another scene's best density than at that of their own to count as different.
const MISFIT: f64 = 1.25;
/// By which factor the best grid must be slower than the fastest structure that adapts to count as bad.
const LOSS: f64 = 2.0;

/// Times on one scene.
#[derive(Clone, Debug)]
struct Measured {
    scene: String,
    /// Cells per primitive, nanoseconds per ray.
    grid: Vec<[f64; 2]>,
    /// The structures of `ADAPTIVE`, nanoseconds per ray.
    adaptive: Vec<f64>,
}

impl Measured {
    /// The density with the least time, and that time.
    fn best(&self) -> Option<[f64; 2]> {
        self.grid.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1]))
    }

    /// The time at another density than the best, relative to the best.
    fn loss_at(&self, density: f64) -> f64 {
        let time = self.grid.iter().find(|[d, _]| *d == density).map_or(f64::NAN, |[_, t]| *t);
        self.best().map_or(f64::NAN, |[_, best]| time / best)
    }

    /// The slowest of the adaptive structures.
    fn slowest_adaptive(&self) -> f64 {
        range(&self.adaptive).1
    }

    fn fastest_adaptive(&self) -> f64 {
        range(&self.adaptive).0
    }
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let count = lab.pick(2_000, 30_000);
    let mut timings = Vec::new();
    let mut results = Vec::new();
    for scene in [shapes::soup(count), shapes::room(count), shapes::stadium(count)] {
        let subject = Subject::new(&scene, lab.is_quick())?;
        let rays = subject.mixed_rays(lab.pick(512, 4096))?;
        let surfaces = PreparedScene::surfaces(&scene);
        let mut structures = Vec::new();
        for &density in DENSITIES {
            let grid_density = density as f32;
            let options = BuildOptions { grid_density, ..BuildOptions::default() };
            structures.push(Structure::build(StructureKind::UniformGrid, &surfaces, &options)?);
        }
        for &kind in ADAPTIVE {
            structures.push(Structure::build(kind, &surfaces, &BuildOptions::default())?);
        }
        // A cell with a whole teapot in it is as slow as brute force.
        let affordable = structures.iter().map(|s| affordable(s, &rays, lab.pick(1e5, 1e6)));
        let affordable: Vec<_> = affordable.collect();
        let contestants: Vec<_> =
            structures.iter().zip(&affordable).map(|(s, rays)| (s, rays.as_slice())).collect();
        let measured = time(&contestants, rounds(lab));
        let per_ray = measured.iter().zip(&affordable);
        let times: Vec<_> = per_ray.map(|(t, rays)| nanoseconds(t, rays.len())).collect();
        timings.extend(measured);
        let (grid, adaptive) = times.split_at(DENSITIES.len());
        results.push(Measured {
            scene: scene.name,
            grid: DENSITIES.iter().zip(grid).map(|(&d, &time)| [d, time]).collect(),
            adaptive: adaptive.to_vec(),
        });
    }
    Ok(findings(lab, count, &results, &timings))
}

/// How often times are taken.
fn rounds(lab: &Lab<'_>) -> usize {
    lab.pick(3, 9)
}

fn findings(lab: &Lab<'_>, count: usize, results: &[Measured], timings: &[Timing]) -> Findings {
    let method = format!(
        "Three scenes of about {count} triangles: a soup that fills its cube evenly, and a teapot of that many triangles, 19 cm high, seen from half \
         a metre away in a bowl 6 m across and in one of 95 m. Uniform grids of {} to {} cells per triangle and four structures that adapt are \
         given the same primary, shadow, reflection and diffuse rays on one thread, in turn; medians of {} rounds, {}.",
        DENSITIES[0],
        DENSITIES[DENSITIES.len() - 1],
        rounds(lab),
        spread_text(timings)
    );
    let plot = Chart::Plot(Plot {
        title: "Time per ray over the resolution of a uniform grid".to_owned(),
        x: Axis::logarithmic("cells per triangle"),
        y: Axis::logarithmic("time per ray (ns)"),
        series: results.iter().map(|r| Series::measured(&r.scene, r.grid.clone())).collect(),
    });
    let best_grid = |r: &Measured| r.best().map(|best| best[1]);
    let bars = Chart::Bars(BarChart {
        title: "Time per ray: the best uniform grid and what adapts".to_owned(),
        value: Axis::logarithmic("time per ray (ns)"),
        decimals: 0,
        categories: ["best uniform grid"]
            .into_iter()
            .chain(ADAPTIVE.iter().map(|k| k.name()))
            .map(str::to_owned)
            .collect(),
        series: results
            .iter()
            .map(|r| BarSeries {
                name: r.scene.clone(),
                values: [best_grid(r)]
                    .into_iter()
                    .chain(r.adaptive.iter().map(|&t| Some(t)))
                    .collect(),
            })
            .collect(),
    });
    let mut table = Table::new(
        "The best grid of each scene, and the structures that adapt",
        &[
            "scene",
            "best cells per triangle",
            "its ns per ray",
            "slowest that adapts",
            "fastest that adapts",
        ],
    );
    table.rows = results
        .iter()
        .map(|r| {
            let [density, time] = r.best().unwrap_or([f64::NAN; 2]);
            let (slowest, fastest) = (r.slowest_adaptive(), r.fastest_adaptive());
            vec![
                Cell::text(&r.scene),
                Cell::Number(density, 2),
                Cell::Number(time, 0),
                Cell::Number(slowest, 0),
                Cell::Number(fastest, 0),
            ]
        })
        .collect();
    Findings { method, tables: vec![table], charts: vec![plot, bars], verdict: judge(results) }
}

/// Judges the results of an even scene first and ever more uneven ones after it.
fn judge(results: &[Measured]) -> Verdict {
    let measured = results.iter().all(|r| r.best().is_some_and(|best| best[1].is_finite()));
    let (Some(even), [.., uneven], true) = (results.first(), results, measured) else {
        let explanation = "The eye sees nothing in one of the scenes.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    };
    let best = |r: &Measured| r.best().unwrap_or([f64::NAN; 2]);
    let [even_density, _] = best(even);
    let losses: Vec<_> = results[1..].iter().map(|r| r.loss_at(even_density)).collect();
    let (_, loss) = range(&losses);
    let against_fastest = best(uneven)[1] / uneven.fastest_adaptive();
    let against_slowest = best(uneven)[1] / uneven.slowest_adaptive();
    let judgement =
        Judgement::by_conditions(&[loss >= MISFIT, against_fastest >= LOSS, against_slowest > 1.0]);
    let best_at = |r: &Measured| format!("{} for the {}", best(r)[0], r.scene);
    let all: Vec<_> = results.iter().map(best_at).collect();
    let explanation = format!(
        "The best number of cells per triangle is {}. With that of the {}, another scene takes {loss:.1} times as long as with its own. For the \
         {} even the best uniform grid takes {against_fastest:.1} times as long as the fastest structure that adapts, and {against_slowest:.1} \
         times as long as the slowest of these.",
        all.join(", "),
        even.scene,
        uneven.scene
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene with its best grid at a density, a third slower on both sides.
    fn made_up(best: f64, time: f64, adaptive: f64) -> Measured {
        let slower = |density: f64| if density == best { time } else { 1.33 * time };
        let grid = [0.1, 1.0, 10.0].map(|density| [density, slower(density)]).to_vec();
        Measured { scene: "scene".to_owned(), grid, adaptive: vec![adaptive, 1.1 * adaptive] }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let even = made_up(1.0, 100.0, 100.0);
        let judgement = |uneven: Measured| judge(&[even.clone(), uneven]).judgement;
        assert_eq!(judgement(made_up(10.0, 300.0, 100.0)), Judgement::Holds);
        assert_eq!(judgement(made_up(1.0, 300.0, 100.0)), Judgement::HoldsInPart);
        assert_eq!(judgement(made_up(0.1, 90.0, 100.0)), Judgement::HoldsInPart);
        assert_eq!(judgement(made_up(1.0, 90.0, 100.0)), Judgement::Fails);
        assert_eq!(judge(&[]).judgement, Judgement::NotMeasured);
        assert_eq!(judgement(made_up(1.0, f64::NAN, 100.0)), Judgement::NotMeasured);
    }

    #[test]
    fn every_scene_is_measured() {
        let lab = Lab::new(&[], true, 1).expect("no scenes");
        let findings = measure(&lab).expect("findings");
        assert_ne!(findings.verdict.judgement, Judgement::NotMeasured);
        let [table] = &findings.tables[..] else { panic!("one table") };
        assert_eq!(table.rows.len(), 3);
    }
}
