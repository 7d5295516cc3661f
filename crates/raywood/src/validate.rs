//! The invariants of a tree, checked.

use std::fmt;

use crate::structures::{Bvh2, MAX_DEPTH};
use crate::{Aabb, Geometry};

/// An invariant of a tree that does not hold.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ValidationError {
    /// More nodes than `2N-1`, or none although there are primitives.
    NodeCount {
        /// How many nodes there are.
        nodes: usize,
        /// How many primitives.
        primitives: usize,
    },
    /// A node names children or primitives that do not exist.
    BadReference {
        /// The node.
        node: usize,
    },
    /// A node's box does not enclose its content.
    NotEnclosed {
        /// The node.
        node: usize,
        /// Its box.
        bounds: Aabb,
        /// The box of the child or primitive that sticks out.
        content: Aabb,
    },
    /// A node is reached on two ways, or on none.
    NodeReached {
        /// The node.
        node: usize,
        /// On how many ways.
        times: usize,
    },
    /// A primitive is in two leaves, or in none.
    PrimitiveReached {
        /// The primitive.
        primitive: usize,
        /// In how many leaves.
        times: usize,
    },
    /// A cell does not refer to a primitive that reaches into it.
    NotReferenced {
        /// The cell.
        node: usize,
        /// The primitive.
        primitive: u32,
    },
    /// A triangle was cut, and a point of it lies in none of its parts' boxes.
    NotCovered {
        /// The primitive.
        primitive: u32,
    },
    /// A cell does not refer to exactly the primitives that overlap it.
    WrongContent {
        /// The cell's node.
        node: usize,
    },
    /// A leaf lies deeper than the traversals' stacks allow.
    TooDeep {
        /// Its level.
        depth: usize,
    },
}

impl fmt::Display for ValidationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NodeCount { nodes, primitives } => {
                write!(f, "{nodes} nodes for {primitives} primitives")
            }
            Self::BadReference { node } => {
                write!(f, "node {node} refers to nodes or primitives that do not exist")
            }
            Self::NotEnclosed { node, bounds, content } => {
                write!(f, "node {node} has the bounds {bounds:?} which do not enclose {content:?}")
            }
            Self::NodeReached { node, times } => {
                write!(f, "node {node} is reached {times} times instead of once")
            }
            Self::PrimitiveReached { primitive, times } => {
                write!(f, "primitive {primitive} is in {times} leaves instead of one")
            }
            Self::NotReferenced { node, primitive } => {
                write!(
                    f,
                    "cell {node} does not refer to primitive {primitive}, which reaches into it"
                )
            }
            Self::NotCovered { primitive } => {
                write!(f, "the boxes of the parts of primitive {primitive} do not hold all of it")
            }
            Self::WrongContent { node } => {
                write!(f, "node {node} does not hold exactly the primitives that overlap its cell")
            }
            Self::TooDeep { depth } => {
                write!(f, "a leaf on level {depth}, the deepest allowed is {MAX_DEPTH}")
            }
        }
    }
}

impl std::error::Error for ValidationError {}

impl Bvh2 {
    /// Checks every invariant of the tree against the geometry it was built over: at most `2N-1` nodes, each reached once; every
    /// primitive in one leaf; every box around its content; the depth within bounds. O(N).
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold.
    pub(crate) fn check<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        let (nodes, primitives) = (self.nodes(), geometry.len());
        if self.primitive_indices().len() != primitives
            || nodes.len() > (2 * primitives).saturating_sub(1)
            || (nodes.is_empty() && primitives > 0)
        {
            return Err(ValidationError::NodeCount { nodes: nodes.len(), primitives });
        }

        let mut node_reached = vec![0usize; nodes.len()];
        let mut primitive_reached = vec![0usize; primitives];
        let mut pending = Vec::new();
        if !nodes.is_empty() {
            pending.push((0usize, 1));
        }
        while let Some((number, depth)) = pending.pop() {
            let node = &nodes[number];
            node_reached[number] += 1;
            if node_reached[number] > 1 {
                return Err(ValidationError::NodeReached {
                    node: number,
                    times: node_reached[number],
                });
            }
            if depth > MAX_DEPTH {
                return Err(ValidationError::TooDeep { depth });
            }

            let bounds = node.bounds();
            let encloses = |content: Aabb| match bounds.contains(&content) {
                true => Ok(()),
                false => Err(ValidationError::NotEnclosed { node: number, bounds, content }),
            };
            let (first, end) = if node.is_leaf() {
                (node.left_first() as usize, node.left_first() as usize + node.count() as usize)
            } else {
                (node.left_first() as usize, node.left_first() as usize + 2)
            };
            if node.is_leaf() {
                let Some(leaf) = self.primitive_indices().get(first..end) else {
                    return Err(ValidationError::BadReference { node: number });
                };
                for &primitive in leaf {
                    let Some(times) = primitive_reached.get_mut(primitive as usize) else {
                        return Err(ValidationError::BadReference { node: number });
                    };
                    *times += 1;
                    encloses(geometry.bounds(primitive))?;
                }
            } else {
                let Some(children) = nodes.get(first..end) else {
                    return Err(ValidationError::BadReference { node: number });
                };
                for (child, node) in (first..).zip(children) {
                    encloses(node.bounds())?;
                    pending.push((child, depth + 1));
                }
            }
        }

