//! The tests of the library, one subject per file, in one program: what is generic is compiled once for all of them.

mod all_hits;
mod bounding_balls;
mod closest_point;
mod conformance;
mod dynamic;
mod forest;
mod grids;
mod hit_options;
mod instances;
mod kd_tree;
mod moving_instances;
mod octree;
mod overlap;
mod packets;
mod refit;
mod reinsertion;
mod saved_forgeries;
mod saved_trees;
mod solid;
mod spatial_splits;
mod sphere_cast;
mod spheres;
mod statistics;
mod trees;
mod watertight;
mod wide_packets;
