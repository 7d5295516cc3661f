//! Questions beside closest and any hits, of points and of rays: asked by turns, told as text, JSON and Markdown.

pub(crate) mod answers;
pub(crate) mod measure;
pub(crate) mod ratios;
pub(crate) mod reference;
pub(crate) mod report;
pub(crate) mod sets;
pub(crate) mod table;
