//! How the cost of a ray grows with the number of primitives.

use raywood::{BuildOptions, Structure, StructureKind};
use raywood_render::PreparedScene;
use raywood_scene::Scene;

use super::fit::{growth_exponent, range};
use super::lab::Subject;
use super::measure::{Work, nanoseconds, spread_text, thinned, time};
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict, shapes};
use crate::figures::{Axis, Cell, Chart, Plot, Series, Table};
use crate::timing::Timing;

pub(super) const ENTRY: Entry = Entry {
    id: "growth",
    title: "How the cost of a ray grows",
    claim: "Without a structure the time of a ray grows in proportion to the number of primitives N; with one it grows about as log N.",
    measure,
};

/// Growth exponents up to this count as logarithmic: between a thousand and a million, log N itself grows as N to the power of 0.1.
const LOGARITHMIC: f64 = 0.2;
/// Growth exponents up to this are still far from proportional.
const SLOW: f64 = 0.6;

/// How a structure does on scenes of one kind and growing size.
#[derive(Clone, Debug)]
struct Curve {
    scene: String,
    kind: StructureKind,
    /// Number of primitives, nodes and primitives that a ray meets.
    steps: Vec<[f64; 2]>,
    /// Number of primitives, nanoseconds per ray.
    times: Vec<[f64; 2]>,
}

impl Curve {
    fn steps_exponent(&self) -> f64 {
        growth_exponent(&self.steps)
    }

    fn time_exponent(&self) -> f64 {
        growth_exponent(&self.times)
    }

    fn is_brute_force(&self) -> bool {
        self.kind == StructureKind::BruteForce
    }
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let sizes: &[usize] =
        lab.pick(&[1_000, 4_000, 16_000], &[1_000, 4_000, 16_000, 64_000, 256_000, 1_000_000]);
    // The builder that tries every split takes very long over a million primitives, and its trees are nearly those of the bins.
    let kinds = StructureKind::ALL.iter().filter(|kind| **kind != StructureKind::BvhSahSweep);
    let kinds: Vec<_> = kinds.copied().collect();
    let mut timings = Vec::new();
    let surface = curves(lab, shapes::sheet, sizes, &kinds, &mut timings)?;
    // In space the large sizes tell nothing new.
    let in_space: Vec<_> = sizes.iter().copied().filter(|&size| size <= 256_000).collect();
    let soup = curves(lab, shapes::soup, &in_space, &kinds, &mut timings)?;

    let columns = [
        "structure",
        "scene",
        "steps, smallest N",
        "steps, largest N",
        "exponent of steps",
        "exponent of time",
    ];
    let mut table =
        Table::new("Steps (nodes and primitives) of a ray, and growth exponents", &columns);
    table.rows = surface.iter().chain(&soup).map(row).collect();
    let charts = vec![
        time_chart("Time per ray on a wavy surface", &surface),
        steps_chart("Steps per ray on a wavy surface, brute force left out", &surface),
        steps_chart("Steps per ray in a soup of random triangles, brute force left out", &soup),
    ];
    let all: Vec<_> = surface.into_iter().chain(soup).collect();
    let method = format!(
        "Two scenes are made of ever more, ever smaller triangles: a wavy surface, and a soup that fills a cube and whose total area stays the \
         same, so that rays fly equally far. Primary, shadow, reflection and diffuse rays are traced on one thread, each structure in turn, and \
         medians of {} rounds are taken; {}. The growth exponent p is that of the power law N^p that fits best: 1 is proportional, log N \
         itself comes to about 0.1. Up to {LOGARITHMIC} in steps counts as logarithmic.",
        rounds(lab),
        spread_text(&timings)
    );
    Ok(Findings { method, tables: vec![table], charts, verdict: judge(&all) })
}

/// How often times are taken.
fn rounds(lab: &Lab<'_>) -> usize {
    lab.pick(3, 7)
}

/// Builds and measures every structure on scenes of growing size.
fn curves(
    lab: &Lab<'_>,
    make: impl Fn(usize) -> Scene,
    sizes: &[usize],
    kinds: &[StructureKind],
    timings: &mut Vec<Timing>,
) -> Result<Vec<Curve>, LectureError> {
    let mut curves: Vec<_> = kinds
        .iter()
        .map(|&kind| Curve { scene: String::new(), kind, steps: Vec::new(), times: Vec::new() })
        .collect();
    for &size in sizes {
        let scene = make(size);
        let subject = Subject::new(&scene, lab.is_quick())?;
        let rays = subject.mixed_rays(lab.pick(512, 4096))?;
        let primitives = (scene.mesh.triangles.triangles().len()) as f64;
        let surfaces = PreparedScene::surfaces(&scene);
        let mut structures = Vec::new();
        for &kind in kinds {
            structures.push(Structure::build(kind, &surfaces, &BuildOptions::default())?);
        }

        // Brute force gets fewer rays, or it would take hours.
        let few = thinned(&rays, (4_000_000 / size).max(8));
        let rays_for = |kind: StructureKind| {
            if kind == StructureKind::BruteForce { few.as_slice() } else { &rays }
        };
        let contestants: Vec<_> =
            structures.iter().map(|structure| (structure, rays_for(structure.kind()))).collect();
        let measured = time(&contestants, rounds(lab));
        for ((curve, timing), (structure, rays)) in
            curves.iter_mut().zip(&measured).zip(&contestants)
        {
            curve.scene.clone_from(&scene.name);
            curve.steps.push([primitives, Work::of(structure, rays).steps()]);
            curve.times.push([primitives, nanoseconds(timing, rays.len())]);
        }
        timings.extend(measured);
    }
    Ok(curves)
}

