//! Tables in Markdown, as GitHub and others read it.

use super::Compared;
use super::text_table::{notes, ray_sets, tables};
use crate::print::thousands;

pub(super) fn write(Compared { scene, comparison }: &Compared<'_>) -> String {
    let primitives = thousands(comparison.primitives as u64);
    let scene = escaped(scene);
    let mut text =
        format!("### {scene}: {primitives} primitives, {} threads\n\n", comparison.threads);
    for line in ray_sets(comparison) {
        text += &format!("- {line}\n");
    }
    for table in tables(comparison) {
        text += &format!("\n{}:\n\n", capitalised(table.title));
        let row = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        text += &row(&table.header);
        let columns = table.header.len();
        text += &format!("| --- |{}\n", " ---: |".repeat(columns - 1));
        table.rows.iter().for_each(|cells| text += &row(cells));
    }
    text += "\n";
    for note in notes(comparison) {
        text += &format!("{note}\n");
    }
    text
}

/// The text with a large first letter.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
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
