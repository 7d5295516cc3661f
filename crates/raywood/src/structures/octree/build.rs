//! Building the octree: top down, every crowded cell's primitives handed to its octants.

use std::ops::Range;

use super::cell::{Placement, middle, octant};
use super::{Node, Octree};
use crate::build::{PackedAabb, Work, driver};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Vec3, parallel};

/// How many references a primitive may have on average.
const MAX_REFERENCES: f64 = 8.0;

/// How many references a tree may have in all, so that 32 bits number them, with room for rounding.
const MAX_TOTAL_REFERENCES: f64 = 4.29e9;

/// Cells with more primitives than this build their octants in parallel.
const PARALLEL_CELL: usize = 2048;

/// Cells with more primitives than this have them placed in parallel: the few at the top, before there are octants to share out.
const PARALLEL_PLACEMENT: usize = 1 << 16;

/// Builds the octree; the options are within their ranges.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Octree, BuildError> {
    let [listing, dividing] = work.shares([1.0, 30.0]);
    let bounds = driver::primitive_bounds(geometry, listing)?;
    let n = bounds.len();
    let root: Aabb =
        parallel::fold(&bounds, PackedAabb::EMPTY, PackedAabb::grow, PackedAabb::grow).into();
    let (mut nodes, mut references) = (Vec::new(), Vec::new());
    if n > 0 {
        let placement = Placement::new(geometry);
        let builder = OctreeBuilder { bounds: &bounds, placement, options };
        let allowance = MAX_REFERENCES.min(MAX_TOTAL_REFERENCES / n as f64);
        let mut lists = Lists { primitives: (0..n as u32).collect(), octants: Vec::new() };
        let mut pool = Pool { nodes: vec![Node::default()], references: Vec::new() };
        let cell = CrowdedCell { bounds: root, level: 1, allowance, work: dividing };
        pool.nodes[0] = builder.subdivide(&mut pool, &mut lists, 0..n, &cell);
        work.check()?;
        (nodes, references) = (pool.nodes, pool.references);
        nodes.shrink_to_fit();
        references.shrink_to_fit();
    }
    Ok(Octree { bounds: root, primitives: n as u32, nodes, references })
}

/// What the build of every cell needs.
struct OctreeBuilder<'a, G> {
    bounds: &'a [PackedAabb],
    placement: Placement<'a, G>,
    options: &'a BuildOptions,
}

/// A cell that may be divided.
struct CrowdedCell<'a> {
    bounds: Aabb,
    level: usize,
    /// How many references each of its primitives may come to have inside it, on average. A division into octants that hold `m`
    /// of `n` primitives uses up a factor of `m/n`, so that whatever the scene no subtree exceeds its share.
    allowance: f64,
    /// What dividing it is of the whole build. Small cells do not report it.
    work: Work<'a>,
}

/// The finished part of a tree.
struct Pool {
    nodes: Vec<Node>,
    references: Vec<u32>,
}

/// The primitives of all cells on the way from the root to the current one, and the octants of the current one's.
struct Lists {
    primitives: Vec<u32>,
    octants: Vec<u8>,
}

/// The primitives of the eight octants, each a stretch of the list.
struct Division {
    octants: [Range<usize>; 8],
    /// How many they have together.
    references: usize,
    allowance: f64,
}

/// One octant's part of the work when octants are built in parallel.
struct Task<'a> {
    lists: Lists,
    cell: CrowdedCell<'a>,
    pool: Pool,
    node: Node,
}

