//! Objects that stand at many places: parts of the scene's mesh, and where they are shown.

use std::fmt;
use std::ops::Range;

use raywood::{Aabb, MeshPart, Transform, TransformError, TriangleMesh};

use crate::{MaterialId, Rgb};

/// The objects of a scene and the places where they stand. None by default.
///
/// Objects are parts of the scene's one [mesh](crate::Scene::mesh), each in a space of its own, behind all triangles that stand in the world as they are. So what belongs to a
/// triangle (normals, texture coordinates, materials) is found in the same way whether it is instanced or not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instances {
    /// The number of the first triangle of each object, ascending; behind them that of all.
    starts: Vec<u32>,
    placed: Vec<Instance>,
}

/// An object at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The number of the object.
    pub object: u32,
    /// From the object's space into the world: any affine transform that has an inverse. Of what moves, at time 0.
    pub transform: Transform,
    /// Where it has moved to at time 1, if it moves: [between](Transform::blended), its points are on straight lines.
    pub later: Option<Transform>,
    /// A material for all its triangles, in place of their own.
    pub material: Option<MaterialId>,
    /// What its diffuse colours are multiplied by, as by colours of vertices.
    pub tint: Rgb,
}

impl Instance {
    /// An object at a place, with its own materials and colours.
    pub fn new(object: u32, transform: Transform) -> Self {
        Self { object, transform, later: None, material: None, tint: Rgb::ONE }
    }

    /// The box around it at all times, if that is the one around its object.
    pub fn bounds(&self, object: &Aabb) -> Aabb {
        let first = self.transform.bounds(object);
        // On the way all corners of the box are between where they are at both ends.
        self.later.map_or(first, |later| first.union(later.bounds(object)))
    }

    fn check(&self) -> Result<(), TransformError> {
        match &self.later {
            None => self.transform.check(),
            Some(later) => self.transform.check_motion(later),
        }
    }
}

/// Why there cannot be such instances.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstancesError {
    /// Objects begin before those before them.
    Unordered {
        /// The first such object.
        object: usize,
    },
    /// A transform is not finite or has no inverse, or one on the way between two.
    BadTransform {
        /// The first such instance.
        instance: usize,
        /// What is wrong with it.
        error: TransformError,
    },
    /// An instance shows an object that is not there.
    NoSuchObject {
        /// The first such instance.
        instance: usize,
        /// The object that it names.
        object: u32,
        /// How many there are.
        objects: usize,
    },
}

impl fmt::Display for InstancesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unordered { object } => {
                write!(f, "object {object} ends before it begins: objects must stand in order")
            }
            Self::BadTransform { instance, error } => {
                write!(f, "the transform of instance {instance} {error}")
            }
            Self::NoSuchObject { instance, object, objects } => {
                write!(f, "instance {instance} shows object {object}, but there are {objects}")
            }
        }
    }
}

impl std::error::Error for InstancesError {}

impl Instances {
    /// Objects that begin at these triangles of the mesh and end where the next begins, the last at `end`; and instances of them.
    ///
    /// # Errors
    ///
    /// Objects out of order, instances of objects that are not there, transforms that cannot be inverted.
    pub fn new(
        mut starts: Vec<u32>,
        end: u32,
        placed: Vec<Instance>,
    ) -> Result<Self, InstancesError> {
        let objects = starts.len();
        starts.push(end);
        if let Some(object) = starts.windows(2).position(|pair| pair[0] > pair[1]) {
            return Err(InstancesError::Unordered { object });
        }
        let is_missing = |instance: &Instance| instance.object as usize >= objects;
        if let Some(instance) = placed.iter().position(is_missing) {
            let object = placed[instance].object;
            return Err(InstancesError::NoSuchObject { instance, object, objects });
        }
        let bad = placed.iter().map(Instance::check);
        if let Some((instance, Err(error))) = bad.enumerate().find(|(_, check)| check.is_err()) {
            return Err(InstancesError::BadTransform { instance, error });
        }
        Ok(if objects == 0 { Self::default() } else { Self { starts, placed } })
    }

    /// Whether there are none, and no objects.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// All instances.
    pub fn placed(&self) -> &[Instance] {
        &self.placed
    }

    /// Whether any of them moves.
    pub fn moves(&self) -> bool {
        self.placed.iter().any(|instance| instance.later.is_some())
    }

    /// The triangles of all objects, in order.
    pub fn objects(&self) -> impl ExactSizeIterator<Item = Range<u32>> + '_ {
        self.starts.windows(2).map(|pair| pair[0]..pair[1])
    }

    /// How many of a mesh's triangles stand in the world as they are: the first ones.
    pub fn own_triangles(&self, triangles: &TriangleMesh) -> u32 {
        let all = triangles.triangles().len() as u32;
        self.starts.first().map_or(all, |&first| first.min(all))
    }

    /// How many triangles the instances show.
    pub fn visible_triangles(&self) -> u64 {
        let counts: Vec<_> = self.objects().map(|triangles| triangles.len() as u64).collect();
        self.placed.iter().map(|instance| counts[instance.object as usize]).sum()
    }

    /// The box around each object, in its own space. O(triangles of objects).
    pub fn object_bounds(&self, triangles: &TriangleMesh) -> Vec<Aabb> {
        self.objects().map(|range| MeshPart::new(triangles, range).total_bounds()).collect()
    }

    /// A box around each instance, at all times: that of its object, transformed; empty where that is. O(triangles of objects + instances).
    pub fn bounds(&self, triangles: &TriangleMesh) -> Vec<Aabb> {
        let objects = self.object_bounds(triangles);
        let around = |instance: &Instance| instance.bounds(&objects[instance.object as usize]);
        self.placed.iter().map(around).collect()
    }
}

/// Triangles that are fewer are copied, however often they are shown.
const FEWEST_TRIANGLES: u64 = 128;

/// Triangles are copied if their copies add no more than so many.
const MOST_ADDED: u64 = 1 << 16;

/// Whether triangles that are shown at many places should become an object that instances show, rather than be copied.
///
/// Copies are traced faster: their triangles lie in one tree, and no ray is taken from one space into another. Instances take no memory for triangles and no time to build trees over them. So
/// triangles are shared where copies would add many, unless they are so few that an instance of them takes as much memory as they do and the way into it as much time as testing them.
pub(crate) fn is_worth_sharing(triangles: u64, places: u64) -> bool {
    let added = triangles.saturating_mul(places.saturating_sub(1));
    triangles >= FEWEST_TRIANGLES && added > MOST_ADDED
}
