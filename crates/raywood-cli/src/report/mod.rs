//! Pages that a command writes: one file of HTML with everything in it, charts as SVG, for screens light and dark, phones and paper.
//!
//! [`page::html`] is the page, [`page::table`] a table in it, [`charts::figure`] a chart; [`values`] writes numbers in all of them.

mod axis;
pub(crate) mod charts;
pub(crate) mod experiments;
pub(crate) mod page;
mod palette;
pub(crate) mod values;

#[cfg(test)]
mod tests;
