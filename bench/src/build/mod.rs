//! What building trees takes, and what the trees are worth: measured by turns, told as text, JSON, Markdown and a picture.

mod labels;
pub(crate) mod pareto;
pub(crate) mod ratios;
pub(crate) mod report;
pub(crate) mod table;
pub(crate) mod turns;
