//! Saved trees: a tree and its geometry in one file, used where it lies in memory.
//!
//! `docs/format.md` specifies the file; why it is as it is stands in decision 17.

mod container;
mod error;
mod geometry;
mod tree;

use std::fmt;
use std::io::{self, Write};

use crate::storage::Array;
use crate::{Bvh, Geometry, Spheres, Structure, TriangleMesh, WideBvh, parallel};
use container::{Container, MOST_SECTIONS, NewSection, name_problem};
pub use error::SavedTreeError;
pub use geometry::SavedGeometry;

/// A tree that was [saved](Bvh::save), with its geometry and whatever was saved besides.
///
/// ```
/// use raywood::{Bvh, Ray, SavedTree, TriangleMesh};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let bvh = Bvh::build(TriangleMesh::new(corners, vec![[0, 1, 2]])?)?;
/// let mut file = Vec::new();
/// bvh.save_with(&[("colour", b"red")], &mut file)?;
///
/// let saved = SavedTree::open(file)?;
/// assert_eq!(saved.section("colour"), Some(&b"red"[..]));
/// let loaded = saved.bvh(saved.mesh())?;
/// let ray = Ray::new([0.25, 0.5, 1.0], [0.0, 0.0, -1.0]);
/// assert_eq!(loaded.intersect(&ray), bvh.intersect(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct SavedTree {
    file: Container,
    tree: WideBvh,
    mesh: TriangleMesh,
    spheres: Spheres,
}

impl SavedTree {
    /// With which bytes every saved tree begins, of any version.
    pub const SIGNATURE: [u8; 8] = container::SIGNATURE;

    /// Opens a saved tree. The arrays of which tree and mesh are made are not copied if they are aligned in memory, as those of a mapped file are (nodes to 64 bytes, all others to
    /// 4); the owner of the bytes lives as long as anything that was made of them.
    ///
    /// Everything is checked, in O(size of the file) on all threads of the caller's rayon pool, some milliseconds for a million triangles: checksums, so that damage
    /// is found; and every reference, number and box of the tree, so that no file, whatever it holds, makes a query panic, hang or read what it must not. What only costs
    /// hits is not: whether boxes and triangles are those of the geometry [`Bvh::validate`] can tell.
    ///
    /// Mapping a file is `unsafe` with every crate that does it: nobody may change the file as long as it is mapped, or what was checked does not hold any more. A file that is
    /// replaced by renaming another one does not change.
    ///
    /// # Errors
    ///
    /// The bytes are no saved tree, one of another version, damaged, or no tree that can be used: see [`SavedTreeError`].
    pub fn open(bytes: impl AsRef<[u8]> + Send + Sync + 'static) -> Result<Self, SavedTreeError> {
        if cfg!(target_endian = "big") {
            return Err(SavedTreeError::BigEndian);
        }
        let file = Container::open(Array::held_by(bytes))?;
        let is_other = |name: &str| !tree::VERIFIED_WHILE_READ.contains(&name);
        let (verified, read) =
            parallel::join_if(true, || file.verify(is_other), || tree::read(&file));
        if verified.is_err() || read.is_err() {
            // What is wrong with damaged contents is of no interest, and which of several damages is told of depends on their order alone.
            file.verify(|_| true)?;
        }
        let (tree, mesh, spheres) = read?;
        Ok(Self { file, tree, mesh, spheres })
    }

    /// The tree.
    pub fn tree(&self) -> &WideBvh {
        &self.tree
    }

    /// The triangles, which come first in the numbers of primitives.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The spheres, which are numbered on from the triangles.
    pub fn spheres(&self) -> &Spheres {
        &self.spheres
    }

    /// A section that was [saved besides](Bvh::save_with) the tree, or one of its own.
    pub fn section(&self, name: &str) -> Option<&[u8]> {
        Some(&self.file.bytes()[self.file.range(name)?])
    }

    /// The names of all sections and how many bytes they have.
    pub fn sections(&self) -> impl Iterator<Item = (&str, usize)> {
        self.file.sections()
    }

    /// The tree over its geometry, which must be that of [`mesh`](Self::mesh) and [`spheres`](Self::spheres). O(1).
    ///
    /// # Errors
    ///
    /// Another number of primitives.
    pub fn bvh<G: Geometry>(&self, geometry: G) -> Result<Bvh<G>, SavedTreeError> {
        self.check_geometry(geometry.len())?;
        Ok(Bvh { geometry, tree: self.tree.clone() })
    }