        if let Some(node) = node_reached.iter().position(|&times| times != 1) {
            return Err(ValidationError::NodeReached { node, times: node_reached[node] });
        }
        match primitive_reached.iter().position(|&times| times != 1) {
            Some(primitive) => Err(ValidationError::PrimitiveReached {
                primitive,
                times: primitive_reached[primitive],
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structures::Node;
    use crate::{BuildOptions, TriangleMesh, Vec3};

    /// Eight triangles along x, in a tree with one in each leaf.
    fn mesh_and_tree() -> (TriangleMesh, Bvh2) {
        let corner = |i: u32, y: f32| Vec3::new(i as f32, y, 0.5 * y);
        let positions = (0..8).flat_map(|i| [corner(i, 0.0), corner(i, 1.0), corner(i + 1, 0.0)]);
        let triangles = (0..8).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriangleMesh::new(positions.collect(), triangles).expect("a mesh");
        let options = BuildOptions { max_leaf_size: 1, ..Default::default() };
        let tree = Bvh2::build(&mesh, &options).expect("a tree");
        assert_eq!((tree.nodes().len(), tree.check(&mesh)), (15, Ok(())));
        (mesh, tree)
    }

    /// The complaint about the tree after a change to its nodes and primitive indices.
    fn complaint(change: impl Fn(&mut Vec<Node>, &mut Vec<u32>)) -> ValidationError {
        let (mesh, tree) = mesh_and_tree();
        let (mut nodes, mut indices) = (tree.nodes().to_vec(), tree.primitive_indices().to_vec());
        change(&mut nodes, &mut indices);
        Bvh2::from_parts(nodes, indices).check(&mesh).expect_err("it is noticed")
    }

    fn first_leaf(nodes: &[Node]) -> usize {
        nodes.iter().position(Node::is_leaf).expect("a leaf")
    }

    #[test]
    fn too_few_or_many_nodes_are_noticed() {
        let is_count = |e| matches!(e, ValidationError::NodeCount { .. });
        assert!(is_count(complaint(|nodes, _| nodes.clear())));
        assert!(is_count(complaint(|nodes, _| nodes.push(nodes[0]))));
        assert!(is_count(complaint(|_, indices| indices.truncate(7))));
    }

    #[test]
    fn boxes_that_do_not_enclose_are_noticed() {
        for axis in 0..3 {
            let error = complaint(|nodes, _| {
                let mut max = nodes[0].bounds().max.to_array();
                max[axis] -= 0.125;
                let bounds = Aabb::new(nodes[0].bounds().min, max);
                nodes[0] = Node::interior(bounds, nodes[0].left_first());
            });
            assert!(matches!(error, ValidationError::NotEnclosed { node: 0, .. }), "{error}");
        }
        let error = complaint(|nodes, _| {
            let leaf = first_leaf(nodes);
            let flat = Aabb::new(nodes[leaf].bounds().min, nodes[leaf].bounds().min);
            nodes[leaf] = Node::leaf(flat, nodes[leaf].left_first(), 1);
        });
        assert!(matches!(error, ValidationError::NotEnclosed { .. }), "{error}");
    }

    #[test]
    fn wrong_references_are_noticed() {
        let far = |e| matches!(e, ValidationError::BadReference { .. });
        assert!(far(complaint(|nodes, _| nodes[0] = Node::interior(nodes[0].bounds(), 14))));
        assert!(far(complaint(|nodes, _| {
            let leaf = first_leaf(nodes);
            nodes[leaf] = Node::leaf(nodes[leaf].bounds(), 8, 1);
        })));
        assert!(far(complaint(|_, indices| indices[0] = 8)));
    }

    #[test]
    fn what_is_reached_twice_or_never_is_noticed() {
        // A loop: the root as its own descendant's child.
        let error = complaint(|nodes, _| {
            let below = nodes[0].left_first() as usize;
            let bounds = nodes[0].bounds();
            nodes[below] = Node::interior(bounds, nodes[0].left_first());
            nodes[0] = Node::interior(bounds, below as u32);
        });
        assert!(matches!(error, ValidationError::NodeReached { .. }), "{error}");

        let error = complaint(|nodes, indices| {
            indices[1] = indices[0];
            let all = nodes[0].bounds();
            for node in nodes {
                *node = Node::leaf(all, node.left_first(), node.count());
            }
        });
        assert!(matches!(error, ValidationError::PrimitiveReached { .. }), "{error}");

        let error = complaint(|nodes, _| {
            let all = nodes[0].bounds();
            nodes[0] = Node::leaf(all, 0, 8);
        });
        assert!(matches!(error, ValidationError::NodeReached { times: 0, .. }), "{error}");
    }

    #[test]
    fn trees_that_are_too_deep_are_noticed() {
        // A comb: each right child is a leaf, each left child the next tooth.
        let count = MAX_DEPTH + 2;
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]; count]).expect("a mesh");
        let bounds = mesh.total_bounds();
        let mut nodes = vec![];
        for tooth in 0..count as u32 - 1 {
            nodes.push(Node::interior(bounds, 2 * tooth + 1));
            if tooth > 0 {
                let last = nodes.len() - 1;
                nodes.insert(last + 1, Node::leaf(bounds, tooth, 1));
            }
        }
        nodes.push(Node::leaf(bounds, 0, 1));
        nodes.push(Node::leaf(bounds, count as u32 - 1, 1));
        let tree = Bvh2::from_parts(nodes, (0..count as u32).collect());
        let error = tree.check(&mesh).expect_err("it is noticed");
        assert!(matches!(error, ValidationError::TooDeep { .. }), "{error}");
    }
}
