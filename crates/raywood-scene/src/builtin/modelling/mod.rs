//! Tools to model smooth shapes by code: closed or open surfaces with shading normals, front faces outside.
//!
//! A [`Part`] is a piece of surface without a material; a [`MeshBuilder`] copies parts to their [`Placement`] in
//! the scene. Parts come from [`revolve()`] and [`sweep()`], which both move a [`Profile`] through space, from the
//! panels and vaults of architecture, and from [`Part::add_grid`], on which all of these rest.

mod arch;
mod mesh_builder;
mod part;
mod placement;
mod profile;
mod revolve;
mod solids;
mod sweep;
mod topology;
mod vault;

pub use arch::{Arch, ArchedWall, arch_path};
pub use mesh_builder::MeshBuilder;
pub use part::{Cells, Part};
pub use placement::Placement;
pub use profile::Profile;
pub use revolve::{revolve, revolve_with};
pub use solids::{bar, cuboid};
pub use sweep::{PathPoint, sweep};
pub use topology::{is_closed, signed_volume};
pub use vault::{GroinVault, groin_vault};
