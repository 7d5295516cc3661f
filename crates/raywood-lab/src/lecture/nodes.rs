//! How many nodes and levels binary trees have.

use raywood::{BuildOptions, Structure, StructureKind};
use raywood_render::PreparedScene;

use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict, shapes};
use crate::figures::{Axis, Cell, Chart, Plot, Series, Table};

pub(super) const ENTRY: Entry = Entry {
    id: "nodes",
    title: "How large a tree is",
    claim: "A binary tree over N primitives has at most 2N-1 nodes, and a balanced one log2 N + 1 levels: 11 for 1024 primitives, 21 for a \
            million.",
    measure,
};

const BUILDERS: &[StructureKind] = &[
    StructureKind::BvhMidpoint,
    StructureKind::BvhMedian,
    StructureKind::BvhSahSweep,
    StructureKind::BvhSahBinned,
];

/// The builder whose trees are balanced.
const BALANCED: StructureKind = StructureKind::BvhMedian;

/// The builder that tries every split takes too long over more primitives than this.
const MOST_FOR_SWEEP: usize = 1 << 16;

/// A tree that was built.
#[derive(Clone, Debug)]
struct Tree {
    scene: String,
    kind: StructureKind,
    primitives: usize,
    nodes: usize,
    depth: usize,
    /// Whether every leaf has a single primitive, so that the claim about levels is about this tree.
    single: bool,
}

impl Tree {
    fn most_nodes(&self) -> usize {
        (2 * self.primitives).saturating_sub(1)
    }

    /// The levels of a balanced tree over as many primitives.
    fn balanced_depth(&self) -> usize {
        self.primitives.next_power_of_two().ilog2() as usize + 1
    }
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let sizes: &[usize] =
        lab.pick(&[1 << 8, 1 << 10, 1 << 12], &[1 << 10, 1 << 13, 1 << 16, 1 << 20]);
    let single = BuildOptions { max_leaf_size: 1, ..BuildOptions::default() };
    let mut trees = Vec::new();
    for &size in sizes {
        let soup = shapes::soup(size);
        for &kind in BUILDERS {
            if kind != StructureKind::BvhSahSweep || size <= MOST_FOR_SWEEP {
                trees.push(tree(&soup, kind, &single)?);
            }
        }
    }
    for subject in lab.subjects() {
        for kind in [BALANCED, StructureKind::BvhSahBinned] {
            trees.push(tree(subject.scene, kind, &BuildOptions::default())?);
        }
    }

    let columns = ["scene", "builder", "primitives N", "nodes", "2N-1", "levels", "log2 N + 1"];
    let mut table = Table::new("Nodes and levels", &columns);
    table.rows = trees.iter().map(row).collect();
    let verdict = judge(&trees);
    let method = format!(
        "Every builder divides a soup of random triangles until one is left in each leaf ({} only up to {MOST_FOR_SWEEP}); then two of them \
         build the scenes with their usual leaves of up to {} primitives. The trees are counted, nothing is timed. log2 N is rounded up.",
        StructureKind::BvhSahSweep.name(),
        BuildOptions::default().max_leaf_size
    );
    Ok(Findings { method, tables: vec![table], charts: vec![chart(&trees)], verdict })
}

fn tree(
    scene: &raywood_scene::Scene,
    kind: StructureKind,
    options: &BuildOptions,
) -> Result<Tree, LectureError> {
    let stats = Structure::build(kind, PreparedScene::surfaces(scene), options)?.stats();
    Ok(Tree {
        scene: scene.name.clone(),
        kind,
        primitives: stats.primitives,
        nodes: stats.nodes,
        depth: stats.depth,
        single: options.max_leaf_size == 1,
    })
}

fn row(tree: &Tree) -> Vec<Cell> {
    vec![
        Cell::text(&tree.scene),
        Cell::text(tree.kind.name()),
        Cell::count(tree.primitives),
        Cell::count(tree.nodes),
        Cell::count(tree.most_nodes()),
        Cell::count(tree.depth),
        if tree.single { Cell::count(tree.balanced_depth()) } else { Cell::Nothing },
    ]
}

fn chart(trees: &[Tree]) -> Chart {
    let of_kind = |kind: StructureKind| trees.iter().filter(move |t| t.single && t.kind == kind);
    let series = |&kind: &StructureKind| {
        let point = |tree: &Tree| [tree.primitives as f64, tree.depth as f64];
        Series::measured(kind.name(), of_kind(kind).map(point).collect())
    };
    let ideal = of_kind(BALANCED).map(|t| [t.primitives as f64, t.balanced_depth() as f64]);
    let ideal = Series::ideal("log2 N + 1", ideal.collect());
    Chart::Plot(Plot {
        title: "Levels of trees over a soup of triangles, one triangle per leaf".to_owned(),
        x: Axis::logarithmic("primitives N"),
        y: Axis::linear("levels"),
        series: BUILDERS.iter().map(series).chain([ideal]).collect(),
    })
}

fn judge(trees: &[Tree]) -> Verdict {
    let over = trees.iter().filter(|tree| tree.nodes > tree.most_nodes()).count();
    let balanced: Vec<_> = trees.iter().filter(|t| t.single && t.kind == BALANCED).collect();
    let fits = balanced.iter().filter(|tree| tree.depth == tree.balanced_depth()).count();
    let judgement = match trees {
        [] => Judgement::NotMeasured,
        _ => Judgement::by_conditions(&[over == 0, fits == balanced.len()]),
    };
    let deepest = trees.iter().filter(|tree| tree.single).max_by_key(|tree| tree.depth);
    let deepest = deepest.map_or(String::new(), |tree| {
        format!(
            " The deepest tree with single primitives in its leaves, {} over {} of them, has {} levels instead of {}.",
            tree.kind.name(), tree.primitives, tree.depth, tree.balanced_depth()
        )
    });
    let explanation = format!(
        "{} of {} trees have more than 2N-1 nodes; {fits} of {} balanced trees have log2 N + 1 levels.{deepest}",
        over,
        trees.len(),
        balanced.len()
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made_up(nodes: usize, depth: usize) -> Tree {
        let scene = "soup".to_owned();
        Tree { scene, kind: BALANCED, primitives: 1024, nodes, depth, single: true }
    }

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let judgement = |tree: Tree| judge(&[tree]).judgement;
        assert_eq!(judgement(made_up(2047, 11)), Judgement::Holds);
        assert_eq!(judgement(made_up(2048, 11)), Judgement::HoldsInPart);
        assert_eq!(judgement(made_up(2047, 12)), Judgement::HoldsInPart);
        assert_eq!(judgement(made_up(2048, 12)), Judgement::Fails);
        assert_eq!(judge(&[]).judgement, Judgement::NotMeasured);
    }

    #[test]
    fn a_balanced_tree_over_1024_has_11_levels() {
        let single = BuildOptions { max_leaf_size: 1, ..BuildOptions::default() };
        let soup = shapes::soup(1024);
        for &kind in BUILDERS {
            let tree = tree(&soup, kind, &single).expect("a tree");
            assert_eq!(tree.nodes, 2047, "{}", kind.name());
            assert!(tree.depth >= 11, "{}", kind.name());
        }
        assert_eq!(tree(&soup, BALANCED, &single).expect("a tree").depth, 11);
    }
}