    /// The same as a structure of the kind [`BvhWide`](crate::StructureKind::BvhWide).
    ///
    /// # Errors
    ///
    /// As [`bvh`](Self::bvh).
    pub fn structure<G: Geometry>(&self, geometry: G) -> Result<Structure<G>, SavedTreeError> {
        self.check_geometry(geometry.len())?;
        Ok(Structure::of_wide(geometry, self.tree.clone()))
    }

    fn check_geometry(&self, primitives: usize) -> Result<(), SavedTreeError> {
        let own = self.mesh.len() + self.spheres.len();
        if primitives == own {
            return Ok(());
        }
        let (expected, found) = (format!("{primitives} primitives"), format!("{own} primitives"));
        Err(SavedTreeError::OtherGeometry { expected, found })
    }
}

impl fmt::Debug for SavedTree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.sections()).finish()
    }
}

impl<G: SavedGeometry> Bvh<G> {
    /// Saves the tree and its geometry, to be [loaded](Bvh::load) without being built again. The file is as large as both are in memory, and the same, to the byte, for
    /// any number of threads and level of instructions. Writes large pieces: the writer needs no buffer.
    ///
    /// ```
    /// use raywood::{Bvh, TriangleMesh};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let bvh = Bvh::build(TriangleMesh::new(corners, vec![[0, 1, 2]])?)?;
    /// let mut file = Vec::new();
    /// bvh.save(&mut file)?;
    ///
    /// let loaded = Bvh::load(file)?;
    /// assert_eq!(loaded.tree(), bvh.tree());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// What the writer says, and on big-endian machines [`Unsupported`](io::ErrorKind::Unsupported).
    pub fn save(&self, writer: impl Write) -> io::Result<()> {
        self.save_with(&[], writer)
    }

    /// As [`save`](Self::save), with sections besides, a name and any bytes each: what belongs to the geometry but is none, such as materials. Names have 1 to 16 bytes of `a` to
    /// `z`, `0` to `9`, `-` and `.`.
    ///
    /// # Errors
    ///
    /// As [`save`](Self::save), and [`InvalidInput`](io::ErrorKind::InvalidInput) for a name that no section can have, that another has, or that the library
    /// itself uses; and for more than some 250 sections.
    pub fn save_with(&self, besides: &[(&str, &[u8])], writer: impl Write) -> io::Result<()> {
        if cfg!(target_endian = "big") {
            return Err(io::Error::new(io::ErrorKind::Unsupported, SavedTreeError::BigEndian));
        }
        for (number, (name, _)) in besides.iter().enumerate() {
            let is_taken = tree::OWN.contains(name)
                || besides[..number].iter().any(|(other, _)| other == name);
            let problem = match is_taken {
                true => Some("there is a section of this name"),
                false => name_problem(name),
            };
            if let Some(problem) = problem {
                return Err(invalid_input(format!("section `{name}`: {problem}")));
            }
        }
        let own = tree::sections(&self.tree, self.geometry.content());
        if own.len() + besides.len() > MOST_SECTIONS {
            return Err(invalid_input(format!("more than {MOST_SECTIONS} sections")));
        }
        let own = own.iter().map(|(name, bytes)| NewSection { name, bytes });
        let besides = besides.iter().map(|&(name, bytes)| NewSection { name, bytes });
        container::write(&own.chain(besides).collect::<Vec<_>>(), writer)
    }
}

impl Bvh<TriangleMesh> {
    /// Loads a saved tree over triangles: see [`SavedTree::open`], which all that is said here is about, and which opens those with spheres or more as well.
    ///
    /// # Errors
    ///
    /// As [`SavedTree::open`], and a tree that is not over triangles alone.
    pub fn load(bytes: impl AsRef<[u8]> + Send + Sync + 'static) -> Result<Self, SavedTreeError> {
        let SavedTree { tree, mesh, spheres, .. } = SavedTree::open(bytes)?;
        if !spheres.is_empty() {
            let expected = "triangles alone".to_owned();
            let found = format!("{} triangles and {} spheres", mesh.len(), spheres.len());
            return Err(SavedTreeError::OtherGeometry { expected, found });
        }
        Ok(Self { geometry: mesh, tree })
    }
}

fn invalid_input(problem: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem)
}
