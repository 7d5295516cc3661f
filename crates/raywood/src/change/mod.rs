//! Trees that change with their geometry: new boxes for primitives that moved, parts built anew, or everything, as quality asks for.

mod dynamic_bvh;
mod refit;
mod refit_binary;
mod refit_error;
mod update;

pub use dynamic_bvh::DynamicBvh;
pub(crate) use refit::check_primitives;
pub use refit_error::RefitError;
pub use update::{Decision, Update, UpdateOptions};
