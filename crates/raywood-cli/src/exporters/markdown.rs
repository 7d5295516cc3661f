//! Tables in Markdown, as GitHub and others read it.

use super::Compared;
use super::contents::{notes, ray_sets, tables};
use crate::print::thousands;
use crate::report::values::cell;

pub(super) fn write(Compared { scene, comparison }: &Compared<'_>) -> String {
    let primitives = thousands(comparison.primitives as u64);
    let scene = escaped(scene);
    let mut text =
        format!("### {scene}: {primitives} primitives, {} threads\n\n", comparison.threads);
    for line in ray_sets(comparison) {
        text += &format!("- {line}\n");
    }
    for table in tables(comparison) {
        text += &format!("\n{}:\n\n| {} |\n", table.caption, table.columns.join(" | "));
        text += &format!("| --- |{}\n", " ---: |".repeat(table.columns.len() - 1));
        for row in &table.rows {
            let cells: Vec<_> = row.iter().map(cell).collect();
            text += &format!("| {} |\n", cells.join(" | "));
        }
    }
    text += "\n";
    for note in notes(comparison) {
        text += &format!("{note}\n");
    }
    text
}

/// The text with whatever would be read as Markdown escaped.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        if letter.is_ascii_punctuation() && !"-./:,".contains(letter) {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}