fn row(curve: &Curve) -> Vec<Cell> {
    let steps = |point: Option<&[f64; 2]>| point.map_or(Cell::Nothing, |p| Cell::Number(p[1], 0));
    vec![
        Cell::text(curve.kind.name()),
        Cell::text(&curve.scene),
        steps(curve.steps.first()),
        steps(curve.steps.last()),
        Cell::Number(curve.steps_exponent(), 2),
        Cell::Number(curve.time_exponent(), 2),
    ]
}

fn chart(title: &str, y: &str, series: Vec<Series>) -> Chart {
    Chart::Plot(Plot {
        title: title.to_owned(),
        x: Axis::logarithmic("triangles N"),
        y: Axis::logarithmic(y),
        series,
    })
}

/// Brute force comes last, so that each structure has the same colour in all charts.
fn time_chart(title: &str, curves: &[Curve]) -> Chart {
    let (brute, others): (Vec<_>, Vec<_>) = curves.iter().partition(|curve| curve.is_brute_force());
    let series = |curve: &Curve| Series::measured(curve.kind.name(), curve.times.clone());
    let series = others.into_iter().chain(brute).map(series).collect();
    chart(title, "time per ray (ns)", series)
}

/// The steps of rays in structures, and log N to hold them against. Brute force, N steps, would press all others together.
fn steps_chart(title: &str, curves: &[Curve]) -> Chart {
    let curves: Vec<_> = curves.iter().filter(|curve| !curve.is_brute_force()).collect();
    let series = |curve: &&Curve| Series::measured(curve.kind.name(), curve.steps.clone());
    let logarithm = curves.first().map(|curve| {
        let points = curve.steps.iter().map(|[n, _]| [*n, n.log2()]);
        Series::ideal("log2 N", points.collect())
    });
    let series = curves.iter().map(series).chain(logarithm).collect();
    chart(title, "nodes and primitives per ray", series)
}

/// An exponent as tables show it, so that readers judge as the verdict does.
fn rounded(exponent: f64) -> f64 {
    (100.0 * exponent).round() / 100.0
}

fn judge(curves: &[Curve]) -> Verdict {
    let (brute, others): (Vec<_>, Vec<_>) = curves.iter().partition(|curve| curve.is_brute_force());
    if brute.is_empty() || others.is_empty() {
        let explanation = "There is nothing to compare.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    }
    let exponents =
        |curves: &[&Curve]| curves.iter().map(|c| c.steps_exponent()).collect::<Vec<_>>();
    let (brute, fast) = (range(&exponents(&brute)), exponents(&others));
    let proportional = (brute.0 - 1.0).abs() <= 0.1 && (brute.1 - 1.0).abs() <= 0.1;
    let logarithmic = fast.iter().filter(|p| rounded(**p) <= LOGARITHMIC).count();
    let slow = fast.iter().all(|p| *p <= SLOW);
    let judgement = if proportional && logarithmic == fast.len() {
        Judgement::Holds
    } else if proportional && (logarithmic > 0 || slow) {
        Judgement::HoldsInPart
    } else {
        Judgement::Fails
    };

    let mut scenes: Vec<&str> = Vec::new();
    for curve in &others {
        if !scenes.contains(&curve.scene.as_str()) {
            scenes.push(&curve.scene);
        }
    }
    let of_scene = |scene: &&str| {
        let here = others.iter().copied().filter(|curve| curve.scene == **scene);
        let (low, high) = range(&exponents(&here.collect::<Vec<_>>()));
        format!("from {low:.2} to {high:.2} on the {scene}")
    };
    let scenes: Vec<_> = scenes.iter().map(of_scene).collect();
    let explanation = format!(
        "Brute force grows with an exponent of {:.2}. Those of the structures' steps lie {}: {logarithmic} of {} curves are logarithmic.",
        brute.1,
        scenes.join(", "),
        fast.len()
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made_up(kind: StructureKind, exponent: f64) -> Curve {
        let points: Vec<_> = [1e3, 1e5].map(|n: f64| [n, n.powf(exponent)]).to_vec();
        Curve { scene: "sheet".to_owned(), kind, steps: points.clone(), times: points }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let judgement = |brute: f64, trees: [f64; 2]| {
            let [a, b] = trees.map(|p| made_up(StructureKind::KdTree, p));
            judge(&[made_up(StructureKind::BruteForce, brute), a, b]).judgement
        };
        assert_eq!(judgement(1.0, [0.1, 0.15]), Judgement::Holds);
        assert_eq!(judgement(1.0, [0.1, 0.35]), Judgement::HoldsInPart);
        assert_eq!(judgement(1.0, [0.5, 0.5]), Judgement::HoldsInPart);
        assert_eq!(judgement(1.0, [0.9, 0.8]), Judgement::Fails);
        assert_eq!(judgement(0.5, [0.1, 0.1]), Judgement::Fails);
        assert_eq!(judge(&[]).judgement, Judgement::NotMeasured);
    }

    #[test]
    fn brute_force_grows_in_proportion_and_a_tree_does_not() {
        let lab = Lab::new(&[], true, 1).expect("no scenes");
        let kinds = [StructureKind::BruteForce, StructureKind::BvhSahBinned];
        let sizes = [500, 2_000, 8_000];
        let curves = curves(&lab, shapes::sheet, &sizes, &kinds, &mut Vec::new()).expect("curves");
        // A shadow ray stops at what blocks it, and so tests fewer than all.
        assert!((curves[0].steps_exponent() - 1.0).abs() < 0.1, "{:?}", curves[0]);
        assert!(curves[1].steps_exponent() < 0.3, "{:?}", curves[1]);
    }
}
