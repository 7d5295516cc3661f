//! Structures that divide space into equal cells: the uniform grid, and the grid whose crowded cells hold grids.

mod build;
mod cells;
mod check;
mod dda;
mod lattice;
mod nested;
mod pool;
mod uniform;

pub use nested::NestedGrid;
pub use uniform::UniformGrid;