impl<G: Geometry> OctreeBuilder<'_, G> {
    /// Adds all below a cell to the pool and returns the cell's own node. The cell's primitives are a stretch of the list.
    fn subdivide(
        &self,
        pool: &mut Pool,
        lists: &mut Lists,
        primitives: Range<usize>,
        cell: &CrowdedCell<'_>,
    ) -> Node {
        let (count, end) = (primitives.len(), lists.primitives.len());
        if count > PARALLEL_CELL && cell.work.check().is_err() {
            return Node::default();
        }
        let middle = middle(&cell.bounds);
        let Some(division) = self.divide(lists, primitives.clone(), cell, middle) else {
            let first = pool.references.len();
            pool.references.extend_from_slice(&lists.primitives[primitives]);
            return Node::leaf(first, count);
        };

        // Make room for the nodes of all octants that are not empty, side by side, then fill it.
        let first = pool.nodes.len();
        let octants = (0..8).filter(|&number| !division.octants[number].is_empty());
        let children = octants.map(|number| {
            let bounds = octant(&cell.bounds, middle, number);
            let (level, allowance) = (cell.level + 1, division.allowance);
            let stretch = division.octants[number].clone();
            let work = match count > PARALLEL_CELL {
                true => cell.work.part(stretch.len(), division.references),
                false => cell.work,
            };
            (stretch, CrowdedCell { bounds, level, allowance, work })
        });
        let set = (0..8)
            .fold(0, |set, number| set | u8::from(!division.octants[number].is_empty()) << number);
        pool.nodes.resize(first + set.count_ones() as usize, Node::default());
        if count > PARALLEL_CELL {
            let mut tasks: Vec<Task<'_>> = children
                .map(|(stretch, cell)| Task {
                    lists: Lists {
                        primitives: lists.primitives[stretch].to_vec(),
                        octants: Vec::new(),
                    },
                    cell,
                    pool: Pool { nodes: Vec::new(), references: Vec::new() },
                    node: Node::default(),
                })
                .collect();
            lists.primitives.truncate(end);
            self.run(&mut tasks);
            for (place, task) in (first..).zip(tasks) {
                pool.nodes[place] = pool.append(task.pool, task.node);
            }
        } else {
            for (place, (stretch, child)) in (first..).zip(children) {
                pool.nodes[place] = self.subdivide(pool, lists, stretch, &child);
            }
            lists.primitives.truncate(end);
        }
        Node::interior(first, set)
    }

    /// Lists the primitives of each octant behind all others, or leaves everything as it is if the cell should be a leaf.
    fn divide(
        &self,
        lists: &mut Lists,
        primitives: Range<usize>,
        cell: &CrowdedCell<'_>,
        middle: Vec3,
    ) -> Option<Division> {
        let count = primitives.len();
        if count <= self.options.octree_leaf_size || cell.level >= self.options.octree_max_depth {
            return None;
        }

        // Find each primitive's octants and how many each octant has.
        let Lists { primitives: all, octants } = lists;
        let members = &all[primitives.clone()];
        let place = |primitive: u32| {
            let bounds = self.bounds[primitive as usize].into();
            self.placement.octants(primitive, &bounds, &cell.bounds, middle)
        };
        octants.clear();
        if count > PARALLEL_PLACEMENT {
            let work = cell.work.without_progress();
            *octants = parallel::map_watched(count, work, |i| place(members[i])).ok()?;
        } else {
            octants.extend(members.iter().map(|&primitive| place(primitive)));
        }
        let mut counts = [0usize; 8];
        for &set in &*octants {
            for (number, count) in counts.iter_mut().enumerate() {
                *count += usize::from(set >> number & 1);
            }
        }

        // Stop where dividing costs more than it saves by the surface area heuristic, where an octant has a quarter of the cell's
        // area, and where references would become too many. A geometry that denies all parts of its primitives gets a leaf, too.
        let total: usize = counts.iter().sum();
        let nodes = counts.iter().filter(|&&count| count > 0).count();
        let BuildOptions { node_cost, primitive_cost, .. } = *self.options;
        let cost = |nodes: usize, primitives: usize| {
            f64::from(node_cost) * nodes as f64 + f64::from(primitive_cost) * primitives as f64
        };
        let pays = cost(nodes, total) < 4.0 * cost(0, count);
        let growth = total as f64 / count as f64;
        if !pays || growth > cell.allowance || total == 0 {
            return None;
        }

        // List them, octant by octant.
        let mut end = lists.primitives.len();
        let octants = counts.map(|count| {
            end += count;
            end - count..end
        });
        lists.primitives.resize(end, 0);
        let mut places = octants.clone().map(|stretch| stretch.start);
        for (index, &set) in primitives.zip(&lists.octants) {
            let primitive = lists.primitives[index];
            let mut rest = set;
            while rest != 0 {
                let place = &mut places[rest.trailing_zeros() as usize];
                lists.primitives[*place] = primitive;
                *place += 1;
                rest &= rest - 1;
            }
        }
        Some(Division { octants, references: total, allowance: cell.allowance / growth })
    }

    /// Builds octants, each into a pool of its own, in parallel.
    fn run(&self, tasks: &mut [Task<'_>]) {
        match tasks {
            [] => {}
            [Task { lists, cell, pool, node }] => {
                let all = 0..lists.primitives.len();
                *node = self.subdivide(pool, lists, all.clone(), cell);
                if all.len() <= PARALLEL_CELL {
                    // If the build is stopped, the next large cell sees it.
                    let _ = cell.work.done();
                }
            }
            _ => {
                let (some, others) = tasks.split_at_mut(tasks.len() / 2);
                parallel::join_if(true, || self.run(some), || self.run(others));
            }
        }
    }
}

impl Pool {
    /// Takes in another pool and returns the node over it as it must be from now on.
    fn append(&mut self, other: Self, node: Node) -> Node {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        let moved = |node: Node| {
            let by = if node.count() > 0 { references } else { nodes };
            Node { first: node.first + by, ..node }
        };
        self.nodes.extend(other.nodes.into_iter().map(moved));
        self.references.extend(other.references);
        moved(node)
    }
}
