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
